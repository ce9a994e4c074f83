//! Boxes, which the editors of STEP 7 write as several statements: EN as `JNB`, ENO as BR, flip-flops, timers and counters with all pins.
//!
//! Source: LAD/FBD reference F.1 and F.3.

use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    self, Area, BlockName, Bound, Operand, OperandKind, PathPart, PathRoot, SectionKind, Statement, StatementKind,
    StatusOperand,
};
use plcc_syntax::network::ast::{Eno, Pin, PinValue, Target, Template, TemplateKey};
use plcc_syntax::network::elements::PinDirection;
use plcc_syntax::stl::StlInsn;

use super::drawing::{Reason, Signal, pin};
use super::logic::Logic;
use super::operand::{expression, fits, typed};
use super::statements::{Reader, Refused};

/// An operation between loads and a transfer.
struct Operation {
    row: &'static str,
    /// Types of the inputs and of the result, by the names of their settings.
    source: Option<&'static str>,
    destination: Option<&'static str>,
    inputs: Vec<(&'static str, Elementary)>,
    result: Elementary,
    /// Whether OV says that the result is wrong.
    checked: bool,
}

/// What the statements of a box do between EN and ENO.
struct Body<'a> {
    /// None: MOVE.
    operation: Option<Operation>,
    inputs: Vec<&'a Operand>,
    outputs: Vec<&'a Operand>,
    /// Statements of which it is made.
    len: usize,
}

/// What sets BR at the end of a box.
#[derive(Clone, Copy, PartialEq)]
enum Tail {
    None,
    /// `AN OV; SAVE; CLR`.
    Overflow,
    /// `SET; SAVE; CLR`.
    Set,
}

