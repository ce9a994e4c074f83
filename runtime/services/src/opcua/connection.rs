//! A connection: frames in, responses out. Source: OPC 10000-6, section 7.1.

use std::sync::Arc;
use std::time::{Instant, SystemTime};

use plcc_abi::services::Right;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::{sleep_until, timeout};

use super::Server;
use super::channel::{Channel, HEAD_BYTES, Opening};
use super::code::{Reader, Writer, now};
use super::session::{self, Response, Session, opening_head, response};
use super::status::{self, Status};
use crate::limits::{
    ANSWER_TIME, FRAME_TIME, OPCUA_CHUNK_MAX, OPCUA_CHUNKS_MAX, OPCUA_HELLO_MAX, OPCUA_OPEN_MAX, OPCUA_REQUEST_MAX,
    SETUP_TIME,
};
use crate::listen::Visitor;

/// The smallest chunk that both sides must be able to take.
const CHUNK_MIN: u32 = 8192;
const OPEN_CHANNEL: u32 = 446;

/// Answers one client until it breaks the rules, goes, or the CPU ends or gets a program with other types of structures.
pub async fn serve(visitor: Visitor, server: Arc<Server>) {
    let Some(server) = server.renewed().await else { return };
    let mut connection = Connection {
        server: Arc::new(server),
        stream: visitor.stream,
        right: visitor.right,
        buffer: Vec::new(),
        begun: Instant::now(),
        opened: Instant::now(),
        renewed: Instant::now(),
        chunk: 0,
        channel: None,
        session: None,
        parts: Vec::new(),
        chunks: 0,
    };
    if let Err(Some(status)) = connection.run().await {
        connection.end(status).await;
    }
}

struct Connection {
    server: Arc<Server>,
    stream: TcpStream,
    right: Right,
    /// Bytes that have come, and since when a frame is not complete.
    buffer: Vec<u8>,
    begun: Instant,
    opened: Instant,
    /// When the CPU was asked for its program.
    renewed: Instant,
    /// Bytes of a chunk that the client takes; 0: it has not said hello.
    chunk: usize,
    channel: Option<Channel>,
    session: Option<Session>,
    /// Chunks of a request whose last one has not come.
    parts: Vec<u8>,
    chunks: usize,
}

/// Why a connection ends: with an error that the client gets, or without.
type End = Option<Status>;

impl Connection {
    async fn run(&mut self) -> Result<(), End> {
        let mut bytes = vec![0; 16_384];
        loop {
            let due = self.due();
            tokio::select! {
                read = self.stream.read(&mut bytes) => {
                    let count = read.ok().filter(|count| *count > 0).ok_or(None)?;
                    if self.buffer.is_empty() {
                        self.begun = Instant::now();
                    }
                    self.buffer.extend_from_slice(&bytes[..count]);
                    while let Some(frame) = self.frame()? {
                        self.take(frame).await?;
                        self.begun = Instant::now();
                    }
                }
                () = sleep_until(due.into()) => self.tick().await?,
            }
        }
    }

    /// When there is something to do although nothing comes.
    fn due(&self) -> Instant {
        let mut due = match &self.session {
            Some(session) if session.is_active() => session.due(),
            Some(_) | None => self.opened + SETUP_TIME,
        };
        if !self.buffer.is_empty() {
            due = due.min(self.begun + FRAME_TIME);
        }
        if let Some(until) = self.channel.as_ref().and_then(|channel| channel.until) {
            due = due.min(until);
        }
        due
    }

    async fn tick(&mut self) -> Result<(), End> {
        let time = Instant::now();
        let is_late = !self.buffer.is_empty() && self.begun + FRAME_TIME <= time;
        let is_old = self.channel.as_ref().and_then(|channel| channel.until).is_some_and(|until| until <= time);
        let has_session = self.session.as_ref().is_some_and(Session::is_active);
        let is_slow = !has_session && self.opened + SETUP_TIME <= time;
        if is_late || is_old || is_slow || self.session.as_ref().is_some_and(Session::is_over) {
            return Err(Some(status::TIMEOUT));
        }
        if let Some(session) = &mut self.session {
            match session.tick(&self.server).await {
                Some(responses) => self.say(responses).await?,
                None => self.renew(true).await?,
            }
        }
        Ok(())
    }

