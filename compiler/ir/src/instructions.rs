//! The instruction set of the IR.

use plcc_abi::RuntimeFn;
use thin_vec::ThinVec;

use crate::entities::{Block, FuncId, Value};

/// Names an operation in the text form and back.
macro_rules! ops {
    ($(#[$doc:meta])* $name:ident { $( $(#[$vdoc:meta])* $variant:ident = $text:literal ),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum $name { $( $(#[$vdoc])* $variant ),* }

        impl $name {
            pub const ALL: &'static [$name] = &[ $($name::$variant),* ];

            /// Name in the text form.
            pub const fn name(self) -> &'static str {
                match self { $($name::$variant => $text),* }
            }

            /// The operation with this name in the text form.
            pub fn from_name(name: &str) -> Option<$name> {
                $name::ALL.iter().copied().find(|op| op.name() == name)
            }
        }
    };
}

ops! {
    /// One operand, result of the same type.
    UnaryOp {
        /// Reverses the bytes of an i16, i32 or i64.
        Bswap = "bswap",
        /// Number of the lowest bit that is 1, of an i32 or i64; the width if there is none.
        Ctz = "ctz",
        Fneg = "fneg",
        Fabs = "fabs",
        Fsqrt = "fsqrt",
        /// Towards +infinity.
        Fceil = "fceil",
        /// Towards -infinity.
        Ffloor = "ffloor",
        /// Towards zero.
        Ftrunc = "ftrunc",
        /// To nearest, ties to even.
        Fnearest = "fnearest",
    }
}

ops! {
    /// Two operands of one type, result of the same type. Integer arithmetic wraps.
    BinaryOp {
        Iadd = "iadd",
        Isub = "isub",
        Imul = "imul",
        /// The divisor is not 0, and not -1 when the dividend is the least value: code that builds it guards it.
        Sdiv = "sdiv",
        /// As `sdiv`.
        Srem = "srem",
        /// The divisor is not 0.
        Udiv = "udiv",
        /// As `udiv`.
        Urem = "urem",
        And = "and",
        Or = "or",
        Xor = "xor",
        /// The shift count is taken modulo the width, in all shifts and rotates.
        Shl = "shl",
        /// Fills with 0.
        Lshr = "lshr",
        /// Fills with the sign.
        Ashr = "ashr",
        Rotl = "rotl",
        Rotr = "rotr",
        Fadd = "fadd",
        Fsub = "fsub",
        Fmul = "fmul",
        Fdiv = "fdiv",
    }
}

ops! {
    /// Integer comparison; `s` signed, `u` unsigned.
    IntCc {
        Eq = "eq",
        Ne = "ne",
        Slt = "slt",
        Sle = "sle",
        Sgt = "sgt",
        Sge = "sge",
        Ult = "ult",
        Ule = "ule",
        Ugt = "ugt",
        Uge = "uge",
    }
}

ops! {
    /// Floating-point comparison; false if unordered, except `ne` and `uno`.
    FloatCc {
        Eq = "feq",
        Ne = "fne",
        Lt = "flt",
        Le = "fle",
        Gt = "fgt",
        Ge = "fge",
        /// True if an operand is NaN.
        Uno = "funo",
    }
}

ops! {
    /// One operand, result of another type.
    ConvertOp {
        /// To a wider integer, filling with 0.
        Zext = "zext",
        /// To a wider integer, filling with the sign.
        Sext = "sext",
        /// To a narrower integer, dropping high bits.
        Trunc = "trunc",
        /// Same bits, other class: i32 and f32, i64 and f64.
        Bitcast = "bitcast",
        /// Signed i32 or i64 to f32 or f64, to nearest, ties to even.
        FromSint = "from_sint",
        /// f32 or f64 to signed i32 or i64, towards zero; saturates, NaN becomes 0.
        ToSint = "to_sint",
        /// Unsigned i32 or i64 to f32 or f64, to nearest, ties to even.
        FromUint = "from_uint",
        /// f32 or f64 to unsigned i32 or i64, towards zero; saturates, NaN becomes 0.
        ToUint = "to_uint",
        Fpromote = "fpromote",
        Fdemote = "fdemote",
    }
}

