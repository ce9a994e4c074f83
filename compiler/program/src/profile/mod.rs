//! CPU profiles: what `--cpu` can name, with the limits of each.

pub mod s7200;

use plcc_abi::image::{Family, Profile};
use plcc_abi::layout;

/// One row of the table of CPUs.
struct Row {
    name: &'static str,
    family: Family,
    accumulators: u8,
    /// Bytes of the process image, inputs and outputs alike.
    image: u32,
    bit_memory: u32,
    timers: u32,
    counters: u32,
    local_data: u32,
    db_bytes_max: u32,
    block_depth: u32,
    error_depth: u32,
    checked: bool,
}

#[allow(clippy::too_many_arguments, reason = "one table row a line reads better than named fields")]
const fn row(
    name: &'static str,
    family: Family,
    accumulators: u8,
    image: u32,
    bit_memory: u32,
    timers: u32,
    counters: u32,
    local_data: u32,
    db_bytes_max: u32,
    block_depth: u32,
    error_depth: u32,
    checked: bool,
) -> Row {
    Row {
        name,
        family,
        accumulators,
        image,
        bit_memory,
        timers,
        counters,
        local_data,
        db_bytes_max,
        block_depth,
        error_depth,
        checked,
    }
}

use Family::{S7200, S7300, S7400, S71200, S71500};

/// Source: the generic profiles are design decisions, 313 is from its technical data, those of S7-1200 (firmware V4) from the
/// LAD/FBD reference. The others are not `checked`: what exceeds one of
/// their limits is a warning only.
#[rustfmt::skip]
const PROFILES: &[Row] = &[
    //  name            family  accus image     M     T     C      L     DB depth err checked
    row("s7-300",       S7300,  2,  2048,  8192, 2048, 2048, 32768, 65534, 16, 4, true),
    row("s7-400",       S7400,  4,  2048, 16384, 2048, 2048, 65536, 65534, 24, 2, true),
    row("s7-200",       S7200,  2,    16,    32,  256,  256,    64, 10240,  8, 0, true),
    row("s7-1200",      S71200, 2,  1024,  8192,    0,    0, 65536, 65534, 16, 6, true),
    row("s7-1500",      S71500, 2, 32768, 16384, 2048, 2048, 65536, 65534, 24, 2, true),
    row("1211C",        S71200, 2,  1024,  4096,    0,    0, 16384, 30720, 16, 6, true),
    row("1212C",        S71200, 2,  1024,  4096,    0,    0, 16384, 51200, 16, 6, true),
    row("1214C",        S71200, 2,  1024,  8192,    0,    0, 16384, 65534, 16, 6, true),
    row("1215C",        S71200, 2,  1024,  8192,    0,    0, 16384, 65534, 16, 6, true),
    row("1217C",        S71200, 2,  1024,  8192,    0,    0, 16384, 65534, 16, 6, true),
    row("312IFM",       S7300,  2,   128,   128,   64,   32,   256,  8192,  8, 4, false),
    row("312",          S7300,  2,   128,   256,  128,  128,   256, 16384,  8, 4, false),
    row("312C",         S7300,  2,   128,   128,  128,  128,   256, 16384,  8, 4, false),
    row("313",          S7300,  2,    32,   256,  128,   64,   256,  8192,  8, 4, true),
    row("313C",         S7300,  2,   128,   256,  256,  256,   510, 16384,  8, 4, false),
    row("313C-2DP",     S7300,  2,   128,   256,  256,  256,   510, 16384,  8, 4, false),
    row("314",          S7300,  2,   128,   256,  128,   64,   256,  8192,  8, 4, false),
    row("314IFM",       S7300,  2,   128,   256,  128,   64,   256,  8192,  8, 4, false),
    row("314C-2DP",     S7300,  2,  2048,   256,  256,  256,   510, 16384,  8, 4, false),
    row("315",          S7300,  2,   128,   256,  128,   64,   256, 16384,  8, 4, false),
    row("315-2DP",      S7300,  2,   128,   256,  128,   64,   256, 16384,  8, 4, false),
    row("315-2PN/DP",   S7300,  2,  2048,  2048,  256,  256, 32768, 65534, 16, 4, false),
    row("316",          S7300,  2,   128,   256,  128,   64,   256, 16384,  8, 4, false),
    row("317-2DP",      S7300,  2,  8192,  4096,  512,  512, 32768, 65534, 16, 4, false),
    row("317-2PN/DP",   S7300,  2,  8192,  4096,  512,  512, 32768, 65534, 16, 4, false),
    row("318",          S7300,  4,  2048,  1024,  512,  512,  4096, 65534, 16, 3, false),
    row("318-2",        S7300,  4,  2048,  1024,  512,  512,  4096, 65534, 16, 3, false),
    row("319-3PN/DP",   S7300,  2,  8192,  8192, 2048, 2048, 32768, 65534, 16, 4, false),
    row("412-2",        S7400,  4,  4096,  4096, 2048, 2048,  8192, 65534, 24, 2, false),
    row("412-2DP",      S7400,  4,  4096,  4096, 2048, 2048,  8192, 65534, 24, 2, false),
    row("414-2",        S7400,  4,  8192,  8192, 2048, 2048, 16384, 65534, 24, 2, false),
    row("414-3",        S7400,  4,  8192,  8192, 2048, 2048, 16384, 65534, 24, 2, false),
    row("414-3PN/DP",   S7400,  4,  8192,  8192, 2048, 2048, 16384, 65534, 24, 2, false),
    row("416-2",        S7400,  4, 16384, 16384, 2048, 2048, 32768, 65534, 24, 2, false),
    row("416-3",        S7400,  4, 16384, 16384, 2048, 2048, 32768, 65534, 24, 2, false),
    row("416-3PN/DP",   S7400,  4, 16384, 16384, 2048, 2048, 32768, 65534, 24, 2, false),
    row("417-4",        S7400,  4, 16384, 16384, 2048, 2048, 65536, 65534, 24, 2, false),
];

