//! Functions of numbers and bits. Source: SCL reference, numbers, bits, rounding, conversions.

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::scl::ast::{Argument as Given, BinaryOp as NodeOp, Expr as Node};
use plcc_syntax::{Class, Elementary};

use super::coerce::has_call;
use super::complex::is_dtl;
use super::convert::{self, converted};
use super::expression::constant_expr;
use super::function::{Kind, Row};
use super::message::described;
use super::numeric::{self, Shape};
use super::pins::Pins;
use super::text::{is_wide_text, several_bytes, short};
use super::value::Value;
use super::{Rules, constant};
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_binding::rewrite;
use plcc_model::scl::{BinaryOp, Conversion, Expr, ExprKind, Function, UnaryOp};
use plcc_model::types::DataType;

impl SclBinder<'_, '_> {
    pub fn number_function(
        &mut self,
        ctx: &mut SclBlock,
        row: &Row,
        suffix: Option<Elementary>,
        pins: &Pins,
        span: Span,
    ) -> Option<Value> {
        let expr = match row.kind {
            Kind::Float(function) => self.float_function(ctx, function, suffix, pins.get("IN")?, span),
            Kind::Absolute => {
                let (mut values, ty) = self.alike(ctx, &[pins.get("IN")?], suffix)?;
                let operand = values.pop()?;
                self.number_wanted(&operand)?;
                let kind = ExprKind::Unary { op: UnaryOp::Abs, operand: Box::new(operand) };
                Some(Expr { kind, ty, span })
            }
            Kind::Extreme(op) => {
                let nodes = pins.numbered("IN1");
                let values: Vec<Option<Value>> = nodes.iter().map(|node| self.value(ctx, node)).collect();
                let values: Vec<Value> = values.into_iter().collect::<Option<_>>()?;
                if let [only] = values.as_slice() {
                    let text = self.program.globals.text(only.span());
                    self.refuse(
                        Code::MissingParameter,
                        pins.name,
                        &format!("{} chooses among several values, but only `{text}` is given", row.name),
                        "`IN2` is missing",
                        "add `IN2 := …`",
                    );
                    return None;
                }
                if let Some(kind) = ordered_kind(&values) {
                    let name = if op == BinaryOp::Min { "MIN" } else { "MAX" };
                    let mut values = values.into_iter();
                    let mut best = values.next()?;
                    for value in values {
                        best = self.instruction_value(ctx, &format!("{name}_{kind}"), vec![best, value], span)?;
                    }
                    return Some(best);
                }
                let (values, ty) = self.alike_values(ctx, values, suffix)?;
                let fold = |left: Expr, right: Expr| Expr {
                    kind: ExprKind::Binary { op, left: Box::new(left), right: Box::new(right) },
                    ty,
                    span,
                };
                values.into_iter().reduce(fold)
            }
            Kind::Limit => {
                let nodes = [pins.get("MN")?, pins.get("IN")?, pins.get("MX")?];
                let values = nodes.map(|node| self.value(ctx, node));
                let values: Vec<Value> = values.into_iter().collect::<Option<_>>()?;
                self.check_limits(&values);
                if let Some(kind) = ordered_kind(&values) {
                    return self.instruction_value(ctx, &format!("LIMIT_{kind}"), values, span);
                }
                let (arguments, ty) = self.alike_values(ctx, values, suffix)?;
                Some(computed(Function::Limit, arguments, ty, span))
            }
            Kind::Select => {
                let selector = self.of_type(ctx, pins.get("G")?, Elementary::Bool);
                let values = [pins.get("IN0")?, pins.get("IN1")?].map(|node| self.value(ctx, node));
                let values: Vec<Value> = values.into_iter().collect::<Option<_>>()?;
                if let Some(kind) = complex_kind(&values) {
                    let inputs = std::iter::once(Value::Elementary(selector?)).chain(values).collect();
                    return self.instruction_value(ctx, &format!("SEL_{kind}"), inputs, span);
                }
                let (mut arguments, ty) = self.alike_values(ctx, values, suffix)?;
                arguments.insert(0, selector?);
                Some(computed(Function::Select, arguments, ty, span))
            }
            Kind::Mux => return self.mux(ctx, suffix, pins, span),
            Kind::NormX => {
                let nodes = [pins.get("MIN")?, pins.get("VALUE")?, pins.get("MAX")?];
                let (arguments, ty) = self.alike(ctx, &nodes, None)?;
                self.number_wanted(arguments.first()?)?;
                let result = suffix.unwrap_or(if ty == Elementary::Lreal { ty } else { Elementary::Real });
                self.float_suffix(row, result, pins.name)?;
                self.check_scale(&arguments, "1.0 - the result");
                Some(computed(Function::NormX, arguments, result, span))
            }
            Kind::ScaleX => {
                let value = self.float_value(ctx, pins.get("VALUE")?, None);
                let (mut arguments, ty) = self.alike(ctx, &[pins.get("MIN")?, pins.get("MAX")?], suffix)?;
                self.number_wanted(arguments.first()?)?;
                arguments.insert(1, value?);
                self.check_scale(&arguments, "1.0 - the value");
                Some(computed(Function::ScaleX, arguments, ty, span))
            }
            Kind::Round => self.round(ctx, row, suffix, pins, span),
            Kind::Shift(op) => self.shift(ctx, op, suffix, pins, span),
            Kind::Swap => {
                let value = self.bits_value(ctx, pins.get("IN")?, suffix)?;
                let ty = value.ty;
                Some(computed(Function::Swap, vec![value], ty, span))
            }
            Kind::Encode => {
                let value = self.bits_value(ctx, pins.get("IN")?, None)?;
                Some(computed(Function::Encode, vec![value], Elementary::Int, span))
            }
            Kind::BitSum => {
                let value = self.bits_value(ctx, pins.get("IN")?, None)?;
                Some(computed(Function::BitSum, vec![value], Elementary::Int, span))
            }
            Kind::Decode => {
                let ty = suffix.unwrap_or(Elementary::Dword);
                if ty.class() != Class::Bits || ty == Elementary::Bool {
                    return self.bad_suffix(row, ty, pins.name);
                }
                let value = self.count_value(ctx, pins.get("IN")?, "write the number of the bit, from 0")?;
                Some(computed(Function::Decode, vec![value], ty, span))
            }
            Kind::IsValid => {
                let value = self.float_value(ctx, pins.get("IN")?, None)?;
                Some(computed(Function::IsValid, vec![value], Elementary::Bool, span))
            }
            _ => None,
        };
        expr.map(Value::Elementary)
    }

