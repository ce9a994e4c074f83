//! Each language names only what is below it.

use std::fs;
use std::path::{Path, PathBuf};

/// The folders and files of `bind`, each above the ones before it.
const LAYERS: [&str; 10] =
    ["trees", "globals", "declarations", "stl", "scl", "network", "chart", "review", "program", "partial"];

/// Test code may start from the entry.
const TESTS: [&str; 3] = ["tests", "tests.rs", "testing.rs"];

#[test]
fn no_layer_names_one_above() {
    let bind = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../compiler/program")).join("src/bind");
    let mut wrong = Vec::new();
    for path in files(&bind) {
        let place = path.strip_prefix(&bind).expect("the file is in this folder").with_extension("");
        let mut module: Vec<&str> = place.iter().filter_map(|part| part.to_str()).collect();
        module.pop_if(|last| *last == "mod");
        let Some(name) = module.first().copied() else { continue };
        let layer = LAYERS.iter().position(|layer| *layer == name).unwrap_or_else(|| panic!("{name} is in no layer"));
        let text = fs::read_to_string(&path).expect("sources can be read");
        for named in named_modules(&text, module.len()) {
            match LAYERS.iter().position(|layer| *layer == named) {
                Some(other) if other <= layer => {}
                _ => wrong.push(format!("{} names bind::{named}", place.display())),
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The types that hold a layer together, and the layer that alone adds methods to each.
const OWNERS: [(&str, &str); 6] = [
    ("Globals", "globals"),
    ("Declarations", "declarations"),
    ("StlBinder", "stl"),
    ("SclBinder", "scl"),
    ("NetworkBinder", "network"),
    ("ChartBinder", "chart"),
];

#[test]
fn no_layer_adds_methods_to_one_below() {
    let bind = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../compiler/program")).join("src/bind");
    let mut wrong = Vec::new();
    for path in files(&bind) {
        let place = path.strip_prefix(&bind).expect("the file is in this folder");
        let text = fs::read_to_string(&path).expect("sources can be read");
        for line in text.lines().filter(|line| line.starts_with("impl")) {
            let owner = OWNERS.iter().find(|(ty, _)| line.contains(&format!(" {ty}<")));
            if owner.is_some_and(|(_, layer)| !place.starts_with(layer)) {
                wrong.push(format!("{}: {line}", place.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn what_counts_as_naming() {
    let names = |text| named_modules(text, 2);
    assert_eq!(names("use crate::bind::scl::value::Value;"), ["scl"]);
    assert_eq!(names("use crate::bind::{chart::Charts, bind};"), ["chart", "bind"]);
    assert_eq!(names("use super::value; let a = super::super::network::draw();"), ["network"]);
    assert_eq!(names("use super::super::{scl::{self, value}, stl};"), ["scl", "stl"]);
    assert!(names("/// See [`crate::bind::partial`].\nuse super::{a, b};").is_empty());
}

/// Sources below `folder`, without those of tests.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("the folder can be read").map(|entry| entry.expect("an entry").path());
    let is_test = |path: &PathBuf| {
        path.file_name()
            .and_then(|name| name.to_str())
            .is_some_and(|name| TESTS.contains(&name) || name.ends_with("_tests.rs"))
    };
    let kept: Vec<PathBuf> = entries.filter(|path| !is_test(path)).collect();
    let (folders, files): (Vec<PathBuf>, Vec<PathBuf>) = kept.into_iter().partition(|path| path.is_dir());
    let own = files.into_iter().filter(|path| path.extension().is_some_and(|ending| ending == "rs"));
    own.chain(folders.iter().flat_map(|folder| self::files(folder))).collect()
}

/// What a module at `depth` below `bind` names in `bind` itself.
fn named_modules(text: &str, depth: usize) -> Vec<String> {
    let is_code = |line: &&str| !line.trim_start().starts_with("//");
    let code: Vec<&str> = text.lines().filter(is_code).collect();
    let code = code.join("\n");
    let mut names = Vec::new();
    for prefix in ["crate::bind::".to_string(), "super::".repeat(depth)] {
        for (at, _) in code.match_indices(&prefix) {
            // Part of a longer path that begins further up.
            if code[..at].ends_with("::") {
                continue;
            }
            names.extend(first_names(&code[at + prefix.len()..]));
        }
    }
    names
}

/// The first names of a path, or of the paths in braces.
fn first_names(path: &str) -> Vec<String> {
    let name = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let Some(list) = path.strip_prefix('{') else { return vec![name(path)] };
    let mut names = Vec::new();
    let (mut nesting, mut begins) = (0, true);
    for (at, c) in list.char_indices() {
        match c {
            '}' if nesting == 0 => break,
            '{' => nesting += 1,
            '}' => nesting -= 1,
            ',' if nesting == 0 => begins = true,
            c if begins && !c.is_whitespace() => {
                names.push(name(&list[at..]));
                begins = false;
            }
            _ => {}
        }
    }
    names
}
