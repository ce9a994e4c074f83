//! Loops that end when a counter is equal to a number, which it may reach in steps of more than 1.

use plcc_ir::{BinaryOp, Block, ConvertOp, InstData, IntCc, Type, Value};

use super::Ranges;
use super::companions::Step;
use crate::ranges::interval::Interval;

/// Blocks between a jump back and the head of its loop whose tests are looked at.
const TESTS_MAX: usize = 16;
/// Sums and conversions between a counter and what is compared.
const SUMS_MAX: usize = 4;

impl Ranges<'_> {
    /// How many passes the loop of `param`, which changes by `step`, begins at most because a pass in which it has a certain number does
    /// not jump back. It gets there from its first number without leaving it out.
    pub(super) fn passes_until_equal(&self, header: Block, param: Value, step: Step) -> Option<i64> {
        let by = step.constant()?;
        let first = self.first(header, param)?.single()?;
        let full = Interval::full(self.function.ty(param));
        if step.fits != full {
            return None;
        }
        let last = self.last_number(header, param)?;
        // All is counted as the type of the comparison does, which may wrap.
        let size = 1i64.checked_shl(last.bits).filter(|&size| size > 0)?;
        let way = if by > 0 { last.number.checked_sub(first)? } else { first.checked_sub(last.number)? };
        let way = way.rem_euclid(size);
        (way % by.abs() == 0).then(|| way / by.abs() + 1)
    }

    /// The number that `param` has in no pass that jumps back to `header`.
    fn last_number(&self, header: Block, param: Value) -> Option<Last> {
        let place = self.cfg.rpo_index(header);
        let latches: Vec<Block> =
            self.cfg.predecessors(header).iter().copied().filter(|&pred| self.cfg.rpo_index(pred) >= place).collect();
        let mut at = Some(*latches.first()?);
        for _ in 0..TESTS_MAX {
            let block = at?;
            let inst = self.function.terminator(block)?;
            if let InstData::Branch { cond, then_to, else_to } = &self.function.insts[inst] {
                for (on, other, holds) in [(then_to, else_to, true), (else_to, then_to, false)] {
                    let leads_back = |&latch: &Block| match on.block == header {
                        true => latch == block && other.block != header,
                        false => {
                            self.cfg.predecessors(on.block) == [block] && self.dominators.dominates(on.block, latch)
                        }
                    };
                    if on.block != other.block
                        && latches.iter().all(leads_back)
                        && let Some(last) = self.excluded(param, *cond, holds)
                    {
                        return Some(last);
                    }
                }
            }
            if block == header {
                return None;
            }
            at = self.dominators.immediate(block);
        }
        None
    }

    /// The number that `param` does not have if `cond` is `holds`, a comparison for equality of it, of a sum with a constant, or of its low bits.
    fn excluded(&self, param: Value, cond: Value, holds: bool) -> Option<Last> {
        let &InstData::IntCompare { cc, args: [compared, with] } = self.function.defining(cond)? else { return None };
        let ty = self.function.ty(compared);
        if cc != (if holds { IntCc::Ne } else { IntCc::Eq }) || ty == Type::I1 {
            return None;
        }
        let mut number = self.constant(with)?;
        let mut at = self.function.resolve(compared);
        for _ in 0..SUMS_MAX {
            if at == param {
                return Some(Last { number, bits: ty.bits() });
            }
            let from = match *self.function.defining(at)? {
                InstData::Binary { op: BinaryOp::Iadd, args: [a, b] } => {
                    number = number.checked_sub(self.constant(b)?)?;
                    a
                }
                InstData::Binary { op: BinaryOp::Isub, args: [a, b] } => {
                    number = number.checked_add(self.constant(b)?)?;
                    a
                }
                InstData::Convert { op: ConvertOp::Trunc, arg } => arg,
                _ => return None,
            };
            at = self.function.resolve(from);
        }
        None
    }
}

/// The number that a counter has in the last pass, in its low bits.
struct Last {
    number: i64,
    bits: u32,
}
