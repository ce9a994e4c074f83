//! The types that STL can declare, each with the values of its sample.

use Class::{Bit, Complex, Number};

/// How a value of a type is read and written.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Class {
    Bit,
    /// By `L` and `T`.
    Number,
    /// As a whole by SFC 20 alone.
    Complex,
}

/// A type with what a sample of it has.
pub struct Kind {
    pub name: &'static str,
    pub class: Class,
    pub bytes: u32,
    /// All components with their classes and values. Bytes of a component that is itself complex are in `Complex`.
    pub leaves: &'static [(&'static str, Class, &'static str)],
}

const fn kind(
    name: &'static str,
    class: Class,
    bytes: u32,
    leaves: &'static [(&'static str, Class, &'static str)],
) -> Kind {
    Kind { name, class, bytes, leaves }
}

/// The types, from the smallest to those made of others.
pub const TYPES: &[Kind] = &[
    kind("BOOL", Bit, 1, &[("", Bit, "TRUE")]),
    kind("BYTE", Number, 1, &[("", Number, "B#16#A5")]),
    kind("CHAR", Number, 1, &[("", Number, "'x'")]),
    kind("WORD", Number, 2, &[("", Number, "W#16#A55A")]),
    kind("INT", Number, 2, &[("", Number, "-30000")]),
    kind("S5TIME", Number, 2, &[("", Number, "S5T#2s340ms")]),
    kind("DATE", Number, 2, &[("", Number, "D#2024-2-29")]),
    kind("DWORD", Number, 4, &[("", Number, "DW#16#A55A_1234")]),
    kind("DINT", Number, 4, &[("", Number, "L#-2000000000")]),
    kind("REAL", Number, 4, &[("", Number, "-1.25")]),
    kind("TIME", Number, 4, &[("", Number, "T#-1h")]),
    kind("TIME_OF_DAY", Number, 4, &[("", Number, "TOD#12:34:56.789")]),
    kind("DATE_AND_TIME", Complex, 8, &[("", Complex, "DT#2024-2-29-12:34:56.789")]),
    kind("STRING", Complex, 256, &[("", Complex, "'a text'")]),
    kind("STRING [7]", Complex, 10, &[("", Complex, "'seven c'")]),
    kind("ARRAY [1..3] OF INT", Complex, 6, &[("[1]", Number, "7"), ("[2]", Number, "8"), ("[3]", Number, "-7")]),
    kind(
        "ARRAY [0..15] OF BOOL",
        Complex,
        2,
        &[("[0]", Bit, "TRUE"), ("[7]", Bit, "TRUE"), ("[8]", Bit, "TRUE"), ("[15]", Bit, "TRUE")],
    ),
    kind(
        "ARRAY [-1..3] OF BYTE",
        Complex,
        6,
        &[
            ("[-1]", Number, "B#16#11"),
            ("[0]", Number, "B#16#22"),
            ("[1]", Number, "B#16#33"),
            ("[2]", Number, "B#16#44"),
            ("[3]", Number, "B#16#55"),
        ],
    ),
    kind(
        "ARRAY [0..1, 1..2] OF REAL",
        Complex,
        16,
        &[("[0, 1]", Number, "1.5"), ("[0, 2]", Number, "2.5"), ("[1, 1]", Number, "3.5"), ("[1, 2]", Number, "-4.5")],
    ),
    kind("ARRAY [1..2] OF STRING [5]", Complex, 16, &[("[1]", Complex, "'ab'"), ("[2]", Complex, "'abcde'")]),
    kind(
        "ARRAY [1..2] OF DATE_AND_TIME",
        Complex,
        16,
        &[("[1]", Complex, "DT#2024-2-29-12:34:56.789"), ("[2]", Complex, "DT#1999-12-31-23:59:59.999")],
    ),
    kind(
        "STRUCT a : BOOL; b : DINT; c : BYTE; END_STRUCT",
        Complex,
        8,
        &[(".a", Bit, "TRUE"), (".b", Number, "L#123456789"), (".c", Number, "B#16#7F")],
    ),
    kind(
        "UDT 1",
        Complex,
        26,
        &[
            (".a", Number, "-3"),
            (".b", Number, "2.5"),
            (".c", Bit, "TRUE"),
            (".d", Number, "B#16#99"),
            (".t", Complex, "'uvwxyz'"),
            (".l[0]", Number, "DW#16#1234_5678"),
            (".l[1]", Number, "DW#16#9ABC_DEF0"),
            (".e", Number, "'z'"),
        ],
    ),
    kind(
        "ARRAY [1..2] OF UDT 1",
        Complex,
        52,
        &[
            ("[1].a", Number, "-3"),
            ("[1].t", Complex, "'uvw'"),
            ("[2].b", Number, "0.125"),
            ("[2].c", Bit, "TRUE"),
            ("[2].l[1]", Number, "DW#16#9ABC_DEF0"),
            ("[2].e", Number, "'q'"),
        ],
    ),
];
