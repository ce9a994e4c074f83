//! `[s7200]` of plc.toml: station address, ports, the link to other stations, analog modules, and settings of the CPU.

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use plcc_abi::image::{Family, Profile};
use plcc_abi::s7200::S7200Config;
use plcc_abi::s7200::image::{AnalogModule, Link, Port};
use plcc_diag::{Code, Diagnostic, FileId, Span};
use plcc_runtime::s7200::socket_address;
use serde::Deserialize;
use toml::Spanned;

use crate::keys::{Reader, one_of};
use crate::project::{duration_ms, number_within};

/// Highest station address. Source: S7-200 system manual, network.
const STATION_MAX: i64 = 126;
const STATION_DEFAULT: u8 = 2;
/// Analog potentiometers of the larger CPUs.
const POTENTIOMETERS: usize = 2;
/// Maximum number of expansion modules of a CPU. Source: S7-200 system manual, expansion I/O.
const MODULES_MAX: usize = 7;
const RANGE_DEFAULT: &str = "0-10 V";

/// `[s7200]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct S7200Keys {
    station: Option<Spanned<i64>>,
    watchdog: Option<Spanned<String>>,
    potentiometers: Option<Spanned<Vec<Spanned<i64>>>>,
    #[serde(default, alias = "stop-on-error")]
    stop_on_error: bool,
    #[serde(default, alias = "strict-compare")]
    strict_compare: bool,
    #[serde(alias = "mode-switch")]
    mode_switch: Option<Spanned<String>>,
    #[serde(default)]
    port: Vec<PortKeys>,
    network: Option<NetworkKeys>,
    #[serde(default)]
    analog: Vec<AnalogKeys>,
}

/// `[[s7200.port]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PortKeys {
    number: Spanned<i64>,
    device: Option<Spanned<String>>,
    pty: Option<Spanned<String>>,
    listen: Option<Spanned<String>>,
    connect: Option<Spanned<String>>,
}

/// `[s7200.network]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NetworkKeys {
    listen: Option<Spanned<String>>,
    #[serde(default)]
    stations: BTreeMap<Spanned<String>, Spanned<String>>,
}

/// `[[s7200.analog]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AnalogKeys {
    module: Spanned<String>,
    inputs: Option<Spanned<i64>>,
    outputs: Option<Spanned<i64>>,
    range: Option<Spanned<String>>,
    switches: Option<Spanned<String>>,
}

/// A kind of analog module: its name, and its possible numbers of inputs and outputs, the usual one first.
struct Kind {
    name: &'static str,
    inputs: &'static [u8],
    outputs: &'static [u8],
}

/// Source: S7-200 system manual, technical data of analog expansion modules. The EM 235 of the 21x generation had 3 inputs.
static KINDS: [Kind; 3] = [
    Kind { name: "EM 231", inputs: &[4, 8], outputs: &[0] },
    Kind { name: "EM 232", inputs: &[0], outputs: &[2, 4] },
    Kind { name: "EM 235", inputs: &[4, 3], outputs: &[1] },
];

/// A range of inputs, with the switches that choose it on an EM 231 and an EM 235, SW1 first, x: on.
struct Range {
    name: &'static str,
    low: f64,
    high: f64,
    unit: &'static str,
    em_231: Option<&'static str>,
    em_235: Option<&'static str>,
}

const fn range(
    name: &'static str,
    (low, high): (f64, f64),
    unit: &'static str,
    em_231: Option<&'static str>,
    em_235: Option<&'static str>,
) -> Range {
    Range { name, low, high, unit, em_231, em_235 }
}

/// Source: S7-200 system manual, configuration of the EM 231 and the EM 235. Of two ranges with the same switches the first one counts.
static RANGES: [Range; 17] = [
    range("0-10 V", (0.0, 10.0), "V", Some("x-x"), Some("-x---x")),
    range("0-5 V", (0.0, 5.0), "V", Some("xx-"), Some("x----x")),
    range("0-20 mA", (0.0, 20.0), "mA", Some("xx-"), Some("x----x")),
    range("0-1 V", (0.0, 1.0), "V", None, Some("-x--xx")),
    range("0-500 mV", (0.0, 500.0), "mV", None, Some("x---xx")),
    range("0-100 mV", (0.0, 100.0), "mV", None, Some("-x-x-x")),
    range("0-50 mV", (0.0, 50.0), "mV", None, Some("x--x-x")),
    range("+-10 V", (-10.0, 10.0), "V", None, Some("--x---")),
    range("+-5 V", (-5.0, 5.0), "V", Some("--x"), Some("-x----")),
    range("+-2.5 V", (-2.5, 2.5), "V", Some("-x-"), Some("x-----")),
    range("+-1 V", (-1.0, 1.0), "V", None, Some("--x-x-")),
    range("+-500 mV", (-500.0, 500.0), "mV", None, Some("-x--x-")),
    range("+-250 mV", (-250.0, 250.0), "mV", None, Some("x---x-")),
    range("+-100 mV", (-100.0, 100.0), "mV", None, Some("--xx--")),
    range("+-50 mV", (-50.0, 50.0), "mV", None, Some("-x-x--")),
    range("+-25 mV", (-25.0, 25.0), "mV", None, Some("x--x--")),
    // Outputs; an EM 232 has no switches.
    range("+-10 V", (-10.0, 10.0), "V", None, None),
];

