//! The S7-200: everything that other families do not have. Source: S7-200 system manual.
//!
//! - `family`: the hooks for cycle and schedule; `scan`: start of RUN, scan, STOP; `special`: special memory; `errors`: fatal and
//!   non-fatal errors; `retain`: retentive memory.
//! - `address`: addresses as a user writes them; `analog`: words of analog modules.
//! - `interrupts`: events, their queues, interrupt routines; `timers`: the three resolutions.
//! - `bits`, `blocks`, `tables`, `text`, `strings`, `pid`, `calendar`: operations on memory; `access`: checks when they
//!   read and write; `daylight`: daylight-saving time; `pointers`: indirect addresses.
//! - `high_speed`, `pulses`: simulated counters and pulse outputs.
//! - `freeport`, `network`: serial ports and the PPI link.
//!
//! Generated code calls an [`Operation`] by number; each is a function of one of these modules.

mod access;
mod address;
mod analog;
mod bits;
mod blocks;
mod calendar;
mod daylight;
pub(crate) mod errors;
mod family;
mod freeport;
mod high_speed;
mod interrupts;
mod network;
mod pid;
mod pointers;
mod pulses;
mod retain;
mod scan;
mod sockets;
mod special;
mod strings;
mod tables;
mod text;
mod timers;

#[cfg(test)]
mod tests;

pub use high_speed::PulseInput;
pub use pulses::{Edge, PULSE_OUTPUTS};
pub use sockets::socket_address;

/// A CPU whose port 0 is in Freeport mode, 9600 baud.
#[cfg(test)]
pub(crate) use freeport::tests::freeport_cpu as cpu_for_tests;

use std::cell::Cell;

use plcc_abi::layout;
use plcc_abi::s7200::{Operation, S7200Config, S7200Image, result, system};

use crate::cpu::Cpu;
use crate::memory::Memory;
pub use address::Part;
pub(crate) use address::parse as parse_address;
pub use analog::ModuleScale;
pub(crate) use analog::{has_module, scale};
use errors::ENDLESS;
pub(crate) use errors::{STOP_INSTRUCTION, event_text};
pub(crate) use family::ScanCycle;

/// Operands of an operation, see [`Operation`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Operands {
    pub site: u32,
    pub a: u32,
    pub b: u32,
    pub c: u32,
    pub d: u32,
}

/// State outside the memory.
pub struct S7200 {
    /// Neither the program nor a scenario touches interrupts and hardware: scans need not look at them.
    pub(crate) logic_only: Cell<bool>,
    pub(crate) image: S7200Image,
    pub(crate) config: S7200Config,
    pub(crate) scan: scan::Scan,
    pub(crate) special: special::Special,
    pub(crate) errors: errors::Errors,
    pub(crate) retain: retain::Retain,
    pub(crate) timers: timers::Timers,
    pub(crate) interrupts: interrupts::Interrupts,
    pub(crate) counters: high_speed::Counters,
    pub(crate) pulses: pulses::PulseOutputs,
    pub(crate) freeport: freeport::Freeport,
    pub(crate) network: network::Network,
    pub(crate) loops: pid::Loops,
    pub(crate) calendar: calendar::Calendar,
}

impl S7200 {
    pub(crate) fn new(image: &S7200Image, config: &S7200Config) -> S7200 {
        S7200 {
            // Who asks for the program's data over the network or a port is heard in each scan.
            logic_only: Cell::new(is_logic_only(image, config)),
            image: image.clone(),
            config: config.clone(),
            scan: scan::Scan::default(),
            special: special::Special::default(),
            errors: errors::Errors::default(),
            retain: retain::Retain::default(),
            timers: timers::Timers::default(),
            interrupts: interrupts::Interrupts::default(),
            counters: high_speed::Counters::default(),
            pulses: pulses::PulseOutputs::default(),
            freeport: freeport::Freeport::default(),
            network: network::Network::default(),
            loops: pid::Loops::default(),
            calendar: calendar::Calendar::default(),
        }
    }
}

/// See [`S7200::logic_only`].
fn is_logic_only(image: &S7200Image, config: &S7200Config) -> bool {
    image.logic_only && config.listen.is_none() && config.ports.is_empty()
}

