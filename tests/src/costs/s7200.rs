//! A sequence for each instruction of the S7-200, and the programs that run them.

use std::fmt::Write as _;

use plcc_syntax::s7200::{Acts, Compare, Contact, Insn, OperandClass};
use plcc_syntax::stl::Mnemonics;

use super::Row;

/// Instructions that end the scan or the program, or that end every routine.
const ENDS: &[Insn] = &[Insn::End, Insn::Mend, Insn::Stop, Insn::Creti, Insn::Reti, Insn::Ret];

/// The rows of the instruction table, then the compare contacts.
pub fn rows() -> Vec<Row> {
    let rows = Insn::ROWS.iter().filter(|insn| !ENDS.contains(insn));
    let contacts = Compare::all().map(|compare| {
        let name = compare.mnemonic(Mnemonics::En);
        let operands = operands(Insn::Compare(compare));
        let before = if compare.contact == Contact::Load { "" } else { "LD V0.0; " };
        Row::new("S7-200", &name, &format!("{before}{name} {operands}; = V300.0"))
    });
    rows.map(|&insn| Row::new("S7-200", insn.row(), &sequence(insn))).chain(contacts).collect()
}

/// The rows without a sequence.
pub fn without_sequence() -> Vec<&'static str> {
    ENDS.iter().map(|insn| insn.row()).collect()
}

fn sequence(insn: Insn) -> String {
    use Insn as I;
    let name = insn.mnemonic(Mnemonics::En);
    let step = |end: &str| format!("LD SM0.0; S S{{s}}, 1; LSCR S{{s}}; LD V0.0; {end}; SCRE");
    match insn {
        I::Load | I::LoadNot => format!("{name} V0.0; = V300.0"),
        I::LoadNow | I::LoadNotNow => format!("{name} I0.0; = V300.0"),
        I::AndLoad | I::OrLoad => format!("LD V0.0; O V1.1; LD V2.2; O V3.3; {name}; = V300.0"),
        I::Push | I::Read | I::Pop => {
            "LD V0.0; LPS; A V1.1; = V300.0; LRD; A V2.2; = V301.0; LPP; A V3.3; = V302.0".to_string()
        }
        I::LoadStack => "LD V0.0; LD V1.1; LDS 1; ALD; = V300.0".to_string(),
        I::AndEno => "LD SM0.0; MOVW VW8, VW300; AENO; = V302.0".to_string(),
        I::Not | I::RisingEdge | I::FallingEdge => format!("LD V0.0; {name}; = V300.0"),
        I::Assign => "LD V0.0; = V300.0".to_string(),
        I::AssignNow => "LD V0.0; =I Q0.0".to_string(),
        I::Ctu | I::Ctd => format!("LD V0.0; LD V1.1; {name} C{{n}}, 10"),
        I::Ctud => "LD V0.0; LD V1.1; LD V2.2; CTUD C{n}, 10".to_string(),
        I::Ton | I::Tonr | I::Tof => {
            let timer = match insn {
                I::Tonr => "T5",
                I::Ton => "T40",
                _ => "T41",
            };
            format!("LD V0.0; {name} {timer}, 5; LD {timer}; = V300.0")
        }
        I::Hdef => "LD SM0.1; HDEF 0, 0".to_string(),
        I::Jmp | I::Lbl => "LD V0.0; JMP 1; LD SM0.0; MOVW VW8, VW300; LBL 1".to_string(),
        I::For | I::Next => "LD SM0.0; FOR VW{p}, 1, 10; LD SM0.0; INCW VW300; NEXT".to_string(),
        I::Lscr | I::Scre => "LD SM0.0; S S{s}, 1; LSCR S{s}; LD SM0.0; = V300.0; SCRE".to_string(),
        I::Scrt => step("SCRT S31.0"),
        I::Cscre => step("CSCRE"),
        I::Call => "LD SM0.0; CALL Helper".to_string(),
        I::Cret => "LD V0.0; CRET; LD SM0.0; MOVW VW8, VW300".to_string(),
        I::Pid => "LD SM0.0; PID VB5900, 0".to_string(),
        I::Nop => "NOP 0".to_string(),
        _ => {
            let start = match insn.acts() {
                Acts::Enabled => "LD SM0.0",
                Acts::Always | Acts::Marker => "LD V0.0",
            };
            let end = if insn.acts() == Acts::Always { "; = V300.0" } else { "" };
            format!("{start}; {name} {}{end}", operands(insn))
        }
    }
}

