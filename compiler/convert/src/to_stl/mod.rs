//! Networks of LAD and FBD as statements, as STEP 7 would write them.
//!
//! - `plan`: which values stay in the RLO, and which need a bit of their own.
//! - `logic`: Boolean expressions as `A`, `O`, `A(`.
//! - `elements`: contacts, coils, edges, jumps; `cells`: S5 timers and counters; `fields`: coils of several bits; `control`: jumps to one
//!   of several labels.
//! - `outputs`: where the values of elements go.
//! - `compare`: comparisons.
//! - `boxes`: boxes with EN and ENO; `formula`: those that compute in several steps; `moves`: MOVE; `shifts`, `choices`.
//! - `values`: types of boxes, how their inputs are loaded and outputs stored.
//! - `calls`: calls of blocks and instances; `instructions`: of instructions of the TIA Portal by their names, `library`: and of blocks.
//! - `operand`: operands of networks as operands of STL; `constants`: constants of blocks; `texts`: temporary texts; `inputs`: copies of
//!   inputs.
//! - [`instances`]: instances where STL has none.
//! - [`types`]: types of operands, where a box does not name its own.
//!
//! Source: LAD/FBD reference, chapter F.

mod boxes;
mod calls;
mod cells;
mod choices;
mod compare;
pub(crate) mod constants;
mod control;
mod elements;
mod fields;
mod formula;
mod inputs;
pub mod instances;
mod instructions;
pub(crate) mod library;
mod logic;
mod moves;
mod operand;
mod outputs;
pub(crate) mod plan;
mod shifts;
mod texts;
pub mod types;
pub mod values;

use std::collections::{HashMap, HashSet};

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    self, Block, CodeBlock, CodeKind, Label, Operand, OperandKind, Path, PathRoot, Section, SectionKind, SourceUnit,
    Statement, StatementKind, TypeKind, TypeRef, Variable,
};
use plcc_syntax::network::ast::{Body, Content, Graph, NetId, Network};
use plcc_syntax::stl::StlInsn;

use crate::from_scl::does_nothing;
use logic::Logic;
pub(crate) use operand::slice_type;
use plan::Plan;
use types::Types;

/// A source whose blocks of LAD and FBD are STL; the others stay as they are.
pub fn unit(unit: &SourceUnit, types: &Types, keeps_br: bool) -> (SourceUnit, Vec<Diagnostic>) {
    let mut made = unit.clone();
    let mut messages = Vec::new();
    for block in &mut made.blocks {
        let Block::Code(code) = block else { continue };
        let ast::Code::Graphic(body) = &code.code else { continue };
        match self::block(code, body, types, keeps_br) {
            Ok(mut done) => {
                if types.is_portal {
                    constants::with_start_values(&mut done);
                }
                *code = done;
            }
            Err(found) => messages.extend(found),
        }
    }
    (made, messages)
}

/// A block with the statements that do what its networks do.
///
/// `keeps_br`: the CPU has a BR, so that ENO of the block is that of its last box; otherwise ENO of a block is 1 unless RET says more.
pub fn block(block: &CodeBlock, body: &Body, types: &Types, keeps_br: bool) -> Result<CodeBlock, Vec<Diagnostic>> {
    let mut maker = Maker {
        types,
        block,
        keeps_br,
        labels: labels_of(body),
        made_labels: 0,
        temporaries: Vec::new(),
        used: HashSet::new(),
        statements: Vec::new(),
        pending: Vec::new(),
        span: block.name.span(),
        messages: Vec::new(),
        values: HashMap::new(),
        outputs: HashMap::new(),
        typed: HashMap::new(),
        rlo: None,
        sets_br: false,
        is_scanned: false,
        is_open: false,
        is_after_list: false,
    };
    maker.messages = instances::of_block(block, types);
    maker.begin_texts();
    let mut networks: Vec<ast::Network> = body.networks.iter().map(|network| maker.network(network)).collect();
    let is_end_reached = networks.iter().rev().find_map(|network| network.statements.last()).is_none_or(goes_on);
    if maker.sets_br && !keeps_br && block.kind != CodeKind::Ob && is_end_reached {
        // ENO of the block, which its boxes used for theirs.
        maker.push(StlInsn::SetRlo, None);
        maker.push(StlInsn::Save, None);
        let statements = std::mem::take(&mut maker.statements);
        networks.push(ast::Network { title: None, comment: Vec::new(), statements });
    }
    maker.copy_inputs(&mut networks);
    if !maker.messages.is_empty() {
        return Err(maker.messages);
    }
    let mut made = block.clone();
    made.code = ast::Code::Stl(networks);
    maker.declare(&mut made);
    Ok(made)
}

/// Whether an instruction combines the RLO with something, if the string of logic is open.
fn is_scan(insn: StlInsn) -> bool {
    use StlInsn::{And, AndNot, Or, OrNot, Xor, XorNot};
    insn.opens_nesting() || matches!(insn, And | AndNot | Or | OrNot | Xor | XorNot)
}