    /// A frame that has come completely.
    fn frame(&mut self) -> Result<Option<Vec<u8>>, End> {
        let Some(head) = self.buffer.first_chunk::<8>() else { return Ok(None) };
        let [a, b, c, part, size @ ..] = *head;
        let size = u32::from_le_bytes(size) as usize;
        let most = match (&[a, b, c], part) {
            (b"HEL", b'F') => OPCUA_HELLO_MAX,
            (b"OPN", b'F') => OPCUA_OPEN_MAX,
            (b"MSG" | b"CLO", b'F' | b'C' | b'A') => OPCUA_CHUNK_MAX,
            _ => return Err(Some(status::MESSAGE_TYPE_INVALID)),
        };
        if size > most {
            return Err(Some(status::MESSAGE_TOO_LARGE));
        }
        if size < HEAD_BYTES {
            return Err(Some(status::DECODING));
        }
        if self.buffer.len() < size {
            return Ok(None);
        }
        let rest = self.buffer.split_off(size);
        Ok(Some(std::mem::replace(&mut self.buffer, rest)))
    }

    async fn take(&mut self, mut frame: Vec<u8>) -> Result<(), End> {
        let kind = [frame[0], frame[1], frame[2]];
        match (&kind, self.chunk) {
            (b"HEL", 0) => return self.hello(&frame).await,
            // Hello comes first, and once.
            (b"HEL", _) | (_, 0) => return Err(Some(status::MESSAGE_TYPE_INVALID)),
            (b"OPN", _) => return self.open(frame).await,
            (b"CLO", _) => return Err(None),
            _ => {}
        }
        let part = frame[3];
        let channel = self.channel.as_mut().ok_or(Some(status::CHANNEL_INVALID))?;
        let chunk = channel.read(&mut frame).map_err(Some)?;
        self.chunks += 1;
        if part == b'A' {
            self.parts.clear();
            self.chunks = 0;
            return Ok(());
        }
        if self.chunks > OPCUA_CHUNKS_MAX || self.parts.len() + chunk.body.len() > OPCUA_REQUEST_MAX {
            return Err(Some(status::MESSAGE_TOO_LARGE));
        }
        self.parts.extend(chunk.body);
        if part == b'C' {
            return Ok(());
        }
        self.chunks = 0;
        let body = std::mem::take(&mut self.parts);
        let request = chunk.request;
        if session::age_max(&body).is_some_and(|age| self.renewed.elapsed() >= age) {
            self.renew(false).await?;
        }
        if let Some(responses) = self.serve(request, &body).await {
            return self.say(responses).await;
        }
        self.renew(true).await?;
        let responses = self.serve(request, &body).await.ok_or(Some(status::SHUTDOWN))?;
        self.say(responses).await
    }

    async fn serve(&mut self, request: u32, body: &[u8]) -> Option<Vec<Response>> {
        let channel = self.channel.as_ref()?;
        let had_session = self.session.is_some();
        let served = session::serve(&self.server, &mut self.session, channel, self.right, (request, body)).await;
        if had_session && self.session.is_none() {
            // The client closes the channel next, or opens another session: it has time for that.
            self.opened = Instant::now();
        }
        served
    }

    /// Asks for the program that runs now; the session goes on with its nodes. `must`: it is another one than before. `Err`: the CPU has
    /// ended, or what clients know of its structures is no longer true.
    async fn renew(&mut self, must: bool) -> Result<(), End> {
        self.renewed = Instant::now();
        let server = self.server.renewed().await.ok_or(Some(status::SHUTDOWN))?;
        let is_same = server.space.generation() == self.server.space.generation();
        if is_same && must || !server.space.has_types_of(&self.server.space) {
            return Err(Some(status::SHUTDOWN));
        }
        if !is_same {
            self.server = Arc::new(server);
            if let Some(session) = &mut self.session {
                session.renew(&self.server);
            }
        }
        Ok(())
    }

