//! Frames of OPC UA without security, for clients that break the rules. Source: OPC 10000-6.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

/// A message that grows.
#[derive(Default)]
struct Out(Vec<u8>);

impl Out {
    fn raw(mut self, bytes: &[u8]) -> Out {
        self.0.extend(bytes);
        self
    }

    fn u32(self, value: u32) -> Out {
        self.raw(&value.to_le_bytes())
    }

    fn f64(self, value: f64) -> Out {
        self.raw(&value.to_le_bytes())
    }

    fn text(self, text: &str) -> Out {
        self.u32(text.len() as u32).raw(text.as_bytes())
    }

    fn null(self) -> Out {
        self.u32(u32::MAX)
    }

    /// The number of a service, and a head without the token of the session.
    fn request(service: u16) -> Out {
        Out::default()
            .raw(&[1, 0])
            .raw(&service.to_le_bytes())
            .raw(TOKEN)
            .raw(&[0; 8])
            .u32(7)
            .u32(0)
            .null()
            .u32(0)
            .raw(&[0; 3])
    }

    fn node(self, text: &str) -> Out {
        self.raw(&[3, 3, 0]).text(text)
    }
}

/// Stands for the token of the session: a null node.
const TOKEN: &[u8] = &[0, 0];
/// Where it is in a request.
const TOKEN_AT: usize = 4;

fn framed(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    Out::default().raw(kind).u32(content.len() as u32 + 8).raw(content).0
}

pub fn hello() -> Vec<u8> {
    let content = Out::default().u32(0).u32(65_536).u32(65_536).u32(0).u32(0).text("opc.tcp://127.0.0.1:4840");
    framed(b"HELF", &content.0)
}

pub fn open() -> Vec<u8> {
    let body = Out::request(446).u32(0).u32(0).u32(1).null().u32(3_600_000);
    let head = Out::default().u32(0).text("http://opcfoundation.org/UA/SecurityPolicy#None").null().null();
    framed(b"OPNF", &head.u32(1).u32(1).raw(&body.0).0)
}

/// Right requests of all kinds that a session carries out.
pub fn requests() -> Vec<Vec<u8>> {
    let qualified = |out: Out| out.raw(&[0, 0]).null();
    let parameters =
        |out: Out| out.u32(5).f64(50.0).raw(&[1, 0, 0xD4, 2, 1]).u32(16).u32(1).u32(1).f64(0.5).u32(10).raw(&[1]);
    let item = |out: Out| parameters(qualified(out.node("\"Groups\".\"ints\"").u32(13).null()).u32(2));
    let requests = [
        qualified(Out::request(631).f64(0.0).u32(2).u32(1).node("\"Values\".\"aReal\"").u32(13).null()),
        qualified(Out::request(631).f64(0.0).u32(2).u32(1).node("\"Counted\".\"all\"[3]").u32(13).null()),
        Out::request(673).u32(1).node("\"Values\".\"anInt\"").u32(13).null().raw(&[1, 4, 5, 0]),
        Out::request(673)
            .u32(1)
            .node("\"Groups\".\"ints\"")
            .u32(13)
            .null()
            .raw(&[1, 0x84])
            .u32(4)
            .raw(&[1, 2, 3, 4, 5, 6, 7, 8]),
        Out::request(673)
            .u32(1)
            .node("\"Groups\".\"texts\"")
            .u32(13)
            .null()
            .raw(&[1, 0x8C])
            .u32(2)
            .text("ab")
            .text("cd"),
        Out::request(673)
            .u32(1)
            .node("\"Values\".\"aDtl\"")
            .u32(13)
            .null()
            .raw(&[1, 13])
            .raw(&[0, 0, 0, 0, 0, 0, 0xDC, 1]),
        Out::request(527)
            .raw(&[0, 0])
            .raw(&[0; 12])
            .u32(2)
            .u32(1)
            .node("DataBlocks")
            .u32(0)
            .raw(&[0, 33, 1])
            .u32(0)
            .u32(63),
        Out::request(527)
            .raw(&[0, 0])
            .raw(&[0; 12])
            .u32(0)
            .u32(1)
            .node("\"Counted\".\"all\"")
            .u32(2)
            .raw(&[0, 0, 1])
            .u32(0)
            .u32(63),
        Out::request(533).raw(&[0]).u32(1).u32(4).u32(1),
        Out::request(554).u32(1).node("PLC").u32(1).raw(&[0, 33, 0, 1]).raw(&[3, 0]).text("DataBlocks"),
        Out::request(560).u32(1).node("PLC"),
        Out::request(787).f64(50.0).u32(100).u32(10).u32(0).raw(&[1, 0]),
        item(Out::request(751).u32(1).u32(2).u32(1)),
        parameters(Out::request(763).u32(1).u32(2).u32(1).u32(1)),
        Out::request(769).u32(1).u32(2).u32(1).u32(1),
        Out::request(781).u32(1).u32(1).u32(1),
        Out::request(793).u32(1).f64(100.0).u32(100).u32(10).u32(0).raw(&[0]),
        Out::request(799).raw(&[1]).u32(1).u32(1),
        Out::request(826).u32(1).u32(1).u32(1),
        Out::request(832).u32(1).u32(1),
        Out::request(847).u32(1).u32(2),
        Out::request(428).text("opc.tcp://127.0.0.1:1").null().null(),
    ];
    requests.into_iter().map(|request| request.0).collect()
}

