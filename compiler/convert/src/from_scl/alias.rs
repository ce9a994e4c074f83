//! Elements of arrays that a function gets as a copy in STL, while it also uses the array by its own name: `"F"(io := "D".a[i])`.
//!
//! SCL passes the element itself, so that the function sees there at once what it writes to the parameter. Blocks in STL are not looked at.

use std::collections::HashSet;
use std::ops::Range;

use plcc_model::scl::walk::{self, Role, Visitor};
use plcc_model::scl::{Access, Base, Call, IndexBounds};
use plcc_model::{BlockKey, Body, CodeBlock, Place, Program, layout};

/// Whether a block, or one that it calls, uses the array in a data block of which `access` is an element.
pub fn uses_array(program: &Program, callee: &CodeBlock, access: &Access) -> bool {
    let Some((db, bytes)) = reached(access) else { return false };
    let mut uses = Uses { db, bytes, found: false, calls: vec![callee.key()] };
    let mut seen = HashSet::new();
    while let Some(key) = uses.calls.pop() {
        let body = program.block(key).filter(|_| seen.insert(key)).map(|block| &block.body);
        if let Some(Body::Scl(body)) = body {
            walk::statements(&body.statements, &mut uses);
        }
    }
    uses.found
}

/// The data block of an access by name, and the bytes that it may reach with any index.
fn reached(access: &Access) -> Option<(u16, Range<u32>)> {
    let Base::Place(Place::Db { number, byte, bit }) = access.base else { return None };
    let mut bits = u64::from(bit);
    for index in &access.indices {
        let IndexBounds::Known(low, high) = index.bounds else { return Some((number, byte..u32::MAX)) };
        bits += u64::from(high.abs_diff(low)) * u64::from(index.stride);
    }
    let last = u32::try_from(bits / 8).unwrap_or(u32::MAX);
    let end = byte.saturating_add(last).saturating_add(layout::bytes(&access.ty).max(1));
    Some((number, byte..end))
}

struct Uses {
    db: u16,
    bytes: Range<u32>,
    found: bool,
    /// Blocks that are still to be looked at.
    calls: Vec<BlockKey>,
}

impl Visitor for Uses {
    fn access(&mut self, access: &Access, _role: Role) {
        let is_same = |(db, bytes): (u16, Range<u32>)| {
            db == self.db && bytes.start < self.bytes.end && self.bytes.start < bytes.end
        };
        self.found |= reached(access).is_some_and(is_same);
    }

    fn call(&mut self, call: &Call) {
        self.calls.push(call.target);
    }
}
