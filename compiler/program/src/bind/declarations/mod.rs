//! What the sources, the tables and the library declare.

pub mod addresses;
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
pub mod system_memory;
pub mod types;
