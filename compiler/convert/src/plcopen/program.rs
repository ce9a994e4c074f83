//! What the sources of a program declare, and the names that everything gets.

use std::collections::{BTreeSet, HashMap, HashSet};

use plcc_diag::Span;
use plcc_syntax::ast::{
    Block, BlockName, BlockPrefix, CodeBlock, CodeKind, DataBlock, DataContent, SourceUnit, TypeBlock, TypeKind,
    TypeRef, Variable,
};
use plcc_syntax::front::Comment;
use plcc_syntax::scl::ast::{Expr, ExprKind, NameForm};
use plcc_syntax::symbols::{GlobalConstant, Symbol, SymbolTable, SymbolTarget};

use super::identifier::{identifier, is_standard};
use super::{chart, system};

/// The data block in which a reader of PLCopen XML keeps global variables without an address.
pub const GLOBALS: &str = "GlobalVariables";

/// A source, with the text that its spans mean, and the comments that its tree does not hold.
pub struct Unit<'a> {
    pub unit: &'a SourceUnit,
    pub text: &'a str,
    pub comments: Vec<Comment>,
}

/// What a name outside of blocks means.
#[derive(Clone, Copy)]
pub enum Global<'a> {
    Code(&'a CodeBlock),
    Data(&'a DataBlock),
    Type(&'a TypeBlock),
    Tag(&'a Symbol),
    Constant(&'a GlobalConstant),
    /// A component of the block of global variables.
    Variable(&'a Variable),
}

/// What is known only after the bodies have been written once.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Learned {
    /// Keys of global names that a local variable hides.
    pub hidden: HashSet<String>,
    /// Instances of `IEC_TIMER` and `IEC_COUNTER` by the place of their type, with the block that is called with them.
    pub instances: HashMap<Span, &'static str>,
    /// Bytes of M that code names by their addresses: the first, and how many.
    pub memory: BTreeSet<(u32, u32)>,
}

/// A whole program.
pub struct Program<'a> {
    pub units: Vec<Unit<'a>>,
    pub tables: &'a [SymbolTable],
    /// By their keys.
    pub globals: HashMap<String, Global<'a>>,
    /// Names in the file, by keys.
    names: HashMap<String, String>,
    /// Numbers of blocks that symbols name, in lower case.
    numbers: HashMap<String, (BlockPrefix, u32)>,
    /// Instance data blocks that tasks run, by their keys, with the keys of their function blocks.
    pub tasks: HashMap<String, String>,
    pub learned: Learned,
    /// How often each word is in the sources, in lower case.
    words: HashMap<String, usize>,
}

/// The key of a numbered block.
fn numbered(prefix: BlockPrefix, number: u32) -> String {
    format!("{} {number}", prefix.letters())
}

impl<'a> Program<'a> {
    pub fn new(units: Vec<Unit<'a>>, tables: &'a [SymbolTable]) -> Program<'a> {
        let mut program = Program {
            units,
            tables,
            globals: HashMap::new(),
            names: HashMap::new(),
            numbers: HashMap::new(),
            tasks: HashMap::new(),
            learned: Learned::default(),
            words: HashMap::new(),
        };
        for unit in &program.units {
            for word in unit.text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty()) {
                *program.words.entry(word.to_lowercase()).or_default() += 1;
            }
        }
        for symbol in tables.iter().flat_map(|table| &table.symbols) {
            if let SymbolTarget::Block { prefix, number } = symbol.target {
                program.numbers.insert(symbol.name.to_lowercase(), (prefix, number));
            }
        }
        let blocks: Vec<&'a Block> = program.units.iter().flat_map(|unit| &unit.unit.blocks).collect();
        for block in blocks {
            let (name, global) = match block {
                Block::Code(block) => (&block.name, Global::Code(block)),
                Block::Data(block) => (&block.name, Global::Data(block)),
                Block::Type(block) => (&block.name, Global::Type(block)),
            };
            if let Block::Data(DataBlock { content: DataContent::Struct(members), .. }) = block
                && is_globals(name)
            {
                for member in members {
                    program.globals.insert(member.name.to_lowercase(), Global::Variable(member));
                }
                continue;
            }
            program.globals.insert(program.key(name), global);
        }
        for table in tables {
            for symbol in &table.symbols {
                if matches!(symbol.target, SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. }) {
                    program.globals.entry(symbol.name.to_lowercase()).or_insert(Global::Tag(symbol));
                }
            }
            for constant in &table.constants {
                program.globals.entry(constant.name.to_lowercase()).or_insert(Global::Constant(constant));
            }
        }
        program.name_all();
        program
    }

    /// How often the sources name something, in whatever meaning.
    pub fn uses(&self, name: &str) -> usize {
        match name.chars().all(|c| c.is_alphanumeric() || c == '_') {
            true => self.words.get(&name.to_lowercase()).copied().unwrap_or(0),
            // Not a word, so it was not counted.
            false => usize::MAX,
        }
    }

    /// The key of a block: its number if a table gives it one.
    pub fn key(&self, name: &BlockName) -> String {
        match name {
            BlockName::Numbered { prefix, number, .. } => numbered(*prefix, *number),
            BlockName::Symbol { name, .. } => self.key_of(name),
        }
    }

    pub fn key_of(&self, name: &str) -> String {
        let folded = name.to_lowercase();
        match self.numbers.get(&folded) {
            Some((prefix, number)) => numbered(*prefix, *number),
            None => folded,
        }
    }

    pub fn global(&self, key: &str) -> Option<Global<'a>> {
        self.globals.get(key).copied()
    }

    /// The name of a global in the file.
    pub fn name(&self, key: &str) -> String {
        self.names.get(key).cloned().unwrap_or_else(|| identifier(key))
    }

    /// The name of a global in the sources.
    pub fn own_name(&self, key: &str) -> String {
        let of_block = |name: &BlockName| match name {
            BlockName::Symbol { name, .. } => name.clone(),
            BlockName::Numbered { prefix, number, .. } => {
                let is_own =
                    |symbol: &&Symbol| symbol.target == SymbolTarget::Block { prefix: *prefix, number: *number };
                let symbol = self.tables.iter().flat_map(|table| &table.symbols).find(is_own);
                symbol.map_or_else(|| format!("{}_{number}", prefix.letters()), |symbol| symbol.name.clone())
            }
        };
        match self.global(key) {
            Some(Global::Code(block)) => of_block(&block.name),
            Some(Global::Data(block)) => of_block(&block.name),
            Some(Global::Type(block)) => of_block(&block.name),
            Some(Global::Tag(symbol)) => symbol.name.clone(),
            Some(Global::Constant(constant)) => constant.name.clone(),
            Some(Global::Variable(variable)) => variable.name.clone(),
            None => key.to_string(),
        }
    }

    /// A global as messages name it.
    pub fn shown(&self, key: &str) -> String {
        let name = self.own_name(key);
        if name == key.replace(' ', "_") { key.to_string() } else { name }
    }

    /// Gives all globals names of IEC 61131-3, each its own.
    pub fn name_all(&mut self) {
        let locals: HashSet<String> = self
            .code_blocks()
            .flat_map(|block| {
                let constants = block.constants.iter().map(|constant| &constant.name);
                let steps = chart::of_block(block).into_iter().flat_map(|chart| &chart.steps);
                let steps = steps.map(|step| &step.name.text);
                let variables = block.sections.iter().flat_map(|section| &section.variables);
                variables.map(|one| &one.name).chain(constants).chain(steps)
            })
            .map(|name| identifier(name).to_lowercase())
            .collect();
        let mut keys: Vec<&String> = self.globals.keys().collect();
        keys.sort();
        let mut taken: HashSet<String> = HashSet::new();
        let mut names = HashMap::new();
        // Names that stay as they are come first.
        let wanted = |key: &String| identifier(&self.own_name(key));
        let is_taken = |key: &String, name: &str| {
            matches!(self.global(key), Some(Global::Code(_) | Global::Type(_))) && is_standard(name)
        };
        let stays = |key: &String| {
            let own = self.own_name(key);
            wanted(key) == own && !self.learned.hidden.contains(key) && !is_taken(key, &own)
        };
        let (plain, others): (Vec<&String>, Vec<&String>) = keys.into_iter().partition(|key| stays(key));
        for key in plain.into_iter().chain(others) {
            let wanted = wanted(key);
            let hidden = self.learned.hidden.contains(key);
            let is_free = |name: &str| {
                let name = name.to_lowercase();
                !(taken.contains(&name) || hidden && locals.contains(&name) || is_taken(key, &name))
            };
            let name = free(&wanted, is_free);
            taken.insert(name.to_lowercase());
            names.insert(key.clone(), name);
        }
        self.names = names;
    }

    /// A name for a type or an object of the file that nothing else has.
    pub fn free_name(&self, wanted: &str, taken: &[String]) -> String {
        let is_taken = |name: &str| {
            let equal = |other: &String| other.eq_ignore_ascii_case(name);
            self.names.values().any(equal) || taken.iter().any(equal)
        };
        free(wanted, |name| !is_taken(name))
    }

    pub fn code_blocks(&self) -> impl Iterator<Item = &'a CodeBlock> {
        let units: Vec<&'a SourceUnit> = self.units.iter().map(|unit| unit.unit).collect();
        units.into_iter().flat_map(|unit| &unit.blocks).filter_map(|block| match block {
            Block::Code(block) => Some(block),
            Block::Data(_) | Block::Type(_) => None,
        })
    }

    /// The function block of an instance data block: its key.
    pub fn instance_of(&self, block: &DataBlock) -> Option<String> {
        let DataContent::OfType(ty) = &block.content else { return None };
        let key = self.type_key(ty)?;
        matches!(self.global(&key), Some(Global::Code(_))).then_some(key)
    }

    /// The key of the block or data type that a type names.
    pub fn type_key(&self, ty: &TypeRef) -> Option<String> {
        match &ty.kind {
            TypeKind::Block(name) => Some(self.key(name)),
            TypeKind::Named(name) => Some(self.key_of(name)).filter(|key| self.globals.contains_key(key)),
            _ => None,
        }
    }

    /// Components of a structure, a data type or a function block.
    pub fn members(&self, ty: &'a TypeRef) -> Option<Vec<&'a Variable>> {
        if let TypeKind::Struct(members) = &ty.kind {
            return Some(members.iter().collect());
        }
        match self.global(&self.type_key(ty)?)? {
            Global::Type(block) => match &block.alias {
                Some(alias) => self.members(alias),
                None => Some(block.members.iter().collect()),
            },
            Global::Code(block) => Some(block.sections.iter().flat_map(|section| &section.variables).collect()),
            _ => None,
        }
    }

    /// The declared type of an operand, as far as the sources say it.
    pub fn type_of(&self, value: &Expr, block: &'a CodeBlock) -> Option<&'a TypeRef> {
        match &value.kind {
            ExprKind::Name(name) => {
                let folded = name.text.to_lowercase();
                if name.form != NameForm::Quoted {
                    if let Some(variable) = local(block, &name.text) {
                        return Some(&variable.ty);
                    }
                    let constant = block.constants.iter().find(|one| one.name.to_lowercase() == folded);
                    if let Some(constant) = constant {
                        return constant.ty.as_ref();
                    }
                }
                match self.global(&self.key_of(&name.text))? {
                    Global::Data(data) => match &data.content {
                        DataContent::OfType(ty) | DataContent::Array(ty, _) => Some(ty),
                        DataContent::Struct(_) | DataContent::Empty => None,
                    },
                    Global::Code(block) => block.return_type.as_ref(),
                    Global::Variable(variable) => Some(&variable.ty),
                    Global::Type(_) | Global::Tag(_) | Global::Constant(_) => None,
                }
            }
            ExprKind::Member { base, name } => {
                let members = match self.struct_of(base) {
                    Some(members) => members,
                    None => self.members(self.type_of(base, block)?)?,
                };
                let is = |member: &&&Variable| member.name.eq_ignore_ascii_case(&name.text);
                members.iter().find(is).map(|member| &member.ty)
            }
            ExprKind::Index { base, .. } => match &self.type_of(base, block)?.kind {
                TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } => Some(element),
                _ => None,
            },
            ExprKind::Call { callee, .. } => match self.global(&self.callee_key(callee)?)? {
                Global::Code(block) => block.return_type.as_ref(),
                _ => None,
            },
            _ => None,
        }
    }

    /// The components of a data block that is a structure of its own.
    fn struct_of(&self, value: &Expr) -> Option<Vec<&'a Variable>> {
        let key = self.callee_key(value)?;
        match self.global(&key) {
            Some(Global::Data(DataBlock { content: DataContent::Struct(members), .. })) => {
                Some(members.iter().collect())
            }
            _ => None,
        }
    }

    /// The key of a block that an expression names.
    pub fn callee_key(&self, value: &Expr) -> Option<String> {
        match &value.kind {
            ExprKind::Name(name) if name.form != NameForm::Local => {
                let key = self.key_of(&name.text);
                if self.globals.contains_key(&key) {
                    return Some(key);
                }
                // `FC1`, `DB10` without a sign.
                match plcc_syntax::scl::absolute(&name.text) {
                    Some(plcc_syntax::ast::OperandKind::Block(block)) => Some(self.key(&block)),
                    _ => None,
                }
            }
            ExprKind::Absolute(plcc_syntax::ast::OperandKind::Block(name)) => Some(self.key(name)),
            _ => None,
        }
    }

    /// The type of an instance, in the file: a function block of the program, or one of the standard.
    pub fn block_type(&self, ty: &TypeRef) -> Option<String> {
        if let Some(key) = self.type_key(ty) {
            return matches!(self.global(&key), Some(Global::Code(_))).then(|| self.name(&key));
        }
        let TypeKind::Named(word) = &ty.kind else { return None };
        if let Some(standard) = system::block(word) {
            return Some(standard.to_string());
        }
        let learned = self.learned.instances.get(&ty.span)?;
        system::of_data_type(word, learned).map(str::to_string)
    }
}

/// The wanted name, or the first with a number that is free.
fn free(wanted: &str, is_free: impl Fn(&str) -> bool) -> String {
    let numbered = (1..).map(|number| format!("{wanted}_{number}"));
    std::iter::once(wanted.to_string()).chain(numbered).find(|name| is_free(name)).expect("numbers do not end")
}

/// A variable of a block.
pub fn local<'a>(block: &'a CodeBlock, name: &str) -> Option<&'a Variable> {
    let mut variables = block.sections.iter().flat_map(|section| &section.variables);
    variables.find(|variable| variable.name.to_lowercase() == name.to_lowercase())
}

pub fn is_globals(name: &BlockName) -> bool {
    matches!(name, BlockName::Symbol { name, .. } if name.eq_ignore_ascii_case(GLOBALS))
}

/// Whether a block is a function.
pub fn is_function(block: &CodeBlock) -> bool {
    matches!(block.kind, CodeKind::Fc | CodeKind::Sfc)
}
