//! Variables that a client gets again and again, or once for a watch table.

use std::time::{Duration, Instant};

use plcc_abi::services::Protection;

use super::{ALL, CLEAR_PASSWORD, SET_PASSWORD, SETUP, exchange, hex, session};
use crate::s7::Fake;
use crate::s7::plc::Family;
use crate::s7::session::{Gate, Session};

#[test]
fn subscribed_variables_come_again() {
    let plc = Fake::new();
    let mut session = session(&plc);
    let began = Instant::now();
    // DB10.DBB4, three bytes, every 200 ms: job 1. M5.3 on change, looked at every 100 ms: job 2.
    exchange(
        &plc,
        &mut session,
        "32 07 0000 0002 0008 0014 00 01 12 04 11 42 01 00 FF 09 0010 00 01 00 02 12 0A 10 02 0003 000A 84 000020",
        "32 07 0000 0002 000C 000D 00 01 12 08 12 82 01 01 00 00 0000 FF 09 0009 00 01 FF 04 0018 112233",
    );
    exchange(
        &plc,
        &mut session,
        "32 07 0000 0003 0008 0014 00 01 12 04 11 42 05 00 FF 09 0010 00 01 00 01 12 0A 10 01 0001 0000 83 00002B",
        "32 07 0000 0003 000C 000B 00 01 12 08 12 82 05 02 00 00 0000 FF 09 0007 00 01 FF 03 0001 01",
    );
    let ms = |ms| began + Duration::from_millis(ms);
    assert!(session.due().is_some_and(|due| due >= ms(100)));
    assert_eq!(session.indications(&plc, ms(50)), Vec::<Vec<u8>>::new());
    plc.db.borrow_mut()[4] = 0x44;
    let cyclic = hex("32 07 0000 0000 000C 000D 00 01 12 08 12 02 01 01 00 00 0000 FF 09 0009 00 01 FF 04 0018 442233");
    assert_eq!(session.indications(&plc, ms(1000)), std::slice::from_ref(&cyclic), "M5.3 has not changed");
    plc.memory.borrow_mut()[5] = 0;
    let changed = hex("32 07 0000 0000 000C 000B 00 01 12 08 12 02 05 02 00 00 0000 FF 09 0007 00 01 FF 03 0001 00");
    assert_eq!(session.indications(&plc, ms(1150)), [changed]);
    assert_eq!(session.indications(&plc, ms(2000)), [cyclic], "once, however late");
    let unsubscribe = |job: &str| format!("32 07 0000 0004 0008 0006 00 01 12 04 11 42 04 00 FF 09 0002 {job}");
    exchange(
        &plc,
        &mut session,
        &unsubscribe("05 02"),
        "32 07 0000 0004 000C 0004 00 01 12 08 12 82 04 03 00 00 0000 0A 00 0000",
    );
    exchange(
        &plc,
        &mut session,
        &unsubscribe("05 02"),
        "32 07 0000 0004 000C 0004 00 01 12 08 12 82 04 04 00 00 D802 0A 00 0000",
    );
    session.answer(&hex(SETUP), &plc).unwrap();
    assert_eq!(session.due(), None, "they end with the setup");
}

/// A request for the status of variables with this trigger: its error word and answer.
fn watch(session: &mut Session, plc: &Fake, trigger: &str, variables: &str) -> (u16, Vec<u8>) {
    let mut rest = hex(variables);
    let mut payload = hex("0014 0000");
    payload[3] = rest.len() as u8;
    payload.extend(hex(trigger));
    payload.extend([0; 18]);
    payload.append(&mut rest);
    let mut request = hex("32 07 0000 0007 0008 0000 00 01 12 04 11 41 02 00 FF 09 0000");
    request[9] = payload.len() as u8 + 4;
    request[21] = payload.len() as u8;
    request.extend(payload);
    let answer = session.answer(&request, plc).unwrap().unwrap();
    (u16::from_be_bytes([answer[20], answer[21]]), answer)
}

