//! Operands of STEP 5, for messages: `KT 50.1`, `KF +5`, `FW 10`, `DW 5`.

/// Values are shorter: what follows a word is looked at no further.
const VALUE_MAX: usize = 16;

/// The length of the operand that begins with `word` (upper case) in `rest`, the text after it, and what STEP 7 has for it.
pub fn meant(word: &str, rest: &str) -> Option<(usize, String)> {
    let blanks = rest.len() - rest.trim_start().len();
    let head = &rest[blanks..];
    let head = &head[..head.char_indices().nth(VALUE_MAX).map_or(head.len(), |(at, _)| at)];
    let value = head.split(|c: char| c.is_whitespace() || c == ';').next()?;
    if value.is_empty() || value.chars().count() == VALUE_MAX {
        return None;
    }
    let length = blanks + value.len();
    let number = || value.parse::<u32>().ok();
    let written = match word {
        "KF" | "KB" => value.trim_start_matches('+').parse::<i32>().ok()?.to_string(),
        "KH" if value.bytes().all(|digit| digit.is_ascii_hexdigit()) && value.len() <= 4 => {
            format!("W#16#{}", value.to_ascii_uppercase())
        }
        "KZ" | "KC" => format!("C#{}", number().filter(|count| *count <= 999)?),
        "KY" => {
            let (high, low) = value.split_once(',')?;
            format!("B#({},{})", high.parse::<u8>().ok()?, low.parse::<u8>().ok()?)
        }
        "KT" => {
            let (count, base) = value.split_once('.')?;
            duration(count.parse::<u32>().ok().filter(|count| *count <= 999)?, base)?
        }
        "F" => bit("M", value, |byte, bit| (byte, bit))?,
        "FY" => format!("MB {}", number()?),
        "FW" => format!("MW {}", number()?),
        "FD" => format!("MD {}", number()?),
        // Words of a data block are counted by their first bytes.
        "D" => bit("DBX", value, |word, bit| (2 * word + u32::from(bit < 8), bit % 8))?,
        "DL" => format!("DBB {}", 2 * number().filter(|word| *word < 0x8000)?),
        "DR" => format!("DBB {}", 2 * number().filter(|word| *word < 0x8000)? + 1),
        "DW" => format!("DBW {}", 2 * number().filter(|word| *word < 0x8000)?),
        "DD" => format!("DBD {}", 2 * number().filter(|word| *word < 0x8000)?),
        _ => return None,
    };
    Some((length, written))
}

/// `5.7`, with the place that STEP 7 gives it.
fn bit(area: &str, value: &str, place: impl Fn(u32, u32) -> (u32, u32)) -> Option<String> {
    let (first, bit) = value.split_once('.')?;
    let (byte, bit) = place(
        first.parse::<u32>().ok().filter(|first| *first < 0x8000)?,
        bit.parse::<u32>().ok().filter(|bit| *bit < 16)?,
    );
    (bit < 8).then(|| format!("{area} {byte}.{bit}"))
}

/// `S5T#5S` for 50 steps of 100 ms.
fn duration(count: u32, base: &str) -> Option<String> {
    let step = match base {
        "0" => 10,
        "1" => 100,
        "2" => 1_000,
        "3" => 10_000,
        _ => return None,
    };
    let mut rest = count * step;
    let mut parts = Vec::new();
    for (unit, letters) in [(3_600_000, "H"), (60_000, "M"), (1_000, "S"), (1, "MS")] {
        let many = rest / unit;
        rest %= unit;
        if many > 0 {
            parts.push(format!("{many}{letters}"));
        }
    }
    let text = if parts.is_empty() { "0MS".to_owned() } else { parts.join("_") };
    Some(format!("S5T#{text}"))
}

#[cfg(test)]
mod tests {
    use super::meant;

    #[test]
    fn counts_as_step_7_does() {
        let written = |word, rest| meant(word, rest).map(|(_, written)| written);
        assert_eq!(meant("KT", " 50.1;"), Some((5, "S5T#5S".to_owned())));
        assert_eq!(written("KT", " 15.3").as_deref(), Some("S5T#2M_30S"));
        assert_eq!(written("KF", " +5").as_deref(), Some("5"));
        assert_eq!(written("KH", " 00ff").as_deref(), Some("W#16#00FF"));
        assert_eq!(written("KY", " 1,2").as_deref(), Some("B#(1,2)"));
        assert_eq!(written("DW", " 5").as_deref(), Some("DBW 10"));
        assert_eq!(written("DR", " 5").as_deref(), Some("DBB 11"));
        assert_eq!(written("D", " 5.0").as_deref(), Some("DBX 11.0"));
        assert_eq!(written("D", " 5.8").as_deref(), Some("DBX 10.0"));
        assert_eq!(written("F", " 10.0").as_deref(), Some("M 10.0"));
        assert_eq!(written("MW", " 10"), None);
    }
}
