use super::*;

fn board() -> Board {
    let connection =
        |id| S7Connection { id, partner: None, active: false, local_tsap: vec![0x10, 1], remote_tsap: Vec::new() };
    Board::new(vec![connection(1), connection(0x100)])
}

const READY: Receive = Receive { enabled: true, room: 10 };

fn slot(kind: Kind, handle: u32) -> Slot {
    Slot { kind, r_id: 7, handle }
}

#[test]
fn a_job_needs_a_connection_that_is_up() {
    let board = board();
    assert_eq!(board.start(2, Work::Read(Vec::new())), Err(status::NO_CONNECTION));
    assert_eq!(board.start(1, Work::Read(Vec::new())), Err(status::NO_CONNECTION));
    let turn = board.join(0, Box::new(|| {}));
    let job = board.start(1, Work::Block(7, vec![1])).unwrap();
    assert_eq!(board.next(0, turn), Some((job, Work::Block(7, vec![1]))));
    assert_eq!(board.next(0, turn), None);
    board.leave(0, turn);
    assert_eq!(board.take(job), State::Running, "the end shows after the cycle control point");
    board.exchange();
    assert_eq!(board.take(job), State::Ended(Err(status::NO_CONNECTION)));
}

#[test]
fn an_end_shows_once_and_after_the_cycle() {
    let board = board();
    let turn = board.join(1, Box::new(|| {}));
    let job = board.start(0x100, Work::Read(Vec::new())).unwrap();
    board.next(1, turn);
    board.finish(job, Ok(vec![vec![5]]));
    assert_eq!(board.take(job), State::Running);
    board.exchange();
    assert_eq!(board.take(job), State::Ended(Ok(vec![vec![5]])));
    assert_eq!(board.take(job), State::Ended(Err(status::NO_CONNECTION)), "there is no such job any more");
}

#[test]
fn a_newer_connection_takes_over() {
    let board = board();
    let first = board.join(0, Box::new(|| {}));
    let job = board.start(1, Work::Read(Vec::new())).unwrap();
    let second = board.join(0, Box::new(|| {}));
    board.leave(0, first);
    assert!(board.is_current(0, second) && !board.is_current(0, first));
    board.exchange();
    assert_eq!(board.take(job), State::Ended(Err(status::NO_CONNECTION)));
    assert!(board.start(1, Work::Read(Vec::new())).is_ok(), "the second one is up");
}

#[test]
fn jobs_that_nobody_takes_make_room() {
    let board = board();
    board.join(0, Box::new(|| {}));
    let jobs: Vec<u32> = (0..JOBS_MAX).map(|_| board.start(1, Work::Read(Vec::new())).unwrap()).collect();
    assert_eq!(board.start(1, Work::Read(Vec::new())), Err(status::RESOURCES));
    board.finish(jobs[3], Ok(Vec::new()));
    assert!(board.start(1, Work::Read(Vec::new())).is_ok());
    board.cancel(jobs[4]);
    assert!(board.start(1, Work::Read(Vec::new())).is_ok());
}

#[test]
fn a_newer_message_takes_the_place_of_an_older_one() {
    let board = board();
    board.join(0, Box::new(|| {}));
    board.message(0, 7, vec![vec![0]]);
    let (handle, arrived) = board.receive(1, slot(Kind::Message, 0), &READY);
    assert_eq!(arrived, Ok(Arrived::Nothing), "nobody waited for the first one");
    board.message(0, 7, vec![vec![1]]);
    assert_eq!(board.receive(1, slot(Kind::Message, handle), &READY).1, Ok(Arrived::Nothing));
    board.exchange();
    board.message(0, 7, vec![vec![2]]);
    board.exchange();
    let expected = Arrived::All { areas: vec![vec![2]], overwritten: true };
    assert_eq!(board.receive(1, slot(Kind::Message, handle), &READY).1, Ok(expected));
    assert_eq!(board.receive(1, slot(Kind::Message, 0), &READY).1, Err(status::R_ID_USED));
}

#[test]
fn a_block_waits_until_it_is_taken() {
    let board = board();
    board.join(0, Box::new(|| {}));
    assert_eq!(board.begin_block(0, 7, 4), Err(NotTaken::Unknown));
    let off = Receive { enabled: false, room: 10 };
    let (handle, _) = board.receive(1, slot(Kind::Block, 0), &off);
    assert_eq!(board.begin_block(0, 7, 4), Err(NotTaken::Disabled));
    assert_eq!(board.receive(1, slot(Kind::Block, handle), &READY).1, Ok(Arrived::Nothing));
    assert_eq!(board.begin_block(0, 7, 11), Err(NotTaken::TooLong));
    assert_eq!(board.begin_block(0, 7, 2), Ok(()));
    assert_eq!(board.receive(1, slot(Kind::Block, handle), &READY).1, Ok(Arrived::Some));
    assert_eq!(board.end_block(0, 7, vec![1, 2]), Ok(()));
    assert_eq!(board.begin_block(0, 7, 2), Err(NotTaken::Full));
    board.exchange();
    let expected = Arrived::All { areas: vec![vec![1, 2]], overwritten: false };
    assert_eq!(board.receive(1, slot(Kind::Block, handle), &READY).1, Ok(expected));
    assert_eq!(board.begin_block(0, 7, 2), Ok(()));
}

#[test]
fn a_handle_outlives_a_connection_that_is_not_up() {
    let board = board();
    let (handle, arrived) = board.receive(1, slot(Kind::Block, 0), &READY);
    assert_eq!(arrived, Err(status::NO_CONNECTION));
    board.join(0, Box::new(|| {}));
    assert_eq!(board.receive(1, slot(Kind::Block, handle), &READY), (handle, Ok(Arrived::Nothing)));
}
