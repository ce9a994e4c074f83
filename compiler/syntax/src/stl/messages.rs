//! Syntax errors in terms that users know.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic};

use crate::Elementary;
use crate::front::{ParseState, Place};
use crate::stl::token::{Spanned, Tok};
use crate::stl::{Mnemonics, StlInsn, form_help, forms, mnemonics, start_values, suggest};

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
            Recovery::Declaration => {
                start_values::slip(state, index).unwrap_or_else(|| declaration_error(state, at, before))
            }
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

/// A form that has only one meaning: German letters among international mnemonics, `1,5`, `0xFF`, `5s`, `M 1.O`, `[AR1]`, `T 1.0`.
fn slip(state: &State, index: usize, before: Option<&Spanned>) -> Option<Diagnostic> {
    let (b_start, before_token, before_end) = before?;
    let (start, token, end) = state.tokens.get(index)?;
    let next = state.tokens.get(index + 1);
    let adjacent = before_end == start;
    let whole = state.text.get(*b_start..*end)?;
    let told = |code, range: Range<usize>, title: String, label: &str, help: String| {
        Some(Diagnostic::new(code, state.span(range), title).label(label).help(help))
    };
    match (before_token, token, next.map(|(_, token, _)| token)) {
        (Tok::Name(name), Tok::Literal(_), _) => {
            let number = state.text.get(*before_end..*end)?;
            if let Some(address) = suggest::address(name, number.trim(), state.rules) {
                return told(
                    Code::ForeignForm,
                    *b_start..*end,
                    format!("`{whole}` is not an address of STL"),
                    "an address begins with the letters of its area",
                    format!("write `{address}`"),
                );
            }
            let letters = mnemonics::Upper::new(name);
            let own = match (letters.as_str(), state.rules) {
                ("C", Mnemonics::De) => "Z".to_owned(),
                ("Z", Mnemonics::En) => "C".to_owned(),
                (letters, _) => {
                    let (area, width) = mnemonics::area(letters, Some(mnemonics::other(state.rules)))?;
                    mnemonics::letters(area, width, state.rules)?
                }
            };
            // `Data.DBW 0`: these letters are those of both sets.
            if own.eq_ignore_ascii_case(letters.as_str()) {
                let [.., (from, Tok::Name(_), to), (_, Tok::Dot, _), _] = state.tokens.get(..index)? else {
                    return None;
                };
                if !own.starts_with("DB") {
                    return None;
                }
                let block = state.text.get(*from..*to)?;
                let help = format!("write `\"{block}\".{whole}`");
                let title = "a symbol before an address has quotes".to_owned();
                return told(Code::ForeignForm, *from..*end, title, "a name without quotes", help);
            }
            let (own_set, other_set) = (set_name(state.rules), set_name(mnemonics::other(state.rules)));
            told(
                Code::MixedMnemonics,
                *b_start..*end,
                format!("`{whole}` is an address of the {other_set} mnemonics in a file with {own_set} ones"),
                "a file uses one set only",
                format!("write `{own}{number}`: the file has {own_set} mnemonics"),
            )
        }
        (Tok::Literal(_), Tok::Comma, Some(Tok::Literal(_))) => {
            let number = &state.text[*b_start..next?.2];
            told(
                Code::ForeignForm,
                *b_start..next?.2,
                "a decimal number has a point".to_owned(),
                "not a number of STL",
                format!("fractions have a point: write `{}`", number.replace(',', ".")),
            )
        }
        (Tok::Literal(_), Tok::Name(name), _) if adjacent => {
            let number = &state.text[*b_start..*before_end];
            let upper = name.to_ascii_uppercase();
            let digits = upper.strip_prefix('X').filter(|_| number == "0");
            let bits = upper.strip_prefix('B').filter(|bits| number == "0" && !bits.is_empty());
            let is_of = |base: u32, digits: &str| digits.chars().all(|digit| digit.is_digit(base));
            let (title, help) = match (digits, bits) {
                (_, Some(bits)) if is_of(2, bits) => ("a binary number begins with `2#`", format!("write `2#{bits}`")),
                (_, Some(bits)) if is_of(10, bits) => (
                    "a binary number begins with `2#`",
                    format!("its digits are 0 and 1; if `{bits}` is a hexadecimal number, write `16#{bits}`"),
                ),
                (Some(digits), _) if let Some(written) = suggest::hexadecimal(digits) => {
                    ("a hexadecimal number begins with `16#`", format!("write `{written}`"))
                }
                _ if ["MS", "S", "M", "H", "D"].contains(&upper.as_str()) => (
                    "a time begins with `S5T#` or `T#`",
                    format!("write `S5T#{number}{upper}` for a timer of the CPU, `T#{number}{upper}` for a TIME"),
                ),
                _ if let Some(written) = suggest::hexadecimal(&format!("{number}{}", upper.trim_end_matches('H'))) => {
                    ("a hexadecimal number begins with `16#`", format!("write `{written}`"))
                }
                _ => return None,
            };
            told(Code::ForeignForm, *b_start..*end, title.to_owned(), "not a constant of STL", help)
        }
        // `5.`
        (Tok::Literal(_), Tok::Dot, _) if adjacent => {
            let number = &state.text[*b_start..*before_end];
            let digits = number.trim_start_matches(['-', '+']);
            if digits.is_empty() || !digits.bytes().all(|digit| digit.is_ascii_digit()) {
                return None;
            }
            told(
                Code::ForeignForm,
                *b_start..*end,
                "a decimal number has a digit after its point".to_owned(),
                "not a number of STL",
                format!("write `{number}.0`"),
            )
        }
        (Tok::Cell(cell), Tok::BitAddress(number, _), _) => {
            let letters = state.text.get(*b_start..*before_end)?;
            let what = match cell {
                crate::ast::CellKind::Timer => "a timer",
                crate::ast::CellKind::Counter => "a counter",
            };
            told(
                Code::Syntax,
                *b_start..*end,
                format!("`{whole}` has a bit number, but {what} has none"),
                "the number before the point is that of the whole",
                format!("write `{letters} {number}`"),
            )
        }
        _ => {
            let help = match (before_token, token) {
                (Tok::Address(_), Tok::Dot)
                    if adjacent && matches!(next, Some((_, Tok::Name(name), _)) if name.eq_ignore_ascii_case("o")) =>
                {
                    let number = &state.text[phrase(state, *b_start, *before_end)];
                    format!("write the digit 0 in place of the letter O: `{number}.0`")
                }
                (Tok::Register(_), Tok::RightBracket) => "the offset is missing: write e.g. `[AR1,P#0.0]`".to_owned(),
                (Tok::Name(name), Tok::Comma)
                    if name.len() == 3 && name.get(..2).is_some_and(|letters| letters.eq_ignore_ascii_case("ar")) =>
                {
                    "the address registers are AR1 and AR2".to_owned()
                }
                _ => return None,
            };
            Some(message(state, state.tokens.get(index), before, Code::Syntax, "statement").help(help))
        }
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
        Tok::Label(_)
            | Tok::Begin
            | Tok::Network
            | Tok::Title(_)
            | Tok::Section(_)
            | Tok::Constants
            | Tok::Struct
            | Tok::LeftBrace
    )
}

