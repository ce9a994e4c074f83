//! Conversions, and statements as they are bound.
