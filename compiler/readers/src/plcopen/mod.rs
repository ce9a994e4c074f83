//! Projects in PLCopen XML (TC6), as open editors export them: LD, FBD, ST and SFC.
//!
//! ```text
//! file ─► overlay ─► interface ─────────────► blocks
//!                ├─► objects ─► order ─► graph ─┤
//!                └─► chart ─────────────────────┘
//! ```
//!
//! - `overlay` lets expressions be read in place: it replaces entities and markup.
//! - `objects` are contacts, blocks and variables with the lines between them; `order` groups them into networks, `graph` turns them into
//!   elements and nets.
//! - `chart` turns SFC bodies into charts.
//! - `scope` resolves names: located and global variables are tags and components of a data block here; `functions` translates
//!   standard functions to SCL.
//! - `editor` finds the editor that wrote the project, `address` where its addresses are.
//! - `project` returns global variables, and the blocks that call the programs.
//!
//! A PROGRAM is a function block with an instance data block, called by OB 1 or by a cyclic OB. Namespaces are ignored: versions 1.0 to
//! 2.01 of the format use the same words. Source: LAD/FBD reference, chapter A3.

mod address;
mod chart;
mod editor;
mod functions;
mod graph;
mod il;
mod interface;
mod objects;
mod order;
mod overlay;
mod pragma;
mod project;
mod scope;
#[cfg(test)]
mod tests;
mod types;

use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::rc::Rc;

use plcc_diag::{Code, Diagnostic, FileId, Span};
use roxmltree::Node;

use address::Addresses;
use editor::Editor;
use interface::{child, elements, flip_flop, plain_text};
use objects::Kind;
use plcc_syntax::ast::{
    Block, BlockName, Code as BlockCode, CodeBlock, CodeKind, Constant, Header, Retain, Section, SectionKind,
    SourceUnit, TypeBlock, TypeKind, TypeRef, Variable,
};
use plcc_syntax::network::ast::{Body as Networks, Content, Graph, Language, Network};
use plcc_syntax::scl::ast::{Body as SclBody, Dialect, Expr, Name, NameForm, Statement};
use plcc_syntax::scl::fragment;
use plcc_syntax::scl::raw::Iec;
use scope::{Global, Scope, Shared};
use types::{Ty, Types};

/// Actions may call each other up to this depth.
const DEPTH_MAX: usize = 64;

pub use project::{Tag, tags};

/// True if a text is a project in PLCopen XML: its root element is `project`, and it has types or instances.
pub fn is_project(text: &str) -> bool {
    if !text.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
        return false;
    }
    crate::xml::parse(text).is_ok_and(|document| is_root(document.root_element()))
}

fn is_root(root: Node) -> bool {
    root.tag_name().name() == "project" && ["types", "instances"].iter().any(|name| child(root, name).is_some())
}

/// Reads a project. Never fails: the messages say what is wrong.
pub fn parse(file: FileId, text: &str) -> (SourceUnit, Vec<Diagnostic>) {
    let document = match crate::xml::parse(text) {
        Ok(document) => document,
        Err(fault) => return (SourceUnit::default(), vec![crate::xml::broken(file, text, &fault)]),
    };
    let editor = Editor::of(&document);
    let mut reader = Reader {
        file,
        overlay: overlay::overlay(text, &document),
        editor,
        addresses: project::addresses(editor, text),
        types: project::data_types(&document),
        kinds: Rc::new(Types::of(document.root_element())),
        pous: HashSet::new(),
        complex: HashMap::new(),
        enums: Vec::new(),
        constants: Vec::new(),
        globals: HashMap::new(),
        lists: HashMap::new(),
        instances: Vec::new(),
        program_instances: HashMap::new(),
        starts: Vec::new(),
        shared: None,
        blocks: Vec::new(),
        messages: Vec::new(),
    };
    reader.project(document.root_element());
    let Reader { overlay, blocks, mut messages, .. } = reader;
    messages.sort_by_key(|message| message.primary.span.start);
    // A value that two pins read is reported twice.
    let mut known = HashSet::new();
    messages.retain(|message| {
        let span = message.primary.span;
        known.insert((message.code, span.start, span.end, message.title.clone()))
    });
    (SourceUnit { blocks, overlay: Some(overlay), ..SourceUnit::default() }, messages)
}

