//! What names mean and which names addresses have, from the symbol tables and the layout of data blocks.

use std::collections::HashMap;

use plcc_diag::Span;
use plcc_model::layout;
use plcc_model::types::{ArrayType, DataType, Member};
use plcc_model::{Actual, Body, DataBlock, Program, StlStatementKind};
use plcc_syntax::Elementary;
use plcc_syntax::ast::{BlockName, BlockPrefix, Bound, PathPart, Width};
use plcc_syntax::symbols::{S7200Symbol, Symbol, SymbolTable, SymbolTarget};

use crate::to_stl::types::elementary;

/// Symbols by name and by address, and the data blocks of the program.
pub struct Names<'p> {
    symbols: HashMap<String, &'p Symbol>,
    /// Names of each address, by its text.
    named: HashMap<String, Vec<&'p Symbol>>,
    pub(super) s7200: Vec<&'p S7200Symbol>,
    program: &'p Program,
    /// Actual parameters of which a call makes a pointer with a type.
    pointers: Vec<Span>,
}

/// A symbol of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    pub name: String,
    pub target: SymbolTarget,
    /// Its declared type, if it is elementary.
    pub ty: Option<Elementary>,
}

/// A place in a data block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Component {
    pub db: u16,
    pub width: Width,
    pub byte: u32,
    pub bit: u8,
    pub ty: Elementary,
}

impl<'p> Names<'p> {
    pub fn new(tables: &'p [SymbolTable], program: &'p Program) -> Names<'p> {
        let mut names = Names {
            symbols: HashMap::new(),
            named: HashMap::new(),
            s7200: tables.iter().flat_map(|table| &table.s7200).collect(),
            program,
            pointers: pointers(program),
        };
        for symbol in tables.iter().flat_map(|table| &table.symbols) {
            names.symbols.entry(symbol.name.to_lowercase()).or_insert(symbol);
            let known = names.named.entry(key(symbol.target)).or_default();
            if !known.iter().any(|other| other.name.eq_ignore_ascii_case(&symbol.name)) {
                known.push(symbol);
            }
        }
        names
    }

    /// What a name of the symbol tables means.
    pub(super) fn target(&self, name: &str) -> Option<Found> {
        self.symbols.get(&name.to_lowercase()).map(|symbol| found(symbol))
    }

    /// The symbols of an address; several are one too many.
    pub(super) fn symbols_of(&self, target: SymbolTarget) -> Vec<Found> {
        let named = self.named.get(&key(target));
        named.into_iter().flatten().map(|symbol| found(symbol)).collect()
    }

    /// Whether a name is that of a block in the sources.
    pub(super) fn is_own_block(&self, name: &str) -> bool {
        let same = |own: &str| own.eq_ignore_ascii_case(name);
        self.program.blocks.iter().any(|block| !block.library && same(&block.name))
            || self.program.dbs.iter().any(|db| same(&db.name))
    }

    /// Whether a call makes a pointer of the operand there.
    pub(super) fn is_pointer(&self, span: Span) -> bool {
        self.pointers.iter().any(|other| other.file == span.file && other.start < span.end && span.start < other.end)
    }

    /// The number of a data block that the sources or a symbol table give it.
    pub(super) fn db_number(&self, name: &BlockName) -> Option<u16> {
        match name {
            BlockName::Numbered { prefix: BlockPrefix::Db, number, .. } => u16::try_from(*number).ok(),
            BlockName::Numbered { .. } => None,
            BlockName::Symbol { name, .. } => match self.target(name)?.target {
                SymbolTarget::Block { prefix: BlockPrefix::Db, number } => u16::try_from(number).ok(),
                SymbolTarget::Block { .. } | SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => None,
            },
        }
    }

    /// A data block whose components have addresses.
    fn data(&self, number: u16) -> Option<&'p DataBlock> {
        self.program.db(number).filter(|db| !db.optimized)
    }

    /// The elementary component at the end of a path with known indices; `None`: it is not elementary, or has no address.
    pub(super) fn component(&self, db: u16, parts: &[PathPart]) -> Option<Component> {
        let data = self.data(db)?;
        let (PathPart::Member { name, .. }, rest) = parts.split_first()? else { return None };
        let member = data.members.iter().find(|member| member.name.eq_ignore_ascii_case(name))?;
        let (ty, byte, bit) = inside(&member.ty, rest)?;
        let ty = *ty;
        let place = 8 * member.byte + u32::from(member.bit) + 8 * byte + u32::from(bit);
        let width = layout::width(ty);
        (width != Width::Lword).then_some(Component { db, width, byte: place / 8, bit: (place % 8) as u8, ty })
    }

    /// The path to the elementary component at a place, `b[2].x`, with its type.
    pub(super) fn path(&self, db: u16, width: Width, byte: u32, bit: u8) -> Option<(String, Elementary)> {
        let data = self.data(db)?;
        path_in(&data.members, width, 8 * byte + u32::from(bit))
    }
}

