//! Ports of a CPU with partners that are files and sockets.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::net::TcpListener;
use std::rc::Rc;
use std::time::Duration;

use plcc_abi::layout;
use plcc_abi::s7200::image::{Link, Port};
use plcc_abi::s7200::{S7200Config, S7200Image, V_DB, result};

use super::*;
use crate::clock::Clock;
use crate::code::Code;
use crate::io::Simulated;

struct NoCode;

impl Code for NoCode {
    fn call(&self, _entry: u32, _mem: *mut u8, _lbase: u32, _vbase: u32) {}
}

pub const V: u32 = layout::DB_DATA;
pub const V_BYTES: u32 = 1000;

/// A CPU with two ports, VB0 to VB999, and the virtual clock; RUN has begun.
pub fn cpu(config: S7200Config) -> Rc<Cpu> {
    cpu_with(config, Clock::simulated())
}

fn cpu_with(config: S7200Config, clock: Clock) -> Rc<Cpu> {
    let mut image = crate::tests::image(&[]);
    let mut own = S7200Image::default();
    own.cpu.ports = 2;
    own.cpu.sm_bytes = 550;
    image.s7200 = Some(own);
    image.config.s7200 = config;
    let cpu = Cpu::new(image, Rc::new(NoCode), clock, Box::new(Simulated::new(None)));
    cpu.memory.set_db(V_DB, V, V_BYTES);
    cpu.s7200_start_ports();
    cpu.s7200_start_network();
    cpu
}

pub fn operands(a: u32, b: u32) -> Operands {
    Operands { a, b, ..Operands::default() }
}

pub fn set_sm(cpu: &Cpu, byte: u32, value: u8) {
    cpu.memory.set_byte(special(byte), value);
    if byte == 30 || byte == 130 {
        cpu.s7200_port_control_written(u8::from(byte == 130));
    }
}

fn sm(cpu: &Cpu, byte: u32) -> u8 {
    cpu.memory.byte(special(byte))
}

/// Moves the virtual clock on, with everything that is due on the way.
fn pass(cpu: &Cpu, ns: u64) {
    let end = cpu.clock.now() + ns;
    while cpu.s7200_ports_due() <= end {
        cpu.clock.move_to(cpu.s7200_ports_due());
        cpu.s7200_poll_ports();
    }
    cpu.clock.move_to(end);
}

fn raised(cpu: &Cpu) -> Vec<(u8, EventData)> {
    std::mem::take(&mut *cpu.s7200().unwrap().freeport.raised.borrow_mut())
}

fn table(cpu: &Cpu, at: u32, bytes: u32) -> Vec<u8> {
    let mut table = Vec::new();
    cpu.memory.view(V + at, bytes, |view| table.extend_from_slice(view));
    table
}

/// 9600 baud, 8 data bits, no parity, Freeport: 10 bits take 1.041666 ms.
const FREEPORT: u8 = 0x09;
const CHARACTER: u64 = 1_041_666;
const MS: u64 = 1_000_000;

pub fn freeport_cpu() -> Rc<Cpu> {
    let cpu = cpu(S7200Config::default());
    set_sm(&cpu, 30, FREEPORT);
    cpu
}

/// SMB87 to SMB94: start `:`, end CR, 5 ms idle, 20 ms timer, 10 characters.
fn prepare(cpu: &Cpu, control: u8) {
    cpu.memory.load(special(87), &[control, b':', b'\r', 0, 5, 0, 20, 10]);
}

#[test]
fn characters_raise_events() {
    let cpu = freeport_cpu();
    cpu.s7200_feed(0, b"AB", false);
    pass(&cpu, CHARACTER - 1);
    assert_eq!(raised(&cpu), []);
    pass(&cpu, 1);
    assert_eq!((raised(&cpu), sm(&cpu, 2), sm(&cpu, 3)), (vec![(8, Some((b'A', false)))], b'A', 0));
    pass(&cpu, CHARACTER);
    assert_eq!((raised(&cpu), sm(&cpu, 2)), (vec![(8, Some((b'B', false)))], b'B'));
    cpu.s7200_feed(0, b"C", true);
    pass(&cpu, 2 * MS);
    assert_eq!((raised(&cpu), sm(&cpu, 3)), (vec![(8, Some((b'C', true)))], 1));
    // Port 1 has its own event; seven data bits drop the eighth.
    set_sm(&cpu, 130, FREEPORT | 0x20);
    cpu.s7200_feed(1, &[0xC1], false);
    pass(&cpu, 2 * MS);
    assert_eq!(raised(&cpu), [(25, Some((0x41, false)))]);
}

