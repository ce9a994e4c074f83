//! Array elements, characters of texts, and addresses with an index: `MW[i]`, `M[b, i]`, `DB10.DW[i]`. Source: SCL reference,
//! indexed operands, array limits.

use std::rc::Rc;

use plcc_diag::{Code, Span};
use plcc_syntax::ast::{Area, Width};
use plcc_syntax::scl::ast::{Argument, Expr as Node, ExprKind as NodeKind};
use plcc_syntax::scl::{area_word, db_area_word};
use plcc_syntax::{Class, Elementary};

use super::convert;
use super::expression::typed_constant;
use super::place::{Db, Root, Spot, Thing};
use super::value::Value;
use super::{Intent, Rules, constant, message};
use crate::bind::declarations::path::{self, Variable, type_of_width};
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_binding::rewrite;
use plcc_model::layout;
use plcc_model::scl::{Expr, Index, IndexBounds, IndexedArea};
use plcc_model::types::{ArrayType, DataType};

/// Bytes before the characters of a STRING and a WSTRING.
const STRING_HEADER: u32 = 2;
const WIDE_HEADER: u32 = 4;

/// An index: its value if that is known, otherwise an expression for it, a DINT.
enum Position {
    Known(i64),
    Dynamic(Expr),
}

impl SclBinder<'_, '_> {
    /// `a[i, j]`, `a[i]` as a row of it, `s[i]`.
    pub(super) fn element(&mut self, ctx: &mut SclBlock, spot: Spot, indices: &[Node], span: Span) -> Option<Spot> {
        let positions: Vec<Option<Position>> = indices.iter().map(|index| self.position(ctx, index)).collect();
        let positions: Vec<Position> = positions.into_iter().collect::<Option<_>>()?;
        match spot.ty.clone() {
            _ if spot.part.is_some() => {
                self.refuse(Code::UnknownMember, span, "this is not an array", "a slice has no elements", "");
                None
            }
            DataType::Array(array) => self.array_element(spot, &array, positions, indices, span),
            DataType::OpenArray(open) => self.open_element(ctx, spot, &open, positions, span),
            DataType::String(length) => {
                let character = (Elementary::Char, STRING_HEADER, 1);
                self.character(ctx.scope.rules, spot, length.into(), character, positions, span)
            }
            DataType::WideString(length) => {
                let character = (Elementary::Wchar, WIDE_HEADER, 2);
                self.character(ctx.scope.rules, spot, length.into(), character, positions, span)
            }
            other => {
                let label = format!("the name before it is of type {}", layout::type_name(&other));
                let text = self.program.globals.text(span);
                let help = match (&other, text.strip_suffix(']').and_then(|text| text.rsplit_once('['))) {
                    (DataType::Elementary(ty), Some((name, bit)))
                        if ty.class() == Class::Bits && bit.trim().parse::<u32>().is_ok_and(|bit| bit < ty.bits()) =>
                    {
                        format!("a bit of it is `{name}.%X{}`", bit.trim())
                    }
                    (_, Some((name, _))) => format!("write `{name}`, or declare it as an array"),
                    _ => String::new(),
                };
                self.refuse(Code::UnknownMember, span, "this is not an array", &label, &help);
                None
            }
        }
    }

    fn array_element(
        &mut self,
        mut spot: Spot,
        array: &Rc<ArrayType>,
        positions: Vec<Position>,
        nodes: &[Node],
        span: Span,
    ) -> Option<Spot> {
        let (given, declared) = (positions.len(), array.bounds.len());
        if given > declared {
            let inner = match &array.element {
                DataType::Array(inner) => inner.bounds.len(),
                _ => 0,
            };
            let help = self.indices_as_declared(nodes, declared, inner, span);
            self.program.report(path::index_count(given, declared, span).help(help));
            return None;
        }
        let mut bits = 0u32;
        for (dimension, position) in positions.into_iter().enumerate() {
            let (low, high) = array.bounds[dimension];
            let stride = layout::distance(array, dimension);
            match position {
                Position::Known(index) => {
                    if index < i64::from(low) || index > i64::from(high) {
                        let title = format!("index {index} is outside the array");
                        let label = format!("the array goes from {low} to {high}");
                        let help = format!("write an index from {low} to {high}, or declare a larger array");
                        self.refuse(Code::ArrayIndex, nodes[dimension].span, &title, &label, &help);
                        return None;
                    }
                    bits = bits.wrapping_add(((index - i64::from(low)) as u32).wrapping_mul(stride));
                }
                Position::Dynamic(value) => {
                    spot.indices.push(Index { value, bounds: IndexBounds::Known(low, high), stride });
                }
            }
        }
        // Arrays begin at a byte.
        spot.byte = spot.byte.wrapping_add(bits / 8);
        spot.bit = (bits % 8) as u8;
        spot.ty = match &array.bounds[given..] {
            [] => array.element.clone(),
            rest => DataType::Array(Rc::new(ArrayType {
                bounds: rest.to_vec(),
                element: array.element.clone(),
                bytes: layout::array_bytes(rest, &array.element) as u32,
            })),
        };
        (spot.ty != DataType::Void).then_some(spot)
    }

