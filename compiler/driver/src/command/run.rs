//! `plcc run`.

use std::rc::Rc;

use plcc_abi::ProgramImage;
use plcc_codegen::CodegenError;
use plcc_runtime::{Code, guest};

use crate::cli::RunArgs;
use crate::code;
use crate::command::build::{accepted, internal};
use crate::pipeline::Compiled;
use crate::{drawings, inputs, live, pipeline};

/// Compiles in memory and runs; the exit code is that of the program.
pub fn run(args: &RunArgs) -> u8 {
    if args.watch {
        return live::run(args);
    }
    if args.services.allow_load && !args.run.is_many() {
        return live::run(args);
    }
    let machine_code = |compiled: &Compiled| code::machine_code(compiled);
    match compile(args, machine_code) {
        Ok((image, (entries, _code))) => {
            // The code stays where it is until all CPUs have ended.
            let code = || -> Rc<dyn Code> { Rc::new(guest::NativeCode::new(entries.clone(), ())) };
            match args.services.open(&image, args.run.is_many(), None) {
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

/// Compiles the program; `generate` makes its code. `Err`: the exit code, after messages.
pub fn compile<C>(
    args: &RunArgs,
    generate: impl FnOnce(&Compiled) -> Result<C, CodegenError>,
) -> Result<(ProgramImage, C), u8> {
    let read = inputs::read_as(&inputs::or_here(&args.inputs)?, args.compile.code_page);
    let unreadable = read.is_unreadable();
    let settings = pipeline::Settings { require_main: true, ..pipeline::Settings::new(&args.compile) };
    let has_page = args.services.web.is_some();
    let bound =
        drawings::bind(pipeline::parse(read, &settings), &settings, |project| has_page || project.web.is_some());
    let bound = accepted(bound, unreadable, &settings)?;
    let compiled = pipeline::back(&bound, args.optimization.optimization());
    let code = generate(&compiled).map_err(|error| internal(&error))?;
    Ok((compiled.image, code))
}
