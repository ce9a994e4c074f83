//! Running a program as a CPU does: `plcc run` and executables.

mod debugged;
mod instances;
mod recorded;
mod session;

use std::fs::File;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use plcc_abi::ProgramImage;

use crate::change::{CodeSource, Inbox};
use crate::code::Code;
use crate::cpu::Cpu;
use crate::cycle::Pace;
use crate::faults::{STOP_BY_CLIENT, STOP_BY_REQUEST};
use crate::force::Table;
use crate::io::{Driver, Simulated};
use crate::online::Service;
use crate::options::{ClockKind, HANG_LIMIT_DEFAULT, Restart, RunOptions};
use crate::probe::Watcher;
use crate::records::store::{self, Store};
use crate::remote::{self, Remote};
use crate::testing::NOT_REACHED;
use crate::trace::Recorder;
use crate::{diagnostics, files, realtime, report};
pub use debugged::{Ended, for_debugger, run_debugged};
use session::{Session, prepare};

/// The program stopped because it was asked to.
pub const EXIT_OK: u8 = 0;
/// The CPU went to STOP on a fault, or an expectation of the scenario failed.
pub const EXIT_FAULT: u8 = 1;
/// A flag or file is wrong.
pub const EXIT_USAGE: u8 = 2;

/// Writes a line to standard error; a closed one must not stop a plant.
macro_rules! say {
    ($($arg:tt)*) => {{
        let text = $crate::files::without_numbers(&std::fmt::format(format_args!($($arg)*)));
        let _ = std::io::Write::write_fmt(&mut std::io::stderr(), format_args!("{text}\n"));
    }};
}

pub(crate) use say;

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

/// Makes the code of a CPU.
pub type CodeMaker<'a> = &'a (dyn Fn() -> Rc<dyn Code> + Sync);

/// Runs a program by the runtime flags, on one CPU or on as many as they say. `service` answers clients of one CPU, also in STOP.
/// Result: exit code.
pub fn start(image: ProgramImage, code: CodeMaker, options: &RunOptions, service: Option<Box<dyn Service>>) -> u8 {
    match options.is_many() {
        true if service.is_some() => {
            say!("runtime: clients are answered by one CPU: leave out --instances");
            EXIT_USAGE
        }
        true => instances::run(image, code, options),
        false => run_with(image, code(), options, Extras { service, ..Extras::default() }),
    }
}

/// As [`start`] for one CPU, whose program can be changed while it runs.
pub fn start_changeable(
    image: ProgramImage,
    code: CodeSource,
    options: &RunOptions,
    service: Option<Box<dyn Service>>,
    inbox: Inbox,
) -> u8 {
    let first = code();
    run_with(image, first, options, Extras { service, changes: Some((inbox, code)), watcher: None })
}

/// What a run may have besides its program and flags.
#[derive(Default)]
struct Extras {
    service: Option<Box<dyn Service>>,
    watcher: Option<Rc<dyn Watcher>>,
    /// Where changes of the program come from, and what makes the code of the first one.
    changes: Option<(Inbox, CodeSource)>,
}

/// Runs a program on one CPU. Values go to standard output, messages to standard error. Result: exit code.
pub fn run(image: ProgramImage, code: Rc<dyn Code>, options: &RunOptions) -> u8 {
    run_with(image, code, options, Extras::default())
}

/// As [`run`], with someone who looks at the probes of the program.
pub fn run_watched(
    image: ProgramImage,
    code: Rc<dyn Code>,
    options: &RunOptions,
    watcher: Option<Rc<dyn Watcher>>,
) -> u8 {
    run_with(image, code, options, Extras { watcher, ..Extras::default() })
}

