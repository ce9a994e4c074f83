//! Networks of the S7-200 as rungs. The logic stack has spans of parts: `LD` begins one, `A` goes on, `O` is beside it, `ALD` and `OLD`
//! join two, `LPS` begins a branch.

use plcc_syntax::ast::Width;
use plcc_syntax::s7200::ast::{Area, Direct, Operand, OperandKind, Statement, StatementKind};
use plcc_syntax::s7200::{Acts, Compare, Contact, Insn, OperandClass};
use plcc_syntax::stl::Mnemonics;

use super::rungs::{Rungs, Span, side};
use super::s7200_boxes::{Face, face};
use super::{Label, Link, Look, Meaning, Pin, Place, Sheet};

/// A subroutine as its box shows it.
pub struct Subroutine {
    /// Its symbol; empty if it has none.
    pub name: String,
    /// The names of its parameters, and whether they are outputs.
    pub formals: Vec<(String, bool)>,
}

/// Finds a subroutine by its name or number, such as `Scale` or `SBR0`, and the number of its arguments.
pub type Subroutines<'a> = dyn Fn(&str, usize) -> Option<Subroutine> + 'a;

/// The rungs of a network. `label` finds the operand at a place of the source. `Err`: why it cannot be drawn; empty if it has no statements.
pub fn sheet(
    statements: &[Statement],
    label: &dyn Fn(&Operand) -> Label,
    subroutines: &Subroutines,
) -> Result<Sheet, String> {
    let wires = wires(statements).into_iter().map(|bit| (bit, None)).collect();
    let mut maker =
        Maker { rungs: Rungs::default(), stack: Vec::new(), eno: None, wires, flows: Vec::new(), subroutines };
    for statement in statements {
        maker.rungs.statement = Some(statement.span.start);
        match &statement.kind {
            StatementKind::Instruction { insn: Insn::Assign, operands, .. } if maker.begins_wire(operands) => {}
            StatementKind::Instruction { insn, operands, .. } => {
                maker.flows = operands.iter().map(|operand| maker.wire(operand)).collect();
                let labelled = |(at, operand): (usize, &Operand)| match insn.operands().get(at) {
                    Some(class) if is_word(*class) => label(operand).into_word(),
                    _ => label(operand),
                };
                let labels: Vec<Label> = operands.iter().enumerate().map(labelled).collect();
                let name = insn.mnemonic(Mnemonics::En).to_string();
                maker.instruction(*insn, &name, labels).map_err(|reason| format!("`{name}` {reason}"))?;
            }
            StatementKind::Pragma { .. } => {}
            StatementKind::Error => return Err("a statement could not be read".to_string()),
        }
    }
    if maker.rungs.part_count() == 0 {
        // A network without statements needs no reason.
        let is_empty = statements.iter().all(|statement| matches!(statement.kind, StatementKind::Pragma { .. }));
        return Err(if is_empty { String::new() } else { "there is nothing to draw".to_string() });
    }
    match maker.stack.iter().find(|span| !maker.rungs.is_used(span.end)) {
        Some(_) => Err("a result of logic is not used".to_string()),
        None => Ok(maker.rungs.sheet()),
    }
}

/// Whether an operand of the class is a word: of a timer or counter its current value, not its bit.
fn is_word(class: OperandClass) -> bool {
    use OperandClass::*;
    matches!(class, WordIn | IntIn | WordOut | WordOutAnalog | WordsIn | WordsOut | Table)
}

/// A bit of local memory: byte and bit.
type LocalBit = (u32, u8);

/// The bits of local memory that Micro/WIN has for itself: L60.0 to L63.7.
fn local_bit(operand: &Operand) -> Option<LocalBit> {
    match operand.kind {
        OperandKind::Direct(Direct { area: Area::L, width: Some(Width::Bit), number: number @ 60..=63, bit }) => {
            Some((number, bit))
        }
        _ => None,
    }
}

