//! From the S7-200 to the S7-1200, which has LAD, FBD and SCL, and no STL.
//!
//! Source: S7-200 system manual, SIMATIC instructions and special memory; S7-1200 system manual, instructions, organization blocks and
//! system and clock memory.

use plcc_abi::image::BlockKind;
use plcc_model::s7200::{Insn, Operand, StatementKind};
use plcc_model::{BlockKey, Body, Program};
use plcc_xref::Reference;

use super::Fate::{Carries, Changes, Lost, Unknown};
use super::{Rows, Verdict};

pub(super) fn collect(program: &Program, reference: &Reference, rows: &mut Rows) {
    for block in program.blocks.iter().filter(|block| !block.library) {
        let Body::S7200(body) = &block.body else { continue };
        for statement in &body.statements {
            let place = rows.at(statement.span);
            let operands = match &statement.kind {
                StatementKind::Instruction { insn, operands } => {
                    let name = insn.mnemonic(plcc_syntax::stl::Mnemonics::En);
                    rows.add(name, instruction(*insn), place.clone());
                    if let (Insn::Atch, Some(Operand::Const(number))) = (insn, operands.get(1)) {
                        rows.add(format!("event {number}"), event(*number), place.clone());
                    }
                    operands
                }
                StatementKind::Call { number, arguments } => {
                    let called = program.block(BlockKey { kind: BlockKind::Sbr, number: *number });
                    let name = called.map(|block| block.name.to_ascii_uppercase()).unwrap_or_default();
                    match of_library(&name) {
                        Some(verdict) => rows.add(name, verdict, place.clone()),
                        None => rows.add("CALL", instruction(Insn::Call), place.clone()),
                    }
                    arguments
                }
                StatementKind::Assert(_) | StatementKind::Sleep(_) => continue,
            };
            let is_pointer = |operand: &Operand| matches!(operand, Operand::Indirect { .. });
            if operands.iter().any(is_pointer) || takes_address(&place.text) {
                rows.add("pointers", POINTER, place.clone());
            }
            if operands.iter().any(is_accumulator) {
                rows.add("AC", ACCUMULATOR, place);
            }
        }
    }
    for operand in &reference.operands {
        if let Some((what, verdict)) = memory(&operand.address) {
            rows.uses(&what, verdict, &operand.uses);
        }
    }
}

/// Whether a statement takes the address of an operand, `&VB100`. In a bound program that is a number.
fn takes_address(statement: &str) -> bool {
    statement.split(['\'', '"']).step_by(2).any(|outside_of_quotes| outside_of_quotes.contains('&'))
}

/// Whether an operand is an accumulator, or found by one: `AC0`, `*AC1`.
fn is_accumulator(operand: &Operand) -> bool {
    match operand {
        Operand::Accumulator { .. } => true,
        Operand::Indirect { pointer, .. } => is_accumulator(pointer),
        _ => false,
    }
}

const POINTER: Verdict =
    (Changes, "elements of an array by their index, or PEEK and POKE in SCL; a variable has no address as a number");
const ACCUMULATOR: Verdict =
    (Changes, "a temporary variable, or a component of a data block where several blocks use it");
const CONTACT: Verdict = (Carries, "");
const BOX: Verdict = (Carries, "");
const TWO_INPUTS: Verdict =
    (Changes, "a box with two inputs and one output, IN1, IN2 and OUT, instead of an operand that is changed");
const TIMER: Verdict =
    (Changes, "an IEC timer with an instance; its time is a TIME (multiply by the resolution of the timer)");
const COUNTER: Verdict = (Changes, "an IEC counter with an instance; its value is CV of the instance");
const STACK: Verdict = (Carries, "as branches of LAD and FBD, which the editor draws");
const STRING: Verdict =
    (Changes, "the function of the same purpose for STRING; texts have their maximum length in their first byte");
const CONVERT: Verdict = (Changes, "CONV with the types of its operands");
const TABLE: Verdict = (Lost, "write a function with an array and its index in SCL");
const LOOP: Verdict = (Changes, "FOR in SCL; LAD and FBD have no loops but jumps");
const SEQUENCE: Verdict =
    (Lost, "write the sequence as CASE in SCL, or with a bit for each step; the S7-1200 has no GRAPH");
const FREEPORT: Verdict = (Changes, "Send_P2P and Receive_P2P with a communication module CM 1241 or board CB 1241");
const NETWORK: Verdict = (Changes, "GET and PUT over PROFINET; PPI does not exist");

