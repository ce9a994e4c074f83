//! Boxes with functions of the standard, instances, and calls of blocks of the program.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{CodeBlock, Section, SectionKind};
use plcc_syntax::network::ast::{Element, Eno, NetId, Pin, PinValue, Source, TemplateKey};
use plcc_syntax::network::elements::{Kind as RowKind, Row};
use plcc_syntax::scl::ast::{Argument, Expr, ExprKind, Name, NameForm};

use super::{Build, origin, storage};
use crate::plcopen::body::Called;
use crate::plcopen::identifier::identifier;
use crate::plcopen::objects::{Input, Kind, Object, Output, Storage};
use crate::plcopen::system;
use crate::scl::expression;
use crate::to_stl::types::elementary;

impl<'a> Build<'_, '_, 'a, '_, '_> {
    /// Adds a block with these inputs and outputs, and the variables that its outputs write. `outputs`: pins with their names in the file.
    pub(super) fn block(
        &mut self,
        at: usize,
        element: &Element,
        mut object: Object,
        outputs: &[(&Pin, String)],
        has_flow: bool,
    ) {
        let enable = element.pin("en").map(|pin| self.flow(Some(pin)));
        let enable = enable.filter(|from| !from.is_empty());
        let conditional = enable.clone().filter(|from| !self.is_rail(from));
        if let Some(from) = &enable
            && (self.is_ladder || conditional.is_some())
        {
            let input = Input { formal: "EN".to_string(), from: from.clone(), ..Input::default() };
            object.inputs.insert(0, input);
        }
        let eno = element.pin("eno").filter(|pin| !matches!(pin.value, PinValue::Open));
        let follows = element.eno == Eno::Disabled;
        if eno.is_some() && !follows {
            object.outputs.insert(0, Output { formal: "ENO".to_string(), negated: false });
        } else if enable.is_some() && self.is_ladder && !has_flow {
            // The line of a rung goes through the block.
            object.outputs.insert(0, Output { formal: "ENO".to_string(), negated: false });
        }
        for (pin, formal) in outputs {
            if !object.outputs.iter().any(|known| known.formal == *formal) {
                let negated = pin.negated && matches!(pin.value, PinValue::Net(_));
                object.outputs.push(Output { formal: formal.clone(), negated });
            }
        }
        let block = self.add(object);
        for (pin, formal) in outputs {
            match &pin.value {
                PinValue::Operand(value) => {
                    let text = self.body.text(value);
                    let storage = storage(pin);
                    let inputs = vec![Input { from: vec![origin(block, formal)], ..Input::default() }];
                    self.add(Object { inputs, storage, negated: pin.negated, ..Object::new(Kind::OutVariable, text) });
                }
                PinValue::Net(_) => self.set(at, &pin.name, vec![origin(block, formal)]),
                PinValue::Open => {}
            }
        }
        if let Some(pin) = eno {
            let from = match follows {
                true => match enable {
                    Some(from) => from,
                    None => self.rail(),
                },
                false => vec![origin(block, "ENO")],
            };
            match &pin.value {
                PinValue::Operand(value) => {
                    let text = self.body.text(value);
                    self.coil(text, pin.negated, Storage::None, from);
                }
                PinValue::Net(_) => self.set(at, "eno", from),
                PinValue::Open => {}
            }
        }
    }

    /// The inputs of a block in this order: pin of the element, name in the file.
    fn inputs(&mut self, pins: &[(&Pin, String)]) -> Vec<Input> {
        let mut inputs = Vec::new();
        for (pin, formal) in pins {
            let from = self.value(Some(pin));
            if from.is_empty() {
                continue;
            }
            let from = self.joined(from);
            inputs.push(Input { formal: formal.clone(), from, negated: pin.negated, in_out: false });
        }
        inputs
    }

