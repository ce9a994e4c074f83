//! Signals as elements and nets: contacts in series and parallel, or gates.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::network::ast::{
    Element, Eno, Graph, Language, NetId, Pin, PinValue, Source, Storage, Target, Template, TemplateKey,
};
use plcc_syntax::network::elements::{Row, find_sd};
use plcc_syntax::scl::ast::{Expr, ExprKind, Literal};

/// A Boolean value.
#[derive(Clone, Debug, PartialEq)]
pub enum Signal {
    Constant(bool),
    Operand(Expr),
    Not(Box<Signal>),
    And(Vec<Signal>),
    Or(Vec<Signal>),
    Xor(Vec<Signal>),
    /// A comparison, by the name of its element.
    Compare {
        element: &'static str,
        ty: &'static str,
        left: Expr,
        right: Expr,
        span: Span,
    },
    Edge {
        of: Box<Signal>,
        bit: Expr,
        rising: bool,
        span: Span,
    },
    /// A bit of the status word, by the name of its element.
    Flag {
        element: &'static str,
        span: Span,
    },
    /// An element of both languages in a branch, without its input `pre`.
    Element(Box<Element>),
    /// What an element that is drawn already gives.
    Net(NetId),
}

impl Signal {
    pub fn inverted(self) -> Signal {
        match self {
            Signal::Constant(value) => Signal::Constant(!value),
            Signal::Not(inner) => *inner,
            other => Signal::Not(Box::new(other)),
        }
    }

    pub fn and(list: Vec<Signal>) -> Signal {
        let mut flat = Vec::new();
        for one in list {
            match one {
                Signal::Constant(true) => {}
                Signal::And(inner) => flat.extend(inner),
                other => flat.push(other),
            }
        }
        match flat.len() {
            0 => Signal::Constant(true),
            1 => flat.remove(0),
            _ => Signal::And(flat),
        }
    }

    pub fn or(list: Vec<Signal>) -> Signal {
        let mut flat = Vec::new();
        for one in list {
            match one {
                Signal::Constant(false) => {}
                Signal::Or(inner) => flat.extend(inner),
                other => flat.push(other),
            }
        }
        match flat.len() {
            0 => Signal::Constant(false),
            1 => flat.remove(0),
            _ => Signal::Or(flat),
        }
    }
}

/// An exclusive OR becomes no more contacts than that.
const CONTACTS_MAX: usize = 64;

impl Signal {
    /// The signal and its inverse without exclusive OR: `a XOR b` is `a AND NOT b OR NOT a AND b`. None: it has a part that cannot be
    /// evaluated twice, or becomes too many contacts.
    fn polarities(&self) -> Option<(Signal, Signal)> {
        let each = |list: &[Signal]| -> Option<(Vec<Signal>, Vec<Signal>)> {
            list.iter().map(Signal::polarities).collect::<Option<Vec<_>>>().map(|pairs| pairs.into_iter().unzip())
        };
        match self {
            Signal::Operand(_) | Signal::Compare { .. } | Signal::Flag { .. } | Signal::Element(_) | Signal::Net(_) => {
                Some((self.clone(), self.clone().inverted()))
            }
            Signal::Not(inner) => inner.polarities().map(|(yes, no)| (no, yes)),
            Signal::And(list) => each(list).map(|(yes, no)| (Signal::and(yes), Signal::or(no))),
            Signal::Or(list) => each(list).map(|(yes, no)| (Signal::or(yes), Signal::and(no))),
            Signal::Xor(list) => {
                let (first, rest) = list.split_first()?;
                let (mut yes, mut no) = first.polarities()?;
                for one in rest {
                    let (own, inverse) = one.polarities()?;
                    let either = |a: [&Signal; 2], b: [&Signal; 2]| {
                        Signal::or([a, b].map(|pair| Signal::and(pair.map(Signal::clone).to_vec())).to_vec())
                    };
                    let differs = either([&yes, &inverse], [&no, &own]);
                    no = either([&yes, &own], [&no, &inverse]);
                    yes = differs;
                    if yes.contacts() > CONTACTS_MAX {
                        return None;
                    }
                }
                Some((yes, no))
            }
            Signal::Constant(_) | Signal::Edge { .. } => None,
        }
    }

