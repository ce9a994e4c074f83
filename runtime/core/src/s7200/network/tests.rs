//! Stations in one process.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::rc::Rc;
use std::time::{Duration, Instant};

use plcc_abi::layout;
use plcc_abi::s7200::{S7200Config, result};

use super::*;
use crate::s7200::freeport::tests::{V, V_BYTES, cpu, operands, set_sm};

const MS: u64 = 1_000_000;
const PPI_MASTER: u8 = 2;
/// The table is at VB200.
const TABLE: u32 = V + 200;

fn free_address() -> String {
    TcpListener::bind("127.0.0.1:0").and_then(|free| free.local_addr()).unwrap().to_string()
}

/// A master with station 3 at `address`.
fn master(address: Option<&str>) -> Rc<Cpu> {
    let stations = address.iter().map(|address| (3, address.to_string())).collect();
    let cpu = cpu(S7200Config { stations, ..S7200Config::default() });
    set_sm(&cpu, 30, PPI_MASTER);
    cpu
}

fn slave(address: &str, station: u8) -> Rc<Cpu> {
    cpu(S7200Config { station: Some(station), listen: Some(address.to_string()), ..S7200Config::default() })
}

fn fill(cpu: &Cpu, table: u32, station: u8, pointer: u32, length: u8) {
    cpu.memory.set_byte(table, 0);
    cpu.memory.set_byte(table + STATION, station);
    cpu.memory.set_dword(table + POINTER, pointer);
    cpu.memory.set_byte(table + LENGTH, length);
}

fn status(cpu: &Cpu) -> u8 {
    cpu.memory.byte(TABLE)
}

fn data(cpu: &Cpu, address: u32, count: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    cpu.memory.view(address, count, |view| bytes.extend_from_slice(view));
    bytes
}

/// A scan of 10 ms.
fn scan(cpu: &Cpu) {
    cpu.clock.move_to(cpu.clock.now() + 10 * MS);
    cpu.s7200_poll_network();
}

/// Scans of both until the request has ended; its status.
fn finish(master: &Cpu, slave: Option<&Cpu>) -> u8 {
    let end = Instant::now() + Duration::from_secs(20);
    while status(master) & ACTIVE != 0 {
        assert!(Instant::now() < end, "no end");
        scan(master);
        slave.into_iter().for_each(scan);
        std::thread::sleep(Duration::from_millis(1));
    }
    status(master)
}

#[test]
fn master_reads_and_writes_a_station() {
    let address = free_address();
    let (master, slave) = (master(Some(&address)), slave(&address, 3));
    slave.memory.load(V + 100, &[0x12, 0x34]);
    fill(&master, TABLE, 3, 0x0800_0064, 2);
    assert_eq!(read(&master, &operands(TABLE, 0)), result::ENO);
    assert_eq!(status(&master), ACTIVE);
    assert_eq!(finish(&master, Some(&slave)), DONE);
    assert_eq!(data(&master, TABLE + DATA, 3), [0x12, 0x34, 0]);
    // 16 bytes to VB100.
    fill(&master, TABLE, 3, 0x0800_0064, 16);
    let bytes: Vec<u8> = (1..=16).collect();
    master.memory.load(TABLE + DATA, &bytes);
    assert_eq!(write(&master, &operands(TABLE, 0)), result::ENO);
    // The content of the table at the time of the statement is sent.
    master.memory.set_byte(TABLE + DATA, 99);
    assert_eq!(finish(&master, Some(&slave)), DONE);
    assert_eq!(data(&slave, V + 100, 17), [&bytes[..], &[0]].concat());
}

