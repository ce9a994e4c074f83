//! A program that is put into the memory of this process: for `plcc load`. The code runs with all rights of the process.

use std::ffi::c_void;
use std::mem::offset_of;
use std::ptr::NonNull;
use std::rc::Rc;
use std::sync::Arc;

use plcc_abi::linked::LinkedProgram;
use plcc_abi::loadable::{Head, SLOT_BYTES, fingerprint};
use plcc_abi::{ProgramImage, RuntimeFn};

use crate::change::CodeSource;
use crate::code::{Entries, EntryFunction};
use crate::{functions, guest};

/// Memory with code. It is freed when no entry function of it is in use.
struct Mapping {
    base: NonNull<u8>,
    bytes: usize,
}

// SAFETY: after it was made, the memory is only read and executed.
unsafe impl Send for Mapping {}
// SAFETY: as above.
unsafe impl Sync for Mapping {}

impl Mapping {
    /// Memory with these bytes, `slots` in front of them, that can be read and executed and no longer written.
    fn new(content: &[u8], slots: &[*const u8]) -> Result<Mapping, String> {
        let failed = || format!("no memory for the program: {}", std::io::Error::last_os_error());
        let (protection, flags) = (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS);
        // SAFETY: a new mapping of its own.
        let base = unsafe { libc::mmap(std::ptr::null_mut(), content.len(), protection, flags, -1, 0) };
        let base = if base == libc::MAP_FAILED { None } else { NonNull::new(base.cast::<u8>()) };
        let mapping = Mapping { base: base.ok_or_else(failed)?, bytes: content.len() };
        // SAFETY: the mapping has these bytes, and there are at least as many as the slots take, which the caller has checked.
        unsafe {
            std::ptr::copy_nonoverlapping(content.as_ptr(), mapping.base.as_ptr(), content.len());
            std::ptr::copy_nonoverlapping(slots.as_ptr().cast::<u8>(), mapping.base.as_ptr(), slots.len() * SLOT_BYTES);
        }
        // SAFETY: the whole mapping, which nothing else knows.
        let made = unsafe {
            libc::mprotect(mapping.base.as_ptr().cast::<c_void>(), mapping.bytes, libc::PROT_READ | libc::PROT_EXEC)
        };
        if made == 0 { Ok(mapping) } else { Err(failed()) }
    }

    fn bytes(&self) -> &[u8] {
        // SAFETY: readable for as long as it lives.
        unsafe { std::slice::from_raw_parts(self.base.as_ptr(), self.bytes) }
    }
}

impl Drop for Mapping {
    fn drop(&mut self) {
        // SAFETY: the mapping that `new` made.
        unsafe { libc::munmap(self.base.as_ptr().cast::<c_void>(), self.bytes) };
    }
}

/// Puts a program into memory. `Err`: why not.
pub fn load(bytes: &[u8]) -> Result<(ProgramImage, CodeSource), String> {
    let damaged = || "what was sent is not a program, or damaged".to_string();
    let (head, content) = Head::decode(bytes).ok_or_else(damaged)?;
    if head.fingerprint != fingerprint() {
        return Err("another version of plcc has compiled this program, or for another processor".to_string());
    }
    let library: [*const u8; 2] = [libc::memset as *const u8, libc::memmove as *const u8];
    let slots: Vec<*const u8> = RuntimeFn::ALL.iter().map(|&one| functions::address(one)).chain(library).collect();
    if content.len() < slots.len() * SLOT_BYTES {
        return Err(damaged());
    }
    let mapping = Mapping::new(content, &slots)?;
    let parts = parts(mapping.bytes(), head.program).ok_or_else(damaged)?;
    let (image, entries) = parts.first().ok_or_else(damaged)?;
    let mut image = postcard::from_bytes::<ProgramImage>(image).map_err(|_| damaged())?;
    if image.blocks.iter().any(|block| block.entry as usize >= entries.len()) {
        return Err(damaged());
    }
    let function = |&at: &usize| {
        // SAFETY: the place of an entry function in the mapping, by the contract of `plcc_abi`.
        unsafe { std::mem::transmute::<*const u8, EntryFunction>(mapping.base.as_ptr().add(at)) }
    };
    let functions = |entries: &[usize]| entries.iter().map(function).collect::<Vec<_>>();
    let plain = functions(entries);
    // The code with probes is another program, beside the first.
    let probed = match parts.get(1) {
        Some((_, entries)) if entries.len() == plain.len() => functions(entries),
        Some(_) | None => Vec::new(),
    };
    if probed.is_empty() {
        image.config.services.probes = None;
    }
    let mapping = Arc::new(mapping);
    let code: CodeSource = Arc::new(move || {
        let entries = Entries::watched(plain.clone(), probed.clone());
        Rc::new(guest::NativeCode::new(entries, Arc::clone(&mapping)))
    });
    Ok((image, code))
}

/// A program, and the same with probes.
const PROGRAMS_MAX: usize = 2;

/// The encoded image of a program, and where its entry functions are.
type Part<'a> = (&'a [u8], Vec<usize>);

/// The program at this place, or those to which a directory there leads, all of them inside.
fn parts(content: &[u8], program: u64) -> Option<Vec<Part<'_>>> {
    let start = usize::try_from(program).ok()?;
    match part(content, start)? {
        (&[], programs) if programs.len() <= PROGRAMS_MAX => {
            programs.into_iter().map(|start| part(content, start)).collect()
        }
        one => Some(vec![one]),
    }
}

fn part(content: &[u8], start: usize) -> Option<Part<'_>> {
    let number = |at: usize| Some(u64::from_ne_bytes(content.get(at..at.checked_add(8)?)?.try_into().ok()?));
    // What a field leads to that has its own distance from there.
    let target = |at: usize| {
        let distance = i32::from_ne_bytes(content.get(at..at.checked_add(4)?)?.try_into().ok()?);
        at.checked_add_signed(distance as isize).filter(|target| *target < content.len())
    };
    let length = usize::try_from(number(start.checked_add(offset_of!(LinkedProgram, image_len))?)?).ok()?;
    let count = usize::try_from(number(start + offset_of!(LinkedProgram, entries_len))?).ok()?;
    let image = target(start + offset_of!(LinkedProgram, image))?;
    let table = target(start + offset_of!(LinkedProgram, entries))?;
    let image = content.get(image..image.checked_add(length)?)?;
    let entries = (0..count.min(content.len())).map(|index| target(table + 4 * index)).collect::<Option<Vec<_>>>()?;
    Some((image, entries))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_program_is_refused() {
        let wrong = |bytes: &[u8]| load(bytes).err().unwrap_or_default();
        assert!(wrong(b"").contains("not a program"));
        let with = |fingerprint: u64, program: u64, content: &[u8]| {
            let head = Head { fingerprint, program, sum: plcc_abi::loadable::sum(content) };
            [&head.encode()[..], content].concat()
        };
        assert!(wrong(&with(7, 0, &[0; 64])).contains("another version"));
        assert!(wrong(&with(fingerprint(), 0, &[0; 64])).contains("not a program"));
        // Distances that lead out of it.
        for program in [0, 8, 60_000, u64::MAX - 4, u64::MAX] {
            for byte in [0, 1, 0x7F, 0xFF] {
                assert!(
                    wrong(&with(fingerprint(), program, &vec![byte; 60_010])).contains("not a program"),
                    "{program} {byte}"
                );
            }
        }
        let mut changed = with(fingerprint(), 0, &[0; 64]);
        changed[40] = 1;
        assert!(wrong(&changed).contains("damaged"));
    }
}
