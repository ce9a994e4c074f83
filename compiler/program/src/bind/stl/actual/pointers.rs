//! Pointers as actual parameters: constants, and pointers to the named operands.

use plcc_abi::layout::area;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{Area, Width};
use plcc_syntax::literal::Literal;

use crate::bind::declarations::block::CurrentBlock;
use crate::bind::declarations::path::type_of_width;
use crate::bind::declarations::pointer::{
    CODE_BYTE, CODE_DATE_AND_TIME, POINTS_AT_NOTHING, any_bytes, any_number_of_block, any_number_of_cell, code_for,
    for_formal, known_pointer, local_place, pointed_at, pointed_at_by_literal, pointer_bytes,
};
use crate::bind::declarations::typed::is_complex;
use crate::bind::stl::StlBinder;
use crate::bind::stl::settle::Settled;
use plcc_model::layout;
use plcc_model::types::{DataType, ParameterType};
use plcc_model::{Actual, BlockKey, Direction, Number, Parameter, Place, Pointed};

impl StlBinder<'_, '_> {
    /// The memory of `bytes` bytes at a pointer constant, checked against its area; `None` after a message.
    pub(super) fn pointed_place(
        &mut self,
        ctx: &mut CurrentBlock,
        db: u16,
        pointer: u32,
        formal: &Parameter,
        bytes: u32,
        span: Span,
    ) -> Option<Place> {
        let (byte, bit) = ((pointer & 0x00FF_FFFF) >> 3, (pointer & 7) as u8);
        let (found, place) = match (pointer >> 24) as u8 {
            area::I => (Area::I, Place::I { byte, bit }),
            area::Q => (Area::Q, Place::Q { byte, bit }),
            area::M => (Area::M, Place::M { byte, bit }),
            area::L => (Area::L, Place::L { byte, bit }),
            area::DB if db == 0 => (Area::Db, Place::OpenDb { byte, bit }),
            area::DB => (Area::Db, Place::Db { number: db, byte, bit }),
            area::DI if db == 0 => (Area::Di, Place::OpenDi { byte, bit }),
            area::P if formal.direction == Direction::Output => (Area::Pq, Place::Pq { byte, bit }),
            area::P => (Area::Pi, Place::Pi { byte, bit }),
            _ => {
                let text = self.program.globals.text(span);
                self.program.report(
                    Diagnostic::new(Code::OperandKind, span, format!("`{text}` cannot be an actual parameter"))
                        .label("not an address of this block")
                        .help("name an address of I, Q, M, L or a data block"),
                );
                return None;
            }
        };
        self.program.check_address(ctx, found, Width::Byte, byte, span)?;
        self.program.check_address(ctx, found, Width::Byte, byte.saturating_add(bytes.saturating_sub(1)), span)?;
        if let Place::Db { number, .. } = place {
            self.program.use_db(number, span);
            self.program.check_db_end(number, byte + bytes, span);
        }
        Some(place)
    }

    /// `P#DB5.DBX 20.0` for a parameter of type DATE_AND_TIME, STRING, STRUCT or ARRAY: the address of the actual. `None`: it does not
    /// fit; the outer one after a message.
    pub(super) fn complex_at_pointer(
        &mut self,
        ctx: &mut CurrentBlock,
        formal: &Parameter,
        literal: &Literal,
        span: Span,
    ) -> Option<Option<Actual>> {
        let bytes = layout::bytes(&formal.ty);
        let (db, pointer) = match literal {
            Literal::AreaPointer { db, pointer } => (*db, *pointer),
            Literal::Any([_, code, high, low, db_high, db_low, pointer @ ..]) => {
                let count = u32::from(u16::from_be_bytes([*high, *low]));
                let fits = match (*code, &formal.ty) {
                    (CODE_DATE_AND_TIME, DataType::DateAndTime) => count == 1,
                    (CODE_BYTE, DataType::String(_)) => true,
                    (CODE_BYTE, _) => count == bytes,
                    _ => false,
                };
                if !fits {
                    return Some(None);
                }
                (u16::from_be_bytes([*db_high, *db_low]), u32::from_be_bytes(*pointer))
            }
            _ => return Some(None),
        };
        let peripheral = (pointer >> 24) as u8 == area::P;
        if pointer & 7 != 0 || peripheral {
            return Some(None);
        }
        let place = self.pointed_place(ctx, db, pointer, formal, bytes, span)?;
        Some(Some(Actual::Place(place)))
    }

