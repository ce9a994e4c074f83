//! Damaged files that accompany sources: symbol and tag tables of all forms, texts, settings, scenarios, and traces.

use std::path::{Path, PathBuf};
use std::time::Duration;

use plcc_driver::cli::Level;
use plcc_driver::inputs::{self, Read};
use plcc_driver::pipeline::{self, Settings};
use plcc_driver::plot;
use plcc_runtime::scenario::Scenario;
use plcc_tests::random::{Random, setting};
use plcc_tests::robust::{self, Reach};
use plcc_tests::{damage, files, projects, root, tests_folder};

/// Processor time that no file takes.
const LIMIT: Duration = Duration::from_secs(20);

/// Tables in forms without a file in the project, with their extensions.
const TABLES: &[(&str, &str)] = &[
    (
        "asc",
        "126,Start                   I       0.0 BOOL      the button                                                                      \r\n\
         126,Speed                   MW     10   INT       revolutions                                                                     \r\n\
         126,Wait                    T       5   TIMER                                                                                     \r\n\
         126,Recipe                  DB     10   DB     10                                                                                 \r\n",
    ),
    ("seq", "\tStart\tI 0.0\tthe button\r\n\tSpeed\tMW 10\trevolutions\r\n\tWait\tT 5\t\r\n"),
    (
        "dif",
        "TABLE\r\n0,1\r\n\"EXCEL\"\r\nVECTORS\r\n0,2\r\n\"\"\r\nTUPLES\r\n0,4\r\n\"\"\r\nDATA\r\n0,0\r\n\"\"\r\n-1,0\r\nBOT\r\n1,0\r\n\"Start\"\r\n1,0\r\n\"I 0.0\"\r\n1,0\r\n\"BOOL\"\r\n1,0\r\n\"button\"\r\n-1,0\r\nEOD\r\n",
    ),
    (
        "sdf",
        "\"Start\",\"I 0.0\",\"BOOL\",\"the button\"\r\n\"Speed\",\"MW 10\",\"INT\",\"\"\r\n\"Wait\",\"T 5\",\"TIMER\",\"\"\r\n",
    ),
    ("txt", "Start\tI0.0\tthe button\r\nSpeed\tVW10\t\r\nLimit\t16#7F\tconstant\r\n"),
    (
        "xml",
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Tagtable name=\"Tags\">\n  <Tag type=\"Bool\" hmiVisible=\"True\" remark=\"\" addr=\"%I0.0\">Start</Tag>\n  <Tag type=\"Int\" addr=\"%MW10\">Speed</Tag>\n  <Constant type=\"Int\" remark=\"\" value=\"5\">Limit</Constant>\n</Tagtable>\n",
    ),
];

/// A program that uses a table.
const PROGRAM: &str =
    "ORGANIZATION_BLOCK OB 1\nBEGIN\nA \"Start\"; = M 0.0; L \"Speed\"; T MW 20;\nEND_ORGANIZATION_BLOCK\n";

/// Files that accompany sources in a project.
fn companions(project: &Path) -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> =
        ["s7res", "sdf", "xlsx", "toml", "xml"].iter().flat_map(|ending| files_of(project, ending)).collect();
    found.retain(|path| {
        path.extension().is_none_or(|ending| ending != "xml")
            || std::fs::read_to_string(path).is_ok_and(|text| text.contains("TagTable") || text.contains("Tagtable"))
    });
    found
}

/// Files of a project with this ending, below it too.
fn files_of(project: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(project).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(files_of(&path, ending));
        } else if path.extension().is_some_and(|found| found == ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn copy_folder(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a folder can be made");
    for entry in std::fs::read_dir(from).into_iter().flatten().flatten() {
        let (path, target) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy_folder(&path, &target);
        } else {
            std::fs::copy(&path, &target).expect("a file can be copied");
        }
    }
}

