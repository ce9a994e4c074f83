//! From the S7-300/400 to the S7-1500, which has STL, SCL, LAD, FBD and GRAPH.
//!
//! Source: System and standard functions; S7-1500 information system, comparison list of instructions and organization blocks.

use plcc_abi::image::BlockKind;
use plcc_model::{Body, Program, StlStatementKind};
use plcc_syntax::stl::{Mnemonics, StlInsn};
use plcc_xref::Reference;

use super::Fate::{Carries, Changes, Lost, Unknown};
use super::{Rows, Verdict};

pub(super) fn collect(program: &Program, reference: &Reference, rows: &mut Rows) {
    for block in program.blocks.iter().filter(|block| !block.library) {
        let place = rows.at(block.span);
        match block.kind {
            BlockKind::Ob => rows.add(format!("OB {}", block.number), organization_block(block.number), place),
            BlockKind::Fb | BlockKind::Fc => rows.add(block.kind.prefix(), (Carries, ""), place),
            BlockKind::Sfc | BlockKind::Sfb | BlockKind::Db | BlockKind::Sbr | BlockKind::Int => {}
        }
        let Body::Stl(statements) = &block.body else { continue };
        for statement in statements {
            let place = rows.at(statement.span);
            match &statement.kind {
                StlStatementKind::Instruction { insn, .. } => {
                    rows.add(insn.mnemonic(Mnemonics::En), instruction(*insn), place);
                }
                StlStatementKind::JumpList { .. } => rows.add("JL", instruction(StlInsn::JumpList), place),
                StlStatementKind::Call(_) => rows.add("CALL", (Carries, ""), place),
                StlStatementKind::Label(_) | StlStatementKind::Assert(_) | StlStatementKind::Sleep(_) => {}
            }
        }
    }
    for operand in &reference.operands {
        if let Some((what, verdict)) = of_operand(program, &operand.address) {
            rows.uses(&what, verdict, &operand.uses);
        }
    }
}

const SAME: Verdict = (Carries, "");
const REGISTERS: Verdict = (
    Changes,
    "registers do not reach a called block, and are lost after one, unless it has \"Parameter passing via registers\"",
);
const INSTRUCTION: Verdict = (Carries, "the instruction of this name");
const STATUS: Verdict = (Carries, "the status word is computed only where the block uses it");

