//! DWARF variables of an object file: inputs, outputs, bit memory, data blocks and symbols, which a debugger shows and changes.
//!
//! A variable is at a fixed distance from the base of memory, whose address the runtime keeps in [`MEMORY_SYMBOL`].
//! Numbers are big-endian there, as `DW_AT_endianity` says for each type. A BOOL is one bit: in a structure a field
//! of one bit, alone a piece of one bit. In an array it is a field that is named by its index, because debuggers
//! cannot place elements one bit apart.

use gimli::write::{Address, AttributeValue, Expression, Unit, UnitEntryId};
use plcc_abi::image::AssertType;
use plcc_abi::names::{Dimension, NamedStruct, NamedType, TypeNumber};
use rustc_hash::FxHashMap;

#[cfg(doc)]
use plcc_abi::linked::MEMORY_SYMBOL;

/// What debuggers see of a program besides its code.
pub struct Variables<'a> {
    /// As in the image of the program.
    pub types: &'a [NamedType],
    pub list: Vec<Variable>,
}

/// A value in memory with its name.
pub struct Variable {
    pub name: String,
    /// From the base of memory.
    pub offset: u32,
    /// Of a BOOL.
    pub bit: u8,
    pub form: Form,
}

/// What a variable is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// So many bytes without declared components.
    Bytes(u32),
    Value(AssertType),
    Named(TypeNumber),
}

/// Fields of an array of BOOL; a longer one is shown as its bytes.
const FIELDS_MAX: u64 = 4096;

/// A type with its size; of a BOOL the size of the byte that contains it.
#[derive(Clone, Copy)]
struct Known {
    id: UnitEntryId,
    bytes: u64,
    is_bit: bool,
}

/// Adds the variables below the root of the unit. `base` is where the address of memory is.
pub fn add(unit: &mut Unit, variables: &Variables<'_>, base: Address) {
    let mut writer = Writer { unit, base, made: FxHashMap::default(), named: Vec::new() };
    for ty in variables.types {
        let known = writer.named_type(ty);
        writer.named.push(known);
    }
    for variable in &variables.list {
        let known = match variable.form {
            Form::Bytes(count) => Some(writer.bytes(u64::from(count))),
            Form::Value(ty) => writer.value(ty),
            Form::Named(number) => writer.named.get(number as usize).copied().flatten(),
        };
        if let Some(known) = known {
            writer.variable(variable, known);
        }
    }
}

struct Writer<'u> {
    unit: &'u mut Unit,
    base: Address,
    /// Types of values, by their names.
    made: FxHashMap<String, Known>,
    /// Types of the program in their order; `None`: nothing that can be shown.
    named: Vec<Option<Known>>,
}