#[test]
fn a_watch_table_gets_its_values_once() {
    let plc = Fake::new();
    let mut session = session(&plc);
    assert_eq!(session.due(), None);
    // M5.3, DB10.DBB4 three times, T 1, DB99.DBW0.
    let variables = "0004 00 03 0000 0005 71 03 000A 0004 54 01 0000 0001 72 01 0063 0000";
    let (error, answer) = watch(&mut session, &plc, "0000", variables);
    assert_eq!(error, 0);
    assert_eq!(
        answer,
        hex("32 07 0000 0007 000C 000C 00 01 12 08 12 81 02 01 00 00 0000 FF 09 0008 0004 0000 00000000")
    );
    let now = Instant::now();
    assert!(session.due().is_some_and(|due| due <= now + Duration::from_secs(1)));
    let values = "32 07 0000 0000 000C 0026 00 01 12 08 12 01 02 01 00 00 0000 FF 09 0022 0004 001A 00000000 \
                  0004 FF 03 0001 01 00 FF 04 0018 112233 00 FF 09 0002 0000 0A 00 0000";
    assert_eq!(session.indications(&plc, now), [hex(values)]);
    assert_eq!((session.due(), session.indications(&plc, now)), (None, Vec::new()));
}

#[test]
fn wrong_requests_of_a_watch_table_have_error_words() {
    let plc = Fake::new();
    let mut own = session(&plc);
    let byte = "0001 01 01 0000 0000";
    for (trigger, variables, expected) in [
        ("0100", byte, 0xD003),
        ("0000", "0000", 0x8500),
        ("0000", "0002 01 01 0000 0000", 0x8500),
        ("0000", "0001 01 01 0000 0000 00", 0x8500),
        ("0000", "0001 91 01 0000 0000", 0xD042),
        ("0000", "0001 00 08 0000 0000", 0xD042),
        ("0000", "0001 51 01 0000 0000", 0xD042),
        ("0000", "0001 73 FF 000A 0000", 0x8500),
    ] {
        assert_eq!(watch(&mut own, &plc, trigger, variables).0, expected, "{trigger} {variables}");
    }
    for _ in 0..16 {
        assert_eq!(watch(&mut own, &plc, "0000", byte).0, 0);
    }
    assert_eq!(watch(&mut own, &plc, "0000", byte).0, 0x8302);
    own.answer(&hex(SETUP), &plc).unwrap();
    assert_eq!(own.due(), None, "jobs end with the setup");
    let portal = Fake { family: Family::S71200, ..Fake::new() };
    assert_eq!(watch(&mut session(&portal), &portal, "0000", byte).0, 0xD003);
}

#[test]
fn subscriptions_end_with_the_right_to_read() {
    let plc = Fake { family: Family::S71500, ..Fake::new() };
    let mut session = Session::new(Gate { protection: Protection::Complete, has_password: true, ..ALL });
    session.answer(&hex(SETUP), &plc).unwrap();
    session.judge(true);
    session.answer(&hex(SET_PASSWORD), &plc).unwrap();
    let subscribe =
        "32 07 0000 0002 0008 0014 00 01 12 04 11 42 01 00 FF 09 0010 00 01 00 01 12 0A 10 02 0001 0000 83 000000";
    assert_eq!(session.answer(&hex(subscribe), &plc).unwrap().unwrap()[20..22], [0, 0]);
    assert!(session.due().is_some());
    session.answer(&hex(CLEAR_PASSWORD), &plc).unwrap();
    let later = Instant::now() + Duration::from_secs(1);
    assert_eq!(session.indications(&plc, later), Vec::<Vec<u8>>::new());
    assert_eq!(session.due(), None, "else it would be due at every moment");
}

#[test]
fn wrong_subscriptions_have_error_words() {
    let plc = Fake::new();
    let mut session = session(&plc);
    let item = "12 0A 10 02 0003 000A 84 000020";
    let mut ask = |payload: &str| {
        let payload = hex(payload);
        let mut request = hex("32 07 0000 0002 0008 0000 00 01 12 04 11 42 01 00 FF 09 0000");
        request[9] = payload.len() as u8 + 4;
        let at = request.len() - 1;
        request[at] = payload.len() as u8;
        request.extend(payload);
        let answer = session.answer(&request, &plc).unwrap().unwrap();
        u16::from_be_bytes([answer[20], answer[21]])
    };
    assert_eq!(ask("00 01 00 00 ".to_string().as_str()), 0xD804);
    assert_eq!(ask(&format!("00 01 03 01 {item}")), 0xD804);
    assert_eq!(ask("00 00 00 01"), 0xD801);
    assert_eq!(ask(&format!("00 02 00 01 {item}")), 0xD801);
    assert_eq!(ask("00 01 00 01 12 0A 10 02 00FF 0001 84 000000"), 0xD801, "longer than a PDU");
    for _ in 0..16 {
        assert_eq!(ask(&format!("00 01 00 01 {item}")), 0);
    }
    assert_eq!(ask(&format!("00 01 00 01 {item}")), 0xD805);
}