/// What an instruction does to /FC: whether the string of logic is open after it. `None`: it is as before.
fn first_check(insn: StlInsn) -> Option<bool> {
    match insn.status().chars().next_back() {
        Some('-') | None => None,
        sign => Some(sign != Some('0')),
    }
}

/// What follows the statement is reached.
fn goes_on(statement: &Statement) -> bool {
    !matches!(
        statement.kind,
        StatementKind::Instruction { insn: StlInsn::BlockEnd | StlInsn::BlockEndUnconditional, .. }
    )
}

/// Labels of a block by their folded names.
fn labels_of(body: &Body) -> HashMap<String, String> {
    let mut labels = HashMap::new();
    for network in &body.networks {
        let own = network.labels.iter().map(|label| &label.text);
        let statements = match &network.content {
            Content::Stl(list) => list.as_slice(),
            Content::Graphic(_) | Content::Scl(_) => &[],
        };
        let inside = statements.iter().filter_map(|statement| statement.label.as_ref()).map(|label| &label.name);
        labels.extend(own.chain(inside).map(|label| (label.to_lowercase(), label.clone())));
    }
    labels
}

/// What is made of one block.
struct Maker<'a> {
    types: &'a Types<'a>,
    block: &'a CodeBlock,
    keeps_br: bool,
    /// Labels of the block by their folded names.
    labels: HashMap<String, String>,
    made_labels: usize,
    /// Names and types of variables that hold values of nets.
    temporaries: Vec<(String, Elementary)>,
    /// Those that the current network uses.
    used: HashSet<usize>,
    statements: Vec<Statement>,
    /// Labels of the next statement.
    pending: Vec<Label>,
    /// What is being converted.
    span: Span,
    messages: Vec<Diagnostic>,
    /// Values of nets.
    values: HashMap<NetId, Logic>,
    /// Values of outputs, by element and pin.
    outputs: HashMap<(usize, usize), Logic>,
    /// Nets that carry numbers: the variables that hold them.
    typed: HashMap<NetId, (Operand, Elementary)>,
    /// The net whose value the RLO is.
    rlo: Option<NetId>,
    sets_br: bool,
    /// /FC is 1.
    is_scanned: bool,
    /// The last string of logic is open although its value was used, as after SAVE: a scan would go on with it.
    is_open: bool,
    /// The network before is one of statements.
    is_after_list: bool,
}

