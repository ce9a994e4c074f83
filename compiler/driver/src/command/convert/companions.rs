//! What a folder of converted sources needs besides them, to be the same program: symbol tables and the settings of the project.

use std::fs;
use std::path::{Path, PathBuf};

use plcc_abi::image::{Family, Profile};
use plcc_diag::{FileId, SourceFile, SourceMap};
use plcc_model::profile;
use plcc_readers::ReadOptions;
use plcc_syntax::ast::{Block, Code, SourceUnit, Statement, StatementKind};
use plcc_syntax::{chart, scl};
use serde::Deserialize;
use toml::Spanned;

use super::{Converted, without_stl};
use crate::cli::{ConvertArgs, ConvertTo, MnemonicsArg};
use crate::command::exit;
use crate::inputs::{AXES_ENDING, Read, read_text};
use crate::project::FILE_NAME;
use crate::{pipeline, report};

/// A file that is written into the folder.
pub(super) struct Companion {
    pub name: PathBuf,
    pub bytes: Vec<u8>,
    /// A file with this name stays as it is.
    pub yields: bool,
}

/// Keys of plc.toml that mean something else in the new folder.
#[derive(Deserialize)]
struct Moved {
    sources: Option<Spanned<Vec<String>>>,
    symbols: Option<Spanned<Vec<String>>>,
    mnemonics: Option<Spanned<String>>,
}

/// Whether a source is made of other settings: axes are in plc.toml.
pub(super) fn is_made(name: &str) -> bool {
    name.ends_with(AXES_ENDING)
}

/// The files that have only symbols.
pub(super) fn tables(read: &Read) -> Vec<PathBuf> {
    let alone = read.tables.iter().filter(|table| !read.units.contains(table));
    alone.map(|table| PathBuf::from(&read.sources.file(*table).name)).collect()
}

/// What a folder of the sources needs; `made`: the files in another notation. `Err`: the exit code, after a message.
pub(super) fn of(
    args: &ConvertArgs,
    tables: &[PathBuf],
    parsed: &pipeline::Parsed,
    made: Option<(ConvertTo, &[Converted])>,
) -> Result<Vec<Companion>, u8> {
    let mut found = Vec::new();
    for path in tables {
        let bytes = fs::read(path).map_err(|error| {
            report::say(&format!("cannot read `{}`: {error}", path.display()));
            exit::USAGE
        })?;
        found.push(Companion { name: PathBuf::from(path.file_name().unwrap_or_default()), bytes, yields: false });
    }
    if args.inputs.iter().any(|path| path.is_dir()) {
        let settings = settings(args, parsed, made)?;
        found.extend((!settings.is_empty()).then(|| Companion {
            name: PathBuf::from(FILE_NAME),
            bytes: settings.into_bytes(),
            yields: true,
        }));
    }
    Ok(found)
}

