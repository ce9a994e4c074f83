//! Blocks of the Siemens libraries that are known by name but not included yet.
//!
//! Their numbers belong to the user; only their standard names refer to them.

/// A function (FC) or function block (FB) of a library.
#[derive(Clone, Copy, Debug)]
pub struct LibraryBlock {
    pub fb: bool,
    pub number: u16,
    /// Standard name, `SCALE`.
    pub name: &'static str,
}

const fn fc(number: u16, name: &'static str) -> LibraryBlock {
    LibraryBlock { fb: false, number, name }
}

const fn fb(number: u16, name: &'static str) -> LibraryBlock {
    LibraryBlock { fb: true, number, name }
}

/// TI-S7 converting blocks. Source: block lists of the standard libraries.
pub const LIBRARY: &[LibraryBlock] = &[
    fc(80, "TONR"),
    fc(81, "IBLKMOV"),
    fc(82, "RSET"),
    fc(83, "SET"),
    fc(84, "ATT"),
    fc(85, "FIFO"),
    fc(86, "TBL_FIND"),
    fc(87, "LIFO"),
    fc(88, "TBL"),
    fc(89, "TBL_WRD"),
    fc(90, "WSR"),
    fc(91, "WRD_TBL"),
    fc(92, "SHRB"),
    fc(94, "ATH"),
    fc(95, "HTA"),
    fc(100, "RSETI"),
    fc(101, "SETI"),
    fc(102, "DEV"),
    fc(103, "CDT"),
    fc(104, "TBL_TBL"),
    fb(86, "PACK"),
];
