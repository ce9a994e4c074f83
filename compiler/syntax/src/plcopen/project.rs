//! Global variables, configurations and tasks.

use plcc_diag::{Code, Diagnostic, FileId, Span};
use roxmltree::{Document, Node};

use super::Reader;
use super::interface::{child, elements};
use super::scope::address;
use crate::ast::{
    Block, BlockName, BlockPrefix, Code as BlockCode, CodeBlock, CodeKind, Constant, DataBlock, DataContent, Header,
    TypeKind, TypeRef, Variable,
};
use crate::scl::ast::{Body, Dialect, Expr, ExprKind, Literal, Name, NameForm, Statement, StatementKind, UnaryOp};

/// The data block of the global variables.
pub const GLOBALS: &str = "GlobalVariables";

/// A variable with an address.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tag {
    /// Of a global variable its name; of a POU's, `POU.name`.
    pub name: String,
    /// As the vendor writes it: `%MW2`.
    pub address: String,
    /// `"BOOL"`.
    pub ty: String,
    pub span: Span,
}

/// Cyclic OBs with the periods that they have unless plc.toml says otherwise, in milliseconds. Source: SIMATIC S7-300/400 system software,
/// chapter on cyclic interrupts.
const CYCLIC: &[(u32, u64)] =
    &[(30, 5000), (31, 2000), (32, 1000), (33, 500), (34, 200), (35, 100), (36, 50), (37, 20), (38, 10)];

/// The name of the tag of a variable with an address.
pub fn tag_name(pou: Option<&str>, name: &str) -> String {
    match pou {
        Some(pou) => format!("{pou}.{name}"),
        None => name.to_string(),
    }
}

/// The variables with an address in a project, and messages about addresses that the CPU does not have.
pub fn tags(file: FileId, text: &str) -> (Vec<Tag>, Vec<Diagnostic>) {
    let (mut tags, mut messages) = (Vec::new(), Vec::new());
    let Ok(document) = Document::parse(text) else { return (tags, messages) };
    let variables = document.descendants().filter(|node| node.tag_name().name() == "variable");
    for variable in variables {
        let (Some(name), Some(place)) = (variable.attribute("name"), variable.attribute_node("address")) else {
            continue;
        };
        let pou =
            variable.ancestors().find(|node| node.tag_name().name() == "pou").and_then(|pou| pou.attribute("name"));
        let span = Span::new(file, place.range_value());
        let ty = child(variable, "type").and_then(|ty| elements(ty).next());
        let ty = ty.map(|ty| ty.tag_name().name().to_ascii_uppercase()).unwrap_or_default();
        match address(place.value()) {
            Some(address) => tags.push(Tag { name: tag_name(pou, name), address, ty, span }),
            None => {
                let text = format!("`{}` is no address of this CPU", place.value());
                let message = Diagnostic::new(Code::AddressRange, span, text).label(format!("address of `{name}`"));
                messages.push(message.help("give a complete address in I, Q or M: %IX0.0, %QW2, %MD4"));
            }
        }
    }
    (tags, messages)
}

/// An instance of a program, and the task that runs it.
struct Instance {
    name: String,
    program: String,
    span: Span,
    /// Period in milliseconds; `None`: each cycle.
    period: Option<u64>,
}

impl<'a> Reader<'a> {
    /// Global variables: those with an address are tags, the others components of a data block.
    pub fn global_variables(&mut self, root: Node<'a, 'a>) {
        let mut variables: Vec<Variable> = Vec::new();
        let mut first = None;
        let lists = root.descendants().filter(|node| node.tag_name().name() == "globalVars");
        for list in lists.filter(|list| !list.ancestors().any(|node| node.tag_name().name() == "pou")) {
            for node in elements(list).filter(|node| node.tag_name().name() == "variable") {
                let Some(name) = node.attribute("name") else { continue };
                if node.has_attribute("address") {
                    self.located.push((name.to_lowercase(), tag_name(None, name)));
                } else if let Some(variable) = self.variable(node, 0) {
                    first.get_or_insert(variable.name_span);
                    self.globals.insert(name.to_lowercase());
                    variables.push(variable);
                }
            }
        }
        if let Some(span) = first {
            let name = BlockName::Symbol { name: GLOBALS.to_string(), span };
            let content = DataContent::Struct(variables);
            let block = DataBlock { name, header: Header::default(), content, values: Vec::new(), span };
            self.blocks.push(Block::Data(block));
        }
    }

    /// A value of an enumeration as a constant of a POU.
    pub fn enum_constant(&self, node: Node, name: &str, number: i64) -> Constant {
        let name_span = self.place(node, "name");
        let literal = ExprKind::Literal(Literal::Integer { value: number.unsigned_abs(), based: false });
        let mut value = Expr { kind: literal, span: name_span };
        if number < 0 {
            let operand = Box::new(value);
            value = Expr { kind: ExprKind::Unary { op: UnaryOp::Minus, operand }, span: name_span };
        }
        let ty = TypeRef { kind: TypeKind::Named("INT".to_string()), span: name_span };
        Constant { name: name.to_string(), name_span, ty: Some(ty), value: Some(value) }
    }

