//! Variables as a client sees them: rows with names, values and types; what has parts has a number by which the client asks for these.

use plcc_lower::probe::Kept;
use plcc_model::layout;
use plcc_model::types::DataType;
use plcc_runtime::address::Place;
use plcc_runtime::clock::NS_PER_MS;
use plcc_runtime::names::{self, path::written};
use plcc_runtime::s7200::Part;
use plcc_runtime::signal::Source;
use serde_json::{Value, json};

use crate::lookup::{Data, Found, Here};
use crate::registers;

/// What a number stands for until the program runs on.
#[derive(Clone, Debug)]
pub enum Group {
    /// The scopes of the call with this index on the stack.
    Cpu,
    Registers(usize),
    Formals(usize),
    Temporaries(usize),
    Instance(usize),
    Inputs,
    Outputs,
    BitMemory,
    Dbs,
    /// A data block, by its index in the program.
    Db(usize),
    /// The parts of a variable, with its name.
    Parts(String, Data),
    Values(Vec<(String, Source)>),
}

/// A row.
pub struct Row {
    pub name: String,
    pub found: Option<Found>,
    /// If it is not that of `found`.
    pub text: Option<String>,
    pub ty: String,
    /// As an expression.
    pub expression: String,
    pub group: Option<Group>,
}

/// Rows that are shown of one group.
const ROWS_MAX: usize = 1000;

/// The groups of which the client knows.
#[derive(Debug, Default)]
pub struct Groups(Vec<Group>);

impl Groups {
    /// The program runs on.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// The number of a group, from 1.
    pub fn add(&mut self, group: Group) -> usize {
        self.0.push(group);
        self.0.len()
    }

    pub fn get(&self, number: u64) -> Option<&Group> {
        self.0.get(usize::try_from(number).ok()?.checked_sub(1)?)
    }

    /// A row as the client gets it.
    pub fn shown(&mut self, here: &Here<'_>, row: Row) -> Value {
        let text = row.text.unwrap_or_else(|| row.found.as_ref().map_or_else(String::new, |found| text(here, found)));
        let number = row.group.map_or(0, |group| self.add(group));
        json!({
            "name": row.name,
            "value": text,
            "type": row.ty,
            "evaluateName": row.expression,
            "variablesReference": number,
        })
    }
}

impl Group {
    /// The call that it belongs to; `None`: to the program.
    pub fn frame(&self) -> Option<usize> {
        match self {
            Group::Registers(frame) | Group::Formals(frame) | Group::Temporaries(frame) | Group::Instance(frame) => {
                Some(*frame)
            }
            Group::Cpu
            | Group::Inputs
            | Group::Outputs
            | Group::BitMemory
            | Group::Dbs
            | Group::Db(_)
            | Group::Parts(..)
            | Group::Values(_) => None,
        }
    }

    /// Its rows; of an array from `start`, at most `count`.
    pub fn rows(&self, here: &Here<'_>, start: usize, count: usize) -> Vec<Row> {
        let count = count.min(ROWS_MAX);
        let of_image = |is_it: fn(Place) -> bool| -> Vec<Row> {
            let used = names::used(&here.cpu.image).into_iter().filter(|(_, named)| is_it(named.address.place));
            used.map(|(name, named)| value_row(name.clone(), name, Source::of(named))).collect()
        };
        let local = |list: Vec<(String, Found)>| -> Vec<Row> {
            list.into_iter().map(|(name, found)| row(name.clone(), format!("#{}", written(&name)), found)).collect()
        };
        let rows: Vec<Row> = match self {
            Group::Cpu => cpu_rows(here),
            Group::Registers(_) => register_rows(here),
            Group::Formals(_) => local(here.formals()),
            Group::Temporaries(_) => local(here.temporaries()),
            Group::Instance(_) => local(here.instance()),
            Group::Inputs => of_image(|place| {
                matches!(place, Place::Input(_) | Place::PeripheralInput(_) | Place::S7200(Part::AnalogInput, _))
            }),
            Group::Outputs => of_image(|place| {
                matches!(place, Place::Output(_) | Place::PeripheralOutput(_) | Place::S7200(Part::AnalogOutput, _))
            }),
            Group::BitMemory => of_image(|place| matches!(place, Place::BitMemory(_))),
            Group::Dbs if here.program.s7200.is_some() => of_image(|place| matches!(place, Place::Db(..))),
            Group::Dbs => (0..here.program.dbs.len()).map(|index| db_row(here, index)).collect(),
            Group::Db(index) => db_rows(here, *index),
            Group::Parts(name, data) => return part_rows(name, data, start, count),
            Group::Values(values) => {
                values.iter().map(|(name, source)| value_row(name.clone(), name.clone(), *source)).collect()
            }
        };
        rows.into_iter().skip(start).take(count).collect()
    }
}

/// What a client reads.
pub fn text(here: &Here<'_>, found: &Found) -> String {
    match found {
        Found::Register(register) => here.frame.map_or_else(String::new, |frame| register.text(&frame.probed)),
        Found::Number(number, ty) => format!("{ty} {number}"),
        Found::Values(values) => format!("{} values", values.len()),
        Found::Data(_) | Found::Value(_) | Found::Constant(..) => match (here.value(found), found) {
            (Some(value), _) => value.text(),
            (None, Found::Data(data)) => match &data.ty {
                DataType::Parameter(_) => {
                    let bytes = here.cpu.memory.view(data.offset, layout::bytes(&data.ty), <[u8]>::to_vec);
                    crate::data::shown(&bytes)
                }
                ty => layout::type_name(ty),
            },
            (None, _) => String::new(),
        },
    }
}

