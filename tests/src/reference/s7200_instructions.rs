//! The instructions of the reference page of the S7-200, printed from the instruction table.

use std::fmt::Write as _;

use plcc_syntax::s7200::{ALIASES, Acts, BOXES, Compare, CompareKind, Contact, Insn, OperandClass, Relation};
use plcc_syntax::stl::Mnemonics;

/// A family of instructions: heading, section of the manual, first and last row.
///
/// Source: S7-200 system manual, chapter "S7-200 Instruction Set".
const FAMILIES: &[(&str, &str, Insn, Insn)] = &[
    ("Bit logic", "Bit Logic Instructions", Insn::Load, Insn::ResetNow),
    ("Logic stack", "Bit Logic Instructions: Logic Stack Instructions", Insn::AndLoad, Insn::Nop),
    ("Timers", "Timer Instructions", Insn::Ton, Insn::Interval),
    ("Counters", "Counter Instructions", Insn::Ctu, Insn::Ctud),
    ("High-speed counters", "High-Speed Counter Instructions", Insn::Hdef, Insn::Hsc),
    ("Pulse outputs", "Pulse Output Instruction", Insn::Pls, Insn::Pls),
    ("Mathematics", "Math Instructions", Insn::AddI, Insn::Exp),
    ("PID loops", "Proportional/Integral/Derivative (PID) Loop Instruction", Insn::Pid, Insn::Pid),
    ("Moves", "Move Instructions", Insn::MovB, Insn::Biw),
    ("Logical operations", "Logical Operations Instructions", Insn::InvB, Insn::XorD),
    ("Shift and rotate", "Shift and Rotate Instructions", Insn::ShiftRightB, Insn::ShiftRegister),
    ("Tables", "Table Instructions", Insn::Att, Insn::FindGreater),
    ("Conversion", "Conversion Instructions", Insn::Bti, Insn::Str),
    ("Strings", "String Instructions", Insn::Slen, Insn::Cfnd),
    ("Program control", "Program Control Instructions", Insn::End, Insn::Next),
    ("Sequence control relays", "Program Control Instructions: SCR Instructions", Insn::Lscr, Insn::Scre),
    ("Subroutines", "Subroutine Instructions", Insn::Call, Insn::Ret),
    ("Diagnostic LED", "Program Control Instructions", Insn::Dled, Insn::Dled),
    ("Interrupts", "Interrupt Instructions", Insn::Atch, Insn::Reti),
    ("Communication", "Communications Instructions", Insn::Netr, Insn::Spa),
    ("Clock", "Clock Instructions", Insn::Todr, Insn::Todwx),
];

/// Words for operands whose name is not enough, with what they accept.
const OPERANDS: &[(&str, &str)] = &[
    ("bit", "I Q V M SM S T C L: `I0.0`, `V100.5`, `T37`; to write: none of the read-only special memory"),
    ("byte", "IB QB VB MB SMB SB LB, AC, a pointer (`*VD200`, `*LD4`, `*AC1`), a constant"),
    ("word", "IW QW VW MW SMW SW LW, T, C, AIW, AC, a pointer, a constant"),
    (
        "INT, DINT",
        "as a word or double word; a decimal constant has a sign: -32768 to 32767, -2147483648 to 2147483647",
    ),
    ("double word", "ID QD VD MD SMD SD LD, HC, AC, a pointer, a constant"),
    ("REAL", "ID QD VD MD SMD SD LD, AC, a pointer, a constant"),
    ("… to write", "the same without constants, AIW and HC"),
    ("string", "VB, LB, a pointer, a text in double quotes; to write: no text"),
    ("buffer, first byte", "IB QB VB MB SMB SB LB, a pointer"),
    ("table", "IW QW VW MW SMW SW LW, T, C, a pointer"),
    ("first word", "as a table; AIW is read and AQW written too"),
    ("first double word", "ID QD VD MD SMD SD LD, a pointer"),
];

