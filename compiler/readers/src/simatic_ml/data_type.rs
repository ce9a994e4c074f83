//! Data types of members as the export has them: `Array[0..3] of "Motor"`, `String[20]`, `TON_TIME`.

use std::ops::Range;

use plcc_diag::Span;
use plcc_literal::distance::nearest;

use super::reader::Reader;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{BlockName, BlockPrefix, Bound, TypeKind, TypeRef};
use plcc_syntax::scl::{bound, fragment};

/// How many `Array of` one type may have.
const DEPTH_MAX: usize = 16;

/// Types that are not single values, and others than those of the CPU's variables; `DT` is short for one of them.
const OTHERS: [&str; 10] =
    ["STRING", "WSTRING", "DATE_AND_TIME", "DT", "DTL", "TIMER", "COUNTER", "POINTER", "VARIANT", "ANY"];
/// Types of other languages, and what STEP 7 calls them.
const FOREIGN: [(&str, &str); 4] = [("INTEGER", "INT"), ("BOOLEAN", "BOOL"), ("FLOAT", "REAL"), ("DOUBLE", "LREAL")];

/// The type that a slip means; `None`: a type, or a word that resembles none.
pub fn meant(word: &str) -> Option<&'static str> {
    let word = word.trim().split('[').next().unwrap_or_default().trim_end();
    let upper = word.to_ascii_uppercase();
    if Elementary::from_word(&upper).is_some() || OTHERS.contains(&upper.as_str()) || word.contains('"') {
        return None;
    }
    let foreign = |name: &str| FOREIGN.iter().find(|(foreign, _)| *foreign == name).map(|(_, own)| *own);
    foreign(&upper)
        .or_else(|| nearest(word, Elementary::ALL.into_iter().map(|ty| ty.name()).chain(OTHERS)))
        .or_else(|| foreign(nearest(word, FOREIGN.iter().map(|(foreign, _)| *foreign))?))
}

/// The type in `range` of the overlay.
pub fn read(reader: &mut Reader, range: Range<usize>) -> TypeRef {
    at_depth(reader, range, 0)
}

fn at_depth(reader: &mut Reader, range: Range<usize>, depth: usize) -> TypeRef {
    let whole = reader.overlay.text().get(range.clone()).unwrap_or_default();
    let range = range.start + (whole.len() - whole.trim_start().len())..range.start + whole.trim_end().len();
    let text = whole.trim().to_string();
    let span = Span::new(reader.file, range.clone());
    let lower = text.to_ascii_lowercase();
    let inner = |from: usize, to: usize| range.start + from..range.start + to;
    let kind = if let Some(head) = bracketed(&lower, "array")
        && let Some(of) = lower[head.end + 1..].find("of").map(|of| head.end + 1 + of)
        && lower[head.end + 1..of].trim().is_empty()
        && depth < DEPTH_MAX
    {
        let element = Box::new(at_depth(reader, inner(of + 2, text.len()), depth + 1));
        let dimensions = split(&text, head, ",");
        if dimensions.iter().any(|dimension| text[dimension.clone()].trim() == "*") {
            TypeKind::OpenArray { dimensions: dimensions.len().min(255) as u8, element }
        } else {
            let mut bounds = Vec::new();
            for dimension in dimensions {
                let ends = split(&text, dimension.clone(), "..");
                let low = ends.first().cloned().unwrap_or(dimension);
                let high = ends.last().cloned().unwrap_or(low.clone());
                bounds.push((limit(reader, inner(low.start, low.end)), limit(reader, inner(high.start, high.end))));
            }
            TypeKind::Array { bounds, element }
        }
    } else if let Some(length) = bracketed(&lower, "wstring") {
        TypeKind::WideString(Some(limit(reader, inner(length.start, length.end))))
    } else if let Some(length) = bracketed(&lower, "string") {
        TypeKind::String(Some(limit(reader, inner(length.start, length.end))))
    } else if lower == "string" {
        TypeKind::String(None)
    } else if lower == "wstring" {
        TypeKind::WideString(None)
    } else if lower == "struct" {
        TypeKind::Struct(Vec::new())
    } else if lower.starts_with("ref_to ") && depth < DEPTH_MAX {
        TypeKind::Reference(Box::new(at_depth(reader, inner(7, text.len()), depth + 1)))
    } else if text.starts_with('"') {
        TypeKind::Block(BlockName::Symbol { name: text.trim_matches('"').trim().to_string(), span })
    } else if let Some(number) = numbered(&lower) {
        TypeKind::Block(BlockName::Numbered { prefix: number.0, number: number.1, span })
    } else {
        TypeKind::Named(text.to_uppercase())
    };
    TypeRef { kind, span }
}

/// The bytes between the brackets after `word`, with which the text begins.
fn bracketed(text: &str, word: &str) -> Option<Range<usize>> {
    let rest = text.strip_prefix(word)?;
    let open = word.len() + (rest.len() - rest.trim_start().len());
    if !text[open..].starts_with('[') {
        return None;
    }
    let close = open + text[open..].find(']')?;
    Some(open + 1..close)
}

/// The parts of `range` between the separators.
fn split(text: &str, range: Range<usize>, separator: &str) -> Vec<Range<usize>> {
    let mut parts = Vec::new();
    let mut start = range.start;
    while let Some(at) = text[start..range.end].find(separator) {
        parts.push(start..start + at);
        start += at + separator.len();
    }
    parts.push(start..range.end);
    parts
}

/// A bound or length: a number, or a constant.
fn limit(reader: &mut Reader, range: Range<usize>) -> Bound {
    let text = reader.overlay.text().get(range.clone()).unwrap_or_default();
    let range = range.start + (text.len() - text.trim_start().len())..range.start + text.trim_end().len();
    let (expr, messages) = fragment::expression(reader.file, reader.overlay.text(), range);
    reader.diagnostics.extend(messages);
    bound(expr)
}

/// `UDT 5`, `FB10`.
fn numbered(text: &str) -> Option<(BlockPrefix, u32)> {
    let known = [("udt", BlockPrefix::Udt), ("sfb", BlockPrefix::Sfb), ("fb", BlockPrefix::Fb)];
    known.into_iter().find_map(|(letters, prefix)| {
        let digits = text.strip_prefix(letters)?.trim();
        let number = digits.bytes().all(|digit| digit.is_ascii_digit()).then(|| digits.parse().ok())??;
        Some((prefix, number))
    })
}
