//! Bit logic: scans, nesting, assignments, edges. Source: STL reference, bit logic instructions.

use plcc_ir::{IntCc, Value};
use plcc_model::{Operand, Place, StatusOperand, Width};
use plcc_syntax::stl::StlInsn;

use crate::block::BlockLowering;
use crate::place::Direction;

/// How a scan combines with the RLO.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Combine {
    And,
    Or,
    Xor,
}

impl BlockLowering<'_, '_> {
    /// `A AN O ON X XN` with an operand.
    pub fn combine(&mut self, how: Combine, negated: bool, operand: &Operand) {
        let scanned = self.scan(operand);
        self.count_contact(scanned);
        let value = if negated { self.b.not(scanned) } else { scanned };
        let (rlo, fc, or_) = (self.rlo(), self.get(self.regs.fc), self.get(self.regs.or_));
        self.combine_value(how, value, rlo, fc, or_);
        self.set(self.regs.sta, scanned);
        self.set_bit(self.regs.fc, true);
    }

    /// Combines `value` with the logic string so far, in `rlo`, `fc`, `or_`; sets RLO and OR.
    fn combine_value(&mut self, how: Combine, value: Value, rlo: Value, fc: Value, or_: Value) {
        match how {
            Combine::And => {
                // RLO := (/FC ? RLO and value : value) or OR-if-/FC.
                let or_ = self.b.and(or_, fc);
                let first = self.b.not(fc);
                let so_far = self.b.or(rlo, first);
                let both = self.b.and(so_far, value);
                let result = self.b.or(both, or_);
                self.set(self.regs.rlo, result);
                self.set(self.regs.or_, or_);
            }
            Combine::Or | Combine::Xor => {
                let so_far = self.b.and(fc, rlo);
                let result = match how {
                    Combine::Xor => self.b.xor(so_far, value),
                    Combine::And | Combine::Or => self.b.or(so_far, value),
                };
                self.set(self.regs.rlo, result);
                self.set_bit(self.regs.or_, false);
            }
        }
    }

    /// `O` without operand: the AND groups before and after it are ORed.
    pub fn or_of_ands(&mut self) {
        let (rlo, fc, or_) = (self.rlo(), self.get(self.regs.fc), self.get(self.regs.or_));
        let any = self.b.or(rlo, or_);
        let or_ = self.b.and(any, fc);
        let first = self.b.and(rlo, fc);
        self.set(self.regs.or_, or_);
        self.set(self.regs.fc, first);
        self.set_bit(self.regs.sta, true);
    }

    /// Value of a bit operand, an i1.
    fn scan(&mut self, operand: &Operand) -> Value {
        match operand {
            Operand::Memory { place, .. } => self.read(place, Width::Bit),
            Operand::Cell { kind, number } => self.cell_scan(*kind, number),
            Operand::Status(status) => self.status(*status),
            Operand::Const { value, .. } => self.b.bool_const(*value != 0),
            Operand::None
            | Operand::Block { .. }
            | Operand::Db { .. }
            | Operand::Special(_)
            | Operand::Register(_)
            | Operand::Label(_)
            | Operand::ParameterPointer { .. } => unreachable!("the binder only passes bit operands"),
        }
    }

    /// Value of a status operand, an i1.
    pub fn status(&mut self, status: StatusOperand) -> Value {
        let (cc1, cc0) = (self.get(self.regs.cc1), self.get(self.regs.cc0));
        match status {
            StatusOperand::Br => self.get(self.regs.br),
            StatusOperand::Ov => self.get(self.regs.ov),
            StatusOperand::Os => self.get(self.regs.os),
            StatusOperand::Uo => self.b.and(cc1, cc0),
            StatusOperand::Eq0 => {
                let any = self.b.or(cc1, cc0);
                self.b.not(any)
            }
            StatusOperand::Ne0 => self.b.xor(cc1, cc0),
            StatusOperand::Gt0 => {
                let not_below = self.b.not(cc0);
                self.b.and(cc1, not_below)
            }
            StatusOperand::Lt0 => {
                let not_above = self.b.not(cc1);
                self.b.and(cc0, not_above)
            }
            StatusOperand::Ge0 => self.b.not(cc0),
            StatusOperand::Le0 => self.b.not(cc1),
        }
    }

    /// `A(` and other instructions with a parenthesis.
    pub fn open_nesting(&mut self, insn: StlInsn) {
        let nesting = self.new_nesting(insn);
        let pairs = [
            (nesting.rlo, self.regs.rlo),
            (nesting.or_, self.regs.or_),
            (nesting.fc, self.regs.fc),
            (nesting.br, self.regs.br),
        ];
        for (saved, register) in pairs {
            let value = self.get(register);
            self.set(saved, value);
        }
        self.nesting.push(nesting);
        debug_assert!(self.nesting.len() <= crate::block::NESTING_MAX, "checked when bound");
        self.set_bit(self.regs.sta, true);
        self.end_logic_string();
    }

    pub fn close_nesting(&mut self) {
        let Some(nesting) = self.pop_nesting() else { return };
        let (how, negated) = match nesting.insn {
            StlInsn::AndNest => (Combine::And, false),
            StlInsn::AndNotNest => (Combine::And, true),
            StlInsn::OrNest => (Combine::Or, false),
            StlInsn::OrNotNest => (Combine::Or, true),
            StlInsn::XorNest => (Combine::Xor, false),
            _ => (Combine::Xor, true),
        };
        let inner = self.rlo();
        let value = if negated { self.b.not(inner) } else { inner };
        let (rlo, fc) = (self.get(nesting.rlo), self.get(nesting.fc));
        let (or_, br) = (self.get(nesting.or_), self.get(nesting.br));
        self.combine_value(how, value, rlo, fc, or_);
        self.set(self.regs.br, br);
        self.set_bit(self.regs.sta, true);
        self.set_bit(self.regs.fc, true);
    }