fn statement_error(state: &State, index: usize, at: Option<&Spanned>, before: Option<&Spanned>) -> Diagnostic {
    let incomplete = at.is_none_or(|(start, token, end)| start == end || ends(token));
    if let Some(told) = forms::negated_operand(state, index, before) {
        return told;
    }
    // `=I`
    if incomplete
        && let (Some((start, Tok::Area(..), end)), Some((sign, Tok::Insn(_), sign_end))) =
            (before, index.checked_sub(2).and_then(|first| state.tokens.get(first)))
        && sign_end == start
        && &state.text[*sign..*sign_end] == "="
        && matches!(&state.text[*start..*end], "I" | "i" | "D" | "d")
    {
        let written = &state.text[*sign..*end];
        return Diagnostic::new(Code::ForeignForm, state.span(*sign..*end), format!("a comparison is `={written}`"))
            .label("`=` writes a bit")
            .help(format!("write `={written}`"));
    }
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
    if let Some(told) = slip(state, index, before) {
        return told;
    }
    let outside = |(_, token, _): &Spanned| ends(token) || begins(token);
    let start = state.tokens[..index].iter().rposition(outside).map_or(0, |end| end + 1);
    let first = state.tokens[start..index].first();
    if let (Some((_, Tok::Comma, comma_end)), Some((_, Tok::Insn(insn), insn_end))) = (at, first) {
        return forms::surplus_operand(state, *insn, *insn_end, *comma_end);
    }
    if let (Some((start, Tok::Name(word), end)), Some((_, Tok::Insn(insn), _)), Some((.., operand_end))) =
        (at, first, before)
        && operand_end < start
        && let Some(told) = forms::operator(state, word, *start..*end, insn.operand())
    {
        return told;
    }
    if let (Some((start, next, _)), Some((_, Tok::Insn(insn), insn_end)), Some((_, last, last_end))) =
        (at, first, before)
        && last_end < start
        && forms::is_operand_end(last)
        && matches!(next, Tok::Local(_) | Tok::Quoted(_) | Tok::Area(..) | Tok::Cell(_) | Tok::Block(..))
    {
        return forms::surplus_operand(state, *insn, *insn_end, *start);
    }
    if let Some(help) = first.and_then(|first| form_help::of(state, index, first)) {
        return message(state, at, before, Code::Syntax, "statement").help(help);
    }
    let help = match first.map(|(_, token, _)| token) {
        Some(Tok::Call) => {
            "write `CALL block, instance ( name := operand, … )`, or each `name := operand` on a separate line"
                .to_owned()
        }
        Some(Tok::Insn(insn)) => {
            format!("`{}` takes {}", insn.mnemonic(state.rules), operand_phrase(insn.operand(), state.rules))
        }
        Some(Tok::Jump(insn)) if matches!(at, Some((_, Tok::Colon, _))) => {
            let label = before.and_then(|(start, _, end)| state.text.get(*start..*end)).unwrap_or("…");
            format!("write `{} {label}`: only the label itself has a `:`", insn.mnemonic(state.rules))
        }
        Some(Tok::Jump(insn)) => {
            let jump = insn.mnemonic(state.rules);
            match jump_on_bit(state, at, before) {
                Some(bit) => {
                    format!(
                        "write `{} {bit}` on the line before, and a label after `{jump}`",
                        StlInsn::And.mnemonic(state.rules)
                    )
                }
                None => format!("`{jump}` takes a label"),
            }
        }
        _ => "a statement is: label `:`, mnemonic, operand, and `;` or the end of the line".to_owned(),
    };
    message(state, at, before, Code::Syntax, "statement").help(help)
}

