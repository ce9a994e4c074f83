//! Symbolic names of values: `"Station_DB".D1.Starts`, `Motors.m[2].speed`, `DB41.S005.X`, `Status.%X3`.
//!
//! A name begins with a symbol or a DB, and goes on with members, indices and at last a slice of a bit string. Quotes may be
//! left out, and letters of both cases are the same where no other name has the exact letters.

mod instances;
mod limits;
mod messages;
pub mod path;
mod used;

use plcc_abi::ProgramImage;
use plcc_abi::image::{AssertType, DbEntry};
use plcc_abi::names::{NamedStruct, NamedType, TypeNumber};

use crate::address::{self, Address, Place, Width, digits};
use crate::s7200::Part as S7200Part;
use crate::signal;
use crate::typed::ValueType;
use messages::{no_member, what};
use path::{Part, written};

pub use instances::{InstanceName, instance};
pub use limits::Limits;
pub use used::used;

/// A value with an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Named {
    pub address: Address,
    /// Its declared type; `None`: bits without another meaning.
    pub ty: Option<ValueType>,
}

/// A variable on the way to a value: where it begins, and its type.
#[derive(Clone, Copy)]
struct Variable {
    place: Place,
    bit: u8,
    ty: TypeNumber,
}

/// Finds an absolute address or a symbolic name. `Err`: the error as a sentence.
pub fn find(text: &str, image: &ProgramImage) -> Result<Named, String> {
    let text = text.trim();
    if text.is_empty() || text == "\"\"" {
        return Err(format!(
            "the name is empty; write an address (such as {}) or a name of the program",
            examples(image)
        ));
    }
    let bare = text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).unwrap_or(text);
    let is_symbol = image.symbols.iter().any(|symbol| symbol.name == text || symbol.name == bare);
    if !is_symbol && let Some(address) = address::parse_for(text, image).or_else(|| signal::analog_channel(text, image))
    {
        return Ok(Named { address, ty: usual_type(address.place) });
    }
    let finder = Finder { image };
    let parts = match is_symbol {
        true => Some(vec![Part::Name(bare.to_string())]),
        false => path::parts(text),
    };
    match parts.as_deref() {
        Some([Part::Name(root), rest @ ..]) => finder.value(text, root, rest).map_err(|wrong| {
            // `I0.9` was meant as an address.
            address::too_large(text).map_or(wrong, |why| format!("`{text}` is not an address: {why}"))
        }),
        _ => Err(format!("`{text}` is neither an address (such as {}) nor a name", examples(image))),
    }
}

/// Addresses of the CPU, for messages.
fn examples(image: &ProgramImage) -> &'static str {
    if image.s7200.is_some() { "Q0.0, VW20, SM0.1" } else { "Q4.0, MW20, DB10.DBD4" }
}

/// All values of a structure, an array or a DB, with their names, at most `most`; a value alone is a list of one. `Err`: as
/// for [`find`].
pub fn values(text: &str, image: &ProgramImage, most: usize) -> Result<Vec<(String, Named)>, String> {
    let wrong = match find(text, image) {
        Ok(named) => return Ok(vec![(text.trim().to_string(), named)]),
        Err(wrong) => wrong,
    };
    let finder = Finder { image };
    let Some(parts) = path::parts(text) else { return Err(wrong) };
    let [Part::Name(root), rest @ ..] = &parts[..] else { return Err(wrong) };
    let Ok(Root::Variable(variable)) = finder.root(text, root) else { return Err(wrong) };
    let Ok(variable) = finder.walk(variable, rest, root) else { return Err(wrong) };
    let mut list = Vec::new();
    finder.list(text.trim(), variable, most, &mut list);
    if list.is_empty() { Err(wrong) } else { Ok(list) }
}

