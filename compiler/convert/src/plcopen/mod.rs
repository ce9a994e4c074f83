//! Projects in PLCopen XML (TC6 2.01): a whole program in one document.
//!
//! - `program`: what the sources declare, and `identifier`: the names of the file.
//! - `declare`: types, variables and start values; `globals`: tags, constants and data blocks.
//! - `body`: statements and expressions as ST, with the functions of `system`.
//! - `chart`: charts of GRAPH as SFC.
//! - `network`: networks as the objects of LD and FBD, which `layout` places and `objects` writes.
//! - `tasks`: organization blocks as tasks.
//!
//! Source: PLCopen TC6, XML schema 2.01; LAD/FBD reference, chapter A3.

mod body;
mod chart;
mod declare;
mod globals;
mod identifier;
mod layout;
mod network;
mod objects;
mod program;
mod system;
mod tasks;

use std::collections::{BTreeSet, HashMap};

use plcc_diag::{Diagnostic, Severity, Span};
use plcc_syntax::ast::{
    Area, Block, Code, CodeBlock, CodeKind, DataBlock, Header, Retain, Section, SectionKind, TypeBlock, Width,
};
use plcc_syntax::network::ast::{Content, Language};
use plcc_syntax::scl::ast::{Dialect, Statement};
use plcc_syntax::stl::Mnemonics;
use plcc_syntax::symbols::{SymbolTable, SymbolTarget};

use crate::frames::bare;
use crate::node::{self, Node};
use crate::trivia::Trivia;
use crate::writer::{Notation, Writer};
use body::Body;
use declare::{Declarer, unique};
use identifier::identifier;
pub use program::Unit;
use program::{Global, Learned, Program, is_function, is_globals};
use tasks::Task;

/// The bodies are written again until their names are settled, but not more often than this.
const ROUNDS_MAX: usize = 8;

/// What is written of a program besides its sources.
pub struct Settings<'s> {
    pub name: &'s str,
    /// Period of a cyclic OB.
    pub period_ms: &'s dyn Fn(u16) -> u32,
}

/// Writes a program as one project.
pub fn write(units: Vec<Unit>, tables: &[SymbolTable], settings: &Settings) -> (String, Vec<Diagnostic>) {
    let mut program = Program::new(units, tables);
    for (data, fb) in program
        .code_blocks()
        .filter(|block| block.kind == CodeKind::Ob)
        .filter_map(|block| tasks::instances(&program, block))
        .flatten()
        .collect::<Vec<_>>()
    {
        program.tasks.insert(data, fb);
    }
    let mut rounds = 0;
    loop {
        let mut project = Project::new(&program, settings);
        project.units();
        rounds += 1;
        let learned = std::mem::take(&mut project.learned);
        if learned == program.learned || rounds == ROUNDS_MAX {
            let messages = project.names_that_change();
            return project.document(messages);
        }
        program.learned = learned;
        program.name_all();
    }
}

/// A text for people.
fn documentation(text: &str) -> Node {
    Node::new("documentation").child(Node::of("xhtml:p", text))
}

/// A project that is being written.
struct Project<'p, 'a, 's> {
    program: &'p Program<'a>,
    settings: &'s Settings<'s>,
    declarer: Declarer<'p, 'a>,
    learned: Learned,
    used: BTreeSet<String>,
    types: Vec<Node>,
    pous: Vec<Node>,
    /// Variables of data blocks, by their keys.
    data: Vec<(String, bool, Node)>,
    tasks: Vec<Task>,
    messages: Vec<Diagnostic>,
    /// A block with a version or an author.
    described: Option<Span>,
}

