"use strict";
// The status of the block that is in sight, and what the CPU is and does.

const status = {
  block: null, // that the CPU is asked for: FB1
  frame: null,
  calls: [],
  call: "",
  turn: 0, // number of the order whose news are shown
  places: [],
  // Asks for the block that the drawings show now.
  async follow(frame) {
    const isNew = frame && frame !== this.frame;
    this.frame = frame;
    if (isNew) program.mark();
    // A data block and a list have no status.
    $("status-bar").hidden = !live.watchable || !frame?.block();
    const block = live.watchable && $("status-on").checked ? frame?.block() ?? null : null;
    if (block === this.block || !frame) return;
    this.block = block;
    this.call = "";
    this.turn++;
    this.list([]);
    $("status-block").textContent = block ?? frame.block() ?? "";
    $("status-seen").textContent = "";
    if (!block) { frame.unwatch(); this.ask(); return; }
    const answer = await fetch(`places/${block}`);
    if (this.block !== block) return;
    if (!answer.ok) { $("status-seen").textContent = "this block has no status"; return; }
    this.places = await answer.json();
    frame.watch(block, this.places);
    $("status-seen").textContent = "not called so far";
    this.ask();
  },
  ask() { send(this.block ? { do: "status", block: this.block, call: this.call || null, turn: ++this.turn } : { do: "status", block: null }); },
  // After the connection was lost.
  again() { if (this.block) { this.block = null; } },
  leave() {
    const was = this.block;
    this.block = null;
    if (was) this.frame?.unwatch();
    // Also ends what the view of the CPU has asked for.
    if (live.watchable) this.ask();
  },
  list(calls) {
    this.calls = calls;
    $("status-call").replaceChildren(element("option", { value: "", textContent: "first call in a cycle" }),
      ...calls.map((name) => element("option", { value: name, textContent: name, selected: name === this.call })));
  },
  take(news) {
    if (!this.block || news.turn !== this.turn) return;
    if (news.calls) this.list(news.calls);
    if (news.call) $("status-seen").textContent = `${this.calls[news.call[0]] ?? ""} in cycle ${news.call[1].toLocaleString("en")}`;
    this.frame?.see(news.seen ?? [], news.steps, news.history);
  },
};
$("status-on").onchange = () => program.look();
$("status-call").onchange = () => {
  status.call = $("status-call").value;
  $("status-seen").textContent = "not called since then";
  // Nothing of the call until now remains.
  if (status.block) status.frame?.watch(status.block, status.places);
  status.ask();
};

// View: the CPU

const cpuInfo = {
  timer: null,
  open() {
    watch();
    if (view !== this) return;
    this.look();
  },
  async look() {
    clearTimeout(this.timer);
    if (view !== this) return;
    // Again and again: the connection may be another one.
    if (live.watchable) send({ do: "obs" });
    const answer = await fetch("info").catch(() => null);
    if (answer?.ok) this.draw(await answer.json());
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.look(), 1000);
  },
  names: () => [],
  update() {},
  table(title, rows) {
    return element("div", {}, element("h2", { textContent: title }), element("table", {}, element("tbody", {},
      ...rows.map((row) => element("tr", {}, ...row.map((cell) => element("td", { textContent: cell ?? "" })))))));
  },
  // The station as it is configured, and partners of the program.
  station(it) {
    const parts = [];
    if (it.modules.length) parts.push(this.table("Modules", it.modules.map((of) => [[of.name, of.order].filter((text) => text).join(", "),
      of.slot === null ? "" : `rack ${of.rack}, slot ${of.slot}`, of.addresses, [...new Set(of.ranges)].join(", ")])));
    if (it.devices.length) parts.push(this.table("Devices", it.devices.map((of) => [of.name, of.line, `unit ${of.unit}`, of.away ? "does not answer" : "answers"])));
    if (it.partners.length) parts.push(this.table("Connections of the program", it.partners.map((of) => [`ID ${of.id}`, of.partner ?? "any partner", of.active ? "this side connects" : "the partner connects"])));
    return parts;
  },
  times(title, bounds, counts) {
    const most = Math.max(1, ...counts);
    const name = (us) => (us >= 1e6 ? `${us / 1e6} s` : us >= 1000 ? `${us / 1000} ms` : `${us} µs`);
    const bars = element("div", { className: "bars" });
    const [first, last] = [counts.findIndex((n) => n), counts.findLastIndex((n) => n)];
    counts.forEach((count, i) => {
      if (first < 0 || i < first || i > last) return;
      const bar = element("i");
      bar.style.width = `${count / most * 100}%`;
      bars.append(element("span", { textContent: i < bounds.length ? `≤ ${name(bounds[i])}` : `> ${name(bounds.at(-1))}` }), bar,
        element("span", { textContent: count.toLocaleString("en") }));
    });
    if (first < 0) bars.append("none yet");
    return element("div", {}, element("h2", { textContent: title }), bars);
  },
  draw(it) {
    const { bounds_us: bounds, period, work } = it.cycles;
    // They are counted since somebody wants to know them.
    const from = it.cycles.from ? `, from cycle ${it.cycles.from.toLocaleString("en")} on` : "";
    $("cpu-info").replaceChildren(
      this.table("CPU", [["CPU", it.cpu], ["order number", it.order], ["program", it.program],
        ["cycle monitoring", it.cycle_limit_ms === null ? "off" : `${it.cycle_limit_ms} ms`], ["faults so far", it.faults]].filter(([, value]) => value !== "")),
      this.times(`Work of a cycle${from}`, bounds, work),
      this.times(`From cycle to cycle${from}`, bounds, period),
      this.table("Memory in bytes", Object.entries(it.memory)),
      this.table("Blocks", Object.entries(it.blocks)),
      this.table("Organization blocks", it.obs.map((ob) => [`OB ${ob.ob} ${ob.name}`, (ob.class ?? "").replace(/\B[A-Z]/g, (c) => ` ${c}`).toLowerCase(),
        ob.runs ? `${ob.runs.count.toLocaleString("en")} runs` : "", ob.runs?.count ? `${ob.runs.mean_us.toFixed(1)} µs, at most ${ob.runs.longest_us.toFixed(1)} µs` : ""])),
      ...this.station(it),
      this.table("Clients", it.connections.map((of) => [of.service, `${of.now} now`, `${of.accepted} accepted`, `${of.refused} refused`])),
    );
  },
};
