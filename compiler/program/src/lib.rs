//! Symbols, names, types and checks: syntax trees in, the bound program out.
//!
//! - [`symbols`]: symbol tables.
//! - [`bind()`] settles every name, type and address; its result is [`plcc_model`].
//!
//! **Invariant**: a program that binds without errors lowers without errors.

mod bind;

pub use bind::{
    bind, complete, graph_reference, has_free_obs, implied_family, is_about_drafts, lad_fbd_reference,
    library_interface, scl_functions, scl_reference,
};
