// A client of a language server in the place of `vscode-languageclient/node`, which needs an editor: the same command, over the
// same protocol.
"use strict";

const { spawn } = require("node:child_process");
const { pathToFileURL } = require("node:url");
const lsp = require("vscode-languageserver-protocol/node");

/** The clients that were made. */
const clients = [];

class LanguageClient {
  constructor(id, name, server, options) {
    Object.assign(this, { id, name, server, options, diagnostics: new Map(), waiting: [] });
    clients.push(this);
  }

  async start() {
    this.process = spawn(this.server.command, this.server.args, { stdio: ["pipe", "pipe", "inherit"] });
    this.ended = new Promise((resolve) => this.process.on("exit", resolve));
    const reader = new lsp.StreamMessageReader(this.process.stdout);
    this.connection = lsp.createProtocolConnection(reader, new lsp.StreamMessageWriter(this.process.stdin));
    this.connection.onNotification(lsp.PublishDiagnosticsNotification.type, ({ uri, diagnostics, version }) => {
      this.diagnostics.set(uri, diagnostics);
      this.waiting = this.waiting.filter((wait) => !wait(uri, diagnostics, version));
    });
    this.connection.onRequest(lsp.RegistrationRequest.type, () => {});
    this.connection.onRequest(lsp.ConfigurationRequest.type, ({ items }) => items.map(() => null));
    this.connection.listen();
    const folder = require("./vscode").person.folder;
    const result = await this.connection.sendRequest(lsp.InitializeRequest.type, {
      processId: process.pid,
      rootUri: pathToFileURL(folder).href,
      workspaceFolders: [{ uri: pathToFileURL(folder).href, name: "folder" }],
      capabilities: { textDocument: { publishDiagnostics: { versionSupport: true }, rename: {}, hover: {} } },
    });
    this.capabilities = result.capabilities;
    await this.connection.sendNotification(lsp.InitializedNotification.type, {});
  }

  /** Opens a document as the editor does. */
  open(uri, languageId, text) {
    const textDocument = { uri, languageId, version: 1, text };
    return this.connection.sendNotification(lsp.DidOpenTextDocumentNotification.type, { textDocument });
  }

  change(uri, version, text) {
    const params = { textDocument: { uri, version }, contentChanges: [{ text }] };
    return this.connection.sendNotification(lsp.DidChangeTextDocumentNotification.type, params);
  }

  /** The messages about a document, as soon as `wanted` is true of them. */
  messages(uri, wanted) {
    const known = this.diagnostics.get(uri);
    if (known && wanted(known)) return Promise.resolve(known);
    return new Promise((resolve, reject) => {
      const limit = setTimeout(() => reject(new Error(`no such messages about ${uri} within 20 s`)), 20000);
      this.waiting.push((about, messages) => {
        if (about !== uri || !wanted(messages)) return false;
        clearTimeout(limit);
        resolve(messages);
        return true;
      });
    });
  }

  async stop() {
    await this.connection.sendRequest(lsp.ShutdownRequest.type);
    await this.connection.sendNotification(lsp.ExitNotification.type);
    this.code = await this.ended;
    this.connection.dispose();
  }
}

module.exports = { LanguageClient, clients, lsp };
