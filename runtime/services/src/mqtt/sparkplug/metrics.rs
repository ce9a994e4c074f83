//! Values of the program as metrics: their types, both ways.
//!
//! | PLC | Data type | PLC | Data type |
//! | --- | --- | --- | --- |
//! | BOOL | Boolean | SINT, INT, DINT, LINT | Int8 to Int64 |
//! | BYTE, WORD, DWORD, LWORD, USINT to ULINT | UInt8 to UInt64 | REAL, LREAL | Float, Double |
//! | TIME, LTIME | Int32 in ms, Int64 in ns | DT, LDT, DTL | DateTime, in ms |
//! | STRING, WSTRING | String | others | as in OPC UA |

use plcc_abi::ProgramImage;
use plcc_abi::image::AssertType;
use plcc_abi::names::External;
use plcc_runtime::address::{Address, Place, Width};
use plcc_runtime::cpu::Cpu;
use plcc_runtime::names::Limits;
use plcc_runtime::signal::{Signal, Source};
use plcc_runtime::typed::ValueType;

use super::payload::{DataType, Metric, Property, PropertySet, PropertyValue, Value};
use crate::opcua::code::{Scalar, Variant, moment_of, time_of};
use crate::opcua::status::{self, Status};
use crate::opcua::values::{Part, Variable};

const NS_PER_MS: i64 = 1_000_000;

/// A value of the program.
#[derive(Clone, Debug)]
pub struct Tag {
    pub name: String,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    /// In memory, with a type.
    Typed(Variable),
    /// A number that is computed from what is in memory.
    Number(Source),
    /// The program had it before it was changed.
    Gone(DataType),
}

/// A value as it was copied at the cycle control point.
pub enum Copied {
    Bytes(Vec<u8>),
    Number(f64),
    Nothing,
}

impl Tag {
    /// `limits`: of the program.
    pub fn new(signal: Signal, image: &ProgramImage, limits: &Limits) -> Tag {
        let is_fixed = |address: &Address| match address.place {
            Place::Db(number, _) => image.dbs.iter().any(|db| db.number == number && db.read_only),
            _ => false,
        };
        let bits = match &signal.source {
            Source::Typed(address, ty) => (8 * ty.bytes()).max(address.width.bits()),
            source => source.address().map_or(0, |address| address.width.bits()),
        };
        let is_limited = |address: &Address| limits.of(image, address, bits.into()) != External::Write;
        let read_only = signal.source.address().is_some_and(|address| is_fixed(address) || is_limited(address));
        Tag::of(signal, read_only)
    }

    /// A value that is read only, or may be written if its address can be.
    pub fn of(signal: Signal, read_only: bool) -> Tag {
        let of = |address: &Address, ty: ValueType| {
            let bit = if let Width::Bit(bit) = address.width { bit } else { 0 };
            Kind::Typed(Variable { place: address.place, bit, ty, dimensions: Vec::new(), read_only })
        };
        let kind = match &signal.source {
            Source::Bits(address) => of(address, ValueType::of(bits_of(address.width))),
            Source::Typed(address, ty) => of(address, *ty),
            Source::Channel(..)
            | Source::Plant(_)
            | Source::PulseDuty(_)
            | Source::PulsePeriod(_)
            | Source::PulseCount(_) => Kind::Number(signal.source),
        };
        Tag { name: signal.name, kind }
    }

    /// The same in another program.
    pub fn renewed(&self, image: &ProgramImage, limits: &Limits) -> Tag {
        match Source::find(&self.name, image, None) {
            Ok(source) => Tag::new(Signal { name: self.name.clone(), source }, image, limits),
            Err(_) => Tag { name: self.name.clone(), kind: Kind::Gone(self.datatype()) },
        }
    }

    pub fn datatype(&self) -> DataType {
        match &self.kind {
            Kind::Typed(variable) => datatype_of(variable.ty.ty),
            Kind::Number(_) => DataType::Double,
            Kind::Gone(datatype) => *datatype,
        }
    }

    fn is_writable(&self) -> bool {
        match &self.kind {
            Kind::Typed(variable) => variable.is_writable(),
            Kind::Number(_) | Kind::Gone(_) => false,
        }
    }

    /// At the cycle control point.
    pub fn copy(&self, cpu: &Cpu) -> Copied {
        match &self.kind {
            // A data block that the program deletes, for example.
            Kind::Typed(variable) => variable.read(cpu).map_or(Copied::Nothing, Copied::Bytes),
            Kind::Number(source) => source.read(cpu, None).number().map_or(Copied::Nothing, Copied::Number),
            Kind::Gone(_) => Copied::Nothing,
        }
    }

