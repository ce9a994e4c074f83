//! A file that always has a whole copy of what was last written to it: two slots, written in turn.
//!
//! The file begins with [`MAGIC`] and the bytes that a slot holds (`u64`, little-endian). Slot 0 begins at [`HEAD_BYTES`], slot 1 after it. A
//! slot has a number that grows by one with each copy (`u64`), the length of the content (`u64`), a checksum (CRC-32 of both and of the
//! content), and the content. The slot with the larger number counts if its checksum is right, else the other one. So a copy
//! that was cut short leaves the one before it.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read, Write};
use std::os::unix::fs::{FileExt, MetadataExt};
use std::path::{Path, PathBuf};

/// Begins the file; the last digit is the version of the format.
const MAGIC: &[u8; 8] = b"PLCRET2\n";
/// Where slot 0 begins: no slot shares a block of the disk with the head.
const HEAD_BYTES: u64 = 4096;
/// Number, length, checksum.
const SLOT_HEAD_BYTES: usize = 8 + 8 + 4;
/// Longest content: all areas and data blocks of a CPU.
const CONTENT_MAX: u64 = 256 << 20;

/// Why the file cannot be used.
#[derive(Debug)]
pub(crate) enum Fault {
    /// It has something else in it, which must stay as it is.
    Foreign(String),
    /// Another process has it open.
    InUse,
    Host(std::io::Error),
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Fault::Foreign(text) => f.write_str(text),
            Fault::InUse => f.write_str("another process has it open"),
            Fault::Host(error) => error.fmt(f),
        }
    }
}

impl From<std::io::Error> for Fault {
    fn from(error: std::io::Error) -> Fault {
        Fault::Host(error)
    }
}

/// What the file has.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Content {
    /// There was no file, or an empty one.
    Nothing,
    Whole(Vec<u8>),
    /// Neither slot is whole.
    Damaged,
}

/// See the module comment.
#[derive(Debug)]
pub(crate) struct Slots {
    path: PathBuf,
    file: File,
    /// Bytes of a slot, its head included.
    slot_bytes: u64,
    /// Number of the last copy.
    number: u64,
    /// A copy with its head, made before it is written.
    buffer: Vec<u8>,
}

impl Slots {
    /// Opens the file, or makes a new one, and locks it until it is closed.
    pub(crate) fn open(path: &Path) -> Result<(Slots, Content), Fault> {
        check(path)?;
        let mut file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)?;
        lock(&file)?;
        let Found { slot_bytes, number, content } = read_all(&mut file)?;
        Ok((Slots { path: path.to_path_buf(), file, slot_bytes, number, buffer: Vec::new() }, content))
    }

    /// What a file has that can be read and not written.
    pub(crate) fn read(path: &Path) -> Result<Content, Fault> {
        check(path)?;
        let mut file = File::open(path)?;
        found_free(file.try_lock_shared())?;
        Ok(read_all(&mut file)?.content)
    }

    /// Writes a copy over the older one. It is with the system then, not yet on the disk, see [`Slots::disk`].
    pub(crate) fn write(&mut self, content: &[u8]) -> std::io::Result<()> {
        let needed = (SLOT_HEAD_BYTES + content.len()) as u64;
        if needed > self.slot_bytes {
            return self.renew(content);
        }
        let number = self.number + 1;
        self.fill(number, content);
        self.file.write_all_at(&self.buffer, HEAD_BYTES + (number % 2) * self.slot_bytes)?;
        self.number = number;
        Ok(())
    }

    /// True if a content of so many bytes needs a file with larger slots, which takes longer to write.
    pub(crate) fn is_short_for(&self, bytes: usize) -> bool {
        (SLOT_HEAD_BYTES + bytes) as u64 > self.slot_bytes
    }

    /// False: somebody has deleted the file, or another one is in its place. One that somebody has cut is made again with the next copy.
    pub(crate) fn is_in_place(&mut self) -> bool {
        let there = match std::fs::metadata(&self.path) {
            Ok(there) => there,
            Err(error) => return error.kind() != ErrorKind::NotFound,
        };
        if self.file.metadata().is_ok_and(|own| (own.dev(), own.ino()) != (there.dev(), there.ino())) {
            return false;
        }
        let mut head = [0; MAGIC.len() + 8];
        if self.file.read_exact_at(&mut head, 0).is_err() || slot_bytes_of(&head) != self.slot_bytes {
            self.slot_bytes = 0;
        }
        true
    }

    /// The open file, for [`File::sync_data`] by another thread. After a [`Slots::write`] of a longer content it is another one.
    pub(crate) fn disk(&self) -> std::io::Result<File> {
        self.file.try_clone()
    }

    /// Puts the copy with its head into the buffer.
    fn fill(&mut self, number: u64, content: &[u8]) {
        self.buffer.clear();
        self.buffer.extend(number.to_le_bytes());
        self.buffer.extend((content.len() as u64).to_le_bytes());
        let sum = checksum(&self.buffer, content);
        self.buffer.extend(sum.to_le_bytes());
        self.buffer.extend(content);
    }

    /// Puts a file with larger slots in the place of this one, which stays whole until then.
    fn renew(&mut self, content: &[u8]) -> std::io::Result<()> {
        // Room to grow, in blocks of the disk.
        let slot_bytes = ((SLOT_HEAD_BYTES + content.len()) as u64 * 5 / 4).next_multiple_of(HEAD_BYTES);
        let number = self.number + 1;
        self.fill(number, content);
        let beside = beside(&self.path);
        check(&beside).map_err(|fault| std::io::Error::other(fault.to_string()))?;
        let mut file = OpenOptions::new().read(true).write(true).create(true).truncate(true).open(&beside)?;
        let written = (|| {
            lock(&file).map_err(|_| std::io::Error::from(ErrorKind::ResourceBusy))?;
            file.write_all(MAGIC)?;
            file.write_all(&slot_bytes.to_le_bytes())?;
            file.write_all_at(&self.buffer, HEAD_BYTES + (number % 2) * slot_bytes)?;
            file.set_len(HEAD_BYTES + 2 * slot_bytes)?;
            file.sync_all()?;
            std::fs::rename(&beside, &self.path)
        })();
        if let Err(error) = written {
            // What is left of it takes room that may be what is missing.
            let _ = std::fs::remove_file(&beside);
            return Err(error);
        }
        (self.file, self.slot_bytes, self.number) = (file, slot_bytes, number);
        Ok(())
    }
}

