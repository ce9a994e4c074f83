//! Arrays and structures at inputs of function blocks: SCL copies each before it evaluates the arguments after it, `CALL` of STL copies all
//! arguments at once. Source: SCL reference, order of evaluation.

use plcc_abi::image::BlockKind;
use plcc_model::scl::walk::{self, Visitor};
use plcc_model::scl::{Actual, Argument, Call, Complex};
use plcc_model::{CodeBlock, Direction, Parameter};

use super::Maker;

/// Looks for calls of blocks of the program.
struct Calls<'f> {
    is_own: &'f dyn Fn(&Call) -> bool,
    found: bool,
}

impl Visitor for Calls<'_> {
    fn call(&mut self, call: &Call) {
        self.found |= (self.is_own)(call);
    }
}

impl Maker<'_> {
    /// Whether an argument after `argument` calls a function of the program, which may change what SCL has copied.
    pub fn may_change_later(&self, call: &Call, callee: &CodeBlock, formal: &Parameter, argument: &Argument) -> bool {
        let is_copied = matches!(callee.kind, BlockKind::Fb | BlockKind::Sfb) && formal.direction == Direction::Input;
        let mut later = call.arguments.iter().skip_while(|one| one.parameter != argument.parameter).skip(1);
        is_copied && later.any(|one| self.calls_something(&one.actual))
    }

    fn calls_something(&self, actual: &Actual) -> bool {
        match actual {
            Actual::Value(value) | Actual::PointerToValue { value, .. } => {
                let is_own = |call: &Call| self.is_own(call);
                let mut calls = Calls { is_own: &is_own, found: false };
                walk::expr(value, &mut calls);
                calls.found
            }
            Actual::Complex(Complex::Call(call)) | Actual::PointerToComplex { value: Complex::Call(call), .. } => {
                self.is_own(call) || call.arguments.iter().any(|argument| self.calls_something(&argument.actual))
            }
            Actual::Complex(_)
            | Actual::PointerToComplex { .. }
            | Actual::Variable { .. }
            | Actual::Reference(_)
            | Actual::Number(_)
            | Actual::Dropped
            | Actual::PointerBytes(_)
            | Actual::PointerTo { .. }
            | Actual::PointerCopy(_)
            | Actual::Variant(..) => false,
        }
    }

    /// Functions of the library change nothing but their outputs.
    fn is_own(&self, call: &Call) -> bool {
        self.program.block(call.target).is_none_or(|block| !block.library)
    }
}
