//! What the flags of a run name, made for one CPU: values that are set, printed and recorded, and the scenario.

use std::io::Write;

use plcc_abi::image::Family;

use crate::cpu::Cpu;
use crate::cycle::Observer;
use crate::options::{Restart, RunOptions, split_list};
use crate::plant::Plant;
use crate::scenario::{Player, Scenario};
use crate::signal::{self, Signal, Source, Value};
use crate::trace::triggered::Triggered;
use crate::trace::{self, Recorder};
use crate::watch::{Table, Trigger};

/// Everything that flags name, checked.
pub(super) struct Session {
    set: Vec<(Source, Value)>,
    /// Time of the last cycle in nanoseconds.
    pub last: u64,
    pub player: Player,
    pub recorder: Option<Recorder>,
    /// The values that are printed at the end.
    pub printed: Vec<Signal>,
    /// The watch table.
    pub watch: Option<Table>,
    /// The trace of the watch table.
    pub triggered: Option<Triggered>,
    /// It could not be written.
    trace_failed: bool,
}

impl Observer for Session {
    fn before(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        if cycle == 0 {
            return self.before_startup(cpu, time);
        }
        self.player.before(cpu, cycle, time);
    }

    fn begin(&mut self, cpu: &Cpu, cycle: u64) {
        if let Some(table) = &self.watch {
            table.modify(cpu, cycle, Trigger::Begin);
        }
    }

    fn end(&mut self, cpu: &Cpu, cycle: u64) {
        if let Some(table) = &self.watch {
            table.modify(cpu, cycle, Trigger::End);
        }
    }

    fn after(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        self.last = time;
        if !(self.player.is_idle() && self.recorder.is_none() && self.triggered.is_none()) {
            self.look(cpu, cycle, time);
        }
    }

    fn rests(&self) -> bool {
        self.player.rests() && self.recorder.is_none() && self.triggered.is_none() && self.watch.is_none()
    }
}

impl Session {
    /// Further values to be set.
    pub fn set(&mut self, values: Vec<(Source, Value)>) {
        self.set.extend(values);
    }

    /// The program has changed: names mean places of the new one. What it does not have is reported and left out.
    pub fn renew(&mut self, cpu: &Cpu, options: &RunOptions) {
        self.end_trace(cpu);
        self.printed.clear();
        for name in split_list(&options.print) {
            match signals(cpu, self.player.plant(), std::slice::from_ref(&name)) {
                Ok(found) => self.printed.extend(found),
                Err(message) => super::say!("runtime: --print {message}"),
            }
        }
        if let Some(path) = options.watch_table.as_deref().filter(|_| self.watch.is_some()) {
            match Table::read(path, cpu) {
                Ok(table) => self.watch = Some(table),
                Err(message) => {
                    super::say!("runtime: the watch table is left out: {message}");
                    self.watch = None;
                }
            }
        }
    }

    /// Writes what the trace of the watch table has. False: the file cannot be written.
    pub fn end_trace(&mut self, cpu: &Cpu) -> bool {
        self.trace_failed |= self.triggered.take().is_some_and(|mut trace| !tell(trace.finish(cpu)));
        !self.trace_failed
    }

    /// The values of `--set`, and what the scenario sets first.
    #[cold]
    fn before_startup(&mut self, cpu: &Cpu, time: u64) {
        for (source, value) in &self.set {
            // Checked when the session was made.
            let _ = source.write(cpu, value);
        }
        self.player.before(cpu, 0, time);
    }

    /// Scenario and traces after a cycle.
    #[inline(never)]
    fn look(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        self.player.after(cpu, cycle, time);
        if self.recorder.is_some() {
            self.record(cpu, cycle, time);
        }
        if let Some(trace) = &mut self.triggered {
            self.trace_failed |= !tell(trace.look(cpu));
        }
    }

    /// A sample of the trace.
    #[inline(never)]
    fn record(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        if let Some(recorder) = &mut self.recorder {
            recorder.sample(cpu, self.player.plant(), cycle, time);
        }
    }
}

