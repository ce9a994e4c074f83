//! The stages of a compilation: read, parse, bind, lower, optimise, generate code. Each stage is one function, from one type to another.
//!
//! - [`cpu`]: the CPU that a program is for.
//! - [`consequences`]: messages that only follow from others.
//! - [`optimization`]: how code is made of the IR.
//! - [`object_file`]: the last stage, with the cache.

mod consequences;
mod cpu;
mod object_file;
mod optimization;

pub use object_file::{object, objects};
pub use optimization::Optimization;

use std::path::Path;

use plcc_abi::image::{BlockKind, Config, ProgramImage};
use plcc_binding::BindInput;
use plcc_codegen::CodegenOptions;
use plcc_diag::{Code, Diagnostic, FileId, Severity, SourceFile, SourceMap, Span};
use plcc_ir::Module;
use plcc_ir::entities::Entity;
use plcc_model::Program;
use plcc_opt::Usage;
use plcc_readers::ReadOptions;
use plcc_readers::sd::Texts;
use plcc_readers::symbols;
use plcc_syntax::Language;
use plcc_syntax::ast::{Block, SourceUnit, StatementKind};
use plcc_syntax::stl::{Mnemonics, StlInsn};
use plcc_syntax::symbols::SymbolTable;
use rustc_hash::FxHashSet;

use consequences::{forget_absent, forget_doubtful, forget_lost, forget_not_connected, forget_other_ends};
use cpu::{check_pragmas, order_of, pragma_profile, profile_of};

use crate::axes;
use crate::beginning;
use crate::cli::{CompileArgs, CpuFeatures, Deny, Level};
use crate::cpu_settings;
use crate::inputs::Read;
use crate::parallel;
use crate::project::{self, Project};
use crate::s7200;
use crate::technology;

/// Settings of the stages up to the bound program.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    pub cpu: Option<String>,
    pub mnemonics: Option<Mnemonics>,
    /// `//@` lines are applied.
    pub pragmas: bool,
    /// A missing definition is a warning, and a stand-in replaces it.
    pub partial: bool,
    /// A program without OB 1 is an error.
    pub require_main: bool,
    /// Blocks of safety programs are standard blocks.
    pub safety_as_standard: bool,
    /// A program with a warning is refused.
    pub deny_warnings: bool,
    /// Charts become statements for other notations.
    pub plain_charts: bool,
}

impl Settings {
    /// As the command line says.
    pub fn new(args: &CompileArgs) -> Settings {
        Settings {
            cpu: args.cpu.clone(),
            mnemonics: args.mnemonics.map(Mnemonics::from),
            safety_as_standard: args.safety_as_standard,
            partial: args.partial,
            deny_warnings: args.deny == Some(Deny::Warnings),
            ..Settings::default()
        }
    }

    /// Whether the command line or the project allows missing parts.
    pub fn is_partial(&self, project: Option<&Project>) -> bool {
        self.partial || project.is_some_and(|project| project.partial)
    }

    fn parse_options(&self, project: Option<&Project>) -> ReadOptions<'static> {
        let mnemonics = self.mnemonics.or_else(|| project.and_then(|project| project.mnemonics));
        ReadOptions { mnemonics, pragmas: self.pragmas, language: None, texts: None }
    }
}

/// A program whose sources are parsed.
pub struct Parsed {
    pub name: String,
    pub sources: SourceMap,
    pub units: Vec<(FileId, SourceUnit)>,
    pub tables: Vec<SymbolTable>,
    pub project: Option<Project>,
    pub diagnostics: Vec<Diagnostic>,
}

/// A program with resolved names, types and addresses.
pub struct Bound {
    pub sources: SourceMap,
    pub program: Program,
    pub diagnostics: Vec<Diagnostic>,
}

impl Bound {
    /// True if the program cannot be compiled.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(Diagnostic::is_error)
    }

    /// True if the settings refuse a program that could be compiled.
    pub fn is_denied(&self, settings: &Settings) -> bool {
        settings.deny_warnings && !self.diagnostics.is_empty()
    }
}

/// A program as IR, with its description for the runtime.
#[derive(Clone)]
pub struct Compiled {
    pub module: Module,
    pub image: ProgramImage,
    pub optimization: Optimization,
    /// The first passes have run.
    begun: bool,
}

/// Sources of fewer bytes are parsed before a thread has started.
const SHARED_BYTES_MIN: usize = 100_000;

