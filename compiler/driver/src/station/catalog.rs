//! Modules and CPUs by order number: the possible parts of a station.
//!
//! Source: SIMATIC S7-300 module data and CPU data; the catalogue of STEP 7's hardware configuration.

/// What a module is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Ps,
    Cpu,
    Im360,
    Im361,
    Im365,
    Di,
    Do,
    DiDo,
    Ai,
    Ao,
    AiAo,
    Fm,
    Cp,
    /// Dummy module: it reserves a slot.
    Dm,
}

impl Kind {
    /// Its name for `kind` in plc.toml.
    const NAMES: [(&'static str, Kind); 14] = [
        ("PS", Kind::Ps),
        ("CPU", Kind::Cpu),
        ("IM 360", Kind::Im360),
        ("IM 361", Kind::Im361),
        ("IM 365", Kind::Im365),
        ("DI", Kind::Di),
        ("DO", Kind::Do),
        ("DI/DO", Kind::DiDo),
        ("AI", Kind::Ai),
        ("AO", Kind::Ao),
        ("AI/AO", Kind::AiAo),
        ("FM", Kind::Fm),
        ("CP", Kind::Cp),
        ("DM", Kind::Dm),
    ];

    pub fn named(name: &str) -> Option<Kind> {
        Kind::NAMES.iter().find(|(word, _)| normalized(word) == normalized(name)).map(|(_, kind)| *kind)
    }

    pub fn names() -> String {
        Kind::NAMES.map(|(word, _)| word).join(", ")
    }

    pub fn name(self) -> &'static str {
        Kind::NAMES.iter().find(|(_, kind)| *kind == self).map_or("", |(word, _)| word)
    }

    pub fn is_digital(self) -> bool {
        matches!(self, Kind::Di | Kind::Do | Kind::DiDo)
    }

    pub fn is_analog(self) -> bool {
        matches!(self, Kind::Ai | Kind::Ao | Kind::AiAo)
    }

    pub fn is_interface(self) -> bool {
        matches!(self, Kind::Im360 | Kind::Im361 | Kind::Im365)
    }

    /// Has inputs, has outputs.
    pub fn directions(self) -> (bool, bool) {
        match self {
            Kind::Di | Kind::Ai => (true, false),
            Kind::Do | Kind::Ao => (false, true),
            Kind::DiDo | Kind::AiAo | Kind::Fm | Kind::Cp => (true, true),
            Kind::Ps | Kind::Cpu | Kind::Im360 | Kind::Im361 | Kind::Im365 | Kind::Dm => (false, false),
        }
    }
}

/// Bytes that FMs and CPs have in each direction.
pub const FM_BYTES: u32 = 16;

/// A type of module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Type {
    pub kind: Kind,
    /// Channels of inputs and of outputs.
    pub inputs: u32,
    pub outputs: u32,
    /// Resolution of analog channels in bits without the sign.
    pub bits: u8,
}

impl Type {
    pub fn input_bytes(&self) -> u32 {
        bytes(self.kind, self.inputs, self.kind.directions().0)
    }

    pub fn output_bytes(&self) -> u32 {
        bytes(self.kind, self.outputs, self.kind.directions().1)
    }
}

fn bytes(kind: Kind, channels: u32, has: bool) -> u32 {
    match kind {
        _ if !has => 0,
        Kind::Fm | Kind::Cp => FM_BYTES,
        _ if kind.is_analog() => 2 * channels,
        _ => channels.div_ceil(8),
    }
}

/// A row of the catalogue.
pub struct Row {
    /// Order number without version: all versions have the same addresses.
    order: &'static str,
    pub name: &'static str,
    pub module: Type,
}

const fn row(order: &'static str, name: &'static str, kind: Kind, inputs: u32, outputs: u32, bits: u8) -> Row {
    Row { order, name, module: Type { kind, inputs, outputs, bits } }
}

use Kind::{Ai, AiAo, Ao, Cp, Di, DiDo, Dm, Do, Fm, Im360, Im361, Im365, Ps};

