//! Pointers: double words that hold an area and a byte. V, the usual area, is checked here; others ask the runtime.

use plcc_abi::RuntimeFn;
use plcc_abi::s7200::{V_DB, pointer};
use plcc_ir::{BinaryOp, IntCc, Value};

use super::block::S7200Lowering;
use super::operand::Use;

impl S7200Lowering<'_, '_> {
    /// Offset of the target of `pointer` from the memory base, an i32, with access to `bytes` bytes. On a bad pointer the
    /// instruction ends here.
    pub fn follow(&mut self, pointer: Value, bytes: u32, purpose: Use) -> Value {
        let v = self.plan.dbs.iter().find(|db| db.number == V_DB);
        let (v_address, v_bytes) = v.map_or((0, 0), |db| (db.address, db.length));
        let offset = self.b.binary_imm(BinaryOp::Isub, pointer, i64::from(pointer_to(pointer::V, 0)));
        let last = i64::from(v_bytes) - i64::from(bytes);
        if last < 0 {
            return self.follow_anywhere(pointer, bytes, purpose);
        }
        let in_v = self.b.icmp_imm(IntCc::Ule, offset, last);
        let (fast, slow, after) = (self.b.create_block(), self.b.create_cold_block(), self.b.create_block());
        self.b.branch(in_v, fast, slow);
        self.b.seal_block(fast);
        self.b.seal_block(slow);
        self.b.switch_to(fast);
        let base = self.b.binary_imm(BinaryOp::Iadd, offset, i64::from(v_address));
        self.set(self.result, base);
        self.b.jump(after, &[]);
        self.b.switch_to(slow);
        let base = self.follow_anywhere(pointer, bytes, purpose);
        self.set(self.result, base);
        self.b.jump(after, &[]);
        self.b.seal_block(after);
        self.b.switch_to(after);
        self.get(self.result)
    }

    fn follow_anywhere(&mut self, pointer: Value, bytes: u32, purpose: Use) -> Value {
        let (bytes, write) = (self.b.i32_const(bytes), self.b.i32_const(u32::from(purpose == Use::Write)));
        let base =
            self.b.call_runtime(RuntimeFn::S7200Pointer, &[pointer, bytes, write]).expect("it returns an address");
        let ok = self.b.icmp_imm(IntCc::Ne, base, 0);
        self.pointer_error_unless(ok);
        base
    }
}

/// A pointer to byte `offset` of the area with this tag.
const fn pointer_to(tag: u8, offset: u32) -> u32 {
    (tag as u32) << 24 | offset
}
