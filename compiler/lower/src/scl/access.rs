//! Values of variables: reads and writes, slices, promoted variables. Source: SCL reference, addressing.
//!
//! `located` has the places.

use plcc_ir::{BinaryOp, Block, Type, Value};
use plcc_model::scl::{Access, Base, Part};
use plcc_model::types::{DataType, Elementary};
use plcc_model::{Place, Width, layout};

use super::located::{Character, Located};
use super::{promote, value_type};
use crate::block::BlockLowering;
use crate::fault::Substitute;
use crate::place::{Direction, TargetKind};

impl BlockLowering<'_, '_> {
    /// Reads an elementary variable: a value of the type of [`Access::elementary`].
    pub fn read_access(&mut self, access: &Access) -> Value {
        if let Some(var) = self.promoted(access) {
            let value = self.b.use_var(var);
            return self.part_of(access, value);
        }
        if let (DataType::Parameter(_), Base::Place(place)) = (&access.ty, &access.base) {
            return self.block_number(place);
        }
        let located = self.locate(access);
        self.read_located(access, &located)
    }

    /// Number of the data block of a formal parameter BLOCK_DB, an i16.
    fn block_number(&mut self, place: &Place) -> Value {
        let number = match place {
            Place::Parameter { parameter, .. } => self.parameters[*parameter][0],
            place => self.read(place, Width::Word),
        };
        self.b.trunc(Type::I16, number)
    }

    pub fn read_located(&mut self, access: &Access, located: &Located) -> Value {
        let DataType::Elementary(ty) = access.ty else {
            unreachable!("the binder reads elementary variables as values")
        };
        let value = match located.character() {
            Some(character) => self.read_character(located, character, ty),
            None => self.read_typed(located, ty),
        };
        self.part_of(access, value)
    }

    fn read_typed(&mut self, located: &Located, ty: Elementary) -> Value {
        let value = self.read_at(located, layout::width(ty));
        self.typed(value, ty)
    }

    /// A character of a text, 0 if the text does not have it.
    fn read_character(&mut self, located: &Located, character: Character, ty: Elementary) -> Value {
        if self.open_question(located).is_some() {
            let value = self.read_typed(located, ty);
            let missing = self.b.not(character.there);
            self.fail_if(missing);
            let none = self.zero(ty);
            return self.b.select(character.there, value, none);
        }
        let result = self.b.declare_var(value_type(ty));
        let none = self.zero(ty);
        self.b.def_var(result, none);
        let after = self.begin_character(character);
        let value = self.read_typed(&located.of_character(character), ty);
        self.b.def_var(result, value);
        self.end_guard(after);
        self.b.use_var(result)
    }

    /// Begins the way on which a text has a character, for [`end_guard`](Self::end_guard). One that its text does not have clears the bit.
    fn begin_character(&mut self, character: Character) -> Option<Block> {
        if self.b.constant_bits(character.there) == Some(1) {
            return None;
        }
        let (there, missing, after) = (self.b.create_block(), self.b.create_cold_block(), self.b.create_block());
        self.b.branch(character.there, there, missing);
        self.b.seal_block(there);
        self.b.seal_block(missing);
        self.b.switch_to(missing);
        let failed = self.b.bool_const(true);
        self.fail_if(failed);
        self.b.jump(after, &[]);
        self.b.switch_to(there);
        Some(after)
    }

    /// As [`read`](Self::read).
    pub(super) fn read_at(&mut self, located: &Located, width: Width) -> Value {
        let result = self.result_of(width);
        let by_reference = self.by_located_reference(located, width, Direction::Read, &mut |this, target| {
            let value = this.read_target(target, width);
            this.b.def_var(result, value);
        });
        if by_reference {
            return self.b.use_var(result);
        }
        let target = self.located_target(located, width, Direction::Read);
        self.read_target(target, width)
    }

    /// Writes an elementary variable; `value` has the type of [`Access::elementary`].
    pub fn write_access(&mut self, access: &Access, value: Value) {
        if let Some(var) = self.promoted(access) {
            let whole = match access.part {
                Some(part) => {
                    let before = self.b.use_var(var);
                    self.with_part(before, part, value)
                }
                None => value,
            };
            self.b.def_var(var, whole);
            self.probe_write(access, value);
            return;
        }
        let located = self.locate(access);
        self.write_located(access, &located, value);
    }

    pub fn write_located(&mut self, access: &Access, located: &Located, value: Value) {
        self.store_located(access, located, value);
        self.probe_write(access, value);
    }

