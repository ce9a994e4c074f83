//! Connections of a program with a partner that is a plain socket.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::time::Duration;

use crate::communication::{Communication, Description, Protocol, Receive, status};

const HOME: Ipv4Addr = Ipv4Addr::LOCALHOST;
const MS: u64 = 1_000_000;

/// A port that nobody uses now.
fn free_port() -> u16 {
    TcpListener::bind((HOME, 0)).and_then(|listener| listener.local_addr()).expect("loopback exists").port()
}

fn tcp(id: u16, active: bool, local_port: u16, remote_port: u16) -> Description {
    Description {
        id,
        protocol: Protocol::Tcp,
        active,
        local_port,
        remote: active.then_some(HOME),
        remote_name: String::new(),
        remote_port,
        local_tsap: Vec::new(),
        remote_tsap: Vec::new(),
    }
}

fn iso(id: u16, active: bool) -> Description {
    let (local_tsap, remote_tsap) = (vec![0xE0, 1, 7], vec![0xE0, 2, 9]);
    Description { protocol: Protocol::Iso, local_tsap, remote_tsap, ..tcp(id, active, 0, 0) }
}

/// The CPU under test: each step is a cycle of 10 ms.
struct Plc {
    communication: Communication,
    now: u64,
}

impl Plc {
    fn new() -> Plc {
        Plc { communication: Communication::default(), now: 0 }
    }

    fn open(&mut self, description: Description) -> Result<(), u16> {
        self.communication.open(description, false, self.now)
    }

    fn cycle(&mut self) {
        self.now += 10 * MS;
        self.communication.work(self.now);
        std::thread::sleep(Duration::from_millis(1));
    }

    /// Cycles until `question` is answered.
    fn until<T>(&mut self, mut question: impl FnMut(&mut Communication) -> Option<T>) -> T {
        for _ in 0..3000 {
            if let Some(answer) = question(&mut self.communication) {
                return answer;
            }
            self.cycle();
        }
        panic!("nothing happens");
    }

    fn until_up(&mut self, id: u16) {
        self.until(|all| all.connection(id)?.is_up().then_some(()));
    }

    fn until_lost(&mut self, id: u16) {
        self.until(|all| (all.connection(id)?.losses > 0).then_some(()));
    }

    fn receive(&mut self, id: u16, room: usize, exact: bool) -> Receive {
        self.until(|all| match all.connection(id)?.receive(room, exact) {
            Receive::Nothing => None,
            got => Some(got),
        })
    }

    fn send(&mut self, id: u16, bytes: &[u8]) {
        assert!(self.communication.connection(id).is_some_and(|connection| connection.send(bytes)));
    }
}

fn read(stream: &mut TcpStream, count: usize) -> Vec<u8> {
    stream.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
    let mut bytes = vec![0; count];
    stream.read_exact(&mut bytes).expect("the partner sends");
    bytes
}

#[test]
fn client_finds_its_partner_by_name() {
    let partner = TcpListener::bind((HOME, 0)).unwrap();
    let port = partner.local_addr().unwrap().port();
    let mut plc = Plc::new();
    plc.open(Description { remote: None, remote_name: "localhost".to_owned(), ..tcp(1, true, 0, port) }).unwrap();
    plc.until_up(1);
    plc.send(1, b"name");
    let (mut stream, _) = partner.accept().unwrap();
    assert_eq!(read(&mut stream, 4), b"name");
}

#[test]
fn client_sends_and_receives_in_parts() {
    let partner = TcpListener::bind((HOME, 0)).unwrap();
    let mut plc = Plc::new();
    plc.open(tcp(1, true, 0, partner.local_addr().unwrap().port())).unwrap();
    let (mut stream, _) = partner.accept().unwrap();
    plc.until_up(1);
    plc.send(1, b"question");
    assert_eq!(read(&mut stream, 8), b"question");
    stream.write_all(b"four").unwrap();
    for _ in 0..20 {
        plc.cycle();
    }
    assert_eq!(plc.communication.connection(1).unwrap().receive(10, true), Receive::Nothing);
    stream.write_all(b"sixsixtwo").unwrap();
    assert_eq!(plc.receive(1, 10, true), Receive::Bytes(b"foursixsix".to_vec()));
    assert_eq!(plc.receive(1, 10, false), Receive::Bytes(b"two".to_vec()));
}