    /// How many contacts it has.
    fn contacts(&self) -> usize {
        match self {
            Signal::And(list) | Signal::Or(list) | Signal::Xor(list) => list.iter().map(Signal::contacts).sum(),
            Signal::Not(inner) => inner.contacts(),
            Signal::Constant(_)
            | Signal::Operand(_)
            | Signal::Compare { .. }
            | Signal::Edge { .. }
            | Signal::Flag { .. }
            | Signal::Element(_)
            | Signal::Net(_) => 1,
        }
    }
}

/// Why a signal cannot be drawn.
pub type Reason = String;

/// A network that grows.
pub struct Drawing {
    pub graph: Graph,
    language: Language,
    rail: Option<NetId>,
    wires: usize,
    span: Span,
}

impl Drawing {
    pub fn new(language: Language, span: Span) -> Drawing {
        Drawing { graph: Graph::default(), language, rail: None, wires: 0, span }
    }

    /// The place in the source of what is drawn next.
    pub fn at(&mut self, span: Span) {
        self.span = span;
    }

    fn rail(&mut self) -> NetId {
        if let Some(rail) = self.rail {
            return rail;
        }
        let rail = self.graph.add_net("powerrail", self.span);
        self.graph.nets[rail.0 as usize].sources.push(Source::Rail);
        self.rail = Some(rail);
        rail
    }

    /// A net with a name of its own.
    pub fn wire(&mut self) -> NetId {
        self.wires += 1;
        let name = format!("w{}", self.wires);
        self.graph.add_net(&name, self.span)
    }

    /// Whether an element from this number on is connected to the rail.
    pub fn has_rung_since(&self, from: usize) -> bool {
        let rail = self.rail.map(PinValue::Net);
        let mut pins = self.graph.elements.iter().skip(from).flat_map(|element| &element.pins);
        pins.any(|pin| Some(&pin.value) == rail.as_ref())
    }

    /// An input that is connected to a signal.
    pub fn input(&mut self, name: &str, signal: &Signal) -> Result<Option<Pin>, Reason> {
        let (value, negated) = match self.language {
            Language::Fbd => match signal {
                Signal::Constant(true) => return Ok(None),
                signal => self.gates(signal)?,
            },
            Language::Lad | Language::Scl | Language::Stl => {
                let rail = self.rail();
                (PinValue::Net(self.contacts(signal, rail, None)?), false)
            }
        };
        Ok(Some(pin(name, value, negated, false, self.span)))
    }

    /// An input of a box that is not its flow: an operand stays one.
    pub fn side_input(&mut self, name: &str, signal: &Signal) -> Result<Pin, Reason> {
        match signal {
            Signal::Operand(value) => Ok(pin(name, PinValue::Operand(value.clone()), false, false, self.span)),
            Signal::Constant(value) => {
                Ok(pin(name, PinValue::Operand(truth(*value, self.span)), false, false, self.span))
            }
            signal => {
                let span = self.span;
                Ok(self
                    .input(name, signal)?
                    .unwrap_or_else(|| pin(name, PinValue::Operand(truth(true, span)), false, false, span)))
            }
        }
    }

    /// A net with the value that an operand has here.
    pub fn held(&mut self, value: PinValue, negated: bool) -> NetId {
        let span = self.span;
        let pins = vec![
            pin("in1", value, negated, false, span),
            pin("in2", PinValue::Operand(truth(true, span)), false, false, span),
        ];
        let element = self.element("A", pins, None);
        self.output(element, "out", None)
    }

    /// An element of the table; its index.
    pub fn element(&mut self, name: &str, pins: Vec<Pin>, ty: Option<&str>) -> usize {
        let row = row(name);
        let templates =
            ty.map(|value| Template { key: TemplateKey::Source, value: value.to_string(), span: self.span });
        self.graph.elements.push(Element {
            target: Target::Element { row, instance: None },
            templates: templates.into_iter().collect(),
            eno: if row.is_box() { Eno::Disabled } else { Eno::Default },
            pins,
            equation: None,
            cases: Vec::new(),
            span: self.span,
        });
        self.graph.elements.len() - 1
    }

    /// A call, or an element with an instance; its index.
    pub fn called(&mut self, target: Target, pins: Vec<Pin>) -> usize {
        self.graph.elements.push(Element {
            target,
            templates: Vec::new(),
            eno: Eno::Default,
            pins,
            equation: None,
            cases: Vec::new(),
            span: self.span,
        });
        self.graph.elements.len() - 1
    }

