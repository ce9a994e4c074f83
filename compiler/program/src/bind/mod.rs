//! Binding: syntax trees and symbol tables in, the bound program out.
//!
//! 1. [`names`] reads the tables and numbers the blocks of all sources, so that order does not matter.
//! 2. [`declare`] lays out types, [`interface`] the interfaces of blocks, each when first needed; [`data`] makes the data blocks.
//! 3. [`body`] binds statements: [`path`] turns names into places, [`operand`] checks operands against the instruction table,
//!    [`call`] and [`actual`] check calls, [`pragma`] binds assertions, [`assertion`] compares by type. That is STL; [`scl`] does the same for SCL.
//! 4. Blocks of the [`library`] are added when something uses them.
//!
//! [`constant`] computes constants of all languages; [`library_reference`] prints the reference of the library.
//!
//! With errors the program is incomplete and must not be lowered; the same applies to `partial` runs with warnings about
//! undefined names.

mod chart;
mod chart_data;
mod declarations;
mod family;
mod library_reference;
mod mentions;
mod network;
mod partial;
#[cfg(test)]
mod partial_tests;
mod scl;
mod stl;

#[cfg(test)]
mod declaration_tests;
#[cfg(test)]
#[path = "../../../readers/tests/notation/mod.rs"]
mod notation;
#[cfg(test)]
mod tests;

use std::rc::Rc;

use plcc_abi::image::{BlockKind, Config, SymbolEntry};
use plcc_abi::ob::ObClass;
use plcc_diag::{Code, Diagnostic, FileId, Span};
use plcc_syntax::ast::{self, Area, BlockPrefix, CellKind, Width};
use rustc_hash::{FxHashMap, FxHashSet};

pub use chart::reference as graph_reference;
use declarations::names::Global;
pub use declarations::names::has_free_obs;
use declarations::types::{self, BoundInterface, Scope, Typed, TypedStruct};
use declarations::{data, names};
pub use family::implied_family;
pub use library_reference::standard_library;
pub use network::{is_about_drafts, reference as lad_fbd_reference};
pub use partial::complete;
use plcc_binding::constant::Constants;
use plcc_binding::report::Report;
use plcc_binding::{BindInput, Bound};
use plcc_model::types::StructType;
use plcc_model::{BlockKey, Body, CodeBlock, Program, TestSettings};
use plcc_syntax::symbols::SymbolTarget;
pub use scl::{functions as scl_functions, reference as scl_reference};

/// TEMP of an OB holds at least its start information.
const OB_START_INFORMATION_BYTES: u32 = 20;

/// File of the sources of the system blocks; no user file has this number.
const SYSTEM_FILE: FileId = FileId(u32::MAX);

/// Binds a program. The program is complete if no message is an error and, with `partial`, nothing is undefined.
pub fn bind(input: &BindInput) -> (Program, Vec<Diagnostic>) {
    let Bound { program, diagnostics, .. } = bind_all(input);
    (program, diagnostics)
}

fn bind_all(input: &BindInput) -> Bound {
    let mut binder = Binder::new(input);
    binder.collect();
    binder.system_memory();
    binder.ob_classes();
    binder.bind_types();
    binder.bind_data();
    let mut blocks = binder.bind_user_blocks();
    binder.bind_system_blocks(&mut blocks);
    binder.check_pointers();
    blocks.sort_by_key(CodeBlock::key);
    let config = std::mem::take(&mut binder.config);
    if input.require_main && !blocks.iter().any(|block| is_main(input, &config, block)) {
        binder.no_main_block();
    }
    let test = binder.file_pragmas();
    let mut dbs = std::mem::take(&mut binder.dbs);
    let mut dbs: Vec<_> = dbs.drain().map(|(_, db)| db.block).collect();
    dbs.sort_by_key(|db| db.number);
    let symbols = binder.symbol_entries();
    let notices = std::mem::take(&mut binder.notices);
    let (mut diagnostics, missing) = binder.report.finish();
    // A message inside a system block has no file to show.
    for diagnostic in &mut diagnostics {
        if diagnostic.primary.span.file == SYSTEM_FILE {
            diagnostic.primary.span = Span::default();
        }
        diagnostic.secondary.retain(|label| label.span.file != SYSTEM_FILE);
    }
    let program = Program {
        name: input.name.clone(),
        profile: input.profile.clone(),
        config,
        blocks,
        dbs,
        symbols,
        notices,
        test,
        s7200: None,
        partial: Vec::new(),
    };
    Bound { program, diagnostics, missing }
}

