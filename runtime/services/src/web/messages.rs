//! What the page and the server tell each other, as JSON.

use plcc_abi::services::Role;
use plcc_runtime::watch::Trigger;
use plcc_runtime::watch::format::Format;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::status::Status;
use super::trace::{Part, Wanted};

/// An order of the page.
#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "lowercase", deny_unknown_fields)]
pub enum Order {
    /// From now on tell these values, and no others.
    Watch {
        names: Vec<String>,
        /// The format of each name; null or nothing: by its type.
        #[serde(default)]
        formats: Vec<Option<Format>>,
    },
    /// Change a value once, at the cycle control point.
    Modify(Change),
    /// Change values at one cycle control point, all or none.
    All {
        rows: Vec<Change>,
    },
    /// Modify values in the cycle from now on, and no others; without rows none.
    Job {
        rows: Vec<JobRow>,
    },
    /// From now on tell what the statements of this block see, and of no other; `None`: of none.
    Status {
        block: Option<String>,
        /// One of the calls that the page has got; `None`: the first one in a cycle.
        #[serde(default)]
        call: Option<String>,
        /// Comes back with the values, so that values of an earlier block are recognised.
        #[serde(default)]
        turn: u64,
    },
    /// From now on count the runs of organization blocks; no block is watched then.
    Obs,
    /// Record values in every cycle; without names, end the recording.
    Trace(Wanted),
    /// Give an input or output a fixed value.
    Force(Change),
    /// End the forcing of a value; without a name that of all.
    Unforce {
        name: Option<String>,
    },
    Stop,
    /// Outputs in STOP: enable them for what this page modifies, or disable them for every page.
    Outputs {
        enable: bool,
    },
    /// Memory reset, in STOP.
    Reset,
    /// A restart by one of the words `warm`, `cold`.
    Run {
        restart: String,
    },
}

/// A value that something gets.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    pub name: String,
    pub value: String,
    /// `None`: as its type is written.
    #[serde(default)]
    pub format: Option<Format>,
}

/// A value that is written in the cycle.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JobRow {
    pub name: String,
    pub value: String,
    #[serde(default)]
    pub format: Option<Format>,
    pub trigger: Trigger,
    /// In each cycle, else once.
    pub every: bool,
}

/// What the server tells. Fields that have not changed are left out.
#[derive(Debug, Default, Serialize)]
pub struct News {
    /// Once, at first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hello: Option<Hello>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state: Option<State>,
    /// How many lists of names the page has sent so far: numbers of names are those of the last one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub list: Option<u64>,
    /// Values that have changed: number in the list of watched names, and value.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub values: Vec<(usize, Shown)>,
    /// Names that mean nothing: number in the list, and why.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub wrong: Vec<(usize, String)>,
    /// The diagnostic buffer, newest first, when it has changed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub buffer: Option<Vec<Entry>>,
    /// What a block sees, when something of it is new.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub status: Option<Status>,
    /// What the recording has that the page has not got yet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trace: Option<Part>,
    /// The forced values, when they have changed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub forced: Option<Vec<Forced>>,
    /// Numbers of the watched names that have forced bits, when they have changed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub marked: Option<Vec<usize>>,
    /// Number of values that the job of the page still writes, when it has changed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub job: Option<usize>,
    /// Why an order was not carried out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
}

/// Who speaks.
#[derive(Clone, Debug, Serialize)]
pub struct Hello {
    pub program: String,
    pub cpu: String,
    pub user: String,
    /// What the user may do here.
    pub role: Role,
    /// That is less than the role of the user, by the right of the computer.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub limited: bool,
    /// When this process began to serve pages, in nanoseconds since 1970: another one has another number.
    pub started: String,
    /// The program has code with probes.
    pub watchable: bool,
    /// Values that this CPU forces at most; of an S7-200 without those of digital inputs and outputs.
    pub force_max: usize,
    /// Forcing is at the modules, direct access to them included.
    pub force_modules: bool,
    /// What it forces, in words.
    pub force_areas: &'static str,
    /// It has a cold restart besides the warm one.
    pub has_cold: bool,
    /// It has a memory reset.
    pub has_reset: bool,
}

/// A forced value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Forced {
    pub name: String,
    pub value: String,
    pub address: String,
    pub format: Option<Format>,
    #[serde(skip_serializing_if = "String::is_empty")]
    pub comment: String,
}

/// State of the CPU.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct State {
    pub running: bool,
    /// Why it is in STOP.
    pub reason: String,
    /// Outputs are enabled nevertheless.
    pub outputs: bool,
    pub cycle: u64,
    /// How often the program was changed while it ran.
    pub generation: u64,
    /// Time of day in milliseconds since 1970.
    pub clock: f64,
}

/// A value as JSON, as text, and its type.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shown {
    pub value: Value,
    pub text: String,
    #[serde(rename = "type")]
    pub ty: &'static str,
    /// Its width, if it can have other formats; else 0.
    pub bits: u32,
    /// This CPU can force it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub forcible: bool,
}

/// A value as JSON that no browser rounds: whole numbers of more than 53 bits are texts.
pub fn exact(value: Value) -> Value {
    const EXACT: u64 = 1 << 53;
    match &value {
        Value::Number(number) => match (number.as_i64(), number.as_u64()) {
            (Some(whole), _) if whole.unsigned_abs() > EXACT => whole.to_string().into(),
            (None, Some(whole)) if whole > EXACT => whole.to_string().into(),
            _ => value,
        },
        _ => value,
    }
}

/// An event of the diagnostic buffer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Entry {
    pub clock: f64,
    pub event: u16,
    pub text: String,
    pub place: String,
}
