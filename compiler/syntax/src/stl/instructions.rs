//! The instruction table of STL: one row per instruction.
//!
//! Lexer, parser, checks, the reference page and the coverage test read these rows. `status` is the effect on the status word in the
//! order BR CC1 CC0 OV OS OR STA RLO /FC: `-` not touched, `x` computed, `0` `1` forced. Rows follow the chapters of the
//! "Statement List for S7-300 and S7-400" reference manual. `CALL` has a syntax of its own and no row.

/// The two sets of mnemonics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Mnemonics {
    /// International: `A`, `JC`, `I 0.0`.
    #[default]
    En,
    /// German: `U`, `SPB`, `E 0.0`.
    De,
}

/// What an instruction accepts as operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OperandClass {
    None,
    /// A bit to scan: I Q M L DBX DIX, T, C, a status bit.
    Bit,
    BitOrNone,
    /// A bit to write.
    BitWrite,
    /// A bit to write, or a counter.
    BitWriteOrCounter,
    /// A bit to write, a timer or a counter.
    BitWriteOrCell,
    LoadSource,
    TransferTarget,
    Timer,
    Counter,
    /// A timer or a counter.
    Cell,
    /// AR1: nothing, a double word, a pointer constant or AR2.
    LoadAr1,
    /// AR2: nothing, a double word or a pointer constant.
    LoadAr2,
    /// AR1: nothing, a double word or AR2.
    TransferAr1,
    /// AR2: nothing or a double word.
    TransferAr2,
    /// Nothing or an area-internal pointer constant.
    PointerOrNone,
    /// 0..=255.
    Byte,
    /// An INT or DINT constant.
    AddConstant,
    WordConstOrNone,
    DwordConstOrNone,
    /// Nothing or 0..=15.
    ShiftCount16,
    /// Nothing or 0..=32.
    ShiftCount32,
    Label,
    /// FC, FB, SFC, SFB.
    Block,
    /// DB or DI.
    DataBlock,
}

impl OperandClass {
    /// True if the operand may be omitted.
    pub const fn may_be_missing(self) -> bool {
        match self {
            OperandClass::None
            | OperandClass::BitOrNone
            | OperandClass::LoadAr1
            | OperandClass::LoadAr2
            | OperandClass::TransferAr1
            | OperandClass::TransferAr2
            | OperandClass::PointerOrNone
            | OperandClass::WordConstOrNone
            | OperandClass::DwordConstOrNone
            | OperandClass::ShiftCount16
            | OperandClass::ShiftCount32 => true,
            OperandClass::Bit
            | OperandClass::BitWrite
            | OperandClass::BitWriteOrCounter
            | OperandClass::BitWriteOrCell
            | OperandClass::LoadSource
            | OperandClass::TransferTarget
            | OperandClass::Timer
            | OperandClass::Counter
            | OperandClass::Cell
            | OperandClass::Byte
            | OperandClass::AddConstant
            | OperandClass::Label
            | OperandClass::Block
            | OperandClass::DataBlock => false,
        }
    }
}

