//! Where components are: the layout rules of DBs, UDTs, structures, arrays and local data.
//!
//! Source: STL reference, layout rules. BOOLs fill bytes from bit 0, BYTE and CHAR take the next byte, everything else begins at
//! an even byte; arrays and structures are rounded up to even. Each row of an array of BOOL begins at a new byte.

use crate::types::{ArrayType, DataType, Elementary, ParameterType, StructType};
use plcc_abi::names::{compound_number, structure_number};
use plcc_syntax::ast::Width;

/// No DB, local data or target of a pointer can have more bytes.
pub const BYTES_MAX: u64 = 65_536;

/// Assigns addresses to components in sequence.
#[derive(Clone, Debug, Default)]
pub struct Placer {
    next: u32,
    /// Byte and next free bit after a BOOL.
    bits: Option<(u32, u8)>,
}

impl Placer {
    /// The address of the next component, which is of type `ty`.
    pub fn place(&mut self, ty: &DataType) -> (u32, u8) {
        if *ty == DataType::Elementary(Elementary::Bool) {
            let (byte, bit) = match self.bits {
                Some((byte, bit)) if bit < 8 => (byte, bit),
                _ => {
                    let byte = self.next;
                    self.next = byte.saturating_add(1);
                    (byte, 0)
                }
            };
            self.bits = Some((byte, bit + 1));
            return (byte, bit);
        }
        self.bits = None;
        if !matches!(ty, DataType::Elementary(ty) if ty.bits() == 8) {
            self.align();
        }
        let byte = self.next;
        self.next = self.next.saturating_add(bytes(ty));
        (byte, 0)
    }

    /// Goes to the next even byte: between sections and at the end.
    pub fn align(&mut self) {
        self.bits = None;
        self.next = self.next.saturating_add(self.next & 1);
    }

    /// Bytes so far, rounded up to even.
    pub fn size(mut self) -> u32 {
        self.align();
        self.next
    }

    /// Reserves the first `bytes` bytes.
    pub fn reserve(&mut self, bytes: u32) {
        self.bits = None;
        self.next = self.next.max(bytes);
    }
}

/// Bytes that a variable of `ty` needs; a BOOL needs 1.
pub fn bytes(ty: &DataType) -> u32 {
    match ty {
        DataType::Elementary(elementary) => elementary.bits().div_ceil(8),
        DataType::DateAndTime => 8,
        DataType::String(length) => even(u32::from(*length) + 2),
        DataType::WideString(length) => 2 * u32::from(*length) + 4,
        DataType::Array(array) => array.bytes,
        DataType::Struct(structure) => structure.bytes,
        DataType::Parameter(parameter) => parameter_bytes(*parameter),
        DataType::OpenArray(array) => 6 + 8 * u32::from(array.dimensions),
        DataType::Void => 0,
    }
}

/// Bits from the beginning of a variable to the end of its last component, without padding. An odd number of bytes, which an
/// array or structure rounds up, counts as it is.
pub fn used_bits(ty: &DataType) -> u32 {
    let after = |byte: u32, bit: u8, ty: &DataType| 8 * byte + u32::from(bit) + used_bits(ty);
    match ty {
        DataType::Elementary(elementary) => elementary.bits(),
        DataType::Array(array) => match element_count(&array.bounds) {
            0 => 0,
            count => {
                let (byte, bit) = element_place(array, count - 1);
                after(byte, bit, &array.element)
            }
        },
        DataType::Struct(structure) => {
            structure.members.iter().map(|member| after(member.byte, member.bit, &member.ty)).max().unwrap_or(0)
        }
        _ => 8 * bytes(ty),
    }
}

/// Bytes of the ANY at the beginning of a VARIANT.
pub const ANY_BYTES: u32 = 10;

/// Where a VARIANT has the number of elements of the array that it points at, a double word; 0: not an array.
pub const VARIANT_ELEMENTS: u32 = ANY_BYTES;

/// Where a VARIANT has the type of the data that it points at, or of the elements of the array, a double word: see [`type_number`].
pub const VARIANT_TYPE: u32 = ANY_BYTES + 4;

