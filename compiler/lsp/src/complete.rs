//! What can be written at a place, and the parameters of the call around it. `language` has what each language has.

mod language;

use std::ops::Range;

use lsp_types::{
    CompletionItem, CompletionItemKind, ParameterInformation, ParameterLabel, SignatureHelp, SignatureInformation,
};
use plcc_diag::FileId;
use plcc_syntax::ast::{Block, BlockName};
use plcc_syntax::stl::Mnemonics;
use plcc_syntax::symbols::Symbol;
use plcc_syntax::{Elementary, Language};

use crate::chart::Component;
use crate::constants::{self, Constant};
use crate::facts::{FunctionFacts, ParameterFacts};
use crate::index::{Declared, Entry, Index};
use crate::names::{Meaning, along, callee_around, open_bracket, part_before, values_before};
use crate::network;
use crate::words::{Words, bare, is_name};
use language::{Place, of_language};

/// The items at a byte.
pub fn complete(index: &Index, words: &Words, file: FileId, byte: usize, set: Mnemonics) -> Vec<CompletionItem> {
    let next = words.before(byte);
    if is_in_text(words, byte, next) {
        return Vec::new();
    }
    // The word that is being written.
    let writing = next.checked_sub(1).filter(|&at| words.range(at).end >= byte && is_name(words.word(at)));
    let first = writing.unwrap_or(next);
    let before = first.checked_sub(1).map_or("", |at| words.word(at));
    let written = writing.map_or("", |at| words.word(at));
    let entry = index.around(file, byte);
    if before == "." {
        return after_dot(index, words, file, first - 1);
    }
    if before == "#" || written.starts_with('#') || words.word(first) == "#" && words.range(first).end == byte {
        let sign = if before == "#" { first - 1 } else { first };
        let owner = sign.checked_sub(1).map_or("", |owner| words.word(owner));
        if words.language(sign) == Language::Sd && owner.eq_ignore_ascii_case("wire") {
            let wires = network::wires(words, sign).into_iter();
            return wires.map(|name| item(name, CompletionItemKind::REFERENCE, "wire")).collect();
        }
        return locals(index, entry);
    }
    if written.starts_with('"') || text_before(words, byte).ends_with('"') {
        return globals(index);
    }
    // What follows is an address.
    if text_before(words, byte).ends_with('%') {
        return Vec::new();
    }
    let language = words.language(first.min(words.pieces.len().saturating_sub(1)));
    if language != Language::S7200 && is_type(words, first) {
        return types(index, language);
    }
    let mut items = Vec::new();
    let begins = before == ":"
        || match writing {
            Some(at) => words.first_on_line(at),
            None => text_before(words, byte).trim().is_empty(),
        };
    // `CALL FB 1, ` without a list of parameters yet.
    let is_instance = language == Language::Stl && before == "," && !begins && open_bracket(words, first).is_none();
    // `#t.TON( ` has the pins of the element, not the parameters of the block TON as well.
    let is_element = || open_bracket(words, first).is_some_and(|open| network::signature(words, open).is_some());
    if matches!(before, "(" | ",") && !is_instance && !is_element() {
        items.extend(parameters(index, words, file, first));
    }
    // A line of a list of parameters has no mnemonic.
    let is_statement = begins && before != "," && items.is_empty();
    let place = Place { words, first, before, entry, set, is_statement };
    items.extend(of_language(index, language, place));
    items
}

/// Whether a byte is in a comment or in a text, where nothing is proposed. `next`: the first word after it.
fn is_in_text(words: &Words, byte: usize, next: usize) -> bool {
    let Some(around) = next.checked_sub(1) else { return false };
    let (word, end) = (words.word(around), words.range(around).end);
    match word {
        _ if word.starts_with("//") => byte <= end,
        // A text whose second quote is not written yet.
        _ if word.starts_with('\'') && (word.len() == 1 || !word.ends_with('\'')) => byte <= end,
        _ if word.starts_with("(*") || word.starts_with("/*") || word.starts_with('\'') => byte < end,
        _ => false,
    }
}

/// The components of what is before a dot, the word `dot`.
fn after_dot(index: &Index, words: &Words, file: FileId, dot: usize) -> Vec<CompletionItem> {
    if let Some(part) = part_before(index, words, file, dot) {
        let row = |one: &Component| CompletionItem {
            documentation: Some(lsp_types::Documentation::String(one.doc.to_owned())),
            ..item(one.name, CompletionItemKind::FIELD, one.ty)
        };
        return part.components().iter().map(row).collect();
    }
    let members = members_before(index, words, file, dot);
    if members.is_empty() {
        let values = values_before(index, words, file, dot).unwrap_or_default();
        return values.iter().map(|one| item(&one.name, CompletionItemKind::FIELD, &one.ty)).collect();
    }
    members.into_iter().map(|one| variable(index, one)).collect()
}

