//! From FILE|DIR arguments to the text of files: the first stage of the pipeline, and the only one that reads.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use plcc_diag::{Code, Diagnostic, FileId, SourceFile, SourceMap, Span};
use plcc_runtime::files::regular;
use plcc_syntax::{CodePage, Language};

use crate::content::foreign::{self, Foreign};
use crate::content::{self, Content};
use crate::near;
use crate::pipeline;
use crate::project::{self, Project};
use crate::sheets;
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

/// True for the text of a source, at a path that the user did not name.
pub(crate) fn is_source(path: &Path, text: &str) -> bool {
    matches!(content_in_folder(path, text), Content::Source | Content::SourceAndTable)
}

/// True unless a file in a folder is clearly no part of a program or its tests; also if it cannot be read.
pub(crate) fn may_be_input(path: &Path) -> bool {
    let is_one_of =
        |suffix: &std::ffi::OsStr| [TEXTS_SUFFIX, "toml", "xlsx"].iter().any(|one| suffix.eq_ignore_ascii_case(one));
    if path.extension().is_some_and(is_one_of) || pipeline::language_of(&path.display().to_string()).is_some() {
        return true;
    }
    let Ok(bytes) = fs::read(path) else { return true };
    let content = content_in_folder(path, &String::from_utf8_lossy(&bytes));
    !matches!(content, Content::Nothing | Content::Prose | Content::Other(_))
}

/// The extension of files with the texts of a source in SIMATIC SD.
const TEXTS_SUFFIX: &str = "s7res";

/// What a file contains. For a text that may be prose, the file extension decides.
fn content_of(path: &Path, text: &str) -> Content {
    if path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case(TEXTS_SUFFIX)) {
        return Content::Other("texts of a block");
    }
    if is_toml(path) {
        return Content::Other("settings or a scenario in TOML");
    }
    match content::of(text) {
        Content::Source | Content::Prose if content::is_table_in_no_form(path, text) => Content::SymbolTable,
        Content::Prose if pipeline::language_of(&path.display().to_string()).is_some() => Content::Source,
        // For a binary file the name is the best evidence.
        Content::Other(what) => match foreign::of_name(path) {
            Some(Foreign::Program(what)) => Content::Program(what),
            _ => Content::Other(what),
        },
        content => content,
    }
}

/// Like [`content_of`], for a file that the user did not name.
fn content_in_folder(path: &Path, text: &str) -> Content {
    let is_text_of_block = path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case(TEXTS_SUFFIX));
    if is_text_of_block || is_toml(path) {
        return content_of(path, text);
    }
    content::in_folder(path, text, pipeline::language_of(&path.display().to_string()).is_some())
}

fn is_toml(path: &Path) -> bool {
    path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("toml"))
}

/// Whether a file that is not a source is a mistake.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Wanted {
    /// The user named it.
    Yes,
    /// It is only in a folder.
    No,
}

fn add_file(read: &mut Read, path: &Path, wanted: Wanted) {
    if wanted == Wanted::No
        && let Err(why) = regular(path)
    {
        return read.unread.push((path.to_path_buf(), reason(&why)));
    }
    if wanted == Wanted::Yes
        && path.is_file()
        && let Some((what, how)) = foreign::siemens_project(path)
    {
        return read.report(
            Code::NotASource,
            path,
            format!("`{}` is {what}, which only that tool reads", path.display()),
            how,
        );
    }
    if sheets::is_workbook(path) {
        return add_workbook(read, path, wanted);
    }
    let text = match read.open.get(path).map_or_else(|| read_text_as(path, read.code_page), |text| Ok(text.clone())) {
        Ok(text) => text,
        Err(error) => {
            return read.unreadable(path, &error);
        }
    };
    let content = match wanted {
        Wanted::Yes => content_of(path, &text),
        Wanted::No => content_in_folder(path, &text),
    };
    if wanted == Wanted::No {
        let named = |what: &str| (path.to_path_buf(), what.to_string());
        match content {
            Content::Source | Content::SourceAndTable | Content::SymbolTable => {}
            Content::Nothing => return,
            Content::Other(_) if is_toml(path) => return,
            Content::Program(what) => return read.foreign.push(named(what)),
            Content::Prose => return read.unread.push(named("text that is not a source")),
            Content::Other(what) => return read.unread.push(named(what)),
        }
    }
    let source = SourceFile::new(path.display().to_string(), text);
    match content {
        // The parser reports best why a text is not a source.
        Content::Source | Content::SourceAndTable | Content::Prose | Content::Nothing => {
            if read.name.is_empty() {
                read.name = stem(path);
            }
            let file = read.sources.add(source);
            read.units.push(file);
            if content == Content::SourceAndTable {
                read.tables.push(file);
            }
            add_texts(read, path, file);
        }
        Content::SymbolTable => {
            let file = read.sources.add(source);
            read.tables.push(file);
        }
        Content::Other(what) | Content::Program(what) => {
            let title = format!("`{}` is not a PLC source but {what}", path.display());
            let help = "give a source in STL (S7-200 or S7-300/400), SCL, SIMATIC SD or GRAPH, blocks exported as XML, or a symbol table";
            read.report(Code::NotASource, path, title, help);
        }
    }
}

