// What a person sees on the page, in Chromium: signs in, modifies an input, and looks at the networks.
const { browse, until } = require("./browser.js");

async function look(tab) {
  await until(tab, "the question who it is", `document.querySelector("#sign-in").open`);
  const signIn = (password) => tab(`{
    const form = document.querySelector("#sign-in form");
    form.user.value = "anna"; form.password.value = "${password}"; form.requestSubmit();
  }`);
  await signIn("not the password");
  await until(tab, "the refusal", `!document.querySelector("#wrong").hidden`);
  await signIn("riverside");
  await until(tab, "RUN", `document.querySelector("#state").textContent === "RUN"`);
  await until(tab, "the user", `document.querySelector("#user").textContent === "anna"`);

  // The address of the page names the view, and must not scroll the state of the CPU away.
  await tab(`location.hash = "program"`);
  await until(tab, "the head above the networks", `(() => {
    const [head, frame] = [document.querySelector("header"), document.querySelector("#drawings")].map((it) => it.getBoundingClientRect());
    return head.top === 0 && frame.height > 300 && frame.bottom <= innerHeight;
  })()`);

  const drawn = (text) => `(() => {
    const page = document.querySelector("#drawings").contentDocument;
    const wires = [...page.querySelectorAll("path.w")].map((wire) => wire.getAttribute("class"));
    return wires.length > 1 && wires.${text};
  })()`;
  await until(tab, "the rung without power after its contact", drawn(`some((wire) => wire === "w off")`));
  await tab(`{ location.hash = "table"; table.add("I0.0"); table.add("Values.level"); table.add("Nothing"); table.add("DB9.DBW0"); }`);
  await until(tab, "a value of its type", `table.rows.get("Values.level")?.value.textContent === "1.5"`);
  await until(tab, "a block that is not there", `table.rows.get("DB9.DBW0")?.value.textContent === "(DB 9 is not loaded)"`);
  await until(tab, "the name that is unknown", `/neither an address/.test(table.rows.get("Nothing")?.value.textContent)`);
  await tab(`{
    const form = table.rows.get("I0.0").value.parentElement.querySelector("form");
    form.querySelector("input").value = "1"; form.requestSubmit();
  }`);
  await until(tab, "the input", `table.rows.get("I0.0").value.textContent === "TRUE"`);
  await tab(`location.hash = "program"`);
  await until(tab, "the rung with power", drawn(`every((wire) => wire === "w on")`));

  // The reference data, as plcc xref has them.
  const page = `document.querySelector("#drawings").contentDocument`;
  const open = (view) => tab(`${page}.querySelector('[data-view="${view}"]').click()`);
  const row = (text) => `[...${page}.querySelectorAll("main tr")].some((row) => row.textContent === "${text}")`;
  await open("addresses");
  await until(tab, "where an input is used", row("I0.0OB1/2 R"));
  await open("assignment");
  await until(tab, "its byte", row("IB0X"));
  await open("symbols");
  await until(tab, "that it has no symbol", row("I0.01"));
  await open("calls");
  await until(tab, "who calls FC 7", `/OB1[^]*FC7[^]*local data/.test(${page}.querySelector("main").textContent)`);
  await open("addresses");
  await tab(`[...${page}.querySelectorAll("main tr")].find((row) => row.textContent.startsWith("I0.0")).querySelector("a").click()`);
  await until(tab, "the network of the use", `/^#OB1.1$/.test(document.querySelector("#drawings").contentWindow.location.hash)`);

  // The list of variables leads to the uses of a component of a data block.
  await tab(`program.uses("Values.cycles")`);
  await until(tab, "the uses of a component", `/Values.cycles DB2.DBD0\\s*OB 1, network 1/.test(${page}.querySelector("aside").textContent)`);

  // The head of the list of variables is as wide as its rows.
  await tab(`location.hash = "variables"; 0`);
  const cells = (row) => `document.querySelector("#variables ${row}")?.cells.length`;
  await until(tab, "a cell above each column", `${cells("tbody tr")} > 0 && ${cells("tbody tr")} === ${cells("thead tr")}`);

  // Before the CPU has said what is forced, the page does not say that nothing is.
  const claim = `document.querySelector("#no-forces").hidden`;
  await tab(`location.hash = "force"; 0`);
  await until(tab, "that nothing is forced", `!${claim}`);
  await tab(`live.told = false; forces.open(); 0`);
  await until(tab, "no such words", claim);
  await tab(`live.told = true; forces.open(); 0`);
  await until(tab, "the words again", `!${claim}`);

  // She may change values, but not stop the CPU.
  await tab(`send({ do: "stop" })`);
  await until(tab, "why not", `/role/.test(document.querySelector("#refused").textContent)`);
  await until(tab, "RUN as before", `document.querySelector("#state").textContent === "RUN"`);
}

browse(look);