/// What becomes of an instruction.
#[allow(clippy::too_many_lines)] // One row for each instruction.
fn instruction(insn: Insn) -> Verdict {
    match insn {
        Insn::Load | Insn::LoadNot | Insn::And | Insn::AndNot | Insn::Or | Insn::OrNot | Insn::Not => CONTACT,
        Insn::LoadNow | Insn::LoadNotNow | Insn::AndNow | Insn::AndNotNow | Insn::OrNow | Insn::OrNotNow => {
            (Changes, "a contact with the peripheral input, `%I0.0:P`")
        }
        Insn::RisingEdge => (Changes, "P_TRIG, with a memory bit for the edge"),
        Insn::FallingEdge => (Changes, "N_TRIG, with a memory bit for the edge"),
        Insn::Assign => CONTACT,
        Insn::Set | Insn::Reset => (Changes, "S and R for one bit, SET_BF and RESET_BF for several"),
        Insn::AssignNow | Insn::SetNow | Insn::ResetNow => {
            (Changes, "the peripheral output, `%Q0.0:P`, beside the process image")
        }
        Insn::AndLoad | Insn::OrLoad | Insn::Push | Insn::Read | Insn::Pop => STACK,
        Insn::LoadStack => {
            (Lost, "no result of logic is copied from below: repeat the contacts, or keep the result in a bit")
        }
        Insn::AndEno => (Changes, "the output ENO of the box"),
        Insn::Nop => (Lost, "leave it out"),
        Insn::Compare(_) => BOX,
        Insn::Ton | Insn::Tonr | Insn::Tof => TIMER,
        Insn::BeginInterval | Insn::Interval => (Changes, "RUNTIME, which measures in seconds as LREAL"),
        Insn::Ctu | Insn::Ctd | Insn::Ctud => COUNTER,
        Insn::Hdef | Insn::Hsc => (Changes, "a fast counter of the device configuration, with CTRL_HSC"),
        Insn::Pls => (
            Changes,
            "a pulse generator of the device configuration, with CTRL_PWM or CTRL_PTO, or an axis of motion control",
        ),
        Insn::AddI | Insn::SubI | Insn::MulI | Insn::DivI | Insn::AddD | Insn::SubD | Insn::MulD | Insn::DivD => {
            TWO_INPUTS
        }
        Insn::AddR | Insn::SubR | Insn::MulR | Insn::DivR => TWO_INPUTS,
        Insn::Mul => (Changes, "MUL of DINT after CONV of both factors: it does not widen INT to DINT"),
        Insn::Div => (Changes, "DIV and MOD: quotient and remainder are two results"),
        Insn::IncB | Insn::DecB => (Changes, "INC and DEC of a USINT"),
        Insn::IncW | Insn::DecW | Insn::IncD | Insn::DecD => BOX,
        Insn::Sqrt | Insn::Sin | Insn::Cos | Insn::Tan | Insn::Ln | Insn::Exp => BOX,
        Insn::Pid => {
            (Changes, "PID_Compact, a technology object; the loop table is not read: set the controller up again")
        }
        Insn::MovB | Insn::MovW | Insn::MovD | Insn::MovR => (Carries, "as MOVE"),
        Insn::Bmb | Insn::Bmw | Insn::Bmd => (Changes, "MOVE_BLK of arrays"),
        Insn::Swap => (Carries, ""),
        Insn::Bir => (Changes, "MOVE from the peripheral input, `%IB0:P`"),
        Insn::Biw => (Changes, "MOVE to the peripheral output, `%QB0:P`"),
        Insn::InvB | Insn::InvW | Insn::InvD => BOX,
        Insn::AndB | Insn::AndW | Insn::AndD | Insn::OrB | Insn::OrW | Insn::OrD => TWO_INPUTS,
        Insn::XorB | Insn::XorW | Insn::XorD => TWO_INPUTS,
        Insn::ShiftRightB | Insn::ShiftRightW | Insn::ShiftRightD => BOX,
        Insn::ShiftLeftB | Insn::ShiftLeftW | Insn::ShiftLeftD => BOX,
        Insn::RotateRightB | Insn::RotateRightW | Insn::RotateRightD => BOX,
        Insn::RotateLeftB | Insn::RotateLeftW | Insn::RotateLeftD => BOX,
        Insn::ShiftRegister => (Lost, "shift an array of BOOL in SCL, or a word with SHL and SHR"),
        Insn::Att
        | Insn::Fifo
        | Insn::Lifo
        | Insn::FindEqual
        | Insn::FindNotEqual
        | Insn::FindLess
        | Insn::FindGreater => TABLE,
        Insn::Fill => (Changes, "FILL_BLK of an array"),
        Insn::Bti | Insn::Itb | Insn::Itd | Insn::Dti | Insn::Dtr | Insn::Bcdi | Insn::Ibcd => CONVERT,
        Insn::Round | Insn::Trunc => BOX,
        Insn::Deco | Insn::Enco => BOX,
        Insn::Seg => (Lost, "take the pattern from an array of 16 bytes"),
        Insn::Ath | Insn::Hta => (Changes, "ATH and HTA with pointers and a length"),
        Insn::Ita | Insn::Dta | Insn::Rta => (Changes, "VAL_STRG, which has the format as parameters"),
        Insn::Its | Insn::Dts | Insn::Rts => (Changes, "S_CONV or VAL_STRG"),
        Insn::Sti | Insn::Std | Insn::Str => (Changes, "S_CONV or STRG_VAL"),
        Insn::Slen | Insn::Scpy | Insn::Scat | Insn::Sscpy | Insn::Sfnd => STRING,
        Insn::Cfnd => (Lost, "look for each character with FIND, in a loop in SCL"),
        Insn::End | Insn::Mend => (Changes, "RET in the organization block; the end of the program is implied"),
        Insn::Stop => (Changes, "STP"),
        Insn::Wdr => (Changes, "RE_TRIGR"),
        Insn::Jmp | Insn::Lbl => (Carries, "labels are names"),
        Insn::For | Insn::Next => LOOP,
        Insn::Lscr | Insn::Scrt | Insn::Cscre | Insn::Scre => SEQUENCE,
        Insn::Call => (Changes, "FC or FB with its parameters; local data are not kept between calls in an FC either"),
        Insn::Cret => (Changes, "RET"),
        Insn::Ret => (Carries, "the end of a block is implied"),
        Insn::Dled => (Changes, "LED reads the state of LEDs; the program sets none"),
        Insn::Atch => (Changes, "an organization block for the event, with ATTACH for events of the hardware"),
        Insn::Dtch => (Changes, "DETACH"),
        Insn::Cevnt => (Lost, "a queue of events is not cleared"),
        Insn::Eni => (Changes, "EN_AIRT: interrupts are enabled when the CPU starts"),
        Insn::Disi => (Changes, "DIS_AIRT delays them; each call needs its EN_AIRT"),
        Insn::Creti | Insn::Reti => (Changes, "RET in the organization block of the event"),
        Insn::Netr | Insn::Netw => NETWORK,
        Insn::Xmt | Insn::Rcv => FREEPORT,
        Insn::Gpa | Insn::Spa => (Lost, "there is no PPI port"),
        Insn::Todr => (Changes, "RD_LOC_T or RD_SYS_T, with a DTL"),
        Insn::Todw => (Changes, "WR_LOC_T or WR_SYS_T, with a DTL"),
        Insn::Todrx | Insn::Todwx => (Changes, "RD_LOC_T and SET_TIMEZONE, with a DTL"),
    }
}

