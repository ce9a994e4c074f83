//! Functions of texts that generated code calls with addresses: how operands and results travel.
//!
//! A text operand is an offset from the memory base. The first argument of these functions has [`OPERAND_BITS`] bits for each text operand, in
//! their order, the first operand lowest. Their low half says how many characters exist there, 254 if there are more, since a data block may end before
//! the STRING that its head describes; or that the text is in local data ([`LOCAL`]), which the runtime knows the end of. Their high half is
//! the declared maximum, 0 if it is not known: a variable with this maximum in its head exists as a whole.
//!
//! The result has the value in its low half, [`BR`] and [`WRITTEN`] above it.

/// Bits for one operand.
pub const OPERAND_BITS: u32 = 16;
/// More characters do not matter.
pub const ROOM_MAX: u32 = 254;
/// The text is in local data.
pub const LOCAL: u8 = 255;
/// All is well.
pub const BR: u64 = 1 << 32;
/// The function has a value; without it, the variable for the value stays as it is.
pub const WRITTEN: u64 = 1 << 33;

/// FORM of numbers as text: `+` before numbers that are not negative.
pub const PLUS: u16 = 1;
/// FORM of numbers as text: the number is a ULINT.
pub const UNSIGNED: u16 = 2;

/// Whose special cases a function has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rules {
    /// FC 2 to FC 32 of STEP 7 V5.
    V5,
    /// Instructions of the TIA Portal.
    Tia,
}

impl Rules {
    /// By the parameter RULES of the functions: 0 or 1.
    pub fn of(parameter: u16) -> Rules {
        if parameter == 0 { Rules::V5 } else { Rules::Tia }
    }
}
