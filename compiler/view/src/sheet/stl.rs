//! Networks in STL of S7-300/400 as rungs: bits that are combined and assigned, timers and counters as coils, jumps and calls at the end.

use std::collections::HashMap;

use plcc_syntax::ast::{Call, Operand, Statement, StatementKind};
use plcc_syntax::stl::{Mnemonics, StlInsn};

use super::rungs::{Rungs, Span, side};
use super::{Label, Link, Look, Meaning, Pin, Place, Sheet};

/// What the nesting stack keeps: the span before the parenthesis, and how its result is combined.
struct Outer {
    before: Option<Span>,
    branch: Option<Span>,
    opened: StlInsn,
}

struct Maker<'a> {
    rungs: Rungs,
    label: &'a dyn Fn(&Operand) -> Label,
    /// Whether the block of that name has an output of that name.
    is_output: &'a dyn Fn(&str, &str) -> bool,
    /// The result of logic; none: the next scan begins a new string.
    span: Option<Span>,
    /// The branches before an `O` without operand.
    branch: Option<Span>,
    outer: Vec<Outer>,
    /// Values in the accumulators, the last one first.
    loaded: Vec<Label>,
    /// The span was assigned: only further coils follow it.
    assigned: bool,
    /// The last use of the RLO was SAVE, which does not end the string of logic.
    saved: bool,
    /// NOT came after branches that `O` joins: the CPU joins what an AND makes of it with them once more.
    held: bool,
    /// What local bits keep: STEP 7 writes branches like that. None: they are coils and contacts.
    kept: Option<HashMap<String, Kept>>,
    /// Rungs that have begun after an assignment.
    begun: usize,
}

/// What a local bit keeps.
struct Kept {
    span: Span,
    /// A branch continues it.
    is_used: bool,
    /// The rungs that had begun.
    begun: usize,
}

/// The rungs of a network. `label` finds an operand. `branches`: local bits may be lines of branches. `Err`: why it cannot be drawn.
pub fn sheet(
    statements: &[Statement],
    label: &dyn Fn(&Operand) -> Label,
    is_output: &dyn Fn(&str, &str) -> bool,
    branches: bool,
) -> Result<Sheet, String> {
    let branched = if branches { rungs(statements, label, is_output, true) } else { Err(String::new()) };
    branched.or_else(|_| rungs(statements, label, is_output, false))
}

/// `branches`: local bits keep what branches continue.
fn rungs(
    statements: &[Statement],
    label: &dyn Fn(&Operand) -> Label,
    is_output: &dyn Fn(&str, &str) -> bool,
    branches: bool,
) -> Result<Sheet, String> {
    let mut maker = Maker {
        kept: branches.then(HashMap::new),
        rungs: Rungs::default(),
        label,
        is_output,
        span: None,
        branch: None,
        outer: Vec::new(),
        loaded: Vec::new(),
        assigned: false,
        saved: false,
        held: false,
        begun: 0,
    };
    let count = statements.len();
    for (at, statement) in statements.iter().enumerate() {
        if let (Some(mark), true) = (&statement.label, at > 0) {
            return Err(format!("the label `{}` is inside of the network", mark.name));
        }
        let is_last = statements[at + 1..]
            .iter()
            .all(|rest| !matches!(rest.kind, StatementKind::Instruction { .. } | StatementKind::Call(_)));
        maker.rungs.statement = Some(statement.span.start);
        match &statement.kind {
            StatementKind::Empty | StatementKind::Pragma(_) => {}
            StatementKind::Instruction { insn, operand, .. } => {
                let name = insn.mnemonic(Mnemonics::En);
                maker
                    .instruction(*insn, operand.as_ref(), is_last)
                    .map_err(|reason| format!("statement {} of {count}, `{name}`, {reason}", at + 1))?;
            }
            StatementKind::Call(call) => maker.call(call).map_err(|reason| format!("`CALL` {reason}"))?,
            StatementKind::Error => return Err("a statement could not be read".to_string()),
        }
    }
    let open = maker.span.is_some() && !maker.assigned || !maker.outer.is_empty();
    let unused = maker.kept.iter().flat_map(HashMap::values).any(|kept| !kept.is_used);
    match () {
        () if unused => Err("a local bit is not used".to_string()),
        () if maker.rungs.part_count() == 0 => Err(String::new()),
        () if open => Err("the result of logic at its end is not used".to_string()),
        () if !maker.loaded.is_empty() => Err("a value is loaded and not used".to_string()),
        () => Ok(maker.rungs.sheet()),
    }
}

