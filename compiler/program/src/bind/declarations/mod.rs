//! What the sources, the tables and the library declare.

pub mod addresses;
pub mod block;
pub mod calls;
pub mod constant;
pub mod data;
pub mod hardware;
pub mod initial;
pub mod interface;
pub mod library;
pub mod names;
pub mod ob;
pub mod path;
pub mod pointer;
pub mod predefined;
pub mod rules;
pub mod sources;
pub mod system_memory;
pub mod types;

use std::rc::Rc;

use plcc_abi::image::Config;
use plcc_diag::Span;
use plcc_syntax::ast::{self, Area, BlockPrefix, CellKind};
use rustc_hash::{FxHashMap, FxHashSet};

use library::SystemUse;
use names::Global;
use plcc_binding::BindInput;
use plcc_binding::constant::Constants;
use plcc_binding::report::Report;
use plcc_model::BlockKey;
use plcc_model::types::StructType;
use sources::{CodeSource, State};
use types::{BoundInterface, Scope, Typed, TypedStruct};

pub struct Declarations<'a> {
    pub input: &'a BindInput<'a>,
    /// As in the input, with the information from the blocks.
    pub config: Config,
    pub report: Report,
    pub globals: FxHashMap<String, Global>,
    /// Numbers of the program's data types, by folded name.
    pub type_names: FxHashMap<String, u16>,
    /// User constants of tag tables, by folded name.
    pub global_constants: Constants,
    pub block_names: FxHashMap<(BlockPrefix, u16), String>,
    /// Where each block of the sources is defined.
    pub defined: FxHashMap<(BlockPrefix, u16), Span>,
    pub code: FxHashMap<BlockKey, CodeSource<'a>>,
    pub data: FxHashMap<u16, &'a ast::DataBlock>,
    pub type_blocks: FxHashMap<u16, &'a ast::TypeBlock>,
    pub udts: FxHashMap<u16, State<Option<Typed>>>,
    /// DTL and other predefined structures.
    pub predefined: FxHashMap<&'static str, TypedStruct>,
    /// Where the declarations are that are currently bound.
    pub scope: Scope,
    /// A block of the TIA Portal is among the sources, or the CPU only exists there.
    pub tia_sources: bool,
    pub interfaces: FxHashMap<BlockKey, State<Option<Rc<BoundInterface>>>>,
    pub dbs: FxHashMap<u16, data::BoundDb>,
    /// Size of all data blocks so far, in bytes.
    pub db_bytes: u64,
    /// Current depth of nested types.
    pub depth: u32,
    /// Components by folded name; the structure is kept so that no other gets its address.
    pub member_index: FxHashMap<*const StructType, (Rc<StructType>, FxHashMap<String, usize>)>,
    pub system: Vec<SystemUse>,
    /// Library blocks whose numbers the program uses for its own, by their new numbers.
    pub moved: FxHashMap<BlockKey, &'static plcc_stdlib::SystemBlock>,
    pub system_used: FxHashSet<BlockKey>,
    /// Library blocks whose numbers or names mean missing blocks of the program: their calls have other parameters.
    pub foreign: FxHashSet<(plcc_stdlib::BlockClass, u16)>,
    /// Addresses beyond the CPU's limits that have been reported.
    pub limits_told: FxHashSet<(Area, u32)>,
    pub cells_told: FxHashSet<(CellKind, u32)>,
    /// Pointer parameters of instances: whether some call supplies them, and a call that does not.
    pub pointers: FxHashMap<(calls::InstanceId, usize), calls::PointerUse>,
    /// Data blocks that calls name as instances of undefined blocks: nothing is known of them.
    pub unknown_instances: FxHashSet<u16>,
    /// Lines that every run of the program prints at its start.
    pub notices: Vec<String>,
    /// It has been reported that REF_TO is not supported.
    pub references_refused: bool,
    /// Tags of the system memory that nothing sets, as reported; folded.
    pub system_tags_told: FxHashSet<String>,
}

impl<'a> Declarations<'a> {
    pub fn new(input: &'a BindInput<'a>) -> Declarations<'a> {
        Declarations {
            input,
            config: input.config.clone(),
            report: Report::new(input.partial),
            globals: FxHashMap::default(),
            type_names: FxHashMap::default(),
            global_constants: Constants::default(),
            block_names: FxHashMap::default(),
            defined: FxHashMap::default(),
            code: FxHashMap::default(),
            data: FxHashMap::default(),
            type_blocks: FxHashMap::default(),
            udts: FxHashMap::default(),
            predefined: FxHashMap::default(),
            scope: Scope::default(),
            tia_sources: types::is_tia(input),
            interfaces: FxHashMap::default(),
            dbs: FxHashMap::default(),
            db_bytes: 0,
            depth: 0,
            member_index: FxHashMap::default(),
            system: Vec::new(),
            moved: FxHashMap::default(),
            system_used: FxHashSet::default(),
            foreign: FxHashSet::default(),
            limits_told: FxHashSet::default(),
            cells_told: FxHashSet::default(),
            pointers: FxHashMap::default(),
            unknown_instances: FxHashSet::default(),
            notices: Vec::new(),
            references_refused: false,
            system_tags_told: FxHashSet::default(),
        }
    }
}
