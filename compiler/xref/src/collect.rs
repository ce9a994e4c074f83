//! Every use of every operand, in the order of the blocks.

mod s7200;
mod scl;
mod stl;

use std::collections::HashSet;

use plcc_abi::any;
use plcc_abi::image::BlockKind;
use plcc_abi::layout::area;
use plcc_diag::Span;
use plcc_model::types::{DataType, ParameterType};
use plcc_model::{
    BlockKey, Body, CodeBlock, Direction, Number, Parameter, Passing, Place, Program, StlStatement, Width,
};

use crate::Access;
use crate::operand::{Area, Operand};

/// A use of an operand.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    pub operand: Operand,
    /// Index of the block among those of the program.
    pub block: usize,
    pub network: u16,
    pub span: Span,
    pub access: Access,
}

/// Looks at all blocks of the user. Blocks of the library are not looked into.
pub fn collect(program: &Program) -> Vec<Found> {
    let mut found = Vec::new();
    for (index, block) in program.blocks.iter().enumerate().filter(|(_, block)| !block.library) {
        let mut collector = Collector { program, block, index, network: 0, span: block.span, found: &mut found };
        match &block.body {
            Body::Stl(statements) => {
                statements.iter().for_each(|statement| collector.stl(statement));
                collector.named_dbs(statements);
            }
            Body::Scl(body) => collector.scl(body),
            Body::S7200(body) => body.statements.iter().for_each(|statement| collector.s7200(statement)),
            Body::Runtime => {}
        }
    }
    // A chart has code for some of its statements twice.
    let mut seen = HashSet::new();
    found.retain(|one| seen.insert((one.operand, one.block, one.span.start, one.access)));
    found
}

/// A block that is looked at.
struct Collector<'a> {
    program: &'a Program,
    block: &'a CodeBlock,
    index: usize,
    /// Of the current statement.
    network: u16,
    span: Span,
    found: &'a mut Vec<Found>,
}

