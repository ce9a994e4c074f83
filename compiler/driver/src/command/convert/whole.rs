//! `plcc convert --to plcopen`: a whole program as one document.

use plcc_abi::image::BlockKind;
use plcc_abi::ob::CYCLIC_PERIOD_MS;
use plcc_convert::own_types::OwnTypes;
use plcc_convert::plcopen::{self, Settings, Unit};
use plcc_convert::to_stl::types::Types;
use plcc_convert::{to_graph, with_pragmas};
use plcc_diag::{Diagnostic, FileId};
use plcc_model::{Program, profile};
use plcc_readers::plcopen as reader;
use plcc_readers::simatic_ml::Remarks;
use plcc_readers::xml::XmlKind;
use plcc_runtime::events::default_period_ms;
use plcc_syntax::ast::{Block, BlockName, Code, CodeBlock, CodeKind, SourceUnit};
use plcc_syntax::network::ast::Language as Graphic;
use plcc_syntax::{scl, stl};

use super::{
    Converted, bound, companions, exit, has, languages, name_by_files, other_family, remarks, store, whole_blocks,
};
use crate::cli::{ConvertArgs, ConvertTo};
use crate::{inputs, pipeline, report};

/// Writes the program as one project.
pub fn plcopen(args: &ConvertArgs) -> u8 {
    let read = inputs::read_as(&args.inputs, args.code_page);
    if read.is_unreadable() {
        return exit::USAGE;
    }
    // Assertions are statements: the names in them are those of the file.
    let settings = pipeline::Settings { pragmas: true, ..pipeline::Settings::default() };
    let mut parsed = pipeline::parse(read, &settings);
    name_by_files(&mut parsed);
    let mut messages = std::mem::take(&mut parsed.diagnostics);
    messages.retain(Diagnostic::is_error);
    messages.extend(
        parsed
            .units
            .iter()
            .filter(|(_, unit)| unit.s7200.is_some())
            .map(|(_, unit)| other_family(unit, ConvertTo::Plcopen)),
    );
    let mut files = Vec::new();
    if messages.is_empty() {
        // Names and types decide what a statement means, so the program must be whole.
        let program = match bound(args, &parsed, None) {
            Ok(bound) => bound.program,
            Err(code) => return code,
        };
        let name = parsed.project.as_ref().and_then(|project| project.name.clone());
        let folder =
            args.inputs.first().and_then(|path| path.file_stem()).map(|name| name.to_string_lossy().into_owned());
        let (text, found) = document(&parsed, Some(&program), &name.or(folder).unwrap_or_default());
        messages.extend(found);
        let name = args.inputs.first().map_or_else(String::new, |path| path.to_string_lossy().into_owned());
        files.push(Converted { name, text, beside: Vec::new() });
    }
    report::messages(&mut messages, &parsed.sources);
    if messages.iter().any(Diagnostic::is_error) {
        report::say(&report::summary(&messages));
        return exit::COMPILE;
    }
    // The document has the symbols of the tables.
    let companions = match companions::of(args, &[], &parsed, Some((ConvertTo::Plcopen, &files))) {
        Ok(companions) => companions,
        Err(code) => return code,
    };
    store(args, Some(ConvertTo::Plcopen.extension()), &files, &companions).err().unwrap_or(exit::OK)
}