    /// What was copied; `None`: null.
    pub fn value(&self, copied: &Copied) -> Option<Value> {
        match (&self.kind, copied) {
            (Kind::Typed(variable), Copied::Bytes(bytes)) => match variable.value(bytes).ok()? {
                Variant::One(scalar) => value_of(&scalar),
                Variant::Empty | Variant::Many { .. } => None,
            },
            (Kind::Number(_), Copied::Number(number)) => Some(Value::Double(*number)),
            (Kind::Typed(_) | Kind::Number(_) | Kind::Gone(_), _) => None,
        }
    }

    /// The metric of a birth, without its value.
    pub fn birth(&self, alias: u64) -> Metric {
        let property = |datatype: DataType, value| Property { datatype: Some(datatype as u32), value: Some(value) };
        let read_only = property(DataType::Boolean, PropertyValue::Boolean(!self.is_writable()));
        let (mut keys, mut values) = (vec!["readOnly".to_string()], vec![read_only]);
        if let Kind::Typed(variable) = &self.kind {
            keys.push("plcType".to_string());
            let name = plcc_runtime::typed::name(variable.ty.ty).to_string();
            values.push(property(DataType::String, PropertyValue::Text(name)));
        }
        Metric {
            name: Some(self.name.clone()),
            alias: Some(alias),
            datatype: Some(self.datatype() as u32),
            properties: Some(PropertySet { keys, values }),
            ..Metric::default()
        }
    }

    /// A value of a command on its way into memory. `Err`: why it cannot go there.
    pub fn parts(&self, metric: &Metric) -> Result<(Variable, Vec<Part>), String> {
        let Kind::Typed(variable) = &self.kind else { return Err("it cannot be written".to_string()) };
        if !variable.is_writable() {
            return Err("it cannot be written".to_string());
        }
        let own = self.datatype();
        if metric.datatype.is_some_and(|given| given != 0 && given != own as u32) {
            return Err(format!("its data type is {own:?}"));
        }
        let value = metric.value.as_ref().filter(|_| metric.is_null != Some(true)).ok_or("the command has no value")?;
        let scalar = scalar_of(own, value).ok_or_else(|| format!("the value is not of the data type {own:?}"))?;
        let parts = variable.parts(&Variant::One(scalar), None).map_err(|status| refused(status).to_string())?;
        Ok((variable.clone(), parts))
    }
}

/// Why a value was not written.
pub fn refused(status: Status) -> &'static str {
    match status {
        status::OUT_OF_RANGE => "its type does not have this value",
        status::TYPE_MISMATCH => "the value has another type",
        status::NOT_FOUND => "it is not there",
        _ => "it cannot be written",
    }
}

fn bits_of(width: Width) -> AssertType {
    match width {
        Width::Bit(_) => AssertType::Bool,
        Width::Byte => AssertType::Bits(8),
        Width::Word => AssertType::Bits(16),
        Width::Dword => AssertType::Bits(32),
        Width::Lword => AssertType::Bits(64),
    }
}

/// By the type of the value in OPC UA.
fn datatype_of(ty: AssertType) -> DataType {
    match crate::opcua::values::type_of(ty) {
        1 => DataType::Boolean,
        2 => DataType::Int8,
        3 => DataType::UInt8,
        4 => DataType::Int16,
        5 => DataType::UInt16,
        6 => DataType::Int32,
        7 => DataType::UInt32,
        8 => DataType::Int64,
        9 => DataType::UInt64,
        10 => DataType::Float,
        11 => DataType::Double,
        12 => DataType::String,
        _ => DataType::DateTime,
    }
}

fn value_of(scalar: &Scalar) -> Option<Value> {
    Some(match scalar {
        Scalar::Bool(value) => Value::Boolean(*value),
        Scalar::SByte(value) => Value::Int(u32::from(*value as u8)),
        Scalar::Byte(value) => Value::Int((*value).into()),
        Scalar::Int16(value) => Value::Int(u32::from(*value as u16)),
        Scalar::UInt16(value) => Value::Int((*value).into()),
        Scalar::Int32(value) => Value::Int(*value as u32),
        Scalar::UInt32(value) => Value::Int(*value),
        Scalar::Int64(value) => Value::Long(*value as u64),
        Scalar::UInt64(value) => Value::Long(*value),
        Scalar::Float(value) => Value::Float(*value),
        Scalar::Double(value) => Value::Double(*value),
        Scalar::Text(text) => Value::Text(text.clone()),
        Scalar::Time(time) => Value::Long(moment_of(*time)?.div_euclid(NS_PER_MS) as u64),
        Scalar::Bytes(_)
        | Scalar::Node(_)
        | Scalar::Status(_)
        | Scalar::Name(..)
        | Scalar::Localized(_)
        | Scalar::Object(..) => return None,
    })
}

/// A whole number with a sign, of so many bits: in two's complement of this width, or of the field that carries it.
fn signed(value: &Value, bits: u32) -> Option<i32> {
    let raw = unsigned(value, 32)?;
    let own = ((raw << (32 - bits)) as i32) >> (32 - bits);
    let fits = u64::from(raw) < 1 << bits || raw == own as u32;
    fits.then_some(own)
}

