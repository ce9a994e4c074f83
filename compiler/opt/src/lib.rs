//! Optimisation passes over the SSA IR.
//!
//! [`TOGETHER`] and [`ALONE`] are the passes in their order; each is one file with its idea on top. All take time near linear in
//! the size of the program and never recurse by it: a PLC block can have tens of thousands of lines.
//!
//! **Invariant**: a pass keeps everything that an observer of PLC memory can see: memory at calls, at runtime functions that may run
//! organization blocks, and at the end of the block.

mod addresses;
mod bits;
mod block_moves;
mod branches;
mod checks;
mod cold_loops;
mod control_flow;
mod copy_loops;
mod dead_code;
mod dead_stores;
mod duplicate;
mod effects;
mod extents;
mod finite;
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
mod note_outputs;
mod pointer_tests;
mod ranges;
mod sink_stores;
mod surroundings;
mod unroll;
mod unused;
mod usage;
mod values;
mod variables;
mod without;
mod words;

use plcc_ir::{Function, Module};
use rustc_hash::FxHashMap;
pub use surroundings::Surroundings;
pub use usage::{Usage, reached, usage, usage_of};
pub use without::{UnknownPass, Without};

/// A pass with the name that `--print-after`, `--without-pass` and tests use.
#[derive(Clone, Copy)]
pub struct Pass {
    pub name: &'static str,
    pub run: Run,
}

/// What a pass has changed in a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    Nothing,
    /// Equal constants are one value, and equal conditions.
    Shared,
    /// What nothing uses is gone.
    Unused,
    /// Something else.
    Code,
}

impl From<bool> for Change {
    fn from(changed: bool) -> Change {
        if changed { Change::Code } else { Change::Nothing }
    }
}

/// How much of the program a pass looks at. The result of a pass over a function is false if it has changed nothing.
#[derive(Clone, Copy)]
pub enum Run {
    /// One function.
    Function(fn(&mut Function) -> bool),
    /// One function; it says what it has changed.
    Telling(fn(&mut Function) -> Change),
    /// One function, and facts about the others.
    Surrounded(fn(&mut Function, &Surroundings) -> bool),
    Module(fn(&mut Module)),
}

const fn function(name: &'static str, run: fn(&mut Function) -> bool) -> Pass {
    Pass { name, run: Run::Function(run) }
}

const fn telling(name: &'static str, run: fn(&mut Function) -> Change) -> Pass {
    Pass { name, run: Run::Telling(run) }
}

const fn surrounded(name: &'static str, run: fn(&mut Function, &Surroundings) -> bool) -> Pass {
    Pass { name, run: Run::Surrounded(run) }
}

const fn module(name: &'static str, run: fn(&mut Module)) -> Pass {
    Pass { name, run: Run::Module(run) }
}

impl Pass {
    /// True if the pass knows nothing but its function.
    fn is_alone(&self) -> bool {
        matches!(self.run, Run::Function(_) | Run::Telling(_))
    }

    /// True if the pass does nothing to a function without loops. No pass makes a loop where there is none.
    fn is_for_loops(&self) -> bool {
        matches!(
            self.name,
            "copy-loops"
                | "hoist-lookups"
                | "loop-memory"
                | "loop-ranges"
                | "part-cold-loops"
                | "turn-loops"
                | "unroll"
        )
    }

    /// True if the pass has nothing to do after such a change, if it had nothing to do before it.
    fn ignores(&self, change: Change) -> bool {
        match change {
            Change::Nothing => true,
            // Constants are looked at as such, and conditions hardly more often when they are one.
            Change::Shared => {
                matches!(
                    self.name,
                    "addresses" | "bits" | "forward" | "loop-memory" | "loop-ranges" | "ranges" | "values"
                )
            }
            Change::Unused => matches!(
                self.name,
                "addresses" | "bits" | "fold" | "forward" | "loop-ranges" | "ranges" | "unused" | "values"
            ),
            Change::Code => false,
        }
    }
}

