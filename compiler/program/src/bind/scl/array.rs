//! Parts of arrays: MOVE_BLK, FILL_BLK, and queries about bounds. Source: SCL reference, moves; S7-1200 reference, moves.

use std::rc::Rc;

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::Elementary;
use plcc_syntax::count::counted;
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind};

use super::Intent;
use super::memory::{binary, elementary_at, load, minus_one, number, whole};
use super::message::described;
use super::pins::Pins;
use super::value::Value;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_model::Place;
use plcc_model::layout;
use plcc_model::scl::{
    Access, Base, BinaryOp, CompareOp, Complex, Expr, ExprKind, Function, Index, IndexBounds, Statement, StatementKind,
};
use plcc_model::types::{ArrayType, DataType, ParameterType};

/// The elements of an array, beginning with one of them.
pub(super) struct Run {
    /// The whole array.
    pub array: Access,
    pub element: DataType,
    bounds: IndexBounds,
    /// Distance of elements in bits.
    stride: u32,
    /// Number of the first element, a DINT; known if it is constant.
    pub first: Expr,
}

impl Run {
    /// The element `first + offset`.
    pub fn at(&self, first: &Expr, offset: Expr) -> Access {
        let value = binary(BinaryOp::Add, first.clone(), offset);
        self.element(value)
    }

    fn element(&self, value: Expr) -> Access {
        let mut access = self.array.clone();
        access.indices.push(Index { value, bounds: self.bounds, stride: self.stride });
        access.ty = self.element.clone();
        access
    }

    /// Number of the last element.
    fn last(&self) -> Expr {
        let span = self.array.span;
        match self.bounds {
            IndexBounds::Known(_, high) | IndexBounds::Characters { length: high, .. } => number(high, span),
            IndexBounds::Open { parameter, .. } => bound(parameter, number(0, span), true, span),
        }
    }
}

impl SclBinder<'_, '_> {
    pub fn move_block(&mut self, ctx: &mut SclBlock, pins: &Pins, span: Span) -> Option<Vec<StatementKind>> {
        let source = self.run(ctx, pins.get("IN")?, Intent::Read);
        let count = self.dint(ctx, pins.get("COUNT")?);
        let target = self.run(ctx, pins.get("OUT")?, Intent::Write);
        let (source, target, count) = (source?, target?, count?);
        if !layout::same_type(&source.element, &target.element) {
            let is = format!("an array of {}", layout::type_name(&source.element));
            let wanted = format!("an array of {}", layout::type_name(&target.element));
            self.wrong_type(source.array.span, &is, &wanted, None);
            return None;
        }
        if let Some(copy) = whole_copy(&source, &target, &count) {
            return Some(vec![copy]);
        }
        if !self.check_length(&source, &count) {
            self.check_length(&target, &count);
        }
        let mut code = Vec::new();
        let from = self.kept(ctx, &mut code, source.first.clone());
        let to = self.kept(ctx, &mut code, target.first.clone());
        let left = self.temp(ctx, Elementary::Dint, span);
        code.push(StatementKind::Assign { target: left.clone(), value: count });
        code.push(shortened(&left, &source, &from, span));
        code.push(shortened(&left, &target, &to, span));
        let at = self.temp(ctx, Elementary::Dint, span);
        let offset = || load(&at, Elementary::Dint);
        let copy = copied(target.at(&to, offset()), &source.at(&from, offset()), &source.element);
        let (zero, last) = (|| number(0, span), || minus_one(load(&left, Elementary::Dint)));
        let (start, end, step) = match may_overlap(&source.array, &target.array) {
            // Backwards if the target comes after the source, as if through a buffer.
            true => {
                let place = match distance(&source, &target) {
                    0 => to.clone(),
                    elements => binary(BinaryOp::Add, to.clone(), number(elements, span)),
                };
                let after = || Expr {
                    kind: ExprKind::Compare {
                        op: CompareOp::Greater,
                        left: Box::new(place.clone()),
                        right: Box::new(from.clone()),
                    },
                    ty: Elementary::Bool,
                    span,
                };
                let choose = |no: Expr, yes: Expr| Expr {
                    kind: ExprKind::Function { function: Function::Select, arguments: vec![after(), no, yes] },
                    ty: Elementary::Dint,
                    span,
                };
                (choose(zero(), last()), choose(last(), zero()), choose(number(1, span), number(-1, span)))
            }
            false => (zero(), last(), number(1, span)),
        };
        let body = vec![Statement { kind: copy, span }];
        code.push(StatementKind::For { variable: at, start, end, step, body });
        Some(code)
    }

