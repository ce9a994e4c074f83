//! Symbols, names, types and checks: syntax trees in, the bound program out.
//!
//! - [`bind()`] settles every name, type and address; its result is [`plcc_model`]. [`complete`] does so for a program in which parts
//!   are missing.
//! - [`implied_profile`]: the CPU of sources that name none.
//! - [`instruction_pins`]: what STL passes to an instruction of the TIA Portal that it calls by its name.
//! - [`library_code`]: what a block of the CPU or of a library declares.
//! - [`with_chart_data`]: what the block of a chart declares without saying so.
//! - [`check_modules`] compares a bound program with the modules of its station.
//!
//! **Invariant**: a program that binds without errors lowers without errors.

mod bind;
mod modules;

pub use bind::{
    NOT_CONNECTED, bind, block_of_file, complete, implied_profile, instruction_pins, is_about_drafts, is_s7200,
    language_beyond_s7_1200, library_code, library_interface, runs, system_members, tables, told_ob, with_chart_data,
};
pub use modules::check_modules;
