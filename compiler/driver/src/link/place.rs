//! Where the sections and symbols of the program's objects are in the executable.

use object::read::elf::{ElfFile64, SectionHeader as _};
use object::read::{Object as _, ObjectSection as _, ObjectSymbol as _};
use object::{LittleEndian, SectionIndex, elf};
use plcc_abi::linked;
use rustc_hash::FxHashMap;

use super::LinkError;
use super::template::{ENDIAN, Template};

pub type ObjectFile<'a> = ElfFile64<'a, LittleEndian>;

/// Reads an object.
pub fn parse(bytes: &[u8]) -> Result<ObjectFile<'_>, LinkError> {
    ObjectFile::parse(bytes).map_err(wrong)
}

pub fn wrong(error: object::read::Error) -> LinkError {
    LinkError::Object(format!("an object: {error}"))
}

/// A section of the executable that contains parts of the program.
pub struct Section {
    pub name: Vec<u8>,
    /// Its address when it is loaded; 0 for one that is not.
    pub address: u64,
    pub bytes: Vec<u8>,
}

/// Number of the section of constants in [`Image::sections`]; it begins with the `LinkedProgram`.
pub const PROGRAM: usize = 0;
/// Number of the section of code. Those after it are for debuggers.
pub const CODE: usize = 1;

/// Where a section of an object went.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Index in [`Image::sections`].
    pub section: usize,
    pub offset: u64,
}

/// The part of the executable that is the program.
pub struct Image {
    pub sections: Vec<Section>,
    /// For each object, the places of its sections by their index there.
    places: Vec<Vec<Option<Place>>>,
    /// Addresses of the symbols that objects share, and of those of the runtime.
    globals: FxHashMap<Vec<u8>, u64>,
}

impl Image {
    /// Where section `section` of object `object` is.
    pub fn place(&self, object: usize, section: SectionIndex) -> Option<Place> {
        *self.places.get(object)?.get(section.0)?
    }

    /// Address of the byte at `offset` of a section of an object; in a section that is not loaded its distance from the beginning.
    pub fn address(&self, object: usize, section: SectionIndex, offset: u64) -> Option<u64> {
        let place = self.place(object, section)?;
        Some(self.sections[place.section].address + place.offset + offset)
    }

    /// Address of an exported symbol.
    pub fn global(&self, name: &[u8]) -> Option<u64> {
        self.globals.get(name).copied()
    }
}

/// What is there before the program.
pub struct Start<'a> {
    /// Of the section of constants.
    pub address: u64,
    /// Alignment of the code.
    pub page: u64,
    /// Functions of the runtime with their addresses, and its variable for debuggers.
    pub functions: Vec<(&'a [u8], u64)>,
}

impl<'a> From<&'a Template> for Start<'a> {
    fn from(template: &'a Template) -> Start<'a> {
        use object::read::elf::Sym as _;
        let functions = template.functions.iter().map(|(name, symbol)| (*name, symbol.st_value(ENDIAN)));
        let functions =
            functions.chain([(linked::MEMORY_SYMBOL.as_bytes(), template.memory.st_value(ENDIAN))]).collect();
        Start { address: template.program.address, page: template.code.page, functions }
    }
}

/// Gives each section and symbol its place.
///
/// Errors: an object contains what a program never has (variables of its own), or too much.
pub fn place(start: &Start<'_>, objects: &[ObjectFile<'_>]) -> Result<Image, LinkError> {
    let section = |name: &str, address| Section { name: name.into(), address, bytes: Vec::new() };
    let mut image = Image {
        sections: vec![section(linked::SECTION, start.address), section(linked::CODE_SECTION, 0)],
        places: objects.iter().map(|object| vec![None; object.sections().count() + 1]).collect(),
        globals: FxHashMap::default(),
    };
    // What the runtime looks at comes first.
    let found = objects.iter().enumerate().find_map(|(number, object)| Some((number, exported(object)?)));
    let (number, first) = found.ok_or_else(|| LinkError::Object(format!("no object has {}", linked::SYMBOL)))?;
    add(&mut image, number, &objects[number], first)?;
    for (number, object) in objects.iter().enumerate() {
        for section in object.sections() {
            if image.place(number, section.index()).is_none() {
                add(&mut image, number, object, section.index())?;
            }
        }
    }
    let end = start.address + image.sections[PROGRAM].bytes.len() as u64;
    image.sections[CODE].address = end.next_multiple_of(start.page);
    name_symbols(&mut image, start, objects)?;
    Ok(image)
}

/// The section in which the object defines the program.
fn exported(object: &ObjectFile<'_>) -> Option<SectionIndex> {
    let mut symbols = object.symbols();
    let symbol = symbols.find(|symbol| symbol.is_global() && symbol.name_bytes() == Ok(linked::SYMBOL.as_bytes()))?;
    symbol.section_index()
}

/// Appends a section of an object to one of the executable.
fn add(image: &mut Image, number: usize, object: &ObjectFile<'_>, index: SectionIndex) -> Result<(), LinkError> {
    let section = object.section_by_index(index).map_err(wrong)?;
    let header = section.elf_section_header();
    let flags = header.sh_flags(ENDIAN);
    let has = |flag: u32| flags & u64::from(flag) != 0;
    let name = section.name_bytes().map_err(wrong)?;
    let target = match (has(elf::SHF_ALLOC), has(elf::SHF_EXECINSTR)) {
        _ if section.size() == 0 => return Ok(()),
        (true, false) if !has(elf::SHF_WRITE) && header.sh_type(ENDIAN) == elf::SHT_PROGBITS => PROGRAM,
        (true, true) if !has(elf::SHF_WRITE) => CODE,
        (true, _) => {
            return Err(LinkError::Object(format!("section {} of an object", String::from_utf8_lossy(name))));
        }
        (false, _) if !name.starts_with(b".debug_") => return Ok(()),
        (false, _) => image.sections.iter().position(|section| section.name == name).unwrap_or_else(|| {
            image.sections.push(Section { name: name.to_vec(), address: 0, bytes: Vec::new() });
            image.sections.len() - 1
        }),
    };
    let bytes = &mut image.sections[target].bytes;
    bytes.resize(bytes.len().next_multiple_of(section.align().max(1) as usize), 0);
    image.places[number][index.0] = Some(Place { section: target, offset: bytes.len() as u64 });
    bytes.extend_from_slice(section.data().map_err(wrong)?);
    Ok(())
}

fn name_symbols(image: &mut Image, start: &Start<'_>, objects: &[ObjectFile<'_>]) -> Result<(), LinkError> {
    for (name, address) in &start.functions {
        image.globals.insert(name.to_vec(), *address);
    }
    for (library, exported) in linked::LIBRARY_FUNCTIONS {
        let address = image.global(exported.as_bytes());
        let address = address.ok_or_else(|| LinkError::Object(format!("the runtime has no {exported}")))?;
        image.globals.insert(library.into(), address);
    }
    for (number, object) in objects.iter().enumerate() {
        for symbol in object.symbols().filter(|symbol| symbol.is_global()) {
            let address = symbol.section_index().and_then(|section| image.address(number, section, symbol.address()));
            if let Some(address) = address {
                image.globals.insert(symbol.name_bytes().map_err(wrong)?.to_vec(), address);
            }
        }
    }
    Ok(())
}