impl<'p, 'a, 's> Project<'p, 'a, 's> {
    fn new(program: &'p Program<'a>, settings: &'s Settings<'s>) -> Project<'p, 'a, 's> {
        let declarer = Declarer { program, structures: Vec::new(), attributes: Vec::new() };
        let learned = program.learned.clone();
        Project {
            program,
            settings,
            declarer,
            learned,
            used: BTreeSet::new(),
            types: Vec::new(),
            pous: Vec::new(),
            data: Vec::new(),
            tasks: Vec::new(),
            messages: Vec::new(),
            described: None,
        }
    }

    fn units(&mut self) {
        let program = self.program;
        for unit in &program.units {
            let trivia = Trivia::new(unit.text, unit.comments.clone(), false).without_regions();
            let mut writer = Writer::new(Notation::St, Mnemonics::En, trivia, None);
            for block in &unit.unit.blocks {
                match block {
                    Block::Code(block) => self.code(block, &mut writer),
                    Block::Data(block) => self.data_block(block, &mut writer),
                    Block::Type(block) => self.data_type(block, &mut writer),
                }
            }
            self.messages.append(&mut writer.messages);
        }
    }

    fn header(&mut self, header: &Header, span: Span, writer: &mut Writer) {
        if header.know_how_protect {
            writer.warn(
                span,
                "the protection of the block is not in the file",
                "protect the block again in the editor",
            );
        }
        let sets_eno = header.attributes.iter().any(|(key, value)| {
            ["S7_SetENOAutomatically", "SetENOAutomatically"].iter().any(|known| known.eq_ignore_ascii_case(key))
                && value.eq_ignore_ascii_case("TRUE")
        });
        if sets_eno {
            let title = "errors in this block set its ENO to 0, which no block of PLCopen XML does by itself";
            writer.refuse(span, title, "test for the errors, and remove S7_SetENOAutomatically");
        }
        if header.version.is_some() || header.author.is_some() || header.family.is_some() || header.name.is_some() {
            self.described.get_or_insert(span);
        }
        // What the file says in its own way.
        const SAID: [&str; 6] = [
            "S7_EventClass",
            "SecondaryType",
            "S7_PreferredLanguage",
            "S7_PreferredLang",
            "S7_Language",
            "ProgrammingLanguage",
        ];
        for (key, _) in &header.attributes {
            let is_said = SAID.iter().any(|known| known.eq_ignore_ascii_case(key));
            if !is_said && !self.declarer.attributes.iter().any(|(known, _)| known.eq_ignore_ascii_case(key)) {
                self.declarer.attributes.push((key.clone(), span));
            }
        }
    }

    fn data_type(&mut self, block: &'a TypeBlock, writer: &mut Writer) {
        let before = writer.lines_before(block.span.start);
        self.header(&block.header, block.name.span(), writer);
        let name = self.program.name(&self.program.key(&block.name));
        let ty = match &block.alias {
            Some(alias) => self.declarer.type_node(alias, "values", &name, writer),
            None => self.declarer.structure(&block.members, &name, writer),
        };
        let mut node = Node::new("dataType").with("name", name).child(Node::new("baseType").child(ty));
        node.children.extend(comment_of(before, &block.header));
        self.types.push(node);
    }

    fn data_block(&mut self, block: &'a DataBlock, writer: &mut Writer) {
        let key = self.program.key(&block.name);
        self.header(&block.header, block.name.span(), writer);
        if self.program.tasks.contains_key(&key) {
            return;
        }
        if is_globals(&block.name) {
            self.variables_of(block, writer);
            return;
        }
        let retained = globals::retained(block);
        if retained.is_none() {
            let title = format!(
                "only some components of `{}` are retentive, and PLCopen XML says it of a whole variable",
                self.program.shown(&key)
            );
            writer.refuse(block.name.span(), title, "put the retentive components into a data block of their own");
        }
        let node = globals::data(&mut self.declarer, &key, block, writer);
        self.data.push((key, retained.unwrap_or(false), node));
    }

    /// The components of the block of global variables are variables.
    fn variables_of(&mut self, block: &'a DataBlock, writer: &mut Writer) {
        let plcc_syntax::ast::DataContent::Struct(members) = &block.content else { return };
        for member in members {
            let key = member.name.to_lowercase();
            let mut node = self.declarer.variable(member, "", writer);
            if let Some((_, name)) = node.attributes.first_mut() {
                *name = self.program.name(&key);
            }
            let retained = block.retained.iter().any(|name| name.eq_ignore_ascii_case(&member.name));
            self.data.push((key, retained, node));
        }
    }

    // Blocks with code.

    fn code(&mut self, block: &'a CodeBlock, writer: &mut Writer) {
        let program = self.program;
        let key = program.key(&block.name);
        let before = writer.lines_before(block.span.start);
        self.header(&block.header, block.name.span(), writer);
        if block.kind == CodeKind::Ob {
            self.tasks.extend(tasks::of_block(program, block, self.settings.period_ms, writer));
            if tasks::instances(program, block).is_some() {
                return;
            }
        }
        let is_task = program.tasks.values().any(|fb| *fb == key);
        let kind = match block.kind {
            CodeKind::Ob => "program",
            CodeKind::Fb | CodeKind::Sfb if is_task => "program",
            CodeKind::Fb | CodeKind::Sfb => "functionBlock",
            CodeKind::Fc | CodeKind::Sfc => "function",
        };
        let name = program.name(&key);
        let mut interface = Node::new("interface");
        if let Some(ty) = &block.return_type {
            let ty = self.declarer.type_node(ty, "result", &name, writer);
            interface.push(Node::new("returnType").child(ty));
        }
        let variables = block.sections.iter().flat_map(|section| &section.variables);
        let constants = block.constants.iter().map(|one| (one.name.as_str(), one.name_span));
        let steps = chart::of_block(block).into_iter().flat_map(|chart| &chart.steps);
        let steps = steps.map(|step| (step.name.text.as_str(), step.name.span));
        unique(variables.map(|one| (one.name.as_str(), one.name_span)).chain(constants).chain(steps), writer);
        let operating = chart::operating(block);
        if !operating.is_empty() {
            let title = format!("the operating parameters of `{name}` are not in the file: {}", operating.join(", "));
            let help = "SFC has no operating modes; draw what the program needs of them as steps and transitions";
            writer.warn(block.name.span(), title, help);
        }
        for section in &block.sections {
            interface.children.extend(self.section(section, block, &name, writer));
        }
        interface.children.extend(self.constants(block, &name, writer));
        let local_names: Vec<String> = interface
            .children
            .iter()
            .flat_map(|list| &list.children)
            .filter_map(|one| one.attributes.first())
            .map(|(_, name)| name.to_lowercase())
            .collect();
        let mut steps = chart::of_block(block).into_iter().flat_map(|chart| &chart.steps);
        let is_step = steps.any(|step| identifier(&step.name.text).eq_ignore_ascii_case(&name));
        if is_step || local_names.contains(&name.to_lowercase()) {
            self.learned.hidden.insert(key.clone());
        }
        let mut body = Body::new(program, block, writer, &mut self.learned);
        let code = body_of(&mut body);
        let (used, retyped) = (std::mem::take(&mut body.used), std::mem::take(&mut body.retyped));
        for list in &mut interface.children {
            list.children.retain_mut(|variable| retype(variable, &retyped));
        }
        interface.children.retain(|list| !list.children.is_empty());
        interface.children.extend(self.externals(&used, writer));
        self.used.extend(used);
        let mut node = Node::new("pou").with("name", name).with("pouType", kind).child(interface);
        node.push(Node::new("body").children(code));
        // Those after the last part of a chart.
        let comments = before.into_iter().chain(writer.lines_before(block.span.end)).collect();
        node.children.extend(comment_of(comments, &block.header));
        self.pous.push(node);
    }

    fn section(&mut self, section: &'a Section, block: &CodeBlock, name: &str, writer: &mut Writer) -> Option<Node> {
        let list = match section.kind {
            // A program has no start information; code that reads it is refused.
            SectionKind::Input if block.kind == CodeKind::Ob => return None,
            SectionKind::Input => "inputVars",
            SectionKind::Output => "outputVars",
            SectionKind::InOut => "inOutVars",
            SectionKind::Static => "localVars",
            SectionKind::Temp if is_function(block) => "localVars",
            SectionKind::Temp => "tempVars",
        };
        let mut node = Node::new(list);
        match section.retain {
            Retain::Retain => node.attributes.push(("retain", "true".to_string())),
            Retain::NonRetain => node.attributes.push(("nonretain", "true".to_string())),
            Retain::Unsaid => {}
            Retain::DbSpecific => {
                let title =
                    "each instance chooses whether these variables are retentive, which PLCopen XML does not have";
                writer.refuse(section.span, title, "declare them as retentive or not");
            }
        }
        for variable in &section.variables {
            if block.kind == CodeKind::Ob && body::is_start_name(&variable.name)
                || chart::is_operating(block, &variable.name)
            {
                continue;
            }
            let declared = self.declarer.variable(variable, name, writer);
            node.push(declared);
        }
        (!node.children.is_empty()).then_some(node)
    }

    fn constants(&mut self, block: &'a CodeBlock, name: &str, writer: &mut Writer) -> Option<Node> {
        let mut node = Node::new("localVars").with("constant", "true");
        for constant in &block.constants {
            let (Some(ty), Some(value)) = (&constant.ty, &constant.value) else {
                let title = format!("PLCopen XML has no form for the constant `{}`", constant.name);
                writer.refuse(constant.name_span, title, "declare it in VAR CONSTANT with its type and one value");
                continue;
            };
            let ty = self.declarer.type_node(ty, &constant.name, name, writer);
            let mut body = Body::new(self.program, block, writer, &mut self.learned);
            let text = body.text(value);
            let mut variable = Node::new("variable").with("name", identifier(&constant.name));
            variable.push(Node::new("type").child(ty));
            variable.push(Node::new("initialValue").child(Node::new("simpleValue").with("value", text)));
            let remarks = writer.trivia.on_line(value.span.end);
            let comment: Vec<String> = remarks.iter().map(|remark| bare(&remark.text)).collect();
            if !comment.is_empty() {
                variable.push(documentation(&comment.join("\n")));
            }
            node.push(variable);
        }
        (!node.children.is_empty()).then_some(node)
    }

    /// VAR_EXTERNAL of the global variables that a POU uses.
    fn externals(&mut self, used: &BTreeSet<String>, writer: &mut Writer) -> Vec<Node> {
        let (mut variables, mut constants) =
            (Node::new("externalVars"), Node::new("externalVars").with("constant", "true"));
        for key in used {
            let name = self.program.name(key);
            let mut plain = Node::new("variable").with("name", name);
            let ty = match self.program.global(key) {
                Some(Global::Tag(symbol)) => body::tag_type(symbol).and_then(system::type_element).map(Node::new),
                Some(Global::Constant(constant)) => {
                    let ty = crate::to_stl::types::elementary(&constant.ty).and_then(system::type_element);
                    if let Some(ty) = ty {
                        plain.push(Node::new("type").child(Node::new(ty)));
                        constants.push(plain);
                    }
                    continue;
                }
                Some(Global::Data(block)) => {
                    // Its type is that of its declaration, where messages about it are.
                    let mut quiet = Writer::new(Notation::St, Mnemonics::En, Trivia::none(), None);
                    let known = self.data.iter().find(|(other, ..)| other == key).cloned();
                    let node = match known {
                        Some((_, _, node)) => node,
                        None => globals::data(&mut self.declarer, key, block, &mut quiet),
                    };
                    node.children
                        .into_iter()
                        .find(|child| child.name == "type")
                        .and_then(|ty| ty.children.into_iter().next())
                }
                Some(Global::Variable(variable)) => {
                    Some(self.declarer.type_node(&variable.ty, &variable.name, "", writer))
                }
                Some(Global::Code(_) | Global::Type(_)) | None => None,
            };
            if let Some(ty) = ty {
                plain.push(Node::new("type").child(ty));
                variables.push(plain);
            }
        }
        [variables, constants].into_iter().filter(|list| !list.children.is_empty()).collect()
    }

    // The document.

    /// Names that are others in the file, and attributes that it does not have.
    fn names_that_change(&self) -> Vec<Diagnostic> {
        let mut writer = Writer::new(Notation::St, Mnemonics::En, Trivia::none(), None);
        let mut changed: Vec<(String, String, Span)> = Vec::new();
        for (key, global) in &self.program.globals {
            let span = match global {
                Global::Code(block) => block.name.span(),
                Global::Data(block) => block.name.span(),
                Global::Type(block) => block.name.span(),
                Global::Tag(symbol) => symbol.span,
                Global::Constant(constant) => constant.span,
                Global::Variable(variable) => variable.name_span,
            };
            changed.push((self.program.own_name(key), self.program.name(key), span));
        }
        for block in self.program.code_blocks() {
            for variable in block.sections.iter().flat_map(|section| &section.variables) {
                changed.push((variable.name.clone(), identifier(&variable.name), variable.name_span));
            }
        }
        changed.retain(|(own, name, _)| own != name);
        changed.sort_by_key(|(_, _, span)| (span.file.0, span.start));
        changed.dedup_by(|a, b| (&a.0, &a.1) == (&b.0, &b.1));
        if let Some((own, name, span)) = changed.first() {
            let list: Vec<String> = changed.iter().map(|(own, name, _)| format!("`{own}` is `{name}`")).collect();
            let title = match list.len() {
                1 => format!("`{own}` is `{name}` in the file"),
                count => format!("{count} names are different in the file: {}", list.join(", ")),
            };
            let help =
                "IEC 61131-3 has names of letters, digits and single `_`, and a local variable hides a global one";
            let mut message = Diagnostic::new(plcc_diag::Code::NotConverted, *span, title);
            message.severity = Severity::Warning;
            writer.messages.push(message.label("gets another name").help(help));
        }
        let mut lost: Vec<&str> = self.declarer.attributes.iter().map(|(key, _)| key.as_str()).collect();
        if self.described.is_some() {
            lost.extend(["VERSION", "AUTHOR", "FAMILY"]);
        }
        let first = self.declarer.attributes.first().map(|(_, span)| *span).or(self.described);
        if let Some(span) = first {
            let title = format!("PLCopen XML does not have {}", lost.join(", "));
            writer.warn(span, title, "set what the program needs in the editor again");
        }
        writer.messages
    }

    fn document(mut self, more: Vec<Diagnostic>) -> (String, Vec<Diagnostic>) {
        let mut writer = Writer::new(Notation::St, Mnemonics::En, Trivia::none(), None);
        let globals = self.globals(&mut writer);
        self.messages.append(&mut writer.messages);
        self.messages.extend(more);
        let structures = std::mem::take(&mut self.declarer.structures);
        let structures = structures
            .into_iter()
            .map(|(name, node)| Node::new("dataType").with("name", name).child(Node::new("baseType").child(node)));
        let types = Node::new("dataTypes").children(self.types).children(structures);
        self.tasks.sort_by_key(|task| (task.period_ms.is_some(), task.number));
        let resource = Node::new("resource").with("name", "CPU").children(self.tasks.iter().map(Task::node));
        let configuration = Node::new("configuration").with("name", "PLC").child(resource).children(globals);
        // The format wants a time; the same program gives the same file.
        const TIME: &str = "1970-01-01T00:00:00";
        let scale = |language: &'static str| Node::new(language).child(Node::new("scaling").with("x", 1).with("y", 1));
        let file = Node::new("fileHeader")
            .with("companyName", "")
            .with("productName", "plcc")
            .with("productVersion", env!("CARGO_PKG_VERSION"))
            .with("creationDateTime", TIME);
        let content = Node::new("contentHeader")
            .with("name", self.settings.name)
            .child(Node::new("coordinateInfo").child(scale("fbd")).child(scale("ld")).child(scale("sfc")));
        let root = Node::new("project")
            .with("xmlns", "http://www.plcopen.org/xml/tc6_0201")
            .with("xmlns:xhtml", "http://www.w3.org/1999/xhtml")
            .child(file)
            .child(content)
            .child(Node::new("types").child(types).child(Node::new("pous").children(self.pous)))
            .child(Node::new("instances").child(Node::new("configurations").child(configuration)));
        (node::document(&root), self.messages)
    }

    /// Lists of global variables.
    fn globals(&mut self, writer: &mut Writer) -> Vec<Node> {
        let mut lists: HashMap<&str, Node> = HashMap::new();
        let mut add = |list: &'static str, node: Node| {
            let new = || match list {
                "" => Node::new("globalVars"),
                attribute => Node::new("globalVars").with(attribute, "true"),
            };
            lists.entry(list).or_insert_with(new).push(node);
        };
        for table in self.program.tables {
            for symbol in &table.symbols {
                let key = symbol.name.to_lowercase();
                let is_block = matches!(symbol.target, SymbolTarget::Block { .. });
                if is_block
                    || !matches!(self.program.global(&key), Some(Global::Tag(known)) if std::ptr::eq(known, symbol))
                {
                    continue;
                }
                let is_used = self.used.contains(&key);
                if let Some(node) = globals::tag(self.program, &key, symbol, is_used, writer) {
                    add("", node);
                }
            }
            for constant in &table.constants {
                let key = constant.name.to_lowercase();
                let node = globals::constant(self.program, &key, &constant.ty, &constant.value, constant.span, writer);
                if let Some(node) = node {
                    add("constant", node);
                }
            }
        }
        for (_, retained, node) in std::mem::take(&mut self.data) {
            add(if retained { "retain" } else { "" }, node);
        }
        ["", "retain", "constant"].iter().filter_map(|list| lists.remove(list)).collect()
    }
}

