//! `main` of a compiled program: its image and code are linked beside the runtime.

use std::ffi::{CStr, OsString, c_char, c_int};
use std::os::unix::ffi::OsStringExt;
use std::rc::Rc;

use clap::Parser;
use plcc_abi::ProgramImage;

use crate::code::{Code, EntryFunction};
use crate::options::RunOptions;

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
    let arguments = (0..usize::try_from(argc).unwrap_or(0)).map(|index| {
        // SAFETY: the C runtime gives `argc` pointers to strings that end in 0.
        let argument = unsafe { CStr::from_ptr(*argv.add(index)) };
        OsString::from_vec(argument.to_bytes().to_vec())
    });
    let run = match CommandLine::try_parse_from(arguments) {
        Ok(command) => command.run,
        Err(error) => {
            let _ = error.print();
            return error.exit_code();
        }
    };
    // SAFETY: the object file of the program defines the four symbols; the lengths are those of the tables.
    let (image, entries) = unsafe {
        (
            std::slice::from_raw_parts(&raw const plcc_image, plcc_image_len as usize),
            std::slice::from_raw_parts(&raw const plcc_entries, plcc_entries_len as usize),
        )
    };
    match postcard::from_bytes::<ProgramImage>(image) {
        Ok(image) => c_int::from(crate::run::run(image, Rc::new(LinkedCode(entries)), &run)),
        Err(error) => {
            eprintln!("runtime: this executable is damaged: {error}");
            c_int::from(crate::run::EXIT_USAGE)
        }
    }
}