/// The instructions in Markdown, the first part of `docs/reference/s7-200.md`.
pub fn reference() -> String {
    let mut page = String::from(
        "# S7-200 instructions\n\n\
         Printed from the tables of instructions, CPUs, events and errors; do not edit.\n\n\
         **S0**: an instruction acts *always*, or *if 1*: if the top of the logic stack is 1, which is its EN. **SM1**: bits of SMB1\n\
         that it writes: 0 zero, 1 overflow, illegal value or last bit shifted out, 2 negative, 3 division by zero, 4 table full,\n\
         5 table empty, 6 not a BCD value, 7 not hexadecimal. **ENO**: `-` it has none; otherwise ENO is 0 where EN is 0, on a bad\n\
         pointer (0006), on errors of its own, and if this bit of SM1 is 1, or on these errors: *range* (0091; a count 0092), *index* (009B),\n\
         *format* (an illegal format byte), *nesting* (0008).\n\n\
         | operand | takes |\n| --- | --- |\n",
    );
    for (name, takes) in OPERANDS {
        let _ = writeln!(page, "| {name} | {takes} |");
    }
    for (heading, section, first, last) in FAMILIES {
        let _ = write!(
            page,
            "\n## {heading}\n\nSource: S7-200 system manual, {section}.\n\n\
             | international | German | operands | S0 | SM1 | ENO | effect |\n| --- | --- | --- | --- | --- | --- | --- |\n"
        );
        for insn in Insn::ROWS.iter().filter(|insn| (*first..=*last).contains(insn)) {
            let operands: Vec<String> = insn.operands().iter().map(|class| phrase(*class)).collect();
            let _ = writeln!(
                page,
                "| `{}` | `{}` | {} | {} | {} | {} | {} |",
                insn.mnemonic(Mnemonics::En),
                insn.mnemonic(Mnemonics::De),
                operands.join(", "),
                match insn.acts() {
                    Acts::Always => "always",
                    Acts::Enabled => "if 1",
                    Acts::Marker => "marker",
                },
                flags(insn.flags()),
                eno(insn.eno()),
                insn.doc().trim(),
            );
        }
    }
    write_comparisons(&mut page);
    write_other_names(&mut page);
    page
}

fn write_comparisons(page: &mut String) {
    page.push_str(
        "\n## Compare contacts\n\nSource: S7-200 system manual, Compare Instructions.\n\n\
         `LD…` pushes the result, `A…` (German `U…`) and `O…` combine it with S0. They act always and have no ENO. A bad pointer stops the CPU\n\
         (0011), and so does a string that leaves its memory (0014); a REAL that is not a number compares as false (000F), or stops the CPU (0012) where\n\
         plc.toml has `strict_compare`. Older texts write `LDDW=` for `LDD=`; that is accepted too.\n\n\
         | operands | international | German | relations |\n| --- | --- | --- | --- |\n",
    );
    for kind in CompareKind::ALL {
        let of_kind = |set: Mnemonics| {
            let names = [Contact::Load, Contact::And, Contact::Or].map(|contact| {
                let compare = Compare { contact, kind, relation: Relation::Eq };
                format!("`{}`", compare.mnemonic(set).trim_end_matches('='))
            });
            names.join(" ")
        };
        let relations: Vec<String> = Compare::all()
            .filter(|compare| compare.kind == kind && compare.contact == Contact::Load)
            .map(|compare| format!("`{}`", compare.relation.sign()))
            .collect();
        let what = match kind {
            CompareKind::Byte => "bytes, unsigned",
            CompareKind::Word => "words, signed",
            CompareKind::Dword => "double words, signed",
            CompareKind::Real => "REALs",
            CompareKind::Text => "strings, letter by letter",
        };
        let (en, de) = (of_kind(Mnemonics::En), of_kind(Mnemonics::De));
        let _ = writeln!(page, "| {what} | {en} | {de} | {} |", relations.join(" "));
    }
}

