//! Words of statements that are misspelt, or that other languages have.

use super::cases::is_switch;
use super::{Repair, begins_operand, closer, ends_operand};
use crate::front::frame_words::slip_of;
use crate::scl::address;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// Words of other languages for a statement or an operator.
const ALIASES: [(&str, Keyword); 24] = [
    ("ELIF", Keyword::Elsif),
    ("ELSE_IF", Keyword::Elsif),
    ("WENN", Keyword::If),
    ("DANN", Keyword::Then),
    ("SONST", Keyword::Else),
    ("OTHERWISE", Keyword::Else),
    ("DEFAULT", Keyword::Else),
    ("OTHERS", Keyword::Else),
    ("BREAK", Keyword::Exit),
    ("LEAVE", Keyword::Exit),
    ("ENDE_IF", Keyword::EndIf),
    ("ENDE_WENN", Keyword::EndIf),
    ("FI", Keyword::EndIf),
    ("WEND", Keyword::EndWhile),
    ("ESAC", Keyword::EndCase),
    ("NEXT", Keyword::EndFor),
    ("END_UNTIL", Keyword::EndRepeat),
    ("UND", Keyword::And),
    ("ODER", Keyword::Or),
    ("NICHT", Keyword::Not),
    ("EXOR", Keyword::Xor),
    ("MODULO", Keyword::Mod),
    ("STEP", Keyword::By),
    ("DOWNTO", Keyword::To),
];

const ENDS: [Keyword; 5] = [Keyword::EndIf, Keyword::EndCase, Keyword::EndFor, Keyword::EndWhile, Keyword::EndRepeat];

pub(super) fn alias(word: &str) -> Option<Keyword> {
    ALIASES.iter().find(|(alias, _)| alias.eq_ignore_ascii_case(word)).map(|(_, keyword)| *keyword)
}

/// The keyword among `known` that `word` is a slip of. Short keywords allow one added letter, `IFF`, or the other order, `FO`.
pub(super) fn slip(word: &str, known: &[Keyword]) -> Option<Keyword> {
    if let Some(found) = alias(word).filter(|found| known.contains(found)) {
        return Some(found);
    }
    let found = slip_of(word, known.iter().map(|keyword| keyword.word()));
    let doubled = || known.iter().map(|keyword| keyword.word()).find(|keyword| is_short_slip(word, keyword));
    found.or_else(doubled).and_then(Keyword::from_word)
}

/// `word` is `keyword` of two letters with one of them twice, or both exchanged.
fn is_short_slip(word: &str, keyword: &str) -> bool {
    let word = word.to_ascii_uppercase();
    match (word.as_bytes(), keyword.as_bytes()) {
        ([a, b, c], [first, last]) => a == first && c == last && (b == first || b == last),
        ([a, b], [first, last]) => a == last && b == first,
        _ => false,
    }
}

