use super::*;
use plcc_abi::connections::S7Connection;
use plcc_runtime::partners::{Arrived, BYTES, Kind, Receive, Slot, State};

const NOW: fn() -> Instant = Instant::now;

fn setting(pdu: u16) -> (Arc<Board>, Partner) {
    let connection =
        S7Connection { id: 1, partner: None, active: false, local_tsap: vec![0x10, 1], remote_tsap: Vec::new() };
    let board = Arc::new(Board::new(vec![connection]));
    let partner = Partner::new(board.clone(), 0, pdu, 8, || {});
    (board, partner)
}

fn bytes(db: u16, start: u32, count: u16) -> Remote {
    Remote { transport: BYTES, count, db, area: 0x84, address: 8 * start }
}

fn ended(board: &Board, job: u32) -> State {
    board.exchange();
    board.take(job)
}

#[test]
fn get_as_bytes() {
    let (board, mut partner) = setting(240);
    let bit = Remote { transport: BIT, count: 1, db: 0, area: 0x83, address: 43 };
    let job = board.start(1, Work::Read(vec![bytes(10, 4, 3), bit])).unwrap();
    let expected = [
        0x32, 1, 0, 0, 0, 1, 0, 26, 0, 0, 4, 2, 0x12, 10, 0x10, 2, 0, 3, 0, 10, 0x84, 0, 0, 0x20, 0x12, 10, 0x10, 1, 0,
        1, 0, 0, 0x83, 0, 0, 0x2B,
    ];
    assert_eq!(partner.work(NOW()), Ok(vec![expected.to_vec()]));
    let answer = [0x32, 3, 0, 0, 0, 1, 0, 2, 0, 13, 0, 0, 4, 2, 0xFF, 4, 0, 24, 0x11, 0x22, 0x33, 0, 0xFF, 3, 0, 1, 1];
    assert_eq!(partner.take(&answer, NOW()), Ok(Taken::Own(Vec::new())));
    assert_eq!(ended(&board, job), State::Ended(Ok(vec![vec![0x11, 0x22, 0x33], vec![1]])));
    // The same answer again is for nobody.
    assert_eq!(partner.take(&answer, NOW()), Ok(Taken::Own(Vec::new())));
}

#[test]
fn put_as_bytes() {
    let (board, mut partner) = setting(240);
    let bit = Remote { transport: BIT, count: 1, db: 0, area: 0x82, address: 2 };
    let on = Data { is_bit: true, bytes: vec![1] };
    let word = Data { is_bit: false, bytes: vec![0x12, 0x34] };
    let job = board.start(1, Work::Write(vec![(bit, on), (bytes(99, 0, 2), word)])).unwrap();
    let expected = [
        0x32, 1, 0, 0, 0, 1, 0, 26, 0, 12, 5, 2, 0x12, 10, 0x10, 1, 0, 1, 0, 0, 0x82, 0, 0, 2, 0x12, 10, 0x10, 2, 0, 2,
        0, 99, 0x84, 0, 0, 0, 0, 3, 0, 1, 1, 0, 0, 4, 0, 16, 0x12, 0x34,
    ];
    assert_eq!(partner.work(NOW()), Ok(vec![expected.to_vec()]));
    partner.take(&[0x32, 3, 0, 0, 0, 1, 0, 2, 0, 2, 0, 0, 5, 2, 0xFF, 0x0A], NOW()).unwrap();
    assert_eq!(ended(&board, job), State::Ended(Err(status::ACCESS)));
}

#[test]
fn what_does_not_fit_a_pdu_is_an_error() {
    let (board, mut partner) = setting(240);
    let data = |count| Data { is_bit: false, bytes: vec![0; count] };
    let mut ends = Vec::new();
    for work in [
        Work::Read(vec![bytes(1, 0, 222)]),
        Work::Read(vec![bytes(1, 0, 223)]),
        Work::Write(vec![(bytes(1, 0, 212), data(212))]),
        Work::Write(vec![(bytes(1, 0, 213), data(213))]),
        Work::Message(1, vec![data(212)]),
        Work::Message(1, vec![data(213)]),
    ] {
        let job = board.start(1, work).unwrap();
        let sent = partner.work(NOW()).unwrap();
        assert!(sent.iter().all(|pdu| pdu.len() <= 240));
        ends.push((sent.len(), ended(&board, job)));
    }
    let wrong = (0, State::Ended(Err(status::AREA)));
    let running = (1, State::Running);
    let sent = (1, State::Ended(Ok(Vec::new())));
    assert_eq!(ends, [running.clone(), wrong.clone(), running, wrong.clone(), sent, wrong]);
}