#[test]
fn other_modes_have_no_characters() {
    let cpu = cpu(S7200Config::default());
    cpu.s7200_feed(0, b"A", false);
    pass(&cpu, 10 * MS);
    assert_eq!((raised(&cpu), cpu.s7200_ports_due()), (vec![], NEVER));
    assert_eq!((transmit(&cpu, &operands(V, 0)), receive(&cpu, &operands(V, 0))), (0, 0));
    assert_eq!(transmit(&cpu, &operands(V, 2)), 0, "no such port");
}

#[test]
fn transmit_takes_its_time() {
    let cpu = freeport_cpu();
    assert_eq!(sm(&cpu, 4), 0x60, "both transmitters are idle");
    cpu.memory.load(V, b"\x03abc");
    assert_eq!(transmit(&cpu, &operands(V, 0)), result::ENO);
    assert_eq!(sm(&cpu, 4), 0x40);
    assert_eq!(transmit(&cpu, &operands(V, 0)), 0, "0009");
    pass(&cpu, 3 * CHARACTER - 1);
    // SM4.3 shows the error.
    assert_eq!((raised(&cpu), sm(&cpu, 4)), (vec![], 0x48));
    pass(&cpu, 1);
    assert_eq!((raised(&cpu), sm(&cpu, 4)), (vec![(9, None)], 0x68));
    assert_eq!((cpu.s7200_take_sent(0), cpu.s7200_take_sent(0)), (b"abc".to_vec(), vec![]));
    assert_eq!(transmit(&cpu, &operands(V, 0)), result::ENO);
}

#[test]
fn transmit_of_nothing_is_a_break() {
    let cpu = freeport_cpu();
    set_sm(&cpu, 130, FREEPORT);
    assert_eq!(transmit(&cpu, &operands(V, 1)), result::ENO);
    assert_eq!(sm(&cpu, 4), 0x20);
    pass(&cpu, 1_666_665);
    assert_eq!(raised(&cpu), []);
    pass(&cpu, 1);
    assert_eq!((raised(&cpu), sm(&cpu, 4), cpu.s7200_take_sent(1)), (vec![(26, None)], 0x60, vec![]));
}

#[test]
fn tables_must_fit() {
    let cpu = freeport_cpu();
    cpu.memory.set_byte(V + V_BYTES - 3, 3);
    assert_eq!(transmit(&cpu, &operands(V + V_BYTES - 3, 0)), 0);
    cpu.memory.set_byte(V + V_BYTES - 3, 2);
    assert_eq!(transmit(&cpu, &operands(V + V_BYTES - 3, 0)), result::ENO);
    pass(&cpu, 10 * MS);
    prepare(&cpu, 0xC0);
    assert_eq!(receive(&cpu, &operands(V + V_BYTES - 10, 0)), 0);
    assert_eq!(receive(&cpu, &operands(V + V_BYTES - 11, 0)), result::ENO);
}

#[test]
fn message_from_start_to_end_character() {
    let cpu = freeport_cpu();
    set_sm(&cpu, 86, 0xFF);
    prepare(&cpu, 0xE0);
    cpu.memory.set_byte(V + 100, 77);
    assert_eq!(receive(&cpu, &operands(V + 100, 0)), result::ENO);
    assert_eq!((sm(&cpu, 86), table(&cpu, 100, 1)), (0, vec![0]));
    cpu.s7200_feed(0, b"x:12\ry", false);
    pass(&cpu, 4 * CHARACTER);
    assert_eq!((raised(&cpu), sm(&cpu, 86), table(&cpu, 100, 4)), (vec![], 0, b"\x03:12".to_vec()));
    pass(&cpu, CHARACTER);
    assert_eq!((raised(&cpu), sm(&cpu, 86)), (vec![(23, None)], status::END_CHARACTER));
    assert_eq!(table(&cpu, 100, 6), b"\x04:12\r\0");
    // After the message characters raise events again.
    pass(&cpu, CHARACTER);
    assert_eq!(raised(&cpu), [(8, Some((b'y', false)))]);
}