    /// Parentheses in unreachable code: only their number counts.
    pub fn skip_nesting(&mut self, insn: StlInsn) {
        match insn {
            insn if insn.opens_nesting() => {
                let nesting = self.new_nesting(insn);
                self.nesting.push(nesting);
            }
            StlInsn::CloseNest => {
                self.pop_nesting();
            }
            _ => {}
        }
    }

    /// The place of an operand that is written.
    fn written(operand: &Operand) -> &Place {
        match operand {
            Operand::Memory { place, .. } => place,
            _ => unreachable!("the binder only passes bits in memory"),
        }
    }

    /// `=`.
    pub fn assign(&mut self, operand: &Operand) {
        let rlo = self.rlo();
        let on = self.mcr_on();
        let value = self.b.and(rlo, on);
        self.write(Self::written(operand), Width::Bit, value);
        self.set(self.regs.sta, value);
        self.end_logic_string();
    }

    /// `S`, `R` of a bit.
    pub fn set_or_reset(&mut self, operand: &Operand, set: bool) {
        let rlo = self.rlo();
        let on = self.mcr_on();
        let acts = self.b.and(rlo, on);
        // The address is computed, and may fault, with any RLO; the bit keeps its value if RLO is 0.
        let place = Self::written(operand);
        let target = self.target(place, Width::Bit, Direction::Write);
        let guard = self.begin_guard(target.checks, crate::fault::Substitute::None);
        let inner = crate::place::Target { kind: target.kind, checks: Vec::new() };
        let old = self.peek(&inner);
        let value = if set {
            self.b.or(old, acts)
        } else {
            let keep = self.b.not(acts);
            self.b.and(old, keep)
        };
        self.write_target(inner, Width::Bit, value);
        self.set(self.regs.sta, value);
        if let Some(after) = guard {
            self.end_guard(Some(after));
        }
        self.end_logic_string();
    }

    /// Current value of a bit after its checks.
    pub fn peek(&mut self, target: &crate::place::Target) -> Value {
        match target.kind {
            crate::place::TargetKind::Memory { addr, bit } => {
                let copy = crate::place::Target::at(addr, bit);
                self.read_target(copy, Width::Bit)
            }
            // An output: its process image has the last written value.
            crate::place::TargetKind::Peripheral { address, bit } => {
                let byte = self.b.constant_bits(address).expect("bits of outputs have addresses that are known");
                self.b.load_bit(plcc_ir::Address::direct(plcc_ir::Region::Q, byte as u32), bit)
            }
            crate::place::TargetKind::Either { .. } => unreachable!("the peripheral area has no bits"),
        }
    }

    pub fn not(&mut self) {
        let rlo = self.rlo();
        let value = self.b.not(rlo);
        self.set(self.regs.rlo, value);
        self.set_bit(self.regs.sta, true);
    }

    /// `SET`, `CLR`.
    pub fn set_rlo(&mut self, value: bool) {
        self.set_bit(self.regs.rlo, value);
        self.set_bit(self.regs.sta, value);
        self.end_logic_string();
    }

    pub fn save(&mut self) {
        let rlo = self.rlo();
        self.set(self.regs.br, rlo);
    }

    /// `FP`, `FN`.
    pub fn edge(&mut self, operand: &Operand, positive: bool) {
        let rlo = self.rlo();
        let target = self.target(Self::written(operand), Width::Bit, Direction::Write);
        let zero = self.b.bool_const(false);
        self.set(self.result_bit, zero);
        let guard = self.begin_guard(target.checks, crate::fault::Substitute::Bit);
        let inner = crate::place::Target { kind: target.kind, checks: Vec::new() };
        let before = self.peek(&inner);
        self.write_target(inner, Width::Bit, rlo);
        let result = if positive {
            let was_low = self.b.not(before);
            self.b.and(rlo, was_low)
        } else {
            let is_low = self.b.not(rlo);
            self.b.and(is_low, before)
        };
        let result = match guard {
            None => result,
            Some(after) => {
                self.set(self.result_bit, result);
                self.end_guard(Some(after));
                self.get(self.result_bit)
            }
        };
        self.set(self.regs.rlo, result);
        self.set(self.regs.sta, rlo);
        self.set_bit(self.regs.or_, false);
        self.set_bit(self.regs.fc, true);
    }

    /// CC1 and CC0 as after arithmetic: above 0, below 0.
    pub fn set_conditions(&mut self, cc1: Value, cc0: Value) {
        self.set(self.regs.cc1, cc1);
        self.set(self.regs.cc0, cc0);
    }

    /// CC1 and CC0 by the sign of an integer.
    pub fn conditions_of(&mut self, value: Value) -> (Value, Value) {
        (self.b.icmp_imm(IntCc::Sgt, value, 0), self.b.icmp_imm(IntCc::Slt, value, 0))
    }

    /// OV := `ov`, which OS stores.
    pub fn set_overflow(&mut self, ov: Value) {
        let os = self.get(self.regs.os);
        let os = self.b.or(os, ov);
        self.set(self.regs.ov, ov);
        self.set(self.regs.os, os);
    }
}