/// What was read from a file.
struct Found {
    slot_bytes: u64,
    /// Number of the newest copy, 0: there is none.
    number: u64,
    content: Content,
}

fn read_all(file: &mut File) -> std::io::Result<Found> {
    let mut bytes = Vec::new();
    Read::by_ref(file).take(HEAD_BYTES + 2 * CONTENT_MAX).read_to_end(&mut bytes)?;
    let slot_bytes = slot_bytes_of(&bytes);
    let newest = (0..2).filter_map(|slot| copy(&bytes, slot, slot_bytes)).max_by_key(|(number, _)| *number);
    let (number, content) = match newest {
        Some((number, content)) => (number, Content::Whole(content.to_vec())),
        None if bytes.is_empty() => (0, Content::Nothing),
        None => (0, Content::Damaged),
    };
    Ok(Found { slot_bytes, number, content })
}

fn lock(file: &File) -> Result<(), Fault> {
    found_free(file.try_lock())
}

fn found_free(locked: Result<(), TryLockError>) -> Result<(), Fault> {
    match locked {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(Fault::InUse),
        Err(TryLockError::Error(error)) => Err(Fault::Host(error)),
    }
}

/// Where a longer file is written before it takes the place of the other.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".new");
    path.with_file_name(name)
}

fn checksum(head: &[u8], content: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(head);
    hasher.update(content);
    hasher.finalize()
}

/// The bytes of a slot as the head of the file says; 0 if it says nothing sensible.
fn slot_bytes_of(file: &[u8]) -> u64 {
    let given = file.strip_prefix(MAGIC).and_then(|rest| rest.first_chunk::<8>()).map_or(0, |n| u64::from_le_bytes(*n));
    if given > CONTENT_MAX { 0 } else { given }
}

