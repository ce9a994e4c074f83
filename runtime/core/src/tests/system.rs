//! System functions through their parameter structures.

use plcc_abi::image::{DbEntry, Family};
use plcc_abi::layout::{self, state};

use super::helpers::{Block, cpu, cpu_with, run};
use crate::cpu::Cpu;
use crate::datetime;
use crate::diagnostics::NO_SITE;

/// Where the tests put parameters.
const AT: u32 = layout::SCRATCH;

/// Runs `body` as OB 1, once, with a DB 10 of 20 bytes.
fn in_ob1(body: impl Fn(&Cpu, u32) + 'static) {
    in_ob1_of(Family::S7300, body);
}

fn in_ob1_of(family: Family, body: impl Fn(&Cpu, u32) + 'static) {
    let block: Block = Box::new(body);
    let cpu = cpu_with(vec![(1, block)], |image| {
        image.profile.family = family;
        image.dbs.push(DbEntry {
            number: 10,
            name: String::new(),
            address: layout::DB_DATA,
            data: (0..20).collect(),
            read_only: false,
            unlinked: false,
            optimized: false,
            kept: Default::default(),
            ty: None,
        });
        image.db_end = layout::DB_DATA + 32;
    });
    run(&cpu, 1);
    assert!(!cpu.is_stopped());
}

fn any(code: u8, count: u16, db: u16, area: u8, byte: u32) -> [u8; 10] {
    let (count, db, pointer) = (count.to_be_bytes(), db.to_be_bytes(), (byte << 3).to_be_bytes());
    [0x10, code, count[0], count[1], db[0], db[1], area, pointer[1], pointer[2], pointer[3]]
}

/// Calls SFC 20 or 21; returns RET_VAL.
fn block_move(cpu: &Cpu, lbase: u32, number: u32, from: [u8; 10], to: [u8; 10]) -> u16 {
    cpu.memory.set_bytes(AT, from);
    cpu.memory.set_bytes(AT + 12, to);
    let br = cpu.system_function(0, number, AT, lbase);
    let value = cpu.memory.word(AT + 10);
    assert_eq!(br == 1, value & 0x8000 == 0);
    value
}

#[test]
fn blkmov_copies_the_shorter_length() {
    in_ob1(|cpu, lbase| {
        assert_eq!(block_move(cpu, lbase, 20, any(2, 4, 10, 0x84, 2), any(4, 10, 0, 0x83, 100)), 0);
        assert_eq!(cpu.memory.bytes::<5>(layout::M + 100), [2, 3, 4, 5, 0]);
        assert_eq!(block_move(cpu, lbase, 20, any(1, 16, 0, 0x83, 100), any(2, 2, 0, 0x87, 20)), 0);
        assert_eq!(cpu.memory.bytes::<3>(lbase + 20), [2, 3, 0]);
    });
}

#[test]
fn blkmov_errors() {
    in_ob1(|cpu, lbase| {
        let code = |from, to| block_move(cpu, lbase, 20, from, to);
        let good = any(2, 2, 0, 0x83, 0);
        assert_eq!(code(any(2, 2, 11, 0x84, 0), good), 0x813A);
        assert_eq!(code(good, any(2, 2, 0, 0x88, 0)), 0x8325);
        assert_eq!(code(any(0x17, 2, 0, 0x83, 0), good), 0x8124);
        assert_eq!(code([0; 10], good), 0x8101);
        assert_eq!(code(any(1, 7, 0, 0x83, 0), good), 0x8122);
        assert_eq!(code(any(2, 0, 0, 0x83, 0), good), 0, "NIL");
        assert_eq!(code(any(2, 10, 10, 0x84, 15), any(2, 10, 0, 0x83, 0)), 0x837F);
        assert_eq!(code(any(2, 10, 0, 0x83, 0), any(2, 10, 0, 0x83, 0xFFFF)), 0x837F);
    });
    in_ob1_of(Family::S7400, |cpu, lbase| {
        assert_eq!(block_move(cpu, lbase, 20, any(2, 10, 10, 0x84, 15), any(2, 10, 0, 0x83, 0)), 0x8122);
        assert_eq!(block_move(cpu, lbase, 20, any(2, 10, 0, 0x83, 0), any(2, 10, 10, 0x84, 15)), 0x8323);
    });
}

