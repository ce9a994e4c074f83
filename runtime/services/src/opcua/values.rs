//! Values of PLC types in memory, and the variants that clients see. Source: S7-1500 information system, mapping of data types; but
//! DATE_AND_TIME and DTL are DateTime here.
//!
//! At the cycle control point only bytes are copied; what they mean is found out on the thread of the services.

use jiff::civil;
use plcc_abi::image::AssertType;
use plcc_abi::names::Dimension;
use plcc_runtime::address::{Address, Place, Width};
use plcc_runtime::assertion::{Value as TypedValue, byte_of};
use plcc_runtime::cpu::{Area, Cpu};
use plcc_runtime::signal;
use plcc_runtime::typed::{self, ValueType};
use plcc_runtime::{bcd, datetime};

use super::code::{Scalar, Variant, moment_of, time_of};
use super::range::Range;
use super::status::{self, Status};
use crate::limits::OPCUA_ELEMENTS_MAX;

/// The type number of Byte, which has no sign.
const BYTE: u8 = 3;
/// The type number of dates with their time of day.
const DATE_TIME: u8 = 13;
/// The DateTime of a date that does not exist. Source: OPC 10000-6, section 5.2.2.5.
const NO_DATE: Scalar = Scalar::Time(0);

/// A variable with a value: elementary, or an array of such.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    pub place: Place,
    pub bit: u8,
    pub ty: ValueType,
    /// Empty: no array.
    pub dimensions: Vec<Dimension>,
    pub read_only: bool,
}

/// A value on its way into memory: bits from the start of the variable, and what comes there.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    at: u32,
    data: Data,
}

#[derive(Clone, Debug, PartialEq)]
enum Data {
    Bit(bool),
    Bytes(Vec<u8>),
    /// Characters of a STRING or WSTRING.
    Text(Vec<u16>),
}

/// The type of a value, which is also the number of its node.
pub fn type_of(ty: AssertType) -> u8 {
    match ty {
        AssertType::Bool => 1,
        AssertType::Signed(8) => 2,
        AssertType::Bits(8) | AssertType::Unsigned(8) | AssertType::Char => BYTE,
        AssertType::Signed(16) => 4,
        AssertType::Bits(16) | AssertType::Unsigned(16) | AssertType::Wchar | AssertType::S5Time | AssertType::Date => {
            5
        }
        AssertType::Signed(32) | AssertType::Time => 6,
        AssertType::Bits(32) | AssertType::Unsigned(32) | AssertType::TimeOfDay => 7,
        AssertType::Signed(_) | AssertType::Ltime => 8,
        AssertType::Bits(_) | AssertType::Unsigned(_) | AssertType::Ltod => 9,
        AssertType::Real => 10,
        AssertType::Lreal => 11,
        AssertType::Text | AssertType::WideText => 12,
        AssertType::Ldt | AssertType::DateAndTime | AssertType::Dtl => DATE_TIME,
    }
}

/// What a number of this type counts, for the description.
pub fn unit_text(ty: AssertType) -> &'static str {
    match ty {
        AssertType::Time => " in ms",
        AssertType::Ltime => " in ns",
        AssertType::Date => " in days since 1990-01-01",
        AssertType::TimeOfDay => " in ms since midnight",
        AssertType::Ltod => " in ns since midnight",
        AssertType::S5Time => " as on the CPU: time base and BCD",
        _ => "",
    }
}

/// Bits in memory.
pub fn bits(ty: ValueType) -> u32 {
    match ty.ty {
        AssertType::Dtl => 96,
        AssertType::Text => 8 * (2 + u32::from(ty.length)),
        AssertType::WideText => 8 * (4 + 2 * u32::from(ty.length)),
        other => typed::bits(other).unwrap_or(8),
    }
}

/// Elements of each dimension.
pub fn lengths_of(dimensions: &[Dimension]) -> Vec<u32> {
    let length = |dimension: &Dimension| i64::from(dimension.high) - i64::from(dimension.low) + 1;
    dimensions.iter().map(|dimension| length(dimension).clamp(0, u32::MAX.into()) as u32).collect()
}

