//! A secure channel: chunks in and out. Source: OPC 10000-6, section 6.7.

use std::time::Instant;

use rsa::traits::PublicKeyParts;

use super::certificate::{Client, Own};
use super::code::{Reader, Writer};
use super::crypto::{BLOCK_BYTES, Keys, MAC_BYTES, NONCE_BYTES, Policy, random, thumbprint};
use super::status::{self, Status};
use crate::limits::OPCUA_CHANNEL_TIME;

/// Type of message and of chunk, size, channel; with the token.
pub const HEAD_BYTES: usize = 12;
const SYMMETRIC_BYTES: usize = 16;
/// Number of the chunk, and of the request.
const SEQUENCE_BYTES: usize = 8;

/// What is secured of each message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    None,
    Sign,
    SignAndEncrypt,
}

impl Mode {
    pub fn number(self) -> i32 {
        match self {
            Mode::None => 1,
            Mode::Sign => 2,
            Mode::SignAndEncrypt => 3,
        }
    }

    fn from_number(number: u32) -> Option<Mode> {
        [Mode::None, Mode::Sign, Mode::SignAndEncrypt].into_iter().find(|mode| mode.number() as u32 == number)
    }
}

/// Keys of both directions, by token.
#[derive(Clone)]
struct Token {
    number: u32,
    client: Keys,
    server: Keys,
}

/// A channel of a connection.
pub struct Channel {
    pub id: u32,
    pub policy: Policy,
    pub mode: Mode,
    pub client: Option<Client>,
    /// The newest one is last; the one before it holds until the client uses the new one.
    tokens: Vec<Token>,
    /// When its keys are too old.
    pub until: Option<Instant>,
    /// Number of the last chunk.
    received: Option<u32>,
    sent: u32,
}

/// A chunk without what secures it.
pub struct Chunk {
    pub request: u32,
    pub body: Vec<u8>,
}

/// A message that opens or renews a channel, decrypted and checked.
pub struct Opening {
    policy: Policy,
    client: Option<Client>,
    sequence: u32,
    pub request: u32,
    pub body: Vec<u8>,
}

impl Opening {
    /// Decrypts and checks, which takes some milliseconds.
    pub fn read(frame: &[u8], own: &Own) -> Result<Opening, Status> {
        let mut reader = Reader(frame.get(HEAD_BYTES..).ok_or(status::DECODING)?);
        let policy = reader.bytes().ok_or(status::DECODING)?;
        let policy = Policy::from_uri(policy).ok_or(status::POLICY_REJECTED)?;
        let certificate = reader.bytes().ok_or(status::DECODING)?;
        let receiver = reader.bytes().ok_or(status::DECODING)?;
        let head = frame.len() - reader.0.len();
        if policy == Policy::None {
            return Opening::split(policy, None, reader.0);
        }
        if receiver != own.thumbprint {
            return Err(status::CERTIFICATE_INVALID);
        }
        let client = Client::parse(certificate).ok_or(status::CERTIFICATE_INVALID)?;
        let plain = policy.decrypt(&own.key, reader.0).ok_or(status::SECURITY_CHECKS)?;
        let content = plain.len().checked_sub(client.key.size()).ok_or(status::SECURITY_CHECKS)?;
        let (content, signature) = plain.split_at(content);
        let signed = [&frame[..head], content].concat();
        if !policy.is_signed(&client.key, &signed, signature) {
            return Err(status::SECURITY_CHECKS);
        }
        // The key of this server has 2048 bits: the length of the padding is one byte.
        let content = unpadded(content).ok_or(status::SECURITY_CHECKS)?;
        Opening::split(policy, Some(client), content)
    }

    /// Who has sent it; `None`: it is not secured.
    pub fn client(&self) -> Option<&Client> {
        self.client.as_ref()
    }

    #[cfg(test)]
    pub fn of_test(policy: Policy, client: Client) -> Opening {
        Opening { policy, client: Some(client), sequence: 1, request: 1, body: Vec::new() }
    }

    fn split(policy: Policy, client: Option<Client>, content: &[u8]) -> Result<Opening, Status> {
        let mut reader = Reader(content);
        let (Some(sequence), Some(request)) = (reader.u32(), reader.u32()) else { return Err(status::DECODING) };
        Ok(Opening { policy, client, sequence, request, body: reader.0.to_vec() })
    }
}

/// Without the padding, whose length is the last byte.
fn unpadded(content: &[u8]) -> Option<&[u8]> {
    let (padding, _) = content.split_last()?;
    content.get(..content.len().checked_sub(usize::from(*padding) + 1)?)
}