fn operands(insn: Insn) -> String {
    let classes = insn.operands();
    let texts = classes.contains(&OperandClass::StringIn);
    let format = matches!(insn, Insn::Ita | Insn::Dta | Insn::Rta | Insn::Its | Insn::Dts | Insn::Rts);
    // A second operand of the same kind is another one.
    let list: Vec<String> = classes
        .iter()
        .enumerate()
        .map(|(at, class)| match class {
            _ if at > 0 && classes[0] == *class && second(*class).is_some() => {
                second(*class).unwrap_or_default().to_string()
            }
            OperandClass::Bit => "V1.1".to_string(),
            OperandClass::BitWrite => "V{p}.0".to_string(),
            OperandClass::InputBit => "I0.1".to_string(),
            OperandClass::OutputBit => "Q0.0".to_string(),
            OperandClass::SBit => "S1.0".to_string(),
            OperandClass::ByteIn if texts => "1".to_string(),
            OperandClass::ByteIn if format => "16#51".to_string(),
            OperandClass::ByteIn if classes.contains(&OperandClass::Buffer) => "4".to_string(),
            OperandClass::ByteIn => "VB4".to_string(),
            OperandClass::ByteOut => "VB{p}".to_string(),
            OperandClass::WordIn | OperandClass::IntIn => "VW8".to_string(),
            OperandClass::WordOut | OperandClass::WordOutAnalog => "VW{p}".to_string(),
            OperandClass::DwordIn | OperandClass::DintIn | OperandClass::DwordInAddress => "VD12".to_string(),
            OperandClass::DwordOut | OperandClass::RealOut => "VD{p}".to_string(),
            OperandClass::RealIn => "VD200".to_string(),
            OperandClass::StringIn => "VB220".to_string(),
            OperandClass::StringOut => "VB5000".to_string(),
            OperandClass::Buffer => "VB5300".to_string(),
            OperandClass::Table => "VW5600".to_string(),
            OperandClass::BytesIn => "VB20".to_string(),
            OperandClass::BytesOut => "VB5000".to_string(),
            OperandClass::WordsIn => "VW20".to_string(),
            OperandClass::WordsOut => "VW5000".to_string(),
            OperandClass::DwordsIn => "VD20".to_string(),
            OperandClass::DwordsOut => "VD5000".to_string(),
            OperandClass::Count => "4".to_string(),
            OperandClass::SignedCount => "16".to_string(),
            OperandClass::Timer => "T40".to_string(),
            OperandClass::Counter => "C{n}".to_string(),
            OperandClass::Number(33) => "10".to_string(),
            OperandClass::Number(_) => "0".to_string(),
            OperandClass::Label => "1".to_string(),
            OperandClass::LoopTable => "VB5900".to_string(),
            OperandClass::InputByte => "IB0".to_string(),
            OperandClass::OutputByte => "QB0".to_string(),
            OperandClass::Subroutine => "Helper".to_string(),
            OperandClass::Interrupt => "Tick".to_string(),
        })
        .collect();
    list.join(", ")
}

/// The second operand of a comparison or a search.
fn second(class: OperandClass) -> Option<&'static str> {
    match class {
        OperandClass::ByteIn => Some("VB40"),
        OperandClass::WordIn | OperandClass::IntIn => Some("VW40"),
        OperandClass::DwordIn | OperandClass::DintIn => Some("VD40"),
        OperandClass::RealIn => Some("VD204"),
        OperandClass::StringIn => Some("VB240"),
        _ => None,
    }
}

/// A program with `blocks`, subroutines by number with their sequences. Its main program fills VB 0 to 199 with other values in each scan,
/// VD200 to VD208 with REALs, VB220 and VB240 with strings, VW5600 with a table of three words, and calls all, or 1000 times that of VW9002.
pub fn source(blocks: Vec<(usize, String)>) -> String {
    let last = blocks.len() + 1;
    let mut text = String::from(MAIN);
    for number in 1..=last {
        writeln!(text, "LDW= VW9002, 0\nCALL R{number}").expect("a string takes all");
    }
    text.push_str("LDW<> VW9002, 0\nFOR VW9004, 1, 1000\n");
    for number in 1..=last {
        writeln!(text, "LDW= VW9002, {number}\nCALL R{number}").expect("a string takes all");
    }
    text.push_str("NEXT\nEND_ORGANIZATION_BLOCK\n");
    for (number, sequence) in [(1, String::new())].into_iter().chain(blocks) {
        writeln!(text, "SUBROUTINE_BLOCK R{number}:SBR{number}\nBEGIN\nNETWORK 1").expect("a string takes all");
        sequence.split("; ").filter(|line| !line.is_empty()).for_each(|line| text.push_str(&format!("{line}\n")));
        text.push_str("END_SUBROUTINE_BLOCK\n");
    }
    text.push_str(
        "SUBROUTINE_BLOCK Helper:SBR0\nBEGIN\nNETWORK 1\nLD SM0.0\nMOVW VW8, VW304\nEND_SUBROUTINE_BLOCK\n\
         INTERRUPT_BLOCK Tick:INT0\nBEGIN\nNETWORK 1\nLD SM0.0\nINCW VW306\nEND_INTERRUPT_BLOCK\n",
    );
    text
}

const MAIN: &str = "ORGANIZATION_BLOCK MAIN:OB1
BEGIN
NETWORK 1
LD SM0.1
MOVD 16#12345678, VD9010
SCPY \"12.5 kg\", VB220
SCPY \"kg\", VB240
LD SM0.0
MOVW 50, VW5600
MOVW 3, VW5602
MOVD &VB0, AC1
FOR VW9006, 1, 50
LD SM0.0
MOVD VD9010, AC2
SLD AC2, 13
XORD AC2, VD9010
MOVD VD9010, AC2
SRD AC2, 17
XORD AC2, VD9010
MOVD VD9010, AC2
SLD AC2, 5
XORD AC2, VD9010
MOVD VD9010, *AC1
+D 4, AC1
NEXT
LD SM0.0
MOVW VW0, AC0
ANDW 16#7FFF, AC0
ITD AC0, AC0
DTR AC0, VD200
/R 80.0, VD200
MOVW VW4, AC0
ANDW 16#7FFF, AC0
ITD AC0, AC0
DTR AC0, VD204
/R 80.0, VD204
";
