//! Checks that a module is well formed. These are the rules:
//!
//! Module
//! - Function names are unique, not empty, and have no space, `(`, `{`, `;` or `"`; entries exist and take and return nothing.
//! - DBs are sorted by number, each number once; their data is after `layout::DB_DATA`, at most 64 KiB each.
//! - A frame is a multiple of `layout::FRAME_ALIGN` and at most `layout::L_CLASS_BYTES`; with the bytes for inlined functions too.
//!
//! Blocks
//! - A function has an entry block; nothing jumps to it. Each block is laid out once, each jump target is laid out.
//! - A block ends with a terminator and has no other.
//! - Jumps supply as many values as the target has parameters, of the same types.
//! - `ret` supplies the values that the function returns.
//!
//! Values
//! - A value has one definition, whose stored place is right. A use is not an alias.
//! - The definition of a value dominates its uses, in blocks that can be reached.
//! - An instruction is at one place; its site exists.
//!
//! Types
//! - Constants fit their type. `iadd` to `ashr` and the rotates: i8 to i64, `and or xor`: i1 too, both operands and the
//!   result of one type; float operations: f32 or f64. `bswap`: i16, i32, i64.
//! - Comparisons: two operands of one type, result i1; of i1 only `eq` and `ne`.
//! - `zext sext` widen and `trunc` narrows integers; `bitcast` is between i32 and f32 or i64 and f64; `from_sint` and
//!   `to_sint` are between i32 or i64 and f32 or f64; `fpromote` is f32 to f64, `fdemote` the reverse.
//! - `select` and `branch` decide by an i1, `switch` by an i32.
//! - Memory holds no i1 except as a bit 0 to 7. Address bases, DB numbers, addresses and frame bases are i32.
//! - Calls match the parameters of the callee's entry block and its results; runtime calls match their table.
//!
//! Regions
//! - `any` and `anydb` have a base.
//! - `DBn` is a DB of the module. Without a base the whole access is inside the DB, the frame (`L`), one L stack (`V`),
//!   the area of 64 KiB (`state`, `I`, `Q`, `M`, `system`), or the cells of timers and counters (`cells`).

mod instruction;

use std::fmt;

use plcc_abi::layout;
use rustc_hash::FxHashSet;

use crate::analysis::{ControlFlow, Dominators};
use crate::entities::{Block, Entity, EntityVec, Value};
use crate::function::{Function, ValueDef};
use crate::module::Module;

/// A broken rule; a bug in the code that built the module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VerifyError {
    /// Name of the function; empty if the rule is one of the module.
    pub function: String,
    /// Block as stored.
    pub block: Option<Block>,
    /// Place of the instruction in its block.
    pub index: Option<usize>,
    pub message: String,
}

impl fmt::Display for VerifyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.function.is_empty() {
            write!(f, "@{}", self.function)?;
            if let Some(block) = self.block {
                write!(f, " {block}")?;
            }
            if let Some(index) = self.index {
                write!(f, " instruction {index}")?;
            }
            write!(f, ": ")?;
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for VerifyError {}

/// Checks all rules of the module comment. Errors: every broken one that was found.
pub fn verify(module: &Module) -> Result<(), Vec<VerifyError>> {
    let mut errors = Vec::new();
    verify_module(module, &mut errors);
    for function in module.functions.values() {
        verify_function(module, function, &mut errors);
    }
    if errors.is_empty() { Ok(()) } else { Err(errors) }
}

fn verify_module(module: &Module, errors: &mut Vec<VerifyError>) {
    let mut report = |function: &str, message: String| {
        errors.push(VerifyError { function: function.to_owned(), block: None, index: None, message });
    };
    let mut names = FxHashSet::default();
    for function in module.functions.values() {
        if !names.insert(&function.name) {
            report(&function.name, "the name is not unique".into());
        }
        if function.name.is_empty()
            || function.name.contains(|c: char| c.is_whitespace() || matches!(c, '(' | '{' | ';' | '"'))
        {
            report(&function.name, "the name cannot be read back".into());
        }
    }
    for &entry in &module.entries {
        match module.functions.get(entry) {
            None => report("", format!("entry {entry} is not a function")),
            Some(function) => {
                let takes = function.layout.first().is_some_and(|&block| !function.blocks[block].params.is_empty());
                if takes || !function.returns.is_empty() {
                    report(&function.name, "an entry takes and returns nothing".into());
                }
            }
        }
    }
    for pair in module.dbs.windows(2) {
        if pair[0].number >= pair[1].number {
            report("", format!("DB{} comes after DB{}", pair[1].number, pair[0].number));
        }
    }
    for db in &module.dbs {
        let end = db.address.checked_add(db.length);
        let fits = db.length <= 0x1_0000 && end.is_some_and(|end| end <= layout::END_MAX);
        if db.address < layout::DB_DATA || !fits {
            report("", format!("DB{} lies outside the data of DBs", db.number));
        }
    }
}

fn verify_function(module: &Module, function: &Function, errors: &mut Vec<VerifyError>) {
    let mut verifier = Verifier {
        module,
        function,
        errors,
        block: None,
        index: None,
        definitions: EntityVec::new(),
        laid_out: EntityVec::new(),
    };
    verifier.run();
}

/// Where a value is defined, for the check of dominance.
#[derive(Clone, Copy)]
struct Definition {
    block: Block,
    /// Place after which it may be used: 0 for parameters, 1 + place of the instruction for results.
    after: usize,
}

struct Verifier<'a> {
    module: &'a Module,
    function: &'a Function,
    errors: &'a mut Vec<VerifyError>,
    block: Option<Block>,
    index: Option<usize>,
    definitions: EntityVec<Value, Option<Definition>>,
    laid_out: EntityVec<Block, bool>,
}

