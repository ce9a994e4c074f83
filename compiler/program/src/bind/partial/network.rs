//! Uses in networks of LAD and FBD, and in charts.

use plcc_syntax::Elementary;
use plcc_syntax::ast::{self, BlockPrefix, CellKind};
use plcc_syntax::chart::ast as chart;
use plcc_syntax::network::ast::{
    Body, Content, Element, Graph, NetId, Network, Pin, PinValue, Source, Target, TemplateKey,
};
use plcc_syntax::network::elements::{Kind, Row};
use plcc_syntax::scl::ast::{Argument, Expr as Node, ExprKind as NodeKind, Name, NameForm};

use super::evidence::Hint;
use super::look::{Look, Start};
use super::scl::{surest, typed};
use crate::bind::scl::SclBlock;
use crate::bind::scl::function::Named;
use plcc_binding::fold;
use plcc_binding::stand_ins::Missing;
use plcc_model::BlockKey;
use plcc_model::types::DataType;

const BOOL: Hint = typed(Elementary::Bool);
const INT: Hint = Hint::Literal(DataType::Elementary(Elementary::Int));

impl Look<'_, '_> {
    pub fn networks(&mut self, ctx: &mut SclBlock, body: &Body) {
        for network in &body.networks {
            self.network(ctx, network);
        }
    }

    fn network(&mut self, ctx: &mut SclBlock, network: &Network) {
        match &network.content {
            Content::Scl(list) => self.statements(ctx, list),
            Content::Stl(list) => self.list(ctx, list.iter()),
            Content::Graphic(graph) => self.graph(ctx, graph),
        }
    }

    fn graph(&mut self, ctx: &mut SclBlock, graph: &Graph) {
        for net in &graph.nets {
            for source in &net.sources {
                if let Source::Operand { value, .. } = source {
                    let hint = self.net_hint(ctx, graph, net as *const _).unwrap_or(BOOL);
                    self.expect(ctx, value, Some(&hint));
                }
            }
        }
        for element in &graph.elements {
            match &element.target {
                Target::Block { callee, instance } => {
                    self.block_element(ctx, graph, element, callee, instance.as_ref())
                }
                Target::Element { row, instance } => self.row_element(ctx, graph, element, row, instance.as_ref()),
            }
        }
    }

    /// The type that the pins at the end of a net need.
    fn net_hint(
        &mut self,
        ctx: &mut SclBlock,
        graph: &Graph,
        net: *const plcc_syntax::network::ast::Net,
    ) -> Option<Hint> {
        let at = graph.nets.iter().position(|known| std::ptr::eq(known, net))?;
        let id = NetId(u32::try_from(at).ok()?);
        let mut hints = Vec::new();
        for element in &graph.elements {
            let Target::Element { row, .. } = &element.target else { continue };
            if element.pins.iter().any(|pin| !pin.output && pin.value == PinValue::Net(id)) && !is_bit(row) {
                hints.push(self.element_type(ctx, graph, element));
            }
        }
        surest(hints)
    }

    /// The type of an element: from its settings, otherwise from its other operands.
    fn element_type(&mut self, ctx: &mut SclBlock, graph: &Graph, element: &Element) -> Option<Hint> {
        let keys = [TemplateKey::Source, TemplateKey::Value, TemplateKey::Destination, TemplateKey::Time];
        let given = keys.iter().find_map(|key| {
            let word = element.template(*key)?.value.trim().to_ascii_uppercase();
            Elementary::from_word(&word)
        });
        if let Some(ty) = given {
            return Some(typed(ty));
        }
        let mut hints = Vec::new();
        for pin in &element.pins {
            if ["en", "eno", "pre", "operand", "n", "k", "g", "count"].contains(&pin.name.as_str()) {
                continue;
            }
            match &pin.value {
                PinValue::Operand(node) => hints.push(self.hint_of(ctx, node)),
                PinValue::Net(id) => {
                    for source in &graph.net(*id).sources {
                        if let Source::Operand { value, .. } = source {
                            hints.push(self.hint_of(ctx, value));
                        }
                    }
                }
                PinValue::Open => {}
            }
        }
        surest(hints)
    }

