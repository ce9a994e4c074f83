//! The loop of the server: messages of the editor, finished checks, and what is due.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Sender, after, never, select, unbounded};
use lsp_server::{Connection, Message, Notification, Request};
use lsp_types::{
    CodeActionProviderCapability, CompletionOptions, DidChangeTextDocumentParams, DidCloseTextDocumentParams,
    DidOpenTextDocumentParams, HoverProviderCapability, OneOf, PublishDiagnosticsParams, RenameOptions,
    SemanticTokensFullOptions, SemanticTokensLegend, SemanticTokensOptions, ServerCapabilities, SignatureHelpOptions,
    TextDocumentIdentifier, TextDocumentSyncCapability, TextDocumentSyncKind, WorkDoneProgressOptions,
};
use plcc_diag::{Code, Diagnostic, FileId, SourceFile, SourceMap};
use plcc_readers::ReadOptions;
use plcc_syntax::Language;

use crate::requests::{self, View};
use crate::{Checked, Host, Open, outline, text};

/// A program is bound when nothing has changed for so long.
const PAUSE: Duration = Duration::from_millis(150);

/// A file that takes longer to parse is not parsed at each key, but when it is asked about or the user pauses.
const QUICK: Duration = Duration::from_millis(20);

/// Stack of the thread that binds, in bytes: nesting in a source is recursion.
const STACK_BYTES: usize = 256 << 20;

/// What the server can do. `prepares`: the editor asks what would be renamed before it asks for the new name.
fn capabilities(prepares: bool) -> ServerCapabilities {
    let rename =
        RenameOptions { prepare_provider: Some(true), work_done_progress_options: WorkDoneProgressOptions::default() };
    let words = |words: &[&str]| Some(words.iter().map(|word| (*word).to_owned()).collect());
    ServerCapabilities {
        text_document_sync: Some(TextDocumentSyncCapability::Kind(TextDocumentSyncKind::INCREMENTAL)),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        definition_provider: Some(OneOf::Left(true)),
        references_provider: Some(OneOf::Left(true)),
        document_highlight_provider: Some(OneOf::Left(true)),
        rename_provider: Some(if prepares { OneOf::Right(rename) } else { OneOf::Left(true) }),
        document_symbol_provider: Some(OneOf::Left(true)),
        document_formatting_provider: Some(OneOf::Left(true)),
        folding_range_provider: Some(true.into()),
        code_action_provider: Some(CodeActionProviderCapability::Simple(true)),
        completion_provider: Some(CompletionOptions {
            trigger_characters: words(&[".", "#", "\"", "(", ","]),
            ..CompletionOptions::default()
        }),
        signature_help_provider: Some(SignatureHelpOptions {
            trigger_characters: words(&["(", ","]),
            ..SignatureHelpOptions::default()
        }),
        semantic_tokens_provider: Some(
            SemanticTokensOptions {
                legend: SemanticTokensLegend { token_types: outline::LEGEND.to_vec(), token_modifiers: Vec::new() },
                full: Some(SemanticTokensFullOptions::Bool(true)),
                ..SemanticTokensOptions::default()
            }
            .into(),
        ),
        ..ServerCapabilities::default()
    }
}

/// Serves an editor until it says that it ends. `Err`: what went wrong with the connection.
pub fn serve(connection: &Connection, host: Arc<dyn Host>) -> Result<(), String> {
    let (id, editor) = connection.initialize_start().map_err(|error| error.to_string())?;
    let prepares = editor.pointer("/capabilities/textDocument/rename/prepareSupport");
    let capabilities = capabilities(prepares == Some(&serde_json::Value::Bool(true)));
    let answer = serde_json::json!({ "capabilities": capabilities });
    connection.initialize_finish(id, answer).map_err(|error| error.to_string())?;
    let (sender, results) = unbounded();
    let mut server = Server {
        host,
        open: Open::new(),
        programs: BTreeMap::new(),
        due: BTreeMap::new(),
        slow: BTreeSet::new(),
        stale: BTreeSet::new(),
        running: BTreeSet::new(),
        bound: BTreeSet::new(),
        published: BTreeMap::new(),
        out: connection.sender.clone(),
        finished: sender,
    };
    server.run(connection, &results)
}