/// All operands of a statement.
pub fn operands(statement: &Statement) -> Vec<&Operand> {
    match &statement.kind {
        StatementKind::Instruction { operand, .. } => operand.iter().collect(),
        StatementKind::Call(call) => {
            let actuals = call.parameters.iter().filter_map(|parameter| parameter.actual.as_ref());
            std::iter::once(&call.target).chain(&call.instance).chain(actuals).collect()
        }
        StatementKind::Empty | StatementKind::Pragma(_) | StatementKind::Error => Vec::new(),
    }
}

impl Maker<'_> {
    fn instruction(&mut self, insn: StlInsn, operand: Option<&Operand>, is_last: bool) -> Result<(), String> {
        use StlInsn::*;
        let label = operand.map(self.label);
        if let (Some(bit), true) = (label.as_ref().filter(|label| is_branch(label)), self.kept.is_some()) {
            return self.branch_bit(insn, bit.text.replace(' ', ""));
        }
        match insn {
            And | AndNot => {
                let sign = if insn == And { "" } else { "/" };
                self.scan(sign, label)
            }
            Or if label.is_none() => {
                self.goes_on(true)?;
                self.close_branch()?;
                self.branch = Some(self.span.take().ok_or("has no logic before it")?);
                Ok(())
            }
            Or | OrNot => {
                let sign = if insn == Or { "" } else { "/" };
                self.goes_on(false)?;
                self.held = false;
                self.begin();
                self.close_branch()?;
                match self.span {
                    None => self.scan(sign, label),
                    Some(span) => {
                        self.free(span)?;
                        self.rungs.contact(sign, label.into_iter().collect(), span.start, span.end);
                        Ok(())
                    }
                }
            }
            AndNest | AndNotNest | OrNest | OrNotNest => {
                self.goes_on(matches!(insn, AndNest | AndNotNest))?;
                self.held = false;
                self.begin();
                if matches!(insn, OrNest | OrNotNest) {
                    self.close_branch()?;
                }
                self.outer.push(Outer { before: self.span.take(), branch: self.branch.take(), opened: insn });
                Ok(())
            }
            CloseNest => self.close(),
            Not => {
                self.held |= self.branch.is_some();
                self.close_branch()?;
                let span = self.span.filter(|_| !self.assigned).ok_or("has no logic before it")?;
                self.span = Some(self.rungs.then(span, "NOT", Vec::new()));
                Ok(())
            }
            EdgePositive | EdgeNegative => {
                (self.held, self.saved) = (false, false);
                self.close_branch()?;
                let span = self.span.filter(|_| !self.assigned).ok_or("has no logic before it")?;
                let sign = if insn == EdgePositive { "P" } else { "N" };
                self.span = Some(self.rungs.then(span, sign, label.into_iter().collect()));
                Ok(())
            }
            SetRlo => {
                self.span = Some(Span::at(self.rungs.net()));
                (self.branch, self.assigned) = (None, false);
                (self.held, self.saved) = (false, false);
                Ok(())
            }
            Assign => self.coil("", label, false),
            Set | Reset if label.as_ref().is_some_and(|label| label.key.starts_with('C')) && insn == Set => {
                self.coil("SC", label, true)
            }
            Set => self.coil("S", label, false),
            Reset => self.coil("R", label, false),
            Save => {
                // SET begins no string of logic.
                let is_open = !self.assigned && self.span.is_some_and(|span| span.start != span.end);
                self.coil("SAVE", None, false)?;
                self.saved = is_open;
                Ok(())
            }
            Load => {
                if self.loaded.len() == 2 {
                    return Err("loads a third value".to_string());
                }
                self.loaded.push(label.ok_or("has no operand")?.into_word());
                Ok(())
            }
            Transfer => {
                // A box MOVE at the rail.
                let (Some(value), true) = (self.loaded.pop(), self.loaded.is_empty()) else {
                    return Err("has no single value before it".to_string());
                };
                if self.span.is_some() && !self.assigned {
                    return Err("does not depend on the logic before it".to_string());
                }
                let net = self.rungs.net();
                self.rungs.rail(Span::at(net));
                let pins = vec![side("IN", value, false), side("OUT", label.ok_or("has no operand")?, true)];
                let look = Look::Box { title: "MOVE".to_string(), detail: String::new(), instance: None };
                self.rungs.part(look, Meaning::Other, pins, Some(net), None);
                Ok(())
            }
            Jump | JumpIf | JumpIfNot if !is_last => Err("is not the last statement".to_string()),
            Jump => {
                let net = self.rungs.net();
                self.rungs.rail(Span::at(net));
                self.rungs.coil("JMP", label.into_iter().collect(), net);
                Ok(())
            }
            JumpIf => self.coil("JMP", label, false),
            JumpIfNot => self.coil("JMPN", label, false),
            Nop | Display => Ok(()),
            other => match (timer(other), comparison(other)) {
                (Some((sign, timed)), _) => self.coil(sign, label, timed),
                (None, Some((sign, ty))) => self.compare(sign, ty),
                (None, None) => Err("has no element of LAD here".to_string()),
            },
        }
    }

    /// After an assignment a scan begins a new rung.
    fn begin(&mut self) {
        if self.assigned && self.outer.is_empty() {
            (self.span, self.branch, self.assigned) = (None, None, false);
            self.begun += 1;
        }
    }

    /// Before a scan: what the CPU does after SAVE, and after NOT of branches that `O` joins, is not what a ladder would show.
    fn goes_on(&self, is_and: bool) -> Result<(), String> {
        match () {
            () if self.saved => Err("goes on after `SAVE`".to_string()),
            () if self.held && is_and => Err("is an AND after `NOT` of branches that `O` joins".to_string()),
            () => Ok(()),
        }
    }

    fn scan(&mut self, sign: &str, label: Option<Label>) -> Result<(), String> {
        self.goes_on(true)?;
        self.begin();
        let labels: Vec<Label> = label.into_iter().collect();
        self.span = Some(match self.span {
            Some(span) => self.rungs.then(span, sign, labels),
            None => self.rungs.load(sign, labels),
        });
        Ok(())
    }

    /// A local bit: `= L 20.0` keeps the logic, and branches that begin with `A L 20.0` continue it.
    fn branch_bit(&mut self, insn: StlInsn, bit: String) -> Result<(), String> {
        if !self.outer.is_empty() || !self.loaded.is_empty() {
            return Err("is inside of other logic".to_string());
        }
        if insn == StlInsn::And {
            self.goes_on(true)?;
        }
        (self.held, self.saved) = (false, false);
        match insn {
            StlInsn::Assign => {
                self.close_branch()?;
                let span = self.span.ok_or("has no logic before it")?;
                let kept = Kept { span, is_used: false, begun: self.begun };
                let before = self.kept.get_or_insert_default().insert(bit, kept);
                if before.is_some_and(|before| !before.is_used) {
                    return Err("is written again before it is used".to_string());
                }
                self.assigned = true;
                Ok(())
            }
            StlInsn::And if self.span.is_none() && self.branch.is_none() || self.assigned => {
                let kept = self.kept.as_mut().and_then(|kept| kept.get_mut(&bit));
                let kept = kept.ok_or("is not a branch")?;
                if kept.begun != self.begun {
                    return Err("continues a rung after another one has begun".to_string());
                }
                kept.is_used = true;
                (self.span, self.branch, self.assigned) = (Some(Span { shared: true, ..kept.span }), None, false);
                Ok(())
            }
            _ => Err("is not a branch".to_string()),
        }
    }

    fn free(&self, span: Span) -> Result<(), String> {
        match span.shared || self.rungs.is_used(span.end) {
            true => Err("would be beside a branch that already leads elsewhere".to_string()),
            false => Ok(()),
        }
    }

    /// The branch before `O` and the one after it are parallel.
    fn close_branch(&mut self) -> Result<(), String> {
        let Some(branch) = self.branch.take() else { return Ok(()) };
        let span = self.span.take().ok_or("has an empty branch before it")?;
        self.rungs.join(branch.start, span.start);
        self.rungs.join(branch.end, span.end);
        self.span = Some(Span { whole: branch.whole || span.whole, ..branch });
        Ok(())
    }

    fn close(&mut self) -> Result<(), String> {
        self.close_branch()?;
        let inner = self.span.take().ok_or("closes an empty parenthesis")?;
        let Outer { before, branch, opened } = self.outer.pop().ok_or("closes no parenthesis")?;
        self.held = false;
        let inner = match opened {
            StlInsn::AndNotNest | StlInsn::OrNotNest => self.rungs.then(inner, "NOT", Vec::new()),
            _ => inner,
        };
        self.branch = branch;
        self.span = Some(match (before, opened) {
            (None, _) => inner,
            (Some(_), StlInsn::AndNest | StlInsn::AndNotNest) if inner.whole => {
                return Err("ends an edge or an inversion that is not of the logic before it".to_string());
            }
            (Some(before), StlInsn::AndNest | StlInsn::AndNotNest) => {
                self.rungs.join(before.end, inner.start);
                Span { end: inner.end, shared: false, ..before }
            }
            (Some(before), _) => {
                self.free(before)?;
                self.rungs.join(before.start, inner.start);
                self.rungs.join(before.end, inner.end);
                Span { whole: before.whole || inner.whole, ..before }
            }
        });
        Ok(())
    }

    /// A coil; `timed`: the loaded value stands below it.
    fn coil(&mut self, sign: &str, label: Option<Label>, timed: bool) -> Result<(), String> {
        if !self.outer.is_empty() {
            return Err("is inside of a parenthesis".to_string());
        }
        self.close_branch()?;
        (self.held, self.saved) = (false, false);
        let span = self.span.ok_or("has no logic before it")?;
        let mut labels: Vec<Label> = label.into_iter().collect();
        if timed {
            labels.push(self.loaded.pop().ok_or("has no value before it")?);
        }
        if !self.loaded.is_empty() {
            return Err("has values before it that it does not use".to_string());
        }
        self.rungs.rail(span);
        self.rungs.coil(sign, labels, span.end);
        self.assigned = true;
        Ok(())
    }

    fn compare(&mut self, sign: &str, ty: &str) -> Result<(), String> {
        let (Some(second), Some(first)) = (self.loaded.pop(), self.loaded.pop()) else {
            return Err("has no two values before it".to_string());
        };
        self.begin();
        if self.span.is_some() {
            return Err("replaces the logic before it".to_string());
        }
        let pin = |label, place| Pin {
            name: String::new(),
            place,
            output: false,
            link: Link::Operand(label),
            negated: false,
        };
        let (start, end) = (self.rungs.net(), self.rungs.net());
        let look = Look::Compare { sign: sign.to_string(), ty: ty.to_string() };
        let pins = vec![pin(first, Place::Above), pin(second, Place::Below)];
        let meaning = Meaning::Compare { sign: sign.to_string(), inverse: false };
        self.rungs.part(look, meaning, pins, Some(start), Some(end));
        self.span = Some(Span::between(start, end));
        Ok(())
    }

    /// A call without conditions.
    fn call(&mut self, call: &Call) -> Result<(), String> {
        if self.span.is_some() && !self.assigned || !self.loaded.is_empty() {
            return Err("does not depend on the logic before it".to_string());
        }
        let mut actuals = call.parameters.iter().filter_map(|parameter| parameter.actual.as_ref());
        if self.kept.is_some() && actuals.any(|actual| is_branch(&(self.label)(actual))) {
            return Err("has a local bit as a parameter".to_string());
        }
        let net = self.rungs.net();
        self.rungs.rail(Span::at(net));
        let title = (self.label)(&call.target).text;
        let pins = call.parameters.iter().map(|parameter| {
            let label = parameter.actual.as_ref().map(self.label).unwrap_or_default();
            side(&parameter.name, label, (self.is_output)(&title, &parameter.name))
        });
        let pins = pins.collect();
        let look = Look::Box { title, detail: String::new(), instance: call.instance.as_ref().map(self.label) };
        self.rungs.part(look, Meaning::Other, pins, Some(net), None);
        (self.span, self.assigned, self.saved) = (None, false, false);
        Ok(())
    }
}

