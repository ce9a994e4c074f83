//! Constants as values, the same for every language.

/// A constant with its type. Values are already range-checked.
#[derive(Clone, Debug, PartialEq)]
pub enum Literal {
    Bool(bool),
    /// `930`, `-5`: a decimal integer without a type; its width comes from the place.
    Int(i64),
    /// `L#930`.
    Dint(i32),
    /// `B#16#1E`.
    Byte(u8),
    /// `W#16#3A2F`.
    Word(u16),
    /// `DW#16#2C1E_A2EB`.
    Dword(u32),
    /// `16#1E`, `2#1010`: bits without a type; `digits` is the number of bits written (4 for each hex digit).
    Bits {
        value: u32,
        digits: u8,
    },
    /// `B#(1,8)`.
    Bytes2([u8; 2]),
    /// `B#(1,14,100,120)`.
    Bytes4([u8; 4]),
    Real(f32),
    /// `S5T#2s`: time base and BCD value.
    S5Time(u16),
    /// `T#1s`: milliseconds.
    Time(i32),
    /// `D#2000-6-20`: days since 1990-01-01.
    Date(u16),
    /// `TOD#5:45:00`: milliseconds since midnight.
    TimeOfDay(u32),
    /// `DT#...`: eight BCD bytes.
    DateAndTime([u8; 8]),
    /// `C#20`: BCD value.
    Counter(u16),
    /// `'ABCD'`: bytes of the text with escapes expanded, in Windows-1252.
    Text(Vec<u8>),
    /// `P#10.3`: area-internal pointer, as the 32 bits that `L` gives.
    Pointer(u32),
    /// `P#M 10.0`, `P#DBX 0.0`, `P#DB10.DBX 20.0`: area-crossing pointer as 32 bits; `db` 0 if no DB is named.
    AreaPointer {
        db: u16,
        pointer: u32,
    },
    /// `P#DB11.DBX 20.0 INT 10`: the ten bytes of an ANY.
    Any([u8; 10]),
}
