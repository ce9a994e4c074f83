//! Classifies the words of operands: area letters, block numbers, registers, names.

use plcc_diag::{Code, Diagnostic};

use super::declaration::sign;
use super::{Classifier, unquoted};
use crate::ast::{AssertRegister, BlockPrefix, StatusOperand, Width};
use crate::front::{extent, foreign_address};
use crate::stl::mnemonics::{self, letters_and_digits};
use crate::stl::raw::{RawKind, RawToken};
use crate::stl::token::Tok;
use crate::stl::{Mnemonics, step5};

impl<'a> Classifier<'a, '_> {
    /// A side of an assertion.
    pub(super) fn assert_side(&mut self) {
        while self.peek().is_some() {
            if !self.assert_register() {
                self.operand_token();
            }
        }
    }

    /// Takes `ACCU1`, `STW.OV`; `false`: it is something else.
    fn assert_register(&mut self) -> bool {
        if matches!(self.last(), Some(Tok::Dot)) {
            return false;
        }
        let register = match self.upper(self.at).as_str() {
            "ACCU1" => AssertRegister::Accu(1),
            "ACCU2" => AssertRegister::Accu(2),
            "ACCU3" => AssertRegister::Accu(3),
            "ACCU4" => AssertRegister::Accu(4),
            "AR1" => AssertRegister::Ar1,
            "AR2" => AssertRegister::Ar2,
            "DBNO" => AssertRegister::DbNumber,
            "DINO" => AssertRegister::DiNumber,
            "STW" if self.kind_at(self.at + 1) == Some(RawKind::Dot) => {
                let bit = match self.upper(self.at + 2).as_str() {
                    "BR" | "BIE" => AssertRegister::Br,
                    "CC1" | "A1" => AssertRegister::Cc1,
                    "CC0" | "A0" => AssertRegister::Cc0,
                    "OV" => AssertRegister::Ov,
                    "OS" => AssertRegister::Os,
                    "OR" => AssertRegister::Or,
                    "STA" => AssertRegister::Sta,
                    "RLO" | "VKE" => AssertRegister::Rlo,
                    "FC" | "ER" => AssertRegister::Fc,
                    _ => return false,
                };
                let (start, end) = (self.raw[self.at].start as usize, self.raw[self.at + 2].end as usize);
                self.at += 3;
                self.push(start, Tok::AssertRegister(bit), end);
                return true;
            }
            "STW" => AssertRegister::Stw,
            _ => return false,
        };
        self.take(Tok::AssertRegister(register));
        true
    }

    /// One token of an operand; some make two tokens for the grammar.
    pub(super) fn operand_token(&mut self) {
        let token = self.raw[self.at];
        match token.kind {
            RawKind::Number | RawKind::Real if matches!(self.last(), Some(Tok::Area(..) | Tok::Cell(_))) => {
                self.address(token);
            }
            RawKind::Number | RawKind::Real if matches!(self.last(), Some(Tok::Dot)) => self.number_after_dot(token),
            RawKind::Word if self.foreign_address(token) || self.step5(token) || self.base_without_sign(token) => {}
            _ if self.is_literal(self.at) => self.literal(),
            RawKind::Word => self.operand_word(token),
            RawKind::Quoted => {
                let name = unquoted(self.slice(token));
                let member = matches!(self.last(), Some(Tok::Dot));
                self.take(if member { Tok::Name(name) } else { Tok::Quoted(name) });
            }
            RawKind::Colon
                if self.is_peripheral_mark()
                    && matches!(self.last(), Some(Tok::Quoted(_) | Tok::Name(_) | Tok::RightBracket)) =>
            {
                let end = self.raw[self.at + 1].end as usize;
                self.at += 2;
                self.push(token.start as usize, Tok::Peripheral, end);
            }
            RawKind::Hash => self.local(),
            RawKind::Percent if matches!(self.last(), Some(Tok::Dot)) && self.is_slice() => {
                let end = self.raw[self.at + 1].end as usize;
                self.at += 2;
                let start = token.start as usize;
                let name = &self.text[start..end];
                self.push(start, Tok::Name(name), end);
            }
            RawKind::Percent if self.is_before_word(token) => self.at += 1,
            RawKind::EqualEqual
            | RawKind::NotEqual
            | RawKind::Greater
            | RawKind::Less
            | RawKind::GreaterEqual
            | RawKind::LessEqual => self.compared_with_zero(token),
            RawKind::Equal => self.stray(),
            kind => match sign(kind) {
                Some(tok) => self.take(tok),
                None => self.stray(),
            },
        }
    }

    /// The `%` of `%MW10`, without a blank after it.
    fn is_before_word(&self, percent: RawToken) -> bool {
        self.raw_at(self.at + 1).is_some_and(|next| next.kind == RawKind::Word && next.start == percent.end)
    }

    /// `N7:0`, `B3:0/1` of other controllers.
    fn foreign_address(&mut self, token: RawToken) -> bool {
        if !matches!(self.kind_at(self.at + 1), Some(RawKind::Colon)) {
            return false;
        }
        let Some(address) = self.text.get(token.start as usize..).and_then(foreign_address::at) else { return false };
        let (start, end) = (token.start as usize, token.start as usize + address.length);
        self.report(
            Diagnostic::new(Code::ForeignForm, self.span_of(start, end), address.title)
                .label("not an address of STEP 7")
                .help(address.help),
        );
        while self.raw_at(self.at).is_some_and(|token| (token.start as usize) < end) {
            self.at += 1;
        }
        self.push(start, Tok::BadOperand, end);
        true
    }

    /// `KT 50.1`, `FW 10`, `DW 5` of STEP 5.
    fn step5(&mut self, token: RawToken) -> bool {
        let beside = self.raw_at(self.at + 1).is_some_and(|next| !next.first_on_line);
        if !beside || matches!(self.last(), Some(Tok::Dot)) {
            return false;
        }
        let upper = self.upper(self.at);
        let Some((length, written)) = step5::meant(upper.as_str(), &self.text[token.end as usize..]) else {
            return false;
        };
        let (start, end) = (token.start as usize, token.end as usize + length);
        let title = format!("`{}` is an operand of STEP 5", &self.text[start..end]);
        self.report(
            Diagnostic::new(Code::ForeignForm, self.span_of(start, end), title)
                .label("STEP 7 has other constants and flags, and counts the bytes of a data block")
                .help(format!("write `{written}`")),
        );
        while self.raw_at(self.at).is_some_and(|token| (token.start as usize) < end) {
            self.at += 1;
        }
        self.push(start, Tok::BadOperand, end);
        true
    }

    /// `W16#FF` for `W#16#FF`.
    fn base_without_sign(&mut self, token: RawToken) -> bool {
        let upper = self.upper(self.at);
        let letters = upper.as_str().strip_suffix("16").unwrap_or_default();
        let is_type = matches!(letters, "B" | "W" | "DW" | "BYTE" | "WORD" | "DWORD");
        if !is_type || self.kind_at(self.at + 1) != Some(RawKind::Hash) || !self.adjacent(self.at) {
            return false;
        }
        let (start, hash) = (token.start as usize, token.end as usize);
        let digits = &self.text[hash + 1..];
        let digits = &digits[..extent::word(digits)];
        if digits.is_empty() {
            return false;
        }
        let end = hash + 1 + digits.len();
        let title = format!("`{}` is not a constant as STEP 7 writes it", &self.text[start..end]);
        self.report(
            Diagnostic::new(Code::BadLiteral, self.span_of(start, end), title)
                .label("`#` is missing before the base")
                .help(format!("write `{letters}#16#{digits}`")),
        );
        while self.raw_at(self.at).is_some_and(|token| (token.start as usize) < end) {
            self.at += 1;
        }
        self.push(start, Tok::BadOperand, end);
        true
    }

    /// `#name`, `#"name"`.
    fn local(&mut self) {
        match self.raw_at(self.at + 1) {
            Some(name) if matches!(name.kind, RawKind::Word | RawKind::Quoted) && !name.first_on_line => {
                let start = self.raw[self.at].start as usize;
                let text = unquoted(self.slice(name));
                self.at += 2;
                self.push(start, Tok::Local(text), name.end as usize);
            }
            _ => {
                let span = self.span(self.raw[self.at]);
                self.report(
                    Diagnostic::new(Code::Syntax, span, "no name follows `#`")
                        .label("a local name is expected after it")
                        .help("write `#` and the name without a blank, e.g. `#speed`"),
                );
                self.take(Tok::BadOperand);
            }
        }
    }

    /// `==0`, `>0`: conditions of CC1 and CC0.
    fn compared_with_zero(&mut self, token: RawToken) {
        let status = match token.kind {
            RawKind::EqualEqual => StatusOperand::Eq0,
            RawKind::NotEqual => StatusOperand::Ne0,
            RawKind::Greater => StatusOperand::Gt0,
            RawKind::Less => StatusOperand::Lt0,
            RawKind::GreaterEqual => StatusOperand::Ge0,
            _ => StatusOperand::Le0,
        };
        match self.raw_at(self.at + 1) {
            Some(zero) if zero.kind == RawKind::Number && self.slice(zero) == "0" => {
                self.at += 2;
                self.push(token.start as usize, Tok::Status(status), zero.end as usize);
            }
            _ if self.is_reversed(token) => self.reversed(token),
            _ => self.stray(),
        }
    }

    /// `=>I`, `=<I`: the sign follows an `=` that begins the statement.
    fn is_reversed(&self, token: RawToken) -> bool {
        let before = self.at.checked_sub(1).and_then(|before| self.raw_at(before));
        matches!(token.kind, RawKind::Greater | RawKind::Less)
            && before.is_some_and(|equal| equal.kind == RawKind::Equal && equal.end == token.start)
            && matches!(self.last(), Some(Tok::Insn(_)))
    }

    fn reversed(&mut self, token: RawToken) {
        let (sign, words) = match token.kind {
            RawKind::Greater => (">=", "greater or equal"),
            _ => ("<=", "less or equal"),
        };
        let ty = self.raw_at(self.at + 1).map_or("", |next| self.slice(next));
        let help = match ty.to_ascii_uppercase().as_str() {
            ty @ ("I" | "D" | "R") => format!("write `{sign}{ty}`"),
            _ => format!("write `{sign}I` for INT, `{sign}D` for DINT, `{sign}R` for REAL"),
        };
        let span = self.span_of(token.start as usize - 1, token.end as usize);
        self.report(
            Diagnostic::new(Code::ForeignForm, span, format!("{words} is `{sign}`"))
                .label("a form of other languages")
                .help(help),
        );
        self.skip_stray();
    }

    /// The set whose area letters are accepted; `None`: both.
    fn letters_of(&self) -> Option<Mnemonics> {
        if self.both_sets { None } else { Some(self.set) }
    }

    fn operand_word(&mut self, token: RawToken) {
        let text = self.slice(token);
        if matches!(self.last(), Some(Tok::Dot)) {
            return self.member(token);
        }
        let upper = self.upper(self.at);
        let word = upper.as_str();
        let (letters, digits) = letters_and_digits(word);
        let set = self.letters_of();
        let next = self.raw_at(self.at + 1).filter(|next| !next.first_on_line).map(|next| next.kind);
        if !digits.is_empty() {
            if let Some((area, width)) = mnemonics::area(letters, set) {
                return self.glued(token, Tok::Area(area, width), letters.len(), digits);
            }
            if let Some(cell) = mnemonics::cell(letters, set) {
                return self.glued(token, Tok::Cell(cell), letters.len(), digits);
            }
        }
        let bracket = next == Some(RawKind::LeftBracket);
        let numbered = bracket || matches!(next, Some(RawKind::Number | RawKind::Real));
        // Area letters are reserved; without a number the address is missing. In assertions they may be a name.
        let alone = !self.both_sets && !matches!(next, Some(RawKind::Dot));
        if digits.is_empty() && (numbered || alone) {
            if let Some((area, width)) = mnemonics::area(letters, set) {
                return self.take(Tok::Area(area, width));
            }
            if let Some(cell) = mnemonics::cell(letters, set) {
                return self.take(Tok::Cell(cell));
            }
        }
        if bracket {
            let width = match word {
                "B" => Some(Width::Byte),
                "W" => Some(Width::Word),
                "D" => Some(Width::Dword),
                _ => None,
            };
            if let Some(width) = width {
                return self.take(Tok::Width(width));
            }
            if let Some(prefix) = mnemonics::block_prefix(word) {
                return self.take(Tok::BlockLetters(prefix));
            }
        }
        if self.numbered_block() {
            // A number that no block has was reported.
            let has_part = self.kind_at(self.at) == Some(RawKind::Dot);
            if let Some((_, tok @ Tok::Block(_, u32::MAX), _)) = self.out.last_mut()
                && !has_part
            {
                *tok = Tok::BadOperand;
            }
            return;
        }
        if let Some(status) = mnemonics::status(word, set) {
            return self.take(Tok::Status(status));
        }
        if let Some(special) = mnemonics::special(word) {
            return self.take(Tok::Special(special));
        }
        if let Some(register) = mnemonics::register(word) {
            return self.take(Tok::Register(register));
        }
        match word {
            "TRUE" | "FALSE" => {
                let tok = self.literal_token(text, self.span(token));
                self.take(tok);
            }
            "P" if next == Some(RawKind::Hash) => {
                let end = self.raw[self.at + 1].end as usize;
                self.at += 2;
                self.push(token.start as usize, Tok::PointerTo, end);
            }
            "B" if next == Some(RawKind::LeftParen) => self.bytes_without_hash(token),
            _ => self.take(Tok::Name(text)),
        }
    }

    /// `L B(1,8)`: a misprint of `B#(1,8)`.
    fn bytes_without_hash(&mut self, token: RawToken) {
        let mut index = self.at + 1;
        while let Some(next) = self.raw_at(index)
            && !next.first_on_line
            && matches!(next.kind, RawKind::LeftParen | RawKind::Number | RawKind::Comma)
        {
            index += 1;
        }
        if self.kind_at(index) == Some(RawKind::RightParen) {
            index += 1;
        }
        let (start, end) = (token.start as usize, self.raw[index - 1].end as usize);
        let list = &self.text[token.end as usize..end];
        self.report(
            Diagnostic::new(
                Code::BadLiteral,
                self.span_of(start, end),
                format!("`{}` is not a constant as STEP 7 writes it", &self.text[start..end]),
            )
            .label("`#` is missing")
            .help(format!("write `B#{}`", list.trim())),
        );
        self.at = index;
        self.push(start, Tok::BadOperand, end);
    }

    /// A word after a dot: a component, or `DBW 2` after a data block.
    fn member(&mut self, token: RawToken) {
        let text = self.slice(token);
        let root = self.out.len().checked_sub(2).map(|root| &self.out[root].1);
        if matches!(root, Some(Tok::Block(BlockPrefix::Db | BlockPrefix::Di, _) | Tok::Quoted(_))) {
            let upper = self.upper(self.at);
            let (letters, digits) = letters_and_digits(upper.as_str());
            let next = self.raw_at(self.at + 1).filter(|next| !next.first_on_line).map(|next| next.kind);
            let numbered = !digits.is_empty() || matches!(next, Some(RawKind::Number | RawKind::Real));
            if numbered
                && letters.starts_with("DB")
                && let Some((area, width)) = mnemonics::area(letters, None)
            {
                if digits.is_empty() {
                    return self.take(Tok::Area(area, width));
                }
                return self.glued(token, Tok::Area(area, width), letters.len(), digits);
            }
        }
        self.take(Tok::Name(text));
    }

    /// Whether `%X3`, `%B1`, `%W0` or `%D1` follows: a part of the variable before the point.
    fn is_slice(&self) -> bool {
        let upper = self.upper(self.at + 1);
        let (letters, digits) = letters_and_digits(upper.as_str());
        matches!(letters, "X" | "B" | "W" | "D") && !digits.is_empty() && self.adjacent(self.at)
    }
}