impl Maker<'_> {
    fn network(&mut self, network: &Network) -> ast::Network {
        self.used.clear();
        self.values.clear();
        self.outputs.clear();
        self.typed.clear();
        self.rlo = None;
        self.span = network.span;
        for label in &network.labels {
            self.label(&label.text);
        }
        match &network.content {
            Content::Graphic(graph) => {
                self.graph(graph);
                self.is_after_list = false;
            }
            Content::Stl(list) => {
                // Statements go on with the logic of statements, not with that of SAVE in a picture.
                if self.is_open && !self.is_after_list {
                    self.push(StlInsn::ClearRlo, None);
                }
                self.is_after_list = true;
                for statement in list {
                    let mut statement = statement.clone();
                    match statement.label {
                        Some(_) => self.close_labels(),
                        None => statement.label = self.pending.pop().map(Box::new),
                    }
                    // ENO of the block does not follow the blocks that they call.
                    self.sets_br |= matches!(statement.kind, StatementKind::Call(_));
                    if let StatementKind::Instruction { insn, .. } = &statement.kind {
                        self.is_scanned = first_check(*insn).unwrap_or(self.is_scanned);
                    }
                    self.is_scanned &= !matches!(statement.kind, StatementKind::Call(_));
                    self.is_open = self.is_scanned;
                    self.statements.push(statement);
                }
            }
            // Its assertions are comments.
            Content::Scl(list) if does_nothing(list) => {}
            Content::Scl(_) => self.refuse(
                network.span,
                "a network in SCL among those of LAD and FBD",
                "leave the block in its language, or write the network in LAD, FBD or STL",
            ),
        }
        self.close_labels();
        ast::Network {
            title: network.title.clone(),
            comment: network.comment.clone(),
            statements: std::mem::take(&mut self.statements),
        }
    }

    fn graph(&mut self, graph: &Graph) {
        if graph.broken {
            return self.refuse(self.span, "a network that was not understood", "repair the source first");
        }
        let plan = Plan::new(graph);
        for &element in &plan.order {
            self.span = graph.elements[element].span;
            self.element(graph, &plan, element);
        }
    }

    // Statements.

    fn push(&mut self, insn: StlInsn, operand: Option<Operand>) {
        self.rlo = None;
        if self.is_open && (is_scan(insn) || insn == StlInsn::Jump) {
            self.is_open = false;
            self.push(StlInsn::ClearRlo, None);
        }
        self.is_open = self.is_scanned && insn == StlInsn::Save || self.is_open && first_check(insn).is_none();
        self.is_scanned = first_check(insn).unwrap_or(self.is_scanned);
        let kind = StatementKind::Instruction { insn, mnemonic_span: self.span, operand };
        self.push_kind(kind);
    }

    fn push_kind(&mut self, kind: StatementKind) {
        if matches!(kind, StatementKind::Call(_)) {
            (self.is_scanned, self.is_open) = (false, false);
        }
        while self.pending.len() > 1 {
            let label = self.pending.remove(0);
            let operand = Some(number(0, self.span));
            let kind = StatementKind::Instruction { insn: StlInsn::Nop, mnemonic_span: self.span, operand };
            self.statements.push(Statement { label: Some(Box::new(label)), kind, span: self.span });
        }
        self.statements.push(Statement { label: self.pending.pop().map(Box::new), kind, span: self.span });
    }

    /// The next statement has this label.
    fn label(&mut self, name: &str) {
        self.rlo = None;
        self.pending.push(Label { name: name.to_string(), span: self.span });
    }

    /// Labels that no statement follows stand before one that does nothing.
    fn close_labels(&mut self) {
        if !self.pending.is_empty() {
            self.push(StlInsn::Nop, Some(number(0, self.span)));
        }
    }

    /// A label that the block does not have.
    fn new_label(&mut self) -> String {
        loop {
            self.made_labels += 1;
            let name = format!("_{:03}", self.made_labels);
            if !self.labels.contains_key(&name) {
                return name;
            }
        }
    }

    /// A jump; returns its place among the statements.
    fn jump(&mut self, insn: StlInsn, label: &str) -> usize {
        self.push(insn, Some(Operand { kind: OperandKind::Label(label.to_string()), span: self.span }));
        self.statements.len() - 1
    }

    /// Inserts statements before the one at `place`, whose label they get.
    fn insert(&mut self, place: usize, statements: Vec<(StlInsn, Operand)>) {
        let mut label = match statements.is_empty() {
            true => None,
            false => self.statements[place].label.take(),
        };
        let span = self.span;
        let made: Vec<Statement> = statements
            .into_iter()
            .map(|(insn, operand)| {
                let kind = StatementKind::Instruction { insn, mnemonic_span: span, operand: Some(operand) };
                Statement { label: label.take(), kind, span }
            })
            .collect();
        self.statements.splice(place..place, made);
    }

    /// A variable for a value of the current network.
    fn temporary(&mut self, ty: Elementary) -> Operand {
        let free = (0..self.temporaries.len()).find(|at| self.temporaries[*at].1 == ty && !self.used.contains(at));
        let at = free.unwrap_or_else(|| {
            let name = self.unused_name();
            self.temporaries.push((name, ty));
            self.temporaries.len() - 1
        });
        self.used.insert(at);
        let (name, span) = (self.temporaries[at].0.clone(), self.span);
        let path = Path { root: PathRoot::Local { name, span }, parts: Vec::new(), span };
        Operand { kind: OperandKind::Path(path), span }
    }

    fn unused_name(&self) -> String {
        let declared = |name: &str| {
            let mut variables = self.block.sections.iter().flat_map(|section| &section.variables);
            variables.any(|variable| variable.name.eq_ignore_ascii_case(name))
                || self.temporaries.iter().any(|(known, _)| known == name)
        };
        (1..).map(|number| format!("net_{number}")).find(|name| !declared(name)).expect("numbers do not end")
    }

    /// Declares the variables that hold values of nets.
    fn declare(&self, block: &mut CodeBlock) {
        if self.temporaries.is_empty() {
            return;
        }
        let at = block.code_start();
        let span = Span { start: at, end: at, ..block.span };
        let variables = self.temporaries.iter().map(|(name, ty)| {
            Variable::new(name, TypeRef { kind: TypeKind::Named(ty.name().to_string()), span }, span)
        });
        let retain = ast::Retain::Unsaid;
        match block.sections.iter_mut().find(|section| section.kind == SectionKind::Temp) {
            Some(section) => section.variables.extend(variables),
            None => {
                let variables = variables.collect();
                block.sections.push(Section { kind: SectionKind::Temp, retain, variables, span });
            }
        }
    }

    fn refuse(&mut self, span: Span, what: impl std::fmt::Display, help: &str) {
        self.messages.push(
            Diagnostic::new(Code::NotConverted, span, format!("STL has no form for {what}"))
                .label("cannot be converted")
                .help(help),
        );
    }
}

/// Where the declarations of a block end in its source.
trait CodeStart {
    fn code_start(&self) -> u32;
}

impl CodeStart for CodeBlock {
    fn code_start(&self) -> u32 {
        self.sections.iter().map(|section| section.span.end).max().unwrap_or(self.name.span().end)
    }
}

/// A whole number as an operand.
fn number(value: i64, span: Span) -> Operand {
    Operand { kind: OperandKind::Literal(plcc_syntax::literal::Literal::Int(value)), span }
}
