//! The runtime as an executable or a shared library with room for a program.
//!
//! `plcc_prebuilt` has them, and [`provide`](super::provide) names them.

use object::LittleEndian;
use object::elf::{self, FileHeader64, ProgramHeader64, SectionHeader64, Sym64};
use object::read::elf::{FileHeader as _, ProgramHeader as _, SectionHeader as _, Sym as _};
use plcc_abi::linked;

use super::LinkError;
use super::runtimes::provided;

/// What is linked with a program besides it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Runtime {
    Plain,
    /// With servers for clients, and their flags.
    Services,
}

/// What linking makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    Executable(Runtime),
    /// An executable that needs no dynamic library.
    Static(Runtime),
    /// A shared library: the unit of a co-simulation.
    Unit,
}

impl Form {
    /// The template; empty if plcc was built without it.
    fn bytes(self) -> &'static [u8] {
        let runtimes = provided();
        match self {
            Form::Executable(Runtime::Plain) => runtimes.executable,
            Form::Executable(Runtime::Services) => runtimes.executable_with_services,
            Form::Static(Runtime::Plain) => runtimes.without_libraries,
            Form::Static(Runtime::Services) => runtimes.without_libraries_with_services,
            Form::Unit => runtimes.unit,
        }
    }
}

pub const ENDIAN: LittleEndian = LittleEndian;

/// The parsed template.
pub struct Template {
    pub bytes: &'static [u8],
    pub header: FileHeader64<LittleEndian>,
    pub segments: Vec<ProgramHeader64<LittleEndian>>,
    /// Sections that are loaded, with their names, and the empty one in front.
    pub sections: Vec<(&'static [u8], SectionHeader64<LittleEndian>)>,
    /// Defined functions, with their names.
    pub functions: Vec<(&'static [u8], Sym64<LittleEndian>)>,
    /// The variable [`linked::MEMORY_SYMBOL`].
    pub memory: Sym64<LittleEndian>,
    pub program: Room,
    pub code: Room,
    /// Where in the file the parts end that stay as they are.
    pub end: u64,
}

/// A place for a part of the program.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    pub section: usize,
    pub segment: usize,
    /// Alignment of its segment in memory and in the file.
    pub page: u64,
    pub address: u64,
}

impl Template {
    /// True if the runtime is for a computer whose executables plcc can write.
    pub fn is_usable(form: Form) -> bool {
        FileHeader64::<LittleEndian>::parse(form.bytes()).is_ok_and(|header| header.e_machine(ENDIAN) == elf::EM_X86_64)
    }

    /// Errors: the linker that built the runtime did not make what it was asked for.
    pub fn read(form: Form) -> Result<Template, LinkError> {
        let bytes = form.bytes();
        let wrong = |error: object::read::Error| LinkError::Object(format!("the runtime: {error}"));
        let missing = |what: &str| LinkError::Object(format!("the runtime has no {what}"));
        let header = FileHeader64::<LittleEndian>::parse(bytes).map_err(wrong)?;
        let segments = header.program_headers(ENDIAN, bytes).map_err(wrong)?.to_vec();
        let table = header.sections(ENDIAN, bytes).map_err(wrong)?;
        let mut sections = Vec::new();
        for section in table.iter() {
            if section.sh_type(ENDIAN) == elf::SHT_NULL || section.sh_flags(ENDIAN) & u64::from(elf::SHF_ALLOC) != 0 {
                sections.push((table.section_name(ENDIAN, section).map_err(wrong)?, *section));
            }
        }
        let room = |name: &str| {
            let section = sections.iter().position(|(found, _)| *found == name.as_bytes())?;
            let address = sections[section].1.sh_addr(ENDIAN);
            let holds = |segment: &ProgramHeader64<LittleEndian>| {
                segment.p_type(ENDIAN) == elf::PT_LOAD && segment.p_vaddr(ENDIAN) == address
            };
            let segment = segments.iter().position(holds)?;
            Some(Room { section, segment, page: segments[segment].p_align(ENDIAN), address })
        };
        let program = room(linked::SECTION).ok_or_else(|| missing(linked::SECTION))?;
        let code = room(linked::CODE_SECTION).ok_or_else(|| missing(linked::CODE_SECTION))?;
        let rooms = [program.section, code.section];
        let mut end = 0;
        for (index, (_, section)) in sections.iter().enumerate() {
            if rooms.contains(&index) {
                continue;
            }
            if section.sh_addr(ENDIAN) > program.address {
                return Err(missing(&format!("room: {} is not its last section", linked::SECTION)));
            }
            if section.sh_type(ENDIAN) != elf::SHT_NOBITS {
                end = end.max(section.sh_offset(ENDIAN) + section.sh_size(ENDIAN));
            }
        }
        let symbols = table.symbols(ENDIAN, bytes, elf::SHT_SYMTAB).map_err(wrong)?;
        let (mut functions, mut memory) = (Vec::new(), None);
        for symbol in symbols.iter() {
            let section = symbol.st_shndx(ENDIAN);
            if symbol.st_type() == elf::STT_FUNC && section != elf::SHN_UNDEF && usize::from(section) < sections.len() {
                functions.push((symbols.symbol_name(ENDIAN, symbol).map_err(wrong)?, *symbol));
            }
            if symbols.symbol_name(ENDIAN, symbol).is_ok_and(|name| name == linked::MEMORY_SYMBOL.as_bytes()) {
                memory = Some(*symbol);
            }
        }
        let memory = memory.ok_or_else(|| missing(linked::MEMORY_SYMBOL))?;
        functions.sort_by_key(|(_, symbol)| symbol.st_value(ENDIAN));
        Ok(Template { bytes, header: *header, segments, sections, functions, memory, program, code, end })
    }
}
