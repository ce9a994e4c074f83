//! Binding of networks in LAD and FBD: element by element to the typed tree of SCL, so that all languages share one lowering.
//!

//! - `sheet`: the network that is being bound: values of nets, hidden variables, statements so far.
//! - `pins`: what comes in at pins and goes out of them; EN and ENO.
//! - `bits`, `compare`, `math`, `moves`, `convert`, `calls`, `control`, `classic`: the elements, by the kinds of the table.
//! - `stl`: networks in STL between the others.
//! - `legality`: which networks are valid.
//!
//! Source: LAD/FBD reference, chapters A.11, C and E.2.

mod bits;
mod calls;
mod classic;
mod compare;
mod control;
mod convert;
mod legality;
mod math;
mod moves;

mod pins;
mod sheet;
mod stl;

pub use pins::{and, inverted, no, yes};
pub use sheet::Hidden;

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast;
use plcc_syntax::network::ast::{Body as Networks, Content, Graph, Network, Target};
use plcc_syntax::network::draw::draw;
use plcc_syntax::network::elements::Kind;
use plcc_syntax::network::order::order;
use plcc_syntax::scl::ast::Dialect;

use super::scl::expression::constant_expr;
use super::scl::temporary;
use super::scl::{Rules, Scope};
use crate::bind::declarations::Declarations;
use crate::bind::declarations::block::CurrentBlock;
use crate::bind::scl::{SclBinder, SclBlock, marks_locals};
use crate::bind::stl::StlBinder;
use crate::bind::trees::cpu::needs_registers;
use crate::bind::trees::mentions;
use classic::Registers;
use plcc_model::scl::{Expr, ExprKind, SclBody, Statement, StatementKind};
use rustc_hash::FxHashSet;
use sheet::{Pool, Sheet};

/// Data that the networks of a block share.
pub struct Page {
    pub pool: Pool,
    /// ENO of the block so far, a BOOL; none if nothing but RET sets it.
    eno: Option<sheet::Hidden>,
    pub registers: Registers,
    /// The result at the coil of a condition in GRAPH; none outside of GRAPH.
    pub condition: Option<Option<Expr>>,
    /// The first element that could not be bound.
    failed: Option<Span>,
}

impl Page {
    pub fn new(ctx: &mut SclBlock) -> Page {
        Page { pool: Pool::new(ctx), eno: None, registers: Registers::default(), condition: None, failed: None }
    }

    /// A hidden variable, until the next network begins.
    pub fn hidden(&mut self, ctx: &mut SclBlock, ty: Elementary) -> Hidden {
        self.pool.take(ctx, ty, sheet::Use::Value)
    }
}

/// Limit of messages of one network that have a drawing: more would not help, and drawing takes time in large networks.
const DRAWINGS_MAX: usize = 50;

/// Binds networks of LAD and FBD.
pub struct NetworkBinder<'b, 'a> {
    program: &'b mut Declarations<'a>,
}

impl<'b, 'a> NetworkBinder<'b, 'a> {
    pub fn new(program: &'b mut Declarations<'a>) -> NetworkBinder<'b, 'a> {
        NetworkBinder { program }
    }

    /// STL, for networks that are written in it.
    fn stl(&mut self) -> StlBinder<'_, 'a> {
        StlBinder::new(self.program)
    }

    /// SCL, whose expressions elements become.
    fn scl(&mut self) -> SclBinder<'_, 'a> {
        SclBinder::new(self.program)
    }
}

