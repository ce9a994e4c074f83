//! A time without a working broker, and what is reported about it.
//!
//! A broker may refuse connections at first, and then the password; each reason is reported once. One that takes connections and loses
//! each of them at once is not back: only a connection that lasts is reported.

use std::io::{self, ErrorKind};
use std::time::{Duration, Instant};

use rumqttc::mqttbytes::Error as FrameError;
use rumqttc::{ConnectReturnCode, ConnectionError, StateError};

/// At most this many reasons of one outage are reported.
const REASONS_MAX: usize = 4;
/// The reason if the broker ends the connection, in whatever way.
const CLOSED: &str = "it has closed the connection";
/// A connection that has lasted this long works.
const LASTS: Duration = Duration::from_secs(10);

/// See the module comment.
#[derive(Default)]
pub(super) struct Outage {
    /// Those that were reported.
    reasons: Vec<String>,
    /// When the connection was made, if it has not lasted yet.
    made: Option<Instant>,
    /// The last line said that the broker is back.
    is_back: bool,
    /// A connection was lost soon after it was made.
    is_unstable: bool,
}

impl Outage {
    /// A connection is made. True: tell that the broker is back.
    pub(super) fn made(&mut self, now: Instant) -> bool {
        self.made = Some(now);
        self.is_back = !self.is_unstable && !self.reasons.is_empty();
        self.is_back
    }

    /// Connections do not last.
    pub(super) fn is_unstable(&self) -> bool {
        self.is_unstable
    }

    /// Something came or went. `Some`: the connection has lasted, and the outage is over; true: tell that the broker is back.
    pub(super) fn lasts(&mut self, now: Instant) -> Option<bool> {
        self.made.filter(|made| now.duration_since(*made) >= LASTS)?;
        let old = std::mem::take(self);
        Some(!old.reasons.is_empty() && !old.is_back)
    }

    /// The connection is lost, or cannot be made. True: tell the reason.
    pub(super) fn lost(&mut self, reason: &str) -> bool {
        self.is_unstable |= self.made.take().is_some();
        if std::mem::take(&mut self.is_back) {
            self.reasons.clear();
        }
        let is_new = self.reasons.len() < REASONS_MAX && self.reasons.iter().all(|told| told != reason);
        if is_new {
            self.reasons.push(reason.to_string());
        }
        is_new
    }
}

/// Why there is no connection, in plain words.
pub(super) fn reason(error: &ConnectionError) -> String {
    match error {
        ConnectionError::Io(error)
        | ConnectionError::MqttState(StateError::Io(error) | StateError::Deserialization(FrameError::Io(error))) => {
            network_reason(error)
        }
        ConnectionError::NetworkTimeout | ConnectionError::FlushTimeout => "it does not answer in time".to_string(),
        ConnectionError::MqttState(StateError::AwaitPingResp) => "it has stopped answering".to_string(),
        ConnectionError::MqttState(StateError::ConnectionAborted) => CLOSED.to_string(),
        ConnectionError::MqttState(StateError::Deserialization(error)) => format!("what it sends is not MQTT: {error}"),
        ConnectionError::ConnectionRefused(code) => match code {
            ConnectReturnCode::BadUserNamePassword => "it refuses the user or the password".to_string(),
            ConnectReturnCode::NotAuthorized => "it wants a user with a right to connect".to_string(),
            ConnectReturnCode::ServiceUnavailable => "it takes no connections at present".to_string(),
            ConnectReturnCode::BadClientId => "it refuses the name of the client".to_string(),
            ConnectReturnCode::RefusedProtocolVersion => "it does not know MQTT 3.1.1".to_string(),
            ConnectReturnCode::Success => "it refuses the connection".to_string(),
        },
        other => other.to_string(),
    }
}

fn network_reason(error: &io::Error) -> String {
    match error.kind() {
        ErrorKind::BrokenPipe
        | ErrorKind::ConnectionReset
        | ErrorKind::ConnectionAborted
        | ErrorKind::UnexpectedEof => CLOSED.to_string(),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_reason_of_an_outage_is_told_once() {
        let mut outage = Outage::default();
        assert!(!outage.made(Instant::now()), "it was not away");
        let mut outage = Outage::default();
        let told = |outage: &mut Outage, reasons: &str| -> String {
            reasons.matches(|reason: char| outage.lost(&reason.to_string())).collect()
        };
        assert_eq!(told(&mut outage, "ddpdp"), "dp");
        assert!(outage.made(Instant::now()));
        // Not without an end, if a broker has ever new ones.
        assert_eq!(told(&mut outage, "dabcef"), "dabc");
    }

    #[test]
    fn a_broker_that_loses_each_connection_is_not_back() {
        let start = Instant::now();
        let mut outage = Outage::default();
        assert!(outage.lost("refused"));
        assert!(outage.made(start));
        assert!(outage.lost("damaged"), "the last line said that it is back");
        for _ in 0..20 {
            assert!(!outage.made(start));
            assert_eq!(outage.lasts(start), None);
            assert!(!outage.lost("damaged"));
            assert!(outage.is_unstable());
        }
        assert!(!outage.made(start));
        assert_eq!(outage.lasts(start + LASTS), Some(true), "now it is");
        assert!(!outage.is_unstable());
        assert_eq!(outage.lasts(start + 2 * LASTS), None);
        assert!(outage.lost("refused"), "another outage");
        assert!(outage.made(start + 3 * LASTS));
        assert_eq!(outage.lasts(start + 4 * LASTS), Some(false), "that was told when it was made");
    }

    #[test]
    fn reasons_are_told_in_plain_words() {
        let state = |error| reason(&ConnectionError::MqttState(error));
        assert_eq!(state(StateError::ConnectionAborted), "it has closed the connection");
        let damaged = StateError::Deserialization(rumqttc::mqttbytes::Error::MalformedRemainingLength);
        assert_eq!(state(damaged), "what it sends is not MQTT: Malformed remaining length");
        for kind in [ErrorKind::BrokenPipe, ErrorKind::ConnectionReset] {
            assert_eq!(state(StateError::Deserialization(FrameError::Io(kind.into()))), CLOSED);
            assert_eq!(reason(&ConnectionError::Io(kind.into())), CLOSED);
        }
        let none = io::Error::from(ErrorKind::ConnectionRefused);
        assert_eq!(reason(&ConnectionError::Io(none)), io::Error::from(ErrorKind::ConnectionRefused).to_string());
        let refused = ConnectionError::ConnectionRefused(ConnectReturnCode::BadUserNamePassword);
        assert_eq!(reason(&refused), "it refuses the user or the password");
    }
}
