//! Contacts, gates, coils, edges, flip-flops, bit fields. Source: LAD/FBD reference C.2 to C.4.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::CellKind;
use plcc_syntax::network::ast::{Element, Pin, PinValue};
use plcc_syntax::network::draw;
use plcc_syntax::network::elements::Gate;
use plcc_syntax::scl::ast::{
    Argument, Expr as Node, ExprKind as NodeKind, Name, NameForm, Statement as Tree, StatementKind as TreeKind,
};
use plcc_syntax::{Class, Elementary};

use super::pins::{and, bare, connected, inverted, no, yes};
use super::sheet::Sheet;
use crate::bind::network::NetworkBinder;
use crate::bind::scl::assign::value_of;
use crate::bind::scl::expression::{binary_expr, constant_expr};
use crate::bind::scl::numeric::Shape;
use crate::bind::scl::place::{Thing, shifted};
use crate::bind::scl::value::Value;
use crate::bind::scl::{Intent, SclBlock};
use plcc_model::layout;
use plcc_model::scl::{Access, Base, BinaryOp, Expr, StatementKind};
use plcc_model::types::{ArrayType, DataType};
use plcc_model::{Place, Width};

/// No memory area has more bits.
const BIT_FIELD_MAX: i128 = 8 * 65_536;

impl NetworkBinder<'_, '_> {
    pub fn contact(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        let span = sheet.element(at).span;
        let flow = self.flow(ctx, sheet, at, "in");
        let operand = self.input_of(ctx, sheet, at, "operand", Elementary::Bool);
        self.output(ctx, sheet, at, "out", Value::Elementary(and(flow?, operand?, span)))
    }

    pub fn not_element(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        let flow = self.flow(ctx, sheet, at, "in")?;
        self.output(ctx, sheet, at, "out", Value::Elementary(inverted(flow)))
    }