#[test]
fn fill_repeats_and_cuts() {
    in_ob1(|cpu, lbase| {
        assert_eq!(block_move(cpu, lbase, 21, any(2, 3, 10, 0x84, 1), any(2, 8, 0, 0x83, 0)), 0);
        assert_eq!(cpu.memory.bytes::<9>(layout::M), [1, 2, 3, 1, 2, 3, 1, 2, 0]);
    });
}

fn words(cpu: &Cpu, values: &[u16]) {
    for (index, &value) in (0u32..).zip(values) {
        cpu.memory.set_word(AT + 2 * index, value);
    }
}

#[test]
fn data_blocks_come_and_go() {
    in_ob1(|cpu, lbase| {
        let create = |low, high, count| {
            words(cpu, &[low, high, count]);
            cpu.system_function(0, 22, AT, lbase);
            (cpu.memory.word(AT + 6), cpu.memory.word(AT + 8))
        };
        assert_eq!(create(10, 12, 100), (0, 11));
        assert_eq!(create(10, 12, 50), (0, 12));
        assert_eq!(create(10, 12, 50), (0x80B1, 0));
        assert_eq!(create(0, 12, 50), (0x80A1, 0));
        assert_eq!(create(20, 30, 51), (0x80A2, 0));
        let delete = |number| {
            words(cpu, &[number]);
            cpu.system_function(0, 23, AT, lbase);
            cpu.memory.word(AT + 2)
        };
        cpu.memory.set_byte(cpu.memory.db(11).0, 0xFF);
        assert_eq!((delete(11), delete(11), delete(10)), (0, 0x80B1, 0x80B2));
        assert_eq!(create(11, 11, 90), (0, 11));
        assert_eq!(cpu.memory.byte(cpu.memory.db(11).0), 0, "contents are 0");
        let test = |number| {
            words(cpu, &[number]);
            cpu.system_function(0, 24, AT, lbase);
            (cpu.memory.word(AT + 2), cpu.memory.word(AT + 4))
        };
        assert_eq!((test(11), test(10), test(99)), ((0, 90), (0, 20), (0x80B1, 0)));
    });
}

#[test]
fn pool_is_finite() {
    in_ob1(|cpu, lbase| {
        let mut made = 0;
        loop {
            words(cpu, &[100, 60_000, 65_534]);
            cpu.system_function(0, 22, AT, lbase);
            match cpu.memory.word(AT + 6) {
                0 => made += 1,
                code => {
                    assert_eq!(code, 0x80B2);
                    break;
                }
            }
        }
        assert_eq!(made, 64);
    });
}

#[test]
fn clock_functions() {
    in_ob1(|cpu, lbase| {
        cpu.memory.set_bytes(AT, [0x20, 0x02, 0x29, 0x12, 0x30, 0, 0, 0]);
        assert_eq!(cpu.system_function(0, 0, AT, lbase), 1);
        cpu.pass_time(1_500_000_000, false);
        assert_eq!(cpu.system_function(0, 1, AT, lbase), 1);
        assert_eq!(cpu.memory.bytes::<8>(AT + 2), [0x20, 0x02, 0x29, 0x12, 0x30, 0x01, 0x50, 0x07]);
        assert_eq!(cpu.system_function(0, 64, AT, lbase), 1);
        assert_eq!(cpu.memory.dword(AT), 1500);
        cpu.memory.set_byte(AT + 1, 0x13);
        assert_eq!(cpu.system_function(0, 0, AT, lbase), 0);
        assert_eq!(cpu.memory.word(AT + 8), 0x8080);
    });
}

#[test]
fn delay_interrupt() {
    let ob1: Block = Box::new(|cpu, lbase| {
        if cpu.memory.byte(lbase + 1) == 1 {
            words(cpu, &[20, 0, 25, 0xABCD]);
            assert_eq!(cpu.system_function(0, 32, AT, lbase), 1);
            words(cpu, &[20]);
            cpu.system_function(0, 34, AT, lbase);
            assert_eq!(cpu.memory.word(AT + 4), 0b1_0100);
        }
    });
    let ob20: Block = Box::new(|cpu, lbase| {
        assert_eq!(cpu.clock.now(), 25_000_000);
        assert_eq!(cpu.memory.bytes::<12>(lbase), [0x11, 0x21, 3, 20, 0, 0, 0xAB, 0xCD, 0, 0, 0, 25]);
        cpu.memory.set_byte(layout::M, 1);
        words(cpu, &[20]);
        assert_eq!(cpu.system_function(0, 33, AT, lbase), 0);
        assert_eq!(cpu.memory.word(AT + 2), 0x80A0);
    });
    let cpu = cpu(vec![(1, ob1), (20, ob20)]);
    run(&cpu, 5);
    assert_eq!(cpu.memory.byte(layout::M), 1);
}

