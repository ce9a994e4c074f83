//! Freeport: XMT, RCV, character interrupts. Source: S7-200 system manual, Freeport mode.
//!
//! - `registers`: special memory of the ports; `receiver`, `transmitter`: RCV and XMT, which depend only on characters and time.
//! - `stream`: the serial device, pseudo-terminal or TCP partner; `port`: the line between them.
//!
//! A character takes its time on the line by the clock of the CPU, from every source. With the real clock streams are polled every
//! millisecond, with the virtual one at the end of each scan.

mod port;
mod receiver;
mod registers;
mod stream;
#[cfg(test)]
pub(super) mod tests;
mod transmitter;

use std::cell::RefCell;

use plcc_abi::s7200::error;

use self::port::{Happened, Port};
use self::receiver::{Criteria, Receiver, control, status};
pub(super) use self::registers::Mode;
use self::registers::{Control, REGISTERS, Registers};
use self::stream::{Arrived, Stream};
use super::interrupts::EventData;
use super::{Operands, done, failed, failed_quietly, set_special, special};
use crate::clock::NS_PER_MS;
use crate::cpu::Cpu;
use crate::diagnostics::NO_SITE;
use crate::schedule::NEVER;

/// How often a stream is polled with the real clock.
const LOOK_NS: u64 = NS_PER_MS;
const RECEIVED_CHARACTER: u32 = 2;
const PARITY_BYTE: u32 = 3;
const TRANSMITTER_BYTE: u32 = 4;

/// Ports in Freeport mode.
#[derive(Default)]
pub struct Freeport {
    ports: [RefCell<Port>; 2],
    /// The events that were raised, for tests.
    #[cfg(test)]
    raised: RefCell<Vec<(u8, EventData)>>,
}

/// A port with its registers.
type Place<'a> = (&'a RefCell<Port>, &'static Registers);

