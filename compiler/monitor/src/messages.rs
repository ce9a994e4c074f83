//! What comes and goes over the page's connection, as JSON: the part of it that is shown here. See `web/messages.rs` of the services.

use plcc_abi::services::Role;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// An order to the CPU.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "do", rename_all = "lowercase")]
pub enum Order {
    Watch {
        names: Vec<String>,
        /// The format of each name; without any: by their types.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        formats: Vec<Option<String>>,
        /// Number of the list, which comes back with its values. It is not sent.
        #[serde(skip)]
        number: u64,
    },
    Modify(Change),
    /// All of them at one moment, or none.
    All {
        rows: Vec<Change>,
    },
    Force(Change),
    Unforce {
        name: Option<String>,
    },
    Stop,
    /// Outputs in STOP: whether what is modified here reaches the modules.
    Outputs {
        enable: bool,
    },
    /// Memory reset, in STOP.
    Reset,
    Run {
        restart: String,
    },
    /// From now on tell what the statements of this block see; `None`: of none.
    Status {
        block: Option<String>,
        /// One of its calls; `None`: the first one in a cycle.
        #[serde(skip_serializing_if = "Option::is_none")]
        call: Option<String>,
        /// Comes back with what is seen.
        turn: u64,
    },
}

/// A value that something gets.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Change {
    pub name: String,
    pub value: String,
    /// `None`: as its type is written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub format: Option<String>,
}

/// What is new; what has not changed is left out.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct News {
    pub hello: Option<Hello>,
    pub state: Option<State>,
    /// The list of names that values and wrong names belong to: from the CPU how many it has got on this connection, for the model its own number.
    pub list: Option<u64>,
    /// Number in the list of watched names, and value, or why there is none.
    pub values: Vec<(usize, Shown)>,
    pub wrong: Vec<(usize, String)>,
    pub buffer: Option<Vec<Entry>>,
    pub forced: Option<Vec<Forced>>,
    pub status: Option<StatusNews>,
    pub refused: Option<String>,
}

/// What is new in a block that is watched.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct StatusNews {
    /// The number that came with the order.
    pub turn: u64,
    /// The calls that have run so far.
    pub calls: Option<Vec<String>>,
    /// Number of the call that was seen, and of its cycle.
    pub call: Option<(usize, u64)>,
    /// Number of the place, and what was seen there; null: it was not reached.
    pub seen: Vec<(usize, Value)>,
    pub steps: Option<Vec<Step>>,
    pub history: Option<Vec<Activation>>,
}

/// A step of a chart.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Step {
    pub step: String,
    pub active: bool,
    pub t_ms: Option<i32>,
    pub u_ms: Option<i32>,
    /// Its interlock is not satisfied, its supervision has found a fault.
    pub interlocked: bool,
    pub faulty: bool,
}

/// A forced value.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct Forced {
    pub name: String,
    pub value: String,
    #[serde(default)]
    pub address: String,
}

#[derive(Clone, Debug, Deserialize)]
pub struct Hello {
    pub program: String,
    pub cpu: String,
    pub role: Role,
    /// The program has code that tells what its statements see.
    #[serde(default)]
    pub watchable: bool,
    /// The CPU has a cold restart besides the warm one.
    #[serde(default)]
    pub has_cold: bool,
    /// Forcing is at the modules, direct access to them included.
    #[serde(default)]
    pub force_modules: bool,
}

#[derive(Clone, Debug, Default, Deserialize)]
pub struct State {
    pub running: bool,
    pub reason: String,
    /// Somebody has enabled the outputs of the CPU in STOP.
    #[serde(default)]
    pub outputs: bool,
    pub cycle: u64,
    /// How often the program was changed while it ran.
    #[serde(default)]
    pub generation: u64,
}

#[derive(Clone, Debug, Deserialize)]
pub struct Shown {
    pub text: String,
    #[serde(rename = "type")]
    pub ty: String,
    /// Its width, if it can have other formats; else 0.
    #[serde(default)]
    pub bits: u32,
}

/// A step that has become active: when, by the clock in milliseconds since 1970, and for how long; `None`: it is.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Activation {
    pub step: String,
    pub cycle: u64,
    pub clock_ms: i64,
    pub active_ms: Option<u64>,
}

/// An event of the diagnostic buffer; its clock in milliseconds since 1970. Its text has its number.
#[derive(Clone, Debug, Deserialize)]
pub struct Entry {
    pub clock: f64,
    pub text: String,
    pub place: String,
}

/// A watch table of the project.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct Sheet {
    pub row: Vec<SheetRow>,
}

/// A row of it. The terminal modifies values at once; only the page does it in the cycle.
#[derive(Clone, Debug, Deserialize)]
pub struct SheetRow {
    pub address: String,
    pub format: Option<String>,
    pub modify: Option<String>,
}

/// A value that the program uses.
#[derive(Clone, Debug, Deserialize)]
pub struct Listed {
    pub name: String,
    #[serde(rename = "type")]
    pub ty: String,
}
