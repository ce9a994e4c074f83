//! Fills addresses and distances into the sections of the program.
//!
//! Everything that is loaded uses distances, so the executable runs at any address and the loader has nothing to do for
//! the program. Only debuggers read addresses.

use object::read::{Object as _, ObjectSection as _, ObjectSymbol as _, Relocation};
use object::{RelocationKind, RelocationTarget, SymbolIndex};

use super::LinkError;
use super::place::{CODE, Image, ObjectFile, Place, wrong};

/// Applies all relocations of `objects`.
///
/// Errors: a symbol that is not defined, a relocation that code of plcc does not have, or a program that is too large.
pub fn relocate(objects: &[ObjectFile<'_>], image: &mut Image) -> Result<(), LinkError> {
    for (number, object) in objects.iter().enumerate() {
        // Symbols by their index in the object.
        let mut addresses: Vec<Option<u64>> = Vec::new();
        for section in object.sections() {
            let Some(place) = image.place(number, section.index()) else { continue };
            for (offset, relocation) in section.relocations() {
                let RelocationTarget::Symbol(symbol) = relocation.target() else {
                    return Err(unknown(&relocation));
                };
                if addresses.len() <= symbol.0 {
                    addresses.resize(symbol.0 + 1, None);
                }
                let address = match addresses[symbol.0] {
                    Some(address) => address,
                    None => address_of(image, number, object, symbol)?,
                };
                addresses[symbol.0] = Some(address);
                apply(image, place, offset, address, &relocation)?;
            }
        }
    }
    Ok(())
}

fn address_of(image: &Image, number: usize, object: &ObjectFile<'_>, index: SymbolIndex) -> Result<u64, LinkError> {
    let symbol = object.symbol_by_index(index).map_err(wrong)?;
    let address = match symbol.section_index() {
        Some(section) => image.address(number, section, symbol.address()),
        None => image.global(symbol.name_bytes().map_err(wrong)?),
    };
    address.ok_or_else(|| LinkError::Object(format!("nothing defines {}", symbol.name().unwrap_or("a symbol"))))
}

fn unknown(relocation: &Relocation) -> LinkError {
    LinkError::Object(format!("a relocation of an unknown kind: {relocation:?}"))
}

/// Writes `address` at `offset` of a section of an object, in the way that the relocation says.
fn apply(image: &mut Image, place: Place, offset: u64, address: u64, relocation: &Relocation) -> Result<(), LinkError> {
    let section = &mut image.sections[place.section];
    let at = (place.offset + offset) as usize;
    let target = address.wrapping_add_signed(relocation.addend());
    let distance = target.wrapping_sub(section.address + at as u64) as i64;
    let is_loaded = section.address != 0;
    let (value, bytes) = match (relocation.kind(), relocation.size()) {
        (RelocationKind::Absolute, 64) if !is_loaded => (target as i64, 8),
        (RelocationKind::Absolute, 32) if !is_loaded => (target as i64, 4),
        (RelocationKind::Relative | RelocationKind::PltRelative, 32) if is_loaded => (distance, 4),
        (RelocationKind::GotRelative, 32) if place.section == CODE && load_directly(&mut section.bytes, at) => {
            (distance, 4)
        }
        _ => return Err(unknown(relocation)),
    };
    let fits = bytes == 8 || if is_loaded { i32::try_from(value).is_ok() } else { u32::try_from(value).is_ok() };
    let field = section.bytes.get_mut(at..at + bytes).filter(|_| fits);
    let field = field.ok_or_else(|| LinkError::Object("a program of more than 2 GB".to_string()))?;
    field.copy_from_slice(&value.to_le_bytes()[..bytes]);
    Ok(())
}

/// Code loads the address of a function from a table that the loader fills, `mov r64, [rip + x]`; the function is in the same
/// executable, so `lea r64, [rip + x]` computes it. False if the instruction before `at` is another one.
fn load_directly(code: &mut [u8], at: usize) -> bool {
    const MOV: u8 = 0x8B;
    const LEA: u8 = 0x8D;
    let Some([rex, opcode, operands]) = at.checked_sub(3).and_then(|start| code.get_mut(start..at)) else {
        return false;
    };
    let is_wide = *rex & 0xF8 == 0x48;
    let is_relative = *operands & 0xC7 == 0x05;
    let is_load = is_wide && *opcode == MOV && is_relative;
    if is_load {
        *opcode = LEA;
    }
    is_load
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_load_of_an_address_becomes_its_computation() {
        // mov r9, [rip + 0]
        let mut code = [0x90, 0x4C, 0x8B, 0x0D, 0, 0, 0, 0];
        assert!(load_directly(&mut code, 4));
        assert_eq!(code, [0x90, 0x4C, 0x8D, 0x0D, 0, 0, 0, 0]);
    }

    #[test]
    fn other_instructions_stay() {
        // add rax, [rip + 0]; mov eax, [rip + 0]; mov rax, [rcx + 0]
        for code in [[0x48, 0x03, 0x05, 0, 0, 0, 0], [0x90, 0x8B, 0x05, 0, 0, 0, 0], [0x48, 0x8B, 0x81, 0, 0, 0, 0]] {
            let mut changed = code;
            assert!(!load_directly(&mut changed, 3), "{code:x?}");
            assert_eq!(changed, code);
        }
        assert!(!load_directly(&mut [0; 4], 2));
    }
}
