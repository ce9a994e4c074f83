//! Errors at run time, with their texts. Source: S7-200 system manual, error codes.

macro_rules! errors {
    ($( $name:ident = $code:literal, $text:literal; )*) => {
        $( pub const $name: u16 = $code; )*

        /// Codes and texts, by code.
        pub const TEXTS: &[(u16, &str)] = &[ $( ($name, $text) ),* ];

        /// Text of an error; `None`: there is no such error.
        pub fn text(code: u16) -> Option<&'static str> {
            TEXTS.iter().find(|(known, _)| *known == code).map(|(_, text)| *text)
        }
    };
}

/// Non-fatal errors: the instruction does nothing, ENO is 0, SM4.3 is 1.
pub mod error {
    errors! {
        HSC_BEFORE_HDEF = 0x0001, "HSC executed before HDEF";
        EVENT_INPUT_IS_HSC = 0x0002, "input of the event is used by a high-speed counter";
        HSC_INPUT_TAKEN = 0x0003, "input of the high-speed counter is used by an interrupt or another counter";
        NOT_IN_INTERRUPT = 0x0004, "instruction is not allowed in an interrupt routine";
        SIMULTANEOUS_HSC = 0x0005, "second HSC or PLS before the first one has ended";
        INDIRECT_ADDRESS = 0x0006, "indirect addressing error";
        CLOCK_DATA = 0x0007, "data error of TODR or TODW";
        NESTING = 0x0008, "subroutines nested too deeply";
        PORT_0_BUSY = 0x0009, "simultaneous XMT and RCV on port 0";
        HDEF_REPEATED = 0x000A, "HDEF repeated for the same counter";
        PORT_1_BUSY = 0x000B, "simultaneous XMT and RCV on port 1";
        NO_CLOCK = 0x000C, "no clock";
        PULSE_OUTPUT_ACTIVE = 0x000D, "redefinition of an active pulse output";
        NO_SEGMENTS = 0x000E, "number of PTO segments is 0";
        ILLEGAL_REAL = 0x000F, "illegal REAL in a compare contact";
        PTO_MODE = 0x0010, "command is not allowed in this PTO mode";
        PTO_COMMAND = 0x0011, "illegal PTO command";
        PTO_PROFILE = 0x0012, "illegal PTO profile table";
        PID_TABLE = 0x0013, "illegal PID loop table";
        RANGE = 0x0091, "operand out of range";
        COUNT = 0x0092, "count out of range";
        PERMANENT_RANGE = 0x0094, "range error on writing to permanent memory";
        FREEPORT_IN_INTERRUPT = 0x009A, "change to Freeport in an interrupt routine";
        INDEX = 0x009B, "illegal index";
        NO_CARTRIDGE = 0x009F, "memory cartridge is missing";
    }
}

/// Fatal errors: the CPU goes to STOP.
pub mod fatal {
    /// Number of the event that stops the CPU, with the code of the error in its low byte.
    pub const EVENT: u16 = 0xFA00;

    errors! {
        WATCHDOG = 0x0003, "scan watchdog expired";
        INTERNAL = 0x0010, "internal software error";
        COMPARE_ADDRESS = 0x0011, "compare contact: bad indirect address";
        COMPARE_REAL = 0x0012, "compare contact: illegal REAL";
        COMPARE_RANGE = 0x0014, "compare contact: string outside of its memory";
    }
}
