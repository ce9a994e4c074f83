//! Boxes that compute: operators, CALCULATE, INC and DEC, functions of SCL. Source: LAD/FBD reference C.8, C.9, C.13, C.14.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::network::ast::{Element, PinValue, Target, TemplateKey};
use plcc_syntax::network::elements::Typing;
use plcc_syntax::scl::ast::{
    AssignOp, BinaryOp as Operator, Expr as Node, ExprKind as NodeKind, Literal, UnaryOp as Sign,
};
use plcc_syntax::{Class, Elementary};

use super::bits::{argument, call_node};
use super::pins::{connected, inverted};
use super::sheet::Sheet;
use crate::bind::network::NetworkBinder;
use crate::bind::scl::assign::value_of;
use crate::bind::scl::convert::converted;
use crate::bind::scl::expression::{binary_expr, binary_op, constant_expr};
use crate::bind::scl::numeric::{self, Shape};
use crate::bind::scl::value::Value;
use crate::bind::scl::{Intent, SclBlock, constant};
use plcc_binding::constant::Constant;
use plcc_binding::{fold, similar};
use plcc_model::scl::{BinaryOp, Conversion, Expr, ExprKind, UnaryOp};

impl NetworkBinder<'_, '_> {
    /// The type that a setting names; none if it is missing, found from the operands, or not elementary.
    pub fn template_type(&self, element: &Element, keys: &[TemplateKey]) -> Option<Elementary> {
        let template = keys.iter().find_map(|key| element.template(*key))?;
        Elementary::from_word(&template.value.trim().to_ascii_uppercase())
    }

    /// Warns of data types in the settings of an element that nothing defines: the operands decide in their place. Names of the system
    /// have a `_`; a slip was reported where it was read.
    pub fn check_templates(&mut self, element: &Element) {
        const OTHERS: [&str; 6] = ["STRING", "WSTRING", "DTL", "VARIANT", "ANY", "STRUCT"];
        for template in &element.templates {
            let name = template.value.trim().trim_matches(['"', '\'']);
            let upper = name.to_ascii_uppercase();
            let is_word = upper.bytes().all(|byte| byte.is_ascii_alphanumeric()) && !upper.is_empty();
            let is_known = Elementary::from_word(&upper).is_some()
                || OTHERS.contains(&upper.as_str())
                || self.program.globals.names.types.contains_key(&fold(name))
                || self.program.globals.names.symbols.contains_key(&fold(name));
            let is_slip = || similar(name, Elementary::ALL.iter().map(|ty| ty.name())).is_some();
            if !is_word || is_known || is_slip() || matches!(template.key, TemplateKey::Card | TemplateKey::Other) {
                continue;
            }
            self.program.report(
                Diagnostic::new(Code::AttributeValue, template.span, format!("no data type has the name `{name}`"))
                    .label("has no effect: the operands decide")
                    .help("write the data type that the element works in, such as `Int`"),
            );
        }
    }

    /// The type that an element works in.
    fn working_type(&self, element: &Element) -> Option<Elementary> {
        self.template_type(
            element,
            &[TemplateKey::Source, TemplateKey::Value, TemplateKey::Destination, TemplateKey::Time],
        )
    }

    /// An integer whose value is known now.
    pub fn constant_integer(&mut self, ctx: &SclBlock, node: &Node) -> Option<i128> {
        match self.program.globals.constant(&ctx.block.bound.constants, node)? {
            Constant::Integer { value, .. } => Some(value),
            Constant::Typed { ty, bits } if !ty.is_float() => Some(constant::integer(ty, bits)),
            _ => {
                let text = self.program.globals.text(node.span);
                self.scl().wrong_type(node.span, &format!("`{text}`"), "an integer", None);
                None
            }
        }
    }

    /// The values of inputs, in the type of the element if its settings name one.
    pub fn typed_inputs(
        &mut self,
        ctx: &mut SclBlock,
        sheet: &mut Sheet,
        at: usize,
        names: &[&str],
    ) -> Option<Vec<Value>> {
        let ty = self.working_type(sheet.element(at));
        let mut values = Vec::with_capacity(names.len());
        for name in names {
            let value = self.input(ctx, sheet, at, name);
            values.push(match (value, ty) {
                (Some(value), Some(ty)) => self.scl().convert(ctx, value, ty).map(Value::Elementary),
                (value, _) => value,
            });
        }
        values.into_iter().collect()
    }

