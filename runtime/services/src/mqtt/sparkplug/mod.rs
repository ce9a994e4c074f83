//! An edge node of Sparkplug B: values as metrics that hosts find by themselves, and can write. Source: Sparkplug specification 3.0.
//!
//! - [`payload`]: the messages; [`metrics`]: values as metrics; [`commands`]: what hosts want.
//!
//! | Message | When |
//! | --- | --- |
//! | NBIRTH, DBIRTH | the node has connected, a host asks for it, or the program was changed: all metrics, with their aliases |
//! | NDATA, DDATA | metrics have changed, by their aliases |
//! | NDEATH | the broker says it when the connection breaks |
//! | NCMD, DCMD | come from hosts: a birth is wanted, or values are to be written |
//!
//! The values are metrics of the device, if it has a name, else of the node. The device lives as long as its node. A host that does not know a
//! node asks for its birth, so nothing is retained, and what was not delivered is not sent again.

mod commands;
mod metrics;
mod payload;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

use plcc_abi::ProgramImage;
use plcc_abi::services::{Protection, Right};
use plcc_runtime::cpu::Cpu;
use plcc_runtime::names::Limits;
use prost::Message;
use rumqttc::{AsyncClient, LastWill, MqttOptions, Publish, QoS};
use tokio::sync::{mpsc, watch};
use tokio::time::{MissedTickBehavior, interval, timeout};

use self::commands::{Command, Wanted};
use self::metrics::{Copied, Tag};
use self::payload::{DataType, Metric, Payload, Value};
use super::values::named;
use super::{Broker, Duties, LOOK, Target, connect};
use crate::limits::{COMMANDS_MAX, LOOKUP_TIME};
use crate::link::Link;
use crate::rights::Clients;

/// First part of all topics.
const NAMESPACE: &str = "spBv1.0";
const BIRTH_DEATH: &str = "bdSeq";
const REBIRTH: &str = "Node Control/Rebirth";
/// Metrics of the node, with their aliases. Those of values follow.
const PROGRAM: (&str, u64) = ("Node Info/Program", 1);
const CPU: (&str, u64) = ("Node Info/CPU", 2);
const STATE: (&str, u64) = ("Node Info/State", 3);
const REFUSED: (&str, u64) = ("Node Info/Refused Command", 4);
const REBIRTH_ALIAS: u64 = 5;
const FIRST_ALIAS: u64 = 16;

/// `GROUP/NODE` or `GROUP/NODE/DEVICE`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeName {
    group: String,
    node: String,
    device: Option<String>,
}

impl NodeName {
    /// `Err`: what is wrong.
    pub fn parse(text: &str) -> Result<NodeName, String> {
        let parts: Vec<&str> = text.split('/').collect();
        let is_wrong = |part: &&str| part.is_empty() || part.contains(['+', '#', '\0']);
        let (group, node, device) = match parts[..] {
            [group, node] => (group, node, None),
            [group, node, device] => (group, node, Some(device)),
            _ => return Err("write GROUP/NODE or GROUP/NODE/DEVICE".to_string()),
        };
        if parts.iter().any(is_wrong) {
            return Err("write GROUP/NODE or GROUP/NODE/DEVICE, without `+` and `#`".to_string());
        }
        Ok(NodeName { group: group.to_string(), node: node.to_string(), device: device.map(str::to_string) })
    }

    /// The topic of messages of the node: `NBIRTH`.
    fn of_node(&self, kind: &str) -> String {
        format!("{NAMESPACE}/{}/{kind}/{}", self.group, self.node)
    }

    /// The topic of messages about the values: of the device, if there is one. `kind` is without its first letter: `DATA`.
    fn of_values(&self, kind: &str) -> String {
        match &self.device {
            Some(device) => format!("{NAMESPACE}/{}/D{kind}/{}/{device}", self.group, self.node),
            None => self.of_node(&format!("N{kind}")),
        }
    }
}

impl std::fmt::Display for NodeName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.group, self.node)?;
        self.device.iter().try_for_each(|device| write!(f, "/{device}"))
    }
}

/// What is published, where, and who may write it.
pub struct Node {
    target: Target,
    name: NodeName,
    tags: Vec<Tag>,
    program: String,
    cpu: String,
    clients: Clients,
    protection: Protection,
}

impl Node {
    /// `Err`: a value does not exist, there is none, or the URL of the broker has a prefix.
    pub fn new(
        target: Target,
        name: NodeName,
        values: &[String],
        image: &ProgramImage,
        clients: Clients,
    ) -> Result<Node, String> {
        if !target.broker.prefix.is_empty() {
            let prefix = &target.broker.prefix;
            return Err(format!("--sparkplug: its topics begin with {NAMESPACE}; take `/{prefix}` out of the URL"));
        }
        let limits = Limits::new(image);
        let mut tags: Vec<Tag> = Vec::new();
        let mut known = std::collections::HashSet::new();
        for signal in named(values, image)? {
            if known.insert(signal.name.clone()) {
                tags.push(Tag::new(signal, image, &limits));
            }
        }
        Ok(Node {
            target,
            name,
            tags,
            program: image.name.clone(),
            cpu: image.profile.name.clone(),
            clients,
            protection: image.config.services.protection,
        })
    }