/// What `-O2` does to all functions together, in order. A new pass is its module above and a row here or in [`ALONE`].
pub const TOGETHER: &[Pass] = &[
    function("fold", fold::fold),
    function("control-flow", control_flow::simplify_control_flow),
    telling("unused", unused::remove_unused),
    function("compact", compact),
    surrounded("addresses", addresses::resolve_addresses),
    telling("values", values::share_values),
    surrounded("forward", forward::forward_memory),
    function("fold", fold::fold),
    function("control-flow", control_flow::simplify_control_flow),
    module("interfaces", interfaces::simplify_interfaces),
    function("fold", fold::fold),
    function("control-flow", control_flow::simplify_control_flow),
    module("dead-code", dead_code::eliminate_dead_code),
    module("inline", inline::inline_calls),
    function("fold", fold::fold),
    function("control-flow", control_flow::simplify_control_flow),
    module("dead-code", dead_code::eliminate_dead_code),
    function("compact", compact),
];

/// What `-O2` does to each function after that. Nothing here depends on the code of other functions, so that the machine code of a function
/// can be kept until it changes.
pub const ALONE: &[Pass] = &[
    surrounded("addresses", addresses::resolve_addresses),
    function("bits", bits::find_bits),
    telling("values", values::share_values),
    surrounded("forward", forward::forward_memory),
    surrounded("locals", locals::promote_locals),
    function("fold", fold::fold),
    surrounded("ranges", ranges::use_ranges),
    function("fold", fold::fold),
    function("control-flow", control_flow::simplify_control_flow),
    function("part-checks", checks::part_checks),
    surrounded("addresses", addresses::resolve_addresses),
    telling("values", values::share_values),
    surrounded("forward", forward::forward_memory),
    function("fold", fold::fold),
    surrounded("block-moves", block_moves::move_blocks),
    function("copy-loops", copy_loops::copy_loops),
    function("unroll", unroll::unroll_loops),
    function("control-flow", control_flow::simplify_control_flow),
    function("fold", fold::fold),
    function("control-flow", control_flow::simplify_control_flow),
    surrounded("part-cold-loops", cold_loops::part_cold_loops),
    function("control-flow", control_flow::simplify_control_flow),
    surrounded("loop-memory", loop_memory::carry_memory),
    function("fold", fold::fold),
    surrounded("ranges", ranges::use_ranges),
    function("fold", fold::fold),
    function("control-flow", control_flow::simplify_control_flow),
    surrounded("addresses", addresses::resolve_addresses),
    function("bits", bits::find_bits),
    telling("values", values::share_values),
    surrounded("forward", forward::forward_memory),
    function("fold", fold::fold),
    function("part-cold-ways", duplicate::part_cold_ways),
    function("control-flow", control_flow::simplify_control_flow),
    telling("values", values::share_values),
    surrounded("forward", forward::forward_memory),
    function("fold", fold::fold),
    function("part-cold-ways", duplicate::part_cold_ways),
    // Loops that were too large before their checks went; without what is unused they may be one block.
    telling("unused", unused::remove_unused),
    function("control-flow", control_flow::simplify_control_flow),
    // Pointers that were in memory have their ranges now, and reach less of it. Counters that were in memory are values then, with ranges
    // that say how often a loop runs, and so how far its pointers get.
    surrounded("loop-memory", loop_memory::carry_memory),
    surrounded("forward", forward::forward_memory),
    function("fold", fold::fold),
    surrounded("loop-ranges", ranges::use_ranges_of_loops),
    function("fold", fold::fold),
    function("control-flow", control_flow::simplify_control_flow),
    surrounded("loop-ranges", ranges::use_ranges_of_loops),
    function("fold", fold::fold),
    function("control-flow", control_flow::simplify_control_flow),
    function("unroll", unroll::unroll_loops),
    function("control-flow", control_flow::simplify_control_flow),
    function("fold", fold::fold),
    surrounded("loop-ranges", ranges::use_ranges_of_loops),
    function("control-flow", control_flow::simplify_control_flow),
    // What was indexed by the counter of a loop that is unrolled.
    surrounded("addresses", addresses::resolve_addresses),
    telling("values", values::share_values),
    surrounded("forward", forward::forward_memory),
    // What is never read goes before stores under a condition, or of single bits, become ones that read what is there.
    surrounded("dead-stores", dead_stores::eliminate_dead_stores),
    telling("unused", unused::remove_unused),
    function("branches", branches::select_by_branches),
    function("control-flow", control_flow::simplify_control_flow),
    function("fold", fold::fold),
    surrounded("words", forward::read_whole_words),
    surrounded("merge-bits", merge_bits::merge_bits),
    function("floats", floats::relax_floats),
    function("finite-results", finite::part_finite_results),
    surrounded("hoist-lookups", invariants::hoist_lookups),
    function("turn-loops", duplicate::turn_loops),
    function("pointer-tests", pointer_tests::join_pointer_tests),
    function("fold", fold::fold),
    function("control-flow", control_flow::simplify_control_flow),
    // The test before the first pass of a loop that was turned may be known.
    function("fold", fold::fold),
    function("control-flow", control_flow::simplify_control_flow),
    surrounded("dead-stores", dead_stores::eliminate_dead_stores),
    surrounded("sink-stores", sink_stores::sink_stores),
    telling("unused", unused::remove_unused),
    function("control-flow", control_flow::simplify_control_flow),
    surrounded("note-outputs", note_outputs::note_outputs),
    function("compact", compact),
];

