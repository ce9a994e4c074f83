//! Rungs to elements and nets: what feeds what.
//!
//! A rung carries a flow from item to item. An element receives it at its flow pin and passes its own flow on; a wire is a net that the flow goes
//! into and comes out of. Source: LAD/FBD reference, A.5, A.6, A.8.

mod element;
mod nets;
mod operand;
mod pins;
mod settings;

use plcc_diag::{Code, Diagnostic, Span};

use super::network::Source as Text;
use super::pragma::Attribute;
use super::tree::{Argument, Item, Part, Rung, ValueKind, Wire};
use nets::Nets;
use plcc_syntax::network::ast::{Element, Eno, Graph, Language, NetId, Pin, PinValue, Source, Storage, Target};
use plcc_syntax::network::elements::{self, Kind};
use plcc_syntax::scl::ast::{Expr, Name};

/// Builds the graph of a network, and its labels.
pub fn build(
    text: &Text,
    language: Language,
    parts: Vec<Part>,
    diagnostics: &mut Vec<Diagnostic>,
) -> (Vec<Name>, Graph) {
    let told = diagnostics.len();
    let mut builder = Builder { text, language, graph: Graph::default(), nets: Nets::default(), diagnostics };
    let mut labels = Vec::new();
    let mut rungs = 0;
    for part in parts {
        match part {
            Part::Label(arguments, span) => builder.label(arguments, span, rungs > 0, &mut labels),
            Part::Rung(rung) => {
                builder.rung(rung);
                rungs += 1;
            }
        }
    }
    builder.finish_nets();
    builder.graph.broken |= builder.diagnostics[told..].iter().any(Diagnostic::is_error);
    (labels, builder.graph)
}

/// The flow between two items of a rung.
#[derive(Clone, Debug)]
enum Flow {
    /// Nothing is connected.
    Nothing,
    Net(NetId),
    /// An operand that the rung begins with.
    Operand(Expr),
    /// The output of the element with that index.
    Element(usize),
    /// Nothing can follow the element with this name.
    Ended(Span),
    /// An error was reported.
    Lost,
}

/// A flow, and whether it is inverted.
#[derive(Clone, Debug)]
struct Carried {
    flow: Flow,
    inverted: bool,
}

struct Builder<'a, 'd> {
    text: &'a Text<'a>,
    language: Language,
    graph: Graph,
    nets: Nets,
    diagnostics: &'d mut Vec<Diagnostic>,
}

impl Builder<'_, '_> {
    /// `Label( name )`; without a name it means nothing.
    fn label(&mut self, arguments: Vec<Argument>, span: Span, late: bool, labels: &mut Vec<Name>) {
        if late {
            self.report(
                Diagnostic::new(Code::ElementPlace, span, "a label must come before the first rung")
                    .label("not first in its network")
                    .help("write `Label( name )` directly after `NETWORK`; a jump leads to the start of a network"),
            );
        }
        for argument in arguments {
            if let Some(value) = argument.value
                && let ValueKind::Operand(span) = value.kind
            {
                labels.push(self.label_name(span));
            }
        }
    }

