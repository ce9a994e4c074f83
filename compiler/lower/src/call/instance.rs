//! Calls of FBs: copies into the instance and back.

use plcc_abi::layout::area;
use plcc_ir::{Address, BinaryOp, FuncId, Type, Value};
use plcc_model::{Actual, Argument, CodeBlock, Direction, Instance, Parameter, Passing, Place, Width};

use super::{big_endian, is_value};
use crate::block::BlockLowering;
use crate::fault::Substitute;
use crate::place::{self, BitNumber, Target, TargetKind};

impl BlockLowering<'_, '_> {
    /// Calls an FB of the program with its instance.
    pub(super) fn call_instance(
        &mut self,
        callee: &CodeBlock,
        function: FuncId,
        instance: &Instance,
        arguments: &[Argument],
    ) {
        let base = match instance {
            Instance::Db(number) => Place::Db { number: *number, byte: 0, bit: 0 },
            Instance::Multi { byte } => Place::Instance { byte: *byte, bit: 0 },
            Instance::Inner { db, byte } => Place::Db { number: *db, byte: *byte, bit: 0 },
        };
        let (db, di, ar2) = (self.get(self.regs.db), self.get(self.regs.di), self.get(self.regs.ar[1]));
        for argument in arguments {
            let parameter = &callee.interface.parameters[argument.parameter];
            if parameter.direction != Direction::Output || !is_value(parameter.passing) {
                self.copy_in(callee, parameter, &argument.actual, &base);
            }
        }
        let (instance_db, instance_ar2) = match instance {
            Instance::Db(number) => {
                let start = self.b.i32_const(u32::from(area::DB) << 24);
                (self.b.i32_const(u32::from(*number)), start)
            }
            Instance::Inner { db, byte } => {
                let start = self.b.i32_const((u32::from(area::DB) << 24) | (8 * byte));
                (self.b.i32_const(u32::from(*db)), start)
            }
            Instance::Multi { byte } => {
                let moved = self.b.binary_imm(BinaryOp::Iadd, ar2, 8 * i64::from(*byte));
                (di, moved)
            }
        };
        self.set(self.regs.db, di);
        self.set(self.regs.di, instance_db);
        self.set(self.regs.ar[1], instance_ar2);
        self.call_function(callee, function, Vec::new());
        self.set(self.regs.di, di);
        self.set(self.regs.ar[1], ar2);
        // Actuals in the open DB mean the one that was open at the call.
        self.set(self.regs.db, db);
        for argument in arguments {
            let parameter = &callee.interface.parameters[argument.parameter];
            if parameter.direction != Direction::Input && is_value(parameter.passing) && !is_reference(parameter) {
                self.copy_out(parameter, &argument.actual, &base);
            }
        }
        self.set(self.regs.db, instance_db);
    }

    /// Puts an actual into the instance.
    fn copy_in(&mut self, callee: &CodeBlock, parameter: &Parameter, actual: &Actual, base: &Place) {
        let byte = parameter.byte;
        match (parameter.passing, actual) {
            (Passing::Elementary(width), Actual::Place(place)) => {
                let db = self.get(self.regs.db);
                let value = self.read(place, width);
                self.set(self.regs.db, db);
                self.write_instance(callee, base, parameter, width, value);
            }
            (Passing::Elementary(width), Actual::Const(bytes)) => {
                let value = self.b.i32_const(big_endian(bytes));
                let value = if width == Width::Bit { self.b.trunc(Type::I1, value) } else { value };
                self.write_instance(callee, base, parameter, width, value);
            }
            (Passing::Complex { .. }, actual) if is_reference(parameter) => {
                let Actual::Place(place) = actual else { unreachable!("the binder gives IN_OUT variables") };
                let fields = self.checked_pointer_fields(place);
                let target = self.instance_target(base, byte, Width::Dword);
                self.store_at(target, |lowering, addr| lowering.store_pointer_fields(addr, fields));
            }
            (Passing::Complex { .. }, Actual::Const(constant)) => {
                let target = self.instance_target(base, byte, Width::Dword);
                self.store_at(target, |lowering, addr| lowering.store_bytes(addr, constant));
            }
            (Passing::Complex { bytes }, Actual::Place(place)) => {
                let to = self.instance_target(base, byte, Width::Byte);
                self.copy_block(place, to, bytes, true);
            }
            (Passing::Number, Actual::Number(number)) => {
                let value = self.number(number);
                self.write_instance(callee, base, parameter, Width::Word, value);
            }
            (Passing::Pointer | Passing::Any | Passing::Variant, actual) => {
                let any = parameter.passing != Passing::Pointer;
                let target = self.instance_target(base, byte, Width::Byte);
                self.store_at(target, |lowering, addr| lowering.store_pointer(addr, actual, any));
            }
            (Passing::Elementary(_) | Passing::Complex { .. } | Passing::Number | Passing::OpenArray { .. }, _) => {
                unreachable!("the binder gives each formal an actual of its kind")
            }
        }
    }

