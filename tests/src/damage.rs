//! Random damage of a text.

use crate::random::Random;

/// Numbers at and beyond the ends of ranges.
#[rustfmt::skip]
const ENDS: &[&str] = &[
    "0", "-1", "1", "32767", "32768", "65535", "65536", "2147483647", "2147483648", "4294967295", "4294967296",
    "9223372036854775807", "99999999999999999999", "1.0E38", "1e999", "16#FFFFFFFFFFFFFFFF", "2#2", "T#24D20H31M23S648MS",
    "DT#1990-1-1-0:0:0",
];

/// Words of all languages, for wrong positions.
#[rustfmt::skip]
pub const WORDS: &[&str] = &[
    "'", "''", "'\u{e4}'", "\"", "\"\"", "(", ")", "[", "]", "{", "}", "(*", "*)", "//", ";", ",", ".", "..", ":=",
    "=>", "#", "%", "%MW65535", "%M0.9", "DB0", "DB65535.DBW65535", "P#", "P#DB1.DBX 0.0 BYTE 65535", "[AR1,P#8191.7]",
    "Array[*] of Int", "Array[0..65535] of LReal", "Array[-2147483648..2147483647] of Bool", "String[254]", "String[0]",
    "WString[16382]", "Variant", "Any", "Pointer", "Void", "Struct", "END_STRUCT", "LReal", "LWord", "LTime", "DTL", "Bool", "VAR_IN_OUT", "VAR_TEMP",
    "END_VAR", "BEGIN", "IF", "END_IF", "CASE", "OF", "FOR", "WHILE", "REPEAT", "GOTO", "RETURN", "AND", "NOT", "MOD", "**", "/", "AT", "CALL",
    "\u{feff}", "\0", "\u{4e2d}", "<", ">", "&lt;", "/>", "</", "&#0;", "true",
];

/// The text with some damage, or unchanged. `other` is one of the same kind, and `words` are put into wrong positions.
pub fn damaged(random: &mut Random, text: &str, other: &str, words: &'static [&'static str]) -> String {
    let mut text = text.to_string();
    // The text unchanged, too.
    let rounds = if random.percent(2) { 0 } else { 1 + random.below(3) };
    for _ in 0..rounds {
        text = match random.below(10) {
            // Cut off.
            0 => {
                let at = (0..=random.below(text.len() + 1)).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
                text[..at].to_string()
            }
            // Two files in one.
            1 => {
                let (a, b): (Vec<&str>, Vec<&str>) = (text.lines().collect(), other.lines().collect());
                let (a_at, b_at) = (random.below(a.len() + 1), random.below(b.len() + 1));
                [&a[..a_at], &b[b_at..]].concat().join("\n")
            }
            2 | 3 => {
                let mut lines: Vec<&str> = text.lines().collect();
                let others: Vec<&str> = other.lines().collect();
                change(random, &mut lines, &others, words);
                lines.join("\n")
            }
            _ => {
                let mut parts = tokens(&text);
                let others = tokens(other);
                for _ in 0..1 + random.below(4) {
                    change(random, &mut parts, &others, words);
                }
                parts.concat()
            }
        };
    }
    text
}

/// The text in words, spaces and signs.
fn tokens(text: &str) -> Vec<&str> {
    let kind = |c: char| {
        if c.is_alphanumeric() || c == '_' {
            0
        } else if c.is_whitespace() {
            1
        } else {
            2
        }
    };
    let mut tokens = Vec::new();
    let mut start = 0;
    let mut before = None;
    for (at, c) in text.char_indices() {
        let now = kind(c);
        if before.is_some_and(|before| before != now || now == 2) {
            tokens.push(&text[start..at]);
            start = at;
        }
        before = Some(now);
    }
    tokens.push(&text[start..]);
    tokens
}

/// One change of a list of words or lines.
fn change<'t>(random: &mut Random, list: &mut Vec<&'t str>, other: &[&'t str], words: &'static [&'static str]) {
    if list.is_empty() || other.is_empty() {
        return;
    }
    let at = random.below(list.len());
    let end = (at + 1 + random.below(8)).min(list.len());
    match random.below(9) {
        0 => _ = list.remove(at),
        1 => _ = list.drain(at..end),
        2 => {
            let copy = list[at..end].to_vec();
            let to = random.below(list.len());
            list.splice(to..to, copy);
        }
        3 => {
            let to = random.below(list.len());
            list.swap(at, to);
        }
        4 => list[at] = word(random, words),
        5 => list.insert(at, word(random, words)),
        6 => list[at] = random.of(other),
        7 => {
            let from = random.below(other.len());
            let part = other[from..(from + 1 + random.below(12)).min(other.len())].to_vec();
            list.splice(at..at, part);
        }
        _ => {
            // Numbers go to their ends.
            if let Some(number) = list[at..].iter_mut().find(|word| word.starts_with(|c: char| c.is_ascii_digit())) {
                *number = random.of(ENDS);
            }
        }
    }
}

fn word(random: &mut Random, words: &'static [&'static str]) -> &'static str {
    if random.percent(20) { random.of(ENDS) } else { random.of(words) }
}
