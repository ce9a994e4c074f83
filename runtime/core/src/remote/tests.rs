//! Devices of their own: a server of Modbus TCP, and one at the other end of a pseudo-terminal.

use std::cell::RefCell;
use std::fs::File;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::os::fd::OwnedFd;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use plcc_abi::image::BlockKind;
use plcc_abi::layout;
use plcc_abi::remote::RemoteParity;

use std::rc::Rc;

use super::*;
use crate::clock::Clock;
use crate::cycle::{Course, Observer, Pace};
use crate::options::RunOptions;
use crate::tests::{Block, Closures, image};

const PATIENCE: Duration = Duration::from_secs(10);

/// What a device has.
#[derive(Default)]
struct Tables {
    coils: Vec<bool>,
    registers: Vec<u16>,
    /// Addresses from here on are refused.
    end: u16,
}

type Shared = Arc<Mutex<Tables>>;

fn tables() -> Shared {
    Arc::new(Mutex::new(Tables { coils: vec![false; 64], registers: vec![0; 64], end: 64 }))
}

/// Answers a request, written against the protocol alone.
fn served(tables: &Shared, request: &[u8]) -> Vec<u8> {
    let mut tables = tables.lock().unwrap();
    let word = |at: usize| u16::from_be_bytes([request[at], request[at + 1]]);
    let (function, first, count) = (request[0], usize::from(word(1)), usize::from(word(3)));
    if word(1) + word(3) > tables.end {
        return vec![function | 0x80, 2];
    }
    match function {
        1 | 2 => {
            let mut bytes = vec![0; count.div_ceil(8)];
            for (index, bit) in tables.coils[first..first + count].iter().enumerate() {
                bytes[index / 8] |= u8::from(*bit) << (index % 8);
            }
            [vec![function, bytes.len() as u8], bytes].concat()
        }
        3 | 4 => {
            let bytes: Vec<u8> =
                tables.registers[first..first + count].iter().flat_map(|word| word.to_be_bytes()).collect();
            [vec![function, bytes.len() as u8], bytes].concat()
        }
        15 => {
            for index in 0..count {
                tables.coils[first + index] = request[6 + index / 8] >> (index % 8) & 1 != 0;
            }
            request[..5].to_vec()
        }
        16 => {
            for index in 0..count {
                tables.registers[first + index] = word(6 + 2 * index);
            }
            request[..5].to_vec()
        }
        _ => vec![function | 0x80, 1],
    }
}

/// A server that can be switched off.
struct Server {
    address: String,
    on: Arc<AtomicBool>,
    end: Arc<AtomicBool>,
}

impl Server {
    fn new(tables: Shared) -> Server {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let (on, end) = (Arc::new(AtomicBool::new(true)), Arc::new(AtomicBool::new(false)));
        let (is_on, ended) = (on.clone(), end.clone());
        std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                if ended.load(Ordering::SeqCst) {
                    return;
                }
                serve(stream, &tables, &is_on);
            }
        });
        Server { address, on, end }
    }

    fn switch(&self, on: bool) {
        self.on.store(on, Ordering::SeqCst);
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.end.store(true, Ordering::SeqCst);
        // Wakes it.
        let _ = TcpStream::connect(&self.address);
    }
}

fn serve(mut stream: TcpStream, tables: &Shared, on: &AtomicBool) {
    loop {
        let mut head = [0; 7];
        if !on.load(Ordering::SeqCst) || stream.read_exact(&mut head).is_err() || !on.load(Ordering::SeqCst) {
            return;
        }
        let mut body = vec![0; usize::from(u16::from_be_bytes([head[4], head[5]])) - 1];
        stream.read_exact(&mut body).unwrap();
        let answer = served(tables, &body);
        let length = (answer.len() as u16 + 1).to_be_bytes();
        let frame = [&head[..4], &length, &head[6..7], &answer].concat();
        if stream.write_all(&frame).is_err() {
            return;
        }
    }
}

fn channel(table: RemoteTable, first: u16, count: u16, output: bool, byte: u32) -> RemoteChannel {
    RemoteChannel {
        table,
        first,
        count,
        output,
        byte,
        bit: 0,
        low_byte_first: false,
        low_word_first: false,
        scale: None,
        substitute: 0,
    }
}