/// A memory region. Distinct plain regions never overlap; see [`Region::may_alias`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Region {
    /// CPU state, host byte order.
    State,
    /// Process image of inputs, big-endian like all regions below.
    I,
    /// Process image of outputs.
    Q,
    /// Bit memory.
    M,
    /// System area of an S7-200: special memory, sequence control relays, accumulators, timers, counters.
    System,
    /// Cells of S5 timers and counters, see [`timer_cell`](plcc_abi::layout::timer_cell); host byte order. No pointer leads there.
    Cells,
    /// Local data: the frame of this call.
    L,
    /// Local data of the caller.
    V,
    /// A DB known at compile time, by number.
    Db(u16),
    /// Some DB: `base` of the address is an offset from the memory base, and lies in a DB.
    AnyDb,
    /// Anywhere in PLC memory: `base` is an offset from the memory base.
    Any,
}

impl Region {
    /// True if accesses of the two regions may touch the same byte.
    pub fn may_alias(self, other: Region) -> bool {
        use Region::*;
        match (self, other) {
            (State | Cells, _) | (_, State | Cells) => self == other,
            (Any, _) | (_, Any) => true,
            (Db(a), Db(b)) => a == b,
            (AnyDb, Db(_) | AnyDb) | (Db(_), AnyDb) => true,
            // The caller's frame is another frame than this one.
            (a, b) => a == b,
        }
    }

    /// True if numbers in the region are in the byte order of the host, not big-endian.
    pub fn is_host_order(self) -> bool {
        matches!(self, Region::State | Region::Cells)
    }
}

/// An address in PLC memory: region + `base` + `offset` bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Address {
    pub region: Region,
    /// An i32 number of bytes, known to be in range at the access.
    pub base: Option<Value>,
    pub offset: u32,
}

impl Address {
    /// The byte at `offset` of `region`.
    pub const fn direct(region: Region, offset: u32) -> Address {
        Address { region, base: None, offset }
    }

    /// The byte at `base` of `region`.
    pub const fn indexed(region: Region, base: Value, offset: u32) -> Address {
        Address { region, base: Some(base), offset }
    }
}

/// The values that an instruction uses where their number is not fixed. An empty list takes one pointer and no allocation: most jumps
/// pass nothing, and an instruction is no longer than its fixed parts.
pub type Values = ThinVec<Value>;

/// A jump target with the values for its block parameters.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct BlockCall {
    pub block: Block,
    pub args: Values,
}

impl BlockCall {
    pub fn new(block: Block) -> BlockCall {
        BlockCall { block, args: Values::new() }
    }
}

/// An instruction. Results are in [`Function::results`](crate::Function::results).
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum InstData {
    /// A constant of the result type: an integer zero-extended from its width, or the bits of a float.
    Const {
        bits: u64,
    },
    Unary {
        op: UnaryOp,
        arg: Value,
    },
    Binary {
        op: BinaryOp,
        args: [Value; 2],
    },
    /// Result i1.
    IntCompare {
        cc: IntCc,
        args: [Value; 2],
    },
    /// Result i1.
    FloatCompare {
        cc: FloatCc,
        args: [Value; 2],
    },
    Convert {
        op: ConvertOp,
        arg: Value,
    },
    /// `cond` is an i1.
    Select {
        cond: Value,
        if_true: Value,
        if_false: Value,
    },
    /// Reads the result type (not i1), big-endian except in `State`.
    Load {
        addr: Address,
    },
    Store {
        addr: Address,
        value: Value,
    },
    /// Reads bit `bit` (0..8) of the byte at `addr`; result i1.
    LoadBit {
        addr: Address,
        bit: u8,
    },
    /// Writes bit `bit` of the byte at `addr`; `value` is an i1.
    StoreBit {
        addr: Address,
        bit: u8,
        value: Value,
    },
    /// Offset of `addr` from the memory base, an i32: usable as `base` of `Any` (of `AnyDb` if it is in a DB).
    AddressOf {
        addr: Address,
    },
    /// Sets `len` bytes to 0.
    Clear {
        addr: Address,
        len: u32,
    },
    /// Copies `len` bytes; the two ranges may overlap (memmove).
    Copy {
        to: Address,
        from: Address,
        len: u32,
    },
    /// Offset of the data of DB `number` (i32, 0..=65535) from the memory base, i32; meaningless if it is not loaded.
    DbBase {
        number: Value,
    },
    /// Length of DB `number` in bytes, i32; 0 if it is not loaded.
    DbLength {
        number: Value,
    },
    /// Calls a function of the module; its frame begins `frame_bytes` of the caller after the caller's.
    Call {
        callee: FuncId,
        args: Values,
    },
    CallRuntime {
        function: RuntimeFn,
        args: Values,
    },
    /// Where the frame of a callee begins (`callee: true`) or this function's (false), as i32 offset from the memory base.
    FrameBase {
        callee: bool,
    },

    // Terminators.
    Jump {
        target: BlockCall,
    },
    Branch {
        cond: Value,
        then_to: BlockCall,
        else_to: BlockCall,
    },
    /// Goes to `targets[value]`, to `default` if there are fewer. `value` is an i32.
    Switch {
        value: Value,
        targets: ThinVec<BlockCall>,
        default: BlockCall,
    },
    Return {
        values: Values,
    },
}

