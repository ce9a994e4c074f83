// The extension: starts the language server, runs plcc, and shows what became of assertions.
"use strict";

const { execFile } = require("node:child_process");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");
const { assertions, outcomes, sameFile, commands } = require("./results");

const LANGUAGES = ["plc-stl", "plc-scl", "plc-sd", "plc-graph"];
const PATTERN = "**/*.{stl,awl,scl,s7dcl,gr7}";
let client;

function plcc() {
  return vscode.workspace.getConfiguration("plcc").get("path", "plcc");
}

/** Runs plcc; resolves to its exit code and what it wrote. */
function run(args, folder, token) {
  return new Promise((resolve) => {
    const done = (error, stdout, stderr) => resolve({ code: error ? (error.code ?? 1) : 0, stdout, stderr });
    const child = execFile(plcc(), args, { cwd: folder, maxBuffer: 64 << 20 }, done);
    token?.onCancellationRequested(() => child.kill());
  });
}

/** The folder of the project around a file, or the file itself. */
function programOf(file) {
  for (let folder = path.dirname(file); ; folder = path.dirname(folder)) {
    if (fs.existsSync(path.join(folder, "plc.toml"))) return folder;
    if (folder === path.dirname(folder)) return file;
  }
}

async function activate(context) {
  const documents = LANGUAGES.map((language) => ({ scheme: "file", language }));
  client = new LanguageClient("plcc", "plcc", { command: plcc(), args: ["lsp"] }, {
    documentSelector: documents,
    synchronize: { fileEvents: vscode.workspace.createFileSystemWatcher("**/*.{stl,awl,scl,db,udt,s7dcl,gr7,toml,sdf,asc,xml,xlsx,s7res}") },
  });
  await client.start().catch((error) => {
    vscode.window.showErrorMessage(`plcc does not start; set plcc.path to the command: ${error.message ?? error}`);
  });
  const terminal = (words, folder) => {
    const execution = new vscode.ProcessExecution(plcc(), words, { cwd: folder });
    const task = new vscode.Task({ type: "plcc" }, vscode.TaskScope.Workspace, words[0], "plcc", execution);
    return vscode.tasks.executeTask(task);
  };
  const withProgram = (action) => () => {
    const file = vscode.window.activeTextEditor?.document.uri.fsPath;
    if (!file) return vscode.window.showInformationMessage("Open a source first.");
    return action(programOf(file), path.dirname(file));
  };
  const monitor = async () => {
    const prompt = "Where the page of the process is: the address given with --web";
    const address = await vscode.window.showInputBox({ prompt, value: "127.0.0.1:8080" });
    return address && terminal(["monitor", address.trim()]);
  };
  // A command that this plcc does not have says so.
  const ifPresent = (name, action) => async () => {
    const help = await run(["--help"], undefined);
    if (commands(help.stdout).includes(name)) return action();
    return vscode.window.showInformationMessage(`This plcc has no command \`${name}\`.`);
  };
  context.subscriptions.push(
    vscode.commands.registerCommand("plcc.build", withProgram((program, folder) => terminal(["build", program], folder))),
    vscode.commands.registerCommand("plcc.test", withProgram((program, folder) => terminal(["test", program], folder))),
    vscode.commands.registerCommand("plcc.view", ifPresent("view", withProgram(view))),
    vscode.commands.registerCommand("plcc.monitor", ifPresent("monitor", monitor)),
    explorer(),
    ...debuggers(),
  );
}

/** Shows the networks, charts and data of a program in a panel beside the text. */
async function view(program, folder) {
  const room = fs.mkdtempSync(path.join(os.tmpdir(), "plcc-view-"));
  const page = path.join(room, "view.html");
  const result = await run(["view", program, "--html", page], folder);
  try {
    const html = fs.readFileSync(page, "utf8");
    const where = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
    const options = { enableScripts: true, enableFindWidget: true };
    const panel = vscode.window.createWebviewPanel("plcc.view", `Networks: ${path.basename(program)}`, where, options);
    panel.webview.html = html;
  } catch {
    vscode.window.showErrorMessage(result.stderr || "plcc did not draw the program.");
  } finally {
    fs.rmSync(room, { recursive: true, force: true });
  }
}

