//! What a source in SIMATIC SD shows of elements beyond their tree: how names are spelt, pins that nothing is connected to, signs.

use std::ops::Range;

use plcc_diag::Span;
use plcc_syntax::network::elements::{self, Kind, Row};

/// An element as its author wrote it.
pub struct Element<'s> {
    /// `S_CU`, without the instance before it.
    pub name: &'s str,
    /// Where its arguments are.
    pub arguments: Range<u32>,
    /// Pins that are open, with their signs and places: `et =>`.
    pub open: Vec<(u32, String)>,
}

/// The element at a place of a source, if an element of that row is there, with or without a negation in its name.
pub fn element<'s>(source: &'s str, span: Span, row: &'static Row, usual: &str) -> Option<Element<'s>> {
    let text = source.get(span.range())?;
    let name = text.rsplit_once('.').map_or(text, |(_, name)| name).trim();
    let (found, is_negated) = elements::find_sd(name)?;
    // The name of a comparison says whether the network is LAD or FBD, which may be another one now.
    let has_language = matches!(row.kind, Kind::Compare(_)) && !name.eq_ignore_ascii_case(usual);
    if found.name != row.name || is_negated != elements::find_sd(usual)?.1 || has_language {
        return None;
    }
    let ranges = arguments(source, span.end as usize)?;
    let (first, last) = (ranges.first()?.start, ranges.last()?.end);
    let open = ranges.into_iter().filter_map(|range| Some((range.start as u32, open_pin(source.get(range)?, row)?)));
    Some(Element { name, arguments: first as u32..last as u32, open: open.collect() })
}

/// `et =>`; `None`: something is connected.
fn open_pin(argument: &str, row: &Row) -> Option<String> {
    let argument = argument.trim();
    let sign = ["=>", ":="].into_iter().find(|sign| argument.ends_with(sign))?;
    let (_, name) = row.pin(argument.strip_suffix(sign)?.trim())?;
    (name != row.flow.0).then(|| format!("{name} {sign}"))
}

/// Whether `A()` follows a place, which hands the flow on from an operand to a box.
pub fn passes_on(source: &str, after: u32) -> bool {
    let rest = source.get(after as usize..).unwrap_or_default().trim_start();
    let rest = rest.strip_prefix(['A', 'a']).map(str::trim_start).and_then(|rest| rest.strip_prefix('('));
    rest.is_some_and(|rest| rest.trim_start().starts_with(')'))
}

/// Whether `NOT` stands directly before a place.
pub fn is_negated(source: &str, before: u32) -> bool {
    let text = source.get(..before as usize).unwrap_or_default().trim_end();
    let word = text.len().checked_sub(3).and_then(|at| text.get(at..).zip(text.get(..at)));
    word.is_some_and(|(word, rest)| {
        word.eq_ignore_ascii_case("NOT")
            && !rest.ends_with(|c: char| c.is_alphanumeric() || matches!(c, '_' | '#' | '.'))
    })
}

/// Whether a pin is written without its name: `Inc( #n )`.
pub fn is_unnamed(source: &str, pin: Span) -> bool {
    let text = source.get(pin.range()).unwrap_or_default();
    // The place of a pin that comes from a statement is its operand alone.
    let before = source.get(..pin.start as usize).unwrap_or_default().trim_end();
    before.ends_with(['(', ',']) && !text.is_empty() && !text.contains(":=") && !text.contains("=>")
}

/// Whether a pin is written with `:=`, as an output of some coils may be: `operand := #a`.
pub fn is_assigned(source: &str, pin: Span, name: &str) -> bool {
    let text = source.get(pin.range()).unwrap_or_default().trim_start();
    let is_name = text.get(..name.len()).is_some_and(|own| own.eq_ignore_ascii_case(name));
    is_name && text[name.len()..].trim_start().starts_with(":=")
}

/// The places of the arguments in the brackets that follow a byte, after settings at most.
fn arguments(source: &str, from: usize) -> Option<Vec<Range<usize>>> {
    let mut found = Vec::new();
    let (mut at, mut depth, mut braces, mut start) = (from, 0_usize, 0_usize, from);
    while at < source.len() {
        let end = end_of(source, at)?;
        match source.get(at..end)? {
            "{" => braces += 1,
            "}" => braces = braces.checked_sub(1)?,
            _ if braces > 0 => {}
            "(" if depth == 0 => (depth, start) = (1, end),
            "(" | "[" if depth > 0 => depth += 1,
            ")" | "]" if depth == 1 => {
                found.push(start..at);
                return Some(found);
            }
            ")" | "]" => depth = depth.checked_sub(1)?,
            "," if depth == 1 => {
                found.push(start..at);
                start = end;
            }
            other if depth == 0 && !(other.trim().is_empty() || other.starts_with("//") || other.starts_with("(*")) => {
                return None;
            }
            _ => {}
        }
        at = end;
    }
    None
}

/// The end of what begins at a byte: a text or a name in quotes, a comment, or one character.
fn end_of(source: &str, at: usize) -> Option<usize> {
    let rest = source.get(at..)?;
    let closed = |sign: &str, open: usize| Some(at + open + rest.get(open..)?.find(sign)? + sign.len());
    match rest.as_bytes() {
        [b'"', ..] => closed("\"", 1),
        [b'\'', ..] => {
            let mut is_escaped = false;
            let mut rest = rest.char_indices().skip(1);
            let (end, _) = rest.find(|(_, c)| {
                let ends = *c == '\'' && !is_escaped;
                is_escaped = *c == '$' && !is_escaped;
                ends
            })?;
            Some(at + end + 1)
        }
        [b'/', b'/', ..] => Some(at + rest.find('\n').unwrap_or(rest.len())),
        [b'(', b'*', ..] => closed("*)", 2),
        [b'/', b'*', ..] => closed("*/", 2),
        _ => Some(at + rest.chars().next()?.len_utf8()),
    }
}
