//! Devices on a field bus whose data are inputs and outputs of the CPU: `[io.NAME]` of plc.toml.

use serde::{Deserialize, Serialize};

/// A device. Source: Modbus application protocol V1.1b3.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RemoteStation {
    pub name: String,
    pub line: RemoteLine,
    /// Address of the device on the line.
    pub unit: u8,
    /// From one exchange to the next.
    pub poll_ms: u32,
    /// How long an answer may take.
    pub timeout_ms: u32,
    /// While the device is away, inputs keep their values; else they have their substitutes.
    pub keep: bool,
    pub channels: Vec<RemoteChannel>,
}

/// How the device is reached.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RemoteLine {
    /// Modbus TCP, `192.168.0.20:502`.
    Tcp(String),
    /// Modbus RTU.
    Serial {
        path: String,
        baud: u32,
        parity: RemoteParity,
    },
}

/// Of a serial line with eight data bits. Source: Modbus over serial line V1.02: without parity there are two stop bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RemoteParity {
    None,
    Even,
    Odd,
}

/// Tables of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RemoteTable {
    Coils,
    DiscreteInputs,
    HoldingRegisters,
    InputRegisters,
}

impl RemoteTable {
    /// The elements are bits, else words.
    pub const fn has_bits(self) -> bool {
        matches!(self, RemoteTable::Coils | RemoteTable::DiscreteInputs)
    }

    /// The CPU can write it.
    pub const fn is_writable(self) -> bool {
        matches!(self, RemoteTable::Coils | RemoteTable::HoldingRegisters)
    }

    /// Elements that one request reads or writes.
    pub const fn count_max(self, output: bool) -> u16 {
        match (self, output) {
            (RemoteTable::Coils | RemoteTable::DiscreteInputs, false) => 2000,
            (RemoteTable::Coils | RemoteTable::DiscreteInputs, true) => 1968,
            (RemoteTable::HoldingRegisters | RemoteTable::InputRegisters, false) => 125,
            (RemoteTable::HoldingRegisters | RemoteTable::InputRegisters, true) => 123,
        }
    }
}

/// Elements of a table, and the inputs or outputs that they are.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RemoteChannel {
    pub table: RemoteTable,
    /// First element, from 0.
    pub first: u16,
    pub count: u16,
    /// Outputs of the CPU; else inputs.
    pub output: bool,
    /// Address of the first byte among the inputs or outputs, and of the first bit.
    pub byte: u32,
    pub bit: u8,
    /// The device has the low byte of each register first.
    pub low_byte_first: bool,
    /// The device has the low word of each pair of registers first.
    pub low_word_first: bool,
    pub scale: Option<RemoteScale>,
    /// Each bit or word of the CPU: of inputs while the device is away, of outputs in STOP.
    pub substitute: u16,
}

impl RemoteChannel {
    /// Bytes of the CPU in which it has a part.
    pub const fn bytes(&self) -> u32 {
        match self.table.has_bits() {
            true => (self.bit as u32 + self.count as u32).div_ceil(8),
            false => 2 * self.count as u32,
        }
    }
}

/// Numbers of the device, and the words of the CPU that they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RemoteScale {
    pub raw_low: i32,
    pub raw_high: i32,
    pub word_low: i32,
    pub word_high: i32,
}