fn pipeline() -> impl Iterator<Item = &'static Pass> {
    TOGETHER.iter().chain(ALONE)
}

/// Names of the passes, each once, in the order in which they first run.
pub fn passes() -> Vec<&'static str> {
    let mut names: Vec<&str> = Vec::new();
    for pass in pipeline() {
        if !names.contains(&pass.name) {
            names.push(pass.name);
        }
    }
    names
}

/// Optimises a module that the verifier passes, except for the passes that are switched off.
pub fn optimize(module: &mut Module, without: Without) {
    optimize_together(module, without);
    run_all(ALONE, module, without);
}

/// The first part of [`optimize`]: the passes that look at all functions.
pub fn optimize_together(module: &mut Module, without: Without) {
    run_all(TOGETHER, module, without);
}

/// The beginning of the first part for one function, which need not be in a module yet.
pub fn begin(function: &mut Function, without: Without) {
    run_row(beginning().0, function, without);
}

/// [`optimize`] for functions that [`begin`] was called with.
pub fn optimize_begun(module: &mut Module, without: Without) {
    optimize_begun_together(module, without);
    run_all(ALONE, module, without);
}

/// The first part of [`optimize`] for functions that [`begin`] was called with.
pub fn optimize_begun_together(module: &mut Module, without: Without) {
    run_all(beginning().1, module, without);
}

/// The first passes, which know nothing but their function, and the others of [`TOGETHER`].
fn beginning() -> (&'static [Pass], &'static [Pass]) {
    TOGETHER.split_at(row_of_functions(TOGETHER))
}

/// How many passes in a row know nothing but their function.
fn row_of_functions(passes: &[Pass]) -> usize {
    passes.iter().take_while(|pass| pass.is_alone()).count()
}

/// The second part of [`optimize`], for one function of a module after the first part.
pub fn optimize_alone(function: &mut Function, surroundings: &Surroundings, without: Without) {
    run_on(ALONE, function, surroundings, without);
}

/// Runs passes in order; those in a row that look at one function on all processors.
fn run_all(mut passes: &[Pass], module: &mut Module, without: Without) {
    if cfg!(debug_assertions) {
        run_each(passes.iter(), module, without, &mut check);
        return;
    }
    while let Some((first, rest)) = passes.split_first() {
        if let Run::Module(run) = first.run {
            if !without.contains(first.name) {
                run(module);
            }
            passes = rest;
            continue;
        }
        // What surrounds functions is found when it is asked for: after the first passes there is less to look at, and it is less.
        let row = row_of_functions(passes);
        if row > 0 {
            let (row, rest) = passes.split_at(row);
            surroundings::for_each(&mut module.functions, &|function| run_row(row, function, without));
            passes = rest;
            continue;
        }
        let row = passes.iter().take_while(|pass| !matches!(pass.run, Run::Module(_))).count();
        let (row, rest) = passes.split_at(row);
        let surroundings = Surroundings::new(module);
        surroundings::for_each(&mut module.functions, &|function| {
            run_on(row, function, &surroundings, without);
        });
        passes = rest;
    }
}

