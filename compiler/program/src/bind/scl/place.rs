//! What a name with its components, indices and slices refers to, on the way to an access.

use plcc_diag::Span;
use plcc_syntax::ast::{Area, BlockPrefix, CellKind, Width};

use super::expression::{binary_expr, constant_expr};
use crate::bind::declarations::path;
use plcc_binding::constant::Constant;
use plcc_model::Number;
use plcc_model::scl::{Access, Base, BinaryOp, Expr, Index, IndexedArea, Part};
use plcc_model::types::{DataType, Elementary, Member};

/// Where a variable begins.
#[derive(Clone, Debug)]
pub enum Root {
    Fixed(path::Base),
    Indexed { area: IndexedArea, byte: Box<Expr>, bit: Option<Box<Expr>> },
}

/// A variable or a part of one.
#[derive(Clone, Debug)]
pub struct Spot {
    pub root: Root,
    /// From the root; for variables and parts at a fixed position.
    pub byte: u32,
    pub bit: u8,
    pub indices: Vec<Index>,
    pub ty: DataType,
    pub part: Option<Part>,
}

impl Spot {
    pub fn fixed(variable: path::Variable) -> Spot {
        let path::Variable { base, byte, bit, ty, untyped: _ } = variable;
        Spot { root: Root::Fixed(base), byte, bit, indices: Vec::new(), ty, part: None }
    }

    pub fn lies_in_db(&self, number: u16) -> bool {
        matches!(self.root, Root::Fixed(path::Base::Db(own)) if own == number)
    }

    pub fn access(self, span: Span) -> Access {
        let Spot { root, byte, bit, indices, ty, part } = self;
        let base = match root {
            Root::Fixed(base) => Base::Place(base.at(byte, bit)),
            Root::Indexed { area, byte: start, bit: first } => Base::Indexed {
                area,
                byte: moved(start, byte, span),
                bit: first.or_else(|| bit_number(&ty, &indices, bit, span)),
            },
        };
        Access { base, indices, ty, part, span }
    }

    /// The same variable, both without run-time indices.
    pub fn is_same(&self, other: &Spot) -> bool {
        match (&self.root, &other.root) {
            (Root::Fixed(a), Root::Fixed(b)) => {
                a == b
                    && (self.byte, self.bit) == (other.byte, other.bit)
                    && self.indices.is_empty()
                    && other.indices.is_empty()
            }
            _ => false,
        }
    }
}

/// A data block before a point.
#[derive(Clone, Debug)]
pub enum Db {
    Known(u16),
    /// A WORD.
    Dynamic(Expr),
}

/// The meaning of a name.
#[derive(Clone, Debug)]
pub enum Thing {
    Spot(Spot),
    Constant(Constant),
    Cell {
        kind: CellKind,
        number: Number,
    },
    /// A data block whose components are unknown.
    Block {
        prefix: BlockPrefix,
        number: Number,
    },
    /// `number`: as a parameter receives it; none after `WORD_TO_BLOCK_DB`.
    Db {
        db: Db,
        number: Option<Number>,
    },
    /// `OK`, `ENO`.
    Flag,
    /// Classic `ENO`.
    LastEno,
    /// `MW` before its index.
    Area(Area, Width),
    /// `DB10.DW` before its index.
    DbArea(Db, Width),
}

/// A byte address and `bytes` after it.
fn moved(start: Box<Expr>, bytes: u32, span: Span) -> Box<Expr> {
    if bytes == 0 {
        return start;
    }
    let more = constant_expr(bytes.into(), Elementary::Dint, span);
    Box::new(binary_expr(BinaryOp::Add, *start, more, Elementary::Dint, span))
}

/// The bit number of a BOOL that is not the first one of its byte.
fn bit_number(ty: &DataType, indices: &[Index], bit: u8, span: Span) -> Option<Box<Expr>> {
    let needed = *ty == DataType::Elementary(Elementary::Bool) && (bit > 0 || indices.is_empty());
    needed.then(|| Box::new(constant_expr(bit.into(), Elementary::Int, span)))
}

/// A component of a structure, which has no run-time address beyond its start.
pub fn part_of(access: &Access, member: &Member) -> Option<Access> {
    match &access.base {
        Base::Place(_) => shifted(access, member.byte, member.bit, &member.ty),
        Base::Indexed { area, byte, .. } => {
            let byte = moved(byte.clone(), member.byte, access.span);
            let bit = bit_number(&member.ty, &access.indices, member.bit, access.span);
            let base = Base::Indexed { area: area.clone(), byte, bit };
            Some(Access { base, ty: member.ty.clone(), ..access.clone() })
        }
    }
}

/// A component of a place, at `byte`.`bit` after its start; none if the place has no fixed start.
pub fn shifted(access: &Access, byte: u32, bit: u8, ty: &DataType) -> Option<Access> {
    use plcc_model::Place;
    let Base::Place(place) = &access.base else { return None };
    let mut place = place.clone();
    match &mut place {
        Place::I { byte: at, bit: at_bit }
        | Place::Q { byte: at, bit: at_bit }
        | Place::M { byte: at, bit: at_bit }
        | Place::L { byte: at, bit: at_bit }
        | Place::Db { byte: at, bit: at_bit, .. }
        | Place::Instance { byte: at, bit: at_bit }
        | Place::Parameter { byte: at, bit: at_bit, .. }
        | Place::ThroughPointer { byte: at, bit: at_bit, .. } => {
            *at += byte;
            *at_bit = bit;
        }
        Place::Pi { .. }
        | Place::Pq { .. }
        | Place::OpenDb { .. }
        | Place::OpenDi { .. }
        | Place::Indirect { .. }
        | Place::Register { .. }
        | Place::Element { .. } => return None,
    }
    Some(Access { base: Base::Place(place), ty: ty.clone(), ..access.clone() })
}
