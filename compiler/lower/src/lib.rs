//! Lowers the bound program to the SSA IR; this is where PLC semantics are defined.
//!
//! - `plan` settles what blocks must know about each other: addresses of DBs, functions, depth of calls.
//! - `block` holds the state of one block while it is lowered: the virtual CPU's registers as SSA variables.
//! - `place` turns addresses into checked memory accesses, `fault` builds the cold paths.
//! - `call` passes parameters; `stl` has one function per family of instructions, `scl` one per kind of node of the typed tree.
//! - `s7200` lowers programs of an S7-200, with its own state of a block.
//! - For all families: `arithmetic`, `stop` has the safepoints and the way out of a function, `labels` the targets of jumps.
//! - `assertion`: code that assertions of all languages share.
//! - [`probe`]: what statements see, for a watcher of the program.
//! - `shapes`: what data blocks look like, for blocks that write them to files.
//! - `parts` makes functions of parts of a block.
//! - `entry` creates the functions that the runtime calls.
//!
//! **Invariant**: a program that was bound without errors lowers without errors.

mod arithmetic;
mod assertion;
mod block;
mod call;
mod entry;
mod fault;
mod labels;
mod names;
mod parts;
mod place;
mod plan;
mod pointer;
pub mod probe;
mod s7200;
mod scl;
mod shapes;
mod stl;
mod stop;
mod used;

use plcc_abi::ProgramImage;
use plcc_abi::image::{AssertEntry, BlockEntry, BlockKind, DbEntry, ErrorSlot, Family, Site};
use plcc_abi::s7200::image::S7200Image;
use plcc_diag::SourceMap;
use plcc_ir::entities::EntityVec;
use plcc_ir::{Areas, FuncId, Function, Module, StaticDb};
use plcc_model::Program;
use plcc_model::{Assert, Body, CodeBlock};

use crate::names::Types;
use crate::plan::Plan;
use crate::probe::{Asked, Probes};
use crate::used::Places;

/// A lowered program: its code, and data about it for the runtime.
#[derive(Clone, Debug)]
pub struct Lowered {
    pub module: Module,
    pub image: ProgramImage,
    /// Where its probes are; none unless they are asked for.
    pub probes: Vec<probe::Place>,
}

/// Lowers a program that was bound without errors.
pub fn lower(program: &Program, sources: &SourceMap) -> Lowered {
    lower_program(program, sources, Probes::default())
}

/// As [`lower`], but gives each function away as soon as it is made, in the order of their numbers; the module comes back without them. The
/// caller can finish some while others are lowered, so that the IR of a large program never is in memory as it was lowered.
pub fn lower_each(program: &Program, sources: &SourceMap, take: &mut dyn FnMut(Function)) -> Lowered {
    lower_to(program, sources, Probes::default(), take)
}

/// Lowers a program that was bound without errors, with probes that tell what its statements see.
pub fn lower_with_probes(program: &Program, sources: &SourceMap) -> Lowered {
    lower_program(program, sources, Probes::new(Asked::Values))
}

/// As [`lower_with_probes`], for code that runs in turn with `plain`: the numbers of its sites go on after those of `plain`, so that one
/// image serves both.
pub fn lower_beside(program: &Program, sources: &SourceMap, plain: &Module) -> Lowered {
    lower_program(program, sources, Probes { sites: plain.sites.clone(), ..Probes::new(Asked::Values) })
}

/// Lowers a program that was bound without errors, with a probe before each statement, and variables in memory.
pub fn lower_for_debugger(program: &Program, sources: &SourceMap) -> Lowered {
    lower_program(program, sources, Probes::new(Asked::Statements))
}

/// Lowers a program that was bound without errors, with probes that tell which of its statements run, and which values the bits have that
/// decide.
pub fn lower_for_coverage(program: &Program, sources: &SourceMap) -> Lowered {
    lower_program(program, sources, Probes::new(Asked::Coverage))
}

/// The part of the image by which names are found, without code: of a program that was bound without errors.
pub fn names_of(program: &Program, sources: &SourceMap) -> ProgramImage {
    let facts = Facts { dbs: Vec::new(), db_end: 0, error_slots: Vec::new(), stops_itself: false };
    let image = Output::new(program, sources, facts, Probes::default(), &mut |_| {}).image;
    let s7200 = program.s7200.map(|cpu| S7200Image { cpu, ..S7200Image::default() });
    ProgramImage { s7200, ..image }
}

