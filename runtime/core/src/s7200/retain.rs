//! Retentive memory and permanent memory in a file. Source: S7-200 system manual, storing and restoring data.
//!
//! Retentive are V, T0-T31, T64-T95, all counters and M14.0 to M31.7. The file is written when they have changed at the end of a scan, but
//! not more often than ten times a second, and when the run ends. A new file takes the place of the old one, so that there is always
//! a whole one.
//!
//! The file: [`MAGIC`], then sections of a tag (4 bytes), a length (`u32`), a checksum (`u64`) and that many bytes; numbers are big-endian.
//! `KEPT` has the checksum of the data block that V began with, then a length (`u32`) and the bytes of each range. `PERM` has that checksum,
//! then offset (`u16`) and value (1 byte) of each saved V byte. V of another data block is not taken: a new one was loaded.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use plcc_abi::layout;
use plcc_abi::s7200::{COUNTERS, V_DB, error, system};

use super::errors::INTERNAL_ERROR;
use crate::cpu::{Area, Cpu};
use crate::diagnostics::NO_SITE;

/// Begins the file; the last character is the version of the format.
const MAGIC: &[u8; 8] = b"S7200RT1";
const KEPT: &[u8; 4] = b"KEPT";
const PERMANENT: &[u8; 4] = b"PERM";
/// Shortest time between two writes.
const PAUSE: Duration = Duration::from_millis(100);
/// First byte of M that is retentive.
const M_FIRST: u32 = 14;
/// Timers of the type TONR: first number, count.
const TONR: [(u32, u32); 2] = [(0, 32), (64, 32)];

/// State of the file.
#[derive(Default)]
pub struct Retain {
    /// Content of the file as last written or read, or its content when `writer` is ready.
    written: RefCell<Vec<u8>>,
    /// Writes the file while scans continue: a disk may take longer than a scan.
    writer: RefCell<Option<JoinHandle<std::io::Result<()>>>>,
    last_write: Cell<Option<Instant>>,
    permanent: RefCell<BTreeMap<u16, u8>>,
    /// Retentive memory was expected and is not there.
    lost: Cell<bool>,
    /// Writing has failed, and this was reported.
    failed: Cell<bool>,
}

impl Retain {
    /// Retentive memory was lost: SM0.2.
    pub(super) fn is_lost(&self) -> bool {
        self.lost.get()
    }
}

/// FNV-1a.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |sum, &byte| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3))
}

fn add_section(file: &mut Vec<u8>, tag: &[u8; 4], body: &[u8]) {
    file.extend(tag);
    file.extend((body.len() as u32).to_be_bytes());
    file.extend(checksum(body).to_be_bytes());
    file.extend(body);
}

/// Takes `N` bytes from the front.
fn take<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (front, rest) = bytes.split_first_chunk::<N>()?;
    *bytes = rest;
    Some(*front)
}

/// Takes `length` bytes.
fn take_counted<'a>(bytes: &mut &'a [u8], length: usize) -> Option<&'a [u8]> {
    let (front, rest) = bytes.split_at_checked(length)?;
    *bytes = rest;
    Some(front)
}

/// The whole section with this tag; `None`: it is not there or damaged.
fn section<'a>(file: &'a [u8], wanted: &[u8; 4]) -> Option<&'a [u8]> {
    let mut rest = file.strip_prefix(MAGIC)?;
    loop {
        let tag = take::<4>(&mut rest)?;
        let length = u32::from_be_bytes(take(&mut rest)?);
        let sum = u64::from_be_bytes(take(&mut rest)?);
        let body = take_counted(&mut rest, length as usize)?;
        if &tag == wanted {
            return Some(body).filter(|body| checksum(body) == sum);
        }
    }
}

/// A message to the user; a closed standard error changes nothing.
fn say(text: &str) {
    let _ = writeln!(std::io::stderr(), "runtime: {text}");
}