    /// Connects an output of an element to a net, or to a new one.
    pub fn output(&mut self, element: usize, name: &str, into: Option<NetId>) -> NetId {
        let net = into.unwrap_or_else(|| self.wire());
        let span = self.span;
        let pins = &mut self.graph.elements[element].pins;
        pins.push(pin(name, PinValue::Net(net), false, true, span));
        let at = pins.len() - 1;
        self.graph.nets[net.0 as usize].sources.push(Source::Pin { element, pin: at });
        net
    }

    /// Contacts between `from` and a net: `into`, or a new one.
    fn contacts(&mut self, signal: &Signal, from: NetId, into: Option<NetId>) -> Result<NetId, Reason> {
        let flow = |drawing: &Drawing| pin("in", PinValue::Net(from), false, false, drawing.span);
        match signal {
            Signal::Constant(true) if into.is_none() => Ok(from),
            Signal::Constant(true) => Err("a branch without a contact".to_string()),
            Signal::Constant(false) => {
                let operand = pin("operand", PinValue::Operand(truth(false, self.span)), false, false, self.span);
                let element = self.element("Contact", vec![flow(self), operand], None);
                Ok(self.output(element, "out", into))
            }
            Signal::Operand(value) => Ok(self.contact(value, false, from, into)),
            Signal::Not(inner) => match &**inner {
                Signal::Operand(value) => Ok(self.contact(value, true, from, into)),
                Signal::Flag { .. }
                | Signal::Compare { .. }
                | Signal::Element(_)
                | Signal::Net(_)
                | Signal::Edge { .. }
                | Signal::Constant(_)
                | Signal::Not(_)
                | Signal::And(_)
                | Signal::Or(_)
                | Signal::Xor(_) => {
                    let rail = self.rail();
                    if from != rail {
                        return Err("an inverted branch after contacts".to_string());
                    }
                    let net = self.contacts(inner, from, None)?;
                    let element =
                        self.element("Not", vec![pin("in", PinValue::Net(net), false, false, self.span)], None);
                    Ok(self.output(element, "out", into))
                }
            },
            Signal::And(list) => {
                let mut net = from;
                // Inversion works on all that is before it, and a box is at the beginning: they come first.
                let leads = |one: &&Signal| match one {
                    Signal::Not(inner) => !matches!(**inner, Signal::Operand(_)),
                    one => matches!(one, Signal::Net(_)),
                };
                let (first, rest): (Vec<&Signal>, Vec<&Signal>) = list.iter().partition(leads);
                if first.len() > 1 {
                    return Err("two inverted branches or results of boxes in series".to_string());
                }
                let order: Vec<&Signal> = first.into_iter().chain(rest).collect();
                let last = order.len() - 1;
                for (at, one) in order.into_iter().enumerate() {
                    net = self.contacts(one, net, if at == last { into } else { None })?;
                }
                Ok(net)
            }
            Signal::Or(list) => {
                let net = into.unwrap_or_else(|| self.wire());
                for one in list {
                    self.contacts(one, from, Some(net))?;
                }
                Ok(net)
            }
            Signal::Xor(_) => match signal.polarities() {
                Some((branches, _)) => self.contacts(&branches, from, into),
                None => Err("an exclusive OR of edges or of this many contacts".to_string()),
            },
            Signal::Compare { element, ty, left, right, span } => {
                let (left, right) = (PinValue::Operand(left.clone()), PinValue::Operand(right.clone()));
                let pins = vec![
                    pin("pre", PinValue::Net(from), false, false, *span),
                    pin("in1", left, false, false, *span),
                    pin("in2", right, false, false, *span),
                ];
                let element = self.element(element, pins, Some(ty));
                Ok(self.output(element, "out", into))
            }
            Signal::Flag { element, span } => {
                let element = self.element(element, vec![pin("pre", PinValue::Net(from), false, false, *span)], None);
                Ok(self.output(element, "out", into))
            }
            Signal::Edge { of, bit, rising, span } => {
                let rail = self.rail();
                let element = if from == rail {
                    let net = self.contacts(of, from, None)?;
                    let bit = pin("bit", PinValue::Operand(bit.clone()), false, false, *span);
                    let flow = pin("in", PinValue::Net(net), false, false, *span);
                    self.element(if *rising { "P_Trig" } else { "N_Trig" }, vec![flow, bit], None)
                } else if let Signal::Operand(operand) = &**of {
                    let pins = vec![
                        pin("pre", PinValue::Net(from), false, false, *span),
                        pin("operand", PinValue::Operand(operand.clone()), false, false, *span),
                        pin("bit", PinValue::Operand(bit.clone()), false, false, *span),
                    ];
                    self.element(if *rising { "P_Contact" } else { "N_Contact" }, pins, None)
                } else {
                    return Err("the edge of a branch after contacts".to_string());
                };
                Ok(self.output(element, "out", into))
            }
            Signal::Element(element) => {
                let span = element.span;
                let mut element = (**element).clone();
                element.pins.insert(0, pin("pre", PinValue::Net(from), false, false, span));
                self.graph.elements.push(element);
                Ok(self.output(self.graph.elements.len() - 1, "out", into))
            }
            Signal::Net(net) if self.rail == Some(from) && into.is_none() => Ok(*net),
            Signal::Net(_) => Err("the result of a box after contacts".to_string()),
        }
    }

