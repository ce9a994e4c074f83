//! Bits of memory that are taken out of their byte, or put into it, by arithmetic.
//!
//! An FC gets a BOOL as the number of a bit, and works on the byte around it. Once the number is known, the access is one of a bit,
//! which leaves the others alone. The byte operations are then dead code.
//!
//! ```text
//! v1 = load.i8 M 4
//! v2 = zext.i32 v1
//! v3 = lshr v2, 3
//! v4 = trunc.i1 v3           ; v4 = load.bit M 4.3
//!
//! v5 = load.i8 L 6
//! v6 = and v5, -9
//! v7 = zext.i8 v0
//! v8 = shl v7, 3
//! v9 = or v6, v8
//! store.i8 L 6, v9           ; store.bit L 6.3, v0
//! ```

use plcc_ir::entities::EntityVec;
use plcc_ir::function::ValueDef;
use plcc_ir::{Address, BinaryOp, ConvertOp, Function, Inst, InstData, Type, Value};
use rustc_hash::FxHashMap;

/// Makes bit accesses in a function. Result: whether there were any.
pub fn find_bits(function: &mut Function) -> bool {
    let uses = count_uses(function);
    let mut bits = Bits { function, uses, replaced: FxHashMap::default(), changed: false };
    for index in 0..bits.function.layout.len() {
        let block = bits.function.layout[index];
        let insts = std::mem::take(&mut bits.function.blocks[block].insts);
        let mut out = Vec::with_capacity(insts.len());
        // Bytes that were loaded after the last write of this block.
        let mut fresh: Vec<Value> = Vec::new();
        for inst in insts {
            match &bits.function.insts[inst] {
                InstData::Load { .. } if bits.function.ty(bits.function.result(inst)) == Type::I8 => {
                    fresh.push(bits.function.result(inst));
                }
                InstData::Convert { op: ConvertOp::Trunc, arg } => bits.load(inst, *arg),
                InstData::Store { addr, value } => {
                    let (addr, value) = (*addr, *value);
                    bits.store(inst, addr, value, &fresh, &mut out);
                    fresh.clear();
                }
                data if data.has_side_effect() => fresh.clear(),
                _ => {}
            }
            out.push(inst);
        }
        bits.function.blocks[block].insts = out;
    }
    if !bits.changed {
        return false;
    }
    let replaced = bits.replaced;
    if !replaced.is_empty() {
        for index in 0..function.layout.len() {
            let block = function.layout[index];
            let insts = std::mem::take(&mut function.blocks[block].insts);
            let mut out = Vec::with_capacity(insts.len());
            for inst in insts {
                match replaced.get(&inst) {
                    Some(Replaced::Load(bit)) => out.extend([*bit, inst]),
                    Some(Replaced::Trunc) => {}
                    None => out.push(inst),
                }
            }
            function.blocks[block].insts = out;
        }
    }
    function.resolve_aliases();
    true
}

/// How often each value is used, without uses by unused instructions.
fn count_uses(function: &Function) -> EntityVec<Value, u32> {
    let mut uses = EntityVec::filled(0, function.values.len());
    let insts = || function.layout.iter().flat_map(|&block| &function.blocks[block].insts);
    for &inst in insts() {
        function.insts[inst].for_each_use(|value| uses[function.resolve(value)] += 1);
    }
    let is_dead = |inst: Inst, uses: &EntityVec<Value, u32>| {
        let results = &function.results[inst];
        !function.insts[inst].has_side_effect() && results.iter().all(|&result| uses[result] == 0)
    };
    let mut dead: Vec<Inst> = insts().copied().filter(|&inst| is_dead(inst, &uses)).collect();
    while let Some(inst) = dead.pop() {
        function.insts[inst].for_each_use(|value| {
            let value = function.resolve(value);
            uses[value] -= 1;
            if let (0, ValueDef::Result(inst, _)) = (uses[value], function.values[value].def)
                && is_dead(inst, &uses)
            {
                dead.push(inst);
            }
        });
    }
    uses
}

/// The replacement of an instruction.
enum Replaced {
    /// This load of a bit is before it: what is known about a byte counts more than what is known about its bits.
    Load(Inst),
    /// It is that bit.
    Trunc,
}

