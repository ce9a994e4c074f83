// What a person sees of a program that is watched while it runs, in Chromium. The second argument is the process of the program, the third one its file.
const { spawn } = require("node:child_process");
const { browse, until, sleep } = require("./browser.js");

const frame = `document.querySelector("#drawings").contentWindow`;
const page = `${frame}.document`;

// Opens the page of a block.
const open = (tab, block) => tab(`${frame}.location.hash = "${block}"; ${frame}.fromHash()`);
// The parts of a network that a selector finds, as a list.
const parts = (network, selector) => `[...${page}.querySelectorAll("section")[${network - 1}].querySelectorAll("${selector}")].map((part) => part.getAttribute("class"))`;
// What is beside the line of code that contains a text.
const beside = (text) => `[...${page}.querySelectorAll(".ln")].find((line) => line.firstChild.textContent.replace(/\\s+/g, " ").includes(${JSON.stringify(text)}))?.lastChild.textContent`;

async function look(tab) {
  await until(tab, "RUN", `document.querySelector("#state").textContent === "RUN"`);
  await until(tab, "the drawings", `${frame}.live !== undefined`);

  // M0.0 is 1 between two networks only: at the end of each cycle it is 0.
  await open(tab, "OB1");
  await until(tab, "the status of OB 1", `/^OB 1 in cycle/.test(document.querySelector("#status-seen").textContent)`);
  await until(tab, "the contact of a bit that is 1 for a moment", `${parts(2, "path.g")}[0] === "g on"`);
  await until(tab, "power at the lamp", `${parts(2, "path.w")}.every((wire) => wire === "w on")`);
  await tab(`location.hash = "table"; table.add("M0.0"); 0`);
  await until(tab, "the bit at the end of the cycle", `table.rows.get("M0.0")?.value.textContent === "FALSE"`);
  await tab(`location.hash = "program"`);

  // One of two instances.
  await open(tab, "FB1");
  await until(tab, "the first instance", `/DB 1 "First"/.test(document.querySelector("#status-seen").textContent)`);
  const sum = `[...${page}.querySelectorAll("text.v")].some((text) => text.textContent === "`;
  await until(tab, "its sum", `${sum}6")`);
  await until(tab, "elements of an array at its pins", `${sum}40") && ${sum}45")`);
  await until(tab, "both calls", `[...document.querySelector("#status-call").options].length === 3`);
  await tab(`{
    const call = document.querySelector("#status-call");
    call.value = [...call.options].find((option) => /Second/.test(option.value)).value;
    call.onchange();
  }`);
  await until(tab, "the sum of the other one", `${sum}105") && !${sum}6")`);
  await until(tab, "its name", `/DB 2 "Second"/.test(document.querySelector("#status-seen").textContent)`);
  // A long value does not lose its first digits at the edge of the drawing.
  await tab(`${frame}.tell(${page}.querySelector("text.v"), "-2147483648")`);
  await until(tab, "all of a long value", `(() => {
    const value = ${page}.querySelector("text.v");
    return value.textContent === "-2147483648" && value.getBBox().width < value.room + 1;
  })()`);

  // Constants are drawn, and compared, as their author wrote them.
  for (const [text, value] of [["TIME#1m_30s", 90000], ["t#1m30s", 90000], ["S5TIME#2s", 2000], ["S5T#2s", 2000], ["int#-7", -7], ["1_000", 1000]]) {
    await until(tab, text, `${frame}.number(${JSON.stringify(text)}, false) === ${value}`);
  }

  // A value is shown in its type even while the status is off.
  await tab(`document.querySelector("#status-on").click()`);
  await until(tab, "a component of a data block", `${sum}105")`);
  await tab(`document.querySelector("#status-on").click()`);

  // A data block has no status.
  await open(tab, "DB1");
  await until(tab, "no status of a data block", `document.querySelector("#status-bar").hidden`);

  // STL: ACCU1 and RLO beside the lines; MW10 is 0 again at the end.
  await open(tab, "FC2");
  await until(tab, "the status of a block again", `!document.querySelector("#status-bar").hidden`);
  await until(tab, "ACCU1 after the first statement", `/^ 0 .*00001234 00000000/.test(${beside("L W#16#1234")} ?? "")`);
  await until(tab, "the RLO of the input", `/^ 1   1 /.test(${beside("A I 0.0")} ?? "")`);

  // SCL: the values of the variables of a line.
  await open(tab, "FC1");
  await until(tab, "a value before it changes", `/#level = 7 .*result TRUE/.test(${beside("IF #level")} ?? "")`);
  await until(tab, "a value that is written", `/#level := 14/.test(${beside("#level * 2")} ?? "")`);

  // A chart: the active step, its time, and the condition that it waits for.
  await open(tab, "FB2");
  await until(tab, "the active step", `${page}.querySelectorAll("rect.act").length === 1`);
  await until(tab, "its name, by which the CPU tells its state", `${frame}.nameOf(${page}.querySelector("rect.act")) === "Filling"`);
  await until(tab, "its time", `/^Filling\\d+\\.\\d s/.test(${page}.querySelector(".steps tr:nth-child(2)")?.textContent ?? "")`);
  await until(tab, "what is forced", `[...${page}.querySelectorAll("text.forced")].map((text) => text.textContent).join() === "I0.7"`);
  await until(tab, "the condition", `${page}.querySelectorAll("path.w.off").length > 0`);
  await until(tab, "the time that it compares", `[...${page}.querySelectorAll("text.v")].some((text) => /^T#\\d/.test(text.textContent))`);
  // The last wire leads to the coil of the last transition: after a contact and beside it a comparison.
  await until(tab, "that nothing flows", `[...${page}.querySelectorAll("path.w:not([data-o])")].pop().getAttribute("class") === "w off"`);

  // A chart whose steps change: from when on they were active, and for how long.
  await open(tab, "FB3");
  const history = `[...${page}.querySelectorAll(".history tr")].map((row) => row.textContent)`;
  await until(tab, "a step that was left", `${history}.some((row) => /^Bright\\d\\d:\\d\\d:\\d\\d\\.\\d{3}0\\.3\\d\\d s\\d+$/.test(row))`);
  await until(tab, "the active one above it", `/active\\d+$/.test(${history}[1]) && !/active/.test(${history}[2])`);

  // Each cycle of a value that changes all the time, with what was before an event.
  await tab(`location.hash = "table"; table.add("MW30"); 0`);
  await until(tab, "the value", `live.shown.has("MW30") && live.shown.has("M0.0")`);
  await tab(`location.hash = "recording"; 0`);
  await until(tab, "the event that begins it", `document.querySelector("#trigger").options.length === 3`);
  await tab(`{
    // Half a second from now, so that there are cycles before it.
    window.level = Math.max(30, (live.shown.get("MW30").value + 256) % 512);
    document.querySelector("#trigger").value = "1"; document.querySelector("#level").value = String(level);
    document.querySelector("#samples").value = "100"; recording.start();
  }`);
  await until(tab, "a complete recording", `/complete, 100 samples/.test(document.querySelector("#record-state").textContent)`);
  // Samples before the event, of cycles that follow each other, and the same in both files.
  await until(tab, "what was before the event", `recording.before === 20 && recording.samples[20][3] === level`);
  await until(tab, "no cycle left out", `recording.samples.every(([cycle], i) => i === 0 || cycle === recording.samples[i - 1][0] + 1)`);
  await until(tab, "a table", `recording.csv().split("\\n")[21].endsWith("," + level)`);
  await until(tab, "a dump", `new RegExp("#\\\\d+\\\\nr" + level + ' "').test(recording.vcd())`);

  await tab(`location.hash = "cpu-view"; 0`);
  await until(tab, "times of cycles", `document.querySelectorAll(".bars i").length > 0`);

  // The place of an event leads to its network.
  await tab(`location.hash = "buffer"; 0`);
  await until(tab, "the fault with its line", `/^Words \\(FC 2\\), network 2, .*words.stl:23$/.test(document.querySelector("#events a")?.textContent ?? "")`);
  await tab(`document.querySelector("#events a").click()`);
  await until(tab, "the network of the fault", `/^#FC2\\/1$/.test(${frame}.location.hash)`);
  // Where a value is used.
  await tab(`program.uses("M0.0"); 0`);
  await until(tab, "the uses of a bit", `/OB 1, network 1: writes.*OB 1, network 2: reads/.test(${page}.querySelector("#uses").textContent)`);

  // The program ends.
  process.kill(Number(process.argv[3]), "SIGKILL");
  await until(tab, "that the connection is lost", `!document.querySelector("#lost").hidden`);
  // It is away for longer than one attempt to reach it, and comes back.
  await sleep(3000);
  const again = spawn(process.argv[4], ["--web", process.argv[2], "--quiet"], { stdio: "ignore" });
  try {
    await until(tab, "the program again", `document.querySelector("#state").textContent === "RUN" && document.querySelector("#lost").hidden`);
    // Nothing is forced now, and the status is that of the new process.
    await until(tab, "what it has forced", `document.querySelector("#forced").hidden`);
    await tab(`location.hash = "program"; 0`);
    await until(tab, "the drawings", `${frame}.live !== undefined`);
    await open(tab, "OB1");
    await until(tab, "the status of OB 1", `/^OB 1 in cycle/.test(document.querySelector("#status-seen").textContent)`);
  } finally {
    again.kill("SIGKILL");
  }
}

browse(look);
