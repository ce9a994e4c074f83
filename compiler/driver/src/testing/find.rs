//! Which tests the arguments of `plcc test` name.
//!
//! What `plcc check` reads as one program is one test, with one exception: of sources that have more than one main program each
//! is a test. A folder with a plc.toml is always one.

use std::path::{Path, PathBuf};

use plcc_diag::Code;

use crate::inputs::{self, Read, TestInput, entries, files_below, is_folder, is_source, read_text};
use crate::pipeline::{self, Settings};
use crate::project;

/// The tests that `paths` name.
pub fn find_tests(paths: &[PathBuf]) -> Vec<TestInput> {
    let (folders, files): (Vec<&PathBuf>, Vec<&PathBuf>) = paths.iter().partition(|path| path.is_dir());
    let mut tests = Vec::new();
    let files: Vec<PathBuf> = files.into_iter().cloned().collect();
    match files.as_slice() {
        [] => {}
        [file] => tests.push(TestInput::File(file.clone())),
        files => {
            let is_test = |path: &&PathBuf| !is_table(path);
            let sources: Vec<PathBuf> = files.iter().filter(is_test).cloned().collect();
            if is_one_program(&sources) {
                tests.push(TestInput::Program(files.to_vec()));
            } else {
                let tables = files.iter().filter(|path| is_table(path));
                let tables: Vec<PathBuf> = tables.cloned().collect();
                tests.extend(sources.into_iter().map(|source| with_tables(source, &tables)));
            }
        }
    }
    folders.into_iter().for_each(|folder| find_below(folder, &mut tests));
    tests
}

fn with_tables(source: PathBuf, tables: &[PathBuf]) -> TestInput {
    match tables {
        [] => TestInput::File(source),
        tables => TestInput::Program([&[source], tables].concat()),
    }
}

fn find_below(folder: &Path, tests: &mut Vec<TestInput>) {
    if folder.join(project::FILE_NAME).is_file() {
        return tests.push(TestInput::Project(folder.to_path_buf()));
    }
    let files = files_below(folder);
    let has_project = files.iter().any(|path| path.file_name() == Some(project::FILE_NAME.as_ref()));
    let sources: Vec<PathBuf> = files.into_iter().filter(|path| is_test_file(path)).collect();
    match sources.as_slice() {
        [] if !has_project => {}
        [source] if !has_project && source.parent() == Some(folder) && !has_tables(folder) => {
            tests.push(TestInput::File(source.clone()));
        }
        sources if !has_project && is_one_program(sources) => {
            tests.push(TestInput::Program(vec![folder.to_path_buf()]));
        }
        _ => {
            for path in entries(folder) {
                if is_folder(&path) {
                    find_below(&path, tests);
                } else if is_test_file(&path) {
                    tests.push(TestInput::File(path));
                }
            }
        }
    }
}

/// A source that is neither a scenario nor a table.
fn is_test_file(path: &Path) -> bool {
    path.extension().is_none_or(|suffix| suffix != "toml")
        && read_text(path).is_ok_and(|text| !text.is_empty() && is_source(path, &text))
}

/// A table of symbols, which alone is not a program.
fn is_table(path: &Path) -> bool {
    let read = inputs::read(&[path.to_path_buf()]);
    read.units.is_empty() && !read.tables.is_empty()
}

fn has_tables(folder: &Path) -> bool {
    files_below(folder).iter().any(|path| !is_test_file(path) && is_table(path))
}

/// True if at most one of the sources has a main program.
fn is_one_program(sources: &[PathBuf]) -> bool {
    sources.iter().filter(|source| has_main(source)).nth(1).is_none()
}

/// Whether a source has the block that the CPU executes in each cycle.
fn has_main(source: &Path) -> bool {
    let read: Read = inputs::read(&[source.to_path_buf()]);
    if crate::testing::carets::has_carets(
        &read.units.first().map_or(String::new(), |&unit| read.sources.file(unit).text.clone()),
    ) {
        return true;
    }
    let settings = Settings { pragmas: true, require_main: true, ..Settings::default() };
    let bound = pipeline::front(read, &settings);
    !bound.diagnostics.iter().any(|message| message.code == Code::NoMainBlock)
}

/// The extension of a scenario next to its source.
const SCENARIO_ENDING: &str = ".scenario.toml";

/// The scenarios of a program of several files: those next to its sources, and those below the folder `tests`.
pub fn program_scenarios(paths: &[PathBuf]) -> Vec<PathBuf> {
    let mut scenarios = Vec::new();
    for path in paths {
        if path.is_dir() {
            let tests = path.join("tests");
            scenarios.extend(files_below(path).into_iter().filter(|file| {
                is_scenario(file) || file.starts_with(&tests) && file.extension().is_some_and(|suffix| suffix == "toml")
            }));
        } else {
            scenarios.extend(inputs::file_scenario(path));
        }
    }
    scenarios
}