/// Elements of all dimensions. `None`: there are too many to be one value.
pub fn count_of(dimensions: &[Dimension]) -> Option<u32> {
    let count = lengths_of(dimensions).iter().try_fold(1u32, |count, length| count.checked_mul(*length))?;
    (count <= OPCUA_ELEMENTS_MAX).then_some(count)
}

/// Where elements are, in bits, if the first one is at `start`; the last index runs fastest.
pub fn offsets_of(dimensions: &[Dimension], start: u32) -> Vec<u32> {
    let mut all = vec![start];
    for (dimension, length) in dimensions.iter().zip(lengths_of(dimensions)) {
        let row = |start: &u32| {
            let start = *start;
            (0..length).map(move |index| start.saturating_add(index.saturating_mul(dimension.distance)))
        };
        all = all.iter().flat_map(row).collect();
    }
    all
}

/// Where so many bytes are in memory; `None`: they are not there, but values of their own.
pub fn span(place: Place, bytes: u32, cpu: &Cpu) -> Result<Option<u32>, Status> {
    let ((base, length), start) = match place {
        Place::Input(byte) => (cpu.area(Area::Inputs), byte),
        Place::Output(byte) => (cpu.area(Area::Outputs), byte),
        Place::BitMemory(byte) => (cpu.area(Area::BitMemory), byte),
        Place::Db(number, byte) => match cpu.memory.db(number) {
            (_, 0) => return Err(status::NOT_FOUND),
            found => (found, byte),
        },
        Place::PeripheralInput(_)
        | Place::PeripheralOutput(_)
        | Place::Timer(_)
        | Place::Counter(_)
        | Place::TimerValue(_)
        | Place::CounterValue(_)
        | Place::S7200(..) => return Ok(None),
    };
    let fits = start.checked_add(bytes).is_some_and(|end| end <= length);
    if fits { Ok(Some(base + start)) } else { Err(status::NOT_FOUND) }
}

impl Variable {
    /// Elements of each dimension.
    pub fn lengths(&self) -> Vec<u32> {
        lengths_of(&self.dimensions)
    }

    /// `None`: there are too many to be one value.
    fn count(&self) -> Option<u32> {
        count_of(&self.dimensions)
    }

    /// Where the elements are, in bits from the byte where the variable begins.
    fn offsets(&self) -> Result<Vec<u32>, Status> {
        self.count().ok_or(status::NOT_READABLE)?;
        Ok(offsets_of(&self.dimensions, self.bit.into()))
    }

    /// Bytes from the first to the last.
    pub fn bytes(&self) -> Result<u32, Status> {
        self.count().ok_or(status::NOT_READABLE)?;
        let last = self.dimensions.iter().zip(self.lengths()).fold(u32::from(self.bit), |at, (dimension, length)| {
            at.saturating_add(length.saturating_sub(1).saturating_mul(dimension.distance))
        });
        Ok(last.saturating_add(bits(self.ty)).div_ceil(8))
    }

    /// Whether anyone may change it.
    pub fn is_writable(&self) -> bool {
        !self.read_only && self.address().check_settable().is_ok()
    }

    /// How much it takes to keep its value: elements, or 32 bytes of a text each.
    pub fn cost(&self) -> Result<u32, Status> {
        let bytes = if type_of(self.ty.ty) == 12 { self.bytes()? } else { 0 };
        Ok(self.count().ok_or(status::NOT_READABLE)?.max(bytes / 32))
    }

    fn address(&self) -> Address {
        Address { place: self.place, width: self.ty.width(self.bit) }
    }

    /// Where it is in memory; `None`: it is not there, but a value of its own.
    fn span(&self, cpu: &Cpu) -> Result<Option<u32>, Status> {
        span(self.place, self.bytes()?, cpu)
    }

