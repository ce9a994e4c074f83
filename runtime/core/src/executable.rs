//! The entry point of a compiled program.

use std::ffi::{CStr, OsString, c_char, c_int};
use std::io::Write;
use std::os::unix::ffi::OsStringExt;
use std::rc::Rc;
use std::sync::Arc;

use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser};
use plcc_abi::ProgramImage;

use crate::change::{self, Loader};
use crate::code::{Code, Entries};
use crate::linked::{LinkedCode, linked_program};
use crate::online::Service;
use crate::options::{RunOptions, negative_value, without_services};
use crate::testing::{TEST_VARIABLE, TestJob};

#[derive(Parser)]
#[command(about = "A PLC program compiled by plcc.", version)]
struct CommandLine<O: Args> {
    #[command(flatten)]
    run: RunOptions,
    #[command(flatten)]
    services: O,
}

/// What answers clients, and what was opened for them, a line each.
pub type Opened = (Option<Box<dyn Service>>, Vec<String>);

/// Flags of services, which open them.
pub trait Opener: Args {
    /// `flags_only`: nothing but flags counts, not what plc.toml says. `loader` is for clients that may load another program. `Err`: why nothing
    /// is open.
    fn open(&self, image: &ProgramImage, flags_only: bool, loader: Option<Loader>) -> Result<Opened, String>;

    /// Clients may load another program.
    fn allows_load(&self) -> bool;
}

/// The flags of an executable without services.
#[derive(Args)]
struct NoServices {}

impl Opener for NoServices {
    fn open(&self, _image: &ProgramImage, _flags_only: bool, _loader: Option<Loader>) -> Result<Opened, String> {
        Ok((None, Vec::new()))
    }

    fn allows_load(&self) -> bool {
        false
    }
}

/// Entry point of a process without services.
///
/// # Safety
/// Called by the C runtime only, with its `argc` and `argv`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn plcc_main(argc: c_int, argv: *const *const c_char) -> c_int {
    // SAFETY: as the caller promises.
    unsafe { main_of::<NoServices>(argc, argv) }
}

/// What entry points do.
///
/// # Safety
/// `argc` and `argv` are those of the process.
pub unsafe fn main_of<O: Opener>(argc: c_int, argv: *const *const c_char) -> c_int {
    if let Ok(job) = std::env::var(TEST_VARIABLE) {
        return test(&job);
    }
    let arguments = (0..usize::try_from(argc).unwrap_or(0)).map(|index| {
        // SAFETY: the C runtime passes `argc` pointers to strings that end in 0.
        let argument = unsafe { CStr::from_ptr(*argv.add(index)) };
        OsString::from_vec(argument.to_bytes().to_vec())
    });
    let arguments: Vec<OsString> = arguments.collect();
    let CommandLine::<O> { run, services } = match CommandLine::try_parse_from(&arguments) {
        Ok(command) => command,
        Err(error) if error.kind() == ErrorKind::DisplayVersion => return version(),
        Err(error) => {
            let words: Vec<&str> = arguments.iter().filter_map(|argument| argument.to_str()).collect();
            return usage(&error, negative_value(&error, &CommandLine::<O>::command(), &words));
        }
    };
    match linked_program(0) {
        Ok((image, entries)) => {
            // The code with probes is another program, beside the first.
            let probed = match image.config.services.probes {
                Some(_) => linked_program(1).map_or_else(|_| Vec::new(), |(_, entries)| entries),
                None => Vec::new(),
            };
            let code =
                move || -> Rc<dyn Code> { Rc::new(LinkedCode(Entries::watched(entries.clone(), probed.clone()))) };
            let (loader, inbox) = match services.allows_load() && !run.flags_only() {
                true => Some(change::loader(&run)).unzip(),
                false => (None, None),
            };
            match services.open(&image, run.flags_only(), loader) {
                Ok((service, opened)) => {
                    // For many CPUs clients are refused.
                    opened.iter().filter(|_| !run.is_many()).for_each(|line| crate::run::say!("{line}"));
                    c_int::from(match inbox {
                        Some(inbox) => crate::run::start_changeable(image, Arc::new(code), &run, service, inbox),
                        None => crate::run::start(image, &code, &run, service),
                    })
                }
                Err(message) => {
                    crate::run::say!("runtime: {message}");
                    c_int::from(crate::run::EXIT_USAGE)
                }
            }
        }
        Err(error) => damaged(&error),
    }
}

/// The name of the program and its CPU, and the compiler that made it.
fn version() -> c_int {
    match linked_program(0) {
        Ok((image, _)) => {
            let (name, cpu) = (&image.name, &image.profile.name);
            let _ = writeln!(std::io::stdout(), "{name} for {cpu}, compiled by plcc {}", env!("CARGO_PKG_VERSION"));
            c_int::from(crate::run::EXIT_OK)
        }
        Err(error) => damaged(&error),
    }
}

/// Help goes to standard output, errors in the flags to standard error; `told` is what is wrong if the error does not say it. No line begins
/// like a message about a source.
fn usage(error: &clap::Error, told: Option<String>) -> c_int {
    if !error.use_stderr() {
        let _ = error.print();
        return c_int::from(crate::run::EXIT_OK);
    }
    let text = told.or_else(|| without_services(error)).unwrap_or_else(|| error.render().to_string());
    // A closed standard error changes nothing.
    let _ = writeln!(std::io::stderr(), "runtime: {}", text.strip_prefix("error: ").unwrap_or(&text).trim_end());
    c_int::from(crate::run::EXIT_USAGE)
}

fn damaged(error: &str) -> c_int {
    crate::run::say!("runtime: this executable is damaged: {error}");
    c_int::from(crate::run::EXIT_USAGE)
}

/// Runs as a test; the report goes to standard output.
fn test(job: &str) -> c_int {
    let report = serde_json::from_str::<TestJob>(job).map_err(|error| error.to_string()).and_then(|job| {
        let (image, entries) = linked_program(job.program)?;
        let code: Rc<dyn Code> = Rc::new(LinkedCode(Entries::new(entries)));
        let report = crate::testing::test(image, code, &job.options);
        serde_json::to_string(&report).map_err(|error| error.to_string())
    });
    match report {
        Ok(report) => {
            println!("{report}");
            c_int::from(crate::run::EXIT_OK)
        }
        Err(error) => damaged(&error),
    }
}
