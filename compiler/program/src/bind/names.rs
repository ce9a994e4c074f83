//! Which names and numbers the program defines: symbol tables, blocks of the sources, blocks of the system.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, BlockName, BlockPrefix, CodeKind};
use rustc_hash::{FxHashMap, FxHashSet};

use super::constant::{Constant, Constants};
use super::{Binder, mentions};
use crate::model::BlockKey;
use crate::symbols::{SymbolTarget, parse_address};
use crate::types::Elementary;

/// A global name.
#[derive(Clone, Debug)]
pub struct Global {
    pub name: String,
    pub target: SymbolTarget,
    /// Type of a memory operand, if the table tells it.
    pub ty: Option<Elementary>,
    /// Data type of a tag that is a structure, by its name.
    pub structure: Option<String>,
    pub span: Span,
}

/// Names in the form in which they are compared: letter case and outer blanks do not matter.
pub fn fold(name: &str) -> String {
    let name = name.trim();
    if name.is_ascii() { name.to_ascii_lowercase() } else { name.to_lowercase() }
}

/// The block kind of code that `prefix` names.
pub const fn code_kind(prefix: BlockPrefix) -> Option<BlockKind> {
    match prefix {
        BlockPrefix::Ob => Some(BlockKind::Ob),
        BlockPrefix::Fc => Some(BlockKind::Fc),
        BlockPrefix::Fb => Some(BlockKind::Fb),
        BlockPrefix::Sfc => Some(BlockKind::Sfc),
        BlockPrefix::Sfb => Some(BlockKind::Sfb),
        BlockPrefix::Db | BlockPrefix::Di | BlockPrefix::Udt | BlockPrefix::Vat => None,
    }
}

/// The letters of a block with code.
pub const fn kind_prefix(kind: BlockKind) -> BlockPrefix {
    match kind {
        BlockKind::Ob => BlockPrefix::Ob,
        // Blocks of an S7-200 are bound elsewhere.
        BlockKind::Fc | BlockKind::Sbr | BlockKind::Int => BlockPrefix::Fc,
        BlockKind::Fb => BlockPrefix::Fb,
        BlockKind::Sfc => BlockPrefix::Sfc,
        BlockKind::Sfb => BlockPrefix::Sfb,
        BlockKind::Db => BlockPrefix::Db,
    }
}

const fn source_prefix(kind: CodeKind) -> BlockPrefix {
    match kind {
        CodeKind::Ob => BlockPrefix::Ob,
        CodeKind::Fc => BlockPrefix::Fc,
        CodeKind::Fb => BlockPrefix::Fb,
        CodeKind::Sfc => BlockPrefix::Sfc,
        CodeKind::Sfb => BlockPrefix::Sfb,
    }
}

/// The name in STEP 7 of a timer's data type of newer tools.
fn classic_name(name: &str) -> &str {
    match name.to_ascii_uppercase().as_str() {
        "TP_TIME" => "TP",
        "TON_TIME" => "TON",
        "TOF_TIME" => "TOF",
        _ => name,
    }
}

/// Letters, number and name of a block of the sources.
fn frame(block: &ast::Block) -> (BlockPrefix, &BlockName) {
    match block {
        ast::Block::Code(code) => (source_prefix(code.kind), &code.name),
        ast::Block::Data(data) => (BlockPrefix::Db, &data.name),
        ast::Block::Type(ty) => (BlockPrefix::Udt, &ty.name),
    }
}

/// Names that the TIA Portal gives to organization blocks, and their numbers. Further ones of a kind are called `_1`, `_2`, where the
/// kind has several numbers.
#[rustfmt::skip]
const OB_NAMES: &[(&str, u32, u32)] = &[
    ("Main", 1, 1), ("Startup", 100, 1), ("Cyclic interrupt", 30, 9), ("Time of day", 10, 8),
    ("Time delay interrupt", 20, 4), ("Hardware interrupt", 40, 8), ("Status", 55, 1), ("Update", 56, 1), ("Profile", 57, 1),
    ("Time error interrupt", 80, 1), ("Diagnostic error interrupt", 82, 1), ("Pull or plug of modules", 83, 1),
    ("Rack or station failure", 86, 1), ("Programming error", 121, 1), ("IO access error", 122, 1),
];

/// The number of an organization block by its usual name.
fn ob_number(name: &str) -> Option<u32> {
    let name = name.trim();
    let (base, index) = match name.rsplit_once('_') {
        Some((base, index))
            if !index.is_empty() && index.len() < 4 && index.bytes().all(|digit| digit.is_ascii_digit()) =>
        {
            (base, index.parse().ok()?)
        }
        _ => (name, 0),
    };
    let (_, first, count) = OB_NAMES.iter().find(|(usual, ..)| usual.eq_ignore_ascii_case(base))?;
    (index < *count).then_some(first + index)
}

