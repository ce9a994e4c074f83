//! What the outcome of a test says about the values that were compared, and about those that are made of them.

use plcc_ir::analysis::ControlFlow;
use plcc_ir::entities::Entity;
use plcc_ir::function::ValueDef;
use plcc_ir::{Address, BinaryOp, Block, ConvertOp, Function, InstData, IntCc, Type, Value};
use rustc_hash::FxHashMap;

use super::{DEPTH_MAX, Ranges, Together};
use crate::ranges::interval::{self, Interval};

impl Ranges<'_> {
    /// The condition of the only branch to `block` is known in it.
    pub(super) fn learn_edge(&mut self, pred: Block, block: Block) {
        let Some(inst) = self.function.terminator(pred) else { return };
        match &self.function.insts[inst] {
            InstData::Branch { cond, then_to, .. } => self.learn(*cond, then_to.block == block, DEPTH_MAX),
            InstData::Switch { value, targets, .. } => {
                if let Some(index) = targets.iter().position(|target| target.block == block) {
                    self.note(*value, Interval::between(index as i64, index as i64));
                }
            }
            _ => {}
        }
    }

    /// `cond` is `holds` here.
    pub(super) fn learn(&mut self, cond: Value, holds: bool, depth: u32) {
        self.note(cond, Interval::between(holds.into(), holds.into()));
        if depth == 0 {
            return;
        }
        match self.function.defining(cond) {
            Some(&InstData::IntCompare { cc, args: [a, b] }) if self.function.ty(a) != Type::I1 => {
                let cc = if holds { cc } else { interval::negated(cc) };
                self.learn_compare(cc, a, b, depth);
                self.learn_compare(interval::swapped(cc), b, a, depth);
            }
            Some(&InstData::Binary { op, args: [a, b] }) => match (op, holds) {
                (BinaryOp::And, true) | (BinaryOp::Or, false) => {
                    self.learn(a, holds, depth - 1);
                    self.learn(b, holds, depth - 1);
                }
                (BinaryOp::Xor, _) if self.function.constant(b) == Some(1) => self.learn(a, !holds, depth - 1),
                _ => {}
            },
            // The end of a FOR whose step is a variable depends on its sign.
            Some(&InstData::Select { cond: chosen, if_true, if_false }) => {
                match self.get(chosen).and_then(Interval::single) {
                    Some(0) => self.learn(if_false, holds, depth - 1),
                    Some(_) => self.learn(if_true, holds, depth - 1),
                    None => {}
                }
            }
            _ => {}
        }
    }

    /// `a cc b` holds here, which says something about `a` and the values from which it is made.
    fn learn_compare(&mut self, cc: IntCc, a: Value, b: Value, depth: u32) {
        let (Some(range), Some(other)) = (self.get(a), self.get(b)) else { return };
        if let Some(range) = interval::refined(cc, range, other) {
            self.learn_range(a, range, depth);
        }
    }

    fn learn_range(&mut self, value: Value, range: Interval, depth: u32) {
        self.note(value, range);
        if depth == 0 {
            return;
        }
        let ty = self.function.ty(value);
        match self.function.defining(value) {
            Some(&InstData::Convert { op, arg }) => {
                let from = self.function.ty(arg);
                let kept = match op {
                    ConvertOp::Sext => from != Type::I1,
                    ConvertOp::Zext => from != Type::I1 && range.hi <= Interval::full(from).hi,
                    // The operand must have fitted.
                    ConvertOp::Trunc => {
                        ty != Type::I1 && self.get(arg).is_some_and(|arg| Interval::full(ty).contains(arg))
                    }
                    _ => false,
                };
                if kept {
                    self.learn_range(arg, range, depth - 1);
                }
            }
            Some(&InstData::Binary { op: op @ (BinaryOp::Iadd | BinaryOp::Isub), args: [a, b] }) => {
                let Some(constant) = self.get(b).and_then(Interval::single) else { return };
                // The operand is the sum minus the constant; where that wraps, both ends must do so.
                let constant = if op == BinaryOp::Iadd { i128::from(constant) } else { -i128::from(constant) };
                let full = Interval::full(ty);
                let size = i128::from(full.hi) - i128::from(full.lo) + 1;
                let (lo, hi) = (i128::from(range.lo) - constant, i128::from(range.hi) - constant);
                let turns = (lo - i128::from(full.lo)).div_euclid(size);
                if let (Ok(lo), Ok(hi)) = (i64::try_from(lo - turns * size), i64::try_from(hi - turns * size))
                    && hi <= full.hi
                {
                    self.learn_range(a, Interval { lo, hi, zeros: 0 }, depth - 1);
                }
            }
            _ => {}
        }
    }

    fn note(&mut self, value: Value, range: Interval) {
        let value = self.function.resolve(value);
        if self.function.constant(value).is_some() {
            return;
        }
        let before = self.here[value.index()];
        let now = match before {
            // Contradictions are left to the code that is never run.
            Some(before) => before.meet(range).unwrap_or(before),
            None => range,
        };
        let now = self.strides.get(&value).map_or(now, |&(first, stride)| now.on_strides(first, stride));
        if before != Some(now) {
            self.undo.push((value, before));
            self.here[value.index()] = Some(now);
            if self.deriving < DEPTH_MAX {
                self.deriving += 1;
                self.derive(value);
                self.note_together(value, now);
                self.deriving -= 1;
            }
        }
    }

    /// `value`, a parameter of a loop, is in `range` here: so are those that count along with it.
    fn note_together(&mut self, value: Value, range: Interval) {
        let Some(together) = self.together.get(&value) else { return };
        for Together { param, times, plus } in together.clone() {
            let ends = [range.lo, range.hi].map(|end| end.checked_mul(times)?.checked_add(plus));
            if let [Some(a), Some(b)] = ends {
                self.note(param, Interval { lo: a.min(b), hi: a.max(b), zeros: 0 });
            }
        }
    }

    /// Something new is known of `value`: computes again what was made of it before. What this sweep has not come to yet has the range of
    /// the sweep before, which may be too small, and is computed from what is known here anyway.
    fn derive(&mut self, value: Value) {
        let Some(derived) = self.derived.get(&value) else { return };
        for result in derived.clone() {
            let ValueDef::Result(inst, _) = self.function.values[result].def else { continue };
            if self.computed[result.index()] == self.sweeps
                && let Some(range) = self.result(inst, self.function.ty(result))
            {
                self.note(result, range);
            }
        }
    }
}

/// See [`Ranges::derived`].
pub(super) fn derived(function: &Function, cfg: &ControlFlow) -> FxHashMap<Value, Vec<Value>> {
    /// More are not worth the time.
    const DERIVED_MAX: usize = 4;
    let mut derived: FxHashMap<Value, Vec<Value>> = FxHashMap::default();
    for &block in &cfg.rpo {
        for &inst in &function.blocks[block].insts {
            let from = match function.insts[inst] {
                InstData::Convert { op: ConvertOp::Sext | ConvertOp::Zext | ConvertOp::Trunc, arg } => arg,
                InstData::Binary {
                    op:
                        BinaryOp::Iadd
                        | BinaryOp::Isub
                        | BinaryOp::Imul
                        | BinaryOp::And
                        | BinaryOp::Shl
                        | BinaryOp::Lshr
                        | BinaryOp::Ashr,
                    args: [a, b],
                } if function.constant(b).is_some() => a,
                InstData::AddressOf { addr: Address { base: Some(base), .. } } => base,
                _ => continue,
            };
            if function.ty(from) != Type::I1 {
                let list = derived.entry(function.resolve(from)).or_default();
                if list.len() < DERIVED_MAX {
                    list.push(function.result(inst));
                }
            }
        }
    }
    derived
}
