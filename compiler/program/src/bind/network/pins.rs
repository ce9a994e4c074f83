//! Values that come in at pins and go out of them; EN and ENO. Source: LAD/FBD reference A.5, A.6, C.1.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::Elementary;
use plcc_syntax::network::ast::{Element, Eno, NetId, Pin, PinValue, Source, Storage, Target};
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind, Name, NameForm, UnaryOp as Sign};

use super::sheet::Sheet;
use crate::bind::network::NetworkBinder;
use crate::bind::scl::expression::{binary_expr, constant_expr};
use crate::bind::scl::message::DEPTH_MAX;
use crate::bind::scl::numeric::Shape;
use crate::bind::scl::value::Value;
use crate::bind::scl::{Intent, SclBlock};
use plcc_model::scl::{BinaryOp, Expr, ExprKind, StatementKind, UnaryOp};

/// TRUE.
pub fn yes(span: Span) -> Expr {
    constant_expr(1, Elementary::Bool, span)
}

/// FALSE.
pub fn no(span: Span) -> Expr {
    constant_expr(0, Elementary::Bool, span)
}

/// `a AND b`; nothing if one is TRUE.
pub fn and(a: Expr, b: Expr, span: Span) -> Expr {
    match (&a.kind, &b.kind) {
        (ExprKind::Const(1), _) => b,
        (_, ExprKind::Const(1)) => a,
        _ => binary_expr(BinaryOp::And, a, b, Elementary::Bool, span),
    }
}

pub fn or(a: Expr, b: Expr, span: Span) -> Expr {
    binary_expr(BinaryOp::Or, a, b, Elementary::Bool, span)
}

/// All bits of a value.
pub fn inverted(value: Expr) -> Expr {
    let (ty, span) = (value.ty, value.span);
    match value.kind {
        ExprKind::Const(bits) if ty == Elementary::Bool => constant_expr(bits ^ 1, ty, span),
        _ => Expr { kind: ExprKind::Unary { op: UnaryOp::Not, operand: Box::new(value) }, ty, span },
    }
}

impl NetworkBinder<'_, '_> {
    /// The value of a net; none if nothing feeds it, which is reported elsewhere.
    pub fn net_value(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, id: NetId) -> Option<Expr> {
        self.net_value_inner(ctx, sheet, id, 0)
    }

    fn net_value_inner(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, id: NetId, depth: u32) -> Option<Expr> {
        if let Some(known) = sheet.nets.get(&id) {
            return Some(known.clone());
        }
        if depth > DEPTH_MAX {
            return None;
        }
        let net = sheet.graph.net(id);
        let mut value: Option<Expr> = None;
        for source in &net.sources {
            let one = match source {
                Source::Rail => yes(net.span),
                Source::Pin { element, pin } => sheet.outputs.get(&(*element, *pin)).cloned()?,
                Source::Operand { value, negated } => {
                    let value = self.scl().of_type(ctx, value, Elementary::Bool)?;
                    sheet.keep(ctx, if *negated { inverted(value) } else { value })
                }
                Source::Net(other) => self.net_value_inner(ctx, sheet, *other, depth + 1)?,
            };
            value = Some(match value {
                None => one,
                Some(before) if before.ty == Elementary::Bool && one.ty == Elementary::Bool => {
                    or(before, one, net.span)
                }
                Some(_) => {
                    self.two_sources(net.span);
                    return None;
                }
            });
        }
        let value = value?;
        let value = if net.sources.len() > 1 { sheet.keep(ctx, value) } else { value };
        sheet.nets.insert(id, value.clone());
        Some(value)
    }

    /// Data of two outputs in one net.
    fn two_sources(&mut self, span: Span) {
        self.program.report(
            Diagnostic::new(Code::OperandKind, span, "two outputs feed one input with values")
                .label("only Boolean branches can be joined")
                .help("connect one output only, or choose between them with SEL or MUX"),
        );
    }

    /// The value at an input pin.
    pub fn pin_value(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, pin: &Pin) -> Option<Value> {
        let value = match &pin.value {
            PinValue::Net(id) => Value::Elementary(self.net_value(ctx, sheet, *id)?),
            PinValue::Operand(node) if pin.negated => {
                return self.scl().value(ctx, &negation(node));
            }
            PinValue::Operand(node) => return self.scl().value(ctx, node),
            PinValue::Open => return None,
        };
        Some(match value {
            Value::Elementary(expr) if pin.negated => Value::Elementary(inverted(expr)),
            value => value,
        })
    }

