//! Addresses with a blank, as STL has them: `I 0.0`, `MW 10`, `DB1.DBX 2.0`.

use super::{Repair, ends_operand};
use crate::ast::{OperandKind, Width};
use crate::scl::address;
use crate::scl::raw::{RawKind, RawToken};

impl Repair<'_> {
    /// The letters of an address and, after a blank, its number.
    pub(super) fn parted_address(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let is_number = |next: &RawToken| matches!(next.kind, RawKind::Number | RawKind::Real);
        let Some(number) = self.beside(at + 1).filter(is_number) else { return false };
        let word = self.slice(token);
        if token.kind != RawKind::Word || token.keyword.is_some() || self.is_declared(word) {
            return false;
        }
        let digits = self.slice(number);
        let bit = digits.split_once('.').is_some_and(|(byte, bit)| is_whole(byte) && is_whole(bit));
        let fits = |width: Option<Width>| match width {
            Some(Width::Bit) => bit,
            Some(_) => is_whole(digits),
            None => false,
        };
        let joined = format!("{word}{digits}");
        let member = self.last.is_some_and(|last| last.kind == RawKind::Dot) && at >= self.statement + 2;
        let is_address = match member {
            true => fits(address::db_area_word(word)),
            false => {
                fits(address::area_word(word).map(|(_, width)| width))
                    || matches!(address::absolute(&joined), Some(OperandKind::Cell { .. }))
            }
        };
        if !is_address || !member && self.last.is_some_and(ends_operand) {
            return false;
        }
        let first = if member { at - 2 } else { at };
        let whole = if member { format!("{}.{joined}", self.words(first, first)) } else { joined };
        let help = format!("write `%{whole}`, in a source of STEP 7 V5 `{whole}`");
        self.report(first, at + 2, "an address of SCL has no blank".to_owned(), "a form of STL", help);
        self.replace(first, at + 2, RawKind::Reported, None);
        true
    }
}

/// Whether the text is a whole number.
fn is_whole(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|digit| digit.is_ascii_digit())
}
