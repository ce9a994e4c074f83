//! The values that a program uses, by name.

use std::collections::{HashMap, HashSet};

use plcc_abi::ProgramImage;
use plcc_abi::image::SymbolEntry;
use plcc_abi::names::{NamedType, UsedArea, UsedPlace};
use plcc_abi::s7200::V_DB;

use super::path::written;
use super::{Finder, Named, Variable, current_value, db_name, find, usual_type};
use crate::address::{self, Address, Place, Width};
use crate::s7200::Part as S7200Part;

/// Values of an instance DB among those that a program uses.
const INSTANCE_VALUES_MAX: usize = 64;

/// Bytes of a DTL.
const DTL_BYTES: u32 = 12;

/// The value that an IEC timer or counter has, by a parameter of it that a call names.
const CURRENT: [(&str, &str); 5] = [(".IN", ".ET"), (".PT", ".ET"), (".CU", ".CV"), (".CD", ".CV"), (".PV", ".CV")];

/// The values that the program uses, with their names: what its code names, the values of its timers and counters, and those of its
/// instance DBs.
pub fn used(image: &ProgramImage) -> Vec<(String, Named)> {
    let finder = Finder { image };
    let symbols: HashMap<Address, &SymbolEntry> =
        image.symbols.iter().filter_map(|symbol| Some((address::parse_for(&symbol.address, image)?, symbol))).collect();
    let mut list: Vec<(String, Named)> = Vec::new();
    for (name, named) in image.used.iter().filter_map(|used| finder.used(used, &symbols)) {
        let value = current_value(named.address).map(|address| {
            let ty = usual_type(address.place);
            (format!("{}.VALUE", written(&name)), Named { address, ty })
        });
        let current =
            CURRENT.iter().find_map(|&(given, current)| Some(format!("{}{current}", name.strip_suffix(given)?)));
        let current = current.and_then(|name| find(&name, image).ok().map(|named| (name, named)));
        list.push((name, named));
        list.extend(value.into_iter().chain(current));
    }
    for db in &image.dbs {
        let Some(ty) = db.ty else { continue };
        if matches!(finder.ty(ty), Some(NamedType::Struct(structure)) if !structure.name.is_empty()) {
            let mut values = Vec::new();
            let variable = Variable { place: Place::Db(db.number, 0), bit: 0, ty };
            finder.list(&db_name(db), variable, INSTANCE_VALUES_MAX, &mut values);
            list.extend(values);
        }
    }
    // An access to a part of a value has the name of the value.
    let mut names = HashSet::new();
    list.retain(|(name, _)| names.insert(name.clone()));
    list
}

