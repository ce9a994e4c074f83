//! What 20 busy S7 clients cost the cycle, and what pages that watch a block cost it: measurements, with `PLCC_LOAD=SECONDS`.

use std::io::{Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use libtest_mimic::Failed;

use crate::here;
use crate::hostile::{CONNECT, SETUP, connect, message, sign_in, upgrade};
use crate::process::{Plc, free_port, get, plcc};

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

/// Asks again as soon as the answer is there.
fn client(number: u8, port: u16, end: &AtomicBool, answers: &AtomicU64) -> std::io::Result<()> {
    let mut stream = connect(number, port)?;
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

/// Watches OB 1 as a page does, and reads what it is told.
fn watcher(number: u8, port: u16, cookie: &str, end: &AtomicBool, told: &AtomicU64) -> std::io::Result<()> {
    let mut stream = connect(number, port)?;
    stream.write_all(&upgrade(cookie))?;
    stream.write_all(&message(r#"{"do":"status","block":"OB1","call":null}"#))?;
    let mut buffer = [0; 65_536];
    while !end.load(Ordering::Relaxed) {
        let count = stream.read(&mut buffer)?;
        // What a block sees is news with this name.
        told.fetch_add(
            buffer[..count].windows(9).filter(|part| part == b"\"status\":").count() as u64,
            Ordering::Relaxed,
        );
    }
    Ok(())
}

/// Prints the times of cycles with nobody, one and ten watching, of three runs.
pub fn watching() -> Result<(), Failed> {
    let time = Duration::from_secs(seconds().unwrap_or(1));
    let folder = tempfile::tempdir()?;
    let program = folder.path().join("line");
    plcc(&["build", "--quiet", "--monitor"], &[&here().join("line")], &program)?;
    for watchers in [0, 1, 10] {
        let (metrics, web) = (free_port(), free_port());
        let plc = Plc::run(&program, &["--metrics", &metrics.to_string(), "--web", &web.to_string()])?;
        let cookie = sign_in(web)?;
        let (end, told) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicU64::new(0)));
        let start = |number| {
            let (end, told, cookie) = (end.clone(), told.clone(), cookie.clone());
            std::thread::spawn(move || watcher(number, web, &cookie, &end, &told))
        };
        let threads: Vec<_> = (0..watchers).map(start).collect();
        std::thread::sleep(time);
        histogram(metrics, &format!("{watchers} watching, told {} times", told.load(Ordering::Relaxed)))?;
        end.store(true, Ordering::Relaxed);
        for thread in threads {
            thread.join().map_err(|_| "a client panicked")??;
        }
        if watchers > 0 && told.load(Ordering::Relaxed) == 0 {
            return Err("nobody was told what the block sees".into());
        }
        plc.end()?;
    }
    Ok(())
}
