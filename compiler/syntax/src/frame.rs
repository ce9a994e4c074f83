//! What the grammars of all languages share: frames of blocks, and the place of a parse error.

use lalrpop_util::ParseError;
use plcc_diag::{Code, Diagnostic, Span};

use crate::ast::{BlockName, BlockPrefix, CodeKind};
use crate::stl::token::CodeKeyword;

/// Kind of the block `name`: from its keyword; SFC and SFB are told by the letters of the number. Wrong letters give a message, too.
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

/// The message for a block whose number has letters that its keyword does not go with.
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
