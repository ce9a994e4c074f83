//! Variable indices of actual parameters. A call reads them once, where it begins: a block that changes an index does not change which
//! element it was given.

use plcc_model::types::Elementary;
use plcc_model::{Actual, Argument, ElementIndex, Place, Width};

use crate::block::BlockLowering;
use crate::place::{BitNumber, Target};
use crate::plan;

impl BlockLowering<'_, '_> {
    /// The arguments of a call with copies of their indices in this frame; `None`: they have no variable index.
    pub(super) fn with_kept_indices(&mut self, arguments: &[Argument]) -> Option<Vec<Argument>> {
        if arguments.iter().all(|argument| argument.actual.indices().is_empty()) {
            return None;
        }
        let mut kept = arguments.to_vec();
        for argument in &mut kept {
            for index in indices_of(&mut argument.actual) {
                let value = self.index_value(index);
                let copy = self.temporary(plan::INDEX_COPY_BYTES);
                self.write_target(Target::at(copy, BitNumber::Known(0)), Width::Dword, value);
                index.place = Place::L { byte: copy.offset, bit: 0 };
                index.ty = Elementary::Dint;
            }
        }
        Some(kept)
    }
}

fn indices_of(actual: &mut Actual) -> &mut [ElementIndex] {
    match actual {
        Actual::Variant(pointer, _) => indices_of(pointer),
        Actual::Place(Place::Element { indices, .. })
        | Actual::PointerTo { place: Place::Element { indices, .. }, .. }
        | Actual::PointerCopy(Place::Element { indices, .. }) => indices,
        Actual::Const(_)
        | Actual::Place(_)
        | Actual::Number(_)
        | Actual::PointerBytes(_)
        | Actual::PointerTo { .. }
        | Actual::PointerCopy(_) => &mut [],
    }
}
