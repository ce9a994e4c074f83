//! SEL, MUX, MIN, MAX and LIMIT: one of several values, which are all computed first; times of a day, which begin again after 24 hours.
//!
//! Source: SCL reference, selection, operators.

use plcc_model::scl::{BinaryOp, CompareOp, Expr};
use plcc_model::types::Elementary;
use plcc_syntax::ast::Operand;
use plcc_syntax::stl::StlInsn;

use super::Maker;

/// The REAL that results from operations with something that is not a number.
pub const INVALID: u32 = 0xFFFF_FFFF;

/// Milliseconds of a day.
const DAY: u64 = 86_400_000;

impl Maker<'_> {
    /// `(G, IN0, IN1)`.
    pub fn select(&mut self, arguments: &[Expr], value: &Expr) {
        let kept = self.all_kept(arguments);
        let [choice, first, second] = &kept[..] else { return self.no_operator(value) };
        let label = self.new_label();
        self.push(StlInsn::AndNot, Some(choice.clone()));
        self.jump(StlInsn::JumpIf, &label);
        self.load_and_store(value.ty, second.clone(), first.clone());
        self.label(&label, self.span.start);
        self.load_chosen(value.ty, first);
    }

    /// `(K, IN0, …, INn)`; without an input for K it is the last argument if `has_else`, otherwise 0.
    pub fn multiplex(&mut self, has_else: bool, arguments: &[Expr], value: &Expr) {
        let number = arguments.first().map_or(value.ty, |first| first.ty);
        let Some(equal) = super::logic::comparison(CompareOp::Equal, number) else { return self.no_operator(value) };
        let kept = self.all_kept(arguments);
        let Some((choice, values)) = kept.split_first() else { return self.no_operator(value) };
        let (values, other) = match values.split_last() {
            Some((other, values)) if has_else => (values, Some(other)),
            _ => (values, None),
        };
        let result = self.temporary(value.ty);
        let end = self.new_label();
        for (at, one) in values.iter().enumerate() {
            let next = self.new_label();
            let place = self.constant(number, at as u64);
            self.push(StlInsn::Load, Some(choice.clone()));
            self.push(StlInsn::Load, Some(place));
            self.push(equal, None);
            self.jump(StlInsn::JumpIfNot, &next);
            self.load_and_store(value.ty, one.clone(), result.clone());
            self.jump(StlInsn::Jump, &end);
            self.label(&next, self.span.start);
        }
        match other {
            Some(other) => self.load_and_store(value.ty, other.clone(), result.clone()),
            None if value.ty == Elementary::Bool => {
                self.push(StlInsn::ClearRlo, None);
                self.push(StlInsn::Assign, Some(result.clone()));
            }
            None => {
                let zero = self.constant(value.ty, 0);
                self.load_and_store(value.ty, zero, result.clone());
            }
        }
        self.label(&end, self.span.start);
        self.load_chosen(value.ty, &result);
    }

    fn load_chosen(&mut self, ty: Elementary, chosen: &Operand) {
        let load = if ty == Elementary::Bool { StlInsn::And } else { StlInsn::Load };
        self.push(load, Some(chosen.clone()));
    }

    /// MIN or MAX of two REALs: what is not a number is the result.
    pub fn least_or_most_real(&mut self, op: BinaryOp, left: &Expr, right: &Expr) {
        let beyond = if op == BinaryOp::Min { StlInsn::CompareGtR } else { StlInsn::CompareLtR };
        self.number(left);
        let chosen = self.keep(Elementary::Real);
        self.number(right);
        let other = self.keep(Elementary::Real);
        let (take, end) = (self.new_label(), self.new_label());
        self.with_both(&chosen, beyond, &other);
        self.jump(StlInsn::JumpIf, &take);
        self.with_both(&other, StlInsn::CompareEqR, &other);
        self.jump(StlInsn::JumpIf, &end);
        self.label(&take, self.span.start);
        self.load_and_store(Elementary::Real, other, chosen.clone());
        self.label(&end, self.span.start);
        // As a result of an operation, it has one of the forms that those have.
        let one = self.constant(Elementary::Real, u64::from(1.0_f32.to_bits()));
        self.push(StlInsn::Load, Some(chosen));
        self.push(StlInsn::Load, Some(one));
        self.push(StlInsn::MulR, None);
    }

    /// Jumps to the label that it returns if one of the REALs is not a number.
    pub fn jump_if_invalid(&mut self, values: &[Operand]) -> String {
        let label = self.new_label();
        for value in values {
            self.with_both(value, StlInsn::CompareEqR, value);
            self.jump(StlInsn::JumpIfNot, &label);
        }
        label
    }

    /// A time of day, and milliseconds that are added to it or subtracted.
    pub fn day_time(&mut self, op: BinaryOp, left: &Expr, right: &Expr) {
        let insn = if op == BinaryOp::AddDay { StlInsn::AddD } else { StlInsn::SubD };
        let [day, zero] = [DAY, 0].map(|bits| self.constant(Elementary::Dint, bits));
        self.number(left);
        let time = self.keep(Elementary::Dint);
        self.number(right);
        self.push(StlInsn::Load, Some(day.clone()));
        self.push(StlInsn::ModD, None);
        let step = self.keep(Elementary::Dint);
        let (low, end) = (self.new_label(), self.new_label());
        self.with_both(&time, insn, &step);
        self.push(StlInsn::Transfer, Some(time.clone()));
        self.with_both(&time, StlInsn::CompareLtD, &zero);
        self.jump(StlInsn::JumpIf, &low);
        self.with_both(&time, StlInsn::CompareGeD, &day);
        self.jump(StlInsn::JumpIfNot, &end);
        self.with_both(&time, StlInsn::SubD, &day);
        self.push(StlInsn::Transfer, Some(time.clone()));
        self.jump(StlInsn::Jump, &end);
        self.label(&low, self.span.start);
        self.with_both(&time, StlInsn::AddD, &day);
        self.push(StlInsn::Transfer, Some(time.clone()));
        self.label(&end, self.span.start);
        self.push(StlInsn::Load, Some(time));
    }

    /// An instruction with two operands.
    fn with_both(&mut self, left: &Operand, insn: StlInsn, right: &Operand) {
        self.push(StlInsn::Load, Some(left.clone()));
        self.push(StlInsn::Load, Some(right.clone()));
        self.push(insn, None);
    }
}
