//! Addresses of other controllers, for messages: `N7:0`, `B3:0/1`, `T4:0.ACC` of a SLC 500 or PLC-5.

/// Letters of the files of an Allen-Bradley controller, and what they hold.
const FILES: [(&str, &str); 10] = [
    ("N", "integers"),
    ("B", "bits"),
    ("F", "REAL values"),
    ("I", "inputs"),
    ("O", "outputs"),
    ("S", "the status"),
    ("T", "timers"),
    ("C", "counters"),
    ("R", "controls"),
    ("L", "double integers"),
];

/// A foreign address, and what to say of it.
pub struct ForeignAddress {
    /// Length in the text.
    pub length: usize,
    pub title: String,
    pub help: &'static str,
}

/// The address at the beginning of `text`.
pub fn at(text: &str) -> Option<ForeignAddress> {
    let letter = text.get(..1)?.to_ascii_uppercase();
    let (_, holds) = FILES.iter().find(|(known, _)| *known == letter)?;
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let colon = 1 + digits(1);
    if text.as_bytes().get(colon) != Some(&b':') {
        return None;
    }
    let mut length = colon + 1;
    match digits(length) {
        0 => return None,
        count => length += count,
    }
    while let Some(b'/' | b'.') = text.as_bytes().get(length) {
        let word = text[length + 1..].bytes().take_while(u8::is_ascii_alphanumeric).count();
        if word == 0 {
            break;
        }
        length += 1 + word;
    }
    let written = &text[..length];
    Some(ForeignAddress {
        length,
        title: format!("`{written}` is an address of an Allen-Bradley controller, whose file {letter} holds {holds}"),
        help: match letter.as_str() {
            "I" => "name the input by its address in this station, as in `I0.0`, or by its symbol",
            "O" => "name the output by its address in this station, as in `Q0.0`, or by its symbol",
            "T" | "C" => "name the timer or counter of this program, such as `T5` or `C5`, or an instance",
            _ => "declare a variable in the block or in a data block, and write its name",
        },
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn takes_the_whole_address() {
        let length = |text| super::at(text).map(|address| address.length);
        assert_eq!(length("N7:0;"), Some(4));
        assert_eq!(length("B3:0/1"), Some(6));
        assert_eq!(length("T4:0.ACC > 5"), Some(8));
        assert_eq!(length("I:0/1"), Some(5));
        assert_eq!(length("N7: 5"), None);
        assert_eq!(length("NAME:5"), None);
        assert_eq!(length("N7:=5"), None);
        assert_eq!(length("ä:1"), None);
    }
}