/// A workbook, if it holds tag tables.
fn add_workbook(read: &mut Read, path: &Path, wanted: Wanted) {
    let bytes = match regular(path).and_then(|()| fs::read(path)) {
        Ok(bytes) => bytes,
        Err(error) => {
            return read.unreadable(path, &error);
        }
    };
    match sheets::text(bytes) {
        Ok(Some(text)) => {
            let file = read.sources.add(SourceFile::new(path.display().to_string(), text));
            read.tables.push(file);
        }
        Ok(None) if wanted == Wanted::No => read.unread.push((
            path.to_path_buf(),
            "a workbook without tags: no sheet has the columns Name, Data Type and Logical Address".to_string(),
        )),
        Ok(None) => {
            let title = format!("`{}` contains no tag table", path.display());
            let help = "a sheet with tags needs the columns Name, Data Type and Logical Address; a sheet with constants needs Name, Data Type and Value";
            read.report(Code::NotASource, path, title, help);
        }
        Err(fault) => {
            let title = format!("the workbook `{}` cannot be read: {}", path.display(), fault.why);
            read.report(Code::NotASource, path, title, fault.help);
        }
    }
}

/// The texts of titles and comments next to a source in SIMATIC SD.
fn add_texts(read: &mut Read, path: &Path, unit: FileId) {
    let beside = path.with_extension(TEXTS_SUFFIX);
    if pipeline::language_of(&path.display().to_string()) == Some(Language::Sd)
        && let Ok(text) = read_text_as(&beside, read.code_page)
    {
        let texts = read.sources.add(SourceFile::new(beside.display().to_string(), text));
        read.texts.push((unit, texts));
    }
}

/// What is wrong with a file, without the number of the error and the name of a temporary file.
pub fn reason(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}

fn add_folder(read: &mut Read, folder: &Path) {
    let before = read.units.len();
    let files = files_below(folder);
    let is_project = |path: &&PathBuf| path.file_name().is_some_and(|name| name == project::FILE_NAME);
    let projects: Vec<&PathBuf> = files.iter().filter(is_project).collect();
    if let [_, .., last] = projects.as_slice() {
        let title = format!("the folder `{}` contains {} projects", folder.display(), projects.len());
        let one = last.parent().unwrap_or(folder).display();
        return read.report(Code::Project, folder, title, &format!("give the folder of one of them, such as `{one}`"));
    }
    for path in &files {
        add_file(read, path, Wanted::No);
    }
    if read.units.len() == before {
        let title = format!("the folder `{}` contains no PLC source", folder.display());
        read.report(Code::NotASource, folder, title, "give a file, a folder of sources, or a folder with a plc.toml");
    }
}

fn add_project(read: &mut Read, folder: &Path) {
    let path = folder.join(project::FILE_NAME);
    if read.project.is_some() {
        let title = format!("`{}` is a second project", folder.display());
        return read.report(Code::Project, &path, title, "give one project at a time");
    }
    let text = match read_text(&path) {
        Ok(text) => text,
        Err(error) => {
            let title = format!("cannot read `{}`: {}", path.display(), reason(&error));
            return read.report(Code::Unreadable, &path, title, "check the permission to read the file");
        }
    };
    let source = SourceFile::new(path.display().to_string(), text);
    let file = read.sources.add(source.clone());
    let (project, diagnostics) = project::parse(file, &source);
    read.diagnostics.extend(diagnostics);
    read.name = project.name.clone().unwrap_or_else(|| stem(folder));
    match &project.sources {
        None if project.unread => {}
        None => {
            for path in files_below(folder) {
                if !path.starts_with(folder.join("tests")) && path.file_name() != Some(project::FILE_NAME.as_ref()) {
                    add_file(read, &path, Wanted::No);
                }
            }
        }
        Some(sources) => sources.iter().for_each(|source| add_named(read, folder, source)),
    }
    project.symbols.iter().for_each(|table| add_named(read, folder, table));
    if !project.axes.is_empty() {
        let name = format!("{}{AXES_ENDING}", path.display());
        let file = read.sources.add(SourceFile::new(name, project.axes.clone()));
        read.units.push(file);
    }
    read.project = Some(project);
}

