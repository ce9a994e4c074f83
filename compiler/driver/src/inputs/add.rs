//! Adds files, folders and projects to a program that is being read.

use std::fs;
use std::path::{Path, PathBuf};

use plcc_diag::{Code, Diagnostic, FileId, SourceFile, Span};
use plcc_runtime::files::regular;
use plcc_runtime::records::store;
use plcc_syntax::Language;

use super::Read;
use super::disk::{entries, files_below, read_text, read_text_as, reason, stem};
use super::kinds::{TEXTS_SUFFIX, content_in_folder, content_of, is_toml};
use crate::content::Content;
use crate::content::foreign;
use crate::near;
use crate::pipeline;
use crate::project;
use crate::sheets;

/// Whether a file that is not a source is a mistake.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Wanted {
    /// The user named it.
    Yes,
    /// It is only in a folder.
    No,
}

pub(super) fn add_file(read: &mut Read, path: &Path, wanted: Wanted) {
    if wanted == Wanted::No
        && let Err(why) = regular(path)
    {
        return read.unread.push((path.to_path_buf(), reason(&why)));
    }
    if path.is_file() && path.canonicalize().is_ok_and(|whole| !read.seen.insert(whole)) {
        return;
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
            if is_toml(path) {
                let help = instead_of_toml(path);
                return read.report(Code::NotASource, path, title, &help);
            }
            let help = "give a source in STL (S7-200 or S7-300/400), SCL, SIMATIC SD or GRAPH, blocks exported as XML, or a symbol table";
            read.report(Code::NotASource, path, title, help);
        }
    }
}

/// The folder of the project above a file or folder, as the command line names it.
pub(crate) fn project_above(path: &Path) -> Option<String> {
    let is_project = |folder: &&Path| folder.join(project::FILE_NAME).is_file();
    let folder = path.ancestors().skip(1).find(is_project)?;
    Some(match folder.as_os_str().is_empty() {
        true => ".".to_string(),
        false => folder.display().to_string(),
    })
}

/// What to give instead of a file in TOML, which belongs to a project or is for a flag.
fn instead_of_toml(path: &Path) -> String {
    let Some(folder) = project_above(path) else {
        return format!("give the sources; `--scenario {}` plays a scenario with them", path.display());
    };
    match path.file_name() {
        Some(name) if name == project::FILE_NAME => {
            format!("give the folder of the project, `{folder}`: plcc reads this file there")
        }
        _ => format!(
            "give the folder of the project, `{folder}`: `plcc test {folder}` plays its scenarios, \
             `plcc run {folder} --scenario {}` this one",
            path.display()
        ),
    }
}

pub(super) fn add_folder(read: &mut Read, folder: &Path) {
    let before = read.units.len();
    let files = files_below(folder);
    let is_project = |path: &&PathBuf| path.file_name().is_some_and(|name| name == project::FILE_NAME);
    let projects: Vec<&PathBuf> = files.iter().filter(is_project).collect();
    if let [_, .., last] = projects.as_slice() {
        let title = format!("the folder `{}` contains {} projects", folder.display(), projects.len());
        let one = last.parent().unwrap_or(folder).display();
        return read.report(Code::Project, folder, title, &format!("give the folder of one of them, such as `{one}`"));
    }
    let data = folder.join(store::folder(None, None));
    for path in files.iter().filter(|path| !path.starts_with(&data)) {
        add_file(read, path, Wanted::No);
    }
    if read.units.len() == before && !has_source_in(read, folder) {
        let title = format!("the folder `{}` contains no PLC source", folder.display());
        read.report(Code::NotASource, folder, title, "give a file, a folder of sources, or a folder with a plc.toml");
    }
}

/// Whether a source was read that lies in the folder.
fn has_source_in(read: &Read, folder: &Path) -> bool {
    let whole = |path: &Path| path.canonicalize().ok();
    let names = read.units.iter().map(|unit| whole(Path::new(&read.sources.file(*unit).name)));
    whole(folder).is_some_and(|folder| names.flatten().any(|path| path.starts_with(&folder)))
}

pub(super) fn add_project(read: &mut Read, folder: &Path) {
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
    let (mut project, diagnostics) = project::parse(file, &source);
    read.diagnostics.extend(diagnostics);
    read.name = project.name.clone().unwrap_or_else(|| stem(folder));
    match &project.sources {
        None if project.unread => {}
        None => {
            // Files that runs of the program have written, and its tests, are not part of it.
            let data = store::folder(None, project.config.data_folder.as_deref());
            let mut apart = vec![folder.join("tests"), folder.join(data)];
            apart.retain(|other| !folder.starts_with(other));
            let is_part = |path: &Path| {
                !apart.iter().any(|other| path.starts_with(other))
                    && path.file_name() != Some(project::FILE_NAME.as_ref())
            };
            for path in files_below(folder).iter().filter(|path| is_part(path)) {
                add_file(read, path, Wanted::No);
            }
        }
        Some(sources) => sources.iter().for_each(|source| add_named(read, folder, source)),
    }
    project.symbols.iter().for_each(|table| add_named(read, folder, table));
    if project.sources.is_some() && project.symbols.is_empty() && read.tables.is_empty() {
        project.tables_beside = tables_in(folder);
    }
    if !project.axes.is_empty() {
        let name = format!("{}{AXES_ENDING}", path.display());
        let file = read.sources.add(SourceFile::new(name, project.axes.clone()));
        read.units.push(file);
    }
    read.project = Some(project);
}

/// The names of symbol tables and workbooks in a folder.
fn tables_in(folder: &Path) -> Vec<String> {
    const ENDINGS: [&str; 5] = ["sdf", "asc", "seq", "dif", "xlsx"];
    let is_table = |path: &PathBuf| {
        let ending = path.extension().and_then(|ending| ending.to_str());
        ending.is_some_and(|ending| ENDINGS.iter().any(|own| own.eq_ignore_ascii_case(ending)))
    };
    let tables = entries(folder).into_iter().filter(is_table);
    tables.filter_map(|path| Some(path.file_name()?.to_str()?.to_owned())).collect()
}

/// A file or folder that plc.toml names.
fn add_named(read: &mut Read, folder: &Path, (name, span): &(String, Span)) {
    let path = folder.join(name);
    if path.is_dir() {
        files_below(&path).iter().for_each(|path| add_file(read, path, Wanted::No));
    } else if path.is_file() {
        add_file(read, &path, Wanted::Yes);
    } else {
        let message = Diagnostic::new(Code::Project, *span, format!("`{name}` {NOT_THERE}"));
        read.diagnostics.push(match near::below(folder, name) {
            _ if name.contains(['*', '?']) => {
                let above = name.rsplit_once(['/', '\\']).map_or(".", |(above, _)| above);
                message.help(format!(
                    "a list has no patterns: name each file, or the folder with all of them, `\"{above}\"`"
                ))
            }
            Some(near) => message.help(format!("is `{near}` meant?")),
            None => message.help("names are relative to the folder of plc.toml"),
        });
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

/// What follows the path of plc.toml in the name of the source that its axes are.
pub(crate) const AXES_ENDING: &str = " (axes).scl";

/// How the title of the message ends about a file that plc.toml names and the project does not have.
pub(crate) const NOT_THERE: &str = "is not a file or folder in the project";
