//! What the front ends of all notations share, from characters to the tree.
//!
//! ```text
//! text ──► raw tokens, comments ──► tokens with a meaning ──► grammar ──► tree
//!        scan.rs   extent.rs       cursor.rs   recover.rs    state.rs
//!                  pointer.rs      pragma.rs                      expression.rs, frame.rs
//! ```
//!
//! A front end consists of
//!
//! 1. `raw`: an enum of raw tokens for `logos`, which implements [`Kind`]. [`scan()`] runs the lexer and keeps comments apart.
//!    Where a regular expression cannot find the end of a token, [`extent`] and [`pointer`] do.
//! 2. `classify`: decides what each word is by where it appears. It moves a [`Cursor`] over the raw tokens, which also
//!    gives messages their spans, reads assertions, and closes brackets that the source left open.
//! 3. a grammar for `lalrpop`, whose actions work with a [`ParseState`]. It takes the tokens of [`Classified`], and reports
//!    what does not parse once, in the words of the front end's [`Place`]. [`Sub`] keeps expressions from being too deep.

pub mod comment;
mod cursor;
mod expression;
pub mod extent;
pub mod foreign_address;
pub(crate) mod frame;
pub mod frame_words;
pub mod pointer;
pub mod pragma;
mod recover;
mod scan;
mod state;

pub use comment::{Comment, CommentForm};
pub use cursor::{Classified, Cursor, Spanned, tokens_text};
pub use expression::Sub;
pub use recover::{
    Brackets, NESTING_MAX, drop_followers_of_comment, in_curved_quotes, stray_characters, stray_help, too_deep,
    unclosed_comment, unterminated_name, unterminated_text,
};
pub use scan::{Bracket, Kind, RawText, RawToken, Role, after_point, scan, shift, skip_text, skip_through};
pub use state::{ParseState, Place, error_range};
