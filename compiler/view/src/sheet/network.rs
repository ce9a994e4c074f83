//! Networks of LAD and FBD as sheets.

use plcc_syntax::network::ast::{
    Content, Element, Graph, Language, Network, PinValue, Source as GraphSource, Storage, Target, TemplateKey,
};
use plcc_syntax::network::draw;
use plcc_syntax::network::elements::{Gate, Kind, PinDirection, PinRow, Row};
use plcc_syntax::scl::ast::Expr;

use super::{Label, Link, Look, Meaning, Net, Part, Pin, Place, Sheet, Source};
use crate::names::{Formal, Names, Scope};

/// The sheet of a network. `text`: the source, or its overlay.
pub fn sheet(graph: &Graph, language: Language, names: &Names, scope: Scope, text: &str) -> Sheet {
    let label =
        |value: &Expr| Label { place: Some(value.span.start), ..names.label(&draw::whole_of(value, text), scope) };
    sheet_with(graph, language, names, scope, &Words { label: &label, text })
}

/// Whether a network has flip-flops, timers or counters as boxes, of which statements also make coils.
pub fn has_cells(network: &Network) -> bool {
    let Content::Graphic(graph) = &network.content else { return false };
    let is_cell = |element: &Element| match &element.target {
        Target::Element { row, .. } => match row.kind {
            Kind::FlipFlop { .. } | Kind::S5Counter(_) => true,
            Kind::S5Timer(_) => draw::is_timer_box(element),
            _ => false,
        },
        Target::Block { .. } => false,
    };
    graph.elements.iter().any(is_cell)
}

/// The sheet of a network that is made of statements: `label` finds the operands in their own words.
pub fn sheet_of_statements(graph: &Graph, names: &Names, scope: Scope, label: &dyn Fn(&Expr) -> Label) -> Sheet {
    let mut sheet = sheet_with(graph, Language::Lad, names, scope, &Words { label, text: "" });
    for part in &mut sheet.parts {
        part.statement = part.place.take();
    }
    sheet
}

/// How operands are written.
struct Words<'a> {
    label: &'a dyn Fn(&Expr) -> Label,
    /// The text that constants of formulas are read from.
    text: &'a str,
}

fn sheet_with(graph: &Graph, language: Language, names: &Names, scope: Scope, words: &Words) -> Sheet {
    let mut nets: Vec<Net> = Vec::with_capacity(graph.nets.len());
    for (at, net) in graph.nets.iter().enumerate() {
        let name = if net.name.is_empty() { format!("n{at}") } else { net.name.clone() };
        let sources = net.sources.iter().map(|source| match source {
            GraphSource::Rail => Source::Rail,
            GraphSource::Pin { element, pin } => Source::Pin { part: *element, pin: *pin },
            GraphSource::Operand { value, negated } => {
                Source::Operand { label: (words.label)(value), negated: *negated }
            }
            GraphSource::Net(id) => Source::Net(id.0 as usize),
        });
        nets.push(Net { name, sources: sources.collect(), joins: None });
    }
    let parts = graph.elements.iter().map(|element| part(element, language, words)).collect();
    let mut sheet = Sheet { parts, nets, ..Sheet::default() };
    for (at, element) in graph.elements.iter().enumerate() {
        if let Target::Element { row, .. } = &element.target {
            sheet.add_outputs(at, row);
            sheet.complete_cell(at, row);
        }
    }
    if language == Language::Fbd {
        sheet.negations_at_pins();
    }
    sheet.name_instances(names, scope);
    sheet.complete_calls(names);
    sheet
}

