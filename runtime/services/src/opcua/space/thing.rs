//! Things that have a value or consist of others: found by name or address, with their parts and types.

use plcc_abi::image::AssertType;
use plcc_abi::names::{Dimension, External, NamedMember, NamedStruct, NamedType, TypeNumber};
use plcc_runtime::address::{self, Place};
use plcc_runtime::typed::{self, ValueType};

use super::super::code::NodeId;
use super::super::standard::{ANALOG_UNIT_TYPE, BASE_OBJECT_TYPE, DATA_VARIABLE_TYPE, HAS_COMPONENT, OBJECT, VARIABLE};
use super::super::structures::Compound;
use super::super::unit::Unit;
use super::super::values::{Variable, unit_text};
use super::node::{Content, Folder, Node};
use super::{DATA, Space};
use crate::limits::OPCUA_LISTED_MAX;

/// What has the value, or consists of others.
#[derive(Clone, Debug)]
pub(super) struct Thing {
    /// As in its node id.
    pub(super) id: String,
    pub(super) name: String,
    pub(super) parent: String,
    pub(super) place: Place,
    pub(super) bit: u8,
    pub(super) ty: Ty,
    pub(super) read_only: bool,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Ty {
    Declared(TypeNumber),
    Plain(ValueType),
}

/// A step from a thing to a part of it.
enum Step<'a> {
    Member(&'a str),
    Index(Vec<i64>),
}

/// What a declared type is made of.
pub(super) enum Form<'a> {
    Value(ValueType),
    Array(&'a [Dimension], TypeNumber),
    Struct(&'a NamedStruct),
    Other,
}

impl Space {
    pub(super) fn form(&self, ty: TypeNumber) -> Form<'_> {
        match self.image.types.get(ty as usize) {
            Some(NamedType::Value(ty)) => Form::Value(ValueType::of(*ty)),
            Some(NamedType::Text { wide, length }) => {
                let ty = if *wide { AssertType::WideText } else { AssertType::Text };
                Form::Value(ValueType { ty, length: *length })
            }
            Some(NamedType::Struct(structure)) if structure.is_dtl => Form::Value(ValueType::of(AssertType::Dtl)),
            Some(NamedType::Struct(structure)) => Form::Struct(structure),
            Some(NamedType::Array { dimensions, element }) => Form::Array(dimensions, *element),
            Some(NamedType::Other { .. }) | None => Form::Other,
        }
    }

    pub(super) fn thing(&self, text: &str) -> Option<Thing> {
        if let Some(address) = text.strip_prefix('%') {
            return self.address(address);
        }
        let (root, steps) = steps(text)?;
        let mut thing = self.roots.get(root)?.clone();
        for step in steps {
            thing = match step {
                Step::Member(name) => {
                    let Ty::Declared(ty) = thing.ty else { return None };
                    let Form::Struct(structure) = self.form(ty) else { return None };
                    let member = structure.members.iter().find(|member| member.name == name)?;
                    if member.external == External::Hidden {
                        return None;
                    }
                    self.member(&thing, member)
                }
                Step::Index(indices) => self.element(&thing, &indices)?,
            };
        }
        // A node has one name only.
        (thing.id == text).then_some(thing)
    }

    /// A value by its address, which need not be one that the program names.
    fn address(&self, text: &str) -> Option<Thing> {
        let is_plain = !text.is_empty()
            && text.bytes().all(|byte| byte.is_ascii_uppercase() || byte.is_ascii_digit() || byte == b'.');
        let address = address::parse_for(text, &self.image).filter(|_| is_plain)?;
        // An address is not a way around what components and tags say.
        let external = match address.place {
            Place::Db(number, _) => {
                let db = self.image.dbs.iter().find(|db| db.number == number).filter(|db| !db.optimized)?;
                let least = db.ty.map_or(External::Write, |ty| self.least(ty));
                if db.read_only { least.min(External::Read) } else { least }
            }
            _ => self.limit(address),
        };
        self.address_tag(text, address, external).map(|(_, thing)| thing)
    }

    fn member(&self, thing: &Thing, member: &NamedMember) -> Thing {
        Thing {
            id: format!("{}.{}", thing.id, quoted(&member.name)),
            name: member.name.clone(),
            parent: thing.id.clone(),
            place: thing.place.offset(member.byte),
            bit: member.bit,
            ty: Ty::Declared(member.ty),
            read_only: thing.read_only || member.external != External::Write,
        }
    }

    fn element(&self, thing: &Thing, indices: &[i64]) -> Option<Thing> {
        let Ty::Declared(ty) = thing.ty else { return None };
        let Form::Array(dimensions, element) = self.form(ty) else { return None };
        if indices.len() != dimensions.len() {
            return None;
        }
        let mut bits = u64::from(thing.bit);
        for (index, dimension) in indices.iter().zip(dimensions) {
            let (low, high) = (i64::from(dimension.low), i64::from(dimension.high));
            if !(low..=high).contains(index) {
                return None;
            }
            bits += (index - low) as u64 * u64::from(dimension.distance);
        }
        let texts: Vec<String> = indices.iter().map(ToString::to_string).collect();
        let name = format!("[{}]", texts.join(","));
        Some(Thing {
            id: format!("{}{name}", thing.id),
            name,
            parent: thing.id.clone(),
            place: thing.place.offset(u32::try_from(bits / 8).ok()?),
            bit: (bits % 8) as u8,
            ty: Ty::Declared(element),
            read_only: thing.read_only,
        })
    }

    pub(super) fn thing_node(&self, thing: Thing) -> Node {
        let variable = |ty: ValueType, dimensions: &[Dimension]| Variable {
            place: thing.place,
            bit: thing.bit,
            ty,
            dimensions: dimensions.to_vec(),
            read_only: thing.read_only,
        };
        let compound = |ty: TypeNumber, dimensions: &[Dimension]| {
            let shape = self.shapes.get(ty as usize)?.clone()?;
            Some(Content::Compound(Compound {
                place: thing.place,
                shape,
                dimensions: dimensions.to_vec(),
                read_only: thing.read_only || self.least(ty) != External::Write,
            }))
        };
        let memory = |ty: ValueType, dimensions: &[Dimension]| Some(Content::Memory(variable(ty, dimensions)));
        let found = match thing.ty {
            Ty::Plain(ty) => memory(ty, &[]),
            Ty::Declared(ty) => match self.form(ty) {
                Form::Value(ty) => memory(ty, &[]),
                Form::Array(dimensions, element) => match self.form(element) {
                    Form::Value(ty) => memory(ty, dimensions),
                    Form::Struct(_) => compound(element, dimensions),
                    Form::Array(..) | Form::Other => None,
                },
                // A block as a whole is not a value, as on a CPU.
                Form::Struct(_) if thing.parent == Folder::DataBlocks.name() => None,
                Form::Struct(_) => compound(ty, &[]),
                Form::Other => None,
            },
        };
        let definition = match &found {
            Some(Content::Memory(variable)) if Unit::of(variable.ty.ty).is_some() => ANALOG_UNIT_TYPE,
            Some(_) => DATA_VARIABLE_TYPE,
            None => BASE_OBJECT_TYPE,
        };
        let description = match thing.ty {
            Ty::Plain(ty) => value_text(ty),
            Ty::Declared(ty) => self.text(ty),
        };
        Node {
            parent: Some((NodeId::text(DATA, thing.parent), HAS_COMPONENT)),
            id: NodeId::text(DATA, thing.id),
            class: if found.is_some() { VARIABLE } else { OBJECT },
            name: thing.name,
            description,
            definition,
            content: found.unwrap_or(Content::None),
        }
    }

    /// A type as it is declared.
    fn text(&self, ty: TypeNumber) -> String {
        match self.form(ty) {
            Form::Value(ty) => value_text(ty),
            Form::Array(dimensions, element) => {
                let bounds: Vec<String> =
                    dimensions.iter().map(|dimension| format!("{}..{}", dimension.low, dimension.high)).collect();
                format!("ARRAY[{}] OF {}", bounds.join(", "), self.text(element))
            }
            Form::Struct(structure) => match (structure.name.as_str(), structure.data_type.as_str()) {
                ("", "") => "STRUCT".to_string(),
                ("", name) | (name, _) => name.to_string(),
            },
            Form::Other => String::new(),
        }
    }

    pub(super) fn parts(&self, thing: &Thing) -> Vec<Thing> {
        let Ty::Declared(ty) = thing.ty else { return Vec::new() };
        match self.form(ty) {
            Form::Struct(structure) => {
                let members = structure.members.iter().filter(|member| member.external != External::Hidden);
                let known = members.filter(|member| !matches!(self.form(member.ty), Form::Other));
                known.map(|member| self.member(thing, member)).collect()
            }
            Form::Array(dimensions, _) => {
                let mut indices: Vec<i64> = dimensions.iter().map(|dimension| dimension.low.into()).collect();
                let mut found = Vec::new();
                while found.len() < OPCUA_LISTED_MAX
                    && let Some(element) = self.element(thing, &indices)
                {
                    found.push(element);
                    // The last index runs fastest.
                    let next = (0..indices.len()).rev().find(|&at| indices[at] < i64::from(dimensions[at].high));
                    let Some(next) = next else { break };
                    indices[next] += 1;
                    for at in next + 1..indices.len() {
                        indices[at] = dimensions[at].low.into();
                    }
                }
                found
            }
            Form::Value(_) | Form::Other => Vec::new(),
        }
    }
}

fn value_text(ty: ValueType) -> String {
    let length = match ty.ty {
        AssertType::Text | AssertType::WideText => format!("[{}]", ty.length),
        _ => String::new(),
    };
    format!("{}{length}{}", typed::name(ty.ty), unit_text(ty.ty))
}

pub(super) fn quoted(name: &str) -> String {
    format!("\"{name}\"")
}

/// Splits `"a"."b"[1,2]` into its root and the way from there.
fn steps(text: &str) -> Option<(&str, Vec<Step<'_>>)> {
    let (root, mut rest) = text.strip_prefix('"')?.split_once('"')?;
    let mut steps = Vec::new();
    while !rest.is_empty() {
        if let Some(member) = rest.strip_prefix(".\"") {
            let (name, after) = member.split_once('"')?;
            steps.push(Step::Member(name));
            rest = after;
        } else {
            let (list, after) = rest.strip_prefix('[')?.split_once(']')?;
            steps.push(Step::Index(list.split(',').map(|index| index.parse().ok()).collect::<Option<_>>()?));
            rest = after;
        }
    }
    Some((root, steps))
}
