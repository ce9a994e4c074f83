//! The bytes of the executable: the template up to its end, the program, then what only tools read.
//!
//! Nothing depends on the time, the folder or the computer, so the same program gives the same bytes.

use object::elf::{self, SectionHeader64, Sym64};
use object::endian::{U16, U32, U64};
use object::pod::{bytes_of, bytes_of_slice};
use object::read::elf::Sym as _;
use object::read::{Object as _, ObjectSymbol as _};
use object::{LittleEndian, SymbolKind};
use plcc_abi::linked;

use super::place::{CODE, Image, ObjectFile, PROGRAM};
use super::template::{ENDIAN, Room, Template};

/// Alignment of tables in the file.
const TABLE_ALIGN: usize = 8;

/// Names one after another; a table refers to one by its offset.
struct Names(Vec<u8>);

impl Names {
    fn new() -> Names {
        Names(vec![0])
    }

    fn add(&mut self, name: &[u8]) -> U32<LittleEndian> {
        let at = self.0.len() as u32;
        self.0.extend_from_slice(name);
        self.0.push(0);
        U32::new(ENDIAN, at)
    }
}

/// Puts the executable together. `image` has its final bytes.
pub fn write(template: &Template, objects: &[ObjectFile<'_>], image: Image) -> Vec<u8> {
    let (symbols, symbol_names) = symbols(template, objects, &image);
    let tools: usize = image.sections.iter().map(|section| section.bytes.len()).sum();
    let room = template.end as usize + tools + symbols.len() * size_of::<Sym64<LittleEndian>>() + symbol_names.len();
    // Headers and gaps.
    let mut out = Vec::with_capacity(room + (1 << 16));
    out.extend_from_slice(&template.bytes[..template.end as usize]);

    let mut header = template.header;
    let mut segments = template.segments.clone();
    let mut names = Names::new();
    let mut sections: Vec<SectionHeader64<LittleEndian>> = Vec::with_capacity(template.sections.len() + 16);
    for (index, (name, section)) in template.sections.iter().enumerate() {
        let name = if index == 0 { U32::new(ENDIAN, 0) } else { names.add(name) };
        sections.push(SectionHeader64 { sh_name: name, ..*section });
    }
    let mut load = |out: &mut Vec<u8>, room: Room, address: u64, bytes: &[u8]| {
        // The place in the file and the address are the same in a page.
        let at = out.len() as u64;
        let at = at + address.wrapping_sub(at) % room.page;
        out.resize(at as usize, 0);
        out.extend_from_slice(bytes);
        let (at, address, length) =
            (U64::new(ENDIAN, at), U64::new(ENDIAN, address), U64::new(ENDIAN, bytes.len() as u64));
        let section = &mut sections[room.section];
        (section.sh_offset, section.sh_addr, section.sh_size) = (at, address, length);
        section.sh_addralign = U64::new(ENDIAN, room.page);
        let segment = &mut segments[room.segment];
        (segment.p_offset, segment.p_vaddr, segment.p_paddr) = (at, address, address);
        (segment.p_filesz, segment.p_memsz) = (length, length);
    };
    load(&mut out, template.program, image.sections[PROGRAM].address, &image.sections[PROGRAM].bytes);
    load(&mut out, template.code, image.sections[CODE].address, &image.sections[CODE].bytes);

    let mut tool_section = |out: &mut Vec<u8>, name: &[u8], kind: u32, bytes: &[u8]| {
        out.resize(out.len().next_multiple_of(TABLE_ALIGN), 0);
        sections.push(SectionHeader64 {
            sh_name: names.add(name),
            sh_type: U32::new(ENDIAN, kind),
            sh_flags: U64::new(ENDIAN, 0),
            sh_addr: U64::new(ENDIAN, 0),
            sh_offset: U64::new(ENDIAN, out.len() as u64),
            sh_size: U64::new(ENDIAN, bytes.len() as u64),
            sh_link: U32::new(ENDIAN, 0),
            sh_info: U32::new(ENDIAN, 0),
            sh_addralign: U64::new(ENDIAN, 1),
            sh_entsize: U64::new(ENDIAN, 0),
        });
        out.extend_from_slice(bytes);
        sections.len() - 1
    };
    for section in &image.sections[CODE + 1..] {
        tool_section(&mut out, &section.name, elf::SHT_PROGBITS, &section.bytes);
    }
    let table = tool_section(&mut out, b".symtab", elf::SHT_SYMTAB, bytes_of_slice(&symbols));
    let strings = tool_section(&mut out, b".strtab", elf::SHT_STRTAB, &symbol_names);
    sections[table].sh_link = U32::new(ENDIAN, strings as u32);
    // All symbols are local.
    sections[table].sh_info = U32::new(ENDIAN, symbols.len() as u32);
    sections[table].sh_addralign = U64::new(ENDIAN, TABLE_ALIGN as u64);
    sections[table].sh_entsize = U64::new(ENDIAN, size_of::<Sym64<LittleEndian>>() as u64);

    let own_name = names.add(b".shstrtab");
    sections.push(SectionHeader64 {
        sh_name: own_name,
        sh_offset: U64::new(ENDIAN, out.len() as u64),
        sh_size: U64::new(ENDIAN, names.0.len() as u64),
        sh_link: U32::new(ENDIAN, 0),
        sh_addralign: U64::new(ENDIAN, 1),
        ..sections[strings]
    });
    out.extend_from_slice(&names.0);
    out.resize(out.len().next_multiple_of(TABLE_ALIGN), 0);
    header.e_shoff = U64::new(ENDIAN, out.len() as u64);
    header.e_shnum = U16::new(ENDIAN, sections.len() as u16);
    header.e_shstrndx = U16::new(ENDIAN, sections.len() as u16 - 1);
    out.extend_from_slice(bytes_of_slice(&sections));

    let header_bytes = bytes_of(&header);
    out[..header_bytes.len()].copy_from_slice(header_bytes);
    let segments_at = header.e_phoff.get(ENDIAN) as usize;
    let segment_bytes = bytes_of_slice(&segments);
    out[segments_at..segments_at + segment_bytes.len()].copy_from_slice(segment_bytes);
    out
}

/// Functions of the runtime and of the program, for profilers and debuggers, and where memory is.
fn symbols(template: &Template, objects: &[ObjectFile<'_>], image: &Image) -> (Vec<Sym64<LittleEndian>>, Vec<u8>) {
    let local = elf::STB_LOCAL << 4 | elf::STT_FUNC;
    let nothing = Sym64 {
        st_name: U32::new(ENDIAN, 0),
        st_info: 0,
        st_other: 0,
        st_shndx: U16::new(ENDIAN, 0),
        st_value: U64::new(ENDIAN, 0),
        st_size: U64::new(ENDIAN, 0),
    };
    let (mut symbols, mut names) = (vec![nothing], Names::new());
    for (name, symbol) in &template.functions {
        // Those of the room for the program are gone.
        if symbol.st_value(ENDIAN) < template.program.address {
            symbols.push(Sym64 { st_name: names.add(name), st_info: local, ..*symbol });
        }
    }
    let variable = elf::STB_LOCAL << 4 | elf::STT_OBJECT;
    symbols.push(Sym64 { st_name: names.add(linked::MEMORY_SYMBOL.as_bytes()), st_info: variable, ..template.memory });
    let mut of_program = Vec::new();
    for (number, object) in objects.iter().enumerate() {
        for symbol in object.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text) {
            let address = symbol.section_index().and_then(|section| image.address(number, section, symbol.address()));
            if let (Some(address), Ok(name)) = (address, symbol.name_bytes()) {
                of_program.push((address, name, symbol.size()));
            }
        }
    }
    of_program.sort_unstable();
    for (address, name, size) in of_program {
        symbols.push(Sym64 {
            st_name: names.add(name),
            st_info: local,
            st_shndx: U16::new(ENDIAN, template.code.section as u16),
            st_value: U64::new(ENDIAN, address),
            st_size: U64::new(ENDIAN, size),
            ..nothing
        });
    }
    (symbols, names.0)
}
