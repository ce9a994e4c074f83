//! Projects in PLCopen XML (TC6), as open editors export them: LD, FBD, ST and SFC.
//!
//! ```text
//! file ─► overlay ─► interface ─────────────► blocks
//!                ├─► objects ─► order ─► graph ─┤
//!                └─► chart ─────────────────────┘
//! ```
//!
//! - `overlay` lets expressions be read where they stand; entities and markup are gone.
//! - `objects` are contacts, blocks and variables with the lines between them; `order` makes networks of them, `graph` elements and nets.
//! - `chart` makes charts of SFC bodies.
//! - `scope` settles what names stand for: located and global variables are tags and components of a data block here.
//! - `project` gives global variables, and the blocks that call the programs.
//!
//! A PROGRAM is a function block with an instance data block, called by OB 1 or by a cyclic OB. Namespaces do not matter: versions 1.0 to
//! 2.01 of the format use the same words. Source: LAD/FBD reference, chapter A3.

mod chart;
mod graph;
mod interface;
mod objects;
mod order;
mod overlay;
mod project;
mod scope;

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};
use roxmltree::{Document, Node};

use crate::ast::{
    Block, BlockName, Code as BlockCode, CodeBlock, CodeKind, Header, Retain, Section, SectionKind, SourceUnit,
    TypeBlock, TypeKind, TypeRef, Variable,
};
use crate::network::ast::{Body as Networks, Content, Graph, Language, Network};
use crate::scl::ast::{Body as SclBody, Dialect, Name, NameForm, Statement};
use crate::scl::fragment;
use interface::{child, elements, flip_flop, plain_text};
use objects::Kind;
use scope::Scope;

pub use project::{Tag, tags};

/// True if a text is a project in PLCopen XML: its root element is `project`, and it has types or instances.
pub fn is_project(text: &str) -> bool {
    if !text.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
        return false;
    }
    Document::parse(text).is_ok_and(|document| is_root(document.root_element()))
}

fn is_root(root: Node) -> bool {
    root.tag_name().name() == "project" && ["types", "instances"].iter().any(|name| child(root, name).is_some())
}

/// Reads a project. Never fails: what is wrong is in the messages.
pub fn parse(file: FileId, text: &str) -> (SourceUnit, Vec<Diagnostic>) {
    let document = match Document::parse(text) {
        Ok(document) => document,
        Err(error) => {
            let message = Diagnostic::new(Code::NotASource, Span::new(file, 0..text.len().min(1)), error.to_string());
            return (
                SourceUnit::default(),
                vec![message.help("export the project again; the file is no complete XML")],
            );
        }
    };
    let mut reader = Reader {
        file,
        overlay: overlay::overlay(text, &document),
        pous: HashSet::new(),
        enums: Vec::new(),
        globals: HashSet::new(),
        located: Vec::new(),
        blocks: Vec::new(),
        messages: Vec::new(),
    };
    reader.project(document.root_element());
    let Reader { overlay, blocks, mut messages, .. } = reader;
    messages.sort_by_key(|message| message.primary.span.start);
    (SourceUnit { blocks, overlay: Some(overlay), ..SourceUnit::default() }, messages)
}

/// A file that is being read.
struct Reader<'a> {
    file: FileId,
    overlay: String,
    /// Names of the file's POUs, in lower case.
    pous: HashSet<String>,
    /// Values of enumerations: their names with their numbers.
    enums: Vec<(Node<'a, 'a>, String, i64)>,
    /// Variables of the data block of the global ones, in lower case.
    globals: HashSet<String>,
    /// Global variables with an address, and their tags.
    located: Vec<(String, String)>,
    blocks: Vec<Block>,
    messages: Vec<Diagnostic>,
}

/// What the body of a POU needs while it is read.
struct Body {
    scope: Scope,
    is_function: bool,
    /// Variables of type BYTE, WORD, DWORD and LWORD, in lower case.
    words: HashSet<String>,
    /// Variables for edges and loops.
    hidden: Vec<Variable>,
}

impl Body {
    /// Declares a BOOL that no other variable is called like.
    fn hidden_name(&mut self, stem: &str, span: Span) -> String {
        let mut number = self.hidden.len() + 1;
        while self.scope.locals.contains(&format!("{stem}_{number}")) {
            number += 1;
        }
        let name = format!("{stem}_{number}");
        self.scope.locals.insert(name.clone());
        let ty = TypeRef { kind: TypeKind::Named("BOOL".to_string()), span };
        let (attributes, at, initial, comment) = (Vec::new(), None, None, None);
        self.hidden.push(Variable { name: name.clone(), name_span: span, attributes, at, ty, initial, comment });
        name
    }
}

