//! Lists of blocks and of the status of the system.

use plcc_abi::services::Protection;

use super::{ALL, SETUP, hex, session};
use crate::s7::Fake;
use crate::s7::plc::Family;
use crate::s7::session::{Gate, Session};

#[test]
fn long_lists_come_in_pieces() {
    let plc = Fake::new();
    let mut session = session(&plc);
    let mut answer =
        session.answer(&hex("32 07 0000 0001 0008 0008 00 01 12 04 11 44 01 00 FF 09 0004 00A0 0000"), &plc);
    let mut all: Vec<u8> = Vec::new();
    loop {
        let pdu = answer.unwrap().unwrap();
        assert!(pdu.len() <= 240);
        let (sequence, more) = (pdu[17], pdu[19]);
        all.extend(&pdu[26..]);
        if more == 0 {
            break;
        }
        let next = format!("32 07 0000 0001 000C 0004 00 01 12 08 12 44 01 {sequence:02X} 00 00 0000 0A 00 0000");
        answer = session.answer(&hex(&next), &plc);
    }
    assert_eq!(all.len(), 8 + 30 * 20);
    // Nothing is left to be asked for.
    let next = "32 07 0000 0001 000C 0004 00 01 12 08 12 44 01 01 00 00 0000 0A 00 0000";
    let pdu = session.answer(&hex(next), &plc).unwrap().unwrap();
    assert_eq!(pdu[20..22], [0xD4, 0x06]);
}

#[test]
fn blocks_are_listed() {
    let plc = Fake::new();
    let mut session = session(&plc);
    let info = "32 07 0000 0001 0008 000C 00 01 12 04 11 43 03 00 FF 09 0008 30 41 30 30 30 31 30 41";
    let pdu = session.answer(&hex(info), &plc).unwrap().unwrap();
    assert_eq!(pdu.len(), 10 + 12 + 4 + 78);
    // DB 10 has 100 bytes.
    assert_eq!((pdu[26 + 12], &pdu[26 + 12..26 + 14]), (0, &[0, 10][..]));
    assert_eq!(pdu[26 + 40..26 + 42], [0, 100]);
    let missing = "32 07 0000 0001 0008 000C 00 01 12 04 11 43 03 00 FF 09 0008 30 41 30 30 33 30 30 41";
    assert_eq!(session.answer(&hex(missing), &plc).unwrap().unwrap()[20..22], [0xD2, 0x09]);
}

/// A status list in one piece, without its head; or the error word.
fn status_list(session: &mut Session, plc: &Fake, id: &str, index: &str) -> Result<Vec<u8>, u16> {
    let mut request = format!("32 07 0000 0001 0008 0008 00 01 12 04 11 44 01 00 FF 09 0004 {id} {index}");
    let mut list = Vec::new();
    loop {
        let pdu = session.answer(&hex(&request), plc).unwrap().unwrap();
        match u16::from_be_bytes([pdu[20], pdu[21]]) {
            0 => list.extend(&pdu[26..]),
            error => return Err(error),
        }
        if pdu[19] == 0 {
            let (length, count) = (u16::from_be_bytes([list[4], list[5]]), u16::from_be_bytes([list[6], list[7]]));
            let records = list.split_off(8);
            assert!(id.starts_with("0F") || records.len() == usize::from(length) * usize::from(count), "{id}");
            return Ok(records);
        }
        request = format!("32 07 0000 0001 000C 0004 00 01 12 08 12 44 01 {:02X} 00 00 0000 0A 00 0000", pdu[17]);
    }
}

