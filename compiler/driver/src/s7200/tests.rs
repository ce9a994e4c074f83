//! Settings of an S7-200, read from texts.

use plcc_diag::SourceFile;

use super::*;
use crate::project::{FILE_NAME, parse};

fn read(text: &str) -> (S7200Config, Vec<(u32, String)>) {
    let source = SourceFile::new(FILE_NAME, text);
    let (project, diagnostics) = parse(FileId(0), &source);
    (project.config.s7200, diagnostics.into_iter().map(|d| (source.line(d.primary.span.start), d.title)).collect())
}

#[test]
fn reads_every_key() {
    let (config, messages) = read(
        r#"
[s7200]
station = 4
watchdog = "300ms"
potentiometers = [10, 200]
stop-on-error = true
strict_compare = true
mode_switch = "term"

[[s7200.port]]
number = 0
device = "/dev/ttyUSB0"

[[s7200.port]]
number = 1
connect = "localhost:7000"

[s7200.network]
listen = "127.0.0.1:4004"
stations = { "12" = "127.0.0.1:4012", "3" = "127.0.0.1:4003" }

[[s7200.analog]]
module = "EM 235"
range = "0-10 V"

[[s7200.analog]]
module = "em231"
inputs = 8
switches = "-x-"

[[s7200.analog]]
module = "EM 232"
"#,
    );
    assert_eq!(messages, []);
    assert_eq!(config.station, Some(4));
    assert_eq!((config.watchdog_ms, config.potentiometers), (Some(300), [10, 200]));
    assert!(config.stop_on_error && config.strict_compare && config.mode_switch_term);
    assert_eq!(
        config.ports,
        [
            Port { number: 0, link: Link::Device("/dev/ttyUSB0".to_string()) },
            Port { number: 1, link: Link::Connect("localhost:7000".to_string()) },
        ]
    );
    assert_eq!(config.listen.as_deref(), Some("127.0.0.1:4004"));
    let stations = [(3, "127.0.0.1:4003".to_string()), (12, "127.0.0.1:4012".to_string())];
    assert_eq!(config.stations, stations);
    let module = |name: &str, inputs: u8, outputs: u8, (low, high): (f64, f64), bipolar: bool| AnalogModule {
        name: name.to_string(),
        inputs,
        outputs,
        low: low.to_bits(),
        high: high.to_bits(),
        unit: "V".to_string(),
        bipolar,
    };
    assert_eq!(
        config.analog,
        [
            module("EM 235", 4, 1, (0.0, 10.0), false),
            module("EM 231", 8, 0, (-2.5, 2.5), true),
            module("EM 232", 0, 2, (-10.0, 10.0), true),
        ]
    );
}

#[test]
fn left_out() {
    let (config, messages) = read("[s7200]\n");
    assert_eq!((config, messages), (S7200Config::default(), vec![]));
    let (config, _) =
        read("[s7200]\nwatchdog = \"0ms\"\nmode_switch = \"run\"\n[[s7200.port]]\nnumber = 0\npty = \"port0\"\n");
    assert_eq!((config.watchdog_ms, config.mode_switch_term), (Some(0), false));
    assert_eq!(config.ports, [Port { number: 0, link: Link::PseudoTerminal("port0".to_string()) }]);
}

#[test]
fn ranges_and_switches() {
    let one = |text: &str| {
        let (config, messages) = read(&format!("[[s7200.analog]]\nmodule = \"EM 235\"\n{text}\n"));
        assert_eq!(messages, []);
        let module = config.analog.first().cloned().unwrap();
        (f64::from_bits(module.low), f64::from_bits(module.high), module.unit, module.bipolar)
    };
    let is = |low: f64, high: f64, unit: &str| (low, high, unit.to_string(), low < 0.0);
    assert_eq!(one(""), is(0.0, 10.0, "V"));
    assert_eq!(one("range = \"0..20 mA\""), is(0.0, 20.0, "mA"));
    assert_eq!(one("range = \"±25 mV\""), is(-25.0, 25.0, "mV"));
    assert_eq!(one("switches = \"x--x-x\""), is(0.0, 50.0, "mV"));
    assert_eq!(one("switches = \"x----x\""), is(0.0, 5.0, "V"));
    assert_eq!(one("switches = \"x----x\"\nrange = \"0-20 mA\""), is(0.0, 20.0, "mA"));
    // Each pattern of an EM 235 means one polarity: SW6 on is unipolar.
    for range in &RANGES {
        assert!(range.em_235.is_none_or(|switches| switches.ends_with('x') == (range.low == 0.0)), "{}", range.name);
        assert!(range.em_231.is_none_or(|switches| switches.starts_with('x') == (range.low == 0.0)), "{}", range.name);
    }
}

#[test]
fn tells_the_line_of_what_is_wrong() {
    let line = |text: &str| read(text).1.first().map(|(line, _)| *line);
    assert_eq!(line("[s7200]\nstation = 127\n"), Some(2));
    assert_eq!(line("[s7200]\nstatoin = 2\n"), Some(2));
    assert_eq!(line("[s7200]\n\nwatchdog = \"70s\"\n"), Some(3));
    assert_eq!(line("[s7200]\npotentiometers = [256]\n"), Some(2));
    assert_eq!(line("[s7200]\npotentiometers = [1, 2, 3]\n"), Some(2));
    assert_eq!(line("[s7200]\nmode_switch = \"stop\"\n"), Some(2));
    assert_eq!(line("[[s7200.port]]\nnumber = 2\npty = \"a\"\n"), Some(2));
    assert_eq!(line("[[s7200.port]]\nnumber = 0\n"), Some(2));
    assert_eq!(line("[[s7200.port]]\nnumber = 0\npty = \"a\"\nlisten = \"127.0.0.1:1\"\n"), Some(2));
    assert_eq!(line("[[s7200.port]]\nnumber = 0\nlisten = \"7000\"\n"), Some(3));
    let two = "[[s7200.port]]\nnumber = 0\npty = \"a\"\n";
    assert_eq!(line(&two.repeat(2)), Some(5));
    assert_eq!(line("[s7200.network]\nlisten = \"here\"\n"), Some(2));
    assert_eq!(line("[s7200.network]\nstations = { \"200\" = \"127.0.0.1:1\" }\n"), Some(2));
    assert_eq!(line("[s7200.network.stations]\n3 = \"127.0.0.1\"\n"), Some(2));
    assert_eq!(line("[s7200]\nstation = 3\n[s7200.network.stations]\n3 = \"127.0.0.1:1\"\n"), Some(4));
    assert_eq!(line("[s7200.network.stations]\n2 = \"127.0.0.1:1\"\n"), Some(2));
    assert_eq!(line("[[s7200.analog]]\nmodule = \"EM 234\"\n"), Some(2));
    assert_eq!(line("[[s7200.analog]]\nmodule = \"EM 235\"\ninputs = 5\n"), Some(3));
    assert_eq!(line("[[s7200.analog]]\nmodule = \"EM 235\"\nrange = \"0-7 V\"\n"), Some(3));
    assert_eq!(line("[[s7200.analog]]\nmodule = \"EM 235\"\nswitches = \"xxxxxx\"\n"), Some(3));
    assert_eq!(line("[[s7200.analog]]\nmodule = \"EM 232\"\nrange = \"+-10 V\"\n"), Some(3));
    let many = "[[s7200.analog]]\nmodule = \"EM 232\"\n".repeat(8);
    assert_eq!(line(&many), Some(16));
}