/// What follows the path of plc.toml in the name of the source that its axes are.
pub(crate) const AXES_ENDING: &str = " (axes).scl";

/// A file or folder that plc.toml names.
fn add_named(read: &mut Read, folder: &Path, (name, span): &(String, Span)) {
    let path = folder.join(name);
    if path.is_dir() {
        files_below(&path).iter().for_each(|path| add_file(read, path, Wanted::No));
    } else if path.is_file() {
        add_file(read, &path, Wanted::Yes);
    } else {
        let message = Diagnostic::new(Code::Project, *span, format!("`{name}` is not a file or folder in the project"));
        read.diagnostics.push(match near::below(folder, name) {
            Some(near) => message.help(format!("is `{near}` meant?")),
            None => message.help("names are relative to the folder of plc.toml"),
        });
    }
}

/// Text of a file, decoded.
pub fn read_text(path: &Path) -> std::io::Result<String> {
    read_text_as(path, None)
}

fn read_text_as(path: &Path, code_page: Option<CodePage>) -> std::io::Result<String> {
    if !path.is_dir() {
        regular(path)?;
    }
    Ok(plcc_syntax::decode_as(&fs::read(path)?, code_page))
}

/// All files below `folder`, sorted by name, without hidden files. A link to a folder counts as a file and is not followed.
pub(crate) fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for path in entries(folder) {
        if is_folder(&path) {
            files.extend(files_below(&path));
        } else {
            files.push(path);
        }
    }
    files
}

/// A folder itself, not a link to one.
pub(crate) fn is_folder(path: &Path) -> bool {
    path.is_dir() && !path.is_symlink()
}

pub(crate) fn entries(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| !path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.')))
        .collect();
    entries.sort();
    entries
}

