//! Syntax tree of blocks that consist of networks.
//!
//! Names are kept as written; only elements and their pins are looked up here.

use plcc_diag::Span;

use super::elements::Row;
use crate::ast::Statement as StlStatement;
use crate::scl::ast::{Expr, Name, Statement as SclStatement};

/// Networks of a block, in the order of execution.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Body {
    pub networks: Vec<Network>,
}

/// A network.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    pub language: Language,
    pub title: Option<String>,
    pub comment: Vec<String>,
    /// Jump labels at its start; SCL and STL networks have labels in their statements.
    pub labels: Vec<Name>,
    pub content: Content,
    /// The position of the network in messages: its first line, or the element that contains it.
    pub span: Span,
}

/// Language of a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Language {
    Lad,
    Fbd,
    Scl,
    Stl,
}

/// What a network consists of.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    Graphic(Graph),
    Scl(Vec<SclStatement>),
    Stl(Vec<StlStatement>),
}

/// Elements and the nets between their pins.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Graph {
    /// In the order of evaluation: an element runs at its place here, or earlier if another one needs its output.
    pub elements: Vec<Element>,
    pub nets: Vec<Net>,
    /// A part of it could not be read, and was reported; what it lacks for that reason is not reported again.
    pub broken: bool,
}

/// Names a net of a graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NetId(pub u32);

/// A wire: it has one value, the OR of its sources. Joined branches of LAD are a net with several sources, never an element.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Net {
    /// As the file calls it, `"w1"`; empty if it has no name.
    pub name: String,
    /// In the order of evaluation.
    pub sources: Vec<Source>,
    pub span: Span,
}

/// What feeds a net.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// The power rail: TRUE.
    Rail,
    /// An output pin: indices into the elements and into the pins of that element.
    Pin { element: usize, pin: usize },
    /// An operand that a rung of FBD begins with.
    Operand { value: Expr, negated: bool },
    /// Another net: a branch without an element, which LAD forbids.
    Net(NetId),
}

/// A contact, coil, gate, box or call.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    pub target: Target,
    /// Types and other settings, in the order of the file.
    pub templates: Vec<Template>,
    pub eno: Eno,
    /// Connected pins, and those that the file shows as open.
    pub pins: Vec<Pin>,
    /// CALCULATE: the formula, with names IN1, IN2, ….
    pub equation: Option<Expr>,
    /// SWITCH: comparison of each branch.
    pub cases: Vec<Comparison>,
    /// Its name, or the whole of it if it has none.
    pub span: Span,
}

/// What an element is.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// A row of the table, with the instance of those that have one (`#t1` of `#t1.TON(…)`).
    Element { row: &'static Row, instance: Option<Expr> },
    /// An FC by name; an FB by its instance or, with `instance`, by its own name. Names in a form that a call in SCL accepts.
    Block { callee: Expr, instance: Option<Expr> },
}

/// Whether ENO reports errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Eno {
    /// The file does not say: as in the row of the table.
    #[default]
    Default,
    Generated,
    /// ENO follows EN.
    Disabled,
}

/// A setting of an element.
#[derive(Clone, Debug, PartialEq)]
pub struct Template {
    pub key: TemplateKey,
    /// A type name or a number, as written; empty where the type is found from the operands.
    pub value: String,
    pub span: Span,
}

/// Which setting. All spellings in the file formats are one key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TemplateKey {
    /// `SrcType`, `src_type`, `inType`.
    Source,
    /// `DestType`, `dest_type`, `outType`.
    Destination,
    /// `value_type`, `valueType`, `countType`.
    Value,
    /// `time_type`, `timeType`.
    Time,
    /// `Card`: number of pins that repeat.
    Card,
    /// Others, which mean nothing to the compiler.
    Other,
}

impl TemplateKey {
    /// The key of a name, ignoring letter case and `_`.
    pub fn of(name: &str) -> TemplateKey {
        let folded: String = name.chars().filter(|c| *c != '_').flat_map(char::to_lowercase).collect();
        match folded.as_str() {
            "srctype" | "intype" => TemplateKey::Source,
            "desttype" | "outtype" => TemplateKey::Destination,
            "valuetype" | "counttype" => TemplateKey::Value,
            "timetype" => TemplateKey::Time,
            "card" => TemplateKey::Card,
            _ => TemplateKey::Other,
        }
    }
}

/// A pin and what is connected to it. An output may be there several times.
#[derive(Clone, Debug, PartialEq)]
pub struct Pin {
    /// Of a row: the first spelling in the table, numbered ones with their number (`in3`); of a block: as written.
    pub name: String,
    pub value: PinValue,
    /// Inverted; of `operand` of a contact or coil: the normally closed contact, the negated coil.
    pub negated: bool,
    /// The element writes it.
    pub output: bool,
    /// An output that sets or resets its operand (PLCopen).
    pub storage: Storage,
    pub span: Span,
}

/// What is connected to a pin.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // Most pins hold an operand.
pub enum PinValue {
    Net(NetId),
    Operand(Expr),
    /// Shown without a connection.
    Open,
}

/// How an output writes its operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Storage {
    #[default]
    None,
    Set,
    Reset,
}

/// A comparison of SWITCH.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Comparison {
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
}

impl Comparison {
    /// `"=="`, `"<>"`, `">="`, …
    pub fn of(sign: &str) -> Option<Comparison> {
        Some(match sign.trim() {
            "==" | "=" | "EQ" => Comparison::Equal,
            "<>" | "NE" => Comparison::NotEqual,
            "<" | "LT" => Comparison::Less,
            "<=" | "LE" => Comparison::LessEqual,
            ">" | "GT" => Comparison::Greater,
            ">=" | "GE" => Comparison::GreaterEqual,
            _ => return None,
        })
    }
}

impl Element {
    /// The first pin of that name.
    pub fn pin(&self, name: &str) -> Option<&Pin> {
        self.pins.iter().find(|pin| pin.name.eq_ignore_ascii_case(name))
    }

    /// The setting of that key.
    pub fn template(&self, key: TemplateKey) -> Option<&Template> {
        self.templates.iter().find(|template| template.key == key)
    }
}

impl Graph {
    /// The net's sources, and everything else about it.
    pub fn net(&self, id: NetId) -> &Net {
        &self.nets[id.0 as usize]
    }

    /// Adds an empty net.
    pub fn add_net(&mut self, name: &str, span: Span) -> NetId {
        self.nets.push(Net { name: name.to_string(), sources: Vec::new(), span });
        NetId(self.nets.len() as u32 - 1)
    }
}