/// What starts an OB, if its attributes tell.
fn block_class(block: &ast::Block) -> Option<plcc_abi::ob::ObClass> {
    match block {
        ast::Block::Code(code) if code.kind == CodeKind::Ob => super::ob::class_attribute(&code.header)?.0,
        ast::Block::Code(_) | ast::Block::Data(_) | ast::Block::Type(_) => None,
    }
}

/// Attributes that hold the number of a block which is written with a name.
const NUMBER_ATTRIBUTES: [&str; 2] = ["S7_BlockNumber", "BlockNumber"];

/// The name of a block with its number, where the text tells it: `FC10` in one word, a number beside the name, the attribute `S7_BlockNumber`, an OB by its usual
/// name. A symbol table comes first.
fn numbered(
    block: &ast::Block,
    prefix: BlockPrefix,
    name: &BlockName,
    globals: &FxHashMap<String, Global>,
) -> BlockName {
    let BlockName::Symbol { name: text, span } = name else { return name.clone() };
    if globals.contains_key(&fold(text)) {
        return name.clone();
    }
    let header = match block {
        ast::Block::Code(code) => &code.header,
        ast::Block::Data(data) => &data.header,
        ast::Block::Type(ty) => &ty.header,
    };
    let written = match parse_address(text) {
        Some(SymbolTarget::Block { prefix: named, number }) if named == prefix => Some(number),
        _ => None,
    };
    let attribute = header
        .attributes
        .iter()
        .find(|(name, _)| NUMBER_ATTRIBUTES.iter().any(|number| number.eq_ignore_ascii_case(name)))
        .and_then(|(_, value)| value.trim().trim_matches(['\'', '"']).parse().ok());
    let usual = || if prefix == BlockPrefix::Ob { ob_number(text) } else { None };
    match written.or(header.number).or(attribute).or_else(usual) {
        Some(number) => BlockName::Numbered { prefix, number, span: *span },
        None => name.clone(),
    }
}

impl<'a> Binder<'a> {
    /// Reads the symbol tables and gives every block of the sources its number.
    pub fn collect(&mut self) {
        self.collect_tables();
        self.collect_constants();
        let blocks: Vec<&'a ast::Block> = self.input.units.iter().flat_map(|(_, unit)| &unit.blocks).collect();
        let mut used: FxHashSet<(BlockPrefix, u32)> = FxHashSet::default();
        for global in self.globals.values() {
            if let SymbolTarget::Block { prefix, number } = global.target {
                used.insert((prefix, number));
            }
        }
        let mut unnumbered = Vec::new();
        for &block in &blocks {
            let (prefix, name) = frame(block);
            if matches!(prefix, BlockPrefix::Sfc | BlockPrefix::Sfb) {
                self.report.push(
                    Diagnostic::new(Code::BlockFrame, name.span(), "system blocks belong to the CPU")
                        .label("a program cannot define this block")
                        .help("make it an FC or FB"),
                );
                continue;
            }
            match &numbered(block, prefix, name, &self.globals) {
                BlockName::Numbered { number, span, .. } => {
                    let portal = self.input.profile.family.is_portal();
                    let limit = match prefix {
                        BlockPrefix::Ob if portal => u32::from(plcc_abi::ob::OB_NUMBER_MAX),
                        BlockPrefix::Ob => 255,
                        _ => 65_535,
                    };
                    if *number > limit || (prefix == BlockPrefix::Db && *number == 0) {
                        self.report.push(
                            Diagnostic::new(
                                Code::AddressRange,
                                *span,
                                format!("{} {number} is no block number", prefix.letters()),
                            )
                            .label(format!("numbers go up to {limit}"))
                            .help("take another number; DB 0 is reserved"),
                        );
                        continue;
                    }
                    used.insert((prefix, *number));
                    self.define(block, prefix, *number as u16, *span);
                    if let (_, BlockName::Symbol { name, .. }) = frame(block) {
                        let target = SymbolTarget::Block { prefix, number: *number };
                        let global =
                            Global { name: name.trim().to_string(), target, ty: None, structure: None, span: *span };
                        self.globals.entry(fold(name)).or_insert(global);
                    }
                }
                BlockName::Symbol { name, span } => match self.globals.get(&fold(name)).map(|global| global.target) {
                    Some(SymbolTarget::Block { prefix: named, number }) if named == prefix && number <= 65_535 => {
                        self.define(block, prefix, number as u16, *span);
                    }
                    Some(_) => {
                        let global = &self.globals[&fold(name)];
                        self.report.push(
                            Diagnostic::new(
                                Code::DuplicateName,
                                *span,
                                format!("`{name}` is no {} in the symbol table", prefix.letters()),
                            )
                            .label(format!("a {} by this name", prefix.letters()))
                            .also(global.span, "the symbol"),
                        );
                    }
                    None => unnumbered.push((block, prefix, name.clone(), *span)),
                },
            }
        }
        if !unnumbered.is_empty() {
            used.extend(blocks.iter().flat_map(|block| mentions::numbers(block)));
        }
        let lonely = blocks.iter().filter(|block| frame(block).0 == BlockPrefix::Ob).count() == 1;
        let mut next: FxHashMap<BlockPrefix, u32> = FxHashMap::default();
        for (block, prefix, name, span) in unnumbered {
            let class = block_class(block);
            if prefix == BlockPrefix::Ob && class.is_none() && (!lonely || used.contains(&(BlockPrefix::Ob, 1))) {
                if self.input.partial {
                    self.report.push(
                        Diagnostic::new(Code::LeftOut, span, format!("the organization block `{name}` is left out"))
                            .label("the CPU finds an organization block by its number, which no source tells")
                            .help("give the name its number in a symbol table, or write `ORGANIZATION_BLOCK OB 35`"),
                    );
                    continue;
                }
                self.report.push(
                    Diagnostic::new(Code::BlockFrame, span, format!("which OB `{name}` is cannot be known"))
                        .label("the CPU finds an organization block by its number")
                        .help("write `ORGANIZATION_BLOCK OB 35`, or give the name its number in the symbol table"),
                );
                continue;
            }
            if let Some(global) = self.globals.get(&fold(&name)) {
                // Two blocks by one name: the second would replace the first.
                let first = global.span;
                let help = self.choice(first, span, "give one of them another name");
                self.report.push(
                    Diagnostic::new(Code::DuplicateBlock, span, format!("`{name}` is defined twice"))
                        .label("the second definition")
                        .also(first, "the first definition")
                        .help(help),
                );
                continue;
            }
            let number = next.entry(prefix).or_insert(1);
            // An OB of which only the class is known: the usual number of the class, else a free one.
            if let Some(class) = class {
                let (first, last) = class.row().numbers;
                let usual = (first..=last).map(u32::from).find(|number| !used.contains(&(prefix, *number)));
                *number = usual.unwrap_or(u32::from(plcc_abi::ob::OB_FREE));
            }
            while used.contains(&(prefix, *number)) {
                *number += 1;
            }
            if *number > 65_535 {
                continue;
            }
            let number = *number;
            used.insert((prefix, number));
            let target = SymbolTarget::Block { prefix, number };
            self.globals
                .insert(fold(&name), Global { name: name.trim().to_string(), target, ty: None, structure: None, span });
            self.define(block, prefix, number as u16, span);
        }
        for global in self.globals.values() {
            if let SymbolTarget::Block { prefix, number } = global.target
                && number <= 65_535
            {
                self.block_names.insert((prefix, number as u16), global.name.clone());
            }
        }
        self.find_foreign();
        self.move_library(&used);
    }

