//! A simulated plant: the process between outputs and inputs. It closes the loop on the clock of the CPU.
//!
//! A plant is a list of named numbers and of equations over them, from `[plant]` of a scenario. In fixed steps of time it reads
//! outputs, computes its equations in order, and sets inputs; all steps that are due are done before a cycle reads its inputs.
//! Equations have no effect but on their values, so runs are the same in each form of a program.

mod expression;
mod read;

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use crate::address::{Place, Width};
use crate::clock::NS_PER_MS;
use crate::cpu::Cpu;
use crate::signal::{Source, Value};
pub use expression::Expression;

pub(crate) use read::PlantText;

/// Step, if left out.
pub const STEP_DEFAULT: u64 = 10 * NS_PER_MS;
/// Shortest step.
pub const STEP_LEAST: u64 = NS_PER_MS;
/// Steps that may be due at once: more is a plant that is too slow for its cycle.
const STEPS_AT_ONCE: u64 = 1_000_000;

/// Time of the step since the start, and its length, in seconds: values that each plant has.
const TIME: usize = 0;
const STEP: usize = 1;

/// See the module comment.
#[derive(Clone, Debug)]
pub struct Plant {
    /// Nanoseconds.
    step: u64,
    names: Vec<String>,
    /// The number of each name.
    numbers: HashMap<String, usize>,
    values: Vec<f64>,
    /// Values that entries of the scenario can change: parameters and states.
    settable: HashSet<usize>,
    reads: Vec<(usize, Source)>,
    equations: Vec<Equation>,
    writes: Vec<Write>,
    /// Clock of the last step.
    time: u64,
    failed: bool,
}

/// Value `target` is set to the result of the expression.
#[derive(Clone, Debug)]
struct Equation {
    target: usize,
    expression: Rc<Expression>,
    line: u32,
}

/// An input is set to the result of the expression.
#[derive(Clone, Debug)]
struct Write {
    name: String,
    input: Source,
    expression: Rc<Expression>,
    line: u32,
}

/// An error, and the line of the scenario.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    pub line: u32,
    /// The signal or variable without a value.
    pub name: String,
    pub message: String,
}

impl Plant {
    /// The number of the value that is called `name`.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.numbers.get(name).copied()
    }

    /// The names of all values.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(String::as_str)
    }

    pub fn value(&self, index: usize) -> f64 {
        self.values.get(index).copied().unwrap_or(0.0)
    }

    /// The number of a parameter or state.
    pub(crate) fn find_settable(&self, name: &str) -> Option<usize> {
        self.find(name).filter(|index| self.settable.contains(index))
    }

    pub(crate) fn set(&mut self, index: usize, value: f64) {
        if let Some(place) = self.values.get_mut(index) {
            *place = value;
        }
    }

    /// Checks addresses against the CPU and makes the inputs named. `Err`: line and message.
    pub(crate) fn attach(&self, cpu: &Cpu) -> Result<(), (u32, String)> {
        for write in &self.writes {
            write.input.check(cpu).map_err(|message| (write.line, format!("{}: {message}", write.name)))?;
            if let Some(address) = write.input.address() {
                cpu.name_input(address);
            }
        }
        for (_, source) in &self.reads {
            source.check(cpu).map_err(|message| (0, message))?;
        }
        Ok(())
    }

    /// Before the startup OB: equations are computed with a step of 0, so that inputs show the initial state.
    pub(crate) fn begin(&mut self, cpu: &Cpu, now: u64) -> Result<(), Fault> {
        self.time = now;
        self.values[STEP] = 0.0;
        let result = self.do_step(cpu);
        self.values[STEP] = seconds(self.step);
        self.noted(result)
    }

    /// All steps that are due at `now`. After a fault the plant stops.
    pub(crate) fn advance(&mut self, cpu: &Cpu, now: u64) -> Result<(), Fault> {
        if self.failed {
            return Ok(());
        }
        let due = now.saturating_sub(self.time) / self.step;
        if due > STEPS_AT_ONCE {
            let message = format!("{due} steps of the plant are due in one cycle; write a longer `step`");
            return self.noted(Err(Fault { line: 0, name: "plant".to_string(), message }));
        }
        let result = (0..due).try_for_each(|_| {
            self.time += self.step;
            self.do_step(cpu)
        });
        self.noted(result)
    }

    fn noted(&mut self, result: Result<(), Fault>) -> Result<(), Fault> {
        self.failed |= result.is_err();
        result
    }

    fn do_step(&mut self, cpu: &Cpu) -> Result<(), Fault> {
        self.values[TIME] = seconds(self.time);
        for &(index, source) in &self.reads {
            self.values[index] = output(cpu, &source);
        }
        for at in 0..self.equations.len() {
            let Equation { target, ref expression, line } = self.equations[at];
            let value = self.evaluate(expression).map_err(|message| Fault {
                line,
                name: self.names[target].clone(),
                message,
            })?;
            self.values[target] = value;
        }
        for write in &self.writes {
            let written = self.evaluate(&write.expression).and_then(|value| write.input.write_number(cpu, value));
            written.map_err(|message| Fault { line: write.line, name: write.name.clone(), message })?;
        }
        Ok(())
    }

    fn evaluate(&self, expression: &Expression) -> Result<f64, String> {
        match expression.evaluate(&|name| self.find(name).map_or(0.0, |index| self.values[index])) {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(value) => Err(format!("the result of the expression is {value} at {} s", self.values[TIME])),
            Err(error) => Err(format!("the expression has no value: {error:?}")),
        }
    }
}

fn seconds(ns: u64) -> f64 {
    ns as f64 / 1e9
}

/// The value of an output module: in STOP it differs from the process image.
fn output(cpu: &Cpu, source: &Source) -> f64 {
    let module = |source: &Source| match *source {
        Source::Bits(mut address) => {
            let Place::Output(byte) = address.place else { return *source };
            if !matches!(address.width, Width::Bit(_)) {
                address.place = Place::PeripheralOutput(byte);
            }
            Source::Bits(address)
        }
        Source::Typed(mut address, ty) => {
            if let Place::Output(byte) = address.place {
                address.place = Place::PeripheralOutput(byte);
            }
            Source::Typed(address, ty)
        }
        other => other,
    };
    if let Source::Bits(address) = source
        && let (Place::Output(byte), Width::Bit(bit)) = (address.place, address.width)
    {
        return f64::from(cpu.module_output(byte, 1) >> bit & 1);
    }
    match module(source).read(cpu, None) {
        Value::Bits(bits, Width::Word) => f64::from(bits as u16 as i16),
        Value::Bits(bits, Width::Dword) => f64::from(bits as u32 as i32),
        Value::Bits(bits, _) => bits as f64,
        Value::Whole(whole) => whole as f64,
        value @ (Value::Number(_) | Value::Typed(..)) => value.number().unwrap_or(0.0),
    }
}
