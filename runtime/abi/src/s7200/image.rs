//! Data of an S7-200 program in addition to blocks and DB 1.

use serde::{Deserialize, Serialize};

use crate::image::BlockKind;

/// The compiler's description of the program.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct S7200Image {
    /// Timers that are used, by number; numbers tell their resolution.
    pub timers: Vec<u8>,
    /// Edge memories that are 1 when RUN begins.
    pub rising_edges: u32,
    /// Edge memories after them, 0 when RUN begins.
    pub falling_edges: u32,
    /// Where they are, in the order of their memories: those of EU, ED and counters.
    pub edges: Vec<EdgeMemory>,
    /// Which CPU it is, for ranges at run time.
    pub cpu: CpuRow,
    /// No code touches interrupts, fast counters, pulse outputs, ports, network, or anything through pointers: the CPU need not
    /// look at them in each scan.
    pub logic_only: bool,
}

/// The place of an edge memory.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EdgeMemory {
    pub kind: BlockKind,
    pub block: u16,
    pub network: u16,
    /// Hash of the statements of the network up to its own, as they are written, without blanks and comments.
    pub statements: u64,
    pub is_falling: bool,
}

/// Limits of a CPU of the S7-200. Source: S7-200 system manual, memory ranges and features.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CpuRow {
    /// Of the 21x generation.
    pub old: bool,
    pub v_bytes: u32,
    pub sm_bytes: u32,
    pub s_bytes: u32,
    /// Bytes of analog inputs and of analog outputs.
    pub analog_bytes: u32,
    /// High-speed counters, one bit each.
    pub high_speed_counters: u8,
    /// Freeport and PPI ports.
    pub ports: u8,
    pub pulse_outputs: u8,
    pub pid_loops: u8,
    /// Subroutines and interrupt routines that it may have.
    pub subroutines: u16,
    pub interrupts: u16,
    pub labels: u16,
    /// Events, one bit each.
    pub events: u64,
    /// Depth of the queues of communication, I/O and timed interrupts.
    pub queues: [u8; 3],
    /// Scan watchdog in milliseconds.
    pub watchdog_ms: u16,
    /// Bits 7-4 of SMB6.
    pub id: u8,
    /// Digital inputs and outputs of the CPU.
    pub inputs: u8,
    pub outputs: u8,
}

/// Settings of plc.toml for an S7-200.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct S7200Config {
    /// Station address, 2 if not given.
    pub station: Option<u8>,
    /// What the ports are connected to, by number.
    pub ports: Vec<Port>,
    /// Own side of the PPI link: `127.0.0.1:4000`, where other stations reach this one.
    pub listen: Option<String>,
    /// Other stations: address and where they listen.
    pub stations: Vec<(u8, String)>,
    /// Analog modules in the order of their slots.
    pub analog: Vec<AnalogModule>,
    /// Scan watchdog in milliseconds, 0: off; `None`: as the CPU has it.
    pub watchdog_ms: Option<u16>,
    /// Analog potentiometers, SMB28 and SMB29.
    pub potentiometers: [u8; 2],
    /// Non-fatal errors stop the CPU.
    pub stop_on_error: bool,
    /// Illegal REALs in compare contacts are fatal.
    pub strict_compare: bool,
    /// Mode switch in RUN (SM0.7 = 1) or TERM.
    pub mode_switch_term: bool,
}

/// What a serial port is connected to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Port {
    pub number: u8,
    pub link: Link,
}

/// The other end of a serial port.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Link {
    /// A serial device: `/dev/ttyUSB0`.
    Device(String),
    /// A pseudo-terminal; a link to it is made at this path.
    PseudoTerminal(String),
    /// Listens for a TCP connection at this address.
    Listen(String),
    /// Connects to this address.
    Connect(String),
}

/// An EM 231 (4 or 8 inputs), EM 232 (2 or 4 outputs) or EM 235 (4 or 3 inputs, 1 output).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AnalogModule {
    /// `EM 235`.
    pub name: String,
    pub inputs: u8,
    pub outputs: u8,
    /// Engineering range of the inputs at the module, of the outputs if it has only these: `0-10 V` gives 0.0 and 10.0, as bits of f64.
    pub low: u64,
    pub high: u64,
    /// Unit of the range: `V`, `mV` or `mA`.
    pub unit: String,
    /// Words go from -32000 to 32000 in steps of 16, else from 0 to 32000 in steps of 8.
    pub bipolar: bool,
}
