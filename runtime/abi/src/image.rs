//! The description of a program for the runtime.
//!
//! An executable carries a [`ProgramImage`] next to its code, encoded with `postcard` under the symbol `plcc_image`,
//! and the addresses of its entry functions under `plcc_entries`; `plcc run` and `plcc test` hand the value over.

use serde::{Deserialize, Serialize};

use crate::connections::S7Connection;
use crate::names::{External, NamedType, TypeNumber, UsedPlace};
use crate::ob::{OB_FREE, ObClass, StartInput};
use crate::remote::RemoteStation;
use crate::s7200::{S7200Config, S7200Image};
use crate::services::ServicesConfig;
use crate::shape::DbShape;
use crate::technology::{FastCounter, HardwareEvent, PulseGenerator};

/// Kinds of blocks, as passed to [`RuntimeFn::CallBlock`](crate::RuntimeFn::CallBlock).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[repr(u8)]
pub enum BlockKind {
    Ob,
    Fc,
    Fb,
    Sfc,
    Sfb,
    Db,
    /// Subroutine of an S7-200.
    Sbr,
    /// Interrupt routine of an S7-200.
    Int,
}

impl BlockKind {
    /// Letters before the number: `FC`.
    pub const fn prefix(self) -> &'static str {
        match self {
            BlockKind::Ob => "OB",
            BlockKind::Fc => "FC",
            BlockKind::Fb => "FB",
            BlockKind::Sfc => "SFC",
            BlockKind::Sfb => "SFB",
            BlockKind::Db => "DB",
            BlockKind::Sbr => "SBR",
            BlockKind::Int => "INT",
        }
    }
}

/// Families of CPUs, which differ in more than limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Family {
    S7300,
    S7400,
    S7200,
    S71200,
    S71500,
}

impl Family {
    /// A CPU that only the TIA Portal programs.
    pub const fn is_portal(self) -> bool {
        matches!(self, Family::S71200 | Family::S71500)
    }

    /// Its CPUs have a cold restart. Source: CPU manuals of S7-1200 and S7-1500, whose only startup is the warm restart; S7-200 system manual.
    pub const fn has_cold_restart(self) -> bool {
        matches!(self, Family::S7300 | Family::S7400)
    }
}

/// Limits and properties of a CPU. Sizes in bytes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Profile {
    /// Name as given to `--cpu`: `s7-300`, `315-2DP`.
    pub name: String,
    pub family: Family,
    /// 2 or 4.
    pub accumulators: u8,
    pub inputs: u32,
    pub outputs: u32,
    pub bit_memory: u32,
    pub timers: u32,
    pub counters: u32,
    /// L stack of one priority class, at most `layout::L_CLASS_BYTES`.
    pub local_data: u32,
    pub db_bytes_max: u32,
    pub block_depth: u32,
    /// What error OBs may add to the depth; on an S7-1200 the depth of interrupt OBs.
    pub error_depth: u32,
    /// Limits come from a checked source: passing them is an error, else a warning.
    pub limits_checked: bool,
}

impl Profile {
    /// Blocks that an OB of class `class` may nest, itself included. Source: technical data of the families.
    pub fn depth_max(&self, class: Option<ObClass>) -> u32 {
        match (class, self.family) {
            (Some(ObClass::ProgramError | ObClass::AccessError), _) => self.error_depth,
            (Some(ObClass::ProgramCycle | ObClass::Startup), _) | (None, _) => self.block_depth,
            (Some(_), Family::S71200) => self.error_depth,
            (Some(_), _) => self.block_depth,
        }
    }
}

/// A place in the source, for messages at run time.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Site {
    /// Index into [`ProgramImage::files`].
    pub file: u32,
    /// 1-based.
    pub line: u32,
    pub block: BlockKind,
    pub block_number: u16,
    /// 1-based; 0 before the first network.
    pub network: u16,
}

/// A block that the runtime can call.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BlockEntry {
    pub kind: BlockKind,
    pub number: u16,
    /// Symbolic name, empty if none.
    pub name: String,
    /// Index into the table of entry functions.
    pub entry: u32,
    /// L stack bytes of the block itself, rounded to frames.
    pub frame: u32,
    /// It reads its local data: an OB its start information, and others zeros.
    pub local_data_used: bool,
    /// Input parameters of an OB, which the CPU sets when it starts.
    pub start_inputs: Vec<StartInput>,
}

