//! Files that are read as a whole or written. Pipes and endless files are refused.

use std::fs;
use std::io::{Error, Result};
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
    use super::without_numbers;

    #[test]
    fn numbers_of_errors_are_left_out() {
        assert_eq!(without_numbers("a.rec: No such file (os error 2)"), "a.rec: No such file");
        assert_eq!(without_numbers("a (os error 13) at b (os error x)"), "a at b (os error x)");
        assert_eq!(without_numbers("a.rec"), "a.rec");
    }
}
