//! Binding: syntax trees and symbol tables in, the bound program out.
//!
//! Each of these names only those before it, as a test checks:
//!
//! 1. [`trees`]: what the syntax trees show without names and types.
//! 2. [`globals`]: names and numbers of the whole program, constants, the library; the report.
//! 3. [`declarations`]: types, interfaces and data blocks.
//! 4. [`stl`], [`scl`], [`network`] (LAD and FBD) and [`chart`] (GRAPH) bind statements over them, each by a type of its own. Networks
//!    become the typed tree of SCL, and charts use SCL and networks.
//! 5. [`review`] looks in bound blocks for statements without effect, and for values that are never set.
//! 6. [`program`](mod@program) binds a whole program, each block in its language.
//! 7. [`partial`] binds a program in which parts may be missing, by binding it several times.
//!
//! With errors the program is incomplete and must not be lowered; the same applies to `partial` runs with warnings about
//! undefined names.

mod chart;
mod declarations;
mod globals;
mod network;
mod partial;
mod program;
mod review;
mod scl;
mod stl;
mod trees;

#[cfg(test)]
#[path = "../../../readers/tests/files/notation/mod.rs"]
mod notation;
#[cfg(test)]
mod tests;

pub use declarations::predefined::system_members;
pub use declarations::shipped::{library_code, library_interface};
pub use globals::pins::instruction_pins;
pub use network::{NOT_CONNECTED, is_about_drafts};
pub use partial::complete;
pub use program::bind;
pub use trees::chart_data::expanded as with_chart_data;
pub use trees::cpu::{implied_profile, is_s7200, language_beyond_s7_1200, runs};
pub use trees::numbering::{block_of_file, told_ob};

/// Tables of the languages, for reference pages and editors.
pub mod tables {
    /// Functions and conversions of SCL.
    pub mod scl {
        pub use crate::bind::globals::rules::Rules;
        pub use crate::bind::scl::convert::{Implicit, implicit, on_300};
        pub use crate::bind::scl::function::{FUNCTIONS, Kind, NAMING, Row, TextNumber};
        pub use crate::bind::scl::naming::Naming;
        pub use crate::bind::scl::signature::{Parameter, Signature, signatures};
        pub use crate::bind::scl::variant::Question;
    }

    /// Operating parameters of charts, and their bits.
    pub mod chart {
        pub use plcc_syntax::chart::parameters::{Effect, OPERATING_BITS, PARAMETERS, Parameter, Set};
    }
}
