//! Types with start values, and what interfaces consist of.

use std::rc::Rc;

use plcc_abi::names::External;
use plcc_binding::constant::Constants;
use plcc_model::Interface;
use plcc_model::layout::{self, BYTES_MAX, Placer};
use plcc_model::types::{DataType, Elementary, Member, StructType};
use plcc_syntax::ast::SectionKind;
use rustc_hash::FxHashMap;

use crate::bind::declarations::path::Base;
/// A type with the start value of its variables, in bytes; a BOOL is one byte, 0 or 1.
#[derive(Clone, Debug)]
pub struct Typed {
    pub ty: DataType,
    pub image: Rc<[u8]>,
}

/// A structure with its start value in bytes.
#[derive(Clone, Debug)]
pub struct TypedStruct {
    pub ty: Rc<StructType>,
    pub image: Rc<[u8]>,
}

/// A variable that the code of a block can name.
#[derive(Clone, Debug)]
pub struct Local {
    pub name: String,
    pub ty: DataType,
    pub base: Base,
    pub byte: u32,
    pub bit: u8,
}

/// Where declarations are.
#[derive(Debug, Default)]
pub struct DeclarationScope {
    /// Those of the block so far.
    pub constants: Constants,
    /// A block in SCL.
    pub scl: bool,
    /// Names mean instructions of the TIA Portal if possible.
    pub tia: bool,
    /// An FB or SFB.
    pub instance: bool,
    /// The variable that is declared, for messages.
    pub variable: String,
}

/// The declarations of a block.
#[derive(Debug, Default)]
pub struct BoundInterface {
    pub interface: Interface,
    /// FB, SFB: the instance as a type.
    pub instance: Option<TypedStruct>,
    /// Folded names.
    pub locals: FxHashMap<String, Local>,
    /// `VAR CONSTANT` and CONST.
    pub constants: Constants,
    /// The data block with constants of arrays and structures.
    pub constant_db: Option<u16>,
    pub temp_bytes: u32,
}

/// Where a type is used.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Use {
    /// A component of a structure, a UDT or a DB.
    Component,
    Parameter(SectionKind),
    Static,
    /// An element of an array or a component of a structure in static data of a block in STL.
    StaticPart,
    Temp,
    Result,
}

impl Use {
    /// Where an element or component of a type is: instances are static data, also in arrays and structures of SCL.
    pub fn inside(self, scl: bool) -> Use {
        match self {
            Use::Static | Use::Parameter(SectionKind::InOut) if scl => Use::Static,
            Use::Static | Use::StaticPart => Use::StaticPart,
            Use::Component | Use::Parameter(_) | Use::Temp | Use::Result => Use::Component,
        }
    }
}

/// Consecutive components, with their start values in bytes.
#[derive(Default)]
pub struct StructBuilder {
    pub placer: Placer,
    members: Vec<Member>,
    image: Vec<u8>,
}

impl StructBuilder {
    pub fn add(&mut self, name: String, typed: &Typed) -> (u32, u8) {
        self.add_external(name, typed, External::default())
    }

    /// As [`StructBuilder::add`], with what clients may do.
    pub fn add_external(&mut self, name: String, typed: &Typed, external: External) -> (u32, u8) {
        let (byte, bit) = self.placer.place(&typed.ty);
        let end = byte as usize + typed.image.len();
        if end as u64 <= 2 * BYTES_MAX {
            if self.image.len() < end {
                self.image.resize(end, 0);
            }
            put(&mut self.image, byte, bit, &typed.ty, &typed.image);
        }
        self.members.push(Member { name, ty: typed.ty.clone(), byte, bit, external });
        (byte, bit)
    }

    /// The structure; the number of its bytes if it is too large.
    pub fn finish(mut self, name: String, instance_of: Option<(bool, u16)>) -> Result<TypedStruct, u64> {
        let bytes = u64::from(self.placer.clone().size());
        if bytes > BYTES_MAX {
            return Err(bytes);
        }
        self.image.resize(bytes as usize, 0);
        let ty = StructType { name, instance_of, refers_to: None, members: self.members, bytes: bytes as u32 };
        Ok(TypedStruct { ty: Rc::new(ty), image: Rc::from(self.image) })
    }

    pub fn too_large(&self) -> bool {
        u64::from(self.placer.clone().size()) > BYTES_MAX
    }
}

/// Writes the bytes of a variable of `ty` at its address.
pub fn put(image: &mut [u8], byte: u32, bit: u8, ty: &DataType, bytes: &[u8]) {
    let at = byte as usize;
    if *ty == DataType::Elementary(Elementary::Bool) {
        let mask = 1 << bit;
        image[at] = if bytes.first().is_some_and(|&value| value != 0) { image[at] | mask } else { image[at] & !mask };
    } else {
        image[at..at + bytes.len()].copy_from_slice(bytes);
    }
}

/// More than `L` can load.
pub fn is_complex(ty: &DataType) -> bool {
    matches!(
        ty,
        DataType::DateAndTime
            | DataType::String(_)
            | DataType::WideString(_)
            | DataType::Array(_)
            | DataType::Struct(_)
    )
}

pub fn string(length: u8) -> Typed {
    let mut image = vec![0; layout::bytes(&DataType::String(length)) as usize];
    image[0] = length;
    Typed { ty: DataType::String(length), image: Rc::from(image) }
}

pub fn wide_string(length: u16) -> Typed {
    let mut image = vec![0; layout::bytes(&DataType::WideString(length)) as usize];
    image[..2].copy_from_slice(&length.to_be_bytes());
    Typed { ty: DataType::WideString(length), image: Rc::from(image) }
}

/// An elementary type starts with 0; CHAR and WCHAR start with a blank.
pub fn elementary_typed(ty: Elementary) -> Typed {
    let mut image = vec![0; ty.bits().div_ceil(8) as usize];
    if matches!(ty, Elementary::Char | Elementary::Wchar)
        && let Some(last) = image.last_mut()
    {
        *last = b' ';
    }
    Typed { ty: DataType::Elementary(ty), image: Rc::from(image) }
}

/// A type with several values.
pub const fn is_composite(ty: &DataType) -> bool {
    matches!(ty, DataType::Array(_) | DataType::Struct(_))
}
