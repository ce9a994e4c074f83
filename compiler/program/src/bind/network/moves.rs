//! MOVE, MUX, DEMUX. Source: LAD/FBD reference C.10, C.13.

use plcc_syntax::network::ast::{Pin, PinValue, Storage, TemplateKey};
use plcc_syntax::{Class, Elementary};

use super::pins::{connected, no, outputs};
use super::sheet::Sheet;
use crate::bind::network::NetworkBinder;
use crate::bind::scl::convert::{converted, explicit_expr};
use crate::bind::scl::numeric::Shape;
use crate::bind::scl::value::Value;
use crate::bind::scl::{Intent, SclBlock};
use plcc_model::scl::{Arm, Conversion, Expr, Statement, StatementKind};

impl NetworkBinder<'_, '_> {
    /// MOVE: the value to each output, in the output's width.
    pub fn move_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        self.boxed(ctx, sheet, at, |binder, ctx, sheet| {
            let value = binder.input(ctx, sheet, at, "in")?;
            let value = match value {
                Value::Elementary(expr) => Value::Elementary(sheet.keep(ctx, expr)),
                value => value,
            };
            // A relay that is off moves 0.
            let value = match (sheet.registers().relay(span), value) {
                (Some(on), Value::Elementary(expr)) => Value::Elementary(binder.relayed_value(ctx, sheet, expr, on)),
                (Some(on), value @ Value::Constant(..)) => match binder.output_type(ctx, element, "out1") {
                    Some(ty) => {
                        let expr = binder.scl().convert(ctx, value, ty)?;
                        Value::Elementary(binder.relayed_value(ctx, sheet, expr, on))
                    }
                    None => value,
                },
                (_, value) => value,
            };
            let mut good = Some(());
            for place in (0..element.pins.len()).map(|pin| (at, pin)) {
                let pin = &element.pins[place.1];
                if pin.output && pin.name != "eno" {
                    good = binder.moved(ctx, sheet, place, value.clone()).and(good);
                }
            }
            good
        })
    }

    /// Writes the value to one of the outputs: `place` is the element and its pin.
    fn moved(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, place: (usize, usize), value: Value) -> Option<()> {
        let pin = &sheet.element(place.0).pins[place.1];
        let is_plain = !pin.negated && pin.storage == Storage::None;
        let (Value::Elementary(expr), PinValue::Operand(node), true) = (&value, &pin.value, is_plain) else {
            return self.output_pin(ctx, sheet, place, pin, value);
        };
        let access = self.scl().access(ctx, node, Intent::Write)?;
        let fitted = match access.elementary() {
            Some(to) => moved_value(expr.clone(), to).map(Value::Elementary),
            None => None,
        };
        let kind = self.scl().assignment(ctx, access, fitted.unwrap_or(value))?;
        sheet.push(kind, node.span);
        Some(())
    }

    /// MUX. If no input has number K: ELSE, or nothing is written; ENO is 0.
    pub fn mux_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        self.boxed(ctx, sheet, at, |binder, ctx, sheet| {
            let selector = binder.input(ctx, sheet, at, "k")?;
            let selector = binder.scl().own_type(ctx, selector)?;
            let selector = sheet.keep(ctx, selector);
            let ty = binder.template_type(element, &[TemplateKey::Source, TemplateKey::Value]);
            let mut inputs: Vec<(u32, Value)> = Vec::new();
            for pin in element.pins.iter().filter(|pin| !pin.output && pin.value != PinValue::Open) {
                let Some(number) = pin.name.strip_prefix("in").and_then(|digits| digits.parse().ok()) else { continue };
                let value = binder.pin_value(ctx, sheet, pin)?;
                inputs.push((number, value));
            }
            inputs.sort_by_key(|(number, _)| *number);
            let otherwise = match connected(element, "else") {
                Some(pin) => Some(binder.pin_value(ctx, sheet, pin)?),
                None => None,
            };
            let ty = match ty {
                Some(ty) => Some(ty),
                None => {
                    let values: Vec<&Value> = inputs.iter().map(|(_, value)| value).chain(&otherwise).collect();
                    // Texts and structures go to the output unchanged.
                    let elementary = values.iter().all(|value| {
                        let shape = Shape::of(value);
                        !matches!(value, Value::Complex { .. }) && !matches!(shape, Shape::Letter | Shape::Other)
                    });
                    if elementary { Some(binder.common_type(ctx, &values, span)?) } else { None }
                }
            };
            let mut arms = Vec::new();
            for (number, value) in inputs {
                let body = binder.selected(ctx, sheet, at, value, ty)?;
                arms.push(Arm { ranges: vec![(i128::from(number), i128::from(number))], body });
            }
            let mut rest = match otherwise {
                Some(value) => binder.selected(ctx, sheet, at, value, ty)?,
                None => Vec::new(),
            };
            rest.push(Statement { kind: StatementKind::SetFlag(no(span)), span });
            sheet.push(StatementKind::Case { selector, arms, otherwise: rest }, span);
            Some(())
        })
    }

    /// The statements that write one input of MUX to the output.
    fn selected(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        at: usize,
        value: Value,
        ty: Option<Elementary>,
    ) -> Option<Vec<Statement>> {
        let value = match ty {
            Some(ty) => Value::Elementary(self.scl().convert(ctx, value, ty)?),
            None => value,
        };
        let outer = std::mem::take(&mut sheet.statements);
        let outs: Vec<(usize, &Pin)> = outputs(sheet.element(at), "out").collect();
        let value = match value {
            Value::Elementary(expr) if outs.len() > 1 => Value::Elementary(sheet.keep(ctx, expr)),
            value => value,
        };
        let mut sent = Some(());
        for (index, pin) in outs {
            let place = (at, index);
            // All branches write one variable of a net.
            let net = sheet.outputs.get(&place).cloned();
            let one = match (net, value.clone()) {
                (Some(Expr { kind: plcc_model::scl::ExprKind::Load(access), .. }), Value::Elementary(value)) => {
                    let span = value.span;
                    sheet.push(StatementKind::Assign { target: *access, value }, span);
                    Some(())
                }
                (_, value) => self.output_pin(ctx, sheet, place, pin, value),
            };
            sent = one.and(sent);
        }
        let body = std::mem::replace(&mut sheet.statements, outer);
        sent.map(|()| body)
    }

    /// DEMUX: the output with number K gets the input, the others stay.
    pub fn demux_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        self.boxed(ctx, sheet, at, |binder, ctx, sheet| {
            let selector = binder.input(ctx, sheet, at, "k")?;
            let selector = binder.scl().own_type(ctx, selector)?;
            let selector = sheet.keep(ctx, selector);
            let value = binder.input(ctx, sheet, at, "in")?;
            let value = match (value, binder.template_type(element, &[TemplateKey::Source, TemplateKey::Value])) {
                (value, Some(ty)) => {
                    let value = binder.scl().convert(ctx, value, ty)?;
                    Value::Elementary(sheet.keep(ctx, value))
                }
                (Value::Elementary(value), None) => Value::Elementary(sheet.keep(ctx, value)),
                (value, None) => value,
            };
            let mut arms = Vec::new();
            let mut rest = Vec::new();
            for pin in element.pins.iter().filter(|pin| pin.output && pin.name != "eno") {
                let outer = std::mem::take(&mut sheet.statements);
                let sent = binder.output(ctx, sheet, at, &pin.name, value.clone());
                let body = std::mem::replace(&mut sheet.statements, outer);
                sent?;
                match pin.name.strip_prefix("out").and_then(|digits| digits.parse::<i128>().ok()) {
                    Some(number) => arms.push(Arm { ranges: vec![(number, number)], body }),
                    None => rest = body,
                }
            }
            rest.push(Statement { kind: StatementKind::SetFlag(no(span)), span });
            sheet.push(StatementKind::Case { selector, arms, otherwise: rest }, span);
            Some(())
        })
    }
}

