//! Elements of networks as statements, one after the other. Source: LAD/FBD reference F.1.

use plcc_syntax::ast::{Operand, OperandKind, StatusOperand};
use plcc_syntax::network::ast::{Element, Graph, PinValue, Target};
use plcc_syntax::network::elements::{Flag, Gate, Kind, Mcr, ReturnValue, Row};
use plcc_syntax::scl::ast::{Expr, ExprKind};
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::logic::Logic;
use super::plan::{Plan, flow_pin, is_pure};

impl Maker<'_> {
    pub fn element(&mut self, graph: &Graph, plan: &Plan, at: usize) {
        let element = &graph.elements[at];
        if is_pure(element) {
            self.pure(graph, plan, at);
        } else {
            match &element.target {
                Target::Block { callee, instance } => {
                    self.call_box(graph, plan, at, callee, instance.as_ref());
                }
                Target::Element { row, instance } => self.effect(graph, plan, at, row, instance.as_ref()),
            }
        }
        // Nets with several users get their variable when the last of their sources is known.
        for pin in element.pins.iter().filter(|pin| pin.output) {
            if let PinValue::Net(net) = pin.value
                && plan.is_kept(graph, net)
                && plan.last_source(graph, net) == Some(plan.place[at])
                && !self.typed.contains_key(&net)
            {
                self.keep(graph, plan, net);
            }
        }
    }

    /// An element without effect: where its value is used, or in a variable.
    fn pure(&mut self, graph: &Graph, plan: &Plan, at: usize) {
        let element = &graph.elements[at];
        let outputs: Vec<usize> = (0..element.pins.len()).filter(|pin| element.pins[*pin].output).collect();
        let nets = outputs.iter().filter_map(|pin| match element.pins[*pin].value {
            PinValue::Net(net) => Some(net),
            PinValue::Operand(_) | PinValue::Open => None,
        });
        if !nets.clone().any(|net| plan.is_used(net)) {
            return;
        }
        let mut value = self.meaning(graph, plan, at);
        if !plan.inline[at] && !matches!(value, Logic::Constant(_)) {
            value = self.stored(&value);
        }
        for pin in outputs {
            let value = if element.pins[pin].negated { value.clone().not() } else { value.clone() };
            self.outputs.insert((at, pin), value);
        }
    }

    /// The value of an element that has one and does nothing else.
    fn meaning(&mut self, graph: &Graph, plan: &Plan, at: usize) -> Logic {
        let element = &graph.elements[at];
        let Target::Element { row, .. } = &element.target else { return Logic::Constant(false) };
        match row.kind {
            Kind::Contact => {
                let flow = self.input(graph, plan, at, "in");
                Logic::and(vec![flow, self.input(graph, plan, at, "operand")])
            }
            Kind::Not => self.input(graph, plan, at, "in").not(),
            Kind::Gate(gate) => {
                let names = element.pins.iter().filter(|pin| !pin.output && pin.value != PinValue::Open);
                let names: Vec<String> = names.map(|pin| pin.name.clone()).collect();
                let values = names.iter().map(|name| self.input(graph, plan, at, name)).collect();
                match gate {
                    Gate::And => Logic::and(values),
                    Gate::Or => Logic::or(values),
                    Gate::Xor => Logic::xor(values),
                }
            }
            Kind::Flag(flag) => {
                let flow = self.input(graph, plan, at, "pre");
                let status = match flag {
                    Flag::Ov => StatusOperand::Ov,
                    Flag::Os => StatusOperand::Os,
                    Flag::Uo => StatusOperand::Uo,
                    Flag::Br => StatusOperand::Br,
                    Flag::Equal => StatusOperand::Eq0,
                    Flag::NotEqual => StatusOperand::Ne0,
                    Flag::Greater => StatusOperand::Gt0,
                    Flag::Less => StatusOperand::Lt0,
                    Flag::GreaterEqual => StatusOperand::Ge0,
                    Flag::LessEqual => StatusOperand::Le0,
                };
                let value = Logic::Operand(Operand { kind: OperandKind::Status(status), span: element.span });
                let negated = element.pin("operand").is_some_and(|pin| pin.negated);
                Logic::and(vec![flow, if negated { value.not() } else { value }])
            }
            Kind::Compare(sign) => self.compare(graph, plan, at, sign),
            Kind::Range { inside } => self.range(graph, plan, at, inside),
            Kind::Valid { valid } => self.valid(graph, plan, at, valid),
            _ => Logic::Constant(false),
        }
    }

    /// An element that does something.
    fn effect(&mut self, graph: &Graph, plan: &Plan, at: usize, row: &'static Row, instance: Option<&Expr>) {
        let element = &graph.elements[at];
        match row.kind {
            Kind::EdgeContact { rising } => {
                let flow = self.input(graph, plan, at, "pre");
                let of = self.input(graph, plan, at, "operand");
                let Some(bit) = self.pin_operand(element, "bit") else { return };
                self.evaluate(&Logic::and(vec![flow, Logic::Edge { of: Box::new(of), bit, rising }]));
                self.result(graph, plan, at, "out");
            }
            Kind::EdgeTrigger { rising } => {
                let of = self.input(graph, plan, at, "in");
                let Some(bit) = self.pin_operand(element, "bit") else { return };
                self.evaluate(&Logic::Edge { of: Box::new(of), bit, rising });
                self.result(graph, plan, at, "out");
            }
            Kind::Coil => self.coil(graph, plan, at, StlInsn::Assign),
            Kind::SetCoil => self.coil(graph, plan, at, StlInsn::Set),
            Kind::ResetCoil => self.coil(graph, plan, at, StlInsn::Reset),
            Kind::Save => self.coil(graph, plan, at, StlInsn::Save),
            Kind::EdgeCoil { rising } => self.edge_coil(graph, plan, at, rising),
            Kind::BitField { set } => self.bit_field(graph, plan, at, set),
            Kind::FlipFlop { set_wins } => self.flip_flop(graph, plan, at, set_wins, instance),
            Kind::Jump { negated } => self.jump_coil(graph, plan, at, negated),
            Kind::JumpList => self.jump_list(graph, plan, at),
            Kind::Switch => self.switch(graph, plan, at),
            Kind::Return(value) => self.return_coil(graph, plan, at, value),
            Kind::S5Timer(name) => self.timer(graph, plan, at, name, instance),
            Kind::S5Counter(_) => self.counter(graph, plan, at, instance),
            Kind::CounterCoil(coil) => self.counter_coil(graph, plan, at, coil, instance),
            Kind::OpenDb { di } => {
                let Some(operand) = self.pin_operand(element, "operand") else { return };
                let operand = opened(operand, di);
                self.under_flow(graph, plan, at, |maker| maker.push(StlInsn::OpenDb, Some(operand)));
            }
            Kind::CallCoil => self.call_coil(graph, plan, at),
            Kind::Mcr(coil) => self.mcr_coil(graph, plan, at, coil),
            Kind::Instance(name) => self.instance_box(graph, plan, at, name, instance),
            Kind::TimerCoil(name) => self.timer_coil(graph, plan, at, name),
            // A gate that has its output at a variable.
            Kind::Gate(_) | Kind::Compare(_) | Kind::Range { .. } | Kind::Valid { .. } => {
                let value = self.meaning(graph, plan, at);
                self.evaluate(&value);
                self.result(graph, plan, at, "out");
            }
            _ => self.arithmetic_box(graph, plan, at, row),
        }
    }

    /// `=`, `S`, `R` or SAVE, after the flow or after another coil of the same flow.
    fn coil(&mut self, graph: &Graph, plan: &Plan, at: usize, insn: StlInsn) {
        let element = &graph.elements[at];
        let net = flow_pin(element).and_then(|pin| match pin.value {
            PinValue::Net(net) if !pin.negated => Some(plan.canonical(net)),
            PinValue::Net(_) | PinValue::Operand(_) | PinValue::Open => None,
        });
        if net.is_none() || self.rlo != net {
            let flow = self.input(graph, plan, at, "in");
            let flow = self.passed(graph, plan, at, flow);
            self.evaluate(&flow);
        }
        if insn == StlInsn::Save {
            self.sets_br = true;
            self.push(insn, None);
        } else {
            let Some(operand) = self.pin_operand(element, "operand") else { return };
            let negated = element.pin("operand").is_some_and(|pin| pin.negated);
            if negated {
                self.push(StlInsn::Not, None);
            }
            self.push(insn, Some(operand));
            if negated {
                self.push(StlInsn::Not, None);
            }
        }
        self.rlo = net;
    }

    /// `(P)` or `(N)`.
    fn edge_coil(&mut self, graph: &Graph, plan: &Plan, at: usize, rising: bool) {
        let element = &graph.elements[at];
        let flow = self.input(graph, plan, at, "in");
        let flow = self.passed(graph, plan, at, flow);
        let (Some(bit), Some(operand)) = (self.pin_operand(element, "bit"), self.pin_operand(element, "operand"))
        else {
            return;
        };
        self.evaluate(&Logic::Edge { of: Box::new(flow), bit, rising });
        self.push(StlInsn::Assign, Some(operand));
    }

    /// `JMP`, or `JMPN` if negated.
    fn jump_coil(&mut self, graph: &Graph, plan: &Plan, at: usize, negated: bool) {
        let Some(label) = self.jump_label(&graph.elements[at], "label") else { return };
        match self.input(graph, plan, at, "in") {
            Logic::Constant(value) if value != negated => {
                self.jump(StlInsn::Jump, &label);
            }
            Logic::Constant(_) => {}
            flow => {
                self.evaluate(&flow);
                self.jump(if negated { StlInsn::JumpIfNot } else { StlInsn::JumpIf }, &label);
            }
        }
    }

    /// `CALL`, which calls an FC without parameters.
    fn call_coil(&mut self, graph: &Graph, plan: &Plan, at: usize) {
        let element = &graph.elements[at];
        let called = element.pin("operand").and_then(|pin| match &pin.value {
            PinValue::Operand(value) => match super::operand::block_name(value) {
                Some(block) => Some(OperandKind::Block(block)),
                // A parameter of type BLOCK_FC.
                None => self.operand(value).map(|operand| operand.kind),
            },
            PinValue::Net(_) | PinValue::Open => None,
        });
        let Some(kind @ (OperandKind::Block(_) | OperandKind::Path(_))) = called else {
            return self.refuse(element.span, "a call of this operand", "name an FC");
        };
        let flow = self.input(graph, plan, at, "in");
        let operand = Some(Operand { kind, span: element.span });
        if matches!(flow, Logic::Constant(true)) {
            self.push(StlInsn::CallUnconditional, operand);
        } else {
            self.evaluate(&flow);
            self.push(StlInsn::CallConditional, operand);
        }
    }

    fn mcr_coil(&mut self, graph: &Graph, plan: &Plan, at: usize, coil: Mcr) {
        let flow = self.input(graph, plan, at, "in");
        match coil {
            Mcr::Activate => self.push(StlInsn::McrActivate, None),
            Mcr::Deactivate => self.push(StlInsn::McrDeactivate, None),
            Mcr::Close => self.push(StlInsn::McrClose, None),
            Mcr::Open => {
                self.evaluate(&flow);
                self.push(StlInsn::McrOpen, None);
            }
        }
    }

    fn flip_flop(&mut self, graph: &Graph, plan: &Plan, at: usize, set_wins: bool, instance: Option<&Expr>) {
        let element = &graph.elements[at];
        let operand = match instance {
            Some(instance) => self.operand(instance),
            None => self.pin_operand(element, "operand"),
        };
        let Some(operand) = operand else { return };
        let (set, reset) = if set_wins { ("s1", "r") } else { ("s", "r1") };
        // The one that wins comes last.
        let order = if set_wins {
            [(reset, StlInsn::Reset), (set, StlInsn::Set)]
        } else {
            [(set, StlInsn::Set), (reset, StlInsn::Reset)]
        };
        let mut inputs = Vec::new();
        for (name, insn) in order {
            if self.is_connected(graph, at, name) {
                inputs.push((self.input(graph, plan, at, name), insn));
            }
        }
        // Both inputs count as they are before the box writes.
        if let [_, (second, _)] = &mut inputs[..]
            && second.reads(&operand)
        {
            *second = self.stored(second);
        }
        for (value, insn) in &inputs {
            self.evaluate(value);
            self.push(*insn, Some(operand.clone()));
        }
        if self.is_wanted(graph, plan, at, "q") {
            self.push(StlInsn::And, Some(operand));
            self.result(graph, plan, at, "q");
        } else if inputs.len() == 2 {
            self.open_pin();
        }
    }

    fn return_coil(&mut self, graph: &Graph, plan: &Plan, at: usize, value: ReturnValue) {
        let flow = self.input(graph, plan, at, "in");
        self.sets_br = true;
        let eno = match value {
            ReturnValue::True => Logic::Constant(true),
            ReturnValue::False => Logic::Constant(false),
            ReturnValue::Operand if self.is_connected(graph, at, "operand") => self.input(graph, plan, at, "operand"),
            ReturnValue::Operand if !self.keeps_br && !matches!(flow, Logic::Constant(_)) => {
                self.evaluate(&flow);
                self.push(StlInsn::Save, None);
                return self.push(StlInsn::BlockEndConditional, None);
            }
            ReturnValue::Operand => Logic::Constant(true),
        };
        self.under(&flow, |maker| {
            maker.evaluate(&eno);
            maker.push(StlInsn::Save, None);
            maker.push(StlInsn::BlockEndUnconditional, None);
        });
    }

    /// Statements that run under the flow of an element.
    fn under_flow(&mut self, graph: &Graph, plan: &Plan, at: usize, body: impl FnOnce(&mut Self)) {
        let flow = self.input(graph, plan, at, "in");
        self.under(&flow, body);
    }

    /// Statements that run if the flow is 1; returns the place of the one that skips them, if any does.
    pub fn under(&mut self, flow: &Logic, body: impl FnOnce(&mut Self)) -> Option<usize> {
        match flow {
            Logic::Constant(true) => body(self),
            Logic::Constant(false) => {}
            flow => {
                let label = self.new_label();
                self.evaluate(flow);
                let jump = self.jump(StlInsn::JumpIfNot, &label);
                body(self);
                self.label(&label);
                return Some(jump);
            }
        }
        None
    }

    // Pins.

    /// The operand of a pin that must have one.
    pub fn pin_operand(&mut self, element: &Element, name: &str) -> Option<Operand> {
        match element.pin(name).map(|pin| &pin.value) {
            Some(PinValue::Operand(value)) => self.operand(value),
            Some(PinValue::Net(_)) => {
                self.refuse(element.span, format!("a wire at the pin `{name}`"), "connect an operand");
                None
            }
            Some(PinValue::Open) | None => {
                self.refuse(element.span, format!("an element whose pin `{name}` is open"), "connect an operand");
                None
            }
        }
    }

    pub fn jump_label(&mut self, element: &Element, name: &str) -> Option<String> {
        match element.pin(name).map(|pin| &pin.value) {
            Some(PinValue::Operand(Expr { kind: ExprKind::Name(name), .. })) => {
                Some(self.labels.get(&name.text.to_lowercase()).cloned().unwrap_or_else(|| name.text.clone()))
            }
            _ => {
                self.refuse(element.span, "a jump without a label", "name the label");
                None
            }
        }
    }
}

/// A data block that OPN opens, in the register that is meant.
fn opened(operand: Operand, di: bool) -> Operand {
    use plcc_syntax::ast::{BlockName, BlockPrefix};
    match operand.kind {
        OperandKind::Block(BlockName::Numbered { number, span, .. }) => {
            let prefix = if di { BlockPrefix::Di } else { BlockPrefix::Db };
            Operand { kind: OperandKind::Block(BlockName::Numbered { prefix, number, span }), ..operand }
        }
        _ => operand,
    }
}
