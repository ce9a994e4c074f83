//! Pins of an element: by name or by position, in the order of the table.

use plcc_diag::{Code, Diagnostic, Span};

use super::{Builder, nets};
use crate::sd::tree::{Argument, Pin as Given, Value, ValueKind};
use plcc_syntax::distance;
use plcc_syntax::network::ast::{Comparison, Language, Pin, PinValue, Source, Storage};
use plcc_syntax::network::elements::{Kind, PinDirection, PinRow, Row};
use plcc_syntax::scl::ast::Expr;

/// The pins of an element that is being read.
pub struct Pins {
    /// None: a call.
    row: Option<&'static Row>,
    /// The name of the element negates the operand.
    negated: bool,
    /// With its position in the table.
    pins: Vec<(Place, Pin)>,
    /// Comparisons of the form `GE #x => label`.
    cases: Vec<(usize, Comparison)>,
    /// Names in the arguments, as written.
    named: Vec<String>,
    /// The rung leads to the element, so its first input is connected.
    pub is_led: bool,
}

/// Flow first, then by the table: index of the pin, number of a numbered one.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Place {
    Flow,
    Table(usize, u32),
}

impl Pins {
    pub fn of_row(row: &'static Row, negated: bool) -> Pins {
        Pins { row: Some(row), negated, ..Pins::of_block() }
    }

    pub fn of_block() -> Pins {
        Pins { row: None, negated: false, pins: Vec::new(), cases: Vec::new(), named: Vec::new(), is_led: false }
    }

    /// The operand before the name of the element.
    pub fn operand(&mut self, span: Span, value: Expr) {
        let Some(row) = self.row else { return };
        let wanted = match row.kind {
            Kind::S5Timer(_) => "timer",
            Kind::S5Counter(_) => "counter",
            _ => "operand",
        };
        if let Some((known, name)) = row.pin(wanted) {
            let output = known.direction == PinDirection::Output;
            let value = PinValue::Operand(value);
            self.add(Pin { name, value, negated: false, output, storage: Storage::None, span });
        }
    }

    /// Connects the flow.
    pub fn first(&mut self, pin: Pin) {
        self.pins.push((Place::Flow, pin));
    }

    /// Where a pin was written.
    pub fn given(&self, name: &str) -> Option<Span> {
        self.pins.iter().find(|(_, pin)| pin.name.eq_ignore_ascii_case(name)).map(|(_, pin)| pin.span)
    }

    /// Comparisons by the number of their branch.
    pub fn cases(&self) -> impl Iterator<Item = (usize, Comparison)> {
        self.cases.iter().copied()
    }

    /// The pins in their order; open pins that may be missing are left out. Those of a call remain as written, after the flow.
    pub fn finish(mut self) -> Vec<Pin> {
        let row = self.row;
        self.pins.retain(|(_, pin)| {
            let optional = row.and_then(|row| row.pin(&pin.name)).is_some_and(|(known, _)| known.optional);
            !(optional && pin.value == PinValue::Open)
        });
        self.pins.sort_by_key(|(place, _)| *place);
        self.pins.into_iter().map(|(_, pin)| pin).collect()
    }

    fn add(&mut self, pin: Pin) {
        let place = match self.row {
            Some(row) => place_of(row, &pin.name),
            None => Place::Table(0, 0),
        };
        self.pins.push((place, pin));
    }

    /// The row's pin that the next of `count` arguments without a name means.
    fn next_unnamed(&self, row: &'static Row, count: usize) -> Option<(PinRow, String)> {
        let is = |pin: &PinRow, flow: &str| !flow.is_empty() && pin.matches(flow).is_some();
        let mut order: Vec<PinRow> = row.pins().filter(|pin| !is(pin, row.flow.0) && !is(pin, row.flow.1)).collect();
        if matches!(row.kind, Kind::FlipFlop { .. }) && count > 2 {
            // `SR( operand, s, r )`: the flow pin is one of them.
            order.splice(1..1, row.pins().filter(|pin| is(pin, row.flow.0)));
        }
        order.into_iter().find(|pin| self.given(pin.name()).is_none()).map(|pin| (pin, pin.name().to_string()))
    }
}