    fn float_function(
        &mut self,
        ctx: &mut SclBlock,
        function: Function,
        suffix: Option<Elementary>,
        node: &Node,
        span: Span,
    ) -> Option<Expr> {
        let value = self.float_value(ctx, node, suffix)?;
        self.check_domain(function, &value);
        let ty = value.ty;
        Some(computed(function, vec![value], ty, span))
    }

    /// A value as a float: LREAL stays, everything else converts to REAL.
    fn float_value(&mut self, ctx: &mut SclBlock, node: &Node, suffix: Option<Elementary>) -> Option<Expr> {
        let value = self.value(ctx, node)?;
        let ty = match (suffix, Shape::of(&value)) {
            (Some(ty), _) if ty.is_float() => ty,
            (_, Shape::Of(Elementary::Lreal)) => Elementary::Lreal,
            // A computation with constants alone is as exact as the CPU allows.
            (_, Shape::Real) => constant::default_type(ctx.scope.rules, &Constant::Real(0.0)),
            // Also of a DINT, which TIA only converts to LREAL.
            (_, Shape::Of(ty)) if ty.is_integer() => {
                let expr = self.own_type(ctx, value)?;
                return convert::explicit_expr(ctx.scope.rules, expr, Elementary::Real);
            }
            _ => Elementary::Real,
        };
        self.convert(ctx, value, ty)
    }

