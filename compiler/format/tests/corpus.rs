//! Every source under tests/ and samples/ that parses keeps its words and its tree when it is laid out, and a second
//! time nothing changes.

use std::fs;
use std::path::{Path, PathBuf};

use plcc_diag::FileId;
use plcc_format::{Left, format};
use plcc_syntax::{Language, decode};

fn files_below(folder: &Path, out: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path()).collect();
    entries.sort();
    for path in entries {
        match path.is_dir() {
            true => files_below(&path, out),
            false => out.push(path),
        }
    }
}

#[test]
fn every_source_keeps_its_words_and_its_layout() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut files = Vec::new();
    for folder in ["tests", "samples", "stdlib"] {
        files_below(&root.join(folder), &mut files);
    }
    let (mut checked, mut wrong) = (0, Vec::new());
    for path in files {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        if !["stl", "awl", "scl", "gr7", "s7dcl", "st", "db", "udt"].contains(&extension.as_str()) {
            continue;
        }
        let text = decode(&fs::read(&path).expect("the file is there"));
        let hint = Language::of_extension(&extension);
        let made = match format(FileId::default(), &text, hint) {
            Ok(made) => made,
            Err(Left::Errors(_) | Left::NotText) => continue,
            Err(Left::Fault(what)) => {
                wrong.push(format!("{}: {what}", path.display()));
                continue;
            }
        };
        checked += 1;
        match format(FileId::default(), &made, hint) {
            Ok(again) if again == made => {}
            Ok(again) => {
                let line = made.lines().zip(again.lines()).find(|(one, other)| one != other);
                wrong.push(format!("{}: another layout the second time: {line:?}", path.display()));
            }
            Err(why) => wrong.push(format!("{}: cannot be laid out again: {why:?}", path.display())),
        }
    }
    assert!(wrong.is_empty(), "{} of {checked}\n{}", wrong.len(), wrong.join("\n"));
    assert!(checked > 1200, "only {checked} files were checked");
}

#[test]
fn samples_are_laid_out() {
    let mut files = Vec::new();
    files_below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples"), &mut files);
    for path in files {
        let extension = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        if ["stl", "awl", "scl", "gr7", "s7dcl"].contains(&extension.as_str()) {
            let text = fs::read_to_string(&path).expect("samples are UTF-8");
            let made = format(FileId::default(), &text, Language::of_extension(&extension)).expect("samples parse");
            assert!(made == text, "{} is not laid out: run `plcc fmt samples`", path.display());
        }
    }
}
