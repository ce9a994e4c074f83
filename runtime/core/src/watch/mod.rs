//! Watch tables: values by their formats, and values that are modified at the beginning or the end of a cycle.
//!
//! [`format`](mod@format) has the display formats, [`sheet`] the text of a table. That is a TOML file:
//!
//! ```toml
//! [[row]]
//! address = "MW10"          # or a name
//! format = "dec"            # default: by the declared type, else bool and hex
//! comment = "Speed"
//! modify = "50"             # a value, by the format or with a prefix
//! trigger = "begin"         # before the program, with the inputs read; or "end", before the outputs are written
//! every-cycle = true        # default: once
//! cycle = 3                 # the first cycle, default 1
//!
//! [trace]                   # records signals in the cycles in which they change
//! file = "start.csv"        # or .vcd, .html
//! signals = ["MW10", "Motor"]
//! trigger = "MW10"          # one of the signals; default: the trace begins at once
//! level = 50                # default 1, of a falling edge 0
//! edge = "rising"           # or "falling"
//! samples = 1000            # default 100000
//! before = 100              # of these from before the trigger, default 0
//! ```

pub mod format;
pub mod sheet;

use std::path::Path;

use plcc_abi::ProgramImage;
use plcc_abi::image::AssertType;
use serde::{Deserialize, Serialize};

use crate::address::{Address, Place, Width};
use crate::assertion::Value as TypedValue;
use crate::cpu::Cpu;
use crate::files;
use crate::monitor::recording;
use crate::names;
use crate::signal::{Signal, Source, Value};
use crate::trace::triggered::Wanted;
use format::Format;
use sheet::{Edge, RowText, TraceText};

/// When a value is modified.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trigger {
    /// After the inputs were read, before the program runs.
    #[default]
    Begin,
    /// After the program, before the outputs are written.
    End,
}

/// A row of a table.
#[derive(Clone, Debug)]
struct Row {
    name: String,
    source: Source,
    address: Address,
    /// `None`: by the declared type.
    format: Option<Format>,
    comment: String,
    modify: Option<Modify>,
}

/// When a value is written.
#[derive(Clone, Debug)]
struct Modify {
    value: Written,
    trigger: Trigger,
    every_cycle: bool,
    cycle: u64,
}

/// A value that is written.
#[derive(Clone, Debug)]
enum Written {
    Bits(u64),
    /// A text or a DTL.
    Long(Value),
}

/// A watch table.
#[derive(Clone, Debug)]
pub struct Table {
    rows: Vec<Row>,
    trace: Option<Wanted>,
}

impl Table {
    /// Reads the file of a table. `Err`: the error with its place.
    pub fn read(path: &Path, cpu: &Cpu) -> Result<Table, String> {
        let name = path.display();
        let text = files::regular(path).and_then(|()| std::fs::read_to_string(path));
        let text = text.map_err(|error| format!("{name}: {error}"))?;
        Table::parse(&text, cpu).map_err(|(offset, message)| {
            let line = text.get(..offset).map_or(1, |before| before.matches('\n').count() + 1);
            format!("{name}:{line}: {message}")
        })
    }

    /// Reads the text of a table. `Err`: the offset and the error.
    pub fn parse(text: &str, cpu: &Cpu) -> Result<Table, (usize, String)> {
        let file = sheet::parse(text)?;
        let rows = file.row.into_iter().map(|row| {
            let offset = row.address.span().start;
            Row::new(row, &cpu.image, cpu).map_err(|message| (offset, message))
        });
        let rows = rows.collect::<Result<_, _>>()?;
        let trace = file.trace.map(|text| {
            let offset = text.span().start;
            trace(text.into_inner(), cpu).map_err(|message| (offset, message))
        });
        Ok(Table { rows, trace: trace.transpose()? })
    }

    /// What the table records.
    pub fn trace(&self) -> Option<&Wanted> {
        self.trace.as_ref()
    }

    /// Writes the values that are due at a trigger of a cycle. Of rows that overlap the last one counts.
    pub fn modify(&self, cpu: &Cpu, cycle: u64, trigger: Trigger) {
        for row in &self.rows {
            let Some(modify) = row.modify.as_ref().filter(|modify| modify.trigger == trigger) else { continue };
            if cycle == modify.cycle || modify.every_cycle && cycle > modify.cycle {
                // Checked when the table was read; a DB may be gone.
                let _ = match &modify.value {
                    Written::Bits(bits) => cpu.modify(&row.address, *bits),
                    Written::Long(value) => row.source.write(cpu, value),
                };
            }
        }
    }

