//! MQTT: what a broker gets, and what comes from it.
//!
//! - [`values`]: values as JSON; [`sparkplug`]: as metrics of Sparkplug B, which can be written.
//! - `outage`: what is told when the broker is away.
//!
//! Both look at the values again and again, and keep one connection. While the broker is away nothing waits for it: when it is back, it gets
//! the values of that moment.

mod outage;
pub mod sparkplug;
pub mod values;

use std::sync::Arc;
use std::time::{Duration, Instant};

use rumqttc::{Event, EventLoop, MqttOptions, Packet, Publish, TlsConfiguration, Transport};
use tokio::sync::watch;
use tokio_rustls::rustls::ClientConfig;

use crate::limits::{MQTT_KEEP_ALIVE, MQTT_RECEIVED_MAX, MQTT_RETRY, MQTT_SENT_MAX};
use outage::Outage;

/// Ports of MQTT without and with TLS.
const PORT: u16 = 1883;
const PORT_TLS: u16 = 8883;
/// From one look at the values to the next.
const LOOK: Duration = Duration::from_millis(100);
/// The environment variable with the password, so that it need not be in a URL.
const PASSWORD_VARIABLE: &str = "PLCC_MQTT_PASSWORD";

/// `mqtt://[USER[:PASSWORD]@]HOST[:PORT][/PREFIX]`, or `mqtts://` with TLS.
#[derive(Clone, PartialEq, Eq)]
pub struct Broker {
    is_secure: bool,
    host: String,
    port: u16,
    user: Option<(String, String)>,
    /// First part of topics; empty: that of the service.
    prefix: String,
}

impl std::fmt::Debug for Broker {
    /// Without the password.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{self}")
    }
}

impl std::fmt::Display for Broker {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let scheme = if self.is_secure { "mqtts" } else { "mqtt" };
        match self.host.contains(':') {
            true => write!(f, "{scheme}://[{}]:{}", self.host, self.port)?,
            false => write!(f, "{scheme}://{}:{}", self.host, self.port)?,
        }
        if self.prefix.is_empty() { Ok(()) } else { write!(f, "/{}", self.prefix) }
    }
}

impl Broker {
    /// `Err`: what is wrong, without the password.
    pub fn parse(text: &str) -> Result<Broker, String> {
        let wrong = || "write mqtt://HOST:PORT/PREFIX, with USER@ before HOST if the broker wants one".to_string();
        let (is_secure, rest) = match (text.strip_prefix("mqtt://"), text.strip_prefix("mqtts://")) {
            (Some(rest), _) => (false, rest),
            (None, Some(rest)) => (true, rest),
            (None, None) => return Err(wrong()),
        };
        let (place, prefix) = rest.split_once('/').unwrap_or((rest, ""));
        let (user, place) = match place.rsplit_once('@') {
            Some((user, place)) => (Some(user), place),
            None => (None, place),
        };
        // An address of IPv6 is in brackets.
        let (host, port) = match place.rsplit_once(':').filter(|(host, _)| !host.contains(':') || host.ends_with(']')) {
            // What comes after the colon may be a password whose `@` is missing: the message does not show it.
            Some((host, port)) => match port.parse::<u16>() {
                Ok(port) if port != 0 => (host, port),
                Ok(_) | Err(_) => return Err(format!("the port is not a number from 1 to 65535; {}", wrong())),
            },
            None if is_secure => (place, PORT_TLS),
            None => (place, PORT),
        };
        let host = host.trim_matches(['[', ']']);
        let prefix = prefix.trim_matches('/');
        if host.is_empty() {
            return Err(wrong());
        }
        if prefix.contains(['+', '#', '\0']) {
            return Err(
                "PREFIX is the beginning of topics, without `+` and `#`, which are for those who subscribe".to_string()
            );
        }
        let user = user.map(|user| {
            let (name, password) = user.split_once(':').unwrap_or((user, ""));
            (name.to_string(), password.to_string())
        });
        Ok(Broker { is_secure, host: host.to_string(), port, user, prefix: prefix.to_string() })
    }

    /// The connection is encrypted.
    pub fn is_secure(&self) -> bool {
        self.is_secure
    }

    fn options(&self, client: String, tls: Option<&Arc<ClientConfig>>) -> MqttOptions {
        let mut options = MqttOptions::new(client, &self.host, self.port);
        options.set_keep_alive(MQTT_KEEP_ALIVE);
        options.set_max_packet_size(MQTT_RECEIVED_MAX, MQTT_SENT_MAX);
        if let Some(config) = tls {
            options.set_transport(Transport::tls_with_config(TlsConfiguration::Rustls(config.clone())));
        }
        if let Some((name, password)) = &self.user {
            let password = match password.as_str() {
                "" => std::env::var(PASSWORD_VARIABLE).unwrap_or_default(),
                password => password.to_string(),
            };
            options.set_credentials(name, password);
        }
        options
    }
}

/// Where a publisher sends to.
pub struct Target {
    pub broker: Broker,
    /// What the broker must show, and what this side shows; `None`: the connection is not encrypted.
    pub tls: Option<Arc<ClientConfig>>,
}