/// Number and content of a slot; `None`: it is not whole.
fn copy(file: &[u8], slot: u64, slot_bytes: u64) -> Option<(u64, &[u8])> {
    let start = usize::try_from(HEAD_BYTES + slot * slot_bytes).ok()?;
    let slot = file.get(start..)?.get(..usize::try_from(slot_bytes).ok()?)?;
    let (number, rest) = slot.split_first_chunk::<8>()?;
    let (length, rest) = rest.split_first_chunk::<8>()?;
    let (sum, rest) = rest.split_first_chunk::<4>()?;
    let content = rest.get(..usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
    let right = checksum(slot.get(..16)?, content) == u32::from_le_bytes(*sum);
    right.then_some((u64::from_le_bytes(*number), content))
}

/// Whether `path` may be written: nothing is there, or a file that is empty or begins as ours, if only in part.
pub(crate) fn check(path: &Path) -> Result<(), Fault> {
    let foreign = |what: &str| Err(Fault::Foreign(format!("{} {what}", path.display())));
    match std::fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(Fault::Host(error)),
        Ok(found) if !found.is_file() => return foreign("is not a file"),
        Ok(_) => {}
    }
    let mut head = Vec::new();
    // All but the version of the format.
    let magic = &MAGIC[..MAGIC.len() - 2];
    File::open(path)?.take(magic.len() as u64).read_to_end(&mut head)?;
    match magic.starts_with(&head) {
        true => Ok(()),
        false => foreign("contains something other than retentive memory and is left as it is"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("plcc-slots-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        folder.join("retain")
    }

    fn content(path: &Path) -> Content {
        Slots::open(path).unwrap().1
    }

    #[test]
    fn the_newest_whole_copy_counts() {
        let path = path("newest");
        let (mut slots, before) = Slots::open(&path).unwrap();
        assert_eq!(before, Content::Nothing);
        for copy in [&b"one"[..], b"two", b"three", b"four"] {
            slots.write(copy).unwrap();
        }
        let bytes = slots.slot_bytes;
        drop(slots);
        assert_eq!(content(&path), Content::Whole(b"four".to_vec()));
        // The copy "four" was cut short: "three" is still there.
        let file = OpenOptions::new().write(true).open(&path).unwrap();
        file.write_all_at(b"!", HEAD_BYTES + SLOT_HEAD_BYTES as u64).unwrap();
        assert_eq!(content(&path), Content::Whole(b"three".to_vec()));
        file.write_all_at(b"!", HEAD_BYTES + bytes + 9).unwrap();
        assert_eq!(content(&path), Content::Damaged);
    }

    #[test]
    fn a_longer_content_gets_larger_slots() {
        let path = path("longer");
        let (mut slots, _) = Slots::open(&path).unwrap();
        slots.write(b"short").unwrap();
        slots.write(&[7; 100_000]).unwrap();
        slots.write(&[8; 100_001]).unwrap();
        drop(slots);
        assert_eq!(content(&path), Content::Whole(vec![8; 100_001]));
    }

    #[test]
    fn other_files_stay_as_they_are() {
        let path = path("foreign");
        std::fs::write(&path, "a letter").unwrap();
        assert!(matches!(Slots::open(&path), Err(Fault::Foreign(_))));
        assert_eq!(std::fs::read(&path).unwrap(), b"a letter");
        assert!(matches!(check(path.parent().unwrap()), Err(Fault::Foreign(_))));
    }

    #[test]
    fn one_process_has_the_file() {
        let path = path("lock");
        let (_slots, _) = Slots::open(&path).unwrap();
        assert!(matches!(Slots::open(&path), Err(Fault::InUse)));
        assert!(matches!(Slots::read(&path), Err(Fault::InUse)));
    }

    #[test]
    fn a_file_is_read_without_being_written() {
        let path = path("read");
        assert!(matches!(Slots::read(&path), Err(Fault::Host(_))));
        let (mut slots, _) = Slots::open(&path).unwrap();
        slots.write(b"content").unwrap();
        drop(slots);
        assert_eq!(Slots::read(&path).unwrap(), Content::Whole(b"content".to_vec()));
    }

    #[test]
    fn any_damage_is_found() {
        let path = path("damage");
        let (mut slots, _) = Slots::open(&path).unwrap();
        slots.write(b"content").unwrap();
        drop(slots);
        let whole = std::fs::read(&path).unwrap();
        for (index, _) in whole.iter().enumerate().filter(|(index, byte)| **byte != 0 || *index < 20) {
            let mut broken = whole.clone();
            broken[index] ^= 0x41;
            std::fs::write(&path, &broken).unwrap();
            match Slots::open(&path) {
                Ok((_, Content::Whole(content))) => assert_eq!(content, b"content", "byte {index}"),
                Ok((_, Content::Damaged)) | Err(Fault::Foreign(_)) => {}
                other => panic!("byte {index}: {other:?}"),
            }
        }
    }
}
