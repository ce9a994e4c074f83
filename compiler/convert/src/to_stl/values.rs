//! Values of boxes: their types, how they are loaded and stored.

use plcc_diag::Span;
use plcc_syntax::ast::{Operand, OperandKind, Width};
use plcc_syntax::literal::Literal;
use plcc_syntax::network::ast::{Element, Graph, PinValue, TemplateKey};
use plcc_syntax::stl::StlInsn;
use plcc_syntax::{Class, Elementary};

use super::Maker;
use super::plan::Plan;
use super::types::elementary;

impl Maker<'_> {
    pub fn unknown_type(&mut self, element: &Element) {
        self.refuse(
            element.span,
            "a box whose type is not in the sources",
            "add the symbol table or the data block with the operands",
        );
    }

    /// The type of a box: its setting, or that of its operands.
    pub fn box_type(&mut self, element: &Element, pins: &[&str]) -> Option<Elementary> {
        let set = element.template(TemplateKey::Source).or_else(|| element.template(TemplateKey::Value));
        if let Some(template) = set.filter(|template| !template.value.trim().is_empty()) {
            if let Some(ty) = elementary(&template.value) {
                return Some(ty);
            }
            self.refuse(element.span, format!("the type `{}`", template.value), "use a type of the S7-300");
            return None;
        }
        let mut found: Option<Elementary> = None;
        for name in pins {
            let Some(ty) = element.pin(name).and_then(|pin| self.type_of(&pin.value)) else { continue };
            found = match found {
                None => Some(ty),
                // The result is converted to the type of the output.
                Some(known) if known == ty || *name == "out" => Some(known),
                Some(known) if known.class() == Class::Signed && ty.class() == Class::Signed => {
                    Some(if known.bits() >= ty.bits() { known } else { ty })
                }
                Some(known) => {
                    let what = format!("a box of {} and {}", known.name(), ty.name());
                    self.refuse(element.span, what, "convert one of the operands");
                    return None;
                }
            };
        }
        if found.is_none() {
            self.unknown_type(element);
        }
        found
    }

    /// The type of what is connected to a pin, if it is known.
    pub fn type_of(&self, value: &PinValue) -> Option<Elementary> {
        match value {
            PinValue::Operand(value) => self.types.of(&super::operand::operand_of(value)?.kind, self.block),
            PinValue::Net(net) => self.typed.get(net).map(|(_, ty)| *ty),
            PinValue::Open => None,
        }
    }

    /// The type of an operand at a pin of type `ty`: an absolute address of its width has that type.
    fn type_at(&self, kind: &OperandKind, ty: Elementary) -> Option<Elementary> {
        let of_width = |own: Elementary| if own.bits() == ty.bits() { ty } else { own };
        self.types.of(kind, self.block).or_else(|| width_type(kind).map(of_width))
    }

    /// Loads an input.
    pub fn load_pin(&mut self, graph: &Graph, at: usize, name: &str, ty: Elementary) {
        for (insn, operand) in self.load(graph, at, name, ty).unwrap_or_default() {
            self.push(insn, operand);
        }
    }

    /// Loads what a counter is set to: a constant is `C#12`.
    pub fn load_count(&mut self, graph: &Graph, at: usize) {
        for (insn, mut operand) in self.load(graph, at, "pv", Elementary::Word).unwrap_or_default() {
            if let Some(Operand { kind: OperandKind::Literal(value), .. }) = &mut operand
                && let Literal::Word(bits) = *value
                && bits <= 0x999
                && (0..3).all(|digit| bits >> (4 * digit) & 0xF < 10)
            {
                *value = Literal::Counter(bits);
            }
            self.push(insn, operand);
        }
    }

    /// Statements that load an input as a value of type `ty`.
    pub fn load(
        &mut self,
        graph: &Graph,
        at: usize,
        name: &str,
        ty: Elementary,
    ) -> Option<Vec<(StlInsn, Option<Operand>)>> {
        let (operand, from) = self.source(graph, at, name, ty)?;
        let is_extended = from == Elementary::Sint && ty.bits() > 8;
        let conversion = self.conversion(if is_extended { Elementary::Int } else { from }, ty, operand.span)?;
        let mut load = vec![(StlInsn::Load, Some(loadable(operand)))];
        if is_extended {
            // L fills a byte with zeros.
            let eight = super::number(8, self.span);
            load.extend([StlInsn::ShiftLeftW, StlInsn::ShiftSignedI].map(|insn| (insn, Some(eight.clone()))));
        }
        load.extend(conversion.iter().map(|insn| (*insn, None)));
        Some(load)
    }

    /// What an input of type `ty` gets, and the type that this has; a constant in the form of `ty`.
    pub fn source(&mut self, graph: &Graph, at: usize, name: &str, ty: Elementary) -> Option<(Operand, Elementary)> {
        let element = &graph.elements[at];
        let pin = element.pin(name);
        let (operand, from) = match pin.map(|pin| &pin.value) {
            Some(PinValue::Operand(value)) => {
                let told = self.messages.len();
                let Some(operand) = self.value_of(value, ty) else {
                    // An operand that STL does not have has its message.
                    if self.messages.len() == told {
                        let what = format!("this constant as {}", ty.name());
                        self.refuse(value.span, what, "write it in the range of the type");
                    }
                    return None;
                };
                let from = self.type_at(&operand.kind, ty);
                (operand, from)
            }
            Some(PinValue::Net(net)) => match self.typed.get(net) {
                Some((operand, ty)) => (operand.clone(), Some(*ty)),
                None => {
                    self.refuse(element.span, format!("a wire with a value at `{name}`"), "put a variable between");
                    return None;
                }
            },
            Some(PinValue::Open) | None => {
                self.refuse(element.span, format!("a box whose input `{name}` is open"), "connect an operand");
                return None;
            }
        };
        let is_number = match &operand.kind {
            OperandKind::Literal(Literal::Int(_) | Literal::Bits { .. }) => true,
            OperandKind::Literal(Literal::Text(text)) => ty == Elementary::Char && text.len() == 1,
            _ => false,
        };
        let from = match from {
            Some(from) => from,
            None if is_number => ty,
            // Its own type; no other value has it here.
            None if ty == Elementary::S5Time => ty,
            None => {
                self.unknown_type(element);
                return None;
            }
        };
        Some((operand, from))
    }

    /// Stores ACCU1, of type `ty`, to what is connected to an output.
    pub fn store_pin(&mut self, graph: &Graph, plan: &Plan, at: usize, name: &str, ty: Elementary) {
        let element = &graph.elements[at];
        for pin in element.pins.iter().filter(|pin| pin.output && pin.name.eq_ignore_ascii_case(name)) {
            match &pin.value {
                PinValue::Operand(value) => {
                    let Some(operand) = self.operand(value) else { return };
                    let Some(to) = self.type_at(&operand.kind, ty) else { return self.unknown_type(element) };
                    let Some(conversion) = self.conversion(ty, to, value.span) else { return };
                    conversion.iter().for_each(|insn| self.push(*insn, None));
                    self.push(StlInsn::Transfer, Some(operand));
                }
                PinValue::Net(net) if plan.is_used(*net) => {
                    let operand = self.temporary(ty);
                    self.push(StlInsn::Transfer, Some(operand.clone()));
                    self.typed.insert(*net, (operand, ty));
                }
                PinValue::Net(_) | PinValue::Open => {}
            }
        }
    }

    /// Instructions that turn a value of one type into one of another.
    pub fn conversion(&mut self, from: Elementary, to: Elementary, span: Span) -> Option<&'static [StlInsn]> {
        use Elementary::{Byte, Char, Dint, Int, Real};
        let same_bits = from.bits() == to.bits() && (from == Real) == (to == Real);
        Some(match (from, to) {
            _ if from == to => &[],
            (Int, Dint) => &[StlInsn::IToD],
            (Int, Real) => &[StlInsn::IToD, StlInsn::DToR],
            (Dint | Elementary::Usint | Elementary::Uint, Real) => &[StlInsn::DToR],
            _ if same_bits && from.bits() > 1 => &[],
            // L fills with zeros.
            (Byte | Char, _) if to.bits() > 8 && to != Real => &[],
            (Elementary::Word | Elementary::Uint, Elementary::Dword | Dint | Elementary::Udint) => &[],
            (Elementary::Usint, _) if to.bits() > 8 && to != Real => &[],
            _ => {
                let what = format!("a conversion of {} to {} by a box", from.name(), to.name());
                self.refuse(span, what, "put a CONVERT before it");
                return None;
            }
        })
    }
}