/// What an S7-1200 has on board, by the name of its row: fast counters, pulse generators, bytes of digital inputs and outputs from
/// address 0, analog inputs and outputs from address 64.
///
/// Source: LAD/FBD reference for S7-1200, CPU limits; two more pulse generators and 1215C, 1217C from the firmware V4 on.
pub struct OnBoard {
    name: &'static str,
    pub fast_counters: u8,
    pub pulse_generators: u8,
    pub input_bytes: u32,
    pub output_bytes: u32,
    pub analog_inputs: u32,
    pub analog_outputs: u32,
}

#[rustfmt::skip]
const ON_BOARD: &[OnBoard] = &[
    OnBoard { name: "s7-1200", fast_counters: 6, pulse_generators: 4, input_bytes: 2, output_bytes: 2, analog_inputs: 2, analog_outputs: 2 },
    OnBoard { name: "1211C",   fast_counters: 3, pulse_generators: 4, input_bytes: 1, output_bytes: 1, analog_inputs: 2, analog_outputs: 0 },
    OnBoard { name: "1212C",   fast_counters: 4, pulse_generators: 4, input_bytes: 1, output_bytes: 1, analog_inputs: 2, analog_outputs: 0 },
    OnBoard { name: "1214C",   fast_counters: 6, pulse_generators: 4, input_bytes: 2, output_bytes: 2, analog_inputs: 2, analog_outputs: 0 },
    OnBoard { name: "1215C",   fast_counters: 6, pulse_generators: 4, input_bytes: 2, output_bytes: 2, analog_inputs: 2, analog_outputs: 2 },
    OnBoard { name: "1217C",   fast_counters: 6, pulse_generators: 4, input_bytes: 2, output_bytes: 2, analog_inputs: 2, analog_outputs: 2 },
];

/// What the CPU of a profile has on board; `None`: nothing.
pub fn on_board(profile: &Profile) -> Option<&'static OnBoard> {
    ON_BOARD.iter().find(|board| board.name == profile.name)
}

/// Short forms that mean a row of the table.
const ALIASES: &[(&str, &str)] = &[("315DP", "3152DP"), ("3172", "3172DP"), ("317", "3172DP"), ("319", "3193PNDP")];

/// The CPU that `name` means: letter case, blanks, hyphens, slashes and a leading `CPU` do not matter.
pub fn lookup(name: &str) -> Option<Profile> {
    let wanted = normalized(name);
    let mut aliases = ALIASES.iter().chain(s7200::ALIASES);
    let wanted = aliases.find(|(alias, _)| *alias == wanted).map_or(wanted.as_str(), |(_, full)| full);
    let row = PROFILES.iter().find(|row| normalized(row.name) == wanted).map(profile);
    row.or_else(|| s7200::cpus().iter().find(|cpu| cpu.name == wanted).map(s7200::profile))
}

/// The generic profile of a family.
pub fn generic(family: Family) -> Profile {
    let row = PROFILES.iter().find(|row| row.family == family).expect("every family begins with its generic row");
    profile(row)
}

/// Names of all profiles, generic ones first.
pub fn names() -> Vec<&'static str> {
    PROFILES.iter().map(|row| row.name).chain(s7200::cpus().iter().map(|cpu| cpu.name)).collect()
}

fn normalized(name: &str) -> String {
    let letters: String =
        name.chars().filter(char::is_ascii_alphanumeric).map(|letter| letter.to_ascii_uppercase()).collect();
    letters.strip_prefix("CPU").map(str::to_string).unwrap_or(letters)
}

fn profile(row: &Row) -> Profile {
    Profile {
        name: row.name.to_string(),
        family: row.family,
        accumulators: row.accumulators,
        inputs: row.image,
        outputs: row.image,
        bit_memory: row.bit_memory,
        timers: row.timers.min(layout::TIMERS_MAX),
        counters: row.counters.min(layout::TIMERS_MAX),
        local_data: row.local_data.min(layout::L_CLASS_BYTES),
        db_bytes_max: row.db_bytes_max,
        block_depth: row.block_depth,
        error_depth: row.error_depth,
        limits_checked: row.checked,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_compare_without_blanks_hyphens_and_case() {
        for name in ["315-2DP", "CPU 315-2 DP", "315-2dp", "cpu315-2DP", "315-DP"] {
            assert_eq!(lookup(name).map(|profile| profile.name), Some("315-2DP".to_string()), "{name}");
        }
        assert_eq!(lookup("S7-300"), Some(generic(Family::S7300)));
        assert_eq!(lookup("315-2 PN/DP").map(|profile| profile.bit_memory), Some(2048));
        assert_eq!(lookup("CPU 1214C").map(|profile| (profile.family, profile.timers)), Some((Family::S71200, 0)));
        for row in PROFILES.iter().filter(|row| row.family == Family::S71200) {
            let profile = profile(row);
            assert!(on_board(&profile).is_some_and(|board| board.fast_counters >= 3), "{}", row.name);
        }
        assert_eq!(lookup("1217c").map(|profile| (profile.bit_memory, profile.limits_checked)), Some((8192, true)));
        assert_eq!(lookup("s7-1500"), Some(generic(Family::S71500)));
        assert_eq!(lookup("999"), None);
    }

    #[test]
    fn four_accumulators() {
        assert_eq!(lookup("318").map(|profile| profile.accumulators), Some(4));
        assert_eq!(generic(Family::S7400).accumulators, 4);
        assert_eq!(generic(Family::S7300).accumulators, 2);
    }
}
