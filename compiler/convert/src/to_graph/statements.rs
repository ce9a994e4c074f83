//! What the statements of a network do: signals, and what they lead to.

use std::collections::{HashMap, HashSet};

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast::{self, BlockName, CellKind, CodeBlock, Operand, OperandKind, Statement, StatementKind};
use plcc_syntax::network::ast::{Graph, Language, Pin, PinValue};
use plcc_syntax::scl::ast::{Expr, ExprKind, Name, NameForm};
use plcc_syntax::stl::StlInsn;

use crate::to_stl::types::Types;

use super::branches::Branches;
use super::drawing::{Drawing, Reason, Signal, pin};
use super::logic::{Join, Logic};
use super::operand::{Kind, compared, compares, expression, flag, keeps_bits, typed};

/// A network that is drawn.
pub struct Drawn {
    pub labels: Vec<Name>,
    pub graph: Graph,
    /// What is not quite the same as the statements.
    pub notes: Vec<Diagnostic>,
}

/// A statement that has no form.
pub struct Refused {
    pub span: Span,
    pub reason: Reason,
}

/// What a network is drawn for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    Conversion,
    /// Types that are not known do not matter. `branches`: bits of local data are lines.
    Picture {
        branches: bool,
    },
}

/// The labels of a network, and its elements.
pub fn graph(
    network: &ast::Network,
    (block, jumps): (&CodeBlock, &Jumps),
    types: &Types,
    language: Language,
    (span, purpose): (Span, Purpose),
) -> Result<Drawn, Vec<Diagnostic>> {
    let mut reader = Reader {
        drawing: Drawing::new(language, span),
        logic: Logic::default(),
        nesting: Vec::new(),
        loads: Vec::new(),
        fresh: true,
        chain: None,
        types,
        block,
        jumps,
        is_picture: purpose != Purpose::Conversion,
        branches: (purpose == Purpose::Picture { branches: true }).then(Branches::default),
        closed: HashSet::new(),
        labels: Vec::new(),
        notes: Vec::new(),
    };
    let statements: Vec<&Statement> = network
        .statements
        .iter()
        .filter(|statement| {
            statement.label.is_some() || !matches!(statement.kind, StatementKind::Empty | StatementKind::Pragma(_))
        })
        .collect();
    if let Err(Refused { span, reason }) = reader.sequence(&statements, true) {
        return Err(vec![refusal(span, &reason, language)]);
    }
    let end = network.statements.last().map_or(span, |statement| statement.span);
    if !reader.nesting.is_empty() || !reader.fresh && reader.logic.is_open() {
        return Err(vec![refusal(end, "a result of logic that nothing uses", language)]);
    }
    if !reader.loads.is_empty() {
        return Err(vec![refusal(end, "a value in the accumulator that nothing uses", language)]);
    }
    if reader.branches.as_ref().is_some_and(Branches::has_unused) {
        return Err(vec![refusal(end, "a branch that is not continued", language)]);
    }
    Ok(Drawn { labels: reader.labels, graph: reader.drawing.graph, notes: reader.notes })
}

pub(super) fn refusal(span: Span, reason: &str, language: Language) -> Diagnostic {
    let name = if language == Language::Fbd { "FBD" } else { "LAD" };
    Diagnostic::new(Code::NotConverted, span, format!("{name} has no form for {reason}"))
        .label("cannot be drawn")
        .help("leave the block in STL, or write the network as contacts, coils and boxes")
}

/// NOP, BLD, or nothing.
fn does_nothing(statement: &Statement) -> bool {
    match &statement.kind {
        StatementKind::Empty => true,
        StatementKind::Instruction { insn, .. } => matches!(insn, StlInsn::Nop | StlInsn::Display),
        StatementKind::Call(_) | StatementKind::Pragma(_) | StatementKind::Error => false,
    }
}

/// `SAVE; BEC` at the end of a network: STEP 7 makes them of the coil RET.
fn returns(rest: &[&Statement]) -> bool {
    let is = |statement: &Statement, wanted: StlInsn| match &statement.kind {
        StatementKind::Instruction { insn, .. } => *insn == wanted && statement.label.is_none(),
        StatementKind::Call(_) | StatementKind::Empty | StatementKind::Pragma(_) | StatementKind::Error => false,
    };
    let [save, end, after @ ..] = rest else { return false };
    is(save, StlInsn::Save)
        && is(end, StlInsn::BlockEndConditional)
        && after.iter().all(|statement| does_nothing(statement))
}