/// What becomes of an instruction of STL.
fn instruction(insn: StlInsn) -> Verdict {
    match insn {
        StlInsn::And
        | StlInsn::AndNot
        | StlInsn::Or
        | StlInsn::OrNot
        | StlInsn::Xor
        | StlInsn::XorNot
        | StlInsn::AndNest
        | StlInsn::AndNotNest
        | StlInsn::OrNest
        | StlInsn::OrNotNest
        | StlInsn::XorNest
        | StlInsn::XorNotNest
        | StlInsn::CloseNest
        | StlInsn::Assign
        | StlInsn::Set
        | StlInsn::Reset
        | StlInsn::Not
        | StlInsn::SetRlo
        | StlInsn::ClearRlo
        | StlInsn::Save
        | StlInsn::EdgePositive
        | StlInsn::EdgeNegative
        | StlInsn::Load
        | StlInsn::LoadBcd
        | StlInsn::Transfer
        | StlInsn::SwapAccu
        | StlInsn::Increment
        | StlInsn::Decrement
        | StlInsn::SwapBytesWord
        | StlInsn::SwapBytesDword
        | StlInsn::Display
        | StlInsn::Nop
        | StlInsn::AddConst
        | StlInsn::AddI
        | StlInsn::SubI
        | StlInsn::MulI
        | StlInsn::DivI
        | StlInsn::AddD
        | StlInsn::SubD
        | StlInsn::MulD
        | StlInsn::DivD
        | StlInsn::ModD
        | StlInsn::AddR
        | StlInsn::SubR
        | StlInsn::MulR
        | StlInsn::DivR
        | StlInsn::AbsR
        | StlInsn::NegR
        | StlInsn::SqrR
        | StlInsn::SqrtR
        | StlInsn::ExpR
        | StlInsn::LnR
        | StlInsn::SinR
        | StlInsn::CosR
        | StlInsn::TanR
        | StlInsn::AsinR
        | StlInsn::AcosR
        | StlInsn::AtanR
        | StlInsn::CompareEqI
        | StlInsn::CompareNeI
        | StlInsn::CompareGtI
        | StlInsn::CompareLtI
        | StlInsn::CompareGeI
        | StlInsn::CompareLeI
        | StlInsn::CompareEqD
        | StlInsn::CompareNeD
        | StlInsn::CompareGtD
        | StlInsn::CompareLtD
        | StlInsn::CompareGeD
        | StlInsn::CompareLeD
        | StlInsn::CompareEqR
        | StlInsn::CompareNeR
        | StlInsn::CompareGtR
        | StlInsn::CompareLtR
        | StlInsn::CompareGeR
        | StlInsn::CompareLeR
        | StlInsn::BcdToI
        | StlInsn::IToBcd
        | StlInsn::BcdToD
        | StlInsn::IToD
        | StlInsn::DToBcd
        | StlInsn::DToR
        | StlInsn::InvertI
        | StlInsn::InvertD
        | StlInsn::NegI
        | StlInsn::NegD
        | StlInsn::Round
        | StlInsn::RoundUp
        | StlInsn::RoundDown
        | StlInsn::Truncate
        | StlInsn::AndW
        | StlInsn::OrW
        | StlInsn::XorW
        | StlInsn::AndD
        | StlInsn::OrD
        | StlInsn::XorD
        | StlInsn::ShiftSignedI
        | StlInsn::ShiftSignedD
        | StlInsn::ShiftLeftW
        | StlInsn::ShiftRightW
        | StlInsn::ShiftLeftD
        | StlInsn::ShiftRightD
        | StlInsn::RotateLeftD
        | StlInsn::RotateRightD
        | StlInsn::RotateLeftCc1
        | StlInsn::RotateRightCc1
        | StlInsn::TimerPulse
        | StlInsn::TimerExtendedPulse
        | StlInsn::TimerOnDelay
        | StlInsn::TimerRetentiveOnDelay
        | StlInsn::TimerOffDelay
        | StlInsn::Enable
        | StlInsn::CountUp
        | StlInsn::CountDown
        | StlInsn::Jump
        | StlInsn::JumpIf
        | StlInsn::JumpIfNot
        | StlInsn::JumpList
        | StlInsn::Loop
        | StlInsn::BlockEnd
        | StlInsn::BlockEndUnconditional
        | StlInsn::BlockEndConditional => SAME,
        StlInsn::Push | StlInsn::Pop => (Carries, "with two accumulators"),
        StlInsn::Enter | StlInsn::Leave => (Changes, "the S7-1500 has two accumulators: keep the value in a variable"),
        StlInsn::LoadAr1
        | StlInsn::LoadAr2
        | StlInsn::TransferAr1
        | StlInsn::TransferAr2
        | StlInsn::SwapAr
        | StlInsn::AddAr1
        | StlInsn::AddAr2
        | StlInsn::OpenDb
        | StlInsn::SwapDb => REGISTERS,
        StlInsn::JumpIfBr
        | StlInsn::JumpIfNotBr
        | StlInsn::JumpBr
        | StlInsn::JumpNotBr
        | StlInsn::JumpOv
        | StlInsn::JumpOs
        | StlInsn::JumpZero
        | StlInsn::JumpNotZero
        | StlInsn::JumpPositive
        | StlInsn::JumpNegative
        | StlInsn::JumpNotNegative
        | StlInsn::JumpNotPositive
        | StlInsn::JumpUnordered => STATUS,
        StlInsn::CallUnconditional | StlInsn::CallConditional => (
            Changes,
            "registers do not reach the called block: give it \"Parameter passing via registers\", or use CALL",
        ),
        StlInsn::McrActivate | StlInsn::McrDeactivate | StlInsn::McrOpen | StlInsn::McrClose => {
            (Lost, "there is no master control relay: put its condition before each coil, or jump over the networks")
        }
    }
}

