//! Comparisons, ranges, and whether a REAL is a number. Source: LAD/FBD reference C.5.

use plcc_syntax::ast::{Operand, OperandKind};
use plcc_syntax::literal::Literal;
use plcc_syntax::network::ast::{Element, Graph};
use plcc_syntax::stl::StlInsn;
use plcc_syntax::{Class, Elementary};

use super::Maker;
use super::logic::Logic;
use super::plan::Plan;
use super::types::elementary;
use super::values::width_of;

/// A comparison of two values, one after the other.
struct Way {
    /// For the signs in the order of [`SIGNS`].
    insns: [StlInsn; 6],
    /// What follows each load, so that the instruction compares values of the type.
    after: Vec<(StlInsn, u32)>,
    /// 32 bits are compared.
    wide: bool,
}

const SIGNS: [&str; 6] = ["=", "<>", "<", ">", "<=", ">="];

/// The exponent of a REAL.
const EXPONENT: u32 = 0x7F80_0000;
/// All of a REAL but its sign.
const AMOUNT: u32 = 0x7FFF_FFFF;
/// It makes unsigned numbers of 32 bits signed ones in the same order.
pub const SIGN: u32 = 0x8000_0000;

impl Maker<'_> {
    /// A comparison as a value.
    pub fn compare(&mut self, graph: &Graph, plan: &Plan, at: usize, sign: &str) -> Logic {
        let flow = self.input(graph, plan, at, "pre");
        let Some(ty) = self.type_or_width(&graph.elements[at], &["in1", "in2"]) else { return Logic::Constant(false) };
        let compared = self.compared(graph, at, ["in1", "in2"], sign, ty);
        Logic::and(vec![flow, compared.unwrap_or(Logic::Constant(false))])
    }

    /// The type in which inputs are compared; of addresses without a type the bits of their width.
    pub fn type_or_width(&mut self, element: &Element, names: &[&str]) -> Option<Elementary> {
        let told = self.messages.len();
        let ty = self.box_type(element, names);
        let is_set = element.templates.iter().any(|template| elementary(&template.value).is_some());
        let types = names.iter().filter_map(|name| self.type_of(&element.pin(name)?.value));
        if ty.is_some() || is_set || types.count() > 0 {
            return ty;
        }
        let width = names.iter().find_map(|name| width_of(&element.pin(name)?.value))?;
        self.messages.truncate(told);
        Some(width)
    }

    /// IN_RANGE, OUT_RANGE.
    pub fn range(&mut self, graph: &Graph, plan: &Plan, at: usize, inside: bool) -> Logic {
        let flow = self.input(graph, plan, at, "pre");
        let Some(ty) = self.box_type(&graph.elements[at], &["min", "in", "max"]) else { return flow };
        let signs = if inside { [">=", "<="] } else { ["<", ">"] };
        let limits = ["min", "max"].into_iter().zip(signs);
        let both: Option<Vec<Logic>> =
            limits.map(|(limit, sign)| self.compared(graph, at, ["in", limit], sign, ty)).collect();
        let Some(both) = both else { return flow };
        let mut parts = vec![flow];
        match inside {
            true => parts.extend(both),
            false => {
                parts.push(Logic::or(both));
                if ty == Elementary::Real {
                    // Nothing is outside a limit that is NaN.
                    let numbers = ["min", "max"].map(|limit| self.compared(graph, at, [limit, limit], "=", ty));
                    parts.extend(numbers.into_iter().flatten());
                }
            }
        }
        Logic::and(parts)
    }

    /// OK, NOT_OK: a REAL is neither infinite nor NaN nor denormal.
    pub fn valid(&mut self, graph: &Graph, plan: &Plan, at: usize, valid: bool) -> Logic {
        let flow = self.input(graph, plan, at, "pre");
        let element = &graph.elements[at];
        let Some((operand, ty)) = self.source(graph, at, "operand", Elementary::Real) else { return flow };
        if ty != Elementary::Real {
            self.refuse(element.span, format!("the question whether a {} is valid", ty.name()), "ask about a REAL");
            return flow;
        }
        let masked = |maker: &Self, mask: u32, with: u32, insn: StlInsn| {
            let loads = vec![
                (StlInsn::Load, Some(operand.clone())),
                (StlInsn::AndD, Some(maker.bits(mask))),
                (StlInsn::Load, Some(maker.bits(with))),
            ];
            Logic::Compare { loads, insn }
        };
        let finite = masked(self, EXPONENT, EXPONENT, StlInsn::CompareNeD);
        let normal = masked(self, EXPONENT, 0, StlInsn::CompareNeD);
        let zero = masked(self, AMOUNT, 0, StlInsn::CompareEqD);
        let check = Logic::and(vec![finite, Logic::or(vec![normal, zero])]);
        Logic::and(vec![flow, if valid { check } else { check.not() }])
    }

    /// The comparison of two inputs, both as values of type `ty`; none after a message.
    pub fn compared(
        &mut self,
        graph: &Graph,
        at: usize,
        names: [&str; 2],
        sign: &str,
        ty: Elementary,
    ) -> Option<Logic> {
        let place = SIGNS.iter().position(|known| *known == sign)?;
        let Some(way) = way(ty, place > 1) else {
            let what = format!("the comparison `{sign}` of {}", ty.name());
            self.refuse(graph.elements[at].span, what, "compare numbers of up to 32 bits");
            return None;
        };
        let mut loads = Vec::new();
        for name in names {
            let mut load = self.load(graph, at, name, ty)?;
            if way.wide
                && let Some((_, Some(Operand { kind: OperandKind::Literal(literal), .. }))) = load.first_mut()
            {
                *literal = wide(literal, ty);
            }
            loads.extend(load);
            for (insn, number) in &way.after {
                let operand = match insn {
                    StlInsn::XorD => self.bits(*number),
                    _ => super::number(i64::from(*number), self.span),
                };
                loads.push((*insn, Some(operand)));
            }
        }
        // On an S7-300, a NaN is not even different.
        if ty == Elementary::Real && sign == "<>" && !self.keeps_br {
            return Some(Logic::Compare { loads, insn: way.insns[0] }.not());
        }
        Some(Logic::Compare { loads, insn: way.insns[place] })
    }

    /// Whether an input of an integer type has this number; none after a message.
    pub fn equals_number(
        &mut self,
        graph: &Graph,
        at: usize,
        name: &str,
        ty: Elementary,
        number: i32,
    ) -> Option<Logic> {
        let Some(way) = way(ty, false).filter(|_| ty != Elementary::Real) else {
            let what = format!("a number of type {} here", ty.name());
            self.refuse(graph.elements[at].span, what, "use an integer of up to 32 bits");
            return None;
        };
        let mut loads = self.load(graph, at, name, ty)?;
        loads.extend(way.after.iter().map(|(insn, count)| (*insn, Some(super::number(i64::from(*count), self.span)))));
        let number = match way.wide || ty.bits() == 32 {
            true => Literal::Dint(number),
            false => Literal::Int(i64::from(number)),
        };
        loads.push((StlInsn::Load, Some(Operand { kind: OperandKind::Literal(number), span: self.span })));
        Some(Logic::Compare { loads, insn: way.insns[0] })
    }

    pub fn bits(&self, value: u32) -> Operand {
        Operand { kind: OperandKind::Literal(Literal::Dword(value)), span: self.span }
    }
}

