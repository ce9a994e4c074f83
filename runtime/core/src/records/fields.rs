//! Values of data blocks as the columns of a CSV file, and back.

use jiff::civil::{Date, DateTime, Time};
use plcc_abi::image::AssertType;
use plcc_abi::shape::{ArrayShape, DbShape, Part, Shape};

use crate::assertion::windows_1252;
use crate::datetime;
use crate::system::dtl;

/// Most columns of a data log or a recipe. Source: S7-1200 reference, data logs.
pub const FIELDS_MAX: usize = 253;
const NS_PER_MS: u64 = 1_000_000;
const NS_PER_DAY: u64 = 86_400_000_000_000;
/// From 1970-01-01 to 1990-01-01, where DATE begins.
const NS_TO_FIRST_DATE: i64 = 7305 * NS_PER_DAY as i64;

/// A value of a data block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Path of names: `weight`, `axis[2].speed`.
    pub name: String,
    /// Bits from the start of what is looked at.
    pub bits: u32,
    pub ty: AssertType,
    pub bytes: u32,
}

/// Why data has no columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unfit {
    /// There is no value, or one is a pointer.
    Types,
    TooMany,
}

/// The components of a data block.
fn parts(shapes: &[DbShape], db: u16) -> &[Part] {
    shapes.iter().find(|shape| shape.number == db).map_or(&[], |shape| &shape.parts)
}

/// The values of a data block that are within `bytes` bytes from `start`; places count from there.
pub fn within(shapes: &[DbShape], db: u16, start: u32, bytes: u32) -> Result<Vec<Field>, Unfit> {
    let mut search = Search { from: 8 * start, to: 8 * (start + bytes), found: Vec::new() };
    search.parts(parts(shapes, db), 0, "")?;
    let prefix = common_prefix(&search.found);
    for field in &mut search.found {
        field.bits -= search.from;
        field.name.drain(..prefix);
    }
    if search.found.is_empty() { Err(Unfit::Types) } else { Ok(search.found) }
}

/// Characters of the path that all names share, up to a dot.
fn common_prefix(fields: &[Field]) -> usize {
    let Some(first) = fields.first() else { return 0 };
    let dots = first.name.match_indices('.').map(|(at, _)| at + 1);
    dots.filter(|&at| fields.iter().all(|field| field.name.as_bytes().starts_with(&first.name.as_bytes()[..at])))
        .max()
        .unwrap_or(0)
}

/// The list of recipes within `bytes` bytes from `start` of a data block.
pub struct Table<'a> {
    pub array: &'a ArrayShape,
    /// Bits from the start of the data block.
    pub bits: u32,
    /// Of one element, from its start.
    pub fields: Vec<Field>,
}

/// Finds the first array of structures.
pub fn table(shapes: &[DbShape], db: u16, start: u32, bytes: u32) -> Result<Table<'_>, Unfit> {
    let within = 8 * start..8 * (start + bytes);
    let (bits, array) = first_array(parts(shapes, db), 0, &within).ok_or(Unfit::Types)?;
    let mut search = Search { from: 0, to: u32::MAX, found: Vec::new() };
    search.shape(&array.element, 0, String::new())?;
    if search.found.is_empty() { Err(Unfit::Types) } else { Ok(Table { array, bits, fields: search.found }) }
}

fn first_array<'a>(parts: &'a [Part], base: u32, within: &std::ops::Range<u32>) -> Option<(u32, &'a ArrayShape)> {
    parts.iter().find_map(|part| {
        let at = base + 8 * part.byte + u32::from(part.bit);
        match &part.shape {
            Shape::Array(array) if matches!(*array.element, Shape::Struct { .. }) && within.contains(&at) => {
                Some((at, array))
            }
            Shape::Struct { parts, .. } => first_array(parts, at, within),
            Shape::Array(_) | Shape::Value { .. } | Shape::Other { .. } => None,
        }
    })
}

/// Collects values.
struct Search {
    from: u32,
    to: u32,
    found: Vec<Field>,
}

impl Search {
    fn parts(&mut self, parts: &[Part], base: u32, path: &str) -> Result<(), Unfit> {
        for part in parts {
            let at = base.saturating_add(8 * part.byte + u32::from(part.bit));
            let name = if path.is_empty() { part.name.clone() } else { format!("{path}.{}", part.name) };
            self.shape(&part.shape, at, name)?;
        }
        Ok(())
    }

