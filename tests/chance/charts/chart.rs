//! A GRAPH function block as plain data: the generator makes it, the model executes it and `text` prints it.
//!
//! Steps and transitions are named by their index. Transitions are in the order of the text: the last one is the leftmost path.

/// A function block.
#[derive(Clone, Debug, Default)]
pub struct Chart {
    pub steps: Vec<Step>,
    pub transitions: Vec<Transition>,
    /// Permanent instructions before the sequencers.
    pub before: Vec<Permanent>,
    /// Permanent instructions after them.
    pub after: Vec<Permanent>,
    /// `AckReq`.
    pub acknowledge: bool,
    /// `SSkipOn`.
    pub skip: bool,
    pub interface: Interface,
}

/// `FBInterface`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Interface {
    #[default]
    Minimum,
    Standard,
    Maximum,
}

#[derive(Clone, Debug)]
pub struct Step {
    pub name: String,
    pub number: i16,
    pub initial: bool,
    pub interlock: Option<Condition>,
    pub supervision: Option<Condition>,
    pub rows: Vec<Row>,
}

#[derive(Clone, Debug)]
pub struct Transition {
    pub name: String,
    pub number: i16,
    pub from: Vec<usize>,
    pub to: Vec<usize>,
    /// None: always satisfied.
    pub condition: Option<Condition>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Area {
    I,
    Q,
    M,
    /// Static variables of the block, bits of one byte.
    Static,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bit {
    pub area: Area,
    pub byte: u8,
    pub bit: u8,
}

/// Members of a step that are bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepBit {
    X,
    S1,
    S0,
    L1,
    L0,
    V1,
    V0,
    A1,
    R1,
    LA,
    LS,
    VA,
    VS,
}

/// Members of a transition that are bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransitionBit {
    TV,
    TT,
    TS,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    Less,
    AtMost,
    More,
    AtLeast,
    Equal,
    Unequal,
}

impl Order {
    pub fn holds(self, left: i64, right: i64) -> bool {
        match self {
            Order::Less => left < right,
            Order::AtMost => left <= right,
            Order::More => left > right,
            Order::AtLeast => left >= right,
            Order::Equal => left == right,
            Order::Unequal => left != right,
        }
    }
}

#[derive(Clone, Debug)]
pub enum Condition {
    Constant(bool),
    Bit(Bit),
    Step(usize, StepBit),
    Transition(usize, TransitionBit),
    /// `S002.T > T#5S`, of `U` if undisturbed.
    Time {
        step: usize,
        undisturbed: bool,
        order: Order,
        ms: i64,
    },
    /// `MW20 > 5`.
    Word {
        byte: u8,
        order: Order,
        value: i16,
    },
    /// Status of a timer.
    Timer(u8),
    /// Status of a counter.
    Counter(u8),
    Not(Box<Condition>),
    And(Vec<Condition>),
    Or(Vec<Condition>),
    Xor(Vec<Condition>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    S1,
    S0,
    V1,
    V0,
    L1,
    L0,
    A1,
    R1,
}

/// A row of a step's actions.
#[derive(Clone, Debug)]
pub struct Row {
    pub event: Option<Event>,
    /// The letter C.
    pub interlock: bool,
    pub action: Action,
}

/// Time of a row.
#[derive(Clone, Copy, Debug)]
pub enum Time {
    Constant(i64),
    /// A double word of bit memory, in milliseconds.
    Memory(u8),
}

#[derive(Clone, Copy, Debug)]
pub enum Action {
    N(Bit),
    S(Bit),
    R(Bit),
    D(Bit, Time),
    L(Bit, Time),
    /// `MWtarget := MWsource + constant`.
    Add {
        target: u8,
        source: u8,
        constant: i16,
    },
    /// `CALL FC1` with a word of bit memory, which it counts up by 1.
    Call(u8),
    On(usize),
    Off(usize),
    OffAll,
    /// CS with a constant.
    CounterSet(u8, u16),
    CounterUp(u8),
    CounterDown(u8),
    CounterClear(u8),
    /// TL: extended pulse, in milliseconds.
    TimerPulse(u8, i64),
    /// TD: retentive on-delay.
    TimerDelay(u8, i64),
    /// TR
    TimerStop(u8),
    /// TF: off-delay.
    TimerOff(u8, i64),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coil {
    Assign,
    Set,
    Reset,
}

/// A permanent instruction.
#[derive(Clone, Debug)]
pub struct Permanent {
    pub coil: Coil,
    pub operand: Bit,
    pub value: Condition,
}

/// Inputs of the block that are BOOL, and the sets that have them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    OffSq,
    InitSq,
    AckEf,
    RegEf,
    AckS,
    RegS,
    HaltSq,
    HaltTm,
    ZeroOp,
    EnIl,
    EnSv,
    EnAckreq,
    EnSskip,
    SPrev,
    SNext,
    SwAuto,
    SwTap,
    SwTop,
    SwMan,
    SOn,
    SOff,
    TPush,
}

impl Input {
    pub const ALL: [Input; 22] = [
        Input::OffSq,
        Input::InitSq,
        Input::AckEf,
        Input::RegEf,
        Input::AckS,
        Input::RegS,
        Input::HaltSq,
        Input::HaltTm,
        Input::ZeroOp,
        Input::EnIl,
        Input::EnSv,
        Input::EnAckreq,
        Input::EnSskip,
        Input::SPrev,
        Input::SNext,
        Input::SwAuto,
        Input::SwTap,
        Input::SwTop,
        Input::SwMan,
        Input::SOn,
        Input::SOff,
        Input::TPush,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Input::OffSq => "OFF_SQ",
            Input::InitSq => "INIT_SQ",
            Input::AckEf => "ACK_EF",
            Input::RegEf => "REG_EF",
            Input::AckS => "ACK_S",
            Input::RegS => "REG_S",
            Input::HaltSq => "HALT_SQ",
            Input::HaltTm => "HALT_TM",
            Input::ZeroOp => "ZERO_OP",
            Input::EnIl => "EN_IL",
            Input::EnSv => "EN_SV",
            Input::EnAckreq => "EN_ACKREQ",
            Input::EnSskip => "EN_SSKIP",
            Input::SPrev => "S_PREV",
            Input::SNext => "S_NEXT",
            Input::SwAuto => "SW_AUTO",
            Input::SwTap => "SW_TAP",
            Input::SwTop => "SW_TOP",
            Input::SwMan => "SW_MAN",
            Input::SOn => "S_ON",
            Input::SOff => "S_OFF",
            Input::TPush => "T_PUSH",
        }
    }

    /// The smallest parameter set that has it. Source: GRAPH reference E.1.
    pub fn least(self) -> Interface {
        match self {
            Input::InitSq => Interface::Minimum,
            Input::OffSq
            | Input::AckEf
            | Input::SPrev
            | Input::SNext
            | Input::SwAuto
            | Input::SwTap
            | Input::SwTop
            | Input::SwMan
            | Input::SOn
            | Input::SOff
            | Input::TPush => Interface::Standard,
            Input::RegEf
            | Input::AckS
            | Input::RegS
            | Input::HaltSq
            | Input::HaltTm
            | Input::ZeroOp
            | Input::EnIl
            | Input::EnSv
            | Input::EnAckreq
            | Input::EnSskip => Interface::Maximum,
        }
    }
}

impl Interface {
    pub fn has(self, least: Interface) -> bool {
        self as u8 >= least as u8
    }

    pub fn inputs(self) -> impl Iterator<Item = Input> {
        Input::ALL.into_iter().filter(move |input| self.has(input.least()))
    }
}
