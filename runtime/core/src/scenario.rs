//! Scenarios: what happens to a program from outside, and what is expected of it. TOML, see docs/testing.md.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use plcc_abi::ProgramImage;
use serde::Deserialize;
use toml::Spanned;

use crate::address::{self, Address, Bits, Place};
use crate::cpu::Cpu;
use crate::cycle::Observer;
use crate::events::{self, Event};
use crate::options::parse_duration;
use crate::testing::AssertFailure;
use crate::{report, value};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileText {
    #[serde(default)]
    at: Vec<Spanned<AtText>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AtText {
    cycle: Option<u64>,
    time: Option<Spanned<String>>,
    #[serde(default)]
    set: BTreeMap<String, Spanned<toml::Value>>,
    event: Option<Spanned<toml::Value>>,
    #[serde(default)]
    expect: BTreeMap<String, Spanned<toml::Value>>,
    #[serde(default)]
    print: Vec<Spanned<String>>,
}

/// When an entry happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    Cycle(u64),
    /// The first cycle that starts at this time, in nanoseconds, or later.
    Time(u64),
}

/// An address with a value and its place in the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    pub name: String,
    pub address: Address,
    pub value: Bits,
    pub line: u32,
}

/// An entry.
#[derive(Clone, Debug)]
pub struct At {
    pub when: When,
    pub set: Vec<Setting>,
    pub event: Option<Event>,
    pub expect: Vec<Setting>,
    pub print: Vec<(String, Address)>,
}

/// A scenario, checked against the program.
#[derive(Clone, Debug, Default)]
pub struct Scenario {
    pub file: String,
    pub entries: Vec<At>,
}

impl Scenario {
    /// Reads and checks a file. `Err`: message with file and line.
    pub fn read(path: &Path, image: &ProgramImage) -> Result<Scenario, String> {
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| format!("cannot read scenario {file}: {error}"))?;
        Scenario::parse(&file, &text, image)
    }

    /// As [`read`](Scenario::read), from text.
    pub fn parse(file: &str, text: &str, image: &ProgramImage) -> Result<Scenario, String> {
        let line =
            |offset: usize| text.as_bytes().iter().take(offset).filter(|&&byte| byte == b'\n').count() as u32 + 1;
        let raw: FileText = toml::from_str(text).map_err(|error| {
            let at = error.span().map_or(1, |span| line(span.start));
            format!("{file}:{at}: {}", in_words(error.message()))
        })?;
        let reader = Reader { file, line: &line, image };
        let entries = raw.at.into_iter().map(|entry| reader.entry(entry)).collect::<Result<_, _>>()?;
        Ok(Scenario { file: file.to_string(), entries })
    }

    /// The last cycle that an entry names, with cycles so many nanoseconds apart; `None` without entries.
    pub fn last_cycle(&self, cycle_time: u64) -> Option<u64> {
        let cycle = |at: &At| match at.when {
            When::Cycle(cycle) => cycle,
            When::Time(time) => time.div_ceil(cycle_time.max(1)) + 1,
        };
        self.entries.iter().map(cycle).max()
    }
}

struct Reader<'a> {
    file: &'a str,
    line: &'a dyn Fn(usize) -> u32,
    image: &'a ProgramImage,
}

impl Reader<'_> {
    fn error<T>(&self, offset: usize, message: &str) -> Result<T, String> {
        Err(format!("{}:{}: {message}", self.file, (self.line)(offset)))
    }

    fn entry(&self, entry: Spanned<AtText>) -> Result<At, String> {
        let start = entry.span().start;
        let entry = entry.into_inner();
        let when = match (entry.cycle, &entry.time) {
            (Some(cycle), None) => When::Cycle(cycle),
            (None, Some(time)) => match parse_duration(time.get_ref()) {
                Ok(duration) => When::Time(duration.0),
                Err(message) => return self.error(time.span().start, &message),
            },
            (None, None) => return self.error(start, "an entry needs `cycle` or `time`"),
            (Some(_), Some(_)) => return self.error(start, "an entry has either `cycle` or `time`, not both"),
        };
        let print = entry.print.iter().map(|name| {
            let found = address::resolve(name.get_ref(), self.image);
            found
                .map(|address| (name.get_ref().clone(), address))
                .or_else(|message| self.error(name.span().start, &message))
        });
        let set = self.settings(&entry.set)?;
        if let Some(cell) = set.iter().find(|one| matches!(one.address.place, Place::Timer(_) | Place::Counter(_))) {
            let message = format!("{}: timers and counters cannot be set", cell.name);
            return Err(format!("{}:{}: {message}", self.file, cell.line));
        }
        Ok(At {
            when,
            set,
            event: entry.event.map(|event| self.event(&event)).transpose()?,
            expect: self.settings(&entry.expect)?,
            print: print.collect::<Result<_, _>>()?,
        })
    }

    fn settings(&self, table: &BTreeMap<String, Spanned<toml::Value>>) -> Result<Vec<Setting>, String> {
        let mut settings = Vec::new();
        for (name, text) in table {
            let offset = text.span().start;
            let parsed = address::resolve(name, self.image).and_then(|address| {
                let value = value::parse(&scalar_text(text.get_ref())?, address.width)?;
                Ok(Setting { name: name.clone(), address, value, line: (self.line)(offset) })
            });
            settings.push(parsed.or_else(|message| self.error(offset, &format!("{name}: {message}")))?);
        }
        // In the order of the file.
        settings.sort_by_key(|setting| setting.line);
        Ok(settings)
    }

    fn event(&self, event: &Spanned<toml::Value>) -> Result<Event, String> {
        parse_event(event.get_ref()).or_else(|message| self.error(event.span().start, &message))
    }
}

