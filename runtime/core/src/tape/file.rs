//! The file of a recording: eight bytes that say what it is, then pieces with their lengths and checksums. The first
//! piece is the head, each further one a cycle; the last is empty, so that a file that was cut off is recognised.
//! What is left of such a file can be repeated.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use plcc_abi::ProgramImage;
use serde::{Deserialize, Serialize};

use super::devices::Devices;
use crate::files;

const MAGIC: &[u8; 8] = b"PLCCREC\x02";
/// Length and checksum before each piece.
const PREFIX_BYTES: usize = 8;
/// Larger files are not read.
const FILE_BYTES_MAX: u64 = 4 << 30;
/// So much time of a recording is lost at most when the process is killed.
const KEEP: Duration = Duration::from_secs(1);

/// What a run began with.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Head {
    /// See [`Head::fingerprint`].
    pub program: u32,
    /// The wall clock at time 0.
    pub wall: i64,
    /// Nanoseconds.
    pub cycle_time: u64,
    pub set: Vec<String>,
    /// Paths from the root on.
    pub scenario: Option<String>,
    pub watch_table: Option<String>,
    pub stop_on_error: bool,
    /// The number of the startup OB.
    pub startup: u16,
    /// Of `[io]`, with their inputs.
    pub devices: Devices,
}

impl Head {
    /// A number by which another program shows.
    pub fn fingerprint(image: &ProgramImage) -> u32 {
        let mut sum = crc32fast::Hasher::new();
        sum.update(image.profile.name.as_bytes());
        let blocks = image.blocks.iter().map(|block| (block.kind, block.number));
        let inner = image.inner_blocks.iter().map(|(kind, number, _)| (*kind, *number));
        let mut all: Vec<_> = blocks.chain(inner).collect();
        all.sort_unstable();
        for (kind, number) in all {
            sum.update(&[kind as u8]);
            sum.update(&number.to_le_bytes());
        }
        for db in &image.dbs {
            sum.update(&db.number.to_le_bytes());
            sum.update(&db.data);
        }
        sum.finalize()
    }
}

/// A cycle.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Frame {
    /// Nanoseconds from the end of its program to the beginning of the next cycle.
    pub advance: u64,
    pub client: Option<Client>,
    /// Of the values in memory at its end.
    pub check: u32,
    /// What came from devices before it.
    pub devices: Devices,
}

/// What clients changed at the end of a cycle.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Client {
    /// Offset in memory, and bytes.
    pub memory: Vec<(u32, Vec<u8>)>,
    /// Inputs of modules: address, bytes, value.
    pub inputs: Vec<(u32, u32, u32)>,
    pub wall: Option<i64>,
    pub stop: bool,
}

/// A recording that was read.
#[derive(Clone, Debug)]
pub struct Recording {
    pub head: Head,
    pub(super) frames: Vec<Frame>,
    /// Where the file was cut, if it was: cycles after that are missing.
    pub cut: Option<String>,
}

impl Recording {
    /// Reads and checks a file. `Err`: message with file and place.
    pub fn read(path: &Path) -> Result<Recording, String> {
        let shown = path.display();
        let length = files::regular(path).and_then(|()| std::fs::metadata(path)).map(|data| data.len());
        if length.as_ref().is_ok_and(|length| *length > FILE_BYTES_MAX) {
            return Err(format!("{shown}: the file has more than {} GB", FILE_BYTES_MAX >> 30));
        }
        let bytes = length.and_then(|_| std::fs::read(path)).map_err(|error| format!("{shown}: {error}"))?;
        Recording::parse(&bytes).map_err(|error| format!("{shown}: {error}"))
    }

    /// As [`read`](Recording::read), from bytes.
    pub fn parse(bytes: &[u8]) -> Result<Recording, String> {
        let rest = bytes.strip_prefix(MAGIC).ok_or("this is not a recording of plcc")?;
        let mut pieces = Pieces { rest, at: MAGIC.len(), number: 0, is_cut: false };
        let head = pieces.next()?.ok_or("the recording is empty")?;
        let mut frames = Vec::new();
        loop {
            match pieces.next() {
                Ok(Some(frame)) => frames.push(frame),
                Ok(None) => break,
                Err(why) if pieces.is_cut && !frames.is_empty() => {
                    return Ok(Recording { head, frames, cut: Some(why) });
                }
                Err(why) => return Err(why),
            }
        }
        match pieces.rest.len() {
            0 => Ok(Recording { head, frames, cut: None }),
            more => Err(format!("{more} bytes after the end, at byte {}", pieces.at)),
        }
    }

    /// Number of cycles.
    pub fn cycles(&self) -> u64 {
        self.frames.len() as u64
    }
}

struct Pieces<'a> {
    rest: &'a [u8],
    /// Of `rest` in the file.
    at: usize,
    /// Of the next piece.
    number: u64,
    /// The file ends within the next piece.
    is_cut: bool,
}