macro_rules! stl_instructions {
    ($( $(#[doc = $doc:literal])* $variant:ident { en: $en:literal, de: $de:literal, operand: $operand:ident, status: $status:literal } )*) => {
        /// An instruction of STL.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum StlInsn { $( $(#[doc = $doc])* $variant ),* }

        impl StlInsn {
            pub const ALL: &'static [StlInsn] = &[ $(StlInsn::$variant),* ];

            /// Name of the row, as in `AddI`.
            pub const fn row(self) -> &'static str {
                match self { $(StlInsn::$variant => stringify!($variant)),* }
            }

            pub const fn mnemonic(self, set: Mnemonics) -> &'static str {
                match set {
                    Mnemonics::En => match self { $(StlInsn::$variant => $en),* },
                    Mnemonics::De => match self { $(StlInsn::$variant => $de),* },
                }
            }

            pub const fn operand(self) -> OperandClass {
                match self { $(StlInsn::$variant => OperandClass::$operand),* }
            }

            /// True for `A( AN( O( ON( X( XN(`.
            pub const fn opens_nesting(self) -> bool {
                matches!(
                    self,
                    StlInsn::AndNest
                        | StlInsn::AndNotNest
                        | StlInsn::OrNest
                        | StlInsn::OrNotNest
                        | StlInsn::XorNest
                        | StlInsn::XorNotNest
                )
            }

            /// Effect on BR CC1 CC0 OV OS OR STA RLO /FC; see the module comment.
            pub const fn status(self) -> &'static str {
                match self { $(StlInsn::$variant => $status),* }
            }

            /// What the instruction does.
            pub const fn doc(self) -> &'static str {
                match self { $(StlInsn::$variant => concat!($($doc),*)),* }
            }
        }
    };
}