    fn shape(&mut self, shape: &Shape, at: u32, name: String) -> Result<(), Unfit> {
        let end = at.saturating_add(8 * shape.bytes().max(1));
        if end <= self.from || at >= self.to {
            return Ok(());
        }
        match shape {
            Shape::Value { ty, bytes } => {
                let used = if *ty == AssertType::Bool { 1 } else { 8 * bytes };
                if at < self.from || at.saturating_add(used) > self.to {
                    return Ok(());
                }
                if self.found.len() == FIELDS_MAX {
                    return Err(Unfit::TooMany);
                }
                self.found.push(Field { name, bits: at, ty: *ty, bytes: *bytes });
                Ok(())
            }
            Shape::Struct { parts, .. } => self.parts(parts, at, &name),
            Shape::Array(array) => (0..array.count()).try_for_each(|index| {
                let place = at.saturating_add(array.place(index));
                self.shape(&array.element, place, format!("{name}{}", array.index_text(index)))
            }),
            Shape::Other { .. } => Err(Unfit::Types),
        }
    }
}

impl Field {
    fn start(&self) -> usize {
        self.bits as usize / 8
    }

    /// The value in `data` as text; an invalid date and time is empty.
    pub fn text(&self, data: &[u8]) -> String {
        let Some(bytes) = data.get(self.start()..self.start() + self.bytes as usize) else { return String::new() };
        let bits = bytes.iter().take(8).fold(0u64, |bits, byte| bits << 8 | u64::from(*byte));
        let shown = |moment: Option<i64>| moment.map(|moment| datetime::civil(moment).to_string()).unwrap_or_default();
        match self.ty {
            AssertType::Bool => (bits >> (self.bits % 8) & 1).to_string(),
            AssertType::Bits(_) | AssertType::Unsigned(_) | AssertType::S5Time => bits.to_string(),
            AssertType::Signed(_) | AssertType::Time | AssertType::Ltime => {
                let unused = 64 - 8 * self.bytes.clamp(1, 8);
                ((bits << unused) as i64 >> unused).to_string()
            }
            AssertType::Real => format!("{:?}", f32::from_bits(bits as u32)),
            AssertType::Lreal => format!("{:?}", f64::from_bits(bits)),
            AssertType::Char => text_of([windows_1252(bits as u16)]),
            AssertType::Wchar => text_of([bits as u16]),
            AssertType::Text => {
                let length = usize::from(bytes[1].min(bytes[0]));
                text_of(bytes[2..].iter().take(length).map(|&byte| windows_1252(byte.into())))
            }
            AssertType::WideText => {
                let words = || bytes.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]]));
                let length = words().take(2).min().unwrap_or(0);
                text_of(words().skip(2).take(length.into()))
            }
            AssertType::Date => {
                let moment = NS_TO_FIRST_DATE + bits as i64 * NS_PER_DAY as i64;
                datetime::civil(moment).date().to_string()
            }
            AssertType::TimeOfDay => clock(bits * NS_PER_MS),
            AssertType::Ltod => clock(bits),
            AssertType::Ldt => shown(i64::try_from(bits).ok()),
            AssertType::DateAndTime => shown(datetime::decode(bits.to_be_bytes()).ok()),
            AssertType::Dtl => shown(<[u8; 12]>::try_from(bytes).ok().and_then(|bytes| dtl::decode(bytes).ok())),
        }
    }

    /// Writes the value of `text` into `data`. `None`: it is not a value of the type.
    pub fn set(&self, text: &str, data: &mut [u8]) -> Option<()> {
        let bit = self.bits % 8;
        let bytes = data.get_mut(self.start()..self.start() + self.bytes as usize)?;
        let text_given = text;
        let text = text.trim();
        let moment = || text.parse::<DateTime>().ok().map(datetime::moment);
        let midnight = |time: Time| {
            let [h, m, s] = [time.hour(), time.minute(), time.second()].map(|part| part.unsigned_abs() as u64);
            ((h * 60 + m) * 60 + s) * 1_000_000_000 + u64::from(time.subsec_nanosecond().unsigned_abs())
        };
        let bits: u64 = match self.ty {
            AssertType::Bool => {
                let on = match text.to_ascii_uppercase().as_str() {
                    "1" | "TRUE" => true,
                    "0" | "FALSE" => false,
                    _ => return None,
                };
                bytes[0] = bytes[0] & !(1 << bit) | u8::from(on) << bit;
                return Some(());
            }
            AssertType::Bits(_) | AssertType::Unsigned(_) | AssertType::S5Time => {
                let limit = u64::MAX >> (64 - 8 * self.bytes.clamp(1, 8));
                text.parse().ok().filter(|&value: &u64| value <= limit)?
            }
            AssertType::Signed(_) | AssertType::Time | AssertType::Ltime => {
                let unused = 64 - 8 * self.bytes.clamp(1, 8);
                text.parse().ok().filter(|&value: &i64| value << unused >> unused == value)? as u64
            }
            AssertType::Real => u64::from(text.parse::<f32>().ok()?.to_bits()),
            AssertType::Lreal => text.parse::<f64>().ok()?.to_bits(),
            AssertType::Char => {
                let units = encoded(text_given)?;
                let [one] = units[..] else { return None };
                one.into()
            }
            AssertType::Wchar => {
                let units: Vec<u16> = text_given.encode_utf16().collect();
                let [one] = units[..] else { return None };
                one.into()
            }
            AssertType::Text => {
                let characters = encoded(text_given)?;
                let room = usize::from(bytes[0]).min(bytes.len() - 2);
                if characters.len() > room {
                    return None;
                }
                bytes[1] = characters.len() as u8;
                bytes[2..2 + characters.len()].copy_from_slice(&characters);
                return Some(());
            }
            AssertType::WideText => {
                let units: Vec<u16> = text_given.encode_utf16().collect();
                let room = usize::from(u16::from_be_bytes([bytes[0], bytes[1]])).min(bytes.len() / 2 - 2);
                if units.len() > room {
                    return None;
                }
                bytes[2..4].copy_from_slice(&(units.len() as u16).to_be_bytes());
                for (place, unit) in bytes[4..].chunks_exact_mut(2).zip(units) {
                    place.copy_from_slice(&unit.to_be_bytes());
                }
                return Some(());
            }
            AssertType::Date => {
                let moment = datetime::moment(text.parse::<Date>().ok()?.to_datetime(Time::midnight()));
                u64::from(u16::try_from((moment - NS_TO_FIRST_DATE) / NS_PER_DAY as i64).ok()?)
            }
            AssertType::TimeOfDay => midnight(text.parse().ok()?) / NS_PER_MS,
            AssertType::Ltod => midnight(text.parse().ok()?),
            AssertType::Ldt => u64::try_from(moment()?).ok()?,
            AssertType::DateAndTime => {
                let moment = moment().filter(|&at| (1990..2090).contains(&datetime::civil(at).year()))?;
                u64::from_be_bytes(datetime::encode(moment))
            }
            AssertType::Dtl => {
                bytes.copy_from_slice(&dtl::encode(moment().filter(|&moment| moment >= 0)?));
                return Some(());
            }
        };
        let image = bits.to_be_bytes();
        bytes.copy_from_slice(&image[8 - bytes.len()..]);
        Some(())
    }

    /// Characters of the longest text.
    pub fn width_max(&self) -> u64 {
        match self.ty {
            // Quotes within quotes; three bytes of UTF-8 for a character.
            AssertType::Text | AssertType::WideText => 3 * u64::from(self.bytes),
            _ => 32,
        }
    }
}

