//! All functions of a module to bytes.
//!
//! Functions do not depend on each other once their calling conventions are known, so threads share them out, the
//! largest first. The result is in the order of the module, whatever thread was first.

use std::borrow::Borrow;
use std::sync::{Mutex, PoisonError};

use cranelift_codegen::control::ControlPlane;
use cranelift_codegen::isa::{OwnedTargetIsa, TargetIsa};
use cranelift_codegen::{Context, ir};
use cranelift_frontend::FunctionBuilderContext;
use cranelift_module::{Module as CraneliftModule, ModuleReloc};
use plcc_abi::RuntimeFn;
use plcc_ir::entities::{Entity, EntityVec};
use plcc_ir::{FuncId, Function, Module};

use crate::abi::{self, FunctionAbi};
use crate::facts::{Facts, facts};
use crate::isa::{Placement, Tuning, isa};
use crate::lower::{self, Target};
use crate::{CodegenError, CodegenOptions, keeping, rounding, work};

/// Functions for which register allocation is more work than this get the quick kind. Its code is 15 to 20 % slower for statement lists and takes
/// twice the time for SCL with many local variables (docs/benchmarks.md); the better kind takes up to two seconds for this much, and time
/// grows faster than the function.
const ALLOCATION_WORK_MAX: usize = 100_000;

/// Functions with more jumps back than this are not optimised by Cranelift: it walks the loops around each value, and labels that are jumped
/// back to from everywhere nest them by the hundred.
const JUMPS_BACK_MAX: usize = 200;

/// Functions with more blocks than this are not optimised by Cranelift, which looks for a value in all blocks that dominate it.
const BLOCKS_MAX: usize = 50_000;

/// Stack of a compiling thread, only touched as far as needed.
const STACK_BYTES: usize = 64 << 20;

/// Machine code of one function.
pub struct CompiledFunction {
    pub bytes: Vec<u8>,
    pub relocs: Vec<ModuleReloc>,
    pub alignment: u64,
    /// Ascending.
    pub places: Vec<Place>,
    /// Where Cranelift's blocks begin; ascending.
    pub blocks: Vec<u32>,
}

/// From an offset on, code belongs to a place of the source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    pub at: u32,
    /// As a [`Loc`](plcc_ir::Loc); 0: none.
    pub site: u32,
    /// On a cold side.
    pub cold: bool,
}

/// Marks the places of cold blocks, so that code can be told apart later.
const COLD: u32 = 1 << 31;

/// The place of an instruction as Cranelift carries it.
pub fn source_location(loc: plcc_ir::Loc, cold: bool) -> ir::SourceLoc {
    match (loc.0, cold) {
        (0, false) => ir::SourceLoc::default(),
        (loc, true) => ir::SourceLoc::new(loc | COLD),
        (loc, false) => ir::SourceLoc::new(loc),
    }
}

/// A module with the data for compiling its functions.
pub struct Compiler<'m> {
    pub module: &'m Module,
    pub abis: EntityVec<FuncId, FunctionAbi>,
    /// Runtime functions that are called so that they keep all registers.
    pub keeping: Vec<RuntimeFn>,
    pub isa: OwnedTargetIsa,
    quick_isa: OwnedTargetIsa,
    plain_isa: OwnedTargetIsa,
    plain_quick_isa: OwnedTargetIsa,
    placement: Placement,
}