    fn row_element(
        &mut self,
        ctx: &mut SclBlock,
        graph: &Graph,
        element: &Element,
        row: &Row,
        instance: Option<&Node>,
    ) {
        let working = self.element_type(ctx, graph, element);
        if let Some(instance) = instance {
            self.system_instance(ctx, row, instance, element);
        }
        for pin in &element.pins {
            let PinValue::Operand(node) = &pin.value else { continue };
            if pin.name == "label" {
                continue;
            }
            let text = if pin.name == "strg" { self.text_of_characters(ctx, element) } else { None };
            let hint = text.or_else(|| pin_hint(row, pin, working.as_ref(), element));
            self.expect(ctx, node, hint.as_ref());
        }
    }

    /// The text at Strg_TO_Chars and Chars_TO_Strg is as wide as the characters.
    fn text_of_characters(&mut self, ctx: &mut SclBlock, element: &Element) -> Option<Hint> {
        let PinValue::Operand(node) = &element.pins.iter().find(|pin| pin.name == "chars")?.value else { return None };
        let Some(Hint::Type(DataType::Array(array))) = self.hint_of(ctx, node) else { return None };
        match array.element {
            DataType::Elementary(Elementary::Char) => Some(Hint::Type(DataType::String(254))),
            DataType::Elementary(Elementary::Wchar) => Some(Hint::Type(DataType::WideString(254))),
            _ => None,
        }
    }

    /// The instance of TON, CTU and similar blocks: a missing one is an instance of that block.
    fn system_instance(&mut self, ctx: &mut SclBlock, row: &Row, instance: &Node, element: &Element) {
        let (Kind::Instance(name) | Kind::TimerCoil(name)) = row.kind else { return };
        if self.hint_of(ctx, instance).is_some() {
            return;
        }
        let Some((start, steps, span)) = self.steps(ctx, instance) else { return };
        let value = element.template(TemplateKey::Value).map(|template| template.value.trim().to_ascii_uppercase());
        let long =
            value.filter(|word| name.starts_with("CT") && word != "INT" && Elementary::from_word(word).is_some());
        let name = long.map_or(name.to_string(), |word| format!("{name}_{word}"));
        let Some((_, of)) = self.block_of_instance(&name) else { return };
        self.with_shape(ctx, &start, &steps, span, &mut |shape| shape.of = Some(of.clone()));
    }

    /// The block of the library with a name such as TON, whose data an instance is.
    pub fn block_of_instance(&self, name: &str) -> Option<(BlockKey, Missing)> {
        let block = plcc_stdlib::find_tia(name).or_else(|| plcc_stdlib::find_name(name))?;
        let key = self.program.globals.library.key_of(block);
        let prefix = crate::bind::globals::names::kind_prefix(key.kind);
        if !matches!(prefix, BlockPrefix::Fb | BlockPrefix::Sfb) {
            return None;
        }
        // No source can name an instruction of the TIA Portal by a number.
        let of = match block.is_tia() {
            true => Missing::name(block.name),
            false => Missing::block(prefix, u32::from(key.number))?,
        };
        Some((key, of))
    }