    fn collect_tables(&mut self) {
        let rows: usize = self.input.tables.iter().map(|table| table.symbols.len()).sum();
        self.globals.reserve(rows);
        for symbol in self.input.tables.iter().flat_map(|table| &table.symbols) {
            let ty = Elementary::from_word(&symbol.ty.to_ascii_uppercase());
            let structure = ty.is_none().then(|| symbol.ty.trim().trim_matches('"').to_string());
            let structure = structure.filter(|name| !name.is_empty());
            let global = Global { name: symbol.name.clone(), target: symbol.target, ty, structure, span: symbol.span };
            match self.globals.entry(fold(&symbol.name)) {
                std::collections::hash_map::Entry::Vacant(entry) => {
                    entry.insert(global);
                }
                std::collections::hash_map::Entry::Occupied(entry) => {
                    if entry.get().target != symbol.target {
                        let first = entry.get().span;
                        self.report.push(
                            Diagnostic::new(
                                Code::DuplicateName,
                                symbol.span,
                                format!("the symbol `{}` has two addresses", symbol.name),
                            )
                            .label("the second address")
                            .also(first, "the first address, which holds")
                            .help("remove one of the two rows"),
                        );
                    }
                }
            }
        }
    }

    /// User constants of tag tables, in their types.
    fn collect_constants(&mut self) {
        let input = self.input;
        for constant in input.tables.iter().flat_map(|table| &table.constants) {
            let Some(value) = self.constant(&Constants::default(), &constant.value) else { continue };
            let value = match Elementary::from_word(&constant.ty.to_ascii_uppercase()) {
                Some(ty) => match self.constant_bits(&value, ty, constant.value.span) {
                    Some(bits) => Constant::Typed { ty, bits },
                    None => continue,
                },
                None => value,
            };
            self.global_constants.entry(fold(&constant.name)).or_insert(value);
        }
    }

