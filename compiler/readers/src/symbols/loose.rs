//! Rows of tables in a form that plcc does not know: the address and the name are found by what they look like.

use plcc_syntax::Elementary;

use super::parse_address;

/// The parts of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row<'t> {
    pub name: &'t str,
    pub address: &'t str,
    /// Empty if no part is a data type.
    pub ty: &'t str,
}

/// No row of a table is longer; each of its gaps is compared with the ones after it.
const LENGTH_MAX: usize = 400;

/// The parts of a line: one is an address, and another one a name. `None`: the line has no such parts, or several addresses.
pub fn row(line: &str) -> Option<Row<'_>> {
    if line.len() > LENGTH_MAX {
        return None;
    }
    let parts: Vec<&str> = parts(line);
    let is_record = |part: &&&str| part.len() == 3 && part.bytes().all(|byte| byte.is_ascii_digit());
    let mut addresses = parts.iter().filter(|part| parse_address(part).is_some());
    let address = *addresses.next()?;
    if addresses.next().is_some() {
        return None;
    }
    let is_type = |part: &str| Elementary::from_word(&part.to_ascii_uppercase()).is_some();
    let ty = parts.iter().find(|part| is_type(part)).copied().unwrap_or_default();
    let mut names = parts.iter().filter(|part| **part != address && **part != ty && !is_record(part));
    let name = *names.next()?;
    Some(Row { name, address, ty })
}

/// What is between quotes, separators and gaps. One blank is part of an address such as `I 0.0`, and more are if a number follows letters.
fn parts(line: &str) -> Vec<&str> {
    let mut found = Vec::new();
    for field in line.split(|c: char| matches!(c, ',' | ';' | '\t' | '"' | '\u{feff}') || is_curved_quote(c)) {
        let mut rest = field.trim();
        while !rest.is_empty() {
            let end = gap(rest);
            found.push(rest[..end].trim());
            rest = rest[end..].trim_start();
        }
    }
    found.retain(|part| !part.is_empty());
    found
}

/// A quote of a text processor.
pub fn is_curved_quote(c: char) -> bool {
    matches!(c, '“' | '”' | '„')
}

/// Where the first part of `text` ends: at a gap of two blanks or more, unless the blanks are inside an address.
fn gap(text: &str) -> usize {
    let end = text.find("  ").unwrap_or(text.len());
    let after = text[end..].trim_start();
    let number = after.find(|c: char| c.is_whitespace()).unwrap_or(after.len());
    let whole = text.len() - after.len() + number;
    if number > 0 && parse_address(&text[..whole]).is_some() {
        return whole;
    }
    let blanks = |text: &str| -> Vec<usize> { text.match_indices(' ').map(|(at, _)| at).collect() };
    let first = &text[..end];
    let is_address = |text: &str, end: usize| parse_address(&text[..end]).is_some();
    // `I 0.0 BOOL`: the address comes first. `Key I 0.0 BOOL`: the part ends before the address.
    let after_address = blanks(first).into_iter().rfind(|at| is_address(first, *at));
    let before_address = blanks(first).into_iter().find(|at| {
        let rest = &first[at + 1..];
        blanks(rest).into_iter().chain([rest.len()]).any(|end| is_address(rest, end))
    });
    after_address.or(before_address).unwrap_or(end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_found_by_what_they_look_like() {
        let of = |line| row(line).map(|row| (row.name, row.address, row.ty));
        assert_eq!(of("126,Key\tI 0.0\tBOOL\t"), Some(("Key", "I 0.0", "BOOL")));
        assert_eq!(of("126,Lamp                  Q       4.0 BOOL     "), Some(("Lamp", "Q       4.0", "BOOL")));
        assert_eq!(of("\"Lamp\" \"Q 4.0\",\"BOOL\",\"\""), Some(("Lamp", "Q 4.0", "BOOL")));
        assert_eq!(of("126,Main key I 0.0 BOOL"), Some(("Main key", "I 0.0", "BOOL")));
        assert_eq!(of("  I 0.0  Key"), Some(("Key", "I 0.0", "")));
        assert_eq!(of("“Main key”,“I 0.0”,“BOOL”,“”"), Some(("Main key", "I 0.0", "BOOL")));
        for line in ["", "Lamp", "I 0.0", "I 0.0; Q 0.0; x", "a text of several words"] {
            assert_eq!(of(line), None, "{line}");
        }
    }
}
