//! From functions that are not finished to an object file, with the code of those that have not changed since it was made.
//!
//! First each function is finished, or its kept code says what it would be; only then is it known how functions call
//! each other. Code that was kept with another way of calling is not used.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Mutex, PoisonError};

use plcc_abi::linked;
use plcc_ir::entities::{Entity, EntityVec};
use plcc_ir::{FuncId, Function, Module};

use crate::abi::FunctionAbi;
use crate::compile::{CompiledFunction, Compiler, in_threads};
use crate::facts::{Facts, facts};
use crate::isa::Placement;
use crate::kept::{KeptFunction, names};
use crate::object::object_of;
use crate::variables::Variables;
use crate::{CodegenError, CodegenOptions};

/// How functions are finished.
pub struct Finishing<'a> {
    /// What was kept of this function, which is not finished.
    pub kept: &'a (dyn Fn(FuncId, &Function) -> Option<KeptFunction> + Sync),
    /// Finishes the function. The result is kept with its code; see [`Finished::notes`].
    pub finish: &'a (dyn Fn(&mut Function) -> u64 + Sync),
    /// What can be kept is wanted.
    pub keep: bool,
}

/// The machine code of a module.
pub struct Finished<'m> {
    compiler: Compiler<'m>,
    functions: Vec<CompiledFunction>,
    /// What the finishing of each function has returned.
    pub notes: Vec<u64>,
    /// Functions that were compiled, to be kept.
    pub made: Vec<(FuncId, KeptFunction)>,
}

enum State {
    Finished(u64),
    Kept(KeptFunction),
}

/// Makes the machine code of a module. Functions that were kept stay unfinished; of those that were compiled only the heads are left.
pub fn finish<'m>(
    module: &'m mut Module,
    options: &CodegenOptions,
    finishing: &Finishing<'_>,
) -> Result<Finished<'m>, CodegenError> {
    let ids: Vec<FuncId> = module.functions.keys().collect();
    let first =
        |id: FuncId, function: &mut Function| match (finishing.kept)(id, function).filter(KeptFunction::is_sound) {
            Some(kept) => State::Kept(kept),
            None => State::Finished((finishing.finish)(function)),
        };
    let mut states = for_each(&mut module.functions, &ids, &first);
    let mut all_facts: Vec<Facts> = Vec::with_capacity(ids.len());
    let mut missing = Vec::new();
    {
        let names = names(module);
        for (&id, state) in ids.iter().zip(&states) {
            let known = match state {
                State::Finished(_) => Some(facts(&module.functions[id])),
                State::Kept(kept) => kept.facts(&names),
            };
            if known.is_none() {
                missing.push(id);
            }
            all_facts.push(known.unwrap_or_default());
        }
    }
    let again = |_: FuncId, function: &mut Function| State::Finished((finishing.finish)(function));
    for (id, state) in missing.iter().zip(for_each(&mut module.functions, &missing, &again)) {
        states[id.index()] = state;
        all_facts[id.index()] = facts(&module.functions[*id]);
    }
    let calls = ways_of_calling(&Compiler::with_facts(module, &all_facts, Placement::Object, options)?, &all_facts);
    let is_other = |&id: &FuncId| matches!(&states[id.index()], State::Kept(kept) if kept.calls != calls[id.index()]);
    let others: Vec<FuncId> = ids.iter().copied().filter(is_other).collect();
    for (id, state) in others.iter().zip(for_each(&mut module.functions, &others, &again)) {
        states[id.index()] = state;
    }

    let finished = ids.iter().copied().filter(|id| matches!(states[id.index()], State::Finished(_)));
    let fresh: Vec<(FuncId, Function)> = finished.map(|id| (id, module.functions[id].take_body())).collect();
    let compiler = Compiler::with_facts(module, &all_facts, Placement::Object, options)?;
    let mut fresh = compiler.some_functions(fresh)?.into_iter();
    let mut finished =
        Finished { compiler, functions: Vec::with_capacity(ids.len()), notes: Vec::new(), made: Vec::new() };
    for (&id, state) in ids.iter().zip(&states) {
        let facts = &all_facts[id.index()];
        match state {
            State::Kept(kept) => {
                let damaged = || CodegenError::Output("the code of a function was kept wrongly".to_string());
                let code = kept.compiled(&finished.compiler, id, facts).ok_or_else(damaged)?;
                finished.functions.push(code);
                finished.notes.push(kept.note);
            }
            State::Finished(note) => {
                let (_, code) = fresh.next().expect("each finished function was compiled");
                if finishing.keep {
                    let calls = calls[id.index()];
                    let kept = KeptFunction::new(&finished.compiler, &code, facts, calls, *note);
                    finished.made.extend(kept.map(|kept| (id, kept)));
                }
                finished.functions.push(code);
                finished.notes.push(*note);
            }
        }
    }
    Ok(finished)
}

impl Finished<'_> {
    /// Object file, to be linked with the runtime. `image` is the encoded `ProgramImage`.
    pub fn object(&self, image: &[u8]) -> Result<Vec<u8>, CodegenError> {
        self.object_as(linked::SYMBOL, image, None)
    }

    /// As [`object`](Finished::object), for one of several programs, which exports `name`. A debugger sees the `variables`.
    pub fn object_as(
        &self,
        name: &str,
        image: &[u8],
        variables: Option<&Variables<'_>>,
    ) -> Result<Vec<u8>, CodegenError> {
        object_of(name, &self.compiler, &self.functions, image, variables)
    }
}

/// For each function a number that changes with the way in which it or one of its callees is called.
fn ways_of_calling(compiler: &Compiler<'_>, facts: &[Facts]) -> Vec<u64> {
    let way = |abi: &FunctionAbi| {
        let mut hasher = DefaultHasher::new();
        format!("{abi:?}").hash(&mut hasher);
        hasher.finish()
    };
    let ways: Vec<u64> = compiler.abis.values().map(way).collect();
    let of_function = |(index, facts): (usize, &Facts)| {
        let mut hasher = DefaultHasher::new();
        ways[index].hash(&mut hasher);
        facts.callees.iter().for_each(|callee| ways[callee.index()].hash(&mut hasher));
        hasher.finish()
    };
    facts.iter().enumerate().map(of_function).collect()
}

/// Calls `work` with each of these functions on all processors; results are in the order of `ids`, which ascend.
fn for_each<R: Send>(
    functions: &mut EntityVec<FuncId, Function>,
    ids: &[FuncId],
    work: &(dyn Fn(FuncId, &mut Function) -> R + Sync),
) -> Vec<R> {
    let mut wanted = ids.iter().copied().peekable();
    let is_wanted = |(id, _): &(FuncId, &mut Function)| wanted.next_if_eq(id).is_some();
    let mut waiting: Vec<(FuncId, &mut Function)> = functions.iter_mut().filter(is_wanted).collect();
    // The next one is taken from the end.
    waiting.sort_by_key(|(_, function)| function.insts.len());
    let total: usize = waiting.iter().map(|(_, function)| function.insts.len()).sum();
    let waiting = Mutex::new(waiting);
    let next = || waiting.lock().unwrap_or_else(PoisonError::into_inner).pop();
    let done = Mutex::new(Vec::with_capacity(ids.len()));
    in_threads(if total < SHARED_INSTS_MIN { 1 } else { ids.len() }, &|| {
        while let Some((id, function)) = next() {
            let result = work(id, function);
            done.lock().unwrap_or_else(PoisonError::into_inner).push((id, result));
        }
    });
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_by_key(|&(id, _)| id);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Programs with fewer instructions are finished before a thread has started.
const SHARED_INSTS_MIN: usize = 5_000;
