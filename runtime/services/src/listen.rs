//! Accepting clients: those of the connection list, and not too many.

use std::collections::HashMap;
use std::net::{IpAddr, SocketAddr};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use plcc_abi::services::Right;
use tokio::net::{TcpListener, TcpStream};

use crate::limits::{CONNECTIONS_MAX, CONNECTIONS_OF_ONE_MAX, PAGE_CONNECTIONS_MAX, PAGE_CONNECTIONS_OF_ONE_MAX};
use crate::rights::Clients;

/// An open port.
pub struct Door {
    /// As flags name it: `s7`.
    pub service: &'static str,
    pub listener: std::net::TcpListener,
    pub clients: Clients,
    pub open: Open,
}

/// Opens a port.
pub fn open(service: &'static str, address: SocketAddr, clients: Clients) -> Result<Door, String> {
    let failed = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::PermissionDenied => {
            format!("--{service}: port {} needs a right of the system; ports from 1024 on do not", address.port())
        }
        _ => format!("--{service}: cannot listen on {address}: {error}"),
    };
    let listener = std::net::TcpListener::bind(address).map_err(failed)?;
    listener.set_nonblocking(true).map_err(failed)?;
    let most = match service {
        "web" => (PAGE_CONNECTIONS_MAX, PAGE_CONNECTIONS_OF_ONE_MAX),
        _ => (CONNECTIONS_MAX, CONNECTIONS_OF_ONE_MAX),
    };
    Ok(Door { service, listener, clients, open: Open { most, ..Open::default() } })
}

/// Connections by computer, and how many there have been.
#[derive(Clone, Default)]
pub struct Open {
    now: Arc<Mutex<HashMap<IpAddr, usize>>>,
    accepted: Arc<AtomicU64>,
    refused: Arc<AtomicU64>,
    /// How many there may be at once, and how many of one computer.
    most: (usize, usize),
}

impl Open {
    /// Connections now, accepted and refused ones.
    pub fn counts(&self) -> (usize, u64, u64) {
        let now = self.now.lock().unwrap_or_else(PoisonError::into_inner).values().sum();
        (now, self.accepted.load(Ordering::Relaxed), self.refused.load(Ordering::Relaxed))
    }

    /// A place for a connection; `None`: there are too many.
    fn enter(&self, from: IpAddr) -> Option<Place> {
        let mut open = self.now.lock().unwrap_or_else(PoisonError::into_inner);
        let all: usize = open.values().sum();
        let own = open.get(&from).copied().unwrap_or(0);
        let (most, most_of_one) = self.most;
        if all >= most || own >= most_of_one {
            return None;
        }
        open.insert(from, own + 1);
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
        let mut open = self.open.now.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(count) = open.get_mut(&self.from) {
            *count -= 1;
            if *count == 0 {
                open.remove(&self.from);
            }
        }
    }
}

/// A client that was let in.
pub struct Visitor {
    pub stream: TcpStream,
    pub from: IpAddr,
    pub right: Right,
}

/// Lets clients in for ever; each one is served by what `serve` makes for it.
pub async fn accept<F: Future<Output = ()> + Send + 'static>(door: Door, serve: impl Fn(Visitor) -> F) {
    let listener = match TcpListener::from_std(door.listener) {
        Ok(listener) => listener,
        // The descriptor was one a moment ago.
        Err(error) => {
            crate::say(&format!("--{}: {error}", door.service));
            return;
        }
    };
    loop {
        let Ok((stream, from)) = listener.accept().await else {
            // No free descriptor: one may be free soon.
            tokio::time::sleep(Duration::from_millis(100)).await;
            continue;
        };
        let from = from.ip().to_canonical();
        // A client that may not come in gets a closed connection.
        let Some((right, place)) = door.clients.of(from).zip(door.open.enter(from)) else {
            door.open.refused.fetch_add(1, Ordering::Relaxed);
            continue;
        };
        door.open.accepted.fetch_add(1, Ordering::Relaxed);
        // An answer that waits for more bytes would come late.
        let _ = stream.set_nodelay(true);
        let served = serve(Visitor { stream, from, right });
        tokio::spawn(async move {
            served.await;
            drop(place);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_computer_leaves_room_for_others() {
        let open = Open { most: (3, 2), ..Open::default() };
        let [one, other] = [1u8, 2].map(|last| IpAddr::from([10, 0, 0, last]));
        let first = open.enter(one);
        let _second = open.enter(one);
        assert!(first.is_some() && open.enter(one).is_none());
        let _third = open.enter(other);
        assert!(open.enter(other).is_none(), "all places are taken");
        drop(first);
        assert!(open.enter(other).is_some());
        assert_eq!(open.counts().0, 2);
    }
}
