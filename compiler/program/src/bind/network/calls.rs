//! Calls: blocks of the program, function blocks of the system on their instances, functions without a value, timer coils.
//!
//! Source: LAD/FBD reference A.8, B.3, B.9, C.1, C.6, C.7.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::network::ast::{Element, Pin, PinValue, Target};
use plcc_syntax::network::elements::{PinDirection, Row};
use plcc_syntax::scl::ast::{
    Argument, Expr as Node, ExprKind as NodeKind, Name, NameForm, Statement as Tree, StatementKind as TreeKind,
};

use super::bits::{argument, call_node};
use super::pins::{connected, outputs};
use super::sheet::Sheet;
use crate::bind::globals::names::kind_prefix;
use crate::bind::network::NetworkBinder;
use crate::bind::scl::SclBlock;
use crate::bind::scl::callee::{Callee, block_of_name};
use crate::bind::scl::instance::type_of_data;
use crate::bind::scl::value::Value;
use plcc_abi::image::BlockKind;
use plcc_binding::fold;
use plcc_model::scl::{Instance, StatementKind};
use plcc_model::types::DataType;
use plcc_model::{BlockKey, Direction};

/// The parameter with the return value of an FC.
const RESULT: &str = "ret_val";

impl NetworkBinder<'_, '_> {
    /// TON, CTU, R_TRIG, TSEND_C and similar blocks with an instance.
    pub fn instance_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, name: &str) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let Target::Element { row, instance: Some(instance) } = &element.target else {
            let is_instance = |ty: &DataType| match ty {
                DataType::Struct(ty) => ty.instance_of.is_some() && ty.name.eq_ignore_ascii_case(name),
                _ => false,
            };
            let own = ctx.block.bound.locals.values().filter(|local| is_instance(&local.ty));
            let help = match own.map(|local| local.name.as_str()).min() {
                Some(own) => format!("write its instance before it: `#{own}.{name}( … )`"),
                None => {
                    let declared = format!("inst{name} : {};", type_of_data(name));
                    format!(
                        "declare `{declared}` in VAR of a function block, and write `#inst{name}.{name}( … )`; \
                         with an instance data block write `\"name\".{name}( … )`"
                    )
                }
            };
            let title = format!("{name} has no instance");
            let label = "the element needs an instance for its data";
            self.scl().refuse(Code::MissingOperand, span, &title, label, &help);
            return None;
        };
        if row.is_box() || connected(element, "en").is_some() {
            self.boxed(ctx, sheet, at, |binder, ctx, sheet| binder.instance_call(ctx, sheet, at, row, instance, name))
        } else {
            self.instance_call(ctx, sheet, at, row, instance, name)
        }
    }

    fn instance_call(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        at: usize,
        row: &'static Row,
        instance: &Node,
        name: &str,
    ) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let arguments = self.input_arguments(ctx, sheet, element)?;
        let member = Name { text: name.to_string(), form: NameForm::Bare, span };
        let callee =
            Node { kind: NodeKind::Member { base: Box::new(instance.clone()), name: member }, span: instance.span };
        self.call_tree(ctx, sheet, callee.clone(), arguments, span)?;
        for pin in row.pins().filter(|pin| pin.direction == PinDirection::Output && pin.name() != "eno") {
            if outputs(sheet.element(at), pin.name()).next().is_some() {
                let component = self.component_of_output(ctx, &callee, pin.name());
                self.instance_output(ctx, sheet, at, instance, pin.name(), &component)?;
            }
        }
        Some(())
    }

    /// The component of an instance that has an output's value. Data for several blocks, such as IEC_COUNTER, may have another name
    /// there: Q of CTU is QU.
    fn component_of_output(&mut self, ctx: &mut SclBlock, callee: &Node, output: &str) -> String {
        self.other_component(ctx, callee, output).unwrap_or_else(|| output.to_string())
    }

    fn other_component(&mut self, ctx: &mut SclBlock, callee: &Node, output: &str) -> Option<String> {
        let Some(Callee::Block { key, instance: Some(instance) }) = self.scl().callee(ctx, callee) else { return None };
        let data = match instance {
            Instance::Db(number) => self.program.data.db_type(number)?,
            Instance::Variable(access) => match access.ty {
                DataType::Struct(data) => data,
                _ => return None,
            },
        };
        let bound = self.program.interface(key, callee.span)?;
        let own = bound.interface.instance.iter().find(|member| member.name.eq_ignore_ascii_case(output))?;
        let there = data.members.iter().find(|member| (member.byte, member.bit) == (own.byte, own.bit))?;
        Some(there.name.clone())
    }

    /// Sends the output of an instance, which is the given component, to what is connected to it.
    fn instance_output(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        at: usize,
        instance: &Node,
        name: &str,
        component: &str,
    ) -> Option<()> {
        let Some((_, pin)) = outputs(sheet.element(at), name).next() else { return Some(()) };
        let member = Name { text: component.to_string(), form: NameForm::Bare, span: pin.span };
        let node = Node { kind: NodeKind::Member { base: Box::new(instance.clone()), name: member }, span: pin.span };
        let value = self.scl().value(ctx, &node)?;
        self.output(ctx, sheet, at, name, value)
    }

    /// Arguments for the inputs and in-outs of an element.
    fn input_arguments(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, element: &Element) -> Option<Vec<Argument>> {
        let mut arguments = Vec::new();
        for pin in element.pins.iter().filter(|pin| !pin.output && !pin.name.eq_ignore_ascii_case("en")) {
            if pin.value == PinValue::Open {
                continue;
            }
            let node = self.pin_node(ctx, sheet, pin)?;
            arguments.push(named(pin, node, false));
        }
        Some(arguments)
    }

    /// A call as a statement.
    fn call_tree(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        callee: Node,
        arguments: Vec<Argument>,
        span: Span,
    ) -> Option<()> {
        let node = Node { kind: NodeKind::Call { callee: Box::new(callee), arguments }, span };
        let tree = Tree { kind: TreeKind::Expression(node), span };
        let before = self.program.globals.report.diagnostics.len();
        let mut bound = Vec::new();
        self.scl().statement(ctx, &tree, &mut bound);
        let good = !self.program.globals.report.diagnostics[before..].iter().any(Diagnostic::is_error);
        sheet.statements.extend(bound);
        good.then_some(())
    }

    /// The call of an FC or FB.
    pub fn block_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        self.boxed(ctx, sheet, at, |binder, ctx, sheet| {
            let element = sheet.element(at);
            let Target::Block { callee, instance } = &element.target else { return None };
            let node = match instance {
                None => callee.clone(),
                Some(instance) => binder.instance_callee(callee, instance),
            };
            let told = binder.program.globals.report.diagnostics.len();
            let key = match binder.scl().callee(ctx, &node) {
                Some(Callee::Block { key, .. }) => key,
                Some(Callee::Function(_)) => return binder.function_call(ctx, sheet, at, &node),
                None => {
                    let operands = element.pins.iter().filter_map(|pin| match &pin.value {
                        PinValue::Operand(node) => Some(named(pin, node.clone(), pin.output)),
                        PinValue::Net(_) | PinValue::Open => None,
                    });
                    let operands: Vec<Argument> = operands.collect();
                    binder.scl().note_arguments(ctx, &operands);
                    if binder.program.globals.report.diagnostics.len() == told {
                        return Some(());
                    }
                    return None;
                }
            };
            if instance.is_some() && binder.is_misnamed(callee, key) {
                return Some(());
            }
            let bound = binder.program.interface(key, node.span)?;
            let element = sheet.element(at);
            let names = element.pins.iter().filter(|pin| pin.value != PinValue::Open).map(|pin| pin.name.as_str());
            if binder.program.globals.is_own_of_program(key, &bound.interface.parameters, names, callee.span) {
                return Some(());
            }
            if matches!(key.kind, BlockKind::Fb | BlockKind::Sfb) {
                let data = instance.as_ref().unwrap_or(callee);
                let data = binder.scl().instance_before(ctx, data).unwrap_or(data);
                return binder.function_block_call(ctx, sheet, at, node, data, key);
            }
            binder.function_call_of(ctx, sheet, at, node, key)
        })
    }

    /// Whether nothing has the name of the called block, although its instance is one of `key`. It is reported.
    fn is_misnamed(&mut self, callee: &Node, key: BlockKey) -> bool {
        let NodeKind::Name(name) = &callee.kind else { return false };
        let globals = &mut self.program.globals;
        let is_known = globals.global(&name.text).is_some() && !globals.is_part(&name.text)
            || block_of_name(name).is_some()
            || plcc_stdlib::blocks()
                .iter()
                .any(|block| block.name.eq_ignore_ascii_case(&name.text) && !block.is_part())
            || plcc_stdlib::catalogued(&name.text).is_some();
        if is_known {
            return false;
        }
        let meant = match globals.library_block(key) {
            Some(block) => block.name.to_owned(),
            None => globals.names.block_name(kind_prefix(key.kind), key.number),
        };
        globals.report.missing_function(&name.text, name.span, Some(meant).filter(|meant| !meant.is_empty()), false);
        true
    }

    /// The call of a function block with its instance: the instance itself, or `"block"."data block"` if the latter is not declared.
    fn instance_callee(&self, callee: &Node, instance: &Node) -> Node {
        match (&callee.kind, &instance.kind) {
            (NodeKind::Name(block), NodeKind::Name(name))
                if name.form != NameForm::Local
                    && self.program.globals.names.symbols.contains_key(&fold(&block.text)) =>
            {
                let kind = NodeKind::Member { base: Box::new(callee.clone()), name: name.clone() };
                Node { kind, span: callee.span }
            }
            // Neither is defined: report the block as missing.
            (NodeKind::Name(_), NodeKind::Name(name))
                if name.form != NameForm::Local
                    && !self.program.globals.names.symbols.contains_key(&fold(&name.text)) =>
            {
                callee.clone()
            }
            _ => instance.clone(),
        }
    }

    fn function_block_call(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        at: usize,
        node: Node,
        instance: &Node,
        key: BlockKey,
    ) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let bound = self.program.interface(key, span)?;
        let mut arguments = Vec::new();
        let mut after = Vec::new();
        for pin in element.pins.iter().filter(|pin| !is_enable(pin) && pin.value != PinValue::Open) {
            let output = bound.interface.parameters.iter().any(|parameter| {
                parameter.direction == Direction::Output && parameter.name.eq_ignore_ascii_case(&pin.name)
            });
            if output && !pin.output {
                self.output_as_input(key, pin);
                return None;
            }
            if pin.output {
                if !after.contains(&pin.name) {
                    after.push(pin.name.clone());
                }
                if !output {
                    // The call reports that there is no such output.
                    let node = self.pin_node_of_output(pin)?;
                    arguments.push(named(pin, node, true));
                }
            } else {
                let node = self.pin_node(ctx, sheet, pin)?;
                arguments.push(named(pin, node, false));
            }
        }
        self.call_tree(ctx, sheet, node, arguments, span)?;
        for name in after {
            self.instance_output(ctx, sheet, at, instance, &name, &name)?;
        }
        Some(())
    }

    /// `run := "Motor"` for an output, whose value would go nowhere.
    fn output_as_input(&mut self, key: BlockKey, pin: &Pin) {
        let title = format!("`{}` of {} is an output", pin.name, self.program.globals.shown(key));
        let help = match self.program.globals.text(pin.span).split_once(":=") {
            Some((_, given)) => format!("write `{} => {}`", pin.name, given.trim()),
            None => "connect its variable as an output of the box".to_string(),
        };
        self.program.report(
            Diagnostic::new(Code::AssignSign, pin.span, title)
                .label("connected as an input: its value goes nowhere")
                .help(help),
        );
    }

    fn pin_node_of_output(&self, pin: &Pin) -> Option<Node> {
        match &pin.value {
            PinValue::Operand(node) => Some(node.clone()),
            PinValue::Net(_) | PinValue::Open => None,
        }
    }

    /// The call of an FC: outputs that feed nets are written into hidden variables first.
    fn function_call_of(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        at: usize,
        node: Node,
        key: BlockKey,
    ) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let bound = self.program.interface(key, span)?;
        let mut arguments = Vec::new();
        let mut after = Vec::new();
        let mut result = None;
        for pin in element.pins.iter().filter(|pin| !is_enable(pin)) {
            let formal = bound.interface.parameters.iter().find(|one| one.name.eq_ignore_ascii_case(&pin.name));
            if pin.value == PinValue::Open {
                // An output that is intentionally left open.
                if formal.is_some_and(|formal| formal.direction == Direction::Output) {
                    let name = Name { text: pin.name.clone(), form: NameForm::Bare, span: pin.span };
                    arguments.push(Argument { name: Some(name), output: true, value: None, span: pin.span });
                }
                continue;
            }
            // Other editors call the result OUT, or by the name of the function.
            let is_own = matches!(&node.kind, NodeKind::Name(own) if own.text.eq_ignore_ascii_case(&pin.name));
            let is_result = pin.name.eq_ignore_ascii_case(RESULT)
                || formal.is_none() && (is_own || pin.name.eq_ignore_ascii_case("OUT"));
            if pin.output && is_result {
                result = Some(pin.name.clone());
                continue;
            }
            let direct = match &pin.value {
                PinValue::Operand(_) => pin.storage == plcc_syntax::network::ast::Storage::None && !pin.negated,
                PinValue::Net(_) | PinValue::Open => false,
            };
            let is_output = formal.map_or(pin.output, |formal| formal.direction == Direction::Output);
            if is_output && !pin.output {
                self.output_as_input(key, pin);
                return None;
            }
            if !is_output {
                let node = self.pin_node(ctx, sheet, pin)?;
                arguments.push(named(pin, node, false));
            } else if direct && outputs(element, &pin.name).count() == 1 {
                arguments.push(named(pin, self.pin_node_of_output(pin)?, true));
            } else if !after.iter().any(|(name, _): &(String, _)| name.eq_ignore_ascii_case(&pin.name)) {
                let Some(DataType::Elementary(ty)) = formal.map(|formal| &formal.ty) else {
                    self.wire_without_type(pin.span);
                    return None;
                };
                let hidden = sheet.hidden_reference(ctx, *ty);
                arguments.push(named(pin, hidden.node(pin.span), true));
                after.push((pin.name.clone(), hidden));
            }
        }
        match result {
            Some(name) => {
                let call = Node { kind: NodeKind::Call { callee: Box::new(node), arguments }, span };
                let value = self.scl().call(ctx, &call, false)?;
                let value = match value {
                    Value::Elementary(expr) => Value::Elementary(sheet.keep(ctx, expr)),
                    value => value,
                };
                self.output(ctx, sheet, at, &name, value)?;
            }
            None => self.call_tree(ctx, sheet, node, arguments, span)?,
        }
        for (name, hidden) in after {
            self.output(ctx, sheet, at, &name, Value::Elementary(hidden.load(span)))?;
        }
        Some(())
    }

    /// An output without a single value cannot feed a wire.
    fn wire_without_type(&mut self, span: Span) {
        self.program.report(
            Diagnostic::new(Code::MissingOperand, span, "this output needs an operand")
                .label("a wire can only carry a single value")
                .help("put a variable at the output"),
        );
    }

    /// A function of SCL that a file calls like a block.
    fn function_call(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, node: &Node) -> Option<()> {
        let NodeKind::Name(name) = &node.kind else { return None };
        self.procedure(ctx, sheet, at, &name.text)
    }

    /// A function without a value, or a block of the library.
    pub fn procedure_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, name: &str) -> Option<()> {
        self.boxed(ctx, sheet, at, |binder, ctx, sheet| binder.procedure(ctx, sheet, at, name))
    }

    fn procedure(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, name: &str) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let node = super::pins::bare(name, span);
        if let Some(key) = self.scl().library_function(ctx.scope.rules, name)
            && matches!(key.kind, BlockKind::Fc | BlockKind::Sfc)
        {
            return self.function_call_of(ctx, sheet, at, node, key);
        }
        let mut arguments = Vec::new();
        for pin in element.pins.iter().filter(|pin| !is_enable(pin) && pin.value != PinValue::Open) {
            match &pin.value {
                PinValue::Operand(operand) if pin.output => arguments.push(named(pin, operand.clone(), true)),
                PinValue::Net(_) if pin.output => {
                    self.wire_without_type(pin.span);
                    return None;
                }
                _ => {
                    let node = self.pin_node(ctx, sheet, pin)?;
                    arguments.push(named(pin, node, false));
                }
            }
        }
        self.call_tree(ctx, sheet, node, arguments, span)
    }

    /// TP, TON, TOF, TONR as coils: the flow is IN.
    pub fn timer_coil(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, name: &str) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let flow = self.flow(ctx, sheet, at, "in")?;
        let flow = sheet.keep(ctx, flow);
        let timer = self.operand_node(element, "timer")?;
        let time = self.pin_node(ctx, sheet, connected(element, "pt")?)?;
        let start = self.value_node(ctx, sheet, flow.clone());
        let member = Name { text: name.to_string(), form: NameForm::Bare, span };
        let callee = Node { kind: NodeKind::Member { base: Box::new(timer.clone()), name: member }, span: timer.span };
        self.call_tree(ctx, sheet, callee, vec![argument("IN", start, false), argument("PT", time, false)], span)?;
        self.output(ctx, sheet, at, "out", Value::Elementary(flow))
    }

    /// RT.
    pub fn reset_timer_coil(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        self.timer_function_coil(ctx, sheet, at, "RESET_TIMER")
    }

    /// PT.
    pub fn preset_timer_coil(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        self.timer_function_coil(ctx, sheet, at, "PRESET_TIMER")
    }

    fn timer_function_coil(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, name: &str) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let flow = self.flow(ctx, sheet, at, "in")?;
        let flow = sheet.keep(ctx, flow);
        let mut arguments = vec![argument("TIMER", self.operand_node(element, "timer")?, false)];
        if let Some(pin) = connected(element, "pt") {
            arguments.push(argument("PT", self.pin_node(ctx, sheet, pin)?, false));
        }
        let node = call_node(name, arguments, span);
        let mut body = Vec::new();
        self.scl().statement(ctx, &Tree { kind: TreeKind::Expression(node), span }, &mut body);
        sheet.push(StatementKind::If { branches: vec![(flow.clone(), body)], otherwise: Vec::new() }, span);
        self.output(ctx, sheet, at, "out", Value::Elementary(flow))
    }

    /// The operand at a pin that cannot have a wire.
    pub fn operand_node(&mut self, element: &Element, name: &str) -> Option<Node> {
        match &connected(element, name)?.value {
            PinValue::Operand(node) => Some(node.clone()),
            PinValue::Net(_) | PinValue::Open => None,
        }
    }
}

fn is_enable(pin: &Pin) -> bool {
    pin.name.eq_ignore_ascii_case("en") || pin.name.eq_ignore_ascii_case("eno")
}

/// An argument for a pin.
fn named(pin: &Pin, value: Node, output: bool) -> Argument {
    let name = Name { text: pin.name.clone(), form: NameForm::Bare, span: pin.span };
    Argument { name: Some(name), output, value: Some(value), span: pin.span }
}