fn lower_program(program: &Program, sources: &SourceMap, probes: Probes) -> Lowered {
    let mut functions = EntityVec::new();
    let mut lowered = lower_to(program, sources, probes, &mut |mut function| {
        function.shrink_to_fit();
        functions.push(function);
    });
    lowered.module.functions = functions;
    lowered
}

fn lower_to(program: &Program, sources: &SourceMap, probes: Probes, take: &mut dyn FnMut(Function)) -> Lowered {
    if let Some(cpu) = program.s7200 {
        return s7200::lower(program, cpu, sources, probes, take);
    }
    let plan = Plan::new(program);
    let facts = Facts {
        dbs: plan.dbs.clone(),
        db_end: plan.db_end,
        error_slots: plan.error_slots(),
        stops_itself: plan.stops_itself,
    };
    let mut output = Output::new(program, sources, facts, probes, take);
    output.next_part = (0..program.blocks.len()).filter_map(|index| plan.function(index)).count();
    let is_large = program.blocks.len() > SMALL_BLOCKS_MAX;
    for (index, block) in program.blocks.iter().enumerate() {
        if is_large {
            output.leave_room();
        }
        let function = match &block.body {
            Body::Stl(statements) => Some(stl::lower_block(&plan, &mut output, block, statements)),
            Body::Scl(body) => Some(scl::lower_block(&plan, &mut output, block, body)),
            Body::S7200(_) | Body::Runtime => None,
        };
        if let Some(function) = function {
            let frame = function.frame_bytes;
            let id = output.add(function);
            debug_assert_eq!(Some(id), plan.function(index), "functions are numbered in order of the blocks");
            debug_assert!(
                frame <= plan.frame_estimate(block.key()),
                "the plan has counted what calls put into the frame"
            );
        }
    }
    for part in std::mem::take(&mut output.parts) {
        output.add(part);
    }
    for (index, block) in program.blocks.iter().enumerate() {
        let Some(function) = plan.function(index) else { continue };
        let mut frame = output.frames[function];
        let entry = match block.kind {
            BlockKind::Ob => function,
            _ if plan.has_dynamic_calls => {
                let wrapper = entry::lower_entry(&plan, block, function);
                frame += wrapper.frame_bytes;
                output.add(wrapper)
            }
            _ => {
                output.image.inner_blocks.push((block.kind, block.number, block.name.clone()));
                continue;
            }
        };
        output.image.blocks.push(BlockEntry {
            kind: block.kind,
            number: block.number,
            name: block.name.clone(),
            entry: output.module.entries.len() as u32,
            frame,
            local_data_used: true,
            start_inputs: block.interface.start_inputs.clone(),
        });
        output.module.entries.push(entry);
    }
    output.finish()
}

/// In programs with more blocks than this the numbers of sites leave room between blocks.
const SMALL_BLOCKS_MAX: usize = 50;

/// The sites of a block begin at a multiple of this.
const SITES_OF_BLOCK: usize = 32;

/// The data in the image about the program as a whole.
pub(crate) struct Facts {
    /// DBs with their addresses.
    pub dbs: Vec<StaticDb>,
    pub db_end: u32,
    pub error_slots: Vec<ErrorSlot>,
    pub stops_itself: bool,
}

/// Data that grows while blocks are lowered.
pub(crate) struct Output<'s> {
    /// Without the functions.
    pub module: Module,
    pub image: ProgramImage,
    pub probes: Probes,
    sources: &'s SourceMap,
    /// Takes the functions.
    take: &'s mut dyn FnMut(Function),
    /// Bytes of the frame of each function.
    frames: EntityVec<FuncId, u32>,
    /// Parts of blocks that are functions of their own. Their numbers follow those of all blocks; `next_part` is that of the next one.
    parts: Vec<Function>,
    next_part: usize,
    used: Places,
}

/// See [`ProgramImage::sources_sum`]. The order of the files does not matter.
fn sources_sum(program: &Program, sources: &SourceMap) -> u64 {
    if program.profile.family != Family::S7400 {
        return 0;
    }
    sources.files().fold(0, |all, (_, file)| all.wrapping_add(plcc_abi::loadable::sum(file.text.as_bytes())))
}