    /// A value as a bit string: with its own type, or that of the suffix.
    fn bits_value(&mut self, ctx: &mut SclBlock, node: &Node, suffix: Option<Elementary>) -> Option<Expr> {
        let value = self.value(ctx, node)?;
        let ty = match (suffix, Shape::of(&value)) {
            (Some(ty), _) => ty,
            (None, Shape::Of(ty)) if ty != Elementary::Bool => match numeric::bit_string(Rules::Tia1500, ty) {
                Some(bits) if bits == ty => ty,
                Some(bits) => {
                    let expr = self.own_type(ctx, value)?;
                    return Some(converted(expr, Conversion::Bits { checked: false }, bits));
                }
                None => Elementary::Dword,
            },
            _ => Elementary::Dword,
        };
        self.convert(ctx, value, ty)
    }

    /// A count: an integer of any type. `help`: what to write instead of a negative one.
    fn count_value(&mut self, ctx: &mut SclBlock, node: &Node, help: &str) -> Option<Expr> {
        let value = self.value(ctx, node)?;
        if let Value::Constant(Constant::Integer { value: count, .. }, span) = &value
            && *count < 0
        {
            let span = *span;
            self.program.report(
                Diagnostic::new(Code::ShiftCount, span, "this number is negative")
                    .label("0 or more is expected")
                    .help(help),
            );
            return None;
        }
        match Shape::of(&value) {
            Shape::Of(ty) if ty.is_integer() => self.own_type(ctx, value),
            // A bit string counts with its value.
            Shape::Of(ty) if ty.class() == Class::Bits && ty != Elementary::Bool => {
                let expr = self.own_type(ctx, value)?;
                let target = match ty.bits() {
                    8 => Elementary::Usint,
                    16 => Elementary::Uint,
                    32 => Elementary::Udint,
                    _ => Elementary::Ulint,
                };
                Some(converted(expr, Conversion::Bits { checked: false }, target))
            }
            _ => {
                let is_long = matches!(&value, Value::Constant(Constant::Integer { value: count, .. }, _) if *count > i128::from(i16::MAX));
                let wide = is_long && !ctx.scope.rules.is_300();
                self.convert(ctx, value, if wide { Elementary::Udint } else { Elementary::Int })
            }
        }
    }

    fn mux(&mut self, ctx: &mut SclBlock, suffix: Option<Elementary>, pins: &Pins, span: Span) -> Option<Value> {
        let selector = self.count_value(ctx, pins.get("K")?, "write the number of an input: 0 for IN0");
        let mut nodes = pins.numbered("IN0");
        let otherwise = pins.get("INELSE");
        if let Some(selector) = &selector {
            self.check_selector(selector, "IN", nodes.len(), otherwise.map(|node| node.span));
        }
        nodes.extend(otherwise);
        let values: Vec<Option<Value>> = nodes.iter().map(|node| self.value(ctx, node)).collect();
        let values: Vec<Value> = values.into_iter().collect::<Option<_>>()?;
        if let Some(kind) = complex_kind(&values) {
            return self.mux_by_selection(ctx, kind, selector?, values, otherwise.is_some(), span);
        }
        let (mut arguments, ty) = self.alike_values(ctx, values, suffix)?;
        arguments.insert(0, selector?);
        let function = Function::Mux { has_else: otherwise.is_some() };
        Some(Value::Elementary(computed(function, arguments, ty, span)))
    }

    /// Warns of NORM_X and SCALE_X with constants of which MAX is not the greater one: they do not compute then. `reversed`: what counts the
    /// other way. Source: LAD/FBD reference, C.11.
    fn check_scale(&mut self, arguments: &[Expr], reversed: &str) {
        let number = |limit: &Expr| match limit.kind {
            ExprKind::Const(bits) if limit.ty == Elementary::Real => Some(f64::from(f32::from_bits(bits as u32))),
            ExprKind::Const(bits) if limit.ty == Elementary::Lreal => Some(f64::from_bits(bits)),
            ExprKind::Const(bits) if limit.ty.is_integer() => Some(constant::integer(limit.ty, bits) as f64),
            _ => None,
        };
        let [low, _, high] = arguments else { return };
        if let Some((least, greatest)) = number(low).zip(number(high))
            && least >= greatest
        {
            let help = match least > greatest {
                true => format!("exchange them; for the other direction use {reversed}"),
                false => "write two limits that differ".to_owned(),
            };
            let globals = &self.program.globals;
            let (span, low, high) = (low.span, globals.text(low.span), globals.text(high.span));
            self.refuse(
                Code::AlwaysSame,
                span,
                &format!("MIN is `{low}`, which is not below MAX, `{high}`"),
                "nothing is computed, and ENO is FALSE",
                &help,
            );
        }
    }

