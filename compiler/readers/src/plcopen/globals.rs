//! Global variables: tags, and the data block of those without an address.

use std::collections::{BTreeSet, HashMap, HashSet};

use plcc_diag::{Code, Diagnostic, FileId, Severity, Span};
use roxmltree::{Document, Node};

use super::Reader;
use super::address::{Addresses, Location, MEMORY_BYTES, Place, Read, mentioned};
use super::editor::Editor;
use super::interface::{child, elements, is_true};
use super::scope::Global;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    Area, Block, BlockName, Constant, DataBlock, DataContent, Header, InitialKind, InitialValue, Path, PathRoot,
    TypeKind, TypeRef, ValueAssignment, Variable, Width,
};
use plcc_syntax::scl::ast::{AssignOp, Expr, ExprKind, Literal, Name, NameForm, Statement, StatementKind, UnaryOp};

/// The data block of the global variables.
pub const GLOBALS: &str = "GlobalVariables";

/// A variable with an address.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tag {
    /// For a global variable its name; for one of a POU, `POU.name`; for an address in a body that cannot be an operand, the address.
    pub name: String,
    pub area: Area,
    pub width: Width,
    pub byte: u32,
    pub bit: u8,
    /// `"BOOL"`.
    pub ty: String,
    pub span: Span,
}

/// The name of the tag of a variable with an address.
pub fn tag_name(owner: Option<&str>, name: &str) -> String {
    match owner {
        Some(owner) => format!("{owner}.{name}"),
        None => name.to_string(),
    }
}

/// The addresses of a project and where they are.
pub fn addresses(editor: Editor, text: &str) -> Addresses {
    let read = |(written, _): (&str, usize)| match Location::read(written) {
        Read::At(location) => Some(location),
        Read::Open | Read::Not => None,
    };
    let locations: BTreeSet<Location> = mentioned(text).filter_map(read).collect();
    Addresses::lay_out(editor, &locations)
}

/// The data types of a project by their names in lower case.
pub fn data_types<'a>(document: &'a Document) -> HashMap<String, Node<'a, 'a>> {
    let types = document.descendants().filter(|node| node.tag_name().name() == "dataType");
    types.filter_map(|node| Some((node.attribute("name")?.to_lowercase(), node))).collect()
}

/// The elementary type of a variable with an address, with names of types resolved; none: it is not elementary.
pub fn elementary(types: &HashMap<String, Node>, variable: Node) -> Option<String> {
    let mut ty = child(variable, "type").and_then(|ty| elements(ty).next())?;
    for _ in 0..16 {
        let name = ty.tag_name().name();
        ty = match name {
            "derived" => {
                let known = types.get(&ty.attribute("name")?.to_lowercase()).copied()?;
                child(known, "baseType").and_then(|base| elements(base).next())?
            }
            "enum" => return Some("INT".to_string()),
            "subrangeSigned" | "subrangeUnsigned" => child(ty, "baseType").and_then(|base| elements(base).next())?,
            _ => {
                let upper = name.to_ascii_uppercase();
                if matches!(upper.as_str(), "DATE" | "DT" | "DATE_AND_TIME") {
                    return Some("LDT".to_string());
                }
                return Elementary::from_word(&upper).map(|_| upper);
            }
        };
    }
    None
}

/// The place of a variable with a complete address; none for one in a data block.
pub fn located(types: &HashMap<String, Node>, addresses: &Addresses, variable: Node) -> Option<(Place, String)> {
    let Read::At(location) = Location::read(variable.attribute("address")?) else { return None };
    let ty = elementary(types, variable)?;
    let place = addresses.place(&location)?;
    Some((Place { width: width_of(&ty)?, ..place }, ty))
}

/// The width of an elementary type.
fn width_of(ty: &str) -> Option<Width> {
    Some(match Elementary::from_word(ty)?.bits() {
        1 => Width::Bit,
        8 => Width::Byte,
        16 => Width::Word,
        32 => Width::Dword,
        _ => Width::Lword,
    })
}