/// A data block that exists before the first cycle.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DbEntry {
    pub number: u16,
    pub name: String,
    /// Offset from the memory base.
    pub address: u32,
    /// Current values as loaded; its length is the DB's.
    pub data: Vec<u8>,
    /// The program cannot write it.
    pub read_only: bool,
    /// In load memory only: not accessible to the program.
    pub unlinked: bool,
    /// It has no addresses that a client could name.
    pub optimized: bool,
    /// What comes back after the process has ended.
    pub kept: Kept,
    /// A structure with its components; `None` if it has no declared ones.
    pub ty: Option<TypeNumber>,
}

/// Comparison of an assertion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum AssertOp {
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
}

/// What the value of a side of an assertion is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum AssertType {
    /// Bits without another meaning: registers, addresses, BYTE to LWORD.
    Bits(u8),
    Bool,
    /// Signed bits.
    Signed(u8),
    Unsigned(u8),
    Real,
    Lreal,
    Char,
    Wchar,
    S5Time,
    /// Milliseconds.
    Time,
    /// Nanoseconds.
    Ltime,
    /// Days since 1990-01-01.
    Date,
    /// Milliseconds since midnight.
    TimeOfDay,
    /// Nanoseconds since midnight.
    Ltod,
    /// Nanoseconds since 1970-01-01.
    Ldt,
    /// Eight bytes of BCD.
    DateAndTime,
    /// Where the 12 bytes are: an offset from the memory base.
    Dtl,
    /// Where a STRING is: an offset from the memory base.
    Text,
    /// Where a WSTRING is.
    WideText,
}

/// How the sides of a comparison are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum AssertKind {
    /// Unsigned, the narrower one with zeros in front.
    Bits,
    /// By the whole numbers that they are.
    Whole,
    /// As floating-point numbers.
    Float,
    Duration,
    TimeOfDay,
    /// Dates, with or without a time.
    Moment,
    Text,
}

/// A constant side of a comparison.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum AssertConstant {
    /// As a variable of the type has it, zero-extended.
    Bits(u64),
    /// The 12 bytes of a DTL.
    Bytes(Vec<u8>),
    /// The characters of a STRING, each a byte, or of a WSTRING.
    Text(Vec<u16>),
}

/// A side of a comparison.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AssertSide {
    pub ty: AssertType,
    /// Its value; `None`: code supplies it.
    pub constant: Option<AssertConstant>,
}

/// A comparison of an assertion.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AssertComparison {
    pub op: AssertOp,
    pub kind: AssertKind,
    pub left: AssertSide,
    pub right: AssertSide,
}

/// How comparisons are joined.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum AssertCondition {
    /// The comparison with this number.
    Compare(u32),
    Not(Box<AssertCondition>),
    All(Vec<AssertCondition>),
    Any(Vec<AssertCondition>),
}

/// An assertion pragma that was compiled.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AssertEntry {
    pub file: u32,
    pub line: u32,
    /// The source line, trimmed.
    pub text: String,
    pub condition: AssertCondition,
    /// At least one. Code supplies their values in this order; after the last one the assertion is judged.
    pub comparisons: Vec<AssertComparison>,
    /// Both sides are different constants: it must never be reached.
    pub trap: bool,
}

/// A named address, for `--print` and scenarios.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SymbolEntry {
    pub name: String,
    /// Absolute address in international spelling: `Q4.0`, `DB10.DBD4`.
    pub address: String,
    /// The declared type of a value in memory, if it has one.
    pub ty: Option<TypeNumber>,
    /// What clients may do with it.
    pub external: External,
}

