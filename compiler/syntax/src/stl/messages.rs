//! Syntax errors in terms that users know.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic};

use crate::front::{ParseState, Place};
use crate::stl::token::{Spanned, Tok};
use crate::stl::{Mnemonics, mnemonics};

/// State of a parse of STL, with the mnemonic set of the file.
pub type State<'a> = ParseState<'a, Tok<'a>, Mnemonics>;

/// Where a syntax error was recovered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recovery {
    Block,
    Attribute,
    Declaration,
    Assignment,
    Statement,
    Parameter,
}

impl Place<Tok<'_>, Mnemonics> for Recovery {
    fn message(self, state: &State, found: usize) -> Diagnostic {
        let index = state.index_of(found);
        let at = state.tokens.get(index);
        let before = index.checked_sub(1).and_then(|before| state.tokens.get(before));
        match self {
            Recovery::Statement => statement_error(state, index, at, before),
            Recovery::Parameter => parameter_error(state, at, before),
            Recovery::Declaration => declaration_error(state, at, before),
            Recovery::Assignment => assignment_error(state, at, before),
            Recovery::Attribute => message(state, at, before, Code::DeclarationSyntax, "attribute")
                .help("write attributes as `{ name := 'value'; name := 'value' }`"),
            Recovery::Block => message(state, at, before, Code::BlockFrame, "block")
                .help("a block is: keyword and name, header, declarations, `BEGIN`, statements, end keyword"),
        }
    }
}

/// `… cannot follow … in this …`, at the token, or after the last one if the line ends too early.
fn message(state: &State, at: Option<&Spanned>, before: Option<&Spanned>, code: Code, what: &str) -> Diagnostic {
    let phrase = |(start, _, end): &Spanned| phrase(state, *start, *end);
    let here = at.filter(|(start, token, end)| start < end && !ends(token));
    let follows = before.filter(|(start, token, end)| start < end && !ends(token) && !begins(token));
    state.misplaced(code, what, here.map(phrase), follows.map(phrase), before.map_or(0..0, phrase))
}

/// The bytes of a token, with the letters or the number that complete its address: `MW` and `10`.
fn phrase(state: &State, start: usize, end: usize) -> Range<usize> {
    let index = state.index_of(start);
    let letters = |token: Option<&Spanned>| {
        token.filter(|(_, token, _)| matches!(token, Tok::Area(..) | Tok::Cell(_))).map(|(start, ..)| *start)
    };
    let number = |token: Option<&Spanned>| {
        token.filter(|(_, token, _)| matches!(token, Tok::Address(_) | Tok::BitAddress(..))).map(|(.., end)| *end)
    };
    let before = index.checked_sub(1).and_then(|before| state.tokens.get(before));
    match (state.tokens.get(index), state.tokens.get(index + 1)) {
        (at, _) if number(at).is_some() => letters(before).unwrap_or(start)..end,
        (at, next) if letters(at).is_some() => start..number(next).unwrap_or(end),
        _ => start..end,
    }
}

/// Letters that name an area only in the other mnemonic set.
fn foreign_letters(state: &State, at: Option<&Spanned>, before: Option<&Spanned>) -> Option<String> {
    let (Some((_, Tok::Literal(_), end)), Some((start, Tok::Name(name), _))) = (at, before) else { return None };
    let letters = mnemonics::Upper::new(name);
    let (area, width) = mnemonics::area(letters.as_str(), Some(mnemonics::other(state.rules)))?;
    let own = mnemonics::letters(area, width, state.rules)?;
    let number = &state.text[start + name.len()..*end];
    Some(format!("write `{own}{number}`: the file has {} mnemonics", set_name(state.rules)))
}

