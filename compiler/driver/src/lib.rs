//! The command line of plcc: reads, calls, prints, links.
//!
//! - [`cli`]: the command line; [`command`]: the commands.
//! - [`inputs`], [`content`], [`sheets`], [`project`]: from arguments to files.
//! - [`pipeline`]: from files to code, one function per stage; [`emit`]: its forms as text; [`statistics`]: what networks cost;
//!   [`link`]: executables; [`cache`]: code of earlier builds.
//! - [`station`]: the modules of a project; [`plot`]: pictures of traces.
//! - `parallel`: work for all processors.
//! - [`code`]: code that runs in this process; `live`: programs that are changed while they run; [`testing`]: `plcc test`.
//! - [`report`] writes messages.
//!
//! **Invariant**: the only compiler crate that does I/O.

use std::ffi::OsString;

use clap::Parser;

mod arguments;
pub mod axes;
mod beginning;
pub mod cache;
pub mod cli;
pub mod code;
pub mod command;
pub mod connections;
pub mod content;
pub mod cpu_settings;
mod drawings;
pub mod emit;
pub mod inputs;
mod keys;
pub mod link;
mod live;
mod memory;
mod near;
pub mod package;
mod parallel;
pub mod pipeline;
pub mod plot;
pub mod project;
pub mod remote;
pub mod report;
pub mod retain;
pub mod s7200;
pub mod services;
pub mod sheets;
pub mod station;
pub mod statistics;
pub mod technology;
pub mod testing;
mod value_names;
mod variables;

use cli::{Cli, Command};
use command::exit;

/// Stack size of the threads that compile, in bytes. Nesting in a source is recursion in the compiler; only used pages take memory.
pub const COMPILE_STACK_BYTES: usize = 256 << 20;

/// Runs the command in `args`, whose first item is the name of the program. Returns the exit code.
pub fn main_with(args: impl IntoIterator<Item = OsString>) -> u8 {
    let args: Vec<OsString> = args.into_iter().collect();
    if let Some(told) = arguments::fault(&args) {
        report::say(&told);
        return exit::USAGE;
    }
    match Cli::try_parse_from(&args) {
        Ok(cli) => on_large_stack(move || dispatch(&cli)).unwrap_or_else(|fault| {
            report::say(&format!("internal fault, please report it: {fault}"));
            exit::COMPILE
        }),
        Err(error) => match arguments::refused(&error, &args) {
            Some(told) => {
                report::say(&told);
                exit::USAGE
            }
            None => usage(&error),
        },
    }
}

fn dispatch(cli: &Cli) -> u8 {
    match &cli.command {
        Command::Build(args) => command::build::build(args),
        Command::Run(args) => command::run::run(args),
        Command::Load(args) => command::load::load(args),
        Command::Monitor(args) => command::monitor::monitor(args),
        Command::Test(args) => command::test::test(args),
        Command::Check(args) => command::check::check(args),
        Command::Xref(args) => command::xref::xref(args),
        Command::Replay(args) => command::run::replay(args),
        Command::Debug(args) => command::debug::debug(args),
        Command::Status(args) => command::status::status(args),
        Command::Fmt(args) => command::fmt::fmt(args),
        Command::Lsp => command::lsp::lsp(),
        Command::New(args) => command::new::new(args),
        Command::Completions { shell } => command::manual::completions(*shell),
        Command::Man { folder } => command::manual::pages(folder),
        Command::Station { folder } => command::station::station(folder),
        Command::Convert(args) => command::convert::convert(args),
        Command::Password { user } => command::password::password(*user),
        Command::Plot(args) => command::plot::plot(args),
        Command::View(args) => command::view::view(args),
        Command::Explain { code } => command::explain::explain(code),
    }
}

/// Runs `work` in a thread with a large stack. `Err`: the message of a panic.
pub fn on_large_stack<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Result<T, String> {
    let thread = std::thread::Builder::new().stack_size(COMPILE_STACK_BYTES).spawn(work).map_err(|e| e.to_string())?;
    thread.join().map_err(|panic| panic_text(panic.as_ref()))
}

/// The message of a panic.
pub fn panic_text(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "a panic without a message".to_string())
}

/// Writes help and version to standard output, and errors in the arguments to standard error. No line begins like a message
/// about a source.
fn usage(error: &clap::Error) -> u8 {
    if !error.use_stderr() {
        let _ = error.print();
        return exit::OK;
    }
    let text = error.render().to_string();
    // The words of Rust for a number that does not parse.
    let text = ["invalid digit found in string", "invalid float literal", "cannot parse integer from empty string"]
        .iter()
        .fold(text, |text, words| text.replace(words, "it is not a number"));
    // An unknown flag is not meant as the name of a file.
    let is_told = |line: &&str| !line.trim_start().starts_with("tip: to pass '");
    let text = text.lines().filter(is_told).collect::<Vec<_>>().join("\n").replace("\n\n\n", "\n\n");
    report::say(text.strip_prefix("error: ").unwrap_or(&text).trim_end());
    exit::USAGE
}