/// A check that has ended: the root, and the program.
type Finished = (PathBuf, Checked);

struct Server {
    host: Arc<dyn Host>,
    open: Open,
    /// Programs by their roots.
    programs: BTreeMap<PathBuf, Checked>,
    /// Programs that have changed, and when they are bound.
    due: BTreeMap<PathBuf, Instant>,
    /// Files that take long to parse, and those of them that have changed since.
    slow: BTreeSet<PathBuf>,
    stale: BTreeSet<PathBuf>,
    running: BTreeSet<PathBuf>,
    /// Programs that were bound at least once: all of their files are known.
    bound: BTreeSet<PathBuf>,
    /// Files with messages that the editor shows, by program.
    published: BTreeMap<PathBuf, BTreeSet<PathBuf>>,
    out: Sender<Message>,
    finished: Sender<Finished>,
}

impl Server {
    fn run(&mut self, connection: &Connection, results: &Receiver<Finished>) -> Result<(), String> {
        loop {
            let wait = self.due.iter().filter(|(root, _)| !self.running.contains(*root)).map(|(_, at)| *at).min();
            let timer = wait.map_or_else(never, |at| after(at.saturating_duration_since(Instant::now())));
            select! {
                recv(connection.receiver) -> message => match message {
                    Err(_) => return Ok(()),
                    Ok(Message::Request(request)) => {
                        if connection.handle_shutdown(&request).map_err(|error| error.to_string())? {
                            return Ok(());
                        }
                        self.await_program(&request, results);
                        self.request(request);
                    }
                    Ok(Message::Notification(note)) => self.notification(note),
                    Ok(Message::Response(_)) => {}
                },
                recv(results) -> result => if let Ok((root, checked)) = result {
                    self.accept(root, checked);
                },
                recv(timer) -> _ => self.start_due(),
            }
        }
    }

    fn notification(&mut self, note: Notification) {
        let Notification { method, params } = note;
        match method.as_str() {
            "textDocument/didOpen" => {
                if let Ok(DidOpenTextDocumentParams { text_document }) = serde_json::from_value(params)
                    && let Some(path) = text::path(&text_document.uri)
                {
                    self.open.insert(path.clone(), text_document.text);
                    self.changed(&path);
                }
            }
            "textDocument/didChange" => {
                if let Ok(DidChangeTextDocumentParams { text_document, content_changes }) =
                    serde_json::from_value(params)
                    && let Some(path) = text::path(&text_document.uri)
                    && let Some(text) = self.open.get_mut(&path)
                {
                    text::apply(text, content_changes);
                    if self.slow.contains(&path) {
                        self.due.insert(self.host.root(&path), Instant::now() + PAUSE);
                        self.stale.insert(path);
                    } else {
                        self.changed(&path);
                    }
                }
            }
            "textDocument/didClose" => {
                if let Ok(DidCloseTextDocumentParams { text_document }) = serde_json::from_value(params)
                    && let Some(path) = text::path(&text_document.uri)
                {
                    self.open.remove(&path);
                    self.due.insert(self.host.root(&path), Instant::now());
                }
            }
            "textDocument/didSave" | "workspace/didChangeWatchedFiles" => {
                let roots: Vec<PathBuf> = self.programs.keys().cloned().collect();
                self.due.extend(roots.into_iter().map(|root| (root, Instant::now() + PAUSE)));
            }
            _ => {}
        }
    }

