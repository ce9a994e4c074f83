//! Whole PDUs in and out, as clients and CPUs exchange them, and PDUs that nobody should send.
//!
//! - `lists`: blocks and the status of the system; `watched`: subscriptions and watch tables.

mod lists;
mod watched;

use std::time::Instant;

use plcc_abi::services::{Protection, Right};
use proptest::prelude::*;

use super::Fake;
use super::frame::{Reader, Received, data};
use super::plc::Family;
use super::session::{Gate, Session};
use super::userdata;

/// Bytes in hexadecimal; white space and what follows `;` does not count.
fn hex(text: &str) -> Vec<u8> {
    let digits: String = text.lines().filter_map(|line| line.split(';').next()).collect();
    let digits: Vec<char> = digits.chars().filter(|c| !c.is_whitespace()).collect();
    digits.chunks(2).map(|pair| u8::from_str_radix(&pair.iter().collect::<String>(), 16).unwrap()).collect()
}

const ALL: Gate = Gate { right: Right::Control, protection: Protection::None, has_password: false };

const SETUP: &str = "32 01 0000 0001 0008 0000 F0 00 0001 0001 01E0";

/// A session after its setup.
fn session(plc: &Fake) -> Session {
    let mut session = Session::new(ALL);
    let answer = session.answer(&hex(SETUP), plc).unwrap().unwrap();
    assert_eq!(answer, hex("32 03 0000 0001 0008 0000 0000 F0 00 0001 0001 00F0"));
    session
}

fn exchange(plc: &Fake, session: &mut Session, request: &str, expected: &str) {
    let answer = session.answer(&hex(request), plc).unwrap().unwrap();
    assert_eq!(answer, hex(expected), "{request}\nanswered {answer:02X?}");
}

#[test]
fn variables_are_read() {
    let plc = Fake::new();
    exchange(
        &plc,
        &mut session(&plc),
        "32 01 0000 0002 001A 0000 04 02 12 0A 10 02 0003 000A 84 000020 12 0A 10 01 0001 0000 83 00002B",
        "32 03 0000 0002 0002 000D 0000 04 02 FF 04 0018 112233 00 FF 03 0001 01",
    );
}

#[test]
fn variables_are_written_one_by_one() {
    let plc = Fake::new();
    let mut session = session(&plc);
    exchange(
        &plc,
        &mut session,
        "32 01 0000 0003 001A 000C 05 02 12 0A 10 01 0001 0000 82 000002 12 0A 10 02 0002 0063 84 000000
         00 03 0001 01 00 00 04 0010 1234",
        "32 03 0000 0003 0002 0002 0000 05 02 FF 0A",
    );
    exchange(
        &plc,
        &mut session,
        "32 01 0000 0004 000E 0006 05 01 12 0A 10 04 0001 000A 84 000000 00 04 0010 ABCD",
        "32 03 0000 0004 0002 0001 0000 05 01 FF",
    );
    assert_eq!(plc.db.borrow()[..2], [0xAB, 0xCD]);
}

#[test]
fn items_have_codes_of_their_own() {
    let plc = Fake::new();
    let mut session = session(&plc);
    for (item, code) in [
        ("12 0A 10 02 0001 0000 83 000080", 0x05), // beyond the end
        ("12 0A 10 02 0001 0000 83 000001", 0x05), // a byte at a bit
        ("12 0A 10 01 0002 0000 83 000000", 0x05), // two bits
        ("12 0A 10 02 0000 0000 83 000000", 0x05), // nothing
        ("12 0A 10 06 FFFF 0000 83 000000", 0x05), // the answer would be too long: see below
        ("12 0A 10 77 0001 0000 83 000000", 0x06), // no such type
        ("12 0A 10 02 0001 0063 84 000000", 0x0A), // no such DB
        ("12 0A 10 02 0001 0000 86 000000", 0x03), // local data
        ("12 0A 10 02 0001 0000 1D 000000", 0x05), // a timer as a byte
        ("12 0A 13 02 0001 0000 83 000000", 0x05), // another kind of address
    ] {
        let answer = session.answer(&hex(&format!("32 01 0000 0002 000E 0000 04 01 {item}")), &plc).unwrap().unwrap();
        let expected = match item.contains("FFFF") {
            true => hex("32 02 0000 0002 0000 0000 8500"),
            false => hex(&format!("32 03 0000 0002 0002 0004 0000 04 01 {code:02X} 00 0000")),
        };
        assert_eq!(answer, expected, "{item}");
    }
}