fn run_with(mut image: ProgramImage, code: Rc<dyn Code>, options: &RunOptions, extras: Extras) -> u8 {
    let Extras { service, watcher, changes } = extras;
    let planned = match recorded::plan(&mut image, options, service.is_some(), changes.is_some()) {
        Ok(planned) => planned,
        Err(message) => {
            say!("runtime: {message}");
            return EXIT_USAGE;
        }
    };
    let options = &planned.options;
    let mut cpu = Cpu::new(image, code, planned.clock, planned.driver);
    cpu.memory.show();
    if let Some(tape) = &planned.tape {
        cpu.set_tape(Rc::clone(tape));
    }
    if let Some(watcher) = &watcher {
        cpu.set_watcher(watcher.clone());
    }
    if let Err(message) = furnish(&cpu, options) {
        say!("runtime: {message}");
        return EXIT_USAGE;
    }
    let mut session = match prepare(&cpu, options, Box::new(std::io::stdout())) {
        Ok(prepared) => prepared,
        Err(message) => {
            say!("runtime: {message}");
            return EXIT_USAGE;
        }
    };
    if let Some((inbox, code)) = &changes {
        inbox.begin(&cpu, code.clone());
    }
    let inbox = changes.as_ref().map(|(inbox, _)| inbox);
    tell_partial(&cpu.image.partial, options.quiet);
    if let Err(message) = realtime(options) {
        say!("runtime: --realtime: {message}");
        return EXIT_USAGE;
    }
    watch_signals();
    let mut pace = pace(&cpu, options);
    // Also with --quiet: the user must know this to judge the values.
    for notice in &cpu.image.notices {
        say!("{notice}");
    }
    if let Some(service) = service {
        cpu.attach(service);
    }
    // Someone who sees nothing would take it for a program that hangs.
    if options.runs_on() && std::io::stderr().is_terminal() {
        say!("{} runs until Ctrl+C", cpu.image.name);
    }
    let mut cycles = 0;
    drive(&mut cpu, &pace, &mut session, options, inbox, &mut cycles);
    let taped = planned.tape.map(|tape| recorded::end(&tape, options, cycles));
    // A CPU in STOP answers its clients, and one of them may start it again.
    while cpu.is_stopped() && cpu.is_served.get() {
        stop_line(&cpu, options, cycles).iter().for_each(|line| say!("{line}"));
        let (next, is_started) = match wait_for_start(cpu, &mut session, options, inbox, watcher.as_ref()) {
            Ok(waited) => waited,
            Err(message) => {
                say!("runtime: {message}");
                return EXIT_USAGE;
            }
        };
        cpu = next;
        if !is_started {
            break;
        }
        if options.record.is_some() {
            say!("runtime: the recording ends with the STOP: what comes now is not in it");
        }
        if !options.quiet {
            say!("started again by a client");
        }
        pace.cycles = options.cycles.map(|all| all.saturating_sub(cycles));
        drive(&mut cpu, &pace, &mut session, options, inbox, &mut cycles);
    }
    finish(&cpu, options, session, cycles).max(taped.unwrap_or(EXIT_OK))
}

/// Lets a CPU in STOP answer its clients until one of them starts it again. Result: the CPU, and whether it was started. `Err`: what it needs
/// to start is missing.
fn wait_for_start(
    mut cpu: Rc<Cpu>,
    session: &mut Session,
    options: &RunOptions,
    inbox: Option<&Inbox>,
    watcher: Option<&Rc<dyn Watcher>>,
) -> Result<(Rc<Cpu>, bool), String> {
    let furnished = |cpu: &Cpu| {
        cpu.memory.show();
        if let Some(watcher) = watcher {
            cpu.set_watcher(watcher.clone());
        }
        furnish(cpu, options)
    };
    loop {
        match wait_in_stop(&mut cpu, session, options, inbox) {
            Some(Restart::Reset) => {
                cpu = Cpu::after_reset(cpu);
                if !options.quiet {
                    say!("memory reset by a client");
                }
                furnished(&cpu)?;
            }
            Some(kind) => {
                cpu = Cpu::restarted(cpu, kind);
                furnished(&cpu)?;
                return Ok((cpu, true));
            }
            None => return Ok((cpu, false)),
        }
    }
}

