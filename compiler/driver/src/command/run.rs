//! `plcc run`.

use plcc_abi::ProgramImage;
use plcc_abi::services::ServicesConfig;
use plcc_runtime::change::CodeSource;

use crate::cli::{ReplayArgs, RunArgs};
use crate::code;
use crate::command::build::{accepted, internal};
use crate::command::exit;
use crate::{drawings, inputs, live, pipeline, report};

/// Compiles in memory and runs; the exit code is that of the program.
pub fn run(args: &RunArgs) -> u8 {
    if args.watch {
        return live::run(args);
    }
    if args.services.allow_load && !args.run.is_many() {
        return live::run(args);
    }
    match compile(args) {
        Ok((image, code)) => match args.services.open(&image, args.run.flags_only(), None) {
            Ok((service, opened)) => {
                // For many CPUs clients are refused.
                opened.iter().filter(|_| !args.run.is_many()).for_each(|line| report::tell(line));
                plcc_runtime::run::start(image, &*code, &args.run, service)
            }
            Err(message) => {
                report::tell(&format!("runtime: {message}"));
                plcc_runtime::run::EXIT_USAGE
            }
        },
        Err(exit) => exit,
    }
}

/// Repeats a recorded run.
pub fn replay(args: &ReplayArgs) -> u8 {
    let mut run = args.run.clone();
    let others = [("--record", &run.run.record), ("--replay", &run.run.replay)];
    if let Some((flag, _)) = others.iter().find(|(_, file)| file.is_some()) {
        report::say(&format!("`plcc replay` repeats one recording; leave out {flag}"));
        return exit::USAGE;
    }
    run.run.replay = Some(args.recording.clone());
    self::run(&run)
}

/// Compiles the program, also with probes if a page may watch it. `Err`: the exit code, after messages.
pub fn compile(args: &RunArgs) -> Result<(ProgramImage, CodeSource), u8> {
    let read = inputs::read_as(&inputs::or_here(&args.inputs)?, args.compile.code_page);
    let unreadable = read.is_unreadable();
    let settings = pipeline::Settings { require_main: true, ..pipeline::Settings::new(&args.compile) };
    let has_page = |services: &ServicesConfig| args.services.web.is_some() || services.web.is_some();
    let bound = drawings::bind(pipeline::parse(read, &settings), &settings, has_page);
    let bound = accepted(bound, unreadable, &settings)?;
    let mut plain = pipeline::lower_begun(&bound, args.optimization.optimization());
    let is_watched = has_page(&bound.program.config.services) && !args.run.is_many();
    let probed = is_watched.then(|| pipeline::optimize(pipeline::lower_beside(&bound, &mut plain)));
    let mut plain = pipeline::optimize(plain);
    if let Some(probed) = &probed {
        plain.share_image(&probed.image);
    }
    let code = code::source(&plain, probed.as_ref()).map_err(|error| internal(&error))?;
    Ok((plain.image, code))
}
