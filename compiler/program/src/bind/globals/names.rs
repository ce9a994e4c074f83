//! Which names and numbers the program defines: symbol tables, blocks of the sources, blocks of the system.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_stdlib::{BlockClass, Form, SystemBlock};
use plcc_syntax::ast::{BlockName, BlockPrefix};
use rustc_hash::FxHashMap;

use crate::bind::globals::Globals;
use crate::bind::trees::SYSTEM_FILE;
use plcc_binding::constant::Constants;
use plcc_binding::{fold, similar};
use plcc_model::types::Elementary;
use plcc_syntax::symbols::{External, SymbolTarget};

/// Names and numbers that tables and sources define.
#[derive(Default)]
pub struct Names {
    /// By folded name.
    pub symbols: FxHashMap<String, Global>,
    /// Numbers of the program's data types, by folded name.
    pub types: FxHashMap<String, u16>,
    /// User constants of tag tables, by folded name.
    pub constants: Constants,
    /// Spellings of constants whose names are those of tags or blocks too, by folded name.
    pub confused: FxHashMap<String, String>,
    pub blocks: FxHashMap<(BlockPrefix, u16), String>,
    /// Where each block of the sources is defined.
    pub defined: FxHashMap<(BlockPrefix, u16), Span>,
}

/// A global name.
#[derive(Clone, Debug)]
pub struct Global {
    pub name: String,
    pub target: SymbolTarget,
    /// Type of a memory operand, if the table states it.
    pub ty: Option<Elementary>,
    /// Data type of a tag that is a structure, by its name.
    pub structure: Option<String>,
    /// What clients may do with it.
    pub external: External,
    pub span: Span,
}

/// The kind of code block that `prefix` names.
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

/// The prefix of a block with code.
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

/// The name in STEP 7 of a timer's data type of newer tools.
fn classic_name(name: &str) -> &str {
    match name.to_ascii_uppercase().as_str() {
        "TP_TIME" => "TP",
        "TON_TIME" => "TON",
        "TOF_TIME" => "TOF",
        _ => name,
    }
}

impl Names {
    /// Symbol of a block, empty if it has none.
    pub fn block_name(&self, prefix: BlockPrefix, number: u16) -> String {
        self.blocks.get(&(prefix, number)).cloned().unwrap_or_default()
    }
}

