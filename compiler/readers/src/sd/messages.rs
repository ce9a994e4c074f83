//! Syntax errors in terms that users know.

use plcc_diag::{Code, Diagnostic};

use super::token::Tok;
use plcc_syntax::front::{ParseState, Place};

/// State of a parse of a network.
pub type State<'a> = ParseState<'a, Tok<'a>>;

/// Where a syntax error was recovered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recovery {
    Network,
    Rung,
    Argument,
}

impl Place<Tok<'_>, ()> for Recovery {
    fn message(self, state: &State, found: usize) -> Diagnostic {
        let (what, help) = match self {
            Recovery::Network => {
                ("network", "a network contains rungs: `RUNG wire#powerrail Contact( #a ) Coil( #q ) END_RUNG`")
            }
            Recovery::Rung => {
                ("rung", "a rung contains elements with their pins in parentheses, wires `wire#w1`, and in FBD `NOT`")
            }
            Recovery::Argument => {
                ("pin", "write `pin := operand` for inputs and `pin => operand` for outputs, separated by `,`")
            }
        };
        let (start, end) = match state.tokens.get(state.index_of(found)) {
            Some((start, _, end)) => (*start, *end),
            None => state.tokens.last().map_or((0, 0), |(start, _, end)| (*start, *end)),
        };
        let title = match state.text.get(start..end) {
            Some(text) if !text.is_empty() => format!("`{text}` is not allowed here in a {what}"),
            _ => format!("this {what} is not complete"),
        };
        Diagnostic::new(Code::Syntax, state.span(start..end), title).label("not expected here").help(help)
    }
}
