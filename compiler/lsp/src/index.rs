//! The blocks, variables and symbols of a program, by name and by place.

use plcc_diag::{FileId, Span};
use plcc_syntax::ast::{Block, BlockName, CodeKind, DataContent, SectionKind, Statement, TypeKind, TypeRef, Variable};
use plcc_syntax::symbols::{GlobalConstant, Symbol, SymbolTarget};

use crate::Checked;
use crate::facts::same;

/// A block of a source.
#[derive(Clone, Copy)]
pub struct Entry<'c> {
    pub file: FileId,
    pub block: &'c Block,
}

/// A variable with what it is for: `IN`, `STAT` …
pub type Declared<'c> = (&'static str, &'c Variable);

impl<'c> Entry<'c> {
    pub fn name(&self) -> &'c BlockName {
        match self.block {
            Block::Code(block) => &block.name,
            Block::Data(block) => &block.name,
            Block::Type(block) => &block.name,
        }
    }

    /// `FB 10`, or the symbol.
    pub fn text(&self) -> String {
        match self.name() {
            BlockName::Numbered { prefix, number, .. } => format!("{} {number}", prefix.letters()),
            BlockName::Symbol { name, .. } => name.clone(),
        }
    }

    pub fn title(&self) -> Option<&'c str> {
        match self.block {
            Block::Code(block) => block.header.title.as_deref(),
            Block::Data(block) => block.header.title.as_deref(),
            Block::Type(block) => block.header.title.as_deref(),
        }
    }

    /// The type of the value of a function.
    pub fn return_type(&self) -> Option<&'c TypeRef> {
        match self.block {
            Block::Code(block) => block.return_type.as_ref(),
            Block::Data(_) | Block::Type(_) => None,
        }
    }

    pub fn is_data(&self) -> bool {
        matches!(self.block, Block::Data(_))
    }

    /// The keyword that begins it.
    pub fn keyword(&self) -> &'static str {
        match self.block {
            Block::Code(block) => match block.kind {
                CodeKind::Ob => "ORGANIZATION_BLOCK",
                CodeKind::Fc | CodeKind::Sfc => "FUNCTION",
                CodeKind::Fb | CodeKind::Sfb => "FUNCTION_BLOCK",
            },
            Block::Data(_) => "DATA_BLOCK",
            Block::Type(_) => "TYPE",
        }
    }

    /// Its variables, as they are declared in it.
    pub fn variables(&self) -> Vec<Declared<'c>> {
        match self.block {
            Block::Code(block) => {
                let sections = block.sections.iter();
                sections
                    .flat_map(|section| section.variables.iter().map(|variable| (direction(section.kind), variable)))
                    .collect()
            }
            Block::Data(block) => match &block.content {
                DataContent::Struct(variables) => variables.iter().map(|variable| ("DB", variable)).collect(),
                DataContent::OfType(_) | DataContent::Array(..) | DataContent::Empty => Vec::new(),
            },
            Block::Type(block) => block.members.iter().map(|variable| ("TYPE", variable)).collect(),
        }
    }

    /// The statements of STL.
    pub fn statements(&self) -> impl Iterator<Item = &'c Statement> + use<'c> {
        let networks = match self.block {
            Block::Code(block) => block.networks(),
            Block::Data(_) | Block::Type(_) => &[],
        };
        networks.iter().flat_map(|network| &network.statements)
    }
}

const fn direction(kind: SectionKind) -> &'static str {
    match kind {
        SectionKind::Input => "IN",
        SectionKind::Output => "OUT",
        SectionKind::InOut => "IN_OUT",
        SectionKind::Static => "STAT",
        SectionKind::Temp => "TEMP",
    }
}

/// All blocks of a program.
pub struct Index<'c> {
    pub checked: &'c Checked,
    pub blocks: Vec<Entry<'c>>,
}

impl<'c> Index<'c> {
    pub fn new(checked: &'c Checked) -> Index<'c> {
        let units = checked.units.iter();
        let blocks = units.flat_map(|(file, unit)| unit.blocks.iter().map(|block| Entry { file: *file, block }));
        Index { checked, blocks: blocks.collect() }
    }

    /// The block around a byte of a file.
    pub fn around(&self, file: FileId, byte: usize) -> Option<Entry<'c>> {
        let inside = |span: Span| span.start as usize <= byte && byte <= span.end as usize;
        self.blocks.iter().find(|entry| entry.file == file && inside(entry.block.span())).copied()
    }

