//! Elementary values in the required type: implicit conversions, and the types of constants. `complex` has the other types.

use plcc_abi::image::BlockKind;
use plcc_binding::constant::Constant;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::walk::{self, Role, Visitor};
use plcc_model::scl::{Access, BinaryOp, Expr, ExprKind, Function};
use plcc_model::types::DataType;
use plcc_model::{BlockKey, Direction, Number};
use plcc_syntax::ast::BlockPrefix;
use plcc_syntax::scl::ast::Expr as Node;
use plcc_syntax::{Class, Elementary};

use super::complex::converts_dates;
use super::convert::{self, Implicit};
use super::expression::constant_expr;
use super::value::Value;
use super::{Rules, bounds, constant, message};
use crate::bind::scl::{SclBinder, SclBlock};

/// Functions of a REAL or LREAL.
const OF_FLOATS: &[&str] = &["SQR", "SQRT", "EXP", "EXPD", "LN", "LOG", "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN"];

/// Functions that choose among values.
const CHOICES: &[&str] = &["SEL", "MUX", "LIMIT", "MIN", "MAX"];

impl SclBinder<'_, '_> {
    /// Binds an expression whose value must have type `ty`, with an implicit conversion if needed.
    pub(in crate::bind) fn of_type(&mut self, ctx: &mut SclBlock, node: &Node, ty: Elementary) -> Option<Expr> {
        let value = self.value(ctx, node)?;
        self.convert(ctx, value, ty)
    }

    /// Converts a bound value to type `ty` if needed; reports a value without an implicit conversion.
    pub(in crate::bind) fn convert(&mut self, ctx: &mut SclBlock, value: Value, ty: Elementary) -> Option<Expr> {
        match value {
            Value::Elementary(expr) => self.implicit(ctx, expr, ty),
            Value::Constant(constant, span) => self.constant_of_type(ctx, &constant, span, ty),
            // Source: SCL reference, absolute operands: the status, as `A T 5` reads it.
            Value::Cell { kind, number, span } if ty == Elementary::Bool => {
                Some(Expr { kind: ExprKind::Cell { kind, number }, ty, span })
            }
            // A DB_ANY holds the number of a data block.
            Value::Block { prefix: BlockPrefix::Db, number: Number::Known(number), span }
                if ty == Elementary::Uint && !ctx.scope.rules.is_300() =>
            {
                ctx.scope.named_dbs.push((number, span));
                Some(constant_expr(number.into(), ty, span))
            }
            other if ty == Elementary::Ldt && converts_dates(ctx.scope.rules) && Self::is_long_date(&other) => {
                self.as_ldt(ctx, other)
            }
            other => {
                let help = match (&other, ty) {
                    (Value::Complex { ty: own @ (DataType::String(_) | DataType::WideString(_)), .. }, _) => {
                        let text = self.program.globals.text(other.span());
                        let wide = if matches!(own, DataType::WideString(_)) { "W" } else { "" };
                        match ty.class() {
                            Class::Signed | Class::Unsigned | Class::Float if ctx.scope.is_network() => {
                                Some(format!("{}, or take one character: `{text}[1]`", message::text_element(&text)))
                            }
                            Class::Signed | Class::Unsigned | Class::Float | Class::Character => Some(format!(
                                "convert it: `{wide}STRING_TO_{}({text})`, or take one character: `{text}[1]`",
                                ty.name()
                            )),
                            Class::Bits if ty == Elementary::Bool && ctx.scope.is_network() => {
                                Some(format!("compare it: `NE_Contact( in1 := {text}, in2 := '' )`, in FBD `Ne`"))
                            }
                            Class::Bits if ty == Elementary::Bool => Some(format!("compare it: `{text} <> ''`")),
                            Class::Bits | Class::Duration | Class::Date => None,
                        }
                    }
                    (Value::Complex { ty: DataType::Struct(structure), .. }, _) => match structure.instance_of {
                        Some((sfb, number)) => {
                            let kind = if sfb { BlockKind::Sfb } else { BlockKind::Fb };
                            Some(self.name_output(BlockKey { kind, number }, ty, other.span()))
                        }
                        None if structure.refers_to.is_none() => {
                            let text = self.program.globals.text(other.span());
                            let mut members = structure.members.iter();
                            let any = members.clone().next();
                            members
                                .find(|member| member.ty == DataType::Elementary(ty))
                                .or(any)
                                .filter(|_| !text.contains(|c: char| c.is_whitespace() || c == '('))
                                .map(|member| format!("name one of its components, as in `{text}.{}`", member.name))
                        }
                        None => None,
                    },
                    _ => None,
                };
                self.wrong_type(other.span(), &message::described(&other), ty.name(), help);
                None
            }
        }
    }

