//! Mathematics of REAL instructions: `f32` in, `f32` out, without state.
//!
//! Each function is computed in `f64` and rounded once, which is within 1 ulp of the correctly rounded single result
//! (for sine, cosine and tangent of any finite argument too, as `f64` reduces it exactly). A result that is NaN is always
//! 16#FFFF_FFFF. Source: Statement List (STL), chapter 8 (floating-point math).

/// The bit pattern of every NaN that an instruction produces.
pub const NAN_BITS: u32 = 0xFFFF_FFFF;

/// Rounds to single and makes a NaN the one NaN.
fn single(x: f64) -> f32 {
    if x.is_nan() { f32::from_bits(NAN_BITS) } else { x as f32 }
}

pub fn sin(x: f32) -> f32 {
    single(f64::from(x).sin())
}

pub fn cos(x: f32) -> f32 {
    single(f64::from(x).cos())
}

pub fn tan(x: f32) -> f32 {
    single(f64::from(x).tan())
}

/// -π/2..π/2; NaN outside -1..1.
pub fn asin(x: f32) -> f32 {
    single(f64::from(x).asin())
}

/// 0..π; NaN outside -1..1.
pub fn acos(x: f32) -> f32 {
    single(f64::from(x).acos())
}

pub fn atan(x: f32) -> f32 {
    single(f64::from(x).atan())
}

pub fn exp(x: f32) -> f32 {
    single(f64::from(x).exp())
}

/// Natural logarithm; NaN for `x <= 0`, zero included.
pub fn ln(x: f32) -> f32 {
    if x <= 0.0 { f32::from_bits(NAN_BITS) } else { single(f64::from(x).ln()) }
}

/// Logarithm to base 10; NaN for `x <= 0`.
pub fn log(x: f32) -> f32 {
    single(log_long(f64::from(x)))
}

/// `x` to the power `y`: 0 to the power 0 is 1, 0 to a negative power is infinite, and a negative `x` takes whole exponents only.
///
/// Source: SCL reference, arithmetic operators.
pub fn pow(x: f32, y: f32) -> f32 {
    single(pow_long(f64::from(x), f64::from(y)))
}

/// Makes a NaN the one NaN of LREAL.
pub fn long(x: f64) -> f64 {
    if x.is_nan() { f64::from_bits(u64::MAX) } else { x }
}

pub fn ln_long(x: f64) -> f64 {
    if x <= 0.0 { long(f64::NAN) } else { long(x.ln()) }
}

pub fn log_long(x: f64) -> f64 {
    if x <= 0.0 { long(f64::NAN) } else { long(x.log10()) }
}

pub fn pow_long(x: f64, y: f64) -> f64 {
    // Of a NaN and 0 the host makes 1, and of minus zero and a negative odd exponent minus infinity.
    if x.is_nan() || y.is_nan() {
        return long(f64::NAN);
    }
    if x == 0.0 && y < 0.0 {
        return f64::INFINITY;
    }
    long(x.powf(y))
}
