//! CPU profiles: the names for `--cpu`, with the limits of each.

mod cpus;
pub mod s7200;

use plcc_abi::image::{Family, Profile};
use plcc_abi::layout;

use cpus::{PROFILES, Row};

/// The hardware on board of an S7-1200, by row name: fast counters, pulse generators, bytes of digital inputs and outputs from
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
    OnBoard { name: "1212FC",  fast_counters: 4, pulse_generators: 4, input_bytes: 1, output_bytes: 1, analog_inputs: 2, analog_outputs: 0 },
    OnBoard { name: "1214C",   fast_counters: 6, pulse_generators: 4, input_bytes: 2, output_bytes: 2, analog_inputs: 2, analog_outputs: 0 },
    OnBoard { name: "1214FC",  fast_counters: 6, pulse_generators: 4, input_bytes: 2, output_bytes: 2, analog_inputs: 2, analog_outputs: 0 },
    OnBoard { name: "1215C",   fast_counters: 6, pulse_generators: 4, input_bytes: 2, output_bytes: 2, analog_inputs: 2, analog_outputs: 2 },
    OnBoard { name: "1215FC",  fast_counters: 6, pulse_generators: 4, input_bytes: 2, output_bytes: 2, analog_inputs: 2, analog_outputs: 2 },
    OnBoard { name: "1217C",   fast_counters: 6, pulse_generators: 4, input_bytes: 2, output_bytes: 2, analog_inputs: 2, analog_outputs: 2 },
];

/// The hardware on board of a profile's CPU; `None`: nothing.
pub fn on_board(profile: &Profile) -> Option<&'static OnBoard> {
    ON_BOARD.iter().find(|board| board.name == profile.name)
}

/// Short forms that mean a row of the table.
const ALIASES: &[(&str, &str)] = &[("315DP", "3152DP"), ("317", "3172DP"), ("319", "3193PNDP"), ("3172", "3172DP")];

/// Parts that can be omitted at the end of a name: `315-2PN` is the 315-2PN/DP, `1511-1` the 1511-1PN.
const INTERFACES: [&str; 4] = ["", "DP", "PN", "PNDP"];

/// Supply and outputs of an S7-1200, which its name may include.
const SUPPLIES: [&str; 6] = ["DCDCDC", "DCDCRLY", "DCDCRELAY", "ACDCRLY", "ACDCRELAY", "ACDCDC"];

/// How order numbers of CPUs begin: the usual ones, and those of SIPLUS.
const ORDERS: [&str; 3] = ["6ES7", "6AG1", "6AG2"];

/// The CPU that `name` means, or an order number: letter case, blanks, hyphens, slashes and a leading `CPU` do not matter.
pub fn lookup(name: &str) -> Option<Profile> {
    let wanted = normalized(name);
    if let Some(row) = ordered(&wanted) {
        return Some(row);
    }
    let wanted = SUPPLIES.iter().find_map(|supply| wanted.strip_suffix(supply)).unwrap_or(&wanted);
    let mut aliases = ALIASES.iter().chain(s7200::ALIASES);
    let wanted = aliases.find(|(alias, _)| *alias == wanted).map_or(wanted, |(_, full)| full);
    let named = |name: &str| PROFILES.iter().find(|row| normalized(row.name) == name);
    let exact = named(wanted).map(profile);
    let exact = exact.or_else(|| s7200::cpus().iter().find(|cpu| cpu.name == wanted).map(s7200::profile));
    // `1511F` of an S7-1500 is enough, because no other row begins like this.
    let by_model = || {
        PROFILES.iter().find(|row| {
            row.family == Family::S71500
                && row.name.split_once('-').is_some_and(|(model, _)| normalized(model) == wanted)
        })
    };
    exact
        .or_else(|| INTERFACES.iter().find_map(|interface| named(&format!("{wanted}{interface}"))).map(profile))
        .or_else(|| by_model().map(profile))
}

/// The CPU of an order number such as `6ES7 315-2EH14-0AB0`, in the form of [`normalized`].
fn ordered(number: &str) -> Option<Profile> {
    let number = ORDERS.iter().find_map(|prefix| number.strip_prefix(prefix))?;
    let matches = |orders: &[&str]| orders.iter().any(|order| number.starts_with(&normalized(order)));
    let row = PROFILES.iter().find(|row| matches(row.orders)).map(profile);
    row.or_else(|| s7200::cpus().iter().find(|cpu| matches(s7200::orders(cpu.name))).map(s7200::profile))
}

/// The order number of the CPU of `profile`, as far as it is known: `text`, if it is an order number of this CPU, else how those of this CPU
/// begin. Empty for a family.
pub fn order_number(text: &str, profile: &Profile) -> String {
    let is_own = ordered(&normalized(text)).is_some_and(|found| found.name == profile.name);
    if is_own {
        return text.trim().to_string();
    }
    let row = PROFILES.iter().find(|row| row.name == profile.name);
    let mut orders = row.map(|row| row.orders).unwrap_or_default().iter().chain(s7200::orders(&profile.name));
    orders.next().map_or_else(String::new, |order| format!("{} {order}", ORDERS[0]))
}

/// Fewer digits or letters do not tell a CPU from others.
const DIGITS_MIN: usize = 3;