impl Reader<'_> {
    /// Draws the box that begins here, if one does: the number of its statements.
    pub fn boxed(&mut self, rest: &[&Statement]) -> Result<Option<usize>, Refused> {
        let first = rest[0];
        let StatementKind::Instruction { insn, operand, .. } = &first.kind else { return Ok(None) };
        let refused = |reason: Reason| Refused { span: first.span, reason };
        match (insn, operand) {
            (StlInsn::JumpIfNotBr | StlInsn::JumpIfNot, Some(operand)) => {
                self.enabled(rest, *insn, operand).map_err(refused)
            }
            (StlInsn::Load, _) => self.always(rest).map_err(refused),
            (
                StlInsn::TimerPulse
                | StlInsn::TimerExtendedPulse
                | StlInsn::TimerOnDelay
                | StlInsn::TimerRetentiveOnDelay
                | StlInsn::TimerOffDelay
                | StlInsn::CountUp
                | StlInsn::CountDown,
                Some(operand),
            ) => self.cell_box(rest, *insn, operand),
            (StlInsn::Set | StlInsn::Reset, Some(operand)) => self.flip_flop(rest, *insn, operand),
            _ => Ok(None),
        }
    }

    /// `JNB _001; …; _001: A BR`, or `JCN` where nothing asks for ENO.
    fn enabled(&mut self, rest: &[&Statement], insn: StlInsn, operand: &Operand) -> Result<Option<usize>, Reason> {
        let OperandKind::Label(label) = &operand.kind else { return Ok(None) };
        let has_label = |statement: &&Statement| statement.label.as_ref().is_some_and(|own| own.name == *label);
        let Some(end) = rest.iter().position(has_label) else { return Ok(None) };
        let inner = &rest[1..end.max(1)];
        if self.jumps.get(label) != Some(&1) || inner.iter().any(|statement| statement.label.is_some()) {
            return Ok(None);
        }
        let is_used = is_br(rest[end]);
        let is_end = is_used || is_nop(rest[end]);
        let len = if is_end { end + 1 } else { end };
        if let [Statement { kind: StatementKind::Call(call), .. }] = inner {
            if insn != StlInsn::JumpIfNotBr {
                return Err("a call under `JCN`, which does not set BR as EN of a box does".to_string());
            }
            let flow = self.flow()?;
            let element = self.call_box(call, &flow)?;
            self.enabled_end(element, is_used, label);
            return Ok(Some(len));
        }
        let Some(body) = self.body(inner) else { return Ok(None) };
        let tail = match (&inner[body.len..], tail(&inner[body.len..])) {
            ([], _) => Tail::None,
            ([_, _, _], tail @ (Tail::Overflow | Tail::Set)) => tail,
            _ => return Ok(None),
        };
        let checked = body.operation.as_ref().is_some_and(|operation| operation.checked);
        let eno = match (insn, tail, checked) {
            (StlInsn::JumpIfNotBr, Tail::Overflow, true) | (StlInsn::JumpIfNotBr, Tail::Set, false) => Eno::Generated,
            // JNB has set BR, which a box without errors leaves.
            (StlInsn::JumpIfNotBr, Tail::None, false) => Eno::Generated,
            // The editors leave the tail out where nothing asks for ENO.
            (StlInsn::JumpIfNotBr, Tail::None, true) if !is_used => {
                self.note(rest[0].span);
                Eno::Generated
            }
            (_, Tail::None, _) if !is_used => Eno::Disabled,
            _ => return Err("a box whose ENO is not that of the editors".to_string()),
        };
        let flow = self.flow()?;
        let element = self.operation(&body, &flow, eno)?;
        self.enabled_end(element, is_used, label);
        Ok(Some(len))
    }

    /// After a box: its ENO is the RLO, or nothing.
    fn enabled_end(&mut self, element: usize, is_used: bool, label: &str) {
        self.closed.insert(label.to_string());
        self.result((element, "eno"), is_used);
    }

    /// The RLO is an output of an element, or nothing uses the element.
    fn result(&mut self, (element, name): (usize, &str), is_used: bool) {
        self.logic = match is_used {
            true => {
                let net = self.drawing.output(element, name, None);
                Logic { alternatives: Vec::new(), current: Some(Signal::Net(net)) }
            }
            false => Logic::default(),
        };
        self.fresh = !is_used;
        self.chain = None;
    }

    /// A box without conditions: `L a; L b; +I; T c`.
    fn always(&mut self, rest: &[&Statement]) -> Result<Option<usize>, Reason> {
        let is_free = self.loads.is_empty() && (self.fresh || !self.logic.is_open());
        let Some(body) = self.body(rest).filter(|_| is_free && self.nesting.is_empty()) else { return Ok(None) };
        if rest[1..body.len].iter().any(|statement| statement.label.is_some()) {
            return Ok(None);
        }
        let after = &rest[body.len..];
        let tail =
            if after.iter().take(3).any(|statement| statement.label.is_some()) { Tail::None } else { tail(after) };
        let checked = body.operation.as_ref().is_some_and(|operation| operation.checked);
        let eno = match (tail, checked) {
            (Tail::None, _) => Eno::Disabled,
            (Tail::Overflow, true) | (Tail::Set, false) => Eno::Generated,
            // A coil SAVE after a box: the statements say it in their own words.
            _ => return Ok(None),
        };
        if tail == Tail::None && body.operation.is_none() && body.outputs.len() == 1 {
            return Ok(None);
        }
        let element = self.operation(&body, &Signal::Constant(true), eno)?;
        let mut len = body.len;
        let mut is_used = false;
        if tail != Tail::None {
            len += 3;
            is_used = rest.get(len).is_some_and(|next| next.label.is_none() && is_br(next));
            len += usize::from(is_used);
        }
        self.result((element, "eno"), is_used);
        Ok(Some(len))
    }

    /// The statements of a box, if these begin with one.
    fn body<'b>(&self, rest: &[&'b Statement]) -> Option<Body<'b>> {
        let load = |at: usize| match instruction(rest.get(at)?)? {
            (StlInsn::Load, Some(operand)) => Some(operand),
            _ => None,
        };
        let transfer = |at: usize| match instruction(rest.get(at)?)? {
            (StlInsn::Transfer, Some(operand)) => Some(operand),
            _ => None,
        };
        let first = load(0)?;
        if let Some(second) = load(1) {
            let (insn, operand) = instruction(rest.get(2)?)?;
            let output = transfer(3)?;
            if operand.is_some() {
                return None;
            }
            return match binary(insn) {
                Some((row, ty, checked)) => {
                    let source = Some(type_name(ty));
                    let inputs = vec![("in1", ty), ("in2", ty)];
                    let operation = Operation { row, source, destination: None, inputs, result: ty, checked };
                    Some(Body {
                        operation: Some(operation),
                        inputs: vec![first, second],
                        outputs: vec![output],
                        len: 4,
                    })
                }
                // The number of places is loaded first.
                None => {
                    let (row, ty) = shift(insn)?;
                    let operation = shifted(row, ty);
                    Some(Body {
                        operation: Some(operation),
                        inputs: vec![second, first],
                        outputs: vec![output],
                        len: 4,
                    })
                }
            };
        }
        if transfer(1).is_some() {
            let outputs: Vec<&Operand> = (1..).map_while(transfer).collect();
            return Some(Body { operation: None, inputs: vec![first], len: 1 + outputs.len(), outputs });
        }
        let (insn, operand) = instruction(rest.get(1)?)?;
        if let (Some((row, ty)), Some(count)) = (shift(insn), operand) {
            let output = transfer(2)?;
            return Some(Body {
                operation: Some(shifted(row, ty)),
                inputs: vec![first, count],
                outputs: vec![output],
                len: 3,
            });
        }
        let is_long = insn == StlInsn::IToD && matches!(instruction(rest.get(2)?), Some((StlInsn::DToR, None)));
        let operation =
            if is_long { converted("Int", Elementary::Int, "Real", Elementary::Real) } else { unary(insn)? };
        let len = if is_long { 4 } else { 3 };
        let output = transfer(len - 1)?;
        operand.is_none().then(|| Body { operation: Some(operation), inputs: vec![first], outputs: vec![output], len })
    }

    /// Draws an operation or a MOVE.
    fn operation(&mut self, body: &Body, flow: &Signal, eno: Eno) -> Result<usize, Reason> {
        let mut pins: Vec<Pin> = self.drawing.input("en", flow)?.into_iter().collect();
        let Some(operation) = &body.operation else {
            let value = body.inputs[0];
            for output in &body.outputs {
                self.can_move(&self.kind_of(value), output)?;
            }
            pins.push(operand_pin("in", value, None, false)?);
            for (at, output) in body.outputs.iter().enumerate() {
                pins.push(operand_pin(&format!("out{}", at + 1), output, None, true)?);
            }
            let element = self.drawing.element("Move", pins, None);
            self.drawing.graph.elements[element].eno = eno;
            return Ok(element);
        };
        for ((name, ty), operand) in operation.inputs.iter().zip(&body.inputs) {
            if *name == "n" {
                // The statement looks at the low byte, the box at the whole word.
                let is_constant =
                    matches!(operand.kind, OperandKind::Literal(plcc_syntax::literal::Literal::Int(0..=32)));
                if !is_constant && !self.is_picture {
                    return Err("a shift by a variable".to_string());
                }
            } else {
                self.typed_as(operand, *ty)?;
            }
            pins.push(operand_pin(name, operand, Some(type_name(*ty)), false)?);
        }
        self.typed_as(body.outputs[0], operation.result)?;
        pins.push(operand_pin("out", body.outputs[0], None, true)?);
        let element = self.drawing.element(operation.row, pins, operation.source);
        let made = &mut self.drawing.graph.elements[element];
        if let Some(value) = operation.destination {
            made.templates.push(Template { key: TemplateKey::Destination, value: value.to_string(), span: made.span });
        }
        made.eno = eno;
        Ok(element)
    }

    /// An operand of a box has the type of its pin.
    fn typed_as(&self, operand: &Operand, ty: Elementary) -> Result<(), Reason> {
        match self.is_picture || fits(operand, self.kind_of(operand), ty) {
            true => Ok(()),
            false => Err(format!("a box of {} with an operand of another type", ty.name())),
        }
    }

    // Calls.

    /// A call with its parameters, whose directions are those of the block.
    pub fn call_box(&mut self, call: &ast::Call, flow: &Signal) -> Result<usize, Reason> {
        let mut pins: Vec<Pin> = Vec::new();
        if let Some(row) = self.types.row_of(call, self.block) {
            let instance = call.instance.as_ref().unwrap_or(&call.target);
            if !matches!(flow, Signal::Constant(true)) {
                pins.extend(self.drawing.input("en", flow)?);
            }
            for parameter in &call.parameters {
                let Some(actual) = &parameter.actual else { continue };
                let Some((known, name)) = row.pin(&parameter.name) else {
                    return Err(format!("the parameter `{}` of `{}`", parameter.name, row.name));
                };
                let is_output = known.direction == PinDirection::Output;
                if name == row.flow.0 {
                    let signal = Signal::Operand(expression(actual)?);
                    pins.extend(self.drawing.input(&name, &signal)?);
                } else {
                    pins.push(operand_pin(&name, actual, None, is_output)?);
                }
            }
            let instance = expression(instance)?;
            return Ok(self.drawing.called(Target::Element { row, instance: Some(instance) }, pins));
        }
        let (mut read, mut written): (Vec<&Operand>, Vec<&Operand>) = (Vec::new(), Vec::new());
        pins.extend(self.drawing.input("en", flow)?);
        for parameter in &call.parameters {
            let Some(actual) = &parameter.actual else { continue };
            let section = self.types.section(call, &parameter.name, self.block);
            let is_output = match section {
                Some(section) => section == SectionKind::Output,
                None if self.is_picture => false,
                None => return Err("a call of a block whose parameters are not in the sources".to_string()),
            };
            match section {
                Some(SectionKind::Input) => read.push(actual),
                Some(_) => written.push(actual),
                None => {}
            }
            let mut made = operand_pin(&parameter.name, actual, None, is_output)?;
            made.span = parameter.name_span;
            pins.push(made);
        }
        // A function in STL looks at its operands themselves, a box at what they were before the call.
        let is_function = call.instance.is_none() && matches!(call.target.kind, OperandKind::Block(_));
        let is_shared = |one: &&Operand| written.iter().any(|other| overlaps(one, other));
        if is_function && !self.is_picture && read.iter().any(is_shared) {
            return Err("a call that reads and writes one operand".to_string());
        }
        let callee = expression(&call.target)?;
        let instance = call.instance.as_ref().map(expression).transpose()?;
        Ok(self.drawing.called(Target::Block { callee, instance }, pins))
    }

    // Timers, counters and flip-flops.

    /// `SD T 1; A r; R T 1; L T 1; T bi; LC T 1; T bcd; A T 1`, each part present or `NOP 0`.
    fn cell_box(&mut self, rest: &[&Statement], insn: StlInsn, cell: &Operand) -> Result<Option<usize>, Refused> {
        let is_timer = !matches!(insn, StlInsn::CountUp | StlInsn::CountDown);
        let mut slots: Vec<Slot> = match insn {
            StlInsn::CountUp => vec![Slot::Logic(StlInsn::CountDown, "cd"), Slot::Logic(StlInsn::Set, "s")],
            StlInsn::CountDown => vec![Slot::Logic(StlInsn::Set, "s")],
            _ => Vec::new(),
        };
        slots.push(Slot::Logic(StlInsn::Reset, "r"));
        let (binary, bcd) = if is_timer { ("bi", "bcd") } else { ("cv", "cv_bcd") };
        slots.extend([Slot::Value(StlInsn::Load, binary), Slot::Value(StlInsn::LoadBcd, bcd), Slot::Result]);

        // Which slots there are, before anything is drawn.
        let mut found: Vec<(Slot, std::ops::Range<usize>)> = Vec::new();
        let (mut at, mut is_box) = (1, false);
        for slot in slots {
            if rest.get(at).is_some_and(|next| next.label.is_none() && is_nop(next)) {
                (at, is_box) = (at + 1, true);
                continue;
            }
            let Some(len) = slot.len(&rest[at..], cell) else { continue };
            is_box |= matches!(slot, Slot::Value(..));
            found.push((slot, at..at + len));
            at += len;
        }
        let names: Vec<&str> = found.iter().filter_map(|(slot, _)| slot.name()).collect();
        if !is_box {
            return Ok(None);
        }
        let here = |reason: Reason| Refused { span: rest[0].span, reason };
        let (row, flow_name, cell_name) = match insn {
            StlInsn::TimerPulse => ("S_PULSE", "s", "timer"),
            StlInsn::TimerExtendedPulse => ("S_PEXT", "s", "timer"),
            StlInsn::TimerOnDelay => ("S_ODT", "s", "timer"),
            StlInsn::TimerRetentiveOnDelay => ("S_ODTS", "s", "timer"),
            StlInsn::TimerOffDelay => ("S_OFFDT", "s", "timer"),
            StlInsn::CountUp if names.contains(&"cd") => ("S_Cud", "cu", "counter"),
            StlInsn::CountUp => ("S_Cu", "cu", "counter"),
            _ => ("S_Cd", "cd", "counter"),
        };
        let flow = self.flow().map_err(here)?;
        let mut pins: Vec<Pin> = self.connected(&flow).map_err(here)?.into_iter().collect();
        pins.iter_mut().for_each(|pin| pin.name = flow_name.to_string());
        pins.push(operand_pin(cell_name, cell, None, false).map_err(here)?);
        if is_timer {
            let value = self.cell_value().map_err(here)?;
            pins.push(pin("tv", PinValue::Operand(value), false, false, rest[0].span));
        } else if !self.loads.is_empty() {
            return Err(here("a counter with a value that it does not use".to_string()));
        }
        let mut is_used = false;
        for (slot, range) in found {
            let (last, part) = (rest[range.end - 1], &rest[range]);
            let here = |reason: Reason| Refused { span: last.span, reason };
            match slot {
                Slot::Logic(_, name) => {
                    (self.logic, self.fresh) = (Logic::default(), true);
                    self.sequence(&part[..part.len() - 1], false)?;
                    if name == "s" {
                        let value = self.cell_value().map_err(here)?;
                        pins.push(pin("pv", PinValue::Operand(value), false, false, last.span));
                    }
                    let flow = self.flow().map_err(here)?;
                    pins.push(self.drawing.side_input(name, &flow).map_err(here)?);
                }
                Slot::Value(_, name) => {
                    let Some((_, Some(target))) = instruction(last) else { continue };
                    self.typed_as(target, Elementary::Word).map_err(here)?;
                    pins.push(operand_pin(name, target, None, true).map_err(here)?);
                }
                Slot::Result => is_used = true,
            }
        }
        // What feeds the other pins runs before the box.
        self.drawing.at(rest[0].span);
        let element = self.drawing.element(row, pins, None);
        self.result((element, "q"), is_used);
        Ok(Some(at))
    }

    /// The value that is loaded for a timer or a counter.
    fn cell_value(&mut self) -> Result<plcc_syntax::scl::ast::Expr, Reason> {
        match &self.loads[..] {
            [(value, ..)] => {
                let value = value.clone();
                self.loads.clear();
                Ok(value)
            }
            _ => Err("a timer or counter without exactly its value before it".to_string()),
        }
    }

    /// `S op; A r; R op; A op`, or the other way round.
    fn flip_flop(&mut self, rest: &[&Statement], insn: StlInsn, operand: &Operand) -> Result<Option<usize>, Refused> {
        if matches!(operand.kind, OperandKind::Cell { .. }) {
            return Ok(None);
        }
        let other = if insn == StlInsn::Set { StlInsn::Reset } else { StlInsn::Set };
        let Some(len) = Slot::Logic(other, "").len(&rest[1..], operand) else { return Ok(None) };
        let end = 1 + len;
        // Coils have no statement after them.
        let Some(after) = rest.get(end).filter(|after| after.label.is_none()) else { return Ok(None) };
        let is_used = Slot::Result.len(&rest[end..], operand).is_some();
        if !is_used && !is_nop(after) {
            return Ok(None);
        }
        let here = |reason: Reason| Refused { span: rest[0].span, reason };
        let (row, first, second) = if insn == StlInsn::Set { ("S_SR", "s", "r1") } else { ("S_RS", "r", "s1") };
        let flow = self.flow().map_err(here)?;
        let mut pins: Vec<Pin> = self.connected(&flow).map_err(here)?.into_iter().collect();
        pins.iter_mut().for_each(|pin| pin.name = first.to_string());
        pins.push(operand_pin("operand", operand, None, true).map_err(here)?);
        (self.logic, self.fresh) = (Logic::default(), true);
        self.sequence(&rest[1..end - 1], false)?;
        let flow = self.flow().map_err(here)?;
        pins.push(self.drawing.side_input(second, &flow).map_err(here)?);
        self.drawing.at(rest[0].span);
        let element = self.drawing.element(row, pins, None);
        self.result((element, "q"), is_used);
        Ok(Some(end + 1))
    }
}

