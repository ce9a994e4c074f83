//! `plcc convert --report`.

use plcc_convert::migration::{self, Migration};
use plcc_diag::Diagnostic;
use plcc_model::profile;

use crate::cli::ConvertArgs;
use crate::command::exit;
use crate::{inputs, pipeline, report};

/// Writes what the CPUs of a family have of a program.
pub(super) fn report(args: &ConvertArgs, family: &str) -> u8 {
    let Some(target) = profile::lookup(family) else {
        report::say(&format!("plcc does not know the CPU `{family}`; there are reports for `s7-1200` and `s7-1500`"));
        return exit::USAGE;
    };
    let read = inputs::read_as(&args.inputs, args.code_page);
    let unreadable = read.is_unreadable();
    let settings = pipeline::Settings { cpu: args.cpu.clone(), partial: args.partial, ..pipeline::Settings::default() };
    let mut bound = pipeline::front(read, &settings);
    if bound.has_errors() {
        bound.diagnostics.retain(Diagnostic::is_error);
        report::messages(&mut bound.diagnostics, &bound.sources);
        report::say(&report::summary(&bound.diagnostics));
        return if unreadable { exit::USAGE } else { exit::COMPILE };
    }
    if args.partial {
        report::messages(&mut bound.diagnostics, &bound.sources);
    }
    let migration = match Migration::of(target.family, &bound.program) {
        Ok(migration) => migration,
        Err(why) => {
            report::say(&format!("no report for `{family}`: {why}"));
            return exit::USAGE;
        }
    };
    let reference = plcc_xref::reference(&bound.program, &bound.sources);
    let text = migration::report(migration, &bound.program, &reference, &bound.sources).text();
    let written = match &args.output {
        Some(path) => super::output::write(path, &text),
        None => report::print(&text),
    };
    written.err().unwrap_or(exit::OK)
}