/// Startup and cycles, also of programs that take the place of the first one, until STOP or the end of the run.
fn drive(
    cpu: &mut Rc<Cpu>,
    pace: &Pace,
    session: &mut Session,
    options: &RunOptions,
    inbox: Option<&Inbox>,
    cycles: &mut u64,
) {
    let is_wanted = || inbox.is_some_and(Inbox::waits);
    let mut course = cpu.begin(pace, session);
    loop {
        cpu.go_on(&mut course, session, &is_wanted);
        if !(is_wanted() && change(cpu, session, options, inbox)) {
            break;
        }
    }
    cpu.end();
    *cycles += course.cycle();
}

/// Has a change of the program carried out. False: nothing waits.
fn change(cpu: &mut Rc<Cpu>, session: &mut Session, options: &RunOptions, inbox: Option<&Inbox>) -> bool {
    let Some(inbox) = inbox else { return false };
    let (waits, changed) = inbox.carry_out(cpu);
    if changed {
        session.renew(cpu, options);
    }
    waits
}

/// As [`Cpu::serve_in_stop`]; the program may be changed meanwhile.
fn wait_in_stop(
    cpu: &mut Rc<Cpu>,
    session: &mut Session,
    options: &RunOptions,
    inbox: Option<&Inbox>,
) -> Option<Restart> {
    loop {
        let kind = cpu.serve_in_stop(&|| inbox.is_some_and(Inbox::waits));
        if kind.is_some() || !change(cpu, session, options, inbox) {
            return kind;
        }
    }
}

/// Gives a CPU what the flags name: ports, folders, files.
fn furnish(cpu: &Cpu, options: &RunOptions) -> Result<(), String> {
    // After a restart what is forced stays so.
    if !cpu.is_restarted {
        match (&options.force, &cpu.image.config.retain.file) {
            (Some(path), _) => cpu.force_from(path, Table::Named)?,
            (None, Some(file)) => cpu.force_from(Path::new(&format!("{file}.force")), Table::Kept)?,
            (None, None) => {}
        }
        if cpu.is_forcing() {
            let all: Vec<String> = cpu.forced().iter().map(|one| format!("{} = {}", one.name, one.value)).collect();
            say!("forced: {}", all.join(", "));
        }
    }
    if let Some(port) = options.iso_port {
        cpu.communication.borrow_mut().set_iso_port(port);
    }
    if !options.looks {
        let folder = store::folder(options.data.as_deref(), cpu.image.config.data_folder.as_deref());
        cpu.set_store(Store::new(folder));
    }
    // After a restart the file goes on.
    if let (Some(path), false) = (&options.alarm_log, cpu.is_restarted) {
        let file = files::writable(path).and_then(|()| File::create(path));
        cpu.alarms.borrow_mut().write_to(file.map_err(|error| format!("{}: {error}", path.display()))?);
    }
    Ok(())
}

/// The driver: devices only under the real clock, for they know no other.
fn driver(image: &ProgramImage, options: &RunOptions) -> Result<Box<dyn Driver>, String> {
    let (modules, stations) = (image.config.modules.clone(), &image.config.remote);
    match (stations.is_empty(), options.clock) {
        (true, _) => Ok(Box::new(Simulated::new(modules))),
        (false, ClockKind::Virtual) => {
            say!("the devices of `[io]` are simulated under the virtual clock");
            Ok(Box::new(Simulated::new(modules)))
        }
        (false, ClockKind::Real) => {
            if !options.quiet {
                remote::opened(stations).for_each(|line| say!("{line}"));
            }
            Ok(Box::new(Remote::new(modules, stations)?))
        }
    }
}

fn pace(cpu: &Cpu, options: &RunOptions) -> Pace {
    Pace {
        cycles: options.cycles,
        cycle_time: options.cycle_time.map_or_else(|| cpu.cycle_time(), |time| time.0),
        hang_limit: options.hang_limit.unwrap_or(HANG_LIMIT_DEFAULT).0,
    }
}