impl Channel {
    /// Opens a channel, or renews the keys of `before`. Result: the channel, the nonce of this side, and for how many milliseconds it holds.
    pub fn open(
        opening: &Opening,
        before: Option<Channel>,
        renew: bool,
        mode: u32,
        nonce: &[u8],
        lifetime: u32,
    ) -> Result<(Channel, Vec<u8>, u32), Status> {
        let mode = Mode::from_number(mode).ok_or(status::MODE_REJECTED)?;
        if (opening.policy == Policy::None) != (mode == Mode::None) {
            return Err(status::MODE_REJECTED);
        }
        let mut channel = match (renew, before) {
            (false, None) => Channel {
                id: u32::from_le_bytes(random().ok_or(status::INTERNAL)?) | 1,
                policy: opening.policy,
                mode,
                client: opening.client.clone(),
                tokens: Vec::new(),
                until: None,
                received: None,
                sent: 0,
            },
            (true, Some(channel)) => {
                let same =
                    |a: &Option<Client>, b: &Option<Client>| a.as_ref().map(|a| &a.der) == b.as_ref().map(|b| &b.der);
                if (channel.policy, channel.mode) != (opening.policy, mode) || !same(&channel.client, &opening.client) {
                    return Err(status::SECURITY_CHECKS);
                }
                channel
            }
            // A connection has one channel.
            (false, Some(_)) | (true, None) => return Err(status::CHANNEL_INVALID),
        };
        channel.follows(opening.sequence)?;
        let own = random::<NONCE_BYTES>().ok_or(status::INTERNAL)?;
        let number = channel.token() + 1;
        let (client, server) = match channel.policy {
            Policy::None => (Keys::new(Policy::None, &[], &[]), Keys::new(Policy::None, &[], &[])),
            policy if nonce.len() == NONCE_BYTES => (Keys::new(policy, &own, nonce), Keys::new(policy, nonce, &own)),
            _ => return Err(status::NONCE_INVALID),
        };
        channel.tokens.push(Token { number, client, server });
        let oldest = channel.tokens.len().saturating_sub(2);
        channel.tokens.drain(..oldest);
        let wanted = std::time::Duration::from_millis(lifetime.into());
        let time = wanted.clamp(*OPCUA_CHANNEL_TIME.start(), *OPCUA_CHANNEL_TIME.end());
        // A quarter more, for a client that is late.
        channel.until = Some(Instant::now() + time + time / 4);
        Ok((channel, own.to_vec(), time.as_millis() as u32))
    }

    /// The newest token.
    pub fn token(&self) -> u32 {
        self.tokens.last().map_or(0, |token| token.number)
    }

    /// Chunks come in the order of their numbers.
    fn follows(&mut self, number: u32) -> Result<(), Status> {
        let is_next = self
            .received
            .is_none_or(|last| number == last.wrapping_add(1) || (last > u32::MAX - 1024 && number < 1024));
        self.received = Some(number);
        if is_next { Ok(()) } else { Err(status::SEQUENCE_INVALID) }
    }

    /// A chunk of a request.
    pub fn read(&mut self, frame: &mut [u8]) -> Result<Chunk, Status> {
        let mut head = Reader(frame.get(8..SYMMETRIC_BYTES).ok_or(status::DECODING)?);
        let (id, token) = (head.u32(), head.u32());
        let at = self.tokens.iter().position(|own| Some(own.number) == token);
        let at = at.filter(|_| id == Some(self.id)).ok_or(status::CHANNEL_INVALID)?;
        // The client has the new keys: the old ones are of no use.
        self.tokens.drain(..at);
        let keys = &self.tokens[0].client;
        let content = match self.mode {
            Mode::None => &frame[SYMMETRIC_BYTES..],
            Mode::Sign | Mode::SignAndEncrypt => {
                if self.mode == Mode::SignAndEncrypt {
                    let encrypted = &mut frame[SYMMETRIC_BYTES..];
                    if encrypted.is_empty() || !encrypted.len().is_multiple_of(BLOCK_BYTES) {
                        return Err(status::SECURITY_CHECKS);
                    }
                    keys.decrypt(encrypted).ok_or(status::SECURITY_CHECKS)?;
                }
                let end = frame.len().checked_sub(MAC_BYTES).filter(|end| *end >= SYMMETRIC_BYTES);
                let (signed, signature) = frame.split_at(end.ok_or(status::SECURITY_CHECKS)?);
                if !keys.is_mac(signed, signature) {
                    return Err(status::SECURITY_CHECKS);
                }
                let content = &signed[SYMMETRIC_BYTES..];
                match self.mode {
                    Mode::SignAndEncrypt => unpadded(content).ok_or(status::SECURITY_CHECKS)?,
                    Mode::None | Mode::Sign => content,
                }
            }
        };
        let mut reader = Reader(content);
        let (Some(sequence), Some(request)) = (reader.u32(), reader.u32()) else { return Err(status::DECODING) };
        let body = reader.0.to_vec();
        self.follows(sequence)?;
        Ok(Chunk { request, body })
    }