    /// The block with this symbol, or this number: `FC1`, `FC 1`.
    pub fn block(&self, name: &str) -> Option<Entry<'c>> {
        let number = numbered(name);
        let is_it = |entry: &&Entry<'c>| match entry.name() {
            BlockName::Symbol { name: own, .. } => same(own, name),
            BlockName::Numbered { prefix, number: own, .. } => {
                number.as_ref().is_some_and(|(letters, number)| prefix.letters() == letters && own == number)
            }
        };
        let first = self.blocks.iter().find(is_it);
        // A data block may have the name of its data type, which is meant where a type stands.
        let other = first.filter(|entry| matches!(entry.block, Block::Type(_)));
        let other = other.and_then(|_| self.blocks.iter().filter(is_it).find(|entry| entry.is_data()));
        other.or(first).copied().or_else(|| match self.symbol(name)?.target {
            // Not by name again: the symbol `DB58` may be that of DB 58, which no source has.
            SymbolTarget::Block { prefix, number } => self.with_number(prefix.letters(), number),
            SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => None,
        })
    }

    fn with_number(&self, letters: &str, wanted: u32) -> Option<Entry<'c>> {
        let found = self.blocks.iter().find(|entry| match entry.name() {
            BlockName::Numbered { prefix, number, .. } => prefix.letters() == letters && *number == wanted,
            BlockName::Symbol { .. } => false,
        });
        found.copied()
    }

    /// The block or data type that a name means where a type stands. A data block is not a type: one that is declared with its own name,
    /// or two with the names of each other, would have no end.
    pub fn typed(&self, name: &str) -> Option<Entry<'c>> {
        let found = self.block(name)?;
        let is_it = |entry: &&Entry<'c>| !entry.is_data() && same(&entry.text(), name);
        if found.is_data() { self.blocks.iter().find(is_it).copied() } else { Some(found) }
    }

    /// A row of a symbol table.
    pub fn symbol(&self, name: &str) -> Option<&'c Symbol> {
        self.checked.tables.iter().flat_map(|table| &table.symbols).find(|symbol| same(&symbol.name, name))
    }

    /// A constant of a tag table.
    pub fn constant(&self, name: &str) -> Option<&'c GlobalConstant> {
        self.checked.tables.iter().flat_map(|table| &table.constants).find(|constant| same(&constant.name, name))
    }

    /// The components of a type.
    pub fn members(&self, ty: &'c TypeRef) -> Vec<Declared<'c>> {
        match &ty.kind {
            TypeKind::Struct(members) => members.iter().map(|member| ("", member)).collect(),
            TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } | TypeKind::Reference(element) => {
                self.members(element)
            }
            TypeKind::Named(_) | TypeKind::Block(_) => self.block_of(ty).map_or(Vec::new(), |entry| self.inside(entry)),
            TypeKind::String(_) | TypeKind::WideString(_) | TypeKind::Error => Vec::new(),
        }
    }

    /// The block or data type that a type is.
    pub fn block_of(&self, ty: &TypeRef) -> Option<Entry<'c>> {
        match &ty.kind {
            TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } | TypeKind::Reference(element) => {
                self.block_of(element)
            }
            TypeKind::Named(name) | TypeKind::Block(BlockName::Symbol { name, .. }) => self.typed(name),
            TypeKind::Block(BlockName::Numbered { prefix, number, .. }) => {
                self.block(&format!("{}{number}", prefix.letters())).filter(|entry| !entry.is_data())
            }
            TypeKind::Struct(_) | TypeKind::String(_) | TypeKind::WideString(_) | TypeKind::Error => None,
        }
    }

    /// The block of an instance; otherwise the block itself.
    pub fn instance_of(&self, entry: Entry<'c>) -> Entry<'c> {
        match entry.block {
            Block::Data(block) => match &block.content {
                DataContent::OfType(ty) | DataContent::Array(ty, _) => self.block_of(ty).unwrap_or(entry),
                DataContent::Struct(_) | DataContent::Empty => entry,
            },
            Block::Code(_) | Block::Type(_) => entry,
        }
    }

    /// What can follow the name of a block and a point.
    pub fn inside(&self, entry: Entry<'c>) -> Vec<Declared<'c>> {
        match entry.block {
            Block::Data(block) => match &block.content {
                DataContent::OfType(ty) | DataContent::Array(ty, _) => self.members(ty),
                DataContent::Struct(_) | DataContent::Empty => entry.variables(),
            },
            Block::Code(_) | Block::Type(_) => {
                entry.variables().into_iter().filter(|(direction, _)| *direction != "TEMP").collect()
            }
        }
    }

    /// The variable that is declared at a span.
    pub fn declared_at(&self, entry: Entry<'c>, span: Span) -> Option<Declared<'c>> {
        fn find<'c>(variables: Vec<Declared<'c>>, span: Span) -> Option<Declared<'c>> {
            for (direction, variable) in variables {
                if variable.name_span == span {
                    return Some((direction, variable));
                }
                let mut ty = &variable.ty.kind;
                while let TypeKind::Array { element, .. } = ty {
                    ty = &element.kind;
                }
                if let TypeKind::Struct(members) = ty
                    && let Some(found) = find(members.iter().map(|member| ("", member)).collect(), span)
                {
                    return Some(found);
                }
            }
            None
        }
        find(entry.variables(), span)
    }

    /// The variables that are declared beside the one with this name, itself included.
    pub fn siblings(&self, name: Span) -> Vec<Declared<'c>> {
        fn find<'c>(variables: Vec<Declared<'c>>, name: Span) -> Option<Vec<Declared<'c>>> {
            if variables.iter().any(|(_, variable)| variable.name_span == name) {
                return Some(variables);
            }
            variables.into_iter().find_map(|(_, variable)| {
                let mut ty = &variable.ty.kind;
                while let TypeKind::Array { element, .. } = ty {
                    ty = &element.kind;
                }
                match ty {
                    TypeKind::Struct(members) => find(members.iter().map(|member| ("", member)).collect(), name),
                    _ => None,
                }
            })
        }
        let entries = self.blocks.iter().filter(|entry| entry.file == name.file);
        entries.filter_map(|entry| find(entry.variables(), name)).next().unwrap_or_default()
    }

    /// The text of a type as it is written.
    pub fn type_text(&self, ty: &TypeRef) -> String {
        if let TypeKind::Struct(_) = ty.kind {
            // Its components are in the outline.
            return "STRUCT".to_owned();
        }
        let text = self.checked.sources.text(ty.span);
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }
}

/// `FC1`, `FC 1` as letters and number.
pub fn numbered(name: &str) -> Option<(String, u32)> {
    let digits = name.find(|c: char| c.is_ascii_digit())?;
    let letters = name[..digits].trim().to_ascii_uppercase();
    let known = ["OB", "FC", "FB", "SFC", "SFB", "DB", "DI", "UDT"].contains(&letters.as_str());
    Some((letters, name[digits..].parse().ok()?)).filter(|_| known)
}
