//! Constant folding, Boolean and algebraic simplification.
//!
//! Blocks are visited in reverse postorder, so that the operands of an instruction have been simplified before it. Each
//! instruction is rewritten until no rule fits. The rules that matter most for PLC code:
//!
//! ```text
//! v3 = and v1, -65536        ; the high word of ACCU1 is kept ...
//! v4 = zext.i32 v2
//! v5 = or v3, v4
//! v6 = trunc.i16 v5          ; ... and it is unused: v6 is v2
//!
//! v7 = slt v1, v2            ; CC0
//! v8 = sgt v1, v2            ; CC1
//! v9 = or v7, v8             ; `JN` after a comparison: ne v1, v2
//! ```
//!
//! Every rule produces the same bits for all operands, including NaN patterns. Therefore floats have few rules. A division is
//! folded only if it is defined. No rule makes an instruction that was not there on a path before.

mod compare;
pub(crate) mod integer;

use plcc_ir::analysis::reverse_postorder;
use plcc_ir::{
    BinaryOp, BlockCall, Class, ConvertOp, Function, Inst, InstData, IntCc, Loc, Type, UnaryOp, Value, eval,
};

/// Applies the rules to a function. Result: whether anything changed.
pub fn fold(function: &mut Function) -> bool {
    let order = reverse_postorder(function);
    let mut folder = Folder { function, out: Vec::new(), loc: Loc(0), changed: false };
    for block in order {
        let mut insts = std::mem::take(&mut folder.function.blocks[block].insts);
        for &inst in &insts {
            folder.visit(inst);
        }
        insts.clear();
        insts.append(&mut folder.out);
        folder.function.blocks[block].insts = insts;
    }
    let changed = folder.changed;
    if changed {
        function.resolve_aliases();
    }
    changed
}

/// The replacement of an instruction.
enum Change {
    /// Its result is this value.
    Value(Value),
    /// It is this instruction instead.
    Data(InstData),
}

/// Rules chain at most this often at one instruction; more would be two rules that undo each other.
const STEPS_MAX: usize = 16;

struct Folder<'a> {
    function: &'a mut Function,
    /// The instructions of the block so far.
    out: Vec<Inst>,
    loc: Loc,
    changed: bool,
}

