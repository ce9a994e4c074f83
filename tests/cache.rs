//! Code that is kept from build to build: it is used where it can be, and never changes what is built.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use plcc_diag::SourceFile;
use plcc_driver::cache::Cache;
use plcc_driver::cli::Level;
use plcc_driver::inputs::Read;
use plcc_driver::pipeline::{self, Bound, Settings};
use plcc_tests::plants::plant;

/// Enough for code to be kept, in more blocks than a small program has.
const LINES: usize = 20_000;

fn build(text: &str, cache: Option<&Cache>) -> Vec<u8> {
    pipeline::object(pipeline::lower_begun(&bound(text), Level::O2), cache).expect("it compiles")
}

fn bound(text: &str) -> Bound {
    let mut read = Read { name: "plant".to_string(), ..Read::default() };
    read.units.push(read.sources.add(SourceFile::new("plant.stl", text)));
    let bound = pipeline::front(read, &Settings { require_main: true, ..Settings::default() });
    assert!(!bound.has_errors(), "{:?}", bound.diagnostics.first());
    bound
}

fn keys(cache: &Cache) -> HashSet<u128> {
    cache.read().keys().collect()
}

fn file_in(folder: &Path) -> PathBuf {
    let mut files = fs::read_dir(folder).expect("it was made").map(|file| file.expect("it can be read").path());
    let file = files.next().expect("something is kept");
    assert_eq!(files.next(), None);
    file
}

#[test]
fn a_build_with_kept_code_is_the_same() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::in_folder(folder.path(), Path::new("plant"));
    let before = plant(LINES, 1);
    let expected = build(&before, None);
    assert!(build(&before, Some(&cache)) == expected);
    let kept = keys(&cache);
    assert!(kept.len() > 50, "{}", kept.len());
    let bytes = fs::read(file_in(folder.path())).expect("it is there");
    assert!(build(&before, Some(&cache)) == expected);
    assert!(fs::read(file_in(folder.path())).expect("it is there") == bytes);

    // A value, and a line more in a block in the middle.
    let value = plant(LINES, 2);
    let middle = before.len() / 2;
    let at = middle + before[middle..].find("TITLE = Valve").expect("there are valves");
    let line = at + before[at..].find('\n').expect("lines end") + 1;
    let added = format!("{}      L     MW 4;\n      T     MW 6;\n{}", &before[..line], &before[line..]);
    for changed in [value, added] {
        let expected = build(&changed, None);
        build(&before, Some(&cache));
        assert!(build(&changed, Some(&cache)) == expected);
        let made = keys(&cache).difference(&kept).count();
        assert!((1..=2).contains(&made), "{made} functions were compiled");
    }
}

#[test]
fn passes_that_run_while_code_is_lowered_make_the_same() {
    let bound = bound(&plant(LINES, 1));
    let whole = |lowered| pipeline::object(lowered, None).expect("it compiles");
    assert!(whole(pipeline::lower_begun(&bound, Level::O2)) == whole(pipeline::lower(&bound, Level::O2)));
}

#[test]
fn other_programs_share_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let caches = ["one", "two"].map(|name| Cache::in_folder(folder.path(), Path::new(name)));
    let text = plant(LINES, 1);
    let expected = build(&text, Some(&caches[0]));
    assert_eq!(keys(&caches[1]).len(), 0);
    assert!(build(&text, Some(&caches[1])) == expected);
    assert_eq!(keys(&caches[0]), keys(&caches[1]));
}

#[test]
fn damaged_files_are_made_anew() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::in_folder(folder.path(), Path::new("plant"));
    let text = plant(LINES, 1);
    let expected = build(&text, Some(&cache));
    let path = file_in(folder.path());
    let whole = fs::read(&path).expect("it is there");
    // The head, the table, code, the end, everything.
    for at in [0, 9, 20, 40, whole.len() / 2, whole.len() - 1] {
        let mut damaged = whole.clone();
        damaged[at] ^= 0x10;
        fs::write(&path, damaged).expect("own file");
        assert!(build(&text, Some(&cache)) == expected, "{at}");
        assert!(fs::read(&path).expect("it is there") == whole, "{at}");
    }
    for rest in [&whole[..whole.len() / 3], &[], b"something else"] {
        fs::write(&path, rest).expect("own file");
        assert!(build(&text, Some(&cache)) == expected);
        assert!(fs::read(&path).expect("it is there") == whole);
    }
}

#[test]
fn a_folder_that_cannot_be_written_does_not_matter() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("file");
    fs::write(&file, "").expect("the folder can be written");
    let text = plant(LINES, 1);
    assert!(build(&text, Some(&Cache::in_folder(&file, Path::new("plant")))) == build(&text, None));
}

#[test]
fn builds_at_the_same_time_do_not_disturb_each_other() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::in_folder(folder.path(), Path::new("plant"));
    let texts = [plant(LINES, 1), plant(LINES, 2)];
    let expected = texts.each_ref().map(|text| build(text, None));
    std::thread::scope(|scope| {
        for (text, expected) in texts.iter().zip(&expected) {
            let cache = &cache;
            scope.spawn(move || (0..3).for_each(|_| assert!(build(text, Some(cache)) == *expected)));
        }
    });
    assert!(fs::read_dir(folder.path()).expect("it is there").count() == 1, "no temporary file is left");
}
