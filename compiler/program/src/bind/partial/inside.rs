//! From a place to the missing name that it is inside: through blocks, types and components that are declared.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{self, BlockName, BlockPrefix, TypeKind, TypeRef};

use super::evidence::{Hint, Shape};
use super::look::{Look, Start, Step};
use crate::bind::scl::SclBlock;
use plcc_abi::image::BlockKind;
use plcc_binding::fold;
use plcc_binding::stand_ins::Missing;
use plcc_model::BlockKey;
use plcc_stdlib::{Form, SystemBlock};
use plcc_syntax::symbols::SymbolTarget;

impl Look<'_, '_> {
    /// Shows `teach` the missing name that a place is, or is part of.
    pub fn with_shape(
        &mut self,
        ctx: &SclBlock,
        start: &Start,
        steps: &[Step],
        span: Span,
        teach: &mut dyn FnMut(&mut Shape),
    ) {
        match start {
            Start::Local(name) => {
                let Some(ty) = self.declared_type(ctx.block.key, name) else { return };
                self.inside_type(&ty, steps, span, teach, 0);
            }
            Start::Global(name) => {
                let missing = Missing::name(name);
                match self.program.globals.global(name) {
                    _ if self.found.things.contains_key(&missing) => {
                        descend(self.found.of(missing, name, span), steps, teach)
                    }
                    None if self.program.globals.names.constants.contains_key(&fold(name)) => {}
                    None => descend(self.found.of(missing, name, span), steps, teach),
                    Some(SymbolTarget::Block { prefix: BlockPrefix::Db, number }) => {
                        self.inside_db(number, name, steps, span, teach);
                    }
                    Some(SymbolTarget::Block { prefix, number }) => {
                        self.numbered(prefix, number, name, steps, span, teach)
                    }
                    Some(SymbolTarget::Memory { .. }) => {
                        let structure = self
                            .program
                            .globals
                            .names
                            .symbols
                            .get(&fold(name))
                            .and_then(|global| global.structure.clone());
                        if let Some(name) = structure {
                            let name = BlockName::Symbol { name, span };
                            self.inside_type(&TypeRef { kind: TypeKind::Block(name), span }, steps, span, teach, 0);
                        }
                    }
                    Some(SymbolTarget::Cell { .. }) => {}
                }
            }
            Start::Block(BlockPrefix::Db | BlockPrefix::Di, number) => {
                self.inside_db(*number, &format!("DB {number}"), steps, span, teach);
            }
            Start::Block(prefix, number) => {
                self.numbered(*prefix, *number, &format!("{} {number}", prefix.letters()), steps, span, teach);
            }
        }
    }

    /// The missing name or block at the start of a place, if nothing defines it. A symbol table may give the number of a block.
    pub fn meant(&self, start: &Start) -> Option<Missing> {
        match start {
            Start::Local(_) => None,
            Start::Global(name) => match self.program.globals.global(name) {
                Some(SymbolTarget::Block { prefix, number }) if !self.is_missing(name) => {
                    Missing::block(prefix, number)
                }
                _ => Some(Missing::name(name)),
            },
            Start::Block(prefix, number) => Missing::block(*prefix, *number),
        }
    }

    fn numbered(
        &mut self,
        prefix: BlockPrefix,
        number: u32,
        name: &str,
        steps: &[Step],
        span: Span,
        teach: &mut dyn FnMut(&mut Shape),
    ) {
        let Some(missing) = Missing::block(prefix, number) else { return };
        if self.found.things.contains_key(&missing) || !self.is_block(prefix, number) {
            descend(self.found.of(missing, name, span), steps, teach);
        }
    }

