//! Syntax tree of a GRAPH function block.
//!
//! Branches and jumps are notation only: a transition leaves the steps of `from` and enters those of `to`. Names are kept as written;
//! nothing is looked up here. Source: GRAPH reference, chapter 0.

use plcc_diag::Span;

use crate::network;
use crate::scl::ast::{Expr, Name, Statement};

/// Chart of a function block: all its sequencers.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Body {
    pub dialect: Dialect,
    pub settings: Settings,
    /// Permanent instructions before the sequencers, in order.
    pub before: Vec<Permanent>,
    /// In the order of the file.
    pub steps: Vec<Step>,
    /// In the order of the file.
    pub transitions: Vec<Transition>,
    /// Permanent instructions after the sequencers.
    pub after: Vec<Permanent>,
    /// A part of it could not be read, and was reported; what the chart lacks for that reason is not reported again.
    pub broken: bool,
}

/// The variant of GRAPH.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Dialect {
    /// S7-GRAPH of STEP 7 V5: `.gr7`.
    #[default]
    Classic,
    /// GRAPH of the TIA Portal: SimaticML.
    Tia,
    /// SFC of IEC 61131-3: PLCopen XML.
    Sfc,
}

/// Settings of the block. A setting that the file does not give is `None`.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Settings {
    /// `FBInterface`.
    pub interface: Option<Interface>,
    /// `SSBLevel`.
    pub data: Option<StepData>,
    /// `SSkipOn`: initial value of *skip steps*.
    pub skip_steps: Option<bool>,
    /// `AckReq`: initial value of *acknowledgement required*.
    pub acknowledge: Option<bool>,
    /// `PermILMan`: interlocks are processed in manual mode.
    pub manual_interlocks: Option<bool>,
    /// `SaveSwitching`: safe activation in manual mode.
    pub safe_activation: Option<bool>,
    /// `SWMLocked`: the mode is not switched through the instance.
    pub locked_mode: Option<bool>,
}

/// Which parameters the block has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interface {
    Minimum,
    Standard,
    Maximum,
    /// Those that are declared.
    UserDefined,
}

/// How data of steps and transitions are declared in the instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StepData {
    /// A structure each, by name.
    Individual,
    /// The arrays G7S and G7T.
    Array,
    Minimized,
}

/// A step.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    pub name: Name,
    /// The number that the user gave it; unique, but neither dense nor ordered.
    pub number: u32,
    pub initial: bool,
    /// In the order of execution.
    pub actions: Vec<Action>,
    /// Interlock, `C`.
    pub interlock: Option<Condition>,
    /// Supervision, `V`.
    pub supervision: Option<Condition>,
    /// T_MAX and T_WARN, TIME constants.
    pub maximum: Option<Expr>,
    pub warning: Option<Expr>,
    /// Caption and comment.
    pub comment: Vec<String>,
    pub span: Span,
}

/// A transition.
#[derive(Clone, Debug, PartialEq)]
pub struct Transition {
    pub name: Name,
    pub number: u32,
    /// Names of the steps that must be active, and are left.
    pub from: Vec<Name>,
    /// Steps that are entered; none ends the sequence.
    pub to: Vec<Name>,
    /// Drawn as a jump.
    pub jump: bool,
    /// Place in the drawing: of the transitions that leave one step, the one with the lesser path comes first; then the number decides.
    pub path: Vec<u32>,
    /// None: always satisfied.
    pub condition: Option<Condition>,
    /// The drawing has a gap where the transition should be.
    pub missing: bool,
    pub comment: Vec<String>,
    pub span: Span,
}

/// A condition of a transition, an interlock or a supervision.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // Most are expressions or networks of some size either way.
pub enum Condition {
    Expression(Expr),
    /// Its element of kind `Condition` has the result.
    Network(network::ast::Network),
    /// ST: statements; the last one is the expression that counts.
    Statements(Vec<Statement>),
}

