//! What the code of a program with probes reports, to those who watch the program while it runs.
//!
//! An executable has the code of its program twice: as it runs, and with probes. The runtime changes from one to the other between
//! two cycles.

use serde::{Deserialize, Serialize};

use crate::image::{AssertType, BlockKind};

/// All probes of a program, by block. The number of a probe in the code is its place in the list of all.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Probes {
    /// In the order of the numbers of their probes.
    pub blocks: Vec<BlockProbes>,
}

/// The probes of a block.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BlockProbes {
    pub kind: BlockKind,
    pub number: u16,
    pub name: String,
    /// Number of its first probe.
    pub first: u32,
    pub probes: Vec<Probe>,
    /// Of a chart.
    pub steps: Vec<Step>,
}

/// A probe.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Probe {
    /// First byte of its place in the source, as distance from that of the probe before it: small numbers are stored in few bytes.
    pub distance: i32,
    /// Length of the place in bytes.
    pub length: u32,
    /// 0: none.
    pub network: u16,
    pub tells: Tells,
}

/// What a probe tells.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Tells {
    /// A block begins or ends.
    Block,
    /// The registers after a statement of STL, which names no timer or counter.
    Registers,
    /// As `Registers`; the timer or counter that it names.
    Timer(u16),
    Counter(u16),
    /// The value of a variable that is read.
    Variable(AssertType),
    /// A value that is computed.
    Value(AssertType),
    /// A value that is written.
    Written(AssertType),
    /// The logic stack of an S7-200 after a statement: S0 is bit 0, ENO bit 9. The operands of the statement that have addresses,
    /// with the type of numbers: `VW100 as INT`.
    Stack(Vec<String>),
    /// A statement has run that may have no value.
    Ran,
}

/// A step of a chart, by its data in the instance: bytes from its beginning.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Step {
    pub name: String,
    /// Byte and bit of X.
    pub active: (u32, u8),
    /// Where T and U are, TIME.
    pub t: Option<u32>,
    pub u: Option<u32>,
    /// Where LA and VA are: the interlock is not satisfied, the supervision has found a fault.
    pub interlock: Option<(u32, u8)>,
    pub supervision: Option<(u32, u8)>,
}

impl Probes {
    /// The block of a probe, and its place there.
    pub fn find(&self, number: u32) -> Option<(usize, usize)> {
        let block = self.blocks.partition_point(|block| block.first <= number).checked_sub(1)?;
        let at = (number - self.blocks[block].first) as usize;
        (at < self.blocks[block].probes.len()).then_some((block, at))
    }
}
