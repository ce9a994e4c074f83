//! The files of a program: below one folder, which no name leaves.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use crate::files;

/// Longest file.
pub const FILE_BYTES_MAX: u64 = 16 << 20;
/// Most files of a folder. Source: TIA Portal help, data logs.
pub const FILES_MAX: usize = 1000;
/// Most folders and names in a path.
const PARTS_MAX: usize = 4;
/// Longest name of a file or folder.
const NAME_CHARACTERS_MAX: usize = 60;

/// Why a file cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The name is not one of a file below the folder.
    Name,
    Missing,
    /// It would be too long, or its folder has too many.
    Full,
    /// The host does not allow it, or it is not a file.
    Denied,
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Fault {
        match error.kind() {
            ErrorKind::NotFound => Fault::Missing,
            _ => Fault::Denied,
        }
    }
}

/// See the module comment.
pub struct Store {
    root: PathBuf,
    /// Goes with the store.
    temporary: bool,
}

impl Store {
    /// Files below `root`, which exists once something is written.
    pub fn new(root: PathBuf) -> Store {
        Store { root, temporary: false }
    }

    /// Files in a folder of its own, which the store removes at its end.
    pub fn temporary() -> Store {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let name = format!("plcc-data-{}-{number}", std::process::id());
        let root = std::env::temp_dir().join(name);
        // What a killed process with this number has left.
        let _ = fs::remove_dir_all(&root);
        Store { root, temporary: true }
    }

