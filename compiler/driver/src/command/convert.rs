//! `plcc convert`.

use std::path::{Path, PathBuf};

use plcc_abi::image::Family;
use plcc_convert::to_stl::{self, types::Types};
use plcc_convert::trivia::Trivia;
use plcc_diag::{Diagnostic, FileId};
use plcc_model::profile;
use plcc_runtime::files::writable;
use plcc_syntax::ast::SourceUnit;
use plcc_syntax::stl::{self, Mnemonics};
use plcc_syntax::{ParseOptions, ast_text};

use super::exit;
use crate::cli::{ConvertArgs, ConvertTo};
use crate::report::MessageFormat;
use crate::{inputs, pipeline, report};

/// Writes each source in the notation that the command line names. Returns 3 if one has an error or cannot be converted; then nothing is
/// written.
pub fn convert(args: &ConvertArgs) -> u8 {
    let read = inputs::read_as(&args.inputs, args.code_page);
    let unreadable = read.is_unreadable();
    let parsed = pipeline::parse(read, &pipeline::Settings::default());
    let mut messages = parsed.diagnostics;
    // What only warns about the source stays as it is.
    messages.retain(Diagnostic::is_error);
    let mut files = Vec::new();
    if messages.is_empty() {
        let types = Types::new(parsed.units.iter().map(|(_, unit)| unit), &parsed.tables);
        let project = parsed.project.as_ref().and_then(|project| project.cpu.as_ref());
        let cpu = args.cpu.as_deref().or(project.map(|(name, _)| name.as_str()));
        let keeps_br = cpu
            .and_then(profile::lookup)
            .is_some_and(|profile| matches!(profile.family, Family::S7300 | Family::S7400));
        for (file, unit) in &parsed.units {
            let source = parsed.sources.file(*file);
            let (made, found) = to_stl::unit(unit, &types, keeps_br);
            messages.extend(found);
            if messages.iter().any(Diagnostic::is_error) {
                continue;
            }
            let (text, found) = written(args, *file, &made, &source.text);
            messages.extend(found);
            files.push((source.name.clone(), text));
        }
    }
    report::messages(&mut messages, &parsed.sources, MessageFormat::Human);
    if unreadable {
        return exit::USAGE;
    }
    if messages.iter().any(Diagnostic::is_error) {
        report::say(&report::summary(&messages));
        return exit::COMPILE;
    }
    match store(args, &files) {
        Ok(()) => exit::OK,
        Err(code) => code,
    }
}

/// The new text of a source.
fn written(args: &ConvertArgs, file: FileId, unit: &SourceUnit, source: &str) -> (String, Vec<Diagnostic>) {
    let set = args.mnemonics.map_or(unit.mnemonics, Mnemonics::from);
    match args.to {
        ConvertTo::Stl => {
            let is_text = plcc_readers::xml::kind(source).is_none();
            let trivia = if is_text { Trivia::new(source, stl::comments(source), true) } else { Trivia::none() };
            let meaning = unit.overlay.as_deref().unwrap_or(source);
            let (text, messages) = plcc_convert::stl::write(unit, set, trivia, Some(meaning));
            warn_of_set(file, &text, set);
            (text, messages)
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

/// Writes the texts to standard output, to a file or into a folder.
fn store(args: &ConvertArgs, files: &[(String, String)]) -> Result<(), u8> {
    match (&args.output, files) {
        (None, _) => files.iter().try_for_each(|(_, text)| report::print(text)),
        (Some(output), [(_, text)]) if !output.is_dir() => write(output, text),
        (Some(folder), _) => {
            if let Err(error) = std::fs::create_dir_all(folder) {
                report::say(&format!("cannot make the folder `{}`: {error}", folder.display()));
                return Err(exit::USAGE);
            }
            let name_of = |name: &str| {
                let name = Path::new(name).with_extension(args.to.extension());
                folder.join(name.file_name().unwrap_or_default())
            };
            let paths: Vec<PathBuf> = files.iter().map(|(name, _)| name_of(name)).collect();
            if let Some(at) = (1..paths.len()).find(|at| paths[..*at].contains(&paths[*at])) {
                report::say(&format!("two sources would be written to `{}`", paths[at].display()));
                return Err(exit::USAGE);
            }
            paths.iter().zip(files).try_for_each(|(path, (_, text))| write(path, text))
        }
    }
}

fn write(path: &Path, text: &str) -> Result<(), u8> {
    writable(path).and_then(|()| std::fs::write(path, text)).map_err(|error| {
        report::say(&format!("cannot write `{}`: {error}", path.display()));
        exit::USAGE
    })
}
