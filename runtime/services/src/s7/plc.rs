//! What a connection asks of the CPU.

/// An area of memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Area {
    Inputs,
    Outputs,
    BitMemory,
    /// PI on reading, PQ on writing.
    Peripheral,
    /// Of an S7-200: V memory is DB 1.
    Db(u16),
    Timers,
    Counters,
    /// S7-200 only.
    SpecialMemory,
    AnalogInputs,
    AnalogOutputs,
    SystemInfo,
}

/// A place to read or write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    pub area: Area,
    /// First byte; number of the first timer or counter.
    pub start: u32,
    /// `Some`: one bit of that byte.
    pub bit: Option<u8>,
    /// Bytes, timers or counters.
    pub count: u32,
}

/// Why an item cannot be read or written: the code of the item in the answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum ItemError {
    Hardware = 0x01,
    NotAllowed = 0x03,
    OutOfRange = 0x05,
    TypeUnknown = 0x06,
    TypeInconsistent = 0x07,
    Missing = 0x0A,
}

/// What kind of CPU it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    S7300,
    S7400,
    S7200,
    S71200,
    S71500,
}

impl Family {
    /// The longest PDU that such a CPU offers.
    pub fn pdu_max(self) -> u16 {
        match self {
            Family::S7200 | Family::S7300 | Family::S71200 => 240,
            Family::S7400 => 480,
            Family::S71500 => 960,
        }
    }

    pub fn is_portal(self) -> bool {
        matches!(self, Family::S71200 | Family::S71500)
    }
}

/// Kinds of blocks, with their codes in lists.
pub const BLOCK_KINDS: [u8; 7] = [0x08, 0x0E, 0x0C, 0x0A, 0x0B, 0x0D, 0x0F];

/// What clients get to know of a block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockInfo {
    pub number: u16,
    /// Bytes of data of a DB, of code otherwise.
    pub bytes: u16,
    pub local_data: u16,
    pub name: String,
    pub read_only: bool,
}

/// A date and time, as DATE_AND_TIME has it.
pub type DateAndTime = [u8; 8];

/// An entry of the diagnostic buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    pub event: u16,
    /// The OB that was running; of a change of mode the modes before and after it.
    pub ob: u8,
    pub priority: u8,
    pub info: u32,
    pub time: DateAndTime,
}

/// How a CPU begins to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Restart {
    Warm,
    Cold,
}

/// The CPU, at its cycle control point.
pub trait Plc {
    fn family(&self) -> Family;

    /// Name of the program, order number and type of the CPU.
    fn names(&self) -> Names;

    fn read(&self, place: Place) -> Result<Vec<u8>, ItemError>;

    /// `data` has the bytes of the place; of a bit one byte, 0 or 1; of a timer or counter two.
    fn write(&self, place: Place, data: &[u8]) -> Result<(), ItemError>;

    fn is_running(&self) -> bool;
    /// Values are forced.
    fn is_forcing(&self) -> bool;

    /// Puts the CPU into STOP.
    fn stop(&self);

    /// Puts a CPU in STOP into RUN. False: there is no such restart.
    fn start(&self, restart: Restart) -> bool;

    /// Numbers of the blocks of a kind, sorted.
    fn blocks(&self, kind: u8) -> Vec<u16>;

    fn block(&self, kind: u8, number: u16) -> Option<BlockInfo>;

    /// How many bytes a data block may have.
    fn block_bytes_max(&self) -> u32;

    fn clock(&self) -> DateAndTime;

    /// False: there is no such date.
    fn set_clock(&self, time: DateAndTime) -> bool;

    /// The newest entries of the diagnostic buffer, newest first.
    fn events(&self, count: usize) -> Vec<Event>;

    /// The status of an OB, a record of list 0222. `None`: it is not loaded.
    fn ob_status(&self, ob: u16) -> Option<Vec<u8>>;

    /// The newest change of mode in the diagnostic buffer.
    fn last_mode_change(&self) -> Option<Event>;

    /// Faults have come since the last startup.
    fn has_faults(&self) -> bool;

    /// Bytes of the process images and of bit memory, timers, counters, local data.
    fn sizes(&self) -> [u16; 6];

    /// How much is retentive: bytes of bit memory, timers, counters.
    fn retentive(&self) -> [u16; 3];

    /// The memory of data blocks: bytes, those in use, and those of the longest block that still has room.
    fn data_memory(&self) -> [u32; 3];

    /// Modules with addresses: rack, slot in the high byte, first address, two codes of the type, 0, state, area.
    fn modules(&self) -> Vec<[u16; 8]>;

    /// The bit of a timer or counter of an S7-200.
    fn cell_bit(&self, area: Area, number: u32) -> bool;
}

/// What the CPU is called.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    pub program: String,
    /// `6ES7 315-2EH14-0AB0`.
    pub order: String,
    /// `CPU 315-2 PN/DP`.
    pub module: String,
}