struct Bits<'a> {
    function: &'a mut Function,
    uses: EntityVec<Value, u32>,
    replaced: FxHashMap<Inst, Replaced>,
    changed: bool,
}

impl Bits<'_> {
    fn is_used_once(&self, value: Value) -> bool {
        self.uses.get(value) == Some(&1)
    }

    /// The instruction that defines `value`, if nothing else uses it.
    fn sole(&self, value: Value) -> Option<(Inst, InstData)> {
        let value = self.function.resolve(value);
        match self.function.values[value].def {
            ValueDef::Result(inst, _) if self.is_used_once(value) => Some((inst, self.function.insts[inst].clone())),
            _ => None,
        }
    }

    /// Makes a `trunc` of a bit of a byte that was loaded for it alone a load of the bit, where the byte was loaded.
    fn load(&mut self, trunc: Inst, arg: Value) {
        let result = self.function.result(trunc);
        // An unused instruction does not count as a use: the byte may belong to another one.
        if self.function.ty(result) != Type::I1 || self.uses.get(result) == Some(&0) {
            return;
        }
        let (mut value, mut bit) = (arg, 0);
        loop {
            let Some((inst, data)) = self.sole(value) else { return };
            match data {
                InstData::Binary { op: BinaryOp::Lshr, args: [x, count] } if bit == 0 => {
                    let Some(count) = self.function.constant(count) else { return };
                    (value, bit) = (x, count);
                }
                InstData::Convert { op: ConvertOp::Zext, arg } => value = arg,
                InstData::Load { addr } if self.function.ty(value) == Type::I8 && bit < 8 => {
                    let data = InstData::LoadBit { addr, bit: bit as u8 };
                    let load = self.function.make_inst(data, &[Type::I1], self.function.locs[inst]);
                    self.uses.push(1);
                    self.function.replace_value(result, self.function.result(load));
                    self.replaced.insert(inst, Replaced::Load(load));
                    self.replaced.insert(trunc, Replaced::Trunc);
                    self.changed = true;
                    return;
                }
                _ => return,
            }
        }
    }

    /// Turns the store of a byte that changes only one bit into a store of the bit.
    fn store(&mut self, store: Inst, addr: Address, value: Value, fresh: &[Value], out: &mut Vec<Inst>) {
        if fresh.is_empty() || self.function.ty(value) != Type::I8 {
            return;
        }
        let Some((bit, new)) = self.changed_bit(&addr, value, fresh) else { return };
        let value = match new {
            Bit::Value(value) => value,
            Bit::Constant(bits) => {
                let loc = self.function.locs[store];
                let inst = self.function.make_inst(InstData::Const { bits }, &[Type::I1], loc);
                self.uses.push(1);
                out.push(inst);
                self.function.result(inst)
            }
        };
        self.function.insts[store] = InstData::StoreBit { addr, bit, value };
        self.changed = true;
    }

    /// The bit in which `value` differs from the byte at `addr`, and its new value.
    fn changed_bit(&self, addr: &Address, value: Value, fresh: &[Value]) -> Option<(u8, Bit)> {
        let is_old = |value| {
            let byte = self.low_byte(value);
            let load = self.function.defining(byte);
            fresh.contains(&byte) && matches!(load, Some(InstData::Load { addr: from }) if from == addr)
        };
        let Some(&InstData::Binary { op, args: [a, b] }) = self.function.defining(self.low_byte(value)) else {
            return None;
        };
        match (op, self.function.constant(b)) {
            (BinaryOp::Or, Some(mask)) if is_old(a) => Some((single_bit(mask)?, Bit::Constant(1))),
            (BinaryOp::And, Some(mask)) if is_old(a) => Some((single_bit(!mask)?, Bit::Constant(0))),
            (BinaryOp::Or, None) => [(a, b), (b, a)].into_iter().find_map(|(others, placed)| {
                let others = self.function.defining(self.low_byte(others))?;
                let &InstData::Binary { op: BinaryOp::And, args: [old, mask] } = others else { return None };
                let (bit, value) = self.placed_bit(self.low_byte(placed))?;
                let leaves = single_bit(!self.function.constant(mask)?)?;
                (is_old(old) && u64::from(leaves) == bit).then_some((leaves, Bit::Value(value)))
            }),
            _ => None,
        }
    }

    /// The value that has the low byte of `value`.
    fn low_byte(&self, value: Value) -> Value {
        let mut value = self.function.resolve(value);
        while let Some(InstData::Convert { op: ConvertOp::Trunc | ConvertOp::Zext, arg }) =
            self.function.defining(value)
            && self.function.ty(value) != Type::I1
            && self.function.ty(*arg) != Type::I1
        {
            value = self.function.resolve(*arg);
        }
        value
    }

    /// The bit that `value` is, moved to the left, and by how much.
    fn placed_bit(&self, value: Value) -> Option<(u64, Value)> {
        match *self.function.defining(value)? {
            InstData::Convert { op: ConvertOp::Zext, arg } if self.function.ty(arg) == Type::I1 => Some((0, arg)),
            InstData::Binary { op: BinaryOp::Shl, args: [x, count] } => match *self.function.defining(x)? {
                InstData::Convert { op: ConvertOp::Zext, arg } if self.function.ty(arg) == Type::I1 => {
                    Some((self.function.constant(count)?, arg))
                }
                _ => None,
            },
            _ => None,
        }
    }
}