    /// The value at the input `name`; none without a message if it is not connected.
    pub fn input(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, name: &str) -> Option<Value> {
        let pin = connected(sheet.element(at), name)?;
        self.pin_value(ctx, sheet, pin)
    }

    /// Like `input`, with a type.
    pub fn input_of(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        at: usize,
        name: &str,
        ty: Elementary,
    ) -> Option<Expr> {
        let value = self.input(ctx, sheet, at, name)?;
        self.scl().convert(ctx, value, ty)
    }

    /// The flow that enters an element: the value of its first flow pin; TRUE where a box has none.
    pub fn flow(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, name: &str) -> Option<Expr> {
        match connected(sheet.element(at), name) {
            Some(pin) => {
                let value = self.pin_value(ctx, sheet, pin)?;
                self.scl().convert(ctx, value, Elementary::Bool)
            }
            None => Some(yes(sheet.element(at).span)),
        }
    }

    /// An input as an expression of the syntax tree: anything but a plain operand goes through a hidden variable.
    pub fn pin_node(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, pin: &Pin) -> Option<Node> {
        match &pin.value {
            PinValue::Operand(node) if pin.negated => Some(negation(node)),
            PinValue::Operand(node) => Some(node.clone()),
            PinValue::Open => None,
            PinValue::Net(_) => {
                let value = self.pin_value(ctx, sheet, pin)?;
                let value = self.scl().own_type(ctx, value)?;
                Some(self.value_node(ctx, sheet, value))
            }
        }
    }

    /// A value as an expression of the syntax tree.
    pub fn value_node(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, value: Expr) -> Node {
        let span = value.span;
        let hidden = sheet.hidden(ctx, value.ty);
        sheet.statements.push(hidden.set(value, span));
        hidden.node(span)
    }

    /// True if anything uses the output `name`.
    pub fn is_wanted(&self, sheet: &Sheet, at: usize, name: &str) -> bool {
        outputs(sheet.element(at), name).next().is_some()
    }

    /// Writes a value to the output `name`, and to everything that is connected to it.
    pub fn output(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, name: &str, value: Value) -> Option<()> {
        let element = sheet.element(at);
        let mut good = Some(());
        let mut value = value;
        let several = outputs(element, name).count() > 1;
        if several && let Value::Elementary(expr) = value {
            value = Value::Elementary(sheet.keep(ctx, expr));
        }
        for (index, pin) in outputs(element, name) {
            good = self.output_pin(ctx, sheet, (at, index), pin, value.clone()).and(good);
        }
        good
    }

    /// Writes a value to one pin of an output: `place` is the element and the pin.
    pub fn output_pin(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        place: (usize, usize),
        pin: &Pin,
        value: Value,
    ) -> Option<()> {
        let value = if pin.negated {
            Value::Elementary(inverted(self.scl().convert(ctx, value, Elementary::Bool)?))
        } else {
            value
        };
        match &pin.value {
            PinValue::Net(_) => {
                let expr = match value {
                    Value::Elementary(_) | Value::Constant(..) | Value::Cell { .. } => {
                        self.scl().own_type(ctx, value)?
                    }
                    _ => {
                        self.needs_operand(pin.span);
                        return None;
                    }
                };
                let (ty, span) = (expr.ty, expr.span);
                let hidden = sheet.hidden(ctx, ty);
                sheet.statements.push(hidden.set(expr, span));
                sheet.outputs.insert(place, hidden.load(span));
                sheet.skipped.push(hidden);
                Some(())
            }
            PinValue::Operand(node) => {
                // A relay that is off writes 0.
                let value = match (sheet.registers().relay(pin.span), value) {
                    (Some(on), Value::Elementary(expr)) => Value::Elementary(self.relayed_value(ctx, sheet, expr, on)),
                    (_, value) => value,
                };
                self.write(ctx, sheet, node, value, pin.storage)
            }
            PinValue::Open => Some(()),
        }
    }

    /// A wire cannot carry a value that is not a single value.
    fn needs_operand(&mut self, span: Span) {
        self.program.report(
            Diagnostic::new(Code::MissingOperand, span, "this output needs an operand")
                .label("a wire cannot carry texts and structures")
                .help("put a variable at the output, and the same one at the input"),
        );
    }

