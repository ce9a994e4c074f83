//! MOVE: of values in the widths of their targets, and of whole structures, arrays and texts. Source: LAD/FBD reference C.10.

use plcc_syntax::ast::{
    self, BlockName, BlockPrefix, Operand, OperandKind, Parameter, StatementKind, TypeKind, TypeRef,
};
use plcc_syntax::literal::Literal;
use plcc_syntax::network::ast::{Element, Graph, Pin, PinValue, Storage};
use plcc_syntax::stl::StlInsn;
use plcc_syntax::{Class, Elementary};

use super::Maker;
use super::boxes::Check;
use super::compare::SIGN;
use super::plan::Plan;
use super::values::{loadable, width_of};

/// BLKMOV.
const BLOCK_MOVE: u32 = 20;
/// The last TIME_OF_DAY.
const LAST_MILLISECOND: u32 = 86_399_999;
/// The last DATE, in days since 1990.
const LAST_DAY: u32 = 65_378;

impl Maker<'_> {
    pub fn move_box(&mut self, graph: &Graph, plan: &Plan, at: usize) {
        let element = &graph.elements[at];
        let is_target = |pin: &&Pin| pin.output && pin.name.starts_with("out") && pin.value != PinValue::Open;
        let targets: Vec<&Pin> = element.pins.iter().filter(is_target).collect();
        let given = element.pin("in").map(|pin| &pin.value);
        if let Some(calls) = self.whole_moves(element, &targets) {
            self.sets_br = true;
            return self.boxed(graph, plan, at, Check::Br, |maker| {
                calls.into_iter().for_each(|call| maker.push_kind(StatementKind::Call(Box::new(call))));
            });
        }
        let own = given.and_then(|value| self.type_of(value));
        let of_targets: Vec<Option<Elementary>> = targets.iter().map(|pin| self.type_of(&pin.value)).collect();
        // A constant has the type of its target, an address that of its width.
        let known = own.or_else(|| of_targets.iter().flatten().next().copied());
        let known = known.or_else(|| given.into_iter().chain(targets.iter().map(|pin| &pin.value)).find_map(width_of));
        let Some(first) = known else { return self.unknown_type(element) };
        let all_bits = own.iter().chain(of_targets.iter().flatten()).all(|ty| *ty == Elementary::Bool);
        if first == Elementary::Bool && all_bits {
            return self.move_bit(graph, plan, at, &targets);
        }
        let mut moves = Vec::new();
        let mut limits = Vec::new();
        for (pin, of_target) in targets.iter().zip(&of_targets) {
            if moves.iter().any(|(_, name, _): &(_, String, _)| *name == pin.name) {
                continue;
            }
            let to = of_target.or_else(|| width_of(&pin.value)).unwrap_or(first);
            let from = own.unwrap_or(if of_target.is_some() || width_of(&pin.value).is_some() { to } else { first });
            if [from, to].iter().any(|ty| *ty == Elementary::Bool || ty.bits() > 32) {
                let help = "move a byte, word or double word";
                return self.refuse(element.span, format!("a MOVE of {}", to.name()), help);
            }
            let Some((operand, found)) = self.source(graph, at, "in", from) else { return };
            let operand = loadable(operand);
            limits.extend(greatest(found, to).map(|limit| (operand.clone(), limit)));
            let mut load = vec![(StlInsn::Load, Some(operand))];
            let Some(extension) = self.extension(found, to, pin) else { return };
            load.extend(extension);
            moves.push((load, pin.name.clone(), to));
        }
        let watches = !limits.is_empty() && self.saves_eno(graph, plan, at);
        let bit = watches.then(|| self.temporary(Elementary::Bool));
        let check = bit.clone().map_or(Check::Never, Check::Bit);
        self.boxed(graph, plan, at, check, |maker| {
            if let Some(bit) = &bit {
                maker.note_above(&limits, bit);
            }
            let mut loaded = None;
            for (load, name, to) in moves {
                if loaded.as_ref() != Some(&load) {
                    load.iter().for_each(|(insn, operand)| maker.push(*insn, operand.clone()));
                    loaded = Some(load);
                }
                maker.store_pin(graph, plan, at, &name, to);
            }
        });
    }

    /// A BOOL to variables.
    fn move_bit(&mut self, graph: &Graph, plan: &Plan, at: usize, targets: &[&Pin]) {
        let mut operands = Vec::new();
        for pin in targets {
            match &pin.value {
                PinValue::Operand(target) if !pin.negated && pin.storage == Storage::None => {
                    let Some(operand) = self.operand(target) else { return };
                    operands.push(operand);
                }
                PinValue::Net(net) if !plan.is_used(*net) => {}
                PinValue::Operand(_) | PinValue::Net(_) | PinValue::Open => {
                    return self.refuse(pin.span, "a MOVE of BOOL to a wire", "connect a variable");
                }
            }
        }
        let value = self.input(graph, plan, at, "in");
        self.boxed(graph, plan, at, Check::Never, |maker| {
            maker.evaluate(&value);
            operands.into_iter().for_each(|operand| maker.push(StlInsn::Assign, Some(operand)));
        });
    }

    /// A bit becomes 1 if one of the values is above its limit, both unsigned.
    fn note_above(&mut self, limits: &[(Operand, u32)], bit: &Operand) {
        for (number, (operand, limit)) in limits.iter().enumerate() {
            let (sign, limit) = (self.bits(SIGN), self.bits(limit ^ SIGN));
            self.push(StlInsn::Load, Some(operand.clone()));
            self.push(StlInsn::XorD, Some(sign));
            self.push(StlInsn::Load, Some(limit));
            self.push(StlInsn::CompareGtD, None);
            if number > 0 {
                self.push(StlInsn::Or, Some(bit.clone()));
            }
            self.push(StlInsn::Assign, Some(bit.clone()));
        }
    }

    /// Instructions that make a loaded value one of another type: a narrower type gets the low bytes, a wider one zeros, or the sign
    /// from a signed integer to another.
    fn extension(&mut self, from: Elementary, to: Elementary, pin: &Pin) -> Option<Vec<(StlInsn, Option<Operand>)>> {
        use Elementary::{Dint, Int, Sint};
        let is_plain =
            |ty: Elementary| matches!(ty.class(), Class::Bits | Class::Signed | Class::Unsigned | Class::Character);
        let is_bits = |ty: Elementary| ty.class() == Class::Bits;
        let span = self.span;
        let eight = || Some(super::number(8, span));
        let of_byte = || vec![(StlInsn::ShiftLeftW, eight()), (StlInsn::ShiftSignedI, eight())];
        Some(match (from, to) {
            (Sint, Int) => of_byte(),
            (Sint, Dint) => {
                let mut whole = of_byte();
                whole.push((StlInsn::IToD, None));
                whole
            }
            (Int, Dint) => vec![(StlInsn::IToD, None)],
            _ if is_plain(from) && is_plain(to) => Vec::new(),
            _ if from.bits() == to.bits() && (is_bits(from) || is_bits(to)) => Vec::new(),
            _ => self.conversion(from, to, pin.span)?.iter().map(|insn| (*insn, None)).collect(),
        })
    }

    /// The calls that move whole variables; none: the values are elementary, or their types are not known.
    fn whole_moves(&mut self, element: &Element, targets: &[&Pin]) -> Option<Vec<ast::Call>> {
        let PinValue::Operand(source) = &element.pin("in")?.value else { return None };
        let from = super::operand::operand_of(source)?;
        let mut pairs = Vec::new();
        for pin in targets {
            let PinValue::Operand(target) = &pin.value else { return None };
            pairs.push((super::operand::operand_of(target)?, target));
        }
        let is_text = |ty: &TypeRef| matches!(ty.kind, TypeKind::String(_) | TypeKind::WideString(_));
        let all_texts = pairs.iter().all(|(to, _)| self.types.declared(&to.kind, self.block).is_some_and(is_text));
        let own = self.types.declared(&from.kind, self.block);
        let texts = match (&from.kind, own) {
            (OperandKind::Literal(Literal::Text(_)), _) => all_texts,
            (_, Some(own)) => is_text(own) && all_texts,
            (_, None) => false,
        };
        let types = self.types;
        let is_whole = |ty: &TypeRef| match &ty.kind {
            TypeKind::Named(name) => {
                let own = BlockName::Symbol { name: name.clone(), span: ty.span };
                matches!(name.to_uppercase().as_str(), "DTL" | "DATE_AND_TIME" | "DT") || types.is_type(&own)
            }
            TypeKind::Block(name) => types.is_type(name),
            // BLKMOV copies bytes.
            TypeKind::Array { element, .. } => name_of(element).is_none_or(|name| !name.eq_ignore_ascii_case("BOOL")),
            TypeKind::String(_)
            | TypeKind::WideString(_)
            | TypeKind::OpenArray { .. }
            | TypeKind::Reference(_)
            | TypeKind::Struct(_)
            | TypeKind::Error => false,
        };
        let same = own.filter(|own| is_whole(own)).is_some_and(|own| {
            pairs
                .iter()
                .all(|(to, _)| self.types.declared(&to.kind, self.block).is_some_and(|other| is_same(own, other)))
        });
        if pairs.is_empty() || !(same || (texts && self.types.is_portal)) {
            return None;
        }
        let from = self.operand(source)?;
        let mut calls = Vec::new();
        for (_, target) in pairs {
            let to = self.operand(target)?;
            let call = match texts {
                true => self.call_of("S_MOVE", vec![("IN", from.clone()), ("OUT", to)]),
                false => {
                    let result = self.temporary(Elementary::Int);
                    let block = BlockName::Numbered { prefix: BlockPrefix::Sfc, number: BLOCK_MOVE, span: self.span };
                    let target = Operand { kind: OperandKind::Block(block), span: self.span };
                    let actuals = vec![("SRCBLK", from.clone()), ("RET_VAL", result), ("DSTBLK", to)];
                    ast::Call { target, ..self.call_of("", actuals) }
                }
            };
            calls.push(call);
        }
        Some(calls)
    }

    fn call_of(&self, name: &str, actuals: Vec<(&str, Operand)>) -> ast::Call {
        let parameters = actuals.into_iter().map(|(name, actual)| Parameter {
            name: name.to_string(),
            name_span: self.span,
            actual: Some(actual),
        });
        ast::Call { target: self.name_of(name), types: Vec::new(), instance: None, parameters: parameters.collect() }
    }
}