/// The new value of a bit.
enum Bit {
    Value(Value),
    Constant(u64),
}

/// The number of the only bit that is set in the low byte of `mask`.
fn single_bit(mask: u64) -> Option<u8> {
    let byte = mask as u8;
    byte.is_power_of_two().then(|| byte.trailing_zeros() as u8)
}

#[cfg(test)]
mod tests {
    use crate::tests::check_body;

    fn check(body: &str, expected: &str) {
        check_body("bits", body, expected);
    }

    #[test]
    fn a_bit_of_a_loaded_byte() {
        check(
            "v2 = load.i8 M 4\nstore.i32 M 4, v0\nv3 = zext.i32 v2\nv4 = const.i32 3\nv5 = lshr v3, v4\nv6 = trunc.i1 \
             v5\nstore.bit Q 0.0, v6\nret v0",
            "v6 = load.bit M 4.3\nv2 = load.i8 M 4\nstore.i32 M 4, v0\nv3 = zext.i32 v2\nv4 = const.i32 3\nv5 = lshr v3, \
             v4\nstore.bit Q 0.0, v6\nret v0",
        );
        let text = "v2 = load.i8 M 4\nv3 = trunc.i1 v2\nstore.bit Q 0.0, v3\nstore.i8 Q 1, v2\nret v0";
        check(text, text);
        // Another bit of the byte, which is unused.
        check(
            "v2 = load.i8 M 4\nv3 = trunc.i1 v2\nv4 = trunc.i1 v2\nstore.bit Q 0.0, v3\nret v0",
            "v3 = load.bit M 4.0\nv2 = load.i8 M 4\nv4 = trunc.i1 v2\nstore.bit Q 0.0, v3\nret v0",
        );
    }

    #[test]
    fn a_byte_but_for_one_bit() {
        let around = "v2 = load.i8 M 4\nv3 = zext.i32 v2\nv4 = const.i32 4294967287\nv5 = and v3, v4\nv6 = zext.i32 v1\nv7 \
                      = const.i32 3\nv8 = shl v6, v7\nv9 = or v5, v8\nv10 = trunc.i8 v9\n";
        check(&format!("{around}store.i8 M 4, v10\nret v0"), &format!("{around}store.bit M 4.3, v1\nret v0"));
        for text in ["store.i8 M 5, v10\nret v0", "store.i32 M 4, v0\nstore.i8 M 4, v10\nret v0"] {
            let text = format!("{around}{text}");
            check(&text, &text);
        }
    }

    #[test]
    fn a_constant_bit() {
        check(
            "v2 = load.i8 M 4\nv3 = const.i8 16\nv4 = or v2, v3\nstore.i8 M 4, v4\nret v0",
            "v2 = load.i8 M 4\nv3 = const.i8 16\nv4 = or v2, v3\nv5 = const.i1 1\nstore.bit M 4.4, v5\nret v0",
        );
        let text = "v2 = load.i8 M 4\nv3 = const.i8 48\nv4 = or v2, v3\nstore.i8 M 4, v4\nret v0";
        check(text, text);
    }
}
