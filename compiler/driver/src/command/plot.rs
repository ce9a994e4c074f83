//! `plcc plot`.

use std::path::Path;

use plcc_runtime::files::{regular, writable};
use plcc_runtime::trace::page;

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
    let ends_in = |wanted: &str| output.extension().is_some_and(|own| own.eq_ignore_ascii_case(wanted));
    if !ends_in("svg") && !ends_in("html") {
        return fail(&format!("`{}` must end in .svg, for a picture, or in .html, for a page", output.display()));
    }
    if ends_in("html") {
        let title = args.title.clone().unwrap_or_else(|| trace.to_string());
        // A trace that cannot be drawn as a picture is none here either.
        return match plot::picture(&text, "") {
            Ok(_) => {
                write(&output, &(page::head(&title) + &text.replace('<', "&lt;") + "</script>\n</body>\n</html>\n"))
            }
            Err(message) => fail(&format!("{trace}: {message}")),
        };
    }
    let picture = match plot::picture(&text, args.title.as_deref().unwrap_or_default()) {
        Ok(picture) => picture,
        Err(message) => return fail(&format!("{trace}: {message}")),
    };
    write(&output, &picture)
}

fn write(output: &Path, text: &str) -> u8 {
    match writable(output).and_then(|()| std::fs::write(output, text)) {
        Ok(()) => report::print(&format!("wrote {}\n", output.display())).err().unwrap_or(exit::OK),
        Err(error) => fail(&format!("cannot write `{}`: {error}", output.display())),
    }
}

fn fail(message: &str) -> u8 {
    report::say(message);
    exit::USAGE
}
