"use strict";
// Views: the watch tables, and what is forced. Tables are kept by the browser, and in files of the project.

// Formats by the width of a value in bits. Source: Programming with STEP 7, display formats.
const FORMATS = {
  1: ["bool"],
  8: ["bin", "hex", "dec", "unsigned", "char", "bcd"],
  16: ["bin", "hex", "dec", "unsigned", "bcd", "char", "s5time", "date", "counter"],
  32: ["bin", "hex", "dec", "unsigned", "bcd", "char", "real", "time", "time-of-day", "pointer"],
  64: ["bin", "hex", "dec", "unsigned", "real"],
};
const FORMAT_NAMES = { bin: "BIN", hex: "HEX", dec: "DEC, signed", unsigned: "DEC, unsigned", bcd: "BCD", char: "CHAR", real: "REAL", s5time: "S5TIME",
  date: "DATE", counter: "COUNTER", time: "TIME", "time-of-day": "TIME_OF_DAY", pointer: "POINTER", bool: "BOOL" };
const TRIGGERS = [["begin", false, "once, begin"], ["end", false, "once, end"], ["begin", true, "every begin"], ["end", true, "every end"]];

// An address without a declared type is written as it is shown: hexadecimal.
function entryFormat(name, chosen) {
  const shown = live.shown.get(name);
  return chosen ?? (/^(BYTE|WORD|DWORD|LWORD)$/.test(shown?.type) && shown.bits ? "hex" : null);
}

// Forces a value that a person enters. `value`: what the field has at first.
async function askForce(name, value, format) {
  const known = live.forced.find((it) => it.name === name);
  format = entryFormat(name, known?.format ?? format);
  const question = `Force ${name}? It keeps this value whatever modules and program say, through STOP and restart, until it is released.`;
  const entered = await ask(question, "Force", { label: format ? `Value, ${FORMAT_NAMES[format]}` : "Value", value: known?.value ?? value });
  if (entered) send({ do: "force", name, value: entered, format });
}
async function askRelease(name) {
  const question = name ? `Release ${name}? It gets the value of its module or of the program again.` : `Release all ${live.forced.length} forced values?`;
  if (await ask(question, "Release") !== null) send({ do: "unforce", name: name ?? null });
}

// View: watch table

const TABLES = "watch tables of the program";