impl<'a> Reader<'a> {
    fn project(&mut self, root: Node<'a, 'a>) {
        let types = child(root, "types");
        let list = |name: &str, item: &str| -> Vec<Node<'a, 'a>> {
            let found = types.and_then(|types| child(types, name));
            let item = item.to_string();
            found.into_iter().flat_map(elements).filter(|node| node.tag_name().name() == item).collect()
        };
        let pous = list("pous", "pou");
        self.pous = pous.iter().filter_map(|pou| pou.attribute("name")).map(str::to_lowercase).collect();
        let data_types = list("dataTypes", "dataType");
        let mut values = HashMap::new();
        for node in &data_types {
            self.enum_values(*node, &mut values);
        }
        overlay::typed_values(&mut self.overlay, &values);
        for node in data_types {
            self.data_type(node);
        }
        self.global_variables(root);
        for pou in &pous {
            self.pou(*pou);
        }
        self.configurations(root, &pous);
    }

    /// The values of an enumeration; in `values` by their names with the type, `color#red`.
    fn enum_values(&mut self, node: Node<'a, 'a>, values: &mut HashMap<String, i64>) {
        let list = child(node, "baseType").and_then(|base| child(base, "enum"));
        let mut next = 0;
        for value in list.and_then(|list| child(list, "values")).into_iter().flat_map(elements) {
            let number = value.attribute("value").and_then(|text| text.trim().parse().ok()).unwrap_or(next);
            if let Some(name) = value.attribute("name") {
                if let Some(ty) = node.attribute("name") {
                    values.insert(format!("{ty}#{name}").to_ascii_lowercase(), number);
                }
                self.enums.push((value, name.to_string(), number));
            }
            next = number.saturating_add(1);
        }
    }

    fn data_type(&mut self, node: Node<'a, 'a>) {
        let (Some(name), Some(base)) = (node.attribute("name"), child(node, "baseType")) else { return };
        let span = self.place(node, "name");
        let Some(ty) = self.type_of(base, 0) else { return };
        let (members, alias) = match ty.kind {
            TypeKind::Struct(members) => (members, None),
            _ => (Vec::new(), Some(ty)),
        };
        let name = BlockName::Symbol { name: name.to_string(), span };
        self.blocks.push(Block::Type(TypeBlock { name, header: Header::default(), members, alias, span }));
    }

    fn pou(&mut self, pou: Node<'a, 'a>) {
        let Some(name) = pou.attribute("name") else { return };
        let span = self.place(pou, "name");
        let kind = match pou.attribute("pouType") {
            Some("function") => CodeKind::Fc,
            Some("functionBlock" | "program") => CodeKind::Fb,
            _ => {
                let text = format!("`{name}` is neither a function nor a function block nor a program");
                let message = Diagnostic::new(Code::ForeignContent, span, text);
                return self.messages.push(message.help("pouType is function, functionBlock or program"));
            }
        };
        let is_function = kind == CodeKind::Fc;
        let interface = child(pou, "interface");
        let (mut sections, mut constants) = match interface {
            Some(interface) => self.sections(interface, is_function),
            None => Default::default(),
        };
        let return_type = interface
            .and_then(|interface| child(interface, "returnType"))
            .filter(|_| is_function)
            .and_then(|ty| self.type_of(ty, 0));
        let mut body =
            Body { scope: self.scope_of(name, interface), is_function, words: words(interface), hidden: Vec::new() };
        for (node, value_name, number) in self.enums.clone() {
            // Only those that the POU mentions: names of values are often words that other POUs use for variables.
            let used = self.overlay.get(pou.range()).is_some_and(|text| mentions(text, &value_name));
            if used && !body.scope.locals.contains(&value_name.to_lowercase()) {
                constants.push(self.enum_constant(node, &value_name, number));
            }
        }
        let code =
            child(pou, "body").map_or(BlockCode::Graphic(Networks::default()), |node| self.body(node, &mut body));
        if !body.hidden.is_empty() {
            let variables = std::mem::take(&mut body.hidden);
            sections.push(Section { kind: SectionKind::Static, retain: Retain::Unsaid, variables, span });
        }
        let comment = child(pou, "documentation").map(plain_text).filter(|text| !text.is_empty());
        let header = Header { comment: comment.into_iter().collect(), ..Header::default() };
        let name = BlockName::Symbol { name: name.to_string(), span };
        self.blocks.push(Block::Code(CodeBlock { kind, name, return_type, header, sections, constants, code, span }));
    }

    /// What names mean in a POU.
    fn scope_of(&self, pou: &str, interface: Option<Node>) -> Scope {
        let mut scope =
            Scope { globals: self.globals.clone(), global_block: project::GLOBALS.to_string(), ..Scope::default() };
        for (name, tag) in &self.located {
            scope.located.insert(name.clone(), tag.clone());
        }
        for list in interface.into_iter().flat_map(elements) {
            if list.tag_name().name() == "externalVars" {
                continue;
            }
            for variable in elements(list).filter(|node| node.tag_name().name() == "variable") {
                let Some(name) = variable.attribute("name") else { continue };
                let key = name.to_lowercase();
                scope.located.remove(&key);
                if variable.has_attribute("address") {
                    scope.located.insert(key, project::tag_name(Some(pou), name));
                    continue;
                }
                if let Some(kind) = flip_flop(variable) {
                    scope.flip_flops.insert(key.clone(), kind);
                }
                scope.locals.insert(key);
            }
        }
        scope
    }