impl NetworkBinder<'_, '_> {
    /// Binds the networks of a block.
    pub fn bind_block(&mut self, current: &mut CurrentBlock, block: &ast::CodeBlock, networks: &Networks) -> SclBody {
        let scope = Scope::new(self.program.globals.input, &block.header, Dialect::Tia);
        let sets_eno = scope.sets_flag;
        let ctx = &mut SclBlock { block: current, scope };
        // Boxes report their errors through ENO.
        ctx.scope.sets_flag = true;
        ctx.scope.marks_locals = marks_locals(&block.code);
        ctx.scope.untyped = Some(FxHashSet::default());
        ctx.scope.lists = vec![TOP];
        self.collect_network_labels(ctx, &networks.networks);
        let span = ctx.block.fixed_span.unwrap_or(block.name.span());
        let mut page = Page::new(ctx);
        let mut statements = Vec::new();
        self.begin_registers(ctx, &mut page, networks, span, &mut statements);
        self.begin_eno(ctx, &mut page, networks, span, &mut statements);
        for (number, network) in networks.networks.iter().enumerate() {
            self.bind_network(ctx, &mut page, network, number as u16 + 1, &mut statements);
        }
        // In SIMATIC SD a block in SCL has networks, too.
        let is_scl = networks.networks.iter().all(|network| matches!(network.content, Content::Scl(_)));
        let eno = match &page.eno {
            Some(eno) => Some(eno.load(span)),
            // Its errors have set it (`S7_SetENOAutomatically`).
            None if is_scl && sets_eno => None,
            None => Some(constant_expr(1, Elementary::Bool, span)),
        };
        statements.extend(eno.map(|eno| Statement { kind: StatementKind::SetFlag(eno), span }));
        for warning in legality::block_warnings(networks) {
            self.program.report(warning);
        }
        // All others have a message; this one is for elements that none of the checks found.
        if let Some(span) = page.failed
            && self.program.globals.report.is_clean()
        {
            self.not_bound(span);
        }
        self.scl().unused_data(ctx, block, networks.networks.is_empty());
        SclBody {
            statements,
            sets_flag: true,
            calls_set_flag: true,
            temporary_texts: temporary::texts(&ctx.block.bound),
            networks: networks.networks.iter().map(|network| network.span.start).collect(),
            inputs_in_place: ctx.scope.rules.is_300() && !is_scl,
            named_dbs: std::mem::take(&mut ctx.scope.named_dbs),
        }
    }

    /// ENO of the block is stored separately where SCL networks set it, and on an S7-300/400, where it is the BR that boxes and SAVE change.
    fn begin_eno(
        &mut self,
        ctx: &mut SclBlock,
        page: &mut Page,
        networks: &Networks,
        span: Span,
        statements: &mut Vec<Statement>,
    ) {
        let scl = networks
            .networks
            .iter()
            .any(|network| matches!(&network.content, Content::Scl(list) if mentions::names_eno(list)));
        let saves = |network: &Network| match &network.content {
            Content::Graphic(graph) => graph
                .elements
                .iter()
                .any(|element| matches!(&element.target, Target::Element { row, .. } if row.kind == Kind::Save)),
            Content::Scl(_) | Content::Stl(_) => false,
        };
        if !scl && !has_br(ctx.scope.rules) && !networks.networks.iter().any(saves) {
            return;
        }
        let eno = page.pool.lasting(ctx, Elementary::Bool);
        statements.push(eno.set(constant_expr(1, Elementary::Bool, span), span));
        page.eno = Some(eno);
    }

    /// Binds a network of a chart, which is independent of others.
    pub(in crate::bind) fn bind_lone_network(
        &mut self,
        ctx: &mut SclBlock,
        page: &mut Page,
        network: &Network,
    ) -> Vec<Statement> {
        self.collect_network_labels(ctx, std::slice::from_ref(network));
        let mut statements = Vec::new();
        ctx.scope.lists.push(TOP);
        self.bind_network(ctx, page, network, 1, &mut statements);
        ctx.scope.lists.pop();
        if let Some(span) = page.failed.take()
            && self.program.globals.report.is_clean()
        {
            self.not_bound(span);
        }
        statements
    }

    fn bind_network(
        &mut self,
        ctx: &mut SclBlock,
        page: &mut Page,
        network: &Network,
        number: u16,
        statements: &mut Vec<Statement>,
    ) {
        page.pool.next_network();
        for label in &network.labels {
            if let Some(id) = self.scl().label(ctx, label) {
                statements.push(Statement { kind: StatementKind::Label(id), span: label.span });
            }
        }
        match &network.content {
            Content::Graphic(graph) => statements.extend(self.bind_graph(ctx, page, network, graph)),
            Content::Scl(list) => {
                // Without the word ENO, nothing in it changes ENO of the block.
                let eno = page.eno.as_ref().filter(|_| mentions::names_eno(list));
                if let Some(eno) = eno {
                    let kind = StatementKind::SetFlag(eno.load(network.span));
                    statements.push(Statement { kind, span: network.span });
                }
                ctx.scope.in_scl = true;
                statements.extend(self.scl().statements(ctx, list));
                ctx.scope.in_scl = false;
                if let Some(eno) = eno {
                    let flag = Expr { kind: ExprKind::Flag, ty: Elementary::Bool, span: network.span };
                    statements.push(eno.set(flag, network.span));
                }
            }
            Content::Stl(list) => self.bind_stl_network(ctx, list, number, statements),
        }
    }

