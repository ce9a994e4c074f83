//! Checks of an instruction and its operand that need no names: whether the operand is in the operand class of the table.

use plcc_diag::{Code, Diagnostic, Span};

use crate::article::with_article;
use crate::ast::{Area, BlockName, BlockPrefix, CellKind, Operand, OperandKind, Width};
use crate::literal::Literal;
use crate::stl::actions::NO_BIT;
use crate::stl::messages::operand_phrase;
use crate::stl::operand_form::{Form, describe, fits, form, width_name};
use crate::stl::{Mnemonics, OperandClass, StlInsn, operand_help};

/// Checks the operand of an instruction; a name fits everything. Messages have the mnemonics `set` of the file.
pub fn operand(
    text: &str,
    set: Mnemonics,
    insn: StlInsn,
    mnemonic: Span,
    operand: Option<&Operand>,
) -> Option<Diagnostic> {
    let class = insn.operand();
    let written = text[mnemonic.range()].to_owned();
    let Some(operand) = operand else {
        // `+` alone was meant as `-` and `*` are: an instruction with a type.
        let help = match insn {
            StlInsn::AddConst => {
                "write `+I` for INT, `+D` for DINT or `+R` for REAL, or the number that is added, as in `+ 5`"
                    .to_owned()
            }
            _ => format!("`{written}` takes {}", operand_phrase(class, set)),
        };
        return (!class.may_be_missing()).then(|| {
            Diagnostic::new(Code::MissingOperand, mnemonic, format!("`{written}` has no operand"))
                .label("an operand is missing after this")
                .help(help)
        });
    };
    let shown = &text[operand.span.range()];
    if class == OperandClass::None {
        return Some(
            Diagnostic::new(Code::SurplusOperand, operand.span, format!("`{written}` takes no operand"))
                .label("surplus operand")
                .also(mnemonic, "works on the accumulators or the RLO")
                .help(surplus_help(insn, &written, shown)),
        );
    }
    if let Some(diagnostic) = constant_range(insn, &written, shown, operand) {
        return Some(diagnostic);
    }
    if class == OperandClass::DataBlock && matches!(shown.to_ascii_uppercase().as_str(), "DB" | "DI") {
        return Some(
            Diagnostic::new(Code::MissingOperand, operand.span, format!("`{shown}` has no number"))
                .label("a number is missing after this")
                .help(format!("write e.g. `{shown} 5`, or `{shown} [MW 10]` for a number found at run time")),
        );
    }
    if fits(class, &operand.kind) {
        return None;
    }
    if class == OperandClass::DataBlock
        && let Some((block, part)) = shown.split_once('.')
        && block.get(..2).is_some_and(|letters| letters.eq_ignore_ascii_case("DB"))
    {
        return Some(
            Diagnostic::new(Code::OperandKind, operand.span, format!("`{written}` opens a whole data block"))
                .label(describe(&operand.kind))
                .help(format!("write `{written} {block}`, and `{part}` in the statements after it")),
        );
    }
    let (title, help) = mismatch(set, insn, &written, shown, operand);
    Some(
        Diagnostic::new(Code::OperandKind, operand.span, title)
            .label(describe(&operand.kind))
            .also(mnemonic, format!("takes {}", operand_phrase(class, set)))
            .help(help),
    )
}

/// Instructions of both sets that change the value in ACCU1.
const OF_ACCU1: [&str; 27] = [
    "ABS", "ACOS", "ASIN", "ATAN", "BTD", "BTI", "COS", "DTB", "DTR", "EXP", "INVD", "INVI", "ITB", "ITD", "LN", "MOD",
    "NEGD", "NEGI", "NEGR", "RND", "RND+", "RND-", "SIN", "SQR", "SQRT", "TAN", "TRUNC",
];