    /// The common type of values; with a message if there is none.
    pub fn common_type(&mut self, ctx: &SclBlock, values: &[&Value], span: Span) -> Option<Elementary> {
        let rules = ctx.scope.rules;
        let mut shape: Option<Shape> = None;
        for value in values {
            let next = Shape::of(value);
            shape = match shape {
                None => Some(next),
                Some(before) if before == next => Some(before),
                Some(before) => numeric::common(rules, before, next).map(Shape::Of),
            };
            shape?;
        }
        let ty = match shape? {
            Shape::Of(ty) => Some(ty),
            Shape::Integer(_) => Some(Elementary::Dint),
            Shape::Real => Some(Elementary::Real),
            Shape::Letter => Some(Elementary::Char),
            Shape::Other => None,
        };
        if ty.is_none() {
            self.no_type(span);
        }
        ty
    }

    /// The data type of an element is not known.
    pub fn no_type(&mut self, span: Span) {
        let text = self.program.globals.text(span);
        self.program.report(
            Diagnostic::new(Code::ElementType, span, format!("the data type of `{text}` is not known"))
                .label("its operands do not have one type")
                .help("set the type of the element, or use operands of one type"),
        );
    }

    /// The numbered inputs of an element, in order.
    fn numbered_inputs(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<Vec<Value>> {
        let element = sheet.element(at);
        let mut pins: Vec<(u32, &plcc_syntax::network::ast::Pin)> = element
            .pins
            .iter()
            .filter(|pin| !pin.output && pin.value != PinValue::Open)
            .filter_map(|pin| Some((pin.name.strip_prefix("in")?.parse().ok()?, pin)))
            .collect();
        pins.sort_by_key(|(number, _)| *number);
        let values: Vec<Option<Value>> = pins.into_iter().map(|(_, pin)| self.pin_value(ctx, sheet, pin)).collect();
        values.into_iter().collect()
    }

    /// The type of a variable that is connected to an output; binds nothing.
    pub fn output_type(&mut self, ctx: &mut SclBlock, element: &Element, name: &str) -> Option<Elementary> {
        let (_, pin) = super::pins::outputs(element, name).next()?;
        let PinValue::Operand(node) = &pin.value else { return None };
        let access = self.scl().quietly(ctx, |binder, ctx| binder.access(ctx, node, Intent::Write));
        access?.elementary()
    }

    /// ADD, SUB, MUL, DIV, MOD, EXPT, AND, OR, XOR: from the first input to the last.
    pub fn operator_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, op: &str) -> Option<()> {
        let element = sheet.element(at);
        self.boxed(ctx, sheet, at, |binder, ctx, sheet| {
            let values = binder.numbered_inputs(ctx, sheet, at)?;
            let value = binder.operated(ctx, element, op, values)?;
            binder.box_result(ctx, sheet, at, value)
        })
    }

    fn operated(&mut self, ctx: &mut SclBlock, element: &Element, op: &str, values: Vec<Value>) -> Option<Value> {
        let span = element.span;
        let operator = match op {
            "+" => Operator::Add,
            "-" => Operator::Subtract,
            "*" => Operator::Multiply,
            "/" => Operator::Divide,
            "MOD" => Operator::Modulo,
            "AND" => Operator::And,
            "OR" => Operator::Or,
            "XOR" => Operator::Xor,
            _ => Operator::Power,
        };
        let ty = self.working_type(element).filter(|ty| works_in(operator, *ty));
        let ty = ty.or_else(|| self.type_of_all(ctx, element, operator, &values));
        let mut values = values.into_iter();
        let mut result = values.next()?;
        for value in values {
            result = match (ty, operator) {
                (Some(ty), _) if operator != Operator::Power => {
                    let left = self.scl().convert(ctx, result, ty)?;
                    let right = self.scl().convert(ctx, value, ty)?;
                    if matches!(operator, Operator::Divide | Operator::Modulo) {
                        self.scl().check_divisor(&right);
                    }
                    Value::Elementary(binary_expr(binary_op(operator), left, right, ty, span))
                }
                (_, Operator::Power) => {
                    let ty =
                        ty.or_else(|| self.own_type(&result)).filter(|ty| ty.is_float()).unwrap_or(Elementary::Real);
                    let left = self.scl().convert(ctx, result, ty)?;
                    let right = self.scl().exponent(ctx, value, ty)?;
                    Value::Elementary(binary_expr(BinaryOp::Power, left, right, ty, span))
                }
                (_, Operator::And | Operator::Or | Operator::Xor) => {
                    let bits = |value: &Value| {
                        Shape::of(value).elementary().and_then(|ty| numeric::bit_string(ctx.scope.rules, ty))
                    };
                    let Some(ty) = wider(bits(&result), bits(&value)) else {
                        self.no_type(span);
                        return None;
                    };
                    let left = self.scl().convert(ctx, result, ty)?;
                    let right = self.scl().convert(ctx, value, ty)?;
                    Value::Elementary(binary_expr(binary_op(operator), left, right, ty, span))
                }
                _ => self.scl().binary_value(ctx, operator, span, result, value, span)?,
            };
        }
        Some(result)
    }

