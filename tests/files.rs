//! Tests that are files: drop one into a folder of `tests/` and it is found. The folder tells the stage.
//!
//! | Folder | A test | Beside it |
//! | --- | --- | --- |
//! | `run/` | STL or SCL with assertions, in all forms at -O0 and -O2; the verifier passes the IR after each pass | `x.scenario.toml` |
//! | `run/*/` | a project: a folder with a `plc.toml` | its scenarios below `tests` |
//! | `twins/*/` | one program in folders `sd`, `xml`, `open`: the IR is the same | |
//! | `check/` | STL or SCL with caret lines | |
//! | `parse/` | STL or SCL | `x.ast`, and `x.tokens` if it is there |
//! | `ir/` | IR that prints as it stands | |
//! | `opt/` | IR; `; passes: a,b` in its first line | `x.expect` |
//! | `clif/` | STL or SCL | `x.clif` |
//! | `xref/`, `xref/*/` | a source, a project | `x.xref`: its reference data |
//! | `status/` | `x.status`: a command `plcc status`, and what it prints | |
//! | `debug/` | `x.debug`: a session with `plcc debug`, each line with `>` a request, and what comes back | |
//! | `messages/` | STL or SCL | `x.txt`: its messages as drawn |
//! | `view/` | any source | `x.svg`: its drawings, with the state at the end of `x.trace.csv` if that is there |
//! | `../samples/*/`, `../samples/*/*/` | a project with scenarios | `x.trace.csv`, `x.vcd`, `x.svg` beside `x.toml`, with the signals of its `# trace-signals:` line; `station.txt`: the list of `plcc station` |

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Arc, OnceLock};

use clap::Parser;
use libtest_mimic::{Arguments, Failed, Trial};
use plcc_driver::cli::Level;
use plcc_driver::command::view;
use plcc_driver::emit;
use plcc_driver::inputs::{self, TestInput};
use plcc_driver::pipeline::{self, Settings};
use plcc_driver::testing::{self, Form, Outcome, Variant, carets, prepare};
use plcc_tests::{
    all_variants, bind_file, debug, difference, expect_file, files, folders, plan, projects, root, shown, tests_folder,
    twins, updating,
};

use plcc_view::book::{Body, Options};
use plcc_view::names::Names;

/// Endings of the sources that are tests.
const LANGUAGES: [&str; 6] = ["stl", "awl", "scl", "s7dcl", "gr7", "xml"];

/// Run tests that share links: so many executables are one.
const RUN_GROUP: usize = 40;

fn main() -> ExitCode {
    plcc_tests::provide_runtimes();
    let arguments = Arguments::from_args();
    let trials = trials(&|name| is_selected(&arguments, name));
    libtest_mimic::run(&arguments, trials).exit_code()
}

/// True if the command line selects the trial `name`, by the rules of `cargo test`.
fn is_selected(arguments: &Arguments, name: &str) -> bool {
    let matches = |pattern: &String| if arguments.exact { name == pattern } else { name.contains(pattern.as_str()) };
    arguments.filter.as_ref().is_none_or(matches) && !arguments.skip.iter().any(matches)
}

fn trials(is_selected: &dyn Fn(&str) -> bool) -> Vec<Trial> {
    let tests = tests_folder();
    let mut trials = Vec::new();
    let sources: Vec<PathBuf> = LANGUAGES.iter().flat_map(|language| files(&tests.join("run"), language)).collect();
    run_trials(sources, is_selected, &mut trials);
    for language in LANGUAGES {
        file_trials("check", language, check_carets, &mut trials);
        file_trials("parse", language, check_parse, &mut trials);
        file_trials("clif", language, check_clif, &mut trials);
        file_trials("messages", language, check_messages, &mut trials);
        file_trials("view", language, check_view, &mut trials);
    }
    trials.push(trial("view: every network of the tests and samples".to_string(), check_drawings));
    for project in projects(&tests.join("run")) {
        trials.push(trial(shown(&project), move || {
            all_passed(&testing::run(&[TestInput::Project(project)], &plan(all_variants())))
        }));
    }
    for program in fs::read_dir(tests.join("xref")).into_iter().flatten().flatten().map(|entry| entry.path()) {
        let is_source = program.extension().is_some_and(|ending| LANGUAGES.iter().any(|language| ending == *language));
        if is_source || program.is_dir() {
            trials.push(trial(shown(&program), move || check_xref(&program)));
        }
    }
    file_trials("status", "status", check_status, &mut trials);
    file_trials("debug", "debug", |path| expect_file(path, &debug::transcript(path)?), &mut trials);
    for twins in folders(&tests.join("twins")) {
        trials.push(trial(shown(&twins), move || check_twins(&twins)));
    }
    file_trials("ir", "ir", check_ir, &mut trials);
    file_trials("opt", "ir", check_opt, &mut trials);
    sample_trials(&mut trials);
    trials
}