/// The program of the station need not use the outputs itself.
#[test]
fn outputs_that_a_master_writes_reach_the_modules() {
    let address = free_address();
    let (master, slave) = (master(Some(&address)), slave(&address, 3));
    // The first scan has copied all outputs.
    slave.outputs_changed.set(0);
    fill(&master, TABLE, 3, 0x0200_0001, 1);
    master.memory.set_byte(TABLE + DATA, 0x5A);
    write(&master, &operands(TABLE, 0));
    assert_eq!(finish(&master, Some(&slave)), DONE);
    assert_eq!(slave.memory.byte(layout::Q + 1), 0x5A);
    assert_eq!(slave.outputs_changed.get(), u32::MAX);
    slave.write_outputs();
    assert_eq!(slave.driver.output(1, 1), 0x5A);
}

#[test]
fn areas_of_the_station() {
    let address = free_address();
    let (master, slave) = (master(Some(&address)), slave(&address, 3));
    for (area, at) in [(0x01, layout::I), (0x02, layout::Q), (0x03, layout::M), (0x08, V)] {
        slave.memory.set_byte(at + 5, area + 0x40);
        fill(&master, TABLE, 3, u32::from(area) << 24 | 5, 1);
        read(&master, &operands(TABLE, 0));
        assert_eq!(finish(&master, Some(&slave)), DONE);
        assert_eq!(master.memory.byte(TABLE + DATA), area + 0x40);
    }
    // The last byte of V is there, the next one is not.
    for (offset, length, wanted) in [
        (V_BYTES - 16, 16, DONE),
        (V_BYTES - 15, 16, DONE | FAILED | code::MESSAGE),
        (V_BYTES, 1, DONE | FAILED | code::MESSAGE),
        (0x00FF_FFFF, 16, DONE | FAILED | code::MESSAGE),
    ] {
        for begin in [read, write] {
            fill(&master, TABLE, 3, 0x0800_0000 | offset, length);
            begin(&master, &operands(TABLE, 0));
            assert_eq!(finish(&master, Some(&slave)), wanted, "{offset}");
        }
    }
}

#[test]
fn eight_requests_at_a_time() {
    let address = free_address();
    let (master, slave) = (master(Some(&address)), slave(&address, 3));
    slave.memory.load(V, &[10, 11, 12, 13, 14, 15, 16, 17, 18]);
    let table = |index: u32| V + 300 + 30 * index;
    for index in 0..9 {
        fill(&master, table(index), 3, 0x0800_0000 | index, 1);
        let ran = read(&master, &operands(table(index), 0));
        assert_eq!(ran, if index < 8 { result::ENO } else { 0 });
    }
    assert_eq!(master.memory.byte(table(8)), DONE | FAILED | code::QUEUE);
    for _ in 0..3000 {
        scan(&master);
        scan(&slave);
        std::thread::sleep(Duration::from_millis(1));
        if (0..8).all(|index| master.memory.byte(table(index)) == DONE) {
            break;
        }
    }
    let values: Vec<u8> = (0..8).map(|index| master.memory.byte(table(index) + DATA)).collect();
    assert_eq!(values, [10, 11, 12, 13, 14, 15, 16, 17]);
}

#[test]
fn nobody_answers() {
    // Without a link, by the clock of the CPU alone.
    let master = master(None);
    fill(&master, TABLE, 3, 0x0800_0064, 2);
    assert_eq!(read(&master, &operands(TABLE, 0)), result::ENO);
    for _ in 0..99 {
        scan(&master);
    }
    assert_eq!(status(&master), ACTIVE);
    // An active table is left alone, whatever it holds.
    master.memory.set_byte(TABLE + LENGTH, 99);
    assert_eq!((read(&master, &operands(TABLE, 0)), status(&master)), (result::ENO, ACTIVE));
    scan(&master);
    assert_eq!(status(&master), DONE | FAILED | code::TIME_OUT);
}

