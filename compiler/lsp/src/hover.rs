//! What an editor shows about the word under the pointer.

use plcc_diag::FileId;
use plcc_syntax::stl::{self, StlInsn};
use plcc_syntax::symbols::{Symbol, SymbolTarget};
use plcc_syntax::{Language, s7200};

use crate::address::{self, Address};
use crate::constants::Constant;
use crate::facts::{self, Facts, ParameterFacts};
use crate::index::{Entry, Index};
use crate::names::{Callee, Meaning, meaning, part_before, values_before};
use crate::network;
use crate::words::{Words, bare};

/// Markdown about a piece.
pub fn hover(index: &Index, words: &Words, file: FileId, at: usize) -> Option<String> {
    let Some(found) = meaning(index, words, file, at) else {
        let found = component(index, words, file, at).or_else(|| value(index, words, file, at));
        return found.or_else(|| network::hover(words, at));
    };
    match found {
        Meaning::Variable { declared: (direction, variable), path, owner } => {
            let mut text = code(&format!("{} : {}", path.join("."), index.type_text(&variable.ty)));
            if !direction.is_empty() {
                // Not `owner`: a path goes through instances and structures.
                let entry = index.around(variable.name_span.file, variable.name_span.start as usize);
                let inside = entry.map(|own| format!(" of {} {}", own.keyword(), own.text())).unwrap_or_default();
                let what = if direction == "TYPE" { "component" } else { direction };
                text.push_str(&format!("{what}{inside}\n"));
            }
            if let Some(place) = owner.and_then(|owner| place(index, owner, &path)) {
                text.push_str(&format!("\n{place}\n"));
            }
            if let Some(comment) = &variable.comment {
                text.push_str(&format!("\n{comment}\n"));
            }
            Some(text)
        }
        Meaning::Block(entry) => Some(block(index, entry)),
        Meaning::Library(found) => {
            let callee = Callee::Library(found);
            let description = paragraph(&Facts::description(found));
            Some(format!("{}{description}{}\n", code(&callee.name()), parameters(index, &callee)))
        }
        Meaning::Function(found) => {
            let callee = Callee::Function(found);
            let description = paragraph(&found.description);
            Some(format!("{}{description}{}\n", code(&callee.name()), parameters(index, &callee)))
        }
        Meaning::Symbol(symbol) => Some(symbol_text(symbol)),
        Meaning::Constant(constant) => Some(constant_text(index, constant)),
        Meaning::Chart(part) => {
            Some(format!("{}\n{}\n", code(&format!("{} {}", part.kind(), part.name())), part.comment()))
        }
        Meaning::Label(label) => Some(format!("{}jump label\n", code(label.name))),
        Meaning::Address(found) => address_text(index, words, at, &found),
        Meaning::Word(word) => instruction(words.language(at), &word).or_else(|| network::hover(words, at)),
    }
}

/// Markdown about what a row of a symbol table names.
pub fn row(index: &Index, found: &Meaning) -> Option<String> {
    match found {
        Meaning::Block(entry) => Some(block(index, *entry)),
        Meaning::Symbol(symbol) => Some(symbol_text(symbol)),
        Meaning::Constant(constant) => Some(constant_text(index, *constant)),
        Meaning::Variable { .. }
        | Meaning::Library(_)
        | Meaning::Function(_)
        | Meaning::Chart(_)
        | Meaning::Label(_)
        | Meaning::Address(_)
        | Meaning::Word(_) => None,
    }
}

fn constant_text(index: &Index, constant: Constant) -> String {
    let value = constant.value(index);
    let colon = if value.starts_with(":=") { "" } else { ": " };
    let text = code(&format!("{} {colon}{value}", constant.name()));
    format!("{text}constant of {}\n", constant.owner())
}

fn code(text: &str) -> String {
    format!("```plc\n{text}\n```\n")
}

fn paragraph(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("{text}\n\n") }
}

fn block(index: &Index, entry: Entry) -> String {
    let returns = entry.return_type().map(|ty| format!(" : {}", index.type_text(ty))).unwrap_or_default();
    let mut text = code(&format!("{} {}{returns}", entry.keyword(), entry.text()));
    if let Some(title) = entry.title() {
        text.push_str(&format!("{title}\n\n"));
    }
    text + &parameters(index, &Callee::Source(entry))
}

fn parameters(index: &Index, callee: &Callee) -> String {
    let rows = callee.parameters(index);
    let row = |one: &ParameterFacts| {
        let more = if one.is_numbered { " …" } else { "" };
        let optional = if one.is_optional { ", may be missing" } else { "" };
        let kind = format!("{} {}", one.direction, one.ty);
        format!("- `{}`{more} {}{optional}\n", one.name, kind.trim_end())
    };
    rows.iter().map(row).collect()
}