/// Whether the type of a variable is an element that is not one of IEC 61131-3, such as `<BOOLEAN/>`.
fn has_unknown_type(variable: Node) -> bool {
    const COMPOSED: [&str; 9] =
        ["derived", "array", "string", "wstring", "struct", "enum", "subrangeSigned", "subrangeUnsigned", "pointer"];
    let ty = child(variable, "type").and_then(|ty| elements(ty).next());
    ty.is_some_and(|ty| {
        let name = ty.tag_name().name();
        !COMPOSED.iter().any(|known| known.eq_ignore_ascii_case(name))
            && Elementary::from_word(&name.to_ascii_uppercase()).is_none()
    })
}

/// Names of lists of global variables with the lists: the names of lists distinguish variables with equal names.
pub fn global_lists<'a, 'i>(root: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    let lists = root.descendants().filter(|node| node.tag_name().name() == "globalVars");
    lists.filter(|list| !list.ancestors().any(|node| node.tag_name().name() == "pou"))
}

/// A global variable: its node, the list that contains it, and its own name in plcc.
pub struct GlobalVariable<'a, 'i> {
    pub node: Node<'a, 'i>,
    pub list: Option<&'a str>,
    pub name: &'a str,
    pub unique: String,
}

/// All global variables. The second one with a name also gets the name of its list.
pub fn global_variables<'a, 'i>(root: Node<'a, 'i>) -> Vec<GlobalVariable<'a, 'i>> {
    let mut found: Vec<GlobalVariable<'a, 'i>> = Vec::new();
    let mut taken: BTreeSet<String> = BTreeSet::new();
    for list in global_lists(root) {
        let list_name = list.attribute("name").map(str::trim).filter(|name| !name.is_empty());
        for node in elements(list).filter(|node| node.tag_name().name() == "variable") {
            let Some(name) = node.attribute("name") else { continue };
            let mut unique = name.to_string();
            if let (true, Some(list)) = (taken.contains(&name.to_lowercase()), list_name) {
                unique = format!("{list}_{name}");
            }
            taken.insert(unique.to_lowercase());
            found.push(GlobalVariable { node, list: list_name, name, unique });
        }
    }
    found
}

/// The variables with an address in a project, and messages about addresses that the CPU does not have.
pub fn tags(file: FileId, text: &str) -> (Vec<Tag>, Vec<Diagnostic>) {
    let (mut tags, mut messages) = (Vec::new(), Vec::new());
    let Ok(document) = crate::xml::parse(text) else { return (tags, messages) };
    let addresses = addresses(Editor::of(&document), text);
    let types = data_types(&document);
    let mut tag = |name: String, place: Place, ty: String, span: Span| {
        let Place { area, width, byte, bit } = place;
        tags.push(Tag { name, area, width, byte, bit, ty, span });
    };
    let globals = global_variables(document.root_element());
    let globals = globals.into_iter().map(|global| (global.node, global.unique));
    let is_variable = |node: &Node| node.tag_name().name() == "variable" && node.has_attribute("address");
    let locals = document.descendants().filter(is_variable).filter_map(|node| {
        let pou = node.ancestors().find(|node| node.tag_name().name() == "pou")?.attribute("name")?;
        Some((node, tag_name(Some(pou), node.attribute("name")?)))
    });
    let mut refused = 0u32;
    for (node, name) in globals.chain(locals) {
        let Some(place) = node.attribute_node("address") else { continue };
        let span = Span::new(file, place.range_value());
        match Location::read(place.value()) {
            Read::At(location) => {
                if let Some((place, ty)) = located(&types, &addresses, node) {
                    // Dates are wider here than in these editors.
                    if place.width != location.width() && ty != "LDT" {
                        messages.push(other_width(span, &name, &location, place.width, &ty));
                    }
                    tag(name, place, ty, span);
                }
            }
            Read::Open => {}
            Read::Not => {
                let text = format!("`{}` is not an address of this CPU", place.value());
                let message = Diagnostic::new(Code::AddressRange, span, text).label(format!("address of `{name}`"));
                messages.push(message.help(match Location::meant(place.value()) {
                    Some(meant) => format!("write `{meant}`"),
                    None => "give a complete address in I, Q or M: %IX0.0, %QW2, %MD4".to_string(),
                }));
                // The uses of the variable are not mistakes.
                if let Some(ty) = elementary(&types, node)
                    && let Some(width) = width_of(&ty)
                {
                    refused += 1;
                    let byte = MEMORY_BYTES.saturating_sub(8u32.saturating_mul(refused));
                    tag(name, Place { area: Area::M, width, byte, bit: 0 }, ty, span);
                }
            }
        }
    }
    // Addresses in bodies that cannot be an operand of this CPU.
    let mut known: BTreeSet<String> = BTreeSet::new();
    for (written, at) in mentioned(text) {
        let Read::At(location) = Location::read(written) else { continue };
        if location.is_operand() || !known.insert(written.to_lowercase()) {
            continue;
        }
        if let Some(place) = addresses.place(&location) {
            let span = Span::new(file, at..at + written.len());
            tag(written.to_string(), place, location.type_name().to_string(), span);
        }
    }
    report_places(file, text, &addresses, &mut messages);
    (tags, messages)
}