#[test]
fn the_mode_is_told() {
    let plc = Fake::new();
    exchange(
        &plc,
        &mut session(&plc),
        "32 07 0000 0004 0008 0008 00 01 12 04 11 44 01 00 FF 09 0004 0424 0000",
        "32 07 0000 0004 000C 0020 00 01 12 08 12 84 01 01 00 00 0000 FF 09 001C 0424 0000 0014 0001
         4302 FF 08 00000000 00000000 2611 2219 0530 1231",
    );
}

#[test]
fn groups_that_are_not_served_are_refused_in_userdata() {
    let plc = Fake::new();
    let mut session = session(&plc);
    // Routing of data records, NC programming, a group that does not exist.
    for (sequence, group) in [0x20, 0x3F, 0x0E].into_iter().enumerate() {
        let request = format!("32 07 0000 0004 0008 0004 00 01 12 04 11 {:02X} 01 00 0A 00 0000", 0x40 | group);
        let (kind, sequence) = (0x80 | group, sequence + 1);
        let expected =
            format!("32 07 0000 0004 000C 0004 00 01 12 08 12 {kind:02X} 01 {sequence:02X} 00 00 8104 0A 00 0000");
        exchange(&plc, &mut session, &request, &expected);
    }
    // An answer to nothing.
    let answer = "32 07 0000 0004 0008 0004 00 01 12 04 11 84 01 00 0A 00 0000";
    exchange(&plc, &mut session, answer, "32 02 0000 0004 0000 0000 8500");
}

#[test]
fn the_cpu_is_stopped_and_not_started() {
    let plc = Fake::new();
    let mut session = session(&plc);
    let stop = "32 01 0000 0005 0010 0000 29 00 00 00 00 00 09 50 5F 50 52 4F 47 52 41 4D";
    let start = "32 01 0000 0006 0014 0000 28 00 00 00 00 00 00 FD 0000 09 50 5F 50 52 4F 47 52 41 4D";
    exchange(&plc, &mut session, start, "32 03 0000 0006 0002 0000 8402 28 03");
    exchange(&plc, &mut session, stop, "32 03 0000 0005 0001 0000 0000 29");
    assert!(!plc.running.get());
    exchange(&plc, &mut session, stop, "32 03 0000 0005 0002 0000 8402 29 07");
    exchange(&plc, &mut session, start, "32 03 0000 0006 0001 0000 0000 28");
    assert!(plc.running.get());
    exchange(&plc, &mut session, stop, "32 03 0000 0005 0001 0000 0000 29");
    // A cold restart, which this CPU refuses.
    let cold = "32 01 0000 0006 0016 0000 28 00 00 00 00 00 00 FD 0002 43 20 09 50 5F 50 52 4F 47 52 41 4D";
    exchange(&plc, &mut session, cold, "32 03 0000 0006 0002 0000 8402 28 02");
    let unknown = "32 01 0000 0006 0016 0000 28 00 00 00 00 00 00 FD 0002 43 43 09 50 5F 50 52 4F 47 52 41 4D";
    exchange(&plc, &mut session, unknown, "32 03 0000 0006 0001 0000 D202 28");
}

#[test]
fn a_pdu_that_is_longer_than_agreed_is_refused() {
    let plc = Fake::new();
    let mut session = session(&plc);
    let job = |bytes: usize| {
        let mut pdu = hex("32 01 0000 0005 0002 0000 05 01");
        pdu[8..10].copy_from_slice(&((bytes - 12) as u16).to_be_bytes());
        pdu.resize(bytes, 0);
        pdu
    };
    // Both are wrong, but only one is read: its item is cut.
    for bytes in [240, 241, 960] {
        let answer = session.answer(&job(bytes), &plc).unwrap().unwrap();
        assert_eq!(answer, hex("32 02 0000 0005 0000 0000 8500"), "{bytes}");
    }
    // The connection goes on.
    let read = "32 01 0000 0002 000E 0000 04 01 12 0A 10 02 0001 0000 83 000000";
    exchange(&plc, &mut session, read, "32 03 0000 0002 0002 0005 0000 04 01 FF 04 0008 00");
}

