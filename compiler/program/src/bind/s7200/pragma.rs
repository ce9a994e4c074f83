//! Pragmas between statements.

use plcc_abi::image::AssertOp;
use plcc_diag::Span;
use plcc_syntax::ast::{self as classic, Pragma, Width};
use plcc_syntax::s7200::ast::{Area, Assert, AssertSide, Constant, Operand as Written};

use super::super::pragma::{bad_pragma, split, unknown_pragma};
use super::Binder;
use super::constant::{Target, mask};
use super::interface::Locals;
use super::operand::{memory, place};
use super::settle::Settled;
use crate::model::s7200 as model;
use crate::model::s7200::StatementKind;

/// One side before the other one is known.
enum Side {
    Bound(model::AssertSide, Width),
    Constant(Constant, Span),
}

impl Binder<'_> {
    pub fn statement_pragma(
        &mut self,
        locals: &Locals,
        pragma: &Pragma,
        assert: Option<&Assert>,
    ) -> Option<StatementKind> {
        if !self.input.pragmas {
            return None;
        }
        let (word, rest) = split(&pragma.text);
        match word {
            // One that is not built as `assert LHS OP RHS` was reported when it was read.
            "assert" => self.assert(locals, pragma, assert?),
            "sleep" => match rest.parse::<u32>() {
                Ok(milliseconds) => Some(StatementKind::Sleep(milliseconds)),
                Err(_) => {
                    let title = "`sleep` takes a number of milliseconds";
                    bad_pragma(&mut self.report, pragma.span, title, "write `//@ sleep 100`");
                    None
                }
            },
            // Those of the whole file, which the file lists by itself.
            "cpu" | "test" => None,
            _ if word.starts_with('^') => None,
            _ => {
                unknown_pragma(&mut self.report, pragma);
                None
            }
        }
    }

    fn assert(&mut self, locals: &Locals, pragma: &Pragma, assert: &Assert) -> Option<StatementKind> {
        let left = self.assert_side(locals, &assert.left);
        let right = self.assert_side(locals, &assert.right);
        let (left, right) = (left?, right?);
        let op = match assert.op {
            classic::AssertOp::Eq => AssertOp::Eq,
            classic::AssertOp::Ne => AssertOp::Ne,
            classic::AssertOp::Lt => AssertOp::Lt,
            classic::AssertOp::Le => AssertOp::Le,
            classic::AssertOp::Gt => AssertOp::Gt,
            classic::AssertOp::Ge => AssertOp::Ge,
        };
        let ordered = matches!(op, AssertOp::Lt | AssertOp::Le | AssertOp::Gt | AssertOp::Ge);
        let real = [&left, &right].iter().any(|side| matches!(side, Side::Constant(Constant::Real(_), _)));
        let width = match (&left, &right) {
            (Side::Bound(_, width), _) | (_, Side::Bound(_, width)) => *width,
            _ => Width::Dword,
        };
        let (left, left_constant) = self.settle_side(left, width, real)?;
        let (right, right_constant) = self.settle_side(right, width, real)?;
        Some(StatementKind::Assert(model::Assert {
            left,
            op,
            right,
            real: ordered && real,
            trap: matches!((left_constant, right_constant), (Some(left), Some(right)) if left != right),
            text: pragma.text.clone(),
        }))
    }

    fn assert_side(&mut self, locals: &Locals, side: &AssertSide) -> Option<Side> {
        let operand: &Written = match side {
            AssertSide::Stack(level @ 0..=8) => return Some(Side::Bound(model::AssertSide::Stack(*level), Width::Bit)),
            AssertSide::Stack(_) => return None,
            AssertSide::Eno => return Some(Side::Bound(model::AssertSide::Eno, Width::Bit)),
            AssertSide::Operand(operand) => operand,
        };
        match self.settle(locals, operand, false)? {
            Settled::Constant(constant) => Some(Side::Constant(constant, operand.span)),
            Settled::Pointer(value) => {
                let constant = Constant::Bits { value, width: Some(Width::Dword) };
                Some(Side::Constant(constant, operand.span))
            }
            settled @ (Settled::Direct(_) | Settled::StringVariable(_)) => {
                let (operand, width) = self.plain(settled, operand.span)?;
                Some(Side::Bound(model::AssertSide::Operand(operand), width))
            }
            Settled::Indirect(_) | Settled::Block(_) => {
                bad_pragma(
                    &mut self.report,
                    operand.span,
                    "this has no value of up to 32 bits",
                    "name an address, a symbol, a constant, AC0 to AC3, S0 to S8 of the logic stack, or ENO",
                );
                None
            }
        }
    }

    /// The operand that the pragma at `span` compares, with its width.
    fn plain(&mut self, settled: Settled, span: Span) -> Option<(model::Operand, Width)> {
        let direct = match settled {
            Settled::Direct(direct) => direct,
            Settled::StringVariable(pointer) => return Some((memory(pointer, Width::Dword)?, Width::Dword)),
            _ => return None,
        };
        let width = match (direct.area, direct.width) {
            (_, Some(width)) => width,
            (Area::T | Area::C, None) => Width::Bit,
            (Area::Ai | Area::Aq, None) => Width::Word,
            (_, None) => Width::Dword,
        };
        self.check_range(direct, width, 1, span)?;
        Some((place(direct, width), width))
    }

    /// A constant gets the bits that it has in the width of the other side.
    fn settle_side(&mut self, side: Side, width: Width, real: bool) -> Option<(model::AssertSide, Option<u32>)> {
        let (constant, span) = match side {
            Side::Bound(side, _) => return Some((side, None)),
            Side::Constant(constant, span) => (constant, span),
        };
        let value = match (&constant, width) {
            (Constant::Bool(value), _) => u32::from(*value),
            (Constant::Integer(value), Width::Dword) if real => (*value as f32).to_bits(),
            // A byte of the other side is compared without a sign; a negative constant has the same bits.
            (Constant::Integer(value @ -128..=-1), Width::Byte) => *value as u32 & mask(width),
            _ => self.constant(&constant, Target::Bits(width), span)?,
        };
        Some((model::AssertSide::Operand(model::Operand::Const(value)), Some(value)))
    }
}
