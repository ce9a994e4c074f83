//! Which operands are forced.

use std::collections::HashMap;
use std::ops;

/// The areas whose addresses are marked, the longer names first.
const AREAS: [&str; 9] = ["PI", "PQ", "SM", "AI", "AQ", "I", "Q", "M", "V"];

/// The addresses that are forced.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Forcing {
    ranges: Vec<Range>,
    /// It is at the modules: what is read and written directly is forced too.
    modules: bool,
}

/// Bits of an area.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Range {
    area: &'static str,
    from: u64,
    to: u64,
}

impl Forcing {
    pub fn new<'a>(addresses: impl Iterator<Item = &'a str>, modules: bool) -> Forcing {
        Forcing { ranges: addresses.filter_map(range).collect(), modules }
    }

    /// Whether an operand with this address has forced bits.
    pub fn has(&self, address: &str) -> bool {
        let Some(operand) = range(address) else { return false };
        let area = match operand.area {
            "PI" if self.modules => "I",
            "PQ" if self.modules => "Q",
            area => area,
        };
        self.ranges.iter().any(|forced| forced.area == area && forced.from < operand.to && operand.from < forced.to)
    }
}

/// The bits of an address: `I0.0`, `QW4`, `PIW256`.
fn range(address: &str) -> Option<Range> {
    let (area, rest) = AREAS.iter().find_map(|area| Some((*area, address.strip_prefix(*area)?)))?;
    let (bits, rest) = match rest.chars().next()? {
        'B' => (8, &rest[1..]),
        'W' => (16, &rest[1..]),
        'D' => (32, &rest[1..]),
        'L' => (64, &rest[1..]),
        _ => (1, rest),
    };
    let (byte, bit) = match rest.split_once('.') {
        Some((byte, bit)) => (byte, bit.parse::<u32>().ok()?),
        // `i1` is a variable.
        None if bits == 1 => return None,
        None => (rest, 0),
    };
    let from = u64::from(byte.parse::<u32>().ok()?) * 8 + u64::from(bit);
    Some(Range { area, from, to: from + bits })
}

/// Addresses of symbols, by their names in small letters.
pub type Symbols = HashMap<String, String>;

/// The operands of a line of STL or SCL that have addresses: where they are in it, in bytes, and their addresses.
pub fn operands(line: &str, symbols: &Symbols) -> Vec<(ops::Range<usize>, String)> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(first) = line[at..].chars().next() {
        let rest = &line[at..];
        let mut end = at + first.len_utf8();
        if rest.starts_with("//") {
            break;
        } else if first == '"' || first == '\'' {
            end = rest[1..].find(first).map_or(line.len(), |close| at + close + 2);
            let name = line[at..end].trim_matches('"').to_lowercase();
            found.extend(symbols.get(&name).filter(|_| first == '"').map(|address| (at..end, address.clone())));
        } else if is_part(first) {
            end = at + rest.find(|letter: char| !is_part(letter)).unwrap_or(rest.len());
            // `MW 10` is an address too.
            let number = line[end..].trim_start_matches(' ');
            let digits = number.find(|letter: char| !letter.is_ascii_digit() && letter != '.').unwrap_or(number.len());
            let blanks = line.len() - end - number.len();
            let word = &line[at..end];
            if let Some(address) = absolute(word) {
                found.push((at..end, address));
            } else if let Some(address) = absolute(&format!("{word}{}", &number[..digits])).filter(|_| digits > 0) {
                end += blanks + digits;
                found.push((at..end, address));
            } else {
                found.extend(symbols.get(&word.to_lowercase()).map(|address| (at..end, address.clone())));
            }
        }
        at = end;
    }
    found
}

/// Whether a letter belongs to a word.
fn is_part(letter: char) -> bool {
    letter.is_alphanumeric() || matches!(letter, '_' | '%' | '#' | '.')
}

/// An address in the international mnemonics, if a word is one.
fn absolute(word: &str) -> Option<String> {
    let word = word.strip_prefix('%').unwrap_or(word).to_ascii_uppercase();
    let german = |word: &str| match word.split_at_checked(1)? {
        ("E", rest) => Some(format!("I{rest}")),
        ("A", rest) if !rest.starts_with(['I', 'Q']) => Some(format!("Q{rest}")),
        _ => None,
    };
    let address = match word.strip_prefix('P') {
        Some(rest) => german(rest).map(|rest| format!("P{rest}")),
        None => german(&word),
    };
    let address = address.unwrap_or(word);
    range(&address).is_some().then_some(address)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operands_with_forced_bits_are_forced() {
        let forcing = Forcing::new(["I0.3", "QW4", "PIW256", "nothing"].into_iter(), false);
        for (address, expected) in [
            ("I0.3", true),
            ("I0.4", false),
            ("IB0", true),
            ("ID0", true),
            ("QB5", true),
            ("QB6", false),
            ("Q4.7", true),
            ("PIB257", true),
            ("PI0.3", false),
            ("IW256", false),
            ("M0.3", false),
            ("#I0.3", false),
            ("", false),
            ("I", false),
            ("IW", false),
        ] {
            assert_eq!(forcing.has(address), expected, "{address}");
        }
        assert!(Forcing::new(["IW256"].into_iter(), true).has("PIW256"));
    }

    #[test]
    fn addresses_and_symbols_of_a_line_are_found() {
        let symbols = [("switch", "I0.3"), ("motor on", "Q4.0")].map(|(name, at)| (name.to_string(), at.to_string()));
        let symbols = Symbols::from(symbols);
        for (line, expected) in [
            ("      A     I 0.0;", &[("I 0.0", "I0.0")][..]),
            ("U E 0.0 // E 1.0", &[("E 0.0", "I0.0")]),
            ("T PAW 256", &[("PAW 256", "PQW256")]),
            ("%MW10 := Switch + \"Motor on\";", &[("%MW10", "MW10"), ("Switch", "I0.3"), ("\"Motor on\"", "Q4.0")]),
            ("#switch := 'I0.0'; x := \"nobody", &[]),
            ("L W#16#1234; A(; T 5; ü", &[]),
            ("i1 := M2 + e3 * Q 4;", &[]),
            ("LD SM0.1 AIW4", &[("SM0.1", "SM0.1"), ("AIW4", "AIW4")]),
        ] {
            let found = operands(line, &symbols);
            let found: Vec<_> = found.iter().map(|(place, address)| (&line[place.clone()], address.as_str())).collect();
            assert_eq!(found, expected, "{line}");
        }
    }
}
