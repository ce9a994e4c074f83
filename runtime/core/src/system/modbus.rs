//! The runtime part of MB_CLIENT and MB_SERVER: frames of Modbus TCP, and the data that they carry.
//!
//! A frame is a head of six bytes (transaction, protocol 0, length) and a body of that length (unit, function, data). Registers are
//! words with the high byte first, as in memory; the first of several bits is the lowest one of the first byte.
//!
//! Source: S7-1200 reference, MB_CLIENT and MB_SERVER; Modbus application protocol V1.1b3; Modbus messaging on TCP/IP.

use plcc_abi::layout::area;

use super::any::{self, Access, Range};
use super::parameters::Call;
use super::{OK, Outcome, error, variants};
use crate::cpu::Area;

/// STATUS of a request that cannot be made.
const MODE: u16 = 0x8188;
const ADDRESS: u16 = 0x8189;
const LENGTH: u16 = 0x818A;
const DATA: u16 = 0x818B;
/// MB_HOLD_REG cannot be used.
const HOLDING: u16 = 0x8187;
/// STATUS of what a partner sends.
const FORMAT: u16 = 0x8380;
const FUNCTION: u16 = 0x8381;
const WRONG_LENGTH: u16 = 0x8382;
const WRONG_ADDRESS: u16 = 0x8383;
const WRONG_VALUE: u16 = 0x8384;
const WRONG_DIAGNOSTIC: u16 = 0x8385;
const OTHER_FUNCTION: u16 = 0x8386;
const PROTOCOL: u16 = 0x8387;
const OTHER_LENGTH: u16 = 0x8388;
/// RET_VAL of [`response`]: it belongs to another request.
const OTHER_TRANSACTION: u16 = 1;

const HEAD_BYTES: usize = 6;
/// Head, unit, function.
const DATA_AT: usize = 8;
/// The longest body: unit, and 253 bytes of function and data.
const BODY_MAX: usize = 254;
/// In the function of an answer: it is an exception.
const EXCEPTION: u8 = 0x80;

const READ_COILS: u8 = 1;
const READ_INPUTS: u8 = 2;
const READ_HOLDING: u8 = 3;
const READ_INPUT_REGISTERS: u8 = 4;
const WRITE_COIL: u8 = 5;
const WRITE_REGISTER: u8 = 6;
const DIAGNOSTICS: u8 = 8;
const EVENT_COUNTER: u8 = 11;
const WRITE_COILS: u8 = 15;
const WRITE_REGISTERS: u8 = 16;

/// Subfunctions of DIAGNOSTICS.
const ECHO: u16 = 0x0000;
const CLEAR: u16 = 0x000A;
/// What a coil gets that becomes 1.
const COIL_ON: u16 = 0xFF00;

/// Most bits or registers that a function reads or writes.
fn count_max(function: u8) -> u16 {
    match function {
        READ_COILS | READ_INPUTS => 2000,
        WRITE_COILS => 1968,
        READ_HOLDING | READ_INPUT_REGISTERS => 125,
        WRITE_REGISTERS => 123,
        _ => 1,
    }
}

/// Function and first bit or register that mode, address and length mean. `Err`: STATUS.
fn request_of(mode: u8, address: u32, count: u16) -> Result<(u8, u16), u16> {
    let one = count == 1;
    let function = match (mode, address) {
        (0, 1..=9999) => READ_COILS,
        (0, 10001..=19999) => READ_INPUTS,
        (0, 30001..=39999) => READ_INPUT_REGISTERS,
        (0, 40001..=49999 | 400_001..=465_536) => READ_HOLDING,
        (1, 1..=9999) if one => WRITE_COIL,
        (1, 40001..=49999 | 400_001..=465_536) if one => WRITE_REGISTER,
        (1 | 2, 1..=9999) => WRITE_COILS,
        (1 | 2, 40001..=49999 | 400_001..=465_536) => WRITE_REGISTERS,
        (0..=2, _) => return Err(ADDRESS),
        (11, _) => EVENT_COUNTER,
        (80 | 81, _) => DIAGNOSTICS,
        (101..=106 | 115 | 116, _) => mode - 100,
        _ => return Err(MODE),
    };
    let start = match (mode, address) {
        (11, _) => return Ok((function, 0)),
        (80, _) => return Ok((function, ECHO)),
        (81, _) => return Ok((function, CLEAR)),
        (0..=2, 400_001..) => address - 400_001,
        (0..=2, 40001..) => address - 40001,
        (0..=2, 30001..) => address - 30001,
        (0..=2, 10001..) => address - 10001,
        (0..=2, _) => address - 1,
        _ => address,
    };
    let start = u16::try_from(start).map_err(|_| ADDRESS)?;
    if count == 0 || count > count_max(function) {
        return Err(LENGTH);
    }
    if u32::from(start) + u32::from(count) > 0x1_0000 {
        return Err(ADDRESS);
    }
    Ok((function, start))
}

