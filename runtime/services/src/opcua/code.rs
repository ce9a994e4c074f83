//! The binary encoding: numbers, texts, node ids, variants. Source: OPC 10000-6, section 5.2.
//!
//! A decoder takes only what is there: a length is checked against the bytes that are left before anything is made of it.

use super::status::{self, Status};
use crate::limits::OPCUA_ELEMENTS_MAX;
use crate::wire;

/// What is left of a message. `None` of its functions: the message is wrong.
#[derive(Clone)]
pub struct Reader<'a>(pub &'a [u8]);

impl<'a> Reader<'a> {
    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        wire::take(&mut self.0, count)
    }

    pub fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        wire::array(&mut self.0)
    }

    pub fn u8(&mut self) -> Option<u8> {
        self.array::<1>().map(|[byte]| byte)
    }

    pub fn bool(&mut self) -> Option<bool> {
        self.u8().map(|byte| byte != 0)
    }

    pub fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn i32(&mut self) -> Option<i32> {
        self.array().map(i32::from_le_bytes)
    }

    pub fn i64(&mut self) -> Option<i64> {
        self.array().map(i64::from_le_bytes)
    }

    pub fn f64(&mut self) -> Option<f64> {
        self.array().map(f64::from_le_bytes)
    }

    /// A ByteString; null is empty.
    pub fn bytes(&mut self) -> Option<&'a [u8]> {
        match self.i32()? {
            ..=-1 => Some(&[]),
            length => self.take(length as usize),
        }
    }

    pub fn text(&mut self) -> Option<String> {
        std::str::from_utf8(self.bytes()?).ok().map(str::to_string)
    }

    /// The number of elements of an array, each of which has at least a byte; null is empty.
    pub fn count(&mut self) -> Option<usize> {
        match self.i32()? {
            ..=-1 => Some(0),
            count => Some(count as usize).filter(|count| *count <= self.0.len().min(OPCUA_ELEMENTS_MAX as usize)),
        }
    }

    /// An array.
    pub fn list<T>(&mut self, read: impl Fn(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        (0..self.count()?).map(|_| read(self)).collect()
    }

    pub fn node(&mut self) -> Option<NodeId> {
        let kind = self.u8()?;
        self.node_of(kind)
    }

    fn node_of(&mut self, kind: u8) -> Option<NodeId> {
        Some(match kind & 0x3F {
            0 => NodeId::number(0, self.u8()?.into()),
            1 => {
                let namespace = self.u8()?;
                NodeId::number(namespace.into(), self.u16()?.into())
            }
            2 => {
                let namespace = self.u16()?;
                NodeId::number(namespace, self.u32()?)
            }
            3 => NodeId { namespace: self.u16()?, id: Id::Text(self.text()?) },
            4 => NodeId { namespace: self.u16()?, id: Id::Guid(self.array()?) },
            5 => NodeId { namespace: self.u16()?, id: Id::Bytes(self.bytes()?.to_vec()) },
            _ => return None,
        })
    }

    /// A qualified name.
    pub fn name(&mut self) -> Option<(u16, String)> {
        Some((self.u16()?, self.text()?))
    }

    pub fn localized(&mut self) -> Option<String> {
        let mask = self.u8()?;
        if mask & 1 != 0 {
            self.text()?;
        }
        if mask & 2 != 0 { self.text() } else { Some(String::new()) }
    }

    /// An ExtensionObject: its encoding, and its body.
    fn extension(&mut self) -> Option<(NodeId, &'a [u8])> {
        let encoding = self.node()?;
        let body = match self.u8()? {
            0 => &[],
            1 | 2 => self.bytes()?,
            _ => return None,
        };
        Some((encoding, body))
    }

    /// An ExtensionObject of the standard: the number of its encoding, and its body.
    pub fn object(&mut self) -> Option<(u32, &'a [u8])> {
        self.extension().map(|(encoding, body)| (encoding.standard().unwrap_or(0), body))
    }

    pub fn scalar(&mut self, ty: u8) -> Option<Scalar> {
        Some(match ty {
            1 => Scalar::Bool(self.bool()?),
            2 => Scalar::SByte(self.u8()? as i8),
            3 => Scalar::Byte(self.u8()?),
            4 => Scalar::Int16(self.u16()? as i16),
            5 => Scalar::UInt16(self.u16()?),
            6 => Scalar::Int32(self.i32()?),
            7 => Scalar::UInt32(self.u32()?),
            8 => Scalar::Int64(self.i64()?),
            9 => Scalar::UInt64(self.i64()? as u64),
            10 => Scalar::Float(self.array().map(f32::from_le_bytes)?),
            11 => Scalar::Double(self.f64()?),
            12 => Scalar::Text(self.text()?),
            13 => Scalar::Time(self.i64()?),
            15 => Scalar::Bytes(self.bytes()?.to_vec()),
            17 => Scalar::Node(self.node()?),
            19 => Scalar::Status(self.u32()?),
            20 => {
                let (namespace, name) = self.name()?;
                Scalar::Name(namespace, name)
            }
            21 => Scalar::Localized(self.localized()?),
            22 => {
                let (encoding, body) = self.extension()?;
                Scalar::Object(encoding, body.to_vec())
            }
            _ => return None,
        })
    }

    /// A variant of the types that a variable of this server can have.
    pub fn variant(&mut self) -> Option<Variant> {
        let head = self.u8()?;
        let ty = head & 0x3F;
        if ty == 0 {
            return Some(Variant::Empty);
        }
        if head & 0x80 == 0 {
            return self.scalar(ty).map(Variant::One);
        }
        let values = self.list(|reader| reader.scalar(ty))?;
        let dimensions = if head & 0x40 != 0 { self.list(Reader::u32)? } else { Vec::new() };
        Some(Variant::Many { ty, values, dimensions })
    }

    /// Value and status of a DataValue. Its times do not matter here.
    pub fn data_value(&mut self) -> Option<(Variant, Status)> {
        let mask = self.u8()?;
        let value = if mask & 1 != 0 { self.variant()? } else { Variant::Empty };
        let status = if mask & 2 != 0 { self.u32()? } else { status::GOOD };
        for (bit, bytes) in [(4, 8), (16, 2), (8, 8), (32, 2)] {
            if mask & bit != 0 {
                self.take(bytes)?;
            }
        }
        Some((value, status))
    }
}

