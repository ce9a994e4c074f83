//! Bit logic, the logic stack, S and R. Source: S7-200 system manual, bit logic and stack instructions.

use plcc_abi::RuntimeFn;
use plcc_abi::s7200::{Operation, STACK_LEVELS, system};
use plcc_ir::{Address, BinaryOp, IntCc, Region, Type, Value};
use plcc_model::s7200::{Area, Operand, Width};

use super::block::S7200Lowering;
use super::operand::{Use, area_address};

/// Limit of bits that S and R with a constant count write directly.
const DIRECT_BITS: u32 = 64;
/// The same for timers and counters.
const DIRECT_CELLS: u32 = 4;

impl S7200Lowering<'_, '_> {
    fn bit(&mut self, operands: &[Operand], negated: bool) -> Value {
        let value = self.read(&operands[0], Width::Bit);
        if !is_always_on(&operands[0]) {
            self.count_contact(value);
        }
        if negated { self.b.not(value) } else { value }
    }

    /// `LD`, `LDN`.
    pub fn load_bit(&mut self, operands: &[Operand], negated: bool) {
        let value = self.bit(operands, negated);
        self.push(value);
    }

    /// `A AN O ON`.
    pub fn combine_bit(&mut self, operands: &[Operand], op: BinaryOp, negated: bool) {
        let value = self.bit(operands, negated);
        self.combine(op, value);
    }

    /// S0 := S0 op `value`.
    pub fn combine(&mut self, op: BinaryOp, value: Value) {
        let top = self.top();
        let result = self.b.binary(op, top, value);
        self.set_top(result);
    }

    /// The current value of the input at the module, an i1.
    fn bit_now(&mut self, operands: &[Operand], negated: bool) -> Value {
        let Operand::Memory { byte, bit, .. } = operands[0] else { return self.b.bool_const(false) };
        let (address, bytes) = (self.b.i32_const(byte), self.b.i32_const(1));
        let value = self.b.call_runtime(RuntimeFn::PeripheralRead, &[address, bytes]).expect("it returns a value");
        let value = self.b.trunc(Type::I8, value);
        let value = self.b.binary_imm(BinaryOp::And, value, 1 << bit);
        let value = self.b.icmp_imm(IntCc::Ne, value, 0);
        self.count_contact(value);
        if negated { self.b.not(value) } else { value }
    }

    /// `LDI`, `LDNI`.
    pub fn load_now(&mut self, operands: &[Operand], negated: bool) {
        let value = self.bit_now(operands, negated);
        self.push(value);
    }

    /// `AI ANI OI ONI`.
    pub fn combine_now(&mut self, operands: &[Operand], op: BinaryOp, negated: bool) {
        let value = self.bit_now(operands, negated);
        self.combine(op, value);
    }

    pub fn not(&mut self) {
        let top = self.top();
        let value = self.b.not(top);
        self.set_top(value);
    }

    /// `EU`. The memory is 1 when RUN begins, so the first execution sees no edge.
    pub fn rising_edge(&mut self) {
        let edge = self.plan.rising_edges.take();
        let top = self.top();
        let rising = self.edge_of(edge, top);
        self.set_top(rising);
    }

    /// Whether `value` has risen since the last update of the edge memory.
    pub fn edge_of(&mut self, edge: u32, value: Value) -> Value {
        let old = self.swap_edge(edge, value);
        let was_off = self.b.not(old);
        self.b.and(value, was_off)
    }

    /// `ED`. The memory is 0 when RUN begins.
    pub fn falling_edge(&mut self) {
        let edge = self.plan.falling_edges.take();
        let top = self.top();
        let old = self.swap_edge(edge, top);
        let is_off = self.b.not(top);
        let falling = self.b.and(old, is_off);
        self.set_top(falling);
    }

    /// Stores a value in an edge memory; returns the one before.
    fn swap_edge(&mut self, edge: u32, value: Value) -> Value {
        let at = Address::direct(Region::System, system::EDGES + edge);
        let old = self.b.load(Type::I8, at);
        let byte = self.b.zext(Type::I8, value);
        self.b.store(at, byte);
        self.b.icmp_imm(IntCc::Ne, old, 0)
    }

    /// `=`.
    pub fn assign(&mut self, operands: &[Operand]) {
        let top = self.top();
        let target = self.target(&operands[0], Width::Bit);
        self.store(target, Width::Bit, top);
    }

    /// `=I`: image and module.
    pub fn assign_now(&mut self, operands: &[Operand]) {
        let Operand::Memory { byte, bit, .. } = operands[0] else { return };
        let top = self.top();
        let (address, bit) = (self.b.i32_const(byte), self.b.i32_const(u32::from(bit)));
        let value = self.b.zext(Type::I32, top);
        self.b.call_runtime(RuntimeFn::PeripheralWriteBit, &[address, bit, value]);
    }

    /// `ALD`, `OLD`.
    pub fn combine_levels(&mut self, op: BinaryOp) {
        let below = self.get(self.stack[1]);
        self.combine(op, below);
        self.close_gap(1);
    }

    /// `LPS`: pushes a copy of a level.
    pub fn copy_level(&mut self, level: usize) {
        let value = self.get(self.stack[level.min(STACK_LEVELS - 1)]);
        self.push(value);
    }

