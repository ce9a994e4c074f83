//! Boolean expressions as statements.

use plcc_syntax::ast::Operand;
use plcc_syntax::network::ast::{Graph, NetId, PinValue, Source};
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::plan::Plan;

/// A Boolean expression over operands.
#[derive(Clone, Debug)]
pub enum Logic {
    Constant(bool),
    Operand(Operand),
    Not(Box<Logic>),
    And(Vec<Logic>),
    Or(Vec<Logic>),
    Xor(Vec<Logic>),
    /// Two values that are loaded, and how they are compared.
    Compare {
        loads: Vec<(StlInsn, Option<Operand>)>,
        insn: StlInsn,
    },
    /// The edge of an expression, with the bit that remembers it.
    Edge {
        of: Box<Logic>,
        bit: Operand,
        rising: bool,
    },
    /// What the RLO is.
    Rlo,
}

impl Logic {
    pub fn not(self) -> Logic {
        match self {
            Logic::Constant(value) => Logic::Constant(!value),
            Logic::Not(inner) => *inner,
            other => Logic::Not(Box::new(other)),
        }
    }

    pub fn and(list: Vec<Logic>) -> Logic {
        let mut flat = Vec::new();
        for one in list {
            match one {
                Logic::Constant(true) => {}
                Logic::And(inner) => flat.extend(inner),
                other => flat.push(other),
            }
        }
        let never = flat.iter().any(|one| matches!(one, Logic::Constant(false)));
        match flat.len() {
            // Edges are taken whatever the rest is.
            _ if never && !flat.iter().any(Logic::has_effect) => Logic::Constant(false),
            0 => Logic::Constant(true),
            1 => flat.remove(0),
            _ => Logic::And(flat),
        }
    }

    pub fn or(list: Vec<Logic>) -> Logic {
        let mut flat = Vec::new();
        for one in list {
            match one {
                Logic::Constant(false) => {}
                Logic::Or(inner) => flat.extend(inner),
                other => flat.push(other),
            }
        }
        let always = flat.iter().any(|one| matches!(one, Logic::Constant(true)));
        match flat.len() {
            _ if always && !flat.iter().any(Logic::has_effect) => Logic::Constant(true),
            0 => Logic::Constant(false),
            1 => flat.remove(0),
            _ => Logic::Or(flat),
        }
    }

    pub fn xor(list: Vec<Logic>) -> Logic {
        let mut rest: Vec<Logic> = Vec::new();
        let mut inverted = false;
        for one in list {
            match one {
                Logic::Constant(value) => inverted ^= value,
                other => rest.push(other),
            }
        }
        let value = match rest.len() {
            0 => Logic::Constant(false),
            1 => rest.remove(0),
            _ => Logic::Xor(rest),
        };
        if inverted { value.not() } else { value }
    }

    fn has_effect(&self) -> bool {
        match self {
            Logic::Constant(_) | Logic::Operand(_) | Logic::Compare { .. } => false,
            Logic::Not(inner) => inner.has_effect(),
            Logic::And(list) | Logic::Or(list) | Logic::Xor(list) => list.iter().any(Logic::has_effect),
            Logic::Edge { .. } | Logic::Rlo => true,
        }
    }

    /// Whether the expression reads the operand, or something that may be the same.
    pub fn reads(&self, operand: &Operand) -> bool {
        match self {
            Logic::Constant(_) | Logic::Rlo => false,
            Logic::Operand(own) => plain(own) == plain(operand),
            Logic::Not(inner) => inner.reads(operand),
            Logic::And(list) | Logic::Or(list) | Logic::Xor(list) => list.iter().any(|one| one.reads(operand)),
            // A word may contain the bit.
            Logic::Compare { .. } | Logic::Edge { .. } => true,
        }
    }
}

/// An operand without its place in the source.
fn plain(operand: &Operand) -> String {
    let mut writer = crate::writer::Writer::new(
        crate::writer::Notation::Stl,
        plcc_syntax::stl::Mnemonics::En,
        crate::trivia::Trivia::none(),
        None,
    );
    crate::operand::operand(operand, &mut writer).to_lowercase()
}

/// How an expression is combined with what is before it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Join {
    And,
    Or,
    Xor,
}

/// The CPU has no more levels of parentheses.
const NESTING_MAX: usize = 7;

