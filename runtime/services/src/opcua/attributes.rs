//! Attributes of nodes: reading many of them in one cycle, and writing values.

use plcc_abi::image::Family;
use plcc_abi::services::Right;
use plcc_runtime::cpu::Cpu;
use plcc_runtime::datetime;
use plcc_runtime::options::Restart;

use super::Server;
use super::code::{DataValue, NodeId, Reader, Scalar, Variant, Writer, moment_of, now, time_of};
use super::events::EVENT_NOTIFIER;
use super::range::Range;
use super::space::{Content, CpuValue, DATA, NAMESPACES, Node};
use super::standard;
use super::status::{self, Status};
use super::structures::{self, Compound, Values};
use super::unit;
use super::values::{Part, Variable, type_of};
use crate::limits::{
    OPCUA_BROWSED_MAX, OPCUA_CONTINUATIONS_MAX, OPCUA_ELEMENTS_MAX, OPCUA_NODES_MAX, OPCUA_READ_MAX, OPCUA_SAMPLING_MIN,
};

/// The attribute with the value.
pub const VALUE: u32 = 13;
/// Types of the standard that are numbers: SByte to Double.
const NUMBERS: std::ops::RangeInclusive<u32> = 2..=11;
/// Rights of a variable.
const CURRENT_READ: u8 = 1;
const CURRENT_WRITE: u8 = 2;

/// What is needed to tell an attribute.
#[derive(Clone, Debug)]
pub enum Wanted {
    Ready(Variant),
    Wrong(Status),
    /// A variable of the standard, by its number.
    Standard(u32),
    Memory(Variable),
    Compound(Compound),
    Cpu(CpuValue),
    /// Some elements of it.
    Part(Box<Wanted>, Range),
}

impl Wanted {
    /// It is looked up in the CPU.
    fn is_of_cpu(&self) -> bool {
        match self {
            Wanted::Memory(_) | Wanted::Compound(_) | Wanted::Cpu(_) => true,
            // The CPU may have another program by now, which has it.
            Wanted::Wrong(why) => *why == status::NODE_UNKNOWN,
            Wanted::Ready(_) | Wanted::Standard(_) => false,
            Wanted::Part(all, _) => all.is_of_cpu(),
        }
    }

    /// How much it takes to keep its value: elements, or 32 bytes of a text each.
    pub fn cost(&self) -> u32 {
        match self {
            Wanted::Memory(variable) => variable.cost().unwrap_or(1),
            Wanted::Compound(compound) => compound.cost().unwrap_or(1),
            Wanted::Part(all, _) => all.cost(),
            Wanted::Ready(_) | Wanted::Wrong(_) | Wanted::Standard(_) | Wanted::Cpu(_) => 1,
        }
    }

    /// Its value is a number or an array of numbers, so that a deadband has a meaning.
    pub fn is_number(&self) -> bool {
        match self {
            Wanted::Ready(Variant::One(scalar)) => scalar.number().is_some(),
            Wanted::Standard(number) => standard::row(*number).is_some_and(|row| NUMBERS.contains(&row.value)),
            Wanted::Memory(variable) => NUMBERS.contains(&u32::from(type_of(variable.ty.ty))),
            Wanted::Cpu(value) => *value == CpuValue::Cycle,
            Wanted::Part(all, _) => all.is_number(),
            // The program that had it may come back.
            Wanted::Wrong(_) => true,
            Wanted::Ready(Variant::Empty | Variant::Many { .. }) | Wanted::Compound(_) => false,
        }
    }
}

/// What was found at the cycle control point.
enum Found {
    Ready,
    Bytes(Result<Vec<u8>, Status>),
    Value(Scalar),
}

/// An attribute of a node: the number, and how a client wants a value.
#[derive(Clone, Debug)]
pub struct Question {
    pub node: NodeId,
    pub attribute: u32,
    pub range: String,
    pub encoding: String,
}

impl Question {
    pub fn read(reader: &mut Reader) -> Option<Question> {
        let (node, attribute, range, encoding) = (reader.node()?, reader.u32()?, reader.text()?, reader.name()?.1);
        Some(Question { node, attribute, range, encoding })
    }

    /// Finds it.
    pub fn wanted(&self, server: &Server, right: Right) -> Wanted {
        let all = wanted(server, &self.node, self.attribute, right);
        match (Range::parse(&self.range), self.encoding.as_str()) {
            _ if matches!(all, Wanted::Wrong(_)) => all,
            (Ok(None), "" | "Default Binary") => all,
            (Ok(Some(range)), "" | "Default Binary") => Wanted::Part(Box::new(all), range),
            (Ok(_), _) => Wanted::Wrong(status::ENCODING_INVALID),
            (Err(status), _) => Wanted::Wrong(status),
        }
    }
}

