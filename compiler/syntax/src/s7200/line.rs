//! Lines of a source, as the grammar returns them.

use plcc_diag::Span;

use super::Insn;
use super::ast::{Assert, BlockKind, Declaration, Operand, Section};
use crate::ast::Pragma;

/// A line.
pub struct Line {
    pub kind: LineKind,
    /// After `//`.
    pub comment: Option<String>,
    /// Without its comment.
    pub span: Span,
}

/// `name:SBR3` after the keyword of a block.
#[derive(Default)]
pub struct BlockLabel {
    pub name: Option<(String, Span)>,
    pub number: Option<(BlockKind, u32, Span)>,
}

/// What a line is.
pub enum LineKind {
    Header(BlockKind, BlockLabel),
    EndBlock(BlockKind),
    DataHeader,
    EndData,
    Title(String),
    Section(Section),
    EndVar,
    Begin,
    Network {
        number: Option<i64>,
        title: String,
    },
    /// `SBR 3`, `INT 0`; none: a number that is too large, reported.
    Marker(BlockKind, Option<(u32, Span)>),
    Declarations(Vec<Declaration>),
    /// True: the first operand is the address.
    Data(bool, Vec<Operand>),
    Instruction {
        insn: Insn,
        mnemonic: Span,
        operands: Vec<Operand>,
    },
    Pragma(Box<Pragma>, Option<Box<Assert>>),
    /// Nothing but a comment.
    Comment,
    /// Reported.
    Bad,
}