/// Parses all sources and symbol tables.
pub fn parse(read: Read, settings: &Settings) -> Parsed {
    let Read { name, sources, units, tables, texts, project, mut diagnostics, .. } = read;
    let options = settings.parse_options(project.as_ref());
    let parse_with = |file: FileId, mnemonics: Option<Mnemonics>| {
        let source = sources.file(file);
        let mut diagnostics = Vec::new();
        let texts = texts.iter().find(|(unit, _)| *unit == file).map(|&(_, texts)| {
            let (texts, messages) = Texts::parse(texts, &sources.file(texts).text);
            diagnostics.extend(messages);
            texts
        });
        let options = ReadOptions { mnemonics, language: language_of(&source.name), texts: texts.as_ref(), ..options };
        let (unit, messages) = plcc_readers::parse(file, &source.text, &options);
        diagnostics.extend(messages);
        ((file, unit), diagnostics)
    };
    let parse_unit = |&file: &FileId| parse_with(file, options.mnemonics);
    let bytes: usize = units.iter().map(|&file| sources.file(file).text.len()).sum();
    let mut parsed: Vec<((FileId, SourceUnit), Vec<Diagnostic>)> = match bytes < SHARED_BYTES_MIN {
        true => units.iter().map(parse_unit).collect(),
        false => parallel::map(&units, parse_unit),
    };
    if is_german(parsed.iter().map(|((_, unit), _)| unit)) {
        for entry in &mut parsed {
            let (file, unit) = &entry.0;
            if unit.shows_mnemonics == Some(false) {
                *entry = parse_with(*file, Some(Mnemonics::De));
            }
        }
    }
    let (units, messages): (Vec<_>, Vec<_>) = parsed.into_iter().unzip();
    diagnostics.extend(messages.into_iter().flatten());
    diagnostics.extend(doubtful_timers(&units));
    let mut parse_table = |file| {
        let (table, messages) = symbols::parse(file, sources.file(file));
        diagnostics.extend(messages);
        table
    };
    let tables = tables.into_iter().map(&mut parse_table).collect();
    Parsed { name, sources, units, tables, project, diagnostics }
}

/// Whether the sources that show their mnemonic set show the German one. Those that do not, with nothing but `SE`, `S` and `=`, are then
/// German too.
fn is_german<'a>(units: impl Iterator<Item = &'a SourceUnit>) -> bool {
    let mut counts = [0usize; 2];
    for unit in units.filter(|unit| unit.shows_mnemonics == Some(true)) {
        counts[unit.mnemonics as usize] += 1;
    }
    counts[Mnemonics::De as usize] > counts[Mnemonics::En as usize]
}

/// Warns of `SE` where no source shows its mnemonics: it starts a timer in both sets, but not the same one.
fn doubtful_timers(units: &[(FileId, SourceUnit)]) -> Vec<Diagnostic> {
    if units.iter().any(|(_, unit)| unit.shows_mnemonics == Some(true)) {
        return Vec::new();
    }
    let first = |unit: &SourceUnit| {
        let networks =
            unit.blocks.iter().flat_map(|block| if let Block::Code(code) = block { code.networks() } else { &[] });
        networks.flat_map(|network| &network.statements).find_map(|statement| {
            let StatementKind::Instruction { insn: StlInsn::TimerExtendedPulse, mnemonic_span, .. } = &statement.kind
            else {
                return None;
            };
            Some(*mnemonic_span)
        })
    };
    let doubtful = units.iter().filter(|(_, unit)| unit.shows_mnemonics == Some(false));
    let message = |span| {
        let title = "no source shows its mnemonics, and `SE` is in both sets";
        let help = "write `mnemonics = \"en\"` into plc.toml if that is right, or `\"de\"`, where `SE` is an on-delay, the international `SD`; `--mnemonics` does the same";
        Diagnostic::new(Code::Tolerated, span, title)
            .label("read as the international one, an extended pulse")
            .help(help)
    };
    doubtful.filter_map(|(_, unit)| first(unit)).map(message).collect()
}

/// The language that the name of a file implies.
pub fn language_of(name: &str) -> Option<Language> {
    Path::new(name).extension().and_then(|extension| Language::of_extension(&extension.to_string_lossy()))
}