/// Help for a name that is not a CPU.
pub fn help(name: &str) -> String {
    let wanted = normalized(name);
    // `S7-1214C` for `1214C`.
    let bare = wanted.strip_prefix("S7").unwrap_or(&wanted);
    // `1214C DC/DC/DC`, `1517F`: what stands before its additions, or the same number.
    let begins = |own: &str| own.len() >= DIGITS_MIN && (wanted.starts_with(own) || bare.starts_with(own));
    let longest = names().into_iter().filter(|known| begins(&normalized(known))).max_by_key(|known| known.len());
    let digits = &bare[..bare.bytes().take_while(u8::is_ascii_digit).count()];
    let is_alike = |known: &&str| digits.len() >= DIGITS_MIN && normalized(known).starts_with(digits);
    let begun = names().into_iter().find(|known| bare.len() >= DIGITS_MIN && normalized(known).starts_with(bare));
    let near = [wanted.as_str(), bare]
        .into_iter()
        .flat_map(|wanted| names().into_iter().map(move |known| (wanted, known, normalized(known))))
        .filter(|(wanted, _, own)| wanted.get(..2) == own.get(..2))
        .map(|(wanted, known, own)| (plcc_syntax::distance::between(wanted, &own), known))
        .filter(|(distance, _)| *distance <= 2)
        .min()
        .map(|(_, known)| known);
    let forms = "write a family (`s7-300`, `s7-400`, `s7-1200`, `s7-1500`, `s7-200`), a CPU as STEP 7 names it (`315-2 PN/DP`), or its order number";
    let numbered = || names().into_iter().find(is_alike);
    // `1500` for a family.
    let family = names().into_iter().find(|known| normalized(known) == format!("S7{bare}"));
    match family.or(near.filter(is_alike)).or(longest).or(begun).or_else(numbered).or(near) {
        Some(near) => format!("is `{near}` meant? Otherwise {forms}"),
        None => forms.to_string(),
    }
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
    let name = letters.strip_prefix("CPU").unwrap_or(&letters);
    name.strip_suffix("CPU").unwrap_or(name).to_string()
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
    fn order_numbers() {
        for (number, name) in [
            ("6ES7 315-2EH14-0AB0", "315-2PN/DP"),
            ("6ES73152EH140AB0", "315-2PN/DP"),
            ("6es7 314-6eh04-0ab0", "314C-2PN/DP"),
            ("6AG1 315-2AH14-2AY0", "315-2DP"),
            ("6ES7 318-3EL01-0AB0", "319-3PN/DP"),
            ("6ES7 416-3XR05-0AB0", "416-3"),
            ("6ES7 417-4HT14-0AB0", "417-4H"),
            ("6ES7214-1AG40-0XB0", "1214C"),
            ("6ES7 214-1AF40-0XB0", "1214FC"),
            ("6ES7 214-1AD23-0XB0", "224"),
            ("6ES7 516-3AN01-0AB0", "1516-3PN/DP"),
            ("6ES7 512-1SK01-0AB0", "1512SP F-1PN"),
        ] {
            assert_eq!(lookup(number).map(|profile| profile.name).as_deref(), Some(name), "{number}");
        }
        assert_eq!(lookup("6ES7 399-0AA00-0AA0"), None);
    }

    #[test]
    fn short_names() {
        for (short, name) in [
            ("319-3", "319-3PN/DP"),
            ("315-2PN", "315-2PN/DP"),
            ("314C-2 PN/DP", "314C-2PN/DP"),
            ("412-5H", "412-5H"),
            ("1511", "1511-1PN"),
            ("CPU 1516F-3 PN/DP", "1516F-3PN/DP"),
            ("1518", "1518-4PN/DP"),
            ("1510SP-1 PN", "1510SP-1PN"),
            ("CPU 1214C DC/DC/DC", "1214C"),
            ("IM 151-8 PN/DP CPU", "IM 151-8PN/DP"),
        ] {
            assert_eq!(lookup(short).map(|profile| profile.name).as_deref(), Some(name), "{short}");
        }
        assert!(help("315-2DB").contains("315-2DP"));
        assert!(help("1214C DC/DC/DC").contains("`1214C`"));
        assert!(help("S7-1517F").contains("`1517F-3PN/DP`"));
    }

    /// No order number identifies two CPUs, and each row is found by its name.
    #[test]
    fn rows_are_told_apart() {
        let orders: Vec<&str> = PROFILES.iter().flat_map(|row| row.orders).copied().collect();
        for (at, order) in orders.iter().enumerate() {
            assert!(!orders[..at].iter().any(|other| order.starts_with(other) || other.starts_with(order)), "{order}");
        }
        for row in PROFILES {
            assert_eq!(lookup(row.name).map(|profile| profile.name).as_deref(), Some(row.name));
        }
    }

    #[test]
    fn order_numbers_are_those_of_the_user_or_how_they_begin() {
        for (text, order) in [
            ("6ES7 315-2EH14-0AB0", "6ES7 315-2EH14-0AB0"),
            (" 6ag1 516-3an01-2ab0 ", "6ag1 516-3an01-2ab0"),
            ("1516-3 PN/DP", "6ES7 516-3AN"),
            ("224XP", "6ES7 214-2AD"),
            ("s7-300", ""),
            ("1508S", ""),
        ] {
            let profile = lookup(text).expect("a CPU");
            assert_eq!(order_number(text, &profile), order, "{text}");
        }
        // The CPU of the command line is another one.
        let other = lookup("313C").expect("a CPU");
        assert_eq!(order_number("6ES7 315-2EH14-0AB0", &other), "6ES7 313-5B");
        assert_eq!(order_number("", &other), "6ES7 313-5B");
    }

    #[test]
    fn four_accumulators() {
        assert_eq!(lookup("318").map(|profile| profile.accumulators), Some(4));
        assert_eq!(generic(Family::S7400).accumulators, 4);
        assert_eq!(generic(Family::S7300).accumulators, 2);
    }
}
