//! Loads, stores, bits, clearing and copying.

use plcc_abi::{Type, layout};
use plcc_ir::{Address, FunctionBuilder, IntCc, Region, Value};

use crate::harness::{self, DB, LBASE, VBASE, patterned_memory, read_state, run};

const RESULT: u32 = 0x400;

/// Each region with where it begins.
const REGIONS: [(Region, u32); 7] = [
    (Region::State, layout::STATE + 0x800),
    (Region::I, layout::I),
    (Region::Q, layout::Q),
    (Region::M, layout::M),
    (Region::L, LBASE),
    (Region::V, VBASE),
    (Region::Db(DB.number), DB.address),
];

fn region_offset(region: Region) -> u32 {
    if region == Region::State { 0x800 } else { 0 }
}

fn result(slot: u32) -> Address {
    Address::direct(Region::State, RESULT + 8 * slot)
}

/// A value that the compiler does not know.
fn unknown(b: &mut FunctionBuilder, value: u32) -> Value {
    let zero = b.load(Type::I32, Address::direct(Region::State, 0x3F0));
    let value = b.i32_const(value);
    b.iadd(zero, value)
}

#[test]
fn loads_of_every_width() {
    for (region, start) in REGIONS {
        for ty in [Type::I8, Type::I16, Type::I32, Type::I64, Type::F32, Type::F64] {
            for indexed in [false, true] {
                let module = harness::entry(|b| {
                    let at = region_offset(region);
                    let addr = if indexed {
                        Address::indexed(region, unknown(b, 3), at + 2)
                    } else {
                        Address::direct(region, at + 5)
                    };
                    let value = b.load(ty, addr);
                    b.store(result(0), value);
                });
                let memory = run(&module);
                let width = ty.bytes() as usize;
                let at = start as usize + 5;
                let mut bytes = patterned_memory()[at..at + width].to_vec();
                if region != Region::State {
                    bytes.reverse();
                }
                assert_eq!(memory[RESULT as usize..RESULT as usize + width], bytes, "{region:?} {}", ty.name());
            }
        }
    }
}

#[test]
fn stores_of_every_width() {
    let bits = 0x0123_4567_89AB_CDEFu64;
    for (region, start) in REGIONS {
        for ty in [Type::I8, Type::I16, Type::I32, Type::I64, Type::F32, Type::F64] {
            for constant in [false, true] {
                let module = harness::entry(|b| {
                    let low = if constant { b.iconst(Type::I64, bits as i64) } else { b.load(Type::I64, result(0)) };
                    let value = match ty {
                        Type::F32 => {
                            let word = b.trunc(Type::I32, low);
                            b.bitcast(ty, word)
                        }
                        Type::F64 => b.bitcast(ty, low),
                        _ => b.trunc(ty, low),
                    };
                    b.store(Address::direct(region, region_offset(region) + 3), value);
                });
                for options in harness::LEVELS {
                    let mut expected = patterned_memory();
                    expected[RESULT as usize..RESULT as usize + 8].copy_from_slice(&bits.to_le_bytes());
                    let mut memory = expected.clone();
                    harness::run_on(&module, 0, &options, &mut memory);
                    let width = ty.bytes() as usize;
                    let mut bytes = bits.to_le_bytes()[..width].to_vec();
                    if region != Region::State {
                        bytes.reverse();
                    }
                    expected[start as usize + 3..start as usize + 3 + width].copy_from_slice(&bytes);
                    assert!(memory == expected, "{region:?} {}", ty.name());
                }
            }
        }
    }
}

