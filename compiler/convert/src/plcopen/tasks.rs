//! Organization blocks as programs of tasks.

use plcc_abi::ob::ObClass;
use plcc_syntax::ast::{Block, BlockName, Code, CodeBlock, CodeKind, DataContent};
use plcc_syntax::scl::ast::{ExprKind, Statement, StatementKind};
use plcc_syntax::symbols::has_own_name;

use super::program::{Global, Program};
use super::{Settings, ToldOb};
use crate::node::Node;
use crate::writer::Writer;

/// A task with the instances of programs that it runs: their names and programs.
pub struct Task {
    pub name: String,
    /// `None`: each cycle.
    pub period_ms: Option<u32>,
    pub number: u32,
    pub programs: Vec<(String, String)>,
}

impl Task {
    pub fn node(&self) -> Node {
        let mut node = Node::new("task").with("name", &self.name);
        let priority = match self.period_ms {
            Some(ms) => {
                node.attributes.push(("interval", format!("T#{ms}ms")));
                1
            }
            None => 10,
        };
        let instance =
            |(name, program): &(String, String)| Node::new("pouInstance").with("name", name).with("typeName", program);
        node.with("priority", priority).children(self.programs.iter().map(instance))
    }
}

/// The number and the class of an OB.
fn class(program: &Program, block: &CodeBlock, settings: &Settings) -> ToldOb {
    let attribute = |names: &[&str]| {
        let named = |(key, _): &&(String, String)| names.iter().any(|name| name.eq_ignore_ascii_case(key));
        block.header.attributes.iter().find(named).map(|(_, value)| value.as_str())
    };
    let in_key = program.key(&block.name).strip_prefix("OB ").and_then(|number| number.parse().ok());
    let (told, told_class) = match &block.name {
        BlockName::Numbered { .. } => (None, None),
        BlockName::Symbol { name, .. } => (settings.told_ob)(name),
    };
    let own = match &block.name {
        BlockName::Numbered { number, .. } => Some(*number),
        BlockName::Symbol { .. } => in_key.or(block.header.number),
    };
    let number = own.or_else(|| attribute(&["S7_BlockNumber"]).and_then(|text| text.trim().parse().ok())).or(told);
    let said = attribute(&["S7_EventClass", "SecondaryType"]).map(ObClass::of_name);
    let by_number = || match number {
        Some(number) => {
            let of_number = u16::try_from(number).ok().and_then(ObClass::of_number);
            of_number.or(told_class).or(Some(ObClass::ProgramCycle))
        }
        None => told_class.or(Some(ObClass::ProgramCycle)),
    };
    (number, said.unwrap_or_else(by_number))
}

/// The task of an OB.
pub fn of_block(program: &Program, block: &CodeBlock, settings: &Settings, writer: &mut Writer) -> Option<Task> {
    let key = program.key(&block.name);
    let name = program.name(&key);
    let (number, class) = class(program, block, settings);
    let period_ms = match class {
        Some(ObClass::ProgramCycle) => None,
        Some(ObClass::Cyclic) => {
            let number = number.and_then(|number| u16::try_from(number).ok()).unwrap_or(30);
            Some((settings.period_ms)(number, has_own_name(&block.name)))
        }
        class => {
            let what = class.map_or("another event", |class| class.row().word);
            let title =
                format!("`{}` starts at {what}, and tasks of PLCopen XML run in cycles only", program.shown(&key));
            let help = match class {
                Some(ObClass::Startup) => {
                    "do the same in the first cycle, with a variable that tells it, or give variables start values"
                }
                _ => "do the same in a cyclic OB",
            };
            writer.refuse(block.name.span(), title, help);
            return None;
        }
    };
    let programs = match instances(program, block) {
        Some(list) => list.into_iter().map(|(data, fb)| (program.name(&data), program.name(&fb))).collect(),
        None => vec![(program.free_name(&format!("{name}_instance"), &[]), name.clone())],
    };
    let number = number.unwrap_or(if class == Some(ObClass::ProgramCycle) { 123 } else { 30 });
    Some(Task { name: format!("{name}_task"), period_ms, number, programs })
}

/// The instances of function blocks that an OB calls, if it does nothing else and nothing else uses them: a task can run them.
/// Keys of data blocks and of function blocks.
pub fn instances(program: &Program, block: &CodeBlock) -> Option<Vec<(String, String)>> {
    let Code::Scl(body) = &block.code else { return None };
    let has_variables = block.sections.iter().any(|section| !section.variables.is_empty());
    let unit = program.units.iter().find(|unit| unit.unit.blocks.iter().any(|one| is(one, block)))?;
    let is_inside = |at: u32| block.span.start <= at && at < block.span.end;
    if has_variables || unit.comments.iter().any(|comment| is_inside(comment.start)) || body.statements.is_empty() {
        return None;
    }
    body.statements.iter().map(|statement| instance(program, statement)).collect()
}

fn is(one: &Block, block: &CodeBlock) -> bool {
    matches!(one, Block::Code(one) if std::ptr::eq(one, block))
}

/// `"Plant"()` of an instance data block.
fn instance(program: &Program, statement: &Statement) -> Option<(String, String)> {
    let StatementKind::Expression(value) = &statement.kind else { return None };
    let ExprKind::Call { callee, arguments } = &value.kind else { return None };
    let key = program.callee_key(callee).filter(|_| arguments.is_empty())?;
    let Some(Global::Data(data)) = program.global(&key) else { return None };
    let fb = program.instance_of(data).filter(|_| data.values.is_empty())?;
    let Some(Global::Code(block)) = program.global(&fb) else { return None };
    // Declared and called: each other use of the name may be another call.
    let is_fb = block.kind == CodeKind::Fb && program.uses(&program.own_name(&key)) <= 2;
    let of_fb = |data: &&Block| matches!(data, Block::Data(data) if matches!(data.content, DataContent::OfType(_)) && program.instance_of(data).as_ref() == Some(&fb));
    let blocks = program.units.iter().flat_map(|unit| &unit.unit.blocks);
    // Of a function block that is also declared elsewhere a program cannot be made.
    let only = blocks.filter(of_fb).count() == 1 && program.uses(&program.own_name(&fb)) <= 2;
    (is_fb && only).then_some((key, fb))
}