// Rows are those of the file: address, format, comment, modify, trigger, every-cycle, cycle. A table has `changed` if the file of the project,
// if there is one, does not have what is here.
const table = {
  // The table that is shown, the others that are open, and the names of those in the project; null: it has no place for them.
  kept: { name: "watch", row: [] },
  others: [],
  project: null,
  rows: new Map(),
  restore() {
    const [shown, ...others] = JSON.parse(localStorage.getItem(TABLES) ?? "[]");
    if (shown) Object.assign(this, { kept: shown, others });
  },
  // What a person has done is kept.
  save() {
    this.kept.changed = true;
    this.store();
  },
  store() {
    localStorage.setItem(TABLES, JSON.stringify([this.kept, ...this.others]));
    this.list();
  },
  // Names of the tables, those of the project first; a star marks what differs from its file.
  list() {
    $("table-name").value = this.kept.name;
    const here = new Map([this.kept, ...this.others].map((it) => [it.name, it]));
    const names = [...new Set([...this.project ?? [], ...[...here.keys()].sort()])];
    $("table-list").replaceChildren(...names.map((name) => element("option", { value: name, selected: name === this.kept.name,
      textContent: this.project?.includes(name) && here.get(name)?.changed ? `${name} *` : name })));
    $("table-keep").hidden = !this.project || live.role === "look";
    $("table-close").disabled = names.length < 2;
  },
  // Asks which tables the project has now.
  async learn() {
    const answer = await fetch("tables");
    this.project = answer.ok ? await answer.json() : null;
    this.list();
  },
  // Shows a table that is open, or opens that of the project.
  async show(name) {
    if (name === this.kept.name) return;
    const open = this.others.find((it) => it.name === name);
    let next = open;
    if (this.project?.includes(name) && !open?.changed) {
      const answer = await fetch(`tables/${encodeURIComponent(name)}`);
      if (!answer.ok) { refused(await answer.text()); this.list(); return; }
      next = this.table(name, await answer.json());
      if (next) next.from = name;
    }
    if (!next) { this.list(); return; }
    this.turn(next);
  },
  // Shows another table instead of the one with its name; the one that was shown stays open.
  turn(next) {
    const others = this.others.filter((it) => it.name !== next.name);
    if (this.kept.name !== next.name && (this.kept.row.length || this.project?.includes(this.kept.name))) others.push(this.kept);
    Object.assign(this, { kept: next, others });
    this.store();
    if (view === this) this.open();
  },
  // A table of a file; undefined: it cannot be shown.
  table(name, { row, trace }) {
    const twice = row.find((it, at) => row.findIndex((other) => other.address === it.address) < at);
    if (twice) { refused(`${name}: ${twice.address} has two rows; the page shows each name once`); return; }
    return { name, row, trace };
  },
  isOpen(name) { return this.others.some((it) => it.name === name) || this.project?.includes(name); },
  fresh() {
    let number = 1;
    while (this.kept.name === `table ${number}` || this.isOpen(`table ${number}`)) number++;
    this.turn({ name: `table ${number}`, row: [] });
  },
  rename(name) {
    const other = name !== this.kept.name && this.isOpen(name);
    if (other) refused(`there is a watch table ${name} already`);
    if (name && !other) { this.kept.name = name; this.save(); } else this.list();
  },
  // Writes the table into the project.
  async keep() {
    const { name, row, trace, from } = this.kept;
    if (from !== name && this.project.includes(name) && await ask(`Replace the watch table ${name} of the project?`, "Replace") === null) return;
    const answer = await fetch(`tables/${encodeURIComponent(name)}`, { method: "PUT", headers: { "content-type": "application/json" }, body: JSON.stringify({ row, trace }) });
    if (!answer.ok) { refused(await answer.text()); return; }
    delete this.kept.changed;
    this.kept.from = name;
    this.store();
    await this.learn();
  },
  // A table of the project can be opened again.
  async close() {
    const closed = this.kept;
    const isLost = closed.changed && closed.row.length;
    if (isLost && await ask(`Close ${closed.name}? What is not saved is lost.`, "Close") === null) return;
    const next = this.others[0]?.name ?? this.project?.find((it) => it !== closed.name);
    if (next) await this.show(next);
    this.others = this.others.filter((it) => it !== closed);
    this.store();
  },
  add(name) {
    if (!name || this.kept.row.some((it) => it.address === name)) return;
    this.kept.row.push({ address: name });
    this.save();
    if (view === this) this.open();
  },
  open() {
    this.rows.clear();
    this.list();
    $("empty").hidden = this.kept.row.length > 0;
    $("watched").replaceChildren(...this.kept.row.map((it) => this.row(it)));
    watch();
    this.update(this.rows.keys());
  },
  row(it) {
    const name = it.address;
    const value = element("td", { className: "value" });
    const type = element("td", { className: "type" });
    const format = element("select", { title: "format", onchange: () => { it.format = format.value || undefined; this.save(); watch(); } });
    const fresh = element("input", { className: "new", placeholder: "value", value: it.modify ?? "", onchange: () => { it.modify = fresh.value.trim() || undefined; this.save(); } });
    fresh.setAttribute("aria-label", `modify value of ${name}`);
    fresh.oninput = () => { fresh.classList.remove("wrong"); fresh.title = ""; };
    const modify = element("form", { onsubmit: (event) => {
      event.preventDefault();
      it.modify = fresh.value.trim() || undefined;
      this.save();
      if (it.modify) send({ do: "modify", ...this.change(it) });
    } }, fresh, " ", element("button", { textContent: "now", title: "modify now, once" }));
    const when = element("select", { title: "when the value is modified in the cycle", onchange: () => {
      const [trigger, every] = TRIGGERS[when.value];
      Object.assign(it, { trigger, "every-cycle": every });
      this.save();
    } }, ...TRIGGERS.map(([trigger, every, text], at) => element("option", { value: String(at), textContent: text,
      selected: trigger === (it.trigger ?? "begin") && every === (it["every-cycle"] ?? false) })));
    const comment = element("input", { className: "comment", placeholder: " ", value: it.comment ?? "", onchange: () => { it.comment = comment.value || undefined; this.save(); } });
    comment.setAttribute("aria-label", `comment of ${name}`);
    const force = element("button", { textContent: "F", title: "force", className: "force", hidden: true,
      onclick: () => askForce(name, live.shown.get(name)?.text ?? "", it.format) });
    const release = element("button", { textContent: "release", className: "release", hidden: true, onclick: () => askRelease(name) });
    const remove = element("button", { textContent: "×", title: "remove", onclick: () => {
      this.kept.row = this.kept.row.filter((other) => other !== it);
      this.save();
      this.open();
    } });
    this.rows.set(name, { it, value, type, format, fresh, force, release, bits: null });
    this.offer(name);
    return element("tr", {}, element("td", { className: "name", textContent: name }), type, element("td", { className: "format" }, format), value,
      element("td", { className: "operate modify" }, modify), element("td", { className: "operate when" }, when),
      element("td", { className: "comment" }, comment), element("td", { className: "buttons" }, element("span", { className: "change" }, force, release), " ", remove));
  },
  // The formats that fit the width of the value.
  offer(name) {
    const row = this.rows.get(name), shown = live.shown.get(name);
    const bits = shown && !shown.wrong ? shown.bits : row.bits ?? 0;
    if (row.bits === bits && row.format.options.length) return;
    row.bits = bits;
    const formats = new Set(FORMATS[bits] ?? []);
    if (row.it.format) formats.add(row.it.format);
    row.format.replaceChildren(element("option", { value: "", textContent: "as its type" }),
      ...[...formats].map((format) => element("option", { value: format, textContent: FORMAT_NAMES[format], selected: format === row.it.format })));
  },
  names() { return this.kept.row.map((it) => it.address); },
  format(name) { return this.kept.row.find((it) => it.address === name)?.format ?? null; },
  change(it) { return { name: it.address, value: it.modify, format: entryFormat(it.address, it.format) }; },
  update(changed) {
    for (const name of changed) {
      const row = this.rows.get(name);
      const shown = live.shown.get(name);
      if (!row) continue;
      row.type.textContent = shown?.type ?? "";
      showValue(row.value, shown);
      row.value.classList.toggle("forced", live.marked.has(name));
      row.force.hidden = !shown?.forcible;
      row.release.hidden = !live.forced.some((it) => it.name === name);
      this.offer(name);
    }
  },
  mark() { if (view === this) this.update(this.rows.keys()); },
  // So many values are still modified in the cycle.
  job(count) {
    $("modify-state").textContent = count ? `${count} ${count === 1 ? "value is" : "values are"} modified in the cycle` : "";
    $("modify-end").hidden = !count;
  },
  // A refusal that begins with a name is about its modify value.
  refused(why) {
    for (const [name, row] of this.rows) {
      if (!why.includes(name) || !row.fresh.value) continue;
      row.fresh.classList.add("wrong");
      row.fresh.title = why;
    }
  },
  due() { return this.kept.row.filter((it) => it.modify); },
  // The file as the CPU's command line has it, too.
  async write() {
    const { row, trace } = this.kept;
    const answer = await fetch("table/file", { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify({ row, trace }) });
    const text = await answer.text();
    if (!answer.ok) { refused(text); return; }
    recording.save(`${this.kept.name || "watch"}.toml`, text);
    return text;
  },
  async read(name, text) {
    const answer = await fetch("table/rows", { method: "POST", body: text });
    if (!answer.ok) { refused(`${name}: ${await answer.text()}`); return; }
    const read = this.table(name.replace(/\.toml$/i, ""), await answer.json());
    if (read) this.turn({ ...read, changed: true });
  },
};
$("add").onsubmit = (event) => {
  event.preventDefault();
  table.add($("name").value.trim());
  $("name").value = "";
};
table.restore();
$("table-name").onchange = () => table.rename($("table-name").value.trim());
$("table-list").onchange = () => table.show($("table-list").value);
$("table-new").onclick = () => table.fresh();
$("table-keep").onclick = () => table.keep();
$("table-close").onclick = () => table.close();
$("table-save").onclick = () => table.write();
$("table-open").onclick = () => $("table-file").click();
$("table-file").onchange = async () => {
  const [file] = $("table-file").files;
  if (file) await table.read(file.name, await file.text());
  $("table-file").value = "";
};
$("table-clear").onclick = async () => {
  if (!table.kept.row.length || await ask("Remove all rows of the table?", "Remove") === null) return;
  table.kept.row = [];
  table.save();
  table.open();
};
$("modify-now").onclick = () => {
  const rows = table.due().map((it) => table.change(it));
  if (rows.length) send({ do: "all", rows }); else refused("no row has a modify value");
};
$("modify-cycle").onclick = () => {
  const rows = table.due().map((it) => ({ ...table.change(it), trigger: it.trigger ?? "begin", every: it["every-cycle"] ?? false }));
  if (rows.length) send({ do: "job", rows }); else refused("no row has a modify value");
};
$("modify-end").onclick = () => send({ do: "job", rows: [] });

