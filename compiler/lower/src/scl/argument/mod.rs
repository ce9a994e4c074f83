//! Actual parameters of calls from SCL: evaluated first, from left to right, then passed. Source: SCL reference, parameters.
//!
//! `reference` passes them to FCs, `copy` to instances and system functions; `pointer`: POINTER, ANY and VARIANT;
//! `text`: to functions of texts, with addresses.

mod copy;
mod pointer;
mod reference;
mod text;

use plcc_ir::{Address, Value};
use plcc_model::scl::{Access, Actual, Argument, Base, Complex, Conversion, ExprKind};
use plcc_model::{Direction, Parameter, Place};

use self::pointer::PointerSource;
pub use self::text::{Look, TextArguments, TextSite, chain, joined_call};
use crate::block::BlockLowering;
use crate::scl::located::Located;

/// An argument with evaluated expressions.
pub struct Given<'m> {
    pub parameter: usize,
    pub supply: Supply<'m>,
    /// Where the formal's value goes after the call.
    pub back: Option<Back<'m>>,
}

/// The input.
pub enum Supply<'m> {
    Nothing,
    /// Elementary, in the form for memory.
    Value(Value),
    Complex(Source<'m>),
    /// A number of a timer, counter or block, an i32.
    Number(Value),
    Pointer(PointerSource<'m>),
}

/// A complex value in memory.
pub enum Source<'m> {
    Variable {
        access: &'m Access,
        located: Located<'m>,
    },
    /// In the frame.
    Frame(Address),
}

/// A variable that a result goes to.
pub struct Back<'m> {
    pub access: &'m Access,
    /// None: the variable is not in memory.
    pub located: Option<Located<'m>>,
    pub conversion: Option<Conversion>,
}

/// The place of the variable of an elementary actual, if it is known before the program runs.
pub fn place_of(actual: &Actual) -> Option<&Place> {
    let access = match actual {
        Actual::Value(value) => match &value.kind {
            ExprKind::Load(access) => access,
            _ => return None,
        },
        Actual::Variable { access, .. } => access,
        _ => return None,
    };
    match &access.base {
        Base::Place(place) if access.indices.is_empty() && access.part.is_none() => Some(place),
        Base::Place(_) | Base::Indexed { .. } => None,
    }
}

impl BlockLowering<'_, '_> {
    /// Evaluates an argument.
    pub fn give<'m>(&mut self, parameter: &Parameter, argument: &'m Argument) -> Given<'m> {
        let given = |supply, back| Given { parameter: argument.parameter, supply, back };
        match &argument.actual {
            Actual::Value(value) => {
                let ty = value.ty;
                let value = self.value(value);
                let value = self.untyped(value, ty);
                given(Supply::Value(value), None)
            }
            Actual::Variable { access, back } => {
                let located = (!self.is_promoted(access)).then(|| self.locate(access));
                let back = Back { access, located, conversion: *back };
                let supply = if parameter.direction == Direction::InOut {
                    let value = self.read_back(&back);
                    let ty = access.elementary().expect("the binder gives elementary formals elementary variables");
                    Supply::Value(self.untyped(value, ty))
                } else {
                    Supply::Nothing
                };
                given(supply, Some(back))
            }
            Actual::Complex(value) => given(Supply::Complex(self.source(value)), None),
            Actual::Reference(access) => {
                let located = self.locate(access);
                if parameter.direction == Direction::Output {
                    let back = Back { access, located: Some(located), conversion: None };
                    return given(Supply::Nothing, Some(back));
                }
                given(Supply::Complex(Source::Variable { access, located }), None)
            }
            Actual::Number(number) => given(Supply::Number(self.number(number)), None),
            Actual::Dropped => given(Supply::Nothing, None),
            Actual::PointerBytes(_)
            | Actual::PointerTo { .. }
            | Actual::PointerCopy(_)
            | Actual::PointerToValue { .. }
            | Actual::PointerToComplex { .. }
            | Actual::Variant(..) => given(Supply::Pointer(self.pointer_source(&argument.actual)), None),
        }
    }

    fn source<'m>(&mut self, value: &'m Complex) -> Source<'m> {
        match value {
            // It is stored where something is called.
            Complex::Const(bytes) if self.scl.only_text => Source::Frame(self.temporary(bytes.len() as u32)),
            Complex::Variable(access) => Source::Variable { access, located: self.locate(access) },
            _ => Source::Frame(self.complex_value(value)),
        }
    }

    fn read_back(&mut self, back: &Back) -> Value {
        match &back.located {
            Some(located) => self.read_located(back.access, located),
            None => self.read_access(back.access),
        }
    }
}