/// Reads the table. Reports wrong keys and ignores them.
pub fn read(keys: &S7200Keys, file: FileId) -> (S7200Config, Vec<Diagnostic>) {
    let mut reader = Reader::new(file);
    let config = reader.config(keys);
    (config, reader.diagnostics)
}

/// Reports the table if the project is for another CPU.
pub fn check(place: Option<Span>, profile: &Profile) -> Option<Diagnostic> {
    let place = place.filter(|_| profile.family != Family::S7200)?;
    let title = format!("the CPU {} is not an S7-200", profile.name);
    Some(Diagnostic::new(Code::Project, place, title).help("`[s7200]` is only for CPUs of the S7-200"))
}

impl Reader {
    fn number(&mut self, key: &Spanned<i64>, range: RangeInclusive<i64>, what: &str) -> Option<u8> {
        let help = format!("write a number from {} to {}", range.start(), range.end());
        number_within(key, range, what).map_err(|title| self.report(key, title, &help)).ok()
    }

    fn config(&mut self, keys: &S7200Keys) -> S7200Config {
        let station = keys.station.as_ref().and_then(|key| self.number(key, 0..=STATION_MAX, "a station address"));
        let mut config = S7200Config {
            station,
            watchdog_ms: keys.watchdog.as_ref().and_then(|key| self.watchdog(key)),
            stop_on_error: keys.stop_on_error,
            strict_compare: keys.strict_compare,
            ..S7200Config::default()
        };
        if let Some(values) = &keys.potentiometers {
            if values.get_ref().len() > POTENTIOMETERS {
                let title = format!("a CPU has at most {POTENTIOMETERS} analog potentiometers");
                self.report(values, title, "write `[10, 0]`");
            }
            for (value, place) in values.get_ref().iter().zip(&mut config.potentiometers) {
                *place = self.number(value, 0..=255, "a value of a potentiometer").unwrap_or_default();
            }
        }
        if let Some(switch) = &keys.mode_switch {
            match switch.get_ref().to_ascii_lowercase().as_str() {
                "run" => {}
                "term" => config.mode_switch_term = true,
                _ => {
                    let title = format!("`{}` is not a position of the mode switch", switch.get_ref());
                    self.report(switch, title, "\"run\" or \"term\"");
                }
            }
        }
        for port in &keys.port {
            let known = |number: u8| config.ports.iter().any(|port| port.number == number);
            match self.port(port) {
                Some(new) if known(new.number) => {
                    self.report(&port.number, format!("port {} occurs twice", new.number), "give each port once");
                }
                new => config.ports.extend(new),
            }
        }
        if let Some(network) = &keys.network {
            config.listen = network.listen.as_ref().and_then(|key| self.address(key));
            self.stations(&network.stations, &mut config);
        }
        for (index, module) in keys.analog.iter().enumerate() {
            if index == MODULES_MAX {
                let title = format!("a CPU has at most {MODULES_MAX} expansion modules");
                self.report(&module.module, title, "leave some out");
            }
            config.analog.extend(self.analog(module));
        }
        config
    }

    fn watchdog(&mut self, key: &Spanned<String>) -> Option<u16> {
        let ms = duration_ms(key.get_ref()).and_then(|ms| u16::try_from(ms).ok());
        if ms.is_none() {
            let title = format!("`{}` is not a time from 0 to {} ms", key.get_ref(), u16::MAX);
            self.report(key, title, "write `300ms`, or `0ms` for none");
        }
        ms
    }

    fn address(&mut self, key: &Spanned<String>) -> Option<String> {
        let found = socket_address(key.get_ref());
        if found.is_none() {
            let title = format!("`{}` is not an address with a port", key.get_ref());
            self.report(key, title, "write `\"127.0.0.1:7000\"` or `\"localhost:7000\"`");
        }
        found.map(|_| key.get_ref().clone())
    }

    fn port(&mut self, keys: &PortKeys) -> Option<Port> {
        let number = self.number(&keys.number, 0..=1, "a port")?;
        let links = [
            keys.device.as_ref().and_then(|key| self.file_name(key, "device", "/dev/ttyUSB0")).map(Link::Device),
            keys.pty.as_ref().and_then(|key| self.file_name(key, "device", "/dev/ttyUSB0")).map(Link::PseudoTerminal),
            keys.listen.as_ref().and_then(|key| self.address(key)).map(Link::Listen),
            keys.connect.as_ref().and_then(|key| self.address(key)).map(Link::Connect),
        ];
        let given = [&keys.device, &keys.pty, &keys.listen, &keys.connect].into_iter().flatten().count();
        if given != 1 {
            let title = format!("port {number} has {given} connections");
            self.report(&keys.number, title, "write one of `device`, `pty`, `listen` and `connect`");
            return None;
        }
        links.into_iter().flatten().next().map(|link| Port { number, link })
    }