    /// Copies its bytes, at the cycle control point.
    pub fn read(&self, cpu: &Cpu) -> Result<Vec<u8>, Status> {
        if let Some(at) = self.span(cpu)? {
            return Ok(cpu.memory.view(at, self.bytes()?, <[u8]>::to_vec));
        }
        let address = self.address();
        cpu.check_address(&address).map_err(|_| status::NOT_FOUND)?;
        let value = cpu.read(&address);
        Ok(match address.width {
            Width::Bit(bit) => vec![(value as u8 & 1) << bit],
            width => value.to_be_bytes()[8 - width.bytes() as usize..].to_vec(),
        })
    }

    /// What the bytes mean.
    pub fn value(&self, bytes: &[u8]) -> Result<Variant, Status> {
        self.value_or(bytes, Err)
    }

    /// The same as a component of a structure, where a date that does not exist is `NO_DATE`, so that the other components can be read.
    pub fn value_of_component(&self, bytes: &[u8]) -> Result<Variant, Status> {
        let is_date = type_of(self.ty.ty) == DATE_TIME;
        self.value_or(bytes, |wrong| match is_date && wrong == status::OUT_OF_RANGE {
            true => Ok(NO_DATE),
            false => Err(wrong),
        })
    }

    fn value_or(&self, bytes: &[u8], other: impl Fn(Status) -> Result<Scalar, Status>) -> Result<Variant, Status> {
        let offsets = self.offsets()?;
        let one = |at: &u32| {
            let rest = bytes.get(*at as usize / 8..).unwrap_or_default();
            decode(self.ty, rest, (at % 8) as u8).or_else(&other)
        };
        if self.dimensions.is_empty() {
            return one(&self.bit.into()).map(Variant::One);
        }
        let values = offsets.iter().map(one).collect::<Result<_, _>>()?;
        Ok(Variant::Many { ty: type_of(self.ty.ty), values, dimensions: self.lengths() })
    }

    /// A value of a client as it comes into memory. Wrong types and values that the type does not have are refused.
    pub fn parts(&self, value: &Variant, range: Option<&Range>) -> Result<Vec<Part>, Status> {
        self.parts_without(None, value, range)
    }

    /// The same for a component of a structure, where `NO_DATE` leaves a date as it is.
    pub fn parts_of_component(&self, value: &Variant) -> Result<Vec<Part>, Status> {
        self.parts_without(Some(&NO_DATE), value, None)
    }

    /// The parts, without those of elements with the value `kept`.
    fn parts_without(
        &self,
        kept: Option<&Scalar>,
        value: &Variant,
        range: Option<&Range>,
    ) -> Result<Vec<Part>, Status> {
        let mut offsets = self.offsets()?;
        let mut lengths = self.lengths();
        if let Some(range) = range {
            let (elements, own) = range.elements(&lengths, true)?;
            offsets = elements.iter().filter_map(|index| offsets.get(*index).copied()).collect();
            lengths = own;
        }
        let elements: Vec<Scalar>;
        let values = match value {
            Variant::One(value) if self.dimensions.is_empty() => std::slice::from_ref(value),
            // A ByteString is an array of bytes. Source: OPC 10000-4, Write.
            Variant::One(Scalar::Bytes(bytes)) if lengths.len() == 1 && type_of(self.ty.ty) == BYTE => {
                elements = bytes.iter().copied().map(Scalar::Byte).collect();
                &elements
            }
            Variant::Many { values, dimensions, .. } if !self.dimensions.is_empty() => {
                if *dimensions != lengths && !(dimensions.len() < 2 && lengths.len() == 1) {
                    return Err(status::TYPE_MISMATCH);
                }
                values
            }
            Variant::Empty | Variant::One(_) | Variant::Many { .. } => return Err(status::TYPE_MISMATCH),
        };
        if offsets.len() != values.len() {
            return Err(status::TYPE_MISMATCH);
        }
        let mut parts: Vec<Part> = Vec::new();
        for (at, value) in offsets.into_iter().zip(values).filter(|(_, value)| Some(*value) != kept) {
            let data = encode(self.ty, value)?;
            // Elements that follow each other are one piece.
            if let (Data::Bytes(new), Some(Part { at: start, data: Data::Bytes(bytes) })) = (&data, parts.last_mut())
                && *start + 8 * bytes.len() as u32 == at
            {
                bytes.extend(new);
                continue;
            }
            parts.push(Part { at, data });
        }
        Ok(parts)
    }

