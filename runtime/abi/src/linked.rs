//! How the runtime of an executable finds its program.
//!
//! The program's object file defines [`SYMBOL`]; all parts are named by their distance from the field that names them, so
//! that nothing has to be relocated when the executable is loaded, and everything can be read-only.

/// The symbol of the [`LinkedProgram`].
pub const SYMBOL: &str = "plcc_program";

/// The section that contains it and nothing else.
pub const SECTION: &str = ".plcc.program";

/// The section of an executable that contains the program's code.
pub const CODE_SECTION: &str = ".plcc.text";

/// Where the parts of a program are in the memory of its process, in host byte order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C, align(8))]
pub struct LinkedProgram {
    /// Distance in bytes from this field to the encoded [`ProgramImage`](crate::ProgramImage).
    pub image: i32,
    /// Distance in bytes from this field to the table of entry functions. Each entry is an `i32`, the distance from itself to the function.
    pub entries: i32,
    /// Length of the image in bytes. 0: the executable contains several programs, and the table leads to their
    /// `LinkedProgram`s.
    pub image_len: u64,
    /// Number of entries in the table.
    pub entries_len: u64,
}

impl LinkedProgram {
    /// The bytes of this value, as they are in an object file.
    pub fn encode(&self) -> [u8; size_of::<LinkedProgram>()] {
        let mut bytes = [0; size_of::<LinkedProgram>()];
        let mut put = |at: usize, field: &[u8]| bytes[at..at + field.len()].copy_from_slice(field);
        put(std::mem::offset_of!(LinkedProgram, image), &self.image.to_ne_bytes());
        put(std::mem::offset_of!(LinkedProgram, entries), &self.entries.to_ne_bytes());
        put(std::mem::offset_of!(LinkedProgram, image_len), &self.image_len.to_ne_bytes());
        put(std::mem::offset_of!(LinkedProgram, entries_len), &self.entries_len.to_ne_bytes());
        bytes
    }
}

/// The symbol of the variable with the address of the memory of the CPU that runs, for debuggers.
pub const MEMORY_SYMBOL: &str = "plcc_memory";

/// The names under which the runtime exports functions of the C library that generated code calls: their names there, and
/// here.
pub const LIBRARY_FUNCTIONS: [(&str, &str); 2] = [("memset", "plcc_memset"), ("memmove", "plcc_memmove")];

/// The compiled runtime in each form that plcc makes executables from. A form is empty if it could not be made.
#[derive(Clone, Copy)]
pub struct Runtimes {
    /// One relocatable object, for a C compiler that links.
    pub object: &'static [u8],
    /// As `object`, with servers for clients, and their flags.
    pub object_with_services: &'static [u8],
    /// An executable with room for a program.
    pub executable: &'static [u8],
    /// As `executable`, with servers for clients, and their flags.
    pub executable_with_services: &'static [u8],
    /// An executable with room for a program that needs no dynamic library.
    pub without_libraries: &'static [u8],
    /// As `without_libraries`, with servers for clients, and their flags.
    pub without_libraries_with_services: &'static [u8],
    /// A shared library with room for a program: the unit of a co-simulation.
    pub unit: &'static [u8],
}
