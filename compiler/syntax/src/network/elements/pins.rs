//! Pins of an element, which its row has as words.

use super::Row;

/// A pin of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PinRow {
    /// Spellings with `|` between.
    text: &'static str,
    pub optional: bool,
    pub direction: PinDirection,
    pub numbered: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PinDirection {
    Input,
    Output,
    InOut,
}

impl PinRow {
    fn read(word: &'static str) -> PinRow {
        let optional = word.starts_with('?');
        let rest = word.trim_start_matches('?');
        let direction = match rest.as_bytes().first() {
            Some(b'>') => PinDirection::Output,
            Some(b'=') => PinDirection::InOut,
            _ => PinDirection::Input,
        };
        let rest = rest.trim_start_matches(['>', '=']);
        let numbered = rest.ends_with('+');
        PinRow { text: rest.trim_end_matches('+'), optional, direction, numbered }
    }

    /// Its name in the syntax tree; of numbered ones the first.
    pub fn name(&self) -> &'static str {
        self.text.split('|').next().unwrap_or(self.text)
    }

    /// Spellings in files; the first one is the name in the syntax tree.
    pub fn spellings(&self) -> impl Iterator<Item = &'static str> {
        self.text.split('|')
    }

    /// The name in the syntax tree of a pin that a file calls `given`: `IN3` is `in3` of `in1+`.
    pub fn matches(&self, given: &str) -> Option<String> {
        if self.text.split('|').any(|known| known.eq_ignore_ascii_case(given)) {
            return Some(self.name().to_string());
        }
        if !self.numbered {
            return None;
        }
        let name = self.name();
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let first: u32 = name[stem.len()..].parse().ok()?;
        self.text.split('|').find_map(|known| {
            let known = known.trim_end_matches(|c: char| c.is_ascii_digit());
            let head = given.get(..known.len())?;
            let digits = given.get(known.len()..)?;
            if !head.eq_ignore_ascii_case(known)
                || digits.starts_with('0') && digits.len() > 1
                || digits.starts_with('+')
            {
                return None;
            }
            let number: u32 = digits.parse().ok()?;
            (number >= first && number < first + PINS_MAX).then(|| format!("{stem}{number}"))
        })
    }
}

/// No element has more numbered pins than this.
const PINS_MAX: u32 = 256;

impl Row {
    /// The pins, in the order of the table.
    pub fn pins(&self) -> impl Iterator<Item = PinRow> {
        self.pins.split_whitespace().map(PinRow::read)
    }

    /// The pin that a file calls `given`, and its name in the syntax tree.
    pub fn pin(&self, given: &str) -> Option<(PinRow, String)> {
        self.pins().find_map(|pin| Some((pin, pin.matches(given)?)))
    }

    /// The element has EN and ENO.
    pub fn is_box(&self) -> bool {
        self.flow.0 == "en"
    }
}
