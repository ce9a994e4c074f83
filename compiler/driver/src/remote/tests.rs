//! Tests of the section `[io]` of plc.toml.

use plcc_diag::SourceFile;

use super::*;
use crate::project;

type Found = (Vec<RemoteStation>, Option<Vec<Module>>, Vec<(u32, String)>);

/// Devices and modules of a project, and the messages with their lines.
fn read(text: &str) -> Found {
    let source = SourceFile::new("plc.toml", text);
    let (project, diagnostics) = project::parse(FileId(0), &source);
    let messages = diagnostics.into_iter().map(|d| (source.line(d.primary.span.start), d.title)).collect();
    (project.config.remote, project.config.modules, messages)
}

#[test]
fn a_device_has_defaults() {
    let (stations, modules, messages) = read(
        "[io.tank]\nmodbus = \"10.0.0.1\"\n[[io.tank.data]]\ndiscrete = 3\nat = \"I4.2\"\n\
         [[io.tank.data]]\nholding = 0\nat = \"PQD300\"\nwords = \"low first\"\nsubstitute = -1\n",
    );
    assert_eq!(messages, []);
    assert_eq!(modules, None, "without a station every address exists");
    let [station] = &stations[..] else { panic!("{stations:?}") };
    assert_eq!(station.line, RemoteLine::Tcp("10.0.0.1:502".to_string()));
    assert_eq!((station.unit, station.poll_ms, station.timeout_ms, station.keep), (1, 100, 1000, true));
    let places: Vec<_> =
        station.channels.iter().map(|c| (c.table, c.first, c.count, c.output, c.byte, c.bit)).collect();
    assert_eq!(
        places,
        [(RemoteTable::DiscreteInputs, 3, 1, false, 4, 2), (RemoteTable::HoldingRegisters, 0, 2, true, 300, 0)]
    );
    assert_eq!(station.channels[1].substitute, 0xFFFF);
}

#[test]
fn help_has_the_address_of_the_user() {
    let help = |table: &str, at: &str| {
        let text = format!("[io.a]\nmodbus = \"h\"\n[[io.a.data]]\n{table} = 0\nat = \"{at}\"\n");
        let (_, diagnostics) = project::parse(FileId(0), &SourceFile::new("plc.toml", text.as_str()));
        diagnostics.into_iter().flat_map(|diagnostic| diagnostic.help).collect::<Vec<_>>()
    };
    assert_eq!(help("holding", "IB4"), ["write `IW4`, or `ID4` for two of them"]);
    assert_eq!(help("input", "I4.0"), ["write `IW4`, or `ID4` for two of them"]);
    assert_eq!(help("coils", "QW6"), ["write `Q6.0` or `QB6`"]);
    assert_eq!(help("discrete", "PIW300"), ["write `PIB300`"]);
}

#[test]
fn reference_numbers_are_told_from_addresses() {
    let told = |table: &str| {
        let at = if table.starts_with("discrete") { "I4.0" } else { "IW4" };
        let text = format!("[io.a]\nmodbus = \"h\"\n[[io.a.data]]\n{table}\nat = \"{at}\"\n");
        let (_, diagnostics) = project::parse(FileId(0), &SourceFile::new("plc.toml", text.as_str()));
        let told = diagnostics.into_iter().map(|message| (message.is_error(), message.help.unwrap_or_default()));
        told.collect::<Vec<_>>()
    };
    let write = |what: &str| format!("write `{what}`, the address of that element: addresses begin at 0");
    let warning = |what: &str, number: u32| {
        let word = what.split(' ').next().unwrap_or_default();
        let own = format!("if {number} is the address itself, write `{word} = 0x{number:X}`");
        vec![(false, format!("{}; {own}", write(what)))]
    };
    assert_eq!(told("holding = 40001"), warning("holding = 0", 40001));
    assert_eq!(told("input = 30011"), warning("input = 10", 30011));
    assert_eq!(told("discrete = 10001"), warning("discrete = 0", 10001));
    assert_eq!(told("holding = 400123"), [(true, write("holding = 122"))]);
    for good in ["holding = 30001", "holding = 40000", "input = 40001", "holding = 1", "holding = 0x9C41"] {
        assert_eq!(told(good), [], "{good}");
    }
}

#[test]
fn a_line_and_a_range_are_read() {
    let (stations, _, messages) = read(
        "[io.a]\nserial = \"/dev/ttyS0\"\nbaud = 9600\nparity = \"odd\"\naway = \"substitute\"\n\
         [[io.a.data]]\ninput = 1\nat = \"IW10\"\nraw = [-500, 500]\nrange = \"+-10 V\"\n",
    );
    assert_eq!(messages, []);
    let line = RemoteLine::Serial { path: "/dev/ttyS0".to_string(), baud: 9600, parity: RemoteParity::Odd };
    assert_eq!((&stations[0].line, stations[0].keep), (&line, false));
    let scale = RemoteScale { raw_low: -500, raw_high: 500, word_low: -27_648, word_high: 27_648 };
    assert_eq!(stations[0].channels[0].scale, Some(scale));
}

