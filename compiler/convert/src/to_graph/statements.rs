//! What the statements of a network do: signals, and what they lead to.

use std::collections::{HashMap, HashSet};

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::ast::{self, CellKind, CodeBlock, Operand, OperandKind, Statement, StatementKind};
use plcc_syntax::network::ast::{Graph, Language, Pin, PinValue};
use plcc_syntax::scl::ast::{Expr, Name, NameForm};
use plcc_syntax::stl::{Mnemonics, StlInsn};

use crate::to_stl::types::Types;

use super::branches::Branches;
use super::drawing::{Drawing, Reason, Signal};
use super::logic::{Join, Logic};
use super::operand::{Kind, compared, expression, flag};

/// A network that is drawn.
pub struct Drawn {
    pub labels: Vec<Name>,
    pub graph: Graph,
    /// What is not quite the same as the statements.
    pub notes: Vec<Diagnostic>,
    /// It ends with SAVE, after which a scan goes on with the string of logic.
    pub is_saved: bool,
}

/// A statement that has no form.
pub struct Refused {
    pub span: Span,
    pub reason: Reason,
}

/// What a network is drawn for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// `is_saved`: the network before it ends with SAVE.
    Conversion { is_saved: bool },
    /// Types that are not known do not matter. `branches`: bits of local data are lines.
    Picture { branches: bool },
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
        is_picture: matches!(purpose, Purpose::Picture { .. }),
        is_saved: purpose == Purpose::Conversion { is_saved: true },
        is_held: false,
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
    Ok(Drawn { labels: reader.labels, graph: reader.drawing.graph, notes: reader.notes, is_saved: reader.is_saved })
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

/// The reason for an instruction that has no form where it is.
pub fn not_here(insn: StlInsn) -> Reason {
    format!("`{}` here", insn.mnemonic(Mnemonics::En))
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
    /// The last use of the RLO was SAVE, which does not end the string of logic.
    pub is_saved: bool,
    /// NOT came after branches that `O` joins: the CPU joins what an AND makes of it with them once more.
    pub is_held: bool,
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
            let len = match self.boxed(&statements[at..])? {
                Some(len) => len,
                None => {
                    let last = is_whole && statements[at + 1..].iter().all(|rest| does_nothing(rest));
                    self.statement(statement, last).map_err(here)?;
                    1
                }
            };
            statements[at..at + len].iter().for_each(|done| self.note_end(done));
            at += len;
        }
        Ok(())
    }

    /// What ends the string of logic after SAVE.
    fn note_end(&mut self, done: &Statement) {
        match &done.kind {
            // The last sign is what becomes of /FC.
            StatementKind::Instruction { insn, .. } => self.is_saved &= insn.status().ends_with('-'),
            StatementKind::Call(_) => self.is_saved = false,
            StatementKind::Empty | StatementKind::Pragma(_) | StatementKind::Error => {}
        }
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
        let named = || not_here(insn);
        if let Some(done) = self.branch(insn, operand) {
            return done;
        }
        match insn {
            I::Nop | I::Display => Ok(()),
            I::And => self.scan(Join::And, operand, false),
            I::AndNot => self.scan(Join::And, operand, true),
            I::Or if operand.is_none() => {
                self.goes_on(Join::And)?;
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
                (self.fresh, self.is_held) = (false, false);
                self.join(join, if negated { value.inverted() } else { value });
                Ok(())
            }
            I::Not => {
                let Some(value) = self.logic.value() else { return Err(named()) };
                // The next scan is the first one if the RLO was 0.
                if self.logic.current.is_none() {
                    return Err("`NOT` after `O`".to_string());
                }
                self.is_held |= !self.logic.alternatives.is_empty();
                self.logic = Logic { alternatives: Vec::new(), current: Some(value.inverted()) };
                Ok(())
            }
            I::SetRlo | I::ClearRlo => {
                self.unused()?;
                self.is_held = false;
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
                let is_open = !self.fresh;
                self.save_coil()?;
                self.is_saved = is_open;
                Ok(())
            }
            I::EdgePositive | I::EdgeNegative => {
                let bit = expression(operand.ok_or_else(named)?)?;
                let Some(of) = self.logic.value() else { return Err(named()) };
                let edge = Signal::Edge { of: Box::new(of), bit, rising: insn == I::EdgePositive, span };
                self.logic = Logic { alternatives: Vec::new(), current: Some(edge) };
                (self.fresh, self.is_held) = (false, false);
                Ok(())
            }
            I::Load => self.load(operand, span),
            I::Transfer => self.transfer(operand.ok_or_else(named)?),
            I::TimerPulse => self.cell_coil("S_PULSE", "timer", "tv", operand),
            I::TimerExtendedPulse => self.cell_coil("S_PEXT", "timer", "tv", operand),
            I::TimerOnDelay => self.cell_coil("S_ODT", "timer", "tv", operand),
            I::TimerRetentiveOnDelay => self.cell_coil("S_ODTS", "timer", "tv", operand),
            I::TimerOffDelay => self.cell_coil("S_OFFDT", "timer", "tv", operand),
            I::CountUp => self.cell_coil("CU_Coil", "counter", "", operand),
            I::CountDown => self.cell_coil("CD_Coil", "counter", "", operand),
            I::Jump | I::JumpIf | I::JumpIfNot if last && self.nesting.is_empty() => self.jump(insn, operand, span),
            I::OpenDb => self.open_db(operand, span),
            I::McrActivate | I::McrDeactivate | I::McrOpen | I::McrClose => self.mcr_coil(insn),
            I::CallUnconditional | I::CallConditional => self.call_coil(insn, operand, span),
            _ => match compared(insn) {
                Some((element, ty)) => self.compare(element, ty, span),
                None => Err(named()),
            },
        }
    }

    // Logic.

    fn scan(&mut self, join: Join, operand: Option<&Operand>, negated: bool) -> Result<(), Reason> {
        self.goes_on(join)?;
        let operand = operand.ok_or("an instruction without its operand")?;
        let signal = match &operand.kind {
            OperandKind::Status(status) => Signal::Flag { element: flag(*status), span: operand.span },
            _ => Signal::Operand(expression(operand)?),
        };
        self.join(join, if negated { signal.inverted() } else { signal });
        Ok(())
    }

    /// Before a scan: what the CPU does after SAVE, and after NOT of branches that `O` joins, is not what networks would show.
    fn goes_on(&self, join: Join) -> Result<(), Reason> {
        match () {
            () if self.is_saved => Err("logic that goes on after `SAVE`".to_string()),
            () if self.is_held && join == Join::And => Err("an AND after `NOT` of branches that `O` joins".to_string()),
            () => Ok(()),
        }
    }

    pub fn join(&mut self, join: Join, signal: Signal) {
        self.is_held = false;
        if std::mem::replace(&mut self.fresh, false) {
            self.logic = Logic::default();
        }
        self.logic.join(join, signal);
    }

    fn open(&mut self, join: Join, negated: bool) -> Result<(), Reason> {
        self.goes_on(join)?;
        self.is_held = false;
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
        (self.is_saved, self.is_held) = (false, false);
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
    pub fn chain(&mut self, element: usize, flow: Signal) {
        if matches!(&flow, Signal::Operand(_) | Signal::Not(_)) {
            self.chain = Some((element, flow));
        }
    }

    /// An instruction that does not look at the RLO must not follow an open one.
    pub fn unused(&self) -> Result<(), Reason> {
        match self.nesting.is_empty() && (self.fresh || !self.logic.is_open()) {
            true => Ok(()),
            false => Err("an unconditional instruction after contacts".to_string()),
        }
    }
}