    /// MUX of values that are not single values: INELSE, unless K is the number of an input.
    fn mux_by_selection(
        &mut self,
        ctx: &mut SclBlock,
        kind: &str,
        selector: Expr,
        mut values: Vec<Value>,
        has_else: bool,
        span: Span,
    ) -> Option<Value> {
        if !has_else || has_call(&selector) {
            let (label, help) = if has_else {
                ("K is evaluated once for each input", "assign K to a variable first")
            } else {
                ("INELSE is missing", "add `INELSE := …`, the value for all other numbers")
            };
            self.refuse(Code::OperandKind, span, "this MUX of texts or dates cannot be computed", label, help);
            return None;
        }
        let mut result = values.pop()?;
        let inputs = values.len();
        for (number, value) in values.into_iter().enumerate().rev() {
            // A separate MUX, so that a K without an input is an error here as well.
            let flags = (0..=inputs).map(|at| constant_expr(u64::from(at == number), Elementary::Bool, span));
            let arguments = std::iter::once(selector.clone()).chain(flags).collect();
            let meant = computed(Function::Mux { has_else: true }, arguments, Elementary::Bool, span);
            let given = vec![Value::Elementary(meant), result, value];
            result = self.instruction_value(ctx, &format!("SEL_{kind}"), given, span)?;
        }
        Some(result)
    }

    fn round(
        &mut self,
        ctx: &mut SclBlock,
        row: &Row,
        suffix: Option<Elementary>,
        pins: &Pins,
        span: Span,
    ) -> Option<Expr> {
        let ty = suffix.unwrap_or(Elementary::Dint);
        let value = self.float_value(ctx, pins.get("IN")?, None)?;
        if !ty.is_integer() && (!ty.is_float() || ctx.scope.rules.is_300()) {
            return self.bad_suffix(row, ty, pins.name);
        }
        self.check_converted(&value, ty);
        let conversion = convert::rounding(ctx.scope.rules, row.name)?;
        Some(Expr { span, ..convert::rounded(value, conversion, ty) })
    }

    /// Shifts and rotates. In the classic form integers are bit strings, so zeros are shifted in.
    fn shift(
        &mut self,
        ctx: &mut SclBlock,
        op: BinaryOp,
        suffix: Option<Elementary>,
        pins: &Pins,
        span: Span,
    ) -> Option<Expr> {
        let value = self.value(ctx, pins.get("IN")?);
        let count = self.count_value(ctx, pins.get("N")?, "for the other direction call the other function");
        let value = value?;
        let ty = match (suffix, Shape::of(&value)) {
            (Some(ty), _) | (None, Shape::Of(ty)) => ty,
            _ => Elementary::Dword,
        };
        let possible = (ty.class() == Class::Bits && ty != Elementary::Bool) || ty.is_integer();
        if !possible {
            let is = described(&value);
            self.wrong_type(value.span(), &is, "a bit string or an integer", None);
            return None;
        }
        // A constant without a type may still take the type of the target.
        if let Some(count) = count.as_ref().filter(|_| suffix.is_some() || !Shape::of(&value).is_untyped()) {
            self.check_shift(op, value.span(), ty, count);
        }
        let left = self.convert(ctx, value, ty)?;
        let bits = numeric::bit_string(Rules::Tia1500, ty).filter(|bits| *bits != ty);
        let make = |left: Expr, count: Expr| {
            let ty = left.ty;
            Expr { kind: ExprKind::Binary { op, left: Box::new(left), right: Box::new(count) }, ty, span }
        };
        // The box shifts the sign in, as SSI and SSD do; the function of SCL does not. Source: LAD/FBD reference, C.14.
        let keeps_sign = ctx.scope.is_network() && op == BinaryOp::ShiftRight;
        Some(match bits {
            Some(bits) if ctx.scope.rules.is_300() && !keeps_sign => {
                let pattern = Conversion::Bits { checked: false };
                converted(make(converted(left, pattern, bits), count?), pattern, ty)
            }
            _ => make(left, count?),
        })
    }

