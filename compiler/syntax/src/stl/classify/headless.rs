//! A block whose first word is missing: `FB 10` in a line of its own, before declarations.

use super::{Classifier, is_end_of_block};
use crate::ast::BlockPrefix;
use crate::front::frame;
use crate::stl::mnemonics::{block_prefix, letters_and_digits};
use crate::stl::raw::RawKind;
use crate::stl::token::{CodeKeyword, Tok};

/// What a line like `FB 10` stands for.
struct Headless {
    /// The word that is missing.
    word: &'static str,
    keyword: Tok<'static>,
    /// Index after the number.
    after: usize,
}

impl Classifier<'_, '_> {
    /// Reads the block, whose word is reported; `false`: something else is here.
    pub(super) fn block_without_keyword(&mut self) -> bool {
        let Some(Headless { word, keyword, after }) = self.headless() else { return false };
        let opening = self.raw[self.at];
        let (start, end) = (opening.start as usize, self.raw[after - 1].end as usize);
        let name = &self.text[start..end];
        self.report(frame::no_keyword_before_name(self.span_of(start, end), word, name));
        self.push(start, keyword.clone(), start);
        self.after_keyword(opening, &keyword, false);
        true
    }

    fn headless(&self) -> Option<Headless> {
        self.peek().filter(|token| token.first_on_line)?;
        let upper = self.upper(self.at);
        let (letters, digits) = letters_and_digits(upper.as_str());
        let (word, end, keyword) = match block_prefix(letters)? {
            BlockPrefix::Ob => {
                ("ORGANIZATION_BLOCK", "END_ORGANIZATION_BLOCK", Tok::Code(CodeKeyword::OrganizationBlock))
            }
            BlockPrefix::Fc => ("FUNCTION", "END_FUNCTION", Tok::Code(CodeKeyword::Function)),
            BlockPrefix::Fb => ("FUNCTION_BLOCK", "END_FUNCTION_BLOCK", Tok::Code(CodeKeyword::FunctionBlock)),
            BlockPrefix::Db => ("DATA_BLOCK", "END_DATA_BLOCK", Tok::DataBlock),
            BlockPrefix::Udt => ("TYPE", "END_TYPE", Tok::Type),
            BlockPrefix::Sfc | BlockPrefix::Sfb | BlockPrefix::Di | BlockPrefix::Vat => return None,
        };
        let on_line = |index: usize| self.raw_at(index).is_some_and(|token| !token.first_on_line);
        let after = if digits.is_empty() { self.at + 2 } else { self.at + 1 };
        if digits.is_empty() && !(on_line(self.at + 1) && self.kind_at(self.at + 1) == Some(RawKind::Number)) {
            return None;
        }
        // The type of a function.
        let typed = word == "FUNCTION" && self.kind_at(after) == Some(RawKind::Colon);
        let next = if typed { (after..).find(|index| !on_line(*index))? } else { after };
        let goes_on = matches!(self.kind_at(next), Some(RawKind::Title | RawKind::LeftBrace))
            || self.upper(next).as_str() == "STRUCT"
            || self.header_keyword(next);
        let last = (next..self.raw.len()).find(|index| is_end_of_block(self.upper(*index).as_str()))?;
        (!on_line(next) && goes_on && self.upper(last).as_str() == end).then_some(Headless { word, keyword, after })
    }
}
