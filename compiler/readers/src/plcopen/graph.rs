//! Objects of a network as elements and nets.

mod floats;
mod instances;
mod places;
mod signals;
mod variables;

use std::collections::HashMap;
use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_literal::distance::nearest;

use super::functions;
use super::objects::{Connection, Edge, Kind, Object};
use super::types::Ty;
use super::{Body, Reader};
use plcc_syntax::Elementary;
use plcc_syntax::network::ast::{Element, Eno, Graph, NetId, Pin, PinValue, Storage, Target, Template, TemplateKey};
use plcc_syntax::network::elements::{self, PinDirection, Row};
use plcc_syntax::scl::ast::{Argument, Expr, ExprKind, Name, NameForm};
use plcc_syntax::scl::fragment;
use variables::words;

/// Most connectors in a chain of connectors.
const DEPTH_MAX: usize = 64;

/// The table row of standard functions that are formulas.
const FORMULA: &str = "function of IEC 61131-3";

/// Where a signal comes from.
#[derive(Clone, Debug, PartialEq)]
enum Origin {
    Rail,
    /// A pin of an element, by its name in the file.
    Pin(usize, String),
    Operand(Expr, bool),
}

/// A network that is being built.
pub struct Build<'r, 'a, 'b> {
    reader: &'r mut Reader<'a>,
    body: &'b mut Body,
    objects: &'r [Object],
    graph: Graph,
    /// The element of each object.
    made: HashMap<usize, usize>,
    /// The objects of an element.
    sources: HashMap<usize, Vec<usize>>,
    /// Nets by their sources.
    nets: Vec<(Vec<Origin>, NetId)>,
    /// Variables that keep a signal for the next cycle, by the object and the pin that it comes from.
    kept: HashMap<(usize, String), Expr>,
    /// Variables for outputs that no net can carry, by object and pin.
    carried: HashMap<(usize, String), Expr>,
    /// The signals of connectors and in-outs while one input is followed.
    passed: HashMap<(usize, String), Vec<Origin>>,
    /// The line that is being followed leads to a variable, which may have any type.
    direct: bool,
    /// The last element that names each variable, by words in lower case.
    named: HashMap<String, usize>,
    /// The variables that outputs of an element write themselves: the element, and the variable in lower case.
    written: Vec<(usize, String)>,
}

/// The graph of the objects `order`, which run in this order.
pub fn build(reader: &mut Reader, body: &mut Body, objects: &[Object], order: &[usize]) -> Graph {
    let mut build = Build {
        reader,
        body,
        objects,
        graph: Graph::default(),
        made: HashMap::new(),
        sources: HashMap::new(),
        nets: Vec::new(),
        kept: HashMap::new(),
        carried: HashMap::new(),
        passed: HashMap::new(),
        direct: false,
        named: HashMap::new(),
        written: Vec::new(),
    };
    for at in order {
        build.object(*at);
    }
    build.keep();
    build.finish()
}

fn name(text: impl Into<String>, form: NameForm, span: Span) -> Expr {
    Expr { kind: ExprKind::Name(Name { text: text.into(), form, span }), span }
}

fn pin(name: &str, value: PinValue, output: bool, span: Span) -> Pin {
    Pin { name: name.to_string(), value, negated: false, output, storage: Storage::None, span }
}

