//! Operations of S7-200 instructions that the runtime does.

/// Bits of the low half of the result of an operation; the high half is its value.
pub mod result {
    /// It ran without error: the ENO of the instruction.
    pub const ENO: u64 = 1;
    /// The block must be left at once, as after a safepoint.
    pub const STOP: u64 = 2;
    /// The value is valid and is to be stored. Else the output stays as it is.
    pub const VALUE: u64 = 4;
}

/// The three timers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum TimerKind {
    Ton,
    Tonr,
    Tof,
}

macro_rules! operations {
    ($( $(#[$doc:meta])* $name:ident ; )*) => {
        /// What [`RuntimeFn::S7200Operation`](crate::RuntimeFn::S7200Operation) does, as its number. `a` to `d` are its operands.
        ///
        /// *Address*: offset from the memory base. *Bit address*: eight times an address, plus the bit. *Value*: zero-extended.
        /// An operation writes SM1 bits and the errors of SM4.3 itself; it checks that what it reads and writes is in the area
        /// in which it begins (0091), and does nothing then.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u8)]
        pub enum Operation { $( $(#[$doc])* $name ),* }

        impl Operation {
            pub const ALL: &'static [Operation] = &[ $( Operation::$name ),* ];

            pub const fn name(self) -> &'static str {
                match self { $( Operation::$name => stringify!($name) ),* }
            }

            /// True if it goes on after it has returned, or something outside the program does: interrupts, counters, pulse outputs,
            /// ports, network, and a STOP at the end of the scan.
            pub const fn concerns_hardware(self) -> bool {
                self as u8 >= Operation::AttachInterrupt as u8
                    && !matches!(self, Operation::RestartWatchdog | Operation::DiagnosticLed)
            }

            /// The operation with this number.
            pub fn of_number(number: u32) -> Option<Operation> {
                Operation::ALL.get(number as usize).copied()
            }
        }
    };
}

operations! {
    /// S, R with a count: bit address `a`, count `b`, value 0 or 1 `c`.
    WriteBits;
    /// SI, RI: number of the first output bit `a` (8 × byte + bit), count `b`, value 0 or 1 `c`. Image and module.
    WriteOutputsNow;
    /// R of timers: first number `a`, count `b`.
    ResetTimers;
    /// R of counters.
    ResetCounters;
    /// S of timers: sets the bits only.
    SetTimers;
    /// S of counters.
    SetCounters;
    /// BMB, BMW, BMD: address `a` to address `b`, element size in bytes `c`, number of elements `d`.
    CopyBlock;
    /// FILL: value `a`, address `b`, number of words `c`.
    Fill;
    /// SHRB: data bit `a` (0 or 1), bit address `b`, count `c` (signed, sign-extended).
    ShiftRegister;
    /// ATT: value `a`, address of the table `b`.
    TableAdd;
    /// FIFO: address of the table `a`; returns the word.
    TableFirst;
    /// LIFO: address of the table `a`; returns the word.
    TableLast;
    /// FND: address of the entry count `a`, pattern `b`, index `c`, relation `d` (0 `=`, 1 `<>`, 2 `<`, 3 `>`); returns the new index.
    TableFind;
    /// ITA: value `a`, address of the buffer `b`, format `c`.
    IntToAscii;
    /// DTA.
    DintToAscii;
    /// RTA: bits of the REAL `a`, address of the buffer `b`, format `c`.
    RealToAscii;
    /// ITS: as ITA, address of the string `b`.
    IntToString;
    /// DTS.
    DintToString;
    /// RTS.
    RealToString;
    /// ATH: address of characters `a`, address of bytes `b`, number of digits `c`.
    AsciiToHex;
    /// HTA: address of bytes `a`, address of characters `b`, number of digits `c`.
    HexToAscii;
    /// STI: address of the string `a`, index `b`; returns the word.
    StringToInt;
    /// STD; returns the double word.
    StringToDint;
    /// STR; returns the bits of the REAL.
    StringToReal;
    /// SLEN: address of the string `a`; returns the byte.
    StringLength;
    /// SCPY: address `a` to address `b`.
    StringCopy;
    /// SCAT: address `a` after the string at `b`.
    StringAppend;
    /// SSCPY: address `a`, index `b`, number `c`, address of the result `d`.
    StringPart;
    /// SFND: searches the string at `b` in the string at `a`, from position `c`; returns the position.
    StringFind;
    /// CFND: searches characters of the string at `b` in the string at `a`, from position `c`; returns the position.
    CharacterFind;
    /// Comparison of the strings at `a` and `b`; returns 1 if they are equal. A length that leaves the area is a fatal error.
    StringEqual;
    /// PID: address of the loop table `a`, loop number `b`, EN `c`: with 0 it only notes that the loop is off.
    Pid;
    /// TODR: address of the buffer `a`.
    ReadClock;
    /// TODW.
    SetClock;
    /// TODRX.
    ReadClockExtended;
    /// TODWX.
    SetClockExtended;
    /// ATCH: interrupt routine `a`, event `b`.
    AttachInterrupt;
    /// DTCH: event `a`.
    DetachInterrupt;
    /// CEVNT: event `a`.
    ClearEvents;
    /// ENI. Waiting interrupts run at the next safepoint.
    EnableInterrupts;
    /// DISI.
    DisableInterrupts;
    /// HDEF: counter `a`, mode `b`.
    DefineCounter;
    /// HSC: counter `a`.
    ControlCounter;
    /// PLS: output `a`.
    ControlPulses;
    /// XMT: address of the table `a`, port `b`.
    Transmit;
    /// RCV: address of the table `a`, port `b`.
    Receive;
    /// NETR: address of the table `a`, port `b`.
    NetworkRead;
    /// NETW.
    NetworkWrite;
    /// GPA: port `a`; returns the station address.
    GetStationAddress;
    /// SPA: station address `a`, port `b`.
    SetStationAddress;
    /// WDR.
    RestartWatchdog;
    /// DLED: value `a`.
    DiagnosticLed;
    /// STOP instruction. Returns STOP, but not in an interrupt routine: there the scan ends first.
    StopMode;
}
