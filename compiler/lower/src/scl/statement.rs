//! Statements. Source: SCL reference, statements.

use std::collections::BTreeMap;

use plcc_diag::Span;
use plcc_ir::{BinaryOp, Block, IntCc, Type, Value};
use plcc_model::scl::{Access, Arm, Base, Complex, Expr, Statement, StatementKind};
use plcc_model::types::Elementary;

use super::Loop;
use crate::block::BlockLowering;
use crate::fault::Substitute;
use crate::place::Direction;

/// Number of CASE values from which a table may pay off.
const TABLE_MIN: usize = 4;
/// Limit of the distance between the lowest and the highest value of a table, per value.
const TABLE_SPREAD: i128 = 8;
/// Largest table.
const TABLE_MAX: i128 = 4096;
/// A range counts as at most so many values: two comparisons find it, however long it is.
const RANGE_COUNTED: i128 = 16;

/// A range of values, and the arm that it belongs to.
type Range = (i128, i128, usize);

impl BlockLowering<'_, '_> {
    pub fn statements(&mut self, statements: &[Statement]) {
        for statement in statements {
            self.reachable();
            self.place_statement(statement.span);
            self.step_before(statement);
            self.statement(statement);
        }
    }

    fn statement(&mut self, statement: &Statement) {
        match &statement.kind {
            StatementKind::Assign { target, value } => self.assign_value(target, value),
            StatementKind::AssignText { target, value } => self.assign_text(target, value),
            StatementKind::Copy { target, source, bytes } => self.copy_complex(target, source, *bytes),
            StatementKind::SetFlag(value) => {
                let value = self.value(value);
                let flag = self.flag();
                self.b.def_var(flag, value);
            }
            StatementKind::Watch(on) => self.scl.sets_flag = *on || self.scl.block_sets_flag,
            StatementKind::Failed => {
                if self.wants_flag() {
                    let flag = self.flag();
                    let failed = self.zero(Elementary::Bool);
                    self.b.def_var(flag, failed);
                }
            }
            StatementKind::Call(call) => {
                self.scl_call(call);
            }
            StatementKind::Evaluate(value) => {
                self.value(value);
            }
            StatementKind::If { branches, otherwise } => self.if_statement(statement.span, branches, otherwise),
            StatementKind::Case { selector, arms, otherwise } => self.case_statement(selector, arms, otherwise),
            StatementKind::For { variable, start, end, step, body } => {
                self.for_statement(variable, start, end, step, body);
            }
            StatementKind::While { condition, body } => self.while_statement(condition, body),
            StatementKind::Repeat { body, until } => self.repeat_statement(body, until),
            StatementKind::Exit => {
                let exit = self.innermost_loop().exit;
                self.b.jump(exit, &[]);
            }
            StatementKind::Continue => {
                let next = self.innermost_loop().next;
                self.b.jump(next, &[]);
            }
            StatementKind::Return(value) => {
                if let Some(value) = value {
                    let value = self.value(value);
                    let flag = self.flag();
                    self.b.def_var(flag, value);
                }
                self.leave_block();
            }
            StatementKind::Goto(label) => {
                let edge = self.label_target(*label);
                self.b.jump(edge.block, &[]);
                self.jump_done(edge);
            }
            StatementKind::Label(label) => self.place_label(*label),
            StatementKind::Assert(assert) => self.assert(assert, statement.span),
            StatementKind::Sleep(ms) => self.sleep(*ms),
            StatementKind::Apart => self.begin_part(),
            StatementKind::Stl(statement) => self.stl_statement(statement),
        }
    }

    fn innermost_loop(&self) -> Loop {
        *self.scl.loops.last().expect("the binder only passes EXIT and CONTINUE in loops")
    }

    /// Indices of the target, then the value, then the store.
    fn assign_value(&mut self, target: &Access, value: &Expr) {
        if target.indices.is_empty() && !matches!(target.base, Base::Indexed { .. }) {
            let value = self.value(value);
            self.write_access(target, value);
            return;
        }
        let located = self.locate(target);
        let value = self.value(value);
        self.write_located(target, &located, value);
    }

