//! What clients may do with an address, by the attributes of declarations and tag tables.

use std::ops::Range;

use plcc_abi::ProgramImage;
use plcc_abi::names::{External, NamedType, TypeNumber};

use crate::address::{self, Address, Place, Width};
use crate::typed::{self, ValueType};

/// The tags with which clients may not do everything: their area, where they are in it, and what clients may do.
pub struct Limits(Vec<(Place, Range<u64>, External)>);

impl Limits {
    pub fn new(image: &ProgramImage) -> Limits {
        let symbols = image.symbols.iter().filter(|symbol| symbol.external != External::Write);
        let limits = symbols.filter_map(|symbol| {
            let address = address::parse_for(&symbol.address, image)?;
            let declared = symbol.ty.map_or(0, |ty| bits_of(&image.types, ty));
            let (area, bits) = tag_range(&address, declared.max(address.width.bits().into()))?;
            Some((area, bits, symbol.external))
        });
        Limits(limits.collect())
    }

    /// What clients may do with a value of so many bits, of which all are at the address: no more than with any tag or component there.
    pub fn of(&self, image: &ProgramImage, address: &Address, bits: u64) -> External {
        let Place::Db(number, byte) = address.place else { return self.of_tags(address, bits) };
        let Some(ty) = image.dbs.iter().find(|db| db.number == number).and_then(|db| db.ty) else {
            return External::default();
        };
        let start = first_bit(byte, address.width);
        of_components(&image.types, ty, 0, &(start..start + bits))
    }

    /// The same for an address that is not in a data block.
    pub fn of_tags(&self, address: &Address, bits: u64) -> External {
        let Some((area, bits)) = tag_range(address, bits) else { return External::default() };
        let there = self.0.iter().filter(|(own, range, _)| *own == area && overlap(range, &bits));
        there.map(|(.., external)| *external).min().unwrap_or_default()
    }
}

/// The area of an address outside of data blocks, and the bits that a value has there. Direct access to modules is access to the process image.
fn tag_range(address: &Address, bits: u64) -> Option<(Place, Range<u64>)> {
    // A timer or counter is as many bits as a byte, whatever its values have.
    let cell = |number: u32| first_bit(number, Width::Byte)..first_bit(number, Width::Byte) + 8;
    let memory = |byte: u32| first_bit(byte, address.width)..first_bit(byte, address.width) + bits;
    Some(match address.place {
        Place::Input(byte) | Place::PeripheralInput(byte) => (Place::Input(0), memory(byte)),
        Place::Output(byte) | Place::PeripheralOutput(byte) => (Place::Output(0), memory(byte)),
        Place::BitMemory(byte) => (Place::BitMemory(0), memory(byte)),
        Place::Timer(number) | Place::TimerValue(number) => (Place::Timer(0), cell(number)),
        Place::Counter(number) | Place::CounterValue(number) => (Place::Counter(0), cell(number)),
        Place::Db(..) | Place::S7200(..) => return None,
    })
}

fn first_bit(byte: u32, width: Width) -> u64 {
    let bit = if let Width::Bit(bit) = width { bit } else { 0 };
    8 * u64::from(byte) + u64::from(bit)
}

fn overlap(one: &Range<u64>, other: &Range<u64>) -> bool {
    one.start < other.end && other.start < one.end
}

/// What clients may do with the bits `wanted` by the components of a variable that begins at the bit `start`.
fn of_components(types: &[NamedType], ty: TypeNumber, start: u64, wanted: &Range<u64>) -> External {
    match types.get(ty as usize) {
        Some(NamedType::Struct(structure)) => {
            let there = structure.members.iter().filter_map(|member| {
                let at = start + 8 * u64::from(member.byte) + u64::from(member.bit);
                let is_there = overlap(&(at..at + bits_of(types, member.ty)), wanted);
                is_there.then(|| member.external.min(of_components(types, member.ty, at, wanted)))
            });
            there.min().unwrap_or_default()
        }
        Some(NamedType::Array { dimensions, element }) => {
            let (mut at, mut rest) = (start, wanted.start.max(start) - start);
            for dimension in dimensions {
                let distance = u64::from(dimension.distance.max(1));
                at += rest - rest % distance;
                rest %= distance;
            }
            match wanted.end <= at + bits_of(types, *element) {
                true => of_components(types, *element, at, wanted),
                // Parts of several elements.
                false => of_components(types, *element, 0, &(0..u64::MAX)),
            }
        }
        Some(NamedType::Value(_) | NamedType::Text { .. } | NamedType::Other { .. }) | None => External::default(),
    }
}