    pub fn fill_block(&mut self, ctx: &mut SclBlock, pins: &Pins, span: Span) -> Option<Vec<StatementKind>> {
        let target = self.run(ctx, pins.get("OUT")?, Intent::Write)?;
        let DataType::Elementary(ty) = target.element else {
            let is = format!("an array of {}", layout::type_name(&target.element));
            self.wrong_type(target.array.span, &is, "an array of an elementary type", None);
            return None;
        };
        let value = self.of_type(ctx, pins.get("IN")?, ty);
        let count = self.dint(ctx, pins.get("COUNT")?);
        let mut code = Vec::new();
        let value = self.kept(ctx, &mut code, value?);
        let count = count?;
        if let Some(filled) = whole_fill(&target, &value, &count) {
            code.extend(filled);
            return Some(code);
        }
        self.check_length(&target, &count);
        let to = self.kept(ctx, &mut code, target.first.clone());
        let left = self.temp(ctx, Elementary::Dint, span);
        code.push(StatementKind::Assign { target: left.clone(), value: count });
        code.push(shortened(&left, &target, &to, span));
        let at = self.temp(ctx, Elementary::Dint, span);
        let element = target.at(&to, load(&at, Elementary::Dint));
        code.push(StatementKind::For {
            variable: at,
            start: number(0, span),
            end: minus_one(load(&left, Elementary::Dint)),
            step: number(1, span),
            body: vec![Statement { kind: StatementKind::Assign { target: element, value }, span }],
        });
        Some(code)
    }

    /// Warns of a COUNT that is a number and more than the elements of the array from the first one on; true if it does.
    fn check_length(&mut self, run: &Run, count: &Expr) -> bool {
        let (ExprKind::Const(first), ExprKind::Const(number), IndexBounds::Known(_, high)) =
            (&run.first.kind, &count.kind, run.bounds)
        else {
            return false;
        };
        let left = i64::from(high) - i64::from(*first as u32 as i32) + 1;
        let number = i64::from(*number as u32 as i32);
        if number <= left {
            return false;
        }
        let array = self.program.globals.text(run.array.span);
        let left = counted(left as usize, "element");
        let mut message =
            Diagnostic::new(Code::ArrayIndex, count.span, format!("`{array}` has only {left} here, not {number}"))
                .label("only these are written, and ENO is FALSE")
                .also(run.first.span, "counted from this element on")
                .help("write a smaller COUNT, or declare a larger array");
        message.severity = Severity::Warning;
        self.program.report(message);
        true
    }

    /// `a[i]` and everything after it in the array.
    pub(super) fn run(&mut self, ctx: &mut SclBlock, node: &Node, intent: Intent) -> Option<Run> {
        let NodeKind::Index { base, indices } = &node.kind else { return self.no_element(node.span) };
        let [index] = indices.as_slice() else { return self.no_element(node.span) };
        let array = self.access(ctx, base, intent)?;
        let (element, bounds) = match &array.ty {
            DataType::Array(ty) if ty.bounds.len() == 1 => {
                (ty.element.clone(), IndexBounds::Known(ty.bounds[0].0, ty.bounds[0].1))
            }
            DataType::OpenArray(ty) if ty.dimensions == 1 => {
                let parameter = open_parameter(ctx, &array)?;
                (ty.element.clone(), IndexBounds::Open { parameter, dimension: 0 })
            }
            _ => return self.no_element(node.span),
        };
        let first = self.dint(ctx, index)?;
        if let (ExprKind::Const(value), IndexBounds::Known(low, high)) = (&first.kind, bounds)
            && !(low..=high).contains(&(*value as u32 as i32))
        {
            self.program.report(
                Diagnostic::new(
                    Code::ArrayIndex,
                    index.span,
                    format!("index {} is outside the array", *value as u32 as i32),
                )
                .label(format!("the array goes from {low} to {high}"))
                .help(format!("write an index from {low} to {high}, or declare a larger array")),
            );
            return None;
        }
        let stride = stride(&element);
        Some(Run { array, element, bounds, stride, first })
    }