/// What to write for an instruction with an operand that it does not take. To remove the operand would be another program.
fn surplus_help(insn: StlInsn, written: &str, shown: &str) -> String {
    match insn {
        StlInsn::SetRlo => format!("write `S {shown}`, which sets the bit if the RLO is 1"),
        StlInsn::ClearRlo => format!("write `R {shown}`, which resets the bit if the RLO is 1"),
        StlInsn::Not => match shown.bytes().next().map(|letter| letter.to_ascii_uppercase()) {
            Some(b'E' | b'A' | b'Z') => format!("write `UN {shown}` or `ON {shown}`"),
            Some(b'I' | b'Q' | b'C') => format!("write `AN {shown}` or `ON {shown}`"),
            _ => format!("write `AN {shown}` (in German mnemonics `UN {shown}`) or `ON {shown}`"),
        },
        // `BE U`
        StlInsn::BlockEnd if matches!(shown.to_ascii_uppercase().as_str(), "U" | "C" | "A" | "B") => {
            format!("write `{written}{}`, as one word", shown.to_ascii_uppercase())
        }
        _ if written.starts_with(['+', '-', '*', '/', '<', '>', '='])
            || OF_ACCU1.iter().any(|own| own.eq_ignore_ascii_case(written)) =>
        {
            format!("write `L {shown}` on the line before, and `{written}` alone")
        }
        _ => match written.strip_suffix('(').map(str::trim_end) {
            Some(single) => format!(
                "write `{single} {shown}` for one operand; several have lines of their own between `{written}` and `)`"
            ),
            None => format!("write `{written}` alone, or another instruction"),
        },
    }
}

/// Checks target and instance of a CALL.
pub fn call(text: &str, keyword: Span, target: &Operand, instance: Option<&Operand>) -> Option<Diagnostic> {
    let callable = match &target.kind {
        OperandKind::Block(BlockName::Numbered { prefix, .. }) => {
            matches!(prefix, BlockPrefix::Fc | BlockPrefix::Fb | BlockPrefix::Sfc | BlockPrefix::Sfb)
        }
        OperandKind::Block(BlockName::Symbol { .. }) | OperandKind::Path(_) | OperandKind::Error => true,
        _ => false,
    };
    if !callable {
        let shown = &text[target.span.range()];
        let other =
            instance.filter(|instance| matches!(form(&instance.kind), Form::Block(BlockPrefix::Fb | BlockPrefix::Sfb)));
        let help = match other {
            Some(block) => {
                format!("write `CALL {}, {shown}`: the block comes before its data", &text[block.span.range()])
            }
            None if matches!(form(&target.kind), Form::Block(BlockPrefix::Ob)) => {
                "the CPU itself calls the organization blocks: put what several blocks do into an FC, and call that"
                    .to_owned()
            }
            // `CALL t1` for an instance `t1`
            None if matches!(target.kind, OperandKind::Cell { .. }) => {
                format!("an instance of the block has `#` before its name: write `CALL #{shown}`")
            }
            None if matches!(form(&target.kind), Form::Block(BlockPrefix::Db)) => {
                format!("write the function block before its data: `CALL FB …, {shown}`")
            }
            None => "write e.g. `CALL FC 1` or `CALL FB 1, DB 1`".to_owned(),
        };
        return Some(
            Diagnostic::new(Code::OperandKind, target.span, format!("`{shown}` is not a block that `CALL` can call"))
                .label(describe(&target.kind))
                .also(keyword, "calls an FC, FB, SFC or SFB")
                .help(help),
        );
    }
    let instance = instance?;
    let data_block = match &instance.kind {
        OperandKind::Block(BlockName::Numbered { prefix, .. }) => *prefix == BlockPrefix::Db,
        OperandKind::Block(BlockName::Symbol { .. }) | OperandKind::Path(_) | OperandKind::Error => true,
        _ => false,
    };
    (!data_block).then(|| {
        let shown = &text[instance.span.range()];
        // `CALL FB 1, DB 1.DBX 0.0`
        let data = shown.split('.').next().filter(|data| data.get(..2).is_some_and(|db| db.eq_ignore_ascii_case("DB")));
        let help = format!("write `CALL {}, {}`", &text[target.span.range()], data.unwrap_or("DB …"));
        Diagnostic::new(Code::OperandKind, instance.span, format!("`{shown}` is not an instance data block"))
            .label(describe(&instance.kind))
            .help(help)
    })
}

