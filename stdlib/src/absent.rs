//! Instructions of the TIA Portal of which plcc only knows the name.

/// Functions that the vendor's tools have but plcc does not, unless a block of the standard library has the name.
pub const NOT_SUPPORTED: &[&str] =
    &["ReadFromArrayDBL", "WriteToArrayDBL", "INIT_RD", "JOIN", "SPLIT", "VARIANT_TO_ANY"];

/// True of a function of which plcc only knows the name.
pub fn not_supported(name: &str) -> bool {
    NOT_SUPPORTED.iter().any(|known| known.eq_ignore_ascii_case(name.trim()))
}
