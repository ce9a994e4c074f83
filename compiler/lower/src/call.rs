//! Block calls: registers, parameters, instances. Source: STL reference, block call model.
//!
//! - FC: each formal is a reference to its actual, so the FC sees changes during its run and an OUT that it does not write
//!   does not change the actual. Constants and peripheral inputs are put into the caller's frame first.
//! - FB: elementary and complex values are copied into the instance and back; complex IN_OUT are POINTERs there.
//! - System functions get a structure of parameters in the caller's frame.

use plcc_abi::RuntimeFn;
use plcc_abi::codes::{stop, sync};
use plcc_abi::image::BlockKind;
use plcc_abi::layout::{self, CpuRegister, area, state};
use plcc_ir::{Address, BinaryOp, FuncId, FunctionBuilder, IntCc, Region, Type, Value};
use plcc_model::{Actual, Argument, BlockKey, Call, CodeBlock, Direction, Instance, Parameter, Passing, Place, Width};

use crate::block::BlockLowering;
use crate::fault::{Check, Substitute};
use crate::place::{self, BitNumber, Target, TargetKind};
use crate::plan;

/// The SFC with a separate runtime function: timers use it in every call.
const TIME_TCK: u16 = 64;

impl BlockLowering<'_, '_> {
    /// `CALL` with its parameters.
    pub fn call(&mut self, call: &Call) {
        let plan = self.plan;
        let Some((callee, function)) = plan.block(call.target) else {
            unreachable!("the binder only passes calls of known blocks");
        };
        match (function, &call.instance) {
            (Some(function), Some(instance)) => self.call_instance(callee, function, instance, &call.arguments),
            (Some(function), None) => self.call_fc(callee, function, &call.arguments),
            (None, _) => self.call_system_function(callee, &call.arguments),
        }
        self.bring_back();
        self.after_block();
    }

    // Functions.

    fn call_fc(&mut self, callee: &CodeBlock, function: FuncId, arguments: &[Argument]) {
        let mut copies_back = Vec::new();
        let mut references = Vec::new();
        let mut pointers = Vec::new();
        let plan = self.plan;
        let pointed = plan.pointed(callee.key());
        for (index, parameter) in callee.interface.parameters.iter().enumerate() {
            let argument = arguments.iter().find(|argument| argument.parameter == index);
            match argument {
                Some(argument) => {
                    // A fully qualified actual does not change the caller's DB register.
                    let db = self.get(self.regs.db);
                    let wanted = pointed.contains(&index).then_some(&mut pointers);
                    self.fc_argument(parameter, &argument.actual, &mut references, &mut copies_back, wanted);
                    self.set(self.regs.db, db);
                }
                None => {
                    self.no_argument(parameter, &mut references);
                    if pointed.contains(&index) {
                        pointers.push(self.b.i32_const(0));
                    }
                }
            }
        }
        references.extend(pointers);
        self.call_function(callee, function, references);
        for (place, width, temporary) in copies_back {
            let value = self.read_target(Target::at(temporary, BitNumber::Known(0)), width);
            self.write(&place, width, value);
        }
    }

