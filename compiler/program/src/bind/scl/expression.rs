//! Operators of expressions. Both sides of each are evaluated, the left one first. Source: SCL reference, operators.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::scl::ast::{BinaryOp as Operator, Expr as Node, ExprKind as NodeKind, Literal, UnaryOp as Sign};
use plcc_syntax::{Class, Elementary};

use super::compare::{comparison, is_any_text};
use super::numeric::{self, Shape};
use super::text::{is_narrow_text, number_as_text};
use super::value::Value;
use super::{Intent, Rules, message};
use crate::bind::scl::message::DEPTH_MAX;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_model::scl::{BinaryOp, CompareOp, Conversion, Expr, ExprKind, UnaryOp};
use plcc_model::types::{DataType, ParameterType};

impl SclBinder<'_, '_> {
    /// Binds an expression, calls included.
    pub(in crate::bind) fn value(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Value> {
        if ctx.scope.depth >= DEPTH_MAX {
            self.too_deep(node.span);
            return None;
        }
        ctx.scope.depth += 1;
        let value = self.value_inner(ctx, node);
        ctx.scope.depth -= 1;
        value
    }

    fn value_inner(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Value> {
        if let Some(call) = self.constant_character(ctx, node) {
            return self.call(ctx, &call, false);
        }
        match &node.kind {
            NodeKind::Literal(literal) => self.literal_value(literal, node.span),
            NodeKind::Name(_)
            | NodeKind::Absolute(_)
            | NodeKind::Member { .. }
            | NodeKind::MemberAbsolute { .. }
            | NodeKind::Slice { .. }
            | NodeKind::Dereference(_)
            | NodeKind::Index { .. } => {
                let thing = self.thing(ctx, node, Intent::Read)?;
                self.thing_value(ctx, thing, node.span)
            }
            NodeKind::Call { callee, arguments } => match self.indexed_call(ctx, callee, arguments, node.span) {
                Some(thing) => {
                    let thing = thing?;
                    self.thing_value(ctx, thing, node.span)
                }
                None => self.call(ctx, node, false),
            },
            NodeKind::Reference(target) => self.reference(ctx, target, node.span),
            NodeKind::Unary { op, operand } => self.unary(ctx, node, *op, operand, None),
            NodeKind::Binary { .. } => self.chain(ctx, node),
            NodeKind::Error => None,
        }
    }

    /// `compared`: the comparison whose left side this is.
    fn unary(
        &mut self,
        ctx: &mut SclBlock,
        node: &Node,
        op: Sign,
        operand: &Node,
        compared: Option<&Node>,
    ) -> Option<Value> {
        let value = self.value(ctx, operand)?;
        let shape = Shape::of(&value);
        if shape.is_untyped() && !matches!((op, shape), (Sign::Not, Shape::Real)) {
            return self.folded_constant(ctx, node);
        }
        let rules = ctx.scope.rules;
        let (name, ty) = match op {
            Sign::Plus => ("+", shape.elementary().filter(|ty| is_signed(*ty))),
            Sign::Minus => ("-", shape.elementary().filter(|ty| is_signed(*ty))),
            Sign::Not => ("NOT", shape.elementary().and_then(|ty| numeric::bit_string(rules, ty))),
        };
        let Some(ty) = ty else {
            let is = message::described(&value);
            let text = |span| self.program.globals.text(span);
            let help = match (op, compared.map(|node| &node.kind)) {
                (Sign::Not, Some(NodeKind::Binary { op: sign, right, .. })) => {
                    format!("write `NOT ({} {} {})`", text(operand.span), sign.sign(), text(right.span))
                }
                (Sign::Not, _) if shape.elementary().is_some_and(|ty| ty.is_integer() || ty.is_float()) => {
                    let zero = if shape.elementary().is_some_and(Elementary::is_float) { "0.0" } else { "0" };
                    format!("NOT needs a BOOL or a bit string: write `{} = {zero}`", text(operand.span))
                }
                (Sign::Not, _) => "NOT needs a BOOL or a bit string".to_owned(),
                (Sign::Minus, _) if shape.elementary() == Some(Elementary::Bool) => {
                    format!("the opposite of a BOOL is `NOT {}`", text(operand.span))
                }
                (Sign::Minus | Sign::Plus, _) => "only numbers of signed types and TIME can have a sign".to_owned(),
            };
            let with = if is.starts_with("of ") { format!("a value {is}") } else { is.clone() };
            let title = format!("`{name}` is not possible with {with}");
            self.refuse(Code::TypeMismatch, node.span, &title, &is, &help);
            return None;
        };
        let operand = Box::new(self.convert(ctx, value, ty)?);
        let op = match op {
            Sign::Plus => return Some(Value::Elementary(*operand)),
            Sign::Minus => UnaryOp::Negate,
            Sign::Not => UnaryOp::Not,
        };
        Some(Value::Elementary(Expr { kind: ExprKind::Unary { op, operand }, ty, span: node.span }))
    }

    /// A binary operator with all operators to its left: `a + b + …` is as deep as it is long.
    fn chain(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Value> {
        let mut operators = Vec::new();
        let mut first = node;
        while let NodeKind::Binary { left, .. } = &first.kind {
            operators.push(first);
            first = left;
        }
        if operators.len() > Self::CHAIN_MAX {
            self.too_deep(node.span);
            return None;
        }
        let mut value = match (&first.kind, operators.last().map(|next| (&next.kind, *next))) {
            // `NOT a = b`
            (NodeKind::Unary { op, operand }, Some((NodeKind::Binary { op: next, .. }, whole)))
                if is_comparison(*next) =>
            {
                self.unary(ctx, first, *op, operand, Some(whole))
            }
            // `"text" + 'a'`
            (_, Some((NodeKind::Binary { op, right, .. }, _)))
                if joins_texts(*op)
                    && self.is_undefined_in_quotes(ctx, first)
                    && self.is_text_operand(ctx, right)
                    && self.is_text_in_name_quotes(ctx, first) =>
            {
                None
            }
            _ => self.value(ctx, first),
        };
        for node in operators.into_iter().rev() {
            let NodeKind::Binary { op, left, right, op_span } = &node.kind else { continue };
            if let Some(compared) = self.compared_with_null(*op, value.as_ref(), right, node.span) {
                value = Some(compared);
                continue;
            }
            if let NodeKind::Literal(Literal::Null) = right.kind
                && matches!(value, Some(Value::Parameter { .. }))
                && let Some(compared) = self.points_nowhere(ctx, node)
            {
                value = Some(Value::Elementary(compared));
                continue;
            }
            if self.number_among_conditions(*op, left, right) {
                value = None;
                continue;
            }
            // `text = "START"`.
            if joins_texts(*op) && value.as_ref().is_some_and(is_narrow_text) && self.is_text_in_name_quotes(ctx, right)
            {
                value = None;
                continue;
            }
            let right = match self.compared_type_name(ctx, *op, left, right) {
                Some(number) => Some(number),
                None => self.value(ctx, right),
            };
            if value.is_some() && right.as_ref().is_some_and(|right| self.value_among_conditions(*op, left, right)) {
                value = None;
                continue;
            }
            value = match (value, right) {
                (Some(left), Some(right)) => self.binary(ctx, node, *op, *op_span, left, right),
                _ => None,
            };
        }
        value
    }

    /// Reports `a = 5 OR 6`, which was meant as `a = 5 OR a = 6`.
    fn number_among_conditions(&mut self, op: Operator, left: &Node, right: &Node) -> bool {
        let NodeKind::Binary { op: compare, left: subject, .. } = &left.kind else { return false };
        let compares = is_comparison(*compare);
        let number = match &right.kind {
            NodeKind::Literal(Literal::Integer { value, .. }) => *value > 1,
            _ => false,
        };
        if !matches!(op, Operator::And | Operator::Or | Operator::Xor) || !compares || !number {
            return false;
        }
        let text = |node: &Node| self.program.globals.text(node.span);
        let (condition, subject, number) = (text(left), text(subject), text(right));
        let title = format!("`{number}` is a number, but {} joins conditions here", op.sign());
        let help = format!("write `{condition} {} {subject} {} {number}`", op.sign(), compare.sign());
        self.refuse(Code::TypeMismatch, right.span, &title, "not a condition", &help);
        true
    }

    /// `i = 1 OR j` with an INT `j`: reports a value that was meant to be compared as the one before it.
    fn value_among_conditions(&mut self, op: Operator, left: &Node, right: &Value) -> bool {
        let joins = |op: Operator| matches!(op, Operator::And | Operator::Or | Operator::Xor);
        let last = match &left.kind {
            NodeKind::Binary { op, right, .. } if joins(*op) => &**right,
            _ => left,
        };
        let NodeKind::Binary { op: compare, left: subject, .. } = &last.kind else { return false };
        let is_number = match Shape::of(right) {
            Shape::Of(ty) => ty.is_integer() || ty.is_float(),
            Shape::Integer(value) => value > 1,
            Shape::Real => true,
            Shape::Letter | Shape::Other => false,
        };
        if !joins(op) || !is_comparison(*compare) || !(is_number || is_narrow_text(right)) {
            return false;
        }
        let text = |span| self.program.globals.text(span);
        let (condition, subject, value) = (text(left.span), text(subject.span), text(right.span()));
        let title = format!("`{value}` is {}, but {} joins conditions here", message::described(right), op.sign());
        let help = format!("write `{condition} {} {subject} {} {value}`", op.sign(), compare.sign());
        self.refuse(Code::TypeMismatch, right.span(), &title, "not a condition", &help);
        true
    }

    /// `v = NULL`, `v <> NULL` of a VARIANT or ANY: whether it points to nothing, which its type code shows. `None` for other operands.
    fn points_nowhere(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Expr> {
        let NodeKind::Binary { op, left, .. } = &node.kind else { return None };
        let op = match op {
            Operator::Equal => CompareOp::Equal,
            Operator::NotEqual => CompareOp::NotEqual,
            _ => return None,
        };
        let mut spot = self.spot(ctx, left, Intent::Read)?;
        if spot.ty != DataType::Parameter(ParameterType::Any) {
            return None;
        }
        // Byte 0 of every ANY of an S7 is the same.
        spot.byte += 1;
        spot.ty = DataType::Elementary(Elementary::Byte);
        let access = Box::new(spot.access(left.span));
        let code = Expr { kind: ExprKind::Load(access), ty: Elementary::Byte, span: left.span };
        let none = constant_expr(0, Elementary::Byte, node.span);
        Some(comparison(op, code, none, node.span))
    }

    fn binary(
        &mut self,
        ctx: &mut SclBlock,
        node: &Node,
        op: Operator,
        op_span: Span,
        left: Value,
        right: Value,
    ) -> Option<Value> {
        let span = node.span;
        match op {
            Operator::Less
            | Operator::Greater
            | Operator::LessEqual
            | Operator::GreaterEqual
            | Operator::Equal
            | Operator::NotEqual => self.compare(ctx, op, op_span, left, right, span).map(Value::Elementary),
            _ if Shape::of(&left).is_untyped() && Shape::of(&right).is_untyped() => self.folded_constant(ctx, node),
            Operator::And | Operator::Or | Operator::Xor => {
                let (left, right) = self.partners(ctx, left, right);
                self.bitwise(ctx, op, op_span, left, right, span)
            }
            Operator::Power => self.power(ctx, op_span, left, right, span),
            Operator::Add
            | Operator::Subtract
            | Operator::Multiply
            | Operator::Divide
            | Operator::DivideInteger
            | Operator::Modulo => {
                let (left, right) = self.partners(ctx, left, right);
                let (left, right) =
                    if ctx.scope.address_numbers { self.address_operands(ctx, left, right) } else { (left, right) };
                match self.time_arithmetic(ctx, op, op_span, left, right, span) {
                    Ok(value) => value,
                    Err((left, right)) => self.arithmetic(ctx, op, op_span, left, right, span),
                }
            }
        }
    }

    /// The result of two untyped constants is an untyped constant.
    fn folded_constant(&mut self, ctx: &SclBlock, node: &Node) -> Option<Value> {
        let constant = self.program.globals.constant(&ctx.block.bound.constants, node)?;
        Some(Value::Constant(constant, node.span))
    }

    pub(super) fn arithmetic(
        &mut self,
        ctx: &mut SclBlock,
        op: Operator,
        op_span: Span,
        left: Value,
        right: Value,
        span: Span,
    ) -> Option<Value> {
        let ty = numeric::common(ctx.scope.rules, Shape::of(&left), Shape::of(&right));
        let whole = matches!(op, Operator::DivideInteger | Operator::Modulo);
        let Some(ty) = ty.filter(|ty| !(whole && ty.is_float())) else {
            let help = match (whole && ty.is_some(), op) {
                (true, Operator::Modulo) => {
                    let (left, right) = (self.as_integer(&left), self.as_integer(&right));
                    format!("MOD needs integers: write `{left} MOD {right}`")
                }
                (true, _) => "DIV needs integers; for floating-point numbers write `/`".to_string(),
                (false, Operator::Add) if is_any_text(&left) && is_any_text(&right) => {
                    let globals = &self.program.globals;
                    let (one, two) = (globals.text(left.span()), globals.text(right.span()));
                    format!("texts are joined with `CONCAT(IN1 := {one}, IN2 := {two})`")
                }
                (false, _) => "both sides must be numbers, or dates and times that go together".to_string(),
            };
            self.operator_types(op_span, &left, &right, &help);
            return None;
        };
        let zero = matches!(&right, Value::Constant(Constant::Integer { value: 0, .. }, _));
        if zero && !ty.is_float() && matches!(op, Operator::Divide | Operator::DivideInteger | Operator::Modulo) {
            let text = self.program.globals.text(left.span());
            self.refuse(
                Code::AlwaysSame,
                op_span,
                &format!("`{text}` is always divided by 0"),
                "the right side is 0",
                "write another divisor, or a variable that is not 0",
            );
        }
        self.combined(ctx, binary_op(op), left, right, ty, span)
    }

    /// The text of a number, converted to an integer if it is not one.
    fn as_integer(&self, value: &Value) -> String {
        let text = self.program.globals.text(value.span());
        match value {
            Value::Constant(Constant::Real(number), _) if number.fract() == 0.0 => format!("{number:.0}"),
            Value::Constant(Constant::Real(_), _) => format!("REAL_TO_DINT({text})"),
            Value::Elementary(expr) if expr.ty.is_float() => format!("{}_TO_DINT({text})", expr.ty.name()),
            _ => text,
        }
    }

    /// `left op right` in type `ty`.
    pub(super) fn combined(
        &mut self,
        ctx: &mut SclBlock,
        op: BinaryOp,
        left: Value,
        right: Value,
        ty: Elementary,
        span: Span,
    ) -> Option<Value> {
        let left = self.convert(ctx, left, ty);
        let right = self.convert(ctx, right, ty);
        Some(Value::Elementary(binary_expr(op, left?, right?, ty, span)))
    }

    fn power(&mut self, ctx: &mut SclBlock, op_span: Span, left: Value, right: Value, span: Span) -> Option<Value> {
        let rules = ctx.scope.rules;
        let (a, b) = (Shape::of(&left), Shape::of(&right));
        if numeric::common(rules, a, b).is_none() {
            self.operator_types(op_span, &left, &right, "`**` needs numbers");
            return None;
        }
        let long = |shape| matches!(shape, Shape::Of(Elementary::Lreal));
        let ty = if long(a) || long(b) { Elementary::Lreal } else { Elementary::Real };
        let (left, right) = (self.convert(ctx, left, ty), self.exponent(ctx, right, ty));
        Some(Value::Elementary(binary_expr(BinaryOp::Power, left?, right?, ty, span)))
    }

    fn bitwise(
        &mut self,
        ctx: &mut SclBlock,
        op: Operator,
        op_span: Span,
        left: Value,
        right: Value,
        span: Span,
    ) -> Option<Value> {
        let rules = ctx.scope.rules;
        let bits = |shape: Shape| shape.elementary().and_then(|ty| numeric::bit_string(rules, ty));
        let (a, b) = (Shape::of(&left), Shape::of(&right));
        let ty = match (a, b, bits(a), bits(b)) {
            (_, Shape::Integer(_), Some(ty), _) | (Shape::Integer(_), _, _, Some(ty)) => Some(ty),
            (_, _, Some(a), Some(b)) => {
                let one_bool = (a == Elementary::Bool) != (b == Elementary::Bool);
                let longer = if a.bits() >= b.bits() { a } else { b };
                (!one_bool || rules == Rules::Classic).then_some(longer)
            }
            _ => None,
        };
        let Some(ty) = ty else {
            self.operator_types(op_span, &left, &right, "both sides must be BOOL, or both bit strings");
            return None;
        };
        // Bits keep their pattern: a negative INT next to a longer bit string loses nothing.
        self.combined(ctx, binary_op(op), left, right, ty, span)
    }

    /// Operands that an operator cannot combine.
    pub(super) fn operator_types(&mut self, op_span: Span, left: &Value, right: &Value, help: &str) {
        let op = self.program.globals.text(op_span);
        let (left_is, right_is) = (message::described(left), message::described(right));
        let of_text = |is: &String| is.contains("STRING") || is.contains("a text");
        let joined = match op.as_str() {
            "+" => of_text(&left_is) || of_text(&right_is),
            "&" => of_text(&left_is) && of_text(&right_is),
            _ => false,
        } && !help.contains("CONCAT");
        let of_texts = joined.then(|| {
            let text = |value: &Value| {
                let text = self.program.globals.text(value.span());
                number_as_text(value, &text).unwrap_or(text)
            };
            format!("texts are joined with `CONCAT(IN1 := {}, IN2 := {})`", text(left), text(right))
        });
        // An element is not an operator between values.
        let of_element = (is_element(&op) && help.contains(op.as_str())).then(|| {
            let text = if of_text(&left_is) { Some(left) } else { Some(right).filter(|_| of_text(&right_is)) };
            match text {
                Some(value) => message::text_element(&self.program.globals.text(value.span())),
                None => "convert one of them in an element of its own: `Convert`".to_owned(),
            }
        });
        let help = of_texts.as_deref().or(of_element.as_deref()).unwrap_or(help);
        self.program.report(
            Diagnostic::new(
                Code::TypeMismatch,
                op_span,
                format!("`{op}` cannot combine a value {left_is} with one {right_is}")
                    .replace("a value a", "a")
                    .replace("with one a", "with a"),
            )
            .label("not possible with these types")
            .also(left.span(), left_is)
            .also(right.span(), right_is)
            .help(help),
        );
    }

    /// Operators of one precedence in a row.
    const CHAIN_MAX: usize = 1000;
}

/// Whether the text of an operator is the name of an element of networks, such as `GE_Contact`.
fn is_element(op: &str) -> bool {
    let is_word = op.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    is_word && !["AND", "OR", "XOR", "MOD", "DIV", "NOT"].iter().any(|word| word.eq_ignore_ascii_case(op))
}

/// Types that have a sign.
fn is_signed(ty: Elementary) -> bool {
    matches!(ty.class(), Class::Signed | Class::Float) || matches!(ty, Elementary::Time | Elementary::Ltime)
}

/// `left op right` of one type.
pub fn binary_expr(op: BinaryOp, left: Expr, right: Expr, ty: Elementary, span: Span) -> Expr {
    Expr { kind: ExprKind::Binary { op, left: Box::new(left), right: Box::new(right) }, ty, span }
}

/// A constant of a type.
pub fn constant_expr(bits: u64, ty: Elementary, span: Span) -> Expr {
    Expr { kind: ExprKind::Const(bits), ty, span }
}

/// The same bits as another type.
pub fn as_bits(value: Expr, ty: Elementary) -> Expr {
    if value.ty == ty {
        return value;
    }
    super::convert::converted(value, Conversion::Bits { checked: false }, ty)
}

/// A typed constant's type and bits.
pub fn typed_constant(value: &Value) -> Option<(Elementary, u64)> {
    match value {
        Value::Constant(Constant::Typed { ty, bits }, _) => Some((*ty, *bits)),
        Value::Elementary(Expr { kind: ExprKind::Const(bits), ty, .. }) => Some((*ty, *bits)),
        _ => None,
    }
}

/// The operation of an operator that computes.
pub fn binary_op(op: Operator) -> BinaryOp {
    match op {
        Operator::Power => BinaryOp::Power,
        Operator::Multiply => BinaryOp::Multiply,
        Operator::Divide | Operator::DivideInteger => BinaryOp::Divide,
        Operator::Modulo => BinaryOp::Modulo,
        Operator::Add => BinaryOp::Add,
        Operator::Subtract => BinaryOp::Subtract,
        Operator::And => BinaryOp::And,
        Operator::Xor => BinaryOp::Xor,
        Operator::Or => BinaryOp::Or,
        Operator::Less
        | Operator::Greater
        | Operator::LessEqual
        | Operator::GreaterEqual
        | Operator::Equal
        | Operator::NotEqual => unreachable!("comparisons are not operations"),
    }
}

/// Whether the operator stands between texts, or is meant to.
const fn joins_texts(op: Operator) -> bool {
    is_comparison(op) || matches!(op, Operator::Add)
}

const fn is_comparison(op: Operator) -> bool {
    matches!(
        op,
        Operator::Less
            | Operator::Greater
            | Operator::LessEqual
            | Operator::GreaterEqual
            | Operator::Equal
            | Operator::NotEqual
    )
}