/// I 4.0 to I 4.7 are coils 0 to 7, IW 10 is register 1; Q 4.0 to 4.3 are coils 16 to 19, QW 6 is register 2 with 99 in STOP.
fn station(line: RemoteLine) -> RemoteStation {
    RemoteStation {
        name: "tank".to_string(),
        line,
        unit: 17,
        poll_ms: 2,
        timeout_ms: 300,
        keep: false,
        channels: vec![
            RemoteChannel { substitute: 1, ..channel(RemoteTable::DiscreteInputs, 0, 8, false, 4) },
            RemoteChannel { substitute: 7, ..channel(RemoteTable::InputRegisters, 1, 1, false, 10) },
            channel(RemoteTable::Coils, 16, 4, true, 4),
            RemoteChannel { substitute: 99, ..channel(RemoteTable::HoldingRegisters, 2, 1, true, 6) },
        ],
    }
}

/// OB 1 copies IB 4 to QB 4 and IW 10 to QW 6. OB 86 and OB 82 count in MB 0 and MB 1, and keep 12 bytes of their start information from
/// MB 20 and MB 40 on. OB 122 counts in MB 2 when OB 1 reads PIW 10.
fn cpu(stations: &[RemoteStation]) -> Rc<Cpu> {
    let counting = |byte: u32, at: u32| -> Block {
        Box::new(move |cpu, lbase| {
            let memory = &cpu.memory;
            memory.set_byte(layout::M + byte, memory.byte(layout::M + byte) + 1);
            (0..12).for_each(|index| memory.set_byte(layout::M + at + index, memory.byte(lbase + index)));
        })
    };
    let program: Block = Box::new(|cpu, _| {
        let memory = &cpu.memory;
        memory.set_byte(layout::Q + 4, memory.byte(layout::I + 4));
        memory.set_word(layout::Q + 6, memory.word(layout::I + 10));
        memory.set_word(layout::M + 10, memory.word(layout::M + 10) + 1);
        let missing = cpu.peripheral_read(10, 2) >> 32 != 0;
        memory.set_byte(layout::M + 3, missing.into());
    });
    let blocks = vec![program, counting(0, 20), counting(1, 40)];
    let image = image(&[(BlockKind::Ob, 1), (BlockKind::Ob, 86), (BlockKind::Ob, 82)]);
    let driver = Remote::new(None, stations).unwrap();
    Cpu::new(image, Rc::new(Closures(blocks)), Clock::simulated(), Box::new(driver))
}

struct Nobody;

impl Observer for Nobody {
    fn before(&mut self, _: &Cpu, _: u64, _: u64) {}
    fn after(&mut self, _: &Cpu, _: u64, _: u64) {}
}

struct Running {
    cpu: Rc<Cpu>,
    course: Course,
    time: u64,
}

impl Running {
    fn new(stations: &[RemoteStation]) -> Running {
        let cpu = cpu(stations);
        let pace = Pace { cycles: None, cycle_time: 1_000_000, hang_limit: u64::MAX };
        let course = cpu.begin(&pace, &mut Nobody);
        Running { cpu, course, time: 0 }
    }

    /// Runs cycles until something holds.
    fn until(&mut self, what: &str, holds: impl Fn(&Cpu) -> bool) {
        let end = Instant::now() + PATIENCE;
        while !holds(&self.cpu) {
            assert!(Instant::now() < end, "not in time: {what}");
            self.time += 1_000_000;
            let before = Instant::now();
            self.cpu.run_until(&mut self.course, self.time, &mut Nobody);
            assert!(before.elapsed() < Duration::from_millis(200), "the cycle has waited for the network");
            std::thread::sleep(Duration::from_micros(200));
        }
    }

    fn byte(&self, at: u32) -> u8 {
        self.cpu.memory.byte(layout::M + at)
    }

    fn info(&self, at: u32) -> Vec<u8> {
        (at..at + 12).map(|byte| self.byte(byte)).collect()
    }
}

