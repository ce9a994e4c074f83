//! Organization blocks, grouped by the events that start them, and the values that an S7-1200/1500 hands to each.
//!
//! Source: LAD/FBD reference for S7-1200, organization blocks.

use serde::{Deserialize, Serialize};

/// The event that starts an organization block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ObClass {
    ProgramCycle,
    Startup,
    TimeOfDay,
    TimeDelay,
    Cyclic,
    Hardware,
    Status,
    Update,
    Profile,
    TimeError,
    Diagnostic,
    PullPlug,
    RackFailure,
    ProgramError,
    AccessError,
    Multicomputing,
    SynchronousCycle,
    Motion,
    IoRedundancy,
    CpuRedundancy,
    PowerSupply,
    CpuHardware,
    ClassError,
    CommunicationError,
    Processing,
    Background,
}

/// A row of [`OB_CLASSES`].
#[derive(Debug)]
pub struct ObClassRow {
    pub class: ObClass,
    /// Word of plc.toml.
    pub word: &'static str,
    /// Values of the attributes `S7_EventClass` and `SecondaryType`; the first is the usual one.
    pub names: &'static [&'static str],
    /// Numbers with this class on every CPU.
    pub numbers: (u16, u16),
    /// OBs from [`OB_FREE`] on may have it.
    pub free: bool,
    /// Priority on an S7-1200/1500 without configuration.
    pub priority: u8,
}

/// OBs from this number on have the class from their block or from plc.toml, else that of the program cycle.
pub const OB_FREE: u16 = 123;
/// Period of a new cyclic interrupt of the TIA Portal in milliseconds, whatever its number.
pub const CYCLIC_PERIOD_MS: u32 = 100;
/// Largest number of an OB of an S7-1200/1500.
pub const OB_NUMBER_MAX: u16 = 32_767;

const fn row(
    class: ObClass,
    word: &'static str,
    names: &'static [&'static str],
    numbers: (u16, u16),
    free: bool,
    priority: u8,
) -> ObClassRow {
    ObClassRow { class, word, names, numbers, free, priority }
}

use ObClass::{
    AccessError, Background, ClassError, CommunicationError, CpuHardware, CpuRedundancy, Cyclic, Diagnostic, Hardware,
    IoRedundancy, Motion, Multicomputing, PowerSupply, Processing, Profile, ProgramCycle, ProgramError, PullPlug,
    RackFailure, Startup, Status, SynchronousCycle, TimeDelay, TimeError, TimeOfDay, Update,
};