/// The position of a pin in the table.
fn place_of(row: &Row, name: &str) -> Place {
    if row.pin(row.flow.0).is_some_and(|(_, flow)| flow == name) {
        return Place::Flow;
    }
    let index = row.pins().position(|pin| pin.matches(name).is_some()).unwrap_or(usize::MAX);
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    Place::Table(index, name[stem.len()..].parse().unwrap_or(0))
}

/// The pin of a row that the text calls `name`.
fn find_pin(row: &'static Row, name: &str) -> Option<(PinRow, String)> {
    // `r` and `s` are short names at flip-flops.
    let dominant = || match row.kind {
        Kind::FlipFlop { .. } => row.pin(&format!("{name}1")),
        _ => None,
    };
    row.pin(name).or_else(dominant)
}

/// Coils whose operand is written with `:=` as well as with `=>`.
fn takes_both_signs(row: &Row) -> bool {
    matches!(
        row.kind,
        Kind::Coil
            | Kind::SetCoil
            | Kind::ResetCoil
            | Kind::EdgeCoil { .. }
            | Kind::BitField { .. }
            | Kind::TimerCoil(_)
            | Kind::ResetTimer
            | Kind::PresetTimer
            | Kind::S5Timer(_)
            | Kind::CounterCoil(_)
    )
}

/// Pins that name a label.
fn is_label(row: &Row, name: &str) -> bool {
    match row.kind {
        Kind::Jump { .. } => name == "label",
        Kind::JumpList | Kind::Switch => name.starts_with("dest") || name == "else",
        _ => false,
    }
}

impl Builder<'_, '_> {
    /// Reads the arguments of an element.
    pub(super) fn pins(&mut self, pins: &mut Pins, arguments: Vec<Argument>) {
        let count = arguments.iter().filter(|argument| argument.pin == Given::Unnamed).count();
        let named = arguments.iter().filter_map(|argument| match argument.pin {
            Given::Input(name) | Given::Output(name) => Some(self.slice(name).trim_matches(['"', '#']).to_string()),
            Given::Unnamed | Given::Case(..) | Given::Error => None,
        });
        pins.named = named.collect();
        if let Some(row) = pins.row.filter(|row| matches!(row.kind, Kind::Gate(_)))
            && count > 0
            && count == arguments.len()
            && arguments.iter().all(|argument| argument.value.is_some())
        {
            return self.report_unnamed_of_gate(row, pins.is_led, &arguments);
        }
        let mut branch = 0;
        for argument in arguments {
            let Argument { pin, value, span } = argument;
            match (pin, pins.row) {
                (Given::Error, _) => {}
                (Given::Unnamed, _) if value.is_none() => {}
                (Given::Unnamed, Some(row)) if self.is_flow(row, span) => self.report_flow(row, span),
                (Given::Unnamed, Some(row)) => match pins.next_unnamed(row, count) {
                    Some((known, name)) => self.row_pin(pins, row, known, name, value, span),
                    None => self.report_surplus(row, span),
                },
                (Given::Unnamed, None) => self.report_unnamed(span),
                (Given::Input(name), Some(row)) => self.named_pin(pins, row, name, false, value, span),
                (Given::Output(name), Some(row)) => self.named_pin(pins, row, name, true, value, span),
                (Given::Input(name), None) => self.call_pin(pins, name, false, value, span),
                (Given::Output(name), None) => self.call_pin(pins, name, true, value, span),
                (Given::Case(sign, label), Some(row)) if row.kind == Kind::Switch => {
                    pins.cases.push((branch, sign));
                    if let Some((known, name)) = row.pin(&format!("case{branch}")) {
                        self.row_pin(pins, row, known, name, value, span);
                    }
                    if let Some((known, name)) = row.pin(&format!("dst{branch}")) {
                        let label = Value { negated: false, kind: ValueKind::Operand(label) };
                        self.row_pin(pins, row, known, name, Some(label), span);
                    }
                    branch += 1;
                }
                (Given::Case(..), _) => self.report(
                    Diagnostic::new(Code::Syntax, span, "only SWITCH has branches with a comparison")
                        .label("not a pin")
                        .help("write `pin := operand` or `pin => operand`"),
                ),
            }
        }
    }