stl_instructions! {
    /// AND: combines the RLO with the bit.
    And { en: "A", de: "U", operand: Bit, status: "- - - - - x x x 1" }
    /// AND NOT: combines the RLO with the negated bit.
    AndNot { en: "AN", de: "UN", operand: Bit, status: "- - - - - x x x 1" }
    /// OR: combines the RLO with the bit. Without operand: AND before OR.
    Or { en: "O", de: "O", operand: BitOrNone, status: "- - - - - x x x 1" }
    /// OR NOT: combines the RLO with the negated bit.
    OrNot { en: "ON", de: "ON", operand: Bit, status: "- - - - - 0 x x 1" }
    /// Exclusive OR: combines the RLO with the bit.
    Xor { en: "X", de: "X", operand: Bit, status: "- - - - - 0 x x 1" }
    /// Exclusive OR NOT: combines the RLO with the negated bit.
    XorNot { en: "XN", de: "XN", operand: Bit, status: "- - - - - 0 x x 1" }
    /// Opens a parenthesis whose result is combined as with `A`.
    AndNest { en: "A(", de: "U(", operand: None, status: "- - - - - 0 1 - 0" }
    /// Opens a parenthesis whose result is combined as with `AN`.
    AndNotNest { en: "AN(", de: "UN(", operand: None, status: "- - - - - 0 1 - 0" }
    /// Opens a parenthesis whose result is combined as with `O`.
    OrNest { en: "O(", de: "O(", operand: None, status: "- - - - - 0 1 - 0" }
    /// Opens a parenthesis whose result is combined as with `ON`.
    OrNotNest { en: "ON(", de: "ON(", operand: None, status: "- - - - - 0 1 - 0" }
    /// Opens a parenthesis whose result is combined as with `X`.
    XorNest { en: "X(", de: "X(", operand: None, status: "- - - - - 0 1 - 0" }
    /// Opens a parenthesis whose result is combined as with `XN`.
    XorNotNest { en: "XN(", de: "XN(", operand: None, status: "- - - - - 0 1 - 0" }
    /// Closes the parenthesis: combines its RLO with the one before; BR is as it was at the opening.
    CloseNest { en: ")", de: ")", operand: None, status: "x - - - - x 1 x 1" }
    /// Writes the RLO to the bit (0 in a switched-off MCR zone).
    Assign { en: "=", de: "=", operand: BitWrite, status: "- - - - - 0 x - 0" }
    /// Sets the bit if the RLO is 1. With a counter: presets it from ACCU1 on a rising edge of the RLO.
    Set { en: "S", de: "S", operand: BitWriteOrCounter, status: "- - - - - 0 x - 0" }
    /// Resets the bit, timer or counter if the RLO is 1.
    Reset { en: "R", de: "R", operand: BitWriteOrCell, status: "- - - - - 0 x - 0" }
    /// Negates the RLO.
    Not { en: "NOT", de: "NOT", operand: None, status: "- - - - - - 1 x -" }
    /// Sets the RLO to 1.
    SetRlo { en: "SET", de: "SET", operand: None, status: "- - - - - 0 1 1 0" }
    /// Sets the RLO to 0.
    ClearRlo { en: "CLR", de: "CLR", operand: None, status: "- - - - - 0 0 0 0" }
    /// Copies the RLO to BR.
    Save { en: "SAVE", de: "SAVE", operand: None, status: "x - - - - - - - -" }
    /// Rising edge of the RLO; the bit remembers the RLO of the last cycle.
    EdgePositive { en: "FP", de: "FP", operand: BitWrite, status: "- - - - - 0 x x 1" }
    /// Falling edge of the RLO; the bit remembers the RLO of the last cycle.
    EdgeNegative { en: "FN", de: "FN", operand: BitWrite, status: "- - - - - 0 x x 1" }
    /// Loads a value into ACCU1; the old ACCU1 goes to ACCU2.
    Load { en: "L", de: "L", operand: LoadSource, status: "- - - - - - - - -" }
    /// Loads the value of a timer or counter in BCD.
    LoadBcd { en: "LC", de: "LC", operand: Cell, status: "- - - - - - - - -" }
    /// Transfers ACCU1 to the operand (0 in a switched-off MCR zone). `T STW` writes the status word.
    Transfer { en: "T", de: "T", operand: TransferTarget, status: "- - - - - - - - -" }
    /// Loads AR1 from ACCU1 or the operand.
    LoadAr1 { en: "LAR1", de: "LAR1", operand: LoadAr1, status: "- - - - - - - - -" }
    /// Loads AR2 from ACCU1 or the operand.
    LoadAr2 { en: "LAR2", de: "LAR2", operand: LoadAr2, status: "- - - - - - - - -" }
    /// Transfers AR1 to ACCU1 or the operand.
    TransferAr1 { en: "TAR1", de: "TAR1", operand: TransferAr1, status: "- - - - - - - - -" }
    /// Transfers AR2 to ACCU1 or the operand.
    TransferAr2 { en: "TAR2", de: "TAR2", operand: TransferAr2, status: "- - - - - - - - -" }
    /// Exchanges AR1 and AR2.
    SwapAr { en: "CAR", de: "TAR", operand: None, status: "- - - - - - - - -" }
    /// Adds ACCU1-L or the pointer constant to AR1.
    AddAr1 { en: "+AR1", de: "+AR1", operand: PointerOrNone, status: "- - - - - - - - -" }
    /// Adds ACCU1-L or the pointer constant to AR2.
    AddAr2 { en: "+AR2", de: "+AR2", operand: PointerOrNone, status: "- - - - - - - - -" }
    /// Exchanges ACCU1 and ACCU2.
    SwapAccu { en: "TAK", de: "TAK", operand: None, status: "- - - - - - - - -" }
    /// Copies ACCU1 to ACCU2 (on 4 accumulators 2 to 3 and 3 to 4 before).
    Push { en: "PUSH", de: "PUSH", operand: None, status: "- - - - - - - - -" }
    /// Copies ACCU2 to ACCU1 (on 4 accumulators 3 to 2 and 4 to 3 after).
    Pop { en: "POP", de: "POP", operand: None, status: "- - - - - - - - -" }
    /// Copies ACCU3 to ACCU4 and ACCU2 to ACCU3. Only with 4 accumulators.
    Enter { en: "ENT", de: "ENT", operand: None, status: "- - - - - - - - -" }
    /// Copies ACCU3 to ACCU2 and ACCU4 to ACCU3. Only with 4 accumulators.
    Leave { en: "LEAVE", de: "LEAVE", operand: None, status: "- - - - - - - - -" }
    /// Adds the constant to ACCU1-LL, modulo 256.
    Increment { en: "INC", de: "INC", operand: Byte, status: "- - - - - - - - -" }
    /// Subtracts the constant from ACCU1-LL, modulo 256.
    Decrement { en: "DEC", de: "DEC", operand: Byte, status: "- - - - - - - - -" }
    /// Exchanges the two bytes of ACCU1-L.
    SwapBytesWord { en: "CAW", de: "TAW", operand: None, status: "- - - - - - - - -" }
    /// Reverses the four bytes of ACCU1.
    SwapBytesDword { en: "CAD", de: "TAD", operand: None, status: "- - - - - - - - -" }
    /// No effect: a hint for the editor.
    Display { en: "BLD", de: "BLD", operand: Byte, status: "- - - - - - - - -" }
    /// No effect.
    Nop { en: "NOP", de: "NOP", operand: Byte, status: "- - - - - - - - -" }
    /// Adds an INT constant to ACCU1-L, a DINT constant to ACCU1.
    AddConst { en: "+", de: "+", operand: AddConstant, status: "- - - - - - - - -" }
    /// ACCU1-L := ACCU2-L + ACCU1-L.
    AddI { en: "+I", de: "+I", operand: None, status: "- x x x x - - - -" }
    /// ACCU1-L := ACCU2-L - ACCU1-L.
    SubI { en: "-I", de: "-I", operand: None, status: "- x x x x - - - -" }
    /// ACCU1 := ACCU2-L * ACCU1-L, 32 bits.
    MulI { en: "*I", de: "*I", operand: None, status: "- x x x x - - - -" }
    /// ACCU1-L := ACCU2-L / ACCU1-L, ACCU1-H := remainder.
    DivI { en: "/I", de: "/I", operand: None, status: "- x x x x - - - -" }
    /// ACCU1 := ACCU2 + ACCU1.
    AddD { en: "+D", de: "+D", operand: None, status: "- x x x x - - - -" }
    /// ACCU1 := ACCU2 - ACCU1.
    SubD { en: "-D", de: "-D", operand: None, status: "- x x x x - - - -" }
    /// ACCU1 := ACCU2 * ACCU1.
    MulD { en: "*D", de: "*D", operand: None, status: "- x x x x - - - -" }
    /// ACCU1 := ACCU2 / ACCU1.
    DivD { en: "/D", de: "/D", operand: None, status: "- x x x x - - - -" }
    /// ACCU1 := remainder of ACCU2 / ACCU1.
    ModD { en: "MOD", de: "MOD", operand: None, status: "- x x x x - - - -" }
    /// ACCU1 := ACCU2 + ACCU1, REAL.
    AddR { en: "+R", de: "+R", operand: None, status: "- x x x x - - - -" }
    /// ACCU1 := ACCU2 - ACCU1, REAL.
    SubR { en: "-R", de: "-R", operand: None, status: "- x x x x - - - -" }
    /// ACCU1 := ACCU2 * ACCU1, REAL.
    MulR { en: "*R", de: "*R", operand: None, status: "- x x x x - - - -" }
    /// ACCU1 := ACCU2 / ACCU1, REAL.
    DivR { en: "/R", de: "/R", operand: None, status: "- x x x x - - - -" }
    /// Clears the sign of the REAL in ACCU1.
    AbsR { en: "ABS", de: "ABS", operand: None, status: "- - - - - - - - -" }
    /// Changes the sign of the REAL in ACCU1.
    NegR { en: "NEGR", de: "NEGR", operand: None, status: "- - - - - - - - -" }
    /// Square of the REAL in ACCU1.
    SqrR { en: "SQR", de: "SQR", operand: None, status: "- x x x x - - - -" }
    /// Square root of the REAL in ACCU1.
    SqrtR { en: "SQRT", de: "SQRT", operand: None, status: "- x x x x - - - -" }
    /// Exponential of the REAL in ACCU1.
    ExpR { en: "EXP", de: "EXP", operand: None, status: "- x x x x - - - -" }
    /// Natural logarithm of the REAL in ACCU1.
    LnR { en: "LN", de: "LN", operand: None, status: "- x x x x - - - -" }
    /// Sine of the REAL in ACCU1.
    SinR { en: "SIN", de: "SIN", operand: None, status: "- x x x x - - - -" }
    /// Cosine of the REAL in ACCU1.
    CosR { en: "COS", de: "COS", operand: None, status: "- x x x x - - - -" }
    /// Tangent of the REAL in ACCU1.
    TanR { en: "TAN", de: "TAN", operand: None, status: "- x x x x - - - -" }
    /// Arc sine of the REAL in ACCU1.
    AsinR { en: "ASIN", de: "ASIN", operand: None, status: "- x x x x - - - -" }
    /// Arc cosine of the REAL in ACCU1.
    AcosR { en: "ACOS", de: "ACOS", operand: None, status: "- x x x x - - - -" }
    /// Arc tangent of the REAL in ACCU1.
    AtanR { en: "ATAN", de: "ATAN", operand: None, status: "- x x x x - - - -" }
    /// RLO := ACCU2 == ACCU1, as INT.
    CompareEqI { en: "==I", de: "==I", operand: None, status: "- x x 0 - 0 x x 1" }
    /// RLO := ACCU2 <> ACCU1, as INT.
    CompareNeI { en: "<>I", de: "<>I", operand: None, status: "- x x 0 - 0 x x 1" }
    /// RLO := ACCU2 > ACCU1, as INT.
    CompareGtI { en: ">I", de: ">I", operand: None, status: "- x x 0 - 0 x x 1" }
    /// RLO := ACCU2 < ACCU1, as INT.
    CompareLtI { en: "<I", de: "<I", operand: None, status: "- x x 0 - 0 x x 1" }
    /// RLO := ACCU2 >= ACCU1, as INT.
    CompareGeI { en: ">=I", de: ">=I", operand: None, status: "- x x 0 - 0 x x 1" }
    /// RLO := ACCU2 <= ACCU1, as INT.
    CompareLeI { en: "<=I", de: "<=I", operand: None, status: "- x x 0 - 0 x x 1" }
    /// RLO := ACCU2 == ACCU1, as DINT.
    CompareEqD { en: "==D", de: "==D", operand: None, status: "- x x 0 - 0 x x 1" }
    /// RLO := ACCU2 <> ACCU1, as DINT.
    CompareNeD { en: "<>D", de: "<>D", operand: None, status: "- x x 0 - 0 x x 1" }
    /// RLO := ACCU2 > ACCU1, as DINT.
    CompareGtD { en: ">D", de: ">D", operand: None, status: "- x x 0 - 0 x x 1" }
    /// RLO := ACCU2 < ACCU1, as DINT.
    CompareLtD { en: "<D", de: "<D", operand: None, status: "- x x 0 - 0 x x 1" }
    /// RLO := ACCU2 >= ACCU1, as DINT.
    CompareGeD { en: ">=D", de: ">=D", operand: None, status: "- x x 0 - 0 x x 1" }
    /// RLO := ACCU2 <= ACCU1, as DINT.
    CompareLeD { en: "<=D", de: "<=D", operand: None, status: "- x x 0 - 0 x x 1" }
    /// RLO := ACCU2 == ACCU1, as REAL.
    CompareEqR { en: "==R", de: "==R", operand: None, status: "- x x x x 0 x x 1" }
    /// RLO := ACCU2 <> ACCU1, as REAL.
    CompareNeR { en: "<>R", de: "<>R", operand: None, status: "- x x x x 0 x x 1" }
    /// RLO := ACCU2 > ACCU1, as REAL.
    CompareGtR { en: ">R", de: ">R", operand: None, status: "- x x x x 0 x x 1" }
    /// RLO := ACCU2 < ACCU1, as REAL.
    CompareLtR { en: "<R", de: "<R", operand: None, status: "- x x x x 0 x x 1" }
    /// RLO := ACCU2 >= ACCU1, as REAL.
    CompareGeR { en: ">=R", de: ">=R", operand: None, status: "- x x x x 0 x x 1" }
    /// RLO := ACCU2 <= ACCU1, as REAL.
    CompareLeR { en: "<=R", de: "<=R", operand: None, status: "- x x x x 0 x x 1" }
    /// Three BCD digits in ACCU1-L to INT.
    BcdToI { en: "BTI", de: "BTI", operand: None, status: "- - - - - - - - -" }
    /// INT in ACCU1-L to three BCD digits.
    IToBcd { en: "ITB", de: "ITB", operand: None, status: "- - - x x - - - -" }
    /// Seven BCD digits in ACCU1 to DINT.
    BcdToD { en: "BTD", de: "BTD", operand: None, status: "- - - - - - - - -" }
    /// INT in ACCU1-L to DINT.
    IToD { en: "ITD", de: "ITD", operand: None, status: "- - - - - - - - -" }
    /// DINT in ACCU1 to seven BCD digits.
    DToBcd { en: "DTB", de: "DTB", operand: None, status: "- - - x x - - - -" }
    /// DINT in ACCU1 to REAL.
    DToR { en: "DTR", de: "DTR", operand: None, status: "- - - - - - - - -" }
    /// One's complement of ACCU1-L.
    InvertI { en: "INVI", de: "INVI", operand: None, status: "- - - - - - - - -" }
    /// One's complement of ACCU1.
    InvertD { en: "INVD", de: "INVD", operand: None, status: "- - - - - - - - -" }
    /// Two's complement of ACCU1-L.
    NegI { en: "NEGI", de: "NEGI", operand: None, status: "- x x x x - - - -" }
    /// Two's complement of ACCU1.
    NegD { en: "NEGD", de: "NEGD", operand: None, status: "- x x x x - - - -" }
    /// REAL in ACCU1 to DINT, to nearest, ties to even.
    Round { en: "RND", de: "RND", operand: None, status: "- - - x x - - - -" }
    /// REAL in ACCU1 to the next DINT above.
    RoundUp { en: "RND+", de: "RND+", operand: None, status: "- - - x x - - - -" }
    /// REAL in ACCU1 to the next DINT below.
    RoundDown { en: "RND-", de: "RND-", operand: None, status: "- - - x x - - - -" }
    /// REAL in ACCU1 to DINT, towards zero.
    Truncate { en: "TRUNC", de: "TRUNC", operand: None, status: "- - - x x - - - -" }
    /// AND of ACCU1-L with ACCU2-L or with the constant.
    AndW { en: "AW", de: "UW", operand: WordConstOrNone, status: "- x 0 0 - - - - -" }
    /// OR of ACCU1-L with ACCU2-L or with the constant.
    OrW { en: "OW", de: "OW", operand: WordConstOrNone, status: "- x 0 0 - - - - -" }
    /// Exclusive OR of ACCU1-L with ACCU2-L or with the constant.
    XorW { en: "XOW", de: "XOW", operand: WordConstOrNone, status: "- x 0 0 - - - - -" }
    /// AND of ACCU1 with ACCU2 or with the constant.
    AndD { en: "AD", de: "UD", operand: DwordConstOrNone, status: "- x 0 0 - - - - -" }
    /// OR of ACCU1 with ACCU2 or with the constant.
    OrD { en: "OD", de: "OD", operand: DwordConstOrNone, status: "- x 0 0 - - - - -" }
    /// Exclusive OR of ACCU1 with ACCU2 or with the constant.
    XorD { en: "XOD", de: "XOD", operand: DwordConstOrNone, status: "- x 0 0 - - - - -" }
    /// Shifts ACCU1-L right, filling with the sign.
    ShiftSignedI { en: "SSI", de: "SSI", operand: ShiftCount16, status: "- x 0 0 - - - - -" }
    /// Shifts ACCU1 right, filling with the sign.
    ShiftSignedD { en: "SSD", de: "SSD", operand: ShiftCount32, status: "- x 0 0 - - - - -" }
    /// Shifts ACCU1-L left.
    ShiftLeftW { en: "SLW", de: "SLW", operand: ShiftCount16, status: "- x 0 0 - - - - -" }
    /// Shifts ACCU1-L right.
    ShiftRightW { en: "SRW", de: "SRW", operand: ShiftCount16, status: "- x 0 0 - - - - -" }
    /// Shifts ACCU1 left.
    ShiftLeftD { en: "SLD", de: "SLD", operand: ShiftCount32, status: "- x 0 0 - - - - -" }
    /// Shifts ACCU1 right.
    ShiftRightD { en: "SRD", de: "SRD", operand: ShiftCount32, status: "- x 0 0 - - - - -" }
    /// Rotates ACCU1 left.
    RotateLeftD { en: "RLD", de: "RLD", operand: ShiftCount32, status: "- x 0 0 - - - - -" }
    /// Rotates ACCU1 right.
    RotateRightD { en: "RRD", de: "RRD", operand: ShiftCount32, status: "- x 0 0 - - - - -" }
    /// Rotates ACCU1 left by 1 through CC1.
    RotateLeftCc1 { en: "RLDA", de: "RLDA", operand: None, status: "- x 0 0 - - - - -" }
    /// Rotates ACCU1 right by 1 through CC1.
    RotateRightCc1 { en: "RRDA", de: "RRDA", operand: None, status: "- x 0 0 - - - - -" }
    /// Starts the timer as pulse timer with the S5TIME in ACCU1-L.
    TimerPulse { en: "SP", de: "SI", operand: Timer, status: "- - - - - 0 - - 0" }
    /// Starts the timer as extended pulse timer with the S5TIME in ACCU1-L.
    TimerExtendedPulse { en: "SE", de: "SV", operand: Timer, status: "- - - - - 0 - - 0" }
    /// Starts the timer as on-delay timer with the S5TIME in ACCU1-L.
    TimerOnDelay { en: "SD", de: "SE", operand: Timer, status: "- - - - - 0 - - 0" }
    /// Starts the timer as retentive on-delay timer with the S5TIME in ACCU1-L.
    TimerRetentiveOnDelay { en: "SS", de: "SS", operand: Timer, status: "- - - - - 0 - - 0" }
    /// Starts the timer as off-delay timer with the S5TIME in ACCU1-L.
    TimerOffDelay { en: "SF", de: "SA", operand: Timer, status: "- - - - - 0 - - 0" }
    /// Enables a timer or counter on a rising edge of the RLO.
    Enable { en: "FR", de: "FR", operand: Cell, status: "- - - - - 0 - - 0" }
    /// Counts up by 1 on a rising edge of the RLO.
    CountUp { en: "CU", de: "ZV", operand: Counter, status: "- - - - - 0 - - 0" }
    /// Counts down by 1 on a rising edge of the RLO.
    CountDown { en: "CD", de: "ZR", operand: Counter, status: "- - - - - 0 - - 0" }
    /// Jumps.
    Jump { en: "JU", de: "SPA", operand: Label, status: "- - - - - - - - -" }
    /// Jumps if the RLO is 1.
    JumpIf { en: "JC", de: "SPB", operand: Label, status: "- - - - - 0 1 1 0" }
    /// Jumps if the RLO is 0.
    JumpIfNot { en: "JCN", de: "SPBN", operand: Label, status: "- - - - - 0 1 1 0" }
    /// Jumps if the RLO is 1; copies it to BR.
    JumpIfBr { en: "JCB", de: "SPBB", operand: Label, status: "x - - - - 0 1 1 0" }
    /// Jumps if the RLO is 0; copies it to BR.
    JumpIfNotBr { en: "JNB", de: "SPBNB", operand: Label, status: "x - - - - 0 1 1 0" }
    /// Jumps if BR is 1.
    JumpBr { en: "JBI", de: "SPBI", operand: Label, status: "- - - - - 0 1 - 0" }
    /// Jumps if BR is 0.
    JumpNotBr { en: "JNBI", de: "SPBIN", operand: Label, status: "- - - - - 0 1 - 0" }
    /// Jumps if OV is 1.
    JumpOv { en: "JO", de: "SPO", operand: Label, status: "- - - - - - - - -" }
    /// Jumps if OS is 1 and clears it.
    JumpOs { en: "JOS", de: "SPS", operand: Label, status: "- - - - 0 - - - -" }
    /// Jumps if the last result was 0.
    JumpZero { en: "JZ", de: "SPZ", operand: Label, status: "- - - - - - - - -" }
    /// Jumps if the last result was not 0.
    JumpNotZero { en: "JN", de: "SPN", operand: Label, status: "- - - - - - - - -" }
    /// Jumps if the last result was above 0.
    JumpPositive { en: "JP", de: "SPP", operand: Label, status: "- - - - - - - - -" }
    /// Jumps if the last result was below 0.
    JumpNegative { en: "JM", de: "SPM", operand: Label, status: "- - - - - - - - -" }
    /// Jumps if the last result was 0 or above.
    JumpNotNegative { en: "JPZ", de: "SPPZ", operand: Label, status: "- - - - - - - - -" }
    /// Jumps if the last result was 0 or below.
    JumpNotPositive { en: "JMZ", de: "SPMZ", operand: Label, status: "- - - - - - - - -" }
    /// Jumps if the last result was invalid.
    JumpUnordered { en: "JUO", de: "SPU", operand: Label, status: "- - - - - - - - -" }
    /// Jump distributor: executes the JU in the list after it that ACCU1-LL numbers.
    JumpList { en: "JL", de: "SPL", operand: Label, status: "- - - - - - - - -" }
    /// Decrements ACCU1-L; jumps if it is not 0.
    Loop { en: "LOOP", de: "LOOP", operand: Label, status: "- - - - - - - - -" }
    /// Calls a block without parameters.
    CallUnconditional { en: "UC", de: "UC", operand: Block, status: "- - - - 0 0 1 - 0" }
    /// Calls a block without parameters if the RLO is 1.
    CallConditional { en: "CC", de: "CC", operand: Block, status: "- - - - 0 0 1 1 0" }
    /// Ends the block.
    BlockEnd { en: "BE", de: "BE", operand: None, status: "- - - - 0 0 1 - 0" }
    /// Ends the block at this place.
    BlockEndUnconditional { en: "BEU", de: "BEA", operand: None, status: "- - - - 0 0 1 - 0" }
    /// Ends the block if the RLO is 1.
    BlockEndConditional { en: "BEC", de: "BEB", operand: None, status: "- - - - x 0 1 1 0" }
    /// Opens a data block in the DB or DI register.
    OpenDb { en: "OPN", de: "AUF", operand: DataBlock, status: "- - - - - - - - -" }
    /// Exchanges the DB and the DI register.
    SwapDb { en: "CDB", de: "TDB", operand: None, status: "- - - - - - - - -" }
    /// Makes the master control relay act from here.
    McrActivate { en: "MCRA", de: "MCRA", operand: None, status: "- - - - - - - - -" }
    /// Makes the master control relay inactive from here.
    McrDeactivate { en: "MCRD", de: "MCRD", operand: None, status: "- - - - - - - - -" }
    /// Opens an MCR zone that is on if the RLO is 1.
    McrOpen { en: "MCR(", de: "MCR(", operand: None, status: "- - - - - 0 1 - 0" }
    /// Closes an MCR zone.
    McrClose { en: ")MCR", de: ")MCR", operand: None, status: "- - - - - 0 1 - 0" }
}
