//! What declarations say: types, interfaces, data blocks. Statements of all languages are bound over it.
//!
//! Each is made when first needed, since declarations may be in any order.
//!
//! - [`types`] resolves data types ([`typed`]), [`predefined`] those of the language and the CPU; [`constant`] their bounds, [`initial`] start values,
//!   of which `single_value` judges those of arrays and `s5time` those of timers.
//! - [`interface`] lays out the interface of a block, [`start_inputs`] the inputs of organization blocks, [`block_constants`] its constants;
//!   [`data`] makes the data blocks, [`shipped`] has the interfaces of blocks of the library.
//! - [`path`] turns names into places, [`element`] their indices; [`unknown_member`] reports components that do not exist; [`pointer`] has the
//!   bytes of pointers.
//! - [`block`] is the block whose statements are bound; [`calls`] is what calls of all languages check.

pub mod block;
pub mod block_constants;
pub mod calls;
pub mod constant;
pub mod data;
pub mod element;
pub mod initial;
pub mod interface;
pub mod path;
pub mod pointer;
pub mod predefined;
pub mod reference;
mod s5time;
pub mod shipped;
mod single_value;
pub mod start_inputs;
pub mod symbols;
pub mod typed;
pub mod types;
pub mod unknown_member;

use std::rc::Rc;

use plcc_diag::{Diagnostic, FileId};
use plcc_syntax::Elementary;
use rustc_hash::FxHashMap;

use crate::bind::globals::Globals;
use calls::InstancePointers;
use data::DataBlocks;
use plcc_binding::BindInput;
use plcc_model::BlockKey;
use typed::BoundInterface;
use types::Types;

/// A value that is made when first needed.
pub enum State<T> {
    /// In progress: a use now means a loop.
    Running,
    Done(T),
}

/// What the program declares.
pub struct Declarations<'a> {
    pub globals: Globals<'a>,
    pub types: Types,
    pub interfaces: FxHashMap<BlockKey, State<Option<Rc<BoundInterface>>>>,
    pub data: DataBlocks,
    pub pointers: InstancePointers,
    /// The declared types of numbers and durations that statements in STL load and transfer, for the review.
    pub numbers: NumberTypes,
}

/// Types of numbers and TIMEs by the file and the end of the operand that names one.
pub type NumberTypes = FxHashMap<(FileId, u32), Elementary>;

impl<'a> Declarations<'a> {
    pub fn new(input: &'a BindInput<'a>) -> Declarations<'a> {
        Declarations {
            globals: Globals::new(input),
            types: Types::default(),
            interfaces: FxHashMap::default(),
            data: DataBlocks::default(),
            pointers: InstancePointers::default(),
            numbers: NumberTypes::default(),
        }
    }

    /// Reports a message.
    pub fn report(&mut self, message: Diagnostic) {
        self.globals.report.push(message);
    }
}
