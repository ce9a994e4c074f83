//! The key of a function: a number that differs whenever the machine code of the function may differ.
//!
//! It comes from the IR of the function after the passes that look at all functions, with the names of its callees,
//! from the DBs of the program, which are addresses in the code, from what runs at safepoints, from the options, and
//! from plcc itself. How functions call each other is not known yet; the kept code remembers it.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::OnceLock;
use std::time::UNIX_EPOCH;

use plcc_codegen::CodegenOptions;
use plcc_ir::entities::Entity;
use plcc_ir::{FuncId, Function, InstData, Module};
use plcc_opt::Surroundings;

/// The keys of the functions of a module.
pub struct Keys<'a> {
    /// What all functions depend on.
    common: Vec<u8>,
    names: Vec<String>,
    surroundings: &'a Surroundings,
    keys: Vec<OnceLock<u128>>,
}

/// Programs with fewer instructions are compiled faster than files are read and written.
const INSTS_MIN: usize = 5_000;

/// The bytes of what is hashed.
#[derive(Default)]
struct Bytes(Vec<u8>);

impl Hasher for Bytes {
    fn finish(&self) -> u64 {
        0
    }

    fn write(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }
}

impl<'a> Keys<'a> {
    /// True if the module is so large that keeping code saves time.
    pub fn is_worth_while(module: &Module) -> bool {
        module.functions.values().map(|function| function.insts.len()).sum::<usize>() >= INSTS_MIN
    }

    pub fn new(module: &Module, surroundings: &'a Surroundings, options: &CodegenOptions) -> Keys<'a> {
        let mut bytes = Bytes::default();
        env!("CARGO_PKG_VERSION").hash(&mut bytes);
        // Another plcc may make other code.
        let plcc = std::env::current_exe().and_then(std::fs::metadata);
        if let Ok((length, Ok(modified))) = plcc.map(|metadata| (metadata.len(), metadata.modified())) {
            (length, modified.duration_since(UNIX_EPOCH).ok()).hash(&mut bytes);
        }
        let CodegenOptions { optimize, native, verify } = *options;
        (optimize, native, verify).hash(&mut bytes);
        for db in &module.dbs {
            (db.number, db.address, db.length, db.read_only).hash(&mut bytes);
        }
        surroundings.areas.hash(&mut bytes);
        surroundings.effects.hash(&mut bytes);
        let names: Vec<String> = module.functions.values().map(|function| function.name.clone()).collect();
        let common = hash(&bytes.0).to_le_bytes().to_vec();
        Keys { common, keys: names.iter().map(|_| OnceLock::new()).collect(), names, surroundings }
    }

    /// The key of a function, which is canonical.
    pub fn key(&self, id: FuncId, function: &Function) -> u128 {
        *self.keys[id.index()].get_or_init(|| hash(&self.bytes(function)))
    }

    /// The key that [`Keys::key`] has found before.
    pub fn found_for(&self, id: FuncId) -> Option<u128> {
        self.keys.get(id.index())?.get().copied()
    }

    /// All keys found so far.
    pub fn found(&self) -> impl Iterator<Item = u128> + '_ {
        self.keys.iter().filter_map(|key| key.get().copied())
    }

    fn bytes(&self, function: &Function) -> Vec<u8> {
        let Function {
            name,
            returns,
            frame_bytes,
            inlined_bytes,
            apart,
            by_pointers,
            blocks,
            layout,
            insts,
            values,
            results,
            locs,
        } = function;
        let mut bytes = Bytes(self.common.clone());
        (name, returns, frame_bytes, inlined_bytes, apart, by_pointers).hash(&mut bytes);
        let ty = |value: &plcc_ir::Value| values[*value].ty;
        for &block in layout {
            let data = &blocks[block];
            (block, data.cold, data.params.len(), data.insts.len()).hash(&mut bytes);
            data.params.iter().for_each(|param| (param, ty(param)).hash(&mut bytes));
            for &inst in &data.insts {
                locs[inst].hash(&mut bytes);
                results[inst].iter().for_each(|result| (result, ty(result)).hash(&mut bytes));
                match &insts[inst] {
                    InstData::Call { callee, args } => {
                        let touches = self.surroundings.touches_caller(*callee);
                        let reads = self.surroundings.caller_reads(*callee);
                        ("call", &self.names[callee.index()], touches, reads, args).hash(&mut bytes);
                    }
                    data => data.hash(&mut bytes),
                }
            }
        }
        bytes.0
    }
}

/// A hash so wide that two functions never share one.
fn hash(bytes: &[u8]) -> u128 {
    let half = |seed: u64| {
        let mut hasher = DefaultHasher::new();
        hasher.write_u64(seed);
        hasher.write(bytes);
        u128::from(hasher.finish())
    };
    half(1) << 64 | half(2)
}
