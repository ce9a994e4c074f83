//! Bytes that a block needs in the frame: its local data, and temporaries of calls.

use plcc_model::scl;
use plcc_model::types::DataType;
use plcc_model::{
    Actual, Argument, Body, Call, CodeBlock, Number, Operand, Parameter, Passing, Place, StlStatementKind,
};

/// Largest distance to the next even address.
pub(super) const ALIGNMENT: u32 = 1;

/// Bytes of the copy of an elementary parameter that a pointer points at.
pub const POINTED_COPY_BYTES: u32 = 8;

/// Bytes of the copy of a variable index of an actual parameter.
pub const INDEX_COPY_BYTES: u32 = 4;

/// Upper bound of what a call from SCL puts into the frame of the calling block, in bytes: the result, references with their values,
/// or a structure of parameters.
pub(super) fn scl_temporary_bytes(callee: &CodeBlock, call: &scl::Call) -> u32 {
    let result =
        crate::scl::result(callee).map_or(0, |(_, parameter)| crate::scl::result_bytes(&parameter.ty) + ALIGNMENT);
    // A function refers to what it is given. Constant texts for functions of texts may be there twice.
    let is_only_referred_to = |index: usize, parameter: &Parameter| {
        let is_given = |one: &scl::Argument| one.parameter == index && !matches!(one.actual, scl::Actual::Dropped);
        call.instance.is_none() && !matches!(parameter.ty, DataType::String(_)) && call.arguments.iter().any(is_given)
    };
    // Also values that pointers point at.
    let of_parameter = |(index, parameter): (usize, &Parameter)| match parameter.passing {
        Passing::Elementary(_) => 8 + ALIGNMENT,
        Passing::Complex { .. } if is_only_referred_to(index, parameter) => 6 + 2 * ALIGNMENT,
        Passing::Complex { .. } => 6 + crate::scl::result_bytes(&parameter.ty) + 2 * ALIGNMENT,
        Passing::OpenArray { .. } => 6 + ALIGNMENT,
        Passing::Number => 0,
        Passing::Pointer | Passing::Any | Passing::Variant => parameter.passing.pointer_bytes() + 8 + 2 * ALIGNMENT,
    };
    let structure = if matches!(callee.body, Body::Runtime) { callee.interface.bytes.max(2) + ALIGNMENT } else { 0 };
    result + structure + callee.interface.parameters.iter().enumerate().map(of_parameter).sum::<u32>()
}

/// Maximum that a call puts into the frame of the calling block, in bytes: pointers, constants and copies for an FC, the structure
/// of parameters for a system function, copies of indices and of what pointers point at for all.
pub(super) fn temporary_bytes(callee: &CodeBlock, call: &Call) -> u32 {
    let points_at_copy = |argument: &Argument| match argument.actual.pointer() {
        Actual::PointerTo { place, .. } => matches!(place, Place::Parameter { .. }),
        Actual::Const(_)
        | Actual::Place(_)
        | Actual::Number(_)
        | Actual::PointerBytes(_)
        | Actual::PointerCopy(_)
        | Actual::Variant(..) => false,
    };
    let indices = call.arguments.iter().map(|argument| argument.actual.indices().len()).sum::<usize>() as u32;
    let pointed = call.arguments.iter().filter(|argument| points_at_copy(argument)).count() as u32;
    let copies = indices * INDEX_COPY_BYTES + pointed * POINTED_COPY_BYTES;
    if matches!(callee.body, Body::Runtime) {
        return copies + callee.interface.bytes.max(2).next_multiple_of(2);
    }
    if call.instance.is_some() {
        return copies;
    }
    let of_parameter = |(index, parameter): (usize, &Parameter)| {
        let argument = call.arguments.iter().find(|argument| argument.parameter == index);
        let value = match argument.map(|argument| &argument.actual) {
            Some(Actual::Const(bytes)) => (bytes.len() as u32).next_multiple_of(2),
            Some(Actual::Place(place)) if is_copied(place) => 4,
            Some(Actual::Place(_) | Actual::Number(_) | Actual::PointerBytes(_) | Actual::PointerTo { .. })
            | Some(Actual::PointerCopy(_) | Actual::Variant(..))
            | None => 0,
        };
        match parameter.passing {
            Passing::Elementary(_) => value,
            Passing::Complex { .. } => 6 + value,
            Passing::OpenArray { .. } => 6,
            Passing::Number => 0,
            Passing::Pointer | Passing::Any | Passing::Variant => parameter.passing.pointer_bytes(),
        }
    };
    copies + callee.interface.parameters.iter().enumerate().map(of_parameter).sum::<u32>()
}

/// True for actuals of functions that may be passed as a copy in the caller's frame: peripheral ones, and those without a separate
/// area pointer if the function uses it.
fn is_copied(place: &Place) -> bool {
    matches!(
        place,
        Place::Pi { .. }
            | Place::Pq { .. }
            | Place::OpenDi { .. }
            | Place::Instance { .. }
            | Place::Parameter { .. }
            | Place::ThroughPointer { .. }
            | Place::Element { .. }
    )
}

/// Local data that the block's code can reach: declared TEMP, and directly addressed data after it, as code from the
/// graphic editors does.
pub fn local_bytes(block: &CodeBlock) -> u32 {
    let mut bytes = block.temp_bytes;
    let Body::Stl(statements) = &block.body else { return bytes.next_multiple_of(2) };
    let mut see = |place: &plcc_model::Place, width: u32| {
        if let plcc_model::Place::L { byte, .. } = place {
            bytes = bytes.max(byte + width);
        }
    };
    for statement in statements {
        match &statement.kind {
            StlStatementKind::Instruction { operand, .. } => see_operand(operand, &mut see),
            StlStatementKind::Assert(assert) => {
                for side in assert.sides() {
                    match side {
                        plcc_model::AssertSide::Operand(operand) => see_operand(operand, &mut see),
                        plcc_model::AssertSide::CellValue { number: plcc_model::Number::Word(place), .. } => {
                            see(place, 16)
                        }
                        plcc_model::AssertSide::CellValue { .. } => {}
                        plcc_model::AssertSide::Memory(place) => see(place, 16),
                        plcc_model::AssertSide::Register(_) => {}
                    }
                }
            }
            StlStatementKind::Call(call) => {
                for argument in &call.arguments {
                    if let plcc_model::Actual::Place(place) = &argument.actual {
                        see(place, 4);
                    }
                }
            }
            StlStatementKind::Label(_) | StlStatementKind::JumpList { .. } | StlStatementKind::Sleep(_) => {}
        }
    }
    bytes.next_multiple_of(2)
}

fn see_operand(operand: &Operand, see: &mut dyn FnMut(&plcc_model::Place, u32)) {
    use plcc_model::Place;
    let mut see_place = |place: &Place, width: u32| {
        see(place, width);
        if let Place::Indirect { pointer, .. } = place {
            see(pointer, 4);
        }
    };
    match operand {
        Operand::Memory { place, width } => see_place(place, width.bytes()),
        Operand::Cell { number, .. } | Operand::Block { number, .. } | Operand::Db { number, .. } => {
            if let Number::Word(place) = number {
                see_place(place, 2);
            }
        }
        Operand::None
        | Operand::Const { .. }
        | Operand::Status(_)
        | Operand::Special(_)
        | Operand::Register(_)
        | Operand::Label(_)
        | Operand::ParameterPointer { .. } => {}
    }
}