#[test]
fn a_large_job_goes_out_in_many_cycles() {
    let partner = TcpListener::bind((HOME, 0)).unwrap();
    let mut plc = Plc::new();
    plc.open(tcp(1, true, 0, partner.local_addr().unwrap().port())).unwrap();
    let (mut stream, _) = partner.accept().unwrap();
    plc.until_up(1);
    let job: Vec<u8> = (0..8192u32).map(|at| (at % 251) as u8).collect();
    // Until the operating system takes no more.
    let mut jobs = 0;
    while plc.communication.connection(1).unwrap().is_sent() == Some(true) && jobs < 5000 {
        plc.send(1, &job);
        jobs += 1;
    }
    assert_eq!(plc.communication.connection(1).unwrap().is_sent(), Some(false));
    let reader = std::thread::spawn(move || {
        let mut all = Vec::new();
        for _ in 0..jobs {
            all.extend(read(&mut stream, 8192));
        }
        (all, stream)
    });
    plc.until(|all| all.connection(1)?.is_sent()?.then_some(()));
    let (all, _stream) = reader.join().unwrap();
    assert!(all.chunks(8192).all(|part| part == job));
}

#[test]
fn a_lost_client_connects_again() {
    let partner = TcpListener::bind((HOME, 0)).unwrap();
    let mut plc = Plc::new();
    plc.open(tcp(1, true, 0, partner.local_addr().unwrap().port())).unwrap();
    let (stream, _) = partner.accept().unwrap();
    plc.until_up(1);
    drop(stream);
    plc.until_lost(1);
    let (mut stream, _) = partner.accept().unwrap();
    plc.until_up(1);
    plc.send(1, b"again");
    assert_eq!(read(&mut stream, 5), b"again");
    assert_eq!(plc.communication.connection(1).unwrap().losses, 1);
}

#[test]
fn a_refused_client_tries_again() {
    let port = free_port();
    let mut plc = Plc::new();
    plc.open(tcp(1, true, 0, port)).unwrap();
    plc.until(|all| (all.connection(1)?.failures >= 2).then_some(()));
    assert!(plc.now >= 100 * MS, "it rests between attempts");
    let partner = TcpListener::bind((HOME, port)).unwrap();
    plc.until_up(1);
    partner.accept().unwrap();
}

#[test]
fn server_takes_partners_one_after_the_other() {
    let port = free_port();
    let mut plc = Plc::new();
    plc.open(tcp(1, false, port, 0)).unwrap();
    let mut first = TcpStream::connect((HOME, port)).unwrap();
    plc.until_up(1);
    assert!(TcpStream::connect((HOME, port)).is_err(), "the connection is taken");
    // What came before the end is still there.
    first.write_all(b"last words").unwrap();
    drop(first);
    plc.cycle();
    assert_eq!(plc.receive(1, 100, false), Receive::Bytes(b"last words".to_vec()));
    plc.until_lost(1);
    let mut second = TcpStream::connect((HOME, port)).unwrap();
    plc.until_up(1);
    plc.send(1, b"hello");
    assert_eq!(read(&mut second, 5), b"hello");
}

#[test]
fn server_turns_other_partners_away() {
    let (port, wanted) = (free_port(), free_port());
    let mut plc = Plc::new();
    plc.open(Description { remote: Some(HOME), ..tcp(1, false, port, wanted) }).unwrap();
    let mut stranger = TcpStream::connect((HOME, port)).unwrap();
    for _ in 0..20 {
        plc.cycle();
    }
    assert!(!plc.communication.connection(1).unwrap().is_up());
    stranger.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
    assert!(matches!(stranger.read(&mut [0]), Ok(0) | Err(_)));
    let mut other = Plc::new();
    other.open(tcp(1, true, wanted, port)).unwrap();
    plc.until_up(1);
    other.until_up(1);
}