/// Values next to that of `text` in the same structure, at most `most`.
pub fn neighbours(text: &str, image: &ProgramImage, most: usize) -> Vec<(String, Named)> {
    let Some(parts) = path::parts(text) else { return Vec::new() };
    let finder = Finder { image };
    let [Part::Name(root), rest @ .., Part::Name(last)] = &parts[..] else { return Vec::new() };
    let Ok(Root::Variable(variable)) = finder.root(text, root) else { return Vec::new() };
    let Ok(variable) = finder.walk(variable, rest, root) else { return Vec::new() };
    let Some(NamedType::Struct(structure)) = finder.ty(variable.ty) else { return Vec::new() };
    let others = structure.members.iter().filter(|member| !same(&member.name, last));
    let values = others.filter_map(|member| {
        let variable = Variable { place: variable.place.offset(member.byte), bit: member.bit, ty: member.ty };
        Some((written(&member.name), finder.end(variable)?))
    });
    values.take(most).collect()
}

/// Timers and counters have values of a type, although they are not declared.
fn usual_type(place: Place) -> Option<ValueType> {
    match place {
        Place::TimerValue(_) => Some(ValueType::of(AssertType::S5Time)),
        Place::CounterValue(_) | Place::S7200(S7200Part::TimerValue | S7200Part::CounterValue, _) => {
            Some(ValueType::of(AssertType::Signed(16)))
        }
        Place::Input(_)
        | Place::Output(_)
        | Place::BitMemory(_)
        | Place::PeripheralInput(_)
        | Place::PeripheralOutput(_)
        | Place::Db(..)
        | Place::Timer(_)
        | Place::Counter(_)
        | Place::S7200(..) => None,
    }
}

fn same(a: &str, b: &str) -> bool {
    a == b || a.to_lowercase() == b.to_lowercase()
}

/// What the first part of a name means.
enum Root {
    Address(Address, Option<ValueType>),
    Variable(Variable),
}

struct Finder<'a> {
    image: &'a ProgramImage,
}

