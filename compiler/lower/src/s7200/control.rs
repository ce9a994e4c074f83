//! Jumps, loops, calls, ends. Source: S7-200 system manual, program control instructions.

use plcc_abi::s7200::{Operation, error, fatal, system};
use plcc_ir::{Address, IntCc, Region, Type, Value};
use plcc_model::s7200::{Direction, Operand, Width};

use super::block::{Loop, S7200Lowering};
use super::operand::Place;
use super::plan;

/// Limit of nested calls. Source: S7-200 system manual, subroutines.
const NESTING_MAX: i64 = 8;

impl<'p> S7200Lowering<'p, '_> {
    /// `JMP`: a backward jump passes a safepoint on its way.
    pub fn jump(&mut self, operands: &[Operand]) {
        let Some(Operand::Const(number)) = operands.first() else { return };
        let Some(label) = self.labels.get(*number) else { return };
        let enable = self.top();
        self.count_contact(enable);
        let (taken, next) = (self.b.create_block(), self.b.create_block());
        self.b.branch(enable, taken, next);
        self.b.seal_block(taken);
        self.b.seal_block(next);
        self.b.switch_to(taken);
        if label.placed {
            self.safepoint();
        }
        self.b.jump(label.block, &[]);
        self.labels.jump_done(&mut self.b, *number);
        self.b.switch_to(next);
    }

    /// `LBL`.
    pub fn label(&mut self, operands: &[Operand]) {
        if let Some(Operand::Const(number)) = operands.first() {
            self.labels.place(&mut self.b, *number);
        }
    }

    /// `FOR INDX, INIT, FINAL`: with S0 = 0, or nothing to do, it continues after its NEXT. It has ENO like a box.
    pub fn begin_loop(&mut self, operands: &[Operand]) {
        // The operands are needed for the whole body; NEXT reads them again.
        let body = self.body;
        let own = body.statements.get(self.index).and_then(|statement| match &statement.kind {
            plcc_model::s7200::StatementKind::Instruction { operands, .. } => Some(operands.as_slice()),
            _ => None,
        });
        let ([index, initial, last], Some(own)) = (operands, own) else { return };
        let (start, body, after) = (self.b.create_block(), self.b.create_block(), self.b.create_block());
        let enable = self.top();
        let failed = self.b.bool_const(false);
        self.set(self.eno, failed);
        self.b.branch(enable, start, after);
        self.b.seal_block(start);
        self.b.switch_to(start);
        self.guarded_to(after, |lowering| {
            let initial = lowering.read(initial, Width::Word);
            let last = lowering.read(last, Width::Word);
            let target = lowering.target(index, Width::Word);
            lowering.store(target, Width::Word, initial);
            let one = lowering.b.bool_const(true);
            lowering.set(lowering.eno, one);
            let runs = lowering.b.icmp(IntCc::Sle, initial, last);
            lowering.b.branch(runs, body, after);
        });
        self.b.switch_to(body);
        self.loops.push(Loop { operands: own, body, after });
    }

    /// `NEXT`: counts, then compares, so the index is one more than the last value at the end. At 32767 it stays.
    pub fn end_loop(&mut self) {
        let Some(Loop { operands, body, after }) = self.loops.pop() else { return };
        let [index, _, last] = operands else { return };
        let one = self.b.bool_const(true);
        self.set_top(one);
        self.safepoint();
        self.guarded_to(after, |lowering| {
            let target = lowering.target(index, Width::Word);
            let value = lowering.load(target, Width::Word);
            let last = lowering.read(last, Width::Word);
            let more = lowering.b.icmp_imm(IntCc::Ne, value, i64::from(i16::MAX));
            let step = lowering.b.zext(Type::I16, more);
            let next = lowering.b.iadd(value, step);
            lowering.store(target, Width::Word, next);
            let within = lowering.b.icmp(IntCc::Sle, next, last);
            let again = lowering.b.and(within, more);
            lowering.b.branch(again, body, after);
        });
        self.b.seal_block(body);
        self.b.seal_block(after);
        self.b.switch_to(after);
    }

    /// `END`, `CRET`, `CRETI`.
    pub fn end_if_enabled(&mut self) {
        let enable = self.top();
        self.count_contact(enable);
        let (end, next) = (self.b.create_block(), self.b.create_block());
        self.b.branch(enable, end, next);
        self.b.seal_block(end);
        self.b.seal_block(next);
        self.b.switch_to(end);
        self.leave();
        self.b.switch_to(next);
    }

    /// `STOP`.
    pub fn stop(&mut self) {
        self.conditional(|lowering| {
            let result = lowering.run_raw(Operation::StopMode, &[]);
            lowering.stop_if_told(result);
        });
    }

    /// `CALL`: IN and IN_OUT are copied in, IN_OUT and OUT back. With S0 = 0, nothing is copied.
    pub fn call(&mut self, number: u16, arguments: &[Operand]) {
        let Some((function, callee)) = self.plan.subroutine(number) else { return };
        self.boxed(|lowering| {
            let mut given = Vec::new();
            let mut targets: Vec<(Place, Width)> = Vec::new();
            for (parameter, argument) in callee.parameters.iter().zip(arguments) {
                match parameter.direction {
                    Direction::In => given.push(lowering.read(argument, parameter.width)),
                    Direction::InOut => {
                        let place = lowering.target(argument, parameter.width);
                        given.push(lowering.load(place, parameter.width));
                        targets.push((place, parameter.width));
                    }
                    Direction::Out => targets.push((lowering.target(argument, parameter.width), parameter.width)),
                }
            }
            let depth = lowering.enter_call();
            let results = lowering.b.call(function, given, &plan::returns(callee));
            if let Some(depth) = depth {
                lowering.b.store(DEPTH, depth);
            }
            lowering.safepoint();
            for ((place, width), value) in targets.into_iter().zip(results) {
                lowering.store(place, width, value);
            }
        });
    }

    /// Counts a call, if the compiler cannot bound the depth; returns the depth before. Too deep: error 0008, no call.
    fn enter_call(&mut self) -> Option<Value> {
        if !self.plan.counts_calls {
            return None;
        }
        let depth = self.b.load(Type::I32, DEPTH);
        let ok = self.b.icmp_imm(IntCc::Ult, depth, NESTING_MAX);
        self.error_unless(ok, error::NESTING, fatal::INTERNAL);
        let one = self.b.i32_const(1);
        let deeper = self.b.iadd(depth, one);
        self.b.store(DEPTH, deeper);
        Some(depth)
    }
}

const DEPTH: Address = Address::direct(Region::System, system::CALL_DEPTH);
