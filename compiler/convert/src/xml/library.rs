//! What the sources of a program declare, and the names of blocks in the file.

use std::collections::HashMap;

use plcc_syntax::ast::{
    Block, BlockName, BlockPrefix, CodeKind, DataBlock, DataContent, PathPart, Section, SourceUnit, TypeKind, TypeRef,
    Variable,
};
use plcc_syntax::symbols::{SymbolTable, SymbolTarget, parse_address};

use super::header::{instruction, number_in};
use super::system;
use crate::writer::Writer;

/// What the sources of a program declare: blocks for calls, structures for start values.
#[derive(Default)]
pub struct Library {
    /// Declarations of function blocks and functions, by folded names.
    pub(super) blocks: HashMap<String, (CodeKind, Vec<Section>, Option<TypeRef>)>,
    /// Members of data types and function blocks, also of timers and counters of the system.
    members: HashMap<String, Vec<Variable>>,
    /// Data types.
    pub(super) types: Vec<String>,
    /// Data blocks, with the types of what they declare.
    data: HashMap<String, Option<TypeRef>>,
    /// Blocks of instance data blocks.
    pub(super) instances: HashMap<String, BlockName>,
    /// Types of components of data blocks.
    data_types: Vec<TypeRef>,
    /// Names of numbered blocks, in the sources or the symbol tables.
    names: HashMap<(BlockPrefix, u32), String>,
    /// Members of blocks and data types of the system, by folded names.
    system: HashMap<String, Vec<Variable>>,
}

