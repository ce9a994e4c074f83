//! From FILE|DIR arguments to the text of files: the first stage of the pipeline, and the only one that reads.
//!
//! - [`add`]: adds files, folders and projects to the program.
//! - [`kinds`]: what a file is.
//! - [`disk`]: files and folders, and their texts.

mod add;
mod disk;
mod kinds;

pub(crate) use add::{AXES_ENDING, NOT_THERE, project_above};
pub(crate) use disk::{entries, files_below, is_folder};
pub use disk::{read_text, reason};
pub(crate) use kinds::{is_source, may_be_input};

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use plcc_diag::{Code, Diagnostic, FileId, SourceFile, SourceMap, Span};
use plcc_syntax::CodePage;

use add::{Wanted, add_file, add_folder, add_project};
use disk::stem;

use crate::near;
use crate::project::{self, Project};
use crate::{command::exit, report};

/// A program as it was read.
#[derive(Default)]
pub struct Read {
    /// Name of the program: that of the project, or of the first source without its extension.
    pub name: String,
    pub sources: SourceMap,
    /// Sources in STL of all families, SCL, SIMATIC SD and GRAPH and exports of blocks, in the order in which they were given or found.
    pub units: Vec<FileId>,
    /// Symbol tables.
    pub tables: Vec<FileId>,
    /// Sources with the texts next to them (`.s7res`).
    pub texts: Vec<(FileId, FileId)>,
    pub project: Option<Project>,
    pub diagnostics: Vec<Diagnostic>,
    /// Files in folders that plcc does not read, and what they are.
    pub unread: Vec<(PathBuf, String)>,
    /// Those of them that are programs of other tools.
    pub foreign: Vec<(PathBuf, String)>,
    /// Code page of files that are not UTF-8; `None`: found in each.
    pub code_page: Option<CodePage>,
    /// Texts of files that an editor has open, which go before those on the disk.
    pub open: BTreeMap<PathBuf, String>,
    /// Files that are part of the program: one that is named twice, alone and with its folder, is one file.
    pub seen: BTreeSet<PathBuf>,
}

impl Read {
    /// True if a file could not be read at all.
    pub fn is_unreadable(&self) -> bool {
        self.diagnostics.iter().any(|d| d.code == Code::Unreadable)
    }

    /// A file that the user named and that cannot be read.
    fn unreadable(&mut self, path: &Path, error: &std::io::Error) {
        let title = format!("cannot read `{}`: {}", path.display(), reason(error));
        let help = match error.kind() {
            std::io::ErrorKind::NotFound => match near::beside(path) {
                Some(near) => format!("is `{near}` meant?"),
                None => "check the name of the file; it is looked for in the folder where plcc runs".to_string(),
            },
            std::io::ErrorKind::PermissionDenied => "the file exists, but you may not read it".to_string(),
            _ => "check the file and the permission to read it".to_string(),
        };
        self.report(Code::Unreadable, path, title, &help);
    }

    /// Reports `code` at a place that cannot be shown.
    fn report(&mut self, code: Code, file: &Path, title: String, help: &str) {
        let file = self.sources.add(SourceFile::new(file.display().to_string(), ""));
        self.diagnostics.push(Diagnostic::new(code, Span::new(file, 0..0), title).help(help));
    }
}

/// The paths of the command line; if it names none, the project in the current folder. `Err`: the exit code.
pub fn or_here(paths: &[PathBuf]) -> Result<Vec<PathBuf>, u8> {
    if !paths.is_empty() {
        return Ok(paths.to_vec());
    }
    if !Path::new(project::FILE_NAME).is_file() {
        let file = project::FILE_NAME;
        report::say(&format!("name a FILE or DIR: this folder is not a project, it contains no {file}"));
        return Err(exit::USAGE);
    }
    Ok(vec![PathBuf::from(".")])
}

/// Reads `paths` as one program: files, folders and at most one project.
pub fn read(paths: &[PathBuf]) -> Read {
    read_as(paths, None)
}

/// Like [`read`], with the code page of files that are not UTF-8.
pub fn read_as(paths: &[PathBuf], code_page: Option<CodePage>) -> Read {
    read_into(Read { code_page, ..Read::default() }, paths)
}

/// Like [`read`], with the texts of files that an editor has open.
pub fn read_open(paths: &[PathBuf], open: BTreeMap<PathBuf, String>) -> Read {
    read_into(Read { open, ..Read::default() }, paths)
}

/// Like [`read_as`], with other texts of some files.
pub fn read_changed(paths: &[PathBuf], code_page: Option<CodePage>, texts: BTreeMap<PathBuf, String>) -> Read {
    read_into(Read { code_page, open: texts, ..Read::default() }, paths)
}

fn read_into(mut read: Read, paths: &[PathBuf]) -> Read {
    for path in paths {
        if !path.is_dir() {
            add_file(&mut read, path, Wanted::Yes);
        } else if path.join(project::FILE_NAME).is_file() {
            add_project(&mut read, path);
        } else {
            add_folder(&mut read, path);
        }
    }
    if read.name.is_empty() {
        read.name = paths.first().map(|path| stem(path)).unwrap_or_default();
    }
    report_unread(&mut read);
    read
}

/// Maximum number of names in a message about files that are not read.
const UNREAD_MAX: usize = 8;

/// Reports in one message all files of folders that were not read.
fn report_unread(read: &mut Read) {
    // Programs of other tools come first: a user may miss them.
    let mut unread = std::mem::take(&mut read.foreign);
    unread.append(&mut read.unread);
    let texts: Vec<String> = read.texts.iter().map(|(_, texts)| read.sources.file(*texts).name.clone()).collect();
    let unread: Vec<&(PathBuf, String)> =
        unread.iter().filter(|(path, _)| !texts.contains(&path.display().to_string())).collect();
    let Some((first, _)) = unread.first() else { return };
    let title = match unread.len() {
        1 => "a file in the folder is not read".to_string(),
        count => format!("{count} files in the folder are not read"),
    };
    let mut names: Vec<String> =
        unread.iter().take(UNREAD_MAX).map(|(path, what)| format!("{} ({what})", path.display())).collect();
    if unread.len() > UNREAD_MAX {
        names.push(format!("... and {} more", unread.len() - UNREAD_MAX));
    }
    read.report(Code::NotRead, first, title, &names.join(", "));
}

/// What `plcc test` runs.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TestInput {
    /// A source alone.
    File(PathBuf),
    /// A folder with a plc.toml.
    Project(PathBuf),
    /// Sources and tables of one program, or a folder of them.
    Program(Vec<PathBuf>),
}

/// Scenarios of a project: the `.toml` files below its `tests` folder.
pub fn project_scenarios(folder: &Path) -> Vec<PathBuf> {
    let mut scenarios = files_below(&folder.join("tests"));
    scenarios.retain(|path| path.extension().is_some_and(|suffix| suffix == "toml") && path.is_file());
    scenarios
}

/// The scenario of a single test file, if it has one: `x.scenario.toml` next to `x.stl`.
pub fn file_scenario(file: &Path) -> Option<PathBuf> {
    Some(file.with_extension("scenario.toml")).filter(|path| path.is_file())
}

#[cfg(test)]
pub(crate) mod tests;
