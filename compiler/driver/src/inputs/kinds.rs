//! What a file is, by its name and its text.

use std::fs;
use std::path::Path;

use crate::content::foreign::{self, Foreign};
use crate::content::{self, Content};
use crate::pipeline;
use crate::project;

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
pub(super) const TEXTS_SUFFIX: &str = "s7res";

/// What a file contains. For a text that may be prose, the file extension decides.
pub(super) fn content_of(path: &Path, text: &str) -> Content {
    if path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case(TEXTS_SUFFIX)) {
        return Content::Other("texts of a block");
    }
    if path.file_name().is_some_and(|name| name == project::FILE_NAME) {
        return Content::Other("the settings of a project");
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
pub(super) fn content_in_folder(path: &Path, text: &str) -> Content {
    let is_text_of_block = path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case(TEXTS_SUFFIX));
    if is_text_of_block || is_toml(path) {
        return content_of(path, text);
    }
    content::in_folder(path, text, pipeline::language_of(&path.display().to_string()).is_some())
}

pub(super) fn is_toml(path: &Path) -> bool {
    path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("toml"))
}
