//! How names compare.

use plcc_syntax::distance;

/// A name in the form in which names are compared: without letter case and outer blanks.
pub fn fold(name: &str) -> String {
    let name = name.trim();
    if name.is_ascii() { name.to_ascii_lowercase() } else { name.to_lowercase() }
}

/// The name that differs least from `name`, if it only differs by a slip.
pub fn similar<'n>(name: &str, names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    const CANDIDATES: usize = 20_000;
    const LENGTH_MAX: usize = 130;
    let wanted = fold(name);
    // Names of one letter always resemble each other.
    let length = wanted.chars().count();
    let limit = match length {
        0 | 1 => return None,
        2 | 3 => 1,
        4..=LENGTH_MAX => 2,
        _ => return None,
    };
    names
        .take(CANDIDATES)
        .filter(|other| other.chars().count().abs_diff(length) <= limit)
        .map(|other| (distance::between(&wanted, &fold(other)), other))
        .filter(|(distance, _)| *distance <= limit)
        .min()
        .map(|(_, other)| other)
}
