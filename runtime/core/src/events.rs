//! Events that start organization blocks, with their start information.
//!
//! Source: System and standard functions, organization blocks.

use plcc_abi::image::{Config, Family, Profile};
use plcc_abi::ob::{CYCLIC_PERIOD_MS, OB_FREE, ObClass};

/// Bytes of start information at the head of an OB's TEMP.
pub const START_INFO_BYTES: usize = 20;

/// The first 12 bytes of start information; the time of the start is added when the OB starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StartInfo(pub [u8; 12]);

impl StartInfo {
    /// `class` is byte 0, `cause` byte 1; the priority is filled at the start.
    pub fn new(class: u8, cause: u8, ob: u16) -> StartInfo {
        let mut bytes = [0; 12];
        bytes[0] = class;
        bytes[1] = cause;
        bytes[3] = ob as u8;
        StartInfo(bytes)
    }

    /// Of an OB of the program cycle: `words` are bytes 6 to 11. Made in two pieces of the size in which it is read again, because it is
    /// needed in each cycle.
    pub fn of_cycle(cause: u8, priority: u8, ob: u16, words: [u16; 3]) -> StartInfo {
        let [last, shortest, longest] = words;
        let head = u64::from(u32::from_be_bytes([0x11, cause, priority, ob as u8])) << 32 | u64::from(last);
        let tail = u32::from(shortest) << 16 | u32::from(longest);
        let mut bytes = [0; 12];
        bytes[..8].copy_from_slice(&head.to_be_bytes());
        bytes[8..].copy_from_slice(&tail.to_be_bytes());
        StartInfo(bytes)
    }

    pub fn byte(mut self, offset: usize, value: u8) -> StartInfo {
        self.0[offset] = value;
        self
    }

    pub fn word(mut self, offset: usize, value: u16) -> StartInfo {
        self.0[offset..offset + 2].copy_from_slice(&value.to_be_bytes());
        self
    }

    pub fn dword(mut self, offset: usize, value: u32) -> StartInfo {
        self.0[offset..offset + 4].copy_from_slice(&value.to_be_bytes());
        self
    }
}

/// A request to run an OB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    pub ob: u16,
    pub info: StartInfo,
}

/// The reaction to an event whose OB is not loaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Missing {
    /// STOP with this event.
    Stop(u16),
    Continue,
    /// OB 85, fault A1; without OB 85 STOP.
    ClassError,
}

/// Second byte of the start information of an OB whose class begins with OB `first`, which has `base`. Further OBs of an
/// S7-1200/1500 have that of the first.
pub fn cause(base: u8, first: u16, ob: u16) -> u8 {
    match ob.checked_sub(first) {
        Some(index @ 0..=8) => base + index as u8,
        Some(_) | None => base,
    }
}

/// Reaction to a missing OB.
///
/// Source: LAD/FBD reference, organization blocks, for the S7-1200.
pub fn missing(ob: u16, family: Family) -> Missing {
    match (ob, family) {
        (83, Family::S71200) => return Missing::Stop(0x456B),
        (86, Family::S71200) => return Missing::Stop(0x456F),
        (_, Family::S71200 | Family::S71500) => return Missing::Continue,
        (_, Family::S7300 | Family::S7400 | Family::S7200) => {}
    }
    match ob {
        10..=23 | 30..=57 => Missing::ClassError,
        80 => Missing::Stop(0x4568),
        82 => Missing::Stop(0x456A),
        83 => Missing::Stop(0x456B),
        85 => Missing::Stop(0x456D),
        86 => Missing::Stop(0x456F),
        87 if family == Family::S7300 => Missing::Stop(0x456E),
        88 => Missing::Stop(0x4570),
        _ => Missing::Continue,
    }
}

/// Priority of an OB without configuration.
pub fn default_priority(ob: u16, family: Family) -> u8 {
    match ob {
        10..=17 | 55..=57 => 2,
        20..=23 => 3 + (ob - 20) as u8,
        30..=38 => 7 + (ob - 30) as u8,
        40..=47 => 16 + (ob - 40) as u8,
        60..=64 | 70 => 25,
        72 | 73 | 88 => 28,
        80 => 26,
        81..=87 if family == Family::S7400 => 25,
        81..=87 => 26,
        90 => 0,
        100..=102 => 27,
        _ => 1,
    }
}

