//! Jump labels of a function while it is built. The same for all families.

use std::hash::Hash;

use plcc_ir::{Block, FunctionBuilder};
use rustc_hash::FxHashMap;

/// A label: its block, and how many of its jumps are not built yet.
#[derive(Clone, Copy)]
pub struct Label {
    pub block: Block,
    /// The block has its position: jumps to it go backward.
    pub placed: bool,
    jumps_left: u32,
}

/// The labels of a function, by what names them.
pub struct Labels<K> {
    labels: FxHashMap<K, Label>,
}

impl<K> Default for Labels<K> {
    fn default() -> Labels<K> {
        Labels { labels: FxHashMap::default() }
    }
}

impl<K: Copy + Eq + Hash> Labels<K> {
    /// `jumps` more statements jump to the label.
    pub fn declare(&mut self, b: &mut FunctionBuilder, name: K, jumps: u32) {
        let label =
            self.labels.entry(name).or_insert_with(|| Label { block: b.create_block(), placed: false, jumps_left: 0 });
        label.jumps_left += jumps;
    }

    pub fn get(&self, name: K) -> Option<Label> {
        self.labels.get(&name).copied()
    }

    /// Code built from now on is at the label, if it is declared.
    pub fn place(&mut self, b: &mut FunctionBuilder, name: K) {
        let Some(label) = self.labels.get_mut(&name) else { return };
        label.placed = true;
        if b.is_reachable() {
            b.jump(label.block, &[]);
        }
        if label.jumps_left == 0 {
            b.seal_block(label.block);
        }
        b.switch_to(label.block);
    }

    /// A jump to the label has been built, or is unreachable; seals its block after the last one.
    pub fn jump_done(&mut self, b: &mut FunctionBuilder, name: K) {
        let label = self.labels.get_mut(&name).expect("labels are declared before statements are lowered");
        label.jumps_left -= 1;
        if label.jumps_left == 0 && label.placed {
            b.seal_block(label.block);
        }
    }
}
