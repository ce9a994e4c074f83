//! Parameters of a loop that count along with each other.

use plcc_ir::entities::Entity;
use plcc_ir::function::ValueDef;
use plcc_ir::{BinaryOp, Block, BlockCall, ConvertOp, InstData, Type, Value};

use super::{ADDRESS_MASK, Ranges, Together};
use crate::ranges::interval::{self, Interval};

/// Steps back from what a jump back brings to the parameter; more are not worth the time.
const BUDGET: u32 = 64;
/// Steps back from what a loop begins with.
const SUM_MAX: usize = 8;
/// Parameters of a loop that are compared with each other.
const COUNTERS_MAX: usize = 12;

impl<'f> Ranges<'f> {
    /// Parameters of a loop that all change by a constant, or by an amount of a known range, with each pass count along with each other:
    /// one with known ends that changes by a constant says how often the loop runs at most, and so how far the others get.
    ///
    /// Result: whether the next look finds more, with what this one has found out: of a parameter that gets on by what an inner loop adds to
    /// it, or of a counter that had no ends.
    pub(super) fn find_companions(&mut self) -> bool {
        let mut is_more_known = false;
        // Inner loops come first.
        for &header in self.cfg.rpo.iter().rev() {
            let Some(calls) = self.jumps_back(header) else { continue };
            let params = &self.function.blocks[header].params;
            let step = |(index, &param): (usize, &Value)| {
                let area = self.area_of(header, param);
                let mut way = Way { param, area, budget: BUDGET, is_nested: false };
                let mut steps = calls.iter().map(|call| self.step_of(&mut way, call.args[index]));
                let first = steps.next()??;
                let step = steps.try_fold(first, |step, other| step.or(other?))?;
                Some((step, way.is_nested))
            };
            let steps: Vec<Option<(Step, bool)>> = params.iter().enumerate().map(step).collect();
            let counters = || params.iter().zip(&steps).filter_map(|(&param, step)| Some((param, (*step)?.0)));
            let by_ends = counters().filter_map(|(param, step)| self.passes(param, step)).min();
            let until_equal = counters().filter_map(|(param, step)| self.passes_until_equal(header, param, step)).min();
            self.limit_by_each_other(header, &steps);
            let Some(passes) = by_ends.into_iter().chain(until_equal).min() else { continue };
            is_more_known |= self.passes.insert(header, passes) != Some(passes) && by_ends != Some(passes);
            for (&param, step) in params.iter().zip(&steps) {
                let (Some((step, nested)), Some(first)) = (*step, self.first(header, param)) else { continue };
                if let Some(limit) = reach(first, step, passes) {
                    self.limit(param, limit);
                    is_more_known |= nested;
                    if let (Some(first), Some(by)) = (first.single(), step.constant()) {
                        self.strides.insert(param, (first, by.abs()));
                    }
                }
            }
        }
        is_more_known
    }

    /// A parameter that begins as so many times another one plus a constant, and changes by so many times its step, stays that: the pointer to
    /// the element that a counter names. So it gets no further than the other one says, wherever that begins.
    fn limit_by_each_other(&mut self, header: Block, steps: &[Option<(Step, bool)>]) {
        let params = &self.function.blocks[header].params;
        let counter = |(index, step): (usize, &Option<(Step, bool)>)| {
            let (step, _) = (*step)?;
            Some((index, step, step.constant()?))
        };
        let counters: Vec<(usize, Step, i64)> =
            steps.iter().enumerate().filter_map(counter).take(COUNTERS_MAX).collect();
        for &(index, step, by) in &counters {
            for &(other, other_step, other_by) in counters.iter().filter(|(other, ..)| *other != index) {
                let range = self.values[params[other].index()].filter(|&range| other_step.keeps(range));
                let times = by.checked_div(other_by).filter(|times| times.checked_mul(other_by) == Some(by));
                let (Some(range), Some(times)) = (range, times) else { continue };
                let Some(plus) = self.difference_at_first(header, [index, other], times) else { continue };
                let ends = [range.lo, range.hi].map(|end| end.checked_mul(times)?.checked_add(plus));
                let [Some(a), Some(b)] = ends else { continue };
                let zeros = times.trailing_zeros().min(if plus == 0 { 63 } else { plus.trailing_zeros() });
                let limit = Interval { lo: a.min(b), hi: a.max(b), zeros };
                if step.fits.lo <= limit.lo && limit.hi <= step.fits.hi {
                    self.limit(params[index], limit);
                    let together = self.together.entry(params[other]).or_default();
                    let own = Together { param: params[index], times, plus };
                    if !together.contains(&own) {
                        together.push(own);
                    }
                }
            }
        }
    }