/// Checks that an address has a bit number exactly if its letters name a bit.
pub fn address(text: &str, span: Span, width: Width, byte: u32, bit: u8) -> Option<Diagnostic> {
    let shown = &text[span.range()];
    match (width, bit) {
        (Width::Bit, NO_BIT) => {
            let digits = shown.find(|c: char| c.is_ascii_digit()).map_or("", |at| &shown[at..]);
            let letters = shown.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end();
            let help = match digits.strip_prefix('0') {
                Some(bit) if bit.len() == 1 => format!("write `{letters} 0.{bit}`"),
                _ if letters.ends_with(['X', 'x']) && letters.contains('.') => {
                    let block = &letters[..letters.len() - 1];
                    format!("write `{letters}{byte}.0` for a bit, `{block}B{byte}` for a byte")
                }
                _ if letters.ends_with(['X', 'x']) => {
                    let block = &letters[..letters.len() - 1];
                    format!("write `{letters} {byte}.0` for a bit, `{block} {byte}` for a data block")
                }
                _ => format!("write `{letters} {byte}.0` for a bit, `{letters}B {byte}` for a byte"),
            };
            Some(
                Diagnostic::new(Code::Syntax, span, format!("`{shown}` names a bit, but not its number"))
                    .label("the bit number is missing")
                    .help(help),
            )
        }
        (Width::Bit, _) | (_, NO_BIT) => None,
        _ => Some(
            Diagnostic::new(Code::Syntax, span, format!("`{shown}` has a bit number, but does not name a bit"))
                .label("bytes, words and double words are addressed by their first byte")
                .help(match bit_address(shown) {
                    Some(address) => format!("remove `.{bit}`, or write `{address}` for the bit"),
                    None => format!("remove `.{bit}`, or name the bit without the letter of the width"),
                }),
        ),
    }
}

/// `DB1.DBX0.1` for `DB1.DBW0.1`, `M 0.1` for `MW 0.1`.
fn bit_address(text: &str) -> Option<String> {
    let point = text.rfind('.')?;
    let digits = text[..point].trim_end_matches(|c: char| c.is_ascii_digit());
    let letters = digits.trim_end();
    let area = letters.strip_suffix(['B', 'W', 'D', 'b', 'w', 'd'])?;
    // The bits of peripheral words are in the process image.
    let area = if area.len() == 2 { area.trim_start_matches(['P', 'p']) } else { area };
    let bit = if area.ends_with(['B', 'b', 'I', 'i']) && area.len() > 1 { "X" } else { "" };
    (!area.is_empty()).then(|| format!("{area}{bit}{}{}", &digits[letters.len()..], &text[digits.len()..]))
}

/// A constant of the right kind that is outside the range of the instruction.
fn constant_range(insn: StlInsn, written: &str, shown: &str, operand: &Operand) -> Option<Diagnostic> {
    let OperandKind::Literal(Literal::Int(number)) = operand.kind else { return None };
    let class = insn.operand();
    let size = if number < 0 { "small" } else { "large" };
    let range = |code, label: &str, help: String| {
        Some(
            Diagnostic::new(code, operand.span, format!("`{shown}` is too {size} for `{written}`"))
                .label(label)
                .help(help),
        )
    };
    match class {
        OperandClass::LoadSource | OperandClass::AddConstant | OperandClass::WordConstOrNone
            if i16::try_from(number).is_err() =>
        {
            let help = match u16::try_from(number) {
                Ok(word) if class != OperandClass::AddConstant => format!("write `L#{number}` or `W#16#{word:X}`"),
                _ => format!("write `L#{number}` for a DINT"),
            };
            Some(
                Diagnostic::new(Code::LiteralRange, operand.span, format!("`{shown}` is outside the range of INT"))
                    .label("an INT is a number from -32768 to 32767")
                    .help(help),
            )
        }
        OperandClass::Byte if insn == StlInsn::Nop && !(0..=1).contains(&number) => {
            range(Code::LiteralRange, "not 0 or 1", format!("write `{written} 0` or `{written} 1`, which do nothing"))
        }
        OperandClass::Byte
            if matches!(insn, StlInsn::Increment | StlInsn::Decrement) && (-255..0).contains(&number) =>
        {
            let other = if insn == StlInsn::Increment { "DEC" } else { "INC" };
            Some(
                Diagnostic::new(Code::LiteralRange, operand.span, format!("the number of `{written}` has no sign"))
                    .label("below 0")
                    .help(format!("write `{other} {}`", -number)),
            )
        }
        OperandClass::Byte if !(0..=255).contains(&number) => {
            range(Code::LiteralRange, "not a byte", "write a number from 0 to 255".to_owned())
        }
        OperandClass::ShiftCount16 if !(0..=15).contains(&number) => range(
            Code::ShiftCount,
            "16-bit shifts take 0 to 15",
            format!("write a count from 0 to 15, or load the count and write `{written}` alone"),
        ),
        OperandClass::ShiftCount32 if !(0..=32).contains(&number) => range(
            Code::ShiftCount,
            "32-bit shifts take 0 to 32",
            format!("write a count from 0 to 32, or load the count and write `{written}` alone"),
        ),
        _ => None,
    }
}

