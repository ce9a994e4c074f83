//! The blocks of all sources with their names and numbers, and the rows of symbol tables.

use std::path::Path;
use std::rc::Rc;

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, FileId, Span};
use plcc_syntax::ast as classic;
use plcc_syntax::s7200::ast::{self, Area, Direct, OperandKind, Section, StatementKind};
use plcc_syntax::s7200::{self, Insn};
use rustc_hash::{FxHashMap, FxHashSet};

use super::Binder;
use super::interface::Locals;
use plcc_syntax::distance;
use plcc_syntax::symbols::{Symbol, SymbolTarget};

/// Names of files without block headers that contain the main program, folded.
const MAIN_FILES: &[&str] = &[
    "main",
    "ob1",
    "ob_1",
    "main_ob1",
    "main_program",
    "mainprogram",
    "haupt",
    "hauptprogramm",
    "principal",
    "programma",
    "программа",
    "主程序",
    "主",
];

/// A block of the program.
pub struct Block<'a> {
    pub ast: &'a ast::Block,
    pub kind: BlockKind,
    pub number: u16,
    /// Empty if it has none.
    pub name: String,
    /// The header, or where the block begins.
    pub span: Span,
    pub locals: Rc<Locals>,
}

/// A row of a symbol table.
pub struct Global {
    pub name: String,
    /// An address, a constant, or a block; `Error`: the row has been reported.
    pub target: OperandKind,
    pub span: Span,
}

/// A block of the sources before it has a number.
struct Found<'a> {
    file: FileId,
    ast: &'a ast::Block,
    kind: BlockKind,
    number: Option<(u32, Span)>,
    name: String,
    span: Span,
}

/// The form in which names are compared: in one letter case, with `_` for blanks.
pub fn fold(name: &str) -> String {
    name.trim().to_lowercase().replace(' ', "_")
}

impl<'a> Binder<'a> {
    /// Finds all blocks and symbols.
    pub fn collect(&mut self) {
        let input = self.input;
        let sources = input.units.iter().filter_map(|(file, unit)| Some((*file, unit.s7200.as_ref()?)));
        let mut found: Vec<Found<'a>> =
            sources.flat_map(|(file, source)| source.blocks.iter().map(move |ast| Found::new(file, ast))).collect();
        self.settle_bare(&mut found);
        self.number_blocks(found);
        self.read_tables();
    }

