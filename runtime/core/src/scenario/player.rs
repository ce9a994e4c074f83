//! Plays a scenario: between the cycles it sets values, starts events, steps the plant, and compares.

use std::collections::HashMap;
use std::io::Write;

use super::trains::Trains;
use super::{PulsesAt, Scenario, Setting, When};
use crate::cpu::Cpu;
use crate::cycle::Observer;
use crate::names;
use crate::plant::{Fault, Plant};
use crate::report;
use crate::s7200::PulseInput;
use crate::signal::{self, Signal, Source, Value};
use crate::testing::{AssertFailure, NOT_REACHED};
use crate::typed;

/// When entries are due, so that a cycle looks at its own alone.
struct Agenda {
    /// Entries of a cycle, in the order of the file.
    by_cycle: HashMap<u64, Vec<usize>>,
    /// Nanoseconds and entry; the latest first.
    by_time: Vec<(u64, usize)>,
}

impl Agenda {
    fn of(scenario: &Scenario) -> Agenda {
        let mut agenda = Agenda { by_cycle: HashMap::new(), by_time: Vec::new() };
        for (index, at) in scenario.entries.iter().enumerate() {
            match at.when {
                When::Cycle(cycle) => agenda.by_cycle.entry(cycle).or_default().push(index),
                When::Time(time) => agenda.by_time.push((time, index)),
            }
        }
        agenda.by_time.sort_by(|a, b| b.cmp(a));
        agenda
    }

    /// Entries that happen in this cycle, in the order of the file; they are taken.
    fn take(&mut self, cycle: u64, time: u64) -> Vec<usize> {
        let mut due = self.by_cycle.remove(&cycle).unwrap_or_default();
        while cycle > 0
            && let Some(&(_, index)) = self.by_time.last().filter(|(at, _)| *at <= time)
        {
            due.push(index);
            self.by_time.pop();
        }
        due.sort_unstable();
        due
    }
}

/// Plays a scenario.
pub struct Player {
    scenario: Scenario,
    agenda: Agenda,
    /// For each entry: whether it happened.
    happened: Vec<bool>,
    /// Entries that happened in this cycle.
    current: Vec<usize>,
    expectations_met: u64,
    failures: Vec<AssertFailure>,
    trains: Trains,
    /// The OB whose event stopped the CPU at once, because it does not exist, and its line in the file.
    stopper: Option<(u16, u32)>,
    /// Where `print` goes; nowhere in tests.
    out: Option<Box<dyn Write>>,
    json: bool,
    /// There is nothing to play.
    idle: bool,
}

impl Player {
    /// Checks the addresses against the CPU and makes its inputs named. `Err`: message with file and line.
    pub fn new(scenario: Scenario, cpu: &Cpu) -> Result<Player, String> {
        let file = &scenario.file;
        for Setting { signal, line, .. } in scenario.entries.iter().flat_map(|at| at.set.iter().chain(&at.expect)) {
            signal.source.check(cpu).map_err(|message| format!("{file}:{line}: {}: {message}", signal.name))?;
        }
        for Setting { signal, line, .. } in scenario.entries.iter().flat_map(|at| &at.set) {
            if let Some(address) = signal.source.address().filter(|address| !signal::has_module(address, &cpu.image)) {
                let (name, bytes) = (&signal.name, address.width.bytes());
                return Err(format!("{file}:{line}: {name}: no module of the station has these {bytes} input bytes"));
            }
        }
        for Signal { name, source } in scenario.entries.iter().flat_map(|at| &at.print) {
            source.check(cpu).map_err(|message| format!("{file}: print {name}: {message}"))?;
        }
        for address in scenario.entries.iter().flat_map(|at| &at.set).filter_map(|set| set.signal.source.address()) {
            cpu.name_input(address);
        }
        let trains = scenario.entries.iter().flat_map(|at| &at.pulses);
        if trains.into_iter().any(|pulses| matches!(pulses.at, PulsesAt::S7200(_))) {
            cpu.driver.name_input(0, PulseInput::bytes());
        }
        if let Some(plant) = &scenario.plant {
            plant.attach(cpu).map_err(|(line, message)| match line {
                0 => format!("{file}: plant: {message}"),
                line => format!("{file}:{line}: {message}"),
            })?;
        }
        let idle = scenario.entries.is_empty() && scenario.plant.is_none();
        if !idle {
            cpu.s7200_look_always();
        }
        Ok(Player {
            idle,
            agenda: Agenda::of(&scenario),
            happened: vec![false; scenario.entries.len()],
            current: Vec::new(),
            scenario,
            expectations_met: 0,
            failures: Vec::new(),
            trains: Trains::default(),
            stopper: None,
            out: None,
            json: false,
        })
    }

