//! One look at the CPU, at a cycle control point: all that a page wants to know of one cycle.

use std::sync::Arc;

use plcc_abi::ProgramImage;
use plcc_runtime::cpu::Cpu;
use plcc_runtime::datetime::NS_PER_S;
use plcc_runtime::monitor::Looked;
use plcc_runtime::monitor::recording::Progress;
use plcc_runtime::signal::{Source, Value};
use plcc_runtime::watch::format::Format;
use plcc_runtime::{diagnostics, force};

use super::watched::{Watched, find};
use crate::limits::SAMPLES_SENT_MAX;
use crate::web::messages::{Entry, State};

/// What the CPU said at one cycle control point.
pub(super) struct Seen {
    pub(super) state: State,
    /// Place in the list of what was found, and value, or why there is none at present. What is shown of them is found out elsewhere: the
    /// cycle waits for it.
    pub(super) values: Vec<(usize, Result<Value, String>)>,
    pub(super) renewed: Option<Renewed>,
    /// The diagnostic buffer, if its newest entry is another one.
    pub(super) buffer: Option<Vec<diagnostics::Entry>>,
    pub(super) forced: Vec<force::Forced>,
    /// Values that the job of the page still writes.
    pub(super) job: usize,
    /// Number of events so far, as far as the buffer tells.
    pub(super) newest: Newest,
    /// What the watched block has seen.
    pub(super) looked: Option<Looked>,
    pub(super) recording: Option<Progress>,
}

/// What has become different because the program has changed.
pub(super) struct Renewed {
    /// The names have other places.
    pub(super) watched: Watched,
    /// Why some no longer mean anything.
    pub(super) wrong: Vec<(usize, String)>,
    pub(super) image: Arc<ProgramImage>,
}

/// What of the running program a page watches: a block and a call of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Target {
    Nothing,
    Block(String, Option<String>),
    /// The runs of organization blocks.
    Obs,
}

/// Tells whether the buffer has changed: number of entries and the newest one.
pub(super) type Newest = Option<(usize, diagnostics::Entry)>;

/// All that a page wants to know, of one cycle.
pub(super) fn look(
    cpu: &Cpu,
    watched: &Watched,
    before: Newest,
    client: u64,
    target: &Target,
    asked: Option<usize>,
) -> Seen {
    let looked = if *target == Target::Nothing { None } else { cpu.look_at_block(client) };
    if looked.is_none() && *target != Target::Nothing {
        // The CPU was restarted, or its program changed.
        let _ = watch_program(cpu, client, target);
    }
    let recording = asked.and_then(|told| cpu.recorded(client, told, SAMPLES_SENT_MAX));
    let renewed = (cpu.generation() != watched.generation).then(|| {
        let (watched, wrong) = find(&cpu.image, watched.wanted.clone()).of(cpu, &cpu.image);
        Renewed { watched, wrong, image: cpu.image.clone() }
    });
    let watched = renewed.as_ref().map_or(watched, |renewed| &renewed.watched);
    let value = |(place, (_, source, format)): (usize, &(usize, Source, Option<Format>))| {
        let value = match (source.absent(cpu), format, source.address()) {
            (Some(why), ..) => Err(why),
            (None, Some(_), Some(address)) => Ok(Value::Bits(cpu.read(address), address.width)),
            (None, ..) => Ok(source.read(cpu, None)),
        };
        (place, value)
    };
    let values = watched.found.iter().enumerate().map(value).collect();
    let entries = cpu.diagnostics.newest_first();
    let newest = entries.first().map(|entry| (entries.len(), *entry));
    let buffer = (newest != before).then_some(entries);
    let forced = if cpu.is_forcing() { cpu.forced() } else { Vec::new() };
    let job = cpu.job_rows(client);
    Seen { state: state(cpu), values, renewed, buffer, forced, job, newest, looked, recording }
}

/// Begins or ends to watch the running program.
pub(super) fn watch_program(cpu: &Cpu, client: u64, target: &Target) -> Result<(), String> {
    match target {
        Target::Block(block, call) => return cpu.watch_block(client, block, call.as_deref()),
        Target::Obs => cpu.watch_obs(client),
        Target::Nothing => cpu.unwatch_block(client),
    }
    Ok(())
}

fn state(cpu: &Cpu) -> State {
    let reason = cpu.stopped().map(|stop| diagnostics::event_text(&cpu.image, &stop.entry));
    State {
        running: !cpu.is_stopped(),
        reason: reason.unwrap_or_default(),
        outputs: cpu.has_enabled_outputs(),
        cycle: cpu.cycle_number(),
        generation: cpu.generation(),
        clock: milliseconds(cpu.clock.wall()),
    }
}

pub(super) fn entry(image: &ProgramImage, entry: &diagnostics::Entry) -> Entry {
    Entry {
        clock: milliseconds(entry.wall),
        event: entry.event,
        text: diagnostics::event_text(image, entry),
        place: diagnostics::place_text(image, entry),
    }
}

/// A moment of the CPU's clock in milliseconds, as a page computes with it.
fn milliseconds(wall: i64) -> f64 {
    wall as f64 / (NS_PER_S / 1000) as f64
}
