//! The pages in `docs/reference/`, printed from the tables of the compiler.

mod diagnostics;
mod graph;
mod lad_fbd;
mod s7200;
mod s7200_instructions;
mod scl;
mod stdlib;
mod stl;

pub use diagnostics::diagnostics;
pub use graph::reference as graph;
pub use lad_fbd::reference as lad_fbd;
pub use s7200::reference as s7200;
pub use scl::reference as scl;
pub use stdlib::standard_library;
pub use stl::reference as stl;
