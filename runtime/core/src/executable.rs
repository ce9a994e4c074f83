//! `main` of a compiled program: its image and code are linked next to the runtime.

use std::ffi::{CStr, OsString, c_char, c_int};
use std::io::Write;
use std::os::unix::ffi::OsStringExt;
use std::rc::Rc;

use clap::Parser;
use plcc_abi::ProgramImage;

use crate::code::{Code, EntryFunction};
use crate::options::RunOptions;
use crate::testing::{TEST_VARIABLE, TestJob};

unsafe extern "C" {
    static plcc_image: u8;
    static plcc_image_len: u64;
    static plcc_entries: EntryFunction;
    static plcc_entries_len: u64;
}

#[derive(Parser)]
#[command(about = "A PLC program compiled by plcc.", disable_version_flag = true)]
struct CommandLine {
    #[command(flatten)]
    run: RunOptions,
}

/// The entry functions of the linked program.
struct LinkedCode(&'static [EntryFunction]);

impl Code for LinkedCode {
    fn call(&self, entry: u32, mem: *mut u8, lbase: u32, vbase: u32) {
        if let Some(function) = self.0.get(entry as usize) {
            // SAFETY: the object file that defines the table also defines the function, by the contract of `plcc_abi`;
            // `mem`, `lbase` and `vbase` come from the runtime.
            unsafe { function(mem, lbase, vbase) }
        }
    }
}

/// Entry point of the process.
///
/// # Safety
/// Called by the C runtime only, with its `argc` and `argv`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn main(argc: c_int, argv: *const *const c_char) -> c_int {
    if let Ok(job) = std::env::var(TEST_VARIABLE) {
        return test(&job);
    }
    let arguments = (0..usize::try_from(argc).unwrap_or(0)).map(|index| {
        // SAFETY: the C runtime passes `argc` pointers to strings that end in 0.
        let argument = unsafe { CStr::from_ptr(*argv.add(index)) };
        OsString::from_vec(argument.to_bytes().to_vec())
    });
    let run = match CommandLine::try_parse_from(arguments) {
        Ok(command) => command.run,
        Err(error) => return usage(&error),
    };
    match linked_program(0) {
        Ok((image, code)) => c_int::from(crate::run::run(image, code, &run)),
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

/// Where a program that shares the executable with others has its four symbols.
#[repr(C)]
struct DirectoryEntry {
    image: *const u8,
    image_len: *const u64,
    entries: *const EntryFunction,
    entries_len: *const u64,
}

/// The program with this number; the only one has number 0.
fn linked_program(number: usize) -> Result<(ProgramImage, Rc<dyn Code>), String> {
    // SAFETY: the object file of the program defines the four symbols; the lengths are those of the tables. An image of length 0
    // is a directory of `plcc_entries_len` programs whose pointers are these symbols.
    let (image, entries) = unsafe {
        let mut found = DirectoryEntry {
            image: &raw const plcc_image,
            image_len: &raw const plcc_image_len,
            entries: &raw const plcc_entries,
            entries_len: &raw const plcc_entries_len,
        };
        if plcc_image_len == 0 {
            let directory = (&raw const plcc_image).cast::<DirectoryEntry>();
            let directory = std::slice::from_raw_parts(directory, plcc_entries_len as usize);
            let entry = directory.get(number).ok_or_else(|| format!("program {number} does not exist"))?;
            found = DirectoryEntry { ..*entry };
        }
        (
            std::slice::from_raw_parts(found.image, *found.image_len as usize),
            std::slice::from_raw_parts(found.entries, *found.entries_len as usize),
        )
    };
    let image = postcard::from_bytes::<ProgramImage>(image).map_err(|error| error.to_string())?;
    Ok((image, Rc::new(LinkedCode(entries))))
}

/// Runs as a test; the report goes to standard output.
fn test(job: &str) -> c_int {
    let report = serde_json::from_str::<TestJob>(job).map_err(|error| error.to_string()).and_then(|job| {
        let (image, code) = linked_program(job.program)?;
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