impl Maker<'_> {
    /// Statements after which the RLO is the value.
    pub fn evaluate(&mut self, value: &Logic) {
        self.value(value, 0);
    }

    fn value(&mut self, value: &Logic, depth: usize) {
        match value {
            Logic::Constant(true) => self.push(StlInsn::SetRlo, None),
            Logic::Constant(false) => self.push(StlInsn::ClearRlo, None),
            Logic::Operand(_) => self.joined(value, Join::And, depth),
            Logic::Not(inner) if matches!(**inner, Logic::Operand(_)) => self.joined(value, Join::And, depth),
            Logic::Not(inner) => {
                self.value(inner, depth);
                self.push(StlInsn::Not, None);
            }
            Logic::And(list) => list.iter().for_each(|one| self.joined(one, Join::And, depth)),
            Logic::Or(list) => {
                for (at, one) in list.iter().enumerate() {
                    match one {
                        // AND before OR: `O` alone, then the series.
                        Logic::And(series) => {
                            if at > 0 {
                                self.push(StlInsn::Or, None);
                            }
                            series.iter().for_each(|one| self.joined(one, Join::And, depth));
                        }
                        one => self.joined(one, Join::Or, depth),
                    }
                }
            }
            Logic::Xor(list) => list.iter().for_each(|one| self.joined(one, Join::Xor, depth)),
            Logic::Compare { loads, insn } => {
                for (insn, operand) in loads {
                    self.push(*insn, operand.clone());
                }
                self.push(*insn, None);
            }
            Logic::Edge { of, bit, rising } => {
                self.value(of, depth);
                let insn = if *rising { StlInsn::EdgePositive } else { StlInsn::EdgeNegative };
                self.push(insn, Some(bit.clone()));
            }
            Logic::Rlo => {}
        }
    }

    /// An expression after what is before it.
    fn joined(&mut self, value: &Logic, join: Join, depth: usize) {
        use StlInsn::{
            And, AndNest, AndNot, AndNotNest, Or, OrNest, OrNot, OrNotNest, Xor, XorNest, XorNot, XorNotNest,
        };
        let (value, negated) = match value {
            Logic::Not(inner) => (&**inner, true),
            value => (value, false),
        };
        match value {
            Logic::Rlo => {}
            Logic::Operand(operand) => {
                let insn = match (join, negated) {
                    (Join::And, false) => And,
                    (Join::And, true) => AndNot,
                    (Join::Or, false) => Or,
                    (Join::Or, true) => OrNot,
                    (Join::Xor, false) => Xor,
                    (Join::Xor, true) => XorNot,
                };
                self.push(insn, Some(operand.clone()));
            }
            value => {
                let insn = match (join, negated) {
                    (Join::And, false) => AndNest,
                    (Join::And, true) => AndNotNest,
                    (Join::Or, false) => OrNest,
                    (Join::Or, true) => OrNotNest,
                    (Join::Xor, false) => XorNest,
                    (Join::Xor, true) => XorNotNest,
                };
                if depth >= NESTING_MAX {
                    return self.refuse(
                        self.span,
                        format!("more than {NESTING_MAX} levels of branches"),
                        "store a part of the network in a bit of its own",
                    );
                }
                self.push(insn, None);
                self.value(value, depth + 1);
                self.push(StlInsn::CloseNest, None);
            }
        }
    }

    /// The value of a net.
    pub fn net(&mut self, graph: &Graph, plan: &Plan, id: NetId) -> Logic {
        let id = plan.canonical(id);
        if let Some(known) = self.values.get(&id) {
            return known.clone();
        }
        let mut sources = Vec::new();
        for source in &graph.net(id).sources {
            sources.push(match source {
                Source::Rail => Logic::Constant(true),
                Source::Pin { element, pin } => match self.outputs.get(&(*element, *pin)) {
                    Some(value) => value.clone(),
                    None => {
                        // Elsewhere the element that feeds it was refused.
                        if self.messages.is_empty() {
                            self.refuse(graph.net(id).span, "a loop of wires", "store the value in a bit");
                        }
                        Logic::Constant(false)
                    }
                },
                Source::Operand { value, negated } => {
                    let value = self.bit(value);
                    if *negated { value.not() } else { value }
                }
                Source::Net(other) => self.net(graph, plan, *other),
            });
        }
        Logic::or(sources)
    }

    /// The value at an input pin; TRUE if nothing is connected.
    pub fn input(&mut self, graph: &Graph, plan: &Plan, element: usize, name: &str) -> Logic {
        let Some(pin) = graph.elements[element].pin(name) else { return Logic::Constant(true) };
        let value = match &pin.value {
            PinValue::Net(net) => self.net(graph, plan, *net),
            PinValue::Operand(value) => self.bit(value),
            PinValue::Open => return Logic::Constant(true),
        };
        if pin.negated { value.not() } else { value }
    }

    /// Whether something is connected to an input.
    pub fn is_connected(&self, graph: &Graph, element: usize, name: &str) -> bool {
        graph.elements[element].pin(name).is_some_and(|pin| pin.value != PinValue::Open)
    }
}
