//! One connection: how it is set up, kept up and used.
//!
//! ```text
//!            ┌─────────── 5 ───────────┐
//!            ▼                         │
//! passive: Listening ──── 1 ────────► Up     1 a partner has connected        `accept`, `take_caller`
//! active:  Connecting ─ 2 ─► Greeting ─┘     2 TCP is connected: ISO sends its CR   `connected`; `resolved` before it
//!            │    ▲            │ 3           3 the partner's CC has come      `greeted`
//!            4    │            4             4 refused                        `fail`
//!            └─► Resting ◄─────┘             5 lost: set up again             `restart`
//! ```

use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, TcpListener, ToSocketAddrs};
use std::sync::mpsc::{self, Receiver, TryRecvError};

use socket2::{Domain, Protocol as IpProtocol, Socket, Type};

use super::datagrams::Datagrams;
use super::description::{Description, Protocol};
use super::iso::{self, Offer, Transport};
use super::link::Link;
use super::status;

/// Time between two attempts of an active side, by the clock of the CPU.
const REST_NS: u64 = 100_000_000;
/// An attempt that takes longer has failed.
const ATTEMPT_NS: u64 = 10_000_000_000;
/// Unread bytes keep a connection open for this time after the partner has closed it.
const LEAVE_NS: u64 = 1_000_000_000;
/// Messages that wait for a receiver.
const MESSAGES_MAX: usize = 4;

enum State {
    /// Passive TCP with its own listener; passive ISO-on-TCP shares one.
    Listening(Option<TcpListener>),
    /// The address of a partner with a name is asked for.
    Resolving {
        answer: Receiver<Option<Ipv4Addr>>,
        until: u64,
    },
    Connecting {
        socket: Socket,
        until: u64,
    },
    /// ISO: the request is sent.
    Greeting {
        link: Link,
        until: u64,
    },
    Up {
        link: Link,
        transport: Option<Transport>,
        ended_at: Option<u64>,
    },
    /// UDP: there is nothing to be set up.
    Datagrams(Datagrams),
    /// Until the next attempt.
    Resting {
        until: u64,
    },
}

/// See the module comment.
pub struct Connection {
    pub description: Description,
    /// Blocks that use it.
    pub users: u32,
    /// Bytes of the user that were given to it to be sent, and that the program has taken, modulo 2^32.
    pub sent_bytes: u32,
    pub received_bytes: u32,
    /// How often it was lost, modulo 2^16.
    pub losses: u16,
    /// How often an attempt failed, modulo 2^16.
    pub failures: u16,
    iso_port: u16,
    state: State,
    /// `losses` when the last job began.
    job_losses: u16,
    /// The last job was sent before the connection was lost.
    sent_before_loss: bool,
}

/// The result of a receive job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Receive {
    Bytes(Vec<u8>),
    /// A message that is longer than the receive area; it is gone.
    TooLong,
    Nothing,
}

/// A listener on all interfaces. `Err`: STATUS.
pub fn listen(port: u16) -> Result<TcpListener, u16> {
    let listener = TcpListener::bind((Ipv4Addr::UNSPECIFIED, port)).map_err(|_| status::INCONSISTENT)?;
    listener.set_nonblocking(true).map_err(|_| status::TEMPORARY)?;
    Ok(listener)
}

/// The next partner that has connected.
pub fn accept(listener: &TcpListener) -> Option<(Link, Ipv4Addr)> {
    match listener.accept().ok()? {
        (stream, SocketAddr::V4(from)) => Some((Link::new(stream).ok()?, *from.ip())),
        _ => None,
    }
}

impl Connection {
    /// Begins to set it up. `Err`: STATUS.
    pub fn open(description: Description, iso_port: u16, now: u64) -> Result<Connection, u16> {
        let state = begin(&description, iso_port, now)?;
        Ok(Connection {
            description,
            users: 1,
            sent_bytes: 0,
            received_bytes: 0,
            losses: 0,
            failures: 0,
            iso_port,
            state,
            job_losses: 0,
            sent_before_loss: false,
        })
    }