    /// The words for the line that says what was opened.
    pub fn text(&self) -> String {
        let count = self.tags.len();
        format!(
            "{count} value{} as Sparkplug B {} to {}: {}",
            if count == 1 { "" } else { "s" },
            self.name,
            self.target.broker,
            self.clients.text("read and write")
        )
    }
}

/// The side of the connection.
struct Line {
    commands: mpsc::Sender<Command>,
    /// Commands came faster than the CPU takes them.
    overrun: Arc<AtomicBool>,
    node_topic: String,
    /// Of the last attempt to connect; the first one has 0.
    number: Arc<AtomicU8>,
    death_topic: String,
    is_first: bool,
}

impl Duties for Line {
    /// Each attempt has a number, by which hosts know which birth a death belongs to.
    fn prepare(&mut self, options: &mut MqttOptions) {
        if !std::mem::take(&mut self.is_first) {
            self.number.fetch_add(1, Ordering::Relaxed);
        }
        let metrics = vec![birth_death(&self.number)];
        let death = Payload { metrics, ..Payload::default() }.encode_to_vec();
        options.set_last_will(LastWill::new(&self.death_topic, death, QoS::AtLeastOnce, false));
    }

    fn receive(&mut self, message: Publish) {
        let Publish { retain, topic, payload, .. } = message;
        let command = Command { is_for_node: topic == self.node_topic, is_retained: retain, payload };
        if self.commands.try_send(command).is_err() {
            self.overrun.store(true, Ordering::Relaxed);
        }
    }
}

fn birth_death(number: &AtomicU8) -> Metric {
    Metric {
        name: Some(BIRTH_DEATH.to_string()),
        datatype: Some(DataType::Int64 as u32),
        value: Some(Value::Long(number.load(Ordering::Relaxed).into())),
        ..Metric::default()
    }
}

/// What one cycle has shown.
struct Seen {
    /// The program has changed: how often, and its values.
    renewed: Option<(u64, Arc<[Tag]>, String)>,
    running: bool,
    copied: Vec<Copied>,
    /// Wall clock of the CPU, in milliseconds since 1970.
    time: u64,
}

fn look(cpu: &Cpu, tags: &Arc<[Tag]>, generation: u64) -> Seen {
    let renewed = (cpu.generation() != generation).then(|| {
        let limits = Limits::new(&cpu.image);
        let tags: Arc<[Tag]> = tags.iter().map(|tag| tag.renewed(&cpu.image, &limits)).collect();
        (cpu.generation(), tags, cpu.image.name.clone())
    });
    let tags = renewed.as_ref().map_or(tags, |(_, tags, _)| tags);
    let copied = tags.iter().map(|tag| tag.copy(cpu)).collect();
    let time = u64::try_from(cpu.clock.wall().div_euclid(1_000_000)).unwrap_or(0);
    Seen { renewed, running: !cpu.is_stopped(), copied, time }
}

/// Publishes and takes commands until the CPU ends.
pub async fn run(node: Node, link: Link) {
    let Node { target, name, tags, program, cpu, clients, protection } = node;
    let (send_commands, commands) = mpsc::channel(COMMANDS_MAX);
    let (send, connected) = watch::channel(0);
    let (overrun, number) = (Arc::<AtomicBool>::default(), Arc::<AtomicU8>::default());
    let line = Line {
        commands: send_commands,
        overrun: overrun.clone(),
        node_topic: name.of_node("NCMD"),
        number: number.clone(),
        death_topic: name.of_node("NDEATH"),
        is_first: true,
    };
    // The broker knows the node again when its process was killed, and tells of its death before the next birth.
    let client = format!("plcc-{}-{}", name.group, name.node);
    let (client, events) = AsyncClient::new(target.broker.options(client, target.tls.as_ref()), 64);
    tokio::spawn(connect(events, send, target.broker.to_string(), line));
    let mut session = Session {
        link,
        client,
        connected,
        name,
        tags: tags.into(),
        generation: 0,
        program,
        cpu,
        rights: Rights { broker: target.broker, clients, protection, now: None },
        number,
        connection: 0,
        seq: 0,
        state: None,
        sent: Vec::new(),
        wants_birth: false,
        refused: String::new(),
        refused_sent: String::new(),
    };
    // Only the end of the CPU ends it.
    let _ = session.serve(commands, &overrun).await;
}