    /// All inputs are read. PLCopen has one name for the gates of BOOL and of bit strings.
    pub fn gate(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, gate: Gate) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let mut values = Vec::new();
        for pin in element.pins.iter().filter(|pin| !pin.output && pin.value != PinValue::Open) {
            values.push(self.pin_value(ctx, sheet, pin)?);
        }
        let bits = |value: &Value| match Shape::of(value).elementary() {
            Some(ty) if ty.class() == Class::Bits => Some(ty),
            _ => None,
        };
        // With one BOOL it is a gate of signals.
        let ty = match values.iter().filter_map(bits).min_by_key(|ty| ty.bits()) {
            Some(Elementary::Bool) | None => Elementary::Bool,
            Some(ty) => values.iter().filter_map(bits).max_by_key(|ty| ty.bits()).unwrap_or(ty),
        };
        let op = match gate {
            Gate::And => BinaryOp::And,
            Gate::Or => BinaryOp::Or,
            Gate::Xor => BinaryOp::Xor,
        };
        let mut result: Option<Expr> = None;
        for value in values {
            let value = self.scl().convert(ctx, value, ty)?;
            result = Some(match result {
                None => value,
                Some(before) => binary_expr(op, before, value, ty, span),
            });
        }
        self.output(ctx, sheet, at, "out", Value::Elementary(result?))
    }

    /// The flow of a coil: the value that it writes, and the one that leaves it. A relay that is off writes 0.
    fn coil_flow(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<Expr> {
        let flow = self.flow(ctx, sheet, at, "in")?;
        Some(sheet.keep(ctx, flow))
    }

    pub fn coil(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let flow = self.coil_flow(ctx, sheet, at)?;
        let pin = connected(element, "operand")?;
        let value = if pin.negated { inverted(flow.clone()) } else { flow.clone() };
        let value = match sheet.registers().relay(span) {
            Some(on) => and(value, on, span),
            None => value,
        };
        self.write_pin(ctx, sheet, pin, value)?;
        self.output(ctx, sheet, at, "out", Value::Elementary(flow))
    }

    /// The coil at the end of a condition of GRAPH.
    pub fn condition_coil(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        let flow = self.flow(ctx, sheet, at, "in")?;
        if sheet.page.condition.is_none() {
            self.scl().refuse(
                Code::UnknownElement,
                sheet.element(at).span,
                "the coil of a condition is only possible in a chart of GRAPH",
                "this network is not a condition",
                "write a coil with an operand",
            );
            return None;
        }
        sheet.page.condition = Some(Some(flow));
        Some(())
    }

    /// Writes the operand of a coil.
    fn write_pin(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, pin: &Pin, value: Expr) -> Option<()> {
        match &pin.value {
            PinValue::Operand(node) => {
                let target = self.coil_target(ctx, node)?;
                let kind = self.scl().assignment(ctx, target, Value::Elementary(value))?;
                sheet.push(kind, node.span);
                Some(())
            }
            PinValue::Net(_) | PinValue::Open => None,
        }
    }

    /// The operand that a coil writes, which must be a BOOL.
    fn coil_target(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Access> {
        let target = self.scl().access(ctx, node, Intent::Write)?;
        match target.elementary().filter(|ty| *ty != Elementary::Bool) {
            None => Some(target),
            Some(ty) => {
                let text = self.program.globals.text(node.span);
                let title = format!("`{text}` is of type {}, but a coil writes a BOOL", ty.name());
                let help = format!("name a BOOL, or write numbers to `{text}` with the box `Move`");
                self.scl().refuse(Code::TypeMismatch, node.span, &title, &format!("of type {}", ty.name()), &help);
                None
            }
        }
    }

    pub fn set_coil(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, set: bool) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let flow = self.coil_flow(ctx, sheet, at)?;
        let PinValue::Operand(node) = &connected(element, "operand")?.value else { return None };
        let condition = self.relayed(sheet, flow.clone(), span);
        if !set && let Some(kind) = self.cell_operand(ctx, node) {
            self.reset_cell(ctx, sheet, kind, node, condition, span)?;
        } else {
            let target = self.coil_target(ctx, node)?;
            let value = if set { yes(span) } else { no(span) };
            let kind = self.scl().assignment(ctx, target, Value::Elementary(value))?;
            self.conditional(sheet, condition, kind, span);
        }
        self.output(ctx, sheet, at, "out", Value::Elementary(flow))
    }

    /// The condition for writing: a relay that is off does not write.
    pub fn relayed(&mut self, sheet: &Sheet, flow: Expr, span: Span) -> Expr {
        match sheet.registers().relay(span) {
            Some(on) => and(flow, on, span),
            None => flow,
        }
    }

    /// The operand is a timer or counter of the S7-300/400.
    fn cell_operand(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<CellKind> {
        if !matches!(node.kind, NodeKind::Name(_) | NodeKind::Absolute(_)) {
            return None;
        }
        let thing = self.scl().quietly(ctx, |binder, ctx| binder.thing(ctx, node, Intent::Read));
        match thing? {
            Thing::Cell { kind, .. } => Some(kind),
            _ => None,
        }
    }

    /// `R T1`, `R C1`.
    fn reset_cell(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        kind: CellKind,
        node: &Node,
        condition: Expr,
        span: Span,
    ) -> Option<()> {
        let (function, formal) = match kind {
            CellKind::Timer => ("S_PULSE", "T_NO"),
            CellKind::Counter => ("S_CU", "C_NO"),
        };
        let reset = self.value_node(ctx, sheet, condition);
        let arguments = vec![argument(formal, node.clone(), false), argument("R", reset, false)];
        self.call_statement(ctx, sheet, function, arguments, span)
    }

    /// A function of SCL as a statement.
    pub fn call_statement(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        name: &str,
        arguments: Vec<Argument>,
        span: Span,
    ) -> Option<()> {
        let before = self.program.globals.report.diagnostics.len();
        let node = call_node(name, arguments, span);
        let tree = Tree { kind: TreeKind::Expression(node), span };
        let mut bound = Vec::new();
        self.scl().statement(ctx, &tree, &mut bound);
        let good = !self.program.globals.report.diagnostics[before..].iter().any(Diagnostic::is_error);
        sheet.statements.extend(bound);
        good.then_some(())
    }

    pub fn edge_contact(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, rising: bool) -> Option<()> {
        let span = sheet.element(at).span;
        let flow = self.flow(ctx, sheet, at, "pre")?;
        let operand = self.input_of(ctx, sheet, at, "operand", Elementary::Bool)?;
        let operand = sheet.keep(ctx, operand);
        let edge = self.edge(ctx, sheet, at, operand, rising)?;
        self.own_edge_bit(sheet.element(at));
        self.output(ctx, sheet, at, "out", Value::Elementary(and(flow, edge, span)))
    }

    pub fn edge_trigger(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, rising: bool) -> Option<()> {
        let flow = self.flow(ctx, sheet, at, "in")?;
        let flow = sheet.keep(ctx, flow);
        let edge = self.edge(ctx, sheet, at, flow, rising)?;
        self.output(ctx, sheet, at, "out", Value::Elementary(edge))
    }

    pub fn edge_coil(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, rising: bool) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let flow = self.coil_flow(ctx, sheet, at)?;
        let edge = self.edge(ctx, sheet, at, flow.clone(), rising)?;
        let edge = self.relayed(sheet, edge, span);
        self.write_pin(ctx, sheet, connected(element, "operand")?, edge)?;
        self.output(ctx, sheet, at, "out", Value::Elementary(flow))
    }

    /// The edge of a value compared with its memory bit, which then holds the value.
    fn edge(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, value: Expr, rising: bool) -> Option<Expr> {
        let element = sheet.element(at);
        let span = element.span;
        let PinValue::Operand(bit) = &connected(element, "bit")?.value else { return None };
        let access = self.scl().access(ctx, bit, Intent::Both)?;
        let before = value_of(&access, bit.span)?;
        if let Value::Elementary(own) = &before
            && own.ty != Elementary::Bool
        {
            let (text, is) = (self.program.globals.text(bit.span), format!("of type {}", own.ty.name()));
            let title = format!("`{text}` is {is}, but an edge memory bit is a BOOL");
            let message = Diagnostic::new(Code::TypeMismatch, bit.span, title);
            let help = "name a BOOL in bit memory or in static data that nothing else uses";
            self.program.report(message.label(is).help(help));
            return None;
        }
        self.check_edge_bit(&access, bit.span);
        let before = self.scl().convert(ctx, before, Elementary::Bool)?;
        let edge = if rising {
            and(value.clone(), inverted(before), span)
        } else {
            and(inverted(value.clone()), before, span)
        };
        let edge = sheet.keep(ctx, edge);
        let kind = self.scl().assignment(ctx, access, Value::Elementary(value))?;
        sheet.push(kind, span);
        Some(edge)
    }

    /// Warns of a contact whose edge memory bit is its operand.
    fn own_edge_bit(&mut self, element: &Element) {
        let text = |name: &str| match &connected(element, name)?.value {
            PinValue::Operand(node) => Some((draw::whole(node), node.span)),
            PinValue::Net(_) | PinValue::Open => None,
        };
        let (Some((signal, _)), Some((bit, span))) = (text("operand"), text("bit")) else { return };
        if !signal.eq_ignore_ascii_case(&bit) {
            return;
        }
        let message = Diagnostic::new(Code::EdgeBit, span, format!("`{bit}` is compared with itself"))
            .label("the operand of the contact: there is never an edge")
            .help("name another BOOL, in bit memory or in static data, that nothing else uses");
        self.program.report(message);
    }

    /// An edge memory bit keeps its value from one cycle to the next.
    fn check_edge_bit(&mut self, access: &Access, span: Span) {
        let area = match &access.base {
            Base::Place(Place::L { .. }) => "temporary data, which is lost when the block ends",
            Base::Place(Place::I { .. }) => "an input, which the process image overwrites",
            _ => return,
        };
        let text = self.program.globals.text(span);
        let message = Diagnostic::new(Code::EdgeBit, span, format!("`{text}` cannot remember an edge"))
            .label(area)
            .help("use a bit memory, a static variable or a bit of a data block");
        self.program.report(message);
    }

    pub fn flip_flop(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, set_wins: bool) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let (set, reset) = if set_wins { ("s1", "r") } else { ("s", "r1") };
        let mut input = |binder: &mut Self, name: &str| match connected(element, name) {
            Some(_) => {
                let value = binder.input_of(ctx, sheet, at, name, Elementary::Bool)?;
                Some(sheet.keep(ctx, value))
            }
            None => Some(no(span)),
        };
        let (set, reset) = (input(self, set)?, input(self, reset)?);
        let PinValue::Operand(node) = &connected(element, "operand")?.value else { return None };
        let access = self.scl().access(ctx, node, Intent::Both)?;
        let state = self.scl().convert(ctx, value_of(&access, node.span)?, Elementary::Bool)?;
        let value = if set_wins {
            super::pins::or(and(state, inverted(reset), span), set, span)
        } else {
            and(super::pins::or(state, set, span), inverted(reset), span)
        };
        let value = sheet.keep(ctx, value);
        let kind = self.scl().assignment(ctx, access.clone(), Value::Elementary(value.clone()))?;
        match sheet.registers().relay(span) {
            Some(on) => {
                self.conditional(sheet, on, kind, span);
                let state = value_of(&access, node.span)?;
                self.output(ctx, sheet, at, "q", state)
            }
            None => {
                sheet.push(kind, span);
                self.output(ctx, sheet, at, "q", Value::Elementary(value))
            }
        }
    }

    /// SET_BF, RESET_BF: whole bytes where these are known.
    pub fn bit_field(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, set: bool) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let flow = self.coil_flow(ctx, sheet, at)?;
        let PinValue::Operand(count) = &connected(element, "n")?.value else { return None };
        let count = self.constant_integer(ctx, count)?;
        let PinValue::Operand(node) = &connected(element, "operand")?.value else { return None };
        let access = self.scl().access(ctx, node, Intent::Write)?;
        let count = count.clamp(0, BIT_FIELD_MAX);
        let array = self.array_of_bits(ctx, node);
        let count = match &array {
            Some(array) => count.min(array.left()),
            None => count,
        };
        if access.elementary() != Some(Elementary::Bool) || access.part.is_some() || !access.indices.is_empty() {
            let text = self.program.globals.text(node.span);
            self.scl().refuse(
                Code::OperandKind,
                node.span,
                &format!("`{text}` cannot begin a bit field"),
                "not a bit with a fixed address",
                "name a BOOL: an input, output, bit memory, or an element of an ARRAY OF BOOL with a constant index",
            );
            return None;
        }
        let condition = self.relayed(sheet, flow.clone(), span);
        let mut body = Vec::new();
        let mut bit = 0;
        while bit < count {
            let (target, width) = match &array {
                // Each row of an array with several dimensions begins at a new byte.
                Some(array) if array.ty.bounds.len() > 1 => (array.element(bit)?, Width::Bit),
                _ => moved_bit(&access, bit as u32, count - bit >= 8)?,
            };
            let (value, ty) = match (width, set) {
                (Width::Byte, true) => (0xFF, Elementary::Byte),
                (Width::Byte, false) => (0, Elementary::Byte),
                (_, true) => (1, Elementary::Bool),
                (_, false) => (0, Elementary::Bool),
            };
            let kind = StatementKind::Assign { target, value: constant_expr(value, ty, span) };
            body.push(plcc_model::scl::Statement { kind, span });
            bit += i128::from(width.bits());
        }
        sheet.push(StatementKind::If { branches: vec![(condition, body)], otherwise: Vec::new() }, span);
        self.output(ctx, sheet, at, "out", Value::Elementary(flow))
    }

    /// The array that `node` names an element of, with constant indices; none for other operands.
    fn array_of_bits(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<BitArray> {
        let NodeKind::Index { base, indices } = &node.kind else { return None };
        let access = self.scl().access(ctx, base, Intent::Write)?;
        let DataType::Array(ty) = &access.ty else { return None };
        let mut position = 0;
        for (index, (low, high)) in indices.iter().zip(&ty.bounds) {
            let value = self.constant_integer(ctx, index)?;
            position = position * (i128::from(*high) - i128::from(*low) + 1) + (value - i128::from(*low));
        }
        Some(BitArray { ty: std::rc::Rc::clone(ty), access, position })
    }
}

