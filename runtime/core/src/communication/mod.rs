//! Open user communication: TCP, ISO-on-TCP and UDP with IPv4 partners.
//!
//! No call waits: sockets are non-blocking, and every call and the end of each cycle advance all connections. A lost
//! connection is set up again automatically until it is closed; STOP closes all.
//!
//! Under the virtual clock a cycle takes no host time, so a partner would never get to answer: a cycle in which a block waited
//! for one takes [`PATIENCE`] of host time.
//!
//! Source: S7-1200 reference, open user communication.

mod connection;
mod datagrams;
mod description;
mod iso;
pub(crate) mod link;

use std::net::{Ipv4Addr, TcpListener};
use std::time::Duration;

pub use connection::{Connection, Receive};
pub use datagrams::DATAGRAM_BYTES_MAX;
pub use description::{Description, LENGTHS, Protocol};
use iso::Offer;
use link::Link;

/// Connections of an S7-1200 for open user communication.
pub const CONNECTIONS_MAX: usize = 8;
/// Longest send or receive job in bytes.
pub const JOB_BYTES_MAX: u32 = 8192;
/// Port of ISO-on-TCP. Source: RFC 1006.
pub const ISO_PORT: u16 = 102;
/// Host time that a cycle takes under the virtual clock while a block waits for a partner.
pub const PATIENCE: Duration = Duration::from_millis(1);
/// Partners on the ISO port that have not yet requested a connection, and how long they may wait.
const CALLERS_MAX: usize = 8;
const CALLER_NS: u64 = 5_000_000_000;

/// STATUS of a connection that cannot be made.
pub mod status {
    pub const NOT_CONNECTED: u16 = 0x80A1;
    pub const NO_SUCH: u16 = 0x80A3;
    pub const INCONSISTENT: u16 = 0x80B3;
    pub const RESOURCES: u16 = 0x80C3;
    pub const TEMPORARY: u16 = 0x80C4;
}

/// A partner on the ISO port that has not yet requested a connection.
struct Caller {
    link: Link,
    from: Ipv4Addr,
    until: u64,
}

/// All connections of a CPU.
#[derive(Default)]
pub struct Communication {
    connections: Vec<Connection>,
    iso_listener: Option<TcpListener>,
    callers: Vec<Caller>,
    /// Port of ISO-on-TCP, if not [`ISO_PORT`].
    iso_port: Option<u16>,
    /// A block waits for a partner in this cycle.
    waiting: bool,
}

impl Communication {
    /// ISO-on-TCP uses `port` on both sides.
    pub fn set_iso_port(&mut self, port: u16) {
        self.iso_port = Some(port);
    }

    /// Sets a connection up, or joins the one with the same description. `alone`: it must not exist. `Err`: STATUS.
    pub fn open(&mut self, description: Description, alone: bool, now: u64) -> Result<(), u16> {
        if let Some(known) = self.connection(description.id) {
            if alone {
                return Err(status::NO_SUCH);
            }
            if known.description != description {
                return Err(status::INCONSISTENT);
            }
            known.users = known.users.saturating_add(1);
            return Ok(());
        }
        if self.connections.len() >= CONNECTIONS_MAX {
            return Err(status::RESOURCES);
        }
        let port = description.local_port;
        let passive_iso = |other: &Description| other.protocol == Protocol::Iso && !other.active;
        let collides = |other: &Description| match description.protocol {
            Protocol::Tcp | Protocol::Udp => {
                port != 0 && other.local_port == port && other.protocol == description.protocol
            }
            Protocol::Iso => {
                passive_iso(&description)
                    && passive_iso(other)
                    && other.local_tsap == description.local_tsap
                    && other.remote_tsap == description.remote_tsap
            }
        };
        if self.connections.iter().any(|other| collides(&other.description)) {
            return Err(status::INCONSISTENT);
        }
        if passive_iso(&description) {
            self.listen_iso()?;
        }
        let connection = Connection::open(description, self.iso_port.unwrap_or(ISO_PORT), now)?;
        self.connections.push(connection);
        Ok(())
    }

    /// Leaves a connection; the last one to leave ends it. `force`: ends it for all. `Err`: STATUS.
    pub fn close(&mut self, id: u16, force: bool) -> Result<(), u16> {
        let known = self.connection(id).ok_or(status::NO_SUCH)?;
        known.users = known.users.saturating_sub(1);
        if force || known.users == 0 {
            self.connections.retain(|connection| connection.description.id != id);
            let iso = |connection: &Connection| connection.description.protocol == Protocol::Iso;
            if !self.connections.iter().any(iso) {
                self.iso_listener = None;
                self.callers.clear();
            }
        }
        Ok(())
    }

    pub fn connection(&mut self, id: u16) -> Option<&mut Connection> {
        self.connections.iter_mut().find(|connection| connection.description.id == id)
    }

    /// There is something to be moved on.
    #[inline]
    pub fn is_open(&self) -> bool {
        !self.connections.is_empty() || self.iso_listener.is_some()
    }

    /// Moves everything on; `now` is the time of the CPU in nanoseconds.
    pub fn work(&mut self, now: u64) {
        for connection in &mut self.connections {
            connection.work(now);
        }
        self.accept_iso(now);
    }

    /// A block waits for a partner.
    pub fn note_waiting(&mut self) {
        self.waiting = true;
    }

    /// True if a block has waited since the last question.
    pub fn take_waiting(&mut self) -> bool {
        std::mem::take(&mut self.waiting)
    }

    /// STOP.
    pub fn close_all(&mut self) {
        self.connections.clear();
        self.callers.clear();
        self.iso_listener = None;
    }

    fn listen_iso(&mut self) -> Result<(), u16> {
        if self.iso_listener.is_none() {
            self.iso_listener = Some(connection::listen(self.iso_port.unwrap_or(ISO_PORT))?);
        }
        Ok(())
    }

    /// Assigns partners on the ISO port to the connections that they request by TSAP.
    fn accept_iso(&mut self, now: u64) {
        let Some(listener) = &self.iso_listener else { return };
        while self.callers.len() < CALLERS_MAX
            && let Some((link, from)) = connection::accept(listener)
        {
            self.callers.push(Caller { link, from, until: now.saturating_add(CALLER_NS) });
        }
        for mut caller in std::mem::take(&mut self.callers) {
            caller.link.work();
            match iso::requested(&mut caller.link.input) {
                Ok(Some(offer)) => self.assign(caller, &offer),
                Ok(None) if !caller.link.ended && now < caller.until => self.callers.push(caller),
                Ok(None) | Err(_) => {}
            }
        }
    }

    fn assign(&mut self, mut caller: Caller, offer: &Offer) {
        match self.connections.iter_mut().find(|connection| connection.wants(offer, caller.from)) {
            Some(connection) => connection.take_caller(caller.link, offer),
            None => caller.link.send(&iso::refuse(offer)),
        }
    }
}
