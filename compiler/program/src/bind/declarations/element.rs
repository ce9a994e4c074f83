//! Elements of arrays and characters of texts. Their indices are constants, and in STL on an S7-1500 also variables.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::Class;
use plcc_syntax::ast::{Bound, Path, PathRoot};

use crate::bind::declarations::Declarations;
use crate::bind::declarations::block::CurrentBlock;
use crate::bind::declarations::path::{Resolved, Variable, index_count};
use crate::bind::globals::sources::portal_cpu;
use plcc_binding::fold;
use plcc_model::types::{ArrayType, DataType, Elementary};
use plcc_model::{ElementIndex, Place, layout};

/// Maximum and actual length, before the characters.
const STRING_HEADER_BYTES: u32 = 2;

/// An index.
pub enum Position {
    Known(i64),
    /// The variable that has it.
    Variable(Place, Elementary),
}

impl Declarations<'_> {
    /// The indices in brackets; variables only in the statements of a block.
    pub fn positions(&mut self, mut ctx: Option<&mut CurrentBlock>, values: &[Bound]) -> Option<Vec<Position>> {
        values.iter().map(|value| self.position(ctx.as_deref_mut(), value)).collect()
    }

    fn position(&mut self, ctx: Option<&mut CurrentBlock>, value: &Bound) -> Option<Position> {
        let Some(ctx) = ctx else { return self.bound(value).map(Position::Known) };
        match value {
            Bound::Number(..) | Bound::Expr(_) => self.bound(value).map(Position::Known),
            Bound::Path(path) => self.named_position(ctx, path),
            Bound::Name(name, span) => {
                let root = PathRoot::Bare { name: name.clone(), span: *span };
                self.named_position(ctx, &Path { root, parts: Vec::new(), span: *span })
            }
        }
    }

    fn named_position(&mut self, ctx: &mut CurrentBlock, path: &Path) -> Option<Position> {
        if let Some(number) = self.constant_position(ctx, path) {
            return Some(Position::Known(number));
        }
        if !portal_cpu(self.globals.input) {
            let name = path.name().map_or_else(|| self.globals.text(path.span), str::to_owned);
            return self.not_a_constant(&name, path.span);
        }
        let (resolved, indices) = self.resolve(ctx, path)?;
        let is = match resolved {
            Resolved::Variable(variable) => match variable.ty {
                DataType::Elementary(ty) if is_index(ty) => {
                    return Some(Position::Variable(variable.place().with_indices(indices), ty));
                }
                // Its type is unknown, which is reported.
                DataType::Void => return None,
                ty => format!("is of type {}", layout::type_name(&ty)),
            },
            Resolved::Cell { .. } => "is a timer or a counter".to_owned(),
            Resolved::Block { .. } => "is a block".to_owned(),
        };
        let text = self.globals.text(path.span);
        self.report(
            Diagnostic::new(Code::TypeMismatch, path.span, format!("`{text}` is not an index"))
                .label(is)
                .help("name an integer of up to 32 bits, e.g. a variable of type INT"),
        );
        None
    }

    fn constant_position(&self, ctx: &CurrentBlock, path: &Path) -> Option<i64> {
        let name = path.name()?;
        let folded = fold(name);
        let own = !matches!(path.root, PathRoot::Quoted { .. });
        if own && ctx.bound.locals.contains_key(&folded) {
            return None;
        }
        match ctx.bound.constants.get(&folded).filter(|_| own) {
            Some(constant) => i64::try_from(constant.integer()?).ok(),
            None => self.constant_number(name),
        }
    }

    /// Goes from an array to one of its elements. `moved`: the variable indices on the way.
    pub fn element(
        &mut self,
        variable: &mut Variable,
        moved: &mut Vec<ElementIndex>,
        array: &ArrayType,
        positions: Vec<Position>,
        span: Span,
    ) -> Option<()> {
        let (given, declared) = (positions.len(), array.bounds.len());
        if given != declared {
            self.report(index_count(given, declared, span));
            return None;
        }
        let at_lowest = |(position, (low, _)): (&Position, &(i32, i32))| match position {
            Position::Known(index) => *index,
            Position::Variable(..) => i64::from(*low),
        };
        let known: Vec<i64> = positions.iter().zip(&array.bounds).map(at_lowest).collect();
        let index = match layout::element_index(array, &known) {
            Ok(index) => index,
            Err(dimension) => {
                let (low, high) = array.bounds[dimension];
                self.report(
                    Diagnostic::new(Code::ArrayIndex, span, format!("index {} is outside the array", known[dimension]))
                        .label(format!("the array goes from {low} to {high}"))
                        .help(format!("write an index from {low} to {high}, or declare a larger array")),
                );
                return None;
            }
        };
        let (byte, bit) = layout::element_place(array, index);
        variable.byte += byte;
        variable.bit = bit;
        variable.ty = array.element.clone();
        for (dimension, position) in positions.into_iter().enumerate() {
            if let Position::Variable(place, ty) = position {
                let (low, high) = array.bounds[dimension];
                moved.push(ElementIndex { place, ty, low, high, stride: layout::distance(array, dimension) });
            }
        }
        Some(())
    }

    /// Goes from a STRING to one of its characters.
    pub fn character(
        &mut self,
        variable: &mut Variable,
        moved: &mut Vec<ElementIndex>,
        length: u8,
        positions: Vec<Position>,
        span: Span,
    ) -> Option<()> {
        let first = variable.byte + STRING_HEADER_BYTES;
        match <[Position; 1]>::try_from(positions) {
            Ok([Position::Known(index)]) if (1..=i64::from(length)).contains(&index) => {
                variable.byte = first + index as u32 - 1;
            }
            Ok([Position::Variable(place, ty)]) => {
                variable.byte = first;
                moved.push(ElementIndex { place, ty, low: 1, high: length.into(), stride: 8 });
            }
            Ok([Position::Known(_)]) | Err(_) => {
                self.report(
                    Diagnostic::new(Code::ArrayIndex, span, "this character is outside the STRING")
                        .label(format!("the STRING has the characters 1 to {length}")),
                );
                return None;
            }
        }
        variable.ty = DataType::Elementary(Elementary::Char);
        Some(())
    }
}

/// Types that an index may have: those of what an accumulator holds.
fn is_index(ty: Elementary) -> bool {
    let is_whole = ty.is_integer() || ty.class() == Class::Bits && ty != Elementary::Bool;
    is_whole && ty.bits() <= 32
}