    /// How the access at `span`, with the indices `nodes`, is written for an array of `declared` dimensions, whose elements have `inner`.
    fn indices_as_declared(&self, nodes: &[Node], declared: usize, inner: usize, span: Span) -> String {
        let text = |nodes: &[Node]| {
            nodes.iter().map(|node| self.program.globals.text(node.span)).collect::<Vec<_>>().join(", ")
        };
        let before = Span { end: nodes[0].span.start.max(span.start), ..span };
        let before = self.program.globals.text(before);
        let array = before.trim_end().trim_end_matches('[').trim_end();
        let (own, rest) = nodes.split_at(declared);
        match rest.len() == inner {
            true => format!("each array has brackets of its own: write `{array}[{}][{}]`", text(own), text(rest)),
            false => format!("write `{array}[{}]`", text(own)),
        }
    }

    fn index_count(&mut self, given: usize, declared: usize, span: Span) {
        self.program.report(path::index_count(given, declared, span));
    }

    /// An element of an ARRAY[*], which is always a parameter.
    fn open_element(
        &mut self,
        ctx: &SclBlock,
        mut spot: Spot,
        open: &plcc_model::types::OpenArrayType,
        positions: Vec<Position>,
        span: Span,
    ) -> Option<Spot> {
        let (given, declared) = (positions.len(), usize::from(open.dimensions));
        if given != declared {
            self.index_count(given, declared, span);
            return None;
        }
        let parameters = &ctx.block.bound.interface.parameters;
        let parameter = match spot.root {
            Root::Fixed(path::Base::Parameter(parameter)) => Some(parameter),
            Root::Fixed(path::Base::ThroughPointer(pointer)) => {
                parameters.iter().position(|parameter| parameter.byte == pointer && parameter.ty == spot.ty)
            }
            _ => None,
        };
        let Some(parameter) = parameter else {
            self.refuse(Code::OperandKind, span, "only a parameter can be an ARRAY[*]", "its bounds are not known", "");
            return None;
        };
        let stride = match &open.element {
            DataType::Elementary(Elementary::Bool) => 1,
            element => layout::stride(element) * 8,
        };
        for (dimension, position) in positions.into_iter().enumerate() {
            let value = match position {
                Position::Known(index) => {
                    let index = i32::try_from(index).unwrap_or(i32::MAX);
                    super::expression::constant_expr(u64::from(index as u32), Elementary::Dint, span)
                }
                Position::Dynamic(value) => value,
            };
            let bounds = IndexBounds::Open { parameter, dimension: dimension as u8 };
            spot.indices.push(Index { value, bounds, stride });
        }
        spot.ty = open.element.clone();
        Some(spot)
    }

