// What a person sees and does with values, in Chromium: the watch table and its files, forcing, the memory reset, and a small screen.
const { browse, until } = require("./browser.js");

const { readFileSync, writeFileSync } = require("node:fs");

const folder = process.argv[3];
const frame = `document.querySelector("#drawings").contentWindow`;
const page = `${frame}.document`;
const open = (tab, block) => tab(`${frame}.location.hash = "${block}"; ${frame}.fromHash()`);
const show = (tab, view) => tab(`location.hash = "${view}"; 0`);

async function signIn(tab, user) {
  await until(tab, "the question who it is", `document.querySelector("#sign-in")?.open`);
  await tab(`{
    const form = document.querySelector("#sign-in form");
    form.user.value = "${user}"; form.password.value = "riverside"; form.requestSubmit();
  }`);
  await until(tab, user, `document.querySelector("#user")?.textContent === "${user}"`);
  await until(tab, "RUN", `document.querySelector("#state").textContent === "RUN"`);
}

// Answers the question that is open.
async function answer(tab, what, button, value) {
  await until(tab, what, `document.querySelector("#question").open`);
  await tab(`{
    const value = ${JSON.stringify(value ?? null)};
    if (value !== null) document.querySelector("#question-value").value = value;
    document.querySelector("#question ${button}").click();
  }`);
  await until(tab, "that the question has gone", `!document.querySelector("#question").open`);
}

const value = (name) => `table.rows.get("${name}")?.value.textContent`;
const isValue = (tab, name, text) => until(tab, `${name} = ${text}`, `${value(name)} === "${text}"`);
// Chooses a format, as a person does.
async function choose(tab, name, format) {
  await until(tab, `the format ${format} of ${name}`, `[...table.rows.get("${name}").format.options].some((option) => option.value === "${format}")`);
  await tab(`{ const list = table.rows.get("${name}").format; list.value = "${format}"; list.onchange(); }`);
}
const enter = (tab, name, text) => tab(`{ const row = table.rows.get("${name}"); row.fresh.value = "${text}"; row.fresh.oninput(); row.fresh.onchange(); }`);
const modify = (tab, name) => tab(`table.rows.get("${name}").fresh.form.requestSubmit()`);

async function values(tab) {
  await show(tab, "table");
  await tab(`["Big.count", "Big.pattern", "Big.speed", "MW10", "QB4", "I0.0"].forEach((name) => table.add(name))`);

  // More than 53 bits.
  await isValue(tab, "Big.count", "9007199254740993");
  await choose(tab, "Big.count", "hex");
  await isValue(tab, "Big.count", "LW#16#0020000000000001");
  await choose(tab, "Big.count", "dec");
  await enter(tab, "Big.count", "-9007199254740995");
  await modify(tab, "Big.count");
  await isValue(tab, "Big.count", "-9007199254740995");
  await choose(tab, "Big.pattern", "unsigned");
  await isValue(tab, "Big.pattern", "9223372036854775809");

  // Formats that fit the width only, and entries in the format.
  await until(tab, "no S5TIME of 32 bits", `![...table.rows.get("Big.speed").format.options].some((option) => option.value === "s5time")`);
  await choose(tab, "Big.speed", "hex");
  await isValue(tab, "Big.speed", "DW#16#3FC00000");
  await choose(tab, "Big.speed", "real");
  await enter(tab, "Big.speed", "-2");
  await modify(tab, "Big.speed");
  await isValue(tab, "Big.speed", "-2.0");
  await choose(tab, "MW10", "s5time");
  await enter(tab, "MW10", "137");
  await modify(tab, "MW10");
  await isValue(tab, "MW10", "S5T#130ms");
  await choose(tab, "MW10", "bcd");
  await enter(tab, "MW10", "12A");
  await modify(tab, "MW10");
  await until(tab, "why not", `/^MW10: .12A. is not a value in the format/.test(document.querySelector("#refused").textContent)`);
  await until(tab, "where", `table.rows.get("MW10").fresh.classList.contains("wrong")`);

  // In each cycle: after the program, which writes 7.
  await isValue(tab, "QB4", "16#07");
  await enter(tab, "MW10", "120");
  await enter(tab, "QB4", "A5");
  await tab(`{ const when = table.rows.get("QB4").fresh.closest("tr").querySelector(".when select"); when.value = "3"; when.onchange(); }`);
  await tab(`["Big.count", "Big.speed"].forEach((name) => { table.rows.get(name).fresh.value = ""; table.rows.get(name).fresh.onchange(); })`);
  await tab(`document.querySelector("#modify-cycle").click()`);
  await isValue(tab, "QB4", "16#A5");
  await isValue(tab, "MW10", "120");
  await until(tab, "what is modified", `document.querySelector("#modify-state").textContent === "1 value is modified in the cycle"`);
  await tab(`document.querySelector("#modify-end").click()`);
  await isValue(tab, "QB4", "16#07");
  await until(tab, "that nothing is", `document.querySelector("#modify-state").textContent === ""`);
}

