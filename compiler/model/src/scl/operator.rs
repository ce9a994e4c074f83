//! Operators, conversions and functions that are computed in place.

/// An operator with one operand; the result has its type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum UnaryOp {
    /// Integers and TIME wrap, floats change sign.
    Negate,
    /// All bits of the type.
    Not,
    /// The smallest integer stays; floats lose their sign.
    Abs,
}

/// Integers wrap; a division by 0 yields 0. The SCL reference, operators, lists what clears the bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BinaryOp {
    Add,
    Subtract,
    Multiply,
    Divide,
    Modulo,
    /// REAL or LREAL.
    Power,
    And,
    Or,
    Xor,
    ShiftLeft,
    /// Fills with the sign if the type is signed.
    ShiftRight,
    RotateLeft,
    RotateRight,
    /// Like Add and Subtract, for a TIME_OF_DAY and milliseconds: modulo 24 hours, which clears the bit. The same for LTOD in nanoseconds.
    AddDay,
    SubtractDay,
    /// The smaller or the greater; NaN yields NaN.
    Min,
    Max,
}

/// Floats: every comparison with NaN is FALSE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CompareOp {
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
}

impl CompareOp {
    /// The comparison with its sides exchanged.
    pub const fn turned(self) -> CompareOp {
        match self {
            CompareOp::Equal => CompareOp::Equal,
            CompareOp::NotEqual => CompareOp::NotEqual,
            CompareOp::Less => CompareOp::Greater,
            CompareOp::LessEqual => CompareOp::GreaterEqual,
            CompareOp::Greater => CompareOp::Less,
            CompareOp::GreaterEqual => CompareOp::LessEqual,
        }
    }
}

/// How a value is converted to another type. The SCL reference, explicit conversions, lists what clears the bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Conversion {
    /// By value: integer to integer (low bits), integer to float, float to float, float to integer (to nearest, ties to even), TIME to
    /// integer and back. Float to integer out of range: see [`Overflow`].
    Value(Overflow),
    /// Like `Value` from a float, towards zero, up, down.
    Truncate(Overflow),
    Ceil(Overflow),
    Floor(Overflow),
    /// The bits: zero-extended from a bit string, sign-extended from a signed integer, truncated to the target. `checked`: lost bits clear the
    /// bit.
    Bits {
        checked: bool,
    },
    /// Anything to BOOL: bit 0; other bits that are 1 clear the bit.
    ToBool,
    /// WORD or DWORD in BCD to INT or DINT; a bad digit is OB 121 16#21 if `fault`, otherwise 0 and the bit cleared.
    FromBcd {
        fault: bool,
    },
    /// INT or DINT to BCD; out of range leaves the pattern and clears the bit.
    ToBcd,
    /// S5TIME to TIME.
    FromS5Time,
    /// TIME to S5TIME: truncated to the time base; out of range clears the bit.
    ToS5Time,
    /// TIME to LTIME, TIME_OF_DAY to LTOD and back: milliseconds and nanoseconds.
    MillisToNanos,
    NanosToMillis,
    /// The pattern stays; out of 0..=`max` clears the bit (DATE, TIME_OF_DAY, LTOD, LDT).
    Ranged {
        max: i64,
    },
}

/// Result of a float to integer conversion that is out of range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Overflow {
    /// S7-300/400: the REAL's own bit pattern, low bits.
    Pattern,
    /// S7-1200/1500: low bits of the rounded value; NaN and infinity 0.
    LowBits,
}

/// Functions that are computed in place. Arguments have the types of their signatures; results the type of the expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Function {
    Sqr,
    Sqrt,
    Exp,
    /// 10 to the x.
    Expd,
    Ln,
    /// To base 10.
    Log,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    /// x minus its integral part.
    Frac,
    /// `(MN, IN, MX)`; MN > MX: IN, and the bit cleared.
    Limit,
    /// `(G, IN0, IN1)`
    Select,
    /// `(K, IN0, …, INn)`; no input for K: the last argument if `has_else`, otherwise 0; both clear the bit.
    Mux {
        has_else: bool,
    },
    /// Bytes in reverse order.
    Swap,
    /// `(MIN, VALUE, MAX)`; the result is a float.
    NormX,
    /// `(MIN, VALUE, MAX)`; VALUE is a float, the rest of the type of the result.
    ScaleX,
    /// Number of the lowest 1; 0 and the bit cleared if there is none.
    Encode,
    /// 1 shifted left by the argument modulo the width.
    Decode,
    /// Number of bits that are 1: an INT.
    BitSum,
    /// Valid float: neither NaN nor infinite; a BOOL.
    IsValid,
}