    /// `in2 := #b`
    fn named_pin(
        &mut self,
        pins: &mut Pins,
        row: &'static Row,
        name: Span,
        output: bool,
        value: Option<Value>,
        span: Span,
    ) {
        let text = self.slice(name).trim_matches(['"', '#']);
        let Some((known, canonical)) = find_pin(row, text) else {
            let names: Vec<&str> = row.pins().map(|pin| pin.name()).collect();
            // Those that the arguments give are not meant.
            let is_free = |pin: &PinRow| !pins.named.iter().any(|own| pin.matches(own).is_some());
            let free = row.pins().filter(is_free).map(|pin| pin.name());
            let diagnostic =
                Diagnostic::new(Code::UnknownParameter, name, format!("`{}` has no pin `{text}`", row.name))
                    .label("not a pin of this element")
                    .help(match distance::nearest(text, free) {
                        Some(near) => format!("is `{near}` meant?"),
                        None => format!("its pins are {}", names.join(", ")),
                    });
            return self.report(diagnostic);
        };
        let fits = match known.direction {
            PinDirection::Input => !output,
            PinDirection::Output => output,
            PinDirection::InOut => true,
        };
        let first_operand = matches!(canonical.as_str(), "operand" | "timer" | "counter");
        if fits || first_operand && takes_both_signs(row) && output {
            // As in the table, or as the TIA Portal writes coils.
        } else {
            let (sign, wanted) = if output { ("=>", ":=") } else { (":=", "=>") };
            let tolerated = first_operand && takes_both_signs(row);
            let code = if tolerated { Code::Tolerated } else { Code::Syntax };
            let kind = if output { "input" } else { "output" };
            let operand = self.slice(span).split_once(sign).map_or("…", |(_, operand)| operand.trim());
            let diagnostic =
                Diagnostic::new(code, name, format!("`{text}` is an {kind}, but is connected with `{sign}`"))
                    .label(format!("an {kind} of `{}`", row.name))
                    .help(format!("write `{text} {wanted} {operand}`"));
            self.report(diagnostic);
        }
        self.row_pin(pins, row, known, canonical, value, span);
    }

    /// A pin of the table.
    fn row_pin(
        &mut self,
        pins: &mut Pins,
        row: &'static Row,
        known: PinRow,
        name: String,
        value: Option<Value>,
        span: Span,
    ) {
        if let Some(first) = pins.given(&name) {
            self.report_twice(&name, first, span);
            return;
        }
        let output = known.direction == PinDirection::Output;
        let (value, negated) = self.value(value, output, is_label(row, &name));
        let negated = negated ^ (pins.negated && name == "operand");
        pins.add(Pin { name, value, negated, output, storage: Storage::None, span });
    }

    /// A pin of a call.
    fn call_pin(&mut self, pins: &mut Pins, name: Span, output: bool, value: Option<Value>, span: Span) {
        let text = self.slice(name).trim_matches(['"', '#']).to_string();
        if let Some(first) = pins.given(&text) {
            self.report_twice(&text, first, span);
            return;
        }
        let (value, negated) = self.value(value, output, false);
        let flow = !output && text.eq_ignore_ascii_case("en");
        let name = if flow || output && text.eq_ignore_ascii_case("eno") { text.to_lowercase() } else { text };
        let pin = Pin { name, value, negated, output, storage: Storage::None, span };
        if flow { pins.first(pin) } else { pins.add(pin) }
    }