    fn rung(&mut self, rung: Rung) {
        self.graph.broken |= rung.is_open;
        let mut carried = Carried { flow: Flow::Nothing, inverted: false };
        let mut settings: Vec<Attribute> = Vec::new();
        let mut settings_span = None;
        let first_element = self.graph.elements.len();
        let mut first = true;
        if let ([Item::Wire(_)], None) = (rung.items.as_slice(), &rung.end) {
            // An empty rung.
            return;
        }
        let mut items = rung.items.into_iter().peekable();
        while let Some(item) = items.next() {
            match item {
                Item::Wire(wire) if first => carried.flow = Flow::Net(self.consumed(wire)),
                Item::Wire(wire) if items.peek().is_none() && rung.end.is_none() => {
                    let last = std::mem::replace(&mut carried, Carried { flow: Flow::Lost, inverted: false });
                    self.end_in_wire(last, wire, first_element);
                }
                Item::Wire(wire) => self.through_wire(&mut carried, wire, first_element),
                Item::Operand(span) if first => {
                    if self.language == Language::Lad {
                        self.report_rung_start(span);
                        carried.flow = Flow::Lost;
                    } else {
                        self.lead(&mut carried, span, items.peek());
                    }
                }
                Item::Operand(span) if let Some(gate) = gate_of(self.slice(span)) => {
                    let negation = match items.peek() {
                        Some(Item::Not(negation)) => Some(*negation),
                        _ => None,
                    };
                    if negation.is_some() {
                        items.next();
                    }
                    let operand = match items.peek() {
                        Some(Item::Operand(operand)) => Some(*operand),
                        _ => None,
                    };
                    if operand.is_some() {
                        items.next();
                    }
                    let operand = operand.map(|operand| negation.map_or(operand, |negation| negation.to(operand)));
                    self.report_operator(span, gate, operand);
                    carried.flow = Flow::Lost;
                }
                Item::Operand(span) if is_operand(items.peek()) && elements::find_sd(self.slice(span)).is_some() => {
                    let element = self.slice(span).to_owned();
                    let Some(Item::Operand(operand)) = items.next() else { continue };
                    let help = format!("write `{element}( {} )`", self.slice(operand));
                    self.report(
                        Diagnostic::new(
                            Code::Syntax,
                            span,
                            format!("the operand of `{element}` is written in parentheses"),
                        )
                        .label("an element")
                        .help(help),
                    );
                    carried.flow = Flow::Lost;
                }
                Item::Operand(span) if elements::find_sd(self.slice(span)).is_some() => {
                    let element = self.slice(span).to_owned();
                    self.report(
                        Diagnostic::new(Code::Syntax, span, format!("`{element}` has no parentheses"))
                            .label("an element")
                            .help(format!("write `{element}( … )`, with its operand or its pins")),
                    );
                    carried.flow = Flow::Lost;
                }
                Item::Operand(span) => {
                    self.report(
                        Diagnostic::new(
                            Code::Syntax,
                            span,
                            format!("a rung cannot contain `{}` here", self.slice(span)),
                        )
                        .label("an operand without an element")
                        .help("write operands in the parentheses of an element; only a rung of FBD can begin with one"),
                    );
                    carried.flow = Flow::Lost;
                }
                Item::Not(span) => {
                    if first {
                        self.report_leading_not(span);
                        if let Some(Item::Operand(_)) = items.peek() {
                            items.next();
                        }
                        carried.flow = Flow::Lost;
                    } else if self.language == Language::Lad {
                        self.report(
                            Diagnostic::new(Code::ElementPlace, span, "in LAD an element inverts the flow")
                                .label("this form belongs to FBD")
                                .help("write `Not()`"),
                        );
                    }
                    carried.inverted = !carried.inverted;
                }
                Item::Pragma(attributes, span) => {
                    settings.extend(attributes);
                    settings_span = Some(span);
                    // It is before the wire or operand only by mistake; the element counts.
                    continue;
                }
                Item::Element(node) => {
                    if first && self.language == Language::Lad {
                        self.report_rung_start(node.target);
                        carried.flow = Flow::Lost;
                    }
                    settings_span = None;
                    self.element(&mut carried, node, std::mem::take(&mut settings));
                }
                // It was reported, and what it was meant as is not known.
                Item::Error => {
                    carried.flow = Flow::Lost;
                    self.graph.broken = true;
                }
            }
            first = false;
        }
        if let Some(span) = settings_span {
            self.report(
                Diagnostic::new(Code::Syntax, span, "these attributes belong to no element")
                    .label("no element follows")
                    .help("write them directly before the element that they describe"),
            );
        }
        match rung.end {
            Some(wire) => self.end_in_wire(carried, wire, first_element),
            None if carried.inverted && !matches!(carried.flow, Flow::Lost) => self.report(
                Diagnostic::new(Code::Syntax, rung.span, "the rung ends with `NOT`")
                    .label("nothing uses the inverted flow")
                    .help("write the element after `NOT`, or remove it"),
            ),
            None => {}
        }
    }