/// What becomes of a subroutine of a library of Micro/WIN. Source: S7-1200 system manual, USS and Modbus RTU communication.
fn of_library(name: &str) -> Option<Verdict> {
    Some(match name {
        "USS_INIT" => (Changes, "nothing: USS_Port_Scan has the port and its baud rate"),
        "USS_CTRL" => (Changes, "USS_Drive_Control for each drive, and USS_Port_Scan in a cyclic interrupt"),
        "USS_RPM_W" | "USS_RPM_D" | "USS_RPM_R" => (Changes, "USS_Read_Param"),
        "USS_WPM_W" | "USS_WPM_D" | "USS_WPM_R" => (Changes, "USS_Write_Param"),
        "MBUS_INIT" => (Changes, "Modbus_Comm_Load; Modbus_Slave has the address and the holding registers"),
        "MBUS_SLAVE" => (Changes, "Modbus_Slave"),
        "MBUS_CTRL" | "MBUS_CTRL_P1" => (Changes, "Modbus_Comm_Load"),
        "MBUS_MSG" | "MBUS_MSG_P1" => (Changes, "Modbus_Master"),
        _ => return None,
    })
}

/// What becomes of an event of ATCH. Source: S7-200 system manual, priority table of interrupt events.
fn event(number: u32) -> Verdict {
    match number {
        0..=7 => (Changes, "a hardware interrupt of the digital input"),
        8 | 9 | 25 | 26 => (Changes, "no event: DONE of Send_P2P and NDR of Receive_P2P"),
        10 | 11 => (Changes, "a cyclic interrupt, whose time is set with it (SMB34, SMB35)"),
        12 | 13 | 16 | 29 | 32 | 33 => (Changes, "a hardware interrupt of the fast counter: value reached"),
        14 | 17 | 27 | 30 => (Changes, "a hardware interrupt of the fast counter: direction changed"),
        15 | 18 | 28 | 31 => (Changes, "a hardware interrupt of the fast counter: reset"),
        19 | 20 => (Lost, "the end of a pulse train is not an event; look at BUSY and DONE of CTRL_PTO or of the axis"),
        21 | 22 => (Changes, "a time-delay interrupt, SRT_DINT"),
        23 | 24 => (Changes, "no event: NDR of Receive_P2P"),
        _ => (Unknown, ""),
    }
}