#[rustfmt::skip]
const MODULES: &[Row] = &[
    row("6ES7305-1BA", "PS 305 2A",                 Ps, 0, 0, 0),
    row("6ES7307-1BA", "PS 307 2A",                 Ps, 0, 0, 0),
    row("6ES7307-1EA", "PS 307 5A",                 Ps, 0, 0, 0),
    row("6ES7307-1KA", "PS 307 10A",                Ps, 0, 0, 0),
    row("6ES7360-3AA", "IM 360",                    Im360, 0, 0, 0),
    row("6ES7361-3CA", "IM 361",                    Im361, 0, 0, 0),
    row("6ES7365-0BA", "IM 365",                    Im365, 0, 0, 0),
    row("6ES7370-0AA", "DM 370",                    Dm, 0, 0, 0),
    row("6ES7321-1BH", "DI16xDC24V",                Di, 16, 0, 0),
    row("6ES7321-1BL", "DI32xDC24V",                Di, 32, 0, 0),
    row("6ES7321-1CH", "DI16xUC",                   Di, 16, 0, 0),
    row("6ES7321-1EL", "DI32xAC120V",               Di, 32, 0, 0),
    row("6ES7321-1FF", "DI8xAC120/230V",            Di, 8, 0, 0),
    row("6ES7321-1FH", "DI16xAC120/230V",           Di, 16, 0, 0),
    row("6ES7321-7BH", "DI16xDC24V, interrupt",     Di, 16, 0, 0),
    row("6ES7322-1BF", "DO8xDC24V/2A",              Do, 0, 8, 0),
    row("6ES7322-1BH", "DO16xDC24V/0.5A",           Do, 0, 16, 0),
    row("6ES7322-1BL", "DO32xDC24V/0.5A",           Do, 0, 32, 0),
    row("6ES7322-1CF", "DO8xDC48-125V/1.5A",        Do, 0, 8, 0),
    row("6ES7322-1FF", "DO8xAC120/230V/2A",         Do, 0, 8, 0),
    row("6ES7322-1FH", "DO16xAC120/230V/1A",        Do, 0, 16, 0),
    row("6ES7322-1FL", "DO32xAC120/230V/1A",        Do, 0, 32, 0),
    row("6ES7322-1HF", "DO8xRelay",                 Do, 0, 8, 0),
    row("6ES7322-1HH", "DO16xRelay",                Do, 0, 16, 0),
    row("6ES7322-5FF", "DO8xAC120/230V/2A",         Do, 0, 8, 0),
    row("6ES7322-5HF", "DO8xRelay/5A",              Do, 0, 8, 0),
    row("6ES7322-8BF", "DO8xDC24V/0.5A, interrupt", Do, 0, 8, 0),
    row("6ES7323-1BH", "DI8/DO8xDC24V/0.5A",        DiDo, 8, 8, 0),
    row("6ES7323-1BL", "DI16/DO16xDC24V/0.5A",      DiDo, 16, 16, 0),
    row("6ES7331-1KF", "AI8x13Bit",                 Ai, 8, 0, 12),
    row("6ES7331-7HF", "AI8x14Bit",                 Ai, 8, 0, 13),
    row("6ES7331-7KB", "AI2x12Bit",                 Ai, 2, 0, 12),
    row("6ES7331-7KF", "AI8x12Bit",                 Ai, 8, 0, 12),
    row("6ES7331-7NF", "AI8x16Bit",                 Ai, 8, 0, 15),
    row("6ES7331-7PF0", "AI8xRTD",                  Ai, 8, 0, 15),
    row("6ES7331-7PF1", "AI8xTC",                   Ai, 8, 0, 15),
    row("6ES7332-5HB", "AO2x12Bit",                 Ao, 0, 2, 12),
    row("6ES7332-5HD", "AO4x12Bit",                 Ao, 0, 4, 12),
    row("6ES7332-5HF", "AO8x12Bit",                 Ao, 0, 8, 12),
    row("6ES7332-7ND", "AO4x16Bit",                 Ao, 0, 4, 15),
    row("6ES7334-0CE", "AI4/AO2x8Bit",              AiAo, 4, 2, 8),
    row("6ES7334-0KE", "AI4/AO2x12Bit",             AiAo, 4, 2, 12),
    row("6ES7335-7HG", "AI4/AO4x14/12Bit",          AiAo, 4, 4, 13),
    row("6ES7340-1AH", "CP 340-RS232C",             Cp, 0, 0, 0),
    row("6ES7341-1AH", "CP 341-RS232C",             Cp, 0, 0, 0),
    row("6GK7342-5DA", "CP 342-5",                  Cp, 0, 0, 0),
    row("6GK7343-1EX", "CP 343-1",                  Cp, 0, 0, 0),
    row("6ES7350-1AH", "FM 350-1 counter",          Fm, 0, 0, 0),
    row("6ES7351-1AH", "FM 351 positioning",        Fm, 0, 0, 0),
    row("6ES7352-1AH", "FM 352 cam controller",     Fm, 0, 0, 0),
    row("6ES7353-1AH", "FM 353 stepper motor",      Fm, 0, 0, 0),
    row("6ES7354-1AH", "FM 354 servo motor",        Fm, 0, 0, 0),
    row("6ES7355-0VH", "FM 355 C PID control",      Fm, 0, 0, 0),
];

