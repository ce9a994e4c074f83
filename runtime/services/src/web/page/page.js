"use strict";
// The page: one connection to the CPU tells values as they change; each view says which values it shows.

const $ = (id) => document.getElementById(id);
const ROWS = 200; // of the list of variables at a time
const SAMPLES_MAX = 12000; // of a curve

const live = {
  socket: null,
  names: [], // what the server tells, in its order
  formats: [], // of them, null: by the type
  list: 0, // how often other names were asked for on this connection
  shown: new Map(), // name -> { value, text, type } or { wrong }
  role: "look",
  forced: [], // { name, value, address, comment }
  told: false, // the CPU has said what is forced
  marked: new Set(), // names with forced bits
  drawn: false, // the program has drawings
};

// Connection

function connect() {
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  const socket = new WebSocket(`${scheme}://${location.host}/live`);
  live.socket = socket;
  let opened = false;
  socket.onopen = () => { opened = true; Object.assign(live, { names: [], formats: [], list: 0 }); lost(false); watch(); status.again(); };
  socket.onmessage = (event) => take(JSON.parse(event.data));
  socket.onclose = async () => {
    if (opened) lost(true);
    // Without an answer the program is away: it is tried again.
    else {
      const status = (await fetch("names").catch(() => null))?.status;
      if (status === 401) { lost(false); lamp("", "not signed in"); signIn(); return; }
      if (status === 403) { lost(false); lamp("", "refused: without users, open this page by IP address or as localhost"); return; }
    }
    lost(true);
    setTimeout(connect, 1000);
  };
}

function lost(is) {
  $("lost").hidden = !is;
  document.body.classList.toggle("lost", is);
  if (is) lamp("", "not connected");
}

function send(order) {
  if (live.socket?.readyState === WebSocket.OPEN) live.socket.send(JSON.stringify(order));
}

// Asks for the values of the view that is open.
function watch() {
  const names = [...new Set(view?.names() ?? [])];
  const formats = names.map((name) => view.format?.(name) ?? null);
  const same = (list, other) => list.length === other.length && list.every((one, at) => one === other[at]);
  if (live.socket?.readyState !== WebSocket.OPEN || same(names, live.names) && same(formats, live.formats)) return;
  Object.assign(live, { names, formats, list: live.list + 1 });
  send(formats.some((format) => format) ? { do: "watch", names, formats } : { do: "watch", names });
}

function take(news) {
  if (news.hello) hello(news.hello);
  if (news.state) state(news.state);
  const changed = new Set();
  // Numbers of an earlier list of names mean others.
  if (news.list === live.list) {
    for (const [number, why] of news.wrong ?? []) {
      live.shown.set(live.names[number], { wrong: why });
      changed.add(live.names[number]);
    }
    for (const [number, shown] of news.values ?? []) {
      live.shown.set(live.names[number], shown);
      changed.add(live.names[number]);
    }
    if (news.marked) live.marked = new Set(news.marked.map((number) => live.names[number]));
  }
  if (news.status) status.take(news.status);
  if (news.trace) recording.take(news.trace);
  if (news.buffer) buffer(news.buffer);
  if (news.forced) forced(news.forced);
  if (news.forced || news.marked) { table.mark(); if (view === forces) forces.open(); }
  if (news.job !== undefined) table.job(news.job);
  if (news.refused) { refused(news.refused); table.refused(news.refused); }
  record();
  view?.update(changed);
}

function hello(it) {
  // Another process has another program.
  if (live.started !== undefined && live.started !== it.started) { location.reload(); return; }
  live.started = it.started;
  document.title = `${it.program} – plcc`;
  $("title").textContent = it.program;
  $("cpu").textContent = it.cpu;
  $("user").textContent = it.limited ? `${it.user} (${it.role})` : it.user;
  $("user").title = it.limited ? "clients may do no more: access in plc.toml and --access say what" : "";
  $("sign-out").hidden = !it.user;
  live.role = it.role;
  Object.assign(live, { watchable: it.watchable, force: { max: it.force_max, modules: it.force_modules, areas: it.force_areas }, resets: it.has_reset });
  document.body.classList.toggle("operate", it.role !== "look");
  document.body.classList.toggle("change", it.role === "change");
  $("orders").hidden = it.role !== "change";
  $("restart").hidden = !it.has_cold;
  table.job(0);
  table.learn();
}

