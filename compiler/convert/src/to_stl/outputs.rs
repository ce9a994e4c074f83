//! Values of elements: in variables, in the RLO, or at the operands of outputs.

use plcc_syntax::Elementary;
use plcc_syntax::ast::{Operand, OperandKind, PathRoot};
use plcc_syntax::network::ast::{Graph, NetId, Pin, PinValue, Storage};
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::logic::Logic;
use super::plan::Plan;

impl Maker<'_> {
    /// A value in a variable of its own.
    pub fn stored(&mut self, value: &Logic) -> Logic {
        self.evaluate(value);
        let bit = self.temporary(Elementary::Bool);
        self.push(StlInsn::Assign, Some(bit.clone()));
        Logic::Operand(bit)
    }

    /// The value of a net with several users, in a variable unless it has one or is constant.
    pub fn keep(&mut self, graph: &Graph, plan: &Plan, net: NetId) {
        let value = self.net(graph, plan, net);
        let net = plan.canonical(net);
        let value = match value {
            Logic::Constant(_) => value,
            value if self.is_temporary(&value) => value,
            value => {
                let value = self.stored(&value);
                // The RLO still has it.
                self.rlo = Some(net);
                value
            }
        };
        self.values.insert(net, value);
    }

    fn is_temporary(&self, value: &Logic) -> bool {
        let Logic::Operand(Operand { kind: OperandKind::Path(path), .. }) = value else { return false };
        match &path.root {
            PathRoot::Local { name, .. } => self.temporaries.iter().any(|(known, _)| known == name),
            _ => false,
        }
    }

    /// The flow of a coil, in a variable if something after the coil needs it.
    pub fn passed(&mut self, graph: &Graph, plan: &Plan, at: usize, flow: Logic) -> Logic {
        let element = &graph.elements[at];
        let pins: Vec<usize> = (0..element.pins.len())
            .filter(|pin| element.pins[*pin].output && element.pins[*pin].name == "out")
            .filter(|pin| match element.pins[*pin].value {
                PinValue::Net(net) => plan.canonical(net) == net && plan.is_used(net),
                PinValue::Operand(_) | PinValue::Open => false,
            })
            .collect();
        if pins.is_empty() || matches!(flow, Logic::Constant(_)) {
            pins.into_iter().for_each(|pin| drop(self.outputs.insert((at, pin), flow.clone())));
            return flow;
        }
        let flow = self.stored(&flow);
        pins.into_iter().for_each(|pin| drop(self.outputs.insert((at, pin), flow.clone())));
        flow
    }

    /// The RLO is the value of an output.
    pub fn result(&mut self, graph: &Graph, plan: &Plan, at: usize, name: &str) {
        let element = &graph.elements[at];
        let named = |pin: &Pin| pin.output && pin.name.eq_ignore_ascii_case(name);
        let pins: Vec<usize> = (0..element.pins.len()).filter(|pin| named(&element.pins[*pin])).collect();
        let is_net = |pin: &usize| matches!(element.pins[*pin].value, PinValue::Net(net) if plan.is_used(net));
        if pins.len() == 1 && pins.iter().all(is_net) && !element.pins[pins[0]].negated && plan.continues(graph, at) {
            self.outputs.insert((at, pins[0]), Logic::Rlo);
            return;
        }
        let mut kept = None;
        for pin in pins {
            let (value, negated) = (&element.pins[pin].value, element.pins[pin].negated);
            match value {
                PinValue::Operand(operand) => {
                    let Some(operand) = self.operand(operand) else { continue };
                    let insn = match element.pins[pin].storage {
                        Storage::None => StlInsn::Assign,
                        Storage::Set => StlInsn::Set,
                        Storage::Reset => StlInsn::Reset,
                    };
                    if negated {
                        self.push(StlInsn::Not, None);
                    }
                    self.push(insn, Some(operand));
                    if negated {
                        self.push(StlInsn::Not, None);
                    }
                    kept.get_or_insert(None);
                }
                PinValue::Net(net) if plan.is_used(*net) => {
                    let bit = match &kept {
                        Some(Some(bit)) => Operand::clone(bit),
                        _ => self.temporary(Elementary::Bool),
                    };
                    self.push(StlInsn::Assign, Some(bit.clone()));
                    let value = Logic::Operand(bit.clone());
                    self.outputs.insert((at, pin), if negated { value.not() } else { value });
                    kept = Some(Some(bit));
                }
                PinValue::Net(_) | PinValue::Open => {}
            }
        }
        if kept.is_none() {
            // The next scan must not be combined with this one.
            let bit = self.temporary(Elementary::Bool);
            self.push(StlInsn::Assign, Some(bit));
        }
    }

    /// Whether anything is connected to an output.
    pub fn is_wanted(&self, graph: &Graph, plan: &Plan, at: usize, name: &str) -> bool {
        graph.elements[at].pins.iter().any(|pin| {
            pin.output
                && pin.name.eq_ignore_ascii_case(name)
                && match pin.value {
                    PinValue::Net(net) => plan.is_used(net),
                    PinValue::Operand(_) => true,
                    PinValue::Open => false,
                }
        })
    }
}