#[test]
fn message_ends_by_time_and_by_parity() {
    let cpu = freeport_cpu();
    prepare(&cpu, 0xC4);
    receive(&cpu, &operands(V, 0));
    cpu.s7200_feed(0, b":1", false);
    pass(&cpu, 2 * CHARACTER + 20 * MS - 1);
    assert_eq!(raised(&cpu), []);
    pass(&cpu, 1);
    assert_eq!((raised(&cpu), sm(&cpu, 86), table(&cpu, 0, 3)), (vec![(23, None)], status::TIMER, b"\x02:1".to_vec()));
    receive(&cpu, &operands(V, 0));
    cpu.s7200_feed(0, b":", false);
    cpu.s7200_feed(0, b"1", true);
    pass(&cpu, 3 * MS);
    assert_eq!((raised(&cpu), sm(&cpu, 86), table(&cpu, 0, 1)), (vec![(23, None)], status::FAULTY, vec![1]));
}

#[test]
fn message_after_a_break() {
    let cpu = freeport_cpu();
    set_sm(&cpu, 130, FREEPORT);
    cpu.memory.load(special(187), &[0x82, 0, 0, 0, 0, 0, 0, 2]);
    receive(&cpu, &operands(V, 1));
    cpu.s7200_feed(1, b"ab", false);
    cpu.s7200_feed_break(1);
    cpu.s7200_feed(1, b"cd", false);
    pass(&cpu, 10 * MS);
    assert_eq!((raised(&cpu), sm(&cpu, 186), table(&cpu, 0, 3)), (vec![(24, None)], status::COUNT, b"\x02cd".to_vec()));
}

#[test]
fn receive_is_refused_and_aborted() {
    let cpu = freeport_cpu();
    prepare(&cpu, 0xA0);
    assert_eq!(receive(&cpu, &operands(V, 0)), 0);
    assert_eq!((sm(&cpu, 86), raised(&cpu)), (status::PARAMETER, vec![]));
    prepare(&cpu, 0xC0);
    assert_eq!(receive(&cpu, &operands(V, 0)), result::ENO);
    assert_eq!(receive(&cpu, &operands(V, 0)), 0, "0009");
    assert_eq!(transmit(&cpu, &operands(V, 0)), 0, "0009");
    set_sm(&cpu, 87, 0);
    assert_eq!(receive(&cpu, &operands(V, 0)), result::ENO);
    assert_eq!((sm(&cpu, 86), raised(&cpu)), (status::ABORTED, vec![]));
    set_sm(&cpu, 86, 5);
    assert_eq!((receive(&cpu, &operands(V, 0)), sm(&cpu, 86)), (result::ENO, 5), "there is nothing to abort");
}

#[test]
fn leaving_freeport_ends_all() {
    let cpu = freeport_cpu();
    cpu.memory.load(V, b"\x02ab");
    transmit(&cpu, &operands(V, 0));
    cpu.s7200_feed(0, b"A", false);
    set_sm(&cpu, 30, 0x08);
    assert_eq!((sm(&cpu, 4), cpu.s7200_ports_due()), (0x60, NEVER));
    pass(&cpu, 10 * MS);
    assert_eq!((raised(&cpu), cpu.s7200_take_sent(0)), (vec![], vec![]));
}

#[test]
fn too_many_characters_are_an_overrun() {
    let cpu = freeport_cpu();
    cpu.s7200_feed(0, &vec![0x55; 1 << 15], false);
    pass(&cpu, (1 << 15) * CHARACTER);
    let raised = raised(&cpu);
    assert_eq!((raised.len(), raised.last()), (1 << 14, Some(&(8, Some((0x55, true))))));
}

fn config(link: Link) -> S7200Config {
    S7200Config { ports: vec![Port { number: 0, link }], ..S7200Config::default() }
}

/// The end of a scan under the virtual clock, and the time to the next.
fn scan(cpu: &Cpu) {
    cpu.s7200_poll_network();
    pass(cpu, 10 * MS);
    std::thread::sleep(Duration::from_millis(1));
}

fn until_raised(cpu: &Cpu, count: usize) -> Vec<(u8, EventData)> {
    let mut all = Vec::new();
    for _ in 0..3000 {
        scan(cpu);
        all.extend(raised(cpu));
        if all.len() >= count {
            return all;
        }
    }
    panic!("only {all:?}");
}

fn path(name: &str) -> String {
    std::env::temp_dir().join(format!("plcc-{}-{name}", std::process::id())).display().to_string()
}

/// Sends `ok` from port 0 and lets `partner` read it.
fn send_ok(cpu: &Cpu, partner: &mut impl Read) {
    cpu.memory.load(V, b"\x02ok");
    assert_eq!(transmit(cpu, &operands(V, 0)), result::ENO);
    assert_eq!(until_raised(cpu, 1), [(9, None)]);
    let mut bytes = [0; 2];
    partner.read_exact(&mut bytes).unwrap();
    assert_eq!(&bytes, b"ok");
}

