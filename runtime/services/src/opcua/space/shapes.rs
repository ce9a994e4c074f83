//! Which types of a program are types of OPC UA: structures that can be a value as a whole.

use std::sync::Arc;

use plcc_abi::names::{External, NamedMember, NamedType, TypeNumber};

use super::super::code::NodeId;
use super::super::structures::{Field, Kind, Shape};
use super::node::{DATA_TYPE_PREFIX, ENCODING_PREFIX};
use super::thing::{Form, quoted};
use super::{DATA, Space};

impl Space {
    /// Finds what clients may do with a value as a whole: no more than with any component of it. A type comes after those of its components.
    pub(super) fn find_least(&mut self) {
        let mut least: Vec<External> = Vec::with_capacity(self.image.types.len());
        for ty in &self.image.types {
            let of = |ty: TypeNumber| least.get(ty as usize).copied().unwrap_or_default();
            let own = match ty {
                NamedType::Struct(structure) => {
                    let members = structure.members.iter().map(|member| member.external.min(of(member.ty)));
                    members.min().unwrap_or_default()
                }
                NamedType::Array { element, .. } => of(*element),
                NamedType::Value(_) | NamedType::Text { .. } | NamedType::Other { .. } => External::default(),
            };
            least.push(own);
        }
        self.least = least;
    }

    /// What clients may do with all of a value of this type.
    pub(super) fn least(&self, ty: TypeNumber) -> External {
        self.least.get(ty as usize).copied().unwrap_or_default()
    }

    /// Finds the types of structures that are a component, an element or a tag. A type comes after those of its components.
    pub(super) fn find_shapes(&mut self) {
        let mut is_part = vec![false; self.image.types.len()];
        let mut part = |ty: TypeNumber| is_part.get_mut(ty as usize).into_iter().for_each(|found| *found = true);
        for ty in &self.image.types {
            match ty {
                NamedType::Struct(structure) => structure.members.iter().for_each(|member| part(member.ty)),
                NamedType::Array { element, .. } => part(*element),
                NamedType::Value(_) | NamedType::Text { .. } | NamedType::Other { .. } => {}
            }
        }
        self.image.symbols.iter().filter_map(|symbol| symbol.ty).for_each(part);
        for (number, is_part) in is_part.into_iter().enumerate() {
            let shape = if is_part { self.new_shape(number) } else { None };
            let shape = shape.map(Arc::new);
            if let Some(shape) = &shape {
                self.by_name.insert(shape.name.clone(), self.data_types.len());
                self.data_types.push(shape.clone());
            }
            self.shapes.push(shape);
        }
    }

    /// `None`: it is not a structure, or one that is not a value as a whole.
    fn new_shape(&self, number: usize) -> Option<Shape> {
        let ty = TypeNumber::try_from(number).ok()?;
        let Form::Struct(structure) = self.form(ty) else { return None };
        let kind = |ty: TypeNumber| match self.form(ty) {
            Form::Value(ty) => Some(Kind::Value(ty)),
            Form::Struct(_) => self.shapes.get(ty as usize)?.clone().map(Kind::Structure),
            Form::Array(..) | Form::Other => None,
        };
        let field = |member: &NamedMember| {
            if member.external == External::Hidden {
                return None;
            }
            let (kind, dimension) = match self.form(member.ty) {
                // One dimension, as decoders of structures have it.
                Form::Array([dimension], element) => (kind(element)?, Some(dimension.clone())),
                Form::Array(..) => return None,
                Form::Value(_) | Form::Struct(_) | Form::Other => (kind(member.ty)?, None),
            };
            Some(Field { name: member.name.clone(), byte: member.byte, bit: member.bit, kind, dimension })
        };
        let fields = structure.members.iter().map(field).collect::<Option<Vec<_>>>()?;
        let declared = if structure.name.is_empty() { &structure.data_type } else { &structure.name };
        // A structure without a name, or the second one of a name.
        let is_free = |name: &str| !name.is_empty() && !self.by_name.contains_key(name);
        let name = if is_free(declared) { declared.clone() } else { format!("{declared}_{number}") };
        let node = |prefix: &str| NodeId::text(DATA, format!("{prefix}{}", quoted(&name)));
        Shape::new(name.clone(), node(DATA_TYPE_PREFIX), node(ENCODING_PREFIX), fields)
    }
}
