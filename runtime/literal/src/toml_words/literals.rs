//! Values that are written as in a PLC program.

use std::ops::Range;

use super::Wrong;

/// `T#5s` or `16#FF` without quotation marks, at the `offset` of an error in the syntax or in the line before it: for TOML `#` begins a
/// comment, so the error is somewhere after it. With its place.
pub fn bare_literal(message: &str, text: &str, offset: usize) -> Option<(Range<usize>, Wrong)> {
    let of_values = ["unknown ", "invalid type", "invalid value", "invalid length", "missing field", "duplicate "];
    if of_values.iter().any(|start| message.starts_with(start)) {
        return None;
    }
    let end = (0..=offset.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or_default();
    let end = text[end..].find('\n').map_or(text.len(), |length| end + length);
    let last = text[..end].rfind('\n').map_or(0, |at| at + 1);
    let before = text[..last.saturating_sub(1)].rfind('\n').map_or(0, |at| at + 1);
    let range = [last..end, before..last].into_iter().find_map(|line| {
        let found = in_line(&text[line.clone()])?;
        Some(line.start + found.start..line.start + found.end)
    })?;
    let literal = &text[range.clone()];
    let title = format!("`{literal}` needs quotation marks: without them `#` begins a comment");
    Some((range, Wrong { title, help: format!("write `\"{literal}\"`") }))
}

/// The first literal outside of quotation marks whose `#` begins a comment.
fn in_line(line: &str) -> Option<Range<usize>> {
    let mut quote = None;
    let sign = line.char_indices().find_map(|(at, letter)| match (quote, letter) {
        (None, '"' | '\'') => {
            quote = Some(letter);
            None
        }
        (Some(open), letter) if open == letter => {
            quote = None;
            None
        }
        (None, '#') => Some(at),
        (None | Some(_), _) => None,
    })?;
    let is_word = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    let start = line[..sign].rfind(|letter: char| !is_word(letter)).map_or(0, |at| {
        // Blanks, signs and brackets of one byte or more.
        at + line[at..].chars().next().map_or(1, char::len_utf8)
    });
    let rest = &line[sign + 1..];
    let length = rest.find(|letter: char| !(is_word(letter) || ".:-+".contains(letter))).unwrap_or(rest.len());
    let is_value = line[..start].trim_end().ends_with(['=', '[', ',']);
    // `5#comment` and `true#comment` are values with comments.
    let prefix = &line[start..sign];
    let is_prefix = match prefix.starts_with(|letter: char| letter.is_ascii_digit()) {
        true => matches!(prefix, "2" | "8" | "16"),
        false => !matches!(prefix, "" | "true" | "false"),
    };
    (is_prefix && length > 0 && is_value).then_some(start..sign + 1 + length)
}

#[cfg(test)]
mod tests {
    use super::bare_literal;

    #[test]
    fn literals_without_quotation_marks_are_found() {
        let told = |text: &str, offset: usize| {
            let (range, wrong) = bare_literal("unclosed inline table, expected `}`", text, offset)?;
            Some((text[range].to_owned(), wrong.help))
        };
        let found = |literal: &str| Some((literal.to_owned(), format!("write `\"{literal}\"`")));
        assert_eq!(told("set = { \"A\" = T#5s }\nexpect = { }\n", 20), found("T#5s"));
        assert_eq!(told("set = { \"A\" = T#1.5s }\nexpect = { }\n", 25), found("T#1.5s"));
        assert_eq!(told("set = { A = 1, B = 16#FF, C = 2 }\n", 33), found("16#FF"));
        assert_eq!(told("cycle = 1 # in T#5s\nset = {\n", 26), None);
        assert_eq!(told("name = \"a#b\"\nset = {\n", 20), None);
        assert_eq!(told("cycle = 5#comment\nset = {\n", 24), None);
        assert_eq!(told("json = true#comment\nset = {\n", 26), None);
        let text = "set = { A = T#5s }\n";
        assert_eq!(bare_literal("unknown field `a`", text, 5), None);
    }
}
