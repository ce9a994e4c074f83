//! What the statements of a chart know of it: where data of steps lie in the instance, and which features it has.

use plcc_diag::Span;
use plcc_syntax::chart::ast::{Body as Chart, Event};

use super::index::Index;
use crate::bind::network::Page;
use crate::model::scl::{Expr, Statement};

/// A chart while it is bound.
pub struct Engine<'c> {
    pub chart: &'c Chart,
    pub index: &'c Index,
    /// Hidden variables, and what networks of the block share.
    pub page: Page,
}

impl Engine<'_> {
    /// Whether an event of a step occurs in this call, a BOOL.
    pub fn event(&self, _step: usize, _event: Event, _span: Span) -> Expr {
        todo!("the contract")
    }

    /// Whether the interlock of a step is satisfied, a BOOL; none if it has no interlock.
    pub fn interlock(&self, _step: usize, _span: Span) -> Option<Expr> {
        todo!("the contract")
    }

    /// Time since the activation of a step, a TIME.
    pub fn elapsed(&self, _step: usize, _span: Span) -> Expr {
        todo!("the contract")
    }

    /// Whether operands of N, D and L are to be 0 and calls are not executed (ZERO_OP), a BOOL; none if nothing asks for it.
    pub fn zeroed(&self, _span: Span) -> Option<Expr> {
        todo!("the contract")
    }

    /// Stores a request for the next call: step `step` is to be activated, or deactivated.
    pub fn request(&self, _step: usize, _on: bool, _span: Span) -> Statement {
        todo!("the contract")
    }

    /// Stores a request for the next call: all steps but `except` are to be deactivated.
    pub fn request_all_off(&self, _except: Option<usize>, _span: Span) -> Vec<Statement> {
        todo!("the contract")
    }
}