    /// The one type of the inputs and output of an operator, if none is set. None for times, dates and bit strings, which have no
    /// type for the operation. Source: LAD/FBD reference A.7, C.8.
    fn type_of_all(
        &mut self,
        ctx: &mut SclBlock,
        element: &Element,
        operator: Operator,
        values: &[Value],
    ) -> Option<Elementary> {
        let works = |ty: &Elementary| works_in(operator, *ty);
        let rules = ctx.scope.rules;
        let target = self.output_type(ctx, element, "out").filter(works);
        let (typed, constants): (Vec<Shape>, Vec<Shape>) =
            values.iter().map(Shape::of).partition(|shape| !shape.is_untyped());
        if typed.is_empty() || operator == Operator::Power {
            return target;
        }
        let mut shapes = typed.into_iter().chain(constants);
        let first = shapes.next()?.elementary().filter(works)?;
        let inputs = shapes.try_fold(first, |ty, next| numeric::common(rules, Shape::Of(ty), next))?;
        let all = target.and_then(|target| numeric::common(rules, Shape::Of(inputs), Shape::Of(target)));
        Some(all.unwrap_or(inputs)).filter(works)
    }

    /// Writes the value of a box to `out`. If a single variable is connected there, the value has its type.
    pub fn box_result(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, value: Value) -> Option<()> {
        let value = match value {
            Value::Elementary(expr) => {
                let expr = sheet.keep(ctx, expr);
                let outcome = self.note_result(sheet, &expr);
                sheet.statements.extend(outcome);
                Value::Elementary(expr)
            }
            value => value,
        };
        self.output(ctx, sheet, at, "out", value)
    }

