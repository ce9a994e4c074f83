//! Arrays, structures and texts at inputs of function blocks: SCL copies them before it evaluates the arguments after them, `CALL` of STL at once
//! with all others. Source: SCL reference, order of evaluation.

use plcc_abi::image::BlockKind;
use plcc_model::scl::walk::{self, Visitor};
use plcc_model::scl::{Access, Actual, Argument, Base, Call, Complex, Expr, ExprKind, Statement, StatementKind};
use plcc_model::{Body, CodeBlock, Direction, Parameter, Place};

use super::Maker;

/// Looks for what may change data outside of a function: assignments, calls, timers and counters.
struct Changes<'p> {
    parameters: &'p [Parameter],
    found: bool,
}

impl Visitor for Changes<'_> {
    fn statement(&mut self, statement: &Statement) {
        let is_inside = |target: &Access| match &target.base {
            Base::Place(Place::L { .. }) => true,
            Base::Place(Place::Parameter { parameter, .. }) => {
                self.parameters.get(*parameter).is_some_and(|formal| formal.name == "RET_VAL")
            }
            Base::Place(_) | Base::Indexed { .. } => false,
        };
        let is_outside = statement.kind.target().is_some_and(|target| !is_inside(target));
        self.found |= is_outside || matches!(statement.kind, StatementKind::Stl(_));
    }

    fn expr(&mut self, value: &Expr) {
        self.found |= matches!(value.kind, ExprKind::Timer(_) | ExprKind::Counter(_));
    }

    fn call(&mut self, call: &Call) {
        self.found |= !call.is_operation;
    }
}

/// Looks for calls of functions that may change data.
struct Calls<'f> {
    may_change_data: &'f dyn Fn(&Call) -> bool,
    found: bool,
}

impl Visitor for Calls<'_> {
    fn call(&mut self, call: &Call) {
        self.found |= (self.may_change_data)(call);
    }
}

impl Maker<'_> {
    /// Whether an argument after `argument` calls a function that may change what SCL has copied.
    pub fn may_change_later(&self, call: &Call, callee: &CodeBlock, formal: &Parameter, argument: &Argument) -> bool {
        let is_copied = matches!(callee.kind, BlockKind::Fb | BlockKind::Sfb) && formal.direction == Direction::Input;
        let mut later = call.arguments.iter().skip_while(|one| one.parameter != argument.parameter).skip(1);
        is_copied && later.any(|one| self.calls_something(&one.actual))
    }

    fn calls_something(&self, actual: &Actual) -> bool {
        let may_change_data = |call: &Call| self.may_change_data(call);
        let mut calls = Calls { may_change_data: &may_change_data, found: false };
        actual.value().into_iter().for_each(|value| walk::expr(value, &mut calls));
        calls.found
            || matches!(actual.complex(), Some(Complex::Call(call)) if self.may_change_data(call)
                || call.arguments.iter().any(|argument| self.calls_something(&argument.actual)))
    }

    /// Functions of the library change nothing but their outputs, and neither do those of the program that only compute a value.
    fn may_change_data(&self, call: &Call) -> bool {
        let Some(block) = self.program.block(call.target) else { return true };
        let changes_data = || match &block.body {
            Body::Scl(body) => {
                let mut changes = Changes { parameters: &block.interface.parameters, found: false };
                walk::statements(&body.statements, &mut changes);
                changes.found
            }
            Body::Stl(_) | Body::S7200(_) | Body::Runtime => true,
        };
        !block.library && changes_data()
    }
}
