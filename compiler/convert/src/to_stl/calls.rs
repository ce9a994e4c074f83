//! Calls of blocks and of instances. Source: LAD/FBD reference F.1.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{self, Operand, OperandKind, Parameter, StatementKind};
use plcc_syntax::literal::Literal;
use plcc_syntax::network::ast::{Element, Graph, PinValue, Target, TemplateKey};
use plcc_syntax::scl::ast::{Expr, ExprKind};
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::logic::Logic;
use super::operand::{block_name, has_variable_index};
use super::plan::Plan;
use super::types::elementary;

impl Maker<'_> {
    pub fn call_box(&mut self, graph: &Graph, plan: &Plan, at: usize, callee: &Expr, instance: Option<&Expr>) {
        let span = graph.elements[at].span;
        // `#lag.LEAD_LAG(…)`: the instance, and its block again.
        let callee = match &callee.kind {
            ExprKind::Member { base, name } if self.is_instance_of(base, &name.text) => base,
            _ => callee,
        };
        let (target, instance) = match (block_name(callee), instance) {
            (Some(block), None) if let Some(of) = self.types.instance_of(&block) => {
                let target = Operand { kind: OperandKind::Block(of), span };
                (target, Some(Operand { kind: OperandKind::Block(block), span }))
            }
            (Some(block), None) if self.types.is_data(&block) => {
                return self.refuse(
                    span,
                    "a call of a data block whose function block is not in the sources",
                    "add the source of the function block",
                );
            }
            (Some(block), instance) => {
                let target = Operand { kind: OperandKind::Block(block), span };
                match instance.map(|instance| self.instance(instance)) {
                    Some(None) => return,
                    Some(instance) => (target, instance),
                    None => (target, None),
                }
            }
            // A multi-instance.
            (None, _) => match self.operand(callee) {
                Some(Operand { kind: OperandKind::Path(path), .. })
                    if !matches!(path.root, ast::PathRoot::Local { .. }) && !self.types.is_portal =>
                {
                    return self.refuse(
                        span,
                        "a call of an instance in a data block",
                        "declare the instance in the block",
                    );
                }
                Some(target) if has_variable_index(&target) => return self.refuse_indexed(span),
                Some(target) => (target, None),
                None => return,
            },
        };
        self.call(graph, plan, at, target, instance);
    }

    /// Whether an operand is a variable of the type with that name.
    fn is_instance_of(&self, value: &Expr, ty: &str) -> bool {
        self.type_name(value).is_some_and(|name| name.eq_ignore_ascii_case(ty))
    }

    /// The name of the type of a variable of the block.
    fn type_name(&self, value: &Expr) -> Option<&str> {
        let ExprKind::Name(name) = &value.kind else { return None };
        let mut variables = self.block.sections.iter().flat_map(|section| &section.variables);
        let variable = variables.find(|variable| variable.name.eq_ignore_ascii_case(&name.text))?;
        match &variable.ty.kind {
            ast::TypeKind::Named(name) | ast::TypeKind::Block(ast::BlockName::Symbol { name, .. }) => Some(name),
            _ => None,
        }
    }

    pub fn instance_box(&mut self, graph: &Graph, plan: &Plan, at: usize, name: &str, instance: Option<&Expr>) {
        let span = graph.elements[at].span;
        let Some(instance) = instance else {
            return self.refuse(span, format!("`{name}` without an instance"), "name its instance");
        };
        let Some(operand) = self.instance(instance) else { return };
        let ty = self.type_name(instance).map(str::to_uppercase);
        let is_common = ty.as_deref().is_some_and(|ty| ty.starts_with("IEC_"));
        if is_common && self.keeps_br {
            let what = format!("`{name}` on a variable whose type is that of several blocks");
            return self.refuse(span, what, &format!("declare the variable as {name}"));
        }
        let is_block = matches!(operand.kind, OperandKind::Block(_));
        // The declarations of the block do not show the types of other instances.
        if is_block || is_common || (ty.is_none() && !self.keeps_br) {
            let target = self.block_named(name);
            self.call(graph, plan, at, target, Some(operand));
        } else {
            self.call(graph, plan, at, operand, None);
        }
    }

    /// TP, TON, TOF and TONR as coils: the flow is IN.
    pub fn timer_coil(&mut self, graph: &Graph, plan: &Plan, at: usize, name: &str) {
        let element = &graph.elements[at];
        let (Some(PinValue::Operand(timer)), Some(PinValue::Operand(time)), false) =
            (element.pin("timer").map(|pin| &pin.value), element.pin("pt").map(|pin| &pin.value), self.keeps_br)
        else {
            return self.refuse(element.span, format!("the coil `{name}` here"), "write the box with an instance");
        };
        let (Some(instance), Some(time)) = (self.instance(timer), self.operand(time)) else { return };
        let flow = self.input(graph, plan, at, "in");
        let start = match self.passed(graph, plan, at, flow) {
            Logic::Operand(operand) => operand,
            Logic::Constant(value) => Operand { kind: OperandKind::Literal(Literal::Bool(value)), span: element.span },
            flow => match self.stored(&flow) {
                Logic::Operand(bit) => bit,
                _ => return,
            },
        };
        let parameters = [("IN", start), ("PT", time)].map(|(name, actual)| Parameter {
            name: name.to_string(),
            name_span: element.span,
            actual: Some(actual),
        });
        let (target, parameters) = (self.block_named(name), parameters.to_vec());
        let call = ast::Call { target, types: Vec::new(), instance: Some(instance), parameters };
        self.sets_br = true;
        self.rlo = None;
        self.push_kind(StatementKind::Call(Box::new(call)));
    }

    /// A block of the system.
    fn block_named(&self, name: &str) -> Operand {
        let name = ast::BlockName::Symbol { name: name.to_string(), span: self.span };
        Operand { kind: OperandKind::Block(name), span: self.span }
    }

    /// STL calls instances that are known.
    fn refuse_indexed(&mut self, span: Span) {
        self.refuse(span, "a call of an instance that an index chooses", "name the instance");
    }

    /// An instance: a data block, or a variable of the block.
    fn instance(&mut self, value: &Expr) -> Option<Operand> {
        match (block_name(value), self.operand(value)?) {
            (Some(name), Operand { kind: OperandKind::Block(_), span }) => {
                Some(Operand { kind: OperandKind::Block(name), span })
            }
            (Some(name), Operand { kind: OperandKind::Path(path), span })
                if matches!(path.root, ast::PathRoot::Quoted { .. }) =>
            {
                Some(Operand { kind: OperandKind::Block(name), span })
            }
            (_, operand) if has_variable_index(&operand) => {
                self.refuse_indexed(value.span);
                None
            }
            (_, operand) => Some(operand),
        }
    }

    fn call(&mut self, graph: &Graph, plan: &Plan, at: usize, target: Operand, instance: Option<Operand>) {
        let element = &graph.elements[at];
        let enable = match self.input(graph, plan, at, "en") {
            // A bit that is stored for the call would take its place.
            Logic::Rlo if element.pins.iter().any(|pin| !pin.output && pin.negated) => self.stored(&Logic::Rlo),
            enable => enable,
        };
        let mut parameters = Vec::new();
        let mut results = Vec::new();
        // PLCopen XML calls the result of a function as the function.
        let function = match &target.kind {
            OperandKind::Block(ast::BlockName::Symbol { name, .. }) if instance.is_none() => name.clone(),
            _ => String::new(),
        };
        for (index, pin) in element.pins.iter().enumerate() {
            if matches!(pin.name.as_str(), "en" | "eno") || pin.value == PinValue::Open {
                continue;
            }
            let is_result = pin.output && pin.name.eq_ignore_ascii_case(&function);
            let actual = match &pin.value {
                PinValue::Operand(value) if !pin.negated => match self.operand(value) {
                    Some(operand) => operand,
                    None => return,
                },
                PinValue::Operand(_) | PinValue::Net(_) if !pin.output => {
                    let typed = match pin.value {
                        PinValue::Net(net) => self.typed.get(&net).map(|(operand, _)| operand.clone()),
                        PinValue::Operand(_) | PinValue::Open => None,
                    };
                    match typed {
                        Some(operand) => operand,
                        None => {
                            let value = self.input(graph, plan, at, &pin.name);
                            match self.stored(&value) {
                                Logic::Operand(bit) => bit,
                                _ => return,
                            }
                        }
                    }
                }
                PinValue::Net(net) if plan.is_used(*net) && !pin.negated => {
                    let name = if is_result { "RET_VAL" } else { pin.name.as_str() };
                    let ty = self.type_of_output(element, (&target, instance.as_ref()), name);
                    let result = self.temporary(ty);
                    results.push((index, *net, result.clone(), ty));
                    result
                }
                PinValue::Net(_) if !pin.negated => continue,
                _ => return self.refuse(pin.span, "an inverted output", "invert the value after the box"),
            };
            let name = if is_result { "RET_VAL".to_string() } else { pin.name.to_uppercase() };
            if parameters.iter().any(|given: &Parameter| given.name == name) {
                let what = format!("the output `{}` of a call with several connections", pin.name);
                return self.refuse(pin.span, what, "connect one variable, and copy it into the others after the call");
            }
            parameters.push(Parameter { name, name_span: pin.span, actual: Some(actual) });
        }
        for parameter in &mut parameters {
            // A row has its pins in small letters, a block has them as they are declared.
            if let Some(pin) = element.pins.iter().find(|pin| pin.name.eq_ignore_ascii_case(&parameter.name)) {
                parameter.name = pin.name.clone();
            }
            if let Target::Element { row, .. } = &element.target
                && let Some((pin, _)) = row.pin(&parameter.name)
            {
                // The longest spelling is that of the block: `LD` of a counter is LOAD.
                let names = pin.spellings().filter(|name| *name == "load" || *name == pin.name());
                parameter.name = names.last().unwrap_or(&parameter.name).to_uppercase();
            }
        }
        let wanted = self.is_wanted(graph, plan, at, "eno");
        let mut call = ast::Call { target, types: Vec::new(), instance, parameters };
        // In STL, a function needs all its parameters.
        for (name, ty) in self.types.outputs_of_function(&call, self.block) {
            if call.parameters.iter().any(|given| given.name.eq_ignore_ascii_case(&name)) {
                continue;
            }
            let Some(ty) = ty else {
                return self.refuse(element.span, format!("the open output `{name}`"), "connect a variable");
            };
            let unused = self.temporary(ty);
            call.parameters.push(Parameter { name, name_span: element.span, actual: Some(unused) });
        }
        let call = StatementKind::Call(Box::new(call));
        self.sets_br = true;
        let mut skip = None;
        match enable {
            Logic::Constant(true) => {
                if wanted || self.keeps_br {
                    // A block that does not touch BR has succeeded.
                    self.push(StlInsn::SetRlo, None);
                    self.push(StlInsn::Save, None);
                }
                self.rlo = None;
                self.push_kind(call);
            }
            enable => {
                let label = self.new_label();
                self.evaluate(&enable);
                let jump = self.jump(StlInsn::JumpIfNotBr, &label);
                self.rlo = None;
                self.push_kind(call);
                // EN is 0 where the call is skipped.
                let wires = results
                    .iter()
                    .filter(|(_, net, _, ty)| *ty == Elementary::Bool && !plan.is_guarded(graph, *net, at));
                let clears = wires.map(|(_, _, bit, _)| (StlInsn::Assign, bit.clone())).collect();
                self.insert(jump, clears);
                skip = Some(jump);
                self.label(&label);
            }
        }
        for (pin, net, result, ty) in results {
            match ty {
                Elementary::Bool => drop(self.outputs.insert((at, pin), Logic::Operand(result))),
                ty => drop(self.typed.insert(net, (result, ty))),
            }
        }
        self.clear_wires(graph, plan, at, skip);
        self.take_eno(graph, plan, at, wanted);
    }

    /// The type of an output that feeds a wire; `called`: the block, and its instance. If nothing tells it, it is a signal.
    fn type_of_output(&self, element: &Element, called: (&Operand, Option<&Operand>), name: &str) -> Elementary {
        let (target, instance) = (called.0.clone(), called.1.cloned());
        let call = ast::Call { target, types: Vec::new(), instance, parameters: Vec::new() };
        if let Some(ty) = self.types.formal(&call, name, self.block) {
            return ty;
        }
        let set = |key: TemplateKey| element.template(key).and_then(|template| elementary(&template.value));
        let of_instance = match (&element.target, name) {
            (Target::Element { .. }, "et") => Some(set(TemplateKey::Time).unwrap_or(Elementary::Time)),
            (Target::Element { .. }, "cv") => Some(set(TemplateKey::Value).unwrap_or(Elementary::Int)),
            _ => None,
        };
        of_instance.unwrap_or(Elementary::Bool)
    }
}
