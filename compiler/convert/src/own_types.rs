//! Types that a program declares itself. In SIMATIC SD and SCL they may be words without quotes, `d : Door`, as types of the system are;
//! other notations have them in quotes only. SimaticML has no types that are other names of types: these are written out.

use std::collections::HashMap;

use plcc_syntax::Elementary;
use plcc_syntax::ast::{Block, BlockName, CodeKind, DataContent, SourceUnit, TypeKind, TypeRef};

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

/// Types that are other names of types are written out up to this depth; those that name each other have no end.
const DEPTH_MAX: u32 = 16;

/// The data types and function blocks of a program.
pub struct OwnTypes {
    /// Their names as they are declared, by upper-case names.
    names: HashMap<String, String>,
    /// What is written out in their place, likewise.
    aliases: HashMap<String, TypeKind>,
}

impl OwnTypes {
    pub fn new<'a>(units: impl Iterator<Item = &'a SourceUnit>) -> OwnTypes {
        let declared = units.flat_map(|unit| &unit.blocks).filter_map(|block| match block {
            Block::Type(block) => Some(&block.name),
            Block::Code(block) if block.kind == CodeKind::Fb => Some(&block.name),
            Block::Code(_) | Block::Data(_) => None,
        });
        let names = declared.filter_map(name_of).map(|name| (name.to_uppercase(), name.to_string()));
        OwnTypes { names: names.collect(), aliases: HashMap::new() }
    }

    /// The same types, of which those that are only names of others are written out.
    pub fn with_aliases<'a>(mut self, units: impl Iterator<Item = &'a SourceUnit>) -> OwnTypes {
        let types = units.flat_map(|unit| &unit.blocks).filter_map(|block| match block {
            Block::Type(block) => Some((name_of(&block.name)?, block.alias.as_ref()?)),
            Block::Code(_) | Block::Data(_) => None,
        });
        let types = types.filter(|(_, alias)| is_written_out(alias));
        self.aliases.extend(types.map(|(name, alias)| (name.to_uppercase(), alias.kind.clone())));
        self
    }

    /// Makes the words that name such a type names of blocks.
    pub fn settle(&self, unit: &mut SourceUnit) {
        each_type(unit, &mut |ty| self.ty(ty, 0));
        for block in &mut unit.blocks {
            if let Block::Data(block) = block
                && let DataContent::OfType(ty) = &block.content
                && matches!(ty.kind, TypeKind::Array { .. })
            {
                block.content = DataContent::Array(ty.clone(), None);
            }
        }
    }

    /// Makes names in quotes that are those of the system words, `DATA_BLOCK "T" "TON_TIME"`, unless the program declares such a type.
    pub fn unquote(&self, unit: &mut SourceUnit, is_of_system: &dyn Fn(&str) -> bool) {
        each_type(unit, &mut |ty| self.word(ty, is_of_system));
    }

    fn word(&self, ty: &mut TypeRef, is_of_system: &dyn Fn(&str) -> bool) {
        match &mut ty.kind {
            TypeKind::Block(BlockName::Symbol { name, .. }) => {
                let word = name.to_uppercase();
                if !self.names.contains_key(&word) && is_of_system(&word) {
                    ty.kind = TypeKind::Named(word);
                }
            }
            TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } => self.word(element, is_of_system),
            TypeKind::Struct(members) => members.iter_mut().for_each(|member| self.word(&mut member.ty, is_of_system)),
            TypeKind::Block(BlockName::Numbered { .. })
            | TypeKind::Named(_)
            | TypeKind::Reference(_)
            | TypeKind::String(_)
            | TypeKind::WideString(_)
            | TypeKind::Error => {}
        }
    }

    /// `depth`: how often it was another name of a type.
    fn ty(&self, ty: &mut TypeRef, depth: u32) {
        match &mut ty.kind {
            TypeKind::Named(word) => {
                let is_of_system = Elementary::from_word(word).is_some() || SYSTEM.contains(&word.as_str());
                if let Some(name) = self.names.get(word.as_str()).filter(|_| !is_of_system) {
                    ty.kind = TypeKind::Block(BlockName::Symbol { name: name.clone(), span: ty.span });
                }
            }
            TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } => self.ty(element, depth),
            TypeKind::Reference(target) => self.ty(target, depth),
            TypeKind::Struct(members) => members.iter_mut().for_each(|member| self.ty(&mut member.ty, 0)),
            TypeKind::String(_) | TypeKind::WideString(_) | TypeKind::Block(_) | TypeKind::Error => {}
        }
        if depth < DEPTH_MAX
            && let TypeKind::Block(name) = &ty.kind
            && let Some(kind) = name_of(name).and_then(|name| self.aliases.get(&name.to_uppercase()))
        {
            ty.kind = kind.clone();
            self.ty(ty, depth + 1);
        }
    }
}

/// All types in the declarations of a source.
fn each_type(unit: &mut SourceUnit, visit: &mut dyn FnMut(&mut TypeRef)) {
    for block in &mut unit.blocks {
        match block {
            Block::Code(block) => {
                let variables = block.sections.iter_mut().flat_map(|section| &mut section.variables);
                variables.for_each(|variable| visit(&mut variable.ty));
                block.constants.iter_mut().filter_map(|constant| constant.ty.as_mut()).for_each(&mut *visit);
                block.return_type.iter_mut().for_each(&mut *visit);
            }
            Block::Data(block) => match &mut block.content {
                DataContent::Struct(members) => members.iter_mut().for_each(|member| visit(&mut member.ty)),
                DataContent::OfType(ty) | DataContent::Array(ty, _) => visit(ty),
                DataContent::Empty => {}
            },
            Block::Type(block) => {
                block.members.iter_mut().for_each(|member| visit(&mut member.ty));
                block.alias.iter_mut().for_each(&mut *visit);
            }
        }
    }
}

/// Whether a type can stand in the place of its name, in whatever source that is. Structures have comments, which are in their own.
pub fn is_written_out(alias: &TypeRef) -> bool {
    match &alias.kind {
        TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } => is_written_out(element),
        TypeKind::Reference(target) => is_written_out(target),
        TypeKind::Named(_) | TypeKind::String(_) | TypeKind::WideString(_) | TypeKind::Block(_) => true,
        TypeKind::Struct(_) | TypeKind::Error => false,
    }
}

fn name_of(name: &BlockName) -> Option<&str> {
    match name {
        BlockName::Symbol { name, .. } => Some(name),
        BlockName::Numbered { .. } => None,
    }
}
