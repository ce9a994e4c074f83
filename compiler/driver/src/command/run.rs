//! `plcc run`.

use std::rc::Rc;

use crate::cli::RunArgs;
use crate::code;
use crate::command::build::{accepted, internal};
use crate::{inputs, pipeline};

/// Compiles in memory and runs; the exit code is that of the program.
pub fn run(args: &RunArgs) -> u8 {
    match compile(args) {
        Ok((image, code)) => plcc_runtime::run(image, code, &args.run),
        Err(exit) => exit,
    }
}

fn compile(args: &RunArgs) -> Result<(plcc_abi::ProgramImage, Rc<dyn plcc_runtime::Code>), u8> {
    let read = inputs::read_as(&inputs::or_here(&args.inputs)?, args.compile.code_page);
    let unreadable = read.is_unreadable();
    let settings = pipeline::Settings { require_main: true, ..pipeline::Settings::new(&args.compile) };
    let bound = accepted(pipeline::front(read, &settings), unreadable, &settings)?;
    let compiled = pipeline::back(&bound, args.optimization.optimization());
    let code = code::jit(&compiled).map_err(|error| internal(&error))?;
    Ok((compiled.image, code))
}