/// Type codes of an ANY. Source: STL reference, table of type codes.
pub const fn type_code(ty: Elementary) -> u8 {
    match ty {
        Elementary::Bool => 0x01,
        Elementary::Byte => 0x02,
        Elementary::Char => 0x03,
        Elementary::Word => 0x04,
        Elementary::Int => 0x05,
        Elementary::Dword => 0x06,
        Elementary::Dint => 0x07,
        Elementary::Real => 0x08,
        Elementary::Date => 0x09,
        Elementary::TimeOfDay => 0x0A,
        Elementary::Time => 0x0B,
        Elementary::S5Time => 0x0C,
        Elementary::Wchar => 0x2C,
        Elementary::Lword => 0x2D,
        Elementary::Sint => 0x30,
        Elementary::Usint => 0x31,
        Elementary::Uint => 0x32,
        Elementary::Udint => 0x33,
        Elementary::Lreal => 0x34,
        Elementary::Lint => 0x35,
        Elementary::Ulint => 0x36,
        Elementary::Ltime => 0x37,
        Elementary::Ltod => 0x38,
        Elementary::Ldt => 0x39,
    }
}

/// The number by which a VARIANT distinguishes types: for elementary types and texts their code in an ANY, for structures and function
/// blocks one derived from their name, or without a name from their components. The length of a text does not count.
pub fn type_number(ty: &DataType) -> u32 {
    match ty {
        DataType::Elementary(ty) => u32::from(type_code(*ty)),
        DataType::DateAndTime => 0x0E,
        DataType::String(_) => 0x13,
        DataType::WideString(_) => 0x14,
        DataType::Array(array) => compound_number(0x8000, &[type_number(&array.element)]),
        DataType::Struct(structure) if structure.name.is_empty() => {
            let members: Vec<u32> = structure.members.iter().map(|member| type_number(&member.ty)).collect();
            compound_number(0x8001, &members)
        }
        DataType::Struct(structure) => structure_number(&structure.name),
        DataType::OpenArray(_) | DataType::Parameter(_) | DataType::Void => 0,
    }
}

/// Bytes of a parameter type in an instance or in the structure of parameters.
pub const fn parameter_bytes(ty: ParameterType) -> u32 {
    match ty {
        ParameterType::Timer
        | ParameterType::Counter
        | ParameterType::BlockFb
        | ParameterType::BlockFc
        | ParameterType::BlockDb
        | ParameterType::BlockSdb => 2,
        ParameterType::Pointer => 6,
        ParameterType::Any => ANY_BYTES,
        ParameterType::Variant => ANY_BYTES + 8,
    }
}

/// Width of an access to an elementary variable.
pub const fn width(ty: Elementary) -> Width {
    match ty.bits() {
        1 => Width::Bit,
        8 => Width::Byte,
        16 => Width::Word,
        32 => Width::Dword,
        _ => Width::Lword,
    }
}

const fn even(bytes: u32) -> u32 {
    bytes + (bytes & 1)
}

/// The layout of an array's elements: elements in a row and bytes of a row, or `None` for one element after the other.
fn rows(array_bounds: &[(i32, i32)], element: &DataType) -> Option<(u64, u64)> {
    let last = array_bounds.last().map_or(1, |&(low, high)| (i64::from(high) - i64::from(low) + 1).max(0) as u64);
    match element {
        DataType::Elementary(Elementary::Bool) => Some((last, last.div_ceil(8))),
        _ => None,
    }
}

/// Distance between elements that do not share bytes.
pub fn stride(element: &DataType) -> u32 {
    match element {
        DataType::Elementary(ty) if ty.bits() == 8 => 1,
        _ => even(bytes(element)),
    }
}

/// Number of elements.
pub fn element_count(bounds: &[(i32, i32)]) -> u64 {
    bounds
        .iter()
        .map(|&(low, high)| (i64::from(high) - i64::from(low) + 1).max(0) as u64)
        .fold(1u64, u64::saturating_mul)
}

/// Bytes of an array, rounded up to even; it may exceed [`BYTES_MAX`].
pub fn array_bytes(bounds: &[(i32, i32)], element: &DataType) -> u64 {
    let count = element_count(bounds);
    let total = match rows(bounds, element) {
        Some((in_row, row_bytes)) => (count / in_row.max(1)).saturating_mul(row_bytes),
        None => count.saturating_mul(u64::from(stride(element))),
    };
    total.saturating_add(total & 1)
}

/// Address of element number `index` (0-based, last dimension fastest) relative to the start of the array.
pub fn element_place(array: &ArrayType, index: u64) -> (u32, u8) {
    match rows(&array.bounds, &array.element) {
        Some((in_row, row_bytes)) => {
            let (row, column) = (index / in_row.max(1), index % in_row.max(1));
            ((row * row_bytes + column / 8) as u32, (column % 8) as u8)
        }
        None => ((index * u64::from(stride(&array.element))) as u32, 0),
    }
}