/// Does what `--realtime` asks for. Under the virtual clock cycles follow each other without a pause: at the priority of real time they
/// would keep the computer from everything else.
fn realtime(options: &RunOptions) -> Result<(), String> {
    match (options.realtime, options.clock) {
        (false, _) => Ok(()),
        (true, ClockKind::Real) => realtime::enter(),
        (true, ClockKind::Virtual) => {
            Err("the virtual clock does not wait; leave out one of the two flags".to_string())
        }
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

fn finish(cpu: &Cpu, options: &RunOptions, mut session: Session, cycles: u64) -> u8 {
    let mut exit = if session.end_trace(cpu) { EXIT_OK } else { EXIT_USAGE };
    let printed = &session.printed;
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
    if let Some(table) = &session.watch {
        let mut out = std::io::stdout().lock();
        let written = out.write_all(table.text(cpu).as_bytes()).and_then(|()| out.flush());
        if let Err(error) = written.or_else(|error| if is_closed(&error) { Ok(()) } else { Err(error) }) {
            say!("runtime: cannot write to standard output: {error}");
            exit = EXIT_USAGE;
        }
    }
    let (lines, fault) = verdict(cpu, options, &session, cycles);
    lines.iter().for_each(|line| say!("{line}"));
    if fault {
        exit = exit.max(EXIT_FAULT);
    }
    if options.diag {
        for entry in cpu.diagnostics.newest_first() {
            say!("{}", diagnostics::line(&cpu.image, &entry));
        }
    }
    // Errors that leave an S7-200 in RUN are easily missed.
    if options.diag || !options.quiet && cpu.stopped().is_none_or(|stop| stop.asked) {
        cpu.s7200_error_report().iter().for_each(|line| say!("{line}"));
    }
    if let Some(Err(error)) = session.recorder.map(Recorder::finish) {
        say!("runtime: the trace is incomplete: {error}");
        exit = EXIT_USAGE;
    }
    exit
}

/// How the run ended: expectations that were not met, why the CPU is in STOP. And whether one of them is a fault.
fn verdict(cpu: &Cpu, options: &RunOptions, session: &Session, cycles: u64) -> (Vec<String>, bool) {
    let (mut lines, mut fault) = (Vec::new(), false);
    for failure in session.player.failures() {
        if options.looks && failure.left == NOT_REACHED {
            continue;
        }
        let place = failure.place().map(|place| format!(" {place}")).unwrap_or_default();
        let beside = match failure.beside.is_empty() {
            true => String::new(),
            false => format!("; other values: {}", failure.beside.join(", ")),
        };
        let (file, line, text) = (&failure.file, failure.line, &failure.text);
        lines.push(format!("{file}:{line}: expected {text}, but it is {}{place}{beside}", failure.left));
        fault = true;
    }
    fault |= cpu.stopped().is_some_and(|stop| !stop.asked);
    // With clients it was told when the CPU stopped.
    if !(cpu.is_stopped() && cpu.is_served.get()) {
        let stopper = if fault { session.player.stopper() } else { String::new() };
        lines.extend(stop_line(cpu, options, cycles).map(|line| line + &stopper));
    }
    (lines, fault)
}

/// Why the CPU is in STOP, or that it has reached its end.
fn stop_line(cpu: &Cpu, options: &RunOptions, cycles: u64) -> Option<String> {
    let line = match cpu.stopped() {
        Some(stop) if !stop.asked => return Some(cpu.stop_text(&stop)),
        Some(stop) if stop.entry.event == STOP_BY_REQUEST => "ended in startup".to_string(),
        Some(stop) if stop.entry.event == STOP_BY_CLIENT => format!("stopped by a client after {}", counted(cycles)),
        Some(_) => format!("stopped by the program after {}", counted(cycles)),
        None => format!("ended after {}", counted(cycles)),
    };
    (!options.quiet).then_some(line)
}

/// `1 cycle`, `12 cycles`.
fn counted(cycles: u64) -> String {
    plcc_literal::count::counted(cycles as usize, "cycle")
}