pub fn type_of(found: &Found) -> String {
    match found {
        Found::Register(register) => register.ty().to_string(),
        Found::Number(_, ty) => ty.clone(),
        Found::Data(data) => layout::type_name(&data.ty),
        Found::Value(source) => source.ty().to_string(),
        Found::Constant(ty, _) => layout::type_name(&DataType::Elementary(*ty)),
        Found::Values(_) => String::new(),
    }
}

/// A row for what a name means.
pub fn row(name: String, expression: String, found: Found) -> Row {
    let group = match &found {
        Found::Data(data)
            if data.value_type().is_none() && matches!(data.ty, DataType::Struct(_) | DataType::Array(_)) =>
        {
            Some(Group::Parts(expression.clone(), data.clone()))
        }
        Found::Values(values) => {
            Some(Group::Values(values.iter().map(|signal| (signal.name.clone(), signal.source)).collect()))
        }
        _ => None,
    };
    Row { name, text: None, ty: type_of(&found), expression, group, found: Some(found) }
}

fn value_row(name: String, expression: String, source: Source) -> Row {
    row(name, expression, Found::Value(source))
}

fn fixed(name: &str, text: String, ty: &str) -> Row {
    Row {
        name: name.to_string(),
        found: None,
        text: Some(text),
        ty: ty.to_string(),
        expression: String::new(),
        group: None,
    }
}

fn cpu_rows(here: &Here<'_>) -> Vec<Row> {
    let time = here.cpu.clock.now();
    let mut rows = vec![
        fixed("Cycle", here.cpu.cycle_number().to_string(), "number"),
        fixed("Time", format!("{}.{:06} ms", time / NS_PER_MS, time % NS_PER_MS), "since the start"),
    ];
    if let Some(stop) = here.cpu.stopped() {
        rows.push(fixed("STOP", here.cpu.stop_text(&stop), "cause"));
    }
    rows
}

fn register_rows(here: &Here<'_>) -> Vec<Row> {
    let kept = here.kept();
    let accumulators = u32::from(here.program.profile.accumulators);
    let is_there = |name: &str| {
        name.strip_prefix("ACCU")
            .and_then(|number| number.parse::<u32>().ok())
            .is_none_or(|number| number <= accumulators)
    };
    registers::of(kept)
        .iter()
        .filter(|register| kept == Kept::Stack || is_there(register.name))
        .map(|register| row(register.name.to_string(), register.name.to_string(), Found::Register(*register)))
        .collect()
}

fn db_row(here: &Here<'_>, index: usize) -> Row {
    let db = &here.program.dbs[index];
    let address = format!("DB{}", db.number);
    let name = if db.name.is_empty() { address.clone() } else { format!("{} ({address})", db.name) };
    let (_, bytes) = here.cpu.memory.db(db.number);
    let kind = db.instance_of.map_or_else(|| format!("{bytes} bytes"), |key| format!("instance of {key}"));
    let group = (bytes > 0 && !db.members.is_empty()).then_some(Group::Db(index));
    Row { name, found: None, text: Some(kind), ty: db.data_type.clone(), expression: address, group }
}

fn db_rows(here: &Here<'_>, index: usize) -> Vec<Row> {
    let Some(db) = here.program.dbs.get(index) else { return Vec::new() };
    let (address, bytes) = here.cpu.memory.db(db.number);
    let members = db.members.iter().filter(|member| member.byte < bytes);
    members
        .map(|member| {
            let data = Data { offset: address + member.byte, bit: member.bit, ty: member.ty.clone() };
            row(member.name.clone(), format!("DB{}.{}", db.number, written(&member.name)), Found::Data(data))
        })
        .collect()
}

fn part_rows(name: &str, data: &Data, start: usize, count: usize) -> Vec<Row> {
    match &data.ty {
        DataType::Struct(structure) => {
            let members = structure.members.iter().skip(start).take(count);
            members
                .map(|member| {
                    let offset = data.offset + member.byte;
                    let part = Data { offset, bit: member.bit, ty: member.ty.clone() };
                    row(member.name.clone(), format!("{name}.{}", written(&member.name)), Found::Data(part))
                })
                .collect()
        }
        DataType::Array(array) => {
            let all = layout::element_count(&array.bounds);
            let numbers = (start as u64..all).take(count);
            numbers
                .filter_map(|number| {
                    let index = indices(&array.bounds, number);
                    Some(row(format!("[{index}]"), format!("{name}[{index}]"), Found::Data(data.element(number)?)))
                })
                .collect()
        }
        _ => Vec::new(),
    }
}

/// The indices of an element; the last runs fastest.
fn indices(bounds: &[(i32, i32)], mut number: u64) -> String {
    let mut texts: Vec<String> = Vec::new();
    for &(low, high) in bounds.iter().rev() {
        let count = (i64::from(high) - i64::from(low) + 1).max(1) as u64;
        texts.push((i64::from(low) + (number % count) as i64).to_string());
        number /= count;
    }
    texts.reverse();
    texts.join(",")
}