    fn store_located(&mut self, access: &Access, located: &Located, value: Value) {
        let DataType::Elementary(ty) = access.ty else {
            unreachable!("the binder writes elementary variables as values")
        };
        let width = layout::width(ty);
        if let Some(character) = located.character() {
            let check = self.index_check(located, width, Direction::Write);
            let guard = self.begin_guard(check.into_iter().collect(), Substitute::None);
            let after = self.begin_character(character);
            self.store_located(access, &located.of_character(character), value);
            self.end_guard(after);
            return self.end_guard(guard);
        }
        let Some(part) = access.part else { return self.store_whole(located, ty, value) };
        if matches!(access.base, Base::Place(Place::Pq { .. })) && part.width == Width::Bit {
            let target = self.located_target(located, width, Direction::Write);
            if let TargetKind::Peripheral { address, .. } = target.kind {
                return self.write_peripheral_bit(address, part.index, value);
            }
        }
        // An index outside its bounds is one error, that of the write: the rest of the variable is not read.
        let check = self.index_check(located, width, Direction::Write);
        let guard = self.begin_guard(check.into_iter().collect(), Substitute::None);
        let before = self.read_at(located, width);
        let before = self.typed(before, ty);
        let whole = self.with_part(before, part, value);
        self.store_whole(located, ty, whole);
        self.end_guard(guard);
    }

    fn store_whole(&mut self, located: &Located, ty: Elementary, value: Value) {
        let width = layout::width(ty);
        let value = self.untyped(value, ty);
        let by_reference = self.by_located_reference(located, width, Direction::Write, &mut |this, target| {
            this.write_target(target, width, value);
        });
        if !by_reference {
            let target = self.located_target(located, width, Direction::Write);
            self.write_target(target, width, value);
        }
    }

    /// True if the variable is not in memory.
    pub fn is_promoted(&self, access: &Access) -> bool {
        self.promoted(access).is_some()
    }

    fn promoted(&self, access: &Access) -> Option<plcc_ir::Var> {
        let (slot, _) = promote::slot(access)?;
        self.scl.promoted.get(&slot).copied()
    }

    /// The result of a read of memory (i1, i32 or i64) as a value of `ty`.
    pub fn typed(&mut self, value: Value, ty: Elementary) -> Value {
        match value_type(ty) {
            Type::I1 | Type::I32 | Type::I64 => value,
            narrow @ (Type::I8 | Type::I16) => self.b.trunc(narrow, value),
            float @ (Type::F32 | Type::F64) => self.b.bitcast(float, value),
        }
    }

    /// A value of `ty` in the form for memory: i1, i32 or i64.
    pub fn untyped(&mut self, value: Value, ty: Elementary) -> Value {
        match value_type(ty) {
            Type::I1 | Type::I32 | Type::I64 => value,
            Type::I8 | Type::I16 => self.b.zext(Type::I32, value),
            Type::F32 => self.b.bitcast(Type::I32, value),
            Type::F64 => self.b.bitcast(Type::I64, value),
        }
    }

    /// The slice of a value that was read, or the value.
    fn part_of(&mut self, access: &Access, value: Value) -> Value {
        let Some(part) = access.part else { return value };
        let bits = self.as_bits(value);
        let shift = i64::from(part.index) * i64::from(part.width.bits());
        let moved = self.b.binary_imm(BinaryOp::Lshr, bits, shift);
        let ty = crate::place::width_type(part.width);
        if self.b.ty(moved) == ty { moved } else { self.b.trunc(ty, moved) }
    }

    /// `whole` with the slice replaced by `value`.
    fn with_part(&mut self, whole: Value, part: Part, value: Value) -> Value {
        let bits = self.as_bits(whole);
        let ty = self.b.ty(bits);
        let shift = i64::from(part.index) * i64::from(part.width.bits());
        let ones = if part.width.bits() == 64 { u64::MAX } else { (1 << part.width.bits()) - 1 };
        let mask = !(ones << shift) as i64;
        let others = self.b.binary_imm(BinaryOp::And, bits, mask);
        let value = if self.b.ty(value) == ty { value } else { self.b.zext(ty, value) };
        let moved = self.b.binary_imm(BinaryOp::Shl, value, shift);
        let bits = self.b.or(others, moved);
        match self.b.ty(whole) {
            float @ (Type::F32 | Type::F64) => self.b.bitcast(float, bits),
            _ => bits,
        }
    }
}
