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

#[cfg(test)]
mod tests {
    use super::between;

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
