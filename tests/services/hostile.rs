//! Clients that break the rules, take no answers, or go in the middle. The program goes on, its cycles are not longer, and others are served.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use libtest_mimic::Failed;
use socket2::{Domain, Socket, Type};

use crate::process::{Plc, Program, cycles_took_at_most, free_port, get};
use crate::ua;

/// Frames of each kind: random ones, and right ones that were changed.
const FRAMES: usize = 10_000;
/// Clients at once: as many as one computer may have, but for one.
const CLIENTS: usize = 7;
/// In seconds. On a computer with other work a process may have to wait this long for a processor.
pub const LONGEST_CYCLE: &str = "0.1";

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }

    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    pub fn bytes(&mut self, longest: usize) -> Vec<u8> {
        (0..self.below(longest)).map(|_| self.next() as u8).collect()
    }

    /// One of `frames` with a few bytes changed, and sometimes cut.
    pub fn changed(&mut self, frames: &[&[u8]]) -> Vec<u8> {
        let mut frame = frames[self.below(frames.len())].to_vec();
        for _ in 0..1 + self.below(4) {
            let at = self.below(frame.len());
            frame[at] = self.next() as u8;
        }
        if self.below(10) == 0 {
            frame.truncate(1 + self.below(frame.len()));
        }
        frame
    }
}

pub const CONNECT: &[u8] = &[3, 0, 0, 22, 17, 0xE0, 0, 0, 0, 1, 0, 0xC1, 2, 1, 0, 0xC2, 2, 1, 2, 0xC0, 1, 10];
pub const SETUP: &[u8] = &[3, 0, 0, 25, 2, 0xF0, 0x80, 0x32, 1, 0, 0, 0, 1, 0, 8, 0, 0, 0xF0, 0, 0, 1, 0, 1, 1, 0xE0];
const READ: &[u8] =
    &[3, 0, 0, 31, 2, 0xF0, 0x80, 0x32, 1, 0, 0, 0, 2, 0, 14, 0, 0, 4, 1, 0x12, 10, 0x10, 2, 0, 1, 0, 1, 0x84, 0, 0, 0];
const WRITE: &[u8] = &[
    3, 0, 0, 37, 2, 0xF0, 0x80, 0x32, 1, 0, 0, 0, 3, 0, 14, 0, 6, 5, 1, 0x12, 10, 0x10, 4, 0, 1, 0, 1, 0x84, 0, 0, 0,
    0, 4, 0, 16, 1, 2,
];
const STATUS_LIST: &[u8] = &[
    3, 0, 0, 33, 2, 0xF0, 0x80, 0x32, 7, 0, 0, 0, 4, 0, 8, 0, 8, 0, 1, 0x12, 4, 0x11, 0x44, 1, 0, 0xFF, 9, 0, 4, 4,
    0x24, 0, 0,
];
const S7: &[&[u8]] = &[CONNECT, SETUP, READ, WRITE, STATUS_LIST];

const MODBUS: &[&[u8]] = &[
    &[0, 1, 0, 0, 0, 6, 1, 3, 0, 0, 0, 10],
    &[0, 2, 0, 0, 0, 6, 1, 1, 0, 0, 0, 10],
    &[0, 3, 0, 0, 0, 11, 1, 16, 0, 10, 0, 2, 4, 1, 2, 3, 4],
    &[0, 4, 0, 0, 0, 9, 1, 15, 0, 44, 0, 10, 2, 0xFF, 0x03],
];

/// A connection from a computer of its own: one may have 8, and those that have ended count for a moment.
pub fn connect(number: u8, port: u16) -> std::io::Result<TcpStream> {
    let socket = Socket::new(Domain::IPV4, Type::STREAM, None)?;
    socket.bind(&SocketAddr::from((Ipv4Addr::new(127, 0, 1, number + 1), 0)).into())?;
    socket.connect(&SocketAddr::from((Ipv4Addr::LOCALHOST, port)).into())?;
    let stream = TcpStream::from(socket);
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(Duration::from_secs(5)))?;
    Ok(stream)
}