/// Settings of the CPU, from plc.toml.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Config {
    /// Cycle-time monitoring; 150 by default.
    pub cycle_time_max_ms: u32,
    /// Time from one cycle start to the next, if the flags of the run say nothing.
    pub cycle_time_ms: Option<u32>,
    /// S7-1200/1500 without OB 80: whether the first cycle that is too long stops the CPU; `None`: the default of the family.
    pub overrun_stops: Option<bool>,
    /// Clock memory byte, if one is configured.
    pub clock_memory_byte: Option<u16>,
    /// System memory byte, if one is configured.
    pub system_memory_byte: Option<u16>,
    /// Classes of OBs from [`OB_FREE`] on, where they are not those of the program cycle.
    pub ob_classes: Vec<(u16, ObClass)>,
    /// Fast counters, pulse generators and hardware interrupts of an S7-1200.
    pub fast_counters: Vec<FastCounter>,
    pub pulse_generators: Vec<PulseGenerator>,
    pub hardware_events: Vec<HardwareEvent>,
    /// Period of cyclic interrupts by OB number, where it differs from the default.
    pub cyclic_period_ms: Vec<(u16, u32)>,
    /// Phase offset of cyclic interrupts.
    pub cyclic_phase_ms: Vec<(u16, u32)>,
    /// Priority by OB number, where it differs from the default (not on an S7-300).
    pub priorities: Vec<(u16, u8)>,
    /// Time-of-day interrupts that are active from the start.
    pub time_of_day: Vec<TimeOfDay>,
    /// Byte ranges of inputs and outputs that modules cover; `None`: every address exists.
    pub modules: Option<Vec<Module>>,
    /// Hardware identifiers that plc.toml gives to modules: the number, and [`Module::identifier`].
    pub hardware_ids: Vec<(u16, u16)>,
    /// Devices on a field bus.
    pub remote: Vec<RemoteStation>,
    /// Partners of PUT, GET, BSEND and so on.
    pub connections: Vec<S7Connection>,
    /// First startup OB: 100, 101 or 102.
    pub startup: u16,
    /// Retentive memory.
    pub retain: RetainConfig,
    /// Order number of the CPU, `6ES7 315-2AF03-0AB0`, or how it begins, `6ES7 315-2AF`; empty if unknown.
    pub cpu_order: String,
    /// Folder of the program's files, if the flags of the run say nothing.
    pub data_folder: Option<String>,
    /// What clients can reach.
    pub services: ServicesConfig,
    pub s7200: S7200Config,
}

impl Default for Config {
    fn default() -> Self {
        Config {
            cycle_time_max_ms: 150,
            cycle_time_ms: None,
            overrun_stops: None,
            clock_memory_byte: None,
            system_memory_byte: None,
            ob_classes: Vec::new(),
            fast_counters: Vec::new(),
            pulse_generators: Vec::new(),
            hardware_events: Vec::new(),
            cyclic_period_ms: Vec::new(),
            cyclic_phase_ms: Vec::new(),
            priorities: Vec::new(),
            time_of_day: Vec::new(),
            modules: None,
            hardware_ids: Vec::new(),
            remote: Vec::new(),
            connections: Vec::new(),
            startup: 100,
            retain: RetainConfig::default(),
            cpu_order: String::new(),
            data_folder: None,
            services: ServicesConfig::default(),
            s7200: S7200Config::default(),
        }
    }
}

impl Config {
    /// What starts OB `ob`.
    pub fn class_of(&self, ob: u16) -> Option<ObClass> {
        let given = self.ob_classes.iter().find(|(number, _)| *number == ob).map(|(_, class)| *class);
        given.or_else(|| if ob >= OB_FREE { Some(ObClass::ProgramCycle) } else { ObClass::of_number(ob) })
    }

    /// The hardware identifier of a module: the one that plc.toml gives it, otherwise that by its addresses.
    pub fn hardware_id(&self, module: &Module) -> u16 {
        let own = module.identifier();
        self.hardware_ids.iter().find(|(_, address)| *address == own).map_or(own, |(given, _)| *given)
    }
}

/// What is retentive besides data blocks, and where it is kept.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RetainConfig {
    /// The file; `None`: nothing is kept, and each start begins with start values.
    pub file: Option<String>,
    pub interval: RetainInterval,
    /// Bytes of bit memory, S5 timers and counters from the first on; `None`: as many as the family has by default.
    pub bit_memory: Option<u32>,
    pub timers: Option<u32>,
    pub counters: Option<u32>,
    /// Memory reset: what is in the file does not come back.
    pub reset: bool,
    /// A hot restart may come after this run, although it does not begin with one: all memory is kept.
    pub for_hot: bool,
}

/// How often retentive memory is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RetainInterval {
    /// After each cycle that has changed it.
    Cycle,
    Milliseconds(u32),
}

impl Default for RetainInterval {
    fn default() -> RetainInterval {
        RetainInterval::Milliseconds(100)
    }
}

/// What of a data block is retentive.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kept {
    #[default]
    Nothing,
    Everything,
    /// First bit in the block and number of bits of each part.
    Bits(Vec<(u32, u32)>),
}

