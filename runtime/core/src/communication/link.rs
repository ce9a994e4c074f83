//! A byte stream that never blocks, with buffers for unsent and received bytes.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use socket2::{SockRef, TcpKeepalive};

/// Received bytes that wait here; more stays with the operating system, which slows the partner down.
const INPUT_MAX: usize = 1 << 16;
/// Time after which a silent partner is probed.
const KEEP_ALIVE: Duration = Duration::from_secs(30);

/// A TCP stream, or anything else that reads and writes without blocking.
pub struct Link<S = TcpStream> {
    stream: S,
    /// Received bytes that are not yet read.
    pub input: Vec<u8>,
    output: Vec<u8>,
    /// Nothing more will arrive.
    pub ended: bool,
    /// Nothing more can be sent.
    pub broken: bool,
}

impl Link<TcpStream> {
    pub fn new(stream: TcpStream) -> std::io::Result<Link> {
        stream.set_nonblocking(true)?;
        // Neither is needed for the connection to work.
        let _ = stream.set_nodelay(true);
        let _ = SockRef::from(&stream).set_tcp_keepalive(&TcpKeepalive::new().with_time(KEEP_ALIVE));
        Ok(Link::of(stream))
    }

    pub fn partner_port(&self) -> Option<u16> {
        self.stream.peer_addr().ok().map(|address| address.port())
    }
}

impl<S: Read + Write> Link<S> {
    /// A link over a stream that does not block.
    pub fn of(stream: S) -> Link<S> {
        Link { stream, input: Vec::new(), output: Vec::new(), ended: false, broken: false }
    }

    pub fn stream(&self) -> &S {
        &self.stream
    }

    /// Bytes that the operating system has not taken yet.
    pub fn backlog(&self) -> usize {
        self.output.len()
    }

    /// Forgets bytes that are not yet passed to the operating system.
    pub fn discard_backlog(&mut self) {
        self.output.clear();
    }

    /// Sends as much as possible now, the rest later.
    pub fn send(&mut self, bytes: &[u8]) {
        self.output.extend_from_slice(bytes);
        self.flush();
    }

    /// Everything is with the operating system.
    pub fn is_drained(&self) -> bool {
        self.output.is_empty()
    }

    pub fn work(&mut self) {
        self.flush();
        self.fill();
    }

    fn flush(&mut self) {
        while !self.output.is_empty() && !self.broken {
            match self.stream.write(&self.output) {
                Ok(0) => self.broken = true,
                Ok(count) => drop(self.output.drain(..count)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => self.broken = true,
            }
        }
    }

    fn fill(&mut self) {
        let mut buffer = [0; 4096];
        while !self.ended && self.input.len() < INPUT_MAX {
            match self.stream.read(&mut buffer) {
                Ok(0) => self.ended = true,
                Ok(count) => self.input.extend_from_slice(&buffer[..count]),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => self.ended = true,
            }
        }
    }
}
