//! A node of Sparkplug B: a host that is not ours, a broker that comes and goes, who may write, and commands that
//! break the rules.

use std::io::Write;
use std::net::TcpStream;
use std::process::{Command, Stdio};
use std::time::Duration;

use libtest_mimic::Failed;

use crate::hostile::{LONGEST_CYCLE, Random};
use crate::process::{Plc, Program, broker, connect_to_broker, cycles_took_at_most, free_port, write_register};
use crate::{here, venv};

/// The values that the host knows.
const PUBLISHED: &str = "Values,Groups,Fixed,Guarded,Hidden,MW20,Shown,MB45";

fn url(port: u16) -> String {
    format!("mqtt://127.0.0.1:{port}")
}

/// Runs the host; what it says.
fn run_host(port: u16, what: &str, plc: &Plc) -> Result<String, Failed> {
    let mut command = Command::new(venv());
    command.arg(here().join("sparkplug_client.py")).args([port.to_string(), what.to_string(), plc.id().to_string()]);
    let output = command.stdin(Stdio::null()).output()?;
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    if output.status.success() { Ok(said) } else { Err(said.into()) }
}

/// Births, data, commands of all types, and the death.
pub fn host() -> Result<(), Failed> {
    let port = free_port();
    let _broker = broker(port)?;
    let flags = ["--mqtt", &url(port), "--sparkplug", "plant/line/press", "--publish", PUBLISHED];
    let plc = Plc::run(Program::Plant.path()?, &flags)?;
    let said = run_host(port, "all", &plc)?;
    if said.contains("done") { Ok(()) } else { Err(said.into()) }
}

/// Each connection has another number, and begins with the values of its moment.
pub fn broker_comes_back() -> Result<(), Failed> {
    let (port, modbus) = (free_port(), free_port().to_string());
    let first = broker(port)?;
    let flags = ["--modbus", &modbus, "--mqtt", &url(port), "--sparkplug", "plant/line", "--publish", "DB1.DBW0"];
    let plc = Plc::start(&flags)?;
    let births = |expected: &str| -> Result<u8, Failed> {
        let said = run_host(port, "births", &plc)?;
        let words: Vec<&str> = said.split_whitespace().collect();
        match words[..] {
            ["bdSeq", number, "value", value] if value == expected => Ok(number.parse()?),
            _ => Err(format!("{expected}: {said}").into()),
        }
    };
    let before = births("0")?;
    drop(first);
    // While the broker is away.
    write_register(&modbus, 0x1235)?;
    std::thread::sleep(Duration::from_millis(500));
    let _second = broker(port)?;
    std::thread::sleep(Duration::from_millis(1500));
    let after = births("4661")?;
    match after > before {
        true => plc.end().map(drop),
        false => Err(format!("bdSeq {before}, then {after}").into()),
    }
}

/// A broker that is a client without the right to write.
pub fn may_not_write() -> Result<(), Failed> {
    let port = free_port();
    let _broker = broker(port)?;
    let flags = ["--mqtt", &url(port), "--sparkplug", "plant/line", "--publish", "MW10", "--access", "read"];
    let plc = Plc::start(&flags)?;
    run_host(port, "refused", &plc)?;
    plc.end().map(drop)
}

/// A command for the metric MW10: field 2 of a payload is a metric with a name (1), a data type (4) and a value (10).
const WRITE: &[u8] = b"\x08\x01\x12\x0C\x0A\x04MW10\x18\x01\x20\x06\x50\x07";
/// A command for the first value by its alias (2).
const BY_ALIAS: &[u8] = b"\x12\x06\x10\x10\x20\x06\x50\x09";
const REBIRTH: &[u8] = b"\x12\x1A\x0A\x14Node Control/Rebirth\x20\x0B\x70\x01";

/// PUBLISH with quality of service 0. Source: MQTT 3.1.1, section 3.3.
fn publish(topic: &str, payload: &[u8]) -> Vec<u8> {
    let mut frame = vec![0x30];
    let mut length = 2 + topic.len() + payload.len();
    while length > 127 {
        frame.push(length as u8 | 0x80);
        length >>= 7;
    }
    frame.push(length as u8);
    frame.extend((topic.len() as u16).to_be_bytes());
    frame.extend(topic.as_bytes());
    frame.extend(payload);
    frame
}

/// Random and changed commands, as fast as the broker takes them.
pub fn hostile() -> Result<(), Failed> {
    const COMMANDS: usize = 20_000;
    let (port, metrics) = (free_port(), free_port());
    let _broker = broker(port)?;
    let flags = ["--metrics", &metrics.to_string(), "--mqtt", &url(port), "--sparkplug", "plant/line"];
    let plc = Plc::start(&[&flags[..], &["--publish", "MW10"]].concat())?;
    std::thread::sleep(Duration::from_millis(500));
    let mut random = Random(7);
    let mut stream: TcpStream = connect_to_broker(port, "attacker")?;
    for index in 0..COMMANDS {
        let payload = match index % 2 {
            0 => random.bytes(200),
            _ => random.changed(&[WRITE, BY_ALIAS, REBIRTH]),
        };
        stream.write_all(&publish("spBv1.0/plant/NCMD/line", &payload))?;
        if index % 100 == 0 {
            // Else most of them would be lost in the queue of the node.
            std::thread::sleep(Duration::from_millis(10));
        }
    }
    std::thread::sleep(Duration::from_millis(500));
    run_host(port, "births", &plc)?;
    cycles_took_at_most(metrics, LONGEST_CYCLE)?;
    plc.end().map(drop)
}
