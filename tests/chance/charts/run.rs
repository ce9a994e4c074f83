//! Compiles a chart with its caller, runs it, and compares it with the model after each cycle.

use std::rc::Rc;

use plcc_abi::layout;
use plcc_convert::from_scl;
use plcc_convert::trivia::Trivia;
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
use plcc_syntax::stl::Mnemonics;

use super::chart::Chart;
use super::generate::{Call, Case};
use super::memory::Memory;
use super::model::Model;
use super::text::{self, Watch};

/// Nanoseconds of host time for a cycle.
const HANG_LIMIT: u64 = 10_000_000_000;
/// Milliseconds in MD 40 and MD 44, for rows with a time in memory.
const TIMES: [(u8, i16); 2] = [(42, 100), (46, 250)];

/// How a chart fails.
#[derive(Clone, Debug)]
pub enum Failure {
    /// It does not compile.
    Refused(String),
    /// It does something else than the model, first in this call.
    Different { call: usize, text: String },
}

/// The ways to run a program.
#[derive(Clone, Copy, Debug)]
pub enum Form {
    /// The interpreter at -O0.
    Plain,
    /// Machine code at -O2.
    Machine,
    /// At -O2 without a pass, as machine code or in the interpreter.
    Without { pass: Without, machine: bool },
}

impl Form {
    /// The forms of a chart without a pass.
    pub fn without(pass: Without) -> [Form; 2] {
        [false, true].map(|machine| Form::Without { pass, machine })
    }

    fn optimization(self) -> Optimization {
        match self {
            Form::Plain => Level::O0.into(),
            Form::Machine => Level::O2.into(),
            Form::Without { pass, .. } => plcc_tests::without(pass),
        }
    }
}

/// All of them.
pub const FORMS: [Form; 2] = [Form::Plain, Form::Machine];

/// Binds a chart with its caller.
fn bound(case: &Case, long: bool) -> Result<pipeline::Bound, Failure> {
    let (chart, caller) = (text::graph(&case.chart), text::caller(&case.chart, long));
    let settings = Settings { require_main: true, ..Settings::default() };
    good(pipeline::front(read([("chart.gr7", chart.as_str()), ("main.stl", caller.as_str())]), &settings))
}

/// The sources of a program, by their names.
fn read(sources: [(&str, &str); 2]) -> Read {
    let mut read = Read { name: "chart".to_string(), ..Read::default() };
    for (name, text) in sources {
        read.units.push(read.sources.add(SourceFile::new(name, text)));
    }
    read
}

fn good(bound: pipeline::Bound) -> Result<pipeline::Bound, Failure> {
    if bound.has_errors() {
        let errors: Vec<_> = bound.diagnostics.iter().filter(|message| message.is_error()).cloned().collect();
        return Err(Failure::Refused(plcc_diag::drawing::draw(&errors, &bound.sources, false)));
    }
    Ok(bound)
}

/// Compiles and runs in all forms.
pub fn check(case: &Case, forms: &[Form]) -> Result<(), Failure> {
    let bound = bound(case, false)?;
    for &form in forms {
        let compiled = pipeline::back(&bound, form.optimization());
        plcc_ir::verify::verify(&compiled.module)
            .map_err(|errors| Failure::Refused(format!("{form:?}: {}", errors[0])))?;
        let code = match form {
            Form::Plain | Form::Without { machine: false, .. } => code::interpreter(&compiled),
            Form::Machine | Form::Without { machine: true, .. } => {
                code::jit(&compiled).map_err(|error| Failure::Refused(error.to_string()))?
            }
        };
        run(case, &compiled, code).map_err(|failure| match failure {
            Failure::Different { call, text } => Failure::Different { call, text: format!("{form:?}: {text}") },
            refused @ Failure::Refused(_) => refused,
        })?;
    }
    Ok(())
}

/// Runs a chart as the statement list that is made of it.
pub fn check_as_list(case: &Case) -> Result<(), Failure> {
    let (chart, caller) = (text::graph(&case.chart), text::caller(&case.chart, false));
    let plain = Settings { require_main: true, plain_charts: true, ..Settings::default() };
    let parsed = pipeline::parse(read([("chart.gr7", chart.as_str()), ("main.stl", caller.as_str())]), &plain);
    let unit = parsed.units[0].1.clone();
    let program = good(pipeline::bind(parsed, &plain))?.program;
    let meaning = (chart.as_str(), Default::default());
    let (made, mut messages) = from_scl::unit(&unit, &program, meaning, plcc_program::with_chart_data);
    let (list, more) = plcc_convert::stl::write(&made, Mnemonics::En, Trivia::none(), None);
    messages.extend(more);
    if let Some(error) = messages.iter().find(|message| message.is_error()) {
        return Err(Failure::Refused(error.title.clone()));
    }
    let settings = Settings { plain_charts: false, ..plain };
    let bound = good(pipeline::front(read([("list.stl", list.as_str()), ("main.stl", caller.as_str())]), &settings))?;
    let compiled = pipeline::back(&bound, Level::O0);
    let code = code::jit(&compiled).map_err(|error| Failure::Refused(error.to_string()))?;
    run(case, &compiled, code)
}

/// The instance after each call, with or without the short way of the ordinary modes. Source of IL_PERM: `text::caller`.
pub fn instances(case: &Case, long: bool) -> Result<Vec<Vec<u8>>, Failure> {
    let bound = bound(case, long)?;
    let compiled = pipeline::back(&bound, Form::Machine.optimization());
    let code = code::jit(&compiled).map_err(|error| Failure::Refused(error.to_string()))?;
    let mut seen = Vec::new();
    play(case, &compiled, code, &mut |cpu| {
        let (begin, bytes) = cpu.memory.db(1);
        seen.push((begin..begin + bytes).map(|at| cpu.memory.byte(at)).collect());
    })?;
    Ok(seen)
}