/** The debugger is `plcc debug`; two commands are for cycles, which other programs do not have. */
function debuggers() {
  const ask = (request, values) => vscode.debug.activeDebugSession?.customRequest(request, values);
  const gotoCycle = async () => {
    const text = await vscode.window.showInputBox({ prompt: "The cycle, 0 for startup; earlier ones as well" });
    if (text && /^\d+$/.test(text.trim())) return ask("plcc/gotoCycle", { cycle: Number(text) });
  };
  const configuration = (folder, given) =>
    given.type ? given : { type: "plcc", request: "launch", name: "PLC program", program: folder?.uri.fsPath, stopOnEntry: true };
  return [
    vscode.debug.registerDebugAdapterDescriptorFactory("plcc", {
      createDebugAdapterDescriptor: (session) =>
        new vscode.DebugAdapterExecutable(plcc(), ["debug"], { cwd: session.workspaceFolder?.uri.fsPath }),
    }),
    vscode.debug.registerDebugConfigurationProvider("plcc", { resolveDebugConfiguration: configuration }),
    vscode.commands.registerCommand("plcc.cycle", () => ask("plcc/cycle")),
    vscode.commands.registerCommand("plcc.gotoCycle", gotoCycle),
  ];
}

/** The test explorer: each source with assertions, and each assertion in it. */
function explorer() {
  const controller = vscode.tests.createTestController("plcc", "PLC assertions");
  const renew = (uri, text) => {
    const places = assertions(text);
    if (places.length === 0) return controller.items.delete(uri.toString());
    const item = controller.createTestItem(uri.toString(), vscode.workspace.asRelativePath(uri), uri);
    for (const place of places) {
      const child = controller.createTestItem(`${uri}#${place.line}`, place.text, uri);
      child.range = new vscode.Range(place.line, 0, place.line, 1000);
      item.children.add(child);
    }
    controller.items.add(item);
  };
  const read = async (uri) => {
    const bytes = await vscode.workspace.fs.readFile(uri);
    renew(uri, Buffer.from(bytes).toString("utf8"));
  };
  const watcher = vscode.workspace.createFileSystemWatcher(PATTERN);
  watcher.onDidCreate(read);
  watcher.onDidChange(read);
  watcher.onDidDelete((uri) => controller.items.delete(uri.toString()));
  controller.resolveHandler = async (item) => {
    if (!item) await Promise.all((await vscode.workspace.findFiles(PATTERN)).map(read));
  };
  controller.createRunProfile("Run", vscode.TestRunProfileKind.Run, async (request, token) => {
    const test = controller.createTestRun(request);
    const all = request.include ?? [...controller.items].map(([, item]) => item);
    const files = new Set(all.map((item) => item.parent ?? item));
    for (const item of files) {
      if (token.isCancellationRequested) break;
      item.children.forEach((child) => test.started(child));
      await runFile(test, item, token);
    }
    test.end();
  }, true);
  return vscode.Disposable.from(controller, watcher);
}

async function runFile(test, item, token) {
  const file = item.uri.fsPath;
  const folder = path.dirname(file);
  const result = await run(["test", "--json", programOf(file)], folder, token);
  let report;
  try {
    report = JSON.parse(result.stdout);
  } catch {
    item.children.forEach((child) => test.errored(child, new vscode.TestMessage(result.stderr || "plcc did not run")));
    return;
  }
  const places = [];
  item.children.forEach((child) => places.push({ line: child.range.start.line, child }));
  for (const one of outcomes(report, places, (name) => sameFile(folder, name, file))) {
    if (one.state === "passed") {
      test.passed(one.child);
      continue;
    }
    const message = one.expected === undefined
      ? new vscode.TestMessage(one.message)
      : vscode.TestMessage.diff(one.message, one.expected, one.found);
    message.location = new vscode.Location(item.uri, one.child.range);
    if (one.state === "errored") test.errored(one.child, message);
    else test.failed(one.child, message);
  }
}

function deactivate() {
  return client?.stop();
}

module.exports = { activate, deactivate };