/// What becomes of an organization block.
fn organization_block(number: u16) -> Verdict {
    match number {
        1 | 10..=17 | 20..=23 | 30..=38 | 40..=47 | 55..=57 | 61..=64 | 80 | 82 | 83 | 86 | 100 | 121 | 122 => {
            (Carries, "start information only in a block with standard access")
        }
        60 => (Lost, "there is no multicomputing"),
        65 => (Changes, "MC-Servo (OB 91) and MC-Interpolator (OB 92), which motion control makes"),
        70 | 72 | 73 => (Changes, "only redundant CPUs (S7-1500R/H) have redundancy errors, in OB 70 and OB 72"),
        81 => (Lost, "power supply errors do not start a block: see OB 83 and the diagnostic buffer"),
        84 => (Lost, "errors of the CPU hardware stop it"),
        85 => (
            Lost,
            "an error while the process image is updated starts OB 122, or nothing; a missing block is an error of the compiler",
        ),
        87 => (Lost, "communication errors are in STATUS of the instructions"),
        88 => (Lost, "a block that is aborted starts OB 121 or stops the CPU"),
        90 => (Lost, "there is no background: use a cyclic interrupt of low priority"),
        101 | 102 => (Lost, "the CPU starts with a warm restart only, OB 100"),
        _ => (Unknown, ""),
    }
}

/// What becomes of a system function. The names are those of the TIA Portal.
const fn system_function(number: u16) -> Verdict {
    match number {
        0 => (Changes, "WR_SYS_T"),
        1 => (Changes, "RD_SYS_T"),
        2..=4 | 101 => (Changes, "RTM"),
        5 => (Changes, "GEO2LOG"),
        49 => (Changes, "LOG2GEO"),
        50 => (Changes, "RD_ADDR"),
        6 => (Carries, "RD_SINFO"),
        9 | 10 => (Lost, "alarms are not locked by the program"),
        13 => (Carries, "DPNRM_DG"),
        14 => (Carries, "DPRD_DAT"),
        15 => (Carries, "DPWR_DAT"),
        17 | 18 | 107 | 108 => (Changes, "Program_Alarm"),
        19 => (Changes, "Get_AlarmState"),
        20 => (Carries, "BLKMOV; optimised data need MOVE_BLK_VARIANT"),
        21 => (Carries, "FILL; optimised data need FILL_BLK"),
        81 => (Carries, "UBLKMOV; optimised data need UMOVE_BLK"),
        22 | 82 | 85 => (Changes, "CREATE_DB"),
        23 => (Changes, "DELETE_DB"),
        24 => (Changes, "ATTR_DB"),
        83 => (Carries, "READ_DBL"),
        84 => (Carries, "WRIT_DBL"),
        25 => (Lost, "the CPU compresses its memory itself"),
        26 => (Carries, "UPDAT_PI"),
        27 => (Carries, "UPDAT_PO"),
        126 => (Carries, "SYNC_PI"),
        127 => (Carries, "SYNC_PO"),
        28 => (Changes, "SET_TINTL"),
        29 => (Carries, "CAN_TINT"),
        30 => (Carries, "ACT_TINT"),
        31 => (Carries, "QRY_TINT"),
        32 => (Carries, "SRT_DINT"),
        33 => (Carries, "CAN_DINT"),
        34 => (Carries, "QRY_DINT"),
        41 => (Carries, "DIS_AIRT"),
        42 => (Carries, "EN_AIRT"),
        43 => (Carries, "RE_TRIGR"),
        46 => (Carries, "STP"),
        47 => (Carries, "WAIT"),
        51 => (Changes, "LED, DeviceStates, ModuleStates, Get_IM_Data and GET_DIAG, by what is asked"),
        52 => (Changes, "Gen_UsrMsg"),
        55..=58 => (Changes, "WRREC"),
        59 => (Changes, "RDREC"),
        64 => (Carries, "TIME_TCK"),
        65..=74 => (Changes, "TSEND_C and TRCV_C, or PUT and GET"),
        _ => (Unknown, ""),
    }
}

/// What becomes of a system function block.
const fn system_function_block(number: u16) -> Verdict {
    match number {
        0 => (Changes, "CTU of the instructions, with an instance"),
        1 => (Changes, "CTD of the instructions, with an instance"),
        2 => (Changes, "CTUD of the instructions, with an instance"),
        3 => (Changes, "TP of the instructions, with an instance"),
        4 => (Changes, "TON of the instructions, with an instance"),
        5 => (Changes, "TOF of the instructions, with an instance"),
        8 => (Carries, "USEND"),
        9 => (Carries, "URCV"),
        12 => (Carries, "BSEND"),
        13 => (Carries, "BRCV"),
        14 => (Carries, "GET"),
        15 => (Carries, "PUT"),
        52 => (Carries, "RDREC"),
        53 => (Carries, "WRREC"),
        54 => (Carries, "RALRM"),
        41 => (Carries, "CONT_C"),
        42 => (Carries, "CONT_S"),
        43 => (Carries, "PULSEGEN"),
        31 | 33..=36 => (Changes, "Program_Alarm"),
        44..=49 => (
            Lost,
            "the inputs and outputs of the CPU 31xC: a technology module, or a compact CPU with High_Speed_Counter",
        ),
        _ => (Unknown, ""),
    }
}

