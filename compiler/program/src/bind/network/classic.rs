//! Elements of the S7-300/400: S5 timers and counters, open data blocks, the Master Control Relay, the status word.
//!
//! The typed tree has no such registers; a block that uses them keeps them in hidden variables. Source: LAD/FBD reference B.10, C.22.

use plcc_diag::{Code, Span};
use plcc_syntax::Elementary;
use plcc_syntax::network::ast::{Body as Networks, Content, Target};
use plcc_syntax::network::elements::{CounterCoil, Flag, Kind, Mcr};
use plcc_syntax::scl::ast::{
    Argument, Expr as Node, ExprKind as NodeKind, Statement as Tree, StatementKind as TreeKind,
};

use super::Page;
use super::bits::{argument, call_node};
use super::pins::{and, connected, inverted, no, or, outputs, yes};
use super::sheet::{Hidden, Sheet};
use crate::bind::network::NetworkBinder;
use crate::bind::scl::convert::converted;
use crate::bind::scl::expression::{binary_expr, constant_expr};
use crate::bind::scl::place::{Db, Thing};
use crate::bind::scl::value::Value;
use crate::bind::scl::{Intent, SclBlock};
use plcc_model::Width;
use plcc_model::scl::{BinaryOp, CompareOp, Conversion, Expr, ExprKind, Part, Statement, StatementKind};

/// Limit of nested MCR zones.
const MCR_DEPTH: usize = 8;

/// Registers of the CPU that a block uses.
#[derive(Default)]
pub struct Registers {
    relay: Option<Relay>,
    db: Option<(Hidden, Hidden)>,
    status: Option<Status>,
    /// Zones that are open at the current element.
    zones: usize,
}

/// The Master Control Relay.
struct Relay {
    /// Between MCRA and MCRD.
    active: Hidden,
    /// A WORD: bit 0 is the current zone, the next bits are those around it.
    zones: Hidden,
}

/// Status bits that contacts read.
struct Status {
    ov: Hidden,
    os: Hidden,
    /// CC1 and CC0 as a DINT: -1, 0 or 1 for the last result compared with 0; 2 if unordered.
    sign: Hidden,
}

impl Registers {
    /// Whether coils have power; none if the block has no relay.
    pub fn relay(&self, span: Span) -> Option<Expr> {
        let relay = self.relay.as_ref()?;
        let mut zone = relay.zones.access(span);
        zone.part = Some(Part { width: Width::Bit, index: 0 });
        let on = Expr { kind: ExprKind::Load(Box::new(zone)), ty: Elementary::Bool, span };
        Some(or(inverted(relay.active.load(span)), on, span))
    }

    /// Contacts read the status word.
    pub fn has_status(&self) -> bool {
        self.status.is_some()
    }
}

impl NetworkBinder<'_, '_> {
    /// Hidden variables for the registers that the networks use.
    pub fn begin_registers(
        &mut self,
        ctx: &mut SclBlock,
        page: &mut Page,
        networks: &Networks,
        span: Span,
        statements: &mut Vec<Statement>,
    ) {
        let kinds = || {
            networks.networks.iter().filter_map(|network| match &network.content {
                Content::Graphic(graph) => Some(&graph.elements),
                Content::Scl(_) | Content::Stl(_) => None,
            })
        };
        let has = |wanted: fn(&Kind) -> bool| {
            kinds().flatten().any(|element| matches!(&element.target, Target::Element { row, .. } if wanted(&row.kind)))
        };
        let mut variable = |ty: Elementary, bits: u64, page: &mut Page| {
            let hidden = page.pool.lasting(ctx, ty);
            statements.push(hidden.set(constant_expr(bits, ty, span), span));
            hidden
        };
        if has(|kind| matches!(kind, Kind::Mcr(_))) {
            let active = variable(Elementary::Bool, 0, page);
            let zones = variable(Elementary::Word, 0xFFFF, page);
            page.registers.relay = Some(Relay { active, zones });
        }
        if has(|kind| matches!(kind, Kind::Flag(_))) {
            let (ov, os) = (variable(Elementary::Bool, 0, page), variable(Elementary::Bool, 0, page));
            let sign = variable(Elementary::Dint, 0, page);
            page.registers.status = Some(Status { ov, os, sign });
        }
        if has(|kind| matches!(kind, Kind::OpenDb { .. })) {
            let db = variable(Elementary::Word, 0, page);
            let di = variable(Elementary::Word, 0, page);
            page.registers.db = Some((db, di));
        }
        if let Some((db, di)) = &page.registers.db {
            ctx.scope.open_db = Some(db.load(span));
            ctx.scope.open_di = Some(di.load(span));
        }
    }

