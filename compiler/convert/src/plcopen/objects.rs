//! The objects of an LD or FBD body, and how they are written.

use crate::node::Node;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    LeftRail,
    RightRail,
    Contact,
    Coil,
    Block,
    /// A value that others read.
    InVariable,
    /// A variable that is written.
    OutVariable,
    Label,
    Jump,
    Return,
    Comment,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Storage {
    #[default]
    None,
    Set,
    Reset,
}

/// Where a signal comes from: an object, and the pin of a block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    pub object: usize,
    pub pin: String,
}

/// What a line leads to.
#[derive(Clone, Debug, Default)]
pub struct Input {
    pub formal: String,
    pub from: Vec<Origin>,
    pub negated: bool,
    pub in_out: bool,
}

#[derive(Clone, Debug)]
pub struct Output {
    pub formal: String,
    pub negated: bool,
}

/// An object. Places are those of its upper left corner.
#[derive(Clone, Debug)]
pub struct Object {
    pub kind: Kind,
    /// Operand, type of a block, label, or comment.
    pub text: String,
    pub instance: Option<String>,
    pub negated: bool,
    /// `rising`, `falling`; empty: none.
    pub edge: &'static str,
    pub storage: Storage,
    pub inputs: Vec<Input>,
    pub outputs: Vec<Output>,
    /// When it runs; 0: not at a time of its own.
    pub order: u32,
    pub x: i32,
    pub y: i32,
    pub width: i32,
    pub height: i32,
    /// Where lines from it go up and down, after its column.
    pub exit: i32,
}

/// From the top of a block to its first pin, and from pin to pin.
pub const PIN_FIRST: i32 = 40;
pub const PIN_PITCH: i32 = 30;
/// Height of contacts, coils and variables.
pub const ROW: i32 = 20;
/// Width of a letter.
const LETTER: i32 = 8;

pub fn text_width(text: &str) -> i32 {
    i32::try_from(text.chars().count()).unwrap_or(i32::MAX / LETTER).saturating_mul(LETTER)
}

impl Object {
    pub fn new(kind: Kind, text: impl Into<String>) -> Object {
        Object {
            kind,
            text: text.into(),
            instance: None,
            negated: false,
            edge: "",
            storage: Storage::None,
            inputs: Vec::new(),
            outputs: Vec::new(),
            order: 0,
            x: 0,
            y: 0,
            width: 0,
            height: 0,
            exit: 0,
        }
    }

    /// Gives it the size that its texts need.
    pub fn measure(&mut self) {
        let text = text_width(&self.text);
        (self.width, self.height) = match self.kind {
            Kind::LeftRail | Kind::RightRail => (10, 40),
            Kind::Contact | Kind::Coil => (30, ROW),
            Kind::InVariable | Kind::OutVariable | Kind::Label | Kind::Jump | Kind::Return => (text.max(20) + 10, ROW),
            Kind::Comment => {
                let lines = self.text.lines();
                let widest = lines.clone().map(text_width).max().unwrap_or(0);
                (widest.clamp(100, 1200) + 20, 10 + 20 * i32::try_from(lines.count().max(1)).unwrap_or(1))
            }
            Kind::Block => {
                let longest =
                    |names: &mut dyn Iterator<Item = &String>| names.map(|name| text_width(name)).max().unwrap_or(0);
                let pins = longest(&mut self.inputs.iter().map(|pin| &pin.formal))
                    + longest(&mut self.outputs.iter().map(|pin| &pin.formal));
                let rows = i32::try_from(self.inputs.len().max(self.outputs.len()).max(1)).unwrap_or(1);
                let width = (pins + 30).max(text + 20).max(60);
                (width, PIN_FIRST + PIN_PITCH * (rows - 1) + 20)
            }
        };
    }

    /// Space for the operand above, or the instance.
    pub fn above(&self) -> i32 {
        match self.kind {
            Kind::Contact | Kind::Coil => 20,
            Kind::Block if self.instance.is_some() => 20,
            _ => 0,
        }
    }

    /// Width with the text above.
    pub fn whole_width(&self) -> i32 {
        let above = match self.kind {
            Kind::Contact | Kind::Coil => text_width(&self.text),
            Kind::Block => self.instance.as_deref().map_or(0, text_width),
            _ => 0,
        };
        self.width.max(above)
    }

    /// The place of an input within the object.
    pub fn input_place(&self, at: usize) -> (i32, i32) {
        (0, self.pin_y(at))
    }

    /// The place of an output within the object.
    pub fn output_place(&self, pin: &str) -> (i32, i32) {
        let at = self.outputs.iter().position(|output| output.formal == pin).unwrap_or(0);
        (self.width, self.pin_y(at))
    }

    fn pin_y(&self, at: usize) -> i32 {
        match self.kind {
            Kind::Block => PIN_FIRST + PIN_PITCH * i32::try_from(at).unwrap_or(0),
            Kind::LeftRail | Kind::RightRail => ROW / 2 + 30 * i32::try_from(at).unwrap_or(0),
            _ => ROW / 2,
        }
    }
}