impl Cpu {
    fn s7200_places(&self) -> impl Iterator<Item = Place<'_>> {
        self.s7200().into_iter().flat_map(|own| own.freeport.ports.iter().zip(&REGISTERS))
    }

    fn s7200_place(&self, port: u32) -> Option<Place<'_>> {
        self.s7200_places().nth(usize::try_from(port).ok()?)
    }

    fn s7200_control(&self, byte: u8) -> Control {
        let row = self.s7200().map(|own| own.image.cpu).unwrap_or_default();
        Control::of(byte, &row)
    }

    /// The current settings of a port.
    pub(super) fn s7200_port_mode(&self, port: u32) -> Option<Mode> {
        let (_, registers) = self.s7200_place(port)?;
        Some(self.s7200_control(self.memory.byte(special(registers.control))).mode)
    }

    /// RUN begins: opens the connections of the ports from plc.toml.
    pub(crate) fn s7200_start_ports(&self) {
        let Some(own) = self.s7200() else { return };
        let now = self.clock.now();
        for (port, registers) in self.s7200_places() {
            let mut port = port.borrow_mut();
            port.reset(now);
            port.control_byte = 0;
            set_special(&self.memory, TRANSMITTER_BYTE, registers.idle_bit, true);
        }
        for wanted in &own.config.ports {
            let Some((port, _)) = self.s7200_place(u32::from(wanted.number)) else { continue };
            let mut port = port.borrow_mut();
            if port.stream.is_some() {
                continue;
            }
            match Stream::open(&wanted.link) {
                Ok(stream) => port.stream = Some(stream),
                Err(message) => crate::run::say!("runtime: port {}: {message}", wanted.number),
            }
        }
    }

    /// When a port next does something: end of a transmission, idle time, message timer.
    pub(crate) fn s7200_ports_due(&self) -> u64 {
        let due = |(port, _): Place| {
            let port = port.borrow();
            let look = if self.clock.is_virtual() || !self.s7200_control(port.control_byte).is_freeport() {
                NEVER
            } else {
                port.look_due(LOOK_NS)
            };
            port.due().min(look)
        };
        self.s7200_places().map(due).min().unwrap_or(NEVER)
    }

    /// Moves bytes, raises events.
    pub(crate) fn s7200_poll_ports(&self) {
        let now = self.clock.now();
        for place in self.s7200_places() {
            self.s7200_obey_control(place);
            if !self.clock.is_virtual() {
                self.s7200_look(place);
            }
            loop {
                let happened = place.0.borrow_mut().next(now);
                match happened {
                    Some(happened) => self.s7200_happened(place.1, happened),
                    None => break,
                }
            }
        }
    }

    /// Asks the streams at the end of a scan, for the virtual clock. True: there is one whose partner needs host time.
    pub(super) fn s7200_look_at_streams(&self) -> bool {
        let mut waits = false;
        for place in self.s7200_places() {
            self.s7200_obey_control(place);
            waits |= self.s7200_look(place);
        }
        waits
    }

    /// True: the port is in Freeport mode and has a stream.
    fn s7200_look(&self, (port, _): Place) -> bool {
        let mut port = port.borrow_mut();
        let control = self.s7200_control(port.control_byte);
        let open = control.is_freeport() && port.stream.is_some();
        if open {
            port.look(self.clock.now(), self.clock.is_virtual(), &control);
        }
        open
    }

    fn s7200_happened(&self, registers: &Registers, happened: Happened) {
        match happened {
            Happened::Nothing => {}
            Happened::Character { byte, faulty } => {
                // With a routine the values wait with the event.
                if !self.s7200_is_attached(registers.character_event) {
                    self.memory.set_byte(special(RECEIVED_CHARACTER), byte);
                    set_special(&self.memory, PARITY_BYTE, 0, faulty);
                }
                self.s7200_raise(registers.character_event, Some((byte, faulty)));
            }
            Happened::Message { table, byte, step } => {
                if let Some(count) = step.stored {
                    self.memory.set_byte(table.saturating_add(u32::from(count)), byte);
                    self.memory.set_byte(table, count);
                }
                if step.ended != 0 {
                    self.memory.set_byte(special(registers.receive_status), step.ended);
                    self.s7200_raise(registers.message_event, None);
                }
            }
            Happened::Transmitted => {
                set_special(&self.memory, TRANSMITTER_BYTE, registers.idle_bit, true);
                self.s7200_raise(registers.transmit_event, None);
            }
        }
    }

    fn s7200_raise(&self, event: u8, data: EventData) {
        #[cfg(test)]
        self.s7200().into_iter().for_each(|own| own.freeport.raised.borrow_mut().push((event, data)));
        self.s7200_event(event, data);
    }

    /// The program wrote SMB30 or SMB130.
    pub(crate) fn s7200_port_control_written(&self, port: u8) {
        let Some(place) = self.s7200_place(u32::from(port)) else { return };
        let register = special(place.1.control);
        let old = place.0.borrow().control_byte;
        let begins =
            !self.s7200_control(old).is_freeport() && self.s7200_control(self.memory.byte(register)).is_freeport();
        if begins && self.s7200_in_interrupt() {
            self.memory.set_byte(register, old);
            self.s7200_error(NO_SITE, error::FREEPORT_IN_INTERRUPT);
        } else {
            self.s7200_obey_control(place);
        }
    }

    /// Follows SMB30. Another mode ends XMT and RCV without events.
    fn s7200_obey_control(&self, (port, registers): Place) {
        let byte = self.memory.byte(special(registers.control));
        let mut port = port.borrow_mut();
        if byte == port.control_byte {
            return;
        }
        let (old, new) = (self.s7200_control(port.control_byte), self.s7200_control(byte));
        port.control_byte = byte;
        if old.is_freeport() != new.is_freeport() {
            port.reset(self.clock.now());
            set_special(&self.memory, TRANSMITTER_BYTE, registers.idle_bit, true);
        }
        if new.is_freeport()
            && let Some(stream) = &mut port.stream
        {
            stream.configure(&new);
        }
    }

    /// Bytes arrive at a port, from a scenario. A port that is not in Freeport mode loses them.
    pub fn s7200_feed(&self, port: u8, bytes: &[u8], parity_error: bool) {
        let arrived = bytes.iter().map(|&byte| Arrived::Character { byte, faulty: parity_error });
        self.s7200_put(port, &arrived.collect::<Vec<_>>());
    }

    /// A break arrives at a port.
    pub fn s7200_feed_break(&self, port: u8) {
        self.s7200_put(port, &[Arrived::Break]);
    }

    fn s7200_put(&self, port: u8, arrived: &[Arrived]) {
        let Some(place) = self.s7200_place(u32::from(port)) else { return };
        self.s7200_obey_control(place);
        let mut port = place.0.borrow_mut();
        let control = self.s7200_control(port.control_byte);
        if control.is_freeport() {
            port.put(arrived, self.clock.now(), &control);
        }
    }

    /// The characters that a port has sent since the last call.
    pub fn s7200_take_sent(&self, port: u8) -> Vec<u8> {
        self.s7200_place(u32::from(port))
            .map(|(port, _)| std::mem::take(&mut port.borrow_mut().sent))
            .unwrap_or_default()
    }
}

