//! The effects of instructions, on a small memory.

use std::cell::RefCell;

use super::*;
use crate::parse::parse_module;

/// Memory up to the end of the first DBs. `s7200_counter` calls function 1 again, if there is an interpreter.
struct Memory<'a> {
    bytes: RefCell<Vec<u8>>,
    interpreter: Option<&'a Interpreter>,
}

impl Memory<'_> {
    fn new() -> Memory<'static> {
        Memory { bytes: RefCell::new(vec![0; layout::DB_DATA as usize + 256]), interpreter: None }
    }
}

impl Host for Memory<'_> {
    fn read(&self, offset: u32, buf: &mut [u8]) {
        buf.copy_from_slice(&self.bytes.borrow()[offset as usize..][..buf.len()]);
    }

    fn write(&self, offset: u32, bytes: &[u8]) {
        self.bytes.borrow_mut()[offset as usize..][..bytes.len()].copy_from_slice(bytes);
    }

    fn call_runtime(&self, function: RuntimeFn, args: &[u64]) -> u64 {
        match (function, self.interpreter) {
            (RuntimeFn::S7200Counter, Some(interpreter)) => {
                interpreter.call(self, FuncId::new(1), args, layout::L, layout::L)[0]
            }
            _ => u64::MAX,
        }
    }
}

fn run(text: &str, args: &[u64]) -> Vec<u64> {
    let module = parse_module(text).expect("text is well formed");
    crate::verify::verify(&module).expect("rules are kept");
    let interpreter = Interpreter::new(&module);
    let memory = Memory { interpreter: Some(&interpreter), ..Memory::new() };
    interpreter.call(&memory, FuncId::new(0), args, layout::L, layout::L)
}

#[test]
fn memory_is_big_endian_and_state_is_not() {
    let text = "func @F -> i8, i8, i1, i1, i32 {
        b0(v0: i32):
        store.i32 M 4, v0
        store.i32 state 8, v0
        v1 = load.i8 M 4
        v2 = load.i8 state 8
        v3 = const.i1 1
        store.bit M 7.7, v3
        v4 = load.bit M 7.7
        v5 = load.bit M 7.6
        v6 = load.i32 M 4
        ret v1, v2, v4, v5, v6
        }";
    let state = u64::from(0x1234_5678_u32.to_ne_bytes()[0]);
    assert_eq!(run(text, &[0x1234_5678]), [0x12, state, 1, 1, 0x1234_56F8]);
}

#[test]
fn parameters_of_blocks_change_at_once() {
    let text = "func @F -> i32, i32 {
        b0(v0: i32, v1: i32):
        v2 = const.i32 3
        jump b1(v0, v1, v2)
        b1(v3: i32, v4: i32, v5: i32):
        v6 = const.i32 1
        v7 = isub v5, v6
        v8 = const.i32 0
        v9 = eq v7, v8
        branch v9, b2, b1(v4, v3, v7)
        b2:
        ret v3, v4
        }";
    assert_eq!(run(text, &[10, 20]), [10, 20]);
}

#[test]
fn instructions_are_counted_without_constants() {
    let text = "func @F {
        b0:
        call @G()
        ret
        }
        func @G {
        b0:
        v0 = const.i32 3
        jump b1
        b1:
        ret
        }";
    let interpreter = Interpreter::new(&parse_module(text).expect("text is well formed"));
    for total in [4, 8] {
        interpreter.call(&Memory::new(), FuncId::new(0), &[], layout::L, layout::L);
        assert_eq!(interpreter.executed(), total);
    }
}

#[test]
fn callees_see_the_frame_of_the_caller() {
    let text = "func @F -> i16, i32, i32 frame 16 {
        b0(v0: i16):
        store.i16 L 2, v0
        v1 = frame_base
        v2, v3 = call @G()
        v4 = callee_frame_base
        v5 = isub v4, v1
        v6 = isub v3, v4
        ret v2, v5, v6
        }
        func @G -> i16, i32 {
        b0:
        v1 = load.i16 V 2
        v2 = frame_base
        ret v1, v2
        }";
    assert_eq!(run(text, &[77]), [77, 16, 0]);
}

#[test]
fn runtime_functions_may_come_back() {
    let text = "func @F -> i32 {
        b0(v0: i32):
        v1 = rt @s7200_counter(v0)
        v2 = rt @s7200_counter(v1)
        v3 = iadd v2, v0
        ret v3
        }
        func @G -> i32 {
        b0(v0: i32):
        v1 = const.i32 100
        v2 = iadd v0, v1
        ret v2
        }";
    assert_eq!(run(text, &[5]), [210]);
}

#[test]
fn deep_calls_take_no_stack_of_the_host() {
    let text = "func @F -> i32 {
        b0(v0: i32):
        v1 = const.i32 0
        v2 = eq v0, v1
        branch v2, b1, b2
        b1:
        ret v1
        b2:
        v3 = const.i32 1
        v4 = isub v0, v3
        v5 = call @F(v4)
        v6 = iadd v5, v3
        ret v6
        }";
    assert_eq!(run(text, &[100_000]), [100_000]);
}

#[test]
fn switch_goes_to_the_default_beyond_its_targets() {
    let text = "func @F -> i32 {
        b0(v0: i32):
        v1 = const.i32 7
        v2 = const.i32 8
        switch v0 [b1(v1), b1(v2)], b1(v0)
        b1(v3: i32):
        ret v3
        }";
    assert_eq!([0, 1, 2, 0xFFFF_FFFF].map(|value| run(text, &[value])[0]), [7, 8, 2, 0xFFFF_FFFF]);
}

#[test]
fn copies_may_overlap_and_clears_stop_in_time() {
    let text = "func @F -> i32, i32 {
        b0(v0: i32):
        store.i32 M 0, v0
        copy M 1, M 0, 4
        v1 = load.i32 M 0
        clear M 2, 2
        v2 = load.i32 M 1
        ret v1, v2
        }";
    assert_eq!(run(text, &[0x1122_3344]), [0x1111_2233, 0x1100_0044]);
}

#[test]
fn the_db_table_is_read() {
    let text = "db 10 at 0x400000 length 20
        func @F -> i32, i32, i16 {
        b0(v0: i32):
        v1 = db_base v0
        v2 = db_length v0
        v3 = load.i16 DB10 2
        ret v1, v2, v3
        }";
    let module = parse_module(text).expect("text is well formed");
    let memory = Memory::new();
    memory.write(layout::db_table_entry(10), &layout::DB_DATA.to_ne_bytes());
    memory.write(layout::db_table_entry(10) + 4, &20u32.to_ne_bytes());
    memory.write(layout::DB_DATA + 2, &[1, 2]);
    let returned = Interpreter::new(&module).call(&memory, FuncId::new(0), &[10], layout::L, layout::L);
    assert_eq!(returned, [u64::from(layout::DB_DATA), 20, 0x0102]);
}
