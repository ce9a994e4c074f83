//! Machine code of earlier builds: what has not changed is not compiled again.
//!
//! The code of a function is kept under a key of all that it depends on (`key`). An executable has one file of code, in
//! `$XDG_CACHE_HOME/plcc` or `~/.cache/plcc`: what its last build used. No clean-up is needed: a file that is damaged or of
//! another plcc is written again, and when all files together are too large, the least recently used ones go. Files are
//! replaced as a whole, so builds at the same time do not disturb each other. Without a folder for it nothing is kept.

mod key;

use std::env;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write as _;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use plcc_codegen::KeptFunction;
use plcc_ir::FuncId;
use rustc_hash::FxHashMap;

pub use key::Keys;

/// What identifies a file of code, and its format.
const MAGIC: [u8; 8] = *b"plcode\x00\x01";

/// All files together, in bytes.
const TOTAL_MAX: u64 = 256 << 20;

/// A larger file is not written.
const FILE_MAX: usize = 128 << 20;

/// The ending of the names of files of code.
const EXTENSION: &str = "code";

/// The place of the code of one executable.
pub struct Cache {
    path: PathBuf,
}

/// The code that was kept.
#[derive(Default)]
pub struct Kept {
    bytes: Vec<u8>,
    entries: FxHashMap<u128, Entry>,
}

#[derive(Clone)]
struct Entry {
    range: Range<usize>,
    check: u64,
}

/// Bytes of a row of the table: key, length, check.
const ROW_BYTES: usize = 32;
/// Bytes before the table: what identifies the file, number of rows, check of the table.
const HEAD_BYTES: usize = 24;

impl Cache {
    /// The code of the executable `output`. `None`: the user has no folder for such files.
    pub fn of(output: &Path) -> Option<Cache> {
        let absolute = |name| env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
        let folder = absolute("XDG_CACHE_HOME").or_else(|| Some(absolute("HOME")?.join(".cache")))?;
        Some(Cache::in_folder(&folder.join("plcc"), output))
    }

    /// The code of the executable `output`, kept in `folder`.
    pub fn in_folder(folder: &Path, output: &Path) -> Cache {
        let output = std::path::absolute(output).unwrap_or_else(|_| output.to_path_buf());
        let mut hasher = DefaultHasher::new();
        output.hash(&mut hasher);
        Cache { path: folder.join(format!("{:016x}.{EXTENSION}", hasher.finish())) }
    }

    /// What is there; nothing, if the file is missing or damaged.
    pub fn read(&self) -> Kept {
        let bytes = fs::read(&self.path).unwrap_or_default();
        entries(&bytes).map_or_else(Kept::default, |entries| Kept { bytes, entries })
    }

    /// Keeps what this build has used of `old`, and what it has made. Failing to do so only costs time in the next build.
    pub fn write(&self, old: &Kept, keys: &Keys, made: &[(FuncId, KeptFunction)]) {
        let used: Vec<u128> = keys.found().filter(|key| old.entries.contains_key(key)).collect();
        if made.is_empty() && used.len() == old.entries.len() {
            return;
        }
        let encoded = made.iter().filter_map(|(id, function)| {
            Some((keys.found_for(*id)?, std::borrow::Cow::Owned(postcard::to_stdvec(function).ok()?)))
        });
        let mut rows: Vec<(u128, std::borrow::Cow<'_, [u8]>)> = encoded.collect();
        let new: std::collections::HashSet<u128> = rows.iter().map(|&(key, _)| key).collect();
        let still = used.iter().filter(|key| !new.contains(key));
        rows.extend(still.map(|key| (*key, old.bytes[old.entries[key].range.clone()].into())));
        rows.sort_by_key(|&(key, _)| key);
        let bytes = file_of(&rows);
        if bytes.len() <= FILE_MAX {
            let _ = self.replace(&bytes);
        }
    }

    fn replace(&self, bytes: &[u8]) -> std::io::Result<()> {
        let folder = self.path.parent().unwrap_or(Path::new("."));
        fs::create_dir_all(folder)?;
        let mut file = tempfile::Builder::new().prefix("new-").suffix(".tmp").tempfile_in(folder)?;
        file.write_all(bytes)?;
        file.persist(&self.path)?;
        make_room(folder, TOTAL_MAX);
        Ok(())
    }
}

impl Kept {
    /// The keys of all functions.
    pub fn keys(&self) -> impl Iterator<Item = u128> + '_ {
        self.entries.keys().copied()
    }

    /// The code under this key.
    pub fn get(&self, key: u128) -> Option<KeptFunction> {
        let entry = self.entries.get(&key)?;
        let bytes = &self.bytes[entry.range.clone()];
        if check(bytes) != entry.check {
            return None;
        }
        postcard::from_bytes(bytes).ok()
    }
}

