//! Forms of values and choices of C: `if (x) a = 1;`, `a := [1, 2]`, `a{1}`, `a =: 5`, and `>5:` in CASE. And END_IF before ELSE.

use plcc_diag::{Code, Diagnostic};

use super::{Repair, ends_operand};
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// More elements of an array than this are not written out in a message.
const ELEMENTS_MAX: usize = 4;

/// Tokens of an index in braces.
const INDEX_MAX: usize = 100;

impl Repair<'_> {
    /// `IF (x) a := 1;` without THEN and END_IF, perhaps with an ELSE of the same form.
    pub(super) fn if_of_c(&mut self, token: RawToken) -> bool {
        let at = self.at;
        if token.keyword != Some(Keyword::If) || !self.starts(token) || self.kind(at + 1) != Some(RawKind::LeftParen) {
            return false;
        }
        let Some(close) = self.closing(at + 1).filter(|close| *close > at + 2) else { return false };
        let Some(end) = self.assignment_end(close + 1).filter(|_| !self.has_end_if(close + 1, self.open_ifs())) else {
            return false;
        };
        let (condition, statement) = (self.words(at + 1, close), self.words(close + 1, end));
        let other = match self.keyword(end + 1) {
            Some(Keyword::Else) => self.assignment_end(end + 2),
            _ => None,
        };
        let (otherwise, end) = match other {
            Some(other) => (format!(" ELSE {}", self.words(end + 2, other)), other),
            None => (String::new(), end),
        };
        let help = format!("write `IF {condition} THEN {statement}{otherwise} END_IF;`");
        self.report(at, at + 1, "IF needs THEN and END_IF".to_owned(), "a form of other languages", help);
        self.statement = at;
        self.give_up(end);
        true
    }

    /// END_IF before ELSE or ELSIF, where no other IF or CASE is open to which they could belong.
    pub(super) fn early_end_if(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let after = if self.kind(at + 1) == Some(RawKind::Semicolon) { at + 2 } else { at + 1 };
        let next = self.keyword(after);
        let goes_on = matches!(next, Some(Keyword::Else | Keyword::Elsif | Keyword::ElseIf));
        if token.keyword != Some(Keyword::EndIf) || !goes_on || self.head.is_some() {
            return false;
        }
        let Some((own, around)) = self.open.split_last() else { return false };
        let takes_else = |keyword: Keyword| matches!(keyword, Keyword::If | Keyword::Case);
        if own.keyword != Keyword::If
            || own.brace
            || around.iter().any(|open| takes_else(open.keyword))
            || !self.has_end_if(after, 0)
        {
            return false;
        }
        let word = self.words(after, after).to_ascii_uppercase();
        let title = format!("END_IF comes after the statements of {word}");
        let help = format!("remove `{}` before `{word}`", self.words(at, after - 1));
        let message = Diagnostic::new(Code::Syntax, self.span(at, at + 1), title);
        self.messages.push(message.label("the IF goes on after it").help(help));
        self.drop_tokens(at, after);
        self.begin_statement();
        true
    }

    /// Index of the `;` of an assignment that begins at `first`.
    fn assignment_end(&self, first: usize) -> Option<usize> {
        let token = self.token(first)?;
        let is_name = matches!(token.kind, RawKind::Word | RawKind::Local | RawKind::Quoted | RawKind::Absolute);
        let after = self.operand_end(first);
        if !is_name || token.keyword.is_some() || self.kind(after) != Some(RawKind::Assign) {
            return None;
        }
        let end = self.end_of_statement(after);
        (self.kind(end) == Some(RawKind::Semicolon)).then_some(end)
    }

    fn open_ifs(&self) -> usize {
        self.open.iter().filter(|open| open.keyword == Keyword::If).count()
    }

    /// Whether an END_IF follows from `first` on that belongs neither to an IF after it nor to one of `around` that are open.
    fn has_end_if(&self, first: usize, around: usize) -> bool {
        const LOOK_MAX: usize = 1000;
        let mut depth = around;
        for token in self.tokens.iter().skip(first).take(LOOK_MAX) {
            match token.keyword {
                Some(Keyword::If) => depth += 1,
                Some(Keyword::EndIf) if depth == 0 => return true,
                Some(Keyword::EndIf) => depth -= 1,
                Some(keyword) if keyword.ends_block() => return false,
                _ => {}
            }
        }
        false
    }

    /// `a := [1, 2, 3];`, `a := (1, 2, 3);`, `a := (x := 1, y := 2);`
    pub(super) fn list_of_values(&mut self) -> bool {
        let at = self.at;
        let assigned = self.last.is_some_and(|last| last.kind == RawKind::Assign) && at >= self.statement + 2;
        if !assigned || self.data || !self.brackets.is_empty() || self.head.is_some() {
            return false;
        }
        let Some(close) = self.closing(at).filter(|close| self.kind(*close + 1) == Some(RawKind::Semicolon)) else {
            return false;
        };
        let target = self.words(self.statement, at - 2);
        let values = self.parts(at + 1, close);
        let is_named =
            |(first, last): &(usize, usize)| self.kind(first + 1) == Some(RawKind::Assign) && *last >= first + 2;
        if self.kind(at) == Some(RawKind::LeftParen) {
            if !values.is_empty() && values.iter().all(is_named) {
                let text = |(first, last): &(usize, usize)| format!("{target}.{};", self.words(*first, *last));
                let shown: Vec<String> = values.iter().take(ELEMENTS_MAX).map(text).collect();
                let more = if values.len() > ELEMENTS_MAX { " …" } else { "" };
                let help = format!("write `{}{more}`", shown.join(" "));
                let title = "a structure of values is possible in a declaration only".to_owned();
                self.report(at, close + 1, title, "a form of other languages", help);
                self.give_up(close + 1);
                return true;
            }
            if values.len() < 2 {
                return false;
            }
        }
        let elements = self.lower_bound(target).filter(|_| !values.is_empty()).map(|low| {
            let text =
                |(index, part): (i64, &(usize, usize))| format!("{target}[{index}] := {};", self.words(part.0, part.1));
            let shown: Vec<String> = (low..).zip(values.iter().take(ELEMENTS_MAX)).map(text).collect();
            let more = if values.len() > ELEMENTS_MAX { " …" } else { "" };
            format!("write `{}{more}`", shown.join(" "))
        });
        let help =
            elements.unwrap_or_else(|| format!("write an assignment for each element, as in `{target}[1] := …;`"));
        let title = "a list of values is possible in a declaration only".to_owned();
        self.report(at, close + 1, title, "a form of other languages", help);
        self.give_up(close + 1);
        true
    }

    /// The lower bound of the array `name`, if its declaration has a number for it.
    fn lower_bound(&self, name: &str) -> Option<i64> {
        let at = *self.declared.get(&name.trim_start_matches('#').to_uppercase())?;
        let is_array = self.kind(at + 1) == Some(RawKind::Colon)
            && self.keyword(at + 2) == Some(Keyword::Array)
            && self.kind(at + 3) == Some(RawKind::LeftBracket);
        let number = self.token(at + 4).filter(|token| is_array && token.kind == RawKind::Number)?;
        self.slice(number).parse().ok()
    }

    /// `a{1}`
    pub(super) fn index_in_braces(&mut self) -> bool {
        let at = self.at;
        if at == self.statement || !self.last.is_some_and(ends_operand) || !self.adjacent(at - 1) {
            return false;
        }
        let close = (at + 1..self.tokens.len())
            .take(INDEX_MAX)
            .take_while(|index| self.beside(*index).is_some())
            .find(|index| self.kind(*index) == Some(RawKind::RightBrace));
        let Some(close) = close.filter(|close| *close > at + 1) else { return false };
        let first = self.operand_start(at);
        let (name, index) = (self.words(first, at - 1), self.words(at + 1, close - 1));
        let help = format!("write `{name}[{index}]`");
        let title = "the index of an array is written in brackets".to_owned();
        self.report(at, close + 1, title, "a form of other languages", help);
        self.replace(first, close + 1, RawKind::Reported, None);
        true
    }

    /// `a =: 5;`
    pub(super) fn exchanged_assignment(&mut self) -> bool {
        let at = self.at;
        let sign = self.kind(at + 1) == Some(RawKind::Colon) && self.adjacent(at);
        let outside = self.brackets.is_empty() && self.head.is_none() && !self.is_assigned();
        sign && outside && self.last.is_some_and(ends_operand) && self.assignment(2)
    }

    /// `a = 5;` in a data block, which compares nothing.
    pub(super) fn equal_in_data(&mut self) -> bool {
        let outside = self.data && self.statements_begun && self.brackets.is_empty() && !self.is_assigned();
        let twice = self.kind(self.at + 1) == Some(RawKind::Equal) && self.adjacent(self.at);
        outside && self.last.is_some_and(ends_operand) && self.assignment(if twice { 2 } else { 1 })
    }

    /// `>5:` as a value of CASE.
    pub(super) fn compared_case(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let inside = self.open.last().is_some_and(|open| open.keyword == Keyword::Case) && self.head.is_none();
        let value = self.token(at + 1).filter(|value| value.kind == RawKind::Number);
        let Some(value) = value.filter(|_| inside && at == self.statement) else { return false };
        if !matches!(self.kind(at + 2), Some(RawKind::Colon | RawKind::Comma)) {
            return false;
        }
        let (sign, number) = (self.slice(token), self.slice(value));
        let range = number.parse::<i64>().ok().and_then(|number| match token.kind {
            RawKind::Greater => Some(format!("{}..32767", number + 1)),
            RawKind::GreaterEqual => Some(format!("{number}..32767")),
            RawKind::Less => Some(format!("-32768..{}", number - 1)),
            RawKind::LessEqual => Some(format!("-32768..{number}")),
            _ => None,
        });
        let help = match range {
            Some(range) => format!("write the range, for an INT `{range}:`, or use IF and ELSIF"),
            None => "use IF and ELSIF".to_owned(),
        };
        self.report(at, at + 1, format!("a value of CASE has no `{sign}`"), "CASE compares for equality", help);
        self.drop_tokens(at, at + 1);
        true
    }
}
