//! The reference execution of the IR.
//!
//! The interpreter defines the meaning of instructions; machine code must agree bit for bit. The interpreter is prepared
//! once: every value gets a register, every address is resolved as far as it is known. Memory and runtime functions are
//! behind [`Host`].
//!
//! A call inside the IR takes a new window of one register stack, never the stack of the host. A runtime function may come
//! back into the interpreter through its host; that takes a fresh register stack.

mod prepare;

use std::cell::{Cell, RefCell};

use plcc_abi::{RuntimeFn, Type, layout};

use crate::entities::{Entity, FuncId};
use crate::eval;
use crate::module::Module;
use prepare::{Base, Code, List, Op, Place};

/// The environment of the interpreted program.
pub trait Host {
    /// Reads the bytes at `offset` from the memory base.
    fn read(&self, offset: u32, buf: &mut [u8]);
    /// Writes the bytes at `offset` from the memory base.
    fn write(&self, offset: u32, bytes: &[u8]);
    /// Calls a runtime function. Arguments and result are bit patterns, zero-extended; 0 if it has no result. It may call the
    /// interpreter again.
    fn call_runtime(&self, function: RuntimeFn, args: &[u64]) -> u64;
}

/// A module made ready to run.
pub struct Interpreter {
    functions: Vec<Code>,
    /// Register stacks that are not in use.
    stacks: RefCell<Vec<Vec<u64>>>,
    /// Instructions that ran.
    executed: Cell<u64>,
}

impl Interpreter {
    /// Prepares `module`, which the verifier has passed.
    pub fn new(module: &Module) -> Interpreter {
        let functions = module.functions.values().map(|function| prepare::prepare(module, function)).collect();
        Interpreter { functions, stacks: RefCell::default(), executed: Cell::default() }
    }

    /// Runs `func` with the bit patterns `args`; returns those that it returns. `lbase` is where its frame begins and
    /// `vbase` where its caller's does, as offsets from the memory base.
    pub fn call(&self, host: &dyn Host, func: FuncId, args: &[u64], lbase: u32, vbase: u32) -> Vec<u64> {
        let mut stack = self.stacks.borrow_mut().pop().unwrap_or_default();
        let returned = self.run(host, &mut stack, func.index(), args, lbase, vbase);
        self.stacks.borrow_mut().push(stack);
        returned
    }

    /// Instructions that have run so far, without constants, which machine code has in the instructions that use them: a measure of time that
    /// depends on no machine.
    pub fn executed(&self) -> u64 {
        self.executed.get()
    }

    fn run(
        &self,
        host: &dyn Host,
        stack: &mut Vec<u64>,
        func: usize,
        args: &[u64],
        lbase: u32,
        vbase: u32,
    ) -> Vec<u64> {
        let mut callers: Vec<Frame> = Vec::new();
        let mut frame = Frame { func, pc: 0, window: 0, lbase, vbase };
        reserve(stack, &self.functions[func], 0);
        for (&register, &arg) in self.functions[func].params.iter().zip(args) {
            stack[register as usize] = arg;
        }
        loop {
            let code = &self.functions[frame.func];
            let registers = &mut stack[frame.window..frame.window + code.registers];
            let (exit, executed) = execute(code, &mut frame, registers, host);
            self.executed.set(self.executed.get() + executed);
            match exit {
                Exit::Call { callee, args } => {
                    let window = frame.window + code.registers;
                    let target = &self.functions[callee];
                    reserve(stack, target, window);
                    for (&param, &arg) in target.params.iter().zip(code.list(args)) {
                        stack[window + param as usize] = stack[frame.window + arg as usize];
                    }
                    let lbase = frame.lbase.wrapping_add(code.frame_bytes);
                    let called = Frame { func: callee, pc: 0, window, lbase, vbase: frame.lbase };
                    callers.push(std::mem::replace(&mut frame, called));
                }
                Exit::Return { values } => {
                    let Some(caller) = callers.pop() else {
                        return code.list(values).iter().map(|&value| registers[value as usize]).collect();
                    };
                    let returning = std::mem::replace(&mut frame, caller);
                    let code_of_caller = &self.functions[frame.func];
                    let Op::Call { results, .. } = code_of_caller.ops[frame.pc] else {
                        unreachable!("a caller waits at its call")
                    };
                    for (&result, &value) in code_of_caller.list(results).iter().zip(code.list(values)) {
                        stack[frame.window + result as usize] = stack[returning.window + value as usize];
                    }
                    frame.pc += 1;
                }
            }
        }
    }
}

fn reserve(stack: &mut Vec<u64>, code: &Code, window: usize) {
    let needed = window + code.registers;
    if stack.len() < needed {
        stack.resize(needed, 0);
    }
}

/// A function that runs or waits for one that it called.
struct Frame {
    func: usize,
    /// Index into its operations; of a waiting function, that of the call.
    pc: usize,
    /// Where its registers begin in the register stack.
    window: usize,
    lbase: u32,
    vbase: u32,
}

/// Why the operations of a function do not continue.
enum Exit {
    Call { callee: usize, args: List },
    Return { values: List },
}