    /// What all jumps from before the loop bring for the first parameter, minus so many times what they bring for the second one.
    fn difference_at_first(&self, header: Block, [index, other]: [usize; 2], times: i64) -> Option<i64> {
        let place = self.cfg.rpo_index(header);
        let mut difference: Option<i64> = None;
        for &pred in self.cfg.predecessors(header).iter().filter(|&&pred| self.cfg.rpo_index(pred) < place) {
            let inst = self.function.terminator(pred)?;
            for call in self.function.insts[inst].targets().into_iter().filter(|call| call.block == header) {
                let (first, second) = (self.sum(call.args[index])?, self.sum(call.args[other])?);
                if first.of != second.of || first.times != second.times.checked_mul(times)? {
                    return None;
                }
                let found = first.plus.checked_sub(second.plus.checked_mul(times)?)?;
                if difference.is_some_and(|known| known != found) {
                    return None;
                }
                difference = Some(found);
            }
        }
        difference
    }

    /// What a value is made of, where nothing on the way wraps.
    fn sum(&self, value: Value) -> Option<Sum> {
        let (mut times, mut plus) = (1i64, 0i64);
        let mut at = self.function.resolve(value);
        for _ in 0..SUM_MAX {
            if let Some(constant) = self.constant(at) {
                return Some(Sum { of: None, times: 0, plus: plus.checked_add(constant.checked_mul(times)?)? });
            }
            let from = match self.function.defining(at) {
                Some(&InstData::Binary { op, args: [a, b] }) if self.constant(b).is_some() => {
                    let (constant, range) = (self.constant(b)?, self.anywhere(a)?);
                    let (factor, added) = match op {
                        BinaryOp::Iadd => (1, constant),
                        BinaryOp::Isub => (1, constant.checked_neg()?),
                        BinaryOp::Imul => (constant, 0),
                        BinaryOp::Shl if (0..32).contains(&constant) => (1 << constant, 0),
                        _ => break,
                    };
                    let full = Interval::full(self.function.ty(at));
                    let fits = [range.lo, range.hi].into_iter().all(|end| {
                        let exact = end.checked_mul(factor).and_then(|end| end.checked_add(added));
                        exact.is_some_and(|exact| (full.lo..=full.hi).contains(&exact))
                    });
                    if !fits {
                        break;
                    }
                    plus = plus.checked_add(added.checked_mul(times)?)?;
                    times = times.checked_mul(factor)?;
                    a
                }
                Some(&InstData::Convert { op: ConvertOp::Sext, arg }) if self.function.ty(arg) != Type::I1 => arg,
                Some(&InstData::Convert { op: ConvertOp::Zext, arg }) if self.function.ty(arg) != Type::I1 => {
                    if !self.anywhere(arg)?.is_natural() {
                        return Some(Sum { of: Some((self.function.resolve(arg), false)), times, plus });
                    }
                    arg
                }
                Some(&InstData::Convert { op: ConvertOp::Trunc, arg })
                    if self.function.ty(at) != Type::I1
                        && Interval::full(self.function.ty(at)).contains(self.anywhere(arg)?) =>
                {
                    arg
                }
                _ => break,
            };
            at = self.function.resolve(from);
        }
        Some(Sum { of: Some((at, true)), times, plus })
    }

    /// A parameter gets no further than this.
    fn limit(&mut self, param: Value, limit: Interval) {
        let both = self.limits.get(&param).and_then(|known| known.meet(limit));
        self.limits.insert(param, both.unwrap_or(limit));
    }

