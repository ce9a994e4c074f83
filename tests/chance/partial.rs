//! Complete programs with parts removed: with `--partial` the rest must build and run. Parts are files, blocks, declared
//! variables, rows of tables and constants. No error may come, nothing may panic, the IR must be valid, and three cycles must run.
//!
//! `PLCC_RANDOM_PARTIAL=N` sets how many programs are tried, `PLCC_RANDOM_PARTIAL_FROM` the first of them; `PLCC_RANDOM_PARTIAL_ALL` continues after one that fails.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use plcc_diag::drawing;
use plcc_driver::cli::Level;
use plcc_driver::pipeline::{self, Parsed, Settings};
use plcc_driver::{code, inputs};
use plcc_runtime::TestOptions;
use plcc_syntax::ast::{Block, DataContent};
use plcc_tests::random::{Random, setting};
use plcc_tests::{files, folders, projects, root, shown, tests_folder};

/// Programs of all languages: projects, carriers, and single files with several blocks.
fn programs() -> Vec<PathBuf> {
    let mut found = projects(&root().join("samples"));
    found.extend(projects(&tests_folder().join("run")));
    let twins = folders(&tests_folder().join("twins"));
    let carriers = twins.iter().flat_map(|twin| ["sd", "xml", "open"].map(|carrier| twin.join(carrier)));
    found.extend(carriers.filter(|folder| folder.is_dir()));
    for (folder, suffix) in [
        ("run/stl/calls", "stl"),
        ("run/stl/data", "stl"),
        ("run/stl/timers", "stl"),
        ("run/stl/library", "stl"),
        ("run/scl/language", "scl"),
        ("run/scl/programs", "scl"),
        ("run/scl/library", "scl"),
        ("run/graph", "gr7"),
        ("run/lad-fbd", "s7dcl"),
        ("run/lad-fbd", "xml"),
        ("run/graph", "xml"),
        ("run/scl/exports", "xml"),
        ("run/stl/exports", "xml"),
        ("run/s7200/subroutines", "awl"),
        ("run/s7200/plants", "awl"),
        ("run/plcopen", "xml"),
    ] {
        found.extend(files(&tests_folder().join(folder), suffix));
    }
    found
}

/// The program at `path`, unchanged, if it has no errors.
fn whole(path: &Path) -> Option<Parsed> {
    let settings = Settings { require_main: true, ..Settings::default() };
    let read = inputs::read(&[path.to_path_buf()]);
    let bound = pipeline::front(read, &settings);
    if bound.has_errors() {
        return None;
    }
    let read = inputs::read(&[path.to_path_buf()]);
    Some(pipeline::parse(read, &settings))
}

/// Removes parts; returns a line for each.
fn take_away(parsed: &mut Parsed, random: &mut Random) -> Vec<String> {
    let mut gone = Vec::new();
    if parsed.units.len() > 1 && random.one_in(3) {
        let at = random.below(parsed.units.len());
        let (file, _) = parsed.units.remove(at);
        gone.push(format!("file {}", parsed.sources.file(file).name));
    }
    if !parsed.tables.is_empty() && random.one_in(4) {
        parsed.tables.clear();
        gone.push("all tables".to_string());
    }
    for table in &mut parsed.tables {
        let share = 2 + random.below(6);
        table.symbols.retain(|symbol| {
            let kept = !random.one_in(share);
            if !kept {
                gone.push(format!("symbol {}", symbol.name));
            }
            kept
        });
        table.s7200.retain(|_| !random.one_in(share));
        table.constants.retain(|_| !random.one_in(share));
    }
    for (_, unit) in &mut parsed.units {
        let share = 2 + random.below(8);
        unit.blocks.retain(|block| {
            let kept = !random.one_in(share);
            if !kept {
                gone.push(format!("block {}", name_of(block)));
            }
            kept
        });
        // Types and data blocks of an older version: some components are not there yet.
        for block in &mut unit.blocks {
            if let Block::Data(data) = block
                && let DataContent::Struct(variables) = &mut data.content
                && variables.len() > 1
                && random.one_in(3)
            {
                let at = random.below(variables.len());
                let name = variables.remove(at).name;
                data.values.clear();
                gone.push(format!("component {name}"));
            }
        }
        if let Some(source) = &mut unit.s7200
            && source.blocks.len() > 1
            && random.one_in(2)
        {
            let at = random.below(source.blocks.len());
            source.blocks.remove(at);
            gone.push(format!("block {at} of the S7-200"));
        }
    }
    gone
}

fn name_of(block: &Block) -> String {
    match block {
        Block::Code(code) => format!("{:?} {:?}", code.kind, code.name),
        Block::Data(data) => format!("{:?}", data.name),
        Block::Type(ty) => format!("{:?}", ty.name),
    }
}

/// Builds and runs the rest.
fn check(path: &Path, seed: u64) -> Result<(), String> {
    let Some(mut parsed) = whole(path) else { return Ok(()) };
    let mut random = Random::new(seed);
    let gone = take_away(&mut parsed, &mut random);
    if parsed.units.is_empty() {
        return Ok(());
    }
    let explain = |text: String| format!("{} with seed {seed}, without {}:\n{text}", shown(path), gone.join(", "));
    let settings = Settings { partial: true, require_main: true, ..Settings::default() };
    let result = catch_unwind(AssertUnwindSafe(|| {
        let bound = pipeline::bind(parsed, &settings);
        if bound.has_errors() {
            let errors: Vec<_> = bound.diagnostics.iter().filter(|message| message.is_error()).cloned().collect();
            return Err(drawing::draw(&errors, &bound.sources, false));
        }
        let mut compiled = pipeline::lower(&bound, Level::O0);
        plcc_ir::verify::verify(&compiled.module).map_err(|errors| format!("after lowering: {}", errors[0]))?;
        plcc_opt::optimize_with(&mut compiled.module, plcc_opt::Without::NOTHING, &mut |_, _| {});
        plcc_ir::verify::verify(&compiled.module).map_err(|errors| format!("after the passes: {}", errors[0]))?;
        // A fault stops the CPU, which is an end like others here.
        let options = TestOptions { cycles: Some(3), ..TestOptions::default() };
        plcc_runtime::test(compiled.image.clone(), code::interpreter(&compiled), &options);
        Ok(())
    }));
    match result {
        Ok(result) => result.map_err(explain),
        Err(_) => Err(explain("a panic".to_string())),
    }
}

#[test]
fn the_rest_of_a_program_builds_and_runs() {
    let programs = programs();
    let (count, first) = (setting("PLCC_RANDOM_PARTIAL", 80), setting("PLCC_RANDOM_PARTIAL_FROM", 1));
    let all = std::env::var_os("PLCC_RANDOM_PARTIAL_ALL").is_some();
    let mut failures = Vec::new();
    for seed in first..first + count {
        let path = &programs[Random::new(seed ^ 0x5EED).below(programs.len())];
        if let Err(failure) = check(path, seed) {
            assert!(all, "{failure}");
            eprintln!("{failure}\n");
            failures.push(seed);
        }
    }
    assert!(failures.is_empty(), "{} of {count} failed: {failures:?}", failures.len());
}
