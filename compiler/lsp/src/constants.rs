//! Constants with names: those of a block, and those of tag tables.

use plcc_diag::Span;
use plcc_syntax::ast::{self, Block};
use plcc_syntax::symbols::GlobalConstant;

use crate::facts::same;
use crate::index::{Entry, Index};

/// A constant.
#[derive(Clone, Copy)]
pub enum Constant<'c> {
    /// Of VAR CONSTANT or CONST.
    Local(Entry<'c>, &'c ast::Constant),
    Global(&'c GlobalConstant),
}

/// The constants of a block.
pub fn of(entry: Entry<'_>) -> &[ast::Constant] {
    match entry.block {
        Block::Code(block) => &block.constants,
        Block::Data(_) | Block::Type(_) => &[],
    }
}

/// The constant of a block with a name.
pub fn named<'c>(entry: Entry<'c>, name: &str) -> Option<Constant<'c>> {
    of(entry).iter().find(|constant| same(&constant.name, name)).map(|constant| Constant::Local(entry, constant))
}

impl<'c> Constant<'c> {
    pub fn name(&self) -> &'c str {
        match self {
            Constant::Local(_, constant) => &constant.name,
            Constant::Global(constant) => &constant.name,
        }
    }

    /// Where it is declared.
    pub fn span(&self) -> Span {
        match self {
            Constant::Local(_, constant) => constant.name_span,
            Constant::Global(constant) => constant.span,
        }
    }

    /// `INT := 10`, as written.
    pub fn value(&self, index: &Index) -> String {
        let written = |span: Span| index.checked.sources.file(span.file).text.get(span.range()).unwrap_or_default();
        let (ty, value) = match self {
            Constant::Local(_, constant) => {
                let value = constant.value.as_ref().map(|value| value.span);
                let value = value.or(constant.initial.as_ref().map(|value| value.span));
                (constant.ty.as_ref().map_or(String::new(), |ty| index.type_text(ty)), value)
            }
            Constant::Global(constant) => (constant.ty.clone(), Some(constant.value.span)),
        };
        let value = value.map_or(String::new(), |span| format!(" := {}", written(span)));
        format!("{ty}{value}").trim().to_owned()
    }

    /// What has it.
    pub fn owner(&self) -> String {
        match self {
            Constant::Local(entry, _) => format!("{} {}", entry.keyword(), entry.text()),
            Constant::Global(_) => "the tag tables".to_owned(),
        }
    }
}