/// A file that is being read.
struct Reader<'a> {
    file: FileId,
    overlay: String,
    editor: Editor,
    addresses: Addresses,
    /// Data types of the file by their names in lower case.
    types: HashMap<String, Node<'a, 'a>>,
    /// Types of all variables of the file.
    kinds: Rc<Types>,
    /// Names of the file's POUs, in lower case.
    pous: HashSet<String>,
    /// Outputs of POUs that no net can carry, texts and structures: by POU and output in lower case; for a function the output is empty.
    complex: HashMap<(String, String), Node<'a, 'a>>,
    /// Values of enumerations: their names with their numbers.
    enums: Vec<(Node<'a, 'a>, String, i64)>,
    /// Global constants; each POU that uses them gets a copy.
    constants: Vec<Constant>,
    /// Global variables, in lower case.
    globals: HashMap<String, Global>,
    /// Lists of global variables, in lower case.
    lists: HashMap<String, HashMap<String, Global>>,
    instances: Vec<project::Instance>,
    /// Programs with one instance, and its name.
    program_instances: HashMap<String, String>,
    /// The assignments at the start of the CPU.
    starts: Vec<Statement>,
    /// The meaning of names in all POUs, once the declarations are read.
    shared: Option<Rc<Shared>>,
    blocks: Vec<Block>,
    messages: Vec<Diagnostic>,
}

/// The state while the body of a POU is read.
struct Body {
    scope: Scope,
    is_function: bool,
    /// Variables of type BYTE, WORD, DWORD and LWORD, in lower case.
    words: HashSet<String>,
    /// Variables for edges and loops.
    hidden: Vec<Variable>,
    /// Variables for values on wires that no net can carry.
    temporary: Vec<Variable>,
}

impl Body {
    /// Declares a BOOL with a name that no other variable has.
    fn hidden_name(&mut self, stem: &str, span: Span) -> String {
        self.hidden_variable(stem, "BOOL", span)
    }

    /// Declares a variable with a name that no other has.
    fn hidden_variable(&mut self, stem: &str, ty: &str, span: Span) -> String {
        let ty = TypeRef { kind: TypeKind::Named(ty.to_string()), span };
        let variable = self.unnamed(stem, ty, span);
        let name = variable.name.clone();
        self.hidden.push(variable);
        name
    }

    /// Declares temporary data with a name that no other variable has.
    fn temporary_variable(&mut self, ty: TypeRef, span: Span) -> String {
        let variable = self.unnamed("wire", ty, span);
        let name = variable.name.clone();
        self.temporary.push(variable);
        name
    }

    fn unnamed(&mut self, stem: &str, ty: TypeRef, span: Span) -> Variable {
        let mut number = self.hidden.len() + self.temporary.len() + 1;
        while self.scope.locals.contains(&format!("{stem}_{number}")) {
            number += 1;
        }
        let name = format!("{stem}_{number}");
        self.scope.locals.insert(name.clone());
        let (attributes, at, initial, comment) = (Vec::new(), None, None, None);
        Variable { name, name_span: span, attributes, at, ty, initial, comment }
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
        for pou in &pous {
            self.complex_outputs(*pou);
        }
        let data_types = list("dataTypes", "dataType");
        let mut values = HashMap::new();
        for node in &data_types {
            self.enum_values(*node, &mut values);
        }
        overlay::typed_values(&mut self.overlay, &values);
        self.global_constants(root);
        for node in data_types {
            self.data_type(node);
        }
        self.global_variables(root);
        self.programs(root, &pous);
        let mut enums: HashMap<String, HashMap<String, i64>> = HashMap::new();
        for (key, number) in values {
            if let Some((ty, value)) = key.split_once('#') {
                enums.entry(ty.to_string()).or_default().insert(value.to_string(), number);
            }
        }
        self.shared = Some(Rc::new(Shared {
            editor: self.editor,
            addresses: self.addresses.clone(),
            globals: self.globals.clone(),
            lists: self.lists.clone(),
            programs: self.program_instances.clone(),
            enums,
            pous: self.pous.clone(),
            types: Rc::clone(&self.kinds),
        }));
        for pou in &pous {
            self.pou(*pou);
        }
        self.configurations();
        self.foreign(root);
    }

