//! The file of retentive memory, also while it cannot be opened, and after somebody has deleted it: each copy tries it again.

use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::slots::{Content, Fault, Slots};

/// From one look at whether the file is still in its place to the next.
const LOOK_PAUSE: Duration = Duration::from_millis(100);

/// See the module comment.
pub(super) struct LateFile {
    path: PathBuf,
    /// `None`: it cannot be opened for writing yet.
    slots: Option<Slots>,
    /// What it has was read; if not, that must not be lost when it is opened at last.
    is_read: bool,
    /// Somebody has deleted or replaced it since it was opened.
    is_replaced: bool,
    looked: Instant,
}

/// How a file was found.
pub(super) struct Opened {
    pub file: LateFile,
    pub content: Content,
    /// Why it cannot be written.
    pub error: Option<std::io::Error>,
    /// There may be one that has something, and it cannot be read.
    pub is_lost: bool,
}

impl LateFile {
    /// Opens the file, or at least reads it. `Err`: it is not for this process.
    pub(super) fn open(path: &Path) -> Result<Opened, Fault> {
        let looked = Instant::now();
        let file = |slots, is_read| LateFile { path: path.to_path_buf(), slots, is_read, is_replaced: false, looked };
        match Slots::open(path) {
            Ok((slots, content)) => Ok(Opened { file: file(Some(slots), true), content, error: None, is_lost: false }),
            Err(Fault::Host(error)) => match Slots::read(path) {
                Ok(content) => Ok(Opened { file: file(None, true), content, error: Some(error), is_lost: false }),
                Err(Fault::Host(unread)) => {
                    // A folder that is there has no such file; one that is not there may be that of another disk.
                    let is_absent = unread.kind() == ErrorKind::NotFound && folder_of(path).is_dir();
                    let (file, content) = (file(None, false), Content::Nothing);
                    Ok(Opened { file, content, error: Some(error), is_lost: !is_absent })
                }
                Err(fault) => Err(fault),
            },
            Err(fault) => Err(fault),
        }
    }

    /// As [`Slots::is_short_for`].
    pub(super) fn is_short_for(&self, bytes: usize) -> bool {
        self.slots.as_ref().is_some_and(|slots| slots.is_short_for(bytes))
    }

    /// As [`Slots::write`], after the file was opened.
    pub(super) fn write(&mut self, content: &[u8]) -> std::io::Result<()> {
        self.look();
        let slots = match self.slots.take() {
            Some(slots) => slots,
            None => self.open_again()?,
        };
        self.slots.insert(slots).write(content)
    }

    /// As [`Slots::disk`].
    pub(super) fn disk(&self) -> std::io::Result<File> {
        self.slots.as_ref().ok_or(ErrorKind::NotFound)?.disk()
    }

    /// Somebody may have taken the file away: what is written to it then is lost when the process ends.
    fn look(&mut self) {
        if self.looked.elapsed() < LOOK_PAUSE {
            return;
        }
        self.looked = Instant::now();
        if self.slots.as_mut().is_some_and(|slots| !slots.is_in_place()) {
            super::say(&format!("{} was deleted or replaced, and is written again", self.path.display()));
            (self.slots, self.is_read, self.is_replaced) = (None, false, true);
        }
    }

    fn open_again(&mut self) -> std::io::Result<Slots> {
        let (slots, content) = Slots::open(&self.path).map_err(|fault| match fault {
            Fault::Host(error) => error,
            Fault::Foreign(_) | Fault::InUse => std::io::Error::other(fault.to_string()),
        })?;
        if !self.is_read && content != Content::Nothing {
            let kept = super::keep_before(&self.path);
            let why = if self.is_replaced { "is another file now" } else { "could not be read at the start" };
            super::say(&format!("{} {why}, and is overwritten{kept}", self.path.display()));
        }
        self.is_read = true;
        Ok(slots)
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where a file is, and what it has, after somebody did something with it while it was open, and a copy `two` was written.
    fn after(name: &str, done: impl FnOnce(&Path)) -> (PathBuf, Content) {
        let folder = std::env::temp_dir().join(format!("plcc-late-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("retain");
        let mut file = LateFile::open(&path).unwrap().file;
        file.write(b"one").unwrap();
        done(&path);
        std::thread::sleep(LOOK_PAUSE);
        file.write(b"two").unwrap();
        drop(file);
        let content = Slots::read(&path).unwrap();
        (path, content)
    }

    #[test]
    fn a_file_that_is_taken_away_is_made_again() {
        let two = || Content::Whole(b"two".to_vec());
        assert_eq!(after("deleted", |path| std::fs::remove_file(path).unwrap()).1, two());
        let away = |path: &Path| path.with_extension("away");
        let (path, content) = after("moved", |path| std::fs::rename(path, away(path)).unwrap());
        assert_eq!((content, Slots::read(&away(&path)).unwrap()), (two(), Content::Whole(b"one".to_vec())));
        assert_eq!(after("cut", |path| drop(File::create(path).unwrap())).1, two());
    }

    #[test]
    fn what_takes_the_place_of_the_file_is_kept() {
        let (path, content) = after("replaced", |path| {
            let other = path.with_extension("other");
            Slots::open(&other).unwrap().0.write(b"other").unwrap();
            std::fs::rename(other, path).unwrap();
        });
        assert_eq!(content, Content::Whole(b"two".to_vec()));
        assert_eq!(Slots::read(&path.with_extension("old")).unwrap(), Content::Whole(b"other".to_vec()));
    }
}
