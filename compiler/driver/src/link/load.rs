//! A program as bytes that a running process puts into its memory: for `plcc load`.
//!
//! Nothing in it depends on where it is: code reaches the runtime through short jumps in front of it, whose targets the process fills in; see
//! `plcc_abi::loadable`.

use plcc_abi::RuntimeFn;
use plcc_abi::linked;
use plcc_abi::loadable::{self, Head};

use super::LinkError;
use super::place::{CODE, PROGRAM, Start, parse, place};
use super::relocate::relocate;

/// Where the bytes after the head are during linking; any address but 0.
const BASE: u64 = 0x10000;

/// Links the objects of a program to a loadable one. Only for x86-64, as all that plcc itself links.
pub fn loadable(objects: &[impl AsRef<[u8]>]) -> Result<Vec<u8>, LinkError> {
    if !cfg!(target_arch = "x86_64") {
        return Err(LinkError::Object("programs are loaded into processes for x86-64 only".to_string()));
    }
    let names = RuntimeFn::ALL.iter().map(|function| function.symbol());
    let names: Vec<&str> = names.chain(linked::LIBRARY_FUNCTIONS.map(|(_, exported)| exported)).collect();
    let slots = names.len() * loadable::SLOT_BYTES;
    let mut bytes = vec![0; slots];
    let mut functions = Vec::new();
    for (number, name) in names.iter().enumerate() {
        let at = bytes.len();
        functions.push((name.as_bytes(), BASE + at as u64));
        // jmp [rip + distance]
        let distance = (number * loadable::SLOT_BYTES) as i64 - (at as i64 + 6);
        bytes.extend([0xFF, 0x25]);
        bytes.extend((distance as i32).to_le_bytes());
        bytes.extend([0xCC, 0xCC]);
    }
    // Sections for debuggers name it; they are left out.
    functions.push((linked::MEMORY_SYMBOL.as_bytes(), BASE));
    let program = bytes.len().next_multiple_of(64);
    let start = Start { address: BASE + program as u64, page: 64, functions };
    let objects: Vec<_> = objects.iter().map(|object| parse(object.as_ref())).collect::<Result<_, _>>()?;
    let mut image = place(&start, &objects)?;
    relocate(&objects, &mut image)?;
    for section in [PROGRAM, CODE] {
        let section = &image.sections[section];
        bytes.resize((section.address - BASE) as usize, 0xCC);
        bytes.extend(&section.bytes);
    }
    let head = Head { fingerprint: loadable::fingerprint(), program: program as u64, sum: loadable::sum(&bytes) };
    Ok([&head.encode()[..], &bytes].concat())
}