/// The document of a parsed program, and messages. `program`: the same, bound; without it settings of plc.toml are not known.
pub fn document(parsed: &pipeline::Parsed, program: Option<&Program>, name: &str) -> (String, Vec<Diagnostic>) {
    let cpu = parsed.project.as_ref().and_then(|project| project.cpu.as_ref());
    let named = cpu.and_then(|(name, _)| profile::lookup(name));
    let family = named.unwrap_or_else(|| plcc_program::implied_profile(&parsed.units)).family;
    let period_ms = |ob: u16, has_own_name: bool| {
        let set = program.and_then(|program| program.config.cyclic_period_ms.iter().find(|(number, _)| *number == ob));
        match set {
            Some((_, ms)) => *ms,
            None if has_own_name && family.is_portal() => CYCLIC_PERIOD_MS,
            None => default_period_ms(ob),
        }
    };
    let blocks = || parsed.units.iter().flat_map(|(_, unit)| &unit.blocks);
    let told_ob = |name: &str| {
        let is_named = |block: &&Block| match block {
            Block::Code(CodeBlock { kind: CodeKind::Ob, name: BlockName::Symbol { name: own, .. }, .. }) => own == name,
            _ => false,
        };
        let (number, class) = blocks().find(is_named).map_or((None, None), plcc_program::told_ob);
        let bound = || {
            let mut obs = program?.blocks.iter().filter(|block| block.kind == BlockKind::Ob);
            obs.find(|block| block.name.eq_ignore_ascii_case(name)).map(|block| u32::from(block.number))
        };
        (number.or_else(bound), class)
    };
    let types = Types::new(parsed.units.iter().map(|(_, unit)| unit), &parsed.tables);
    let mut notes = Vec::new();
    let mut drawn: Vec<SourceUnit> =
        parsed.units.iter().map(|(_, unit)| as_networks(unit, &types, &mut notes)).collect();
    if notes.iter().any(Diagnostic::is_error) {
        return (String::new(), notes);
    }
    let own_types = OwnTypes::new(parsed.units.iter().map(|(_, unit)| unit));
    drawn.iter_mut().for_each(|unit| own_types.unquote(unit, &plcopen::has_type));
    // Comments of exports are not in their overlays.
    let exported: Vec<Option<Remarks>> = parsed.units.iter().map(|(id, one)| exported(one, parsed, *id)).collect();
    for (((id, _), drawn), _) in parsed.units.iter().zip(&mut drawn).zip(&exported).filter(|(_, found)| found.is_some())
    {
        *drawn = whole_blocks(drawn, parsed.sources.file(*id).text.len() as u32);
    }
    let sources = parsed.units.iter().zip(&drawn).zip(&exported);
    let units = sources.map(|(((id, one), drawn), exported)| {
        let source = &parsed.sources.file(*id).text;
        unit(source, one, drawn, exported.as_ref())
    });
    let units = units.collect();
    let (text, mut messages) =
        plcopen::write(units, &parsed.tables, &Settings { name, told_ob: &told_ob, period_ms: &period_ms });
    messages.extend(notes);
    messages.extend(parsed.units.iter().flat_map(|(id, _)| languages::of_export(*id, &parsed.sources.file(*id).text)));
    // Pragmas of files, such as the CPU, are comments after the first line.
    let mut pragmas: Vec<String> =
        parsed.units.iter().flat_map(|(_, unit)| &unit.pragmas).map(|one| one.text.trim().to_string()).collect();
    pragmas.sort_unstable();
    pragmas.dedup();
    (with_pragmas(&text, &pragmas), messages)
}

/// A source with its blocks of STL as LAD.
fn as_networks(unit: &SourceUnit, types: &Types, notes: &mut Vec<Diagnostic>) -> SourceUnit {
    let mut made = unit.clone();
    for block in &mut made.blocks {
        if let Block::Code(code) = block
            && matches!(code.code, Code::Stl(_))
        {
            match to_graph::block(code, types, Graphic::Lad, notes) {
                Ok(drawn) => *code = drawn,
                Err(found) => notes.extend(found),
            }
        }
    }
    made
}

/// The comments of an export of the TIA Portal without charts, and the text in which they are.
fn exported(unit: &SourceUnit, parsed: &pipeline::Parsed, id: FileId) -> Option<Remarks> {
    let source = &parsed.sources.file(id).text;
    match plcc_readers::xml::kind(source) {
        Some(XmlKind::SimaticMl(_)) => remarks(unit, source),
        _ => None,
    }
}

/// A source with the text that its spans mean. `drawn`: what is made of its tree; `exported`: comments of an export.
fn unit<'a>(source: &'a str, unit: &'a SourceUnit, drawn: &'a SourceUnit, exported: Option<&'a Remarks>) -> Unit<'a> {
    let overlay = unit.overlay.as_deref().unwrap_or(source);
    let text = exported.map_or(overlay, |exported| exported.text.as_str());
    let is_stl = has(unit, |code| matches!(code, Code::Stl(_)));
    let comments = match exported {
        Some(exported) => exported.comments.clone(),
        None if reader::is_project(source) => reader::comments(source, text),
        None if plcc_readers::xml::kind(source).is_some() => Vec::new(),
        None if is_stl => stl::comments(source),
        None if has(unit, |code| matches!(code, Code::Chart(_))) => plcc_readers::gr7::comments(source),
        None => scl::comments_and_regions(source),
    };
    if reader::is_project(source) {
        return Unit { unit: drawn, text, comments };
    }
    // Assertions are statements, but those of STL are comments of networks.
    let mut comments = if is_stl { to_graph::other_comments(unit, text, comments) } else { comments };
    comments.retain(|comment| {
        let pragma = text.get(comment.range()).and_then(|text| text.strip_prefix("//@"));
        pragma.is_none_or(|text| is_stl && !matches!(text.split_whitespace().next(), Some("cpu" | "test")))
    });
    Unit { unit: drawn, text, comments }
}