    fn bind_graph(&mut self, ctx: &mut SclBlock, page: &mut Page, network: &Network, graph: &Graph) -> Vec<Statement> {
        let (first, failed) = (self.program.globals.report.diagnostics.len(), page.failed);
        let mut messages = Vec::new();
        if !graph.broken {
            legality::legality(network, &mut messages);
        }
        let legal = !graph.broken && !messages.iter().any(Diagnostic::is_error);
        messages.into_iter().for_each(|message| self.program.report(message));
        let mut sheet = Sheet::new(page, graph);
        let mut drawn = 0;
        for element in order(graph) {
            let before = self.program.globals.report.diagnostics.len();
            if self.bind_element(ctx, &mut sheet, element).is_none() && !graph.broken {
                sheet.page.failed.get_or_insert(graph.elements[element].span);
            }
            if !legal {
                // Only messages that do not follow from the shape of the network.
                let found = self.program.globals.report.diagnostics.split_off(before);
                self.program
                    .globals
                    .report
                    .diagnostics
                    .extend(found.into_iter().filter(|message| is_about_names(message.code)));
            }
            for message in &mut self.program.globals.report.diagnostics[before..] {
                if message.note.is_none() && drawn < DRAWINGS_MAX {
                    drawn += 1;
                    message.note = Some(draw(network, Some(element)));
                }
            }
        }
        let statements = sheet.statements;
        if self.program.globals.input.partial && self.is_unfinished(graph, first) {
            page.failed = failed;
            return Vec::new();
        }
        statements
    }

    /// Whether a network lacks something that its drawing must have, as drafts do: part of a program with drafts can still be checked,
    /// and messages about the network since message `first` become warnings. The network then does nothing.
    fn is_unfinished(&mut self, graph: &Graph, first: usize) -> bool {
        let mut unfinished = graph.broken;
        for message in &mut self.program.globals.report.diagnostics[first..] {
            if message.is_error() && is_about_drafts(message.code) {
                unfinished = true;
                message.severity = Severity::Warning;
                if let Some(help) = &mut message.help {
                    help.push_str("; until then the network does nothing");
                }
            }
        }
        unfinished
    }

    /// An incomplete element that no message reports.
    fn not_bound(&mut self, span: Span) {
        let text = self.program.globals.text(span);
        self.program.report(
            Diagnostic::new(Code::MissingOperand, span, format!("`{text}` {NOT_CONNECTED}"))
                .label("a pin has no operand and no wire")
                .help("connect all its inputs"),
        );
    }

