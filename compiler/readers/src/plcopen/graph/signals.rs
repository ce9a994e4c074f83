//! The sources of the pins of elements: lines as nets, and the order of pins.

use std::collections::HashSet;

use plcc_diag::{Code, Diagnostic, Span};

use super::super::objects::{Connection, Edge, Kind, Object};
use super::{Build, DEPTH_MAX, Origin, pin};
use plcc_syntax::ast::{TypeKind, TypeRef};
use plcc_syntax::network::ast::{Graph, NetId, Pin, PinValue, Source, Target};
use plcc_syntax::network::elements;
use plcc_syntax::scl::ast::{Expr, ExprKind, Name, NameForm};

impl Build<'_, '_, '_> {
    /// The value of an input, with an edge before it if it has one.
    pub(super) fn input(&mut self, input: Option<&Connection>, span: Span) -> PinValue {
        let Some(input) = input.filter(|input| !input.is_open()) else { return PinValue::Open };
        // What it is connected to is not known: the rail stands for it, so that there is no second message.
        let origins = if input.lost { vec![Origin::Rail] } else { self.sources(input) };
        let value = match origins.as_slice() {
            [] => PinValue::Open,
            [Origin::Operand(value, negated)] if !*negated && (input.in_out || input.modifiers.edge == Edge::None) => {
                PinValue::Operand(value.clone())
            }
            _ => PinValue::Net(self.net(origins, span)),
        };
        let row = match input.modifiers.edge {
            Edge::None => return value,
            Edge::Rising => "P_Trig",
            Edge::Falling => "N_Trig",
        };
        let Some(bit) = self.hidden("edge", span) else { return value };
        let Some(target) = self.row(row) else { return value };
        let pins = vec![pin("in", value, false, span), pin("bit", PinValue::Operand(bit), false, span)];
        let element = self.element(None, target, pins, span);
        PinValue::Net(self.net(vec![Origin::Pin(element, "out".to_string())], span))
    }

    /// What feeds a connection: its lines, or its expression.
    pub(super) fn sources(&mut self, input: &Connection) -> Vec<Origin> {
        match input.text.clone().filter(|_| input.from.is_empty()) {
            Some(range) => vec![Origin::Operand(self.expr(range), false)],
            None => self.origins(&input.from, 0),
        }
    }

    /// What feeds the ends of lines.
    pub(super) fn origins(&mut self, from: &[(usize, String)], depth: usize) -> Vec<Origin> {
        if depth == 0 {
            self.passed.clear();
        }
        let mut found = Vec::new();
        for (at, formal) in from {
            for origin in self.origin(*at, formal, depth) {
                if !found.contains(&origin) {
                    found.push(origin);
                }
            }
        }
        found
    }

    fn origin(&mut self, at: usize, formal: &str, depth: usize) -> Vec<Origin> {
        let object = &self.objects[at];
        match object.kind {
            Kind::LeftRail => vec![Origin::Rail],
            Kind::InVariable | Kind::InOutVariable => match object.text.clone() {
                Some(_) if object.modifiers.edge != Edge::None => {
                    let span = object.span;
                    self.reader.unreadable(span, "an edge at a variable", "connect an R_TRIG or F_TRIG after it");
                    Vec::new()
                }
                Some(range) => vec![Origin::Operand(self.expr(range), object.modifiers.negated)],
                None => Vec::new(),
            },
            Kind::Continuation => {
                let connector = |other: &Object| other.kind == Kind::Connector && other.name == object.name;
                match self.objects.iter().position(connector).filter(|_| depth < DEPTH_MAX) {
                    Some(connector) => self.passed_on(connector, "", depth),
                    None => {
                        let text = format!("no connector of the network is called `{}`", object.name);
                        let message = Diagnostic::new(Code::NoSource, object.span, text);
                        self.reader.messages.push(message.help("give the continuation the name of a connector"));
                        Vec::new()
                    }
                }
            }
            Kind::Connector if depth < DEPTH_MAX => self.passed_on(at, "", depth),
            Kind::Connector => Vec::new(),
            Kind::Contact | Kind::Coil => self.made_pin(at, "out"),
            Kind::Block => {
                // A line from the only output needs no name.
                let first = object.outputs.iter().find(|output| !output.formal.eq_ignore_ascii_case("ENO"));
                let formal = match (formal, first) {
                    ("", Some(first)) => first.formal.clone(),
                    _ => formal.to_string(),
                };
                // The variable before an in-out is also after it.
                let passed = |input: &&Connection| input.in_out && input.formal.eq_ignore_ascii_case(&formal);
                match object.inputs.iter().any(|input| passed(&input)) && depth < DEPTH_MAX {
                    true => self.passed_on(at, &formal, depth),
                    false => self.made_pin(at, &formal),
                }
            }
            Kind::OutVariable | Kind::Label | Kind::Jump | Kind::Return | Kind::Condition => Vec::new(),
        }
    }

    /// What feeds an input that passes its signal on: of a connector, or in and out of a block. Each is followed once; one that leads back
    /// to itself has no signal.
    fn passed_on(&mut self, at: usize, formal: &str, depth: usize) -> Vec<Origin> {
        let key = (at, formal.to_ascii_lowercase());
        if let Some(known) = self.passed.get(&key) {
            return known.clone();
        }
        self.passed.insert(key.clone(), Vec::new());
        let objects = self.objects;
        let input = objects[at].inputs.iter().find(|input| input.formal.eq_ignore_ascii_case(formal));
        let input = input.or(objects[at].inputs.first().filter(|_| formal.is_empty()));
        let found = input.map_or(Vec::new(), |input| self.origins(&input.from, depth + 1));
        self.passed.insert(key, found.clone());
        found
    }

    /// An output of an object that has run; otherwise its value of the last cycle.
    fn made_pin(&mut self, at: usize, formal: &str) -> Vec<Origin> {
        let object = &self.objects[at];
        if let Some(element) = self.made.get(&at).copied() {
            return match self.complex_output(at, formal).filter(|_| !self.direct) {
                Some(ty) => vec![self.carried(at, element, formal, ty)],
                None => vec![Origin::Pin(element, formal.to_string())],
            };
        }
        let flip_flop = ["SR", "RS"].iter().any(|name| object.name.eq_ignore_ascii_case(name));
        if let Some(range) = object.instance.clone() {
            let base = self.expr(range);
            let span = object.span;
            let member = Name { text: formal.to_string(), form: NameForm::Bare, span };
            let kind = ExprKind::Member { base: Box::new(base.clone()), name: member };
            let negated = object.outputs.iter().any(|pin| pin.formal == formal && pin.modifiers.negated);
            return vec![Origin::Operand(if flip_flop { base } else { Expr { kind, span } }, negated)];
        }
        let key = (at, formal.to_string());
        if let Some(known) = self.kept.get(&key) {
            return vec![Origin::Operand(known.clone(), false)];
        }
        let boolean = object.kind != Kind::Block
            || elements::find_open(&object.name).is_some_and(|row| {
                matches!(row.kind, elements::Kind::Gate(_) | elements::Kind::Not | elements::Kind::Compare(_))
            });
        if !boolean {
            let text = format!("the output of `{}` is connected to its own inputs", object.name);
            let message = Diagnostic::new(Code::ReverseFlow, object.span, text);
            let help = "write the output to a variable and read that one: it has the value of the last cycle";
            self.reader.messages.push(message.label("its value of the last cycle is not known").help(help));
            return Vec::new();
        }
        let Some(hidden) = self.hidden("loop", object.span) else { return Vec::new() };
        self.kept.insert(key, hidden.clone());
        vec![Origin::Operand(hidden, false)]
    }

    /// The type of an output that no net can carry: a text or a structure.
    fn complex_output(&mut self, at: usize, formal: &str) -> Option<TypeRef> {
        let object = &self.objects[at];
        if object.kind != Kind::Block || formal.eq_ignore_ascii_case("ENO") {
            return None;
        }
        let name = object.name.to_lowercase();
        if self.reader.pous.contains(&name) {
            let output = formal.to_lowercase();
            let of_function = (name.clone(), String::new());
            let known = self.reader.complex.get(&(name, output)).or_else(|| self.reader.complex.get(&of_function))?;
            let known = *known;
            return self.reader.type_of(known, 0);
        }
        let text = TypeRef { kind: TypeKind::String(None), span: object.span };
        self.is_text(at, &mut HashSet::new()).then_some(text)
    }

    /// A standard block whose output is a text.
    fn is_text(&self, at: usize, seen: &mut HashSet<usize>) -> bool {
        const TEXT: [&str; 7] = ["CONCAT", "LEFT", "RIGHT", "MID", "INSERT", "DELETE", "REPLACE"];
        const ANY: [&str; 6] = ["SEL", "MUX", "MOVE", "LIMIT", "MIN", "MAX"];
        let object = &self.objects[at];
        let upper = object.name.to_ascii_uppercase();
        if TEXT.contains(&upper.as_str()) || upper.ends_with("_TO_STRING") {
            return true;
        }
        let mut is_text = |from: usize| {
            let other = &self.objects[from];
            match other.kind {
                Kind::Block => seen.len() < DEPTH_MAX && seen.insert(from) && self.is_text(from, seen),
                _ => {
                    let text = other.text.clone().and_then(|range| self.reader.overlay.get(range)).unwrap_or_default();
                    let ty = self.body.scope.types.get(&text.trim().to_lowercase());
                    text.trim_start().starts_with('\'') || ty.is_some_and(|ty| ty == "STRING")
                }
            }
        };
        let lines = object.inputs.iter().flat_map(|input| &input.from);
        ANY.contains(&upper.as_str()) && lines.into_iter().any(|(from, _)| is_text(*from))
    }

    /// An output that no net can carry: kept in temporary data, or read from the instance.
    fn carried(&mut self, at: usize, element: usize, formal: &str, ty: TypeRef) -> Origin {
        let object = &self.objects[at];
        let span = object.span;
        if let Some(range) = object.instance.clone() {
            let base = Box::new(self.expr(range));
            let member = Name { text: formal.to_string(), form: NameForm::Bare, span };
            return Origin::Operand(Expr { kind: ExprKind::Member { base, name: member }, span }, false);
        }
        let key = (at, formal.to_string());
        if let Some(known) = self.carried.get(&key) {
            return Origin::Operand(known.clone(), false);
        }
        let variable = super::name(self.body.temporary_variable(ty, span), NameForm::Local, span);
        let canonical = self.output_name(element, formal, span);
        let output = pin(&canonical, PinValue::Operand(variable.clone()), true, span);
        self.graph.elements[element].pins.push(output);
        self.carried.insert(key, variable.clone());
        Origin::Operand(variable, false)
    }

    /// Keeps signals that are read before they are computed for the next cycle.
    pub(super) fn keep(&mut self) {
        let mut kept: Vec<((usize, String), Expr)> = std::mem::take(&mut self.kept).into_iter().collect();
        kept.sort_by_key(|((at, _), _)| *at);
        for ((at, formal), hidden) in kept {
            let Some(element) = self.made.get(&at).copied() else { continue };
            let span = self.objects[at].span;
            let net = self.net(vec![Origin::Pin(element, formal)], span);
            let pins =
                vec![pin("in", PinValue::Net(net), false, span), pin("operand", PinValue::Operand(hidden), true, span)];
            if let Some(target) = self.row("Coil") {
                self.element(None, target, pins, span);
            }
        }
    }

    /// The net that these feed.
    pub(super) fn net(&mut self, origins: Vec<Origin>, span: Span) -> NetId {
        if let Some((_, id)) = self.nets.iter().find(|(known, _)| *known == origins) {
            return *id;
        }
        let id = self.graph.add_net("", span);
        for origin in &origins {
            let source = match origin {
                Origin::Rail => Source::Rail,
                Origin::Operand(value, negated) => Source::Operand { value: value.clone(), negated: *negated },
                Origin::Pin(element, formal) => {
                    let canonical = self.output_name(*element, formal, span);
                    let mut output = pin(&canonical, PinValue::Net(id), true, span);
                    output.negated = self.negated_output(*element, formal);
                    let Some(from) = self.graph.elements.get_mut(*element) else { continue };
                    from.pins.push(output);
                    Source::Pin { element: *element, pin: from.pins.len() - 1 }
                }
            };
            if let Some(net) = self.graph.nets.get_mut(id.0 as usize) {
                net.sources.push(source);
            }
        }
        self.nets.push((origins, id));
        id
    }

    /// Puts the pins of each element into their order: the flow first, then as in the table, the flow out last.
    pub(super) fn finish(mut self) -> Graph {
        let mut moved: Vec<Vec<usize>> = Vec::new();
        for element in &mut self.graph.elements {
            let (flow, row) = match &element.target {
                Target::Element { row, .. } => (row.flow, Some(*row)),
                Target::Block { .. } => (("en", "eno"), None),
            };
            let place = |pin: &Pin| {
                let known = row.and_then(|row| row.pins().position(|known| known.matches(&pin.name).is_some()));
                let last = pin.name.eq_ignore_ascii_case(flow.1) && matches!(pin.value, PinValue::Net(_));
                (!pin.name.eq_ignore_ascii_case(flow.0), last, known.unwrap_or(usize::from(pin.output)))
            };
            let mut order: Vec<usize> = (0..element.pins.len()).collect();
            order.sort_by_key(|at| place(&element.pins[*at]));
            let mut to = vec![0; order.len()];
            order.iter().enumerate().for_each(|(new, old)| to[*old] = new);
            element.pins = order.iter().map(|at| element.pins[*at].clone()).collect();
            moved.push(to);
        }
        for source in self.graph.nets.iter_mut().flat_map(|net| &mut net.sources) {
            if let Source::Pin { element, pin } = source
                && let Some(to) = moved.get(*element).and_then(|to| to.get(*pin))
            {
                *pin = *to;
            }
        }
        self.graph
    }
}