/// What to write for `1,5`, `M 1.O`, `[AR1]` or `[AR3,P#0.0]`.
fn slip(state: &State, index: usize, before: Option<&Spanned>) -> Option<String> {
    let (_, before_token, before_end) = before?;
    let (start, token, _) = state.tokens.get(index)?;
    let next = state.tokens.get(index + 1);
    match (before_token, token, next.map(|(_, token, _)| token)) {
        (Tok::Literal(_), Tok::Comma, Some(Tok::Literal(_))) => {
            let (b_start, ..) = before?;
            let (_, _, end) = next?;
            let number = state.text[*b_start..*end].replace(',', ".");
            Some(format!("fractions have a point: write `{number}`"))
        }
        (Tok::Address(_), Tok::Dot, Some(Tok::Name(name))) if name.eq_ignore_ascii_case("o") && before_end == start => {
            let (b_start, _, b_end) = before?;
            let number = &state.text[phrase(state, *b_start, *b_end)];
            Some(format!("write the digit 0 in place of the letter O: `{number}.0`"))
        }
        (Tok::Register(_), Tok::RightBracket, _) => Some("the offset is missing: write e.g. `[AR1,P#0.0]`".to_owned()),
        (Tok::Name(name), Tok::Comma, _)
            if name.len() == 3 && name.get(..2).is_some_and(|letters| letters.eq_ignore_ascii_case("ar")) =>
        {
            Some("the address registers are AR1 and AR2".to_owned())
        }
        _ => None,
    }
}

pub fn set_name(set: Mnemonics) -> &'static str {
    match set {
        Mnemonics::En => "international",
        Mnemonics::De => "German",
    }
}

/// Whether a statement or declaration ends with the token.
fn ends(token: &Tok) -> bool {
    matches!(token, Tok::End | Tok::Semicolon | Tok::EndVar | Tok::EndStruct | Tok::EndBlock | Tok::AttributeEnd)
}

fn begins(token: &Tok) -> bool {
    matches!(
        token,
        Tok::Label(_) | Tok::Begin | Tok::Network | Tok::Title(_) | Tok::Section(_) | Tok::Struct | Tok::LeftBrace
    )
}

fn statement_error(state: &State, index: usize, at: Option<&Spanned>, before: Option<&Spanned>) -> Diagnostic {
    let incomplete = at.is_none_or(|(start, token, end)| start == end || ends(token));
    match before.map(|(_, token, _)| token) {
        Some(Tok::Area(_, width)) if incomplete => {
            let example = if width.bits() == 1 { "0.0" } else { "10" };
            let (start, _, end) = before.expect("it has an area token");
            let text = &state.text[*start..*end];
            return Diagnostic::new(Code::MissingOperand, state.span(*start..*end), format!("`{text}` has no address"))
                .label("a number is missing after this")
                .help(format!("write e.g. `{text} {example}`; a local variable is written `#{text}`"));
        }
        Some(Tok::Cell(_)) if incomplete => {
            let (start, _, end) = before.expect("it has a cell token");
            let text = &state.text[*start..*end];
            return Diagnostic::new(Code::MissingOperand, state.span(*start..*end), format!("`{text}` has no number"))
                .label("a number is missing after this")
                .help(format!("write e.g. `{text} 5`; a local variable is written `#{text}`"));
        }
        Some(Tok::Call) if incomplete => {
            return message(state, at, before, Code::MissingOperand, "call")
                .help("write e.g. `CALL FC 1`, `CALL FB 1, DB 1` or `CALL \"Motor\"`");
        }
        _ => {}
    }
    if let Some(help) = foreign_letters(state, at, before).or_else(|| slip(state, index, before)) {
        return message(state, at, before, Code::Syntax, "statement").help(help);
    }
    let start = state.tokens[..index].iter().rposition(|(_, token, _)| ends(token)).map_or(0, |end| end + 1);
    let first = state.tokens[start..index].iter().find(|(_, token, _)| !begins(token));
    let help = match first.map(|(_, token, _)| token) {
        Some(Tok::Call) => {
            "write `CALL block, instance ( name := operand, … )`, or each `name := operand` on a separate line"
                .to_owned()
        }
        Some(Tok::Insn(insn)) => format!("`{}` takes {}", insn.mnemonic(state.rules), operand_phrase(insn.operand())),
        Some(Tok::Jump(insn)) => format!("`{}` takes a label", insn.mnemonic(state.rules)),
        _ => "a statement is: label `:`, mnemonic, operand, and `;` or the end of the line".to_owned(),
    };
    message(state, at, before, Code::Syntax, "statement").help(help)
}

