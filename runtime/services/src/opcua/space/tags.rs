//! Which names and addresses a program has.

use std::ops::Range;

use plcc_abi::image::{AssertType, DbEntry, SymbolEntry};
use plcc_abi::names::{Dimension, External, NamedMember, TypeNumber};
use plcc_runtime::address::{self, Address, Place, Width};
use plcc_runtime::names;
use plcc_runtime::typed::ValueType;

use super::super::values::bits;
use super::Space;
use super::node::Folder;
use super::thing::{Form, Thing, Ty, quoted};

impl Space {
    /// The node of a data block; `None`: clients may reach nothing of it.
    pub(super) fn block(&self, db: &DbEntry) -> Option<Thing> {
        let ty = db.ty?;
        if let Form::Struct(structure) = self.form(ty)
            && !structure.members.is_empty()
            && structure.members.iter().all(|member| member.external == External::Hidden)
        {
            return None;
        }
        let absolute = format!("DB{}", db.number);
        let symbol =
            || self.image.symbols.iter().find(|symbol| symbol.address == absolute).map(|symbol| symbol.name.clone());
        let name = Some(db.name.clone()).filter(|name| !name.is_empty()).or_else(symbol).unwrap_or(absolute);
        Some(Thing {
            id: quoted(&name),
            name,
            parent: Folder::DataBlocks.name().to_string(),
            place: Place::Db(db.number, 0),
            bit: 0,
            ty: Ty::Declared(ty),
            read_only: db.read_only,
        })
    }

    /// Finds the tags with which clients may not do everything.
    pub(super) fn find_limits(&mut self) {
        let symbols = self.image.symbols.iter().filter(|symbol| symbol.external != External::Write);
        let limits = symbols.filter_map(|symbol| {
            let (_, thing) = self.named_tag(symbol)?;
            let bits = match thing.ty {
                Ty::Plain(ty) => u64::from(bits(ty)),
                Ty::Declared(ty) => self.bits_of(ty),
            };
            let (folder, bits) = place_of(thing.place, thing.bit, bits)?;
            Some((folder, bits, symbol.external))
        });
        self.limits = limits.collect();
    }

    /// What clients may do with an address: no more than with any tag there.
    pub(super) fn limit(&self, address: Address) -> External {
        let place = place_of(address.place, bit_of(address), address.width.bits().into());
        let Some((folder, bits)) = place else { return External::Write };
        let is_there = |range: &Range<u64>| range.start < bits.end && bits.start < range.end;
        let there = self.limits.iter().filter(|(own, range, _)| *own == folder && is_there(range));
        there.map(|(.., external)| *external).min().unwrap_or_default()
    }

    /// From the first bit of a value to its last.
    fn bits_of(&self, ty: TypeNumber) -> u64 {
        match self.form(ty) {
            Form::Value(ty) => bits(ty).into(),
            Form::Array(dimensions, element) => {
                let steps = |dimension: &Dimension| i64::from(dimension.high).abs_diff(dimension.low.into());
                let last = dimensions.iter().map(|dimension| steps(dimension) * u64::from(dimension.distance));
                last.sum::<u64>() + self.bits_of(element)
            }
            Form::Struct(structure) => {
                let end =
                    |member: &NamedMember| 8 * u64::from(member.byte) + u64::from(member.bit) + self.bits_of(member.ty);
                structure.members.iter().map(end).max().unwrap_or(0)
            }
            Form::Other => 0,
        }
    }

    /// The tag of a symbol, unless it names a block.
    fn named_tag(&self, symbol: &SymbolEntry) -> Option<(Folder, Thing)> {
        let address = address::parse_for(&symbol.address, &self.image)?;
        let named = names::find(&symbol.name, &self.image).ok().and_then(|named| named.ty);
        let ty = match (symbol.ty, named) {
            (Some(ty), _) if !matches!(self.form(ty), Form::Value(_) | Form::Other) => Ty::Declared(ty),
            (_, named) => Ty::Plain(named.unwrap_or(plain(address.width))),
        };
        let (folder, thing) = self.tag(quoted(&symbol.name), &symbol.name, address, ty);
        Some((folder, Thing { read_only: symbol.external != External::Write, ..thing }))
    }

    /// An address as a tag; `None`: clients may not access it.
    pub(super) fn address_tag(&self, text: &str, address: Address, external: External) -> Option<(Folder, Thing)> {
        if external == External::Hidden {
            return None;
        }
        let (folder, thing) = self.tag(format!("%{text}"), text, address, Ty::Plain(plain(address.width)));
        Some((folder, Thing { read_only: external != External::Write, ..thing }))
    }

    pub(super) fn find_tags(&self) -> Vec<(Folder, Thing)> {
        let named = self.image.symbols.iter().filter(|symbol| symbol.external != External::Hidden);
        let mut tags: Vec<(Folder, Thing)> = named.filter_map(|symbol| self.named_tag(symbol)).collect();
        for (name, named) in names::used(&self.image) {
            let is_address = address::parse_for(&name, &self.image) == Some(named.address);
            // A timer or counter of an S7-300/400 is its value. Data blocks have a folder of their own, but V memory of an S7-200 has not.
            let is_elsewhere = match self.image.s7200 {
                Some(_) => false,
                None => matches!(named.address.place, Place::Db(..) | Place::TimerValue(_) | Place::CounterValue(_)),
            };
            if is_address && !is_elsewhere {
                tags.extend(self.address_tag(&name, named.address, self.limit(named.address)));
            }
        }
        tags
    }

    pub(super) fn tag(&self, id: String, name: &str, address: Address, ty: Ty) -> (Folder, Thing) {
        // Clients want to know how long a timer runs; that it runs, they see by that.
        let (place, ty) = match address.place {
            Place::Timer(number) | Place::TimerValue(number) => {
                (Place::TimerValue(number), Ty::Plain(ValueType::of(AssertType::S5Time)))
            }
            Place::Counter(number) | Place::CounterValue(number) => {
                (Place::CounterValue(number), Ty::Plain(ValueType::of(AssertType::Signed(16))))
            }
            place => (place, ty),
        };
        let bit = bit_of(address);
        let folder = Folder::of(place);
        let parent = folder.name().to_string();
        (folder, Thing { id, name: name.to_string(), parent, place, bit, ty, read_only: false })
    }
}

fn bit_of(address: Address) -> u8 {
    if let Width::Bit(bit) = address.width { bit } else { 0 }
}

/// The folder of a place, and the bits that it has there. Direct access to modules is access to the process image.
fn place_of(place: Place, bit: u8, bits: u64) -> Option<(Folder, Range<u64>)> {
    let (byte, bits) = match place {
        Place::Input(byte) | Place::PeripheralInput(byte) => (byte, bits),
        Place::Output(byte) | Place::PeripheralOutput(byte) | Place::BitMemory(byte) => (byte, bits),
        // As many as a byte, whatever their values have.
        Place::Timer(number) | Place::TimerValue(number) => (number, 8),
        Place::Counter(number) | Place::CounterValue(number) => (number, 8),
        Place::Db(..) | Place::S7200(..) => return None,
    };
    let start = 8 * u64::from(byte) + u64::from(bit);
    Some((Folder::of(place), start..start + bits))
}

/// Bits of a width.
fn plain(width: Width) -> ValueType {
    ValueType::of(match width {
        Width::Bit(_) => AssertType::Bool,
        width => AssertType::Bits(width.bits() as u8),
    })
}
