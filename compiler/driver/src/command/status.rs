//! `plcc status`.

use std::rc::Rc;

use plcc_runtime::RunOptions;
use plcc_runtime::options::ClockKind;
use plcc_runtime::probe::Watcher;
use plcc_status::{Call, Choice, Recorder, Status, choice, status, text};

use super::exit;
use crate::cli::{Level, StatusArgs};
use crate::command::build::{accepted, internal};
use crate::pipeline::Bound;
use crate::{code, inputs, pipeline, report};

/// Runs the program up to a cycle, and prints what the statements of a block see in it.
pub fn status(args: &StatusArgs) -> u8 {
    match output(args) {
        Ok((text, ended)) => report::print(&text).err().unwrap_or(ended),
        Err(exit) => exit,
    }
}

/// What is printed, and the exit code of the run. `Err`: the exit code.
pub fn output(args: &StatusArgs) -> Result<(String, u8), u8> {
    let (bound, seen, ended) = show(args)?;
    Ok((if args.json { format!("{:#}\n", serde_json::json!(seen)) } else { shown(&bound, &seen) }, ended))
}

/// The status as text.
fn shown(bound: &Bound, seen: &Status) -> String {
    let file = bound.sources.files().find(|(_, file)| file.name == seen.file);
    file.map_or_else(String::new, |(_, file)| text::document(seen, file))
}

/// Compiles with probes and runs. `Err`: the exit code.
fn show(args: &StatusArgs) -> Result<(Bound, Status, u8), u8> {
    let read = inputs::read_as(&inputs::or_here(&args.inputs)?, args.compile.code_page);
    let unreadable = read.is_unreadable();
    let settings = pipeline::Settings { require_main: true, ..pipeline::Settings::new(&args.compile) };
    let bound = accepted(pipeline::front(read, &settings), unreadable, &settings)?;
    let choice = choice_of(args, &bound).map_err(|message| {
        report::say(&message);
        exit::USAGE
    })?;
    let options = RunOptions {
        cycles: Some(args.cycle.max(1)),
        clock: ClockKind::Virtual,
        cycle_time: args.cycle_time,
        set: args.set.clone(),
        scenario: args.scenario.clone(),
        force: args.force.clone(),
        quiet: true,
        looks: true,
        ..RunOptions::default()
    };
    let (seen, ended) = run(&bound, choice, &options)?;
    Ok((bound, seen, ended))
}

/// What the chosen call sees in a run, and the exit code of the run. `Err`: the exit code of a fault.
pub fn run(bound: &Bound, choice: Choice, options: &RunOptions) -> Result<(Status, u8), u8> {
    let (compiled, places) = pipeline::lower_with_probes(bound, Level::O2);
    let compiled = pipeline::optimize(compiled);
    let code = code::jit(&compiled).map_err(|error| internal(&error))?;
    let recorder = Rc::new(Recorder::new(&bound.program, places.into(), choice));
    let watcher: Rc<dyn Watcher> = Rc::<Recorder>::clone(&recorder);
    let ended = plcc_runtime::run::run_watched(compiled.image, code, options, Some(watcher));
    Ok((status::status(&bound.program, &bound.sources, &recorder), ended))
}

fn choice_of(args: &StatusArgs, bound: &Bound) -> Result<Choice, String> {
    let program = &bound.program;
    let (block, network) = choice::block_and_network(program, &args.block)?;
    let instance = args.instance.as_deref().map(|text| choice::instance(program, text)).transpose()?;
    let path = args.path.as_deref().map(|text| choice::path(program, text)).transpose()?.unwrap_or_default();
    Ok(Choice { block, network, cycle: args.cycle, call: Call { instance, path, number: args.call } })
}
