//! Read Var and Write Var: items with addresses, each with a result of its own.

use super::plc::{Area, Family, ItemError, Place, Plc};
use crate::wire::{Bytes, put16};

/// Jobs.
pub const READ: u8 = 0x04;
pub const WRITE: u8 = 0x05;

/// The whole job is refused with this error word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refused(pub u16);

/// Length, count or answer do not fit.
pub const WRONG_PDU: u16 = 0x8500;

pub(super) const SUCCESS: u8 = 0xFF;

/// Transport sizes of requests, by which elements are counted.
struct Element {
    code: u8,
    bytes: u32,
    /// Transport size in an answer.
    answer: u8,
}

/// Transport sizes of data.
pub(super) const BIT: u8 = 3;
pub(super) const WORDS: u8 = 4;
pub(super) const INTEGER: u8 = 5;
const DOUBLE_INTEGER: u8 = 6;
const REAL: u8 = 7;
pub(super) const OCTETS: u8 = 9;

const ELEMENT_BIT: u8 = 0x01;
const ELEMENT_BYTE: u8 = 0x02;
const ELEMENT_WORD: u8 = 0x04;
const ELEMENT_INTEGER: u8 = 0x05;
const ELEMENT_COUNTER: u8 = 0x1C;
const ELEMENT_TIMER: u8 = 0x1D;
/// Counters and timers of an S7-200: the bit, and the current value in the last two bytes.
const ELEMENT_S7200_COUNTER: u8 = 0x1E;
const ELEMENT_S7200_TIMER: u8 = 0x1F;

const ELEMENTS: [Element; 18] = [
    Element { code: ELEMENT_BIT, bytes: 1, answer: BIT },
    Element { code: ELEMENT_BYTE, bytes: 1, answer: WORDS },
    Element { code: 0x03, bytes: 1, answer: OCTETS },
    Element { code: ELEMENT_WORD, bytes: 2, answer: WORDS },
    Element { code: ELEMENT_INTEGER, bytes: 2, answer: INTEGER },
    Element { code: 0x06, bytes: 4, answer: WORDS },
    Element { code: 0x07, bytes: 4, answer: INTEGER },
    Element { code: 0x08, bytes: 4, answer: REAL },
    Element { code: 0x09, bytes: 2, answer: WORDS },
    Element { code: 0x0A, bytes: 4, answer: WORDS },
    Element { code: 0x0B, bytes: 4, answer: WORDS },
    Element { code: 0x0C, bytes: 2, answer: WORDS },
    Element { code: 0x0F, bytes: 8, answer: WORDS },
    Element { code: 0x13, bytes: 1, answer: OCTETS },
    Element { code: ELEMENT_COUNTER, bytes: 2, answer: OCTETS },
    Element { code: ELEMENT_TIMER, bytes: 2, answer: OCTETS },
    Element { code: ELEMENT_S7200_COUNTER, bytes: 3, answer: OCTETS },
    Element { code: ELEMENT_S7200_TIMER, bytes: 5, answer: OCTETS },
];

impl Element {
    /// Of a cell of an S7-200, with its bit.
    fn has_bit(&self) -> bool {
        matches!(self.code, ELEMENT_S7200_COUNTER | ELEMENT_S7200_TIMER)
    }
}

