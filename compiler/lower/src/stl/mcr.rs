//! Master control relay. Source: STL reference, program control instructions.

use plcc_abi::codes::stop;
use plcc_ir::{BinaryOp, IntCc, Type};

use crate::block::BlockLowering;

/// Entries of the MCR stack.
const MCR_DEPTH: i64 = 8;

impl BlockLowering<'_, '_> {
    /// `MCRA`, `MCRD`.
    pub fn mcr_activate(&mut self, active: bool) {
        self.set_bit(self.regs.mcr_active, active);
    }

    /// `MCR(`: pushes the RLO.
    pub fn mcr_open(&mut self) {
        let depth = self.get(self.regs.mcr_depth);
        let ok = self.b.icmp_imm(IntCc::Ult, depth, MCR_DEPTH);
        self.stop_unless(ok, stop::MCR_STACK);
        let deeper = self.b.binary_imm(BinaryOp::Iadd, depth, 1);
        self.set(self.regs.mcr_depth, deeper);
        let (bits, rlo) = (self.get(self.regs.mcr_bits), self.rlo());
        let rlo = self.b.zext(Type::I32, rlo);
        let bits = self.b.binary_imm(BinaryOp::Shl, bits, 1);
        let bits = self.b.or(bits, rlo);
        self.set(self.regs.mcr_bits, bits);
        self.set_bit(self.regs.sta, true);
        self.end_logic_string();
    }

    /// `)MCR`: pops.
    pub fn mcr_close(&mut self) {
        let depth = self.get(self.regs.mcr_depth);
        let ok = self.b.icmp_imm(IntCc::Ne, depth, 0);
        self.stop_unless(ok, stop::MCR_STACK);
        let depth = self.b.binary_imm(BinaryOp::Isub, depth, 1);
        self.set(self.regs.mcr_depth, depth);
        let bits = self.get(self.regs.mcr_bits);
        // The bit that moves in is a 1: a missing entry switches nothing off.
        let bits = self.b.binary_imm(BinaryOp::Ashr, bits, 1);
        self.set(self.regs.mcr_bits, bits);
        self.set_bit(self.regs.sta, true);
        self.end_logic_string();
    }
}
