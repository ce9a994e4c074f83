//! One test input: read, compiled, and run in the forms of this process.

use std::path::{Path, PathBuf};

use plcc_coverage::Coverage;
use plcc_diag::{Code, Diagnostic, SourceMap, drawing};
use plcc_runtime::{TestOptions, TestReport};

use super::coverage::Counting;
use super::{Form, Outcome, Plan, Variant, carets, executables, find, name_of};
use crate::inputs::{self, Read, TestInput};
use crate::pipeline::{self, Bound, Compiled, Settings};
use crate::{code, report};

/// A test in progress: its outcome so far, and its programs.
pub struct Prepared {
    pub outcome: Outcome,
    /// One for each scenario; one if there is none; none if the outcome is finished.
    pub programs: Vec<TestProgram>,
    /// What has run, if the plan asks for it.
    pub coverage: Option<Coverage>,
}

impl Prepared {
    /// A test without a program to run.
    pub fn finished(outcome: Outcome) -> Prepared {
        Prepared { outcome, programs: Vec::new(), coverage: None }
    }
}

/// A program with its run options and the reports of its forms.
pub struct TestProgram {
    pub options: TestOptions,
    pub sources: SourceMap,
    pub variants: Vec<(Variant, VariantState)>,
}

/// State of a form of a program.
pub enum VariantState {
    /// An executable: the object to link, and the name under which it exports the program.
    Object {
        name: String,
        bytes: Vec<u8>,
    },
    Done(TestReport),
    /// It could not run because of a fault in plcc.
    Broken(String),
}

/// Compiles `input` and runs it in the forms that need no executable.
pub fn prepare(input: &TestInput, plan: &Plan) -> Prepared {
    let (paths, scenarios) = match input {
        TestInput::File(path) => (std::slice::from_ref(path), inputs::file_scenario(path).into_iter().collect()),
        TestInput::Project(path) => (std::slice::from_ref(path), inputs::project_scenarios(path)),
        TestInput::Program(paths) => (paths.as_slice(), find::program_scenarios(paths)),
    };
    let mut outcome = Outcome { name: name_of(input), ..Outcome::default() };
    let read = inputs::read(paths);
    outcome.unreadable = read.is_unreadable();
    if marked(&read, plan, &mut outcome).is_some() {
        return Prepared::finished(outcome);
    }
    let parsed = pipeline::parse(read, &settings(plan));
    let units = if plan.coverage { parsed.units.clone() } else { Vec::new() };
    let bound = pipeline::bind(parsed, &settings(plan));
    outcome.messages = drawing::draw(&bound.diagnostics, &bound.sources, false);
    if bound.is_denied(&plan.settings) && !bound.has_errors() {
        outcome.fail(&format!("{}: {}, refused by --deny", outcome.name, report::summary(&bound.diagnostics)));
        return Prepared::finished(outcome);
    }
    let mut coverage = plan.coverage.then(|| Counting::new(&bound, &units));
    let programs = match accept(&bound, &mut outcome) {
        true => {
            for notice in &bound.program.notices {
                outcome.messages.push_str(&format!("{}: {notice}\n", outcome.name));
            }
            runs(&bound, &scenarios, plan, coverage.as_mut())
        }
        false => Vec::new(),
    };
    Prepared { outcome, programs, coverage: coverage.map(|counting| counting.coverage) }
}

fn settings(plan: &Plan) -> Settings {
    Settings { pragmas: true, require_main: true, ..plan.settings.clone() }
}

/// A file with caret lines is not run: its messages are compared. `None` if it has none.
fn marked(read: &Read, plan: &Plan, outcome: &mut Outcome) -> Option<()> {
    let &[file] = read.units.as_slice() else { return None };
    let source = read.sources.file(file);
    if !carets::has_carets(&source.text) {
        return None;
    }
    let (marks, mut wrong) = carets::marks(file, source);
    let (diagnostics, sources) = messages_of(read, plan);
    wrong.extend(diagnostics);
    let (passed, failures) = carets::compare(&marks, &wrong, &sources);
    outcome.passed = u64::from(passed);
    for failure in failures {
        outcome.fail(&format!("{}: {failure}", outcome.name));
    }
    Some(())
}