impl Cpu {
    /// The program was changed: all state of the CPU goes on, and interrupt routines that the new program has not are detached. `renamed`: the
    /// numbers of places in both programs. Result: what was detached, a line each.
    pub(crate) fn s7200_take_over(&mut self, before: &mut Option<Box<S7200>>, renamed: &[(u32, u32)]) -> Vec<String> {
        let (Some(own), Some(before)) = (&mut self.s7200, before) else { return Vec::new() };
        // A scenario or a client touches hardware.
        let looks_always = is_logic_only(&before.image, &before.config) && !before.logic_only.get();
        std::mem::swap(own, before);
        std::mem::swap(&mut own.image, &mut before.image);
        std::mem::swap(&mut own.config, &mut before.config);
        own.logic_only.set(is_logic_only(&own.image, &own.config) && !looks_always);
        own.errors.rename_sites(renamed);
        self.s7200_detach_missing()
    }
}

/// It ran without error.
fn done() -> u64 {
    result::ENO
}

/// It ran without error and returns `value`.
fn value(value: u32) -> u64 {
    u64::from(value) << 32 | result::ENO | result::VALUE
}

/// It failed with non-fatal error `code`, and did nothing.
fn failed(cpu: &Cpu, operands: &Operands, code: u16) -> u64 {
    cpu.s7200_error(operands.site, code);
    0
}

/// It failed by a bit of SM1 that the operation has set: no error code, no ENO.
fn failed_quietly() -> u64 {
    0
}

/// Offset of special memory byte `byte` from the memory base.
const fn special(byte: u32) -> u32 {
    layout::SYSTEM + system::SM + byte
}

/// Bits of SM1.
mod sm1 {
    pub const OVERFLOW: u8 = 1;
    pub const TABLE_FULL: u8 = 4;
    pub const TABLE_EMPTY: u8 = 5;
    pub const NOT_HEX: u8 = 7;
}

/// Writes bit `bit` of special memory byte `byte`.
fn set_special(memory: &Memory, byte: u32, bit: u8, on: bool) {
    let old = memory.byte(special(byte));
    let mask = 1 << bit;
    memory.set_byte(special(byte), if on { old | mask } else { old & !mask });
}

/// After these something may be due earlier than before.
fn starts_hardware(operation: Operation) -> bool {
    matches!(
        operation,
        Operation::DefineCounter
            | Operation::ControlCounter
            | Operation::ControlPulses
            | Operation::Transmit
            | Operation::Receive
            | Operation::NetworkRead
            | Operation::NetworkWrite
    )
}

impl Cpu {
    /// The S7-200 part; only its programs need it.
    pub(crate) fn s7200(&self) -> Option<&S7200> {
        self.s7200.as_deref()
    }

    /// The area that begins at or before `address` and holds it: its first byte and the byte after its last one, as offsets from the
    /// memory base. `None`: no area of an S7-200.
    pub(crate) fn s7200_area(&self, address: u32) -> Option<(u32, u32)> {
        let cpu = self.s7200()?.image.cpu;
        let (v, v_bytes) = self.memory.db(plcc_abi::s7200::V_DB);
        // Nearly all operands are there.
        if address >= v && address - v < v_bytes {
            return Some((v, v + v_bytes));
        }
        let areas = [
            (layout::I, self.image.profile.inputs),
            (layout::Q, self.image.profile.outputs),
            (layout::M, self.image.profile.bit_memory),
            (layout::SYSTEM + system::SM, cpu.sm_bytes),
            (layout::SYSTEM + system::S, cpu.s_bytes),
            (layout::SYSTEM + system::ACCUMULATORS, 16),
            (layout::SYSTEM + system::AI, cpu.analog_bytes.min(system::ANALOG_BYTES)),
            (layout::SYSTEM + system::AQ, cpu.analog_bytes.min(system::ANALOG_BYTES)),
            (layout::SYSTEM + system::TIMER_VALUES, 2 * self.image.profile.timers.min(plcc_abi::s7200::TIMERS)),
            (layout::SYSTEM + system::COUNTER_VALUES, 2 * self.image.profile.counters.min(plcc_abi::s7200::COUNTERS)),
        ];
        let fixed = areas.into_iter().find(|&(start, bytes)| address >= start && address - start < bytes);
        let local = |address: u32| {
            // Frames of local data begin at multiples of their size.
            let first = layout::L;
            (first..first + layout::L_CLASSES * layout::L_CLASS_BYTES).contains(&address).then(|| {
                let frame = address - (address - first) % plcc_abi::s7200::LOCAL_BYTES;
                (frame, frame + plcc_abi::s7200::LOCAL_BYTES)
            })
        };
        // Strings of the program text are in another DB.
        let constants = || {
            let others = self.image.dbs.iter().filter(|db| db.number != plcc_abi::s7200::V_DB);
            let mut ranges = others.map(|db| (db.address, db.address.saturating_add(db.data.len() as u32)));
            ranges.find(|&(start, end)| (start..end).contains(&address))
        };
        fixed.map(|(start, bytes)| (start, start + bytes)).or_else(|| local(address)).or_else(constants)
    }

