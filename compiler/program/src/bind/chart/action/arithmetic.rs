//! Assignments in rows of actions. Source: GRAPH reference D.8.
//!
//! They are those of SCL, with two additions: an address such as MD4 is also the number of its width, and functions have names of STL.

use plcc_diag::Span;
use plcc_syntax::scl::ast::{Argument, Expr as Node, ExprKind as NodeKind, Name, NameForm};
use plcc_syntax::{Class, Elementary};

use crate::bind::chart::ChartBinder;
use crate::bind::network::Page;
use crate::bind::scl::constant::float_bits;
use crate::bind::scl::convert::{converted, explicit_expr, rounding};
use crate::bind::scl::expression::constant_expr;
use crate::bind::scl::message::DEPTH_MAX;
use crate::bind::scl::numeric::Shape;
use crate::bind::scl::value::Value;
use crate::bind::scl::{Intent, SclBlock};
use plcc_binding::constant::Constant;
use plcc_binding::fold;
use plcc_model::scl::{Conversion, Expr, ExprKind, Statement, UnaryOp};

/// A function of GRAPH that SCL does not have under this name.
#[derive(Clone, Copy)]
enum Mnemonic {
    /// Has the argument's type if none is named.
    Negate(Option<Elementary>),
    Invert(Elementary),
    Number {
        from: Elementary,
        to: Elementary,
    },
    /// Has the width of the argument.
    FromBcd(Option<Elementary>),
    ToBcd(Option<Elementary>),
    Round,
    /// A function of SCL for a REAL.
    Real,
}

/// The function with this name.
fn mnemonic(name: &str) -> Option<Mnemonic> {
    Some(match name.to_ascii_uppercase().as_str() {
        "NEG" => Mnemonic::Negate(None),
        "NEGI" => Mnemonic::Negate(Some(Elementary::Int)),
        "NEGD" => Mnemonic::Negate(Some(Elementary::Dint)),
        "NEGR" => Mnemonic::Negate(Some(Elementary::Real)),
        "INVI" => Mnemonic::Invert(Elementary::Word),
        "INVD" => Mnemonic::Invert(Elementary::Dword),
        "ITD" => Mnemonic::Number { from: Elementary::Int, to: Elementary::Dint },
        "DTR" => Mnemonic::Number { from: Elementary::Dint, to: Elementary::Real },
        "BCD_TO_NUM" => Mnemonic::FromBcd(None),
        "BTI" => Mnemonic::FromBcd(Some(Elementary::Word)),
        "BTD" => Mnemonic::FromBcd(Some(Elementary::Dword)),
        "NUM_TO_BCD" => Mnemonic::ToBcd(None),
        "ITB" => Mnemonic::ToBcd(Some(Elementary::Int)),
        "DTB" => Mnemonic::ToBcd(Some(Elementary::Dint)),
        "RND" => Mnemonic::Round,
        "SQR" | "SQRT" | "LN" | "EXP" | "SIN" | "COS" | "TAN" | "ASIN" | "ACOS" | "ATAN" | "ROUND" | "TRUNC"
        | "CEIL" | "FLOOR" => Mnemonic::Real,
        _ => return None,
    })
}

impl ChartBinder<'_, '_> {
    /// `a := expr`.
    pub(super) fn action_assignment(
        &mut self,
        ctx: &mut SclBlock,
        page: &mut Page,
        operand: &Node,
        value: &Node,
        span: Span,
    ) -> Vec<Statement> {
        page.pool.next_network();
        let mut statements = Vec::new();
        let value = self.without_mnemonics(ctx, page, value, &mut statements, 0);
        let value = value.and_then(|value| self.scl().value(ctx, &value));
        let target = self.scl().access(ctx, operand, Intent::Write);
        let (Some(value), Some(target)) = (value, target) else { return Vec::new() };
        let value = match target.elementary() {
            Some(ty) => self.as_width(ctx, value, ty),
            None => Some(value),
        };
        let Some(kind) = value.and_then(|value| self.scl().assignment(ctx, target, value)) else { return Vec::new() };
        statements.push(Statement { kind, span });
        statements
    }

    /// A bit string as the number of its width, and vice versa.
    fn as_width(&mut self, ctx: &mut SclBlock, value: Value, ty: Elementary) -> Option<Value> {
        let rules = ctx.scope.rules;
        match (&value, Shape::of(&value)) {
            (Value::Constant(Constant::Real(number), span), _) if ty == Elementary::Dword => {
                let bits = float_bits(*number, Elementary::Real);
                Some(Value::Elementary(constant_expr(bits, Elementary::Dword, *span)))
            }
            (_, Shape::Of(from))
                if from != ty
                    && from.bits() == ty.bits()
                    && (from.class() == Class::Bits || ty.class() == Class::Bits) =>
            {
                let value = self.scl().own_type(ctx, value)?;
                match explicit_expr(rules, value.clone(), ty) {
                    Some(value) => Some(Value::Elementary(value)),
                    None => Some(Value::Elementary(value)),
                }
            }
            _ => Some(value),
        }
    }

