//! How many characters two words differ in, for suggestions.

/// Number of characters to add, remove or replace to turn one word into the other (Levenshtein).
pub fn between(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (line, a) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = line + 1;
        for (column, b) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(a != *b);
            diagonal = row[column + 1];
            row[column + 1] = replaced.min(row[column] + 1).min(diagonal + 1);
        }
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
    }
}
