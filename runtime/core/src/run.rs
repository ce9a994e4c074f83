//! Running a program as a CPU does: `plcc run` and executables.

use std::fs::File;
use std::io::Write;
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use plcc_abi::ProgramImage;

use crate::clock::Clock;
use crate::code::Code;
use crate::cpu::Cpu;
use crate::cycle::{Observer, Pace};
use crate::faults::STOP_BY_REQUEST;
use crate::io::Simulated;
use crate::options::{ClockKind, HANG_LIMIT_DEFAULT, RunOptions, split_list};
use crate::plant::Plant;
use crate::records::store::{self, Store};
use crate::scenario::{Player, Scenario};
use crate::signal::{Signal, Source, Value};
use crate::trace::{self, Recorder};
use crate::{diagnostics, files, names, realtime, report};

/// The program stopped because it was asked to.
pub const EXIT_OK: u8 = 0;
/// The CPU went to STOP on a fault, or an expectation of the scenario failed.
pub const EXIT_FAULT: u8 = 1;
/// A flag or file is wrong.
pub const EXIT_USAGE: u8 = 2;

/// Writes a line to standard error; a closed one must not stop a plant.
macro_rules! say {
    ($($arg:tt)*) => {{
        let _ = writeln!(std::io::stderr(), $($arg)*);
    }};
}

static END: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// True after SIGINT or SIGTERM.
pub fn end_requested() -> bool {
    END.get().is_some_and(|end| end.load(Ordering::Relaxed))
}

/// The first SIGINT or SIGTERM ends the run after the cycle, a second one ends the process at once.
fn watch_signals() {
    let end = END.get_or_init(|| Arc::new(AtomicBool::new(false)));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        // Without the handlers the signals still end the process.
        let _ = signal_hook::flag::register_conditional_shutdown(signal, i32::from(EXIT_FAULT), end.clone())
            .and_then(|_| signal_hook::flag::register(signal, end.clone()));
    }
}

/// Everything that flags name, checked.
struct Session {
    set: Vec<(Source, Value)>,
    /// Time of the last cycle in nanoseconds.
    last: u64,
    player: Player,
    recorder: Option<Recorder>,
}

impl Observer for Session {
    fn before(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        if cycle == 0 {
            for (source, value) in &self.set {
                // Checked when the session was made.
                let _ = source.write(cpu, value);
            }
        }
        self.player.before(cpu, cycle, time);
    }

    fn after(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        self.last = time;
        self.player.after(cpu, cycle, time);
        if let Some(recorder) = &mut self.recorder {
            recorder.sample(cpu, self.player.plant(), cycle, time);
        }
    }
}

/// Runs a program by the runtime flags. Values go to standard output, messages to standard error. Result: exit code.
pub fn run(mut image: ProgramImage, code: Rc<dyn Code>, options: &RunOptions) -> u8 {
    let clock = match options.clock {
        ClockKind::Real => Clock::real(),
        ClockKind::Virtual => Clock::simulated(),
    };
    image.config.s7200.stop_on_error |= options.stop_on_error;
    let driver = Box::new(Simulated::new(image.config.modules.clone()));
    let cpu = Cpu::new(image, code, clock, driver);
    if let Some(port) = options.iso_port {
        cpu.communication.borrow_mut().set_iso_port(port);
    }
    let folder = store::folder(options.data.as_deref(), cpu.image.config.data_folder.as_deref());
    cpu.set_store(Store::new(folder));
    if let Some(path) = &options.alarm_log {
        match files::writable(path).and_then(|()| File::create(path)) {
            Ok(file) => cpu.alarms.borrow_mut().write_to(file),
            Err(error) => {
                say!("runtime: {}: {error}", path.display());
                return EXIT_USAGE;
            }
        }
    }
    let (printed, mut session) = match prepare(&cpu, options) {
        Ok(prepared) => prepared,
        Err(message) => {
            say!("runtime: {message}");
            return EXIT_USAGE;
        }
    };
    tell_partial(&cpu.image.partial, options.quiet);
    if let Err(message) = realtime(options) {
        say!("runtime: --realtime: {message}");
        return EXIT_USAGE;
    }
    watch_signals();
    let pace = Pace {
        cycles: options.cycles,
        cycle_time: options.cycle_time.map_or_else(|| cpu.cycle_time(), |time| time.0),
        hang_limit: options.hang_limit.unwrap_or(HANG_LIMIT_DEFAULT).0,
    };
    // Also with --quiet: the user must know this to judge the values.
    for notice in &cpu.image.notices {
        say!("{notice}");
    }
    let cycles = cpu.execute(&pace, &mut session);
    finish(&cpu, options, &printed, session, cycles)
}

/// Does what `--realtime` asks for. Under the virtual clock cycles follow each other without a pause: at the priority of real time they
/// would keep the computer from everything else.
fn realtime(options: &RunOptions) -> Result<(), String> {
    match (options.realtime, options.clock) {
        (false, _) => Ok(()),
        (true, ClockKind::Real) => realtime::enter(),
        (true, ClockKind::Virtual) => Err("the virtual clock does not wait; leave out one of both flags".to_string()),
    }
}

fn is_closed(error: &std::io::Error) -> bool {
    error.kind() == std::io::ErrorKind::BrokenPipe
}

/// Reports the stand-ins for missing parts, one per line, or all in one line.
fn tell_partial(items: &[String], quiet: bool) {
    match (items.len(), quiet) {
        (0, _) => {}
        (1, true) => say!("partial: the program was built with 1 missing part"),
        (count, true) => say!("partial: the program was built with {count} missing parts"),
        (_, false) => items.iter().for_each(|item| say!("partial: {item}")),
    }
}

