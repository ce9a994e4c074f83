//! Names of the elementary data types.

/// Elementary types of all CPUs; the profiles say which CPU has which.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Elementary {
    Bool,
    Byte,
    Word,
    Dword,
    Lword,
    Char,
    /// A character of two bytes.
    Wchar,
    Sint,
    Usint,
    Int,
    Uint,
    Dint,
    Udint,
    Lint,
    Ulint,
    Real,
    Lreal,
    S5Time,
    /// Milliseconds, signed.
    Time,
    /// Nanoseconds, signed.
    Ltime,
    /// Days since 1990-01-01.
    Date,
    /// Milliseconds since midnight.
    TimeOfDay,
    /// Nanoseconds since midnight.
    Ltod,
    /// Nanoseconds since 1970-01-01.
    Ldt,
}

/// The kind of values of a type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Class {
    /// BOOL, BYTE, WORD, DWORD, LWORD.
    Bits,
    Signed,
    Unsigned,
    Float,
    /// CHAR, WCHAR.
    Character,
    /// S5TIME, TIME, LTIME.
    Duration,
    /// DATE, TIME_OF_DAY, LTOD, LDT.
    Date,
}

impl Elementary {
    pub const ALL: [Elementary; 24] = [
        Elementary::Bool,
        Elementary::Byte,
        Elementary::Word,
        Elementary::Dword,
        Elementary::Lword,
        Elementary::Char,
        Elementary::Wchar,
        Elementary::Sint,
        Elementary::Usint,
        Elementary::Int,
        Elementary::Uint,
        Elementary::Dint,
        Elementary::Udint,
        Elementary::Lint,
        Elementary::Ulint,
        Elementary::Real,
        Elementary::Lreal,
        Elementary::S5Time,
        Elementary::Time,
        Elementary::Ltime,
        Elementary::Date,
        Elementary::TimeOfDay,
        Elementary::Ltod,
        Elementary::Ldt,
    ];

    /// Size in bits; 1 for BOOL.
    pub const fn bits(self) -> u32 {
        match self {
            Elementary::Bool => 1,
            Elementary::Byte | Elementary::Char | Elementary::Sint | Elementary::Usint => 8,
            Elementary::Word
            | Elementary::Wchar
            | Elementary::Int
            | Elementary::Uint
            | Elementary::S5Time
            | Elementary::Date => 16,
            Elementary::Dword
            | Elementary::Dint
            | Elementary::Udint
            | Elementary::Real
            | Elementary::Time
            | Elementary::TimeOfDay => 32,
            Elementary::Lword
            | Elementary::Lint
            | Elementary::Ulint
            | Elementary::Lreal
            | Elementary::Ltime
            | Elementary::Ltod
            | Elementary::Ldt => 64,
        }
    }

    pub const fn class(self) -> Class {
        match self {
            Elementary::Bool | Elementary::Byte | Elementary::Word | Elementary::Dword | Elementary::Lword => {
                Class::Bits
            }
            Elementary::Sint | Elementary::Int | Elementary::Dint | Elementary::Lint => Class::Signed,
            Elementary::Usint | Elementary::Uint | Elementary::Udint | Elementary::Ulint => Class::Unsigned,
            Elementary::Real | Elementary::Lreal => Class::Float,
            Elementary::Char | Elementary::Wchar => Class::Character,
            Elementary::S5Time | Elementary::Time | Elementary::Ltime => Class::Duration,
            Elementary::Date | Elementary::TimeOfDay | Elementary::Ltod | Elementary::Ldt => Class::Date,
        }
    }

    /// True for the types of the S7-300 and S7-400; the S7-1200 and S7-1500 have the others as well.
    pub const fn is_of_s7300(self) -> bool {
        match self {
            Elementary::Bool
            | Elementary::Byte
            | Elementary::Word
            | Elementary::Dword
            | Elementary::Char
            | Elementary::Int
            | Elementary::Dint
            | Elementary::Real
            | Elementary::S5Time
            | Elementary::Time
            | Elementary::Date
            | Elementary::TimeOfDay => true,
            Elementary::Lword
            | Elementary::Wchar
            | Elementary::Sint
            | Elementary::Usint
            | Elementary::Uint
            | Elementary::Udint
            | Elementary::Lint
            | Elementary::Ulint
            | Elementary::Lreal
            | Elementary::Ltime
            | Elementary::Ltod
            | Elementary::Ldt => false,
        }
    }

    /// SINT, USINT and the other integers.
    pub const fn is_integer(self) -> bool {
        matches!(self.class(), Class::Signed | Class::Unsigned)
    }

    /// REAL and LREAL.
    pub const fn is_float(self) -> bool {
        matches!(self.class(), Class::Float)
    }

    /// True if the order of values is that of signed numbers.
    pub const fn is_signed(self) -> bool {
        matches!(self.class(), Class::Signed) || matches!(self, Elementary::Time | Elementary::Ltime)
    }

    pub const fn name(self) -> &'static str {
        match self {
            Elementary::Bool => "BOOL",
            Elementary::Byte => "BYTE",
            Elementary::Word => "WORD",
            Elementary::Dword => "DWORD",
            Elementary::Lword => "LWORD",
            Elementary::Char => "CHAR",
            Elementary::Wchar => "WCHAR",
            Elementary::Sint => "SINT",
            Elementary::Usint => "USINT",
            Elementary::Int => "INT",
            Elementary::Uint => "UINT",
            Elementary::Dint => "DINT",
            Elementary::Udint => "UDINT",
            Elementary::Lint => "LINT",
            Elementary::Ulint => "ULINT",
            Elementary::Real => "REAL",
            Elementary::Lreal => "LREAL",
            Elementary::S5Time => "S5TIME",
            Elementary::Time => "TIME",
            Elementary::Ltime => "LTIME",
            Elementary::Date => "DATE",
            Elementary::TimeOfDay => "TIME_OF_DAY",
            Elementary::Ltod => "LTOD",
            Elementary::Ldt => "LDT",
        }
    }

    /// The type that a word names, in upper case; `TOD`, `LTIME_OF_DAY`, `DATE_AND_LTIME` and `LDATE_AND_TIME` too.
    pub fn from_word(word: &str) -> Option<Elementary> {
        match word {
            "TOD" => Some(Elementary::TimeOfDay),
            "LTIME_OF_DAY" => Some(Elementary::Ltod),
            "DATE_AND_LTIME" | "LDATE_AND_TIME" => Some(Elementary::Ldt),
            _ => Elementary::ALL.into_iter().find(|ty| ty.name() == word),
        }
    }
}