#[test]
fn what_cannot_be_opened() {
    let port = free_port();
    let mut plc = Plc::new();
    plc.open(tcp(1, false, port, 0)).unwrap();
    assert_eq!(plc.open(tcp(1, false, port, 0)), Ok(()), "shared");
    assert_eq!(plc.open(tcp(1, true, 0, 2000)), Err(status::INCONSISTENT), "one ID, two descriptions");
    assert_eq!(plc.open(tcp(2, false, port, 0)), Err(status::INCONSISTENT), "port of this CPU");
    assert_eq!(plc.communication.open(tcp(1, false, port, 0), true, 0), Err(status::NO_SUCH));
    let taken = TcpListener::bind((Ipv4Addr::UNSPECIFIED, 0)).unwrap();
    let taken_port = taken.local_addr().unwrap().port();
    assert_eq!(plc.open(tcp(2, false, taken_port, 0)), Err(status::INCONSISTENT), "port of another process");
    for id in 2..=8 {
        plc.open(tcp(id, true, 0, taken_port)).unwrap();
    }
    assert_eq!(plc.open(tcp(9, true, 0, taken_port)), Err(status::RESOURCES));
    // Two users: the first leaves, the second ends it.
    assert_eq!(plc.communication.close(1, false), Ok(()));
    assert!(plc.communication.connection(1).is_some());
    assert_eq!(plc.communication.close(1, false), Ok(()));
    assert_eq!(plc.communication.close(1, false), Err(status::NO_SUCH));
    drop(TcpListener::bind((Ipv4Addr::UNSPECIFIED, port)).expect("the port is free again"));
    plc.communication.close_all();
    assert!(plc.communication.connection(2).is_none());
}

/// CR or CC with TSAPs of a partner, whose own is E0 02 09.
fn greeting(code: u8, destination: u16, size: u8, calling: [u8; 3], called: [u8; 3]) -> Vec<u8> {
    let [high, low] = destination.to_be_bytes();
    let mut bytes = vec![3, 0, 0, 24, 19, code, high, low, 0, 77, 0, 0xC0, 1, size, 0xC1, 3];
    bytes.extend(calling);
    bytes.extend([0xC2, 3]);
    bytes.extend(called);
    bytes
}

fn data(last: bool, bytes: &[u8]) -> Vec<u8> {
    let [high, low] = (bytes.len() as u16 + 7).to_be_bytes();
    [&[3, 0, high, low, 2, 0xF0, if last { 0x80 } else { 0 }], bytes].concat()
}

/// Reads one packet; its TPDU.
fn packet(stream: &mut TcpStream) -> Vec<u8> {
    let head = read(stream, 4);
    assert_eq!(head[..2], [3, 0]);
    read(stream, usize::from(u16::from_be_bytes([head[2], head[3]])) - 4)
}

const OWN: [u8; 3] = [0xE0, 1, 7];
const FAR: [u8; 3] = [0xE0, 2, 9];

