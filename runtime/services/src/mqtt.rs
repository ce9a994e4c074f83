//! Values to an MQTT broker: on change, and all of them again and again.
//!
//! | Topic | Content |
//! | --- | --- |
//! | `PREFIX/state` | `RUN`, `STOP`, or `offline`, which the broker says when the connection breaks |
//! | `PREFIX/value/NAME` | `{"value": 12.5, "type": "REAL", "time": "2026-01-31T06:00:00.125Z"}` |
//!
//! All messages are retained with quality of service 1. While the broker is away nothing waits for it: when it is back, it gets the values of that
//! moment.

use std::time::Duration;

use jiff::Timestamp;
use plcc_abi::ProgramImage;
use plcc_runtime::cpu::Cpu;
use plcc_runtime::options::split_list;
use plcc_runtime::signal::{self, Signal};
use rumqttc::{AsyncClient, Event, EventLoop, LastWill, MqttOptions, Packet, QoS};
use tokio::time::{Instant, MissedTickBehavior, interval};

use crate::link::Link;

/// Port of MQTT without encryption.
const PORT: u16 = 1883;
const PREFIX_DEFAULT: &str = "plc";
const KEEP_ALIVE: Duration = Duration::from_secs(5);
/// From one look at the values to the next.
const LOOK: Duration = Duration::from_millis(100);
/// All values are published again after this time, unless plc.toml names another.
const INTERVAL_DEFAULT: Duration = Duration::from_secs(10);
/// From one try to reach the broker to the next: at first, and at last.
const RETRY: std::ops::RangeInclusive<Duration> = Duration::from_millis(250)..=Duration::from_secs(10);
/// Values that are published.
const VALUES_MAX: usize = 1000;
/// The environment variable with the password, so that it need not be in a URL.
const PASSWORD_VARIABLE: &str = "PLCC_MQTT_PASSWORD";

/// `mqtt://[USER[:PASSWORD]@]HOST[:PORT][/PREFIX]`
#[derive(Clone, PartialEq, Eq)]
pub struct Broker {
    host: String,
    port: u16,
    user: Option<(String, String)>,
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
        write!(f, "mqtt://{}:{}/{}", self.host, self.port, self.prefix)
    }
}

impl Broker {
    /// `Err`: what is wrong, without the password.
    pub fn parse(text: &str) -> Result<Broker, String> {
        let wrong = || "write mqtt://HOST:PORT/PREFIX, with USER@ before HOST if the broker wants one".to_string();
        let rest = text.strip_prefix("mqtt://").ok_or_else(wrong)?;
        let (place, prefix) = rest.split_once('/').unwrap_or((rest, ""));
        let (user, place) = match place.rsplit_once('@') {
            Some((user, place)) => (Some(user), place),
            None => (None, place),
        };
        // An address of IPv6 is in brackets.
        let (host, port) = match place.rsplit_once(':').filter(|(host, _)| !host.contains(':') || host.ends_with(']')) {
            Some((host, port)) => (host, port.parse().map_err(|_| wrong())?),
            None => (place, PORT),
        };
        let host = host.trim_matches(['[', ']']);
        let prefix = prefix.trim_matches('/');
        if host.is_empty() || prefix.contains(['+', '#', '\0']) {
            return Err(wrong());
        }
        let user = user.map(|user| {
            let (name, password) = user.split_once(':').unwrap_or((user, ""));
            (name.to_string(), password.to_string())
        });
        let prefix = if prefix.is_empty() { PREFIX_DEFAULT } else { prefix };
        Ok(Broker { host: host.to_string(), port, user, prefix: prefix.to_string() })
    }

