//! What needs neither a network nor a CPU: encodings, keys, certificates, names.

use std::path::Path;
use std::time::{Duration, SystemTime};

use plcc_abi::image::AssertType;
use plcc_abi::names::Dimension;
use plcc_runtime::address::Place;
use plcc_runtime::typed::ValueType;
use proptest::prelude::*;
use rsa::RsaPrivateKey;
use rsa::rand_core::OsRng;

use super::certificate::{Client, Own, Trusted};
use super::channel::{Channel, Opening};
use super::code::{NodeId, Reader, Scalar, Variant, Writer, moment_of, time_of};
use super::crypto::{NONCE_BYTES, Policy};
use super::range::Range;
use super::standard::{self, HAS_COMPONENT, ROWS};
use super::status;
use super::values::Variable;
use crate::certificate::is_of;

fn variable(ty: AssertType, length: u16, dimensions: Vec<Dimension>) -> Variable {
    Variable { place: Place::Db(1, 0), bit: 0, ty: ValueType { ty, length }, dimensions, read_only: false }
}

fn written(value: &Variant) -> Vec<u8> {
    let mut out = Writer::default();
    out.variant(value);
    out.0
}

#[test]
fn variants_are_read_as_they_were_written() {
    let values = [
        Variant::Empty,
        Variant::One(Scalar::Int64(-5)),
        Variant::One(Scalar::Text("Ω".to_string())),
        Variant::One(Scalar::Node(NodeId::text(3, "\"a\".\"b\"[1]"))),
        Variant::list(1, vec![Scalar::Bool(true), Scalar::Bool(false)]),
        Variant::Many { ty: 6, values: (0..6).map(Scalar::Int32).collect(), dimensions: vec![2, 3] },
    ];
    for value in values {
        assert_eq!(Reader(&written(&value)).variant(), Some(value.clone()), "{value:?}");
    }
}

#[test]
fn a_length_is_not_believed() {
    // Two thousand million elements, texts and bytes that are not there.
    for bytes in [
        &[0x86, 0xFF, 0xFF, 0xFF, 0x7F, 1][..],
        &[12, 0xFF, 0xFF, 0xFF, 0x7F, 1],
        &[15, 4, 0, 0, 0, 1],
        &[24],
        &[0x98, 1, 0, 0, 0, 0x98],
    ] {
        assert_eq!(Reader(bytes).variant(), None, "{bytes:?}");
    }
}

#[test]
fn times_are_counted_from_1601() {
    assert_eq!(time_of(0), 116_444_736_000_000_000);
    assert_eq!(moment_of(time_of(1_700_000_000_123_456_700)), Some(1_700_000_000_123_456_700));
    assert_eq!(moment_of(i64::MIN), None);
}

#[test]
fn arrays_with_gaps_keep_their_order() {
    // ARRAY[0..1, 1..3] OF BYTE: a row begins at a word.
    let dimensions = vec![Dimension { low: 0, high: 1, distance: 32 }, Dimension { low: 1, high: 3, distance: 8 }];
    let bytes = variable(AssertType::Bits(8), 0, dimensions);
    assert_eq!(bytes.bytes(), Ok(7));
    let Ok(Variant::Many { values, dimensions, .. }) = bytes.value(&[1, 2, 3, 9, 4, 5, 6]) else { panic!("an array") };
    assert_eq!(values, (1..=6).map(Scalar::Byte).collect::<Vec<_>>());
    assert_eq!(dimensions, [2, 3]);
    // Bits.
    let bits = variable(AssertType::Bool, 0, vec![Dimension { low: -1, high: 8, distance: 1 }]);
    assert_eq!(bits.bytes(), Ok(2));
    let Ok(Variant::Many { values, .. }) = bits.value(&[0b1000_0001, 0b10]) else { panic!("an array") };
    let expected = [true, false, false, false, false, false, false, true, false, true];
    assert_eq!(values, expected.map(Scalar::Bool).to_vec());
}

#[test]
fn an_array_can_be_too_long_or_empty() {
    let long = variable(AssertType::Bool, 0, vec![Dimension { low: 0, high: 70_000, distance: 1 }]);
    assert_eq!(long.bytes(), Err(status::NOT_READABLE));
    let huge = vec![Dimension { low: i32::MIN, high: i32::MAX, distance: u32::MAX }; 4];
    assert_eq!(variable(AssertType::Bool, 0, huge).bytes(), Err(status::NOT_READABLE));
    let empty = variable(AssertType::Signed(16), 0, vec![Dimension { low: 1, high: 0, distance: 16 }]);
    assert_eq!(empty.value(&[0, 0]), Ok(Variant::Many { ty: 4, values: Vec::new(), dimensions: vec![0] }));
}

