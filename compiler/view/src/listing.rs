//! Code as coloured text.

use plcc_diag::Span;

/// Lines of coloured text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Listing {
    pub kind: Kind,
    pub lines: Vec<String>,
    /// The first byte of each line in the source.
    pub starts: Vec<u32>,
}

/// The language, which decides the colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    #[default]
    Stl,
    Scl,
}

/// The text of statements with all that stands between them. `overlay`: the text is that of a file with its own notation, whose blanks mean nothing.
/// `exact`: lines are those of the source, with all their blanks.
pub fn of_spans(text: &str, spans: impl Iterator<Item = Span>, overlay: bool, kind: Kind, exact: bool) -> Listing {
    let spans: Vec<Span> = spans.collect();
    let slice = |start: usize, end: usize| text.get(start..end).unwrap_or_default();
    let (lines, starts) = match overlay {
        true => {
            let words = |span: &Span| {
                slice(span.start as usize, span.end as usize).split_whitespace().collect::<Vec<_>>().join(" ")
            };
            spans.iter().map(|span| (words(span), span.start)).filter(|(line, _)| !line.is_empty()).unzip()
        }
        false => {
            let start = spans.iter().map(|span| span.start as usize).min().unwrap_or(0);
            let end = spans.iter().map(|span| span.end as usize).max().unwrap_or(0);
            // Whole lines, with the comments after the statements.
            let start = text.get(..start).and_then(|before| before.rfind('\n')).map_or(0, |at| at + 1);
            let end = text.get(end..).and_then(|rest| rest.find('\n')).map_or(text.len(), |at| end + at);
            let cut = slice(start, end);
            let first = cut.lines().take_while(|line| line.trim().is_empty()).count();
            let lines = match (spans.is_empty(), exact) {
                (true, _) => Vec::new(),
                (false, true) => trimmed(cut.lines().map(|line| line.trim_end().to_string()).collect()),
                (false, false) => undented(cut),
            };
            let start_of = |line: &str| (start + line.as_ptr().addr() - cut.as_ptr().addr()) as u32;
            let starts = cut.lines().skip(first).take(lines.len()).map(start_of).collect();
            (lines, starts)
        }
    };
    Listing { kind, lines, starts }
}

/// Lines without the blank ones at both ends.
fn trimmed(lines: Vec<String>) -> Vec<String> {
    let first = lines.iter().position(|line| !line.is_empty()).unwrap_or(0);
    let last = lines.iter().rposition(|line| !line.is_empty()).map_or(first, |at| at + 1);
    lines[first..last].to_vec()
}

/// The lines of a text without their common blanks at the left, and without blank lines at both ends.
pub fn undented(text: &str) -> Vec<String> {
    let lines: Vec<String> = text.lines().map(|line| line.trim_end().replace('\t', "    ")).collect();
    let used = |line: &&String| !line.is_empty();
    let blanks = |line: &String| line.len() - line.trim_start_matches(' ').len();
    let common = lines.iter().filter(used).map(blanks).min().unwrap_or(0);
    let first = lines.iter().position(|line| !line.is_empty()).unwrap_or(0);
    let last = lines.iter().rposition(|line| !line.is_empty()).map_or(first, |at| at + 1);
    lines[first..last].iter().map(|line| line.get(common..).unwrap_or_default().to_string()).collect()
}
