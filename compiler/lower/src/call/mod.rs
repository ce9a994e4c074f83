//! Block calls: registers, parameters, instances. Source: STL reference, block call model.
//!
//! - `function`: each formal of an FC is a reference to its actual, so the FC sees changes during its run and an OUT that it does not write
//!   does not change the actual. Constants and peripheral inputs are put into the caller's frame first.
//! - `instance`: for an FB, elementary and complex values are copied into the instance and back; complex IN_OUT are POINTERs there.
//! - `indices`: variable indices of actual parameters are read where the call begins.
//! - `block_move`: SFC 20, 21 and 81 in place, where the areas are known.
//! - `text`: functions of texts with addresses instead of ANY pointers; `text_operand`: where the texts are; `text_words` and `text_copies`: their
//!   characters, in words.
//! - `system`: system functions get a structure of parameters in the caller's frame.

mod block_move;
mod function;
mod indices;
mod instance;
mod system;
mod text;
mod text_compare;
mod text_copies;
mod text_operand;
mod text_short;
mod text_words;

use plcc_abi::RuntimeFn;
use plcc_abi::codes::{stop, sync};
use plcc_abi::image::BlockKind;
use plcc_abi::layout::{CpuRegister, state};
use plcc_ir::{BinaryOp, FuncId, FunctionBuilder, IntCc, Type, Value};
use plcc_model::{BlockKey, Call, CodeBlock, Passing};

pub use self::block_move::{is_block_move, known_bytes};
pub use self::function::has_area_pointer;
pub use self::text::{TextCall, TextInput, TextResult, is_length, text_call};
pub use self::text_operand::{FormalText, TextOperand};
pub use self::text_short::declared_of;
pub use self::text_words::WORD;
use crate::block::BlockLowering;
use crate::fault::{Check, Substitute};
use crate::plan;

impl BlockLowering<'_, '_> {
    /// `CALL` with its parameters.
    pub fn call(&mut self, call: &Call) {
        let plan = self.plan;
        let Some((callee, function)) = plan.block(call.target) else {
            unreachable!("the binder only passes calls of known blocks");
        };
        let kept = self.with_kept_indices(&call.arguments);
        let arguments = kept.as_deref().unwrap_or(&call.arguments);
        match (function, &call.instance) {
            (Some(function), Some(instance)) => self.call_instance(callee, function, instance, arguments),
            (Some(function), None) => {
                let text = text_call(plan, callee);
                if !text.is_some_and(|text| self.call_known_texts(&text, callee, arguments)) {
                    self.call_fc(callee, function, arguments);
                }
            }
            (None, _) => self.call_system_function(callee, arguments),
        }
        self.bring_back();
        self.after_block();
    }

    /// Calls a block of the program with the current registers, and takes over those that it returns.
    pub fn call_function(&mut self, callee: &CodeBlock, function: FuncId, references: Vec<Value>) {
        let plan = self.plan;
        let mut arguments: Vec<Value> =
            plan.registers.iter().map(|&register| self.b.use_var(self.regs.var(register))).collect();
        arguments.extend(references);
        let depth = self.enter_call(callee);
        let returned = self.b.call(function, arguments, &plan.function_returns(callee));
        self.leave_call(depth);
        let keeps_ar2 = !plan.changes_ar2(callee.key());
        for (register, value) in plan.returned_registers().zip(returned) {
            if !(keeps_ar2 && register == CpuRegister::Ar2) {
                self.set(self.regs.var(register), value);
            }
        }
        self.safepoint();
        // Blocks of the library write what they are given, which is not a pointer of this block.
        if !callee.library {
            self.renew_references();
        }
    }

    /// Counts the block depth and the local data if they are not bounded at compile time. Returns the depth before.
    fn enter_call(&mut self, callee: &CodeBlock) -> Option<Value> {
        if !self.plan.checks_depth {
            return None;
        }
        let depth = self.count_depth();
        let frame = self.b.frame_base(true);
        let end = self.b.binary_imm(BinaryOp::Iadd, frame, i64::from(self.plan.frame_estimate(callee.key())));
        let limit = self.b.load_state(state::L_END);
        let ok = self.b.icmp(IntCc::Ule, end, limit);
        self.stop_unless(ok, stop::LOCAL_DATA);
        Some(depth)
    }