/// Data of the program, as bits or as registers.
struct Place {
    offset: u32,
    /// Of the first bit.
    bit: u8,
    bits: u32,
}

impl Place {
    /// What parameter `index` points to; `None`: it cannot be used.
    fn of(call: &Call, index: usize, access: Access) -> Option<Place> {
        const BOOL: u8 = 0x01;
        let any = call.any(index);
        if any.head >> 16 != 0x1000 | u32::from(BOOL) {
            let range =
                any::decode(call, index, access).ok().flatten().filter(|range| range.existing == range.bytes)?;
            return Some(Place { offset: range.offset, bit: 0, bits: range.bytes * 8 });
        }
        let bits = any.head & 0xFFFF;
        let last = plcc_abi::any::Fields { pointer: any.pointer + bits.checked_sub(1)?, ..any };
        let (offset, bit) = variants::bit_place(call, any)?;
        variants::bit_place(call, last)?;
        if access == Access::Write && (any.pointer >> 24) as u8 == area::Q {
            call.cpu.note_outputs(u32::MAX);
        }
        let protected = matches!((any.pointer >> 24) as u8, area::DB | area::DI) && call.cpu.is_read_only(any.db);
        (access == Access::Read || !protected).then_some(Place { offset, bit, bits })
    }

    /// All of a memory area of the CPU.
    fn area(call: &Call, area: Area) -> Place {
        let (offset, bytes) = call.cpu.area(area);
        Place { offset, bit: 0, bits: bytes * 8 }
    }

    fn has_bits(&self, start: u16, count: u16) -> bool {
        u32::from(start) + u32::from(count) <= self.bits
    }

    fn has_registers(&self, start: u32, count: u16) -> bool {
        self.bit == 0 && (start + u32::from(count)) * 16 <= self.bits
    }

    fn bit_at(&self, index: u32) -> (u32, u8) {
        let at = u32::from(self.bit) + index;
        (self.offset + at / 8, (at % 8) as u8)
    }

    fn read_bits(&self, call: &Call, start: u16, count: u16) -> Vec<u8> {
        let mut bytes = vec![0; usize::from(count.div_ceil(8))];
        for index in 0..count {
            let (offset, bit) = self.bit_at(u32::from(start) + u32::from(index));
            bytes[usize::from(index / 8)] |= u8::from(call.cpu.memory.bit(offset, bit)) << (index % 8);
        }
        bytes
    }

    fn write_bits(&self, call: &Call, start: u16, count: u16, bytes: &[u8]) {
        for index in 0..count {
            let (offset, bit) = self.bit_at(u32::from(start) + u32::from(index));
            call.cpu.memory.set_bit(offset, bit, bytes[usize::from(index / 8)] >> (index % 8) & 1 != 0);
        }
    }

    fn read_registers(&self, call: &Call, start: u32, count: u16) -> Vec<u8> {
        call.cpu.memory.view(self.offset + start * 2, u32::from(count) * 2, <[u8]>::to_vec)
    }

    fn write_registers(&self, call: &Call, start: u32, bytes: &[u8]) {
        call.cpu.memory.load(self.offset + start * 2, bytes);
    }
}

fn word(bytes: &[u8], at: usize) -> u16 {
    u16::from_be_bytes([bytes[at], bytes[at + 1]])
}

/// The bytes of a buffer of the library.
fn bytes_of(call: &Call, index: usize) -> Vec<u8> {
    let range = any::decode(call, index, Access::Read).ok().flatten();
    range.map(|range| call.cpu.memory.view(range.offset, range.existing, <[u8]>::to_vec)).unwrap_or_default()
}

/// Writes a frame to a buffer of the library; its length is parameter `length`.
fn set_frame(call: &Call, buffer: usize, length: usize, frame: &[u8]) {
    if let Ok(Some(Range { offset, existing, .. })) = any::decode(call, buffer, Access::Write)
        && frame.len() <= existing as usize
    {
        call.cpu.memory.load(offset, frame);
        call.set_word(length, frame.len() as u16);
    }
}

