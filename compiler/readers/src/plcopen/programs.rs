//! Configurations and tasks: the blocks that call the programs.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_literal::distance::nearest;
use roxmltree::Node;

use super::Reader;
use super::globals::{GLOBALS, integer};
use super::pou::mentions;
use plcc_syntax::ast::{
    Block, BlockName, BlockPrefix, Code as BlockCode, CodeBlock, CodeKind, DataBlock, DataContent, Header, TypeKind,
    TypeRef,
};
use plcc_syntax::scl::ast::{Argument, Body, Dialect, Expr, ExprKind, Name, NameForm, Statement, StatementKind};

/// Cyclic OBs with the periods that they have unless plc.toml says otherwise, in milliseconds. Source: SIMATIC S7-300/400 system software,
/// chapter on cyclic interrupts.
const CYCLIC: &[(u32, u64)] =
    &[(30, 5000), (31, 2000), (32, 1000), (33, 500), (34, 200), (35, 100), (36, 50), (37, 20), (38, 10)];

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
                let help = match nearest(program, programs.iter().map(|(known, _)| *known)) {
                    Some(meant) => format!("is `{meant}` meant?"),
                    None => "export the program too, or remove the instance from its task".to_string(),
                };
                self.messages.push(message.help(help));
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
                if !others().any(|text| mentions(text, program)) {
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
            let (header, values, retained) = (Header::default(), Vec::new(), Vec::new());
            let block = DataBlock { name, header, content, values, retained, span };
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