    /// The path of a file. No part of it is a link.
    fn path(&self, name: &str) -> Result<PathBuf, Fault> {
        let parts: Vec<&str> = name.split(['/', '\\']).collect();
        if parts.len() > PARTS_MAX || !parts.iter().all(|part| is_name(part)) {
            return Err(Fault::Name);
        }
        let mut path = self.root.clone();
        for part in parts {
            path.push(part);
            match fs::symlink_metadata(&path) {
                Ok(found) if found.is_symlink() => return Err(Fault::Denied),
                Ok(_) => {}
                Err(error) if error.kind() == ErrorKind::NotFound => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(path)
    }

    /// Opens a file that exists.
    fn open(&self, name: &str, options: &mut OpenOptions) -> Result<File, Fault> {
        let path = self.path(name)?;
        files::regular(&path)?;
        Ok(options.custom_flags(libc::O_NOFOLLOW).open(path)?)
    }

    /// Opens a file for writing; makes it, and its folders.
    fn open_or_make(&self, name: &str) -> Result<File, Fault> {
        let path = self.path(name)?;
        files::writable(&path)?;
        if !path.exists() {
            let folder = path.parent().unwrap_or(&self.root);
            fs::create_dir_all(folder)?;
            if fs::read_dir(folder)?.count() >= FILES_MAX {
                return Err(Fault::Full);
            }
        }
        let mut options = OpenOptions::new();
        options.write(true).create(true).truncate(false).custom_flags(libc::O_NOFOLLOW);
        Ok(options.open(path)?)
    }

    pub fn exists(&self, name: &str) -> bool {
        self.path(name).is_ok_and(|path| path.exists())
    }

    /// Length of a file in bytes.
    pub fn length(&self, name: &str) -> Result<u64, Fault> {
        Ok(self.open(name, OpenOptions::new().read(true))?.metadata()?.len())
    }

    /// Up to `count` bytes of a file from `offset` on.
    pub fn read(&self, name: &str, offset: u64, count: u64) -> Result<Vec<u8>, Fault> {
        let mut file = self.open(name, OpenOptions::new().read(true))?;
        file.seek(SeekFrom::Start(offset))?;
        let mut bytes = Vec::new();
        file.take(count.min(FILE_BYTES_MAX)).read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    /// Writes bytes at `offset`; zeros fill what is not there before it. With `cut` the file ends after them.
    pub fn write(&self, name: &str, offset: u64, bytes: &[u8], cut: bool) -> Result<(), Fault> {
        let end = offset.saturating_add(bytes.len() as u64);
        if end > FILE_BYTES_MAX {
            return Err(Fault::Full);
        }
        let mut file = self.open_or_make(name)?;
        file.seek(SeekFrom::Start(offset))?;
        file.write_all(bytes)?;
        if cut {
            file.set_len(end)?;
        }
        Ok(())
    }

    /// Removes a file.
    pub fn remove(&self, name: &str) -> Result<(), Fault> {
        let path = self.path(name)?;
        files::regular(&path)?;
        Ok(fs::remove_file(path)?)
    }
}

impl Drop for Store {
    fn drop(&mut self) {
        if self.temporary {
            let _ = fs::remove_dir_all(&self.root);
        }
    }
}

/// True of a word that every file system takes as the name of a file that is not hidden.
pub fn is_name(name: &str) -> bool {
    let forbidden = |c: char| c.is_control() || matches!(c, '/' | '\\' | ':' | '*' | '?' | '"' | '<' | '>' | '|');
    !name.is_empty()
        && name.chars().count() <= NAME_CHARACTERS_MAX
        && !name.starts_with(['.', ' '])
        && !name.ends_with(['.', ' '])
        && !name.contains(forbidden)
}

/// The folder of a run: that of the flag, else that of plc.toml, else `plc-data`.
pub fn folder(flag: Option<&Path>, configured: Option<&str>) -> PathBuf {
    flag.map(Path::to_path_buf).or(configured.map(PathBuf::from)).unwrap_or_else(|| PathBuf::from("plc-data"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_below_the_folder() {
        let store = Store::temporary();
        for name in [
            "../x",
            "a/../../x",
            "/etc/passwd",
            "",
            "a//b",
            ".",
            "..",
            ".x",
            "a\\..\\b",
            "x\0y",
            "C:x",
            "a/b/c/d/e",
            "x ",
            "x.",
        ] {
            assert_eq!(store.write(name, 0, b"1", true), Err(Fault::Name), "{name:?}");
            assert_eq!(store.read(name, 0, 1), Err(Fault::Name), "{name:?}");
            assert_eq!(store.remove(name), Err(Fault::Name), "{name:?}");
        }
        assert!(!store.root.exists());
    }

    #[test]
    fn links_are_not_followed() {
        let store = Store::temporary();
        let outside = Store::temporary();
        store.write("a.txt", 0, b"1", true).unwrap();
        outside.write("b.txt", 0, b"2", true).unwrap();
        std::os::unix::fs::symlink(&outside.root, store.root.join("out")).unwrap();
        std::os::unix::fs::symlink(outside.root.join("b.txt"), store.root.join("b.txt")).unwrap();
        for name in ["out/b.txt", "b.txt", "out/new.txt"] {
            assert_eq!(store.read(name, 0, 1), Err(Fault::Denied), "{name}");
            assert_eq!(store.write(name, 0, b"3", true), Err(Fault::Denied), "{name}");
            assert_eq!(store.remove(name), Err(Fault::Denied), "{name}");
        }
        assert_eq!(outside.read("b.txt", 0, 9), Ok(b"2".to_vec()));
    }

    #[test]
    fn parts_of_files() {
        let store = Store::temporary();
        store.write("d/a.bin", 2, b"xyz", false).unwrap();
        assert_eq!(store.read("d/a.bin", 0, 9), Ok(b"\0\0xyz".to_vec()));
        store.write("d/a.bin", 3, b"-", false).unwrap();
        assert_eq!(store.read("d\\a.bin", 2, 2), Ok(b"x-".to_vec()));
        store.write("d/a.bin", 0, b"q", true).unwrap();
        assert_eq!(store.length("d/a.bin"), Ok(1));
        assert_eq!(store.write("d/a.bin", FILE_BYTES_MAX, b"1", false), Err(Fault::Full));
        assert_eq!(store.read("d", 0, 1), Err(Fault::Denied));
        store.remove("d/a.bin").unwrap();
        assert_eq!(store.read("d/a.bin", 0, 1), Err(Fault::Missing));
    }
}
