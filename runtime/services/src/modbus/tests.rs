//! Requests as masters send them, and requests that nobody should send.

use proptest::prelude::*;

use super::functions::{answer, frame};
use super::memory::{Map, Start};
use crate::s7::{Area, Fake, Plc};

const MAP: Map = Map {
    coils: Start { area: Area::BitMemory, byte: 0, bit: 0 },
    discrete_inputs: Start { area: Area::BitMemory, byte: 5, bit: 2 },
    input_registers: Start { area: Area::BitMemory, byte: 4, bit: 0 },
    holding_registers: Start { area: Area::Db(10), byte: 2, bit: 0 },
};

/// A CPU whose MB 5 is 8, and DB 10 of 100 bytes with 11, 22, 33 from byte 4 on (hexadecimal).
fn ask(plc: &Fake, request: &[u8]) -> Vec<u8> {
    answer(request, &MAP, true, plc)
}

#[test]
fn bits_and_registers_are_read() {
    let plc = Fake::new();
    assert_eq!(ask(&plc, &[1, 0, 40, 0, 9]), [1, 2, 8, 0]);
    // From M5.2 on: M5.3 is the second one.
    assert_eq!(ask(&plc, &[2, 0, 0, 0, 3]), [2, 1, 2]);
    assert_eq!(ask(&plc, &[4, 0, 0, 0, 1]), [4, 2, 0, 8]);
    assert_eq!(ask(&plc, &[3, 0, 1, 0, 2]), [3, 4, 0x11, 0x22, 0x33, 0]);
}

#[test]
fn bits_and_registers_are_written() {
    let plc = Fake::new();
    assert_eq!(ask(&plc, &[6, 0, 0, 0xAB, 0xCD]), [6, 0, 0, 0xAB, 0xCD]);
    assert_eq!(ask(&plc, &[16, 0, 10, 0, 2, 4, 1, 2, 3, 4]), [16, 0, 10, 0, 2]);
    assert_eq!(ask(&plc, &[22, 0, 10, 0xFF, 0x00, 0x00, 0x55]), [22, 0, 10, 0xFF, 0x00, 0x00, 0x55]);
    assert_eq!(ask(&plc, &[23, 0, 10, 0, 2, 0, 11, 0, 1, 2, 9, 9]), [23, 4, 1, 0x55, 9, 9]);
    assert_eq!(plc.db.borrow()[2..4], [0xAB, 0xCD]);
    assert_eq!(ask(&plc, &[5, 0, 41, 0xFF, 0]), [5, 0, 41, 0xFF, 0]);
    assert_eq!(ask(&plc, &[15, 0, 44, 0, 10, 2, 0xFF, 0x03]), [15, 0, 44, 0, 10]);
    assert_eq!(ask(&plc, &[1, 0, 40, 0, 16]), [1, 2, 0xFA, 0x3F]);
}

#[test]
fn the_device_is_identified() {
    let plc = Fake::new();
    let head = |code: u8, count: u8| vec![43, 14, code, 0x82, 0, 0, count];
    let object = |number: u8, text: &str| [&[number, text.len() as u8][..], text.as_bytes()].concat();
    let (vendor, code) = (object(0, "plcc"), object(1, "6ES7 315-2AG10-0AB0"));
    let (revision, program) = (object(2, env!("CARGO_PKG_VERSION")), object(6, "test"));
    let module = object(4, "CPU 315-2 DP");
    let basic = [head(1, 3), vendor.clone(), code.clone(), revision.clone()].concat();
    assert_eq!(ask(&plc, &[43, 14, 1, 0]), basic);
    assert_eq!(ask(&plc, &[43, 14, 1, 4]), basic, "an object of another kind: from the first one on");
    assert_eq!(ask(&plc, &[43, 14, 1, 2]), [head(1, 1), revision.clone()].concat());
    let regular = |code_asked: u8| {
        let parts = [head(code_asked, 5), vendor.clone(), code.clone(), revision.clone(), module.clone()];
        [parts.concat(), program.clone()].concat()
    };
    assert_eq!(ask(&plc, &[43, 14, 2, 0]), regular(2));
    assert_eq!(ask(&plc, &[43, 14, 3, 0x80]), regular(3));
    assert_eq!(ask(&plc, &[43, 14, 4, 6]), [head(4, 1), program.clone()].concat());
    for (request, exception) in [
        (&[43, 14, 4, 3][..], 2),
        (&[43, 14, 5, 0], 3),
        (&[43, 14, 1], 3),
        (&[43, 14, 1, 0, 0], 3),
        (&[43, 13, 1, 0], 1),
        (&[43], 1),
    ] {
        assert_eq!(ask(&plc, request), [0xAB, exception], "{request:?}");
    }
}