/// What a device with these tables does, whatever the way to it is.
fn inputs_and_outputs(tables: &Shared, line: RemoteLine) {
    {
        let mut state = tables.lock().unwrap();
        (state.coils[0], state.coils[2], state.registers[1]) = (true, true, 0xABCD);
    }
    let mut running = Running::new(&[station(line)]);
    running.until("the inputs", |cpu| cpu.memory.byte(layout::I + 4) == 5 && cpu.memory.word(layout::I + 10) == 0xABCD);
    let end = Instant::now() + PATIENCE;
    let arrived = |tables: &Shared| {
        let state = tables.lock().unwrap();
        state.coils[16..20] == [true, false, true, false] && state.registers[2] == 0xABCD
    };
    while !arrived(tables) && Instant::now() < end {
        running.until("a cycle", |_| true);
        running.time += 1_000_000;
        running.cpu.run_until(&mut running.course, running.time, &mut Nobody);
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(arrived(tables), "the outputs");
    assert_eq!((running.byte(0), running.byte(1), running.byte(3)), (0, 0, 0), "no fault");
    // The process ends: outputs have their substitutes.
    drop(running);
    let state = tables.lock().unwrap();
    assert_eq!((&state.coils[16..20], state.registers[2]), (&[false; 4][..], 99));
}

#[test]
fn inputs_come_and_outputs_go_over_tcp() {
    let tables = tables();
    let server = Server::new(tables.clone());
    inputs_and_outputs(&tables, RemoteLine::Tcp(server.address.clone()));
}

#[test]
fn inputs_come_and_outputs_go_over_a_serial_line() {
    let (path, _slave, tables) = line();
    inputs_and_outputs(&tables, RemoteLine::Serial { path, baud: 115_200, parity: RemoteParity::None });
}

/// A pseudo-terminal with a device at its other end: its path, its end that is held open, and the device.
fn line() -> (String, File, Shared) {
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&master).unwrap();
    unlockpt(&master).unwrap();
    let path = ptsname(&master, Vec::new()).unwrap().into_string().unwrap();
    // Held open, so that the master can be read before and after the CPU.
    let slave = File::options().read(true).write(true).open(&path).unwrap();
    let tables = tables();
    let device = tables.clone();
    std::thread::spawn(move || serve_serial(master, &device));
    (path, slave, tables)
}

#[test]
fn two_devices_on_a_line_take_turns() {
    let (path, _slave, tables) = line();
    tables.lock().unwrap().registers[1] = 77;
    let line = RemoteLine::Serial { path, baud: 115_200, parity: RemoteParity::None };
    let one = station(line.clone());
    let other = RemoteStation {
        name: "other".to_string(),
        unit: 18,
        channels: vec![channel(RemoteTable::HoldingRegisters, 1, 1, false, 50)],
        ..station(line)
    };
    let mut running = Running::new(&[one, other]);
    running
        .until("inputs of both", |cpu| cpu.memory.word(layout::I + 10) == 77 && cpu.memory.word(layout::I + 50) == 77);
    let end = Instant::now() + Duration::from_secs(1);
    running.until("a second", |_| Instant::now() > end);
    assert_eq!(running.byte(0), 0, "no answer was lost");
}

/// A device at the end of a line. It gets noise before the first request, and answers in pieces.
fn serve_serial(master: OwnedFd, tables: &Shared) {
    let mut master = File::from(master);
    let (mut frame, mut buffer) = (Vec::new(), [0; 256]);
    while let Ok(count) = master.read(&mut buffer) {
        frame.extend_from_slice(&buffer[..count]);
        let length = match frame.get(1) {
            Some(1..=4) => 8,
            Some(15 | 16) => frame.get(6).map_or(usize::MAX, |bytes| 9 + usize::from(*bytes)),
            _ => usize::MAX,
        };
        if frame.len() < length {
            continue;
        }
        let (body, sum) = frame.split_at(length - 2);
        assert_eq!(frame::checksum(body).to_le_bytes(), sum);
        assert!(matches!(body[0], 17 | 18));
        let mut answer = vec![body[0]];
        answer.extend(served(tables, &body[1..]));
        answer.extend(frame::checksum(&answer).to_le_bytes());
        frame.clear();
        for piece in answer.chunks(3) {
            if master.write_all(piece).is_err() {
                return;
            }
        }
    }
}

