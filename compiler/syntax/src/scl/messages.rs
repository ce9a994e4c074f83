//! Syntax errors in terms that users know.

use plcc_diag::{Code, Diagnostic};

use super::ast::{Dialect, Literal};
use super::token::{Spanned, Tok};
use crate::front::{ParseState, Place};

/// State of a parse of SCL, with the dialect of the file.
pub type State<'a> = ParseState<'a, Tok<'a>, Dialect>;

/// Where a syntax error was recovered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recovery {
    Block,
    Declaration,
    Constant,
    Labels,
    Assignment,
    Statement,
    Condition,
    For,
    CaseValue,
    Argument,
}

impl Place<Tok<'_>, Dialect> for Recovery {
    fn message(self, state: &State, found: usize) -> Diagnostic {
        let index = state.index_of(found);
        let at = state.tokens.get(index);
        let before = index.checked_sub(1).and_then(|before| state.tokens.get(before));
        let (code, what, help) = match self {
            Recovery::Block => (
                Code::BlockFrame,
                "block",
                "a block is: keyword and name, header, declarations, `BEGIN`, statements, end keyword",
            ),
            Recovery::Declaration => (Code::DeclarationSyntax, "declaration", declaration_help(at, before)),
            Recovery::Constant => (
                Code::DeclarationSyntax,
                "constant",
                "write `name : type := value;`, in a classic CONST section `name := value;`",
            ),
            Recovery::Labels => (Code::DeclarationSyntax, "list of labels", "write `LABEL first, second; END_LABEL`"),
            Recovery::Assignment => (Code::Syntax, "assignment", "write `component := constant;`, e.g. `a.b[3] := 5;`"),
            Recovery::Statement if begins_branch(state, index) => {
                (Code::Syntax, "statement", "a number begins a branch of CASE, which belongs between OF and ELSE")
            }
            Recovery::Statement => (Code::Syntax, "statement", statement_help(at, before)),
            Recovery::Condition => (Code::Syntax, "expression", expression_help(at, before)),
            Recovery::For => (Code::Syntax, "head of the loop", "write `FOR i := first TO last BY step DO`"),
            Recovery::CaseValue => {
                (Code::Syntax, "value of CASE", "values are constants: `1:`, `2, 5..7:`, or names of constants")
            }
            Recovery::Argument => (
                Code::Syntax,
                "argument",
                "write `name := value` for inputs and `name => variable` for outputs, separated by `,`",
            ),
        };
        if let Some(told) = self.slip(state, index) {
            return told;
        }
        let range = |(start, _, end): &Spanned| *start..*end;
        let here = at.filter(|(start, token, end)| start < end && !ends(token));
        let follows = before.filter(|(start, token, end)| start < end && !ends(token) && !begins(token));
        state.misplaced(code, what, here.map(range), follows.map(range), before.map_or(0..0, range)).help(help)
    }
}

/// Whether a statement, condition or declaration ends with the token.
pub(super) fn ends(token: &Tok) -> bool {
    matches!(
        token,
        Tok::End
            | Tok::Empty
            | Tok::EndVar
            | Tok::EndStruct
            | Tok::EndBlock
            | Tok::Then
            | Tok::Do
            | Tok::Of
            | Tok::EndIf
            | Tok::EndCase
            | Tok::EndFor
            | Tok::EndWhile
            | Tok::EndRepeat
    )
}

/// Whether a statement or declaration begins after the token.
pub(super) fn begins(token: &Tok) -> bool {
    matches!(
        token,
        Tok::Begin
            | Tok::Section(..)
            | Tok::Constants
            | Tok::Labels
            | Tok::Content
            | Tok::Struct
            | Tok::Else
            | Tok::Repeat
            | Tok::Label(_)
            | Tok::Arm
            | Tok::Pragma(_)
            | Tok::ImpliedOb
    )
}

fn declaration_help(at: Option<&Spanned>, before: Option<&Spanned>) -> &'static str {
    match before.map(|(_, token, _)| token) {
        _ if matches!(at, Some((_, Tok::LeftBracket, _))) => "an array is written `ARRAY[low..high] OF type`",
        _ if matches!(at, Some((_, Tok::RightBracket, _))) => {
            "an array has a lower and an upper bound: `ARRAY[low..high] OF type`"
        }
        Some(Tok::Name(_) | Tok::Quoted(_)) if !matches!(at, Some((_, Tok::Colon, _))) => {
            "write `:` between name and data type, e.g. `speed : INT;`"
        }
        Some(Tok::Colon | Tok::Of) => "a data type is missing, e.g. `INT`, `ARRAY[1..10] OF REAL`, `\"Motor\"`",
        Some(Tok::Array | Tok::DotDot) => "an array is written `ARRAY[1..10] OF INT`",
        _ => "write `name : type := value;`, e.g. `speed : INT := 5;`",
    }
}

/// `3:`, `2..5:` where no value of CASE is possible.
fn begins_branch(state: &State, index: usize) -> bool {
    let Some([(_, before, _), (_, Tok::Literal(Literal::Integer { .. }), _), (_, Tok::Colon | Tok::DotDot, _)]) =
        index.checked_sub(2).and_then(|first| state.tokens.get(first..=index))
    else {
        return false;
    };
    matches!(before, Tok::End | Tok::Then | Tok::Else | Tok::Do | Tok::Begin)
}

fn statement_help(at: Option<&Spanned>, before: Option<&Spanned>) -> &'static str {
    match at.map(|(_, token, _)| token) {
        Some(Tok::Colon) => "a value is assigned with `:=`",
        _ if before.is_some_and(|(_, token, _)| matches!(token, Tok::Goto)) => "write the label after GOTO",
        _ => {
            "a statement is an assignment `variable := value;`, a call `block(input := value);`, or one of IF, CASE, FOR, WHILE, REPEAT"
        }
    }
}

fn expression_help(at: Option<&Spanned>, _before: Option<&Spanned>) -> &'static str {
    match at.map(|(_, token, _)| token) {
        Some(Tok::Assign) => "values are compared with `=`",
        _ => "an expression consists of variables, constants, calls and operators such as `+`, `=`, `AND`",
    }
}
