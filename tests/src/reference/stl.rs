//! The reference page of STL, printed from the instruction table.

use std::fmt::Write as _;

use plcc_syntax::stl::{Mnemonics, StlInsn, operand_phrase};

/// A family of instructions: heading, chapter of the reference manual, first and last row.
///
/// Source: Statement List (STL), contents.
const FAMILIES: &[(&str, &str, StlInsn, StlInsn)] = &[
    ("Bit logic", "1 Bit Logic Instructions", StlInsn::And, StlInsn::EdgeNegative),
    ("Load and transfer", "9 Load and Transfer Instructions", StlInsn::Load, StlInsn::SwapAr),
    (
        "Accumulators and address registers",
        "14 Accumulator and Address Register Instructions",
        StlInsn::AddAr1,
        StlInsn::Nop,
    ),
    ("Integer arithmetic", "7 Integer Math Instructions", StlInsn::AddConst, StlInsn::ModD),
    ("REAL arithmetic and functions", "8 Floating-Point Math Instructions", StlInsn::AddR, StlInsn::AtanR),
    ("Comparison", "2 Comparison Instructions", StlInsn::CompareEqI, StlInsn::CompareLeR),
    ("Conversion", "3 Conversion Instructions", StlInsn::BcdToI, StlInsn::Truncate),
    ("Word logic", "13 Word Logic Instructions", StlInsn::AndW, StlInsn::XorD),
    ("Shift and rotate", "11 Shift and Rotate Instructions", StlInsn::ShiftSignedI, StlInsn::RotateRightCc1),
    ("Timers", "12 Timer Instructions", StlInsn::TimerPulse, StlInsn::Enable),
    ("Counters", "4 Counter Instructions", StlInsn::CountUp, StlInsn::CountDown),
    ("Jumps", "6 Logic Control Instructions", StlInsn::Jump, StlInsn::Loop),
    (
        "Block calls and block ends",
        "10 Program Control Instructions",
        StlInsn::CallUnconditional,
        StlInsn::BlockEndConditional,
    ),
    ("Data blocks", "5 Data Block Instructions", StlInsn::OpenDb, StlInsn::SwapDb),
    ("Master control relay", "10 Program Control Instructions", StlInsn::McrActivate, StlInsn::McrClose),
];

/// The page in Markdown: `docs/reference/stl.md`.
pub fn reference() -> String {
    let mut page = String::from(
        "# STL instructions\n\n\
         Printed from the instruction table; do not edit. The status word column stands for\n\
         BR CC1 CC0 OV OS OR STA RLO /FC: `-` not touched, `x` computed, `0` and `1` forced.\n\
         OS is only ever set by arithmetic, never cleared. `CALL` has a syntax of its own.\n\
         On an S7-1500 it also calls MOVE, NORM_X, SCALE_X, LIMIT, SEL, MUX, MIN, MAX, CONVERT, SWAP, T_ADD, T_SUB, T_DIFF,\n\
         T_CONV, S_MOVE, S_CONV, STRG_VAL and VAL_STRG with the output OUT, T_COMP and S_COMP for a relation, `relation := GE`,\n\
         MOVE_BLK, FILL_BLK and SCATTER_BLK from an element on, LEN, CONCAT and other functions of texts with OUT in place of RET_VAL,\n\
         and an index may be a variable: `L #list[#i]`, `A \"Data\".motors[\"Number\"].runs`.\n",
    );
    for (heading, chapter, first, last) in FAMILIES {
        let _ = write!(
            page,
            "\n## {heading}\n\nSource: STL reference manual, chapter {chapter}.\n\n\
             | international | German | operand | status word | effect |\n| --- | --- | --- | --- | --- |\n"
        );
        for insn in StlInsn::ALL.iter().filter(|insn| (*first..=*last).contains(insn)) {
            let _ = writeln!(
                page,
                "| {} | {} | {} | `{}` | {} |",
                code(insn.mnemonic(Mnemonics::En)),
                code(insn.mnemonic(Mnemonics::De)),
                operand_phrase(insn.operand(), Mnemonics::En),
                insn.status(),
                cell(insn.doc().trim()),
            );
        }
    }
    page
}

fn code(mnemonic: &str) -> String {
    format!("`{mnemonic}`")
}

/// Text inside a table: a bar would end its cell.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_hold_each_row_once() {
        let mut listed: Vec<&StlInsn> = Vec::new();
        for (_, _, first, last) in FAMILIES {
            listed.extend(StlInsn::ALL.iter().filter(|insn| (*first..=*last).contains(insn)));
        }
        assert_eq!(listed, StlInsn::ALL.iter().collect::<Vec<_>>());
    }
}
