//! Pairs of values with the same symbolic path and type in two programs.

use plcc_abi::image::{AssertType, DbEntry};
use plcc_abi::names::{Dimension, NamedStruct, NamedType, TypeNumber};

use super::charts::{self, Chart};
use crate::typed;

/// Bits that go from one place to another, counted from the beginning of memory; within a byte from the lowest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Move {
    pub from: u64,
    pub to: u64,
    pub bits: u64,
}

/// A value that points at data: where it was, where it will be, and its bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pointer {
    pub from: u32,
    pub to: u32,
    pub bytes: u32,
    /// Where in it the number of a DB and the area code are. Without a code it points into a DB if it points anywhere.
    pub db: u32,
    pub area: Option<u32>,
}

/// A side of a comparison.
pub(super) struct Side<'a> {
    pub types: &'a [NamedType],
    pub db: &'a DbEntry,
}

impl<'a> Side<'a> {
    pub(super) fn ty(&self, number: TypeNumber) -> Option<&'a NamedType> {
        self.types.get(number as usize)
    }

    /// The start value of a word at this bit of the block.
    pub(super) fn word(&self, bit: u64) -> u16 {
        let at = (bit / 8) as usize;
        self.db.data.get(at..at + 2).map_or(0, |bytes| u16::from_be_bytes([bytes[0], bytes[1]]))
    }

    pub(super) fn base(&self) -> u64 {
        8 * u64::from(self.db.address)
    }
}

/// What two data blocks have in common.
pub(super) struct Pairs<'a> {
    pub old: Side<'a>,
    pub new: Side<'a>,
    pub moves: Vec<Move>,
    pub pointers: Vec<Pointer>,
    /// Paths that only one side has, or whose types differ: text, and whether a value goes.
    pub items: Vec<(String, bool)>,
    /// Charts with other steps or transitions that may go on.
    pub charts: Vec<Chart>,
}

/// A place in both blocks, in bits from their beginnings.
#[derive(Clone, Copy)]
struct Place {
    old: u64,
    new: u64,
}

/// How the names of references to types begin.
const REFERENCE: &str = "REF_TO ";
/// Deeper structures do not exist: a type has a larger number than those that it contains.
const DEPTH_MAX: u32 = 64;
/// Items of one data block that are listed.
const ITEMS_MAX: usize = 100;