impl Cpu {
    /// Offset from the memory base and length of each retentive range, V first.
    fn retentive_ranges(&self) -> Vec<(u32, u32)> {
        let (v, v_bytes) = self.memory.db(V_DB);
        let (m, m_bytes) = self.area(Area::BitMemory);
        let mut ranges = vec![(v, v_bytes), (m.saturating_add(M_FIRST), m_bytes.saturating_sub(M_FIRST))];
        ranges.extend(TONR.map(|(first, count)| (layout::SYSTEM + system::TIMER_VALUES + 2 * first, 2 * count)));
        ranges.push((layout::SYSTEM + system::COUNTER_VALUES, 2 * COUNTERS));
        ranges
    }

    /// Checksum of V as the program brings it.
    fn data_block_sum(&self) -> u64 {
        self.image.dbs.iter().find(|db| db.number == V_DB).map_or(0, |db| checksum(&db.data))
    }

    fn retentive_file(&self) -> Option<&Path> {
        self.s7200().and_then(|own| own.config.retentive_file.as_deref()).map(Path::new)
    }

    /// Whether the file of retentive memory can be one. `Err`: why another file is in its place.
    pub(crate) fn s7200_check_retentive_file(&self) -> Result<(), String> {
        match self.retentive_file() {
            Some(path) => [path.to_path_buf(), beside(path)].iter().try_for_each(|path| check_ours(path)),
            None => Ok(()),
        }
    }

    /// The CPU is switched on: memory gets its retentive values, V its permanent ones if there are no others.
    pub(super) fn s7200_load_retentive(&self) {
        let (Some(own), Some(path)) = (self.s7200(), self.retentive_file()) else { return };
        let retain = &own.retain;
        if let Err(message) = check_ours(path) {
            say(&format!("cold start: {message}"));
            retain.lost.set(true);
            return;
        }
        let file = match std::fs::read(path) {
            Ok(file) => file,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                retain.lost.set(true);
                return;
            }
            Err(error) => {
                say(&format!("cold start: cannot read retentive memory from {}: {error}", path.display()));
                retain.lost.set(true);
                return;
            }
        };
        if let Some(permanent) = section(&file, PERMANENT) {
            self.load_permanent(permanent);
        }
        match section(&file, KEPT).and_then(|kept| self.load_kept(kept, path)) {
            Some(()) => *retain.written.borrow_mut() = file,
            None => {
                say(&format!("cold start: {} is damaged or contains no retentive memory", path.display()));
                retain.lost.set(true);
            }
        }
    }

    /// `None`: it is cut, and nothing was loaded after the cut.
    fn load_kept(&self, mut body: &[u8], path: &Path) -> Option<()> {
        let same_block = u64::from_be_bytes(take(&mut body)?) == self.data_block_sum();
        if !same_block {
            say(&format!(
                "the data block is new: V memory begins with its values, not with those of {}",
                path.display()
            ));
        }
        for (index, (address, bytes)) in self.retentive_ranges().into_iter().enumerate() {
            let length = u32::from_be_bytes(take(&mut body)?);
            let values = take_counted(&mut body, length as usize)?;
            if index > 0 || same_block {
                self.memory.load(address, values.get(..bytes as usize).unwrap_or(values));
            }
        }
        Some(())
    }

    fn load_permanent(&self, mut body: &[u8]) {
        let Some(own) = self.s7200() else { return };
        let (v, v_bytes) = self.memory.db(V_DB);
        if take(&mut body).map(u64::from_be_bytes) != Some(self.data_block_sum()) {
            return;
        }
        let mut permanent = own.retain.permanent.borrow_mut();
        while let Some([high, low, value]) = take(&mut body) {
            let offset = u16::from_be_bytes([high, low]);
            if u32::from(offset) < v_bytes {
                permanent.insert(offset, value);
                self.memory.set_byte(v + u32::from(offset), value);
            }
        }
    }

    /// Copies V bytes to permanent memory. Outside of V: error 0094.
    pub(super) fn s7200_save_permanent(&self, offset: u16, bytes: u16) {
        let Some(own) = self.s7200() else { return };
        let (v, v_bytes) = self.memory.db(V_DB);
        if u32::from(offset) + u32::from(bytes) > v_bytes {
            self.s7200_error(NO_SITE, error::PERMANENT_RANGE);
            return;
        }
        let mut permanent = own.retain.permanent.borrow_mut();
        for at in offset..offset.saturating_add(bytes) {
            permanent.insert(at, self.memory.byte(v + u32::from(at)));
        }
    }

    /// The file as it should be now.
    fn retentive_image(&self) -> Vec<u8> {
        let sum = self.data_block_sum().to_be_bytes();
        let mut kept = sum.to_vec();
        for (address, bytes) in self.retentive_ranges() {
            kept.extend(bytes.to_be_bytes());
            self.memory.view(address, bytes, |values| kept.extend(values));
        }
        let mut permanent = sum.to_vec();
        if let Some(own) = self.s7200() {
            for (offset, value) in own.retain.permanent.borrow().iter() {
                permanent.extend(offset.to_be_bytes());
                permanent.push(*value);
            }
        }
        let mut file = MAGIC.to_vec();
        add_section(&mut file, KEPT, &kept);
        add_section(&mut file, PERMANENT, &permanent);
        file
    }

    /// A scan has ended, or with `finally` the run: writes the file if it is time and something has changed.
    pub(crate) fn s7200_keep(&self, finally: bool) {
        let (Some(own), Some(path)) = (self.s7200(), self.retentive_file()) else { return };
        let retain = &own.retain;
        let soon = retain.last_write.get().is_some_and(|last| last.elapsed() < PAUSE);
        let damaged = self.stopped().is_some_and(|stop| stop.entry.event == INTERNAL_ERROR);
        let busy = retain.writer.borrow().as_ref().is_some_and(|writer| !writer.is_finished());
        if (soon || busy) && !finally || damaged {
            return;
        }
        retain.last_write.set(Some(Instant::now()));
        if let Some(writer) = retain.writer.take() {
            let result = writer.join().unwrap_or_else(|_| Err(std::io::ErrorKind::Other.into()));
            self.note_write(path, result);
        }
        let file = self.retentive_image();
        if *retain.written.borrow() == file {
            return;
        }
        retain.written.borrow_mut().clone_from(&file);
        // Without a real clock a scan may take as long as it likes.
        if finally || self.clock.is_virtual() {
            self.note_write(path, replace(path, &file));
            return;
        }
        let own_path = path.to_path_buf();
        let spawned = std::thread::Builder::new().spawn(move || replace(&own_path, &file));
        match spawned {
            Ok(writer) => *retain.writer.borrow_mut() = Some(writer),
            Err(error) => self.note_write(path, Err(error)),
        }
    }

    /// A file that was not written is written again after the next change; the first failure is reported.
    fn note_write(&self, path: &Path, result: std::io::Result<()>) {
        let (Some(own), Err(error)) = (self.s7200(), result) else { return };
        own.retain.written.borrow_mut().clear();
        if !own.retain.failed.replace(true) {
            say(&format!("cannot write retentive memory to {}: {error}", path.display()));
        }
    }
}

