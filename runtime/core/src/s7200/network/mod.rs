//! NETR, NETW, station addresses: the PPI link, as TCP between running programs. Source: S7-200 system manual, Network Read and Network
//! Write; docs/decisions/0060-ppi-on-tcp.md.
//!
//! - `frame`: the data on the link; `client`: requests of this station; `server`: requests of other stations.
//!
//! Everything moves between scans only, so a table changes there, too.

mod client;
mod frame;
mod server;
#[cfg(test)]
mod tests;

use std::cell::{Cell, RefCell};

use plcc_abi::s7200::{V_DB, error, pointer};

use self::client::{Client, Done};
use self::frame::{Body, DATA_MAX, Frame};
use self::server::Server;
use super::freeport::Mode;
use super::{Operands, done, failed, failed_quietly, value};
use crate::cpu::{Area, Cpu};
use crate::schedule::NEVER;

/// Error codes in the status byte of a table.
pub(super) mod code {
    pub const TIME_OUT: u8 = 1;
    pub const RECEIVE: u8 = 2;
    pub const QUEUE: u8 = 4;
    pub const NO_MASTER: u8 = 5;
    pub const PARAMETER: u8 = 6;
    pub const APPLICATION: u8 = 8;
    pub const MESSAGE: u8 = 9;
}

/// Status byte of a table.
const DONE: u8 = 0x80;
const ACTIVE: u8 = 0x40;
const FAILED: u8 = 0x20;
/// Offsets in a table.
const STATION: u32 = 1;
const POINTER: u32 = 2;
const LENGTH: u32 = 6;
const DATA: u32 = 7;

const STATION_DEFAULT: u8 = 2;
const STATION_MAX: u32 = 126;

/// Requests of this station, and requests from other stations.
pub struct Network {
    /// Station address by port.
    addresses: [Cell<u8>; 2],
    client: RefCell<Client>,
    server: RefCell<Option<Server>>,
}

impl Default for Network {
    fn default() -> Network {
        Network {
            addresses: [Cell::new(STATION_DEFAULT), Cell::new(STATION_DEFAULT)],
            client: RefCell::default(),
            server: RefCell::default(),
        }
    }
}

impl Cpu {
    /// RUN begins: listens for other stations if plc.toml says where.
    pub(crate) fn s7200_start_network(&self) {
        let Some(own) = self.s7200() else { return };
        let station = own.config.station.unwrap_or(STATION_DEFAULT);
        own.network.addresses.iter().for_each(|address| address.set(station));
        *own.network.client.borrow_mut() = Client::new(&own.config.stations);
        let mut server = own.network.server.borrow_mut();
        if let (None, Some(address)) = (&*server, &own.config.listen) {
            match Server::new(address) {
                Ok(new) => *server = Some(new),
                Err(message) => crate::run::say!("runtime: network: {message}"),
            }
        }
    }

    /// When a request next times out. It is checked only between scans.
    pub(crate) fn s7200_network_due(&self) -> u64 {
        NEVER
    }

    /// Between scans: answers other stations, and puts answers to own requests into their tables.
    pub(crate) fn s7200_poll_network(&self) {
        let Some(own) = self.s7200() else { return };
        let is_virtual = self.clock.is_virtual();
        let mut waits = is_virtual && self.s7200_look_at_streams();
        if let Some(server) = &mut *own.network.server.borrow_mut() {
            server.work(|frame| self.s7200_answer(frame));
            waits = true;
        }
        let ended = {
            let mut client = own.network.client.borrow_mut();
            let ended = client.work(self.clock.now(), is_virtual);
            waits |= client.is_waiting();
            ended
        };
        ended.iter().for_each(|done| self.s7200_end_request(done));
        // With the virtual clock a scan takes no host time, so a partner would never get to answer.
        if waits && let Ok(mut communication) = self.communication.try_borrow_mut() {
            self.has_jobs.set(true);
            communication.note_waiting();
        }
    }

    fn s7200_end_request(&self, Done { table, code, data }: &Done) {
        self.memory.load(table.saturating_add(DATA), data);
        self.memory.set_byte(*table, if *code == 0 { DONE } else { DONE | FAILED | code });
    }

    /// Answers another station. `None`: it does not mean this one, or no port is there for it.
    fn s7200_answer(&self, request: &Frame) -> Option<Frame> {
        let own = self.s7200()?;
        let ports = usize::from(own.image.cpu.ports).clamp(1, 2);
        let is_meant = |(port, address): (u32, &Cell<u8>)| {
            address.get() == request.to && self.s7200_port_mode(port).is_some_and(|mode| mode != Mode::Freeport)
        };
        if !(0u32..).zip(&own.network.addresses).take(ports).any(is_meant) {
            return None;
        }
        let (code, data) = match &request.body {
            Body::Read { pointer, count } => match self.s7200_remote(*pointer, usize::from(*count)) {
                Some(address) => {
                    let mut data = Vec::new();
                    self.memory.view(address, u32::from(*count), |bytes| data.extend_from_slice(bytes));
                    (0, data)
                }
                None => (code::MESSAGE, Vec::new()),
            },
            Body::Write { pointer, data } => match self.s7200_remote(*pointer, data.len()) {
                Some(address) => {
                    self.memory.load(address, data);
                    if pointer_area(*pointer) == Some(pointer::Q) {
                        self.note_outputs(u32::MAX);
                    }
                    (0, Vec::new())
                }
                None => (code::MESSAGE, Vec::new()),
            },
            Body::Answer { .. } => (code::APPLICATION, Vec::new()),
        };
        Some(Frame { to: request.from, from: request.to, tag: request.tag, body: Body::Answer { code, data } })
    }