/// The text of plc.toml for the folder: that of the project, with the CPU that the sources imply if nothing names one and the new files
/// imply another.
fn settings(
    args: &ConvertArgs,
    parsed: &pipeline::Parsed,
    made: Option<(ConvertTo, &[Converted])>,
) -> Result<String, u8> {
    let to = made.map(|(to, _)| to);
    let own = args.inputs.iter().map(|path| path.join(FILE_NAME)).find(|path| path.is_file());
    let text = own.map_or_else(|| Ok(String::new()), |path| text_of(&path))?;
    // Sources and tables are now in the folder itself. Only statement lists have mnemonics.
    let keeps_set = args.mnemonics.is_none() && matches!(to, None | Some(ConvertTo::Stl | ConvertTo::Awl));
    let mut text = without_moved(&text, keeps_set);
    if to == Some(ConvertTo::Plcopen) {
        text = without_blocks(&text);
    }
    if let Some(set) = args.mnemonics.filter(|_| matches!(to, Some(ConvertTo::Stl | ConvertTo::Awl))) {
        let set = match set {
            MnemonicsArg::De => "de",
            MnemonicsArg::En => "en",
        };
        text = format!("mnemonics = \"{set}\"\n{text}");
    }
    if to == Some(ConvertTo::Stl) {
        text = without_stl::settings(text, args.cpu.as_deref());
    }
    let names_cpu =
        parsed.project.as_ref().is_some_and(|project| project.cpu.is_some()) || cpu_of_pragmas(parsed).is_some();
    let named = args.cpu.as_deref().and_then(profile::lookup);
    let is_named = named.is_some();
    let cpu = named.unwrap_or_else(|| plcc_program::implied_profile(&parsed.units));
    // Statement lists and charts of S7-GRAPH imply an S7-300, others a CPU of the TIA Portal.
    let of_portal = made.filter(|(to, _)| match to {
        ConvertTo::Stl | ConvertTo::Gr7 | ConvertTo::Awl | ConvertTo::Plcopen => false,
        ConvertTo::Lad | ConvertTo::Fbd | ConvertTo::Sd | ConvertTo::Scl | ConvertTo::Xml => true,
    });
    let is_list = to == Some(ConvertTo::Stl);
    let needs_another = || {
        is_named && cpu.family == Family::S71200
            || made.is_some_and(|(to, files)| calls_instructions(&units_of(to, files)))
    };
    let new = match of_portal {
        Some(made) => (is_named || !keeps_rules(parsed, made, &cpu)).then_some(cpu.name.as_str()),
        None if is_list && cpu.family == Family::S71500 => Some(cpu.name.as_str()),
        None => (is_list && needs_another()).then_some(without_stl::USUAL),
    };
    if let Some(new) = new.filter(|_| !names_cpu) {
        text = format!("cpu = \"{new}\"\n{text}");
    }
    Ok(text)
}

/// The new files as they are read.
fn units_of(to: ConvertTo, files: &[Converted]) -> Vec<(FileId, SourceUnit)> {
    let options =
        ReadOptions { language: plcc_syntax::Language::of_extension(to.extension()), ..ReadOptions::default() };
    let mut sources = SourceMap::default();
    let read = |file: &Converted| {
        let id = sources.add(SourceFile::new(file.name.as_str(), file.text.as_str()));
        (id, plcc_readers::parse(id, &file.text, &options).0)
    };
    files.iter().map(read).collect()
}

/// Whether statement lists call instructions, `CALL SEL {value_type := INT}`, which only an S7-1500 has.
fn calls_instructions(units: &[(FileId, SourceUnit)]) -> bool {
    let is_instruction =
        |statement: &Statement| matches!(&statement.kind, StatementKind::Call(call) if !call.types.is_empty());
    units.iter().flat_map(|(_, unit)| &unit.blocks).any(|block| match block {
        Block::Code(code) => code.networks().iter().flat_map(|network| &network.statements).any(is_instruction),
        Block::Data(_) | Block::Type(_) => false,
    })
}

/// Whether the new files follow the rules of the sources if nothing names a CPU: all blocks are of the TIA Portal, and the files imply the
/// same CPU as the sources, `implied`. Its name would choose the rules of an S7-300, which are stricter. In XML, optimized access implies an
/// S7-1500, whose rules the sources follow as well.
fn keeps_rules(parsed: &pipeline::Parsed, (to, files): (ConvertTo, &[Converted]), implied: &Profile) -> bool {
    let is_of_portal = |block: &Block| match block {
        Block::Code(code) => match &code.code {
            Code::Scl(body) => body.dialect == scl::ast::Dialect::Tia,
            Code::Graphic(_) => true,
            Code::Chart(body) => body.dialect != chart::ast::Dialect::Classic,
            Code::Stl(_) => false,
        },
        Block::Data(_) | Block::Type(_) => true,
    };
    if !parsed.units.iter().flat_map(|(_, unit)| &unit.blocks).all(is_of_portal) {
        return false;
    }
    let of_files = plcc_program::implied_profile(&units_of(to, files));
    let is_unnamed_300 = implied.family == Family::S7300 && !implied.limits_checked;
    of_files == *implied || is_unnamed_300 && of_files.family == Family::S71500
}

