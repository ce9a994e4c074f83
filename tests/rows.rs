//! Each row of each table has a run test: instructions of STL and of the S7-200, elements of LAD and FBD, functions of SCL,
//! qualifiers and events of GRAPH, system functions of the runtime.
//!
//! What a test contains is read from its syntax tree or its tokens, so comments, names and texts do not count.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use plcc_diag::FileId;
use plcc_driver::inputs;
use plcc_driver::pipeline::language_of;
use plcc_readers::{ReadOptions, parse};
use plcc_syntax::ast::{
    Block, BlockName, BlockPrefix, Code, Operand, OperandKind, PathRoot, SourceUnit, Statement, StatementKind,
};
use plcc_syntax::chart::ast::{ActionBody, Body as Chart, Call, Condition, Event, PermanentKind, Qualifier};
use plcc_syntax::network::ast::{Content, Network, Target};
use plcc_syntax::network::elements::elements;
use plcc_syntax::s7200::{self, Compare, Insn};
use plcc_syntax::scl::ast::{Expr, ExprKind};
use plcc_syntax::scl::raw::{self, RawKind};
use plcc_syntax::stl::{Mnemonics, StlInsn};
use plcc_tests::{costs, root, shown, tests_folder};

/// What the run tests contain.
static FOUND: LazyLock<Found> = LazyLock::new(|| {
    let folders = [tests_folder().join("run"), tests_folder().join("twins"), root().join("samples")];
    let mut found = Found::default();
    for path in folders.iter().flat_map(|folder| all_files(folder)) {
        if let Some("stl" | "scl" | "gr7" | "s7dcl" | "awl" | "xml") =
            path.extension().and_then(|ending| ending.to_str())
        {
            found.file(&path);
        }
    }
    found
});

#[test]
fn every_instruction_has_its_test_file() {
    let folder = tests_folder().join("run/stl/insn");
    let missing = StlInsn::ALL.iter().map(|insn| snake_case(insn.row())).filter(|name| {
        let path = folder.join(format!("{name}.stl"));
        let mut found = Found::default();
        if path.is_file() {
            found.file(&path);
        }
        !found.stl.iter().any(|insn| snake_case(insn.row()) == *name)
    });
    none(missing, "file of its name in tests/run/stl/insn with the instruction");
}

#[test]
fn every_instruction_of_the_s7_200_is_in_a_test() {
    let rows = Insn::ROWS.iter().copied().chain(Compare::all().map(Insn::Compare));
    let missing = rows.filter(|insn| !FOUND.s7200.contains(insn)).map(|insn| insn.mnemonic(Mnemonics::En).into_owned());
    none(missing, "test with the instruction of the S7-200");
}

#[test]
fn every_element_is_in_a_test() {
    let missing = elements().map(|row| row.name).filter(|name| !FOUND.elements.contains(name));
    none(missing, "test with the element");
}

#[test]
fn every_function_of_scl_is_in_a_test() {
    // A function may carry a type: `ABS_INT`.
    let called = |name: &str| {
        FOUND
            .calls
            .iter()
            .any(|word| word.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with('_')))
    };
    none(
        plcc_program::tables::scl::FUNCTIONS.iter().map(|row| row.name).filter(|name| !called(&name.to_uppercase())),
        "test with the function",
    );
}

#[test]
fn every_qualifier_and_event_of_graph_is_in_a_test() {
    let qualifiers = Qualifier::ALL.into_iter().filter(|one| !FOUND.qualifiers.contains(one)).map(Qualifier::name);
    none(qualifiers, "test with the qualifier");
    none(Event::ALL.into_iter().filter(|one| !FOUND.events.contains(one)).map(Event::name), "test with the event");
}

#[test]
fn every_system_function_is_in_a_test() {
    let called = |number: u16, name: &str| {
        FOUND.calls.contains(&name.to_uppercase()) || FOUND.calls.contains(&format!("SFC{number}"))
    };
    // Those from 1000 on are parts of library blocks, which have tests under their own names.
    let documented = plcc_runtime::system::table().filter(|(number, ..)| *number < 1000);
    let missing = documented.filter(|(number, name, _)| !called(*number, name));
    none(missing.map(|(number, name, _)| format!("SFC {number} {name}")), "test that calls");
}

/// docs/benchmarks.md says which rows have none.
#[test]
fn every_row_has_a_cost() {
    let rows: HashSet<String> = costs::rows().iter().map(costs::Row::key).collect();
    let missing = |set: &str, name: &str| !rows.contains(&format!("{set} {name}"));
    none(StlInsn::ALL.iter().map(|insn| insn.row()).filter(|name| missing("STL", name)), "cost of the instruction");
    let ends = costs::s7200::without_sequence();
    let s7200 = Insn::ROWS.iter().map(|insn| insn.row()).filter(|name| !ends.contains(name));
    none(s7200.filter(|name| missing("S7-200", name)), "cost of the instruction of the S7-200");
    let compares = Compare::all().map(|compare| compare.mnemonic(Mnemonics::En));
    none(compares.filter(|name| missing("S7-200", name)), "cost of the contact");
    let functions = plcc_program::tables::scl::FUNCTIONS.iter().map(|row| row.name);
    none(functions.filter(|name| missing("SCL", name)), "cost of the function");
    let elements = elements().map(|row| row.name).filter(|name| !costs::network::has_sequence_elsewhere(name));
    none(elements.filter(|name| missing("LAD", name)), "cost of the element");
    let actions = Qualifier::ALL.into_iter().map(Qualifier::name).chain(Event::ALL.into_iter().map(Event::name));
    none(actions.filter(|name| missing("GRAPH", name)), "cost of the action");
    assert_eq!(rows.len(), costs::rows().len(), "each row has another name");
}