fn parameter_error(state: &State, at: Option<&Spanned>, before: Option<&Spanned>) -> Diagnostic {
    message(state, at, before, Code::Syntax, "parameter list")
        .help("write `name := operand` for each parameter, separated by `,`")
}

fn declaration_error(state: &State, at: Option<&Spanned>, before: Option<&Spanned>) -> Diagnostic {
    let help = match before.map(|(_, token, _)| token) {
        Some(Tok::Name(_)) if !matches!(at, Some((_, Tok::Colon, _))) => {
            "write `:` between name and data type, e.g. `speed : INT;`"
        }
        Some(Tok::Colon | Tok::Of) => "a data type is missing, e.g. `INT`, `ARRAY [1..10] OF REAL`, `UDT 5`",
        Some(Tok::Array | Tok::DotDot) => "an array is written `ARRAY [1..10] OF INT`",
        _ => "write `name : type := value;`, e.g. `speed : INT := 5;`",
    };
    message(state, at, before, Code::DeclarationSyntax, "declaration").help(help)
}

fn assignment_error(state: &State, at: Option<&Spanned>, before: Option<&Spanned>) -> Diagnostic {
    message(state, at, before, Code::Syntax, "assignment").help("write `component := constant;`, e.g. `a.b[3] := 5;`")
}

/// What an instruction accepts, for help texts.
pub fn operand_phrase(class: crate::stl::OperandClass) -> &'static str {
    use crate::stl::OperandClass;
    match class {
        OperandClass::None => "no operand",
        OperandClass::Bit => "one bit, e.g. `I 0.0`, a timer, a counter or a status bit",
        OperandClass::BitOrNone => "one bit, e.g. `I 0.0`, or nothing",
        OperandClass::BitWrite => "one bit, e.g. `M 0.0`",
        OperandClass::BitWriteOrCounter => "one bit, e.g. `M 0.0`, or a counter",
        OperandClass::BitWriteOrCell => "one bit, e.g. `M 0.0`, a timer or a counter",
        OperandClass::LoadSource => "a byte, word or double word, e.g. `MW 10`, or a constant",
        OperandClass::TransferTarget => "a byte, word or double word, e.g. `MW 10`",
        OperandClass::Timer => "a timer, e.g. `T 5`",
        OperandClass::Counter => "a counter, e.g. `C 5`",
        OperandClass::Cell => "a timer or a counter, e.g. `T 5`",
        OperandClass::LoadAr1 => "nothing, a double word, a pointer `P#10.0` or `AR2`",
        OperandClass::LoadAr2 => "nothing, a double word or a pointer `P#10.0`",
        OperandClass::TransferAr1 => "nothing, a double word or `AR2`",
        OperandClass::TransferAr2 => "nothing or a double word",
        OperandClass::PointerOrNone => "nothing or a pointer without area, e.g. `P#10.0`",
        OperandClass::Byte => "a number from 0 to 255",
        OperandClass::AddConstant => "a whole number, e.g. `5` or `L#5`",
        OperandClass::WordConstOrNone => "nothing or a word constant, e.g. `W#16#FF`",
        OperandClass::DwordConstOrNone => "nothing or a double word constant, e.g. `DW#16#FF`",
        OperandClass::ShiftCount16 => "nothing or a count from 0 to 15",
        OperandClass::ShiftCount32 => "nothing or a count from 0 to 32",
        OperandClass::Label => "a label",
        OperandClass::Block => "a block, e.g. `FC 5`",
        OperandClass::DataBlock => "a data block, e.g. `DB 5` or `DI 5`",
    }
}
