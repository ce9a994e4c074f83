//! What the sources, the tables and the library declare. Statements of all languages are bound over it.
//!
//! Values: [`names`], [`sources`] (the syntax trees), [`library`], [`types`], interfaces, [`data`] blocks, pointers of instances ([`calls`]),
//! and the report. Names, types and interfaces are made when first needed, since declarations may be in any order:
//!
//! - [`collect`] reads the tables and numbers the blocks; [`ob`] finds out what starts organization blocks.
//! - [`types`] resolves data types, [`predefined`] those of the language and the CPU; [`constant`] computes constants of all languages,
//!   [`initial`] encodes start values. [`interface`] lays out the interface of a block, [`data`] makes the data blocks.
//! - [`path`] turns names into places; [`addresses`] checks addresses against the CPU, [`hardware`] and [`system_memory`] its constants and
//!   its tags; [`pointer`] has the bytes of pointers.
//! - [`block`] is the block whose statements are bound, [`rules`] the rules of its source and CPU.

pub mod addresses;
pub mod block;
pub mod calls;
pub mod collect;
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
use rustc_hash::FxHashMap;

use addresses::Told;
use calls::InstancePointers;
use data::DataBlocks;
use library::Library;
use names::Names;
use plcc_binding::BindInput;
use plcc_binding::report::Report;
use plcc_model::BlockKey;
use sources::{Sources, State};
use types::{BoundInterface, Types};

/// What the program declares, and what has been reported about it.
pub struct Declarations<'a> {
    pub input: &'a BindInput<'a>,
    /// As in the input, with the information from the blocks.
    pub config: Config,
    pub report: Report,
    pub told: Told,
    /// Lines that every run of the program prints at its start.
    pub notices: Vec<String>,
    pub names: Names,
    pub sources: Sources<'a>,
    pub library: Library,
    pub types: Types,
    pub interfaces: FxHashMap<BlockKey, State<Option<Rc<BoundInterface>>>>,
    pub data: DataBlocks,
    pub pointers: InstancePointers,
}

impl<'a> Declarations<'a> {
    pub fn new(input: &'a BindInput<'a>) -> Declarations<'a> {
        Declarations {
            input,
            config: input.config.clone(),
            report: Report::new(input.partial),
            told: Told::default(),
            notices: Vec::new(),
            names: Names::default(),
            sources: Sources {
                code: FxHashMap::default(),
                data: FxHashMap::default(),
                types: FxHashMap::default(),
                tia: types::is_tia(input),
            },
            library: Library::default(),
            types: Types::default(),
            interfaces: FxHashMap::default(),
            data: DataBlocks::default(),
            pointers: InstancePointers::default(),
        }
    }
}