fn finish(cpu: &Cpu, options: &RunOptions, printed: &[Signal], session: Session, cycles: u64) -> u8 {
    let mut exit = EXIT_OK;
    if !printed.is_empty() {
        let mut out = std::io::stdout().lock();
        let plant = session.player.plant();
        let written =
            report::write_values(cpu, plant, printed, options.json.then_some((cycles, session.last)), &mut out)
                .and_then(|()| out.flush());
        // A closed pipe is not a fault of the program.
        if let Err(error) = written.or_else(|error| if is_closed(&error) { Ok(()) } else { Err(error) }) {
            say!("runtime: cannot write to standard output: {error}");
            exit = EXIT_USAGE;
        }
    }
    for failure in session.player.failures() {
        let place = failure.place().map(|place| format!(" {place}")).unwrap_or_default();
        let beside = match failure.beside.is_empty() {
            true => String::new(),
            false => format!("; beside it: {}", failure.beside.join(", ")),
        };
        let (file, line, text) = (&failure.file, failure.line, &failure.text);
        say!("{file}:{line}: expected {text}, but it is {}{place}{beside}", failure.left);
        exit = exit.max(EXIT_FAULT);
    }
    let stop = cpu.stopped();
    match stop {
        Some(stop) if !stop.asked => {
            say!("{}", cpu.stop_text(&stop));
            exit = exit.max(EXIT_FAULT);
        }
        Some(stop) if stop.entry.event == STOP_BY_REQUEST => {
            if !options.quiet {
                say!("ended in startup");
            }
        }
        Some(_) if !options.quiet => say!("stopped by the program after {cycles} cycles"),
        None if !options.quiet => say!("ended after {cycles} cycles"),
        Some(_) | None => {}
    }
    if options.diag {
        for entry in cpu.diagnostics.newest_first() {
            say!("{}", diagnostics::line(&cpu.image, &entry));
        }
        cpu.s7200_error_report().iter().for_each(|line| say!("{line}"));
    }
    if let Some(Err(error)) = session.recorder.map(Recorder::finish) {
        say!("runtime: the trace is incomplete: {error}");
        exit = EXIT_USAGE;
    }
    exit
}

fn prepare(cpu: &Cpu, options: &RunOptions) -> Result<(Vec<Signal>, Session), String> {
    cpu.s7200_check_retentive_file()?;
    let scenario = options.scenario.as_deref().map(|path| Scenario::read(path, &cpu.image)).transpose()?;
    let player = Player::new(scenario.unwrap_or_default(), cpu)?.print_to(Box::new(std::io::stdout()), options.json);
    let printed = signals(cpu, player.plant(), &options.print)?;
    let asked = signals(cpu, player.plant(), &options.trace_signals)?;
    // A wrong flag leaves the trace of an earlier run as it is.
    let set = settings(cpu, &options.set)?;
    let recorder = match &options.trace {
        Some(path) => {
            let step = options.trace_step.map_or(0, |step| step.0);
            let (signals, has_more) = trace::signals(cpu, &asked, &printed);
            if has_more {
                let count = signals.len();
                say!("the trace has the first {count} values of the program; --trace-signals names others");
            }
            Some(Recorder::create(path, signals, step)?)
        }
        None => None,
    };
    Ok((printed, Session { set, last: 0, player, recorder }))
}

/// Values of a structure or DB that a flag names as a whole.
const VALUES_MAX: usize = 1000;

/// The signals of a list flag.
fn signals(cpu: &Cpu, plant: Option<&Plant>, list: &[String]) -> Result<Vec<Signal>, String> {
    let mut signals = Vec::new();
    for name in split_list(list) {
        let found = match Source::find(&name, &cpu.image, plant) {
            Ok(source) => vec![Signal { name, source }],
            // A structure, an array or a DB stands for all its values.
            Err(wrong) => {
                let values = names::values(&name, &cpu.image, VALUES_MAX).map_err(|_| wrong)?;
                values.into_iter().map(|(name, named)| Signal { name, source: Source::of(named) }).collect()
            }
        };
        for Signal { name, source } in &found {
            source.check(cpu).map_err(|message| format!("{name}: {message}"))?;
        }
        signals.extend(found);
    }
    Ok(signals)
}

/// Splits at the first `=` that is not in quotes.
fn split_setting(item: &str) -> Option<(&str, &str)> {
    let mut in_quotes = false;
    let at = item.find(|c| {
        in_quotes ^= c == '"';
        c == '=' && !in_quotes
    })?;
    Some((&item[..at], &item[at + 1..]))
}

/// The settings of `--set`. Inputs among them are copied into the process image from the start.
fn settings(cpu: &Cpu, list: &[String]) -> Result<Vec<(Source, Value)>, String> {
    let one = |item: String| {
        let (name, text) = split_setting(&item).ok_or_else(|| format!("--set {item}: write ADDR=VALUE, as I0.0=1"))?;
        let source = Source::find(name, &cpu.image, None)?;
        let checked = match source.address() {
            Some(address) => cpu.check_address(address).and_then(|()| source.check_settable()),
            None => source.check_settable(),
        };
        let checked = checked.and_then(|()| source.parse(text, &cpu.image));
        checked.map(|value| (source, value)).map_err(|message| format!("--set {item}: {message}"))
    };
    split_list(list).into_iter().map(one).collect()
}
