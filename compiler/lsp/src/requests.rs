//! What an editor asks, and the answers.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

use lsp_server::{ErrorCode, Request, Response};
use lsp_types::{
    CodeAction, CodeActionKind, CodeActionOrCommand, CodeActionParams, CompletionParams, DiagnosticRelatedInformation,
    DiagnosticSeverity, DocumentFormattingParams, DocumentHighlight, DocumentHighlightParams, DocumentSymbolParams,
    FoldingRangeParams, GotoDefinitionParams, Hover, HoverContents, HoverParams, Location, MarkupContent, MarkupKind,
    NumberOrString, Position, PrepareRenameResponse, ReferenceParams, RenameParams, SemanticTokens,
    SemanticTokensParams, SignatureHelpParams, TextDocumentPositionParams, TextEdit, Uri, WorkspaceEdit,
};
use plcc_diag::{Diagnostic, FileId, Severity, SourceMap, Span};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::index::Index;
use crate::server::hint;
use crate::text::{self, Lines};
use crate::words::{Words, bare};
use crate::{Checked, complete, fixes, go, hover, names, outline, s7200};

/// A file of a program.
pub struct View<'c> {
    pub checked: &'c Checked,
    pub file: FileId,
}

impl<'c> View<'c> {
    fn text(&self) -> &'c str {
        &self.checked.sources.file(self.file).text
    }

    fn words(&self, file: FileId) -> Words<'c> {
        let source = self.checked.sources.file(file);
        Words::new(&source.text, hint(Path::new(&source.name)))
    }

    /// The words of all sources.
    fn texts(&self) -> go::Texts<'c> {
        with_assertions(self.checked.units.iter().map(|(file, _)| (*file, self.words(*file))).collect())
    }

    /// What is written at a byte of a source for the S7-200, and all its names.
    fn s7200(&self, byte: usize) -> Option<(s7200::Use<'c>, s7200::Names<'c>)> {
        let names = s7200::Names::of(self.checked, self.file)?;
        Some((names.at(self.file, byte)?, names))
    }

    fn location(&self, span: Span) -> Option<Location> {
        self.locations([span]).pop().flatten()
    }

    /// The places of spans. The lines of a file are counted once.
    fn locations(&self, spans: impl IntoIterator<Item = Span>) -> Vec<Option<Location>> {
        let mut files: BTreeMap<FileId, Option<(Uri, Lines)>> = BTreeMap::new();
        let mut found = Vec::new();
        for span in spans {
            let file = files.entry(span.file).or_insert_with(|| {
                let source = self.checked.sources.file(span.file);
                Some((text::uri(Path::new(&source.name))?, Lines::new(&source.text)))
            });
            found.push(file.as_ref().map(|(uri, lines)| Location::new(uri.clone(), lines.range(span.range()))));
        }
        found
    }
}

/// Texts, and after them the words of their assertions.
fn with_assertions(mut texts: go::Texts<'_>) -> go::Texts<'_> {
    let asserted: go::Texts = texts.iter().map(|(file, words)| (*file, words.asserted())).collect();
    texts.extend(asserted);
    texts
}

/// Answers a request. `view` finds the file at a path.
pub fn answer<'c>(request: Request, view: impl Fn(&Path) -> Option<View<'c>>) -> Response {
    let Request { id, method, params } = request;
    let made = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| result(&method, params, &view)));
    match made {
        Ok(Ok(value)) => Response::new_ok(id, value),
        Ok(Err((code, message))) => Response::new_err(id, code as i32, message),
        Err(_) => Response::new_err(id, ErrorCode::InternalError as i32, "internal fault, please report it".to_owned()),
    }
}

type Answer = Result<Value, (ErrorCode, String)>;

