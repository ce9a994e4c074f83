//! Global variables, configurations and tasks.

use std::collections::{BTreeSet, HashMap, HashSet};

use plcc_diag::{Code, Diagnostic, FileId, Severity, Span};
use roxmltree::{Document, Node};

use super::Reader;
use super::address::{Addresses, Location, Place, Read, mentioned};
use super::editor::Editor;
use super::interface::{child, elements, is_true};
use super::scope::Global;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    Area, Block, BlockName, BlockPrefix, Code as BlockCode, CodeBlock, CodeKind, Constant, DataBlock, DataContent,
    Header, InitialKind, TypeKind, TypeRef, Variable, Width,
};
use plcc_syntax::scl::ast::{
    Argument, AssignOp, Body, Dialect, Expr, ExprKind, Literal, Name, NameForm, Statement, StatementKind, UnaryOp,
};

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

/// Cyclic OBs with the periods that they have unless plc.toml says otherwise, in milliseconds. Source: SIMATIC S7-300/400 system software,
/// chapter on cyclic interrupts.
const CYCLIC: &[(u32, u64)] =
    &[(30, 5000), (31, 2000), (32, 1000), (33, 500), (34, 200), (35, 100), (36, 50), (37, 20), (38, 10)];

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
    let width = match Elementary::from_word(&ty)?.bits() {
        1 => Width::Bit,
        8 => Width::Byte,
        16 => Width::Word,
        32 => Width::Dword,
        _ => Width::Lword,
    };
    Some((Place { width, ..place }, ty))
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
    for (node, name) in globals.chain(locals) {
        let Some(place) = node.attribute_node("address") else { continue };
        let span = Span::new(file, place.range_value());
        match Location::read(place.value()) {
            Read::At(_) => {
                if let Some((place, ty)) = located(&types, &addresses, node) {
                    tag(name, place, ty, span);
                }
            }
            Read::Open => {}
            Read::Not => {
                let text = format!("`{}` is not an address of this CPU", place.value());
                let message = Diagnostic::new(Code::AddressRange, span, text).label(format!("address of `{name}`"));
                messages.push(message.help("give a complete address in I, Q or M: %IX0.0, %QW2, %MD4"));
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

/// An instance of a program, and the task that runs it.
pub struct Instance {
    name: String,
    program: String,
    span: Span,
    /// Period in milliseconds; `None`: each cycle.
    period: Option<u64>,
    /// False: other programs call it.
    runs: bool,
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
                first.get_or_insert(variable.name_span);
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
            let block = DataBlock { name, header: Header::default(), content, values: Vec::new(), span };
            self.blocks.push(Block::Data(block));
        }
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

    /// The name of the instance of each program, and whether a task runs it: see `configurations`.
    pub fn programs(&mut self, root: Node<'a, 'a>, pous: &[Node<'a, 'a>]) {
        let programs: Vec<(&str, Span)> = pous
            .iter()
            .filter(|pou| pou.attribute("pouType") == Some("program"))
            .filter_map(|pou| Some((pou.attribute("name")?, self.place(*pou, "name"))))
            .collect();
        for node in root.descendants().filter(|node| node.tag_name().name() == "pouInstance") {
            let Some(name) = node.attribute("name") else { continue };
            let ty = node.attribute("typeName").or(node.attribute("type")).map(str::trim).filter(|ty| !ty.is_empty());
            let program = ty.unwrap_or(name);
            let span = self.place(node, "name");
            let Some((program, _)) = programs.iter().find(|(known, _)| known.eq_ignore_ascii_case(program)) else {
                let text = format!("the project has no program `{program}`");
                let message = Diagnostic::new(Code::ForeignContent, span, text).label("this instance is not executed");
                self.messages.push(message.help("export the program too, or remove the instance from its task"));
                continue;
            };
            let task = node.parent().filter(|task| task.tag_name().name() == "task");
            let period = task.and_then(|task| self.period(task));
            let name = self.free_name(name);
            let (program, runs) = (program.to_string(), true);
            self.instances.push(Instance { name, program, span, period, runs });
        }
        let configured = !self.instances.is_empty();
        let mut idle = Vec::new();
        for (program, span) in &programs {
            if self.instances.iter().any(|instance| instance.program.eq_ignore_ascii_case(program)) {
                continue;
            }
            let others = || {
                let other = |pou: &&Node| !pou.attribute("name").is_some_and(|name| name.eq_ignore_ascii_case(program));
                pous.iter().filter(other).filter_map(|pou| self.overlay.get(pou.range()))
            };
            let called = others().any(|text| calls(text, program));
            if configured && !called {
                idle.push((program.to_string(), *span));
                if !others().any(|text| super::mentions(text, program)) {
                    continue;
                }
            }
            let name = self.free_name(&format!("{program}_DB"));
            let (program, span) = (program.to_string(), *span);
            let runs = !called && !configured;
            self.instances.push(Instance { name, program, span, period: None, runs });
        }
        for (program, span) in idle {
            let text = format!("the program `{program}` belongs to no task");
            let message = Diagnostic::new(Code::Tolerated, span, text).label("is not executed");
            self.messages.push(message.help("give it to a task, or call it in another program"));
        }
        let running: Vec<&Instance> = self.instances.iter().filter(|instance| instance.runs).collect();
        if let (false, Some(second)) = (configured, running.get(1)) {
            let text = "the project has no task, so its programs run one after the other in each cycle";
            let message = Diagnostic::new(Code::Tolerated, second.span, text).label("runs after the previous program");
            self.messages.push(message.help("give the programs to tasks in the configuration of the project"));
        }
        for (program, _) in programs {
            let mut own = self.instances.iter().filter(|instance| instance.program.eq_ignore_ascii_case(program));
            if let (Some(instance), None) = (own.next(), own.next()) {
                self.program_instances.insert(program.to_lowercase(), instance.name.clone());
            }
        }
    }

    /// A name for an instance that is used for nothing else.
    fn free_name(&self, wanted: &str) -> String {
        let is_taken = |name: &str| {
            self.pous.contains(&name.to_lowercase())
                || name.eq_ignore_ascii_case(GLOBALS)
                || self.globals.contains_key(&name.to_lowercase())
                || self.types.contains_key(&name.to_lowercase())
                || self.instances.iter().any(|instance| instance.name.eq_ignore_ascii_case(name))
        };
        let mut name = wanted.to_string();
        let mut number = 1;
        while is_taken(&name) {
            name = format!("{wanted}_{number}");
            number += 1;
        }
        name
    }

    /// The interval of a task in milliseconds.
    fn period(&mut self, task: Node) -> Option<u64> {
        let Some(interval) = task.attribute_node("interval").filter(|interval| !interval.value().trim().is_empty())
        else {
            if let Some(single) = task.attribute_node("single").filter(|single| !single.value().trim().is_empty()) {
                let text = format!("plcc does not read tasks that an event starts, such as `{}`", single.value());
                let message = Diagnostic::new(Code::ForeignContent, self.span(single.range_value()), text);
                let help = "call the program from a cyclic one, after an R_TRIG of the variable";
                self.messages.push(message.label("its programs run in each cycle").help(help));
            }
            return None;
        };
        let span = self.span(interval.range_value());
        let text = interval.value();
        let Some(microseconds) = microseconds(text) else {
            let message = Diagnostic::new(Code::ForeignContent, span, format!("`{text}` is not an interval of a task"));
            self.messages.push(message.label("its programs run in each cycle").help("write it as T#20ms"));
            return None;
        };
        let milliseconds = microseconds.div_ceil(1000);
        if milliseconds * 1000 != microseconds {
            let title = format!("an interval of {text} is longer here: OBs run at whole milliseconds");
            let message = Diagnostic::new(Code::Tolerated, span, title).label(format!("read as {milliseconds} ms"));
            self.messages.push(message.help("give the task an interval of whole milliseconds"));
        }
        Some(milliseconds)
    }

    /// Instances of programs, and the OBs that call them. Without a configuration each program runs in OB 1.
    pub fn configurations(&mut self) {
        let instances = std::mem::take(&mut self.instances);
        if let Some(first) = instances.first() {
            self.call(&instances, first.span);
        }
        let starts = std::mem::take(&mut self.starts);
        if let Some(first) = starts.first() {
            let span = first.span;
            self.organization_block(100, starts, span);
        }
    }

    fn call(&mut self, instances: &[Instance], first: Span) {
        let mut calls: Vec<(u32, Vec<Statement>, Span)> = vec![(1, Vec::new(), first)];
        let mut periods: Vec<(u64, u32)> = Vec::new();
        for instance in instances {
            let span = instance.span;
            let program = BlockName::Symbol { name: instance.program.clone(), span };
            let content = DataContent::OfType(TypeRef { kind: TypeKind::Block(program), span });
            let name = BlockName::Symbol { name: instance.name.clone(), span };
            let block = DataBlock { name, header: Header::default(), content, values: Vec::new(), span };
            self.blocks.push(Block::Data(block));
            if !instance.runs {
                continue;
            }
            let callee = Name { text: instance.name.clone(), form: NameForm::Quoted, span };
            let callee = Box::new(Expr { kind: ExprKind::Name(callee), span });
            let call = Expr { kind: ExprKind::Call { callee, arguments: Vec::new() }, span };
            let statement = Statement { kind: StatementKind::Expression(call), span };
            let number = match instance.period {
                None => 1,
                Some(period) => match self.cyclic(period, &mut periods, span) {
                    Some(number) => number,
                    None => continue,
                },
            };
            match calls.iter_mut().find(|(known, ..)| *known == number) {
                Some((_, statements, _)) => statements.push(statement),
                None => calls.push((number, vec![statement], span)),
            }
        }
        for (number, statements, span) in calls {
            self.organization_block(number, statements, span);
        }
    }

    fn organization_block(&mut self, number: u32, statements: Vec<Statement>, span: Span) {
        self.blocks.push(Block::Code(CodeBlock {
            kind: CodeKind::Ob,
            name: BlockName::Numbered { prefix: BlockPrefix::Ob, number, span },
            return_type: None,
            header: Header::default(),
            sections: Vec::new(),
            constants: Vec::new(),
            code: BlockCode::Scl(Body { dialect: Dialect::Tia, labels: Vec::new(), statements }),
            span,
        }));
    }

    /// The cyclic OB for a period: the one that has it, otherwise a free one, whose period plc.toml must set.
    fn cyclic(&mut self, period: u64, periods: &mut Vec<(u64, u32)>, span: Span) -> Option<u32> {
        if let Some((_, number)) = periods.iter().find(|(known, _)| *known == period) {
            return Some(*number);
        }
        if let Some((number, _)) = CYCLIC.iter().find(|(_, known)| *known == period) {
            periods.push((period, *number));
            return Some(*number);
        }
        let free = CYCLIC.iter().find(|(number, _)| !periods.iter().any(|(_, used)| used == number));
        let Some((number, _)) = free else {
            let text = "there are more different intervals of tasks than the CPU has cyclic OBs";
            let message = Diagnostic::new(Code::ForeignContent, span, text).label("no OB is left for this program");
            self.messages.push(message.help("let programs share a task"));
            return None;
        };
        periods.push((period, *number));
        if period > PERIOD_MAX_MS {
            let text = format!("an interval of {period} ms is longer than a cyclic OB can have");
            let message = Diagnostic::new(Code::ForeignContent, span, text).label("more than one minute");
            self.messages.push(message.help("count shorter intervals in the program"));
            return None;
        }
        self.starts.push(set_period(*number, period, span));
        Some(*number)
    }
}

/// The longest period of a cyclic OB. Source: S7-1200 reference, SET_CINT.
const PERIOD_MAX_MS: u64 = 60_000;

/// `SET_CINT(OB_NR := 30, CYCLE := 1000, PHASE := 0)`
fn set_period(number: u32, milliseconds: u64, span: Span) -> Statement {
    let argument = |name: &str, value: u64| Argument {
        name: Some(Name { text: name.to_string(), form: NameForm::Bare, span }),
        output: false,
        value: Some(integer(value as i64, span)),
        span,
    };
    let arguments =
        vec![argument("OB_NR", number.into()), argument("CYCLE", milliseconds * 1000), argument("PHASE", 0)];
    let callee = Name { text: "SET_CINT".to_string(), form: NameForm::Bare, span };
    let callee = Box::new(Expr { kind: ExprKind::Name(callee), span });
    let call = Expr { kind: ExprKind::Call { callee, arguments }, span };
    Statement { kind: StatementKind::Expression(call), span }
}

/// Whether the text calls a program: in ST by its name before a parenthesis, as a block, or in IL.
fn calls(text: &str, program: &str) -> bool {
    let text = super::il::without_comments(text).to_ascii_lowercase();
    let name = program.to_ascii_lowercase();
    let is_word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.');
    text.contains(&format!("typename=\"{name}\""))
        || text.match_indices(&name).any(|(at, _)| {
            let (before, after) = (&text[..at], &text[at + name.len()..]);
            let whole = !before.ends_with(is_word) && !after.starts_with(is_word);
            let cal = before.trim_end().rsplit(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
            whole && (after.trim_start().starts_with('(') || matches!(cal, "cal" | "calc" | "calcn"))
        })
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

/// The interval of a task in microseconds, rounded up; `None`: not a time, or 0.
fn microseconds(text: &str) -> Option<u64> {
    let whole = plcc_literal::duration::interval(text)?.div_ceil(1000);
    (1..1_000_000_000_000_000).contains(&whole).then_some(whole)
}

#[cfg(test)]
mod tests {
    use super::microseconds;

    #[test]
    fn intervals_have_many_forms() {
        let cases = [
            ("T#20ms", Some(20_000)),
            ("PT0.02S", Some(20_000)),
            ("P0DT0H0M1.5S", Some(1_500_000)),
            ("t#1s_500ms", Some(1_500_000)),
            ("T#100us", Some(100)),
            ("PT0.0005S", Some(500)),
            ("T#1.5ms", Some(1_500)),
            ("T#0.1ms", Some(100)),
            ("T#1.001s", Some(1_001_000)),
            ("PT4.035S", Some(4_035_000)),
            ("T#1ns", Some(1)),
            ("T#.s", None),
            ("T#1.2.3s", None),
            ("T#99999999999999999999s", None),
            ("T#0s", None),
            ("soon", None),
        ];
        for (text, wanted) in cases {
            assert_eq!(microseconds(text), wanted, "{text}");
        }
    }
}
