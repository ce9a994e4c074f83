//! Elements of networks as statements, one after the other. Source: LAD/FBD reference F.1.

use plcc_syntax::Elementary;
use plcc_syntax::ast::{Operand, OperandKind, StatusOperand};
use plcc_syntax::network::ast::{Element, Graph, Pin, PinValue, Storage, Target};
use plcc_syntax::network::elements::{CounterCoil, Flag, Gate, Kind, Mcr, ReturnValue, Row};
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

    /// A value in a variable of its own.
    pub fn stored(&mut self, value: &Logic) -> Logic {
        self.evaluate(value);
        let bit = self.temporary(Elementary::Bool);
        self.push(StlInsn::Assign, Some(bit.clone()));
        Logic::Operand(bit)
    }

    fn keep(&mut self, graph: &Graph, plan: &Plan, net: plcc_syntax::network::ast::NetId) {
        let value = self.net(graph, plan, net);
        let net = plan.canonical(net);
        let value = match value {
            Logic::Constant(_) => value,
            value if self.is_temporary(&value) => value,
            value => {
                let value = self.stored(&value);
                // The RLO still has it.
                self.rlo = Some(net);
                value
            }
        };
        self.values.insert(net, value);
    }

    fn is_temporary(&self, value: &Logic) -> bool {
        let Logic::Operand(Operand { kind: OperandKind::Path(path), .. }) = value else { return false };
        match &path.root {
            plcc_syntax::ast::PathRoot::Local { name, .. } => self.temporaries.iter().any(|(known, _)| known == name),
            _ => false,
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
            Kind::EdgeCoil { rising } => {
                let flow = self.input(graph, plan, at, "in");
                let flow = self.passed(graph, plan, at, flow);
                let (Some(bit), Some(operand)) =
                    (self.pin_operand(element, "bit"), self.pin_operand(element, "operand"))
                else {
                    return;
                };
                self.evaluate(&Logic::Edge { of: Box::new(flow), bit, rising });
                self.push(StlInsn::Assign, Some(operand));
            }
            Kind::BitField { set } => self.bit_field(graph, plan, at, set),
            Kind::FlipFlop { set_wins } => self.flip_flop(graph, plan, at, set_wins, instance),
            Kind::Jump { negated } => {
                let Some(label) = self.jump_label(element, "label") else { return };
                let flow = self.input(graph, plan, at, "in");
                match flow {
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
            Kind::JumpList => self.jump_list(graph, plan, at),
            Kind::Switch => self.switch(graph, plan, at),
            Kind::Return(value) => self.return_coil(graph, plan, at, value),
            Kind::S5Timer(name) => self.timer(graph, plan, at, name, instance),
            Kind::S5Counter(_) => self.counter(graph, plan, at, instance),
            Kind::CounterCoil(coil) => {
                let Some(cell) = self.cell(element, "counter", instance) else { return };
                let flow = self.input(graph, plan, at, "in");
                let flow = self.passed(graph, plan, at, flow);
                self.evaluate(&flow);
                let insn = match coil {
                    CounterCoil::Up => StlInsn::CountUp,
                    CounterCoil::Down => StlInsn::CountDown,
                    CounterCoil::Set => {
                        self.load_count(graph, at);
                        StlInsn::Set
                    }
                };
                self.push(insn, Some(cell));
            }
            Kind::OpenDb { di } => {
                let Some(operand) = self.pin_operand(element, "operand") else { return };
                let operand = opened(operand, di);
                self.under_flow(graph, plan, at, |maker| maker.push(StlInsn::OpenDb, Some(operand)));
            }
            Kind::CallCoil => {
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
            Kind::Mcr(coil) => {
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

    /// The flow of a coil, in a variable if something after the coil needs it.
    pub fn passed(&mut self, graph: &Graph, plan: &Plan, at: usize, flow: Logic) -> Logic {
        let element = &graph.elements[at];
        let pins: Vec<usize> = (0..element.pins.len())
            .filter(|pin| element.pins[*pin].output && element.pins[*pin].name == "out")
            .filter(|pin| match element.pins[*pin].value {
                PinValue::Net(net) => plan.canonical(net) == net && plan.is_used(net),
                PinValue::Operand(_) | PinValue::Open => false,
            })
            .collect();
        if pins.is_empty() || matches!(flow, Logic::Constant(_)) {
            pins.into_iter().for_each(|pin| drop(self.outputs.insert((at, pin), flow.clone())));
            return flow;
        }
        let flow = self.stored(&flow);
        pins.into_iter().for_each(|pin| drop(self.outputs.insert((at, pin), flow.clone())));
        flow
    }

    /// The RLO is the value of an output.
    pub fn result(&mut self, graph: &Graph, plan: &Plan, at: usize, name: &str) {
        let element = &graph.elements[at];
        let named = |pin: &Pin| pin.output && pin.name.eq_ignore_ascii_case(name);
        let pins: Vec<usize> = (0..element.pins.len()).filter(|pin| named(&element.pins[*pin])).collect();
        let is_net = |pin: &usize| matches!(element.pins[*pin].value, PinValue::Net(net) if plan.is_used(net));
        if pins.len() == 1 && pins.iter().all(is_net) && !element.pins[pins[0]].negated && plan.continues(graph, at) {
            self.outputs.insert((at, pins[0]), Logic::Rlo);
            return;
        }
        let mut kept = None;
        for pin in pins {
            let (value, negated) = (&element.pins[pin].value, element.pins[pin].negated);
            match value {
                PinValue::Operand(operand) => {
                    let Some(operand) = self.operand(operand) else { continue };
                    let insn = match element.pins[pin].storage {
                        Storage::None => StlInsn::Assign,
                        Storage::Set => StlInsn::Set,
                        Storage::Reset => StlInsn::Reset,
                    };
                    if negated {
                        self.push(StlInsn::Not, None);
                    }
                    self.push(insn, Some(operand));
                    if negated {
                        self.push(StlInsn::Not, None);
                    }
                    kept.get_or_insert(None);
                }
                PinValue::Net(net) if plan.is_used(*net) => {
                    let bit = match &kept {
                        Some(Some(bit)) => Operand::clone(bit),
                        _ => self.temporary(Elementary::Bool),
                    };
                    self.push(StlInsn::Assign, Some(bit.clone()));
                    let value = Logic::Operand(bit.clone());
                    self.outputs.insert((at, pin), if negated { value.not() } else { value });
                    kept = Some(Some(bit));
                }
                PinValue::Net(_) | PinValue::Open => {}
            }
        }
        if kept.is_none() {
            // The next scan must not be combined with this one.
            let bit = self.temporary(Elementary::Bool);
            self.push(StlInsn::Assign, Some(bit));
        }
    }

    /// Whether anything is connected to an output.
    pub fn is_wanted(&self, graph: &Graph, plan: &Plan, at: usize, name: &str) -> bool {
        graph.elements[at].pins.iter().any(|pin| {
            pin.output
                && pin.name.eq_ignore_ascii_case(name)
                && match pin.value {
                    PinValue::Net(net) => plan.is_used(net),
                    PinValue::Operand(_) => true,
                    PinValue::Open => false,
                }
        })
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

    /// What stands in the place of a pin without connection, so that the statements can be drawn as the box again.
    fn open_pin(&mut self) {
        self.push(StlInsn::Nop, Some(super::number(0, self.span)));
    }

    /// Whether a timer is a box: a coil has no pins but its start and its time.
    fn is_cell_box(&self, graph: &Graph, plan: &Plan, at: usize) -> bool {
        let wanted = ["bi", "bcd", "cv", "cv_bcd", "q"].iter().any(|name| self.is_wanted(graph, plan, at, name));
        wanted || self.is_connected(graph, at, "r")
    }

    fn timer(&mut self, graph: &Graph, plan: &Plan, at: usize, name: &str, instance: Option<&Expr>) {
        let element = &graph.elements[at];
        let Some(cell) = self.cell(element, "timer", instance) else { return };
        let insn = match name {
            "S_PULSE" => StlInsn::TimerPulse,
            "S_PEXT" => StlInsn::TimerExtendedPulse,
            "S_ODT" => StlInsn::TimerOnDelay,
            "S_ODTS" => StlInsn::TimerRetentiveOnDelay,
            _ => StlInsn::TimerOffDelay,
        };
        if self.is_connected(graph, at, "s") {
            let flow = self.input(graph, plan, at, "s");
            let flow = self.passed(graph, plan, at, flow);
            self.evaluate(&flow);
            if self.is_connected(graph, at, "tv") {
                self.load_pin(graph, at, "tv", Elementary::S5Time);
            }
            self.push(insn, Some(cell.clone()));
        }
        if self.is_cell_box(graph, plan, at) {
            self.cell_end(graph, plan, at, cell, [("bi", StlInsn::Load), ("bcd", StlInsn::LoadBcd)]);
        }
    }

    fn counter(&mut self, graph: &Graph, plan: &Plan, at: usize, instance: Option<&Expr>) {
        let element = &graph.elements[at];
        let Some(cell) = self.cell(element, "counter", instance) else { return };
        for (name, insn) in [("cu", StlInsn::CountUp), ("cd", StlInsn::CountDown), ("s", StlInsn::Set)] {
            if self.is_connected(graph, at, name) {
                let flow = self.input(graph, plan, at, name);
                self.evaluate(&flow);
                if name == "s" && self.is_connected(graph, at, "pv") {
                    self.load_count(graph, at);
                }
                self.push(insn, Some(cell.clone()));
            }
        }
        self.cell_end(graph, plan, at, cell, [("cv", StlInsn::Load), ("cv_bcd", StlInsn::LoadBcd)]);
    }

    /// The reset, the values and the output of a timer or a counter.
    fn cell_end(&mut self, graph: &Graph, plan: &Plan, at: usize, cell: Operand, pins: [(&str, StlInsn); 2]) {
        if self.is_connected(graph, at, "r") {
            let reset = self.input(graph, plan, at, "r");
            self.evaluate(&reset);
            self.push(StlInsn::Reset, Some(cell.clone()));
        } else {
            self.open_pin();
        }
        for (name, insn) in pins {
            if self.is_wanted(graph, plan, at, name) {
                self.push(insn, Some(cell.clone()));
                self.store_pin(graph, plan, at, name, Elementary::Word);
            } else {
                self.open_pin();
            }
        }
        if self.is_wanted(graph, plan, at, "q") {
            self.push(StlInsn::And, Some(cell));
            self.result(graph, plan, at, "q");
        } else {
            self.open_pin();
        }
    }

    /// The timer or counter of an element.
    fn cell(&mut self, element: &Element, pin: &str, instance: Option<&Expr>) -> Option<Operand> {
        match instance {
            Some(instance) => self.operand(instance),
            None => self.pin_operand(element, pin),
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
