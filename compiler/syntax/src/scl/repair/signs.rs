//! Signs and numbers of other languages: `==`, `&&`, `i++`, `0x1F`, `3,5`.
//!
//! - Here: operators and assignments; `conditions`: what is on both sides of them.
//! - `numbers`: `0x1F`, `3,5`; `comments`: `# text`, and `*)` alone.

mod comments;
mod conditions;
mod numbers;

use plcc_diag::{Code, Diagnostic, Span};

use super::{Edit, Repair, begins_operand, ends_operand};
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// Two signs without a blank between them, what they are in SCL, as a kind or keyword, and in words.
const PAIRS: &[(RawKind, RawKind, RawKind, &str, &str)] = &[
    (RawKind::Equal, RawKind::Equal, RawKind::Equal, "=", "values are compared with `=`"),
    (RawKind::Greater, RawKind::Less, RawKind::NotEqual, "<>", "not equal is `<>`"),
    (RawKind::Equal, RawKind::Less, RawKind::LessEqual, "<=", "less or equal is `<=`"),
    (RawKind::Ampersand, RawKind::Ampersand, RawKind::Ampersand, "AND", "the operator is `AND`"),
];

impl Repair<'_> {
    /// Repairs the sign or number at the current place.
    pub(super) fn repair_sign(&mut self, token: RawToken) -> bool {
        match token.kind {
            RawKind::Number | RawKind::Real => self.repair_number(token),
            RawKind::Semicolon => self.arguments_with_semicolon() || self.value_of_case_with_semicolon(),
            RawKind::Colon => {
                self.colon_after_word()
                    || self.split_assignment()
                    || self.element_past_image()
                    || self.time_with_colons()
            }
            RawKind::Stray => self.stray_sign(token) || self.curved_quotes(token),
            RawKind::Assign => self.value_with_sign(),
            RawKind::Arrow => self.value_with_sign() || self.arrow(),
            RawKind::LeftParen => self.type_in_brackets() || self.list_of_values(),
            RawKind::Literal => {
                self.parted_duration(token) || self.parted_digits(token) || self.date_with_slashes(token)
            }
            RawKind::Local => self.region_with_sign(token),
            RawKind::Hash => self.parted_duration(token) || self.split_local(token) || self.comment_with_hash(token),
            RawKind::Caret => self.power(),
            RawKind::Text => self.doubled_quote(token) || self.apostrophe(token),
            RawKind::Dot => self.bare_fraction() || self.bit_after_point(),
            RawKind::Plus | RawKind::Minus => {
                self.step(token)
                    || self.step_before(token)
                    || self.comment_with_minus(token)
                    || self.component_with_arrow(token)
            }
            RawKind::Slash => self.half_comment(token),
            RawKind::Star => self.end_of_no_comment(),
            RawKind::Comma => {
                self.comma_at_end()
                    || self.block_and_instance()
                    || self.several_targets()
                    || self.comma_between_assignments()
            }
            RawKind::DotDot => self.open_range(),
            RawKind::LeftBracket => self.empty_index() || self.list_of_values(),
            RawKind::LeftBrace => self.index_in_braces(),
            kind if is_comparison(kind) && (self.half_comparison(token) || self.compared_case(token)) => true,
            RawKind::Equal
                if self.value_with_sign()
                    || self.exchanged_assignment()
                    || self.equal_in_data()
                    || self.comparison_for_assignment() =>
            {
                true
            }
            RawKind::Less | RawKind::Greater if self.shift(token) || self.back_arrow(token) => true,
            RawKind::Equal | RawKind::Greater | RawKind::Ampersand => self.pair(token),
            _ => false,
        }
    }

    /// `a == 5;` as a statement.
    fn comparison_for_assignment(&mut self) -> bool {
        let at = self.at;
        let twice = self.kind(at + 1) == Some(RawKind::Equal) && self.adjacent(at);
        let target = self.head.is_none()
            && self.brackets.is_empty()
            && self.statement < at
            && self.last.is_some_and(|last| ends_operand(last) && last.kind != RawKind::RightParen)
            && self.operand_start(at) == self.statement;
        if !twice || !target {
            return false;
        }
        let (left, right) = self.sides(at, at + 2);
        let help = format!("write `{left} := {right}`");
        self.report(at, at + 2, "a value is assigned with `:=`".to_owned(), "read as `:=`", help);
        self.replace(at, at + 2, RawKind::Assign, None);
        true
    }

    fn pair(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let Some(next) = self.token(at + 1).filter(|_| self.adjacent(at)) else { return false };
        let Some((_, _, kind, sign, title)) =
            PAIRS.iter().find(|(first, second, ..)| (*first, *second) == (token.kind, next.kind))
        else {
            return false;
        };
        self.operator(2, *kind, None, sign, title)
    }

    /// The operator of `count` tokens is `sign` in SCL.
    pub(super) fn operator(
        &mut self,
        count: usize,
        kind: RawKind,
        keyword: Option<Keyword>,
        sign: &str,
        title: &str,
    ) -> bool {
        let at = self.at;
        let (left, right) = match sign {
            "AND" | "OR" => self.conditions(at, at + count),
            _ => self.sides(at, at + count),
        };
        let help = format!("write `{left} {sign} {right}`");
        self.report(at, at + count, title.to_owned(), &format!("read as `{sign}`"), help);
        self.replace(at, at + count, kind, keyword);
        true
    }

    /// `!=`, `!x`, `||`, `|`, `%`, `x ? a : b`
    fn stray_sign(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let after_operand = self.last.is_some_and(ends_operand);
        match self.slice(token) {
            "!" if self.kind(at + 1) == Some(RawKind::Equal) && self.adjacent(at) => {
                let count = if self.kind(at + 2) == Some(RawKind::Equal) && self.adjacent(at + 1) { 3 } else { 2 };
                self.operator(count, RawKind::NotEqual, None, "<>", "not equal is `<>`")
            }
            "$" if !after_operand => self.dollar_number(),
            "!" | "~" if !after_operand => {
                let (_, operand) = self.sides(at, at + 1);
                let help = format!("write `NOT {operand}`");
                self.report(at, at + 1, "the operator is `NOT`".to_owned(), "read as `NOT`", help);
                self.replace(at, at + 1, RawKind::Word, Some(Keyword::Not));
                true
            }
            "||" | "|" if after_operand => {
                self.operator(1, RawKind::Word, Some(Keyword::Or), "OR", "the operator is `OR`")
            }
            "%" if after_operand => {
                self.operator(1, RawKind::Word, Some(Keyword::Mod), "MOD", "the remainder of a division is `MOD`")
            }
            "?" if after_operand => {
                let end = self.end_of_statement(at);
                let first = self.statement;
                let assigned = (first..at).find(|index| self.kind(*index) == Some(RawKind::Assign));
                let colon = (at..end).find(|index| self.kind(*index) == Some(RawKind::Colon));
                let help = match (assigned, colon) {
                    (Some(assign), Some(colon)) if assign > first && colon > at + 1 && colon + 1 < end => {
                        let target = self.words(first, assign - 1);
                        let condition = self.words(assign + 1, at - 1);
                        let (yes, no) = (self.words(at + 1, colon - 1), self.words(colon + 1, end - 1));
                        format!("write `IF {condition} THEN {target} := {yes}; ELSE {target} := {no}; END_IF;`")
                    }
                    _ => "write `IF condition THEN … ELSE … END_IF;`".to_owned(),
                };
                self.report(
                    at,
                    at + 1,
                    "SCL chooses between two values with IF".to_owned(),
                    "a form of other languages",
                    help,
                );
                self.give_up(end);
                true
            }
            _ => false,
        }
    }

    /// `i++;`, `i--;`
    fn step(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let twice = self.token(at + 1).is_some_and(|next| next.kind == token.kind) && self.adjacent(at);
        let ends = matches!(self.kind(at + 2), Some(RawKind::Semicolon))
            || self.token(at + 2).is_none_or(|next| next.first_on_line);
        if !twice || !ends || !self.last.is_some_and(ends_operand) || at == self.statement {
            return false;
        }
        let first = self.operand_start(at);
        let variable = self.words(first, at - 1);
        let sign = self.slice(token);
        let title = format!("SCL has no `{sign}{sign}`");
        // `a := i++;`
        let before = if first > self.statement { self.words(self.statement, at - 1) } else { "" };
        let before = if before.is_empty() { String::new() } else { format!("{before}; ") };
        let help = format!("write `{before}{variable} := {variable} {sign} 1;`");
        self.report(at, at + 2, title, "a form of other languages", help);
        self.give_up(at + 2);
        true
    }

    /// `a << 2`, `a >> 2`
    fn shift(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let twice = self.token(at + 1).is_some_and(|next| next.kind == token.kind) && self.adjacent(at);
        if !twice || !self.last.is_some_and(ends_operand) {
            return false;
        }
        let (left, right) = self.sides(at, at + 2);
        let function = if token.kind == RawKind::Less { "SHL" } else { "SHR" };
        let title = format!("the function that shifts is `{function}`");
        self.report(
            at,
            at + 2,
            title,
            "a form of other languages",
            format!("write `{function}(IN := {left}, N := {right})`"),
        );
        let end = self.end_of_statement(at);
        if self.head.is_some() {
            // The rest of the condition goes with it.
            self.replace(at, at + 2, RawKind::Plus, None);
        } else {
            self.give_up(end);
        }
        true
    }

    /// `a ^ 2`, which other languages have for powers, and some for exclusive OR; `^` of SCL follows a reference.
    fn power(&mut self) -> bool {
        let at = self.at;
        let operand = self.token(at + 1).is_some_and(begins_operand) && self.beside(at + 1).is_some();
        if !operand || !self.last.is_some_and(ends_operand) {
            return false;
        }
        let (first, after) = (self.operand_start(at), self.operand_end(at + 1));
        let (left, right) = (self.words(first, at - 1), self.words(at + 1, after - 1));
        let help = format!("write `{left} ** {right}` for a power, `{left} XOR {right}` for an exclusive OR");
        self.report(at, at + 1, "SCL has no operator `^`".to_owned(), "follows a reference only", help);
        self.replace(first, after, RawKind::Reported, None);
        true
    }

    /// `'it''s'`: a quote inside a text is `$'`.
    fn doubled_quote(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let mut after = at + 1;
        while self.kind(after) == Some(RawKind::Text) && self.adjacent(after - 1) {
            after += 1;
        }
        if after == at + 1 {
            return false;
        }
        let parts: Vec<&str> = (at..after)
            .filter_map(|index| self.token(index))
            .map(|part| self.slice(part).trim_start_matches('\'').trim_end_matches('\''))
            .collect();
        let help = format!("write `'{}'`", parts.join("$'"));
        self.report(at, after, "a quote inside a text is written `$'`".to_owned(), "read as one text", help);
        debug_assert_eq!(token.kind, RawKind::Text, "called at a text");
        self.replace(at, after, RawKind::Reported, None);
        true
    }

    /// `'it's'`: a text with one quote inside, whose last quote opens a text without an end.
    fn apostrophe(&mut self, token: RawToken) -> bool {
        const LOOK_MAX: usize = 40;
        let at = self.at;
        // What follows a word at once is the end of a text, as in `'it's', 'a'`.
        let ends_text = at > 0 && self.adjacent(at - 1) && self.kind(at - 1) == Some(RawKind::Word);
        if ends_text || !self.adjacent(at) || self.kind(at + 1) != Some(RawKind::Word) {
            return false;
        }
        let mut line = (at + 1..).take(LOOK_MAX).take_while(|index| self.beside(*index).is_some());
        let is_text = |index: &usize| matches!(self.kind(*index), Some(RawKind::Text | RawKind::UnterminatedText));
        let last = line.find(is_text).filter(|last| self.kind(*last) == Some(RawKind::UnterminatedText));
        let Some((last, open)) = last.and_then(|last| Some((last, self.token(last)?))) else { return false };
        let (text, close) = (self.text, open.start + 1);
        let tail = text.get(close as usize..open.end as usize).unwrap_or_default();
        let tail = tail.split("//").next().unwrap_or_default();
        let inner = text.get(token.start as usize + 1..open.start as usize).unwrap_or_default();
        if !tail.chars().all(|sign| matches!(sign, ')' | ']' | ';' | ' ' | '\t' | '\r')) {
            return false;
        }
        let span = Span { file: self.file, start: token.start, end: close };
        let message = Diagnostic::new(Code::ForeignForm, span, "a quote inside a text is written `$'`");
        let help = format!("write `'{}'`", inner.replace('\'', "$'"));
        self.messages.push(message.label("read as one text").help(help));
        let mut with = vec![RawToken { kind: RawKind::Reported, end: close, keyword: None, ..token }];
        for (offset, sign) in tail.char_indices() {
            let kind = match sign {
                ')' => RawKind::RightParen,
                ']' => RawKind::RightBracket,
                ';' => RawKind::Semicolon,
                _ => continue,
            };
            let start = close + offset as u32;
            with.push(RawToken { kind, keyword: None, start, end: start + 1, first_on_line: false });
        }
        self.edits.push(Edit { first: at, after: last + 1, with: with.clone() });
        self.at = last + 1;
        for token in with {
            self.note(token);
        }
        true
    }

    /// `a : = 5;`
    fn split_assignment(&mut self) -> bool {
        let at = self.at;
        let next = self.beside(at + 1).filter(|next| next.kind == RawKind::Equal);
        if next.is_none() || !self.last.is_some_and(ends_operand) {
            return false;
        }
        let (left, right) = self.sides(at, at + 2);
        let help = format!("write `{left} := {right}`");
        self.report(at, at + 2, "`:=` is one sign".to_owned(), "read as `:=`", help);
        self.replace(at, at + 2, RawKind::Assign, None);
        true
    }

    /// `# i := 5`: a local name with a blank in it.
    fn split_local(&mut self, token: RawToken) -> bool {
        const LINE_MAX: usize = 40;
        let at = self.at;
        let Some(name) = self.beside(at + 1).filter(|next| next.kind == RawKind::Word && !self.adjacent(at)) else {
            return false;
        };
        let word = self.slice(name);
        // At the beginning of a line it may be a comment.
        let begins = token.first_on_line || self.last.is_none_or(|last| last.kind == RawKind::Semicolon);
        let assigns = |kind: Option<RawKind>| {
            matches!(
                kind,
                Some(
                    RawKind::Assign
                        | RawKind::AddAssign
                        | RawKind::SubtractAssign
                        | RawKind::MultiplyAssign
                        | RawKind::DivideAssign
                )
            )
        };
        let is_target = || match self.kind(at + 2) {
            Some(RawKind::Dot | RawKind::LeftBracket) => (at + 3..)
                .take(LINE_MAX)
                .take_while(|index| self.beside(*index).is_some())
                .any(|index| assigns(self.kind(index))),
            kind => assigns(kind),
        };
        if !self.is_declared(word) || begins && !is_target() {
            return false;
        }
        let help = format!("write `#{word}`");
        self.report(at, at + 2, "`#` and the name have no blank between them".to_owned(), "read as one name", help);
        let local = RawToken { kind: RawKind::Local, keyword: None, first_on_line: token.first_on_line, ..name };
        self.edits.push(super::Edit { first: at, after: at + 2, with: vec![local] });
        self.at = at + 2;
        self.note(local);
        true
    }

    /// `f(a := 1; b := 2)`
    fn arguments_with_semicolon(&mut self) -> bool {
        const LOOK_MAX: usize = 200;
        let at = self.at;
        if self.brackets.last() != Some(&true) || self.head.is_some() {
            return false;
        }
        let formal = matches!(self.kind(at + 1), Some(RawKind::Word | RawKind::Local))
            && matches!(self.kind(at + 2), Some(RawKind::Assign | RawKind::Arrow));
        // `)` that belongs to the call must follow.
        let mut depth = 0usize;
        let closed = self.tokens[at + 1..].iter().take(LOOK_MAX).find_map(|token| match token.kind {
            RawKind::LeftParen | RawKind::LeftBracket => {
                depth += 1;
                None
            }
            RawKind::RightParen | RawKind::RightBracket if depth == 0 => Some(true),
            RawKind::RightParen | RawKind::RightBracket => {
                depth -= 1;
                None
            }
            _ => token.keyword.is_some_and(|word| word.ends_expression()).then_some(false),
        });
        let last = self.kind(at + 1) == Some(RawKind::RightParen);
        if closed != Some(true) || !(formal || last) {
            return false;
        }
        let title = "the parameters of a call are separated by `,`".to_owned();
        let help = match last {
            true => "remove `;` before `)`".to_owned(),
            false => format!("write `, {} {} …`", self.words(at + 1, at + 1), self.words(at + 2, at + 2)),
        };
        self.report(at, at + 1, title, if last { "not needed" } else { "read as `,`" }, help);
        if last {
            self.drop_tokens(at, at + 1);
        } else {
            // The statement goes on.
            self.edits.push(super::Edit {
                first: at,
                after: at + 1,
                with: vec![RawToken { kind: RawKind::Comma, ..self.tokens[at] }],
            });
            self.at += 1;
            self.last = Some(RawToken { kind: RawKind::Comma, ..self.tokens[at] });
        }
        true
    }
}

pub(super) fn is_comparison(kind: RawKind) -> bool {
    matches!(
        kind,
        RawKind::Less
            | RawKind::Greater
            | RawKind::LessEqual
            | RawKind::GreaterEqual
            | RawKind::Equal
            | RawKind::NotEqual
    )
}
