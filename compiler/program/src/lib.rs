//! Symbols, data types, block interfaces and checks; gives the bound program.
//!
//! - [`symbols`]: symbol tables; [`profile`]: the CPUs and their limits.
//! - [`types`], [`layout`]: data types and where their components lie.
//! - [`bind()`] settles every name, type and address; [`model`] is what it gives.
//!
//! **Invariant**: what binds without errors lowers without errors.

mod bind;
pub mod layout;
pub mod model;
pub mod profile;
pub mod symbols;
pub mod types;

pub use bind::{
    BindInput, bind, graph_reference, has_free_obs, is_about_drafts, lad_fbd_reference, scl_reference, standard_library,
};
pub use model::Program;
pub use profile::s7200::reference as s7200_reference;