/// `M 0.0` after a jump, in place of a label.
fn jump_on_bit<'a>(state: &'a State, at: Option<&Spanned>, before: Option<&Spanned>) -> Option<&'a str> {
    let ((start, _, area_end), (number, _, end)) = (before?, at?);
    let (area, number) = (state.text.get(*start..*area_end)?, state.text.get(*number..*end)?);
    let is_area = ["I", "Q", "M", "E", "A", "L"].iter().any(|known| known.eq_ignore_ascii_case(area));
    let is_bit = number.contains('.') && number.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    (is_area && is_bit).then(|| &state.text[*start..*end])
}

fn parameter_error(state: &State, at: Option<&Spanned>, before: Option<&Spanned>) -> Diagnostic {
    let told = message(state, at, before, Code::Syntax, "parameter list");
    told.help(
        match (at, before) {
            (Some(at), Some(before)) => parameter_help(state, at, before),
            _ => None,
        }
        .unwrap_or_else(|| "write `name := operand` for each parameter, separated by `,`".to_owned()),
    )
}

/// What to write for an expression or an incomplete pointer after `name :=`.
fn parameter_help(state: &State, at: &Spanned, before: &Spanned) -> Option<String> {
    let text = |(start, _, end): &Spanned| state.text.get(*start..*end).unwrap_or_default();
    let (word, last) = (text(at).to_ascii_uppercase(), text(before));
    if word == ":" && matches!(before.1, Tok::Name(_)) {
        let operand = state.text.get(at.2..)?.split([',', ')', ';', '\n']).next().unwrap_or_default().trim();
        return Some(format!("write `{last} := {operand}`"));
    }
    if last.eq_ignore_ascii_case("NOT") {
        return Some(
            "a parameter has one operand: write the negated bit with `NOT` and `=` before the call".to_owned(),
        );
    }
    if word.starts_with(['+', '-', '*', '/']) || matches!(word.as_str(), "AND" | "OR" | "XOR" | "DIV" | "MOD") {
        return Some(
            "a parameter has one operand: calculate the value before the call, and pass the result".to_owned(),
        );
    }
    let is_type = |word: &str| {
        matches!(word, "BOOL" | "BYTE" | "CHAR" | "WORD" | "INT" | "DWORD" | "DINT" | "REAL" | "TIME" | "S5TIME")
    };
    let index = state.index_of(at.0);
    let start = index.saturating_sub(POINTER_TOKENS);
    let first = start + state.tokens[start..index].iter().rposition(|(_, token, _)| matches!(token, Tok::Assign))? + 1;
    let operand = state.text.get(state.tokens.get(first)?.0..at.0)?.trim_end();
    let is_pointer = operand.get(..2).is_some_and(|letters| letters.eq_ignore_ascii_case("P#"));
    let count = state.tokens.get(index + 1).map(text).filter(|count| count.bytes().all(|digit| digit.is_ascii_digit()));
    let count = count.filter(|count| !count.is_empty()).unwrap_or("1");
    // `P#M 0.0 BYTE8`
    let letters = word.trim_end_matches(|c: char| c.is_ascii_digit());
    if is_pointer && letters.len() < word.len() && is_type(letters) {
        return Some(format!("write `{operand} {letters} {}`", &word[letters.len()..]));
    }
    match word.strip_suffix('S').filter(|singular| is_type(singular)) {
        Some(singular) if is_pointer => Some(format!("write `{operand} {singular} {count}`")),
        None if is_type(&word) && !is_pointer => {
            Some(format!("a pointer begins with `P#`: write `P#{operand} {word} {count}`"))
        }
        _ => None,
    }
}

