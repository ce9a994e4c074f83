//! Statements of SCL and charts of GRAPH as statement lists: the typed tree of a bound block, whose names, types and conversions are settled.
//!
//! - `code`: statements, labels and variables that hold values between them.
//! - `place`: places in memory by their names; `address`: those that AR1 points at.
//! - `control`: IF, CASE, loops, jumps; `copy`: whole arrays and structures; `value`: numbers in ACCU1; `shift`: shifts;
//!   `convert`: conversions; `choice`: SEL, MUX …; `logic`: BOOLs in the RLO.
//! - `call`: calls of blocks; `instruction`: those of instructions of an S7-1500; `watch`: ENO of these; `text`: texts and their functions;
//!   `character`: their characters; `number_text`: numbers as texts and back; `moment`: DTL; `cell`: timers and counters.
//! - `position`: where the parts of a statement are in the source, so that comments stay in their branch.
//! - `networks`: networks in SCL among those of LAD and FBD.
//! - `chart`: what charts declare, and what their statements expect.
//!
//! Each statement of a block in SCL is a network, whose title is the first line of the statement.
//!
//! Source: SCL reference, statements and operators; STL reference.

mod address;
mod alias;
mod call;
mod cell;
mod character;
mod chart;
mod choice;
mod code;
mod control;
mod convert;
mod copy;
mod instruction;
mod logic;
mod moment;
mod networks;
mod number_text;
mod place;
mod position;
mod shift;
mod text;
mod turn;
mod value;
mod watch;

use std::collections::{HashMap, HashSet};

use plcc_abi::image::{BlockKind, Family};
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::walk::{self, Role, Visitor};
use plcc_model::scl::{Access, Base, Call, Expr, ExprKind, SclBody, Statement, StatementKind};
use plcc_model::types::{DataType, Elementary};
use plcc_model::{self as model, Body, Direction, LabelId, Passing, Place, Program};
use plcc_syntax::ast::{self, Block, Operand, SourceUnit};
use plcc_syntax::front::Comment;
use plcc_syntax::stl::StlInsn;

use crate::to_stl::constants::with_start_values;
use code::Temporary;
use control::Loop;
use position::Positions;

pub use chart::ChartData;
pub(crate) use networks::does_nothing;
pub use networks::has_statements;

/// A source whose blocks in SCL and GRAPH are STL, and so are the networks in SCL among those of LAD and FBD; the rest stays as it is.
///
/// `program`: bound with plain charts; `text`, `comments`: what the spans of the tree mean; `chart_data`: see [`ChartData`].
pub fn unit(
    unit: &SourceUnit,
    program: &Program,
    (text, comments): (&str, &[Comment]),
    chart_data: ChartData,
) -> (SourceUnit, Vec<Diagnostic>) {
    let mut made = unit.clone();
    let mut messages = Vec::new();
    let mut symbols = Symbols::new();
    for symbol in &program.symbols {
        symbols.entry(symbol.address.replace(' ', "")).or_default().push(symbol);
    }
    for block in &mut made.blocks {
        let Block::Code(tree) = block else { continue };
        if !has_statements(&tree.code) {
            continue;
        }
        // A program of PLCopen XML and the organization block that calls it have one place.
        let kind = match tree.kind {
            ast::CodeKind::Ob => BlockKind::Ob,
            ast::CodeKind::Fc => BlockKind::Fc,
            ast::CodeKind::Fb => BlockKind::Fb,
            ast::CodeKind::Sfc => BlockKind::Sfc,
            ast::CodeKind::Sfb => BlockKind::Sfb,
        };
        let has_number = |bound: &model::CodeBlock| match tree.name {
            ast::BlockName::Numbered { number, .. } => u32::from(bound.number) == number,
            ast::BlockName::Symbol { .. } => true,
        };
        let is_own =
            |bound: &model::CodeBlock| bound.kind == kind && has_number(bound) && bound.span == tree.name.span();
        let bound = program.blocks.iter().find(|block| !block.library && is_own(block));
        let Some((bound, typed)) = bound.and_then(|block| match &block.body {
            Body::Scl(typed) => Some((block, typed)),
            Body::Stl(_) | Body::S7200(_) | Body::Runtime => None,
        }) else {
            messages.push(
                Diagnostic::new(Code::NotConverted, tree.name.span(), "the block is not part of the program")
                    .label("cannot be converted")
                    .help("give the sources of one program, in which each block is defined once"),
            );
            continue;
        };
        let whole;
        let (source, comments) = match &tree.code {
            ast::Code::Chart(chart) => {
                whole = chart::declared(tree, chart, chart_data);
                // They stay together, at the end of the block.
                (&whole, Default::default())
            }
            ast::Code::Scl(_) | ast::Code::Graphic(_) | ast::Code::Stl(_) => (&*tree, comments),
        };
        let positions = Positions::new(text, comments, &networks::lists(&source.code));
        let mut maker = Maker::new((program, &symbols), bound, typed, source, positions);
        let code = maker.code();
        let refused = maker.messages.iter().any(Diagnostic::is_error);
        messages.append(&mut maker.messages);
        // A network that is refused has its message.
        if !refused || matches!(source.code, ast::Code::Graphic(_)) {
            let mut done = source.clone();
            done.code = code;
            maker.declare(&mut done);
            if program.profile.family == Family::S71500 && matches!(done.code, ast::Code::Stl(_)) {
                with_start_values(&mut done);
            }
            *tree = done;
        }
    }
    (made, messages)
}

