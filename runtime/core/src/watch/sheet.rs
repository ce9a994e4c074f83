//! The text of a watch table: as a file, and as clients exchange it.

use std::path::PathBuf;

use plcc_literal::toml_words;
use serde::{Deserialize, Serialize};

use super::Trigger;
use super::format::Format;
use crate::monitor::recording;

/// Rows of a table at most. Source: Programming with STEP 7, variable table.
pub const ROWS_MAX: usize = 1024;

/// A table as it is written. `A` and `T`: address and trace, which have their places in a file.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Sheet<A = String, T = TraceText> {
    #[serde(default = "Vec::new")]
    pub row: Vec<RowText<A>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trace: Option<T>,
}

/// A row as it is written.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct RowText<A = String> {
    pub address: A,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub format: Option<Format>,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub comment: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub modify: Option<String>,
    #[serde(default, skip_serializing_if = "is_usual")]
    pub trigger: Trigger,
    #[serde(default, skip_serializing_if = "is_usual")]
    pub every_cycle: bool,
    #[serde(default = "first_cycle", skip_serializing_if = "is_first")]
    pub cycle: u64,
}

/// What is recorded.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct TraceText {
    pub file: PathBuf,
    pub signals: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trigger: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edge: Option<Edge>,
    #[serde(default = "all_samples", skip_serializing_if = "is_all")]
    pub samples: usize,
    #[serde(default, skip_serializing_if = "is_usual")]
    pub before: usize,
}

/// How a signal crosses a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Edge {
    Rising,
    Falling,
}

const fn first_cycle() -> u64 {
    1
}

const fn all_samples() -> usize {
    recording::SAMPLES_MAX
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde gives references")]
fn is_first(cycle: &u64) -> bool {
    *cycle == first_cycle()
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde gives references")]
fn is_all(samples: &usize) -> bool {
    *samples == all_samples()
}

fn is_usual<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// A table with the places of its addresses and of its trace.
pub(super) type Placed = Sheet<toml::Spanned<String>, toml::Spanned<TraceText>>;

/// Reads the file of a table. `Err`: the offset and the error.
pub(super) fn parse(text: &str) -> Result<Placed, (usize, String)> {
    let sheet: Placed = toml::from_str(text).map_err(|error| {
        let offset = error.span().map_or(0, |span| span.start);
        let wrong = value_at_top(error.message(), text, offset)
            .unwrap_or_else(|| toml_words::plain_at(error.message(), text, offset));
        (offset, format!("{}; {}", wrong.title, wrong.help))
    })?;
    check(sheet.row.len()).map_err(|error| (0, error))?;
    if let Some(row) = sheet.row.iter().find(|row| row.cycle == 0) {
        let message = "the first cycle is 1; write `cycle = 1`, or leave `cycle` out".to_string();
        return Err((row.address.span().start, format!("{}: {message}", row.address.get_ref())));
    }
    Ok(sheet)
}

/// `"I0.0" = 1` outside of tables, where each address has a row.
fn value_at_top(message: &str, text: &str, offset: usize) -> Option<toml_words::Wrong> {
    if !message.starts_with("unknown field") || !message.contains("expected `row`") {
        return None;
    }
    let start = text.get(..offset)?.rfind('\n').map_or(0, |at| at + 1);
    let (name, value) = text.get(start..)?.lines().next()?.split(" #").next()?.split_once('=')?;
    let (name, value) = (name.trim().trim_matches(['"', '\'']), value.trim().trim_matches(['"', '\'']));
    Some(toml_words::Wrong {
        title: "each address has a table `[[row]]`".to_owned(),
        help: format!("write `[[row]]`, and below it `address = \"{name}\"` and `modify = \"{value}\"`"),
    })
}

fn check(rows: usize) -> Result<(), String> {
    match rows > ROWS_MAX {
        true => Err(format!("the table has {rows} rows; {ROWS_MAX} are possible")),
        false => Ok(()),
    }
}

impl Sheet {
    /// Reads a file without looking at a program. `Err`: the error with its line.
    pub fn read(text: &str) -> Result<Sheet, String> {
        let Sheet { row, trace } = parse(text).map_err(|(offset, message)| {
            let line = text.get(..offset).map_or(1, |before| before.matches('\n').count() + 1);
            format!("line {line}: {message}")
        })?;
        let plain = |row: RowText<toml::Spanned<String>>| RowText {
            address: row.address.into_inner(),
            format: row.format,
            comment: row.comment,
            modify: row.modify,
            trigger: row.trigger,
            every_cycle: row.every_cycle,
            cycle: row.cycle,
        };
        Ok(Sheet { row: row.into_iter().map(plain).collect(), trace: trace.map(toml::Spanned::into_inner) })
    }

    /// The text of its file. `Err`: why there is none.
    pub fn write(&self) -> Result<String, String> {
        check(self.row.len())?;
        toml::to_string(self).map_err(|error| error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_read_is_written_again() {
        let text = "[[row]]\naddress = \"MW10\"\nformat = \"dec\"\ncomment = \"Speed\"\nmodify = \"50\"\n\
                    trigger = \"end\"\nevery-cycle = true\ncycle = 3\n\n[[row]]\naddress = \"Motor\"\n\n\
                    [trace]\nfile = \"a.csv\"\nsignals = [\"MW10\"]\ntrigger = \"MW10\"\nlevel = 5.0\nedge = \"falling\"\n\
                    samples = 100\nbefore = 10\n";
        let sheet = Sheet::read(text).unwrap();
        assert_eq!(sheet.write().as_deref(), Ok(text));
        assert_eq!((sheet.row[1].trigger, sheet.row[1].every_cycle, sheet.row[1].cycle), (Trigger::Begin, false, 1));
    }

    #[test]
    fn errors_have_their_lines() {
        let error = |text: &str| Sheet::read(text).unwrap_err();
        assert!(error("[[row]]\naddress = \"MW10\"\nformat = \"octal\"\n").starts_with("line 3: "));
        assert!(error("[[row]]\naddres = \"MW10\"\n").starts_with("line 2: "));
        let no_cycle = error("[[row]]\naddress = \"MW10\"\nmodify = \"1\"\ncycle = 0\n");
        assert_eq!(no_cycle, "line 2: MW10: the first cycle is 1; write `cycle = 1`, or leave `cycle` out");
        let row =
            RowText { address: "M0.0".to_string(), ..Sheet::read("[[row]]\naddress = \"\"").unwrap().row.remove(0) };
        let sheet = Sheet { row: vec![row; ROWS_MAX + 1], trace: None };
        assert!(sheet.write().unwrap_err().contains("1025 rows"));
    }
}
