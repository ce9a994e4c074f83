//! The instruction table of the S7-200: one row per instruction. Compare contacts are in [`super::compare`].
//!
//! Lexer, parser, checks, the reference page and the coverage test read these rows. `flags` are the bits of SM1 that the instruction writes:
//! `Z` SM1.0, `V` SM1.1, `N` SM1.2, `D` SM1.3, a number the bit SM1.n. `eno` says when ENO is 0, apart from a bad pointer: `-` the
//! instruction has no ENO; `Yes` for its own errors; letters and numbers: that bit of SM1 is set; `Range`, `Index`, `Count`,
//! `Format`, `Nesting`: errors of that kind. Rows follow the chapters of the S7-200 system manual.

use std::borrow::Cow;

use super::compare::Compare;
use crate::stl::Mnemonics;

/// What an operand is. `In` is read, `Out` is written (or changed in place).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OperandClass {
    /// I Q V M SM S T C L as bits.
    Bit,
    /// A bit that may be written.
    BitWrite,
    /// I only, read from the module.
    InputBit,
    /// Q only, written to the module.
    OutputBit,
    /// S only.
    SBit,
    ByteIn,
    ByteOut,
    WordIn,
    /// As `WordIn`, with a sign: a decimal constant is an INT.
    IntIn,
    WordOut,
    /// As `WordOut`, and AQW.
    WordOutAnalog,
    /// HC included.
    DwordIn,
    /// As `DwordIn`, with a sign: a decimal constant is a DINT.
    DintIn,
    /// As `DwordIn`, and the address of an operand (`&VB100`).
    DwordInAddress,
    DwordOut,
    RealIn,
    RealOut,
    /// VB, LB, pointers, or a string constant.
    StringIn,
    StringOut,
    /// A byte-addressed buffer: IB QB VB MB SMB SB LB, pointers.
    Buffer,
    /// A table of words: its first word; IW QW VW MW SMW SW LW T C, pointers.
    Table,
    /// First byte of several: IB QB VB MB SMB SB LB, pointers.
    BytesIn,
    BytesOut,
    /// First word of several: also T, C, AIW.
    WordsIn,
    /// Also T, C, AQW.
    WordsOut,
    DwordsIn,
    DwordsOut,
    /// A byte as number of elements.
    Count,
    /// A byte as signed number of bits.
    SignedCount,
    Timer,
    Counter,
    /// A constant from 0 to this.
    Number(u16),
    Label,
    /// VB with a loop table.
    LoopTable,
    /// IB, read from the module.
    InputByte,
    /// QB, written to the module.
    OutputByte,
    /// A subroutine, then its parameters.
    Subroutine,
    /// An interrupt routine.
    Interrupt,
}

/// When an instruction takes effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Acts {
    /// Whatever S0 is.
    Always,
    /// If S0 is 1: a box with EN, or a conditional instruction.
    Enabled,
    /// It marks a place.
    Marker,
}

macro_rules! instructions {
    ($( $(#[doc = $doc:literal])* $variant:ident { en: $en:literal, de: $de:literal, operands: [$($operand:expr),*], acts: $acts:ident, flags: $flags:literal, eno: $eno:literal } )*) => {
        /// An instruction of the S7-200.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Insn {
            $( $(#[doc = $doc])* $variant, )*
            /// A compare contact.
            Compare(Compare),
        }

        impl Insn {
            /// All but the compare contacts, in the order of the table.
            pub const ROWS: &'static [Insn] = &[ $(Insn::$variant),* ];

            /// Name of the row, as in `AddI`.
            pub const fn row(self) -> &'static str {
                match self { $(Insn::$variant => stringify!($variant),)* Insn::Compare(_) => "Compare" }
            }

            /// As written, in capital letters.
            pub fn mnemonic(self, set: Mnemonics) -> Cow<'static, str> {
                match (self, set) {
                    $( (Insn::$variant, Mnemonics::En) => $en.into(), (Insn::$variant, Mnemonics::De) => $de.into(), )*
                    (Insn::Compare(compare), _) => compare.mnemonic(set).into(),
                }
            }

            pub fn operands(self) -> &'static [OperandClass] {
                use OperandClass::*;
                match self { $(Insn::$variant => &[$($operand),*],)* Insn::Compare(compare) => compare.kind.operands() }
            }

            pub const fn acts(self) -> Acts {
                match self { $(Insn::$variant => Acts::$acts,)* Insn::Compare(_) => Acts::Always }
            }

            /// Bits of SM1 that it writes; see the module comment.
            pub const fn flags(self) -> &'static str {
                match self { $(Insn::$variant => $flags,)* Insn::Compare(_) => "" }
            }

            /// When ENO is 0; see the module comment.
            pub const fn eno(self) -> &'static str {
                match self { $(Insn::$variant => $eno,)* Insn::Compare(_) => "-" }
            }

            /// What the instruction does.
            pub const fn doc(self) -> &'static str {
                match self { $(Insn::$variant => concat!($($doc),*),)* Insn::Compare(_) => " Combines the result of a comparison with S0, or pushes it." }
            }
        }
    };
}