/// Priority of an OB on this CPU: those of an S7-400/1200/1500 can be configured from 2 to 24, the cycle and the startup excepted.
pub fn priority(ob: u16, profile: &Profile, config: &Config) -> u8 {
    let class = config.class_of(ob);
    let configured = config.priorities.iter().find(|(number, _)| *number == ob).map(|(_, priority)| *priority);
    match (profile.family, class, configured) {
        (Family::S7400, _, Some(priority)) => priority.clamp(2, 24),
        (Family::S71200 | Family::S71500, Some(ObClass::ProgramCycle | ObClass::Startup), _) => 1,
        (Family::S71200 | Family::S71500, Some(_), Some(priority)) => priority.clamp(2, 24),
        (Family::S71200 | Family::S71500, Some(class), None) => class.row().priority,
        _ => default_priority(ob, profile.family),
    }
}

/// Default period of a cyclic interrupt in milliseconds. Blocks of the TIA Portal have their period in the configuration.
pub fn default_period_ms(ob: u16) -> u32 {
    if ob >= OB_FREE {
        return CYCLIC_PERIOD_MS;
    }
    [5000, 2000, 1000, 500, 200, 100, 50, 20, 10][usize::from(ob.clamp(30, 38) - 30)]
}

/// A field of start information that a scenario may name: its name without `OBnn_`, offset and width in bytes.
pub struct Field {
    pub name: &'static str,
    pub offset: usize,
    pub bytes: usize,
}

const fn field(name: &'static str, offset: usize, bytes: usize) -> Field {
    Field { name, offset, bytes }
}

/// Fields of all start information.
const COMMON: &[Field] =
    &[field("EV_CLASS", 0, 1), field("EVENT_CLASS", 0, 1), field("RESERVED_1", 4, 1), field("RESERVED_2", 5, 1)];

/// Fields by OB range.
///
/// Source: System and standard functions, organization blocks.
const FIELDS: &[(std::ops::RangeInclusive<u16>, &[Field])] = &[
    (
        10..=17,
        &[field("STRT_INFO", 1, 1), field("PERIOD_EXE", 6, 2), field("RESERVED_3", 8, 2), field("RESERVED_4", 10, 2)],
    ),
    (20..=23, &[field("STRT_INF", 1, 1), field("SIGN", 6, 2), field("DTIME", 8, 4)]),
    (
        30..=38,
        &[field("STRT_INF", 1, 1), field("PHASE_OFFSET", 6, 2), field("RESERVED_3", 8, 2), field("EXC_FREQ", 10, 2)],
    ),
    (
        40..=47,
        &[
            field("STRT_INF", 1, 1),
            field("IO_FLAG", 5, 1),
            field("MDL_ADDR", 6, 2),
            field("POINT_ADDR", 8, 4),
            field("LADDR", 6, 2),
            field("USI", 8, 2),
            field("ICHANNEL", 10, 1),
            field("EVENTTYPE", 11, 1),
        ],
    ),
    (
        55..=57,
        &[
            field("STRT_INF", 1, 1),
            field("IO_FLAG", 5, 1),
            field("MDL_ADDR", 6, 2),
            field("LEN", 8, 1),
            field("TYPE", 9, 1),
            field("SLOT", 10, 1),
            field("SPEC", 11, 1),
        ],
    ),
    (
        80..=80,
        &[
            field("FLT_ID", 1, 1),
            field("ERROR_INFO", 6, 2),
            field("ERR_EV_CLASS", 8, 1),
            field("ERR_EV_NUM", 9, 1),
            field("OB_PRIORITY", 10, 1),
            field("OB_NUM", 11, 1),
        ],
    ),
    (81..=81, &[field("FLT_ID", 1, 1), field("RACK_CPU", 6, 2), field("RESERVED_3", 8, 4)]),
    (
        82..=82,
        &[
            field("FLT_ID", 1, 1),
            field("IO_FLAG", 5, 1),
            field("MDL_ADDR", 6, 2),
            field("MDL_DIAG", 8, 4),
            field("MULTIERROR", 4, 1),
            field("LADDR", 6, 2),
            field("IO_STATE", 8, 2),
            field("CHANNEL", 10, 2),
        ],
    ),
    (
        83..=83,
        &[
            field("FLT_ID", 1, 1),
            field("MDL_TD", 5, 1),
            field("MDL_ADDR", 6, 2),
            field("RACK_NUM", 8, 2),
            field("MDL_TYPE", 10, 2),
            field("LADDR", 6, 2),
            field("FAULT_ID", 1, 1),
        ],
    ),
    (
        85..=85,
        &[
            field("FLT_ID", 1, 1),
            field("Z1", 6, 2),
            field("Z23", 8, 4),
            field("ERR_EV_CLASS", 8, 1),
            field("ERR_EV_NUM", 9, 1),
            field("OB_PRIOR", 10, 1),
            field("OB_NUM", 11, 1),
        ],
    ),
    (
        86..=86,
        &[
            field("FLT_ID", 1, 1),
            field("MDL_ADDR", 6, 2),
            field("RACKS_FLTD", 8, 4),
            field("LADDR", 6, 2),
            field("FAULT_ID", 1, 1),
        ],
    ),
    (84..=88, &[field("FLT_ID", 1, 1), field("INFO_1", 6, 2), field("INFO_2_3", 8, 4)]),
];