/// True of the block that the CPU calls in each cycle.
fn is_main(input: &BindInput, config: &Config, block: &CodeBlock) -> bool {
    match block.kind {
        BlockKind::Ob if input.profile.family.is_portal() => {
            config.class_of(block.number) == Some(ObClass::ProgramCycle)
        }
        kind => kind == BlockKind::Ob && block.number == 1,
    }
}

/// A value that is made when first needed.
enum State<T> {
    /// In progress: a use now means a loop.
    Running,
    Done(T),
}

/// The syntax tree of a block with code.
#[derive(Clone)]
enum CodeSource<'a> {
    User(&'a ast::CodeBlock),
    /// Of a user block, with declarations that its language adds.
    Expanded(Rc<ast::CodeBlock>),
    System(Rc<ast::CodeBlock>),
}

impl CodeSource<'_> {
    fn block(&self) -> &ast::CodeBlock {
        match self {
            CodeSource::User(block) => block,
            CodeSource::Expanded(block) | CodeSource::System(block) => block,
        }
    }
}

/// A system block that is used.
struct SystemUse {
    key: BlockKey,
    /// The first use, which messages show instead of its statements.
    span: Span,
    runtime: bool,
}

struct Binder<'a> {
    input: &'a BindInput<'a>,
    /// As in the input, with the information from the blocks.
    config: Config,
    report: Report,
    globals: FxHashMap<String, Global>,
    /// Numbers of the program's data types, by folded name.
    type_names: FxHashMap<String, u16>,
    /// User constants of tag tables, by folded name.
    global_constants: Constants,
    block_names: FxHashMap<(BlockPrefix, u16), String>,
    /// Where each block of the sources is defined.
    defined: FxHashMap<(BlockPrefix, u16), Span>,
    code: FxHashMap<BlockKey, CodeSource<'a>>,
    data: FxHashMap<u16, &'a ast::DataBlock>,
    type_blocks: FxHashMap<u16, &'a ast::TypeBlock>,
    udts: FxHashMap<u16, State<Option<Typed>>>,
    /// DTL and other predefined structures.
    predefined: FxHashMap<&'static str, TypedStruct>,
    /// Where the declarations are that are currently bound.
    scope: Scope,
    /// A block of the TIA Portal is among the sources, or the CPU only exists there.
    tia_sources: bool,
    interfaces: FxHashMap<BlockKey, State<Option<Rc<BoundInterface>>>>,
    dbs: FxHashMap<u16, data::BoundDb>,
    /// Size of all data blocks so far, in bytes.
    db_bytes: u64,
    /// Current depth of nested types.
    depth: u32,
    /// Components by folded name; the structure is kept so that no other gets its address.
    member_index: FxHashMap<*const StructType, (Rc<StructType>, FxHashMap<String, usize>)>,
    system: Vec<SystemUse>,
    /// Library blocks whose numbers the program uses for its own, by their new numbers.
    moved: FxHashMap<BlockKey, &'static plcc_stdlib::SystemBlock>,
    system_used: FxHashSet<BlockKey>,
    /// Library blocks whose numbers or names mean missing blocks of the program: their calls have other parameters.
    foreign: FxHashSet<(plcc_stdlib::BlockClass, u16)>,
    /// Addresses beyond the CPU's limits that have been reported.
    limits_told: FxHashSet<(Area, u32)>,
    cells_told: FxHashSet<(CellKind, u32)>,
    /// Pointer parameters of instances: whether some call supplies them, and a call that does not.
    pointers: FxHashMap<(declarations::calls::InstanceId, usize), declarations::calls::PointerUse>,
    /// Data blocks that calls name as instances of undefined blocks: nothing is known of them.
    unknown_instances: FxHashSet<u16>,
    /// Lines that every run of the program prints at its start.
    notices: Vec<String>,
    /// It has been reported that REF_TO is not supported.
    references_refused: bool,
    /// Tags of the system memory that nothing sets, as reported; folded.
    system_tags_told: FxHashSet<String>,
}