    pub fn is_up(&self) -> bool {
        matches!(self.state, State::Up { .. } | State::Datagrams(_))
    }

    /// Ends the connection to the partner, if there is one, and begins to set it up again.
    pub fn reset(&mut self, now: u64) {
        if let State::Datagrams(datagrams) = &mut self.state {
            datagrams.forget();
        } else if self.is_up() {
            self.state = State::Resting { until: now };
            self.state = self.restart(now);
        }
    }

    /// Moves it on.
    pub fn work(&mut self, now: u64) {
        let state = std::mem::replace(&mut self.state, State::Resting { until: now });
        self.state = self.moved(state, now);
    }

    fn moved(&mut self, state: State, now: u64) -> State {
        match state {
            State::Listening(Some(listener)) => self.listened(listener),
            State::Listening(None) => State::Listening(None),
            State::Datagrams(mut datagrams) => {
                datagrams.work();
                State::Datagrams(datagrams)
            }
            State::Resolving { answer, until } => self.resolved(answer, until, now),
            State::Connecting { socket, until } => self.connected(socket, until, now),
            State::Greeting { link, until } => self.greeted(link, until, now),
            State::Up { mut link, mut transport, ended_at } => {
                link.work();
                let sound = transport.as_mut().is_none_or(|iso| iso.work(&mut link.input, MESSAGES_MAX).is_ok());
                let left = link.ended.then(|| ended_at.unwrap_or(now));
                let unread = match &transport {
                    Some(iso) => !iso.messages.is_empty(),
                    None => !link.input.is_empty(),
                };
                let waits = left.is_none_or(|since| unread && now < since.saturating_add(LEAVE_NS));
                if sound && !link.broken && waits {
                    return State::Up { link, transport, ended_at: left };
                }
                if self.losses == self.job_losses {
                    self.sent_before_loss = link.is_drained() && !link.broken;
                }
                drop(link);
                self.restart(now)
            }
            State::Resting { until } if now < until => State::Resting { until },
            State::Resting { .. } => match begin(&self.description, self.iso_port, now) {
                Ok(state) => state,
                Err(_) => self.fail(now),
            },
        }
    }

    fn listened(&mut self, listener: TcpListener) -> State {
        let Description { remote, .. } = self.description;
        // A partner that is not the one described is turned away.
        while let Some((link, from)) = accept(&listener) {
            let port = link.partner_port();
            if remote.is_none_or(|wanted| wanted == from)
                && (self.description.remote_port == 0 || Some(self.description.remote_port) == port)
            {
                return State::Up { link, transport: None, ended_at: None };
            }
        }
        State::Listening(Some(listener))
    }

    fn resolved(&mut self, answer: Receiver<Option<Ipv4Addr>>, until: u64, now: u64) -> State {
        match answer.try_recv() {
            Ok(Some(remote)) => match connect(&self.description, remote, self.iso_port, now) {
                Ok(state) => state,
                Err(_) => self.fail(now),
            },
            Err(TryRecvError::Empty) if now < until => State::Resolving { answer, until },
            Ok(None) | Err(_) => self.fail(now),
        }
    }

    fn connected(&mut self, socket: Socket, until: u64, now: u64) -> State {
        if matches!(socket.take_error(), Ok(Some(_)) | Err(_)) {
            return self.fail(now);
        }
        if socket.peer_addr().is_err() {
            return if now < until { State::Connecting { socket, until } } else { self.fail(now) };
        }
        let Ok(mut link) = Link::new(socket.into()) else { return self.fail(now) };
        match self.description.protocol {
            Protocol::Tcp | Protocol::Udp => State::Up { link, transport: None, ended_at: None },
            Protocol::Iso => {
                let Description { id, local_tsap, remote_tsap, .. } = &self.description;
                link.send(&iso::request(*id, local_tsap, remote_tsap));
                State::Greeting { link, until }
            }
        }
    }

