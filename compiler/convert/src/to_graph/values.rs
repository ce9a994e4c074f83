//! Values in the accumulators: they are loaded, compared and transferred.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{Operand, OperandKind};
use plcc_syntax::network::ast::{Pin, PinValue};
use plcc_syntax::stl::StlInsn;

use super::drawing::{Reason, Signal, pin};
use super::logic::Logic;
use super::operand::{Kind, compares, expression, keeps_bits, typed};
use super::statements::{Reader, not_here};

impl Reader<'_> {
    pub fn load(&mut self, operand: Option<&Operand>, span: Span) -> Result<(), Reason> {
        if self.loads.len() == 2 {
            return Err("a third value in the accumulators".to_string());
        }
        let operand = operand.ok_or_else(|| not_here(StlInsn::Load))?;
        self.loads.push((expression(operand)?, span, self.kind_of(operand)));
        Ok(())
    }

    /// The element `element` compares the two loaded values as `ty`.
    pub fn compare(&mut self, element: &'static str, ty: &'static str, span: Span) -> Result<(), Reason> {
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

    /// `L a; T b`.
    pub fn transfer(&mut self, operand: &Operand) -> Result<(), Reason> {
        self.unused()?;
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
}