    /// Warns of a shift by a constant of at least the width: no bit keeps its value.
    fn check_shift(&mut self, op: BinaryOp, value: Span, ty: Elementary, count: &Expr) {
        let ExprKind::Const(number) = count.kind else { return };
        let (number, width) = (constant::integer(count.ty, number), ty.bits());
        if number < i128::from(width) || !matches!(op, BinaryOp::ShiftLeft | BinaryOp::ShiftRight) {
            return;
        }
        let text = self.program.globals.text(value);
        let title = format!("a shift by {number} moves all {width} bits of `{text}` out");
        let mut message = Diagnostic::new(Code::ShiftCount, count.span, title)
            .label(format!("{} has {width} bits", ty.name()))
            .help(format!("write a number from 1 to {}", width - 1));
        message.severity = Severity::Warning;
        self.program.report(message);
    }

    /// Values converted to one type: that of the suffix, or the widest of their own.
    fn alike(
        &mut self,
        ctx: &mut SclBlock,
        nodes: &[&Node],
        suffix: Option<Elementary>,
    ) -> Option<(Vec<Expr>, Elementary)> {
        let values: Vec<Option<Value>> = nodes.iter().map(|node| self.value(ctx, node)).collect();
        let values: Vec<Value> = values.into_iter().collect::<Option<_>>()?;
        self.alike_values(ctx, values, suffix)
    }

    fn alike_values(
        &mut self,
        ctx: &mut SclBlock,
        values: Vec<Value>,
        suffix: Option<Elementary>,
    ) -> Option<(Vec<Expr>, Elementary)> {
        let ty = match suffix {
            Some(ty) => ty,
            None => self.widest(ctx, &values)?,
        };
        let bound: Vec<Option<Expr>> = values.into_iter().map(|value| self.convert(ctx, value, ty)).collect();
        Some((bound.into_iter().collect::<Option<_>>()?, ty))
    }

    /// The type that can hold all of the values; reports values that do not go together.
    fn widest(&mut self, ctx: &SclBlock, values: &[Value]) -> Option<Elementary> {
        let rules = ctx.scope.rules;
        let mut shapes: Vec<(Shape, &Value)> = values.iter().map(|value| (Shape::of(value), value)).collect();
        // Constants without a type follow the others; what is not a single value is compared with the type of the others.
        shapes.sort_by_key(|(shape, _)| match shape {
            Shape::Of(_) => 0,
            Shape::Integer(_) | Shape::Real | Shape::Letter => 1,
            Shape::Other => 2,
        });
        let mut widest: Option<Shape> = None;
        for (shape, value) in shapes {
            let joined = match (widest, shape) {
                (_, Shape::Other) => None,
                (None, shape) => Some(shape),
                (Some(Shape::Of(a)), Shape::Of(b)) if a == b => Some(shape),
                (Some(Shape::Of(a)), Shape::Of(b)) if a.class() == Class::Bits && b.class() == Class::Bits => {
                    Some(Shape::Of(if a.bits() >= b.bits() { a } else { b }))
                }
                // A bit string, duration or date next to a constant keeps its type.
                (Some(Shape::Of(a)), Shape::Integer(_)) if !a.is_float() => Some(Shape::Of(a)),
                (Some(Shape::Of(a)), Shape::Letter) => Some(Shape::Of(a)),
                (Some(Shape::Letter), Shape::Letter) => Some(shape),
                (Some(before), shape) => numeric::common(rules, before, shape).map(Shape::Of),
            };
            if joined.is_none() {
                let is = described(value);
                let (wanted, help) = match widest {
                    Some(Shape::Of(ty)) => {
                        let text = self.program.globals.text(value.span());
                        (ty.name().to_string(), rewrite::of_constant(ty, &text, rewrite::Form::Scl))
                    }
                    _ => ("a single value".to_string(), None),
                };
                self.wrong_type(value.span(), &is, &wanted, help);
                return None;
            }
            widest = joined;
        }
        match widest? {
            Shape::Of(ty) => Some(ty),
            Shape::Integer(value) => Some(constant::default_type(rules, &Constant::Integer { value, based: false })),
            Shape::Real => Some(constant::default_type(rules, &Constant::Real(0.0))),
            Shape::Letter | Shape::Other => Some(Elementary::Char),
        }
    }