instructions! {
    // Bit logic.

    /// Pushes the bit.
    Load { en: "LD", de: "LD", operands: [Bit], acts: Always, flags: "", eno: "-" }
    /// Pushes the negated bit.
    LoadNot { en: "LDN", de: "LDN", operands: [Bit], acts: Always, flags: "", eno: "-" }
    /// AND of S0 and the bit.
    And { en: "A", de: "U", operands: [Bit], acts: Always, flags: "", eno: "-" }
    /// AND of S0 and the negated bit.
    AndNot { en: "AN", de: "UN", operands: [Bit], acts: Always, flags: "", eno: "-" }
    /// OR of S0 and the bit.
    Or { en: "O", de: "O", operands: [Bit], acts: Always, flags: "", eno: "-" }
    /// OR of S0 and the negated bit.
    OrNot { en: "ON", de: "ON", operands: [Bit], acts: Always, flags: "", eno: "-" }
    /// Pushes the input as it is at this moment.
    LoadNow { en: "LDI", de: "LDI", operands: [InputBit], acts: Always, flags: "", eno: "-" }
    /// Pushes the negated input of this moment.
    LoadNotNow { en: "LDNI", de: "LDNI", operands: [InputBit], acts: Always, flags: "", eno: "-" }
    /// AND of S0 and the input of this moment.
    AndNow { en: "AI", de: "UI", operands: [InputBit], acts: Always, flags: "", eno: "-" }
    /// AND of S0 and the negated input of this moment.
    AndNotNow { en: "ANI", de: "UNI", operands: [InputBit], acts: Always, flags: "", eno: "-" }
    /// OR of S0 and the input of this moment.
    OrNow { en: "OI", de: "OI", operands: [InputBit], acts: Always, flags: "", eno: "-" }
    /// OR of S0 and the negated input of this moment.
    OrNotNow { en: "ONI", de: "ONI", operands: [InputBit], acts: Always, flags: "", eno: "-" }
    /// Negates S0.
    Not { en: "NOT", de: "NOT", operands: [], acts: Always, flags: "", eno: "-" }
    /// S0 is 1 for one execution when it changed from 0 to 1.
    RisingEdge { en: "EU", de: "EU", operands: [], acts: Always, flags: "", eno: "-" }
    /// S0 is 1 for one execution when it changed from 1 to 0.
    FallingEdge { en: "ED", de: "ED", operands: [], acts: Always, flags: "", eno: "-" }
    /// Writes S0 to the bit.
    Assign { en: "=", de: "=", operands: [BitWrite], acts: Always, flags: "", eno: "-" }
    /// Writes S0 to the output bit and to its module at once.
    AssignNow { en: "=I", de: "=I", operands: [OutputBit], acts: Always, flags: "", eno: "-" }
    /// Sets N bits from the first one.
    Set { en: "S", de: "S", operands: [BitWrite, Count], acts: Enabled, flags: "", eno: "Range" }
    /// Clears N bits from the first one; of timers and counters their current values too.
    Reset { en: "R", de: "R", operands: [BitWrite, Count], acts: Enabled, flags: "", eno: "Range" }
    /// Sets outputs, and their module at once.
    SetNow { en: "SI", de: "SI", operands: [OutputBit, Count], acts: Enabled, flags: "", eno: "Range" }
    /// Clears outputs, and their module at once.
    ResetNow { en: "RI", de: "RI", operands: [OutputBit, Count], acts: Enabled, flags: "", eno: "Range" }
    /// S0 AND S1 replaces the two.
    AndLoad { en: "ALD", de: "ULD", operands: [], acts: Always, flags: "", eno: "-" }
    /// S0 OR S1 replaces the two.
    OrLoad { en: "OLD", de: "OLD", operands: [], acts: Always, flags: "", eno: "-" }
    /// Pushes a copy of S0.
    Push { en: "LPS", de: "LPS", operands: [], acts: Always, flags: "", eno: "-" }
    /// Copies S1 to S0.
    Read { en: "LRD", de: "LRD", operands: [], acts: Always, flags: "", eno: "-" }
    /// Drops S0.
    Pop { en: "LPP", de: "LPP", operands: [], acts: Always, flags: "", eno: "-" }
    /// Pushes a copy of level n.
    LoadStack { en: "LDS", de: "LDS", operands: [Number(8)], acts: Always, flags: "", eno: "-" }
    /// AND of S0 and ENO.
    AndEno { en: "AENO", de: "UENO", operands: [], acts: Always, flags: "", eno: "-" }
    /// Does nothing.
    Nop { en: "NOP", de: "NOP", operands: [Number(255)], acts: Always, flags: "", eno: "-" }
    // Timers and counters.

    /// On-delay timer.
    Ton { en: "TON", de: "TON", operands: [Timer, IntIn], acts: Always, flags: "", eno: "-" }
    /// On-delay timer that keeps its time.
    Tonr { en: "TONR", de: "TONR", operands: [Timer, IntIn], acts: Always, flags: "", eno: "-" }
    /// Off-delay timer.
    Tof { en: "TOF", de: "TOF", operands: [Timer, IntIn], acts: Always, flags: "", eno: "-" }
    /// Stores the millisecond counter.
    BeginInterval { en: "BITIM", de: "BITIM", operands: [DwordOut], acts: Enabled, flags: "", eno: "Yes" }
    /// Milliseconds since the stored moment.
    Interval { en: "CITIM", de: "CITIM", operands: [DwordIn, DwordOut], acts: Enabled, flags: "", eno: "Yes" }
    /// Counts up. S0 resets, S1 counts.
    Ctu { en: "CTU", de: "CTU", operands: [Counter, IntIn], acts: Always, flags: "", eno: "-" }
    /// Counts down. S0 loads, S1 counts.
    Ctd { en: "CTD", de: "CTD", operands: [Counter, IntIn], acts: Always, flags: "", eno: "-" }
    /// Counts up and down. S0 resets, S1 counts down, S2 counts up.
    Ctud { en: "CTUD", de: "CTUD", operands: [Counter, IntIn], acts: Always, flags: "", eno: "-" }
    // High-speed counters and pulse outputs.

    /// Sets the mode of a high-speed counter.
    Hdef { en: "HDEF", de: "HDEF", operands: [Number(5), Number(12)], acts: Enabled, flags: "", eno: "Yes" }
    /// Applies the control byte of a high-speed counter.
    Hsc { en: "HSC", de: "HSC", operands: [Number(5)], acts: Enabled, flags: "", eno: "Yes" }
    /// Starts or changes pulses of Q0.0 or Q0.1.
    Pls { en: "PLS", de: "PLS", operands: [Number(1)], acts: Enabled, flags: "", eno: "Yes" }
    // Mathematics.

    /// Adds in 16 bits: OUT + IN to OUT.
    AddI { en: "+I", de: "+I", operands: [IntIn, WordOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Subtracts in 16 bits: OUT - IN to OUT.
    SubI { en: "-I", de: "-I", operands: [IntIn, WordOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Multiplies in 16 bits: OUT * IN to OUT.
    MulI { en: "*I", de: "*I", operands: [IntIn, WordOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Divides in 16 bits: OUT / IN to OUT.
    DivI { en: "/I", de: "/I", operands: [IntIn, WordOut], acts: Enabled, flags: "Z V N D", eno: "V D" }
    /// Adds in 32 bits: OUT + IN to OUT.
    AddD { en: "+D", de: "+D", operands: [DintIn, DwordOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Subtracts in 32 bits: OUT - IN to OUT.
    SubD { en: "-D", de: "-D", operands: [DintIn, DwordOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Multiplies in 32 bits: OUT * IN to OUT.
    MulD { en: "*D", de: "*D", operands: [DintIn, DwordOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Divides in 32 bits: OUT / IN to OUT.
    DivD { en: "/D", de: "/D", operands: [DintIn, DwordOut], acts: Enabled, flags: "Z V N D", eno: "V D" }
    /// Adds REALs: OUT + IN to OUT.
    AddR { en: "+R", de: "+R", operands: [RealIn, RealOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Subtracts REALs: OUT - IN to OUT.
    SubR { en: "-R", de: "-R", operands: [RealIn, RealOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Multiplies REALs: OUT * IN to OUT.
    MulR { en: "*R", de: "*R", operands: [RealIn, RealOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Divides REALs: OUT / IN to OUT.
    DivR { en: "/R", de: "/R", operands: [RealIn, RealOut], acts: Enabled, flags: "Z V N D", eno: "V D" }
    /// Product of IN and the low word of OUT, 32 bits.
    Mul { en: "MUL", de: "MUL", operands: [IntIn, DwordOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Low word of OUT by IN: remainder to the high word, quotient to the low one.
    Div { en: "DIV", de: "DIV", operands: [IntIn, DwordOut], acts: Enabled, flags: "Z V N D", eno: "V D" }
    /// Adds 1.
    IncB { en: "INCB", de: "INCB", operands: [ByteOut], acts: Enabled, flags: "Z V", eno: "V" }
    /// Subtracts 1.
    DecB { en: "DECB", de: "DECB", operands: [ByteOut], acts: Enabled, flags: "Z V", eno: "V" }
    /// Adds 1.
    IncW { en: "INCW", de: "INCW", operands: [WordOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Subtracts 1.
    DecW { en: "DECW", de: "DECW", operands: [WordOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Adds 1.
    IncD { en: "INCD", de: "INCD", operands: [DwordOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Subtracts 1.
    DecD { en: "DECD", de: "DECD", operands: [DwordOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Square root.
    Sqrt { en: "SQRT", de: "SQRT", operands: [RealIn, RealOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Sine of an angle in radians.
    Sin { en: "SIN", de: "SIN", operands: [RealIn, RealOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Cosine of an angle in radians.
    Cos { en: "COS", de: "COS", operands: [RealIn, RealOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Tangent of an angle in radians.
    Tan { en: "TAN", de: "TAN", operands: [RealIn, RealOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Natural logarithm.
    Ln { en: "LN", de: "LN", operands: [RealIn, RealOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Natural exponential.
    Exp { en: "EXP", de: "EXP", operands: [RealIn, RealOut], acts: Enabled, flags: "Z V N", eno: "V" }
    /// Computes a PID loop.
    Pid { en: "PID", de: "PID", operands: [LoopTable, Number(7)], acts: Enabled, flags: "V", eno: "V" }
    // Moves.

    /// Copies a byte.
    MovB { en: "MOVB", de: "MOVB", operands: [ByteIn, ByteOut], acts: Enabled, flags: "", eno: "Yes" }
    /// Copies a word.
    MovW { en: "MOVW", de: "MOVW", operands: [WordIn, WordOutAnalog], acts: Enabled, flags: "", eno: "Yes" }
    /// Copies a double word, or the address of an operand.
    MovD { en: "MOVD", de: "MOVD", operands: [DwordInAddress, DwordOut], acts: Enabled, flags: "", eno: "Yes" }
    /// Copies a REAL.
    MovR { en: "MOVR", de: "MOVR", operands: [RealIn, RealOut], acts: Enabled, flags: "", eno: "Yes" }
    /// Copies N bytes.
    Bmb { en: "BMB", de: "BMB", operands: [BytesIn, BytesOut, Count], acts: Enabled, flags: "", eno: "Range" }
    /// Copies N words.
    Bmw { en: "BMW", de: "BMW", operands: [WordsIn, WordsOut, Count], acts: Enabled, flags: "", eno: "Range" }
    /// Copies N double words.
    Bmd { en: "BMD", de: "BMD", operands: [DwordsIn, DwordsOut, Count], acts: Enabled, flags: "", eno: "Range" }
    /// Exchanges the bytes of a word.
    Swap { en: "SWAP", de: "SWAP", operands: [WordOut], acts: Enabled, flags: "", eno: "Yes" }
    /// Reads an input byte at this moment.
    Bir { en: "BIR", de: "BIR", operands: [InputByte, ByteOut], acts: Enabled, flags: "", eno: "Yes" }
    /// Writes an output byte and its module at once.
    Biw { en: "BIW", de: "BIW", operands: [ByteIn, OutputByte], acts: Enabled, flags: "", eno: "Yes" }
    // Logical operations.

    /// Inverts all bits.
    InvB { en: "INVB", de: "INVB", operands: [ByteOut], acts: Enabled, flags: "Z", eno: "Yes" }
    /// Inverts all bits.
    InvW { en: "INVW", de: "INVW", operands: [WordOut], acts: Enabled, flags: "Z", eno: "Yes" }
    /// Inverts all bits.
    InvD { en: "INVD", de: "INVD", operands: [DwordOut], acts: Enabled, flags: "Z", eno: "Yes" }
    /// AND of all bits of IN and OUT, to OUT.
    AndB { en: "ANDB", de: "ANDB", operands: [ByteIn, ByteOut], acts: Enabled, flags: "Z", eno: "Yes" }
    /// AND of all bits of IN and OUT, to OUT.
    AndW { en: "ANDW", de: "ANDW", operands: [WordIn, WordOut], acts: Enabled, flags: "Z", eno: "Yes" }
    /// AND of all bits of IN and OUT, to OUT.
    AndD { en: "ANDD", de: "ANDD", operands: [DwordIn, DwordOut], acts: Enabled, flags: "Z", eno: "Yes" }
    /// OR of all bits of IN and OUT, to OUT.
    OrB { en: "ORB", de: "ORB", operands: [ByteIn, ByteOut], acts: Enabled, flags: "Z", eno: "Yes" }
    /// OR of all bits of IN and OUT, to OUT.
    OrW { en: "ORW", de: "ORW", operands: [WordIn, WordOut], acts: Enabled, flags: "Z", eno: "Yes" }
    /// OR of all bits of IN and OUT, to OUT.
    OrD { en: "ORD", de: "ORD", operands: [DwordIn, DwordOut], acts: Enabled, flags: "Z", eno: "Yes" }
    /// Exclusive OR of all bits of IN and OUT, to OUT.
    XorB { en: "XORB", de: "XORB", operands: [ByteIn, ByteOut], acts: Enabled, flags: "Z", eno: "Yes" }
    /// Exclusive OR of all bits of IN and OUT, to OUT.
    XorW { en: "XORW", de: "XORW", operands: [WordIn, WordOut], acts: Enabled, flags: "Z", eno: "Yes" }
    /// Exclusive OR of all bits of IN and OUT, to OUT.
    XorD { en: "XORD", de: "XORD", operands: [DwordIn, DwordOut], acts: Enabled, flags: "Z", eno: "Yes" }
    // Shift and rotate.

    /// Shifts right, filling with 0.
    ShiftRightB { en: "SRB", de: "SRB", operands: [ByteOut, Count], acts: Enabled, flags: "Z V", eno: "Yes" }
    /// Shifts right, filling with 0.
    ShiftRightW { en: "SRW", de: "SRW", operands: [WordOut, Count], acts: Enabled, flags: "Z V", eno: "Yes" }
    /// Shifts right, filling with 0.
    ShiftRightD { en: "SRD", de: "SRD", operands: [DwordOut, Count], acts: Enabled, flags: "Z V", eno: "Yes" }
    /// Shifts left, filling with 0.
    ShiftLeftB { en: "SLB", de: "SLB", operands: [ByteOut, Count], acts: Enabled, flags: "Z V", eno: "Yes" }
    /// Shifts left, filling with 0.
    ShiftLeftW { en: "SLW", de: "SLW", operands: [WordOut, Count], acts: Enabled, flags: "Z V", eno: "Yes" }
    /// Shifts left, filling with 0.
    ShiftLeftD { en: "SLD", de: "SLD", operands: [DwordOut, Count], acts: Enabled, flags: "Z V", eno: "Yes" }
    /// Rotates right.
    RotateRightB { en: "RRB", de: "RRB", operands: [ByteOut, Count], acts: Enabled, flags: "Z V", eno: "Yes" }
    /// Rotates right.
    RotateRightW { en: "RRW", de: "RRW", operands: [WordOut, Count], acts: Enabled, flags: "Z V", eno: "Yes" }
    /// Rotates right.
    RotateRightD { en: "RRD", de: "RRD", operands: [DwordOut, Count], acts: Enabled, flags: "Z V", eno: "Yes" }
    /// Rotates left.
    RotateLeftB { en: "RLB", de: "RLB", operands: [ByteOut, Count], acts: Enabled, flags: "Z V", eno: "Yes" }
    /// Rotates left.
    RotateLeftW { en: "RLW", de: "RLW", operands: [WordOut, Count], acts: Enabled, flags: "Z V", eno: "Yes" }
    /// Rotates left.
    RotateLeftD { en: "RLD", de: "RLD", operands: [DwordOut, Count], acts: Enabled, flags: "Z V", eno: "Yes" }
    /// Shifts a register of bits by one place; the sign of its length says whether up or down.
    ShiftRegister { en: "SHRB", de: "SHRB", operands: [Bit, BitWrite, SignedCount], acts: Enabled, flags: "V", eno: "Range" }
    // Tables.

    /// Adds a word to a table.
    Att { en: "ATT", de: "ATT", operands: [IntIn, Table], acts: Enabled, flags: "4", eno: "4 Range" }
    /// Takes the first word out of a table.
    Fifo { en: "FIFO", de: "FIFO", operands: [Table, WordOutAnalog], acts: Enabled, flags: "5", eno: "5 Range" }
    /// Takes the last word out of a table.
    Lifo { en: "LIFO", de: "LIFO", operands: [Table, WordOutAnalog], acts: Enabled, flags: "5", eno: "5 Range" }
    /// Writes a word to N words.
    Fill { en: "FILL", de: "FILL", operands: [IntIn, WordsOut, Count], acts: Enabled, flags: "", eno: "Range" }
    /// Searches a table from an index on.
    FindEqual { en: "FND=", de: "FND=", operands: [Table, IntIn, WordOut], acts: Enabled, flags: "", eno: "Range" }
    /// Searches a table from an index on.
    FindNotEqual { en: "FND<>", de: "FND<>", operands: [Table, IntIn, WordOut], acts: Enabled, flags: "", eno: "Range" }
    /// Searches a table from an index on.
    FindLess { en: "FND<", de: "FND<", operands: [Table, IntIn, WordOut], acts: Enabled, flags: "", eno: "Range" }
    /// Searches a table from an index on.
    FindGreater { en: "FND>", de: "FND>", operands: [Table, IntIn, WordOut], acts: Enabled, flags: "", eno: "Range" }
    // Conversion.

    /// Byte to integer.
    Bti { en: "BTI", de: "BTI", operands: [ByteIn, WordOut], acts: Enabled, flags: "", eno: "Yes" }
    /// Integer to byte.
    Itb { en: "ITB", de: "ITB", operands: [IntIn, ByteOut], acts: Enabled, flags: "V", eno: "V" }
    /// Integer to double integer.
    Itd { en: "ITD", de: "ITD", operands: [IntIn, DwordOut], acts: Enabled, flags: "", eno: "Yes" }
    /// Double integer to integer.
    Dti { en: "DTI", de: "DTI", operands: [DintIn, WordOut], acts: Enabled, flags: "V", eno: "V" }
    /// Double integer to REAL.
    Dtr { en: "DTR", de: "DTR", operands: [DintIn, RealOut], acts: Enabled, flags: "", eno: "Yes" }
    /// REAL to the nearest double integer, halves away from zero.
    Round { en: "ROUND", de: "ROUND", operands: [RealIn, DwordOut], acts: Enabled, flags: "V", eno: "V" }
    /// REAL to double integer, without its fraction.
    Trunc { en: "TRUNC", de: "TRUNC", operands: [RealIn, DwordOut], acts: Enabled, flags: "V", eno: "V" }
    /// BCD to integer, in place.
    Bcdi { en: "BCDI", de: "BCDI", operands: [WordOut], acts: Enabled, flags: "6", eno: "6" }
    /// Integer to BCD, in place.
    Ibcd { en: "IBCD", de: "IBCD", operands: [WordOut], acts: Enabled, flags: "6", eno: "6" }
    /// Sets the bit that the low nibble names, clears the others.
    Deco { en: "DECO", de: "DECO", operands: [ByteIn, WordOutAnalog], acts: Enabled, flags: "", eno: "Yes" }
    /// Number of the lowest bit that is set.
    Enco { en: "ENCO", de: "ENCO", operands: [WordIn, ByteOut], acts: Enabled, flags: "", eno: "Yes" }
    /// Segments of the digit in the low nibble.
    Seg { en: "SEG", de: "SEG", operands: [ByteIn, ByteOut], acts: Enabled, flags: "", eno: "Yes" }
    /// Integer to eight characters.
    Ita { en: "ITA", de: "ITA", operands: [IntIn, Buffer, ByteIn], acts: Enabled, flags: "", eno: "Format" }
    /// Double integer to twelve characters.
    Dta { en: "DTA", de: "DTA", operands: [DintIn, Buffer, ByteIn], acts: Enabled, flags: "", eno: "Format" }
    /// REAL to characters.
    Rta { en: "RTA", de: "RTA", operands: [RealIn, Buffer, ByteIn], acts: Enabled, flags: "", eno: "Format" }
    /// Hexadecimal characters to bytes.
    Ath { en: "ATH", de: "ATH", operands: [Buffer, Buffer, ByteIn], acts: Enabled, flags: "7", eno: "7 Range" }
    /// Bytes to hexadecimal characters.
    Hta { en: "HTA", de: "HTA", operands: [Buffer, Buffer, ByteIn], acts: Enabled, flags: "", eno: "Range" }
    /// Integer to a string.
    Its { en: "ITS", de: "ITS", operands: [IntIn, StringOut, ByteIn], acts: Enabled, flags: "", eno: "Format" }
    /// Double integer to a string.
    Dts { en: "DTS", de: "DTS", operands: [DintIn, StringOut, ByteIn], acts: Enabled, flags: "", eno: "Format" }
    /// REAL to a string.
    Rts { en: "RTS", de: "RTS", operands: [RealIn, StringOut, ByteIn], acts: Enabled, flags: "", eno: "Format" }
    /// String to integer.
    Sti { en: "STI", de: "STI", operands: [StringIn, ByteIn, WordOut], acts: Enabled, flags: "V", eno: "V Index" }
    /// String to double integer.
    Std { en: "STD", de: "STD", operands: [StringIn, ByteIn, DwordOut], acts: Enabled, flags: "V", eno: "V Index" }
    /// String to REAL.
    Str { en: "STR", de: "STR", operands: [StringIn, ByteIn, RealOut], acts: Enabled, flags: "V", eno: "V Index" }
    // Strings.

    /// Length of a string.
    Slen { en: "SLEN", de: "SLEN", operands: [StringIn, ByteOut], acts: Enabled, flags: "", eno: "Range" }
    /// Copies a string.
    Scpy { en: "SCPY", de: "SCPY", operands: [StringIn, StringOut], acts: Enabled, flags: "", eno: "Range" }
    /// Appends a string.
    Scat { en: "SCAT", de: "SCAT", operands: [StringIn, StringOut], acts: Enabled, flags: "", eno: "Range" }
    /// Copies a part of a string.
    Sscpy { en: "SSCPY", de: "SSCPY", operands: [StringIn, ByteIn, ByteIn, StringOut], acts: Enabled, flags: "", eno: "Range Index" }
    /// Searches a string in a string.
    Sfnd { en: "SFND", de: "SFND", operands: [StringIn, StringIn, ByteOut], acts: Enabled, flags: "", eno: "Range Index" }
    /// Searches one of several characters in a string.
    Cfnd { en: "CFND", de: "CFND", operands: [StringIn, StringIn, ByteOut], acts: Enabled, flags: "", eno: "Range Index" }
    // Program control.

    /// Ends the scan.
    End { en: "END", de: "END", operands: [], acts: Enabled, flags: "", eno: "-" }
    /// Ends the main program.
    Mend { en: "MEND", de: "MEND", operands: [], acts: Always, flags: "", eno: "-" }
    /// Switches the CPU to STOP.
    Stop { en: "STOP", de: "STOP", operands: [], acts: Enabled, flags: "", eno: "-" }
    /// Restarts the watchdog of the scan.
    Wdr { en: "WDR", de: "WDR", operands: [], acts: Enabled, flags: "", eno: "-" }
    /// Goes to the label.
    Jmp { en: "JMP", de: "JMP", operands: [Label], acts: Enabled, flags: "", eno: "-" }
    /// A label.
    Lbl { en: "LBL", de: "LBL", operands: [Label], acts: Marker, flags: "", eno: "-" }
    /// Begins a loop: index, first and last value.
    For { en: "FOR", de: "FOR", operands: [WordOut, IntIn, IntIn], acts: Enabled, flags: "", eno: "Yes" }
    /// Ends a loop; S0 is 1.
    Next { en: "NEXT", de: "NEXT", operands: [], acts: Always, flags: "", eno: "-" }
    /// Begins a step of a sequence.
    Lscr { en: "LSCR", de: "LSCR", operands: [SBit], acts: Always, flags: "", eno: "-" }
    /// Goes on to another step.
    Scrt { en: "SCRT", de: "SCRT", operands: [SBit], acts: Enabled, flags: "", eno: "-" }
    /// Ends the step early.
    Cscre { en: "CSCRE", de: "CSCRE", operands: [], acts: Enabled, flags: "", eno: "-" }
    /// Ends the step.
    Scre { en: "SCRE", de: "SCRE", operands: [], acts: Always, flags: "", eno: "-" }
    /// Calls a subroutine with its parameters.
    Call { en: "CALL", de: "CALL", operands: [Subroutine], acts: Enabled, flags: "", eno: "Nesting" }
    /// Returns from the subroutine.
    Cret { en: "CRET", de: "CRET", operands: [], acts: Enabled, flags: "", eno: "-" }
    /// Ends the subroutine.
    Ret { en: "RET", de: "RET", operands: [], acts: Always, flags: "", eno: "-" }
    /// Switches the diagnostic LED.
    Dled { en: "DLED", de: "DLED", operands: [ByteIn], acts: Enabled, flags: "", eno: "-" }
    // Interrupts.

    /// Attaches an interrupt routine to an event.
    Atch { en: "ATCH", de: "ATCH", operands: [Interrupt, Number(33)], acts: Enabled, flags: "", eno: "Yes" }
    /// Detaches the event.
    Dtch { en: "DTCH", de: "DTCH", operands: [Number(33)], acts: Enabled, flags: "", eno: "Yes" }
    /// Drops waiting events.
    Cevnt { en: "CEVNT", de: "CEVNT", operands: [Number(33)], acts: Enabled, flags: "", eno: "Yes" }
    /// Enables interrupts.
    Eni { en: "ENI", de: "ENI", operands: [], acts: Enabled, flags: "", eno: "Yes" }
    /// Disables interrupts; events wait.
    Disi { en: "DISI", de: "DISI", operands: [], acts: Enabled, flags: "", eno: "Yes" }
    /// Returns from the interrupt routine.
    Creti { en: "CRETI", de: "CRETI", operands: [], acts: Enabled, flags: "", eno: "-" }
    /// Ends the interrupt routine.
    Reti { en: "RETI", de: "RETI", operands: [], acts: Always, flags: "", eno: "-" }
    // Communication and clock.

    /// Reads from another station.
    Netr { en: "NETR", de: "NETR", operands: [Buffer, Number(1)], acts: Enabled, flags: "", eno: "Yes" }
    /// Writes to another station.
    Netw { en: "NETW", de: "NETW", operands: [Buffer, Number(1)], acts: Enabled, flags: "", eno: "Yes" }
    /// Sends bytes in Freeport mode.
    Xmt { en: "XMT", de: "XMT", operands: [Buffer, Number(1)], acts: Enabled, flags: "", eno: "Yes" }
    /// Starts or ends receiving a message.
    Rcv { en: "RCV", de: "RCV", operands: [Buffer, Number(1)], acts: Enabled, flags: "", eno: "Yes" }
    /// Station address of the port.
    Gpa { en: "GPA", de: "GPA", operands: [ByteOut, Number(1)], acts: Enabled, flags: "", eno: "Yes" }
    /// Sets the station address of the port.
    Spa { en: "SPA", de: "SPA", operands: [ByteIn, Number(1)], acts: Enabled, flags: "", eno: "Range" }
    /// Reads the clock.
    Todr { en: "TODR", de: "TODR", operands: [Buffer], acts: Enabled, flags: "", eno: "Yes" }
    /// Sets the clock.
    Todw { en: "TODW", de: "TODW", operands: [Buffer], acts: Enabled, flags: "", eno: "Yes" }
    /// Reads clock and daylight-saving settings.
    Todrx { en: "TODRX", de: "TODRX", operands: [Buffer], acts: Enabled, flags: "", eno: "Yes" }
    /// Sets clock and daylight-saving settings.
    Todwx { en: "TODWX", de: "TODWX", operands: [Buffer], acts: Enabled, flags: "", eno: "Yes" }
}