/// A value as MOVE writes it into another type: a narrower one gets the low bytes, a wider one gets zeros or, from a signed integer to a
/// signed one, the sign. None if the types must be the same or have a separate conversion.
fn moved_value(value: Expr, to: Elementary) -> Option<Expr> {
    let from = value.ty;
    let plain = |ty: Elementary| {
        ty != Elementary::Bool && matches!(ty.class(), Class::Bits | Class::Signed | Class::Unsigned | Class::Character)
    };
    if from == to {
        return Some(value);
    }
    // Dates and durations are the integers of their widths; floating-point numbers the bit strings of theirs.
    let same_width = from.bits() == to.bits() && (from.class() == Class::Bits || to.class() == Class::Bits);
    let integers = plain(from) && plain(to);
    if !integers && !same_width {
        return None;
    }
    // Sign extension is for signed targets only.
    if integers && from.class() == Class::Signed && to.class() != Class::Signed && to.bits() > from.bits() {
        let own = unsigned(from)?;
        let bits = converted(value, Conversion::Bits { checked: false }, own);
        return explicit_expr(crate::bind::scl::Rules::Tia1500, bits, to);
    }
    Some(converted(value, Conversion::Bits { checked: false }, to))
}

/// The bit string with the width of a type.
fn unsigned(ty: Elementary) -> Option<Elementary> {
    Some(match ty.bits() {
        8 => Elementary::Byte,
        16 => Elementary::Word,
        32 => Elementary::Dword,
        64 => Elementary::Lword,
        _ => return None,
    })
}
