//! A module of the IR: the functions of one PLC program.

use plcc_abi::image::Site;

use crate::entities::{EntityVec, FuncId};
use crate::function::Function;

/// A DB that exists before the first cycle and is never deleted: its address is a constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StaticDb {
    pub number: u16,
    /// Offset from the memory base.
    pub address: u32,
    /// Length in bytes.
    pub length: u32,
    /// The program cannot write to it.
    pub read_only: bool,
}

/// Lengths of the areas of the CPU in bytes; 0: not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Areas {
    /// The process image of inputs.
    pub inputs: u32,
    /// The process image of outputs.
    pub outputs: u32,
    pub bit_memory: u32,
}

/// The functions of one PLC program and everything that they refer to.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Module {
    pub functions: EntityVec<FuncId, Function>,
    /// Functions that the runtime calls, in the order of their entry numbers. They take and return nothing; CPU registers travel in
    /// the CPU state.
    pub entries: Vec<FuncId>,
    /// Sorted by number.
    pub dbs: Vec<StaticDb>,
    /// [`Loc`](crate::Loc) n points to `sites[n - 1]`.
    pub sites: Vec<Site>,
    pub files: Vec<String>,
    /// The text of a module does not have them.
    pub areas: Areas,
}

impl Module {
    /// The DB `number`, if the module has its address.
    pub fn db(&self, number: u16) -> Option<&StaticDb> {
        self.dbs.binary_search_by_key(&number, |db| db.number).ok().map(|index| &self.dbs[index])
    }
}