/// A time-of-day interrupt set in plc.toml.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TimeOfDay {
    /// An OB of this class.
    pub ob: u16,
    /// First start, `2026-01-31T06:00:00`.
    pub start: String,
    /// Code of SFC 28: 0 once, 16#0201 every minute, ...
    pub period: u16,
}

/// An I/O module: the peripheral bytes it answers for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Module {
    pub name: String,
    pub input_start: u32,
    pub input_bytes: u32,
    pub output_start: u32,
    pub output_bytes: u32,
    /// Its description if plc.toml describes the station.
    pub station: Option<StationModule>,
}

impl Module {
    /// Bit of a hardware identifier that is an address of outputs.
    pub const OF_OUTPUTS: u16 = 0x8000;

    /// Its hardware identifier by its addresses: the first one of its inputs, or that of its outputs with [`Module::OF_OUTPUTS`].
    pub const fn identifier(&self) -> u16 {
        match self.input_bytes {
            0 => self.output_start as u16 | Module::OF_OUTPUTS,
            _ => self.input_start as u16,
        }
    }
}

/// A module of a station: its position and its channels.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StationModule {
    pub rack: u8,
    pub slot: u8,
    /// `6ES7 331-7KB02-0AB0`; empty if unknown.
    pub order: String,
    /// Analog input channels, one word each from the start of the inputs; none if the module is not analog.
    pub analog_inputs: Vec<AnalogChannel>,
    /// Analog output channels.
    pub analog_outputs: Vec<AnalogChannel>,
    /// What outputs show in STOP: the word of each analog channel, else the bits of all output bytes.
    pub substitute: u32,
}

/// An analog channel.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AnalogChannel {
    /// Name of its measuring or output range, `4..20 mA`; empty if not configured.
    pub range: String,
    /// Resolution in bits without the sign, 15 at most.
    pub bits: u8,
    /// A current below 1.185 mA is shown as wire break.
    pub wire_break: bool,
}

/// A block that handles its own synchronous errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ErrorSlot {
    pub kind: BlockKind,
    pub number: u16,
    /// Where the ErrorStruct of the first error is in the block's local data.
    pub offset: u32,
}

/// Everything about a program that the runtime needs, except its code.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProgramImage {
    pub name: String,
    pub profile: Profile,
    pub config: Config,
    pub blocks: Vec<BlockEntry>,
    pub dbs: Vec<DbEntry>,
    /// First byte after the DBs of the program, where the pool begins.
    pub db_end: u32,
    pub sites: Vec<Site>,
    /// Sorted by kind and number.
    pub error_slots: Vec<ErrorSlot>,
    pub files: Vec<String>,
    pub asserts: Vec<AssertEntry>,
    pub symbols: Vec<SymbolEntry>,
    /// Types of the components of DBs and of symbols.
    pub types: Vec<NamedType>,
    /// Places that the code names, in order.
    pub used: Vec<UsedPlace>,
    /// Stand-ins for missing parts, and parts left out because of them: one line each, reported at the start of a run.
    pub partial: Vec<String>,
    /// What DBs look like, if the program has a block that needs it.
    pub shapes: Vec<DbShape>,
    /// No code of the program changes output bytes from here on: they need not be copied to the modules in each cycle.
    pub outputs_used: u32,
    /// The program may end itself (SFC 46, STP): `plcc test` runs it until then.
    pub stops_itself: bool,
    /// Tells the sources of an S7-400 from others: a hot restart needs the same program. 0 on other CPUs.
    pub sources_sum: u64,
    /// Lines that every run prints first.
    pub notices: Vec<String>,
    /// Blocks that only code of the program calls, and their names: clients see them in lists.
    pub inner_blocks: Vec<(BlockKind, u16, String)>,
    /// Of an S7-200.
    pub s7200: Option<S7200Image>,
}

impl ProgramImage {
    /// Milliseconds that a cycle may take; `None`: any time. An S7-200 has a scan watchdog, which can be off, others a cycle monitoring time.
    pub fn cycle_limit_ms(&self) -> Option<u32> {
        match &self.s7200 {
            Some(own) => {
                let ms = self.config.s7200.watchdog_ms.unwrap_or(own.cpu.watchdog_ms);
                (ms != 0).then_some(ms.into())
            }
            None => Some(self.config.cycle_time_max_ms.max(1)),
        }
    }
}