    fn no_element<T>(&mut self, span: Span) -> Option<T> {
        let text = self.program.globals.text(span);
        self.program.report(
            Diagnostic::new(Code::OperandKind, span, format!("`{text}` is not an element of an array"))
                .label("the first element is expected here")
                .help("name an element of an array of one dimension, for example `#data[0]`"),
        );
        None
    }

    /// LOWER_BOUND, UPPER_BOUND.
    pub fn bound_function(&mut self, ctx: &mut SclBlock, upper: bool, pins: &Pins, span: Span) -> Option<Value> {
        let array = self.value(ctx, pins.get("ARR")?);
        let dimension = self.dint(ctx, pins.get("DIM")?);
        match (array?, dimension?) {
            (Value::Parameter { access, span: place }, dimension) if matches!(access.ty, DataType::OpenArray(_)) => {
                let Some(parameter) = open_parameter(ctx, &access) else { return self.no_bounds(place) };
                Some(Value::Elementary(bound(parameter, counted_from_0(dimension), upper, span)))
            }
            (Value::Complex { ty: DataType::Array(array), .. }, Expr { kind: ExprKind::Const(dimension), .. }) => {
                let index = usize::try_from(dimension).ok().and_then(|dimension| dimension.checked_sub(1));
                let bounds = index.and_then(|index| array.bounds.get(index));
                let Some((low, high)) = bounds else {
                    self.program.report(
                        Diagnostic::new(Code::ArrayIndex, span, "the array does not have this dimension")
                            .label(format!("it has {}", counted(array.bounds.len(), "dimension"))),
                    );
                    return None;
                };
                Some(Value::Elementary(number(if upper { *high } else { *low }, span)))
            }
            (other, _) => {
                let place = other.span();
                self.no_bounds(place)
            }
        }
    }

    fn no_bounds<T>(&mut self, span: Span) -> Option<T> {
        let text = self.program.globals.text(span);
        self.program.report(
            Diagnostic::new(Code::TypeMismatch, span, format!("`{text}` has no bounds to query"))
                .label("an ARRAY[*] parameter, or an array and a constant dimension, is expected"),
        );
        None
    }

    /// CountOfElements: a UDINT, 0 for what is not an array.
    pub fn count_of_elements(&mut self, ctx: &mut SclBlock, pins: &Pins, span: Span) -> Option<Value> {
        let udint = |value: u64| Expr { kind: ExprKind::Const(value), ty: Elementary::Udint, span };
        let count = match self.value(ctx, pins.get("IN")?)? {
            Value::Complex { ty: DataType::Array(array), .. } => udint(layout::element_count(&array.bounds)),
            Value::Parameter { access, span: place } => match &access.ty {
                DataType::OpenArray(array) => {
                    let Some(parameter) = open_parameter(ctx, &access) else { return self.no_bounds(place) };
                    let length = |dimension: i32| {
                        let high = bound(parameter, number(dimension, span), true, span);
                        let low = bound(parameter, number(dimension, span), false, span);
                        binary(BinaryOp::Add, binary(BinaryOp::Subtract, high, low), number(1, span))
                    };
                    let lengths = (0..i32::from(array.dimensions)).map(length);
                    let count = lengths.reduce(|a, b| binary(BinaryOp::Multiply, a, b))?;
                    Expr {
                        ty: Elementary::Udint,
                        ..super::convert::converted(
                            count,
                            plcc_model::scl::Conversion::Bits { checked: false },
                            Elementary::Udint,
                        )
                    }
                }
                DataType::Parameter(ParameterType::Variant) => variant_field(&access, layout::VARIANT_ELEMENTS, span)?,
                _ => {
                    let is = described(&Value::Parameter { access: access.clone(), span: place });
                    self.wrong_type(place, &is, "an array", None);
                    return None;
                }
            },
            _ => udint(0),
        };
        Some(Value::Elementary(count))
    }
}