/// One trial per file of `tests/FOLDER`.
fn file_trials(folder: &str, suffix: &str, check: fn(&Path) -> Result<(), String>, trials: &mut Vec<Trial>) {
    for path in files(&tests_folder().join(folder), suffix) {
        trials.push(trial(shown(&path), move || check(&path)));
    }
}

/// A trial on a large stack, as the compiler has it.
fn trial(name: String, work: impl FnOnce() -> Result<(), String> + Send + 'static) -> Trial {
    Trial::test(name, move || plcc_driver::on_large_stack(work).and_then(|result| result).map_err(Failed::from))
}

/// Run tests whose executables share links. The first trial that asks runs them all.
struct Group {
    paths: Vec<PathBuf>,
    outcomes: OnceLock<Vec<Outcome>>,
}

/// One trial per file. Those that are selected share links in groups; the first files of all groups come first, so that trials that run
/// at the same time rarely wait for the same group.
fn run_trials(paths: Vec<PathBuf>, is_selected: &dyn Fn(&str) -> bool, trials: &mut Vec<Trial>) {
    let (selected, others): (Vec<PathBuf>, Vec<PathBuf>) =
        paths.into_iter().partition(|path| is_selected(&shown(path)));
    let groups: Vec<Arc<Group>> = [selected, others]
        .iter()
        .flat_map(|paths| paths.chunks(RUN_GROUP))
        .map(|paths| Arc::new(Group { paths: paths.to_vec(), outcomes: OnceLock::new() }))
        .collect();
    for index in 0..RUN_GROUP {
        for group in &groups {
            let Some(path) = group.paths.get(index) else { continue };
            let group = Arc::clone(group);
            trials.push(trial(shown(path), move || group.check(index)));
        }
    }
}

impl Group {
    fn check(&self, index: usize) -> Result<(), String> {
        verify_passes(&self.paths[index])?;
        let run = || {
            let inputs: Vec<TestInput> = self.paths.iter().cloned().map(TestInput::File).collect();
            testing::run(&inputs, &plan(all_variants()))
        };
        let outcome = &self.outcomes.get_or_init(run)[index];
        all_passed(std::slice::from_ref(outcome))?;
        // What runs and asserts nothing is not a test.
        let untested = outcome.untested.join(", ");
        if untested.is_empty() { Ok(()) } else { Err(format!("no assertions: {untested}\n")) }
    }
}

/// The verifier passes the IR of the program after lowering and after each pass.
fn verify_passes(path: &Path) -> Result<(), String> {
    let settings = Settings { pragmas: true, require_main: true, ..Settings::default() };
    let bound = pipeline::front(inputs::read(&[path.to_path_buf()]), &settings);
    if bound.has_errors() {
        return Ok(());
    }
    let mut module = pipeline::lower(&bound, Level::O0).module;
    let mut failure = verified(&module).err().map(|error| ("lowering", error));
    plcc_opt::optimize_with(&mut module, plcc_opt::Without::NOTHING, &mut |pass, module| {
        if failure.is_none() {
            failure = verified(module).err().map(|error| (pass, error));
        }
    });
    match failure {
        Some((stage, error)) => Err(format!("{}: after {stage}: {error}\n", shown(path))),
        None => Ok(()),
    }
}

/// Errors: the first thing that the verifier says.
fn verified(module: &plcc_ir::Module) -> Result<(), String> {
    plcc_ir::verify::verify(module).map_err(|errors| errors[0].to_string())
}

/// Errors: everything that failed, with the messages of the compiler.
fn all_passed(outcomes: &[Outcome]) -> Result<(), String> {
    let failed: String = outcomes
        .iter()
        .filter(|outcome| outcome.failed > 0 || outcome.unreadable)
        .map(|outcome| format!("{}{}", outcome.messages, outcome.failures))
        .collect();
    if failed.is_empty() { Ok(()) } else { Err(failed) }
}