/// A part of a box with several pins.
#[derive(Clone, Copy)]
enum Slot {
    /// Logic, and the instruction that it leads to.
    Logic(StlInsn, &'static str),
    /// `L T 1; T bi`.
    Value(StlInsn, &'static str),
    /// `A T 1`.
    Result,
}

impl Slot {
    fn name(self) -> Option<&'static str> {
        match self {
            Slot::Logic(_, name) | Slot::Value(_, name) => Some(name),
            Slot::Result => None,
        }
    }

    /// The number of statements that are this part of the box of `cell`.
    fn len(self, rest: &[&Statement], cell: &Operand) -> Option<usize> {
        let is_cell = |operand: &Option<Operand>| operand.as_ref().is_some_and(|own| is_same(own, cell));
        match self {
            Slot::Logic(wanted, _) => {
                let mut depth = 0usize;
                for (at, statement) in rest.iter().enumerate() {
                    let StatementKind::Instruction { insn, operand, .. } = &statement.kind else { return None };
                    if statement.label.is_some() {
                        return None;
                    }
                    if *insn == wanted && is_cell(operand) && depth == 0 {
                        return (at > 0).then_some(at + 1);
                    }
                    match insn {
                        StlInsn::AndNest
                        | StlInsn::AndNotNest
                        | StlInsn::OrNest
                        | StlInsn::OrNotNest
                        | StlInsn::XorNest
                        | StlInsn::XorNotNest => depth += 1,
                        StlInsn::CloseNest => depth = depth.checked_sub(1)?,
                        StlInsn::And
                        | StlInsn::AndNot
                        | StlInsn::Or
                        | StlInsn::OrNot
                        | StlInsn::Xor
                        | StlInsn::XorNot
                        | StlInsn::Not
                        | StlInsn::Load => {}
                        _ => return None,
                    }
                    // All pins of a box count as they are before the box writes.
                    if operand.as_ref().is_some_and(|operand| may_be_same(operand, cell)) {
                        return None;
                    }
                }
                None
            }
            Slot::Value(wanted, _) => {
                let (StlInsn::Transfer, Some(_)) = instruction(rest.get(1)?)? else { return None };
                let (insn, Some(operand)) = instruction(rest[0])? else { return None };
                let is_plain = rest[..2].iter().all(|statement| statement.label.is_none());
                (is_plain && insn == wanted && is_same(operand, cell)).then_some(2)
            }
            Slot::Result => {
                let (StlInsn::And, Some(operand)) = instruction(rest.first()?)? else { return None };
                (rest[0].label.is_none() && is_same(operand, cell)).then_some(1)
            }
        }
    }
}

/// Whether two operands are written as the same one.
fn is_same(one: &Operand, other: &Operand) -> bool {
    match (&one.kind, &other.kind) {
        (OperandKind::Path(one), OperandKind::Path(other)) => {
            let parts = one.parts.iter().zip(&other.parts);
            same_root(&one.root, &other.root)
                && std::mem::discriminant(&one.root) == std::mem::discriminant(&other.root)
                && one.parts.len() == other.parts.len()
                && parts.into_iter().all(|pair| match pair {
                    (PathPart::Member { name, .. }, PathPart::Member { name: other, .. }) => {
                        name.eq_ignore_ascii_case(other)
                    }
                    (PathPart::Index { values, .. }, PathPart::Index { values: others, .. }) => {
                        values.len() == others.len()
                            && values.iter().zip(others).all(|pair| match pair {
                                (Bound::Number(one, _), Bound::Number(other, _)) => one == other,
                                _ => false,
                            })
                    }
                    _ => false,
                })
        }
        (
            OperandKind::Block(BlockName::Symbol { name, .. }),
            OperandKind::Block(BlockName::Symbol { name: other, .. }),
        ) => name.eq_ignore_ascii_case(other),
        (one, other) => one == other,
    }
}

/// Whether reading one operand may read what another one names; addresses and names are not compared with each other.
fn may_be_same(read: &Operand, written: &Operand) -> bool {
    use OperandKind as K;
    match (&read.kind, &written.kind) {
        (K::Literal(_) | K::Status(_), _) => false,
        (K::Cell { .. }, K::Cell { .. }) => is_same(read, written),
        (K::Absolute { area, width, byte, .. }, K::Absolute { area: other, byte: at, .. }) => {
            // A bit is only itself; a byte, word or double word has all its bits.
            let bytes = width.bits().div_ceil(8);
            match width.bits() {
                1 => read.kind == written.kind,
                _ => area == other && (*byte..byte.saturating_add(bytes)).contains(at),
            }
        }
        (K::Cell { .. }, K::Absolute { .. }) | (K::Absolute { .. }, K::Cell { .. }) => false,
        (K::Path(one), K::Path(other)) => match (&one.root, &other.root) {
            (PathRoot::Local { .. }, PathRoot::Local { .. }) | (PathRoot::Quoted { .. }, PathRoot::Quoted { .. }) => {
                // One path may be a part of the other: `#a` and `#a.b`.
                let count = one.parts.len().min(other.parts.len());
                same_root(&one.root, &other.root) && same_parts(&one.parts[..count], &other.parts[..count])
            }
            _ => true,
        },
        _ => true,
    }
}

/// Whether two operands of a call may have bits in common. A local variable is none of the others.
fn overlaps(one: &Operand, other: &Operand) -> bool {
    use OperandKind as K;
    let is_local = |operand: &Operand| {
        matches!(&operand.kind, K::Path(path) if matches!(path.root, PathRoot::Local { .. }))
            || matches!(operand.kind, K::Absolute { area: Area::L, .. })
    };
    match (&one.kind, &other.kind) {
        (K::Literal(_), _) | (_, K::Literal(_)) => false,
        _ if is_local(one) != is_local(other) => false,
        (K::Absolute { area, width, byte, bit }, K::Absolute { area: other, width: wide, byte: at, bit: place }) => {
            let ends = |byte: u32, bits: u32| byte.saturating_add(bits.div_ceil(8));
            let is_apart = width.bits() == 1 && wide.bits() == 1 && bit != place;
            area == other && *byte < ends(*at, wide.bits()) && *at < ends(*byte, width.bits()) && !is_apart
        }
        _ => may_be_same(one, other) || may_be_same(other, one),
    }
}

fn same_root(one: &PathRoot, other: &PathRoot) -> bool {
    match (one, other) {
        (PathRoot::Local { name, .. }, PathRoot::Local { name: other, .. })
        | (PathRoot::Quoted { name, .. }, PathRoot::Quoted { name: other, .. }) => name.eq_ignore_ascii_case(other),
        _ => true,
    }
}

/// Indices may be equal whatever they are written as.
fn same_parts(one: &[PathPart], other: &[PathPart]) -> bool {
    one.iter().zip(other).all(|pair| match pair {
        (PathPart::Member { name, .. }, PathPart::Member { name: other, .. }) => name.eq_ignore_ascii_case(other),
        _ => true,
    })
}

fn instruction(statement: &Statement) -> Option<(StlInsn, Option<&Operand>)> {
    match &statement.kind {
        StatementKind::Instruction { insn, operand, .. } => Some((*insn, operand.as_ref())),
        StatementKind::Call(_) | StatementKind::Empty | StatementKind::Pragma(_) | StatementKind::Error => None,
    }
}

fn is_nop(statement: &Statement) -> bool {
    matches!(instruction(statement), Some((StlInsn::Nop | StlInsn::Display, _)))
}

/// `A BR`.
fn is_br(statement: &Statement) -> bool {
    let Some((StlInsn::And, Some(operand))) = instruction(statement) else { return false };
    operand.kind == OperandKind::Status(StatusOperand::Br)
}

fn tail(rest: &[&Statement]) -> Tail {
    let [first, second, third, ..] = rest else { return Tail::None };
    let ends = matches!(instruction(second), Some((StlInsn::Save, _)))
        && matches!(instruction(third), Some((StlInsn::ClearRlo, _)));
    match instruction(first) {
        Some((StlInsn::AndNot, Some(operand))) if ends && operand.kind == OperandKind::Status(StatusOperand::Ov) => {
            Tail::Overflow
        }
        Some((StlInsn::SetRlo, _)) if ends => Tail::Set,
        _ => Tail::None,
    }
}

/// A pin with an operand; `ty`: that of a constant.
fn operand_pin(name: &str, operand: &Operand, ty: Option<&str>, output: bool) -> Result<Pin, Reason> {
    let value = expression(operand)?;
    let value = ty.map_or(value.clone(), |ty| typed(value, ty));
    Ok(pin(name, PinValue::Operand(value), false, output, operand.span))
}

fn binary(insn: StlInsn) -> Option<(&'static str, Elementary, bool)> {
    use Elementary::{Dint, Dword, Int, Real, Word};
    use StlInsn as I;
    Some(match insn {
        I::AddI => ("Add", Int, true),
        I::SubI => ("Sub", Int, true),
        I::MulI => ("Mul", Int, true),
        I::DivI => ("Div", Int, true),
        I::AddD => ("Add", Dint, true),
        I::SubD => ("Sub", Dint, true),
        I::MulD => ("Mul", Dint, true),
        I::DivD => ("Div", Dint, true),
        I::ModD => ("Mod", Dint, true),
        I::AddR => ("Add", Real, true),
        I::SubR => ("Sub", Real, true),
        I::MulR => ("Mul", Real, true),
        I::DivR => ("Div", Real, true),
        I::AndW => ("And", Word, false),
        I::OrW => ("Or", Word, false),
        I::XorW => ("Xor", Word, false),
        I::AndD => ("And", Dword, false),
        I::OrD => ("Or", Dword, false),
        I::XorD => ("Xor", Dword, false),
        _ => return None,
    })
}

fn shift(insn: StlInsn) -> Option<(&'static str, Elementary)> {
    use Elementary::{Dint, Dword, Int, Word};
    use StlInsn as I;
    Some(match insn {
        I::ShiftLeftW => ("Shl", Word),
        I::ShiftLeftD => ("Shl", Dword),
        I::ShiftRightW => ("Shr", Word),
        I::ShiftRightD => ("Shr", Dword),
        I::ShiftSignedI => ("Shr", Int),
        I::ShiftSignedD => ("Shr", Dint),
        I::RotateLeftD => ("Rol", Dword),
        I::RotateRightD => ("Ror", Dword),
        _ => return None,
    })
}

fn shifted(row: &'static str, ty: Elementary) -> Operation {
    let inputs = vec![("in", ty), ("n", Elementary::Word)];
    Operation { row, source: Some(type_name(ty)), destination: None, inputs, result: ty, checked: false }
}

fn converted(from: &'static str, source: Elementary, to: &'static str, result: Elementary) -> Operation {
    let checked = to.starts_with("BCD");
    let inputs = vec![("in", source)];
    Operation { row: "Convert", source: Some(from), destination: Some(to), inputs, result, checked }
}

fn unary(insn: StlInsn) -> Option<Operation> {
    use Elementary::{Dint, Dword, Int, Real, Word};
    use StlInsn as I;
    let of = |row, ty, checked| Operation {
        row,
        source: Some(type_name(ty)),
        destination: None,
        inputs: vec![("in", ty)],
        result: ty,
        checked,
    };
    let round = |row| Operation {
        row,
        source: Some("Real"),
        destination: Some("DInt"),
        inputs: vec![("in", Real)],
        result: Dint,
        checked: true,
    };
    Some(match insn {
        I::NegI => of("Neg", Int, true),
        I::NegD => of("Neg", Dint, true),
        I::NegR => of("Neg", Real, false),
        I::InvertI => of("Inv", Word, false),
        I::InvertD => of("Inv", Dword, false),
        I::AbsR => of("Abs", Real, false),
        I::SqrR => of("Sqr", Real, true),
        I::SqrtR => of("Sqrt", Real, true),
        I::LnR => of("Ln", Real, true),
        I::ExpR => of("Exp", Real, true),
        I::SinR => of("Sin", Real, true),
        I::CosR => of("Cos", Real, true),
        I::TanR => of("Tan", Real, true),
        I::AsinR => of("Asin", Real, true),
        I::AcosR => of("Acos", Real, true),
        I::AtanR => of("Atan", Real, true),
        I::IToD => converted("Int", Int, "DInt", Dint),
        I::DToR => converted("DInt", Dint, "Real", Real),
        I::IToBcd => converted("Int", Int, "BCD16", Word),
        I::BcdToI => converted("BCD16", Word, "Int", Int),
        I::DToBcd => converted("DInt", Dint, "BCD32", Dword),
        I::BcdToD => converted("BCD32", Dword, "DInt", Dint),
        I::Round => round("Round"),
        I::Truncate => round("Trunc"),
        I::RoundUp => round("Ceil"),
        I::RoundDown => round("Floor"),
        _ => return None,
    })
}

/// As settings of elements write it.
fn type_name(ty: Elementary) -> &'static str {
    match ty {
        Elementary::Int => "Int",
        Elementary::Dint => "DInt",
        Elementary::Real => "Real",
        Elementary::Word => "Word",
        Elementary::Dword => "DWord",
        other => other.name(),
    }
}
