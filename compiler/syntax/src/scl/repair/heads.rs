//! Heads of structured statements: THEN, DO, OF, TO and BY that are misspelt, exchanged, or written as signs. And declarations.

use super::words::slip;
use super::{Area, Head, Open, Repair, begins_operand, ends_operand};
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// Tokens of a group in braces.
const GROUP_MAX: usize = 2000;

impl Repair<'_> {
    /// Repairs a part of a head, or a brace.
    pub(super) fn repair_head(&mut self, token: RawToken) -> bool {
        match token.kind {
            RawKind::LeftBrace => return self.opening_brace(),
            RawKind::RightBrace => return self.closed_brace(),
            _ => {}
        }
        let outside = self.brackets.is_empty();
        let Some(&Head { keyword, wanted, assigned, to, by }) = self.head.as_ref() else { return false };
        let at = self.at;
        if self.operator_left_out(token) {
            return true;
        }
        let for_head = keyword == Keyword::For;
        let statement = if keyword == Keyword::ElseIf { Keyword::Elsif } else { keyword };
        let begins = for_head && !assigned && self.last.is_some_and(|last| last.keyword == Some(Keyword::For));
        if begins && (token.kind != RawKind::LeftParen && self.bare_for_of_c() || self.for_each(token)) {
            return true;
        }
        match token.kind {
            RawKind::Word if outside => match token.keyword {
                Some(Keyword::Do) if wanted == Keyword::EndRepeat => self.do_before_end_until(),
                Some(found @ (Keyword::Then | Keyword::Do | Keyword::Of))
                    if found != wanted && wanted != Keyword::EndRepeat =>
                {
                    let title = format!("{} needs `{}`, not `{}`", statement.word(), wanted.word(), found.word());
                    let help = format!("write `{}`", wanted.word());
                    self.report(at, at + 1, title, &format!("read as `{}`", wanted.word()), help);
                    self.replace(at, at + 1, RawKind::Word, Some(wanted));
                    true
                }
                None if self.last.is_some_and(ends_operand) && !self.is_declared(self.slice(token)) => {
                    let mut known = vec![wanted];
                    if for_head && !to {
                        known.push(Keyword::To);
                    }
                    if for_head && to && !by {
                        known.push(Keyword::By);
                    }
                    let word = self.slice(token);
                    if for_head && !assigned && word.eq_ignore_ascii_case("IN") {
                        return self.for_in();
                    }
                    if for_head && !assigned && word.eq_ignore_ascii_case("FROM") {
                        return self.for_from();
                    }
                    slip(word, &known).is_some_and(|keyword| self.take_keyword(keyword))
                }
                _ => false,
            },
            RawKind::LeftParen
                if for_head && !assigned && self.last.is_some_and(|last| last.keyword == Some(Keyword::For)) =>
            {
                self.for_of_c()
            }
            RawKind::Equal if for_head && !assigned && outside => {
                let rest = self.words(self.statement_head(), at - 1).to_owned();
                let start = self.token(at + 1).map_or("1", |token| self.slice(token));
                let help = format!("write `{rest} := {start}`");
                self.report(at, at + 1, "the first value of FOR is given with `:=`".to_owned(), "compares", help);
                self.replace(at, at + 1, RawKind::Assign, None);
                true
            }
            RawKind::DotDot | RawKind::Comma if for_head && assigned && !to && outside => {
                let range = self.words(self.statement_head(), at - 1).to_owned();
                let is_end = |index| matches!(self.keyword(index), Some(Keyword::Do | Keyword::By));
                // The step may follow after another comma.
                let end = self.part_of_head(is_end);
                let last = match end.and_then(|end| self.parts(at + 1, end).first().copied()) {
                    Some((first, last)) => self.words(first, last),
                    None => self.token(at + 1).map_or("…", |token| self.slice(token)),
                };
                let help = format!("write `FOR {range} TO {last} DO`");
                self.report(at, at + 1, "FOR counts with TO".to_owned(), "read as `TO`", help);
                self.replace(at, at + 1, RawKind::Word, Some(Keyword::To));
                true
            }
            RawKind::Comma if for_head && to && !by && outside => {
                let (title, help) = ("the step of FOR is given with BY", "write `BY` for `,`");
                self.report(at, at + 1, title.to_owned(), "read as `BY`", help.to_owned());
                self.replace(at, at + 1, RawKind::Word, Some(Keyword::By));
                true
            }
            // Without THEN, a statement follows.
            RawKind::Assign
                if !for_head
                    && keyword != Keyword::Case
                    && !self.begins_anew(at)
                    && !self.brackets.last().copied().unwrap_or(false) =>
            {
                let (left, right) = self.sides(at, at + 1);
                let help = format!("write `{left} = {right}`");
                self.report(at, at + 1, "a condition compares with `=`; `:=` assigns".to_owned(), "read as `=`", help);
                self.replace(at, at + 1, RawKind::Equal, None);
                true
            }
            RawKind::Arrow if !for_head && !self.brackets.last().copied().unwrap_or(false) => {
                let (left, right) = self.sides(at, at + 1);
                let help = format!("write `{left} >= {right}`");
                self.report(at, at + 1, "greater or equal is `>=`".to_owned(), "read as `>=`", help);
                self.replace(at, at + 1, RawKind::GreaterEqual, None);
                true
            }
            RawKind::Colon
                if outside
                    && wanted != Keyword::Of
                    && wanted != Keyword::EndRepeat
                    && self.kind(at + 1) != Some(RawKind::Equal) =>
            {
                let title = format!("the head of {} ends with `{}`", statement.word(), wanted.word());
                self.report(
                    at,
                    at + 1,
                    title,
                    &format!("read as `{}`", wanted.word()),
                    format!("write `{}`", wanted.word()),
                );
                self.replace(at, at + 1, RawKind::Word, Some(wanted));
                true
            }
            RawKind::Semicolon if self.keyword(at + 1) == Some(wanted) && wanted != Keyword::EndRepeat => {
                let title = format!("`;` is not allowed before `{}`", wanted.word());
                let head = self.words(self.statement_head(), at - 1);
                let help = format!("write `{} {head} {}`", statement.word(), wanted.word());
                self.report(at, at + 1, title, "the head of the statement is not complete here", help);
                self.drop_tokens(at, at + 1);
                true
            }
            _ => false,
        }
    }

    /// Whether the name before `at` follows another operand, so that it belongs to the next statement.
    fn begins_anew(&self, at: usize) -> bool {
        let mut first = at.saturating_sub(1);
        while first >= 2 && self.kind(first - 1) == Some(RawKind::Dot) {
            first -= 2;
        }
        first > 0 && ends_operand(self.tokens[first - 1])
    }

    /// Index of the token after the keyword of the head.
    pub(super) fn statement_head(&self) -> usize {
        let is_head = |token: &RawToken| {
            token.keyword.is_some_and(|word| {
                matches!(
                    word,
                    Keyword::If | Keyword::Elsif | Keyword::ElseIf | Keyword::For | Keyword::While | Keyword::Case
                )
            })
        };
        self.tokens[..self.at].iter().rposition(is_head).map_or(self.at.saturating_sub(1), |found| found + 1)
    }

    /// The operands next to the operator at `at` to `after`, as written.
    pub(super) fn sides(&self, at: usize, after: usize) -> (String, String) {
        let mut first = at;
        while first > 0 && at - first < 12 {
            let token = self.tokens[first - 1];
            let part = ends_operand(token)
                || begins_operand(token)
                || matches!(token.kind, RawKind::Dot | RawKind::Caret | RawKind::LeftBracket);
            if !part || token.keyword.is_some_and(|word| word.is_operator() || word.ends_expression()) {
                break;
            }
            // Two operands in a row belong to different parts.
            if first < at && ends_operand(token) && begins_operand(self.tokens[first]) {
                break;
            }
            first -= 1;
        }
        let mut end = after;
        while end < self.tokens.len() && end - after < 12 {
            let token = self.tokens[end];
            let sign = end == after && token.kind == RawKind::Minus;
            let part = sign
                || ends_operand(token)
                || begins_operand(token)
                || matches!(token.kind, RawKind::Dot | RawKind::LeftBracket | RawKind::LeftParen);
            if !part
                || token
                    .keyword
                    .is_some_and(|word| word.is_operator() || word.ends_expression() || super::is_link(word))
            {
                break;
            }
            if end > after && begins_operand(token) && ends_operand(self.tokens[end - 1]) {
                break;
            }
            end += 1;
        }
        let left = if first < at { self.words(first, at - 1) } else { "…" };
        let right = if end > after { self.words(after, end - 1) } else { "…" };
        (left.to_owned(), right.trim_end_matches(')').to_owned())
    }

    /// `{` for THEN or DO, or after ELSE.
    fn opening_brace(&mut self) -> bool {
        let at = self.at;
        let after_else = self.last.is_some_and(|last| last.keyword == Some(Keyword::Else));
        let wanted = match &self.head {
            Some(head) if matches!(head.wanted, Keyword::Then | Keyword::Do) => Some(head.wanted),
            None if after_else => None,
            _ => return self.group_of_statements(),
        };
        let Some(open) = self.open.last_mut() else { return false };
        let (statement, end) = (open.keyword, super::closer(open.keyword));
        open.brace = true;
        // The message for the head of C says how the statements end.
        let told = statement == Keyword::For
            && self.last.is_some_and(|last| last.kind == RawKind::Reported && self.slice(last).starts_with('('));
        if !told && !std::mem::replace(&mut self.braces_reported, true) {
            let help = match wanted {
                Some(wanted) => format!("write `{}` for `{{` and `{};` for `}}`", wanted.word(), end.word()),
                None => format!("remove `{{`, and write `{};` for `}}`", end.word()),
            };
            let title = format!("the statements of {} are not written in braces", statement.word());
            self.report(at, at + 1, title, "a form of other languages", help);
        }
        match wanted {
            Some(wanted) => self.replace(at, at + 1, RawKind::Word, Some(wanted)),
            None => self.drop_tokens(at, at + 1),
        }
        true
    }

    /// `{ a := 1; }` without a head before it: the braces are left out. A list of attributes has texts as its values.
    fn group_of_statements(&mut self) -> bool {
        let at = self.at;
        // Structured text of IEC 61131-3 has conditions for the compiler in braces.
        if self.iec || self.head.is_some() || !self.brackets.is_empty() || self.last.is_some_and(ends_operand) {
            return false;
        }
        let close = self.closing_brace(at, GROUP_MAX).filter(|close| self.kind(*close) == Some(RawKind::RightBrace));
        let Some(close) = close else { return false };
        let is_statement = |index: usize| match self.kind(index) {
            Some(RawKind::Local | RawKind::LeftParen | RawKind::LeftBracket) => true,
            Some(RawKind::Assign) => self.kind(index + 1) != Some(RawKind::Text),
            _ => self.keyword(index).is_some_and(Keyword::begins_statement),
        };
        if !(at + 1..close).any(is_statement) {
            return false;
        }
        let help = "remove `{` and the `}` that belongs to it".to_owned();
        self.report(at, at + 1, "statements are not grouped by braces".to_owned(), "a form of other languages", help);
        self.group_ends.insert(close);
        self.drop_tokens(at, at + 1);
        self.statement = self.at;
        true
    }

    /// `}` for END_IF and others.
    fn closed_brace(&mut self) -> bool {
        if self.group_ends.remove(&self.at) {
            self.drop_tokens(self.at, self.at + 1);
            self.statement = self.at;
            return true;
        }
        let Some(index) = self.open.iter().rposition(|open| open.brace) else { return false };
        let at = self.at;
        let more = match self.token(at + 1) {
            Some(next) => {
                matches!(next.keyword, Some(Keyword::Else | Keyword::Elsif | Keyword::ElseIf))
                    || super::words::alias(self.slice(next)) == Some(Keyword::Elsif)
            }
            None => false,
        };
        if more && self.open[index].keyword == Keyword::If {
            self.open.truncate(index + 1);
            // `else if` of such languages goes on with the statement.
            if self.keyword(at + 1) == Some(Keyword::Else) && self.keyword(at + 2) == Some(Keyword::If) {
                self.drop_tokens(at, at + 1);
                self.replace(at + 1, at + 3, RawKind::Word, Some(Keyword::Elsif));
            } else {
                self.drop_tokens(at, at + 1);
            }
            self.statement = self.at;
            return true;
        }
        let end = super::closer(self.open[index].keyword);
        self.open.truncate(index + 1);
        self.replace(at, at + 1, RawKind::Word, Some(end));
        true
    }

    /// A token of a section: `name : INT = 5;`
    pub(super) fn declaration_token(&mut self, token: RawToken) {
        let at = self.at;
        if let Some(word) = token.keyword
            && (word.ends_section() || word.ends_block() || word == Keyword::Begin || word.begins_statement())
            && self.kind(at + 1) != Some(RawKind::Colon)
        {
            self.area = if word.ends_block() { Area::Head } else { Area::Statements };
            return self.pass(token);
        }
        if self.foreign_declaration(token) || self.enumerated_start(token) {
            return;
        }
        match token.kind {
            RawKind::Word | RawKind::Local
                if matches!(
                    self.kind(at + 1),
                    Some(RawKind::Colon | RawKind::Comma | RawKind::Assign | RawKind::LeftBrace)
                ) =>
            {
                self.declared.insert(self.slice(token).trim_start_matches('#').to_uppercase(), self.at);
            }
            RawKind::Equal if self.brackets.is_empty() && self.last.is_some_and(ends_operand) => {
                let (left, right) = self.sides(at, at + 1);
                let help = format!("write `{left} := {right}`");
                self.report(at, at + 1, "an initial value is given with `:=`".to_owned(), "read as `:=`", help);
                self.replace(at, at + 1, RawKind::Assign, None);
                return;
            }
            RawKind::Word if self.hyphenated_declaration(token) || self.swapped_declaration(token) => return,
            _ => {}
        }
        let is_text = token.kind == RawKind::Stray && self.curved_quotes(token);
        if is_text
            || self.name_with_digit(token)
            || self.repair_number(token)
            || self.parted_duration(token)
            || token.kind == RawKind::Literal && self.parted_digits(token)
            || self.date_with_slashes(token)
        {
            return;
        }
        self.at += 1;
        match token.kind {
            RawKind::LeftParen | RawKind::LeftBracket => self.brackets.push(true),
            RawKind::RightParen | RawKind::RightBracket => {
                self.brackets.pop();
            }
            RawKind::Semicolon => self.begin_statement(),
            _ => {}
        }
        self.last = Some(token);
    }

    /// `1a : INT;`, whose name is then one word wherever it is used.
    fn name_with_digit(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let rest = self.token(at + 1).filter(|next| next.kind == RawKind::Word && self.adjacent(at));
        let Some(rest) = rest.filter(|_| token.kind == RawKind::Number) else { return false };
        let begins = self.brackets.is_empty() && (at == self.statement || token.first_on_line);
        let declares = matches!(self.kind(at + 2), Some(RawKind::Colon | RawKind::Comma | RawKind::Assign));
        let is_value = |last: RawToken| matches!(last.kind, RawKind::Colon | RawKind::Assign | RawKind::Comma);
        if !begins || !declares || self.last.is_some_and(is_value) {
            return false;
        }
        let whole = RawToken { kind: RawKind::Word, end: rest.end, keyword: None, ..token };
        let name = self.slice(whole);
        let help = format!("write another name, such as `_{name}`");
        self.report(at, at + 2, format!("`{name}` is not a name"), "a name begins with a letter or `_`", help);
        self.declared.insert(name.to_uppercase(), at);
        self.edits.push(super::Edit { first: at, after: at + 2, with: vec![whole] });
        self.at = at + 2;
        self.last = Some(whole);
        true
    }

    /// The words from `at` that hyphens join without blanks, `belt-speed-max`: how many tokens they are.
    fn hyphenated(&self, at: usize) -> usize {
        let mut count = 1;
        while let (Some(last), Some(sign), Some(next)) =
            (self.token(at + count - 1), self.token(at + count), self.token(at + count + 1))
            && sign.kind == RawKind::Minus
            && next.kind == RawKind::Word
            && last.end == sign.start
            && sign.end == next.start
        {
            count += 2;
        }
        count
    }

    /// `belt-speed : INT;`, whose name is then one word wherever it is used.
    fn hyphenated_declaration(&mut self, token: RawToken) -> bool {
        let (at, count) = (self.at, self.hyphenated(self.at));
        if count == 1
            || self.kind(at + count) != Some(RawKind::Colon)
            || self.last.is_some_and(|last| last.kind == RawKind::Colon)
        {
            return false;
        }
        let whole = self.one_word(token, count);
        let name = self.slice(whole).to_owned();
        let title = format!("`{name}` is not a name");
        let help = format!("a name has letters, digits and `_`: write `{}`", name.replace('-', "_"));
        self.report(at, at + count, title, "`-` subtracts", help);
        self.with_hyphens.insert(name.to_uppercase());
        self.declared.insert(name.to_uppercase(), self.at);
        self.edits.push(super::Edit { first: at, after: at + count, with: vec![whole] });
        self.at = at + count;
        self.last = Some(whole);
        true
    }

    /// The use of a name that was declared with hyphens.
    pub(super) fn hyphenated_use(&mut self, token: RawToken) -> bool {
        if self.with_hyphens.is_empty() || !matches!(token.kind, RawKind::Word | RawKind::Local) {
            return false;
        }
        let (at, count) = (self.at, self.hyphenated(self.at));
        let whole = self.one_word(token, count);
        if count == 1 || !self.with_hyphens.contains(&self.slice(whole).trim_start_matches('#').to_uppercase()) {
            return false;
        }
        self.edits.push(super::Edit { first: at, after: at + count, with: vec![whole] });
        self.at = at + count;
        self.note(whole);
        true
    }

    /// The first token up to the end of the last of `count`.
    fn one_word(&self, token: RawToken, count: usize) -> RawToken {
        let end = self.token(self.at + count - 1).map_or(token.end, |last| last.end);
        RawToken { end, keyword: None, ..token }
    }

    /// `speed INT;` without `:`, and `INT speed;`.
    fn swapped_declaration(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let starts = at == self.statement
            || token.first_on_line
                && self.last.is_none_or(|last| last.kind == RawKind::Semicolon || last.keyword.is_some());
        let Some(next) = self.beside(at + 1).filter(|next| matches!(next.kind, RawKind::Word)) else { return false };
        let ends = matches!(self.kind(at + 2), Some(RawKind::Semicolon | RawKind::Assign | RawKind::Equal));
        if !starts || !ends || next.keyword.is_some() && next.keyword != Some(Keyword::String) {
            return false;
        }
        let (first, second) = (self.slice(token), self.slice(next));
        let is_type = |word: &str| {
            let upper = word.to_ascii_uppercase();
            crate::Elementary::from_word(&upper).is_some() || upper == "STRING"
        };
        let (name, ty) = match (is_type(first), is_type(second)) {
            (false, true) => (first, second),
            (true, false) => (second, first),
            _ => return false,
        };
        self.declared.insert(name.to_uppercase(), self.at);
        let title = if name == first {
            format!("`:` is missing between `{name}` and its type")
        } else {
            "the name of a variable comes before its type".to_owned()
        };
        self.report(at, at + 2, title, "not a declaration of SCL", format!("write `{name} : {ty};`"));
        let (name_token, type_token) = if name == first {
            (token, next)
        } else {
            (RawToken { keyword: None, ..next }, RawToken { first_on_line: false, ..token })
        };
        let colon = RawToken {
            kind: RawKind::Colon,
            start: name_token.end,
            end: name_token.end,
            first_on_line: false,
            keyword: None,
        };
        self.edits.push(super::Edit { first: at, after: at + 2, with: vec![name_token, colon, type_token] });
        self.at = at + 2;
        self.last = Some(type_token);
        true
    }
}

impl Open {
    /// An open statement without braces.
    #[cfg(test)]
    fn plain(keyword: Keyword) -> Open {
        Open { keyword, brace: false }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_statement_has_its_end() {
        for keyword in [Keyword::If, Keyword::Case, Keyword::For, Keyword::While, Keyword::Repeat] {
            assert_eq!(super::super::opener(super::super::closer(Open::plain(keyword).keyword)), Some(keyword));
        }
    }
}
