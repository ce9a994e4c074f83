//! SEL and MUX: one of several values, which are all computed first. Source: SCL reference, selection.

use plcc_model::scl::{CompareOp, Expr};
use plcc_model::types::Elementary;
use plcc_syntax::ast::Operand;
use plcc_syntax::stl::StlInsn;

use super::Maker;

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
}
