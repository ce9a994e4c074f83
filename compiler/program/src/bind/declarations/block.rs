//! The block whose statements are bound.

use std::rc::Rc;

use plcc_diag::Span;
use plcc_model::BlockKey;
use rustc_hash::FxHashSet;

use crate::bind::declarations::types::BoundInterface;

/// A block while its statements are bound, in any language.
pub struct CurrentBlock {
    pub key: BlockKey,
    pub bound: Rc<BoundInterface>,
    /// Folded; each is reported once.
    pub unknown_locals: FxHashSet<String>,
    /// End of the local data that direct addresses touch.
    pub local_bytes: u32,
    /// The block is a list of statements without a header.
    pub fragment: bool,
    /// Represents all statements of a system block.
    pub fixed_span: Option<Span>,
}

impl CurrentBlock {
    pub fn new(key: BlockKey, bound: Rc<BoundInterface>) -> CurrentBlock {
        CurrentBlock {
            key,
            bound,
            unknown_locals: FxHashSet::default(),
            local_bytes: 0,
            fragment: false,
            fixed_span: None,
        }
    }
}