/// The name of a node.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct NodeId {
    pub namespace: u16,
    pub id: Id,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Id {
    Number(u32),
    Text(String),
    Guid([u8; 16]),
    Bytes(Vec<u8>),
}

impl NodeId {
    pub fn number(namespace: u16, number: u32) -> NodeId {
        NodeId { namespace, id: Id::Number(number) }
    }

    pub fn text(namespace: u16, text: impl Into<String>) -> NodeId {
        NodeId { namespace, id: Id::Text(text.into()) }
    }

    /// The number of a node of the standard.
    pub fn standard(&self) -> Option<u32> {
        match (self.namespace, &self.id) {
            (0, Id::Number(number)) => Some(*number),
            _ => None,
        }
    }
}

/// A value without elements.
#[derive(Clone, Debug, PartialEq)]
pub enum Scalar {
    Bool(bool),
    SByte(i8),
    Byte(u8),
    Int16(i16),
    UInt16(u16),
    Int32(i32),
    UInt32(u32),
    Int64(i64),
    UInt64(u64),
    Float(f32),
    Double(f64),
    Text(String),
    /// 100 ns since 1601.
    Time(i64),
    Bytes(Vec<u8>),
    Node(NodeId),
    Status(u32),
    Name(u16, String),
    Localized(String),
    /// The encoding, and the body.
    Object(NodeId, Vec<u8>),
}

