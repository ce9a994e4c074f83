//! Instructions of the TIA Portal that plcc knows by name only.

/// Functions that the tools of the vendor have and plcc has not, unless a block of the standard library is called so.
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
    "MB_CLIENT",
    "MB_SERVER",
    "PUT",
    "GET",
    "DB_ANY_TO_VARIANT",
    "VARIANT_TO_DB_ANY",
    "VARIANT_TO_ANY",
    "DB_ANY_TO_UINT",
    "UINT_TO_DB_ANY",
    "SEG",
    "BCDCPL",
    "GETIO",
    "SETIO",
    "DPRD_DAT",
    "DPWR_DAT",
    "RDREC",
    "WRREC",
    "DeviceStates",
    "ModuleStates",
    "LED",
    "GET_DIAG",
    "Program_Alarm",
];

/// True of a function that plcc knows by name only.
pub fn not_supported(name: &str) -> bool {
    NOT_SUPPORTED.iter().any(|known| known.eq_ignore_ascii_case(name.trim()))
}
