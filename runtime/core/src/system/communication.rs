//! Open user communication: the runtime part of TCON, TSEND_C, …. RET_VAL is a STATUS.
//!
//! Source: S7-1200 reference, TSEND_C and TRCV_C, tables of STATUS.

use std::net::{Ipv4Addr, SocketAddrV4};

use plcc_abi::image::Family;
use plcc_abi::layout::area;

use super::any::{self, Access, Range};
use super::parameters::Call;
use super::{OK, Outcome, error};
use crate::communication::{DATAGRAM_BYTES_MAX, Description, JOB_BYTES_MAX, LENGTHS, Protocol, Receive, status};

/// Sending or receiving is in progress.
const RUNNING: u16 = 0x7002;
const LENGTH: u16 = 0x8085;
const ID: u16 = 0x8086;
const AREA_SHORT: u16 = 0x8088;
const NO_DATA_BLOCK: u16 = 0x8089;
const CONNECT_LENGTH: u16 = 0x809A;
const UNLINKED: u16 = 0x80B2;
const CONNECT_AREA: u16 = 0x8722;
const CONNECT_ACCESS: u16 = 0x873A;

/// The address of a partner cannot be used, or is not there.
const PARTNER_ADDRESS: u16 = 0x80A4;
const PARTNER_AREA: u16 = 0x80B7;
/// Length of TADDR_Param.
const PARTNER_BYTES: u32 = 8;

/// LEN of a job that receives whatever has arrived.
const AD_HOC: u32 = 65_535;

/// RET_VAL of [`state`].
const MISSING: u16 = 0;
const ESTABLISHING: u16 = 1;
const ESTABLISHED: u16 = 2;

fn status(result: Result<(), u16>) -> Outcome {
    match result {
        Ok(()) => OK,
        Err(code) => error(code),
    }
}

/// CONNECT, ID (0: that of the description), ALONE (no connection of this ID may exist) -> RET_VAL, HANDLE: the ID.
pub(super) fn open(call: &Call) -> Outcome {
    let described = description(call).and_then(|description| match call.word(1) {
        0 => Ok(description),
        id if !(1..=4095).contains(&id) => Err(ID),
        id if id != description.id => Err(status::INCONSISTENT),
        _ => Ok(description),
    });
    let description = match described {
        Ok(description) => description,
        Err(code) => return error(code),
    };
    call.set_word(4, description.id);
    let now = call.cpu.clock.now();
    status(call.cpu.connections().open(description, call.byte(2) & 1 != 0, now))
}

fn description(call: &Call) -> Result<Description, u16> {
    let any = call.any(0);
    if !matches!((any.pointer >> 24) as u8, area::DB | area::DI) {
        return Err(NO_DATA_BLOCK);
    }
    let number = any.db;
    if call.cpu.image.dbs.iter().any(|db| db.number == number && db.unlinked) {
        return Err(UNLINKED);
    }
    if call.cpu.memory.db(number).1 == 0 {
        return Err(CONNECT_ACCESS);
    }
    let range = any::decode(call, 0, Access::Read).map_err(|_| CONNECT_AREA)?.ok_or(CONNECT_AREA)?;
    if !LENGTHS.contains(&(range.bytes as usize)) {
        return Err(CONNECT_LENGTH);
    }
    if range.existing < range.bytes {
        return Err(CONNECT_AREA);
    }
    let mut found = Err(CONNECT_AREA);
    let is_portal = matches!(call.cpu.image.profile.family, Family::S71200 | Family::S71500);
    call.cpu.memory.view(range.offset, range.bytes, |bytes| found = Description::read(bytes, !is_portal));
    found
}

/// HANDLE -> RET_VAL: 0 there is none, 1 being established, 2 established; LOSSES and FAILURES, counted.
pub(super) fn state(call: &Call) -> Outcome {
    let mut communication = call.cpu.connections();
    let Some(connection) = communication.connection(call.word(0)) else { return Outcome::RetVal(MISSING) };
    connection.work(call.cpu.clock.now());
    call.set_word(2, connection.losses);
    call.set_word(3, connection.failures);
    if connection.is_up() {
        return Outcome::RetVal(ESTABLISHED);
    }
    communication.note_waiting();
    Outcome::RetVal(ESTABLISHING)
}

