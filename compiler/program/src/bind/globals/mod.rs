//! What has a name or a number in the whole program: sources, symbols, constants, blocks, the library; and the report.
//!
//! - [`collect`] reads the tables and numbers the blocks of the [`sources`], so that their order does not matter; [`ob`] finds out what
//!   starts organization blocks.
//! - [`names`] finds names and numbers, also those of the [`library`]; [`constant`] computes constants of all languages,
//!   `user_constants` reads those of tag tables; [`instruction`] and [`form`] have functions for instructions that STL calls,
//!   [`pins`] says with what.
//! - [`addresses`] checks addresses against the CPU; [`hardware`] has its constants, [`system_memory`] its tags, [`rules`] its dialect.

pub mod addresses;
pub mod collect;
pub mod constant;
pub mod form;
pub mod hardware;
pub mod instruction;
pub mod library;
pub mod names;
pub mod ob;
mod overlaps;
pub mod pins;
pub mod rules;
pub mod sources;
pub mod system_memory;
mod user_constants;

use plcc_abi::image::Config;
use rustc_hash::FxHashMap;

use addresses::Told;
use library::Library;
use names::Names;
use plcc_binding::BindInput;
use plcc_binding::report::Report;
use sources::Sources;

/// The names and numbers of the program, and what has been reported.
pub struct Globals<'a> {
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
}

impl<'a> Globals<'a> {
    pub fn new(input: &'a BindInput<'a>) -> Globals<'a> {
        let config = input.config.clone();
        let mut report = Report::new(input.partial);
        report.memory_bytes = [config.clock_memory_byte, config.system_memory_byte];
        Globals {
            input,
            config,
            report,
            told: Told::default(),
            notices: Vec::new(),
            names: Names::default(),
            sources: Sources {
                code: FxHashMap::default(),
                data: FxHashMap::default(),
                types: FxHashMap::default(),
                tia: sources::is_tia(input),
            },
            library: Library::default(),
        }
    }
}