/// Runs passes that look at one function. One that has seen everything as it is does not run again: most functions are small and have no
/// loops, and nothing happens to them in half of the rows.
///
/// Result: whether anything changed.
fn run_on(passes: &[Pass], function: &mut Function, surroundings: &Surroundings, without: Without) -> bool {
    run_each_on(passes, function, without, |run, function| match run {
        Run::Function(run) => run(function).into(),
        Run::Telling(run) => run(function),
        Run::Surrounded(run) => run(function, surroundings).into(),
        Run::Module(_) => unreachable!("only passes that look at one function run so"),
    })
}

/// As [`run_on`], for passes that know nothing but their function.
fn run_row(passes: &[Pass], function: &mut Function, without: Without) {
    run_each_on(passes, function, without, |run, function| match run {
        Run::Function(run) => run(function).into(),
        Run::Telling(run) => run(function),
        Run::Surrounded(_) | Run::Module(_) => unreachable!("only passes that know nothing but their function run so"),
    });
}

fn run_each_on(
    passes: &[Pass],
    function: &mut Function,
    without: Without,
    mut run: impl FnMut(Run, &mut Function) -> Change,
) -> bool {
    // What the passes have changed so far, and for each pass how much of that it has seen.
    let mut changes: Vec<Change> = Vec::new();
    let mut seen: FxHashMap<&str, usize> = FxHashMap::default();
    let mut has_loops = None;
    for pass in passes.iter().filter(|pass| !without.contains(pass.name)) {
        if let Some(seen) = seen.insert(pass.name, changes.len())
            && changes[seen..].iter().all(|&change| pass.ignores(change))
        {
            continue;
        }
        if pass.is_for_loops() && !*has_loops.get_or_insert_with(|| plcc_ir::analysis::has_loops(function)) {
            continue;
        }
        let change = run(pass.run, function);
        if change != Change::Nothing {
            changes.push(change);
        }
    }
    !changes.is_empty()
}

/// Renumbers a function; its code stays as it is.
fn compact(function: &mut Function) -> bool {
    function.compact();
    false
}

fn run_each<'p>(
    passes: impl Iterator<Item = &'p Pass>,
    module: &mut Module,
    without: Without,
    after: &mut dyn FnMut(&'static str, &Module),
) {
    for pass in passes.filter(|pass| !without.contains(pass.name)) {
        run_one(pass, module);
        after(pass.name, module);
    }
}

/// Result: false if nothing changed.
fn run_one(pass: &Pass, module: &mut Module) -> bool {
    if let Run::Module(run) = pass.run {
        run(module);
        return true;
    }
    let surroundings = Surroundings::new(module);
    let mut changed = false;
    for function in module.functions.values_mut() {
        changed |= run_on(&[*pass], function, &surroundings, Without::NOTHING);
    }
    changed
}

/// Like [`optimize`]; calls `after` with the name of each pass that runs, and its result.
pub fn optimize_with(module: &mut Module, without: Without, after: &mut dyn FnMut(&'static str, &Module)) {
    run_each(pipeline(), module, without, after);
}

/// Runs the pass called `name`.
///
/// Errors: there is none; or it says that it has changed nothing, and has.
pub fn run_pass(module: &mut Module, name: &str) -> Result<(), String> {
    let pass = pipeline().find(|pass| pass.name == name).ok_or_else(|| format!("there is no pass `{name}`"))?;
    if name == "compact" {
        run_one(pass, module);
        return Ok(());
    }
    let before = plcc_ir::print::module_text(module);
    if !run_one(pass, module) && plcc_ir::print::module_text(module) != before {
        return Err(format!("{name} says that it has changed nothing, and has"));
    }
    Ok(())
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
        run_pass(&mut module, name)?;
        verify(&module).map_err(|error| format!("after {name}: {error}"))?;
    }
    module.functions.values_mut().for_each(Function::compact);
    Ok(plcc_ir::print::module_text(&module))
}

/// Panics if the verifier rejects the result of the pass `name`: a bug of the pass.
pub fn check(name: &str, module: &Module) {
    if let Err(errors) = plcc_ir::verify::verify(module) {
        panic!("after {name}: {}\n{}", errors[0], plcc_ir::print::module_text(module));
    }
}

#[cfg(test)]
mod tests;