    /// Writes an operand.
    pub fn write(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        node: &Node,
        value: Value,
        storage: Storage,
    ) -> Option<()> {
        let span = node.span;
        let value = match storage {
            Storage::None => value,
            Storage::Set | Storage::Reset => {
                let condition = self.scl().convert(ctx, value, Elementary::Bool)?;
                let target = self.scl().access(ctx, node, Intent::Write)?;
                let value = if storage == Storage::Set { yes(span) } else { no(span) };
                let kind = self.scl().assignment(ctx, target, Value::Elementary(value))?;
                self.conditional(sheet, condition, kind, span);
                return Some(());
            }
        };
        let target = self.scl().access(ctx, node, Intent::Write)?;
        let kind = self.scl().assignment(ctx, target, value)?;
        sheet.push(kind, span);
        Some(())
    }

    /// `IF condition THEN statement`.
    pub fn conditional(&mut self, sheet: &mut Sheet, condition: Expr, kind: StatementKind, span: Span) {
        if let ExprKind::Const(1) = condition.kind {
            sheet.push(kind, span);
            return;
        }
        let body = vec![plcc_model::scl::Statement { kind, span }];
        sheet.push(StatementKind::If { branches: vec![(condition, body)], otherwise: Vec::new() }, span);
    }

    /// Runs `body` under EN of a box, and returns ENO.
    pub fn boxed(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        at: usize,
        body: impl FnOnce(&mut Self, &mut SclBlock, &mut Sheet) -> Option<()>,
    ) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let enable = self.flow(ctx, sheet, at, "en")?;
        let generated = element.eno != Eno::Disabled;
        let br = sheet.page.eno.clone().filter(|_| super::has_br(ctx.scope.rules) && has_eno(element));
        let wanted = self.is_wanted(sheet, at, "eno");
        let eno = (wanted || (br.is_some() && generated)).then(|| sheet.hidden(ctx, Elementary::Bool));
        let outer = std::mem::take(&mut sheet.statements);
        let skipped_before = std::mem::take(&mut sheet.skipped);
        if generated || sheet.registers().has_status() {
            sheet.push(StatementKind::SetFlag(yes(span)), span);
        }
        let good = body(self, ctx, sheet);
        if let Some(eno) = &eno {
            let flag = Expr { kind: ExprKind::Flag, ty: Elementary::Bool, span };
            sheet.statements.push(eno.set(if generated { flag } else { yes(span) }, span));
        }
        let inner = std::mem::replace(&mut sheet.statements, outer);
        let skipped = std::mem::replace(&mut sheet.skipped, skipped_before);
        match enable.kind {
            ExprKind::Const(1) => sheet.statements.extend(inner),
            _ => {
                let mut otherwise: Vec<_> =
                    skipped.iter().map(|hidden| hidden.set(constant_expr(0, hidden.ty, span), span)).collect();
                otherwise.extend(eno.iter().map(|eno| eno.set(no(span), span)));
                sheet.push(StatementKind::If { branches: vec![(enable, inner)], otherwise }, span);
            }
        }
        if let Some(eno) = eno {
            if let Some(br) = br.filter(|_| generated) {
                sheet.statements.push(br.set(eno.load(span), span));
            }
            self.output(ctx, sheet, at, "eno", Value::Elementary(eno.load(span)))?;
        }
        good
    }

    /// The type of a value, if it has one itself.
    pub fn own_type(&self, value: &Value) -> Option<Elementary> {
        Shape::of(value).elementary()
    }
}

/// The box reports errors through ENO; for a call of a block, the block sets ENO.
fn has_eno(element: &Element) -> bool {
    match &element.target {
        Target::Element { row, .. } => row.is_box(),
        Target::Block { .. } => true,
    }
}

/// The input `name`, if something is connected to it.
pub fn connected<'e>(element: &'e Element, name: &str) -> Option<&'e Pin> {
    element.pin(name).filter(|pin| pin.value != PinValue::Open)
}

/// Everything that is connected to the output `name`, with the position of each pin.
pub fn outputs<'e>(element: &'e Element, name: &str) -> impl Iterator<Item = (usize, &'e Pin)> {
    let name = name.to_string();
    element
        .pins
        .iter()
        .enumerate()
        .filter(move |(_, pin)| pin.output && pin.value != PinValue::Open && pin.name.eq_ignore_ascii_case(&name))
}

/// `NOT operand` in the syntax tree.
pub fn negation(node: &Node) -> Node {
    let kind = NodeKind::Unary { op: Sign::Not, operand: Box::new(node.clone()) };
    Node { kind, span: node.span }
}

/// A bare name in the syntax tree.
pub fn bare(text: &str, span: Span) -> Node {
    Node { kind: NodeKind::Name(Name { text: text.to_string(), form: NameForm::Bare, span }), span }
}
