//! Syntax errors in terms that users know, and what else the actions of the grammar share.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic};

use super::lexer::BLANKS;
use super::token::{Spanned, Tok};
use plcc_syntax::front::{Comment, CommentForm, ParseState, Place};
use plcc_syntax::scl::ast::{Name, NameForm};

/// State of a parse of a chart.
pub type State<'a> = ParseState<'a, Tok<'a>>;

/// Where a syntax error was recovered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recovery {
    Permanent,
    Action,
    Parameter,
    Steps,
    Condition,
}

impl Place<Tok<'_>, ()> for Recovery {
    fn message(self, state: &State, found: usize) -> Diagnostic {
        let (code, what, help) = match self {
            Recovery::Permanent => (
                Code::Syntax,
                "permanent instruction",
                "write `operand (=) := condition`, `operand (S) := condition` or `CALL FC1 ()`",
            ),
            Recovery::Action => (
                Code::ActionText,
                "action",
                "an action is `operand (N)`, `operand := value (N)`, `operand := T#5S (D)` or `CALL FC1 () (N)`",
            ),
            Recovery::Parameter => {
                (Code::Syntax, "parameter", "write `name := value` for inputs and outputs, separated by `,`")
            }
            Recovery::Steps => {
                (Code::Syntax, "list of steps", "write the name of a step, or several as `(Fill, Heat)`")
            }
            Recovery::Condition => (
                Code::Syntax,
                "condition",
                "a condition is built of operands, AND, OR, XOR, NOT, comparisons and brackets",
            ),
        };
        let index = state.index_of(found);
        let wide = |token: &&Spanned| token.0 < token.2;
        let range = |(start, _, end): &Spanned| *start..*end;
        let before = state.tokens[..index].iter().rev().find(wide);
        let here = state.tokens.get(index).filter(wide);
        let first = before.filter(|(_, tok, _)| follows(tok));
        if let Some(told) = self.slip(state, here) {
            return told;
        }
        let meant = match (self, first.map(range), here.map(range)) {
            (Recovery::Condition, Some(before), Some(here)) => between_operands(state.text, before, here),
            _ => None,
        };
        let message = state.misplaced(code, what, here.map(range), first.map(range), before.map_or(0..0, range));
        message.help(meant.unwrap_or_else(|| help.to_owned()))
    }
}

impl Recovery {
    /// A form with only one meaning: a condition without `CONDITION :=`, `=>` for `>=`.
    fn slip(self, state: &State, here: Option<&Spanned>) -> Option<Diagnostic> {
        let (start, _, end) = here?;
        let line_start = state.text[..*start].rfind('\n').map_or(0, |at| at + 1);
        let line_end = state.text[*start..].find(['\n', '\r']).map_or(state.text.len(), |length| start + length);
        let line = state.text[*start..line_end].trim();
        let text = &state.text[*start..*end];
        match self {
            Recovery::Steps if state.text[line_start..*start].trim().is_empty() && !line.is_empty() => Some(
                Diagnostic::new(Code::Syntax, state.span(*start..*end), "a condition begins with `CONDITION :=`")
                    .label("neither a step nor a clause of the transition")
                    .help(format!("write `CONDITION := {line}`")),
            ),
            Recovery::Condition if text == "=>" || text == "=<" => {
                let meant = if text == "=>" { ">=" } else { "<=" };
                let words = if text == "=>" { "greater or equal" } else { "less or equal" };
                Some(
                    Diagnostic::new(Code::ForeignForm, state.span(*start..*end), format!("{words} is `{meant}`"))
                        .label("a form of other languages")
                        .help(format!("write `{meant}` for `{text}`")),
                )
            }
            _ => None,
        }
    }
}

/// What is meant by two operands without an operator between them, by `> =`, `1 < #n < 5`, `#n > 1 AND < 5` and `IF #a`.
fn between_operands(text: &str, before: Range<usize>, here: Range<usize>) -> Option<String> {
    let is_one_line = !text[before.end..here.start].contains(['\n', '\r']);
    let (first, second) = (&text[before.clone()], &text[here]);
    if matches!((first, second), (">" | "<", "=") | ("<", ">")) {
        return Some(format!("write `{first}{second}` without a blank"));
    }
    if matches!((first, second), ("=", ">" | "<")) {
        return Some(format!("write `{second}=`"));
    }
    let is_operand = |text: &str| text.starts_with(|c: char| c.is_alphanumeric() || matches!(c, '#' | '"' | '%' | '_'));
    let is_one_of = |text: &str, words: &[&str]| words.iter().any(|word| word.eq_ignore_ascii_case(text));
    if is_one_of(first, &["IF", "WHEN"]) || is_one_of(second, &["THEN"]) {
        return Some("write the condition alone, without `IF` and `THEN`".to_owned());
    }
    let compares = |text: &str| matches!(text, "<" | ">" | "<=" | ">=" | "=" | "==" | "<>");
    if compares(second) && is_one_of(first, &["AND", "OR", "XOR", "&"]) {
        return Some(format!("write the value again before `{second}`: a comparison has two sides"));
    }
    if compares(second) && is_operand(first) {
        return Some(format!("write `AND {first}` before `{second}`: a comparison has two sides"));
    }
    if !is_one_line || !is_operand(first) || !is_operand(second) {
        return None;
    }
    // `Heat.X` is several tokens.
    let start = text[..before.start].rfind(|c: char| c.is_whitespace() || c == '(').map_or(0, |at| at + 1);
    let is_member = text[..before.start].ends_with('.') && text.is_char_boundary(start);
    let first = if is_member { &text[start..before.end] } else { first };
    Some(format!("write `{first} AND {second}`, or `{first} OR {second}`"))
}

/// A name; blanks in an address such as `MW 10` are not part of it.
pub fn name(state: &State, text: &str, form: NameForm, range: Range<usize>) -> Name {
    let text = if form == NameForm::Bare { text.replace(BLANKS, "") } else { text.to_owned() };
    Name { text, form, span: state.span(range) }
}

/// The comment of either form after byte `end`, if there are only blanks and `;` between. The lines of the comment are joined.
pub fn comment_after(text: &str, comments: &[Comment], end: usize) -> Option<String> {
    let comment = comments.get(comments.partition_point(|comment| (comment.start as usize) < end))?;
    let between = &text[end..comment.start as usize];
    let inside = &text[comment.start as usize + 2..comment.end as usize];
    if !between.bytes().all(|byte| matches!(byte, b' ' | b'\t' | b';')) || inside.starts_with('@') {
        return None;
    }
    let inside = match comment.form {
        CommentForm::Line => inside,
        CommentForm::Block => inside.strip_suffix("*)").unwrap_or(inside),
        CommentForm::Slash | CommentForm::Unterminated => return None,
    };
    let words: Vec<&str> = inside.split_whitespace().collect();
    (!words.is_empty()).then(|| words.join(" "))
}

/// Whether the text after the token belongs to the same row.
fn follows(tok: &Tok) -> bool {
    !matches!(
        tok,
        Tok::Settings(_)
            | Tok::Comment(_)
            | Tok::Permanents(_)
            | Tok::Step(_)
            | Tok::Interlock
            | Tok::Supervision
            | Tok::Number(_)
            | Tok::End
            | Tok::Qualifier(_)
            | Tok::From
            | Tok::To
            | Tok::Condition
    )
}