/// A permanent instruction.
#[derive(Clone, Debug, PartialEq)]
pub struct Permanent {
    pub kind: PermanentKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // Few of them in a block.
pub enum PermanentKind {
    /// `M9.0 (=) := I1.6`, `(S)`, `(R)`.
    Coil {
        operand: Expr,
        coil: Coil,
        value: Expr,
    },
    Call(Call),
    Network(network::ast::Network),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Coil {
    Assign,
    Set,
    Reset,
}

/// A row of a step's actions.
#[derive(Clone, Debug, PartialEq)]
pub struct Action {
    pub event: Option<Event>,
    pub qualifier: Qualifier,
    /// The letter C: only while the interlock is satisfied.
    pub interlock: bool,
    /// Event, qualifier and C.
    pub qualifier_span: Span,
    pub body: ActionBody,
    pub comment: Option<String>,
    pub span: Span,
}

/// The operand, assignment or call of a row.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // Few rows are the small ones.
pub enum ActionBody {
    /// `Q4.0`; a step of ON and OFF.
    Operand(Expr),
    /// `Q4.0 := T#5S`, `Q4.0, T#5S`, `C5, C#20`, `MW2 := MW4 + MW6`: an operand, and the value that its qualifier requires.
    Value { operand: Expr, value: Expr },
    /// `S_ALL`.
    All { span: Span },
    /// `CALL FC1 (…)`, under N.
    Call(Call),
    /// ST, under N.
    Statements(Vec<Statement>),
    /// A network, under N.
    Network(network::ast::Network),
    /// Could not be read; reported.
    Error,
}

/// A block call.
#[derive(Clone, Debug, PartialEq)]
pub struct Call {
    /// FC, FB, SFC or SFB, in a form that a call in SCL accepts.
    pub block: Expr,
    /// Instance DB of an FB.
    pub instance: Option<Expr>,
    pub parameters: Vec<Parameter>,
    pub span: Span,
}

/// `IN1 := MW2`: outputs are written like this, too.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    pub name: Name,
    /// None: left empty.
    pub value: Option<Expr>,
    pub span: Span,
}

/// What a row reacts to. Source: GRAPH reference D.7.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Event {
    /// The step is entered.
    S1,
    /// The step is left.
    S0,
    /// A supervision fault comes.
    V1,
    /// A supervision fault goes.
    V0,
    /// The interlock is lost.
    L1,
    /// The interlock is satisfied again.
    L0,
    /// A fault is acknowledged.
    A1,
    /// A registration.
    R1,
}

impl Event {
    pub const ALL: [Event; 8] =
        [Event::S1, Event::S0, Event::V1, Event::V0, Event::L1, Event::L0, Event::A1, Event::R1];

    /// `"S1"`
    pub const fn name(self) -> &'static str {
        match self {
            Event::S1 => "S1",
            Event::S0 => "S0",
            Event::V1 => "V1",
            Event::V0 => "V0",
            Event::L1 => "L1",
            Event::L0 => "L0",
            Event::A1 => "A1",
            Event::R1 => "R1",
        }
    }

    /// The event of that name, in either letter case.
    pub fn of(name: &str) -> Option<Event> {
        Event::ALL.into_iter().find(|event| event.name().eq_ignore_ascii_case(name))
    }
}

/// What a row does. Source: GRAPH reference D.6 to D.8.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Qualifier {
    /// While the step is active: operand, assignment or call.
    N,
    S,
    R,
    /// Delayed.
    D,
    /// Limited.
    L,
    /// Activates a step.
    On,
    /// Deactivates a step.
    Off,
    /// Counter: load, up, down, clear.
    Cs,
    Cu,
    Cd,
    Cr,
    /// Timer: extended pulse, retentive on-delay, stop, off-delay.
    Tl,
    Td,
    Tr,
    Tf,
}

impl Qualifier {
    pub const ALL: [Qualifier; 15] = [
        Qualifier::N,
        Qualifier::S,
        Qualifier::R,
        Qualifier::D,
        Qualifier::L,
        Qualifier::On,
        Qualifier::Off,
        Qualifier::Cs,
        Qualifier::Cu,
        Qualifier::Cd,
        Qualifier::Cr,
        Qualifier::Tl,
        Qualifier::Td,
        Qualifier::Tr,
        Qualifier::Tf,
    ];

    /// `"CU"`
    pub const fn name(self) -> &'static str {
        match self {
            Qualifier::N => "N",
            Qualifier::S => "S",
            Qualifier::R => "R",
            Qualifier::D => "D",
            Qualifier::L => "L",
            Qualifier::On => "ON",
            Qualifier::Off => "OFF",
            Qualifier::Cs => "CS",
            Qualifier::Cu => "CU",
            Qualifier::Cd => "CD",
            Qualifier::Cr => "CR",
            Qualifier::Tl => "TL",
            Qualifier::Td => "TD",
            Qualifier::Tr => "TR",
            Qualifier::Tf => "TF",
        }
    }

    /// The qualifier of that name, in either letter case.
    pub fn of(name: &str) -> Option<Qualifier> {
        Qualifier::ALL.into_iter().find(|qualifier| qualifier.name().eq_ignore_ascii_case(name))
    }
}
