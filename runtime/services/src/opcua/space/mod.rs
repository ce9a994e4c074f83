//! The address space: what there is, found by name when a client asks. Nothing is kept for a node that is not asked for.
//!
//! ```text
//! Objects
//!   PLC                       ns=3;s=PLC
//!     State, Clock, Cycle, Type
//!     Inputs, Outputs, Memory, Timers, Counters
//!       Motor                 ns=3;s="Motor"
//!       MW10                  ns=3;s=%MW10
//!     DataBlocks
//!       Station               ns=3;s="Station"
//!         D1                  ns=3;s="Station"."D1"
//!           [1]               ns=3;s="Station"."D1"[1]
//! ```
//!
//! [`node`] says what a node is and makes those that every program has, [`thing`] what is behind a name or an address, [`tags`] which names and
//! addresses a program has, and [`shapes`] which of its types are types of OPC UA.

mod node;
mod shapes;
mod tags;
mod thing;

use std::collections::HashMap;
use std::sync::Arc;

use plcc_abi::ProgramImage;
use plcc_abi::names::External;
use plcc_runtime::names::Limits;

use super::code::{Id, NodeId};
use super::standard::{self, HAS_COMPONENT, HAS_ENCODING, HAS_PROPERTY, HAS_SUBTYPE, OBJECTS, ORGANIZES};
use super::structures::{self, Shape};
use crate::limits::NAME_MAX;
pub use node::{Content, CpuValue, Node};
use node::{
    DATA_TYPE_PREFIX, ENCODING_PREFIX, Folder, PLC, UNIT_SUFFIX, cpu_node, data_type_node, encoding_node, folder_node,
    plc_node, standard_node, unit_node,
};
use thing::{Thing, quoted};

/// Namespace of the data, as on an S7-1500; 1 is that of this server, 2 is not used.
pub const DATA: u16 = 3;
/// Names of the namespaces from 2 on.
pub const NAMESPACES: [&str; 2] = ["urn:plcc:unused", "http://www.siemens.com/simatic-s7-opcua"];

/// All nodes of a program.
pub struct Space {
    image: ProgramImage,
    generation: u64,
    /// Symbols and addresses, with their folders.
    tags: Vec<(Folder, Thing)>,
    blocks: Vec<Thing>,
    /// Those of both that have names, by name.
    roots: HashMap<String, Thing>,
    /// What clients may do with all of a value, by the numbers of the types.
    least: Vec<External>,
    /// What clients may do with tags.
    limits: Limits,
    /// Of structures that can be a value, by the numbers of their types.
    shapes: Vec<Option<Arc<Shape>>>,
    /// Those that some variable has, and their places in `shapes` by name.
    data_types: Vec<Arc<Shape>>,
    by_name: HashMap<String, usize>,
}

impl Space {
    /// `generation`: how often the program had been changed.
    pub fn new(image: &ProgramImage, generation: u64) -> Space {
        // Names and types are needed, not what is in the blocks.
        let mut image = image.clone();
        image.blocks.clear();
        image.asserts.clear();
        image.config.services.drawings.clear();
        image.dbs.iter_mut().for_each(|db| db.data.clear());
        let mut space = Space {
            limits: Limits::new(&image),
            image,
            generation,
            tags: Vec::new(),
            blocks: Vec::new(),
            roots: HashMap::new(),
            least: Vec::new(),
            shapes: Vec::new(),
            data_types: Vec::new(),
            by_name: HashMap::new(),
        };
        space.find_least();
        space.find_shapes();
        space.tags = space.find_tags();
        space.blocks = space.image.dbs.iter().filter_map(|db| space.block(db)).collect();
        let tags = space.tags.iter().map(|(_, thing)| thing);
        // A block comes before a tag of its name.
        let named = tags.chain(&space.blocks).filter(|thing| thing.id.starts_with('"'));
        space.roots = named.map(|thing| (thing.name.clone(), thing.clone())).collect();
        space
    }

    /// The node with an id.
    pub fn node(&self, id: &NodeId) -> Option<Node> {
        match (id.namespace, &id.id) {
            (0, Id::Number(number)) => standard_node(*number),
            (DATA, Id::Text(text)) if text.len() <= NAME_MAX => self.data(text),
            _ => None,
        }
    }

