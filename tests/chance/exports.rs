//! Exports in XML with elements cut out, doubled and exchanged, and with values exchanged: checking them ends soon, without a panic, every
//! message has a place, and a program without errors lowers to IR that the verifier and the passes accept.

use std::path::PathBuf;

use plcc_diag::{SourceFile, SourceMap};
use plcc_driver::inputs::{self, Read};
use plcc_driver::pipeline::Settings;
use plcc_tests::random::setting;
use plcc_tests::robust::{self, Reach};
use plcc_tests::{folders, projects, tests_folder};
use proptest::prelude::*;
use proptest::sample::Index;

/// A change of an export. Indices choose an element or attribute of the file.
#[derive(Clone, Debug)]
enum Change {
    Remove(Index),
    Double(Index),
    /// Two elements change places.
    Swap(Index, Index),
    /// An attribute has the value of another one.
    Value(Index, Index),
    /// An element has the text of another one.
    Text(Index, Index),
    /// An attribute or text is a word.
    Word(Index, usize),
}

/// Values that are nowhere in the files.
const WORDS: [&str; 12] = [
    "",
    "0",
    "-1",
    "99999999999999999999",
    "4294967295",
    "ä 漢",
    "(*",
    "'",
    "Array[1..0] of Int",
    "Void",
    "O",
    "Variant",
];

fn change() -> impl Strategy<Value = Change> {
    let index = any::<Index>;
    prop_oneof![
        index().prop_map(Change::Remove),
        index().prop_map(Change::Double),
        (index(), index()).prop_map(|(a, b)| Change::Swap(a, b)),
        (index(), index()).prop_map(|(a, b)| Change::Value(a, b)),
        (index(), index()).prop_map(|(a, b)| Change::Text(a, b)),
        (index(), 0..WORDS.len()).prop_map(|(a, word)| Change::Word(a, word)),
    ]
}

/// The changed text; as it was if the change fits nowhere.
fn changed(text: &str, change: &Change) -> String {
    let Ok(document) = roxmltree::Document::parse(text) else { return text.to_string() };
    let root = document.root_element();
    let elements: Vec<_> = root.descendants().filter(|node| node.is_element() && *node != root).collect();
    let values: Vec<_> = elements.iter().flat_map(|node| node.attributes()).map(|one| one.range_value()).collect();
    let texts: Vec<_> = elements.iter().filter_map(|node| node.first_child()).filter(|node| node.is_text()).collect();
    let texts: Vec<_> = texts.iter().map(|node| node.range()).collect();
    if elements.is_empty() || values.is_empty() || texts.is_empty() {
        return text.to_string();
    }
    let element = |index: &Index| elements[index.index(elements.len())].range();
    let mut out = text.to_string();
    match change {
        Change::Remove(at) => out.replace_range(element(at), ""),
        Change::Double(at) => out.insert_str(element(at).end, &text[element(at)]),
        Change::Swap(a, b) => {
            let (a, b) = (element(a), element(b));
            let (first, second) = if a.start < b.start { (a, b) } else { (b, a) };
            if first.end <= second.start {
                out.replace_range(second.clone(), &text[first.clone()]);
                out.replace_range(first, &text[second]);
            }
        }
        Change::Value(a, b) => {
            out.replace_range(values[a.index(values.len())].clone(), &text[values[b.index(values.len())].clone()]);
        }
        Change::Text(a, b) => {
            out.replace_range(texts[a.index(texts.len())].clone(), &text[texts[b.index(texts.len())].clone()]);
        }
        Change::Word(at, word) => {
            let place = at.index(values.len() + texts.len());
            let place = values.get(place).unwrap_or_else(|| &texts[place - values.len()]);
            out.replace_range(place.clone(), WORDS[*word]);
        }
    }
    out
}

/// The folders with exports.
fn programs() -> Vec<PathBuf> {
    let twins = folders(&tests_folder().join("twins"));
    let carriers = twins.iter().flat_map(|twin| ["xml", "open"].map(|carrier| twin.join(carrier)));
    let mut found: Vec<PathBuf> = carriers.filter(|folder| folder.is_dir()).collect();
    let exports = ["lad-fbd", "graph", "scl/exports"].map(|folder| projects(&tests_folder().join("run").join(folder)));
    let has_xml = |folder: &PathBuf| {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.into_iter().any(|entry| entry.path().extension().is_some_and(|extension| extension == "xml"))
    };
    found.extend(exports.into_iter().flatten().filter(has_xml));
    found
}

/// A program with changes in one of its exports.
fn read_changed(folder: PathBuf, file: Index, changes: &[Change]) -> Read {
    let mut read = inputs::read(&[folder]);
    let chosen = (!read.units.is_empty()).then(|| read.units[file.index(read.units.len())]);
    let mut sources = SourceMap::default();
    for (id, source) in read.sources.files() {
        let mut text = source.text.clone();
        if Some(id) == chosen {
            text = changes.iter().fold(text, |text, change| changed(&text, change));
        }
        sources.add(SourceFile::new(source.name.clone(), text));
    }
    read.sources = sources;
    read
}

fn settings() -> Settings {
    Settings { require_main: true, ..Settings::default() }
}

/// How many changed programs: `PLCC_RANDOM_EXPORTS`, else as many as some seconds take.
fn cases() -> u32 {
    u32::try_from(setting("PLCC_RANDOM_EXPORTS", 60)).unwrap_or(u32::MAX)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(), max_shrink_iters: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn changed_exports_are_checked(
        program: Index,
        file: Index,
        changes in prop::collection::vec(change(), 1..5),
    ) {
        let programs = programs();
        let folder = programs[program.index(programs.len())].clone();
        let read = read_changed(folder.clone(), file, &changes);
        let result = plcc_driver::on_large_stack(move || robust::endures(read, &settings(), Reach::Ir));
        let result = result.and_then(|result| result);
        prop_assert!(result.is_ok(), "{}: {}", folder.display(), result.err().unwrap_or_default());
    }
}
