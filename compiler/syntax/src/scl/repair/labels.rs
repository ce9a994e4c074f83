//! Labels that are numbers: `GOTO 10;` and `10:`.

use std::collections::HashSet;

use super::Repair;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// Numbers to which statements jump.
#[derive(Default)]
pub(super) struct NumberLabels<'t> {
    /// Those of the whole text; none: they have not been asked for.
    all: Option<HashSet<&'t str>>,
    /// Those of the block that were reported.
    reported: HashSet<&'t str>,
}

impl NumberLabels<'_> {
    pub(super) fn begin_block(&mut self) {
        self.reported.clear();
    }
}

impl<'t> Repair<'t> {
    /// A jump to a number, which is reported, or the number before a statement.
    pub(super) fn number_label(&mut self, token: RawToken) -> bool {
        match (token.kind, token.keyword) {
            (_, Some(Keyword::Goto)) => self.jump_to_number(),
            (RawKind::Number, _) => self.number_before_statement(token),
            _ => false,
        }
    }

    /// `GOTO 10;`
    fn jump_to_number(&mut self) -> bool {
        let at = self.at;
        let Some(number) = self.beside(at + 1).filter(|next| next.kind == RawKind::Number) else { return false };
        let label = self.slice(number);
        if self.number_labels.reported.insert(label) {
            let help = format!("write `GOTO L{label};`, and `L{label}:` before the statement");
            self.report(at + 1, at + 2, format!("`{label}` is not a label"), "a label begins with a letter", help);
        }
        self.statement = at;
        self.give_up(at + 2);
        true
    }

    /// `10:`, outside of CASE.
    fn number_before_statement(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let in_case = self.open.last().is_some_and(|open| open.keyword == Keyword::Case);
        if in_case || !self.starts(token) || self.kind(at + 1) != Some(RawKind::Colon) {
            return false;
        }
        let (text, tokens) = (self.text, self.tokens);
        let all = self.number_labels.all.get_or_insert_with(|| {
            let jumps = tokens.windows(2).filter(|pair| {
                pair[0].keyword == Some(Keyword::Goto) && pair[1].kind == RawKind::Number && !pair[1].first_on_line
            });
            jumps.map(|pair| pair[1].text(text)).collect()
        });
        if !all.contains(token.text(text)) {
            return false;
        }
        self.drop_tokens(at, at + 2);
        self.statement = self.at;
        true
    }
}