/// Gives an edge bit the block that takes its name; false: the file does not need it.
fn retype(variable: &mut Node, retyped: &HashMap<String, Option<&'static str>>) -> bool {
    let name = variable.attributes.first().map(|(_, name)| name.to_lowercase()).unwrap_or_default();
    match retyped.get(&name) {
        None => true,
        Some(None) => false,
        Some(Some(block)) => {
            let ty = Node::new("type").child(Node::new("derived").with("name", block));
            variable.children.retain(|child| child.name != "type");
            variable.children.insert(0, ty);
            true
        }
    }
}

/// Title and comments of a block.
fn comment_of(before: Vec<String>, header: &Header) -> Option<Node> {
    let lines: Vec<String> =
        before.into_iter().chain(header.title.clone()).chain(header.comment.iter().cloned()).collect();
    let lines: Vec<String> = lines.into_iter().filter(|line| !line.trim().is_empty()).collect();
    (!lines.is_empty()).then(|| documentation(&lines.join("\n")))
}

/// The code of a block in its language.
fn body_of(body: &mut Body) -> Option<Node> {
    let block = body.block;
    let span = block.name.span();
    match &block.code {
        Code::Scl(scl) if scl.dialect == Dialect::Classic => {
            let title =
                format!("`{}` is SCL of STEP 7 V5, which has other rules than ST", body.program.shown(&body.key));
            body.refuse(span, title, "write it as SCL of the TIA Portal first: names with `#` and quotes");
            None
        }
        Code::Scl(scl) => Some(structured_text(body, &[&scl.statements], block.span.end)),
        Code::Graphic(networks) => {
            let is_text = |content: &Content| matches!(content, Content::Scl(_));
            let networks = &networks.networks;
            if !networks.is_empty() && networks.iter().all(|network| is_text(&network.content)) {
                let lists: Vec<&[Statement]> = networks
                    .iter()
                    .filter_map(|network| match &network.content {
                        Content::Scl(list) => Some(list.as_slice()),
                        Content::Graphic(_) | Content::Stl(_) => None,
                    })
                    .collect();
                return Some(structured_text(body, &lists, block.span.end));
            }
            let is_ladder = networks.iter().any(|network| network.language == Language::Lad) || networks.is_empty();
            Some(network::write(body, networks, if is_ladder { Language::Lad } else { Language::Fbd }))
        }
        Code::Stl(_) => {
            let title =
                format!("plcc writes no STL as PLCopen XML, such as that of `{}`", body.program.shown(&body.key));
            body.refuse(span, title, "write it as networks first, with `--to lad`, or as SCL");
            None
        }
        Code::Chart(chart) => chart::write(body, chart),
    }
}

fn structured_text(body: &mut Body, lists: &[&[Statement]], end: u32) -> Node {
    body.writer.out = crate::out::Out::default();
    for list in lists {
        let statements = body.statements(list);
        body.writer.statements(&statements);
    }
    body.writer.remarks_before(end);
    let text = std::mem::take(&mut body.writer.out).into_text();
    Node::new("ST").child(Node::of("xhtml:p", text))
}

/// The address of an operand; one that the format does not have was reported.
pub(crate) fn address(area: Area, width: Width, byte: u32, bit: u8) -> String {
    let letter = match area {
        Area::Q => 'Q',
        Area::M => 'M',
        _ => 'I',
    };
    system::address(letter, width, byte, bit).unwrap_or_default()
}