/// Where the new file is written before it takes the place of the old one.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".new");
    path.with_file_name(name)
}

/// Whether `path` may be replaced: nothing is there, or a file that is empty or begins as ours, if only in part. `Err`: why not.
fn check_ours(path: &Path) -> Result<(), String> {
    let wrong = |what: &str| Err(format!("{} {what}; name another file in `retentive`", path.display()));
    match std::fs::metadata(path) {
        // There is no file, or reading it reports the error.
        Err(_) => return Ok(()),
        Ok(found) if !found.is_file() => return wrong("is not a file"),
        Ok(_) => {}
    }
    let mut head = Vec::new();
    let Ok(file) = std::fs::File::open(path) else { return Ok(()) };
    // All but the version of the format.
    let magic = &MAGIC[..MAGIC.len() - 1];
    match file.take(magic.len() as u64).read_to_end(&mut head) {
        Ok(_) if !magic.starts_with(&head) => {
            wrong("contains something other than retentive memory and is left as it is")
        }
        Ok(_) | Err(_) => Ok(()),
    }
}

/// Writes a file next to `path` and puts it in its place when it is on the disk.
fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let new = beside(path);
    for file in [path, &new] {
        check_ours(file).map_err(std::io::Error::other)?;
    }
    let mut file = std::fs::File::create(&new)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    drop(file);
    std::fs::rename(&new, path)
}