/// Distance of adjacent elements in a dimension, in bits.
pub fn distance(array: &ArrayType, dimension: usize) -> u32 {
    let after = array.bounds.get(dimension + 1..).unwrap_or(&[]);
    let bits = match rows(&array.bounds, &array.element) {
        Some(_) if after.is_empty() => 1,
        Some((_, row_bytes)) => row_bytes.saturating_mul(8).saturating_mul(element_count(&after[..after.len() - 1])),
        None => u64::from(stride(&array.element)).saturating_mul(8).saturating_mul(element_count(after)),
    };
    u32::try_from(bits).unwrap_or(u32::MAX)
}

/// 0-based number of the element at `indices`; `Err` names the dimension that is out of bounds.
pub fn element_index(array: &ArrayType, indices: &[i64]) -> Result<u64, usize> {
    let mut number = 0u64;
    for (dimension, (&index, &(low, high))) in indices.iter().zip(&array.bounds).enumerate() {
        if index < i64::from(low) || index > i64::from(high) {
            return Err(dimension);
        }
        number = number * (i64::from(high) - i64::from(low) + 1) as u64 + (index - i64::from(low)) as u64;
    }
    Ok(number)
}

/// The same data in memory, with any type names. An FC or FB accepts an actual of this type.
pub fn same_type(a: &DataType, b: &DataType) -> bool {
    match (a, b) {
        (DataType::Array(a), DataType::Array(b)) => a.bounds == b.bounds && same_type(&a.element, &b.element),
        (DataType::Struct(a), DataType::Struct(b)) => same_structure(a, b),
        _ => a == b,
    }
}

fn same_structure(a: &StructType, b: &StructType) -> bool {
    std::ptr::eq(a, b)
        || (a.instance_of == b.instance_of
            && a.bytes == b.bytes
            && a.members.len() == b.members.len()
            && a.members
                .iter()
                .zip(&b.members)
                .all(|(a, b)| (a.byte, a.bit) == (b.byte, b.bit) && same_type(&a.ty, &b.ty)))
}

/// Most components of a structure that help texts list.
const LISTED_MAX: usize = 12;

/// As [`type_name`]; a structure without a name has its components.
pub fn declared_type(ty: &DataType) -> String {
    match ty {
        DataType::Struct(structure) if structure.name.is_empty() && structure.members.len() <= LISTED_MAX => {
            let components =
                structure.members.iter().map(|member| format!("{} : {}; ", member.name, type_name(&member.ty)));
            format!("STRUCT {}END_STRUCT", components.collect::<String>())
        }
        ty => type_name(ty),
    }
}

