//! The trace of a watch table: its signals in the cycles in which one of them changes, from before an event on.

use std::path::{Path, PathBuf};

use plcc_abi::image::AssertType;

use super::{Signal, sink};
use crate::address::Width;
use crate::cpu::Cpu;
use crate::monitor::recording::{Plan, Recording, SAMPLES_MAX, SIGNALS_MAX, Sample, Trigger};
use crate::signal::{Shape, Source, Value};

/// What is to be recorded.
#[derive(Clone, Debug)]
pub struct Wanted {
    pub file: PathBuf,
    /// Names with their sources.
    pub signals: Vec<Signal>,
    pub trigger: Option<Trigger>,
    pub samples: usize,
    pub before: usize,
}

impl Wanted {
    /// Checks what a user wants. `Err`: what is wrong.
    pub fn check(&self) -> Result<(), String> {
        let suffix = self.file.extension().and_then(|suffix| suffix.to_str()).unwrap_or("").to_ascii_lowercase();
        let is_number = |signal: &&Signal| signal.source.shape() != Shape::Text && fits(&signal.source);
        let other = self.signals.iter().find(|signal| !is_number(signal));
        let folder = self.file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        match () {
            () if !matches!(suffix.as_str(), "csv" | "vcd" | "html") => {
                Err(format!("`{}` must end in .csv, .vcd or .html", self.file.display()))
            }
            () if !folder.is_dir() => {
                Err(format!("`{}` cannot be written: there is no folder {}", self.file.display(), folder.display()))
            }
            () if self.signals.is_empty() => Err("a trace has at least one signal".to_string()),
            () if self.signals.len() > SIGNALS_MAX => Err(format!("a trace has at most {SIGNALS_MAX} signals")),
            () if !(1..=SAMPLES_MAX).contains(&self.samples) => {
                Err(format!("a trace has 1 to {SAMPLES_MAX} samples, not {}", self.samples))
            }
            () if self.before >= self.samples => {
                Err(format!("{} samples from before the trigger leave none after it", self.before))
            }
            () => match other {
                Some(signal) => Err(format!(
                    "{} is not recorded: only bits and numbers of up to 32 bits, LREAL and LTIME are",
                    signal.name
                )),
                None => Ok(()),
            },
        }
    }
}

/// A trace that runs.
pub struct Triggered {
    wanted: Wanted,
    /// `None`: it is written.
    recording: Option<Recording>,
}

impl Triggered {
    pub fn new(wanted: Wanted) -> Triggered {
        let sources: Vec<Source> = wanted.signals.iter().map(|signal| signal.source).collect();
        let plan = Plan { signals: sources, trigger: wanted.trigger, samples: wanted.samples, before: wanted.before };
        Triggered { wanted, recording: Some(Recording::new(0, plan)) }
    }

    /// After a cycle. The file is written as soon as there are all samples. `Some`: what to tell the user; `Err`: it cannot be written.
    pub fn look(&mut self, cpu: &Cpu) -> Option<Result<String, String>> {
        let recording = self.recording.as_mut()?;
        recording.look(cpu);
        if recording.is_full() { self.finish(cpu) } else { None }
    }

    /// The run is over, or the program changes: writes what there is. `None`: it is already written.
    pub fn finish(&mut self, cpu: &Cpu) -> Option<Result<String, String>> {
        let recording = self.recording.take()?;
        let progress = recording.progress(cpu, 0, SAMPLES_MAX);
        let path = self.wanted.file.display();
        let Some(before) = progress.triggered else {
            return Some(Ok(format!("{path} is not written: the trigger has not come")));
        };
        let written = write(&self.wanted.file, &self.wanted.signals, &progress.base, &progress.samples);
        let count = progress.samples.len();
        let before =
            if self.wanted.trigger.is_some() { format!(", {before} from before the trigger") } else { String::new() };
        let samples = plcc_literal::count::counted(count, "sample");
        Some(written.map(|()| format!("{path}: {samples}{before}")))
    }
}

/// Writes a row for each cycle with a sample: all values after it.
fn write(path: &Path, signals: &[Signal], base: &[f64], samples: &[Sample]) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("{}: {error}", path.display());
    let mut sink = sink(path, signals)?;
    let mut now = base.to_vec();
    for cycle in samples.chunk_by(|a, b| a.cycle == b.cycle) {
        for sample in cycle {
            now[usize::from(sample.signal)] = sample.value;
        }
        let Some(first) = cycle.first() else { continue };
        let values: Vec<Value> = signals.iter().zip(&now).map(|(signal, now)| value(&signal.source, *now)).collect();
        sink.sample(first.cycle, first.time, &values).map_err(failed)?;
    }
    sink.finish().map_err(failed)
}

/// The value that a sample stands for.
fn value(source: &Source, number: f64) -> Value {
    match (source, source.shape()) {
        (_, Shape::Bits(width)) => Value::Bits(number as u64, width),
        (Source::Typed(_, ty), _) if is_whole(ty.ty) => Value::Whole(number as i128),
        (_, Shape::Long { .. } | Shape::Number | Shape::Text) => Value::Number(number),
    }
}

fn is_whole(ty: AssertType) -> bool {
    matches!(ty, AssertType::Signed(_) | AssertType::Unsigned(_) | AssertType::Bits(_))
}

/// Samples are numbers with 53 bits.
fn fits(source: &Source) -> bool {
    match source {
        Source::Bits(address) => address.width != Width::Lword,
        Source::Typed(address, ty) => !is_whole(ty.ty) || address.width != Width::Lword,
        Source::Channel(..)
        | Source::Plant(_)
        | Source::PulseDuty(_)
        | Source::PulsePeriod(_)
        | Source::PulseCount(_) => true,
    }
}
