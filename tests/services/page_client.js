// What a person sees on the page, in Chromium: signs in, modifies an input, and looks at the networks.
const { spawn } = require("node:child_process");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const WebSocket = require("ws");

const address = `http://127.0.0.1:${process.argv[2]}/`;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), "plcc-page-"));
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

async function main() {
  const flags = ["--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0", "--window-size=1200,800", `--user-data-dir=${folder}`];
  const browser = spawn("chromium", [...flags, "about:blank"], { stdio: "ignore" });
  try {
    await look(await connect());
    console.log("done");
  } finally {
    browser.kill("SIGKILL");
    fs.rmSync(folder, { recursive: true, force: true, maxRetries: 5, retryDelay: 100 });
  }
}

// The first tab, as a function that evaluates an expression there.
async function connect() {
  const told = path.join(folder, "DevToolsActivePort");
  for (let i = 0; i < 300 && !(fs.existsSync(told) && fs.readFileSync(told, "utf8").includes("\n")); i++) await sleep(100);
  const port = fs.readFileSync(told, "utf8").split("\n")[0];
  const tabs = await (await fetch(`http://127.0.0.1:${port}/json`)).json();
  const socket = new WebSocket(tabs.find((tab) => tab.type === "page").webSocketDebuggerUrl);
  await new Promise((resolve) => socket.on("open", resolve));
  let last = 0;
  const call = (method, params) => new Promise((resolve) => {
    const id = ++last;
    const answer = (data) => {
      const message = JSON.parse(data);
      if (message.id !== id) return;
      socket.off("message", answer);
      resolve(message.result);
    };
    socket.on("message", answer);
    socket.send(JSON.stringify({ id, method, params }));
  });
  await call("Page.navigate", { url: address });
  return async (expression) => {
    const { result, exceptionDetails } = await call("Runtime.evaluate", { expression, awaitPromise: true });
    if (exceptionDetails) throw new Error(`${expression}: ${exceptionDetails.exception?.description}`);
    return result.value;
  };
}

// Waits until something is seen.
async function until(tab, what, expression) {
  let seen;
  for (let i = 0; i < 100; i++) {
    try {
      seen = await tab(expression);
      if (seen === true) return;
    } catch (error) {
      seen = error.message;
    }
    await sleep(100);
  }
  throw new Error(`${what}: not seen, but ${seen}`);
}

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

  const drawn = (text) => `(() => {
    const page = document.querySelector("#drawings").contentDocument;
    const wires = [...page.querySelectorAll("path.w")].map((wire) => wire.getAttribute("class"));
    return wires.length > 1 && wires.${text};
  })()`;
  await until(tab, "the rung without power after its contact", drawn(`some((wire) => wire === "w off")`));
  await tab(`{ location.hash = "table"; table.add("I0.0"); table.add("Values.level"); table.add("Nothing"); }`);
  await until(tab, "a value of its type", `table.rows.get("Values.level")?.value.textContent === "1.5"`);
  await until(tab, "the name that is unknown", `/neither an address/.test(table.rows.get("Nothing")?.value.textContent)`);
  await tab(`{
    const form = table.rows.get("I0.0").value.parentElement.querySelector("form");
    form.querySelector("input").value = "1"; form.requestSubmit();
  }`);
  await until(tab, "the input", `table.rows.get("I0.0").value.textContent === "TRUE"`);
  await tab(`location.hash = "program"`);
  await until(tab, "the rung with power", drawn(`every((wire) => wire === "w on")`));

  // She may change values, but not stop the CPU.
  await tab(`send({ do: "stop" })`);
  await until(tab, "why not", `/role/.test(document.querySelector("#refused").textContent)`);
  await until(tab, "RUN as before", `document.querySelector("#state").textContent === "RUN"`);
}

main().catch((error) => {
  console.error(error);
  process.exitCode = 1;
});
