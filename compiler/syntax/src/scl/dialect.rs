//! Which form of SCL a file shows. Its features select defaults; both forms are always accepted.
//!
//! Source: SCL reference, dialects.

use super::address;
use super::ast::Dialect;
use super::keyword::Keyword;
use super::outline::modern_type;
use super::raw::{RawKind, RawText, RawToken};

/// The dialect of a source: that of the TIA Portal if the source has any feature of it.
pub fn of(text: &str, raw: &RawText) -> Dialect {
    let mut scan = Scan { text, tokens: &raw.tokens, classic: false, statements: false };
    let tia =
        text.starts_with('\u{FEFF}') || !raw.regions.is_empty() || (0..raw.tokens.len()).any(|index| scan.tia(index));
    if tia {
        Dialect::Tia
    } else if scan.classic {
        Dialect::Classic
    } else {
        Dialect::Either
    }
}

struct Scan<'a> {
    text: &'a str,
    tokens: &'a [RawToken],
    /// A feature of the classic form has been seen.
    classic: bool,
    /// Inside the statements of a block.
    statements: bool,
}

impl Scan<'_> {
    fn kind(&self, index: usize) -> Option<RawKind> {
        self.tokens.get(index).map(|token| token.kind)
    }

    fn word(&self, index: usize) -> &str {
        match self.tokens.get(index) {
            Some(token) if token.kind == RawKind::Word => &self.text[token.range()],
            _ => "",
        }
    }

    /// Whether the token is a feature of the TIA Portal. Remembers classic features.
    fn tia(&mut self, index: usize) -> bool {
        let token = self.tokens[index];
        let text = &self.text[token.range()];
        match token.kind {
            RawKind::Local
            | RawKind::Arrow
            | RawKind::Slice
            | RawKind::AddAssign
            | RawKind::SubtractAssign
            | RawKind::MultiplyAssign
            | RawKind::DivideAssign
            | RawKind::AttemptAssign => true,
            RawKind::Absolute => text.starts_with('%'),
            RawKind::LeftBracket => self.kind(index + 1) == Some(RawKind::Star),
            RawKind::Literal => {
                let prefix = text.split('#').next().unwrap_or_default();
                modern_type(prefix) || ["LT", "LW"].iter().any(|known| known.eq_ignore_ascii_case(prefix))
            }
            RawKind::Text => {
                self.classic |= text.contains("$>");
                false
            }
            RawKind::Word => self.tia_word(index, token),
            _ => false,
        }
    }

    fn tia_word(&mut self, index: usize, token: RawToken) -> bool {
        let before = index.checked_sub(1).and_then(|before| self.tokens.get(before)).copied();
        match token.keyword {
            Some(Keyword::RefTo) => return true,
            Some(Keyword::Const | Keyword::Label) => self.classic = true,
            Some(Keyword::Begin) => self.statements = true,
            Some(word) if word.ends_block() => self.statements = false,
            Some(Keyword::FunctionBlock | Keyword::Function | Keyword::OrganizationBlock | Keyword::DataBlock) => {
                let name = self.word(index + 1);
                self.classic |= address::numbered_block(name).is_some() || address::block_prefix(name).is_some();
                self.statements = false;
            }
            Some(Keyword::Var) if self.word(index + 1).eq_ignore_ascii_case("CONSTANT") => return true,
            Some(_) => {}
            None => {
                let word = &self.text[token.range()];
                if word.eq_ignore_ascii_case("S7_Optimized_Access") {
                    return true;
                }
                let typed =
                    before.is_some_and(|before| before.kind == RawKind::Colon || before.keyword == Some(Keyword::Of));
                if typed && modern_type(word) {
                    return true;
                }
                self.classic |= self.classic_word(index, word, before);
            }
        }
        false
    }

    /// `level := 5`, `OK`, `MW[i]`, `DB10.DW[i]`, `FB10.DB20(…)`
    fn classic_word(&self, index: usize, word: &str, before: Option<RawToken>) -> bool {
        let member = before.is_some_and(|before| before.kind == RawKind::Dot);
        match self.kind(index + 1) {
            Some(RawKind::LeftBracket) if member => address::db_area_word(word).is_some(),
            Some(RawKind::LeftBracket) => address::area_word(word).is_some(),
            Some(RawKind::LeftParen) if member => {
                address::numbered_block(word).is_some_and(|(prefix, _)| prefix == crate::ast::BlockPrefix::Db)
            }
            Some(RawKind::Assign) if self.statements && !member => before.is_some_and(|before| {
                before.kind == RawKind::Semicolon
                    || matches!(
                        before.keyword,
                        Some(Keyword::Begin | Keyword::Then | Keyword::Else | Keyword::Do | Keyword::Repeat)
                    )
            }),
            _ => self.statements && !member && word.eq_ignore_ascii_case("OK"),
        }
    }
}
