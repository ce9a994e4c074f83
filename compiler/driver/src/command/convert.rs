//! `plcc convert`: sources in another notation. [`addresses`]: with symbols or addresses; [`migration`]: what another CPU has of them;
//! [`whole`]: programs as one document; [`companions`]: what a folder of sources needs besides them; [`languages`]: texts that are lost;
//! [`without_stl`]: programs for an S7-1200 as STL; [`output`]: the files that are written.

mod addresses;
mod asserted;
mod companions;
mod languages;
mod migration;
mod output;
pub mod whole;
mod without_stl;

use std::path::Path;

use plcc_abi::image::Family;
use plcc_convert::addresses::To;
use plcc_convert::element_values::Components;
use plcc_convert::own_types::{OwnTypes, is_written_out};
use plcc_convert::scl::Others;
use plcc_convert::to_stl::{self, types::Types};
use plcc_convert::trivia::Trivia;
use plcc_convert::{from_scl, sd, to_graph, xml};
use plcc_diag::{Diagnostic, FileId, SourceFile};
use plcc_model::profile;
use plcc_readers::plcopen;
use plcc_readers::simatic_ml::{self, Remarks};
use plcc_readers::xml::XmlKind;
use plcc_syntax::ast::{Block, BlockName, BlockPrefix, Code, CodeKind, SourceUnit};
use plcc_syntax::network::ast::Language as Graphic;
use plcc_syntax::stl::{self, Mnemonics};
use plcc_syntax::symbols::SymbolTable;
use plcc_syntax::{ParseOptions, ast_text, scl};

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

/// The variables with addresses that a source declares itself: those of a project in PLCopen XML, and tag tables among exported blocks.
fn tags_beside(file: FileId, source: &str, tables: &[SymbolTable]) -> (Option<Beside>, Vec<Diagnostic>) {
    const WHAT: &str = "names and addresses of variables are";
    if plcopen::is_project(source) {
        let (text, found) = plcc_convert::symbols::write(file, tables);
        return (text.map(|text| Beside { extension: "sdf", text, what: WHAT }), found);
    }
    let text = plcc_readers::xml::tag_tables(source);
    (text.map(|text| Beside { extension: "tags.xml", text, what: WHAT }), Vec::new())
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
        (Some(to), _) => notation(args, to),
        (None, Some(family)) => migration::report(args, family),
        (None, None) => addresses::write(args, if args.absolute { To::Absolute } else { To::Symbolic }),
    }
}

