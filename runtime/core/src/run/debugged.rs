//! A run that a debugger watches: on the virtual clock, without files and devices, so that it can be repeated.

use std::io::Write;
use std::rc::Rc;
use std::sync::Arc;

use plcc_abi::ProgramImage;

use super::session::{Session, prepare};
use super::{pace, tell_partial, verdict};
use crate::clock::Clock;
use crate::code::Code;
use crate::cpu::Cpu;
use crate::cycle::Observer;
use crate::io::{Driver, Simulated};
use crate::options::{Duration, RunOptions};
use crate::probe::{Phase, Watcher};
use crate::tape::{Recording, Tape, repeated_driver};

/// How a run ended.
#[derive(Clone, Debug, Default)]
pub struct Ended {
    pub cycles: u64,
    /// Expectations that were not met, and why the CPU is in STOP.
    pub lines: Vec<String>,
    /// One of them is a fault.
    pub fault: bool,
}

/// A person thinks longer than any cycle may last: host time is not limited.
const NO_HANG_LIMIT: Duration = Duration(u64::MAX / 4);

/// Runs a program under the eyes of `watcher`. What a scenario prints goes to `out`. Retentive memory and the files of the program are those of
/// this run alone. `Err`: a flag or file is wrong.
pub fn run_debugged(
    image: &Arc<ProgramImage>,
    code: Rc<dyn Code>,
    options: &RunOptions,
    watcher: &Rc<dyn Watcher>,
    out: Box<dyn Write>,
    recording: Option<&Rc<Recording>>,
) -> Result<Ended, String> {
    let options = RunOptions { hang_limit: Some(NO_HANG_LIMIT), quiet: false, ..options.clone() };
    let driver: Box<dyn Driver> = match recording {
        Some(recording) => repeated_driver(image, recording),
        None => Box::new(Simulated::new(image.config.modules.clone())),
    };
    let clock = recording.map_or_else(Clock::simulated, |recording| Tape::clock(recording.head.wall));
    let cpu = Cpu::new(Arc::clone(image), code, clock, driver);
    if let Some(recording) = recording {
        cpu.set_tape(Rc::new(Tape::replay(Rc::clone(recording))));
    }
    cpu.set_watcher(Rc::clone(watcher));
    let mut session = prepare(&cpu, &options, out)?;
    // The program runs once more for each way back.
    session.triggered = None;
    let mut told = Told { session, watcher };
    tell_partial(&cpu.image.partial, true);
    let cycles = cpu.execute(&pace(&cpu, &options), &mut told);
    watcher.phase(&cpu, Phase::Over);
    let (mut lines, mut fault) = verdict(&cpu, &options, &told.session, cycles);
    if let Some(failure) = cpu.tape().and_then(Tape::failure) {
        (lines, fault) = ([lines, vec![failure]].concat(), true);
    }
    Ok(Ended { cycles, lines, fault })
}

/// The image and the flags for [`run_debugged`]: retentive memory is in no file. `Err`: the recording is one of another program.
pub fn for_debugger(
    mut image: ProgramImage,
    options: &RunOptions,
    recording: Option<&Rc<Recording>>,
) -> Result<(Arc<ProgramImage>, RunOptions), String> {
    options.configure(&mut image.config);
    image.config.retain.file = None;
    let options = match recording {
        Some(recording) => super::recorded::repeated(&mut image, options, recording)?,
        None => options.clone(),
    };
    Ok((Arc::new(image), options))
}

/// Tells the watcher the phases of the cycle.
struct Told<'a> {
    session: Session,
    watcher: &'a Rc<dyn Watcher>,
}

impl Observer for Told<'_> {
    fn before(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        self.watcher.phase(cpu, Phase::Before);
        self.session.before(cpu, cycle, time);
    }

    fn begin(&mut self, cpu: &Cpu, cycle: u64) {
        self.session.begin(cpu, cycle);
        self.watcher.phase(cpu, Phase::Begin);
    }

    fn end(&mut self, cpu: &Cpu, cycle: u64) {
        self.session.end(cpu, cycle);
    }

    fn after(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        self.session.after(cpu, cycle, time);
        self.watcher.phase(cpu, Phase::After);
    }
}
