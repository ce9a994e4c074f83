//! TODR, TODW, TODRX, TODWX.

use plcc_abi::s7200::Operation;

use super::{DONE, FAILED, V, V_BYTES, cpu, load_v, run, v_bytes};
use crate::clock::NS_PER_MS;
use crate::cpu::Cpu;

const NS_PER_HOUR: u64 = 3_600_000 * NS_PER_MS;

fn set(cpu: &Cpu, buffer: [u8; 8]) -> u64 {
    load_v(cpu, 0, &buffer);
    run(cpu, Operation::SetClock, &[V])
}

fn read(cpu: &Cpu) -> Vec<u8> {
    load_v(cpu, 100, &[0xEE; 9]);
    assert_eq!(run(cpu, Operation::ReadClock, &[V + 100]), DONE);
    assert_eq!(cpu.memory.byte(V + 108), 0xEE);
    v_bytes(cpu, 100, 8)
}

/// Lets time pass.
fn pass(cpu: &Cpu, ns: u64) {
    cpu.clock.move_to(cpu.clock.now() + ns);
}

#[test]
fn the_clock_is_set_and_read() {
    let cpu = cpu();
    // 1994-01-01 was a Saturday.
    assert_eq!(read(&cpu), [0x94, 0x01, 0x01, 0, 0, 0, 0, 7]);
    // 2004-02-29, a Sunday.
    assert_eq!(set(&cpu, [0x04, 0x02, 0x29, 0x23, 0x59, 0x58, 0, 1]), DONE);
    assert_eq!(read(&cpu), [0x04, 0x02, 0x29, 0x23, 0x59, 0x58, 0, 1]);
    pass(&cpu, 2999 * NS_PER_MS);
    assert_eq!(read(&cpu), [0x04, 0x03, 0x01, 0, 0, 0, 0, 2]);
    // The byte that is 0 does not count.
    assert_eq!(set(&cpu, [0x99, 0x12, 0x31, 0x12, 0x34, 0x56, 0xFF, 5]), DONE);
    assert_eq!(read(&cpu), [0x99, 0x12, 0x31, 0x12, 0x34, 0x56, 0, 5]);
}

#[test]
fn the_day_of_the_week_is_not_checked() {
    let cpu = cpu();
    // 2026-11-22 is a Sunday, but the program says Wednesday.
    assert_eq!(set(&cpu, [0x26, 0x11, 0x22, 0x12, 0, 0, 0, 4]), DONE);
    assert_eq!(read(&cpu)[7], 4);
    pass(&cpu, 24 * 3 * NS_PER_HOUR);
    assert_eq!(read(&cpu)[7], 7);
    pass(&cpu, 24 * NS_PER_HOUR);
    assert_eq!(read(&cpu)[7], 1);
    // Without one.
    assert_eq!(set(&cpu, [0x26, 0x11, 0x22, 0x12, 0, 0, 0, 0]), DONE);
    assert_eq!(read(&cpu)[7], 0);
    pass(&cpu, 24 * NS_PER_HOUR);
    assert_eq!(read(&cpu)[7], 0);
}

#[test]
fn a_day_that_does_not_exist_lasts_until_midnight() {
    let cpu = cpu();
    assert_eq!(set(&cpu, [0x26, 0x02, 0x30, 0x22, 0, 0, 0, 2]), DONE);
    pass(&cpu, NS_PER_HOUR);
    assert_eq!(read(&cpu), [0x26, 0x02, 0x30, 0x23, 0, 0, 0, 2]);
    pass(&cpu, NS_PER_HOUR);
    assert_eq!(read(&cpu), [0x26, 0x03, 0x03, 0, 0, 0, 0, 3]);
}

#[test]
fn wrong_data_are_refused() {
    let cpu = cpu();
    let good = [0x26, 0x11, 0x22, 0x13, 0x34, 0x52, 0, 1];
    assert_eq!(set(&cpu, good), DONE);
    for (index, bad) in [
        (0, 0xA0),
        (0, 0x9A),
        (1, 0x00),
        (1, 0x13),
        (1, 0x0A),
        (2, 0x00),
        (2, 0x32),
        (3, 0x24),
        (4, 0x60),
        (5, 0x60),
        (5, 0x0F),
        (7, 0x08),
    ] {
        let mut buffer = good;
        buffer[index] = bad;
        assert_eq!(set(&cpu, buffer), FAILED, "{index} {bad:X}");
    }
    assert_eq!(read(&cpu), good);
    for (operation, bytes) in [
        (Operation::ReadClock, 8),
        (Operation::SetClock, 8),
        (Operation::ReadClockExtended, 19),
        (Operation::SetClockExtended, 19),
    ] {
        assert_eq!(run(&cpu, operation, &[V + V_BYTES - bytes + 1]), FAILED);
    }
    assert_eq!(run(&cpu, Operation::ReadClockExtended, &[V + V_BYTES - 19]), DONE);
}

/// Sets the clock with settings of daylight-saving time.
fn set_extended(cpu: &Cpu, buffer: [u8; 8], settings: [u8; 11]) -> u64 {
    load_v(cpu, 0, &buffer);
    load_v(cpu, 8, &settings);
    run(cpu, Operation::SetClockExtended, &[V])
}