impl Scalar {
    /// The number of its type.
    pub fn ty(&self) -> u8 {
        match self {
            Scalar::Bool(_) => 1,
            Scalar::SByte(_) => 2,
            Scalar::Byte(_) => 3,
            Scalar::Int16(_) => 4,
            Scalar::UInt16(_) => 5,
            Scalar::Int32(_) => 6,
            Scalar::UInt32(_) => 7,
            Scalar::Int64(_) => 8,
            Scalar::UInt64(_) => 9,
            Scalar::Float(_) => 10,
            Scalar::Double(_) => 11,
            Scalar::Text(_) => 12,
            Scalar::Time(_) => 13,
            Scalar::Bytes(_) => 15,
            Scalar::Node(_) => 17,
            Scalar::Status(_) => 19,
            Scalar::Name(..) => 20,
            Scalar::Localized(_) => 21,
            Scalar::Object(..) => 22,
        }
    }

    pub fn put(&self, out: &mut Writer) {
        match self {
            Scalar::Bool(value) => out.u8((*value).into()),
            Scalar::SByte(value) => out.u8(*value as u8),
            Scalar::Byte(value) => out.u8(*value),
            Scalar::Int16(value) => out.u16(*value as u16),
            Scalar::UInt16(value) => out.u16(*value),
            Scalar::Int32(value) => out.i32(*value),
            Scalar::UInt32(value) | Scalar::Status(value) => out.u32(*value),
            Scalar::Int64(value) | Scalar::Time(value) => out.i64(*value),
            Scalar::UInt64(value) => out.i64(*value as i64),
            Scalar::Float(value) => out.0.extend(value.to_le_bytes()),
            Scalar::Double(value) => out.f64(*value),
            Scalar::Text(text) => out.text(text),
            Scalar::Bytes(bytes) => out.bytes(bytes),
            Scalar::Node(node) => out.node(node),
            Scalar::Name(namespace, name) => {
                out.u16(*namespace);
                out.text(name);
            }
            Scalar::Localized(text) => out.localized(text),
            Scalar::Object(encoding, body) => {
                out.node(encoding);
                out.u8(1);
                out.bytes(body);
            }
        }
    }

    /// As a number, for deadbands.
    pub fn number(&self) -> Option<f64> {
        Some(match self {
            Scalar::SByte(value) => (*value).into(),
            Scalar::Byte(value) => (*value).into(),
            Scalar::Int16(value) => (*value).into(),
            Scalar::UInt16(value) => (*value).into(),
            Scalar::Int32(value) => (*value).into(),
            Scalar::UInt32(value) => (*value).into(),
            Scalar::Int64(value) => *value as f64,
            Scalar::UInt64(value) => *value as f64,
            Scalar::Float(value) => (*value).into(),
            Scalar::Double(value) => *value,
            _ => return None,
        })
    }
}

/// A value of any type.
#[derive(Clone, Debug, PartialEq)]
pub enum Variant {
    Empty,
    One(Scalar),
    /// Without dimensions: one of them.
    Many {
        ty: u8,
        values: Vec<Scalar>,
        dimensions: Vec<u32>,
    },
}

impl Variant {
    pub fn list(ty: u8, values: Vec<Scalar>) -> Variant {
        Variant::Many { ty, values, dimensions: Vec::new() }
    }
}

/// What was read, when, or why not.
#[derive(Clone, Debug, PartialEq)]
pub struct DataValue {
    pub value: Variant,
    pub status: Status,
    /// 100 ns since 1601.
    pub time: i64,
}

impl DataValue {
    pub fn wrong(status: Status) -> DataValue {
        DataValue { value: Variant::Empty, status, time: 0 }
    }
}

/// A message that grows.
#[derive(Default)]
pub struct Writer(pub Vec<u8>);

impl Writer {
    pub fn u8(&mut self, value: u8) {
        self.0.push(value);
    }

    pub fn u16(&mut self, value: u16) {
        self.0.extend(value.to_le_bytes());
    }

    pub fn u32(&mut self, value: u32) {
        self.0.extend(value.to_le_bytes());
    }

    pub fn i32(&mut self, value: i32) {
        self.0.extend(value.to_le_bytes());
    }

    pub fn i64(&mut self, value: i64) {
        self.0.extend(value.to_le_bytes());
    }

