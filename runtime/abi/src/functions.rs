//! The table of runtime functions that generated code calls.
//!
//! One row defines the name, the parameters and the result; the linker symbol is `plcc_rt_` + name. The runtime defines
//! each as `extern "C"`; unless a row is `pure`, a pointer to the memory base is before the listed parameters.
//! A `site` is an index into the sites of the program image.
//! `i1`, `i8` and `i16` never cross this border: bits and bytes travel as `i32`, 0 or 1 for a bit.

/// Types of the IR and of this border.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Type {
    I1,
    I8,
    I16,
    I32,
    I64,
    F32,
    F64,
}

impl Type {
    /// Width in bits.
    pub const fn bits(self) -> u32 {
        match self {
            Type::I1 => 1,
            Type::I8 => 8,
            Type::I16 => 16,
            Type::I32 | Type::F32 => 32,
            Type::I64 | Type::F64 => 64,
        }
    }

    /// Width in memory, in bytes.
    pub const fn bytes(self) -> u32 {
        self.bits().div_ceil(8)
    }

    pub const fn is_int(self) -> bool {
        !matches!(self, Type::F32 | Type::F64)
    }

    /// Name in the text form of the IR.
    pub const fn name(self) -> &'static str {
        match self {
            Type::I1 => "i1",
            Type::I8 => "i8",
            Type::I16 => "i16",
            Type::I32 => "i32",
            Type::I64 => "i64",
            Type::F32 => "f32",
            Type::F64 => "f64",
        }
    }
}

/// What a runtime function may do to PLC memory, for the optimiser.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Effect {
    /// No memory at all; the same arguments have the same result. No memory pointer is passed.
    Pure,
    /// Touches timer or counter cells and the clock only.
    Cells,
    /// Touches the system area of an S7-200, timers, the clock and simulated hardware.
    System,
    /// Touches the I/O driver and the process image of outputs.
    Io,
    /// Reads any memory and changes none.
    Reads,
    /// May run organization blocks, so it may read and write everything.
    All,
}

macro_rules! runtime_functions {
    ($( $(#[$doc:meta])* $variant:ident = $name:literal ( $($param:ident : $pty:ident),* ) $(-> $rty:ident)? , $effect:ident ; )*) => {
        /// A runtime function; see the module comment.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum RuntimeFn { $( $(#[$doc])* $variant ),* }

        impl RuntimeFn {
            pub const ALL: &'static [RuntimeFn] = &[ $(RuntimeFn::$variant),* ];

            /// Name in the text form of the IR; the linker symbol is `plcc_rt_` before it.
            pub const fn name(self) -> &'static str {
                match self { $(RuntimeFn::$variant => $name),* }
            }

            /// The linker symbol.
            pub const fn symbol(self) -> &'static str {
                match self { $(RuntimeFn::$variant => concat!("plcc_rt_", $name)),* }
            }

            /// Types of the parameters, without the memory pointer.
            pub const fn params(self) -> &'static [Type] {
                match self { $(RuntimeFn::$variant => &[ $(Type::$pty),* ]),* }
            }

            pub const fn result(self) -> Option<Type> {
                match self { $(RuntimeFn::$variant => runtime_functions!(@result $($rty)?)),* }
            }

            pub const fn effect(self) -> Effect {
                match self { $(RuntimeFn::$variant => Effect::$effect),* }
            }
        }
    };
    (@result) => { None };
    (@result $rty:ident) => { Some(Type::$rty) };
}