    /// A file has another text: its tree is renewed at once, and the program when the user pauses.
    fn changed(&mut self, path: &Path) {
        let root = self.host.root(path);
        let Some(text) = self.open.get(path) else { return };
        let checked = self.programs.entry(root.clone()).or_default();
        let start = Instant::now();
        let messages = renew(checked, path, text);
        if start.elapsed() > QUICK {
            self.slow.insert(path.to_path_buf());
        } else {
            self.slow.remove(path);
        }
        if messages.iter().any(Diagnostic::is_error)
            && let Some(file) = file_of(checked, path)
        {
            let shown = requests::diagnostics(&checked.sources, file, &messages);
            self.published.entry(root.clone()).or_default().insert(path.to_path_buf());
            self.publish(path, shown);
        }
        self.due.insert(root, Instant::now() + PAUSE);
    }

    /// Starts the checks whose time has come.
    fn start_due(&mut self) {
        let now = Instant::now();
        let ready = self.due.iter().filter(|(root, at)| **at <= now && !self.running.contains(*root));
        let ready: Vec<PathBuf> = ready.map(|(root, _)| root.clone()).collect();
        for root in ready {
            self.due.remove(&root);
            let (host, open, finished) = (Arc::clone(&self.host), self.open.clone(), self.finished.clone());
            let place = root.clone();
            let work = move || {
                let checked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| host.check(&place, &open)));
                // The server may have ended.
                let _ = finished.send((place, checked.unwrap_or_default()));
            };
            if std::thread::Builder::new().stack_size(STACK_BYTES).spawn(work).is_ok() {
                self.running.insert(root);
            }
        }
    }

    /// Takes a program that was bound, unless it has changed since.
    fn accept(&mut self, root: PathBuf, checked: Checked) {
        self.running.remove(&root);
        if self.due.contains_key(&root) {
            return;
        }
        self.bound.insert(root.clone());
        if checked.units.is_empty() && checked.diagnostics.is_empty() {
            return;
        }
        let mut shown: BTreeMap<PathBuf, Vec<lsp_types::Diagnostic>> = BTreeMap::new();
        for (file, source) in checked.sources.files() {
            let own: Vec<Diagnostic> =
                checked.diagnostics.iter().filter(|message| message.primary.span.file == file).cloned().collect();
            if !own.is_empty() {
                let messages = requests::diagnostics(&checked.sources, file, &own);
                shown.entry(PathBuf::from(&source.name)).or_default().extend(messages);
            }
        }
        // Files without messages get an empty list, open ones always: the editor knows then that the check has ended.
        let before = self.published.remove(&root).unwrap_or_default();
        let open = self.open.keys().filter(|path| file_of(&checked, path).is_some()).cloned();
        for path in before.into_iter().chain(open) {
            shown.entry(path).or_default();
        }
        self.stale.retain(|path| file_of(&checked, path).is_none());
        self.published.insert(root.clone(), shown.keys().cloned().collect());
        self.programs.insert(root, checked);
        for (path, messages) in shown {
            self.publish(&path, messages);
        }
    }

    fn publish(&self, path: &Path, diagnostics: Vec<lsp_types::Diagnostic>) {
        let Some(uri) = text::uri(path) else { return };
        let params = PublishDiagnosticsParams { uri, diagnostics, version: None };
        let note = Notification::new("textDocument/publishDiagnostics".to_owned(), params);
        // A closed connection is seen at the next message.
        let _ = self.out.send(Message::Notification(note));
    }

    /// Waits for the first check of a program whose other files a request is about: until then only open files are known, and a name
    /// would be changed in some of its places. Another name also waits for what was typed since, in tables and settings too.
    fn await_program(&mut self, request: &Request, results: &Receiver<Finished>) {
        const OF_PROGRAM: [&str; 7] =
            ["hover", "definition", "references", "prepareRename", "rename", "completion", "signatureHelp"];
        let is_of_program = request.method.strip_prefix("textDocument/").is_some_and(|name| OF_PROGRAM.contains(&name));
        let document = request.params.get("textDocument").filter(|_| is_of_program);
        let document = document.and_then(|one| serde_json::from_value::<TextDocumentIdentifier>(one.clone()).ok());
        let path = document.and_then(|document| text::path(&document.uri));
        let Some(root) = path.filter(|path| self.open.contains_key(path)).map(|path| self.host.root(&path)) else {
            return;
        };
        let is_rename = request.method == "textDocument/rename";
        while !self.bound.contains(&root) || is_rename && self.is_behind(&root) {
            if !self.running.contains(&root) {
                self.due.insert(root.clone(), Instant::now());
                self.start_due();
                if !self.running.contains(&root) {
                    return;
                }
            }
            let Ok((root, checked)) = results.recv() else { return };
            self.accept(root, checked);
        }
    }

    /// Whether something was typed after the program was bound.
    fn is_behind(&self, root: &Path) -> bool {
        self.due.contains_key(root) || self.running.contains(root)
    }

    fn request(&mut self, request: Request) {
        for path in std::mem::take(&mut self.stale) {
            self.changed(&path);
        }
        let view = |path: &Path| {
            let checked = self.programs.get(&self.host.root(path))?;
            Some(View { checked, file: file_of(checked, path)? })
        };
        let response = requests::answer(request, view);
        let _ = self.out.send(Message::Response(response));
    }
}

