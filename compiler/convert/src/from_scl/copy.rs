//! Assignments of whole arrays and structures: BLKMOV. An element with a variable index is an ANY that the statements make; in local data, or
//! where its area is that of a parameter, it is copied piece by piece.
//!
//! Source: System and standard functions, SFC 20 BLKMOV; STL reference, format of ANY.

use plcc_model::scl::{Access, Base, Complex, ExprKind, IndexBounds, Statement};
use plcc_model::types::{DataType, Elementary, ParameterType};
use plcc_model::{Place, layout};
use plcc_syntax::ast::{self, AddressRegister, BlockName, BlockPrefix, Operand, OperandKind, SpecialRegister, Width};
use plcc_syntax::literal::Literal;
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::address::{ADDRESS_MASK, Target};

/// BLKMOV.
const BLOCK_MOVE: u32 = 20;

/// The first bytes of an ANY of bytes.
const ANY_OF_BYTES: u32 = 0x1002_0000;

/// The most bytes that are copied piece by piece.
const PIECES_MAX: u32 = 64;

impl Maker<'_> {
    /// An array or a structure.
    pub fn copy(&mut self, target: &Access, source: &Complex, bytes: u32, statement: &Statement) {
        if let Complex::Const(bytes) = source
            && self.store_components(target, bytes)
        {
            return;
        }
        let Complex::Variable(source) = source else {
            return self.refuse(statement.span, "this assignment of a whole variable", "assign its components");
        };
        // BLKMOV and the pieces go from the first byte to the last one.
        if may_overlap(target, source, bytes) {
            let help = "copy the elements in a loop";
            return self.refuse(statement.span, "a copy of elements onto others of their array", help);
        }
        if self.is_block(target, bytes) && self.is_block(source, bytes) {
            // The target is the first whose indices are computed.
            let Some(to) = self.block_of(target, bytes) else { return };
            let Some(from) = self.block_of(source, bytes) else { return };
            return self.move_block(from, to);
        }
        if bytes > PIECES_MAX {
            let help = "assign the components of the element";
            return self.refuse(statement.span, "an assignment of a whole element with a variable index", help);
        }
        let Some(to) = self.stored_address(target) else { return };
        let Some(from) = self.stored_address(source) else { return };
        let mut done = 0;
        while done < bytes {
            let ty = match bytes - done {
                4.. => Elementary::Dword,
                2 | 3 => Elementary::Word,
                _ => Elementary::Byte,
            };
            for (insn, place) in [(StlInsn::Load, &from), (StlInsn::Transfer, &to)] {
                let operand = self.reach_at(place, ty, done);
                self.push(insn, Some(operand));
            }
            done += ty.bits() / 8;
        }
    }

    fn move_block(&mut self, from: Operand, to: Operand) {
        let result = self.temporary(Elementary::Int);
        let parameter = |name: &str, actual: Operand| ast::Parameter {
            name: name.to_string(),
            name_span: self.span,
            actual: Some(actual),
        };
        let name = BlockName::Numbered { prefix: BlockPrefix::Sfc, number: BLOCK_MOVE, span: self.span };
        let call = ast::Call {
            target: Operand { kind: OperandKind::Block(name), span: self.span },
            types: Vec::new(),
            instance: None,
            parameters: vec![parameter("SRCBLK", from), parameter("RET_VAL", result), parameter("DSTBLK", to)],
        };
        self.push_kind(ast::StatementKind::Call(Box::new(call)));
    }

    /// BLKMOV can reach it.
    fn is_block(&self, access: &Access, bytes: u32) -> bool {
        let has_area = matches!(&access.base, Base::Place(place) if area_of(place).is_some());
        self.is_operand(access, bytes) || has_area && bytes <= u32::from(u16::MAX)
    }

    /// An operand is all of it: MOVE_BLK and FILL_BLK copy several elements from one on.
    fn is_operand(&self, access: &Access, bytes: u32) -> bool {
        self.is_direct(access) && bytes <= layout::bytes(&access.ty)
    }

    /// A variable itself, or an ANY of it.
    fn block_of(&mut self, access: &Access, bytes: u32) -> Option<Operand> {
        let Base::Place(place) = &access.base else { return None };
        if self.is_operand(access, bytes) {
            return self.operand(access);
        }
        let (area, number) = area_of(place)?;
        let through = self.address(access)?;
        self.dword_constant(StlInsn::AndD, ADDRESS_MASK);
        self.dword_constant(StlInsn::OrD, area << 24);
        let pointer = self.keep(Elementary::Dword);
        let number = match number {
            Some(register) => {
                if let Some(open) = through.open {
                    self.push(StlInsn::OpenDb, Some(open));
                }
                self.push(StlInsn::Load, Some(self.here(OperandKind::Special(register))));
                self.keep(Elementary::Word)
            }
            None => super::code::number(0, self.span),
        };
        let any = self.variable(&DataType::Parameter(ParameterType::Any), "any");
        let OperandKind::Path(path) = &any.kind else { return None };
        self.push(StlInsn::Load, Some(self.here(OperandKind::AddressOf(path.clone()))));
        self.push(StlInsn::LoadAr1, None);
        let head = self.here(OperandKind::Literal(Literal::Dword(ANY_OF_BYTES | bytes)));
        for (value, width, byte) in [(head, Width::Dword, 0), (number, Width::Word, 4), (pointer, Width::Dword, 6)] {
            let register = AddressRegister::Ar1;
            let there = OperandKind::RegisterIndirect { area: None, width, register, offset: byte * 8 };
            self.push(StlInsn::Load, Some(value));
            self.push(StlInsn::Transfer, Some(self.here(there)));
        }
        Some(any)
    }

    /// The address of a variable, in another one.
    pub fn stored_address(&mut self, access: &Access) -> Option<Target> {
        let through = self.address(access)?;
        Some(Target::Stored(through, self.keep(Elementary::Dword)))
    }

    fn here(&self, kind: OperandKind) -> Operand {
        Operand { kind, span: self.span }
    }
}