    fn block_element(
        &mut self,
        ctx: &mut SclBlock,
        graph: &Graph,
        element: &Element,
        callee: &Node,
        instance: Option<&Node>,
    ) {
        let mut arguments = Vec::new();
        let mut wires = Vec::new();
        for pin in &element.pins {
            if ["en", "eno"].iter().any(|known| pin.name.eq_ignore_ascii_case(known)) {
                continue;
            }
            let name = Name { text: pin.name.clone(), form: NameForm::Bare, span: pin.span };
            match &pin.value {
                PinValue::Operand(node) => arguments.push(Argument {
                    name: Some(name),
                    output: pin.output,
                    value: Some(node.clone()),
                    span: pin.span,
                }),
                PinValue::Net(id) => {
                    let hint = self.wire_hint(ctx, graph, *id, pin.output);
                    wires.push((pin.name.clone(), pin.output, hint));
                }
                PinValue::Open => wires.push((pin.name.clone(), pin.output, None)),
            }
        }
        let result = element.pins.iter().any(|pin| pin.output && fold(&pin.name) == "ret_val");
        let inputs: Vec<Argument> = arguments
            .iter()
            .filter(|argument| {
                !(argument.output && argument.name.as_ref().is_some_and(|name| fold(&name.text) == "ret_val"))
            })
            .cloned()
            .collect();
        let value = arguments
            .iter()
            .find(|argument| {
                argument.output && argument.name.as_ref().is_some_and(|name| fold(&name.text) == "ret_val")
            })
            .and_then(|argument| argument.value.clone());
        let call = match instance {
            // The block, and the data block or variable that is its instance.
            Some(instance) => {
                if let NodeKind::Name(name) = &instance.kind
                    && name.form != NameForm::Local
                {
                    let kind = NodeKind::Member { base: Box::new(callee.clone()), name: quoted(name) };
                    Node { kind, span: callee.span }
                } else {
                    self.local_instance(ctx, callee, instance);
                    instance.clone()
                }
            }
            None => callee.clone(),
        };
        let of_value = value.as_ref().and_then(|value| self.hint_of(ctx, value));
        let of_value = match (result, of_value) {
            (true, None) => wires
                .iter()
                .find(|(name, output, _)| *output && fold(name) == "ret_val")
                .and_then(|(_, _, hint)| hint.clone()),
            (_, hint) => hint,
        };
        self.call(ctx, &call, &inputs, of_value.as_ref(), !result || instance.is_some());
        if let Some(value) = value {
            let place = self.steps(ctx, callee).filter(|(_, steps, _)| steps.is_empty());
            let hint = place.and_then(|(start, ..)| self.stated_value(ctx, &start));
            self.expect(ctx, &value, hint.as_ref());
        }
        // Wires have no expressions: the missing block gets their types directly.
        let Some((start, steps, span)) = self.steps(ctx, callee) else { return };
        self.with_shape(ctx, &start, &steps, span, &mut |shape| {
            if shape.call.is_none() {
                return;
            }
            for (name, output, hint) in &wires {
                if fold(name) == "ret_val" {
                    continue;
                }
                shape.formal(name, *output).learn(hint.as_ref());
            }
        });
    }

    /// A static variable as an instance: the type in its declaration is the block of the call.
    fn local_instance(&mut self, ctx: &mut SclBlock, callee: &Node, instance: &Node) {
        if let (Some((start @ (Start::Global(_) | Start::Block(..)), steps, span)), Some(_)) =
            (self.steps(ctx, callee), self.steps(ctx, instance))
            && steps.is_empty()
        {
            self.with_shape(ctx, &start, &[], span, &mut |shape| {
                shape.call.get_or_insert_default().instance = true;
            });
        }
    }

    /// The type on a wire: from what feeds it, or what it feeds.
    fn wire_hint(&mut self, ctx: &mut SclBlock, graph: &Graph, id: NetId, output: bool) -> Option<Hint> {
        if output {
            let mut hints = vec![self.net_hint(ctx, graph, graph.net(id) as *const _)];
            for element in &graph.elements {
                let Target::Element { row, .. } = &element.target else { continue };
                let leads = element.pins.iter().any(|pin| !pin.output && pin.value == PinValue::Net(id));
                hints.push((leads && is_bit(row)).then_some(BOOL));
            }
            return surest(hints);
        }
        let mut hints = Vec::new();
        for source in &graph.net(id).sources {
            hints.push(match source {
                Source::Rail => Some(BOOL),
                Source::Operand { value, .. } => self.hint_of(ctx, value),
                Source::Pin { element, pin } => {
                    let from = &graph.elements[*element];
                    match &from.target {
                        Target::Element { row, .. } if is_bit(row) => Some(BOOL),
                        Target::Element { .. } if from.pins[*pin].name == "eno" => Some(BOOL),
                        Target::Element { row, .. } if matches!(row.kind, Kind::Instance(_)) => {
                            from.pins[*pin].name.starts_with('q').then_some(BOOL)
                        }
                        Target::Element { .. } => self.element_type(ctx, graph, from),
                        Target::Block { .. } => None,
                    }
                }
                Source::Net(_) => None,
            });
        }
        surest(hints)
    }

    // Charts.

    pub fn chart(&mut self, ctx: &mut SclBlock, body: &chart::Body) {
        for permanent in body.before.iter().chain(&body.after) {
            match &permanent.kind {
                chart::PermanentKind::Coil { operand, value, .. } => {
                    self.expect(ctx, operand, Some(&BOOL));
                    self.expect(ctx, value, Some(&BOOL));
                }
                chart::PermanentKind::Call(call) => self.chart_call(ctx, call),
                chart::PermanentKind::Network(network) => self.network(ctx, network),
            }
        }
        for step in &body.steps {
            for condition in step.interlock.iter().chain(&step.supervision) {
                self.condition(ctx, condition);
            }
            for value in step.maximum.iter().chain(&step.warning) {
                self.expect(ctx, value, Some(&typed(Elementary::Time)));
            }
            for action in &step.actions {
                self.action(ctx, action);
            }
        }
        for condition in body.transitions.iter().filter_map(|transition| transition.condition.as_ref()) {
            self.condition(ctx, condition);
        }
    }

