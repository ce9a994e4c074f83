//! A CPU that a simulator steps, with its variables.

use std::rc::Rc;
use std::sync::Arc;

use plcc_abi::ProgramImage;
use plcc_abi::image::AssertType;

use super::variables::{Kind, Role, Variable};
use crate::address::{Address, Place};
use crate::clock::Clock;
use crate::code::Code;
use crate::cpu::Cpu;
use crate::cycle::{Course, Observer, Pace};
use crate::io::Simulated;
use crate::options::HANG_LIMIT_DEFAULT;
use crate::signal::{Source, Value};
use crate::typed;

/// A value as it goes between simulator and CPU.
#[derive(Clone, Debug, PartialEq)]
pub enum Scalar {
    Bool(bool),
    Whole(i128),
    /// A duration in seconds.
    Float(f64),
    Text(String),
}

/// What a step has brought.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    Done,
    /// The CPU went to STOP in this step. `fault`: not because its program asked for it.
    Stopped {
        fault: bool,
        text: String,
    },
}

/// See the module comment.
pub struct Instance {
    cpu: Rc<Cpu>,
    variables: Arc<[Variable]>,
    /// From the startup on.
    course: Option<Course>,
    /// What was set before the startup.
    start: Start,
    /// A STOP was reported.
    told: bool,
}

/// Values for the moment before the startup OB.
#[derive(Default)]
struct Start(Vec<(Source, Value)>);

impl Observer for Start {
    fn before(&mut self, cpu: &Cpu, cycle: u64, _time: u64) {
        if cycle == 0 {
            for (source, value) in &self.0 {
                // Was possible when the simulator set it.
                let _ = source.write(cpu, value);
            }
        }
    }

    fn after(&mut self, _cpu: &Cpu, _cycle: u64, _time: u64) {}
}

/// A CPU in STOP with the program loaded, as instances have it: files and retentive memory are those of this instance alone.
pub fn cpu(image: &Arc<ProgramImage>, code: Rc<dyn Code>) -> Rc<Cpu> {
    let driver = Box::new(Simulated::new(image.config.modules.clone()));
    Cpu::new(Arc::clone(image), code, Clock::simulated(), driver)
}

impl Instance {
    /// An instance before its startup. `variables` are those of the program.
    pub fn new(cpu: Rc<Cpu>, variables: Arc<[Variable]>) -> Instance {
        Instance { cpu, variables, course: None, start: Start::default(), told: false }
    }

    /// The variable with this number. `Err`: the error.
    pub fn variable(&self, number: u32) -> Result<&Variable, String> {
        self.variables.get(number as usize).ok_or_else(|| format!("there is no variable with the number {number}"))
    }

    /// Runs the startup of the CPU, unless it was run.
    pub fn start_up(&mut self) -> Step {
        if self.course.is_none() {
            let pace = Pace { cycles: None, cycle_time: self.cpu.cycle_time(), hang_limit: HANG_LIMIT_DEFAULT.0 };
            self.course = Some(self.cpu.begin(&pace, &mut self.start));
        }
        self.outcome()
    }

    /// Lets the CPU run until the virtual time `end`, in nanoseconds since the startup.
    pub fn run_until(&mut self, end: u64) -> Step {
        if let Some(course) = &mut self.course {
            self.cpu.run_until(course, end, &mut Start::default());
        }
        self.outcome()
    }

    /// The end of the run.
    pub fn end(&mut self) {
        if self.course.take().is_some() {
            self.cpu.end();
        }
    }

    fn outcome(&mut self) -> Step {
        match self.cpu.stopped() {
            Some(stop) if !std::mem::replace(&mut self.told, true) => {
                Step::Stopped { fault: !stop.asked, text: self.cpu.stop_text(&stop) }
            }
            Some(_) | None => Step::Done,
        }
    }

    /// A value. `Err`: the error.
    pub fn read(&self, number: u32) -> Result<Scalar, String> {
        let Variable { source, kind, .. } = self.variable(number)?;
        let Some(source) = source else {
            return Ok(Scalar::Bool(self.course.is_some() && !self.cpu.is_stopped()));
        };
        let value = self.in_stop(source).unwrap_or(*source).read(&self.cpu, None);
        Ok(match (kind, &value) {
            (Kind::Boolean, Value::Bits(bits, _)) => Scalar::Bool(*bits != 0),
            (Kind::Signed(_) | Kind::Unsigned(_), Value::Bits(bits, _)) => Scalar::Whole((*bits).into()),
            (Kind::Signed(_) | Kind::Unsigned(_), Value::Whole(whole)) => Scalar::Whole(*whole),
            (Kind::Text, value) => match source {
                Source::Typed(_, ty) if is_characters(ty.ty) => Scalar::Text(value.plain_text()),
                _ => Scalar::Text(value.text()),
            },
            (_, value) => Scalar::Float(value.number().unwrap_or(f64::NAN)),
        })
    }