/// The body of all objects; their identifiers are their numbers from 1.
pub fn body(language: &'static str, objects: &[Object]) -> Node {
    Node::new(language).children(objects.iter().enumerate().map(|(at, object)| node(at, object, objects)))
}

fn place(name: &'static str, (x, y): (i32, i32)) -> Node {
    Node::new(name).with("x", x).with("y", y)
}

fn node(at: usize, object: &Object, objects: &[Object]) -> Node {
    let name = match object.kind {
        Kind::LeftRail => "leftPowerRail",
        Kind::RightRail => "rightPowerRail",
        Kind::Contact => "contact",
        Kind::Coil => "coil",
        Kind::Block => "block",
        Kind::InVariable => "inVariable",
        Kind::OutVariable => "outVariable",
        Kind::Label => "label",
        Kind::Jump => "jump",
        Kind::Return => "return",
        Kind::Comment => "comment",
    };
    let mut node = Node::new(name).with("localId", at + 1).with("width", object.width).with("height", object.height);
    if object.order > 0 {
        node.attributes.push(("executionOrderId", object.order.to_string()));
    }
    match object.kind {
        Kind::Block => {
            node.attributes.push(("typeName", object.text.clone()));
            if let Some(instance) = &object.instance {
                node.attributes.push(("instanceName", instance.clone()));
            }
        }
        Kind::Label | Kind::Jump => node.attributes.push(("label", object.text.clone())),
        _ => {}
    }
    if object.negated {
        node.attributes.push(("negated", "true".to_string()));
    }
    if !object.edge.is_empty() {
        node.attributes.push(("edge", object.edge.to_string()));
    }
    match object.storage {
        Storage::None => {}
        Storage::Set => node.attributes.push(("storage", "set".to_string())),
        Storage::Reset => node.attributes.push(("storage", "reset".to_string())),
    }
    let mut node = node.child(place("position", (object.x, object.y)));
    let out = |pin: &str| Node::new("connectionPointOut").child(place("relPosition", object.output_place(pin)));
    match object.kind {
        Kind::Comment => {
            return node.child(Node::new("content").child(Node::of("xhtml:p", object.text.as_str())));
        }
        Kind::LeftRail => {
            for (at, output) in object.outputs.iter().enumerate() {
                let point = Node::new("connectionPointOut").with("formalParameter", &output.formal);
                node.push(point.child(place("relPosition", (object.width, object.pin_y(at)))));
            }
            return node;
        }
        Kind::Block => {
            let variable = |(at, input): (usize, &Input)| {
                let mut variable = Node::new("variable").with("formalParameter", &input.formal);
                if input.negated {
                    variable.attributes.push(("negated", "true".to_string()));
                }
                variable.child(connection(object, at, input, objects))
            };
            let inputs = || object.inputs.iter().enumerate();
            node.push(Node::new("inputVariables").children(inputs().filter(|(_, one)| !one.in_out).map(variable)));
            node.push(Node::new("inOutVariables").children(inputs().filter(|(_, one)| one.in_out).map(variable)));
            let output = |output: &Output| {
                let mut variable = Node::new("variable").with("formalParameter", &output.formal);
                if output.negated {
                    variable.attributes.push(("negated", "true".to_string()));
                }
                variable.child(out(&output.formal))
            };
            return node.child(Node::new("outputVariables").children(object.outputs.iter().map(output)));
        }
        _ => {}
    }
    for (at, input) in object.inputs.iter().enumerate() {
        node.push(connection(object, at, input, objects));
    }
    match object.kind {
        Kind::Contact | Kind::Coil => node.child(out("")).child(Node::of("variable", object.text.as_str())),
        Kind::InVariable => node.child(out("")).child(Node::of("expression", object.text.as_str())),
        Kind::OutVariable => node.child(Node::of("expression", object.text.as_str())),
        _ => node,
    }
}

/// An input with its lines: each from its end at the input to its beginning.
fn connection(object: &Object, at: usize, input: &Input, objects: &[Object]) -> Node {
    let start = |origin: &Origin| {
        let source = objects.get(origin.object)?;
        let (x, y) = source.output_place(&origin.pin);
        Some((source, source.x + x, source.y + y))
    };
    let (dx, mut dy) = object.input_place(at);
    // Rails are lines: a branch meets them anywhere.
    if object.kind == Kind::RightRail
        && let Some((_, _, y)) = input.from.first().and_then(start)
    {
        dy = y - object.y;
    }
    let (tx, ty) = (object.x + dx, object.y + dy);
    let mut point = Node::new("connectionPointIn").child(place("relPosition", (dx, dy)));
    for origin in &input.from {
        let Some((source, sx, sy)) = start(origin) else { continue };
        let sy = if source.kind == Kind::LeftRail { ty } else { sy };
        let mut line = Node::new("connection").with("refLocalId", origin.object + 1);
        if !origin.pin.is_empty() {
            line.attributes.push(("formalParameter", origin.pin.clone()));
        }
        line.push(place("position", (tx, ty)));
        if sy != ty {
            line.push(place("position", (source.exit, ty)));
            line.push(place("position", (source.exit, sy)));
        }
        line.push(place("position", (sx, sy)));
        point.push(line);
    }
    point
}