    /// Reports parts of a project that plcc does not read.
    fn foreign(&mut self, root: Node<'a, 'a>) {
        for (list, known) in [
            ("project", &["fileHeader", "contentHeader", "types", "instances", "documentation", "addData"][..]),
            ("types", &["dataTypes", "pous", "documentation", "addData"]),
            ("dataTypes", &["dataType", "documentation", "addData"]),
            ("pous", &["pou", "documentation", "addData"]),
            ("instances", &["configurations", "documentation", "addData"]),
            ("configurations", &["configuration", "documentation", "addData"]),
            ("configuration", &["resource", "globalVars", "documentation", "addData"]),
            ("resource", &["task", "globalVars", "pouInstance", "documentation", "addData"]),
            ("task", &["pouInstance", "documentation", "addData"]),
        ] {
            let nodes: Vec<Node> = root.descendants().filter(|node| node.tag_name().name() == list).collect();
            nodes.into_iter().for_each(|node| self.unread(node, known));
        }
        // Parts that an editor adds with their own meaning.
        const CODE: [&str; 4] = ["Method", "Property", "Interface", "Union"];
        let added = root.descendants().filter(|node| node.is_element() && CODE.contains(&node.tag_name().name()));
        let added: Vec<Node> =
            added.filter(|node| node.parent().is_some_and(|data| data.tag_name().name() == "data")).collect();
        for node in added {
            let what = node.tag_name().name().to_lowercase();
            let name = node.attribute("name").map_or(String::new(), |name| format!(" `{name}`"));
            let text = format!("plcc does not read the {what}{name}");
            let message = Diagnostic::new(Code::ForeignContent, self.place(node, "name"), text);
            let help = "write it as a function, a function block or a structure";
            self.messages.push(message.label("nothing is compiled in its place").help(help));
        }
    }

    /// Reports elements below a node other than the known ones.
    fn unread(&mut self, node: Node, known: &[&str]) {
        for other in elements(node).filter(|other| !known.contains(&other.tag_name().name())) {
            let text = format!("plcc does not read the element `{}` of PLCopen XML", other.tag_name().name());
            let message = Diagnostic::new(Code::ForeignContent, self.place(other, "name"), text);
            let help = "remove it from the project, and export again";
            self.messages.push(message.label("nothing is compiled in its place").help(help));
        }
    }

    /// Outputs of a POU that no net can carry.
    fn complex_outputs(&mut self, pou: Node<'a, 'a>) {
        let (Some(name), Some(interface)) = (pou.attribute("name"), child(pou, "interface")) else { return };
        let mut found = Vec::new();
        for list in elements(interface) {
            match list.tag_name().name() {
                "returnType" => found.push((String::new(), list)),
                "outputVars" | "inOutVars" => {
                    let typed = |variable: Node<'a, 'a>| {
                        Some((variable.attribute("name")?.to_lowercase(), child(variable, "type")?))
                    };
                    found.extend(elements(list).filter_map(typed));
                }
                _ => {}
            }
        }
        for (output, holder) in found {
            if !self.is_elementary(holder) {
                self.complex.insert((name.to_lowercase(), output), holder);
            }
        }
    }

    /// A type of one value, with names of types resolved.
    fn is_elementary(&self, holder: Node) -> bool {
        let Some(mut ty) = elements(holder).next() else { return true };
        for _ in 0..16 {
            ty = match ty.tag_name().name() {
                "string" | "wstring" | "STRING" | "WSTRING" | "array" | "struct" => return false,
                "derived" => {
                    let name = ty.attribute("name").unwrap_or_default().to_lowercase();
                    let known = self.types.get(&name).and_then(|known| child(*known, "baseType"));
                    match known.and_then(|base| elements(base).next()) {
                        Some(known) => known,
                        None => return true,
                    }
                }
                _ => return true,
            };
        }
        true
    }