/// The type as written in a source.
pub fn type_name(ty: &DataType) -> String {
    match ty {
        DataType::Elementary(elementary) => elementary.name().to_string(),
        DataType::DateAndTime => "DATE_AND_TIME".to_string(),
        DataType::String(length) => format!("STRING[{length}]"),
        DataType::WideString(length) => format!("WSTRING[{length}]"),
        DataType::OpenArray(array) => {
            format!("ARRAY[{}] OF {}", vec!["*"; usize::from(array.dimensions)].join(","), type_name(&array.element))
        }
        DataType::Array(array) => {
            let bounds: Vec<String> = array.bounds.iter().map(|(low, high)| format!("{low}..{high}")).collect();
            format!("ARRAY[{}] OF {}", bounds.join(","), type_name(&array.element))
        }
        DataType::Struct(structure) if structure.name.is_empty() => "STRUCT".to_string(),
        DataType::Struct(structure) => structure.name.clone(),
        DataType::Parameter(parameter) => match parameter {
            ParameterType::Timer => "TIMER",
            ParameterType::Counter => "COUNTER",
            ParameterType::BlockFb => "BLOCK_FB",
            ParameterType::BlockFc => "BLOCK_FC",
            ParameterType::BlockDb => "BLOCK_DB",
            ParameterType::BlockSdb => "BLOCK_SDB",
            ParameterType::Pointer => "POINTER",
            ParameterType::Any => "ANY",
            ParameterType::Variant => "VARIANT",
        }
        .to_string(),
        DataType::Void => "an unknown type".to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::rc::Rc;

    const BOOL: DataType = DataType::Elementary(Elementary::Bool);
    const BYTE: DataType = DataType::Elementary(Elementary::Byte);
    const INT: DataType = DataType::Elementary(Elementary::Int);
    const WORD: DataType = DataType::Elementary(Elementary::Word);
    const REAL: DataType = DataType::Elementary(Elementary::Real);
    const TIME: DataType = DataType::Elementary(Elementary::Time);

    fn array(bounds: &[(i32, i32)], element: DataType) -> ArrayType {
        ArrayType { bounds: bounds.to_vec(), bytes: array_bytes(bounds, &element) as u32, element }
    }

    fn places(types: &[&DataType]) -> Vec<(u32, u8)> {
        let mut placer = Placer::default();
        types.iter().map(|ty| placer.place(ty)).collect()
    }

    #[test]
    fn bits_bytes_and_words() {
        assert_eq!(places(&[&BOOL, &BOOL, &BYTE, &BOOL, &INT]), [(0, 0), (0, 1), (1, 0), (2, 0), (4, 0)]);
        assert_eq!(places(&[&BYTE, &REAL, &BYTE, &BYTE]), [(0, 0), (2, 0), (6, 0), (7, 0)]);
    }

    #[test]
    fn nine_bits_take_two_bytes() {
        let types = [&BOOL; 9];
        assert_eq!(places(&types)[8], (1, 0));
    }

    #[test]
    fn arrays_begin_and_end_even() {
        let bits = DataType::Array(Rc::new(array(&[(1, 3)], BOOL)));
        assert_eq!(places(&[&BOOL, &bits, &BOOL]), [(0, 0), (2, 0), (4, 0)]);
    }

    /// Source: STL reference, layout rule 7: `ARRAY[1..2,1..3] OF BOOL`.
    #[test]
    fn rows_of_bits_begin_at_a_byte() {
        let bits = array(&[(1, 2), (1, 3)], BOOL);
        let place = |row, column| element_place(&bits, element_index(&bits, &[row, column]).unwrap());
        assert_eq!(place(1, 1), (0, 0));
        assert_eq!(place(1, 3), (0, 2));
        assert_eq!(place(2, 1), (1, 0));
        assert_eq!(bits.bytes, 2);
    }

    #[test]
    fn odd_strings_are_padded_in_arrays() {
        let texts = array(&[(0, 2)], DataType::String(5));
        assert_eq!(element_place(&texts, 1), (8, 0));
        assert_eq!(texts.bytes, 24);
    }

    #[test]
    fn indices_are_checked() {
        let numbers = array(&[(-1, 2), (5, 6)], INT);
        assert_eq!(element_index(&numbers, &[-1, 5]), Ok(0));
        assert_eq!(element_index(&numbers, &[2, 6]), Ok(7));
        assert_eq!(element_index(&numbers, &[3, 6]), Err(0));
        assert_eq!(element_index(&numbers, &[0, 4]), Err(1));
    }

    /// Source: published instance layout of FB 41: SP_INT 6, GAIN 20, LMN 72, PV 92, first static 100, length 126.
    #[test]
    fn instance_of_fb_41() {
        let mut placer = Placer::default();
        let mut place = |ty: &DataType| placer.place(ty).0;
        for _ in 0..8 {
            assert_eq!(place(&BOOL), 0);
        }
        assert_eq!(place(&TIME), 2, "CYCLE");
        assert_eq!(place(&REAL), 6, "SP_INT");
        assert_eq!(place(&REAL), 10, "PV_IN");
        assert_eq!(place(&WORD), 14, "PV_PER");
        assert_eq!(place(&REAL), 16, "MAN");
        assert_eq!(place(&REAL), 20, "GAIN");
    }

    /// Source: published instance layout of FB 58: the sections begin at even addresses.
    #[test]
    fn sections_begin_even() {
        let mut placer = Placer::default();
        for ty in [&REAL, &INT, &REAL, &BOOL, &BOOL, &INT] {
            placer.place(ty);
        }
        placer.align();
        for (ty, place) in [(&REAL, 14), (&REAL, 18), (&INT, 22), (&BOOL, 24), (&BOOL, 24), (&BOOL, 24), (&BOOL, 24)] {
            assert_eq!(placer.place(ty).0, place);
        }
        placer.align();
        assert_eq!(placer.place(&REAL).0, 26, "CYCLE, the first IN_OUT");
    }
}