fn result<'c>(method: &str, params: Value, view: &impl Fn(&Path) -> Option<View<'c>>) -> Answer {
    match method {
        "textDocument/hover" => {
            let HoverParams { text_document_position_params, .. } = read(params)?;
            at(view, text_document_position_params, |view, words, byte| {
                if let Some((found, names)) = view.s7200(byte) {
                    let contents = HoverContents::Markup(MarkupContent {
                        kind: MarkupKind::Markdown,
                        value: names.hover(&found.named),
                    });
                    return Some(Hover { contents, range: Some(Lines::new(view.text()).range(found.span.range())) });
                }
                let index = Index::new(view.checked);
                let (value, range) = match go::in_row(&index, view.file, byte) {
                    Some((found, _, span)) => (hover::row(&index, &found)?, span.range()),
                    None => {
                        let at = words.at(byte)?;
                        (hover::hover(&index, words, view.file, at)?, words.range(at))
                    }
                };
                let range = Some(Lines::new(view.text()).range(range));
                let contents = HoverContents::Markup(MarkupContent { kind: MarkupKind::Markdown, value });
                Some(Hover { contents, range })
            })
        }
        "textDocument/definition" => {
            let GotoDefinitionParams { text_document_position_params, .. } = read(params)?;
            at(view, text_document_position_params, |view, words, byte| {
                if let Some((found, names)) = view.s7200(byte) {
                    return view.location(names.definition(&found.named)?);
                }
                let index = Index::new(view.checked);
                let meaning = match go::in_row(&index, view.file, byte) {
                    Some((found, ..)) => found,
                    None => names::meaning(&index, words, view.file, words.at(byte)?)?,
                };
                view.location(meaning.definition()?)
            })
        }
        "textDocument/references" => {
            let ReferenceParams { text_document_position, .. } = read(params)?;
            at(view, text_document_position, |view, words, byte| {
                let found = match view.s7200(byte) {
                    Some((found, names)) => names.references(&found.named),
                    None => {
                        let index = Index::new(view.checked);
                        go::references(&index, &view.texts(), &go::asked(&index, words, view.file, byte)?)
                    }
                };
                Some(view.locations(found).into_iter().flatten().collect::<Vec<_>>())
            })
        }
        "textDocument/documentHighlight" => {
            let DocumentHighlightParams { text_document_position_params, .. } = read(params)?;
            at(view, text_document_position_params, |view, words, byte| {
                let own = with_assertions(vec![(view.file, view.words(view.file))]);
                let mut found = match view.s7200(byte) {
                    Some((found, names)) => names.references(&found.named),
                    None => {
                        let index = Index::new(view.checked);
                        go::references(&index, &own, &go::asked(&index, words, view.file, byte)?)
                    }
                };
                found.retain(|span| span.file == view.file);
                let lines = Lines::new(view.text());
                let mark = |span: Span| DocumentHighlight { range: lines.range(span.range()), kind: None };
                Some(found.into_iter().map(mark).collect::<Vec<_>>())
            })
        }
        "textDocument/rename" => {
            let RenameParams { text_document_position, new_name, .. } = read(params)?;
            rename(view, text_document_position, &new_name)
        }
        "textDocument/prepareRename" => prepare(view, read(params)?),
        "textDocument/completion" => {
            let CompletionParams { text_document_position, .. } = read(params)?;
            at(view, text_document_position, |view, words, byte| {
                let unit = view.checked.units.iter().find(|(file, _)| *file == view.file);
                let set = unit.map(|(_, unit)| unit.mnemonics).unwrap_or_default();
                let operands = s7200::Names::of(view.checked, view.file);
                let operands = operands.map_or(Vec::new(), |names| names.operands(words, view.file, byte));
                if !operands.is_empty() {
                    return Some(operands);
                }
                Some(complete::complete(&Index::new(view.checked), words, view.file, byte, set))
            })
        }
        "textDocument/signatureHelp" => {
            let SignatureHelpParams { text_document_position_params, .. } = read(params)?;
            at(view, text_document_position_params, |view, words, byte| {
                match s7200::Names::of(view.checked, view.file) {
                    Some(names) => names.signature(words, byte),
                    None => complete::signature(&Index::new(view.checked), words, view.file, byte),
                }
            })
        }
        "textDocument/documentSymbol" => {
            let DocumentSymbolParams { text_document, .. } = read(params)?;
            whole(view, &text_document.uri, |view| {
                Some(outline::symbols(&Index::new(view.checked), &Lines::new(view.text()), view.file))
            })
        }
        "textDocument/foldingRange" => {
            let FoldingRangeParams { text_document, .. } = read(params)?;
            whole(view, &text_document.uri, |view| {
                Some(outline::folding(&view.words(view.file), &Lines::new(view.text())))
            })
        }
        "textDocument/semanticTokens/full" => {
            let SemanticTokensParams { text_document, .. } = read(params)?;
            whole(view, &text_document.uri, |view| {
                let (index, words) = (Index::new(view.checked), view.words(view.file));
                let data = outline::tokens(&index, &words, &Lines::new(view.text()), view.file);
                Some(SemanticTokens { result_id: None, data })
            })
        }
        "textDocument/formatting" => {
            let DocumentFormattingParams { text_document, .. } = read(params)?;
            whole(view, &text_document.uri, formatting)
        }
        "textDocument/codeAction" => {
            let params: CodeActionParams = read(params)?;
            let uri = params.text_document.uri.clone();
            whole(view, &uri, |view| Some(actions(view, &params)))
        }
        other => Err((ErrorCode::MethodNotFound, format!("`{other}` is not known"))),
    }
}