impl<'s> Output<'s> {
    fn new(
        program: &Program,
        sources: &'s SourceMap,
        facts: Facts,
        probes: Probes,
        take: &'s mut dyn FnMut(Function),
    ) -> Output<'s> {
        let files: Vec<String> = sources.files().map(|(_, file)| file.name.clone()).collect();
        let place_of = |number| facts.dbs.binary_search_by_key(&number, |db: &StaticDb| db.number).ok();
        let address_of = |number| place_of(number).map_or(facts.db_end, |index| facts.dbs[index].address);
        let sites = probes.sites.clone();
        let profile = &program.profile;
        let areas = Areas { inputs: profile.inputs, outputs: profile.outputs, bit_memory: profile.bit_memory };
        let module = Module { dbs: facts.dbs.clone(), files, sites, areas, ..Module::default() };
        let mut types = Types::default();
        let image = ProgramImage {
            name: program.name.clone(),
            profile: program.profile.clone(),
            config: program.config.clone(),
            blocks: Vec::new(),
            dbs: program
                .dbs
                .iter()
                .map(|db| DbEntry {
                    number: db.number,
                    name: db.name.clone(),
                    address: address_of(db.number),
                    data: db.data.clone(),
                    read_only: db.read_only,
                    unlinked: db.unlinked,
                    optimized: db.optimized,
                    kept: db.kept.clone(),
                    ty: (!db.members.is_empty()).then(|| types.of_db(db, program)),
                })
                .collect(),
            db_end: facts.db_end,
            sites: Vec::new(),
            error_slots: facts.error_slots,
            files: Vec::new(),
            asserts: Vec::new(),
            symbols: types.symbols(program),
            types: types.finish(),
            used: Vec::new(),
            partial: program.partial.clone(),
            stops_itself: facts.stops_itself,
            sources_sum: sources_sum(program, sources),
            shapes: shapes::of(program),
            outputs_used: u32::MAX,
            notices: program.notices.clone(),
            inner_blocks: Vec::new(),
            s7200: None,
        };
        Output {
            module,
            image,
            probes,
            sources,
            take,
            frames: EntityVec::new(),
            parts: Vec::new(),
            next_part: 0,
            used: Places::default(),
        }
    }

    /// A function is complete.
    pub fn add(&mut self, function: Function) -> FuncId {
        self.used.add(&function);
        let id = self.frames.push(function.frame_bytes);
        (self.take)(function);
        id
    }

    /// Makes functions of the parts that begin at these blocks of a function.
    pub fn cut(&mut self, function: &mut Function, starts: &[plcc_ir::Block], variables: u32) {
        let parts = parts::cut(function, starts, variables, self.next_part);
        self.next_part += parts.len();
        self.parts.extend(parts);
    }

    /// Index of the span's file in the image, and its line there. Blocks of the standard library have the spans of their first calls.
    fn place(&self, span: plcc_diag::Span) -> (u32, u32) {
        (span.file.0, self.sources.file(span.file).line(span.start))
    }

    /// Begins the sites of a block at a round number: a few more statements in a block leave those of the blocks after it as they are,
    /// and so their code, which contains these numbers.
    fn leave_room(&mut self) {
        let sites = &mut self.module.sites;
        if let Some(last) = sites.last().cloned() {
            sites.resize((sites.len() + SITES_OF_BLOCK / 4).next_multiple_of(SITES_OF_BLOCK), last);
        }
    }

    /// Number of the site of code of `block` at `span`; a new one if it differs from the last.
    pub fn site(&mut self, block: &CodeBlock, span: plcc_diag::Span, network: u16) -> u32 {
        let (file, line) = self.place(span);
        let site = Site { file, line, block: block.kind, block_number: block.number, network };
        let sites = &mut self.module.sites;
        if sites.last() != Some(&site) {
            sites.push(site);
        }
        sites.len() as u32 - 1
    }

    /// Enters an assertion in the program's list; returns its number there.
    pub fn register_assert<S>(&mut self, assert: &Assert<S>, span: plcc_diag::Span) -> u32 {
        let (file, line) = self.place(span);
        let asserts = &mut self.image.asserts;
        asserts.push(AssertEntry {
            file,
            line,
            text: assert.text.clone(),
            condition: assert.condition.clone(),
            comparisons: assert.comparisons.iter().map(assertion::compared).collect(),
            trap: assert.trap,
        });
        asserts.len() as u32 - 1
    }

    fn finish(mut self) -> Lowered {
        self.image.used = self.used.finish(self.image.profile.family);
        self.image.files = self.module.files.clone();
        self.image.sites = self.module.sites.clone();
        Lowered { module: self.module, image: self.image, probes: self.probes.places.unwrap_or_default() }
    }
}