/// How many tokens an address in a data block has, with `:=`.
const POINTER_TOKENS: usize = 8;

fn declaration_error(state: &State, at: Option<&Spanned>, before: Option<&Spanned>) -> Diagnostic {
    let after_bounds = matches!((before, at), (Some((_, Tok::RightBracket, _)), Some((start, _, end))) if start < end);
    if after_bounds && let Some((start, _, end)) = at {
        let ty = &state.text[*start..*end];
        return Diagnostic::new(Code::DeclarationSyntax, state.span(*start..*end), "`OF` is missing before the type")
            .label("the type of the elements")
            .help(format!("write `OF {ty}`"));
    }
    if let (Some(at), Some(before)) = (at, before)
        && let Some(told) = other_brackets(state, at, before)
    {
        return told;
    }
    if let Some(help) = before.zip(at).and_then(|(before, at)| without_colon(state, before, at)) {
        return message(state, at, before, Code::DeclarationSyntax, "declaration").help(help);
    }
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

/// `speed INT`, `INT speed`: the help.
fn without_colon(state: &State, before: &Spanned, at: &Spanned) -> Option<String> {
    let ((start, Tok::Name(_), end), (at_start, Tok::Name(_), at_end)) = (before, at) else { return None };
    let index = state.index_of(*start);
    // `x : UNSIGNED INT`, `x : ARRAY[1..5] OF UNSIGNED INT`
    let is_in_type = index.checked_sub(1).is_some_and(|before| matches!(state.tokens[before].1, Tok::Colon | Tok::Of));
    let (first, second) = (&state.text[*start..*end], &state.text[*at_start..*at_end]);
    let is_type = |word: &str| Elementary::from_word(&word.to_ascii_uppercase()).is_some();
    let (name, ty) = match (is_type(first), is_type(second)) {
        _ if is_in_type => return None,
        (false, true) => (first, second),
        (true, false) => (second, first),
        (false, false) | (true, true) => return None,
    };
    Some(format!("write `{name} : {ty}`"))
}

/// `ARRAY[10]`, `ARRAY[1-10]`, `STRING(20)`.
fn other_brackets(state: &State, at: &Spanned, before: &Spanned) -> Option<Diagnostic> {
    let text = |(start, _, end): &Spanned| state.text.get(*start..*end).unwrap_or_default();
    let told = |from: usize, to: usize, title: &str, help: String| {
        Some(
            Diagnostic::new(Code::DeclarationSyntax, state.span(from..to), title)
                .label("a form of other languages")
                .help(help),
        )
    };
    let next = state.tokens.get(state.index_of(at.0) + 1);
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|digit| digit.is_ascii_digit());
    let opens = |bracket: char| state.text.get(..before.0).is_some_and(|text| text.trim_end().ends_with(bracket));
    match (&before.1, &at.1) {
        (Tok::Literal(_), Tok::RightBracket) if opens('[') && is_number(text(before)) => {
            let bound = text(before);
            told(
                before.0,
                before.2,
                "an array has a lower and an upper bound",
                format!("write `1..{bound}`, or another range"),
            )
        }
        (Tok::Literal(_), Tok::Literal(_)) if opens('[') && is_number(text(before)) => {
            let high = text(at).strip_prefix('-').map(str::trim).filter(|high| is_number(high))?;
            let help = format!("write `{}..{high}`", text(before));
            told(before.0, at.2, "the bounds of an array are separated by two dots", help)
        }
        (_, Tok::LeftParen) if text(before).eq_ignore_ascii_case("STRING") => {
            let length = next.map(text).filter(|length| is_number(length))?;
            told(at.0, at.2, "the length of a STRING is written in brackets", format!("write `STRING[{length}]`"))
        }
        _ => None,
    }
}