/// Head and body around function and data.
fn frame(transaction: u16, unit: u8, body: &[u8]) -> Vec<u8> {
    let mut frame = transaction.to_be_bytes().to_vec();
    frame.extend([0, 0]);
    frame.extend((body.len() as u16 + 1).to_be_bytes());
    frame.push(unit);
    frame.extend(body);
    frame
}

/// MODE, ADDRESS, LEN, UNIT, TRANSACTION, DATA -> RET_VAL, LENGTH, FRAME: what a client sends.
pub(super) fn request(call: &Call) -> Outcome {
    let (length, buffer) = (7, 8);
    match asked(call) {
        Ok(body) => {
            set_frame(call, buffer, length, &frame(call.word(4), call.byte(3), &body));
            OK
        }
        Err(status) => error(status),
    }
}

fn asked(call: &Call) -> Result<Vec<u8>, u16> {
    let (count, data) = (call.word(2), 5);
    let (function, start) = request_of(call.byte(0), call.dword(1), count)?;
    let mut body = vec![function];
    if function != EVENT_COUNTER {
        body.extend(start.to_be_bytes());
    }
    let place = |access| Place::of(call, data, access).ok_or(DATA);
    let bits = |access| place(access).and_then(|place| place.has_bits(0, count).then_some(place).ok_or(DATA));
    let registers =
        |access, count| place(access).and_then(|place| place.has_registers(0, count).then_some(place).ok_or(DATA));
    match function {
        READ_COILS | READ_INPUTS => {
            bits(Access::Write)?;
            body.extend(count.to_be_bytes());
        }
        READ_HOLDING | READ_INPUT_REGISTERS => {
            registers(Access::Write, count)?;
            body.extend(count.to_be_bytes());
        }
        WRITE_COIL => {
            let on = bits(Access::Read)?.read_bits(call, 0, 1)[0] != 0;
            body.extend(if on { COIL_ON } else { 0 }.to_be_bytes());
        }
        WRITE_REGISTER => body.extend(registers(Access::Read, 1)?.read_registers(call, 0, 1)),
        WRITE_COILS => {
            let bytes = bits(Access::Read)?.read_bits(call, 0, count);
            body.extend(count.to_be_bytes());
            body.push(bytes.len() as u8);
            body.extend(bytes);
        }
        WRITE_REGISTERS => {
            let bytes = registers(Access::Read, count)?.read_registers(call, 0, count);
            body.extend(count.to_be_bytes());
            body.push(bytes.len() as u8);
            body.extend(bytes);
        }
        EVENT_COUNTER => _ = registers(Access::Write, 2)?,
        // Of diagnostics, a word that comes back.
        _ => body.extend([0, 0]),
    }
    Ok(body)
}

/// REQUEST, HEAD, BODY -> RET_VAL, DATA: takes what a server answers; 1: it answers another request.
pub(super) fn response(call: &Call) -> Outcome {
    let (request, head, mut body) = (bytes_of(call, 0), bytes_of(call, 1), bytes_of(call, 2));
    if request.len() < DATA_AT + 4 || head.len() < HEAD_BYTES {
        return error(FORMAT);
    }
    body.truncate(usize::from(word(&head, 4)));
    if request[..2] != head[..2] {
        return Outcome::RetVal(OTHER_TRANSACTION);
    }
    match answered(call, &request, &head, &body) {
        Ok(()) => OK,
        Err(status) => error(status),
    }
}

fn answered(call: &Call, request: &[u8], head: &[u8], body: &[u8]) -> Result<(), u16> {
    let function = request[DATA_AT - 1];
    if word(head, 2) != 0 {
        return Err(PROTOCOL);
    }
    let Some((&answer, data)) = body.get(1..).and_then(<[u8]>::split_first) else { return Err(FORMAT) };
    if answer == function | EXCEPTION {
        return Err(match data.first() {
            Some(1) => FUNCTION,
            Some(2) => WRONG_ADDRESS,
            Some(3) if function == DIAGNOSTICS => WRONG_DIAGNOSTIC,
            Some(_) => WRONG_VALUE,
            None => FORMAT,
        });
    }
    if answer != function {
        return Err(OTHER_FUNCTION);
    }
    let count = word(request, DATA_AT + 2);
    let place = || Place::of(call, 4, Access::Write).ok_or(DATA);
    match function {
        READ_COILS | READ_INPUTS => {
            let bytes = counted(data, usize::from(count.div_ceil(8)))?;
            place()?.write_bits(call, 0, count, bytes);
        }
        READ_HOLDING | READ_INPUT_REGISTERS => {
            let bytes = counted(data, usize::from(count) * 2)?;
            place()?.write_registers(call, 0, bytes);
        }
        EVENT_COUNTER => {
            let bytes = data.get(..4).ok_or(FORMAT)?;
            place()?.write_registers(call, 0, bytes);
        }
        // The others come back as they were sent, up to the data of several.
        _ if data.len() < 4 => return Err(FORMAT),
        _ if data[..4] != request[DATA_AT..12] => return Err(WRONG_VALUE),
        _ => {}
    }
    Ok(())
}