// The bounds of curves have no exponents and enough digits, a large number that never changes has a line, and a duration is in seconds.
const curves = (tab) => until(tab, "the bounds of curves", `bound(27648) === "27648" && bound(-29994.5) === "-29994.5" && bound(0.1 + 0.2) === "0.3"
  && range([-9e18], false)[0] < -9e18 && range([1], true)[1] === 1
  && plotted({ type: "TIME", value: "T#-1m2s500ms" }) === -62.5 && plotted({ type: "STRING", value: "T#1s" }) === null`);

const press = (tab, id) => tab(`document.querySelector("#${id}").click()`);
const choice = `[...document.querySelector("#table-list").options].map((it) => it.textContent).join()`;
const isShown = (tab, name, rows) => until(tab, `the table ${name}`, `table.kept.name === "${name}" && document.querySelector("#table-list").value === "${name}" && table.rows.size === ${rows}`);
const turn = (tab, name) => tab(`{ const list = document.querySelector("#table-list"); list.value = "${name}"; list.onchange(); }`);
const rename = (tab, name) => tab(`{ const field = document.querySelector("#table-name"); field.value = "${name}"; field.onchange(); }`);

// Several tables: those of the project and those that a person makes.
async function tables(tab) {
  await show(tab, "table");
  await until(tab, "the tables of the project", `${choice} === "broken,levels,watch"`);
  await turn(tab, "levels");
  await isShown(tab, "levels", 1);
  await until(tab, "the comment", `document.querySelector("#watched .comment input").value === "upper"`);
  await until(tab, "the format", `/^-?[0-9]+$/.test(${value("MW10")})`);
  await tab(`table.add("I0.0")`);
  await until(tab, "the star of what differs from its file", `${choice} === "broken,levels *,watch"`);
  await turn(tab, "watch");
  await isShown(tab, "watch", 6);
  await isValue(tab, "Big.speed", "-2.0");
  await turn(tab, "levels");
  await isShown(tab, "levels", 2);
  await press(tab, "table-keep");
  await until(tab, "no star", `${choice} === "broken,levels,watch"`);

  // A new one, which becomes one of the project.
  await press(tab, "table-new");
  await isShown(tab, "table 1", 0);
  await tab(`table.add("QB4")`);
  await rename(tab, "levels");
  await until(tab, "why not", `/already/.test(document.querySelector("#refused").textContent)`);
  await rename(tab, "../pumps");
  await press(tab, "table-keep");
  await until(tab, "why not", `/cannot be the name of a watch table/.test(document.querySelector("#refused").textContent)`);
  await rename(tab, "pumps");
  await press(tab, "table-keep");
  await until(tab, "four", `${choice} === "broken,levels,pumps,watch"`);

  // The file is changed by somebody else: who has changed nothing sees it.
  await turn(tab, "levels");
  await isShown(tab, "levels", 2);
  const file = `${folder}/pumps.toml`;
  writeFileSync(file, readFileSync(file, "utf8") + '[[row]]\naddress = "I0.0"\n');
  await turn(tab, "pumps");
  await isShown(tab, "pumps", 2);
  await turn(tab, "broken");
  await until(tab, "the line of the mistake", `/broken.toml: line 3: /.test(document.querySelector("#refused").textContent)`);
  await isShown(tab, "pumps", 2);

  // Not in the project: closing it is asked.
  await turn(tab, "watch");
  await press(tab, "table-new");
  await tab(`table.add("QB4")`);
  await press(tab, "table-close");
  await answer(tab, "the question", "button[value='']");
  await isShown(tab, "table 1", 1);
  await press(tab, "table-close");
  await answer(tab, "the question", "#question-yes");
  await until(tab, "that it has gone", `${choice} === "broken,levels,pumps,watch"`);
  await turn(tab, "watch");
  await isShown(tab, "watch", 6);
}

