//! SHL, SHR, ROL, ROR. Source: LAD/FBD reference C.14; STL reference, shifts.

use plcc_syntax::Elementary;
use plcc_syntax::ast::{Operand, OperandKind};
use plcc_syntax::literal::Literal;
use plcc_syntax::network::ast::{Element, Graph, PinValue};
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::boxes::Check;
use super::plan::Plan;
use super::values::width_of;

/// More places than any type has, of which ACCU2-LL can hold the number.
const ALL_PLACES: i64 = 64;

impl Maker<'_> {
    pub fn shift_box(&mut self, graph: &Graph, plan: &Plan, at: usize, name: &str) {
        use Elementary::{Byte, Dint, Dword, Int, Sint, Udint, Uint, Usint, Word};
        use StlInsn as I;
        let element = &graph.elements[at];
        let Some(ty) = self.box_type(element, &["in", "out"]) else { return };
        let insn = match (name, ty) {
            ("SHL", Byte | Word | Int | Sint | Usint | Uint) => I::ShiftLeftW,
            ("SHL", Dword | Dint | Udint) => I::ShiftLeftD,
            ("SHR", Byte | Word | Usint | Uint) => I::ShiftRightW,
            ("SHR", Dword | Udint) => I::ShiftRightD,
            ("SHR", Int | Sint) => I::ShiftSignedI,
            ("SHR", Dint) => I::ShiftSignedD,
            ("ROL", Dword) => I::RotateLeftD,
            ("ROR", Dword) => I::RotateRightD,
            _ => {
                let help = "leave the block in its language, or write the network with other elements";
                return self.refuse(element.span, format!("{name} of {}", ty.name()), help);
            }
        };
        let Some(mut value) = self.load(graph, at, "in", ty) else { return };
        if (name, ty) == ("SHR", Sint) {
            // L fills a byte with zeros.
            value.extend([I::ShiftLeftW, I::ShiftSignedI].map(|insn| (insn, Some(super::number(8, self.span)))));
        }
        match self.places(element) {
            Some(places) => {
                let counts = counts(insn, places);
                self.boxed(graph, plan, at, Check::Never, |maker| {
                    value.into_iter().for_each(|(insn, operand)| maker.push(insn, operand));
                    counts.into_iter().for_each(|count| maker.push(insn, Some(super::number(count, maker.span))));
                    maker.store_pin(graph, plan, at, "out", ty);
                });
            }
            None => {
                let Some(own) = self.type_of_places(element) else { return };
                let Some(number) = self.load(graph, at, "n", Word) else { return };
                self.boxed(graph, plan, at, Check::Never, |maker| {
                    number.into_iter().for_each(|(insn, operand)| maker.push(insn, operand));
                    maker.limit_places(insn, own);
                    value.into_iter().for_each(|(insn, operand)| maker.push(insn, operand));
                    maker.push(insn, None);
                    maker.store_pin(graph, plan, at, "out", ty);
                });
            }
        }
    }

    /// The number of places, if it is a constant.
    fn places(&self, element: &Element) -> Option<i64> {
        let PinValue::Operand(value) = &element.pin("n")?.value else { return None };
        match crate::operand::constant(value)? {
            Literal::Int(count @ 0..) => Some(count),
            Literal::Bits { value, .. } => Some(i64::from(value)),
            _ => None,
        }
    }

    /// The type of the number of places; none after a message.
    fn type_of_places(&mut self, element: &Element) -> Option<Elementary> {
        let value = element.pin("n").map(|pin| &pin.value);
        let ty = value.and_then(|value| self.type_of(value).or_else(|| width_of(value)));
        match ty {
            Some(ty @ (Elementary::Byte | Elementary::Usint | Elementary::Word | Elementary::Uint)) => Some(ty),
            Some(ty) => {
                let what = format!("a shift by a number of type {}", ty.name());
                self.refuse(element.span, what, "convert it to UINT");
                None
            }
            None => {
                self.unknown_type(element);
                None
            }
        }
    }

    /// Leaves a number of places in ACCU1-LL that moves as far as the one in ACCU1-L.
    fn limit_places(&mut self, insn: StlInsn, own: Elementary) {
        if matches!(insn, StlInsn::RotateLeftD | StlInsn::RotateRightD) {
            let places = Operand { kind: OperandKind::Literal(Literal::Word(31)), span: self.span };
            return self.push(StlInsn::AndW, Some(places));
        }
        if own.bits() == 8 {
            return;
        }
        let label = self.new_label();
        let number = self.temporary(Elementary::Word);
        let all = super::number(ALL_PLACES, self.span);
        self.push(StlInsn::Transfer, Some(number.clone()));
        self.push(StlInsn::Load, Some(all.clone()));
        self.push(StlInsn::CompareGtD, None);
        self.jump(StlInsn::JumpIfNot, &label);
        self.push(StlInsn::Load, Some(all));
        self.push(StlInsn::Transfer, Some(number.clone()));
        self.label(&label);
        self.push(StlInsn::Load, Some(number));
    }
}

/// The places of one instruction after the other, each with as many as it can have.
fn counts(insn: StlInsn, places: i64) -> Vec<i64> {
    match insn {
        StlInsn::RotateLeftD | StlInsn::RotateRightD => vec![places % 32],
        // All places after the first 15 are signs.
        StlInsn::ShiftSignedI => vec![places.min(15)],
        StlInsn::ShiftLeftW | StlInsn::ShiftRightW if places > 15 => vec![15, 1],
        StlInsn::ShiftLeftW | StlInsn::ShiftRightW => vec![places],
        _ => vec![places.min(32)],
    }
}