    /// What to do about two definitions: which version of a block counts is not guessed.
    fn choice(&self, first: Span, second: Span, same_file: &str) -> String {
        let name =
            |span: Span| self.input.sources.files().nth(span.file.0 as usize).map(|(_, file)| file.name.as_str());
        match (name(first), name(second)) {
            (Some(first), Some(second)) if first != second => format!(
                "choose one: give only the files of one CPU and one version, or name them as `sources` in plc.toml. The files are \
                 `{first}` and `{second}`"
            ),
            _ => same_file.to_string(),
        }
    }

    fn define(&mut self, block: &'a ast::Block, prefix: BlockPrefix, number: u16, span: Span) {
        if let Some(first) = self.defined.insert((prefix, number), span) {
            self.defined.insert((prefix, number), first);
            let title = format!("{} {number} is defined twice", prefix.letters());
            let help = self.choice(first, span, "give one of them another number");
            self.report.push(
                Diagnostic::new(Code::DuplicateBlock, span, title)
                    .label("the second definition")
                    .also(first, "the first definition")
                    .help(help),
            );
            return;
        }
        match block {
            ast::Block::Code(code) => {
                if let Some(kind) = code_kind(prefix) {
                    let source = match &code.code {
                        ast::Code::Chart(chart) => {
                            super::CodeSource::Expanded(std::rc::Rc::new(super::chart::expanded(code, chart)))
                        }
                        ast::Code::Stl(_) | ast::Code::Scl(_) | ast::Code::Graphic(_) => super::CodeSource::User(code),
                    };
                    self.code.insert(BlockKey { kind, number }, source);
                }
            }
            ast::Block::Data(data) => {
                self.data.insert(number, data);
            }
            ast::Block::Type(ty) => {
                self.type_blocks.insert(number, ty);
            }
        }
    }

    /// The block that a name means; what is defined nowhere is reported. A block of the system answers to its standard name.
    pub fn block_number(&mut self, name: &BlockName) -> Option<(BlockPrefix, u16)> {
        match name {
            BlockName::Numbered { prefix, number, span } => match u16::try_from(*number) {
                Ok(number) => self.numbered_block(*prefix, number, *span),
                Err(_) => {
                    self.report.push(
                        Diagnostic::new(
                            Code::AddressRange,
                            *span,
                            format!("{} {number} is no block number", prefix.letters()),
                        )
                        .label("numbers go up to 65535"),
                    );
                    None
                }
            },
            BlockName::Symbol { name, span } => self.named_block(name, *span),
        }
    }

    pub fn named_block(&mut self, name: &str, span: Span) -> Option<(BlockPrefix, u16)> {
        match self.global(name) {
            Some(SymbolTarget::Block { prefix, number }) => Some((prefix, number as u16)),
            Some(_) => {
                self.report.push(
                    Diagnostic::new(Code::OperandKind, span, format!("`{name}` is no block"))
                        .label("a block is wanted here"),
                );
                None
            }
            None => {
                self.unknown_name(name, span);
                None
            }
        }
    }

    /// Reports a name that nothing defines.
    pub fn unknown_name(&mut self, name: &str, span: Span) {
        let folded = fold(name);
        match plcc_stdlib::LIBRARY.iter().find(|block| fold(block.name) == folded) {
            Some(block) => {
                let prefix = if block.fb { BlockPrefix::Fb } else { BlockPrefix::Fc };
                self.report.not_shipped(prefix, block.number, block.name, span);
            }
            None => self.report.missing_symbol(name, span),
        }
    }

    /// What a global name stands for: a row of a table, a block of the sources, a block of the system by its standard name.
    pub fn global(&self, name: &str) -> Option<SymbolTarget> {
        if let Some(global) = self.globals.get(&fold(name)) {
            return Some(global.target);
        }
        let name = classic_name(name.trim());
        let key = self.library_key(plcc_stdlib::find_name(name).or_else(|| plcc_stdlib::find_tia(name))?);
        Some(SymbolTarget::Block { prefix: kind_prefix(key.kind), number: u32::from(key.number) })
    }

    /// Symbol of a block, empty if it has none.
    pub fn block_name(&self, prefix: BlockPrefix, number: u16) -> String {
        self.block_names.get(&(prefix, number)).cloned().unwrap_or_default()
    }

    /// Reports a block with code that nothing defines; it tells apart what only plcc lacks.
    pub fn unknown_block(&mut self, prefix: BlockPrefix, number: u16, span: Span) {
        let fb = prefix == BlockPrefix::Fb;
        let name = self.block_name(prefix, number);
        let library = plcc_stdlib::LIBRARY
            .iter()
            .find(|block| block.number == number && block.fb == fb && block.name.eq_ignore_ascii_case(&name));
        match library {
            Some(block) if matches!(prefix, BlockPrefix::Fc | BlockPrefix::Fb) => {
                self.report.not_shipped(prefix, number, block.name, span);
            }
            _ => self.report.missing_block(prefix, number, span),
        }
    }
}
