//! Runs a program in the model and in plcc, and compares all memory after each scan.

use std::panic::{self, AssertUnwindSafe};
use std::rc::Rc;

use plcc_abi::layout;
use plcc_abi::s7200::{V_DB, system};
use plcc_diag::SourceFile;
use plcc_driver::cli::Level;
use plcc_driver::code;
use plcc_driver::inputs::Read;
use plcc_driver::pipeline::{self, Compiled, Optimization, Settings};
use plcc_opt::Without;
use plcc_runtime::Code;
use plcc_runtime::clock::{Clock, NS_PER_MS};
use plcc_runtime::cpu::Cpu;
use plcc_runtime::cycle::{Observer, Pace};
use plcc_runtime::io::Simulated;

use super::generate::Case;
use super::memory::Memory;
use super::model::{Halt, Model};

/// Nanoseconds of host time for a cycle.
const HANG_LIMIT: u64 = 10_000_000_000;
/// Maximum number of reported differences.
const SHOWN: usize = 12;

/// How a program fails.
#[derive(Clone, Debug)]
pub enum Failure {
    /// It does not compile.
    Refused(String),
    /// The compiler or the runtime panics.
    Panicked(String),
    /// It does something else than the model, first in this scan.
    Different { scan: usize, text: String },
}

/// The ways to run a program.
#[derive(Clone, Copy, Debug)]
pub enum Form {
    /// The interpreter at -O0.
    Interpreter,
    /// Machine code.
    Machine(Level),
    /// At -O2 without a pass, as machine code or in the interpreter.
    Without { pass: Without, machine: bool },
}

impl Form {
    /// The forms of a program without a pass.
    pub fn without(pass: Without) -> [Form; 2] {
        [false, true].map(|machine| Form::Without { pass, machine })
    }

    fn optimization(self) -> Optimization {
        match self {
            Form::Interpreter => Level::O0.into(),
            Form::Machine(level) => level.into(),
            Form::Without { pass, .. } => plcc_tests::without(pass),
        }
    }
}

/// All of them.
pub const FORMS: [Form; 3] = [Form::Interpreter, Form::Machine(Level::O0), Form::Machine(Level::O2)];

/// The state after a scan: memory, or a stopped CPU.
enum Expected {
    Memory(Box<Memory>),
    Stopped,
}

/// Compiles and runs in all forms.
pub fn check(case: &Case, forms: &[Form]) -> Result<(), Failure> {
    panic::catch_unwind(AssertUnwindSafe(|| checked(case, forms))).unwrap_or_else(|cause| {
        let text = cause.downcast_ref::<String>().cloned().unwrap_or_else(|| "a panic without text".to_string());
        Err(Failure::Panicked(text))
    })
}

fn checked(case: &Case, forms: &[Form]) -> Result<(), Failure> {
    let mut read = Read { name: "random".to_string(), ..Read::default() };
    read.units.push(read.sources.add(SourceFile::new("random.awl", case.program.to_string())));
    let bound = pipeline::front(read, &Settings { require_main: true, ..Settings::default() });
    if bound.has_errors() {
        let errors: Vec<_> = bound.diagnostics.iter().filter(|message| message.is_error()).cloned().collect();
        return Err(Failure::Refused(plcc_diag::drawing::draw(&errors, &bound.sources, false)));
    }
    let expected = expected(case);
    for &form in forms {
        let compiled = pipeline::back(&bound, form.optimization());
        plcc_ir::verify::verify(&compiled.module)
            .map_err(|errors| Failure::Refused(format!("{form:?}: {}", errors[0])))?;
        let code = match form {
            Form::Interpreter | Form::Without { machine: false, .. } => code::interpreter(&compiled),
            Form::Machine(_) | Form::Without { machine: true, .. } => {
                code::jit(&compiled).map_err(|error| Failure::Refused(error.to_string()))?
            }
        };
        run(case, &expected, &compiled, code).map_err(|failure| match failure {
            Failure::Different { scan, text } => Failure::Different { scan, text: format!("{form:?}: {text}") },
            other @ (Failure::Refused(_) | Failure::Panicked(_)) => other,
        })?;
    }
    Ok(())
}

