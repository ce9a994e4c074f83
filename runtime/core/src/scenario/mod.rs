//! Scenarios: the inputs of a program over time, and its expected results. TOML, see docs/testing.md.

mod line;
mod player;
mod read;
mod trains;

use std::path::Path;

use plcc_abi::ProgramImage;
use plcc_literal::distance::nearest;

use crate::events::Event;
use crate::plant::Plant;
use crate::s7200::PulseInput;
use crate::signal::{Signal, Value};
pub use line::{Received, Sent};
pub use player::Player;

/// When an entry happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    Cycle(u64),
    /// The first cycle that starts at this time, in nanoseconds, or later.
    Time(u64),
}

/// A signal with a value and its place in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    pub signal: Signal,
    pub value: Value,
    /// How far a number may be away from `value`.
    pub tolerance: f64,
    pub line: u32,
}

/// Where pulses arrive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PulsesAt {
    /// A fast counter of an S7-1200: its place in the configuration.
    Counter(usize),
    /// An input or a high-speed counter of an S7-200.
    S7200(PulseInput),
}

/// A train of pulses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pulses {
    pub at: PulsesAt,
    /// As the file names it.
    pub name: String,
    pub line: u32,
    pub count: u64,
    /// Nanoseconds from one to the next.
    pub period: u64,
    pub backward: bool,
}

/// An entry.
#[derive(Clone, Debug)]
pub struct At {
    pub when: When,
    pub set: Vec<Setting>,
    /// Parameters and states of the plant, by number.
    pub plant: Vec<(usize, f64)>,
    pub event: Option<Event>,
    /// Where `event` is in the file; 0 without one.
    pub event_line: u32,
    /// Characters that arrive at serial ports.
    pub receive: Vec<Received>,
    /// Characters that serial ports have sent.
    pub sent: Vec<Sent>,
    pub pulses: Vec<Pulses>,
    pub expect: Vec<Setting>,
    pub print: Vec<Signal>,
}

/// A scenario, checked against the program.
#[derive(Clone, Debug, Default)]
pub struct Scenario {
    pub file: String,
    pub entries: Vec<At>,
    pub plant: Option<Plant>,
}

impl Scenario {
    /// Reads and checks a file. `Err`: message with file and line.
    pub fn read(path: &Path, image: &ProgramImage) -> Result<Scenario, String> {
        let file = path.display().to_string();
        let text = crate::files::regular(path).and_then(|()| std::fs::read_to_string(path));
        let text = text.map_err(|error| {
            let near = near(path).map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            format!("cannot read scenario {file}: {error}{near}")
        })?;
        Scenario::parse(&file, &text, image).map_err(|error| {
            // A scenario with a mistake may have any name.
            let is_toml = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
            let has_entries = || text.lines().any(|line| line.trim_start().starts_with("[["));
            match path.file_name().is_some_and(|name| name == "plc.toml") {
                true => format!("{file} has the settings of a project, and is not a scenario"),
                false if is_toml || has_entries() => error,
                false => format!("{file} is not a scenario, which is a file in TOML with entries `[[at]]`"),
            }
        })
    }

    /// As [`read`](Scenario::read), from text.
    pub fn parse(file: &str, text: &str, image: &ProgramImage) -> Result<Scenario, String> {
        read::parse(file, text, image)
    }

    /// The last cycle that an entry names, for this many nanoseconds per cycle; `None` without entries.
    pub fn last_cycle(&self, cycle_time: u64) -> Option<u64> {
        let cycle = |at: &At| match at.when {
            When::Cycle(cycle) => cycle,
            When::Time(time) => time.div_ceil(cycle_time.max(1)) + 1,
        };
        self.entries.iter().map(cycle).max()
    }
}

/// The file in the folder of `path` whose name resembles its name.
fn near(path: &Path) -> Option<String> {
    let wanted = path.file_name()?.to_string_lossy().into_owned();
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = std::fs::read_dir(folder).ok()?.flatten();
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.retain(|name| *name != wanted);
    names.sort();
    let meant = nearest(&wanted, names.iter().map(String::as_str))?;
    Some(path.with_file_name(meant).display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::address::Width;
    use crate::tests::image;

    fn parse(text: &str) -> Result<Scenario, String> {
        Scenario::parse("s.toml", text, &image(&[]))
    }

    #[test]
    fn all_keys() {
        let scenario = parse(
            "[[at]]\ncycle = 3\nset = { \"I0.0\" = 1, \"IW2\" = \"16#0100\" }\nevent = \"OB40\"\n\
             expect = { \"Q0.0\" = true }\nprint = [\"Q0.0\"]\n\
             [[at]]\ntime = \"100ms\"\nevent = { ob = \"OB40\", MDL_ADDR = 4, OB40_POINT_ADDR = \"16#1\" }\n",
        )
        .unwrap();
        assert_eq!(scenario.entries[0].when, When::Cycle(3));
        assert_eq!(scenario.entries[0].set[1].value, Value::Bits(0x100, Width::Word));
        assert_eq!(scenario.entries[1].when, When::Time(100_000_000));
        let info = scenario.entries[1].event.unwrap().info.0;
        assert_eq!((&info[6..8], &info[8..12]), (&[0u8, 4][..], &[0u8, 0, 0, 1][..]));
        assert_eq!(scenario.last_cycle(10_000_000), Some(11));
    }

    #[test]
    fn errors_name_the_line() {
        let message = |text: &str| parse(text).unwrap_err();
        assert!(
            message("[[at]]\ncycle = 1\nsett = {}\n").starts_with("s.toml:3: `sett` is not a key here; write `set`")
        );
        assert!(message("\n[[at]]\nset = { \"I0.0\" = 1 }\n").starts_with("s.toml:2: an entry says when it acts"));
        assert!(
            message("[[at]]\ncycle = 1\nset = { \"I0.9\" = 1 }\n")
                .starts_with("s.toml:3: I0.9: `I0.9` is not an address")
        );
        assert!(
            message("[[at]]\ncycle = 1\n\nset = { \"I0.0\" = 2 }\n").starts_with("s.toml:4: I0.0: `2` does not fit")
        );
        let empty = message("[[at]]\ncycle = 1\nset = { \"\" = 1 }\n");
        assert!(empty.starts_with("s.toml:3: the name is empty; write an address"), "{empty}");
        assert!(message("[[at]]\ncycle = 1\nevent = \"OB1\"\n").starts_with("s.toml:3: `OB1` is not an OB"));
        assert!(message("[[at]]\ncycle = 1\nevent = { ob = \"OB40\", x = 1 }\n").contains("no field `x`"));
        assert!(message("[[at]]\ntime = \"soon\"\n").starts_with("s.toml:2: `soon` is not a time"));
        assert!(message("[[at]\n").starts_with("s.toml:1: "));
        assert!(
            message("[[at]]\ncycle = -1\n").contains("a whole number, 0 or more, is expected here, not the number -1")
        );
        assert_eq!(
            message("[[at]]\ncycle = 1\nset = { \"T5\" = 1 }\n"),
            "s.toml:3: T5: T5 is the state of a timer, which the program alone sets; its time is T5.VALUE"
        );
    }
}
