//! `plcc check`.

use crate::cli::CheckArgs;
use crate::command::exit;
use crate::report::{self, MessageFormat};
use crate::{inputs, pipeline};

/// Reports all messages. Returns 3 after an error, 1 after a warning that the command line refuses, otherwise 0.
pub fn check(args: &CheckArgs) -> u8 {
    let inputs = match inputs::or_here(&args.inputs) {
        Ok(inputs) => inputs,
        Err(code) => return code,
    };
    let read = inputs::read_as(&inputs, args.compile.code_page);
    let unreadable = read.is_unreadable();
    // A single file may be part of a program; a project is a whole one.
    let settings = pipeline::Settings::new(&args.compile);
    let require_main = read.project.is_some() && !settings.is_partial(read.project.as_ref());
    let settings = pipeline::Settings { require_main, ..settings };
    let mut bound = pipeline::front(read, &settings);
    if let Err(code) = report::messages_as(&mut bound.diagnostics, &bound.sources, args.message_format) {
        return code;
    }
    if args.message_format == MessageFormat::Human && !bound.diagnostics.is_empty() {
        report::say(&report::summary(&bound.diagnostics));
    }
    match (unreadable, bound.has_errors()) {
        (true, _) => exit::USAGE,
        (false, true) => exit::COMPILE,
        (false, false) if bound.is_denied(&settings) => exit::FAILED,
        (false, false) => exit::OK,
    }
}