    fn greeted(&mut self, mut link: Link, until: u64, now: u64) -> State {
        link.work();
        match iso::confirmed(&mut link.input) {
            Ok(Some(transport)) => State::Up { link, transport: Some(transport), ended_at: None },
            Ok(None) if !link.ended && !link.broken && now < until => State::Greeting { link, until },
            Ok(None) | Err(_) => self.fail(now),
        }
    }

    fn fail(&mut self, now: u64) -> State {
        self.failures = self.failures.wrapping_add(1);
        State::Resting { until: now.saturating_add(REST_NS) }
    }

    fn restart(&mut self, now: u64) -> State {
        self.losses = self.losses.wrapping_add(1);
        match begin(&self.description, self.iso_port, now) {
            Ok(state) => state,
            Err(_) => State::Resting { until: now.saturating_add(REST_NS) },
        }
    }

    /// Waits for a partner that makes this offer.
    pub fn wants(&self, offer: &Offer, from: Ipv4Addr) -> bool {
        let Description { protocol, active, remote, local_tsap, remote_tsap, .. } = &self.description;
        *protocol == Protocol::Iso
            && !active
            && !self.is_up()
            && *local_tsap == offer.called
            && (remote_tsap.is_empty() || *remote_tsap == offer.calling)
            && remote.is_none_or(|wanted| wanted == from)
    }

    /// Accepts a partner that [`Connection::wants`] has approved.
    pub fn take_caller(&mut self, mut link: Link, offer: &Offer) {
        let (answer, transport) = iso::confirm(offer, self.description.id);
        link.send(&answer);
        self.state = State::Up { link, transport: Some(transport), ended_at: None };
    }

    /// Begins to send; false if it is not up.
    pub fn send(&mut self, bytes: &[u8]) -> bool {
        let sends = self.begin_to_send(bytes);
        self.note_sent(sends, bytes);
        sends
    }

    fn note_sent(&mut self, sends: bool, bytes: &[u8]) {
        if sends {
            self.sent_bytes = self.sent_bytes.wrapping_add(bytes.len() as u32);
        }
    }

    fn note_received(&mut self, received: &Receive) {
        if let Receive::Bytes(bytes) = received {
            self.received_bytes = self.received_bytes.wrapping_add(bytes.len() as u32);
        }
    }

    fn begin_to_send(&mut self, bytes: &[u8]) -> bool {
        self.job_losses = self.losses;
        self.sent_before_loss = false;
        if let State::Datagrams(datagrams) = &mut self.state {
            let Description { remote, remote_port, .. } = self.description;
            let to = remote.filter(|_| remote_port != 0).map(|remote| SocketAddrV4::new(remote, remote_port));
            return to.is_some_and(|to| datagrams.send(bytes, to));
        }
        let State::Up { link, transport, ended_at: None } = &mut self.state else { return false };
        match transport {
            Some(iso) => link.send(&iso.message(bytes)),
            None => link.send(bytes),
        }
        !link.broken
    }

    /// Everything is sent; `None`: the connection was lost before.
    pub fn is_sent(&self) -> Option<bool> {
        match &self.state {
            State::Up { link, .. } if self.losses == self.job_losses => Some(link.is_drained()),
            State::Datagrams(_) => Some(true),
            _ => self.sent_before_loss.then_some(true),
        }
    }

    /// Takes received bytes: at most `room`, or exactly that many if `exact`. A message is taken as a whole.
    pub fn receive(&mut self, room: usize, exact: bool) -> Receive {
        let received = self.take(room, exact);
        self.note_received(&received);
        received
    }

