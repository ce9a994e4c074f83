//! Conversions. Source: STL reference, conversion instructions.

use plcc_abi::codes::sync;
use plcc_ir::{BinaryOp, ConvertOp, IntCc, Type, UnaryOp, Value};

use crate::arithmetic::bcd::Bcd;
use crate::arithmetic::integer;
use crate::arithmetic::rounding::{self, Whole};
use crate::block::BlockLowering;
use crate::fault::{Check, Substitute};

impl BlockLowering<'_, '_> {
    /// `BTI`, `BTD`. A digit above 9 is a synchronous error; ACCU1 then stays.
    pub fn bcd_to_int(&mut self, double: bool) {
        let accu1 = self.accu1();
        let form = if double { Bcd::DWORD } else { Bcd::WORD };
        let (magnitude, ok) = form.magnitude(&mut self.b, accu1);
        let check = self.bcd_check(ok);
        let guard = self.begin_guard(vec![check], Substitute::None);
        let value = form.with_sign(&mut self.b, accu1, magnitude);
        if double {
            self.set_accu1(value);
        } else {
            let word = self.low_word(value);
            self.set_accu1_low(word);
        }
        self.end_guard(guard);
    }

    /// A BCD error unless `ok`; the fault register is 0: ACCU1.
    pub fn bcd_check(&mut self, ok: Value) -> Check {
        let code = self.b.i32_const(u32::from(sync::BCD));
        let zero = self.b.i32_const(0);
        Check { ok, code, access: zero, info: zero, db: None }
    }

    /// `ITB`, `DTB`. A value that does not fit leaves ACCU1 unchanged and sets OV.
    pub fn int_to_bcd(&mut self, double: bool) {
        let accu1 = self.accu1();
        let value = if double {
            accu1
        } else {
            let word = self.low_word(accu1);
            self.b.sext(Type::I32, word)
        };
        let form = if double { Bcd::DWORD } else { Bcd::WORD };
        let (result, too_large) = form.digits_and_sign(&mut self.b, value);
        let result = if double {
            result
        } else {
            let high = self.b.binary_imm(BinaryOp::And, accu1, 0xFFFF_0000);
            self.b.or(high, result)
        };
        let result = self.b.select(too_large, accu1, result);
        self.set_accu1(result);
        self.set_overflow(too_large);
    }

    pub fn int_to_dint(&mut self) {
        let accu1 = self.accu1();
        let word = self.low_word(accu1);
        let value = self.b.sext(Type::I32, word);
        self.set_accu1(value);
    }

    pub fn dint_to_real(&mut self) {
        let accu1 = self.accu1();
        let real = self.b.convert(ConvertOp::FromSint, Type::F32, accu1);
        let bits = self.b.bitcast(Type::I32, real);
        self.set_accu1(bits);
    }

    pub fn invert_int(&mut self) {
        let accu1 = self.accu1();
        let value = self.b.binary_imm(BinaryOp::Xor, accu1, 0xFFFF);
        self.set_accu1(value);
    }

    pub fn invert_dint(&mut self) {
        let accu1 = self.accu1();
        let value = self.b.not(accu1);
        self.set_accu1(value);
    }

    pub fn negate_int(&mut self) {
        let accu1 = self.accu1();
        let word = self.low_word(accu1);
        let result = self.negate(word);
        self.set_accu1_low(result);
    }

    pub fn negate_dint(&mut self) {
        let accu1 = self.accu1();
        let result = self.negate(accu1);
        self.set_accu1(result);
    }

    /// Two's complement with its status bits; the smallest number stays and sets OV.
    fn negate(&mut self, value: Value) -> Value {
        let result = integer::negated(&mut self.b, value);
        let least = integer::least(self.b.ty(value).bits());
        let overflow = self.b.icmp_imm(IntCc::Eq, value, least);
        let (cc1, cc0) = self.conditions_of(result);
        self.set_conditions(cc1, cc0);
        self.set_overflow(overflow);
        result
    }

    /// `RND RND+ RND- TRUNC`. NaN and values that a DINT cannot hold leave ACCU1 unchanged and set OV.
    pub fn real_to_dint(&mut self, rounding: UnaryOp) {
        let accu1 = self.accu1();
        let x = self.accu1_real();
        let Whole { value, fits } = rounding::to_integer(&mut self.b, x, rounding, 32, true);
        let result = self.b.select(fits, value, accu1);
        self.set_accu1(result);
        let overflow = self.b.not(fits);
        self.set_overflow(overflow);
    }
}