    /// NEG or INV.
    pub fn unary_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, negate: bool) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        self.boxed(ctx, sheet, at, |binder, ctx, sheet| {
            let ty = binder.working_type(element);
            let value = binder.input(ctx, sheet, at, "in")?;
            let ty = ty.or_else(|| binder.own_type(&value)).or_else(|| binder.output_type(ctx, element, "out"));
            let Some(ty) = ty else {
                binder.no_type(span);
                return None;
            };
            let value = binder.scl().convert(ctx, value, ty)?;
            let possible = if negate {
                matches!(ty.class(), Class::Signed | Class::Float | Class::Duration)
            } else {
                matches!(ty.class(), Class::Bits | Class::Signed | Class::Unsigned)
            };
            if !possible {
                binder.impossible_type(element, ty);
                return None;
            }
            let value = if negate {
                Expr { kind: ExprKind::Unary { op: UnaryOp::Negate, operand: Box::new(value) }, ty, span }
            } else {
                inverted(value)
            };
            binder.box_result(ctx, sheet, at, Value::Elementary(value))
        })
    }

    /// An element that does not work with a type.
    pub fn impossible_type(&mut self, element: &Element, ty: Elementary) {
        let text = self.program.globals.text(element.span);
        self.program.report(
            Diagnostic::new(Code::ElementType, element.span, format!("`{text}` does not work with {}", ty.name()))
                .label(format!("no element for values of type {}", ty.name()))
                .help("convert the value first, with CONVERT"),
        );
    }

    /// INC, DEC.
    pub fn step_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, up: bool) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        self.boxed(ctx, sheet, at, |binder, ctx, sheet| {
            let PinValue::Operand(node) = &connected(element, "operand")?.value else { return None };
            let access = binder.scl().access(ctx, node, Intent::Both)?;
            let named = binder.template_type(element, &[TemplateKey::Destination, TemplateKey::Source]);
            let ty = match access.elementary() {
                Some(ty) if ty.is_integer() => ty,
                // An address of bit memory has the type of the element.
                Some(bits) if bits.class() == Class::Bits && named.is_some_and(|ty| is_number(ty, bits)) => {
                    named.unwrap_or(bits)
                }
                Some(ty) => {
                    binder.impossible_type(element, ty);
                    return None;
                }
                None => {
                    binder.no_type(span);
                    return None;
                }
            };
            let value = binder.scl().own_type(ctx, value_of(&access, node.span)?)?;
            let value = as_bits(value, ty);
            let op = if up { BinaryOp::Add } else { BinaryOp::Subtract };
            let value = binary_expr(op, value, constant_expr(1, ty, span), ty, span);
            let value = as_bits(value, access.elementary()?);
            let kind = binder.scl().assignment(ctx, access, Value::Elementary(value))?;
            sheet.push(kind, span);
            Some(())
        })
    }

    /// The type of a function whose inputs are constants, where none is set: that of its output.
    fn type_of_constants(&mut self, ctx: &mut SclBlock, element: &Element) -> Option<Elementary> {
        let typing = typing(element);
        if !typing.follows_output {
            return None;
        }
        let mut inputs =
            element.pins.iter().filter(|pin| !pin.output && pin.name != "en" && typing.converts(&pin.name));
        inputs
            .all(|pin| matches!(&pin.value, PinValue::Operand(node) if is_untyped_number(node)))
            .then(|| self.output_type(ctx, element, "out"))?
            .filter(|ty| ty.bits() > 1)
    }

    /// CALCULATE: the formula over the inputs, each read once.
    pub fn calculate_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let Some(equation) = &element.equation else {
            self.scl().refuse(
                Code::MissingOperand,
                span,
                "CALCULATE has no formula",
                "nothing to compute",
                "enter one: IN1 + IN2",
            );
            return None;
        };
        self.boxed(ctx, sheet, at, |binder, ctx, sheet| {
            let ty = binder.working_type(element).or_else(|| binder.output_type(ctx, element, "out"));
            let mut formula = equation.clone();
            as_in_scl(&mut formula);
            for pin in element.pins.iter().filter(|pin| !pin.output && pin.name.starts_with("in")) {
                let Some(value) = binder.pin_value(ctx, sheet, pin) else { continue };
                let value = match ty {
                    Some(ty) => binder.scl().convert(ctx, value, ty)?,
                    None => binder.scl().own_type(ctx, value)?,
                };
                let node = binder.value_node(ctx, sheet, value);
                substitute(&mut formula, &pin.name, &node);
            }
            let value = binder.scl().value(ctx, &formula)?;
            let value = match ty {
                Some(ty) => Value::Elementary(binder.scl().convert(ctx, value, ty)?),
                None => value,
            };
            binder.box_result(ctx, sheet, at, value)
        })
    }

    /// A function that the file has as a formula: each input keeps its type.
    pub fn formula_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        let element = sheet.element(at);
        let mut formula = element.equation.clone()?;
        self.boxed(ctx, sheet, at, |binder, ctx, sheet| {
            for pin in element.pins.iter().filter(|pin| !pin.output && pin.name.starts_with("in")) {
                let node = binder.pin_node(ctx, sheet, pin)?;
                substitute(&mut formula, &pin.name, &node);
            }
            let value = binder.scl().value(ctx, &formula)?;
            binder.box_result(ctx, sheet, at, value)
        })
    }

    /// A function of SCL with a value. Inputs that have the element's type are first converted to it.
    pub fn function_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, name: &str) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        self.boxed(ctx, sheet, at, |binder, ctx, sheet| {
            let source = binder.template_type(element, &[TemplateKey::Source, TemplateKey::Value]);
            let target = binder.template_type(element, &[TemplateKey::Destination]);
            let source = source.or_else(|| binder.type_of_constants(ctx, element));
            let typing = typing(element);
            let mut arguments = Vec::new();
            // The limits of LIMIT after their conversion; those that are not converted are checked with the call in SCL.
            let (mut low, mut high) = (None, None);
            for pin in element.pins.iter().filter(|pin| !pin.output && pin.value != PinValue::Open && pin.name != "en")
            {
                let ty = match pin.name.as_str() {
                    name if typing.output_pins.contains(&name) => target,
                    name => source.filter(|_| typing.converts(name)),
                };
                let node = match ty {
                    Some(ty) => {
                        let value = binder.pin_value(ctx, sheet, pin)?;
                        let value = binder.scl().convert(ctx, value, ty)?;
                        match (name, pin.name.as_str()) {
                            ("LIMIT", "mn") => low = Some(Value::Elementary(value.clone())),
                            ("LIMIT", "mx") => high = Some(Value::Elementary(value.clone())),
                            _ => {}
                        }
                        binder.value_node(ctx, sheet, value)
                    }
                    None => binder.pin_node(ctx, sheet, pin)?,
                };
                arguments.push(argument(&pin.name, node, false));
            }
            if let (Some(low), Some(high)) = (&low, &high) {
                binder.scl().check_limits(low, high, ["MN", "MX"]);
            }
            let of_output = match typing.named_by_output {
                true => target.or_else(|| binder.output_type(ctx, element, "out")),
                false => None,
            };
            let called = match of_output {
                Some(ty) => format!("{name}_{}", ty.name()),
                None => name.to_string(),
            };
            let call = call_node(&called, arguments, span);
            // T_CONV and T_DIFF have the type of the variable at OUT.
            let output = connected(element, "out").and_then(|_| binder.operand_node(element, "out"));
            let targets: Vec<_> = output.into_iter().map(|node| (node, AssignOp::Set)).collect();
            let value = match binder.scl().value_for_target(ctx, &targets, &call) {
                Some(value) => value?,
                None => binder.scl().call(ctx, &call, false)?,
            };
            binder.box_result(ctx, sheet, at, value)
        })
    }
}