    pub fn f64(&mut self, value: f64) {
        self.0.extend(value.to_le_bytes());
    }

    pub fn bool(&mut self, value: bool) {
        self.u8(value.into());
    }

    pub fn bytes(&mut self, bytes: &[u8]) {
        self.u32(bytes.len() as u32);
        self.0.extend(bytes);
    }

    pub fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }

    /// A text, a ByteString or an array that is not there.
    pub fn null(&mut self) {
        self.i32(-1);
    }

    pub fn node(&mut self, node: &NodeId) {
        match &node.id {
            Id::Number(number) => match (node.namespace, u8::try_from(*number)) {
                (0, Ok(number)) => self.0.extend([0, number]),
                _ => {
                    self.u8(2);
                    self.u16(node.namespace);
                    self.u32(*number);
                }
            },
            Id::Text(text) => {
                self.u8(3);
                self.u16(node.namespace);
                self.text(text);
            }
            Id::Guid(guid) => {
                self.u8(4);
                self.u16(node.namespace);
                self.0.extend(guid);
            }
            Id::Bytes(bytes) => {
                self.u8(5);
                self.u16(node.namespace);
                self.bytes(bytes);
            }
        }
    }

    pub fn localized(&mut self, text: &str) {
        if text.is_empty() {
            return self.u8(0);
        }
        self.u8(2);
        self.text(text);
    }

    pub fn name(&mut self, namespace: u16, name: &str) {
        self.u16(namespace);
        self.text(name);
    }

    /// An ExtensionObject; 0: none.
    pub fn object(&mut self, ty: u32, body: &[u8]) {
        self.node(&NodeId::number(0, ty));
        if ty == 0 {
            return self.u8(0);
        }
        self.u8(1);
        self.bytes(body);
    }

    pub fn list<T>(&mut self, values: &[T], put: impl Fn(&mut Self, &T)) {
        self.u32(values.len() as u32);
        for value in values {
            put(self, value);
        }
    }

    /// Statuses of the operations of a request, and no diagnostics.
    pub fn statuses(&mut self, statuses: &[Status]) {
        self.list(statuses, |out, status| out.u32(*status));
        self.null();
    }

    pub fn variant(&mut self, value: &Variant) {
        match value {
            Variant::Empty => self.u8(0),
            Variant::One(value) => {
                self.u8(value.ty());
                value.put(self);
            }
            Variant::Many { ty, values, dimensions } => {
                let many = dimensions.len() > 1;
                self.u8(ty | 0x80 | if many { 0x40 } else { 0 });
                self.list(values, |out, value| value.put(out));
                if many {
                    self.list(dimensions, |out, length| out.u32(*length));
                }
            }
        }
    }

    /// With the time of the source (0, 2) and of the server (1, 2), as a client asks for them.
    pub fn data_value(&mut self, value: &DataValue, times: u32) {
        let has_value = value.value != Variant::Empty;
        let (source, server) = (has_value && matches!(times, 0 | 2), matches!(times, 1 | 2));
        let bit = |condition: bool, bit: u8| if condition { bit } else { 0 };
        self.u8(bit(has_value, 1) | bit(value.status != status::GOOD, 2) | bit(source, 4) | bit(server, 8));
        if has_value {
            self.variant(&value.value);
        }
        if value.status != status::GOOD {
            self.u32(value.status);
        }
        if source {
            self.i64(value.time);
        }
        if server {
            self.i64(now());
        }
    }
}

/// 100 ns from 1601 to 1970.
const EPOCH: i64 = 116_444_736_000_000_000;

/// Nanoseconds since 1970 as a DateTime.
pub fn time_of(moment: i64) -> i64 {
    moment.div_euclid(100) + EPOCH
}

/// A DateTime as nanoseconds since 1970; `None`: it is too far away.
pub fn moment_of(time: i64) -> Option<i64> {
    time.checked_sub(EPOCH)?.checked_mul(100)
}

/// The clock of this computer.
pub fn now() -> i64 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    time_of(i64::try_from(since.as_nanos()).unwrap_or(0))
}
