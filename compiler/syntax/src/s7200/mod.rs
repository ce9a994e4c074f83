//! STL of the S7-200 (Micro/WIN): lexer, grammar, instruction table, data blocks. Source: S7-200 system manual.
//!
//! ```text
//! text ──► raw tokens, by lines ──► tokens with a meaning ──► lines ──► syntax tree
//!      raw.rs                 classify/            s7200.lalrpop  blocks.rs
//! ```

pub mod address;
mod aliases;
pub mod ast;
mod blocks;
mod classify;
mod compare;
mod constant;
mod instructions;
pub mod libraries;
mod line;
mod meant;
mod messages;
mod mnemonics;
mod outline;
mod pragma;
mod raw;
mod suggest;
pub(crate) mod text;
mod token;

#[allow(clippy::all, clippy::pedantic, dead_code, unused_imports, unused_parens, missing_docs)] // Generated.
mod grammar {
    include!(concat!(env!("OUT_DIR"), "/s7200/s7200.rs"));
}

#[cfg(test)]
mod tests;

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use crate::ParseOptions;
use crate::ast::SourceUnit;
use crate::front::{self, ParseState};
use crate::stl::Mnemonics;

pub use address::with_zeros;
pub use aliases::{ALIASES, BOXES};
pub use compare::{Compare, CompareKind, Contact, Relation};
pub use instructions::{Acts, Insn, OperandClass};
pub use messages::form;
pub use outline::is_s7200;

/// Whether `word` is a mnemonic of either set, or another spelling of one.
pub fn is_mnemonic(word: &str) -> bool {
    mnemonics::any(&word.to_ascii_uppercase(), Mnemonics::En).is_some()
}

/// Whether `word` is a mnemonic, of either set or another spelling, whose instruction has operands.
pub fn has_operands(word: &str) -> bool {
    mnemonics::any(&word.to_ascii_uppercase(), Mnemonics::En).is_some_and(|insn| !insn.operands().is_empty())
}

/// How many operands the instruction of a mnemonic has, and what it does.
pub fn described(word: &str) -> Option<(String, &'static str)> {
    let insn = mnemonics::any(&word.to_ascii_uppercase(), Mnemonics::En)?;
    Some((form(insn, Mnemonics::En), insn.doc()))
}

/// Each mnemonic of a set, and what its instruction does.
pub fn mnemonics(set: Mnemonics) -> impl Iterator<Item = (String, &'static str)> {
    mnemonics::all().map(move |insn| (insn.mnemonic(set).into_owned(), insn.doc()))
}

/// The direct address that `text` is (`VW100`, `E 0.0` without its blank), in either set.
pub fn parse_address(text: &str) -> Option<ast::Direct> {
    address::parse(&text.trim().to_ascii_uppercase())?.ok()
}

/// An address as written in the international set: `VW100`.
pub fn address_text(direct: &ast::Direct) -> String {
    address::text(direct)
}

/// The constant that `text` is (`-5`, `16#FF`, `1.5`, `'AB'`, `"text"`), as in a symbol table.
pub fn parse_constant(text: &str) -> Option<ast::Constant> {
    use ast::Constant;
    let text = text.trim();
    if let Some(inner) = text.strip_prefix('\'').and_then(|text| text.strip_suffix('\'')) {
        return constant::text(inner).ok().map(Constant::Characters);
    }
    if let Some(inner) = text.strip_prefix('"').and_then(|text| text.strip_suffix('"')) {
        return constant::text(inner).ok().map(Constant::Text);
    }
    let digits = text.strip_prefix('+').unwrap_or(text);
    if let Ok((value, width)) = constant::based(digits, None) {
        return Some(Constant::Bits { value, width });
    }
    constant::integer(digits).map(Constant::Integer).or_else(|_| constant::real(digits).map(Constant::Real)).ok()
}

/// The block that `text` numbers: `SBR3`, `INT0`, `OB1`.
pub fn parse_block(text: &str) -> Option<(ast::BlockKind, u32)> {
    classify::block(&text.trim().to_ascii_uppercase())
}

/// Parses a source. Errors are recovered at the end of their line.
pub fn parse(file: FileId, text: &str, options: &ParseOptions) -> (SourceUnit, Vec<Diagnostic>) {
    let lines = raw::lines(text);
    let bare_data = outline::is_data(text, &lines);
    let detected = mnemonics::detect(text, &lines, options.mnemonics);
    let classified = classify::classify(file, text, &lines, &detected, options.pragmas, bare_data);
    let mut diagnostics = classified.diagnostics.clone();
    report_mixture(file, text, &detected, options, &mut diagnostics);
    let mut state = ParseState::new(file, text, &classified.tokens, detected.set).after(&diagnostics);
    let lines = match grammar::LinesParser::new().parse(&mut state, classified.stream()) {
        Ok(lines) => lines,
        // Each line recovers; a remaining error belongs to the last one.
        Err(error) => {
            let at = front::error_range(&error).map_or(text.len(), |(start, _)| start);
            let span = Span::new(file, at..at);
            state.diagnostics.push(
                Diagnostic::new(Code::Syntax, span, "the source ends too early")
                    .label("something is missing here")
                    .help("a statement is a mnemonic and its operands: `LD I0.0`"),
            );
            Vec::new()
        }
    };
    diagnostics.append(&mut state.diagnostics);
    let source = blocks::build(file, lines, bare_data, &mut diagnostics);
    diagnostics.sort_by_key(|diagnostic| diagnostic.primary.span.start);
    let unit = SourceUnit {
        mnemonics: detected.set,
        pragmas: classified.pragmas,
        s7200: Some(source),
        ..SourceUnit::default()
    };
    (unit, diagnostics)
}

/// Mnemonics of both sets in one file.
fn report_mixture(
    file: FileId,
    text: &str,
    detected: &mnemonics::Detected,
    options: &ParseOptions,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let Some((start, end)) = detected.foreign else { return };
    let name = |set| match set {
        Mnemonics::En => "international",
        Mnemonics::De => "German",
    };
    let (set, other) = (name(detected.set), name(mnemonics::other(detected.set)));
    let word = text.get(start..end).unwrap_or_default();
    let title = format!("`{word}` is a mnemonic of the {other} set in a file with the {set} one");
    let mut diagnostic = Diagnostic::new(Code::MixedMnemonics, Span::new(file, start..end), title)
        .label("a file uses one set only")
        .help(if options.mnemonics.is_some() {
            format!("the {set} set was requested; without `--mnemonics` plcc finds the set itself")
        } else {
            format!("write the whole file with the mnemonics of the {set} set")
        });
    if let Some((start, end)) = detected.own {
        diagnostic = diagnostic.also(Span::new(file, start..end), format!("mnemonic of the {set} set"));
    }
    diagnostics.push(diagnostic);
}

/// Bytes of the words, signs, constants and comments of a text, line by line.
pub fn pieces(text: &str) -> Vec<Vec<Range<usize>>> {
    raw::lines(text).iter().map(|line| line.iter().map(raw::RawToken::range).collect()).collect()
}

/// The tokens of a source as the grammar sees them, one per line, for `--emit tokens`.
pub fn tokens_text(text: &str, options: &ParseOptions) -> String {
    let lines = raw::lines(text);
    let detected = mnemonics::detect(text, &lines, options.mnemonics);
    let bare_data = outline::is_data(text, &lines);
    let classified = classify::classify(FileId::default(), text, &lines, &detected, options.pragmas, bare_data);
    front::tokens_text(text, &classified.tokens)
}
