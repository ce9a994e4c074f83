//! Sources in SCL.

pub mod expression;
