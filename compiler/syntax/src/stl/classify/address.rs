//! Addresses: the number after the letters of an area, and what is written where one should be.

use plcc_diag::{Code, Diagnostic};

use super::Classifier;
use crate::ast::{Area, Width};
use crate::stl::messages;
use crate::stl::mnemonics;
use crate::stl::raw::{RawKind, RawToken};
use crate::stl::token::Tok;

impl<'a> Classifier<'a, '_> {
    /// `MW10`, `I0.0`, `T5`: letters and number in one word, followed by the bit number.
    pub(super) fn glued(&mut self, token: RawToken, letters: Tok<'a>, letter_count: usize, digits: &str) {
        let start = token.start as usize;
        let cell = matches!(letters, Tok::Cell(_));
        self.push(start, letters, start + letter_count);
        let bit = match (self.raw_at(self.at + 1), self.raw_at(self.at + 2)) {
            (Some(dot), Some(bit))
                if !cell
                    && dot.kind == RawKind::Dot
                    && bit.kind == RawKind::Number
                    && !dot.first_on_line
                    && !bit.first_on_line =>
            {
                Some(bit)
            }
            _ => None,
        };
        let end = bit.unwrap_or(token).end as usize;
        let bit_text = bit.map(|bit| self.slice(bit));
        self.at += if bit.is_some() { 3 } else { 1 };
        self.push_address(start + letter_count, digits, bit_text, end);
    }

    /// `10`, `0.0` after area letters.
    pub(super) fn address(&mut self, token: RawToken) {
        let text = self.slice(token);
        self.at += 1;
        let (byte, bit) = match text.split_once('.') {
            Some((byte, bit)) => (byte, Some(bit)),
            None => (text, None),
        };
        self.push_address(token.start as usize, byte, bit, token.end as usize);
    }

    fn push_address(&mut self, start: usize, byte: &str, bit: Option<&str>, end: usize) {
        if bit.is_none() && self.comma_for_point(byte) {
            return;
        }
        self.push_number(start, byte, bit, end);
        self.peripheral();
    }

    /// `I 0,1`: reported and accepted; `false`: this is something else.
    fn comma_for_point(&mut self, byte: &str) -> bool {
        let (Some(comma), Some(bit)) = (self.raw_at(self.at), self.raw_at(self.at + 1)) else { return false };
        let slip = matches!(self.last(), Some(Tok::Area(_, Width::Bit)))
            && comma.kind == RawKind::Comma
            && bit.kind == RawKind::Number
            && !comma.first_on_line
            && self.adjacent(self.at);
        if !slip {
            return false;
        }
        let (begin, _, letters_end) = self.out.pop().expect("its area was last");
        let end = bit.end as usize;
        let letters = &self.text[begin..letters_end];
        let meant = format!("{letters} {byte}.{}", self.slice(bit));
        let title = format!("`{}` is not an address", &self.text[begin..end]);
        self.report(
            Diagnostic::new(Code::Syntax, self.span_of(begin, end), title)
                .label("a point separates byte and bit")
                .help(format!("write `{meant}`")),
        );
        self.at += 2;
        self.push(begin, Tok::BadOperand, end);
        true
    }

    /// `IW64:P` of newer tools is `PIW64`.
    fn peripheral(&mut self) {
        let marked = self.is_peripheral_mark();
        let Some([(_, Tok::Area(area, _), _), (_, Tok::Address(_) | Tok::BitAddress(..), end)]) =
            self.cursor.out.last_chunk_mut()
        else {
            return;
        };
        if marked {
            *area = match area {
                Area::I => Area::Pi,
                Area::Q => Area::Pq,
                _ => return,
            };
            *end = self.cursor.raw[self.cursor.at + 1].end as usize;
            self.at += 2;
        }
    }

    /// Whether `:P` follows, and no label after it.
    pub(super) fn is_peripheral_mark(&self) -> bool {
        self.kind_at(self.at) == Some(RawKind::Colon)
            && self.adjacent(self.at)
            && self.upper(self.at + 1).as_str() == "P"
            && self.kind_at(self.at + 2) != Some(RawKind::Colon)
    }

    fn push_number(&mut self, start: usize, byte: &str, bit: Option<&str>, end: usize) {
        let byte = byte.parse::<u32>().ok().filter(|byte| *byte <= 0x00FF_FFFF);
        let bit_number = bit.map(|bit| bit.parse::<u8>().ok().filter(|bit| *bit <= 7));
        match (byte, bit_number) {
            (Some(byte), None) => self.push(start, Tok::Address(byte), end),
            (Some(byte), Some(Some(bit))) => self.push(start, Tok::BitAddress(byte, bit), end),
            (byte, _) => {
                let letters = self.out.pop();
                let begin = letters.map_or(start, |(begin, ..)| begin);
                let title = format!("`{}` is not an address", &self.text[begin..end]);
                let diagnostic = Diagnostic::new(Code::AddressRange, self.span_of(begin, end), title);
                self.report(if byte.is_some() {
                    let meant = crate::scl::address::with_carried_bit(&self.text[begin..end]);
                    let help = match meant {
                        Some(meant) => {
                            format!("is `{meant}` meant, the bit after those of the byte, or another bit from 0 to 7?")
                        }
                        None => "write the bit number after the dot, 0 to 7".to_string(),
                    };
                    diagnostic.label("a byte has the bits 0 to 7").help(help)
                } else {
                    diagnostic.label("the number is too large").help("no area has that many bytes")
                });
                self.push(begin, Tok::BadOperand, end);
            }
        }
    }

    /// `MO.0`, `L .5`: a number where the name of a component is expected.
    pub(super) fn number_after_dot(&mut self, token: RawToken) {
        self.at += 1;
        let dot = self.out.pop();
        let is_value = matches!(self.out.last(), Some((_, Tok::Insn(_), _)));
        if let (Some((start, ..)), true) = (dot, is_value) {
            let end = token.end as usize;
            let written = format!("write `0.{}`", self.slice(token));
            let title = "a decimal number has a digit before its point";
            let message = Diagnostic::new(Code::ForeignForm, self.span_of(start, end), title);
            self.report(message.label("not a number of STL").help(written));
            return self.push(start, Tok::BadOperand, end);
        }
        let (begin, end) = (self.out.pop().map_or(token.start as usize, |(begin, ..)| begin), token.end as usize);
        if self.letter_for_digit(begin, end) {
            return;
        }
        let text = &self.text[begin..end];
        let help = match text.get(..2).map(str::to_ascii_uppercase).as_deref() {
            Some("MO" | "IO" | "QO" | "EO" | "AO") => {
                format!("write the digit 0 in place of the letter O: `{}0{}`", &text[..1], &text[2..])
            }
            _ => match self.own_letters(text) {
                Some(address) => format!("write `{address}`: the file has {} mnemonics", messages::set_name(self.set)),
                None => match without_x(text) {
                    Some(address) => format!("write `{address}`"),
                    None => match self.parted_address(text) {
                        Some(address) => format!("write `{address}`, without a blank at the point"),
                        None if let Some((name, number)) = text.split_once('.').filter(|_| text.starts_with('#')) => {
                            format!("write `{name}[{number}]` for an element of an array; a component has a name")
                        }
                        None => match self.address_of_two(text) {
                            Some(address) => {
                                format!("an address has the number of a byte and that of a bit: `{address}`")
                            }
                            None => "a component has a name; an address is written like `M 10.0`".to_owned(),
                        },
                    },
                },
            },
        };
        self.report(
            Diagnostic::new(
                Code::Syntax,
                self.span_of(begin, end),
                format!("`{text}` is neither an address nor a name"),
            )
            .label("a number cannot follow this name")
            .help(help),
        );
        self.push(begin, Tok::BadOperand, end);
    }

    /// `I O.0`: reported, if `O.0` from byte `begin` to `end` follows the letters of an area.
    fn letter_for_digit(&mut self, begin: usize, end: usize) -> bool {
        let rest = self.text[begin..end].strip_prefix(['O', 'o']).filter(|rest| rest.starts_with('.'));
        let (Some(rest), Some(&(start, Tok::Area(..), letters_end))) = (rest, self.out.last()) else { return false };
        let letters = &self.text[start..letters_end];
        let title = format!("`{}` is not an address", &self.text[start..end]);
        self.report(
            Diagnostic::new(Code::Syntax, self.span_of(start, end), title)
                .label("the letter O")
                .help(format!("write the digit 0 in place of the letter O: `{letters} 0{rest}`")),
        );
        self.out.pop();
        self.push(start, Tok::BadOperand, end);
        true
    }

    /// `E 0.1` for `E 0 .1`, where `text` is the number after the letters.
    fn parted_address(&self, text: &str) -> Option<String> {
        let Some((start, Tok::Area(..), end)) = self.out.last() else { return None };
        let number: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        let (byte, bit) = number.split_once('.')?;
        let is_address = !byte.is_empty() && byte.bytes().all(|digit| digit.is_ascii_digit());
        let is_bit = matches!(bit.as_bytes(), [b'0'..=b'7']);
        (is_address && is_bit).then(|| format!("{} {number}", &self.text[*start..*end]))
    }

    /// `M 0.1` for `M 0.1.2`, where `text` is what follows the letters.
    fn address_of_two(&self, text: &str) -> Option<String> {
        let Some((start, Tok::Area(_, Width::Bit), end)) = self.out.last() else { return None };
        let is_number = |part: &str| !part.is_empty() && part.bytes().all(|digit| digit.is_ascii_digit());
        let mut parts = text.split('.');
        let (byte, bit) = (parts.next()?, parts.next()?);
        let is_address = is_number(byte) && matches!(bit.as_bytes(), [b'0'..=b'7']) && parts.all(is_number);
        is_address.then(|| format!("{} {byte}.{bit}", &self.text[*start..*end]))
    }

    /// `E0.0` with the letters of the file's set: `I0.0`; `None` if the other set does not have the letters.
    fn own_letters(&self, text: &str) -> Option<String> {
        let letters = text.find(|c: char| !c.is_ascii_alphabetic())?;
        let (area, width) = mnemonics::area(&text[..letters].to_ascii_uppercase(), Some(mnemonics::other(self.set)))?;
        Some(format!("{}{}", mnemonics::letters(area, width, self.set)?, &text[letters..]))
    }
}

/// `I 0.0` for `IX0.0` of IEC 61131-3.
fn without_x(text: &str) -> Option<String> {
    let upper = text.to_ascii_uppercase();
    let (area, number) = upper.split_at_checked(1)?;
    let number = number.strip_prefix('X')?;
    let known = "IQMEA".contains(area) && number.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    known.then(|| format!("{area} {number}"))
}