/// A session without a user.
pub struct Session {
    stream: TcpStream,
    channel: [u8; 8],
    number: u32,
    token: Vec<u8>,
}

impl Session {
    pub fn open(port: u16) -> Option<Session> {
        let mut stream = TcpStream::connect(("127.0.0.1", port)).ok()?;
        stream.set_read_timeout(Some(Duration::from_secs(5))).ok()?;
        stream.set_write_timeout(Some(Duration::from_millis(500))).ok()?;
        stream.set_nodelay(true).ok()?;
        stream.write_all(&hello()).ok()?;
        frame(&mut stream)?;
        stream.write_all(&open()).ok()?;
        let answer = frame(&mut stream)?;
        // At the end are channel, token, time, lifetime and an empty nonce or one of 32 bytes.
        let channel = answer.get(8..12)?;
        let channel = [channel, &1u32.to_le_bytes()].concat().try_into().ok()?;
        let mut session = Session { stream, channel, number: 1, token: TOKEN.to_vec() };
        let create = Out::request(461).null().null().raw(&[0]).u32(1).null().null().u32(0).null().null().null();
        let answer = session.ask(&create.null().null().f64(60_000.0).u32(0).0)?;
        // After the head of the response: the session, a number; and the token, bytes.
        let at = answer.windows(7).position(|bytes| bytes == [5, 1, 0, 32, 0, 0, 0])?;
        session.token = answer.get(at..at + 39)?.to_vec();
        session.ask(&Out::request(467).null().null().u32(0).u32(0).raw(&[0, 0, 0]).null().null().0)?;
        session.stream.set_read_timeout(Some(Duration::from_millis(2))).ok()?;
        Some(session)
    }

    fn write(&mut self, body: &[u8]) -> Option<()> {
        self.number += 1;
        let has_token = body.get(TOKEN_AT..TOKEN_AT + 2) == Some(TOKEN);
        let body = match has_token {
            true => [&body[..TOKEN_AT], &self.token, &body[TOKEN_AT + 2..]].concat(),
            false => body.to_vec(),
        };
        let content = Out::default().raw(&self.channel).u32(self.number).u32(self.number).raw(&body);
        self.stream.write_all(&framed(b"MSGF", &content.0)).ok()
    }

    fn ask(&mut self, body: &[u8]) -> Option<Vec<u8>> {
        self.write(body)?;
        frame(&mut self.stream).filter(|answer| answer.starts_with(b"MSGF"))
    }

    /// Sends a request; the answer may stay away. Result: the connection is still there.
    pub fn send(&mut self, body: &[u8]) -> bool {
        let mut buffer = [0; 65_536];
        self.write(body).is_some()
            && match self.stream.read(&mut buffer) {
                Ok(count) => count != 0 && !buffer.starts_with(b"ERR"),
                Err(error) => matches!(error.kind(), std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut),
            }
    }
}

fn frame(stream: &mut TcpStream) -> Option<Vec<u8>> {
    let mut head = [0; 8];
    stream.read_exact(&mut head).ok()?;
    let [.., a, b, c, d] = head;
    let length = u32::from_le_bytes([a, b, c, d]).checked_sub(8).filter(|length| *length < 65_536)?;
    let mut frame = vec![0; length as usize];
    stream.read_exact(&mut frame).ok()?;
    Some([&head[..], &frame].concat())
}
