//! Connections of S7 clients.

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::time::timeout;

use plcc_abi::services::Protection;

use super::frame::{self, Reader, Received};
use super::session::{Gate, PDU_BEFORE, Session};
use super::userdata;
use crate::access::Access;
use crate::limits::{ANSWER_TIME, CONNECT_TIME, FRAME_TIME, SETUP_TIME};
use crate::link::Link;
use crate::listen::Visitor;
use crate::password::Guard;

/// A disconnect reason of ISO 8073: the address is unknown.
const ADDRESS_UNKNOWN: u8 = 3;
/// Bytes of a PDU in one frame before the client says how many.
const PIECE_BYTES: usize = 1021;

/// What all connections share.
#[derive(Clone)]
pub struct Server {
    pub link: Link,
    pub guard: Guard,
    pub protection: Protection,
}

/// Answers one client until it breaks the rules, goes, or the CPU ends. `reference`: a number of the connection, not 0.
pub async fn serve(visitor: Visitor, server: Server, reference: u16) {
    let _ = connection(visitor, server, reference).await;
}

async fn connection(mut visitor: Visitor, server: Server, reference: u16) -> Option<()> {
    let stream = &mut visitor.stream;
    let has_password = server.guard.has_password();
    let gate = Gate { right: visitor.right, protection: server.protection, has_password };
    let mut reader = Reader::default();
    let mut session: Option<Session> = None;
    let mut piece_bytes = PIECE_BYTES;
    let mut buffer = [0; 2048];
    loop {
        let pdu_max = session.as_ref().map_or(PDU_BEFORE, Session::pdu_max);
        while let Some(received) = reader.next(pdu_max).ok()? {
            let answer = match (received, session.take()) {
                (Received::Connect(request), _) if request.is_for_cpu() => {
                    session = Some(Session::new(gate));
                    piece_bytes = request.piece_bytes();
                    Some(request.confirm(reference))
                }
                (Received::Connect(request), _) => {
                    let _ = timeout(ANSWER_TIME, stream.write_all(&request.refuse(ADDRESS_UNKNOWN))).await;
                    return None;
                }
                (Received::Pdu(_), None) => return None,
                // Some CPUs and clients show by it that they are alive.
                (Received::Pdu(pdu), own) if pdu.is_empty() => {
                    session = own;
                    None
                }
                (Received::Pdu(pdu), Some(mut own)) => {
                    if let Some(password) = userdata::password(&pdu) {
                        own.judge(server.guard.check(visitor.from, password).await);
                    }
                    let (own, answer) = server
                        .link
                        .ask(move |cpu| {
                            let answer = own.answer(&pdu, &Access(cpu));
                            (own, answer)
                        })
                        .await?;
                    session = Some(own);
                    answer.ok()?.map(|pdu| frame::data(&pdu, piece_bytes))
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
