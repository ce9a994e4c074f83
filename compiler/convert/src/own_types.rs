//! Types that a program declares itself. In SIMATIC SD and SCL they may be words without quotes, `d : Door`, as types of the system are;
//! other notations have them in quotes only.

use std::collections::HashMap;

use plcc_syntax::Elementary;
use plcc_syntax::ast::{Block, BlockName, CodeKind, DataContent, SourceUnit, TypeKind, TypeRef, Variable};

/// Words that are types of the system, whatever a program declares.
const SYSTEM: [&str; 13] = [
    "DATE_AND_TIME",
    "DT",
    "STRING",
    "WSTRING",
    "TIMER",
    "COUNTER",
    "BLOCK_FB",
    "BLOCK_FC",
    "BLOCK_DB",
    "BLOCK_SDB",
    "POINTER",
    "ANY",
    "VARIANT",
];

/// The data types and function blocks of a program.
pub struct OwnTypes {
    /// Their names as they are declared, by upper-case names.
    names: HashMap<String, String>,
}

impl OwnTypes {
    pub fn new<'a>(units: impl Iterator<Item = &'a SourceUnit>) -> OwnTypes {
        let declared = units.flat_map(|unit| &unit.blocks).filter_map(|block| match block {
            Block::Type(block) => Some(&block.name),
            Block::Code(block) if block.kind == CodeKind::Fb => Some(&block.name),
            Block::Code(_) | Block::Data(_) => None,
        });
        let names = declared.filter_map(|name| match name {
            BlockName::Symbol { name, .. } => Some((name.to_uppercase(), name.clone())),
            BlockName::Numbered { .. } => None,
        });
        OwnTypes { names: names.collect() }
    }

    /// Makes the words that name such a type names of blocks.
    pub fn settle(&self, unit: &mut SourceUnit) {
        for block in &mut unit.blocks {
            match block {
                Block::Code(block) => {
                    block.sections.iter_mut().for_each(|section| self.variables(&mut section.variables));
                    block.constants.iter_mut().filter_map(|constant| constant.ty.as_mut()).for_each(|ty| self.ty(ty));
                    block.return_type.iter_mut().for_each(|ty| self.ty(ty));
                }
                Block::Data(block) => match &mut block.content {
                    DataContent::Struct(members) => self.variables(members),
                    DataContent::OfType(ty) | DataContent::Array(ty, _) => self.ty(ty),
                    DataContent::Empty => {}
                },
                Block::Type(block) => {
                    self.variables(&mut block.members);
                    block.alias.iter_mut().for_each(|ty| self.ty(ty));
                }
            }
        }
    }

    fn variables(&self, variables: &mut [Variable]) {
        variables.iter_mut().for_each(|variable| self.ty(&mut variable.ty));
    }

    fn ty(&self, ty: &mut TypeRef) {
        match &mut ty.kind {
            TypeKind::Named(word) => {
                let is_of_system = Elementary::from_word(word).is_some() || SYSTEM.contains(&word.as_str());
                if let Some(name) = self.names.get(word.as_str()).filter(|_| !is_of_system) {
                    ty.kind = TypeKind::Block(BlockName::Symbol { name: name.clone(), span: ty.span });
                }
            }
            TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } => self.ty(element),
            TypeKind::Reference(target) => self.ty(target),
            TypeKind::Struct(members) => self.variables(members),
            TypeKind::String(_) | TypeKind::WideString(_) | TypeKind::Block(_) | TypeKind::Error => {}
        }
    }
}
