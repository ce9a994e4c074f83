//! A program does the same with probes as without, those of the status of a block, of a debugger and of coverage, and if its code changes in
//! every cycle: the report of its test is the same.
//!
//! About one in twenty-five run tests, chosen by their paths; `PLCC_PROBES=all` takes all of them.

use std::rc::Rc;

use plcc_codegen::CodegenError;
use plcc_driver::cli::Level;
use plcc_driver::pipeline::{self, Bound, Compiled, Settings};
use plcc_driver::{code, inputs};
use plcc_runtime::cpu::Cpu;
use plcc_runtime::{Code, TestOptions, TestReport};
use plcc_tests::{files, is_chosen, shown, tests_folder};

/// One in so many run tests.
const PART: u64 = 25;

#[test]
fn probes_change_nothing() {
    let all = std::env::var_os("PLCC_PROBES").is_some_and(|value| value == "all");
    let folder = tests_folder().join("run");
    let sources = ["stl", "awl", "scl", "s7dcl", "gr7", "xml"].map(|language| files(&folder, language)).concat();
    assert!(sources.len() > 500, "the run tests are there");
    let mut probes = 0;
    for path in sources.iter().filter(|path| all || is_chosen(path, PART)) {
        probes += check(path);
    }
    assert!(probes > 500, "only {probes} probes");
}

/// Code that runs with probes in every other cycle.
struct InTurn(Rc<dyn Code>);

impl Code for InTurn {
    #[allow(unsafe_code, reason = "the memory says which CPU runs")]
    fn call(&self, entry: u32, mem: *mut u8, lbase: u32, vbase: u32) {
        // SAFETY: the CPU calls this with its memory.
        let cycle = unsafe { Cpu::of(mem) }.cycle_number();
        self.0.watch(cycle % 2 == 1);
        self.0.call(entry, mem, lbase, vbase);
    }
}

/// The report of a program whose code changes from cycle to cycle.
fn in_turn(
    bound: &Bound,
    options: &TestOptions,
    code: impl Fn(&Compiled, &Compiled) -> Result<Rc<dyn Code>, CodegenError>,
) -> TestReport {
    let mut plain = pipeline::lower(bound, Level::O2);
    let probed = pipeline::optimize(pipeline::lower_beside(bound, &mut plain));
    let mut plain = pipeline::optimize(plain);
    plain.share_image(&probed.image);
    let code = code(&plain, &probed).expect("what is lowered becomes code");
    plcc_runtime::test(plain.image, Rc::new(InTurn(code)), options)
}

/// Number of probes.
fn check(path: &std::path::Path) -> usize {
    let path = path.to_path_buf();
    let work = move || {
        let settings = Settings { pragmas: true, require_main: true, ..Settings::default() };
        let bound = pipeline::front(inputs::read(std::slice::from_ref(&path)), &settings);
        if bound.has_errors() {
            return 0;
        }
        let test = &bound.program.test;
        let scenario = Some(path.with_extension("scenario.toml")).filter(|file| file.is_file());
        let options = TestOptions {
            cycles: test.cycles.map(u64::from),
            expect_fail: test.expect_fail.clone(),
            scenario,
            ..TestOptions::default()
        };
        let run = |compiled: &Compiled| -> TestReport {
            let code = code::jit(compiled).expect("what is lowered becomes code");
            plcc_runtime::test(compiled.image.clone(), code, &options)
        };
        let plain = pipeline::back(&bound, Level::O2);
        let without = plcc_ir::print::module_text(&pipeline::lower(&bound, Level::O0).module);
        assert!(!without.contains("probe_"), "{}: code has probes that nobody asked for", shown(&path));
        let (probed, places) = pipeline::lower_with_probes(&bound, Level::O2);
        let verified = plcc_ir::verify::verify(&probed.module);
        assert!(verified.is_ok(), "{}: {verified:?}", shown(&path));
        let (before, after) = (run(&plain), run(&pipeline::optimize(probed)));
        assert_eq!(before, after, "{}", shown(&path));
        assert_eq!(before, in_turn(&bound, &options, code::jit_watched), "{}: in turn", shown(&path));
        let interpreted = |plain: &Compiled, probed: &Compiled| Ok(code::interpreter_watched(plain, probed));
        assert_eq!(before, in_turn(&bound, &options, interpreted), "{}: in turn, interpreted", shown(&path));
        let (stepped, statements) = pipeline::lower_for_debugger(&bound);
        let verified = plcc_ir::verify::verify(&stepped.module);
        assert!(verified.is_ok(), "{}: {verified:?}", shown(&path));
        assert_eq!(before, run(&pipeline::optimize(stepped)), "{}: for a debugger", shown(&path));
        let (counted, bits) = pipeline::lower_for_coverage(&bound, Level::O2);
        let verified = plcc_ir::verify::verify(&counted.module);
        assert!(verified.is_ok(), "{}: {verified:?}", shown(&path));
        assert_eq!(before, run(&pipeline::optimize(counted)), "{}: for coverage", shown(&path));
        places.len() + statements.len() + bits.len()
    };
    plcc_driver::on_large_stack(work).unwrap_or_else(|fault| panic!("{fault}"))
}