#[test]
fn bits_are_read_written_and_combined() {
    for from in 0..8 {
        for to in 0..8 {
            let module = harness::entry(|b| {
                let x = b.load_bit(Address::direct(Region::I, 9), from);
                let y = b.load_bit(Address::direct(Region::M, 77), to);
                let and = b.and(x, y);
                let or = b.or(x, y);
                let xor = b.xor(x, y);
                let not = b.not(y);
                let nand = b.not(and);
                let select = b.select(not, and, or);
                let values = [x, y, and, or, xor, not, nand, select];
                for (slot, value) in (0u32..).zip(values) {
                    b.store_bit(Address::direct(Region::Q, 20 + slot), to, value);
                    let wide = b.zext(Type::I32, value);
                    b.store(result(slot), wide);
                }
                let one = b.bool_const(true);
                let zero = b.bool_const(false);
                b.store_bit(Address::direct(Region::Q, 30), to, one);
                b.store_bit(Address::direct(Region::Q, 31), to, zero);
            });
            let memory = run(&module);
            let before = patterned_memory();
            let bit = |area: u32, byte: u32, bit: u8| before[(area + byte) as usize] >> bit & 1 != 0;
            let (x, y) = (bit(layout::I, 9, from), bit(layout::M, 77, to));
            let values = [x, y, x && y, x || y, x != y, !y, !(x && y), if !y { x && y } else { x || y }, true, false];
            for (slot, value) in (0u32..).zip(values) {
                let byte = (layout::Q + if slot < 8 { 20 + slot } else { 22 + slot }) as usize;
                let expected = before[byte] & !(1 << to) | u8::from(value) << to;
                assert_eq!(memory[byte], expected, "value {slot}, from bit {from} to bit {to}");
                if slot < 8 {
                    assert_eq!(read_state(&memory, RESULT + 8 * slot, 4), u64::from(value), "value {slot}");
                }
            }
        }
    }
}

#[test]
fn branches_on_bits() {
    for bit in 0..8 {
        let module = harness::entry(|b| {
            for (slot, negated) in [(0, false), (1, true)] {
                let mut value = b.load_bit(Address::direct(Region::I, 33), bit);
                if negated {
                    value = b.not(value);
                }
                let (yes, no, join) = (b.create_block(), b.create_cold_block(), b.create_block());
                let param = b.append_param(join, Type::I32);
                b.branch(value, yes, no);
                for (block, number) in [(yes, 111), (no, 222)] {
                    b.seal_block(block);
                    b.switch_to(block);
                    let number = b.i32_const(number);
                    b.jump(join, &[number]);
                }
                b.seal_block(join);
                b.switch_to(join);
                b.store(result(slot), param);
            }
        });
        let memory = run(&module);
        let set = patterned_memory()[layout::I as usize + 33] >> bit & 1 != 0;
        assert_eq!(read_state(&memory, RESULT, 4), if set { 111 } else { 222 });
        assert_eq!(read_state(&memory, RESULT + 8, 4), if set { 222 } else { 111 });
    }
}

#[test]
fn clearing_every_size() {
    for len in (0..=140).chain([255, 256, 1000]) {
        for region in [Region::M, Region::L] {
            let module = harness::entry(|b| b.clear(Address::direct(region, 3), len));
            let memory = run(&module);
            let mut expected = patterned_memory();
            let start = if region == Region::M { layout::M } else { LBASE } as usize + 3;
            expected[start..start + len as usize].fill(0);
            assert!(memory == expected, "{len} bytes");
        }
    }
}

#[test]
fn copying_every_size_also_onto_itself() {
    for len in (0..=140).chain([255, 256, 600]) {
        for (from, to) in [(10u32, 700), (10, 11), (11, 10), (10, 17), (17, 10), (10, 10)] {
            let module = harness::entry(|b| {
                let base = unknown(b, to);
                b.copy(Address::indexed(Region::M, base, 0), Address::direct(Region::M, from), len);
            });
            let memory = run(&module);
            let mut expected = patterned_memory();
            let source = layout::M as usize + from as usize;
            expected.copy_within(source..source + len as usize, layout::M as usize + to as usize);
            assert!(memory == expected, "{len} bytes from {from} to {to}");
        }
    }
}

#[test]
fn offsets_of_addresses() {
    let module = harness::entry(|b| {
        for (slot, (region, _)) in (0u32..).zip(REGIONS) {
            let direct = b.address_of(Address::direct(region, 7));
            b.store(result(2 * slot), direct);
            let base = unknown(b, 100);
            let indexed = b.address_of(Address::indexed(region, base, 7));
            b.store(result(2 * slot + 1), indexed);
        }
        let own = b.frame_base(false);
        b.store(result(20), own);
        let callee = b.frame_base(true);
        b.store(result(21), callee);
        let number = unknown(b, u32::from(DB.number));
        let values = [b.db_base(number), b.db_length(number)];
        b.store(result(22), values[0]);
        b.store(result(23), values[1]);
        let number = b.i32_const(u32::from(DB.number));
        let values = [b.db_base(number), b.db_length(number)];
        b.store(result(24), values[0]);
        b.store(result(25), values[1]);
    });
    let memory = run(&module);
    let slot = |slot: u32| read_state(&memory, RESULT + 8 * slot, 4) as u32;
    for (index, (region, start)) in (0u32..).zip(REGIONS) {
        let start = if region == Region::State { 0 } else { start };
        assert_eq!(slot(2 * index), start + 7, "{region:?}");
        assert_eq!(slot(2 * index + 1), start + 107, "{region:?}");
    }
    assert_eq!((slot(20), slot(21)), (LBASE, LBASE + 64));
    assert_eq!([slot(22), slot(23), slot(24), slot(25)], [DB.address, DB.length, DB.address, DB.length]);
}