fn write_other_names(page: &mut String) {
    page.push_str(
        "\n## Other names\n\nBoxes of LAD and FBD whose operands have the order of the instruction, and other spellings; they are accepted.\n\n\
         | name | instruction |\n| --- | --- |\n",
    );
    for (alias, mnemonic) in ALIASES {
        let _ = writeln!(page, "| `{alias}` | `{mnemonic}` |");
    }
    page.push_str(
        "\nBoxes whose pins have another order: they are errors, whose message names the statement.\n\n\
         | box | statement |\n| --- | --- |\n",
    );
    for (name, statement) in BOXES {
        let _ = writeln!(page, "| `{name}` | `{statement}` |");
    }
}

/// An operand in words.
fn phrase(class: OperandClass) -> String {
    use OperandClass as C;
    let text = match class {
        C::Bit => "bit",
        C::BitWrite => "bit to write",
        C::InputBit => "input bit",
        C::OutputBit => "output bit",
        C::SBit => "S bit",
        C::ByteIn => "byte",
        C::ByteOut => "byte to write",
        C::WordIn => "word",
        C::IntIn => "INT",
        C::WordOut => "word to write",
        C::WordOutAnalog => "word or AQW to write",
        C::DwordIn => "double word",
        C::DintIn => "DINT",
        C::DwordInAddress => "double word or address (`&VB100`)",
        C::DwordOut => "double word to write",
        C::RealIn => "REAL",
        C::RealOut => "REAL to write",
        C::StringIn => "string",
        C::StringOut => "string to write",
        C::Buffer => "buffer",
        C::Table => "table",
        C::BytesIn => "first byte",
        C::BytesOut => "first byte to write",
        C::WordsIn => "first word",
        C::WordsOut => "first word to write",
        C::DwordsIn => "first double word",
        C::DwordsOut => "first double word to write",
        C::Count => "count (byte)",
        C::SignedCount => "signed count (byte)",
        C::Timer => "T0 to T255",
        C::Counter => "C0 to C255",
        C::Number(most) => return format!("constant 0 to {most}"),
        C::Label => "label 0 to 255",
        C::LoopTable => "loop table in V",
        C::InputByte => "input byte",
        C::OutputByte => "output byte",
        C::Subroutine => "subroutine, its parameters",
        C::Interrupt => "interrupt routine",
    };
    text.to_owned()
}

/// Numbers of bits of SMB1.
fn flags(letters: &str) -> String {
    letters.split_whitespace().map(|letter| bit(letter).unwrap_or(letter)).collect::<Vec<_>>().join(" ")
}

fn bit(letter: &str) -> Option<&'static str> {
    ["Z", "V", "N", "D"].iter().zip(["0", "1", "2", "3"]).find(|(known, _)| **known == letter).map(|(_, bit)| bit)
}

/// When ENO is 0.
fn eno(words: &str) -> String {
    if words == "-" {
        return "`-`".to_owned();
    }
    let reason = |word: &str| match word {
        "Yes" => "yes".to_owned(),
        "Z" | "V" | "N" | "D" | "4" | "5" | "6" | "7" => format!("SM1.{}", bit(word).unwrap_or(word)),
        _ => word.to_lowercase(),
    };
    words.split_whitespace().map(reason).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_hold_each_row_once() {
        let mut listed: Vec<&Insn> = Vec::new();
        for (_, _, first, last) in FAMILIES {
            listed.extend(Insn::ROWS.iter().filter(|insn| (*first..=*last).contains(insn)));
        }
        assert_eq!(listed, Insn::ROWS.iter().collect::<Vec<_>>());
    }

    #[test]
    fn columns_in_words() {
        assert_eq!(flags("Z V N D"), "0 1 2 3");
        assert_eq!(flags("4"), "4");
        assert_eq!(eno("V D"), "SM1.1, SM1.3");
        assert_eq!(eno("4 Range"), "SM1.4, range");
        assert_eq!(eno("Yes"), "yes");
    }

    #[test]
    fn every_row_has_cells_without_bars() {
        let columns = |line: &str| line.matches('|').count();
        let mut wanted = 0;
        for line in reference().lines() {
            if line.starts_with("| ---") {
                wanted = columns(line);
            } else if line.starts_with('|') && wanted > 0 {
                assert_eq!(columns(line), wanted, "{line}");
            } else if !line.starts_with('|') {
                wanted = 0;
            }
        }
    }
}