/// What the TOML reader expected, without the names of its types.
fn in_words(message: &str) -> String {
    [
        ("expected u64", "expected a whole number, 0 or more"),
        ("expected a sequence", "expected a list"),
        ("expected a map", "expected a table"),
    ]
    .iter()
    .fold(message.to_string(), |text, (from, to)| text.replace(from, to))
}

/// A TOML value as the text that `value::parse` takes.
fn scalar_text(value: &toml::Value) -> Result<String, String> {
    match value {
        toml::Value::Integer(number) => Ok(number.to_string()),
        toml::Value::Boolean(bit) => Ok(u8::from(*bit).to_string()),
        toml::Value::String(text) => Ok(text.clone()),
        toml::Value::Float(number) => Ok(format!("{number:?}")),
        toml::Value::Datetime(_) | toml::Value::Array(_) | toml::Value::Table(_) => {
            Err("a value is a number, true, false, or a text as \"16#00FF\"".to_string())
        }
    }
}

/// `"OB40"`, or a table with `ob` and fields of its start information.
fn parse_event(event: &toml::Value) -> Result<Event, String> {
    let number = |name: &str| {
        let digits = name.trim().to_ascii_uppercase();
        let number = digits.strip_prefix("OB").map(str::trim).and_then(|digits| digits.parse().ok());
        number.and_then(events::usual).ok_or_else(|| {
            format!("`{name}` is no OB that an event starts; those are OB 10-17, 20-23, 30-38, 40-47, 55-57 and 80-88")
        })
    };
    match event {
        toml::Value::String(name) => number(name),
        toml::Value::Table(table) => {
            let name = table.get("ob").or_else(|| table.get("OB")).and_then(toml::Value::as_str);
            let mut event = number(name.ok_or("an event needs `ob = \"OB40\"`")?)?;
            for (key, given) in table.iter().filter(|(key, _)| !key.eq_ignore_ascii_case("ob")) {
                let field = events::find_field(event.ob, key)
                    .ok_or_else(|| format!("the start information of OB {} has no field `{key}`", event.ob))?;
                let width = match field.bytes {
                    1 => address::Width::Byte,
                    2 => address::Width::Word,
                    _ => address::Width::Dword,
                };
                let bits = value::parse(&scalar_text(given)?, width).map_err(|message| format!("{key}: {message}"))?;
                let bytes = (bits as u32).to_be_bytes();
                event.info.0[field.offset..field.offset + field.bytes].copy_from_slice(&bytes[4 - field.bytes..]);
            }
            Ok(event)
        }
        toml::Value::Integer(_)
        | toml::Value::Float(_)
        | toml::Value::Boolean(_)
        | toml::Value::Datetime(_)
        | toml::Value::Array(_) => Err("an event is a text as \"OB40\" or a table with `ob`".to_string()),
    }
}

/// Plays a scenario.
pub struct Player {
    scenario: Scenario,
    /// For each entry: the cycle in which it happened.
    happened: Vec<Option<u64>>,
    expectations_met: u64,
    failures: Vec<AssertFailure>,
    /// Where `print` goes; nowhere in tests.
    out: Option<Box<dyn Write>>,
    json: bool,
}

impl Player {
    /// Checks the addresses against the CPU and makes its inputs named. `Err`: message with file and line.
    pub fn new(scenario: Scenario, cpu: &Cpu) -> Result<Player, String> {
        for setting in scenario.entries.iter().flat_map(|at| at.set.iter().chain(&at.expect)) {
            // A DB may still be made by the program.
            if !matches!(setting.address.place, Place::Db(..)) {
                cpu.check_address(&setting.address)
                    .map_err(|message| format!("{}:{}: {}: {message}", scenario.file, setting.line, setting.name))?;
            }
        }
        for (name, address) in scenario.entries.iter().flat_map(|at| &at.print) {
            if !matches!(address.place, Place::Db(..)) {
                cpu.check_address(address).map_err(|message| format!("{}: print {name}: {message}", scenario.file))?;
            }
        }
        for setting in scenario.entries.iter().flat_map(|at| &at.set) {
            cpu.name_input(&setting.address);
        }
        let happened = vec![None; scenario.entries.len()];
        Ok(Player { scenario, happened, expectations_met: 0, failures: Vec::new(), out: None, json: false })
    }