/// Data for binding a block.
struct Ctx {
    key: BlockKey,
    bound: Rc<BoundInterface>,
    /// Folded; each is reported once.
    unknown_locals: FxHashSet<String>,
    /// End of the local data that direct addresses touch.
    local_bytes: u32,
    /// The block is a list of statements without a header.
    fragment: bool,
    /// Represents all statements of a system block.
    fixed_span: Option<Span>,
    /// Only while a block in SCL is bound.
    scl: scl::Scope,
}

impl<'a> Binder<'a> {
    fn new(input: &'a BindInput<'a>) -> Binder<'a> {
        Binder {
            input,
            config: input.config.clone(),
            report: Report::new(input.partial),
            globals: FxHashMap::default(),
            type_names: FxHashMap::default(),
            global_constants: Constants::default(),
            block_names: FxHashMap::default(),
            defined: FxHashMap::default(),
            code: FxHashMap::default(),
            data: FxHashMap::default(),
            type_blocks: FxHashMap::default(),
            udts: FxHashMap::default(),
            predefined: FxHashMap::default(),
            scope: Scope::default(),
            tia_sources: types::is_tia(input),
            interfaces: FxHashMap::default(),
            dbs: FxHashMap::default(),
            db_bytes: 0,
            depth: 0,
            member_index: FxHashMap::default(),
            system: Vec::new(),
            moved: FxHashMap::default(),
            system_used: FxHashSet::default(),
            foreign: FxHashSet::default(),
            limits_told: FxHashSet::default(),
            cells_told: FxHashSet::default(),
            pointers: FxHashMap::default(),
            unknown_instances: FxHashSet::default(),
            notices: Vec::new(),
            references_refused: false,
            system_tags_told: FxHashSet::default(),
        }
    }

    /// Every UDT, so that unused ones are checked, too.
    fn bind_types(&mut self) {
        let mut numbers: Vec<u16> = self.type_blocks.keys().copied().collect();
        numbers.sort_unstable();
        for number in numbers {
            let span = self.type_blocks[&number].name.span();
            self.udt(number, span);
        }
    }

    fn bind_user_blocks(&mut self) -> Vec<CodeBlock> {
        let mut keys: Vec<BlockKey> = self
            .code
            .iter()
            .filter(|(_, source)| !matches!(source, CodeSource::System(_)))
            .map(|(key, _)| *key)
            .collect();
        keys.sort_unstable();
        for &key in &keys {
            let span = self.code[&key].block().name.span();
            self.interface(key, span);
        }
        keys.into_iter().filter_map(|key| self.bind_block(key, None, false)).collect()
    }

    /// System blocks that are used, and those that they use.
    fn bind_system_blocks(&mut self, blocks: &mut Vec<CodeBlock>) {
        let mut next = 0;
        while let Some(used) = self.system.get(next) {
            let (key, span, runtime) = (used.key, used.span, used.runtime);
            next += 1;
            blocks.extend(self.bind_block(key, Some(span), runtime));
        }
    }

    fn bind_block(&mut self, key: BlockKey, fixed_span: Option<Span>, runtime: bool) -> Option<CodeBlock> {
        let source = self.code.get(&key)?.clone();
        let block = source.block();
        let span = block.name.span();
        let bound = self.interface(key, fixed_span.unwrap_or(span))?;
        let mut ctx = Ctx {
            key,
            bound: Rc::clone(&bound),
            unknown_locals: FxHashSet::default(),
            local_bytes: 0,
            fragment: fixed_span.is_none() && names::is_fragment(block),
            fixed_span,
            scl: scl::Scope::default(),
        };
        let body = if runtime { Body::Runtime } else { self.bind_code(&mut ctx, block) };
        let name = match self.block_name(names::kind_prefix(key.kind), key.number) {
            name if name.is_empty() => match &block.header.name {
                Some(name) if fixed_span.is_some() => name.trim().to_string(),
                _ => String::new(),
            },
            name => name,
        };
        Some(CodeBlock {
            kind: key.kind,
            number: key.number,
            name,
            span: fixed_span.unwrap_or(span),
            interface: bound.interface.clone(),
            temp_bytes: bound.temp_bytes.max(ctx.local_bytes.next_multiple_of(2)),
            body,
        })
    }

    fn bind_code(&mut self, ctx: &mut Ctx, block: &ast::CodeBlock) -> Body {
        match &block.code {
            ast::Code::Stl(_) => Body::Stl(self.bind_body(ctx, block)),
            ast::Code::Scl(body) => Body::Scl(self.bind_scl(ctx, block, body)),
            ast::Code::Graphic(body) => Body::Scl(self.bind_networks(ctx, block, body)),
            ast::Code::Chart(body) => Body::Scl(self.bind_chart(ctx, block, body)),
        }
    }

    fn no_main_block(&mut self) {
        // A text without any block is not a source, which the parser has reported.
        let is_code = |line: &str| !line.trim().is_empty() && !line.trim_start().starts_with("//");
        let unread = self.input.units.iter().any(|(file, unit)| {
            let source = self.input.sources.files().nth(file.0 as usize);
            unit.blocks.is_empty() && source.is_some_and(|(_, source)| source.text.lines().any(is_code))
        });
        if unread {
            return;
        }
        let first = self.input.units.iter().flat_map(|(_, unit)| &unit.blocks).next();
        let span = match first {
            Some(ast::Block::Code(code)) => code.name.span(),
            Some(ast::Block::Data(data)) => data.name.span(),
            Some(ast::Block::Type(ty)) => ty.name.span(),
            None => Span { file: self.input.units.first().map_or(FileId(0), |(file, _)| *file), start: 0, end: 0 },
        };
        self.report.push(
            Diagnostic::new(Code::NoMainBlock, span, "the program has no OB 1")
                .label("the CPU calls OB 1 in each cycle; this program has none")
                .help("add an ORGANIZATION_BLOCK OB 1 that calls the other blocks"),
        );
    }

    /// Named addresses of memory, timers, counters and DBs.
    fn symbol_entries(&self) -> Vec<SymbolEntry> {
        let mut entries: Vec<SymbolEntry> = self
            .globals
            .values()
            .filter_map(|global| {
                let address = match global.target {
                    SymbolTarget::Memory { area, width, byte, bit } => address_text(area, width, byte, bit),
                    SymbolTarget::Cell { kind: CellKind::Timer, number } => format!("T{number}"),
                    SymbolTarget::Cell { kind: CellKind::Counter, number } => format!("C{number}"),
                    SymbolTarget::Block { prefix: BlockPrefix::Db, number } => format!("DB{number}"),
                    SymbolTarget::Block { .. } => return None,
                };
                Some(SymbolEntry { name: global.name.clone(), address })
            })
            .collect();
        entries.sort_by(|a, b| a.name.cmp(&b.name));
        entries
    }

    fn file_pragmas(&mut self) -> TestSettings {
        let mut settings = TestSettings::default();
        if self.input.pragmas {
            for (_, unit) in self.input.units {
                for pragma in &unit.pragmas {
                    self.file_pragma(pragma, &mut settings);
                }
            }
        }
        settings
    }
}

/// An address as the runtime reads it: `Q4.0`, `MW20`.
fn address_text(area: Area, width: Width, byte: u32, bit: u8) -> String {
    let area = area.letters();
    match width {
        Width::Bit => format!("{area}{byte}.{bit}"),
        Width::Byte => format!("{area}B{byte}"),
        Width::Word => format!("{area}W{byte}"),
        Width::Dword | Width::Lword => format!("{area}D{byte}"),
    }
}