fn wanted(server: &Server, id: &NodeId, attribute: u32, right: Right) -> Wanted {
    match server.space.node(id) {
        Some(node) => match (attribute, &node.content) {
            (VALUE, Content::Memory(variable)) => Wanted::Memory(variable.clone()),
            (VALUE, Content::Compound(compound)) => Wanted::Compound(compound.clone()),
            (VALUE, Content::Unit(unit)) => Wanted::Ready(Variant::One(unit.value())),
            (VALUE, Content::Cpu(value)) => Wanted::Cpu(*value),
            (VALUE, Content::Standard(number)) => Wanted::Standard(*number),
            (VALUE, Content::None | Content::DataType(_)) => Wanted::Wrong(status::ATTRIBUTE_INVALID),
            _ => constant(&node, attribute, right).map_or_else(Wanted::Wrong, Wanted::Ready),
        },
        None => Wanted::Wrong(status::NODE_UNKNOWN),
    }
}

/// Reads all of them in one cycle. `None`: the CPU has ended, or has another program.
pub async fn read(server: &Server, wanted: Vec<Wanted>) -> Option<Vec<DataValue>> {
    if !wanted.iter().any(Wanted::is_of_cpu) {
        return Some(wanted.into_iter().map(|wanted| data_value(server, wanted, Found::Ready, now())).collect());
    }
    let generation = server.space.generation();
    let (wanted, found, time) = server
        .link
        .ask(move |cpu| {
            if cpu.generation() != generation {
                return None;
            }
            let mut room = OPCUA_READ_MAX;
            let found: Vec<Found> = wanted.iter().map(|wanted| look(cpu, wanted, &mut room)).collect();
            Some((wanted, found, time_of(cpu.clock.wall())))
        })
        .await??;
    Some(wanted.into_iter().zip(found).map(|(wanted, found)| data_value(server, wanted, found, time)).collect())
}

fn look(cpu: &Cpu, wanted: &Wanted, room: &mut u32) -> Found {
    match wanted {
        Wanted::Ready(_) | Wanted::Wrong(_) | Wanted::Standard(_) => Found::Ready,
        Wanted::Memory(variable) => Found::Bytes(variable.cost().and_then(|cost| {
            *room = room.checked_sub(cost).ok_or(status::RESPONSE_TOO_LARGE)?;
            variable.read(cpu)
        })),
        Wanted::Compound(compound) => Found::Bytes(compound.cost().and_then(|cost| {
            *room = room.checked_sub(cost).ok_or(status::RESPONSE_TOO_LARGE)?;
            compound.read(cpu)
        })),
        Wanted::Part(all, _) => look(cpu, all, room),
        Wanted::Cpu(CpuValue::State) => {
            Found::Value(Scalar::Text(if cpu.is_stopped() { "STOP" } else { "RUN" }.to_string()))
        }
        Wanted::Cpu(CpuValue::Clock) => Found::Value(Scalar::Time(time_of(cpu.clock.wall()))),
        Wanted::Cpu(CpuValue::Cycle) => Found::Value(Scalar::UInt64(cpu.cycle_number())),
        Wanted::Cpu(CpuValue::Type) => Found::Value(Scalar::Text(cpu.image.profile.name.clone())),
    }
}

fn data_value(server: &Server, wanted: Wanted, found: Found, time: i64) -> DataValue {
    let value = match (wanted, found) {
        (Wanted::Part(all, range), found) => {
            let DataValue { value, status, .. } = data_value(server, *all, found, time);
            if status == status::GOOD { range.of(value) } else { Err(status) }
        }
        (Wanted::Compound(compound), Found::Bytes(bytes)) => bytes.and_then(|bytes| compound.value(&bytes)),
        (Wanted::Memory(variable), Found::Bytes(bytes)) => bytes.and_then(|bytes| variable.value(&bytes)),
        (_, Found::Value(value)) => Ok(Variant::One(value)),
        (Wanted::Ready(value), _) => Ok(value),
        (Wanted::Wrong(status), _) => Err(status),
        (Wanted::Standard(number), _) => standard_value(server, number),
        (Wanted::Memory(_) | Wanted::Compound(_) | Wanted::Cpu(_), Found::Ready | Found::Bytes(_)) => {
            Err(status::INTERNAL)
        }
    };
    match value {
        Ok(value) => DataValue { value, status: status::GOOD, time },
        Err(status) => DataValue::wrong(status),
    }
}