    fn bind_element(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        let element = sheet.element(at);
        let row = match &element.target {
            Target::Block { .. } => return self.block_box(ctx, sheet, at),
            Target::Element { row, .. } => *row,
        };
        if !has_br(ctx.scope.rules) && needs_registers(row.kind) {
            self.scl().refuse(
                Code::UnknownElement,
                element.span,
                &format!("`{}` is an element of the S7-300 and S7-400", row.name),
                "this CPU does not have it",
                "write the network without it, or name another CPU with --cpu",
            );
            return None;
        }
        if matches!(
            row.kind,
            Kind::Compare(_) | Kind::Range { .. } | Kind::Operator(_) | Kind::Step { .. } | Kind::Negate
        ) {
            self.check_templates(sheet.element(at));
        }
        match row.kind {
            Kind::Contact => self.contact(ctx, sheet, at),
            Kind::Not => self.not_element(ctx, sheet, at),
            Kind::Gate(gate) => self.gate(ctx, sheet, at, gate),
            Kind::EdgeContact { rising } => self.edge_contact(ctx, sheet, at, rising),
            Kind::EdgeTrigger { rising } => self.edge_trigger(ctx, sheet, at, rising),
            Kind::Coil => self.coil(ctx, sheet, at),
            Kind::SetCoil => self.set_coil(ctx, sheet, at, true),
            Kind::ResetCoil => self.set_coil(ctx, sheet, at, false),
            Kind::EdgeCoil { rising } => self.edge_coil(ctx, sheet, at, rising),
            Kind::BitField { set } => self.bit_field(ctx, sheet, at, set),
            Kind::FlipFlop { set_wins } => self.flip_flop(ctx, sheet, at, set_wins),
            Kind::Compare(op) => self.compare_contact(ctx, sheet, at, op),
            Kind::Range { inside } => self.range_contact(ctx, sheet, at, inside),
            Kind::Valid { valid } => self.valid_contact(ctx, sheet, at, valid),
            Kind::Variant(question) => self.variant_contact(ctx, sheet, at, question),
            Kind::Instance(name) => self.instance_box(ctx, sheet, at, name),
            Kind::TimerCoil(name) => self.timer_coil(ctx, sheet, at, name),
            Kind::ResetTimer => self.reset_timer_coil(ctx, sheet, at),
            Kind::PresetTimer => self.preset_timer_coil(ctx, sheet, at),
            Kind::Calculate => self.calculate_box(ctx, sheet, at),
            Kind::Formula => self.formula_box(ctx, sheet, at),
            Kind::Operator(op) => self.operator_box(ctx, sheet, at, op),
            Kind::Step { up } => self.step_box(ctx, sheet, at, up),
            Kind::Function(name) => self.function_box(ctx, sheet, at, name),
            Kind::Procedure(name) => self.procedure_box(ctx, sheet, at, name),
            Kind::Move => self.move_box(ctx, sheet, at),
            Kind::Convert => self.convert_box(ctx, sheet, at),
            Kind::Round(name) => self.round_box(ctx, sheet, at, name),
            Kind::Negate => self.unary_box(ctx, sheet, at, true),
            Kind::Invert => self.unary_box(ctx, sheet, at, false),
            Kind::Mux => self.mux_box(ctx, sheet, at),
            Kind::Demux => self.demux_box(ctx, sheet, at),
            Kind::Jump { negated } => self.jump_coil(ctx, sheet, at, negated),
            Kind::JumpList => self.jump_list_box(ctx, sheet, at),
            Kind::Switch => self.switch_box(ctx, sheet, at),
            Kind::Return(value) => self.return_coil(ctx, sheet, at, value),
            Kind::S5Timer(name) => self.s5_timer_box(ctx, sheet, at, name),
            Kind::S5Counter(name) => self.s5_counter_box(ctx, sheet, at, name),
            Kind::CounterCoil(coil) => self.counter_coil(ctx, sheet, at, coil),
            Kind::OpenDb { di } => self.open_db(ctx, sheet, at, di),
            Kind::Mcr(coil) => self.mcr_coil(ctx, sheet, at, coil),
            Kind::CallCoil => self.call_coil(ctx, sheet, at),
            Kind::Save => self.save_coil(ctx, sheet, at),
            Kind::Condition => self.condition_coil(ctx, sheet, at),
            Kind::Flag(flag) => self.flag_contact(ctx, sheet, at, flag),
        }
    }
}

/// True of a message about a name that is not defined.
fn is_about_names(code: Code) -> bool {
    matches!(
        code,
        Code::UnknownSymbol
            | Code::UnknownBlock
            | Code::UnknownLocal
            | Code::UnknownMember
            | Code::UnknownLabel
            | Code::NotShipped
    )
}

/// How the title ends of the message about an element that could not be bound, if nothing else is wrong in the program.
pub const NOT_CONNECTED: &str = "is not connected as it must be";

/// True of a message about something that has not been drawn yet.
pub const fn is_about_drafts(code: Code) -> bool {
    matches!(
        code,
        Code::MissingOperand
            | Code::MissingParameter
            | Code::OpenBranch
            | Code::NoSource
            | Code::GateInputs
            | Code::ElementPlace
    )
}

/// The list of statements of a block of networks, as labels refer to it.
const TOP: usize = 0;

/// ENO of a block is the BR of the status word.
fn has_br(rules: Rules) -> bool {
    rules.is_300()
}
