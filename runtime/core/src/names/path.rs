//! The parts of a symbolic name: `"Station_DB".D1.m[2, 3].%X3`.

use std::ops::Range;

use crate::address::digits;

/// A part of a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Part {
    /// Without its quotes.
    Name(String),
    Index(Vec<i64>),
    /// Part of a bit string: its width in bits and its number, 0 at the right.
    Slice(u32, u32),
}

/// Splits a name at points and brackets outside of quotes. `None`: it is not a name.
pub fn parts(text: &str) -> Option<Vec<Part>> {
    Some(placed(text)?.into_iter().map(|(part, _)| part).collect())
}

/// The parts of a name as [`parts`] finds them, each with its bytes in the text; those of a name are without its quotes.
pub fn placed(text: &str) -> Option<Vec<(Part, Range<usize>)>> {
    let text = text.trim_end();
    let at = |rest: &str| text.len() - rest.len();
    let mut parts = Vec::new();
    let mut rest = text.trim_start();
    loop {
        let (part, start, length, after) = match rest.strip_prefix('"') {
            Some(quoted) => {
                let (name, after) = quoted.split_once('"')?;
                (Part::Name(name.to_string()), at(quoted), name.len(), after)
            }
            None => {
                let (name, after) = rest.split_at(rest.find(['.', '[']).unwrap_or(rest.len()));
                let name = name.trim_end();
                let slice = name.strip_prefix('%').filter(|_| !parts.is_empty()).and_then(slice);
                (slice.unwrap_or_else(|| Part::Name(name.to_string())), at(rest), name.len(), after)
            }
        };
        if part == Part::Name(String::new()) {
            return None;
        }
        parts.push((part, start..start + length));
        rest = after.trim_start();
        while let Some(list) = rest.strip_prefix('[') {
            let (list, after) = list.split_once(']')?;
            let indices = list.split(',').map(|index| index.trim().parse().ok()).collect::<Option<_>>()?;
            parts.push((Part::Index(indices), at(rest)..at(after)));
            rest = after.trim_start();
        }
        match rest.strip_prefix('.') {
            Some(after) => rest = after.trim_start(),
            None if rest.is_empty() => return Some(parts),
            None => return None,
        }
    }
}

/// `X3`, `B1`, `W0`, `D1`.
fn slice(text: &str) -> Option<Part> {
    let width = match text.chars().next()?.to_ascii_uppercase() {
        'X' => 1,
        'B' => 8,
        'W' => 16,
        'D' => 32,
        _ => return None,
    };
    Some(Part::Slice(width, digits(&text[1..])?))
}

/// A part of a name as a user writes it: in quotes if it has other characters than letters, digits and `_`.
pub fn written(name: &str) -> String {
    let is_plain = !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_');
    if is_plain { name.to_string() } else { format!("\"{name}\"") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(text: &str) -> Part {
        Part::Name(text.to_string())
    }

    #[test]
    fn names_indices_and_slices() {
        let all = parts("\"Station.1\".D1 . m[2, -3][0].\"a b\".%X3");
        let expected = [
            name("Station.1"),
            name("D1"),
            name("m"),
            Part::Index(vec![2, -3]),
            Part::Index(vec![0]),
            name("a b"),
            Part::Slice(1, 3),
        ];
        assert_eq!(all.as_deref(), Some(&expected[..]));
        assert_eq!(parts("Tag.%w1"), Some(vec![name("Tag"), Part::Slice(16, 1)]));
    }

    #[test]
    fn parts_have_places() {
        let text = " \"Station.1\" . m [2].%X3 ";
        let places: Vec<&str> = placed(text).into_iter().flatten().map(|(_, place)| &text[place]).collect();
        assert_eq!(places, ["Station.1", "m", "[2]", "%X3"]);
    }

    #[test]
    fn what_is_no_name() {
        for text in ["", ".", "a.", ".a", "a..b", "a[", "a[x]", "a[]", "\"a", "\"a\"b", "a[1]b"] {
            assert_eq!(parts(text), None, "{text}");
        }
    }
}
