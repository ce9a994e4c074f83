//! A block whose first word is missing: `FB 10`, `"Motor"` or `DB 1 FB 10` in a line of its own, before declarations.

use super::{Classifier, is_end_of_block};
use crate::ast::BlockPrefix;
use crate::front::frame;
use crate::stl::mnemonics::{block_prefix, letters_and_digits};
use crate::stl::raw::RawKind;
use crate::stl::token::{CodeKeyword, Tok};

/// Tokens of a type after the name of a block, and the one after it.
const TYPE_TOKENS_MAX: usize = 8;

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
        let token = self.peek().filter(|token| token.first_on_line)?;
        let on_line = |index: usize| self.raw_at(index).is_some_and(|token| !token.first_on_line);
        let (prefix, after) = if token.kind == RawKind::Quoted {
            (None, self.at + 1)
        } else {
            let upper = self.upper(self.at);
            let (letters, digits) = letters_and_digits(upper.as_str());
            let prefix = block_prefix(letters)?;
            let number = on_line(self.at + 1) && self.kind_at(self.at + 1) == Some(RawKind::Number);
            match (digits.is_empty(), number) {
                (false, _) => (Some(prefix), self.at + 1),
                (true, true) => (Some(prefix), self.at + 2),
                (true, false) => return None,
            }
        };
        // The type of a function or of a data block.
        let next = (after..after + TYPE_TOKENS_MAX).find(|index| !on_line(*index))?;
        let goes_on = matches!(self.kind_at(next), Some(RawKind::Title | RawKind::LeftBrace))
            || self.upper(next).as_str() == "STRUCT"
            || self.header_keyword(next);
        if !goes_on {
            return None;
        }
        let frames =
            |index: &usize| is_end_of_block(self.upper(*index).as_str()) || self.block_keyword(*index).is_some();
        let last = (next..self.raw.len()).find(frames)?;
        let (word, keyword, number) = match self.upper(last).as_str() {
            "END_ORGANIZATION_BLOCK" => {
                ("ORGANIZATION_BLOCK", Tok::Code(CodeKeyword::OrganizationBlock), BlockPrefix::Ob)
            }
            "END_FUNCTION" => ("FUNCTION", Tok::Code(CodeKeyword::Function), BlockPrefix::Fc),
            "END_FUNCTION_BLOCK" => ("FUNCTION_BLOCK", Tok::Code(CodeKeyword::FunctionBlock), BlockPrefix::Fb),
            "END_DATA_BLOCK" => ("DATA_BLOCK", Tok::DataBlock, BlockPrefix::Db),
            "END_TYPE" => ("TYPE", Tok::Type, BlockPrefix::Udt),
            _ => return None,
        };
        let has_type = match word {
            "FUNCTION" => next == after || self.kind_at(after) == Some(RawKind::Colon),
            "DATA_BLOCK" => next == after || matches!(self.kind_at(after), Some(RawKind::Quoted | RawKind::Word)),
            _ => next == after,
        };
        let fits = prefix.is_none_or(|prefix| prefix == number) && has_type;
        fits.then_some(Headless { word, keyword, after })
    }
}
