//! Values of CASE that end with another sign than `:`: `1 := x := 2;`, `2 = x := 3;`, `3 => x := 4;`.

use super::{Repair, ends_operand};
use crate::scl::keyword::Keyword;
use crate::scl::raw::RawKind;

impl Repair<'_> {
    /// A sign for `:` after the values of CASE.
    pub(super) fn value_with_sign(&mut self) -> bool {
        let (first, at) = (self.statement, self.at);
        let inside = self.open.last().is_some_and(|open| open.keyword == Keyword::Case) && self.head.is_none();
        let values = first < at && (first..at).all(|index| self.kind(index).is_some_and(is_part_of_values));
        if !inside || !values || !self.last.is_some_and(ends_operand) {
            return false;
        }
        let help = format!("write `{}:`", self.words(first, at - 1));
        self.report(at, at + 1, "a value of CASE ends with `:`".to_owned(), "read as `:`", help);
        self.replace(at, at + 1, RawKind::Colon, None);
        true
    }
}

fn is_part_of_values(kind: RawKind) -> bool {
    matches!(
        kind,
        RawKind::Number | RawKind::Literal | RawKind::Text | RawKind::Minus | RawKind::Comma | RawKind::DotDot
    )
}
