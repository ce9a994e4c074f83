//! `plcc plot`.

use plcc_runtime::files::{regular, writable};

use super::exit;
use crate::cli::PlotArgs;
use crate::{plot, report};

/// Draws a trace.
pub fn plot(args: &PlotArgs) -> u8 {
    let trace = args.trace.display();
    let text = match regular(&args.trace).and_then(|()| std::fs::read_to_string(&args.trace)) {
        Ok(text) => text,
        Err(error) => return fail(&format!("cannot read `{trace}`: {error}")),
    };
    let output = args.output.clone().unwrap_or_else(|| args.trace.with_extension("svg"));
    let picture = match plot::picture(&text, args.title.as_deref().unwrap_or_default()) {
        Ok(picture) => picture,
        Err(message) => return fail(&format!("{trace}: {message}")),
    };
    match writable(&output).and_then(|()| std::fs::write(&output, picture)) {
        Ok(()) => exit::OK,
        Err(error) => fail(&format!("cannot write `{}`: {error}", output.display())),
    }
}

fn fail(message: &str) -> u8 {
    report::say(message);
    exit::USAGE
}