    fn options(&self) -> MqttOptions {
        let topic = format!("{}/state", self.prefix);
        let id = format!("plcc-{}-{}", self.prefix.replace('/', "-"), std::process::id());
        let mut options = MqttOptions::new(id, &self.host, self.port);
        options.set_keep_alive(KEEP_ALIVE);
        options.set_last_will(LastWill::new(topic, "offline", QoS::AtLeastOnce, true));
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

/// What is published, and where.
pub struct Publisher {
    broker: Broker,
    /// Values with the last part of their topics.
    signals: Vec<(String, Signal)>,
    interval: Duration,
}

impl Publisher {
    /// `Err`: a value does not exist, or there is none.
    pub fn new(
        broker: Broker,
        values: &[String],
        interval_ms: Option<u32>,
        image: &ProgramImage,
    ) -> Result<Publisher, String> {
        let mut signals = Vec::new();
        for text in split_list(values) {
            let found = signal::all(&text, image, None).map_err(|error| format!("--publish {text}: {error}"))?;
            signals.extend(found.into_iter().map(|signal| (topic(&signal.name), signal)));
        }
        match signals.len() {
            0 => Err("--mqtt: no values: name them with --publish, or as `values` in [services]".to_string()),
            1..=VALUES_MAX => {
                let interval = interval_ms.map_or(INTERVAL_DEFAULT, |ms| Duration::from_millis(ms.into()));
                Ok(Publisher { broker, signals, interval })
            }
            count => Err(format!("--publish: {count} values; at most {VALUES_MAX} are published")),
        }
    }

    /// As a line about what was opened tells it.
    pub fn text(&self) -> String {
        format!("{} values to {}", self.signals.len(), self.broker)
    }
}

/// The last part of a topic: the name without what brokers take for something else.
fn topic(name: &str) -> String {
    name.replace(['/', '+', '#', '\0', '"'], "_").replace(' ', "")
}

/// The values of one cycle: content without the time, in the order of the signals.
struct Values {
    /// The program has changed: how often, and where its values are.
    renewed: Option<(u64, Signals)>,
    running: bool,
    texts: Vec<String>,
    time: String,
}

/// Values with the last part of their topics, and whether the program has them, which may be a changed one.
type Signals = std::sync::Arc<[(String, Signal, bool)]>;

fn renew(cpu: &Cpu, signals: &Signals) -> Signals {
    let found = signals.iter().map(|(topic, signal, _)| {
        let name = signal.name.clone();
        match signal::Source::find(&name, &cpu.image, None) {
            Ok(source) => (topic.clone(), Signal { name, source }, true),
            Err(_) => (topic.clone(), signal.clone(), false),
        }
    });
    found.collect()
}

fn read(cpu: &Cpu, signals: &Signals, generation: u64) -> Values {
    let renewed = (cpu.generation() != generation).then(|| (cpu.generation(), renew(cpu, signals)));
    let signals = renewed.as_ref().map_or(signals, |(_, signals)| signals);
    let one = |signal: &Signal| {
        let value = signal.source.read(cpu, None).json();
        format!("\"value\": {value}, \"type\": \"{}\"", signal.source.ty())
    };
    let texts = signals.iter().map(|(_, signal, exists)| match exists {
        true => one(signal),
        false => "\"value\": null".to_string(),
    });
    let texts = texts.collect();
    Values { running: !cpu.is_stopped(), texts, time: moment(cpu), renewed }
}

/// The wall clock of the CPU.
fn moment(cpu: &Cpu) -> String {
    let ms = cpu.clock.wall().div_euclid(1_000_000);
    Timestamp::from_millisecond(ms).map_or_else(|_| String::new(), |time| format!("{time:.3}"))
}

/// Publishes until the CPU ends.
pub async fn run(publisher: Publisher, link: Link) {
    let Publisher { broker, signals, interval: every } = publisher;
    let mut signals: Signals = signals.into_iter().map(|(topic, signal)| (topic, signal, true)).collect();
    let mut generation = 0;
    // As many as all values and the state take.
    let (client, events) = AsyncClient::new(broker.options(), signals.len() + 16);
    let (send, mut connected) = tokio::sync::watch::channel(0);
    tokio::spawn(connect(events, send, broker.to_string()));
    let mut sent: Vec<String> = Vec::new();
    let mut state = None;
    let mut last = Instant::now();
    let mut connection = 0;
    let mut ticks = interval(LOOK);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        ticks.tick().await;
        let now = *connected.borrow_and_update();
        // An even number: there is no connection.
        if now % 2 == 0 {
            continue;
        }
        let own = signals.clone();
        let Some(values) = link.ask(move |cpu| read(cpu, &own, generation)).await else { return };
        if let Some(renewed) = values.renewed {
            (generation, signals) = renewed;
        }
        let all = connection != now || last.elapsed() >= every;
        connection = now;
        let say = if values.running { "RUN" } else { "STOP" };
        if all || state != Some(say) {
            let put = client.publish(format!("{}/state", broker.prefix), QoS::AtLeastOnce, true, say);
            if put.await.is_err() {
                return;
            }
            state = Some(say);
        }
        for (index, ((topic, ..), text)) in signals.iter().zip(&values.texts).enumerate() {
            if !all && sent.get(index) == Some(text) {
                continue;
            }
            let content = format!("{{{text}, \"time\": \"{}\"}}", values.time);
            let topic = format!("{}/value/{topic}", broker.prefix);
            if client.publish(topic, QoS::AtLeastOnce, true, content).await.is_err() {
                return;
            }
        }
        sent = values.texts;
        if all {
            last = Instant::now();
        }
    }
}

/// Keeps the connection: `send` gets an odd number with each new one, and an even one when it is lost.
async fn connect(mut events: EventLoop, send: tokio::sync::watch::Sender<u64>, broker: String) {
    let mut pause = *RETRY.start();
    let mut told = false;
    loop {
        match events.poll().await {
            Ok(Event::Incoming(Packet::ConnAck(_))) => {
                pause = *RETRY.start();
                if std::mem::take(&mut told) {
                    crate::say(&format!("{broker} is back"));
                }
                send.send_modify(|number| *number = (*number | 1) + u64::from(*number % 2 == 1) * 2);
            }
            Ok(_) => {}
            Err(error) => {
                if !told {
                    told = true;
                    crate::say(&format!("{broker} does not answer: {error}; trying again"));
                }
                // What was not delivered is not current any more when the broker is back: it gets all values then.
                events.clean();
                events.pending.clear();
                send.send_modify(|number| *number += *number % 2);
                tokio::time::sleep(pause).await;
                pause = (pause * 2).min(*RETRY.end());
            }
        }
        if send.is_closed() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn urls_of_brokers() {
        let parse = |text: &str| Broker::parse(text).map(|broker| (broker.to_string(), broker.user));
        assert_eq!(parse("mqtt://broker").unwrap().0, "mqtt://broker:1883/plc");
        assert_eq!(parse("mqtt://10.0.0.1:1884/plant/tank/").unwrap().0, "mqtt://10.0.0.1:1884/plant/tank");
        assert_eq!(Broker::parse("mqtt://[fd00::1]:1884").unwrap().host, "fd00::1");
        assert_eq!(parse("mqtt://me:s@cret@b").unwrap().1, Some(("me".to_string(), "s@cret".to_string())));
        for text in ["broker", "mqtt://", "mqtts://b", "mqtt://b:x", "mqtt://b/a/#"] {
            assert!(Broker::parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_password_is_not_shown() {
        let broker = Broker::parse("mqtt://me:secret@b").unwrap();
        assert!(!format!("{broker:?} {broker}").contains("secret"));
    }
}