    /// In STOP the outputs of modules are off or have their substitute values, whatever is in the process image.
    fn in_stop(&self, source: &Source) -> Option<Source> {
        let (Place::Output(byte) | Place::PeripheralOutput(byte)) = source.address()?.place else { return None };
        if !self.cpu.is_stopped() {
            return None;
        }
        let modules = self.cpu.image.config.modules.iter().flatten();
        let mut stations = modules.filter(|module| module.station.is_some());
        let is_module = |start: u32, bytes: u32| byte >= start && byte - start < bytes;
        let place = match stations.any(|module| is_module(module.output_start, module.output_bytes)) {
            true => Place::PeripheralOutput(byte),
            // Beyond the modules of a station: outputs without a voltage.
            false => Place::PeripheralOutput(u32::MAX / 2),
        };
        let moved = |address: &Address| Address { place, width: address.width };
        match source {
            Source::Bits(address) => Some(Source::Bits(moved(address))),
            Source::Typed(address, ty) => Some(Source::Typed(moved(address), *ty)),
            Source::Channel(..)
            | Source::Plant(_)
            | Source::PulseDuty(_)
            | Source::PulsePeriod(_)
            | Source::PulseCount(_) => None,
        }
    }

    /// Sets a value. `Err`: the error.
    pub fn write(&mut self, number: u32, value: &Scalar) -> Result<(), String> {
        let variable = self.variable(number)?;
        let name = &variable.name;
        let failed = |message: String| format!("{name}: {message}");
        let (Some(source), true) = (variable.source, variable.settable) else {
            let why = match (variable.role, &variable.source) {
                (Role::Output, _) => "the CPU sets it".to_string(),
                (_, None) => "it shows the CPU".to_string(),
                (_, Some(source)) => source.check_settable().err().unwrap_or_else(|| {
                    "write-protected data blocks, and views of inputs that other variables set, cannot be set"
                        .to_string()
                }),
            };
            return Err(failed(why));
        };
        let value = self.value(&source, variable.kind, value).map_err(failed)?;
        source.write(&self.cpu, &value).map_err(failed)?;
        if self.course.is_none() {
            self.start.0.push((source, value));
        }
        Ok(())
    }

    /// The value for a source. `Err`: the error.
    fn value(&self, source: &Source, kind: Kind, value: &Scalar) -> Result<Value, String> {
        let width = source.address().map_or(crate::address::Width::Byte, |address| address.width);
        match (kind, value) {
            (Kind::Boolean, Scalar::Bool(bit)) => Ok(Value::Bits((*bit).into(), width)),
            (Kind::Signed(_) | Kind::Unsigned(_), Scalar::Whole(whole)) => whole_value(kind, *whole),
            (Kind::Signed(_) | Kind::Unsigned(_), Scalar::Float(number)) => match number.fract() == 0.0 {
                true => whole_value(kind, *number as i128),
                false => Err(format!("{number} is not a whole number")),
            },
            (Kind::Signed(_) | Kind::Unsigned(_), Scalar::Text(text)) => {
                let whole = text.trim().parse::<i128>().map_err(|_| format!("`{text}` is not a whole number"))?;
                whole_value(kind, whole)
            }
            (Kind::Float32 | Kind::Float64, Scalar::Float(number)) => match source {
                Source::Typed(_, ty) if typed::is_duration(ty.ty) => self.duration(source, *number, ty.ty),
                Source::Channel(..) if !number.is_finite() => {
                    Err(format!("{number} is not a value of an analog channel"))
                }
                _ if kind == Kind::Float32 && number.is_finite() && !(*number as f32).is_finite() => {
                    Err(format!("{number:e} does not fit into REAL, which goes to {:e}", f32::MAX))
                }
                _ => Ok(Value::Number(*number)),
            },
            (Kind::Text, Scalar::Text(text)) => match source {
                // As in a program, where `$` begins an escape.
                Source::Typed(_, ty) if is_characters(ty.ty) => {
                    source.parse(&format!("'{}'", text.replace('$', "$$")), &self.cpu.image)
                }
                _ => source.parse(text, &self.cpu.image),
            },
            _ => Err("the value has another type".to_string()),
        }
    }

    /// A duration of seconds, rounded to the unit of its type. `Err`: the error.
    fn duration(&self, source: &Source, seconds: f64, ty: AssertType) -> Result<Value, String> {
        let (prefix, unit, size) = match ty {
            AssertType::Ltime => ("LT", "ns", 1e9),
            AssertType::S5Time => ("S5T", "ms", 1e3),
            _ => ("T", "ms", 1e3),
        };
        let units = (seconds * size).round();
        if !units.is_finite() || units.abs() > i64::MAX as f64 {
            return Err(format!("{seconds} s is not a duration of a PLC"));
        }
        let sign = if units < 0.0 { "-" } else { "" };
        source.parse(&format!("{prefix}#{sign}{}{unit}", units.abs() as u64), &self.cpu.image)
    }
}

fn whole_value(kind: Kind, whole: i128) -> Result<Value, String> {
    match kind.range() {
        Some((low, high)) if !(low..=high).contains(&whole) => Err(format!("{whole} is not from {low} to {high}")),
        Some(_) | None => Ok(Value::Whole(whole)),
    }
}

/// Types whose texts have quotes in a program.
fn is_characters(ty: AssertType) -> bool {
    matches!(ty, AssertType::Text | AssertType::WideText | AssertType::Char | AssertType::Wchar)
}

impl Drop for Instance {
    fn drop(&mut self) {
        self.end();
    }
}
