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
//! - `words` are the known elements and values: a project with a misspelt one is not read.
//! - `globals` are the global variables, `pou` reads a program organization unit, `programs` makes the blocks that call the programs.
//!
//! A PROGRAM is a function block with an instance data block, called by OB 1 or by a cyclic OB. Namespaces are ignored: versions 1.0 to
//! 2.01 of the format use the same words. Source: LAD/FBD reference, chapter A3.

mod address;
mod chart;
mod editor;
mod functions;
mod globals;
mod graph;
mod il;
mod interface;
mod objects;
mod order;
mod overlay;
mod pou;
mod pragma;
mod programs;
mod scope;
#[cfg(test)]
mod tests;
mod types;
mod words;

use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::rc::Rc;

use plcc_diag::{Code, Diagnostic, FileId, Span};
use roxmltree::Node;

use address::Addresses;
use editor::Editor;
use interface::{child, elements};
use plcc_syntax::ast::{Block, BlockName, Constant, Header, SourceUnit, TypeBlock, TypeKind, TypeRef, Variable};
use plcc_syntax::front::Comment;
use plcc_syntax::scl::ast::Statement;
use scope::{Global, Scope, Shared};
use types::Types;

/// Actions may call each other up to this depth.
const DEPTH_MAX: usize = 64;

pub use globals::{Tag, tags};

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

/// The comments in the bodies in ST, but for pragmas, which are statements. `overlay`: that of the project, with its text in the same places.
pub fn comments(text: &str, overlay: &str) -> Vec<Comment> {
    let mut found = comments_and_pragmas(text, overlay);
    found.retain(|comment| !overlay[comment.range()].starts_with("//@"));
    found
}

/// The comments in the bodies in ST with the pragmas, for a notation whose statements are not those of the tree.
pub fn comments_and_pragmas(text: &str, overlay: &str) -> Vec<Comment> {
    let Ok(document) = crate::xml::parse(text) else { return Vec::new() };
    let bodies = document.descendants().filter(|node| node.tag_name().name() == "ST");
    let of_body = |range: Range<usize>| {
        let start = range.start as u32;
        let body = overlay.get(range).unwrap_or_default();
        plcc_syntax::scl::comments(body).into_iter().map(move |comment| Comment {
            start: comment.start + start,
            end: comment.end + start,
            ..comment
        })
    };
    bodies.filter_map(overlay::content).flat_map(of_body).collect()
}

/// Reads a project. Never fails: the messages say what is wrong.
pub fn parse(file: FileId, text: &str) -> (SourceUnit, Vec<Diagnostic>) {
    let document = match crate::xml::parse(text) {
        Ok(document) => document,
        Err(fault) => return (SourceUnit::default(), vec![crate::xml::broken(file, text, &fault)]),
    };
    let faults = words::faults(file, &document);
    if !faults.is_empty() {
        return (SourceUnit::default(), faults);
    }
    let editor = Editor::of(&document);
    let mut reader = Reader {
        file,
        overlay: overlay::overlay(text, &document),
        editor,
        addresses: globals::addresses(editor, text),
        types: globals::data_types(&document),
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
    instances: Vec<programs::Instance>,
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