    /// What a pin is connected to, and whether inverted.
    fn value(&mut self, value: Option<Value>, output: bool, label: bool) -> (PinValue, bool) {
        let Some(Value { negated, kind }) = value else { return (PinValue::Open, false) };
        let value = match kind {
            ValueKind::Wire(wire) if output => {
                self.fed(wire, None, nets::Place::Inline, true).map_or(PinValue::Open, PinValue::Net)
            }
            ValueKind::Wire(wire) => PinValue::Net(self.consumed(wire)),
            ValueKind::Operand(span) if label => PinValue::Operand(self.label_expression(span)),
            ValueKind::Operand(span) => PinValue::Operand(self.operand(span)),
        };
        (value, negated)
    }

    /// Nets that the pins of a new element feed: `out => wire#w1`.
    pub(super) fn feed_from_pins(&mut self, element: usize) {
        for (pin, given) in self.graph.elements[element].pins.iter().enumerate() {
            if let (true, PinValue::Net(net)) = (given.output, &given.value) {
                self.nets.add_source(*net, Source::Pin { element, pin });
            }
        }
    }

    fn report_twice(&mut self, name: &str, first: Span, second: Span) {
        self.report(
            Diagnostic::new(Code::DuplicateParameter, second, format!("the pin `{name}` appears twice"))
                .label("a second time")
                .also(first, "first given here")
                .help("remove one of them"),
        );
    }

    /// Whether the text is the name of a pin that the rung connects, alone: `EN`, `IN` of a timer.
    fn is_flow(&self, row: &Row, span: Span) -> bool {
        let text = self.slice(span);
        [row.flow.0, row.flow.1, "en", "eno"].iter().any(|pin| text.eq_ignore_ascii_case(pin))
    }

    fn report_flow(&mut self, row: &Row, span: Span) {
        let text = self.slice(span);
        let title = format!("`{text}` of `{}` is connected by the rung", row.name);
        let help = format!("remove `{text}`: the element has the wire before it at this pin");
        self.report(Diagnostic::new(Code::Syntax, span, title).label("not an operand").help(help));
    }

    fn report_surplus(&mut self, row: &Row, span: Span) {
        // `%I0,1`: that `%I0` is not an address is reported.
        let ends_before = |told: &&Diagnostic| told.primary.span.end + 1 == span.start;
        let told = self.diagnostics.last().filter(|told| told.code == Code::AddressRange).filter(ends_before);
        if let Some(address) = told.map(|told| told.primary.span) {
            let help = format!("write `{}.{}`", self.slice(address), self.slice(span));
            if let Some(message) = self.diagnostics.last_mut() {
                message.help = Some(help);
            }
            return;
        }
        let help = match (row.kind, self.language) {
            (Kind::Not, Language::Lad) => {
                format!("write `I_Contact( {} )`, which is closed while its operand is 0", self.slice(span))
            }
            _ => "remove it, or write the pin's name before it: `pin := operand`".to_owned(),
        };
        self.report(
            Diagnostic::new(Code::UnknownParameter, span, format!("`{}` has no further operand", row.name))
                .label("belongs to no pin")
                .help(help),
        );
    }

    /// `A( #a, #b )`; `is_led`: the rung brings the first input.
    fn report_unnamed_of_gate(&mut self, row: &Row, is_led: bool, arguments: &[Argument]) {
        let first = if is_led { 2 } else { 1 };
        let pins =
            arguments.iter().zip(first..).map(|(argument, at)| format!("in{at} := {}", self.slice(argument.span)));
        let help = format!("write `{}( {} )`", row.name, pins.collect::<Vec<_>>().join(", "));
        let span = arguments[0].span.to(arguments[arguments.len() - 1].span);
        self.report(
            Diagnostic::new(Code::Syntax, span, format!("the inputs of `{}` have names", row.name))
                .label("operands without them")
                .help(help),
        );
    }

    fn report_unnamed(&mut self, span: Span) {
        self.report(
            Diagnostic::new(Code::Syntax, span, "the pins of a call have names")
                .label("which pin is meant?")
                .help("write `pin := operand` for inputs and `pin => operand` for outputs"),
        );
    }
}
