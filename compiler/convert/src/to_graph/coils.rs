//! What the flow of a network leads to: coils, jumps, and calls without parameters.

use plcc_diag::Span;
use plcc_syntax::ast::{self, BlockName, BlockPrefix, Operand, OperandKind};
use plcc_syntax::network::ast::{Pin, PinValue};
use plcc_syntax::scl::ast::{Expr, ExprKind, Name, NameForm};
use plcc_syntax::stl::StlInsn;

use super::drawing::{Reason, Signal, pin};
use super::logic::Logic;
use super::operand::expression;
use super::statements::{Reader, not_here};

impl Reader<'_> {
    /// `=`, `S` or `R`.
    pub fn coil(&mut self, name: &str, operand: Option<&Operand>) -> Result<(), Reason> {
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

    /// A timer or counter, with the value that is loaded.
    pub fn cell_coil(&mut self, name: &str, cell: &str, value: &str, operand: Option<&Operand>) -> Result<(), Reason> {
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

    pub fn save_coil(&mut self) -> Result<(), Reason> {
        let flow = self.flow()?;
        let pins = self.drawing.input("in", &flow)?.into_iter().collect();
        let element = self.drawing.element("SaveCoil", pins, None);
        self.chain(element, flow);
        Ok(())
    }

    pub fn jump(&mut self, insn: StlInsn, operand: Option<&Operand>, span: Span) -> Result<(), Reason> {
        let Some(OperandKind::Label(label)) = operand.map(|operand| &operand.kind) else { return Err(not_here(insn)) };
        let flow = match insn {
            StlInsn::Jump => {
                self.unused()?;
                Signal::Constant(true)
            }
            _ => self.flow()?,
        };
        let target = Expr { kind: ExprKind::Name(Name { text: label.clone(), form: NameForm::Bare, span }), span };
        let mut pins: Vec<Pin> = self.drawing.input("in", &flow)?.into_iter().collect();
        pins.push(pin("label", PinValue::Operand(target), false, false, span));
        self.drawing.element(if insn == StlInsn::JumpIfNot { "I_JumpCoil" } else { "JumpCoil" }, pins, None);
        Ok(())
    }

    pub fn open_db(&mut self, operand: Option<&Operand>, span: Span) -> Result<(), Reason> {
        self.unused()?;
        let operand = operand.ok_or_else(|| not_here(StlInsn::OpenDb))?;
        let di = matches!(&operand.kind, OperandKind::Block(BlockName::Numbered { prefix: BlockPrefix::Di, .. }));
        let block = pin("operand", PinValue::Operand(expression(operand)?), false, false, span);
        let mut pins: Vec<Pin> = self.drawing.input("in", &Signal::Constant(true))?.into_iter().collect();
        pins.push(block);
        self.drawing.element(if di { "OpenDICoil" } else { "OpenDBCoil" }, pins, None);
        Ok(())
    }

    pub fn mcr_coil(&mut self, insn: StlInsn) -> Result<(), Reason> {
        let (name, flow) = match insn {
            StlInsn::McrActivate => ("McrActivateCoil", Signal::Constant(true)),
            StlInsn::McrDeactivate => ("McrDeactivateCoil", Signal::Constant(true)),
            StlInsn::McrClose => ("McrCloseCoil", Signal::Constant(true)),
            _ => ("McrOpenCoil", self.flow()?),
        };
        if insn != StlInsn::McrOpen {
            self.unused()?;
        }
        let pins = self.drawing.input("in", &flow)?.into_iter().collect();
        self.drawing.element(name, pins, None);
        Ok(())
    }

    /// `UC` or `CC`.
    pub fn call_coil(&mut self, insn: StlInsn, operand: Option<&Operand>, span: Span) -> Result<(), Reason> {
        let flow = if insn == StlInsn::CallConditional { self.flow()? } else { Signal::Constant(true) };
        if insn == StlInsn::CallUnconditional {
            self.unused()?;
        }
        let block = expression(operand.ok_or_else(|| not_here(insn))?)?;
        let mut pins: Vec<Pin> = self.drawing.input("in", &flow)?.into_iter().collect();
        pins.push(pin("operand", PinValue::Operand(block), false, false, span));
        self.drawing.element("CallCoil", pins, None);
        Ok(())
    }

    /// `CALL`.
    pub fn call(&mut self, call: &ast::Call) -> Result<(), Reason> {
        self.unused()?;
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
