//! Shifts and rotations. Source: SCL reference, SHL, SHR, ROL, ROR; STL reference, shifts.

use plcc_model::scl::{BinaryOp, Expr, ExprKind};
use plcc_model::types::Elementary;
use plcc_syntax::stl::StlInsn;

use super::Maker;

/// The most places that an instruction shifts by.
const COUNT_MAX: u64 = 255;

impl Maker<'_> {
    pub fn shift(&mut self, op: BinaryOp, left: &Expr, count: &Expr, value: &Expr) {
        use Elementary::{Byte, Dint, Dword, Int, Sint, Udint, Uint, Usint, Word};
        let insn = match (op, value.ty) {
            (BinaryOp::ShiftLeft, Byte | Word | Int | Sint | Usint | Uint) => StlInsn::ShiftLeftW,
            (BinaryOp::ShiftLeft, Dword | Dint | Udint) => StlInsn::ShiftLeftD,
            (BinaryOp::ShiftRight, Byte | Word | Usint | Uint) => StlInsn::ShiftRightW,
            (BinaryOp::ShiftRight, Dword | Udint) => StlInsn::ShiftRightD,
            (BinaryOp::ShiftRight, Int | Sint) => StlInsn::ShiftSignedI,
            (BinaryOp::ShiftRight, Dint) => StlInsn::ShiftSignedD,
            _ => return self.no_operator(value),
        };
        let signed_byte = (op, value.ty) == (BinaryOp::ShiftRight, Sint);
        let most = if value.ty.bits() == 32 { 32 } else { 15 };
        self.number(left);
        match count.kind {
            ExprKind::Const(bits) if bits <= most => {
                if signed_byte {
                    self.sign_of_byte();
                }
                self.push(insn, Some(super::code::number(bits as i64, self.span)));
            }
            _ => {
                let stored = self.keep(left.ty);
                self.shift_count(count);
                self.push(StlInsn::Load, Some(stored));
                if signed_byte {
                    self.sign_of_byte();
                }
                self.push(insn, None);
            }
        }
        self.mask(if value.ty.bits() == 8 { 8 } else { 32 });
    }

    /// A count as the low byte of ACCU1: more than 255 counts as 255, a negative one modulo 256.
    fn shift_count(&mut self, count: &Expr) {
        if let ExprKind::Const(bits) = count.kind {
            let is_negative = count.ty.is_signed() && bits >> (count.ty.bits() - 1) & 1 == 1;
            let places = if is_negative { bits & 0xFF } else { bits.min(COUNT_MAX) };
            let places = super::code::number(places as i64, self.span);
            return self.push(StlInsn::Load, Some(places));
        }
        self.number(count);
        if !is_limited(count.ty) {
            return;
        }
        let stored = self.keep(count.ty);
        let label = self.new_label();
        match count.ty {
            Elementary::Int | Elementary::Dint => {
                let is_int = count.ty == Elementary::Int;
                let limit = self.constant(count.ty, COUNT_MAX);
                self.push(StlInsn::Load, Some(limit));
                self.push(if is_int { StlInsn::CompareLeI } else { StlInsn::CompareLeD }, None);
                self.jump(StlInsn::JumpIf, &label);
            }
            _ => {
                self.dword_constant(StlInsn::AndD, !(COUNT_MAX as u32));
                self.jump(StlInsn::JumpZero, &label);
            }
        }
        let limit = self.constant(count.ty, COUNT_MAX);
        self.push(StlInsn::Load, Some(limit));
        self.push(StlInsn::Transfer, Some(stored.clone()));
        self.label(&label, self.span.start);
        self.push(StlInsn::Load, Some(stored));
    }

    /// A byte or word beside itself in a double word rotates as the double word does.
    pub fn rotate(&mut self, op: BinaryOp, left: &Expr, count: &Expr, value: &Expr) {
        let insn = if op == BinaryOp::RotateLeft { StlInsn::RotateLeftD } else { StlInsn::RotateRightD };
        let bits = value.ty.bits();
        self.number(left);
        if left.ty.is_signed() {
            self.mask(bits);
        }
        for half in [8, 16].into_iter().filter(|half| *half >= bits) {
            let stored = self.keep(Elementary::Dword);
            self.push(StlInsn::ShiftLeftD, Some(super::code::number(i64::from(half), self.span)));
            self.push(StlInsn::Load, Some(stored));
            self.push(StlInsn::OrD, None);
        }
        match count.kind {
            ExprKind::Const(count) => {
                let places = count as i64 & i64::from(bits - 1);
                self.push(insn, Some(super::code::number(places, self.span)));
            }
            _ => {
                let stored = self.keep(Elementary::Dword);
                self.number(count);
                self.dword_constant(StlInsn::AndD, bits - 1);
                self.push(StlInsn::Load, Some(stored));
                self.push(insn, None);
            }
        }
        self.mask(bits);
    }
}

/// A count of the type may be more than a shift can have, or below 0 with more than one byte.
pub fn is_limited(ty: Elementary) -> bool {
    ty.bits() > 8
}
