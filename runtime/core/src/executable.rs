//! The entry point of a compiled program: its image and code are linked next to the runtime.

use std::ffi::{CStr, OsString, c_char, c_int, c_void};
use std::io::Write;
use std::os::unix::ffi::OsStringExt;
use std::rc::Rc;

use clap::{Args, Parser};
use plcc_abi::ProgramImage;
use plcc_abi::linked::LinkedProgram;

use crate::code::{Code, EntryFunction};
use crate::online::Service;
use crate::options::RunOptions;
use crate::testing::{TEST_VARIABLE, TestJob};

unsafe extern "C" {
    /// Defined by the object file of the program.
    static plcc_program: LinkedProgram;
}

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

/// Flags of services, which open them. `Err`: why not.
pub trait Opener: Args {
    fn open(&self, image: &ProgramImage) -> Result<Opened, String>;
}

/// The flags of an executable without services.
#[derive(Args)]
struct NoServices {}

impl Opener for NoServices {
    fn open(&self, _image: &ProgramImage) -> Result<Opened, String> {
        Ok((None, Vec::new()))
    }
}

/// The entry functions of the linked program.
struct LinkedCode(Vec<EntryFunction>);

impl Code for LinkedCode {
    fn call(&self, entry: u32, mem: *mut u8, lbase: u32, vbase: u32) {
        if let Some(function) = self.0.get(entry as usize) {
            // SAFETY: the object file that defines the table also defines the function, by the contract of `plcc_abi`;
            // `mem`, `lbase` and `vbase` come from the runtime.
            unsafe { function(mem, lbase, vbase) }
        }
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
    let CommandLine::<O> { run, services } = match CommandLine::try_parse_from(arguments) {
        Ok(command) => command,
        Err(error) if error.kind() == clap::error::ErrorKind::DisplayVersion => return version(),
        Err(error) => return usage(&error),
    };
    match linked_program(0) {
        Ok((image, entries)) => {
            let code = || -> Rc<dyn Code> { Rc::new(LinkedCode(entries.clone())) };
            match services.open(&image) {
                Ok((service, opened)) => {
                    opened.iter().for_each(|line| crate::run::say!("{line}"));
                    c_int::from(crate::run::start(image, &code, &run, service))
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

/// Help goes to standard output, errors in the flags to standard error. No line begins like a message about
/// a source.
fn usage(error: &clap::Error) -> c_int {
    if !error.use_stderr() {
        let _ = error.print();
        return c_int::from(crate::run::EXIT_OK);
    }
    let text = error.render().to_string();
    // A closed standard error changes nothing.
    let _ = writeln!(std::io::stderr(), "runtime: {}", text.strip_prefix("error: ").unwrap_or(&text).trim_end());
    c_int::from(crate::run::EXIT_USAGE)
}

fn damaged(error: &str) -> c_int {
    eprintln!("runtime: this executable is damaged: {error}");
    c_int::from(crate::run::EXIT_USAGE)
}

/// The place to which a field leads that contains its own distance from there.
///
/// # Safety
/// `field` is part of a linked program.
unsafe fn target<T>(field: *const i32) -> *const T {
    // SAFETY: the linker wrote the field, and what it leads to is in the same executable.
    unsafe { field.byte_offset(field.read() as isize).cast() }
}

/// The program with this number; the only one has number 0.
fn linked_program(number: usize) -> Result<(ProgramImage, Vec<EntryFunction>), String> {
    let mut program = &raw const plcc_program;
    // SAFETY: the object file of the program defines the symbol and all that its fields lead to, with these lengths, by the
    // contract of `plcc_abi`. Each entry is the address of an entry function.
    let (image, entries) = unsafe {
        if (*program).image_len == 0 {
            if number as u64 >= (*program).entries_len {
                return Err(format!("program {number} does not exist"));
            }
            let table: *const i32 = target(&raw const (*program).entries);
            program = target(table.add(number));
        }
        let image = std::slice::from_raw_parts(target(&raw const (*program).image), (*program).image_len as usize);
        let table: *const i32 = target(&raw const (*program).entries);
        let function = |entry| std::mem::transmute::<*const u8, EntryFunction>(target(table.add(entry)));
        (image, (0..(*program).entries_len as usize).map(function).collect())
    };
    let image = postcard::from_bytes::<ProgramImage>(image).map_err(|error| error.to_string())?;
    Ok((image, entries))
}

/// `memset` of the C library, for generated code: a finished executable has no other name for it.
///
/// # Safety
/// As `memset`.
#[unsafe(no_mangle)]
unsafe extern "C" fn plcc_memset(to: *mut c_void, byte: c_int, len: usize) -> *mut c_void {
    // SAFETY: as the caller promises.
    unsafe { libc::memset(to, byte, len) }
}

/// `memmove` of the C library, likewise.
///
/// # Safety
/// As `memmove`.
#[unsafe(no_mangle)]
unsafe extern "C" fn plcc_memmove(to: *mut c_void, from: *const c_void, len: usize) -> *mut c_void {
    // SAFETY: as the caller promises.
    unsafe { libc::memmove(to, from, len) }
}

/// Runs as a test; the report goes to standard output.
fn test(job: &str) -> c_int {
    let report = serde_json::from_str::<TestJob>(job).map_err(|error| error.to_string()).and_then(|job| {
        let (image, entries) = linked_program(job.program)?;
        let code: Rc<dyn Code> = Rc::new(LinkedCode(entries));
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
