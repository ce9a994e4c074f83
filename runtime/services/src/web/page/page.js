"use strict";
// The page: one connection to the CPU tells values as they change; each view says which values it shows.

const $ = (id) => document.getElementById(id);
const ROWS = 200; // of the list of variables at a time
const SAMPLES_MAX = 12000; // of a curve

const live = {
  socket: null,
  names: [], // what the server tells, in its order
  shown: new Map(), // name -> { value, text, type } or { wrong }
  role: "look",
  forced: [], // addresses
  drawn: false, // the program has drawings
};

// Connection

function connect() {
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  const socket = new WebSocket(`${scheme}://${location.host}/live`);
  live.socket = socket;
  let opened = false;
  socket.onopen = () => { opened = true; live.names = []; lost(false); watch(); status.again(); };
  socket.onmessage = (event) => take(JSON.parse(event.data));
  socket.onclose = async () => {
    lost(true);
    if (!opened && (await fetch("names")).status === 401) { signIn(); return; }
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
  if (names.length === live.names.length && names.every((name, at) => name === live.names[at])) return;
  live.names = names;
  send({ do: "watch", names });
}

function take(news) {
  if (news.hello) hello(news.hello);
  if (news.state) state(news.state);
  const changed = new Set();
  for (const [number, why] of news.wrong ?? []) {
    live.shown.set(live.names[number], { wrong: why });
    changed.add(live.names[number]);
  }
  for (const [number, shown] of news.values ?? []) {
    live.shown.set(live.names[number], shown);
    changed.add(live.names[number]);
  }
  if (news.status) status.take(news.status);
  if (news.trace) recording.take(news.trace);
  if (news.buffer) buffer(news.buffer);
  if (news.forced) forced(news.forced);
  if (news.refused) refused(news.refused);
  record();
  view?.update(changed);
}

function hello(it) {
  document.title = `${it.program} – plcc`;
  $("title").textContent = it.program;
  $("cpu").textContent = it.cpu;
  $("user").textContent = it.user;
  $("sign-out").hidden = !it.user;
  live.role = it.role;
  live.watchable = it.watchable;
  document.body.classList.toggle("operate", it.role !== "look");
  $("orders").hidden = it.role !== "change";
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
  $("clock").textContent = time(it.clock);
  $("cycle").textContent = `cycle ${it.cycle.toLocaleString("en")}`;
}

// Inputs and outputs with fixed values are told wherever the page is.
function forced(list) {
  live.forced = list.map(([name]) => name);
  program.frame.contentWindow?.live?.force(live.forced);
  if (view === table) table.update(table.rows.keys());
  $("forced").hidden = list.length === 0;
  $("forced").textContent = `F ${list.length}`;
  $("forced").title = list.map(([name, value]) => `${name} = ${value}`).join("\n");
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

function showValue(cell, shown, format) {
  cell.className = "value";
  if (!shown) { cell.textContent = "…"; return; }
  if (shown.wrong) { cell.textContent = shown.wrong; cell.classList.add("wrong"); return; }
  cell.textContent = formatted(shown, format);
  cell.classList.toggle("on", shown.value === true);
}

const WIDTHS = { BYTE: 8, USINT: 8, SINT: 8, CHAR: 8, WORD: 16, INT: 16, UINT: 16, DWORD: 32, DINT: 32, UDINT: 32, LWORD: 64, LINT: 64, ULINT: 64 };
const FORMATS = ["", "dec", "signed", "hex", "bin", "BCD", "REAL"];

// A value as its type shows it, or in the format that was chosen.
function formatted(shown, format) {
  const bits = WIDTHS[shown.type];
  if (!format || !bits || typeof shown.value !== "number" || !Number.isSafeInteger(shown.value)) {
    return typeof shown.value === "boolean" ? String(shown.value).toUpperCase() : shown.text;
  }
  const raw = BigInt.asUintN(bits, BigInt(shown.value));
  switch (format) {
    case "dec": return raw.toString();
    case "signed": return BigInt.asIntN(bits, raw).toString();
    case "hex": return `16#${raw.toString(16).toUpperCase().padStart(bits / 4, "0")}`;
    case "bin": return `2#${raw.toString(2).padStart(bits, "0").replace(/\B(?=(.{4})+$)/g, "_")}`;
    case "BCD": { const digits = raw.toString(16); return /^\d+$/.test(digits) ? digits : shown.text; }
    case "REAL": {
      if (bits !== 32) return shown.text;
      const data = new DataView(new ArrayBuffer(4));
      data.setUint32(0, Number(raw));
      return data.getFloat32(0).toPrecision(7);
    }
  }
}

// View: program. The drawings are a document of their own, which says which operands are in sight.

const program = {
  frame: $("drawings"), keys: [],
  async open() {
    if (!this.frame.src) this.frame.src = "program";
    this.look();
  },
  look() {
    if (view !== this) return;
    status.follow(this.frame.contentWindow?.live);
    this.keys = this.frame.contentWindow?.live?.keys() ?? [];
    watch();
    this.update();
    setTimeout(() => this.look(), 500);
  },
  names() { return this.keys; },
  // Does something with the drawings as soon as they are there.
  show(work) {
    location.hash = "program";
    const open = () => { const frame = this.frame.contentWindow?.live; if (frame) work(frame); else setTimeout(open, 200); };
    open();
  },
  uses(name) { this.show((frame) => frame.uses(name)); },
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

// View: watch table. It is kept by the browser.

const table = {
  list: JSON.parse(localStorage.getItem("watch table") ?? "[]"), rows: new Map(),
  save() { localStorage.setItem("watch table", JSON.stringify(this.list)); },
  add(name) {
    if (!name || this.list.some((it) => it.name === name)) return;
    this.list.push({ name, format: "" });
    this.save();
    if (view === this) this.open();
  },
  open() {
    this.rows.clear();
    $("empty").hidden = this.list.length > 0;
    $("watched").replaceChildren(...this.list.map((it) => this.row(it)));
    watch();
    this.update(this.rows.keys());
  },
  row(it) {
    const value = element("td", { className: "value" });
    const type = element("td", { className: "type" });
    const format = element("select", { title: "format", onchange: () => { it.format = format.value; this.save(); this.update([it.name]); } },
      ...FORMATS.map((name) => element("option", { value: name, textContent: name || "type", selected: name === it.format })));
    const fresh = element("input", { className: "new", placeholder: "value" });
    fresh.setAttribute("aria-label", `new value of ${it.name}`);
    const modify = element("form", { onsubmit: (event) => {
      event.preventDefault();
      if (fresh.value) send({ do: "modify", name: it.name, value: fresh.value });
    } }, fresh, " ", element("button", { textContent: "set" }));
    const remove = element("button", { textContent: "×", title: "remove", onclick: () => {
      this.list = this.list.filter((other) => other !== it);
      this.save();
      this.open();
    } });
    this.rows.set(it.name, { value, type, format });
    return element("tr", {}, element("td", { textContent: it.name }), type, element("td", {}, format), value,
      element("td", { className: "operate" }, modify), element("td", {}, remove));
  },
  names() { return this.list.map((it) => it.name); },
  update(changed) {
    for (const name of changed) {
      const row = this.rows.get(name);
      const shown = live.shown.get(name);
      if (!row) continue;
      row.type.textContent = shown?.type ?? "";
      showValue(row.value, shown, row.format.value);
      row.value.classList.toggle("forced", live.forced.includes(name));
    }
  },
};
$("add").onsubmit = (event) => {
  event.preventDefault();
  table.add($("name").value.trim());
  $("name").value = "";
};

// View: curves of the watch table

const curves = {
  samples: new Map(), lanes: new Map(), paused: false, until: 0,
  open() {
    this.lanes.clear();
    $("lanes").replaceChildren(...table.list.map(({ name }) => {
      const value = element("b");
      const canvas = element("canvas");
      this.lanes.set(name, { value, canvas });
      return element("div", { className: "lane" }, element("div", {}, name, value), canvas);
    }));
    watch();
    this.draw();
  },
  names() { return table.names(); },
  update() { this.draw(); },
  draw() {
    if (!this.paused) this.until = Date.now();
    const span = Number($("span").value) * 1000;
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
      let low = Math.min(...seen.map(([, y]) => y));
      let high = Math.max(...seen.map(([, y]) => y));
      if (low === high) { low -= 0.5; high += 0.5; }
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
      if (typeof live.shown.get(name)?.value === "number") {
        pen.fillStyle = dark ? "#9aa5ae" : "#5d6872";
        pen.fillText(high.toPrecision(4), 4, 12 * devicePixelRatio);
        pen.fillText(low.toPrecision(4), 4, height - 3);
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
  for (const { name } of table.list) {
    const value = live.shown.get(name)?.value;
    if (typeof value !== "number" && typeof value !== "boolean") continue;
    const samples = curves.samples.get(name) ?? [];
    if (samples.at(-1)?.[1] !== Number(value)) samples.push([now, Number(value)]);
    if (samples.length > SAMPLES_MAX) samples.splice(0, SAMPLES_MAX / 4);
    curves.samples.set(name, samples);
  }
}

// View: diagnostic buffer

const diagnostics = { open() { watch(); }, names: () => [], update() {} };

// A place in the source leads to its network.
function place(text) {
  const found = /^([A-Z]+ \d+), (?:network (\d+), )?/.exec(text);
  if (!found || !live.drawn) return text;
  return element("a", { href: "#program", textContent: text, onclick: () => program.show((frame) => frame.go(found[1], Number(found[2] ?? 0))) });
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
  const VIEWS = { program, variables, table, curves, recording, "cpu-view": cpuInfo, buffer: diagnostics };
  if (!Object.hasOwn(VIEWS, name)) name = live.drawn ? "program" : "variables";
  if (view !== VIEWS[name]) status.leave();
  view = VIEWS[name];
  for (const section of document.querySelectorAll("main section")) section.hidden = section.id !== name;
  for (const button of document.querySelectorAll("nav button")) {
    if (button.dataset.view === name) button.setAttribute("aria-current", "page");
    else button.removeAttribute("aria-current");
  }
  view.open();
}
for (const button of document.querySelectorAll("nav button")) button.onclick = () => { location.hash = button.dataset.view; };
onhashchange = () => show(location.hash.slice(1));

// Orders and users

$("stop").onclick = () => { if (confirm("Put the CPU into STOP?")) send({ do: "stop" }); };
$("run").onclick = () => { if (confirm("Start the CPU?")) send({ do: "run", restart: $("restart").value }); };

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