    /// The bits above the address that a parameter has in the first pass: an address register keeps its area.
    fn area_of(&self, header: Block, param: Value) -> i64 {
        self.first(header, param).and_then(|first| interval::common_bits(first, ADDRESS_MASK)).unwrap_or(0)
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

    /// By how much the argument of the jump back differs from the parameter.
    fn step_of(&self, way: &mut Way, arg: Value) -> Option<Step> {
        let (param, area) = (way.param, way.area);
        let mut keeps_area = false;
        let mut step = Step::none(Interval::full(self.function.ty(param)));
        let mut at = self.function.resolve(arg);
        while at != param {
            way.budget = way.budget.checked_sub(1)?;
            let ValueDef::Result(inst, _) = self.function.values[at].def else {
                return step.then(self.step_of_param(way, at)?);
            };
            match self.function.insts[inst] {
                InstData::Binary { op: BinaryOp::Iadd, args: [a, b] } => {
                    step.fits = step.fits.meet(Interval::full(self.function.ty(at)))?;
                    let Some(constant) = self.constant(b) else {
                        // One of the two is what the parameter has become, the other one is added.
                        let (from, added) = match self.step_of(way, a) {
                            Some(from) => (from, self.anywhere(b)?),
                            None => (self.step_of(way, b)?, self.anywhere(a)?),
                        };
                        let added = Step { lo: added.lo, hi: added.hi, zeros: added.zeros, fits: step.fits };
                        return step.then(added)?.then(from);
                    };
                    step = step.plus(constant)?;
                    at = self.function.resolve(a);
                }
                InstData::Binary { op: BinaryOp::Isub, args: [a, b] } => {
                    step = step.plus(self.constant(b)?.checked_neg()?)?;
                    step.fits = step.fits.meet(Interval::full(self.function.ty(at)))?;
                    at = self.function.resolve(a);
                }
                InstData::Select { if_true, if_false, .. } => {
                    let either = self.step_of(way, if_true)?.or(self.step_of(way, if_false)?)?;
                    return step.then(either);
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
                    if mask < 0 || mask & (mask + 1) != 0 || step.lo != 0 || step.hi != 0 {
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
        Some(step)
    }

    /// [`Ranges::step_of`] for a parameter of another block of the loop: where ways of a pass meet, or of an inner loop.
    fn step_of_param(&self, way: &mut Way, at: Value) -> Option<Step> {
        let ValueDef::Param(block, index) = self.function.values[at].def else { return None };
        let place = self.cfg.rpo_index(block)?;
        let mut step: Option<Step> = None;
        let mut is_loop = false;
        for &pred in self.cfg.predecessors(block) {
            if self.cfg.rpo_index(pred)? >= place {
                is_loop = true;
                continue;
            }
            let inst = self.function.terminator(pred)?;
            for call in self.function.insts[inst].targets().into_iter().filter(|call| call.block == block) {
                let other = self.step_of(way, call.args[index as usize])?;
                step = Some(match step {
                    Some(step) => step.or(other)?,
                    None => other,
                });
            }
        }
        let step = step?;
        if !is_loop {
            return Some(step);
        }
        // Each pass of the inner loop but the last one adds to it.
        let passes = *self.passes.get(&block)?;
        let mut inner = Way { param: at, area: self.area_of(block, at), budget: way.budget, is_nested: false };
        let mut added: Option<Step> = None;
        for call in self.jumps_back(block)? {
            let other = self.step_of(&mut inner, call.args[index as usize])?;
            added = Some(match added {
                Some(added) => added.or(other)?,
                None => other,
            });
        }
        way.budget = inner.budget;
        way.is_nested = true;
        step.then(added?.times(passes.checked_sub(1)?)?)
    }

    /// What a value can be anywhere.
    fn anywhere(&self, value: Value) -> Option<Interval> {
        let value = self.function.resolve(value);
        match self.function.constant(value) {
            Some(_) => self.get(value),
            None => self.values[value.index()],
        }
    }

    /// How often the loop of a parameter that changes by `step` begins a pass at most; `None`: it may wrap.
    fn passes(&self, param: Value, step: Step) -> Option<i64> {
        let range = self.values[param.index()]?;
        let by = i128::from(step.constant()?);
        let passes = (i128::from(range.hi) - i128::from(range.lo)) / by.abs() + 1;
        i64::try_from(passes).ok().filter(|_| step.keeps(range))
    }

    /// What a parameter of a loop can be in the first pass.
    pub(super) fn first(&self, header: Block, param: Value) -> Option<Interval> {
        let index = self.function.blocks[header].params.iter().position(|&other| other == param)?;
        let place = self.cfg.rpo_index(header);
        let mut first: Option<Interval> = None;
        for &pred in self.cfg.predecessors(header).iter().filter(|&&pred| self.cfg.rpo_index(pred) < place) {
            let inst = self.function.terminator(pred)?;
            for call in self.function.insts[inst].targets().into_iter().filter(|call| call.block == header) {
                let range = self.anywhere(call.args[index])?;
                first = Some(first.map_or(range, |first| first.join(range)));
            }
        }
        first
    }
}

/// So many times a value, plus a constant; of a constant only that.
struct Sum {
    /// The value, and whether its sign counts.
    of: Option<(Value, bool)>,
    times: i64,
    plus: i64,
}

/// The way back from what a jump back brings to the parameter of a loop.
struct Way {
    param: Value,
    /// The bits above the address that the parameter has in the first pass.
    area: i64,
    /// Steps that are left.
    budget: u32,
    /// It leads through an inner loop.
    is_nested: bool,
}

/// How a parameter of a loop changes from pass to pass: by a number from `lo` to `hi`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Step {
    lo: i64,
    hi: i64,
    /// Bits at the low end of the number that are 0.
    zeros: u32,
    /// It is so as long as the parameter is in here before and after: the narrowest type and mask on the way.
    pub(super) fits: Interval,
}

impl Step {
    fn none(fits: Interval) -> Step {
        Step { lo: 0, hi: 0, zeros: 63, fits }
    }

    /// The number by which the parameter changes in each pass, if it is always the same.
    pub(super) fn constant(self) -> Option<i64> {
        (self.lo == self.hi && self.lo != 0).then_some(self.lo)
    }

    /// This step and one by a constant, of which only the sum counts.
    fn plus(self, by: i64) -> Option<Step> {
        let (lo, hi) = (self.lo.checked_add(by)?, self.hi.checked_add(by)?);
        let zeros = if lo == hi { lo.trailing_zeros().min(63) } else { self.zeros.min(by.trailing_zeros()) };
        Some(Step { lo, hi, zeros, ..self })
    }

    /// One after the other; in one direction, so that what is between them is between the ends.
    fn then(self, other: Step) -> Option<Step> {
        if self.lo < 0 && other.hi > 0 || self.hi > 0 && other.lo < 0 {
            return None;
        }
        Some(Step {
            lo: self.lo.checked_add(other.lo)?,
            hi: self.hi.checked_add(other.hi)?,
            zeros: self.zeros.min(other.zeros),
            fits: self.fits.meet(other.fits)?,
        })
    }

    /// One or the other.
    fn or(self, other: Step) -> Option<Step> {
        Some(Step {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
            zeros: self.zeros.min(other.zeros),
            fits: self.fits.meet(other.fits)?,
        })
    }

    /// Up to `count` times.
    fn times(self, count: i64) -> Option<Step> {
        Some(Step { lo: self.lo.min(0).checked_mul(count)?, hi: self.hi.max(0).checked_mul(count)?, ..self })
    }

    /// True if all numbers of `range` stay within bounds with this step.
    fn keeps(self, range: Interval) -> bool {
        let inside = |number: i64| (self.fits.lo..=self.fits.hi).contains(&number);
        let steps = [(range.lo, self.lo), (range.hi, self.hi)];
        steps.into_iter().all(|(end, by)| inside(end) && end.checked_add(by).is_some_and(inside))
    }
}

/// How far a value gets that changes by `step` from pass to pass; `None`: it may wrap.
fn reach(first: Interval, step: Step, passes: i64) -> Option<Interval> {
    let way = step.times(passes.checked_sub(1)?)?;
    let (lo, hi) = (first.lo.checked_add(way.lo)?, first.hi.checked_add(way.hi)?);
    let range = Interval { lo, hi, zeros: first.zeros.min(step.zeros) };
    // After the last pass it is computed once more.
    step.keeps(range).then_some(range)
}