/// What becomes of a function of the standard libraries: IEC functions, TI-S7 blocks and communication.
const fn library_function(number: u16) -> Verdict {
    match number {
        2 | 4 | 11 | 17 | 20 | 21 | 22 | 25 | 26 | 27 | 31 | 32 | 36 | 93 | 96..=99 | 105 | 106 => INSTRUCTION,
        1 => (Changes, "T_ADD"),
        3 => (Changes, "T_COMBINE"),
        6 | 8 | 33 | 40 => (Changes, "T_CONV"),
        7 => (Changes, "WEEKDAY of a DTL"),
        34 => (Changes, "T_DIFF"),
        35 => (Changes, "T_SUB"),
        9 | 12 | 14 | 18 | 23 | 28 => (Changes, "T_COMP"),
        10 | 13 | 15 | 19 | 24 | 29 => (Changes, "S_COMP"),
        5 | 16 | 30 | 37..=39 => (Changes, "S_CONV"),
        50 | 60 => (Changes, "TSEND_C and TRCV_C"),
        _ => (Unknown, ""),
    }
}

/// What becomes of a function block of the standard libraries.
const fn library_function_block(number: u16) -> Verdict {
    match number {
        41..=43 | 58 | 59 | 63 | 64 | 66..=68 | 80..=85 => INSTRUCTION,
        65 => (Changes, "TCON, whose connection is in a structure such as TCON_IP_v4"),
        28 => (Changes, "USEND"),
        29 => (Changes, "URCV"),
        34 => (Changes, "GET"),
        35 => (Changes, "PUT"),
        _ => (Unknown, ""),
    }
}

/// What becomes of an operand, with the name of its part; `None`: nothing to say.
fn of_operand(program: &Program, address: &str) -> Option<(String, Verdict)> {
    let digits = address.find(|c: char| c.is_ascii_digit())?;
    let (letters, number) = address.split_at(digits);
    let name = |kind: BlockKind, number: u16| {
        let block = program.block(plcc_model::BlockKey { kind, number });
        let name = block.map_or("", |block| block.name.as_str());
        format!("{} {number} {name}", kind.prefix()).trim_end().to_string()
    };
    Some(match letters {
        "SFC" => {
            let number = number.parse().ok()?;
            (name(BlockKind::Sfc, number), system_function(number))
        }
        "SFB" => {
            let number = number.parse().ok()?;
            (name(BlockKind::Sfb, number), system_function_block(number))
        }
        "FC" | "FB" => {
            let kind = if letters == "FC" { BlockKind::Fc } else { BlockKind::Fb };
            let number = number.parse().ok()?;
            // Those of the program are looked at themselves.
            program.block(plcc_model::BlockKey { kind, number }).filter(|block| block.library)?;
            let verdict = if kind == BlockKind::Fc { library_function(number) } else { library_function_block(number) };
            (name(kind, number), verdict)
        }
        "T" => ("S5 timers".into(), (Carries, "IEC timers are more exact, and are not limited in number")),
        "C" => ("S5 counters".into(), (Carries, "IEC counters have a larger range, and are not limited in number")),
        "PIB" | "PIW" | "PID" => {
            ("PI".into(), (Changes, "`%IW256:P`; inputs at any address are also in the process image"))
        }
        "PQB" | "PQW" | "PQD" => {
            ("PQ".into(), (Changes, "`%QW256:P`; outputs at any address are also in the process image"))
        }
        "I" | "IB" | "IW" | "ID" | "Q" | "QB" | "QW" | "QD" => ("I and Q".into(), SAME),
        "M" | "MB" | "MW" | "MD" => ("M memory".into(), SAME),
        "DB" => match address.split_once('.') {
            Some(_) => ("DB addresses".into(), (Carries, "only in a data block with standard access")),
            None => return None,
        },
        _ => return None,
    })
}
