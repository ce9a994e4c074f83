"use strict";
// View: a recording of the watch table, in every cycle in which a value changes.

const recording = {
  signals: [], // names
  last: [], // samples by signal: [milliseconds, value]
  samples: [], // all: [cycle, milliseconds, signal, value]
  base: [], // values before the first sample
  now: 0, before: 0, lanes: [], axis: element("canvas", { className: "axis" }),
  open() {
    const chosen = $("trigger").value;
    $("trigger").replaceChildren(element("option", { value: "", textContent: "at once" }),
      ...this.wanted().map((name, i) => element("option", { value: String(i), textContent: `when ${name}`, selected: String(i) === chosen })));
    $("crossing").hidden = $("trigger").value === "";
    watch();
    this.show();
  },
  // What can be recorded: bits and numbers.
  wanted: () => table.names().filter((name) => ["number", "boolean"].includes(typeof live.shown.get(name)?.value)).slice(0, 16),
  names() { return table.names(); },
  update(changed) { if (changed.size && $("trigger").options.length !== this.wanted().length + 1) this.open(); },
  start() {
    const signals = this.wanted();
    if (!signals.length) { refused("put bits or numbers into the watch table"); return; }
    const at = $("trigger").value;
    const trigger = at === "" ? null : { signal: Number(at), level: Number($("level").value), rising: $("edge").value === "up" };
    Object.assign(this, { signals, samples: [], last: signals.map(() => []), now: 0, before: 0 });
    send({ do: "trace", signals, trigger, samples: Number($("samples").value) || 100000, before: trigger ? Number($("before").value) || 0 : 0 });
    this.show();
  },
  stop() { send({ do: "trace", signals: [] }); $("record-state").textContent = `ended, ${this.samples.length.toLocaleString("en")} samples`; },
  take(part) {
    for (const sample of part.samples) {
      this.samples.push(sample);
      this.last[sample[2]]?.push([sample[1], sample[3]]);
    }
    this.now = Math.max(this.now, part.now);
    this.before = part.before;
    this.base = part.base;
    const words = { waiting: "waits for the event", running: "records", full: "complete", lost: "ended: the CPU was restarted" };
    $("record-state").textContent = `${words[part.state]}, ${this.samples.length.toLocaleString("en")} samples`;
    if (part.state === "full") this.now = this.samples.at(-1)?.[1] ?? this.now;
    $("save-csv").disabled = $("save-vcd").disabled = !this.samples.length;
    if (view === this) this.draw();
  },
  show() {
    this.lanes = this.signals.map((name) => ({ value: element("b"), canvas: element("canvas"), name }));
    $("records").replaceChildren(...this.lanes.map(({ name, value, canvas }) => element("div", { className: "record" }, element("div", {}, name, " ", value), canvas)),
      ...(this.lanes.length ? [element("div", { className: "record" }, element("div"), this.axis)] : []));
    this.draw();
  },
  draw() {
    const from = this.samples[0]?.[1] ?? 0;
    const span = Math.max(1, this.now - from);
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    const event = this.before > 0 ? this.samples[this.before]?.[1] : undefined;
    // Times are from the event on, or from the beginning.
    if (this.samples.length) axis(this.axis, from, from + span, event ?? from);
    this.lanes.forEach(({ value, canvas, name }, signal) => {
      const list = typeof this.base[signal] === "number" ? [[from, this.base[signal]], ...this.last[signal]] : this.last[signal] ?? [];
      value.textContent = list.length ? String(list.at(-1)[1]) : "";
      const width = (canvas.width = canvas.clientWidth * devicePixelRatio), height = (canvas.height = canvas.clientHeight * devicePixelRatio);
      const pen = canvas.getContext("2d");
      const numbers = list.map(([, y]) => y).filter((y) => y !== null), isBit = typeof live.shown.get(name)?.value === "boolean";
      if (!numbers.length) return;
      const [low, high] = range(numbers, isBit);
      const x = (at) => (at - from) / span * width, y = (number) => height - 6 - (number - low) / (high - low) * (height - 12);
      pen.strokeStyle = dark ? "#58b4f0" : "#0b6aa8";
      pen.lineWidth = 1.5 * devicePixelRatio;
      pen.beginPath();
      let before = null;
      for (const [at, number] of list) {
        if (number === null) { before = null; continue; }
        if (before === null) pen.moveTo(x(at), y(number)); else { pen.lineTo(x(at), y(before)); pen.lineTo(x(at), y(number)); }
        before = number;
      }
      if (before !== null) pen.lineTo(x(this.now), y(before));
      pen.stroke();
      if (!isBit) {
        pen.fillStyle = dark ? "#9aa5ae" : "#5d6872";
        pen.font = `${11 * devicePixelRatio}px system-ui`;
        pen.fillText(bound(high), 4, 12 * devicePixelRatio);
        pen.fillText(bound(low), 4, height - 3);
      }
      if (event !== undefined) {
        pen.strokeStyle = "#c25e00";
        pen.beginPath(); pen.moveTo(x(event), 0); pen.lineTo(x(event), height); pen.stroke();
      }
    });
  },
  // A row for each cycle in which something changed, with all values that hold after it.
  csv() {
    const quoted = (name) => (/[",;\n]/.test(name) ? `"${name.replace(/"/g, '""')}"` : name);
    const rows = [["cycle", "ms", ...this.signals.map(quoted)].join(",")];
    const values = this.signals.map((_, signal) => this.base[signal] ?? "");
    this.samples.forEach(([cycle, ms, signal, value], i) => {
      values[signal] = value ?? "";
      if (this.samples[i + 1]?.[0] !== cycle) rows.push([cycle, ms, ...values].join(","));
    });
    return rows.join("\n") + "\n";
  },
  // Value change dump: bits are wires, numbers are reals. Source: IEEE 1364, value change dump files.
  vcd() {
    const id = (signal) => String.fromCharCode(33 + signal);
    const isBit = this.signals.map((name) => typeof live.shown.get(name)?.value === "boolean");
    const lines = ["$timescale 1us $end", "$scope module plc $end",
      ...this.signals.map((name, i) => `$var ${isBit[i] ? "wire 1" : "real 64"} ${id(i)} ${name.replace(/\s/g, "_")} $end`),
      "$upscope $end", "$enddefinitions $end"];
    const change = (signal, value) => (isBit[signal] ? `${value === null ? "x" : value}${id(signal)}` : `r${value ?? "nan"} ${id(signal)}`);
    let time = null;
    if (this.samples.length) lines.push(`#${(time = Math.round(this.samples[0][1] * 1000))}`);
    this.base.forEach((value, signal) => { if (value !== null) lines.push(change(signal, value)); });
    for (const [, ms, signal, value] of this.samples) {
      const us = Math.round(ms * 1000);
      if (us !== time) lines.push(`#${(time = us)}`);
      lines.push(change(signal, value));
    }
    return lines.join("\n") + "\n";
  },
  save(name, text) {
    const link = element("a", { href: URL.createObjectURL(new Blob([text], { type: "text/plain" })), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  },
};
$("record").onclick = () => recording.start();
$("record-stop").onclick = () => recording.stop();
$("trigger").onchange = () => { $("crossing").hidden = $("trigger").value === ""; };
$("save-csv").onclick = () => recording.save("recording.csv", recording.csv());
$("save-vcd").onclick = () => recording.save("recording.vcd", recording.vcd());
