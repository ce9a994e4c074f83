//! Values to an MQTT broker: on change, and all of them again and again.
//!
//! | Topic | Content |
//! | --- | --- |
//! | `PREFIX/state` | `RUN`, `STOP`, or `offline`, which the broker says when the connection breaks |
//! | `PREFIX/value/NAME` | `{"value": 12.5, "type": "REAL", "time": "2026-01-31T06:00:00.125Z"}` |
//!
//! All messages are retained with quality of service 1.

use std::collections::HashMap;
use std::time::Duration;

use jiff::Timestamp;
use plcc_abi::ProgramImage;
use plcc_runtime::cpu::Cpu;
use plcc_runtime::options::split_list;
use plcc_runtime::signal::{self, Signal, Value};
use rumqttc::{AsyncClient, LastWill, QoS};
use tokio::time::{Instant, MissedTickBehavior, interval};

use super::{LOOK, NoDuties, Target, connect};
use crate::limits::PUBLISHED_MAX;
use crate::link::Link;

/// First part of topics, unless the URL names another.
const PREFIX: &str = "plc";
/// All values are published again after this time, unless plc.toml names another.
const INTERVAL_DEFAULT: Duration = Duration::from_secs(10);

/// What is published, and where.
pub struct Publisher {
    target: Target,
    /// Values with the last part of their topics.
    signals: Vec<(String, Signal)>,
    interval: Duration,
}

impl Publisher {
    /// `Err`: a value does not exist, or there is none.
    pub fn new(
        mut target: Target,
        values: &[String],
        interval_ms: Option<u32>,
        image: &ProgramImage,
    ) -> Result<Publisher, String> {
        if target.broker.prefix.is_empty() {
            target.broker.prefix = PREFIX.to_string();
        }
        let found = named(values, image)?;
        let names: Vec<&str> = found.iter().map(|signal| signal.name.as_str()).collect();
        let topics = topics(&names)?;
        let signals = topics.into_iter().zip(found).filter_map(|(topic, signal)| Some((topic?, signal))).collect();
        let interval = interval_ms.map_or(INTERVAL_DEFAULT, |ms| Duration::from_millis(ms.into()));
        Ok(Publisher { target, signals, interval })
    }

    /// The words for the line that says what was opened.
    pub fn text(&self) -> String {
        let count = self.signals.len();
        format!("{count} value{} to {}", if count == 1 { "" } else { "s" }, self.target.broker)
    }
}

/// The values that were named. `Err`: one does not exist, or there is none.
pub fn named(values: &[String], image: &ProgramImage) -> Result<Vec<Signal>, String> {
    let mut signals = Vec::new();
    for text in split_list(values) {
        signals.extend(signal::all(&text, image, None).map_err(|error| format!("--publish {text}: {error}"))?);
    }
    match signals.len() {
        0 => Err("--mqtt: no values: name them with --publish, or as `values` in [services]".to_string()),
        1..=PUBLISHED_MAX => Ok(signals),
        count => Err(format!("--publish: {count} values; at most {PUBLISHED_MAX} are published")),
    }
}

/// The last part of a topic: the name without what brokers take for something else.
fn topic(name: &str) -> String {
    name.replace(['/', '+', '#', '\0', '"'], "_").replace(' ', "")
}

/// The topic of each name, its last part; `None`: the name came before. `Err`: two names have one topic, so that nobody could tell their values
/// apart.
fn topics(names: &[&str]) -> Result<Vec<Option<String>>, String> {
    let mut taken: HashMap<String, &str> = HashMap::new();
    let mut topics = Vec::with_capacity(names.len());
    for &name in names {
        let own = topic(name);
        match taken.get(&own) {
            Some(other) if *other == name => topics.push(None),
            Some(other) => {
                return Err(format!(
                    "--publish: `{other}` and `{name}` have the same topic, `{own}`, because topics have no quotes, blanks, `/`, `+` and \
                     `#`; rename one of them, or leave it out"
                ));
            }
            None => {
                taken.insert(own.clone(), name);
                topics.push(Some(own));
            }
        }
    }
    Ok(topics)
}

/// The values of one cycle, in the order of the signals. They become texts elsewhere: the cycle waits for this.
struct Values {
    /// The program has changed: how often, and where its values are.
    renewed: Option<(u64, Signals)>,
    running: bool,
    /// `None`: the program has no such value, or its data block does not exist at present.
    values: Vec<Option<Value>>,
    /// Wall clock of the CPU, in milliseconds since 1970.
    time: i64,
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
    let value = |(_, Signal { source, .. }, exists): &(String, Signal, bool)| {
        (*exists && source.absent(cpu).is_none()).then(|| source.read(cpu, None))
    };
    let values = signals.iter().map(value).collect();
    Values { running: !cpu.is_stopped(), values, time: cpu.clock.wall().div_euclid(1_000_000), renewed }
}

/// The content of a message, without the time.
fn content(signal: &Signal, value: Option<&Value>) -> String {
    match value {
        Some(value) => format!("\"value\": {}, \"type\": \"{}\"", value.exact_json(), signal.source.ty()),
        None => "\"value\": null".to_string(),
    }
}

/// A moment of the CPU's clock.
fn moment(ms: i64) -> String {
    Timestamp::from_millisecond(ms).map_or_else(|_| String::new(), |time| format!("{time:.3}"))
}

/// Publishes until the CPU ends.
pub async fn run(publisher: Publisher, link: Link) {
    let Publisher { target: Target { broker, tls }, signals, interval: every } = publisher;
    let mut signals: Signals = signals.into_iter().map(|(topic, signal)| (topic, signal, true)).collect();
    let mut generation = 0;
    let id = format!("plcc-{}-{}", broker.prefix.replace('/', "-"), std::process::id());
    let mut options = broker.options(id, tls.as_ref());
    options.set_last_will(LastWill::new(format!("{}/state", broker.prefix), "offline", QoS::AtLeastOnce, true));
    // As many as all values and the state take.
    let (client, events) = AsyncClient::new(options, signals.len() + 16);
    let (send, mut connected) = tokio::sync::watch::channel(0);
    tokio::spawn(connect(events, send, broker.to_string(), NoDuties));
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
        let all_texts =
            signals.iter().zip(&values.values).map(|((_, signal, _), value)| content(signal, value.as_ref()));
        let texts: Vec<String> = all_texts.collect();
        let time = moment(values.time);
        for (index, ((topic, ..), text)) in signals.iter().zip(&texts).enumerate() {
            if !all && sent.get(index) == Some(text) {
                continue;
            }
            let content = format!("{{{text}, \"time\": \"{time}\"}}");
            let topic = format!("{}/value/{topic}", broker.prefix);
            if client.publish(topic, QoS::AtLeastOnce, true, content).await.is_err() {
                return;
            }
        }
        sent = texts;
        if all {
            last = Instant::now();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::topics;

    #[test]
    fn each_value_has_a_topic_of_its_own() {
        let found = topics(&["Motor.speed", "\"My DB\".\"a/b\"", "Motor.speed"]).unwrap();
        assert_eq!(found, [Some("Motor.speed".to_string()), Some("_MyDB_._a_b_".to_string()), None]);
        let error = topics(&["D.\"a/b\"", "D.\"a+b\""]).unwrap_err();
        assert!(error.starts_with("--publish: `D.\"a/b\"` and `D.\"a+b\"` have the same topic, `D._a_b_`"), "{error}");
    }
}