/// Sends frames on connections that begin with `opening`, a new one whenever the program has closed the old one.
fn attack(port: u16, seed: u64, frames: usize, opening: &[&[u8]], right: &[&[u8]]) {
    let mut random = Random(seed);
    let mut stream: Option<TcpStream> = None;
    let mut buffer = [0; 4096];
    for index in 0..frames {
        let frame = match index % 2 {
            0 => random.bytes(200),
            _ => random.changed(right),
        };
        let open = || {
            let mut stream = connect(seed as u8, port).ok()?;
            // Answers may stay away; what counts is that the program goes on.
            stream.set_read_timeout(Some(Duration::from_millis(2))).ok()?;
            stream.set_write_timeout(Some(Duration::from_millis(200))).ok()?;
            opening.iter().try_for_each(|frame| stream.write_all(frame)).ok()?;
            Some(stream)
        };
        let Some(mut now) = stream.take().or_else(open) else { continue };
        if now.write_all(&frame).is_ok() {
            match now.read(&mut buffer) {
                Ok(0) => {}
                Ok(_) => stream = Some(now),
                Err(error) if matches!(error.kind(), std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut) => {
                    // A frame that is not complete: the next ones belong to it. Half of the clients begin again.
                    stream = (random.below(2) == 0).then_some(now);
                }
                Err(_) => {}
            }
        }
    }
}

/// All clients at once, with frames of both kinds.
pub fn all_attack(port: u16, opening: &[&[u8]], right: &[&[u8]]) {
    std::thread::scope(|scope| {
        for seed in 0..CLIENTS as u64 {
            scope.spawn(move || attack(port, seed, 2 * FRAMES / CLIENTS + 1, opening, right));
        }
    });
}

