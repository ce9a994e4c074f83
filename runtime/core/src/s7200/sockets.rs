//! TCP addresses of plc.toml: listening at them, and connecting to them without blocking.

use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::time::{Duration, Instant};

use socket2::{Domain, Protocol, Socket, Type};

use crate::communication::link::Link;

/// Host time between two attempts to connect.
const REST: Duration = Duration::from_millis(50);
/// An attempt that takes longer has failed.
const ATTEMPT: Duration = Duration::from_secs(5);

/// `127.0.0.1:4000`, `[::1]:4000`, `localhost:4000`.
pub fn socket_address(text: &str) -> Option<SocketAddr> {
    match text.trim().strip_prefix("localhost:") {
        Some(port) => Some(SocketAddr::from((Ipv4Addr::LOCALHOST, port.parse::<u16>().ok()?))),
        None => text.trim().parse().ok(),
    }
}

/// A listener that does not block. `Err`: why there is none.
pub(super) fn listen(text: &str) -> Result<TcpListener, String> {
    let wrong = |error: &dyn std::fmt::Display| format!("cannot listen at {text}: {error}");
    let address = socket_address(text).ok_or_else(|| wrong(&"no address"))?;
    let listener = TcpListener::bind(address).map_err(|error| wrong(&error))?;
    listener.set_nonblocking(true).map_err(|error| wrong(&error))?;
    Ok(listener)
}

/// The next partner that has connected.
pub(super) fn accept(listener: &TcpListener) -> Option<Link> {
    let (stream, _) = listener.accept().ok()?;
    Link::new(stream).ok()
}

enum State {
    Resting { until: Instant },
    Connecting { socket: Socket, until: Instant },
}

/// Connects to an address, again and again until somebody is there.
pub(super) struct Dialer {
    address: SocketAddr,
    state: Option<State>,
}

impl Dialer {
    pub fn new(text: &str) -> Result<Dialer, String> {
        let address = socket_address(text).ok_or_else(|| format!("`{text}` is not an address"))?;
        Ok(Dialer { address, state: None })
    }

    /// Makes progress; returns the link when it is connected. Afterwards it dials again.
    pub fn work(&mut self) -> Option<Link> {
        let now = Instant::now();
        match self.state.take() {
            Some(State::Resting { until }) if now < until => self.state = Some(State::Resting { until }),
            None | Some(State::Resting { .. }) => self.begin(now),
            Some(State::Connecting { socket, until }) => {
                if matches!(socket.take_error(), Ok(Some(_)) | Err(_)) {
                    self.rest(now);
                } else if socket.peer_addr().is_ok() {
                    return Link::new(socket.into()).ok();
                } else if now < until {
                    self.state = Some(State::Connecting { socket, until });
                } else {
                    self.rest(now);
                }
            }
        }
        None
    }

    fn begin(&mut self, now: Instant) {
        match connect(self.address) {
            Ok(socket) => self.state = Some(State::Connecting { socket, until: now + ATTEMPT }),
            Err(_) => self.rest(now),
        }
    }

    fn rest(&mut self, now: Instant) {
        self.state = Some(State::Resting { until: now + REST });
    }
}

fn connect(address: SocketAddr) -> std::io::Result<Socket> {
    let socket = Socket::new(Domain::for_address(address), Type::STREAM, Some(Protocol::TCP))?;
    socket.set_nonblocking(true)?;
    match socket.connect(&address.into()) {
        Err(error) if error.raw_os_error() != Some(libc::EINPROGRESS) => Err(error),
        Ok(()) | Err(_) => Ok(socket),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses() {
        assert_eq!(socket_address("localhost:80"), socket_address("127.0.0.1:80"));
        assert!(socket_address("[::1]:7000").is_some());
        for wrong in ["", "localhost", "127.0.0.1", "1.2.3.4:70000", "plc:4000", ":4000"] {
            assert_eq!(socket_address(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn dials_until_somebody_is_there() {
        let address = TcpListener::bind("127.0.0.1:0").and_then(|free| free.local_addr()).unwrap();
        let mut dialer = Dialer::new(&address.to_string()).unwrap();
        for _ in 0..10 {
            assert!(dialer.work().is_none());
        }
        let listener = listen(&address.to_string()).unwrap();
        let end = Instant::now() + Duration::from_secs(10);
        while dialer.work().is_none() {
            assert!(Instant::now() < end);
            std::thread::sleep(Duration::from_millis(1));
        }
        assert!(accept(&listener).is_some());
    }
}
