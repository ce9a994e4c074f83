//! The shapes of data blocks in the image, for programs with blocks that write data to files.

use plcc_abi::image::{AssertType, BlockKind};
use plcc_abi::shape::USERS;
use plcc_abi::shape::{ArrayShape, DbShape, Part, Shape};
use plcc_model::types::{DTL, DataType, Member, value_type};
use plcc_model::{Program, layout};

/// The shapes of all DBs if the program has a block that needs them.
pub fn of(program: &Program) -> Vec<DbShape> {
    if !program.blocks.iter().any(|block| block.kind == BlockKind::Sfb && USERS.contains(&block.number)) {
        return Vec::new();
    }
    program.dbs.iter().map(|db| DbShape { number: db.number, parts: parts(&db.members) }).collect()
}

fn parts(members: &[Member]) -> Vec<Part> {
    let part = |member: &Member| Part {
        name: member.name.clone(),
        byte: member.byte,
        bit: member.bit,
        shape: shape(&member.ty),
    };
    members.iter().map(part).collect()
}

fn shape(ty: &DataType) -> Shape {
    let bytes = layout::bytes(ty);
    let value = |ty: AssertType| Shape::Value { ty, bytes };
    match ty {
        DataType::Elementary(ty) => value(value_type(*ty)),
        DataType::DateAndTime => value(AssertType::DateAndTime),
        DataType::String(_) => value(AssertType::Text),
        DataType::WideString(_) => value(AssertType::WideText),
        DataType::Struct(structure) if structure.name.eq_ignore_ascii_case(DTL) => value(AssertType::Dtl),
        DataType::Struct(structure) => Shape::Struct { bytes, parts: parts(&structure.members) },
        DataType::Array(array) => {
            let count = layout::element_count(&array.bounds);
            let bits = |index: u64| {
                let (byte, bit) = layout::element_place(array, index);
                8 * byte + u32::from(bit)
            };
            let length = |&(low, high): &(i32, i32)| (i64::from(high) - i64::from(low) + 1).clamp(0, 1 << 20) as u32;
            let row = array.bounds.last().map_or(1, length).max(1);
            let after = |index: u64| if index < count { bits(index) } else { 0 };
            Shape::Array(ArrayShape {
                dimensions: array.bounds.iter().map(|bounds| (bounds.0, length(bounds))).collect(),
                bytes,
                row,
                row_bits: after(u64::from(row)),
                element_bits: after(1).max(1),
                element: Box::new(shape(&array.element)),
            })
        }
        DataType::Parameter(_) | DataType::OpenArray(_) | DataType::Void => Shape::Other { bytes },
    }
}