    fn take(&mut self, room: usize, exact: bool) -> Receive {
        if let State::Datagrams(datagrams) = &mut self.state {
            return datagrams.receive(room).0;
        }
        let State::Up { link, transport, .. } = &mut self.state else { return Receive::Nothing };
        if let Some(iso) = transport {
            return match iso.messages.pop_front() {
                Some(message) if message.len() > room => Receive::TooLong,
                Some(message) => Receive::Bytes(message),
                None => Receive::Nothing,
            };
        }
        let there = link.input.len();
        if there == 0 || (exact && there < room) {
            return Receive::Nothing;
        }
        Receive::Bytes(link.input.drain(..there.min(room)).collect())
    }
}

/// UDP.
impl Connection {
    /// Sends a datagram; `None`: this is not UDP; false: it cannot be sent now.
    pub fn send_to(&mut self, bytes: &[u8], to: SocketAddrV4) -> Option<bool> {
        let State::Datagrams(datagrams) = &mut self.state else { return None };
        let sends = datagrams.send(bytes, to);
        self.note_sent(sends, bytes);
        Some(sends)
    }

    /// Takes a datagram of at most `room` bytes, and who sent it; `None`: this is not UDP.
    pub fn receive_from(&mut self, room: usize) -> Option<(Receive, Option<SocketAddrV4>)> {
        let State::Datagrams(datagrams) = &mut self.state else { return None };
        let (received, from) = datagrams.receive(room);
        self.note_received(&received);
        Some((received, from))
    }
}

/// The first state. `Err`: STATUS.
fn begin(description: &Description, iso_port: u16, now: u64) -> Result<State, u16> {
    let iso = description.protocol == Protocol::Iso;
    if description.protocol == Protocol::Udp {
        return Datagrams::open(description.local_port).map(State::Datagrams);
    }
    if description.active && !description.remote_name.is_empty() {
        let answer = ask_for(description.remote_name.clone());
        return Ok(State::Resolving { answer, until: now.saturating_add(ATTEMPT_NS) });
    }
    match description.remote.filter(|_| description.active) {
        Some(remote) => connect(description, remote, iso_port, now),
        None => Ok(State::Listening(if iso { None } else { Some(listen(description.local_port)?) })),
    }
}

/// Asks the host for the address of a name, which may take seconds.
fn ask_for(name: String) -> Receiver<Option<Ipv4Addr>> {
    let (sender, answer) = mpsc::channel();
    std::thread::spawn(move || {
        let found = (name.as_str(), 0u16).to_socket_addrs().ok().and_then(|mut all| {
            all.find_map(|address| match address {
                SocketAddr::V4(address) => Some(*address.ip()),
                SocketAddr::V6(_) => None,
            })
        });
        // Nothing waits for it if the connection has ended.
        let _ = sender.send(found);
    });
    answer
}

/// Begins to connect to the partner. `Err`: STATUS.
fn connect(description: &Description, remote: Ipv4Addr, iso_port: u16, now: u64) -> Result<State, u16> {
    let socket = Socket::new(Domain::IPV4, Type::STREAM, Some(IpProtocol::TCP)).map_err(|_| status::RESOURCES)?;
    socket.set_nonblocking(true).map_err(|_| status::TEMPORARY)?;
    if description.local_port != 0 {
        // Without it a new connection from the same port would have to wait for minutes.
        let _ = socket.set_reuse_address(true);
        let own = SocketAddr::from((Ipv4Addr::UNSPECIFIED, description.local_port));
        socket.bind(&own.into()).map_err(|_| status::INCONSISTENT)?;
    }
    let port = if description.protocol == Protocol::Iso { iso_port } else { description.remote_port };
    let until = now.saturating_add(ATTEMPT_NS);
    match socket.connect(&SocketAddr::from((remote, port)).into()) {
        Ok(()) => Ok(State::Connecting { socket, until }),
        Err(error) if error.raw_os_error() == Some(libc::EINPROGRESS) => Ok(State::Connecting { socket, until }),
        Err(_) => Err(status::TEMPORARY),
    }
}