#[test]
fn pointers_meet_every_area() {
    // A store through a pointer changes the value of a direct load, and vice versa.
    let module = harness::entry(|b| {
        let direct = Address::direct(Region::M, 40);
        let before = b.load(Type::I32, direct);
        b.store(result(0), before);
        let pointer = unknown(b, layout::M + 40);
        let value = b.i32_const(0x1122_3344);
        b.store(Address::indexed(Region::Any, pointer, 0), value);
        let after = b.load(Type::I32, direct);
        b.store(result(1), after);
        let value = b.i32_const(0x5566_7788);
        b.store(direct, value);
        let through = b.load(Type::I32, Address::indexed(Region::Any, pointer, 0));
        b.store(result(2), through);
        let base = unknown(b, DB.address);
        let value = b.i32_const(0x99AA_BBCC);
        b.store(Address::indexed(Region::AnyDb, base, 4), value);
        let after = b.load(Type::I32, Address::direct(Region::Db(DB.number), 4));
        b.store(result(3), after);
    });
    let memory = run(&module);
    let slot = |slot: u32| read_state(&memory, RESULT + 8 * slot, 4) as u32;
    assert_eq!([slot(1), slot(2), slot(3)], [0x1122_3344, 0x5566_7788, 0x99AA_BBCC]);
}

/// Masks, selections and comparisons of what comes from memory, which need no byte swaps, and the same as numbers.
#[test]
fn words_combined_in_the_order_of_memory() {
    for ty in [Type::I16, Type::I32, Type::I64] {
        let width = ty.bytes() as usize;
        let number = |start: u32, at: usize| {
            let at = start as usize + at;
            patterned_memory()[at..at + width].iter().fold(0, |number, &byte| number << 8 | u64::from(byte))
        };
        let (x, y) = (number(layout::M, 0x11), number(DB.address, 0x21));
        let all = u64::MAX >> (64 - ty.bits());
        let mask = 0x1234_F00F_5678_0FF0 & all;
        for wanted in [x & mask, x & mask ^ 1] {
            let module = harness::entry(|b| {
                let first = b.load(ty, Address::direct(Region::M, 0x11));
                let index = unknown(b, 1);
                let second = b.load(ty, Address::indexed(Region::Db(DB.number), index, 0x20));
                let constant = b.iconst(ty, mask as i64);
                let masked = b.and(first, constant);
                let either = b.or(first, second);
                let mixed = b.xor(either, constant);
                let wanted = b.iconst(ty, wanted as i64);
                let hit = b.icmp(IntCc::Eq, masked, wanted);
                let chosen = b.select(hit, mixed, first);
                b.store(Address::direct(Region::Q, 3), chosen);
                b.store(result(0), chosen);
                let differs = b.icmp(IntCc::Ne, first, second);
                let sum = b.iadd(mixed, constant);
                let number = b.select(differs, sum, mixed);
                b.store(result(1), number);
                b.store(result(2), mixed);
            });
            let memory = run(&module);
            let mixed = (x | y) ^ mask;
            let chosen = if wanted == x & mask { mixed } else { x };
            let at = layout::Q as usize + 3;
            assert_eq!(memory[at..at + width], chosen.to_be_bytes()[8 - width..], "{}", ty.name());
            for (slot, value) in [(0, chosen), (1, mixed.wrapping_add(mask) & all), (2, mixed)] {
                let at = (RESULT + 8 * slot) as usize;
                assert_eq!(memory[at..at + width], value.to_le_bytes()[..width], "{} {slot}", ty.name());
            }
        }
    }
}
