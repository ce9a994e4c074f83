//! Requests of this station: NETR and NETW that are on their way.

use std::time::{Duration, Instant};

use super::code;
use super::frame::{Body, Frame};
use crate::communication::link::Link;
use crate::s7200::sockets::Dialer;

/// NETR and NETW that may be active at a time. Source: S7-200 system manual, Network Read and Network Write.
pub const ACTIVE_MAX: usize = 8;
/// How long a station may take to answer.
const ANSWER_NS: u64 = 1_000_000_000;
const ANSWER: Duration = Duration::from_nanos(ANSWER_NS);

/// Another station of the link.
struct Partner {
    station: u8,
    dialer: Dialer,
    link: Option<Link>,
}

/// An active NETR or NETW.
struct Request {
    /// Its table, as offset from the memory base.
    table: u32,
    frame: Frame,
    /// Bytes that the answer brings.
    wanted: usize,
    sent: bool,
    since: u64,
    host_since: Instant,
}

/// A NETR or NETW that has ended.
#[derive(Debug, PartialEq, Eq)]
pub struct Done {
    pub table: u32,
    pub code: u8,
    pub data: Vec<u8>,
}

#[derive(Default)]
pub struct Client {
    partners: Vec<Partner>,
    requests: Vec<Request>,
    next_tag: u8,
}

impl Client {
    /// Stations with the addresses where they listen; those without a right one are not reached.
    pub fn new(stations: &[(u8, String)]) -> Client {
        let partner = |(station, address): &(u8, String)| {
            Some(Partner { station: *station, dialer: Dialer::new(address).ok()?, link: None })
        };
        Client { partners: stations.iter().filter_map(partner).collect(), ..Client::default() }
    }

    pub fn is_full(&self) -> bool {
        self.requests.len() >= ACTIVE_MAX
    }

    /// A request waits for a station that is known.
    pub fn is_waiting(&self) -> bool {
        self.requests.iter().any(|request| self.partners.iter().any(|partner| partner.station == request.frame.to))
    }

    /// Begins a request; there is room.
    pub fn begin(&mut self, table: u32, to: u8, from: u8, body: Body, now: u64) {
        while self.requests.iter().any(|request| request.frame.tag == self.next_tag) {
            self.next_tag = self.next_tag.wrapping_add(1);
        }
        let wanted = match &body {
            Body::Read { count, .. } => usize::from(*count),
            Body::Write { .. } | Body::Answer { .. } => 0,
        };
        let frame = Frame { to, from, tag: self.next_tag, body };
        self.next_tag = self.next_tag.wrapping_add(1);
        self.requests.push(Request { table, frame, wanted, sent: false, since: now, host_since: Instant::now() });
    }

    /// Moves all on; returns those that have ended.
    pub fn work(&mut self, now: u64, is_virtual: bool) -> Vec<Done> {
        let mut done = Vec::new();
        for partner in &mut self.partners {
            partner.work(&mut self.requests, &mut done);
        }
        let partners = &self.partners;
        self.requests.retain(|request| {
            let known = partners.iter().any(|partner| partner.station == request.frame.to);
            // A station that may be there gets the second in its own time, too: the virtual clock runs ahead of it.
            let late = now.saturating_sub(request.since) >= ANSWER_NS
                && (!known || !is_virtual || request.host_since.elapsed() >= ANSWER);
            if late {
                done.push(Done { table: request.table, code: code::TIME_OUT, data: Vec::new() });
            }
            !late
        });
        done
    }
}

impl Partner {
    fn work(&mut self, requests: &mut Vec<Request>, done: &mut Vec<Done>) {
        let station = self.station;
        if self.link.is_none() && requests.iter().any(|request| request.frame.to == station) {
            self.link = self.dialer.work();
        }
        let Some(link) = &mut self.link else { return };
        for request in requests.iter_mut().filter(|request| request.frame.to == station && !request.sent) {
            link.send(&request.frame.encode());
            request.sent = true;
        }
        link.work();
        let sound = loop {
            match Frame::take(&mut link.input) {
                Ok(Some(frame)) => answered(&frame, station, requests, done),
                Ok(None) => break true,
                Err(_) => break false,
            }
        };
        if !sound {
            for request in requests.extract_if(.., |request| request.frame.to == station) {
                done.push(Done { table: request.table, code: code::RECEIVE, data: Vec::new() });
            }
        }
        if !sound || link.ended || link.broken {
            // Reads and writes may be repeated, so they go out again when the station is back.
            requests.iter_mut().filter(|request| request.frame.to == station).for_each(|request| request.sent = false);
            self.link = None;
        }
    }
}

/// Ends the request that an answer belongs to. An answer that comes too late belongs to none.
fn answered(frame: &Frame, station: u8, requests: &mut Vec<Request>, done: &mut Vec<Done>) {
    let Body::Answer { code, data } = &frame.body else { return };
    let mine = |request: &Request| request.frame.tag == frame.tag && request.frame.to == station && request.sent;
    let Some(index) = requests.iter().position(mine) else { return };
    let request = requests.remove(index);
    let (code, data) = match *code {
        0 if frame.from != station || data.len() != request.wanted => (code::RECEIVE, Vec::new()),
        0 => (0, data.clone()),
        other => (other & 0x0F, Vec::new()),
    };
    done.push(Done { table: request.table, code, data });
}