/// Writes each source in another notation.
fn notation(args: &ConvertArgs, to: ConvertTo) -> u8 {
    let read = inputs::read_as(&args.inputs, args.code_page);
    let unreadable = read.is_unreadable();
    let tables = companions::tables(&read);
    let texts = read.texts.clone();
    let mut parsed = pipeline::parse(read, &pipeline::Settings::default());
    if to != ConvertTo::Stl {
        name_by_files(&mut parsed);
    }
    let mut messages = std::mem::take(&mut parsed.diagnostics);
    // What only warns about the source stays as it is.
    messages.retain(Diagnostic::is_error);
    let mut own_types = OwnTypes::new(parsed.units.iter().map(|(_, unit)| unit));
    if to == ConvertTo::Xml {
        own_types = own_types.with_aliases(parsed.units.iter().map(|(_, unit)| unit));
    }
    let components = Components::new(parsed.units.iter().map(|(_, unit)| unit));
    for (id, unit) in &mut parsed.units {
        if has_quoted_types(to, unit, parsed.sources.file(*id)) {
            own_types.settle(unit);
        }
        if matches!(to, ConvertTo::Scl | ConvertTo::Sd | ConvertTo::Lad | ConvertTo::Fbd) && unit.overlay.is_some() {
            components.list_elements(unit);
        }
    }
    let mut files = Vec::new();
    let told = companions::cpu_of_pragmas(&parsed).filter(|name| profile::lookup(name).is_some());
    let default = cpu_for_stl(&parsed);
    let program = match messages.is_empty() && has_scl_for_stl(to, &parsed) {
        true => match bound(args, &parsed, default) {
            Ok(bound) => Some(bound.program),
            Err(code) => return code,
        },
        false => None,
    };
    let project = parsed.project.as_ref().and_then(|project| project.cpu.as_ref());
    let cpu = args.cpu.as_deref().or(project.map(|(name, _)| name.as_str())).or(told);
    // What nobody names, the statements do.
    let usual = default.filter(|default| cpu.is_none() && program.is_some() && *default == without_stl::USUAL);
    let cpu = cpu.or(usual);
    if messages.is_empty() {
        let types = Types::new(parsed.units.iter().map(|(_, unit)| unit), &parsed.tables);
        let mut library = xml::Library::with_symbols(parsed.units.iter().map(|(_, unit)| unit), &parsed.tables);
        if to == ConvertTo::Xml {
            library.add_system(plcc_program::system_members);
        }
        let named = cpu.and_then(profile::lookup);
        let is_named = named.is_some();
        let profile = named.unwrap_or_else(|| plcc_program::implied_profile(&parsed.units));
        let family = profile.family;
        // If no CPU is named, limits are checked where the sources need an S7-300.
        let keeps_br = (is_named || profile.limits_checked) && matches!(family, Family::S7300 | Family::S7400);
        let types = types.with_instructions(plcc_program::instruction_pins).for_portal(family.is_portal());
        let types = types.with_library(parsed.units.iter().map(|(_, unit)| unit), plcc_program::library_code);
        for (id, unit) in &parsed.units {
            let source = parsed.sources.file(*id);
            if companions::is_made(&source.name) {
                continue;
            }
            let is_awl = to == ConvertTo::Awl;
            if let Some(s7200) = &unit.s7200
                && is_awl
            {
                let set = args.mnemonics.map_or(unit.mnemonics, Mnemonics::from);
                let text = plcc_convert::addresses::apply(&source.text, &plcc_convert::awl::edits(s7200, set));
                files.push(Converted { name: source.name.clone(), text, beside: Vec::new() });
                continue;
            }
            if is_awl || unit.s7200.is_some() {
                messages.push(other_family(unit, to));
                continue;
            }
            let (made, found) = match to {
                ConvertTo::Stl => {
                    let misplaced = to_stl::instances::of_unit(unit, &types);
                    let (listed, mut found) = match &program {
                        // The calls of such instances need no message of their own.
                        _ if !misplaced.is_empty() => (unit.clone(), misplaced),
                        Some(program) => {
                            let Remarks { text, comments } = remarks(unit, &source.text).unwrap_or_else(|| {
                                let meaning = unit.overlay.as_deref().unwrap_or(&source.text);
                                let comments = match plcopen::is_project(&source.text) {
                                    true => plcopen::comments_and_pragmas(&source.text, meaning),
                                    false => Vec::new(),
                                };
                                Remarks { text: meaning.to_string(), comments }
                            });
                            from_scl::unit(
                                unit,
                                program,
                                (text.as_str(), comments.as_slice()),
                                plcc_program::with_chart_data,
                            )
                        }
                        None => (unit.clone(), Vec::new()),
                    };
                    let (made, more) = to_stl::unit(&listed, &types, keeps_br);
                    found.extend(more);
                    (made, found)
                }
                ConvertTo::Lad => to_graph::unit(unit, &types, Graphic::Lad),
                ConvertTo::Fbd => to_graph::unit(unit, &types, Graphic::Fbd),
                ConvertTo::Sd if family.is_portal() => (sd::of_portal(unit), Vec::new()),
                ConvertTo::Sd
                | ConvertTo::Scl
                | ConvertTo::Gr7
                | ConvertTo::Xml
                | ConvertTo::Plcopen
                | ConvertTo::Awl => (unit.clone(), Vec::new()),
            };
            let refused = found.iter().any(Diagnostic::is_error);
            messages.extend(found);
            if !refused {
                let (file, found) = written((args, to), *id, (unit, &made), &library, source);
                messages.extend(found);
                if to == ConvertTo::Xml && parsed.units.len() > 1 && has_only_names(unit) {
                    continue;
                }
                if matches!(to, ConvertTo::Lad | ConvertTo::Fbd) && has(unit, |code| matches!(code, Code::Stl(_))) {
                    messages.extend(asserted::of_registers(*id, &source.text, unit.mnemonics));
                }
                messages.extend(languages::of_export(*id, &source.text));
                let (tags, found) = tags_beside(*id, &source.text, &parsed.tables);
                messages.extend(found);
                // What is made of a document names the texts of that.
                let is_of_sd = matches!(to, ConvertTo::Lad | ConvertTo::Fbd | ConvertTo::Sd);
                let own = texts.iter().find(|(unit, _)| unit == id);
                if let Some((_, texts)) = own.filter(|_| !is_of_sd) {
                    messages.extend(languages::of_document(*texts, &parsed.sources.file(*texts).text));
                }
                let own = own.filter(|_| is_of_sd);
                let own = own.map(|(_, texts)| texts_beside(parsed.sources.file(*texts).text.clone()));
                let beside = file.beside.into_iter().chain(own).chain(tags).collect();
                let text = match to {
                    ConvertTo::Stl => {
                        let pragma = usual.map_or_else(String::new, |cpu| format!("//@ cpu {cpu}\n"));
                        pragma + &without_stl::text(&file.text, args.cpu.as_deref())
                    }
                    _ => file.text,
                };
                files.push(Converted { name: source.name.clone(), text, beside });
            }
        }
    }
    report::messages(&mut messages, &parsed.sources);
    if unreadable {
        return exit::USAGE;
    }
    if messages.iter().any(Diagnostic::is_error) {
        report::say(&report::summary(&messages));
        return exit::COMPILE;
    }
    if to == ConvertTo::Stl
        && let Some(cpu) = cpu.filter(|cpu| without_stl::is_without(cpu))
    {
        report::say(&without_stl::warning(cpu));
    }
    let companions = match companions::of(args, &tables, &parsed, Some((to, &files))) {
        Ok(companions) => companions,
        Err(code) => return code,
    };
    store(args, Some(to.extension()), &files, &companions).err().unwrap_or(exit::OK)
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

/// STL is made of SCL and charts, whose names and types are those of the program.
fn has_scl_for_stl(to: ConvertTo, parsed: &pipeline::Parsed) -> bool {
    let is_scl = |block: &Block| matches!(block, Block::Code(block) if from_scl::has_statements(&block.code));
    to == ConvertTo::Stl && parsed.units.iter().any(|(_, unit)| unit.blocks.iter().any(is_scl))
}

/// The CPU for STL made from SCL and charts if nothing names one; `None`: the one that the sources imply, as when they are run.
fn cpu_for_stl(parsed: &pipeline::Parsed) -> Option<&'static str> {
    let implied = plcc_program::implied_profile(&parsed.units);
    if implied.family == Family::S71200 {
        // That has no STL.
        return Some("s7-300");
    }
    // SCL of the TIA Portal follows the rules of an S7-1500, whose STL has instructions that an S7-300 does not have.
    let is_of_portal = |block: &Block| match block {
        Block::Code(block) => match &block.code {
            Code::Scl(body) => body.dialect == scl::ast::Dialect::Tia,
            Code::Graphic(_) => true,
            Code::Stl(_) | Code::Chart(_) => false,
        },
        Block::Data(_) | Block::Type(_) => true,
    };
    let is_unnamed = implied.family == Family::S7300 && !implied.limits_checked;
    let is_for_portal = is_unnamed && parsed.units.iter().flat_map(|(_, unit)| &unit.blocks).all(is_of_portal);
    is_for_portal.then_some(without_stl::USUAL)
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

/// Whether the new notation has the types of a program in quotes. SCL keeps them as its author wrote them.
fn has_quoted_types(to: ConvertTo, unit: &SourceUnit, source: &SourceFile) -> bool {
    match to {
        ConvertTo::Stl | ConvertTo::Xml => true,
        ConvertTo::Scl => unit.overlay.is_some() || is_document(source),
        ConvertTo::Lad | ConvertTo::Fbd | ConvertTo::Sd | ConvertTo::Gr7 | ConvertTo::Plcopen | ConvertTo::Awl => false,
    }
}

/// Whether all that a source has is written out in other documents.
fn has_only_names(unit: &SourceUnit) -> bool {
    let is_name = |block: &Block| match block {
        Block::Type(ty) => ty.alias.as_ref().is_some_and(is_written_out),
        Block::Code(_) | Block::Data(_) => false,
    };
    !unit.blocks.is_empty() && unit.blocks.iter().all(is_name)
}

/// Whether a source is a document of SIMATIC SD.
fn is_document(source: &SourceFile) -> bool {
    let parts = plcc_readers::parts(&source.text, pipeline::language_of(&source.name));
    matches!(parts[..], [(_, plcc_syntax::Language::Sd)])
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

/// The new text of a source, whose tree is `made` from `unit`.
fn written(
    (args, to): (&ConvertArgs, ConvertTo),
    file: FileId,
    (unit, made): (&SourceUnit, &SourceUnit),
    library: &xml::Library,
    source: &SourceFile,
) -> (Converted, Vec<Diagnostic>) {
    let is_document = is_document(source);
    let source = source.text.as_str();
    let set = args.mnemonics.map_or(unit.mnemonics, Mnemonics::from);
    let is_stl = has(unit, |code| matches!(code, Code::Stl(_)));
    let whole;
    let made = match plcc_readers::xml::kind(source) {
        Some(kind @ (XmlKind::SimaticMl(_) | XmlKind::PlcOpen)) => {
            let mut blocks = whole_blocks(made, source.len() as u32);
            // Their comments are met in the order of the text.
            if matches!(kind, XmlKind::PlcOpen)
                && matches!(to, ConvertTo::Xml | ConvertTo::Sd | ConvertTo::Gr7 | ConvertTo::Stl)
            {
                blocks.blocks.sort_by_key(|block| block.span().start);
            }
            whole = blocks;
            &whole
        }
        _ => made,
    };
    let mut remarks = match &unit.overlay {
        Some(text)
            if matches!(to, ConvertTo::Xml | ConvertTo::Sd | ConvertTo::Gr7 | ConvertTo::Stl)
                && plcopen::is_project(source) =>
        {
            let comments = match to {
                ConvertTo::Stl => plcopen::comments_and_pragmas(source, text),
                _ => plcopen::comments(source, text),
            };
            Some(Remarks { text: text.clone(), comments })
        }
        _ => remarks(unit, source),
    };
    if let Some(remarks) = remarks.as_mut().filter(|_| is_stl && matches!(to, ConvertTo::Lad | ConvertTo::Fbd)) {
        remarks.comments = to_graph::other_comments(unit, &remarks.text, std::mem::take(&mut remarks.comments));
    }
    let trivia = |only_lines| match &remarks {
        Some(Remarks { text, comments }) => Trivia::new(text, comments.clone(), only_lines),
        None => Trivia::none(),
    };
    let meaning = unit.overlay.as_deref().unwrap_or(source);
    // Constants of STL and of projects in PLCopen XML have other forms, or are none there, as `S` of a list: they are not copied.
    let own = Some(meaning).filter(|_| !plcopen::is_project(source));
    let same = own.filter(|_| !is_stl);
    let name = String::new();
    match to {
        // Sources of the S7-200 and whole programs are written by others.
        ConvertTo::Awl | ConvertTo::Plcopen => {
            (Converted { name, text: source.to_string(), beside: Vec::new() }, Vec::new())
        }
        ConvertTo::Stl => {
            let (text, messages) = plcc_convert::stl::write(made, set, trivia(true), is_stl.then_some(meaning));
            warn_of_set(file, &text, set);
            (Converted { name, text, beside: Vec::new() }, messages)
        }
        ConvertTo::Lad | ConvertTo::Fbd | ConvertTo::Sd => {
            let sd::Document { text, texts, messages } = match is_document {
                true => sd::rewrite(made, trivia(false), source, to != ConvertTo::Sd),
                false if to == ConvertTo::Sd => sd::write_all(made, trivia(false), same),
                false => sd::write(made, trivia(false), same),
            };
            (Converted { name, text, beside: Vec::from_iter(texts.map(texts_beside)) }, messages)
        }
        ConvertTo::Gr7 => {
            let (text, messages) = plcc_convert::gr7::write(made, trivia(is_stl), own);
            (Converted { name, text, beside: Vec::new() }, messages)
        }
        ConvertTo::Xml => {
            let (text, messages) = plcc_convert::xml::write(made, library, trivia(is_stl), same);
            (Converted { name, text, beside: Vec::new() }, messages)
        }
        ConvertTo::Scl if plcopen::is_project(source) => {
            let trivia = Trivia::new(meaning, plcopen::comments(source, meaning), false);
            let (text, messages) = plcc_convert::scl::write(made, trivia, same, Others::LeftOut);
            (Converted { name, text, beside: Vec::new() }, messages)
        }
        ConvertTo::Scl => {
            let (text, messages) = plcc_convert::scl::write(made, trivia(false), same, Others::Refused);
            (Converted { name, text, beside: Vec::new() }, messages)
        }
    }
}

/// Few mnemonics, such as `SE`, are in both sets: a source with no others must be read with the set that is meant.
fn warn_of_set(file: FileId, text: &str, set: Mnemonics) {
    let read = |mnemonics| {
        let (unit, _) = stl::parse(file, text, &ParseOptions { mnemonics, pragmas: false });
        ast_text(&unit).lines().skip(1).collect::<Vec<_>>().join("\n")
    };
    if read(None) != read(Some(set)) {
        let name = if set == Mnemonics::De { "de" } else { "en" };
        report::say(&format!("the text does not show its mnemonics: read it with `--mnemonics {name}`"));
    }
}