const forced = (selector) => `[...${page}.querySelectorAll("${selector}")].map((part) => part.textContent).join()`;

async function forcing(tab) {
  await show(tab, "table");
  await until(tab, "the button", `table.rows.get("I0.0")?.force.checkVisibility() && !table.rows.get("MW10").force.checkVisibility()`);
  await tab(`table.rows.get("I0.0").force.click()`);
  await answer(tab, "the question", "#question-yes", "1");
  await isValue(tab, "I0.0", "TRUE");
  await until(tab, "the mark in the table", `table.rows.get("I0.0").value.classList.contains("forced")`);
  await until(tab, "the mark in the head", `document.querySelector("#forced").textContent === "F 1" && document.querySelector("#forced").checkVisibility()`);
  await show(tab, "program");
  await until(tab, "the drawings", `${frame}.live !== undefined`);
  await open(tab, "FC2");
  await until(tab, "the mark at the contact", `${forced("text.forced")} === "I0.0" || ${forced("text.forced")} === "%I0.0"`);
  await open(tab, "FC1");
  await until(tab, "the mark in STL", `${forced(".id.forced")} === "I 0.0"`);
  await open(tab, "OB1");
  await until(tab, "the mark in SCL", `${forced(".id.forced")} === "%I0.0"`);

  // What is forced is no modify value of the file; what was entered is.
  const file = await tab(`table.write()`);
  for (const part of ['address = "I0.0"', 'modify = "A5"\ntrigger = "end"\nevery-cycle = true', 'format = "bcd"\nmodify = "120"']) {
    if (!file.includes(part)) throw new Error(`no ${part} in\n${file}`);
  }
  if (/I0.0"\s*modify/.test(file)) throw new Error(file);
  await tab(`table.kept = { name: "other", row: [] }; table.save(); table.read("speed.toml", ${JSON.stringify(file)})`);
  await until(tab, "the rows of the file", `table.kept.name === "speed" && table.kept.row.length === 6 && table.kept.row[4]["every-cycle"]`);
  await tab(`table.read("bad.toml", '[[row]]\\naddress = "MW10"\\nformat = "octal"\\n')`);
  await until(tab, "the line of the mistake", `/^bad.toml: line 3: /.test(document.querySelector("#refused").textContent)`);

  // Another value, one more, and all released.
  await show(tab, "force");
  await until(tab, "the limit", `/inputs and outputs at their modules; at most 200 values/.test(document.querySelector("#force-limit").textContent)`);
  await tab(`document.querySelector("#force-name").value = "MW10"; document.querySelector("#force-add").requestSubmit()`);
  await answer(tab, "the question", "#question-yes", "1");
  await until(tab, "why not", `/neither an input nor an output/.test(document.querySelector("#refused").textContent)`);
  await tab(`document.querySelector("#force-name").value = "QW6"; document.querySelector("#force-add").requestSubmit()`);
  await answer(tab, "the question", "#question-yes", "16#0102");
  await until(tab, "both", `document.querySelectorAll("#forces tr").length === 2`);
  await tab(`document.querySelector("#release-all").click()`);
  await until(tab, "a question that asks for no value", `document.querySelector("#question").open && !document.querySelector("#question-value").checkVisibility()`);
  await answer(tab, "the question", "button[value='']");
  await until(tab, "both as before", `document.querySelectorAll("#forces tr").length === 2`);
  await tab(`document.querySelector("#release-all").click()`);
  await answer(tab, "the question", "#question-yes");
  await until(tab, "nothing", `document.querySelector("#forced").hidden && document.querySelectorAll("#forces tr").length === 0`);
}

// Outputs in STOP, to test the wiring.
async function outputs(tab) {
  const enabled = `document.querySelector("#enabled").checkVisibility()`;
  await tab(`table.add("PQB4")`);
  await until(tab, "the value of the module", `/^16#/.test(${value("PQB4")})`);
  await enter(tab, "PQB4", "A5");
  await modify(tab, "PQB4");
  await until(tab, "why not", `/outputs are disabled/.test(document.querySelector("#refused").textContent)`);
  await press(tab, "outputs");
  await answer(tab, "the question", "#question-yes");
  await until(tab, "that outputs are enabled", enabled);
  await isValue(tab, "PQB4", "16#00");
  await modify(tab, "PQB4");
  await isValue(tab, "PQB4", "16#A5");
  await press(tab, "outputs");
  await until(tab, "that outputs are disabled", `!${enabled}`);
  await isValue(tab, "PQB4", "16#00");
}

async function reset(tab) {
  await show(tab, "table");
  await isValue(tab, "MW10", "120");
  await until(tab, "no memory reset in RUN", `document.querySelector("#reset").hidden`);
  await tab(`send({ do: "reset" })`);
  await until(tab, "why not", `/in STOP only/.test(document.querySelector("#refused").textContent)`);
  await tab(`document.querySelector("#stop").click()`);
  await answer(tab, "the question", "#question-yes");
  await until(tab, "STOP", `document.querySelector("#state").textContent === "STOP"`);
  await tab(`document.querySelector("#reset").click()`);
  await answer(tab, "the question", "#question-yes");
  await isValue(tab, "MW10", "0");
  await until(tab, "the event", `/memory reset/.test(document.querySelector("#events tr")?.textContent)`);
  await until(tab, "STOP as before", `document.querySelector("#state").textContent === "STOP"`);
  await outputs(tab);
  await tab(`document.querySelector("#run").click()`);
  await answer(tab, "the question", "#question-yes");
  await until(tab, "RUN", `document.querySelector("#state").textContent === "RUN"`);
  await show(tab, "cpu-view");
  await until(tab, "the module", `/DI.DQ 32.*I 0 to 7, Q 0 to 7/.test(document.querySelector("#cpu-info").textContent)`);
}

// 390 pixels, as a phone has them: nothing is wider than the screen.
async function small(tab) {
  await tab.call("Emulation.setDeviceMetricsOverride", { width: 390, height: 844, deviceScaleFactor: 2, mobile: true });
  for (const view of ["variables", "table", "force", "curves", "recording", "cpu-view", "buffer", "program"]) {
    await show(tab, view);
    await until(tab, `${view} within the screen`, `document.documentElement.scrollWidth <= 390 && document.querySelector("main").scrollWidth <= 390`);
    const button = `document.querySelector("nav [aria-current]").getBoundingClientRect()`;
    await until(tab, `the name of ${view}`, `${button}.left > -1 && ${button}.right < 391`);
  }
  await show(tab, "recording");
  await tab(`document.querySelector("#trigger").append(new Option("when ${"a long name ".repeat(8)}", "99"))`);
  await until(tab, "a list of long names within the screen", `document.querySelector("main").scrollWidth <= 390`);
  await show(tab, "program");
  await open(tab, "FC1");
  const line = `[...${page}.querySelectorAll(".ln")].find((line) => /=\\s+Q 0.0/.test(line.firstChild.textContent))`;
  await until(tab, "the status below the line", `/^ 0   0/.test(${line}?.lastChild.textContent) && ${line}.lastChild.getBoundingClientRect().top > ${line}.firstChild.getBoundingClientRect().top`);
  await until(tab, "no wider than the screen", `${page}.querySelector("main").scrollWidth <= 390 && ${page}.querySelector(".code").scrollWidth <= 390`);
  const more = `${line}.querySelector(".more").checkVisibility()`;
  await until(tab, "what the most important columns are", `!${more}`);
  await tab(`${line}.click()`);
  await until(tab, "all columns", more);
}

async function look(tab) {
  await signIn(tab, "ben");
  await values(tab);
  await curves(tab);
  await tables(tab);
  await until(tab, "nothing to force with", `!document.querySelector(".force")?.checkVisibility() && document.querySelector("#orders").hidden`);
  await tab(`send({ do: "force", name: "I0.0", value: "1" })`);
  await until(tab, "why not", `/role .change./.test(document.querySelector("#refused").textContent)`);
  await tab(`document.querySelector("#sign-out").click()`);
  await signIn(tab, "anna");
  await forcing(tab);
  await reset(tab);
  await small(tab);
}

browse(look);