/// Types that are not elementary ones.
const TYPES: [&str; 4] = ["ARRAY", "DATE_AND_TIME", "STRING", "STRUCT"];

/// Whether a piece is where a declaration has its type: after `:` or OF, as in `list : ARRAY[0..3] OF INT`.
fn is_type(words: &Words, at: usize) -> bool {
    // Words that begin and end declarations. Statements have `:` and OF too, after labels and in CASE.
    const ENDS: [&str; 6] = ["BEGIN", "END_CONST", "END_TYPE", "END_VAR", "NETWORK", "RUNG"];
    const BEGINS: [&str; 10] = [
        "CONST",
        "FUNCTION",
        "STRUCT",
        "TYPE",
        "VAR",
        "VAR_IN_OUT",
        "VAR_INPUT",
        "VAR_OUTPUT",
        "VAR_STATIC",
        "VAR_TEMP",
    ];
    let is = |at: usize, list: &[&str]| list.iter().any(|own| own.eq_ignore_ascii_case(words.word(at)));
    if !at.checked_sub(1).is_some_and(|before| is(before, &[":", "OF"])) {
        return false;
    }
    let last = (0..at).rev().find(|&at| is(at, &ENDS) || is(at, &BEGINS));
    last.is_some_and(|at| is(at, &BEGINS))
}

/// Elementary types, and the data types and FBs of the program. Only the S7-1200 and S7-1500 have all; STL has those of the S7-300.
fn types(index: &Index, language: Language) -> Vec<CompletionItem> {
    let is_known = |ty: &&Elementary| language != Language::Stl || ty.is_of_s7300();
    let names = Elementary::ALL.iter().filter(is_known).map(|ty| ty.name());
    let mut items: Vec<CompletionItem> =
        names.chain(TYPES).map(|name| item(name, CompletionItemKind::KEYWORD, "")).collect();
    let blocks = index.blocks.iter().filter(|entry| matches!(entry.keyword(), "TYPE" | "FUNCTION_BLOCK"));
    items.extend(blocks.map(|entry| {
        let name = match entry.name() {
            BlockName::Symbol { name, .. } => format!("\"{name}\""),
            BlockName::Numbered { .. } => entry.text(),
        };
        item(&name, CompletionItemKind::STRUCT, entry.keyword())
    }));
    items
}

/// The text of the line up to a byte.
fn text_before<'t>(words: &Words<'t>, byte: usize) -> &'t str {
    let text = words.text.get(..byte).unwrap_or_default();
    text.rsplit('\n').next().unwrap_or_default()
}

fn item(label: &str, kind: CompletionItemKind, detail: &str) -> CompletionItem {
    let detail = Some(detail.to_owned()).filter(|detail| !detail.is_empty());
    CompletionItem { label: label.to_owned(), kind: Some(kind), detail, ..CompletionItem::default() }
}

fn variable(index: &Index, (direction, variable): Declared) -> CompletionItem {
    let detail = format!("{} {direction}", index.type_text(&variable.ty));
    CompletionItem {
        documentation: variable.comment.clone().map(lsp_types::Documentation::String),
        ..item(&variable.name, CompletionItemKind::FIELD, detail.trim())
    }
}

fn function(function: &FunctionFacts) -> CompletionItem {
    let parameters: Vec<String> = function.parameters.iter().map(ParameterFacts::text).collect();
    let description = Some(&function.description).filter(|text| !text.is_empty());
    CompletionItem {
        documentation: description.cloned().map(lsp_types::Documentation::String),
        ..item(&function.name, CompletionItemKind::FUNCTION, &format!("({})", parameters.join(", ")))
    }
}

/// Variables and constants of a block.
fn locals(index: &Index, entry: Option<Entry>) -> Vec<CompletionItem> {
    let Some(entry) = entry else { return Vec::new() };
    let mut items: Vec<CompletionItem> = entry.variables().into_iter().map(|one| variable(index, one)).collect();
    items.extend(constants::of(entry).iter().map(|one| constant(index, Constant::Local(entry, one))));
    items
}

fn constant(index: &Index, constant: Constant) -> CompletionItem {
    item(constant.name(), CompletionItemKind::CONSTANT, &constant.value(index))
}

/// Blocks with names, symbols and constants.
fn globals(index: &Index) -> Vec<CompletionItem> {
    let named = index.blocks.iter().filter(|entry| matches!(entry.name(), BlockName::Symbol { .. }));
    let block = |entry: &Entry| item(&entry.text(), CompletionItemKind::MODULE, entry.keyword());
    let mut items: Vec<CompletionItem> = named.map(block).collect();
    items.extend(index.checked.tables.iter().flat_map(|table| &table.symbols).map(symbol));
    let constants = index.checked.tables.iter().flat_map(|table| &table.constants);
    items.extend(constants.map(|one| constant(index, Constant::Global(one))));
    items
}