    async fn hello(&mut self, frame: &[u8]) -> Result<(), End> {
        let mut reader = Reader(&frame[8..]);
        let mut read =
            || Some((reader.u32()?, reader.u32()?, reader.u32()?, reader.u32()?, reader.u32()?, reader.text()?));
        let (_version, receive, send, _size, _chunks, _url) = read().ok_or(Some(status::DECODING))?;
        if receive < CHUNK_MIN || send < CHUNK_MIN {
            return Err(Some(status::DECODING));
        }
        self.chunk = OPCUA_CHUNK_MAX.min(receive as usize);
        let mut out = Writer::default();
        out.0.extend(b"ACKF");
        out.u32(28);
        out.u32(0);
        out.u32(OPCUA_CHUNK_MAX as u32);
        out.u32(self.chunk as u32);
        out.u32(OPCUA_REQUEST_MAX as u32);
        out.u32(OPCUA_CHUNKS_MAX as u32);
        self.send(&out.0).await
    }

    /// Opens a channel, or renews its keys.
    async fn open(&mut self, frame: Vec<u8>) -> Result<(), End> {
        let turn = self.server.one.clone().acquire_owned().await.map_err(|_| Some(status::SHUTDOWN))?;
        let (server, before) = (self.server.clone(), self.channel.take());
        // On a thread of its own: private keys take their time.
        let opened = tokio::task::spawn_blocking(move || open(&server, before, &frame)).await;
        drop(turn);
        let (channel, answer) = opened.map_err(|_| Some(status::INTERNAL))?.map_err(Some)?;
        self.channel = Some(channel);
        self.send(&answer).await
    }

    async fn say(&mut self, responses: Vec<Response>) -> Result<(), End> {
        for Response { request, body } in responses {
            let channel = self.channel.as_mut().ok_or(Some(status::CHANNEL_INVALID))?;
            let frames = channel.write(request, &body, self.chunk).map_err(Some)?;
            self.send(&frames).await?;
        }
        Ok(())
    }

    async fn send(&mut self, bytes: &[u8]) -> Result<(), End> {
        timeout(ANSWER_TIME, self.stream.write_all(bytes)).await.map_err(|_| None)?.map_err(|_| None)
    }

    /// Tells the client why the connection ends.
    async fn end(&mut self, status: Status) {
        let mut out = Writer::default();
        out.0.extend(b"ERRF");
        out.u32(16);
        out.u32(status);
        out.null();
        let _ = self.send(&out.0).await;
        let _ = timeout(ANSWER_TIME, self.stream.shutdown()).await;
    }
}

/// Reads a message that opens a channel, and answers it.
fn open(server: &Server, before: Option<Channel>, frame: &[u8]) -> Result<(Channel, Vec<u8>), Status> {
    let opening = Opening::read(frame, &server.own)?;
    if let (Some(trusted), Some(client)) = (&server.trusted, opening.client()) {
        trusted.check(client, SystemTime::now())?;
    }
    let (service, handle, mut reader) = opening_head(&opening.body).ok_or(status::DECODING)?;
    let mut read = || Some((reader.u32()?, reader.u32()?, reader.u32()?, reader.bytes()?.to_vec(), reader.u32()?));
    let (_version, kind, mode, nonce, lifetime) = read().ok_or(status::DECODING)?;
    if service != OPEN_CHANNEL || kind > 1 {
        return Err(status::DECODING);
    }
    let (mut channel, nonce, time) = Channel::open(&opening, before, kind == 1, mode, &nonce, lifetime)?;
    let mut out = Writer::default();
    out.u32(0);
    out.u32(channel.id);
    out.u32(channel.token());
    out.i64(now());
    out.u32(time);
    out.bytes(&nonce);
    let body = response(OPEN_CHANNEL + 3, handle, status::GOOD, &out.0);
    let answer = channel.write_opening(opening.request, &body, &server.own)?;
    Ok((channel, answer))
}