/// How STL compares values of a type; none: it does not.
fn way(ty: Elementary, is_order: bool) -> Option<Way> {
    use StlInsn as I;
    let int = [I::CompareEqI, I::CompareNeI, I::CompareLtI, I::CompareGtI, I::CompareLeI, I::CompareGeI];
    let dint = [I::CompareEqD, I::CompareNeD, I::CompareLtD, I::CompareGtD, I::CompareLeD, I::CompareGeD];
    let real = [I::CompareEqR, I::CompareNeR, I::CompareLtR, I::CompareGtR, I::CompareLeR, I::CompareGeR];
    let plain = |insns: [StlInsn; 6], wide: bool| Some(Way { insns, after: Vec::new(), wide });
    match ty {
        Elementary::Int => plain(int, false),
        // L fills with zeros.
        Elementary::Sint => {
            Some(Way { insns: int, after: vec![(I::ShiftLeftW, 8), (I::ShiftSignedI, 8)], wide: false })
        }
        Elementary::Dint | Elementary::Time | Elementary::TimeOfDay => plain(dint, false),
        Elementary::Real => plain(real, false),
        Elementary::Byte | Elementary::Word | Elementary::Char if !is_order => plain(int, false),
        Elementary::Byte
        | Elementary::Word
        | Elementary::Char
        | Elementary::Usint
        | Elementary::Uint
        | Elementary::Date => plain(dint, true),
        Elementary::Dword | Elementary::Udint if !is_order => plain(dint, true),
        Elementary::Dword | Elementary::Udint => Some(Way { insns: dint, after: vec![(I::XorD, SIGN)], wide: true }),
        Elementary::Bool
        | Elementary::Lword
        | Elementary::Wchar
        | Elementary::Lint
        | Elementary::Ulint
        | Elementary::Lreal
        | Elementary::S5Time
        | Elementary::Ltime
        | Elementary::Ltod
        | Elementary::Ldt => None,
    }
}

/// A constant as one of 32 bits, which no sign fills.
pub fn wide(literal: &Literal, ty: Elementary) -> Literal {
    let value = match literal {
        Literal::Int(value) if ty.class() == Class::Bits && ty.bits() == 16 => i64::from(*value as u16),
        Literal::Int(value) => *value,
        Literal::Bits { value, .. } => i64::from(*value),
        other => return other.clone(),
    };
    match u32::try_from(value) {
        Ok(value) => Literal::Dword(value),
        Err(_) => literal.clone(),
    }
}
