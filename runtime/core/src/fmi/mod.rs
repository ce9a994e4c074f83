//! A CPU as a unit of a co-simulation, by the Functional Mock-up Interface.
//!
//! - [`variables`]: what a unit shows of its program. The model description and the unit itself use the same list, in
//!   which a variable is known by its place.
//! - [`instance`]: a CPU that is stepped from outside, whose variables are read and set.
//! - `abi`: the functions that a simulator calls, version 2.0 and 3.0.
//!
//! Instances are independent: they share the code, and each has its own memory and its own virtual clock.

#[cfg(all(feature = "executable", not(test)))]
mod abi;
pub mod instance;
pub mod variables;

use plcc_abi::ProgramImage;

/// Identifies a program: a simulator passes it from the model description to the unit, which refuses that of another program. FNV-1a of
/// the description, written as a GUID.
pub fn token(image: &ProgramImage) -> String {
    const OFFSET: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    let bytes = postcard::to_stdvec(image).unwrap_or_default();
    let hash = bytes.iter().fold(OFFSET, |hash, byte| (hash ^ u128::from(*byte)).wrapping_mul(PRIME));
    let digits = format!("{hash:032x}");
    let parts = [&digits[..8], &digits[8..12], &digits[12..16], &digits[16..20], &digits[20..]];
    format!("{{{}}}", parts.join("-"))
}
