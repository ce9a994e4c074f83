//! The program of this folder as a process, and a broker.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use libtest_mimic::Failed;

use crate::here;

/// A port that was free a moment ago, and that no other test of this process has.
pub fn free_port() -> u16 {
    static GIVEN: Mutex<BTreeSet<u16>> = Mutex::new(BTreeSet::new());
    let mut given = GIVEN.lock().unwrap_or_else(PoisonError::into_inner);
    let free = || TcpListener::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).map(|address| address.port());
    // A port that is closed again may be proposed again before its service opens it.
    std::iter::repeat_with(free).map_while(Result::ok).find(|port| given.insert(*port)).unwrap_or(0)
}

/// Runs plcc in this process.
pub fn plcc(flags: &[&str], inputs: &[&Path], out: &Path) -> Result<(), Failed> {
    let flags = ["plcc"].iter().chain(flags).map(|flag| flag.into());
    let inputs = inputs.iter().map(|input| input.as_os_str().to_os_string());
    let arguments = flags.chain(inputs).chain(["-o".into(), out.into()]);
    match plcc_driver::main_with(arguments) {
        0 => Ok(()),
        code => Err(format!("plcc ended with {code}").into()),
    }
}

/// The programs of this folder.
#[derive(Clone, Copy)]
pub enum Program {
    Line,
    /// Has values of all types.
    Plant,
}

impl Program {
    /// The executable, built once.
    pub fn path(self) -> Result<&'static Path, Failed> {
        static PROGRAMS: [OnceLock<Result<PathBuf, String>>; 2] = [const { OnceLock::new() }; 2];
        // The page of the line draws its networks; with the status of statements it has STL as text.
        let (name, flags): (_, &[&str]) = match self {
            Program::Line => ("line", &["build", "--quiet", "--no-monitor"]),
            Program::Plant => ("plant", &["build", "--quiet"]),
        };
        let build = || {
            let out = crate::clients().join(name);
            let _ = std::fs::create_dir_all(crate::clients());
            plcc(flags, &[&here().join(name)], &out).map(|()| out).map_err(|error| format!("{error:?}"))
        };
        PROGRAMS[self as usize].get_or_init(build).as_deref().map_err(|error| error.as_str().into())
    }
}

/// A running program.
pub struct Plc {
    child: Child,
}

impl Plc {
    /// Runs the line until it has opened its services.
    pub fn start(flags: &[&str]) -> Result<Plc, Failed> {
        Plc::run(Program::Line.path()?, flags)
    }

    /// As [`Plc::start`], of another program.
    pub fn run(program: &Path, flags: &[&str]) -> Result<Plc, Failed> {
        Plc::run_in(&crate::clients(), program, flags)
    }

    /// As [`Plc::run`], in a folder.
    pub fn run_in(folder: &Path, program: &Path, flags: &[&str]) -> Result<Plc, Failed> {
        let mut command = Command::new(program);
        command.current_dir(folder).args(["--cycle-time", "2ms"]).args(flags);
        command.stdin(Stdio::null()).stderr(Stdio::piped());
        let mut plc = Plc { child: spawn(&mut command)? };
        let error = plc.child.stderr.as_mut().ok_or("no standard error")?;
        // The first line says what was opened; the rest is read at the end.
        let mut line = String::new();
        let mut one = [0];
        while !line.ends_with('\n') && error.read(&mut one)? > 0 {
            line.push(char::from(one[0]));
        }
        match line.contains("127.0.0.1:") || line.contains(" to mqtt") {
            true => Ok(plc),
            false => Err(line.into()),
        }
    }

    /// Number of the process.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    pub fn is_running(&mut self) -> bool {
        self.child.try_wait().is_ok_and(|ended| ended.is_none())
    }

    /// Ends it as a user does. Result: what it said.
    pub fn end(mut self) -> Result<String, Failed> {
        if !self.is_running() {
            return Err("the program had ended before".into());
        }
        Command::new("kill").arg(self.child.id().to_string()).status()?;
        let mut said = String::new();
        if let Some(error) = &mut self.child.stderr {
            error.read_to_string(&mut said)?;
        }
        let status = self.child.wait()?;
        if status.success() { Ok(said) } else { Err(format!("{status}: {said}").into()) }
    }
}

fn spawn(command: &mut Command) -> std::io::Result<Child> {
    loop {
        match command.spawn() {
            // A process that another test starts at this moment still has the file open for writing.
            Err(error) if error.kind() == std::io::ErrorKind::ExecutableFileBusy => {
                std::thread::sleep(Duration::from_millis(1));
            }
            started => return started,
        }
    }
}