/// The classes, a row each. Priorities are those of the S7-1200 from V4 on; those of OB 121 and 122 do not count, as they run in the
/// class that failed.
#[rustfmt::skip]
pub const OB_CLASSES: &[ObClassRow] = &[
    row(ProgramCycle, "program cycle",  &["ProgramCycle"],                                    (1, 1),     true,  1),
    row(Startup,      "startup",        &["Startup"],                                         (100, 102), true,  1),
    row(TimeOfDay,    "time of day",    &["TimeOfDay", "TimeOfDayInterrupt"],                 (10, 17),   true,  2),
    row(TimeDelay,    "time delay",     &["TimeDelayInterrupt", "TimeDelay"],                 (20, 23),   true,  3),
    row(Cyclic,       "cyclic",         &["CyclicInterrupt", "Cyclic"],                       (30, 38),   true,  8),
    row(Hardware,     "hardware",       &["HardwareInterrupt", "ProcessInterrupt", "Hardware"], (40, 47), true,  18),
    row(Status,       "status",         &["Status", "StatusInterrupt"],                       (55, 55),   false, 4),
    row(Update,       "update",         &["Update", "UpdateInterrupt"],                       (56, 56),   false, 4),
    row(Profile,      "profile",        &["Profile", "ProfileInterrupt"],                     (57, 57),   false, 4),
    row(TimeError,    "time error",     &["TimeErrorInterrupt", "TimeError"],                 (80, 80),   false, 22),
    row(Diagnostic,   "diagnostic",     &["DiagnosticErrorInterrupt", "DiagnosticError"],     (82, 82),   false, 5),
    row(PullPlug,     "pull or plug",   &["PullOrPlugOfModules", "PullOrPlugModules", "PullPlugOfModules"], (83, 83), false, 6),
    row(RackFailure,  "rack failure",   &["RackOrStationFailure", "RackFailure"],             (86, 86),   false, 6),
    row(ProgramError, "program error",  &["ProgrammingError"],                                (121, 121), false, 7),
    row(AccessError,  "access error",   &["IOAccessError", "AccessError"],                    (122, 122), false, 7),
    row(Multicomputing, "multicomputing", &["Multicomputing", "MulticomputingInterrupt"],     (60, 60),   false, 25),
    row(SynchronousCycle, "synchronous cycle", &["SynchronousCycle", "SynchronousCycleInterrupt"], (61, 64), false, 21),
    row(Motion,       "motion control", &["MC-Servo", "MC-Interpolator", "MC-PreServo", "MC-PostServo", "MC-PreInterpolator",
                                          "MC-Transformation", "MC-LookAhead", "MCServo", "MCInterpolator"], (91, 98), false, 24),
    row(IoRedundancy, "I/O redundancy error", &["IORedundancyError"],                         (70, 70),   false, 25),
    row(CpuRedundancy, "CPU redundancy error", &["CPURedundancyError"],                       (72, 72),   false, 28),
    row(PowerSupply,  "power supply error", &["PowerSupplyError"],                            (81, 81),   false, 26),
    row(CpuHardware,  "CPU hardware error", &["CPUHardwareError", "CPUHardwareFault"],        (84, 84),   false, 26),
    row(ClassError,   "priority class error", &["PriorityClassError", "ProgramExecutionError", "ProgramSequenceError"], (85, 85), false, 26),
    row(CommunicationError, "communication error", &["CommunicationError"],                   (87, 87),   false, 26),
    row(Processing,   "processing interrupt", &["ProcessingInterrupt"],                       (88, 88),   false, 28),
    row(Background,   "background", &["BackgroundCycle", "Background", "BackgroundProcessing"], (90, 90),  false, 1),
];

impl ObClass {
    /// plcc simulates no event that starts this OB; a scenario may.
    pub const fn is_started(self) -> bool {
        !matches!(self, Multicomputing | SynchronousCycle | Motion | IoRedundancy | CpuRedundancy | Background)
    }

    pub fn row(self) -> &'static ObClassRow {
        OB_CLASSES.iter().find(|row| row.class == self).unwrap_or(&OB_CLASSES[0])
    }

    /// The class that an OB below [`OB_FREE`] has by its number.
    pub fn of_number(ob: u16) -> Option<ObClass> {
        // MC-PreServo and MC-PreInterpolator stand apart from the other blocks of motion control.
        if matches!(ob, 67 | 68) {
            return Some(Motion);
        }
        OB_CLASSES.iter().find(|row| (row.numbers.0..=row.numbers.1).contains(&ob)).map(|row| row.class)
    }

    /// The class of an attribute's value, in any letter case.
    pub fn of_name(name: &str) -> Option<ObClass> {
        let same = |known: &&str| known.eq_ignore_ascii_case(name.trim());
        OB_CLASSES.iter().find(|row| row.names.iter().any(same)).map(|row| row.class)
    }
}

/// A value that an S7-1200/1500 hands to an OB as an input parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum StartValue {
    /// First call since the change to RUN.
    InitialCall,
    /// Retentive data are there.
    Remanence,
    LostRetentive,
    LostRtc,
    /// The call makes up for one that the clock jumped over.
    CaughtUp,
    /// The second call for one time, after the clock was set back.
    SecondTime,
    /// SIGN of SRT_DINT.
    Sign,
    /// Events that were lost since the last call.
    EventCount,
    /// Hardware identifier of the module.
    Laddr,
    Usi,
    IChannel,
    EventType,
    IoState,
    Channel,
    MultiError,
    FaultId,
    EventClass,
    /// OB that caused the time error, and its priority.
    CsgObNr,
    CsgPrio,
    /// Of a synchronous error: number and type of the block, 1 OB, 2 FC, 3 FB.
    BlockNr,
    BlockType,
    /// 0 continues, 1 uses a substitute value, 2 skips the access.
    Reaction,
    /// Memory area and width of the access.
    Area,
    Width,
    DbNr,
    /// OB in which the error occurred, and its priority.
    FailedOb,
    FailedPrio,
}

