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
                        match self.variable(0, bit, ty, dimension).value_of_component(rest)? {
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
                        let parts = variable.parts_of_component(&value.ok_or(status::DECODING)?)?;
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

#[cfg(test)]
mod tests {
    use std::rc::Rc;

    use plcc_abi::ProgramImage;
    use plcc_abi::image::{Config, DbEntry, Family, Kept, Profile};
    use plcc_abi::layout;
    use plcc_abi::names::{External, NamedMember, NamedStruct, NamedType, TypeNumber};
    use plcc_runtime::clock::Clock;
    use plcc_runtime::code::Code;
    use plcc_runtime::io::Simulated;

    use super::super::space::{Content, DATA, Space};
    use super::*;

    struct NoBlocks;

    impl Code for NoBlocks {
        fn call(&self, _: u32, _: *mut u8, _: u32, _: u32) {}
    }

    /// DB 1 `Groups` with `one : Motor` and `motors : ARRAY[1..2] OF Motor`; a motor is `speed : REAL`, `running : BOOL`, `name : STRING[10]`,
    /// `hours : ARRAY[1..3] OF UINT`.
    fn image() -> ProgramImage {
        let member = |&(name, ty, byte): &(&str, TypeNumber, u32)| NamedMember {
            name: name.to_string(),
            ty,
            byte,
            bit: 0,
            external: External::default(),
        };
        let members = |members: &[(&str, TypeNumber, u32)]| members.iter().map(member).collect();
        let structure = |name: &str, list: &[(&str, TypeNumber, u32)]| {
            let data_type = String::new();
            NamedType::Struct(NamedStruct { name: name.to_string(), data_type, members: members(list), is_dtl: false })
        };
        let array = |high, distance, element| NamedType::Array {
            dimensions: vec![Dimension { low: 1, high, distance }],
            element,
        };
        let types = vec![
            NamedType::Value(AssertType::Real),
            NamedType::Value(AssertType::Bool),
            NamedType::Text { wide: false, length: 10 },
            NamedType::Value(AssertType::Unsigned(16)),
            array(3, 16, 3),
            structure("Motor", &[("speed", 0, 0), ("running", 1, 4), ("name", 2, 6), ("hours", 4, 18)]),
            array(2, 192, 5),
            structure("", &[("one", 5, 0), ("motors", 6, 24)]),
        ];
        let db = DbEntry {
            number: 1,
            name: "Groups".to_string(),
            address: layout::DB_DATA,
            data: vec![0; 72],
            read_only: false,
            unlinked: false,
            optimized: false,
            kept: Kept::Everything,
            ty: Some(7),
        };
        let profile = Profile {
            name: "s7-1500".to_string(),
            family: Family::S71500,
            accumulators: 2,
            inputs: 1024,
            outputs: 1024,
            bit_memory: 8192,
            timers: 0,
            counters: 0,
            local_data: 32_768,
            db_bytes_max: 65_534,
            block_depth: 24,
            error_depth: 4,
            limits_checked: false,
        };
        ProgramImage {
            name: "test".to_string(),
            profile,
            config: Config::default(),
            blocks: Vec::new(),
            dbs: vec![db],
            db_end: layout::DB_DATA + 128,
            sites: Vec::new(),
            error_slots: Vec::new(),
            files: Vec::new(),
            asserts: Vec::new(),
            symbols: Vec::new(),
            types,
            used: Vec::new(),
            partial: Vec::new(),
            stops_itself: false,
            sources_sum: 0,
            shapes: Vec::new(),
            outputs_used: u32::MAX,
            notices: Vec::new(),
            inner_blocks: Vec::new(),
            s7200: None,
        }
    }

    fn cpu(image: ProgramImage) -> Rc<Cpu> {
        let driver = Box::new(Simulated::new(None));
        let cpu = Cpu::new(image, Rc::new(NoBlocks), Clock::simulated(), driver);
        cpu.memory.set_db(1, layout::DB_DATA, 72);
        cpu
    }

    fn compound(space: &Space, id: &str) -> Compound {
        match space.node(&NodeId::text(DATA, id)).map(|node| node.content) {
            Some(Content::Compound(compound)) => compound,
            other => panic!("{id}: {other:?}"),
        }
    }

    /// `speed`, `running`, `name`, `hours` as they are encoded.
    fn body(speed: f32, running: bool, name: &str, hours: &[u16]) -> Vec<u8> {
        let mut out = Writer::default();
        Scalar::Float(speed).put(&mut out);
        out.bool(running);
        out.text(name);
        out.list(hours, |out, hours| out.u16(*hours));
        out.0
    }

    fn motor(body: Vec<u8>) -> Scalar {
        Scalar::Object(NodeId::text(DATA, "TE_\"Motor\""), body)
    }

    #[test]
    fn structures_are_written_and_read() {
        let image = image();
        let (space, cpu) = (Space::new(&image, 0), cpu(image));
        let (one, motors) = (compound(&space, "\"Groups\".\"one\""), compound(&space, "\"Groups\".\"motors\""));
        let fan = Variant::One(motor(body(-2.5, true, "fan", &[7, 8, 9])));
        write(&cpu, &one.parts(&fan, None).unwrap()).unwrap();
        assert_eq!(one.value(&one.read(&cpu).unwrap()), Ok(fan));
        let bytes = cpu.memory.view(layout::DB_DATA, 24, <[u8]>::to_vec);
        assert_eq!(bytes, [&[0xC0, 0x20, 0, 0, 1, 0, 10, 3], &b"fan"[..], &[0; 7], &[0, 7, 0, 8, 0, 9]].concat());
        // The second of two.
        let range = Range::parse("1").unwrap();
        let pump = motor(body(1.5, false, "pump", &[1, 2, 3]));
        let values = motors.parts(&Variant::list(TYPE, vec![pump.clone()]), range.as_ref()).unwrap();
        write(&cpu, &values).unwrap();
        let empty = motor(body(0.0, false, "", &[0, 0, 0]));
        let all = Variant::Many { ty: TYPE, values: vec![empty, pump], dimensions: vec![2] };
        assert_eq!(motors.value(&motors.read(&cpu).unwrap()), Ok(all));
    }

    #[test]
    fn wrong_structures_change_nothing() {
        let image = image();
        let (space, cpu) = (Space::new(&image, 0), cpu(image));
        let one = compound(&space, "\"Groups\".\"one\"");
        let mut long = body(1.0, true, "a", &[1, 2, 3]);
        long.push(0);
        for (value, expected) in [
            (motor(body(1.0, true, "12345678901", &[1, 2, 3])), status::OUT_OF_RANGE),
            (motor(body(1.0, true, "a", &[1, 2])), status::TYPE_MISMATCH),
            (motor(body(1.0, true, "a", &[1, 2, 3])[..9].to_vec()), status::DECODING),
            (motor(long), status::DECODING),
            (Scalar::Object(NodeId::number(0, 864), body(1.0, true, "a", &[1, 2, 3])), status::TYPE_MISMATCH),
            (Scalar::Float(1.0), status::TYPE_MISMATCH),
        ] {
            assert_eq!(one.parts(&Variant::One(value.clone()), None), Err(expected), "{value:?}");
        }
        // The program has made less room for the text than the type has.
        cpu.memory.set_byte(layout::DB_DATA + 6, 2);
        let values = one.parts(&Variant::One(motor(body(1.0, true, "fan", &[1, 2, 3]))), None).unwrap();
        assert_eq!(write(&cpu, &values), Err(status::OUT_OF_RANGE));
        assert_eq!(cpu.memory.view(layout::DB_DATA, 24, |bytes| bytes.iter().filter(|byte| **byte != 0).count()), 1);
    }

    #[test]
    fn a_wrong_date_does_not_hide_the_other_components() {
        let field = |name: &str, byte, ty| {
            let kind = Kind::Value(ValueType::of(ty));
            Field { name: name.to_string(), byte, bit: 0, kind, dimension: None }
        };
        let fields = vec![field("since", 0, AssertType::DateAndTime), field("speed", 8, AssertType::Real)];
        let node = |id: &str| NodeId::text(DATA, id);
        let shape = Shape::new("Run".to_string(), node("DT_\"Run\""), node("TE_\"Run\""), fields).unwrap();
        let run = Compound { place: Place::Db(1, 0), shape: Arc::new(shape), dimensions: Vec::new(), read_only: false };
        let mut body = Writer::default();
        Scalar::Time(0).put(&mut body);
        Scalar::Float(2.5).put(&mut body);
        let value = Variant::One(Scalar::Object(node("TE_\"Run\""), body.0));
        let cpu = cpu(image());
        // A date without a year, a month and a day.
        cpu.memory.set_byte(layout::DB_DATA + 3, 0x11);
        write(&cpu, &run.parts(&value, None).unwrap()).unwrap();
        let bytes = cpu.memory.view(layout::DB_DATA, 12, <[u8]>::to_vec);
        assert_eq!(bytes, [0, 0, 0, 0x11, 0, 0, 0, 0, 0x40, 0x20, 0, 0], "the date stays as it is");
        assert_eq!(run.value(&run.read(&cpu).unwrap()), Ok(value));
    }

    #[test]
    fn types_are_nodes() {
        let space = Space::new(&image(), 0);
        let base = space.node(&NodeId::number(0, BASE)).unwrap();
        let found: Vec<_> = space.children(&base).into_iter().map(|(_, node)| node.id).collect();
        // The block as a whole is not a value, so it has no type.
        let own: Vec<_> = found.iter().filter(|id| id.namespace == DATA).collect();
        assert_eq!(own, [&NodeId::text(DATA, "DT_\"Motor\"")]);
        let ty = space.node(own[0]).unwrap();
        let Content::DataType(shape) = &ty.content else { panic!("{ty:?}") };
        let Scalar::Object(encoding, body) = shape.definition() else { panic!("a definition") };
        assert_eq!((encoding, body.len()), (NodeId::number(0, DEFINITION), 132), "{body:02X?}");
        let [(_, default)] = space.children(&ty).try_into().unwrap();
        assert_eq!((default.name.as_str(), default.name_space()), ("Default Binary", 0));
        assert_eq!(space.child(&ty, "Default Binary").map(|node| node.id), Some(default.id));
    }
}