    /// The values that an FC gets for one parameter; see [`plan::parameter_types`]. `pointers`: the FC also needs the area pointer of the
    /// actual. An actual without one in the FC is copied into the caller's frame and back, as STEP 7 does.
    fn fc_argument(
        &mut self,
        parameter: &Parameter,
        actual: &Actual,
        references: &mut Vec<Value>,
        copies_back: &mut Vec<(Place, Width, Address)>,
        pointers: Option<&mut Vec<Value>>,
    ) {
        match parameter.passing {
            Passing::Elementary(width) => {
                let mut copy = None;
                let reference = match actual {
                    Actual::Place(place)
                        if matches!(place, Place::Pi { .. } | Place::Pq { .. })
                            || pointers.is_some() && !has_area_pointer(place) =>
                    {
                        let temporary = self.temporary(4);
                        copy = Some(temporary);
                        if parameter.direction != Direction::Output {
                            let value = self.read(place, width);
                            self.write_target(Target::at(temporary, BitNumber::Known(0)), width, value);
                        }
                        if parameter.direction != Direction::Input {
                            copies_back.push((place.clone(), width, temporary));
                        }
                        self.reference(Target::at(temporary, BitNumber::Known(0)), width, place::Direction::Write)
                    }
                    Actual::Place(place) => {
                        let direction = access_direction(parameter.direction);
                        let target = self.target(place, width, direction);
                        self.reference(target, width, direction)
                    }
                    Actual::Const(bytes) => {
                        let temporary = self.temporary(bytes.len() as u32);
                        copy = Some(temporary);
                        self.store_bytes(temporary, bytes);
                        self.reference(Target::at(temporary, BitNumber::Known(0)), width, place::Direction::Write)
                    }
                    Actual::Number(_)
                    | Actual::PointerBytes(_)
                    | Actual::PointerTo { .. }
                    | Actual::PointerCopy(_)
                    | Actual::Variant(..) => {
                        unreachable!("the binder gives elementary formals values")
                    }
                };
                references.push(reference);
                if let Some(pointers) = pointers {
                    let copy = copy.map_or(0, |temporary| temporary.offset);
                    let pointer = match actual {
                        Actual::Place(place) if has_area_pointer(place) => self.pointer_fields(place).pointer,
                        _ => self.pointer_fields(&Place::L { byte: copy, bit: 0 }).pointer,
                    };
                    pointers.push(pointer);
                }
            }
            Passing::Complex { .. } => self.complex_argument(actual, references),
            Passing::Number => {
                let Actual::Number(number) = actual else { unreachable!("the binder gives numbers") };
                references.push(self.number(number));
            }
            Passing::Pointer | Passing::Any | Passing::Variant => {
                let temporary = self.temporary(parameter.passing.pointer_bytes());
                self.store_pointer(temporary, actual, parameter.passing != Passing::Pointer);
                references.push(self.b.i32_const(temporary.offset));
            }
            Passing::OpenArray { .. } => unreachable!("the binder gives an ARRAY[*] to calls from SCL only"),
        }
    }

    /// POINTER in the frame, and the variable itself.
    fn complex_argument(&mut self, actual: &Actual, references: &mut Vec<Value>) {
        let pointer = self.temporary(6);
        match actual {
            Actual::Place(place) => {
                let fields = self.pointer_fields(place);
                self.store_pointer_fields(pointer, fields);
                let target = self.target(place, Width::Byte, place::Direction::Read);
                let reference = self.reference(target, Width::Byte, place::Direction::Read);
                references.push(self.b.i32_const(pointer.offset));
                references.push(reference);
            }
            Actual::Const(bytes) => {
                let temporary = self.temporary(bytes.len() as u32);
                self.store_bytes(temporary, bytes);
                let fields = self.pointer_fields(&Place::L { byte: temporary.offset, bit: 0 });
                self.store_pointer_fields(pointer, fields);
                references.push(self.b.i32_const(pointer.offset));
                let address = self.b.address_of(temporary);
                references.push(address);
            }
            Actual::Number(_)
            | Actual::PointerBytes(_)
            | Actual::PointerTo { .. }
            | Actual::PointerCopy(_)
            | Actual::Variant(..) => {
                unreachable!("the binder gives complex formals variables")
            }
        }
    }