impl Pairs<'_> {
    /// Compares the types of the blocks as wholes.
    pub fn compare(&mut self, old: TypeNumber, new: TypeNumber, name: &str) {
        self.pair(old, new, name, Place { old: 0, new: 0 }, 0);
    }

    pub(super) fn item(&mut self, text: String, loses: bool) {
        if self.items.len() < ITEMS_MAX && !self.items.iter().any(|(known, _)| *known == text) {
            self.items.push((text, loses));
        }
    }

    fn pair(&mut self, old: TypeNumber, new: TypeNumber, path: &str, place: Place, depth: u32) {
        let (Some(was), Some(is)) = (self.old.ty(old), self.new.ty(new)) else { return };
        if depth > DEPTH_MAX {
            return;
        }
        match (was, is) {
            (NamedType::Value(a), NamedType::Value(b)) if a == b => self.take(place, value_bits(*a)),
            (NamedType::Text { .. }, NamedType::Text { .. }) if was == is => self.take(place, text_bits(was)),
            (NamedType::Other { name: a }, NamedType::Other { name: b }) if a == b => self.pointer(a, place),
            (NamedType::Array { dimensions: a, element: from }, NamedType::Array { dimensions: b, element: to })
                if a.len() == b.len() =>
            {
                self.array((a, *from), (b, *to), path, place, depth)
            }
            (NamedType::Struct(a), NamedType::Struct(b)) if a.name == b.name && a.name.starts_with(REFERENCE) => {
                self.pointer(&a.name, place);
            }
            (NamedType::Struct(a), NamedType::Struct(b))
                if is_same(&a.name, &b.name) && !a.name.starts_with(REFERENCE) =>
            {
                self.structure(a, b, path, place, depth);
            }
            _ => {
                let (a, b) = (self.old.name(old), self.new.name(new));
                self.item(format!("{path} is {b} instead of {a}: it gets its initial value"), true);
            }
        }
    }

    /// Compares two values at these bits from the beginnings of the blocks.
    pub(super) fn pair_at(&mut self, old: TypeNumber, new: TypeNumber, path: &str, (was, is): (u64, u64)) {
        self.pair(old, new, path, Place { old: was, new: is }, 0);
    }

    fn take(&mut self, place: Place, bits: u64) {
        let (from, to) = (self.old.base() + place.old, self.new.base() + place.new);
        if let Some(last) = self.moves.last_mut()
            && (last.from + last.bits, last.to + last.bits) == (from, to)
        {
            last.bits += bits;
            return;
        }
        self.moves.push(Move { from, to, bits });
    }

    /// A parameter type, whose value may point at data that moves.
    fn pointer(&mut self, name: &str, place: Place) {
        // Source: STL reference, formats of POINTER and ANY. A VARIANT begins with an ANY.
        let (bytes, db, area) = match name {
            "POINTER" => (6, 0, Some(2)),
            "ANY" => (10, 4, Some(6)),
            "VARIANT" => (18, 4, Some(6)),
            reference if reference.starts_with(REFERENCE) => (8, 0, None),
            "TIMER" | "COUNTER" | "BLOCK_FB" | "BLOCK_FC" | "BLOCK_DB" | "BLOCK_SDB" => return self.take(place, 16),
            // An array without bounds is a parameter, which each call supplies.
            _ => return,
        };
        let at = |base: u64, bit: u64| ((base + bit) / 8) as u32;
        let (from, to) = (at(self.old.base(), place.old), at(self.new.base(), place.new));
        self.pointers.push(Pointer { from, to, bytes, db, area });
    }

    /// Elements with the same indices.
    fn array(
        &mut self,
        (a, from): (&[Dimension], TypeNumber),
        (b, to): (&[Dimension], TypeNumber),
        path: &str,
        place: Place,
        depth: u32,
    ) {
        let Some(((first_a, rest_a), (first_b, rest_b))) = a.split_first().zip(b.split_first()) else {
            return self.pair(from, to, path, place, depth + 1);
        };
        if first_a.low < first_b.low || first_a.high > first_b.high {
            let bounds = |one: &Dimension| format!("[{}..{}]", one.low, one.high);
            self.item(
                format!(
                    "{path}{} has the bounds {}: elements outside them are removed",
                    bounds(first_a),
                    bounds(first_b)
                ),
                true,
            );
        }
        let inner = format!("{path}[]");
        for index in first_a.low.max(first_b.low)..=first_a.high.min(first_b.high) {
            let at = |one: &Dimension| (i64::from(index) - i64::from(one.low)) as u64 * u64::from(one.distance);
            let element = Place { old: place.old + at(first_a), new: place.new + at(first_b) };
            self.array((rest_a, from), (rest_b, to), &inner, element, depth);
        }
    }

    fn structure(&mut self, a: &NamedStruct, b: &NamedStruct, path: &str, place: Place, depth: u32) {
        let (was, is) = (charts::parts(&self.old, a, place.old), charts::parts(&self.new, b, place.new));
        let is_other_chart = !is.is_empty() && !charts::are_same(&was, &is);
        if is_other_chart {
            charts::compare(self, (a, b), (place.old, place.new), path);
        }
        for member in &b.members {
            if is_other_chart && charts::is_of_chart(&self.new, b, member) {
                continue;
            }
            let inner = format!("{path}.{}", member.name);
            match a.members.iter().find(|other| is_same(&other.name, &member.name)) {
                Some(other) => {
                    let place = Place { old: charts::at(place.old, other), new: charts::at(place.new, member) };
                    self.pair(other.ty, member.ty, &inner, place, depth + 1);
                }
                None => self.item(format!("{inner} is new: it gets its initial value"), false),
            }
        }
        for member in &a.members {
            if is_other_chart && charts::is_of_chart(&self.old, a, member) {
                continue;
            }
            if !b.members.iter().any(|other| is_same(&other.name, &member.name)) {
                self.item(format!("{path}.{} is removed", member.name), true);
            }
        }
    }
}

impl Side<'_> {
    /// The type as a user knows it.
    fn name(&self, number: TypeNumber) -> String {
        match self.ty(number) {
            Some(NamedType::Value(ty)) => typed::name(*ty).to_string(),
            Some(NamedType::Text { wide, length }) => format!("{}STRING[{length}]", if *wide { "W" } else { "" }),
            Some(NamedType::Array { dimensions, element }) => {
                let bounds: Vec<String> = dimensions.iter().map(|one| format!("{}..{}", one.low, one.high)).collect();
                let element = if *element < number { self.name(*element) } else { String::new() };
                format!("ARRAY[{}] OF {element}", bounds.join(","))
            }
            Some(NamedType::Struct(one)) if one.name.is_empty() => "STRUCT".to_string(),
            Some(NamedType::Struct(one)) => one.name.clone(),
            Some(NamedType::Other { name }) => name.clone(),
            None => "an unknown type".to_string(),
        }
    }
}

/// Names of the CPU do not distinguish case.
pub(super) fn is_same(a: &str, b: &str) -> bool {
    a == b || a.to_lowercase() == b.to_lowercase()
}

/// Bits of a value in memory. Texts have a type of their own.
fn value_bits(ty: AssertType) -> u64 {
    match typed::bits(ty) {
        Some(bits) => bits.into(),
        None => {
            if ty == AssertType::Dtl {
                96
            } else {
                0
            }
        }
    }
}

fn text_bits(ty: &NamedType) -> u64 {
    match ty {
        NamedType::Text { wide: false, length } => 8 * (u64::from(*length) + 2),
        NamedType::Text { wide: true, length } => 16 * (u64::from(*length) + 2),
        _ => 0,
    }
}