    /// The values of an enumeration; in `values` by their names with the type, `color#red`.
    fn enum_values(&mut self, node: Node<'a, 'a>, values: &mut HashMap<String, i64>) {
        let list = child(node, "baseType").and_then(|base| child(base, "enum"));
        let mut next = 0;
        for value in list.and_then(|list| child(list, "values")).into_iter().flat_map(elements) {
            let number = match value.attribute_node("value").filter(|value| !value.value().trim().is_empty()) {
                None => next,
                Some(written) => whole_number(written.value()).unwrap_or_else(|| {
                    let text = format!("`{}` is not a number", written.value());
                    let message = Diagnostic::new(Code::ForeignContent, self.span(written.range_value()), text);
                    self.messages.push(message.label(format!("read as {next}")).help("give the value a number"));
                    next
                }),
            };
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
        let span = self.place(node, "name");
        let (Some(name), Some(base)) = (node.attribute("name"), child(node, "baseType")) else {
            let message = Diagnostic::new(Code::ForeignContent, span, "a data type without a name or a base type");
            return self.messages.push(message.help("export the project again"));
        };
        let Some(ty) = self.type_of(base, 0) else { return };
        let (members, alias) = match ty.kind {
            TypeKind::Struct(members) => (members, None),
            _ => (Vec::new(), Some(ty)),
        };
        let name = BlockName::Symbol { name: name.to_string(), span };
        self.blocks.push(Block::Type(TypeBlock { name, header: Header::default(), members, alias, span }));
    }

    fn pou(&mut self, pou: Node<'a, 'a>) {
        let span = self.place(pou, "name");
        let Some(name) = pou.attribute("name") else {
            let message = Diagnostic::new(Code::ForeignContent, span, "a POU without a name");
            return self.messages.push(message.help("export the project again"));
        };
        self.unread(pou, &["interface", "actions", "transitions", "body", "documentation", "addData"]);
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
        let mut body = Body {
            scope: self.scope_of(name, interface),
            is_function,
            words: words(interface),
            hidden: Vec::new(),
            temporary: Vec::new(),
        };
        // Only those that the POU mentions: their names are often words that other POUs use for variables.
        let words = words_of(self.overlay.get(pou.range()).unwrap_or_default());
        for constant in self.constants.clone() {
            let used = words.contains(&constant.name.to_lowercase());
            if used && !body.scope.locals.contains(&constant.name.to_lowercase()) {
                constants.push(constant);
            }
        }
        for (node, value_name, number) in self.enums.clone() {
            let used = words.contains(&value_name.to_lowercase());
            if used && !body.scope.locals.contains(&value_name.to_lowercase()) {
                constants.push(self.enum_constant(node, &value_name, number));
            }
        }
        let is_chart = child(pou, "body").is_some_and(|node| child(node, "SFC").is_some());
        if !is_chart {
            self.actions(pou, &mut body);
        }
        let mut bodies = elements(pou).filter(|node| node.tag_name().name() == "body");
        let code = bodies.next().map_or(BlockCode::Graphic(Networks::default()), |node| self.body(node, &mut body));
        for further in bodies {
            let text = format!("`{name}` has several bodies");
            let message = Diagnostic::new(Code::ForeignContent, self.place(further, "WorksheetName"), text);
            self.messages.push(message.label("only the first is compiled").help("put the code into one body"));
        }
        if !body.hidden.is_empty() {
            let variables = std::mem::take(&mut body.hidden);
            sections.push(Section { kind: SectionKind::Static, retain: Retain::Unsaid, variables, span });
        }
        if !body.temporary.is_empty() {
            let variables = std::mem::take(&mut body.temporary);
            sections.push(Section { kind: SectionKind::Temp, retain: Retain::Unsaid, variables, span });
        }
        let comment = child(pou, "documentation").map(plain_text).filter(|text| !text.is_empty());
        let header = Header { comment: comment.into_iter().collect(), ..Header::default() };
        let name = BlockName::Symbol { name: name.to_string(), span };
        self.blocks.push(Block::Code(CodeBlock { kind, name, return_type, header, sections, constants, code, span }));
    }

    /// Actions of a POU that is not an SFC; the POU calls them by name.
    fn actions(&mut self, pou: Node<'a, 'a>, body: &mut Body) {
        let actions: Vec<Node> = child(pou, "actions").into_iter().flat_map(elements).collect();
        for _ in 0..=actions.len().min(DEPTH_MAX) {
            let known = body.scope.actions.len();
            for node in &actions {
                let Some(name) = node.attribute("name").map(str::to_lowercase) else { continue };
                let text = child(*node, "body").and_then(|node| child(node, "ST"));
                let Some(text) = text.filter(|_| !body.scope.actions.contains_key(&name)) else { continue };
                let source = self.text_range(elements(text).next().unwrap_or(text));
                // The actions that it calls come first.
                let waits = |other: &&Node| {
                    let other = other.attribute("name").unwrap_or_default();
                    !other.eq_ignore_ascii_case(&name)
                        && !body.scope.actions.contains_key(&other.to_lowercase())
                        && source
                            .clone()
                            .and_then(|range| self.overlay.get(range))
                            .is_some_and(|text| mentions(text, other))
                };
                if actions.iter().any(|other| waits(&other)) {
                    continue;
                }
                let statements = source.map(|range| self.statements(range, body)).unwrap_or_default();
                if let Some(span) = chart::leaving(&statements) {
                    let message =
                        Diagnostic::new(Code::ForeignContent, span, "plcc does not read jumps and returns in actions");
                    self.messages.push(message.label("would leave the whole POU").help("use IF"));
                }
                body.scope.actions.insert(name, statements);
            }
            if body.scope.actions.len() == known {
                break;
            }
        }
        for node in actions {
            let name = node.attribute("name").unwrap_or_default();
            if !body.scope.actions.contains_key(&name.to_lowercase()) {
                let text = format!("plcc does not read the action `{name}`: it is not in ST, or calls itself");
                let message = Diagnostic::new(Code::ForeignContent, self.place(node, "name"), text);
                self.messages.push(message.help("write it in ST, or as a function block"));
            }
        }
    }

    /// The meaning of names in a POU. Variables with an address get their start values.
    fn scope_of(&mut self, pou: &str, interface: Option<Node>) -> Scope {
        let shared = self.shared.clone().expect("declarations are read first");
        let mut scope = Scope::new(shared);
        for list in interface.into_iter().flat_map(elements) {
            if list.tag_name().name() == "externalVars" {
                self.external(list);
                continue;
            }
            for variable in elements(list).filter(|node| node.tag_name().name() == "variable") {
                let Some(name) = variable.attribute("name") else { continue };
                let key = name.to_lowercase();
                scope.hidden.insert(key.clone());
                if let Some(ty) = child(variable, "type").and_then(|ty| elements(ty).next()) {
                    scope.types.insert(key.clone(), ty.tag_name().name().to_ascii_uppercase());
                }
                if let Some(kind) = child(variable, "type").and_then(Ty::of) {
                    scope.kinds.insert(key.clone(), kind);
                }
                if self.located_variable(variable) {
                    let tag = project::tag_name(Some(pou), name);
                    let target = Name { text: tag.clone(), form: NameForm::Quoted, span: self.place(variable, "name") };
                    self.start_value(variable, target);
                    scope.located.insert(key, tag);
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

    /// VAR_EXTERNAL names global variables.
    fn external(&mut self, list: Node) {
        for variable in elements(list).filter(|node| node.tag_name().name() == "variable") {
            let Some(name) = variable.attribute("name") else { continue };
            let known = self.globals.contains_key(&name.to_lowercase())
                || self.constants.iter().any(|constant| constant.name.eq_ignore_ascii_case(name))
                || self.program_instances.contains_key(&name.to_lowercase());
            if !known {
                let text = format!("the project has no global variable `{name}`");
                let message = Diagnostic::new(Code::UnknownSymbol, self.place(variable, "name"), text);
                let help = "declare it in the configuration or the resource, and export again";
                self.messages.push(message.label("declared as external").help(help));
            }
        }
    }

    fn body(&mut self, node: Node<'a, 'a>, body: &mut Body) -> BlockCode {
        let Some(content) = body_content(node) else { return BlockCode::Graphic(Networks::default()) };
        let span = self.place(content, "name");
        let language = match content.tag_name().name() {
            "ST" => return self.structured_text(content, body),
            "IL" => {
                let statements = il::read(self, body, content);
                return BlockCode::Scl(SclBody { dialect: Dialect::Tia, labels: Vec::new(), statements });
            }
            "LD" => Language::Lad,
            "FBD" | "CFC" => Language::Fbd,
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
                let help = "write the POU in LD, FBD, ST, IL or SFC; plcc reads the other blocks of the file";
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

    /// A connector that appears twice joins two signals under one name.
    fn unknown_connectors(&mut self, objects: &[objects::Object]) {
        let mut known: HashSet<&str> = HashSet::new();
        for object in objects.iter().filter(|object| object.kind == Kind::Connector) {
            if !known.insert(&object.name) {
                let text = format!("two connectors are called `{}`", object.name);
                let message = Diagnostic::new(Code::DuplicateName, object.span, text);
                self.messages.push(message.help("give each connector its own name"));
            }
        }
    }

    fn structured_text(&mut self, node: Node, body: &mut Body) -> BlockCode {
        let range = self.text_range(elements(node).next().unwrap_or(node));
        let statements = range.map(|range| self.statements(range, body)).unwrap_or_default();
        BlockCode::Scl(SclBody { dialect: Dialect::Tia, labels: Vec::new(), statements })
    }

    /// How the ST of this editor is read.
    fn iec(&self) -> Iec {
        Iec { nested_comments: self.editor.nests_comments() }
    }

    /// The statements in a part of the file.
    fn statements(&mut self, range: Range<usize>, body: &Body) -> Vec<Statement> {
        pragma::clear(self.file, self.editor, &mut self.overlay, range.clone(), &mut self.messages);
        let (mut statements, messages) = fragment::iec_statements(self.file, &self.overlay, range, self.iec());
        self.messages.extend(messages);
        body.scope.statements(&mut statements);
        self.messages.append(&mut body.scope.messages.borrow_mut());
        statements
    }

    /// The expression in a part of the file; the scope of a POU resolves the names.
    fn expression(&mut self, range: Range<usize>, scope: Option<&Scope>) -> Expr {
        pragma::clear(self.file, self.editor, &mut self.overlay, range.clone(), &mut self.messages);
        let (mut value, messages) = fragment::iec_expression(self.file, &self.overlay, range, self.iec());
        self.messages.extend(messages);
        if let Some(scope) = scope {
            scope.expr(&mut value);
            self.messages.append(&mut scope.messages.borrow_mut());
        }
        value
    }

    /// As `expression`, with its type as far as it is known.
    fn typed_expression(&mut self, range: Range<usize>, scope: &Scope) -> (Expr, Option<Ty>) {
        let mut value = self.expression(range, None);
        let kind = scope.typed(&mut value);
        self.messages.append(&mut scope.messages.borrow_mut());
        (value, kind)
    }
}

/// The language element of a body. CODESYS puts its function charts into additional data.
fn body_content<'a, 'i>(body: Node<'a, 'i>) -> Option<Node<'a, 'i>> {
    let mut languages = elements(body).filter(|node| !matches!(node.tag_name().name(), "documentation" | "addData"));
    let plain = languages.next();
    let added = body.descendants().find(|node| node.tag_name().name() == "CFC");
    match plain {
        Some(plain) if plain.has_children() => Some(plain),
        _ => added.or(plain),
    }
}

/// A number in decimal, or with a base as IEC 61131-3 writes it.
fn whole_number(text: &str) -> Option<i64> {
    let text = text.trim().replace('_', "");
    let text = text.rsplit_once('#').map_or((10, text.as_str()), |(base, digits)| {
        (base.rsplit('#').next().and_then(|base| base.parse().ok()).unwrap_or(10), digits)
    });
    let (base, digits) = text;
    (2..=36).contains(&base).then(|| i64::from_str_radix(digits, base).ok())?
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

/// The words of a text, in lower case.
fn words_of(text: &str) -> HashSet<String> {
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect()
}

/// Whether the text has the name as a separate word.
fn mentions(text: &str, name: &str) -> bool {
    let mut words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
    words.any(|word| word.eq_ignore_ascii_case(name))
}