    pub(super) fn instance(&mut self, at: usize, element: &Element, row: &'static Row, instance: Option<&Expr>) {
        let span = element.span;
        let (call, is_coil) = match row.kind {
            RowKind::Instance(name) => (name, false),
            RowKind::TimerCoil(name) => (name, true),
            _ => return,
        };
        let known = system::call_on_data(call).is_some() || matches!(call, "R_TRIG" | "F_TRIG");
        if !known {
            return self.refuse(span, format!("IEC 61131-3 has no function block `{call}`"));
        }
        let instance = match (instance, element.pin("timer").map(|pin| &pin.value)) {
            (Some(instance), _) | (None, Some(PinValue::Operand(instance))) => instance,
            _ => return self.refuse(span, format!("`{call}` without an instance")),
        };
        let Some((text, ty)) = self.instance_of(instance, call, span) else { return };
        if ty != call && ty.split('_').next() != Some(call) {
            return self.refuse(span, format!("an instance of {ty} is called as {call}"));
        }
        let mut inputs: Vec<(&Pin, String)> = Vec::new();
        let mut outputs: Vec<(&Pin, String)> = Vec::new();
        for pin in &element.pins {
            let name = pin.name.to_uppercase();
            match name.as_str() {
                "EN" | "ENO" | "TIMER" => {}
                "OUT" if is_coil => {}
                _ if pin.output => outputs.push((pin, name)),
                _ => inputs.push((pin, name)),
            }
        }
        // The flow is the first line of the block.
        inputs.sort_by_key(|(pin, _)| pin.name != row.flow.0);
        outputs.sort_by_key(|(pin, _)| pin.name != row.flow.1);
        let mut object = Object { instance: Some(text), ..Object::new(Kind::Block, ty) };
        object.inputs = self.inputs(&inputs);
        if is_coil && let Some(first) = object.inputs.first() {
            let from = first.from.clone();
            self.set(at, "out", from);
        }
        self.block(at, element, object, &outputs, true);
    }

    /// The text of an instance, and its type in the file.
    fn instance_of(&mut self, instance: &Expr, call: &str, span: Span) -> Option<(String, String)> {
        // Data of any timer are called by its name.
        let member = Name { text: call.to_string(), form: NameForm::Bare, span };
        let named = Expr { kind: ExprKind::Member { base: Box::new(instance.clone()), name: member }, span };
        let is_data = system::call_on_data(call).is_some();
        match self.body.called(if is_data { &named } else { instance }) {
            Called::Instance { instance, ty, .. } => Some((expression::text(&instance, self.body.writer), ty)),
            Called::Function(..) | Called::System(_) => {
                self.refuse(span, format!("`{call}` needs an instance"));
                None
            }
            Called::Refused => None,
        }
    }

    /// The inputs that an element converts must already have its type.
    pub(super) fn check_types(&mut self, element: &Element, pins: &[&str]) {
        let Some(template) = element.template(TemplateKey::Source).or(element.template(TemplateKey::Value)) else {
            return;
        };
        let Some(wanted) = elementary(&template.value) else { return };
        let mut is_there = false;
        let mut others: Option<String> = None;
        for name in pins {
            let Some(pin) = element.pin(name) else { continue };
            let ty = match &pin.value {
                PinValue::Operand(value) if is_constant(value) => continue,
                PinValue::Operand(value) => self.body.elementary(value),
                PinValue::Net(id) => self.net_type(*id),
                PinValue::Open => continue,
            };
            match ty {
                Some(ty) if ty == wanted => is_there = true,
                Some(ty) => others = Some(ty.name().to_string()),
                None => others = Some("a type that the sources do not show".to_string()),
            }
        }
        if let (false, Some(other)) = (is_there, others) {
            let title = format!("this element converts its operands from {other} to {}", wanted.name());
            self.body.refuse(element.span, title, "convert them with a box of their own before it");
        }
    }