/// The state of the model after each scan. Scans that do not end have none.
fn expected(case: &Case) -> Vec<Expected> {
    let mut model = Model::new(&case.program);
    let (mut now, mut list) = (0, Vec::new());
    for scan in &case.scans {
        now += scan.after;
        match model.scan(&scan.inputs, now) {
            Ok(()) => list.push(Expected::Memory(Box::new(model.memory.clone()))),
            Err(Halt::Endless) => break,
            Err(Halt::Fatal(_) | Halt::Stop) => {
                list.push(Expected::Stopped);
                break;
            }
        }
    }
    list
}

fn run(case: &Case, expected: &[Expected], compiled: &Compiled, code: Rc<dyn Code>) -> Result<(), Failure> {
    let driver = Box::new(Simulated::new(compiled.image.config.modules.clone()));
    let cpu = Cpu::new(compiled.image.clone(), code, Clock::simulated(), driver);
    let mut player = Player { case, expected, failure: None };
    let pace = Pace { cycles: Some(expected.len() as u64), cycle_time: 0, hang_limit: HANG_LIMIT };
    cpu.execute(&pace, &mut player);
    player.failure.map_or(Ok(()), Err)
}

/// Plays the scans to the CPU.
struct Player<'a> {
    case: &'a Case,
    expected: &'a [Expected],
    failure: Option<Failure>,
}

impl Observer for Player<'_> {
    fn before(&mut self, cpu: &Cpu, cycle: u64, _: u64) {
        let Some(scan) = cycle.checked_sub(1).and_then(|index| self.case.scans.get(index as usize)) else { return };
        for (byte, &value) in (0..).zip(&scan.inputs) {
            cpu.driver.name_input(byte, 1);
            cpu.driver.set_input(byte, 1, value.into());
        }
    }

    fn after(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        let Some(index) = cycle.checked_sub(1).map(|index| index as usize) else { return };
        if self.failure.is_none() {
            let text = match self.expected.get(index) {
                None => None,
                Some(Expected::Stopped) => (!cpu.is_stopped()).then(|| "the CPU runs on".to_string()),
                Some(Expected::Memory(_)) if cpu.is_stopped() => {
                    let stop = cpu.stopped().map_or(String::new(), |stop| cpu.stop_text(&stop));
                    Some(format!("the CPU went to STOP: {stop}"))
                }
                Some(Expected::Memory(memory)) => difference(cpu, memory),
            };
            self.failure = text.map(|text| Failure::Different { scan: index + 1, text });
        }
        if let Some(next) = self.case.scans.get(index + 1) {
            cpu.clock.move_to(time + next.after * NS_PER_MS);
        }
    }
}

/// The difference from the model.
fn difference(cpu: &Cpu, memory: &Memory) -> Option<String> {
    let bits = |bits: &[bool]| bits.iter().map(|&bit| u8::from(bit)).collect::<Vec<u8>>();
    let (v, _) = cpu.memory.db(V_DB);
    let at = |offset: u32| layout::SYSTEM + offset;
    let accumulators: Vec<u8> = memory.accumulators.iter().flat_map(|value| value.to_be_bytes()).collect();
    let (timer_bits, counter_bits) = (bits(&memory.timer_bits), bits(&memory.counter_bits));
    let areas: [(&str, u32, &[u8]); 12] = [
        ("IB", layout::I, &memory.inputs),
        ("QB", layout::Q, &memory.outputs),
        ("MB", layout::M, &memory.m),
        ("VB", v, &memory.v),
        ("SMB", at(system::SM), &memory.sm[..5]),
        ("SMB22+", at(system::SM) + 22, &memory.sm[22..28]),
        ("SMB200+", at(system::SM) + 200, &memory.sm[200..]),
        ("SB", at(system::S), &memory.s),
        ("AC as bytes ", at(system::ACCUMULATORS), &accumulators),
        ("T as bytes ", at(system::TIMER_VALUES), &memory.timer_values),
        ("C as bytes ", at(system::COUNTER_VALUES), &memory.counter_values),
        ("bit of T", at(system::TIMER_BITS), &timer_bits),
    ];
    let mut lines = Vec::new();
    for (name, base, bytes) in areas.into_iter().chain([("bit of C", at(system::COUNTER_BITS), &counter_bits[..])]) {
        for (byte, &expected) in (0..).zip(bytes) {
            let actual = cpu.memory.byte(base + byte);
            if actual != expected {
                lines.push(format!("{name}{byte} is 16#{actual:02X}, not 16#{expected:02X}"));
            }
        }
    }
    lines.truncate(SHOWN);
    (!lines.is_empty()).then(|| lines.join("\n"))
}
