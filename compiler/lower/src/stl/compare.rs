//! Comparisons. Source: STL reference, comparison instructions.

use plcc_ir::{FloatCc, IntCc, Type, Value};

use crate::arithmetic::compare;
use crate::block::BlockLowering;

impl BlockLowering<'_, '_> {
    /// ACCU2-L with ACCU1-L.
    pub fn compare_int(&mut self, cc: IntCc) {
        let (a, b) = (self.accu2(), self.accu1());
        let (a, b) = (self.low_word(a), self.low_word(b));
        self.compare_signed(cc, a, b);
    }

    /// ACCU2 with ACCU1.
    pub fn compare_dint(&mut self, cc: IntCc) {
        let (a, b) = (self.accu2(), self.accu1());
        self.compare_signed(cc, a, b);
    }

    fn compare_signed(&mut self, cc: IntCc, a: Value, b: Value) {
        let result = self.b.icmp(cc, a, b);
        let (cc1, cc0) = (self.b.icmp(IntCc::Sgt, a, b), self.b.icmp(IntCc::Slt, a, b));
        self.set_conditions(cc1, cc0);
        self.set_bit(self.regs.ov, false);
        self.set_comparison(result);
    }

    /// As REAL. With a NaN operand: CC 11, OV, OS, and the result is 0 for any comparison.
    pub fn compare_real(&mut self, cc: FloatCc) {
        let (a, b) = (self.accu2(), self.accu1());
        let (a, b) = (self.b.bitcast(Type::F32, a), self.b.bitcast(Type::F32, b));
        let unordered = self.b.fcmp(FloatCc::Uno, a, b);
        let result = compare::floats(&mut self.b, cc, a, b);
        let (above, below) = (self.b.fcmp(FloatCc::Gt, a, b), self.b.fcmp(FloatCc::Lt, a, b));
        let (cc1, cc0) = (self.b.or(above, unordered), self.b.or(below, unordered));
        self.set_conditions(cc1, cc0);
        self.set_overflow(unordered);
        self.set_comparison(result);
    }

    /// The result is the RLO, not combined with the one before.
    fn set_comparison(&mut self, result: Value) {
        self.count_contact(result);
        self.set(self.regs.rlo, result);
        self.set(self.regs.sta, result);
        self.set_bit(self.regs.or_, false);
        self.set_bit(self.regs.fc, true);
    }
}