impl Globals<'_> {
    /// The block that a name means; reports a name that is defined nowhere. A system block is found by its standard name.
    pub fn block_number(&mut self, name: &BlockName) -> Option<(BlockPrefix, u16)> {
        match name {
            BlockName::Numbered { prefix, number, span } => match u16::try_from(*number) {
                Ok(number) => self.numbered_block(*prefix, number, *span),
                Err(_) => {
                    self.report.push(
                        Diagnostic::new(
                            Code::AddressRange,
                            *span,
                            format!("{} {number} is not a block number", prefix.letters()),
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
        match self.global_at(name, span) {
            Some(SymbolTarget::Block { prefix, number }) => Some((prefix, number as u16)),
            Some(_) => {
                self.report.push(
                    Diagnostic::new(Code::OperandKind, span, format!("`{name}` is not a block"))
                        .label("a block is expected here"),
                );
                None
            }
            None => {
                if !self.missing_instruction(name, span) {
                    self.unknown_name(name, span, std::iter::empty());
                }
                None
            }
        }
    }

    /// Reports an instruction that STEP 7 or the TIA Portal has but plcc does not; false: no instruction has the name.
    pub fn missing_instruction(&mut self, name: &str, span: Span) -> bool {
        let own = self.known_block(name).is_some() || self.names.symbols.contains_key(&fold(name));
        !own && self.report.missing_instruction(name, span)
    }

    /// The same without elements of networks that text languages write in another way.
    pub fn missing_in_catalogue(&mut self, name: &str, span: Span) -> bool {
        let own = self.known_block(name).is_some() || self.names.symbols.contains_key(&fold(name));
        !own && self.report.missing_in_catalogue(name, span)
    }

    /// A block of the libraries of which plcc only knows name and number.
    fn known_block(&self, name: &str) -> Option<&'static plcc_stdlib::LibraryBlock> {
        let folded = fold(name);
        let standard = fold(plcc_stdlib::standard_name(&folded));
        plcc_stdlib::LIBRARY.iter().find(|block| fold(block.name) == standard)
    }

    /// Reports a name that nothing defines. `locals`: the names that the block declares.
    pub fn unknown_name<'n>(&mut self, name: &str, span: Span, locals: impl Iterator<Item = &'n str>) {
        self.unknown(name, span, locals, false);
    }

    /// The same of an operand of STL.
    pub fn unknown_operand<'n>(&mut self, name: &str, span: Span, locals: impl Iterator<Item = &'n str>) {
        self.unknown(name, span, locals, true);
    }

    fn unknown<'n>(&mut self, name: &str, span: Span, locals: impl Iterator<Item = &'n str>, in_stl: bool) {
        match self.known_block(name) {
            Some(block) => {
                let prefix = if block.fb { BlockPrefix::Fb } else { BlockPrefix::Fc };
                self.report.not_shipped(prefix, block.number, block.name, span);
            }
            None => {
                let mut rows = self.input.tables.iter().flat_map(|table| &table.unreadable);
                if let Some(row) = rows.find(|row| fold(&row.name) == fold(name)) {
                    return self.report.unreadable_symbol(name, span, row);
                }
                let meant = self.path_in_quotes(name).or_else(|| self.similar_name(name, span, locals));
                self.report.missing_symbol(name, span, meant, in_stl);
            }
        }
    }

    /// `"Data.speed"` for `"Data".speed`.
    fn path_in_quotes(&self, name: &str) -> Option<String> {
        let (block, component) = name.split_once('.')?;
        let global = self.names.symbols.get(&fold(block))?;
        Some(format!("\"{}\".{component}", global.name))
    }

    /// A name of the block or the program that resembles `name`; that of the block comes first. A name in quotes is more likely one of the program.
    fn similar_name<'n>(&mut self, name: &str, span: Span, locals: impl Iterator<Item = &'n str>) -> Option<String> {
        if !self.report.may_search() {
            return None;
        }
        let globals = self.names.symbols.values().map(|global| global.name.as_str());
        if !self.text(span).starts_with('"') {
            return similar(name, locals).or_else(|| similar(name, globals)).map(str::to_owned);
        }
        let locals: Vec<&str> = locals.collect();
        let own = locals.iter().copied().find(|local| fold(local) == fold(name));
        let global = || similar(name, globals).map(str::to_owned);
        let local = |local: &str| format!("#{local}");
        own.map(local).or_else(global).or_else(|| similar(name, locals.iter().copied()).map(local))
    }

    /// Reports a data type that nothing defines.
    pub fn unknown_type(&mut self, name: &str, span: Span) {
        let shown = self.text(span).trim_matches('"').to_owned();
        let shown = if shown.eq_ignore_ascii_case(name) { shown } else { name.to_owned() };
        let meant = if self.report.may_search() {
            // Types are kept by folded name.
            let types = self.names.types.keys().map(String::as_str);
            let blocks = self.names.symbols.values().filter(|global| {
                matches!(global.target, SymbolTarget::Block { prefix: BlockPrefix::Fb | BlockPrefix::Udt, .. })
            });
            let blocks: Vec<&str> = blocks.map(|global| global.name.as_str()).collect();
            similar(name, blocks.into_iter()).or_else(|| similar(name, types)).map(str::to_owned)
        } else {
            None
        };
        self.report.missing_type(name, &shown, span, meant);
    }

    /// What a global name means: a row of a table, a block of the sources, or a system block with this standard name.
    pub fn global(&self, name: &str) -> Option<SymbolTarget> {
        if let Some(global) = self.names.symbols.get(&fold(name)) {
            return Some(global.target);
        }
        self.library_symbol(name)
    }

    /// The same of a name that is written at `span`. A block of the library means others of the library, and only it means their parts.
    pub fn global_at(&self, name: &str, span: Span) -> Option<SymbolTarget> {
        match span.file == SYSTEM_FILE {
            true => self.library_symbol(name).or_else(|| self.global(name)),
            false => self.global(name).filter(|_| !self.is_part(name)),
        }
    }

    /// Whether a name is that of a part of library blocks, and the program has no block of that name: only the library calls it.
    pub fn is_part(&self, name: &str) -> bool {
        !self.names.symbols.contains_key(&fold(name)) && plcc_stdlib::find_tia(name).is_some_and(SystemBlock::is_part)
    }

    /// Whether the program, a symbol table or the hardware defines a name.
    pub fn is_defined(&self, name: &str) -> bool {
        let folded = fold(name);
        self.names.symbols.contains_key(&folded)
            || self.names.constants.contains_key(&folded)
            || self.system_constant(name).is_some()
    }

    /// Whether only a block of the library has a name, which a tag of the program may have as well: `"Limit"`, `"Max"`.
    pub fn is_only_in_library(&self, name: &str) -> bool {
        !self.is_defined(name) && self.library_symbol(name).is_some()
    }

    fn library_symbol(&self, name: &str) -> Option<SymbolTarget> {
        let name = classic_name(name.trim());
        let block = plcc_stdlib::find_name(name).or_else(|| plcc_stdlib::find_tia(name))?;
        if self.library.is_foreign(block) {
            return None;
        }
        let key = self.library.key_of(block);
        Some(SymbolTarget::Block { prefix: kind_prefix(key.kind), number: u32::from(key.number) })
    }

    /// Reports a code block that nothing defines, and whether only plcc lacks it.
    pub fn unknown_block(&mut self, prefix: BlockPrefix, number: u16, span: Span) {
        let fb = prefix == BlockPrefix::Fb;
        let name = self.names.block_name(prefix, number);
        let library = plcc_stdlib::LIBRARY
            .iter()
            .find(|block| block.number == number && block.fb == fb && block.name.eq_ignore_ascii_case(&name));
        match library {
            Some(block) if matches!(prefix, BlockPrefix::Fc | BlockPrefix::Fb) => {
                self.report.not_shipped(prefix, number, block.name, span);
            }
            _ => match self.library_of_number(prefix, number).filter(|_| !name.is_empty()) {
                Some(library) => self.report.renamed_block(prefix, number, library.name, span),
                None => self.report.missing_block(prefix, number, span),
            },
        }
    }

    /// The FC or FB of a library that has this number there.
    fn library_of_number(&self, prefix: BlockPrefix, number: u16) -> Option<&'static SystemBlock> {
        let class = match prefix {
            BlockPrefix::Fc => BlockClass::Fc,
            BlockPrefix::Fb => BlockClass::Fb,
            _ => return None,
        };
        let block = plcc_stdlib::find(class, number)?;
        (block.form != Form::NotShipped && !self.library.is_foreign(block)).then_some(block)
    }
}