/// The type with this order number.
pub fn lookup(order: &str) -> Option<&'static Row> {
    let order = normalized(order);
    MODULES.iter().find(|row| order.starts_with(&normalized(row.order)))
}

/// Order numbers are compared without blanks and hyphens; the letter O counts as 0.
pub fn normalized(order: &str) -> String {
    order
        .chars()
        .filter(char::is_ascii_alphanumeric)
        .map(|c| c.to_ascii_uppercase())
        .map(|c| if c == 'O' { '0' } else { c })
        .collect()
}

/// Inputs and outputs inside a CPU.
#[derive(Clone, Copy, Debug)]
pub struct Onboard {
    pub name: &'static str,
    pub module: Type,
    pub start: u32,
}

/// What a CPU allows.
pub struct CpuRow {
    /// Name of its profile.
    pub name: &'static str,
    order: &'static str,
    /// Racks, 1 or 4.
    pub racks: u8,
    /// Start addresses can be chosen.
    pub free_addresses: bool,
    /// Peripheral bytes in each direction.
    pub peripheral: u32,
    /// Slot 11 of rack 3 stays empty.
    pub short_rack: bool,
    pub onboard: &'static [Onboard],
}

const fn onboard(name: &'static str, kind: Kind, inputs: u32, outputs: u32, bits: u8, start: u32) -> Onboard {
    Onboard { name, module: Type { kind, inputs, outputs, bits }, start }
}

const ONBOARD_312IFM: &[Onboard] = &[onboard("DI10/DO6", DiDo, 10, 6, 0, 124)];
const ONBOARD_314IFM: &[Onboard] =
    &[onboard("DI20/DO16", DiDo, 20, 16, 0, 124), onboard("AI4/AO1", AiAo, 4, 1, 11, 128)];
const ONBOARD_312C: &[Onboard] = &[onboard("DI10/DO6", DiDo, 10, 6, 0, 124)];
const ONBOARD_313C: &[Onboard] = &[onboard("DI24/DO16", DiDo, 24, 16, 0, 124), onboard("AI5/AO2", AiAo, 5, 2, 11, 752)];
const ONBOARD_313C2: &[Onboard] = &[onboard("DI16/DO16", DiDo, 16, 16, 0, 124)];

#[rustfmt::skip]
const fn cpu(name: &'static str, order: &'static str, racks: u8, free_addresses: bool, peripheral: u32, onboard: &'static [Onboard]) -> CpuRow {
    CpuRow { name, order, racks, free_addresses, peripheral, short_rack: !onboard.is_empty() && racks > 1, onboard }
}