/// Says which symbol tables a project leaves out, where it has symbols that nothing defines.
fn name_tables(diagnostics: &mut [Diagnostic], tables: &[String]) {
    const SHOWN_MAX: usize = 5;
    if tables.is_empty() {
        return;
    }
    let names: Vec<String> = tables.iter().take(SHOWN_MAX).map(|name| format!("\"{name}\"")).collect();
    let help = format!("write `symbols = [{}]` into plc.toml, which names no symbol table", names.join(", "));
    for message in diagnostics.iter_mut().filter(|message| message.code == Code::UnknownSymbol) {
        if message.help.as_ref().is_some_and(|help| help.contains("add the symbol table of the project")) {
            message.help = Some(help.clone());
        }
    }
}

/// Resolves names, types and addresses.
pub fn bind(parsed: Parsed, settings: &Settings) -> Bound {
    let Parsed { name, mut sources, units, tables, project, mut diagnostics } = parsed;
    check_pragmas(settings, &units, &mut diagnostics);
    let profile = match pragma_profile(settings, &units) {
        Some(profile) => profile,
        None => profile_of(settings, project.as_ref(), &units, &mut sources, &mut diagnostics),
    };
    // Nothing is known of a CPU that was refused.
    let is_known = diagnostics.iter().all(|message| message.code != Code::UnknownCpu);
    if let Some(project) = project.as_ref().filter(|_| is_known) {
        diagnostics.extend(technology::check(&project.technology, &profile));
        diagnostics.extend(cpu_settings::check(&project.of_cpu, &profile));
        diagnostics.extend(s7200::check(project.s7200, &profile));
        diagnostics.extend(project::check_hot(project.hot, &profile));
    }
    let partial = settings.is_partial(project.as_ref()) || pragma_partial(settings, &units);
    if partial {
        // Unfinished networks, which binding leaves out.
        let drafts = diagnostics.iter_mut().filter(|message| plcc_program::is_about_drafts(message.code));
        let networks = drafts.filter(|message| matches!(message.code, Code::NoSource | Code::OpenBranch));
        networks.for_each(|message| message.severity = Severity::Warning);
    }
    let has_station = project.as_ref().is_some_and(|project| project.station.is_some());
    let names = project.as_ref().map(|project| project.names.clone()).unwrap_or_default();
    let tables_beside = project.as_ref().map(|project| project.tables_beside.clone()).unwrap_or_default();
    let of_cpu = project.as_ref().map(|project| project.of_cpu.clone()).unwrap_or_default();
    let axis_names = project.as_ref().map(|project| project.axis_names.clone()).unwrap_or_default();
    let named_obs = project.as_ref().map(|project| project.named_obs.clone()).unwrap_or_default();
    let cpu_order = order_of(settings, project.as_ref(), &profile);
    let input = BindInput {
        name,
        sources: &sources,
        units: &units,
        tables: &tables,
        profile,
        safety_as_standard: settings.safety_as_standard
            || project.as_ref().is_some_and(|project| project.safety_as_standard),
        plain_charts: settings.plain_charts,
        config: Config { cpu_order, ..project.map(|project| project.config).unwrap_or_default() },
        partial,
        stand_ins: None,
        pragmas: settings.pragmas,
        // Without a source there is already another message.
        require_main: settings.require_main && !units.is_empty(),
    };
    let (mut program, messages, stand_ins) = resolve(&input);
    diagnostics.extend(messages);
    // Stand-ins need places like everything else.
    if let Some(text) = stand_ins {
        sources.add(SourceFile::new(STAND_INS, text));
    }
    // The addresses of a station that cannot be built say nothing.
    if has_station && diagnostics.iter().all(|message| message.code != Code::Station) {
        diagnostics.extend(plcc_program::check_modules(&program));
    }
    // Names of a program with errors may be missing because of these, those of a part of one because they are in the rest.
    if !names.is_empty() && !partial && diagnostics.iter().all(|message| message.severity != Severity::Error) {
        diagnostics.extend(names.check(&plcc_lower::names_of(&program, &sources)));
        diagnostics.extend(names.check_blocks(|number| program.db(number).is_some()));
    }
    let is_whole = !partial && diagnostics.iter().all(|message| message.severity != Severity::Error);
    if is_whole {
        diagnostics.extend(cpu_settings::without_block(&of_cpu, &program));
    }
    diagnostics.extend(project::set_named(&named_obs, &of_cpu, is_whole, &mut program));
    name_tables(&mut diagnostics, &tables_beside);
    axes::show_headings(&mut diagnostics, &axis_names, &sources);
    tidy(&mut diagnostics, &sources);
    Bound { sources, program, diagnostics }
}