/// The bytes with some of them changed, cut out or doubled.
fn damaged_bytes(random: &mut Random, bytes: &mut Vec<u8>) {
    for _ in 0..1 + random.below(6) {
        let at = random.below(bytes.len().max(1));
        match random.below(4) {
            0 => bytes.truncate(at),
            1 => _ = bytes.drain(at..(at + 1 + random.below(16)).min(bytes.len())),
            _ => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte = random.below(256) as u8;
                }
            }
        }
    }
}

/// Damages a file of the project in `folder`, and processes it like plcc.
fn endures(seed: u64, programs: &[PathBuf], traces: &[PathBuf]) -> Result<(), String> {
    let mut random = Random::new(seed);
    if random.percent(15) {
        let text = std::fs::read_to_string(&traces[random.below(traces.len())]).unwrap_or_default();
        let other = std::fs::read_to_string(&traces[random.below(traces.len())]).unwrap_or_default();
        let text = damage::damaged(&mut random, &text, &other, damage::WORDS);
        return robust::within(LIMIT, move || _ = plot::picture(&text, "damaged"));
    }
    let settings = Settings { pragmas: true, partial: random.percent(50), ..Settings::default() };
    if random.percent(40) {
        let (ending, text) = TABLES[random.below(TABLES.len())];
        let other = TABLES[random.below(TABLES.len())].1;
        let text = damage::damaged(&mut random, text, other, damage::WORDS);
        let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
        let (table, source) = (folder.path().join(format!("table.{ending}")), folder.path().join("main.stl"));
        std::fs::write(&table, text).map_err(|error| error.to_string())?;
        std::fs::write(&source, PROGRAM).map_err(|error| error.to_string())?;
        let read = inputs::read(&[table, source]);
        return robust::within(LIMIT, move || robust::endures(read, &settings, Reach::Run))?.map(|_| ());
    }
    let project = &programs[random.below(programs.len())];
    let found = companions(project);
    let path = &found[random.below(found.len())];
    let name = path.strip_prefix(project).map_err(|error| error.to_string())?.to_path_buf();
    let mut bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    let text = match String::from_utf8(bytes.clone()) {
        Ok(text) => damage::damaged(&mut random, &text, &text, damage::WORDS),
        Err(_) => {
            damaged_bytes(&mut random, &mut bytes);
            String::new()
        }
    };
    let bytes = if text.is_empty() { bytes } else { text.clone().into_bytes() };
    // A scenario is read with the unchanged program.
    if name.starts_with("tests") {
        let read: Read = inputs::read(std::slice::from_ref(project));
        return robust::within(LIMIT, move || {
            let bound = pipeline::front(read, &Settings::default());
            if !bound.has_errors() {
                let image = pipeline::back(&bound, Level::O0).image;
                _ = Scenario::parse("damaged.toml", &text, &image);
            }
        });
    }
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    copy_folder(project, folder.path());
    std::fs::write(folder.path().join(&name), bytes).map_err(|error| error.to_string())?;
    let read = inputs::read(&[folder.path().to_path_buf()]);
    robust::within(LIMIT, move || robust::endures(read, &settings, Reach::Ir))?.map(|_| ())
}

#[test]
fn damaged_files_beside_sources_do_no_harm() {
    let mut programs = projects(&root().join("samples"));
    programs.extend(projects(&tests_folder()));
    let mut traces = files(&root().join("samples"), "csv");
    traces.extend(programs.iter().flat_map(|project| files_of(project, "csv")));
    let (from, count) = (setting("PLCC_RANDOM_FILES_FROM", 0), setting("PLCC_RANDOM_FILES", 100));
    let mut failures = Vec::new();
    for seed in from..from + count {
        if let Err(error) = endures(seed, &programs, &traces) {
            eprintln!("{seed}: {error}");
            failures.push(format!("{seed}: {error}"));
        }
    }
    assert!(failures.is_empty(), "{} of {count} failed:\n{}", failures.len(), failures.join("\n"));
}
