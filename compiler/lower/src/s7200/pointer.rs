//! Pointers: double words that hold an area and a byte. V, the usual area, is checked here; others ask the runtime.

use plcc_abi::RuntimeFn;
use plcc_abi::s7200::{V_DB, pointer};
use plcc_ir::{Address, BinaryOp, IntCc, Region, Type, Value};

use super::block::S7200Lowering;
use super::operand::Use;

/// Where a pointer leads.
#[derive(Clone, Copy)]
pub struct Pointed {
    /// Offset of the target from the memory base, an i32.
    pub base: Value,
    /// Whether it is in V memory (i1), and its offset there. `None`: it is not.
    in_v: Option<(Value, Value)>,
}

impl S7200Lowering<'_, '_> {
    /// Follows `pointer` to `bytes` bytes. On a bad pointer the instruction ends here.
    pub fn follow(&mut self, pointer: Value, bytes: u32, purpose: Use) -> Pointed {
        let Some((in_v, offset)) = self.is_in_v(pointer, bytes) else {
            return Pointed { base: self.follow_anywhere(pointer, bytes, purpose), in_v: None };
        };
        let v_address = self.plan.dbs.iter().find(|db| db.number == V_DB).map_or(0, |db| db.address);
        let base = self.by_target(
            in_v,
            Some(Type::I32),
            |this| Some(this.b.binary_imm(BinaryOp::Iadd, offset, i64::from(v_address))),
            |this| Some(this.follow_anywhere(pointer, bytes, purpose)),
        );
        Pointed { base: base.expect("both ways have an address"), in_v: Some((in_v, offset)) }
    }

    /// Follows `pointer` to a value of type `ty` in `bytes` bytes and loads it.
    pub fn load_through(&mut self, pointer: Value, bytes: u32, ty: Type) -> Value {
        let anywhere = |this: &mut Self| {
            let base = this.follow_anywhere(pointer, bytes, Use::Read);
            this.b.load(ty, Address::indexed(Region::Any, base, 0))
        };
        let Some((in_v, offset)) = self.is_in_v(pointer, bytes) else { return anywhere(self) };
        let v = |this: &mut Self| Some(this.b.load(ty, Address::indexed(Region::Db(V_DB), offset, 0)));
        self.by_target(in_v, Some(ty), v, |this| Some(anywhere(this))).expect("both ways load")
    }

    /// The value of type `ty` where a pointer leads.
    pub fn load_pointed(&mut self, pointed: Pointed, ty: Type) -> Value {
        let anywhere = |this: &mut Self| this.b.load(ty, Address::indexed(Region::Any, pointed.base, 0));
        let Some((in_v, offset)) = pointed.in_v else { return anywhere(self) };
        let v = |this: &mut Self| Some(this.b.load(ty, Address::indexed(Region::Db(V_DB), offset, 0)));
        self.by_target(in_v, Some(ty), v, |this| Some(anywhere(this))).expect("both ways load")
    }

    /// Stores `value` where a pointer leads.
    pub fn store_pointed(&mut self, pointed: Pointed, value: Value) {
        let anywhere = |this: &mut Self| this.b.store(Address::indexed(Region::Any, pointed.base, 0), value);
        let Some((in_v, offset)) = pointed.in_v else { return anywhere(self) };
        let v = |this: &mut Self| {
            this.b.store(Address::indexed(Region::Db(V_DB), offset, 0), value);
            None
        };
        self.by_target(in_v, None, v, |this| {
            anywhere(this);
            None
        });
    }

    /// Whether `bytes` bytes at `pointer` are in V memory, and where there. `None`: it has fewer.
    pub fn is_in_v(&mut self, pointer: Value, bytes: u32) -> Option<(Value, Value)> {
        let length = self.plan.dbs.iter().find(|db| db.number == V_DB)?.length;
        let last = length.checked_sub(bytes)?;
        let offset = self.b.binary_imm(BinaryOp::Isub, pointer, i64::from(pointer_to(pointer::V, 0)));
        let in_v = self.b.icmp_imm(IntCc::Ule, offset, i64::from(last));
        Some((in_v, offset))
    }

    /// Does the one for targets in V memory, the other for all others. An access in V memory names its DB, so that it touches nothing
    /// else. Result: what they bring.
    fn by_target(
        &mut self,
        in_v: Value,
        ty: Option<Type>,
        v: impl FnOnce(&mut Self) -> Option<Value>,
        anywhere: impl FnOnce(&mut Self) -> Option<Value>,
    ) -> Option<Value> {
        let (fast, slow, after) = (self.b.create_block(), self.b.create_cold_block(), self.b.create_block());
        let result = ty.map(|ty| self.b.append_param(after, ty));
        self.b.branch(in_v, fast, slow);
        self.b.seal_block(fast);
        self.b.seal_block(slow);
        self.b.switch_to(fast);
        let value = v(self);
        self.b.jump(after, value.as_slice());
        self.b.switch_to(slow);
        let value = anywhere(self);
        self.b.jump(after, value.as_slice());
        self.b.seal_block(after);
        self.b.switch_to(after);
        result
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
