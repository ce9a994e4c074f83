// The extension itself with this plcc, in an editor that is not there: see mock/vscode.js. Needs the environment variable PLCC and
// what `npm ci` installs.
"use strict";

const assert = require("node:assert");
const { execFileSync } = require("node:child_process");
const fs = require("node:fs");
const Module = require("node:module");
const os = require("node:os");
const path = require("node:path");
const { after, before, describe, test } = require("node:test");
const { pathToFileURL } = require("node:url");

const ROOT = path.join(__dirname, "..");
const installed = fs.existsSync(path.join(ROOT, "node_modules", "vscode-languageserver-protocol"));
const skip = !process.env.PLCC ? "PLCC does not name the command" : !installed ? "`npm ci` has not been run" : false;

const SOURCE = `FUNCTION FC 1 : VOID
VAR_TEMP
  count : INT;
END_VAR
BEGIN
NETWORK
      A     I     0.0;
      =     Q     0.0;
      L     5;
      T     #count;
END_FUNCTION

ORGANIZATION_BLOCK OB 1
BEGIN
NETWORK
      CALL  FC    1;
      L     2;
//@ assert ACCU1 == 2
//@ assert ACCU1 == 3
END_ORGANIZATION_BLOCK
`;

describe("the extension in an editor", { skip }, () => {
  let extension, seen, person, clients, lsp, client, file, uri;

  before(async () => {
    const mock = require("./mock/vscode");
    const mockClient = require("./mock/client");
    ({ seen, person } = mock);
    ({ clients, lsp } = mockClient);
    const load = Module._load;
    Module._load = (name, ...rest) => {
      if (name === "vscode") return mock.vscode;
      if (name === "vscode-languageclient/node") return mockClient;
      return load(name, ...rest);
    };
    extension = require("../src/extension");
    Module._load = load;
    person.command = process.env.PLCC;
    person.folder = fs.mkdtempSync(path.join(os.tmpdir(), "plcc-extension-"));
    file = path.join(person.folder, "main.stl");
    fs.writeFileSync(file, SOURCE);
    uri = pathToFileURL(file).href;
    person.file = file;
    await extension.activate({ subscriptions: [] });
    client = clients[0];
    await client.open(uri, "plc-stl", SOURCE);
  });

  after(async () => {
    await extension.deactivate();
    fs.rmSync(person.folder, { recursive: true, force: true });
    assert.strictEqual(client.code, 0, "the server ends as it is asked to");
  });

  const at = (text, after = 0) => {
    const lines = SOURCE.slice(0, SOURCE.indexOf(text) + after).split("\n");
    return { line: lines.length - 1, character: lines.at(-1).length };
  };
  const ask = (type, position, more = {}) =>
    client.connection.sendRequest(type.type, { textDocument: { uri }, position, ...more });

  test("has the commands of its manifest", () => {
    const { contributes } = JSON.parse(fs.readFileSync(path.join(ROOT, "package.json"), "utf8"));
    assert.deepStrictEqual([...seen.commands.keys()].sort(), contributes.commands.map((one) => one.command).sort());
  });

  test("asks the server for all languages of its manifest", () => {
    const { contributes } = JSON.parse(fs.readFileSync(path.join(ROOT, "package.json"), "utf8"));
    const selected = client.options.documentSelector.map((one) => one.language).sort();
    assert.deepStrictEqual(selected, contributes.languages.map((one) => one.id).sort());
    for (const [name, value] of Object.entries({ hoverProvider: true, definitionProvider: true, referencesProvider: true })) {
      assert.deepStrictEqual(Boolean(client.capabilities[name]), value, name);
    }
  });

  test("shows messages while typing, and takes them back", async () => {
    await client.change(uri, 2, SOURCE.replace("A     I     0.0;", "A     MW    0;"));
    const [message] = await client.messages(uri, (list) => list.length > 0);
    assert.strictEqual(message.code, "P0203");
    assert.deepStrictEqual(message.range.start.line, at("A     I     0.0").line);
    await client.change(uri, 3, SOURCE);
    assert.deepStrictEqual(await client.messages(uri, (list) => list.length === 0), []);
  });

  test("answers hover, definition, references, completion and rename", async () => {
    const hover = await ask(lsp.HoverRequest, at("A     I"));
    assert.match(JSON.stringify(hover.contents), /RLO/);
    const definition = await ask(lsp.DefinitionRequest, at("#count", 2));
    const found = Array.isArray(definition) ? definition[0] : definition;
    assert.strictEqual((found.range ?? found.targetRange).start.line, at("count : INT").line);
    const uses = await ask(lsp.ReferencesRequest, at("#count", 2), { context: { includeDeclaration: true } });
    assert.deepStrictEqual(uses.map((one) => one.range.start.line).sort(), [at("count : INT").line, at("#count").line]);
    const proposals = await ask(lsp.CompletionRequest, at("#count", 1));
    const labels = (proposals.items ?? proposals).map((one) => one.label);
    assert.ok(labels.some((label) => label.includes("count")), labels.join());
    const edit = await ask(lsp.RenameRequest, at("#count", 2), { newName: "total" });
    const changes = edit.changes?.[uri] ?? edit.documentChanges.flatMap((one) => one.edits);
    assert.deepStrictEqual(changes.map((one) => one.newText.replace("#", "")), ["total", "total"]);
  });

  test("shows what became of each assertion in its place", async () => {
    const [explorer] = seen.controllers;
    await explorer.resolveHandler(undefined);
    assert.strictEqual(explorer.items.size, 1);
    const [[, item]] = [...explorer.items];
    const lines = [];
    item.children.forEach((child) => lines.push(child.range.start.line));
    const [good, bad] = [at("//@ assert ACCU1 == 2").line, at("//@ assert ACCU1 == 3").line];
    assert.deepStrictEqual(lines, [good, bad]);
    await explorer.profiles[0].run({ include: undefined }, { isCancellationRequested: false, onCancellationRequested() {} });
    const [run] = seen.runs;
    assert.ok(run.ended);
    assert.strictEqual(run.states.get(good).state, "passed");
    const { state, message } = run.states.get(bad);
    assert.strictEqual(state, "failed");
    assert.strictEqual(message.location.range.start.line, bad);
    assert.strictEqual(message.location.uri.fsPath, file);
    assert.match(message.actualOutput, /2/);
    assert.match(message.expectedOutput, /3/);
  });

  test("shows the networks beside the text", async () => {
    await seen.commands.get("plcc.view")();
    const panel = seen.panels.at(-1);
    assert.ok(panel, seen.messages.join());
    assert.strictEqual(panel.title, "Networks: main.stl");
    assert.ok(panel.options.enableScripts);
    assert.match(panel.webview.html, /^<!DOCTYPE html>/);
    assert.match(panel.webview.html, /FC 1/);
  });

  test("builds and tests in a terminal", async () => {
    seen.tasks.length = 0;
    await seen.commands.get("plcc.build")();
    await seen.commands.get("plcc.test")();
    assert.deepStrictEqual(seen.tasks.map((task) => task.args), [["build", file], ["test", file]]);
    assert.strictEqual(seen.tasks[0].status, 0, seen.tasks[0].stderr);
    assert.match(seen.tasks[1].stdout, /1 passed, 1 failed/);
  });

  test("asks where the process is that it monitors", async () => {
    seen.tasks.length = 0;
    person.answer = undefined;
    await seen.commands.get("plcc.monitor")();
    assert.deepStrictEqual(seen.tasks, []);
    // Nothing listens there; the command itself is understood.
    person.answer = "127.0.0.1:1";
    await seen.commands.get("plcc.monitor")();
    assert.deepStrictEqual(seen.tasks[0].args, ["monitor", "127.0.0.1:1"]);
    assert.doesNotMatch(seen.tasks[0].stderr, /Usage|unexpected argument|invalid value/);
  });

  test("starts the debugger of this plcc", () => {
    const adapter = seen.adapters.get("plcc").createDebugAdapterDescriptor({ workspaceFolder: undefined });
    assert.deepStrictEqual([adapter.command, adapter.args], [process.env.PLCC, ["debug"]]);
  });
});

const vsce = path.join(ROOT, "node_modules", ".bin", "vsce");
test("is packaged with all that it needs", { skip: fs.existsSync(vsce) ? false : "`npm ci` has not been run" }, () => {
  const listed = execFileSync(vsce, ["ls"], { cwd: ROOT, encoding: "utf8" }).split("\n");
  const { main, contributes } = JSON.parse(fs.readFileSync(path.join(ROOT, "package.json"), "utf8"));
  const needed = [main.replace("./", ""), "src/results.js", "README.md", "LICENSE", "node_modules/vscode-languageclient/node.js"];
  for (const name of [...needed, ...contributes.grammars.map((one) => one.path.replace("./", ""))]) {
    assert.ok(listed.includes(name), `${name} is in the package`);
  }
  assert.ok(!listed.some((name) => name.startsWith("test/") || name.startsWith("node_modules/@vscode/vsce/")));
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "plcc-package-"));
  const file = path.join(folder, "plcc.vsix");
  execFileSync(vsce, ["package", "--no-rewrite-relative-links", "--out", file], { cwd: ROOT, stdio: "pipe" });
  assert.ok(fs.statSync(file).size > 10000);
  fs.rmSync(folder, { recursive: true, force: true });
});