/// The port of XMT or RCV, with its settings. `Err`: the result of the instruction.
fn freeport<'a>(cpu: &'a Cpu, operands: &Operands) -> Result<(Place<'a>, Control), u64> {
    let place = cpu.s7200_place(operands.b).ok_or_else(|| failed(cpu, operands, error::RANGE))?;
    cpu.s7200_obey_control(place);
    let control = cpu.s7200_control(place.0.borrow().control_byte);
    // Outside of Freeport mode there is no ENO, and no error.
    if control.is_freeport() { Ok((place, control)) } else { Err(failed_quietly()) }
}

/// Whether `bytes` bytes from `table` on are in one area.
fn fits(cpu: &Cpu, table: u32, bytes: u32) -> bool {
    cpu.s7200_area(table).is_some_and(|(_, end)| end.saturating_sub(table) >= bytes)
}

pub(super) fn transmit(cpu: &Cpu, operands: &Operands) -> u64 {
    let ((port, registers), control) = match freeport(cpu, operands) {
        Ok(found) => found,
        Err(result) => return result,
    };
    if port.borrow().is_busy() {
        return failed(cpu, operands, registers.busy_error);
    }
    let count = u32::from(cpu.memory.byte(operands.a));
    if !fits(cpu, operands.a, count + 1) {
        return failed(cpu, operands, error::RANGE);
    }
    let mut bytes = Vec::new();
    cpu.memory.view(operands.a.saturating_add(1), count, |table| bytes.extend_from_slice(table));
    port.borrow_mut().transmit(&bytes, cpu.clock.now(), &control);
    set_special(&cpu.memory, TRANSMITTER_BYTE, registers.idle_bit, false);
    done()
}

pub(super) fn receive(cpu: &Cpu, operands: &Operands) -> u64 {
    let ((port, registers), _) = match freeport(cpu, operands) {
        Ok(found) => found,
        Err(result) => return result,
    };
    let memory = &cpu.memory;
    let wanted = memory.byte(registers.receive_control());
    if wanted & control::ENABLE == 0 {
        if port.borrow_mut().receiver.take().is_some() {
            memory.set_byte(special(registers.receive_status), status::ABORTED);
        }
        return done();
    }
    if port.borrow().is_busy() {
        return failed(cpu, operands, registers.busy_error);
    }
    let most = memory.byte(registers.most_characters());
    let criteria = Criteria::of(
        wanted,
        memory.byte(registers.start_character()),
        memory.byte(registers.end_character()),
        memory.word(registers.idle_time()),
        memory.word(registers.timer()),
        most,
    );
    let Some(criteria) = criteria else {
        // No event: a routine that begins the next message would run for ever.
        memory.set_byte(special(registers.receive_status), status::PARAMETER);
        return failed_quietly();
    };
    if !fits(cpu, operands.a, u32::from(most) + 1) {
        return failed(cpu, operands, error::RANGE);
    }
    memory.set_byte(special(registers.receive_status), 0);
    memory.set_byte(operands.a, 0);
    port.borrow_mut().receiver = Some((Receiver::begin(criteria, cpu.clock.now()), operands.a));
    done()
}