/// The operand of `L`: an unsigned number that is too large for an INT is a word or double word there.
pub fn loadable(operand: Operand) -> Operand {
    let OperandKind::Literal(Literal::Int(number)) = operand.kind else { return operand };
    let bits = u32::try_from(number).ok().filter(|number| i16::try_from(*number).is_err());
    let Some(bits) = bits else { return operand };
    let literal = u16::try_from(bits).map_or(Literal::Dword(bits), Literal::Word);
    Operand { kind: OperandKind::Literal(literal), ..operand }
}

pub fn width_of(value: &PinValue) -> Option<Elementary> {
    match value {
        PinValue::Operand(value) => width_type(&super::operand::operand_of(value)?.kind),
        PinValue::Net(_) | PinValue::Open => None,
    }
}

/// The type that an absolute address has by its width.
pub fn width_type(kind: &OperandKind) -> Option<Elementary> {
    let (OperandKind::Absolute { width, .. } | OperandKind::DbAbsolute { width, .. }) = kind else { return None };
    Some(of_width(*width))
}

/// The type of an operand without a type of its own.
pub fn of_width(width: Width) -> Elementary {
    match width {
        Width::Bit => Elementary::Bool,
        Width::Byte => Elementary::Byte,
        Width::Word => Elementary::Word,
        Width::Dword => Elementary::Dword,
        Width::Lword => Elementary::Lword,
    }
}
