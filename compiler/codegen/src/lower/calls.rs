//! Calls of functions of the module and of the runtime, and what functions return.

use cranelift_codegen::ir::{ExtFuncData, ExternalName, FuncRef, InstBuilder, Signature, UserExternalName, types};
use plcc_abi::RuntimeFn;
use plcc_ir::entities::Entity;
use plcc_ir::{FuncId, Value};

use super::{Lowering, invalid};
use crate::CodegenError;
use crate::abi::{ReturnPlace, clif_type, runtime_signature, takes_memory};
use crate::keeping;

impl Lowering<'_, '_> {
    fn callee(&mut self, symbol: u32, signature: impl FnOnce() -> Signature, near: bool) -> FuncRef {
        if let Some(&known) = self.callees.get(&symbol) {
            return known;
        }
        let signature = self.b.import_signature(signature());
        let name = self.b.func.declare_imported_user_function(UserExternalName { namespace: 0, index: symbol });
        let name = ExternalName::user(name);
        let callee = self.b.import_function(ExtFuncData { name, signature, colocated: near, patchable: false });
        self.callees.insert(symbol, callee);
        callee
    }

    pub(super) fn call(&mut self, callee: FuncId, args: &[Value], results: &[Value]) -> Result<(), CodegenError> {
        let Some(abi) = self.target.abis.get(callee) else {
            return Err(invalid(format!("{callee} is not in the module")));
        };
        if abi.returns.len() != results.len() {
            return Err(invalid(format!("{callee} does not return {} values", results.len())));
        }
        let mut clif_args = vec![self.memory.mem];
        if abi.frame || abi.caller_frame {
            let frame = self.memory.frame.expect("a function whose callee needs frames has one");
            let callee_frame = self.b.ins().iadd_imm_s(frame, i64::from(self.function.frame_bytes));
            let frames = [abi.frame.then_some(callee_frame), abi.caller_frame.then_some(frame)];
            for frame in frames.into_iter().flatten() {
                clif_args.push(if abi.entry { self.memory.offset_of(&mut self.b, frame) } else { frame });
            }
        }
        clif_args.extend(self.values(args)?);
        if clif_args.len() != abi.signature.params.len() {
            return Err(invalid(format!("{callee} does not take {} values", args.len())));
        }
        let func = self.callee(callee.index() as u32, || abi.signature.clone(), true);
        let inst = self.b.ins().call(func, &clif_args);
        let in_registers = self.b.inst_results(inst).to_vec();
        for (&result, &place) in results.iter().zip(&abi.returns) {
            let value = match place {
                ReturnPlace::Register(index) => in_registers[index],
                ReturnPlace::State(offset) => {
                    self.memory.load_state(&mut self.b, clif_type(self.function.ty(result)), offset)
                }
            };
            self.define(result, value);
        }
        Ok(())
    }

    pub(super) fn call_runtime(
        &mut self,
        function: RuntimeFn,
        args: &[Value],
        results: &[Value],
    ) -> Result<(), CodegenError> {
        if args.len() != function.params().len() || results.len() != usize::from(function.result().is_some()) {
            return Err(invalid(format!("a call of {} does not fit its signature", function.name())));
        }
        let mut clif_args = Vec::with_capacity(args.len() + 1);
        clif_args.extend(takes_memory(function).then_some(self.memory.mem));
        clif_args.extend(self.values(args)?);
        let isa = self.target.isa;
        if let Some(symbol) = self.target.keeping_symbol(function) {
            let func = self.callee(symbol, || keeping::signature(function, isa), true);
            self.b.ins().call(func, &clif_args);
            if let Some(&result) = results.first() {
                let value = self.memory.load_state(&mut self.b, types::I32, keeping::RESULT);
                self.define(result, value);
            }
            return Ok(());
        }
        let symbol = self.target.runtime_symbol(function);
        let func = self.callee(symbol, || runtime_signature(function, isa), self.target.near_runtime);
        let inst = self.b.ins().call(func, &clif_args);
        let values = self.b.inst_results(inst).to_vec();
        for (&result, value) in results.iter().zip(values) {
            self.define(result, value);
        }
        Ok(())
    }

    pub(super) fn return_values(&mut self, values: &[Value]) -> Result<(), CodegenError> {
        if values.len() != self.abi.returns.len() {
            return Err(invalid(format!("{} values are returned", values.len())));
        }
        let mut in_registers = Vec::new();
        for (&value, &place) in values.iter().zip(&self.abi.returns) {
            let value = self.value(value)?;
            match place {
                ReturnPlace::Register(_) => in_registers.push(value),
                ReturnPlace::State(offset) => self.memory.store_state(&mut self.b, value, offset),
            }
        }
        self.b.ins().return_(&in_registers);
        Ok(())
    }
}
