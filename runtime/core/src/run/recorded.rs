//! `--record` and `--replay`: the clock, the modules and the flags of a run that is recorded or repeated.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use plcc_abi::ProgramImage;

use super::{EXIT_FAULT, EXIT_OK, EXIT_USAGE, counted, driver, say};
use crate::clock::Clock;
use crate::io::Driver;
use crate::options::{ClockKind, Duration, RunOptions};
use crate::tape::{Devices, Head, Noted, Notes, Recording, Tape, repeated_driver};

/// What a run needs from outside.
pub(super) struct Planned {
    pub options: RunOptions,
    pub clock: Clock,
    pub driver: Box<dyn Driver>,
    pub tape: Option<Rc<Tape>>,
}

/// Settles what a run needs. `Err`: what cannot be recorded or repeated, and other wrong flags.
pub(super) fn plan(
    image: &mut ProgramImage,
    options: &RunOptions,
    has_clients: bool,
    is_changeable: bool,
) -> Result<Planned, String> {
    options.configure(&mut image.config);
    if is_changeable && (options.record.is_some() || options.replay.is_some()) {
        return Err(
            "--record, --replay: not for a program that is changed while it runs; leave out --watch".to_string()
        );
    }
    match (&options.record, &options.replay) {
        (Some(path), _) => record(image, options, path).map_err(|error| format!("--record: {error}")),
        (None, Some(_)) if has_clients => {
            Err("--replay: the clients of a repeated run are those of the recording".to_string())
        }
        (None, Some(path)) => {
            let recording = Rc::new(Recording::read(path).map_err(|error| format!("--replay: {error}"))?);
            if let Some(why) = &recording.cut {
                say!("--replay: {}: {why}; the {} cycles before are repeated", path.display(), recording.cycles());
            }
            replay(image, options, &recording).map_err(|error| format!("--replay: {error}"))
        }
        (None, None) => {
            let clock = match options.clock {
                ClockKind::Real => Clock::real(),
                ClockKind::Virtual => Clock::simulated(),
            };
            Ok(Planned { options: options.clone(), clock, driver: driver(image, options)?, tape: None })
        }
    }
}

fn record(image: &ProgramImage, options: &RunOptions, path: &Path) -> Result<Planned, String> {
    refuse(&[
        (options.clock == ClockKind::Virtual, "a run on the virtual clock can be repeated without a recording"),
        (options.force.is_some(), "forced values are not recorded; leave out --force"),
        (image.config.retain.file.is_some(), "a recording begins without retentive memory; leave out the file for it"),
    ])?;
    let has_devices = !image.config.remote.is_empty();
    let inner = driver(image, options)?;
    let devices = if has_devices { Devices::at_start(&*inner) } else { Devices::default() };
    let wall = Clock::real().wall();
    let cycle_time = image.config.cycle_time_ms.map(|ms| u64::from(ms) * crate::clock::NS_PER_MS);
    let default = cycle_time.unwrap_or(crate::options::CYCLE_TIME_DEFAULT.0);
    let head = Head {
        program: Head::fingerprint(image),
        wall,
        cycle_time: options.cycle_time.map_or(default, |time| time.0),
        set: options.set.clone(),
        scenario: absolute(options.scenario.as_ref())?,
        watch_table: absolute(options.watch_table.as_ref())?,
        stop_on_error: options.stop_on_error,
        startup: image.config.startup,
        devices,
    };
    let notes = Rc::<Notes>::default();
    let driver = Box::new(Noted { inner, notes: Rc::clone(&notes), has_devices });
    let tape = Rc::new(Tape::record(path, &head, notes)?);
    Ok(Planned { options: options.clone(), clock: Tape::clock(wall), driver, tape: Some(tape) })
}

fn replay(image: &mut ProgramImage, options: &RunOptions, recording: &Rc<Recording>) -> Result<Planned, String> {
    let options = repeated(image, options, recording)?;
    let driver = repeated_driver(image, recording);
    let tape = Some(Rc::new(Tape::replay(Rc::clone(recording))));
    Ok(Planned { options, clock: Tape::clock(recording.head.wall), driver, tape })
}

/// The flags of a repeated run. `Err`: the recording is one of another program, or a flag is a matter of the recording.
pub(super) fn repeated(
    image: &mut ProgramImage,
    options: &RunOptions,
    recording: &Recording,
) -> Result<RunOptions, String> {
    let head = &recording.head;
    refuse(&[
        (
            head.program != Head::fingerprint(image),
            "the recording is one of another program, or of another version of it",
        ),
        (!options.set.is_empty(), "--set is in the recording"),
        (options.scenario.is_some(), "--scenario is in the recording"),
        (options.watch_table.is_some(), "--watch-table is in the recording"),
        (options.cycle_time.is_some(), "--cycle-time is in the recording"),
        (options.restart.is_some(), "--restart is in the recording"),
        (options.force.is_some(), "--force: a recording has no forced values"),
        (options.retain.is_some(), "--retain: a recording begins without retentive memory"),
        (options.realtime, "--realtime: a repeated run does not wait for the clock"),
    ])?;
    image.config.startup = head.startup;
    image.config.retain.file = None;
    image.config.s7200.stop_on_error |= head.stop_on_error;
    Ok(RunOptions {
        cycle_time: Some(Duration(head.cycle_time)),
        set: head.set.clone(),
        scenario: head.scenario.as_ref().map(PathBuf::from),
        watch_table: head.watch_table.as_ref().map(PathBuf::from),
        clock: ClockKind::Virtual,
        ..options.clone()
    })
}

/// `Err`: the text of the first that is true.
fn refuse(list: &[(bool, &str)]) -> Result<(), String> {
    list.iter().find(|(is_so, _)| *is_so).map_or(Ok(()), |(_, why)| Err((*why).to_string()))
}

fn absolute(path: Option<&PathBuf>) -> Result<Option<String>, String> {
    let one = |path: &PathBuf| std::path::absolute(path).map(|path| path.display().to_string());
    path.map(one).transpose().map_err(|error| error.to_string())
}

/// The end of a run that was recorded or repeated. Result: exit code.
pub(super) fn end(tape: &Tape, options: &RunOptions, cycles: u64) -> u8 {
    tape.finish();
    let is_recorded = options.record.is_some();
    match tape.failure() {
        Some(failure) => {
            say!("runtime: {failure}");
            if is_recorded { EXIT_USAGE } else { EXIT_FAULT }
        }
        None if options.quiet => EXIT_OK,
        None if is_recorded => {
            say!("recorded {}", counted(cycles));
            EXIT_OK
        }
        None => {
            let each = if cycles == 1 { "" } else { "each of " };
            say!("memory was as recorded after {each}{}", counted(cycles));
            EXIT_OK
        }
    }
}
