//! Values that are known when a program is compiled: constants of blocks, array bounds, CASE labels, initial values.

use plcc_syntax::Elementary;
use plcc_syntax::scl::ast::Expr;
use rustc_hash::FxHashMap;

use super::Binder;

/// A constant value.
#[derive(Clone, Debug, PartialEq)]
pub enum Constant {
    /// An integer without a type; `based` if it was written as bits (`16#FF`).
    Integer {
        value: i128,
        based: bool,
    },
    /// A floating-point number without a type.
    Real(f64),
    /// The bits, zero-extended from the width of the type.
    Typed {
        ty: Elementary,
        bits: u64,
    },
    /// In Windows-1252; not `typed` and one character long it may be a CHAR.
    Text {
        bytes: Vec<u8>,
        typed: bool,
    },
    WideText(Vec<u16>),
    DateAndTime([u8; 8]),
    Dtl([u8; 12]),
}

/// Constants of a block by folded name, for [`Binder::constant`].
pub type Constants = FxHashMap<String, Constant>;

impl Binder<'_> {
    /// The value of a constant expression; what is no constant is reported.
    pub fn constant(&mut self, _constants: &Constants, _value: &Expr) -> Option<Constant> {
        None
    }
}