#[test]
fn wrong_requests_have_exceptions() {
    let plc = Fake::new();
    for (request, exception) in [
        (&[7][..], [0x87, 1]),
        (&[3, 0, 49, 0, 1], [0x83, 2]),
        (&[3, 0xFF, 0xFF, 0, 2], [0x83, 2]),
        (&[3, 0, 0, 0, 0], [0x83, 3]),
        (&[3, 0, 0, 0, 126], [0x83, 3]),
        (&[3, 0, 0, 0], [0x83, 3]),
        (&[5, 0, 0, 1, 0], [0x85, 3]),
        (&[15, 0, 0, 0, 9, 1, 0], [0x8F, 3]),
        (&[16, 0, 48, 0, 2, 4, 1, 2, 3, 4], [0x90, 2]),
        (&[15, 0, 127, 0, 2, 1, 3], [0x8F, 2]),
    ] {
        assert_eq!(ask(&plc, request), exception, "{request:?}");
    }
    // Nothing of what is partly wrong is written.
    assert_eq!((plc.db.borrow()[98..].to_vec(), plc.memory.borrow()[15]), (vec![0, 0], 0));
}

#[test]
fn readers_do_not_write() {
    let plc = Fake::new();
    assert_eq!(answer(&[6, 0, 0, 1, 1], &MAP, false, &plc), [0x86, 1]);
    assert_eq!(answer(&[3, 0, 0, 0, 1], &MAP, false, &plc), [3, 2, 0, 0]);
    assert_eq!(plc.db.borrow()[2..4], [0, 0]);
}

#[test]
fn a_frame_has_its_transaction() {
    assert_eq!(frame([1, 2], 7, &[3, 2, 0, 1]), [1, 2, 0, 0, 0, 5, 7, 3, 2, 0, 1]);
}

const REQUESTS: [&[u8]; 7] = [
    &[43, 14, 2, 0],
    &[1, 0, 40, 0, 9],
    &[3, 0, 1, 0, 2],
    &[15, 0, 44, 0, 10, 2, 0xFF, 0x03],
    &[16, 0, 10, 0, 2, 4, 1, 2, 3, 4],
    &[22, 0, 10, 0xFF, 0x00, 0x00, 0x55],
    &[23, 0, 10, 0, 2, 0, 11, 0, 1, 2, 9, 9],
];

fn survives(request: &[u8]) {
    let plc = Fake::new();
    let answered = ask(&plc, request);
    let function = request.first().copied().unwrap_or(0);
    assert!(answered.len() <= 253 && answered[0] | 0x80 == function | 0x80, "{request:?}: {answered:?}");
    assert!(plc.is_running());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_requests_do_no_harm(request in prop::collection::vec(any::<u8>(), 0..60), function in 0u8..45) {
        let mut request = request;
        if let Some(first) = request.first_mut() { *first = function }
        survives(&request);
    }

    #[test]
    fn changed_requests_do_no_harm(
        which in 0..REQUESTS.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut request = REQUESTS[which].to_vec();
        for (index, value) in &changes {
            let at = index.index(request.len());
            request[at] = *value;
        }
        survives(&request);
        survives(&request[..=cut.index(request.len())]);
    }
}