/// An item of a job.
type Item = Result<(Place, &'static Element), ItemError>;

/// The items after the job's number; with write, the data comes after them.
fn items(family: Family, parameter: &mut Bytes) -> Option<Vec<Item>> {
    let count = parameter.u8()?;
    let mut items = Vec::with_capacity(count.into());
    for index in 0..count {
        let (specification, length) = (parameter.u8()?, parameter.u8()?);
        let body = parameter.take(length.into())?;
        // Items of odd length are filled up, except for the last.
        if length % 2 != 0 && index + 1 < count {
            parameter.u8()?;
        }
        items.push(if specification == 0x12 { item(family, body) } else { Err(ItemError::OutOfRange) });
    }
    (count > 0 && parameter.is_empty()).then_some(items)
}

fn item(family: Family, body: &[u8]) -> Item {
    let &[0x10, transport, count_high, count_low, db_high, db_low, area, a, b, c] = body else {
        return Err(ItemError::OutOfRange);
    };
    let count = u32::from(u16::from_be_bytes([count_high, count_low]));
    let address = u32::from_be_bytes([0, a, b, c]);
    let element = ELEMENTS.iter().find(|element| element.code == transport).ok_or(ItemError::TypeUnknown)?;
    let s7200 = family == Family::S7200;
    let area = match area {
        0x80 if !s7200 && !family.is_portal() => Area::Peripheral,
        0x81 => Area::Inputs,
        0x82 => Area::Outputs,
        0x83 => Area::BitMemory,
        0x84 | 0x85 => Area::Db(u16::from_be_bytes([db_high, db_low])),
        0x86 | 0x87 => return Err(ItemError::NotAllowed),
        0x1C if !s7200 && !family.is_portal() => Area::Counters,
        0x1D if !s7200 && !family.is_portal() => Area::Timers,
        0x1C | 0x1D => return Err(ItemError::Missing),
        0x1E if s7200 => Area::Counters,
        0x1F if s7200 => Area::Timers,
        0x03 if s7200 => Area::SystemInfo,
        0x05 if s7200 => Area::SpecialMemory,
        0x06 if s7200 => Area::AnalogInputs,
        0x07 if s7200 => Area::AnalogOutputs,
        _ => return Err(ItemError::OutOfRange),
    };
    if count == 0 {
        return Err(ItemError::OutOfRange);
    }
    let cells = matches!(area, Area::Timers | Area::Counters);
    // Of an S7-200 the bit, or the current value, which is a word.
    let is_cell_of_s7200 = matches!(transport, ELEMENT_BIT | ELEMENT_BYTE | ELEMENT_WORD | ELEMENT_INTEGER);
    let of_area = match area {
        Area::Timers if s7200 => is_cell_of_s7200 || matches!(transport, ELEMENT_TIMER | ELEMENT_S7200_TIMER),
        Area::Counters if s7200 => is_cell_of_s7200 || matches!(transport, ELEMENT_COUNTER | ELEMENT_S7200_COUNTER),
        Area::Timers => transport == ELEMENT_TIMER,
        Area::Counters => transport == ELEMENT_COUNTER,
        _ => !matches!(transport, ELEMENT_COUNTER..=ELEMENT_S7200_TIMER),
    };
    if !of_area || cells && address > 0xFFFF {
        return Err(ItemError::OutOfRange);
    }
    let place = if cells {
        let bit = (transport == ELEMENT_BIT).then_some(0);
        if bit.is_some() && count != 1 {
            return Err(ItemError::OutOfRange);
        }
        Place { area, start: address, bit, count }
    } else if transport == ELEMENT_BIT {
        if count != 1 {
            return Err(ItemError::OutOfRange);
        }
        Place { area, start: address >> 3, bit: Some((address & 7) as u8), count: 1 }
    } else if address & 7 != 0 {
        return Err(ItemError::OutOfRange);
    } else {
        Place { area, start: address >> 3, bit: None, count: count * element.bytes }
    };
    Ok((place, element))
}

/// The length field of data: bits for some transport sizes, bytes for others.
fn length_field(transport: u8, bytes: usize) -> u16 {
    match transport {
        BIT => 1,
        WORDS | INTEGER => (8 * bytes) as u16,
        _ => bytes as u16,
    }
}

/// Read Var: the data part of the answer, and the number of items.
pub fn read(plc: &dyn Plc, mut parameter: Bytes, pdu: usize) -> Result<(u8, Vec<u8>), Refused> {
    /// Head of the answer and the parameter in it.
    const AROUND: usize = 12 + 2;
    let items = items(plc.family(), &mut parameter).ok_or(Refused(WRONG_PDU))?;
    let (mut data, count) = (Vec::new(), items.len());
    for (index, item) in items.into_iter().enumerate() {
        // The length is known before anything is read.
        let longest = item.as_ref().map_or(0, |(place, element)| size(place, element) as usize);
        if AROUND + data.len() + 4 + longest > pdu {
            return Err(Refused(WRONG_PDU));
        }
        match item.and_then(|(place, element)| read_one(plc, place, element).map(|bytes| (bytes, element))) {
            Ok((bytes, element)) => {
                data.extend([SUCCESS, element.answer]);
                put16(&mut data, length_field(element.answer, bytes.len()));
                data.extend(&bytes);
                if bytes.len() % 2 != 0 && index + 1 < count {
                    data.push(0);
                }
            }
            Err(error) => data.extend([error as u8, 0, 0, 0]),
        }
    }
    if AROUND + data.len() > pdu { Err(Refused(WRONG_PDU)) } else { Ok((count as u8, data)) }
}

fn read_one(plc: &dyn Plc, place: Place, element: &Element) -> Result<Vec<u8>, ItemError> {
    if is_bit_of_cell(&place) {
        // The whole cell is read to see that it exists.
        plc.read(Place { bit: None, ..place })?;
        return Ok(vec![plc.cell_bit(place.area, place.start).into()]);
    }
    let bytes = plc.read(place)?;
    if !element.has_bit() {
        return Ok(bytes);
    }
    let words = bytes.as_chunks::<2>().0.iter();
    let cell = |(number, [high, low]): (u32, &[u8; 2])| {
        let mut cell = vec![0; element.bytes as usize - 2];
        cell[0] = plc.cell_bit(place.area, number).into();
        cell.extend([*high, *low]);
        cell
    };
    Ok((place.start..).zip(words).flat_map(cell).collect())
}

/// The bit of a timer or counter of an S7-200.
fn is_bit_of_cell(place: &Place) -> bool {
    place.bit.is_some() && matches!(place.area, Area::Timers | Area::Counters)
}

/// Bytes of an item's data.
fn size(place: &Place, element: &Element) -> u32 {
    if is_bit_of_cell(place) {
        return 1;
    }
    if matches!(place.area, Area::Timers | Area::Counters) { place.count * element.bytes.max(2) } else { place.count }
}

/// Write Var: the codes of the items. Items are written in order; those after a failed one as well. `may_write`: the client may.
pub fn write(plc: &dyn Plc, mut parameter: Bytes, mut data: Bytes, may_write: bool) -> Result<Vec<u8>, Refused> {
    let items = items(plc.family(), &mut parameter).ok_or(Refused(WRONG_PDU))?;
    let count = items.len();
    // Nothing is written of a job whose data is cut.
    let mut jobs = Vec::with_capacity(count);
    for (index, item) in items.into_iter().enumerate() {
        let taken = (|| {
            let [_, transport, high, low] = data.array::<4>()?;
            let length = usize::from(u16::from_be_bytes([high, low]));
            let bytes = if matches!(transport, BIT | WORDS | INTEGER) { length.div_ceil(8) } else { length };
            let values = data.take(bytes)?;
            if bytes % 2 != 0 && index + 1 < count {
                data.u8()?;
            }
            Some((transport, length, values))
        })();
        jobs.push((item, taken.ok_or(Refused(WRONG_PDU))?));
    }
    let mut codes = Vec::with_capacity(count);
    for (item, (transport, length, values)) in jobs {
        let done = item.and_then(|(place, element)| {
            // The program sets the bit.
            if !may_write || is_bit_of_cell(&place) {
                return Err(ItemError::NotAllowed);
            }
            let fits = match (place.bit, transport) {
                (Some(_), BIT) => length == 1,
                (Some(_), _) | (None, BIT) => false,
                (None, WORDS | INTEGER) => length % 8 == 0,
                (None, DOUBLE_INTEGER | REAL | OCTETS) => true,
                (None, _) => false,
            };
            let values = written(values, &place, element).filter(|_| fits).ok_or(ItemError::TypeInconsistent)?;
            plc.write(place, &values)
        });
        codes.push(done.map_or_else(|error| error as u8, |()| SUCCESS));
    }
    Ok(codes)
}

/// What is written of the data of an item; `None`: its length is wrong. Cells of an S7-200 get a current value, which clients send alone or as
/// they read the cell.
fn written(values: &[u8], place: &Place, element: &Element) -> Option<Vec<u8>> {
    let count = place.count as usize;
    match (element.has_bit(), element.bytes as usize) {
        (true, bytes) if values.len() == count * bytes => {
            Some(values.chunks_exact(bytes).flat_map(|cell| cell[bytes - 2..].to_vec()).collect())
        }
        (true, _) if values.len() != 2 * count => None,
        (false, _) if values.len() != size(place, element) as usize => None,
        _ => Some(values.to_vec()),
    }
}
