// A browser without a window, and what a person sees in it.
const { spawn } = require("node:child_process");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const WebSocket = require("ws");

const address = `http://127.0.0.1:${process.argv[2]}/`;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), "plcc-page-"));
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

// Opens the page and lets `look` have a tab: a function that evaluates an expression there, with `tab.call` for other commands.
async function browse(look) {
  const flags = ["--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0", "--window-size=1200,800", `--user-data-dir=${folder}`];
  const browser = spawn("chromium", [...flags, "about:blank"], { stdio: "ignore", detached: true });
  try {
    await look(await connect());
    console.log("done");
  } catch (error) {
    console.error(error);
    process.exitCode = 1;
  } finally {
    const ended = new Promise((resolve) => browser.once("exit", resolve));
    // With its processes, which write into the folder too.
    process.kill(-browser.pid, "SIGKILL");
    await ended;
    fs.rmSync(folder, { recursive: true, force: true, maxRetries: 5, retryDelay: 100 });
  }
}

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
  const tab = async (expression) => {
    const { result, exceptionDetails } = await call("Runtime.evaluate", { expression, awaitPromise: true });
    if (exceptionDetails) throw new Error(`${expression}: ${exceptionDetails.exception?.description}`);
    return result.value;
  };
  return Object.assign(tab, { call });
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

module.exports = { browse, until, sleep };
