//! Whole statements of other languages: `let x = 5`, `do … while (c)`, `try`, `-- text`, `(INT)x`, `f(a b)`, `ELSE:`, `#define`.

use super::{Edit, Repair, begins_operand, ends_operand};
use crate::Elementary;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// Words that declare a variable in other languages, and the type of SCL; none: the type follows from the value.
const DECLARING: [(&str, Option<&str>); 16] = [
    ("LET", None),
    ("AUTO", None),
    ("DIM", None),
    ("VAL", None),
    ("STATIC", None),
    ("FLOAT", Some("REAL")),
    ("DOUBLE", Some("LREAL")),
    ("SINGLE", Some("REAL")),
    ("LONG", Some("DINT")),
    ("SHORT", Some("INT")),
    ("INTEGER", Some("INT")),
    ("BOOLEAN", Some("BOOL")),
    ("UNSIGNED", Some("UINT")),
    ("UINT16_T", Some("UINT")),
    ("INT16_T", Some("INT")),
    ("INT32_T", Some("DINT")),
];

impl Repair<'_> {
    /// A statement of another language that begins with a word.
    pub(super) fn foreign_statement(&mut self, token: RawToken) -> bool {
        token.kind == RawKind::Word
            && (self.statement_list(token)
                || self.declaration_inside(token)
                || self.tested_at_end(token)
                || self.exceptions(token)
                || self.value_after_word(token)
                || self.operator_as_function(token)
                || self.missing_comma(token))
    }

    /// `int y = 3;`, `let y = 3;` among the statements.
    fn declaration_inside(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let word = self.slice(token);
        let upper = word.to_ascii_uppercase();
        let own = Elementary::from_word(&upper).map(|_| upper.as_str());
        let foreign = DECLARING.iter().find(|(known, _)| *known == upper).map(|(_, ty)| *ty);
        if own.is_none() && foreign.is_none()
            || token.keyword.is_some()
            || !self.starts(token)
            || self.is_declared(word)
        {
            return false;
        }
        let Some(name) = self.beside(at + 1).filter(|next| next.kind == RawKind::Word && next.keyword.is_none()) else {
            return false;
        };
        let sign = self.kind(at + 2);
        if !matches!(sign, Some(RawKind::Equal | RawKind::Assign | RawKind::Semicolon)) {
            return false;
        }
        let name = self.slice(name);
        let end = self.end_of_statement(at + 2);
        let value = if sign == Some(RawKind::Semicolon) || end <= at + 3 { "" } else { self.words(at + 3, end - 1) };
        let ty = own.or(foreign.flatten()).unwrap_or(match value.contains('.') {
            true => "REAL",
            false => "INT",
        });
        let assign = if value.is_empty() { String::new() } else { format!("`{name} := {value};`") };
        let help = match (self.is_declared(name), value.is_empty()) {
            (true, true) => format!("remove it: `{name}` is declared"),
            (true, false) => format!("write {assign}"),
            (false, true) => format!("write `{name} : {ty};` in VAR_TEMP"),
            (false, false) => format!("write `{name} : {ty};` in VAR_TEMP, and {assign} here"),
        };
        self.report(at, at + 2, "variables are declared before BEGIN".to_owned(), "a form of other languages", help);
        self.give_up(end);
        true
    }

    /// `DO … WHILE c;`
    fn tested_at_end(&mut self, token: RawToken) -> bool {
        let at = self.at;
        if token.keyword != Some(Keyword::Do) || !self.starts(token) || self.last.is_some_and(ends_operand) {
            return false;
        }
        let leaves = |token: &RawToken| token.keyword.is_some_and(Keyword::ends_block);
        let rest = self.tokens[at..].iter().take_while(|token| !leaves(token)).enumerate();
        let tests = rest.filter(|(_, token)| token.keyword == Some(Keyword::While));
        let Some(test) = tests.last().map(|(test, _)| at + test) else { return false };
        let end = self.end_of_statement(test + 1);
        if self.kind(end) != Some(RawKind::Semicolon) || end == test + 1 {
            return false;
        }
        let condition = self.words(test + 1, end - 1).to_owned();
        let condition = match condition.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')) {
            Some(inner) if !inner.contains(['(', ')']) => inner.trim().to_owned(),
            _ => condition,
        };
        let help = format!("write `REPEAT … UNTIL NOT ({condition}) END_REPEAT;`");
        let title = "a loop that tests at its end is REPEAT".to_owned();
        self.report(at, at + 1, title, "a form of other languages", help);
        self.statement = at;
        self.give_up(end);
        true
    }

    /// `TRY … CATCH … END_TRY;`
    fn exceptions(&mut self, token: RawToken) -> bool {
        let at = self.at;
        if token.keyword.is_some() || !self.starts(token) || !self.slice(token).eq_ignore_ascii_case("TRY") {
            return false;
        }
        let is_end = |token: &RawToken| {
            let word = self.slice(*token).to_ascii_uppercase();
            matches!(word.as_str(), "END_TRY" | "ENDTRY" | "__ENDTRY")
        };
        let leaves = |token: &RawToken| token.keyword.is_some_and(Keyword::ends_block);
        let mut rest = self.tokens[at..].iter().take_while(|token| !leaves(token));
        let Some(end) = rest.position(is_end).map(|end| at + end) else { return false };
        let help = "read `ENO` after a statement that may fail, or call GET_ERR_ID".to_owned();
        self.report(at, at + 1, "SCL has no TRY".to_owned(), "a form of other languages", help);
        self.statement = at;
        self.give_up(end + 1);
        true
    }

    /// `MOD(a, 3)`, `AND(a, b)`: operators that stand between their operands.
    fn operator_as_function(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let operators = [Keyword::Mod, Keyword::Div, Keyword::And, Keyword::Or, Keyword::Xor];
        let Some(keyword) = token.keyword.filter(|keyword| operators.contains(keyword)) else { return false };
        if self.last.is_some_and(ends_operand) || self.kind(at + 1) != Some(RawKind::LeftParen) {
            return false;
        }
        let end = self.end_of_statement(at);
        let Some(close) = self.closing(at + 1).filter(|close| *close < end && *close > at + 2) else { return false };
        let mut depth = 0usize;
        let mut parts = vec![at + 2];
        for index in at + 2..close {
            match self.kind(index) {
                Some(RawKind::LeftParen | RawKind::LeftBracket) => depth += 1,
                Some(RawKind::RightParen | RawKind::RightBracket) => depth = depth.saturating_sub(1),
                Some(RawKind::Comma) if depth == 0 => parts.push(index + 1),
                _ => {}
            }
        }
        if parts.len() < 2 {
            return false;
        }
        let ends = parts.iter().skip(1).map(|first| first - 2).chain([close - 1]);
        let operands: Vec<&str> = parts.iter().zip(ends).map(|(first, last)| self.words(*first, last)).collect();
        let word = keyword.word();
        let help = format!("write `{}`", operands.join(&format!(" {word} ")));
        self.report(
            at,
            close + 1,
            format!("{word} is written between its operands"),
            "a form of other languages",
            help,
        );
        self.replace(at, close + 1, RawKind::Reported, None);
        true
    }

    /// `timer(IN := a PT := T#5s)`
    fn missing_comma(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let is_formal = matches!(self.kind(at + 1), Some(RawKind::Assign | RawKind::Arrow));
        if self.brackets.last() != Some(&true) || !is_formal || !self.last.is_some_and(ends_operand) {
            return false;
        }
        let (before, after) = (self.words(at - 1, at - 1).to_owned(), self.words(at, at + 1).to_owned());
        let title = "the parameters of a call are separated by `,`".to_owned();
        self.report(at, at + 1, title, "another parameter begins here", format!("write `{before}, {after} …`"));
        let comma = RawToken { kind: RawKind::Comma, keyword: None, end: token.start, ..token };
        self.edits.push(Edit { first: at, after: at, with: vec![comma] });
        self.last = Some(comma);
        self.pass(token);
        true
    }

    /// `-- text` at the beginning of a statement.
    pub(super) fn comment_with_minus(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let twice = self.token(at + 1).is_some_and(|next| next.kind == token.kind) && self.adjacent(at);
        let begins = self.brackets.is_empty() && self.head.is_none() && at == self.statement;
        if token.kind != RawKind::Minus || !twice || !begins {
            return false;
        }
        let mut after = at + 2;
        while self.beside(after).is_some() {
            after += 1;
        }
        let text = self.words(at, after - 1).trim_start_matches('-').trim().to_owned();
        let help = format!("write `// {text}`");
        self.report(at, at + 2, "a comment begins with `//`".to_owned(), "read as a comment", help);
        self.drop_tokens(at, after);
        self.statement = self.at;
        true
    }

    /// `$FF`
    pub(super) fn dollar_number(&mut self) -> bool {
        let at = self.at;
        let mut after = at + 1;
        while self.kind(after).is_some_and(|kind| matches!(kind, RawKind::Word | RawKind::Number | RawKind::Absolute))
            && self.adjacent(after - 1)
        {
            after += 1;
        }
        let digits = self.words(at, after - 1).trim_start_matches('$').to_ascii_uppercase();
        if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            return false;
        }
        let title = "a hexadecimal number begins with `16#`".to_owned();
        self.report(at, after, title, "not a number of SCL", format!("write `16#{digits}`"));
        self.replace(at, after, RawKind::Reported, None);
        true
    }

    /// `‘text’`, `“text”`, `` `text` ``
    pub(super) fn curved_quotes(&mut self, token: RawToken) -> bool {
        const QUOTES: [char; 8] = ['‘', '’', '‚', '“', '”', '„', '`', '´'];
        let at = self.at;
        let closing = match self.slice(token) {
            "‘" | "’" | "‚" => ["’", "‘"],
            "“" | "”" | "„" => ["”", "“"],
            "`" | "´" => ["`", "´"],
            _ => return false,
        };
        let line = (at + 1..self.tokens.len()).take_while(|index| self.beside(*index).is_some());
        let close = line.into_iter().find(|index| closing.contains(&self.slice(self.tokens[*index])));
        let Some(close) = close else { return false };
        let inner = self.words(at, close);
        let inner = inner.trim_matches(QUOTES);
        let help = format!("write `'{inner}'`");
        self.report(at, close + 1, "a text is written in straight quotes".to_owned(), "read as a text", help);
        self.replace(at, close + 1, RawKind::Reported, None);
        true
    }

    /// `x => 3;` for an assignment, `a => b` for a comparison.
    pub(super) fn arrow(&mut self) -> bool {
        let at = self.at;
        let formal = self.brackets.last() == Some(&true)
            && at >= 2
            && matches!(self.kind(at - 2), Some(RawKind::LeftParen | RawKind::Comma));
        if formal || !self.last.is_some_and(ends_operand) || self.brackets.last() == Some(&true) {
            return false;
        }
        if self.is_assigned() || self.head.is_some() {
            return self.operator(1, RawKind::GreaterEqual, None, ">=", "greater or equal is `>=`");
        }
        self.assignment(1)
    }

    /// `x <- 3;`
    pub(super) fn back_arrow(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let sign = token.kind == RawKind::Less && self.kind(at + 1) == Some(RawKind::Minus) && self.adjacent(at);
        let inside = |this: &Self| this.head.is_some() || !this.brackets.is_empty() || this.is_assigned();
        sign && !inside(self) && self.last.is_some_and(ends_operand) && self.assignment(2)
    }

    /// Whether `:=` is before the current token in its statement; of a long statement only the last tokens are looked at.
    pub(super) fn is_assigned(&self) -> bool {
        const LOOK_MAX: usize = 100;
        let first = self.statement.max(self.at.saturating_sub(LOOK_MAX));
        (first..self.at).any(|index| self.kind(index) == Some(RawKind::Assign))
    }

    pub(super) fn assignment(&mut self, count: usize) -> bool {
        let at = self.at;
        let end = self.end_of_statement(at + count);
        let left = self.words(self.operand_start(at), at - 1);
        let right = if end > at + count { self.words(at + count, end - 1) } else { "…" };
        let help = format!("write `{left} := {right};`");
        self.report(at, at + count, "a value is assigned with `:=`".to_owned(), "read as `:=`", help);
        self.replace(at, at + count, RawKind::Assign, None);
        true
    }

    /// `(INT)x`
    pub(super) fn type_in_brackets(&mut self) -> bool {
        let at = self.at;
        let Some(named) = self.token(at + 1).filter(|next| next.kind == RawKind::Word) else { return false };
        let word = self.slice(named);
        let wanted = word.to_ascii_uppercase();
        if self.last.is_some_and(ends_operand)
            || self.kind(at + 2) != Some(RawKind::RightParen)
            || Elementary::from_word(&wanted).is_none()
            || self.is_declared(word)
            || !self.beside(at + 3).is_some_and(begins_operand)
        {
            return false;
        }
        let after = self.operand_end(at + 3);
        let value = self.words(at + 3, after - 1).to_owned();
        let declared = if after == at + 4 { self.declared_type(value.trim_start_matches('#')) } else { None };
        let help = match declared {
            Some(own) if own.eq_ignore_ascii_case(&wanted) => format!("remove `({word})`: {value} is of this type"),
            Some(own) => format!("write `{}_TO_{wanted}({value})`", own.to_ascii_uppercase()),
            None => format!("write `…_TO_{wanted}({value})`, with the type of `{value}` for `…`"),
        };
        let title = format!("a value is converted by a function, not by `({word})`");
        self.report(at, at + 3, title, "a form of other languages", help);
        self.replace(at, after, RawKind::Reported, None);
        true
    }

    /// `x := a // 2;`, where the rest of the line is a comment. Called at the first token after it.
    pub(super) fn commented_divisor(&mut self, token: RawToken) -> bool {
        let Some(last) = self.last.filter(|last| token.first_on_line && ends_operand(*last)) else { return false };
        let between = self.text.get(last.end as usize..token.start as usize).unwrap_or_default();
        let line = between.split('\n').next().unwrap_or_default();
        let Some(divisor) = line.trim_start().strip_prefix("//").and_then(|rest| rest.trim().strip_suffix(';')) else {
            return false;
        };
        let divisor = divisor.trim();
        let is_operand = |c: char| c.is_alphanumeric() || matches!(c, '#' | '"' | '_' | '.' | '[' | ']' | '%');
        let assigned = self.is_assigned();
        if divisor.is_empty() || !divisor.chars().all(is_operand) || !assigned || !self.brackets.is_empty() {
            return false;
        }
        let at = self.at;
        let left = self.words(self.operand_start(at), at - 1).to_owned();
        let title = "`//` begins a comment, it does not divide".to_owned();
        let help = format!("write `{left} DIV {divisor};` for a whole number, `{left} / {divisor};` for a fraction");
        self.report(at - 1, at, title, "the rest of the line is a comment", help);
        let semicolon =
            RawToken { kind: RawKind::Semicolon, keyword: None, start: last.end, end: last.end, first_on_line: false };
        self.edits.push(Edit { first: at, after: at, with: vec![semicolon] });
        self.note(semicolon);
        false
    }

    /// `#define MAX 10`, `#include "io.h"`, `import math`
    pub(super) fn line_of_others(&mut self, token: RawToken) -> bool {
        const TOGETHER: &str = "remove it: all sources that are named together are one program";
        let at = self.at;
        if !token.first_on_line || !self.brackets.is_empty() || self.head.is_some() || token.keyword.is_some() {
            return false;
        }
        let word = self.slice(token);
        let after = (at + 1..self.tokens.len()).find(|index| self.tokens[*index].first_on_line);
        let after = after.unwrap_or(self.tokens.len());
        let next = self.beside(at + 1).filter(|next| next.keyword.is_none()).map(|next| next.kind);
        let (title, help) = match (word.to_ascii_lowercase().as_str(), next) {
            ("#define", Some(RawKind::Word)) => {
                let value = if after > at + 2 { self.words(at + 2, after - 1) } else { "…" };
                let ty = match (value.parse::<i16>(), value.parse::<i32>(), value.parse::<f64>()) {
                    (Ok(_), ..) => "Int",
                    (_, Ok(_), _) => "DInt",
                    (.., Ok(_)) => "Real",
                    _ => "…",
                };
                let name = self.words(at + 1, at + 1);
                let help = format!("declare a constant in the block: `VAR CONSTANT {name} : {ty} := {value}; END_VAR`");
                ("SCL has no preprocessor", help)
            }
            ("#include", Some(RawKind::Quoted | RawKind::Less)) => ("SCL has no preprocessor", TOGETHER.to_owned()),
            ("import" | "from", Some(RawKind::Word)) if !self.is_declared(word) => {
                ("SCL has no imports", TOGETHER.to_owned())
            }
            _ => return false,
        };
        self.report(at, after, title.to_owned(), "a form of other languages", help);
        self.drop_tokens(at, after);
        self.statement = self.at;
        true
    }

    /// `ELSE:`, `THEN:`, `DO:`, as in Python. After ELSE of CASE it is allowed.
    pub(super) fn colon_after_word(&mut self) -> bool {
        let at = self.at;
        let Some(word) = self.last.and_then(|last| last.keyword) else { return false };
        let inside = self.open.last().map(|open| open.keyword);
        let is_refused = match word {
            Keyword::Then | Keyword::Do | Keyword::Repeat => inside.is_some(),
            Keyword::Else => inside == Some(Keyword::If),
            Keyword::Of => inside == Some(Keyword::Case),
            _ => false,
        };
        if !is_refused {
            return false;
        }
        let word = word.word();
        let title = format!("no `:` follows {word}");
        self.report(at, at + 1, title, "a form of other languages", format!("write `{word}` without it"));
        self.drop_tokens(at, at + 1);
        self.statement = self.at;
        true
    }
}
