//! The address space: what there is, found by name when a client asks. Nothing is kept for a node that nobody asks for.
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

use std::collections::HashMap;
use std::sync::Arc;

use plcc_abi::ProgramImage;
use plcc_abi::image::AssertType;
use plcc_abi::names::{Dimension, NamedType, TypeNumber};
use plcc_runtime::address::{self, Address, Place, Width};
use plcc_runtime::names;
use plcc_runtime::typed::{self, ValueType};

use super::code::{Id, NodeId};
use super::standard::{
    self, ANALOG_UNIT_TYPE, BASE_OBJECT_TYPE, DATA_TYPE, DATA_VARIABLE_TYPE, ENCODING_TYPE, FOLDER_TYPE, HAS_COMPONENT,
    HAS_ENCODING, HAS_PROPERTY, HAS_SUBTYPE, OBJECT, OBJECTS, ORGANIZES, PROPERTY_TYPE, VARIABLE,
};
use super::structures::{self, Compound, Field, Kind, Shape};
use super::unit::{self, Unit};
use super::values::{Variable, unit_text};
use crate::limits::{NAME_MAX, OPCUA_LISTED_MAX};

/// Namespace of the data, as on an S7-1500; 1 is that of this server, 2 is not used.
pub const DATA: u16 = 3;
/// Names of the namespaces from 2 on.
pub const NAMESPACES: [&str; 2] = ["urn:plcc:unused", "http://www.siemens.com/simatic-s7-opcua"];

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
    const ALL: [(CpuValue, &str, &str); 4] = [
        (CpuValue::State, "State", "RUN or STOP; who may control the CPU writes it"),
        (CpuValue::Clock, "Clock", "time of day of the CPU; who may control the CPU sets it"),
        (CpuValue::Cycle, "Cycle", "cycles since the start"),
        (CpuValue::Type, "Type", "the CPU of the program"),
    ];
}

/// Folders of the CPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Folder {
    Inputs,
    Outputs,
    Memory,
    Timers,
    Counters,
    DataBlocks,
}

impl Folder {
    const ALL: [(Folder, &str); 6] = [
        (Folder::Inputs, "Inputs"),
        (Folder::Outputs, "Outputs"),
        (Folder::Memory, "Memory"),
        (Folder::Timers, "Timers"),
        (Folder::Counters, "Counters"),
        (Folder::DataBlocks, "DataBlocks"),
    ];

    fn name(self) -> &'static str {
        Folder::ALL.iter().find(|(folder, _)| *folder == self).map_or("", |(_, name)| name)
    }

    fn of(place: Place) -> Folder {
        match place {
            Place::Input(_) | Place::PeripheralInput(_) => Folder::Inputs,
            Place::Output(_) | Place::PeripheralOutput(_) => Folder::Outputs,
            Place::BitMemory(_) | Place::Db(..) | Place::S7200(..) => Folder::Memory,
            Place::Timer(_) | Place::TimerValue(_) => Folder::Timers,
            Place::Counter(_) | Place::CounterValue(_) => Folder::Counters,
        }
    }
}

/// What has the value, or consists of others.
#[derive(Clone, Debug)]
struct Thing {
    /// As in its node id.
    id: String,
    name: String,
    parent: String,
    place: Place,
    bit: u8,
    ty: Ty,
    read_only: bool,
}

#[derive(Clone, Copy, Debug)]
enum Ty {
    Declared(TypeNumber),
    Plain(ValueType),
}

/// A step from a thing to a part of it.
enum Step<'a> {
    Member(&'a str),
    Index(Vec<i64>),
}

/// All nodes of a program.
pub struct Space {
    image: ProgramImage,
    generation: u64,
    /// Symbols and addresses, with their folders.
    tags: Vec<(Folder, Thing)>,
    blocks: Vec<Thing>,
    /// Those of both that have names, by name.
    roots: HashMap<String, Thing>,
    /// Of structures that can be a value, by the numbers of their types.
    shapes: Vec<Option<Arc<Shape>>>,
    /// Those that some variable has, and their places in `shapes` by name.
    data_types: Vec<Arc<Shape>>,
    by_name: HashMap<String, usize>,
}

