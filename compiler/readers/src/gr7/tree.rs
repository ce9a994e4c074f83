//! Parts of a chart as the grammar returns them.

use plcc_diag::Span;

use plcc_syntax::chart::ast::{Action, Condition, Permanent, Step, Transition};
use plcc_syntax::scl::ast::Name;

/// A part of a chart.
#[derive(Debug)]
#[allow(clippy::large_enum_variant)] // Lives only until its chart is built.
pub enum Part<'a> {
    /// Lines of `key: value`.
    Settings(&'a str),
    /// Comment of the block.
    Comment(&'a str),
    /// Whether they come after the sequencers.
    Permanents(bool, Vec<Permanent>),
    /// Its number, if it has one.
    Step(Step, Option<u32>),
    Transition(Transition, Option<u32>),
}

/// Name and number of a step or transition.
#[derive(Debug)]
pub struct Head {
    pub name: Name,
    pub number: Option<u32>,
}

/// A part of a step.
#[derive(Debug)]
#[allow(clippy::large_enum_variant)] // Lives only until its step is built.
pub enum Item<'a> {
    Comment(&'a str),
    Interlock(Option<Condition>, Span),
    Supervision(Option<Condition>, Span),
    Action(Action),
}

/// A part of a transition.
#[derive(Debug)]
#[allow(clippy::large_enum_variant)] // Lives only until its transition is built.
pub enum Clause<'a> {
    Comment(&'a str),
    From(Vec<Name>),
    /// The steps, and whether it is a jump.
    To(Vec<Name>, bool),
    Condition(Option<Condition>, Span),
    /// Could not be parsed; reported.
    Error,
}