#[test]
fn a_device_that_is_away_comes_back() {
    let tables = tables();
    tables.lock().unwrap().registers[1] = 5;
    let server = Server::new(tables.clone());
    let mut running = Running::new(&[station(RemoteLine::Tcp(server.address.clone()))]);
    running.until("the inputs", |cpu| cpu.memory.word(layout::I + 10) == 5);
    server.switch(false);
    running.until("OB 86", |cpu| cpu.memory.byte(layout::M) == 1);
    // Coming, DP station, of station 1 with inputs from 4 on.
    assert_eq!(running.info(20), [0x39, 0xC4, 26, 86, 0, 0x54, 0, 4, 0x80, 0x04, 0x01, 0x01]);
    running.until("substitutes", |cpu| cpu.memory.byte(layout::I + 4) == 0xFF && cpu.memory.word(layout::I + 10) == 7);
    running.until("access errors", |cpu| cpu.memory.byte(layout::M + 3) == 1);
    assert!(running.cpu.peripheral_write(6, 2, 1), "no module answers for outputs");
    assert!(running.cpu.peripheral_read(100, 2) >> 32 == 0, "other addresses answer");
    tables.lock().unwrap().registers[1] = 6;
    server.switch(true);
    running.until("OB 86 again", |cpu| cpu.memory.byte(layout::M) == 2);
    assert_eq!(running.info(20)[..4], [0x38, 0xC4, 26, 86]);
    running
        .until("the inputs again", |cpu| cpu.memory.word(layout::I + 10) == 6 && cpu.memory.byte(layout::M + 3) == 0);
    assert_eq!(running.byte(1), 0, "no OB 82");
    assert!(!running.cpu.is_stopped());
}

#[test]
fn a_request_that_is_refused_is_a_module_fault() {
    let tables = tables();
    let server = Server::new(tables.clone());
    let mut running = Running::new(&[station(RemoteLine::Tcp(server.address.clone()))]);
    tables.lock().unwrap().end = 1;
    running.until("OB 82", |cpu| cpu.memory.byte(layout::M + 1) == 4);
    // The last of the channels: outputs from 6 on.
    assert_eq!(running.info(40), [0x39, 0x42, 26, 82, 0, 0x55, 0, 6, 5, 0, 0, 0]);
    running.until("access errors", |cpu| cpu.memory.byte(layout::M + 3) == 1);
    tables.lock().unwrap().end = 64;
    running.until("OB 82 again", |cpu| cpu.memory.byte(layout::M + 1) == 8);
    assert_eq!(running.info(40)[..2], [0x38, 0x42]);
    assert_eq!(running.byte(0), 0, "no OB 86");
}

#[test]
fn a_row_that_is_refused_is_named() {
    let tables = tables();
    let server = Server::new(tables.clone());
    let remote = Remote::new(None, &[station(RemoteLine::Tcp(server.address.clone()))]).unwrap();
    let mut texts = Vec::<String>::new();
    let mut said = |count: usize| {
        let end = Instant::now() + PATIENCE;
        while texts.len() < count {
            assert!(Instant::now() < end, "not in time: {texts:?}");
            remote.exchange(&mut |change| texts.push(change.text));
            std::thread::sleep(Duration::from_millis(1));
        }
        std::mem::take(&mut texts)
    };
    let has = |texts: &[String], text: &str| assert!(texts.iter().any(|found| found == text), "{texts:?}");
    tables.lock().unwrap().end = 1;
    let refused = said(4);
    let why = "exception 2, it does not have all of these elements";
    has(&refused, &format!("io tank: the device refuses `discrete = 0` (inputs from byte 4): {why}"));
    has(&refused, &format!("io tank: the device refuses `holding = 2` (outputs from byte 6): {why}"));
    tables.lock().unwrap().end = 64;
    has(&said(4), "io tank: the device accepts `input = 1` (inputs from byte 10) again");
}

#[test]
fn a_device_that_was_never_there_is_no_event() {
    // Nobody listens there.
    let address = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string();
    let mut running = Running::new(&[station(RemoteLine::Tcp(address))]);
    running.until("cycles", |cpu| cpu.memory.word(layout::M + 10) > 50);
    assert_eq!((running.byte(0), running.byte(3)), (0, 1), "access errors, but no OB 86");
    assert_eq!(running.cpu.memory.byte(layout::I + 4), 0xFF, "substitutes");
}

#[test]
fn a_device_that_never_answers_does_not_hold_the_end() {
    // Connections are accepted by the system, and nobody reads.
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let line = RemoteLine::Tcp(listener.local_addr().unwrap().to_string());
    let slow = RemoteStation { timeout_ms: 60_000, ..station(line) };
    let remote = Remote::new(None, &[slow.clone(), RemoteStation { name: "other".to_string(), ..slow }]).unwrap();
    let before = Instant::now();
    drop(remote);
    assert!(before.elapsed() < PATIENCE, "{:?}", before.elapsed());
}