/// What reads the statements of a network.
pub struct Reader<'a> {
    pub drawing: Drawing,
    pub logic: Logic,
    /// Around open parentheses.
    pub nesting: Vec<(Logic, Join, bool)>,
    /// Values that are loaded.
    pub loads: Vec<(Expr, Span, Kind)>,
    /// The RLO has been used: the next scan begins a new string of logic, another coil shares it.
    pub fresh: bool,
    /// The last coil, and its flow.
    pub chain: Option<(usize, Signal)>,
    pub types: &'a Types<'a>,
    pub block: &'a CodeBlock,
    pub jumps: &'a Jumps,
    /// Types that are not known do not matter.
    pub is_picture: bool,
    /// None: bits of local data are coils and contacts.
    pub branches: Option<Branches>,
    /// Labels at the ends of boxes.
    pub closed: HashSet<String>,
    labels: Vec<Name>,
    notes: Vec<Diagnostic>,
}

/// How many statements of a block jump to each of its labels.
pub type Jumps = HashMap<String, usize>;

/// The jumps of a block.
pub fn jumps(networks: &[ast::Network]) -> Jumps {
    let mut jumps = Jumps::new();
    for statement in networks.iter().flat_map(|network| &network.statements) {
        if let StatementKind::Instruction { operand: Some(Operand { kind: OperandKind::Label(label), .. }), .. } =
            &statement.kind
        {
            *jumps.entry(label.clone()).or_default() += 1;
        }
    }
    jumps
}

