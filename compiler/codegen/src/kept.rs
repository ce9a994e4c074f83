//! Machine code that outlives a compilation.
//!
//! The code of a function depends on its IR and on how it and its callees are called. The caller that keeps code has
//! a key of its own for the IR; [`KeptFunction`] remembers how functions were called, and refers to them by name
//! instead of number. So the result of a compilation does not depend on what was kept.

use cranelift_codegen::binemit::Reloc;
use cranelift_codegen::ir::LibCall;
use cranelift_module::{ModuleReloc, ModuleRelocTarget};
use plcc_abi::RuntimeFn;
use plcc_ir::entities::Entity;
use plcc_ir::{FuncId, Module};
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};

use crate::compile::{CompiledFunction, Compiler, Place};
use crate::facts::Facts;
use crate::keeping;

/// The machine code of a function with everything that a module needs of it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeptFunction {
    #[serde(with = "serde_bytes")]
    bytes: Vec<u8>,
    alignment: u64,
    relocs: Vec<KeptReloc>,
    /// Code offsets and source places.
    places: Vec<(u32, u32)>,
    own_frame: bool,
    caller_frame: bool,
    callees: Vec<String>,
    keeping: u8,
    /// How the function and its callees are called.
    pub(crate) calls: u64,
    /// What the finishing of the function said about it.
    pub(crate) note: u64,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct KeptReloc {
    offset: u32,
    kind: u8,
    target: Target,
    addend: i64,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Target {
    /// Index in `callees`.
    Callee(u32),
    Runtime(u32),
    Keeping(u32),
    Library(u8),
    Own(u32),
}

/// Kinds of relocations that are kept; a function with another one is compiled each time.
const KINDS: [Reloc; 4] = [Reloc::X86CallPCRel4, Reloc::X86PCRel4, Reloc::X86GOTPCRel4, Reloc::Abs8];

/// The functions of the C library that generated code calls.
const LIBRARY: [LibCall; 2] = [LibCall::Memset, LibCall::Memmove];

/// Functions of a module by name.
pub type Names<'m> = FxHashMap<&'m str, FuncId>;

pub fn names(module: &Module) -> Names<'_> {
    module.functions.iter().map(|(id, function)| (function.name.as_str(), id)).collect()
}

impl KeptFunction {
    /// The function as it can be kept. `None`: it contains something that cannot.
    pub(crate) fn new(
        compiler: &Compiler<'_>,
        function: &CompiledFunction,
        facts: &Facts,
        calls: u64,
        note: u64,
    ) -> Option<KeptFunction> {
        let functions = compiler.module.functions.len() as u32;
        let target = |target: &ModuleRelocTarget| match target {
            ModuleRelocTarget::User { index, .. } if *index < functions => {
                let id = FuncId::new(*index as usize);
                Some(Target::Callee(facts.callees.iter().position(|&callee| callee == id)? as u32))
            }
            ModuleRelocTarget::User { index, .. } => match RuntimeFn::ALL.get((index - functions) as usize) {
                Some(_) => Some(Target::Runtime(index - functions)),
                None => {
                    let keeping = (index - functions) as usize - RuntimeFn::ALL.len();
                    Some(Target::Keeping(*compiler.keeping.get(keeping)? as u32))
                }
            },
            ModuleRelocTarget::LibCall(call) => {
                Some(Target::Library(LIBRARY.iter().position(|library| library == call)? as u8))
            }
            ModuleRelocTarget::FunctionOffset(_, offset) => Some(Target::Own(*offset)),
            ModuleRelocTarget::KnownSymbol(_) => None,
        };
        let reloc = |reloc: &ModuleReloc| {
            let kind = KINDS.iter().position(|kind| *kind == reloc.kind)? as u8;
            Some(KeptReloc { offset: reloc.offset, kind, target: target(&reloc.name)?, addend: reloc.addend })
        };
        let name = |&callee: &FuncId| compiler.module.functions[callee].name.clone();
        Some(KeptFunction {
            bytes: function.bytes.clone(),
            alignment: function.alignment,
            relocs: function.relocs.iter().map(reloc).collect::<Option<_>>()?,
            places: function.places.iter().map(|place| (place.at, place.site)).collect(),
            own_frame: facts.own_frame,
            caller_frame: facts.caller_frame,
            callees: facts.callees.iter().map(name).collect(),
            keeping: facts.keeping,
            calls,
            note,
        })
    }

    /// What the function tells about itself. `None`: it calls what the module does not have.
    pub(crate) fn facts(&self, names: &Names<'_>) -> Option<Facts> {
        Some(Facts {
            own_frame: self.own_frame,
            caller_frame: self.caller_frame,
            callees: self.callees.iter().map(|name| names.get(name.as_str()).copied()).collect::<Option<_>>()?,
            keeping: self.keeping,
        })
    }

    /// The code for this module. `None`: it is damaged.
    pub(crate) fn compiled(&self, compiler: &Compiler<'_>, id: FuncId, facts: &Facts) -> Option<CompiledFunction> {
        let own = cranelift_module::FuncId::from_u32(id.index() as u32);
        let functions = compiler.module.functions.len() as u32;
        let user = |index| ModuleRelocTarget::User { namespace: 0, index };
        let reloc = |reloc: &KeptReloc| {
            let name = match reloc.target {
                Target::Callee(index) => user(facts.callees.get(index as usize)?.index() as u32),
                Target::Runtime(number) => {
                    RuntimeFn::ALL.get(number as usize)?;
                    user(functions + number)
                }
                Target::Keeping(number) => {
                    let index = compiler.keeping.iter().position(|&keeping| keeping as u32 == number)?;
                    user(functions + (RuntimeFn::ALL.len() + index) as u32)
                }
                Target::Library(number) => ModuleRelocTarget::LibCall(*LIBRARY.get(number as usize)?),
                Target::Own(offset) => ModuleRelocTarget::FunctionOffset(own, offset),
            };
            let kind = *KINDS.get(reloc.kind as usize)?;
            Some(ModuleReloc { offset: reloc.offset, kind, name, addend: reloc.addend })
        };
        Some(CompiledFunction {
            bytes: self.bytes.clone(),
            relocs: self.relocs.iter().map(reloc).collect::<Option<_>>()?,
            alignment: self.alignment,
            places: self.places.iter().map(|&(at, site)| Place { at, site, cold: false }).collect(),
            // Only statistics and assembly, which nothing is kept for, look at them.
            blocks: Vec::new(),
        })
    }

    /// Whether all of its parts fit together; a file can be damaged.
    pub(crate) fn is_sound(&self) -> bool {
        let is_sound = |reloc: &KeptReloc| {
            let target = match reloc.target {
                Target::Callee(index) => (index as usize) < self.callees.len(),
                Target::Runtime(number) => (number as usize) < RuntimeFn::ALL.len(),
                Target::Keeping(number) => {
                    keeping::of_bits(self.keeping).iter().any(|&function| function as u32 == number)
                }
                Target::Library(number) => usize::from(number) < LIBRARY.len(),
                Target::Own(offset) => (offset as usize) < self.bytes.len(),
            };
            let is_inside = (reloc.offset as usize).saturating_add(4) <= self.bytes.len();
            target && is_inside && usize::from(reloc.kind) < KINDS.len()
        };
        self.alignment.is_power_of_two() && self.keeping >> keeping::COUNT == 0 && self.relocs.iter().all(is_sound)
    }
}
