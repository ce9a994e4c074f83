//! The block whose statements are bound.

use std::rc::Rc;

use plcc_abi::layout::L_CLASS_BYTES;
use plcc_diag::Span;
use plcc_model::BlockKey;
use plcc_syntax::ast::{Area, Width};
use rustc_hash::FxHashSet;

use crate::bind::declarations::Declarations;
use crate::bind::declarations::typed::BoundInterface;

/// A block while its statements are bound, in any language.
pub struct CurrentBlock {
    pub key: BlockKey,
    pub bound: Rc<BoundInterface>,
    /// Folded; each is reported once.
    pub unknown_locals: FxHashSet<String>,
    /// End of the local data that direct addresses touch.
    pub local_bytes: u32,
    /// Data blocks whose numbers STL passes to a DB_ANY.
    pub named_dbs: Vec<(u16, Span)>,
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
            named_dbs: Vec::new(),
            fragment: false,
            fixed_span: None,
        }
    }
}

impl Declarations<'_> {
    /// Checks an address of a block's statements; `None` if it cannot exist, which is reported.
    pub fn check_address(
        &mut self,
        ctx: &mut CurrentBlock,
        area: Area,
        width: Width,
        byte: u32,
        span: Span,
    ) -> Option<()> {
        let end = u64::from(byte) + u64::from(width.bytes());
        if area == Area::L && end <= u64::from(L_CLASS_BYTES) {
            ctx.local_bytes = ctx.local_bytes.max(end as u32);
        }
        self.globals.check_area(area, width, byte, span)
    }
}