    fn copy_complex(&mut self, target: &Access, source: &Complex, bytes: u32) {
        let to = self.locate(target);
        match source {
            Complex::Const(constant) => {
                let (addr, checks) = self.located_address(&to, Direction::Write);
                let guard = self.begin_guard(checks, Substitute::None);
                self.store_bytes(addr, constant);
                self.end_guard(guard);
            }
            Complex::Variable(_) | Complex::Call(_) => {
                let (from, mut checks) = match source {
                    Complex::Variable(from) => {
                        let from = self.locate(from);
                        self.located_address(&from, Direction::Read)
                    }
                    _ => (self.complex_result(source), Vec::new()),
                };
                let (to, more) = self.located_address(&to, Direction::Write);
                checks.extend(more);
                let guard = self.begin_guard(checks, Substitute::None);
                self.b.copy(to, from, bytes);
                self.end_guard(guard);
            }
            Complex::Character(_) => unreachable!("the binder only makes texts of characters"),
        }
    }

    /// Lowers a body that ends at `end`.
    fn body(&mut self, block: Block, statements: &[Statement], end: Block) {
        self.b.seal_block(block);
        self.b.switch_to(block);
        self.statements(statements);
        if self.b.is_reachable() {
            self.b.jump(end, &[]);
        }
    }

    /// Code built from now on belongs to the position `span`.
    fn place_statement(&mut self, span: Span) {
        let network = match &self.block.body {
            plcc_model::Body::Scl(body) => body.network_at(span.start),
            plcc_model::Body::Stl(_) | plcc_model::Body::S7200(_) | plcc_model::Body::Runtime => 0,
        };
        self.set_place(span, network);
    }

    fn if_statement(&mut self, span: Span, branches: &[(Expr, Vec<Statement>)], otherwise: &[Statement]) {
        let end = self.b.create_block();
        for (number, (condition, body)) in branches.iter().enumerate() {
            self.place_statement(condition.span);
            if number > 0 {
                self.step_between(condition.span);
            }
            let holds = self.value(condition);
            self.count_condition(condition, (branches.len() == 1 && self.scl.conditions == 0).then_some(span), holds);
            self.scl.conditions += 1;
            let (then, other) = (self.b.create_block(), self.b.create_block());
            self.b.branch(holds, then, other);
            self.body(then, body, end);
            self.scl.conditions -= 1;
            self.b.seal_block(other);
            self.b.switch_to(other);
        }
        self.statements(otherwise);
        if self.b.is_reachable() {
            self.b.jump(end, &[]);
        }
        self.b.seal_block(end);
        self.b.switch_to(end);
    }

    fn case_statement(&mut self, selector: &Expr, arms: &[Arm], otherwise: &[Statement]) {
        let value = self.value(selector);
        let ranges = disjoint(arms);
        let end = self.b.create_block();
        let default = self.b.create_block();
        let blocks: Vec<Block> = arms.iter().map(|_| self.b.create_block()).collect();
        if !self.case_table(value, selector.ty, &ranges, &blocks, default) {
            self.case_search(value, selector.ty, &ranges, &blocks, default);
        }
        for (arm, &block) in arms.iter().zip(&blocks) {
            self.body(block, &arm.body, end);
        }
        self.body(default, otherwise, end);
        self.b.seal_block(end);
        self.b.switch_to(end);
    }

