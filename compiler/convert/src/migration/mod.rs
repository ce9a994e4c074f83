//! Which parts of a program another CPU has, which it has in another form, and which it lacks, with their lines.
//!
//! Each topic is one table: instructions, system functions, organization blocks, memory, interrupt events. [`s7200`]
//! has those from the S7-200 to the S7-1200, [`s7300`] those from the S7-300/400 to the S7-1500. Whatever no table
//! names is reported as such.

mod s7200;
mod s7300;

use std::collections::BTreeMap;

use plcc_abi::image::Family;
use plcc_diag::{SourceMap, Span};
use plcc_model::Program;
use plcc_xref::Reference;

/// Where a program goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Migration {
    /// From the S7-200.
    S71200,
    /// From the S7-300/400.
    S71500,
}

impl Migration {
    /// The migration to a family of CPUs from that of a program. `Err`: why there is none.
    pub fn of(to: Family, program: &Program) -> Result<Migration, String> {
        match (program.profile.family, to) {
            (Family::S7200, Family::S71200) => Ok(Migration::S71200),
            (Family::S7300 | Family::S7400, Family::S71500) => Ok(Migration::S71500),
            (Family::S7200, _) => Err("a program of an S7-200 goes to an S7-1200".to_string()),
            (Family::S7300 | Family::S7400, _) => Err("a program of an S7-300/400 goes to an S7-1500".to_string()),
            (Family::S71200 | Family::S71500, _) => {
                Err("there are reports for programs of the S7-200 and of the S7-300/400".to_string())
            }
        }
    }

    const fn title(self) -> &'static str {
        match self {
            Migration::S71200 => "S7-200 to S7-1200",
            Migration::S71500 => "S7-300/400 to S7-1500",
        }
    }
}

/// What becomes of something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Fate {
    /// The CPU has nothing like it.
    Lost,
    /// No table says.
    Unknown,
    /// The CPU has it in another form.
    Changes,
    Carries,
}

/// A fate with what to do, or what is different; empty where nothing is.
pub type Verdict = (Fate, &'static str);

/// Something that a program uses.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub fate: Fate,
    /// As the program names it: `NETR`, `SFC 20 BLKMOV`, `OB 85`, `SMB34`.
    pub what: String,
    pub note: &'static str,
    /// In the order of the text, each line once.
    pub places: Vec<Place>,
}

/// A line of a source.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    pub file: String,
    /// From 1.
    pub line: u32,
    /// The line without its comment and outer blanks.
    pub text: String,
}

/// What becomes of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    pub title: &'static str,
    pub program: String,
    /// What is lost first, then by what it is.
    pub rows: Vec<Row>,
}

/// Looks at a program that is bound without errors.
pub fn report(migration: Migration, program: &Program, reference: &Reference, sources: &SourceMap) -> Report {
    let mut rows = Rows { sources, found: BTreeMap::new() };
    match migration {
        Migration::S71200 => s7200::collect(program, reference, &mut rows),
        Migration::S71500 => s7300::collect(program, reference, &mut rows),
    }
    let rows = rows.found.into_iter().map(|((fate, what), (note, mut places))| {
        places.sort();
        places.dedup();
        Row { fate, what, note, places }
    });
    Report { title: migration.title(), program: program.name.clone(), rows: rows.collect() }
}

/// The rows of a report, as they are found.
struct Rows<'s> {
    sources: &'s SourceMap,
    found: BTreeMap<(Fate, String), (&'static str, Vec<Place>)>,
}

impl Rows<'_> {
    fn add(&mut self, what: impl Into<String>, (fate, note): Verdict, place: Place) {
        self.found.entry((fate, what.into())).or_insert_with(|| (note, Vec::new())).1.push(place);
    }

    fn at(&self, span: Span) -> Place {
        let file = self.sources.file(span.file);
        let line = file.line(span.start);
        Place { file: file.name.clone(), line, text: shown(file.line_text(line)) }
    }

    /// The places of the uses of an operand.
    fn uses(&mut self, what: &str, verdict: Verdict, uses: &[plcc_xref::Use]) {
        for one in uses {
            let place = Place { file: one.file.clone(), line: one.line, text: one.statement.clone() };
            self.add(what, verdict, place);
        }
    }
}

fn shown(line: &str) -> String {
    line.split("//").next().unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Column where notes begin.
const NOTE: usize = 16;

/// Characters of a line of names.
const WIDTH: usize = 100;

impl Report {
    /// The report for people.
    pub fn text(&self) -> String {
        let mut out = format!("{}: {}\n", self.title, self.program);
        for (fate, heading) in [
            (Fate::Lost, "Has no counterpart"),
            (Fate::Unknown, "Is in no table of plcc: look it up"),
            (Fate::Changes, "Is different"),
        ] {
            let rows: Vec<&Row> = self.rows.iter().filter(|row| row.fate == fate).collect();
            if rows.is_empty() {
                continue;
            }
            out.push_str(&format!("\n{heading}\n"));
            for row in rows {
                let gap = if row.note.is_empty() { String::new() } else { format!("  {}", row.note) };
                out.push_str(format!("  {:NOTE$}{gap}", row.what).trim_end());
                out.push('\n');
                for place in &row.places {
                    let line = format!("      {}:{}  {}", place.file, place.line, place.text);
                    out.push_str(line.trim_end());
                    out.push('\n');
                }
            }
        }
        let (plain, noted): (Vec<&Row>, Vec<&Row>) =
            self.rows.iter().filter(|row| row.fate == Fate::Carries).partition(|row| row.note.is_empty());
        if !plain.is_empty() || !noted.is_empty() {
            out.push_str("\nCarries over (in so many lines)\n");
        }
        let mut line = String::from(" ");
        for (at, row) in plain.iter().enumerate() {
            let end = if at + 1 == plain.len() { "" } else { "," };
            let item = format!(" {} ({}){end}", row.what, row.places.len());
            if line.chars().count() + item.chars().count() > WIDTH {
                out.push_str(&format!("{line}\n"));
                line = String::from(" ");
            }
            line.push_str(&item);
        }
        if !plain.is_empty() {
            out.push_str(&format!("{line}\n"));
        }
        for row in noted {
            let what = format!("{} ({})", row.what, row.places.len());
            out.push_str(&format!("  {what:NOTE$}  {}\n", row.note));
        }
        let count = |fate: Fate| self.rows.iter().filter(|row| row.fate == fate).count();
        out.push_str(&format!(
            "\nCarries over: {}; is different: {}; has no counterpart: {}; unknown: {}\n",
            count(Fate::Carries),
            count(Fate::Changes),
            count(Fate::Lost),
            count(Fate::Unknown)
        ));
        out
    }
}