/// Runs until the function calls another or returns; also returns the number of instructions.
fn execute(code: &Code, frame: &mut Frame, r: &mut [u64], host: &dyn Host) -> (Exit, u64) {
    let (lbase, vbase) = (frame.lbase, frame.vbase);
    let address = |r: &[u64], place: &Place| -> u32 {
        let start = match place.base {
            Base::Memory => place.offset,
            Base::Frame => lbase.wrapping_add(place.offset),
            Base::CallerFrame => vbase.wrapping_add(place.offset),
        };
        match place.register {
            None => start,
            Some(register) => start.wrapping_add(r[register as usize] as u32),
        }
    };
    let mut pc = frame.pc;
    let mut executed = 0;
    loop {
        executed += 1;
        match &code.ops[pc] {
            Op::Const { dst, bits } => {
                executed -= 1;
                r[*dst as usize] = *bits;
            }
            Op::Unary { op, ty, dst, arg } => {
                r[*dst as usize] = eval::mask(*ty, eval::unary(*op, *ty, r[*arg as usize]));
            }
            Op::Binary { op, ty, dst, args } => {
                r[*dst as usize] = eval::binary(*op, *ty, r[args[0] as usize], r[args[1] as usize])
                    .expect("code that builds a division guards it");
            }
            Op::IntCompare { cc, ty, dst, args } => {
                r[*dst as usize] = u64::from(eval::int_compare(*cc, *ty, r[args[0] as usize], r[args[1] as usize]));
            }
            Op::FloatCompare { cc, ty, dst, args } => {
                r[*dst as usize] = u64::from(eval::float_compare(*cc, *ty, r[args[0] as usize], r[args[1] as usize]));
            }
            Op::Convert { op, from, to, dst, arg } => {
                r[*dst as usize] = eval::convert(*op, *from, *to, r[*arg as usize]);
            }
            Op::Select { dst, cond, if_true, if_false } => {
                let chosen = if r[*cond as usize] != 0 { *if_true } else { *if_false };
                r[*dst as usize] = r[chosen as usize];
            }
            Op::Load { dst, ty, place } => {
                let mut bytes = [0; 8];
                let bytes = &mut bytes[..ty.bytes() as usize];
                host.read(address(r, place), bytes);
                r[*dst as usize] = from_bytes(bytes, place.host_order);
            }
            Op::Store { ty, place, value } => {
                let (bytes, len) = (to_bytes(r[*value as usize], *ty, place.host_order), ty.bytes() as usize);
                host.write(address(r, place), &bytes[..len]);
            }
            Op::LoadBit { dst, place, bit } => {
                let mut byte = [0];
                host.read(address(r, place), &mut byte);
                r[*dst as usize] = u64::from(byte[0] >> bit & 1);
            }
            Op::StoreBit { place, bit, value } => {
                let at = address(r, place);
                let mut byte = [0];
                host.read(at, &mut byte);
                byte[0] = byte[0] & !(1 << bit) | ((r[*value as usize] as u8 & 1) << bit);
                host.write(at, &byte);
            }
            Op::AddressOf { dst, place } => r[*dst as usize] = u64::from(address(r, place)),
            Op::Clear { place, len } => clear(host, address(r, place), *len),
            Op::Copy { to, from, len } => {
                let mut bytes = vec![0; *len as usize];
                host.read(address(r, from), &mut bytes);
                host.write(address(r, to), &bytes);
            }
            Op::DbEntry { dst, number, field } => {
                let mut bytes = [0; 4];
                host.read(layout::db_table_entry(r[*number as usize] as u16) + field, &mut bytes);
                r[*dst as usize] = u64::from(u32::from_ne_bytes(bytes));
            }
            Op::FrameBase { dst, offset } => r[*dst as usize] = u64::from(lbase.wrapping_add(*offset)),
            Op::CallRuntime { function, args, dst } => {
                let args = code.list(*args);
                // No runtime function has more parameters than this.
                let mut values = [0; 8];
                let values = &mut values[..args.len()];
                for (value, &arg) in values.iter_mut().zip(args) {
                    *value = r[arg as usize];
                }
                let result = host.call_runtime(*function, values);
                if let Some((dst, ty)) = dst {
                    r[*dst as usize] = eval::mask(*ty, result);
                }
            }
            Op::Call { callee, args, .. } => {
                frame.pc = pc;
                return (Exit::Call { callee: *callee as usize, args: *args }, executed);
            }
            Op::Jump { edge } => {
                pc = code.follow(*edge, r);
                continue;
            }
            Op::Branch { cond, then_to, else_to } => {
                let edge = if r[*cond as usize] != 0 { *then_to } else { *else_to };
                pc = code.follow(edge, r);
                continue;
            }
            Op::Switch { value, first, count } => {
                let chosen = (r[*value as usize] as u32).min(*count);
                pc = code.follow(first + chosen, r);
                continue;
            }
            Op::Return { values } => return (Exit::Return { values: *values }, executed),
        }
        pc += 1;
    }
}

fn clear(host: &dyn Host, at: u32, len: u32) {
    const ZEROS: [u8; 256] = [0; 256];
    let mut done = 0;
    while done < len {
        let step = (len - done).min(ZEROS.len() as u32);
        host.write(at.wrapping_add(done), &ZEROS[..step as usize]);
        done += step;
    }
}

fn from_bytes(bytes: &[u8], host_order: bool) -> u64 {
    let big_endian = !host_order || cfg!(target_endian = "big");
    let join = |value: u64, &byte: &u8| value << 8 | u64::from(byte);
    if big_endian { bytes.iter().fold(0, join) } else { bytes.iter().rev().fold(0, join) }
}

/// The bytes of a value of type `ty`, from the front.
fn to_bytes(value: u64, ty: Type, host_order: bool) -> [u8; 8] {
    if host_order && cfg!(target_endian = "little") {
        value.to_le_bytes()
    } else {
        (value << (64 - 8 * ty.bytes())).to_be_bytes()
    }
}

#[cfg(test)]
mod tests;