impl Drop for Plc {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The answer to a request for a page.
pub fn get(port: u16, path: &str) -> Result<String, Failed> {
    let mut stream = TcpStream::connect(("127.0.0.1", port))?;
    stream.set_read_timeout(Some(Duration::from_secs(10)))?;
    write!(stream, "GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")?;
    let mut page = String::new();
    stream.read_to_string(&mut page)?;
    Ok(page)
}

/// Longest cycle so far is at most this many seconds, by the histogram of the metrics.
pub fn cycles_took_at_most(port: u16, bound: &str) -> Result<(), Failed> {
    page_has_short_cycles(&get(port, "/metrics")?, bound)
}

/// As [`cycles_took_at_most`], of metrics that have come.
pub fn page_has_short_cycles(page: &str, bound: &str) -> Result<(), Failed> {
    let count = |name: &str| page.lines().find_map(|line| line.strip_prefix(name)?.trim().parse::<u64>().ok());
    let within = count(&format!("plc_cycle_seconds_bucket{{le=\"{bound}\"}}"));
    let all = count("plc_cycle_seconds_count");
    match (within, all) {
        (Some(within), Some(all)) if all > 50 && within == all => Ok(()),
        found => Err(format!("{found:?} cycles within {bound} s\n{page}").into()),
    }
}

/// A process that ends with its value.
pub struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// mosquitto without encryption.
pub fn broker(port: u16) -> Result<Ended, Failed> {
    broker_with(port, &["-p", &port.to_string()])
}

/// mosquitto with other flags.
pub fn broker_with(port: u16, flags: &[&str]) -> Result<Ended, Failed> {
    let mut command = Command::new("mosquitto");
    command.args(flags).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let broker = Ended(command.spawn()?);
    let began = Instant::now();
    while TcpStream::connect(("127.0.0.1", port)).is_err() {
        if began.elapsed() > Duration::from_secs(5) {
            return Err("the broker does not answer".into());
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    Ok(broker)
}

/// A connection of MQTT, whose first answer is not read. Frame: MQTT 3.1.1, section 3.1.
pub fn connect_to_broker(port: u16, identifier: &str) -> Result<TcpStream, Failed> {
    let mut stream = TcpStream::connect(("127.0.0.1", port))?;
    let mut connect = vec![0x10, 12 + identifier.len() as u8, 0, 4];
    connect.extend(b"MQTT\x04\x02\x00\x3C\x00");
    connect.push(identifier.len() as u8);
    connect.extend(identifier.as_bytes());
    stream.write_all(&connect)?;
    Ok(stream)
}

/// A client of MQTT that only listens: what came until `done`, or for ten seconds. Frames: MQTT 3.1.1, sections 3.3, 3.8.
fn listen(port: u16, done: impl Fn(&str) -> bool) -> Result<String, Failed> {
    let mut stream = connect_to_broker(port, "listener")?;
    stream.set_read_timeout(Some(Duration::from_millis(100)))?;
    stream.write_all(b"\x82\x06\x00\x01\x00\x01#\x00")?;
    let mut all = Vec::new();
    let began = Instant::now();
    let mut reader = BufReader::new(stream);
    while began.elapsed() < Duration::from_secs(10) {
        match reader.fill_buf() {
            Ok([]) => break,
            Ok(bytes) => {
                all.extend_from_slice(bytes);
                let count = bytes.len();
                reader.consume(count);
            }
            Err(_) => {}
        }
        // Topics and contents are text; what is around them does not matter here.
        let text = String::from_utf8_lossy(&all).into_owned();
        if done(&text) {
            return Ok(text);
        }
    }
    Err(format!("not all came: {}", String::from_utf8_lossy(&all)).into())
}

/// Values on change, after the broker was away too, and the last will.
pub fn values_reach_a_broker() -> Result<(), Failed> {
    let (mqtt, s7) = (free_port(), free_port());
    let first = broker(mqtt)?;
    let url = format!("mqtt://127.0.0.1:{mqtt}/plant/line");
    let modbus = free_port().to_string();
    let flags = ["--modbus", &modbus, "--s7", &s7.to_string(), "--mqtt", &url, "--publish", "MW10,DB1.DBW0,Values"];
    let mut plc = Plc::start(&flags)?;
    let has = |parts: &'static [&'static str]| move |text: &str| parts.iter().all(|part| text.contains(part));
    listen(
        mqtt,
        has(&[
            "plant/line/stateRUN",
            "value/MW10{\"value\": 0, \"type\": \"WORD\"",
            "value/Values.level{\"value\": 1.5",
        ]),
    )?;
    write_register(&modbus, 0x1234)?;
    listen(mqtt, has(&["value/DB1.DBW0{\"value\": 4660"]))?;
    drop(first);
    std::thread::sleep(Duration::from_millis(500));
    // While the broker is away.
    write_register(&modbus, 0x1235)?;
    let _second = broker(mqtt)?;
    listen(mqtt, has(&["value/DB1.DBW0{\"value\": 4661", "plant/line/stateRUN"]))?;
    plc.child.kill()?;
    listen(mqtt, has(&["plant/line/stateoffline"]))?;
    Ok(())
}

/// Writes the first holding register, as a Modbus client.
pub fn write_register(port: &str, value: u16) -> Result<(), Failed> {
    let mut stream = TcpStream::connect(format!("127.0.0.1:{port}"))?;
    stream.set_read_timeout(Some(Duration::from_secs(5)))?;
    let [high, low] = value.to_be_bytes();
    stream.write_all(&[0, 1, 0, 0, 0, 6, 1, 6, 0, 0, high, low])?;
    let mut answer = [0; 12];
    stream.read_exact(&mut answer)?;
    if answer[7] == 6 { Ok(()) } else { Err(format!("{answer:?}").into()) }
}