/// An input that the CPU supplies: class of the OB, name, width in bits, value.
pub const START_VALUES: &[(ObClass, &str, u32, StartValue)] = &[
    (ProgramCycle, "Initial_Call", 1, StartValue::InitialCall),
    (ProgramCycle, "Remanence", 1, StartValue::Remanence),
    (Startup, "LostRetentive", 1, StartValue::LostRetentive),
    (Startup, "LostRTC", 1, StartValue::LostRtc),
    (TimeOfDay, "CaughtUp", 1, StartValue::CaughtUp),
    (TimeOfDay, "SecondTime", 1, StartValue::SecondTime),
    (TimeDelay, "Sign", 16, StartValue::Sign),
    (Cyclic, "Initial_Call", 1, StartValue::InitialCall),
    (Cyclic, "Event_Count", 16, StartValue::EventCount),
    (Hardware, "LADDR", 16, StartValue::Laddr),
    (Hardware, "USI", 16, StartValue::Usi),
    (Hardware, "IChannel", 8, StartValue::IChannel),
    (Hardware, "EventType", 8, StartValue::EventType),
    (TimeError, "Fault_ID", 8, StartValue::FaultId),
    (TimeError, "Csg_OBnr", 16, StartValue::CsgObNr),
    (TimeError, "Csg_Prio", 16, StartValue::CsgPrio),
    (Diagnostic, "IO_State", 16, StartValue::IoState),
    (Diagnostic, "LADDR", 16, StartValue::Laddr),
    (Diagnostic, "Channel", 16, StartValue::Channel),
    (Diagnostic, "MultiError", 1, StartValue::MultiError),
    (PullPlug, "LADDR", 16, StartValue::Laddr),
    (PullPlug, "Event_Class", 8, StartValue::EventClass),
    (PullPlug, "Fault_ID", 8, StartValue::FaultId),
    (RackFailure, "LADDR", 16, StartValue::Laddr),
    (RackFailure, "Event_Class", 8, StartValue::EventClass),
    (RackFailure, "Fault_ID", 8, StartValue::FaultId),
    (ProgramError, "BlockNr", 16, StartValue::BlockNr),
    (ProgramError, "Reaction", 8, StartValue::Reaction),
    (ProgramError, "Fault_ID", 8, StartValue::FaultId),
    (ProgramError, "BlockType", 8, StartValue::BlockType),
    (ProgramError, "Area", 8, StartValue::Area),
    (ProgramError, "DBNr", 16, StartValue::DbNr),
    (ProgramError, "Csg_OBNr", 16, StartValue::FailedOb),
    (ProgramError, "Csg_Prio", 8, StartValue::FailedPrio),
    (ProgramError, "Width", 8, StartValue::Width),
    (AccessError, "BlockNr", 16, StartValue::BlockNr),
    (AccessError, "Reaction", 8, StartValue::Reaction),
    (AccessError, "Fault_ID", 8, StartValue::FaultId),
    (AccessError, "BlockType", 8, StartValue::BlockType),
    (AccessError, "Area", 8, StartValue::Area),
    (AccessError, "DBNr", 16, StartValue::DbNr),
    (AccessError, "Csg_OBNr", 16, StartValue::FailedOb),
    (AccessError, "Csg_Prio", 8, StartValue::FailedPrio),
    (AccessError, "Width", 8, StartValue::Width),
];

/// Whether two names of a start value are one: letter case and underscores differ between versions of the TIA Portal, and `DBNBR` is `DBNr`.
pub fn same_start_value(one: &str, other: &str) -> bool {
    let plain = |name: &str| name.trim().replace('_', "").to_ascii_lowercase().replace("nbr", "nr");
    plain(one) == plain(other)
}

/// An input parameter of an OB and its place in the OB's local data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StartInput {
    pub value: StartValue,
    pub byte: u32,
    pub bit: u8,
    /// 1, 8 or 16.
    pub bits: u32,
}