    /// Whether [`Variable::write`] can write the parts now. Result: where it is in memory, as [`span`] says it, and for each part the bytes of
    /// its text.
    fn prepare(&self, cpu: &Cpu, parts: &[Part]) -> Result<(Option<u32>, Vec<Vec<u8>>), Status> {
        let is_fixed = matches!(self.place, Place::Db(number, _) if cpu.is_read_only(number));
        if is_fixed || !self.is_writable() {
            return Err(status::NOT_WRITABLE);
        }
        let Some(start) = self.span(cpu)? else { return Ok((None, Vec::new())) };
        // The room of a text is in its head.
        let room = |at: u32| match (self.ty.ty, cpu.memory.word(start + at / 8)) {
            (AssertType::WideText, room) => room,
            (_, word) => word >> 8,
        };
        let texts = parts.iter().map(|part| match &part.data {
            Data::Text(text) => {
                let room = if room(part.at) == 0 { self.ty.length } else { room(part.at).min(self.ty.length) };
                if text.len() <= usize::from(room) {
                    Ok(head_and(text, room, self.ty.ty))
                } else {
                    Err(status::OUT_OF_RANGE)
                }
            }
            Data::Bit(_) | Data::Bytes(_) => Ok(Vec::new()),
        });
        Ok((Some(start), texts.collect::<Result<_, _>>()?))
    }

    /// Whether the parts can be written now.
    pub fn check(&self, cpu: &Cpu, parts: &[Part]) -> Result<(), Status> {
        self.prepare(cpu, parts).map(|_| ())
    }

    /// Writes, at the cycle control point: all parts, or nothing.
    pub fn write(&self, cpu: &Cpu, parts: &[Part]) -> Result<(), Status> {
        let (start, texts) = self.prepare(cpu, parts)?;
        let Some(start) = start else {
            let [Part { data, .. }] = parts else { return Err(status::NOT_WRITABLE) };
            return write_at(cpu, self.address(), data);
        };
        for (part, text) in parts.iter().zip(&texts) {
            let byte = part.at / 8;
            let bit = (part.at % 8) as u8;
            if let Place::Input(_) = self.place {
                let width = match &part.data {
                    Data::Bit(_) => Width::Bit(bit),
                    Data::Bytes(_) | Data::Text(_) => self.ty.width(0),
                };
                let address = Address { place: self.place.offset(byte), width };
                match &part.data {
                    Data::Text(_) => cpu.write_bytes(&address, text).map_err(|_| status::NOT_WRITABLE)?,
                    data => write_at(cpu, address, data)?,
                }
                continue;
            }
            match &part.data {
                Data::Bit(value) => cpu.memory.set_bit(start + byte, bit, *value),
                Data::Bytes(bytes) => cpu.memory.load(start + byte, bytes),
                Data::Text(_) => cpu.memory.load(start + byte, text),
            }
        }
        if let Place::Output(byte) = self.place {
            cpu.note_outputs(byte.saturating_add(self.bytes()?));
        }
        Ok(())
    }
}

/// Through the access of the CPU, for what is not plain memory.
fn write_at(cpu: &Cpu, address: Address, data: &Data) -> Result<(), Status> {
    let done = match data {
        Data::Bit(value) => cpu.write(&address, u64::from(*value)),
        Data::Bytes(bytes) if bytes.len() == address.width.bytes() as usize => {
            let value = bytes.iter().fold(0u64, |value, byte| value << 8 | u64::from(*byte));
            cpu.write(&address, value)
        }
        Data::Bytes(bytes) => cpu.write_bytes(&address, bytes),
        Data::Text(_) => return Err(status::NOT_WRITABLE),
    };
    done.map_err(|_| status::NOT_WRITABLE)
}

