//! `plcc run`.

use std::rc::Rc;

use plcc_abi::ProgramImage;
use plcc_codegen::JitProgram;
use plcc_runtime::code::EntryFunction;
use plcc_runtime::{Code, guest};

use crate::cli::{ReplayArgs, RunArgs};
use crate::code;
use crate::command::build::{accepted, internal};
use crate::{drawings, inputs, pipeline};

/// Compiles in memory and runs; the exit code is that of the program.
pub fn run(args: &RunArgs) -> u8 {
    match compile(args) {
        Ok((image, entries, _code)) => {
            // The code stays where it is until all CPUs have ended.
            let code = || -> Rc<dyn Code> { Rc::new(guest::NativeCode::new(entries.clone(), ())) };
            match args.services.open(&image, args.run.flags_only()) {
                Ok((service, opened)) => {
                    opened.iter().for_each(|line| eprintln!("{line}"));
                    plcc_runtime::run::start(image, &code, &args.run, service)
                }
                Err(message) => {
                    eprintln!("runtime: {message}");
                    plcc_runtime::run::EXIT_USAGE
                }
            }
        }
        Err(exit) => exit,
    }
}

/// Repeats a recorded run.
pub fn replay(args: &ReplayArgs) -> u8 {
    let mut run = args.run.clone();
    run.run.replay = Some(args.recording.clone());
    self::run(&run)
}

fn compile(args: &RunArgs) -> Result<(ProgramImage, Vec<EntryFunction>, JitProgram), u8> {
    let read = inputs::read_as(&inputs::or_here(&args.inputs)?, args.compile.code_page);
    let unreadable = read.is_unreadable();
    let settings = pipeline::Settings { require_main: true, ..pipeline::Settings::new(&args.compile) };
    let has_page = args.services.web.is_some();
    let bound =
        drawings::bind(pipeline::parse(read, &settings), &settings, |project| has_page || project.web.is_some());
    let bound = accepted(bound, unreadable, &settings)?;
    let compiled = pipeline::back(&bound, args.optimization.optimization());
    let (entries, code) = code::machine_code(&compiled).map_err(|error| internal(&error))?;
    Ok((compiled.image, entries, code))
}