impl Build<'_, '_, '_> {
    fn object(&mut self, at: usize) {
        let object = &self.objects[at];
        match object.kind {
            Kind::Contact => self.contact(at, object),
            Kind::Coil => self.coil(at, object),
            Kind::Block => self.block(at, object),
            Kind::OutVariable | Kind::InOutVariable => self.out_variable(at, object),
            Kind::Jump | Kind::Return => self.leave(at, object),
            Kind::Condition => self.condition(at, object),
            Kind::LeftRail | Kind::InVariable | Kind::Label | Kind::Connector | Kind::Continuation => {}
        }
    }

    fn element(&mut self, at: Option<usize>, target: Target, pins: Vec<Pin>, span: Span) -> usize {
        let (templates, equation, cases) = (Vec::new(), None, Vec::new());
        self.graph.elements.push(Element { target, templates, eno: Eno::Default, pins, equation, cases, span });
        let index = self.graph.elements.len() - 1;
        if let Some(at) = at {
            self.made.insert(at, index);
            self.sources.entry(index).or_default().push(at);
        }
        index
    }

    fn row(&mut self, name: &str) -> Option<Target> {
        elements::find_sd(name).map(|(row, _)| Target::Element { row, instance: None })
    }

    /// The expression in a part of the file.
    fn expr(&mut self, range: Range<usize>) -> Expr {
        let next = self.graph.elements.len();
        for word in words(self.reader.overlay.get(range.clone()).unwrap_or_default()) {
            self.named.insert(word, next);
        }
        self.reader.expression(range, Some(&self.body.scope))
    }

    /// The operand of a contact, coil or variable.
    fn operand(&mut self, object: &Object) -> PinValue {
        match object.text.clone() {
            Some(range) => PinValue::Operand(self.expr(range)),
            None => PinValue::Open,
        }
    }

    /// A BOOL of the instance that keeps a signal from cycle to cycle.
    fn hidden(&mut self, stem: &str, span: Span) -> Option<Expr> {
        if self.body.is_function {
            let text = "a function cannot store an edge or the signal of the last cycle";
            let mut message = Diagnostic::new(Code::EdgeBit, span, text);
            message.severity = Severity::Error;
            let help = "make the POU a function block, or pass it the signal of the last cycle as a parameter";
            self.reader.messages.push(message.label("needs a BOOL that outlives the call").help(help));
            return None;
        }
        Some(name(self.body.hidden_name(stem, span), NameForm::Local, span))
    }

    fn contact(&mut self, at: usize, object: &Object) {
        let operand = self.operand(object);
        let value = self.input(object.inputs.first(), object.span);
        let negated = object.modifiers.negated;
        let mut pins = vec![pin("in", value, false, object.span), pin("operand", operand, false, object.span)];
        pins[1].negated = negated;
        let (row, span) = (edge_name(object.modifiers.edge, "Contact", "P_Contact", "N_Contact"), object.span);
        if object.modifiers.edge != Edge::None {
            let Some(bit) = self.hidden("edge", span) else { return };
            pins[0].name = "pre".to_string();
            pins.push(pin("bit", PinValue::Operand(bit), false, span));
        }
        if let Some(target) = self.row(row) {
            self.element(Some(at), target, pins, span);
        }
    }

    fn coil(&mut self, at: usize, object: &Object) {
        let operand = self.operand(object);
        let value = self.input(object.inputs.first(), object.span);
        let span = object.span;
        let mut pins = vec![pin("in", value, false, span), pin("operand", operand, true, span)];
        let row = match (object.modifiers.edge, object.modifiers.storage) {
            (Edge::None, Storage::None) => "Coil",
            (Edge::None, Storage::Set) => "S_Coil",
            (Edge::None, Storage::Reset) => "R_Coil",
            (Edge::Rising, _) => "P_Coil",
            (Edge::Falling, _) => "N_Coil",
        };
        pins[1].negated = object.modifiers.negated && row == "Coil";
        if object.modifiers.edge != Edge::None {
            let Some(bit) = self.hidden("edge", span) else { return };
            pins.push(pin("bit", PinValue::Operand(bit), false, span));
        }
        if let Some(target) = self.row(row) {
            self.element(Some(at), target, pins, span);
        }
    }

    fn condition(&mut self, at: usize, object: &Object) {
        let mut pins = vec![pin("in", self.input(object.inputs.first(), object.span), false, object.span)];
        pins[0].negated = object.modifiers.negated;
        if let Some(target) = self.row("ConditionCoil") {
            self.element(Some(at), target, pins, object.span);
        }
    }

    fn leave(&mut self, at: usize, object: &Object) {
        let row = match (object.kind, object.modifiers.negated) {
            (Kind::Return, _) => "ReturnCoil",
            (_, false) => "JumpCoil",
            (_, true) => "I_JumpCoil",
        };
        let mut pins = Vec::new();
        if object.inputs.first().is_some_and(|input| !input.is_open()) {
            let mut condition = pin("in", self.input(object.inputs.first(), object.span), false, object.span);
            condition.negated = object.kind == Kind::Return && object.modifiers.negated;
            pins.push(condition);
        }
        if object.kind == Kind::Jump {
            let label = match object.name.as_str() {
                "" => PinValue::Open,
                label => PinValue::Operand(name(label, NameForm::Bare, object.span)),
            };
            pins.push(pin("label", label, false, object.span));
        }
        if let Some(target) = self.row(row) {
            self.element(Some(at), target, pins, object.span);
        }
    }

    /// Reports a pin that a block does not have; returns the one that a misspelt name means. `missing`: the only pin without a line.
    fn unknown_pin(
        &mut self,
        target: &Target,
        (formal, missing): (&str, Option<&str>),
        block: &str,
        output: bool,
        span: Span,
    ) -> Option<String> {
        let Target::Element { row, .. } = target else { return None };
        let on_side = |pin: &elements::PinRow| (pin.direction == PinDirection::Output) == output;
        let known: Vec<&str> = row.pins().filter(on_side).map(|pin| pin.name()).collect();
        let meant = nearest(formal, known.iter().copied()).or(missing);
        let side = if output { "output" } else { "input" };
        let help = match meant {
            Some(meant) => format!("is `{}` meant?", meant.to_uppercase()),
            None => format!("its {side}s are {}", known.join(", ").to_uppercase()),
        };
        let message = Diagnostic::new(Code::UnknownParameter, span, format!("`{block}` has no {side} `{formal}`"));
        self.reader.messages.push(message.label("no pin of this block has this name").help(help));
        meant.map(str::to_string)
    }

    fn block(&mut self, at: usize, object: &Object) {
        let instance = object.instance.clone().map(|range| self.expr(range));
        let span = object.span;
        let mut templates = Vec::new();
        let editor = self.reader.editor;
        // Blocks of the library have the pin names of the project.
        let block = self.reader.pous.contains(&object.name.to_lowercase())
            || object.instance.is_some() && functions::block(editor, &object.name).is_some();
        let open = if block { None } else { elements::find_open(&object.name) };
        let formula = if block || open.is_some() { None } else { self.formula(object) };
        let conversion = if block || formula.is_some() { None } else { conversion(&object.name) };
        let row = match &conversion {
            Some((_, _, row)) => elements::find_sd(row).map(|(row, _)| row),
            None if formula.is_some() => elements::find_sd(FORMULA).map(|(row, _)| row),
            None => open.map(|row| self.word_gate(object).unwrap_or(row)),
        };
        if let Some((from, to, _)) = conversion {
            let template = |key, ty: Elementary| Template { key, value: ty.name().to_string(), span };
            templates.push(template(TemplateKey::Source, from));
            templates.push(template(TemplateKey::Destination, to));
        }
        let flip_flop = row.is_some_and(|row| matches!(row.kind, elements::Kind::FlipFlop { .. }));
        let target = match row {
            Some(row) => Target::Element { row, instance: instance.clone().filter(|_| !flip_flop) },
            None => {
                self.check_instance(object);
                let callee = instance.clone().unwrap_or_else(|| name(object.name.clone(), NameForm::Bare, span));
                Target::Block { callee, instance: None }
            }
        };
        let compared = row.is_some_and(|row| matches!(row.kind, elements::Kind::Compare(op) if op != "<>"));
        let (mut pins, mut further) = (Vec::new(), Vec::new());
        let missing = row.and_then(|row| only_missing(row, &target, &object.inputs));
        let placed = row.filter(|row| places::are_inputs(row, &object.inputs));
        let floats = self.floats(at, object, block);
        for ((number, input), float) in places::numbered(&object.inputs).zip(&floats) {
            if input.is_open() {
                continue;
            }
            if compared && further_operand(&input.formal) {
                further.push(input);
                continue;
            }
            let at_place = placed.and_then(|row| places::input(row, &input.formal));
            let Some(canonical) = at_place.or_else(|| pin_name(&target, &input.formal, false, number)).or_else(|| {
                let formal = (input.formal.as_str(), missing.as_deref());
                self.unknown_pin(&target, formal, &object.name, false, input.span)
            }) else {
                continue;
            };
            let value = self.input(Some(input), input.span);
            let value = self.as_float(value, input, float.as_ref());
            let mut connected = pin(&canonical, value, false, input.span);
            connected.negated = input.modifiers.negated;
            pins.push(connected);
        }
        for pin in object.inputs.iter().chain(&object.outputs).filter(|pin| pin.modifiers.storage != Storage::None) {
            self.reader.unreadable(pin.span, "a pin that sets or resets", "connect a coil that sets or resets");
        }
        for pin in object.outputs.iter().filter(|pin| pin.modifiers.edge != Edge::None) {
            self.reader.unreadable(pin.span, "an edge at an output", "connect an R_TRIG or F_TRIG after it");
        }
        if let (true, Some(state)) = (flip_flop, instance) {
            pins.push(pin("operand", PinValue::Operand(state), false, span));
        }
        let last = pins.iter().find(|pin| pin.name == "in2").cloned();
        let element = self.element(Some(at), target, pins, span);
        self.graph.elements[element].templates = templates;
        self.graph.elements[element].equation = formula;
        if let (Some(last), Some(row)) = (last, row) {
            self.compare_on(at, row, last, further);
        }
    }

    /// A standard function that SCL expresses in another way, over the inputs `in1`, `in2` ….
    fn formula(&mut self, object: &Object) -> Option<Expr> {
        let inputs = object.inputs.iter().filter(|input| !input.formal.eq_ignore_ascii_case("EN") && !input.is_open());
        let argument = |(at, input): (usize, &Connection)| {
            let digits = input.formal.to_ascii_uppercase();
            let number = digits.strip_prefix("IN").and_then(|digits| digits.parse().ok()).unwrap_or(at + 1);
            let value = Some(name(format!("in{number}"), NameForm::Bare, object.span));
            Argument { name: None, output: false, value, span: object.span }
        };
        let arguments: Vec<Argument> = inputs.clone().enumerate().map(argument).collect();
        let kinds: Vec<Option<Ty>> = inputs.map(|input| self.kind(input)).collect();
        let called = Name { text: object.name.clone(), form: NameForm::Bare, span: object.span };
        let messages = &mut self.reader.messages;
        let mut tell = |message| messages.push(message);
        let kind = functions::rewritten(self.reader.editor, &called, &arguments, &kinds, object.span, &mut tell)?;
        Some(Expr { kind, span: object.span })
    }

    /// The type of the signal at an input, if a variable or a function with a known result feeds it.
    fn kind(&self, input: &Connection) -> Option<Ty> {
        let text = match (input.from.as_slice(), input.text.clone()) {
            ([], text) => text,
            ([(from, formal)], _) => {
                let object = &self.objects[*from];
                if object.kind == Kind::Block {
                    let types = &self.body.scope.shared.types;
                    let upper = object.name.to_ascii_uppercase();
                    let named = Ty::Named(object.name.to_lowercase());
                    return types.member(&named, &formal.to_lowercase()).or_else(|| types.result(&upper, &[]));
                }
                object.text.clone()
            }
            _ => None,
        }?;
        self.type_of(text)
    }

    /// The type of the expression in a part of the file, as far as it is known.
    fn type_of(&self, text: Range<usize>) -> Option<Ty> {
        let (mut value, _) = fragment::iec_expression(self.reader.file, &self.reader.overlay, text, self.reader.iec());
        let scope = &self.body.scope;
        // Errors in it are reported where it is read.
        let told = std::mem::take(&mut *scope.messages.borrow_mut());
        let kind = scope.typed(&mut value);
        *scope.messages.borrow_mut() = told;
        kind
    }

    /// A comparison of more than two values: each with the next one.
    fn compare_on(&mut self, at: usize, row: &'static Row, mut last: Pin, further: Vec<&Connection>) {
        for input in further {
            let Some(before) = self.made.get(&at).copied() else { return };
            let flow = PinValue::Net(self.net(vec![Origin::Pin(before, "out".to_string())], input.span));
            let mut next = pin("in2", self.input(Some(input), input.span), false, input.span);
            next.negated = input.modifiers.negated;
            last.name = "in1".to_string();
            let pins = vec![pin("pre", flow, false, input.span), last, next.clone()];
            self.element(Some(at), Target::Element { row, instance: None }, pins, input.span);
            last = next;
        }
    }

    /// AND, OR, XOR and NOT of words, when a declared variable at an input is a word.
    fn word_gate(&self, object: &Object) -> Option<&'static Row> {
        let word = match object.name.to_ascii_uppercase().as_str() {
            "AND" => "And",
            "OR" => "Or",
            "XOR" => "Xor",
            "NOT" => "Inv",
            _ => return None,
        };
        let is_word = |at: &usize| {
            let text = self.objects[*at].text.clone().and_then(|range| self.reader.overlay.get(range));
            text.is_some_and(|text| self.body.words.contains(&text.trim().to_lowercase()) || is_word_constant(text))
        };
        let mut inputs = object.inputs.iter().flat_map(|input| &input.from).map(|(at, _)| at);
        inputs.any(is_word).then(|| elements::find_sd(word).map(|(row, _)| row))?
    }
}