/// The message for a variable whose type is wider or narrower than its address, `%IW0` of a BOOL. Some editors accept it.
fn other_width(span: Span, name: &str, location: &Location, width: Width, ty: &str) -> Diagnostic {
    let bits = |width: Width| match width {
        Width::Bit => "1 bit".to_string(),
        width => format!("{} bits", width.bytes() * 8),
    };
    let title =
        format!("the address of `{name}` has {}, but its type {ty} has {}", bits(location.width()), bits(width));
    let letter = match width {
        Width::Bit => "X0.0",
        Width::Byte => "B0",
        Width::Word => "W0",
        Width::Dword => "D0",
        Width::Lword => "L0",
    };
    let (area, own) = (location.area, location.type_name());
    Diagnostic::new(Code::Tolerated, span, title)
        .label("only the beginning of the address counts")
        .help(format!("write an address such as `%{area}{letter}`, or give the variable a type such as {own}"))
}

/// Reports addresses that are not where their numbers say.
fn report_places(file: FileId, text: &str, addresses: &Addresses, messages: &mut Vec<Diagnostic>) {
    let find = |is: &dyn Fn(&Location) -> bool| {
        let mut all = mentioned(text);
        all.find(|(written, _)| matches!(Location::read(written), Read::At(location) if is(&location)))
    };
    for (area, width, bytes) in &addresses.moved {
        let Some((written, at)) = find(&|location| location.area == *area && location.width == *width) else {
            continue;
        };
        let Read::At(location) = Location::read(written) else { continue };
        let Some(place) = addresses.place(&location) else { continue };
        let text =
            format!("in this editor addresses %{area}{width} have separate memory; here they are {bytes} bytes higher");
        let message = Diagnostic::new(Code::Tolerated, Span::new(file, at..at + written.len()), text);
        let help = "name variables rather than addresses in scenarios and on the command line, or use the address here";
        messages.push(message.label(format!("{} here", place_text(place))).help(help));
    }
    if let Some((first, place)) = addresses.loose.first()
        && let Some((written, at)) = find(&|location| location == first)
    {
        let others = match addresses.loose.len() - 1 {
            0 => String::new(),
            count => format!(", and {count} others after it"),
        };
        let text = "the CPU has no address of this form: it is given the next free place";
        let message = Diagnostic::new(Code::Tolerated, Span::new(file, at..at + written.len()), text);
        let help = "name variables rather than addresses in scenarios and on the command line";
        messages.push(message.label(format!("{} here{others}", place_text(*place))).help(help));
    }
}