/// The data after its number of bytes. `Err`: STATUS.
fn counted(data: &[u8], bytes: usize) -> Result<&[u8], u16> {
    let (&told, data) = data.split_first().ok_or(FORMAT)?;
    if usize::from(told) != bytes {
        return Err(OTHER_LENGTH);
    }
    data.get(..bytes).ok_or(FORMAT)
}

/// What a request did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Effect {
    None = 0,
    Read = 1,
    Written = 2,
    Cleared = 3,
}

/// HEAD, BODY, FIRST (number of the first holding register), EVENTS -> RET_VAL, LENGTH, EFFECT, FRAME, HOLD: answers a client. With an
/// error the answer is an exception.
pub(super) fn reply(call: &Call) -> Outcome {
    let (length, effect, buffer) = (5, 6, 7);
    let (head, mut body) = (bytes_of(call, 0), bytes_of(call, 1));
    if head.len() < HEAD_BYTES {
        return error(FORMAT);
    }
    body.truncate(usize::from(word(&head, 4)).min(BODY_MAX));
    let [unit, function, data @ ..] = &body[..] else { return error(FORMAT) };
    if word(&head, 2) != 0 {
        return error(PROTOCOL);
    }
    let (status, answer) = match served(call, *function, data) {
        Ok((what, mut answer)) => {
            call.set_byte(effect, what as u8);
            answer.insert(0, *function);
            (0, answer)
        }
        Err((status, exception)) => (status, vec![function | EXCEPTION, exception]),
    };
    set_frame(call, buffer, length, &frame(word(&head, 0), *unit, &answer));
    if status == 0 { OK } else { error(status) }
}

