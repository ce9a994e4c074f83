//! How many slips of the keyboard are between two words, for suggestions.

/// Number of characters to add, remove, replace or swap with their neighbour to turn one word into the other (optimal string alignment).
pub fn between(a: &str, b: &str) -> usize {
    strsim::osa_distance(a, b)
}

/// The name that differs least from `name`, without regard to letter case and outer blanks, if it only differs by a slip.
pub fn nearest<'n>(name: &str, names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    const CANDIDATES: usize = 20_000;
    const LENGTH_MAX: usize = 130;
    let fold = |name: &str| name.trim().to_lowercase();
    let wanted = fold(name);
    let length = wanted.chars().count();
    let limit = match length {
        // Names of one letter always resemble each other.
        0 | 1 => return None,
        // Two slips in four letters leave no likeness: `LTOD` is not meant by `VIOD`.
        2..=4 => 1,
        5..=LENGTH_MAX => 2,
        _ => return None,
    };
    names
        .take(CANDIDATES)
        .filter(|other| other.chars().count().abs_diff(length) <= limit)
        .map(|other| (between(&wanted, &fold(other)), other))
        .filter(|(distance, _)| *distance <= limit)
        // One other letter of two leaves no likeness either: `CV` is not meant by `CD`.
        .filter(|(_, other)| length > 2 || other.chars().count() != 2 || is_swapped(&wanted, &fold(other)))
        .min()
        .map(|(_, other)| other)
}

/// The same letters, perhaps in another order.
fn is_swapped(a: &str, b: &str) -> bool {
    a == b || a.chars().rev().eq(b.chars())
}

#[cfg(test)]
mod tests {
    use super::{between, nearest};

    #[test]
    fn finds_slips() {
        assert_eq!(nearest("nmae", ["cpu", "name"].into_iter()), Some("name"));
        assert_eq!(nearest("speed", ["cpu", "name"].into_iter()), None);
        assert_eq!(nearest("a", ["b"].into_iter()), None);
        assert_eq!(nearest("viod", ["ltod", "void"].into_iter()), Some("void"));
        assert_eq!(nearest("tonn", ["dint"].into_iter()), None);
        assert_eq!(nearest("cd", ["cv", "cu"].into_iter()), None);
        assert_eq!(nearest("vp", ["cv", "pv"].into_iter()), Some("pv"));
        assert_eq!(nearest("tp", ["tpx"].into_iter()), Some("tpx"));
    }

    #[test]
    fn counts_edits() {
        assert_eq!(between("contact", "contact"), 0);
        assert_eq!(between("kontact", "contact"), 1);
        assert_eq!(between("cont", "contact"), 3);
        assert_eq!(between("", "ab"), 2);
        assert_eq!(between("Pmup", "Pump"), 1);
        assert_eq!(between("ab", "ba"), 1);
        assert_eq!(between("a", ""), 1);
    }
}
