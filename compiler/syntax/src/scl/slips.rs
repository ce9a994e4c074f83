//! Syntax errors of SCL that show what is meant, so that the help can say what to write.

mod declaration;
mod statement;

use plcc_diag::{Code, Diagnostic};

use super::messages::{Recovery, State};
use super::token::{Spanned, Tok};
use super::types_meant;

impl Recovery {
    /// A form that has only one meaning: an ARRAY without OF, `STRING(20)`, a misspelt STRING, a value of CASE without `:`, a `,`
    /// without a parameter.
    pub(super) fn slip(self, state: &State, index: usize) -> Option<Diagnostic> {
        let at = state.tokens.get(index).filter(|(start, _, end)| start < end)?;
        let before = index.checked_sub(1).and_then(|before| state.tokens.get(before))?;
        let slip = Slip { recovery: self, state, index, before, at };
        let meant = match self {
            Recovery::Declaration => types_meant::of(state.text, before, at),
            Recovery::CaseValue => types_meant::range_of_case(state.text, before, at),
            _ => None,
        };
        if let Some((title, help)) = meant {
            return slip.told(at.0, at.2, title.to_owned(), "a form of other languages", help);
        }
        match self {
            Recovery::Declaration => slip.in_declaration(),
            Recovery::Constant => slip.in_number(),
            Recovery::Assignment => slip.in_assignment(),
            Recovery::CaseValue => slip.in_case_value(),
            Recovery::Statement | Recovery::Condition | Recovery::Argument => slip.in_statement(),
            Recovery::Block | Recovery::Labels | Recovery::For => None,
        }
    }
}

/// Two tokens that cannot follow each other, and where that was found.
#[derive(Clone, Copy)]
struct Slip<'s, 't> {
    recovery: Recovery,
    state: &'s State<'t>,
    /// Of `at`.
    index: usize,
    before: &'s Spanned<'t>,
    at: &'s Spanned<'t>,
}

impl Slip<'_, '_> {
    fn text(self, (start, _, end): &Spanned) -> String {
        self.state.text.get(*start..*end).unwrap_or_default().to_owned()
    }

    /// The message about the bytes from `from` up to `to`.
    fn told(self, from: usize, to: usize, title: String, label: &str, help: String) -> Option<Diagnostic> {
        let declares = matches!(self.recovery, Recovery::Declaration | Recovery::Constant);
        let code = if declares { Code::DeclarationSyntax } else { Code::Syntax };
        Some(Diagnostic::new(code, self.state.span(from..to), title).label(label).help(help))
    }

    /// A number with blanks, `1 000`.
    fn in_number(self) -> Option<Diagnostic> {
        let Slip { state, before, at, .. } = self;
        let are_literals = matches!((&before.1, &at.1), (Tok::Literal(_), Tok::Literal(_)));
        if !(are_literals && is_digits(&self.text(before)) && is_digits(&self.text(at)) && at.0 == before.2 + 1) {
            return None;
        }
        let number = state.text.get(before.0..).map(with_blanks).unwrap_or_default();
        self.told(
            before.0,
            before.0 + number.len(),
            "a number has no blanks".to_owned(),
            "blanks inside",
            format!("write `{}`", number.replace(' ', "")),
        )
    }

    /// `[0].n := 4;` after BEGIN of a data block that is an array.
    fn in_assignment(self) -> Option<Diagnostic> {
        let Slip { state, at, .. } = self;
        if !matches!(at.1, Tok::LeftBracket) {
            return None;
        }
        let rest = state.text.get(at.0..).unwrap_or_default();
        let form = rest.split([';', '\n', '\r']).next().unwrap_or_default().trim_end();
        let form = if form.chars().count() > EXPRESSION_MAX { "[0] := …" } else { form };
        self.told(
            at.0,
            at.2,
            "an element of this data block has no name".to_owned(),
            "the elements of a data block that is an array are those of `THIS`",
            format!("write `THIS{form};`"),
        )
    }

    /// What is meant by the values of a branch of CASE.
    fn in_case_value(self) -> Option<Diagnostic> {
        let Slip { state, index, before, at, .. } = self;
        match (&before.1, &at.1) {
            // `2, 3,: #q := TRUE;` in CASE
            (Tok::Comma, _) if self.text(at) == ":" => self.told(
                before.0,
                before.2,
                "no value follows `,`".to_owned(),
                "one sign too many",
                "remove `,` before `:`".to_owned(),
            ),
            // `2, 3 #q := TRUE;` in CASE
            (Tok::Literal(_), Tok::Comma) => {
                let is_value =
                    |(_, token, _): &&Spanned| matches!(token, Tok::Literal(_) | Tok::Comma | Tok::DotDot | Tok::Minus);
                let rest = state.tokens.get(index..)?;
                let count = rest.iter().take(CASE_VALUES_MAX).take_while(is_value).count();
                let (last, next) = (rest.get(count.checked_sub(1)?)?, rest.get(count)?);
                if !begins_operand(&next.1) || !matches!(last.1, Tok::Literal(_)) {
                    return None;
                }
                let values = state.text.get(before.0..last.2)?;
                self.told(
                    before.0,
                    last.2,
                    "`:` is missing after the values of CASE".to_owned(),
                    "a statement follows",
                    format!("write `{values}:`"),
                )
            }
            _ => None,
        }
    }
}

/// A part of a source that is longer than this is not shown in a help.
const EXPRESSION_MAX: usize = 80;
/// How many values of CASE are looked at.
const CASE_VALUES_MAX: usize = 40;

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

/// Whether a variable begins with the token.
fn begins_operand(token: &Tok) -> bool {
    matches!(token, Tok::Name(_) | Tok::Local(_) | Tok::Quoted(_) | Tok::Absolute(_))
}