    /// What to write for an instance of `key` where a value of `ty` is expected: an output of this type, else any.
    fn name_output(&mut self, key: BlockKey, ty: Elementary, span: Span) -> String {
        let text = self.program.globals.text(span);
        let bound = self.program.interface(key, span);
        let parameters = bound.as_ref().map_or(&[][..], |bound| bound.interface.parameters.as_slice());
        let mut outputs = parameters.iter().filter(|parameter| parameter.direction == Direction::Output);
        let any = outputs.clone().next();
        match outputs.find(|output| output.ty == DataType::Elementary(ty)).or(any) {
            Some(output) => format!("name one of its outputs, as in `{text}.{}`", output.name),
            None => format!("it has no outputs; name one of its values, as in `{text}.name`"),
        }
    }

    /// A value in its own type; a constant in the type that it has without a partner.
    pub(in crate::bind) fn own_type(&mut self, ctx: &mut SclBlock, value: Value) -> Option<Expr> {
        let ty = match &value {
            Value::Elementary(expr) => expr.ty,
            Value::Constant(constant, _) => constant::default_type(ctx.scope.rules, constant),
            Value::Cell { .. } => Elementary::Bool,
            other => {
                self.wrong_type(other.span(), &message::described(other), "a single value", None);
                return None;
            }
        };
        self.convert(ctx, value, ty)
    }

    /// The implicit conversion of a value to `ty`.
    pub(in crate::bind) fn implicit(&mut self, ctx: &SclBlock, value: Expr, ty: Elementary) -> Option<Expr> {
        let (from, span) = (value.ty, value.span);
        if from == ty {
            return Some(value);
        }
        let rules = ctx.scope.rules;
        if let Some(own) = self.choice_of_constants(ctx, &value, ty) {
            return Some(own);
        }
        let is_address = matches!(value.kind, ExprKind::Load(_)) && is_untyped(ctx, span);
        if is_address && let Some(bits) = convert::same_bits(rules, from, ty) {
            return Some(convert::converted(value, bits, ty));
        }
        let implicit = match convert::implicit(rules, ctx.scope.strict, from, ty) {
            Implicit::No if ctx.scope.strict && self.takes_any_type(rules, &value, ty) => {
                convert::implicit(rules, false, from, ty)
            }
            checked => checked,
        };
        if implicit == Implicit::Yes
            && !ctx.scope.is_network()
            && let Some(own) = self.of_target_type(rules, &value, ty)
        {
            return Some(own);
        }
        match implicit {
            Implicit::No => {
                self.no_conversion(&ctx.scope, span, from, ty);
                return None;
            }
            Implicit::Unusual => self.unusual(span, from, ty),
            Implicit::Yes if from == Elementary::Lreal && self.follows_target(rules, &value, ty) => {
                return convert::explicit_expr(rules, with_real_constants(value), ty);
            }
            Implicit::Yes if convert::narrows(from, ty) && !self.follows_target(rules, &value, ty) => {
                match constant::computed(&value) {
                    Some(number) if convert::holds(rules, from, ty, number) => {}
                    Some(number) if ty.is_integer() => self.value_lost(rules, span, number, ty),
                    _ if bounds::fits(&value, ty) => {}
                    _ => self.may_lose(&ctx.scope, span, from, ty),
                }
            }
            Implicit::Yes => self.too_late_for_target(ctx, &value, ty),
        }
        convert::explicit_expr(rules, value, ty)
    }

    /// The exponent of `**` and EXPT in type `ty`: any number, also with the IEC check.
    pub(in crate::bind) fn exponent(&mut self, ctx: &mut SclBlock, value: Value, ty: Elementary) -> Option<Expr> {
        match value {
            Value::Elementary(value) if ctx.scope.strict && (value.ty.is_integer() || value.ty.is_float()) => {
                convert::explicit_expr(ctx.scope.rules, value, ty)
            }
            value => self.convert(ctx, value, ty),
        }
    }

