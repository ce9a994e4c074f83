//! Parameters of a loop that count along with each other.

use plcc_ir::entities::Entity;
use plcc_ir::{BinaryOp, Block, BlockCall, ConvertOp, InstData, Value};

use super::{ADDRESS_MASK, DEPTH_MAX, Ranges};
use crate::ranges::interval::{self, Interval};

impl<'f> Ranges<'f> {
    /// Parameters of a loop that all change by a constant with each pass count along with each other: one with known ends says how
    /// often the loop runs at most, and so how far the others get.
    pub(super) fn find_companions(&mut self) {
        for &header in &self.cfg.rpo {
            let Some(calls) = self.jumps_back(header) else { continue };
            let params = &self.function.blocks[header].params;
            let step = |(index, &param): (usize, &Value)| {
                // An address register keeps its area.
                let area = self.first(header, param).and_then(|first| interval::common_bits(first, ADDRESS_MASK));
                let mut steps = calls.iter().map(|call| self.step_of(param, call.args[index], area.unwrap_or(0)));
                let first = steps.next()??;
                steps.all(|other| other == Some(first)).then_some(first)
            };
            let steps: Vec<Option<Step>> = params.iter().enumerate().map(step).collect();
            let passes = params.iter().zip(&steps).filter_map(|(&param, step)| self.passes(param, (*step)?)).min();
            let Some(passes) = passes else { continue };
            self.passes.insert(header, passes);
            for (&param, step) in params.iter().zip(&steps) {
                let (Some(step), Some(first)) = (*step, self.first(header, param)) else { continue };
                if let Some(limit) = reach(first, step, passes) {
                    self.limits.insert(param, limit);
                }
            }
        }
    }

