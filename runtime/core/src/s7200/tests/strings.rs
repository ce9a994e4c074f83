//! Operations on strings.

use plcc_abi::image::DbEntry;
use plcc_abi::s7200::{Operation, fatal, result};

use super::{DONE, FAILED, V, V_BYTES, changed_cpu, cpu, gives, load_v, put_string, run, string, v_bytes};

#[test]
fn length_and_copy() {
    let cpu = cpu();
    put_string(&cpu, 0, "HELLO WORLD");
    assert_eq!(run(&cpu, Operation::StringLength, &[V]), gives(11));
    assert_eq!(run(&cpu, Operation::StringCopy, &[V, V + 70]), DONE);
    assert_eq!(string(&cpu, 70), "HELLO WORLD");
    assert_eq!(cpu.memory.byte(V + 82), 0);
    assert_eq!(run(&cpu, Operation::StringLength, &[V + 500]), gives(0));
    // At the end of V memory.
    assert_eq!(run(&cpu, Operation::StringCopy, &[V, V + V_BYTES - 12]), DONE);
    assert_eq!(string(&cpu, V_BYTES - 12), "HELLO WORLD");
    assert_eq!(run(&cpu, Operation::StringLength, &[V + V_BYTES - 12]), gives(11));
    assert_eq!(run(&cpu, Operation::StringCopy, &[V, V + V_BYTES - 11]), FAILED);
    assert_eq!(string(&cpu, V_BYTES - 12), "HELLO WORLD");
    load_v(&cpu, V_BYTES - 12, &[12]);
    assert_eq!(run(&cpu, Operation::StringLength, &[V + V_BYTES - 12]), FAILED);
    assert_eq!(run(&cpu, Operation::StringCopy, &[V + V_BYTES - 12, V]), FAILED);
    load_v(&cpu, 0, &[255]);
    assert_eq!(run(&cpu, Operation::StringLength, &[V]), FAILED);
    assert_eq!(run(&cpu, Operation::StringLength, &[V + V_BYTES]), FAILED);
    assert_eq!(run(&cpu, Operation::StringLength, &[u32::MAX]), FAILED);
}

#[test]
fn strings_are_appended() {
    let cpu = cpu();
    put_string(&cpu, 0, "HELLO ");
    put_string(&cpu, 100, "WORLD");
    assert_eq!(run(&cpu, Operation::StringAppend, &[V + 100, V]), DONE);
    assert_eq!(string(&cpu, 0), "HELLO WORLD");
    // To itself.
    assert_eq!(run(&cpu, Operation::StringAppend, &[V + 100, V + 100]), DONE);
    assert_eq!(string(&cpu, 100), "WORLDWORLD");
    // 254 characters at most.
    put_string(&cpu, 1000, &"x".repeat(250));
    put_string(&cpu, 2000, "1234");
    assert_eq!(run(&cpu, Operation::StringAppend, &[V + 2000, V + 1000]), DONE);
    assert_eq!(run(&cpu, Operation::StringLength, &[V + 1000]), gives(254));
    put_string(&cpu, 1000, &"x".repeat(251));
    assert_eq!(run(&cpu, Operation::StringAppend, &[V + 2000, V + 1000]), FAILED);
    assert_eq!(string(&cpu, 1000), "x".repeat(251));
    put_string(&cpu, V_BYTES - 6, "ab");
    assert_eq!(run(&cpu, Operation::StringAppend, &[V + 2000, V + V_BYTES - 6]), FAILED);
    assert_eq!(string(&cpu, V_BYTES - 6), "ab");
    put_string(&cpu, V_BYTES - 6, "a");
    assert_eq!(run(&cpu, Operation::StringAppend, &[V + 2000, V + V_BYTES - 6]), DONE);
    assert_eq!(string(&cpu, V_BYTES - 6), "a1234");
}