/// The bits by which Micro/WIN writes the rungs that lead to EN and to other inputs of a call: `= L60.0` and `= L63.7` at their ends, then
/// `LD L60.0` and `CALL Motor, L63.7`. Each is written once, at the end of a rung, and read once.
fn wires(statements: &[Statement]) -> Vec<LocalBit> {
    let instructions = statements.iter().filter_map(|statement| match &statement.kind {
        StatementKind::Instruction { insn, operands, .. } => Some((*insn, operands.as_slice())),
        StatementKind::Pragma { .. } | StatementKind::Error => None,
    });
    let list: Vec<(Insn, &[Operand])> = instructions.collect();
    let begins_rung = |insn: Insn| {
        matches!(insn, Insn::Load | Insn::LoadNot | Insn::LoadNow | Insn::LoadNotNow)
            || matches!(insn, Insn::Compare(Compare { contact: Contact::Load, .. }))
    };
    let mut found = Vec::new();
    for (at, (_, operands)) in list.iter().enumerate().filter(|(_, (insn, _))| *insn == Insn::Call) {
        let before = &list[..at];
        let writes = |(insn, operands): (Insn, &[Operand]), bit: LocalBit| {
            insn == Insn::Assign && operands.iter().any(|operand| local_bit(operand) == Some(bit))
        };
        let ends_rung = |bit: LocalBit| before.windows(2).any(|pair| writes(pair[0], bit) && begins_rung(pair[1].0));
        let uses = |bit: LocalBit| {
            list.iter().flat_map(|(_, operands)| *operands).filter(|operand| local_bit(operand) == Some(bit)).count()
        };
        let enable = before.last().filter(|(insn, _)| *insn == Insn::Load).and_then(|(_, operands)| operands.first());
        let inputs = enable.into_iter().chain(operands.iter().skip(1)).filter_map(local_bit);
        found.extend(inputs.filter(|bit| uses(*bit) == 2 && ends_rung(*bit)));
    }
    found
}

struct Maker<'a> {
    subroutines: &'a Subroutines<'a>,
    rungs: Rungs,
    stack: Vec<Span>,
    /// The box whose ENO the next statement may continue.
    eno: Option<usize>,
    /// Bits by which rungs are written, with their rungs once they have ended.
    wires: Vec<(LocalBit, Option<Span>)>,
    /// The rungs that lead to the operands of the statement.
    flows: Vec<Option<Span>>,
}

/// The logic stack has nine levels.
const STACK: usize = 9;