    fn body(&mut self, node: Node<'a, 'a>, body: &mut Body) -> BlockCode {
        let Some(content) = elements(node).find(|node| node.tag_name().name() != "documentation") else {
            return BlockCode::Graphic(Networks::default());
        };
        let span = self.place(content, "name");
        let language = match content.tag_name().name() {
            "ST" => return self.structured_text(content, body),
            "LD" => Language::Lad,
            "FBD" => Language::Fbd,
            "SFC" if body.is_function => {
                let text = "a function has no memory for the steps of an SFC";
                let message = Diagnostic::new(Code::ForeignContent, span, text);
                let help = "make the POU a function block or a program";
                self.messages.push(message.label("this POU is compiled as if it were empty").help(help));
                return BlockCode::Graphic(Networks::default());
            }
            "SFC" => return BlockCode::Chart(chart::read(self, body, node.parent().unwrap_or(node), content)),
            other => {
                let text = format!("plcc does not read POUs in {other}");
                let message = Diagnostic::new(Code::ForeignContent, span, text);
                let help = "write the POU in LD, FBD, ST or SFC; other blocks of the file are read all the same";
                self.messages.push(message.label("this POU is compiled as if it were empty").help(help));
                return BlockCode::Graphic(Networks::default());
            }
        };
        BlockCode::Graphic(Networks { networks: self.networks(content, language, body) })
    }

    /// The networks of an LD or FBD body.
    fn networks(&mut self, content: Node<'a, 'a>, language: Language, body: &mut Body) -> Vec<Network> {
        let span = self.place(content, "name");
        let objects = self.objects(content);
        let mut networks = Vec::new();
        for group in order::groups(&objects) {
            let labels = group.labels.iter().map(|at| &objects[*at]);
            let labels: Vec<Name> =
                labels.map(|label| Name { text: label.name.clone(), form: NameForm::Bare, span: label.span }).collect();
            let graph = match group.objects.is_empty() {
                true => Graph::default(),
                false => graph::build(self, body, &objects, &group.objects),
            };
            let first = group.objects.iter().chain(&group.labels).map(|at| objects[*at].span).next().unwrap_or(span);
            networks.push(Network {
                language,
                title: None,
                comment: Vec::new(),
                labels,
                content: Content::Graphic(graph),
                span: first,
            });
        }
        self.unknown_connectors(&objects);
        networks
    }

    /// A connector that is there twice joins two signals under one name.
    fn unknown_connectors(&mut self, objects: &[objects::Object]) {
        let mut known: HashSet<&str> = HashSet::new();
        for object in objects.iter().filter(|object| object.kind == Kind::Connector) {
            if !known.insert(&object.name) {
                let text = format!("two connectors are called `{}`", object.name);
                let message = Diagnostic::new(Code::DuplicateName, object.span, text);
                self.messages.push(message.help("give each connector a name of its own"));
            }
        }
    }

    fn structured_text(&mut self, node: Node, body: &mut Body) -> BlockCode {
        let range = self.text_range(elements(node).next().unwrap_or(node));
        let statements = range.map(|range| self.statements(range, body)).unwrap_or_default();
        BlockCode::Scl(SclBody { dialect: Dialect::Tia, labels: Vec::new(), statements })
    }

    /// The statements in a part of the file.
    fn statements(&mut self, range: Range<usize>, body: &Body) -> Vec<Statement> {
        let (mut statements, messages) = fragment::statements(self.file, &self.overlay, range, false);
        self.messages.extend(messages);
        body.scope.statements(&mut statements);
        statements
    }
}

/// Variables of an interface that hold bits of a word.
fn words(interface: Option<Node>) -> HashSet<String> {
    let is_word = |variable: &Node| {
        let ty = child(*variable, "type").and_then(|ty| elements(ty).next());
        ty.is_some_and(|ty| matches!(ty.tag_name().name(), "BYTE" | "WORD" | "DWORD" | "LWORD"))
    };
    interface
        .into_iter()
        .flat_map(elements)
        .flat_map(elements)
        .filter(is_word)
        .filter_map(|variable| variable.attribute("name"))
        .map(str::to_lowercase)
        .collect()
}

/// The text has the name as a word of its own.
fn mentions(text: &str, name: &str) -> bool {
    let mut words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
    words.any(|word| word.eq_ignore_ascii_case(name))
}
