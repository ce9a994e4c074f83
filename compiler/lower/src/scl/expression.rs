//! Expressions. Source: SCL reference, operators.

use plcc_ir::{BinaryOp, Type, UnaryOp as IrUnary, Value};
use plcc_model::scl::{Expr, ExprKind, UnaryOp};
use plcc_model::types::Elementary;

use super::value_type;
use crate::arithmetic::integer;
use crate::block::BlockLowering;

impl BlockLowering<'_, '_> {
    /// The value of an expression, in the IR type of its type.
    pub fn value(&mut self, expr: &Expr) -> Value {
        let value = self.value_of(expr);
        self.probe_expr(expr, value);
        value
    }

    fn value_of(&mut self, expr: &Expr) -> Value {
        match &expr.kind {
            ExprKind::Const(bits) => self.constant_of(expr.ty, *bits),
            ExprKind::Load(access) => self.read_access(access),
            ExprKind::Unary { op, operand } => {
                let value = self.value(operand);
                self.unary(*op, value, expr.ty)
            }
            ExprKind::Binary { op, left, right } => {
                let (a, b) = (self.value(left), self.value(right));
                self.binary(*op, a, b, expr.ty, right.ty)
            }
            ExprKind::Compare { op, left, right } => {
                let (a, b) = (self.value(left), self.value(right));
                self.compare(*op, a, b, left.ty)
            }
            ExprKind::Convert { conversion, operand } => {
                let value = self.value(operand);
                self.convert(*conversion, value, operand.ty, expr.ty)
            }
            ExprKind::Call(call) => {
                let result = self.scl_call(call);
                result.value.unwrap_or_else(|| self.zero(expr.ty))
            }
            ExprKind::Function { function, arguments } => {
                let values: Vec<Value> = arguments.iter().map(|argument| self.value(argument)).collect();
                let ty = arguments.last().map_or(expr.ty, |argument| argument.ty);
                self.function(*function, &values, ty, expr.ty)
            }
            ExprKind::Timer(call) => self.timer_function(call),
            ExprKind::Counter(call) => self.counter_function(call),
            ExprKind::Cell { kind, number } => self.cell_scan(*kind, number),
            ExprKind::Bound { parameter, dimension, upper } => self.array_bound(*parameter, dimension, *upper),
            ExprKind::Flag => {
                let flag = self.flag();
                self.b.use_var(flag)
            }
            ExprKind::LastEno => {
                let eno = self.last_eno();
                self.b.use_var(eno)
            }
        }
    }

    pub fn constant_of(&mut self, ty: Elementary, bits: u64) -> Value {
        self.b.iconst(value_type(ty), bits as i64)
    }

    fn unary(&mut self, op: UnaryOp, value: Value, ty: Elementary) -> Value {
        match op {
            UnaryOp::Not => self.b.not(value),
            UnaryOp::Negate if ty.is_float() => self.b.unary(IrUnary::Fneg, value),
            UnaryOp::Abs if ty.is_float() => self.b.unary(IrUnary::Fabs, value),
            UnaryOp::Negate => {
                let zero = self.zero(ty);
                let result = self.b.isub(zero, value);
                self.fail_if_least(value, ty);
                result
            }
            UnaryOp::Abs if ty.is_signed() => {
                let zero = self.zero(ty);
                let negative = self.b.icmp(plcc_ir::IntCc::Slt, value, zero);
                let minus = self.b.isub(zero, value);
                self.fail_if_least(value, ty);
                self.b.select(negative, minus, value)
            }
            UnaryOp::Abs => value,
        }
    }

    /// The smallest number has no counterpart; among unsigned numbers only 0 has one.
    fn fail_if_least(&mut self, value: Value, ty: Elementary) {
        if !self.wants_flag() {
            return;
        }
        let failed = if ty.is_signed() {
            self.b.icmp_imm(plcc_ir::IntCc::Eq, value, integer::least(ty.bits()))
        } else {
            self.b.icmp_imm(plcc_ir::IntCc::Ne, value, 0)
        };
        self.fail_if(failed);
    }

    /// `LOWER_BOUND`, `UPPER_BOUND`: a DINT; 0 for a dimension that the array does not have.
    fn array_bound(&mut self, parameter: usize, dimension: &Expr, upper: bool) -> Value {
        let number = self.value(dimension);
        let plcc_model::Passing::OpenArray { dimensions } = self.passing(parameter) else {
            unreachable!("the binder only uses bounds of ARRAY[*]")
        };
        let mut result = self.b.i32_const(0);
        let mut known = self.b.bool_const(false);
        for at in 0..dimensions {
            let (low, high) = self.open_bounds(parameter, at);
            let is_this = self.b.icmp_imm(plcc_ir::IntCc::Eq, number, i64::from(at));
            result = self.b.select(is_this, if upper { high } else { low }, result);
            known = self.b.or(known, is_this);
        }
        let unknown = self.b.not(known);
        self.fail_if(unknown);
        result
    }

    /// The low bits of a value as the integer type `ty`.
    pub fn narrowed(&mut self, value: Value, ty: Type) -> Value {
        if self.b.ty(value) == ty { value } else { self.b.trunc(ty, value) }
    }

    /// The value with `bits` as all of its bits, masked if a shift continues.
    pub fn masked(&mut self, value: Value, mask: i64) -> Value {
        self.b.binary_imm(BinaryOp::And, value, mask)
    }
}
