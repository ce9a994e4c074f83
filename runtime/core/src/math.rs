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

/// -π/2..π/2; NaN outside of -1..1.
pub fn asin(x: f32) -> f32 {
    single(f64::from(x).asin())
}

/// 0..π; NaN outside of -1..1.
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
