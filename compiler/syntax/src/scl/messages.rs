//! Syntax errors in terms that users know.

use plcc_diag::{Code, Diagnostic};

use super::context::{Context, Place};
use super::token::{Spanned, Tok};

/// The message for the token at byte `found`, recovered at `place`.
pub fn syntax_error(context: &Context, found: usize, place: Place) -> Diagnostic {
    let index = context.tokens.partition_point(|(start, ..)| *start < found);
    let at = context.tokens.get(index);
    let before = index.checked_sub(1).and_then(|before| context.tokens.get(before));
    let (code, what, help) = match place {
        Place::Block => (
            Code::BlockFrame,
            "block",
            "a block is: keyword and name, header, declarations, `BEGIN`, statements, end keyword",
        ),
        Place::Declaration => (Code::DeclarationSyntax, "declaration", declaration_help(at, before)),
        Place::Constant => (
            Code::DeclarationSyntax,
            "constant",
            "write `name : type := value;`, in a classic CONST section `name := value;`",
        ),
        Place::Labels => (Code::DeclarationSyntax, "list of labels", "write `LABEL first, second; END_LABEL`"),
        Place::Assignment => (Code::Syntax, "assignment", "write `component := constant;`, e.g. `a.b[3] := 5;`"),
        Place::Statement => (Code::Syntax, "statement", statement_help(at, before)),
        Place::Condition => (Code::Syntax, "expression", expression_help(at, before)),
        Place::For => (Code::Syntax, "head of the loop", "write `FOR i := first TO last BY step DO`"),
        Place::CaseValue => {
            (Code::Syntax, "value of CASE", "values are constants: `1:`, `2, 5..7:`, or names of constants")
        }
        Place::Argument => (
            Code::Syntax,
            "argument",
            "write `name := value` for inputs and `name => variable` for outputs, separated by `,`",
        ),
    };
    message(context, at, before, code, what).help(help)
}

/// `… cannot follow … in this …`, at the token, or after the last one if the statement ends too early.
fn message(context: &Context, at: Option<&Spanned>, before: Option<&Spanned>, code: Code, what: &str) -> Diagnostic {
    match at {
        Some((start, token, end)) if start < end && !ends(token) => {
            let text = &context.text[*start..*end];
            let title = match before {
                Some((b_start, b_token, b_end)) if b_start < b_end && !ends(b_token) && !begins(b_token) => {
                    format!("`{text}` cannot follow `{}` in this {what}", &context.text[*b_start..*b_end])
                }
                _ => format!("`{text}` cannot begin this {what}"),
            };
            Diagnostic::new(code, context.span(*start, *end), title).label("not expected here")
        }
        _ => {
            let (start, end) = before.map_or((0, 0), |(start, _, end)| (*start, *end));
            Diagnostic::new(code, context.span(start, end), format!("this {what} is not complete"))
                .label("something is missing after this")
        }
    }
}

/// Whether a statement, condition or declaration ends with the token.
fn ends(token: &Tok) -> bool {
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
fn begins(token: &Tok) -> bool {
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
        Some(Tok::Name(_) | Tok::Quoted(_)) if !matches!(at, Some((_, Tok::Colon, _))) => {
            "write `:` between name and data type, e.g. `speed : INT;`"
        }
        Some(Tok::Colon | Tok::Of) => "a data type is missing, e.g. `INT`, `ARRAY[1..10] OF REAL`, `\"Motor\"`",
        Some(Tok::Array | Tok::DotDot) => "an array is written `ARRAY[1..10] OF INT`",
        _ => "write `name : type := value;`, e.g. `speed : INT := 5;`",
    }
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
