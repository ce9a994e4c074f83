//! Statements and addresses of other languages: blocks of Pascal, methods, LOOP, operators in two words, addresses of other controllers.

use plcc_diag::Span;

use super::{Open, Repair, begins_operand, closer, ends_operand};
use crate::Elementary;
use crate::ast::{OperandKind, Width};
use crate::front::foreign_address;
use crate::scl::address;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// Parts of a block that SCL does not have, with the words that end them and what takes their place.
const PARTS: [(&str, &[&str], &str); 6] = [
    ("METHOD", &["END_METHOD"], "write a FUNCTION or a FUNCTION_BLOCK with these statements, and call it"),
    ("PROPERTY", &["END_PROPERTY"], "declare a variable in VAR_INPUT or VAR_OUTPUT"),
    ("ACTION", &["END_ACTION"], "write a FUNCTION with these statements, and call it"),
    (
        "CLASS",
        &["END_CLASS"],
        "write a FUNCTION_BLOCK with its variables and the statements of one method, and a FUNCTION for each other method",
    ),
    (
        "CONFIGURATION",
        &["END_CONFIGURATION"],
        "call its programs in organization blocks: OB 1 runs in each cycle, OB 30 to OB 38 run in an interval",
    ),
    ("INTERFACE", &["END_INTERFACE"], "write the blocks themselves, and call each by its name"),
];

/// Functions with one argument that people write without brackets; those of conversions have `_TO_` in their names.
const FUNCTIONS: [&str; 19] = [
    "ABS", "ACOS", "ASIN", "ATAN", "CEIL", "CHR", "COS", "EXP", "EXPD", "FLOOR", "FRAC", "LEN", "LN", "LOG", "ROUND",
    "SIN", "SQR", "SQRT", "TRUNC",
];

