//! What hosts want of a node. All that a command writes is written between two cycles; a command that is wrong in one part does nothing.

use plcc_runtime::cpu::Cpu;
use prost::Message;

use super::metrics::{Tag, refused};
use super::payload::{Metric, Payload, Value};
use super::{FIRST_ALIAS, REBIRTH, REBIRTH_ALIAS};
use crate::limits::{COMMAND_METRICS_MAX, NAME_MAX};
use crate::opcua::values::{Part, Variable};

/// A message of a host, as it came.
pub struct Command {
    pub is_for_node: bool,
    /// The broker has kept it from before.
    pub is_retained: bool,
    pub payload: axum::body::Bytes,
}

/// What is to be done.
#[derive(Debug)]
pub struct Wanted {
    pub birth: bool,
    /// Name, place and value.
    pub values: Vec<(String, Variable, Vec<Part>)>,
}

impl Command {
    /// `Err`: why the command is refused.
    pub fn read(&self, tags: &[Tag], has_device: bool) -> Result<Wanted, String> {
        if self.is_retained {
            return Err("a command must not be retained: it would be carried out again and again".to_string());
        }
        let payload = Payload::decode(&*self.payload).map_err(|_| "a command is not a payload of Sparkplug B")?;
        if payload.metrics.len() > COMMAND_METRICS_MAX {
            return Err(format!("a command has more than {COMMAND_METRICS_MAX} metrics"));
        }
        let mut wanted = Wanted { birth: false, values: Vec::new() };
        for metric in &payload.metrics {
            if self.is_for_node && is_rebirth(metric) {
                wanted.birth |= metric.value == Some(Value::Boolean(true));
                continue;
            }
            let tag = find(metric, tags)?;
            if self.is_for_node == has_device {
                let (right, wrong) = if has_device { ("DCMD", "NCMD") } else { ("NCMD", "DCMD") };
                return Err(format!("{}: write it by {right}, not by {wrong}", tag.name));
            }
            let (variable, parts) = tag.parts(metric).map_err(|why| format!("{}: {why}", tag.name))?;
            wanted.values.push((tag.name.clone(), variable, parts));
        }
        Ok(wanted)
    }
}

fn is_rebirth(metric: &Metric) -> bool {
    match &metric.name {
        Some(name) => name == REBIRTH,
        None => metric.alias == Some(REBIRTH_ALIAS),
    }
}

/// By name, or by alias; both must mean the same.
fn find<'a>(metric: &Metric, tags: &'a [Tag]) -> Result<&'a Tag, String> {
    let by_alias = |alias: u64| {
        let index = alias.checked_sub(FIRST_ALIAS).and_then(|index| usize::try_from(index).ok());
        index.and_then(|index| tags.get(index)).ok_or_else(|| format!("no metric of values has the alias {alias}"))
    };
    match (metric.name.as_deref().filter(|name| !name.is_empty()), metric.alias) {
        (Some(name), alias) => {
            let known = tags.iter().find(|tag| tag.name == name);
            let tag = known.ok_or_else(|| {
                let shown: String = name.chars().take(NAME_MAX).collect();
                format!("no metric of values has the name {shown}")
            })?;
            match alias {
                Some(alias) if by_alias(alias)?.name != tag.name => Err(format!("{name} has another alias")),
                Some(_) | None => Ok(tag),
            }
        }
        (None, Some(alias)) => by_alias(alias),
        (None, None) => Err("a metric of a command has neither name nor alias".to_string()),
    }
}