fn is_scenario(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().ends_with(SCENARIO_ENDING))
}

/// Scenarios that have no source next to them: nothing plays them.
pub fn lone_scenarios(paths: &[PathBuf], tests: &[TestInput]) -> Vec<PathBuf> {
    let mut scenarios: Vec<PathBuf> =
        paths.iter().filter(|path| path.is_dir()).flat_map(|path| files_below(path)).collect();
    scenarios.retain(|path| is_scenario(path));
    scenarios.retain(|path| {
        !tests.iter().any(|test| match test {
            TestInput::File(source) => source.with_extension("scenario.toml") == *path,
            TestInput::Project(folder) => path.starts_with(folder),
            TestInput::Program(parts) => parts.iter().any(|part| path.starts_with(part)),
        })
    });
    scenarios
}

/// Scenarios of projects that are not below `tests`: nothing plays them.
pub fn strayed_scenarios(tests: &[TestInput]) -> Vec<PathBuf> {
    let strayed = |test: &TestInput| match test {
        TestInput::Project(folder) => {
            let played = folder.join("tests");
            let mut files = files_below(folder);
            files.retain(|path| is_scenario(path) && !path.starts_with(&played));
            files
        }
        TestInput::File(_) | TestInput::Program(_) => Vec::new(),
    };
    tests.iter().flat_map(strayed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inputs::tests::folder;
    use std::fs;

    const MAIN: &str = "ORGANIZATION_BLOCK OB 1\nBEGIN\nCALL FC 1\nEND_ORGANIZATION_BLOCK\n";
    const FUNCTION: &str = "FUNCTION FC 1 : VOID\nBEGIN\nA \"Start\"\n= Q 4.0\nEND_FUNCTION\n";
    const TABLE: &str = "126,Start                   I       0.0 BOOL\n";

    fn tests_of(folder: &tempfile::TempDir) -> Vec<TestInput> {
        find_tests(&[folder.path().to_path_buf()])
    }

    #[test]
    fn a_folder_with_one_main_program_is_one_test() {
        let folder =
            folder(&[("main.stl", MAIN), ("sub/f.stl", FUNCTION), ("s.asc", TABLE), ("main.scenario.toml", "")]);
        let root = folder.path().to_path_buf();
        assert_eq!(tests_of(&folder), [TestInput::Program(vec![root.clone()])]);
        assert_eq!(program_scenarios(std::slice::from_ref(&root)), [root.join("main.scenario.toml")]);
        assert!(lone_scenarios(std::slice::from_ref(&root), &tests_of(&folder)).is_empty());
        let named = ["main.stl", "sub/f.stl", "s.asc"].map(|name| root.join(name));
        assert_eq!(find_tests(&named), [TestInput::Program(named.to_vec())]);
    }

    #[test]
    fn sources_with_main_programs_are_tests_of_their_own() {
        let folder =
            folder(&[("a.stl", "A I 0.0\n"), ("b.stl", "A I 0.1\n"), ("b.scenario.toml", ""), ("c.scenario.toml", "")]);
        let root = folder.path();
        let tests = tests_of(&folder);
        assert_eq!(tests, [TestInput::File(root.join("a.stl")), TestInput::File(root.join("b.stl"))]);
        // A scenario that nothing plays is reported.
        assert_eq!(lone_scenarios(&[root.to_path_buf()], &tests), [root.join("c.scenario.toml")]);
        fs::write(root.join("s.asc"), TABLE).unwrap();
        let named = ["a.stl", "b.stl", "s.asc"].map(|name| root.join(name));
        let with = |name: &str| TestInput::Program(vec![root.join(name), root.join("s.asc")]);
        assert_eq!(find_tests(&named), [with("a.stl"), with("b.stl")]);
    }

    #[test]
    fn projects_below_a_folder_are_tests() {
        let folder = folder(&[("x/plc.toml", ""), ("x/main.stl", MAIN), ("x/f.stl", FUNCTION), ("b.stl", "A I 0.1\n")]);
        let root = folder.path();
        assert_eq!(tests_of(&folder), [TestInput::File(root.join("b.stl")), TestInput::Project(root.join("x"))]);
        for file in ["x/main.scenario.toml", "x/tests/a.toml", "x/tests/b.scenario.toml"] {
            let path = root.join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "").unwrap();
        }
        // A scenario next to a source of a project is not played.
        assert_eq!(strayed_scenarios(&tests_of(&folder)), [root.join("x/main.scenario.toml")]);
    }
}