fn found(symbol: &Symbol) -> Found {
    Found { name: symbol.name.clone(), target: symbol.target, ty: elementary(&symbol.ty) }
}

fn key(target: SymbolTarget) -> String {
    format!("{target:?}")
}

/// Type and place of what a path leads to from a value of type `ty`.
fn inside<'t>(ty: &'t DataType, parts: &[PathPart]) -> Option<(&'t Elementary, u32, u8)> {
    let (of, byte, bit, rest) = match (ty, parts.split_first()) {
        (DataType::Elementary(ty), None) => return Some((ty, 0, 0)),
        (DataType::Struct(structure), Some((PathPart::Member { name, .. }, rest))) if structure.refers_to.is_none() => {
            let member = structure.members.iter().find(|member| member.name.eq_ignore_ascii_case(name))?;
            (&member.ty, member.byte, member.bit, rest)
        }
        (DataType::Array(array), Some((PathPart::Index { values, .. }, rest))) => {
            let indices: Option<Vec<i64>> = values
                .iter()
                .map(|value| match value {
                    Bound::Number(number, _) => Some(*number),
                    Bound::Name(..) | Bound::Expr(_) | Bound::Path(_) => None,
                })
                .collect();
            let indices = indices.filter(|indices| indices.len() == array.bounds.len())?;
            let (byte, bit) = layout::element_place(array, layout::element_index(array, &indices).ok()?);
            (&array.element, byte, bit, rest)
        }
        _ => return None,
    };
    let (ty, more, more_bit) = inside(of, rest)?;
    let place = 8 * (byte + more) + u32::from(bit) + u32::from(more_bit);
    Some((ty, place / 8, (place % 8) as u8))
}

/// The component at bit `place`.
fn path_in(members: &[Member], width: Width, place: u32) -> Option<(String, Elementary)> {
    let member = members.iter().rfind(|member| {
        let start = 8 * member.byte + u32::from(member.bit);
        start <= place && place < start + layout::used_bits(&member.ty).max(1)
    })?;
    let name = crate::names::declared(&member.name);
    let (rest, ty) = path_to(&member.ty, width, place - 8 * member.byte - u32::from(member.bit))?;
    Some((format!("{name}{rest}"), ty))
}

fn path_to(ty: &DataType, width: Width, place: u32) -> Option<(String, Elementary)> {
    match ty {
        DataType::Elementary(ty) => (place == 0 && layout::width(*ty) == width).then(|| (String::new(), *ty)),
        DataType::Struct(structure) if structure.refers_to.is_none() => {
            let (path, ty) = path_in(&structure.members, width, place)?;
            Some((format!(".{path}"), ty))
        }
        DataType::Array(array) => {
            let number = element_at(array, place)?;
            let (byte, bit) = layout::element_place(array, number);
            let (rest, ty) = path_to(&array.element, width, place.checked_sub(8 * byte + u32::from(bit))?)?;
            Some((format!("[{}]{rest}", indices(array, number)), ty))
        }
        DataType::Struct(_)
        | DataType::DateAndTime
        | DataType::String(_)
        | DataType::WideString(_)
        | DataType::Parameter(_)
        | DataType::OpenArray(_)
        | DataType::Void => None,
    }
}

/// The last element that begins at or before bit `place`.
fn element_at(array: &ArrayType, place: u32) -> Option<u64> {
    let start = |number: u64| {
        let (byte, bit) = layout::element_place(array, number);
        8 * u64::from(byte) + u64::from(bit)
    };
    let (mut low, mut high) = (0, layout::element_count(&array.bounds));
    if high == 0 {
        return None;
    }
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if start(middle) <= u64::from(place) { low = middle } else { high = middle }
    }
    Some(low)
}

/// `2,-1`: the indices of element number `number`.
fn indices(array: &ArrayType, number: u64) -> String {
    let mut rest = number;
    let mut list: Vec<String> = Vec::new();
    for &(low, high) in array.bounds.iter().rev() {
        let count = (i64::from(high) - i64::from(low) + 1).max(1) as u64;
        list.insert(0, (i64::from(low) + (rest % count) as i64).to_string());
        rest /= count;
    }
    list.join(",")
}

/// Actual parameters of calls in STL that are passed as pointers, which have the type of what they point at.
fn pointers(program: &Program) -> Vec<Span> {
    let mut spans = Vec::new();
    for block in program.blocks.iter().filter(|block| !block.library) {
        let Body::Stl(statements) = &block.body else { continue };
        for statement in statements {
            let StlStatementKind::Call(call) = &statement.kind else { continue };
            let typed = call.arguments.iter().filter(|argument| match argument.actual {
                Actual::PointerBytes(_) | Actual::PointerTo { .. } | Actual::PointerCopy(_) | Actual::Variant(..) => {
                    true
                }
                Actual::Place(_) | Actual::Number(_) | Actual::Const(_) => false,
            });
            spans.extend(typed.map(|argument| argument.span));
        }
    }
    spans
}