fn read<T: DeserializeOwned>(params: Value) -> Result<T, (ErrorCode, String)> {
    serde_json::from_value(params).map_err(|error| (ErrorCode::InvalidParams, error.to_string()))
}

fn write(value: impl Serialize) -> Answer {
    serde_json::to_value(value).map_err(|error| (ErrorCode::InternalError, error.to_string()))
}

fn path_of(uri: &Uri) -> Result<PathBuf, (ErrorCode, String)> {
    text::path(uri).ok_or((ErrorCode::InvalidParams, "only files have answers".to_owned()))
}

/// An answer about a file; null if there is none.
fn whole<'c, T: Serialize>(
    view: &impl Fn(&Path) -> Option<View<'c>>,
    uri: &Uri,
    made: impl FnOnce(&View<'c>) -> Option<T>,
) -> Answer {
    write(view(&path_of(uri)?).and_then(|view| made(&view)))
}

/// An answer about a place; null if there is none.
fn at<'c, T: Serialize>(
    view: &impl Fn(&Path) -> Option<View<'c>>,
    place: TextDocumentPositionParams,
    made: impl FnOnce(&View<'c>, &Words<'c>, usize) -> Option<T>,
) -> Answer {
    let made = |view: &View<'c>| made(view, &view.words(view.file), text::byte(view.text(), place.position));
    whole(view, &place.text_document.uri, made)
}

/// A name that nothing has, to find out whether something can have another one.
const OTHER: &str = "_0";

/// The name at a place that would change, or why it cannot.
fn prepare<'c>(view: &impl Fn(&Path) -> Option<View<'c>>, place: TextDocumentPositionParams) -> Answer {
    let failed = |why: String| (ErrorCode::RequestFailed, why);
    let view = view(&path_of(&place.text_document.uri)?).ok_or_else(|| failed("the file is not known".to_owned()))?;
    let words = view.words(view.file);
    let byte = text::byte(view.text(), place.position);
    let (placeholder, edits) = match view.s7200(byte) {
        Some((found, names)) => {
            let name = bare(view.checked.sources.text(found.span)).to_owned();
            (name, names.rename(&found.named, OTHER))
        }
        None => {
            let index = Index::new(view.checked);
            let asked = go::asked(&index, &words, view.file, byte);
            let (wanted, name) = asked.ok_or_else(|| failed("this has no name".to_owned()))?;
            (name, go::rename(&index, &view.texts(), &wanted, OTHER))
        }
    };
    let edits = edits.map_err(failed)?;
    let mut own = edits.iter().filter(|(span, _)| span.file == view.file).map(|(span, _)| span.range());
    // `S002` stays when step 2 gets another name.
    let word = || words.at(byte).map(|at| words.range(at));
    let range = own.find(|range| range.start <= byte && byte <= range.end).or_else(word);
    let range = range.ok_or_else(|| failed("this has no name".to_owned()))?;
    let range = Lines::new(view.text()).range(range);
    write(PrepareRenameResponse::RangeWithPlaceholder { range, placeholder })
}