    /// The rows with their values now.
    pub fn shown(&self, cpu: &Cpu) -> Vec<Shown> {
        let value = |row: &Row| match row.format {
            Some(format) => format.show_at(cpu.read(&row.address), &row.address),
            None => row.source.read(cpu, None).text(),
        };
        let shown = |row: &Row| Shown {
            address: row.name.clone(),
            value: value(row),
            modified: row.modify.is_some(),
            comment: row.comment.clone(),
        };
        self.rows.iter().map(shown).collect()
    }

    /// The table for people.
    pub fn text(&self, cpu: &Cpu) -> String {
        let rows = self.shown(cpu);
        let last = cpu.cycle_number();
        let mark = |row: &Row| match &row.modify {
            None => String::new(),
            Some(modify) if last > 0 && modify.cycle > last => format!("cycle {} has not come", modify.cycle),
            Some(_) => "modified".to_string(),
        };
        let width = |of: &dyn Fn(&Shown) -> usize| rows.iter().map(of).max().unwrap_or(0);
        let (names, values) = (width(&|row| row.address.chars().count()), width(&|row| row.value.chars().count()));
        let line = |(row, shown): (&Row, &Shown)| {
            let mark = mark(row);
            let line = format!("{:names$}  {:values$}  {mark:8}  {}", shown.address, shown.value, shown.comment);
            format!("{}\n", line.trim_end())
        };
        self.rows.iter().zip(&rows).map(line).collect()
    }
}

/// What `[trace]` wants. `Err`: the error.
fn trace(text: TraceText, cpu: &Cpu) -> Result<Wanted, String> {
    let signal = |name: &String| {
        let source = Source::find(name, &cpu.image, None)?;
        source.check(cpu).map_err(|message| format!("{name}: {message}"))?;
        Ok::<_, String>(Signal { name: name.clone(), source })
    };
    let signals: Vec<Signal> = text.signals.iter().map(signal).collect::<Result<_, _>>()?;
    let is_again = |(at, name): (usize, &String)| text.signals[..at].contains(name).then(|| name.clone());
    // More signals than there may be are refused below.
    if let Some(name) = text.signals.iter().enumerate().take(recording::SIGNALS_MAX).find_map(is_again) {
        return Err(format!("{name} is in the signals twice: name it once"));
    }
    let trigger = match &text.trigger {
        Some(name) => {
            let signal = signals.iter().position(|signal| signal.name == *name);
            let signal =
                signal.ok_or_else(|| format!("the trigger {name} is not one of the signals: add it to them"))?;
            let rising = text.edge.unwrap_or(Edge::Rising) == Edge::Rising;
            // A bit rises to 1, and falls to 0.
            let level = text.level.unwrap_or(if rising { 1.0 } else { 0.0 });
            if let Some((low, high)) = range(&signals[signal].source)
                && (level < low || level > high || level == if rising { low } else { high })
            {
                let does = if rising { "rise" } else { "fall" };
                return Err(format!("{name} cannot {does} to {level}: its values are {low} to {high}"));
            }
            Some(recording::Trigger { signal, level, rising })
        }
        None if text.level.is_some() || text.edge.is_some() || text.before > 0 => {
            return Err("`level`, `edge` and `before` belong to a `trigger`: name the signal".to_string());
        }
        None => None,
    };
    let wanted = Wanted { file: text.file, signals, trigger, samples: text.samples, before: text.before };
    wanted.check()?;
    Ok(wanted)
}

/// The lowest and the highest value of a signal that is a bit or a whole number.
fn range(source: &Source) -> Option<(f64, f64)> {
    let unsigned = |bits: u8| (0.0, f64::from(bits).exp2() - 1.0);
    match source {
        Source::Bits(address) => Some(unsigned(address.width.bits() as u8)),
        Source::Typed(_, ty) => match ty.ty {
            AssertType::Bool => Some(unsigned(1)),
            AssertType::Bits(bits) | AssertType::Unsigned(bits) => Some(unsigned(bits)),
            AssertType::Signed(bits) => {
                let half = (f64::from(bits) - 1.0).exp2();
                Some((-half, half - 1.0))
            }
            AssertType::Real
            | AssertType::Lreal
            | AssertType::Char
            | AssertType::Wchar
            | AssertType::S5Time
            | AssertType::Time
            | AssertType::Ltime
            | AssertType::Date
            | AssertType::TimeOfDay
            | AssertType::Ltod
            | AssertType::Ldt
            | AssertType::DateAndTime
            | AssertType::Dtl
            | AssertType::Text
            | AssertType::WideText => None,
        },
        Source::Channel(..)
        | Source::Plant(_)
        | Source::PulseDuty(_)
        | Source::PulsePeriod(_)
        | Source::PulseCount(_) => None,
    }
}

