//! Moves. Source: S7-200 system manual, move instructions.

use plcc_abi::RuntimeFn;
use plcc_abi::s7200::V_DB;
use plcc_ir::{Address, Type, UnaryOp};
use plcc_model::s7200::{Area, Insn, Operand, Width};

use super::block::S7200Lowering;
use super::operand::area_address;

/// Words that `FILL` writes one by one.
const FILLED_MAX: u32 = 16;

/// A block move that needs no runtime: all of it is in an area where reading and writing have no effects, and the number of elements is a constant.
#[derive(Clone, Copy)]
pub enum KnownMove {
    Copy { from: Address, to: Address, bytes: u32 },
    Fill { to: Address, words: u32 },
}

impl S7200Lowering<'_, '_> {
    /// `MOVB MOVW MOVD MOVR`.
    pub fn copy_value(&mut self, operands: &[Operand], width: Width) {
        let [input, output] = operands else { return };
        self.boxed(|lowering| {
            let value = lowering.read(input, width);
            let target = lowering.target(output, width);
            lowering.store(target, width, value);
        });
    }

    /// `SWAP`.
    pub fn swap(&mut self, operands: &[Operand]) {
        self.boxed(|lowering| {
            let target = lowering.target(&operands[0], Width::Word);
            let old = lowering.load(target, Width::Word);
            let swapped = lowering.b.unary(UnaryOp::Bswap, old);
            lowering.store(target, Width::Word, swapped);
        });
    }

    /// `BIR`: the image does not change.
    pub fn read_input_now(&mut self, operands: &[Operand]) {
        let [Operand::Memory { byte, .. }, output] = operands else { return };
        self.boxed(|lowering| {
            let (address, bytes) = (lowering.b.i32_const(*byte), lowering.b.i32_const(1));
            let value =
                lowering.b.call_runtime(RuntimeFn::PeripheralRead, &[address, bytes]).expect("it returns a value");
            let value = lowering.b.trunc(Type::I8, value);
            let target = lowering.target(output, Width::Byte);
            lowering.store(target, Width::Byte, value);
        });
    }

    /// `BIW`: image and module.
    pub fn write_output_now(&mut self, operands: &[Operand]) {
        let [input, Operand::Memory { byte, .. }] = operands else { return };
        self.boxed(|lowering| {
            let value = lowering.read(input, Width::Byte);
            let value = lowering.b.zext(Type::I32, value);
            let (address, bytes) = (lowering.b.i32_const(*byte), lowering.b.i32_const(1));
            lowering.b.call_runtime(RuntimeFn::PeripheralWrite, &[address, bytes, value]);
        });
    }

    /// What `BMB BMW BMD FILL` do, if it is known and no error.
    pub fn known_move(&self, insn: Insn, operands: &[Operand]) -> Option<KnownMove> {
        let &[ref from, ref to, Operand::Const(count)] = operands else { return None };
        let size = match insn {
            Insn::Bmb => 1,
            Insn::Bmw | Insn::Fill => 2,
            Insn::Bmd => 4,
            _ => return None,
        };
        if !(1..=u32::from(u8::MAX)).contains(&count) {
            return None;
        }
        let bytes = size * count;
        let to = self.plain_bytes(to, bytes)?;
        if insn == Insn::Fill {
            let is_zero = matches!(from, Operand::Const(0));
            return (is_zero || count <= FILLED_MAX).then_some(KnownMove::Fill { to, words: count });
        }
        Some(KnownMove::Copy { from: self.plain_bytes(from, bytes)?, to, bytes })
    }

    /// The address of bytes in an area that is nothing but memory, if they are all there.
    fn plain_bytes(&self, operand: &Operand, bytes: u32) -> Option<Address> {
        let &Operand::Memory { area, byte, .. } = operand else { return None };
        let profile = &self.plan.program.profile;
        let length = match area {
            Area::V => self.plan.dbs.iter().find(|db| db.number == V_DB)?.length,
            Area::I => profile.inputs,
            Area::Q => profile.outputs,
            Area::M => profile.bit_memory,
            Area::L | Area::Sm | Area::S => return None,
        };
        (byte.checked_add(bytes)? <= length).then(|| area_address(area, byte))
    }

    /// Does a block move here. Sides that overlap are copied as if through a buffer.
    pub fn move_in_place(&mut self, known: KnownMove, operands: &[Operand]) {
        match known {
            KnownMove::Copy { from, to, bytes } => self.b.copy(to, from, bytes),
            KnownMove::Fill { to, words } => {
                let value = self.read(&operands[0], Width::Word);
                if self.b.constant_bits(value) == Some(0) {
                    return self.b.clear(to, 2 * words);
                }
                for word in 0..words {
                    self.b.store(Address { offset: to.offset + 2 * word, ..to }, value);
                }
            }
        }
    }
}