/// The CPU of the first source that names one.
pub(super) fn cpu_of_pragmas(parsed: &pipeline::Parsed) -> Option<&str> {
    parsed.units.iter().find_map(|(file, _)| parsed.sources.file(*file).text.lines().find_map(cpu_of_pragma))
}

/// The name in `//@ cpu 315-2DP`, or in the same in a comment of an export.
pub(super) fn cpu_of_pragma(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let text = line.strip_prefix("//@").or_else(|| line.strip_prefix("<!--@")?.trim_end().strip_suffix("-->"))?;
    text.trim().strip_prefix("cpu")?.strip_prefix(char::is_whitespace).map(str::trim)
}

fn text_of(path: &Path) -> Result<String, u8> {
    read_text(path).map_err(|error| {
        report::say(&format!("cannot read `{}`: {error}", path.display()));
        exit::USAGE
    })
}

/// The settings without the keys that name files, and without the mnemonics unless they stay.
fn without_moved(text: &str, keeps_set: bool) -> String {
    // What is wrong in the file has been reported.
    let Ok(moved) = toml::from_str::<Moved>(text) else { return text.to_string() };
    let set = moved.mnemonics.filter(|_| !keeps_set).map(|value| value.span());
    let values = [moved.sources.map(|value| value.span()), moved.symbols.map(|value| value.span()), set];
    let mut lines: Vec<(usize, usize)> = values
        .into_iter()
        .flatten()
        .map(|value| {
            let start = text.get(..value.start).and_then(|text| text.rfind('\n')).map_or(0, |at| at + 1);
            let end = text.get(value.end..).and_then(|text| text.find('\n'));
            (start, end.map_or(text.len(), |at| value.end + at + 1))
        })
        .collect();
    lines.sort_unstable();
    let mut kept = String::new();
    let mut at = 0;
    for (start, end) in lines {
        kept.push_str(text.get(at..start).unwrap_or_default());
        at = end;
    }
    kept.push_str(text.get(at..).unwrap_or_default());
    kept
}

/// The settings without those of organization blocks: a project in PLCopen XML has tasks with intervals instead.
fn without_blocks(text: &str) -> String {
    let mut is_of_block = false;
    let is_kept = |line: &&str| {
        let line = line.trim_start();
        if line.starts_with('[') {
            is_of_block = line.starts_with("[ob.");
        }
        !is_of_block
    };
    text.split_inclusive('\n').filter(is_kept).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_that_name_files_are_left_out() {
        let text = "# a plant\nsources = [\n  \"a\", # one\n  \"b]\",\n] # all\ncpu = \"315-2DP\"\nmnemonics = \"de\"\n[ob.35]\nperiod = \"1s\"\n";
        assert_eq!(
            without_moved(text, true),
            "# a plant\ncpu = \"315-2DP\"\nmnemonics = \"de\"\n[ob.35]\nperiod = \"1s\"\n"
        );
        assert_eq!(without_moved(text, false), "# a plant\ncpu = \"315-2DP\"\n[ob.35]\nperiod = \"1s\"\n");
        assert_eq!(without_moved("symbols = []", true), "");
    }

    #[test]
    fn settings_of_organization_blocks_are_left_out_of_projects() {
        let text = "clock_memory = 100\n\n[ob.35]\nperiod = \"50ms\"\n[[module]]\nname = \"DI8\"\n[ob.\"PID_Loop\"]\nphase = \"1ms\"\n";
        assert_eq!(without_blocks(text), "clock_memory = 100\n\n[[module]]\nname = \"DI8\"\n");
    }
}