fn mode(mode: u8) -> [u8; 11] {
    [mode, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]
}

#[test]
fn settings_are_read_back() {
    let cpu = cpu();
    let settings = [0xFF, 0x01, 0x30, 0x04, 0x01, 0x02, 0x00, 0x10, 0x31, 0x03, 0x59];
    assert_eq!(set_extended(&cpu, [0x26, 0x01, 0x05, 0x12, 0, 0, 0, 2], settings), DONE);
    assert_eq!(run(&cpu, Operation::ReadClockExtended, &[V + 100]), DONE);
    assert_eq!(v_bytes(&cpu, 100, 8), [0x26, 0x01, 0x05, 0x12, 0, 0, 0, 2]);
    assert_eq!(v_bytes(&cpu, 108, 12), [&settings[..], &[0]].concat());
    for (index, bad) in [(0, 0x04), (0, 0x14), (1, 0x24), (2, 0x60), (3, 0x00), (4, 0x32), (5, 0x24), (10, 0x0A)] {
        let mut wrong = settings;
        wrong[index] = bad;
        assert_eq!(set_extended(&cpu, [0x26, 0x01, 0x05, 0x12, 0, 0, 0, 2], wrong), FAILED, "{index} {bad:X}");
    }
}

/// Sets the clock to one second before the hour, in a mode; returns hour and day of the month one second later.
fn next_hour(settings: [u8; 11], [month, day, hour]: [u8; 3]) -> (u8, u8) {
    let cpu = cpu();
    assert_eq!(set_extended(&cpu, [0x26, month, day, hour, 0x59, 0x59, 0, 1], settings), DONE);
    assert_eq!(read(&cpu)[..6], [0x26, month, day, hour, 0x59, 0x59]);
    pass(&cpu, 1000 * NS_PER_MS);
    let now = read(&cpu);
    (now[3], now[2])
}

#[test]
fn daylight_saving_time_begins_and_ends() {
    // Central Europe 2026: from 29 March 2:00 to 25 October 3:00.
    assert_eq!(next_hour(mode(0x02), [0x03, 0x29, 0x01]), (0x03, 0x29));
    assert_eq!(next_hour(mode(0x02), [0x10, 0x25, 0x02]), (0x02, 0x25));
    assert_eq!(next_hour(mode(0x02), [0x03, 0x28, 0x01]), (0x02, 0x28));
    assert_eq!(next_hour(mode(0x02), [0x10, 0x25, 0x03]), (0x04, 0x25));
    assert_eq!(next_hour(mode(0x00), [0x03, 0x29, 0x01]), (0x02, 0x29));
    // Great Britain an hour earlier by its clock, the Azores before 0:00.
    assert_eq!(next_hour(mode(0x01), [0x03, 0x29, 0x00]), (0x02, 0x29));
    assert_eq!(next_hour(mode(0x08), [0x03, 0x28, 0x23]), (0x01, 0x29));
    // USA 2026: from 8 March 2:00 to 1 November 2:00.
    assert_eq!(next_hour(mode(0x10), [0x03, 0x08, 0x01]), (0x03, 0x08));
    assert_eq!(next_hour(mode(0x10), [0x11, 0x01, 0x01]), (0x01, 0x01));
    // Australia: to 29 March 3:00, from 25 October 2:00. Tasmania: from 4 October. New Zealand: to 15 March 3:00.
    assert_eq!(next_hour(mode(0x11), [0x03, 0x29, 0x02]), (0x02, 0x29));
    assert_eq!(next_hour(mode(0x11), [0x10, 0x25, 0x01]), (0x03, 0x25));
    assert_eq!(next_hour(mode(0x12), [0x10, 0x04, 0x01]), (0x03, 0x04));
    assert_eq!(next_hour(mode(0x13), [0x03, 0x15, 0x02]), (0x02, 0x15));
    assert_eq!(next_hour(mode(0x11), [0x12, 0x31, 0x23]), (0x00, 0x01));
}

#[test]
fn begin_and_end_of_the_program() {
    // Half an hour from 1 April 2:00 to 31 October 3:00.
    let settings = [0xFF, 0x00, 0x30, 0x04, 0x01, 0x02, 0x00, 0x10, 0x31, 0x03, 0x00];
    let cpu = cpu();
    assert_eq!(set_extended(&cpu, [0x26, 0x04, 0x01, 0x01, 0x59, 0x59, 0, 4], settings), DONE);
    pass(&cpu, 1000 * NS_PER_MS);
    assert_eq!(read(&cpu), [0x26, 0x04, 0x01, 0x02, 0x30, 0, 0, 4]);
    // TODW keeps the settings.
    assert_eq!(set(&cpu, [0x26, 0x10, 0x31, 0x02, 0x59, 0x59, 0, 7]), DONE);
    pass(&cpu, 1000 * NS_PER_MS);
    assert_eq!(read(&cpu), [0x26, 0x10, 0x31, 0x02, 0x30, 0, 0, 7]);
}