/// A value for an address of the program; whether that exists on the CPU is checked elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct Settled {
    pub address: Address,
    pub bits: u64,
}

impl Settled {
    /// Finds a place by name, and reads a value for it as in a row of a table. `Err`: the error.
    pub fn find(name: &str, value: &str, format: Option<Format>, image: &ProgramImage) -> Result<Settled, String> {
        let place = Located::find(name, format, image)?;
        Ok(Settled { address: place.address, bits: place.bits(value, image)? })
    }
}

/// As [`Settled::find`], of an address that exists.
pub(crate) fn settle(name: &str, value: &str, format: Option<Format>, cpu: &Cpu) -> Result<Settled, String> {
    let place = Located::find(name, format, &cpu.image)?;
    cpu.check_address(&place.address)?;
    let bits = place.bits(value, &cpu.image).map_err(|message| format!("{name}: {message}"))?;
    cpu.name_input(&place.address);
    Ok(Settled { address: place.address, bits })
}

/// Where a row is, and how its values are written.
#[derive(Clone, Copy, Debug)]
struct Located {
    source: Source,
    address: Address,
    /// `None`: by the declared type.
    format: Option<Format>,
}

impl Located {
    fn find(name: &str, format: Option<Format>, image: &ProgramImage) -> Result<Located, String> {
        let source = match names::find(name, image) {
            Ok(named) => Source::of(named),
            // `MW10 as INT`; what has a unit is not bits.
            Err(wrong) => match Source::find(name, image, None) {
                Ok(source @ Source::Typed(..)) => source,
                Ok(_) | Err(_) => return Err(wrong),
            },
        };
        let address = *source.address().ok_or_else(|| format!("{name} has no address"))?;
        let format = match format {
            Some(format) => Some(format.check(name, &source, address.width)?),
            None if matches!(source, Source::Bits(_)) => Some(Format::usual(address.width)),
            None => None,
        };
        Ok(Located { source, address, format })
    }

    fn bits(&self, text: &str, image: &ProgramImage) -> Result<u64, String> {
        match self.written(text, image)? {
            Written::Bits(bits) => Ok(bits),
            Written::Long(_) => Err(format!("a value of type {} has more than 64 bits", self.source.ty())),
        }
    }

    fn written(&self, text: &str, image: &ProgramImage) -> Result<Written, String> {
        self.address.check_settable()?;
        if let Some(format) = self.format {
            let bits = format.parse_at(text, &self.address)?;
            return self.address.check_value(bits).map(|()| Written::Bits(bits));
        }
        let value = self.source.parse(text, image)?;
        match self.source.bits(&value) {
            Some(bits) => Ok(Written::Bits(bits)),
            None if matches!(self.address.place, Place::Input(_)) => {
                Err(format!("a row cannot modify inputs as a value of type {}", self.source.ty()))
            }
            None => Ok(Written::Long(value)),
        }
    }
}

impl Written {
    /// Bytes of a text or DTL in memory.
    fn long_bytes(&self, cpu: &Cpu) -> Option<usize> {
        match self {
            Written::Long(Value::Typed(AssertType::WideText, TypedValue::Text(text))) => Some(4 + 2 * text.len()),
            Written::Long(Value::Typed(_, TypedValue::Text(text))) => {
                Some(text.len() + if cpu.s7200.is_some() { 1 } else { 2 })
            }
            Written::Long(Value::Typed(_, TypedValue::Bytes(bytes))) => Some(bytes.len()),
            Written::Long(_) | Written::Bits(_) => None,
        }
    }
}

/// A row as it is shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shown {
    pub address: String,
    pub value: String,
    /// The table writes the value.
    pub modified: bool,
    pub comment: String,
}

impl Row {
    fn new(row: RowText<toml::Spanned<String>>, image: &ProgramImage, cpu: &Cpu) -> Result<Row, String> {
        let name = row.address.into_inner();
        let place = Located::find(&name, row.format, image)?;
        cpu.check_address(&place.address)?;
        let written = row.modify.as_ref().map(|text| place.written(text, image)).transpose();
        let written = written.map_err(|message| format!("{name}: {message}"))?;
        if let Some(bytes) = written.as_ref().and_then(|written| written.long_bytes(cpu)) {
            let last = place.address.place.offset(bytes.saturating_sub(1) as u32);
            cpu.check_address(&Address { place: last, width: Width::Byte })?;
        }
        if written.is_some() {
            // What is not modified comes from the module again.
            cpu.name_input(&place.address);
        }
        let modify =
            written.map(|value| Modify { value, trigger: row.trigger, every_cycle: row.every_cycle, cycle: row.cycle });
        let Located { source, address, format } = place;
        Ok(Row { name, source, address, format, comment: row.comment, modify })
    }
}
