//! The file of retentive memory, also while it cannot be opened: each copy tries it again.

use std::fs::File;
use std::path::{Path, PathBuf};

use super::slots::{Content, Fault, Slots};

/// See the module comment.
pub(super) struct LateFile {
    path: PathBuf,
    /// `None`: it cannot be opened for writing yet.
    slots: Option<Slots>,
    /// What it has was read; if not, that must not be lost when it is opened at last.
    is_read: bool,
}

/// How a file was found.
pub(super) struct Opened {
    pub file: LateFile,
    pub content: Content,
    /// Why it cannot be written.
    pub error: Option<std::io::Error>,
}

impl LateFile {
    /// Opens the file, or at least reads it. `Err`: it is not for this process.
    pub(super) fn open(path: &Path) -> Result<Opened, Fault> {
        let file = |slots, is_read| LateFile { path: path.to_path_buf(), slots, is_read };
        match Slots::open(path) {
            Ok((slots, content)) => Ok(Opened { file: file(Some(slots), true), content, error: None }),
            Err(Fault::Host(error)) => match Slots::read(path) {
                Ok(content) => Ok(Opened { file: file(None, true), content, error: Some(error) }),
                Err(Fault::Host(_)) => {
                    Ok(Opened { file: file(None, false), content: Content::Nothing, error: Some(error) })
                }
                Err(fault) => Err(fault),
            },
            Err(fault) => Err(fault),
        }
    }

    /// What the file has was read.
    pub(super) fn is_read(&self) -> bool {
        self.is_read
    }

    /// As [`Slots::is_short_for`].
    pub(super) fn is_short_for(&self, bytes: usize) -> bool {
        self.slots.as_ref().is_some_and(|slots| slots.is_short_for(bytes))
    }

    /// As [`Slots::write`], after the file was opened.
    pub(super) fn write(&mut self, content: &[u8]) -> std::io::Result<()> {
        let slots = match self.slots.take() {
            Some(slots) => slots,
            None => self.open_again()?,
        };
        self.slots.insert(slots).write(content)
    }

    /// As [`Slots::disk`].
    pub(super) fn disk(&self) -> std::io::Result<File> {
        self.slots.as_ref().ok_or(std::io::ErrorKind::NotFound)?.disk()
    }

    fn open_again(&self) -> std::io::Result<Slots> {
        let (slots, content) = Slots::open(&self.path).map_err(|fault| match fault {
            Fault::Host(error) => error,
            Fault::Foreign(_) | Fault::InUse => std::io::Error::other(fault.to_string()),
        })?;
        if !self.is_read && content != Content::Nothing {
            let kept = super::keep_before(&self.path);
            super::say(&format!("{} could not be read at the start, and is overwritten{kept}", self.path.display()));
        }
        Ok(slots)
    }
}
