//! Optimisation passes over the SSA IR.
//!
//! [`PIPELINE`] is the list of passes in their order; each is one file with its idea on top. All take time near linear in
//! the size of the program and never recurse by it: a PLC block can have tens of thousands of lines.
//!
//! **Invariant**: a pass keeps everything that an observer of PLC memory can see: memory at calls, at runtime functions that may run
//! organization blocks, and at the end of the block.

mod addresses;
mod bits;
mod branches;
mod cold_loops;
mod control_flow;
mod dead_code;
mod dead_stores;
mod duplicate;
mod effects;
mod extents;
mod floats;
mod fold;
mod forward;
mod frames;
mod inline;
mod interfaces;
mod invariants;
mod known_bits;
mod locals;
mod loop_memory;
mod loops;
mod merge_bits;
mod ranges;
mod unroll;
mod usage;
mod values;
mod variables;
mod without;
mod words;

use plcc_ir::Module;
pub use usage::{Usage, usage};
pub use without::{UnknownPass, Without};

/// A pass with the name that `--print-after`, `--without-pass` and tests use.
#[derive(Clone, Copy)]
pub struct Pass {
    pub name: &'static str,
    pub run: fn(&mut Module),
}

const fn pass(name: &'static str, run: fn(&mut Module)) -> Pass {
    Pass { name, run }
}

/// What `-O2` does, in order. A new pass is its module above and a row here.
pub const PIPELINE: &[Pass] = &[
    pass("fold", fold::fold),
    pass("control-flow", control_flow::simplify_control_flow),
    pass("addresses", addresses::resolve_addresses),
    pass("values", values::share_values),
    pass("forward", forward::forward_memory),
    pass("fold", fold::fold),
    pass("control-flow", control_flow::simplify_control_flow),
    pass("interfaces", interfaces::simplify_interfaces),
    pass("fold", fold::fold),
    pass("control-flow", control_flow::simplify_control_flow),
    pass("dead-code", dead_code::eliminate_dead_code),
    pass("compact", compact),
    pass("inline", inline::inline_calls),
    pass("fold", fold::fold),
    pass("control-flow", control_flow::simplify_control_flow),
    pass("addresses", addresses::resolve_addresses),
    pass("bits", bits::find_bits),
    pass("values", values::share_values),
    pass("forward", forward::forward_memory),
    pass("locals", locals::promote_locals),
    pass("fold", fold::fold),
    pass("ranges", ranges::use_ranges),
    pass("fold", fold::fold),
    pass("control-flow", control_flow::simplify_control_flow),
    pass("addresses", addresses::resolve_addresses),
    pass("values", values::share_values),
    pass("forward", forward::forward_memory),
    pass("fold", fold::fold),
    pass("unroll", unroll::unroll_loops),
    pass("control-flow", control_flow::simplify_control_flow),
    pass("fold", fold::fold),
    pass("control-flow", control_flow::simplify_control_flow),
    pass("part-cold-loops", cold_loops::part_cold_loops),
    pass("control-flow", control_flow::simplify_control_flow),
    pass("loop-memory", loop_memory::carry_memory),
    pass("fold", fold::fold),
    pass("ranges", ranges::use_ranges),
    pass("fold", fold::fold),
    pass("control-flow", control_flow::simplify_control_flow),
    pass("addresses", addresses::resolve_addresses),
    pass("bits", bits::find_bits),
    pass("values", values::share_values),
    pass("forward", forward::forward_memory),
    pass("fold", fold::fold),
    pass("part-cold-ways", duplicate::part_cold_ways),
    pass("control-flow", control_flow::simplify_control_flow),
    pass("values", values::share_values),
    pass("forward", forward::forward_memory),
    pass("fold", fold::fold),
    pass("part-cold-ways", duplicate::part_cold_ways),
    pass("control-flow", control_flow::simplify_control_flow),
    pass("values", values::share_values),
    pass("forward", forward::forward_memory),
    pass("branches", branches::select_by_branches),
    pass("control-flow", control_flow::simplify_control_flow),
    pass("fold", fold::fold),
    pass("words", forward::read_whole_words),
    pass("merge-bits", merge_bits::merge_bits),
    pass("floats", floats::relax_floats),
    pass("hoist-lookups", invariants::hoist_lookups),
    pass("turn-loops", duplicate::turn_loops),
    pass("fold", fold::fold),
    pass("control-flow", control_flow::simplify_control_flow),
    pass("dead-stores", dead_stores::eliminate_dead_stores),
    pass("dead-code", dead_code::eliminate_dead_code),
    pass("control-flow", control_flow::simplify_control_flow),
    pass("compact", compact),
];

/// Names of the passes, each once, in the order in which they first run.
pub fn passes() -> Vec<&'static str> {
    let mut names: Vec<&str> = Vec::new();
    for pass in PIPELINE {
        if !names.contains(&pass.name) {
            names.push(pass.name);
        }
    }
    names
}

/// Optimises a module that the verifier passes, except for the passes that are switched off.
pub fn optimize(module: &mut Module, without: Without) {
    optimize_with(module, without, &mut |name, module| {
        if cfg!(debug_assertions) {
            check(name, module);
        }
    });
}

/// Like [`optimize`]; calls `after` with the name of each pass that runs, and its result.
pub fn optimize_with(module: &mut Module, without: Without, after: &mut dyn FnMut(&'static str, &Module)) {
    for pass in PIPELINE.iter().filter(|pass| !without.contains(pass.name)) {
        (pass.run)(module);
        after(pass.name, module);
    }
}

/// Runs the pass called `name`; false if there is none.
pub fn run_pass(module: &mut Module, name: &str) -> bool {
    let pass = PIPELINE.iter().find(|pass| pass.name == name);
    if let Some(pass) = pass {
        (pass.run)(module);
    }
    pass.is_some()
}

/// Runs the passes that the first line of an IR text names, `; passes: fold, dead-code`, and prints the canonical result: what a
/// file under `tests/opt` expects.
///
/// Errors: text, first line, or module are wrong.
pub fn run_listed_passes(text: &str) -> Result<String, String> {
    let list = text.lines().next().and_then(|line| line.strip_prefix("; passes:"));
    let list = list.ok_or("the first line is expected to be `; passes: NAME, NAME`")?;
    let mut module = plcc_ir::parse::parse_module(text).map_err(|error| error.to_string())?;
    let verify = |module: &Module| plcc_ir::verify::verify(module).map_err(|errors| errors[0].to_string());
    verify(&module)?;
    for name in list.split(',').map(str::trim) {
        if !run_pass(&mut module, name) {
            return Err(format!("there is no pass `{name}`"));
        }
        verify(&module).map_err(|error| format!("after {name}: {error}"))?;
    }
    compact(&mut module);
    Ok(plcc_ir::print::module_text(&module))
}

/// Panics if the verifier rejects the result of the pass `name`: a bug of the pass.
pub fn check(name: &str, module: &Module) {
    if let Err(errors) = plcc_ir::verify::verify(module) {
        panic!("after {name}: {}\n{}", errors[0], plcc_ir::print::module_text(module));
    }
}

/// Drops blocks, instructions and values that earlier passes took out, and numbers the rest again.
fn compact(module: &mut Module) {
    module.functions.values_mut().for_each(plcc_ir::Function::compact);
}

#[cfg(test)]
mod tests;
