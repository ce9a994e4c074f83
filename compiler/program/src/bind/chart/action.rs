//! Rows of actions. Source: GRAPH reference D.6 to D.8.

use super::engine::Engine;
use crate::bind::{Binder, Ctx};
use crate::model::scl::Statement;

/// What a step does, in the order of its rows.
#[derive(Default)]
pub struct StepCode {
    /// In each call in which it is active.
    pub active: Vec<Statement>,
    /// In the call that leaves it: rows of S0, then operands of N, D and L become 0.
    pub leave: Vec<Statement>,
    /// In the call behind that: what S0 has set for one call becomes 0.
    pub after: Vec<Statement>,
}

impl Binder<'_> {
    /// Binds the actions of a step.
    pub fn step_code(&mut self, _ctx: &mut Ctx, _engine: &mut Engine, _step: usize) -> StepCode {
        StepCode::default()
    }
}