/// The symbols at each address.
type Symbols<'a> = HashMap<String, Vec<&'a model::Symbol>>;

/// What is made of one block.
struct Maker<'a> {
    program: &'a Program,
    symbols: &'a Symbols<'a>,
    block: &'a model::CodeBlock,
    body: &'a SclBody,
    tree: &'a ast::CodeBlock,
    positions: Positions<'a>,
    statements: Vec<ast::Statement>,
    /// Labels of the next statement.
    pending: Vec<ast::Label>,
    made_labels: usize,
    labels: HashMap<LabelId, String>,
    /// Labels of other networks of the block, by their folded names.
    other_labels: HashSet<String>,
    temporaries: Vec<Temporary>,
    /// What is converted.
    span: Span,
    messages: Vec<Diagnostic>,
    /// The block follows the rules of the TIA Portal.
    is_portal: bool,
    /// The current statement has a message.
    refused: bool,
    /// The block has the message about indices.
    warned_of_indices: bool,
    loops: Vec<Loop>,
    /// The label of the end of the block, if something jumps to it.
    end: Option<String>,
    /// The result of the function until its end.
    result: Option<Operand>,
    /// Inputs of the function that are copies, by parameter.
    copies: HashMap<usize, Operand>,
    /// Errors of the next statement clear the bit of the block.
    watches: bool,
    /// The number of the character whose address comes next.
    known_index: Option<Operand>,
    /// Variables of the typed tree that no source declares, by their first bit in the frame.
    hidden: HashMap<u32, (Operand, Elementary)>,
    /// OK or ENO of the block.
    flag: Option<Operand>,
    /// ENO of the last call.
    last_eno: Option<Operand>,
}

impl<'a> Maker<'a> {
    fn new(
        (program, symbols): (&'a Program, &'a Symbols<'a>),
        block: &'a model::CodeBlock,
        body: &'a SclBody,
        tree: &'a ast::CodeBlock,
        positions: Positions<'a>,
    ) -> Maker<'a> {
        Maker {
            program,
            symbols,
            block,
            body,
            tree,
            positions,
            statements: Vec::new(),
            pending: Vec::new(),
            made_labels: 0,
            labels: HashMap::new(),
            other_labels: HashSet::new(),
            temporaries: Vec::new(),
            span: tree.name.span(),
            messages: Vec::new(),
            is_portal: chart::is_of_portal(&tree.code),
            refused: false,
            warned_of_indices: false,
            loops: Vec::new(),
            end: None,
            result: None,
            copies: HashMap::new(),
            watches: false,
            known_index: None,
            hidden: HashMap::new(),
            flag: None,
            last_eno: None,
        }
    }

    /// The code of the block without statements of SCL.
    fn code(&mut self) -> ast::Code {
        let tree = self.tree;
        match &tree.code {
            ast::Code::Graphic(body) => ast::Code::Graphic(self.among_networks(body)),
            ast::Code::Scl(_) | ast::Code::Stl(_) | ast::Code::Chart(_) => ast::Code::Stl(self.networks()),
        }
    }

    fn networks(&mut self) -> Vec<ast::Network> {
        self.check_block();
        let mut networks = Vec::new();
        self.begin();
        self.close_network(&mut networks, None, Vec::new());
        let statements = &self.body.statements;
        let is_chart = self.is_chart();
        let mut before = self.positions.code_start(self.tree);
        let is_one =
            |a: &Statement, b: &Statement| a.span.start == b.span.start && (!is_chart || chart::belong_together(a, b));
        for group in statements.chunk_by(is_one) {
            let span = group[0].span;
            self.go_to(span);
            group.iter().for_each(|statement| self.statement(statement));
            let comment = self.positions.comment_before(before, span.start);
            let title = match is_chart {
                true => self.title_in_chart(span),
                false => Some(self.positions.first_line(span)),
            };
            self.close_network(&mut networks, title, comment);
            before = span.end;
        }
        self.finish();
        self.close_network(&mut networks, None, Vec::new());
        if is_chart {
            self.span = self.tree.name.span();
            networks.insert(0, self.start_values());
        }
        networks
    }