    /// An expression in which hidden variables hold the values of functions with names of STL.
    fn without_mnemonics(
        &mut self,
        ctx: &mut SclBlock,
        page: &mut Page,
        node: &Node,
        statements: &mut Vec<Statement>,
        depth: u32,
    ) -> Option<Node> {
        // SCL does not allow deeper nesting either.
        if depth > DEPTH_MAX {
            return Some(node.clone());
        }
        let mut inner =
            |binder: &mut Self, node: &Node| binder.without_mnemonics(ctx, page, node, statements, depth + 1);
        let kind = match &node.kind {
            NodeKind::Unary { op, operand } => NodeKind::Unary { op: *op, operand: Box::new(inner(self, operand)?) },
            NodeKind::Binary { op, left, right, op_span } => {
                let left = Box::new(inner(self, left)?);
                let right = Box::new(inner(self, right)?);
                NodeKind::Binary { op: *op, left, right, op_span: *op_span }
            }
            NodeKind::Call { callee, arguments } => {
                let mut list = Vec::with_capacity(arguments.len());
                for argument in arguments {
                    let value = match &argument.value {
                        Some(value) => Some(inner(self, value)?),
                        None => None,
                    };
                    list.push(Argument { value, ..argument.clone() });
                }
                if let Some(meant) = self.called_mnemonic(callee)
                    && let [Argument { value: Some(value), .. }] = list.as_slice()
                {
                    let value = self.mnemonic_value(ctx, meant, value, node.span)?;
                    let hidden = page.hidden(ctx, value.ty);
                    statements.push(hidden.set(value, node.span));
                    let hidden = hidden.node(node.span);
                    if !matches!(meant, Mnemonic::Real) {
                        return Some(hidden);
                    }
                    list[0].value = Some(hidden);
                }
                NodeKind::Call { callee: callee.clone(), arguments: list }
            }
            _ => return Some(node.clone()),
        };
        Some(Node { kind, span: node.span })
    }

    /// A function with a name of STL, unless the program defines one with this name.
    fn called_mnemonic(&self, callee: &Node) -> Option<Mnemonic> {
        let NodeKind::Name(Name { text, form: NameForm::Bare, .. }) = &callee.kind else { return None };
        if self.program.globals.names.symbols.contains_key(&fold(text)) {
            return None;
        }
        mnemonic(text)
    }

    /// The result of a function; for one of SCL its argument.
    fn mnemonic_value(&mut self, ctx: &mut SclBlock, meant: Mnemonic, argument: &Node, span: Span) -> Option<Expr> {
        let value = self.scl().value(ctx, argument)?;
        let rules = ctx.scope.rules;
        let own = match Shape::of(&value) {
            Shape::Of(ty) => ty,
            Shape::Integer(_) => Elementary::Dint,
            Shape::Real | Shape::Letter | Shape::Other => Elementary::Real,
        };
        let number = if own.bits() > 16 { Elementary::Dint } else { Elementary::Int };
        Some(match meant {
            Mnemonic::Negate(ty) => {
                let ty = ty.unwrap_or(if own.class() == Class::Bits { number } else { own });
                let operand = self.of_width(ctx, value, ty)?;
                Expr { kind: ExprKind::Unary { op: UnaryOp::Negate, operand: Box::new(operand) }, ty, span }
            }
            Mnemonic::Invert(ty) => {
                let operand = self.of_width(ctx, value, ty)?;
                Expr { kind: ExprKind::Unary { op: UnaryOp::Not, operand: Box::new(operand) }, ty, span }
            }
            Mnemonic::Number { from, to } => {
                let value = self.of_width(ctx, value, from)?;
                explicit_expr(rules, value, to)?
            }
            Mnemonic::FromBcd(ty) => {
                let bits = if number == Elementary::Dint { Elementary::Dword } else { Elementary::Word };
                let from = ty.unwrap_or(bits);
                let to = if from == Elementary::Dword { Elementary::Dint } else { Elementary::Int };
                let value = self.of_width(ctx, value, from)?;
                converted(value, Conversion::FromBcd { fault: rules.is_300() }, to)
            }
            Mnemonic::ToBcd(ty) => {
                let from = ty.unwrap_or(number);
                let to = if from == Elementary::Dint { Elementary::Dword } else { Elementary::Word };
                let value = self.of_width(ctx, value, from)?;
                converted(value, Conversion::ToBcd, to)
            }
            Mnemonic::Round => {
                let value = self.of_width(ctx, value, Elementary::Real)?;
                converted(value, rounding(rules, "ROUND")?, Elementary::Dint)
            }
            Mnemonic::Real => match own {
                Elementary::Dword => self.of_width(ctx, value, Elementary::Real)?,
                _ => self.scl().convert(ctx, value, own)?,
            },
        })
    }

    /// A value as one of type `ty`; a bit string of the same width counts as one.
    fn of_width(&mut self, ctx: &mut SclBlock, value: Value, ty: Elementary) -> Option<Expr> {
        let value = self.as_width(ctx, value, ty)?;
        self.scl().convert(ctx, value, ty)
    }
}