    /// See [`RuntimeFn::S7200Operation`](plcc_abi::RuntimeFn::S7200Operation).
    pub(crate) fn s7200_operation(&self, number: u32, operands: &Operands) -> u64 {
        let Some(operation) = Operation::of_number(number) else { return 0 };
        let result = self.s7200_execute(operation, operands);
        if starts_hardware(operation) {
            self.rearm();
        }
        result
    }

    fn s7200_execute(&self, operation: Operation, operands: &Operands) -> u64 {
        match operation {
            Operation::WriteBits => bits::write(self, operands),
            Operation::WriteOutputsNow => bits::write_outputs_now(self, operands),
            Operation::ResetTimers => bits::reset_timers(self, operands),
            Operation::ResetCounters => bits::reset_counters(self, operands),
            Operation::SetTimers => bits::set_timers(self, operands),
            Operation::SetCounters => bits::set_counters(self, operands),
            Operation::CopyBlock => blocks::copy(self, operands),
            Operation::Fill => blocks::fill(self, operands),
            Operation::ShiftRegister => blocks::shift_register(self, operands),
            Operation::TableAdd => tables::add(self, operands),
            Operation::TableFirst => tables::first(self, operands),
            Operation::TableLast => tables::last(self, operands),
            Operation::TableFind => tables::find(self, operands),
            Operation::IntToAscii => text::int_to_ascii(self, operands),
            Operation::DintToAscii => text::dint_to_ascii(self, operands),
            Operation::RealToAscii => text::real_to_ascii(self, operands),
            Operation::IntToString => text::int_to_string(self, operands),
            Operation::DintToString => text::dint_to_string(self, operands),
            Operation::RealToString => text::real_to_string(self, operands),
            Operation::AsciiToHex => text::ascii_to_hex(self, operands),
            Operation::HexToAscii => text::hex_to_ascii(self, operands),
            Operation::StringToInt => text::string_to_int(self, operands),
            Operation::StringToDint => text::string_to_dint(self, operands),
            Operation::StringToReal => text::string_to_real(self, operands),
            Operation::StringLength => strings::length(self, operands),
            Operation::StringCopy => strings::copy(self, operands),
            Operation::StringAppend => strings::append(self, operands),
            Operation::StringPart => strings::part(self, operands),
            Operation::StringFind => strings::find(self, operands),
            Operation::CharacterFind => strings::find_character(self, operands),
            Operation::StringEqual => strings::equal(self, operands),
            Operation::Pid => pid::pid(self, operands),
            Operation::ReadClock => calendar::read(self, operands),
            Operation::SetClock => calendar::set(self, operands),
            Operation::ReadClockExtended => calendar::read_extended(self, operands),
            Operation::SetClockExtended => calendar::set_extended(self, operands),
            Operation::AttachInterrupt => interrupts::attach(self, operands),
            Operation::DetachInterrupt => interrupts::detach(self, operands),
            Operation::ClearEvents => interrupts::clear(self, operands),
            Operation::EnableInterrupts => interrupts::enable(self, operands),
            Operation::DisableInterrupts => interrupts::disable(self, operands),
            Operation::DefineCounter => high_speed::define(self, operands),
            Operation::ControlCounter => high_speed::control(self, operands),
            Operation::ControlPulses => pulses::control(self, operands),
            Operation::Transmit => freeport::transmit(self, operands),
            Operation::Receive => freeport::receive(self, operands),
            Operation::NetworkRead => network::read(self, operands),
            Operation::NetworkWrite => network::write(self, operands),
            Operation::GetStationAddress => network::get_address(self, operands),
            Operation::SetStationAddress => network::set_address(self, operands),
            Operation::RestartWatchdog => scan::restart_watchdog(self, operands),
            Operation::DiagnosticLed => scan::diagnostic_led(self, operands),
            Operation::StopMode => scan::stop_mode(self, operands),
        }
    }
}