/// The value of an attribute that does not change.
fn constant(node: &Node, attribute: u32, right: Right) -> Result<Variant, Status> {
    let is_variable = node.class == standard::VARIABLE;
    let is_type = node.class > standard::VARIABLE;
    let is_reference = node
        .id
        .standard()
        .and_then(standard::row)
        .is_some_and(|row| standard::is_kind_of(row.id, standard::REFERENCES, true));
    let dimensions = match &node.content {
        Content::Memory(variable) => variable.lengths(),
        Content::Compound(compound) => compound.lengths(),
        Content::Standard(2254 | 2255 | 2269 | 2271) => vec![0],
        Content::None | Content::Standard(_) | Content::Cpu(_) | Content::Unit(_) | Content::DataType(_) => Vec::new(),
    };
    let most = access(node);
    Ok(Variant::One(match attribute {
        1 => Scalar::Node(node.id.clone()),
        2 => Scalar::Int32(node.class as i32),
        3 => Scalar::Name(node.name_space(), node.name.clone()),
        4 => Scalar::Localized(node.name.clone()),
        5 => Scalar::Localized(node.description.clone()),
        6 | 7 => Scalar::UInt32(0),
        8 if is_type => Scalar::Bool(false),
        9 if is_reference => Scalar::Bool(false),
        10 if is_reference => Scalar::Localized(String::new()),
        // It has events that can be subscribed to.
        EVENT_NOTIFIER if node.class == standard::OBJECT => {
            Scalar::Byte(u8::from(node.id.standard() == Some(standard::SERVER)))
        }
        14 if is_variable => Scalar::Node(value_type(node)),
        15 if is_variable => Scalar::Int32(if dimensions.is_empty() { -1 } else { dimensions.len() as i32 }),
        16 if is_variable && !dimensions.is_empty() => {
            return Ok(Variant::list(7, dimensions.into_iter().map(Scalar::UInt32).collect()));
        }
        17 if is_variable => Scalar::Byte(most),
        18 if is_variable => Scalar::Byte(if right >= needed(node) { most } else { CURRENT_READ }),
        19 if is_variable => Scalar::Double(OPCUA_SAMPLING_MIN.as_secs_f64() * 1000.0),
        20 if is_variable => Scalar::Bool(false),
        23 => match &node.content {
            Content::DataType(shape) => shape.definition(),
            _ => return Err(status::ATTRIBUTE_INVALID),
        },
        _ => return Err(status::ATTRIBUTE_INVALID),
    }))
}

fn access(node: &Node) -> u8 {
    let is_writable = match &node.content {
        Content::None | Content::Standard(_) | Content::Unit(_) | Content::DataType(_) => false,
        Content::Compound(compound) => compound.is_writable(),
        Content::Cpu(value) => matches!(value, CpuValue::State | CpuValue::Clock),
        Content::Memory(variable) => variable.is_writable(),
    };
    if is_writable { CURRENT_READ | CURRENT_WRITE } else { CURRENT_READ }
}

/// What a client must be allowed to write the value.
fn needed(node: &Node) -> Right {
    if let Content::Cpu(_) = node.content { Right::Control } else { Right::Write }
}

/// The type of a value.
fn value_type(node: &Node) -> NodeId {
    let number = match &node.content {
        Content::None | Content::DataType(_) => 24,
        Content::Unit(_) => unit::TYPE,
        Content::Compound(compound) => return compound.shape.data_type.clone(),
        Content::Standard(number) => standard::row(*number).map_or(24, |row| row.value),
        Content::Cpu(CpuValue::State | CpuValue::Type) => 12,
        Content::Cpu(CpuValue::Clock) => 13,
        Content::Cpu(CpuValue::Cycle) => 9,
        Content::Memory(variable) => type_of(variable.ty.ty).into(),
    };
    NodeId::number(0, number)
}

fn standard_value(server: &Server, number: u32) -> Result<Variant, Status> {
    let texts =
        |texts: &[&str]| Variant::list(12, texts.iter().map(|text| Scalar::Text((*text).to_string())).collect());
    Ok(match number {
        2254 => texts(&[&server.uri]),
        2255 => {
            let [unused, data] = NAMESPACES;
            debug_assert_eq!(DATA, 3);
            texts(&["http://opcfoundation.org/UA/", &server.uri, unused, data])
        }
        2269 => texts(&["http://opcfoundation.org/UA-Profile/Server/EmbeddedUA2017"]),
        2271 => texts(&["en"]),
        _ => Variant::One(match number {
            2256 => Scalar::Object(NodeId::number(0, 864), server_status(server)),
            2257 => Scalar::Time(server.started),
            2258 => Scalar::Time(now()),
            2259 => Scalar::Int32(0),
            2267 => Scalar::Byte(255),
            2272 => Scalar::Double(OPCUA_SAMPLING_MIN.as_secs_f64() * 1000.0),
            2735 => Scalar::UInt16(OPCUA_CONTINUATIONS_MAX as u16),
            11702 => Scalar::UInt32(OPCUA_ELEMENTS_MAX),
            11710 => Scalar::UInt32(OPCUA_BROWSED_MAX as u32),
            11705 | 11707 | 11712 | 11714 => Scalar::UInt32(OPCUA_NODES_MAX as u32),
            _ => return Err(status::ATTRIBUTE_INVALID),
        }),
    })
}