impl Folder<'_> {
    fn visit(&mut self, inst: Inst) {
        self.function.resolve_uses(inst);
        // Only these have rules in `step`.
        if !matches!(self.function.insts[inst].class(), Class::Value | Class::Choice) {
            self.out.push(inst);
            return;
        }
        self.loc = self.function.locs[inst];
        for _ in 0..STEPS_MAX {
            match self.step(inst) {
                None => break,
                Some(Change::Data(new)) => self.function.insts[inst] = new,
                Some(Change::Value(value)) => {
                    self.changed = true;
                    let result = self.function.result(inst);
                    self.function.replace_value(result, value);
                    self.function.insts[inst] = InstData::Const { bits: 0 };
                    return;
                }
            }
            self.changed = true;
        }
        self.out.push(inst);
    }

    fn step(&mut self, inst: Inst) -> Option<Change> {
        match self.function.insts[inst] {
            InstData::Unary { op, arg } => self.unary(op, arg),
            InstData::Binary { op, args } => self.binary(op, args),
            InstData::IntCompare { cc, args } => self.int_compare(cc, args),
            InstData::FloatCompare { cc, args } => self.float_compare(cc, args),
            InstData::Convert { op, arg } => self.convert(op, self.ty(self.function.result(inst)), arg),
            InstData::Select { cond, if_true, if_false } => self.select(cond, if_true, if_false),
            InstData::Branch { .. } => {
                let data = std::mem::replace(&mut self.function.insts[inst], InstData::Const { bits: 0 });
                let InstData::Branch { cond, then_to, else_to } = &data else { unreachable!("it is a branch") };
                let change = self.branch(*cond, then_to, else_to);
                self.function.insts[inst] = data;
                change
            }
            InstData::Switch { value, ref targets, ref default } => {
                let target = match self.function.constant(value) {
                    Some(bits) => targets.get(bits as usize).unwrap_or(default),
                    None if targets.iter().all(|target| target == default) => default,
                    None => return None,
                };
                Some(Change::Data(InstData::Jump { target: target.clone() }))
            }
            InstData::Const { .. }
            | InstData::Load { .. }
            | InstData::Store { .. }
            | InstData::LoadBit { .. }
            | InstData::StoreBit { .. }
            | InstData::AddressOf { .. }
            | InstData::Clear { .. }
            | InstData::Copy { .. }
            | InstData::DbBase { .. }
            | InstData::DbLength { .. }
            | InstData::Call { .. }
            | InstData::CallRuntime { .. }
            | InstData::FrameBase { .. }
            | InstData::Jump { .. }
            | InstData::Return { .. } => None,
        }
    }

    fn ty(&self, value: Value) -> Type {
        self.function.ty(value)
    }

    fn constant(&self, value: Value) -> Option<u64> {
        self.function.constant(value)
    }

    /// Puts an instruction before the one that is visited.
    fn emit(&mut self, data: InstData, ty: Type) -> Value {
        let inst = self.function.make_inst(data, &[ty], self.loc);
        self.out.push(inst);
        self.function.result(inst)
    }

    fn emit_const(&mut self, ty: Type, bits: u64) -> Value {
        self.emit(InstData::Const { bits: eval::mask(ty, bits) }, ty)
    }

    /// The operand of a one's complement (of an i1 a negation).
    fn negated(&self, value: Value) -> Option<Value> {
        match self.function.defining(value) {
            Some(InstData::Binary { op: BinaryOp::Xor, args: [a, b] }) => {
                let ones = eval::mask(self.ty(value), u64::MAX);
                (self.constant(*b) == Some(ones)).then_some(*a)
            }
            _ => None,
        }
    }

    fn unary(&mut self, op: UnaryOp, arg: Value) -> Option<Change> {
        let ty = self.ty(arg);
        if let Some(bits) = self.constant(arg) {
            return constant(eval::mask(ty, eval::unary(op, ty, bits)));
        }
        match (op, self.function.defining(arg)) {
            (UnaryOp::Bswap | UnaryOp::Fneg, Some(InstData::Unary { op: inner, arg: x })) if *inner == op => {
                Some(Change::Value(*x))
            }
            (UnaryOp::Fabs, Some(InstData::Unary { op: UnaryOp::Fabs, .. })) => Some(Change::Value(arg)),
            (UnaryOp::Fabs, Some(InstData::Unary { op: UnaryOp::Fneg, arg: x })) => {
                Some(Change::Data(InstData::Unary { op, arg: *x }))
            }
            _ => None,
        }
    }

    fn convert(&mut self, op: ConvertOp, to: Type, arg: Value) -> Option<Change> {
        let from = self.ty(arg);
        if let Some(bits) = self.constant(arg) {
            return constant(eval::convert(op, from, to, bits));
        }
        if op == ConvertOp::Trunc
            && to == Type::I1
            && let Some(change) = self.trunc_of_bits(arg)
        {
            return Some(change);
        }
        if op == ConvertOp::Trunc
            && let Some(change) = self
                .trunc_of_parts(to, arg)
                .or_else(|| self.trunc_of_shift(to, arg))
                .or_else(|| self.trunc_of_sum(to, arg))
        {
            return Some(change);
        }
        if let (ConvertOp::Trunc, Some(&InstData::Select { cond, if_true, if_false })) =
            (op, self.function.defining(arg))
            && let (Some(t), Some(f)) = (self.constant(if_true), self.constant(if_false))
        {
            let (if_true, if_false) = (self.emit_const(to, t), self.emit_const(to, f));
            return Some(Change::Data(InstData::Select { cond, if_true, if_false }));
        }
        let Some(&InstData::Convert { op: inner, arg: x }) = self.function.defining(arg) else { return None };
        let narrow = self.ty(x);
        let again = |op| Some(Change::Data(InstData::Convert { op, arg: x }));
        match (op, inner) {
            (ConvertOp::Zext, ConvertOp::Zext)
            | (ConvertOp::Sext, ConvertOp::Sext)
            | (ConvertOp::Trunc, ConvertOp::Trunc) => again(op),
            // The sign of a value filled with 0 is 0.
            (ConvertOp::Sext, ConvertOp::Zext) => again(ConvertOp::Zext),
            (ConvertOp::Trunc, ConvertOp::Zext | ConvertOp::Sext) => {
                if to == narrow {
                    Some(Change::Value(x))
                } else if to.bits() < narrow.bits() {
                    again(ConvertOp::Trunc)
                } else {
                    again(inner)
                }
            }
            (ConvertOp::Bitcast, ConvertOp::Bitcast) => Some(Change::Value(x)),
            _ => None,
        }
    }

    fn select(&mut self, cond: Value, if_true: Value, if_false: Value) -> Option<Change> {
        if if_true == if_false {
            return Some(Change::Value(if_true));
        }
        if let Some(bits) = self.constant(cond) {
            return Some(Change::Value(if bits != 0 { if_true } else { if_false }));
        }
        let ty = self.ty(if_true);
        let (t, f) = (self.constant(if_true), self.constant(if_false));
        if t.is_some() && t == f {
            return Some(Change::Value(if_true));
        }
        // Where the two are equal it does not matter which one it is.
        if let Some(&InstData::IntCompare { cc: cc @ (IntCc::Eq | IntCc::Ne), args: [a, b] }) =
            self.function.defining(cond)
            && ([a, b] == [if_true, if_false] || [b, a] == [if_true, if_false])
        {
            return Some(Change::Value(if cc == IntCc::Eq { if_false } else { if_true }));
        }
        if let Some(x) = self.negated(cond) {
            return Some(Change::Data(InstData::Select { cond: x, if_true: if_false, if_false: if_true }));
        }
        if ty == Type::I1 {
            let binary = |op, other| Some(Change::Data(InstData::Binary { op, args: [cond, other] }));
            return match (t, f) {
                (Some(1), Some(0)) => Some(Change::Value(cond)),
                (Some(0), Some(1)) => binary(BinaryOp::Xor, if_false),
                (Some(1), None) => binary(BinaryOp::Or, if_false),
                (None, Some(0)) => binary(BinaryOp::And, if_true),
                (Some(0), None) => {
                    let not = self.emit_not(cond);
                    Some(Change::Data(InstData::Binary { op: BinaryOp::And, args: [not, if_false] }))
                }
                (None, Some(1)) => {
                    let not = self.emit_not(cond);
                    Some(Change::Data(InstData::Binary { op: BinaryOp::Or, args: [not, if_true] }))
                }
                _ => None,
            };
        }
        match (ty.is_int(), t, f) {
            (true, Some(1), Some(0)) => Some(Change::Data(InstData::Convert { op: ConvertOp::Zext, arg: cond })),
            (true, Some(0), Some(1)) => {
                let not = self.emit_not(cond);
                Some(Change::Data(InstData::Convert { op: ConvertOp::Zext, arg: not }))
            }
            (true, None, None) => self.counted(cond, if_true, if_false, ty),
            _ => None,
        }
    }

    /// A counter that goes on by 1 or stays as it is: in a chain of them, a sum with the condition is one step, a sum and a selection are two.
    fn counted(&mut self, cond: Value, if_true: Value, if_false: Value, ty: Type) -> Option<Change> {
        let step = |next: Value, from: Value| match self.function.defining(next)? {
            &InstData::Binary { op: BinaryOp::Iadd, args: [x, step] } if x == from => {
                let step = self.constant(step)?;
                [(1, BinaryOp::Iadd), (eval::mask(ty, u64::MAX), BinaryOp::Isub)]
                    .into_iter()
                    .find(|(one, _)| *one == step)
            }
            _ => None,
        };
        let (from, (_, op), counts) = match (step(if_true, if_false), step(if_false, if_true)) {
            (Some(op), _) => (if_false, op, cond),
            (None, Some(op)) => (if_true, op, self.emit_not(cond)),
            (None, None) => return None,
        };
        let one = self.emit(InstData::Convert { op: ConvertOp::Zext, arg: counts }, ty);
        Some(Change::Data(InstData::Binary { op, args: [from, one] }))
    }

    fn emit_not(&mut self, cond: Value) -> Value {
        let one = self.emit_const(Type::I1, 1);
        self.emit(InstData::Binary { op: BinaryOp::Xor, args: [cond, one] }, Type::I1)
    }

    fn branch(&mut self, cond: Value, then_to: &BlockCall, else_to: &BlockCall) -> Option<Change> {
        let jump = |target: &BlockCall| Some(Change::Data(InstData::Jump { target: target.clone() }));
        if then_to == else_to {
            return jump(then_to);
        }
        if let Some(bits) = self.constant(cond) {
            return jump(if bits != 0 { then_to } else { else_to });
        }
        if then_to.block == else_to.block {
            // Both arms go to one place: only the values differ.
            let pairs: Vec<_> = then_to.args.iter().copied().zip(else_to.args.iter().copied()).collect();
            let args = pairs.into_iter().map(|(if_true, if_false)| self.chosen(cond, if_true, if_false)).collect();
            return Some(Change::Data(InstData::Jump { target: BlockCall { block: then_to.block, args } }));
        }
        let cond = self.negated(cond)?;
        Some(Change::Data(InstData::Branch { cond, then_to: else_to.clone(), else_to: then_to.clone() }))
    }

    /// One of two values, by `cond`.
    fn chosen(&mut self, cond: Value, if_true: Value, if_false: Value) -> Value {
        if if_true == if_false {
            return if_true;
        }
        let ty = self.ty(if_true);
        self.emit(InstData::Select { cond, if_true, if_false }, ty)
    }
}

fn constant(bits: u64) -> Option<Change> {
    Some(Change::Data(InstData::Const { bits }))
}

#[cfg(test)]
mod tests;
