//! Keys and values that plcc does not know, with those that are meant.

use super::Wrong;
use crate::distance;

/// Most keys in a help; of more, the ones that resemble the wrong one are named.
const KEYS_MAX: usize = 12;

/// A key or a value that is not one of `known`. `what`, `plural`: what it is not, and what they are.
pub fn unknown(what: &str, plural: &str, name: &str, known: &[&str]) -> Wrong {
    // A key may be written with `_` and with `-`: the documents have `_`.
    let (other, own) = if name.contains('-') { ('_', "-") } else { ('-', "_") };
    let known: Vec<&str> = known
        .iter()
        .copied()
        .filter(|key| !key.contains(other) || !known.contains(&key.replace(other, own).as_str()))
        .collect();
    let known = known.as_slice();
    let title = format!("`{name}` is not a {what}");
    // `[ob35]` for `[ob.35]`.
    let numbered = known.iter().find(|key| {
        let rest = name.strip_prefix(**key).map(|rest| rest.trim_start_matches(['_', '-', ' ']));
        rest.is_some_and(|rest| !rest.is_empty() && rest.bytes().all(|digit| digit.is_ascii_digit()))
    });
    let meant = MEANT.iter().find(|(word, own)| word.eq_ignore_ascii_case(name) && known.contains(own));
    // `max_cycle_time` for `cycle_time_max`.
    let words = |key: &str| {
        let mut words: Vec<String> = key.split(['_', '-', ' ']).map(str::to_ascii_lowercase).collect();
        words.sort_unstable();
        words
    };
    let own_words = words(name);
    let turned = known.iter().copied().find(|key| words(key) == own_words);
    let near = meant.map(|(_, own)| *own).or(turned).or_else(|| distance::nearest(name, known.iter().copied()));
    let help = match (numbered, near) {
        (Some(key), _) => format!("write `{key}.{}`", name[key.len()..].trim_start_matches(['_', '-', ' '])),
        (None, Some(near)) => format!("write `{near}`"),
        (None, None) if known.is_empty() => "remove it".to_owned(),
        (None, None) if known.len() <= KEYS_MAX => format!("the {plural} are {}", known.join(", ")),
        (None, None) => {
            let begin = |key: &&&str| key.bytes().next().map(|c| c.to_ascii_lowercase()) == first_letter(name);
            let alike: Vec<&str> = known.iter().filter(begin).copied().collect();
            let list = if alike.is_empty() { known } else { &alike };
            format!("remove it, or write one of the {plural} that plcc has, such as {}", list.join(", "))
        }
    };
    Wrong { title, help }
}

/// Other words for keys and values.
const MEANT: [(&str, &str); 32] = [
    ("at", "time"),
    ("wait", "time"),
    ("after", "time"),
    ("force", "set"),
    ("write", "set"),
    ("check", "expect"),
    ("assert", "expect"),
    ("watch", "print"),
    ("host", "modbus"),
    ("ip", "modbus"),
    ("address", "modbus"),
    ("slave", "unit"),
    ("slave_id", "unit"),
    ("interval", "poll"),
    ("map", "data"),
    ("address", "at"),
    ("german", "de"),
    ("deutsch", "de"),
    ("english", "en"),
    ("international", "en"),
    ("OB100", "warm"),
    ("OB101", "hot"),
    ("OB102", "cold"),
    ("decimal", "dec"),
    ("hexadecimal", "hex"),
    ("binary", "bin"),
    ("int", "dec"),
    ("float", "real"),
    ("floating_point", "real"),
    ("simatic_time", "s5time"),
    ("character", "char"),
    ("string", "char"),
];

fn first_letter(name: &str) -> Option<u8> {
    name.bytes().next().map(|letter| letter.to_ascii_lowercase())
}