    /// A character of a text. In the TIA Portal for S7-1200 and S7-1500 one that the text does not have causes no fault. Source: SCL reference, texts.
    fn character(
        &mut self,
        rules: Rules,
        mut spot: Spot,
        length: i32,
        (ty, header, bytes): (Elementary, u32, u32),
        positions: Vec<Position>,
        span: Span,
    ) -> Option<Spot> {
        let Ok([position]) = <[Position; 1]>::try_from(positions) else {
            self.refuse(Code::ArrayIndex, span, "a text has one index", "more than one given", "");
            return None;
        };
        // A formal has as many characters as its actual.
        let in_head = !rules.is_300()
            && spot.byte == 0
            && spot.indices.is_empty()
            && matches!(spot.root, Root::Fixed(path::Base::Parameter(_) | path::Base::ThroughPointer(_)));
        spot.byte += header;
        match position {
            Position::Known(index) if (2..=i64::from(length)).contains(&index) && in_head => {
                let value = super::expression::constant_expr(index as u64, Elementary::Dint, span);
                let bounds = IndexBounds::Characters { length, in_head };
                spot.indices.push(Index { value, bounds, stride: bytes * 8 });
            }
            Position::Known(index) if (1..=i64::from(length)).contains(&index) => {
                spot.byte += (index - 1) as u32 * bytes;
            }
            Position::Known(_) => {
                let label = format!("it has the characters 1 to {length}");
                let help = format!("write an index from 1 to {length}");
                self.refuse(Code::ArrayIndex, span, "this character is outside the text", &label, &help);
                return None;
            }
            Position::Dynamic(value) => {
                let bounds = match rules.is_300() {
                    true => IndexBounds::Known(1, length),
                    false => IndexBounds::Characters { length, in_head },
                };
                spot.indices.push(Index { value, bounds, stride: bytes * 8 });
            }
        }
        spot.ty = DataType::Elementary(ty);
        Some(spot)
    }