impl<'a> Finder<'a> {
    fn ty(&self, number: TypeNumber) -> Option<&'a NamedType> {
        self.image.types.get(number as usize)
    }

    fn value(&self, text: &str, root: &str, rest: &[Part]) -> Result<Named, String> {
        let (rest, slice) = match rest {
            [rest @ .., Part::Slice(width, number)] => (rest, Some((*width, *number))),
            rest => (rest, None),
        };
        let named = match (self.root(text, root)?, rest) {
            (Root::Address(address, ty), []) => Named { address, ty },
            (Root::Address(address, _), [Part::Name(value)]) if value.eq_ignore_ascii_case("VALUE") => {
                let address = current_value(address).ok_or_else(|| format!("`{root}` has no `{value}`"))?;
                Named { address, ty: usual_type(address.place) }
            }
            (Root::Address(Address { width, .. }, _), [Part::Name(bit)])
                if !matches!(width, Width::Bit(_)) && digits(bit).is_some() =>
            {
                return Err(self.bit_of_word(root, bit));
            }
            (Root::Address(address, _), [part, ..]) => {
                let current = current_value(address);
                let help = current.map_or_else(String::new, |_| format!("; its current value is `{root}.VALUE`"));
                return Err(format!("`{root}` is a value without {}{help}", what(part)));
            }
            (Root::Variable(variable), rest) => {
                let found = self.walk(variable, rest, root)?;
                self.end(found).ok_or_else(|| self.no_value(text, found))?
            }
        };
        match slice {
            None => Ok(named),
            Some((width, number)) => sliced(named, width, number)
                .ok_or_else(|| format!("`{text}`: a slice is part of a bit string or an integer, and within it")),
        }
    }

    /// A symbol or DB; one with the exact letters goes first.
    fn root(&self, text: &str, root: &str) -> Result<Root, String> {
        let rules: [fn(&str, &str) -> bool; 2] = [|a, b| a == b, same];
        for is_name in rules {
            if let Some(symbol) = self.image.symbols.iter().find(|symbol| is_name(&symbol.name, root)) {
                if let Some(db) = symbol.address.strip_prefix("DB").and_then(digits).and_then(|number| self.db(number))
                {
                    return self.of_db(db);
                }
                let address = address::parse_for(&symbol.address, self.image)
                    .ok_or_else(|| format!("symbol {text} means {}, which is not a value", symbol.address))?;
                return Ok(match symbol.ty.and_then(|number| Some((number, self.ty(number)?))) {
                    Some((_, NamedType::Value(ty))) => Root::Address(address, Some(ValueType::of(*ty))),
                    Some((ty, _)) => Root::Variable(Variable { place: address.place, bit: 0, ty }),
                    None => Root::Address(address, usual_type(address.place)),
                });
            }
            let mut dbs = self.image.dbs.iter();
            if let Some(db) = dbs.find(|db| !db.name.is_empty() && is_name(&db.name, root)) {
                return self.of_db(db);
            }
        }
        let upper = root.strip_prefix('%').unwrap_or(root).to_ascii_uppercase();
        if let Some(number) = upper.strip_prefix("DB").map(str::trim).and_then(digits) {
            let db = self.db(number).ok_or_else(|| format!("the program has no DB {number}"))?;
            return self.of_db(db);
        }
        if let Some(address) = address::parse_for(root, self.image) {
            return Ok(Root::Address(address, usual_type(address.place)));
        }
        Err(self.unknown(text, root))
    }

    fn db(&self, number: u32) -> Option<&'a DbEntry> {
        self.image.dbs.iter().find(|db| u32::from(db.number) == number)
    }

    fn of_db(&self, db: &DbEntry) -> Result<Root, String> {
        let ty =
            db.ty.ok_or_else(|| format!("DB {} has no declared values; name an address, as DB{0}.DBW0", db.number))?;
        Ok(Root::Variable(Variable { place: Place::Db(db.number, 0), bit: 0, ty }))
    }

    /// Follows members and indices.
    fn walk(&self, mut variable: Variable, parts: &[Part], root: &str) -> Result<Variable, String> {
        let mut so_far = written(root);
        for part in parts {
            let next = match (part, self.ty(variable.ty)) {
                (Part::Name(name), Some(NamedType::Struct(structure))) => {
                    let member = member(structure, name).ok_or_else(|| no_member(&so_far, structure, name))?;
                    so_far = format!("{so_far}.{}", written(&member.name));
                    Variable { place: variable.place.offset(member.byte), bit: member.bit, ty: member.ty }
                }
                (Part::Index(indices), Some(NamedType::Array { dimensions, element })) => {
                    if indices.len() != dimensions.len() {
                        let wanted = match dimensions.len() {
                            1 => "1 index".to_string(),
                            count => format!("{count} indices"),
                        };
                        return Err(format!("`{so_far}` is {}: it needs {wanted}", self.name(variable.ty)));
                    }
                    let mut bits = u64::from(variable.bit);
                    for (&index, dimension) in indices.iter().zip(dimensions) {
                        let (low, high) = (i64::from(dimension.low), i64::from(dimension.high));
                        if !(low..=high).contains(&index) {
                            return Err(format!("index {index} of `{so_far}` is not from {low} to {high}"));
                        }
                        bits += (index - low) as u64 * u64::from(dimension.distance);
                    }
                    let texts: Vec<String> = indices.iter().map(ToString::to_string).collect();
                    so_far = format!("{so_far}[{}]", texts.join(","));
                    Variable { place: variable.place.offset((bits / 8) as u32), bit: (bits % 8) as u8, ty: *element }
                }
                (part, _) => {
                    return Err(format!("`{so_far}` is {} and has no {}", self.name(variable.ty), what(part)));
                }
            };
            variable = next;
        }
        Ok(variable)
    }

    /// The value that a variable is; `None`: it consists of others, or has none.
    fn end(&self, variable: Variable) -> Option<Named> {
        let ty = match self.ty(variable.ty)? {
            NamedType::Value(ty) => ValueType::of(*ty),
            NamedType::Text { wide, length } => {
                let ty = if *wide { AssertType::WideText } else { AssertType::Text };
                ValueType { ty, length: *length }
            }
            NamedType::Struct(structure) if structure.is_dtl => ValueType::of(AssertType::Dtl),
            NamedType::Struct(_) | NamedType::Array { .. } | NamedType::Other { .. } => return None,
        };
        let address = Address { place: variable.place, width: ty.width(variable.bit) };
        Some(Named { address, ty: Some(ty) })
    }

    fn list(&self, name: &str, variable: Variable, most: usize, list: &mut Vec<(String, Named)>) {
        if list.len() >= most {
            return;
        }
        if let Some(named) = self.end(variable) {
            return list.push((name.to_string(), named));
        }
        match self.ty(variable.ty) {
            Some(NamedType::Struct(structure)) => {
                for member in &structure.members {
                    let name = format!("{name}.{}", written(&member.name));
                    let place = variable.place.offset(member.byte);
                    self.list(&name, Variable { place, bit: member.bit, ty: member.ty }, most, list);
                }
            }
            Some(NamedType::Array { dimensions, element }) => {
                let mut indices: Vec<i64> = dimensions.iter().map(|dimension| i64::from(dimension.low)).collect();
                let is_empty = dimensions.iter().any(|dimension| dimension.low > dimension.high);
                while !is_empty && list.len() < most {
                    let bits: u64 = indices
                        .iter()
                        .zip(dimensions)
                        .map(|(index, dimension)| {
                            (index - i64::from(dimension.low)) as u64 * u64::from(dimension.distance)
                        })
                        .sum();
                    let texts: Vec<String> = indices.iter().map(ToString::to_string).collect();
                    let name = format!("{name}[{}]", texts.join(","));
                    let place = variable.place.offset((bits / 8) as u32);
                    self.list(&name, Variable { place, bit: (bits % 8) as u8, ty: *element }, most, list);
                    // The last index runs fastest.
                    let next = (0..indices.len()).rev().find(|&at| indices[at] < i64::from(dimensions[at].high));
                    let Some(next) = next else { break };
                    indices[next] += 1;
                    for at in next + 1..indices.len() {
                        indices[at] = i64::from(dimensions[at].low);
                    }
                }
            }
            Some(NamedType::Value(_) | NamedType::Text { .. } | NamedType::Other { .. }) | None => {}
        }
    }
}