    pub(super) fn pointer_actual(
        &mut self,
        callee: BlockKey,
        formal: &Parameter,
        settled: Settled,
        span: Span,
    ) -> Option<Actual> {
        let to = |place: Place| match known_pointer(&place) {
            Some((db, pointer)) => Actual::PointerBytes(pointer_bytes(db, pointer)),
            None => Actual::PointerTo { place, type_code: 0, count: 0 },
        };
        match &settled {
            Settled::Literal(Literal::AreaPointer { db, pointer }) => {
                self.program.use_db(*db, span);
                Some(match local_place(*pointer) {
                    Some(place) => to(place),
                    None => Actual::PointerBytes(pointer_bytes(*db, *pointer)),
                })
            }
            Settled::Literal(Literal::Pointer(pointer)) => Some(Actual::PointerBytes(pointer_bytes(0, *pointer))),
            Settled::Memory { place, .. } => Some(to(place.clone())),
            Settled::Complex { place, ty } => match ty {
                DataType::Parameter(ParameterType::Pointer) => Some(Actual::PointerCopy(place.clone())),
                ty if is_complex(ty) => Some(to(place.clone())),
                _ => self.mismatch(callee, formal, &settled, span),
            },
            _ => self.mismatch(callee, formal, &settled, span),
        }
    }

    pub(super) fn any_actual(
        &mut self,
        callee: BlockKey,
        formal: &Parameter,
        settled: Settled,
        span: Span,
    ) -> Option<Actual> {
        let to = |place: Place, ty: &DataType, code_of: &DataType| {
            let (type_code, count) = code_for(formal, code_of);
            let count = count.min(0xFFFF) as u16;
            let any = match known_pointer(&place) {
                Some((db, pointer)) => Actual::PointerBytes(any_bytes(type_code, count, db, pointer)),
                None => Actual::PointerTo { place, type_code, count },
            };
            for_formal(formal, any, pointed_at(ty))
        };
        match &settled {
            Settled::Literal(Literal::Any(bytes)) => {
                let [_, type_code, high, low, _, _, pointer @ ..] = *bytes;
                self.program.use_pointed_db(callee, &formal.name, *bytes, span);
                let count = u16::from_be_bytes([high, low]);
                let any = match local_place(u32::from_be_bytes(pointer)) {
                    Some(place) => Actual::PointerTo { place, type_code, count },
                    None => Actual::PointerBytes(bytes.to_vec()),
                };
                Some(for_formal(formal, any, pointed_at_by_literal(type_code, count)))
            }
            Settled::Memory { place, width, ty } => {
                let ty = DataType::Elementary(ty.unwrap_or(type_of_width(*width)));
                Some(to(place.clone(), &ty, &ty))
            }
            Settled::Cell { kind, number: Number::Known(number) } => {
                Some(for_formal(formal, Actual::PointerBytes(any_number_of_cell(*kind, *number)), POINTS_AT_NOTHING))
            }
            Settled::Block { prefix, number: Number::Known(number) } => match any_number_of_block(*prefix, *number) {
                Some(bytes) => Some(for_formal(formal, Actual::PointerBytes(bytes), POINTS_AT_NOTHING)),
                None => self.mismatch(callee, formal, &settled, span),
            },
            Settled::Complex { place, ty } => match ty {
                DataType::Parameter(ParameterType::Any) => {
                    Some(for_formal(formal, Actual::PointerCopy(place.clone()), POINTS_AT_NOTHING))
                }
                DataType::Parameter(ParameterType::Variant) => {
                    Some(for_formal(formal, Actual::PointerCopy(place.clone()), Pointed::Copied))
                }
                DataType::Parameter(ParameterType::Pointer) => self.mismatch(callee, formal, &settled, span),
                ty => {
                    let longest = DataType::String(254);
                    // A STRING parameter of an FC has the length of the actual; the pointer covers the longest.
                    let code_of = match place {
                        Place::Parameter { .. } if matches!(ty, DataType::String(_)) => &longest,
                        _ => ty,
                    };
                    Some(to(place.clone(), ty, code_of))
                }
            },
            _ => self.mismatch(callee, formal, &settled, span),
        }
    }
}