// View: what is forced

const forces = {
  rows: new Map(),
  open() {
    const { max, areas } = live.force ?? {};
    $("force-limit").textContent = max ? `${live.forced.length} forced. This CPU forces ${areas} ${max} values. ${live.role === "change" ? "" : "Only a user with the role change may force."}` : "";
    $("no-forces").hidden = !live.told || live.forced.length > 0;
    $("release-all").disabled = !live.forced.length;
    this.rows.clear();
    $("forces").replaceChildren(...live.forced.map((it) => {
      const value = element("td", { className: "value" });
      this.rows.set(it.name, value);
      return element("tr", {}, element("td", { className: "name", textContent: it.name }), element("td", { className: "type", textContent: it.address }),
        element("td", { className: "value forced", textContent: { 0: "FALSE", 1: "TRUE" }[/\.\d$/.test(it.address) ? it.value : ""] ?? it.value }), value, element("td", { textContent: it.comment ?? "" }),
        element("td", { className: "change" }, element("button", { textContent: "change", onclick: () => askForce(it.name, it.value) }), " ",
          element("button", { textContent: "release", onclick: () => askRelease(it.name) })));
    }));
    watch();
    this.update(this.rows.keys());
  },
  names: () => live.forced.map((it) => it.name),
  update(changed) {
    for (const name of changed) if (this.rows.has(name)) showValue(this.rows.get(name), live.shown.get(name));
  },
};
$("force-add").onsubmit = (event) => {
  event.preventDefault();
  const name = $("force-name").value.trim();
  $("force-name").value = "";
  if (name) askForce(name, "");
};
$("release-all").onclick = () => askRelease();
