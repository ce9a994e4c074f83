//! Where instructions are allowed, which CPUs have them, and which constants they accept.
//!
//! Source: S7-200 system manual, instruction set; restrictions of interrupt routines and of the 21x generation.

use plcc_abi::image::BlockKind;
use plcc_abi::s7200::{Resolution, is_retentive_timer, timer_resolution};
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::Width;
use plcc_syntax::s7200::ast::{self, Area, Direct};
use plcc_syntax::s7200::{CompareKind, Insn};

use super::Binder;
use super::body::block_name;
use plcc_model::s7200::{self as model, Operand};

/// Limit of bits of a shift register.
const SHIFT_REGISTER_MAX: u32 = 64;
/// Limit of bits that SI and RI change at once.
const IMMEDIATE_MAX: u32 = 128;

/// Modes of each high-speed counter, one bit for each.
const MODES: [u16; 6] =
    [0b1_0110_1101_1011, 0b1111_1111_1111, 0b1111_1111_1111, 0b1_0000_0000_0001, 0b110_1101_1011, 0b1];

impl Binder<'_> {
    /// Checks an instruction in a block of `kind`, in a sequence step or not; false: blocks of this kind do not have it.
    pub fn check_place(&mut self, insn: Insn, kind: BlockKind, in_step: bool, span: Span) -> bool {
        let main = kind == BlockKind::Ob;
        let interrupt = kind == BlockKind::Int;
        let old = self.row.old;
        let wrong = match insn {
            Insn::End | Insn::Mend if !main => true,
            Insn::Cret | Insn::Ret => kind != BlockKind::Sbr,
            Insn::Creti | Insn::Reti => !interrupt,
            Insn::Eni | Insn::Disi | Insn::Hdef => interrupt,
            Insn::Call | Insn::For | Insn::Next | Insn::Lscr => interrupt && old,
            _ => false,
        };
        let code = match kind {
            BlockKind::Sbr => "0088",
            BlockKind::Int => "0089",
            _ => "0083",
        };
        let name = self.mnemonic(insn);
        if wrong {
            let help = match insn {
                Insn::End | Insn::Mend if interrupt => {
                    "leave the routine with CRETI; END ends the scan of the main program"
                }
                Insn::End | Insn::Mend => "leave the subroutine with CRET; END ends the scan of the main program",
                Insn::Cret | Insn::Ret if main => "END ends the scan of the main program",
                Insn::Cret | Insn::Ret => "leave an interrupt routine with CRETI",
                Insn::Creti | Insn::Reti if main => "END ends the scan of the main program",
                Insn::Creti | Insn::Reti => "leave a subroutine with CRET",
                _ => "do it in the main program or in a subroutine that it calls",
            };
            self.push(
                Diagnostic::new(
                    Code::InstructionPlace,
                    span,
                    format!("`{name}` is not allowed in {} ({code})", block_name(kind)),
                )
                .label("not possible here")
                .help(help),
            );
        } else if in_step && matches!(insn, Insn::End | Insn::Mend) {
            self.push(
                Diagnostic::new(
                    Code::InstructionPlace,
                    span,
                    format!("`{name}` is not allowed in a sequence step (0096)"),
                )
                .label("not possible between LSCR and SCRE")
                .help("move it after SCRE"),
            );
        }
        self.check_cpu(insn, &name, span);
        !wrong
    }

    /// Instructions that only the 22x has, and those that small CPUs lack.
    fn check_cpu(&mut self, insn: Insn, name: &str, span: Span) {
        if !self.row.old {
            return;
        }
        let lacks = match insn {
            Insn::Pid => self.row.pid_loops == 0,
            Insn::Tof | Insn::BeginInterval | Insn::Interval | Insn::Ctd => true,
            Insn::Sin | Insn::Cos | Insn::Tan | Insn::Ln | Insn::Exp => true,
            Insn::Its | Insn::Dts | Insn::Rts | Insn::Sti | Insn::Std | Insn::Str => true,
            Insn::Slen | Insn::Scpy | Insn::Scat | Insn::Sscpy | Insn::Sfnd | Insn::Cfnd => true,
            Insn::Compare(compare) => compare.kind == CompareKind::Text,
            Insn::Dled | Insn::Cevnt | Insn::Todrx | Insn::Todwx => true,
            Insn::Pls => self.row.pulse_outputs == 0,
            _ => false,
        };
        if lacks {
            let cpu = &self.input.profile.name;
            let message = Diagnostic::new(Code::CpuInstruction, span, format!("the CPU {cpu} has no `{name}` (0082)"))
                .label("only larger or newer CPUs have this instruction")
                .help("name the CPU of the plant with --cpu, or write the network without the instruction");
            self.push(message);
        }
    }

    /// Checks constants of an instruction with bound operands; `None`: reported.
    pub fn check_values(
        &mut self,
        insn: Insn,
        operands: &[Operand],
        written: &[ast::Operand],
        mnemonic: Span,
    ) -> Option<()> {
        let span = |index: usize| written.get(index).map_or(mnemonic, |operand| operand.span);
        let constant = |index: usize| match operands.get(index) {
            Some(Operand::Const(value)) => Some(*value),
            _ => None,
        };
        match insn {
            Insn::Ton | Insn::Tof | Insn::Tonr => {
                if let Some(Operand::Timer { number, .. }) = operands.first() {
                    return self.timer_kind(insn, *number, span(0));
                }
            }
            Insn::ShiftRegister => {
                if let (Some(first), Some(count)) = (operands.get(1), constant(2)) {
                    let count = (count as u8 as i8).unsigned_abs().into();
                    self.count(count, SHIFT_REGISTER_MAX, insn, span(2))?;
                    return self.elements(first, count, span(1));
                }
            }
            Insn::Set | Insn::Reset | Insn::SetNow | Insn::ResetNow => {
                if let (Some(first), Some(count)) = (operands.first(), constant(1)) {
                    let immediate = matches!(insn, Insn::SetNow | Insn::ResetNow);
                    self.count(count, if immediate { IMMEDIATE_MAX } else { 255 }, insn, span(1))?;
                    return self.elements(first, count, span(0));
                }
            }
            Insn::Bmb | Insn::Bmw | Insn::Bmd => {
                if let Some(count) = constant(2) {
                    self.count(count, 255, insn, span(2))?;
                    for (index, operand) in operands.iter().take(2).enumerate() {
                        self.elements(operand, count, span(index))?;
                    }
                }
            }
            Insn::Fill => {
                if let (Some(first), Some(count)) = (operands.get(1), constant(2)) {
                    self.count(count, 255, insn, span(2))?;
                    return self.elements(first, count, span(1));
                }
            }
            Insn::Hdef => {
                let (counter, mode) = (constant(0)?, constant(1)?);
                self.high_speed_counter(counter, span(0))?;
                let modes = match (self.row.old, counter) {
                    (true, 0) => 1,
                    (true, _) => 0b1111_1111_1111,
                    (false, _) => MODES.get(counter as usize).copied().unwrap_or(0),
                };
                if modes >> mode.min(15) & 1 == 0 {
                    let title = format!("HSC{counter} has no mode {mode} (0090)");
                    self.push(
                        Diagnostic::new(Code::NumberRange, span(1), title)
                            .label(format!("its modes: {}", bits(modes.into(), 13)))
                            .help("use one of its modes, or another high-speed counter"),
                    );
                    return None;
                }
            }
            Insn::Hsc => self.high_speed_counter(constant(0)?, span(0))?,
            Insn::Pls => {
                let outputs = self.row.pulse_outputs;
                self.below(constant(0)?, outputs, "pulse outputs", span(0))?;
            }
            Insn::Pid => {
                let loops = self.row.pid_loops;
                self.below(constant(1)?, loops, "PID loops", span(1))?;
                return self.elements(operands.first()?, 36, span(0));
            }
            Insn::Netr | Insn::Netw | Insn::Xmt | Insn::Rcv | Insn::Gpa | Insn::Spa => {
                let ports = self.row.ports;
                self.below(constant(1)?, ports, "ports", span(1))?;
            }
            Insn::Atch => self.event(constant(1)?, span(1))?,
            Insn::Dtch | Insn::Cevnt => self.event(constant(0)?, span(0))?,
            _ => {}
        }
        // Buffers of fixed length.
        let bytes = match insn {
            Insn::Todr | Insn::Todw => 8,
            Insn::Todrx | Insn::Todwx => 19,
            Insn::Netr | Insn::Netw => 7,
            _ => return Some(()),
        };
        self.elements(operands.first()?, bytes, span(0))
    }

    fn count(&mut self, count: u32, max: u32, insn: Insn, span: Span) -> Option<()> {
        if (1..=max).contains(&count) {
            return Some(());
        }
        let title = format!("`{}` cannot have a count of {count} (0092)", self.mnemonic(insn));
        self.push(
            Diagnostic::new(Code::ElementCount, span, title)
                .label(format!("1 to {max}"))
                .help("write the number of elements; a variable count is a byte such as VB10"),
        );
        None
    }

    /// The CPU has `count` elements beginning with an operand.
    fn elements(&mut self, first: &Operand, count: u32, span: Span) -> Option<()> {
        let direct = |area, width, number, bit| Direct { area, width, number, bit };
        let (direct, width) = match first {
            Operand::Memory { area, byte, bit, width } => {
                let area = match area {
                    model::Area::I => Area::I,
                    model::Area::Q => Area::Q,
                    model::Area::V => Area::V,
                    model::Area::M => Area::M,
                    model::Area::Sm => Area::Sm,
                    model::Area::S => Area::S,
                    model::Area::L => Area::L,
                };
                (direct(area, Some(*width), *byte, *bit), *width)
            }
            Operand::Timer { number, width } => (direct(Area::T, None, u32::from(*number), 0), *width),
            Operand::Counter { number, width } => (direct(Area::C, None, u32::from(*number), 0), *width),
            Operand::AnalogInput { byte } => (direct(Area::Ai, Some(Width::Word), *byte, 0), Width::Word),
            Operand::AnalogOutput { byte } => (direct(Area::Aq, Some(Width::Word), *byte, 0), Width::Word),
            Operand::Const(_)
            | Operand::Text(_)
            | Operand::HighSpeedCounter(_)
            | Operand::Accumulator { .. }
            | Operand::Indirect { .. } => return Some(()),
        };
        self.check_range(direct, width, count, span)
    }

    fn timer_kind(&mut self, insn: Insn, number: u8, span: Span) -> Option<()> {
        let retentive = is_retentive_timer(number);
        if retentive == (insn == Insn::Tonr) {
            return Some(());
        }
        let (is, others) = match retentive {
            true => ("a retentive timer for TONR", "TON and TOF have T32 to T63 and T96 to T255"),
            false => ("a timer for TON or TOF", "TONR has T0 to T31 and T64 to T95"),
        };
        let resolution = timer_resolution(number);
        let same = match (resolution, retentive) {
            (Resolution::Ms1, true) => "T32 or T96",
            (Resolution::Ms10, true) => "T33 to T36 or T97 to T100",
            (Resolution::Ms100, true) => "T37 to T63 or T101 to T255",
            (Resolution::Ms1, false) => "T0 or T64",
            (Resolution::Ms10, false) => "T1 to T4 or T65 to T68",
            (Resolution::Ms100, false) => "T5 to T31 or T69 to T95",
        };
        let ms = resolution.milliseconds();
        self.push(
            Diagnostic::new(Code::TimerNumber, span, format!("T{number} is {is} (0090)"))
                .label(others)
                .help(format!("use {same}: they count steps of {ms} ms, as T{number} does")),
        );
        None
    }

    fn high_speed_counter(&mut self, number: u32, span: Span) -> Option<()> {
        if self.row.high_speed_counters >> number.min(7) & 1 != 0 {
            return Some(());
        }
        let has = bits(self.row.high_speed_counters.into(), 6);
        let message = Diagnostic::new(Code::NumberRange, span, format!("there is no HSC{number} (0090)"))
            .label(format!("the CPU {} has the high-speed counters {has}", self.input.profile.name))
            .help("use one of them, or name another CPU with --cpu");
        self.push(message);
        None
    }

    fn event(&mut self, event: u32, span: Span) -> Option<()> {
        if self.row.events >> event.min(63) & 1 != 0 {
            return Some(());
        }
        let message = Diagnostic::new(Code::NumberRange, span, format!("there is no event {event} (0090)"))
            .label(format!("the CPU {} has the events {}", self.input.profile.name, bits(self.row.events, 34)))
            .help("use one of them, or name another CPU with --cpu");
        self.push(message);
        None
    }

    fn below(&mut self, number: u32, limit: u8, what: &str, span: Span) -> Option<()> {
        if number < u32::from(limit) {
            return Some(());
        }
        let cpu = &self.input.profile.name;
        let label = match limit {
            0 => format!("the CPU {cpu} has no {what}"),
            1 => format!("the CPU {cpu} only has the number 0"),
            _ => format!("the CPU {cpu} has the numbers 0 to {}", limit - 1),
        };
        let message = Diagnostic::new(Code::NumberRange, span, format!("{number} is beyond the {what} (0090)"))
            .label(label)
            .help("use a smaller number, or name another CPU with --cpu");
        self.push(message);
        None
    }
}

/// Numbers whose bits are set, ranges in short: `0-12, 19-23`.
fn bits(set: u64, end: u32) -> String {
    let has = |number: u32| number < end && set >> number & 1 != 0;
    let mut parts: Vec<String> = Vec::new();
    let mut number = 0;
    while number < end {
        if has(number) {
            let first = number;
            while has(number + 1) {
                number += 1;
            }
            parts.push(if first == number { first.to_string() } else { format!("{first}-{number}") });
        }
        number += 1;
    }
    parts.join(", ")
}