#[test]
fn a_device_that_sends_anything_harms_nothing() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    std::thread::spawn(move || {
        let mut seed = 7u64;
        for mut stream in listener.incoming().flatten() {
            let mut head = [0; 12];
            while stream.read_exact(&mut head).is_ok() {
                let mut noise = [0; 40];
                for byte in &mut noise {
                    seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    *byte = (seed >> 56) as u8;
                }
                // Sometimes a plausible beginning.
                if noise[39] & 1 == 0 {
                    let begin = [head[0], head[1], 0, 0, 0, noise[5] & 0x1F, head[6], head[7]];
                    noise[..8].copy_from_slice(&begin);
                }
                if stream.write_all(&noise).is_err() {
                    break;
                }
            }
        }
    });
    let mut running = Running::new(&[RemoteStation { timeout_ms: 20, ..station(RemoteLine::Tcp(address)) }]);
    let end = Instant::now() + Duration::from_secs(2);
    while Instant::now() < end {
        let count = running.cpu.memory.word(layout::M + 10);
        running.until("a cycle", |cpu| cpu.memory.word(layout::M + 10) != count);
    }
    assert!(!running.cpu.is_stopped());
}

/// Inputs, a device that goes away and one that comes back are in the recording: the run is the same without the device.
#[test]
fn a_recorded_run_can_be_repeated_without_its_devices() {
    let path = std::env::temp_dir().join(format!("plcc-tape-io-{}.rec", std::process::id()));
    let tables = tables();
    let server = Server::new(tables.clone());
    let station = station(RemoteLine::Tcp(server.address.clone()));
    // OB 1 tells what it sees: IB 4, whether PIW 10 and PQW 6 cannot be reached, and how often OB 86 has run.
    let run = |options: RunOptions, plant: Rc<dyn Fn(usize, u8)>| {
        let seen = Rc::<RefCell<Vec<[u8; 4]>>>::default();
        let own = Rc::clone(&seen);
        let program: Block = Box::new(move |cpu, _| {
            let missing = cpu.peripheral_read(10, 2) >> 32 != 0;
            let refused = cpu.peripheral_write(6, 2, 1);
            let faults = cpu.memory.byte(layout::M);
            own.borrow_mut().push([cpu.memory.byte(layout::I + 4), missing.into(), refused.into(), faults]);
            plant(own.borrow().len(), faults);
        });
        let fault: Block = Box::new(|cpu, _| cpu.memory.set_byte(layout::M, cpu.memory.byte(layout::M) + 1));
        let mut image = image(&[(BlockKind::Ob, 1), (BlockKind::Ob, 86)]);
        image.config.remote = vec![station.clone()];
        let code = Rc::new(Closures(vec![program, fault]));
        assert_eq!(crate::run(image, code, &RunOptions { quiet: true, ..options }), 0);
        seen.take()
    };
    let (device, is_on) = (tables.clone(), server.on.clone());
    let plant = move |cycle: usize, faults: u8| {
        device.lock().unwrap().coils[0] = cycle % 20 < 10;
        is_on.store(!(cycle > 100 && faults == 0), Ordering::SeqCst);
    };
    let options = RunOptions {
        cycles: Some(1500),
        cycle_time: Some(crate::options::Duration(2_000_000)),
        record: Some(path.clone()),
        ..RunOptions::default()
    };
    let recorded = run(options, Rc::new(plant));
    let has = |wanted: &dyn Fn(&[u8; 4]) -> bool| recorded.iter().any(wanted);
    assert!(has(&|seen| *seen == [1, 0, 0, 0]) && has(&|seen| *seen == [0, 0, 0, 0]), "inputs change");
    assert!(has(&|seen| *seen == [0xFF, 1, 1, 1]), "the device is away");
    assert_eq!(recorded.last().map(|seen| &seen[1..]), Some(&[0, 0, 2][..]), "it has come back");
    server.switch(false);
    let repeated = run(RunOptions { replay: Some(path.clone()), ..RunOptions::default() }, Rc::new(|_, _| {}));
    std::fs::remove_file(path).unwrap();
    assert!(recorded == repeated);
}