/// Fails if something is `missing`.
fn none(missing: impl Iterator<Item = impl ToString>, what: &str) {
    let missing: Vec<String> = missing.map(|one| one.to_string()).collect();
    assert!(missing.is_empty(), "there is no {what}: {}", missing.join(", "));
}

/// Rows that tests contain.
#[derive(Default)]
struct Found {
    stl: HashSet<StlInsn>,
    s7200: HashSet<Insn>,
    elements: HashSet<&'static str>,
    qualifiers: HashSet<Qualifier>,
    events: HashSet<Event>,
    /// Names of what is called, in capital letters; `SFC20`.
    calls: HashSet<String>,
}

impl Found {
    fn file(&mut self, path: &Path) {
        let text = inputs::read_text(path).unwrap_or_else(|error| panic!("{}: {error}", shown(path)));
        let options = ReadOptions { language: language_of(&path.to_string_lossy()), ..ReadOptions::default() };
        let (unit, _) = parse(FileId(0), &text, &options);
        if unit.s7200.is_none() {
            self.words(unit.overlay.as_deref().unwrap_or(&text));
        }
        self.unit(&unit);
    }

    /// Words before `(`.
    fn words(&mut self, text: &str) {
        let tokens = raw::scan(text).tokens;
        let calls =
            tokens.windows(2).filter(|pair| pair[0].kind == RawKind::Word && pair[1].kind == RawKind::LeftParen);
        self.calls.extend(calls.map(|pair| pair[0].text(text).to_uppercase()));
    }

    fn unit(&mut self, unit: &SourceUnit) {
        for block in &unit.blocks {
            let Block::Code(block) = block else { continue };
            match &block.code {
                Code::Stl(networks) => {
                    networks.iter().flat_map(|network| &network.statements).for_each(|one| self.statement(one));
                }
                Code::Scl(_) => {}
                Code::Graphic(body) => body.networks.iter().for_each(|network| self.network(network)),
                Code::Chart(chart) => self.chart(chart),
            }
        }
        let networks = unit.s7200.iter().flat_map(|source| &source.blocks).flat_map(|block| &block.networks);
        for statement in networks.flat_map(|network| &network.statements) {
            if let s7200::ast::StatementKind::Instruction { insn, .. } = &statement.kind {
                self.s7200.insert(*insn);
            }
        }
    }

    fn statement(&mut self, statement: &Statement) {
        match &statement.kind {
            StatementKind::Instruction { insn, operand, .. } => {
                self.stl.insert(*insn);
                operand.iter().for_each(|operand| self.block(operand));
            }
            StatementKind::Call(call) => self.block(&call.target),
            StatementKind::Empty | StatementKind::Pragma(_) | StatementKind::Error => {}
        }
    }

    /// The system function that an operand of STL names.
    fn block(&mut self, operand: &Operand) {
        match &operand.kind {
            OperandKind::Block(BlockName::Numbered { prefix: BlockPrefix::Sfc, number, .. }) => {
                self.calls.insert(format!("SFC{number}"));
            }
            OperandKind::Block(BlockName::Symbol { name, .. }) => _ = self.calls.insert(name.to_uppercase()),
            OperandKind::Path(path) => {
                if let PathRoot::Quoted { name, .. } | PathRoot::Bare { name, .. } = &path.root {
                    self.calls.insert(name.to_uppercase());
                }
            }
            _ => {}
        }
    }

    fn network(&mut self, network: &Network) {
        match &network.content {
            Content::Scl(_) => {}
            Content::Stl(statements) => statements.iter().for_each(|one| self.statement(one)),
            Content::Graphic(graph) => {
                for element in &graph.elements {
                    match &element.target {
                        Target::Element { row, .. } => _ = self.elements.insert(row.name),
                        Target::Block { callee, .. } => self.callee(callee),
                    }
                }
            }
        }
    }

    fn chart(&mut self, chart: &Chart) {
        for permanent in chart.before.iter().chain(&chart.after) {
            match &permanent.kind {
                PermanentKind::Coil { .. } => {}
                PermanentKind::Call(Call { block, .. }) => self.callee(block),
                PermanentKind::Network(network) => self.network(network),
            }
        }
        for action in chart.steps.iter().flat_map(|step| &step.actions) {
            self.qualifiers.insert(action.qualifier);
            self.events.extend(action.event);
            match &action.body {
                ActionBody::Call(Call { block, .. }) => self.callee(block),
                ActionBody::Network(network) => self.network(network),
                ActionBody::Operand(_)
                | ActionBody::Value { .. }
                | ActionBody::All { .. }
                | ActionBody::Statements(_)
                | ActionBody::Error => {}
            }
        }
        let conditions = chart.steps.iter().flat_map(|step| step.interlock.iter().chain(&step.supervision));
        for condition in conditions.chain(chart.transitions.iter().flat_map(|transition| &transition.condition)) {
            if let Condition::Network(network) = condition {
                self.network(network);
            }
        }
    }

    fn callee(&mut self, callee: &Expr) {
        if let ExprKind::Name(name) = &callee.kind {
            self.calls.insert(name.text.to_uppercase());
        }
    }
}

/// All files in `folder` and below, those of projects too.
fn all_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    entries.flat_map(|path| if path.is_dir() { all_files(&path) } else { vec![path] }).collect()
}

/// `AddI` to `add_i`.
fn snake_case(row: &str) -> String {
    let mut name = String::new();
    for (index, letter) in row.char_indices() {
        if index > 0 && letter.is_uppercase() {
            name.push('_');
        }
        name.extend(letter.to_lowercase());
    }
    name
}