impl Pieces<'_> {
    /// The next piece; `None`: the end. `Err`: what is wrong, with its place.
    fn next<T: for<'de> Deserialize<'de>>(&mut self) -> Result<Option<T>, String> {
        let what = match self.number {
            0 => "the head".to_string(),
            cycle => format!("cycle {cycle}"),
        };
        let at = self.at;
        let damaged = |why: &str| format!("damaged at byte {at}, {what}: {why}");
        let mut cut = || {
            self.is_cut = true;
            damaged("the file ends too early")
        };
        let (prefix, rest) = self.rest.split_at_checked(PREFIX_BYTES).ok_or_else(&mut cut)?;
        let number = |at: usize| u32::from_le_bytes(std::array::from_fn(|index| prefix[at + index]));
        let (length, check) = (number(0) as usize, number(4));
        let Some((piece, rest)) = rest.split_at_checked(length) else {
            return Err(if begins_with_piece(rest, check) { damaged("its length is wrong") } else { cut() });
        };
        if crc32fast::hash(piece) != check {
            return Err(damaged("the checksum differs"));
        }
        let value = match length {
            0 => None,
            _ => match postcard::take_from_bytes(piece) {
                Ok((value, [])) => Some(value),
                Ok(_) | Err(_) => return Err(damaged("its content makes no sense")),
            },
        };
        (self.rest, self.at, self.number) = (rest, self.at + PREFIX_BYTES + length, self.number + 1);
        Ok(value)
    }
}

/// Whether bytes begin with a whole piece of this checksum: then the file is not cut off, but the length of the piece is damaged.
fn begins_with_piece(bytes: &[u8], check: u32) -> bool {
    const LENGTH_MAX: usize = 16 << 20;
    let mut sum = crc32fast::Hasher::new();
    let mut ends_piece = |byte: &u8| {
        sum.update(std::slice::from_ref(byte));
        sum.clone().finalize() == check
    };
    check == crc32fast::hash(&[]) || bytes.iter().take(LENGTH_MAX).any(&mut ends_piece)
}

/// Writes a file.
pub(super) struct Writer {
    file: BufWriter<File>,
    shown: String,
    /// When what was written was last given to the system.
    kept: Instant,
}

impl Writer {
    pub fn create(path: &Path, head: &Head) -> Result<Writer, String> {
        let shown = path.display().to_string();
        let file =
            files::writable(path).and_then(|()| File::create(path)).map_err(|error| format!("{shown}: {error}"))?;
        let mut writer = Writer { file: BufWriter::new(file), shown, kept: Instant::now() };
        writer.file.write_all(MAGIC).map_err(|error| writer.failed(&error))?;
        writer.piece(&postcard::to_stdvec(head).map_err(|error| error.to_string())?)?;
        Ok(writer)
    }

    fn failed(&self, error: &std::io::Error) -> String {
        format!("the recording is incomplete: {}: {error}", self.shown)
    }

    fn piece(&mut self, bytes: &[u8]) -> Result<(), String> {
        let length = u32::try_from(bytes.len()).map_err(|_| "a cycle changes too much".to_string())?;
        let parts = [&length.to_le_bytes()[..], &crc32fast::hash(bytes).to_le_bytes(), bytes];
        parts.into_iter().try_for_each(|part| self.file.write_all(part)).map_err(|error| self.failed(&error))
    }

    pub fn write(&mut self, frame: &Frame) -> Result<(), String> {
        self.piece(&postcard::to_stdvec(frame).map_err(|error| error.to_string())?)?;
        if self.kept.elapsed() >= KEEP {
            self.kept = Instant::now();
            self.file.flush().map_err(|error| self.failed(&error))?;
        }
        Ok(())
    }

    pub fn finish(mut self) -> Result<(), String> {
        self.piece(&[])?;
        self.file.flush().map_err(|error| self.failed(&error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file() -> Vec<u8> {
        let folder = std::env::temp_dir().join(format!("plcc-tape-{}", std::process::id()));
        let head = Head { program: 7, set: vec!["I0.0=1".to_string()], ..Head::default() };
        let mut writer = Writer::create(&folder, &head).unwrap();
        let client = Client { memory: vec![(5, vec![1, 2])], inputs: vec![(0, 1, 3)], wall: Some(-1), stop: false };
        let devices = Devices { inputs: vec![(4, 9)], changes: Vec::new() };
        writer.write(&Frame { advance: 10_000_000, client: None, check: 1, devices }).unwrap();
        let devices = Devices::default();
        writer.write(&Frame { advance: 1, client: Some(client), check: u32::MAX, devices }).unwrap();
        writer.finish().unwrap();
        let bytes = std::fs::read(&folder).unwrap();
        std::fs::remove_file(&folder).unwrap();
        bytes
    }

    #[test]
    fn what_was_written_is_read() {
        let recording = Recording::parse(&file()).unwrap();
        assert_eq!(recording.head.set, ["I0.0=1"]);
        assert_eq!(recording.cycles(), 2);
        assert_eq!(recording.frames[0].devices.inputs, [(4, 9)]);
        assert_eq!(recording.frames[1].client.as_ref().unwrap().memory, [(5, vec![1, 2])]);
    }

    #[test]
    fn each_damage_has_a_place() {
        let whole = file();
        for length in 0..whole.len() {
            match Recording::parse(&whole[..length]) {
                // The first cycle is whole.
                Ok(recording) => {
                    assert!(
                        recording.cycles() > 0 && recording.cut.is_some_and(|why| why.contains("at byte")),
                        "{length}"
                    );
                }
                Err(error) => {
                    assert!(error.contains("at byte") || error.contains("not a recording"), "{length}: {error}");
                }
            }
        }
        assert_eq!(Recording::parse(&whole[..whole.len() - 1]).unwrap().cycles(), 2);
        for at in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x10;
            assert!(Recording::parse(&bytes).is_err(), "byte {at}");
        }
        let error = Recording::parse(&[&whole[..], b"x"].concat()).map(|_| ()).unwrap_err();
        assert_eq!(error, format!("1 bytes after the end, at byte {}", whole.len()));
    }
}