/// What becomes of memory, with the name of its part; `None`: nothing to say.
fn memory(address: &str) -> Option<(String, Verdict)> {
    let digits = address.find(|c: char| c.is_ascii_digit())?;
    let (letters, number) = address.split_at(digits);
    let byte: u32 = number.split('.').next()?.parse().ok()?;
    let verdict = match letters {
        "V" | "VB" | "VW" | "VD" => {
            return Some(("V memory".into(), (Changes, "components of a data block; give them names and types")));
        }
        "S" | "SB" | "SW" | "SD" => return Some(("S memory".into(), (Lost, "bits of M or of a data block"))),
        "AIW" => {
            return Some((
                "AIW".into(),
                (Changes, "the address of the module, `%IW64`, and 0 to 27648 instead of 32000"),
            ));
        }
        "AQW" => {
            return Some((
                "AQW".into(),
                (Changes, "the address of the module, `%QW80`, and 0 to 27648 instead of 32000"),
            ));
        }
        "HC" => {
            return Some((
                address.into(),
                (Changes, "the address of the fast counter in the process image, `%ID1000`"),
            ));
        }
        "M" | "MB" | "MW" | "MD" => return Some(("M memory".into(), (Carries, ""))),
        "I" | "IB" | "IW" | "ID" | "Q" | "QB" | "QW" | "QD" => return Some(("I and Q".into(), (Carries, ""))),
        "SM" | "SMB" | "SMW" | "SMD" => special(byte, number),
        _ => return None,
    };
    Some((address.to_string(), verdict))
}

/// What becomes of special memory. Source: S7-200 system manual, special memory bits.
fn special(byte: u32, number: &str) -> Verdict {
    match (byte, number) {
        (0, "0.0") => (Changes, "AlwaysTRUE of the system memory byte"),
        (0, "0.1") => (Changes, "FirstScan of the system memory byte, or a startup organization block"),
        (0, "0.2") => (Lost, "compare a value of retentive memory with a known one in the startup organization block"),
        (0, "0.3") => (Changes, "a startup organization block"),
        (0, "0.4") => (Lost, "two timers; clock memory has 10 Hz to 0.5 Hz"),
        (0, "0.5") => (Changes, "Clock_1Hz of the clock memory byte"),
        (0, "0.6") => (Lost, "a bit that the program inverts at the end of its cycle"),
        (0, "0.7") => (Lost, "the CPU has no mode switch"),
        (1, _) => (Changes, "ENO of the box, and comparisons of its result"),
        (2 | 3, _) => (Changes, "the buffer and STATUS of Receive_P2P"),
        (4, _) => (Changes, "status of the instructions, and the diagnostic buffer"),
        (5 | 8..=21, _) => (Changes, "DeviceStates and ModuleStates, and OB 82"),
        (6 | 7, _) => (Changes, "Get_IM_Data"),
        (22..=27, _) => (Changes, "RT_INFO"),
        (28 | 29, _) => (Lost, "there are no potentiometers: use an analog input"),
        (30 | 130, _) => (Changes, "the configuration of the port, or Port_Config"),
        (31..=33, _) => (Lost, "retentive data are kept without a command"),
        (34 | 35, _) => (Changes, "the time of a cyclic interrupt, SET_CINT"),
        (36..=65 | 131..=165, _) => (Changes, "parameters of CTRL_HSC or CTRL_HSC_EXT"),
        (66..=85 | 166..=185, _) => (Changes, "parameters of CTRL_PWM, CTRL_PTO or of the axis"),
        (86..=94 | 186..=194, _) => (Changes, "Receive_Config"),
        (200..=549, _) => (Changes, "the addresses and diagnostics of the module"),
        _ => (Unknown, ""),
    }
}
