//! The program that is linked next to the runtime: its image and its code.

use std::ffi::{c_int, c_void};

use plcc_abi::ProgramImage;
use plcc_abi::linked::LinkedProgram;

use crate::code::{Code, Entries, EntryFunction};

unsafe extern "C" {
    /// Defined by the object file of the program.
    static plcc_program: LinkedProgram;
}

/// The entry functions of the linked program.
pub struct LinkedCode(pub Entries);

impl Code for LinkedCode {
    fn call(&self, entry: u32, mem: *mut u8, lbase: u32, vbase: u32) {
        if let Some(function) = self.0.get(entry) {
            // SAFETY: the object file that defines the table also defines the function, by the contract of `plcc_abi`;
            // `mem`, `lbase` and `vbase` come from the runtime.
            unsafe { function(mem, lbase, vbase) }
        }
    }

    fn watch(&self, is_watched: bool) {
        self.0.watch(is_watched);
    }
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
pub fn linked_program(number: usize) -> Result<(ProgramImage, Vec<EntryFunction>), String> {
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