#[test]
fn iso_server_agrees_on_a_size() {
    let port = free_port();
    let mut plc = Plc::new();
    plc.communication.set_iso_port(port);
    plc.open(iso(5, false)).unwrap();
    // Another TSAP is refused: DR with the partner's reference, reason 3.
    let mut lost = TcpStream::connect((HOME, port)).unwrap();
    lost.write_all(&greeting(0xE0, 0, 10, FAR, [0xE0, 1, 8])).unwrap();
    for _ in 0..20 {
        plc.cycle();
    }
    assert_eq!(packet(&mut lost), [6, 0x80, 0, 77, 0, 0, 3]);
    assert!(!plc.communication.connection(5).unwrap().is_up());

    let mut stream = TcpStream::connect((HOME, port)).unwrap();
    let call = greeting(0xE0, 0, 7, FAR, OWN);
    stream.write_all(&call[..9]).unwrap();
    plc.cycle();
    stream.write_all(&call[9..]).unwrap();
    plc.until_up(5);
    assert_eq!(
        packet(&mut stream),
        [&[19, 0xD0, 0, 77, 0, 5, 0, 0xC0, 1, 7, 0xC1, 3][..], &FAR, &[0xC2, 3], &OWN].concat()
    );
    // Fragments make one message, and two messages stay two.
    stream.write_all(&[data(false, b"one "), data(true, b"message"), data(true, b"another")].concat()).unwrap();
    assert_eq!(plc.receive(5, 100, false), Receive::Bytes(b"one message".to_vec()));
    assert_eq!(plc.receive(5, 6, false), Receive::TooLong);
    // 128 bytes a TPDU leave 125 for data.
    let message: Vec<u8> = (0..=255).collect();
    plc.send(5, &message);
    let parts: Vec<Vec<u8>> = (0..3).map(|_| packet(&mut stream)).collect();
    assert_eq!(parts.iter().map(|part| (part.len(), part[2])).collect::<Vec<_>>(), [(128, 0), (128, 0), (9, 0x80)]);
    assert_eq!(parts.iter().flat_map(|part| part[3..].to_vec()).collect::<Vec<u8>>(), message);
    // Nonsense ends the connection.
    stream.write_all(b"GET / HTTP/1.0\r\n\r\n").unwrap();
    plc.until_lost(5);
}

#[test]
fn iso_client_greets_and_is_refused() {
    let partner = TcpListener::bind((HOME, 0)).unwrap();
    let mut plc = Plc::new();
    plc.communication.set_iso_port(partner.local_addr().unwrap().port());
    plc.open(iso(5, true)).unwrap();
    let (mut stream, _) = partner.accept().unwrap();
    for _ in 0..20 {
        plc.cycle();
    }
    assert_eq!(
        packet(&mut stream),
        greeting(0xE0, 0, 10, OWN, FAR)[4..]
            .iter()
            .enumerate()
            .map(|(at, byte)| {
                // The reference of this side is the ID.
                if at == 5 { 5 } else { *byte }
            })
            .collect::<Vec<u8>>()
    );
    stream.write_all(&[3, 0, 0, 11, 6, 0x80, 0, 5, 0, 0, 3]).unwrap();
    plc.until(|all| (all.connection(5)?.failures == 1).then_some(()));
    for _ in 0..20 {
        plc.cycle();
    }
    let (mut stream, _) = partner.accept().unwrap();
    for _ in 0..20 {
        plc.cycle();
    }
    packet(&mut stream);
    stream.write_all(&greeting(0xD0, 5, 9, OWN, FAR)).unwrap();
    plc.until_up(5);
    plc.send(5, &[1; 600]);
    assert_eq!(packet(&mut stream).len(), 512);
    assert_eq!(packet(&mut stream).len(), 600 - 509 + 3);
    stream.write_all(&data(true, b"answer")).unwrap();
    assert_eq!(plc.receive(5, 8, false), Receive::Bytes(b"answer".to_vec()));
}

#[test]
fn two_sides_of_iso_on_tcp() {
    let port = free_port();
    let (mut server, mut client) = (Plc::new(), Plc::new());
    server.communication.set_iso_port(port);
    client.communication.set_iso_port(port);
    server.open(iso(1, false)).unwrap();
    let Description { local_tsap, remote_tsap, .. } = iso(1, true);
    client.open(Description { local_tsap: remote_tsap, remote_tsap: local_tsap, ..iso(9, true) }).unwrap();
    for _ in 0..500 {
        server.cycle();
        client.cycle();
        if client.communication.connection(9).unwrap().is_up() {
            break;
        }
    }
    server.until_up(1);
    client.until_up(9);
    let message = vec![0x5A; 8192];
    client.send(9, &message);
    assert_eq!(server.receive(1, 8192, false), Receive::Bytes(message));
}
