//! The status of a block for a page: first the places of its probes, then what has changed.

use plcc_abi::ProgramImage;
use plcc_abi::monitor::{BlockProbes, Probes, Tells};
use plcc_runtime::monitor::history::Activation;
use plcc_runtime::monitor::steps::StepSeen;
use plcc_runtime::monitor::{Looked, Recorded, Seen, address_of};
use plcc_runtime::signal;
use serde::Serialize;
use serde_json::{Value, json};

/// What is new about a block.
#[derive(Debug, Default, Serialize)]
pub struct Status {
    /// The number that came with the order.
    pub turn: u64,
    /// The calls that have run so far, when there are more of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calls: Option<Vec<String>>,
    /// Index of the call that was seen, and the number of the cycle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub call: Option<(usize, u64)>,
    /// What has changed: number of the probe, and what it has seen; null if it was not reached.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub seen: Vec<(usize, Value)>,
    /// The steps of a chart, when something is different.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<Vec<StepSeen>>,
    /// The steps that have become active since the page looks, the newest first, when something is different.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub history: Option<Vec<Activation>>,
}

/// The places of a block as the page asks for them: first byte, last byte, kind of value.
pub fn places(image: &ProgramImage, block: &str) -> Option<Value> {
    let named = |of: &&BlockProbes| format!("{}{}", of.kind.prefix(), of.number) == block;
    let of = probes(image)?.blocks.iter().find(named)?;
    let mut start = 0i32;
    let places = of.probes.iter().map(|probe| {
        start = start.wrapping_add(probe.distance);
        let tells = match probe.tells {
            Tells::Block => "block",
            Tells::Registers | Tells::Timer(_) | Tells::Counter(_) => "registers",
            Tells::Variable(_) => "variable",
            Tells::Value(_) => "value",
            Tells::Written(_) => "written",
            Tells::Stack(_) => "stack",
            Tells::Ran => "ran",
        };
        json!([start, i64::from(start) + i64::from(probe.length), tells])
    });
    Some(places.collect())
}

fn probes(image: &ProgramImage) -> Option<&Probes> {
    image.config.services.probes.as_ref()
}

/// What a page knows of the block that it watches.
#[derive(Default)]
pub struct Known {
    turn: u64,
    calls: usize,
    seen: Vec<Option<Seen>>,
    steps: Vec<StepSeen>,
    history: Vec<Activation>,
}

impl Known {
    /// Nothing yet, after the order with this number.
    pub fn since(turn: u64) -> Known {
        Known { turn, ..Known::default() }
    }

    /// Nothing: the program has changed.
    pub fn forget(&mut self) {
        *self = Known::since(self.turn);
    }

    /// What is new in a look; `None`: nothing.
    pub fn news(&mut self, image: &ProgramImage, block: &str, looked: Looked) -> Option<Status> {
        let mut status = Status { turn: self.turn, ..Status::default() };
        if looked.calls.len() != self.calls {
            self.calls = looked.calls.len();
            status.calls = Some(looked.calls);
        }
        if let Some(recorded) = looked.recorded {
            self.recorded(image, block, recorded, &mut status);
        }
        let is_news =
            status.calls.is_some() || status.call.is_some() || !status.seen.is_empty() || status.steps.is_some();
        is_news.then_some(status)
    }

    fn recorded(&mut self, image: &ProgramImage, block: &str, recorded: Recorded, status: &mut Status) {
        let named = |of: &&BlockProbes| format!("{}{}", of.kind.prefix(), of.number) == block;
        let Some(of) = probes(image).and_then(|probes| probes.blocks.iter().find(named)) else { return };
        self.seen.resize(recorded.seen.len(), None);
        for (number, (seen, before)) in recorded.seen.iter().zip(&self.seen).enumerate() {
            if seen != before {
                let tells = of.probes.get(number).map(|probe| &probe.tells);
                status.seen.push((number, tells.map_or(Value::Null, |tells| shown(tells, seen.as_ref()))));
            }
        }
        if self.steps != recorded.steps {
            status.steps = Some(recorded.steps.clone());
        }
        if self.history != recorded.history {
            status.history = Some(recorded.history.clone());
        }
        status.call = Some((recorded.call, recorded.cycle));
        self.seen = recorded.seen;
        self.steps = recorded.steps;
        self.history = recorded.history;
    }
}

/// A value as the page shows it: a bit as true or false, others as texts, registers and stacks as lists.
fn shown(tells: &Tells, seen: Option<&Seen>) -> Value {
    match (tells, seen) {
        (Tells::Variable(ty) | Tells::Value(ty) | Tells::Written(ty), Some(Seen::Value(bits))) => {
            let value = signal::Value::of_type(*ty, *bits);
            match value.json() {
                Value::Bool(bit) => Value::Bool(bit),
                _ => Value::String(value.text()),
            }
        }
        (Tells::Ran, Some(_)) => Value::Bool(true),
        (_, Some(Seen::Registers(registers, cell))) => {
            let [accu1, accu2] = registers.accu;
            let [ar1, ar2] = registers.ar;
            json!([registers.status, accu1, accu2, ar1, ar2, registers.db, registers.di, cell])
        }
        (Tells::Stack(operands), Some(Seen::Stack(bits, values))) => {
            let operands: Vec<(&str, &String)> = operands.iter().map(|name| address_of(name)).zip(values).collect();
            json!([bits, operands])
        }
        _ => Value::Null,
    }
}
