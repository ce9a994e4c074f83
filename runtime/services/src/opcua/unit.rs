//! Units of values: the property EngineeringUnits. Source: OPC 10000-8, section 5.6.4; UNECE recommendation 20.

use plcc_abi::image::AssertType;

use super::code::{NodeId, Scalar, Writer};

/// Name of the property.
pub const NAME: &str = "EngineeringUnits";
/// Number of the type EUInformation, and of its encoding.
pub const TYPE: u32 = 887;
const ENCODING: u32 = 889;

/// What a number counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit {
    /// Its code of three letters.
    code: [u8; 3],
    short: &'static str,
    name: &'static str,
}

const MILLISECOND: Unit = Unit { code: *b"C26", short: "ms", name: "millisecond" };
const NANOSECOND: Unit = Unit { code: *b"C45", short: "ns", name: "nanosecond" };
const DAY: Unit = Unit { code: *b"DAY", short: "d", name: "day" };

impl Unit {
    /// `None`: numbers of this type count nothing in particular.
    pub fn of(ty: AssertType) -> Option<Unit> {
        match ty {
            AssertType::Time | AssertType::TimeOfDay => Some(MILLISECOND),
            AssertType::Ltime | AssertType::Ltod => Some(NANOSECOND),
            AssertType::Date => Some(DAY),
            _ => None,
        }
    }

    /// EUInformation.
    pub fn value(self) -> Scalar {
        let [a, b, c] = self.code;
        let mut out = Writer::default();
        out.text("http://www.opcfoundation.org/UA/units/un/cefact");
        out.i32(i32::from_be_bytes([0, a, b, c]));
        out.localized(self.short);
        out.localized(self.name);
        Scalar::Object(NodeId::number(0, ENCODING), out.0)
    }
}
