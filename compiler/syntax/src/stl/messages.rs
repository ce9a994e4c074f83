//! Syntax errors in terms that users know.

use plcc_diag::{Code, Diagnostic};

use crate::stl::context::{Context, Place};
use crate::stl::token::{Spanned, Tok};
use crate::stl::{Mnemonics, mnemonics};

/// The message for the token at byte `found`, recovered at `place`.
pub fn syntax_error(context: &Context, found: usize, place: Place) -> Diagnostic {
    let index = context.tokens.partition_point(|(start, ..)| *start < found);
    // Tokens without width come before those that begin at the same byte.
    let at = context.tokens.get(index);
    let before = index.checked_sub(1).and_then(|before| context.tokens.get(before));
    match place {
        Place::Statement => statement_error(context, index, at, before),
        Place::Parameter => parameter_error(context, at, before),
        Place::Declaration => declaration_error(context, at, before),
        Place::Assignment => assignment_error(context, at, before),
        Place::Attribute => message(context, at, before, Code::DeclarationSyntax, "attribute")
            .help("write attributes as `{ name := 'value'; name := 'value' }`"),
        Place::Block => message(context, at, before, Code::BlockFrame, "block")
            .help("a block is: keyword and name, header, declarations, `BEGIN`, statements, end keyword"),
    }
}

/// `… cannot follow … in this …`, at the token, or after the last one if the line ends too early.
fn message(context: &Context, at: Option<&Spanned>, before: Option<&Spanned>, code: Code, what: &str) -> Diagnostic {
    match at {
        Some((start, token, end)) if start < end && !ends(token) => {
            let (start, end) = phrase(context, *start, *end);
            let text = &context.text[start..end];
            let title = match before {
                Some((b_start, b_token, b_end)) if b_start < b_end && !ends(b_token) && !begins(b_token) => {
                    let (b_start, b_end) = phrase(context, *b_start, *b_end);
                    format!("`{text}` cannot follow `{}` in this {what}", &context.text[b_start..b_end])
                }
                _ => format!("`{text}` cannot begin this {what}"),
            };
            Diagnostic::new(code, context.span(start, end), title).label("not expected here")
        }
        _ => {
            let (start, end) = before.map_or((0, 0), |(start, _, end)| phrase(context, *start, *end));
            Diagnostic::new(code, context.span(start, end), format!("this {what} is not complete"))
                .label("something is missing after this")
        }
    }
}

/// The bytes of a token, with the letters or the number that complete its address: `MW` and `10`.
fn phrase(context: &Context, start: usize, end: usize) -> (usize, usize) {
    let index = context.tokens.partition_point(|(token_start, ..)| *token_start < start);
    let letters = |token: Option<&Spanned>| {
        token.filter(|(_, token, _)| matches!(token, Tok::Area(..) | Tok::Cell(_))).map(|(start, ..)| *start)
    };
    let number = |token: Option<&Spanned>| {
        token.filter(|(_, token, _)| matches!(token, Tok::Address(_) | Tok::BitAddress(..))).map(|(.., end)| *end)
    };
    let before = index.checked_sub(1).and_then(|before| context.tokens.get(before));
    match (context.tokens.get(index), context.tokens.get(index + 1)) {
        (at, _) if number(at).is_some() => (letters(before).unwrap_or(start), end),
        (at, next) if letters(at).is_some() => (start, number(next).unwrap_or(end)),
        _ => (start, end),
    }
}

/// Letters that name an area only in the other mnemonic set.
fn foreign_letters(context: &Context, at: Option<&Spanned>, before: Option<&Spanned>) -> Option<String> {
    let (Some((_, Tok::Literal(_), end)), Some((start, Tok::Name(name), _))) = (at, before) else { return None };
    let letters = mnemonics::Upper::new(name);
    let (area, width) = mnemonics::area(letters.as_str(), Some(mnemonics::other(context.set)))?;
    let own = mnemonics::letters(area, width, context.set)?;
    let number = &context.text[start + name.len()..*end];
    Some(format!("write `{own}{number}`: the file has {} mnemonics", set_name(context.set)))
}