#[test]
fn list_0000_names_what_is_answered() {
    let plc = Fake::new();
    let mut session = session(&plc);
    let ids = status_list(&mut session, &plc, "0000", "0000").unwrap();
    for id in ids.as_chunks::<2>().0 {
        let id = format!("{:04X}", u16::from_be_bytes(*id));
        // Lists of one record want its index.
        let found = ["0000", "0001", "0004", "0800"].map(|index| status_list(&mut session, &plc, &id, index));
        assert!(found.iter().any(Result::is_ok), "{id}: {found:04X?}");
        assert!(found.iter().flatten().any(|records| !records.is_empty()) != id.starts_with("0F"), "{id}");
    }
    assert_eq!(status_list(&mut session, &plc, "0025", "0001"), Err(0xD401));
    assert_eq!(status_list(&mut session, &plc, "0222", "0050"), Err(0xD402), "OB 80 is not loaded");
    assert_eq!(status_list(&mut session, &plc, "0111", "0003"), Err(0xD402));
}

#[test]
fn status_lists_tell_what_there_is() {
    let plc = Fake::new();
    let mut session = session(&plc);
    let mut list = |id, index| status_list(&mut session, &plc, id, index).unwrap();
    assert_eq!(list("0119", "0004"), hex("0004 01 00"), "RUN is lit");
    assert_eq!(list("0174", "0005"), hex("0005 00 00"), "STOP is not");
    assert_eq!(list("0124", "0000")[..4], hex("4302 FF 68"), "from a warm restart to RUN");
    // Reading and writing once, beginning and ending cyclic reading; 222 bytes at once, 16 jobs from 100 ms to 2,550 s.
    assert_eq!(list("0131", "0003")[..14], hex("0003 47 00 00 00 00DE 0010 0001 639C"));
    assert_eq!(list("0115", "0A00"), hex("0A00 FFFF 0040 FFFFFFFF"), "blocks of 64 KB");
    assert_eq!(list("01A0", "0002").len(), 40);
    assert_eq!(list("0222", "0001"), [0x11; 28]);
    assert_eq!(list("0131", "0002")[..5], hex("0002 04 00 41"), "status of variables, jobs, LEDs");
    assert_eq!(list("0113", "0001")[..24], hex("0001 0001 00010000 0009 0000 00010000 000000A0 0000FF60"));
    assert_eq!(list("0114", "0003"), hex("0003 0001 0080 0010"), "16 bytes of bit memory are retentive");
    assert_eq!(list("0114", "0005"), hex("0005 0001 0080 0008"), "eight counters");
    assert_eq!(list("0114", "0007"), hex("0007 0001 0080 0000"), "local data");
    assert_eq!(list("0091", "0000").len(), 32);
    assert_eq!(list("0C91", "0024"), hex("0001 0400 0024 0000 0000 0000 B502 0001"), "the module with byte 36");
    assert_eq!(list("0D91", "0000"), hex("0000 0400 0000 0000 0000 0000 B402 0001"), "the central rack");
    assert_eq!(status_list(&mut session, &plc, "0D91", "0007"), Err(0xD402));
    assert_eq!(status_list(&mut session, &plc, "0114", "0006"), Err(0xD402));
}

#[test]
fn complete_protection_leaves_the_identification() {
    let plc = Fake { family: Family::S71500, ..Fake::new() };
    let mut session = Session::new(Gate { protection: Protection::Complete, has_password: true, ..ALL });
    session.answer(&hex(SETUP), &plc).unwrap();
    for (id, index) in [("0011", "0000"), ("001C", "0000"), ("0424", "0000"), ("0232", "0004")] {
        assert!(status_list(&mut session, &plc, id, index).is_ok(), "{id}");
    }
    assert_eq!(status_list(&mut session, &plc, "00A0", "0000"), Err(0x8104));
    assert_eq!(status_list(&mut session, &plc, "0222", "0001"), Err(0x8104));
    for request in ["43 01 00 0A 00 0000", "47 01 00 0A 00 0000", "41 10 00 0A 00 0000"] {
        let answer = session.answer(&hex(&format!("32 07 0000 0001 0008 0004 00 01 12 04 11 {request}")), &plc);
        assert_eq!(answer.unwrap().unwrap()[20..22], [0x81, 0x04], "{request}");
    }
}
