//! Operators, comparisons and conversions of types.

use cranelift_codegen::ir::condcodes::{FloatCC, IntCC};
use cranelift_codegen::ir::{InstBuilder, MemFlagsData, Value as ClifValue, types};
use cranelift_frontend::FunctionBuilder;
use plcc_abi::Type;
use plcc_ir::entities::Entity;
use plcc_ir::function::ValueDef;
use plcc_ir::{BinaryOp, ConvertOp, FloatCc, InstData, IntCc, UnaryOp, Value};

use super::{Lowering, Slot, invalid};
use crate::CodegenError;
use crate::abi::clif_type;
use crate::bits::Bit;
use crate::floats;
use crate::rounding::{self, Rounding};

impl Lowering<'_, '_> {
    pub(super) fn binary(&mut self, op: BinaryOp, args: [Value; 2], result: Value) -> Result<(), CodegenError> {
        if self.function.ty(result) == Type::I1 {
            let bit = self.bit_binary(op, args)?;
            self.define_bit(result, bit);
            return Ok(());
        }
        if op == BinaryOp::Shl
            && let Some((bit, to)) = self.shifted_bit(args)
        {
            let ty = clif_type(self.function.ty(result));
            let value = self.bit(bit)?.placed(&mut self.b, ty, to);
            self.define(result, value);
            return Ok(());
        }
        if matches!(op, BinaryOp::And | BinaryOp::Or | BinaryOp::Xor)
            && let Some([x, y]) = self.swapped_operands(args, result)
        {
            let value = bitwise(&mut self.b, op, [x, y]);
            self.slots[result.index()] = Slot::Swapped(value);
            return Ok(());
        }
        if let Some(value) = self.divided(op, args[0], args[1])? {
            self.define(result, value);
            return Ok(());
        }
        let [x, y] = [self.value(args[0])?, self.value(args[1])?];
        let ins = self.b.ins();
        let value = match op {
            BinaryOp::Iadd => ins.iadd(x, y),
            BinaryOp::Isub => ins.isub(x, y),
            BinaryOp::Imul => ins.imul(x, y),
            BinaryOp::Sdiv => ins.sdiv(x, y),
            BinaryOp::Srem => ins.srem(x, y),
            BinaryOp::Udiv => ins.udiv(x, y),
            BinaryOp::Urem => ins.urem(x, y),
            BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => bitwise(&mut self.b, op, [x, y]),
            BinaryOp::Shl => ins.ishl(x, y),
            BinaryOp::Lshr => ins.ushr(x, y),
            BinaryOp::Ashr => ins.sshr(x, y),
            BinaryOp::Rotl => ins.rotl(x, y),
            BinaryOp::Rotr => ins.rotr(x, y),
            BinaryOp::Fadd => ins.fadd(x, y),
            BinaryOp::Fsub => ins.fsub(x, y),
            BinaryOp::Fmul => ins.fmul(x, y),
            BinaryOp::Fdiv => ins.fdiv(x, y),
        };
        self.define(result, value);
        Ok(())
    }

    fn bit_binary(&mut self, op: BinaryOp, args: [Value; 2]) -> Result<Bit, CodegenError> {
        if op == BinaryOp::Xor
            && let Some(position) = args.iter().position(|&arg| self.function.constant(arg) == Some(1))
        {
            let other = self.bit(args[1 - position])?;
            return Ok(other.not(&mut self.b));
        }
        let bits = [self.bit(args[0])?, self.bit(args[1])?];
        let both_clean = bits.iter().all(|bit| matches!(bit, Bit::Clean(_)));
        let [x, y] = Bit::both_low(&mut self.b, bits);
        let value = match op {
            BinaryOp::And => self.b.ins().band(x, y),
            BinaryOp::Or => self.b.ins().bor(x, y),
            BinaryOp::Xor => self.b.ins().bxor(x, y),
            BinaryOp::Iadd
            | BinaryOp::Isub
            | BinaryOp::Imul
            | BinaryOp::Sdiv
            | BinaryOp::Srem
            | BinaryOp::Udiv
            | BinaryOp::Urem
            | BinaryOp::Shl
            | BinaryOp::Lshr
            | BinaryOp::Ashr
            | BinaryOp::Rotl
            | BinaryOp::Rotr
            | BinaryOp::Fadd
            | BinaryOp::Fsub
            | BinaryOp::Fmul
            | BinaryOp::Fdiv => return Err(invalid(format!("{} of bits", op.name()))),
        };
        Ok(if both_clean { Bit::Clean(value) } else { Bit::Low(value) })
    }