/// What an instruction works on: passes decide by it which instructions concern them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    Constant,
    /// Computes a value from other values.
    Value,
    /// Says where something is; does not read it.
    Address,
    /// Reads or writes memory, or the table of data blocks.
    Memory,
    /// Calls a function, which may do both.
    Call,
    /// A terminator that goes one of several ways.
    Choice,
    /// A terminator that goes one way, or returns.
    Exit,
}

impl InstData {
    /// What the instruction works on.
    #[inline]
    pub const fn class(&self) -> Class {
        match self {
            InstData::Const { .. } => Class::Constant,
            InstData::Unary { .. }
            | InstData::Binary { .. }
            | InstData::IntCompare { .. }
            | InstData::FloatCompare { .. }
            | InstData::Convert { .. }
            | InstData::Select { .. } => Class::Value,
            InstData::AddressOf { .. } | InstData::FrameBase { .. } => Class::Address,
            InstData::Load { .. }
            | InstData::Store { .. }
            | InstData::LoadBit { .. }
            | InstData::StoreBit { .. }
            | InstData::Clear { .. }
            | InstData::Copy { .. }
            | InstData::DbBase { .. }
            | InstData::DbLength { .. } => Class::Memory,
            InstData::Call { .. } | InstData::CallRuntime { .. } => Class::Call,
            InstData::Branch { .. } | InstData::Switch { .. } => Class::Choice,
            InstData::Jump { .. } | InstData::Return { .. } => Class::Exit,
        }
    }

    /// True for the instructions that end a block.
    #[inline]
    pub fn is_terminator(&self) -> bool {
        matches!(self.class(), Class::Choice | Class::Exit)
    }

    /// True if the instruction does more than compute its results.
    #[inline]
    pub fn has_side_effect(&self) -> bool {
        match self {
            InstData::Store { .. }
            | InstData::StoreBit { .. }
            | InstData::Clear { .. }
            | InstData::Copy { .. }
            | InstData::Call { .. } => true,
            InstData::CallRuntime { function, .. } => function.effect() != plcc_abi::functions::Effect::Pure,
            _ => self.is_terminator(),
        }
    }

    /// Calls `f` with every value that the instruction uses, those of block calls included.
    #[inline]
    pub fn for_each_use(&self, mut f: impl FnMut(Value)) {
        self.visit(|v| f(*v));
    }

    /// Replaces every used value.
    #[inline]
    pub fn map_uses(&mut self, mut f: impl FnMut(Value) -> Value) {
        self.visit_mut(|v| *v = f(*v));
    }

    /// The jump targets of a terminator.
    pub fn targets(&self) -> Vec<&BlockCall> {
        match self {
            InstData::Jump { target } => vec![target],
            InstData::Branch { then_to, else_to, .. } => vec![then_to, else_to],
            InstData::Switch { targets, default, .. } => targets.iter().chain([default]).collect(),
            _ => Vec::new(),
        }
    }

