//! Instructions of each function, from the output of callgrind.

use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::kernels;

/// Instructions of a function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counted {
    /// Its own.
    pub own: u64,
    /// Those of all functions that it calls, and that they call.
    pub called: u64,
}

/// Runs a command under callgrind. Errors: what it printed, if it fails.
pub fn count(command: &Command, folder: &Path) -> Result<HashMap<String, Counted>, String> {
    let out = folder.join("callgrind.out");
    let mut counted = Command::new("valgrind");
    // Symbols are found before the program starts, not at the first call.
    counted
        .env("LD_BIND_NOW", "1")
        // The C library chooses its functions by the processor; those of the baseline are the same everywhere.
        .env(
            "GLIBC_TUNABLES",
            "glibc.cpu.hwcaps=-AVX,-AVX2,-AVX512F,-AVX512VL,-FMA,-FMA4,-ERMS,-FSRM,-AVX_Fast_Unaligned_Load",
        )
        .args(["--tool=callgrind", "--combine-dumps=yes"])
        .arg(format!("--callgrind-out-file={}", out.display()))
        .arg(command.get_program())
        .args(command.get_args());
    kernels::finished(&mut counted)?;
    Ok(functions(&fs::read_to_string(&out).map_err(|error| error.to_string())?))
}

/// The functions in a file of callgrind, whose format is in the manual of valgrind: after `fn=` the lines of a function, a number and a
/// cost each; after `calls=` one line with the cost of a call.
fn functions(text: &str) -> HashMap<String, Counted> {
    let mut names: HashMap<&str, String> = HashMap::new();
    let mut found: HashMap<String, Counted> = HashMap::new();
    let (mut function, mut is_call) = (String::new(), false);
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("fn=").or_else(|| line.strip_prefix("cfn=")) {
            // `(12) name` the first time, `(12)` then.
            let (number, name) = name.split_once(' ').unwrap_or((name, ""));
            if !name.is_empty() {
                names.insert(number, name.to_string());
            }
            if line.starts_with("fn=") {
                function = names.get(number).cloned().unwrap_or_default();
            }
        } else if line.starts_with("calls=") {
            is_call = true;
        } else if line.starts_with(|c: char| c.is_ascii_digit() || "+-*".contains(c)) {
            let cost = line.split_whitespace().nth(1).and_then(|cost| cost.parse().ok()).unwrap_or(0);
            let counted = found.entry(function.clone()).or_default();
            if std::mem::take(&mut is_call) { counted.called += cost } else { counted.own += cost }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_of_calls_are_told_apart() {
        let text = "positions: line\nevents: Ir\n\nfn=(1) plcc_FC1\n4 10\n+1 5\ncfn=(2) memset\ncalls=3 0\n* 90\n+2 1\n\nfn=(2)\n0 90\n\n\
                    fn=(1)\n9 2\ntotals: 198\n";
        let found = functions(text);
        assert_eq!(found["plcc_FC1"], Counted { own: 18, called: 90 });
        assert_eq!(found["memset"], Counted { own: 90, called: 0 });
    }
}