/// `QW 100`, `I 3.1`.
fn place_text(place: Place) -> String {
    let area = match place.area {
        Area::I => "I",
        Area::Q => "Q",
        _ => "M",
    };
    match place.width {
        Width::Bit => format!("{area}{}.{}", place.byte, place.bit),
        Width::Byte => format!("{area}B{}", place.byte),
        Width::Word => format!("{area}W{}", place.byte),
        Width::Dword => format!("{area}D{}", place.byte),
        Width::Lword => format!("the 8 bytes from {area}B{}", place.byte),
    }
}

impl<'a> Reader<'a> {
    /// The constants that bounds of data types may name.
    pub fn global_constants(&mut self, root: Node<'a, 'a>) {
        for list in global_lists(root).filter(|list| is_true(*list, "constant")) {
            if let Some(name) = list.attribute("name").map(str::trim).filter(|name| !name.is_empty()) {
                self.lists.entry(name.to_lowercase()).or_default();
            }
            for node in elements(list).filter(|node| node.tag_name().name() == "variable") {
                if let Some(value) = self.constant_value(node) {
                    self.constants.push(value);
                }
            }
        }
    }

    /// Global variables: those with an address are tags, constants belong to each POU that uses them, the others are components of a data
    /// block.
    pub fn global_variables(&mut self, root: Node<'a, 'a>) {
        let mut variables: Vec<Variable> = Vec::new();
        let mut retained = Vec::new();
        let mut first = None;
        let constants: HashSet<u32> = self.constants.iter().map(|constant| constant.name_span.start).collect();
        for GlobalVariable { node, list, name, unique } in global_variables(root) {
            let constant = node.parent().is_some_and(|list| is_true(list, "constant"));
            if constant && constants.contains(&self.place(node, "name").start) {
                continue;
            }
            let place = self.located_variable(node);
            let global = match place {
                true => Global::Tag(unique.clone()),
                false => Global::Component(unique.clone()),
            };
            if place {
                self.start_value(
                    node,
                    Name { text: unique.clone(), form: NameForm::Quoted, span: self.place(node, "name") },
                );
            } else if let Some(mut variable) = self.variable(node, 0) {
                variable.name = unique.clone();
                self.give_length(&mut variable.ty);
                if self.is_function_block(&variable.ty) {
                    self.instance(variable, node);
                    let global = Global::Tag(unique.clone());
                    self.globals.entry(name.to_lowercase()).or_insert_with(|| global.clone());
                    if let Some(list) = list {
                        self.lists.entry(list.to_lowercase()).or_default().insert(name.to_lowercase(), global);
                    }
                    continue;
                }
                first.get_or_insert(variable.name_span);
                if node.parent().is_some_and(|list| is_true(list, "retain") || is_true(list, "persistent")) {
                    retained.push(unique.clone());
                }
                variables.push(variable);
            } else {
                continue;
            }
            self.globals.entry(name.to_lowercase()).or_insert_with(|| global.clone());
            if let Some(list) = list {
                self.lists.entry(list.to_lowercase()).or_default().insert(name.to_lowercase(), global);
            }
        }
        for list in global_lists(root) {
            self.unread(list, &["variable", "documentation", "addData"]);
            self.retentive(list);
            if let Some(name) = list.attribute("name").map(str::trim).filter(|name| !name.is_empty()) {
                self.lists.entry(name.to_lowercase()).or_default();
            }
        }
        if let Some(span) = first {
            let name = BlockName::Symbol { name: GLOBALS.to_string(), span };
            let content = DataContent::Struct(variables);
            let block = DataBlock { name, header: Header::default(), content, values: Vec::new(), retained, span };
            self.blocks.push(Block::Data(block));
        }
    }

    /// Whether variables of this type are instances.
    fn is_function_block(&self, ty: &TypeRef) -> bool {
        match &ty.kind {
            TypeKind::Block(BlockName::Symbol { name, .. }) => self.pous.contains(&name.to_lowercase()),
            // A standard block; a flip-flop is a BOOL.
            TypeKind::Named(name) => Elementary::from_word(name).is_none(),
            _ => false,
        }
    }

