//! Classifies the words of the values of a data block, which come after BEGIN.

use super::{Classifier, is_end_of_block};
use crate::stl::mnemonics::{self, letters_and_digits};
use crate::stl::raw::{RawKind, RawToken};
use crate::stl::token::Tok;

impl Classifier<'_, '_> {
    /// Assignments after BEGIN.
    pub(super) fn values(&mut self) {
        self.may_be_long = false;
        let mut brackets = 0usize;
        while let Some(token) = self.peek() {
            self.file_pragmas(token.start);
            if matches!(token.kind, RawKind::Assign | RawKind::Semicolon) {
                self.may_be_long = token.kind == RawKind::Assign;
            }
            let upper = self.upper(self.at);
            let at_start = matches!(self.last(), Some(Tok::Semicolon | Tok::Begin));
            let after_value = matches!(
                self.last(),
                Some(
                    Tok::Literal(_)
                        | Tok::LongLiteral(..)
                        | Tok::BadOperand
                        | Tok::RightParen
                        | Tok::Assign
                        | Tok::Address(_)
                        | Tok::Block(..)
                        | Tok::Quoted(_)
                )
            );
            match token.kind {
                RawKind::Word if is_end_of_block(upper.as_str()) => break,
                RawKind::Word if token.first_on_line && self.block_keyword(self.at).is_some() => break,
                RawKind::Semicolon => {
                    brackets = 0;
                    if at_start {
                        self.at += 1;
                    } else {
                        self.take(Tok::Semicolon);
                    }
                }
                RawKind::Word
                    if matches!(self.last(), Some(Tok::Assign | Tok::LeftParen | Tok::Comma))
                        && matches!(upper.as_str(), "TRUE" | "FALSE") =>
                {
                    let tok = self.literal_token(self.slice(token), self.span(token));
                    self.take(tok);
                }
                RawKind::Word | RawKind::Quoted if after_value && token.first_on_line && brackets == 0 => {
                    self.missing_semicolon("assignment");
                }
                RawKind::Word if matches!(self.last(), Some(Tok::Assign)) && self.value_operand(token) => {}
                RawKind::Word => {
                    let name = self.slice(token);
                    self.take(Tok::Name(name));
                }
                _ => {
                    if !self.bracket_depth(token.kind, &mut brackets) {
                        break;
                    }
                    self.declaration_token();
                }
            }
        }
        if !matches!(self.last(), Some(Tok::Semicolon | Tok::Begin)) {
            self.missing_semicolon("assignment");
        }
    }

    /// Takes `T 5`, `Z6`, `DB 7`: the value of a parameter of type TIMER, COUNTER or BLOCK_x, with letters of either set.
    fn value_operand(&mut self, token: RawToken) -> bool {
        let upper = self.upper(self.at);
        let (letters, digits) = letters_and_digits(upper.as_str());
        let Some(cell) = mnemonics::cell(letters, None) else { return self.numbered_block() };
        let (number, count) = match self.raw_at(self.at + 1) {
            _ if !digits.is_empty() => (token, 1),
            Some(next) if next.kind == RawKind::Number && !next.first_on_line => (next, 2),
            _ => return false,
        };
        let text = if digits.is_empty() { self.slice(number) } else { digits };
        let Ok(value) = text.replace('_', "").parse() else { return false };
        let letters_end = token.start as usize + letters.len();
        self.push(token.start as usize, Tok::Cell(cell), letters_end);
        let start = if count == 1 { letters_end } else { number.start as usize };
        self.push(start, Tok::Address(value), number.end as usize);
        self.at += count;
        true
    }
}
