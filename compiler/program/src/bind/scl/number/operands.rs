//! Operands of functions of numbers and bits, in the types that the functions want.

use plcc_diag::{Code, Diagnostic};
use plcc_syntax::scl::ast::Expr as Node;
use plcc_syntax::{Class, Elementary};

use crate::bind::scl::convert::{self, converted};
use crate::bind::scl::message::described;
use crate::bind::scl::numeric::{self, Shape};
use crate::bind::scl::value::Value;
use crate::bind::scl::{Rules, SclBinder, SclBlock, constant};
use plcc_binding::constant::Constant;
use plcc_binding::rewrite;
use plcc_model::scl::{Conversion, Expr};

impl SclBinder<'_, '_> {
    /// A value as a float: LREAL stays, everything else converts to REAL.
    pub(super) fn float_value(&mut self, ctx: &mut SclBlock, node: &Node, suffix: Option<Elementary>) -> Option<Expr> {
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
    pub(super) fn bits_value(&mut self, ctx: &mut SclBlock, node: &Node, suffix: Option<Elementary>) -> Option<Expr> {
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
    pub(super) fn count_value(&mut self, ctx: &mut SclBlock, node: &Node, help: &str) -> Option<Expr> {
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

    /// Values converted to one type: that of the suffix, or the widest of their own.
    pub(super) fn alike(
        &mut self,
        ctx: &mut SclBlock,
        nodes: &[&Node],
        suffix: Option<Elementary>,
    ) -> Option<(Vec<Expr>, Elementary)> {
        let values: Vec<Option<Value>> = nodes.iter().map(|node| self.value(ctx, node)).collect();
        let values: Vec<Value> = values.into_iter().collect::<Option<_>>()?;
        self.alike_values(ctx, values, suffix)
    }

    pub(super) fn alike_values(
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

    pub(super) fn number_wanted(&mut self, value: &Expr) -> Option<()> {
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
}