/// A number without a type: `5`, `-5`, `16#FF`.
fn is_untyped_number(node: &Node) -> bool {
    match &node.kind {
        NodeKind::Unary { op: Sign::Plus | Sign::Minus, operand } => is_untyped_number(operand),
        NodeKind::Literal(literal) => matches!(literal, Literal::Integer { .. } | Literal::Real(_)),
        _ => false,
    }
}

/// How a row types the pins of its function.
fn typing(element: &Element) -> Typing {
    match &element.target {
        Target::Element { row, .. } => row.typing,
        Target::Block { .. } => Typing::default(),
    }
}

/// Functions of formulas that are operators in SCL: NEG, INV, EXPT.
fn as_in_scl(formula: &mut Node) {
    match &mut formula.kind {
        NodeKind::Unary { operand, .. } => as_in_scl(operand),
        NodeKind::Binary { left, right, .. } => {
            as_in_scl(left);
            as_in_scl(right);
        }
        NodeKind::Call { callee, arguments } => {
            arguments.iter_mut().filter_map(|argument| argument.value.as_mut()).for_each(as_in_scl);
            let NodeKind::Name(name) = &callee.kind else { return };
            let op_span = callee.span;
            let values: Vec<&Node> = arguments.iter().filter_map(|argument| argument.value.as_ref()).collect();
            let unary = |op, operand: &Node| NodeKind::Unary { op, operand: Box::new(operand.clone()) };
            let kind = match (name.text.to_ascii_uppercase().as_str(), values.as_slice()) {
                ("NEG", [value]) => unary(Sign::Minus, value),
                ("INV", [value]) => unary(Sign::Not, value),
                ("EXPT", [base, exponent]) => NodeKind::Binary {
                    op: Operator::Power,
                    left: Box::new((*base).clone()),
                    right: Box::new((*exponent).clone()),
                    op_span,
                },
                _ => return,
            };
            formula.kind = kind;
        }
        _ => {}
    }
}

/// Puts `value` in place of the name `IN1` in a formula.
fn substitute(formula: &mut Node, name: &str, value: &Node) {
    match &mut formula.kind {
        NodeKind::Name(given) if given.text.eq_ignore_ascii_case(name) => formula.kind = value.kind.clone(),
        NodeKind::Unary { operand, .. } => substitute(operand, name, value),
        NodeKind::Binary { left, right, .. } => {
            substitute(left, name, value);
            substitute(right, name, value);
        }
        NodeKind::Call { arguments, .. } => {
            arguments
                .iter_mut()
                .filter_map(|argument| argument.value.as_mut())
                .for_each(|one| substitute(one, name, value));
        }
        _ => {}
    }
}

/// The same bits in a type of the same length.
fn as_bits(value: Expr, ty: Elementary) -> Expr {
    if value.ty == ty { value } else { converted(value, Conversion::Bits { checked: false }, ty) }
}

/// True if an operator works with this type.
fn works_in(operator: Operator, ty: Elementary) -> bool {
    match operator {
        Operator::And | Operator::Or | Operator::Xor => ty.class() == Class::Bits,
        Operator::Modulo => ty.is_integer(),
        _ => ty.is_integer() || ty.is_float(),
    }
}

/// True of an integer of the width of `bits`.
fn is_number(ty: Elementary, bits: Elementary) -> bool {
    ty.is_integer() && ty.bits() == bits.bits()
}

/// The longer of two types.
fn wider(a: Option<Elementary>, b: Option<Elementary>) -> Option<Elementary> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if a.bits() >= b.bits() { a } else { b }),
        (a, b) => a.or(b),
    }
}