    /// A value as the relay passes it on: 0 while the relay is off.
    pub fn relayed_value(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, value: Expr, on: Expr) -> Expr {
        let (ty, span) = (value.ty, value.span);
        let hidden = sheet.hidden(ctx, ty);
        sheet.statements.push(hidden.set(constant_expr(0, ty, span), span));
        self.conditional(sheet, on, StatementKind::Assign { target: hidden.access(span), value }, span);
        hidden.load(span)
    }

    /// Statements that update the status word with a result.
    pub fn note_result(&self, sheet: &Sheet, result: &Expr) -> Vec<Statement> {
        let Some(status) = &sheet.page.registers.status else { return Vec::new() };
        let (ty, span) = (result.ty, result.span);
        let flag = Expr { kind: ExprKind::Flag, ty: Elementary::Bool, span };
        let mut statements = vec![
            status.ov.set(inverted(flag), span),
            status.os.set(or(status.os.load(span), status.ov.load(span), span), span),
        ];
        if ty.is_integer() || ty.is_float() {
            let against = |op| Expr {
                kind: ExprKind::Compare {
                    op,
                    left: Box::new(result.clone()),
                    right: Box::new(constant_expr(0, ty, span)),
                },
                ty: Elementary::Bool,
                span,
            };
            let sign = |value: i32| {
                vec![status.sign.set(constant_expr(u64::from(value as u32), Elementary::Dint, span), span)]
            };
            let branches = vec![
                (against(CompareOp::Less), sign(-1)),
                (against(CompareOp::Greater), sign(1)),
                (against(CompareOp::Equal), sign(0)),
            ];
            statements.push(Statement { kind: StatementKind::If { branches, otherwise: sign(2) }, span });
        }
        statements
    }