#[test]
fn refusals_become_status() {
    let (board, mut partner) = setting(240);
    for (answer, code) in [
        (&[0x32, 2, 0, 0, 0, 1, 0, 0, 0, 0, 0x81, 4][..], status::REFUSED),
        (&[0x32, 3, 0, 0, 0, 2, 0, 2, 0, 4, 0, 0, 4, 1, 0x0A, 0, 0, 0], status::ACCESS),
        (&[0x32, 3, 0, 0, 0, 3, 0, 2, 0, 4, 0, 0, 4, 1, 7, 0, 0, 0], status::AREA),
        (&[0x32, 3, 0, 0, 0, 4, 0, 2, 0, 5, 0, 0, 4, 1, 0xFF, 4, 0, 8, 9], status::REFUSED),
        (&[0x32, 3, 0, 0, 0, 5, 0, 2, 0, 0, 0, 0, 4, 1], status::REFUSED),
        (&[0x32, 3, 0, 0, 0, 6, 0, 2, 0, 5, 0, 0, 4, 2, 0xFF, 4, 0, 8, 9], status::REFUSED),
    ] {
        let job = board.start(1, Work::Read(vec![bytes(1, 0, 2)])).unwrap();
        partner.work(NOW()).unwrap();
        partner.take(answer, NOW()).unwrap();
        assert_eq!(ended(&board, job), State::Ended(Err(code)), "{answer:?}");
    }
}

#[test]
fn late_answers_end_the_connection() {
    let (board, mut partner) = setting(240);
    let job = board.start(1, Work::Read(vec![bytes(1, 0, 2)])).unwrap();
    partner.work(NOW()).unwrap();
    assert_eq!(partner.work(NOW() + PARTNER_TIME), Err(Broken));
    drop(partner);
    assert_eq!(ended(&board, job), State::Ended(Err(status::NO_CONNECTION)));
}

/// Carries PDUs from one to the other until both are silent.
fn carry(from: &mut Partner, to: &mut Partner) {
    let mut pdus = from.work(NOW()).unwrap();
    for _ in 0..2000 {
        let mut answers = Vec::new();
        for pdu in pdus {
            assert!(pdu.len() <= 240);
            match to.take(&pdu, NOW()).unwrap() {
                Taken::Own(own) => answers.extend(own),
                Taken::Request => panic!("not a request"),
            }
        }
        pdus = Vec::new();
        for pdu in &answers {
            if let Taken::Own(own) = from.take(pdu, NOW()).unwrap() {
                pdus.extend(own);
            }
        }
        if pdus.is_empty() {
            return;
        }
    }
    panic!("it does not end");
}

#[test]
fn blocks_and_messages_from_one_to_the_other() {
    let ((board, mut one), (far, mut other)) = (setting(240), setting(240));
    let ready = Receive { enabled: true, room: 65534 };
    let slot = |kind| Slot { kind, r_id: 7, handle: 0 };
    let (handle, _) = far.receive(1, slot(Kind::Block), &ready);
    let (second, _) = far.receive(1, slot(Kind::Message), &ready);
    for length in [1, 203, 204, 205, 410, 65534] {
        let block: Vec<u8> = (0..length).map(|at| (at % 251) as u8).collect();
        let job = board.start(1, Work::Block(7, block.clone())).unwrap();
        carry(&mut one, &mut other);
        assert_eq!(ended(&board, job), State::Ended(Ok(Vec::new())), "{length}");
        far.exchange();
        let all = Arrived::All { areas: vec![block], overwritten: false };
        assert_eq!(far.receive(1, Slot { handle, ..slot(Kind::Block) }, &ready).1, Ok(all), "{length}");
    }
    let data = |bytes: &[u8], is_bit| Data { is_bit, bytes: bytes.to_vec() };
    let areas = vec![data(&[1, 2, 3], false), data(&[1], true), data(&[4, 5], false)];
    let job = board.start(1, Work::Message(7, areas)).unwrap();
    carry(&mut one, &mut other);
    assert_eq!(ended(&board, job), State::Ended(Ok(Vec::new())));
    far.exchange();
    let all = Arrived::All { areas: vec![vec![1, 2, 3], vec![1], vec![4, 5]], overwritten: false };
    assert_eq!(far.receive(1, Slot { handle: second, ..slot(Kind::Message) }, &ready).1, Ok(all));
}

