//! The variables of a unit: inputs and outputs of the CPU, bit memory and values of data blocks.

use std::collections::HashSet;

use plcc_abi::image::{AssertType, Module};

use crate::address::{self, Place, Width};
use crate::analog;
use crate::cpu::Cpu;
use crate::names;
use crate::s7200::Part;
use crate::signal::{self, Source};
use crate::typed;

/// Maximum number of variables of a unit; inputs and outputs come first.
pub const VARIABLES_MAX: usize = 20_000;
/// Number of the time in a unit of version 3.0, after those of all variables.
pub const TIME_NUMBER: u32 = 1 << 31;
/// Maximum number of values of one data block.
const DB_VALUES_MAX: usize = 4096;

/// Who sets a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// The process.
    Input,
    /// The CPU, for the process.
    Output,
    /// The program.
    Local,
}

/// What the values of a variable are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Boolean,
    /// So many bits.
    Signed(u8),
    Unsigned(u8),
    Float32,
    Float64,
    /// A text; also dates and characters, as PLC languages write them.
    Text,
}

impl Kind {
    /// Its type in a unit of version 2.0, whose integers are signed and have 32 bits. No value changes: 32 bits without a sign are
    /// Real, and 64 bits a text.
    pub fn name_v2(self) -> &'static str {
        match self {
            Kind::Boolean => "Boolean",
            Kind::Signed(8 | 16 | 32) | Kind::Unsigned(8 | 16) => "Integer",
            Kind::Unsigned(32) | Kind::Float32 | Kind::Float64 => "Real",
            Kind::Signed(_) | Kind::Unsigned(_) | Kind::Text => "String",
        }
    }

    /// Its type in a unit of version 3.0.
    pub fn name_v3(self) -> &'static str {
        match self {
            Kind::Boolean => "Boolean",
            Kind::Signed(8) => "Int8",
            Kind::Signed(16) => "Int16",
            Kind::Signed(32) => "Int32",
            Kind::Signed(_) => "Int64",
            Kind::Unsigned(8) => "UInt8",
            Kind::Unsigned(16) => "UInt16",
            Kind::Unsigned(32) => "UInt32",
            Kind::Unsigned(_) => "UInt64",
            Kind::Float32 => "Float32",
            Kind::Float64 => "Float64",
            Kind::Text => "String",
        }
    }

    /// Least and greatest value of a whole number.
    pub fn range(self) -> Option<(i128, i128)> {
        match self {
            Kind::Signed(bits) => Some((-(1 << (bits - 1)), (1 << (bits - 1)) - 1)),
            Kind::Unsigned(bits) => Some((0, (1 << bits) - 1)),
            Kind::Boolean | Kind::Float32 | Kind::Float64 | Kind::Text => None,
        }
    }
}

/// A variable; its number is its place in the list.
#[derive(Clone, Debug)]
pub struct Variable {
    /// As flags and scenarios name it.
    pub name: String,
    /// `None`: whether the CPU is in RUN.
    pub source: Option<Source>,
    pub role: Role,
    pub kind: Kind,
    /// `s`, `mA`; of durations and analog channels.
    pub unit: Option<&'static str>,
    /// Type and address.
    pub description: String,
    /// It may be set.
    pub settable: bool,
}

/// The name of the variable that says whether the CPU is in RUN.
pub const RUNNING: &str = "plcc.running";

/// The variables of a CPU with a program, inputs first, then outputs. And how many there are beyond [`VARIABLES_MAX`].
pub fn variables(cpu: &Cpu) -> (Vec<Variable>, usize) {
    let mut list = List { cpu, variables: Vec::new(), names: HashSet::new() };
    list.channels();
    for symbol in &cpu.image.symbols {
        let is_db = symbol.address.strip_prefix("DB").and_then(address::digits).is_some();
        if !is_db {
            list.all(&symbol.name, &symbol.address);
        }
    }
    for (name, named) in names::used(&cpu.image) {
        list.push(&name, Source::of(named), None, "");
    }
    for db in cpu.image.dbs.iter().filter(|db| !db.unlinked && db.ty.is_some()) {
        list.all(&names::db_name(db), &format!("DB{}", db.number));
    }
    let mut variables = list.variables;
    one_input_a_bit(&mut variables);
    variables.push(Variable {
        name: RUNNING.to_string(),
        source: None,
        role: Role::Output,
        kind: Kind::Boolean,
        unit: None,
        description: "the CPU is in RUN".to_string(),
        settable: false,
    });
    // Stable: within a role the order of the program.
    variables.sort_by_key(|variable| variable.role);
    let more = variables.len().saturating_sub(VARIABLES_MAX);
    variables.truncate(VARIABLES_MAX);
    (variables, more)
}

struct List<'a> {
    cpu: &'a Cpu,
    variables: Vec<Variable>,
    names: HashSet<String>,
}