fn check_carets(path: &Path) -> Result<(), String> {
    if updating() {
        let (diagnostics, sources) = prepare::messages_of_file(path, &Settings::default());
        let marks: Vec<carets::Mark> = diagnostics.iter().map(|d| carets::mark_of(d, &sources)).collect();
        let text = inputs::read_text(path).map_err(|error| error.to_string())?;
        fs::write(path, carets::rewrite(&text, &marks)).map_err(|error| error.to_string())?;
    }
    let plan = plan(vec![Variant { form: Form::Jit, optimization: Level::O2.into() }]);
    all_passed(&testing::run(&[TestInput::File(path.to_path_buf())], &plan))
        .map_err(|text| format!("{text}`UPDATE_EXPECT=1 cargo test --release` renews the caret lines\n"))
}

fn check_parse(path: &Path) -> Result<(), String> {
    let read = || inputs::read(&[path.to_path_buf()]);
    let settings = Settings { pragmas: true, ..Settings::default() };
    let tokens = path.with_extension("tokens");
    if tokens.exists() {
        expect_file(&tokens, &emit::tokens(&read(), &settings))?;
    }
    expect_file(&path.with_extension("ast"), &emit::ast(&pipeline::parse(read(), &settings)))
}

/// The program of each folder below has the same IR, sites aside.
fn check_twins(path: &Path) -> Result<(), String> {
    let mut texts = Vec::new();
    for carrier in folders(path) {
        let text = twins::ir_text(&bind_file(&carrier, &Settings::default())?);
        if !text.contains("func @OB1") {
            return Err(format!("{}: there is no OB 1\n", shown(&carrier)));
        }
        texts.push((carrier, text));
    }
    let [(first, expected), others @ ..] = texts.as_slice() else {
        return Err("there are no folders with programs\n".to_string());
    };
    if others.is_empty() {
        return Err("a twin has at least two folders: `sd`, `xml`, `open`\n".to_string());
    }
    match others.iter().find(|(_, text)| text != expected) {
        Some((other, text)) => {
            Err(format!("{} gives other IR than {}\n{}", shown(other), shown(first), difference(expected, text)))
        }
        None => Ok(()),
    }
}

/// IR text stands as it is printed, is valid, and parses back to what was printed.
fn check_ir(path: &Path) -> Result<(), String> {
    let module = read_module(path)?;
    expect_file(path, &plcc_ir::print::module_text(&module))
}

fn read_module(path: &Path) -> Result<plcc_ir::Module, String> {
    let text = fs::read_to_string(path).map_err(|error| error.to_string())?;
    let module = plcc_ir::parse::parse_module(&text).map_err(|error| format!("{}: {error}", shown(path)))?;
    plcc_ir::verify::verify(&module).map_err(|errors| format!("{}: {errors:?}", shown(path)))?;
    Ok(module)
}

/// Runs the passes that the first line names, and compares the IR after them.
fn check_opt(path: &Path) -> Result<(), String> {
    let text = fs::read_to_string(path).map_err(|error| error.to_string())?;
    expect_file(&path.with_extension("expect"), &plcc_opt::run_listed_passes(&text)?)
}

fn check_clif(path: &Path) -> Result<(), String> {
    let bound = bind_file(path, &Settings::default())?;
    let compiled = pipeline::back(&bound, Level::O2);
    let text =
        plcc_codegen::clif_text(&compiled.module, &compiled.codegen_options()).map_err(|error| error.to_string())?;
    expect_file(&path.with_extension("clif"), &text)
}

fn check_messages(path: &Path) -> Result<(), String> {
    let name = path.file_name().ok_or("a file has a name")?.to_string_lossy().into_owned();
    let text = inputs::read_text(path).map_err(|error| error.to_string())?;
    // Only the name of the file, so that the drawing is the same everywhere.
    let mut read = inputs::Read { name: name.clone(), ..inputs::Read::default() };
    read.units.push(read.sources.add(plcc_diag::SourceFile::new(name, text)));
    let bound = pipeline::front(read, &Settings { require_main: false, ..Settings::default() });
    expect_file(&path.with_extension("txt"), &plcc_diag::drawing::draw(&bound.diagnostics, &bound.sources, false))
}

fn check_view(path: &Path) -> Result<(), String> {
    let mut read = inputs::Read::default();
    let text = inputs::read_text(path).map_err(|error| error.to_string())?;
    read.units.push(read.sources.add(plcc_diag::SourceFile::new(shown(path), text)));
    let trace = path.with_extension("trace.csv");
    let state = trace.exists().then(|| trace.display().to_string());
    let drawn = view::draw(read, &Settings::default(), state.as_deref())?;
    expect_file(&path.with_extension("svg"), &drawn.book.poster(drawn.values.as_ref()))
}