#[test]
fn a_text_is_not_longer_than_its_type() {
    // A program may have written any head.
    let text = variable(AssertType::Text, 3, Vec::new());
    assert_eq!(text.value(&[254, 200, b'a', b'b', b'c']), Ok(Variant::One(Scalar::Text("abc".to_string()))));
    assert_eq!(text.value(&[3, 1, 0x80, b'b', b'c']), Ok(Variant::One(Scalar::Text("€".to_string()))));
    assert_eq!(text.parts(&Variant::One(Scalar::Text("abcd".to_string())), None), Err(status::OUT_OF_RANGE));
}

#[test]
fn arrays_of_bytes_are_written_as_byte_strings_too() {
    let row = |ty| variable(ty, 0, vec![Dimension { low: 1, high: 3, distance: 8 }]);
    let text = |bytes: &[u8]| Variant::One(Scalar::Bytes(bytes.to_vec()));
    let list = Variant::list(3, vec![Scalar::Byte(7), Scalar::Byte(8), Scalar::Byte(9)]);
    let bytes = row(AssertType::Bits(8));
    assert!(bytes.parts(&list, None).is_ok());
    assert_eq!(bytes.parts(&text(&[7, 8, 9]), None), bytes.parts(&list, None));
    let part = Range::parse("1:2").unwrap();
    let two = Variant::list(3, vec![Scalar::Byte(8), Scalar::Byte(9)]);
    assert_eq!(bytes.parts(&text(&[8, 9]), part.as_ref()), bytes.parts(&two, part.as_ref()));
    assert_eq!(bytes.parts(&text(&[7, 8]), None), Err(status::TYPE_MISMATCH));
    assert_eq!(row(AssertType::Signed(8)).parts(&text(&[7, 8, 9]), None), Err(status::TYPE_MISMATCH));
    let one = variable(AssertType::Bits(8), 0, Vec::new());
    assert_eq!(one.parts(&text(&[7]), None), Err(status::TYPE_MISMATCH), "no array");
}

#[test]
fn wrong_dates_are_bad_values() {
    assert_eq!(variable(AssertType::DateAndTime, 0, Vec::new()).value(&[0; 8]), Err(status::OUT_OF_RANGE));
    assert_eq!(variable(AssertType::Dtl, 0, Vec::new()).value(&[0; 12]), Err(status::OUT_OF_RANGE));
    assert_eq!(variable(AssertType::Dtl, 0, Vec::new()).value(&[0xFF; 12]), Err(status::OUT_OF_RANGE));
}

#[test]
fn standard_nodes_are_below_each_other() {
    for (index, row) in ROWS.iter().enumerate() {
        assert!(ROWS[..index].iter().all(|other| other.id != row.id), "{} is there twice", row.id);
        assert!(row.parent == 0 || ROWS[..index].iter().any(|other| other.id == row.parent), "{}", row.name);
        assert!(row.definition == 0 || standard::row(row.definition).is_some(), "{}", row.name);
        assert!(row.value == 0 || standard::row(row.value).is_some(), "{}", row.name);
    }
    assert!(standard::is_kind_of(HAS_COMPONENT, 33, true) && !standard::is_kind_of(HAS_COMPONENT, 33, false));
    assert!(!standard::is_kind_of(40, 33, true));
}

#[test]
fn a_certificate_is_made_once() {
    let folder = std::env::temp_dir().join(format!("plcc-opcua-{}", std::process::id()));
    let load = || Own::load(&folder, "urn:plcc:a", "a", [127, 0, 0, 1].into());
    // Programs that start at once have the same one.
    let [first, second] = std::thread::scope(|scope| {
        [scope.spawn(load), scope.spawn(load)].map(|started| started.join().expect("no panic").expect("it can be made"))
    });
    assert_eq!(first.certificate, second.certificate);
    assert_eq!(load().map(|own| own.certificate), Ok(first.certificate.clone()));
    assert!(is_of(&first.certificate, "urn:plcc:a") && !is_of(&first.certificate, "urn:plcc:b"));
    // A chain begins with it.
    let chain = [&first.certificate[..], &[1, 2, 3]].concat();
    assert_eq!(Client::parse(&chain).map(|client| client.der), Some(first.certificate.clone()));
    only_trusted_clients_come_in(&folder, &first);
    // A key of somebody else.
    std::fs::write(folder.join("own.pem"), "nothing").expect("a file of this test");
    assert!(load().is_err_and(|error| error.contains("own.pem") && !error.contains("nothing")));
    std::fs::remove_dir_all(&folder).expect("a folder of this test");
    channels_open(&first);
}

