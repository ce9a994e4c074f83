//! Names of operands, names that nothing uses, and addresses that have none.

use std::collections::{BTreeMap, HashMap};

use plcc_abi::image::BlockKind;
use plcc_model::types::{ArrayType, DataType, Member};
use plcc_model::{Program, layout};
use serde::Serialize;

use crate::collect::Found;
use crate::operand::{Area, Operand};

/// A symbol that no statement uses.
#[derive(Clone, Debug, Serialize)]
pub struct UnusedSymbol {
    pub name: String,
    pub address: String,
}

/// An address that statements use and that has no symbol.
#[derive(Clone, Debug, Serialize)]
pub struct AddressWithoutSymbol {
    pub address: String,
    /// Number of its uses.
    pub uses: usize,
}

/// The names of a program's operands.
pub(crate) struct Names<'a> {
    program: &'a Program,
    symbols: HashMap<Operand, &'a str>,
}

impl<'a> Names<'a> {
    pub fn new(program: &'a Program) -> Names<'a> {
        let mut symbols = HashMap::new();
        for symbol in &program.symbols {
            if let Some(operand) = operand_of(&symbol.address, symbol.ty.as_ref()) {
                symbols.entry(operand).or_insert(symbol.name.as_str());
            }
        }
        Names { program, symbols }
    }

    /// The name of an operand, empty if it has none.
    pub fn of(&self, operand: Operand) -> String {
        if let Some(name) = self.symbols.get(&operand) {
            return (*name).to_string();
        }
        match operand {
            Operand::Block(key) if key.kind == BlockKind::Db => {
                self.program.db(key.number).map(|db| db.name.clone()).unwrap_or_default()
            }
            Operand::Block(key) => self.program.block(key).map(|block| block.name.clone()).unwrap_or_default(),
            Operand::Memory { area: Area::Db(number), start, bits } => {
                let Some(db) = self.program.db(number) else { return String::new() };
                let name = if db.name.is_empty() { format!("DB{number}") } else { db.name.clone() };
                match path(&db.members, start, bits) {
                    Some(path) => format!("{name}{path}"),
                    None if start == 0 && holds_all(&db.members, bits) => name,
                    None => String::new(),
                }
            }
            Operand::Memory { .. } | Operand::Timer(_) | Operand::Counter(_) | Operand::HighSpeedCounter(_) => {
                String::new()
            }
        }
    }
}

/// The operand at the address of a symbol, with the size of its type.
fn operand_of(address: &str, ty: Option<&DataType>) -> Option<Operand> {
    let operand = Operand::parse(address)?;
    Some(match ty {
        Some(ty) => operand.with_bits(layout::used_bits(ty)),
        None => operand,
    })
}

/// Whether the bits from 0 on are all of a data block.
fn holds_all(members: &[Member], bits: u32) -> bool {
    let end = |member: &Member| member.byte * 8 + u32::from(member.bit) + layout::used_bits(&member.ty);
    !members.is_empty() && members.iter().all(|member| end(member) <= bits)
}

/// `.member[3].other` of what begins at bit `start` and has so many bits.
fn path(members: &[Member], start: u32, bits: u32) -> Option<String> {
    let begin = |member: &Member| member.byte * 8 + u32::from(member.bit);
    let inside = |member: &&Member| {
        let begin = begin(member);
        begin <= start && start < begin.saturating_add(layout::used_bits(&member.ty).max(1))
    };
    let member = members.iter().find(inside)?;
    Some(format!(".{}{}", member.name, path_in(&member.ty, start - begin(member), bits)?))
}

fn path_in(ty: &DataType, start: u32, bits: u32) -> Option<String> {
    if start == 0 && layout::used_bits(ty) == bits {
        return Some(String::new());
    }
    match ty {
        DataType::Struct(structure) => path(&structure.members, start, bits),
        DataType::Array(array) if bits <= layout::used_bits(ty).saturating_sub(start) => {
            let count = layout::element_count(&array.bounds);
            let begin = |index: u64| {
                let (byte, bit) = layout::element_place(array, index);
                byte * 8 + u32::from(bit)
            };
            // The last element that begins at or before `start`.
            let (mut low, mut high) = (0, count);
            while low < high {
                let middle = low + (high - low) / 2;
                if begin(middle) <= start { low = middle + 1 } else { high = middle }
            }
            let index = low.checked_sub(1)?;
            let (indices, bits) = indices(array, index, bits);
            let rest = path_in(&array.element, start - begin(index), bits)?;
            Some(format!("[{indices}]{rest}"))
        }
        _ => None,
    }
}

/// The indices of element number `index`, and the bits that are used in one element, if `bits` are used from there on. An index over
/// whose distance the bits reach is computed, any one of its dimension: `*`.
fn indices(array: &ArrayType, mut index: u64, mut bits: u32) -> (String, u32) {
    let mut texts = Vec::new();
    let mut after = layout::element_count(&array.bounds);
    for (dimension, &(low, high)) in array.bounds.iter().enumerate() {
        let length = (i64::from(high) - i64::from(low) + 1).max(1) as u64;
        after /= length;
        let (number, distance) = (index / after.max(1), layout::distance(array, dimension));
        index %= after.max(1);
        let reach = distance.saturating_mul(u32::try_from(length - 1).unwrap_or(u32::MAX));
        if number == 0 && length > 1 && bits > distance && bits > reach {
            bits -= reach;
            texts.push("*".to_string());
        } else {
            texts.push((i64::from(low) + number as i64).to_string());
        }
    }
    (texts.join(","), bits)
}

pub(crate) fn unused(program: &Program, found: &[Found]) -> Vec<UnusedSymbol> {
    let mut used: BTreeMap<Operand, usize> = BTreeMap::new();
    for one in found {
        *used.entry(one.operand).or_default() += 1;
        if let Operand::Memory { area: Area::Db(number), .. } = one.operand {
            *used.entry(Operand::db(number)).or_default() += 1;
        }
    }
    let is_used = |address: &str, ty: Option<&DataType>| {
        match operand_of(address, ty) {
        None => true,
        // A part of a structure is a use of it.
        Some(Operand::Memory { area, start, bits }) if bits > 64 => used
            .range(Operand::Memory { area, start, bits: 0 }..)
            .take_while(|(other, _)| matches!(other, Operand::Memory { area: same, start: at, .. } if *same == area && *at < start + bits))
            .next()
            .is_some(),
        Some(operand) => used.contains_key(&operand),
    }
    };
    let unused = program.symbols.iter().filter(|symbol| !is_used(&symbol.address, symbol.ty.as_ref()));
    unused.map(|symbol| UnusedSymbol { name: symbol.name.clone(), address: symbol.address.clone() }).collect()
}

pub(crate) fn without_symbol(names: &Names, found: &[Found]) -> Vec<AddressWithoutSymbol> {
    let mut uses: BTreeMap<Operand, usize> = BTreeMap::new();
    for one in found.iter().filter(|one| !matches!(one.operand, Operand::Block(_))) {
        *uses.entry(one.operand).or_default() += 1;
    }
    let unnamed = uses.into_iter().filter(|(operand, _)| names.of(*operand).is_empty());
    unnamed.map(|(operand, uses)| AddressWithoutSymbol { address: operand.to_string(), uses }).collect()
}