#[test]
fn a_block_that_is_not_taken_has_a_status() {
    let ((board, mut one), (far, mut other)) = (setting(240), setting(240));
    let mut send = |far: &Board, wanted: u16| {
        let job = board.start(1, Work::Block(7, vec![1; 300])).unwrap();
        carry(&mut one, &mut other);
        let _ = far;
        assert_eq!(ended(&board, job), State::Ended(Err(wanted)));
    };
    send(&far, status::R_ID_UNKNOWN);
    let slot = Slot { kind: Kind::Block, r_id: 7, handle: 0 };
    let (handle, _) = far.receive(1, slot, &Receive { enabled: false, room: 400 });
    send(&far, status::DISABLED);
    let slot = Slot { handle, ..slot };
    assert_eq!(far.receive(1, slot, &Receive { enabled: true, room: 200 }).1, Ok(Arrived::Nothing));
    send(&far, status::ACCESS);
    assert_eq!(far.receive(1, slot, &Receive { enabled: true, room: 400 }).1, Ok(Arrived::Nothing));
    far.end_block(0, 7, vec![1]).unwrap();
    send(&far, status::NOT_TAKEN);
}

#[test]
fn a_block_as_bytes() {
    let (board, mut partner) = setting(240);
    partner.reference = 6;
    let job = board.start(1, Work::Block(1, vec![0xDE, 0xAD, 0xBE, 0xEF])).unwrap();
    let expected = [
        0x32, 7, 0, 0, 0, 7, 0, 12, 0, 18, 0, 1, 0x12, 8, 0x12, 0x46, 1, 0, 0, 0, 0, 0, 0xFF, 9, 0, 14, 0x12, 6, 0x13,
        0, 0, 0, 0, 1, 0, 4, 0xDE, 0xAD, 0xBE, 0xEF,
    ];
    assert_eq!(partner.work(NOW()), Ok(vec![expected.to_vec()]));
    let answer = [0x32, 7, 0, 0, 0, 7, 0, 12, 0, 4, 0, 1, 0x12, 8, 0x12, 0x86, 1, 1, 0, 0, 0, 0, 0x0A, 0, 0, 0];
    assert_eq!(partner.take(&answer, NOW()), Ok(Taken::Own(Vec::new())));
    assert_eq!(ended(&board, job), State::Ended(Ok(Vec::new())));
}

#[test]
fn segments_that_do_not_fit_are_refused() {
    let (board, mut partner) = setting(240);
    let slot = Slot { kind: Kind::Block, r_id: 1, handle: 0 };
    assert_eq!(board.receive(1, slot, &Receive { enabled: true, room: 100 }).1, Ok(Arrived::Nothing));
    let mut error = |sequence: u8, last: bool, payload: &[u8]| {
        let parameter = [0, 1, 0x12, 8, 0x12, 0x46, 1, sequence, 1, u8::from(!last), 0, 0];
        let mut data = vec![0xFF, 9];
        put16(&mut data, payload.len() as u16);
        data.extend(payload);
        match partner.take(&userdata([0, 9], &parameter, &data), NOW()) {
            Ok(Taken::Own(answers)) => u16::from_be_bytes([answers[0][20], answers[0][21]]),
            other => panic!("{other:?}"),
        }
    };
    let head = [0x12, 6, 0x13, 0, 0, 0, 0, 1];
    assert_eq!(error(0, true, &head), WRONG_LENGTH);
    assert_eq!(error(0, true, &head[..5]), WRONG_LENGTH);
    assert_eq!(error(0, true, &[&head[..], &[0, 4, 1, 2, 3]].concat()), WRONG_LENGTH, "too few");
    assert_eq!(error(0, true, &[&head[..], &[0, 2, 1, 2, 3]].concat()), WRONG_LENGTH, "too many");
    assert_eq!(error(0, true, &[&head[..], &[0, 200, 1]].concat()), TOO_LONG);
    assert_eq!(error(5, true, &[&head[..], &[1]].concat()), WRONG_STATE, "nothing began");
    assert_eq!(error(0, false, &[&head[..], &[0, 4, 1, 2]].concat()), 0);
    assert_eq!(error(9, true, &[&head[..], &[3, 4]].concat()), WRONG_STATE, "of another one");
}

