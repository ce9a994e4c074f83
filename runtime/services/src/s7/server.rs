//! Connections of S7 clients, and those to partners of the program.

use std::net::IpAddr;
use std::sync::Arc;

use plcc_abi::services::{Protection, Right};
use plcc_runtime::partners::Board;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::sync::Notify;
use tokio::time::{Instant, sleep, sleep_until, timeout, timeout_at};

use super::dial;
use super::frame::{self, ConnectRequest, Reader, Received};
use super::partner::{Partner, Taken};
use super::session::{Gate, PDU_BEFORE, Session};
use super::userdata;
use crate::access::Access;
use crate::limits::{ANSWER_TIME, CONNECT_TIME, FRAME_TIME, PARTNER_PAUSE, SETUP_TIME};
use crate::link::Link;
use crate::listen::Visitor;
use crate::password::Guard;
use crate::rights::Clients;

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
    /// Connections that the program has configured.
    pub board: Option<Arc<Board>>,
}

/// Answers one client until it breaks the rules, goes, or the CPU ends. `reference`: a number of the connection, not 0.
pub async fn serve(visitor: Visitor, server: Server, reference: u16) {
    let has_password = server.guard.has_password();
    let gate = Gate { right: visitor.right, protection: server.protection, has_password };
    let mut line = Line::new(visitor.stream, visitor.from, server, gate);
    line.reference = reference;
    let _ = line.talk().await;
}

/// Keeps the connection to a partner up for ever. `rights`: what partners may do here, if anything.
pub async fn call(server: Server, line: usize, rights: Option<Clients>) {
    loop {
        let _ = attempt(&server, line, rights.as_ref()).await;
        sleep(PARTNER_PAUSE).await;
    }
}

async fn attempt(server: &Server, number: usize, rights: Option<&Clients>) -> Option<()> {
    let board = server.board.clone()?;
    let connection = board.connections().get(number)?;
    let address = connection.partner.as_deref()?;
    let pdu = server.link.ask(|cpu| super::plc::Plc::family(&Access(cpu)).pdu_max()).await?;
    let stream = timeout(CONNECT_TIME, TcpStream::connect(address)).await.ok()?.ok()?;
    let _ = stream.set_nodelay(true);
    let from = stream.peer_addr().ok()?.ip().to_canonical();
    let has_password = server.guard.has_password();
    let gate = match rights.and_then(|rights| rights.of(from)) {
        Some(right) => Gate { right, protection: server.protection, has_password },
        // Nothing at all.
        None => Gate { right: Right::Read, protection: Protection::Complete, has_password: false },
    };
    let mut line = Line::new(stream, from, server.clone(), gate);
    let until = Instant::now() + SETUP_TIME;
    line.send(&frame::connect(dial::REFERENCE, &connection.local_tsap, &connection.remote_tsap)).await?;
    let Received::Confirm(piece_bytes) = timeout_at(until, line.receive()).await.ok()?? else { return None };
    line.piece_bytes = piece_bytes;
    line.send(&frame::data(&dial::set_up(pdu), piece_bytes)).await?;
    let agreed = loop {
        match timeout_at(until, line.receive()).await.ok()?? {
            Received::Pdu(answer) if answer.is_empty() => {}
            Received::Pdu(answer) => break dial::agreed(&answer, pdu)?,
            Received::Connect(_) | Received::Confirm(_) => return None,
        }
    };
    line.session = Some(Session::agreed(gate, agreed.pdu, agreed.jobs));
    line.configured = Some(number);
    line.join();
    line.talk().await
}

/// One connection.
struct Line {
    stream: TcpStream,
    from: IpAddr,
    server: Server,
    gate: Gate,
    reference: u16,
    reader: Reader,
    piece_bytes: usize,
    session: Option<Session>,
    /// The connection of the program that it is.
    configured: Option<usize>,
    partner: Option<Partner>,
    /// There is something to do for the partner.
    work: Arc<Notify>,
    /// Since when there is no agreement on the length of PDUs.
    opened: Instant,
    /// Since when a frame is not complete.
    begun: Option<Instant>,
}

impl Line {
    fn new(stream: TcpStream, from: IpAddr, server: Server, gate: Gate) -> Line {
        Line {
            stream,
            from,
            server,
            gate,
            reference: dial::REFERENCE,
            reader: Reader::default(),
            piece_bytes: PIECE_BYTES,
            session: None,
            configured: None,
            partner: None,
            work: Arc::default(),
            opened: Instant::now(),
            begun: None,
        }
    }

    /// `None`: the connection has to end.
    async fn send(&mut self, frames: &[u8]) -> Option<()> {
        timeout(ANSWER_TIME, self.stream.write_all(frames)).await.ok()?.ok()
    }

    /// The next thing that comes.
    async fn receive(&mut self) -> Option<Received> {
        let mut buffer = [0; 2048];
        loop {
            if let Some(received) = self.reader.next(PDU_BEFORE).ok()? {
                return Some(received);
            }
            match self.stream.read(&mut buffer).await.ok()? {
                0 => return None,
                count => self.reader.feed(&buffer[..count]),
            }
        }
    }

    /// From now on it carries the jobs of the program.
    fn join(&mut self) {
        let session = self.session.as_ref();
        let agreed = session.and_then(|session| Some((session.pdu?, session.jobs)));
        if let Some(((pdu, jobs), number)) = agreed.zip(self.configured)
            && let Some(board) = self.server.board.clone()
        {
            let work = self.work.clone();
            self.partner = Some(Partner::new(board, number, pdu, jobs, move || work.notify_one()));
        }
    }

