//! Values and targets of other languages: `a S= b`, `a SHL 2`, `a := IF c THEN 1 ELSE 2`, `a IN [1, 2]`, `a, b := 1`, `++a`, `a[1]:P`, `a[]`, and
//! `1..:` in CASE.

use plcc_diag::{Code, Diagnostic, Span};

use super::{Repair, begins_operand, ends_operand};
use crate::ast::OperandKind;
use crate::scl::address;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// A statement that is longer than this is not shown in a help.
const STATEMENT_MAX: usize = 60;

/// More values of a list than this are not written out in a message.
const VALUES_MAX: usize = 4;

impl Repair<'_> {
    /// A value that begins with a word, or has one between its operands.
    pub(super) fn foreign_value(&mut self, token: RawToken) -> bool {
        token.kind == RawKind::Word
            && (self.chosen_value(token)
                || self.if_of_c(token)
                || self.membership(token)
                || self.shift_in_words(token)
                || self.hexadecimal_without_base(token)
                || self.operator_of_queries(token)
                || self.set_or_reset(token))
    }

    /// `"Panel".list[2]:P`: an element past the process image.
    pub(super) fn element_past_image(&mut self) -> bool {
        let at = self.at;
        let after_index = self.last.is_some_and(|last| last.kind == RawKind::RightBracket);
        let letter = self.token(at + 1).filter(|_| at > 0 && self.adjacent(at - 1) && self.adjacent(at));
        let is_letter =
            letter.is_some_and(|letter| letter.kind == RawKind::Word && self.slice(letter).eq_ignore_ascii_case("P"));
        if !after_index || !is_letter || self.is_declared("P") {
            return false;
        }
        let element = self.words(self.operand_start(at), at - 1);
        let help = match element.starts_with('#') {
            true => format!("only inputs and outputs have `:P`: write `{element}`"),
            false => format!(
                "only inputs and outputs have `:P`: declare a tag at the address of `{element}`, and write `\"tag\":P`"
            ),
        };
        let title = "plcc does not read `:P` after an index";
        let message = Diagnostic::new(Code::OperandKind, self.span(at, at + 2), title);
        let message = message.label("an element past the process image").help(help);
        self.messages.push(message);
        self.drop_tokens(at, at + 2);
        true
    }

    /// `2; a := 1;` for `2: a := 1;` and `1; 2:` for `1, 2:` in CASE.
    pub(super) fn value_of_case_with_semicolon(&mut self) -> bool {
        let at = self.at;
        let inside = self.open.last().is_some_and(|open| open.keyword == Keyword::Case) && self.head.is_none();
        let first = self.statement;
        if !inside
            || !self.brackets.is_empty()
            || at != first + 1
            || !matches!(self.kind(first), Some(RawKind::Number | RawKind::Literal))
        {
            return false;
        }
        let is_value = |kind| matches!(kind, Some(RawKind::Number | RawKind::Literal));
        let more = self.beside(at + 1).is_some() && is_value(self.kind(at + 1));
        if more && matches!(self.kind(at + 2), Some(RawKind::Colon | RawKind::Semicolon | RawKind::Comma)) {
            let help = format!("write `{}, {}`", self.words(first, first), self.words(at + 1, at + 1));
            self.report(at, at + 1, "the values of CASE are separated by `,`".to_owned(), "read as `,`", help);
            self.replace(at, at + 1, RawKind::Comma, None);
            return true;
        }
        let help = format!("write `{}:`", self.words(first, first));
        self.report(at, at + 1, "a value of CASE ends with `:`".to_owned(), "read as `:`", help);
        self.replace(at, at + 1, RawKind::Colon, None);
        true
    }

    /// `a := IF c THEN 1 ELSE 2;`
    fn chosen_value(&mut self, token: RawToken) -> bool {
        const LOOK_MAX: usize = 200;
        let at = self.at;
        let assigned = self.last.is_some_and(|last| last.kind == RawKind::Assign) && at >= self.statement + 2;
        if token.keyword != Some(Keyword::If) || !assigned || !self.brackets.is_empty() || self.head.is_some() {
            return false;
        }
        let is_end = |token: &RawToken| {
            matches!(token.kind, RawKind::Semicolon | RawKind::Assign) || token.keyword.is_some_and(Keyword::ends_block)
        };
        let Some(end) = self.tokens[at..].iter().take(LOOK_MAX).position(is_end).map(|end| at + end) else {
            return false;
        };
        let find = |keyword, first| (first..end).find(|index| self.keyword(*index) == Some(keyword));
        let Some(then) = find(Keyword::Then, at) else { return false };
        let Some(other) = find(Keyword::Else, then) else { return false };
        let last = find(Keyword::EndIf, other).unwrap_or(end);
        // An assignment in a branch: the value before IF is missing.
        let two = find(Keyword::Elsif, at).or(find(Keyword::ElseIf, at)).is_none();
        if !two || self.kind(end) != Some(RawKind::Semicolon) || then < at + 2 || other < then + 2 || last < other + 2 {
            return false;
        }
        let target = self.words(self.statement, at - 2);
        let (condition, yes, no) =
            (self.words(at + 1, then - 1), self.words(then + 1, other - 1), self.words(other + 1, last - 1));
        let help = format!("write `IF {condition} THEN {target} := {yes}; ELSE {target} := {no}; END_IF;`");
        self.report(at, at + 1, "IF is a statement, not a value".to_owned(), "a form of other languages", help);
        self.give_up(end);
        true
    }

    /// `lamp S= on;`, `lamp R= off;`
    fn set_or_reset(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let word = self.slice(token).to_ascii_uppercase();
        let value = match word.as_str() {
            "S" => "TRUE",
            "R" => "FALSE",
            _ => return false,
        };
        let sign = self.kind(at + 1) == Some(RawKind::Equal) && self.adjacent(at);
        let outside = self.brackets.is_empty() && self.head.is_none() && self.statement < at;
        if !sign || !outside || token.first_on_line || !self.last.is_some_and(ends_operand) {
            return false;
        }
        let end = self.end_of_statement(at);
        if end <= at + 2 {
            return false;
        }
        let (target, condition) = (self.words(self.statement, at - 1), self.words(at + 2, end - 1));
        let help = format!("write `IF {condition} THEN {target} := {value}; END_IF;`");
        self.report(at, at + 2, format!("SCL has no `{word}=`"), "a form of other languages", help);
        self.give_up(end);
        true
    }

    /// `a IN [1, 2, 5..7]`, `a IN (1, 2)`, `a NOT IN (1, 2)`
    fn membership(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let negated = token.keyword == Some(Keyword::Not);
        let list = if negated { at + 2 } else { at + 1 };
        let is_in = self.token(list - 1).is_some_and(|word| self.slice(word).eq_ignore_ascii_case("IN"));
        let counts = self.head.as_ref().is_some_and(|head| head.keyword == Keyword::For);
        if !is_in
            || token.first_on_line
            || counts
            || !self.last.is_some_and(ends_operand)
            || !matches!(self.kind(list), Some(RawKind::LeftBracket | RawKind::LeftParen))
        {
            return false;
        }
        let end = self.end_of_statement(at);
        let Some(close) = self.closing(list).filter(|close| *close < end && *close > list + 1) else { return false };
        let first = self.operand_start(at);
        let value = self.words(first, at - 1);
        let parts = self.parts(list + 1, close).into_iter();
        let conditions: Vec<String> = parts.map(|(first, last)| self.is_one_of(value, first, last, negated)).collect();
        let join = if negated { " AND " } else { " OR " };
        let more = if conditions.len() > VALUES_MAX { format!("{join}…") } else { String::new() };
        let shown = &conditions[..conditions.len().min(VALUES_MAX)];
        let help = format!("write `{}{more}`", shown.join(join));
        self.report(at, close + 1, "SCL has no operator `IN`".to_owned(), "a form of other languages", help);
        self.replace(first, close + 1, RawKind::Reported, None);
        true
    }

    /// The condition for one part of a list, from token `first` to `last`: a value, or a range. `negated`: that it is not the one.
    fn is_one_of(&self, value: &str, first: usize, last: usize, negated: bool) -> String {
        let points = (first + 1..last).find(|index| self.kind(*index) == Some(RawKind::DotDot));
        let range = points.map(|points| (self.words(first, points - 1), self.words(points + 1, last)));
        match (range, negated) {
            (Some((low, high)), false) => format!("({value} >= {low} AND {value} <= {high})"),
            (Some((low, high)), true) => format!("({value} < {low} OR {value} > {high})"),
            (None, false) => format!("{value} = {}", self.words(first, last)),
            (None, true) => format!("{value} <> {}", self.words(first, last)),
        }
    }

    /// `a BETWEEN 1 AND 5`, `a LIKE 'x%'`
    fn operator_of_queries(&mut self, token: RawToken) -> bool {
        const LOOK_MAX: usize = 12;
        let at = self.at;
        let word = self.slice(token);
        let between = word.eq_ignore_ascii_case("BETWEEN");
        if !(between || word.eq_ignore_ascii_case("LIKE"))
            || token.first_on_line
            || self.is_declared(word)
            || !self.last.is_some_and(ends_operand)
        {
            return false;
        }
        let first = self.operand_start(at);
        let value = self.words(first, at - 1);
        let (after, help) = if between {
            let is_and = |index: &usize| self.keyword(*index) == Some(Keyword::And);
            let Some(and) = (at + 2..self.tokens.len().min(at + LOOK_MAX)).find(is_and) else { return false };
            let high = if self.kind(and + 1) == Some(RawKind::Minus) { and + 2 } else { and + 1 };
            if !self.token(high).is_some_and(begins_operand) {
                return false;
            }
            let after = self.operand_end(high);
            let (low, high) = (self.words(at + 1, and - 1), self.words(and + 1, after - 1));
            (after, format!("write `{value} >= {low} AND {value} <= {high}`"))
        } else {
            if self.kind(at + 1) != Some(RawKind::Text) {
                return false;
            }
            let text = self.words(at + 1, at + 1).replace('%', "");
            (at + 2, format!("write `FIND(IN1 := {value}, IN2 := {text}) > 0`"))
        };
        let title = format!("SCL has no operator `{}`", word.to_ascii_uppercase());
        self.report(at, after, title, "a form of other languages", help);
        self.replace(first, after, RawKind::Reported, None);
        true
    }

    /// What commas separate from token `first` up to `after`, exclusive: the first and last token of each part.
    pub(super) fn parts(&self, first: usize, after: usize) -> Vec<(usize, usize)> {
        let (mut depth, mut begin, mut found) = (0usize, first, Vec::new());
        for index in first..after {
            match self.kind(index) {
                Some(RawKind::LeftParen | RawKind::LeftBracket) => depth += 1,
                Some(RawKind::RightParen | RawKind::RightBracket) => depth = depth.saturating_sub(1),
                Some(RawKind::Comma) if depth == 0 => {
                    if index > begin {
                        found.push((begin, index - 1));
                    }
                    begin = index + 1;
                }
                _ => {}
            }
        }
        if after > begin {
            found.push((begin, after - 1));
        }
        found
    }

    /// `a := 1,` and `f(x),` at the end of a line.
    pub(super) fn comma_at_end(&mut self) -> bool {
        let (first, at) = (self.statement, self.at);
        let outside = self.brackets.is_empty() && self.head.is_none() && first < at;
        let is_called = self.last.is_some_and(|last| last.kind == RawKind::RightParen);
        if !outside
            || self.beside(at + 1).is_some()
            || !(is_called || self.is_assigned())
            || !self.last.is_some_and(ends_operand)
        {
            return false;
        }
        let statement = self.words(first, at - 1);
        let help = match statement.len() <= STATEMENT_MAX && !statement.contains('\n') {
            true => format!("write `{statement};`"),
            false => "write `;`".to_owned(),
        };
        self.report(at, at + 1, "a statement ends with `;`".to_owned(), "read as `;`", help);
        self.replace(at, at + 1, RawKind::Semicolon, None);
        true
    }

    /// `a SHL 2`
    fn shift_in_words(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let word = self.slice(token).to_ascii_uppercase();
        let known = matches!(word.as_str(), "SHL" | "SHR" | "ROL" | "ROR") && !token.first_on_line;
        if !known || !self.last.is_some_and(ends_operand) || !self.beside(at + 1).is_some_and(begins_operand) {
            return false;
        }
        let (left, right) = self.sides(at, at + 1);
        let title = format!("`{word}` is a function, not an operator");
        let help = format!("write `{word}(IN := {left}, N := {right})`");
        self.report(at, at + 1, title, "a form of other languages", help);
        if self.head.is_some() {
            self.replace(at, at + 1, RawKind::Plus, None);
        } else {
            self.give_up(self.end_of_statement(at));
        }
        true
    }

    /// `W#FF`
    fn hexadecimal_without_base(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let width = self.slice(token).to_ascii_uppercase();
        let next = self.token(at + 1).filter(|next| next.kind == RawKind::Local && self.adjacent(at));
        let digits = next.map_or("", |next| self.slice(next).trim_start_matches('#'));
        let is_number = !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
        let is_width = matches!(width.as_str(), "B" | "W" | "DW" | "BYTE" | "WORD" | "DWORD");
        if !is_number || !is_width || self.last.is_some_and(ends_operand) {
            return false;
        }
        let help = format!("write `{width}#16#{}`", digits.to_ascii_uppercase());
        self.report(at, at + 2, "a hexadecimal number begins with `16#`".to_owned(), "not a number of SCL", help);
        self.replace(at, at + 2, RawKind::Reported, None);
        true
    }

    /// `a[]`
    pub(super) fn empty_index(&mut self) -> bool {
        let at = self.at;
        if self.kind(at + 1) != Some(RawKind::RightBracket) || !self.last.is_some_and(ends_operand) {
            return false;
        }
        let first = self.operand_start(at);
        let operand = self.words(first, at - 1);
        let help = format!("write `{operand}[1]` for an element, `{operand}` for the whole array");
        let title = "the number of the element is missing".to_owned();
        self.report(at, at + 2, title, "nothing is between the brackets", help);
        if first == self.statement {
            self.give_up(self.end_of_statement(at));
        } else {
            self.replace(first, at + 2, RawKind::Reported, None);
        }
        true
    }

    /// `"Motor", "Motor_DB" (on := TRUE);`: a call of STL without CALL.
    pub(super) fn block_and_instance(&mut self) -> bool {
        let (first, at) = (self.statement, self.at);
        let outside = self.brackets.is_empty() && self.head.is_none() && first < at;
        let is_name = |kind| matches!(kind, Some(RawKind::Word | RawKind::Quoted | RawKind::Local));
        if !outside || !is_name(self.kind(first)) || self.keyword(first).is_some() || self.operand_end(first) != at {
            return false;
        }
        let block = self.words(first, at - 1);
        let Some(open) = self.parenthesis_after(at + 1) else { return false };
        let end = self.end_of_statement(open);
        let is_whole = self.closing(open).is_some_and(|close| close + 1 == end);
        if !is_whole || block.contains(['(', '[']) {
            return false;
        }
        let instance = self.words(at + 1, open - 1);
        // `FB1, DB5 (…)`
        let callee = match address::numbered_block(instance) {
            Some(_) => format!("{block}.{instance}"),
            None => instance.to_owned(),
        };
        let title = "a block is called by its name alone".to_owned();
        self.report(first, at + 1, title, "a form of STL", format!("write `{callee}( … );`"));
        self.give_up(end);
        true
    }

    /// Index of the parenthesis after the instance at `first`: `"Motor_DB" (`, `#motors[1] (`, `#line.motors[1].inner (`.
    fn parenthesis_after(&self, first: usize) -> Option<usize> {
        let mut after = self.end_of_callee(first)?;
        while self.kind(after) == Some(RawKind::LeftBracket) {
            after = self.closing(after)? + 1;
            while self.kind(after) == Some(RawKind::Dot) && after + 1 < self.tokens.len() {
                after += 2;
            }
        }
        (self.kind(after) == Some(RawKind::LeftParen)).then_some(after)
    }

    /// `a, b := 1;`, `a, b := c, d;`
    pub(super) fn several_targets(&mut self) -> bool {
        const LOOK_MAX: usize = 40;
        let (first, at) = (self.statement, self.at);
        let outside = self.brackets.is_empty() && self.head.is_none();
        let named =
            matches!(self.kind(first), Some(RawKind::Word | RawKind::Local | RawKind::Quoted | RawKind::Absolute));
        if !outside || !named || first >= at || self.is_assigned() || !self.last.is_some_and(ends_operand) {
            return false;
        }
        let after = self.tokens.len().min(at + LOOK_MAX);
        let is_sign = |index: &usize| {
            let token = self.tokens[*index];
            matches!(token.kind, RawKind::Assign | RawKind::Colon | RawKind::Semicolon)
                || token.keyword.is_some_and(Keyword::ends_expression)
        };
        let assign = (at..after).find(is_sign).filter(|sign| self.kind(*sign) == Some(RawKind::Assign));
        let Some(assign) = assign else { return false };
        let end = self.end_of_statement(assign);
        // `M0,0 := TRUE;`
        let address = format!("{}.{}", self.words(first, first), self.words(at + 1, at + 1));
        if at == first + 1
            && assign == at + 2
            && self.kind(at + 1) == Some(RawKind::Number)
            && self.adjacent(first)
            && self.adjacent(at)
            && matches!(address::token(&address, Span::default()), Some(OperandKind::Absolute { .. }))
        {
            let title = "an address has a point before the number of its bit".to_owned();
            self.report(first, assign, title, "a form of other languages", format!("write `{address}`"));
            self.give_up(end);
            return true;
        }
        let (targets, values) = (self.parts(first, assign), self.parts(assign + 1, end));
        let text = |part: &(usize, usize)| self.words(part.0, part.1);
        let targets: Vec<&str> = targets.iter().map(text).collect();
        let values: Vec<&str> = values.iter().map(text).collect();
        let mentioned = |value: &&str| targets.iter().any(|target| value.contains(target));
        let help = match values.as_slice() {
            [value] if !value.contains('(') => {
                let all: Vec<String> = targets.iter().map(|target| format!("{target} := {value};")).collect();
                format!("write `{}`", all.join(" "))
            }
            values if values.len() == targets.len() && !values.iter().any(mentioned) => {
                let all: Vec<String> =
                    targets.iter().zip(values).map(|(target, value)| format!("{target} := {value};")).collect();
                format!("write `{}`", all.join(" "))
            }
            _ => format!("write one assignment for each: `{} := …;`", targets.join(" := …; ")),
        };
        let title = "an assignment has one variable before `:=`".to_owned();
        self.report(first, assign, title, "a form of other languages", help);
        self.give_up(end);
        true
    }

    /// `a := 1, b := 2;`
    pub(super) fn comma_between_assignments(&mut self) -> bool {
        let at = self.at;
        let outside = self.brackets.is_empty() && self.head.is_none();
        if !outside || !self.is_assigned() || !self.last.is_some_and(ends_operand) {
            return false;
        }
        let is_name = |kind| matches!(kind, Some(RawKind::Word | RawKind::Local | RawKind::Quoted | RawKind::Absolute));
        if !is_name(self.kind(at + 1)) || self.kind(self.operand_end(at + 1)) != Some(RawKind::Assign) {
            return false;
        }
        let help = format!("write `{};`", self.words(self.statement, at - 1));
        self.report(at, at + 1, "a statement ends with `;`".to_owned(), "read as `;`", help);
        self.replace(at, at + 1, RawKind::Semicolon, None);
        true
    }

    /// `++i;`, `--i;`
    pub(super) fn step_before(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let twice = self.token(at + 1).is_some_and(|next| next.kind == token.kind) && self.adjacent(at);
        let begins = self.brackets.is_empty() && self.head.is_none() && at == self.statement;
        let variable = self.token(at + 2).filter(|next| {
            matches!(next.kind, RawKind::Word | RawKind::Local | RawKind::Quoted) && next.keyword.is_none()
        });
        if !twice || !begins || variable.is_none() || !self.adjacent(at + 1) {
            return false;
        }
        let after = self.operand_end(at + 2);
        if self.kind(after) != Some(RawKind::Semicolon) {
            return false;
        }
        let variable = self.words(at + 2, after - 1);
        let sign = self.slice(token);
        let help = format!("write `{variable} := {variable} {sign} 1;`");
        self.report(at, at + 2, format!("SCL has no `{sign}{sign}`"), "a form of other languages", help);
        self.give_up(after);
        true
    }

    /// `1..:` and `..5:` as values of CASE.
    pub(super) fn open_range(&mut self) -> bool {
        let at = self.at;
        let inside = self.open.last().is_some_and(|open| open.keyword == Keyword::Case) && self.head.is_none();
        if !inside || !self.brackets.is_empty() {
            return false;
        }
        let ends = |kind| matches!(kind, Some(RawKind::Colon | RawKind::Comma));
        let is_value = |kind| matches!(kind, Some(RawKind::Number | RawKind::Literal | RawKind::Minus));
        let (title, written) = match (at == self.statement, ends(self.kind(at + 1))) {
            (false, true) => ("this range has no last value", self.words(at - 1, at)),
            (true, false) if is_value(self.kind(at + 1)) => ("this range has no first value", self.words(at, at + 1)),
            _ => return false,
        };
        let help = format!("write both ends of `{written}`, or put these statements after ELSE");
        self.report(at, at + 1, title.to_owned(), "a range of CASE has two ends", help);
        self.drop_tokens(at, at + 1);
        true
    }

    /// `a->b`: a component of a structure. Called at the minus.
    pub(super) fn component_with_arrow(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let joined = at > 0 && (at - 1..=at + 1).all(|index| self.adjacent(index));
        let kinds = [at + 1, at + 2].map(|index| self.kind(index));
        let is_arrow = token.kind == RawKind::Minus && kinds == [Some(RawKind::Greater), Some(RawKind::Word)];
        if !joined || !is_arrow || !self.last.is_some_and(ends_operand) {
            return false;
        }
        let (structure, component) = (self.words(self.operand_start(at), at - 1), self.words(at + 2, at + 2));
        let help = format!("write `{structure}.{component}`");
        self.report(at, at + 2, "a component follows a point".to_owned(), "a form of other languages", help);
        self.replace(at, at + 2, RawKind::Dot, None);
        true
    }
}
