//! The committed table of costs.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::Command;

use super::{Cost, Row};
use crate::root;

/// Where the table is.
pub fn path() -> PathBuf {
    root().join("docs/benchmarks/instructions.csv")
}

/// A cost may be worse by this part of it, if that is at least [`SLACK`].
const PART: f64 = 0.03;

/// So many instructions or bytes are not worse.
const SLACK: f64 = 1.0;

/// Versions of the compiler that made the runtime and of the C library: they decide how many instructions the runtime has.
pub fn versions() -> String {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let first_line = |mut command: Command| {
        let output = command.output().map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
        output.ok().and_then(|text| text.lines().next().map(str::to_string)).unwrap_or_else(|| "unknown".to_string())
    };
    let (mut rust, mut library) = (Command::new(rustc), Command::new("getconf"));
    rust.arg("--version");
    library.arg("GNU_LIBC_VERSION");
    format!("{}, {}", first_line(rust), first_line(library))
}

const HEAD: &str = "set,row,sequence,instructions,called,bytes,ns";

/// The table as text.
pub fn text(costs: &[(Row, Cost)]) -> String {
    let mut text = format!("# {}; one decimal: the average of 16 scans with other values\n{HEAD}\n", versions());
    for (row, cost) in costs {
        let Cost { own, called, bytes, time } = cost;
        let sequence = row.sequence.replace('"', "\"\"");
        writeln!(text, "{},\"{}\",\"{sequence}\",{own:.1},{called:.1},{bytes},{time:.1}", row.set, row.name)
            .expect("a string takes all");
    }
    text
}

/// What got worse, a line each. Instructions that are called count only if the table was made with the same versions.
pub fn worse(table: &str, costs: &[(Row, Cost)]) -> Vec<String> {
    let same_versions = table.starts_with(&format!("# {};", versions()));
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let mut wrong = Vec::new();
    if lines.next() != Some(HEAD) {
        wrong.push("the table has other columns".to_string());
        return wrong;
    }
    let lines: Vec<&str> = lines.collect();
    for (row, cost) in costs {
        let start = format!("{},\"{}\",\"{}\",", row.set, row.name, row.sequence.replace('"', "\"\""));
        let Some(line) = lines.iter().find_map(|line| line.strip_prefix(&start)) else {
            wrong.push(format!("{}: it is not in the table, or with another sequence", row.key()));
            continue;
        };
        let before: Vec<f64> = line.split(',').filter_map(|number| number.parse().ok()).collect();
        let &[own, called, bytes, _] = before.as_slice() else {
            wrong.push(format!("{}: not four numbers: {line}", row.key()));
            continue;
        };
        let called = if same_versions { (called, cost.called) } else { (0.0, 0.0) };
        let columns = [("instructions", (own, cost.own)), ("called", called), ("bytes", (bytes, cost.bytes as f64))];
        for (name, (before, after)) in columns {
            let more = after - before;
            if more > PART * before.abs() && more >= SLACK {
                wrong.push(format!("{}: {name} from {before} to {after:.1}", row.key()));
            }
        }
    }
    for line in &lines {
        let known = |(row, _): &(Row, Cost)| line.starts_with(&format!("{},\"{}\",", row.set, row.name));
        if !costs.iter().any(known) {
            wrong.push(format!("there is no such row any more: {line}"));
        }
    }
    wrong
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(own: f64, called: f64, bytes: u64) -> Vec<(Row, Cost)> {
        vec![(Row::new("STL", "AddI", "L MW 0; +I"), Cost { own, called, bytes, time: 1.0 })]
    }

    #[test]
    fn worse_rows_are_named_and_better_ones_are_not() {
        let table = text(&row(100.0, 50.0, 200));
        for fine in [row(100.0, 50.0, 200), row(103.0, 51.0, 206), row(90.0, 40.0, 100)] {
            assert_eq!(worse(&table, &fine), [""; 0]);
        }
        assert_eq!(worse(&table, &row(104.0, 50.0, 200)), ["STL AddI: instructions from 100 to 104.0"]);
        assert_eq!(worse(&table, &row(100.0, 52.0, 200)), ["STL AddI: called from 50 to 52.0"]);
        assert_eq!(worse(&table, &row(100.0, 50.0, 207)), ["STL AddI: bytes from 200 to 207.0"]);
        // One instruction more is more than 3 % of few, less than one is not.
        let small = text(&row(3.0, 0.0, 10));
        assert_eq!(worse(&small, &row(3.9, 0.0, 10)), [""; 0]);
        assert_eq!(worse(&small, &row(4.0, 0.0, 10)).len(), 1);
    }

    #[test]
    fn rows_of_the_table_and_of_the_program_are_the_same() {
        let other = vec![(Row::new("STL", "SubI", "L MW 0; -I"), Cost::default())];
        let wrong = worse(&text(&row(1.0, 0.0, 1)), &other);
        assert_eq!(wrong.len(), 2, "{wrong:?}");
    }

    #[test]
    fn the_runtime_counts_only_with_the_same_versions() {
        let table = text(&row(10.0, 50.0, 20)).replacen(&versions(), "rustc 0.1.0, glibc 2.0", 1);
        assert_eq!(worse(&table, &row(10.0, 500.0, 20)), [""; 0]);
    }
}