    /// An index or byte address: an integer.
    fn position(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Position> {
        let value = self.value(ctx, node)?;
        if let Value::Constant(Constant::Integer { value, .. }, _) = &value {
            return Some(Position::Known(i64::try_from(*value).unwrap_or(i64::MAX)));
        }
        if let Some((ty, bits)) = typed_constant(&value)
            && is_index(ctx, ty)
        {
            return Some(Position::Known(i64::try_from(constant::integer(ty, bits)).unwrap_or(i64::MAX)));
        }
        match value {
            Value::Elementary(expr) if is_index(ctx, expr.ty) => {
                let dint = convert::index(ctx.scope.rules, expr)?;
                Some(Position::Dynamic(dint))
            }
            other => {
                let is = message::described(&other);
                let text = self.program.globals.text(node.span);
                let meant = rewrite::of_constant(Elementary::Int, &text, rewrite::Form::Scl);
                let whole = meant.filter(|help| !help.contains("rounded"));
                let help = whole.unwrap_or_else(|| match &other {
                    Value::Elementary(expr) if matches!(expr.ty, Elementary::Real | Elementary::Lreal) => {
                        format!("write {}", message::conversion(expr.ty, Elementary::Int, &text))
                    }
                    _ => "convert it to INT or DINT".to_string(),
                });
                self.wrong_type(node.span, &is, "an integer", Some(help));
                None
            }
        }
    }

    /// Like [`Self::position`], always as an expression.
    fn address(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Expr> {
        Some(match self.position(ctx, node)? {
            Position::Known(value) => {
                let value = i32::try_from(value).unwrap_or(i32::MAX);
                super::expression::constant_expr(u64::from(value as u32), Elementary::Dint, node.span)
            }
            Position::Dynamic(expr) => expr,
        })
    }

    /// `MW[i]`, `M[b, i]`, `DB10.DW[i]`.
    pub(super) fn indexed(
        &mut self,
        ctx: &mut SclBlock,
        area: IndexedArea,
        width: Width,
        indices: &[Node],
        span: Span,
    ) -> Option<Thing> {
        let values: Vec<Option<Expr>> = indices.iter().map(|index| self.address(ctx, index)).collect();
        let values: Vec<Expr> = values.into_iter().collect::<Option<_>>()?;
        let peripheral = matches!(area, IndexedArea::Memory(Area::Pi | Area::Pq));
        let (byte, bit) = match (width, <[Expr; 2]>::try_from(values)) {
            (Width::Bit, Ok([byte, bit])) if !peripheral => (byte, Some(Box::new(bit))),
            (_, Err(values)) if values.len() == 1 && width != Width::Bit => {
                (values.into_iter().next().expect("one index is given"), None)
            }
            _ => {
                let help = "write `MW[i]` for a byte address, `M[b, i]` for a bit: byte address, then bit number";
                self.refuse(Code::ArrayIndex, span, "a wrong number of indices", "not possible with this width", help);
                return None;
            }
        };
        Some(Thing::Spot(Spot {
            root: Root::Indexed { area, byte: Box::new(byte), bit },
            byte: 0,
            bit: 0,
            indices: Vec::new(),
            ty: DataType::Elementary(type_of_width(width)),
            part: None,
        }))
    }

    pub(super) fn indexed_db(&mut self, db: Db, span: Span) -> IndexedArea {
        match db {
            Db::Known(number) => {
                self.program.use_db(number, span);
                // Reported there; the rest is still checked.
                let _ = self.program.globals.check_absolute_access(number, span);
                IndexedArea::Db(number)
            }
            Db::Dynamic(number) => IndexedArea::DynamicDb(Box::new(number)),
        }
    }

    /// `DB10.DW4`, `blk.DW4`.
    pub(super) fn db_place(
        &mut self,
        ctx: &mut SclBlock,
        db: Db,
        width: Width,
        byte: u32,
        bit: u8,
        span: Span,
    ) -> Option<Thing> {
        self.program.check_address(ctx.block, Area::Db, width, byte, span)?;
        let ty = DataType::Elementary(type_of_width(width));
        match db {
            Db::Known(number) => {
                self.program.use_db(number, span);
                self.program.globals.check_absolute_access(number, span)?;
                self.program.check_db_end(number, byte + width.bytes(), span);
                let base = path::Base::Db(number);
                Some(Thing::Spot(Spot::fixed(Variable { base, byte, bit, ty, untyped: true })))
            }
            Db::Dynamic(number) => {
                let dint =
                    |value: u32| Box::new(super::expression::constant_expr(u64::from(value), Elementary::Dint, span));
                let bit = (width == Width::Bit).then(|| dint(u32::from(bit)));
                let area = IndexedArea::DynamicDb(Box::new(number));
                let root = Root::Indexed { area, byte: dint(byte), bit };
                Some(Thing::Spot(Spot { root, byte: 0, bit: 0, indices: Vec::new(), ty, part: None }))
            }
        }
    }

    pub(super) fn no_db(&mut self, span: Span) {
        let label = "a data block is expected before the point";
        self.refuse(Code::OperandKind, span, "this is not a data block", label, "");
    }

    /// Texts that look like a call and are an address: `WORD_TO_BLOCK_DB(w)`, and `%MW(i)`, `%DB10.DW(i)` as the TIA Portal prints
    /// them for an S7-300/400. `None`: a call.
    pub(super) fn indexed_call(
        &mut self,
        ctx: &mut SclBlock,
        callee: &Node,
        arguments: &[Argument],
        span: Span,
    ) -> Option<Option<Thing>> {
        let indices = || -> Option<Vec<Node>> {
            arguments
                .iter()
                .map(|argument| if argument.name.is_none() { argument.value.clone() } else { None })
                .collect()
        };
        match &callee.kind {
            NodeKind::Name(name) if name.text.eq_ignore_ascii_case("WORD_TO_BLOCK_DB") => {
                let [Argument { value: Some(word), .. }] = arguments else { return None };
                let word = self.of_type(ctx, word, Elementary::Word);
                Some(word.map(|word| Thing::Db { db: Db::Dynamic(word), number: None }))
            }
            NodeKind::Name(name) => {
                let (area, width) = area_word(name.text.strip_prefix('%')?)?;
                let indices = indices()?;
                Some(self.indexed(ctx, IndexedArea::Memory(area), width, &indices, span))
            }
            NodeKind::Member { base, name } => {
                let NodeKind::Name(block) = &base.kind else { return None };
                if !block.text.starts_with('%') {
                    return None;
                }
                let width = db_area_word(name.text.strip_prefix('%').unwrap_or(&name.text))?;
                let indices = indices()?;
                let Some(Thing::Db { db, .. }) = self.thing(ctx, base, Intent::Read) else { return Some(None) };
                let area = self.indexed_db(db, base.span);
                Some(self.indexed(ctx, area, width, &indices, span))
            }
            _ => None,
        }
    }
}

/// Types that can be a number of elements.
fn is_index(ctx: &SclBlock, ty: Elementary) -> bool {
    ty.is_integer() || (ty.class() == Class::Bits && ty != Elementary::Bool && !ctx.scope.rules.is_300())
}