/// What a broker may do: its address is that of a client.
struct Rights {
    broker: Broker,
    clients: Clients,
    protection: Protection,
    now: Option<Right>,
}

impl Rights {
    /// Looks up the addresses of the broker; the one with the least rights counts.
    async fn renew(&mut self) {
        let place = (self.broker.host.as_str(), self.broker.port);
        let found = timeout(LOOKUP_TIME, tokio::net::lookup_host(place)).await;
        let Ok(Ok(addresses)) = found else {
            self.now = None;
            return;
        };
        let rights: Vec<Option<Right>> = addresses.map(|address| self.clients.of(address.ip())).collect();
        self.now = rights.into_iter().min().flatten();
    }

    /// Whether commands may write. `Err`: why not.
    fn check(&self) -> Result<(), &'static str> {
        match (self.protection, self.now) {
            (Protection::Complete, _) => Err("complete protection: the CPU takes no values"),
            (_, Some(Right::Write | Right::Control)) => Ok(()),
            (_, Some(Right::Read) | None) => Err("the broker may not write: see `access` and the list of clients"),
        }
    }
}

struct Session {
    link: Link,
    client: AsyncClient,
    connected: watch::Receiver<u64>,
    name: NodeName,
    tags: Arc<[Tag]>,
    generation: u64,
    program: String,
    cpu: String,
    rights: Rights,
    number: Arc<AtomicU8>,
    /// The connection that has had its births.
    connection: u64,
    /// Of the next message.
    seq: u8,
    state: Option<&'static str>,
    /// Values that hosts know.
    sent: Vec<Option<Value>>,
    wants_birth: bool,
    /// Why the last wrong command was refused.
    refused: String,
    refused_sent: String,
}