    fn close_network(&mut self, networks: &mut Vec<ast::Network>, title: Option<String>, comment: Vec<String>) {
        let statements = std::mem::take(&mut self.statements);
        if !statements.is_empty() {
            networks.push(ast::Network { title, comment, statements });
        }
    }

    /// The CPU must have STL.
    fn check_cpu(&mut self) {
        if self.program.profile.family == Family::S71200 {
            let span = self.tree.name.span();
            self.refuse(span, "a block of an S7-1200, which has no STL", "name a CPU that has it: `--cpu s7-1500`");
        }
    }

    /// What holds for the whole block.
    fn check_block(&mut self) {
        self.check_cpu();
        let span = self.tree.name.span();
        if self.body.sets_flag {
            self.refuse_flag();
        }
        let value = self.tree.return_type.as_ref().map(|ty| &ty.kind);
        if matches!(value, Some(ast::TypeKind::String(Some(_)) | ast::TypeKind::WideString(Some(_)))) {
            let help = "declare the value of the function without a length, or return the text by an output";
            self.refuse(span, "a function whose value is a text with a length", help);
        }
        self.check_chart();
        self.refused = false;
    }

    /// Refuses a block whose OK or ENO follows the errors of its operations.
    fn refuse_flag(&mut self) {
        let help = "leave out the attribute that sets OK or ENO, and do not read OK or ENO";
        self.refuse(self.tree.name.span(), "OK and ENO that follow the errors of operations", help);
    }

    /// Variables that hold for the whole block, and what they start with.
    fn begin(&mut self) {
        let uses = Uses::of(self.block, self.body);
        self.copy_inputs(&uses);
        let is_fc = matches!(self.block.kind, BlockKind::Fc | BlockKind::Sfc);
        let is_result = |formal: &&model::Parameter| {
            formal.direction == Direction::Output
                && formal.name == "RET_VAL"
                && matches!(formal.passing, Passing::Elementary(_))
        };
        let result = self.block.interface.parameters.iter().find(is_result);
        if let Some(DataType::Elementary(ty)) = result.filter(|_| is_fc && !uses.sets_result_last).map(|one| &one.ty) {
            self.result = Some(self.kept(*ty, "result"));
        }
        self.begin_texts();
        if uses.flag {
            let flag = self.kept(Elementary::Bool, "ok");
            self.push(StlInsn::SetRlo, None);
            self.push(StlInsn::Assign, Some(flag.clone()));
            self.flag = Some(flag);
        }
        if uses.last_eno {
            let eno = self.kept(Elementary::Bool, "last_eno");
            self.push(StlInsn::SetRlo, None);
            self.push(StlInsn::Assign, Some(eno.clone()));
            self.last_eno = Some(eno);
        }
    }

    /// Lets a function copy those elementary inputs that may change while it runs.
    fn copy_inputs(&mut self, uses: &Uses) {
        let is_fc = matches!(self.block.kind, BlockKind::Fc | BlockKind::Sfc);
        for (index, parameter) in self.block.interface.parameters.iter().enumerate().filter(|_| is_fc) {
            let (DataType::Elementary(ty), Passing::Elementary(_)) = (&parameter.ty, parameter.passing) else {
                continue;
            };
            let changes = uses.copies_inputs && uses.read.contains(&index);
            let has_parts = uses.parts.contains(&index) && !self.has_parts();
            if parameter.direction == Direction::Input && (changes || has_parts) {
                let copy = self.kept(*ty, &parameter.name);
                let own = self.parameter(index);
                self.load_and_store(*ty, own, copy.clone());
                self.copies.insert(index, copy);
            }
        }
    }

    /// The result, and ENO as the BR.
    fn finish(&mut self) {
        self.span = self.positions.end_of(self.tree);
        if let Some(end) = self.end.take() {
            self.label(&end, self.span.start);
        }
        if let Some(result) = self.result.take() {
            let found = self.block.interface.parameters.iter().position(|parameter| parameter.name == "RET_VAL");
            let index = found.expect("the result is a parameter");
            if let DataType::Elementary(ty) = self.block.interface.parameters[index].ty {
                let own = self.parameter(index);
                self.load_and_store(ty, result, own);
            }
        }
        if self.block.kind != BlockKind::Ob {
            match self.flag.clone() {
                Some(flag) => self.push(StlInsn::And, Some(flag)),
                None => self.push(StlInsn::SetRlo, None),
            }
            self.push(StlInsn::Save, None);
        }
        self.close_labels();
    }