    /// A jump table, if the values are close together.
    fn case_table(&mut self, value: Value, ty: Elementary, ranges: &[Range], blocks: &[Block], default: Block) -> bool {
        let (Some(first), Some(last)) = (ranges.first(), ranges.last()) else { return false };
        let count: i128 = ranges.iter().map(|(low, high, _)| (high - low + 1).min(RANGE_COUNTED)).sum();
        let spread = last.1 - first.0 + 1;
        if ranges.len() < TABLE_MIN || spread > TABLE_MAX || spread > TABLE_SPREAD * count {
            return false;
        }
        let wide = if ty.bits() == 64 { value } else { self.as_i32(value, ty) };
        let from_low = self.b.binary_imm(BinaryOp::Isub, wide, first.0 as i64);
        let number = if ty.bits() == 64 {
            // A value beyond the table must not get back into it when truncated to 32 bits.
            let inside = self.b.icmp_imm(IntCc::Ult, from_low, spread as i64);
            let low = self.b.trunc(Type::I32, from_low);
            let outside = self.b.i32_const(u32::MAX);
            self.b.select(inside, low, outside)
        } else {
            from_low
        };
        let mut targets = vec![default; spread as usize];
        for &(low, high, arm) in ranges {
            targets[(low - first.0) as usize..=(high - first.0) as usize].fill(blocks[arm]);
        }
        self.b.switch(number, &targets, default);
        true
    }

    /// A binary search over the ranges.
    fn case_search(&mut self, value: Value, ty: Elementary, ranges: &[Range], blocks: &[Block], default: Block) {
        match ranges {
            [] => self.b.jump(default, &[]),
            [(low, high, arm)] => {
                let inside = if low == high {
                    self.b.icmp_imm(IntCc::Eq, value, *low as i64)
                } else {
                    let (ge, le) = if ty.is_signed() { (IntCc::Sge, IntCc::Sle) } else { (IntCc::Uge, IntCc::Ule) };
                    let above = self.b.icmp_imm(ge, value, *low as i64);
                    let below = self.b.icmp_imm(le, value, *high as i64);
                    self.b.and(above, below)
                };
                self.b.branch(inside, blocks[*arm], default);
            }
            _ => {
                let (low, high) = ranges.split_at(ranges.len() / 2);
                let less = if ty.is_signed() { IntCc::Slt } else { IntCc::Ult };
                let is_low = self.b.icmp_imm(less, value, high[0].0 as i64);
                let (below, above) = (self.b.create_block(), self.b.create_block());
                self.b.branch(is_low, below, above);
                for (block, part) in [(below, low), (above, high)] {
                    self.b.seal_block(block);
                    self.b.switch_to(block);
                    self.case_search(value, ty, part, blocks, default);
                }
            }
        }
    }

    fn for_statement(&mut self, variable: &Access, start: &Expr, end: &Expr, step: &Expr, body: &[Statement]) {
        let ty = start.ty;
        let computed = !variable.indices.is_empty() || matches!(variable.base, Base::Indexed { .. });
        let located = computed.then(|| self.locate(variable));
        let start = self.value(start);
        let write = |lowering: &mut Self, value| match &located {
            Some(located) => lowering.write_located(variable, located, value),
            None => lowering.write_access(variable, value),
        };
        // End and step may read the variable: it has its first value by then.
        write(self, start);
        let end = self.value(end);
        let step_value = self.value(step);
        let (head, run, next, exit) =
            (self.b.create_block(), self.b.create_block(), self.b.create_block(), self.b.create_block());
        self.b.jump(head, &[]);
        self.b.switch_to(head);
        let now = match &located {
            Some(located) => self.read_located(variable, located),
            None => self.read_access(variable),
        };
        let (less_equal, greater_equal) =
            if ty.is_signed() { (IntCc::Sle, IntCc::Sge) } else { (IntCc::Ule, IntCc::Uge) };
        let up = self.b.icmp(less_equal, now, end);
        let goes_on = if ty.is_signed() {
            let down = self.b.icmp(greater_equal, now, end);
            let upward = self.b.icmp_imm(IntCc::Sge, step_value, 0);
            self.b.select(upward, up, down)
        } else {
            up
        };
        self.b.branch(goes_on, run, exit);
        self.scl.loops.push(Loop { exit, next });
        self.body(run, body, next);
        self.scl.loops.pop();
        self.b.seal_block(next);
        self.b.switch_to(next);
        self.step_between(variable.span);
        let now = match &located {
            Some(located) => self.read_located(variable, located),
            None => self.read_access(variable),
        };
        let following = self.b.iadd(now, step_value);
        write(self, following);
        self.safepoint();
        self.b.jump(head, &[]);
        self.b.seal_block(head);
        self.b.seal_block(exit);
        self.b.switch_to(exit);
    }