impl<'m> Compiler<'m> {
    pub fn new(
        module: &'m Module,
        placement: Placement,
        options: &CodegenOptions,
    ) -> Result<Compiler<'m>, CodegenError> {
        let facts: Vec<Facts> = module.functions.values().map(facts).collect();
        Compiler::with_facts(module, &facts, placement, options)
    }

    /// As [`Compiler::new`], if what the functions tell about themselves is known already.
    pub fn with_facts(
        module: &'m Module,
        facts: &[Facts],
        placement: Placement,
        options: &CodegenOptions,
    ) -> Result<Compiler<'m>, CodegenError> {
        let target = |plain, quick| isa(placement, options, Tuning { plain, quick });
        let isa = target(false, false)?;
        let abis = abi::module_abi(module, facts, &*isa)?;
        let (quick_isa, plain_isa, plain_quick_isa) = (target(false, true)?, target(true, false)?, target(true, true)?);
        let keeping = keeping::of_bits(facts.iter().fold(0, |bits, facts| bits | facts.keeping));
        Ok(Compiler { module, abis, keeping, isa, quick_isa, plain_isa, plain_quick_isa, placement })
    }

    /// Declares the functions of the module and the runtime in `output`, with the numbers that lowering uses.
    pub fn declare(&self, output: &mut dyn CraneliftModule) -> Result<(), CodegenError> {
        use cranelift_module::Linkage;
        for (id, function) in self.module.functions.iter() {
            let name = symbol(&function.name);
            let declared = output
                .declare_function(&name, Linkage::Local, &self.abis[id].signature)
                .map_err(|error| CodegenError::Output(error.to_string()))?;
            if declared.as_u32() != id.index() as u32 {
                let message = "another function has the same name".to_string();
                return Err(CodegenError::Module { function: function.name.clone(), message });
            }
        }
        for &function in RuntimeFn::ALL {
            let signature = abi::runtime_signature(function, &*self.isa);
            let declared = output
                .declare_function(function.symbol(), Linkage::Import, &signature)
                .map_err(|error| CodegenError::Output(error.to_string()))?;
            debug_assert_eq!(declared.as_u32(), self.target(&*self.isa).runtime_symbol(function));
        }
        for &function in &self.keeping {
            let signature = keeping::signature(function, &*self.isa);
            let declared = output
                .declare_function(&keeping::symbol(function), Linkage::Local, &signature)
                .map_err(|error| CodegenError::Output(error.to_string()))?;
            debug_assert_eq!(Some(declared.as_u32()), self.target(&*self.isa).keeping_symbol(function));
        }
        Ok(())
    }

    fn target<'a>(&'a self, isa: &'a dyn TargetIsa) -> Target<'a> {
        Target {
            module: self.module,
            abis: &self.abis,
            isa,
            near_runtime: self.placement == Placement::Object,
            native_rounding: rounding::is_native(isa),
            keeping: &self.keeping,
        }
    }

    /// The CLIF of function `id`.
    pub fn clif(&self, id: FuncId) -> Result<ir::Function, CodegenError> {
        let mut function = ir::Function::new();
        let source = &self.module.functions[id];
        lower::lower(&self.target(&*self.isa), id, source, &mut FunctionBuilderContext::new(), &mut function)?;
        // As text, cold blocks are marked once, at their heads.
        let insts: Vec<ir::Inst> =
            function.layout.blocks().flat_map(|block| function.layout.block_insts(block)).collect();
        for inst in insts {
            let location = function.srcloc(inst);
            if !location.is_default() && location.bits() & COLD != 0 {
                function.set_srcloc(inst, source_location(plcc_ir::Loc(location.bits() & !COLD), false));
            }
        }
        Ok(function)
    }

    /// The functions that call the runtime and keep all registers, with their numbers.
    pub fn keeping_functions(&self) -> Result<Vec<(u32, CompiledFunction)>, CodegenError> {
        let mut worker = Worker { compiler: self, context: Context::new(), builder: Default::default() };
        let target = self.target(&*self.isa);
        let numbered = self.keeping.iter().filter_map(|&function| Some((target.keeping_symbol(function)?, function)));
        numbered.map(|(number, function)| Ok((number, worker.keeping(function, number)?))).collect()
    }

    /// All functions, in the order of the module.
    pub fn functions(&self) -> Result<Vec<CompiledFunction>, CodegenError> {
        let functions = self.some_functions(self.module.functions.iter().collect())?;
        Ok(functions.into_iter().map(|(_, function)| function).collect())
    }

    /// These functions, in the order of the module. Functions that are given away, not lent, are dropped as soon as they are code of
    /// Cranelift: all of them together take most of the memory.
    pub fn some_functions<F: Borrow<Function> + Send>(
        &self,
        mut functions: Vec<(FuncId, F)>,
    ) -> Result<Vec<(FuncId, CompiledFunction)>, CodegenError> {
        let count = functions.len();
        // The next one is taken from the end.
        functions.sort_by_key(|(_, function)| function.borrow().insts.len());
        let waiting = Mutex::new(functions);
        let next = || waiting.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let done = Mutex::new(Vec::with_capacity(count));
        let work = || {
            let mut worker = Worker { compiler: self, context: Context::new(), builder: Default::default() };
            while let Some((id, function)) = next() {
                let result = worker.function(id, function);
                // A thread that panicked ends the program when it is joined.
                done.lock().unwrap_or_else(PoisonError::into_inner).push((id, result));
            }
        };
        in_threads(count, &work);
        let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
        done.sort_by_key(|&(id, _)| id);
        done.into_iter().map(|(id, result)| Ok((id, result?))).collect()
    }
}