impl Writer<'_> {
    fn variable(&mut self, variable: &Variable, ty: Known) {
        let mut place = Expression::new();
        place.op_addr(self.base);
        place.op_deref();
        place.op_plus_uconst(u64::from(variable.offset));
        if ty.is_bit {
            place.op_bit_piece(1, u64::from(variable.bit));
        }
        let id = self.unit.add(self.unit.root(), gimli::DW_TAG_variable);
        let entry = self.unit.get_mut(id);
        entry.set(gimli::DW_AT_name, AttributeValue::String(super::lines::text(&variable.name)));
        entry.set(gimli::DW_AT_type, AttributeValue::UnitRef(ty.id));
        entry.set(gimli::DW_AT_external, AttributeValue::Flag(true));
        entry.set(gimli::DW_AT_location, AttributeValue::Exprloc(place));
    }

    /// An elementary type. `None`: the value is elsewhere than at its address.
    fn value(&mut self, ty: AssertType) -> Option<Known> {
        use gimli::{DW_ATE_boolean, DW_ATE_float, DW_ATE_signed, DW_ATE_unsigned, DW_ATE_unsigned_char};
        let (name, encoding, bytes) = match ty {
            AssertType::Bool => ("BOOL", DW_ATE_boolean, 1),
            AssertType::Bits(8) => ("BYTE", DW_ATE_unsigned, 1),
            AssertType::Bits(16) => ("WORD", DW_ATE_unsigned, 2),
            AssertType::Bits(32) => ("DWORD", DW_ATE_unsigned, 4),
            AssertType::Bits(64) => ("LWORD", DW_ATE_unsigned, 8),
            AssertType::Signed(8) => ("SINT", DW_ATE_signed, 1),
            AssertType::Signed(16) => ("INT", DW_ATE_signed, 2),
            AssertType::Signed(32) => ("DINT", DW_ATE_signed, 4),
            AssertType::Signed(64) => ("LINT", DW_ATE_signed, 8),
            AssertType::Unsigned(8) => ("USINT", DW_ATE_unsigned, 1),
            AssertType::Unsigned(16) => ("UINT", DW_ATE_unsigned, 2),
            AssertType::Unsigned(32) => ("UDINT", DW_ATE_unsigned, 4),
            AssertType::Unsigned(64) => ("ULINT", DW_ATE_unsigned, 8),
            AssertType::Real => ("REAL", DW_ATE_float, 4),
            AssertType::Lreal => ("LREAL", DW_ATE_float, 8),
            AssertType::Char => ("CHAR", DW_ATE_unsigned_char, 1),
            // gdb reads no byte order of characters.
            AssertType::Wchar => ("WCHAR", DW_ATE_unsigned, 2),
            AssertType::S5Time => ("S5TIME", DW_ATE_unsigned, 2),
            AssertType::Time => ("TIME", DW_ATE_signed, 4),
            AssertType::Ltime => ("LTIME", DW_ATE_signed, 8),
            AssertType::Date => ("DATE", DW_ATE_unsigned, 2),
            AssertType::TimeOfDay => ("TIME_OF_DAY", DW_ATE_unsigned, 4),
            AssertType::Ltod => ("LTIME_OF_DAY", DW_ATE_unsigned, 8),
            AssertType::Ldt => ("LDT", DW_ATE_signed, 8),
            AssertType::DateAndTime => return Some(self.bytes(8)),
            AssertType::Bits(_) | AssertType::Signed(_) | AssertType::Unsigned(_) => return None,
            AssertType::Dtl | AssertType::Text | AssertType::WideText => return None,
        };
        if let Some(&known) = self.made.get(name) {
            return Some(known);
        }
        let id = self.unit.add(self.unit.root(), gimli::DW_TAG_base_type);
        let entry = self.unit.get_mut(id);
        entry.set(gimli::DW_AT_name, AttributeValue::String(name.into()));
        entry.set(gimli::DW_AT_encoding, AttributeValue::Encoding(encoding));
        entry.set(gimli::DW_AT_byte_size, AttributeValue::Udata(bytes));
        if bytes > 1 {
            entry.set(gimli::DW_AT_endianity, AttributeValue::Endianity(gimli::DW_END_big));
        }
        let known = Known { id, bytes, is_bit: ty == AssertType::Bool };
        self.made.insert(name.to_string(), known);
        Some(known)
    }

    fn bytes(&mut self, count: u64) -> Known {
        let name = format!("BYTE[{count}]");
        if let Some(&known) = self.made.get(&name) {
            return known;
        }
        let byte = self.value(AssertType::Bits(8)).expect("a BYTE has eight bits");
        let known = self.array(byte, &[(0, i64::try_from(count).unwrap_or(i64::MAX) - 1, 1)]);
        self.made.insert(name, known);
        known
    }

    /// Dimensions with their bounds, and the bytes from one element to the next.
    fn array(&mut self, element: Known, dimensions: &[(i64, i64, u64)]) -> Known {
        let id = self.unit.add(self.unit.root(), gimli::DW_TAG_array_type);
        self.unit.get_mut(id).set(gimli::DW_AT_type, AttributeValue::UnitRef(element.id));
        for &(low, high, distance) in dimensions {
            let range = self.unit.add(id, gimli::DW_TAG_subrange_type);
            let entry = self.unit.get_mut(range);
            entry.set(gimli::DW_AT_lower_bound, AttributeValue::Sdata(low));
            entry.set(gimli::DW_AT_upper_bound, AttributeValue::Sdata(high));
            entry.set(gimli::DW_AT_byte_stride, AttributeValue::Udata(distance));
        }
        let bytes = dimensions.first().map_or(0, |&(low, high, distance)| (high - low + 1).max(0) as u64 * distance);
        Known { id, bytes, is_bit: false }
    }

    fn named_type(&mut self, ty: &NamedType) -> Option<Known> {
        match ty {
            NamedType::Value(ty) => self.value(*ty),
            NamedType::Text { wide, length } => self.text(*wide, *length),
            NamedType::Array { dimensions, element } => {
                let element = self.named.get(*element as usize).copied().flatten()?;
                self.array_type(dimensions, element)
            }
            NamedType::Struct(structure) => Some(self.structure(structure)),
            NamedType::Other { .. } => None,
        }
    }

    fn array_type(&mut self, dimensions: &[Dimension], element: Known) -> Option<Known> {
        if dimensions.iter().any(|dimension| dimension.low > dimension.high) {
            return None;
        }
        let last = dimensions.last()?;
        if element.is_bit && last.distance % 8 != 0 {
            return Some(self.bits(dimensions));
        }
        let plain: Vec<(i64, i64, u64)> = dimensions
            .iter()
            .map(|dimension| (dimension.low.into(), dimension.high.into(), u64::from(dimension.distance / 8)))
            .collect();
        Some(self.array(element, &plain))
    }

    /// An array of BOOL: a field for each element, `_0`, `_m1` for -1, `_1_2` with two indices.
    fn bits(&mut self, dimensions: &[Dimension]) -> Known {
        let length = |dimension: &Dimension| (i64::from(dimension.high) - i64::from(dimension.low) + 1) as u64;
        let count = dimensions.iter().fold(1, |count: u64, dimension| count.saturating_mul(length(dimension)));
        let last = dimensions.iter().map(|one| (length(one) - 1) * u64::from(one.distance)).sum::<u64>();
        let bytes = last / 8 + 1;
        if count > FIELDS_MAX {
            return self.bytes(bytes);
        }
        let bool_type = self.value(AssertType::Bool).expect("a BOOL is a value");
        let id = self.unit.add(self.unit.root(), gimli::DW_TAG_structure_type);
        self.unit.get_mut(id).set(gimli::DW_AT_byte_size, AttributeValue::Udata(bytes));
        for number in 0..count {
            let (mut rest, mut at, mut name) = (number, 0, String::new());
            // The last index runs fastest.
            for dimension in dimensions.iter().rev() {
                let index = rest % length(dimension);
                rest /= length(dimension);
                at += index * u64::from(dimension.distance);
                let index = i64::from(dimension.low) + index as i64;
                let sign = if index < 0 { "m" } else { "" };
                name = format!("_{sign}{}{name}", index.unsigned_abs());
            }
            self.member(id, &name, at, bool_type);
        }
        Known { id, bytes, is_bit: false }
    }

    /// STRING and WSTRING: both lengths, and the characters.
    fn text(&mut self, wide: bool, length: u16) -> Option<Known> {
        let name = format!("{}[{length}]", if wide { "WSTRING" } else { "STRING" });
        if let Some(&known) = self.made.get(&name) {
            return Some(known);
        }
        let (number, character) = match wide {
            false => (self.value(AssertType::Unsigned(8))?, self.value(AssertType::Char)?),
            true => (self.value(AssertType::Unsigned(16))?, self.value(AssertType::Wchar)?),
        };
        let id = self.unit.add(self.unit.root(), gimli::DW_TAG_structure_type);
        let bytes = 2 * number.bytes + u64::from(length) * character.bytes;
        let entry = self.unit.get_mut(id);
        entry.set(gimli::DW_AT_name, AttributeValue::String(name.clone().into_bytes()));
        entry.set(gimli::DW_AT_byte_size, AttributeValue::Udata(bytes));
        self.member(id, "max", 0, number);
        self.member(id, "length", number.bytes * 8, number);
        if length > 0 {
            let text = self.array(character, &[(0, i64::from(length) - 1, character.bytes)]);
            self.member(id, "text", 2 * number.bytes * 8, text);
        }
        let known = Known { id, bytes, is_bit: false };
        self.made.insert(name, known);
        Some(known)
    }

    fn structure(&mut self, structure: &NamedStruct) -> Known {
        let id = self.unit.add(self.unit.root(), gimli::DW_TAG_structure_type);
        let mut bytes = 0;
        for member in &structure.members {
            let Some(ty) = self.named.get(member.ty as usize).copied().flatten() else { continue };
            bytes = bytes.max(u64::from(member.byte) + ty.bytes);
            self.member(id, &member.name, u64::from(member.byte) * 8 + u64::from(member.bit), ty);
        }
        let entry = self.unit.get_mut(id);
        if !structure.name.is_empty() {
            entry.set(gimli::DW_AT_name, AttributeValue::String(super::lines::text(&structure.name)));
        }
        entry.set(gimli::DW_AT_byte_size, AttributeValue::Udata(bytes));
        Known { id, bytes, is_bit: false }
    }

    /// `at`: bits from the beginning of the structure.
    fn member(&mut self, structure: UnitEntryId, name: &str, at: u64, ty: Known) {
        let id = self.unit.add(structure, gimli::DW_TAG_member);
        let entry = self.unit.get_mut(id);
        entry.set(gimli::DW_AT_name, AttributeValue::String(super::lines::text(name)));
        entry.set(gimli::DW_AT_type, AttributeValue::UnitRef(ty.id));
        match ty.is_bit {
            false => entry.set(gimli::DW_AT_data_member_location, AttributeValue::Udata(at / 8)),
            true => {
                entry.set(gimli::DW_AT_bit_size, AttributeValue::Udata(1));
                entry.set(gimli::DW_AT_data_bit_offset, AttributeValue::Udata(at));
            }
        }
    }
}