    /// The operand that a rung of FBD begins with.
    fn lead(&mut self, carried: &mut Carried, span: Span, next: Option<&Item>) {
        carried.flow = Flow::Operand(self.operand(span));
        if let Some(Item::Element(node)) = next
            && let Some((row, _)) = elements::find_sd(self.slice(node.target))
            && row.is_box()
        {
            self.report(
                Diagnostic::new(
                    Code::Tolerated,
                    span,
                    format!("the operand is connected directly to the box `{}`", self.slice(node.target)),
                )
                .label("read as EN")
                .help("write `A()` between them, as the TIA Portal requires"),
            );
        }
    }

    fn report_rung_start(&mut self, span: Span) {
        self.report(
            Diagnostic::new(Code::Syntax, span, "a rung of LAD begins with a wire")
                .label("a wire is expected here")
                .help("write `RUNG wire#powerrail`, or the wire where this branch begins"),
        );
    }

    /// `#a AND #b`, `Contact( #a ) OR Contact( #b )`; `gate`: the element of FBD.
    fn report_operator(&mut self, span: Span, gate: &str, operand: Option<Span>) {
        let word = self.slice(span).to_owned();
        let help = match (self.language, gate) {
            (Language::Lad, "A") => format!("remove `{word}`: elements in a row are in series"),
            (Language::Lad, "O") => format!(
                "write `wire#w1` for `{word}`, and the other branch as a rung: `RUNG wire#powerrail Contact( … ) END_RUNG wire#w1`"
            ),
            (Language::Lad, _) => "write two branches, each with a contact and a negated one".to_owned(),
            _ => format!("write `{gate}( in2 := {} )`", operand.map_or("…", |operand| self.slice(operand))),
        };
        self.report(
            Diagnostic::new(Code::ForeignForm, span, format!("a rung has no operator `{word}`"))
                .label("a form of other languages")
                .help(help),
        );
    }

    fn report_leading_not(&mut self, span: Span) {
        self.report(
            Diagnostic::new(Code::Syntax, span, "a rung cannot begin with `NOT`")
                .label("no flow to invert")
                .help("write the operand first, `RUNG #a NOT …`, or negate it at the pin: `in2 := NOT #a`"),
        );
    }

    // Flow.

    /// Where the flow comes from, for a net.
    fn source(&mut self, carried: Carried) -> Option<Source> {
        if carried.inverted && matches!(carried.flow, Flow::Net(_) | Flow::Element(_)) {
            let inverter = self.inverter(carried);
            return self.source(Carried { flow: Flow::Element(inverter?), inverted: false });
        }
        match carried.flow {
            Flow::Nothing | Flow::Lost => None,
            Flow::Ended(name) => {
                self.report_ended(name);
                None
            }
            Flow::Net(net) => Some(Source::Net(net)),
            Flow::Operand(value) => Some(Source::Operand { value, negated: carried.inverted }),
            Flow::Element(element) => {
                let row = match &self.graph.elements[element].target {
                    Target::Element { row, .. } => row.pin(row.flow.1).map(|(_, name)| name),
                    Target::Block { .. } => Some("eno".to_string()),
                };
                let element_node = &mut self.graph.elements[element];
                let span = element_node.span;
                element_node.pins.push(Pin {
                    name: row?,
                    value: PinValue::Open,
                    negated: false,
                    output: true,
                    storage: Storage::None,
                    span,
                });
                Some(Source::Pin { element, pin: element_node.pins.len() - 1 })
            }
        }
    }