    /// Whether the IEC check has nothing against a value in type `ty`, because nothing in it has a type of its own: it is computed from numbers
    /// without a type and from functions that follow their target.
    fn takes_any_type(&self, rules: Rules, value: &Expr, ty: Elementary) -> bool {
        let is_number = value.ty.is_integer() && (ty.is_integer() || ty.is_float());
        let is_float = value.ty.is_float() && ty.is_float();
        self.of_target_type(rules, value, ty).is_some()
            || self.follows_target(rules, value, ty)
            || (is_number || is_float) && self.is_untyped_number(rules, value)
    }

    fn is_untyped_number(&self, rules: Rules, value: &Expr) -> bool {
        let is_untyped = |part: &Expr| self.is_untyped_number(rules, part);
        match &value.kind {
            ExprKind::Const(_) => {
                let text = self.program.globals.text(value.span);
                text.trim_start_matches(['+', '-', ' ']).starts_with(|first: char| first.is_ascii_digit())
            }
            ExprKind::Unary { operand, .. } => is_untyped(operand),
            ExprKind::Binary { left, right, .. } => is_untyped(left) && is_untyped(right),
            ExprKind::Function { arguments, .. } => arguments.iter().all(is_untyped),
            // An implicit conversion has the text of its operand.
            ExprKind::Convert { operand, .. } => {
                self.is_rounding_without_type(rules, value) || operand.span == value.span && is_untyped(operand)
            }
            _ => false,
        }
    }

    /// Warns of a function that would have the type of its target if it stood alone, but is part of a shorter expression:
    /// `#lint := ROUND(#lreal) * 2` computes a DINT. Source: SCL reference: the target does not decide on the type of an expression.
    fn too_late_for_target(&mut self, ctx: &SclBlock, value: &Expr, ty: Elementary) {
        let is_longer = ty.bits() > value.ty.bits() && value.ty.is_integer() == ty.is_integer();
        if ctx.scope.is_network() || !(is_longer || ty == Elementary::Lreal) {
            return;
        }
        let Some(part) = self.function_of_own_type(ctx.scope.rules, value, ty) else { return };
        let text = self.program.globals.text(part.span);
        let Some((name, rest)) = text.split_once('(') else { return };
        let (own, target) = (part.ty.name(), ty.name());
        self.program.report(
            Diagnostic::new(Code::Narrowing, part.span, format!("`{text}` is of type {own} here, not {target}"))
                .label(format!("what does not fit {own} is lost before it becomes {target}"))
                .help(format!("write `{}_{target}({rest}`", name.trim())),
        );
    }