impl Session {
    /// `None`: the CPU or the connection has ended.
    async fn serve(&mut self, mut commands: mpsc::Receiver<Command>, overrun: &AtomicBool) -> Option<()> {
        let mut ticks = interval(LOOK);
        ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            tokio::select! {
                _ = ticks.tick() => {
                    if overrun.swap(false, Ordering::Relaxed) {
                        self.refused = format!("commands came too fast: more than {COMMANDS_MAX} waited");
                    }
                    self.publish().await?;
                }
                command = commands.recv() => self.obey(command?).await?,
            }
        }
    }

    async fn obey(&mut self, command: Command) -> Option<()> {
        let wanted = command.read(&self.tags, self.name.device.is_some());
        let written = match wanted {
            Ok(Wanted { birth, values }) => {
                self.wants_birth |= birth;
                match self.rights.check() {
                    _ if values.is_empty() => Ok(()),
                    Err(why) => Err(why.to_string()),
                    Ok(()) => {
                        let generation = self.generation;
                        self.link.ask(move |cpu| commands::write(cpu, generation, &values)).await?
                    }
                }
            }
            Err(why) => Err(why),
        };
        if let Err(why) = written {
            self.refused = why;
        }
        Some(())
    }

    /// Births if there is something new about the node, else what has changed.
    async fn publish(&mut self) -> Option<()> {
        let connection = *self.connected.borrow();
        // An even number: there is no connection.
        if connection.is_multiple_of(2) {
            return Some(());
        }
        let is_new = connection != self.connection;
        if is_new {
            self.rights.renew().await;
        }
        let (tags, generation) = (self.tags.clone(), self.generation);
        let seen = self.link.ask(move |cpu| look(cpu, &tags, generation)).await?;
        let is_changed = seen.renewed.is_some();
        if let Some(renewed) = seen.renewed {
            (self.generation, self.tags, self.program) = renewed;
        }
        // From here to the end of the messages nothing waits, so they belong to this connection.
        if *self.connected.borrow() != connection {
            self.wants_birth |= is_changed;
            return Some(());
        }
        let values: Vec<Option<Value>> =
            self.tags.iter().zip(&seen.copied).map(|(tag, copied)| tag.value(copied)).collect();
        let state = if seen.running { "RUN" } else { "STOP" };
        match is_new || is_changed || self.wants_birth {
            true => self.give_birth(values, state, seen.time, is_new).await?,
            false => self.tell_changes(values, state, seen.time).await?,
        }
        self.connection = connection;
        Some(())
    }

    async fn give_birth(
        &mut self,
        values: Vec<Option<Value>>,
        state: &'static str,
        time: u64,
        is_new: bool,
    ) -> Option<()> {
        self.wants_birth = false;
        self.seq = 0;
        if is_new {
            let mut topics = vec![self.name.of_node("NCMD")];
            topics.extend(self.name.device.is_some().then(|| self.name.of_values("CMD")));
            for topic in topics {
                self.client.subscribe(topic, QoS::AtLeastOnce).await.ok()?;
            }
        }
        let text = |(name, alias): (&str, u64), text: &str| Metric {
            name: Some(name.to_string()),
            alias: Some(alias),
            datatype: Some(DataType::String as u32),
            value: Some(Value::Text(text.to_string())),
            ..Metric::default()
        };
        let mut of_node = vec![
            birth_death(&self.number),
            Metric {
                name: Some(REBIRTH.to_string()),
                alias: Some(REBIRTH_ALIAS),
                datatype: Some(DataType::Boolean as u32),
                value: Some(Value::Boolean(false)),
                ..Metric::default()
            },
            text(PROGRAM, &self.program),
            text(CPU, &self.cpu),
            text(STATE, state),
            text(REFUSED, &self.refused),
        ];
        let of_values = self.tags.iter().zip(&values).zip(FIRST_ALIAS..).map(|((tag, value), alias)| Metric {
            value: value.clone(),
            is_null: value.is_none().then_some(true),
            ..tag.birth(alias)
        });
        let of_device: Vec<Metric> = match self.name.device {
            Some(_) => of_values.collect(),
            None => {
                of_node.extend(of_values);
                Vec::new()
            }
        };
        self.send(self.name.of_node("NBIRTH"), of_node, time).await?;
        if self.name.device.is_some() {
            self.send(self.name.of_values("BIRTH"), of_device, time).await?;
        }
        (self.sent, self.state) = (values, Some(state));
        self.refused_sent.clone_from(&self.refused);
        Some(())
    }

    async fn tell_changes(&mut self, values: Vec<Option<Value>>, state: &'static str, time: u64) -> Option<()> {
        let data = |alias: u64, value: &Option<Value>| Metric {
            alias: Some(alias),
            is_null: value.is_none().then_some(true),
            value: value.clone(),
            ..Metric::default()
        };
        let mut of_node = Vec::new();
        if self.state != Some(state) {
            of_node.push(data(STATE.1, &Some(Value::Text(state.to_string()))));
        }
        if self.refused != self.refused_sent {
            of_node.push(data(REFUSED.1, &Some(Value::Text(self.refused.clone()))));
        }
        let is_same = |own: &Option<Value>, other: &Option<Value>| match (own, other) {
            (Some(own), Some(other)) => own.is_same(other),
            (None, None) => true,
            (Some(_), None) | (None, Some(_)) => false,
        };
        let all = values.iter().zip(&self.sent).zip(FIRST_ALIAS..);
        let changed = all.filter(|((now, sent), _)| !is_same(now, sent)).map(|((now, _), alias)| data(alias, now));
        let mut of_device: Vec<Metric> = changed.collect();
        if self.name.device.is_none() {
            of_node.append(&mut of_device);
        }
        if !of_node.is_empty() {
            self.send(self.name.of_node("NDATA"), of_node, time).await?;
        }
        if !of_device.is_empty() {
            self.send(self.name.of_values("DATA"), of_device, time).await?;
        }
        (self.sent, self.state) = (values, Some(state));
        self.refused_sent.clone_from(&self.refused);
        Some(())
    }

    /// The next message. There is room for it in the queue: only the messages of one look are in it.
    async fn send(&mut self, topic: String, mut metrics: Vec<Metric>, time: u64) -> Option<()> {
        metrics.iter_mut().for_each(|metric| metric.timestamp = Some(time));
        let payload = Payload { timestamp: Some(time), metrics, seq: Some(self.seq.into()) };
        self.seq = self.seq.wrapping_add(1);
        self.client.publish(topic, QoS::AtMostOnce, false, payload.encode_to_vec()).await.ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_nodes() {
        let node = NodeName::parse("plant/line").unwrap();
        assert_eq!(
            (node.of_node("NBIRTH"), node.of_values("DATA")),
            ("spBv1.0/plant/NBIRTH/line".to_string(), "spBv1.0/plant/NDATA/line".to_string())
        );
        let device = NodeName::parse("plant/line/press 1").unwrap();
        assert_eq!(device.of_values("CMD"), "spBv1.0/plant/DCMD/line/press 1");
        for text in ["", "plant", "plant/", "/line", "a/b/c/d", "a/+", "a/b/#"] {
            assert!(NodeName::parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_death_belongs_to_its_birth() {
        let (commands, _kept) = mpsc::channel(1);
        let number = Arc::<AtomicU8>::default();
        let mut line = Line {
            commands,
            overrun: Arc::default(),
            node_topic: String::new(),
            number: number.clone(),
            death_topic: "spBv1.0/plant/NDEATH/line".to_string(),
            is_first: true,
        };
        let mut options = MqttOptions::new("plant", "localhost", 1883);
        for expected in (0..=255).chain([0]) {
            line.prepare(&mut options);
            let will = options.last_will().unwrap();
            let payload = Payload::decode(&*will.message).unwrap();
            assert_eq!(payload.metrics, [birth_death(&number)]);
            assert_eq!(payload.metrics[0].value, Some(Value::Long(expected)));
        }
    }
}