impl Library {
    pub fn new<'a>(units: impl Iterator<Item = &'a SourceUnit> + Clone) -> Library {
        Library::with_symbols(units, &[])
    }

    /// With the names that symbol tables give to numbered blocks: `FUNCTION_BLOCK FB 10` has the name of its symbol.
    pub fn with_symbols<'a>(units: impl Iterator<Item = &'a SourceUnit> + Clone, tables: &[SymbolTable]) -> Library {
        let mut library = Library { members: system::members().collect(), ..Library::default() };
        for block in units.clone().flat_map(|unit| &unit.blocks) {
            let (prefix, name, header) = match block {
                Block::Code(block) => (prefix_of(block.kind), &block.name, &block.header),
                Block::Data(block) => (BlockPrefix::Db, &block.name, &block.header),
                Block::Type(_) => continue,
            };
            if let BlockName::Symbol { name, .. } = name
                && let Some(number) = number_in(header).or_else(|| number_of(name, prefix))
            {
                library.names.insert((prefix, number), name.clone());
            }
        }
        for symbol in tables.iter().flat_map(|table| &table.symbols) {
            if let SymbolTarget::Block { prefix, number } = symbol.target {
                library.names.entry((prefix, number)).or_insert_with(|| symbol.name.clone());
            }
        }
        for block in units.flat_map(|unit| &unit.blocks) {
            match block {
                Block::Code(block) => {
                    let members = block.sections.iter().flat_map(|section| section.variables.clone()).collect();
                    let name = library.folded(&block.name);
                    library.members.insert(name.clone(), members);
                    library.blocks.insert(name, (block.kind, block.sections.clone(), block.return_type.clone()));
                }
                Block::Type(block) => {
                    let name = library.folded(&block.name);
                    library.types.push(name.clone());
                    library.members.insert(name, block.members.clone());
                }
                Block::Data(block) => {
                    let name = library.folded(&block.name);
                    let content = match &block.content {
                        DataContent::OfType(ty) | DataContent::Array(ty, _) => Some(ty.clone()),
                        DataContent::Struct(members) => {
                            Some(TypeRef { kind: TypeKind::Struct(members.clone()), span: block.span })
                        }
                        DataContent::Empty => None,
                    };
                    library.data.insert(name.clone(), content);
                    match &block.content {
                        DataContent::OfType(ty) => {
                            let of = match &ty.kind {
                                TypeKind::Block(of) => Some(of.clone()),
                                // A block of the system: `TON_TIME`.
                                TypeKind::Named(of) => Some(BlockName::Symbol { name: of.clone(), span: ty.span }),
                                TypeKind::String(_)
                                | TypeKind::WideString(_)
                                | TypeKind::Array { .. }
                                | TypeKind::OpenArray { .. }
                                | TypeKind::Reference(_)
                                | TypeKind::Struct(_)
                                | TypeKind::Error => None,
                            };
                            library.instances.extend(of.map(|of| (name, of)));
                            library.data_types.push(ty.clone());
                        }
                        DataContent::Struct(members) => {
                            let of = instruction(&block.header).map(|of| TypeKind::Named(of.to_uppercase()));
                            library.data_types.extend(of.map(|kind| TypeRef { kind, span: block.span }));
                            library.data_types.extend(members.iter().map(|member| member.ty.clone()));
                        }
                        DataContent::Array(ty, _) => library.data_types.push(ty.clone()),
                        DataContent::Empty => {}
                    }
                }
            }
        }
        library
    }

    /// Adds the members of the blocks and data types of the system that the sources name. `find`: those of one.
    pub fn add_system(&mut self, find: impl Fn(&str) -> Option<Vec<Variable>>) {
        let mut open = Vec::new();
        for variable in self.members.values().flatten() {
            self.mentioned(&variable.ty, &mut open);
        }
        for ty in &self.data_types {
            self.mentioned(ty, &mut open);
        }
        while let Some(name) = open.pop() {
            if self.members.contains_key(&name) || self.system.contains_key(&name) {
                continue;
            }
            if let Some(members) = find(&name) {
                for member in &members {
                    self.mentioned(&member.ty, &mut open);
                }
                self.system.insert(name, members);
            }
        }
    }

    /// The folded names of the types that a type consists of.
    fn mentioned(&self, ty: &TypeRef, found: &mut Vec<String>) {
        match &ty.kind {
            TypeKind::Named(name) => found.push(name.to_lowercase()),
            TypeKind::Block(name) => found.push(self.block_name(name).to_lowercase()),
            TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } => self.mentioned(element, found),
            TypeKind::Struct(members) => {
                for member in members {
                    self.mentioned(&member.ty, found);
                }
            }
            TypeKind::String(_) | TypeKind::WideString(_) | TypeKind::Reference(_) | TypeKind::Error => {}
        }
    }

    /// The members of a data type or block.
    pub(super) fn members<'s>(&'s self, ty: &'s TypeRef) -> Option<&'s [Variable]> {
        let name = match &ty.kind {
            TypeKind::Block(name) => self.block_name(name).to_lowercase(),
            TypeKind::Named(name) => name.to_lowercase(),
            TypeKind::Struct(members) => return Some(members),
            _ => return None,
        };
        self.members.get(&name).or_else(|| self.system.get(&name)).map(Vec::as_slice)
    }

    /// The type of what a data block declares.
    pub(super) fn content(&self, block: &str) -> Option<&TypeRef> {
        self.data.get(&block.to_lowercase())?.as_ref()
    }

    /// The type of the part of a value that a path leads to.
    pub(super) fn part<'s>(&'s self, of: &'s TypeRef, path: &[PathPart]) -> Option<&'s TypeRef> {
        path.iter().try_fold(of, |of, part| match (part, &of.kind) {
            (PathPart::Member { name, .. }, _) => {
                let member = self.members(of)?.iter().find(|member| member.name.eq_ignore_ascii_case(name))?;
                Some(&member.ty)
            }
            (PathPart::Index { .. }, TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. }) => {
                Some(element.as_ref())
            }
            (PathPart::Index { .. }, _) => None,
        })
    }

    /// The instruction whose data a block has that declares their components, as the TIA Portal writes it in sources.
    pub(super) fn instruction(&self, block: &DataBlock) -> Option<String> {
        let name = instruction(&block.header)?.to_uppercase();
        let DataContent::Struct(members) = &block.content else { return None };
        if self.blocks.contains_key(&name.to_lowercase()) || self.types.contains(&name.to_lowercase()) {
            return None;
        }
        let ty = TypeRef { kind: TypeKind::Named(name.clone()), span: block.span };
        let known = self.members(&ty)?;
        let is_known = |member: &Variable| {
            let same = known.iter().find(|known| known.name.eq_ignore_ascii_case(&member.name));
            same.is_some_and(|same| same.ty.kind == member.ty.kind)
        };
        members.iter().all(is_known).then_some(name)
    }

    /// Whether a name is that of a block or data type of the system, and the program has no other one by this name.
    pub(super) fn is_of_system(&self, name: &BlockName) -> bool {
        let name = self.folded(name);
        let is_own = self.blocks.contains_key(&name) || self.types.contains(&name);
        !is_own && (self.members.contains_key(&name) || self.system.contains_key(&name))
    }

    /// The block of an instance data block.
    pub(super) fn instance(&self, name: &str) -> Option<String> {
        self.instances.get(&name.to_lowercase()).map(|of| self.block_name(of))
    }

    /// The name of a block in the file.
    pub(super) fn block_name(&self, name: &BlockName) -> String {
        self.standard_name(name).map_or_else(|| self.own_name(name), str::to_string)
    }

    /// The name of a block of the program; one with only a number has that of its symbol.
    pub(super) fn own_name(&self, name: &BlockName) -> String {
        let BlockName::Numbered { prefix, number, .. } = name else { return name_of(name) };
        let prefix = if *prefix == BlockPrefix::Di { BlockPrefix::Db } else { *prefix };
        self.names.get(&(prefix, *number)).cloned().unwrap_or_else(|| name_of(name))
    }

    pub(super) fn folded(&self, name: &BlockName) -> String {
        self.own_name(name).to_lowercase()
    }

    /// The name of a numbered block of the CPU or of a library, `TON` of SFB 4; `None`: the program may have another one.
    pub(super) fn standard_name(&self, name: &BlockName) -> Option<&'static str> {
        let BlockName::Numbered { prefix, number, .. } = name else { return None };
        let symbol = self.names.get(&(*prefix, *number)).map(String::as_str);
        let block = plcc_stdlib::find_numbered(prefix.letters(), *number, symbol)?;
        (!self.members.contains_key(&self.folded(name))).then_some(block.name)
    }
}