    /// Writes what `print` asks for to `out`.
    pub fn print_to(mut self, out: Box<dyn Write>, json: bool) -> Player {
        self.out = Some(out);
        self.json = json;
        self
    }

    /// Number of `expect` values that were found so far.
    pub fn expectations_met(&self) -> u64 {
        self.expectations_met
    }

    /// What failed, with the expectations of entries that never happened. Call it at the end.
    pub fn failures(&self) -> Vec<AssertFailure> {
        let mut failures = self.failures.clone();
        for (at, _) in self.scenario.entries.iter().zip(&self.happened).filter(|(_, happened)| happened.is_none()) {
            failures.extend(at.expect.iter().map(|setting| self.failure(setting, "(not reached)".to_string())));
        }
        failures
    }

    fn failure(&self, setting: &Setting, actual: String) -> AssertFailure {
        let expected = value::text(setting.value, setting.address.width);
        AssertFailure {
            file: self.scenario.file.clone(),
            line: setting.line,
            text: format!("{} = {expected}", setting.name),
            left: actual,
            right: expected,
        }
    }
}

impl Observer for Player {
    fn before(&mut self, cpu: &Cpu, cycle: u64, time: u64) {
        for (at, happened) in self.scenario.entries.iter().zip(&mut self.happened) {
            let now = match at.when {
                When::Cycle(at) => at == cycle,
                When::Time(at) => cycle > 0 && at <= time,
            };
            if !now || happened.is_some() {
                continue;
            }
            *happened = Some(cycle);
            for setting in &at.set {
                if let Err(message) = cpu.write(&setting.address, setting.value) {
                    self.failures.push(AssertFailure {
                        file: self.scenario.file.clone(),
                        line: setting.line,
                        text: format!("{} to be set", setting.name),
                        left: message,
                        right: value::text(setting.value, setting.address.width),
                    });
                }
            }
            if let Some(event) = at.event {
                cpu.request(event);
            }
        }
    }

    fn after(&mut self, cpu: &Cpu, cycle: u64, _time: u64) {
        let due = |happened: &Option<u64>| *happened == Some(cycle);
        for index in 0..self.scenario.entries.len() {
            if !self.happened.get(index).is_some_and(due) {
                continue;
            }
            let at = &self.scenario.entries[index];
            let mut failed = Vec::new();
            for setting in &at.expect {
                let actual = cpu.read(&setting.address);
                if actual == setting.value {
                    self.expectations_met += 1;
                } else {
                    failed.push(self.failure(setting, value::text(actual, setting.address.width)));
                }
            }
            if let Some(out) = self.out.as_mut().filter(|_| !at.print.is_empty()) {
                // A closed pipe is no reason to stop a plant.
                let _ = report::write_values(cpu, &at.print, self.json, out.as_mut());
            }
            self.failures.extend(failed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
        assert_eq!(scenario.entries[0].set[1].value, 0x100);
        assert_eq!(scenario.entries[1].when, When::Time(100_000_000));
        let info = scenario.entries[1].event.unwrap().info.0;
        assert_eq!((&info[6..8], &info[8..12]), (&[0u8, 4][..], &[0u8, 0, 0, 1][..]));
        assert_eq!(scenario.last_cycle(10_000_000), Some(11));
    }

    #[test]
    fn errors_name_the_line() {
        let message = |text: &str| parse(text).unwrap_err();
        assert!(message("[[at]]\ncycle = 1\nsett = {}\n").starts_with("s.toml:3: unknown field `sett`"));
        assert_eq!(message("\n[[at]]\nset = { \"I0.0\" = 1 }\n"), "s.toml:2: an entry needs `cycle` or `time`");
        assert!(
            message("[[at]]\ncycle = 1\nset = { \"I0.9\" = 1 }\n").starts_with("s.toml:3: I0.9: `I0.9` is neither")
        );
        assert!(
            message("[[at]]\ncycle = 1\n\nset = { \"I0.0\" = 2 }\n").starts_with("s.toml:4: I0.0: `2` does not fit")
        );
        assert!(message("[[at]]\ncycle = 1\nevent = \"OB1\"\n").starts_with("s.toml:3: `OB1` is no OB"));
        assert!(message("[[at]]\ncycle = 1\nevent = { ob = \"OB40\", x = 1 }\n").contains("no field `x`"));
        assert!(message("[[at]]\ntime = \"soon\"\n").starts_with("s.toml:2: `soon` is not a time"));
        assert!(message("[[at]\n").starts_with("s.toml:1: "));
        assert!(message("[[at]]\ncycle = -1\n").ends_with("expected a whole number, 0 or more"));
        assert_eq!(
            message("[[at]]\ncycle = 1\nset = { \"T5\" = 1 }\n"),
            "s.toml:3: T5: timers and counters cannot be set"
        );
    }
}
