//! Boxes, which the editors of STEP 7 write as several statements: EN as `JNB`, ENO as BR, flip-flops, timers and counters with all pins.
//!
//! Source: LAD/FBD reference F.1 and F.3.

mod cells;
mod operations;
mod overlap;

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{self, Operand, OperandKind, SectionKind, Statement, StatementKind, StatusOperand};
use plcc_syntax::literal::Literal;
use plcc_syntax::network::ast::{Eno, Pin, PinValue, Target, Template, TemplateKey};
use plcc_syntax::network::elements::PinDirection;
use plcc_syntax::scl::ast::{Expr, ExprKind, Literal as SclLiteral};
use plcc_syntax::stl::StlInsn;

use super::drawing::{Reason, Signal, pin};
use super::logic::Logic;
use super::operand::{expression, fits, typed};
use super::statements::{Reader, Refused};
use operations::{Operation, binary, converted, shift, shifted, type_name, unary};
use overlap::overlaps;

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
            if let Some(signal) = self.branches.as_mut().filter(|_| !is_output).and_then(|own| own.side(actual)) {
                pins.push(self.drawing.side_input(&parameter.name, &signal)?);
                continue;
            }
            let mut made = match operand_pin(&parameter.name, actual, None, is_output) {
                // A picture shows the operand as the statement has it: `P#M 0.0 BYTE 4`.
                Err(_) if self.is_picture => {
                    let span = Span { end: actual.span.start, ..actual.span };
                    let value = Expr { kind: ExprKind::Error, span };
                    pin(&parameter.name, PinValue::Operand(value), false, is_output, actual.span)
                }
                made => made?,
            };
            made.span = parameter.name_span;
            if let OperandKind::Literal(Literal::Real(number)) = actual.kind
                && self.types.formal(call, &parameter.name, self.block) == Some(Elementary::Lreal)
            {
                made.value = PinValue::Operand(long_real(number, actual.span)?);
            }
            pins.push(made);
        }
        // A function in STL looks at its operands themselves, a box at what they were before the call.
        let is_local = |path: &ast::Path| matches!(path.root, ast::PathRoot::Local { .. });
        let is_function = call.instance.is_none()
            && match &call.target.kind {
                OperandKind::Block(_) => true,
                OperandKind::Path(path) => !is_local(path),
                _ => false,
            };
        let is_shared = |one: &&Operand| written.iter().any(|other| overlaps(one, other));
        if is_function && !self.is_picture && read.iter().any(is_shared) {
            return Err("a call that reads and writes one operand".to_string());
        }
        let callee = expression(&call.target)?;
        let instance = call.instance.as_ref().map(expression).transpose()?;
        Ok(self.drawing.called(Target::Block { callee, instance }, pins))
    }
}

fn instruction(statement: &Statement) -> Option<(StlInsn, Option<&Operand>)> {
    match &statement.kind {
        StatementKind::Instruction { insn, operand, .. } => Some((*insn, operand.as_ref())),
        StatementKind::Call(_) | StatementKind::Empty | StatementKind::Pragma(_) | StatementKind::Error => None,
    }
}

fn is_nop(statement: &Statement) -> bool {
    is_display(statement) || matches!(instruction(statement), Some((StlInsn::Nop, _)))
}

/// `BLD 101`, which only editors read.
fn is_display(statement: &Statement) -> bool {
    matches!(instruction(statement), Some((StlInsn::Display, _)))
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

/// A number at a LREAL. The constant of a statement has the digits of a REAL; up to six of them are all that the author wrote.
fn long_real(number: f32, span: Span) -> Result<Expr, Reason> {
    let text = format!("{number:e}");
    let digits = text.split('e').next().unwrap_or_default().chars().filter(char::is_ascii_digit).count();
    match text.parse::<f64>() {
        Ok(value) if digits <= 6 => {
            let literal = SclLiteral::Typed { ty: Elementary::Lreal, bits: value.to_bits() };
            // Without text of its own: the notation of the source is another one.
            Ok(Expr { kind: ExprKind::Literal(literal), span: Span { end: span.start, ..span } })
        }
        _ => Err("a number with more than six digits at a LREAL".to_string()),
    }
}

/// A pin with an operand; `ty`: that of a constant.
fn operand_pin(name: &str, operand: &Operand, ty: Option<&str>, output: bool) -> Result<Pin, Reason> {
    let value = expression(operand)?;
    let value = ty.map_or(value.clone(), |ty| typed(value, ty));
    Ok(pin(name, PinValue::Operand(value), false, output, operand.span))
}