    /// True if a source or the library defines the block.
    pub fn is_block(&mut self, prefix: BlockPrefix, number: u32) -> bool {
        let Ok(number) = u16::try_from(number) else { return true };
        if self.program.globals.names.defined.contains_key(&(prefix, number)) {
            return true;
        }
        match crate::bind::globals::names::code_kind(prefix) {
            Some(kind) => {
                let key = BlockKey { kind, number };
                let globals = &self.program.globals;
                let library = globals.library_block(key);
                // A stub stands in for a block that plcc does not have, but not for an instruction.
                let is_there = |block: &SystemBlock| block.is_tia() || block.form != Form::NotShipped;
                globals.sources.code.contains_key(&key) || library.is_some_and(is_there)
            }
            None => false,
        }
    }

    fn inside_db(&mut self, number: u32, name: &str, steps: &[Step], span: Span, teach: &mut dyn FnMut(&mut Shape)) {
        let Ok(narrow) = u16::try_from(number) else { return };
        let Some(missing) = Missing::block(BlockPrefix::Db, number) else { return };
        let source = self.program.globals.sources.data.get(&narrow).copied();
        match source {
            _ if self.found.things.contains_key(&missing) => {
                descend(self.found.of(missing, name, span), steps, teach);
            }
            // A symbol table names it, but no source defines it.
            None if !self.program.data.blocks.contains_key(&narrow) && number != 0 => {
                descend(self.found.of(missing, name, span), steps, teach);
            }
            None => {}
            Some(source) => match &source.content {
                ast::DataContent::Struct(variables) => {
                    let Some((Step::Member(member), rest)) = steps.split_first() else { return };
                    match variables.iter().find(|variable| fold(&variable.name) == fold(member)) {
                        Some(variable) => {
                            let ty = variable.ty.clone();
                            self.inside_type(&ty, rest, span, teach, 0);
                        }
                        // A component of another version of the data block.
                        None => descend(self.found.added(source.name.span(), name), steps, teach),
                    }
                }
                ast::DataContent::OfType(ty) => self.inside_type(ty, steps, span, teach, 0),
                ast::DataContent::Array(ty, _) => match steps.split_first() {
                    Some((Step::Member(_), rest)) => self.inside_type(ty, rest, span, teach, 0),
                    _ => self.inside_type(ty, steps, span, teach, 0),
                },
                ast::DataContent::Empty => {}
            },
        }
    }

    /// The type in the declaration of a variable of a block.
    pub(super) fn declared_type(&self, key: BlockKey, name: &str) -> Option<TypeRef> {
        let source = self.program.globals.sources.code.get(&key)?;
        let block = source.block();
        let mut variables = block.sections.iter().flat_map(|section| &section.variables);
        let variable = variables.find(|variable| fold(&variable.name) == fold(name));
        variable.map(|variable| variable.ty.clone()).or_else(|| block.return_type.clone())
    }

