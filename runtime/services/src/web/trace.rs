//! Recordings of a page: what it asks for, and what it gets as the recording grows.

use plcc_runtime::cpu::Cpu;
use plcc_runtime::monitor::recording::{Plan, Progress, SAMPLES_MAX, SIGNALS_MAX, Trigger};
use serde::{Deserialize, Serialize};

use super::session::source;
use crate::limits::SAMPLES_SENT_MAX;
use crate::link::Link;

/// What is to be recorded.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wanted {
    /// Names; without any no recording runs.
    pub signals: Vec<String>,
    #[serde(default)]
    pub trigger: Option<Crossing>,
    #[serde(default)]
    pub samples: Option<usize>,
    /// Percent of the samples that are from before the trigger.
    #[serde(default)]
    pub before: u8,
}

/// A signal crosses a level.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Crossing {
    /// Number of the signal.
    pub signal: usize,
    pub level: f64,
    pub rising: bool,
}

/// A part of a recording.
#[derive(Debug, Serialize)]
pub struct Part {
    /// Samples: cycle, milliseconds, number of the signal, value.
    pub samples: Vec<(u64, f64, u8, Option<f64>)>,
    /// `waiting` for the trigger, `running`, `full`, or `lost` because the CPU was restarted.
    pub state: &'static str,
    /// Milliseconds of the CPU's clock.
    pub now: f64,
    /// Number of samples before the trigger.
    pub before: usize,
    /// The values of the signals before the first sample.
    pub base: Vec<Option<f64>>,
}

/// The recording of a page.
pub struct Recorder {
    link: Link,
    client: u64,
    is_running: bool,
    told: usize,
    state: &'static str,
}

impl Recorder {
    pub fn new(link: Link, client: u64) -> Recorder {
        Recorder { link, client, is_running: false, told: 0, state: "" }
    }

    /// Begins a recording in place of the one that runs, or ends that. `Err`: why not.
    pub async fn start(&mut self, wanted: Wanted) -> Result<(), String> {
        self.stop().await;
        if wanted.signals.is_empty() {
            return Ok(());
        }
        if wanted.signals.len() > SIGNALS_MAX {
            return Err(format!("a recording has at most {SIGNALS_MAX} signals"));
        }
        let client = self.client;
        let done = self.link.ask(move |cpu| plan(cpu, &wanted).map(|plan| cpu.start_recording(client, plan))).await;
        done.unwrap_or(Ok(()))?;
        self.link.keep_awake(true);
        (self.is_running, self.told, self.state) = (true, 0, "");
        Ok(())
    }

    /// Ends the recording that runs.
    pub async fn stop(&mut self) {
        if std::mem::take(&mut self.is_running) {
            self.link.keep_awake(false);
            let client = self.client;
            self.link.ask(move |cpu| cpu.stop_recording(client)).await;
        }
    }

    /// How many samples are known, if a recording runs.
    pub fn asked(&self) -> Option<usize> {
        self.is_running.then_some(self.told)
    }

    /// What is new.
    pub fn news(&mut self, progress: Option<Progress>) -> Option<Part> {
        if !self.is_running || self.state == "lost" {
            return None;
        }
        let Some(progress) = progress else {
            self.state = "lost";
            return Some(Part { samples: Vec::new(), state: self.state, now: 0.0, before: 0, base: Vec::new() });
        };
        let state = match (progress.triggered, progress.is_full && progress.samples.len() < SAMPLES_SENT_MAX) {
            (None, _) => "waiting",
            (Some(_), true) => "full",
            (Some(_), false) => "running",
        };
        let is_news = !progress.samples.is_empty() || state != self.state || state == "running";
        self.told += progress.samples.len();
        self.state = state;
        let ms = |ns: u64| ns as f64 / 1e6;
        let told = |sample: &plcc_runtime::monitor::recording::Sample| {
            // JSON has no NaN.
            (sample.cycle, ms(sample.time), sample.signal, Some(sample.value).filter(|value| value.is_finite()))
        };
        let samples = progress.samples.iter().map(told).collect();
        let base = progress.base.iter().map(|value| Some(*value).filter(|value| value.is_finite())).collect();
        is_news.then(|| Part { samples, state, now: ms(progress.now.1), before: progress.triggered.unwrap_or(0), base })
    }
}

fn plan(cpu: &Cpu, wanted: &Wanted) -> Result<Plan, String> {
    let signals = wanted.signals.iter().map(|name| source(cpu, name)).collect::<Result<Vec<_>, _>>()?;
    let trigger = match &wanted.trigger {
        None => None,
        Some(crossing) if crossing.signal >= signals.len() => {
            return Err("the trigger is not one of the signals".to_string());
        }
        Some(crossing) => Some(Trigger { signal: crossing.signal, level: crossing.level, rising: crossing.rising }),
    };
    let samples = wanted.samples.unwrap_or(SAMPLES_MAX).clamp(1, SAMPLES_MAX);
    let before = samples * usize::from(wanted.before.min(100)) / 100;
    Ok(Plan { signals, trigger, samples, before })
}