    /// Offset from the memory base of the `bytes` bytes that another station points to.
    fn s7200_remote(&self, pointer: u32, bytes: usize) -> Option<u32> {
        let (start, length) = match pointer_area(pointer)? {
            pointer::I => self.area(Area::Inputs),
            pointer::Q => self.area(Area::Outputs),
            pointer::M => self.area(Area::BitMemory),
            _ => self.memory.db(V_DB),
        };
        let offset = pointer & 0x00FF_FFFF;
        let bytes = u32::try_from(bytes).ok().filter(|bytes| (1..=DATA_MAX as u32).contains(bytes))?;
        (offset.checked_add(bytes)? <= length).then_some(start + offset)
    }
}

/// The area tag of a pointer to another station: I, Q, M or V.
fn pointer_area(pointer: u32) -> Option<u8> {
    let [area, ..] = pointer.to_be_bytes();
    matches!(area, pointer::I | pointer::Q | pointer::M | pointer::V).then_some(area)
}

pub(super) fn read(cpu: &Cpu, operands: &Operands) -> u64 {
    request(cpu, operands, |pointer, count| Body::Read { pointer, count })
}

pub(super) fn write(cpu: &Cpu, operands: &Operands) -> u64 {
    request(cpu, operands, |pointer, count| {
        let mut data = Vec::new();
        cpu.memory.view(operands.a.saturating_add(DATA), u32::from(count), |bytes| data.extend_from_slice(bytes));
        Body::Write { pointer, data }
    })
}

/// Begins NETR or NETW, unless the last one with this table is still active.
fn request(cpu: &Cpu, operands: &Operands, body: impl FnOnce(u32, u8) -> Body) -> u64 {
    let table = operands.a;
    let (Some(own), Some(mode)) = (cpu.s7200(), cpu.s7200_port_mode(operands.b)) else {
        return failed(cpu, operands, error::RANGE);
    };
    let Some(room) = cpu.s7200_area(table).map(|(_, end)| end.saturating_sub(table)).filter(|room| *room >= DATA)
    else {
        return failed(cpu, operands, error::RANGE);
    };
    let memory = &cpu.memory;
    if memory.byte(table) & ACTIVE != 0 {
        return done();
    }
    let station = memory.byte(table + STATION);
    let pointer = memory.dword(table + POINTER);
    let count = memory.byte(table + LENGTH);
    let fits = (1..=DATA_MAX as u8).contains(&count) && u32::from(count) <= room - DATA;
    let wrong = if mode != Mode::PpiMaster {
        Some(code::NO_MASTER)
    } else if !fits || u32::from(station) > STATION_MAX || pointer_area(pointer).is_none() {
        Some(code::PARAMETER)
    } else if own.network.client.borrow().is_full() {
        Some(code::QUEUE)
    } else {
        None
    };
    if let Some(code) = wrong {
        memory.set_byte(table, DONE | FAILED | code);
        return failed_quietly();
    }
    memory.set_byte(table, ACTIVE);
    let from = address(cpu, operands.b).map_or(STATION_DEFAULT, Cell::get);
    own.network.client.borrow_mut().begin(table, station, from, body(pointer, count), cpu.clock.now());
    done()
}

fn address(cpu: &Cpu, port: u32) -> Option<&Cell<u8>> {
    cpu.s7200()?.network.addresses.get(usize::try_from(port).ok()?)
}

pub(super) fn get_address(cpu: &Cpu, operands: &Operands) -> u64 {
    match address(cpu, operands.a) {
        _ if cpu.s7200_in_interrupt() => failed(cpu, operands, error::NOT_IN_INTERRUPT),
        Some(address) => value(u32::from(address.get())),
        None => failed(cpu, operands, error::RANGE),
    }
}

pub(super) fn set_address(cpu: &Cpu, operands: &Operands) -> u64 {
    match (address(cpu, operands.b), u8::try_from(operands.a)) {
        _ if cpu.s7200_in_interrupt() => failed(cpu, operands, error::NOT_IN_INTERRUPT),
        (Some(address), Ok(station)) if operands.a <= STATION_MAX => {
            address.set(station);
            done()
        }
        _ => failed(cpu, operands, error::RANGE),
    }
}