    /// Calls `f` with each jump target, in the order of [`InstData::targets`].
    #[inline]
    pub fn for_each_target<'a>(&'a self, mut f: impl FnMut(&'a BlockCall)) {
        match self {
            InstData::Jump { target } => f(target),
            InstData::Branch { then_to, else_to, .. } => {
                f(then_to);
                f(else_to);
            }
            InstData::Switch { targets, default, .. } => targets.iter().chain([default]).for_each(f),
            _ => {}
        }
    }

    /// Calls `f` with each jump target, in the order of [`InstData::targets`].
    #[inline]
    pub fn for_each_target_mut(&mut self, mut f: impl FnMut(&mut BlockCall)) {
        match self {
            InstData::Jump { target } => f(target),
            InstData::Branch { then_to, else_to, .. } => {
                f(then_to);
                f(else_to);
            }
            InstData::Switch { targets, default, .. } => targets.iter_mut().chain([default]).for_each(f),
            _ => {}
        }
    }

    /// Calls `f` with each address that the instruction names; `Copy` has two.
    #[inline]
    pub fn for_each_address(&self, mut f: impl FnMut(&Address)) {
        match self {
            InstData::Load { addr }
            | InstData::Store { addr, .. }
            | InstData::LoadBit { addr, .. }
            | InstData::StoreBit { addr, .. }
            | InstData::AddressOf { addr }
            | InstData::Clear { addr, .. } => f(addr),
            InstData::Copy { to, from, .. } => {
                f(to);
                f(from);
            }
            InstData::Const { .. }
            | InstData::Unary { .. }
            | InstData::Binary { .. }
            | InstData::IntCompare { .. }
            | InstData::FloatCompare { .. }
            | InstData::Convert { .. }
            | InstData::Select { .. }
            | InstData::DbBase { .. }
            | InstData::DbLength { .. }
            | InstData::Call { .. }
            | InstData::CallRuntime { .. }
            | InstData::FrameBase { .. }
            | InstData::Jump { .. }
            | InstData::Branch { .. }
            | InstData::Switch { .. }
            | InstData::Return { .. } => {}
        }
    }
}

/// Writes the two visitors of used values from one list.
macro_rules! visitor {
    ($name:ident, $slice:ident, $($mutability:tt)?) => {
        impl InstData {
            #[inline]
            fn $name(& $($mutability)? self, mut f: impl FnMut(& $($mutability)? Value)) {
                match self {
                    InstData::Const { .. } | InstData::FrameBase { .. } => {}
                    InstData::Unary { arg, .. } | InstData::Convert { arg, .. } => f(arg),
                    InstData::Binary { args, .. }
                    | InstData::IntCompare { args, .. }
                    | InstData::FloatCompare { args, .. } => args.$slice().for_each(f),
                    InstData::Select { cond, if_true, if_false } => {
                        f(cond);
                        f(if_true);
                        f(if_false);
                    }
                    InstData::Load { addr } | InstData::LoadBit { addr, .. } | InstData::AddressOf { addr }
                    | InstData::Clear { addr, .. } => addr.base.$slice().for_each(f),
                    InstData::Store { addr, value } | InstData::StoreBit { addr, value, .. } => {
                        addr.base.$slice().for_each(&mut f);
                        f(value);
                    }
                    InstData::Copy { to, from, .. } => {
                        to.base.$slice().for_each(&mut f);
                        from.base.$slice().for_each(f);
                    }
                    InstData::DbBase { number } | InstData::DbLength { number } => f(number),
                    InstData::Call { args, .. } | InstData::CallRuntime { args, .. } => args.$slice().for_each(f),
                    InstData::Jump { target } => target.args.$slice().for_each(f),
                    InstData::Branch { cond, then_to, else_to } => {
                        f(cond);
                        then_to.args.$slice().for_each(&mut f);
                        else_to.args.$slice().for_each(f);
                    }
                    InstData::Switch { value, targets, default } => {
                        f(value);
                        for target in targets {
                            target.args.$slice().for_each(&mut f);
                        }
                        default.args.$slice().for_each(f);
                    }
                    InstData::Return { values } => values.$slice().for_each(f),
                }
            }
        }
    };
}

visitor!(visit, iter,);
visitor!(visit_mut, iter_mut, mut);

// A program of a million lines has four million of them at once.
const _: () = assert!(size_of::<InstData>() == 40);
