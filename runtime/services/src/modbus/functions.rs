//! The functions: a request, and its answer or an exception.

use super::identification;
use super::memory::Map;
use crate::s7::{ItemError, Plc};
use crate::wire::{Bytes, put16};

const READ_COILS: u8 = 1;
const READ_DISCRETE_INPUTS: u8 = 2;
const READ_HOLDING_REGISTERS: u8 = 3;
const READ_INPUT_REGISTERS: u8 = 4;
const WRITE_COIL: u8 = 5;
const WRITE_REGISTER: u8 = 6;
const WRITE_COILS: u8 = 15;
const WRITE_REGISTERS: u8 = 16;
const MASK_REGISTER: u8 = 22;
const READ_WRITE_REGISTERS: u8 = 23;

/// Most bits or registers of a function.
const BITS_READ_MAX: u16 = 2000;
const BITS_WRITTEN_MAX: u16 = 1968;
const REGISTERS_READ_MAX: u16 = 125;
const REGISTERS_WRITTEN_MAX: u16 = 123;
const REGISTERS_WRITTEN_AND_READ_MAX: u16 = 121;

/// In the function of an answer: it is an exception.
const EXCEPTION: u8 = 0x80;

/// Why there is no other answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Exception {
    Function = 1,
    Address = 2,
    Value = 3,
    Device = 4,
}

impl From<ItemError> for Exception {
    fn from(error: ItemError) -> Exception {
        match error {
            ItemError::OutOfRange | ItemError::Missing | ItemError::NotAllowed => Exception::Address,
            ItemError::TypeUnknown | ItemError::TypeInconsistent => Exception::Value,
            ItemError::Hardware => Exception::Device,
        }
    }
}

/// The answer to a request, both from the function on. `may_write`: the client may.
pub fn answer(request: &[u8], map: &Map, may_write: bool, plc: &dyn Plc) -> Vec<u8> {
    let mut rest = Bytes(request);
    let function = rest.u8().unwrap_or(0);
    match data(function, rest, map, may_write, plc) {
        Ok(data) => [&[function][..], &data].concat(),
        Err(exception) => vec![function | EXCEPTION, exception as u8],
    }
}

/// The answer if the program has none of the registers.
pub fn refuse(request: &[u8]) -> Vec<u8> {
    vec![request.first().copied().unwrap_or(0) | EXCEPTION, Exception::Address as u8]
}

/// The answer after its function.
fn data(function: u8, request: Bytes, map: &Map, may_write: bool, plc: &dyn Plc) -> Result<Vec<u8>, Exception> {
    let writes = matches!(
        function,
        WRITE_COIL | WRITE_REGISTER | WRITE_COILS | WRITE_REGISTERS | MASK_REGISTER | READ_WRITE_REGISTERS
    );
    if writes && !may_write {
        return Err(Exception::Function);
    }
    match function {
        READ_COILS | READ_DISCRETE_INPUTS => {
            let (first, count) = span(request, BITS_READ_MAX)?;
            let bits = if function == READ_COILS { map.coils } else { map.discrete_inputs };
            Ok(counted(&bits.read_bits(plc, first, count)?))
        }
        READ_HOLDING_REGISTERS | READ_INPUT_REGISTERS => {
            let (first, count) = span(request, REGISTERS_READ_MAX)?;
            let registers =
                if function == READ_HOLDING_REGISTERS { map.holding_registers } else { map.input_registers };
            Ok(counted(&registers.read_registers(plc, first, count)?))
        }
        WRITE_COIL => {
            let [a, b, value, 0] = all(request)? else { return Err(Exception::Value) };
            let bit = match value {
                0xFF => 1,
                0 => 0,
                _ => return Err(Exception::Value),
            };
            map.coils.write_bits(plc, u16::from_be_bytes([a, b]), 1, &[bit])?;
            Ok(request.0.to_vec())
        }
        WRITE_REGISTER => {
            let [a, b, high, low] = all(request)?;
            map.holding_registers.write_registers(plc, u16::from_be_bytes([a, b]), &[high, low])?;
            Ok(request.0.to_vec())
        }
        WRITE_COILS => {
            let (first, count, bits) = values(request, BITS_WRITTEN_MAX, |count| usize::from(count).div_ceil(8))?;
            map.coils.write_bits(plc, first, count, bits)?;
            Ok(request.0[..4].to_vec())
        }
        WRITE_REGISTERS => {
            let (first, _, registers) = values(request, REGISTERS_WRITTEN_MAX, |count| 2 * usize::from(count))?;
            map.holding_registers.write_registers(plc, first, registers)?;
            Ok(request.0[..4].to_vec())
        }
        MASK_REGISTER => {
            let [a, b, and_high, and_low, or_high, or_low] = all(request)?;
            let first = u16::from_be_bytes([a, b]);
            let old = map.holding_registers.read_registers(plc, first, 1)?;
            let masked = |old: u8, and: u8, or: u8| old & and | or & !and;
            let new = [masked(old[0], and_high, or_high), masked(old[1], and_low, or_low)];
            map.holding_registers.write_registers(plc, first, &new)?;
            Ok(request.0.to_vec())
        }
        READ_WRITE_REGISTERS => {
            let (read, written) = request.0.split_first_chunk::<4>().ok_or(Exception::Value)?;
            let (first, count) = span(Bytes(read), REGISTERS_READ_MAX)?;
            let (to, _, registers) =
                values(Bytes(written), REGISTERS_WRITTEN_AND_READ_MAX, |count| 2 * usize::from(count))?;
            // What cannot be read is not written either.
            map.holding_registers.read_registers(plc, first, count)?;
            map.holding_registers.write_registers(plc, to, registers)?;
            Ok(counted(&map.holding_registers.read_registers(plc, first, count)?))
        }
        identification::FUNCTION => identification::read(request.0, plc),
        _ => Err(Exception::Function),
    }
}

/// A request of exactly so many bytes.
fn all<const N: usize>(mut request: Bytes) -> Result<[u8; N], Exception> {
    request.array().filter(|_| request.is_empty()).ok_or(Exception::Value)
}

/// The first number, and how many.
fn span(request: Bytes, most: u16) -> Result<(u16, u16), Exception> {
    let [a, b, c, d] = all(request)?;
    let (first, count) = (u16::from_be_bytes([a, b]), u16::from_be_bytes([c, d]));
    match (1..=most).contains(&count) {
        true if u32::from(first) + u32::from(count) > 0x1_0000 => Err(Exception::Address),
        true => Ok((first, count)),
        false => Err(Exception::Value),
    }
}

/// The first number, how many, and their values.
fn values(mut request: Bytes<'_>, most: u16, bytes: fn(u16) -> usize) -> Result<(u16, u16, &[u8]), Exception> {
    let head = request.take(4).ok_or(Exception::Value)?;
    let (first, count) = span(Bytes(head), most)?;
    let length = usize::from(request.u8().ok_or(Exception::Value)?);
    let values = request.take(length).filter(|_| request.is_empty() && length == bytes(count));
    Ok((first, count, values.ok_or(Exception::Value)?))
}

/// Bytes after their number.
fn counted(bytes: &[u8]) -> Vec<u8> {
    [&[bytes.len() as u8][..], bytes].concat()
}

/// A frame: transaction, protocol 0, length, unit, then from the function on.
pub fn frame(transaction: [u8; 2], unit: u8, body: &[u8]) -> Vec<u8> {
    let mut frame = transaction.to_vec();
    put16(&mut frame, 0);
    put16(&mut frame, body.len() as u16 + 1);
    frame.push(unit);
    frame.extend(body);
    frame
}