    fn number_wanted(&mut self, value: &Expr) -> Option<()> {
        if value.ty.is_integer() || value.ty.is_float() {
            return Some(());
        }
        let text = self.program.globals.text(value.span);
        let help = match value.ty {
            Elementary::Time => Some(format!("as a number of milliseconds it is `TIME_TO_DINT({text})`")),
            _ => None,
        };
        self.wrong_type(value.span, &format!("of type {}", value.ty.name()), "a number", help);
        None
    }

    fn float_suffix(&mut self, row: &Row, ty: Elementary, name: Span) -> Option<()> {
        if ty.is_float() { Some(()) } else { self.bad_suffix(row, ty, name) }
    }

    fn bad_suffix<T>(&mut self, row: &Row, ty: Elementary, name: Span) -> Option<T> {
        self.program.report(
            Diagnostic::new(Code::TypeMismatch, name, format!("{} has no variant for type {}", row.name, ty.name()))
                .label("this type cannot follow the name")
                .help(format!("write {} alone, and convert its result", row.name)),
        );
        None
    }

    /// `X_TO_Y(value)`, `TO_Y(value)`.
    pub fn conversion(
        &mut self,
        ctx: &mut SclBlock,
        from: Option<Elementary>,
        to: Elementary,
        given: &[Given],
        name: Span,
        span: Span,
    ) -> Option<Value> {
        let node = self.only_argument(ctx, given, span)?;
        let told = self.program.globals.report.diagnostics.len();
        let value = match from {
            Some(from) => self.of_type(ctx, node, from)?,
            None => {
                let value = self.value(ctx, node)?;
                // Of a text, or a date of several words: `TO_INT(#text)`, `TO_DATE(#dtl)`.
                match several_bytes(&value) {
                    Some(own) => match self.converted_text(ctx, &own, short(to.name()), value, name, span) {
                        Ok(value) => return value,
                        Err(value) => self.own_type(ctx, value)?,
                    },
                    None => self.own_type(ctx, value)?,
                }
            }
        };
        // A constant that does not even fit the type before is reported.
        if told == self.program.globals.report.diagnostics.len() {
            self.check_converted(&value, to);
        }
        let from = value.ty;
        match convert::explicit_expr(ctx.scope.rules, value, to) {
            Some(expr) => Some(Value::Elementary(Expr { span, ..expr })),
            None => {
                self.program.report(
                    Diagnostic::new(
                        Code::TypeMismatch,
                        span,
                        format!("there is no conversion from {} to {}", from.name(), to.name()),
                    )
                    .label("SCL does not have this function")
                    .help("convert through a type between them, for example DINT or DWORD"),
                );
                None
            }
        }
    }

    /// `BCD_TO_INT` and the other BCD conversions.
    pub fn bcd_conversion(&mut self, ctx: &mut SclBlock, name: &str, given: &[Given], span: Span) -> Option<Value> {
        let node = self.only_argument(ctx, given, span)?;
        let (from, conversion, to) = convert::bcd(ctx.scope.rules, name)?;
        let value = self.of_type(ctx, node, from)?;
        Some(Value::Elementary(Expr { span, ..converted(value, conversion, to) }))
    }