    /// Such a function in an expression, if it may lose something.
    fn function_of_own_type<'e>(&self, rules: Rules, value: &'e Expr, ty: Elementary) -> Option<&'e Expr> {
        let of_value = |value: &'e Expr| self.function_of_own_type(rules, value, ty);
        match &value.kind {
            ExprKind::Binary {
                op: BinaryOp::ShiftLeft | BinaryOp::ShiftRight | BinaryOp::RotateLeft | BinaryOp::RotateRight,
                left,
                right,
            } => {
                let constants = matches!((&left.kind, &right.kind), (ExprKind::Const(_), ExprKind::Const(_)));
                (!constants && self.of_target_type(rules, value, ty).is_some()).then_some(value)
            }
            ExprKind::Unary { operand, .. } => of_value(operand),
            ExprKind::Binary { left, right, .. } => of_value(left).or_else(|| of_value(right)),
            ExprKind::Function { function: Function::Limit, arguments } => arguments.iter().find_map(of_value),
            ExprKind::Function { function: Function::Select | Function::Mux { .. }, arguments } => {
                arguments.iter().skip(1).find_map(of_value)
            }
            ExprKind::Function { function: Function::Decode, arguments } => {
                let is_low = |bit: &Expr| matches!(bit.kind, ExprKind::Const(bit) if bit < u64::from(value.ty.bits()));
                let lost = !arguments.iter().all(is_low);
                (lost && self.of_target_type(rules, value, ty).is_some()).then_some(value)
            }
            // An implicit conversion, as in `SHL(IN := 1, N := #n) + 1`.
            ExprKind::Convert { operand, .. } if operand.span == value.span && !operand.ty.is_float() => {
                of_value(operand)
            }
            ExprKind::Convert { operand, .. } => {
                let lost = ty.is_integer() || operand.ty == Elementary::Lreal;
                let rounds = lost && self.is_rounding_without_type(rules, value);
                (rounds && self.of_target_type(rules, value, ty).is_some()).then_some(value)
            }
            _ => None,
        }
    }

    /// The value for an address that takes the type of what is written to it; `ty`: the bit string of its width.
    pub(in crate::bind) fn for_address(
        &mut self,
        ctx: &mut SclBlock,
        value: Value,
        target: Span,
        ty: Elementary,
    ) -> Value {
        if !is_untyped(ctx, target) {
            return value;
        }
        let value = match value {
            Value::Constant(constant, span) if constant::default_type(ctx.scope.rules, &constant).is_float() => {
                let own = if ty == Elementary::Dword { Elementary::Real } else { Elementary::Lreal };
                match own.bits() == ty.bits() {
                    true => self.constant_of_type(ctx, &constant, span, own).map(Value::Elementary),
                    false => None,
                }
                .unwrap_or(Value::Constant(constant, span))
            }
            value => value,
        };
        match value {
            Value::Elementary(expr) => match convert::same_bits(ctx.scope.rules, expr.ty, ty) {
                Some(bits) => Value::Elementary(convert::converted(expr, bits, ty)),
                None => Value::Elementary(expr),
            },
            value => value,
        }
    }

    /// True of functions that take the type of their target in the TIA Portal: rounding without a type in its name, and SCALE_X, MUX and
    /// others with constants only, if these fit.
    fn follows_target(&self, rules: Rules, value: &Expr, ty: Elementary) -> bool {
        let fits = |argument: &Expr| match argument.kind {
            ExprKind::Const(bits) if argument.ty.is_integer() => {
                let (low, high) = constant::range(ty);
                ty.is_integer() && (low..=high).contains(&constant::integer(argument.ty, bits))
            }
            ExprKind::Const(bits) if argument.ty == Elementary::Lreal => {
                ty == Elementary::Real && f64::from_bits(bits).abs() <= f64::from(f32::MAX)
            }
            _ => false,
        };
        match &value.kind {
            ExprKind::Convert { .. } => self.is_rounding_without_type(rules, value),
            ExprKind::Function { function: Function::ScaleX, arguments } => {
                arguments.first().is_some_and(fits) && arguments.last().is_some_and(fits)
            }
            ExprKind::Function { function: Function::Mux { .. } | Function::Select, arguments } => {
                arguments[1..].iter().all(fits)
            }
            _ => false,
        }
    }

    /// In the TIA Portal a function without a type in its name takes the type of its target, if no argument tells the type: ROUND, TRUNC,
    /// CEIL, FLOOR, DECO, shifts and rotates of a number without a type, NORM_X and functions of floats with integers.
    fn of_target_type(&self, rules: Rules, value: &Expr, ty: Elementary) -> Option<Expr> {
        if rules.is_300() {
            return None;
        }
        let span = value.span;
        let is_bits = ty.class() == Class::Bits && ty != Elementary::Bool;
        match &value.kind {
            ExprKind::Convert { conversion, operand }
                if (ty.is_integer() || ty.is_float()) && self.is_rounding_without_type(rules, value) =>
            {
                Some(Expr { span, ..convert::rounded((**operand).clone(), *conversion, ty) })
            }
            ExprKind::Function { function: Function::Decode, .. } if is_bits && self.is_call_of(value, &["DECO"]) => {
                Some(Expr { ty, ..value.clone() })
            }
            ExprKind::Function { function: Function::NormX, arguments }
                if ty == Elementary::Lreal
                    && arguments.iter().all(|argument| argument.ty.is_integer())
                    && self.is_call_of(value, &["NORM_X"]) =>
            {
                Some(Expr { ty, ..value.clone() })
            }
            ExprKind::Function { function, arguments }
                if ty == Elementary::Lreal && value.ty == Elementary::Real && self.is_call_of(value, OF_FLOATS) =>
            {
                let [Expr { kind: ExprKind::Convert { operand, .. }, .. }] = arguments.as_slice() else { return None };
                if !operand.ty.is_integer() {
                    return None;
                }
                let argument = convert::explicit_expr(rules, (**operand).clone(), ty)?;
                Some(Expr { kind: ExprKind::Function { function: *function, arguments: vec![argument] }, ty, span })
            }
            ExprKind::Binary {
                op: op @ (BinaryOp::ShiftLeft | BinaryOp::ShiftRight | BinaryOp::RotateLeft | BinaryOp::RotateRight),
                left,
                right,
            } if is_bits || ty.is_integer() => {
                let ExprKind::Const(bits) = left.kind else { return None };
                let fits = i128::from(bits) <= constant::range(ty).1;
                let untyped = self.program.globals.text(left.span).starts_with(|sign: char| sign.is_ascii_digit());
                if !fits || !untyped || !self.is_call_of(value, &["SHL", "SHR", "ROL", "ROR"]) {
                    return None;
                }
                let left = Box::new(constant_expr(bits, ty, left.span));
                Some(Expr { kind: ExprKind::Binary { op: *op, left, right: right.clone() }, ty, span })
            }
            _ => None,
        }
    }

    /// Both sides of an operator. In the TIA Portal a constant without a type has the type of the other side, and so has a choice among such
    /// constants: `#int + SEL(G := #b, IN0 := 1, IN1 := 2)` is an INT.
    pub(super) fn partners(&self, ctx: &SclBlock, left: Value, right: Value) -> (Value, Value) {
        let (Value::Elementary(a), Value::Elementary(b)) = (&left, &right) else { return (left, right) };
        if a.ty == b.ty {
            return (left, right);
        }
        let (a, b) = (self.choice_of_constants(ctx, a, b.ty), self.choice_of_constants(ctx, b, a.ty));
        (a.map_or(left, Value::Elementary), b.map_or(right, Value::Elementary))
    }

    /// SEL, MUX, LIMIT, MIN and MAX among constants without a type, and functions of a float such as `SQRT(3.0)`, in type `ty`; none: it is
    /// something else, or a constant does not fit.
    fn choice_of_constants(&self, ctx: &SclBlock, value: &Expr, ty: Elementary) -> Option<Expr> {
        if ctx.scope.rules.is_300() || ctx.scope.is_network() {
            return None;
        }
        let names = match &value.kind {
            ExprKind::Function { function: Function::Select | Function::Mux { .. } | Function::Limit, .. } => CHOICES,
            ExprKind::Binary { op: BinaryOp::Min | BinaryOp::Max, .. } => CHOICES,
            ExprKind::Function { .. } if value.ty == Elementary::Lreal && ty == Elementary::Real => OF_FLOATS,
            _ => return None,
        };
        let own = self.chosen_as(ctx.scope.rules, value, ty)?;
        self.is_call_of(value, names).then_some(own)
    }

    /// Part of [`Self::choice_of_constants`], without a look at the name.
    fn chosen_as(&self, rules: Rules, value: &Expr, ty: Elementary) -> Option<Expr> {
        let all = |arguments: &[Expr]| -> Option<Vec<Expr>> {
            arguments.iter().map(|argument| self.constant_as(rules, argument, ty)).collect()
        };
        let kind = match &value.kind {
            ExprKind::Const(_) => return self.constant_as(rules, value, ty),
            ExprKind::Function { function: function @ (Function::Select | Function::Mux { .. }), arguments } => {
                let (first, rest) = arguments.split_first()?;
                let arguments = std::iter::once(first.clone()).chain(all(rest)?).collect();
                ExprKind::Function { function: *function, arguments }
            }
            // LIMIT, and functions of floats.
            ExprKind::Function { function, arguments } if ty.class() != Class::Bits => {
                ExprKind::Function { function: *function, arguments: all(arguments)? }
            }
            ExprKind::Binary { op: op @ (BinaryOp::Min | BinaryOp::Max), left, right } if ty.class() != Class::Bits => {
                let right = Box::new(self.constant_as(rules, right, ty)?);
                let left = Box::new(self.chosen_as(rules, left, ty)?);
                ExprKind::Binary { op: *op, left, right }
            }
            _ => return None,
        };
        Some(Expr { kind, ty, span: value.span })
    }

    /// A constant without a type, in type `ty`, if it fits.
    fn constant_as(&self, rules: Rules, value: &Expr, ty: Elementary) -> Option<Expr> {
        let ExprKind::Const(bits) = value.kind else { return None };
        let bits = if value.ty.is_integer() {
            let number = constant::integer(value.ty, bits);
            let default = constant::default_type(rules, &Constant::Integer { value: number, based: false });
            let is_bits = ty.class() == Class::Bits && ty != Elementary::Bool;
            if value.ty != default || !(is_bits || ty.is_integer()) || !constant::fits(number, false, ty) {
                return None;
            }
            number as u64 & (u64::MAX >> (64 - ty.bits()))
        } else {
            let number = f64::from_bits(bits);
            if value.ty != Elementary::Lreal || ty != Elementary::Real || number.abs() > f64::from(f32::MAX) {
                return None;
            }
            u64::from((number as f32).to_bits())
        };
        let text = self.program.globals.text(value.span);
        let untyped = text.trim_start_matches(['+', '-', ' ']).starts_with(|first: char| first.is_ascii_digit());
        untyped.then(|| constant_expr(bits, ty, value.span))
    }

    /// True of ROUND, TRUNC, CEIL and FLOOR without a type in the name, in the TIA Portal.
    fn is_rounding_without_type(&self, rules: Rules, value: &Expr) -> bool {
        let ExprKind::Convert { operand, .. } = &value.kind else { return false };
        let rounding = ["ROUND", "TRUNC", "CEIL", "FLOOR"];
        !rules.is_300() && operand.ty.is_float() && self.is_call_of(value, &rounding)
    }

    /// True of the value of a call of one of these functions, by its text.
    fn is_call_of(&self, value: &Expr, names: &[&str]) -> bool {
        let text = self.program.globals.text(value.span);
        let name = text.split('(').next().unwrap_or("").trim();
        names.iter().any(|own| own.eq_ignore_ascii_case(name))
    }

    fn unusual(&mut self, span: Span, from: Elementary, to: Elementary) {
        let text = self.program.globals.text(span);
        self.refuse(
            Code::Narrowing,
            span,
            &format!("`{text}` is of type {} and becomes {}", from.name(), to.name()),
            "S7-SCL of STEP 7 V5 does not convert this implicitly",
            &format!("write {}", message::conversion(from, to, &text)),
        );
    }
}