runtime_functions! {
    /// Something is due at `site` (interrupt, STOP, end of the test): runs it. Result not 0: the CPU goes to STOP, leave the block
    /// at once.
    Safepoint = "safepoint"(site: I32) -> I32, All;
    /// Synchronous error `code` (see `codes::sync`) at `site`; `access` is the access byte, `info` the fault register
    /// (address or number). Runs OB 121 or OB 122, else STOP. Result as `Safepoint`; afterwards SUBSTITUTE holds the value that a
    /// read returns.
    SyncError = "sync_error"(site: I32, code: I32, access: I32, info: I32) -> I32, All;
    /// As `SyncError`, in a block that contains GET_ERROR or GET_ERR_ID: keeps the first error in the frame at `lbase`. Result as
    /// `Safepoint`.
    LocalError = "local_error"(site: I32, code: I32, access: I32, info: I32, lbase: I32) -> I32, All;
    /// STOP with event `code` (see `codes::stop`) at `site`. The block must be left at once.
    Stop = "stop"(site: I32, code: I32), All;
    /// Calls a block whose number is known at run time only. `kind` is a [`BlockKind`](crate::image::BlockKind) as
    /// number. Registers travel in the CPU state. `lbase` is where the callee's frame begins, `vbase` where the
    /// caller's does. A missing block is a synchronous error. Result as `Safepoint`.
    CallBlock = "call_block"(site: I32, kind: I32, number: I32, lbase: I32, vbase: I32) -> I32, All;
    /// Calls system function `number`; its parameters are at `block`, laid out like a structure (IN, OUT, IN_OUT).
    /// `lbase` is the caller's frame, to which L and V pointers among them refer. Result: bit 0 BR, bit 1 as `Safepoint`.
    SystemFunction = "system_function"(site: I32, number: I32, block: I32, lbase: I32) -> I32, All;

    /// Milliseconds since the start of the CPU, 31 bits of them (SFC 64 TIME_TCK).
    TimeTck = "time_tck"() -> I32, Cells;

    /// Starts timer `number` in `mode` (a [`TimerMode`]) with the S5TIME in `value`, by the edge of `rlo`. Number and value are valid;
    /// the value does not matter if it is not used.
    TimerStart = "timer_start"(number: I32, mode: I32, value: I32, rlo: I32), Cells;
    /// Brings the cell of timer `number`, which exists, up to date.
    TimerSettle = "timer_settle"(number: I32), Cells;

    /// Reads `bytes` (1, 2, 4) at peripheral address `address`. Result: value in the low half; bit 32 set: no module there.
    PeripheralRead = "peripheral_read"(address: I32, bytes: I32) -> I64, Io;
    /// Writes `bytes` at peripheral address `address`, and the output image where it covers it. Result not 0: no module there.
    PeripheralWrite = "peripheral_write"(address: I32, bytes: I32, value: I32) -> I32, Io;

    /// Writes bit `bit` of the peripheral output byte `address` and of the output image; the other bits of the module stay. Result as
    /// `PeripheralWrite`.
    PeripheralWriteBit = "peripheral_write_bit"(address: I32, bit: I32, value: I32) -> I32, Io;

    /// Brings the values of comparison `comparison` of assertion `id` of a test, zero-extended; a constant side brings 0. How they are
    /// compared is in the program image.
    Assert = "assert"(id: I32, comparison: I32, left: I32, right: I32), Cells;
    /// As `Assert` for values of 64 bits, each in two halves.
    AssertLong = "assert_long"(id: I32, comparison: I32, left: I32, left_high: I32, right: I32, right_high: I32), Cells;
    /// As `AssertLong` where a side is an offset from the memory base: the value there is read.
    AssertMemory = "assert_memory"(id: I32, comparison: I32, left: I32, left_high: I32, right: I32, right_high: I32), All;
    /// Lets `ms` milliseconds pass on the clock, due interrupts included. Result as `Safepoint`.
    Sleep = "sleep"(ms: I32) -> I32, All;

    // Probes, which only a program that is made to be looked at contains. `place` is an index into its list of places; nothing
    // changes by them.

    /// A block begins at `place`; `instance` is the offset of its instance from the memory base, 0 if it has none.
    ProbeEnter = "probe_enter"(place: I32, instance: I32), All;
    /// The block that has begun last ends.
    ProbeLeave = "probe_leave"(place: I32), All;
    /// The statement at `place` is about to run in the frame at `local` from the memory base. What it has in registers is in the CPU
    /// state from [`PROBED`](crate::layout::state::PROBED) on, and comes from there afterwards.
    ProbeStatement = "probe_statement"(place: I32, local: I32), All;
    /// The statement at `place` has run: the status word, accumulators, address registers, and DB in the low and DI in the high half of
    /// `dbs`.
    ProbeRegisters =
        "probe_registers"(place: I32, status: I32, accu1: I32, accu2: I32, ar1: I32, ar2: I32, dbs: I32), All;
    /// A value at `place`, zero-extended: of a variable, a condition or a pin, or the logic stack of an S7-200 with S0 in bit 0.
    ProbeValue = "probe_value"(place: I32, value: I64), All;

    /// Copies the text at offset `from` from the memory base to the one at `to`: at most `limit` characters, with `u32::MAX` as many as the
    /// head at `to` allows. `wide` 1: WSTRING. Result 1: something was cut.
    CopyText = "copy_text"(to: I32, from: I32, limit: I32, wide: I32) -> I32, All;

    // Functions of texts of the library; `known` and the results are described at `plcc_abi::text`, `rules` at `text::Rules`.

    /// OUT := IN1, then IN2.
    TextConcat = "text_concat"(known: I64, in1: I32, in2: I32, out: I32) -> I64, All;
    /// OUT := IN1, then IN2, then IN3, as two calls do it. WRITTEN: the BR of the first of them.
    TextConcatThree = "text_concat_three"(known: I64, in1: I32, in2: I32, in3: I32, out: I32) -> I64, All;
    /// The relation of two texts: bit 0 of `relation`: less, bit 1: equal, bit 2: greater.
    TextCompare = "text_compare"(known: I64, in1: I32, in2: I32, relation: I32) -> I64, Reads;
    /// Position of the first IN2 in IN1.
    TextFind = "text_find"(known: I64, in1: I32, in2: I32, rules: I32) -> I64, Reads;
    /// The actual length, `maximum` 1: the maximum.
    TextLength = "text_length"(known: I64, text: I32, maximum: I32) -> I64, Reads;
    TextReplace = "text_replace"(known: I64, in1: I32, in2: I32, l: I32, p: I32, rules: I32, out: I32) -> I64, All;
    TextLeft = "text_left"(known: I64, text: I32, l: I32, rules: I32, out: I32) -> I64, All;
    TextRight = "text_right"(known: I64, text: I32, l: I32, rules: I32, out: I32) -> I64, All;
    TextMid = "text_mid"(known: I64, text: I32, l: I32, p: I32, out: I32) -> I64, All;
    TextDelete = "text_delete"(known: I64, text: I32, l: I32, p: I32, rules: I32, out: I32) -> I64, All;
    TextInsert = "text_insert"(known: I64, in1: I32, in2: I32, p: I32, rules: I32, out: I32) -> I64, All;
    /// OUT := a DINT in decimal.
    TextOfDint = "text_of_dint"(known: I64, value: I32, form: I32, out: I32) -> I64, All;
    /// OUT := a REAL, `+v.nnnnnnnE+xx`.
    TextOfReal = "text_of_real"(known: I64, value: I32, out: I32) -> I64, All;
    /// OUT := a REAL with a decimal point.
    TextFixedOfReal = "text_fixed_of_real"(known: I64, value: I32, out: I32) -> I64, All;
    /// A sign or none, then digits only.
    TextToDint = "text_to_dint"(known: I64, text: I32, longest: I32, low: I32, high: I32) -> I64, Reads;
    /// A REAL of the form `+v.nnnnnnnE+xx`.
    TextToReal = "text_to_real"(known: I64, text: I32) -> I64, Reads;
    /// The REAL at the beginning of a text.
    TextScanReal = "text_scan_real"(known: I64, text: I32) -> I64, Reads;
    /// The number at the beginning of a text, in the range of an INT (`kind` 2) or DINT (3).
    TextScan = "text_scan"(known: I64, text: I32, kind: I32) -> I64, Reads;

    /// An [`Operation`](crate::s7200::Operation) of an S7-200 by its number, with its operands. The result is described at
    /// [`s7200::result`](crate::s7200::result).
    S7200Operation = "s7200_operation"(site: I32, operation: I32, a: I32, b: I32, c: I32, d: I32) -> I64, All;
    /// The box of timer `number`: `kind` is a [`TimerKind`](crate::s7200::TimerKind), `preset` is PT, `enable` is 0 or 1.
    S7200Timer = "s7200_timer"(number: I32, kind: I32, preset: I32, enable: I32), System;
    /// Brings value and bit of the 1 ms timer `number` up to date.
    S7200TimerSync = "s7200_timer_sync"(number: I32), System;
    /// Where a pointer of an S7-200 points: offset from the memory base, if `bytes` bytes there may be read (`write` 0) or written (1);
    /// else 0. A read through it follows at once.
    S7200Pointer = "s7200_pointer"(pointer: I32, bytes: I32, write: I32) -> I32, System;
    /// Notes the non-fatal error `code` (see `s7200::error`) at `site`: SM4.3. The instruction does nothing else.
    S7200Error = "s7200_error"(site: I32, code: I32), System;
    /// Current value of high-speed counter `number`.
    S7200Counter = "s7200_counter"(number: I32) -> I32, System;
    /// Milliseconds since the CPU was switched on, 32 bits of them (BITIM).
    S7200Milliseconds = "s7200_milliseconds"() -> I32, Cells;
    /// The program has written special memory byte `byte`, one of those with a side effect.
    S7200SpecialWritten = "s7200_special_written"(byte: I32), System;

    Sin = "sin"(x: F32) -> F32, Pure;
    Cos = "cos"(x: F32) -> F32, Pure;
    Tan = "tan"(x: F32) -> F32, Pure;
    Asin = "asin"(x: F32) -> F32, Pure;
    Acos = "acos"(x: F32) -> F32, Pure;
    Atan = "atan"(x: F32) -> F32, Pure;
    Exp = "exp"(x: F32) -> F32, Pure;
    Ln = "ln"(x: F32) -> F32, Pure;
    /// To base 10.
    Log = "log"(x: F32) -> F32, Pure;
    /// `x` to the power `y`.
    Pow = "pow"(x: F32, y: F32) -> F32, Pure;
    SinLong = "sin_long"(x: F64) -> F64, Pure;
    CosLong = "cos_long"(x: F64) -> F64, Pure;
    TanLong = "tan_long"(x: F64) -> F64, Pure;
    AsinLong = "asin_long"(x: F64) -> F64, Pure;
    AcosLong = "acos_long"(x: F64) -> F64, Pure;
    AtanLong = "atan_long"(x: F64) -> F64, Pure;
    ExpLong = "exp_long"(x: F64) -> F64, Pure;
    LnLong = "ln_long"(x: F64) -> F64, Pure;
    LogLong = "log_long"(x: F64) -> F64, Pure;
    PowLong = "pow_long"(x: F64, y: F64) -> F64, Pure;
}

/// The five S5 timers, as passed to [`RuntimeFn::TimerStart`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum TimerMode {
    /// SP, German SI.
    Pulse,
    /// SE, German SV.
    ExtendedPulse,
    /// SD, German SE.
    OnDelay,
    /// SS.
    RetentiveOnDelay,
    /// SF, German SA.
    OffDelay,
}

impl TimerMode {
    pub const ALL: [TimerMode; 5] = [
        TimerMode::Pulse,
        TimerMode::ExtendedPulse,
        TimerMode::OnDelay,
        TimerMode::RetentiveOnDelay,
        TimerMode::OffDelay,
    ];
}