impl Repair<'_> {
    /// `METHOD … END_METHOD`
    pub(super) fn foreign_part(&mut self, token: RawToken) -> bool {
        if token.kind != RawKind::Word || !token.first_on_line || !self.brackets.is_empty() {
            return false;
        }
        let word = self.slice(token);
        let Some((_, ends, help)) = PARTS.iter().find(|(known, ..)| known.eq_ignore_ascii_case(word)) else {
            return false;
        };
        let named = self.beside(self.at + 1).is_some_and(|next| next.kind == RawKind::Word);
        let is_end = |token: &RawToken| ends.iter().any(|end| end.eq_ignore_ascii_case(self.slice(*token)));
        let Some(end) = self.tokens[self.at..].iter().position(is_end).filter(|_| named) else { return false };
        let (at, end) = (self.at, self.at + end);
        let title = format!("SCL has no {}", word.to_ascii_uppercase());
        self.report(at, at + 2, title, "a form of other languages", (*help).to_owned());
        let after = if self.kind(end + 1) == Some(RawKind::Semicolon) { end + 2 } else { end + 1 };
        self.drop_tokens(at, after);
        self.statement = self.at;
        true
    }

    /// `EXTENDS "Base"`, `IMPLEMENTS Interface` in the head of a block.
    pub(super) fn heritage(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let word = self.slice(token);
        let known = ["EXTENDS", "IMPLEMENTS"].iter().any(|known| known.eq_ignore_ascii_case(word));
        if !known || token.kind != RawKind::Word || token.first_on_line {
            return false;
        }
        let mut after = at + 1;
        while self.beside(after).is_some_and(|next| {
            matches!(next.kind, RawKind::Word | RawKind::Quoted | RawKind::Comma | RawKind::Dot)
                && next.keyword.is_none()
        }) {
            after += 1;
        }
        if after == at + 1 {
            return false;
        }
        let base = self.words(at + 1, after - 1).to_owned();
        let title = format!("a block has no {}", word.to_ascii_uppercase());
        let help = match word.eq_ignore_ascii_case("EXTENDS") {
            true => format!("declare a variable of type {base} in VAR, and call it"),
            false => "remove it: each block is called by its name".to_owned(),
        };
        self.report(at, after, title, "a form of other languages", help);
        self.drop_tokens(at, after);
        true
    }

    /// `THIS^.x`, `self.x`, `CALL FC1();`
    pub(super) fn foreign_prefix(&mut self, token: RawToken) -> bool {
        let at = self.at;
        if token.kind != RawKind::Word || token.keyword.is_some() || self.is_declared(self.slice(token)) {
            return false;
        }
        let word = self.slice(token).to_ascii_uppercase();
        let after_point = self.last.is_some_and(|last| last.kind == RawKind::Dot);
        let component = match (word.as_str(), self.kind(at + 1), self.kind(at + 2)) {
            ("THIS" | "SUPER", Some(RawKind::Caret), Some(RawKind::Dot)) => Some(at + 3),
            ("THIS" | "SELF", Some(RawKind::Dot), Some(RawKind::Word)) if !after_point => Some(at + 2),
            _ => None,
        };
        if let Some(component) = component {
            let name = self.token(component).map_or("name", |next| self.slice(next)).to_owned();
            let title = format!("SCL has no {word}");
            self.report(at, component - 1, title, "a form of other languages", format!("write `#{name}`"));
            self.drop_tokens(at, component);
            return true;
        }
        word == "CALL" && self.starts(token) && self.call_of_stl()
    }

    /// `CALL "Motor", "Motor_DB" (start := a);`, `CALL FC 1;`
    fn call_of_stl(&mut self) -> bool {
        let at = self.at;
        let Some(block) = self.end_of_callee(at + 1) else { return false };
        let (mut first, mut after) = (at + 1, block);
        if self.kind(block) == Some(RawKind::Comma) {
            let Some(instance) = self.end_of_callee(block + 1) else { return false };
            (first, after) = (block + 1, instance);
        }
        let name = |first: usize, after: usize| {
            let text = self.words(first, after - 1);
            if text.starts_with(['"', '#']) { text.to_owned() } else { text.replace([' ', '\t'], "") }
        };
        let mut callee = name(first, after);
        // `FC 1`, `DB 5`
        let numbered = self.kind(after - 1) == Some(RawKind::Number);
        let joined = first > at + 1 && (numbered || address::numbered_block(&callee).is_some());
        if joined {
            callee = format!("{}.{callee}", name(at + 1, block));
        }
        let opens = self.kind(after) == Some(RawKind::LeftParen);
        let ends = self.kind(after) == Some(RawKind::Semicolon) || self.beside(after).is_none();
        if !opens && !ends {
            return false;
        }
        let help = if opens { format!("write `{callee}( … );`") } else { format!("write `{callee}();`") };
        let title = "a block is called by its name alone".to_owned();
        self.report(at, at + 1, title, "CALL is an instruction of STL", help);
        if ends {
            self.replace(at, after, RawKind::Reported, None);
        } else if numbered || joined {
            self.give_up(self.end_of_statement(after));
        } else {
            self.drop_tokens(at, first);
            self.statement = self.at;
        }
        true
    }

    /// Index after the name of a block or an instance at `first`: `"Motor"`, `#motor.inner`, `FC 1`.
    pub(super) fn end_of_callee(&self, first: usize) -> Option<usize> {
        let token = self.beside(first)?;
        let is_name = matches!(token.kind, RawKind::Word | RawKind::Quoted | RawKind::Local);
        if !is_name || token.keyword.is_some() {
            return None;
        }
        let mut after = first + 1;
        if address::block_prefix(self.slice(token)).is_some() && self.kind(after) == Some(RawKind::Number) {
            return Some(after + 1);
        }
        while self.kind(after) == Some(RawKind::Dot) && after + 1 < self.tokens.len() {
            after += 2;
        }
        Some(after)
    }

    /// `END_REPEAT UNTIL x;`
    pub(super) fn late_condition(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let asks = self.head.as_ref().is_some_and(|head| head.wanted == Keyword::EndRepeat);
        if token.keyword != Some(Keyword::EndRepeat) || self.keyword(at + 1) != Some(Keyword::Until) || asks {
            return false;
        }
        let end = self.end_of_statement(at + 2);
        if end == at + 2 {
            return false;
        }
        let condition = self.words(at + 2, end - 1).to_owned();
        let help = format!("write `UNTIL {condition} END_REPEAT;`");
        self.report(at, at + 2, "UNTIL comes before END_REPEAT".to_owned(), "exchanged", help);
        let mut with = self.tokens[at + 1..end].to_vec();
        with.push(token);
        self.edits.push(super::Edit { first: at, after: end, with });
        self.at = end;
        self.note(token);
        true
    }

    /// `#w.3`: bit 3 of a word.
    pub(super) fn bit_after_point(&mut self) -> bool {
        let at = self.at;
        let Some(bit) = self.token(at + 1).filter(|next| next.kind == RawKind::Number && self.adjacent(at)) else {
            return false;
        };
        let Some(mut first) = at.checked_sub(1) else { return false };
        let is_name = |kind| matches!(kind, Some(RawKind::Word | RawKind::Quoted | RawKind::Local));
        if !is_name(self.kind(first)) || !self.adjacent(first) || self.tokens[first].keyword.is_some() {
            return false;
        }
        while first >= 2 && self.kind(first - 1) == Some(RawKind::Dot) && is_name(self.kind(first - 2)) {
            first -= 2;
        }
        let variable = self.words(first, at - 1).to_owned();
        let bit = self.slice(bit);
        let name = variable.trim_start_matches('#');
        let address = format!("%{name}.{bit}");
        let found = address::token(&address, Span::default());
        let is_address = !self.is_declared(name) && matches!(found, Some(OperandKind::Absolute { .. }));
        let (title, label, help) = match self.is_array(name) {
            _ if is_address => ("an address has no `#`", "not a variable of the block", format!("write `{address}`")),
            true => (
                "the index of an array is written in brackets",
                "a form of other languages",
                format!("write `{variable}[{bit}]`"),
            ),
            false => (
                "a bit of a variable has `%X` before its number",
                "neither a component nor a bit",
                format!("write `{variable}.%X{bit}`"),
            ),
        };
        self.report(first, at + 2, title.to_owned(), label, help);
        self.replace(first, at + 2, RawKind::Reported, None);
        true
    }

    /// `IF x THEN BEGIN … END;`, where statements need no brackets.
    pub(super) fn pascal(&mut self, token: RawToken) -> bool {
        let at = self.at;
        if token.keyword == Some(Keyword::Begin) {
            if self.open.is_empty() && (self.data || !self.statements_begun) {
                return false;
            }
            if !self.begins_reported {
                self.begins_reported = true;
                let (title, help) = match self.open.last() {
                    Some(inner) => {
                        let end = closer(inner.keyword).word();
                        (
                            format!("statements up to {end} need no BEGIN"),
                            format!("remove `BEGIN`, and end the statement with `{end};` instead of `END`"),
                        )
                    }
                    None => (
                        "a block has one BEGIN, before its statements".to_owned(),
                        "remove this `BEGIN`, and its `END`".to_owned(),
                    ),
                };
                self.report(at, at + 1, title, "a form of other languages", help);
            }
            self.open.push(Open { keyword: Keyword::Begin, brace: false });
            self.drop_tokens(at, at + 1);
            self.statement = self.at;
            return true;
        }
        if token.keyword.is_some() || token.kind != RawKind::Word || !self.slice(token).eq_ignore_ascii_case("END") {
            return false;
        }
        if self.open.last().is_none_or(|open| open.keyword != Keyword::Begin) {
            return false;
        }
        self.open.pop();
        let semicolon = self.kind(at + 1) == Some(RawKind::Semicolon);
        let after = if semicolon { at + 2 } else { at + 1 };
        let outer = self.open.last().map(|open| closer(open.keyword));
        match (outer, self.keyword(after)) {
            // Its END is also that of the statement.
            (Some(end), next)
                if next != Some(end)
                    && !matches!(next, Some(Keyword::Else | Keyword::Elsif | Keyword::ElseIf | Keyword::Until)) =>
            {
                self.replace(at, at + 1, RawKind::Word, Some(end));
            }
            _ => {
                self.drop_tokens(at, after);
                self.begin_statement();
            }
        }
        true
    }

    /// `LOOP … END_LOOP;`, whose statements are those of a REPEAT without a condition. `EXIT WHEN x;`
    pub(super) fn endless(&mut self, token: RawToken) -> bool {
        let at = self.at;
        if token.kind != RawKind::Word || !self.brackets.is_empty() {
            return false;
        }
        let word = self.slice(token);
        let is = |name: &str| token.keyword.is_none() && word.eq_ignore_ascii_case(name);
        if token.keyword == Some(Keyword::Exit)
            && let Some(next) = self.beside(at + 1)
            && self.slice(next).eq_ignore_ascii_case("WHEN")
        {
            let end = self.end_of_statement((at + 2).min(self.tokens.len()));
            if end <= at + 2 {
                return false;
            }
            let condition = self.words(at + 2, end - 1).to_owned();
            let help = format!("write `IF {condition} THEN EXIT; END_IF;`");
            self.report(at, at + 2, "EXIT has no condition".to_owned(), "a form of other languages", help);
            self.give_up(end);
            return true;
        }
        if is("LOOP") && self.starts(token) && self.beside(at + 1).is_none() && !self.is_declared(word) {
            let ends = |token: &RawToken| self.slice(*token).eq_ignore_ascii_case("END_LOOP");
            if !self.tokens[at..].iter().any(ends) {
                return false;
            }
            let help = "write `WHILE TRUE DO … END_WHILE;`, and leave it with `IF … THEN EXIT; END_IF;`".to_owned();
            self.report(at, at + 1, "SCL has no LOOP".to_owned(), "a form of other languages", help);
            self.loops += 1;
            self.replace(at, at + 1, RawKind::Word, Some(Keyword::Repeat));
            return true;
        }
        if is("END_LOOP") && self.loops > 0 {
            self.loops -= 1;
            let until = RawToken { keyword: Some(Keyword::Until), ..token };
            let condition = RawToken { kind: RawKind::Reported, ..token };
            let end = RawToken { keyword: Some(Keyword::EndRepeat), ..token };
            self.edits.push(super::Edit { first: at, after: at + 1, with: vec![until, condition, end] });
            self.at += 1;
            self.note(end);
            return true;
        }
        false
    }

    /// `a AND THEN b`, `a OR ELSE b`, `AND_THEN`, `OR_ELSE`
    pub(super) fn short_circuit(&mut self, token: RawToken) -> bool {
        let at = self.at;
        if token.kind != RawKind::Word || !self.last.is_some_and(ends_operand) {
            return false;
        }
        let next = self.beside(at + 1).and_then(|next| next.keyword);
        let word = self.slice(token).to_ascii_uppercase();
        // `IF a AND THEN b := TRUE;`: THEN ends the condition.
        let ends_head = || {
            self.head.as_ref().is_some_and(|head| head.wanted == Keyword::Then)
                && self.keyword(self.end_of_statement((at + 2).min(self.tokens.len()))) != Some(Keyword::Then)
        };
        let (count, keyword) = match (token.keyword, next, word.as_str()) {
            (Some(Keyword::And), Some(Keyword::Then), _) if ends_head() => return false,
            (Some(Keyword::And), Some(Keyword::Then), _) => (2, Keyword::And),
            (Some(Keyword::Or), Some(Keyword::Else), _) => (2, Keyword::Or),
            (None, _, "AND_THEN") => (1, Keyword::And),
            (None, _, "OR_ELSE") => (1, Keyword::Or),
            _ => return false,
        };
        let (left, right) = self.sides(at, at + count);
        let sign = keyword.word();
        let written = self.words(at, at + count - 1).to_ascii_uppercase();
        let case = if keyword == Keyword::And { "TRUE" } else { "FALSE" };
        self.report(
            at,
            at + count,
            format!("SCL has no `{written}`"),
            &format!("read as `{sign}`"),
            format!(
                "write `{left} {sign} {right}`; if `{right}` must only be read when `{left}` is {case}, put it into an IF of its own"
            ),
        );
        self.replace(at, at + count, RawKind::Word, Some(keyword));
        true
    }

    /// `SQRT #r`, `INT_TO_REAL x`: a function without brackets.
    pub(super) fn bare_argument(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let word = self.slice(token);
        let known = FUNCTIONS.iter().any(|known| known.eq_ignore_ascii_case(word))
            || word.to_ascii_uppercase().contains("_TO_") && !word.starts_with('_');
        let inside = self.last.is_some_and(|last| last.kind != RawKind::Dot && !ends_operand(last));
        if !known || !inside || token.keyword.is_some() || self.starts(token) || self.is_declared(word) {
            return false;
        }
        // `ABS[#i]`
        let upper = word.to_ascii_uppercase();
        let converts = upper.split_once("_TO_").is_none_or(|(from, _)| Elementary::from_word(from).is_some());
        let close = self.closing(at + 1).filter(|_| converts && self.kind(at + 1) == Some(RawKind::LeftBracket));
        if let Some(close) = close.filter(|close| *close > at + 2) {
            let help = format!("write `{word}({})`", self.words(at + 2, close - 1));
            let title = format!("the argument of `{word}` is written in parentheses");
            self.report(at, close + 1, title, "`[ ]` is for elements of arrays", help);
            self.replace(at, close + 1, RawKind::Reported, None);
            return true;
        }
        // `ABS -5`
        let sign = self.beside(at + 1).is_some_and(|sign| sign.kind == RawKind::Minus && self.adjacent(at + 1));
        let first = if sign && !self.adjacent(at) { at + 2 } else { at + 1 };
        let argument = self.beside(first).filter(|next| begins_operand(*next) && next.keyword.is_none());
        if argument.is_none() {
            return false;
        }
        let after = self.operand_end(first);
        let argument = self.words(at + 1, after - 1).to_owned();
        let title = format!("the argument of `{word}` is written in brackets");
        self.report(at, after, title, "brackets are missing", format!("write `{word}({argument})`"));
        // `ABS #i)`
        let closed = self.brackets.is_empty() && self.kind(after) == Some(RawKind::RightParen);
        self.replace(at, after + usize::from(closed), RawKind::Reported, None);
        true
    }

    /// `#r AS INT`
    pub(super) fn cast(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let word = self.slice(token);
        if !word.eq_ignore_ascii_case("AS") || !self.last.is_some_and(ends_operand) || self.is_declared(word) {
            return false;
        }
        let Some(wanted) = self.beside(at + 1).map(|next| self.slice(next).to_ascii_uppercase()) else { return false };
        if Elementary::from_word(&wanted).is_none() {
            return false;
        }
        let first = self.operand_start(at);
        let value = self.words(first, at - 1).to_owned();
        let declared = if first + 1 == at { self.declared_type(value.trim_start_matches('#')) } else { None };
        let help = match declared {
            Some(own) if own.eq_ignore_ascii_case(&wanted) => {
                format!("remove `{word} {wanted}`: {value} is of this type")
            }
            Some(own) => format!("write `{}_TO_{wanted}({value})`", own.to_ascii_uppercase()),
            None => format!("write `…_TO_{wanted}({value})`, with the type of `{value}` for `…`"),
        };
        let title = format!("a value is converted by a function, not by `{}`", word.to_ascii_uppercase());
        self.report(at, at + 2, title, "a form of other languages", help);
        self.replace(first, at + 2, RawKind::Reported, None);
        true
    }

    /// The elementary type that the last declaration before gives a variable.
    pub(super) fn declared_type(&self, name: &str) -> Option<&str> {
        let at = *self.declared.get(&name.to_uppercase())?;
        let ty = self.slice(self.token(at + 2).filter(|_| self.kind(at + 1) == Some(RawKind::Colon))?);
        Elementary::from_word(&ty.to_ascii_uppercase()).map(|_| ty)
    }

    /// Whether the last declaration of the name is that of an array.
    fn is_array(&self, name: &str) -> bool {
        let declared = self.declared.get(&name.to_uppercase());
        declared
            .is_some_and(|at| self.kind(at + 1) == Some(RawKind::Colon) && self.keyword(at + 2) == Some(Keyword::Array))
    }

    /// Index after the operand that begins at `first`: `a.b[1].c`, `f(x)`.
    pub(super) fn operand_end(&self, first: usize) -> usize {
        let mut after = first + 1;
        loop {
            match self.kind(after) {
                Some(RawKind::Dot) if after + 1 < self.tokens.len() => after += 2,
                Some(RawKind::LeftBracket | RawKind::LeftParen) => {
                    let end = self.end_of_statement(after);
                    let Some(close) = self.closing(after).filter(|close| *close < end) else { return after };
                    after = close + 1;
                }
                _ => return after,
            }
        }
    }

    /// Index of the first token of the operand that ends before `after`.
    pub(super) fn operand_start(&self, after: usize) -> usize {
        let (mut first, mut depth) = (after, 0usize);
        while first > self.statement {
            let token = self.tokens[first - 1];
            match token.kind {
                RawKind::RightBracket | RawKind::RightParen => depth += 1,
                RawKind::LeftBracket | RawKind::LeftParen if depth == 0 => break,
                RawKind::LeftBracket | RawKind::LeftParen => depth -= 1,
                _ if depth > 0 => {}
                RawKind::Dot => {}
                // A name stands alone, after a point, or before what belongs to it.
                _ if ends_operand(token) && (first == after || !ends_operand(self.tokens[first])) => {}
                _ => break,
            }
            first -= 1;
        }
        first.min(after - 1)
    }

    /// `N7:0`, `B3:0/1`, `T4:0.ACC` of a SLC 500 or PLC-5.
    pub(super) fn file_address(&mut self, token: RawToken) -> bool {
        let at = self.at;
        if !matches!(token.kind, RawKind::Word | RawKind::Absolute)
            || self.kind(at + 1) != Some(RawKind::Colon)
            || !matches!(self.kind(at + 2), Some(RawKind::Number | RawKind::Real))
            || !self.adjacent(at)
            || !self.adjacent(at + 1)
        {
            return false;
        }
        let Some(address) = self.text.get(token.start as usize..).and_then(foreign_address::at) else { return false };
        let end = token.start as usize + address.length;
        let count = self.tokens[at..].iter().take_while(|token| (token.start as usize) < end).count();
        let after = at + count;
        self.report(at, after, address.title, "not an address of STEP 7", address.help.to_owned());
        self.replace(at, after, RawKind::Reported, None);
        true
    }

    /// `DB1.DBW0.1`, `MW0.1`: a word with the number of a bit.
    pub(super) fn bit_of_word(&mut self, token: RawToken) -> bool {
        let at = self.at;
        if !matches!(token.kind, RawKind::Word | RawKind::Absolute)
            || self.kind(at + 1) != Some(RawKind::Dot)
            || self.last.is_none_or(|last| last.kind != RawKind::Dot)
            || !self.adjacent(at)
        {
            return false;
        }
        let Some(bit) = self.token(at + 2).filter(|next| next.kind == RawKind::Number && self.adjacent(at + 1)) else {
            return false;
        };
        let Some((width, byte)) = address::db_address(self.slice(token)) else { return false };
        let Some(block) = at.checked_sub(2).and_then(|before| self.token(before)) else { return false };
        let (block, bit) = (self.slice(block).to_owned(), self.slice(bit).to_owned());
        let after = at + 3;
        let name = match width {
            Width::Byte => "a byte",
            Width::Word => "a word",
            Width::Bit | Width::Dword | Width::Lword => "a double word",
        };
        let title = format!("`{}` has the number of a bit, but names {name}", self.words(at - 2, after - 1));
        let help = format!("write `{block}.DBX{byte}.{bit}` for bit {bit} of byte {byte}, or remove `.{bit}`");
        self.report(at, after, title, "only DBX has a bit", help);
        self.replace(at - 2, after, RawKind::Reported, None);
        true
    }
}