#[test]
fn what_is_wrong_has_its_line() {
    let wrong = |line: &str, expected: &str| {
        let text = format!("[io.a]\nmodbus = \"a\"\n[[io.a.data]]\n{line}\n");
        let (stations, _, messages) = read(&text);
        assert!(stations.is_empty(), "{line}");
        let found = messages.iter().any(|(at, title)| *at >= 4 && title.contains(expected));
        assert!(found, "{line}: {messages:?}");
    };
    wrong("at = \"IW4\"", "one table");
    wrong("at = \"IW4\"\nholding = 1\ncoils = 1", "one table");
    wrong("at = \"IW4\"\ncoils = 1", "are bits");
    wrong("at = \"I4.0\"\nholding = 1", "are words");
    wrong("at = \"MW4\"\nholding = 1", "not an input or output");
    wrong("at = \"QW4\"\ninput = 1", "only be read");
    wrong("at = \"IW4\"\nholding = 70000", "70000 is not");
    wrong("at = \"IW4\"\nholding = 0\ncount = 126", "126 is not");
    wrong("at = \"QW4\"\nholding = 0\ncount = 124", "124 is not");
    wrong("at = \"IW4\"\nholding = 65535\ncount = 2", "up to 65535");
    wrong("at = \"IW4\"\nholding = 0\nwords = \"low first\"", "pairs");
    wrong("at = \"I4.0\"\ncoils = 0\nbytes = \"high first\"", "no order");
    wrong("at = \"IW4\"\nholding = 0\nrange = \"0..10 V\"", "numbers of the device");
    wrong("at = \"IW4\"\nholding = 0\nraw = [5, 5]", "`raw`");
    wrong("at = \"IW4\"\nholding = 0\nraw = [0, 10]\nrange = \"12 V\"", "not a range");
    wrong("at = \"IW65535\"\nholding = 0", "after the last address");
    wrong("at = \"IW4\"\nholding = 0\n[[io.a.data]]\nat = \"I5.7\"\ncoils = 0", "in common");
    let (_, _, messages) = read("[io.a]\n[[io.a.data]]\nat = \"IW0\"\nholding = 0\n");
    assert_eq!(messages, [(1, "`a` needs either `modbus` or `serial`".to_string())]);
    let (_, _, messages) = read("[io.a]\nmodbus = \"a b\"\ntimeout = \"soon\"\n");
    assert_eq!(messages.len(), 3, "{messages:?}");
}

#[test]
fn an_address_has_a_port() {
    let address = |text: &str| tcp_address(text).unwrap_or_else(|help| help);
    for (text, expected) in [
        ("10.0.0.1", "10.0.0.1:502"),
        ("plc:1502", "plc:1502"),
        ("::1", "[::1]:502"),
        ("[::1]", "[::1]:502"),
        ("[::1]:1502", "[::1]:1502"),
    ] {
        assert_eq!(address(text), expected, "{text}");
    }
    assert_eq!(address("10.0.0.1:"), "write `10.0.0.1:502`");
    for (text, port) in [("10.0.0.1:99999", "99999"), ("10.0.0.1:0", "0"), ("10.0.0.1:a:1", "a:1")] {
        let expected = format!("`{port}` is not a port, a number from 1 to 65535: write `10.0.0.1:502`");
        assert_eq!(address(text), expected, "{text}");
    }
    for text in ["", "a b", "tcp://10.0.0.1:502", ":502", "[::1]502", "[plc]:502", "[::1"] {
        assert_eq!(address(text), "write `192.168.0.20:502`", "{text}");
    }
    let (stations, _, messages) =
        read("[io.a]\nmodbus = \"10.0.0.1:99999\"\n[[io.a.data]]\nholding = 0\nat = \"IW4\"\n");
    assert!(stations.is_empty());
    assert_eq!(messages, [(2, "`10.0.0.1:99999` is not an address".to_string())]);
}

#[test]
fn settings_of_the_other_kind_of_line_are_refused() {
    let messages = |keys: &str| read(&format!("[io.a]\n{keys}\n[[io.a.data]]\nholding = 0\nat = \"IW4\"\n")).2;
    assert_eq!(messages("modbus = \"a\"\nunit = 0"), []);
    assert_eq!(
        messages("modbus = \"a\"\nparity = \"odd\""),
        [(3, "`parity` is a setting of serial lines".to_string())]
    );
    assert_eq!(
        messages("serial = \"/dev/ttyS0\"\nunit = 0"),
        [(3, "on a serial line 0 is all devices, and none of them answers".to_string())]
    );
}

#[test]
fn devices_on_one_line_have_its_settings() {
    let device = |name: &str, byte: u8, baud: u32| {
        format!(
            "[io.{name}]\nserial = \"/dev/ttyS0\"\nbaud = {baud}\n[[io.{name}.data]]\ncoils = 0\nat = \"IB{byte}\"\n"
        )
    };
    let (stations, _, messages) = read(&[device("a", 0, 9600), device("b", 1, 9600)].concat());
    assert_eq!((stations.len(), messages), (2, Vec::new()));
    let (_, _, messages) = read(&[device("a", 0, 9600), device("b", 1, 19200)].concat());
    assert_eq!(messages, [(7, "`a` and `b` are on one line with different settings".to_string())]);
}

#[test]
fn addresses_of_devices_and_modules_are_apart() {
    let module = "[[module]]\nname = \"DI\"\ninputs = { start = 0, bytes = 2 }\n";
    let device = |at: &str| format!("{module}[io.a]\nmodbus = \"a\"\n[[io.a.data]]\ncoils = 0\nat = \"{at}\"\n");
    let (_, modules, messages) = read(&device("IB2"));
    assert_eq!((modules.map(|modules| modules.len()), messages), (Some(2), Vec::new()));
    let (_, _, messages) = read(&device("I1.7"));
    assert_eq!(messages, [(4, "`io a` and module `DI` have addresses in common".to_string())]);
}