#[test]
fn a_read_without_items_tells_the_mode() {
    let plc = Fake::new();
    let mut session = session(&plc);
    let read = "32 01 0000 0005 0001 0000 04";
    exchange(&plc, &mut session, read, "32 03 0000 0005 0002 0000 0000 04 00");
    plc.running.set(false);
    exchange(&plc, &mut session, read, "32 03 0000 0005 0001 0000 8402 04");
    // A number of items and no items is something else.
    exchange(&plc, &mut session, "32 01 0000 0005 0002 0000 04 00", "32 02 0000 0005 0000 0000 8500");
    exchange(&plc, &mut session, "32 01 0000 0005 0001 0000 05", "32 02 0000 0005 0000 0000 8500");
}

const STOP: &str = "32 01 0000 0005 0010 0000 29 00 00 00 00 00 09 50 5F 50 52 4F 47 52 41 4D";
const SET_PASSWORD: &str = "32 07 0000 0007 0008 000C 00 01 12 04 11 45 01 00 FF 09 0008 26 30 10 17 20 36 55 43";
const CLEAR_PASSWORD: &str = "32 07 0000 0008 0008 0004 00 01 12 04 11 45 02 00 0A 00 0000";

#[test]
fn a_password_lifts_the_protection() {
    let plc = Fake::new();
    let gate = Gate { protection: Protection::ReadWrite, has_password: true, ..ALL };
    let mut session = Session::new(gate);
    session.answer(&hex(SETUP), &plc).unwrap();
    let refused = "32 03 0000 0005 0001 0000 D241 29";
    let answer = |code: &str| format!("32 07 0000 0007 000C 0004 00 01 12 08 12 85 01 01 00 00 {code} 0A 00 0000");
    exchange(&plc, &mut session, STOP, refused);
    // Coded bytes of `secret`, and two blanks.
    assert_eq!(userdata::password(&hex(SET_PASSWORD)).as_deref(), Some(&b"secret"[..]));
    session.judge(false);
    exchange(&plc, &mut session, SET_PASSWORD, &answer("D602"));
    exchange(&plc, &mut session, STOP, refused);
    session.judge(true);
    exchange(&plc, &mut session, SET_PASSWORD, &answer("0000").replace("85 01 01", "85 01 02"));
    exchange(&plc, &mut session, SET_PASSWORD, &answer("D603").replace("85 01 01", "85 01 03"));
    exchange(&plc, &mut session, STOP, "32 03 0000 0005 0001 0000 0000 29");
    let cleared = "32 07 0000 0008 000C 0004 00 01 12 08 12 85 02 04 00 00 0000 0A 00 0000";
    exchange(&plc, &mut session, CLEAR_PASSWORD, cleared);
    exchange(&plc, &mut session, STOP, refused);
    exchange(&plc, &mut session, CLEAR_PASSWORD, &cleared.replace("02 04 00 00 0000", "02 05 00 00 D604"));
}

#[test]
fn without_a_password_none_is_right() {
    let plc = Fake::new();
    let mut session = session(&plc);
    session.judge(true);
    let answer = session.answer(&hex(SET_PASSWORD), &plc).unwrap().unwrap();
    assert_eq!(answer[20..22], [0xD6, 0x05]);
}

#[test]
fn complete_protection_hides_everything() {
    let plc = Fake { family: Family::S71200, ..Fake::new() };
    let mut session = Session::new(Gate { protection: Protection::Complete, has_password: true, ..ALL });
    session.answer(&hex(SETUP), &plc).unwrap();
    let read = "32 01 0000 0002 000E 0000 04 01 12 0A 10 02 0001 0000 83 000000";
    exchange(&plc, &mut session, read, "32 02 0000 0002 0000 0000 8104");
    session.judge(true);
    session.answer(&hex(SET_PASSWORD), &plc).unwrap();
    exchange(&plc, &mut session, read, "32 03 0000 0002 0002 0005 0000 04 01 FF 04 0008 00");
}

