//! The server: connections, their times and limits.

use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::timeout;

use super::frame::{self, Reader, Received};
use super::session::{PDU_BEFORE, Rights, Session};
use crate::access::Access;
use crate::link::Link;

/// Connections at once, and those of one computer.
const CONNECTIONS_MAX: usize = 32;
const CONNECTIONS_OF_ONE_MAX: usize = 8;
/// How long a client may take to ask for a connection, to agree on the length of PDUs, and to complete a frame.
const CONNECT_TIME: Duration = Duration::from_secs(5);
const SETUP_TIME: Duration = Duration::from_secs(10);
const FRAME_TIME: Duration = Duration::from_secs(5);
/// How long it may take to take an answer.
const ANSWER_TIME: Duration = Duration::from_secs(5);

/// A disconnect reason of ISO 8073: the address is unknown.
const ADDRESS_UNKNOWN: u8 = 3;

/// Connections by computer.
#[derive(Clone, Default)]
struct Open(Arc<Mutex<HashMap<IpAddr, usize>>>);

impl Open {
    /// A place for a connection; `None`: there are too many.
    fn enter(&self, from: IpAddr) -> Option<Place> {
        let mut open = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let all: usize = open.values().sum();
        let own = open.entry(from).or_default();
        if all >= CONNECTIONS_MAX || *own >= CONNECTIONS_OF_ONE_MAX {
            return None;
        }
        *own += 1;
        Some(Place { open: self.clone(), from })
    }
}

/// Is given back when the connection ends.
struct Place {
    open: Open,
    from: IpAddr,
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut open = self.open.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(count) = open.get_mut(&self.from) {
            *count -= 1;
            if *count == 0 {
                open.remove(&self.from);
            }
        }
    }
}

/// Serves clients until the CPU ends.
pub async fn serve(listener: TcpListener, link: Link, rights: Rights) {
    let open = Open::default();
    let mut reference = 0u16;
    loop {
        let Ok((stream, from)) = listener.accept().await else {
            // No free descriptor: one may be free soon.
            tokio::time::sleep(Duration::from_millis(100)).await;
            continue;
        };
        // Beyond the limit a connection is closed at once.
        let Some(place) = open.enter(from.ip()) else { continue };
        reference = reference % 0x7FFF + 1;
        let (link, reference) = (link.clone(), reference);
        tokio::spawn(async move {
            // An answer that waits for more bytes would come late.
            let _ = stream.set_nodelay(true);
            connection(stream, link, rights, reference).await;
            drop(place);
        });
    }
}

/// Answers one client until it breaks the rules, goes, or the CPU ends.
async fn connection(mut stream: TcpStream, link: Link, rights: Rights, reference: u16) -> Option<()> {
    let mut reader = Reader::default();
    let mut session: Option<Session> = None;
    let mut buffer = [0; 2048];
    loop {
        let pdu_max = session.as_ref().map_or(PDU_BEFORE, Session::pdu_max);
        while let Some(received) = reader.next(pdu_max).ok()? {
            let answer = match (received, session.take()) {
                (Received::Connect(request), _) if request.is_for_cpu() => {
                    session = Some(Session::new(rights));
                    Some(request.confirm(reference))
                }
                (Received::Connect(request), _) => {
                    let _ = timeout(ANSWER_TIME, stream.write_all(&request.refuse(ADDRESS_UNKNOWN))).await;
                    return None;
                }
                (Received::Pdu(_), None) => return None,
                (Received::Pdu(pdu), Some(mut own)) => {
                    let (own, answer) = link
                        .ask(move |cpu| {
                            let answer = own.answer(&pdu, &Access(cpu));
                            (own, answer)
                        })
                        .await?;
                    session = Some(own);
                    answer.ok()?.map(|pdu| frame::data(&pdu))
                }
            };
            if let Some(answer) = answer {
                timeout(ANSWER_TIME, stream.write_all(&answer)).await.ok()?.ok()?;
            }
        }
        let patience = match &session {
            _ if reader.is_waiting() => Some(FRAME_TIME),
            None => Some(CONNECT_TIME),
            Some(session) if session.pdu.is_none() => Some(SETUP_TIME),
            Some(_) => None,
        };
        let read = stream.read(&mut buffer);
        let count = match patience {
            Some(time) => timeout(time, read).await.ok()?,
            None => read.await,
        };
        match count.ok()? {
            0 => return None,
            count => reader.feed(&buffer[..count]),
        }
    }
}