fn part(element: &Element, language: Language, words: &Words) -> Part {
    let (flow_in, flow_out) = match &element.target {
        Target::Element { row, .. } => row.flow,
        Target::Block { .. } => ("en", "eno"),
    };
    let find = |name: &str, output: bool| {
        element.pins.iter().position(|pin| pin.output == output && pin.name.eq_ignore_ascii_case(name))
    };
    let (flow_in, flow_out) = (find(flow_in, false), find(flow_out, true));
    let (look, meaning, small) = look(element, language, words);
    let of_words =
        matches!(&element.target, Target::Element { row, .. } if matches!(row.kind, Kind::Compare(_) | Kind::Move));
    let mut places = 0;
    let pins = element.pins.iter().enumerate().map(|(at, pin)| {
        let is_flow = Some(at) == flow_in || Some(at) == flow_out;
        let place = match (small, is_flow) {
            (_, true) => Place::Side,
            (false, false) => box_place(element, &pin.name),
            // The time of a timer, wherever the file has it.
            (true, false) if pin.name == "tv" => Place::Below,
            (true, false) => {
                places += 1;
                if places == 1 { Place::Above } else { Place::Below }
            }
        };
        let link = match &pin.value {
            PinValue::Net(id) => Link::Net(id.0 as usize),
            PinValue::Operand(value) => {
                let mut label = (words.label)(value);
                if of_words && !is_flow {
                    label = label.into_word();
                }
                match pin.storage {
                    Storage::None => {}
                    Storage::Set => label.text.push_str(" (S)"),
                    Storage::Reset => label.text.push_str(" (R)"),
                }
                Link::Operand(label)
            }
            PinValue::Open => Link::Open,
        };
        // The sign of a contact or a coil shows its negation.
        let negated = pin.negated && !(small && place == Place::Above);
        let name = if small { String::new() } else { pin_name(element, &pin.name) };
        Pin { name, place, output: pin.output, link, negated }
    });
    let pins: Vec<Pin> = pins.collect();
    // The flow after a contact has the place of its operand.
    let operand = pins.iter().find_map(|pin| match (&meaning, &pin.link) {
        (Meaning::Contact { .. }, Link::Operand(label)) => label.place,
        _ => None,
    });
    Part { look, meaning, pins, flow_in, flow_out, place: operand.or(Some(element.span.start)), statement: None }
}

/// The look of an element, its meaning, and whether it has no pins at its sides but those of the flow.
fn look(element: &Element, language: Language, words: &Words) -> (Look, Meaning, bool) {
    let label = words.label;
    let (row, instance) = match &element.target {
        Target::Element { row, instance } => (*row, instance.as_ref().map(label)),
        Target::Block { callee, instance } => {
            let look =
                Look::Box { title: label(callee).text, detail: String::new(), instance: instance.as_ref().map(label) };
            return (look, Meaning::Other, false);
        }
    };
    let negated = element.pin("operand").is_some_and(|pin| pin.negated);
    let meaning = meaning(row, negated);
    if let (Kind::Compare(sign), Language::Lad) = (row.kind, language) {
        let sign = if sign == "=" { "==" } else { sign };
        return (Look::Compare { sign: sign.to_string(), ty: types(element) }, meaning, true);
    }
    if let Some(symbol) = draw::symbol(row, element, language) {
        let sign = symbol.get(1..symbol.len() - 1).unwrap_or_default().trim().to_string();
        let look = match symbol.as_bytes()[0] {
            b'|' if language == Language::Lad => Look::Contact { sign },
            b'(' => Look::Coil { sign },
            _ => Look::Box { title: sign, detail: String::new(), instance: None },
        };
        return (look, meaning, true);
    }
    let detail = match &element.equation {
        Some(equation) => format!("{}\nOUT := {}", types(element), draw::formula_of(equation, words.text)),
        None => types(element),
    };
    (Look::Box { title: title(row), detail, instance }, meaning, false)
}

/// Where a pin of a box is: the operand of a flip-flop, a timer or a counter is above it, the bit of an edge below.
fn box_place(element: &Element, pin: &str) -> Place {
    let Target::Element { row, .. } = &element.target else { return Place::Side };
    match row.kind {
        Kind::FlipFlop { .. } if pin == "operand" => Place::Above,
        Kind::S5Timer(_) if pin == "timer" => Place::Above,
        Kind::S5Counter(_) if pin == "counter" => Place::Above,
        Kind::EdgeTrigger { .. } if pin == "bit" => Place::Below,
        _ => Place::Side,
    }
}

fn meaning(row: &Row, negated: bool) -> Meaning {
    match row.kind {
        Kind::Contact => Meaning::Contact { negated },
        Kind::Not => Meaning::Not,
        Kind::Gate(Gate::And) => Meaning::And,
        Kind::Gate(Gate::Or) => Meaning::Or,
        Kind::Gate(Gate::Xor) => Meaning::Xor,
        Kind::Compare(sign) => Meaning::Compare { sign: sign.to_string(), inverse: false },
        Kind::Coil
        | Kind::SetCoil
        | Kind::ResetCoil
        | Kind::EdgeCoil { .. }
        | Kind::BitField { .. }
        | Kind::TimerCoil(_)
        | Kind::ResetTimer
        | Kind::PresetTimer
        | Kind::CounterCoil(_)
        | Kind::OpenDb { .. }
        | Kind::Save
        | Kind::Condition => Meaning::Through,
        Kind::EdgeContact { .. }
        | Kind::EdgeTrigger { .. }
        | Kind::FlipFlop { .. }
        | Kind::Range { .. }
        | Kind::Valid { .. }
        | Kind::Variant(_)
        | Kind::Instance(_)
        | Kind::Calculate
        | Kind::Formula
        | Kind::Operator(_)
        | Kind::Step { .. }
        | Kind::Function(_)
        | Kind::Procedure(_)
        | Kind::Move
        | Kind::Convert
        | Kind::Round(_)
        | Kind::Negate
        | Kind::Invert
        | Kind::Mux
        | Kind::Demux
        | Kind::Jump { .. }
        | Kind::JumpList
        | Kind::Switch
        | Kind::Return(_)
        | Kind::S5Timer(_)
        | Kind::S5Counter(_)
        | Kind::Mcr(_)
        | Kind::CallCoil
        | Kind::Flag(_) => Meaning::Other,
    }
}