    /// Writes the values of `print` to `out`.
    pub fn print_to(mut self, out: Box<dyn Write>, json: bool) -> Player {
        self.out = Some(out);
        self.json = json;
        self
    }

    /// The plant as it is now.
    pub fn plant(&self) -> Option<&Plant> {
        self.scenario.plant.as_ref()
    }

    /// Number of `expect` values that were found so far.
    pub fn expectations_met(&self) -> u64 {
        self.expectations_met
    }

    /// The event that stopped the CPU, after the reason of the STOP: `; s.toml:3 starts OB 41`. Empty: there is none.
    pub fn stopper(&self) -> String {
        let text = |(ob, line): (u16, u32)| format!("; {}:{line} starts OB {ob}", self.scenario.file);
        self.stopper.map(text).unwrap_or_default()
    }

    /// All failures, and the expectations of entries that were not reached. Call it at the end.
    pub fn failures(&self) -> Vec<AssertFailure> {
        let mut failures = self.failures.clone();
        for (at, _) in self.scenario.entries.iter().zip(&self.happened).filter(|(_, happened)| !**happened) {
            failures.extend(at.expect.iter().map(|setting| self.failure(setting, NOT_REACHED.to_string())));
            failures.extend(at.sent.iter().map(|sent| sent.failure(&self.scenario.file, NOT_REACHED.to_string())));
        }
        failures.extend(self.trains.never_begun(&self.scenario.file));
        failures
    }

    fn failure(&self, setting: &Setting, actual: String) -> AssertFailure {
        let mut expected = setting.value.text();
        if setting.tolerance > 0.0 {
            let tolerance = match setting.value {
                Value::Typed(ty, _) if typed::is_duration(ty) => typed::duration_text(setting.tolerance),
                _ => Value::Number(setting.tolerance).text(),
            };
            expected = format!("{expected} +- {tolerance}");
        }
        AssertFailure {
            text: format!("{} = {expected}", setting.signal.name),
            left: actual,
            right: expected,
            ty: setting.signal.source.ty().to_string(),
            ..AssertFailure::at(&self.scenario.file, setting.line)
        }
    }

    fn step_plant(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        let Some(plant) = &mut self.scenario.plant else { return };
        let stepped = if cycle == 0 { plant.begin(cpu, time) } else { plant.advance(cpu, time) };
        if let Err(Fault { line, name, message }) = stepped {
            self.failures.push(AssertFailure {
                text: format!("a value of the plant for {name}"),
                left: message,
                right: "a number".to_string(),
                when: Some((cycle, time)),
                ..AssertFailure::at(&self.scenario.file, line)
            });
        }
    }
}

/// Values that are shown next to one that is wrong.
const BESIDE_MAX: usize = 8;

/// The other values of the structure in which the value `name` is.
fn beside(cpu: &Cpu, name: &str) -> Vec<String> {
    let values = names::neighbours(name, &cpu.image, BESIDE_MAX).into_iter();
    values.map(|(name, named)| format!("{name} = {}", Source::of(named).read(cpu, None).text())).collect()
}

/// The text of a value that is not the one wanted. Six digits of two numbers may be the same: then with all of them.
fn distinct(actual: &Value, wanted: &Value) -> String {
    match actual {
        Value::Number(number) if number.is_finite() && actual.text() == wanted.text() => {
            actual.exact_json().to_string()
        }
        Value::Bits(..) | Value::Whole(_) | Value::Number(_) | Value::Typed(..) => actual.text(),
    }
}