/// Everything that the flags name. What a scenario prints goes to `out`.
pub(super) fn prepare(cpu: &Cpu, options: &RunOptions, out: Box<dyn Write>) -> Result<Session, String> {
    if options.restart == Some(Restart::Hot) && cpu.image.profile.family != Family::S7400 {
        return Err("--restart hot: only a CPU of the S7-400 has hot restarts; write --restart warm, or leave it out"
            .to_string());
    }
    if options.restart == Some(Restart::Cold) && !cpu.image.profile.family.has_cold_restart() {
        let family = if cpu.image.profile.family == Family::S7200 { "S7-200" } else { "S7-1200/1500" };
        let other = "--restart reset gives retentive data their start values once";
        return Err(format!("--restart cold: an {family} has no cold restart; {other}"));
    }
    if options.stop_on_error && cpu.image.profile.family != Family::S7200 {
        return Err("--stop-on-error is about errors after which an S7-200 goes on; leave it out".to_string());
    }
    cpu.check_retentive_file()?;
    let scenario = options.scenario.as_deref().map(|path| Scenario::read(path, &cpu.image)).transpose()?;
    let player = Player::new(scenario.unwrap_or_default(), cpu)?.print_to(out, options.json);
    let printed = signals(cpu, player.plant(), &options.print)?;
    let asked = signals(cpu, player.plant(), &options.trace_signals)?;
    if options.trace.is_none() {
        let without = [("--trace-signals", !asked.is_empty()), ("--trace-step", options.trace_step.is_some())];
        if let Some((flag, _)) = without.iter().find(|(_, given)| *given) {
            return Err(format!("{flag} is about a trace, and there is none: add --trace FILE.csv"));
        }
    }
    // A wrong flag leaves the trace of an earlier run as it is.
    let set = settings(cpu, &options.set)?;
    let watch = options.watch_table.as_deref().map(|path| Table::read(path, cpu)).transpose()?;
    let triggered = watch.as_ref().and_then(Table::trace).cloned().map(Triggered::new);
    let recorder = match &options.trace {
        Some(path) => {
            let step = options.trace_step.map_or(0, |step| step.0);
            let (signals, has_more) = trace::signals(cpu, &asked, &printed);
            if has_more {
                let count = signals.len();
                super::say!("the trace has the first {count} values of the program; --trace-signals names others");
            }
            Some(Recorder::create(path, signals, step)?)
        }
        None => None,
    };
    Ok(Session { set, last: 0, player, recorder, printed, watch, triggered, trace_failed: false })
}

/// Tells what has become of the trace of a watch table. False: it cannot be written.
fn tell(outcome: Option<Result<String, String>>) -> bool {
    match outcome {
        None => true,
        Some(Ok(text)) => {
            super::say!("trace {text}");
            true
        }
        Some(Err(error)) => {
            super::say!("runtime: the trace cannot be written: {error}");
            false
        }
    }
}

/// The signals of a list flag.
fn signals(cpu: &Cpu, plant: Option<&Plant>, list: &[String]) -> Result<Vec<Signal>, String> {
    let mut signals = Vec::new();
    for name in split_list(list) {
        let found = signal::all(&name, &cpu.image, plant).map_err(|message| match separated(&name) {
            Some(list) => format!("`{name}`: names are separated by `,`; write {list}"),
            None => message,
        })?;
        for Signal { name, source } in &found {
            source.check(cpu).map_err(|message| format!("{name}: {message}"))?;
        }
        signals.extend(found);
    }
    Ok(signals)
}

/// `Q0.0,MW2` for the list `Q0.0;MW2` or `Q0.0 MW2`; none: it is one name.
fn separated(list: &str) -> Option<String> {
    let words: Vec<&str> = list.split([';', ' ']).filter(|word| !word.is_empty()).collect();
    let is_name = |word: &&str| word.chars().all(|c| c.is_alphanumeric() || "_.%[]".contains(c));
    // `MW2 as INT`, `AO0 in %`
    let is_format = words.iter().any(|word| ["as", "in"].iter().any(|own| own.eq_ignore_ascii_case(word)));
    (words.len() > 1 && !is_format && words.iter().all(is_name)).then(|| words.join(","))
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
        let (name, text) = split_setting(&item).ok_or_else(|| {
            // `I0.0:1`, but not `I0.0:P`.
            let meant = match item.rsplit_once(':') {
                Some((name, value)) if !value.trim().eq_ignore_ascii_case("P") => format!("{name}={value}"),
                _ => format!("{item}=1"),
            };
            format!("--set {item}: write ADDR=VALUE, as {meant}")
        })?;
        if let Some(name) = name.trim_end().strip_suffix(':') {
            return Err(format!("--set {item}: write {}={}", name.trim_end(), text.trim_start()));
        }
        let several = text.contains('=') && text.contains(' ') && !text.contains(['"', '\'']);
        setting(cpu, name, text).map_err(|message| match several {
            true => format!("--set {item}: values are separated by `,`; write {}", item.replace(' ', ",")),
            false => format!("--set {item}: {message}"),
        })
    };
    split_list(list).into_iter().map(one).collect()
}

/// What can be set before the startup OB runs.
pub(super) fn settable(cpu: &Cpu, name: &str) -> Result<Source, String> {
    let source = Source::find(name, &cpu.image, None)?;
    if let Some(address) = source.address() {
        cpu.check_address(address)?;
    }
    source.check_settable()?;
    Ok(source)
}

/// A value that is set before the startup OB runs.
pub(super) fn setting(cpu: &Cpu, name: &str, text: &str) -> Result<(Source, Value), String> {
    let source = settable(cpu, name)?;
    let value = source.parse(text, &cpu.image)?;
    Ok((source, value))
}