/// The title of a box, as the editors of Siemens write it.
fn title(row: &Row) -> String {
    match row.kind {
        Kind::Gate(Gate::And) => "&".to_string(),
        Kind::Gate(Gate::Or) => ">=1".to_string(),
        Kind::Gate(Gate::Xor) => "x".to_string(),
        Kind::FlipFlop { set_wins: false } => "SR".to_string(),
        Kind::FlipFlop { set_wins: true } => "RS".to_string(),
        Kind::Compare(sign) => if sign == "=" { "==" } else { sign }.to_string(),
        Kind::Convert => "CONV".to_string(),
        Kind::Function(name) | Kind::Procedure(name) => name.to_string(),
        Kind::Range { inside } => if inside { "IN_RANGE" } else { "OUT_RANGE" }.to_string(),
        _ if row.name.contains(' ') => "f(x)".to_string(),
        _ => row.name.to_uppercase(),
    }
}

/// `Int`, `Int to Real`.
fn types(element: &Element) -> String {
    let value = |key| element.template(key).map(|template| template.value.trim()).filter(|value| !value.is_empty());
    match (value(TemplateKey::Source), value(TemplateKey::Destination)) {
        (Some(source), Some(destination)) if source != destination => format!("{source} to {destination}"),
        (Some(one), _) | (None, Some(one)) => one.to_string(),
        (None, None) => value(TemplateKey::Value).or(value(TemplateKey::Time)).unwrap_or_default().to_string(),
    }
}

/// A pin's name inside its box, as the editors of Siemens write it: none at gates, at boxes of a single sign, and where the flow enters and
/// leaves a comparison.
fn pin_name(element: &Element, name: &str) -> String {
    match &element.target {
        Target::Element { row, .. } => match (row.kind, name) {
            (Kind::EdgeTrigger { .. }, "in") => "CLK".to_string(),
            (Kind::EdgeTrigger { .. }, "out") => "Q".to_string(),
            (Kind::Gate(_) | Kind::EdgeTrigger { .. }, _) => String::new(),
            (Kind::Compare(_) | Kind::Range { .. }, "pre" | "out") => String::new(),
            (Kind::Range { .. }, "in") => "VAL".to_string(),
            (Kind::Step { .. }, "operand") => "IN/OUT".to_string(),
            _ => name.to_uppercase(),
        },
        Target::Block { .. } if name.eq_ignore_ascii_case("en") || name.eq_ignore_ascii_case("eno") => {
            name.to_uppercase()
        }
        Target::Block { .. } => name.to_string(),
    }
}

impl Sheet {
    /// A call by its instance shows the block in the box, and the instance above it.
    pub fn name_instances(&mut self, names: &Names, scope: Scope) {
        for part in &mut self.parts {
            if let Look::Box { title, instance: instance @ None, .. } = &mut part.look
                && let Some(block) = names.block_of_instance(title, scope)
            {
                *instance = Some(names.label(title, scope));
                *title = block;
            }
        }
    }

    /// The box of a flip-flop, an IEC timer or a counter has all of its outputs, also those that nothing is connected to.
    fn add_outputs(&mut self, at: usize, row: &Row) {
        let is_cell = match row.kind {
            Kind::Instance(_) => row.flow.1 != "eno",
            Kind::FlipFlop { .. } => true,
            _ => false,
        };
        let outputs = row.pins().filter(|pin| pin.direction == PinDirection::Output && pin.name() != "eno");
        let mut next = self.parts[at].pins.iter().position(|pin| pin.output).unwrap_or(self.parts[at].pins.len());
        for output in outputs.filter(|_| is_cell) {
            let own = self.parts[at].pins.iter().position(|pin| pin.output && output.matches(&pin.name).is_some());
            if own.is_none() {
                let name = output.name().to_uppercase();
                let pin = Pin { name, place: Place::Side, output: true, link: Link::Open, negated: false };
                self.insert_pin(at, next, pin);
                if output.name() == row.flow.1 {
                    self.parts[at].flow_out = Some(next);
                }
            }
            next = own.unwrap_or(next) + 1;
        }
    }