impl Collector<'_> {
    fn add(&mut self, operand: Operand, access: Access) {
        self.add_at(operand, access, self.span);
    }

    fn add_at(&mut self, operand: Operand, access: Access, span: Span) {
        // What the compiler itself has put into a block has no place of its own.
        let span = if span.file == self.block.span.file { span } else { self.block.span };
        self.found.push(Found { operand, block: self.index, network: self.network, span, access });
    }

    /// A place with the number of bits that is used there; pointers and indices are read. An element may be any of its array.
    fn place(&mut self, place: &Place, bits: u32, access: Access, span: Span) {
        let (area, byte, bit) = match *place {
            Place::I { byte, bit } => (Area::I, byte, bit),
            Place::Q { byte, bit } => (Area::Q, byte, bit),
            Place::M { byte, bit } => (Area::M, byte, bit),
            Place::Pi { byte, bit } => (Area::Pi, byte, bit),
            Place::Pq { byte, bit } => (Area::Pq, byte, bit),
            Place::Db { number, byte, bit } => (Area::Db(number), byte, bit),
            Place::Indirect { ref pointer, .. } => {
                return self.place(pointer, Width::Dword.bits(), Access::Read, span);
            }
            Place::Element { ref base, ref indices } => {
                let mut reach = 0u32;
                for index in indices {
                    self.place(&index.place, index.ty.bits(), Access::Read, span);
                    reach = reach.saturating_add(index.reach());
                }
                return self.place(base, bits.saturating_add(reach), access, span);
            }
            // Local data, what is known at run time only, and variables of the block.
            Place::L { .. }
            | Place::OpenDb { .. }
            | Place::OpenDi { .. }
            | Place::Instance { .. }
            | Place::Parameter { .. }
            | Place::ThroughPointer { .. }
            | Place::Register { .. } => return,
        };
        let start = byte.saturating_mul(8).saturating_add(u32::from(bit));
        self.add_at(Operand::Memory { area, start, bits: bits.max(1) }, access, span);
    }

    /// A number of a timer, a counter or a block: known, or read from a place.
    fn number(&mut self, number: &Number, of: fn(u16) -> Operand, access: Access) {
        match number {
            Number::Known(number) => self.add(of(*number), access),
            Number::Word(place) => self.place(place, Width::Word.bits(), Access::Read, self.span),
            Number::Parameter(_) => {}
        }
    }

    /// A number that is passed to `parameter`.
    fn passed_number(&mut self, number: &Number, parameter: &Parameter) {
        let block = |kind| move |number| Operand::Block(BlockKey { kind, number });
        match &parameter.ty {
            DataType::Parameter(ParameterType::Timer) => self.number(number, Operand::Timer, Access::Undecided),
            DataType::Parameter(ParameterType::Counter) => self.number(number, Operand::Counter, Access::Undecided),
            DataType::Parameter(ParameterType::BlockDb) => self.number(number, Operand::db, Access::Open),
            DataType::Parameter(kind @ (ParameterType::BlockFb | ParameterType::BlockFc)) => {
                let kind = if *kind == ParameterType::BlockFb { BlockKind::Fb } else { BlockKind::Fc };
                if let Number::Known(number) = number {
                    self.add(block(kind)(*number), Access::Undecided);
                }
            }
            _ => {}
        }
    }

    /// What a block does with the actual of `parameter`.
    fn access_by(&self, target: BlockKey, parameter: &Parameter) -> Access {
        let is_pointer = matches!(parameter.passing, Passing::Pointer | Passing::Any | Passing::Variant);
        let system = matches!(self.program.block(target).map(|block| &block.body), Some(Body::Runtime));
        match parameter.direction {
            // A block may write through a pointer that it gets.
            Direction::Input if is_pointer && !system => Access::Undecided,
            Direction::Input => Access::Read,
            Direction::Output => Access::Write,
            Direction::InOut => Access::ReadWrite,
        }
    }

    /// Bits of the actual of a parameter that is a place.
    fn passed_bits(parameter: &Parameter) -> u32 {
        match parameter.passing {
            Passing::Elementary(width) => width.bits(),
            Passing::Complex { bytes } => bytes.saturating_mul(8),
            Passing::Number => 16,
            Passing::Pointer | Passing::Any | Passing::Variant => parameter.passing.pointer_bytes() * 8,
            Passing::OpenArray { .. } => 8,
        }
    }

    /// A POINTER or an ANY that is known, or the ANY of a VARIANT.
    fn pointer(&mut self, bytes: &[u8], passing: Passing, access: Access, span: Span) {
        let word = |at: usize| bytes.get(at..at + 2).map_or(0, |word| u16::from_be_bytes([word[0], word[1]]));
        let long = |at: usize| u32::from(word(at)) << 16 | u32::from(word(at + 2));
        let (db, pointer, bits) = match bytes.len() {
            6 => (word(0), long(2), 1),
            10.. => {
                if let Some((operand, access)) = self.numbered(bytes[1], word(8), passing, access) {
                    return self.add_at(operand, access, span);
                }
                let fields = any::Fields { head: long(0), db: word(4), pointer: long(6) };
                match any::decode(fields, 0, any::Access::Read) {
                    Ok(Some(any)) => (fields.db, fields.pointer, any.bytes.saturating_mul(8)),
                    Ok(None) => return,
                    Err(_) => (fields.db, fields.pointer, (long(0) & 0xFFFF).max(1)),
                }
            }
            _ => return,
        };
        let area = match (pointer >> 24) as u8 {
            area::I => Area::I,
            area::Q => Area::Q,
            area::M => Area::M,
            area::DB if db != 0 => Area::Db(db),
            area::P => Area::Pi,
            _ => return,
        };
        self.add_at(Operand::Memory { area, start: pointer & 0x7_FFFF, bits }, access, span);
    }

    /// What an ANY with the number of a block, a timer or a counter means: a VARIANT of a data block is all that the block holds.
    fn numbered(&self, code: u8, number: u16, passing: Passing, access: Access) -> Option<(Operand, Access)> {
        let block = |kind| Operand::Block(BlockKey { kind, number });
        Some(match code {
            any::BLOCK_FB => (block(BlockKind::Fb), access),
            any::BLOCK_FC => (block(BlockKind::Fc), access),
            any::BLOCK_DB => {
                let bytes = self.program.db(number).and_then(|db| u32::try_from(db.data.len()).ok()).unwrap_or(0);
                match bytes.saturating_mul(8) {
                    bits if bits > 0 && passing == Passing::Variant => {
                        (Operand::Memory { area: Area::Db(number), start: 0, bits }, access)
                    }
                    _ => (Operand::db(number), Access::Open),
                }
            }
            any::COUNTER => (Operand::Counter(number), access),
            any::TIMER => (Operand::Timer(number), access),
            _ => return None,
        })
    }

    /// Data blocks whose numbers are passed to a DB_ANY.
    fn named_dbs(&mut self, statements: &[StlStatement]) {
        for &(number, span) in &self.block.named_dbs {
            let statement = statements.iter().rev().find(|statement| statement.span.start <= span.start);
            self.network = statement.map_or(0, |statement| statement.network);
            self.add_at(Operand::db(number), Access::Open, span);
        }
    }

    fn stl(&mut self, statement: &StlStatement) {
        (self.network, self.span) = (statement.network, statement.span);
        self.stl_statement(&statement.kind);
    }
}

/// Bits of what a pointer with a type code and a number of elements points at.
fn pointed_bits(type_code: u8, count: u16) -> u32 {
    const BOOL: u8 = 0x01;
    let fields = any::Fields { head: 0x1000_0000 | u32::from(type_code) << 16 | u32::from(count), db: 0, pointer: 0 };
    match any::decode(fields, 0, any::Access::Read) {
        Ok(Some(any)) => any.bytes.saturating_mul(8),
        _ if type_code == BOOL => u32::from(count).max(1),
        _ => 8,
    }
}