/// HANDLE -> RET_VAL: 0, 8086, 80A3; the connection type of TCON_IP_v4, ACTIVE, SENT and RECEIVED bytes.
pub(super) fn diagnosis(call: &Call) -> Outcome {
    let id = call.word(0);
    if !(1..=4095).contains(&id) {
        return error(ID);
    }
    let mut communication = call.cpu.connections();
    let Some(connection) = communication.connection(id) else { return error(status::NO_SUCH) };
    let kind = match connection.description.protocol {
        Protocol::Tcp => 0x0B,
        Protocol::Iso => 0x0C,
        Protocol::Udp => 0x13,
    };
    call.set_byte(2, kind);
    call.set_bool(3, connection.description.active);
    call.set_dword(4, connection.sent_bytes);
    call.set_dword(5, connection.received_bytes);
    OK
}

/// HANDLE, FORCE (for all blocks that use it) -> RET_VAL: 0, 80A3.
pub(super) fn close(call: &Call) -> Outcome {
    let id = call.word(0);
    if !(1..=4095).contains(&id) {
        return error(ID);
    }
    status(call.cpu.connections().close(id, call.byte(1) & 1 != 0))
}

/// HANDLE -> RET_VAL: 0, 8086, 80A3.
pub(super) fn reset(call: &Call) -> Outcome {
    let id = call.word(0);
    if !(1..=4095).contains(&id) {
        return error(ID);
    }
    let now = call.cpu.clock.now();
    match call.cpu.connections().connection(id) {
        Some(connection) => {
            connection.reset(now);
            status(Ok(()))
        }
        None => status(Err(status::NO_SUCH)),
    }
}

/// HANDLE, LEN (0: all of DATA), DATA -> RET_VAL: 0 it begins, 8085, 8086, 8088, 80A1.
pub(super) fn send(call: &Call) -> Outcome {
    let range = match job(call, call.dword(1), 2, Access::Read) {
        Ok(range) => range,
        Err(code) => return error(code),
    };
    let mut bytes = Vec::new();
    call.cpu.memory.view(range.offset, range.bytes, |data| bytes.extend_from_slice(data));
    let mut communication = call.cpu.connections();
    let Some(connection) = communication.connection(call.word(0)) else { return error(status::NOT_CONNECTED) };
    if connection.description.protocol == Protocol::Udp && range.bytes > DATAGRAM_BYTES_MAX {
        return error(LENGTH);
    }
    if !connection.send(&bytes) {
        return error(status::NOT_CONNECTED);
    }
    communication.note_waiting();
    OK
}

/// HANDLE, LEN (0: all of DATA), DATA, ADDR (TADDR_Param) -> RET_VAL: 0 it is sent, 8085, 8086, 8088, 80A1, 80A4, 80B3, 80B7, 80C4.
pub(super) fn send_to(call: &Call) -> Outcome {
    let length = call.dword(1);
    if length > DATAGRAM_BYTES_MAX {
        return error(LENGTH);
    }
    let (range, partner) =
        match job(call, length, 2, Access::Read).and_then(|range| Ok((range, partner(call, 3, Access::Read)?))) {
            Ok((range, _)) if range.bytes > DATAGRAM_BYTES_MAX => return error(LENGTH),
            Ok(found) => found,
            Err(code) => return error(code),
        };
    let bytes = call.cpu.memory.view(range.offset, range.bytes, <[u8]>::to_vec);
    let [a, b, c, d, high, low, ..] = call.cpu.memory.bytes::<{ PARTNER_BYTES as usize }>(partner.offset);
    let to = SocketAddrV4::new(Ipv4Addr::new(a, b, c, d), u16::from_be_bytes([high, low]));
    let mut communication = call.cpu.connections();
    let Some(connection) = communication.connection(call.word(0)) else { return error(status::NOT_CONNECTED) };
    if to.ip().is_unspecified() || to.port() == 0 {
        return error(PARTNER_ADDRESS);
    }
    match connection.send_to(&bytes, to) {
        Some(true) => OK,
        Some(false) => error(status::TEMPORARY),
        None => error(status::INCONSISTENT),
    }
}

