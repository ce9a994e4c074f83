//! `plcc convert`: sources in another form.
//!
//! - [`notation`]: each in another notation; [`whole`]: programs as one document; [`addresses`]: with symbols or addresses.
//! - [`migration`]: what another CPU has of them.
//! - [`companions`]: what a folder of sources needs besides them; [`languages`]: texts that are lost; [`without_stl`]: programs for an S7-1200
//!   as STL; [`output`]: the files that are written.

mod addresses;
mod asserted;
mod companions;
mod languages;
mod migration;
mod notation;
mod output;
pub mod whole;
mod without_stl;

use std::path::Path;

use plcc_convert::addresses::To;
use plcc_diag::Diagnostic;
use plcc_model::profile;
use plcc_readers::simatic_ml::{self, Remarks};
use plcc_readers::xml::XmlKind;
use plcc_syntax::ast::{Block, BlockName, BlockPrefix, Code, CodeKind, SourceUnit};
use plcc_syntax::{scl, stl};

use output::store;

use super::exit;
use crate::cli::{ConvertArgs, ConvertTo};
use crate::{inputs, pipeline, report};

/// A source in its new notation.
struct Converted {
    /// Of the file that it is made of.
    name: String,
    text: String,
    /// What is in files of their own.
    beside: Vec<Beside>,
}

/// A second file that belongs to a source.
struct Beside {
    extension: &'static str,
    text: String,
    /// What it has, for the message about standard output.
    what: &'static str,
}

/// Titles and comments of SIMATIC SD.
fn texts_beside(text: String) -> Beside {
    Beside { extension: "s7res", text, what: "titles and comments are" }
}

/// Writes each source as the command line says, or the report of a migration. Returns 3 if one has an error or cannot be converted; then
/// nothing is written.
pub fn convert(args: &ConvertArgs) -> u8 {
    if args.partial && args.report.is_none() {
        report::say("--partial is for --report: leave it out");
        return exit::USAGE;
    }
    match (args.to, &args.report) {
        (Some(ConvertTo::Plcopen), _) => whole::plcopen(args),
        (Some(to), _) => notation::notation(args, to),
        (None, Some(family)) => migration::report(args, family),
        (None, None) => addresses::write(args, if args.absolute { To::Absolute } else { To::Symbolic }),
    }
}

/// Gives statements without a header the block that the name of their file states, `FC19_Count.awl`. Only statement lists are written
/// without headers.
fn name_by_files(parsed: &mut pipeline::Parsed) {
    for (file, unit) in &mut parsed.units {
        let name = &parsed.sources.file(*file).name;
        let stem = Path::new(name).file_stem().unwrap_or_default().to_string_lossy();
        let Some((prefix, number)) = plcc_program::block_of_file(&stem) else { continue };
        for block in &mut unit.blocks {
            if let Block::Code(code) = block
                && let BlockName::Numbered { prefix: BlockPrefix::Ob, number: 1, span } = code.name
                && span.start == span.end
            {
                code.kind = match prefix {
                    BlockPrefix::Fc => CodeKind::Fc,
                    BlockPrefix::Fb => CodeKind::Fb,
                    BlockPrefix::Ob
                    | BlockPrefix::Sfc
                    | BlockPrefix::Sfb
                    | BlockPrefix::Db
                    | BlockPrefix::Di
                    | BlockPrefix::Udt
                    | BlockPrefix::Vat => CodeKind::Ob,
                };
                code.name = BlockName::Numbered { prefix, number, span };
            }
        }
    }
}

