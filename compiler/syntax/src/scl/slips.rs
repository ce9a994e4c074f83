//! Syntax errors of SCL that show what is meant, so that the help can say what to write.

use plcc_diag::{Code, Diagnostic};

use super::messages::{Recovery, State, begins, ends};
use super::token::{Spanned, Tok};
use super::types_meant;
use crate::elementary::Elementary;

impl Recovery {
    /// A form that has only one meaning: an ARRAY without OF, `STRING(20)`, a misspelt STRING, a value of CASE without `:`, a `,`
    /// without a parameter.
    pub(super) fn slip(self, state: &State, index: usize) -> Option<Diagnostic> {
        let at = state.tokens.get(index).filter(|(start, _, end)| start < end)?;
        let before = index.checked_sub(1).and_then(|before| state.tokens.get(before))?;
        let text = |(start, _, end): &Spanned| state.text.get(*start..*end).unwrap_or_default().to_owned();
        let told = |from: usize, to: usize, title: String, label: &str, help: String| {
            let declares = matches!(self, Recovery::Declaration | Recovery::Constant);
            let code = if declares { Code::DeclarationSyntax } else { Code::Syntax };
            Some(Diagnostic::new(code, state.span(from..to), title).label(label).help(help))
        };
        let meant = match self {
            Recovery::Declaration => types_meant::of(state.text, before, at),
            Recovery::CaseValue => types_meant::range_of_case(state.text, before, at),
            _ => None,
        };
        if let Some((title, help)) = meant {
            return told(at.0, at.2, title.to_owned(), "a form of other languages", help);
        }
        match (self, &before.1, &at.1) {
            (Recovery::Declaration, Tok::Literal(_), Tok::RightBracket) => {
                let open = state.text.get(..at.0)?.rfind('[')?;
                let bounds = state.text.get(open + 1..at.0)?;
                if bounds.trim().parse::<u32>().is_ok() {
                    return told(
                        open + 1,
                        at.0,
                        "an array has a lower and an upper bound".to_owned(),
                        "one bound",
                        format!("write `1..{}`, or another range", bounds.trim()),
                    );
                }
                let (low, high) =
                    bounds.get(1..)?.split_once('-').map(|(low, high)| (bounds[..1].to_owned() + low, high))?;
                let is_number = |text: &str| text.trim().trim_start_matches('-').parse::<u32>().is_ok();
                let (low, high) = (low.trim(), high.trim());
                if !is_number(low) || !is_number(high) {
                    return None;
                }
                told(
                    open + 1,
                    at.0,
                    "the bounds of an array are separated by two dots".to_owned(),
                    "a subtraction",
                    format!("write `{low}..{high}`"),
                )
            }
            // `[0].n := 4;` after BEGIN of a data block that is an array.
            (Recovery::Assignment, _, Tok::LeftBracket) => {
                let rest = state.text.get(at.0..).unwrap_or_default();
                let form = rest.split([';', '\n', '\r']).next().unwrap_or_default().trim_end();
                let form = if form.chars().count() > 80 { "[0] := …" } else { form };
                told(
                    at.0,
                    at.2,
                    "an element of this data block has no name".to_owned(),
                    "the elements of a data block that is an array are those of `THIS`",
                    format!("write `THIS{form};`"),
                )
            }
            (Recovery::Declaration, Tok::RightBracket, _) => told(
                at.0,
                at.2,
                "`OF` is missing before the type".to_owned(),
                "the type of the elements",
                format!("write `OF {}`", text(at)),
            ),
            (Recovery::Declaration, Tok::Array, Tok::LeftParen) => {
                let rest = state.text.get(at.2..).unwrap_or_default();
                let bounds = rest.split(')').next().unwrap_or_default().trim();
                told(
                    at.0,
                    at.2,
                    "the bounds of an array are written in brackets".to_owned(),
                    "a form of other languages",
                    format!("write `{}[{bounds}]`", text(before)),
                )
            }
            (Recovery::Declaration, _, Tok::LeftParen) if text(before).eq_ignore_ascii_case("STRING") => {
                let rest = state.text.get(at.2..).unwrap_or_default();
                let length = rest.split(')').next().unwrap_or_default().trim();
                told(
                    at.0,
                    at.2,
                    "the length of a STRING is written in brackets".to_owned(),
                    "a form of other languages",
                    format!("write `{}[{length}]`", text(before)),
                )
            }
            (
                Recovery::Statement,
                Tok::Literal(_),
                Tok::Name(_) | Tok::Local(_) | Tok::Quoted(_) | Tok::Absolute(_),
            ) if index.checked_sub(2).is_none_or(|first| {
                state.tokens.get(first).is_some_and(|(_, token, _)| ends(token) || begins(token))
            }) =>
            {
                let value = text(before);
                told(
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
                let (variable, value) = (text(before), text(at));
                told(
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
                    && text(at).eq_ignore_ascii_case("E")
                    && text(before).starts_with(|c: char| c.is_ascii_digit()) =>
            {
                let number = text(before);
                told(
                    before.0,
                    at.2,
                    format!("the exponent of `{number}{}` has no digits", text(at)),
                    "digits are missing at its end",
                    format!("write `{number}`, or an exponent such as `{number}E3`"),
                )
            }
            // `1 000`
            (
                Recovery::Statement
                | Recovery::Condition
                | Recovery::Argument
                | Recovery::Declaration
                | Recovery::Constant,
                Tok::Literal(_),
                Tok::Literal(_),
            ) if is_digits(&text(before)) && is_digits(&text(at)) && at.0 == before.2 + 1 => {
                let number = state.text.get(before.0..).map(with_blanks).unwrap_or_default();
                told(
                    before.0,
                    before.0 + number.len(),
                    "a number has no blanks".to_owned(),
                    "blanks inside",
                    format!("write `{}`", number.replace(' ', "")),
                )
            }
            // `1.`
            (Recovery::Statement | Recovery::Condition | Recovery::Argument, Tok::Literal(_), Tok::Dot)
                if is_digits(&text(before)) && at.0 == before.2 =>
            {
                told(
                    before.0,
                    at.2,
                    "a decimal number has a digit after its point".to_owned(),
                    "not a number of SCL",
                    format!("write `{}.0`", text(before)),
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
                told(
                    at.0,
                    at.2,
                    "an index is a single number".to_owned(),
                    "a range",
                    format!("write `[{}]` for one element; FILL_BLK sets several, MOVE_BLK copies them", text(before)),
                )
            }
            // `2, 3,: #q := TRUE;` in CASE
            (Recovery::CaseValue, Tok::Comma, _) if text(at) == ":" => told(
                before.0,
                before.2,
                "no value follows `,`".to_owned(),
                "one sign too many",
                "remove `,` before `:`".to_owned(),
            ),
            // `2, 3 #q := TRUE;` in CASE
            (Recovery::CaseValue, Tok::Literal(_), Tok::Comma) => {
                let is_value =
                    |(_, token, _): &&Spanned| matches!(token, Tok::Literal(_) | Tok::Comma | Tok::DotDot | Tok::Minus);
                let rest = state.tokens.get(index..)?;
                let count = rest.iter().take(CASE_VALUES_MAX).take_while(is_value).count();
                let (last, next) = (rest.get(count.checked_sub(1)?)?, rest.get(count)?);
                if !begins_operand(&next.1) || !matches!(last.1, Tok::Literal(_)) {
                    return None;
                }
                let values = state.text.get(before.0..last.2)?;
                told(
                    before.0,
                    last.2,
                    "`:` is missing after the values of CASE".to_owned(),
                    "a statement follows",
                    format!("write `{values}:`"),
                )
            }
            // `#count : Int := 5;`
            (Recovery::Statement, Tok::Local(_), Tok::Colon) if is_type(state, at.2) => {
                let name = text(before);
                let name = name.trim_start_matches('#');
                let rest = state.text.get(at.2..).unwrap_or_default();
                let rest = rest.split([';', '\n', '\r']).next().unwrap_or_default().trim();
                // Temporary data have no start values.
                let (ty, assigned) = match rest.split_once(":=") {
                    Some((ty, value)) => (ty.trim(), format!(", and `#{name} := {};` here", value.trim())),
                    None => (rest, String::new()),
                };
                told(
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
                let value = text(before);
                told(
                    before.0,
                    before.2,
                    format!("`;` is missing after `{value}`"),
                    "the statement ends here",
                    "end each statement with `;`".to_owned(),
                )
            }
            (Recovery::Argument, Tok::Comma, Tok::RightParen | Tok::Comma) => told(
                before.0,
                before.2,
                "no parameter follows `,`".to_owned(),
                "one sign too many",
                format!("remove `,` before `{}`", text(at)),
            ),
            (Recovery::Argument, Tok::LeftParen, Tok::Comma) => told(
                at.0,
                at.2,
                "no parameter comes before `,`".to_owned(),
                "one sign too many",
                "remove `,` after `(`".to_owned(),
            ),
            (Recovery::Statement | Recovery::Condition, Tok::Comma, Tok::RightBracket) => told(
                before.0,
                before.2,
                "no index follows `,`".to_owned(),
                "one sign too many",
                "remove `,` before `]`".to_owned(),
            ),
            // `'Pump_DB'(start := TRUE);`
            (Recovery::Statement, Tok::Literal(_), Tok::LeftParen) if text(before).starts_with('\'') => told(
                before.0,
                before.2,
                "a name is written in double quotes".to_owned(),
                "a text",
                format!("write `\"{}\"(…)`", text(before).trim_matches('\'')),
            ),
            // `a * [b - c]`
            (Recovery::Statement | Recovery::Condition | Recovery::Argument, operator, Tok::LeftBracket)
                if is_operator(operator) || *operator == Tok::Assign =>
            {
                let rest = state.text.get(at.2..)?;
                let inner = rest.split(']').next().filter(|inner| inner.len() < EXPRESSION_MAX);
                told(
                    at.0,
                    at.2,
                    "an expression is grouped by parentheses".to_owned(),
                    "begins the index of an array",
                    format!("write `({})`", inner.unwrap_or("…").trim()),
                )
            }
            // `ARRAY[0,9] OF INT`
            (Recovery::Declaration, Tok::Literal(_), Tok::Comma)
                if index
                    .checked_sub(2)
                    .and_then(|open| state.tokens.get(open))
                    .is_some_and(|(_, token, _)| *token == Tok::LeftBracket) =>
            {
                let high = state.text.get(at.2..)?.split(']').next().unwrap_or_default().trim();
                let low = text(before);
                if !is_digits(high) {
                    return None;
                }
                told(
                    at.0,
                    at.2,
                    "the bounds of an array are separated by two dots".to_owned(),
                    "separates dimensions",
                    format!("write `{low}..{high}`"),
                )
            }
            // `speed := 5 : INT;`
            (Recovery::Declaration, Tok::Name(name), Tok::Assign) => {
                let rest = state.text.get(at.2..)?.split([';', '\n', '\r']).next().unwrap_or_default();
                let (value, ty) = rest.split_once(':').filter(|(_, ty)| !ty.starts_with('='))?;
                told(
                    at.0,
                    at.2,
                    "the type of a variable comes before its value".to_owned(),
                    "a value without a type",
                    format!("write `{name} : {} := {};`", ty.trim(), value.trim()),
                )
            }
            (Recovery::Declaration, Tok::Name(name), Tok::LeftBracket) => {
                let Some(near) = crate::distance::nearest(name, ["STRING", "WSTRING", "ARRAY"].into_iter()) else {
                    let rest = state.text.get(at.2..)?;
                    let bounds = rest.split(']').next().unwrap_or_default().trim();
                    let bounds = match bounds.parse::<u32>() {
                        Ok(_) => format!("1..{bounds}"),
                        Err(_) => bounds.to_owned(),
                    };
                    return told(
                        at.0,
                        at.2,
                        format!("the bounds of an array are after `ARRAY`, not after `{name}`"),
                        "a form of other languages",
                        format!("write `ARRAY[{bounds}] OF {name}`"),
                    );
                };
                told(
                    before.0,
                    before.2,
                    format!("the data type `{name}` is not defined"),
                    "no type with a length or bounds",
                    format!("is `{near}` meant?"),
                )
            }
            (Recovery::Statement | Recovery::Condition | Recovery::Argument, operator, after)
                if is_operator(operator) && (ends(after) || is_closing(after)) =>
            {
                let sign = text(before);
                told(
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
                let sign = text(at);
                told(
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

/// An expression that is longer than this is not shown in a help.
const EXPRESSION_MAX: usize = 80;
/// How many values of CASE are looked at.
const CASE_VALUES_MAX: usize = 40;
/// How many tokens before and after a place are looked at for an assignment.
const ASSIGNMENT_MAX: usize = 20;

/// The groups of digits at the beginning of a text: `1 000 000`.
fn with_blanks(text: &str) -> &str {
    let end = text.char_indices().find(|&(at, c)| {
        let goes_on = c == ' ' && text[at + 1..].starts_with(|next: char| next.is_ascii_digit());
        !c.is_ascii_digit() && !goes_on
    });
    &text[..end.map_or(text.len(), |(at, _)| at)]
}

/// Whether the text is a decimal number without a point.
fn is_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|digit| digit.is_ascii_digit())
}

/// Whether an operand ends with the token.
fn ends_operand(token: &Tok) -> bool {
    begins_operand(token) || matches!(token, Tok::Literal(_) | Tok::RightParen | Tok::RightBracket)
}

/// Whether a variable begins with the token.
fn begins_operand(token: &Tok) -> bool {
    matches!(token, Tok::Name(_) | Tok::Local(_) | Tok::Quoted(_) | Tok::Absolute(_))
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