/// Title and help for an operand of the wrong kind.
fn mismatch(set: Mnemonics, insn: StlInsn, written: &str, shown: &str, operand: &Operand) -> (String, String) {
    let class = insn.operand();
    let takes = format!("`{written}` takes {}", operand_phrase(class, set));
    let bit_class = matches!(
        class,
        OperandClass::Bit
            | OperandClass::BitOrNone
            | OperandClass::BitWrite
            | OperandClass::BitWriteOrCounter
            | OperandClass::BitWriteOrCell
    );
    match (&operand.kind, form(&operand.kind)) {
        (OperandKind::Literal(Literal::Bool(_)), _) if bit_class => (
            format!("`{written}` takes an address, not `{shown}`"),
            "write `SET` for RLO 1, `CLR` for RLO 0".to_owned(),
        ),
        (OperandKind::Literal(Literal::Bool(value)), _) if class == OperandClass::LoadSource => (
            format!("`{shown}` is one bit, but `{written}` loads bytes, words and double words"),
            format!(
                "write `{}` for the RLO, `{written} {}` for a number",
                if *value { "SET" } else { "CLR" },
                u8::from(*value)
            ),
        ),
        (_, Form::Memory(_, width @ (Width::Byte | Width::Word | Width::Dword))) if bit_class => {
            let address = shown.trim_start_matches(|c: char| c.is_ascii_alphabetic()).trim();
            // The bits of peripheral words are in the process image.
            let letter = shown.trim_start_matches(['P', 'p']).chars().next().unwrap_or('M');
            let part = shown.rsplit_once('.').filter(|(_, part)| matches!(part.get(..2), Some("DB" | "db")));
            let one_bit = if let Some((block, part)) = part {
                let number = part.trim_start_matches(|c: char| c.is_ascii_alphabetic()).trim();
                format!("`{block}.{}X{number}.0`", &part[..2])
            } else if address.starts_with(|c: char| c.is_ascii_digit()) && !shown.contains('.') {
                if matches!(letter, 'D' | 'd') {
                    format!("`{}X {address}.0`", &shown[..2])
                } else {
                    format!("`{letter} {address}.0`")
                }
            } else {
                "`M 10.0`".to_owned()
            };
            let combine = match (insn, width) {
                (StlInsn::Xor, Width::Word) => ", or use `XOW` to combine words in ACCU1".to_owned(),
                (StlInsn::Xor, Width::Dword) => ", or use `XOD` to combine double words in ACCU1".to_owned(),
                (StlInsn::And | StlInsn::Or, Width::Word) => {
                    format!(", or use `{written}W` to combine words in ACCU1")
                }
                (StlInsn::And | StlInsn::Or, Width::Dword) => {
                    format!(", or use `{written}D` to combine double words in ACCU1")
                }
                (StlInsn::Assign, _) => ", or use `T` to transfer ACCU1".to_owned(),
                _ => String::new(),
            };
            (
                format!(
                    "`{written}` works on one bit, but `{shown}` is {}",
                    with_article(&format!("{}-bit {}", width.bits(), width_name(width)))
                ),
                format!("name one bit, e.g. {one_bit}{combine}"),
            )
        }
        (_, Form::Memory(_, Width::Bit))
            if matches!(class, OperandClass::LoadSource | OperandClass::TransferTarget) =>
        {
            (format!("`{written}` moves bytes, words and double words, but `{shown}` is one bit"), {
                let single = if insn == StlInsn::Load { StlInsn::And } else { StlInsn::Assign };
                let bit = format!("{} {shown}", single.mnemonic(set));
                match wide_addresses(shown) {
                    Some((byte, word)) => format!("name `{byte}` or `{word}`, or use `{bit}` for the bit"),
                    None if matches!(operand.kind, OperandKind::RegisterIndirect { area: None, .. }) => format!(
                        "write `{written} B {shown}`, `{written} W {shown}` or `{written} D {shown}`, or use `{bit}` for the bit"
                    ),
                    None => format!("name a byte, word or double word, or use `{bit}` for the bit"),
                }
            })
        }
        (_, Form::Memory(_, width @ (Width::Word | Width::Dword))) if class == OperandClass::AddConstant => {
            let add = match width == Width::Dword {
                true => format!("`{written}D`, or `{written}R` for REAL"),
                false => format!("`{written}I`"),
            };
            (
                format!("`{written}` adds a constant, not a value in memory"),
                format!("write `L {shown}` in the line before, and here {add}"),
            )
        }
        (_, Form::Memory(Some(Area::Pi), _)) if class == OperandClass::TransferTarget => (
            format!("`{shown}` is a peripheral input and cannot be written"),
            match set {
                Mnemonics::En => "write to the output side, e.g. `PQW 256`",
                Mnemonics::De => "write to the output side, e.g. `PAW 256`",
            }
            .to_owned(),
        ),
        (_, Form::Memory(Some(Area::Pq), _)) if class == OperandClass::LoadSource => (
            format!("`{shown}` is a peripheral output and cannot be read"),
            match set {
                Mnemonics::En => "read the process image, e.g. `QW 4`, or the input side `PIW`",
                Mnemonics::De => "read the process image, e.g. `AW 4`, or the input side `PEW`",
            }
            .to_owned(),
        ),
        (OperandKind::Literal(Literal::Text(_)), _) if class == OperandClass::LoadSource => (
            format!("`{shown}` does not fit into ACCU1"),
            "`L` takes a text of one to four characters; copy longer ones with SFC 20 BLKMOV".to_owned(),
        ),
        (OperandKind::Literal(Literal::AreaPointer { db, .. }), _) if *db != 0 => (
            format!("`{shown}` does not fit into 32 bits: there is no room for the number of the data block"),
            format!(
                "write the pointer without it, e.g. `P#DBX 0.0`, and open the block with `{} DB {db}`",
                StlInsn::OpenDb.mnemonic(set)
            ),
        ),
        (OperandKind::Cell { kind: CellKind::Timer, .. }, _) if matches!(insn, StlInsn::Set | StlInsn::Assign) => (
            format!("`{shown}` is not an operand of `{written}`"),
            match set {
                Mnemonics::En => {
                    format!("a timer is started with `SD {shown}`, or SP, SE, SS or SF, after its time is loaded")
                }
                Mnemonics::De => {
                    format!("a timer is started with `SE {shown}`, or SI, SV, SS or SA, after its time is loaded")
                }
            },
        ),
        _ => {
            let help = operand_help::of(set, insn, written, shown, operand);
            (format!("`{shown}` is not an operand of `{written}`"), help.unwrap_or(takes))
        }
    }
}

/// The byte and the word that contain a bit: `IB 0` and `IW 0` for `I 0.3`.
fn wide_addresses(bit: &str) -> Option<(String, String)> {
    let (letters, number) = bit.split_at(bit.find(|c: char| c.is_ascii_digit())?);
    let byte = number.split_once('.')?.0;
    let (area, blank) = (letters.trim_end(), &letters[letters.trim_end().len()..]);
    let is_area = area.len() == 1 && area.bytes().all(|letter| letter.is_ascii_alphabetic());
    is_area.then(|| (format!("{area}B{blank}{byte}"), format!("{area}W{blank}{byte}")))
}