    /// Until the connection ends.
    async fn talk(&mut self) -> Option<()> {
        let mut buffer = [0; 2048];
        loop {
            while let Some(received) = self.reader.next(PDU_BEFORE).ok()? {
                self.begun = None;
                for frames in self.answers(received).await? {
                    self.send(&frames).await?;
                }
            }
            if let Some(partner) = &mut self.partner {
                for pdu in partner.work(std::time::Instant::now()).ok()? {
                    let frames = frame::data(&pdu, self.piece_bytes);
                    self.send(&frames).await?;
                }
            }
            if self.session.as_ref().and_then(Session::due).is_some_and(|due| due <= std::time::Instant::now()) {
                for pdu in self.indications().await? {
                    let frames = frame::data(&pdu, self.piece_bytes);
                    self.send(&frames).await?;
                }
            }
            match self.reader.is_waiting() {
                true => self.begun = self.begun.or_else(|| Some(Instant::now())),
                false => self.begun = None,
            }
            let ready = match &self.session {
                None => Some(self.opened + CONNECT_TIME),
                Some(session) if session.pdu.is_none() => Some(self.opened + SETUP_TIME),
                Some(_) => None,
            };
            // Whatever comes meanwhile: a client that sends a byte now and then is not faster.
            let complete = self.begun.map(|begun| begun + FRAME_TIME);
            let end = ready.into_iter().chain(complete).min();
            let look = self.partner.as_ref().and_then(Partner::deadline);
            let due = self.session.as_ref().and_then(Session::due);
            let next = end.into_iter().chain(look.into_iter().chain(due).map(Instant::from_std)).min();
            tokio::select! {
                count = self.stream.read(&mut buffer) => match count.ok()? {
                    0 => return None,
                    count => self.reader.feed(&buffer[..count]),
                },
                () = self.work.notified() => {}
                () = async { sleep_until(next.unwrap_or(self.opened)).await }, if next.is_some() => {
                    if end.is_some_and(|end| end <= Instant::now()) {
                        return None;
                    }
                }
            }
        }
    }

    /// The frames that answer what came. `None`: the connection has to end.
    async fn answers(&mut self, received: Received) -> Option<Vec<Vec<u8>>> {
        match received {
            Received::Confirm(_) => None,
            Received::Connect(request) => {
                self.partner = None;
                self.configured = self.configured_for(&request);
                if self.configured.is_none() && !request.is_for_cpu() {
                    self.send(&request.refuse(ADDRESS_UNKNOWN)).await?;
                    return None;
                }
                if self.session.as_ref().is_some_and(|session| session.pdu.is_some()) {
                    self.opened = Instant::now();
                }
                self.session = Some(Session::new(self.gate));
                self.piece_bytes = request.piece_bytes();
                Some(vec![request.confirm(self.reference)])
            }
            // Some CPUs and clients show by it that they are alive.
            Received::Pdu(pdu) if pdu.is_empty() && self.session.is_some() => Some(Vec::new()),
            Received::Pdu(pdu) => {
                // Longer than agreed on: the session says so.
                let fits = self.session.as_ref().is_none_or(|session| pdu.len() <= session.pdu_max());
                if let Some(partner) = self.partner.as_mut().filter(|_| fits)
                    && let Taken::Own(pdus) = partner.take(&pdu, std::time::Instant::now()).ok()?
                {
                    return Some(pdus.iter().map(|pdu| frame::data(pdu, self.piece_bytes)).collect());
                }
                let answer = self.ask(pdu).await?;
                Some(answer.into_iter().map(|pdu| frame::data(&pdu, self.piece_bytes)).collect())
            }
        }
    }

    /// The answer of the CPU.
    async fn ask(&mut self, pdu: Vec<u8>) -> Option<Option<Vec<u8>>> {
        let mut own = self.session.take()?;
        let before = own.setups;
        if let Some(password) = userdata::password(&pdu) {
            own.judge(self.server.guard.check(self.from, password).await);
        }
        let (own, answer) = self
            .server
            .link
            .ask(move |cpu| {
                let answer = own.answer(&pdu, &Access(cpu));
                (own, answer)
            })
            .await?;
        let joins = own.setups != before;
        self.session = Some(own);
        if joins {
            self.join();
        }
        answer.ok()
    }

    /// What cyclic jobs send now.
    async fn indications(&mut self) -> Option<Vec<Vec<u8>>> {
        let mut own = self.session.take()?;
        let (own, pdus) = self
            .server
            .link
            .ask(move |cpu| {
                let pdus = own.indications(&Access(cpu), std::time::Instant::now());
                (own, pdus)
            })
            .await?;
        self.session = Some(own);
        Some(pdus)
    }

    /// The connection of the program that a partner asks for.
    fn configured_for(&self, request: &ConnectRequest) -> Option<usize> {
        let board = self.server.board.as_ref()?;
        board.connections().iter().position(|own| {
            let from = own.partner.as_ref().and_then(|text| text.parse::<std::net::SocketAddr>().ok());
            !own.active
                && own.local_tsap == request.called
                && (own.remote_tsap.is_empty() || own.remote_tsap == request.calling)
                && from.is_none_or(|from| from.ip().to_canonical() == self.from)
        })
    }
}
