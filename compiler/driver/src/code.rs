//! Code that runs in this process: machine code in memory, or the IR in its interpreter.

use std::cell::Cell;
use std::rc::Rc;
use std::sync::{Arc, Mutex};

use plcc_codegen::{CodegenError, JitProgram};
use plcc_ir::interpreter::{Host, Interpreter};
use plcc_ir::{FuncId, RuntimeFn};
use plcc_runtime::change::CodeSource;
use plcc_runtime::code::{Entries, EntryFunction};
use plcc_runtime::{Code, functions, guest};

use crate::pipeline::Compiled;

/// Machine code in memory.
pub fn jit(compiled: &Compiled) -> Result<Rc<dyn Code>, CodegenError> {
    let (entries, program) = machine_code(compiled)?;
    Ok(Rc::new(guest::NativeCode::new(Entries::new(entries), program)))
}

/// Machine code in memory that changes to the code with probes while someone watches.
pub fn jit_watched(plain: &Compiled, probed: &Compiled) -> Result<Rc<dyn Code>, CodegenError> {
    let ((entries, program), (others, other)) = (machine_code(plain)?, machine_code(probed)?);
    Ok(Rc::new(guest::NativeCode::new(Entries::watched(entries, others), (program, other))))
}

/// Machine code in memory: its entry functions, and what keeps it there.
pub fn machine_code(compiled: &Compiled) -> Result<(Vec<EntryFunction>, JitProgram), CodegenError> {
    let program = JitProgram::compile(&compiled.module, &functions::address, &compiled.codegen_options())?;
    let entries = (0..program.entries() as u32).map(|index| program.entry(index)).collect();
    Ok((entries, program))
}

/// Makes code of a program as often as asked, for any number of CPUs. `probed`: the same program with probes, if someone may watch.
pub fn source(plain: &Compiled, probed: Option<&Compiled>) -> Result<CodeSource, CodegenError> {
    let (entries, program) = machine_code(plain)?;
    let (others, other) = probed.map(machine_code).transpose()?.unzip();
    let others = others.unwrap_or_default();
    // It keeps the code where it is until all CPUs have ended.
    let owner = Arc::new(Mutex::new((program, other)));
    Ok(Arc::new(move || {
        Rc::new(guest::NativeCode::new(Entries::watched(entries.clone(), others.clone()), Arc::clone(&owner)))
    }))
}

/// The IR in its interpreter.
pub fn interpreter(compiled: &Compiled) -> Rc<Interpreted> {
    Rc::new(Interpreted { interpreter: Interpreter::new(&compiled.module), entries: compiled.module.entries.clone() })
}

/// The IR in its interpreter, which changes to the code with probes while someone watches.
pub fn interpreter_watched(plain: &Compiled, probed: &Compiled) -> Rc<dyn Code> {
    Rc::new(InterpretedTwice { codes: [interpreter(plain), interpreter(probed)], is_watched: Cell::new(false) })
}

/// A program and the same with probes.
struct InterpretedTwice {
    codes: [Rc<Interpreted>; 2],
    is_watched: Cell<bool>,
}

impl Code for InterpretedTwice {
    fn call(&self, entry: u32, mem: *mut u8, lbase: u32, vbase: u32) {
        self.codes[usize::from(self.is_watched.get())].call(entry, mem, lbase, vbase);
    }

    fn watch(&self, is_watched: bool) {
        self.is_watched.set(is_watched);
    }
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