#[test]
fn a_block_that_does_not_go_on_is_forgotten() {
    let ((board, mut one), (far, mut other)) = (setting(240), setting(240));
    let ready = Receive { enabled: true, room: 1000 };
    let slot = Slot { kind: Kind::Block, r_id: 7, handle: 0 };
    let (handle, _) = far.receive(1, slot, &ready);
    let slot = Slot { handle, ..slot };
    board.start(1, Work::Block(7, vec![1; 500])).unwrap();
    let first = one.work(NOW()).unwrap().remove(0);
    other.take(&first, NOW()).unwrap();
    assert_eq!(far.receive(1, slot, &ready).1, Ok(Arrived::Some));
    assert_eq!(other.work(NOW() + PARTNER_TIME), Ok(Vec::new()));
    assert_eq!(far.receive(1, slot, &ready).1, Ok(Arrived::Nothing));
    other.take(&first, NOW()).unwrap();
    assert_eq!(far.receive(1, slot, &ready).1, Ok(Arrived::Some), "another one may begin");
}

#[test]
fn random_and_changed_answers_do_no_harm() {
    let mut state = 1u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let right: [&[u8]; 6] = [
        &[0x32, 3, 0, 0, 0, 1, 0, 2, 0, 13, 0, 0, 4, 2, 0xFF, 4, 0, 24, 0x11, 0x22, 0x33, 0, 0xFF, 3, 0, 1, 1],
        &[0x32, 3, 0, 0, 0, 2, 0, 2, 0, 1, 0, 0, 5, 1, 0xFF],
        &[0x32, 2, 0, 0, 0, 1, 0, 0, 0, 0, 0x81, 4],
        &[0x32, 7, 0, 0, 0, 8, 0, 10, 0, 12, 0, 1, 0x12, 6, 0x13, 0, 0, 0, 0, 7, 0xFF, 0, 0, 1, 0, 9, 0, 4, 1, 2, 3, 4],
        &[
            0x32, 7, 0, 0, 0, 7, 0, 12, 0, 18, 0, 1, 0x12, 8, 0x12, 0x46, 1, 0, 1, 0, 0, 0, 0xFF, 9, 0, 14, 0x12, 6,
            0x13, 0, 0, 0, 0, 7, 0, 9, 1, 2, 3, 4,
        ],
        &[0x32, 7, 0, 0, 0, 3, 0, 12, 0, 4, 0, 1, 0x12, 8, 0x12, 0x86, 1, 1, 0, 0, 0, 0, 0x0A, 0, 0, 0],
    ];
    let (mut broken, mut own) = (0, 0);
    for _ in 0..300 {
        let (board, mut partner) = setting(240);
        for kind in [Kind::Block, Kind::Message] {
            let ready = Receive { enabled: true, room: 100 };
            assert_eq!(board.receive(1, Slot { kind, r_id: 7, handle: 0 }, &ready).1, Ok(Arrived::Nothing));
        }
        let data = Data { is_bit: false, bytes: vec![1, 2] };
        for work in [
            Work::Read(vec![bytes(10, 4, 3), Remote { transport: BIT, count: 1, db: 0, area: 0x83, address: 43 }]),
            Work::Write(vec![(bytes(1, 0, 2), data)]),
            Work::Block(7, vec![0; 1000]),
        ] {
            board.start(1, work).unwrap();
        }
        partner.work(NOW()).unwrap();
        for _ in 0..70 {
            let mut pdu = right[random(right.len())].to_vec();
            for _ in 0..random(4) {
                let at = random(pdu.len());
                pdu[at] = random(256) as u8;
            }
            if random(10) == 0 {
                pdu.truncate(random(pdu.len()));
            }
            match partner.take(&pdu, NOW()) {
                Ok(Taken::Own(answers)) => {
                    own += 1;
                    assert!(answers.len() <= 1 && answers.iter().all(|pdu| pdu.len() <= 240));
                }
                Ok(Taken::Request) => {}
                Err(Broken) => broken += 1,
            }
        }
        board.exchange();
    }
    assert!(broken > 1000 && own > 1000, "{broken} {own}");
}