/// A field of a VARIANT, a UDINT. See [`plcc_model::Pointed`].
pub fn variant_field(variant: &Access, at: u32, span: Span) -> Option<Expr> {
    let field = elementary_at(variant, at, 0, Elementary::Udint)?;
    Some(Expr { kind: ExprKind::Load(Box::new(field)), ty: Elementary::Udint, span })
}

/// The parameter that an ARRAY[*] is.
fn open_parameter(ctx: &SclBlock, access: &Access) -> Option<usize> {
    match &access.base {
        Base::Place(Place::Parameter { parameter, .. }) => Some(*parameter),
        Base::Place(Place::ThroughPointer { pointer, .. }) => ctx
            .block
            .bound
            .interface
            .parameters
            .iter()
            .position(|parameter| parameter.byte == *pointer && matches!(parameter.ty, DataType::OpenArray(_))),
        _ => None,
    }
}

/// A bound of an ARRAY[*]; `dimension` from 0.
fn bound(parameter: usize, dimension: Expr, upper: bool, span: Span) -> Expr {
    Expr { kind: ExprKind::Bound { parameter, dimension: Box::new(dimension), upper }, ty: Elementary::Dint, span }
}

fn counted_from_0(dimension: Expr) -> Expr {
    match dimension.kind {
        ExprKind::Const(value) => number((value as u32 as i32).wrapping_sub(1), dimension.span),
        _ => minus_one(dimension),
    }
}

/// Distance of adjacent elements in bits.
fn stride(element: &DataType) -> u32 {
    let bounds = vec![(0, 1)];
    let bytes = u32::try_from(layout::array_bytes(&bounds, element)).unwrap_or(u32::MAX);
    let array = Rc::new(ArrayType { bounds, element: element.clone(), bytes });
    let (byte, bit) = layout::element_place(&array, 1);
    byte * 8 + u32::from(bit)
}

/// True if two arrays may be the same memory.
fn may_overlap(a: &Access, b: &Access) -> bool {
    let far = |access: &Access| {
        matches!(
            access.base,
            Base::Place(Place::Parameter { .. } | Place::ThroughPointer { .. }) | Base::Indexed { .. }
        )
    };
    if far(a) || far(b) || !a.indices.is_empty() || !b.indices.is_empty() {
        return true;
    }
    match (placed(a), placed(b)) {
        (Some((area, start)), Some((other, first))) => {
            let bits = |access: &Access| 8 * i64::from(layout::bytes(&access.ty));
            area == other && start < first + bits(b) && first < start + bits(a)
        }
        _ => matches!((&a.base, &b.base), (Base::Place(a), Base::Place(b)) if a == b),
    }
}

/// What has to be added to the number of an element of `target`, to compare it with one of `source` by where they are: both may be views of one
/// variable.
fn distance(source: &Run, target: &Run) -> i32 {
    let (IndexBounds::Known(from, _), IndexBounds::Known(to, _)) = (source.bounds, target.bounds) else { return 0 };
    let bits = match (placed(&source.array), placed(&target.array)) {
        (Some((area, start)), Some((other, first))) if area == other => first - start,
        _ => 0,
    };
    let stride = i64::from(source.stride.max(1));
    // A part of an element counts as one.
    let elements = (bits + stride - 1).div_euclid(stride);
    i32::try_from(elements + i64::from(from) - i64::from(to)).unwrap_or(0)
}