    /// `UC` of an FC with parameters passes nothing: reads yield 0, writes have no effect.
    fn no_argument(&mut self, parameter: &Parameter, references: &mut Vec<Value>) {
        let scratch = match parameter.passing {
            Passing::Elementary(Width::Bit) => layout::SCRATCH * 8,
            Passing::Elementary(_) => layout::SCRATCH,
            Passing::Complex { .. } => {
                let pointer = self.temporary(6);
                self.b.clear(pointer, 6);
                references.push(self.b.i32_const(pointer.offset));
                layout::SCRATCH
            }
            Passing::Number => 0,
            Passing::Pointer | Passing::Any | Passing::Variant => {
                let bytes = parameter.passing.pointer_bytes();
                let pointer = self.temporary(bytes);
                self.b.clear(pointer, bytes);
                pointer.offset
            }
            Passing::OpenArray { dimensions } => {
                let pointer = self.temporary(6);
                self.b.clear(pointer, 6);
                references.push(self.b.i32_const(pointer.offset));
                references.push(self.b.i32_const(layout::SCRATCH));
                // No element exists between 1 and 0.
                for _ in 0..dimensions {
                    references.push(self.b.i32_const(1));
                    references.push(self.b.i32_const(0));
                }
                return;
            }
        };
        references.push(self.b.i32_const(scratch));
    }

    /// A reference to `target` for an FC. If the address is faulty, it refers to scratch memory.
    pub fn reference(&mut self, target: Target, width: Width, direction: place::Direction) -> Value {
        let (addr, bit, mut checks) = self.in_memory(target, width, direction);
        checks.retain(|check| self.b.constant_bits(check.ok) != Some(1));
        let reference = |lowering: &mut Self| {
            let address = lowering.b.address_of(addr);
            if width != Width::Bit {
                return address;
            }
            let bits = lowering.b.binary_imm(BinaryOp::Shl, address, 3);
            match bit {
                BitNumber::Known(bit) => lowering.b.binary_imm(BinaryOp::Iadd, bits, i64::from(bit)),
                BitNumber::Dynamic(bit) => lowering.b.iadd(bits, bit),
            }
        };
        if checks.is_empty() {
            return reference(self);
        }
        let scratch = if width == Width::Bit { layout::SCRATCH * 8 } else { layout::SCRATCH };
        let scratch = self.b.i32_const(scratch);
        self.set(self.reference, scratch);
        let guard = self.begin_guard(checks, Substitute::None);
        let value = reference(self);
        self.set(self.reference, value);
        self.end_guard(guard);
        self.get(self.reference)
    }

    // Function blocks.

