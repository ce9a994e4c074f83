//! samples/tank-online: both programs at once, as its script starts them.

use std::path::Path;
use std::time::{Duration, Instant};

use libtest_mimic::Failed;

use crate::hostile::{CONNECT, SETUP, asks};
use crate::process::{Plc, free_port, get, plcc};
use crate::ua;

/// Ports in the sample.
const PORTS: [u16; 6] = [15020, 15102, 15103, 15104, 15105, 15106];

/// A program of the sample on other ports: others may use these at this moment.
fn built(name: &str, folder: &Path, ports: &[u16; 6]) -> Result<std::path::PathBuf, Failed> {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../samples/tank-online").join(name);
    let own = folder.join(name);
    std::fs::create_dir(&own)?;
    for entry in std::fs::read_dir(from)? {
        let path = entry?.path();
        // Its tests.
        if path.is_dir() {
            continue;
        }
        let mut text = std::fs::read_to_string(&path)?;
        for (port, free) in PORTS.iter().zip(ports) {
            text = text.replace(&port.to_string(), &free.to_string());
        }
        std::fs::write(own.join(path.file_name().ok_or("no name")?), text)?;
    }
    let out = folder.join(format!("{name}.program"));
    plcc(&["build", "--quiet"], &[&own], &out)?;
    Ok(out)
}

/// Four bytes of a DB with this address.
fn read(port: u16, db: u8, byte: u16) -> Result<[u8; 4], Failed> {
    let [high, low] = (8 * byte).to_be_bytes();
    let item = [0x12, 10, 0x10, 2, 0, 4, 0, db, 0x84, 0, high, low];
    let job = [&[3, 0, 0, 31, 2, 0xF0, 0x80, 0x32, 1, 0, 0, 0, 2, 0, 14, 0, 0, 4, 1][..], &item].concat();
    let answer = asks(port, &[CONNECT, SETUP, &job])?;
    let value = answer.get(21..29).filter(|item| item[0] == 0xFF).and_then(|item| item[4..].try_into().ok());
    value.ok_or_else(|| format!("{answer:02X?}").into())
}

pub fn plays_together() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let ports = [(); 6].map(|()| free_port());
    let [_, _, s7, metrics, _, opcua] = ports;
    let (plant, controller) = (built("plant", folder.path(), &ports)?, built("controller", folder.path(), &ports)?);
    let plant = Plc::run_in(folder.path(), &plant, &[])?;
    let controller = Plc::run_in(folder.path(), &controller, &[])?;
    let began = Instant::now();
    loop {
        // What the sensor says, and how often the plant has answered.
        let level = f32::from_be_bytes(read(s7, 1, 4)?);
        let answers = i32::from_be_bytes(read(s7, 2, 12)?);
        if level > 0.0 && answers > 0 {
            break;
        }
        if began.elapsed() > Duration::from_secs(20) {
            return Err(format!("level {level}, {answers} answers").into());
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    ua::Session::open(opcua).ok_or("no OPC UA session")?;
    let page = get(metrics, "/metrics")?;
    if !page.lines().any(|line| line == "plc_running 1") {
        return Err(page.into());
    }
    controller.end()?;
    plant.end()?;
    Ok(())
}
