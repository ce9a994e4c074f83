//! Elements of arrays whose index STL reads when it accesses them. An index out of its bounds is the error that it is in SCL.

use plcc_ir::Value;
use plcc_model::layout;
use plcc_model::{ElementIndex, Place, Width};

use super::{Direction, Target};
use crate::block::BlockLowering;
use crate::scl::located::Located;

impl BlockLowering<'_, '_> {
    /// The access to an element that is at `base` with the lowest indices.
    pub(super) fn element_target(
        &mut self,
        base: &Place,
        indices: &[ElementIndex],
        width: Width,
        direction: Direction,
    ) -> Target {
        let located = self.located_element(base, indices);
        let mut target = self.target(base, width, direction);
        self.move_located(&mut target, &located, width, direction);
        target
    }

    /// Reads the indices of an element that is at `base` with the lowest ones.
    pub fn located_element<'m>(&mut self, base: &'m Place, indices: &[ElementIndex]) -> Located<'m> {
        let (mut offset, mut in_bounds) = (self.b.i32_const(0), self.b.bool_const(true));
        let mut only = None;
        for index in indices {
            let value = self.index_value(index);
            let (distance, ok) = self.index_in_bounds(value, (index.low, index.high), index.stride);
            offset = self.b.iadd(offset, distance);
            in_bounds = self.b.and(in_bounds, ok);
            only = (indices.len() == 1).then_some(value);
        }
        Located::element(base, offset, in_bounds, only)
    }

    /// The value of an index, an i32. The open data block stays the same.
    pub fn index_value(&mut self, index: &ElementIndex) -> Value {
        let db = self.get(self.regs.db);
        let value = self.read(&index.place, layout::width(index.ty));
        self.set(self.regs.db, db);
        let value = self.typed(value, index.ty);
        self.as_i32(value, index.ty)
    }
}
