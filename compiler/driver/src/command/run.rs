//! `plcc run`.

use std::rc::Rc;

use plcc_abi::ProgramImage;
use plcc_abi::services::ServicesConfig;
use plcc_codegen::JitProgram;
use plcc_runtime::code::{Entries, EntryFunction};
use plcc_runtime::{Code, guest};

use crate::cli::RunArgs;
use crate::code;
use crate::command::build::{accepted, internal};
use crate::{drawings, inputs, pipeline};

/// Compiles in memory and runs; the exit code is that of the program.
pub fn run(args: &RunArgs) -> u8 {
    match compile(args) {
        Ok(Made { image, entries, probed, .. }) => {
            // The code stays where it is until all CPUs have ended.
            let code = || -> Rc<dyn Code> {
                Rc::new(guest::NativeCode::new(Entries::watched(entries.clone(), probed.clone()), ()))
            };
            match args.services.open(&image, args.run.is_many()) {
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

/// A program in memory.
struct Made {
    image: ProgramImage,
    entries: Vec<EntryFunction>,
    /// Of the code with probes; empty if nobody can watch.
    probed: Vec<EntryFunction>,
    /// What keeps the code in memory.
    _code: Vec<JitProgram>,
}

fn compile(args: &RunArgs) -> Result<Made, u8> {
    let read = inputs::read_as(&inputs::or_here(&args.inputs)?, args.compile.code_page);
    let unreadable = read.is_unreadable();
    let settings = pipeline::Settings { require_main: true, ..pipeline::Settings::new(&args.compile) };
    let has_page = |services: &ServicesConfig| args.services.web.is_some() || services.web.is_some();
    let bound = drawings::bind(pipeline::parse(read, &settings), &settings, has_page);
    let bound = accepted(bound, unreadable, &settings)?;
    let mut plain = pipeline::lower(&bound, args.optimization.optimization());
    let is_watched = has_page(&bound.program.config.services) && !args.run.is_many();
    let probed = is_watched.then(|| pipeline::optimize(pipeline::lower_beside(&bound, &mut plain)));
    let mut plain = pipeline::optimize(plain);
    if let Some(probed) = &probed {
        plain.share_image(&probed.image);
    }
    let (entries, code) = code::machine_code(&plain).map_err(|error| internal(&error))?;
    let mut made = Made { image: plain.image, entries, probed: Vec::new(), _code: vec![code] };
    if let Some(probed) = &probed {
        let (entries, code) = code::machine_code(probed).map_err(|error| internal(&error))?;
        made.probed = entries;
        made._code.push(code);
    }
    Ok(made)
}
