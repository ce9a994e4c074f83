//! What a node is, and the nodes that every program has.

use std::sync::Arc;

use plcc_abi::ProgramImage;
use plcc_runtime::address::Place;
use plcc_runtime::s7200::Part;

use super::super::code::{Id, NodeId};
use super::super::standard::{
    self, BASE_OBJECT_TYPE, DATA_TYPE, DATA_VARIABLE_TYPE, ENCODING_TYPE, FOLDER_TYPE, HAS_COMPONENT, HAS_ENCODING,
    HAS_PROPERTY, HAS_SUBTYPE, OBJECT, OBJECTS, ORGANIZES, PROPERTY_TYPE, VARIABLE,
};
use super::super::structures::{self, Compound, Shape};
use super::super::unit::{self, Unit};
use super::super::values::Variable;
use super::DATA;

pub(super) const PLC: &str = "PLC";
/// Before the name of a type in the ids of its node and of its encoding, as on an S7-1500.
pub(super) const DATA_TYPE_PREFIX: &str = "DT_";
pub(super) const ENCODING_PREFIX: &str = "TE_";
/// After the id of a variable in that of its unit.
pub(super) const UNIT_SUFFIX: &str = ":EngineeringUnits";

/// A node.
#[derive(Clone, Debug)]
pub struct Node {
    pub id: NodeId,
    pub class: u32,
    pub name: String,
    pub description: String,
    /// Number of its type definition; 0: none.
    pub definition: u32,
    /// The node above it, and the reference from there.
    pub parent: Option<(NodeId, u32)>,
    pub content: Content,
}

/// Where its value comes from.
#[derive(Clone, Debug)]
pub enum Content {
    None,
    /// A variable of the standard, by its number.
    Standard(u32),
    Cpu(CpuValue),
    Memory(Variable),
    /// A structure, or an array of them.
    Compound(Compound),
    /// The unit of the variable above it.
    Unit(Unit),
    /// The type of a structure.
    DataType(Arc<Shape>),
}

impl Node {
    /// Namespace of its name: properties have names of the standard.
    pub fn name_space(&self) -> u16 {
        match self.content {
            Content::Unit(_) => 0,
            Content::None
            | Content::Standard(_)
            | Content::Cpu(_)
            | Content::Memory(_)
            | Content::Compound(_)
            | Content::DataType(_) => match self.definition {
                ENCODING_TYPE => 0,
                _ => self.id.namespace,
            },
        }
    }
}

/// Properties of the CPU itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CpuValue {
    State,
    Clock,
    Cycle,
    Type,
}

impl CpuValue {
    pub(super) const ALL: [(CpuValue, &str, &str); 4] = [
        (CpuValue::State, "State", "RUN or STOP; who may control the CPU writes it"),
        (CpuValue::Clock, "Clock", "time of day of the CPU; who may control the CPU sets it"),
        (CpuValue::Cycle, "Cycle", "cycles since the start"),
        (CpuValue::Type, "Type", "the CPU of the program"),
    ];
}

/// Folders of the CPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Folder {
    Inputs,
    Outputs,
    Memory,
    Timers,
    Counters,
    DataBlocks,
}

impl Folder {
    pub(super) const ALL: [(Folder, &str); 6] = [
        (Folder::Inputs, "Inputs"),
        (Folder::Outputs, "Outputs"),
        (Folder::Memory, "Memory"),
        (Folder::Timers, "Timers"),
        (Folder::Counters, "Counters"),
        (Folder::DataBlocks, "DataBlocks"),
    ];

    pub(super) fn name(self) -> &'static str {
        Folder::ALL.iter().find(|(folder, _)| *folder == self).map_or("", |(_, name)| name)
    }

    pub(super) fn of(place: Place) -> Folder {
        match place {
            Place::Input(_) | Place::PeripheralInput(_) => Folder::Inputs,
            Place::Output(_) | Place::PeripheralOutput(_) => Folder::Outputs,
            Place::BitMemory(_) | Place::Db(..) => Folder::Memory,
            Place::Timer(_) | Place::TimerValue(_) => Folder::Timers,
            Place::Counter(_) | Place::CounterValue(_) => Folder::Counters,
            Place::S7200(part, _) => match part {
                Part::AnalogInput => Folder::Inputs,
                Part::AnalogOutput => Folder::Outputs,
                Part::TimerBit | Part::TimerValue => Folder::Timers,
                Part::CounterBit | Part::CounterValue | Part::HighSpeedCounter => Folder::Counters,
                Part::SpecialMemory | Part::Relays | Part::Accumulator => Folder::Memory,
            },
        }
    }
}

/// The CPU of a program.
pub(super) fn plc_node(image: &ProgramImage) -> Node {
    Node {
        id: NodeId::text(DATA, PLC),
        class: OBJECT,
        name: PLC.to_string(),
        description: format!("{} on {}", image.name, image.profile.name),
        definition: BASE_OBJECT_TYPE,
        parent: Some((NodeId::number(0, OBJECTS), ORGANIZES)),
        content: Content::None,
    }
}

pub(super) fn standard_node(number: u32) -> Option<Node> {
    let row = standard::row(number)?;
    Some(Node {
        id: NodeId::number(0, number),
        class: row.class,
        name: row.name.to_string(),
        description: String::new(),
        definition: row.definition,
        parent: (row.reference != 0).then(|| (NodeId::number(0, row.parent), row.reference)),
        content: if row.class == VARIABLE { Content::Standard(number) } else { Content::None },
    })
}

pub(super) fn cpu_node((value, name, description): &(CpuValue, &str, &str)) -> Node {
    Node {
        id: NodeId::text(DATA, format!("{PLC}.{name}")),
        class: VARIABLE,
        name: (*name).to_string(),
        description: (*description).to_string(),
        definition: DATA_VARIABLE_TYPE,
        parent: Some((NodeId::text(DATA, PLC), HAS_COMPONENT)),
        content: Content::Cpu(*value),
    }
}

pub(super) fn data_type_node(shape: &Arc<Shape>) -> Node {
    Node {
        id: shape.data_type.clone(),
        class: DATA_TYPE,
        name: shape.name.clone(),
        description: String::new(),
        definition: 0,
        parent: Some((NodeId::number(0, structures::BASE), HAS_SUBTYPE)),
        content: Content::DataType(shape.clone()),
    }
}

pub(super) fn encoding_node(shape: &Shape) -> Node {
    Node {
        id: shape.encoding.clone(),
        class: OBJECT,
        name: "Default Binary".to_string(),
        description: String::new(),
        definition: ENCODING_TYPE,
        parent: Some((shape.data_type.clone(), HAS_ENCODING)),
        content: Content::None,
    }
}

/// The unit of a variable, if it has one.
pub(super) fn unit_node(of: &Node) -> Option<Node> {
    let (Content::Memory(variable), Id::Text(id)) = (&of.content, &of.id.id) else { return None };
    Some(Node {
        id: NodeId::text(DATA, format!("{id}{UNIT_SUFFIX}")),
        class: VARIABLE,
        name: unit::NAME.to_string(),
        description: String::new(),
        definition: PROPERTY_TYPE,
        parent: Some((of.id.clone(), HAS_PROPERTY)),
        content: Content::Unit(Unit::of(variable.ty.ty)?),
    })
}

pub(super) fn folder_node(folder: Folder) -> Node {
    Node {
        id: NodeId::text(DATA, folder.name()),
        class: OBJECT,
        name: folder.name().to_string(),
        description: String::new(),
        definition: FOLDER_TYPE,
        parent: Some((NodeId::text(DATA, PLC), HAS_COMPONENT)),
        content: Content::None,
    }
}
