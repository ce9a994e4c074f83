//! Round trips of `plcc convert`: what is written reads back to the same tree, with its comments, and does the same.
//!
//! - `text`: STL, SCL, SIMATIC SD and GRAPH; `charts`: charts of XML as sources and as STL; `xml`: SimaticML; `plcopen`: PLCopen XML.
//! - `boxes`: random boxes of STL as LAD and FBD.
//! - `networks`: LAD and FBD as STL; `from_scl`: SCL and GRAPH as STL; `drawn`: STL as LAD and FBD, and LAD as FBD.

mod boxes;
mod charts;
mod drawn;
mod from_scl;
mod networks;
mod plcopen;
mod text;
mod xml;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use plcc_diag::{Diagnostic, FileId};
use plcc_syntax::ast::SourceUnit;
use plcc_syntax::stl::Mnemonics;
use plcc_syntax::{ParseOptions, ast_text, stl};
use plcc_tests::{files, root, tests_folder};

/// Sources with that extension, of tests that compile and of the samples.
pub fn sources(extension: &str) -> Vec<PathBuf> {
    let mut found = files(&tests_folder().join("run"), extension);
    found.extend(files(&tests_folder().join("parse"), extension));
    found.extend(files(&root().join("samples"), extension));
    found
}

/// The tree as text, without its set of mnemonics.
pub fn tree(unit: &SourceUnit) -> String {
    ast_text(unit).lines().skip(1).collect::<Vec<_>>().join("\n")
}

/// How often each comment is there.
pub fn comments(text: &str, of: &[plcc_syntax::front::Comment]) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for comment in of {
        for line in text[comment.range()].lines() {
            let words: Vec<&str> = line.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
            *counts.entry(words.join(" ")).or_default() += usize::from(!words.is_empty());
        }
    }
    counts.retain(|_, count| *count > 0);
    counts
}

pub fn has_errors(messages: &[Diagnostic]) -> bool {
    messages.iter().any(Diagnostic::is_error)
}

pub fn parsed(text: &str, mnemonics: Option<Mnemonics>) -> (SourceUnit, Vec<Diagnostic>) {
    stl::parse(FileId::default(), text, &ParseOptions { mnemonics, pragmas: false })
}

/// A document without the blocks at these places, with their attributes.
pub fn without(text: &str, blocks: &[std::ops::Range<usize>]) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for block in blocks {
        let before = text[..block.start].trim_end();
        let start = match before.ends_with('}') {
            true => before.rfind('{').unwrap_or(block.start),
            false => block.start,
        };
        bytes[start..block.end].iter_mut().filter(|byte| **byte != b'\n').for_each(|byte| *byte = b' ');
    }
    String::from_utf8(bytes).expect("whole characters were replaced")
}

/// All files below a folder.
pub fn everything(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).into_iter().flatten().flatten().map(|one| one.path()).collect();
    entries.sort();
    entries.into_iter().flat_map(|path| if path.is_dir() { everything(&path) } else { vec![path] }).collect()
}