/// What a connection is to do besides being there.
trait Duties: Send {
    /// Before each attempt to connect.
    fn prepare(&mut self, _options: &mut MqttOptions) {}

    /// A message has come.
    fn receive(&mut self, _message: Publish) {}
}

/// A publisher that does nothing with the connection besides sending.
struct NoDuties;

impl Duties for NoDuties {}

/// Keeps the connection: `send` gets an odd number with each new one, and an even one when it is lost.
async fn connect(mut events: EventLoop, send: watch::Sender<u64>, broker: String, mut duties: impl Duties) {
    let mut pause = *MQTT_RETRY.start();
    let mut outage = Outage::default();
    duties.prepare(&mut events.mqtt_options);
    loop {
        let event = events.poll().await;
        let mut is_back = false;
        if let Some(back) = outage.lasts(Instant::now()) {
            pause = *MQTT_RETRY.start();
            is_back = back;
        }
        match event {
            Ok(Event::Incoming(Packet::ConnAck(_))) => {
                is_back |= outage.made(Instant::now());
                if !outage.is_unstable() {
                    pause = *MQTT_RETRY.start();
                }
                send.send_modify(|number| *number = (*number | 1) + u64::from(*number % 2 == 1) * 2);
            }
            Ok(Event::Incoming(Packet::Publish(message))) => duties.receive(message),
            Ok(_) => {}
            Err(error) => {
                is_back = false;
                let reason = outage::reason(&error);
                if outage.lost(&reason) {
                    crate::say(&format!("no connection to {broker}: {reason}; trying again"));
                }
                // What was not delivered is no longer current when the broker is back: it gets all values then.
                events.clean();
                events.pending.clear();
                send.send_modify(|number| *number += *number % 2);
                tokio::time::sleep(pause).await;
                pause = (pause * 2).min(*MQTT_RETRY.end());
                duties.prepare(&mut events.mqtt_options);
            }
        }
        if is_back {
            crate::say(&format!("{broker} is back"));
        }
        if send.is_closed() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytes::BytesMut;
    use proptest::prelude::*;

    #[test]
    fn urls_of_brokers() {
        let parse = |text: &str| Broker::parse(text).map(|broker| (broker.to_string(), broker.user));
        assert_eq!(parse("mqtt://broker").unwrap().0, "mqtt://broker:1883");
        assert_eq!(parse("mqtts://broker").unwrap().0, "mqtts://broker:8883");
        assert_eq!(parse("mqtt://10.0.0.1:1884/plant/tank/").unwrap().0, "mqtt://10.0.0.1:1884/plant/tank");
        assert_eq!(Broker::parse("mqtt://[fd00::1]:1884").unwrap().host, "fd00::1");
        assert_eq!(parse("mqtt://[fd00::1]/plant").unwrap().0, "mqtt://[fd00::1]:1883/plant");
        assert_eq!(parse("mqtt://me:s@cret@b").unwrap().1, Some(("me".to_string(), "s@cret".to_string())));
        for (text, says) in [
            ("broker", "write mqtt://HOST"),
            ("mqtt://", "write mqtt://HOST"),
            ("mqtts://", "write mqtt://HOST"),
            ("http://b", "write mqtt://HOST"),
            ("mqtt://b:x", "the port is not a number"),
            ("mqtt://b:0", "the port is not a number"),
            ("mqtt://b/a/#", "PREFIX is the beginning of topics, without `+` and `#`"),
        ] {
            assert!(Broker::parse(text).unwrap_err().starts_with(says), "{text}");
        }
    }

    /// Messages of brokers: CONNACK, SUBACK, PUBLISH with quality of service 0 and 1, PUBACK, PINGRESP.
    const FRAMES: [&[u8]; 6] = [
        &[0x20, 2, 0, 0],
        &[0x90, 3, 0, 1, 1],
        &[0x30, 7, 0, 3, b'a', b'/', b'b', 1, 2],
        &[0x32, 9, 0, 3, b'a', b'/', b'b', 0, 1, 1, 2],
        &[0x40, 2, 0, 1],
        &[0xD0, 0],
    ];

    fn read_all(bytes: &[u8]) {
        let mut stream = BytesMut::from(bytes);
        while Packet::read(&mut stream, MQTT_RECEIVED_MAX).is_ok() {}
    }

    // A broker may break the rules; the library that reads its frames must not.
    proptest! {
        #![proptest_config(ProptestConfig::with_cases(10_000))]

        #[test]
        fn random_frames_of_a_broker_do_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            read_all(&bytes);
        }

        #[test]
        fn changed_frames_of_a_broker_do_no_harm(
            which in prop::collection::vec(0..FRAMES.len(), 1..4),
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..5),
        ) {
            let mut bytes: Vec<u8> = which.iter().flat_map(|index| FRAMES[*index]).copied().collect();
            for (at, value) in changes {
                let at = at.index(bytes.len());
                bytes[at] = value;
            }
            read_all(&bytes);
        }
    }

    #[test]
    fn a_password_is_not_shown() {
        let broker = Broker::parse("mqtt://me:secret@b").unwrap();
        assert!(!format!("{broker:?} {broker}").contains("secret"));
    }
}