    /// Whether a selection brings a float that is not a number into the form in which all bits are 1.
    pub(super) fn is_all_ones_if_invalid(&self, cond: Value, if_true: Value, if_false: Value) -> bool {
        let function = self.function;
        let ty = function.ty(if_false);
        let Some(InstData::FloatCompare { cc: FloatCc::Uno, args }) = function.defining(cond) else { return false };
        matches!(ty, Type::F32 | Type::F64)
            && function.constant(if_true) == Some(u64::MAX >> (64 - ty.bits()))
            && args.map(|arg| function.resolve(arg)) == [function.resolve(if_false); 2]
    }

    /// The condition and the float, if `value` is a float in whose place all bits are 1 when it is not a number.
    fn all_ones_if_invalid(&self, value: Value) -> Option<(Value, Value)> {
        let &InstData::Select { cond, if_true, if_false } = self.function.defining(value)? else { return None };
        self.is_all_ones_if_invalid(cond, if_true, if_false).then_some((cond, if_false))
    }

    /// The value that `value` is after a shift down by a constant number of bits, and that number.
    fn shifted_down(&self, value: Value) -> Option<(Value, u8)> {
        let function = self.function;
        let value = function.resolve(value);
        let ValueDef::Result(inst, _) = function.values[value].def else { return None };
        let InstData::Binary { op: BinaryOp::Lshr, args: [whole, count] } = function.insts[inst] else { return None };
        let count = function.constant(count).filter(|&count| count < u64::from(function.ty(value).bits()))?;
        Some((whole, count as u8))
    }

    /// The i1 that is extended and then shifted up by a constant number of bits, and that number.
    fn shifted_bit(&self, [extended, count]: [Value; 2]) -> Option<(Value, u8)> {
        let function = self.function;
        let extended = function.resolve(extended);
        let ValueDef::Result(inst, _) = function.values[extended].def else { return None };
        let InstData::Convert { op: ConvertOp::Zext, arg } = function.insts[inst] else { return None };
        let count = function.constant(count).filter(|&count| count < u64::from(function.ty(extended).bits()))?;
        (function.ty(arg) == Type::I1).then_some((arg, count as u8))
    }

    pub(super) fn int_compare(&mut self, cc: IntCc, args: [Value; 2], result: Value) -> Result<(), CodegenError> {
        let swapped = if matches!(cc, IntCc::Eq | IntCc::Ne) { self.swapped(args) } else { None };
        let [x, y] = match swapped {
            Some(operands) => operands,
            None => [self.value(args[0])?, self.value(args[1])?],
        };
        let value = self.b.ins().icmp(int_cc(cc), x, y);
        self.define(result, value);
        Ok(())
    }

    pub(super) fn convert(&mut self, op: ConvertOp, arg: Value, result: Value) -> Result<(), CodegenError> {
        let (from, to) = (self.function.ty(arg), self.function.ty(result));
        let clif_to = clif_type(to);
        let value = match op {
            ConvertOp::Zext if from == Type::I1 => self.bit(arg)?.placed(&mut self.b, clif_to, 0),
            ConvertOp::Zext if let Some(&Some(wide)) = self.extended.get(&self.function.resolve(arg)) => {
                if clif_to == types::I64 { wide } else { self.b.ins().ireduce(clif_to, wide) }
            }
            ConvertOp::Zext => {
                let arg = self.value(arg)?;
                if clif_type(from) == clif_to { arg } else { self.b.ins().uextend(clif_to, arg) }
            }
            ConvertOp::Sext => {
                let arg = self.value(arg)?;
                self.sign_extend(from, to, arg)
            }
            ConvertOp::Trunc if to == Type::I1 => {
                let bit = match self.shifted_down(arg) {
                    Some((whole, bit)) => Bit::Of(self.value(whole)?, bit),
                    None => Bit::Of(self.value(arg)?, 0),
                };
                self.define_bit(result, bit);
                return Ok(());
            }
            ConvertOp::Trunc => {
                let arg = self.value(arg)?;
                if clif_type(from) == clif_to { arg } else { self.b.ins().ireduce(clif_to, arg) }
            }
            ConvertOp::Bitcast if let Some((cond, float)) = self.all_ones_if_invalid(arg) => {
                let (cond, float) = (self.condition(cond)?, self.value(float)?);
                floats::bits_or_all_ones(&mut self.b, cond, float)
            }
            ConvertOp::Bitcast => {
                let arg = self.value(arg)?;
                if clif_type(from) == clif_to { arg } else { self.b.ins().bitcast(clif_to, MemFlagsData::new(), arg) }
            }
            ConvertOp::FromSint => {
                let arg = self.value(arg)?;
                self.b.ins().fcvt_from_sint(clif_to, arg)
            }
            ConvertOp::ToSint => {
                let arg = self.value(arg)?;
                self.b.ins().fcvt_to_sint_sat(clif_to, arg)
            }
            ConvertOp::FromUint => {
                let arg = self.value(arg)?;
                self.b.ins().fcvt_from_uint(clif_to, arg)
            }
            ConvertOp::ToUint => {
                let arg = self.value(arg)?;
                self.b.ins().fcvt_to_uint_sat(clif_to, arg)
            }
            ConvertOp::Fpromote => {
                let arg = self.value(arg)?;
                self.b.ins().fpromote(clif_to, arg)
            }
            ConvertOp::Fdemote => {
                let arg = self.value(arg)?;
                self.b.ins().fdemote(clif_to, arg)
            }
        };
        self.define(result, value);
        Ok(())
    }

