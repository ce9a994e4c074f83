//! Timers, counters and flip-flops with all pins.

use plcc_syntax::Elementary;
use plcc_syntax::ast::{Area, CodeKind, Operand, OperandKind, PathRoot, Statement, StatementKind};
use plcc_syntax::network::ast::{Pin, PinValue};
use plcc_syntax::stl::StlInsn;

use super::overlap::{is_same, may_be_same};
use super::{Logic, Reader, Reason, Refused, instruction, is_display, is_nop, operand_pin, pin};
use crate::to_graph::operand::Kind;

impl Reader<'_> {
    /// `SD T 1; A r; R T 1; L T 1; T bi; LC T 1; T bcd; A T 1`, each part present or `NOP 0`.
    pub(super) fn cell_box(
        &mut self,
        rest: &[&Statement],
        insn: StlInsn,
        cell: &Operand,
    ) -> Result<Option<usize>, Refused> {
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
            // STEP 7 ends the parts of a counter with `BLD 101`.
            at += rest[at..].iter().take_while(|next| next.label.is_none() && is_display(next)).count();
            if rest.get(at).is_some_and(|next| next.label.is_none() && is_nop(next)) {
                (at, is_box) = (at + 1, true);
                continue;
            }
            let Some(len) = slot.len(&rest[at..], cell, &|read| self.is_apart(read, cell)) else { continue };
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

    /// Whether a BOOL that is read cannot be what is written: it is not a timer or counter, and what an FB has of its own is not in I, Q, M.
    fn is_apart(&self, read: &Operand, written: &Operand) -> bool {
        // A part of a structure in IN_OUT may be anywhere.
        let is_local = |operand: &Operand| match &operand.kind {
            OperandKind::Path(path) => matches!(path.root, PathRoot::Local { .. }) && path.parts.is_empty(),
            _ => false,
        };
        let is_image =
            |operand: &Operand| matches!(operand.kind, OperandKind::Absolute { area: Area::I | Area::Q | Area::M, .. });
        let is_bool = |operand: &Operand| self.kind_of(operand) == Kind::Type(Elementary::Bool);
        let is_own = |operand: &Operand| self.block.kind == CodeKind::Fb && is_local(operand) && is_bool(operand);
        matches!(written.kind, OperandKind::Cell { .. }) && is_bool(read)
            || is_own(read) && is_image(written)
            || is_image(read) && is_own(written)
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
    pub(super) fn flip_flop(
        &mut self,
        rest: &[&Statement],
        insn: StlInsn,
        operand: &Operand,
    ) -> Result<Option<usize>, Refused> {
        if matches!(operand.kind, OperandKind::Cell { .. }) {
            return Ok(None);
        }
        let other = if insn == StlInsn::Set { StlInsn::Reset } else { StlInsn::Set };
        let is_apart = |read: &Operand| self.is_apart(read, operand);
        let Some(len) = Slot::Logic(other, "").len(&rest[1..], operand, &is_apart) else { return Ok(None) };
        let end = 1 + len;
        // Coils have no statement after them.
        let Some(after) = rest.get(end).filter(|after| after.label.is_none()) else { return Ok(None) };
        let is_used = Slot::Result.len(&rest[end..], operand, &is_apart).is_some();
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

    /// The number of statements that are this part of the box of `cell`. `is_apart`: an operand cannot be the cell.
    fn len(self, rest: &[&Statement], cell: &Operand, is_apart: &dyn Fn(&Operand) -> bool) -> Option<usize> {
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
                        _ if insn.opens_nesting() => depth += 1,
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
                    if operand.as_ref().is_some_and(|operand| may_be_same(operand, cell) && !is_apart(operand)) {
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