/// Does a request: what it did, and the data of the answer. `Err`: STATUS, and the code of the exception.
fn served(call: &Call, function: u8, data: &[u8]) -> Result<(Effect, Vec<u8>), (u16, u8)> {
    const BAD_FUNCTION: (u16, u8) = (FUNCTION, 1);
    const BAD_ADDRESS: (u16, u8) = (WRONG_ADDRESS, 2);
    const BAD_LENGTH: (u16, u8) = (WRONG_LENGTH, 3);
    const BAD_VALUE: (u16, u8) = (WRONG_VALUE, 3);
    const BAD_DIAGNOSTIC: (u16, u8) = (WRONG_DIAGNOSTIC, 3);
    if function == EVENT_COUNTER {
        let mut answer = vec![0, 0];
        answer.extend(call.word(3).to_be_bytes());
        return Ok((Effect::None, answer));
    }
    let known = matches!(function, READ_COILS..=WRITE_REGISTER | DIAGNOSTICS | WRITE_COILS | WRITE_REGISTERS);
    if !known {
        return Err(BAD_FUNCTION);
    }
    let fields = data.get(..4).ok_or(BAD_LENGTH)?;
    let (start, count) = (word(fields, 0), word(fields, 2));
    if function == DIAGNOSTICS {
        return match start {
            ECHO => Ok((Effect::None, data.to_vec())),
            CLEAR => Ok((Effect::Cleared, data.to_vec())),
            _ => Err(BAD_DIAGNOSTIC),
        };
    }
    let many = !matches!(function, WRITE_COIL | WRITE_REGISTER);
    if many && (count == 0 || count > count_max(function)) {
        return Err(BAD_LENGTH);
    }
    let bits = |area| {
        let place = Place::area(call, area);
        let count = if many { count } else { 1 };
        if place.has_bits(start, count) { Ok(place) } else { Err(BAD_ADDRESS) }
    };
    let registers = |place: Place, start: u32| {
        let count = if many { count } else { 1 };
        if place.has_registers(start, count) { Ok(place) } else { Err(BAD_ADDRESS) }
    };
    let holding = |access| {
        let place = Place::of(call, 8, access).ok_or((HOLDING, 2))?;
        let first = u32::from(start).checked_sub(u32::from(call.word(2))).ok_or(BAD_ADDRESS)?;
        Ok((registers(place, first)?, first))
    };
    // Data of a request that writes several, after its number of bytes.
    let several = |bytes: u16| {
        let (&told, rest) = data[4..].split_first().ok_or(BAD_LENGTH)?;
        if u16::from(told) == bytes && rest.len() >= usize::from(bytes) { Ok(rest) } else { Err(BAD_LENGTH) }
    };
    let with_count = |bytes: Vec<u8>| [vec![bytes.len() as u8], bytes].concat();
    let echoed = || fields.to_vec();
    match function {
        READ_COILS => Ok((Effect::Read, with_count(bits(Area::Outputs)?.read_bits(call, start, count)))),
        READ_INPUTS => Ok((Effect::Read, with_count(bits(Area::Inputs)?.read_bits(call, start, count)))),
        READ_INPUT_REGISTERS => {
            let place = registers(Place::area(call, Area::Inputs), start.into())?;
            Ok((Effect::Read, with_count(place.read_registers(call, start.into(), count))))
        }
        READ_HOLDING => {
            let (place, first) = holding(Access::Read)?;
            Ok((Effect::Read, with_count(place.read_registers(call, first, count))))
        }
        WRITE_REGISTER => {
            let (place, first) = holding(Access::Write)?;
            place.write_registers(call, first, &fields[2..]);
            Ok((Effect::Written, echoed()))
        }
        WRITE_REGISTERS => {
            let bytes = several(count * 2)?;
            let (place, first) = holding(Access::Write)?;
            place.write_registers(call, first, &bytes[..usize::from(count) * 2]);
            Ok((Effect::Written, echoed()))
        }
        WRITE_COIL => {
            let place = bits(Area::Outputs)?;
            if !matches!(count, 0 | COIL_ON) {
                return Err(BAD_VALUE);
            }
            call.cpu.note_outputs(u32::MAX);
            place.write_bits(call, start, 1, &[u8::from(count == COIL_ON)]);
            Ok((Effect::Written, echoed()))
        }
        WRITE_COILS => {
            let bytes = several(count.div_ceil(8))?;
            let place = bits(Area::Outputs)?;
            call.cpu.note_outputs(u32::MAX);
            place.write_bits(call, start, count, bytes);
            Ok((Effect::Written, echoed()))
        }
        _ => Err(BAD_FUNCTION),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: S7-1200 reference, MB_CLIENT, table of MB_MODE.
    #[test]
    fn modes_and_addresses_choose_functions() {
        let rows = [
            ((0, 1, 1), Ok((READ_COILS, 0))),
            ((0, 9999, 1), Ok((READ_COILS, 9998))),
            ((0, 10001, 2000), Ok((READ_INPUTS, 0))),
            ((0, 10001, 2001), Err(LENGTH)),
            ((0, 30001, 125), Ok((READ_INPUT_REGISTERS, 0))),
            ((0, 40010, 126), Err(LENGTH)),
            ((0, 40010, 2), Ok((READ_HOLDING, 9))),
            ((0, 465_536, 1), Ok((READ_HOLDING, 65535))),
            ((0, 465_536, 2), Err(ADDRESS)),
            ((0, 20001, 1), Err(ADDRESS)),
            ((1, 5, 1), Ok((WRITE_COIL, 4))),
            ((1, 5, 2), Ok((WRITE_COILS, 4))),
            ((1, 40001, 1), Ok((WRITE_REGISTER, 0))),
            ((1, 40001, 123), Ok((WRITE_REGISTERS, 0))),
            ((1, 40001, 124), Err(LENGTH)),
            ((1, 30001, 1), Err(ADDRESS)),
            ((2, 5, 1), Ok((WRITE_COILS, 4))),
            ((2, 40001, 1), Ok((WRITE_REGISTERS, 0))),
            ((103, 40000, 1), Ok((READ_HOLDING, 40000))),
            ((106, 3, 1), Ok((WRITE_REGISTER, 3))),
            ((106, 3, 2), Err(LENGTH)),
            ((0, 1, 0), Err(LENGTH)),
            ((3, 1, 1), Err(MODE)),
            ((107, 1, 1), Err(MODE)),
        ];
        for ((mode, address, count), expected) in rows {
            assert_eq!(request_of(mode, address, count), expected, "{mode} {address} {count}");
        }
    }

    #[test]
    fn a_frame_tells_its_length() {
        assert_eq!(frame(0x0102, 7, &[3, 0, 0, 0, 1]), [1, 2, 0, 0, 0, 6, 7, 3, 0, 0, 0, 1]);
    }
}
