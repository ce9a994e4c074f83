//! What each instruction costs: instructions of the host, counted by callgrind, bytes of machine code, and time.
//!
//! A row of the table is a short sequence with one instruction of an instruction set, in a block of its own. Many rows share a program:
//! OB 1 calls their blocks by number, so that no call is inlined, with other values in memory in each scan. An empty block is
//! subtracted.
//!
//! - [`stl`], [`s7200`], [`scl`], [`network`], [`chart`]: the rows of the instruction tables.
//! - [`program`]: programs of many rows; [`callgrind`]: counting; [`table`]: the table in `docs/benchmarks`.

pub mod callgrind;
pub mod chart;
pub mod network;
pub mod program;
pub mod s7200;
pub mod scl;
pub mod stl;
pub mod table;

/// A sequence with an instruction of the instruction set `set`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    pub set: &'static str,
    /// As the instruction table has it.
    pub name: String,
    /// Statements, with `; ` between them. `{p}` is the first of 8 bytes that belong to the row, `{n}` its number,
    /// `{s}` a bit of 256 (`3.1`).
    pub sequence: String,
}

impl Row {
    pub fn new(set: &'static str, name: &str, sequence: &str) -> Row {
        Row { set, name: name.to_string(), sequence: sequence.to_string() }
    }

    /// `STL AddI`
    pub fn key(&self) -> String {
        format!("{} {}", self.set, self.name)
    }
}

/// The cost of a row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Instructions of generated code in a run of the sequence, on average.
    pub own: f64,
    /// Those of the runtime and of called blocks.
    pub called: f64,
    pub bytes: u64,
    /// Nanoseconds, for information.
    pub time: f64,
}

/// All rows, in the order of the instruction tables.
pub fn rows() -> Vec<Row> {
    [stl::rows(), s7200::rows(), network::rows(), scl::rows(), chart::rows()].concat()
}
