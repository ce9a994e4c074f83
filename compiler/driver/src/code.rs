//! Code that runs in this process: machine code in memory, or the IR in its interpreter.

use std::rc::Rc;
use std::sync::{Arc, Mutex};

use plcc_codegen::{CodegenError, JitProgram};
use plcc_ir::interpreter::{Host, Interpreter};
use plcc_ir::{FuncId, RuntimeFn};
use plcc_runtime::change::CodeSource;
use plcc_runtime::code::EntryFunction;
use plcc_runtime::{Code, functions, guest};

use crate::pipeline::Compiled;

/// Machine code in memory.
pub fn jit(compiled: &Compiled) -> Result<Rc<dyn Code>, CodegenError> {
    let (entries, program) = machine_code(compiled)?;
    Ok(Rc::new(guest::NativeCode::new(entries, program)))
}

/// Machine code in memory: its entry functions, and what keeps it there.
pub fn machine_code(compiled: &Compiled) -> Result<(Vec<EntryFunction>, JitProgram), CodegenError> {
    let program = JitProgram::compile(&compiled.module, &functions::address, &compiled.codegen_options())?;
    let entries = (0..program.entries() as u32).map(|index| program.entry(index)).collect();
    Ok((entries, program))
}

/// Makes code of a program as often as asked, for any number of CPUs one after the other.
pub fn source(compiled: &Compiled) -> Result<CodeSource, CodegenError> {
    let (entries, program) = machine_code(compiled)?;
    let owner = Arc::new(Mutex::new(program));
    Ok(Arc::new(move || Rc::new(guest::NativeCode::new(entries.clone(), Arc::clone(&owner)))))
}

/// The IR in its interpreter.
pub fn interpreter(compiled: &Compiled) -> Rc<Interpreted> {
    Rc::new(Interpreted { interpreter: Interpreter::new(&compiled.module), entries: compiled.module.entries.clone() })
}

/// A module in the interpreter, with the memory and the functions of the runtime.
pub struct Interpreted {
    interpreter: Interpreter,
    entries: Vec<FuncId>,
}

impl Interpreted {
    /// Instructions that have run so far.
    pub fn executed(&self) -> u64 {
        self.interpreter.executed()
    }
}

impl Code for Interpreted {
    fn call(&self, entry: u32, mem: *mut u8, lbase: u32, vbase: u32) {
        self.interpreter.call(&Guest(mem), self.entries[entry as usize], &[], lbase, vbase);
    }
}

/// PLC memory and the runtime as the interpreter reaches them.
struct Guest(*mut u8);

impl Host for Guest {
    fn read(&self, offset: u32, buf: &mut [u8]) {
        guest::read(self.0, offset, buf);
    }

    fn write(&self, offset: u32, bytes: &[u8]) {
        guest::write(self.0, offset, bytes);
    }

    fn call_runtime(&self, function: RuntimeFn, args: &[u64]) -> u64 {
        functions::call(function, self.0, args)
    }
}