    fn call_instance(&mut self, callee: &CodeBlock, function: FuncId, instance: &Instance, arguments: &[Argument]) {
        let base = match instance {
            Instance::Db(number) => Place::Db { number: *number, byte: 0, bit: 0 },
            Instance::Multi { byte } => Place::Instance { byte: *byte, bit: 0 },
        };
        let (db, di, ar2) = (self.get(self.regs.db), self.get(self.regs.di), self.get(self.regs.ar[1]));
        for argument in arguments {
            let parameter = &callee.interface.parameters[argument.parameter];
            if parameter.direction != Direction::Output || !is_value(parameter.passing) {
                self.copy_in(parameter, &argument.actual, &base);
            }
        }
        let (instance_db, instance_ar2) = match instance {
            Instance::Db(number) => {
                let start = self.b.i32_const(u32::from(area::DB) << 24);
                (self.b.i32_const(u32::from(*number)), start)
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
    fn copy_in(&mut self, parameter: &Parameter, actual: &Actual, base: &Place) {
        let (byte, bit) = (parameter.byte, parameter.bit);
        match (parameter.passing, actual) {
            (Passing::Elementary(width), Actual::Place(place)) => {
                let db = self.get(self.regs.db);
                let value = self.read(place, width);
                self.set(self.regs.db, db);
                self.write_instance(base, byte, bit, width, value);
            }
            (Passing::Elementary(width), Actual::Const(bytes)) => {
                let value = self.b.i32_const(big_endian(bytes));
                let value = if width == Width::Bit { self.b.trunc(Type::I1, value) } else { value };
                self.write_instance(base, byte, bit, width, value);
            }
            (Passing::Complex { .. }, actual) if is_reference(parameter) => {
                let Actual::Place(place) = actual else { unreachable!("the binder gives IN_OUT variables") };
                let fields = self.pointer_fields(place);
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
                self.write_instance(base, byte, 0, Width::Word, value);
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
    fn copy_block(&mut self, place: &Place, instance: Target, bytes: u32, inward: bool) {
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
            Place::Db { number, .. } => Place::Db { number: *number, byte, bit },
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

    fn write_instance(&mut self, base: &Place, byte: u32, bit: u8, width: Width, value: Value) {
        let target = self.instance_bit_target(base, byte, bit, width);
        self.write_target(target, width, value);
    }

    /// Runs `store` on the target's address, after its checks.
    fn store_at(&mut self, target: Target, store: impl FnOnce(&mut Self, Address)) {
        let guard = self.begin_guard(target.checks, Substitute::None);
        let TargetKind::Memory { addr, .. } = target.kind else { unreachable!("instances are in memory") };
        store(self, addr);
        self.end_guard(guard);
    }

    // System functions.

    fn call_system_function(&mut self, callee: &CodeBlock, arguments: &[Argument]) {
        let structure = self.temporary(callee.interface.bytes.max(2));
        self.b.clear(structure, callee.interface.bytes);
        let base = structure.offset;
        for argument in arguments {
            let parameter = &callee.interface.parameters[argument.parameter];
            if parameter.direction != Direction::Output || !is_value(parameter.passing) {
                let db = self.get(self.regs.db);
                self.structure_in(parameter, &argument.actual, base);
                self.set(self.regs.db, db);
            }
        }
        self.run_system_function(callee, structure);
        for argument in arguments {
            let parameter = &callee.interface.parameters[argument.parameter];
            if parameter.direction != Direction::Input {
                self.structure_out(parameter, &argument.actual, base);
            }
        }
    }

    /// Calls the runtime for a system function whose parameters are in `structure`; its BR is the block's.
    pub fn run_system_function(&mut self, callee: &CodeBlock, structure: Address) {
        if callee.kind == BlockKind::Sfc && callee.number == TIME_TCK {
            let now = self.b.call_runtime(RuntimeFn::TimeTck, &[]).expect("time_tck has a result");
            self.b.store(structure, now);
            let good = self.b.bool_const(true);
            return self.set(self.regs.br, good);
        }
        let site = self.b.i32_const(self.site);
        let number = self.b.i32_const(u32::from(callee.number));
        let block = self.b.address_of(structure);
        let frame = self.b.frame_base(false);
        let answer = self
            .b
            .call_runtime(RuntimeFn::SystemFunction, &[site, number, block, frame])
            .expect("system_function has a result");
        let stop = self.b.binary_imm(BinaryOp::And, answer, 2);
        self.stop_check(stop);
        let br = self.b.trunc(Type::I1, answer);
        self.set(self.regs.br, br);
    }

    fn structure_in(&mut self, parameter: &Parameter, actual: &Actual, base: u32) {
        let addr = Address::direct(Region::L, base + parameter.byte);
        match (parameter.passing, actual) {
            (Passing::Elementary(width), Actual::Place(place)) => {
                let value = self.read(place, width);
                self.write_target(Target::at(addr, BitNumber::Known(parameter.bit)), width, value);
            }
            (Passing::Elementary(Width::Bit), Actual::Const(bytes)) => {
                let value = self.b.bool_const(big_endian(bytes) != 0);
                self.b.store_bit(addr, parameter.bit, value);
            }
            (Passing::Elementary(_) | Passing::Complex { .. }, Actual::Const(bytes)) => self.store_bytes(addr, bytes),
            (Passing::Complex { bytes }, Actual::Place(place)) => {
                self.copy_block(place, Target::at(addr, BitNumber::Known(0)), bytes, true);
            }
            (Passing::Number, Actual::Number(number)) => {
                let value = self.number(number);
                self.store_low(addr, Width::Word, value);
            }
            (Passing::Pointer | Passing::Any | Passing::Variant, actual) => {
                self.store_pointer(addr, actual, parameter.passing != Passing::Pointer);
            }
            (Passing::Elementary(_) | Passing::Complex { .. } | Passing::Number | Passing::OpenArray { .. }, _) => {
                unreachable!("the binder gives each formal an actual of its kind")
            }
        }
    }

    fn structure_out(&mut self, parameter: &Parameter, actual: &Actual, base: u32) {
        let Actual::Place(place) = actual else { return };
        let addr = Address::direct(Region::L, base + parameter.byte);
        match parameter.passing {
            Passing::Elementary(width) => {
                let value = self.read_target(Target::at(addr, BitNumber::Known(parameter.bit)), width);
                let db = self.get(self.regs.db);
                self.write(place, width, value);
                self.set(self.regs.db, db);
            }
            Passing::Complex { bytes } => self.copy_block(place, Target::at(addr, BitNumber::Known(0)), bytes, false),
            Passing::Number | Passing::Pointer | Passing::Any | Passing::Variant | Passing::OpenArray { .. } => {}
        }
    }

    // The call itself.

    /// Calls a block of the program with the current registers, and takes over those that it returns.
    pub fn call_function(&mut self, callee: &CodeBlock, function: FuncId, references: Vec<Value>) {
        let plan = self.plan;
        let mut arguments: Vec<Value> =
            plan.registers.iter().map(|&register| self.b.use_var(self.regs.var(register))).collect();
        arguments.extend(references);
        let depth = self.enter_call(callee);
        let returned = self.b.call(function, arguments, &plan.function_returns(callee));
        self.leave_call(depth);
        let keeps_ar2 = !plan.changes_ar2(callee.key());
        for (register, value) in plan.returned_registers().zip(returned) {
            if !(keeps_ar2 && register == CpuRegister::Ar2) {
                self.set(self.regs.var(register), value);
            }
        }
        self.safepoint();
    }

    /// Counts the block depth and the local data if they are not bounded at compile time. Returns the depth before.
    fn enter_call(&mut self, callee: &CodeBlock) -> Option<Value> {
        if !self.plan.checks_depth {
            return None;
        }
        let depth = self.count_depth();
        let frame = self.b.frame_base(true);
        let end = self.b.binary_imm(BinaryOp::Iadd, frame, i64::from(self.plan.frame_estimate(callee.key())));
        let limit = self.b.load_state(state::L_END);
        let ok = self.b.icmp(IntCc::Ule, end, limit);
        self.stop_unless(ok, stop::LOCAL_DATA);
        Some(depth)
    }

    /// Goes one block deeper, or to STOP. Returns the depth before.
    fn count_depth(&mut self) -> Value {
        let depth = self.b.load_state(state::DEPTH);
        let depth_max = self.b.load_state(state::DEPTH_MAX);
        let ok = self.b.icmp(IntCc::Ult, depth, depth_max);
        self.stop_unless(ok, stop::BLOCK_DEPTH);
        let deeper = self.b.binary_imm(BinaryOp::Iadd, depth, 1);
        self.b.store_state(state::DEPTH, deeper);
        depth
    }

    fn leave_call(&mut self, depth: Option<Value>) {
        if let Some(depth) = depth {
            self.b.store_state(state::DEPTH, depth);
        }
    }

    /// `UC` of an FC or FB: no parameters. An FB has its instance in the current DI, at the current AR2.
    pub fn call_as_it_stands(&mut self, target: BlockKey) {
        let plan = self.plan;
        let Some((callee, Some(function))) = plan.block(target) else {
            unreachable!("the binder only passes calls of known blocks");
        };
        let (db, di) = (self.get(self.regs.db), self.get(self.regs.di));
        let ar2 = self.get(self.regs.ar[1]);
        let check = instance_check(&mut self.b, callee, di, ar2);
        let guard = self.begin_guard(check.into_iter().collect(), Substitute::None);
        let mut references = Vec::new();
        if plan::takes_references(callee) {
            for parameter in &callee.interface.parameters {
                self.no_argument(parameter, &mut references);
            }
            references.extend(plan.pointed(target).iter().map(|_| self.b.i32_const(0)));
        }
        self.call_function(callee, function, references);
        self.set(self.regs.db, db);
        self.set(self.regs.di, di);
        self.end_guard(guard);
    }

    /// Calls the FC or FB whose number is only known at run time. Registers are passed in the CPU state.
    pub fn call_by_number(&mut self, kind: BlockKind, number: Value) {
        let plan = self.plan;
        for &register in &plan.registers {
            let value = self.get(self.regs.var(register));
            let value = self.b.zext(Type::I32, value);
            self.b.store_state(register.slot(), value);
        }
        let depth = self.count_depth();
        let site = self.b.i32_const(self.site);
        self.b.store_state(state::SITE, site);
        let kind = self.b.i32_const(kind as u32);
        let (callee_frame, frame) = (self.b.frame_base(true), self.b.frame_base(false));
        let stop = self
            .b
            .call_runtime(RuntimeFn::CallBlock, &[site, kind, number, callee_frame, frame])
            .expect("call_block has a result");
        self.b.store_state(state::DEPTH, depth);
        self.stop_check(stop);
        for register in plan.returned_registers() {
            let value = self.b.load_state(register.slot());
            let value = self.b.trunc(plan::register_type(register), value);
            self.set(self.regs.var(register), value);
        }
        self.safepoint();
    }
}

/// DB `di` is long enough for the instance of `callee` at `ar2`, which its code relies on; `None` if it has no instance.
pub fn instance_check(b: &mut FunctionBuilder, callee: &CodeBlock, di: Value, ar2: Value) -> Option<Check> {
    if !matches!(callee.kind, BlockKind::Fb | BlockKind::Sfb) || callee.interface.bytes == 0 {
        return None;
    }
    let length = b.db_length(di);
    let bits = b.binary_imm(BinaryOp::And, ar2, 0x00FF_FFFF);
    let byte = b.binary_imm(BinaryOp::Lshr, bits, 3);
    let end = b.binary_imm(BinaryOp::Iadd, byte, i64::from(callee.interface.bytes));
    let long_enough = b.icmp(IntCc::Ule, end, length);
    let bit = b.binary_imm(BinaryOp::And, ar2, 7);
    let aligned = b.icmp_imm(IntCc::Eq, bit, 0);
    let ok = b.and(long_enough, aligned);
    let open = b.icmp_imm(IntCc::Ne, di, 0);
    let (short, none) = (b.i32_const(sync::LENGTH_READ.into()), b.i32_const(sync::DI_NUMBER.into()));
    let code = b.select(open, short, none);
    let info = b.select(open, byte, di);
    let access = b.i32_const(u32::from(plcc_abi::codes::access_area::DI));
    Some(Check { ok, code, access, info })
}

fn access_direction(direction: Direction) -> place::Direction {
    match direction {
        Direction::Input => place::Direction::Read,
        Direction::Output | Direction::InOut => place::Direction::Write,
    }
}

/// True for actuals whose area pointer means the same in the block that is called: not for static data and formal parameters of the
/// caller.
pub fn has_area_pointer(place: &Place) -> bool {
    match place {
        Place::I { .. }
        | Place::Q { .. }
        | Place::M { .. }
        | Place::Pi { .. }
        | Place::Pq { .. }
        | Place::L { .. }
        | Place::OpenDb { .. }
        | Place::Db { .. } => true,
        Place::OpenDi { .. }
        | Place::Instance { .. }
        | Place::Parameter { .. }
        | Place::ThroughPointer { .. }
        | Place::Indirect { .. }
        | Place::Register { .. } => false,
    }
}

/// True for parameters that are copied by value; numbers and pointers are only passed in.
fn is_value(passing: Passing) -> bool {
    matches!(passing, Passing::Elementary(_) | Passing::Complex { .. })
}

/// True for a complex IN_OUT of an FB: a POINTER in the instance.
fn is_reference(parameter: &Parameter) -> bool {
    matches!(parameter.passing, Passing::Complex { .. }) && parameter.direction == Direction::InOut
}

/// Value of at most four big-endian bytes.
fn big_endian(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0, |value, &byte| value << 8 | u32::from(byte))
}