#[allow(clippy::mutable_key_type, reason = "the map of a workspace edit has URIs as keys")]
fn rename<'c>(view: &impl Fn(&Path) -> Option<View<'c>>, place: TextDocumentPositionParams, to: &str) -> Answer {
    let failed = |why: String| (ErrorCode::RequestFailed, why);
    let view = view(&path_of(&place.text_document.uri)?).ok_or_else(|| failed("the file is not known".to_owned()))?;
    let words = view.words(view.file);
    let byte = text::byte(view.text(), place.position);
    let edits = match view.s7200(byte) {
        Some((found, names)) => names.rename(&found.named, to).map_err(failed)?,
        None => {
            let index = Index::new(view.checked);
            let asked = go::asked(&index, &words, view.file, byte);
            let (wanted, _) = asked.ok_or_else(|| failed("this has no name".to_owned()))?;
            go::rename(&index, &view.texts(), &wanted, to).map_err(failed)?
        }
    };
    let mut changes: HashMap<Uri, Vec<TextEdit>> = HashMap::new();
    let places = view.locations(edits.iter().map(|(span, _)| *span));
    for (place, (_, text)) in places.into_iter().zip(edits) {
        if let Some(location) = place {
            changes.entry(location.uri).or_default().push(TextEdit::new(location.range, text));
        }
    }
    write(WorkspaceEdit::new(changes))
}

/// The edit that lays the file out; none if it has errors or is laid out.
fn formatting(view: &View) -> Option<Vec<TextEdit>> {
    let text = view.text();
    let source = view.checked.sources.file(view.file);
    let made = plcc_format::format(FileId::default(), text, hint(Path::new(&source.name))).ok()?;
    let made = if text.contains("\r\n") { made.replace('\n', "\r\n") } else { made };
    if made == text {
        return Some(Vec::new());
    }
    Some(vec![TextEdit::new(Lines::new(text).range(0..text.len()), made)])
}

/// Repairs of the messages in a range.
#[allow(clippy::mutable_key_type, reason = "the map of a workspace edit has URIs as keys")]
fn actions(view: &View, params: &CodeActionParams) -> Vec<CodeActionOrCommand> {
    let lines = Lines::new(view.text());
    let touches = |own: lsp_types::Range| own.start <= params.range.end && params.range.start <= own.end;
    let mut actions = Vec::new();
    for message in &view.checked.diagnostics {
        let span = message.primary.span;
        if span.file != view.file || !touches(lines.range(span.range())) {
            continue;
        }
        let marked = view.text().get(span.range()).unwrap_or_default();
        let Some(text) = fixes::replacement(message, marked) else { continue };
        let around = |range: std::ops::Range<usize>| view.text().get(range).unwrap_or_default();
        let (before, after) = (around(0..span.range().start), around(span.range().end..view.text().len()));
        let edit = TextEdit::new(lines.range(span.range()), fixes::apart(&text, marked, before, after));
        actions.push(CodeActionOrCommand::CodeAction(CodeAction {
            title: format!("Write `{text}`"),
            kind: Some(CodeActionKind::QUICKFIX),
            edit: Some(WorkspaceEdit::new(HashMap::from([(params.text_document.uri.clone(), vec![edit])]))),
            diagnostics: Some(diagnostics(&view.checked.sources, view.file, std::slice::from_ref(message))),
            ..CodeAction::default()
        }));
    }
    actions
}

/// Messages of a file as editors take them.
pub fn diagnostics(sources: &SourceMap, file: FileId, messages: &[Diagnostic]) -> Vec<lsp_types::Diagnostic> {
    let lines = Lines::new(&sources.file(file).text);
    messages.iter().map(|message| diagnostic(sources, &lines, message)).collect()
}

fn diagnostic(sources: &SourceMap, lines: &Lines, message: &Diagnostic) -> lsp_types::Diagnostic {
    let mut text = message.title.clone();
    if !message.primary.text.is_empty() {
        text.push_str(&format!(": {}", message.primary.text));
    }
    if let Some(help) = &message.help {
        text.push_str(&format!("\n{help}"));
    }
    let related = message.secondary.iter().filter_map(|label| {
        let source = sources.file(label.span.file);
        let range = Lines::new(&source.text).range(label.span.range());
        let location = Location::new(text::uri(Path::new(&source.name))?, range);
        Some(DiagnosticRelatedInformation { location, message: label.text.clone() })
    });
    let mut range = lines.range(message.primary.span.range());
    if range.start == range.end {
        range.end = Position::new(range.end.line, range.end.character + 1);
    }
    lsp_types::Diagnostic {
        range,
        severity: Some(match message.severity {
            Severity::Error => DiagnosticSeverity::ERROR,
            Severity::Warning => DiagnosticSeverity::WARNING,
        }),
        code: Some(NumberOrString::String(message.code.name().to_owned())),
        source: Some("plcc".to_owned()),
        message: text,
        related_information: Some(related.collect()),
        ..lsp_types::Diagnostic::default()
    }
}
