//! Two programs that exchange data over an S7 connection, a partner of another make, and one that breaks the rules.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use libtest_mimic::Failed;

use crate::hostile::{CONNECT, Random, SETUP, asks};
use crate::process::{Plc, cycles_took_at_most, free_port, plcc};
use crate::{here, venv};

/// The step at which the program has seen all that it wants.
const LAST_STEP: i16 = 100;
/// How long a step may take.
const PATIENCE: Duration = Duration::from_secs(20);

/// The programs, built for a port of the partner.
struct Pair {
    folder: tempfile::TempDir,
    port: u16,
}

impl Pair {
    fn build() -> Result<Pair, Failed> {
        let pair = Pair { folder: tempfile::tempdir()?, port: free_port() };
        let partner = format!("partner = \"127.0.0.1:{}\"\n", pair.port);
        let one = format!(
            "cpu = \"s7-1500\"\n[services]\n[connection.\"16#100\"]\n{partner}\
             local_tsap = \"10.01\"\nremote_tsap = \"10.02\"\n"
        );
        let alone = format!("cpu = \"s7-1200\"\n[connection.1]\n{partner}slot = 1\n");
        let two = "cpu = \"s7-300\"\n[services]\n[connection.1]\npassive = true\npartner = \"127.0.0.1\"\n\
                   local_tsap = \"10.02\"\nremote_tsap = \"10.01\"\n";
        for (name, source, toml) in
            [("one", "one.scl", one.as_str()), ("two", "two.stl", two), ("alone", "alone.scl", &alone)]
        {
            let project = pair.folder.path().join(format!("{name}.project"));
            std::fs::create_dir(&project)?;
            std::fs::copy(here().join("partners").join(source), project.join(source))?;
            std::fs::write(project.join("plc.toml"), toml)?;
            plcc(&["build", "--quiet"], &[&project], &pair.path(name))?;
        }
        Ok(pair)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn one(&self, flags: &[&str]) -> Result<Plc, Failed> {
        Plc::run(&self.path("one"), flags)
    }

    fn two(&self) -> Result<Plc, Failed> {
        Plc::run(&self.path("two"), &["--s7", &self.port.to_string()])
    }

    /// What the first program has written to the second one: step, STATUS, rounds, losses.
    fn log(&self) -> Result<[i16; 4], Failed> {
        let answer = asks(self.port, &[CONNECT, SETUP, READ_LOG])?;
        let words = answer.get(25..33).ok_or_else(|| format!("{answer:02X?}"))?;
        Ok([0, 2, 4, 6].map(|at| i16::from_be_bytes([words[at], words[at + 1]])))
    }

    fn wait(&self, what: &str, done: impl Fn([i16; 4]) -> bool) -> Result<[i16; 4], Failed> {
        let began = Instant::now();
        loop {
            let log = self.log()?;
            if done(log) {
                return Ok(log);
            }
            if began.elapsed() > PATIENCE || log[0] < 0 {
                return Err(format!("{what}: step, STATUS, rounds, losses {log:?}").into());
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

/// Reads eight bytes of DB 11.
const READ_LOG: &[u8] = &[
    3, 0, 0, 31, 2, 0xF0, 0x80, 0x32, 1, 0, 0, 0, 2, 0, 14, 0, 0, 4, 1, 0x12, 10, 0x10, 2, 0, 8, 0, 11, 0x84, 0, 0, 0,
];

/// PUT, GET, BSEND both ways, USEND, errors; then the partner goes away and comes back.
pub fn programs() -> Result<(), Failed> {
    let pair = Pair::build()?;
    // Nobody is there at first.
    let one = pair.one(&[])?;
    let two = pair.two()?;
    pair.wait("the steps", |[step, _, rounds, _]| step == LAST_STEP && rounds > 5)?;
    two.end()?;
    std::thread::sleep(Duration::from_millis(100));
    let two = pair.two()?;
    pair.wait("the partner is back", |[step, _, rounds, lost]| step == LAST_STEP && rounds > 5 && lost > 0)?;
    one.end()?;
    two.end()?;
    Ok(())
}

/// PUT and GET with a server of python-snap7.
pub fn snap7_server() -> Result<(), Failed> {
    let pair = Pair::build()?;
    let mut server = Command::new(venv());
    server.arg(here().join("snap7_server.py")).arg(pair.port.to_string());
    let server = server.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    let alone = Plc::run(&pair.path("alone"), &[])?;
    let output = server.wait_with_output()?;
    alone.end()?;
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    if output.status.success() && said.contains("done") { Ok(()) } else { Err(said.into()) }
}

const CONFIRM: &[u8] = &[3, 0, 0, 22, 17, 0xD0, 0, 1, 0, 2, 0, 0xC0, 1, 10, 0xC1, 2, 0x10, 1, 0xC2, 2, 0x10, 2];
const AGREED: &[u8] = &[3, 0, 0, 27, 2, 0xF0, 0x80, 0x32, 3, 0, 0, 0, 0, 0, 8, 0, 0, 0, 0, 0xF0, 0, 0, 8, 0, 8, 0, 240];
/// Answers to the first jobs, a message, a segment and its acknowledgement.
const ANSWERS: &[&[u8]] = &[
    &[3, 0, 0, 23, 2, 0xF0, 0x80, 0x32, 3, 0, 0, 0, 1, 0, 2, 0, 2, 0, 0, 5, 2, 0xFF, 0xFF],
    &[3, 0, 0, 22, 2, 0xF0, 0x80, 0x32, 3, 0, 0, 0, 2, 0, 2, 0, 1, 0, 0, 5, 1, 0xFF],
    &[3, 0, 0, 27, 2, 0xF0, 0x80, 0x32, 3, 0, 0, 0, 3, 0, 2, 0, 6, 0, 0, 4, 1, 0xFF, 4, 0, 16, 1, 2],
    &[3, 0, 0, 19, 2, 0xF0, 0x80, 0x32, 2, 0, 0, 0, 3, 0, 0, 0, 0, 0x81, 4],
    &[
        3, 0, 0, 39, 2, 0xF0, 0x80, 0x32, 7, 0, 0, 0, 8, 0, 10, 0, 12, 0, 1, 0x12, 6, 0x13, 0, 0, 0, 0, 1, 0xFF, 0, 0,
        1, 0, 9, 0, 4, 1, 2, 3, 4,
    ],
    &[
        3, 0, 0, 47, 2, 0xF0, 0x80, 0x32, 7, 0, 0, 0, 7, 0, 12, 0, 18, 0, 1, 0x12, 8, 0x12, 0x46, 1, 0, 0, 0, 0, 0,
        0xFF, 9, 0, 14, 0x12, 6, 0x13, 0, 0, 0, 0, 8, 0, 4, 1, 2, 3, 4,
    ],
    &[
        3, 0, 0, 33, 2, 0xF0, 0x80, 0x32, 7, 0, 0, 0, 7, 0, 12, 0, 4, 0, 1, 0x12, 8, 0x12, 0x86, 1, 1, 0, 0, 0, 0,
        0x0A, 0, 0, 0,
    ],
];

/// A partner that sends nonsense at all moments. Then the right one comes to its place, and is served.
pub fn hostile_partner() -> Result<(), Failed> {
    let pair = Pair::build()?;
    let metrics = free_port();
    let listener = TcpListener::bind(("127.0.0.1", pair.port))?;
    let one = pair.one(&["--metrics", &metrics.to_string()])?;
    let mut random = Random(7);
    let mut buffer = [0; 4096];
    for round in 0..4 {
        let (mut stream, _) = listener.accept()?;
        stream.set_read_timeout(Some(Duration::from_millis(200)))?;
        let _ = stream.read(&mut buffer);
        // In the first round even the answer to the request for a connection is wrong.
        let confirm = if round == 0 { random.changed(&[CONFIRM]) } else { CONFIRM.to_vec() };
        let talk = |stream: &mut TcpStream, random: &mut Random| -> std::io::Result<()> {
            stream.write_all(&confirm)?;
            let mut buffer = [0; 4096];
            let _ = stream.read(&mut buffer);
            stream.write_all(AGREED)?;
            let _ = stream.read(&mut buffer);
            for index in 0..500 {
                let frame = if index % 7 == 6 {
                    random.changed(ANSWERS)
                } else {
                    ANSWERS[random.below(ANSWERS.len())].to_vec()
                };
                stream.write_all(&frame)?;
            }
            stream.write_all(&random.bytes(200))
        };
        // The program may end the connection at any moment.
        let _ = talk(&mut stream, &mut random);
    }
    drop(listener);
    let two = pair.two()?;
    let began = Instant::now();
    while pair.log()?[0] == 0 {
        if began.elapsed() > PATIENCE {
            return Err("the right partner is not served".into());
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    cycles_took_at_most(metrics, crate::hostile::LONGEST_CYCLE)?;
    one.end()?;
    two.end()?;
    Ok(())
}