/// Whether bits of local data are coils or contacts.
pub fn has_local_bits(sheet: &Sheet) -> bool {
    let mut pins = sheet.parts.iter().flat_map(|part| &part.pins);
    pins.any(|pin| matches!(&pin.link, Link::Operand(label) if is_branch(label)))
}

/// A bit of local data by its address, `L 20.0`.
fn is_branch(label: &Label) -> bool {
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let place = label.text.strip_prefix('L').and_then(|rest| rest.trim_start().split_once('.'));
    place.is_some_and(|(byte, bit)| digits(byte) && digits(bit))
}

/// Coils of timers and counters, and whether they take the loaded value.
fn timer(insn: StlInsn) -> Option<(&'static str, bool)> {
    Some(match insn.mnemonic(Mnemonics::En) {
        "SP" => ("SP", true),
        "SE" => ("SE", true),
        "SD" => ("SD", true),
        "SS" => ("SS", true),
        "SF" => ("SF", true),
        "CU" => ("CU", false),
        "CD" => ("CD", false),
        _ => return None,
    })
}

/// `>=I`: its sign and its type.
fn comparison(insn: StlInsn) -> Option<(&'static str, &'static str)> {
    let name = insn.mnemonic(Mnemonics::En);
    let at = name.len().checked_sub(1)?;
    let (sign, ty) = name.split_at_checked(at)?;
    let is_sign = matches!(sign, "==" | "<>" | "<" | "<=" | ">" | ">=");
    (is_sign && matches!(ty, "I" | "D" | "R")).then_some((sign, ty))
}
