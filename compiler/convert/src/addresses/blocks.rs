//! Names and numbers of blocks, and types that are blocks.

use plcc_syntax::ast::{Block, BlockName, BlockPrefix, CodeBlock, DataContent, PathRoot, TypeKind, TypeRef, Variable};
use plcc_syntax::symbols::SymbolTarget;

use super::names::Found;
use super::{Editor, To};
use crate::names;

impl Editor<'_> {
    /// The name of a block, and those in its declarations.
    pub(super) fn frame(&mut self, block: &Block) {
        match block {
            Block::Code(CodeBlock { name, return_type, sections, .. }) => {
                self.block_name(name);
                return_type.iter().for_each(|ty| self.type_name(ty));
                sections.iter().for_each(|section| self.variables(&section.variables));
            }
            Block::Data(block) => {
                self.block_name(&block.name);
                match &block.content {
                    DataContent::Struct(variables) => self.variables(variables),
                    DataContent::OfType(ty) | DataContent::Array(ty, _) => self.type_name(ty),
                    DataContent::Empty => {}
                }
            }
            Block::Type(block) => {
                self.block_name(&block.name);
                self.variables(&block.members);
                block.alias.iter().for_each(|ty| self.type_name(ty));
            }
        }
    }

    fn variables(&mut self, variables: &[Variable]) {
        variables.iter().for_each(|variable| self.type_name(&variable.ty));
    }

    fn type_name(&mut self, ty: &TypeRef) {
        match &ty.kind {
            TypeKind::Block(name) => self.block_name(name),
            TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } | TypeKind::Reference(element) => {
                self.type_name(element);
            }
            TypeKind::Struct(members) => self.variables(members),
            TypeKind::Named(_) | TypeKind::String(_) | TypeKind::WideString(_) | TypeKind::Error => {}
        }
    }

    /// `"Motor"` as `FB 10`, or the other way round.
    pub(super) fn block_name(&mut self, name: &BlockName) {
        if let Some(text) = self.block_text(name) {
            self.edit(name.span(), text);
        }
    }

    /// The other form of the name of a block; `None`: it stays.
    pub(super) fn block_text(&mut self, name: &BlockName) -> Option<String> {
        match (self.to, name) {
            (To::Absolute, BlockName::Symbol { name, span }) => match self.symbol(name, *span)?.target {
                SymbolTarget::Block { prefix, number } => Some(self.numbered(prefix, number)),
                SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => None,
            },
            // `OPN DI 5` says which register by its letters.
            (To::Symbolic, BlockName::Numbered { prefix: BlockPrefix::Di, .. }) => None,
            (To::Symbolic, BlockName::Numbered { prefix, number, span }) => {
                let found = self.the_symbol(SymbolTarget::Block { prefix: *prefix, number: *number }, *span)?;
                Some(names::symbol(&found.name))
            }
            (To::Absolute, BlockName::Numbered { .. }) | (To::Symbolic, BlockName::Symbol { .. }) => None,
        }
    }

    /// `FC 7` in STL and declarations.
    pub(super) fn numbered(&self, prefix: BlockPrefix, number: u32) -> String {
        format!("{} {number}", prefix.letters())
    }

    /// The symbol of an address, if it has exactly one.
    pub(super) fn the_symbol(&mut self, target: SymbolTarget, span: plcc_diag::Span) -> Option<Found> {
        let mut found = self.names.symbols_of(target);
        if found.len() > 1 {
            let list: Vec<&str> = found.iter().map(|one| one.name.as_str()).collect();
            let why = format!("the address has {} symbols", list.len());
            self.stays(span, &list.join(", "), &why, "leave one of them in the symbol tables");
            return None;
        }
        found.pop()
    }

    /// Whether the root of a path is a variable of the block.
    pub(super) fn is_local(&self, root: &PathRoot) -> bool {
        match root {
            PathRoot::Local { .. } => true,
            PathRoot::Bare { name, .. } => self.locals.contains(&name.to_lowercase()),
            PathRoot::Quoted { .. } | PathRoot::Block(_) => false,
        }
    }
}
