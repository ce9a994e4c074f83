//! What 20 busy S7 clients cost the cycle: a measurement, with `PLCC_LOAD=SECONDS`.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use libtest_mimic::Failed;
use socket2::{Domain, Socket, Type};

use crate::hostile::{CONNECT, SETUP};
use crate::process::{Plc, free_port, get};

const CLIENTS: u8 = 20;
/// Reads 200 bytes of DB 4.
const READ_BLOCK: &[u8] = &[
    3, 0, 0, 31, 2, 0xF0, 0x80, 0x32, 1, 0, 0, 0, 2, 0, 14, 0, 0, 4, 1, 0x12, 10, 0x10, 2, 0, 200, 0, 4, 0x84, 0, 0, 0,
];
const ANSWER_BYTES: usize = 7 + 12 + 2 + 4 + 200;

/// How long each part of the measurement takes, if one is wanted.
pub fn seconds() -> Option<u64> {
    std::env::var("PLCC_LOAD").ok()?.parse().ok()
}

/// Asks again as soon as the answer is there. One computer may have 8 connections, so each client is another one.
fn client(number: u8, port: u16, end: &AtomicBool, answers: &AtomicU64) -> std::io::Result<()> {
    let socket = Socket::new(Domain::IPV4, Type::STREAM, None)?;
    socket.bind(&SocketAddr::from((Ipv4Addr::new(127, 0, 1, number + 1), 0)).into())?;
    socket.connect(&SocketAddr::from((Ipv4Addr::LOCALHOST, port)).into())?;
    let mut stream = TcpStream::from(socket);
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(Duration::from_secs(5)))?;
    let mut buffer = [0; 512];
    for frame in [CONNECT, SETUP] {
        stream.write_all(frame)?;
        let _ = stream.read(&mut buffer)?;
    }
    while !end.load(Ordering::Relaxed) {
        stream.write_all(READ_BLOCK)?;
        stream.read_exact(&mut buffer[..ANSWER_BYTES])?;
        // The first word is the last: the block is of one cycle.
        if buffer[25..27] != buffer[223..225] {
            return Err(std::io::Error::other("a block of two cycles"));
        }
        answers.fetch_add(1, Ordering::Relaxed);
    }
    Ok(())
}

fn histogram(metrics: u16, title: &str) -> Result<(), Failed> {
    println!("{title}");
    let page = get(metrics, "/metrics")?;
    page.lines().filter(|line| line.starts_with("plc_cycle_")).for_each(|line| println!("  {line}"));
    Ok(())
}

/// Prints the times of cycles without clients and with them, of two runs.
pub fn measure() -> Result<(), Failed> {
    let time = Duration::from_secs(seconds().unwrap_or(1));
    let flags = |metrics: u16, s7: u16| ["--metrics".to_string(), metrics.to_string(), "--s7".into(), s7.to_string()];
    let start = |metrics, s7| {
        let flags = flags(metrics, s7);
        Plc::start(&flags.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let (metrics, s7) = (free_port(), free_port());
    let plc = start(metrics, s7)?;
    std::thread::sleep(time);
    histogram(metrics, "without clients")?;
    plc.end()?;
    let (metrics, s7) = (free_port(), free_port());
    let plc = start(metrics, s7)?;
    let (end, answers) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicU64::new(0)));
    let threads: Vec<_> = (0..CLIENTS)
        .map(|number| {
            let (end, answers) = (end.clone(), answers.clone());
            std::thread::spawn(move || client(number, s7, &end, &answers))
        })
        .collect();
    std::thread::sleep(time);
    histogram(metrics, &format!("with {CLIENTS} clients"))?;
    end.store(true, Ordering::Relaxed);
    for thread in threads {
        thread.join().map_err(|_| "a client panicked")??;
    }
    println!("{} answers per second", answers.load(Ordering::Relaxed) / time.as_secs().max(1));
    plc.end()?;
    Ok(())
}