#[test]
fn rights_are_kept() {
    let plc = Fake::new();
    let mut session = Session::new(Gate { right: Right::Read, ..ALL });
    session.answer(&hex(SETUP), &plc).unwrap();
    for (request, expected) in [
        (
            "32 01 0000 0004 000E 0006 05 01 12 0A 10 04 0001 000A 84 000000 00 04 0010 ABCD",
            "32 03 0000 0004 0002 0001 0000 05 01 03",
        ),
        (
            "32 01 0000 0005 0010 0000 29 00 00 00 00 00 09 50 5F 50 52 4F 47 52 41 4D",
            "32 03 0000 0005 0001 0000 D241 29",
        ),
        (
            "32 07 0000 0004 0008 000E 00 01 12 04 11 47 02 00 FF 09 000A 00 20 26 11 22 19 05 30 12 31",
            "32 07 0000 0004 000C 0004 00 01 12 08 12 87 02 01 00 00 D241 0A 00 0000",
        ),
    ] {
        exchange(&plc, &mut session, request, expected);
    }
    assert!(plc.running.get() && plc.db.borrow()[0] == 0);
}

#[test]
fn test_functions_are_refused_by_name() {
    let plc = Fake::new();
    let mut open = session(&plc);
    let mut read_only = Session::new(Gate { right: Right::Read, ..ALL });
    read_only.answer(&hex(SETUP), &plc).unwrap();
    let ask = |session: &mut Session, function: &str| {
        let request = format!("32 07 0000 0001 0008 0004 00 01 12 04 11 41 {function} 00 0A 00 0000");
        let answer = session.answer(&hex(&request), &plc).unwrap().unwrap();
        u16::from_be_bytes([answer[20], answer[21]])
    };
    // The status of no variables; modifying; forcing; the end of a job; the list of jobs; a LED that flashes.
    for (function, expected) in [("02", 0x8500), ("08", 0xD003), ("09", 0xD003), ("0F", 0xD043), ("10", 0), ("16", 0)] {
        assert_eq!(ask(&mut open, function), expected, "{function}");
    }
    assert_eq!(ask(&mut read_only, "09"), 0xD0A1);
}

#[test]
fn a_cpu_of_the_tia_portal_has_no_blocks_for_s7_clients() {
    let plc = Fake { family: Family::S71200, ..Fake::new() };
    let mut session = session(&plc);
    for function in ["1A", "1B", "1C", "1D", "1E", "1F", "28", "29"] {
        let job = format!("32 01 0000 0009 0001 0000 {function}");
        exchange(&plc, &mut session, &job, "32 02 0000 0009 0000 0000 8104");
    }
}

#[test]
fn an_upload_needs_the_password() {
    let plc = Fake::new();
    let mut session = Session::new(Gate { protection: Protection::ReadWrite, has_password: true, ..ALL });
    session.answer(&hex(SETUP), &plc).unwrap();
    let upload = "32 01 0000 0009 0012 0000 1D 00 0000 00000000 09 5F 30 41 30 30 30 30 31 41";
    exchange(&plc, &mut session, upload, "32 03 0000 0009 0001 0000 D241 1D");
    session.judge(true);
    session.answer(&hex(SET_PASSWORD), &plc).unwrap();
    exchange(&plc, &mut session, upload, "32 03 0000 0009 0001 0000 D209 1D");
}

