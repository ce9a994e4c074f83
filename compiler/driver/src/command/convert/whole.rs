//! `plcc convert --to plcopen`: a whole program as one document.

use plcc_convert::plcopen::{self, Settings, Unit};
use plcc_convert::to_stl::types::Types;
use plcc_convert::{to_graph, with_pragmas};
use plcc_diag::Diagnostic;
use plcc_readers::plcopen as reader;
use plcc_runtime::events::default_period_ms;
use plcc_syntax::ast::{Block, Code, SourceUnit};
use plcc_syntax::network::ast::Language as Graphic;
use plcc_syntax::{scl, stl};

use super::{Converted, bound, exit, has, other_family, store};
use crate::cli::{ConvertArgs, ConvertTo};
use crate::report::MessageFormat;
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
        if let Err(code) = bound(args, &parsed, None) {
            return code;
        }
        let name = parsed.project.as_ref().and_then(|project| project.name.clone());
        let folder =
            args.inputs.first().and_then(|path| path.file_stem()).map(|name| name.to_string_lossy().into_owned());
        let (text, found) = document(&parsed, &name.or(folder).unwrap_or_default());
        messages.extend(found);
        let name = args.inputs.first().map_or_else(String::new, |path| path.to_string_lossy().into_owned());
        files.push(Converted { name, text, beside: Vec::new() });
    }
    report::messages(&mut messages, &parsed.sources, MessageFormat::Human);
    if messages.iter().any(Diagnostic::is_error) {
        report::say(&report::summary(&messages));
        return exit::COMPILE;
    }
    store(args, Some(ConvertTo::Plcopen.extension()), &files, &[]).err().unwrap_or(exit::OK)
}

/// The document of a parsed program, and messages.
pub fn document(parsed: &pipeline::Parsed, name: &str) -> (String, Vec<Diagnostic>) {
    let config = parsed.project.as_ref().map(|project| &project.config);
    let period_ms = |ob: u16| {
        let set = config.and_then(|config| config.cyclic_period_ms.iter().find(|(number, _)| *number == ob));
        set.map_or_else(|| default_period_ms(ob), |(_, ms)| *ms)
    };
    let types = Types::new(parsed.units.iter().map(|(_, unit)| unit), &parsed.tables);
    let mut notes = Vec::new();
    let drawn: Vec<SourceUnit> = parsed.units.iter().map(|(_, unit)| as_networks(unit, &types, &mut notes)).collect();
    if notes.iter().any(Diagnostic::is_error) {
        return (String::new(), notes);
    }
    let sources = parsed.units.iter().zip(&drawn);
    let units = sources.map(|((id, one), drawn)| unit(&parsed.sources.file(*id).text, one, drawn)).collect();
    let (text, mut messages) = plcopen::write(units, &parsed.tables, &Settings { name, period_ms: &period_ms });
    messages.extend(notes);
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

/// A source with the text that its spans mean. `drawn`: what is made of its tree.
fn unit<'a>(source: &'a str, unit: &'a SourceUnit, drawn: &'a SourceUnit) -> Unit<'a> {
    let text = unit.overlay.as_deref().unwrap_or(source);
    let comments = match plcc_readers::xml::kind(source) {
        // Assertions are comments of networks.
        None if has(unit, |code| matches!(code, Code::Stl(_))) => {
            let mut comments = to_graph::other_comments(unit, source, stl::comments(source));
            let is_of_file = |text: &str| matches!(text.split_whitespace().next(), Some("cpu" | "test"));
            comments.retain(|comment| {
                let pragma = source[comment.range()].strip_prefix("//@");
                pragma.is_none_or(|text| !is_of_file(text))
            });
            comments
        }
        None => {
            let mut comments = match has(unit, |code| matches!(code, Code::Chart(_))) {
                true => plcc_readers::gr7::comments(source),
                false => scl::comments_and_regions(source),
            };
            comments.retain(|comment| !source[comment.range()].starts_with("//@"));
            comments
        }
        Some(_) if reader::is_project(source) => reader::comments(source, text),
        Some(_) => Vec::new(),
    };
    Unit { unit: drawn, text, comments }
}
