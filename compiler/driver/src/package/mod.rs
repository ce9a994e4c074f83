//! What a program is packed into for other tools: `fmu` a unit of a co-simulation, `oci` a container image.
//!
//! The same program gives the same bytes: nothing depends on the time, the folder or the user.

mod description;
pub mod fmu;
pub mod oci;
