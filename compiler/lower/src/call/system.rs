//! Calls of system functions: a structure of parameters in the caller's frame.

use plcc_abi::RuntimeFn;
use plcc_abi::image::BlockKind;
use plcc_abi::layout::state;
use plcc_ir::{Address, BinaryOp, IntCc, Region, Type, Value};
use plcc_model::{Actual, Argument, CodeBlock, Direction, Parameter, Passing, Width};

use super::{big_endian, is_block_move, is_value};
use crate::block::BlockLowering;
use crate::place::{BitNumber, Target};

/// The SFC with a separate runtime function: timers use it in every call.
const TIME_TCK: u16 = 64;

impl BlockLowering<'_, '_> {
    /// Calls a system function that the runtime implements.
    pub(super) fn call_system_function(&mut self, callee: &CodeBlock, arguments: &[Argument]) {
        let structure = self.temporary(callee.interface.bytes.max(2));
        let base = structure.offset;
        let known = is_block_move(callee).then(|| self.block_move_pointers(arguments)).flatten();
        if !known.is_some_and(|(source, to)| self.known_block_move(callee, structure, source, to)) {
            self.b.clear(structure, callee.interface.bytes);
            for argument in arguments {
                let parameter = &callee.interface.parameters[argument.parameter];
                if parameter.direction != Direction::Output || !is_value(parameter.passing) {
                    let db = self.get(self.regs.db);
                    self.structure_in(parameter, &argument.actual, base);
                    self.set(self.regs.db, db);
                }
            }
            self.run_system_function(callee, structure);
        }
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
            let now = self.ticks();
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

    /// Milliseconds since the start, 31 bits of them: from the CPU state, if the clock is virtual.
    fn ticks(&mut self) -> Value {
        let shown = self.b.load_state(state::TICKS);
        let asks = self.b.icmp_imm(IntCc::Slt, shown, 0);
        let (ask, after) = (self.b.create_cold_block(), self.b.create_block());
        self.b.def_var(self.result, shown);
        self.b.branch(asks, ask, after);
        self.b.seal_block(ask);
        self.b.switch_to(ask);
        let now = self.b.call_runtime(RuntimeFn::TimeTck, &[]).expect("time_tck has a result");
        self.b.def_var(self.result, now);
        self.b.jump(after, &[]);
        self.b.seal_block(after);
        self.b.switch_to(after);
        self.b.use_var(self.result)
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
}