impl List<'_> {
    /// Analog channels of the station, in the units of their ranges.
    fn channels(&mut self) {
        let image = &self.cpu.image;
        let modules: Vec<&Module> = image.config.modules.iter().flatten().collect();
        let stations = modules.iter().filter_map(|module| module.station.as_ref());
        let (mut inputs, mut outputs) = (0, 0);
        for station in stations {
            inputs += station.analog_inputs.len();
            outputs += station.analog_outputs.len();
        }
        let names = (0..inputs).map(|index| format!("AI{index}")).chain((0..outputs).map(|index| format!("AO{index}")));
        for name in names.collect::<Vec<_>>() {
            let Some(address) = signal::analog_channel(&name, image) else { continue };
            let range = signal::channel(&address, image).and_then(|channel| analog::range(&channel.range));
            let Some(range) = range else { continue };
            if let Ok(scale) = signal::scale(&address, range.unit, image) {
                let range_name = range.name;
                self.push(&name, Source::Channel(address, scale), Some(range.unit), range_name);
            }
        }
    }

    /// All values of what has a name and an address.
    fn all(&mut self, name: &str, address: &str) {
        let image = &self.cpu.image;
        let values = match names::find(name, image) {
            Ok(named) => vec![(name.to_string(), named)],
            // A block or something else that is not a value.
            Err(_) => names::values(name, image, DB_VALUES_MAX).unwrap_or_default(),
        };
        for (name, named) in values {
            self.push(&name, Source::of(named), None, address);
        }
    }

    fn push(&mut self, name: &str, source: Source, unit: Option<&'static str>, note: &str) {
        let Some(address) = source.address() else { return };
        if self.cpu.check_address(address).is_err() || name.contains(['\n', '\r', '\t']) || name == RUNNING {
            return;
        }
        if !self.names.insert(name.to_string()) {
            return;
        }
        let (kind, own_unit) = kind(&source);
        let is_read_only = matches!(address.place, Place::Db(number, _) if self.cpu.is_read_only(number));
        let description = [source.ty(), note].join(" ").trim_end().to_string();
        let role = role(address.place);
        self.variables.push(Variable {
            name: name.to_string(),
            role,
            kind,
            unit: unit.or(own_unit),
            description,
            settable: role != Role::Output && source.check_settable().is_ok() && !is_read_only,
            source: Some(source),
        });
    }
}

/// What a value is, and its unit.
fn kind(source: &Source) -> (Kind, Option<&'static str>) {
    match source {
        Source::Bits(address) => match address.width {
            Width::Bit(_) => (Kind::Boolean, None),
            width => (Kind::Unsigned(width.bits() as u8), None),
        },
        Source::Typed(_, ty) => match ty.ty {
            AssertType::Bool => (Kind::Boolean, None),
            AssertType::Bits(1) => (Kind::Boolean, None),
            AssertType::Bits(bits) | AssertType::Unsigned(bits) => (Kind::Unsigned(bits), None),
            AssertType::Signed(bits) => (Kind::Signed(bits), None),
            AssertType::Real => (Kind::Float32, None),
            AssertType::Lreal => (Kind::Float64, None),
            ty if typed::is_duration(ty) => (Kind::Float64, Some("s")),
            _ => (Kind::Text, None),
        },
        Source::PulseCount(_) => (Kind::Unsigned(32), None),
        Source::Channel(..) | Source::Plant(_) | Source::PulseDuty(_) | Source::PulsePeriod(_) => (Kind::Float64, None),
    }
}

fn role(place: Place) -> Role {
    match place {
        Place::Input(_) | Place::PeripheralInput(_) | Place::S7200(Part::AnalogInput, _) => Role::Input,
        Place::Output(_) | Place::PeripheralOutput(_) | Place::S7200(Part::AnalogOutput, _) => Role::Output,
        Place::BitMemory(_)
        | Place::Db(..)
        | Place::Timer(_)
        | Place::Counter(_)
        | Place::TimerValue(_)
        | Place::CounterValue(_)
        | Place::S7200(..) => Role::Local,
    }
}

/// A simulator sets all inputs, one after the other: of two that share a bit the later one would win. So the narrower is the input, and
/// the other one shows what the CPU has read; an analog channel in its unit goes before its word, a tag before a direct access to the module.
fn one_input_a_bit(variables: &mut [Variable]) {
    let place = |variable: &Variable| {
        let address = *variable.source.as_ref()?.address()?;
        let (area, byte) = match address.place {
            Place::Input(byte) | Place::PeripheralInput(byte) => (0u8, byte),
            Place::S7200(Part::AnalogInput, byte) => (1, byte),
            _ => return None,
        };
        let bits = match address.width {
            Width::Bit(bit) => u32::from(bit)..u32::from(bit) + 1,
            width => 0..width.bits(),
        };
        Some((area, byte * 8 + bits.start..byte * 8 + bits.end))
    };
    let mut order: Vec<usize> = (0..variables.len())
        .filter(|&index| variables[index].role == Role::Input && variables[index].settable)
        .collect();
    order.sort_by_key(|&index| {
        let source = variables[index].source.as_ref();
        let is_channel = matches!(source, Some(Source::Channel(..)));
        let address = source.and_then(Source::address);
        let is_direct = address.is_some_and(|address| matches!(address.place, Place::PeripheralInput(_)));
        (is_direct && !is_channel, place(&variables[index]).map_or(0, |(_, bits)| bits.len()), !is_channel)
    });
    let mut taken: HashSet<(u8, u32)> = HashSet::new();
    for index in order {
        let Some((area, bits)) = place(&variables[index]) else { continue };
        if bits.clone().any(|bit| taken.contains(&(area, bit))) {
            (variables[index].role, variables[index].settable) = (Role::Local, false);
        } else {
            taken.extend(bits.map(|bit| (area, bit)));
        }
    }
}