/// Writes, at the cycle control point. `Err`: what was refused; what came before it is written.
pub fn write(cpu: &Cpu, generation: u64, values: &[(String, Variable, Vec<Part>)]) -> Result<(), String> {
    if cpu.generation() != generation {
        return Err("the program has changed: write again after its birth".to_string());
    }
    for (name, variable, parts) in values {
        variable.write(cpu, parts).map_err(|status| format!("{name}: {}", refused(status)))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mqtt::sparkplug::payload::DataType;
    use plcc_abi::image::AssertType;
    use plcc_runtime::address::{Address, Place, Width};
    use plcc_runtime::signal::{Signal, Source};
    use plcc_runtime::typed::ValueType;
    use proptest::prelude::*;

    fn tags() -> Vec<Tag> {
        let address = |byte, width| Address { place: Place::BitMemory(byte), width };
        let sources = [
            ("on", Source::Bits(address(0, Width::Bit(3)))),
            ("level", Source::Typed(address(4, Width::Dword), ValueType::of(AssertType::Real))),
            ("count", Source::Typed(address(8, Width::Word), ValueType::of(AssertType::Signed(16)))),
        ];
        sources.map(|(name, source)| Tag::of(Signal { name: name.to_string(), source }, false)).into()
    }

    fn metric(name: &str, value: Value) -> Metric {
        Metric { name: Some(name.to_string()), value: Some(value), ..Metric::default() }
    }

    fn command(metrics: Vec<Metric>) -> Command {
        let payload = Payload { metrics, ..Payload::default() }.encode_to_vec().into();
        Command { is_for_node: true, is_retained: false, payload }
    }

    #[test]
    fn metrics_are_found_by_name_and_alias() {
        let by_alias = Metric { alias: Some(FIRST_ALIAS + 1), ..metric("", Value::Float(2.5)) };
        let wanted = command(vec![metric("on", Value::Boolean(true)), by_alias]).read(&tags(), false).unwrap();
        let names: Vec<&str> = wanted.values.iter().map(|(name, ..)| name.as_str()).collect();
        assert_eq!((names, wanted.birth), (vec!["on", "level"], false));
        let rebirth = command(vec![metric(REBIRTH, Value::Boolean(true))]).read(&tags(), false).unwrap();
        assert!(rebirth.birth && rebirth.values.is_empty());
    }

    #[test]
    fn wrong_commands_are_refused() {
        let right = || metric("on", Value::Boolean(true));
        let refused = |command: Command, has_device: bool| command.read(&tags(), has_device).unwrap_err();
        for (command, part) in [
            (command(vec![right(), metric("off", Value::Boolean(true))]), "name off"),
            (command(vec![metric("count", Value::Float(1.0))]), "count: the value is not of the data type Int16"),
            (command(vec![Metric { value: None, ..right() }]), "has no value"),
            (command(vec![Metric { datatype: Some(DataType::Int8 as u32), ..right() }]), "its data type is Boolean"),
            (command(vec![Metric { alias: Some(FIRST_ALIAS + 2), ..right() }]), "another alias"),
            (command(vec![Metric { name: None, alias: Some(u64::MAX), ..right() }]), "alias"),
            (command(vec![Metric { name: None, ..right() }]), "neither name nor alias"),
            (command(vec![right(); COMMAND_METRICS_MAX + 1]), "more than"),
            (Command { is_retained: true, ..command(vec![right()]) }, "retained"),
            (Command { payload: vec![0xFF; 5].into(), ..command(Vec::new()) }, "not a payload"),
        ] {
            let message = refused(command, false);
            assert!(message.contains(part), "{message}");
        }
        assert!(refused(command(vec![right()]), true).contains("by DCMD"));
        let of_device = Command { is_for_node: false, ..command(vec![metric(REBIRTH, Value::Boolean(true))]) };
        assert!(refused(of_device, true).contains("no metric of values has the name Node Control"));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(10_000))]

        #[test]
        fn random_payloads_do_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let _ = Command { payload: bytes.into(), ..command(Vec::new()) }.read(&tags(), false);
        }

        #[test]
        fn changed_payloads_do_no_harm(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..5)) {
            let all = vec![metric("on", Value::Boolean(true)), metric("count", Value::Int(7)), metric("level", Value::Float(1.0))];
            let mut bytes = command(all).payload.to_vec();
            for (at, value) in changes {
                let at = at.index(bytes.len());
                bytes[at] = value;
            }
            let _ = Command { payload: bytes.into(), ..command(Vec::new()) }.read(&tags(), false);
        }
    }
}
