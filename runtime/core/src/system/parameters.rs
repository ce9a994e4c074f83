//! The parameter structure of a system function.

use plcc_abi::any::Fields;
use plcc_abi::codes::local_error;

use crate::cpu::Cpu;

/// Types of parameters by their layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// One bit, the first of its byte.
    Bool,
    /// A BOOL after a BOOL: the next bit of the same byte.
    NextBool,
    Byte,
    /// INT, WORD.
    Word,
    /// DINT, DWORD, TIME, REAL.
    Dword,
    /// LINT, ULINT, LWORD, LREAL.
    Lword,
    DateAndTime,
    Dtl,
    Any,
    /// An ANY with number and type of elements after it.
    Variant,
    /// A VARIANT as a value.
    VariantData,
    /// POINTER: DB number and area pointer.
    Pointer,
    /// Twelve bytes of start information.
    StartInfo,
    ErrorStruct,
}

impl Kind {
    pub(super) const fn bytes(self) -> u32 {
        match self {
            Kind::NextBool => 0,
            Kind::Bool | Kind::Byte => 1,
            Kind::Word => 2,
            Kind::Dword => 4,
            Kind::Lword | Kind::DateAndTime => 8,
            Kind::Any => 10,
            Kind::Variant | Kind::VariantData => 18,
            Kind::Pointer => 6,
            Kind::Dtl | Kind::StartInfo => 12,
            Kind::ErrorStruct => local_error::BYTES,
        }
    }
}

/// Parameters of the system function with the most.
pub(super) const PARAMETERS_MAX: usize = 11;

/// The offset of each parameter: bytes anywhere, all else at even bytes. Source: Programming with STEP 7, layout of a STRUCT.
pub(super) const fn offsets(kinds: &[Kind]) -> [u8; PARAMETERS_MAX] {
    let mut offsets = [0; PARAMETERS_MAX];
    let (mut index, mut at) = (0, 0);
    while index < kinds.len() {
        let bytes = kinds[index].bytes();
        if bytes > 1 {
            at += at % 2;
        }
        assert!(at <= u8::MAX as u32);
        offsets[index] = at as u8;
        at += bytes;
        index += 1;
    }
    offsets
}

/// A call of a system function. Parameters are named by their place in the declaration, from 0.
pub(super) struct Call<'a> {
    pub cpu: &'a Cpu,
    pub site: u32,
    pub block: u32,
    /// Frame of the caller.
    pub lbase: u32,
    /// Where each parameter is, from `block`.
    pub offsets: &'static [u8; PARAMETERS_MAX],
}

impl Call<'_> {
    fn at(&self, index: usize) -> u32 {
        self.block + u32::from(self.offsets[index])
    }

    pub fn byte(&self, index: usize) -> u8 {
        self.cpu.memory.byte(self.at(index))
    }

    pub fn word(&self, index: usize) -> u16 {
        self.cpu.memory.word(self.at(index))
    }

    pub fn dword(&self, index: usize) -> u32 {
        self.cpu.memory.dword(self.at(index))
    }

    pub fn lword(&self, index: usize) -> u64 {
        u64::from_be_bytes(self.cpu.memory.bytes(self.at(index)))
    }

    pub fn date_and_time(&self, index: usize) -> [u8; 8] {
        self.cpu.memory.bytes(self.at(index))
    }

    pub fn dtl(&self, index: usize) -> [u8; 12] {
        self.cpu.memory.bytes(self.at(index))
    }

    pub fn set_dtl(&self, index: usize, value: [u8; 12]) {
        self.cpu.memory.set_bytes(self.at(index), value);
    }

    pub fn any(&self, index: usize) -> Fields {
        self.cpu.memory.any(self.at(index))
    }

    /// The part of a VARIANT after its ANY: number of elements, 0 if it is not an array; number of the type, 0 if it is not known.
    pub fn pointed(&self, index: usize) -> (u32, u32) {
        let at = self.at(index) + Kind::Any.bytes();
        (self.cpu.memory.dword(at), self.cpu.memory.dword(at + 4))
    }

    /// Sets parameter `index`, a [`Kind::VariantData`]: an ANY, number of elements, number of the type.
    pub fn set_variant(&self, index: usize, any: Fields, elements: u32, ty: u32) {
        let memory = &self.cpu.memory;
        let at = self.at(index);
        memory.set_dword(at, any.head);
        memory.set_word(at + 4, any.db);
        memory.set_dword(at + 6, any.pointer);
        memory.set_dword(at + 10, elements);
        memory.set_dword(at + 14, ty);
    }

    pub fn set_bool(&self, index: usize, value: bool) {
        self.cpu.memory.set_bit(self.at(index), 0, value);
    }

    /// Sets parameter `index`, a [`Kind::NextBool`].
    pub fn set_next_bool(&self, index: usize, value: bool) {
        self.cpu.memory.set_bit(self.at(index) - 1, 1, value);
    }

    pub fn set_byte(&self, index: usize, value: u8) {
        self.cpu.memory.set_byte(self.at(index), value);
    }

    pub fn set_word(&self, index: usize, value: u16) {
        self.cpu.memory.set_word(self.at(index), value);
    }

    pub fn set_dword(&self, index: usize, value: u32) {
        self.cpu.memory.set_dword(self.at(index), value);
    }

    pub fn set_lword(&self, index: usize, value: u64) {
        self.cpu.memory.set_bytes(self.at(index), value.to_be_bytes());
    }

    pub fn pointer(&self, index: usize) -> [u8; 6] {
        self.cpu.memory.bytes(self.at(index))
    }

    pub fn set_start_info(&self, index: usize, value: [u8; 12]) {
        self.cpu.memory.set_bytes(self.at(index), value);
    }

    pub fn set_error(&self, index: usize, value: [u8; local_error::BYTES as usize]) {
        self.cpu.memory.set_bytes(self.at(index), value);
    }

    pub fn set_date_and_time(&self, index: usize, value: [u8; 8]) {
        self.cpu.memory.set_bytes(self.at(index), value);
    }
}