    fn next_number(&mut self) -> u32 {
        self.sent = self.sent.wrapping_add(1);
        self.sent
    }

    /// A response as chunks of at most `chunk` bytes.
    pub fn write(&mut self, request: u32, body: &[u8], chunk: usize) -> Result<Vec<u8>, Status> {
        // Padding and its length are at most a block.
        let around =
            SYMMETRIC_BYTES + SEQUENCE_BYTES + if self.mode == Mode::None { 0 } else { MAC_BYTES + BLOCK_BYTES };
        let mut out = Vec::new();
        let mut parts = body.chunks(chunk - around).peekable();
        while let Some(part) = parts.next() {
            let (token, number) = (self.token(), self.next_number());
            let keys = &self.tokens.last().ok_or(status::CHANNEL_INVALID)?.server;
            let mut frame = Writer::default();
            frame.0.extend(b"MSG");
            frame.u8(if parts.peek().is_some() { b'C' } else { b'F' });
            frame.u32(0);
            frame.u32(self.id);
            frame.u32(token);
            frame.u32(number);
            frame.u32(request);
            frame.0.extend(part);
            let mut frame = frame.0;
            if self.mode == Mode::SignAndEncrypt {
                let secured = frame.len() - SYMMETRIC_BYTES + 1 + MAC_BYTES;
                pad(&mut frame, secured, BLOCK_BYTES);
            }
            let size = frame.len() + if self.mode == Mode::None { 0 } else { MAC_BYTES };
            frame[4..8].copy_from_slice(&(size as u32).to_le_bytes());
            if self.mode != Mode::None {
                let mac = keys.mac(&frame);
                frame.extend(mac);
            }
            if self.mode == Mode::SignAndEncrypt {
                keys.encrypt(&mut frame[SYMMETRIC_BYTES..]).ok_or(status::INTERNAL)?;
            }
            out.extend(frame);
        }
        Ok(out)
    }

    /// The answer to the message that opened the channel; signing takes some milliseconds.
    pub fn write_opening(&mut self, request: u32, body: &[u8], own: &Own) -> Result<Vec<u8>, Status> {
        let number = self.next_number();
        let mut frame = Writer::default();
        frame.0.extend(b"OPNF");
        frame.u32(0);
        frame.u32(self.id);
        frame.text(self.policy.uri());
        match &self.client {
            Some(client) => {
                frame.bytes(&own.certificate);
                frame.bytes(&thumbprint(&client.der));
            }
            None => {
                frame.null();
                frame.null();
            }
        }
        let head = frame.0.len();
        frame.u32(number);
        frame.u32(request);
        frame.0.extend(body);
        let mut frame = frame.0;
        let Some(client) = &self.client else {
            let size = frame.len() as u32;
            frame[4..8].copy_from_slice(&size.to_le_bytes());
            return Ok(frame);
        };
        let block = self.policy.block_content(&client.key);
        // A key of more than 2048 bits needs a second byte for the length of the padding.
        let more = usize::from(client.key.size() > 256);
        let secured = frame.len() - head + 1 + more + own.key.size();
        let padding = (block - secured % block) % block;
        frame.push(padding as u8);
        frame.extend(std::iter::repeat_n(padding as u8, padding));
        frame.extend(std::iter::repeat_n((padding >> 8) as u8, more));
        let size = head + (frame.len() - head + own.key.size()) / block * client.key.size();
        frame[4..8].copy_from_slice(&(size as u32).to_le_bytes());
        let signature = self.policy.sign(&own.key, &frame).ok_or(status::INTERNAL)?;
        frame.extend(signature);
        let encrypted = self.policy.encrypt(&client.key, &frame[head..]).ok_or(status::INTERNAL)?;
        frame.truncate(head);
        frame.extend(encrypted);
        Ok(frame)
    }
}

/// Adds padding and its length, so that `secured` bytes become whole blocks.
fn pad(frame: &mut Vec<u8>, secured: usize, block: usize) {
    let padding = (block - secured % block) % block;
    frame.extend(std::iter::repeat_n(padding as u8, padding + 1));
}

#[cfg(test)]
impl Channel {
    /// What `writer` writes as a server, `reader` reads.
    pub fn share(writer: &mut Channel, reader: &mut Channel) {
        (reader.id, writer.sent) = (writer.id, 0);
        let server = writer.tokens[0].server.clone();
        reader.tokens[0].client = server;
        reader.received = Some(0);
    }

    /// The next frame is the first one again.
    pub fn restart(writer: &mut Channel, reader: &mut Channel) {
        (writer.sent, reader.received) = (0, Some(0));
    }
}
