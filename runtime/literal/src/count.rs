//! Numbers of things in messages.

/// `1 cycle`, `12 cycles`. `thing` is a word whose plural ends in `s`.
pub fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::counted;

    #[test]
    fn one_is_not_several() {
        assert_eq!([0, 1, 12].map(|count| counted(count, "cycle")), ["0 cycles", "1 cycle", "12 cycles"]);
    }
}
