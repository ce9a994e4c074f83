//! Common parts of the grammars of all languages: frames of blocks, and the position of a parse error.

use lalrpop_util::ParseError;
use plcc_diag::{Code, Diagnostic, Span};

use std::ops::Range;

use crate::ast::{BlockName, BlockPrefix, CodeKind, Header};
use crate::stl::token::{CodeKeyword, HeaderField, HeaderFlag};

/// A part of a header.
pub enum HeaderPart {
    Title(String),
    Text(HeaderField, String),
    Flag(HeaderFlag),
    Attributes(Vec<(String, String)>),
}

/// The header of a block, with its comment lines.
pub fn header(comment: Vec<String>, parts: Vec<HeaderPart>) -> Header {
    let mut header = Header { comment, ..Header::default() };
    for part in parts {
        match part {
            HeaderPart::Title(text) => header.title = Some(text),
            HeaderPart::Text(HeaderField::Author, text) => header.author = Some(text),
            HeaderPart::Text(HeaderField::Family, text) => header.family = Some(text),
            HeaderPart::Text(HeaderField::Name, text) => header.name = Some(text),
            HeaderPart::Text(HeaderField::Version, text) => header.version = Some(text),
            HeaderPart::Flag(HeaderFlag::KnowHowProtect) => header.know_how_protect = true,
            HeaderPart::Flag(HeaderFlag::Standard) => header.standard = true,
            HeaderPart::Flag(HeaderFlag::CodeVersion1) => header.code_version1 = true,
            HeaderPart::Flag(HeaderFlag::Unlinked) => header.unlinked = true,
            HeaderPart::Flag(HeaderFlag::ReadOnly) => header.read_only = true,
            HeaderPart::Flag(HeaderFlag::NonRetain) => header.non_retain = true,
            HeaderPart::Attributes(attributes) => header.attributes.extend(attributes),
        }
    }
    header
}

/// Kind of the block `name`: from its keyword; the letters of the number distinguish SFC and SFB. Wrong letters are reported, too.
pub fn code_kind(keyword: CodeKeyword, name: &BlockName, text: &str) -> (CodeKind, Option<Diagnostic>) {
    let (kind, keyword, letters) = match keyword {
        CodeKeyword::OrganizationBlock => (CodeKind::Ob, "ORGANIZATION_BLOCK", "OB"),
        CodeKeyword::Function => (CodeKind::Fc, "FUNCTION", "FC"),
        CodeKeyword::FunctionBlock => (CodeKind::Fb, "FUNCTION_BLOCK", "FB"),
    };
    let BlockName::Numbered { prefix, number, span } = name else { return (kind, None) };
    match (kind, prefix) {
        (CodeKind::Ob, BlockPrefix::Ob) | (CodeKind::Fc, BlockPrefix::Fc) | (CodeKind::Fb, BlockPrefix::Fb) => {
            (kind, None)
        }
        (CodeKind::Fc, BlockPrefix::Sfc) => (CodeKind::Sfc, None),
        (CodeKind::Fb, BlockPrefix::Sfb) => (CodeKind::Sfb, None),
        _ => (kind, Some(wrong_letters(*span, keyword, letters, *number, text))),
    }
}

/// The message for a block whose number has a prefix that does not fit its keyword.
pub fn wrong_letters(span: Span, keyword: &str, letters: &str, number: u32, text: &str) -> Diagnostic {
    Diagnostic::new(Code::BlockFrame, span, format!("`{keyword}` cannot name `{}`", &text[span.range()]))
        .label(format!("a block with this keyword is numbered as {letters}"))
        .help(format!("write `{keyword} {letters} {number}`, or the keyword that belongs to the block"))
}

/// Bytes of the token at which a parse error was found.
pub fn error_range<T>(error: &ParseError<usize, T, ()>) -> Option<(usize, usize)> {
    match error {
        ParseError::UnrecognizedToken { token, .. } | ParseError::ExtraToken { token } => Some((token.0, token.2)),
        ParseError::UnrecognizedEof { location, .. } | ParseError::InvalidToken { location } => {
            Some((*location, *location))
        }
        ParseError::User { .. } => None,
    }
}

/// Whether there is already a message within `range`: one of the classifier, whose starts are in `reported` in order, or the last one of the grammar.
pub fn is_reported(reported: &[u32], diagnostics: &[Diagnostic], range: Range<usize>) -> bool {
    let first = reported.partition_point(|&reported| (reported as usize) < range.start);
    let inside = |start: u32| (range.start..=range.end).contains(&(start as usize));
    reported.get(first).is_some_and(|&start| inside(start))
        || diagnostics.last().is_some_and(|last| inside(last.primary.span.start))
}