/// The program of the sources, with its messages. With missing parts: also the text of the file of their stand-ins.
fn resolve(input: &BindInput) -> (Program, Vec<Diagnostic>, Option<String>) {
    // Programs of the S7-200 share nothing with those of the other families.
    let is_s7200 = plcc_program::is_s7200(input.units);
    if input.partial {
        let completed = match is_s7200 {
            true => plcc_program_s7200::complete(input),
            false => plcc_program::complete(input),
        };
        return (completed.program, completed.diagnostics, Some(completed.stand_ins));
    }
    let (program, messages) = match is_s7200 {
        true => plcc_program_s7200::bind(input),
        false => plcc_program::bind(input),
    };
    (program, messages, None)
}

/// Sorts messages, and leaves out those that say what others say, too.
fn tidy(diagnostics: &mut Vec<Diagnostic>, sources: &SourceMap) {
    // A use of a symbol shows the row that cannot be read.
    let shown: FxHashSet<Span> = diagnostics
        .iter()
        .filter(|message| message.code == Code::UnknownSymbol)
        .flat_map(|message| message.secondary.iter().map(|label| label.span))
        .collect();
    diagnostics.retain(|message| message.code != Code::SymbolTable || !shown.contains(&message.primary.span));
    forget_doubtful(diagnostics);
    forget_absent(diagnostics);
    forget_not_connected(diagnostics);
    forget_lost(diagnostics, sources);
    forget_other_ends(diagnostics);
    plcc_diag::sort(diagnostics);
    // Two stages may find the same fault; report it once.
    diagnostics.dedup_by_key(|d| (d.code, d.primary.span));
}

/// Name of the file in which stand-ins for missing parts have their places.
const STAND_INS: &str = "stand-ins of --partial";

/// A test file may allow missing parts.
fn pragma_partial(settings: &Settings, units: &[(FileId, SourceUnit)]) -> bool {
    let mut pragmas = units.iter().flat_map(|(_, unit)| &unit.pragmas);
    let words = |text: &str| {
        let mut words = text.split_whitespace();
        words.next() == Some("test") && words.any(|word| word == "partial")
    };
    settings.pragmas && pragmas.any(|pragma| words(&pragma.text))
}

/// Parses and binds.
pub fn front(read: Read, settings: &Settings) -> Bound {
    bind(parse(read, settings), settings)
}

/// The IR of a program without errors.
pub fn lower(bound: &Bound, optimization: impl Into<Optimization>) -> Compiled {
    let lowered = plcc_lower::lower(&bound.program, &bound.sources);
    Compiled { module: lowered.module, image: lowered.image, optimization: optimization.into(), begun: false }
}

/// As [`lower`], for [`object`]: at -O2 the first passes have run, which takes less memory.
pub fn lower_begun(bound: &Bound, optimization: impl Into<Optimization>) -> Compiled {
    let optimization = optimization.into();
    if optimization.level == Level::O0 {
        return lower(bound, optimization);
    }
    let lowered = beginning::lower(&bound.program, &bound.sources, optimization.without);
    Compiled { module: lowered.module, image: lowered.image, optimization, begun: true }
}

/// The IR of a program without errors, with probes that tell what its statements see, and their places.
pub fn lower_with_probes(
    bound: &Bound,
    optimization: impl Into<Optimization>,
) -> (Compiled, Vec<plcc_lower::probe::Place>) {
    let lowered = plcc_lower::lower_with_probes(&bound.program, &bound.sources);
    (
        Compiled { module: lowered.module, image: lowered.image, optimization: optimization.into(), begun: false },
        lowered.probes,
    )
}

/// The IR of the same program with probes, which shares the image of `plain` and runs in turn with it. The image then has the places of the
/// probes.
pub fn lower_beside(bound: &Bound, plain: &mut Compiled) -> Compiled {
    let lowered = plcc_lower::lower_beside(&bound.program, &bound.sources, &plain.module);
    let mut probed =
        Compiled { module: lowered.module, image: lowered.image, optimization: plain.optimization, begun: false };
    plain.image.config.services.probes = Some(plcc_status::probes::of(&bound.program, &lowered.probes));
    // What is not about the code itself is in the image of the other one.
    let image = &mut probed.image;
    plain.image.sites = std::mem::take(&mut image.sites);
    *image = ProgramImage {
        config: Config::default(),
        dbs: Vec::new(),
        error_slots: Vec::new(),
        files: Vec::new(),
        asserts: Vec::new(),
        symbols: Vec::new(),
        types: Vec::new(),
        used: Vec::new(),
        partial: Vec::new(),
        shapes: Vec::new(),
        notices: Vec::new(),
        inner_blocks: Vec::new(),
        ..std::mem::replace(image, plain.image.clone())
    };
    probed
}

