//! SCATTER_BLK and GATHER_BLK: several bit strings of an array to and from an array of BOOL, beginning with one element.
//!
//! Bit i of element k is BOOL k * width + i. Elements that do not fit are skipped, and ENO is 0.
//! Source: S7-1200 reference, move operations.

use plcc_diag::Span;
use plcc_syntax::{Class, Elementary};

use super::Intent;
use super::array::{Run, shortened};
use super::memory::{binary, bit_of, load, minus_one, number};
use super::pins::Pins;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_model::layout;
use plcc_model::scl::{BinaryOp, Statement, StatementKind};
use plcc_model::types::DataType;

impl SclBinder<'_, '_> {
    /// `to_bits`: SCATTER_BLK, else GATHER_BLK.
    pub fn scatter_block(
        &mut self,
        ctx: &mut SclBlock,
        to_bits: bool,
        pins: &Pins,
        span: Span,
    ) -> Option<Vec<StatementKind>> {
        let source = self.run(ctx, pins.get("IN")?, Intent::Read);
        let count = self.dint(ctx, pins.get(if to_bits { "COUNT_IN" } else { "COUNT_OUT" })?);
        let target = self.run(ctx, pins.get("OUT")?, Intent::Write);
        let (source, target, count) = (source?, target?, count?);
        let (strings, bools) = if to_bits { (&source, &target) } else { (&target, &source) };
        let ty = self.bit_strings(strings, bools)?;
        let width = || number(ty.bits() as i32, span);

        let mut code = Vec::new();
        let string = self.kept(ctx, &mut code, strings.first.clone());
        let bool_at = self.kept(ctx, &mut code, bools.first.clone());
        let left = self.temp(ctx, Elementary::Dint, span);
        let rest = || load(&left, Elementary::Dint);
        code.push(StatementKind::Assign { target: left.clone(), value: count });
        code.push(shortened(&left, strings, &string, span));
        // As many strings as there are BOOLs for them.
        let value = binary(BinaryOp::Multiply, rest(), width());
        code.push(StatementKind::Assign { target: left.clone(), value });
        code.push(shortened(&left, bools, &bool_at, span));
        let value = binary(BinaryOp::Divide, rest(), width());
        code.push(StatementKind::Assign { target: left.clone(), value });

        let at = self.temp(ctx, Elementary::Dint, span);
        let whole = self.temp(ctx, ty, span);
        let offset = || load(&at, Elementary::Dint);
        let string = strings.at(&string, offset());
        let mut body = Vec::new();
        let mut push = |target, value| body.push(Statement { kind: StatementKind::Assign { target, value }, span });
        if to_bits {
            push(whole.clone(), load(&string, ty));
        }
        for bit in 0..ty.bits() as usize {
            let first = binary(BinaryOp::Multiply, offset(), width());
            let place = bools.at(&bool_at, binary(BinaryOp::Add, first, number(bit as i32, span)));
            let in_string = bit_of(&whole, bit);
            let (to, from) = if to_bits { (place, in_string) } else { (in_string, place) };
            push(to, load(&from, Elementary::Bool));
        }
        if !to_bits {
            push(string, load(&whole, ty));
        }
        let (start, step) = (number(0, span), number(1, span));
        code.push(StatementKind::For { variable: at, start, end: minus_one(rest()), step, body });
        Some(code)
    }

    /// The type of the bit strings, if one array has them and the other has BOOLs.
    fn bit_strings(&mut self, strings: &Run, bools: &Run) -> Option<Elementary> {
        let wrong = |binder: &mut Self, run: &Run, wanted: &str| {
            let is = format!("an array of {}", layout::type_name(&run.element));
            binder.wrong_type(run.array.span, &is, wanted, None);
        };
        if bools.element != DataType::Elementary(Elementary::Bool) {
            wrong(self, bools, "an array of BOOL");
            return None;
        }
        match strings.element {
            DataType::Elementary(ty) if ty.class() == Class::Bits && ty != Elementary::Bool => Some(ty),
            _ => {
                wrong(self, strings, "an array of BYTE, WORD, DWORD or LWORD");
                None
            }
        }
    }
}