/// The file of a program at a path.
fn file_of(checked: &Checked, path: &Path) -> Option<FileId> {
    checked.sources.files().find(|(_, source)| Path::new(&source.name) == path).map(|(file, _)| file)
}

/// Parses a file of a program again. Returns its messages.
fn renew(checked: &mut Checked, path: &Path, text: &str) -> Vec<Diagnostic> {
    // The places that the program has found in the file are those of this text.
    if file_of(checked, path).is_some_and(|file| checked.sources.file(file).text == text) {
        return Vec::new();
    }
    let name = path.display().to_string();
    let file = match file_of(checked, path) {
        Some(file) => {
            let mut sources = SourceMap::default();
            for (own, source) in std::mem::take(&mut checked.sources).files() {
                sources.add(if own == file { SourceFile::new(name.clone(), text) } else { source.clone() });
            }
            checked.sources = sources;
            file
        }
        None => checked.sources.add(SourceFile::new(name.clone(), text)),
    };
    // Places in the text before are not those of this one.
    checked.diagnostics.retain(|message| message.primary.span.file != file);
    checked.values.retain(|name| name.iter().all(|part| part.span.file != file));
    if !may_have_blocks(path) {
        return Vec::new();
    }
    let options = ReadOptions { language: hint(path), pragmas: true, ..ReadOptions::default() };
    let (mut unit, mut messages) = plcc_readers::parse(file, text, &options);
    // It may be a table of the program, which says so when it is bound.
    if messages.iter().any(|message| message.code == Code::NotASource) {
        checked.units.retain(|(own, _)| *own != file);
        return Vec::new();
    }
    // A source that does not show its mnemonics has those of the program.
    let before = checked.units.iter().find(|(own, _)| *own == file).map(|(_, unit)| unit.mnemonics);
    if unit.shows_mnemonics == Some(false) && before.is_some_and(|set| set != unit.mnemonics) {
        (unit, messages) = plcc_readers::parse(file, text, &ReadOptions { mnemonics: before, ..options });
    }
    match checked.units.iter_mut().find(|(own, _)| *own == file) {
        Some(slot) => slot.1 = unit,
        None => checked.units.push((file, unit)),
    }
    checked.diagnostics.extend(messages.iter().cloned());
    messages
}

/// False for files of a project that are never sources: settings and scenarios, symbol tables, texts of networks, traces.
fn may_have_blocks(path: &Path) -> bool {
    const OTHERS: [&str; 8] = ["toml", "sdf", "asc", "dif", "seq", "s7res", "csv", "md"];
    let extension = path.extension().map(|extension| extension.to_string_lossy()).unwrap_or_default();
    !OTHERS.iter().any(|known| known.eq_ignore_ascii_case(&extension))
}

/// The language that the name of a file implies.
pub fn hint(path: &Path) -> Option<Language> {
    path.extension().and_then(|extension| Language::of_extension(&extension.to_string_lossy()))
}