/// Programs of the S7-200 and those of the other families share no notation.
fn other_family(unit: &SourceUnit, to: ConvertTo) -> Diagnostic {
    let Some(s7200) = &unit.s7200 else {
        let span = unit.blocks.first().map(Block::span).unwrap_or_default();
        return Diagnostic::new(
            plcc_diag::Code::NotConverted,
            span,
            "only sources of the S7-200 are written for Micro/WIN",
        )
        .label("a block of the S7-300/400/1200/1500")
        .help("write it with `--to stl`");
    };
    let span = s7200.blocks.first().map(|block| block.span).unwrap_or_default();
    let help = match to {
        ConvertTo::Lad | ConvertTo::Fbd => {
            "Micro/WIN keeps LAD and FBD as these statements, so there is no other file; `plcc view` draws them"
        }
        ConvertTo::Stl
        | ConvertTo::Sd
        | ConvertTo::Scl
        | ConvertTo::Gr7
        | ConvertTo::Xml
        | ConvertTo::Plcopen
        | ConvertTo::Awl => "write it with `--to awl`; `--report s7-1200` says what carries over to an S7-1200",
    };
    Diagnostic::new(plcc_diag::Code::NotConverted, span, "a source of the S7-200 cannot be converted")
        .label("STL of the S7-200")
        .help(help)
}

/// How the sources are bound: for the CPU of the command line, of the project or of a pragma; else for `default`.
fn binding(args: &ConvertArgs, parsed: &pipeline::Parsed, default: Option<&str>) -> pipeline::Settings {
    let has_cpu = parsed.project.as_ref().is_some_and(|project| project.cpu.is_some());
    let told = companions::cpu_of_pragmas(parsed).filter(|name| profile::lookup(name).is_some());
    let named = told.or(default).filter(|_| !has_cpu).map(str::to_string);
    let plain_charts = args.to == Some(ConvertTo::Stl);
    pipeline::Settings { cpu: args.cpu.clone().or(named), plain_charts, ..pipeline::Settings::default() }
}

/// The program of the sources; an exit code after messages. `default`: see [`binding`].
fn bound(args: &ConvertArgs, parsed: &pipeline::Parsed, default: Option<&str>) -> Result<pipeline::Bound, u8> {
    let settings = binding(args, parsed, default);
    let mut bound = pipeline::front(inputs::read_as(&args.inputs, args.code_page), &settings);
    if !bound.has_errors() {
        return Ok(bound);
    }
    bound.diagnostics.retain(Diagnostic::is_error);
    report::messages(&mut bound.diagnostics, &bound.sources);
    report::say(&report::summary(&bound.diagnostics));
    Err(exit::COMPILE)
}

/// Whether a source has such a block.
fn has(unit: &SourceUnit, is_such: impl Fn(&Code) -> bool) -> bool {
    unit.blocks.iter().any(|block| matches!(block, Block::Code(block) if is_such(&block.code)))
}

/// The comments of a source, and the text in which they are; none if they are in its tree.
fn remarks(unit: &SourceUnit, source: &str) -> Option<Remarks> {
    let is_chart = has(unit, |code| matches!(code, Code::Chart(_)));
    match plcc_readers::xml::kind(source) {
        None => {
            let comments = match is_chart {
                true => plcc_readers::gr7::comments(source),
                false if has(unit, |code| matches!(code, Code::Stl(_))) => stl::comments(source),
                false => scl::comments_and_regions(source),
            };
            Some(Remarks { text: source.to_string(), comments })
        }
        Some(XmlKind::SimaticMl(_)) if !is_chart => Some(simatic_ml::remarks(source, unit.overlay.as_deref()?)),
        Some(_) => None,
    }
}

/// Blocks of an export up to the next one: the place of such a block is its start tag, and its comments come after that.
fn whole_blocks(unit: &SourceUnit, end: u32) -> SourceUnit {
    let mut unit = unit.clone();
    let mut starts: Vec<u32> = unit.blocks.iter().map(|block| block.span().start).collect();
    starts.sort_unstable();
    for block in &mut unit.blocks {
        if let Block::Code(code) = block {
            let next = starts.partition_point(|start| *start <= code.span.start);
            code.span.end = starts.get(next).copied().unwrap_or(end);
        }
    }
    unit
}
