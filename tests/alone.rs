//! A CPU that is alone goes through its cycles by a shorter way, on which nobody else is asked. Memory and the outputs at the modules are the
//! same as if somebody looked at each cycle, whenever an organization block begins, and so is the report of the test.
//!
//! All run tests without a scenario; with one the CPU is never alone.

use std::cell::RefCell;
use std::hash::Hasher;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use plcc_abi::layout;
use plcc_driver::cli::Level;
use plcc_driver::pipeline::{self, Bound, Settings};
use plcc_driver::{code, inputs};
use plcc_runtime::cpu::Cpu;
use plcc_runtime::{Code, TestOptions, TestReport};
use plcc_tests::{files, shown, tests_folder};

/// Peripheral outputs that are compared, in bytes.
const OUTPUTS: u32 = 256;

/// After so many calls memory is compared in every [`LATER_STRIDE`]th only.
const CLOSELY: usize = 100;
const LATER_STRIDE: usize = 25;

#[test]
fn nobody_is_missed_in_short_cycles() {
    let folder = tests_folder().join("run");
    let sources = ["stl", "awl", "scl", "s7dcl", "gr7", "xml"].map(|language| files(&folder, language)).concat();
    let next = AtomicUsize::new(0);
    let some = || {
        let each = std::iter::from_fn(|| sources.get(next.fetch_add(1, Ordering::Relaxed)));
        each.filter(|path| check(path)).count()
    };
    let compared: usize = thread::scope(|scope| {
        let threads = [(); 2].map(|()| scope.spawn(some));
        threads.into_iter().map(|thread| thread.join().expect("both ways do the same")).sum()
    });
    assert!(compared > 1000, "only {compared} of {} programs ran", sources.len());
}

/// Code that keeps a sum of what each organization block finds.
struct Seen {
    code: Rc<dyn Code>,
    found: RefCell<Vec<(u32, u64)>>,
    calls: RefCell<usize>,
}

impl Code for Seen {
    #[allow(unsafe_code, reason = "the memory says which CPU runs")]
    fn call(&self, entry: u32, mem: *mut u8, lbase: u32, vbase: u32) {
        let calls = self.calls.replace_with(|calls| *calls + 1);
        if calls < CLOSELY || calls.is_multiple_of(LATER_STRIDE) {
            // SAFETY: the CPU calls this with its memory.
            let sum = sum(unsafe { Cpu::of(mem) });
            self.found.borrow_mut().push((entry, sum));
        }
        self.code.call(entry, mem, lbase, vbase);
    }
}

/// A sum of all areas of the program and of the outputs at the modules. The state of the CPU is left out.
fn sum(cpu: &Cpu) -> u64 {
    let mut hasher = rustc_hash::FxHasher::default();
    for (begin, end) in [(layout::I, layout::L), (layout::DB_DATA, cpu.memory.size())] {
        cpu.memory.view(begin, end - begin, |bytes| hasher.write(bytes));
    }
    (0..OUTPUTS).step_by(4).for_each(|address| hasher.write_u32(cpu.driver.output(address, 4)));
    hasher.finish()
}

/// False if the program is not one that runs, or has a scenario.
fn check(path: &Path) -> bool {
    if path.with_extension("scenario.toml").is_file() {
        return false;
    }
    let path: PathBuf = path.to_path_buf();
    let work = move || {
        let settings = Settings { pragmas: true, require_main: true, ..Settings::default() };
        let bound = pipeline::front(inputs::read(std::slice::from_ref(&path)), &settings);
        if bound.has_errors() {
            return false;
        }
        let alone = run(&bound, false);
        let observed = run(&bound, true);
        assert_eq!(alone.0, observed.0, "{}: the report", shown(&path));
        let differs = alone.1.iter().zip(&observed.1).position(|(one, other)| one != other);
        assert_eq!(differs, None, "{}: memory before this call", shown(&path));
        assert_eq!(alone.1.len(), observed.1.len(), "{}: calls", shown(&path));
        true
    };
    plcc_driver::on_large_stack(work).unwrap_or_else(|fault| panic!("{fault}"))
}

/// The report, and the sums of what the organization blocks found, in order.
fn run(bound: &Bound, observed: bool) -> (TestReport, Vec<(u32, u64)>) {
    let compiled = pipeline::back(bound, Level::O0);
    let test = &bound.program.test;
    let options = TestOptions {
        cycles: test.cycles.map(u64::from),
        expect_fail: test.expect_fail.clone(),
        observed,
        ..TestOptions::default()
    };
    let code =
        Rc::new(Seen { code: code::interpreter(&compiled), found: RefCell::default(), calls: RefCell::default() });
    let report = plcc_runtime::test(compiled.image, Rc::clone(&code) as Rc<dyn Code>, &options);
    (report, code.found.take())
}
