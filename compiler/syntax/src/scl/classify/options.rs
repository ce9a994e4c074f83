//! Options of the compiler of S7-SCL, outside blocks: `{ SCL_ResetOptions; SCL_SetOKFlag := 'y' }`. They hold for the blocks that follow.

use super::Classifier;
use crate::scl::raw::RawKind;
use crate::scl::token::Tok;

/// The only option that has an effect on what a block does.
const SET_OK: &str = "SCL_SetOKFlag";

/// Tokens of a list of options.
const TOKENS_MAX: usize = 200;

impl Classifier<'_, '_> {
    /// Takes a list of options; `false`: the brace begins something else.
    pub(super) fn options(&mut self) -> bool {
        let list = &self.raw[self.at + 1..];
        let is_option = |word: &str| word.get(..4).is_some_and(|start| start.eq_ignore_ascii_case("SCL_"));
        let begins = list.first().is_some_and(|token| token.kind == RawKind::Word && is_option(self.slice(*token)));
        let close = list.iter().take(TOKENS_MAX).position(|token| token.kind == RawKind::RightBrace);
        let Some(close) = close.filter(|_| begins) else { return false };
        for index in self.at + 1..self.at + 1 + close {
            let word = self.slice(self.raw[index]);
            if word.eq_ignore_ascii_case("SCL_ResetOptions") {
                self.sets_ok = None;
            } else if word.eq_ignore_ascii_case(SET_OK) && self.kind_at(index + 1) == Some(RawKind::Assign) {
                self.sets_ok = self.raw.get(index + 2).map(|value| self.slice(*value).trim_matches('\''));
            }
        }
        self.at += close + 2;
        true
    }

    /// The options that hold for a block, as attributes of its header.
    pub(super) fn options_of_block(&mut self) {
        if let Some(value) = self.sets_ok {
            self.push_here(Tok::Attribute(SET_OK, value));
        }
    }
}
