//! ATT, FIFO, LIFO, FND.

use plcc_abi::s7200::Operation;

use super::{DONE, FAILED, V, V_BYTES, cpu, gives, load_v, run, special_bit};
use crate::cpu::Cpu;

/// Writes words to V memory.
fn put(cpu: &Cpu, offset: u32, words: &[u16]) {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_be_bytes()).collect();
    load_v(cpu, offset, &bytes);
}

fn words(cpu: &Cpu, offset: u32, count: u32) -> Vec<u16> {
    (0..count).map(|index| cpu.memory.word(V + offset + 2 * index)).collect()
}

#[test]
fn entries_are_added_until_the_table_is_full() {
    let cpu = cpu();
    // The example of the manual: VW100 = 1234 to the table at VW200.
    put(&cpu, 200, &[6, 2, 5431, 8942]);
    assert_eq!(run(&cpu, Operation::TableAdd, &[1234, V + 200]), DONE);
    assert_eq!(words(&cpu, 200, 6), [6, 3, 5431, 8942, 1234, 0]);
    put(&cpu, 300, &[1, 0]);
    assert_eq!(run(&cpu, Operation::TableAdd, &[7, V + 300]), DONE);
    assert!(!special_bit(&cpu, 1, 4));
    assert_eq!(run(&cpu, Operation::TableAdd, &[8, V + 300]), FAILED);
    assert!(special_bit(&cpu, 1, 4));
    assert_eq!(words(&cpu, 300, 4), [1, 1, 7, 0]);
    assert_eq!(run(&cpu, Operation::TableAdd, &[1234, V + 200]), DONE);
    assert!(!special_bit(&cpu, 1, 4));
}

#[test]
fn first_and_last_entry_are_taken() {
    let cpu = cpu();
    put(&cpu, 200, &[6, 3, 5431, 8942, 1234]);
    assert_eq!(run(&cpu, Operation::TableFirst, &[V + 200]), gives(5431));
    assert_eq!(words(&cpu, 200, 4), [6, 2, 8942, 1234]);
    assert_eq!(run(&cpu, Operation::TableLast, &[V + 200]), gives(1234));
    assert_eq!(words(&cpu, 200, 3), [6, 1, 8942]);
    assert_eq!(run(&cpu, Operation::TableFirst, &[V + 200]), gives(8942));
    assert!(!special_bit(&cpu, 1, 5));
    for operation in [Operation::TableFirst, Operation::TableLast] {
        assert_eq!(run(&cpu, operation, &[V + 200]), FAILED);
        assert!(special_bit(&cpu, 1, 5));
    }
    assert_eq!(words(&cpu, 200, 2), [6, 0]);
}

#[test]
fn tables_lie_in_their_area() {
    let cpu = cpu();
    let end = V_BYTES - 6;
    put(&cpu, end, &[2, 0, 0]);
    assert_eq!(run(&cpu, Operation::TableAdd, &[1, V + end]), DONE);
    assert_eq!(run(&cpu, Operation::TableAdd, &[2, V + end]), FAILED);
    assert!(!special_bit(&cpu, 1, 4));
    assert_eq!(words(&cpu, end, 3), [2, 1, 1]);
    assert_eq!(run(&cpu, Operation::TableFind, &[V + end + 2, 1, 0, 0]), gives(0));
    assert_eq!(run(&cpu, Operation::TableLast, &[V + end]), gives(1));
    put(&cpu, end, &[9, 2]);
    for operation in [Operation::TableFirst, Operation::TableLast] {
        assert_eq!(run(&cpu, operation, &[V + end]), FAILED);
        assert_eq!(run(&cpu, operation, &[V + V_BYTES - 2]), FAILED);
        assert_eq!(run(&cpu, operation, &[V + V_BYTES]), FAILED);
    }
    assert_eq!(run(&cpu, Operation::TableFind, &[V + end + 2, 0, 0, 0]), FAILED);
    assert_eq!(run(&cpu, Operation::TableAdd, &[0, V + V_BYTES - 2]), FAILED);
    // 100 entries at most.
    put(&cpu, 0, &[200, 99]);
    assert_eq!(run(&cpu, Operation::TableAdd, &[5, V]), DONE);
    assert_eq!(run(&cpu, Operation::TableAdd, &[5, V]), FAILED);
    assert_eq!(run(&cpu, Operation::TableFind, &[V + 2, 5, 0, 0]), gives(99));
    put(&cpu, 0, &[200, 101]);
    assert_eq!(run(&cpu, Operation::TableFind, &[V + 2, 5, 0, 0]), FAILED);
    put(&cpu, 0, &[0xFFFF, 0xFFFF]);
    assert_eq!(run(&cpu, Operation::TableLast, &[V]), FAILED);
}

#[test]
fn entries_are_found() {
    let cpu = cpu();
    // The example of the manual: FND= VW202, 16#3130, AC1 finds entries 2 and 4.
    put(&cpu, 202, &[6, 0x3133, 0x4142, 0x3130, 0x3030, 0x3130, 0x4541]);
    let find = |pattern: i16, index: u32, relation: u32| {
        run(&cpu, Operation::TableFind, &[V + 202, u32::from(pattern as u16), index, relation])
    };
    assert_eq!(find(0x3130, 0, 0), gives(2));
    assert_eq!(find(0x3130, 3, 0), gives(4));
    assert_eq!(find(0x3130, 5, 0), gives(6));
    assert_eq!(find(0x3130, 6, 0), gives(6));
    assert_eq!(find(0x3130, 0xFFFF, 0), gives(6));
    assert_eq!(find(0x3133, 0, 1), gives(1));
    assert_eq!(find(0x3130, 0, 2), gives(3));
    assert_eq!(find(0x4142, 0, 3), gives(5));
    // Entries have a sign.
    put(&cpu, 302, &[2, 1, 0xFFFF]);
    assert_eq!(run(&cpu, Operation::TableFind, &[V + 302, 0, 0, 2]), gives(1));
    assert_eq!(run(&cpu, Operation::TableFind, &[V + 302, 0xFFFF, 0, 3]), gives(0));
    assert_eq!(run(&cpu, Operation::TableFind, &[V + 302, 0, 0, 9]), gives(2));
    // No entries at all.
    assert_eq!(run(&cpu, Operation::TableFind, &[V + 400, 0, 0, 0]), gives(0));
}