/// The messages that caret lines must mark.
fn messages_of(read: &Read, plan: &Plan) -> (Vec<Diagnostic>, SourceMap) {
    let again = Read {
        name: read.name.clone(),
        sources: read.sources.clone(),
        units: read.units.clone(),
        texts: read.texts.clone(),
        ..Read::default()
    };
    let bound = pipeline::front(again, &settings(plan));
    (bound.diagnostics, bound.sources)
}

/// The messages of one source with pragmas applied, as caret lines must mark them.
pub fn messages_of_file(path: &Path, settings: &Settings) -> (Vec<Diagnostic>, SourceMap) {
    let read = inputs::read(&[path.to_path_buf()]);
    let plan = Plan { settings: settings.clone(), variants: Vec::new(), linker: None, coverage: false };
    messages_of(&read, &plan)
}

/// True if the program can run; otherwise the outcome is finished.
fn accept(bound: &Bound, outcome: &mut Outcome) -> bool {
    if !bound.has_errors() {
        return true;
    }
    // A wrong pragma must not count as an expected rejection.
    let pragma_is_wrong = bound.diagnostics.iter().any(|d| d.code == Code::Pragma);
    let expected = bound.program.test.expect_fail.as_deref().filter(|_| !pragma_is_wrong);
    let is_expected = |code: &str| {
        code.is_empty() || bound.diagnostics.iter().any(|message| message.is_error() && message.code.name() == code)
    };
    if expected.is_some_and(is_expected) {
        outcome.passed += 1;
    } else {
        outcome.rejected = true;
        outcome.fail(&format!("{}: {}", outcome.name, report::summary(&bound.diagnostics)));
    }
    false
}

fn runs(
    bound: &Bound,
    scenarios: &[PathBuf],
    plan: &Plan,
    mut counting: Option<&mut Counting<'_>>,
) -> Vec<TestProgram> {
    let test = &bound.program.test;
    let options = |scenario: Option<&PathBuf>| TestOptions {
        cycles: test.cycles.map(u64::from),
        expect_fail: test.expect_fail.clone(),
        scenario: scenario.cloned(),
        ..TestOptions::default()
    };
    let all_options: Vec<TestOptions> = match scenarios {
        [] => vec![options(None)],
        scenarios => scenarios.iter().map(|scenario| options(Some(scenario))).collect(),
    };
    let mut programs: Vec<TestProgram> = all_options
        .into_iter()
        .map(|options| TestProgram { options, sources: bound.sources.clone(), variants: Vec::new() })
        .collect();
    for &variant in &plan.variants {
        // The code that is counted is the code that is tested, with probes, which change nothing that a program can see.
        if let Some(counting) = counting.take_if(|_| variant.form != Form::Exe) {
            let options: Vec<&TestOptions> = programs.iter().map(|program| &program.options).collect();
            let states = counting.run(variant, &options);
            programs.iter_mut().zip(states).for_each(|(program, state)| program.variants.push((variant, state)));
            continue;
        }
        let compiled = pipeline::back(bound, variant.optimization);
        for program in &mut programs {
            let state = run_variant(&compiled, variant.form, &program.options);
            program.variants.push((variant, state));
        }
    }
    programs
}

fn run_variant(compiled: &Compiled, form: Form, options: &TestOptions) -> VariantState {
    let code = match form {
        Form::Interp => code::interpreter(compiled),
        Form::Jit => match code::jit(compiled) {
            Ok(code) => code,
            Err(error) => return VariantState::Broken(error.to_string()),
        },
        Form::Exe => {
            let (name, image) = (executables::unique_name(), compiled.image_bytes());
            let options = compiled.codegen_options();
            return match plcc_codegen::compile_object_as(&name, &compiled.module, &image, &options) {
                Ok(bytes) => VariantState::Object { name, bytes },
                Err(error) => VariantState::Broken(error.to_string()),
            };
        }
    };
    VariantState::Done(plcc_runtime::test(compiled.image.clone(), code, options))
}
