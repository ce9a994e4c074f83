//! How many slips of the keyboard are between two words, for suggestions.

/// Number of characters to add, remove, replace or swap with their neighbour to turn one word into the other (optimal string alignment).
pub fn between(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    let mut above = row.clone();
    let mut previous = None;
    for (line, a) in a.chars().enumerate() {
        let mut next = vec![line + 1; b.len() + 1];
        for (column, own) in b.iter().enumerate() {
            let replaced = row[column] + usize::from(a != *own);
            next[column + 1] = replaced.min(next[column] + 1).min(row[column + 1] + 1);
            if column > 0 && previous == Some(*own) && b[column - 1] == a {
                next[column + 1] = next[column + 1].min(above[column - 1] + 1);
            }
        }
        above = std::mem::replace(&mut row, next);
        previous = Some(a);
    }
    row[b.len()]
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
        2 | 3 => 1,
        4..=LENGTH_MAX => 2,
        _ => return None,
    };
    names
        .take(CANDIDATES)
        .filter(|other| other.chars().count().abs_diff(length) <= limit)
        .map(|other| (between(&wanted, &fold(other)), other))
        .filter(|(distance, _)| *distance <= limit)
        .min()
        .map(|(_, other)| other)
}

#[cfg(test)]
mod tests {
    use super::{between, nearest};

    #[test]
    fn finds_slips() {
        assert_eq!(nearest("nmae", ["cpu", "name"].into_iter()), Some("name"));
        assert_eq!(nearest("speed", ["cpu", "name"].into_iter()), None);
        assert_eq!(nearest("a", ["b"].into_iter()), None);
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