/// Several elements may be copied onto some of themselves; one element and another one are the same or apart.
fn may_overlap(target: &Access, source: &Access, bytes: u32) -> bool {
    let is_one = |access: &Access| bytes <= layout::bytes(&access.ty);
    if is_one(target) && is_one(source) {
        return false;
    }
    let is_far = |place: &Place| matches!(place, Place::Parameter { .. } | Place::ThroughPointer { .. });
    match (beginning(target), beginning(source)) {
        (Some((area, to)), Some((other, from))) if area == other => to.abs_diff(from) < u64::from(bytes) * 8,
        (Some((area, _)), Some((other, _))) => is_far(&area) || is_far(&other),
        _ => true,
    }
}

/// The place at which the area of a variable begins, and how many bits after it the variable does; its indices are constants.
fn beginning(access: &Access) -> Option<(Place, i64)> {
    let Base::Place(place) = &access.base else { return None };
    let mut area = place.clone();
    let (byte, bit) = area.position_mut()?;
    let mut distance = i64::from(*byte) * 8 + i64::from(*bit);
    (*byte, *bit) = (0, 0);
    for index in &access.indices {
        let (IndexBounds::Known(low, _), ExprKind::Const(bits)) = (index.bounds, &index.value.kind) else {
            return None;
        };
        distance += (i64::from(*bits as u32 as i32) - i64::from(low)) * i64::from(index.stride);
    }
    Some((area, distance))
}

/// The code of an area in pointers, and where the number of its data block is. Local data have none: what an ANY of these means depends on the
/// block that reads it.
fn area_of(place: &Place) -> Option<(u32, Option<SpecialRegister>)> {
    match place {
        Place::I { .. } => Some((0x81, None)),
        Place::Q { .. } => Some((0x82, None)),
        Place::M { .. } => Some((0x83, None)),
        Place::Db { .. } => Some((0x84, Some(SpecialRegister::DbNumber))),
        Place::Instance { .. } => Some((0x84, Some(SpecialRegister::DiNumber))),
        Place::L { .. }
        | Place::Pi { .. }
        | Place::Pq { .. }
        | Place::OpenDb { .. }
        | Place::OpenDi { .. }
        | Place::Parameter { .. }
        | Place::ThroughPointer { .. }
        | Place::Indirect { .. }
        | Place::Register { .. }
        | Place::Element { .. } => None,
    }
}