/// A whole number without a sign. Some clients put 32 bits into the long field.
fn unsigned(value: &Value, bits: u32) -> Option<u32> {
    let raw = match value {
        Value::Int(raw) => *raw,
        Value::Long(raw) => u32::try_from(*raw).ok()?,
        Value::Float(_) | Value::Double(_) | Value::Boolean(_) | Value::Text(_) => return None,
    };
    // A sign that fills the field is judged by `signed`.
    (bits == 32 || raw >> bits == 0).then_some(raw)
}

/// `None`: the value is of another type, or too large for this one.
fn scalar_of(datatype: DataType, value: &Value) -> Option<Scalar> {
    Some(match (datatype, value) {
        (DataType::Boolean, Value::Boolean(value)) => Scalar::Bool(*value),
        (DataType::Float, Value::Float(value)) => Scalar::Float(*value),
        (DataType::Double, Value::Double(value)) => Scalar::Double(*value),
        (DataType::String, Value::Text(text)) => Scalar::Text(text.clone()),
        (DataType::Int64, Value::Long(value)) => Scalar::Int64(*value as i64),
        (DataType::UInt64, Value::Long(value)) => Scalar::UInt64(*value),
        (DataType::UInt64, Value::Int(value)) => Scalar::UInt64((*value).into()),
        (DataType::DateTime, Value::Long(ms)) => Scalar::Time(time_of((*ms as i64).checked_mul(NS_PER_MS)?)),
        (DataType::Int8, value) => Scalar::SByte(signed(value, 8)? as i8),
        (DataType::Int16, value) => Scalar::Int16(signed(value, 16)? as i16),
        (DataType::Int32, value) => Scalar::Int32(signed(value, 32)?),
        (DataType::UInt8, value) => Scalar::Byte(unsigned(value, 8)? as u8),
        (DataType::UInt16, value) => Scalar::UInt16(unsigned(value, 16)? as u16),
        (DataType::UInt32, value) => Scalar::UInt32(unsigned(value, 32)?),
        (
            DataType::Boolean
            | DataType::Float
            | DataType::Double
            | DataType::String
            | DataType::Int64
            | DataType::UInt64
            | DataType::DateTime,
            _,
        ) => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_with_a_sign_have_two_forms() {
        for (datatype, value, scalar) in [
            (DataType::Int8, Value::Int(0xFE), Scalar::SByte(-2)),
            (DataType::Int8, Value::Int(0xFFFF_FFFE), Scalar::SByte(-2)),
            (DataType::Int16, Value::Int(0x8000), Scalar::Int16(i16::MIN)),
            (DataType::Int32, Value::Int(u32::MAX), Scalar::Int32(-1)),
            (DataType::UInt32, Value::Long(u32::MAX.into()), Scalar::UInt32(u32::MAX)),
            (DataType::UInt64, Value::Long(u64::MAX), Scalar::UInt64(u64::MAX)),
            (DataType::Int64, Value::Long(u64::MAX), Scalar::Int64(-1)),
            (DataType::DateTime, Value::Long(0), Scalar::Time(time_of(0))),
        ] {
            assert_eq!(scalar_of(datatype, &value), Some(scalar), "{datatype:?} {value:?}");
        }
        for (datatype, value) in [
            (DataType::Int8, Value::Int(0x100)),
            (DataType::Int16, Value::Int(0xFFFE_8000)),
            (DataType::UInt8, Value::Int(256)),
            (DataType::UInt32, Value::Long(1 << 32)),
            (DataType::Int32, Value::Boolean(true)),
            (DataType::Boolean, Value::Int(1)),
            (DataType::Float, Value::Double(1.0)),
            (DataType::DateTime, Value::Long(u64::MAX / 2)),
        ] {
            assert_eq!(scalar_of(datatype, &value), None, "{datatype:?} {value:?}");
        }
    }

    #[test]
    fn what_is_written_is_what_is_read() {
        for scalar in [
            Scalar::SByte(-128),
            Scalar::Int16(-1),
            Scalar::Int32(i32::MIN),
            Scalar::Int64(i64::MIN),
            Scalar::UInt64(u64::MAX),
            Scalar::Text("ü".to_string()),
            Scalar::Time(time_of(1_700_000_000_123_000_000)),
        ] {
            let datatype = match scalar.ty() {
                2 => DataType::Int8,
                4 => DataType::Int16,
                6 => DataType::Int32,
                8 => DataType::Int64,
                9 => DataType::UInt64,
                12 => DataType::String,
                _ => DataType::DateTime,
            };
            assert_eq!(scalar_of(datatype, &value_of(&scalar).unwrap()), Some(scalar));
        }
    }
}