/// What a declared type is made of.
enum Form<'a> {
    Value(ValueType),
    Array(&'a [Dimension], TypeNumber),
    Struct(&'a plcc_abi::names::NamedStruct),
    Other,
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
            image,
            generation,
            tags: Vec::new(),
            blocks: Vec::new(),
            roots: HashMap::new(),
            shapes: Vec::new(),
            data_types: Vec::new(),
            by_name: HashMap::new(),
        };
        space.find_shapes();
        space.tags = space.find_tags();
        space.blocks = space.image.dbs.iter().filter_map(|db| space.block(db)).collect();
        let tags = space.tags.iter().map(|(_, thing)| thing);
        // A block comes before a tag of its name.
        let named = tags.chain(&space.blocks).filter(|thing| thing.id.starts_with('"'));
        space.roots = named.map(|thing| (thing.name.clone(), thing.clone())).collect();
        space
    }

    /// Finds the types of structures that are a component, an element or a tag. A type comes after those of its components.
    fn find_shapes(&mut self) {
        let mut is_part = vec![false; self.image.types.len()];
        let mut part = |ty: TypeNumber| is_part.get_mut(ty as usize).into_iter().for_each(|found| *found = true);
        for ty in &self.image.types {
            match ty {
                NamedType::Struct(structure) => structure.members.iter().for_each(|member| part(member.ty)),
                NamedType::Array { element, .. } => part(*element),
                NamedType::Value(_) | NamedType::Text { .. } | NamedType::Other { .. } => {}
            }
        }
        self.image.symbols.iter().filter_map(|symbol| symbol.ty).for_each(part);
        for (number, is_part) in is_part.into_iter().enumerate() {
            let shape = if is_part { self.new_shape(number) } else { None };
            let shape = shape.map(Arc::new);
            if let Some(shape) = &shape {
                self.by_name.insert(shape.name.clone(), self.data_types.len());
                self.data_types.push(shape.clone());
            }
            self.shapes.push(shape);
        }
    }

    /// `None`: it is not a structure, or one that is not a value as a whole.
    fn new_shape(&self, number: usize) -> Option<Shape> {
        let ty = TypeNumber::try_from(number).ok()?;
        let Form::Struct(structure) = self.form(ty) else { return None };
        let kind = |ty: TypeNumber| match self.form(ty) {
            Form::Value(ty) => Some(Kind::Value(ty)),
            Form::Struct(_) => self.shapes.get(ty as usize)?.clone().map(Kind::Structure),
            Form::Array(..) | Form::Other => None,
        };
        let field = |member: &plcc_abi::names::NamedMember| {
            let (kind, dimension) = match self.form(member.ty) {
                // One dimension, as decoders of structures have it.
                Form::Array([dimension], element) => (kind(element)?, Some(dimension.clone())),
                Form::Array(..) => return None,
                Form::Value(_) | Form::Struct(_) | Form::Other => (kind(member.ty)?, None),
            };
            Some(Field { name: member.name.clone(), byte: member.byte, bit: member.bit, kind, dimension })
        };
        let fields = structure.members.iter().map(field).collect::<Option<Vec<_>>>()?;
        let declared = if structure.name.is_empty() { &structure.data_type } else { &structure.name };
        // A structure without a name, or the second one of a name.
        let is_free = |name: &str| !name.is_empty() && !self.by_name.contains_key(name);
        let name = if is_free(declared) { declared.clone() } else { format!("{declared}_{number}") };
        let node = |prefix: &str| NodeId::text(DATA, format!("{prefix}{}", quoted(&name)));
        Shape::new(name.clone(), node(DATA_TYPE_PREFIX), node(ENCODING_PREFIX), fields)
    }

    fn block(&self, db: &plcc_abi::image::DbEntry) -> Option<Thing> {
        let absolute = format!("DB{}", db.number);
        let symbol =
            || self.image.symbols.iter().find(|symbol| symbol.address == absolute).map(|symbol| symbol.name.clone());
        let name = Some(db.name.clone()).filter(|name| !name.is_empty()).or_else(symbol).unwrap_or(absolute);
        Some(Thing {
            id: quoted(&name),
            name,
            parent: Folder::DataBlocks.name().to_string(),
            place: Place::Db(db.number, 0),
            bit: 0,
            ty: Ty::Declared(db.ty?),
            read_only: db.read_only,
        })
    }

    fn find_tags(&self) -> Vec<(Folder, Thing)> {
        let mut tags: Vec<(Folder, Thing)> = Vec::new();
        for symbol in &self.image.symbols {
            let Some(address) = address::parse_for(&symbol.address, &self.image) else { continue };
            let named = names::find(&symbol.name, &self.image).ok().and_then(|named| named.ty);
            let ty = match (symbol.ty, named) {
                (Some(ty), _) if !matches!(self.form(ty), Form::Value(_) | Form::Other) => Ty::Declared(ty),
                (_, named) => Ty::Plain(named.unwrap_or(plain(address.width))),
            };
            tags.push(self.tag(quoted(&symbol.name), &symbol.name, address, ty));
        }
        for (name, named) in names::used(&self.image) {
            let is_address = address::parse_for(&name, &self.image) == Some(named.address);
            // A timer or counter of an S7-300/400 is its value.
            if is_address
                && !matches!(named.address.place, Place::Db(..) | Place::TimerValue(_) | Place::CounterValue(_))
            {
                tags.push(self.tag(format!("%{name}"), &name, named.address, Ty::Plain(plain(named.address.width))));
            }
        }
        tags
    }

    fn tag(&self, id: String, name: &str, address: Address, ty: Ty) -> (Folder, Thing) {
        // Clients want to know how long a timer runs; that it runs, they see by that.
        let (place, ty) = match address.place {
            Place::Timer(number) | Place::TimerValue(number) => {
                (Place::TimerValue(number), Ty::Plain(ValueType::of(AssertType::S5Time)))
            }
            Place::Counter(number) | Place::CounterValue(number) => {
                (Place::CounterValue(number), Ty::Plain(ValueType::of(AssertType::Signed(16))))
            }
            place => (place, ty),
        };
        let bit = if let Width::Bit(bit) = address.width { bit } else { 0 };
        let folder = Folder::of(place);
        let parent = folder.name().to_string();
        (folder, Thing { id, name: name.to_string(), parent, place, bit, ty, read_only: false })
    }

    fn form(&self, ty: TypeNumber) -> Form<'_> {
        match self.image.types.get(ty as usize) {
            Some(NamedType::Value(ty)) => Form::Value(ValueType::of(*ty)),
            Some(NamedType::Text { wide, length }) => {
                let ty = if *wide { AssertType::WideText } else { AssertType::Text };
                Form::Value(ValueType { ty, length: *length })
            }
            Some(NamedType::Struct(structure)) if structure.is_dtl => Form::Value(ValueType::of(AssertType::Dtl)),
            Some(NamedType::Struct(structure)) => Form::Struct(structure),
            Some(NamedType::Array { dimensions, element }) => Form::Array(dimensions, *element),
            Some(NamedType::Other { .. }) | None => Form::Other,
        }
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
            return Some(self.plc());
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

    fn plc(&self) -> Node {
        Node {
            id: NodeId::text(DATA, PLC),
            class: OBJECT,
            name: PLC.to_string(),
            description: format!("{} on {}", self.image.name, self.image.profile.name),
            definition: BASE_OBJECT_TYPE,
            parent: Some((NodeId::number(0, OBJECTS), ORGANIZES)),
            content: Content::None,
        }
    }

    fn thing(&self, text: &str) -> Option<Thing> {
        if let Some(address) = text.strip_prefix('%') {
            return self.address(address);
        }
        let (root, steps) = steps(text)?;
        let mut thing = self.roots.get(root)?.clone();
        for step in steps {
            thing = match step {
                Step::Member(name) => {
                    let Ty::Declared(ty) = thing.ty else { return None };
                    let Form::Struct(structure) = self.form(ty) else { return None };
                    let member = structure.members.iter().find(|member| member.name == name)?;
                    self.member(&thing, member)
                }
                Step::Index(indices) => self.element(&thing, &indices)?,
            };
        }
        // A node has one name only.
        (thing.id == text).then_some(thing)
    }

    /// A value by its address, which need not be one that the program names.
    fn address(&self, text: &str) -> Option<Thing> {
        let is_plain = !text.is_empty()
            && text.bytes().all(|byte| byte.is_ascii_uppercase() || byte.is_ascii_digit() || byte == b'.');
        let address = address::parse_for(text, &self.image).filter(|_| is_plain)?;
        let read_only = match address.place {
            Place::Db(number, _) => {
                let db = self.image.dbs.iter().find(|db| db.number == number).filter(|db| !db.optimized)?;
                db.read_only
            }
            _ => false,
        };
        let (_, mut thing) = self.tag(format!("%{text}"), text, address, Ty::Plain(plain(address.width)));
        thing.read_only = read_only;
        Some(thing)
    }

    fn member(&self, thing: &Thing, member: &plcc_abi::names::NamedMember) -> Thing {
        Thing {
            id: format!("{}.{}", thing.id, quoted(&member.name)),
            name: member.name.clone(),
            parent: thing.id.clone(),
            place: thing.place.offset(member.byte),
            bit: member.bit,
            ty: Ty::Declared(member.ty),
            read_only: thing.read_only,
        }
    }

    fn element(&self, thing: &Thing, indices: &[i64]) -> Option<Thing> {
        let Ty::Declared(ty) = thing.ty else { return None };
        let Form::Array(dimensions, element) = self.form(ty) else { return None };
        if indices.len() != dimensions.len() {
            return None;
        }
        let mut bits = u64::from(thing.bit);
        for (index, dimension) in indices.iter().zip(dimensions) {
            let (low, high) = (i64::from(dimension.low), i64::from(dimension.high));
            if !(low..=high).contains(index) {
                return None;
            }
            bits += (index - low) as u64 * u64::from(dimension.distance);
        }
        let texts: Vec<String> = indices.iter().map(ToString::to_string).collect();
        let name = format!("[{}]", texts.join(","));
        Some(Thing {
            id: format!("{}{name}", thing.id),
            name,
            parent: thing.id.clone(),
            place: thing.place.offset(u32::try_from(bits / 8).ok()?),
            bit: (bits % 8) as u8,
            ty: Ty::Declared(element),
            read_only: thing.read_only,
        })
    }

    fn thing_node(&self, thing: Thing) -> Node {
        let variable = |ty: ValueType, dimensions: &[Dimension]| Variable {
            place: thing.place,
            bit: thing.bit,
            ty,
            dimensions: dimensions.to_vec(),
            read_only: thing.read_only,
        };
        let compound = |ty: TypeNumber, dimensions: &[Dimension]| {
            let shape = self.shapes.get(ty as usize)?.clone()?;
            Some(Content::Compound(Compound {
                place: thing.place,
                shape,
                dimensions: dimensions.to_vec(),
                read_only: thing.read_only,
            }))
        };
        let memory = |ty: ValueType, dimensions: &[Dimension]| Some(Content::Memory(variable(ty, dimensions)));
        let found = match thing.ty {
            Ty::Plain(ty) => memory(ty, &[]),
            Ty::Declared(ty) => match self.form(ty) {
                Form::Value(ty) => memory(ty, &[]),
                Form::Array(dimensions, element) => match self.form(element) {
                    Form::Value(ty) => memory(ty, dimensions),
                    Form::Struct(_) => compound(element, dimensions),
                    Form::Array(..) | Form::Other => None,
                },
                // A block as a whole is not a value, as on a CPU.
                Form::Struct(_) if thing.parent == Folder::DataBlocks.name() => None,
                Form::Struct(_) => compound(ty, &[]),
                Form::Other => None,
            },
        };
        let definition = match &found {
            Some(Content::Memory(variable)) if Unit::of(variable.ty.ty).is_some() => ANALOG_UNIT_TYPE,
            Some(_) => DATA_VARIABLE_TYPE,
            None => BASE_OBJECT_TYPE,
        };
        let description = match thing.ty {
            Ty::Plain(ty) => value_text(ty),
            Ty::Declared(ty) => self.text(ty),
        };
        Node {
            parent: Some((NodeId::text(DATA, thing.parent), HAS_COMPONENT)),
            id: NodeId::text(DATA, thing.id),
            class: if found.is_some() { VARIABLE } else { OBJECT },
            name: thing.name,
            description,
            definition,
            content: found.unwrap_or(Content::None),
        }
    }

    /// A type as it is declared.
    fn text(&self, ty: TypeNumber) -> String {
        match self.form(ty) {
            Form::Value(ty) => value_text(ty),
            Form::Array(dimensions, element) => {
                let bounds: Vec<String> =
                    dimensions.iter().map(|dimension| format!("{}..{}", dimension.low, dimension.high)).collect();
                format!("ARRAY[{}] OF {}", bounds.join(", "), self.text(element))
            }
            Form::Struct(structure) => match (structure.name.as_str(), structure.data_type.as_str()) {
                ("", "") => "STRUCT".to_string(),
                ("", name) | (name, _) => name.to_string(),
            },
            Form::Other => String::new(),
        }
    }

    /// The nodes below a node, with their references.
    pub fn children(&self, node: &Node) -> Vec<(u32, Node)> {
        if let Some(number) = node.id.standard() {
            let rows = standard::ROWS.iter().filter(|row| row.parent == number && row.reference != 0);
            let mut children: Vec<_> = rows.filter_map(|row| Some((row.reference, standard_node(row.id)?))).collect();
            if number == OBJECTS {
                children.push((ORGANIZES, self.plc()));
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

    fn parts(&self, thing: &Thing) -> Vec<Thing> {
        let Ty::Declared(ty) = thing.ty else { return Vec::new() };
        match self.form(ty) {
            Form::Struct(structure) => {
                let members = structure.members.iter();
                let known = members.filter(|member| !matches!(self.form(member.ty), Form::Other));
                known.map(|member| self.member(thing, member)).collect()
            }
            Form::Array(dimensions, _) => {
                let mut indices: Vec<i64> = dimensions.iter().map(|dimension| dimension.low.into()).collect();
                let mut found = Vec::new();
                while found.len() < OPCUA_LISTED_MAX
                    && let Some(element) = self.element(thing, &indices)
                {
                    found.push(element);
                    // The last index runs fastest.
                    let next = (0..indices.len()).rev().find(|&at| indices[at] < i64::from(dimensions[at].high));
                    let Some(next) = next else { break };
                    indices[next] += 1;
                    for at in next + 1..indices.len() {
                        indices[at] = dimensions[at].low.into();
                    }
                }
                found
            }
            Form::Value(_) | Form::Other => Vec::new(),
        }
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

const PLC: &str = "PLC";
/// Before the name of a type in the ids of its node and of its encoding, as on an S7-1500.
const DATA_TYPE_PREFIX: &str = "DT_";
const ENCODING_PREFIX: &str = "TE_";
/// After the id of a variable in that of its unit.
const UNIT_SUFFIX: &str = ":EngineeringUnits";

/// Bits of a width.
fn plain(width: Width) -> ValueType {
    ValueType::of(match width {
        Width::Bit(_) => AssertType::Bool,
        width => AssertType::Bits(width.bits() as u8),
    })
}

fn value_text(ty: ValueType) -> String {
    let length = match ty.ty {
        AssertType::Text | AssertType::WideText => format!("[{}]", ty.length),
        _ => String::new(),
    };
    format!("{}{length}{}", typed::name(ty.ty), unit_text(ty.ty))
}

fn quoted(name: &str) -> String {
    format!("\"{name}\"")
}

/// Splits `"a"."b"[1,2]` into its root and the way from there.
fn steps(text: &str) -> Option<(&str, Vec<Step<'_>>)> {
    let (root, mut rest) = text.strip_prefix('"')?.split_once('"')?;
    let mut steps = Vec::new();
    while !rest.is_empty() {
        if let Some(member) = rest.strip_prefix(".\"") {
            let (name, after) = member.split_once('"')?;
            steps.push(Step::Member(name));
            rest = after;
        } else {
            let (list, after) = rest.strip_prefix('[')?.split_once(']')?;
            steps.push(Step::Index(list.split(',').map(|index| index.parse().ok()).collect::<Option<_>>()?));
            rest = after;
        }
    }
    Some((root, steps))
}

fn standard_node(number: u32) -> Option<Node> {
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

fn cpu_node((value, name, description): &(CpuValue, &str, &str)) -> Node {
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

fn data_type_node(shape: &Arc<Shape>) -> Node {
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

fn encoding_node(shape: &Shape) -> Node {
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
fn unit_node(of: &Node) -> Option<Node> {
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

fn folder_node(folder: Folder) -> Node {
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