    fn stations(&mut self, keys: &BTreeMap<Spanned<String>, Spanned<String>>, config: &mut S7200Config) {
        for (station, address) in keys {
            let number = station.get_ref().parse::<u8>().ok().filter(|number| i64::from(*number) <= STATION_MAX);
            let Some(number) = number else {
                let title = format!("`{}` is not a station address from 0 to {STATION_MAX}", station.get_ref());
                self.report(station, title, "write `stations = { \"3\" = \"127.0.0.1:4003\" }`");
                continue;
            };
            if config.station.unwrap_or(STATION_DEFAULT) == number {
                self.report(station, format!("station {number} is this station"), "give the other stations only");
                continue;
            }
            let Some(address) = self.address(address) else { continue };
            config.stations.push((number, address));
        }
        config.stations.sort();
    }

    fn analog(&mut self, keys: &AnalogKeys) -> Option<AnalogModule> {
        let wanted = plain(keys.module.get_ref());
        let Some(kind) = KINDS.iter().find(|kind| plain(kind.name) == wanted) else {
            let title = format!("`{}` is not an analog module", keys.module.get_ref());
            self.report(&keys.module, title, "\"EM 231\", \"EM 232\" or \"EM 235\"");
            return None;
        };
        let inputs = self.channels(keys.inputs.as_ref(), kind.inputs, kind, "inputs")?;
        let outputs = self.channels(keys.outputs.as_ref(), kind.outputs, kind, "outputs")?;
        let range = self.range(keys, kind)?;
        Some(AnalogModule {
            name: kind.name.to_string(),
            inputs,
            outputs,
            low: range.low.to_bits(),
            high: range.high.to_bits(),
            unit: range.unit.to_string(),
            bipolar: range.low < 0.0,
        })
    }

    fn channels(&mut self, key: Option<&Spanned<i64>>, made: &[u8], kind: &Kind, what: &str) -> Option<u8> {
        let Some(key) = key else { return made.first().copied() };
        let found = made.iter().copied().find(|count| i64::from(*count) == *key.get_ref());
        if found.is_none() {
            let counts: Vec<String> = made.iter().map(u8::to_string).collect();
            let title = format!("the {} does not have {} {what}", kind.name, key.get_ref());
            self.report(key, title, &format!("it has {}", counts.join(" or ")));
        }
        found
    }

    /// The range in words comes first, then that of the switches.
    fn range(&mut self, keys: &AnalogKeys, kind: &Kind) -> Option<&'static Range> {
        let switches = |range: &Range| match kind.name {
            "EM 231" => range.em_231,
            "EM 235" => range.em_235,
            _ => None,
        };
        if kind.inputs == [0] {
            if let Some(key) = keys.range.as_ref().or(keys.switches.as_ref()) {
                self.report(key, format!("the {} has no inputs", kind.name), "its outputs are +-10 V and 0-20 mA");
                return None;
            }
            return RANGES.last();
        }
        let list: Vec<&'static Range> = RANGES.iter().filter(|range| switches(range).is_some()).collect();
        let by_switches = match &keys.switches {
            None => None,
            Some(key) => {
                let wanted = plain(key.get_ref());
                let found = list.iter().copied().find(|range| switches(range) == Some(wanted.as_str()));
                if found.is_none() {
                    let rows: Vec<String> =
                        list.iter().filter_map(|range| Some(format!("{} {}", switches(range)?, range.name))).collect();
                    let title = format!("`{}` is not a switch setting of an {}", key.get_ref(), kind.name);
                    self.report(key, title, &format!("x means on: {}", rows.join(", ")));
                    return None;
                }
                found
            }
        };
        match &keys.range {
            None => by_switches.or_else(|| list.iter().copied().find(|range| range.name == RANGE_DEFAULT)),
            Some(key) => {
                let wanted = plain(&key.get_ref().replace("..", "-").replace('±', "+-"));
                let found = list.iter().copied().find(|range| plain(range.name) == wanted);
                if found.is_none() {
                    let names: Vec<&str> = list.iter().map(|range| range.name).collect();
                    let title = format!("`{}` is not a range of an {}", key.get_ref(), kind.name);
                    self.report(key, title, &one_of(key.get_ref(), &names));
                }
                found
            }
        }
    }
}

/// Without blanks, in lower case.
fn plain(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace()).flat_map(char::to_lowercase).collect()
}