/// Nothing overlaps in any drawing of a source that is here for another reason.
fn check_drawings() -> Result<(), String> {
    let mut wrong = Vec::new();
    let folders = [tests_folder(), root().join("samples")];
    let sources = folders.iter().flat_map(|folder| LANGUAGES.iter().flat_map(|language| files(folder, language)));
    let mut count = 0;
    for path in sources {
        let Ok(text) = inputs::read_text(&path) else { continue };
        let name = shown(&path);
        let file = plcc_diag::SourceMap::default().add(plcc_diag::SourceFile::new(name.clone(), text.clone()));
        let options = plcc_readers::ReadOptions { language: pipeline::language_of(&name), ..Default::default() };
        let (unit, _) = plcc_readers::parse(file, &text, &options);
        let book = plcc_view::book::book_with(&name, &[(&text, &unit)], &Names::default(), None, Options::default());
        for page in book.pages.iter().filter(|page| page.language != "GRAPH") {
            for section in &page.sections {
                let Body::Drawing { scene, sheet } = &section.content else { continue };
                count += 1;
                let faults = plcc_view::faults::faults(scene, sheet);
                wrong.extend(
                    faults.first().map(|fault| format!("{name}, {}, network {}: {fault}", page.id, section.number)),
                );
            }
        }
    }
    if count < 1000 {
        wrong.push(format!("only {count} drawings"));
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n")) }
}

/// The reference data of a source or a project.
fn check_xref(path: &Path) -> Result<(), String> {
    let bound = bind_file(path, &Settings::default())?;
    let reference = plcc_xref::reference(&bound.program, &bound.sources);
    let folder = format!("{}/", root().display());
    expect_file(&path.with_extension("xref"), &plcc_xref::text::document(&reference).replace(&folder, ""))
}

/// The first line is a command, `plcc status INPUT ...`; the rest is what it prints.
fn check_status(path: &Path) -> Result<(), String> {
    let text = fs::read_to_string(path).map_err(|error| error.to_string())?;
    let command = text.lines().next().unwrap_or_default();
    let mut words: Vec<String> = command.split_whitespace().map(String::from).collect();
    words.get(2).ok_or("the first line is not a command with an input")?;
    for path in words.iter_mut().filter(|word| word.starts_with("tests/") || word.starts_with("samples/")) {
        *path = root().join(&*path).display().to_string();
    }
    let cli = plcc_driver::cli::Cli::try_parse_from(words).map_err(|error| error.to_string())?;
    let plcc_driver::cli::Command::Status(args) = cli.command else { return Err("it is not `plcc status`".into()) };
    let (shown, _) = plcc_driver::command::status::output(&args).map_err(|exit| format!("exit code {exit}"))?;
    let folder = format!("{}/", root().display());
    expect_file(path, &format!("{command}\n{}", shown.replace(&folder, "")))
}

/// Each sample is a project, or a folder of one for each language: its scenarios pass in all forms, and traces are as they were.
fn sample_trials(trials: &mut Vec<Trial>) {
    let samples = folders_in(&root().join("samples"));
    for sample in &samples {
        // One plant in several languages: a project each. Other folders are samples of their own.
        let mut variants = with_project(folders_in(sample));
        variants
            .retain(|folder| folder.file_name().is_some_and(|name| VARIANTS.iter().any(|variant| name == *variant)));
        if let [first, others @ ..] = variants.as_slice() {
            for other in others {
                let (first, other) = (first.clone(), other.clone());
                let name = format!("{} as {}", shown(&other), shown(&first));
                trials.push(trial(name, move || same_traces(&first, &other)));
            }
        }
    }
    let variants = samples.iter().flat_map(|sample| folders_in(sample)).collect();
    for folder in [with_project(samples), with_project(variants)].concat() {
        let project = folder.clone();
        trials.push(trial(shown(&folder), move || {
            all_passed(&testing::run(&[TestInput::Project(project)], &plan(all_variants())))
        }));
        for scenario in inputs::project_scenarios(&folder) {
            for suffix in ["trace.csv", "vcd", "svg"] {
                let expected = scenario.with_extension(suffix);
                if expected.is_file() {
                    let (folder, scenario) = (folder.clone(), scenario.clone());
                    trials.push(trial(shown(&expected), move || check_trace(&folder, &scenario, &expected)));
                }
            }
        }
        let station = folder.join("station.txt");
        if station.is_file() {
            trials.push(trial(shown(&station), move || check_station(&folder, &station)));
        }
    }
}

/// Folders with one plant in several languages.
const VARIANTS: [&str; 2] = ["fbd", "lad"];

/// Folders in a folder, by name.
fn folders_in(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut folders: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    folders.sort();
    folders
}

fn with_project(mut folders: Vec<PathBuf>) -> Vec<PathBuf> {
    folders.retain(|folder| folder.join("plc.toml").is_file());
    folders
}

/// Two variants of a sample have the same scenarios, and their traces are the same bytes.
fn same_traces(first: &Path, other: &Path) -> Result<(), String> {
    let files = |folder: &Path| -> Result<Vec<(String, String)>, String> {
        let mut files = Vec::new();
        for scenario in inputs::project_scenarios(folder) {
            for path in [scenario.clone(), scenario.with_extension("trace.csv")] {
                let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", shown(&path)))?;
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                files.push((name, text));
            }
        }
        Ok(files)
    };
    let (first, other) = (files(first)?, files(other)?);
    if first.is_empty() {
        return Err("there is no scenario".to_string());
    }
    for ((name, text), (other_name, other_text)) in first.iter().zip(&other) {
        if (name, text) != (other_name, other_text) {
            return Err(format!("{name} and {other_name} are not the same"));
        }
    }
    if first.len() == other.len() { Ok(()) } else { Err("one of them has more scenarios".to_string()) }
}

/// The list that `plcc station` prints.
fn check_station(project: &Path, expected: &Path) -> Result<(), String> {
    let station = inputs::read(&[project.to_path_buf()]).project.and_then(|project| project.station);
    expect_file(expected, &plcc_driver::station::table(&station.ok_or("plc.toml describes no station")?))
}

/// The trace of a scenario, run by `plcc run` under the virtual clock, is the same byte for byte.
fn check_trace(project: &Path, scenario: &Path, expected: &Path) -> Result<(), String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let suffix = if expected.extension().is_some_and(|ending| ending == "vcd") { "trace.vcd" } else { "trace.csv" };
    let trace = folder.path().join(suffix);
    let text = fs::read_to_string(scenario).map_err(|error| error.to_string())?;
    let cycles = last_cycle(&text)?.to_string();
    let mut arguments: Vec<std::ffi::OsString> = vec![
        "plcc".into(),
        "run".into(),
        project.into(),
        "--quiet".into(),
        "--clock".into(),
        "virtual".into(),
        "--cycles".into(),
        cycles.into(),
        "--scenario".into(),
        scenario.into(),
        "--trace".into(),
        trace.clone().into(),
    ];
    let flag = |line_start: &str| text.lines().find_map(|line| line.strip_prefix(line_start)).map(str::trim);
    if let Some(signals) = flag(SIGNALS_LINE) {
        arguments.extend(["--trace-signals".into(), signals.into()]);
    }
    if let Some(step) = flag(STEP_LINE) {
        arguments.extend(["--trace-step".into(), step.into()]);
    }
    let code = plcc_driver::main_with(arguments);
    let trace = fs::read_to_string(&trace).map_err(|error| format!("exit code {code}, no trace: {error}"))?;
    if expected.extension().is_some_and(|ending| ending == "svg") {
        return expect_file(expected, &plcc_driver::plot::picture(&trace, flag(TITLE_LINE).unwrap_or_default())?);
    }
    expect_file(expected, &trace)
}

/// A comment line of a scenario that names what its trace records, in place of the symbols.
const SIGNALS_LINE: &str = "# trace-signals:";

/// A comment line with the time between two samples, in place of each cycle.
const STEP_LINE: &str = "# trace-step:";

/// A comment line with the title of the picture.
const TITLE_LINE: &str = "# title:";

/// The cycle of a scenario's last entry, at 10 ms a cycle; a trace lasts until then.
fn last_cycle(scenario: &str) -> Result<u64, String> {
    const CYCLE_MS: u64 = 10;
    let mut last = 1;
    for line in scenario.lines() {
        let Some((key, value)) = line.split('#').next().and_then(|line| line.split_once('=')) else { continue };
        let value = value.trim().trim_matches('"');
        let unreadable = |_| format!("a trace of an entry at `{value}` is not possible");
        match key.trim() {
            "cycle" => last = last.max(value.parse().map_err(unreadable)?),
            "time" => {
                let ms: u64 = value.trim_end_matches("ms").parse().map_err(unreadable)?;
                last = last.max(ms.div_ceil(CYCLE_MS) + 1);
            }
            _ => {}
        }
    }
    Ok(last)
}