    /// Instances of programs, and the OBs that call them. Without a configuration each program runs in OB 1.
    pub fn configurations(&mut self, root: Node<'a, 'a>, pous: &[Node<'a, 'a>]) {
        let programs: Vec<(&str, Span)> = pous
            .iter()
            .filter(|pou| pou.attribute("pouType") == Some("program"))
            .filter_map(|pou| Some((pou.attribute("name")?, self.place(*pou, "name"))))
            .collect();
        let mut instances = Vec::new();
        for node in root.descendants().filter(|node| node.tag_name().name() == "pouInstance") {
            let (Some(name), Some(program)) =
                (node.attribute("name"), node.attribute("typeName").or(node.attribute("type")))
            else {
                continue;
            };
            if !programs.iter().any(|(known, _)| known.eq_ignore_ascii_case(program)) {
                continue;
            }
            let task = node.parent().filter(|task| task.tag_name().name() == "task");
            let period = task.and_then(|task| self.period(task));
            let (name, program) = (self.free_name(name, &instances), program.to_string());
            instances.push(Instance { name, program, span: self.place(node, "name"), period });
        }
        if instances.is_empty() {
            for (program, span) in programs {
                let name = self.free_name(&format!("{program}_DB"), &instances);
                instances.push(Instance { name, program: program.to_string(), span, period: None });
            }
        }
        if !instances.is_empty() {
            self.call(&instances);
        }
    }

    /// A name for an instance that nothing else has.
    fn free_name(&self, wanted: &str, instances: &[Instance]) -> String {
        let is_taken = |name: &str| {
            self.pous.contains(&name.to_lowercase())
                || name.eq_ignore_ascii_case(GLOBALS)
                || self.located.iter().any(|(known, _)| *known == name.to_lowercase())
                || instances.iter().any(|instance| instance.name.eq_ignore_ascii_case(name))
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
        let interval = task.attribute_node("interval").filter(|interval| !interval.value().trim().is_empty())?;
        let milliseconds = milliseconds(interval.value());
        if milliseconds.is_none() {
            let span = self.span(interval.range_value());
            let text = format!("`{}` is no interval of a task", interval.value());
            let message = Diagnostic::new(Code::ForeignContent, span, text).label("whole milliseconds are wanted");
            self.messages.push(message.help("write it as T#20ms"));
        }
        milliseconds
    }

    fn call(&mut self, instances: &[Instance]) {
        let mut calls: Vec<(u32, Vec<Statement>, Span)> = vec![(1, Vec::new(), instances[0].span)];
        let mut periods: Vec<(u64, u32)> = Vec::new();
        for instance in instances {
            let span = instance.span;
            let program = BlockName::Symbol { name: instance.program.clone(), span };
            let content = DataContent::OfType(TypeRef { kind: TypeKind::Block(program), span });
            let name = BlockName::Symbol { name: instance.name.clone(), span };
            let block = DataBlock { name, header: Header::default(), content, values: Vec::new(), span };
            self.blocks.push(Block::Data(block));
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
    }

    /// The cyclic OB for a period: the one that has it, else a free one, whose period plc.toml must set.
    fn cyclic(&mut self, period: u64, periods: &mut Vec<(u64, u32)>, span: Span) -> Option<u32> {
        if let Some((_, number)) = periods.iter().find(|(known, _)| *known == period) {
            return Some(*number);
        }
        if let Some((number, _)) = CYCLIC.iter().find(|(_, known)| *known == period) {
            periods.push((period, *number));
            return Some(*number);
        }
        let free = CYCLIC.iter().find(|(number, _)| !periods.iter().any(|(_, used)| used == number));
        let Some((number, default)) = free else {
            let text = "more tasks with different intervals than the CPU has cyclic OBs";
            let message = Diagnostic::new(Code::ForeignContent, span, text).label("no OB is left for this program");
            self.messages.push(message.help("let programs share a task"));
            return None;
        };
        periods.push((period, *number));
        let text = format!("no cyclic OB has a period of {period} ms by itself");
        let message =
            Diagnostic::new(Code::Tolerated, span, text).label(format!("runs in OB {number}, each {default} ms"));
        self.messages.push(message.help(format!("set the period of OB {number} to {period} ms in plc.toml")));
        Some(*number)
    }
}

/// `T#1s500ms`, `PT0.02S`, `20ms` in milliseconds; `None`: no time, 0, or no whole milliseconds.
fn milliseconds(text: &str) -> Option<u64> {
    let lower = text.trim().to_ascii_lowercase();
    let iso = lower.strip_prefix("pt").map(str::to_string);
    let rest = ["t#", "time#"].iter().find_map(|prefix| lower.strip_prefix(prefix));
    let mut rest: &str = iso.as_deref().or(rest).unwrap_or(&lower);
    let mut total = 0.0_f64;
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.')?;
        let number: f64 = rest[..digits].parse().ok()?;
        rest = &rest[digits..];
        let units =
            [("ms", 1.0), ("us", 0.001), ("s", 1000.0), ("m", 60_000.0), ("h", 3_600_000.0), ("d", 86_400_000.0)];
        let (unit, factor) = units.iter().find(|(unit, _)| rest.starts_with(unit))?;
        total += number * factor;
        rest = rest[unit.len()..].trim_start_matches('_');
    }
    let rounded = total.round();
    ((total - rounded).abs() < 1e-6 && (1.0..1e9).contains(&rounded)).then_some(rounded as u64)
}