/// ServerStatusDataType.
fn server_status(server: &Server) -> Vec<u8> {
    let mut out = Writer::default();
    out.i64(server.started);
    out.i64(now());
    out.i32(0);
    out.text("urn:plcc");
    out.text("plcc");
    out.text(server.space.program());
    out.text(env!("CARGO_PKG_VERSION"));
    out.text("");
    out.i64(0);
    out.u32(0);
    out.localized("");
    out.0
}

/// A value on its way to the CPU.
pub enum Change {
    Wrong(Status),
    Memory(Variable, Vec<Part>),
    Compound(Values),
    /// RUN or STOP.
    Run(bool),
    /// Nanoseconds since 1970.
    Clock(i64),
}

/// Checks what a client wants to write: the value of a node, or some of its elements.
pub fn change(
    server: &Server,
    (id, attribute): (&NodeId, u32),
    value: &Variant,
    range: Option<&Range>,
    right: Right,
) -> Change {
    let Some(node) = server.space.node(id) else { return Change::Wrong(status::NODE_UNKNOWN) };
    if attribute != VALUE || access(&node) & CURRENT_WRITE == 0 {
        return Change::Wrong(status::NOT_WRITABLE);
    }
    if right < needed(&node) {
        return Change::Wrong(status::USER_ACCESS_DENIED);
    }
    match (node.content, value) {
        (Content::Memory(variable), value) => match variable.parts(value, range) {
            Ok(parts) => Change::Memory(variable, parts),
            Err(status) => Change::Wrong(status),
        },
        (Content::Compound(compound), value) => match compound.parts(value, range) {
            Ok(values) => Change::Compound(values),
            Err(status) => Change::Wrong(status),
        },
        (Content::Cpu(_), _) if range.is_some() => Change::Wrong(status::INDEX_RANGE_INVALID),
        (Content::Cpu(CpuValue::State), Variant::One(Scalar::Text(text))) => match text.as_str() {
            "RUN" => Change::Run(true),
            "STOP" => Change::Run(false),
            _ => Change::Wrong(status::OUT_OF_RANGE),
        },
        (Content::Cpu(CpuValue::Clock), Variant::One(Scalar::Time(time))) => match moment_of(*time) {
            Some(moment) if moment >= 0 => Change::Clock(moment),
            Some(_) | None => Change::Wrong(status::OUT_OF_RANGE),
        },
        _ => Change::Wrong(status::TYPE_MISMATCH),
    }
}

/// Writes all of them between two cycles, in their order. `None`: the CPU has ended, or has another program.
pub async fn write(server: &Server, changes: Vec<Change>) -> Option<Vec<Status>> {
    let generation = server.space.generation();
    let written = server.link.ask(move |cpu| {
        let write = |change: &Change| apply(cpu, change).err().unwrap_or(status::GOOD);
        (cpu.generation() == generation).then(|| changes.iter().map(write).collect())
    });
    written.await?
}

fn apply(cpu: &Cpu, change: &Change) -> Result<(), Status> {
    match change {
        Change::Wrong(status) => return Err(*status),
        Change::Memory(variable, parts) => return variable.write(cpu, parts),
        Change::Compound(values) => return structures::write(cpu, values),
        Change::Run(true) if cpu.is_stopped() && !cpu.request_restart(Restart::Warm) => return Err(status::INTERNAL),
        Change::Run(true) => {}
        Change::Run(false) => cpu.stop_by_request(),
        Change::Clock(moment) if !has_moment(cpu.image.profile.family, *moment) => return Err(status::OUT_OF_RANGE),
        Change::Clock(moment) => cpu.set_wall_clock(*moment),
    }
    Ok(())
}

/// Whether the clock of a CPU can be set to a moment. Programs of an S7-200/300/400 read it as DATE_AND_TIME, from 1990 to 2089.
fn has_moment(family: Family, moment: i64) -> bool {
    const NS_PER_MS: u64 = 1_000_000;
    let is_near = |back: i64| back.abs_diff(moment) < NS_PER_MS;
    family.is_portal() || datetime::decode(datetime::encode(moment)).is_ok_and(is_near)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_has_the_years_of_its_family() {
        let year = |year: i64| (year - 1970) * 365 * 86_400 * 1_000_000_000 + 40 * 86_400 * 1_000_000_000;
        for (moment, is_old) in [(year(1975), false), (year(1991), true), (year(2088), true), (year(2095), false)] {
            assert_eq!(has_moment(Family::S7300, moment), is_old, "{moment}");
            assert!(has_moment(Family::S71500, moment));
        }
    }
}