/// `WORD#16#F`, or a number that is not a BOOL, `16#FF0F`.
fn is_word_constant(text: &str) -> bool {
    let text = text.trim().to_ascii_uppercase();
    if ["BYTE#", "WORD#", "DWORD#", "LWORD#"].iter().any(|word| text.starts_with(word)) {
        return true;
    }
    let digits = text.replace('_', "");
    let number = match digits.split_once('#') {
        Some(("2", digits)) => u64::from_str_radix(digits, 2),
        Some(("8", digits)) => u64::from_str_radix(digits, 8),
        Some(("16", digits)) => u64::from_str_radix(digits, 16),
        Some(_) => return false,
        None => digits.parse(),
    };
    number.is_ok_and(|number| number > 1)
}

/// `IN3` and above.
fn further_operand(formal: &str) -> bool {
    let upper = formal.to_ascii_uppercase();
    upper.strip_prefix("IN").and_then(|number| number.parse::<u32>().ok()).is_some_and(|number| number > 2)
}

fn edge_name(edge: Edge, none: &'static str, rising: &'static str, falling: &'static str) -> &'static str {
    match edge {
        Edge::None => none,
        Edge::Rising => rising,
        Edge::Falling => falling,
    }
}

/// Types and element of `INT_TO_REAL`, `REAL_TRUNC_INT`.
fn conversion(name: &str) -> Option<(Elementary, Elementary, &'static str)> {
    let upper = name.to_ascii_uppercase();
    for (infix, row) in [("_TO_", "Convert"), ("_TRUNC_", "Trunc")] {
        if let Some((from, to)) = upper.split_once(infix) {
            return Some((Elementary::from_word(from)?, Elementary::from_word(to)?, row));
        }
    }
    None
}

/// The input that must have a line and has none, if it is the only one.
fn only_missing(row: &'static Row, target: &Target, inputs: &[Connection]) -> Option<String> {
    let is_given = |pin: &elements::PinRow| {
        let mut names = places::numbered(inputs).map(|(number, input)| pin_name(target, &input.formal, false, number));
        names.any(|name| name.as_deref() == Some(pin.name()))
    };
    let mut open = row.pins().filter(|pin| {
        let of_instance = ["operand", "timer", "counter"].contains(&pin.name());
        pin.direction == PinDirection::Input && !pin.optional && !of_instance && !is_given(pin)
    });
    let only = open.next()?;
    open.next().is_none().then(|| only.name().to_string())
}

/// The name of a pin in the syntax tree; `None`: the element has no such pin. A pin without a name is number `number` on its side.
fn pin_name(target: &Target, formal: &str, output: bool, number: usize) -> Option<String> {
    let Target::Element { row, .. } = target else { return Some(formal.to_string()) };
    let flip_flop = matches!(row.kind, elements::Kind::FlipFlop { .. });
    let formal = if flip_flop { functions::flip_flop_pin(formal) } else { formal };
    let formal = functions::texts::input(row.name, formal).filter(|_| !output).unwrap_or(formal);
    // CODESYS calls the result of a function like the function.
    let result = output && row.name.eq_ignore_ascii_case(formal);
    let on_side = |pin: &elements::PinRow| (pin.direction == PinDirection::Output) == output;
    let known = row.pin(formal).filter(|(pin, _)| on_side(pin)).map(|(_, canonical)| canonical);
    // If an element has one input or output, CODESYS names the pin like the first of several.
    let numbered = if output { "Out1" } else { "In1" };
    if !formal.is_empty() && (known.is_some() || !formal.eq_ignore_ascii_case(numbered) && !result) {
        return known;
    }
    let pins: Vec<elements::PinRow> =
        row.pins().filter(|pin| on_side(pin) && pin.name() != "en" && pin.name() != "eno").collect();
    match pins.iter().find(|pin| pin.numbered).filter(|_| !output) {
        Some(first) => {
            let stem = first.name().trim_end_matches(|c: char| c.is_ascii_digit());
            let base: usize = first.name()[stem.len()..].parse().ok()?;
            Some(format!("{stem}{}", base + number))
        }
        None => pins.get(number).map(|pin| pin.name().to_string()),
    }
}
