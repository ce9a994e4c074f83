//! A module to code in the memory of this process.

use cranelift_jit::{ArenaMemoryProvider, JITBuilder, JITModule};
use cranelift_module::{FuncId as SymbolId, Module as _};
use plcc_abi::RuntimeFn;
use plcc_ir::Module;
use plcc_ir::entities::Entity;

use crate::compile::{CompiledFunction, Compiler};
use crate::isa::Placement;
use crate::{CodegenError, CodegenOptions};

/// An entry function: `mem` is the memory base, `lbase` and `vbase` the offsets of its own and its caller's L frame.
pub type EntryFn = unsafe extern "C" fn(mem: *mut u8, lbase: u32, vbase: u32);

/// Compiled code of a module.
pub struct JitProgram {
    entries: Vec<EntryFn>,
    code_bytes: usize,
    /// Owns the code; `None` only while it is dropped.
    code: Option<JITModule>,
}

impl JitProgram {
    /// Compiles `module`; `resolve` returns the address of a runtime function, which must match its row of the table.
    pub fn compile(
        module: &Module,
        resolve: &dyn Fn(RuntimeFn) -> *const u8,
        options: &CodegenOptions,
    ) -> Result<JitProgram, CodegenError> {
        let compiler = Compiler::new(module, Placement::Memory, options)?;
        let functions = compiler.functions()?;
        let keeping = compiler.keeping_functions()?;
        let code_bytes = functions.iter().map(|function| function.bytes.len()).sum();
        let mut builder = JITBuilder::with_isa(compiler.isa.clone(), cranelift_module::default_libcall_names());
        for &function in RuntimeFn::ALL {
            builder.symbol(function.symbol(), resolve(function));
        }
        builder.symbols(library_functions());
        // One range for all code, so that calls between functions reach.
        let all = functions.iter().chain(keeping.iter().map(|(_, function)| function));
        let room: usize = all.map(|function| function.bytes.len() + 2 * function.alignment as usize).sum();
        const PAGES: usize = 1 << 16;
        let memory = ArenaMemoryProvider::new_with_size(2 * room + PAGES)
            .map_err(|error| CodegenError::Output(format!("no memory for code: {error}")))?;
        builder.memory_provider(Box::new(memory));
        let mut code = JITModule::new(builder);
        let filled = fill(&compiler, &functions, &keeping, &mut code);
        let program = JitProgram { entries: Vec::new(), code_bytes, code: Some(code) };
        filled?;
        Ok(program.with_entries(module))
    }

    fn with_entries(mut self, module: &Module) -> JitProgram {
        let code = self.code.as_ref().expect("the code is there until it is dropped");
        self.entries = module
            .entries
            .iter()
            .map(|id| {
                let address = code.get_finalized_function(SymbolId::from_u32(id.index() as u32));
                // SAFETY: the address is that of a finished function, which was compiled with the signature of an entry.
                unsafe { std::mem::transmute::<*const u8, EntryFn>(address) }
            })
            .collect();
        self
    }

    /// Entry function `index` of the module, which must be one of [`JitProgram::entries`]. It is valid as long as this
    /// value lives. Whoever calls it passes PLC memory as `plcc_abi::layout` describes it.
    pub fn entry(&self, index: u32) -> EntryFn {
        self.entries[index as usize]
    }

    /// How many entry functions there are.
    pub fn entries(&self) -> usize {
        self.entries.len()
    }

    /// Size of the machine code, in bytes.
    pub fn code_bytes(&self) -> usize {
        self.code_bytes
    }
}

impl Drop for JitProgram {
    fn drop(&mut self) {
        if let Some(code) = self.code.take() {
            // SAFETY: the entry functions are valid only as long as this value lives, and are not running while it is dropped.
            unsafe { code.free_memory() };
        }
    }
}

fn fill(
    compiler: &Compiler<'_>,
    functions: &[CompiledFunction],
    keeping: &[(u32, CompiledFunction)],
    code: &mut JITModule,
) -> Result<(), CodegenError> {
    let output = |error: cranelift_module::ModuleError| CodegenError::Output(error.to_string());
    compiler.declare(code)?;
    for (id, function) in compiler.module.functions.keys().zip(functions) {
        let symbol = SymbolId::from_u32(id.index() as u32);
        code.define_function_bytes(symbol, function.alignment, &function.bytes, &function.relocs).map_err(output)?;
    }
    for (number, function) in keeping {
        let symbol = SymbolId::from_u32(*number);
        code.define_function_bytes(symbol, function.alignment, &function.bytes, &function.relocs).map_err(output)?;
    }
    code.finalize_definitions().map_err(output)
}

/// C library functions that generated code calls to clear and copy many bytes.
fn library_functions() -> [(&'static str, *const u8); 2] {
    use std::ffi::{c_int, c_void};
    unsafe extern "C" {
        fn memset(to: *mut c_void, byte: c_int, len: usize) -> *mut c_void;
        fn memmove(to: *mut c_void, from: *const c_void, len: usize) -> *mut c_void;
    }
    [("memset", memset as *const u8), ("memmove", memmove as *const u8)]
}