/// The bytes of a text with its head.
fn head_and(text: &[u16], room: u16, ty: AssertType) -> Vec<u8> {
    let units = [room, text.len() as u16].into_iter().chain(text.iter().copied());
    match ty {
        AssertType::WideText => units.flat_map(u16::to_be_bytes).collect(),
        _ => units.map(|unit| unit as u8).collect(),
    }
}

fn decode(ty: ValueType, bytes: &[u8], bit: u8) -> Result<Scalar, Status> {
    fn first<const N: usize>(bytes: &[u8]) -> Result<[u8; N], Status> {
        bytes.first_chunk::<N>().copied().ok_or(status::NOT_FOUND)
    }
    let word = || first(bytes).map(u16::from_be_bytes);
    let double = || first(bytes).map(u32::from_be_bytes);
    let long = || first(bytes).map(u64::from_be_bytes);
    let byte = || first(bytes).map(|[byte]| byte);
    Ok(match type_of(ty.ty) {
        1 => Scalar::Bool(byte()? >> bit & 1 != 0),
        2 => Scalar::SByte(byte()? as i8),
        BYTE => Scalar::Byte(byte()?),
        4 => Scalar::Int16(word()? as i16),
        5 => Scalar::UInt16(word()?),
        6 => Scalar::Int32(double()? as i32),
        7 => Scalar::UInt32(double()?),
        8 => Scalar::Int64(long()? as i64),
        9 => Scalar::UInt64(long()?),
        10 => Scalar::Float(f32::from_bits(double()?)),
        11 => Scalar::Double(f64::from_bits(long()?)),
        12 => {
            let wide = ty.ty == AssertType::WideText;
            let (head, size) = if wide { (4, 2) } else { (2, 1) };
            let field = |at: usize| {
                bytes
                    .get(at..at + size)
                    .map_or(0, |field| field.iter().fold(0, |sum, byte| sum << 8 | usize::from(*byte)))
            };
            let length = field(0).min(field(size)).min(ty.length.into());
            let text = bytes.get(..head + size * length).ok_or(status::NOT_FOUND)?;
            Scalar::Text(signal::Value::Typed(ty.ty, TypedValue::of_bytes(ty.ty, text)).plain_text())
        }
        _ => Scalar::Time(time_of(match ty.ty {
            AssertType::Ldt => long()? as i64,
            AssertType::Dtl => dtl(first(bytes)?).ok_or(status::OUT_OF_RANGE)?,
            _ => datetime::decode(first(bytes)?).map_err(|_| status::OUT_OF_RANGE)?,
        })),
    })
}

/// Years of DTL, which ends at 2262-04-11 23:47:16.854775807, as the moments of this side do. Source: S7-1200 system manual, DTL.
const DTL_YEARS: std::ops::RangeInclusive<i16> = 1970..=2262;

/// The moment of a DTL; `None`: it has none.
fn dtl(bytes: [u8; 12]) -> Option<i64> {
    let [y0, y1, month, day, _, hour, minute, second, nanos @ ..] = bytes;
    let small = |byte: u8| i8::try_from(byte).ok();
    let nanos = i32::try_from(u32::from_be_bytes(nanos)).ok()?;
    let year = i16::try_from(u16::from_be_bytes([y0, y1])).ok().filter(|year| DTL_YEARS.contains(year))?;
    let moment =
        civil::DateTime::new(year, small(month)?, small(day)?, small(hour)?, small(minute)?, small(second)?, nanos);
    moment.ok().and_then(datetime::moment_in_range)
}

fn dtl_bytes(moment: i64) -> Option<[u8; 12]> {
    let at = datetime::civil(moment);
    let year = Some(at.year()).filter(|year| DTL_YEARS.contains(year))?.unsigned_abs();
    let small = |field: i8| field.unsigned_abs();
    let ([y0, y1], [n0, n1, n2, n3]) = (year.to_be_bytes(), at.subsec_nanosecond().unsigned_abs().to_be_bytes());
    let weekday = small(at.date().weekday().to_sunday_one_offset());
    Some([
        y0,
        y1,
        small(at.month()),
        small(at.day()),
        weekday,
        small(at.hour()),
        small(at.minute()),
        small(at.second()),
        n0,
        n1,
        n2,
        n3,
    ])
}