#[test]
fn cells_of_an_s7_200_have_their_bit() {
    let plc = Fake { family: Family::S7200, ..Fake::new() };
    let mut session = session(&plc);
    // T37 and T38, whose bits the CPU of this test has by their numbers; C5.
    exchange(
        &plc,
        &mut session,
        "32 01 0000 0002 001A 0000 04 02 12 0A 10 1F 0002 0000 1F 000025 12 0A 10 1E 0001 0000 1E 000005",
        "32 03 0000 0002 0002 0015 0000 04 02 FF 09 000A 01 0000 0000 00 0000 0000 FF 09 0003 00 0000",
    );
    // The bits alone, and the values as words; not two bits at once, nor values of 32 bits.
    exchange(
        &plc,
        &mut session,
        "32 01 0000 0002 0026 0000 04 03 12 0A 10 01 0001 0000 1F 000025 12 0A 10 01 0001 0000 1F 000026 12 0A 10 04 0001 0000 1E 000005",
        "32 03 0000 0002 0002 0012 0000 04 03 FF 03 0001 01 00 FF 03 0001 00 00 FF 04 0010 0000",
    );
    exchange(
        &plc,
        &mut session,
        "32 01 0000 0002 0026 0000 04 03 12 0A 10 01 0002 0000 1F 000025 12 0A 10 06 0001 0000 1F 000025 12 0A 10 08 0001 0000 1E 000005",
        "32 03 0000 0002 0002 000C 0000 04 03 05 00 0000 05 00 0000 05 00 0000",
    );
    // The program sets the bit.
    exchange(
        &plc,
        &mut session,
        "32 01 0000 0002 000E 0005 05 01 12 0A 10 01 0001 0000 1F 000025 00 03 0001 01",
        "32 03 0000 0002 0002 0001 0000 05 01 03",
    );
    // A current value alone, or as it is read; not as bits of another length.
    for (data, code) in [("00 04 0010 1234", "FF"), ("00 09 0005 01 0000 1234", "FF"), ("00 09 0003 00 1234", "07")] {
        let length = if data.len() > 16 { "0009" } else { "0006" };
        let length = if code == "07" { "0007" } else { length };
        exchange(
            &plc,
            &mut session,
            &format!("32 01 0000 0002 000E {length} 05 01 12 0A 10 1F 0001 0000 1F 000025 {data}"),
            &format!("32 03 0000 0002 0002 0001 0000 05 01 {code}"),
        );
    }
}

/// Requests that are right, to be changed at random.
const REQUESTS: [&str; 9] = [
    SET_PASSWORD,
    "32 07 0000 0001 0008 0006 00 01 12 04 11 43 02 00 FF 09 0002 30 41",
    SETUP,
    "32 01 0000 0002 001A 0000 04 02 12 0A 10 02 0003 000A 84 000020 12 0A 10 01 0001 0000 83 00002B",
    "32 01 0000 0004 000E 0006 05 01 12 0A 10 04 0001 000A 84 000000 00 04 0010 ABCD",
    "32 07 0000 0004 0008 0008 00 01 12 04 11 44 01 00 FF 09 0004 0424 0000",
    "32 07 0000 0001 0008 000C 00 01 12 04 11 43 03 00 FF 09 0008 30 41 30 30 30 31 30 41",
    "32 07 0000 0007 0008 002A 00 01 12 04 11 41 02 00 FF 09 0026 0014 000E 0000 000000000000000000000000000000000000 \
     0002 00 03 0000 0005 71 03 000A 0004",
    "32 01 0000 0006 0014 0000 28 00 00 00 00 00 00 FD 0000 09 50 5F 50 52 4F 47 52 41 4D",
];

fn survives(pdus: &[Vec<u8>]) {
    let plc = Fake::new();
    let mut own = session(&plc);
    for pdu in pdus {
        let _ = userdata::password(pdu);
        match own.answer(pdu, &plc) {
            Ok(Some(answer)) => {
                assert!(answer.len() <= own.pdu_max(), "{pdu:02X?}: {} bytes", answer.len());
                // The reference is that of the request.
                assert_eq!(answer.get(4..6), pdu.get(4..6));
            }
            Ok(None) => {}
            Err(_) => return,
        }
        let indications = own.indications(&plc, Instant::now());
        assert!(indications.iter().all(|pdu| pdu.len() <= own.pdu_max()), "{indications:02X?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_pdus_do_no_harm(mut pdus in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..80), 1..4)) {
        pdus.iter_mut().for_each(|pdu| if let Some(first) = pdu.first_mut() { *first = 0x32 });
        survives(&pdus);
    }

    #[test]
    fn changed_pdus_do_no_harm(
        which in 0..REQUESTS.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut pdu = hex(REQUESTS[which]);
        for (index, value) in &changes {
            let at = index.index(pdu.len());
            pdu[at] = *value;
        }
        survives(&[pdu.clone(), pdu[..=cut.index(pdu.len())].to_vec()]);
    }

    #[test]
    fn random_streams_do_no_harm(pieces in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..60), 1..6), frames in any::<bool>()) {
        let mut reader = Reader::default();
        for piece in &pieces {
            reader.feed(&if frames { data(piece, 1021) } else { piece.clone() });
            while let Ok(Some(received)) = reader.next(240) {
                prop_assert!(!matches!(received, Received::Pdu(pdu) if pdu.len() > 240));
            }
        }
    }
}