impl Maker<'_> {
    fn top(&self) -> Result<Span, String> {
        self.stack.last().copied().ok_or_else(|| "has no logic before it".to_string())
    }

    fn pop(&mut self) -> Result<Span, String> {
        self.stack.pop().ok_or_else(|| "has no logic before it".to_string())
    }

    fn push(&mut self, span: Span) -> Result<(), String> {
        self.stack.push(span);
        if self.stack.len() > STACK { Err("needs more levels than the logic stack has".to_string()) } else { Ok(()) }
    }

    /// Whether `= L63.7` ends a rung that leads to an input.
    fn begins_wire(&mut self, operands: &[Operand]) -> bool {
        let bit = operands.first().and_then(local_bit);
        let wire = self.wires.iter_mut().find(|(wire, _)| Some(*wire) == bit);
        if let (Some((_, rung)), Some(top)) = (wire, self.stack.last().copied())
            && !top.shared
        {
            *rung = Some(top);
            self.stack.pop();
            return true;
        }
        false
    }

    /// The rung that leads to an operand.
    fn wire(&self, operand: &Operand) -> Option<Span> {
        let bit = local_bit(operand)?;
        self.wires.iter().find(|(wire, _)| *wire == bit)?.1
    }

    /// A contact beside the whole span.
    fn beside(&mut self, add: impl FnOnce(&mut Rungs, usize, usize)) -> Result<(), String> {
        let span = self.top()?;
        if span.shared || self.rungs.is_used(span.end) {
            return Err("would be beside a branch that already leads elsewhere".to_string());
        }
        add(&mut self.rungs, span.start, span.end);
        Ok(())
    }

    fn instruction(&mut self, insn: Insn, name: &str, labels: Vec<Label>) -> Result<(), String> {
        let contact = |name: &str, stem: usize| -> &'static str {
            let rest = &name[stem..];
            match (rest.contains('N'), rest.contains('I')) {
                (false, false) => "",
                (true, false) => "/",
                (false, true) => "I",
                (true, true) => "/I",
            }
        };
        match insn {
            Insn::Load | Insn::LoadNot | Insn::LoadNow | Insn::LoadNotNow => {
                let rung = self.flows.first().copied().flatten();
                let span = rung.unwrap_or_else(|| self.rungs.load(contact(name, 2), labels));
                self.push(span)?;
            }
            Insn::And | Insn::AndNot | Insn::AndNow | Insn::AndNotNow => {
                let span = self.pop()?;
                let span = self.rungs.then(span, contact(name, 1), labels);
                self.push(span)?;
            }
            Insn::Or | Insn::OrNot | Insn::OrNow | Insn::OrNotNow => {
                let sign = contact(name, 1);
                self.beside(|rungs, from, to| rungs.contact(sign, labels, from, to))?;
            }
            Insn::Not | Insn::RisingEdge | Insn::FallingEdge => {
                let sign = match insn {
                    Insn::Not => "NOT",
                    Insn::RisingEdge => "P",
                    _ => "N",
                };
                let span = self.pop()?;
                let span = self.rungs.then(span, sign, labels);
                self.push(span)?;
            }
            Insn::Compare(_) => self.compare(name, labels)?,
            Insn::AndLoad | Insn::OrLoad => {
                let (second, first) = (self.pop()?, self.pop()?);
                if insn == Insn::AndLoad {
                    if second.whole {
                        return Err("joins an edge or NOT that is not of the logic before it".to_string());
                    }
                    self.rungs.join(first.end, second.start);
                    self.push(Span { end: second.end, shared: false, ..first })?;
                } else {
                    if first.shared || self.rungs.is_used(first.end) {
                        return Err("would be beside a branch that already leads elsewhere".to_string());
                    }
                    self.rungs.join(first.start, second.start);
                    self.rungs.join(first.end, second.end);
                    self.push(Span { whole: first.whole || second.whole, ..first })?;
                }
            }
            Insn::Push => {
                let span = self.top()?;
                self.push(Span { shared: true, ..span })?;
            }
            Insn::Read => {
                self.pop()?;
                let span = self.top()?;
                self.push(Span { shared: true, ..span })?;
            }
            Insn::Pop => {
                self.pop()?;
                let span = self.pop()?;
                self.push(Span { shared: true, ..span })?;
            }
            Insn::LoadStack => return Err("has no element of LAD".to_string()),
            Insn::AndEno => {
                self.eno.take().ok_or("has no box before it")?;
                let net = self.rungs.eno().ok_or("has no box before it")?;
                let span = self.pop()?;
                self.push(Span { end: net, shared: false, ..span })?;
                return Ok(());
            }
            Insn::Nop => {}
            Insn::Ctu | Insn::Ctd => {
                let (second, first) = (self.pop()?, self.pop()?);
                let (count, other) = if insn == Insn::Ctu { ("CU", "R") } else { ("CD", "LD") };
                self.counter(name, labels, &[(count, first), (other, second)]);
            }
            Insn::Ctud => {
                let (third, second, first) = (self.pop()?, self.pop()?, self.pop()?);
                self.counter(name, labels, &[("CU", first), ("CD", second), ("R", third)]);
            }
            Insn::Assign | Insn::AssignNow | Insn::Set | Insn::Reset | Insn::SetNow | Insn::ResetNow => {
                let span = self.top()?;
                self.rungs.rail(span);
                let sign = name.trim_start_matches('=');
                self.rungs.coil(sign, labels, span.end);
            }
            other => self.other(other, name, labels)?,
        }
        if !matches!(insn, Insn::Nop) {
            self.eno = None;
        }
        if insn.eno() != "-" {
            self.eno = Some(0);
        }
        Ok(())
    }

    /// `LDW>=`, `AB=`, `OR<>`: a compare contact.
    fn compare(&mut self, name: &str, labels: Vec<Label>) -> Result<(), String> {
        let (joins, rest) = match name.strip_prefix("LD") {
            Some(rest) => ('L', rest),
            None => {
                name.split_at_checked(1).map_or(('L', name), |(head, rest)| (head.chars().next().unwrap_or('L'), rest))
            }
        };
        let at = rest.find(['=', '<', '>']).unwrap_or(0);
        let (ty, sign) = rest.split_at(at);
        let sign = if sign == "=" { "==" } else { sign };
        // Words are compared as integers, and called so in LAD.
        let ty = if ty == "W" { "I" } else { ty };
        let mut pins: Vec<Pin> = Vec::new();
        for (index, label) in labels.into_iter().enumerate() {
            let place = if index == 0 { Place::Above } else { Place::Below };
            pins.push(Pin { name: String::new(), place, output: false, link: Link::Operand(label), negated: false });
        }
        let look = Look::Compare { sign: sign.to_string(), ty: ty.to_string() };
        let meaning = Meaning::Compare { sign: sign.to_string(), inverse: false };
        match joins {
            'L' => {
                let (start, end) = (self.rungs.net(), self.rungs.net());
                self.rungs.part(look, meaning, pins, Some(start), Some(end));
                self.push(Span::between(start, end))
            }
            'A' => {
                let span = self.pop()?;
                let end = self.rungs.net();
                self.rungs.part(look, meaning, pins, Some(span.end), Some(end));
                self.push(Span { end, shared: false, ..span })
            }
            _ => self.beside(|rungs, from, to| rungs.part(look, meaning, pins, Some(from), Some(to))),
        }
    }

    fn counter(&mut self, name: &str, mut labels: Vec<Label>, inputs: &[(&str, Span)]) {
        let instance = (!labels.is_empty()).then(|| labels.remove(0));
        let mut pins: Vec<Pin> = Vec::new();
        for (name, span) in &inputs[1..] {
            self.rungs.rail(*span);
            let link = Link::Net(span.end);
            pins.push(Pin { name: (*name).to_string(), place: Place::Side, output: false, link, negated: false });
        }
        pins.extend(labels.into_iter().map(|label| side("PV", label, false)));
        self.rungs.rail(inputs[0].1);
        let look = Look::Box { title: name.to_string(), detail: String::new(), instance };
        self.rungs.part(look, Meaning::Other, pins, Some(inputs[0].1.end), None);
        self.rungs.name_input(inputs[0].0);
    }

    /// Boxes, and instructions that need no flow.
    fn other(&mut self, insn: Insn, name: &str, mut labels: Vec<Label>) -> Result<(), String> {
        let is_timer = matches!(insn, Insn::Ton | Insn::Tonr | Insn::Tof);
        // Stages of a sequence, labels and loop ends stand at the rail; all others need a result of logic, unless they are unconditional.
        let flow = match (insn.acts(), is_timer) {
            (Acts::Enabled, _) | (_, true) => Some(self.top()?),
            (Acts::Always | Acts::Marker, _) => None,
        };
        let from = match flow {
            Some(span) => {
                self.rungs.rail(span);
                span.end
            }
            None => {
                let net = self.rungs.net();
                self.rungs.rail(Span::at(net));
                net
            }
        };
        let classes = insn.operands();
        // The beginning of a step and a label are boxes, with their operand above and no name at the rail.
        if let Insn::Lscr | Insn::Lbl = insn {
            let title = if insn == Insn::Lscr { "SCR" } else { name };
            let look = Look::Box { title: title.to_string(), detail: String::new(), instance: labels.pop() };
            self.rungs.part(look, Meaning::Other, Vec::new(), Some(from), None);
            self.rungs.name_input("");
            return Ok(());
        }
        if labels.is_empty() || classes.iter().all(|class| matches!(class, OperandClass::Label | OperandClass::SBit)) {
            let sign = match insn {
                Insn::Cret => "RET",
                Insn::Creti => "RETI",
                _ => name,
            };
            self.rungs.coil(sign, labels, from);
            return Ok(());
        }
        if let Some(Face { title, detail, pins }) = face(name)
            && pins.iter().all(|pin| pin.operand < labels.len())
        {
            let pins = pins.iter().map(|pin| side(pin.name, labels[pin.operand].clone(), pin.output)).collect();
            let look = Look::Box { title, detail, instance: None };
            self.rungs.part(look, Meaning::Other, pins, Some(from), None);
            return Ok(());
        }
        let is_call = matches!(classes.first(), Some(OperandClass::Subroutine));
        let first = (is_timer || is_call).then(|| labels.remove(0));
        let skipped = usize::from(first.is_some());
        let (title, instance) = match (first, is_call) {
            (Some(label), true) => (label.text, None),
            (first, _) => (name.to_string(), first),
        };
        let called = if is_call { (self.subroutines)(&title, labels.len()) } else { None };
        let (title, formals) = match called {
            Some(Subroutine { name, formals }) if !name.is_empty() => (name, formals),
            Some(Subroutine { formals, .. }) => (title, formals),
            None => (title, Vec::new()),
        };
        let mut pins: Vec<Pin> = Vec::new();
        let mut inputs = 0;
        for (index, label) in labels.into_iter().enumerate() {
            let (name, output) = match formals.get(index) {
                Some((formal, output)) => (formal.clone(), *output),
                None => {
                    let output = classes.get(index + skipped).is_some_and(|class| is_output(*class));
                    inputs += usize::from(!output);
                    let name = match (output, is_timer, index) {
                        (true, ..) => "OUT".to_string(),
                        (false, true, _) => "PT".to_string(),
                        (false, false, _) if is_call => format!("{}", index + 1),
                        (false, false, _) if inputs == 1 => "IN".to_string(),
                        (false, false, _) => format!("IN{inputs}"),
                    };
                    (name, output)
                }
            };
            let mut pin = side(&name, label, output);
            if let Some(rung) = self.flows.get(index + skipped).copied().flatten() {
                self.rungs.rail(rung);
                pin.link = Link::Net(rung.end);
            }
            pins.push(pin);
        }
        let look = Look::Box { title, detail: String::new(), instance };
        self.rungs.part(look, Meaning::Other, pins, Some(from), None);
        if is_timer {
            self.rungs.name_input("IN");
        }
        Ok(())
    }
}

fn is_output(class: OperandClass) -> bool {
    use OperandClass::*;
    matches!(
        class,
        BitWrite
            | OutputBit
            | ByteOut
            | WordOut
            | WordOutAnalog
            | DwordOut
            | RealOut
            | StringOut
            | BytesOut
            | WordsOut
            | DwordsOut
            | OutputByte
    )
}
