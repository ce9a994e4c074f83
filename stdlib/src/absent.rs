//! Instructions of the TIA Portal of which plcc only knows the name.

/// Functions that the vendor's tools have but plcc does not, unless a block of the standard library has the name.
pub const NOT_SUPPORTED: &[&str] = &[
    "ReadFromArrayDB",
    "WriteToArrayDB",
    "ReadFromArrayDBL",
    "WriteToArrayDBL",
    "GET_ERROR",
    "GET_ERR_ID",
    "ENDIS_PW",
    "INIT_RD",
    "RUNTIME",
    "JOIN",
    "SPLIT",
    "ATTACH",
    "DETACH",
    "DB_ANY_TO_VARIANT",
    "VARIANT_TO_DB_ANY",
    "VARIANT_TO_ANY",
    "SEG",
    "BCDCPL",
    "GETIO",
    "SETIO",
    "DPRD_DAT",
    "DPWR_DAT",
    "DeviceStates",
    "ModuleStates",
    "LED",
    "GET_DIAG",
];

/// True of a function of which plcc only knows the name.
pub fn not_supported(name: &str) -> bool {
    NOT_SUPPORTED.iter().any(|known| known.eq_ignore_ascii_case(name.trim()))
}