#[test]
fn time_of_day_interrupt_every_minute() {
    let ob100: Block = Box::new(|cpu, lbase| {
        words(cpu, &[10]);
        cpu.memory.set_bytes(AT + 2, datetime::encode(datetime::VIRTUAL_START + 60_000_000_000));
        cpu.memory.set_word(AT + 10, 0x0201);
        assert_eq!(cpu.system_function(0, 28, AT, lbase), 1);
        words(cpu, &[10]);
        assert_eq!(cpu.system_function(0, 30, AT, lbase), 1);
        words(cpu, &[11]);
        assert_eq!(cpu.system_function(0, 30, AT, lbase), 0);
        assert_eq!(cpu.memory.word(AT + 2), 0x80A0);
    });
    let ob10: Block = Box::new(|cpu, lbase| {
        assert_eq!(cpu.memory.bytes::<8>(lbase), [0x11, 0x11, 2, 10, 0, 0, 0x02, 0x01]);
        let count = cpu.memory.byte(layout::M) + 1;
        cpu.memory.set_byte(layout::M, count);
        assert_eq!(cpu.clock.now(), u64::from(count) * 60_000_000_000);
    });
    let cpu = cpu(vec![(100, ob100), (10, ob10)]);
    run(&cpu, 18_000);
    assert_eq!(cpu.memory.byte(layout::M), 3);
}

#[test]
fn interrupts_can_be_delayed_and_disabled() {
    let ob40: Block = Box::new(|cpu, _| cpu.memory.set_byte(layout::M, cpu.memory.byte(layout::M) + 1));
    let ob1: Block = Box::new(|cpu, lbase| {
        let event = crate::events::usual(40, None).unwrap();
        let runs = || cpu.memory.byte(layout::M);
        cpu.system_function(0, 41, AT, lbase);
        cpu.system_function(0, 41, AT, lbase);
        assert_eq!(cpu.memory.word(AT), 2);
        cpu.request(event);
        cpu.safepoint(NO_SITE);
        cpu.system_function(0, 42, AT, lbase);
        assert_eq!(runs(), 0);
        cpu.system_function(0, 42, AT, lbase);
        assert_eq!((cpu.memory.word(AT), runs()), (0, 1));
        assert_eq!(cpu.system_function(0, 42, AT, lbase), 0);
        assert_eq!(cpu.memory.word(AT), 0x8080);
        let select = |number, mode, ob| {
            cpu.memory.set_byte(AT, mode);
            cpu.memory.set_word(AT + 2, ob);
            cpu.system_function(0, number, AT, lbase);
            cpu.memory.word(AT + 4)
        };
        assert_eq!((select(39, 2, 39), select(39, 3, 40), select(39, 1, 40)), (0x8090, 0x8091, 0));
        cpu.request(event);
        cpu.safepoint(NO_SITE);
        assert_eq!(runs(), 1);
        assert_eq!(select(40, 0x82, 40), 0);
        cpu.request(event);
        cpu.safepoint(NO_SITE);
        assert_eq!(runs(), 2);
    });
    let cpu = cpu(vec![(1, ob1), (40, ob40)]);
    run(&cpu, 1);
    assert!(!cpu.is_stopped());
    // Nothing runs between cycles.
    assert_eq!(cpu.memory.host32(state::DEPTH), 0);
}

#[test]
fn unknown_system_function() {
    let ob1: Block = Box::new(|cpu, lbase| assert_eq!(cpu.system_function(0, 999, AT, lbase), 2));
    let cpu = cpu(vec![(1, ob1)]);
    run(&cpu, 1);
    assert_eq!(cpu.stopped().unwrap().cause.unwrap().event, 0x253D);
}