    /// A contact of the status word.
    pub fn flag_contact(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, flag: Flag) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let flow = self.flow(ctx, sheet, at, "pre")?;
        let status = sheet.page.registers.status.as_ref()?;
        let sign = |op, value: i32| Expr {
            kind: ExprKind::Compare {
                op,
                left: Box::new(status.sign.load(span)),
                right: Box::new(constant_expr(u64::from(value as u32), Elementary::Dint, span)),
            },
            ty: Elementary::Bool,
            span,
        };
        let ordered = || sign(CompareOp::NotEqual, 2);
        let value = match flag {
            Flag::Ov => status.ov.load(span),
            Flag::Os => status.os.load(span),
            Flag::Uo => sign(CompareOp::Equal, 2),
            Flag::Br => match &sheet.page.eno {
                Some(eno) => eno.load(span),
                None => yes(span),
            },
            Flag::Equal => sign(CompareOp::Equal, 0),
            Flag::NotEqual => and(sign(CompareOp::NotEqual, 0), ordered(), span),
            Flag::Greater => sign(CompareOp::Equal, 1),
            Flag::Less => sign(CompareOp::Equal, -1),
            Flag::GreaterEqual => and(sign(CompareOp::GreaterEqual, 0), ordered(), span),
            Flag::LessEqual => sign(CompareOp::LessEqual, 0),
        };
        // The normally closed contact has its operand pin negated.
        let negated = element.pin("operand").is_some_and(|pin| pin.negated);
        let value = if negated { inverted(value) } else { value };
        self.output(ctx, sheet, at, "out", Value::Elementary(and(flow, value, span)))
    }

    /// MCRA, MCR<, MCR>, MCRD.
    pub fn mcr_coil(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, coil: Mcr) -> Option<()> {
        let span = sheet.element(at).span;
        let flow = self.flow(ctx, sheet, at, "in")?;
        let registers = &mut sheet.page.registers;
        let relay = registers.relay.as_ref()?;
        let word = |op, left: Expr, right: Expr| binary_expr(op, left, right, Elementary::Word, span);
        let one = || constant_expr(1, Elementary::Int, span);
        let statement = match coil {
            Mcr::Activate => relay.active.set(yes(span), span),
            Mcr::Deactivate => relay.active.set(no(span), span),
            Mcr::Open => {
                registers.zones += 1;
                let mut top = relay.zones.access(span);
                top.part = Some(Part { width: Width::Bit, index: 0 });
                let around = Expr { kind: ExprKind::Load(Box::new(top)), ty: Elementary::Bool, span };
                let zone = converted(and(flow, around, span), Conversion::Bits { checked: false }, Elementary::Word);
                let shifted = word(BinaryOp::ShiftLeft, relay.zones.load(span), one());
                relay.zones.set(word(BinaryOp::Or, shifted, zone), span)
            }
            Mcr::Close => {
                let Some(left) = registers.zones.checked_sub(1) else {
                    self.scl().refuse(
                        Code::ElementPlace,
                        span,
                        "MCR> closes no zone",
                        "there is no MCR< before it",
                        "remove it, or open the zone",
                    );
                    return None;
                };
                registers.zones = left;
                let shifted = word(BinaryOp::ShiftRight, relay.zones.load(span), one());
                relay.zones.set(word(BinaryOp::Or, shifted, constant_expr(0x8000, Elementary::Word, span)), span)
            }
        };
        let depth = registers.zones;
        sheet.statements.push(statement);
        if depth > MCR_DEPTH {
            self.scl().refuse(
                Code::ElementPlace,
                span,
                "more than 8 nested MCR zones",
                "the ninth one",
                "close a zone first",
            );
            return None;
        }
        Some(())
    }

    /// SAVE: writes the flow to BR, which is ENO of the block.
    pub fn save_coil(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        let span = sheet.element(at).span;
        let flow = self.flow(ctx, sheet, at, "in")?;
        let flow = sheet.keep(ctx, flow);
        if let Some(eno) = &sheet.page.eno {
            let statement = eno.set(flow.clone(), span);
            sheet.statements.push(statement);
        }
        self.output(ctx, sheet, at, "out", Value::Elementary(flow))
    }

    /// OPN.
    pub fn open_db(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, di: bool) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let flow = self.flow(ctx, sheet, at, "in")?;
        let node = self.operand_node(element, "operand")?;
        let Some(Thing::Db { db, .. }) = self.scl().thing(ctx, &node, Intent::Read) else {
            self.scl().refuse(
                Code::OperandKind,
                node.span,
                "OPN opens data blocks",
                "this is not a data block",
                "name one: DB10",
            );
            return None;
        };
        let number = match db {
            Db::Known(number) => constant_expr(u64::from(number), Elementary::Word, span),
            Db::Dynamic(expr) => expr,
        };
        let (db, other) = sheet.page.registers.db.as_ref()?;
        let target = if di { other } else { db };
        let kind = StatementKind::Assign { target: target.access(span), value: number };
        self.conditional(sheet, flow, kind, span);
        Some(())
    }

    /// S_PULSE, S_PEXT, S_ODT, S_ODTS, S_OFFDT, as boxes and as coils.
    pub fn s5_timer_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, name: &str) -> Option<()> {
        let element = sheet.element(at);
        let cell = self.cell_node(element, "timer", "T1")?;
        let mut arguments = vec![argument("T_NO", cell, false)];
        let flow = self.cell_inputs(ctx, sheet, at, &[("s", "S"), ("tv", "TV"), ("r", "R")], &mut arguments)?;
        self.cell_call(ctx, sheet, at, name, arguments, &[("q", "Q"), ("bi", "BI")], "bcd")?;
        self.passed(ctx, sheet, at, flow)
    }

    /// S_CU, S_CD, S_CUD.
    pub fn s5_counter_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, name: &str) -> Option<()> {
        let element = sheet.element(at);
        let cell = self.cell_node(element, "counter", "C1")?;
        let mut arguments = vec![argument("C_NO", cell, false)];
        let pins = [("cu", "CU"), ("cd", "CD"), ("s", "S"), ("pv", "PV"), ("r", "R")];
        self.cell_inputs(ctx, sheet, at, &pins, &mut arguments)?;
        self.cell_call(ctx, sheet, at, name, arguments, &[("q", "Q"), ("cv", "CV")], "cv_bcd")
    }

    /// CU, CD, SC.
    pub fn counter_coil(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, coil: CounterCoil) -> Option<()> {
        let element = sheet.element(at);
        let cell = self.cell_node(element, "counter", "C1")?;
        let mut arguments = vec![argument("C_NO", cell, false)];
        let (name, input) = match coil {
            CounterCoil::Up => ("S_CU", "CU"),
            CounterCoil::Down => ("S_CD", "CD"),
            CounterCoil::Set => ("S_CU", "S"),
        };
        let flow = self.cell_inputs(ctx, sheet, at, &[("in", input), ("pv", "PV")], &mut arguments)?;
        self.cell_call(ctx, sheet, at, name, arguments, &[], "")?;
        self.passed(ctx, sheet, at, flow)
    }

    /// The flow after a coil is the same as before it.
    fn passed(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, flow: Option<Expr>) -> Option<()> {
        match flow {
            Some(flow) => self.output(ctx, sheet, at, "out", Value::Elementary(flow)),
            None => Some(()),
        }
    }

    /// The timer or counter of an element: its instance, or a pin.
    fn cell_node(&mut self, element: &plcc_syntax::network::ast::Element, pin: &str, example: &str) -> Option<Node> {
        if let Target::Element { instance: Some(instance), .. } = &element.target {
            return Some(instance.clone());
        }
        let node = self.operand_node(element, pin);
        if node.is_none() {
            let text = self.program.globals.text(element.span);
            self.scl().refuse(
                Code::MissingOperand,
                element.span,
                &format!("`{text}` has no {pin}"),
                "the number above the element is missing",
                &format!("write for example {example}"),
            );
        }
        node
    }

    /// Arguments for the connected inputs; returns the flow, the first of them.
    fn cell_inputs(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        at: usize,
        pins: &[(&str, &str)],
        arguments: &mut Vec<Argument>,
    ) -> Option<Option<Expr>> {
        let element = sheet.element(at);
        let mut flow = None;
        for (index, (pin, formal)) in pins.iter().enumerate() {
            let Some(found) = connected(element, pin) else { continue };
            let node = if index == 0 {
                let value = self.flow(ctx, sheet, at, pin)?;
                let value = sheet.keep(ctx, value);
                flow = Some(value.clone());
                self.value_node(ctx, sheet, value)
            } else {
                self.pin_node(ctx, sheet, found)?
            };
            arguments.push(argument(formal, node, false));
        }
        Some(flow)
    }

    /// Calls the function of SCL, and sends its outputs and its value in BCD to the pins.
    #[allow(clippy::too_many_arguments, reason = "the parts of one call")]
    fn cell_call(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        at: usize,
        name: &str,
        mut arguments: Vec<Argument>,
        results: &[(&str, &str)],
        bcd: &str,
    ) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let mut after = Vec::new();
        for (pin, formal) in results {
            if outputs(element, pin).next().is_some() {
                let ty = if *formal == "Q" { Elementary::Bool } else { Elementary::Word };
                let hidden = sheet.hidden(ctx, ty);
                arguments.push(argument(formal, hidden.node(span), true));
                after.push((*pin, hidden));
            }
        }
        let call = call_node(name, arguments, span);
        if !bcd.is_empty() && self.is_wanted(sheet, at, bcd) {
            let value = self.scl().value(ctx, &call)?;
            let value = self.scl().own_type(ctx, value)?;
            let value = converted(value, Conversion::Bits { checked: false }, Elementary::Word);
            let value = sheet.keep(ctx, value);
            self.output(ctx, sheet, at, bcd, Value::Elementary(value))?;
        } else {
            let mut bound = Vec::new();
            self.scl().statement(ctx, &Tree { kind: TreeKind::Expression(call), span }, &mut bound);
            sheet.statements.extend(bound);
        }
        for (pin, hidden) in after {
            self.output(ctx, sheet, at, pin, Value::Elementary(hidden.load(span)))?;
        }
        Some(())
    }

    /// CALL of a block without parameters.
    pub fn call_coil(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let flow = self.flow(ctx, sheet, at, "in")?;
        let callee = self.operand_node(element, "operand")?;
        let node = Node { kind: NodeKind::Call { callee: Box::new(callee), arguments: Vec::new() }, span };
        let mut body = Vec::new();
        self.scl().statement(ctx, &Tree { kind: TreeKind::Expression(node), span }, &mut body);
        sheet.push(StatementKind::If { branches: vec![(flow, body)], otherwise: Vec::new() }, span);
        Some(())
    }
}