function lamp(kind, text) {
  $("state").className = `lamp ${kind}`;
  $("state").textContent = text;
}

function state(it) {
  // Another program has other networks and names.
  if (live.generation !== undefined && live.generation !== it.generation) location.reload();
  live.generation = it.generation;
  lamp(it.running ? "run" : "stop", it.running ? "RUN" : "STOP");
  $("reason").textContent = it.running ? "" : it.reason;
  // What is possible now.
  $("stop").disabled = !it.running;
  $("run").disabled = $("restart").disabled = it.running;
  $("reset").hidden = it.running || !live.resets;
  $("outputs").hidden = it.running;
  $("outputs").textContent = it.outputs ? "disable outputs" : "enable outputs";
  $("enabled").hidden = !it.outputs;
  live.outputs = it.outputs;
  $("clock").textContent = time(it.clock);
  $("cycle").textContent = `cycle ${it.cycle.toLocaleString("en")}`;
}

// Inputs and outputs with fixed values are told wherever the page is.
function forced(list) {
  Object.assign(live, { forced: list, told: true });
  program.mark();
  $("forced").hidden = list.length === 0;
  $("forced").textContent = `F ${list.length}`;
  $("forced").title = list.map((it) => `${it.name} = ${it.value}`).join("\n");
}

let refusedTimer;
function refused(why) {
  $("refused").textContent = why;
  $("refused").hidden = false;
  clearTimeout(refusedTimer);
  refusedTimer = setTimeout(() => { $("refused").hidden = true; }, 6000);
}

// The clock of a CPU has no time zone.
const time = (clock) => new Date(clock).toISOString().replace("T", " ").replace(/\.\d+Z$/, "");

// Parts of a page

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

// Asks a person. Result: what was entered, without a field the empty text; null: no.
function ask(question, yes, field) {
  const dialog = $("question"), input = $("question-value");
  $("question-text").textContent = question;
  $("question-yes").textContent = yes;
  $("question-field").hidden = !field;
  $("question-label").textContent = field?.label ?? "";
  input.value = field?.value ?? "";
  input.required = !!field;
  dialog.returnValue = "";
  dialog.showModal();
  if (field) input.select();
  return new Promise((done) => {
    // The event of an earlier question may come when this one is open.
    dialog.onclose = () => { if (!dialog.open) done(dialog.returnValue === "yes" ? input.value.trim() : null); };
  });
}

function showValue(cell, shown) {
  cell.className = "value";
  if (!shown) { cell.textContent = "…"; return; }
  if (shown.wrong) { cell.textContent = shown.wrong; cell.classList.add("wrong"); return; }
  cell.textContent = typeof shown.value === "boolean" && /^[01]$/.test(shown.text) ? String(shown.value).toUpperCase() : shown.text;
  cell.classList.toggle("on", shown.value === true);
}

// View: program. The drawings are a document of their own, which says which operands are in sight.

const program = {
  frame: $("drawings"), keys: [], timer: null,
  async open() {
    if (!this.frame.src) {
      this.frame.onload = () => {
        this.look();
        // Another block may be in sight after that.
        this.frame.contentDocument?.addEventListener("click", () => setTimeout(() => this.look(), 50));
      };
      this.frame.src = "program";
    }
    this.look();
  },
  // Again and again, while the view is open.
  look() {
    clearTimeout(this.timer);
    if (view !== this) return;
    status.follow(this.frame.contentWindow?.live);
    this.keys = this.frame.contentWindow?.live?.keys() ?? [];
    watch();
    this.update();
    this.timer = setTimeout(() => this.look(), 500);
  },
  names() { return this.keys; },
  // Does something with the drawings as soon as they are there.
  show(work) {
    location.hash = "program";
    const open = () => { const frame = this.frame.contentWindow?.live; if (frame) work(frame); else setTimeout(open, 200); };
    open();
  },
  uses(name) { this.show((frame) => frame.uses(name)); },
  // Operands that are forced.
  mark() { this.frame.contentWindow?.live?.force(live.forced.map((it) => it.address), live.force?.modules); },
  update() {
    const told = this.keys.filter((key) => live.shown.get(key)?.text !== undefined);
    this.frame.contentWindow?.live?.set(told.map((key) => [key, live.shown.get(key).text]));
  },
};