/// The OB whose start information is that of `ob`: the first of the class for those from OB 123 on.
fn model(ob: u16, class: Option<ObClass>) -> u16 {
    class.filter(|_| ob >= OB_FREE).map_or(ob, |class| class.row().numbers.0)
}

/// The field `name` (any case, with or without `OB40_`) of the start information of `ob`.
pub fn find_field(ob: u16, class: Option<ObClass>, name: &str) -> Option<&'static Field> {
    let upper = name.to_ascii_uppercase();
    let short = upper.strip_prefix(&format!("OB{ob}_")).unwrap_or(&upper);
    let model = model(ob, class);
    fields_of(model).find(|field| field.name == short)
}

/// The names of the fields of the start information of `ob`, without `OB40_`.
pub fn field_names(ob: u16, class: Option<ObClass>) -> impl Iterator<Item = &'static str> {
    fields_of(model(ob, class)).map(|field| field.name)
}

/// The fields of an OB, those of its class first.
fn fields_of(model: u16) -> impl Iterator<Item = &'static Field> {
    let specific = FIELDS.iter().filter(move |(range, _)| range.contains(&model)).flat_map(|(_, fields)| fields.iter());
    specific.chain(COMMON)
}

/// The event of `ob` with the usual start information; `None` for an OB that no event starts.
pub fn usual(ob: u16, class: Option<ObClass>) -> Option<Event> {
    let info = match model(ob, class) {
        10..=17 => StartInfo::new(0x11, cause(0x11, 10, ob), ob),
        20..=23 => StartInfo::new(0x11, cause(0x21, 20, ob), ob),
        30..=38 => StartInfo::new(0x11, cause(0x31, 30, ob), ob).word(10, default_period_ms(ob) as u16),
        40..=47 => StartInfo::new(0x11, 0x41, ob).byte(5, 0x54),
        55..=57 => StartInfo::new(0x11, 0x55 + (ob - 55) as u8, ob),
        80 => StartInfo::new(0x35, 0x01, ob),
        81 => StartInfo::new(0x39, 0x22, ob),
        82 => StartInfo::new(0x39, 0x42, ob).byte(5, 0x54),
        83 => StartInfo::new(0x39, 0x61, ob),
        84 => StartInfo::new(0x35, 0x81, ob),
        85 => StartInfo::new(0x35, 0xA1, ob),
        86 => StartInfo::new(0x39, 0xC4, ob),
        87 => StartInfo::new(0x35, 0xE1, ob),
        88 => StartInfo::new(0x35, 0x71, ob),
        _ => return None,
    };
    Some(Event { ob, info })
}