/// From the first bit of a value to its last.
fn bits_of(types: &[NamedType], ty: TypeNumber) -> u64 {
    let of_value = |ty: ValueType| typed::bits(ty.ty).map_or_else(|| 8 * u64::from(ty.bytes()), u64::from);
    match types.get(ty as usize) {
        Some(NamedType::Value(ty)) => of_value(ValueType::of(*ty)),
        // The head of a WSTRING has two words.
        Some(NamedType::Text { wide: true, length }) => 16 * (u64::from(*length) + 2),
        Some(NamedType::Text { wide: false, length }) => 8 * (u64::from(*length) + 2),
        Some(NamedType::Array { dimensions, element }) => {
            let last = dimensions.iter().map(|dimension| {
                let steps = i64::from(dimension.high).abs_diff(dimension.low.into());
                steps * u64::from(dimension.distance)
            });
            last.sum::<u64>() + bits_of(types, *element)
        }
        Some(NamedType::Struct(structure)) => {
            let ends = structure
                .members
                .iter()
                .map(|member| 8 * u64::from(member.byte) + u64::from(member.bit) + bits_of(types, member.ty));
            ends.max().unwrap_or(0)
        }
        Some(NamedType::Other { .. }) | None => 0,
    }
}

#[cfg(test)]
mod tests {
    use plcc_abi::image::AssertType;
    use plcc_abi::names::{Dimension, NamedMember, NamedStruct};

    use super::*;

    const INT: TypeNumber = 0;
    const BOOL: TypeNumber = 1;
    const PAIR: TypeNumber = 2;
    const LIST: TypeNumber = 3;
    const BLOCK: TypeNumber = 4;

    /// PAIR has two INT, of which clients may only read the second, and two BOOL, of which the first is hidden. BLOCK has an INT, an array of
    /// two PAIR, and a PAIR that clients may only read.
    fn types() -> Vec<NamedType> {
        let member = |(ty, byte, bit, external): (TypeNumber, u32, u8, External)| NamedMember {
            name: format!("m{byte}_{bit}"),
            ty,
            byte,
            bit,
            external,
        };
        let structure = |members: &[(TypeNumber, u32, u8, External)]| {
            let members = members.iter().copied().map(member).collect();
            NamedType::Struct(NamedStruct { name: String::new(), data_type: String::new(), members, is_dtl: false })
        };
        let (hidden, read, write) = (External::Hidden, External::Read, External::Write);
        vec![
            NamedType::Value(AssertType::Signed(16)),
            NamedType::Value(AssertType::Bool),
            structure(&[(INT, 0, 0, write), (INT, 2, 0, read), (BOOL, 4, 0, hidden), (BOOL, 4, 1, write)]),
            NamedType::Array { dimensions: vec![Dimension { low: 1, high: 2, distance: 48 }], element: PAIR },
            structure(&[(INT, 0, 0, write), (LIST, 2, 0, write), (PAIR, 14, 0, read)]),
        ]
    }

    #[test]
    fn the_least_right_of_the_components_there_holds() {
        let (hidden, read, write) = (External::Hidden, External::Read, External::Write);
        for (start, bits, expected) in [
            (0, 16, write),
            (16, 16, write),
            (32, 16, read),
            (48, 1, hidden),
            (49, 1, write),
            (64, 16, write),
            (80, 8, read),
            (97, 1, write),
            // Of both elements, of the number and the first element, of the structure that clients may only read, of nothing.
            (49, 32, hidden),
            (0, 32, write),
            (112, 16, read),
            (145, 1, read),
            (1000, 8, write),
        ] {
            assert_eq!(of_components(&types(), BLOCK, 0, &(start..start + bits)), expected, "{start} {bits}");
        }
    }

    #[test]
    fn tags_hold_for_what_overlaps_them() {
        let at = |place, width| Address { place, width };
        let (area, bits) = tag_range(&at(Place::BitMemory(40), Width::Word), 16).unwrap();
        let limits = Limits(vec![(area, bits, External::Read)]);
        for (address, expected) in [
            (at(Place::BitMemory(41), Width::Byte), External::Read),
            (at(Place::BitMemory(38), Width::Dword), External::Read),
            (at(Place::BitMemory(41), Width::Bit(7)), External::Read),
            (at(Place::BitMemory(42), Width::Byte), External::Write),
            (at(Place::Input(40), Width::Word), External::Write),
        ] {
            assert_eq!(limits.of_tags(&address, address.width.bits().into()), expected, "{address:?}");
        }
    }
}