    /// Goes one block deeper, or to STOP. Returns the depth before.
    fn count_depth(&mut self) -> Value {
        let depth = self.b.load_state(state::DEPTH);
        let depth_max = self.b.load_state(state::DEPTH_MAX);
        let ok = self.b.icmp(IntCc::Ult, depth, depth_max);
        self.stop_unless(ok, stop::BLOCK_DEPTH);
        let deeper = self.b.binary_imm(BinaryOp::Iadd, depth, 1);
        self.b.store_state(state::DEPTH, deeper);
        depth
    }

    fn leave_call(&mut self, depth: Option<Value>) {
        if let Some(depth) = depth {
            self.b.store_state(state::DEPTH, depth);
        }
    }

    /// `UC` of an FC or FB: no parameters. An FB has its instance in the current DI, at the current AR2.
    pub fn call_as_it_stands(&mut self, target: BlockKey) {
        let plan = self.plan;
        let Some((callee, Some(function))) = plan.block(target) else {
            unreachable!("the binder only passes calls of known blocks");
        };
        let (db, di) = (self.get(self.regs.db), self.get(self.regs.di));
        let ar2 = self.get(self.regs.ar[1]);
        let check = instance_check(&mut self.b, callee, di, ar2);
        let guard = self.begin_guard(check.into_iter().collect(), Substitute::None);
        let mut references = Vec::new();
        if plan::takes_references(callee) {
            for parameter in &callee.interface.parameters {
                self.no_argument(parameter, &mut references);
            }
            references.extend(plan.pointed(target).iter().map(|_| self.b.i32_const(0)));
        }
        self.call_function(callee, function, references);
        self.set(self.regs.db, db);
        self.set(self.regs.di, di);
        self.end_guard(guard);
    }

    /// Calls the FC or FB whose number is only known at run time. Registers are passed in the CPU state.
    pub fn call_by_number(&mut self, kind: BlockKind, number: Value) {
        let plan = self.plan;
        for &register in &plan.registers {
            let value = self.get(self.regs.var(register));
            let value = self.b.zext(Type::I32, value);
            self.b.store_state(register.slot(), value);
        }
        let depth = self.count_depth();
        let site = self.b.i32_const(self.site);
        self.b.store_state(state::SITE, site);
        let kind = self.b.i32_const(kind as u32);
        let (callee_frame, frame) = (self.b.frame_base(true), self.b.frame_base(false));
        let stop = self
            .b
            .call_runtime(RuntimeFn::CallBlock, &[site, kind, number, callee_frame, frame])
            .expect("call_block has a result");
        self.b.store_state(state::DEPTH, depth);
        self.stop_check(stop);
        for register in plan.returned_registers() {
            let value = self.b.load_state(register.slot());
            let value = self.b.trunc(plan::register_type(register), value);
            self.set(self.regs.var(register), value);
        }
        self.safepoint();
        self.renew_references();
    }
}

/// DB `di` is long enough for the instance of `callee` at `ar2`, which its code relies on; `None` if it has no instance.
pub fn instance_check(b: &mut FunctionBuilder, callee: &CodeBlock, di: Value, ar2: Value) -> Option<Check> {
    if !matches!(callee.kind, BlockKind::Fb | BlockKind::Sfb) || callee.interface.bytes == 0 {
        return None;
    }
    let length = b.db_length(di);
    let bits = b.binary_imm(BinaryOp::And, ar2, 0x00FF_FFFF);
    let byte = b.binary_imm(BinaryOp::Lshr, bits, 3);
    let end = b.binary_imm(BinaryOp::Iadd, byte, i64::from(callee.interface.bytes));
    let long_enough = b.icmp(IntCc::Ule, end, length);
    let bit = b.binary_imm(BinaryOp::And, ar2, 7);
    let aligned = b.icmp_imm(IntCc::Eq, bit, 0);
    let ok = b.and(long_enough, aligned);
    let open = b.icmp_imm(IntCc::Ne, di, 0);
    let (short, none) = (b.i32_const(sync::LENGTH_READ.into()), b.i32_const(sync::DI_NUMBER.into()));
    let code = b.select(open, short, none);
    let info = b.select(open, byte, di);
    let access = b.i32_const(u32::from(plcc_abi::codes::access_area::DI));
    Some(Check { ok, code, access, info, db: None })
}

/// True for parameters that are copied by value; numbers and pointers are only passed in.
fn is_value(passing: Passing) -> bool {
    matches!(passing, Passing::Elementary(_) | Passing::Complex { .. })
}

/// Value of at most four big-endian bytes.
fn big_endian(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0, |value, &byte| value << 8 | u32::from(byte))
}