    /// Gives blocks without a header their kind and name: the main program, or the subroutine that the file is named after.
    fn settle_bare(&self, found: &mut [Found<'a>]) {
        let mut in_file: FxHashMap<FileId, usize> = FxHashMap::default();
        for block in found.iter() {
            *in_file.entry(block.file).or_default() += 1;
        }
        let is_bare = |block: &Found| {
            block.ast.is_bare
                && block.ast.kind == ast::BlockKind::Main
                && in_file.get(&block.file) == Some(&1)
                && !has(block.ast, |insn| matches!(insn, Insn::Mend | Insn::End))
        };
        let alone = found.len() == 1;
        let has_main = found.iter().any(|block| block.ast.kind == ast::BlockKind::Main && !is_bare(block));
        let mut called: FxHashSet<String> = FxHashSet::default();
        let mut attached: FxHashSet<String> = FxHashSet::default();
        for block in found.iter() {
            named_blocks(block.ast, Insn::Call, &mut called);
            named_blocks(block.ast, Insn::Atch, &mut attached);
        }
        let stems: Vec<String> = found.iter().map(|block| self.stem(block.file)).collect();
        let bare: Vec<usize> = (0..found.len()).filter(|&index| is_bare(&found[index])).collect();
        let by_name: Vec<usize> = bare.iter().copied().filter(|&index| is_main_file(&fold(&stems[index]))).collect();
        let main: Vec<usize> = match (alone, by_name.is_empty()) {
            (true, _) => bare.clone(),
            (false, false) => by_name,
            (false, true) if has_main => Vec::new(),
            // The one that no block calls.
            (false, true) => {
                let is_root = |index: &usize| {
                    let stem = fold(&stems[*index]);
                    let has_parameters =
                        found[*index].ast.declarations.iter().any(|declaration| declaration.section != Section::Temp);
                    !called.contains(&stem) && !attached.contains(&stem) && !has_parameters
                };
                let roots: Vec<usize> = bare.iter().copied().filter(is_root).collect();
                if roots.len() == 1 { roots } else { Vec::new() }
            }
        };
        for &index in bare.iter().filter(|index| !main.contains(index)) {
            let stem = stems[index].clone();
            let folded = fold(&stem);
            let block = &mut found[index];
            let (kind, number) = match default_name(&folded) {
                Some((kind, number)) => (kind, Some((number, block.span))),
                None if attached.contains(&folded) && !called.contains(&folded) => (BlockKind::Int, None),
                None => (BlockKind::Sbr, None),
            };
            (block.kind, block.number, block.name) = (kind, number, stem);
        }
    }

    /// Name of a file without folder and extension.
    fn stem(&self, file: FileId) -> String {
        let name = self.input.sources.files().nth(file.0 as usize).map(|(_, source)| source.name.as_str());
        let stem = name.and_then(|name| Path::new(name).file_stem());
        stem.map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
    }

    /// Takes over the blocks: those with a number first, then the others get the free ones in order of the sources.
    fn number_blocks(&mut self, found: Vec<Found<'a>>) {
        let mut taken: FxHashMap<(BlockKind, u16), Span> = FxHashMap::default();
        let mut numbers: Vec<Option<u16>> = Vec::new();
        // A number that the sources or symbol tables name belongs to a block that may be missing.
        let mut mentioned: FxHashSet<(BlockKind, u16)> = FxHashSet::default();
        for block in &found {
            numbered_blocks(block.ast, &mut mentioned);
        }
        for row in self.input.tables.iter().flat_map(|table| &table.s7200) {
            if let OperandKind::Block { kind, number } = target(&row.address) {
                mentioned.extend(u16::try_from(number).map(|number| (block_kind(kind), number)));
            }
        }
        for block in &found {
            let number = match (block.kind, block.number) {
                (BlockKind::Ob, _) => Some(1),
                (kind, None) => self.number_in_tables(kind, &block.name),
                (kind, Some((number, span))) => {
                    self.check_block_number(kind, number, span);
                    Some(u16::try_from(number).unwrap_or(u16::MAX))
                }
            };
            if let Some(number) = number {
                match taken.get(&(block.kind, number)) {
                    Some(&first) => self.duplicate_block(block, number, first),
                    None => {
                        taken.insert((block.kind, number), block.span);
                    }
                }
            }
            numbers.push(number);
        }
        for (block, number) in found.into_iter().zip(numbers) {
            let number = number.unwrap_or_else(|| {
                let is_free = |key: &(BlockKind, u16)| !taken.contains_key(key) && !mentioned.contains(key);
                let free = (0..u16::MAX).find(|number| is_free(&(block.kind, *number)));
                let free = free.unwrap_or(u16::MAX);
                self.check_block_number(block.kind, u32::from(free), block.span);
                taken.insert((block.kind, free), block.span);
                free
            });
            self.add_block(block, number);
        }
    }

    /// The number that a symbol table gives to the block with this name.
    fn number_in_tables(&self, kind: BlockKind, name: &str) -> Option<u16> {
        let folded = fold(name);
        let mut rows = self.input.tables.iter().flat_map(|table| &table.s7200);
        rows.find_map(|row| match target(&row.address) {
            OperandKind::Block { kind: named, number } if block_kind(named) == kind && fold(&row.name) == folded => {
                u16::try_from(number).ok()
            }
            _ => None,
        })
    }

    fn add_block(&mut self, block: Found<'a>, number: u16) {
        let index = self.blocks.len();
        self.by_number.entry((block.kind, number)).or_insert(index);
        if !block.name.is_empty() {
            let first = *self.by_name.entry(fold(&block.name)).or_insert(index);
            if let Some(other) = self.blocks.get(first)
                && (other.kind, other.number) != (block.kind, number)
            {
                let message = Diagnostic::new(
                    Code::DuplicateName,
                    block.span,
                    format!("two blocks are called `{}` (008C)", block.name),
                )
                .label("the second one")
                .also(other.span, "the first one")
                .help("give one of them another name");
                self.push(message);
            }
        }
        self.blocks.push(Block {
            ast: block.ast,
            kind: block.kind,
            number,
            name: block.name,
            span: block.span,
            locals: Rc::new(Locals::default()),
        });
    }

    fn duplicate_block(&mut self, block: &Found, number: u16, first: Span) {
        let (title, help) = match block.kind {
            BlockKind::Ob => (
                "the program has two main programs (008C)".to_string(),
                "keep one; a file without block headers becomes a subroutine if it is named after it",
            ),
            kind => (
                format!("{}{number} is defined twice (008C)", kind.prefix()),
                "give one of them another number; compile the programs of two CPUs separately",
            ),
        };
        let message = Diagnostic::new(Code::DuplicateBlock, block.span, title);
        self.push(message.label("the second one").also(first, "the first one").help(help));
    }

    fn check_block_number(&mut self, kind: BlockKind, number: u32, span: Span) {
        let (limit, others) = match kind {
            BlockKind::Int => (self.row.interrupts, "interrupt routines"),
            _ => (self.row.subroutines, "subroutines"),
        };
        if number < u32::from(limit) {
            return;
        }
        let cpu = &self.input.profile.name;
        let message =
            Diagnostic::new(Code::NumberRange, span, format!("{}{number} does not exist (0090)", kind.prefix()))
                .label(format!("the CPU {cpu} has {limit} {others}: 0 to {}", limit.saturating_sub(1)))
                .help("take a smaller number, or name a larger CPU with --cpu");
        self.push(message);
    }

    /// Rows of all symbol tables.
    fn read_tables(&mut self) {
        let mut rows: Vec<(&'a str, Span, OperandKind)> = Vec::new();
        for table in self.input.tables {
            for row in &table.s7200 {
                rows.push((&row.name, row.name_span, target(&row.address)));
            }
            // A row that is possible in both families is in both lists.
            if table.s7200.is_empty() {
                let row = |symbol: &'a Symbol| (symbol.name.as_str(), symbol.span, classic_target(symbol.target));
                rows.extend(table.symbols.iter().map(row));
            }
        }
        for (name, span, target) in rows {
            self.add_global(name, span, target);
        }
    }

    fn add_global(&mut self, name: &str, span: Span, target: OperandKind) {
        if let OperandKind::Block { kind, number } = &target {
            // The table has the name of a block that the source only numbers.
            let key = (block_kind(*kind), u16::try_from(*number).unwrap_or(u16::MAX));
            if let Some(&index) = self.by_number.get(&key)
                && let Some(block) = self.blocks.get_mut(index)
            {
                self.by_name.entry(fold(name)).or_insert(index);
                if block.name.is_empty() {
                    block.name = name.to_string();
                }
            }
        }
        match self.globals.get(&fold(name)) {
            Some(first) if first.target != target => {
                let message =
                    Diagnostic::new(Code::DuplicateName, span, format!("the symbol `{name}` has two addresses"))
                        .label("the second one")
                        .also(first.span, "the first one")
                        .help("remove one of the rows");
                self.push(message);
            }
            Some(_) => {}
            None => {
                self.globals.insert(fold(name), Global { name: name.to_string(), target, span });
            }
        }
    }

    /// Names that resemble `name`, the nearest first: up to three of `locals`, symbols and blocks.
    pub fn nearest(&self, name: &str, locals: &Locals) -> Vec<String> {
        let wanted = fold(name);
        let limit = match wanted.chars().count() {
            0 | 1 | 65.. => return Vec::new(),
            2 | 3 => 1,
            _ => 2,
        };
        let mut near: Vec<(usize, String)> = Vec::new();
        let mut look_at = |folded: &str, name: &dyn Fn() -> String| {
            // Names of very different length are not similar; tables are long.
            if folded.len().abs_diff(wanted.len()) <= limit * 4 {
                let distance = distance::between(&wanted, folded);
                if distance <= limit {
                    near.push((distance, name()));
                }
            }
        };
        for local in &locals.list {
            look_at(&fold(&local.name), &|| format!("#{}", local.name));
        }
        for (folded, global) in &self.globals {
            look_at(folded, &|| global.name.clone());
        }
        for (folded, &index) in &self.by_name {
            look_at(folded, &|| self.blocks.get(index).map(|block| block.name.clone()).unwrap_or_default());
        }
        near.retain(|(_, name)| !name.is_empty());
        near.sort();
        near.dedup();
        near.into_iter().take(3).map(|(_, name)| name).collect()
    }
}

impl<'a> Found<'a> {
    fn new(file: FileId, ast: &'a ast::Block) -> Found<'a> {
        let begin = Span { end: ast.span.start, ..ast.span };
        let name = ast.name.as_ref();
        let span = name.map(|(_, span)| *span).or(ast.number.map(|(_, span)| span)).unwrap_or(begin);
        Found {
            file,
            ast,
            kind: block_kind(ast.kind),
            number: ast.number,
            name: name.map(|(name, _)| name.clone()).unwrap_or_default(),
            span,
        }
    }
}

/// Kind of a block in the bound program.
pub fn block_kind(kind: ast::BlockKind) -> BlockKind {
    match kind {
        ast::BlockKind::Main => BlockKind::Ob,
        ast::BlockKind::Subroutine => BlockKind::Sbr,
        ast::BlockKind::Interrupt => BlockKind::Int,
    }
}

/// Whether a file with this name (folded) contains the main program: `main`, `ob1`, `ob1_main`.
fn is_main_file(folded: &str) -> bool {
    MAIN_FILES.contains(&folded)
        || folded.starts_with("ob1_")
        || folded.starts_with("ob_1_")
        || folded.ends_with("_ob1")
}

/// `SBR_3`, `INT0`, `sbr3_mixer`: the number is in the name.
fn default_name(folded: &str) -> Option<(BlockKind, u32)> {
    let (kind, rest) = match (folded.strip_prefix("sbr"), folded.strip_prefix("int")) {
        (Some(rest), _) => (BlockKind::Sbr, rest),
        (_, Some(rest)) => (BlockKind::Int, rest),
        (None, None) => return None,
    };
    let rest = rest.trim_start_matches('_');
    let digits = rest.split('_').next().unwrap_or(rest);
    Some((kind, digits.parse().ok()?))
}

/// Blocks that operands name by number.
fn numbered_blocks(block: &ast::Block, numbers: &mut FxHashSet<(BlockKind, u16)>) {
    for operand in instructions(block).flat_map(|(_, operands)| operands) {
        if let OperandKind::Block { kind, number } = &operand.kind
            && let Ok(number) = u16::try_from(*number)
        {
            numbers.insert((block_kind(*kind), number));
        }
    }
}

fn instructions(block: &ast::Block) -> impl Iterator<Item = (Insn, &[ast::Operand])> {
    block.networks.iter().flat_map(|network| &network.statements).filter_map(|statement| match &statement.kind {
        StatementKind::Instruction { insn, operands, .. } => Some((*insn, operands.as_slice())),
        StatementKind::Pragma { .. } | StatementKind::Error => None,
    })
}

fn has(block: &ast::Block, wanted: impl Fn(Insn) -> bool) -> bool {
    instructions(block).any(|(insn, _)| wanted(insn))
}

/// Names of blocks that the instruction `wanted` can name, folded.
fn named_blocks(block: &ast::Block, wanted: Insn, names: &mut FxHashSet<String>) {
    for (_, operands) in instructions(block).filter(|(insn, _)| *insn == wanted) {
        if let Some(OperandKind::Symbol { name, .. }) = operands.first().map(|operand| &operand.kind) {
            names.insert(fold(name));
        }
    }
}

/// The address column of a symbol table.
fn target(address: &str) -> OperandKind {
    if let Some(direct) = s7200::parse_address(address) {
        return OperandKind::Direct(direct);
    }
    if let Some((kind, number)) = s7200::parse_block(address) {
        return OperandKind::Block { kind, number };
    }
    s7200::parse_constant(address).map_or(OperandKind::Error, OperandKind::Constant)
}

/// A row of a symbol table in the form of the other families.
fn classic_target(target: SymbolTarget) -> OperandKind {
    let direct = |area, width, number, bit| OperandKind::Direct(Direct { area, width, number, bit });
    match target {
        SymbolTarget::Memory { area, width, byte, bit } => {
            let area = match area {
                classic::Area::I => Area::I,
                classic::Area::Q => Area::Q,
                classic::Area::M => Area::M,
                classic::Area::L => Area::L,
                classic::Area::Pi => Area::Ai,
                classic::Area::Pq => Area::Aq,
                classic::Area::Db | classic::Area::Di => Area::V,
            };
            direct(area, Some(width), byte, bit)
        }
        SymbolTarget::Cell { kind: classic::CellKind::Timer, number } => direct(Area::T, None, number, 0),
        SymbolTarget::Cell { kind: classic::CellKind::Counter, number } => direct(Area::C, None, number, 0),
        SymbolTarget::Block { prefix: classic::BlockPrefix::Ob, number } => {
            OperandKind::Block { kind: ast::BlockKind::Main, number }
        }
        SymbolTarget::Block { .. } => OperandKind::Error,
    }
}