    /// The type of a value that a box has computed.
    fn net_type(&self, id: NetId) -> Option<Elementary> {
        let source = self.graph.net(id).sources.first()?;
        match source {
            Source::Rail => Some(Elementary::Bool),
            Source::Operand { value, .. } => self.body.elementary(value),
            Source::Net(_) => None,
            Source::Pin { element, .. } => {
                let element = &self.graph.elements[*element];
                let template = [TemplateKey::Destination, TemplateKey::Value, TemplateKey::Source]
                    .into_iter()
                    .find_map(|key| element.template(key));
                elementary(&template?.value)
            }
        }
    }

    /// A box with a function of the standard.
    pub(super) fn function(&mut self, at: usize, element: &Element, row: &'static Row) {
        let span = element.span;
        let template = |key: TemplateKey| element.template(key).and_then(|template| elementary(&template.value));
        let operand_type = |build: &Self, pin: &str| match element.pin(pin).map(|pin| &pin.value) {
            Some(PinValue::Operand(value)) => build.body.elementary(value),
            Some(PinValue::Net(id)) => build.net_type(*id),
            _ => None,
        };
        let outputs: Vec<&Pin> =
            element.pins.iter().filter(|pin| pin.output && pin.name != "eno" && pin.name != "operand").collect();
        let converted = |build: &Self, infix: &str| -> Result<String, String> {
            let from = template(TemplateKey::Source).or_else(|| operand_type(build, "in"));
            let to = template(TemplateKey::Destination).or_else(|| operand_type(build, "out"));
            match (from, to) {
                (Some(from), Some(to)) if from == to => Ok("MOVE".to_string()),
                (Some(from), Some(to)) => {
                    system::conversion(from, to).map(|()| format!("{}{infix}{}", from.name(), to.name()))
                }
                _ => Err("a conversion whose types the sources do not show".to_string()),
            }
        };
        let name = match row.kind {
            RowKind::Convert => converted(self, "_TO_"),
            RowKind::Round("ROUND") => converted(self, "_TO_"),
            RowKind::Round("TRUNC") => converted(self, "_TRUNC_"),
            RowKind::Operator(sign) if row.name.eq_ignore_ascii_case(sign) && row.open.is_empty() => {
                Ok(sign.to_string())
            }
            RowKind::Invert => Ok("NOT".to_string()),
            RowKind::Negate => Ok("MUL".to_string()),
            RowKind::Step { up } => Ok(if up { "ADD" } else { "SUB" }.to_string()),
            RowKind::Mux if element.pin("else").is_some_and(|pin| !matches!(pin.value, PinValue::Open)) => {
                Err("MUX of IEC 61131-3 has no ELSE".to_string())
            }
            _ => match row.open.first() {
                Some(name) => Ok((*name).to_string()),
                None => Err(format!("IEC 61131-3 has no function for `{}`", row.name)),
            },
        };
        let name = match name {
            Ok(name) => name,
            Err(reason) => return self.refuse(span, reason),
        };
        let pins: Vec<&Pin> =
            element.pins.iter().filter(|pin| !pin.output && pin.name != "en" && pin.name != "operand").collect();
        if matches!(row.kind, RowKind::Operator(_) | RowKind::Function(_)) {
            let names: Vec<&str> =
                pins.iter().map(|pin| pin.name.as_str()).filter(|name| row.typing.converts(name)).collect();
            self.check_types(element, &names);
        }
        let mut inputs: Vec<(&Pin, String)> = pins.iter().map(|pin| (*pin, pin.name.to_uppercase())).collect();
        if let [(_, formal)] = inputs.as_mut_slice() {
            *formal = "IN".to_string();
        }
        let mut object = Object::new(Kind::Block, name);
        object.inputs = self.inputs(&inputs);
        let constant = |build: &mut Self, text: &str, formal: &str| {
            let from = build.in_variable(text.to_string(), false);
            Input { formal: formal.to_string(), from, negated: false, in_out: false }
        };
        let mut outputs: Vec<(&Pin, String)> = outputs.into_iter().map(|pin| (pin, "OUT".to_string())).collect();
        match row.kind {
            RowKind::Negate => {
                let is_float = match template(TemplateKey::Source).or_else(|| operand_type(self, "in")) {
                    Some(Elementary::Real | Elementary::Lreal) => true,
                    Some(ty) if ty.is_integer() => false,
                    _ => return self.refuse(span, "a negation whose type the sources do not show"),
                };
                object.inputs.iter_mut().for_each(|input| input.formal = "IN1".to_string());
                let factor = constant(self, if is_float { "-1.0" } else { "-1" }, "IN2");
                object.inputs.push(factor);
            }
            RowKind::Step { .. } => {
                let Some(pin) = element.pin("operand") else { return };
                let from = self.value(Some(pin));
                object.inputs.push(Input { formal: "IN1".to_string(), from, negated: false, in_out: false });
                let one = constant(self, "1", "IN2");
                object.inputs.push(one);
                outputs.push((pin, "OUT".to_string()));
            }
            _ => {}
        }
        self.block(at, element, object, &outputs, false);
    }