// View: variables

const variables = {
  all: [], rows: new Map(), limit: ROWS,
  async open() {
    if (!this.all.length) {
      const answer = await fetch("names");
      if (!answer.ok) return;
      this.all = await answer.json();
      $("known").append(...this.all.slice(0, 5000).map((it) => element("option", { value: it.name })));
    }
    this.draw();
  },
  draw() {
    const words = $("search").value.toLowerCase().split(/\s+/);
    const hits = this.all.filter((it) => words.every((word) => `${it.name} ${it.type}`.toLowerCase().includes(word)));
    $("found").textContent = `${hits.length} of ${this.all.length}`;
    $("more").hidden = hits.length <= this.limit;
    this.rows.clear();
    $("names").replaceChildren(...hits.slice(0, this.limit).map((it) => {
      const value = element("td", { className: "value" });
      const add = element("button", { textContent: "+", title: "to the watch table", onclick: () => table.add(it.name) });
      this.rows.set(it.name, value);
      showValue(value, live.shown.get(it.name));
      return element("tr", {}, element("td", {}, add), element("td", { textContent: it.name }),
        element("td", { className: "type", textContent: it.type }), value,
        element("td", {}, ...(live.drawn ? [element("button", { textContent: "uses", title: "where it is used", onclick: () => program.uses(it.name) })] : [])));
    }));
    watch();
  },
  names() { return [...this.rows.keys()]; },
  update(changed) {
    for (const name of changed) if (this.rows.has(name)) showValue(this.rows.get(name), live.shown.get(name));
  },
};
$("search").oninput = () => { variables.limit = ROWS; variables.draw(); };
$("more").onclick = () => { variables.limit += ROWS; variables.draw(); };

// A time axis below curves, in milliseconds from the moment `zero`.
function axis(canvas, from, to, zero) {
  const ratio = devicePixelRatio, width = (canvas.width = canvas.clientWidth * ratio), height = (canvas.height = canvas.clientHeight * ratio);
  const pen = canvas.getContext("2d"), span = to - from;
  const wanted = span / Math.max(1, canvas.clientWidth / 90), power = 10 ** Math.floor(Math.log10(wanted));
  const step = [1, 2, 5, 10].map((times) => times * power).find((one) => one >= wanted) ?? span;
  pen.font = `${11 * ratio}px system-ui`;
  pen.textAlign = "center";
  pen.fillStyle = pen.strokeStyle = matchMedia("(prefers-color-scheme: dark)").matches ? "#9aa5ae" : "#5d6872";
  for (let tick = Math.ceil((from - zero) / step); tick * step <= to - zero; tick++) {
    const x = (tick * step + zero - from) / span * width, text = step >= 1000 ? `${+(tick * step / 1000).toFixed(3)} s` : `${+(tick * step).toFixed(3)} ms`;
    pen.fillRect(x, 0, ratio, 4 * ratio);
    const half = pen.measureText(text).width / 2;
    pen.fillText(text, Math.min(Math.max(x, half), width - half), height - 3 * ratio);
  }
}

// A bound of a curve, with six digits, and without an exponent where that is possible.
const bound = (number) => String(+number.toPrecision(6));

// The range of a curve: from 0 to 1 for a bit. A number that never changes gets room above and below, even if it is large.
function range(numbers, isBit) {
  let [low, high] = isBit ? [0, 1] : [Infinity, -Infinity];
  for (const number of numbers) { low = Math.min(low, number); high = Math.max(high, number); }
  const room = low === high ? Math.max(0.5, Math.abs(low) / 1e6) : 0;
  return [low - room, high + room];
}