/// A call in an expression or in the indices of a variable: it may change something.
pub fn has_call(expr: &Expr) -> bool {
    let mut calls = HasCall(false);
    walk::expr(expr, &mut calls);
    calls.0
}

/// Like [`has_call`], for a variable.
pub fn access_has_call(access: &Access) -> bool {
    let mut calls = HasCall(false);
    walk::access(access, Role::Value, &mut calls);
    calls.0
}

struct HasCall(bool);

impl Visitor for HasCall {
    fn expr(&mut self, expr: &Expr) {
        self.0 |= matches!(expr.kind, ExprKind::Call(_) | ExprKind::Timer(_) | ExprKind::Counter(_));
    }
}

/// Whether an operand is an address with bits only.
pub(super) fn is_untyped(ctx: &SclBlock, span: Span) -> bool {
    ctx.scope.untyped.as_ref().is_some_and(|known| known.contains(&span))
}

/// SCALE_X, SEL or MUX of constants that are REAL instead of LREAL, and so computed in REAL; another value stays.
fn with_real_constants(mut value: Expr) -> Expr {
    let ExprKind::Function { function: Function::ScaleX | Function::Select | Function::Mux { .. }, arguments } =
        &mut value.kind
    else {
        return value;
    };
    for argument in arguments {
        if let ExprKind::Const(bits) = &mut argument.kind
            && argument.ty == Elementary::Lreal
        {
            *bits = u64::from((f64::from_bits(*bits) as f32).to_bits());
            argument.ty = Elementary::Real;
        }
    }
    value.ty = Elementary::Real;
    value
}
