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

type Statements = Vec<(StlInsn, Option<Operand>)>;

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
            ("ROL", _) if (8..=32).contains(&ty.bits()) => I::RotateLeftD,
            ("ROR", _) if (8..=32).contains(&ty.bits()) => I::RotateRightD,
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
        let rotates = matches!(insn, I::RotateLeftD | I::RotateRightD);
        match self.places(element) {
            Some(places) => {
                let counts = if rotates { vec![places % i64::from(ty.bits())] } else { counts(insn, places) };
                self.boxed(graph, plan, at, Check::Never, |maker| {
                    value.into_iter().for_each(|(insn, operand)| maker.push(insn, operand));
                    if rotates {
                        maker.fill_double_word(ty);
                    }
                    counts.into_iter().for_each(|count| maker.push(insn, Some(super::number(count, maker.span))));
                    if rotates {
                        maker.cut_double_word(ty);
                    }
                    maker.store_pin(graph, plan, at, "out", ty);
                });
            }
            None => {
                let Some(own) = self.type_of_places(element) else { return };
                let Some(number) = self.load(graph, at, "n", Word) else { return };
                if rotates && ty.bits() < 32 {
                    return self.rotate_by(graph, plan, at, (insn, ty), (value, number));
                }
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

    /// ROL, ROR of a byte or word by a number of places that is a variable.
    fn rotate_by(
        &mut self,
        graph: &Graph,
        plan: &Plan,
        at: usize,
        (insn, ty): (StlInsn, Elementary),
        (value, number): (Statements, Statements),
    ) {
        self.boxed(graph, plan, at, Check::Never, |maker| {
            value.into_iter().for_each(|(insn, operand)| maker.push(insn, operand));
            maker.fill_double_word(ty);
            let whole = maker.temporary(Elementary::Dword);
            maker.push(StlInsn::Transfer, Some(whole.clone()));
            number.into_iter().for_each(|(insn, operand)| maker.push(insn, operand));
            let places = Operand { kind: OperandKind::Literal(Literal::Word(ty.bits() as u16 - 1)), span: maker.span };
            maker.push(StlInsn::AndW, Some(places));
            maker.push(StlInsn::Load, Some(whole));
            maker.push(insn, None);
            maker.cut_double_word(ty);
            maker.store_pin(graph, plan, at, "out", ty);
        });
    }

    /// A byte or word beside itself in a double word rotates as the double word does.
    fn fill_double_word(&mut self, ty: Elementary) {
        if ty.is_signed() {
            self.cut_double_word(ty);
        }
        for half in [8, 16].into_iter().filter(|half| *half >= ty.bits()) {
            let stored = self.temporary(Elementary::Dword);
            self.push(StlInsn::Transfer, Some(stored.clone()));
            self.push(StlInsn::ShiftLeftD, Some(super::number(i64::from(half), self.span)));
            self.push(StlInsn::Load, Some(stored));
            self.push(StlInsn::OrD, None);
        }
    }

    /// The byte or word alone.
    fn cut_double_word(&mut self, ty: Elementary) {
        if ty.bits() < 32 {
            let mask = Operand { kind: OperandKind::Literal(Literal::Dword((1 << ty.bits()) - 1)), span: self.span };
            self.push(StlInsn::AndD, Some(mask));
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
        // All places after the first 15 are signs.
        StlInsn::ShiftSignedI => vec![places.min(15)],
        StlInsn::ShiftLeftW | StlInsn::ShiftRightW if places > 15 => vec![15, 1],
        StlInsn::ShiftLeftW | StlInsn::ShiftRightW => vec![places],
        _ => vec![places.min(32)],
    }
}