    /// The box of a timer or counter of the S7-300/400 has all of its pins, in the order of the table.
    fn complete_cell(&mut self, at: usize, row: &Row) {
        let left_out: &[&str] = match row.kind {
            Kind::S5Timer(_) if matches!(self.parts[at].look, Look::Box { .. }) => &["timer", "out"],
            Kind::S5Counter("S_CU") => &["counter", "cd"],
            Kind::S5Counter("S_CD") => &["counter", "cu"],
            Kind::S5Counter(_) => &["counter"],
            _ => return,
        };
        let formal = |known: PinRow| Formal {
            name: known.name().to_uppercase(),
            output: known.direction == PinDirection::Output,
            always: !left_out.contains(&known.name()),
        };
        self.arrange(at, &row.pins().map(formal).collect::<Vec<Formal>>());
        let part = &mut self.parts[at];
        let open = part.pins.iter().position(|pin| pin.output && row.flow.1.eq_ignore_ascii_case(&pin.name));
        part.flow_out = part.flow_out.or(open);
    }

    /// The box of a call has all parameters of its block, in their order.
    pub fn complete_calls(&mut self, names: &Names) {
        for at in 0..self.parts.len() {
            if let Look::Box { title, .. } = &self.parts[at].look
                && let Some(formals) = names.parameters(title)
            {
                self.arrange(at, formals);
            }
        }
    }

    /// Puts the pins of a box into an order, with those that nothing is connected to.
    fn arrange(&mut self, at: usize, formals: &[Formal]) {
        let part = &mut self.parts[at];
        let mut old: Vec<Option<Pin>> = std::mem::take(&mut part.pins).into_iter().map(Some).collect();
        let mut moved = vec![0; old.len()];
        let mut pins: Vec<Pin> = Vec::new();
        for formal in formals {
            let before = pins.len();
            for (own, to) in old.iter_mut().zip(&mut moved) {
                if own.as_ref().is_some_and(|own| own.name.eq_ignore_ascii_case(&formal.name)) {
                    *to = pins.len();
                    pins.extend(own.take());
                }
            }
            if pins.len() == before && formal.always {
                let (name, output) = (formal.name.clone(), formal.output);
                pins.push(Pin { name, place: Place::Side, output, link: Link::Open, negated: false });
            }
        }
        for (own, to) in old.iter_mut().zip(&mut moved).filter(|(own, _)| own.is_some()) {
            *to = pins.len();
            pins.extend(own.take());
        }
        part.flow_in = part.flow_in.map(|pin| moved[pin]);
        part.flow_out = part.flow_out.map(|pin| moved[pin]);
        part.pins = pins;
        for source in self.nets.iter_mut().flat_map(|net| &mut net.sources) {
            if let Source::Pin { part, pin } = source
                && *part == at
            {
                *pin = moved[*pin];
            }
        }
    }

    /// Gives a part a further pin before another one.
    fn insert_pin(&mut self, at: usize, before: usize, pin: Pin) {
        let part = &mut self.parts[at];
        part.pins.insert(before, pin);
        for flow in part.flow_in.iter_mut().chain(&mut part.flow_out).filter(|flow| **flow >= before) {
            *flow += 1;
        }
        for source in self.nets.iter_mut().flat_map(|net| &mut net.sources) {
            if let Source::Pin { part, pin } = source
                && *part == at
                && *pin >= before
            {
                *pin += 1;
            }
        }
    }

    /// FBD has no element for a negation: it is a circle at the pins that the net of a NOT leads to.
    fn negations_at_pins(&mut self) {
        for at in 0..self.parts.len() {
            let part = &self.parts[at];
            if part.meaning != Meaning::Not {
                continue;
            }
            let (Some(from), Some(to)) = (part.net(part.flow_in), part.net(part.flow_out)) else { continue };
            let alone = self.nets.get(to).is_some_and(|net| net.sources.len() == 1) && from != to;
            let sources: usize =
                self.nets.iter().flat_map(|net| &net.sources).filter(|s| **s == Source::Net(to)).count();
            if !alone || sources > 0 {
                continue;
            }
            for pin in self.parts.iter_mut().flat_map(|part| &mut part.pins) {
                if pin.link == Link::Net(to) && !pin.output {
                    pin.link = Link::Net(from);
                    pin.negated = !pin.negated;
                }
            }
            self.nets[to].sources.clear();
            self.parts[at].pins.clear();
            self.parts[at].look = Look::Nothing;
        }
    }
}