impl Reader<'_> {
    /// Statements one after the other. `is_whole`: they are a network, so that the last one may jump.
    pub fn sequence(&mut self, statements: &[&Statement], is_whole: bool) -> Result<(), Refused> {
        let mut at = 0;
        while let Some(statement) = statements.get(at) {
            let here = |reason: Reason| Refused { span: statement.span, reason };
            self.drawing.at(statement.span);
            match &statement.label {
                Some(label) if self.closed.contains(&label.name) => {}
                Some(_) if at > 0 || !is_whole => return Err(here("a label inside a network".to_string())),
                Some(label) => {
                    self.labels.push(Name { text: label.name.clone(), form: NameForm::Bare, span: label.span });
                }
                None => {}
            }
            if is_whole && self.is_picture && returns(&statements[at..]) {
                let flow = self.flow().map_err(here)?;
                let pins = self.drawing.input("in", &flow).map_err(here)?.into_iter().collect();
                self.drawing.element("ReturnCoil", pins, None);
                return Ok(());
            }
            if let Some(len) = self.boxed(&statements[at..])? {
                at += len;
                continue;
            }
            let last = is_whole && statements[at + 1..].iter().all(|rest| does_nothing(rest));
            self.statement(statement, last).map_err(here)?;
            at += 1;
        }
        Ok(())
    }

    /// A box whose BR differs from that of the statements after an overflow.
    pub fn note(&mut self, span: Span) {
        if !self.is_picture {
            let title = "BR is 0 after this box has an overflow; the statements leave it 1";
            let mut message = Diagnostic::new(Code::NotConverted, span, title);
            message.severity = Severity::Warning;
            let message = message.label("a box without `AN OV`, `SAVE`");
            self.notes.push(message.help("look where ENO of this block is used, and where BR is"));
        }
    }

    fn statement(&mut self, statement: &Statement, last: bool) -> Result<(), Reason> {
        match &statement.kind {
            StatementKind::Empty | StatementKind::Pragma(_) => Ok(()),
            StatementKind::Error => Err("a statement that was not understood".to_string()),
            StatementKind::Call(call) => self.call(call),
            StatementKind::Instruction { insn, operand, .. } => {
                self.instruction(*insn, operand.as_ref(), statement.span, last)
            }
        }
    }

    fn instruction(&mut self, insn: StlInsn, operand: Option<&Operand>, span: Span, last: bool) -> Result<(), Reason> {
        use StlInsn as I;
        let named = || format!("`{}` here", insn.mnemonic(plcc_syntax::stl::Mnemonics::En));
        if let Some(done) = self.branch(insn, operand) {
            return done;
        }
        match insn {
            I::Nop | I::Display => Ok(()),
            I::And => self.scan(Join::And, operand, false),
            I::AndNot => self.scan(Join::And, operand, true),
            I::Or if operand.is_none() => {
                let Some(current) = self.logic.current.take().filter(|_| !self.fresh) else { return Err(named()) };
                self.logic.alternatives.push(current);
                Ok(())
            }
            I::Or => self.scan(Join::Or, operand, false),
            I::OrNot => self.scan(Join::Or, operand, true),
            I::Xor => self.scan(Join::Xor, operand, false),
            I::XorNot => self.scan(Join::Xor, operand, true),
            I::AndNest => self.open(Join::And, false),
            I::AndNotNest => self.open(Join::And, true),
            I::OrNest => self.open(Join::Or, false),
            I::OrNotNest => self.open(Join::Or, true),
            I::XorNest => self.open(Join::Xor, false),
            I::XorNotNest => self.open(Join::Xor, true),
            I::CloseNest => {
                let value = self.logic.value().filter(|_| !self.fresh);
                let (Some(value), Some((around, join, negated))) = (value, self.nesting.pop()) else {
                    return Err(named());
                };
                self.logic = around;
                self.fresh = false;
                self.join(join, if negated { value.inverted() } else { value });
                Ok(())
            }
            I::Not => {
                let Some(value) = self.logic.value() else { return Err(named()) };
                self.logic = Logic { alternatives: Vec::new(), current: Some(value.inverted()) };
                Ok(())
            }
            I::SetRlo | I::ClearRlo => {
                self.unused(span)?;
                self.logic = Logic { alternatives: Vec::new(), current: Some(Signal::Constant(insn == I::SetRlo)) };
                self.fresh = true;
                Ok(())
            }
            I::Assign => self.coil("Coil", operand),
            I::Set => match operand.map(|operand| &operand.kind) {
                Some(OperandKind::Cell { kind: CellKind::Counter, .. }) => {
                    self.cell_coil("SC_Coil", "counter", "pv", operand)
                }
                _ => self.coil("S_Coil", operand),
            },
            I::Reset => self.coil("R_Coil", operand),
            I::Save => {
                let flow = self.flow()?;
                let pins = self.drawing.input("in", &flow)?.into_iter().collect();
                let element = self.drawing.element("SaveCoil", pins, None);
                self.chain(element, flow);
                Ok(())
            }
            I::EdgePositive | I::EdgeNegative => {
                let bit = expression(operand.ok_or_else(named)?)?;
                let Some(of) = self.logic.value() else { return Err(named()) };
                let edge = Signal::Edge { of: Box::new(of), bit, rising: insn == I::EdgePositive, span };
                self.logic = Logic { alternatives: Vec::new(), current: Some(edge) };
                self.fresh = false;
                Ok(())
            }
            I::Load => {
                if self.loads.len() == 2 {
                    return Err("a third value in the accumulators".to_string());
                }
                let operand = operand.ok_or_else(named)?;
                self.loads.push((expression(operand)?, span, self.kind_of(operand)));
                Ok(())
            }
            I::Transfer => self.transfer(operand.ok_or_else(named)?),
            I::TimerPulse => self.cell_coil("S_PULSE", "timer", "tv", operand),
            I::TimerExtendedPulse => self.cell_coil("S_PEXT", "timer", "tv", operand),
            I::TimerOnDelay => self.cell_coil("S_ODT", "timer", "tv", operand),
            I::TimerRetentiveOnDelay => self.cell_coil("S_ODTS", "timer", "tv", operand),
            I::TimerOffDelay => self.cell_coil("S_OFFDT", "timer", "tv", operand),
            I::CountUp => self.cell_coil("CU_Coil", "counter", "", operand),
            I::CountDown => self.cell_coil("CD_Coil", "counter", "", operand),
            I::Jump | I::JumpIf | I::JumpIfNot if last && self.nesting.is_empty() => {
                let Some(OperandKind::Label(label)) = operand.map(|operand| &operand.kind) else { return Err(named()) };
                let flow = match insn {
                    I::Jump => {
                        self.unused(span)?;
                        Signal::Constant(true)
                    }
                    _ => self.flow()?,
                };
                let target =
                    Expr { kind: ExprKind::Name(Name { text: label.clone(), form: NameForm::Bare, span }), span };
                let mut pins: Vec<Pin> = self.drawing.input("in", &flow)?.into_iter().collect();
                pins.push(pin("label", PinValue::Operand(target), false, false, span));
                self.drawing.element(if insn == I::JumpIfNot { "I_JumpCoil" } else { "JumpCoil" }, pins, None);
                Ok(())
            }
            I::OpenDb => {
                self.unused(span)?;
                let operand = operand.ok_or_else(named)?;
                let di = matches!(
                    &operand.kind,
                    OperandKind::Block(BlockName::Numbered { prefix: ast::BlockPrefix::Di, .. })
                );
                let block = pin("operand", PinValue::Operand(expression(operand)?), false, false, span);
                let mut pins: Vec<Pin> = self.drawing.input("in", &Signal::Constant(true))?.into_iter().collect();
                pins.push(block);
                self.drawing.element(if di { "OpenDICoil" } else { "OpenDBCoil" }, pins, None);
                Ok(())
            }
            I::McrActivate | I::McrDeactivate | I::McrOpen | I::McrClose => {
                let (name, flow) = match insn {
                    I::McrActivate => ("McrActivateCoil", Signal::Constant(true)),
                    I::McrDeactivate => ("McrDeactivateCoil", Signal::Constant(true)),
                    I::McrClose => ("McrCloseCoil", Signal::Constant(true)),
                    _ => ("McrOpenCoil", self.flow()?),
                };
                if insn != I::McrOpen {
                    self.unused(span)?;
                }
                let pins = self.drawing.input("in", &flow)?.into_iter().collect();
                self.drawing.element(name, pins, None);
                Ok(())
            }
            I::CallUnconditional | I::CallConditional => {
                let flow = if insn == I::CallConditional { self.flow()? } else { Signal::Constant(true) };
                if insn == I::CallUnconditional {
                    self.unused(span)?;
                }
                let block = expression(operand.ok_or_else(named)?)?;
                let mut pins: Vec<Pin> = self.drawing.input("in", &flow)?.into_iter().collect();
                pins.push(pin("operand", PinValue::Operand(block), false, false, span));
                self.drawing.element("CallCoil", pins, None);
                Ok(())
            }
            _ => match compared(insn) {
                Some((element, ty)) => {
                    let [(left, ..), (right, ..)] = &self.loads[..] else {
                        return Err("a comparison without two values before it".to_string());
                    };
                    if !self.fresh && self.logic.is_open() {
                        return Err("a comparison that is not in parentheses".to_string());
                    }
                    let (left, right) = (left.clone(), right.clone());
                    let bits = if ty == "Int" { 16 } else { 32 };
                    let keeps = |kind: &Kind| !matches!(kind, Kind::Constant(literal) if !compares(literal, ty));
                    let fits = |kind: &Kind| match kind {
                        Kind::Bits(own) => *own == bits,
                        // A REAL is its bits for `==D`, and a DINT for `==R`; an element would convert it.
                        Kind::Type(own) => own.bits() == bits && (*own == Elementary::Real) == (ty == "Real"),
                        Kind::Constant(_) => true,
                        Kind::Cell | Kind::Unknown => false,
                    };
                    if !self.is_picture && self.loads.iter().any(|(_, _, kind)| *kind == Kind::Unknown) {
                        return Err("a comparison of operands whose types are not in the source".to_string());
                    }
                    if !self.is_picture && !self.loads.iter().all(|(_, _, kind)| keeps(kind)) {
                        return Err(format!("a comparison as {ty} with a constant that is not of this type"));
                    }
                    if !self.is_picture && !self.loads.iter().all(|(_, _, kind)| fits(kind)) {
                        return Err(format!("a comparison as {ty} of operands of another type"));
                    }
                    self.loads.clear();
                    let signal = Signal::Compare { element, ty, left: typed(left, ty), right: typed(right, ty), span };
                    self.logic = Logic { alternatives: Vec::new(), current: Some(signal) };
                    self.fresh = false;
                    Ok(())
                }
                None => Err(named()),
            },
        }
    }

    // Logic.

    fn scan(&mut self, join: Join, operand: Option<&Operand>, negated: bool) -> Result<(), Reason> {
        let operand = operand.ok_or("an instruction without its operand")?;
        let signal = match &operand.kind {
            OperandKind::Status(status) => Signal::Flag { element: flag(*status), span: operand.span },
            _ => Signal::Operand(expression(operand)?),
        };
        self.join(join, if negated { signal.inverted() } else { signal });
        Ok(())
    }

    pub fn join(&mut self, join: Join, signal: Signal) {
        if std::mem::replace(&mut self.fresh, false) {
            self.logic = Logic::default();
        }
        self.logic.join(join, signal);
    }

    fn open(&mut self, join: Join, negated: bool) -> Result<(), Reason> {
        if std::mem::replace(&mut self.fresh, false) {
            self.logic = Logic::default();
        }
        self.nesting.push((std::mem::take(&mut self.logic), join, negated));
        Ok(())
    }

    /// The flow to a coil; other coils after it share it.
    pub fn flow(&mut self) -> Result<Signal, Reason> {
        if self.nesting.iter().any(|(around, ..)| around.is_open()) {
            return Err("a coil inside parentheses".to_string());
        }
        let Some(value) = self.logic.value() else {
            return Err("an instruction that uses the result of logic of another network".to_string());
        };
        let again = std::mem::replace(&mut self.fresh, true);
        let value = match self.chain.take().filter(|_| again) {
            // After a coil of the same flow.
            Some((coil, signal)) if signal == value => Signal::Net(self.drawing.output(coil, "out", None)),
            Some((coil, signal)) if signal.clone().inverted() == value => {
                Signal::Net(self.drawing.output(coil, "out", None)).inverted()
            }
            _ => value,
        };
        // What is drawn is evaluated once, whatever the coils after it write.
        let value = match &value {
            Signal::Constant(_) => value,
            signal => match self.drawing.input("in", signal)? {
                Some(Pin { value: PinValue::Net(net), negated, .. }) => {
                    if negated {
                        Signal::Net(net).inverted()
                    } else {
                        Signal::Net(net)
                    }
                }
                _ => value,
            },
        };
        self.logic = Logic { alternatives: Vec::new(), current: Some(value.clone()) };
        Ok(value)
    }

    /// Another coil may follow, with the same flow.
    fn chain(&mut self, element: usize, flow: Signal) {
        if matches!(&flow, Signal::Operand(_) | Signal::Not(_)) {
            self.chain = Some((element, flow));
        }
    }

    /// An instruction that does not look at the RLO must not follow an open one.
    fn unused(&self, _span: Span) -> Result<(), Reason> {
        match self.nesting.is_empty() && (self.fresh || !self.logic.is_open()) {
            true => Ok(()),
            false => Err("an unconditional instruction after contacts".to_string()),
        }
    }

    // What a flow leads to.

    fn coil(&mut self, name: &str, operand: Option<&Operand>) -> Result<(), Reason> {
        let value = expression(operand.ok_or("a coil without operand")?)?;
        let flow = self.flow()?;
        let span = value.span;
        let mut pins: Vec<Pin> = self.connected(&flow)?.into_iter().collect();
        pins.push(pin("operand", PinValue::Operand(value), false, true, span));
        let element = self.drawing.element(name, pins, None);
        self.chain(element, flow);
        Ok(())
    }

    /// The flow pin of a coil; a coil must have one.
    pub fn connected(&mut self, flow: &Signal) -> Result<Option<Pin>, Reason> {
        match flow {
            Signal::Constant(_) => {
                self.drawing.side_input("in", flow).map(Some).and_then(|side| match self.drawing.input("in", flow)? {
                    Some(pin) => Ok(Some(pin)),
                    None => Ok(side),
                })
            }
            flow => self.drawing.input("in", flow),
        }
    }

    fn cell_coil(&mut self, name: &str, cell: &str, value: &str, operand: Option<&Operand>) -> Result<(), Reason> {
        let operand = expression(operand.ok_or("an instruction without its cell")?)?;
        let span = operand.span;
        let flow = self.flow()?;
        let loaded = match (&self.loads[..], value) {
            ([], "") => None,
            ([(loaded, ..)], value) if !value.is_empty() => {
                Some(pin(value, PinValue::Operand(loaded.clone()), false, false, span))
            }
            _ => return Err("a timer or counter without exactly its value before it".to_string()),
        };
        self.loads.clear();
        let flow_pin = if name.starts_with("S_") { "s" } else { "in" };
        let mut pins: Vec<Pin> = self.connected(&flow)?.into_iter().collect();
        pins.iter_mut().for_each(|pin| pin.name = flow_pin.to_string());
        pins.push(pin(cell, PinValue::Operand(operand), false, false, span));
        pins.extend(loaded);
        let element = self.drawing.element(name, pins, None);
        self.chain(element, flow);
        Ok(())
    }

    /// `L a; T b`.
    fn transfer(&mut self, operand: &Operand) -> Result<(), Reason> {
        self.unused(operand.span)?;
        let [(value, span, from)] = &self.loads[..] else {
            return Err("a transfer without exactly one value before it".to_string());
        };
        self.can_move(from, operand)?;
        let (value, span) = (value.clone(), *span);
        self.loads.clear();
        let mut pins: Vec<Pin> = self.drawing.input("en", &Signal::Constant(true))?.into_iter().collect();
        pins.push(pin("in", PinValue::Operand(value), false, false, span));
        pins.push(pin("out1", PinValue::Operand(expression(operand)?), false, true, operand.span));
        self.drawing.element("Move", pins, None);
        Ok(())
    }

    /// MOVE has the bits that `L` and `T` have.
    pub fn can_move(&self, from: &Kind, operand: &Operand) -> Result<(), Reason> {
        let to = self.kind_of(operand);
        let target = match &to {
            Kind::Bits(bits) => Some((*bits, None)),
            Kind::Type(ty) => Some((ty.bits(), Some(*ty))),
            Kind::Constant(_) | Kind::Cell | Kind::Unknown => None,
        };
        match (from, target) {
            _ if self.is_picture => Ok(()),
            (Kind::Constant(literal), Some((bits, ty))) if keeps_bits(literal, bits, ty) => Ok(()),
            (Kind::Constant(_), Some(_)) => Err("a transfer of a constant to an operand of another type".to_string()),
            (Kind::Bits(_) | Kind::Type(_), _) if *from == to => Ok(()),
            // An address has the type of the other operand.
            (Kind::Bits(bits), Some((width, _))) if *bits == width => Ok(()),
            (Kind::Type(ty), Some((width, _))) if matches!(to, Kind::Bits(_)) && ty.bits() == width => Ok(()),
            (Kind::Cell, _) => Err("the value of a timer or counter without its box".to_string()),
            (Kind::Bits(_) | Kind::Type(_), Some(_)) => {
                Err("a transfer between operands of different types".to_string())
            }
            _ => Err("a transfer between operands whose types are not in the source".to_string()),
        }
    }

    /// What is known of the type of an operand.
    pub fn kind_of(&self, operand: &Operand) -> Kind {
        match &operand.kind {
            OperandKind::Cell { .. } => Kind::Cell,
            OperandKind::Literal(literal) => Kind::Constant(literal.clone()),
            OperandKind::Absolute { width, .. } | OperandKind::DbAbsolute { width, .. } => Kind::Bits(width.bits()),
            kind => self.types.of(kind, self.block).map_or(Kind::Unknown, Kind::Type),
        }
    }

    fn call(&mut self, call: &ast::Call) -> Result<(), Reason> {
        self.unused(call.target.span)?;
        let is_plain = matches!(call.target.kind, OperandKind::Block(_));
        if !call.parameters.is_empty() || call.instance.is_some() || !is_plain {
            self.call_box(call, &Signal::Constant(true))?;
            (self.logic, self.fresh) = (Logic::default(), true);
            return Ok(());
        }
        let block = expression(&call.target)?;
        let mut pins: Vec<Pin> = self.drawing.input("in", &Signal::Constant(true))?.into_iter().collect();
        pins.push(pin("operand", PinValue::Operand(block), false, false, call.target.span));
        self.drawing.element("CallCoil", pins, None);
        Ok(())
    }
}
