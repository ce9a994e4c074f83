//! Data blocks: the values that V memory has when the program is loaded.
//!
//! Source: S7-200 system manual, data block editor.

use plcc_abi::image::Kept;
use plcc_abi::s7200::V_DB;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::Width;
use plcc_syntax::s7200::ast::{self, Area, Constant, Direct};

use super::Binder;
use super::constant::{Target, whole};
use super::interface::Locals;
use super::settle::Settled;
use plcc_model::DataBlock;

/// Characters of a string in a data block.
const TEXT_MAX: usize = 254;

/// V memory while it is filled.
struct Memory {
    bytes: Vec<u8>,
    /// The line that has written a byte, from 1.
    writer: Vec<u32>,
    lines: Vec<Span>,
}

/// Where the next value is stored, and the width of each value.
#[derive(Clone, Copy)]
struct Cursor {
    byte: u32,
    width: Option<Width>,
}

impl Binder<'_> {
    /// DB 1: V memory.
    pub fn bind_data(&mut self) -> DataBlock {
        let bytes = self.row.v_bytes as usize;
        let mut memory = Memory { bytes: vec![0; bytes], writer: vec![0; bytes], lines: Vec::new() };
        let input = self.input;
        for (_, unit) in input.units {
            let mut cursor = None;
            for line in unit.s7200.iter().flat_map(|source| &source.data) {
                cursor = self.data_line(line, cursor, &mut memory);
            }
        }
        let first = memory.lines.first().copied();
        DataBlock {
            number: V_DB,
            name: String::new(),
            span: first.unwrap_or_default(),
            data: memory.bytes,
            members: Vec::new(),
            instance_of: None,
            data_type: String::new(),
            read_only: false,
            unlinked: false,
            optimized: false,
            kept: Kept::Everything,
        }
    }

    fn data_line(&mut self, line: &ast::DataLine, cursor: Option<Cursor>, memory: &mut Memory) -> Option<Cursor> {
        memory.lines.push(line.span);
        let mut cursor = match (&line.address, cursor) {
            (Some(address), _) => self.data_address(address)?,
            (None, Some(cursor)) => cursor,
            (None, None) => {
                self.push(
                    Diagnostic::new(Code::MissingOperand, line.span, "the first line of a data block needs an address")
                        .label("there is no line before it that it could continue")
                        .help("begin it with an address such as `VB0`"),
                );
                return None;
            }
        };
        let mut told = false;
        for value in &line.values {
            let Some(bytes) = self.data_value(value, cursor.width) else { continue };
            let count = u32::try_from(bytes.len()).unwrap_or(u32::MAX);
            let place = Direct { area: Area::V, width: Some(Width::Byte), number: cursor.byte, bit: 0 };
            if count > 0 {
                self.check_range(place, Width::Byte, count, value.span)?;
            }
            if let Some(first) = memory.write(cursor.byte, &bytes)
                && !told
            {
                told = true;
                let title = format!("V memory from VB{} already has a value", cursor.byte);
                self.push(
                    Diagnostic::new(Code::DataOverlap, value.span, title)
                        .label("this value is used")
                        .also(first, "written here")
                        .help("begin the line at an address after it"),
                );
            }
            cursor.byte = cursor.byte.saturating_add(count);
        }
        Some(cursor)
    }

    fn data_address(&mut self, address: &ast::Operand) -> Option<Cursor> {
        let settled = self.settle(&Locals::default(), address, false)?;
        match settled {
            Settled::Direct(direct) if direct.area == Area::V && direct.width != Some(Width::Bit) => {
                self.check_range(direct, direct.width.unwrap_or(Width::Byte), 1, address.span)?;
                Some(Cursor { byte: direct.number, width: direct.width })
            }
            other => {
                let is_v = matches!(other, Settled::Direct(direct) if direct.area == Area::V);
                self.push(
                    Diagnostic::new(Code::OperandKind, address.span, "a data block can only contain V memory (0090)")
                        .label("not a byte, word or double word of V")
                        .help(match is_v {
                            true => "write the bits of a byte as one value: `VB10 2#00000101`",
                            false => {
                                "use an address such as VW10, or move the value after `LD SM0.1`, in the first scan"
                            }
                        }),
                );
                None
            }
        }
    }

    /// The bytes of a value; `None`: reported.
    fn data_value(&mut self, value: &ast::Operand, width: Option<Width>) -> Option<Vec<u8>> {
        let span = value.span;
        let constant = match self.settle(&Locals::default(), value, true)? {
            Settled::Constant(constant) => constant,
            Settled::Pointer(pointer) => Constant::Bits { value: pointer, width: Some(Width::Dword) },
            _ => {
                self.push(
                    Diagnostic::new(Code::ConstantRequired, span, "a data block can only contain constants (0090)")
                        .label("not a constant")
                        .help("write a number, a text, or the name of a constant"),
                );
                return None;
            }
        };
        match (&constant, width) {
            (Constant::Text(bytes), None | Some(Width::Byte)) => match u8::try_from(bytes.len()) {
                Ok(length) if bytes.len() <= TEXT_MAX => {
                    Some(std::iter::once(length).chain(bytes.iter().copied()).collect())
                }
                _ => {
                    let title = format!("a string of {} characters is too long (0090)", bytes.len());
                    self.push(Diagnostic::new(Code::LiteralRange, span, title).label(format!("up to {TEXT_MAX}")));
                    None
                }
            },
            (Constant::Characters(bytes), None | Some(Width::Byte)) => Some(bytes.clone()),
            (Constant::Characters(bytes), Some(width)) if bytes.len() as u32 > width.bytes() => {
                if !(bytes.len() as u32).is_multiple_of(width.bytes()) {
                    let title = "the characters do not fill whole elements (0090)";
                    self.push(
                        Diagnostic::new(Code::LiteralRange, span, title)
                            .label(format!("each element has room for {}", width.bytes()))
                            .help("write texts at byte addresses: `VB10 'text'`"),
                    );
                    return None;
                }
                Some(bytes.clone())
            }
            (Constant::Bool(value), None | Some(Width::Byte)) => Some(vec![u8::from(*value)]),
            (Constant::Real(value), None) => Some(value.to_be_bytes().to_vec()),
            (_, Some(width)) => {
                let bits = self.constant(&constant, Target::Bits(width), span)?;
                Some(big_endian(bits, width))
            }
            (Constant::Bits { value, width: Some(width) }, None) if *width != Width::Bit => {
                Some(big_endian(*value, *width))
            }
            (_, None) => {
                let width = match whole(&constant) {
                    Some(-128..=255) => Width::Byte,
                    Some(-32768..=65535) => Width::Word,
                    _ => Width::Dword,
                };
                let number = whole(&constant)?;
                match width {
                    // This is a negative byte: the size follows the value.
                    Width::Byte => Some(vec![number as u8]),
                    _ => {
                        let bits = self.constant(&constant, Target::Integer(width), span)?;
                        Some(big_endian(bits, width))
                    }
                }
            }
        }
    }
}

impl Memory {
    /// Writes bytes; returns the line that has written one of them before.
    fn write(&mut self, byte: u32, bytes: &[u8]) -> Option<Span> {
        let line = u32::try_from(self.lines.len()).unwrap_or(u32::MAX);
        let mut first = None;
        for (index, value) in (byte as usize..).zip(bytes) {
            if let (Some(place), Some(writer)) = (self.bytes.get_mut(index), self.writer.get_mut(index)) {
                if *writer != 0 {
                    first.get_or_insert(*writer);
                }
                *place = *value;
                *writer = line;
            }
        }
        first.and_then(|line| self.lines.get(line as usize - 1)).copied()
    }
}

/// The low bytes of a value, the most significant one first.
fn big_endian(value: u32, width: Width) -> Vec<u8> {
    let bytes = value.to_be_bytes();
    let skip = 4usize.saturating_sub(width.bytes() as usize);
    bytes.iter().skip(skip).copied().collect()
}