    fn data(&self, text: &str) -> Option<Node> {
        if text == PLC {
            return Some(plc_node(&self.image));
        }
        if let Some(value) = text.strip_prefix("PLC.") {
            return CpuValue::ALL.iter().find(|(_, name, _)| *name == value).map(cpu_node);
        }
        if let Some((folder, _)) = Folder::ALL.iter().find(|(_, name)| *name == text) {
            return Some(folder_node(*folder));
        }
        let shape = |prefix: &str| {
            let name = text.strip_prefix(prefix)?.strip_prefix('"')?.strip_suffix('"')?;
            self.data_types.get(*self.by_name.get(name)?)
        };
        if let Some(shape) = shape(DATA_TYPE_PREFIX) {
            return Some(data_type_node(shape));
        }
        if let Some(shape) = shape(ENCODING_PREFIX) {
            return Some(encoding_node(shape));
        }
        if let Some(of) = text.strip_suffix(UNIT_SUFFIX) {
            return unit_node(&self.thing_node(self.thing(of)?));
        }
        self.thing(text).map(|thing| self.thing_node(thing))
    }

    /// The nodes below a node, with their references.
    pub fn children(&self, node: &Node) -> Vec<(u32, Node)> {
        if let Some(number) = node.id.standard() {
            let rows = standard::ROWS.iter().filter(|row| row.parent == number && row.reference != 0);
            let mut children: Vec<_> = rows.filter_map(|row| Some((row.reference, standard_node(row.id)?))).collect();
            if number == OBJECTS {
                children.push((ORGANIZES, plc_node(&self.image)));
            }
            if number == structures::BASE {
                children.extend(self.data_types.iter().map(|shape| (HAS_SUBTYPE, data_type_node(shape))));
            }
            return children;
        }
        if let Content::DataType(shape) = &node.content {
            return vec![(HAS_ENCODING, encoding_node(shape))];
        }
        let Id::Text(text) = &node.id.id else { return Vec::new() };
        if text == PLC {
            let values = CpuValue::ALL.iter().map(cpu_node);
            return values
                .chain(Folder::ALL.iter().map(|(folder, _)| folder_node(*folder)))
                .map(|node| (HAS_COMPONENT, node))
                .collect();
        }
        let things: Vec<Thing> = match Folder::ALL.iter().find(|(_, name)| name == text) {
            Some((Folder::DataBlocks, _)) => self.blocks.clone(),
            Some((folder, _)) => {
                self.tags.iter().filter(|(own, _)| own == folder).map(|(_, thing)| thing.clone()).collect()
            }
            None => self.thing(text).map(|thing| self.parts(&thing)).unwrap_or_default(),
        };
        let parts = things.into_iter().map(|thing| (HAS_COMPONENT, self.thing_node(thing)));
        parts.chain(unit_node(node).map(|unit| (HAS_PROPERTY, unit))).collect()
    }

    /// The node of this name below a node. It is looked up, not looked for: there may be many others.
    pub fn child(&self, node: &Node, name: &str) -> Option<Node> {
        if name.len() > NAME_MAX {
            return None;
        }
        if node.id.namespace == 0 || matches!(node.content, Content::DataType(_)) {
            return self.children(node).into_iter().map(|(_, child)| child).find(|child| child.name == name);
        }
        let Id::Text(id) = &node.id.id else { return None };
        let ids = [
            format!("{id}.{}", quoted(name)),
            format!("{id}{name}"),
            quoted(name),
            format!("%{name}"),
            format!("{id}.{name}"),
            format!("{id}:{name}"),
            name.to_string(),
        ];
        let found = ids.into_iter().filter_map(|id| self.node(&NodeId::text(DATA, id)));
        let mut below = found.filter(|child| child.parent.as_ref().is_some_and(|(parent, _)| *parent == node.id));
        below.find(|child| child.name == name)
    }

    /// Whether what clients have learnt of another program's structures is true of this one.
    pub fn has_types_of(&self, other: &Space) -> bool {
        other.data_types.iter().all(|shape| {
            let own = self.by_name.get(&shape.name).and_then(|place| self.data_types.get(*place));
            own.is_some_and(|own| own == shape)
        })
    }

    pub fn generation(&self) -> u64 {
        self.generation
    }

    pub fn program(&self) -> &str {
        &self.image.name
    }
}
