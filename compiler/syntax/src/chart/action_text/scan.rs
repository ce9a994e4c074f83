//! The text of actions without its comments, and where its parts begin and end. The contents of quoted names and texts are ignored.

use std::ops::Range;

/// A part of a text; ranges refer to the whole text.
pub struct Code {
    start: usize,
    /// The part, with blanks in place of comments.
    code: String,
    /// Places and texts of comments.
    comments: Vec<(usize, String)>,
}

/// A character outside quotes.
struct Sign {
    at: usize,
    sign: u8,
    /// How many parentheses and brackets are open before it.
    depth: usize,
}

impl Code {
    pub fn of(text: &str, range: Range<usize>) -> Code {
        let part = text.get(range.clone()).unwrap_or_default();
        let mut code = part.as_bytes().to_vec();
        let mut comments = Vec::new();
        let mut at = 0;
        while at < code.len() {
            let rest = &part.as_bytes()[at..];
            let length = match rest {
                [quote @ (b'"' | b'\''), ..] => {
                    at += quoted_length(rest, *quote);
                    continue;
                }
                [b'/', b'/', ..] => rest.iter().position(|sign| *sign == b'\n').unwrap_or(rest.len()),
                [b'(', b'*', ..] => {
                    rest.windows(2).skip(2).position(|pair| pair == b"*)").map_or(rest.len(), |end| end + 4)
                }
                _ => {
                    at += 1;
                    continue;
                }
            };
            let comment = part.get(at..at + length).unwrap_or_default();
            let inner = comment.trim_start_matches(['/', '(', '*']).trim_end_matches(['*', ')']).trim();
            comments.push((range.start + at, inner.to_string()));
            code[at..at + length].fill(b' ');
            at += length;
        }
        // Comments are whole characters.
        let code = String::from_utf8(code).unwrap_or_default();
        Code { start: range.start, code, comments }
    }

    fn text(&self, range: Range<usize>) -> &str {
        let place = range.start.saturating_sub(self.start)..range.end.saturating_sub(self.start);
        self.code.get(place).unwrap_or_default()
    }

    /// The characters of a range that are outside quotes.
    fn signs(&self, range: Range<usize>) -> Vec<Sign> {
        let bytes = self.text(range.clone()).as_bytes();
        let mut found = Vec::new();
        let mut depth: usize = 0;
        let mut at = 0;
        while let Some(sign) = bytes.get(at).copied() {
            if matches!(sign, b'"' | b'\'') {
                at += quoted_length(&bytes[at..], sign);
                continue;
            }
            if matches!(sign, b')' | b']') {
                depth = depth.saturating_sub(1);
            }
            found.push(Sign { at: range.start + at, sign, depth });
            if matches!(sign, b'(' | b'[') {
                depth += 1;
            }
            at += 1;
        }
        found
    }

    /// Lines; those inside parentheses belong to the line that opens them.
    pub fn lines(&self) -> Vec<Range<usize>> {
        let all = self.start..self.start + self.code.len();
        let is_end = |sign: &Sign| sign.sign == b'\n' && sign.depth == 0;
        let ends: Vec<usize> = self.signs(all.clone()).iter().filter(|sign| is_end(sign)).map(|sign| sign.at).collect();
        parts(all, ends.into_iter().map(|end| end..end + 1))
    }

    /// A range without blanks at its ends, and without the semicolon at its end.
    pub fn trimmed(&self, range: Range<usize>) -> Range<usize> {
        let text = self.text(range.clone());
        let blank = |c: char| c.is_whitespace();
        let end = range.start + text.trim_end_matches(|c: char| blank(c) || c == ';').len();
        let start = range.start + (text.len() - text.trim_start_matches(blank).len());
        start.min(end)..end
    }

    /// The first comment in a range.
    pub fn comment(&self, range: Range<usize>) -> Option<String> {
        let found = self.comments.iter().find(|(at, text)| range.contains(at) && !text.is_empty());
        found.map(|(_, text)| text.clone())
    }

    /// The word that a range begins with, and where the text after it begins. The word may be empty.
    pub fn word(&self, range: Range<usize>) -> (&str, usize) {
        let text = self.text(range.clone());
        let length = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
        let after = text[length..].len() - text[length..].trim_start().len();
        (&text[..length], range.start + length + after)
    }

    /// Commas and `:=` outside parentheses.
    pub fn separators(&self, range: Range<usize>) -> Vec<Range<usize>> {
        let signs = self.signs(range);
        let mut found = Vec::new();
        for (at, sign) in signs.iter().enumerate().filter(|(_, sign)| sign.depth == 0) {
            let next = signs.get(at + 1).filter(|next| next.at == sign.at + 1).map(|next| next.sign);
            match (sign.sign, next) {
                (b',', _) => found.push(sign.at..sign.at + 1),
                (b':', Some(b'=')) => found.push(sign.at..sign.at + 2),
                _ => {}
            }
        }
        found
    }

    /// The first parenthesis that opens in a range, and the one that closes it.
    pub fn parentheses(&self, range: Range<usize>) -> Option<(usize, Option<usize>)> {
        let signs = self.signs(range);
        let open = signs.iter().position(|sign| sign.sign == b'(')?;
        let depth = signs[open].depth;
        let close = signs[open..].iter().find(|sign| sign.sign == b')' && sign.depth == depth);
        Some((signs[open].at, close.map(|sign| sign.at)))
    }

    /// The parts of a range between commas and line ends, without outer blanks.
    pub fn parameters(&self, range: Range<usize>) -> Vec<Range<usize>> {
        let is_end = |sign: &Sign| sign.depth == 0 && matches!(sign.sign, b',' | b'\n' | b';');
        let ends: Vec<usize> =
            self.signs(range.clone()).iter().filter(|sign| is_end(sign)).map(|sign| sign.at).collect();
        let found = parts(range, ends.into_iter().map(|end| end..end + 1));
        found.into_iter().map(|part| self.trimmed(part)).filter(|part| !part.is_empty()).collect()
    }

    /// `:=` or `=>` outside parentheses.
    pub fn arrow(&self, range: Range<usize>) -> Option<Range<usize>> {
        let signs = self.signs(range);
        let is_arrow = |pair: &&[Sign]| {
            let [first, second] = pair else { return false };
            let together = first.depth == 0 && second.at == first.at + 1;
            together && matches!((first.sign, second.sign), (b':', b'=') | (b'=', b'>'))
        };
        signs.windows(2).find(is_arrow).map(|pair| pair[0].at..pair[1].at + 1)
    }
}

/// The part of a range between the given ends.
fn parts(range: Range<usize>, ends: impl Iterator<Item = Range<usize>>) -> Vec<Range<usize>> {
    let mut start = range.start;
    let mut found = Vec::new();
    for end in ends {
        found.push(start..end.start);
        start = end.end;
    }
    found.push(start..range.end);
    found
}

/// Length of a text in quotes; a text that is not closed ends with the line.
fn quoted_length(rest: &[u8], quote: u8) -> usize {
    let inside = &rest[1..];
    match inside.iter().position(|sign| *sign == quote || *sign == b'\n') {
        Some(end) if inside[end] == quote => end + 2,
        Some(end) => end + 1,
        None => rest.len(),
    }
}
