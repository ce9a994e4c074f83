"use strict";

const assert = require("node:assert");
const fs = require("node:fs");
const path = require("node:path");
const { test } = require("node:test");
const { assertions, outcomes, sameFile, commands } = require("../src/results");

const TEXT = "      L 1\r\n//@ assert ACCU1 == 1\r\n  //@ assert ACCU1 == 2\n// assert\n//@ test cycles=2\n//@ assert MW0 == 0\n";

test("assertions have their lines", () => {
  assert.deepStrictEqual(assertions(TEXT).map((place) => place.line), [1, 2, 5]);
});

test("outcomes are those of the report", () => {
  const failure = { file: "a.stl", line: 3, found: 1, expected: 2, cycle: 4 };
  const text = "FAILED a.stl:6: assert MW0 == 0\n       was never executed\n";
  const report = { tests: [{ compiled: true, failures: [failure], text, messages: "" }] };
  const found = outcomes(report, assertions(TEXT), (name) => sameFile("/x", name, "/x/a.stl"));
  assert.deepStrictEqual(found.map((one) => one.state), ["passed", "failed", "failed"]);
  assert.strictEqual(found[1].message, "found 1, expected 2 in cycle 4");
  const other = outcomes(report, assertions(TEXT), (name) => sameFile("/y", name, "/x/a.stl"));
  assert.deepStrictEqual(other.map((one) => one.state), ["passed", "passed", "passed"]);
  report.tests[0].compiled = false;
  assert.ok(outcomes(report, assertions(TEXT), () => true).every((one) => one.state === "errored"));
});

test("commands are read from the help", () => {
  assert.deepStrictEqual(commands("Usage\n\nCommands:\n  build  Compile\n  test   Run\n\nOptions:\n"), ["build", "test"]);
});

test("files that the manifest names are there, and grammars compile", () => {
  const root = path.join(__dirname, "..");
  const { contributes, main } = JSON.parse(fs.readFileSync(path.join(root, "package.json"), "utf8"));
  assert.ok(fs.existsSync(path.join(root, main)));
  const languages = contributes.languages.map((language) => language.id).sort();
  assert.deepStrictEqual(contributes.grammars.map((grammar) => grammar.language).sort(), languages);
  for (const language of contributes.languages) JSON.parse(fs.readFileSync(path.join(root, language.configuration), "utf8"));
  for (const { path: file, scopeName } of contributes.grammars) {
    const grammar = JSON.parse(fs.readFileSync(path.join(root, file), "utf8"));
    assert.strictEqual(grammar.scopeName, scopeName);
    const compile = (value, key) => {
      if (["match", "begin", "end"].includes(key)) new RegExp(value.replace(/^\(\?i\)/, ""), "u");
      else if (value && typeof value === "object") Object.entries(value).forEach(([key, value]) => compile(value, key));
    };
    compile(grammar, "");
  }
});

test("each kind of source belongs to one language, and is seen when another program writes it", () => {
  const root = path.join(__dirname, "..");
  const { contributes } = JSON.parse(fs.readFileSync(path.join(root, "package.json"), "utf8"));
  const extension = fs.readFileSync(path.join(root, "src", "extension.js"), "utf8");
  const watched = /createFileSystemWatcher\("\*\*\/\*\.\{([^}]*)\}"\)/.exec(extension)[1].split(",");
  for (const ending of ["stl", "awl", "scl", "db", "udt", "s7dcl", "gr7"]) {
    const owners = contributes.languages.filter((language) => language.extensions.includes(`.${ending}`));
    assert.strictEqual(owners.length, 1, ending);
    assert.ok(watched.includes(ending), ending);
  }
});

test("plcc reports as the explorer reads", { skip: process.env.PLCC ? false : "PLCC does not name the command" }, () => {
  const { execFileSync } = require("node:child_process");
  const folder = fs.mkdtempSync(path.join(require("node:os").tmpdir(), "plcc-vscode-"));
  const file = path.join(folder, "a.stl");
  const text = "      L     1\n//@ assert ACCU1 == 1\n//@ assert ACCU1 == 2\n      BEU\n//@ assert ACCU1 == 1\n";
  const report = (text) => {
    fs.writeFileSync(file, text);
    let stdout;
    try {
      stdout = execFileSync(process.env.PLCC, ["test", "--json", file], { cwd: folder, encoding: "utf8", stdio: "pipe" });
    } catch (error) {
      stdout = error.stdout;
    }
    return outcomes(JSON.parse(stdout), assertions(text), (name) => sameFile(folder, name, file));
  };
  try {
    assert.deepStrictEqual(report(text).map((one) => one.state), ["passed", "failed", "failed"]);
    assert.deepStrictEqual(report(`${text}      A MW 0\n`).map((one) => one.state), ["errored", "errored", "errored"]);
    const help = execFileSync(process.env.PLCC, ["--help"], { encoding: "utf8" });
    for (const name of ["build", "test", "lsp"]) assert.ok(commands(help).includes(name), help);
  } finally {
    fs.rmSync(folder, { recursive: true });
  }
});