// A value as a curve has it: a bit, a number, or a duration in seconds; null: it is none of these.
const SECONDS = { d: 86400, h: 3600, m: 60, s: 1, ms: 1e-3, us: 1e-6, ns: 1e-9 };
const isDuration = (shown) => /^(TIME|LTIME|S5TIME)$/.test(shown?.type) && /^(T|LT|S5T)#/.test(shown.value);
function plotted(shown) {
  const value = shown?.value;
  if (isDuration(shown)) {
    const parts = [...value.matchAll(/(\d+)(ms|us|ns|[dhms])/g)].map(([, count, unit]) => count * SECONDS[unit]);
    return parts.reduce((sum, part) => sum + part, 0) * (value.includes("#-") ? -1 : 1);
  }
  // Numbers of more than 53 bits come as text.
  if (typeof value === "string" && /^(LWORD|U?LINT)$/.test(shown.type)) return Number(value);
  return typeof value === "number" || typeof value === "boolean" ? Number(value) : null;
}

// View: curves of the watch table

const curves = {
  samples: new Map(), lanes: new Map(), paused: false, until: 0, axis: element("canvas", { className: "axis" }),
  open() {
    this.lanes.clear();
    $("lanes").replaceChildren(...table.names().map((name) => {
      const value = element("b");
      const canvas = element("canvas");
      this.lanes.set(name, { value, canvas });
      return element("div", { className: "lane" }, element("div", {}, name, value), canvas);
    }), element("div", { className: "lane" }, element("div"), this.axis));
    watch();
    this.draw();
  },
  names() { return table.names(); },
  update() { this.draw(); },
  draw() {
    if (!this.paused) this.until = Date.now();
    const span = Number($("span").value) * 1000;
    axis(this.axis, this.until - span, this.until, this.until);
    const style = getComputedStyle(document.documentElement);
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    for (const [name, { value, canvas }] of this.lanes) {
      value.textContent = live.shown.get(name)?.wrong ?? live.shown.get(name)?.text ?? "…";
      const samples = this.samples.get(name) ?? [];
      const width = canvas.width = canvas.clientWidth * devicePixelRatio;
      const height = canvas.height = canvas.clientHeight * devicePixelRatio;
      const pen = canvas.getContext("2d");
      const from = this.until - span;
      const first = Math.max(0, samples.findLastIndex(([at]) => at <= from));
      const seen = samples.slice(first).filter(([at]) => at <= this.until);
      if (!seen.length) continue;
      const [low, high] = range(seen.map(([, y]) => y), typeof live.shown.get(name)?.value === "boolean");
      const x = (at) => (at - from) / span * width;
      const y = (number) => height - 6 - (number - low) / (high - low) * (height - 12);
      pen.strokeStyle = dark ? "#58b4f0" : "#0b6aa8";
      pen.lineWidth = 1.5 * devicePixelRatio;
      pen.beginPath();
      // A value holds until the next one.
      seen.forEach(([at, number], index) => {
        if (index === 0) pen.moveTo(x(at), y(number));
        else { pen.lineTo(x(at), y(seen[index - 1][1])); pen.lineTo(x(at), y(number)); }
      });
      pen.lineTo(x(this.until), y(seen.at(-1)[1]));
      pen.stroke();
      pen.fillStyle = style.color;
      pen.font = `${11 * devicePixelRatio}px system-ui`;
      if (typeof live.shown.get(name)?.value !== "boolean") {
        const unit = isDuration(live.shown.get(name)) ? " s" : "";
        pen.fillStyle = dark ? "#9aa5ae" : "#5d6872";
        pen.fillText(bound(high) + unit, 4, 12 * devicePixelRatio);
        pen.fillText(bound(low) + unit, 4, height - 3);
      }
    }
  },
};
$("pause").onclick = () => {
  curves.paused = !curves.paused;
  $("pause").textContent = curves.paused ? "go on" : "pause";
  curves.draw();
};
$("span").onchange = () => curves.draw();

// Keeps what the watch table tells, for its curves.
function record() {
  const now = Date.now();
  for (const name of table.names()) {
    const value = plotted(live.shown.get(name));
    if (value === null) continue;
    const samples = curves.samples.get(name) ?? [];
    if (samples.at(-1)?.[1] !== value) samples.push([now, value]);
    if (samples.length > SAMPLES_MAX) samples.splice(0, SAMPLES_MAX / 4);
    curves.samples.set(name, samples);
  }
}

