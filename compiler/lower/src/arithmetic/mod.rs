//! Arithmetic that languages share, as functions over the IR builder. They return a value and what went wrong, as i1; a language
//! decides what becomes of it: status bits in STL, OK/ENO in SCL, bits of SM1 and ENO in an S7-200.
//!
//! - `integer`: sums, products and quotients that may not fit. `float`: what a REAL or LREAL result is, ranges of conversions.
//!   `rounding`: those conversions to at most 32 bits.
//! - `compare`: conditions of both. `bits`: shifts and rotates with the last bit out, numbers of bits. `bcd`: BCD numbers.

pub mod bcd;
pub mod bits;
pub mod compare;
pub mod float;
pub mod integer;
pub mod rounding;