impl Finder<'_> {
    /// The value of a variable at `byte` and `bit` from its beginning (`None`: not a bit). Code reads and writes texts and DTL in parts: these
    /// belong to the whole value.
    fn at(&self, name: String, variable: Variable, byte: u32, bit: Option<u8>) -> Option<(String, Named)> {
        if let Some(named) = self.end(variable) {
            let in_parts = match self.ty(variable.ty) {
                Some(NamedType::Text { wide: false, length }) => byte < 2 + u32::from(*length),
                Some(NamedType::Text { wide: true, length }) => byte < 4 + 2 * u32::from(*length),
                Some(NamedType::Struct(_)) => byte < DTL_BYTES,
                Some(NamedType::Value(_) | NamedType::Array { .. } | NamedType::Other { .. }) | None => false,
            };
            let is_here = in_parts || byte == 0 && bit.is_none_or(|bit| bit == variable.bit);
            return is_here.then_some((name, named));
        }
        match self.ty(variable.ty)? {
            NamedType::Struct(structure) => {
                let before =
                    structure.members.partition_point(|member| (member.byte, member.bit) <= (byte, bit.unwrap_or(7)));
                let member = structure.members[..before].last()?;
                let name = format!("{name}.{}", written(&member.name));
                let inner = Variable { place: variable.place.offset(member.byte), bit: member.bit, ty: member.ty };
                self.at(name, inner, byte - member.byte, bit)
            }
            NamedType::Array { dimensions, element } => {
                let mut rest = u64::from(byte) * 8 + u64::from(bit.unwrap_or(0));
                let mut texts = Vec::new();
                for dimension in dimensions {
                    let number = rest / u64::from(dimension.distance.max(1));
                    let index = i64::from(dimension.low) + number as i64;
                    if index > i64::from(dimension.high) {
                        return None;
                    }
                    rest -= number * u64::from(dimension.distance);
                    texts.push(index.to_string());
                }
                let start = u64::from(byte) * 8 + u64::from(bit.unwrap_or(0)) - rest;
                let place = variable.place.offset((start / 8) as u32);
                let inner = Variable { place, bit: (start % 8) as u8, ty: *element };
                self.at(format!("{name}[{}]", texts.join(",")), inner, byte - (start / 8) as u32, bit)
            }
            NamedType::Value(_) | NamedType::Text { .. } | NamedType::Other { .. } => None,
        }
    }

    /// A place of the code, as a symbol or a value of a DB where it is one.
    fn used(&self, used: &UsedPlace, symbols: &HashMap<Address, &SymbolEntry>) -> Option<(String, Named)> {
        let is_s7200 = self.image.s7200.is_some();
        let (letter, place) = match used.area {
            UsedArea::Input => ("I".to_string(), Place::Input(used.byte)),
            UsedArea::Output => ("Q".to_string(), Place::Output(used.byte)),
            UsedArea::BitMemory => ("M".to_string(), Place::BitMemory(used.byte)),
            UsedArea::Timer if is_s7200 => ("T".to_string(), Place::S7200(S7200Part::TimerBit, used.byte)),
            UsedArea::Timer => ("T".to_string(), Place::Timer(used.byte)),
            UsedArea::Counter if is_s7200 => ("C".to_string(), Place::S7200(S7200Part::CounterBit, used.byte)),
            UsedArea::Counter => ("C".to_string(), Place::Counter(used.byte)),
            UsedArea::Db(V_DB) if is_s7200 => ("V".to_string(), Place::Db(V_DB, used.byte)),
            UsedArea::Db(number) => (format!("DB{number}.DB"), Place::Db(number, used.byte)),
            UsedArea::PeripheralInput => ("PI".to_string(), Place::PeripheralInput(used.byte)),
            UsedArea::PeripheralOutput => ("PQ".to_string(), Place::PeripheralOutput(used.byte)),
            UsedArea::AnalogInput => ("AI".to_string(), Place::S7200(S7200Part::AnalogInput, used.byte)),
            UsedArea::AnalogOutput => ("AQ".to_string(), Place::S7200(S7200Part::AnalogOutput, used.byte)),
            UsedArea::SpecialMemory => ("SM".to_string(), Place::S7200(S7200Part::SpecialMemory, used.byte)),
            UsedArea::Relays => ("S".to_string(), Place::S7200(S7200Part::Relays, used.byte)),
            UsedArea::HighSpeedCounter => ("HC".to_string(), Place::S7200(S7200Part::HighSpeedCounter, used.byte)),
        };
        let (width, size) = match used.bits {
            1 => (Width::Bit(used.bit), ""),
            8 => (Width::Byte, "B"),
            16 => (Width::Word, "W"),
            32 => (Width::Dword, "D"),
            _ => (Width::Lword, "L"),
        };
        let address = Address { place, width };
        if let Some(symbol) = symbols.get(&address)
            && let Ok(named) = find(&symbol.name, self.image)
        {
            return Some((symbol.name.clone(), named));
        }
        let bit = (used.bits == 1).then_some(used.bit);
        if let UsedArea::Db(number) = used.area
            && let Some(db) = self.db(number.into())
            && let Some(ty) = db.ty
        {
            let found = self.at(db_name(db), Variable { place: place.start(), bit: 0, ty }, used.byte, bit);
            // Pointers to actuals are not values.
            if found.is_some()
                || matches!(self.ty(ty), Some(NamedType::Struct(structure)) if !structure.name.is_empty())
            {
                // A BOOL that is alone in its byte is stored as a byte.
                let is_stored = |found: Width| found == width || used.bits == 8 && found == Width::Bit(0);
                return found.filter(|(_, named)| is_stored(named.address.width));
            }
        }
        let name = match (used.area, bit) {
            (UsedArea::Timer | UsedArea::Counter | UsedArea::HighSpeedCounter, _) => format!("{letter}{}", used.byte),
            (_, Some(bit)) if letter.ends_with("DB") => format!("{letter}X{}.{bit}", used.byte),
            (_, Some(bit)) => format!("{letter}{}.{bit}", used.byte),
            (_, None) => format!("{letter}{size}{}", used.byte),
        };
        Some((name, Named { address, ty: None }))
    }
}
