//! What the page and the server tell each other, as JSON.

use plcc_abi::services::Role;
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
    },
    /// Change a value once, at the cycle control point.
    Modify {
        name: String,
        value: String,
    },
    /// From now on tell what the statements of this block see, and of no other; `None`: of none.
    Status {
        block: Option<String>,
        /// One of the calls that were told; `None`: the first one in a cycle.
        #[serde(default)]
        call: Option<String>,
    },
    /// From now on count the runs of organization blocks; no block is watched then.
    Obs,
    /// Records values in every cycle; without names no more.
    Trace(Wanted),
    /// Give an input or output a fixed value.
    Force {
        name: String,
        value: String,
    },
    /// End the forcing of a value; without a name that of all.
    Unforce {
        name: Option<String>,
    },
    Stop,
    /// A restart by one of the words `warm`, `cold`.
    Run {
        restart: String,
    },
}

/// What the server tells. Fields without news are left out.
#[derive(Debug, Default, Serialize)]
pub struct News {
    /// Once, at first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hello: Option<Hello>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state: Option<State>,
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
    /// What the recording has that was not told yet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trace: Option<Part>,
    /// The forced values, when they have changed: name and value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub forced: Option<Vec<(String, String)>>,
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
    pub role: Role,
    /// The program has code with probes.
    pub watchable: bool,
}

/// State of the CPU.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct State {
    pub running: bool,
    /// Why it is in STOP.
    pub reason: String,
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
}

/// An event of the diagnostic buffer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Entry {
    pub clock: f64,
    pub event: u16,
    pub text: String,
    pub place: String,
}
