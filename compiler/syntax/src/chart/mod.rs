//! Charts of GRAPH: sequencers of steps and transitions, whatever file they come in.
//!
//! - [`ast`]: the tree.
//! - [`action_text`]: rows of actions, of files that hold them as text.
//! - [`fold`](mod@fold): drawn branches become the FROM and TO of transitions, of files that hold drawings.
//! - [`text`]: the tree as text.

pub mod action_text;
pub mod ast;
pub mod fold;
pub mod text;