/// An element of an array of bits.
struct BitArray {
    access: Access,
    ty: std::rc::Rc<ArrayType>,
    /// In order of the elements, 0 for the first.
    position: i128,
}

impl BitArray {
    /// Elements from this one to the end.
    fn left(&self) -> i128 {
        (i128::from(layout::element_count(&self.ty.bounds)) - self.position).max(0)
    }

    /// The element `distance` after this one.
    fn element(&self, distance: i128) -> Option<Access> {
        let index = u64::try_from(self.position + distance).ok()?;
        let (byte, bit) = layout::element_place(&self.ty, index);
        shifted(&self.access, byte, bit, &self.ty.element)
    }
}

/// The bit or, if `whole`, the byte at this distance in bits from a bit.
fn moved_bit(access: &Access, bits: u32, whole: bool) -> Option<(Access, Width)> {
    let Base::Place(place) = &access.base else { return None };
    let mut place = place.clone();
    let (byte, bit) = match &mut place {
        Place::I { byte, bit }
        | Place::Q { byte, bit }
        | Place::M { byte, bit }
        | Place::L { byte, bit }
        | Place::Db { byte, bit, .. }
        | Place::Instance { byte, bit }
        | Place::Parameter { byte, bit, .. }
        | Place::ThroughPointer { byte, bit, .. } => (byte, bit),
        Place::Pi { .. }
        | Place::Pq { .. }
        | Place::OpenDb { .. }
        | Place::OpenDi { .. }
        | Place::Indirect { .. }
        | Place::Register { .. }
        | Place::Element { .. } => return None,
    };
    let moved = 8 * *byte + u32::from(*bit) + bits;
    *byte = moved / 8;
    *bit = (moved % 8) as u8;
    let whole = whole && *bit == 0;
    let ty = if whole { Elementary::Byte } else { Elementary::Bool };
    let access = Access { base: Base::Place(place), ty: DataType::Elementary(ty), ..access.clone() };
    Some((access, if whole { Width::Byte } else { Width::Bit }))
}

/// An argument of a call in the syntax tree.
pub fn argument(name: &str, value: Node, output: bool) -> Argument {
    let span = value.span;
    Argument {
        name: Some(Name { text: name.to_string(), form: NameForm::Bare, span }),
        output,
        value: Some(value),
        span,
    }
}

/// A call in the syntax tree.
pub fn call_node(name: &str, arguments: Vec<Argument>, span: Span) -> Node {
    Node { kind: NodeKind::Call { callee: Box::new(bare(name, span)), arguments }, span }
}