/// The program answers a frame after another.
pub fn asks(port: u16, frames: &[&[u8]]) -> Result<Vec<u8>, Failed> {
    // Connections of the attackers may be open for a moment.
    let mut last = Failed::from("no answer");
    for _ in 0..100 {
        let mut stream = TcpStream::connect(("127.0.0.1", port))?;
        stream.set_read_timeout(Some(Duration::from_secs(5)))?;
        let mut answer = vec![0; 512];
        let mut count = 0;
        let done: std::io::Result<()> = frames.iter().try_for_each(|frame| {
            stream.write_all(frame)?;
            count = stream.read(&mut answer)?;
            if count == 0 { Err(std::io::ErrorKind::UnexpectedEof.into()) } else { Ok(()) }
        });
        match done {
            Ok(()) => return Ok(answer[..count].to_vec()),
            Err(error) => last = error.into(),
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    Err(last)
}

pub fn s7() -> Result<(), Failed> {
    let (port, metrics) = (free_port(), free_port());
    let plc = Plc::start(&["--metrics", &metrics.to_string(), "--s7", &port.to_string(), "--access", "control"])?;
    all_attack(port, &[CONNECT, SETUP], S7);
    let answer = asks(port, &[CONNECT, SETUP, READ])?;
    if answer.get(7..9) != Some(&[0x32, 3]) || answer.get(21) != Some(&0xFF) {
        return Err(format!("{answer:02X?}").into());
    }
    cycles_took_at_most(metrics, LONGEST_CYCLE)?;
    plc.end()?;
    Ok(())
}

pub fn modbus() -> Result<(), Failed> {
    let (port, metrics) = (free_port(), free_port());
    let plc = Plc::start(&["--metrics", &metrics.to_string(), "--modbus", &port.to_string()])?;
    all_attack(port, &[], MODBUS);
    let answer = asks(port, &[MODBUS[0]])?;
    if answer.len() != 9 + 20 || answer[7] != 3 {
        return Err(format!("{answer:02X?}").into());
    }
    cycles_took_at_most(metrics, LONGEST_CYCLE)?;
    plc.end()?;
    Ok(())
}

/// Sends requests of an OPC UA session, random and changed ones.
fn attack_session(port: u16, seed: u64, requests: usize) {
    let mut random = Random(seed);
    let right = ua::requests();
    let right: Vec<&[u8]> = right.iter().map(Vec::as_slice).collect();
    let mut session = None;
    for index in 0..requests {
        let Some(mut now) = session.take().or_else(|| ua::Session::open(port)) else { continue };
        let body = match index % 2 {
            0 => [right[random.below(right.len())].get(..4).unwrap_or_default(), &random.bytes(100)].concat(),
            _ => random.changed(&right),
        };
        session = now.send(&body).then_some(now);
    }
}

pub fn opcua() -> Result<(), Failed> {
    let (port, metrics) = (free_port(), free_port());
    let folder = tempfile::tempdir()?;
    let flags = ["--metrics", &metrics.to_string(), "--opcua", &port.to_string()];
    let plc = Plc::run_in(folder.path(), Program::Plant.path()?, &flags)?;
    // Before a session, and within one.
    let (hello, open) = (ua::hello(), ua::open());
    let frames = [hello.as_slice(), open.as_slice()];
    std::thread::scope(|scope| {
        for seed in 0..CLIENTS as u64 {
            let opening = if seed % 2 == 0 { &[] } else { &frames[..] };
            scope.spawn(move || attack(port, seed, FRAMES / CLIENTS, opening, &frames));
        }
    });
    std::thread::scope(|scope| {
        for seed in 0..CLIENTS as u64 {
            scope.spawn(move || attack_session(port, seed, 2 * FRAMES / CLIENTS));
        }
    });
    let answer = asks(port, &frames)?;
    if !answer.starts_with(b"OPNF") {
        return Err(format!("{answer:02X?}").into());
    }
    ua::Session::open(port).ok_or("no session after the attack")?;
    cycles_took_at_most(metrics, LONGEST_CYCLE)?;
    plc.end()?;
    Ok(())
}

const METRICS: &[u8] = b"GET /metrics HTTP/1.1\r\nHost: plc\r\nAccept: */*\r\n\r\n";
const HEALTH: &[u8] = b"GET /health?from=probe HTTP/1.0\r\n\r\n";

pub fn metrics() -> Result<(), Failed> {
    let metrics = free_port();
    let plc = Plc::start(&["--metrics", &metrics.to_string()])?;
    // Each answer ends the connection, and the frame after it finds nobody.
    std::thread::scope(|scope| {
        for seed in 0..CLIENTS as u64 {
            scope.spawn(move || attack(metrics, seed, 4 * FRAMES / CLIENTS, &[], &[METRICS, HEALTH]));
        }
    });
    let answer = asks(metrics, &[HEALTH])?;
    if !answer.starts_with(b"HTTP/1.1 200 OK\r\n") {
        return Err(String::from_utf8_lossy(&answer).into());
    }
    were_let_in(metrics, "metrics", 19 * FRAMES / 10)?;
    cycles_took_at_most(metrics, LONGEST_CYCLE)?;
    plc.end()?;
    Ok(())
}

/// So many connections of a service were not refused because there were too many at once.
fn were_let_in(metrics: u16, service: &str, least: usize) -> Result<(), Failed> {
    let (page, name) = (get(metrics, "/metrics")?, format!("plc_connections_total{{service=\"{service}\"}} "));
    let count = page.lines().find_map(|line| line.strip_prefix(name.as_str())?.parse::<usize>().ok());
    if count.is_some_and(|count| count >= least) {
        Ok(())
    } else {
        Err(format!("{service}: {count:?} of {least}").into())
    }
}

/// A request of the page.
fn request(head: &str, cookie: &str, body: &str) -> Vec<u8> {
    let length = body.len();
    format!("{head} HTTP/1.1\r\nHost: plc\r\nCookie: {cookie}\r\nContent-Length: {length}\r\n\r\n{body}").into_bytes()
}

/// Asks to make a connection one for messages. Source: RFC 6455, section 4.1.
pub fn upgrade(cookie: &str) -> Vec<u8> {
    let head =
        "GET /live HTTP/1.1\r\nHost: plc\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13";
    format!("{head}\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nCookie: {cookie}\r\n\r\n").into_bytes()
}

/// A message of text of a client, whose mask is 0. Source: RFC 6455, section 5.2.
pub fn message(text: &str) -> Vec<u8> {
    let length = text.len();
    let head = if length < 126 {
        vec![0x81, 0x80 | length as u8]
    } else {
        vec![0x81, 0xFE, (length >> 8) as u8, length as u8]
    };
    [head.as_slice(), &[0; 4], text.as_bytes()].concat()
}

/// Signs anna in, who may change values. Result: the cookie.
pub fn sign_in(port: u16) -> Result<String, Failed> {
    let form = r#"{"user":"anna","password":"riverside"}"#;
    let head = format!(
        "POST /session HTTP/1.1\r\nHost: plc\r\nContent-Type: application/json\r\nContent-Length: {}",
        form.len()
    );
    let answer = asks(port, &[format!("{head}\r\n\r\n{form}").as_bytes()])?;
    let answer = String::from_utf8_lossy(&answer).into_owned();
    let cookie = answer.split("set-cookie: ").nth(1).and_then(|rest| rest.split(';').next());
    cookie.map(str::to_string).ok_or_else(|| answer.into())
}

/// Orders of the page, each in its short and in a long form.
const ORDERS: [&str; 12] = [
    r#"{"do":"watch","names":["MW10","Values.level","I0.0","DB1.DBW0 in V","Bytes.all[17]"]}"#,
    r#"{"do":"watch","names":["MW10","Values.level"],"formats":["bcd","real"]}"#,
    r#"{"do":"all","rows":[{"name":"MW10","value":"12","format":"bcd"},{"name":"Values.level","value":"2.5","format":"real"}]}"#,
    r#"{"do":"job","rows":[{"name":"MW10","value":"1","format":"hex","trigger":"begin","every":true},{"name":"Q0.0","value":"1","trigger":"end","every":false}]}"#,
    r#"{"do":"reset"}"#,
    r#"{"do":"modify","name":"MW10","value":"16#1234"}"#,
    r#"{"do":"status","block":"OB1","call":null}"#,
    r#"{"do":"obs"}"#,
    r#"{"do":"trace","signals":["I0.0","MW10"],"samples":1000,"before":10,"trigger":{"signal":1,"level":5,"rising":true}}"#,
    r#"{"do":"force","name":"I0.0","value":"1"}"#,
    r#"{"do":"stop"}"#,
    r#"{"do":"run","restart":"cold"}"#,
];

/// The page's requests, and messages on its connection.
pub fn web() -> Result<(), Failed> {
    let (web, metrics) = (free_port(), free_port());
    let flags = ["--metrics", &metrics.to_string(), "--web", &web.to_string(), "--access", "control"];
    let plc = Plc::start(&flags)?;
    let cookie = sign_in(web)?;
    let requests = [
        request("GET /names", &cookie, ""),
        request("GET /places/OB1", &cookie, ""),
        request("GET /info", &cookie, ""),
        request("POST /load?lose", &cookie, "not a program"),
        request("POST /restore", &cookie, ""),
        request(
            "POST /table/rows",
            &cookie,
            "[[row]]\naddress = \"MW10\"\nformat = \"dec\"\n[trace]\nfile = \"a\"\nsignals = []\n",
        ),
        request("POST /table/file", &cookie, r#"{"row":[{"address":"MW10","format":"dec","cycle":3}]}"#),
        upgrade(&cookie),
    ];
    all_attack(web, &[], &requests.each_ref().map(Vec::as_slice));
    let opening = upgrade(&cookie);
    let orders = ORDERS.map(message);
    all_attack(web, &[&opening], &orders.each_ref().map(Vec::as_slice));
    let answer = asks(web, &[&opening])?;
    if !answer.starts_with(b"HTTP/1.1 101") {
        return Err(String::from_utf8_lossy(&answer).into());
    }
    // Most frames end their connection.
    were_let_in(metrics, "web", FRAMES)?;
    cycles_took_at_most(metrics, LONGEST_CYCLE)?;
    plc.end()?;
    Ok(())
}

/// Clients of all services that ask and take no answer, and clients that go while they are answered. Others are served meanwhile.
pub fn slow() -> Result<(), Failed> {
    let ports = [(); 5].map(|()| free_port());
    let [s7, modbus, opcua, web, metrics] = ports;
    let texts = ports.map(|port| port.to_string());
    let names = ["--s7", "--modbus", "--opcua", "--web", "--metrics"];
    let flags: Vec<&str> = names.iter().zip(&texts).flat_map(|(name, port)| [*name, port.as_str()]).collect();
    let folder = tempfile::tempdir()?;
    let plc = Plc::run_in(folder.path(), Program::Line.path()?, &flags)?;
    let cookie = sign_in(web)?;
    let (hello, open, upgrade) = (ua::hello(), ua::open(), upgrade(&cookie));
    let names = request("GET /names", &cookie, "");
    let watch = message(ORDERS[0]);
    let page = request("GET /page.js", "", "");
    // The port, what opens a connection, and a frame to which there is an answer.
    type Service<'a> = (u16, &'a [&'a [u8]], &'a [u8]);
    let services: [Service; 6] = [
        (s7, &[CONNECT, SETUP], READ),
        (modbus, &[], MODBUS[0]),
        (opcua, &[&hello, &open], &hello),
        (web, &[], &names),
        (web, &[&upgrade], &watch),
        (metrics, &[], METRICS),
    ];
    // Each asks as often as the system takes it, and reads nothing.
    let mut silent = Vec::new();
    for (port, opening, frame) in services {
        let mut stream = TcpStream::connect(("127.0.0.1", port))?;
        stream.set_write_timeout(Some(Duration::from_millis(50)))?;
        opening.iter().try_for_each(|frame| stream.write_all(frame))?;
        for _ in 0..20_000 {
            if stream.write_all(frame).is_err() {
                break;
            }
        }
        silent.push(stream);
    }
    for _ in 0..100 {
        for (port, opening, frame) in services {
            let mut stream = TcpStream::connect(("127.0.0.1", port))?;
            // The answer finds nobody.
            let _ = opening.iter().chain([&frame]).try_for_each(|frame| stream.write_all(frame));
        }
    }
    for (port, frames) in
        [(s7, &[CONNECT, SETUP, READ][..]), (modbus, &[MODBUS[0]]), (opcua, &[&hello, &open]), (web, &[&page])]
    {
        asks(port, frames)?;
    }
    cycles_took_at_most(metrics, LONGEST_CYCLE)?;
    drop(silent);
    plc.end()?;
    Ok(())
}

/// Half a frame, and then a byte each second: five seconds after its begin the client loses its connection.
pub fn half() -> Result<(), Failed> {
    let ports = [(); 5].map(|()| free_port());
    let [s7, modbus, opcua, web, metrics] = ports;
    let texts = ports.map(|port| port.to_string());
    let names = ["--s7", "--modbus", "--opcua", "--web", "--metrics"];
    let flags: Vec<&str> = names.iter().zip(&texts).flat_map(|(name, port)| [*name, port.as_str()]).collect();
    let folder = tempfile::tempdir()?;
    let plc = Plc::run_in(folder.path(), Program::Line.path()?, &flags)?;
    let body =
        "POST /session HTTP/1.1\r\nHost: plc\r\nContent-Type: application/json\r\nContent-Length: 99\r\n\r\n{\"user\"";
    let hello = ua::hello();
    // What is sent at once, and the three bytes after it.
    let halves: [(&str, u16, &[u8], &[u8]); 6] = [
        ("s7", s7, &CONNECT[..9], &CONNECT[9..12]),
        ("modbus", modbus, &MODBUS[0][..8], &MODBUS[0][8..11]),
        ("opcua", opcua, &hello[..12], &hello[12..15]),
        ("web", web, b"GET /names HTTP/1.1\r\nHost:", b"plc"),
        ("body", web, body.as_bytes(), b":\"a"),
        ("metrics", metrics, b"GET /metr", b"ics"),
    ];
    let began = Instant::now();
    let mut open = Vec::new();
    for (name, port, half, rest) in halves {
        let mut stream = TcpStream::connect(("127.0.0.1", port))?;
        stream.write_all(half)?;
        stream.set_read_timeout(Some(Duration::from_secs(9)))?;
        open.push((name, stream, rest));
    }
    for index in 0..3 {
        std::thread::sleep(Duration::from_secs(1));
        open.iter_mut().try_for_each(|(_, stream, rest)| stream.write_all(&rest[index..=index]))?;
    }
    for (name, mut stream, _) in open {
        // An answer may come first, such as a refusal.
        let closed = stream.read_to_end(&mut Vec::new());
        let is_open = closed.is_err_and(|error| error.kind() != std::io::ErrorKind::ConnectionReset);
        if is_open || began.elapsed() > Duration::from_millis(7500) {
            return Err(format!("{name}: the connection is still there after {:?}", began.elapsed()).into());
        }
    }
    plc.end()?;
    Ok(())
}

/// One computer opens all connections that it may have, says nothing or half a frame, and loses them.
pub fn idle() -> Result<(), Failed> {
    let port = free_port();
    let plc = Plc::start(&["--s7", &port.to_string()])?;
    let silent: Vec<_> = (0..40).map(|_| TcpStream::connect(("127.0.0.1", port))).collect::<Result<_, _>>()?;
    let mut refused = 0;
    for mut stream in &silent {
        stream.set_read_timeout(Some(Duration::from_millis(20)))?;
        refused += usize::from(matches!(stream.read(&mut [0; 8]), Ok(0)));
    }
    if refused != 32 {
        return Err(format!("{refused} of 40 connections were refused; one computer may have 8").into());
    }
    // After five seconds the silent ones are closed.
    asks(port, &[CONNECT, SETUP, READ])?;
    plc.end()?;
    // Browsers open six connections each, and several people may be behind one address.
    let port = free_port();
    let plc = Plc::start(&["--web", &port.to_string()])?;
    let mut browsers: Vec<_> = (0..36).map(|_| TcpStream::connect(("127.0.0.1", port))).collect::<Result<_, _>>()?;
    for stream in &mut browsers {
        stream.set_read_timeout(Some(Duration::from_millis(20)))?;
        if matches!(stream.read(&mut [0; 8]), Ok(0)) {
            return Err("the page refuses a browser".into());
        }
    }
    plc.end()?;
    Ok(())
}