/// What to write for `1,5`, `M 1.O`, `[AR1]` or `[AR3,P#0.0]`.
fn slip(context: &Context, index: usize, before: Option<&Spanned>) -> Option<String> {
    let (_, before_token, before_end) = before?;
    let (start, token, _) = context.tokens.get(index)?;
    let next = context.tokens.get(index + 1);
    match (before_token, token, next.map(|(_, token, _)| token)) {
        (Tok::Literal(_), Tok::Comma, Some(Tok::Literal(_))) => {
            let (b_start, ..) = before?;
            let (_, _, end) = next?;
            let number = context.text[*b_start..*end].replace(',', ".");
            Some(format!("fractions have a point: write `{number}`"))
        }
        (Tok::Address(_), Tok::Dot, Some(Tok::Name(name))) if name.eq_ignore_ascii_case("o") && before_end == start => {
            let (b_start, _, b_end) = before?;
            let (b_start, b_end) = phrase(context, *b_start, *b_end);
            Some(format!("write the digit 0 in place of the letter O: `{}.0`", &context.text[b_start..b_end]))
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

fn statement_error(context: &Context, index: usize, at: Option<&Spanned>, before: Option<&Spanned>) -> Diagnostic {
    let incomplete = at.is_none_or(|(start, token, end)| start == end || ends(token));
    match before.map(|(_, token, _)| token) {
        Some(Tok::Area(_, width)) if incomplete => {
            let example = if width.bits() == 1 { "0.0" } else { "10" };
            let (start, _, end) = before.expect("it has an area token");
            let text = &context.text[*start..*end];
            return Diagnostic::new(
                Code::MissingOperand,
                context.span(*start, *end),
                format!("`{text}` has no address"),
            )
            .label("a number is missing after this")
            .help(format!("write e.g. `{text} {example}`; a local variable is written `#{text}`"));
        }
        Some(Tok::Cell(_)) if incomplete => {
            let (start, _, end) = before.expect("it has a cell token");
            let text = &context.text[*start..*end];
            return Diagnostic::new(
                Code::MissingOperand,
                context.span(*start, *end),
                format!("`{text}` has no number"),
            )
            .label("a number is missing after this")
            .help(format!("write e.g. `{text} 5`; a local variable is written `#{text}`"));
        }
        Some(Tok::Call) if incomplete => {
            return message(context, at, before, Code::MissingOperand, "call")
                .help("write e.g. `CALL FC 1`, `CALL FB 1, DB 1` or `CALL \"Motor\"`");
        }
        _ => {}
    }
    if let Some(help) = foreign_letters(context, at, before).or_else(|| slip(context, index, before)) {
        return message(context, at, before, Code::Syntax, "statement").help(help);
    }
    let start = context.tokens[..index].iter().rposition(|(_, token, _)| ends(token)).map_or(0, |end| end + 1);
    let first = context.tokens[start..index].iter().find(|(_, token, _)| !begins(token));
    let help = match first.map(|(_, token, _)| token) {
        Some(Tok::Call) => {
            "write `CALL block, instance ( name := operand, … )`, or each `name := operand` on a separate line"
                .to_owned()
        }
        Some(Tok::Insn(insn)) => format!("`{}` takes {}", insn.mnemonic(context.set), operand_phrase(insn.operand())),
        Some(Tok::Jump(insn)) => format!("`{}` takes a label", insn.mnemonic(context.set)),
        _ => "a statement is: label `:`, mnemonic, operand, and `;` or the end of the line".to_owned(),
    };
    message(context, at, before, Code::Syntax, "statement").help(help)
}

fn parameter_error(context: &Context, at: Option<&Spanned>, before: Option<&Spanned>) -> Diagnostic {
    message(context, at, before, Code::Syntax, "parameter list")
        .help("write `name := operand` for each parameter, separated by `,`")
}

fn declaration_error(context: &Context, at: Option<&Spanned>, before: Option<&Spanned>) -> Diagnostic {
    let help = match before.map(|(_, token, _)| token) {
        Some(Tok::Name(_)) if !matches!(at, Some((_, Tok::Colon, _))) => {
            "write `:` between name and data type, e.g. `speed : INT;`"
        }
        Some(Tok::Colon | Tok::Of) => "a data type is missing, e.g. `INT`, `ARRAY [1..10] OF REAL`, `UDT 5`",
        Some(Tok::Array | Tok::DotDot) => "an array is written `ARRAY [1..10] OF INT`",
        _ => "write `name : type := value;`, e.g. `speed : INT := 5;`",
    };
    message(context, at, before, Code::DeclarationSyntax, "declaration").help(help)
}

fn assignment_error(context: &Context, at: Option<&Spanned>, before: Option<&Spanned>) -> Diagnostic {
    message(context, at, before, Code::Syntax, "assignment").help("write `component := constant;`, e.g. `a.b[3] := 5;`")
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
