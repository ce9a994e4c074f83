//! A sequence for each instruction of STL.

use plcc_syntax::stl::{Mnemonics, OperandClass, StlInsn};

use super::Row;

/// The rows of the instruction table. `BE` has none: it ends every block.
pub fn rows() -> Vec<Row> {
    StlInsn::ALL.iter().map(|&insn| Row::new("STL", insn.row(), &sequence(insn))).collect()
}

/// The row needs 4 accumulators.
pub fn needs_four(row: &str) -> bool {
    matches!(row, "Enter" | "Leave")
}

fn sequence(insn: StlInsn) -> String {
    use StlInsn as I;
    let name = insn.mnemonic(Mnemonics::En);
    match insn {
        I::AndNest | I::AndNotNest | I::OrNest | I::OrNotNest | I::XorNest | I::XorNotNest => {
            format!("A M 0.0; {name}; A M 1.1; O M 2.2; ); = M 300.0")
        }
        I::CloseNest => "A(; A M 0.0; O M 1.1; ); = M 300.0".to_string(),
        I::And | I::AndNot | I::Or | I::OrNot | I::Xor | I::XorNot => format!("A M 0.0; {name} M 1.1; = M 300.0"),
        I::Assign => "A M 0.0; = M 300.0".to_string(),
        I::Set | I::Reset => format!("A M 0.0; {name} M {{p}}.0"),
        I::Not => "A M 0.0; A M 1.1; NOT; = M 300.0".to_string(),
        I::SetRlo | I::ClearRlo => format!("{name}; = M 300.0"),
        I::Save => "A M 0.0; SAVE; A M 1.1; A BR; = M 300.0".to_string(),
        I::EdgePositive | I::EdgeNegative => format!("A M 0.0; {name} M {{p}}.0; = M 300.0"),
        I::Load | I::Transfer => "L MW 0; T MW 300".to_string(),
        I::LoadBcd => "LC C {n}; T MW 300".to_string(),
        I::LoadAr1 | I::TransferAr1 => "LAR1 MD 220; TAR1 MD 300".to_string(),
        I::LoadAr2 | I::TransferAr2 => "LAR2 MD 220; TAR2 MD 300".to_string(),
        I::SwapAr => "LAR1 MD 220; CAR; TAR2 MD 300".to_string(),
        I::AddAr1 => "LAR1 MD 220; L MW 0; +AR1; TAR1 MD 300".to_string(),
        I::AddAr2 => "LAR2 MD 220; L MW 0; +AR2; TAR2 MD 300".to_string(),
        I::Enter => "L MD 0; L MD 4; ENT; L MD 8; +D; LEAVE; *D; T MD 300".to_string(),
        I::Leave => "L MD 0; L MD 4; L MD 8; LEAVE; +D; T MD 300".to_string(),
        I::Increment | I::Decrement => format!("L MB 0; {name} 7; T MB 300"),
        I::Display | I::Nop => format!("{name} 0"),
        I::AddConst => "L MW 0; + 5; T MW 300".to_string(),
        I::AddR | I::SubR | I::MulR | I::DivR => format!("L MD 200; L MD 204; {name}; T MD 300"),
        I::AbsR
        | I::NegR
        | I::SqrR
        | I::SqrtR
        | I::ExpR
        | I::LnR
        | I::SinR
        | I::CosR
        | I::TanR
        | I::AsinR
        | I::AcosR
        | I::AtanR => format!("L MD 208; {name}; T MD 300"),
        I::Round | I::RoundUp | I::RoundDown | I::Truncate => format!("L MD 200; {name}; T MD 300"),
        I::CompareEqR | I::CompareNeR | I::CompareGtR | I::CompareLtR | I::CompareGeR | I::CompareLeR => {
            format!("L MD 200; L MD 204; {name}; = M 300.0")
        }
        I::CompareEqI | I::CompareNeI | I::CompareGtI | I::CompareLtI | I::CompareGeI | I::CompareLeI => {
            format!("L MW 0; L MW 4; {name}; = M 300.0")
        }
        I::CompareEqD | I::CompareNeD | I::CompareGtD | I::CompareLtD | I::CompareGeD | I::CompareLeD => {
            format!("L MD 0; L MD 4; {name}; = M 300.0")
        }
        I::BcdToI => "L MW 214; BTI; T MW 300".to_string(),
        I::BcdToD => "L MD 212; BTD; T MD 300".to_string(),
        I::IToBcd | I::DToBcd => format!("L MW 216; {name}; T MD 300"),
        I::ShiftSignedI
        | I::ShiftSignedD
        | I::ShiftLeftW
        | I::ShiftRightW
        | I::ShiftLeftD
        | I::ShiftRightD
        | I::RotateLeftD
        | I::RotateRightD => format!("L MD 0; {name} 3; T MD 300"),
        I::Enable => "A M 0.0; FR T {n}".to_string(),
        I::TimerPulse | I::TimerExtendedPulse | I::TimerOnDelay | I::TimerRetentiveOnDelay | I::TimerOffDelay => {
            format!("A M 0.0; L S5T#100MS; {name} T {{n}}")
        }
        I::CountUp | I::CountDown => format!("A M 0.0; {name} C {{n}}"),
        I::Jump => "L MW 8; JU x; L 7; x: T MW 300".to_string(),
        I::JumpIf | I::JumpIfNot | I::JumpIfBr | I::JumpIfNotBr => {
            format!("A M 0.0; {name} x; L MW 8; T MW 300; x: NOP 0")
        }
        I::JumpBr | I::JumpNotBr => format!("A M 0.0; SAVE; {name} x; L MW 8; T MW 300; x: NOP 0"),
        I::JumpUnordered => format!("L MD 200; L MD 204; +R; {name} x; L MW 8; T MW 300; x: NOP 0"),
        I::JumpOv
        | I::JumpOs
        | I::JumpZero
        | I::JumpNotZero
        | I::JumpPositive
        | I::JumpNegative
        | I::JumpNotNegative
        | I::JumpNotPositive => format!("L MW 0; L MW 4; +I; {name} x; L MW 8; T MW 300; x: NOP 0"),
        I::JumpList => {
            "L MB 218; JL d; JU a; JU b; JU c; d: L 4; JU e; a: L 1; JU e; b: L 2; JU e; c: L 3; e: T MW 300"
                .to_string()
        }
        I::Loop => "L 10; x: T MW 300; L MW 0; T MW 302; L MW 300; LOOP x".to_string(),
        I::CallUnconditional | I::CallConditional => format!("A M 0.0; {name} FC {{helper}}"),
        I::BlockEnd => String::new(),
        I::BlockEndUnconditional => "A M 0.0; JC x; BEU; x: L MW 0; T MW 300".to_string(),
        I::BlockEndConditional => "A M 0.0; BEC; L MW 0; T MW 300".to_string(),
        I::OpenDb => "OPN DB [MW 222]; L DBW 0; T MW 300".to_string(),
        I::SwapDb => "OPN DB 1; CDB; L DIW 0; T MW 300".to_string(),
        I::McrActivate | I::McrDeactivate => "MCRA; A M 0.0; = M 300.0; MCRD".to_string(),
        I::McrOpen | I::McrClose => "MCRA; A M 0.0; MCR(; A M 1.1; = M 300.0; )MCR; MCRD".to_string(),
        I::RotateLeftCc1 | I::RotateRightCc1 => format!("L MD 0; {name}; T MD 300"),
        I::AddI | I::SubI | I::MulI | I::DivI => format!("L MW 0; L MW 4; {name}; T MD 300"),
        _ => {
            debug_assert!(!matches!(insn.operand(), OperandClass::Label | OperandClass::Block));
            format!("L MD 0; L MD 4; {name}; T MD 300")
        }
    }
}
