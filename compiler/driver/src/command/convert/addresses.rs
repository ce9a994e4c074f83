//! `plcc convert --absolute` and `--symbolic`. What is written has the same IR as before; operands with which it would not compile stay.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use plcc_convert::addresses::{self, Edit, To, names::Names};
use plcc_diag::{Code, Diagnostic, FileId, Severity, Span};

use super::{Converted, binding, bound, companions, store};
use crate::cli::{ConvertArgs, Level};
use crate::command::exit;
use crate::{inputs, pipeline, report};

/// Edits of the sources, in the order of these.
type Edits = Vec<(FileId, Vec<Edit>)>;

/// Writes all sources with addresses, or with symbols.
pub(super) fn write(args: &ConvertArgs, to: To) -> u8 {
    let read = inputs::read_as(&args.inputs, args.code_page);
    let unreadable = read.is_unreadable();
    let beside = read.texts.clone();
    let tables = companions::tables(&read);
    let mut parsed = pipeline::parse(read, &pipeline::Settings::default());
    let mut messages = std::mem::take(&mut parsed.diagnostics);
    messages.retain(Diagnostic::is_error);
    messages.extend(parsed.units.iter().filter_map(|(file, _)| without_text(*file, &parsed)));
    if !messages.is_empty() {
        report::messages(&mut messages, &parsed.sources);
        report::say(&report::summary(&messages));
        return if unreadable { exit::USAGE } else { exit::COMPILE };
    }
    let before = match bound(args, &parsed, None) {
        Ok(bound) => bound,
        Err(code) => return code,
    };
    let names = Names::new(&parsed.tables, &before.program);
    let mut edits: Edits = Vec::new();
    for (file, unit) in &parsed.units {
        let (own, found) = addresses::edits(unit, &names, to);
        edits.push((*file, own));
        messages.extend(found);
    }
    let stays = match settle(args, &parsed, &before, &mut edits) {
        Ok(stays) => stays,
        Err(code) => return code,
    };
    messages.extend(stays);
    report::messages(&mut messages, &parsed.sources);
    let files: Vec<Converted> = edits
        .iter()
        .filter(|(file, _)| !companions::is_made(&parsed.sources.file(*file).name))
        .map(|(file, own)| {
            let source = parsed.sources.file(*file);
            let texts = beside.iter().find(|(unit, _)| unit == file);
            Converted {
                name: source.name.clone(),
                text: addresses::apply(&source.text, own),
                beside: texts
                    .map(|(_, texts)| super::texts_beside(parsed.sources.file(*texts).text.to_string()))
                    .into_iter()
                    .collect(),
            }
        })
        .collect();
    let companions = match companions::of(args, &tables, &parsed, None) {
        Ok(companions) => companions,
        Err(code) => return code,
    };
    store(args, None, &files, &companions).err().unwrap_or(exit::OK)
}

/// A source whose operands are not text.
fn without_text(file: FileId, parsed: &pipeline::Parsed) -> Option<Diagnostic> {
    plcc_readers::xml::kind(&parsed.sources.file(file).text)?;
    let message =
        Diagnostic::new(Code::NotConverted, Span::new(file, 0..0), "operands of XML do not change their form");
    Some(message.help("convert it to a text first, with `--to stl`, `--to scl` or `--to sd`"))
}

/// Takes back edits that do not compile, and compares what is left with the program as it was. Returns a warning for each that was taken
/// back; an exit code after messages.
fn settle(
    args: &ConvertArgs,
    parsed: &pipeline::Parsed,
    before: &pipeline::Bound,
    edits: &mut Edits,
) -> Result<Vec<Diagnostic>, u8> {
    let settings = binding(args, parsed, None);
    let mut stays = Vec::new();
    loop {
        let texts: BTreeMap<PathBuf, String> = edits
            .iter()
            .map(|(file, own)| {
                let source = parsed.sources.file(*file);
                (PathBuf::from(&source.name), addresses::apply(&source.text, own))
            })
            .collect();
        let read = inputs::read_changed(&args.inputs, args.code_page, texts);
        let mut after = pipeline::front(read, &settings);
        if !after.has_errors() {
            let text = |bound: &pipeline::Bound| plcc_ir::print::module_text(&pipeline::lower(bound, Level::O0).module);
            if text(before) == text(&after) {
                return Ok(stays);
            }
            report::say("the sources would not be the same program, so nothing is written; please report it");
            return Err(exit::COMPILE);
        }
        after.diagnostics.retain(Diagnostic::is_error);
        let count = stays.len();
        for message in &after.diagnostics {
            stays.extend(taken_back(message, &after, parsed, edits));
        }
        if stays.len() == count {
            report::messages(&mut after.diagnostics, &after.sources);
            report::say("the sources would not compile, so nothing is written");
            return Err(exit::COMPILE);
        }
    }
}

/// Takes back the edits on the line of an error. Lines are those of the text before, since no edit has a line end.
fn taken_back(
    error: &Diagnostic,
    after: &pipeline::Bound,
    parsed: &pipeline::Parsed,
    edits: &mut Edits,
) -> Vec<Diagnostic> {
    let place = error.primary.span;
    let changed = after.sources.file(place.file);
    let line = changed.line(place.start);
    let Some((file, own)) = edits.iter_mut().find(|(file, _)| parsed.sources.file(*file).name == changed.name) else {
        return Vec::new();
    };
    let source = parsed.sources.file(*file);
    let mut taken: BTreeSet<usize> = BTreeSet::new();
    for (at, edit) in own.iter().enumerate() {
        if source.line(edit.span.start) == line {
            taken.insert(at);
        }
    }
    let mut messages = Vec::new();
    for at in taken.iter().rev() {
        let edit = own.remove(*at);
        let name = source.text.get(edit.span.range()).unwrap_or_default();
        let title = format!("`{name}` stays as it is: with `{}`, {}", edit.text, error.title);
        let mut message = Diagnostic::new(Code::NotConverted, edit.span, title);
        message.severity = Severity::Warning;
        messages.push(message.label("has no other form here"));
    }
    messages
}