fn encode(ty: ValueType, value: &Scalar) -> Result<Data, Status> {
    if value.ty() != type_of(ty.ty) {
        return Err(status::TYPE_MISMATCH);
    }
    /// Of a day.
    const MS: u32 = 86_400_000;
    let is_in_range = match (ty.ty, value) {
        (AssertType::TimeOfDay, Scalar::UInt32(ms)) => *ms < MS,
        (AssertType::Ltod, Scalar::UInt64(ns)) => *ns < u64::from(MS) * 1_000_000,
        (AssertType::Date, Scalar::UInt16(days)) => *days <= datetime::DATE_MAX,
        (AssertType::S5Time, Scalar::UInt16(time)) => {
            time >> 14 == 0
                && bcd::to_int((time & 0xFFF).into(), 3) <= 999
                && (0..3).all(|digit| time >> (4 * digit) & 15 <= 9)
        }
        _ => true,
    };
    if !is_in_range {
        return Err(status::OUT_OF_RANGE);
    }
    Ok(Data::Bytes(match value {
        Scalar::Bool(value) => return Ok(Data::Bit(*value)),
        Scalar::SByte(value) => value.to_be_bytes().to_vec(),
        Scalar::Byte(value) => vec![*value],
        Scalar::Int16(value) => value.to_be_bytes().to_vec(),
        Scalar::UInt16(value) => value.to_be_bytes().to_vec(),
        Scalar::Int32(value) => value.to_be_bytes().to_vec(),
        Scalar::UInt32(value) => value.to_be_bytes().to_vec(),
        Scalar::Int64(value) => value.to_be_bytes().to_vec(),
        Scalar::UInt64(value) => value.to_be_bytes().to_vec(),
        Scalar::Float(value) => value.to_be_bytes().to_vec(),
        Scalar::Double(value) => value.to_be_bytes().to_vec(),
        Scalar::Text(text) => {
            let units: Vec<u16> = text.encode_utf16().collect();
            let units: Option<Vec<u16>> = match ty.ty {
                AssertType::WideText => Some(units),
                _ => units.into_iter().map(|unit| byte_of(unit).map(u16::from)).collect(),
            };
            return units
                .filter(|units| units.len() <= usize::from(ty.length))
                .map(Data::Text)
                .ok_or(status::OUT_OF_RANGE);
        }
        Scalar::Time(time) => {
            let moment = moment_of(*time).ok_or(status::OUT_OF_RANGE)?;
            match ty.ty {
                AssertType::Ldt if moment >= 0 => moment.to_be_bytes().to_vec(),
                AssertType::Dtl => dtl_bytes(moment).ok_or(status::OUT_OF_RANGE)?.to_vec(),
                AssertType::DateAndTime if (1990..=2089).contains(&datetime::civil(moment).year()) => {
                    datetime::encode(moment).to_vec()
                }
                _ => return Err(status::OUT_OF_RANGE),
            }
        }
        Scalar::Bytes(_)
        | Scalar::Node(_)
        | Scalar::Status(_)
        | Scalar::Name(..)
        | Scalar::Localized(_)
        | Scalar::Object(..) => {
            return Err(status::TYPE_MISMATCH);
        }
    }))
}

#[cfg(test)]
mod tests {
    use super::{dtl, dtl_bytes};

    #[test]
    fn dtl_has_its_last_year() {
        let last = [0x08, 0xD6, 4, 11, 6, 23, 47, 16, 0x32, 0xF2, 0xD7, 0xFF];
        assert_eq!(dtl(last), Some(i64::MAX));
        assert_eq!(dtl_bytes(i64::MAX), Some(last));
        assert_eq!(dtl_bytes(-1), None, "1969");
        let mut later = last;
        later[3] = 12;
        assert_eq!(dtl(later), None, "2262-04-12");
    }
}