#[test]
fn another_station_does_not_answer() {
    let address = free_address();
    let (master, slave) = (master(Some(&address)), slave(&address, 4));
    fill(&master, TABLE, 3, 0x0800_0064, 2);
    let begun = Instant::now();
    read(&master, &operands(TABLE, 0));
    assert_eq!(finish(&master, Some(&slave)), DONE | FAILED | code::TIME_OUT);
    assert!(begun.elapsed() >= Duration::from_secs(1), "the station has its second");
    // The program sets its address.
    assert_eq!(set_address(&slave, &operands(3, 0)), result::ENO);
    fill(&master, TABLE, 3, 0x0800_0064, 2);
    read(&master, &operands(TABLE, 0));
    assert_eq!(finish(&master, Some(&slave)), DONE);
    // In Freeport mode the port is not on the link; port 1 still has its own address.
    set_sm(&slave, 30, 9);
    fill(&master, TABLE, 3, 0x0800_0064, 2);
    read(&master, &operands(TABLE, 0));
    assert_eq!(finish(&master, Some(&slave)), DONE | FAILED | code::TIME_OUT);
}

#[test]
fn wrong_tables() {
    let address = free_address();
    let cpu = master(Some(&address));
    for (station, pointer, length) in [
        (3, 0x0800_0064, 0),
        (3, 0x0800_0064, 17),
        (127, 0x0800_0064, 2),
        (3, 0x0400_0000, 2),
        (3, 0x0000_0000, 2),
        (3, 0xFF00_0000, 2),
    ] {
        fill(&cpu, TABLE, station, pointer, length);
        assert_eq!(read(&cpu, &operands(TABLE, 0)), 0);
        assert_eq!(status(&cpu), DONE | FAILED | code::PARAMETER, "{station} {pointer:08X} {length}");
    }
    // Port 1 is not a master.
    fill(&cpu, TABLE, 3, 0x0800_0064, 2);
    assert_eq!((write(&cpu, &operands(TABLE, 1)), status(&cpu)), (0, DONE | FAILED | code::NO_MASTER));
    assert_eq!(read(&cpu, &operands(TABLE, 2)), 0, "no such port");
    // Beyond VB999.
    let end = V + V_BYTES;
    assert_eq!(read(&cpu, &operands(end - 6, 0)), 0);
    fill(&cpu, end - 8, 3, 0x0800_0064, 1);
    assert_eq!(read(&cpu, &operands(end - 8, 0)), result::ENO);
}

#[test]
fn nonsense_does_no_harm() {
    let address = free_address();
    let slave = slave(&address, 3);
    for bytes in [&b"GET / HTTP/1.0\r\n\r\n"[..], &[0x68, 255, 255, 0x68], &[0x68, 4, 4, 0x68, 3, 2, 9, 0, 14, 0x16]] {
        let mut stranger = TcpStream::connect(&address).unwrap();
        stranger.write_all(bytes).unwrap();
        stranger.set_read_timeout(Some(Duration::from_millis(20))).unwrap();
        let gone = (0..300).any(|_| {
            scan(&slave);
            matches!(stranger.read(&mut [0]), Ok(0)) || stranger.write_all(&[]).is_err()
        });
        assert!(gone, "{bytes:?}");
    }
    // Half a frame blocks nothing.
    let mut half = TcpStream::connect(&address).unwrap();
    half.write_all(&[0x68, 9]).unwrap();
    let master = master(Some(&address));
    fill(&master, TABLE, 3, 0x0800_0064, 2);
    read(&master, &operands(TABLE, 0));
    assert_eq!(finish(&master, Some(&slave)), DONE);
}

/// A partner that answers a request with the result of `answer`.
fn answered_by(answer: impl FnOnce(Frame) -> Vec<u8> + Send + 'static) -> (Rc<Cpu>, u8) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let master = master(Some(&listener.local_addr().unwrap().to_string()));
    let partner = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut input = Vec::new();
        let frame = loop {
            let mut byte = [0];
            stream.read_exact(&mut byte).unwrap();
            input.push(byte[0]);
            if let Some(frame) = Frame::take(&mut input).unwrap() {
                break frame;
            }
        };
        stream.write_all(&answer(frame)).unwrap();
        stream
    });
    fill(&master, TABLE, 3, 0x0800_0064, 2);
    read(&master, &operands(TABLE, 0));
    let status = finish(&master, None);
    drop(partner.join().unwrap());
    (master, status)
}