/// The address of a value, as far as it has one.
fn place(index: &Index, owner: Entry, path: &[String]) -> Option<String> {
    let names: Vec<&str> = path.iter().map(String::as_str).collect();
    let facts = &index.checked.facts;
    let key = owner.text();
    if owner.keyword() == "DATA_BLOCK" {
        let db = facts.db(&key.replace(' ', "")).or_else(|| facts.db(&key))?;
        let inner = facts::find(&db.members, &names).or_else(|| facts::find(&db.members, names.get(1..)?))?;
        return Some(format!("`{}`", facts::db_address(db.number, inner.1, inner.0)));
    }
    let block = facts.block(&key)?;
    let (value, byte) = facts::find(&block.instance, &names)?;
    Some(format!("byte {byte}.{} of the instance", value.bit))
}

/// The address of a symbol in international letters.
pub fn target_text(target: SymbolTarget) -> String {
    use plcc_syntax::ast::{CellKind, Width};
    match target {
        SymbolTarget::Memory { area, width, byte, bit } => {
            let area = format!("{area:?}").to_ascii_uppercase();
            match width {
                Width::Bit => format!("{area} {byte}.{bit}"),
                Width::Byte => format!("{area}B {byte}"),
                Width::Word => format!("{area}W {byte}"),
                Width::Dword => format!("{area}D {byte}"),
                Width::Lword => format!("{area}L {byte}"),
            }
        }
        SymbolTarget::Cell { kind: CellKind::Timer, number } => format!("T {number}"),
        SymbolTarget::Cell { kind: CellKind::Counter, number } => format!("C {number}"),
        SymbolTarget::Block { prefix, number } => format!("{} {number}", prefix.letters()),
    }
}

fn symbol_text(symbol: &Symbol) -> String {
    let ty = if symbol.ty.is_empty() { String::new() } else { format!(" : {}", symbol.ty) };
    let text = code(&format!("\"{}\"{ty}", symbol.name));
    format!("{text}`{}`\n\n{}\n", target_text(symbol.target), symbol.comment)
}

fn address_text(index: &Index, words: &Words, at: usize, found: &Address) -> Option<String> {
    let mut text = String::new();
    for symbol in index.checked.tables.iter().flat_map(|table| &table.symbols) {
        let own = target_text(symbol.target).replace(' ', "");
        if address::plain(&own).is_some_and(|own| own.overlaps(found)) {
            text.push_str(&format!("- `\"{}\"` {own} {} {}\n", symbol.name, symbol.ty, symbol.comment));
        }
    }
    let bits = match found.bits {
        1 => "one bit".to_owned(),
        bits => format!("{bits} bits"),
    };
    // `M 10.3` is two pieces, and either may be under the pointer.
    let is_it = |first: &usize| address::at(words, *first).as_ref() == Some(found);
    let first = (at.saturating_sub(found.pieces - 1)..=at).find(is_it).unwrap_or(at);
    let whole = words.text.get(words.range(first).start..words.range(first + found.pieces - 1).end);
    Some(format!("{}{bits} of {}\n\n{text}", code(whole.unwrap_or_default()), found.area))
}

/// `Fill.T` of a chart.
fn component(index: &Index, words: &Words, file: FileId, at: usize) -> Option<String> {
    let point = at.checked_sub(1).filter(|point| words.word(*point) == ".")?;
    let part = part_before(index, words, file, point)?;
    let found = part.components().iter().find(|one| facts::same(one.name, words.word(at)))?;
    Some(format!("{}{}\n", code(&format!("{}.{} : {}", part.name(), found.name, found.ty)), found.doc))
}

/// `t.Q` of an instance of a library block.
fn value(index: &Index, words: &Words, file: FileId, at: usize) -> Option<String> {
    let point = at.checked_sub(1).filter(|point| words.word(*point) == ".")?;
    let mut values = values_before(index, words, file, point)?.iter();
    let found = values.find(|one| facts::same(&one.name, bare(words.word(at))))?;
    Some(code(&format!("{} : {}", found.name, found.ty)))
}

/// What the table says about a mnemonic.
fn instruction(language: Language, word: &str) -> Option<String> {
    match language {
        Language::Stl => {
            let insn = StlInsn::ALL
                .iter()
                .find(|insn| [stl::Mnemonics::En, stl::Mnemonics::De].iter().any(|set| insn.mnemonic(*set) == word))?;
            // A word of both sets is taken as an international one.
            let is_german = insn.mnemonic(stl::Mnemonics::En) != word;
            let set = if is_german { stl::Mnemonics::De } else { stl::Mnemonics::En };
            let (english, german) = (insn.mnemonic(stl::Mnemonics::En), insn.mnemonic(stl::Mnemonics::De));
            let head = if english == german { code(english) } else { code(&format!("{english} / {german}")) };
            let table = format!("`BR CC1 CC0 OV OS OR STA RLO /FC`\n\n`{}`", insn.status());
            Some(format!(
                "{head}{}\n\nOperand: {}\n\n{table}\n",
                insn.doc().trim(),
                stl::operand_phrase(insn.operand(), set)
            ))
        }
        Language::S7200 => {
            s7200::described(word).map(|(form, doc)| format!("{}{}\n\n{form}\n", code(word), doc.trim()))
        }
        Language::Scl | Language::Sd | Language::Graph => None,
    }
}
