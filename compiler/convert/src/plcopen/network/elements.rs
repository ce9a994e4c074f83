//! Contacts, coils, gates, edges, flip-flops, comparisons and jumps.

use plcc_syntax::network::ast::{Element, Pin, PinValue};
use plcc_syntax::network::elements::{Gate, Kind as RowKind, ReturnValue, Row};
use plcc_syntax::scl::ast::{Expr, ExprKind};

use super::{Build, origin};
use crate::plcopen::identifier::identifier;
use crate::plcopen::objects::{Input, Kind, Object, Origin, Output, Storage};

impl Build<'_, '_, '_, '_, '_> {
    pub(super) fn of_row(&mut self, at: usize, element: &Element, row: &'static Row, instance: Option<&Expr>) {
        let span = element.span;
        let (enter, leave) = row.flow;
        match row.kind {
            RowKind::Contact => {
                let from = self.flow(element.pin(enter));
                let Some((text, negated, _)) = self.operand(element, "operand") else { return };
                let out = match self.is_ladder {
                    true => self.contact(text, negated, from),
                    false => {
                        let value = self.in_variable(text, false);
                        self.gate("AND", vec![(from, false), (value, negated)])
                    }
                };
                self.set(at, leave, out);
            }
            RowKind::Not => {
                let from = self.flow(element.pin(enter));
                let out = self.inverted(from);
                self.set(at, leave, out);
            }
            RowKind::Gate(gate) => {
                let name = match gate {
                    Gate::And => "AND",
                    Gate::Or => "OR",
                    Gate::Xor => "XOR",
                };
                let pins: Vec<&Pin> = element.pins.iter().filter(|pin| !pin.output).collect();
                let mut inputs = Vec::new();
                for pin in pins {
                    let from = self.value(Some(pin));
                    if from.is_empty() {
                        return self.refuse(span, "a gate with an input that nothing is connected to");
                    }
                    inputs.push((from, pin.negated));
                }
                let out = match inputs.len() {
                    1 => {
                        let (from, negated) = inputs.remove(0);
                        if negated { self.inverted(from) } else { from }
                    }
                    _ => self.gate(name, inputs),
                };
                self.set(at, "out", out);
            }
            RowKind::Coil | RowKind::SetCoil | RowKind::ResetCoil => {
                let storage = match row.kind {
                    RowKind::SetCoil => Storage::Set,
                    RowKind::ResetCoil => Storage::Reset,
                    _ => Storage::None,
                };
                let from = self.flow(element.pin(enter));
                let Some((text, negated, _)) = self.operand(element, "operand") else { return };
                let out = self.coil(text, negated, storage, from);
                self.set(at, leave, out);
            }
            RowKind::EdgeContact { rising } => self.edge_contact(at, element, rising),
            RowKind::EdgeTrigger { rising } => {
                let from = self.flow(element.pin(enter));
                let Some((bit, _, value)) = self.operand(element, "bit") else { return };
                if self.body.is_private(&value) {
                    let name = if rising { "R_TRIG" } else { "F_TRIG" };
                    self.body.retyped.insert(bit.to_lowercase(), Some(name));
                    let inputs = vec![Input { formal: "CLK".to_string(), from, ..Input::default() }];
                    let outputs = vec![Output { formal: "Q".to_string(), negated: false }];
                    let block = Object { instance: Some(bit), inputs, outputs, ..Object::new(Kind::Block, name) };
                    let block = self.add(block);
                    return self.set(at, leave, vec![origin(block, "Q")]);
                }
                let out = self.edge(rising, from, bit);
                self.set(at, leave, out);
            }
            RowKind::EdgeCoil { rising } => {
                let from = self.flow(element.pin(enter));
                let (Some((text, ..)), Some((bit, ..))) =
                    (self.operand(element, "operand"), self.operand(element, "bit"))
                else {
                    return;
                };
                let pulse = self.edge(rising, from.clone(), bit);
                self.coil(text, false, Storage::None, pulse);
                self.set(at, leave, from);
            }
            RowKind::FlipFlop { set_wins } => self.flip_flop(at, element, set_wins),
            RowKind::Compare(sign) => {
                let name = match sign {
                    "=" => "EQ",
                    "<>" => "NE",
                    ">=" => "GE",
                    "<=" => "LE",
                    ">" => "GT",
                    _ => "LT",
                };
                self.check_types(element, &["in1", "in2"]);
                let before = element.pin(enter).map(|pin| self.flow(Some(pin)));
                let (left, right) = (self.value(element.pin("in1")), self.value(element.pin("in2")));
                let out = self.gate(name, vec![(left, false), (right, false)]);
                let out = match before.filter(|from| !self.is_rail(from)) {
                    Some(from) => self.gate("AND", vec![(from, false), (out, false)]),
                    None => out,
                };
                self.set(at, "out", out);
            }
            RowKind::Instance(_) | RowKind::TimerCoil(_) => self.instance(at, element, row, instance),
            RowKind::Operator(_)
            | RowKind::Function(_)
            | RowKind::Move
            | RowKind::Convert
            | RowKind::Round(_)
            | RowKind::Negate
            | RowKind::Invert
            | RowKind::Step { .. }
            | RowKind::Mux => self.function(at, element, row),
            RowKind::Jump { negated } => {
                let label = match element.pin("label").map(|pin| &pin.value) {
                    Some(PinValue::Operand(Expr { kind: ExprKind::Name(name), .. })) => identifier(&name.text),
                    _ => return self.refuse(span, "a jump without a label"),
                };
                let mut from = self.flow(element.pin("in"));
                if negated {
                    from = self.inverted(from);
                }
                self.add(Object { inputs: vec![Input { from, ..Input::default() }], ..Object::new(Kind::Jump, label) });
            }
            RowKind::Return(ReturnValue::Operand | ReturnValue::True) if element.pin("operand").is_none() => {
                let from = self.flow(element.pin("in"));
                self.add(Object { inputs: vec![Input { from, ..Input::default() }], ..Object::new(Kind::Return, "") });
            }
            _ => {
                let title = format!("LD and FBD of PLCopen XML have no element for `{}`", row.name);
                self.refuse(span, title);
            }
        }
    }

    /// A value of FBD as the output of a gate, which is computed in its turn.
    fn held(&mut self, from: Vec<Origin>, negated: bool) -> Vec<Origin> {
        let always = self.in_variable("TRUE".to_string(), false);
        self.gate("AND", vec![(from, negated), (always, false)])
    }

    /// A contact with an edge: with a bit that nothing else uses, the edge of the notation.
    fn edge_contact(&mut self, at: usize, element: &Element, rising: bool) {
        let before = self.flow(element.pin("pre"));
        let (Some((text, negated, _)), Some((bit, _, value))) =
            (self.operand(element, "operand"), self.operand(element, "bit"))
        else {
            return;
        };
        if !self.is_ladder {
            let value = self.in_variable(text, false);
            let signal = self.held(value, negated);
            let old = self.in_variable(bit.clone(), false);
            let mut inputs = vec![(signal.clone(), !rising), (old, rising)];
            if !self.is_rail(&before) {
                inputs.push((before, false));
            }
            let out = self.gate("AND", inputs);
            self.coil(bit, false, Storage::None, signal);
            return self.set(at, "out", out);
        }
        if !negated && self.body.is_private(&value) {
            self.body.retyped.insert(bit.to_lowercase(), None);
            let out = self.contact(text, false, before);
            if let [Origin { object, .. }] = out.as_slice() {
                self.objects[*object].edge = if rising { "rising" } else { "falling" };
            }
            return self.set(at, "out", out);
        }
        let now = self.contact(text.clone(), negated ^ !rising, before);
        let out = self.contact(bit.clone(), rising, now);
        let rail = self.rail();
        let signal = self.contact(text, negated, rail);
        self.coil(bit, false, Storage::None, signal);
        self.set(at, "out", out);
    }

    /// 1 if the signal has changed since the bit was written, which then gets the signal.
    fn edge(&mut self, rising: bool, signal: Vec<Origin>, bit: String) -> Vec<Origin> {
        let out = match self.is_ladder {
            true => {
                let now = match (rising, self.is_rail(&signal)) {
                    (true, _) => signal.clone(),
                    // The power rail never falls, and NOT cannot be the first element of a rung.
                    (false, true) => self.contact(bit.clone(), true, signal.clone()),
                    (false, false) => self.inverted(signal.clone()),
                };
                self.contact(bit.clone(), rising, now)
            }
            false => {
                let old = self.in_variable(bit.clone(), false);
                self.gate("AND", vec![(signal.clone(), !rising), (old, rising)])
            }
        };
        self.coil(bit, false, Storage::None, signal);
        out
    }

    /// The one that wins comes last.
    fn flip_flop(&mut self, at: usize, element: &Element, set_wins: bool) {
        let Some((text, ..)) = self.operand(element, "operand") else { return };
        let names = if set_wins {
            [("r", Storage::Reset), ("s1", Storage::Set)]
        } else {
            [("s", Storage::Set), ("r1", Storage::Reset)]
        };
        let mut inputs = Vec::new();
        for (name, storage) in names {
            if let Some(pin) = element.pin(name).filter(|pin| !matches!(pin.value, PinValue::Open)) {
                let mut from = self.flow(Some(pin));
                // Both are read before one of them is written.
                if !self.is_ladder {
                    from = self.held(from, false);
                }
                inputs.push((from, storage));
            }
        }
        for (from, storage) in inputs {
            self.coil(text.clone(), false, storage, from);
        }
        let is_read = element.pins.iter().any(|pin| pin.output && matches!(pin.value, PinValue::Net(_)));
        for pin in element.pins.iter().filter(|pin| pin.output && pin.name != "operand") {
            if let PinValue::Operand(target) = &pin.value {
                let target = self.body.text(target);
                let value = match self.is_ladder {
                    true => {
                        let rail = self.rail();
                        self.contact(text.clone(), pin.negated, rail)
                    }
                    false => {
                        let value = self.in_variable(text.clone(), false);
                        self.held(value, pin.negated)
                    }
                };
                self.coil(target, false, Storage::None, value);
            }
        }
        if is_read {
            let out = match self.is_ladder {
                true => {
                    let rail = self.rail();
                    self.contact(text, false, rail)
                }
                false => {
                    let value = self.in_variable(text, false);
                    self.held(value, false)
                }
            };
            self.set(at, "q", out);
        }
    }
}
