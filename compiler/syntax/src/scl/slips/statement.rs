//! Slips in statements, their expressions and arguments: signs that are missing or one too many.

use plcc_diag::Diagnostic;

use super::{EXPRESSION_MAX, Slip, begins_operand, is_digits};
use crate::elementary::Elementary;
use crate::scl::messages::{Recovery, State, begins, ends};
use crate::scl::token::Tok;

/// How many tokens before and after a place are looked at for an assignment.
const ASSIGNMENT_MAX: usize = 20;

impl Slip<'_, '_> {
    /// What is meant by a statement, a condition or an argument.
    pub(super) fn in_statement(self) -> Option<Diagnostic> {
        let Slip { state, index, before, at, .. } = self;
        match (self.recovery, &before.1, &at.1) {
            (
                Recovery::Statement,
                Tok::Literal(_),
                Tok::Name(_) | Tok::Local(_) | Tok::Quoted(_) | Tok::Absolute(_),
            ) if index.checked_sub(2).is_none_or(|first| {
                state.tokens.get(first).is_some_and(|(_, token, _)| ends(token) || begins(token))
            }) =>
            {
                let value = self.text(before);
                self.told(
                    before.0,
                    before.2,
                    format!("`{value}` cannot begin a statement"),
                    "a constant",
                    format!("as a value of CASE write `{value}:` before the statement"),
                )
            }
            // `#n 5;`
            (Recovery::Statement, Tok::Local(_) | Tok::Quoted(_), Tok::Literal(_))
                if index.checked_sub(2).is_none_or(|first| {
                    state.tokens.get(first).is_some_and(|(_, token, _)| ends(token) || begins(token))
                }) =>
            {
                let (variable, value) = (self.text(before), self.text(at));
                self.told(
                    before.0,
                    at.2,
                    format!("`:=` is missing after `{variable}`"),
                    "a variable and a value",
                    format!("write `{variable} := {value}`"),
                )
            }
            // `1.0E`
            (Recovery::Statement | Recovery::Condition | Recovery::Argument, Tok::Literal(_), Tok::Name(_))
                if at.0 == before.2
                    && self.text(at).eq_ignore_ascii_case("E")
                    && self.text(before).starts_with(|c: char| c.is_ascii_digit()) =>
            {
                let number = self.text(before);
                self.told(
                    before.0,
                    at.2,
                    format!("the exponent of `{number}{}` has no digits", self.text(at)),
                    "digits are missing at its end",
                    format!("write `{number}`, or an exponent such as `{number}E3`"),
                )
            }
            (_, Tok::Literal(_), Tok::Literal(_)) => self.in_number(),
            // `1.`
            (Recovery::Statement | Recovery::Condition | Recovery::Argument, Tok::Literal(_), Tok::Dot)
                if is_digits(&self.text(before)) && at.0 == before.2 =>
            {
                self.told(
                    before.0,
                    at.2,
                    "a decimal number has a digit after its point".to_owned(),
                    "not a number of SCL",
                    format!("write `{}.0`", self.text(before)),
                )
            }
            // `values[0..3]`
            (
                Recovery::Statement | Recovery::Condition,
                Tok::Literal(_) | Tok::Local(_) | Tok::Name(_),
                Tok::DotDot,
            ) if index
                .checked_sub(2)
                .and_then(|first| state.tokens.get(first))
                .is_some_and(|(_, token, _)| matches!(token, Tok::LeftBracket | Tok::Comma)) =>
            {
                self.told(
                    at.0,
                    at.2,
                    "an index is a single number".to_owned(),
                    "a range",
                    format!(
                        "write `[{}]` for one element; FILL_BLK sets several, MOVE_BLK copies them",
                        self.text(before)
                    ),
                )
            }
            // `#count : Int := 5;`
            (Recovery::Statement, Tok::Local(_), Tok::Colon) if is_type(state, at.2) => {
                let name = self.text(before);
                let name = name.trim_start_matches('#');
                let rest = state.text.get(at.2..).unwrap_or_default();
                let rest = rest.split([';', '\n', '\r']).next().unwrap_or_default().trim();
                // Temporary data have no start values.
                let (ty, assigned) = match rest.split_once(":=") {
                    Some((ty, value)) => (ty.trim(), format!(", and `#{name} := {};` here", value.trim())),
                    None => (rest, String::new()),
                };
                self.told(
                    at.0,
                    at.2,
                    "a variable is declared before the statements".to_owned(),
                    "a declaration",
                    format!("write `{name} : {ty};` in a section such as `VAR_TEMP … END_VAR`, before BEGIN{assigned}"),
                )
            }
            // `a := 1 b := 2;`
            (Recovery::Statement, ended, next)
                if ends_operand(ended) && begins_operand(next) && assigns(state, index) && assigned(state, index) =>
            {
                let value = self.text(before);
                self.told(
                    before.0,
                    before.2,
                    format!("`;` is missing after `{value}`"),
                    "the statement ends here",
                    "end each statement with `;`".to_owned(),
                )
            }
            (Recovery::Argument, Tok::Comma, Tok::RightParen | Tok::Comma) => self.told(
                before.0,
                before.2,
                "no parameter follows `,`".to_owned(),
                "one sign too many",
                format!("remove `,` before `{}`", self.text(at)),
            ),
            (Recovery::Argument, Tok::LeftParen, Tok::Comma) => self.told(
                at.0,
                at.2,
                "no parameter comes before `,`".to_owned(),
                "one sign too many",
                "remove `,` after `(`".to_owned(),
            ),
            (Recovery::Statement | Recovery::Condition, Tok::Comma, Tok::RightBracket) => self.told(
                before.0,
                before.2,
                "no index follows `,`".to_owned(),
                "one sign too many",
                "remove `,` before `]`".to_owned(),
            ),
            // `'Pump_DB'(start := TRUE);`
            (Recovery::Statement, Tok::Literal(_), Tok::LeftParen) if self.text(before).starts_with('\'') => self.told(
                before.0,
                before.2,
                "a name is written in double quotes".to_owned(),
                "a text",
                format!("write `\"{}\"(…)`", self.text(before).trim_matches('\'')),
            ),
            // `a * [b - c]`
            (Recovery::Statement | Recovery::Condition | Recovery::Argument, operator, Tok::LeftBracket)
                if is_operator(operator) || *operator == Tok::Assign =>
            {
                let rest = state.text.get(at.2..)?;
                let inner = rest.split(']').next().filter(|inner| inner.len() < EXPRESSION_MAX);
                self.told(
                    at.0,
                    at.2,
                    "an expression is grouped by parentheses".to_owned(),
                    "begins the index of an array",
                    format!("write `({})`", inner.unwrap_or("…").trim()),
                )
            }
            (Recovery::Statement | Recovery::Condition | Recovery::Argument, operator, after)
                if is_operator(operator) && (ends(after) || is_closing(after)) =>
            {
                let sign = self.text(before);
                self.told(
                    before.0,
                    before.2,
                    format!("`{sign}` has no right side"),
                    "an operand is missing after this",
                    format!("write a variable or a constant after `{sign}`, or remove it"),
                )
            }
            (
                Recovery::Statement | Recovery::Condition | Recovery::Argument,
                Tok::Assign | Tok::LeftParen,
                operator,
            ) if is_operator(operator) => {
                let sign = self.text(at);
                self.told(
                    at.0,
                    at.2,
                    format!("`{sign}` has no left side"),
                    "an operand is missing before this",
                    format!("write a variable or a constant before `{sign}`, or remove it"),
                )
            }
            _ => None,
        }
    }
}