    fn while_statement(&mut self, condition: &Expr, body: &[Statement]) {
        let (head, run, next, exit) =
            (self.b.create_block(), self.b.create_block(), self.b.create_block(), self.b.create_block());
        self.b.jump(head, &[]);
        self.b.switch_to(head);
        let goes_on = self.value(condition);
        self.count_condition(condition, None, goes_on);
        self.b.branch(goes_on, run, exit);
        self.scl.loops.push(Loop { exit, next });
        self.body(run, body, next);
        self.scl.loops.pop();
        self.b.seal_block(next);
        self.b.switch_to(next);
        self.step_between(condition.span);
        self.safepoint();
        self.b.jump(head, &[]);
        self.b.seal_block(head);
        self.b.seal_block(exit);
        self.b.switch_to(exit);
    }

    fn repeat_statement(&mut self, body: &[Statement], until: &Expr) {
        let (run, next, again, exit) =
            (self.b.create_block(), self.b.create_block(), self.b.create_block(), self.b.create_block());
        self.b.jump(run, &[]);
        self.b.switch_to(run);
        self.scl.loops.push(Loop { exit, next });
        self.statements(body);
        if self.b.is_reachable() {
            self.b.jump(next, &[]);
        }
        self.scl.loops.pop();
        self.b.seal_block(next);
        self.b.switch_to(next);
        self.place_statement(until.span);
        self.step_between(until.span);
        let done = self.value(until);
        self.count_condition(until, None, done);
        self.b.branch(done, exit, again);
        self.b.seal_block(again);
        self.b.switch_to(again);
        self.safepoint();
        self.b.jump(run, &[]);
        self.b.seal_block(run);
        self.b.seal_block(exit);
        self.b.switch_to(exit);
    }
}

/// The ranges of all arms in order of value, without overlaps: a value belongs to the first arm that names it.
fn disjoint(arms: &[Arm]) -> Vec<Range> {
    // Sorted by their low ends.
    let mut taken: BTreeMap<i128, (i128, usize)> = BTreeMap::new();
    for (arm, content) in arms.iter().enumerate() {
        for &(low, high) in content.ranges.iter().filter(|(low, high)| low <= high) {
            // The range before may reach into this one.
            let first = taken.range(..=low).next_back().map_or(low, |(from, _)| *from);
            let mut free = low;
            let mut added = Vec::new();
            for (&from, &(to, _)) in taken.range(first..=high) {
                if to < free {
                    continue;
                }
                if from > free {
                    added.push((free, from - 1));
                }
                free = to + 1;
            }
            if free <= high {
                added.push((free, high));
            }
            taken.extend(added.into_iter().map(|(from, to)| (from, (to, arm))));
        }
    }
    taken.into_iter().map(|(low, (high, arm))| (low, high, arm)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arms(ranges: &[&[(i128, i128)]]) -> Vec<Arm> {
        ranges.iter().map(|ranges| Arm { ranges: ranges.to_vec(), body: Vec::new() }).collect()
    }

    #[test]
    fn the_first_arm_wins() {
        let ranges = disjoint(&arms(&[&[(1, 1)], &[(2, 2), (5, 7)], &[(7, 7), (0, 9)]]));
        assert_eq!(
            ranges,
            [(0, 0, 2), (1, 1, 0), (2, 2, 1), (3, 4, 2), (5, 7, 1), (8, 9, 2)],
            "7 belongs to the second arm, what is left of 0..9 to the third"
        );
    }

    #[test]
    fn empty_ranges_hold_nothing() {
        assert_eq!(disjoint(&arms(&[&[(5, 3)], &[(4, 4)]])), [(4, 4, 1)]);
    }
}