/// Calls `work` in as many threads as there are processors, at most in `items`.
pub fn in_threads(items: usize, work: &(dyn Fn() + Sync)) {
    let threads = std::thread::available_parallelism().map_or(1, |count| count.get()).min(items);
    std::thread::scope(|scope| {
        for _ in 1..threads {
            // Without a further thread it only takes longer.
            let _ = std::thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, work);
        }
        work();
    });
}

/// State of a thread that is reused for several functions.
struct Worker<'c, 'm> {
    compiler: &'c Compiler<'m>,
    context: Context,
    builder: FunctionBuilderContext,
}

impl Worker<'_, '_> {
    fn function(&mut self, id: FuncId, source: impl Borrow<Function>) -> Result<CompiledFunction, CodegenError> {
        let compiler = self.compiler;
        let function = source.borrow();
        let tangled = work::jumps_back(function) > JUMPS_BACK_MAX;
        let plain = tangled || function.layout.len() > BLOCKS_MAX;
        // One pass takes quadratic time where many values live over many jumps back.
        let quick = !tangled && work::allocation(function) > ALLOCATION_WORK_MAX;
        let isa = match (plain, quick) {
            (false, false) => &*compiler.isa,
            (false, true) => &*compiler.quick_isa,
            (true, false) => &*compiler.plain_isa,
            (true, true) => &*compiler.plain_quick_isa,
        };
        self.context.clear();
        lower::lower(&compiler.target(isa), id, function, &mut self.builder, &mut self.context.func)?;
        drop(source);
        self.compile(isa, id.index() as u32, &compiler.module.functions[id].name)
    }

    /// The function that calls `function` and keeps all registers.
    fn keeping(&mut self, function: RuntimeFn, number: u32) -> Result<CompiledFunction, CodegenError> {
        let isa = &*self.compiler.isa;
        self.context.clear();
        self.context.func = keeping::function(&self.compiler.target(isa), function, number, &mut self.builder);
        self.compile(isa, number, function.name())
    }

    /// Compiles the function in the context, which the linker knows by `number`.
    fn compile(&mut self, isa: &dyn TargetIsa, number: u32, name: &str) -> Result<CompiledFunction, CodegenError> {
        if let Err(error) = self.context.compile(isa, &mut ControlPlane::default()) {
            let message = cranelift_codegen::print_errors::pretty_error(error.func, error.inner);
            return Err(CodegenError::Function { function: name.to_string(), message });
        }
        let code = self.context.compiled_code().expect("it was compiled");
        let number = cranelift_module::FuncId::from_u32(number);
        let relocs = code
            .buffer
            .relocs()
            .iter()
            .map(|reloc| ModuleReloc::from_mach_reloc(reloc, &self.context.func, number))
            .collect();
        let places = code.buffer.get_srclocs_sorted().iter().map(|place| {
            let bits = if place.loc.is_default() { 0 } else { place.loc.bits() };
            Place { at: place.start, site: bits & !COLD, cold: bits & COLD != 0 }
        });
        Ok(CompiledFunction {
            bytes: code.code_buffer().to_vec(),
            relocs,
            alignment: u64::from(code.buffer.alignment),
            places: filled(places.collect()),
            blocks: code.bb_starts.clone(),
        })
    }
}

/// Code without a place of its own, such as a constant, belongs to the statement before it, at the start of the function to the
/// first one.
fn filled(mut places: Vec<Place>) -> Vec<Place> {
    let mut last = places.iter().map(|place| place.site).find(|site| *site != 0).unwrap_or(0);
    for place in &mut places {
        match place.site {
            0 => place.site = last,
            site => last = site,
        }
    }
    places
}

/// Linker symbol of a function of the module.
pub fn symbol(name: &str) -> String {
    format!("plcc_{name}")
}