    /// Copies a result from the instance to its actual.
    fn copy_out(&mut self, parameter: &Parameter, actual: &Actual, base: &Place) {
        let Actual::Place(place) = actual else { return };
        match parameter.passing {
            Passing::Elementary(width) => {
                let target = self.instance_bit_target(base, parameter.byte, parameter.bit, width);
                let value = self.read_target(target, width);
                let db = self.get(self.regs.db);
                self.write(place, width, value);
                self.set(self.regs.db, db);
            }
            Passing::Complex { bytes } => {
                let from = self.instance_target(base, parameter.byte, Width::Byte);
                self.copy_block(place, from, bytes, false);
            }
            Passing::Number | Passing::Pointer | Passing::Any | Passing::Variant | Passing::OpenArray { .. } => {}
        }
    }

    /// Copies `bytes` between a variable and the instance, `inward` into the latter.
    pub(super) fn copy_block(&mut self, place: &Place, instance: Target, bytes: u32, inward: bool) {
        let db = self.get(self.regs.db);
        let direction = if inward { place::Direction::Read } else { place::Direction::Write };
        let variable = self.target(place, Width::Byte, direction);
        self.set(self.regs.db, db);
        let instance_checks = instance.checks;
        let (variable, _, mut checks) = self.in_memory(variable, Width::Byte, direction);
        let TargetKind::Memory { addr: instance, .. } = instance.kind else { unreachable!("instances are in memory") };
        checks.extend(instance_checks);
        let guard = self.begin_guard(checks, Substitute::None);
        let (to, from) = if inward { (instance, variable) } else { (variable, instance) };
        self.b.copy(to, from, bytes);
        self.end_guard(guard);
    }

    /// Byte `byte`.`bit` of the callee's instance.
    fn instance_bit_target(&mut self, base: &Place, byte: u32, bit: u8, width: Width) -> Target {
        let place = match base {
            Place::Instance { byte: start, .. } => Place::Instance { byte: start + byte, bit },
            Place::Db { number, byte: start, .. } => Place::Db { number: *number, byte: start + byte, bit },
            _ => unreachable!("instances are in a DB or in this block's instance"),
        };
        let db = self.get(self.regs.db);
        let target = self.target(&place, width, place::Direction::Write);
        self.set(self.regs.db, db);
        target
    }

    fn instance_target(&mut self, base: &Place, byte: u32, width: Width) -> Target {
        self.instance_bit_target(base, byte, 0, width)
    }

    fn write_instance(&mut self, callee: &CodeBlock, base: &Place, parameter: &Parameter, width: Width, value: Value) {
        let mut target = self.instance_bit_target(base, parameter.byte, parameter.bit, width);
        if let TargetKind::Memory { bit: bit @ BitNumber::Known(_), .. } = &mut target.kind {
            *bit = BitNumber::of(callee, parameter.byte, parameter.bit);
        }
        self.write_target(target, width, value);
    }

    /// Runs `store` on the target's address, after its checks.
    fn store_at(&mut self, target: Target, store: impl FnOnce(&mut Self, Address)) {
        let guard = self.begin_guard(target.checks, Substitute::None);
        let TargetKind::Memory { addr, .. } = target.kind else { unreachable!("instances are in memory") };
        store(self, addr);
        self.end_guard(guard);
    }
}

/// True for a complex IN_OUT of an FB: a POINTER in the instance.
fn is_reference(parameter: &Parameter) -> bool {
    matches!(parameter.passing, Passing::Complex { .. }) && parameter.direction == Direction::InOut
}
