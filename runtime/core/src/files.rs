//! Files that are read as a whole or written. Pipes and endless files are refused, except a pipe that the shell has opened for the process.

use std::fs;
use std::io::{Error, Read, Result};
use std::os::unix::fs::FileTypeExt;
use std::path::Path;

/// Whether `path` is a file that has an end. `Err`: it is not there, or is a pipe, a device or another thing whose reading may wait for ever.
pub fn regular(path: &Path) -> Result<()> {
    let found = fs::metadata(path)?;
    let wrong = |what: &str| Err(Error::other(what));
    if found.is_dir() {
        return wrong("a folder or a link to one, not a file");
    }
    if !found.is_file() {
        return wrong("a pipe, a socket or a device, not a file");
    }
    // Files of the kernel look like files.
    let real = fs::canonicalize(path)?;
    if real.starts_with("/proc") || real.starts_with("/sys") {
        return wrong("a file of the kernel, which may be endless");
    }
    Ok(())
}

/// The bytes of a file, or of a pipe that is open in this process, as with `<(command)` and `/dev/stdin`. `Err`: there are more than
/// `bytes_max` bytes, or what [`regular`] refuses.
pub fn read(path: &Path, bytes_max: u64) -> Result<Vec<u8>> {
    let is_open = ["/dev/fd", "/dev/stdin", "/proc/self/fd"].iter().any(|open| path.starts_with(open));
    if !(is_open && fs::metadata(path)?.file_type().is_fifo()) {
        regular(path)?;
    }
    let mut bytes = Vec::new();
    fs::File::open(path)?.take(bytes_max + 1).read_to_end(&mut bytes)?;
    match bytes.len() as u64 > bytes_max {
        true => Err(Error::other(format!("the file has more than {} MB", bytes_max >> 20))),
        false => Ok(bytes),
    }
}

/// Whether a file can be written at `path`: it is free, or it is a file.
pub fn writable(path: &Path) -> Result<()> {
    match fs::metadata(path) {
        Ok(_) => regular(path),
        Err(_) => Ok(()),
    }
}

/// A message without the numbers that the operating system gives its errors, as in `No such file or directory (os error 2)`.
pub fn without_numbers(message: &str) -> String {
    const BEFORE: &str = " (os error ";
    let mut parts = message.split(BEFORE);
    let mut plain = parts.next().unwrap_or_default().to_string();
    for part in parts {
        match part.split_once(')') {
            Some((number, rest)) if number.bytes().all(|digit| digit.is_ascii_digit()) => plain.push_str(rest),
            _ => plain.extend([BEFORE, part]),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::os::fd::AsRawFd;

    use super::*;

    #[test]
    fn a_pipe_of_the_shell_is_read_to_its_end() {
        let open = || {
            let (reader, mut writer) = std::io::pipe().expect("there are pipes");
            writer.write_all(b"MW2\n1\n").expect("it is open");
            reader
        };
        let (first, second) = (open(), open());
        let path = |reader: &std::io::PipeReader| format!("/dev/fd/{}", reader.as_raw_fd());
        assert_eq!(read(Path::new(&path(&first)), 6).expect("it has 6 bytes"), b"MW2\n1\n");
        let error = read(Path::new(&path(&second)), 5).expect_err("it has more");
        assert_eq!(error.to_string(), "the file has more than 0 MB");
        assert!(read(Path::new("/dev/zero"), 5).is_err());
    }

    #[test]
    fn numbers_of_errors_are_left_out() {
        assert_eq!(without_numbers("a.rec: No such file (os error 2)"), "a.rec: No such file");
        assert_eq!(without_numbers("a (os error 13) at b (os error x)"), "a at b (os error x)");
        assert_eq!(without_numbers("a.rec"), "a.rec");
    }
}
