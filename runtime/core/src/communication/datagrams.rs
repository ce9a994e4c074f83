//! UDP: messages without a connection.

use std::collections::VecDeque;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, UdpSocket};

use super::connection::Receive;
use super::status;

/// Datagrams that wait for a receiver; further ones are lost, as UDP allows.
const DATAGRAMS_MAX: usize = 16;
/// The longest datagram of a job. Source: S7-1200 reference, TUSEND and TURCV.
pub const DATAGRAM_BYTES_MAX: u32 = 1472;

/// An open port, and what has arrived.
pub struct Datagrams {
    socket: UdpSocket,
    arrived: VecDeque<(Vec<u8>, SocketAddrV4)>,
}

impl Datagrams {
    /// `Err`: STATUS.
    pub fn open(port: u16) -> Result<Datagrams, u16> {
        let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, port)).map_err(|_| status::INCONSISTENT)?;
        socket.set_nonblocking(true).map_err(|_| status::TEMPORARY)?;
        // A job may go to all stations of a network.
        let _ = socket.set_broadcast(true);
        Ok(Datagrams { socket, arrived: VecDeque::new() })
    }

    /// Takes what has arrived.
    pub fn work(&mut self) {
        let mut buffer = [0; DATAGRAM_BYTES_MAX as usize + 1];
        while self.arrived.len() < DATAGRAMS_MAX {
            // An error of an earlier datagram, which was not received, does not matter.
            let Ok((count, SocketAddr::V4(from))) = self.socket.recv_from(&mut buffer) else { return };
            if count <= DATAGRAM_BYTES_MAX as usize {
                self.arrived.push_back((buffer[..count].to_vec(), from));
            }
        }
    }

    /// False: the system does not take it.
    pub fn send(&mut self, bytes: &[u8], to: SocketAddrV4) -> bool {
        // The first attempt may only report that an earlier datagram was not taken.
        let send = || self.socket.send_to(bytes, to).is_ok_and(|count| count == bytes.len());
        send() || send()
    }

    /// The next datagram.
    pub fn receive(&mut self, room: usize) -> (Receive, Option<SocketAddrV4>) {
        self.work();
        match self.arrived.pop_front() {
            Some((bytes, from)) if bytes.len() > room => (Receive::TooLong, Some(from)),
            Some((bytes, from)) => (Receive::Bytes(bytes), Some(from)),
            None => (Receive::Nothing, None),
        }
    }

    /// What has arrived is lost.
    pub fn forget(&mut self) {
        self.work();
        self.arrived.clear();
    }
}
