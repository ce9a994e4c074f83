//! `ENO =>` of functions of the language: one instruction that STL of an S7-1500 calls, whose ENO is the BR.
//!
//! Source: SCL reference, EN and ENO; S7-1500 information system, ENO of instructions in STL.

use plcc_model::scl::{
    Access, Actual, BinaryOp, Call, Complex, Conversion, Expr, ExprKind, Function, Statement, StatementKind, UnaryOp,
};
use plcc_model::types::{Class, Elementary};
use plcc_syntax::ast::{Operand, OperandKind, StatusOperand};
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::character::is_character;

impl Maker<'_> {
    /// A statement whose errors clear the bit of the block, which is set before it.
    pub fn watched(&mut self, statement: &Statement) {
        let is_done = match &statement.kind {
            StatementKind::Assign { target, value } if cannot_fail(value) => return self.assign(target, value),
            StatementKind::Assign { target, value } => !is_character(target) && self.watched_value(target, value),
            StatementKind::Call(call) if has_safe_inputs(call) => {
                self.call(call);
                true
            }
            _ => false,
        };
        if !is_done {
            return self.refuse(statement.span, "the ENO of this function", "call it without `ENO =>`");
        }
        let br = Operand { kind: OperandKind::Status(StatusOperand::Br), span: self.span };
        let flag = self.flag.clone();
        self.push(StlInsn::And, flag.clone());
        self.push(StlInsn::And, Some(br));
        self.push(StlInsn::Assign, flag);
    }

    /// Assigns what one instruction makes of its inputs; false: it is something else.
    fn watched_value(&mut self, target: &Access, value: &Expr) -> bool {
        if value.ty == Elementary::Bool || !self.has_type(value) {
            return false;
        }
        let Some(target) = self.target(target, false) else { return false };
        let is_called = match &value.kind {
            ExprKind::Function { function, arguments } if arguments.iter().all(cannot_fail) => {
                self.function_as_instruction(*function, arguments, value)
            }
            ExprKind::Binary { op: op @ (BinaryOp::Min | BinaryOp::Max), left, right }
                if cannot_fail(left) && cannot_fail(right) =>
            {
                let name = if *op == BinaryOp::Min { "MIN" } else { "MAX" };
                let inputs = [("IN1", &**left), ("IN2", &**right)];
                self.instruction(name, &[("value", value.ty)], &inputs, value)
            }
            ExprKind::Convert { conversion, operand } if cannot_fail(operand) => {
                self.conversion_as_instruction(*conversion, operand, value)
            }
            ExprKind::Call(call) if has_safe_inputs(call) => match self.call(call) {
                Some(result) => {
                    self.push(StlInsn::Load, Some(result));
                    true
                }
                None => false,
            },
            _ => false,
        };
        if is_called {
            let operand = self.reach(&target, value.ty);
            self.push(StlInsn::Transfer, Some(operand));
        }
        is_called
    }
}

/// Nothing but the block itself can fail.
fn has_safe_inputs(call: &Call) -> bool {
    call.enable.is_none()
        && call.eno.is_none()
        && call.arguments.iter().all(|argument| match &argument.actual {
            Actual::Value(value) => cannot_fail(value),
            Actual::Complex(Complex::Variable(access))
            | Actual::Variable { access, back: None }
            | Actual::Reference(access) => access.indices.is_empty(),
            Actual::Complex(Complex::Const(_)) => true,
            _ => false,
        })
}

/// No operation of the value clears the bit of the block.
fn cannot_fail(value: &Expr) -> bool {
    match &value.kind {
        ExprKind::Const(_) => true,
        ExprKind::Load(access) => access.indices.is_empty(),
        ExprKind::Unary { op: UnaryOp::Not, operand } => cannot_fail(operand),
        ExprKind::Binary { op, left, right } => {
            let is_of_bits = matches!(
                op,
                BinaryOp::And
                    | BinaryOp::Or
                    | BinaryOp::Xor
                    | BinaryOp::ShiftLeft
                    | BinaryOp::ShiftRight
                    | BinaryOp::RotateLeft
                    | BinaryOp::RotateRight
            );
            is_of_bits && cannot_fail(left) && cannot_fail(right)
        }
        ExprKind::Convert { conversion: Conversion::Value(_), operand } => {
            let is_integer = matches!(operand.ty.class(), Class::Signed | Class::Unsigned);
            let is_wider = value.ty.class() == Class::Signed && value.ty.bits() > operand.ty.bits();
            is_integer && is_wider && cannot_fail(operand)
        }
        ExprKind::Function { function: Function::Select, arguments } => arguments.iter().all(cannot_fail),
        _ => false,
    }
}