    fn contact(&mut self, value: &Expr, negated: bool, from: NetId, into: Option<NetId>) -> NetId {
        let pins = vec![
            pin("in", PinValue::Net(from), false, false, self.span),
            pin("operand", PinValue::Operand(value.clone()), negated, false, self.span),
        ];
        let element = self.element("Contact", pins, None);
        self.output(element, "out", into)
    }

    /// Gates for a signal: what an input is connected to, and whether it is inverted.
    fn gates(&mut self, signal: &Signal) -> Result<(PinValue, bool), Reason> {
        Ok(match signal {
            Signal::Constant(value) => (PinValue::Operand(truth(*value, self.span)), false),
            Signal::Operand(value) => (PinValue::Operand(value.clone()), false),
            Signal::Not(inner) => {
                let (value, negated) = self.gates(inner)?;
                (value, !negated)
            }
            Signal::And(list) => (self.gate("A", list)?, false),
            Signal::Or(list) => (self.gate("O", list)?, false),
            Signal::Xor(list) => (self.gate("X", list)?, false),
            Signal::Compare { element, ty, left, right, span } => {
                let (left, right) = (PinValue::Operand(left.clone()), PinValue::Operand(right.clone()));
                let pins = vec![pin("in1", left, false, false, *span), pin("in2", right, false, false, *span)];
                let element = self.element(element, pins, Some(ty));
                (PinValue::Net(self.output(element, "out", None)), false)
            }
            Signal::Flag { element, .. } => {
                let element = self.element(element, Vec::new(), None);
                (PinValue::Net(self.output(element, "out", None)), false)
            }
            Signal::Edge { of, bit, rising, span } => {
                let (value, negated) = self.gates(of)?;
                let flow = pin("in", value, negated, false, *span);
                let bit = pin("bit", PinValue::Operand(bit.clone()), false, false, *span);
                let element = self.element(if *rising { "P_Trig" } else { "N_Trig" }, vec![flow, bit], None);
                (PinValue::Net(self.output(element, "out", None)), false)
            }
            Signal::Element(element) => {
                self.graph.elements.push((**element).clone());
                (PinValue::Net(self.output(self.graph.elements.len() - 1, "out", None)), false)
            }
            Signal::Net(net) => (PinValue::Net(*net), false),
        })
    }

    fn gate(&mut self, name: &str, list: &[Signal]) -> Result<PinValue, Reason> {
        let mut pins = Vec::new();
        for (at, one) in list.iter().enumerate() {
            let (value, negated) = self.gates(one)?;
            pins.push(pin(&format!("in{}", at + 1), value, negated, false, self.span));
        }
        let element = self.element(name, pins, None);
        Ok(PinValue::Net(self.output(element, "out", None)))
    }
}

/// A pin.
pub fn pin(name: &str, value: PinValue, negated: bool, output: bool, span: Span) -> Pin {
    Pin { name: name.to_string(), value, negated, output, storage: Storage::None, span }
}

fn row(name: &str) -> &'static Row {
    find_sd(name).map(|(row, _)| row).expect("the names in this crate are in the table")
}

/// TRUE or FALSE.
fn truth(value: bool, span: Span) -> Expr {
    Expr {
        kind: ExprKind::Literal(Literal::Typed { ty: Elementary::Bool, bits: u64::from(value) }),
        span: Span { end: span.start, ..span },
    }
}