fn reply(frame: &Frame, code: u8, data: &[u8]) -> Vec<u8> {
    let body = Body::Answer { code, data: data.to_vec() };
    Frame { to: frame.from, from: frame.to, tag: frame.tag, body }.encode()
}

#[test]
fn answers_are_checked() {
    let wrong = |code: u8| DONE | FAILED | code;
    assert_eq!(answered_by(|frame| reply(&frame, 0, &[1, 2])).1, DONE);
    assert_eq!(answered_by(|frame| reply(&frame, 7, &[])).1, wrong(7));
    assert_eq!(answered_by(|frame| reply(&frame, 0, &[1, 2, 3])).1, wrong(code::RECEIVE), "too many bytes");
    assert_eq!(answered_by(|_| b"HTTP/1.0 400".to_vec()).1, wrong(code::RECEIVE));
    let spoilt = |frame: Frame| {
        let mut bytes = reply(&frame, 0, &[1, 2]);
        bytes[9] ^= 1;
        bytes
    };
    let (master, status) = answered_by(spoilt);
    assert_eq!((status, data(&master, TABLE + DATA, 2)), (wrong(code::RECEIVE), vec![0, 0]), "checksum");
    // An answer to nothing is passed over.
    let late = |frame: Frame| {
        let old = Frame { tag: frame.tag.wrapping_add(100), ..frame.clone() };
        [reply(&old, 9, &[]), reply(&frame, 0, &[5, 6])].concat()
    };
    let (master, status) = answered_by(late);
    assert_eq!((status, data(&master, TABLE + DATA, 2)), (DONE, vec![5, 6]));
}

#[test]
fn a_station_that_comes_back() {
    let address = free_address();
    let master = master(Some(&address));
    for value in [1, 2] {
        // The request is there before the station.
        fill(&master, TABLE, 3, 0x0800_0064, 1);
        read(&master, &operands(TABLE, 0));
        for _ in 0..20 {
            scan(&master);
        }
        assert_eq!(status(&master), ACTIVE);
        let slave = slave(&address, 3);
        slave.memory.set_byte(V + 100, value);
        assert_eq!(finish(&master, Some(&slave)), DONE);
        assert_eq!(master.memory.byte(TABLE + DATA), value);
    }
}

#[test]
fn station_addresses() {
    let cpu = slave(&free_address(), 17);
    let gives = |station: u32| u64::from(station) << 32 | result::ENO | result::VALUE;
    assert_eq!(get_address(&cpu, &operands(0, 0)), gives(17));
    assert_eq!(set_address(&cpu, &operands(126, 1)), result::ENO);
    assert_eq!((get_address(&cpu, &operands(1, 0)), get_address(&cpu, &operands(0, 0))), (gives(126), gives(17)));
    assert_eq!(set_address(&cpu, &operands(127, 0)), 0, "0091");
    assert_eq!(set_address(&cpu, &operands(256, 0)), 0);
    assert_eq!((get_address(&cpu, &operands(2, 0)), set_address(&cpu, &operands(3, 2))), (0, 0), "no such port");
    assert_eq!(get_address(&super::super::freeport::tests::cpu(S7200Config::default()), &operands(0, 0)), gives(2));
}

/// Otherwise cycles in which only the program takes part would leave communication out.
#[test]
fn a_waiting_request_gets_host_time() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let master = master(Some(&listener.local_addr().unwrap().to_string()));
    master.s7200_poll_network();
    assert!(!master.has_jobs.get());
    fill(&master, TABLE, 3, 0x0800_0064, 2);
    assert_eq!(read(&master, &operands(TABLE, 0)), result::ENO);
    master.s7200_poll_network();
    assert!(master.has_jobs.get());
    assert!(master.communication.borrow_mut().take_waiting());
}