    fn load_and_store(&mut self, ty: Elementary, from: Operand, to: Operand) {
        let (load, store) = match ty {
            Elementary::Bool => (StlInsn::And, StlInsn::Assign),
            _ => (StlInsn::Load, StlInsn::Transfer),
        };
        self.push(load, Some(from));
        self.push(store, Some(to));
    }

    /// STL cannot say it; one message for a statement. Parts of a chart are in several statements.
    fn refuse(&mut self, span: Span, what: impl std::fmt::Display, help: &str) {
        if std::mem::replace(&mut self.refused, true) {
            return;
        }
        let message = Diagnostic::new(Code::NotConverted, span, format!("STL has no form for {what}"));
        let is_same = |known: &Diagnostic| known.primary.span == span && known.title == message.title;
        if !self.messages.iter().any(is_same) {
            self.messages.push(message.label("cannot be converted").help(help));
        }
    }
}

/// How a block uses its parameters and hidden bits.
struct Uses {
    /// Inputs may be other than at the start of the block, unless they are copies.
    copies_inputs: bool,
    /// Parameters that are read.
    read: Vec<usize>,
    /// Parameters of which a part is used.
    parts: Vec<usize>,
    /// The result is only assigned, by the last statement.
    sets_result_last: bool,
    flag: bool,
    last_eno: bool,
}

impl Uses {
    fn of(block: &model::CodeBlock, body: &SclBody) -> Uses {
        let mut seen = Seen::default();
        walk::statements(&body.statements, &mut seen);
        let result = block.interface.parameters.iter().position(|parameter| parameter.name == "RET_VAL");
        let is_result = |access: &Access| matches!(access.base, Base::Place(Place::Parameter { parameter, .. }) if Some(parameter) == result);
        let last = body.statements.last().map(|statement| &statement.kind);
        let of_result = seen.accesses.iter().filter(|(base, _)| Some(*base) == result).count();
        let sets_result_last =
            of_result == 1 && matches!(last, Some(StatementKind::Assign { target, .. }) if is_result(target));
        // The result goes to the caller at the end, so only other writes outside of the frame may change an input.
        let others = seen.writes.iter().filter(|written| written.is_none() || **written != result).count();
        let last_is_other =
            matches!(last, Some(StatementKind::Assign { target, .. }) if !is_result(target) && is_outside(target));
        Uses {
            copies_inputs: seen.calls || (others > 0 && !(others == 1 && last_is_other)),
            read: seen.accesses.iter().map(|(parameter, _)| *parameter).collect(),
            parts: seen.parts,
            sets_result_last,
            flag: seen.flag,
            last_eno: seen.last_eno,
        }
    }
}

/// It is not in the frame of the block.
fn is_outside(target: &Access) -> bool {
    !matches!(target.base, Base::Place(Place::L { .. }))
}

#[derive(Default)]
struct Seen {
    /// Parameters, as often as they are used.
    accesses: Vec<(usize, Role)>,
    /// Those of which a part is used.
    parts: Vec<usize>,
    /// Assignments to something that is not in the frame, with the parameter if it is one.
    writes: Vec<Option<usize>>,
    calls: bool,
    flag: bool,
    last_eno: bool,
}

impl Visitor for Seen {
    fn statement(&mut self, statement: &model::scl::Statement) {
        self.flag |= matches!(statement.kind, StatementKind::SetFlag(_) | StatementKind::Return(Some(_)));
        let Some(target) = statement.kind.target() else { return };
        if is_outside(target) {
            self.writes.push(match target.base {
                Base::Place(Place::Parameter { parameter, .. }) => Some(parameter),
                _ => None,
            });
        }
    }

    fn expr(&mut self, value: &Expr) {
        match value.kind {
            ExprKind::Flag => self.flag = true,
            ExprKind::LastEno => self.last_eno = true,
            // They write outputs of their own.
            ExprKind::Timer(_) | ExprKind::Counter(_) => self.calls = true,
            ExprKind::Const(_)
            | ExprKind::Load(_)
            | ExprKind::Unary { .. }
            | ExprKind::Binary { .. }
            | ExprKind::Compare { .. }
            | ExprKind::Convert { .. }
            | ExprKind::Call(_)
            | ExprKind::Function { .. }
            | ExprKind::Cell { .. }
            | ExprKind::Bound { .. } => {}
        }
    }

    fn access(&mut self, access: &Access, role: Role) {
        if let Base::Place(Place::Parameter { parameter, .. }) = access.base {
            self.accesses.push((parameter, role));
            self.parts.extend(access.part.map(|_| parameter));
        }
    }

    fn call(&mut self, _call: &Call) {
        self.calls = true;
    }
}