    /// The jumps back to `header`, if it is the head of a loop.
    fn jumps_back(&self, header: Block) -> Option<Vec<&'f BlockCall>> {
        let place = self.cfg.rpo_index(header);
        let mut calls = Vec::new();
        for &pred in self.cfg.predecessors(header).iter().filter(|&&pred| self.cfg.rpo_index(pred) >= place) {
            let inst = self.function.terminator(pred)?;
            if !self.dominators.dominates(header, pred) {
                return None;
            }
            calls.extend(self.function.insts[inst].targets().into_iter().filter(|call| call.block == header));
        }
        (!calls.is_empty()).then_some(calls)
    }

    /// The constant by which the argument of the jump back differs from the parameter.
    /// `area`: the bits above the address that the parameter has in the first pass.
    fn step_of(&self, param: Value, arg: Value, area: i64) -> Option<Step> {
        let mut keeps_area = false;
        let mut step = Step { by: 0, fits: Interval::full(self.function.ty(param)) };
        let mut at = self.function.resolve(arg);
        for _ in 0..=2 * DEPTH_MAX {
            if at == param {
                return Some(step);
            }
            match *self.function.defining(at)? {
                InstData::Binary { op: BinaryOp::Iadd, args: [a, b] } => {
                    step.by = step.by.checked_add(self.constant(b)?)?;
                    step.fits = step.fits.meet(Interval::full(self.function.ty(at)))?;
                    at = self.function.resolve(a);
                }
                InstData::Binary { op: BinaryOp::Isub, args: [a, b] } => {
                    step.by = step.by.checked_sub(self.constant(b)?)?;
                    step.fits = step.fits.meet(Interval::full(self.function.ty(at)))?;
                    at = self.function.resolve(a);
                }
                // The address register: the byte of the area stays, the rest is counted in 24 bits.
                // The area may be known by now.
                InstData::Binary { op: BinaryOp::Or, args: [a, b] }
                    if self.constant(b).is_some_and(|bits| bits == area && bits != 0) =>
                {
                    let InstData::Binary { op: BinaryOp::And, args: [_, mask] } = *self.function.defining(a)? else {
                        return None;
                    };
                    keeps_area = self.constant(mask)? == ADDRESS_MASK;
                    if !keeps_area {
                        return None;
                    }
                    at = self.function.resolve(a);
                }
                InstData::Binary { op: BinaryOp::Or, args: [a, b] } => {
                    let kept = |value: Value| match *self.function.defining(value)? {
                        InstData::Binary { op: BinaryOp::And, args: [x, mask] }
                            if self.function.resolve(x) == param =>
                        {
                            self.constant(mask)
                        }
                        _ => None,
                    };
                    let (kept, counted) = match (kept(a), kept(b)) {
                        (Some(mask), _) => (mask, b),
                        (None, Some(mask)) => (mask, a),
                        (None, None) => return None,
                    };
                    let InstData::Binary { op: BinaryOp::And, args: [_, mask] } = *self.function.defining(counted)?
                    else {
                        return None;
                    };
                    if self.constant(mask)? & kept != 0 {
                        return None;
                    }
                    keeps_area = kept == !ADDRESS_MASK && self.constant(mask)? == ADDRESS_MASK;
                    at = self.function.resolve(counted);
                }
                InstData::Binary { op: BinaryOp::And, args: [a, mask] } => {
                    let mask = self.constant(mask)?;
                    if mask < 0 || mask & (mask + 1) != 0 || step.by != 0 {
                        return None;
                    }
                    let low = if keeps_area { area } else { 0 };
                    step.fits = step.fits.meet(Interval::between(low, low + mask))?;
                    at = self.function.resolve(a);
                }
                // A conversion that changes nothing.
                InstData::Convert { op: ConvertOp::Sext | ConvertOp::Zext | ConvertOp::Trunc, arg } => {
                    let (from, to) = (self.values[arg.index()]?, self.values[at.index()]?);
                    if from != to {
                        return None;
                    }
                    at = self.function.resolve(arg);
                }
                _ => return None,
            }
        }
        None
    }

    /// How often the loop of a parameter that changes by `step` begins a pass at most; `None`: it may wrap.
    fn passes(&self, param: Value, step: Step) -> Option<i64> {
        let range = self.values[param.index()]?;
        (step.by != 0 && step.keeps(range)).then(|| (range.hi - range.lo) / step.by.abs() + 1)
    }

    /// What a parameter of a loop can be in the first pass.
    fn first(&self, header: Block, param: Value) -> Option<Interval> {
        let index = self.function.blocks[header].params.iter().position(|&other| other == param)?;
        let place = self.cfg.rpo_index(header);
        let mut first: Option<Interval> = None;
        for &pred in self.cfg.predecessors(header).iter().filter(|&&pred| self.cfg.rpo_index(pred) < place) {
            let inst = self.function.terminator(pred)?;
            for call in self.function.insts[inst].targets().into_iter().filter(|call| call.block == header) {
                let arg = self.function.resolve(call.args[index]);
                let range = match self.function.constant(arg) {
                    Some(_) => self.get(arg)?,
                    None => self.values[arg.index()]?,
                };
                first = Some(first.map_or(range, |first| first.join(range)));
            }
        }
        first
    }
}

/// How a parameter of a loop changes from pass to pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Step {
    by: i64,
    /// It is so as long as the parameter is in here before and after: the narrowest type and mask on the way.
    fits: Interval,
}

impl Step {
    /// True if all numbers of `range` stay within bounds with this step.
    fn keeps(self, range: Interval) -> bool {
        let inside = |number: i64| (self.fits.lo..=self.fits.hi).contains(&number);
        [range.lo, range.hi].into_iter().all(|end| inside(end) && end.checked_add(self.by).is_some_and(inside))
    }
}

/// How far a value gets that changes by `step` from pass to pass; `None`: it may wrap.
fn reach(first: Interval, step: Step, passes: i64) -> Option<Interval> {
    let way = step.by.checked_mul(passes.checked_sub(1)?)?;
    let (lo, hi) = (first.lo.checked_add(way.min(0))?, first.hi.checked_add(way.max(0))?);
    let zeros = first.zeros.min(if step.by == 0 { 63 } else { step.by.trailing_zeros() });
    let range = Interval { lo, hi, zeros };
    // After the last pass it is computed once more.
    step.keeps(range).then_some(range)
}