/// Peripheral area: instruction lists of the CPUs.
#[rustfmt::skip]
const CPUS: &[CpuRow] = &[
    cpu("s7-300",     "-",           4, true,  65536, &[]),
    cpu("312IFM",     "6ES7312-5AC", 1, false, 1024, ONBOARD_312IFM),
    cpu("312C",       "6ES7312-5B",  1, true,  1024, ONBOARD_312C),
    cpu("312",        "6ES7312-1A",  1, true,  1024, &[]),
    cpu("313",        "6ES7313-1AD", 1, false, 1024, &[]),
    cpu("313C",       "6ES7313-5B",  4, true,  1024, ONBOARD_313C),
    cpu("313C-2DP",   "6ES7313-6C",  4, true,  1024, ONBOARD_313C2),
    cpu("314IFM",     "6ES7314-5AE", 4, false, 1024, ONBOARD_314IFM),
    cpu("314C-2DP",   "6ES7314-6C",  4, true,  1024, ONBOARD_313C),
    cpu("314",        "6ES7314-1A",  4, false, 1024, &[]),
    cpu("315",        "6ES7315-1A",  4, true,  1024, &[]),
    cpu("315-2DP",    "6ES7315-2A",  4, true,  1024, &[]),
    cpu("315-2PN/DP", "6ES7315-2E",  4, true,  2048, &[]),
    cpu("316",        "6ES7316-1A",  4, true,  1024, &[]),
    cpu("317-2DP",    "6ES7317-2A",  4, true,  8192, &[]),
    cpu("317-2PN/DP", "6ES7317-2E",  4, true,  8192, &[]),
    cpu("318-2",      "6ES7318-2A",  4, true,  8192, &[]),
    cpu("318",        "-",           4, true,  8192, &[]),
    cpu("319-3PN/DP", "6ES7318-3E",  4, true,  8192, &[]),
];

/// The CPU of this profile.
pub fn cpu_named(profile: &str) -> Option<&'static CpuRow> {
    CPUS.iter().find(|row| row.name == profile)
}

/// The CPU with this order number.
pub fn cpu_ordered(order: &str) -> Option<&'static CpuRow> {
    let order = normalized(order);
    CPUS.iter().find(|row| row.order != "-" && order.starts_with(&normalized(row.order)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_numbers_compare_without_blanks_and_with_o_as_0() {
        assert_eq!(cpu_ordered("6ES7 315-2AFO3-OABO").map(|row| row.name), Some("315-2DP"));
        assert_eq!(lookup("6ES7331-7KB02-0AB0").map(|row| row.name), Some("AI2x12Bit"));
        assert!(lookup("6ES7 399-0AA00-0AA0").is_none());
    }

    #[test]
    fn order_numbers_are_unique() {
        for (index, row) in MODULES.iter().enumerate() {
            assert_eq!(lookup(row.order).map(|found| found.name), Some(row.name), "row {index}");
        }
        for row in CPUS.iter().filter(|row| row.order != "-") {
            assert_eq!(cpu_ordered(row.order).map(|found| found.name), Some(row.name));
        }
    }

    #[test]
    fn every_cpu_has_a_profile() {
        for row in CPUS {
            assert_eq!(plcc_model::profile::lookup(row.name).map(|profile| profile.name), Some(row.name.to_string()));
        }
    }

    /// The table of the textbook's modules.
    #[test]
    fn byte_counts() {
        for (order, inputs, outputs) in [
            ("6ES7 307-1EA00-0AA0", 0, 0),
            ("6ES7 321-1BL00-0AA0", 4, 0),
            ("6ES7 321-1EL00-0AA0", 4, 0),
            ("6ES7 322-1BL00-0AA0", 0, 4),
            ("6ES7 322-1FH00-0AA0", 0, 2),
            ("6ES7 322-1HH01-0AA0", 0, 2),
            ("6ES7 322-5HF00-0AB0", 0, 1),
            ("6ES7 323-1BH00-0AA0", 1, 1),
            ("6ES7 323-1BL00-0AA0", 2, 2),
            ("6ES7 331-7KB02-0AB0", 4, 0),
            ("6ES7 332-5HB01-0AB0", 0, 4),
            ("6ES7 332-5HD01-0AB0", 0, 8),
            ("6ES7 365-0BA01-0AA0", 0, 0),
            ("6ES7 350-1AH03-0AE0", 16, 16),
        ] {
            let module = lookup(order).unwrap().module;
            assert_eq!((module.input_bytes(), module.output_bytes()), (inputs, outputs), "{order}");
        }
    }
}
