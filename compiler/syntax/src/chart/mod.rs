//! Charts of GRAPH: sequencers of steps and transitions, from any kind of file.
//!
//! - [`ast`]: the tree.
//! - [`action_text`]: rows of actions, for files that hold them as text.
//! - [`parameters`]: the operating parameters of a block.
//! - [`connect`](mod@connect): turns drawn branches into the FROM and TO of transitions, for files that hold drawings.
//! - [`text`]: the tree as text.

pub mod action_text;
pub mod ast;
pub mod connect;
pub mod parameters;
pub mod text;