fn assignment_error(state: &State, at: Option<&Spanned>, before: Option<&Spanned>) -> Diagnostic {
    message(state, at, before, Code::Syntax, "assignment").help("write `component := constant;`, e.g. `a.b[3] := 5;`")
}

/// What an instruction accepts, for help texts, with addresses as the mnemonics of the file write them.
pub fn operand_phrase(class: crate::stl::OperandClass, set: Mnemonics) -> &'static str {
    use crate::stl::OperandClass;
    match class {
        OperandClass::None => "no operand",
        OperandClass::Bit => match set {
            Mnemonics::En => "one bit, e.g. `I 0.0`, a timer, a counter or a status bit",
            Mnemonics::De => "one bit, e.g. `E 0.0`, a timer, a counter or a status bit",
        },
        OperandClass::BitOrNone => match set {
            Mnemonics::En => "one bit, e.g. `I 0.0`, or nothing",
            Mnemonics::De => "one bit, e.g. `E 0.0`, or nothing",
        },
        OperandClass::BitWrite => "one bit, e.g. `M 0.0`",
        OperandClass::BitWriteOrCounter => "one bit, e.g. `M 0.0`, or a counter",
        OperandClass::BitWriteOrCell => "one bit, e.g. `M 0.0`, a timer or a counter",
        OperandClass::LoadSource => "a byte, word or double word, e.g. `MW 10`, or a constant",
        OperandClass::TransferTarget => "a byte, word or double word, e.g. `MW 10`",
        OperandClass::Timer => "a timer, e.g. `T 5`",
        OperandClass::Counter => match set {
            Mnemonics::En => "a counter, e.g. `C 5`",
            Mnemonics::De => "a counter, e.g. `Z 5`",
        },
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