impl Verifier<'_> {
    fn report(&mut self, message: impl Into<String>) {
        self.errors.push(VerifyError {
            function: self.function.name.clone(),
            block: self.block,
            index: self.index,
            message: message.into(),
        });
    }

    fn check(&mut self, holds: bool, message: &str) {
        if !holds {
            self.report(message);
        }
    }

    fn run(&mut self) {
        let function = self.function;
        let frame = function.frame_bytes;
        if !frame.is_multiple_of(layout::FRAME_ALIGN) || frame > layout::L_CLASS_BYTES {
            self.report(format!("a frame of {frame} bytes is not aligned or too large"));
        }
        let inlined = function.inlined_bytes;
        if !inlined.is_multiple_of(layout::FRAME_ALIGN) || function.local_bytes() > layout::L_CLASS_BYTES {
            self.report(format!("{inlined} bytes for inlined functions are not aligned or too many"));
        }
        if function.layout.is_empty() {
            self.report("the function has no block");
            return;
        }
        let errors_before = self.errors.len();
        self.check_layout();
        self.collect_definitions();
        self.check_references();
        if self.errors.len() > errors_before {
            // The following checks rely on the structure.
            return;
        }
        for &block in &function.layout {
            self.block = Some(block);
            for (index, &inst) in function.blocks[block].insts.iter().enumerate() {
                self.index = Some(index);
                self.check_inst(inst);
            }
        }
        self.check_dominance();
    }

    fn check_layout(&mut self) {
        let function = self.function;
        for _ in function.blocks.keys() {
            self.laid_out.push(false);
        }
        for &block in &function.layout {
            if function.blocks.get(block).is_none() {
                self.report(format!("{block} does not exist"));
            } else if std::mem::replace(&mut self.laid_out[block], true) {
                self.report(format!("{block} is laid out twice"));
            }
        }
    }

    fn collect_definitions(&mut self) {
        let function = self.function;
        for _ in function.values.keys() {
            self.definitions.push(None);
        }
        let mut placed = vec![false; function.insts.len()];
        for &block in &function.layout {
            let Some(data) = function.blocks.get(block) else { continue };
            self.block = Some(block);
            self.index = None;
            for (index, &param) in (0u32..).zip(&data.params) {
                self.define(param, ValueDef::Param(block, index), Definition { block, after: 0 });
            }
            for (index, &inst) in data.insts.iter().enumerate() {
                self.index = Some(index);
                let Some(operation) = function.insts.get(inst) else {
                    self.report(format!("{inst} does not exist"));
                    continue;
                };
                if std::mem::replace(&mut placed[inst.index()], true) {
                    self.report("the instruction stands at two places");
                }
                let last = index + 1 == data.insts.len();
                if operation.is_terminator() != last {
                    self.report(if last { "the block ends without a terminator" } else { "a terminator ends a block" });
                }
                for (number, &result) in (0u32..).zip(&function.results[inst]) {
                    self.define(result, ValueDef::Result(inst, number), Definition { block, after: index + 1 });
                }
            }
            if data.insts.is_empty() {
                self.report("the block is empty");
            }
        }
        (self.block, self.index) = (None, None);
    }

    fn define(&mut self, value: Value, def: ValueDef, definition: Definition) {
        match self.function.values.get(value) {
            None => self.report(format!("{value} does not exist")),
            Some(data) if data.def != def => self.report(format!("the definition stored for {value} is another")),
            Some(_) => {
                if self.definitions[value].replace(definition).is_some() {
                    self.report(format!("{value} is defined twice"));
                }
            }
        }
    }

    /// Every used value, target and callee exists.
    fn check_references(&mut self) {
        let function = self.function;
        for &block in &function.layout {
            let Some(data) = function.blocks.get(block) else { continue };
            self.block = Some(block);
            for (index, &inst) in data.insts.iter().enumerate() {
                self.index = Some(index);
                let Some(operation) = function.insts.get(inst) else { continue };
                operation.for_each_use(|value| {
                    if self.definitions.get(value).is_none_or(Option::is_none) {
                        self.report(format!("{value} is used and defined nowhere"));
                    }
                });
                operation.for_each_target(|call| {
                    if self.laid_out.get(call.block) != Some(&true) {
                        self.report(format!("the jump target {} is not laid out", call.block));
                    } else if call.block == function.entry() {
                        self.report("a jump goes to the entry block");
                    }
                });
                if function.locs[inst].0 as usize > self.module.sites.len() {
                    self.report(format!("site {} does not exist", function.locs[inst].0));
                }
            }
        }
    }

    fn check_dominance(&mut self) {
        let function = self.function;
        let cfg = ControlFlow::new(function);
        let dominators = Dominators::new(function, &cfg);
        for &block in &cfg.rpo {
            self.block = Some(block);
            for (index, &inst) in function.blocks[block].insts.iter().enumerate() {
                self.index = Some(index);
                function.insts[inst].for_each_use(|value| {
                    let Some(definition) = self.definitions[value] else { return };
                    let known = if definition.block == block {
                        definition.after <= index
                    } else {
                        cfg.is_reachable(definition.block) && dominators.dominates(definition.block, block)
                    };
                    if !known {
                        self.report(format!("the definition of {value} does not dominate this use"));
                    }
                });
            }
        }
    }
}

#[cfg(test)]
mod tests;
