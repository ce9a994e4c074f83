//! Requests from other stations.

use std::net::TcpListener;

use super::frame::Frame;
use crate::communication::link::Link;
use crate::s7200::sockets;

/// Stations that are connected at a time. Source: S7-200 system manual, network: 32 stations a segment.
const GUESTS_MAX: usize = 32;
/// Requests of one station that are answered between two scans.
const REQUESTS_MAX: usize = 32;
/// Answers that a station does not take.
const BACKLOG_MAX: usize = 1 << 14;

pub struct Server {
    listener: TcpListener,
    guests: Vec<Link>,
}

impl Server {
    /// `Err`: why it cannot listen.
    pub fn new(address: &str) -> Result<Server, String> {
        Ok(Server { listener: sockets::listen(address)?, guests: Vec::new() })
    }

    /// Passes every request to `answer`. Disconnects a station that sends anything else.
    pub fn work(&mut self, mut answer: impl FnMut(&Frame) -> Option<Frame>) {
        while self.guests.len() < GUESTS_MAX
            && let Some(guest) = sockets::accept(&self.listener)
        {
            self.guests.push(guest);
        }
        self.guests.retain_mut(|guest| {
            guest.work();
            for _ in 0..REQUESTS_MAX {
                match Frame::take(&mut guest.input) {
                    Ok(Some(frame)) => {
                        if let Some(frame) = answer(&frame) {
                            guest.send(&frame.encode());
                        }
                    }
                    Ok(None) if guest.ended => return false,
                    Ok(None) => break,
                    Err(_) => return false,
                }
            }
            !guest.broken && guest.backlog() <= BACKLOG_MAX
        });
    }
}