    /// A call of a block of the program.
    pub(super) fn call(&mut self, at: usize, element: &Element, callee: &Expr, instance: Option<&Expr>) {
        let span = element.span;
        let called = match instance {
            Some(instance) => self.body.called(instance),
            None => self.body.called(callee),
        };
        let (mut object, block): (Object, Option<&'a CodeBlock>) = match called {
            Called::Function(block, name) => (Object::new(Kind::Block, name), Some(block)),
            Called::Instance { instance, ty, block } => {
                let text = expression::text(&instance, self.body.writer);
                (Object { instance: Some(text), ..Object::new(Kind::Block, ty) }, block)
            }
            Called::System(name) => {
                return self.refuse(span, format!("IEC 61131-3 has no block `{}`", name.text));
            }
            Called::Refused => return,
        };
        let section = |name: &str| {
            let has =
                |section: &&Section| section.variables.iter().any(|variable| variable.name.eq_ignore_ascii_case(name));
            block.and_then(|block| block.sections.iter().find(has)).map(|section| section.kind)
        };
        let mut inputs: Vec<(&Pin, String)> = Vec::new();
        let mut outputs: Vec<(&Pin, String)> = Vec::new();
        let mut in_outs: Vec<String> = Vec::new();
        for pin in element.pins.iter().filter(|pin| !matches!(pin.name.as_str(), "en" | "eno")) {
            if let Some(block) = block
                && self.is_left_out(block, pin)
            {
                continue;
            }
            let formal = if block.is_some() { identifier(&pin.name) } else { pin.name.to_uppercase() };
            match section(&pin.name) {
                Some(SectionKind::InOut) => {
                    in_outs.push(formal.clone());
                    inputs.push((pin, formal));
                }
                Some(SectionKind::Output) => outputs.push((pin, formal)),
                Some(_) => inputs.push((pin, formal)),
                // The result of a function.
                None if pin.output && block.is_some() => outputs.push((pin, "OUT".to_string())),
                None if pin.output => outputs.push((pin, formal)),
                None => inputs.push((pin, formal)),
            }
        }
        object.inputs = self.inputs(&inputs);
        for input in &mut object.inputs {
            input.in_out = in_outs.contains(&input.formal);
        }
        self.block(at, element, object, &outputs, false);
    }
}

impl Build<'_, '_, '_, '_, '_> {
    /// Whether a pin is an operating parameter of a chart, which the file does not have.
    fn is_left_out(&mut self, block: &CodeBlock, pin: &Pin) -> bool {
        let span = pin.span;
        let value = match &pin.value {
            PinValue::Operand(value) => Some(value.clone()),
            PinValue::Net(_) => Some(Expr { kind: ExprKind::Error, span }),
            PinValue::Open => None,
        };
        let name = Name { text: pin.name.clone(), form: NameForm::Bare, span };
        self.body.is_left_out(block, &Argument { name: Some(name), output: pin.output, value, span })
    }
}

fn is_constant(value: &Expr) -> bool {
    match &value.kind {
        ExprKind::Literal(_) => true,
        ExprKind::Unary { operand, .. } => is_constant(operand),
        _ => false,
    }
}
