//! Sources of all languages with random damage: words and lines cut out, doubled, exchanged, numbers at their ends, brackets torn, files cut
//! off and spliced. Checking, compiling and running them ends soon, without a panic.
//!
//! `PLCC_RANDOM_SOURCES=N` sets how many (200), `PLCC_RANDOM_SOURCES_FROM` the number of the first, and `PLCC_RANDOM_SOURCES_FOLDER` a further folder
//! whose sources are damaged, too. `PLCC_RANDOM_FILES=N` sets how many other files (100), `PLCC_RANDOM_FILES_FROM` the number of the first.

use std::path::{Path, PathBuf};
use std::time::Duration;

use plcc_diag::SourceFile;
use plcc_driver::inputs::Read;
use plcc_driver::pipeline::Settings;
use plcc_tests::random::{Random, setting};
use plcc_tests::robust::{self, Reach};
use plcc_tests::{damage, files, root, tests_folder};

mod files;

/// Processor time that no source takes.
const LIMIT: Duration = Duration::from_secs(20);

/// Endings of the sources.
const ENDINGS: [&str; 6] = ["stl", "awl", "scl", "s7dcl", "gr7", "xml"];

/// All sources: those of the project, and those of a folder that was named.
fn sources() -> Vec<PathBuf> {
    let mut folders: Vec<PathBuf> =
        ["run", "check", "parse", "messages"].iter().map(|name| tests_folder().join(name)).collect();
    folders.push(root().join("samples"));
    folders.extend(std::env::var("PLCC_RANDOM_SOURCES_FOLDER").map(PathBuf::from));
    folders.iter().flat_map(|folder| ENDINGS.iter().flat_map(|ending| files(folder, ending))).collect()
}

/// The source of number `seed`: its ending and its text.
fn damaged(seed: u64, sources: &[PathBuf]) -> (PathBuf, String) {
    let mut random = Random::new(seed);
    let path = &sources[random.below(sources.len())];
    let read = |path: &Path| String::from_utf8_lossy(&std::fs::read(path).unwrap_or_default()).into_owned();
    let text = read(path);
    let alike: Vec<&PathBuf> = sources.iter().filter(|other| other.extension() == path.extension()).collect();
    let other = read(alike[random.below(alike.len())]);
    (path.clone(), damage::damaged(&mut random, &text, &other, damage::WORDS))
}

#[test]
fn damaged_sources_do_no_harm() {
    let sources = sources();
    let (from, count) = (setting("PLCC_RANDOM_SOURCES_FROM", 0), setting("PLCC_RANDOM_SOURCES", 200));
    let mut failures = Vec::new();
    let mut good = 0;
    for seed in from..from + count {
        let (path, text) = damaged(seed, &sources);
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let mut read = Read { name: "damaged".to_string(), ..Read::default() };
        let file = SourceFile::new(name, text.clone());
        read.units.push(read.sources.add(file));
        let settings = Settings { pragmas: true, partial: seed % 4 == 0, ..Settings::default() };
        let result = robust::within(LIMIT, move || robust::endures(read, &settings, Reach::Run));
        match result.and_then(|result| result) {
            Ok(is_good) => good += u64::from(is_good),
            Err(error) => {
                let folder = std::env::temp_dir().join("plcc-damaged");
                _ = std::fs::create_dir_all(&folder);
                let copy = folder.join(format!("{seed}.{}", path.extension().unwrap_or_default().to_string_lossy()));
                _ = std::fs::write(&copy, text);
                failures.push(format!("{seed} {} {}: {error}", path.display(), copy.display()));
                eprintln!("{}", failures[failures.len() - 1]);
            }
        }
    }
    assert!(failures.is_empty(), "{} of {count} failed:\n{}", failures.len(), failures.join("\n"));
    // The damage is not so great that all end in the parser.
    assert!(good * 50 > count, "only {good} of {count} were without errors");
}
