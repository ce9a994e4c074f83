//! Files and folders on the disk, and their texts.

use std::fs;
use std::path::{Path, PathBuf};

use plcc_runtime::files::regular;
use plcc_syntax::CodePage;

/// Text of a file, decoded.
pub fn read_text(path: &Path) -> std::io::Result<String> {
    read_text_as(path, None)
}

pub(super) fn read_text_as(path: &Path, code_page: Option<CodePage>) -> std::io::Result<String> {
    if !path.is_dir() {
        regular(path)?;
    }
    Ok(plcc_syntax::decode_as(&fs::read(path)?, code_page))
}

/// What is wrong with a file, without the number of the error and the name of a temporary file.
pub fn reason(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
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
pub(super) fn stem(path: &Path) -> String {
    let full = if path.file_name().is_none() { fs::canonicalize(path).unwrap_or_default() } else { path.to_path_buf() };
    let name = if full.is_dir() { full.file_name() } else { full.file_stem() };
    name.map_or_else(|| "program".to_string(), |name| name.to_string_lossy().into_owned())
}