fn symbol(symbol: &Symbol) -> CompletionItem {
    let detail = format!("{} {} {}", crate::hover::target_text(symbol.target), symbol.ty, symbol.comment);
    item(&symbol.name, CompletionItemKind::VARIABLE, detail.trim())
}

/// What can follow the point at a piece.
fn members_before<'c>(index: &Index<'c>, words: &Words, file: FileId, point: usize) -> Vec<Declared<'c>> {
    let Some(owner) = point.checked_sub(1).and_then(|end| words.before_indices(end)) else { return Vec::new() };
    let (first, names) = words.path(owner);
    let entry = index.around(file, words.range(owner).start);
    let local = words.word(first).starts_with('#');
    match along(index, entry, &names, local) {
        Some(Meaning::Variable { declared, .. }) => index.members(&declared.1.ty),
        Some(Meaning::Block(entry)) => match entry.block {
            // `#Sum.` in the function Sum.
            Block::Code(block) if local => block.return_type.as_ref().map_or(Vec::new(), |ty| index.members(ty)),
            Block::Code(_) | Block::Data(_) | Block::Type(_) => index.inside(entry),
        },
        _ => Vec::new(),
    }
}

/// `name := ` for each parameter that the call does not have yet.
fn parameters(index: &Index, words: &Words, file: FileId, at: usize) -> Vec<CompletionItem> {
    let Some(callee) = callee_around(index, words, file, at) else { return Vec::new() };
    let open = open_bracket(words, at).unwrap_or(at);
    let given: Vec<&str> =
        (open..at).filter(|&at| matches!(words.word(at + 1), ":=" | "=>")).map(|at| bare(words.word(at))).collect();
    let language = words.language(open.min(words.pieces.len().saturating_sub(1)));
    let row = |one: &ParameterFacts| {
        let name = one.name_after(&given)?;
        let sign = if one.direction == "OUT" && language != Language::Stl { "=>" } else { ":=" };
        Some(CompletionItem {
            insert_text: Some(format!("{name} {sign} ")),
            sort_text: Some(format!(" {name}")),
            ..item(&name, CompletionItemKind::FIELD, format!("{} {}", one.ty, one.direction).trim_start())
        })
    };
    callee.arguments(index, language).iter().filter_map(row).collect()
}

/// The parameters of the call around a byte.
pub fn signature(index: &Index, words: &Words, file: FileId, byte: usize) -> Option<SignatureHelp> {
    let at = words.before(byte);
    let open = open_bracket(words, at)?;
    let (callee, rows) = match network::signature(words, open) {
        Some(element) => element,
        None => {
            let callee = callee_around(index, words, file, open + 1)?;
            (callee.name(), callee.arguments(index, words.language(open)))
        }
    };
    let texts: Vec<String> = rows.iter().map(ParameterFacts::text).collect();
    let own = directly_in(words, open..at);
    let named = own.iter().rev().find(|&&at| matches!(words.word(at + 1), ":=" | "=>")).map(|&at| bare(words.word(at)));
    let after_comma = at.checked_sub(1).is_some_and(|before| words.word(before) == ",");
    let active = match named {
        Some(name) if !after_comma => rows.iter().position(|row| row.is_called(name)),
        _ => {
            let commas = own.iter().filter(|&&at| words.word(at) == ",").count();
            // Each further value is one more of the numbered ones.
            Some(rows.iter().position(|row| row.is_numbered).map_or(commas, |numbered| commas.min(numbered)))
        }
    };
    Some(help(format!("{callee}({})", texts.join(", ")), &texts, active))
}

/// The pieces of a range that begins with a bracket, without those in brackets in it: in `MAX(LIMIT(1, 2, 3), 4`, one comma.
fn directly_in(words: &Words, range: Range<usize>) -> Vec<usize> {
    let mut depth = 0usize;
    let is_own = |at: &usize| {
        match words.word(*at) {
            "(" | "[" => depth += 1,
            ")" | "]" => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 1
    };
    range.filter(is_own).collect()
}

/// The parameters of a call, with the number of the one at the cursor.
pub fn help(label: String, parameters: &[String], active: Option<usize>) -> SignatureHelp {
    let information =
        |label: &String| ParameterInformation { label: ParameterLabel::Simple(label.clone()), documentation: None };
    SignatureHelp {
        signatures: vec![SignatureInformation {
            label,
            documentation: None,
            parameters: Some(parameters.iter().map(information).collect()),
            active_parameter: None,
        }],
        active_signature: Some(0),
        active_parameter: active.map(|active| active as u32),
    }
}