pub(crate) fn db_name(db: &DbEntry) -> String {
    if db.name.is_empty() { format!("DB{}", db.number) } else { written(&db.name) }
}

fn member<'a>(structure: &'a NamedStruct, name: &str) -> Option<&'a plcc_abi::names::NamedMember> {
    let members = &structure.members;
    members.iter().find(|member| member.name == name).or_else(|| members.iter().find(|member| same(&member.name, name)))
}

/// `VALUE` of a timer or counter.
fn current_value(address: Address) -> Option<Address> {
    let place = match address.place {
        Place::Timer(number) => Place::TimerValue(number),
        Place::Counter(number) => Place::CounterValue(number),
        Place::S7200(part, number) => Place::S7200(part.current_value()?, number),
        Place::Input(_)
        | Place::Output(_)
        | Place::BitMemory(_)
        | Place::PeripheralInput(_)
        | Place::PeripheralOutput(_)
        | Place::Db(..)
        | Place::TimerValue(_)
        | Place::CounterValue(_) => return None,
    };
    Some(Address { place, width: Width::Word })
}

/// Slice `number` of `width` bits of a value.
fn sliced(named: Named, width: u32, number: u32) -> Option<Named> {
    let is_whole = match named.ty {
        None => true,
        Some(ty) => matches!(ty.ty, AssertType::Bits(_) | AssertType::Signed(_) | AssertType::Unsigned(_)),
    };
    let bits = named.address.width.bits();
    let has_bytes = match named.address.place {
        Place::Timer(_) | Place::Counter(_) | Place::TimerValue(_) | Place::CounterValue(_) | Place::S7200(..) => false,
        Place::Input(_)
        | Place::Output(_)
        | Place::BitMemory(_)
        | Place::PeripheralInput(_)
        | Place::PeripheralOutput(_)
        | Place::Db(..) => true,
    };
    let end = number.checked_add(1)?.checked_mul(width)?;
    if !is_whole || !has_bytes || matches!(named.address.width, Width::Bit(_)) || end > bits || width == bits {
        return None;
    }
    let first = number * width;
    let (byte, ty) = match width {
        1 => (bits / 8 - 1 - first / 8, AssertType::Bool),
        _ => ((bits - end) / 8, AssertType::Bits(width as u8)),
    };
    let ty = ValueType::of(ty);
    let address = Address { place: named.address.place.offset(byte), width: ty.width((first % 8) as u8) };
    Some(Named { address, ty: Some(ty) })
}