/// The folder has a certificate for twenty years.
fn only_trusted_clients_come_in(folder: &Path, own: &Own) {
    assert!(Trusted::load(folder).expect("a folder of this test").is_none());
    std::fs::create_dir(folder.join("trusted")).expect("a folder of this test");
    let load = || Trusted::load(folder).expect("a folder of this test").expect("it is there");
    let client = Client::parse(&own.certificate).expect("a certificate");
    let (now, year) = (SystemTime::now(), Duration::from_secs(365 * 24 * 3600));
    assert_eq!(load().check(&client, now), Err(status::CERTIFICATE_UNTRUSTED));
    std::fs::write(folder.join("trusted/client.der"), &own.certificate).expect("a file of this test");
    let trusted = load();
    for moment in [now, now + 19 * year] {
        assert_eq!(trusted.check(&client, moment), Ok(()));
    }
    for moment in [now - year, now + 21 * year, SystemTime::UNIX_EPOCH - year] {
        assert_eq!(trusted.check(&client, moment), Err(status::CERTIFICATE_TIME_INVALID));
    }
}

/// What a client does to open a channel, and what this server answers. Only bits of it may be wrong.
fn channels_open(own: &Own) {
    let own_client = Client::parse(&own.certificate).expect("a certificate");
    for policy in [Policy::Basic256Sha256, Policy::Aes128Sha256RsaOaep, Policy::Aes256Sha256RsaPss] {
        // Client and server have the same key here.
        let mut client = channel(policy, &own_client);
        let frame = client.write_opening(7, b"a request", own).expect("it can be written");
        let opening = Opening::read(&frame, own).expect("it can be read");
        assert_eq!((opening.request, opening.body.as_slice()), (7, &b"a request"[..]));
        // Everything is signed, the head too; to look at each byte would take too long.
        for at in (0..frame.len()).step_by(61) {
            let mut wrong = frame.clone();
            wrong[at] ^= 0x10;
            assert!(Opening::read(&wrong, own).is_err(), "{policy:?}: byte {at} may be changed");
        }
        for cut in [0, 8, 12, 100, frame.len() - 256, frame.len() - 1] {
            assert!(Opening::read(&frame[..cut], own).is_err(), "{cut}");
        }
    }
}

fn channel(policy: Policy, client: &Client) -> Channel {
    let opening = Opening::of_test(policy, client.clone());
    Channel::open(&opening, None, false, 3, &[1; NONCE_BYTES], 60_000).expect("a channel").0
}

#[test]
fn a_channel_reads_what_was_not_changed_and_in_order() {
    let key = RsaPrivateKey::new(&mut OsRng, 2048).expect("a key");
    let client = Client { der: vec![1], key: key.to_public_key(), valid: Duration::ZERO..=Duration::MAX };
    for policy in [Policy::Basic256Sha256, Policy::Aes128Sha256RsaOaep] {
        let mut writer = channel(policy, &client);
        let mut reader = channel(policy, &client);
        Channel::share(&mut writer, &mut reader);
        for length in [1, 15, 16, 17, 40_000] {
            let body = vec![7; length];
            let mut frame = writer.write(9, &body, 65_536).expect("a frame");
            let mut wrong = frame.clone();
            let middle = wrong.len() / 2;
            wrong[middle] ^= 1;
            assert!(reader.read(&mut wrong).is_err());
            let mut again = frame.clone();
            let chunk = reader.read(&mut frame).expect("nothing is wrong");
            assert_eq!((chunk.request, chunk.body), (9, body));
            assert_eq!(reader.read(&mut again).err(), Some(status::SEQUENCE_INVALID), "a frame is taken once");
            Channel::restart(&mut writer, &mut reader);
        }
    }
}

proptest! {
    #[test]
    fn nothing_that_a_reader_gets_panics(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = Reader(&bytes).variant();
        let _ = Reader(&bytes).data_value();
        let _ = Reader(&bytes).node();
        let _ = Reader(&bytes).object();
        let _ = Client::parse(&bytes);
    }
}