    fn sign_extend(&mut self, from: Type, to: Type, arg: ClifValue) -> ClifValue {
        let ty = clif_type(to);
        if from == Type::I1 {
            let wide = if ty == types::I8 { arg } else { self.b.ins().uextend(ty, arg) };
            return self.b.ins().ineg(wide);
        }
        if clif_type(from) == ty { arg } else { self.b.ins().sextend(ty, arg) }
    }
}

pub(super) fn unary(b: &mut FunctionBuilder<'_>, op: UnaryOp, arg: ClifValue, native_rounding: bool) -> ClifValue {
    let is_byte = b.func.dfg.value_type(arg) == types::I8;
    let mut rounded = |rounding| match native_rounding {
        true => rounding::native(b, rounding, arg),
        false => rounding::by_addition(b, rounding, arg),
    };
    match op {
        // One byte has no order.
        UnaryOp::Bswap if is_byte => arg,
        UnaryOp::Bswap => b.ins().bswap(arg),
        UnaryOp::Ctz => b.ins().ctz(arg),
        UnaryOp::Fneg => b.ins().fneg(arg),
        UnaryOp::Fabs => b.ins().fabs(arg),
        UnaryOp::Fsqrt => b.ins().sqrt(arg),
        UnaryOp::Fceil => rounded(Rounding::Up),
        UnaryOp::Ffloor => rounded(Rounding::Down),
        UnaryOp::Ftrunc => rounded(Rounding::TowardsZero),
        UnaryOp::Fnearest => rounded(Rounding::Nearest),
    }
}

/// AND, OR or XOR.
fn bitwise(b: &mut FunctionBuilder<'_>, op: BinaryOp, [x, y]: [ClifValue; 2]) -> ClifValue {
    match op {
        BinaryOp::And => b.ins().band(x, y),
        BinaryOp::Or => b.ins().bor(x, y),
        _ => b.ins().bxor(x, y),
    }
}

fn int_cc(cc: IntCc) -> IntCC {
    match cc {
        IntCc::Eq => IntCC::Equal,
        IntCc::Ne => IntCC::NotEqual,
        IntCc::Slt => IntCC::SignedLessThan,
        IntCc::Sle => IntCC::SignedLessThanOrEqual,
        IntCc::Sgt => IntCC::SignedGreaterThan,
        IntCc::Sge => IntCC::SignedGreaterThanOrEqual,
        IntCc::Ult => IntCC::UnsignedLessThan,
        IntCc::Ule => IntCC::UnsignedLessThanOrEqual,
        IntCc::Ugt => IntCC::UnsignedGreaterThan,
        IntCc::Uge => IntCC::UnsignedGreaterThanOrEqual,
    }
}

pub(super) fn float_cc(cc: FloatCc) -> FloatCC {
    match cc {
        FloatCc::Eq => FloatCC::Equal,
        FloatCc::Ne => FloatCC::NotEqual,
        FloatCc::Lt => FloatCC::LessThan,
        FloatCc::Le => FloatCC::LessThanOrEqual,
        FloatCc::Gt => FloatCC::GreaterThan,
        FloatCc::Ge => FloatCC::GreaterThanOrEqual,
        FloatCc::Uno => FloatCC::Unordered,
    }
}