/// A text of one line.
fn text_of(units: impl IntoIterator<Item = u16>) -> String {
    let characters = char::decode_utf16(units).map(|unit| unit.unwrap_or(char::REPLACEMENT_CHARACTER));
    characters.map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// The characters in Windows-1252.
fn encoded(text: &str) -> Option<Vec<u8>> {
    let byte = |c: char| (0..=255u8).find(|&byte| u32::from(windows_1252(byte.into())) == u32::from(c));
    text.chars().map(byte).collect()
}

/// `05:45:00.500`
fn clock(ns: u64) -> String {
    let (ms, rest) = (ns / NS_PER_MS, ns % NS_PER_MS);
    let tail = if rest == 0 { String::new() } else { format!("{rest:06}") };
    format!("{:02}:{:02}:{:02}.{:03}{tail}", ms / 3_600_000, ms / 60_000 % 60, ms / 1000 % 60, ms % 1000)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_go_to_text_and_back() {
        let check = |ty: AssertType, data: &[u8], text: &str| {
            let field = Field { name: String::new(), bits: 0, ty, bytes: data.len() as u32 };
            assert_eq!(field.text(data), text, "{ty:?}");
            let mut other = vec![0; data.len()];
            if matches!(ty, AssertType::Text | AssertType::WideText) {
                other[..2].copy_from_slice(&data[..2]);
            }
            assert_eq!(field.set(text, &mut other), Some(()), "{ty:?}");
            assert_eq!(other, data, "{ty:?}");
        };
        check(AssertType::Signed(16), &[0xFF, 0xFE], "-2");
        check(AssertType::Unsigned(16), &[0xFF, 0xFE], "65534");
        check(AssertType::Bits(32), &[0xFF; 4], "4294967295");
        check(AssertType::Real, &1.5f32.to_be_bytes(), "1.5");
        check(AssertType::Lreal, &(-1e300f64).to_be_bytes(), "-1e300");
        check(AssertType::Bool, &[1], "1");
        check(AssertType::Char, &[0xE4], "ä");
        check(AssertType::Text, &[4, 2, b'a', b',', 0, 0], "a,");
        check(AssertType::WideText, &[0, 2, 0, 1, 0x20, 0xAC, 0, 0], "€");
        check(AssertType::Time, &(-1500i32).to_be_bytes(), "-1500");
        check(AssertType::Date, &1u16.to_be_bytes(), "1990-01-02");
        check(AssertType::TimeOfDay, &3_661_007u32.to_be_bytes(), "01:01:01.007");
        check(AssertType::Ltod, &1u64.to_be_bytes(), "00:00:00.000000001");
    }

    #[test]
    fn texts_that_are_no_value_are_refused() {
        let check = |ty: AssertType, bytes: u32, text: &str| {
            let field = Field { name: String::new(), bits: 0, ty, bytes };
            assert_eq!(field.set(text, &mut vec![1; bytes as usize]), None, "{ty:?} {text}");
        };
        check(AssertType::Signed(16), 2, "32768");
        check(AssertType::Unsigned(8), 1, "-1");
        check(AssertType::Unsigned(8), 1, "256");
        check(AssertType::Bool, 1, "2");
        check(AssertType::Char, 1, "ab");
        check(AssertType::Text, 6, "ab");
        check(AssertType::Char, 1, "€€");
        check(AssertType::Date, 2, "1989-12-31x");
        check(AssertType::TimeOfDay, 4, "24:00:00");
        check(AssertType::Real, 4, "1,5");
    }

    #[test]
    fn fields_of_a_part_of_a_block() {
        let int = Shape::Value { ty: AssertType::Signed(16), bytes: 2 };
        let part =
            |name: &str, byte: u32, shape: &Shape| Part { name: name.into(), byte, bit: 0, shape: shape.clone() };
        let array = Shape::Array(ArrayShape {
            dimensions: vec![(1, 2)],
            bytes: 4,
            row: 2,
            row_bits: 0,
            element_bits: 16,
            element: Box::new(int.clone()),
        });
        let record = Shape::Struct { bytes: 6, parts: vec![part("a", 0, &int), part("b", 2, &array)] };
        let db = [DbShape { number: 3, parts: vec![part("x", 0, &int), part("r", 2, &record)] }];
        let names = |start, bytes| {
            within(&db, 3, start, bytes).map(|fields| fields.into_iter().map(|f| (f.name, f.bits)).collect::<Vec<_>>())
        };
        let expected = [("a", 0), ("b[1]", 16), ("b[2]", 32)].map(|(name, bits)| (name.to_string(), bits));
        assert_eq!(names(2, 6), Ok(expected.to_vec()));
        assert_eq!(names(0, 2), Ok(vec![("x".to_string(), 0)]));
        assert_eq!(names(0, 1), Err(Unfit::Types));
        assert_eq!(within(&db, 4, 0, 2), Err(Unfit::Types));
    }
}