/// The greatest bit pattern with which ENO of a MOVE between types of one size is 1; none: with all.
fn greatest(from: Elementary, to: Elementary) -> Option<u32> {
    use Elementary::{Date, Dint, Int, Time, TimeOfDay, Udint, Uint};
    match (from, to) {
        (Dint | Udint | Time, TimeOfDay) => Some(LAST_MILLISECOND),
        (Udint, Time) | (Time, Udint) => Some(i32::MAX.cast_unsigned()),
        (Uint, Date) => Some(LAST_DAY),
        (Int, Date) | (Date, Int) => Some(0x7FFF),
        _ => None,
    }
}

/// Two declarations of the same type.
fn is_same(one: &TypeRef, other: &TypeRef) -> bool {
    match (&one.kind, &other.kind) {
        (TypeKind::Array { bounds, element }, TypeKind::Array { bounds: others, element: other }) => {
            let number = |bound: &ast::Bound| match bound {
                ast::Bound::Number(number, _) => Some(*number),
                ast::Bound::Name(..) | ast::Bound::Expr(_) | ast::Bound::Path(_) => None,
            };
            let numbers = |bounds: &[(ast::Bound, ast::Bound)]| -> Option<Vec<(i64, i64)>> {
                bounds.iter().map(|(low, high)| Some((number(low)?, number(high)?))).collect()
            };
            let known = numbers(bounds);
            known.is_some() && known == numbers(others) && is_same(element, other)
        }
        _ => match (name_of(one), name_of(other)) {
            (Some(one), Some(other)) => one.eq_ignore_ascii_case(other),
            _ => false,
        },
    }
}

fn name_of(ty: &TypeRef) -> Option<&str> {
    match &ty.kind {
        TypeKind::Named(name) | TypeKind::Block(BlockName::Symbol { name, .. }) => Some(name),
        _ => None,
    }
}