fn holds(setting: &Setting, actual: &Value) -> bool {
    let number = |value: &Value| match value {
        Value::Whole(_) | Value::Number(_) => value.number(),
        Value::Typed(..) if setting.tolerance > 0.0 || matches!(setting.value, Value::Number(_)) => value.number(),
        Value::Bits(..) | Value::Typed(..) => None,
    };
    match (&setting.value, actual) {
        (Value::Whole(wanted), Value::Whole(actual)) => wanted == actual,
        (Value::Typed(ty, wanted), Value::Typed(_, actual)) if setting.tolerance == 0.0 => {
            typed::equal(*ty, wanted, actual)
        }
        (wanted, actual) => match (number(wanted), number(actual)) {
            // A number has the value of its REAL.
            (Some(wanted), Some(actual)) => {
                let is_exact = setting.signal.source.is_exact();
                let rounding = if is_exact { 0.0 } else { wanted.abs() * f64::from(f32::EPSILON) };
                (actual - wanted).abs() <= setting.tolerance + rounding
            }
            _ => wanted == actual,
        },
    }
}

impl Observer for Player {
    #[inline]
    fn before(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        if !self.idle {
            self.play(cpu, cycle, time);
        }
    }

    #[inline]
    fn after(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        if !self.idle {
            self.compare(cpu, cycle, time);
        }
    }

    #[inline]
    fn rests(&self) -> bool {
        self.idle
    }
}

impl Player {
    /// There is no scenario.
    #[inline]
    pub fn is_idle(&self) -> bool {
        self.idle
    }

    /// Sets what the scenario sets before `cycle`.
    #[inline(never)]
    fn play(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        // Pulses until now count with the earlier levels.
        cpu.s7200_poll_counters();
        self.step_plant(cpu, cycle, time);
        self.current = self.agenda.take(cycle, time);
        for &index in &self.current {
            let Some(at) = self.scenario.entries.get(index) else { continue };
            self.happened[index] = true;
            for setting in &at.set {
                if let Err(message) = setting.signal.source.write(cpu, &setting.value) {
                    self.failures.push(AssertFailure {
                        text: format!("{} to be set", setting.signal.name),
                        left: message,
                        right: setting.value.text(),
                        ..AssertFailure::at(&self.scenario.file, setting.line)
                    });
                }
            }
            if let Some(plant) = &mut self.scenario.plant {
                at.plant.iter().for_each(|&(index, value)| plant.set(index, value));
            }
            for pulses in &at.pulses {
                self.failures.extend(self.trains.begin(cpu, pulses, cpu.clock.now(), &self.scenario.file));
            }
            at.receive.iter().for_each(|received| received.feed(cpu));
            if let Some(event) = at.event {
                let ran = !cpu.is_stopped();
                cpu.request(event);
                if ran && cpu.is_stopped() {
                    self.stopper = Some((event.ob, at.event_line));
                }
            }
        }
    }

    /// Compares what the scenario expects after the cycle.
    #[inline(never)]
    fn compare(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        self.failures.extend(self.trains.retry(cpu, &self.scenario.file));
        for index in std::mem::take(&mut self.current) {
            let Some(at) = self.scenario.entries.get(index) else { continue };
            let mut failed = Vec::new();
            for setting in &at.expect {
                // Reading is 0 there.
                let absent = setting.signal.source.absent(cpu);
                if let Some(message) = absent {
                    let nothing = format!("nothing: {message}");
                    failed.push(AssertFailure { when: Some((cycle, time)), ..self.failure(setting, nothing) });
                    continue;
                }
                let actual = setting.signal.source.read(cpu, self.plant());
                if holds(setting, &actual) {
                    self.expectations_met += 1;
                } else {
                    failed.push(AssertFailure {
                        when: Some((cycle, time)),
                        beside: beside(cpu, &setting.signal.name),
                        values: Some((actual.json(), setting.value.json())),
                        ..self.failure(setting, distinct(&actual, &setting.value))
                    });
                }
            }
            for sent in &at.sent {
                match sent.compare(cpu, &self.scenario.file) {
                    None => self.expectations_met += 1,
                    failure => {
                        failed.extend(failure.map(|failure| AssertFailure { when: Some((cycle, time)), ..failure }))
                    }
                }
            }
            if let Some(out) = self.out.as_mut().filter(|_| !at.print.is_empty()) {
                let plant = self.scenario.plant.as_ref();
                // A closed pipe must not stop a plant.
                let _ = report::write_values(cpu, plant, &at.print, self.json.then_some((cycle, time)), out.as_mut());
            }
            self.failures.extend(failed);
        }
    }
}