    fn condition(&mut self, ctx: &mut SclBlock, condition: &chart::Condition) {
        match condition {
            chart::Condition::Expression(value) => self.expect(ctx, value, Some(&BOOL)),
            chart::Condition::Network(network) => self.network(ctx, network),
            chart::Condition::Statements(list) => {
                self.statements(ctx, list);
            }
        }
    }

    fn action(&mut self, ctx: &mut SclBlock, action: &chart::Action) {
        use chart::Qualifier;
        let cell = match action.qualifier {
            Qualifier::Cs | Qualifier::Cu | Qualifier::Cd | Qualifier::Cr => Some(Hint::Cell(CellKind::Counter)),
            Qualifier::Tl | Qualifier::Td | Qualifier::Tr | Qualifier::Tf => Some(Hint::Cell(CellKind::Timer)),
            Qualifier::N
            | Qualifier::S
            | Qualifier::R
            | Qualifier::D
            | Qualifier::L
            | Qualifier::On
            | Qualifier::Off => None,
        };
        match &action.body {
            chart::ActionBody::Operand(operand) => {
                if !matches!(action.qualifier, Qualifier::On | Qualifier::Off) {
                    self.expect(ctx, operand, Some(&cell.unwrap_or(BOOL)));
                }
            }
            chart::ActionBody::Value { operand, value } => {
                let delayed = matches!(action.qualifier, Qualifier::D | Qualifier::L);
                if let Some(cell) = cell {
                    let ty =
                        if matches!(cell, Hint::Cell(CellKind::Timer)) { Elementary::S5Time } else { Elementary::Word };
                    self.expect(ctx, operand, Some(&cell));
                    self.expect(ctx, value, Some(&typed(ty)));
                } else if delayed {
                    self.expect(ctx, operand, Some(&BOOL));
                    self.expect(ctx, value, Some(&typed(Elementary::Time)));
                } else {
                    let (left, right) = (self.hint_of(ctx, operand), self.hint_of(ctx, value));
                    self.expect(ctx, value, left.as_ref());
                    self.expect(ctx, operand, right.as_ref());
                }
            }
            chart::ActionBody::Call(call) => self.chart_call(ctx, call),
            chart::ActionBody::Statements(list) => self.statements(ctx, list),
            chart::ActionBody::Network(network) => self.network(ctx, network),
            chart::ActionBody::All { .. } | chart::ActionBody::Error => {}
        }
    }

    fn chart_call(&mut self, ctx: &mut SclBlock, call: &chart::Call) {
        let arguments: Vec<Argument> = call
            .parameters
            .iter()
            .map(|parameter| Argument {
                name: Some(parameter.name.clone()),
                output: false,
                value: parameter.value.clone(),
                span: parameter.span,
            })
            .collect();
        let callee = match call.instance.as_ref().map(|instance| &instance.kind) {
            Some(NodeKind::Name(name)) => Node {
                kind: NodeKind::Member { base: Box::new(call.block.clone()), name: quoted(name) },
                span: call.block.span,
            },
            _ => call.block.clone(),
        };
        self.call(ctx, &callee, &arguments, None, true);
    }

    pub fn code(&mut self, ctx: &mut SclBlock, code: &ast::Code) {
        match code {
            ast::Code::Stl(networks) => {
                self.list(ctx, networks.iter().flat_map(|network| &network.statements));
            }
            ast::Code::Scl(body) => self.statements(ctx, &body.statements),
            ast::Code::Graphic(body) => self.networks(ctx, body),
            ast::Code::Chart(body) => self.chart(ctx, body),
        }
    }
}

/// The name of a data block after that of its function block.
fn quoted(name: &Name) -> Name {
    let form = if plcc_syntax::scl::absolute(&name.text).is_some() { name.form } else { NameForm::Quoted };
    Name { form, ..name.clone() }
}