/// The IR of a program without errors, with a probe before each statement, and their places.
pub fn lower_for_debugger(bound: &Bound) -> (Compiled, Vec<plcc_lower::probe::Place>) {
    let lowered = plcc_lower::lower_for_debugger(&bound.program, &bound.sources);
    (
        Compiled { module: lowered.module, image: lowered.image, optimization: Level::O0.into(), begun: false },
        lowered.probes,
    )
}

/// The IR of a program without errors, with probes that tell which parts of it run, and their places.
pub fn lower_for_coverage(
    bound: &Bound,
    optimization: impl Into<Optimization>,
) -> (Compiled, Vec<plcc_lower::probe::Place>) {
    let lowered = plcc_lower::lower_for_coverage(&bound.program, &bound.sources);
    (
        Compiled { module: lowered.module, image: lowered.image, optimization: optimization.into(), begun: false },
        lowered.probes,
    )
}

/// Runs the passes of plcc, at -O2.
pub fn optimize(mut compiled: Compiled) -> Compiled {
    match (compiled.optimization.level, compiled.begun) {
        (Level::O0, _) => {}
        (Level::O2, false) => plcc_opt::optimize(&mut compiled.module, compiled.optimization.without),
        (Level::O2, true) => plcc_opt::optimize_begun(&mut compiled.module, compiled.optimization.without),
    }
    let usage = plcc_opt::usage(&compiled.module);
    let reached = compiled.reached();
    compiled.with_usage(&usage, &reached)
}

/// Lowers and optimises.
pub fn back(bound: &Bound, optimization: impl Into<Optimization>) -> Compiled {
    optimize(lower_begun(bound, optimization))
}

impl Compiled {
    /// Which functions can run: those that the runtime starts by itself, and what they call.
    fn reached(&self) -> Vec<bool> {
        let is_called = |kind| matches!(kind, BlockKind::Fc | BlockKind::Fb | BlockKind::Sfc | BlockKind::Sfb);
        let roots = self.image.blocks.iter().filter(|block| !is_called(block.kind));
        plcc_opt::reached(
            &self.module,
            roots.filter_map(|block| self.module.entries.get(block.entry as usize).copied()),
        )
    }

    /// Tells the runtime what each function of the program uses.
    fn with_usage(mut self, functions: &[Usage], reached: &[bool]) -> Compiled {
        let used = functions.iter().zip(reached).filter_map(|(usage, reached)| reached.then_some(*usage));
        let usage = used.fold(Usage::NOTHING, Usage::and);
        self.image.outputs_used = usage.outputs;
        for block in &mut self.image.blocks {
            let entry = self.module.entries.get(block.entry as usize);
            let first = entry.map_or(0, |entry| functions[entry.index()].local_data);
            // The code itself clears what is after the start information and the inputs.
            let is_only_information = self.image.s7200.is_none() && block.start_inputs.is_empty();
            let end = if is_only_information { plcc_runtime::events::START_INFO_BYTES as u32 } else { u32::MAX };
            block.local_data_used = first < end;
        }
        if let Some(own) = &mut self.image.s7200 {
            own.logic_only = usage.logic_only;
        }
        self
    }

    /// Makes the image serve other code of the same program too, whose image is `other`; see [`lower_beside`].
    pub fn share_image(&mut self, other: &ProgramImage) {
        let image = &mut self.image;
        image.outputs_used = image.outputs_used.max(other.outputs_used);
        for (block, same) in image.blocks.iter_mut().zip(&other.blocks) {
            debug_assert_eq!((block.kind, block.number, block.entry), (same.kind, same.number, same.entry));
            block.frame = block.frame.max(same.frame);
            block.local_data_used |= same.local_data_used;
        }
        if let (Some(own), Some(other)) = (&mut image.s7200, &other.s7200) {
            own.logic_only &= other.logic_only;
        }
    }

    pub fn codegen_options(&self) -> CodegenOptions {
        CodegenOptions {
            optimize: self.optimization.level == Level::O2,
            native: self.optimization.cpu_features == CpuFeatures::Native,
            ..CodegenOptions::default()
        }
    }

    /// The image as it is in an executable.
    pub fn image_bytes(&self) -> Vec<u8> {
        postcard::to_stdvec(&self.image).expect("an image is plain data, which postcard can hold")
    }
}