/// Last part of a path without its extension; for a folder, its whole name.
fn stem(path: &Path) -> String {
    let full = if path.file_name().is_none() { fs::canonicalize(path).unwrap_or_default() } else { path.to_path_buf() };
    let name = if full.is_dir() { full.file_name() } else { full.file_stem() };
    name.map_or_else(|| "program".to_string(), |name| name.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        folder
    }

    #[test]
    fn a_folder_gives_its_sources_and_tables() {
        let folder = folder(&[
            ("main.awl", "A I 0.0\n"),
            ("sub/valve", "FUNCTION FC 1 : VOID\nBEGIN\nEND_FUNCTION\n"),
            ("symbols.txt", "\"Start\",\"I 0.0\",\"BOOL\",\"\"\n"),
            ("notes.txt", "# Notes\n\nThis is prose that explains the program.\n"),
            ("README.md", "A tank\n"),
            ("LICENSE", "MIT\n"),
        ]);
        let read = read(&[folder.path().to_path_buf()]);
        assert_eq!((read.units.len(), read.tables.len(), read.diagnostics.len()), (2, 1, 1));
        assert_eq!(read.name, "main");
        // The message names what is not read.
        let message = &read.diagnostics[0];
        assert_eq!(message.code, Code::NotRead);
        assert!(message.help.iter().any(|help| help.contains("notes.txt (text that is not a source)")));
    }

    #[test]
    fn the_list_of_unread_files_is_short() {
        let mut files: Vec<(String, &str)> = (0..20).map(|n| (format!("a{n:02}.py"), "x = 1\n")).collect();
        files.push(("main".to_string(), "A I 0.0\n= Q 4.0\n"));
        files.push(("z.s7p".to_string(), ""));
        let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (name.as_str(), *text)).collect();
        let read = read(&[folder(&files).path().to_path_buf()]);
        let help = read.diagnostics[0].help.clone().unwrap_or_default();
        assert_eq!((read.units.len(), help.matches("(a source in Python)").count()), (1, 7));
        assert!(help.contains("z.s7p (a project of STEP 7") && help.ends_with("... and 13 more"), "{help}");
    }

    #[test]
    fn a_folder_of_projects_is_not_one_program() {
        let folder = folder(&[("lad/plc.toml", ""), ("lad/a.stl", "A I 0.0\n"), ("fbd/plc.toml", "")]);
        let read = read(&[folder.path().to_path_buf()]);
        let codes: Vec<Code> = read.diagnostics.iter().map(|diagnostic| diagnostic.code).collect();
        assert_eq!((codes, read.units.len()), (vec![Code::Project], 0));
    }

    #[test]
    fn a_missing_file_is_told_with_the_one_that_is_meant() {
        let toml = "sources = [\"mian.stl\", \"valve.scl\", \"gone.stl\"]\n";
        let folder = folder(&[("plc.toml", toml), ("main.stl", "A I 0.0\n"), ("blocks/valve.scl", "%M0.0 := TRUE;\n")]);
        let helps = |path: &Path| -> Vec<String> {
            read(&[path.to_path_buf()]).diagnostics.into_iter().filter_map(|message| message.help).collect()
        };
        let project = helps(folder.path());
        assert_eq!(project[..2], ["is `main.stl` meant?", "is `blocks/valve.scl` meant?"]);
        assert!(project[2].contains("relative to the folder"), "{}", project[2]);
        assert!(helps(&folder.path().join("mian.stl"))[0].ends_with("main.stl` meant?"));
        assert!(helps(&folder.path().join("main.scl"))[0].ends_with("main.stl` meant?"));
        assert!(helps(&folder.path().join("gone.stl"))[0].contains("check the name"));
    }

    #[test]
    fn a_project_of_a_tool_is_told_with_its_export() {
        let folder = folder(&[("a.s7p", "A I 0.0\n"), ("a.zap15", "x"), ("a.mwp", "x")]);
        for (name, words) in
            [("a.s7p", "Generate Source"), ("a.zap15", "Generate source from blocks"), ("a.mwp", ".awl")]
        {
            let read = read(&[folder.path().join(name)]);
            assert_eq!(read.diagnostics[0].code, Code::NotASource, "{name}");
            assert!(read.diagnostics[0].help.as_ref().is_some_and(|help| help.contains(words)), "{name}");
        }
    }

    #[test]
    fn a_named_file_must_be_a_source() {
        let folder = folder(&[("notes.md", "# Notes\n\nThis is prose that explains the program.\n")]);
        fs::write(folder.path().join("other.xml"), "<?xml version=\"1.0\"?>\n<html/>\n").unwrap();
        let codes = |path: &str| -> Vec<Code> {
            read(&[folder.path().join(path)]).diagnostics.iter().map(|message| message.code).collect()
        };
        assert_eq!(codes("other.xml"), [Code::NotASource]);
        assert_eq!(codes("missing.stl"), [Code::Unreadable]);
        assert_eq!(codes("notes.md"), []);
    }

    #[test]
    fn a_scenario_is_no_source() {
        let folder =
            folder(&[("a.stl", "A I 0.0\n"), ("a.scenario.toml", "[[at]]\ncycle = 1\nset = { \"I0.0\" = 1 }\n")]);
        let named = read(&[folder.path().join("a.stl"), folder.path().join("a.scenario.toml")]);
        let codes: Vec<Code> = named.diagnostics.iter().map(|message| message.code).collect();
        assert_eq!((named.units.len(), codes), (1, vec![Code::NotASource]));
        let all = read(&[folder.path().to_path_buf()]);
        assert_eq!((all.units.len(), all.diagnostics.len()), (1, 0));
    }

    /// Reading a pipe would wait forever.
    #[cfg(unix)]
    #[test]
    fn what_is_no_file_is_not_read() {
        use std::os::unix::fs::symlink;
        let folder = folder(&[("a.stl", "A I 0.0\n")]);
        let pipe = folder.path().join("pipe.stl");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.is_ok_and(|status| status.success()));
        symlink(folder.path(), folder.path().join("again")).unwrap();
        symlink("loop.stl", folder.path().join("loop.stl")).unwrap();
        symlink("/dev/zero", folder.path().join("zero.stl")).unwrap();
        symlink("/proc/kmsg", folder.path().join("kernel.stl")).unwrap();
        for name in ["pipe.stl", "loop.stl", "zero.stl", "kernel.stl"] {
            let read = read(&[folder.path().join(name)]);
            let codes: Vec<Code> = read.diagnostics.iter().map(|message| message.code).collect();
            assert_eq!(codes, [Code::Unreadable], "{name}");
        }
        let all = read(&[folder.path().to_path_buf()]);
        let codes: Vec<Code> = all.diagnostics.iter().map(|message| message.code).collect();
        assert_eq!((all.units.len(), codes), (1, vec![Code::NotRead]));
        let help = all.diagnostics[0].help.clone().unwrap_or_default();
        for name in ["pipe.stl", "loop.stl", "zero.stl", "kernel.stl", "again"] {
            assert!(help.contains(name), "{name}: {help}");
        }
    }

    #[test]
    fn a_project_names_its_sources() {
        let folder = folder(&[
            ("plc.toml", "name = \"tank\"\nsources = [\"a.stl\", \"gone.stl\"]\n"),
            ("a.stl", "A I 0.0\n"),
            ("b.stl", "A I 0.0\n"),
        ]);
        let read = read(&[folder.path().to_path_buf()]);
        assert_eq!((read.name.as_str(), read.units.len()), ("tank", 1));
        assert_eq!(read.diagnostics[0].code, Code::Project);
    }
}