// View: diagnostic buffer

const diagnostics = { open() { watch(); }, names: () => [], update() {} };

// A place in the source leads to its network: `FC 2, network 2, words.stl:23`, `Fill (FC 2), network 2, words.scl:23`.
function place(text) {
  const found = /^(?:([A-Z]+ \d+)|.*? \(([A-Z]+ \d+)\)), (?:network (\d+), )?/.exec(text);
  if (!found || !live.drawn) return text;
  return element("a", { href: "#program", textContent: text, onclick: () => program.show((frame) => frame.go(found[1] ?? found[2], Number(found[3] ?? 0))) });
}

function buffer(entries) {
  $("events").replaceChildren(...entries.map((it) => element("tr", { className: /^STOP/.test(it.text) ? "fault" : "" },
    element("td", { className: "value", textContent: `${time(it.clock)}.${String(Math.floor(it.clock % 1000)).padStart(3, "0")}` }),
    element("td", { className: "value", textContent: `16#${it.event.toString(16).toUpperCase().padStart(4, "0")}` }),
    element("td", { textContent: it.text.replace(/^16#[0-9A-F]{4} /, "") }), element("td", {}, place(it.place)))));
}

// Views

let view = null;

function show(name) {
  const VIEWS = { program, variables, table, force: forces, curves, recording, "cpu-view": cpuInfo, buffer: diagnostics };
  if (!Object.hasOwn(VIEWS, name)) name = live.drawn ? "program" : "variables";
  if (view !== VIEWS[name]) status.leave();
  view = VIEWS[name];
  for (const section of document.querySelectorAll("main section")) section.hidden = section.id !== name;
  for (const button of document.querySelectorAll("nav button")) {
    if (button.dataset.view === name) button.setAttribute("aria-current", "page");
    else button.removeAttribute("aria-current");
  }
  // A small screen has no room for all of them.
  document.querySelector("nav [aria-current]").scrollIntoView({ block: "nearest", inline: "nearest" });
  view.open();
}
for (const button of document.querySelectorAll("nav button")) button.onclick = () => { location.hash = button.dataset.view; };
onhashchange = () => show(location.hash.slice(1));

// Orders and users

$("stop").onclick = async () => { if (await ask("Put the CPU into STOP?", "STOP") !== null) send({ do: "stop" }); };
$("run").onclick = async () => { if (await ask(`Start the CPU with a ${$("restart").value} restart?`, "RUN") !== null) send({ do: "run", restart: $("restart").value }); };
$("reset").onclick = async () => {
  const question = "Reset the memory of the CPU? All data begins with its start values, also what is retentive. This cannot be undone. The program stays.";
  if (await ask(question, "Reset memory") !== null) send({ do: "reset" });
};
$("outputs").onclick = async () => {
  const question = "Enable the peripheral outputs in STOP? What you modify there reaches the plant, until RUN or the end of this page.";
  if (live.outputs) send({ do: "outputs", enable: false });
  else if (await ask(question, "Enable") !== null) send({ do: "outputs", enable: true });
};
$("forced").onclick = () => { location.hash = "force"; };

function signIn() {
  if (!$("sign-in").open) $("sign-in").showModal();
}
$("sign-in").querySelector("form").onsubmit = async (event) => {
  event.preventDefault();
  const form = new FormData(event.target);
  const answer = await fetch("session", { method: "POST", headers: { "content-type": "application/json" },
    body: JSON.stringify({ user: form.get("user"), password: form.get("password") }) });
  $("wrong").hidden = answer.ok;
  if (!answer.ok) return;
  location.reload();
};
$("sign-out").onclick = async () => {
  await fetch("session", { method: "DELETE" });
  location.reload();
};

// The other scripts have been run then.
addEventListener("DOMContentLoaded", () => {
  connect();
  fetch("program", { method: "HEAD" }).then((answer) => {
    live.drawn = answer.ok;
    document.querySelector("[data-view=program]").hidden = !answer.ok;
    show(location.hash.slice(1));
  });
});