    /// The argument of a function of one argument, whatever its name.
    pub fn only_argument<'n>(&mut self, ctx: &mut SclBlock, given: &'n [Given], span: Span) -> Option<&'n Node> {
        if let [Given { output: false, value: Some(value), .. }] = given {
            return Some(value);
        }
        self.program.report(
            Diagnostic::new(
                if given.len() > 1 { Code::SurplusOperand } else { Code::MissingParameter },
                span,
                "this function needs one value",
            )
            .label(format!("{} arguments are given", given.len()))
            .help("write the value in parentheses after the name"),
        );
        self.note_arguments(ctx, given);
        None
    }

    /// An operator as a function.
    pub fn operator_function(&mut self, ctx: &mut SclBlock, op: NodeOp, pins: &Pins, span: Span) -> Option<Value> {
        let (left, right) = (self.value(ctx, pins.get("IN1")?), self.value(ctx, pins.get("IN2")?));
        self.operation(ctx, op, pins.name, left?, right?, span)
    }

    /// T_ADD, T_SUB and T_DIFF of bound operands.
    pub(super) fn operation(
        &mut self,
        ctx: &mut SclBlock,
        op: NodeOp,
        name: Span,
        left: Value,
        right: Value,
        span: Span,
    ) -> Option<Value> {
        let (left, right) = match op {
            NodeOp::Subtract => match self.mixed_difference(ctx, left, right, span) {
                Ok(value) => return value,
                Err(both) => both,
            },
            _ => (left, right),
        };
        // T_DIFF yields a TIME on every CPU.
        if op == NodeOp::Subtract && Self::has_short_difference(ctx.scope.rules, &left, &right) {
            return self.date_difference(ctx, left, right, Elementary::Time, span);
        }
        // A result that does not fit the type is 0. Source: S7-1200 reference, date and time; decision 67.
        let subtract = op == NodeOp::Subtract;
        let of = |value: &Value| match Shape::of(value) {
            Shape::Of(ty) => Some(ty),
            _ => None,
        };
        match (of(&left), of(&right)) {
            (Some(Elementary::Time), Some(Elementary::Time)) => {
                let name = if subtract { "SUB_TIME_TIME" } else { "ADD_TIME_TIME" };
                return self.instruction_value(ctx, name, vec![left, right], span);
            }
            (Some(Elementary::Ltime | Elementary::Time), Some(Elementary::Ltime | Elementary::Time)) => {
                let name = if subtract { "SUB_LTIME_LTIME" } else { "ADD_LTIME_LTIME" };
                return self.instruction_value(ctx, name, vec![left, right], span);
            }
            (Some(Elementary::Ldt), Some(Elementary::Ltime | Elementary::Time)) => {
                let back = Value::Constant(Constant::Typed { ty: Elementary::Bool, bits: subtract.into() }, span);
                return self.instruction_value(ctx, "ADD_LDT_LTIME", vec![left, right, back], span);
            }
            _ => {}
        }
        self.binary_value(ctx, op, name, left, right, span)
    }
}

/// The block for MIN, MAX and LIMIT of values that are not single values.
fn ordered_kind(values: &[Value]) -> Option<&'static str> {
    let of_variables = values.iter().filter_map(own_kind).find(|kind| *kind != "DT");
    of_variables.or_else(|| constant_kind(values)).filter(|kind| *kind != "DT")
}

/// The block for SEL of values that are not single values.
fn complex_kind(values: &[Value]) -> Option<&'static str> {
    values.iter().find_map(own_kind).or_else(|| constant_kind(values))
}

/// What a value is that is not a single value; a constant of a date is what the others are.
fn own_kind(value: &Value) -> Option<&'static str> {
    match value {
        Value::Complex { ty: DataType::DateAndTime, .. } => Some("DT"),
        Value::Complex { ty: DataType::Struct(structure), .. } if is_dtl(structure) => Some("DTL"),
        value if is_wide_text(value) => Some("WSTRING"),
        value if is_long_text(value) => Some("STRING"),
        _ => None,
    }
}

/// What constants of dates are if there is nothing else.
fn constant_kind(values: &[Value]) -> Option<&'static str> {
    let of_dtl = |value: &Value| matches!(value, Value::Constant(Constant::Dtl(_), _));
    let is_date = |value: &Value| of_dtl(value) || matches!(value, Value::Constant(Constant::DateAndTime(_), _));
    let kind = if values.iter().any(of_dtl) { "DTL" } else { "DT" };
    (!values.is_empty() && values.iter().all(is_date)).then_some(kind)
}

/// True of a text of more than one character.
fn is_long_text(value: &Value) -> bool {
    match value {
        Value::Complex { ty, .. } => matches!(ty, DataType::String(_)),
        Value::Constant(Constant::Text { .. }, _) => Shape::of(value) != Shape::Letter,
        _ => false,
    }
}

fn computed(function: Function, arguments: Vec<Expr>, ty: Elementary, span: Span) -> Expr {
    Expr { kind: ExprKind::Function { function, arguments }, ty, span }
}