    /// `LRD`.
    pub fn read_level(&mut self) {
        let value = self.get(self.stack[1]);
        self.set_top(value);
    }

    /// `LPP`.
    pub fn pop(&mut self) {
        self.close_gap(0);
    }

    /// `LDS n`.
    pub fn load_level(&mut self, operands: &[Operand]) {
        if let Operand::Const(level) = operands[0] {
            self.copy_level(level as usize);
        }
    }

    pub fn and_eno(&mut self) {
        let eno = self.get(self.eno);
        self.combine(BinaryOp::And, eno);
    }

    /// `S`, `R`.
    pub fn write_bits(&mut self, operands: &[Operand], value: bool) {
        let [target, count] = operands else { return };
        self.boxed(|lowering| match (target, count) {
            (Operand::Timer { number, .. }, _) => {
                let operation = if value { Operation::SetTimers } else { Operation::ResetTimers };
                lowering.write_cells(operation, *number, count);
            }
            (Operand::Counter { number, .. }, Operand::Const(known @ 1..=DIRECT_CELLS)) => {
                lowering.write_counters(*number, *known, value);
            }
            (Operand::Counter { number, .. }, _) => {
                let operation = if value { Operation::SetCounters } else { Operation::ResetCounters };
                lowering.write_cells(operation, *number, count);
            }
            (Operand::Memory { area, byte, bit, .. }, Operand::Const(known @ 1..=DIRECT_BITS)) => {
                lowering.write_known_bits(*area, *byte, *bit, *known, value);
            }
            (Operand::Memory { area, byte, bit, .. }, _) => {
                let at = lowering.b.address_of(area_address(*area, *byte));
                let first = lowering.b.binary_imm(BinaryOp::Shl, at, 3);
                let first = lowering.b.binary_imm(BinaryOp::Iadd, first, i64::from(*bit));
                let count = lowering.count(count);
                let value = lowering.b.i32_const(u32::from(value));
                lowering.run(Operation::WriteBits, &[first, count, value]);
            }
            _ => {}
        });
    }

    /// A count, zero-extended.
    fn count(&mut self, operand: &Operand) -> Value {
        let count = self.read(operand, Width::Byte);
        self.b.zext(Type::I32, count)
    }

    fn write_cells(&mut self, operation: Operation, first: u8, count: &Operand) {
        let count = self.count(count);
        let first = self.b.i32_const(u32::from(first));
        self.run(operation, &[first, count]);
    }

    /// S only sets the bits, R also clears current values.
    fn write_counters(&mut self, first: u8, count: u32, value: bool) {
        for number in u32::from(first)..(u32::from(first) + count).min(plcc_abi::s7200::COUNTERS) {
            let bit = self.b.iconst(Type::I8, i64::from(value));
            self.b.store(Address::direct(Region::System, system::COUNTER_BITS + number), bit);
            if !value {
                let zero = self.b.iconst(Type::I16, 0);
                self.b.store(Address::direct(Region::System, system::COUNTER_VALUES + 2 * number), zero);
            }
        }
    }

    /// A byte at a time. The binder has checked that the area is large enough.
    fn write_known_bits(&mut self, area: Area, byte: u32, bit: u8, count: u32, value: bool) {
        let end = u32::from(bit) + count;
        for index in 0..end.div_ceil(8) {
            let from = if index == 0 { u32::from(bit) } else { 0 };
            let to = (end - 8 * index).min(8);
            let mask = (1u32 << to) - (1u32 << from);
            let at = area_address(area, byte + index);
            if to - from == 1 {
                let value = self.b.bool_const(value);
                self.b.store_bit(at, from as u8, value);
                continue;
            }
            let new = if mask == 0xFF {
                self.b.iconst(Type::I8, if value { 0xFF } else { 0 })
            } else {
                let old = self.b.load(Type::I8, at);
                match value {
                    true => self.b.binary_imm(BinaryOp::Or, old, i64::from(mask)),
                    false => self.b.binary_imm(BinaryOp::And, old, i64::from(!mask & 0xFF)),
                }
            };
            self.b.store(at, new);
        }
        if area == Area::Sm {
            self.special_written(byte, end.div_ceil(8));
        }
    }

    /// `SI`, `RI`.
    pub fn write_outputs_now(&mut self, operands: &[Operand], value: bool) {
        let [Operand::Memory { byte, bit, .. }, count] = operands else { return };
        self.boxed(|lowering| {
            let count = lowering.count(count);
            let first = lowering.b.i32_const(8 * byte + u32::from(*bit));
            let value = lowering.b.i32_const(u32::from(value));
            lowering.run(Operation::WriteOutputsNow, &[first, count, value]);
        });
    }

    /// Writes bit `bit` of SM1.
    pub fn set_flag(&mut self, bit: u8, value: Value) {
        self.b.store_bit(Address::direct(Region::System, system::SM + 1), bit, value);
    }

    /// The address of an operand for operations of the runtime: a byte that is read or written.
    pub fn operand_address(&mut self, operand: &Operand, purpose: Use) -> Value {
        self.address_value(operand, Width::Byte, purpose)
    }
}

/// SM0.0, which is always 1: its other value is not missed. Source: S7-200 system manual, special memory.
const fn is_always_on(operand: &Operand) -> bool {
    matches!(operand, Operand::Memory { area: Area::Sm, byte: 0, bit: 0, width: Width::Bit })
}
