//! What elements do.

/// What an element does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Contact,
    Not,
    Gate(Gate),
    EdgeContact {
        rising: bool,
    },
    /// P_TRIG, N_TRIG: edge of the flow.
    EdgeTrigger {
        rising: bool,
    },
    Coil,
    SetCoil,
    ResetCoil,
    EdgeCoil {
        rising: bool,
    },
    BitField {
        set: bool,
    },
    FlipFlop {
        set_wins: bool,
    },
    Compare(&'static str),
    Range {
        inside: bool,
    },
    Valid {
        valid: bool,
    },
    /// A contact that asks what a VARIANT points to.
    Variant(VariantQuestion),
    /// A function block of the system on an instance, by the name that the library has for it.
    Instance(&'static str),
    /// TP, TON, TOF, TONR as coils.
    TimerCoil(&'static str),
    ResetTimer,
    PresetTimer,
    Calculate,
    /// A function that the file format gives as a formula over its inputs.
    Formula,
    /// An operator of SCL between all numbered inputs, in the type of the template.
    Operator(&'static str),
    /// INC, DEC.
    Step {
        up: bool,
    },
    /// A function of SCL with a value; pins have the names of its formals. Inputs are converted to the template's type.
    Function(&'static str),
    /// A function without a value, or a block of the library: every pin is a formal.
    Procedure(&'static str),
    Move,
    Convert,
    /// ROUND, TRUNC, CEIL, FLOOR.
    Round(&'static str),
    Negate,
    Invert,
    Mux,
    Demux,
    Jump {
        negated: bool,
    },
    JumpList,
    Switch,
    Return(ReturnValue),
    /// S_PULSE …, with all pins of the box; as a coil only the start and the time.
    S5Timer(&'static str),
    S5Counter(&'static str),
    CounterCoil(CounterCoil),
    /// OPN, into the DB or the DI register.
    OpenDb {
        di: bool,
    },
    Mcr(Mcr),
    /// An FC or SFC without parameters.
    CallCoil,
    Save,
    /// The condition of a transition, an interlock or a supervision of GRAPH: the flow is its value.
    Condition,
    /// A bit of the status word, or the relation of the last result to 0.
    Flag(Flag),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gate {
    And,
    Or,
    Xor,
}

/// What sets ENO of the block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReturnValue {
    /// The operand, or the flow without one.
    Operand,
    True,
    False,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CounterCoil {
    Up,
    Down,
    Set,
}

/// Coils of the Master Control Relay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mcr {
    Activate,
    Open,
    Close,
    Deactivate,
}

/// Status contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flag {
    Ov,
    Os,
    Uo,
    Br,
    Equal,
    NotEqual,
    Greater,
    Less,
    GreaterEqual,
    LessEqual,
}

/// What a contact asks about a VARIANT.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VariantQuestion {
    /// IS_NULL, NOT_NULL: whether it points to nothing.
    IsNull { null: bool },
    /// IS_ARRAY.
    IsArray,
    /// EQ_Type, NE_Type; EQ_ElemType, NE_ElemType ask for the elements of an array.
    SameType { elements: bool, same: bool },
}
