//! Blocks of the Siemens libraries that are known by name and not shipped yet.
//!
//! Their numbers belong to the user; only their standard names mean them.

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

/// IEC functions, TI-S7 converting blocks and PID blocks. Source: block lists of the standard libraries.
pub const LIBRARY: &[LibraryBlock] = &[
    fc(1, "AD_DT_TM"),
    fc(2, "CONCAT"),
    fc(3, "D_TOD_DT"),
    fc(4, "DELETE"),
    fc(5, "DI_STRNG"),
    fc(6, "DT_DATE"),
    fc(7, "DT_DAY"),
    fc(8, "DT_TOD"),
    fc(9, "EQ_DT"),
    fc(10, "EQ_STRNG"),
    fc(11, "FIND"),
    fc(12, "GE_DT"),
    fc(13, "GE_STRNG"),
    fc(14, "GT_DT"),
    fc(15, "GT_STRNG"),
    fc(16, "I_STRNG"),
    fc(17, "INSERT"),
    fc(18, "LE_DT"),
    fc(19, "LE_STRNG"),
    fc(20, "LEFT"),
    fc(21, "LEN"),
    fc(22, "LIMIT"),
    fc(23, "LT_DT"),
    fc(24, "LT_STRNG"),
    fc(25, "MAX"),
    fc(26, "MID"),
    fc(27, "MIN"),
    fc(28, "NE_DT"),
    fc(29, "NE_STRNG"),
    fc(30, "R_STRNG"),
    fc(31, "REPLACE"),
    fc(32, "RIGHT"),
    fc(33, "S5TI_TIM"),
    fc(34, "SB_DT_DT"),
    fc(35, "SB_DT_TM"),
    fc(36, "SEL"),
    fc(37, "STRNG_DI"),
    fc(38, "STRNG_I"),
    fc(39, "STRNG_R"),
    fc(40, "TIM_S5TI"),
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
    fc(93, "SEG"),
    fc(94, "ATH"),
    fc(95, "HTA"),
    fc(96, "ENCO"),
    fc(97, "DECO"),
    fc(98, "BCDCPL"),
    fc(99, "BITSUM"),
    fc(100, "RSETI"),
    fc(101, "SETI"),
    fc(102, "DEV"),
    fc(103, "CDT"),
    fc(104, "TBL_TBL"),
    fc(105, "SCALE"),
    fc(106, "UNSCALE"),
    fb(41, "CONT_C"),
    fb(42, "CONT_S"),
    fb(43, "PULSEGEN"),
    fb(58, "TCONT_CP"),
    fb(59, "TCONT_S"),
    fb(80, "LEAD_LAG"),
    fb(81, "DCAT"),
    fb(82, "MCAT"),
    fb(83, "IMC"),
    fb(84, "SMC"),
    fb(85, "DRUM"),
    fb(86, "PACK"),
];