fn prefix_of(kind: CodeKind) -> BlockPrefix {
    match kind {
        CodeKind::Ob => BlockPrefix::Ob,
        CodeKind::Fc => BlockPrefix::Fc,
        CodeKind::Fb => BlockPrefix::Fb,
        CodeKind::Sfc => BlockPrefix::Sfc,
        CodeKind::Sfb => BlockPrefix::Sfb,
    }
}

/// The name of a block; one with only a number, and without a symbol, gets a name of it.
pub(super) fn name_of(name: &BlockName) -> String {
    match name {
        BlockName::Symbol { name, .. } => name.clone(),
        BlockName::Numbered { prefix, number, .. } => format!("{}_{number}", prefix.letters()),
    }
}

/// The name of a block that is called or named as a type. One that only a number names must be in the sources, which give it its name.
pub(super) fn referred(name: &BlockName, library: &Library, writer: &mut Writer) -> String {
    if let Some(standard) = library.standard_name(name) {
        return standard.to_string();
    }
    let found = library.own_name(name);
    if let BlockName::Numbered { span, .. } = name
        && !library.members.contains_key(&found.to_lowercase())
        && !library.data.contains_key(&found.to_lowercase())
    {
        let title = format!("{} has no name, and SimaticML names blocks", writer.block_name(name));
        writer.refuse(*span, title, "add the source of the block, or name it by its symbol");
    }
    found
}

/// The number in a name such as `FC10`.
fn number_of(name: &str, prefix: BlockPrefix) -> Option<u32> {
    match parse_address(name)? {
        SymbolTarget::Block { prefix: named, number } if named == prefix => Some(number),
        SymbolTarget::Block { .. } | SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => None,
    }
}