    /// A global instance is a data block of its own.
    fn instance(&mut self, variable: Variable, node: Node) {
        let span = variable.name_span;
        let field = |(name, value): (Option<Name>, InitialValue)| {
            let name = name?;
            let root = PathRoot::Bare { name: name.text.clone(), span: name.span };
            Some(ValueAssignment { target: Path { root, parts: Vec::new(), span: name.span }, span: value.span, value })
        };
        let values = match variable.initial {
            Some(InitialValue { kind: InitialKind::Fields(fields), .. }) => {
                fields.into_iter().filter_map(field).collect()
            }
            _ => Vec::new(),
        };
        let retain = node.parent().is_some_and(|list| is_true(list, "retain") || is_true(list, "persistent"));
        let name = BlockName::Symbol { name: variable.name, span };
        let (header, content) = (Header { retain, ..Header::default() }, DataContent::OfType(variable.ty));
        self.blocks.push(Block::Data(DataBlock { name, header, content, values, retained: Vec::new(), span }));
    }

    /// Whether a variable is at its address. Reports an address that is not complete or cannot be kept.
    pub fn located_variable(&mut self, node: Node) -> bool {
        let Some(address) = node.attribute_node("address") else { return false };
        let span = self.span(address.range_value());
        let name = node.attribute("name").unwrap_or_default();
        match Location::read(address.value()) {
            Read::At(location) => {
                if located(&self.types, &self.addresses, node).is_some() {
                    return true;
                }
                // A word that is not a type is reported as such.
                if has_unknown_type(node) {
                    return false;
                }
                let text = format!("`{name}` is not of an elementary type, so it cannot have an address");
                let mut message = Diagnostic::new(Code::ForeignContent, span, text);
                if location.area == 'M' {
                    message.severity = Severity::Warning;
                    message = message.label("gets separate memory").help("use the address for nothing else");
                } else {
                    message = message.label("inputs and outputs are read and written one by one");
                    message = message.help("declare each input or output as a separate variable");
                }
                self.messages.push(message);
                false
            }
            Read::Open => {
                let text = format!("`{name}` has no address yet");
                let message = Diagnostic::new(Code::Tolerated, span, text).label("gets separate memory");
                self.messages.push(message.help("write the address that the variable is to have, e.g. %QX0.0"));
                false
            }
            // `tags` reports it.
            Read::Not => true,
        }
    }

    /// The initial value of a variable with an address is written when the CPU starts.
    pub fn start_value(&mut self, node: Node, target: Name) {
        let span = target.span;
        let Some(initial) = child(node, "initialValue").and_then(|value| self.initial(value, 0)) else { return };
        match initial.kind {
            InitialKind::Expr(value) => {
                let target = Expr { kind: ExprKind::Name(target), span };
                let kind = StatementKind::Assign { targets: vec![(target, AssignOp::Set)], value: *value };
                self.starts.push(Statement { kind, span });
            }
            _ => {
                let text = "plcc reads a single value only for a variable with an address";
                self.messages
                    .push(Diagnostic::new(Code::ForeignContent, initial.span, text).help("assign it in a program"));
            }
        }
    }

    /// A value of an enumeration as a constant of a POU.
    pub fn enum_constant(&self, node: Node, name: &str, number: i64) -> Constant {
        let name_span = self.place(node, "name");
        let ty = TypeRef { kind: TypeKind::Named("INT".to_string()), span: name_span };
        let value = Some(integer(number, name_span));
        Constant { name: name.to_string(), name_span, ty: Some(ty), value, initial: None }
    }
}

/// A whole number as an expression.
pub fn integer(number: i64, span: Span) -> Expr {
    let literal = ExprKind::Literal(Literal::Integer { value: number.unsigned_abs(), based: false });
    let value = Expr { kind: literal, span };
    match number < 0 {
        true => Expr { kind: ExprKind::Unary { op: UnaryOp::Minus, operand: Box::new(value) }, span },
        false => value,
    }
}