#[test]
fn pseudo_terminal() {
    let path = path("port");
    let cpu = cpu(config(Link::PseudoTerminal(path.clone())));
    set_sm(&cpu, 30, FREEPORT);
    let mut partner = OpenOptions::new().read(true).write(true).open(&path).unwrap();
    partner.write_all(&[b'A', 0xFF, b'\r', 3]).unwrap();
    let bytes: Vec<u8> = until_raised(&cpu, 4).iter().filter_map(|(_, data)| data.map(|(byte, _)| byte)).collect();
    assert_eq!(bytes, [b'A', 0xFF, b'\r', 3], "no translation and no signals");
    send_ok(&cpu, &mut partner);
    // A second program may come later, and the name goes with the port.
    drop(partner);
    scan(&cpu);
    let mut partner = OpenOptions::new().read(true).write(true).open(&path).unwrap();
    partner.write_all(b"B").unwrap();
    assert_eq!(until_raised(&cpu, 1), [(8, Some((b'B', false)))]);
    drop(cpu);
    assert!(std::fs::symlink_metadata(&path).is_err());
}

#[test]
fn serial_device() {
    let master = openpt_pair();
    let (mut master, terminal) = master;
    let cpu = cpu(config(Link::Device(terminal.clone())));
    // 19200 baud.
    set_sm(&cpu, 30, 0x05);
    let line = rustix::termios::tcgetattr(File::open(&terminal).unwrap()).unwrap();
    assert_eq!((line.input_speed(), line.output_speed()), (19_200, 19_200));
    master.write_all(&[0xFF, b'A']).unwrap();
    assert_eq!(until_raised(&cpu, 2), [(8, Some((0xFF, false))), (8, Some((b'A', false)))]);
    send_ok(&cpu, &mut master);
    // The terminal shows no break, but asking for one does no harm.
    cpu.memory.set_byte(V, 0);
    transmit(&cpu, &operands(V, 0));
    assert_eq!(until_raised(&cpu, 1), [(9, None)]);
}

fn openpt_pair() -> (File, String) {
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&master).unwrap();
    unlockpt(&master).unwrap();
    let name = ptsname(&master, Vec::new()).unwrap().into_string().unwrap();
    (File::from(master), name)
}

#[test]
fn two_ports_over_tcp() {
    let address = TcpListener::bind("127.0.0.1:0").and_then(|free| free.local_addr()).unwrap().to_string();
    let caller = cpu(config(Link::Connect(address.clone())));
    let called = cpu(config(Link::Listen(address)));
    set_sm(&caller, 30, FREEPORT);
    set_sm(&called, 30, FREEPORT);
    prepare(&called, 0xE0);
    receive(&called, &operands(V + 100, 0));
    // Wait for the connection: earlier characters are lost.
    for _ in 0..200 {
        scan(&caller);
        scan(&called);
    }
    caller.memory.load(V, b"\x04:ab\r");
    transmit(&caller, &operands(V, 0));
    assert_eq!(until_raised(&caller, 1), [(9, None)]);
    assert_eq!(until_raised(&called, 1), [(23, None)]);
    assert_eq!(table(&called, 100, 5), b"\x04:ab\r");
}

#[test]
fn real_clock_looks_by_itself() {
    let path = path("real");
    let cpu = cpu_with(config(Link::PseudoTerminal(path.clone())), Clock::real());
    assert_eq!(cpu.s7200_ports_due(), NEVER, "not in Freeport mode");
    set_sm(&cpu, 30, FREEPORT);
    let mut partner = OpenOptions::new().read(true).write(true).open(&path).unwrap();
    partner.write_all(b"AB").unwrap();
    let mut all = Vec::new();
    while all.len() < 2 {
        let now = cpu.clock.now();
        assert!(now < 10_000 * MS && cpu.s7200_ports_due() < now + 2 * MS, "{all:?}");
        std::thread::sleep(Duration::from_micros(100));
        cpu.s7200_poll_ports();
        all.extend(raised(&cpu));
    }
    assert_eq!(all, [(8, Some((b'A', false))), (8, Some((b'B', false)))]);
}

#[test]
fn what_cannot_be_opened_leaves_the_port_alone() {
    let cpu = cpu(config(Link::Device("/dev/null/tty".to_string())));
    set_sm(&cpu, 30, FREEPORT);
    cpu.s7200_feed(0, b"A", false);
    pass(&cpu, 2 * MS);
    assert_eq!(raised(&cpu).len(), 1);
}