#[test]
fn parts_are_copied() {
    let cpu = cpu();
    put_string(&cpu, 0, "HELLO WORLD");
    // The example of the manual: SSCPY VB0, 7, 5, VB70.
    assert_eq!(run(&cpu, Operation::StringPart, &[V, 7, 5, V + 70]), DONE);
    assert_eq!(string(&cpu, 70), "WORLD");
    for (index, count, expected) in
        [(1, 5, "HELLO"), (7, 255, "WORLD"), (11, 2, "D"), (12, 2, ""), (255, 1, ""), (3, 0, "")]
    {
        assert_eq!(run(&cpu, Operation::StringPart, &[V, index, count, V + 70]), DONE);
        assert_eq!(string(&cpu, 70), expected, "{index} {count}");
    }
    assert_eq!(run(&cpu, Operation::StringPart, &[V, 0, 5, V + 70]), FAILED);
    assert_eq!(run(&cpu, Operation::StringPart, &[V, 1, 5, V + V_BYTES - 6]), DONE);
    assert_eq!(run(&cpu, Operation::StringPart, &[V, 1, 5, V + V_BYTES - 5]), FAILED);
    // Into itself.
    assert_eq!(run(&cpu, Operation::StringPart, &[V, 7, 5, V]), DONE);
    assert_eq!(v_bytes(&cpu, 0, 7), *b"\x05WORLD ");
}

#[test]
fn strings_are_found() {
    let cpu = cpu();
    put_string(&cpu, 0, "This is a string: ON or OFF or ON");
    let find = |pattern: &str, start: u32| {
        put_string(&cpu, 100, pattern);
        run(&cpu, Operation::StringFind, &[V, V + 100, start])
    };
    assert_eq!(find("ON", 1), gives(19));
    assert_eq!(find("ON", 19), gives(19));
    assert_eq!(find("ON", 20), gives(32));
    assert_eq!(find("ON", 33), gives(0));
    assert_eq!(find("on", 1), gives(0));
    assert_eq!(find("This is a string: ON or OFF or ON", 1), gives(1));
    assert_eq!(find("This is a string: ON or OFF or ON!", 1), gives(0));
    assert_eq!(find("", 1), gives(0));
    assert_eq!(find("ON", 0), FAILED);
    assert_eq!(find("ON", 34), FAILED);
    assert_eq!(find("ON", u32::MAX), FAILED);
}

#[test]
fn characters_are_found() {
    let cpu = cpu();
    // The example of the manual: the number in a text, then STR from there.
    put_string(&cpu, 0, "Temperature  98.6F");
    put_string(&cpu, 20, "1234567890+-");
    let find = |start: u32| run(&cpu, Operation::CharacterFind, &[V, V + 20, start]);
    assert_eq!(find(1), gives(14));
    assert_eq!(find(15), gives(15));
    assert_eq!(find(16), gives(17));
    assert_eq!(find(18), gives(0));
    assert_eq!(find(0), FAILED);
    assert_eq!(find(19), FAILED);
    assert_eq!(run(&cpu, Operation::StringToReal, &[V, 14]), gives(98.6f32.to_bits()));
    // Nothing in an empty string.
    assert_eq!(run(&cpu, Operation::CharacterFind, &[V + 500, V + 20, 1]), gives(0));
    assert_eq!(run(&cpu, Operation::CharacterFind, &[V, V + 500, 1]), gives(0));
}

#[test]
fn strings_are_compared() {
    let cpu = cpu();
    put_string(&cpu, 0, "Pump");
    for (text, equal) in [("Pump", 1), ("pump", 0), ("Pum", 0), ("Pumps", 0), ("", 0)] {
        put_string(&cpu, 50, text);
        assert_eq!(run(&cpu, Operation::StringEqual, &[V, V + 50]), gives(equal), "{text}");
    }
    assert_eq!(run(&cpu, Operation::StringEqual, &[V + 500, V + 600]), gives(1));
    assert!(!cpu.is_stopped());
    load_v(&cpu, V_BYTES - 1, &[1]);
    assert_eq!(run(&cpu, Operation::StringEqual, &[V, V + V_BYTES - 1]), result::STOP);
    assert_eq!(cpu.stopped().map(|stop| stop.entry.event), Some(0xFA00 | fatal::COMPARE_RANGE));
}

#[test]
fn constants_lie_in_a_block_of_their_own() {
    let constants = V + V_BYTES + 16;
    let cpu = changed_cpu(|image| {
        let data = b"\x02ON\x03OF".to_vec();
        image.db_end = constants + data.len() as u32;
        image.dbs.push(DbEntry {
            number: 2,
            name: String::new(),
            address: constants,
            data,
            read_only: true,
            unlinked: false,
            optimized: false,
            kept: Default::default(),
            ty: None,
        });
    });
    assert_eq!(run(&cpu, Operation::StringCopy, &[constants, V]), DONE);
    assert_eq!(string(&cpu, 0), "ON");
    assert_eq!(run(&cpu, Operation::StringEqual, &[constants, V]), gives(1));
    assert_eq!(run(&cpu, Operation::StringCopy, &[constants + 3, V]), FAILED);
}