/// The area, data block or parameter in which a variable is, as the place where it begins, and the distance from there in bits. `None`: the
/// place is only known when the program runs.
fn placed(access: &Access) -> Option<(Place, i64)> {
    let Base::Place(place) = &access.base else { return None };
    let mut area = place.clone();
    let (byte, bit) = area.position_mut()?;
    let distance = 8 * i64::from(*byte) + i64::from(*bit);
    (*byte, *bit) = (0, 0);
    Some((area, distance))
}

/// The number of the first element and the count, if both are constants, all elements are in the array, and they are whole bytes.
fn constant_range(run: &Run, count: &Expr) -> Option<(i32, u32)> {
    let constant = |value: &Expr| match value.kind {
        ExprKind::Const(bits) => Some(bits as u32 as i32),
        _ => None,
    };
    let (first, count) = (constant(&run.first)?, constant(count)?);
    let IndexBounds::Known(_, high) = run.bounds else { return None };
    let fits = count >= 1 && i64::from(first) + i64::from(count) - 1 <= i64::from(high);
    (fits && run.stride.is_multiple_of(8)).then_some((first, count as u32))
}

/// Assignments to the first elements, then copies of what is filled already, each twice as long, if everything is constant.
fn whole_fill(target: &Run, value: &Expr, count: &Expr) -> Option<Vec<StatementKind>> {
    const ASSIGNED_MAX: u32 = 8;
    let (first, count) = constant_range(target, count)?;
    let span = target.array.span;
    let at = |offset: u32| target.element(number(first + offset as i32, span));
    let mut done = count.min(ASSIGNED_MAX);
    let mut code: Vec<StatementKind> =
        (0..done).map(|offset| StatementKind::Assign { target: at(offset), value: value.clone() }).collect();
    while done < count {
        let part = done.min(count - done);
        let bytes = part.checked_mul(target.stride / 8)?;
        code.push(StatementKind::Copy { target: at(done), source: Complex::Variable(at(0)), bytes });
        done += part;
    }
    Some(code)
}

/// One copy, if everything is constant, inside both arrays, and the elements are whole bytes.
fn whole_copy(source: &Run, target: &Run, count: &Expr) -> Option<StatementKind> {
    let (_, elements) = constant_range(source, count)?;
    constant_range(target, count)?;
    Some(StatementKind::Copy {
        target: target.element(target.first.clone()),
        source: Complex::Variable(source.element(source.first.clone())),
        bytes: elements.checked_mul(source.stride / 8)?,
    })
}

/// Limits `left` to the number of elements that the array still has.
pub(super) fn shortened(left: &Access, run: &Run, first: &Expr, span: Span) -> StatementKind {
    let room = || {
        let rest = binary(BinaryOp::Subtract, run.last(), first.clone());
        binary(BinaryOp::Add, rest, number(1, span))
    };
    let condition = Expr {
        kind: ExprKind::Compare {
            op: CompareOp::Greater,
            left: Box::new(load(left, Elementary::Dint)),
            right: Box::new(room()),
        },
        ty: Elementary::Bool,
        span,
    };
    let cut = StatementKind::Assign { target: left.clone(), value: room() };
    let failed = StatementKind::Failed;
    let body = vec![Statement { kind: cut, span }, Statement { kind: failed, span }];
    StatementKind::If { branches: vec![(condition, body)], otherwise: Vec::new() }
}

/// One element to another of the same type.
fn copied(target: Access, source: &Access, element: &DataType) -> StatementKind {
    match element {
        DataType::Elementary(ty) => StatementKind::Assign { target, value: load(source, *ty) },
        DataType::String(_) | DataType::WideString(_) => StatementKind::AssignText { target, value: whole(source) },
        _ => StatementKind::Copy { target, source: whole(source), bytes: layout::bytes(element) },
    }
}