/// HANDLE, LEN (0: as much as fits DATA) -> RET_VAL: 0, 7002 nothing yet, 8085, 8086, 8088, 80A1, 80B3, 80B7; RCVD_LEN; DATA and ADDR take what came.
pub(super) fn receive_from(call: &Call) -> Outcome {
    let (range, partner) = match job(call, call.dword(1), 4, Access::Write)
        .and_then(|range| Ok((range, partner(call, 5, Access::Write)?)))
    {
        Ok(found) => found,
        Err(code) => return error(code),
    };
    let mut communication = call.cpu.connections();
    let Some(connection) = communication.connection(call.word(0)) else { return error(status::NOT_CONNECTED) };
    match connection.receive_from(range.bytes as usize) {
        None => error(status::INCONSISTENT),
        Some((Receive::Bytes(bytes), from)) => {
            call.cpu.memory.load(range.offset, &bytes);
            call.set_dword(3, bytes.len() as u32);
            if let Some(from) = from {
                let [a, b, c, d] = from.ip().octets();
                let [high, low] = from.port().to_be_bytes();
                call.cpu.memory.load(partner.offset, &[a, b, c, d, high, low]);
            }
            OK
        }
        Some((Receive::TooLong, _)) => error(AREA_SHORT),
        Some((Receive::Nothing, _)) => {
            communication.note_waiting();
            Outcome::RetVal(RUNNING)
        }
    }
}

/// The address of a partner, parameter `index`. `Err`: STATUS.
fn partner(call: &Call, index: usize, access: Access) -> Result<Range, u16> {
    let range = any::decode(call, index, access).ok().flatten().ok_or(PARTNER_AREA)?;
    if range.bytes < PARTNER_BYTES || range.existing < PARTNER_BYTES {
        return Err(PARTNER_AREA);
    }
    Ok(range)
}

/// HANDLE -> RET_VAL: 0 all is sent, 7002 not yet, 80A1 not connected.
pub(super) fn sent(call: &Call) -> Outcome {
    let mut communication = call.cpu.connections();
    match communication.connection(call.word(0)).and_then(|connection| connection.is_sent()) {
        Some(true) => OK,
        Some(false) => {
            communication.note_waiting();
            Outcome::RetVal(RUNNING)
        }
        None => error(status::NOT_CONNECTED),
    }
}

/// HANDLE, LEN (0: as much as fits DATA; 65535: with TCP what there is), ADHOC (the same) -> RET_VAL: 0, 7002 nothing yet, 8085, 8086, 8088,
/// 80A1; RCVD_LEN; DATA takes it.
pub(super) fn receive(call: &Call) -> Outcome {
    let length = if call.dword(1) == AD_HOC { 0 } else { call.dword(1) };
    let range = match job(call, length, 5, Access::Write) {
        Ok(range) => range,
        Err(code) => return error(code),
    };
    let mut communication = call.cpu.connections();
    let Some(connection) = communication.connection(call.word(0)) else { return error(status::NOT_CONNECTED) };
    if !connection.is_up() {
        return error(status::NOT_CONNECTED);
    }
    let ad_hoc = call.byte(2) & 1 != 0 || length == 0;
    let exact = connection.description.protocol == Protocol::Tcp && !ad_hoc;
    match connection.receive(range.bytes as usize, exact) {
        Receive::Bytes(bytes) => {
            call.cpu.memory.load(range.offset, &bytes);
            call.set_dword(4, bytes.len() as u32);
            OK
        }
        Receive::TooLong => error(AREA_SHORT),
        Receive::Nothing => {
            communication.note_waiting();
            Outcome::RetVal(RUNNING)
        }
    }
}

/// The part of DATA, parameter `index`, that LEN names. With LEN 0 it is all of DATA, for receiving at most as much as a job takes. `Err`: STATUS.
fn job(call: &Call, length: u32, index: usize, access: Access) -> Result<Range, u16> {
    if !(1..=4095).contains(&call.word(0)) {
        return Err(ID);
    }
    if length > JOB_BYTES_MAX {
        return Err(LENGTH);
    }
    let range = any::decode(call, index, access).map_err(|_| AREA_SHORT)?.ok_or(AREA_SHORT)?;
    let bytes = match access {
        _ if length != 0 => length,
        Access::Write => range.bytes.min(JOB_BYTES_MAX),
        Access::Read if range.bytes > JOB_BYTES_MAX => return Err(LENGTH),
        Access::Read => range.bytes,
    };
    if bytes > range.bytes || bytes > range.existing {
        return Err(AREA_SHORT);
    }
    Ok(Range { bytes, ..range })
}