/// True of elements that combine bits.
fn is_bit(row: &Row) -> bool {
    match row.kind {
        Kind::Contact
        | Kind::Not
        | Kind::Gate(_)
        | Kind::EdgeContact { .. }
        | Kind::EdgeTrigger { .. }
        | Kind::Coil
        | Kind::SetCoil
        | Kind::ResetCoil
        | Kind::EdgeCoil { .. }
        | Kind::FlipFlop { .. }
        | Kind::Jump { .. }
        | Kind::Return(_)
        | Kind::Save
        | Kind::Condition => true,
        Kind::BitField { .. }
        | Kind::Compare(_)
        | Kind::Range { .. }
        | Kind::Valid { .. }
        | Kind::Variant(_)
        | Kind::Instance(_)
        | Kind::TimerCoil(_)
        | Kind::ResetTimer
        | Kind::PresetTimer
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
        | Kind::JumpList
        | Kind::Switch
        | Kind::S5Timer(_)
        | Kind::S5Counter(_)
        | Kind::CounterCoil(_)
        | Kind::OpenDb { .. }
        | Kind::Mcr(_)
        | Kind::CallCoil
        | Kind::Flag(_) => false,
    }
}

/// The type that a pin of an element needs.
fn pin_hint(row: &Row, pin: &Pin, working: Option<&Hint>, element: &Element) -> Option<Hint> {
    let template = |key| {
        let word = element.template(key)?.value.trim().to_ascii_uppercase();
        Elementary::from_word(&word).map(typed)
    };
    let name = pin.name.as_str();
    if is_bit(row) || matches!(name, "en" | "eno" | "pre" | "bit") {
        return Some(BOOL);
    }
    match (row.kind, name) {
        (Kind::BitField { .. }, "operand") => Some(BOOL),
        (Kind::BitField { .. }, _) => Some(INT),
        (Kind::S5Timer(_), "timer") => Some(Hint::Cell(CellKind::Timer)),
        (Kind::S5Timer(_), "tv") => Some(typed(Elementary::S5Time)),
        (Kind::S5Timer(_), "bi" | "bcd" | "rt") => Some(typed(Elementary::Word)),
        (Kind::S5Timer(_) | Kind::S5Counter(_), "s" | "r" | "q" | "cu" | "cd" | "out") => Some(BOOL),
        (Kind::S5Counter(_), "counter") => Some(Hint::Cell(CellKind::Counter)),
        (Kind::S5Counter(_), _) => Some(typed(Elementary::Word)),
        (Kind::CounterCoil(_), "operand" | "counter") => Some(Hint::Cell(CellKind::Counter)),
        (Kind::OpenDb { .. }, _) => Some(Hint::DataBlock),
        (Kind::Instance(_), "in" | "r" | "q" | "cu" | "cd" | "ld" | "qu" | "qd" | "clk" | "busy") => Some(BOOL),
        (Kind::Instance(block), "pt" | "et") if block.starts_with('T') => {
            template(TemplateKey::Time).or(Some(typed(Elementary::Time)))
        }
        (Kind::Instance(block), "pv" | "cv") if block.starts_with("CT") => {
            template(TemplateKey::Value).or(Some(typed(Elementary::Int)))
        }
        (Kind::TimerCoil(_) | Kind::PresetTimer, "pt") => Some(typed(Elementary::Time)),
        (Kind::Convert | Kind::Round(_), name) if !name.starts_with("in") => template(TemplateKey::Destination),
        (Kind::Convert, _) => template(TemplateKey::Source),
        (Kind::Round(_), _) => template(TemplateKey::Source).or(Some(typed(Elementary::Real))),
        (Kind::Function("SCALE_X"), "value") => template(TemplateKey::Source).or(Some(typed(Elementary::Real))),
        (Kind::Function("SCALE_X"), _) => template(TemplateKey::Destination).or(Some(typed(Elementary::Real))),
        (Kind::Function("NORM_X"), "out") => template(TemplateKey::Destination).or(Some(typed(Elementary::Real))),
        (_, "n" | "k" | "count") => Some(INT),
        (_, "g") => Some(BOOL),
        (Kind::Compare(_) | Kind::Range { .. }, "out") => Some(BOOL),
        (Kind::Function(function), _) if Named::find(function).is_none() => None,
        _ => working.cloned(),
    }
}