#[test]
fn masked_errors_are_noted() {
    in_ob1(|cpu, lbase| {
        let call = |number, program: u32, access: u32| {
            cpu.memory.set_dword(AT, program);
            cpu.memory.set_dword(AT + 4, access);
            cpu.system_function(0, number, AT, lbase);
            (cpu.memory.word(AT + 8), cpu.memory.dword(AT + 10), cpu.memory.dword(AT + 14))
        };
        assert_eq!(call(36, 1 << 2, 1 << 3), (0, 0x0BC0_FC01 | 1 << 2, !0x10));
        assert_eq!(cpu.sync_error(0, 0x22, 0, 0), 0);
        assert_eq!(cpu.sync_error(0, 0x42, 0, 0), 0);
        assert_eq!(call(38, 0xFFFF_FFFF, 1 << 3), (1, 1 << 2, 1 << 3));
        assert_eq!(call(38, 1 << 2, 1 << 3), (0, 0, 0));
        assert_eq!(call(36, 1 << 2, 0).0, 1);
        assert_eq!(call(37, 1 << 2, 1 << 3), (0, 0x0BC0_FC01, !0x18));
        assert_eq!(call(37, 1 << 2, 0).0, 1);
    });
}

#[test]
fn start_information_can_be_read() {
    in_ob1(|cpu, lbase| {
        assert_eq!(cpu.system_function(0, 6, AT, lbase), 1);
        assert_eq!(cpu.memory.bytes::<4>(AT + 2), [0x11, 1, 1, 1]);
        assert_eq!(cpu.memory.bytes::<4>(AT + 14), [0; 4]);
    });
}

#[test]
fn output_bits_in_a_row() {
    in_ob1(|cpu, lbase| {
        let call = |number, count, area, first: u32| {
            cpu.memory.set_word(AT, count);
            cpu.memory.set_word(AT + 4, 0);
            cpu.memory.set_dword(AT + 6, u32::from(area) << 24 | first);
            cpu.system_function(0, number, AT, lbase);
            cpu.memory.word(AT + 2)
        };
        assert_eq!(call(79, 12, 0x80u8, 8 * 4 + 6), 0);
        assert_eq!(cpu.memory.bytes::<4>(layout::Q + 4), [0xC0, 0xFF, 0x03, 0]);
        assert_eq!(call(80, 2, 0x80, 8 * 5 + 1), 0);
        assert_eq!((cpu.memory.byte(layout::Q + 5), cpu.driver.output(5, 1)), (0xF9, 0xF9));
        assert_eq!(call(79, 1, 0x83, 0), 0x8325);
        assert_eq!(call(79, 9, 0x80, 65_535 * 8), 0x8343);
    });
}

#[test]
fn distributed_data() {
    in_ob1(|cpu, lbase| {
        cpu.driver.set_input(512, 4, 0x0102_0304);
        cpu.memory.set_word(AT, 512);
        cpu.memory.set_bytes(AT + 4, any(2, 4, 0, 0x83, 0));
        assert_eq!(cpu.system_function(0, 14, AT, lbase), 1);
        assert_eq!(cpu.memory.dword(layout::M), 0x0102_0304);
        cpu.memory.set_bytes(AT + 2, any(2, 4, 0, 0x83, 0));
        assert_eq!(cpu.system_function(0, 15, AT, lbase), 1);
        assert_eq!(cpu.driver.output(512, 4), 0x0102_0304);
        cpu.memory.set_bytes(AT + 2, any(4, 2, 0, 0x83, 0));
        assert_eq!(cpu.system_function(0, 15, AT, lbase), 0);
        assert_eq!(cpu.memory.word(AT + 12), 0x8092);
    });
}

#[test]
fn a_jump_of_the_wall_clock_skips_time_of_day_interrupts() {
    let ob80: Block = Box::new(|cpu, lbase| {
        assert_eq!(cpu.memory.bytes::<2>(lbase), [0x35, 0x05]);
        assert_eq!(cpu.memory.bytes::<2>(lbase + 6), [0, 1]);
        cpu.memory.set_byte(layout::M, 1);
    });
    let ob1: Block = Box::new(|cpu, lbase| {
        cpu.memory.set_bytes(AT, datetime::encode(datetime::VIRTUAL_START + 86_400_000_000_000));
        cpu.system_function(0, 0, AT, lbase);
        assert_eq!(cpu.safepoint(NO_SITE), 0);
        assert_eq!(cpu.memory.byte(layout::M), 1);
    });
    let cpu = cpu_with(vec![(1, ob1), (10, Box::new(|_: &Cpu, _| ())), (80, ob80)], |image| {
        image.config.time_of_day.push(plcc_abi::image::TimeOfDay {
            ob: 10,
            start: "1994-01-01T06:00:00".to_string(),
            period: 0x1001,
        });
    });
    run(&cpu, 1);
    assert!(!cpu.is_stopped());
}