impl Repair<'_> {
    /// Repairs the word at the current place, if it is not one of SCL.
    pub(super) fn repair_word(&mut self, token: RawToken) -> bool {
        if token.kind != RawKind::Word || token.keyword.is_some() {
            return false;
        }
        let word = self.slice(token);
        let after_point = self.last.is_some_and(|last| last.kind == RawKind::Dot);
        if after_point || !word.is_ascii() || self.is_declared(word) {
            return false;
        }
        if self.starts(token) { self.first_word(token, word) } else { self.operator_word(token, word) }
    }

    /// A word at the beginning of a statement.
    fn first_word(&mut self, token: RawToken, word: &str) -> bool {
        let at = self.at;
        if self.break_word(word) {
            return true;
        }
        let next = self.token(at + 1);
        let beside = self.beside(at + 1);
        if word.eq_ignore_ascii_case("END") && self.end_in_two_words(beside) {
            return true;
        }
        let Some(next) = next else { return self.last_word(word) };
        match next.kind {
            RawKind::Semicolon => return self.last_word(word),
            RawKind::Colon => {
                let case = self.open.last().is_some_and(|open| open.keyword == Keyword::Case);
                if case && !self.iec && alias(word) == Some(Keyword::Else) {
                    self.misspelt(at, at + 1, Keyword::Else);
                    self.edits.push(super::Edit {
                        first: at,
                        after: at + 2,
                        with: vec![RawToken { keyword: Some(Keyword::Else), ..token }],
                    });
                    self.at += 2;
                    self.note(RawToken { keyword: Some(Keyword::Else), ..token });
                    return true;
                }
                return false;
            }
            RawKind::LeftParen => return self.first_before_parenthesis(word),
            _ => {}
        }
        if beside.is_none() {
            let at_line_end = !matches!(next.kind, RawKind::Assign | RawKind::Dot | RawKind::LeftBracket);
            return at_line_end && self.last_word(word);
        }
        if (begins_operand(next) || next.keyword == Some(Keyword::Case)) && self.switch_in_words(word) {
            return true;
        }
        // `FC 7`
        if !begins_operand(next) || address::block_prefix(word).is_some() && next.kind == RawKind::Number {
            return false;
        }
        let inside = !self.open.is_empty();
        let starts: &[Keyword] = if inside {
            &[
                Keyword::If,
                Keyword::Case,
                Keyword::For,
                Keyword::While,
                Keyword::Repeat,
                Keyword::Elsif,
                Keyword::Else,
                Keyword::Until,
                Keyword::Goto,
            ]
        } else {
            &[Keyword::If, Keyword::Case, Keyword::For, Keyword::While, Keyword::Repeat, Keyword::Goto]
        };
        self.take_slip(word, starts)
    }

    /// `END IF`, and `END` alone.
    fn end_in_two_words(&mut self, beside: Option<RawToken>) -> bool {
        let at = self.at;
        let wanted = beside.and_then(|next| next.keyword).map(closer).filter(|end| {
            let opener = super::opener(*end);
            opener.is_some() && beside.and_then(|next| next.keyword) == opener
        });
        if let Some(keyword) = wanted {
            self.misspelt(at, at + 2, keyword);
            self.replace(at, at + 2, RawKind::Word, Some(keyword));
            return true;
        }
        let alone = self.kind(at + 1).is_none_or(|kind| kind == RawKind::Semicolon) || beside.is_none();
        let Some(open) = self.open.last().filter(|_| alone) else { return false };
        let keyword = closer(open.keyword);
        self.misspelt(at, at + 1, keyword);
        self.replace(at, at + 1, RawKind::Word, Some(keyword));
        true
    }

    /// A word that is the whole statement.
    fn last_word(&mut self, word: &str) -> bool {
        if let Some(open) = self.open.last()
            && let Some(found) = alias(word).filter(|found| *found == closer(open.keyword))
        {
            return self.take_keyword(found);
        }
        let mut known = vec![Keyword::Exit, Keyword::Continue, Keyword::Return];
        if !self.open.is_empty() {
            known.extend(ENDS);
            known.push(Keyword::Else);
        }
        self.take_slip(word, &known)
    }

    /// `whle (x) DO`, `switch (x) { … }`
    fn first_before_parenthesis(&mut self, word: &str) -> bool {
        let Some(close) = self.closing(self.at + 1) else { return false };
        let after = self.token(close + 1);
        let brace = after.is_some_and(|token| token.kind == RawKind::LeftBrace);
        if brace && is_switch(word) {
            let value = self.words(self.at + 1, close).trim_start_matches('(').trim_end_matches(')').trim();
            let after = self.closing_brace(close + 1, usize::MAX).map_or(self.tokens.len(), |brace| brace + 1);
            self.report_switch(word, value, close + 1, after);
            return true;
        }
        let known: &[Keyword] = match after.and_then(|token| token.keyword) {
            Some(Keyword::Then) => &[Keyword::If, Keyword::Elsif],
            Some(Keyword::Do) => &[Keyword::While],
            Some(Keyword::Of) => &[Keyword::Case],
            _ if brace => &[Keyword::If, Keyword::Elsif, Keyword::While],
            _ => return false,
        };
        self.take_slip(word, known)
    }

    /// A word between operands, or before one.
    fn operator_word(&mut self, token: RawToken, word: &str) -> bool {
        if self.last.is_none() || token.first_on_line {
            return false;
        }
        let after_operand = self.last.is_some_and(ends_operand);
        let before_operand = self
            .token(self.at + 1)
            .is_some_and(|next| begins_operand(next) || matches!(next.kind, RawKind::LeftParen | RawKind::Minus));
        if !before_operand {
            return false;
        }
        if after_operand && word.eq_ignore_ascii_case("IS") {
            let is_not = self.keyword(self.at + 1) == Some(Keyword::Not);
            return match is_not {
                true => self.operator(2, RawKind::NotEqual, None, "<>", "not equal is `<>`"),
                false => self.operator(1, RawKind::Equal, None, "=", "values are compared with `=`"),
            };
        }
        if after_operand {
            return self.take_slip(word, &[Keyword::And, Keyword::Or, Keyword::Xor, Keyword::Mod, Keyword::Div]);
        }
        let called = self.kind(self.at + 1) == Some(RawKind::LeftParen);
        !called && self.take_slip(word, &[Keyword::Not])
    }

    fn take_slip(&mut self, word: &str, known: &[Keyword]) -> bool {
        slip(word, known).is_some_and(|keyword| self.take_keyword(keyword))
    }

    pub(super) fn take_keyword(&mut self, keyword: Keyword) -> bool {
        self.misspelt(self.at, self.at + 1, keyword);
        self.replace(self.at, self.at + 1, RawKind::Word, Some(keyword));
        true
    }

    /// Index of the bracket that closes the one at `at`, within the statement.
    pub(super) fn closing(&self, at: usize) -> Option<usize> {
        const LOOK_MAX: usize = 300;
        let mut depth = 0usize;
        for (index, token) in self.tokens.iter().enumerate().skip(at).take(LOOK_MAX) {
            match token.kind {
                RawKind::LeftParen | RawKind::LeftBracket => depth += 1,
                RawKind::RightParen | RawKind::RightBracket => {
                    depth = depth.saturating_sub(1);
                    if depth == 0 {
                        return Some(index);
                    }
                }
                _ if token.keyword.is_some_and(Keyword::ends_block) => return None,
                _ => {}
            }
        }
        None
    }

    /// Index of the `}` that closes the `{` at `at`, within the block and `most` tokens.
    pub(super) fn closing_brace(&self, at: usize, most: usize) -> Option<usize> {
        let mut depth = 0usize;
        for (index, token) in self.tokens.iter().enumerate().skip(at).take(most) {
            match token.kind {
                RawKind::LeftBrace => depth += 1,
                RawKind::RightBrace => {
                    depth = depth.saturating_sub(1);
                    if depth == 0 {
                        return Some(index);
                    }
                }
                _ if token.keyword.is_some_and(Keyword::ends_block) => return Some(index.saturating_sub(1)),
                _ => {}
            }
        }
        None
    }
}
