//! Structures as values: what they are made of, and their encoding as one ExtensionObject. Source: OPC 10000-6, sections 5.2.6 and 5.2.7.
//!
//! The fields of a structure are encoded one after the other, those of a structure within it in its place, an array after its length.

use std::sync::Arc;

use plcc_abi::image::AssertType;
use plcc_abi::names::Dimension;
use plcc_runtime::address::Place;
use plcc_runtime::cpu::Cpu;
use plcc_runtime::typed::ValueType;

use super::code::{NodeId, Reader, Scalar, Variant, Writer};
use super::range::Range;
use super::status::{self, Status};
use super::values::{Part, Variable, bits, count_of, lengths_of, offsets_of, span, type_of};
use crate::limits::OPCUA_ELEMENTS_MAX;

/// ExtensionObject.
pub const TYPE: u8 = 22;
/// Number of the data type of all structures.
pub const BASE: u32 = 22;
/// Number of the encoding of a StructureDefinition.
const DEFINITION: u32 = 122;

/// A data type.
#[derive(Debug, PartialEq)]
pub struct Shape {
    pub name: String,
    /// The node of the type, and that of its encoding.
    pub data_type: NodeId,
    pub encoding: NodeId,
    pub fields: Vec<Field>,
    /// From its first byte to its last.
    bytes: u32,
    /// Elements, or 32 bytes of a text each.
    cost: u32,
}

/// A component.
#[derive(Debug, PartialEq)]
pub struct Field {
    pub name: String,
    pub byte: u32,
    pub bit: u8,
    pub kind: Kind,
    pub dimension: Option<Dimension>,
}

#[derive(Debug, PartialEq)]
pub enum Kind {
    Value(ValueType),
    Structure(Arc<Shape>),
}

impl Field {
    fn elements(&self) -> u32 {
        self.dimension.as_ref().map_or(1, |dimension| lengths_of(std::slice::from_ref(dimension))[0])
    }

    /// Bits from the start of its structure to its end.
    fn end(&self) -> u32 {
        let own = match &self.kind {
            Kind::Value(ty) => bits(*ty),
            Kind::Structure(shape) => 8 * shape.bytes,
        };
        let distance = self.dimension.as_ref().map_or(0, |dimension| dimension.distance);
        let last = self.elements().saturating_sub(1).saturating_mul(distance);
        (8 * self.byte + u32::from(self.bit)).saturating_add(last).saturating_add(own)
    }

    fn cost(&self) -> u32 {
        let one = match &self.kind {
            Kind::Value(ty) => (bits(*ty) / 256).max(1),
            Kind::Structure(shape) => shape.cost,
        };
        one.saturating_mul(self.elements())
    }
}

impl Shape {
    /// `None`: there is too much of it to be one value.
    pub fn new(name: String, data_type: NodeId, encoding: NodeId, fields: Vec<Field>) -> Option<Shape> {
        let bytes = fields.iter().map(|field| field.end().div_ceil(8)).max().unwrap_or(0);
        let cost = fields.iter().fold(0u32, |cost, field| cost.saturating_add(field.cost()));
        let shape = Shape { name, data_type, encoding, fields, bytes, cost };
        (cost <= OPCUA_ELEMENTS_MAX && bytes > 0).then_some(shape)
    }

    /// Its StructureDefinition.
    pub fn definition(&self) -> Scalar {
        let mut out = Writer::default();
        out.node(&self.encoding);
        out.node(&NodeId::number(0, BASE));
        out.u32(0);
        out.list(&self.fields, |out, field| {
            out.text(&field.name);
            out.localized("");
            let (data_type, length) = match &field.kind {
                Kind::Value(ty) => {
                    let is_text = matches!(ty.ty, AssertType::Text | AssertType::WideText);
                    (NodeId::number(0, type_of(ty.ty).into()), if is_text { ty.length } else { 0 })
                }
                Kind::Structure(shape) => (shape.data_type.clone(), 0),
            };
            out.node(&data_type);
            match field.dimension {
                Some(_) => {
                    out.i32(1);
                    out.list(&[field.elements()], |out, length| out.u32(*length));
                }
                None => {
                    out.i32(-1);
                    out.null();
                }
            }
            out.u32(length.into());
            out.bool(false);
        });
        Scalar::Object(NodeId::number(0, DEFINITION), out.0)
    }