/// The table of a file. `None`: it is damaged, or written by another version.
fn entries(bytes: &[u8]) -> Option<FxHashMap<u128, Entry>> {
    let number = |at: usize| Some(u64::from_le_bytes(bytes.get(at..at + 8)?.try_into().ok()?));
    if bytes.get(..MAGIC.len())? != MAGIC {
        return None;
    }
    let count = usize::try_from(number(8)?).ok()?;
    let end = count.checked_mul(ROW_BYTES)?.checked_add(HEAD_BYTES)?;
    let table = bytes.get(HEAD_BYTES..end)?;
    if check(table) != number(16)? {
        return None;
    }
    let mut entries = FxHashMap::default();
    let mut at = end;
    for row in table.chunks_exact(ROW_BYTES) {
        let (key, rest) = row.split_at(16);
        let (length, check) = rest.split_at(8);
        let length = usize::try_from(u64::from_le_bytes(length.try_into().ok()?)).ok()?;
        let range = at..at.checked_add(length).filter(|&end| end <= bytes.len())?;
        at = range.end;
        let check = u64::from_le_bytes(check.try_into().ok()?);
        entries.insert(u128::from_le_bytes(key.try_into().ok()?), Entry { range, check });
    }
    Some(entries)
}

fn file_of(rows: &[(u128, std::borrow::Cow<'_, [u8]>)]) -> Vec<u8> {
    let mut table = Vec::with_capacity(rows.len() * ROW_BYTES);
    for (key, bytes) in rows {
        table.extend_from_slice(&key.to_le_bytes());
        table.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
        table.extend_from_slice(&check(bytes).to_le_bytes());
    }
    let total: usize = rows.iter().map(|(_, bytes)| bytes.len()).sum();
    let mut file = Vec::with_capacity(HEAD_BYTES + table.len() + total);
    file.extend_from_slice(&MAGIC);
    file.extend_from_slice(&(rows.len() as u64).to_le_bytes());
    file.extend_from_slice(&check(&table).to_le_bytes());
    file.extend_from_slice(&table);
    rows.iter().for_each(|(_, bytes)| file.extend_from_slice(bytes));
    file
}

/// A number that tells damaged bytes from those that were written.
fn check(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(bytes);
    hasher.finish()
}

/// Removes the files that were written longest ago, until all together are no larger than `total_max`.
fn make_room(folder: &Path, total_max: u64) {
    let Ok(files) = fs::read_dir(folder) else { return };
    let mut found: Vec<(SystemTime, u64, PathBuf)> = files
        .filter_map(Result::ok)
        .filter(|file| file.path().extension().is_some_and(|extension| extension == EXTENSION))
        .filter_map(|file| {
            let metadata = file.metadata().ok()?;
            Some((metadata.modified().ok()?, metadata.len(), file.path()))
        })
        .collect();
    found.sort();
    let mut total: u64 = found.iter().map(|&(_, length, _)| length).sum();
    for (_, length, path) in found {
        if total <= total_max {
            return;
        }
        total -= length;
        let _ = fs::remove_file(path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<(u128, std::borrow::Cow<'static, [u8]>)> {
        vec![(1, vec![1, 2, 3].into()), (7 << 100, vec![].into())]
    }

    #[test]
    fn a_file_reads_as_it_was_written() {
        let bytes = file_of(&rows());
        let found = entries(&bytes).expect("it is not damaged");
        assert_eq!(found.len(), 2);
        assert_eq!(&bytes[found[&1].range.clone()], [1, 2, 3]);
        assert_eq!(found[&1].check, check(&[1, 2, 3]));
        assert!(found[&(7 << 100)].range.is_empty());
    }

    #[test]
    fn damaged_files_are_nothing() {
        let bytes = file_of(&rows());
        for length in 0..bytes.len() {
            assert!(entries(&bytes[..length]).is_none(), "{length}");
        }
        for at in 0..HEAD_BYTES + 2 * ROW_BYTES {
            let mut wrong = bytes.clone();
            wrong[at] ^= 0x40;
            assert!(entries(&wrong).is_none(), "{at}");
        }
    }

    #[test]
    fn the_oldest_files_make_room() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for (age, name) in [(30, "a.code"), (20, "b.code"), (10, "c.code"), (99, "other.txt")] {
            let path = folder.path().join(name);
            fs::write(&path, [0; 100]).expect("the folder can be written");
            let time = SystemTime::now() - std::time::Duration::from_secs(age);
            fs::File::options().append(true).open(path).and_then(|file| file.set_modified(time)).expect("own file");
        }
        make_room(folder.path(), 250);
        let there = |name: &str| folder.path().join(name).exists();
        assert!(!there("a.code") && there("b.code") && there("c.code") && there("other.txt"));
    }
}