    /// An element that inverts the flow for a net that other elements use.
    fn inverter(&mut self, carried: Carried) -> Option<usize> {
        let (row, _) = elements::find_sd("Not")?;
        let (value, negated) = self.taken(Carried { inverted: false, ..carried })?;
        let span = match &value {
            PinValue::Net(net) => self.graph.net(*net).span,
            PinValue::Operand(value) => value.span,
            PinValue::Open => return None,
        };
        let pin = Pin { name: "in".to_string(), value, negated, output: false, storage: Storage::None, span };
        self.graph.elements.push(Element {
            target: Target::Element { row, instance: None },
            templates: Vec::new(),
            eno: Eno::Default,
            pins: vec![pin],
            equation: None,
            cases: Vec::new(),
            span,
        });
        Some(self.graph.elements.len() - 1)
    }

    /// The connection of the flow pin of the next element, and whether it is inverted; none: not connected.
    fn taken(&mut self, carried: Carried) -> Option<(PinValue, bool)> {
        let inverted = carried.inverted;
        let value = match carried.flow {
            Flow::Nothing | Flow::Lost => return None,
            Flow::Ended(name) => {
                self.report_ended(name);
                return None;
            }
            Flow::Net(net) => PinValue::Net(net),
            Flow::Operand(value) => PinValue::Operand(value),
            Flow::Element(element) => {
                let span = self.graph.elements[element].span;
                let source = self.source(Carried { flow: Flow::Element(element), inverted: false })?;
                let net = self.graph.add_net("", span);
                self.connect(&source, net);
                self.graph.nets[net.0 as usize].sources.push(source);
                PinValue::Net(net)
            }
        };
        Some((value, inverted))
    }

    /// Shows at an output pin which net it feeds.
    fn connect(&mut self, source: &Source, net: NetId) {
        if let Source::Pin { element, pin } = source {
            self.graph.elements[*element].pins[*pin].value = PinValue::Net(net);
        }
    }

    fn report_ended(&mut self, name: Span) {
        self.report(
            Diagnostic::new(Code::ElementPlace, name, format!("nothing can follow `{}`", self.slice(name)))
                .label("ends its rung")
                .help("write it last, and begin a separate rung for the rest"),
        );
    }

    /// A wire in the middle of a rung: the flow enters its net, and continues with the value of the net.
    fn through_wire(&mut self, carried: &mut Carried, wire: Wire, first_element: usize) {
        let before = std::mem::replace(carried, Carried { flow: Flow::Lost, inverted: false });
        if matches!(before.flow, Flow::Nothing) && self.language == Language::Fbd {
            self.report(
                Diagnostic::new(
                    Code::ElementPlace,
                    wire.span,
                    format!("nothing feeds `{}` here", self.slice(wire.span)),
                )
                .label("no element comes before it")
                .help("write an operand, a wire or an element before it"),
            );
        }
        let effect = self.has_effect(first_element);
        let source = self.source(before);
        if let Some(net) = self.fed(wire, source, nets::Place::Inline, effect) {
            *carried = Carried { flow: Flow::Net(net), inverted: false };
            self.nets.note_inline_use(net);
        }
    }

    /// The wire at the end of a rung.
    fn end_in_wire(&mut self, carried: Carried, wire: Wire, first_element: usize) {
        let effect = self.has_effect(first_element);
        let source = self.source(carried);
        self.fed(wire, source, nets::Place::End, effect);
    }

    /// Whether an element of the rung does more than pass the flow.
    fn has_effect(&self, first_element: usize) -> bool {
        self.graph.elements[first_element..].iter().any(|element| match &element.target {
            Target::Block { .. } => true,
            Target::Element { row, .. } => !matches!(
                row.kind,
                Kind::Contact
                    | Kind::Not
                    | Kind::Gate(_)
                    | Kind::Compare(_)
                    | Kind::Range { .. }
                    | Kind::Valid { .. }
                    | Kind::Variant(_)
                    | Kind::Flag(_)
            ),
        })
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }
}

/// The element of FBD for an operator between operands, as other languages write it.
fn gate_of(word: &str) -> Option<&'static str> {
    match word.to_ascii_uppercase().as_str() {
        "AND" => Some("A"),
        "OR" => Some("O"),
        "XOR" => Some("X"),
        _ => None,
    }
}

fn is_operand(item: Option<&Item>) -> bool {
    matches!(item, Some(Item::Operand(_)))
}
