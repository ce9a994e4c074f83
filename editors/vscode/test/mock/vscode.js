// The parts of the module `vscode` that the extension uses, without an editor. What the extension does with them is in `seen`.
"use strict";

const { spawnSync } = require("node:child_process");
const fs = require("node:fs");
const path = require("node:path");

/** What the extension has done: commands, panels, tasks, messages, runs of tests. */
const seen = { commands: new Map(), panels: [], tasks: [], messages: [], runs: [], controllers: [], adapters: new Map() };

/** What the person in front of the editor does. */
const person = { folder: "", command: "plcc", file: undefined, answer: undefined };

class Disposable {
  constructor(dispose = () => {}) {
    this.dispose = dispose;
  }
  static from(...all) {
    return new Disposable(() => all.forEach((one) => one.dispose?.()));
  }
}

class Uri {
  constructor(fsPath) {
    this.fsPath = fsPath;
  }
  static file(fsPath) {
    return new Uri(fsPath);
  }
  toString() {
    return `file://${this.fsPath}`;
  }
}

class Range {
  constructor(startLine, startCharacter, endLine, endCharacter) {
    this.start = { line: startLine, character: startCharacter };
    this.end = { line: endLine, character: endCharacter };
  }
}

class Location {
  constructor(uri, range) {
    Object.assign(this, { uri, range });
  }
}

class TestMessage {
  constructor(message) {
    this.message = message;
  }
  static diff(message, expected, actual) {
    return Object.assign(new TestMessage(message), { expectedOutput: expected, actualOutput: actual });
  }
}

/** Items by their ids, in order. */
class Items {
  #all = new Map();
  add(item) {
    this.#all.set(item.id, item);
  }
  delete(id) {
    this.#all.delete(id);
  }
  get(id) {
    return this.#all.get(id);
  }
  get size() {
    return this.#all.size;
  }
  forEach(action) {
    this.#all.forEach((item) => action(item));
  }
  [Symbol.iterator]() {
    return this.#all[Symbol.iterator]();
  }
}

class Controller {
  constructor(id, label) {
    Object.assign(this, { id, label, items: new Items(), profiles: [] });
    seen.controllers.push(this);
  }
  createTestItem(id, label, uri) {
    const item = { id, label, uri, children: new Items(), parent: undefined };
    const add = item.children.add.bind(item.children);
    item.children.add = (child) => {
      child.parent = item;
      add(child);
    };
    return item;
  }
  createRunProfile(label, kind, run) {
    this.profiles.push({ label, kind, run });
  }
  createTestRun() {
    const run = { states: new Map(), ended: false };
    const note = (state) => (item, message) => run.states.set(item.range.start.line, { state, message });
    Object.assign(run, { started: note("started"), passed: note("passed"), failed: note("failed"), errored: note("errored") });
    run.end = () => (run.ended = true);
    seen.runs.push(run);
    return run;
  }
  dispose() {}
}

function filesBelow(folder) {
  return fs.readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const file = path.join(folder, entry.name);
    return entry.isDirectory() ? filesBelow(file) : [file];
  });
}

const vscode = {
  Disposable, Uri, Range, Location, TestMessage,
  ViewColumn: { Beside: -2 },
  TaskScope: { Workspace: 2 },
  TestRunProfileKind: { Run: 1 },
  ProcessExecution: class {
    constructor(process, args, options) {
      Object.assign(this, { process, args, options });
    }
  },
  Task: class {
    constructor(definition, scope, name, source, execution) {
      Object.assign(this, { definition, scope, name, source, execution });
    }
  },
  DebugAdapterExecutable: class {
    constructor(command, args, options) {
      Object.assign(this, { command, args, options });
    }
  },
  commands: {
    registerCommand(name, action) {
      seen.commands.set(name, action);
      return new Disposable();
    },
  },
  debug: {
    activeDebugSession: undefined,
    registerDebugAdapterDescriptorFactory(type, factory) {
      seen.adapters.set(type, factory);
      return new Disposable();
    },
    registerDebugConfigurationProvider: () => new Disposable(),
  },
  tasks: {
    /** Runs the process to its end. */
    executeTask({ name, execution }) {
      const { status, stdout, stderr } = spawnSync(execution.process, execution.args, { ...execution.options, encoding: "utf8" });
      seen.tasks.push({ name, args: execution.args, status, stdout, stderr });
    },
  },
  tests: { createTestController: (id, label) => new Controller(id, label) },
  window: {
    get activeTextEditor() {
      return person.file && { document: { uri: Uri.file(person.file) } };
    },
    createWebviewPanel(type, title, where, options) {
      const panel = { type, title, where, options, webview: { html: "" } };
      seen.panels.push(panel);
      return panel;
    },
    showErrorMessage: (text) => void seen.messages.push(text),
    showInformationMessage: (text) => void seen.messages.push(text),
    showInputBox: async () => person.answer,
  },
  workspace: {
    asRelativePath: (uri) => path.relative(person.folder, uri.fsPath),
    createFileSystemWatcher: () => {
      const none = () => new Disposable();
      return { onDidCreate: none, onDidChange: none, onDidDelete: none, dispose() {} };
    },
    findFiles: async (pattern) => {
      const endings = /\{(.+)\}/.exec(pattern)[1].split(",");
      return filesBelow(person.folder).filter((file) => endings.includes(path.extname(file).slice(1))).map(Uri.file);
    },
    fs: { readFile: async (uri) => fs.readFileSync(uri.fsPath) },
    getConfiguration: () => ({ get: (name, value) => (name === "path" ? person.command : value) }),
  },
};

module.exports = { vscode, seen, person };