/// Whether an operand ends with the token.
fn ends_operand(token: &Tok) -> bool {
    begins_operand(token) || matches!(token, Tok::Literal(_) | Tok::RightParen | Tok::RightBracket)
}

/// Whether the variable at `index` is followed by `:=`, after its components and indexes.
fn assigns(state: &State, index: usize) -> bool {
    let rest = state.tokens.get(index + 1..).unwrap_or_default();
    let is_part = |token: &Tok| {
        begins_operand(token) || matches!(token, Tok::Dot | Tok::LeftBracket | Tok::RightBracket | Tok::Literal(_))
    };
    let next = rest.iter().take(ASSIGNMENT_MAX).find(|(_, token, _)| !is_part(token));
    next.is_some_and(|(_, token, _)| matches!(token, Tok::Assign | Tok::Combine(_)))
}

/// Whether the statement assigns something before `index`.
fn assigned(state: &State, index: usize) -> bool {
    let before = state.tokens.get(..index).unwrap_or_default();
    let statement = before.iter().rev().take(ASSIGNMENT_MAX).take_while(|(_, token, _)| !ends(token) && !begins(token));
    statement.into_iter().any(|(_, token, _)| matches!(token, Tok::Assign | Tok::Combine(_)))
}

/// Whether the token combines or compares values.
fn is_operator(token: &Tok) -> bool {
    matches!(
        token,
        Tok::Or
            | Tok::Xor
            | Tok::And
            | Tok::Not
            | Tok::Equality(_)
            | Tok::Relation(_)
            | Tok::Plus
            | Tok::Minus
            | Tok::Star
            | Tok::Factor(_)
            | Tok::Power
    )
}

/// Whether a part in brackets, or one of several, ends before the token.
fn is_closing(token: &Tok) -> bool {
    matches!(token, Tok::RightParen | Tok::RightBracket | Tok::Comma)
}

/// Whether the text from byte `at` on begins with a data type.
fn is_type(state: &State, at: usize) -> bool {
    let rest = state.text.get(at..).unwrap_or_default().trim_start_matches(' ');
    let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
    let word = rest[..end].to_ascii_uppercase();
    Elementary::from_word(&word).is_some() || matches!(word.as_str(), "STRING" | "WSTRING" | "ARRAY" | "STRUCT" | "DTL")
}
