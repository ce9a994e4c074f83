//! Random modules mean the same before and after every pass: returned values, memory, and the memory that runtime functions see.
//!
//! Addresses fall into a few bytes of every region, directly, with a base, and through pointers that may point into the frame
//! of a caller, so that a wrong assumption about aliasing shows.
//!
//! `generate`: what functions consist of; `build`: functions of the IR; `memory`: what they work on.

mod build;
mod generate;
mod memory;

use plcc_abi::layout;
use plcc_ir::entities::{Entity, EntityVec};
use plcc_ir::interpreter::Interpreter;
use plcc_ir::{FuncId, FunctionBuilder, Module};
use proptest::prelude::*;

use crate::Without;
use build::{Focus, build};
use generate::{RandomBlock, random_function};
use memory::{Memory, dbs};

const WORDS: usize = 3;
const BITS: usize = 3;
const FUNCTIONS: usize = 3;

/// Returned values, memory and log.
type Outcome = (Vec<u64>, Vec<u8>, Vec<u64>);

fn run(module: &Module, seed: u8, word: u32, bit: bool) -> Outcome {
    let memory = Memory::new(seed, !module.entries.is_empty());
    let args = [u64::from(layout::M + 4), u64::from(word), u64::from(bit)];
    let returned = Interpreter::new(module).call(&memory, FuncId::new(0), &args, layout::L, layout::L + 128);
    let observed = memory.observed();
    (returned, observed, memory.log.into_inner())
}

/// The module of random functions: a program of OB 1 alone, or one of which not all is known.
fn random_module(programs: &[Vec<RandomBlock>], focus: &Focus, alone: bool) -> Module {
    let mut functions = EntityVec::new();
    for (index, program) in programs.iter().enumerate() {
        functions.push(build(index, program, focus));
    }
    let mut entries = Vec::new();
    if alone {
        let mut b = FunctionBuilder::new("OB1", &[], &[]);
        b.ret(&[]);
        entries.push(functions.push(b.finish()));
    }
    let module = Module { functions, entries, dbs: dbs(), ..Module::default() };
    crate::check("building", &module);
    module
}

/// `PLCC_PASSES=all` leaves out each pass in each case.
fn left_out(index: usize) -> Vec<Without> {
    let each = Without::each();
    match std::env::var_os("PLCC_PASSES").is_some_and(|value| value == "all") {
        true => each,
        false => vec![each[index % each.len()]],
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, max_shrink_iters: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_pass_relies_on_another_one(
        programs in prop::collection::vec(random_function(), FUNCTIONS),
        (regions, offsets) in (prop::collection::vec(0..7u8, 1..4), 1..9u32),
        (seed, word, bit, alone) in (any::<u8>(), any::<u32>(), any::<bool>(), any::<bool>()),
        index in any::<usize>(),
    ) {
        let module = random_module(&programs, &Focus { regions, offsets }, alone);
        let expected = run(&module, seed, word, bit);
        for without in left_out(index) {
            let mut optimised = module.clone();
            crate::optimize_with(&mut optimised, without, &mut |name, module| crate::check(&format!("{name}, {without}"), module));
            let text = || plcc_ir::print::module_text(&module);
            prop_assert!(run(&optimised, seed, word, bit) == expected, "{} is wrong for\n{}", without, text());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, max_shrink_iters: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn optimisation_keeps_the_meaning(
        programs in prop::collection::vec(random_function(), FUNCTIONS),
        (regions, offsets) in (prop::collection::vec(0..7u8, 1..4), 1..9u32),
        (seed, word, bit, alone) in (any::<u8>(), any::<u32>(), any::<bool>(), any::<bool>()),
    ) {
        let mut module = random_module(&programs, &Focus { regions, offsets }, alone);
        let expected = run(&module, seed, word, bit);
        let mut last = module.clone();
        let mut wrong = None;
        crate::optimize_with(&mut module, Without::NOTHING, &mut |name, module| {
            // Most passes find nothing to do.
            if wrong.is_some() || *module == last {
                return;
            }
            crate::check(name, module);
            if run(module, seed, word, bit) != expected {
                let text = plcc_ir::print::module_text;
                wrong = Some(format!("{name} made of\n{}\n{}", text(&last), text(module)));
            }
            last.clone_from(module);
        });
        prop_assert!(wrong.is_none(), "{}", wrong.unwrap_or_default());
        let again = plcc_ir::parse::parse_module(&plcc_ir::print::module_text(&module));
        prop_assert_eq!(again, Ok(module));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 120, max_shrink_iters: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_pass_says_when_it_has_changed_something(
        programs in prop::collection::vec(random_function(), FUNCTIONS),
        (regions, offsets) in (prop::collection::vec(0..7u8, 1..4), 1..9u32),
        alone in any::<bool>(),
    ) {
        let mut module = random_module(&programs, &Focus { regions, offsets }, alone);
        for name in crate::pipeline().map(|pass| pass.name) {
            let done = crate::run_pass(&mut module, name);
            prop_assert!(done.is_ok(), "{}", done.unwrap_err());
        }
    }
}