    /// Follows steps through declarations until one is missing.
    pub fn inside_type(
        &mut self,
        ty: &TypeRef,
        steps: &[Step],
        span: Span,
        teach: &mut dyn FnMut(&mut Shape),
        depth: u32,
    ) {
        const DEPTH_MAX: u32 = 32;
        if depth > DEPTH_MAX {
            return;
        }
        match &ty.kind {
            TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } | TypeKind::Reference(element) => {
                let rest = match steps.split_first() {
                    Some((Step::Index(_), rest)) => rest,
                    _ => steps,
                };
                self.inside_type(element, rest, span, teach, depth + 1);
            }
            TypeKind::Struct(variables) => self.inside_members(variables, steps, span, teach, depth),
            TypeKind::Named(word) => {
                let name = BlockName::Symbol { name: word.clone(), span: ty.span };
                if !is_type_word(word) {
                    self.inside_named(&name, steps, span, teach, depth);
                }
            }
            TypeKind::Block(name) => self.inside_named(name, steps, span, teach, depth),
            TypeKind::String(_) | TypeKind::WideString(_) | TypeKind::Error => {}
        }
    }

    fn inside_members(
        &mut self,
        variables: &[ast::Variable],
        steps: &[Step],
        span: Span,
        teach: &mut dyn FnMut(&mut Shape),
        depth: u32,
    ) {
        if let Some((Step::Member(name), rest)) = steps.split_first()
            && let Some(variable) = variables.iter().find(|variable| fold(&variable.name) == fold(name))
        {
            let ty = variable.ty.clone();
            self.inside_type(&ty, rest, span, teach, depth + 1);
        }
    }

    fn inside_named(
        &mut self,
        name: &BlockName,
        steps: &[Step],
        span: Span,
        teach: &mut dyn FnMut(&mut Shape),
        depth: u32,
    ) {
        let (prefix, number, missing, text) = match name {
            BlockName::Symbol { name: text, span: place } => {
                let missing = Missing::name(text);
                let known = self.quietly(|program| {
                    program.type_block(text).or_else(|| match program.globals.global(text) {
                        Some(SymbolTarget::Block { prefix, number }) => Some((prefix, number as u16)),
                        _ => None,
                    })
                });
                match known {
                    Some((prefix, number)) if !self.found.things.contains_key(&missing) => {
                        (prefix, u32::from(number), None, text.clone())
                    }
                    _ => {
                        let predefined = self.quietly(|program| program.predefined(text, *place).is_some());
                        if predefined {
                            return;
                        }
                        (BlockPrefix::Udt, 0, Some(missing), text.clone())
                    }
                }
            }
            BlockName::Numbered { prefix, number, .. } => {
                (*prefix, *number, None, format!("{} {number}", prefix.letters()))
            }
        };
        let missing = match missing {
            Some(missing) => Some(missing),
            None => Missing::block(prefix, number)
                .filter(|missing| self.found.things.contains_key(missing) || !self.is_block(prefix, number)),
        };
        if let Some(missing) = missing {
            let shape = self.found.of(missing, &text, span);
            shape.is_type = true;
            descend(shape, steps, teach);
            return;
        }
        let Ok(number) = u16::try_from(number) else { return };
        match prefix {
            BlockPrefix::Udt => {
                let Some(&block) = self.program.globals.sources.types.get(&number) else { return };
                match &block.alias {
                    Some(ty) => self.inside_type(ty, steps, span, teach, depth + 1),
                    None => self.inside_members(&block.members, steps, span, teach, depth + 1),
                }
            }
            BlockPrefix::Fb => {
                let Some((Step::Member(name), rest)) = steps.split_first() else { return };
                if let Some(ty) = self.declared_type(BlockKey { kind: BlockKind::Fb, number }, name) {
                    self.inside_type(&ty, rest, span, teach, depth + 1);
                }
            }
            _ => {}
        }
    }
}

/// Follows a step into a missing name.
pub(super) fn descend(shape: &mut Shape, steps: &[Step], teach: &mut dyn FnMut(&mut Shape)) {
    match steps.split_first() {
        None => teach(shape),
        Some((Step::Member(name), rest)) => descend(shape.member(name), rest, teach),
        Some((Step::Index(indices), rest)) => descend(shape.element(indices), rest, teach),
        Some((Step::Absolute(end), _)) => {
            shape.extent = shape.extent.max(*end);
            shape.is_db = true;
        }
        Some((Step::Slice(bits), _)) => {
            let ty = match bits {
                0..=8 => Elementary::Byte,
                9..=16 => Elementary::Word,
                17..=32 => Elementary::Dword,
                _ => Elementary::Lword,
            };
            shape.learn(Some(&Hint::Width(ty)));
        }
    }
}

/// Words that are types without a declaration.
fn is_type_word(word: &str) -> bool {
    Elementary::from_word(word).is_some()
        || matches!(
            word,
            "DATE_AND_TIME"
                | "DT"
                | "STRING"
                | "WSTRING"
                | "TIMER"
                | "COUNTER"
                | "BLOCK_FB"
                | "BLOCK_FC"
                | "BLOCK_DB"
                | "BLOCK_SDB"
                | "POINTER"
                | "ANY"
                | "VARIANT"
                | "VOID"
        )
}
