//! Finds the file that was meant by a name that does not exist.

use std::path::Path;

use plcc_binding::similar;

use crate::inputs::{entries, files_below};

/// The file of the same folder whose name resembles that of `path`.
pub fn beside(path: &Path) -> Option<String> {
    let wanted = path.file_name()?.to_string_lossy().into_owned();
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let names: Vec<String> = entries(folder)
        .iter()
        .filter_map(|path| path.file_name().map(|name| name.to_string_lossy().into_owned()))
        .collect();
    // `main.scl` for `main.stl`: the same program in another language.
    let stem = |name: &str| name.rsplit_once('.').map_or(name.to_owned(), |(stem, _)| stem.to_owned());
    let near = similar(&wanted, names.iter().map(String::as_str))
        .or_else(|| names.iter().map(String::as_str).find(|name| stem(name).eq_ignore_ascii_case(&stem(&wanted))))?;
    Some(path.with_file_name(near).display().to_string())
}

/// The file below `folder` whose path resembles `name`, or that has this name in another folder.
pub fn below(folder: &Path, name: &str) -> Option<String> {
    let files: Vec<String> = files_below(folder)
        .iter()
        .filter_map(|path| path.strip_prefix(folder).ok().map(|path| path.to_string_lossy().replace('\\', "/")))
        .collect();
    let last = |path: &str| path.rsplit('/').next().unwrap_or(path).to_lowercase();
    let near = similar(name, files.iter().map(String::as_str))
        .or_else(|| files.iter().map(String::as_str).find(|path| last(path) == last(name)))?;
    Some(near.to_owned())
}