    /// Every value in it, and the length of every array, in the order of the encoding.
    fn walk(&self, at: u32, step: &mut dyn FnMut(Step) -> Result<(), Status>) -> Result<(), Status> {
        for field in &self.fields {
            let byte = at + field.byte;
            match &field.kind {
                Kind::Value(ty) => {
                    step(Step::Value { byte, bit: field.bit, ty: *ty, dimension: field.dimension.as_ref() })?
                }
                Kind::Structure(shape) => {
                    let Some(dimension) = &field.dimension else {
                        shape.walk(byte, step)?;
                        continue;
                    };
                    step(Step::Length(field.elements()))?;
                    for start in offsets_of(std::slice::from_ref(dimension), 0) {
                        shape.walk(byte + start / 8, step)?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// A part of the encoding.
enum Step<'a> {
    /// Of an array of structures.
    Length(u32),
    /// From the byte on, an array with a dimension.
    Value { byte: u32, bit: u8, ty: ValueType, dimension: Option<&'a Dimension> },
}

/// A structure in memory, or an array of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Compound {
    pub place: Place,
    pub shape: Arc<Shape>,
    pub dimensions: Vec<Dimension>,
    pub read_only: bool,
}

/// What comes into memory: values, each with its parts.
pub type Values = Vec<(Variable, Vec<Part>)>;

impl Compound {
    pub fn lengths(&self) -> Vec<u32> {
        lengths_of(&self.dimensions)
    }

    /// Whether anyone may change it.
    pub fn is_writable(&self) -> bool {
        self.variable(0, 0, ValueType::of(AssertType::Bits(8)), None).is_writable()
    }

    /// How much it takes to keep its value.
    pub fn cost(&self) -> Result<u32, Status> {
        let count = count_of(&self.dimensions).ok_or(status::NOT_READABLE)?;
        let cost = count.checked_mul(self.shape.cost).filter(|cost| *cost <= OPCUA_ELEMENTS_MAX);
        cost.ok_or(status::NOT_READABLE)
    }

    /// Where its elements begin, in bytes.
    fn starts(&self) -> Result<Vec<u32>, Status> {
        self.cost()?;
        Ok(offsets_of(&self.dimensions, 0).into_iter().map(|at| at / 8).collect())
    }

    fn bytes(&self) -> Result<u32, Status> {
        let last = self.starts()?.last().copied().unwrap_or(0);
        Ok(last.saturating_add(self.shape.bytes))
    }

    /// Copies its bytes, at the cycle control point.
    pub fn read(&self, cpu: &Cpu) -> Result<Vec<u8>, Status> {
        let bytes = self.bytes()?;
        let at = span(self.place, bytes, cpu)?.ok_or(status::NOT_READABLE)?;
        Ok(cpu.memory.view(at, bytes, <[u8]>::to_vec))
    }

    /// What the bytes mean.
    pub fn value(&self, bytes: &[u8]) -> Result<Variant, Status> {
        let one = |start: u32| {
            let mut out = Writer::default();
            self.shape.walk(start, &mut |step| {
                match step {
                    Step::Length(length) => out.u32(length),
                    Step::Value { byte, bit, ty, dimension } => {
                        let rest = bytes.get(byte as usize..).ok_or(status::NOT_FOUND)?;
                        match self.variable(0, bit, ty, dimension).value(rest)? {
                            Variant::One(value) => value.put(&mut out),
                            Variant::Many { values, .. } => out.list(&values, |out, value| value.put(out)),
                            Variant::Empty => {}
                        }
                    }
                }
                Ok(())
            })?;
            Ok(Scalar::Object(self.shape.encoding.clone(), out.0))
        };
        if self.dimensions.is_empty() {
            return one(0).map(Variant::One);
        }
        let values = self.starts()?.into_iter().map(one).collect::<Result<_, _>>()?;
        Ok(Variant::Many { ty: TYPE, values, dimensions: self.lengths() })
    }

    /// A value in it.
    fn variable(&self, byte: u32, bit: u8, ty: ValueType, dimension: Option<&Dimension>) -> Variable {
        let dimensions = dimension.into_iter().cloned().collect();
        Variable { place: self.place.offset(byte), bit, ty, dimensions, read_only: self.read_only }
    }

    /// A value of a client as it comes into memory.
    pub fn parts(&self, value: &Variant, range: Option<&Range>) -> Result<Values, Status> {
        let starts = self.starts()?;
        let (values, starts) = match (value, range) {
            (Variant::One(value), None) if self.dimensions.is_empty() => (std::slice::from_ref(value), starts),
            (Variant::Many { values, .. }, None) if !self.dimensions.is_empty() => (values.as_slice(), starts),
            (Variant::Many { values, .. }, Some(range)) => {
                let (elements, _) = range.elements(&self.lengths(), true)?;
                (values.as_slice(), elements.iter().filter_map(|index| starts.get(*index).copied()).collect())
            }
            _ => return Err(status::TYPE_MISMATCH),
        };
        if values.len() != starts.len() {
            return Err(status::TYPE_MISMATCH);
        }
        let mut found = Vec::new();
        for (start, value) in starts.into_iter().zip(values) {
            let Scalar::Object(encoding, body) = value else { return Err(status::TYPE_MISMATCH) };
            if *encoding != self.shape.encoding {
                return Err(status::TYPE_MISMATCH);
            }
            let mut reader = Reader(body);
            self.shape.walk(start, &mut |step| {
                match step {
                    Step::Length(length) if reader.u32().ok_or(status::DECODING)? == length => {}
                    Step::Length(_) => return Err(status::TYPE_MISMATCH),
                    Step::Value { byte, bit, ty, dimension } => {
                        let number = type_of(ty.ty);
                        let variable = self.variable(byte, bit, ty, dimension);
                        let value = match dimension {
                            None => reader.scalar(number).map(Variant::One),
                            Some(_) => {
                                reader.list(|reader| reader.scalar(number)).map(|all| Variant::list(number, all))
                            }
                        };
                        let parts = variable.parts(&value.ok_or(status::DECODING)?, None)?;
                        found.push((variable, parts));
                    }
                }
                Ok(())
            })?;
            if !reader.0.is_empty() {
                return Err(status::DECODING);
            }
        }
        Ok(found)
    }
}

/// Writes, at the cycle control point: all values, or none.
pub fn write(cpu: &Cpu, values: &Values) -> Result<(), Status> {
    values.iter().try_for_each(|(variable, parts)| variable.check(cpu, parts))?;
    values.iter().try_for_each(|(variable, parts)| variable.write(cpu, parts))
}
