//! `a` or `an` before a word of a message.

/// Words that are read letter by letter, and begin with the sound of a vowel.
const SPELT: [&str; 12] = ["FB", "FC", "SFB", "SFC", "SDB", "S5TIME", "LREAL", "LINT", "LWORD", "LTIME", "LTOD", "LDT"];

/// The words with their article: `an INT`, `a UDT`, `an FB`, `an 8-bit byte`.
pub fn with_article(words: &str) -> String {
    format!("{} {words}", article(words))
}

fn article(words: &str) -> &'static str {
    let word = words.trim_start_matches(['`', '"', '#']).split([' ', '-', '`', '[']).next().unwrap_or_default();
    let vowel = match word.bytes().next() {
        // `a UDT`, `a unit`, but `an update`
        Some(b'U') => false,
        Some(b'u') => word.starts_with("up") || word.starts_with("un") && !word.starts_with("uni"),
        Some(first) => {
            matches!(first.to_ascii_lowercase(), b'a' | b'e' | b'i' | b'o')
                || matches!(word, "8" | "11" | "18")
                || SPELT.contains(&word)
        }
        None => false,
    };
    if vowel { "an" } else { "a" }
}

#[cfg(test)]
mod tests {
    use super::with_article;

    #[test]
    fn the_sound_decides() {
        for words in
            ["an INT", "an `ORGANIZATION_BLOCK`", "an FB", "an 8-bit byte", "an edge", "an update", "an S5TIME"]
        {
            assert_eq!(with_article(words.trim_start_matches("an ")), words);
        }
        for words in ["a BOOL", "a UDT", "a USINT", "a unit of a pulse", "a 16-bit word", "a DB", "a `FUNCTION`"] {
            assert_eq!(with_article(words.trim_start_matches("a ")), words);
        }
    }
}