fn run(case: &Case, compiled: &Compiled, code: Rc<dyn Code>) -> Result<(), Failure> {
    play(case, compiled, code, &mut |_| ())
}

/// Runs a case; `look` sees the CPU after each cycle.
fn play(case: &Case, compiled: &Compiled, code: Rc<dyn Code>, look: &mut dyn FnMut(&Cpu)) -> Result<(), Failure> {
    let driver = Box::new(Simulated::new(compiled.image.config.modules.clone()));
    let cpu = Cpu::new(compiled.image.clone(), code, Clock::simulated(), driver);
    let mut player = Player {
        calls: &case.calls,
        chart: &case.chart,
        watches: text::watches(&case.chart),
        model: Model::new(&case.chart),
        memory: Memory::new(),
        failure: None,
        look,
    };
    let pace = Pace { cycles: Some(case.calls.len() as u64), cycle_time: 0, hang_limit: HANG_LIMIT };
    let cycles = cpu.execute(&pace, &mut player);
    match player.failure {
        Some(failure) => Err(failure),
        None if cpu.is_stopped() => {
            let stop = cpu.stopped().map_or(String::new(), |stop| cpu.stop_text(&stop));
            Err(Failure::Different { call: cycles as usize, text: format!("the CPU went to STOP: {stop}") })
        }
        None => Ok(()),
    }
}

/// Plays the calls to the CPU and to the model.
struct Player<'a> {
    calls: &'a [Call],
    chart: &'a Chart,
    watches: Vec<Watch>,
    model: Model,
    memory: Memory,
    failure: Option<Failure>,
    look: &'a mut dyn FnMut(&Cpu),
}

impl Observer for Player<'_> {
    fn before(&mut self, cpu: &Cpu, cycle: u64, _: u64) {
        let Some(call) = cycle.checked_sub(1).and_then(|index| self.calls.get(index as usize)) else {
            TIMES.iter().for_each(|&(byte, ms)| self.memory.set_word(byte, ms));
            self.memory_to(cpu);
            return;
        };
        self.memory.inputs[..4].copy_from_slice(&call.process);
        for (byte, &value) in (0..).zip(&call.process) {
            cpu.driver.set_input(byte, 1, value.into());
        }
        for (index, &value) in call.inputs.bits.iter().enumerate() {
            let byte = &mut self.memory.bit_memory[usize::from(text::PARAMETERS) + index / 8];
            let mask = 1 << (index % 8);
            *byte = if value { *byte | mask } else { *byte & !mask };
        }
        self.memory.set_word(text::S_SEL, call.inputs.s_sel);
        self.memory.bit_memory[usize::from(text::PAUSE)] = call.paused.into();
        let own = usize::from(text::PAUSE)..self.memory.bit_memory.len();
        for (offset, &value) in (layout::M + u32::from(text::PAUSE)..).zip(&self.memory.bit_memory[own]) {
            cpu.memory.set_byte(offset, value);
        }
    }

    fn after(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        let Some(index) = cycle.checked_sub(1).map(|index| index as usize) else { return };
        (self.look)(cpu);
        if self.failure.is_some() {
            return;
        }
        let now = time / NS_PER_MS;
        let call = &self.calls[index];
        self.memory.now = now as i64;
        if !call.paused {
            self.model.call(&call.inputs, &mut self.memory, now as i64);
        }
        if let Some(text) = self.difference(cpu) {
            self.failure = Some(Failure::Different { call: index + 1, text });
        }
        if let Some(next) = self.calls.get(index + 1) {
            cpu.clock.move_to((now + next.after as u64) * NS_PER_MS);
        }
    }
}

impl Player<'_> {
    fn memory_to(&self, cpu: &Cpu) {
        for (offset, &value) in (layout::M..).zip(&self.memory.bit_memory) {
            cpu.memory.set_byte(offset, value);
        }
    }

    /// The difference from the model.
    fn difference(&self, cpu: &Cpu) -> Option<String> {
        let mut lines = Vec::new();
        let (db, _) = cpu.memory.db(2);
        for watch in &self.watches {
            let at = db + watch.byte;
            let actual = match watch.bits {
                1 => i64::from(cpu.memory.byte(at) & 1),
                16 => i64::from(cpu.memory.word(at) as i16),
                _ => i64::from(cpu.memory.dword(at) as i32),
            };
            let expected = (watch.value)(&self.model, &self.memory);
            if actual != expected {
                lines.push(format!("{} is {actual}, not {expected}", watch.name));
            }
        }
        let areas: [(&str, u32, &[u8]); 2] =
            [("QB", layout::Q, &self.memory.outputs), ("MB", layout::M, &self.memory.bit_memory)];
        for (name, base, bytes) in areas {
            for (byte, &expected) in (0..).zip(bytes) {
                let actual = cpu.memory.byte(base + byte);
                if actual != expected {
                    lines.push(format!("{name} {byte} is {actual:08b}, not {expected:08b}"));
                }
            }
        }
        let numbers: Vec<i16> = self.model.order.iter().map(|&step| self.chart.steps[step].number).collect();
        (!lines.is_empty()).then(|| format!("{}\nactive steps of the model: {numbers:?}", lines.join("\n")))
    }
}
