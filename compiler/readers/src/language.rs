//! Which language a source is written in. The statements of its blocks decide; without statements, the forms of its declarations.

use std::ops::Range;

use plcc_syntax::scl::{Outline, outline};
use plcc_syntax::{Language, s7200};

use crate::{gr7, networks};

/// How to read a source.
pub enum Reading {
    /// The whole source in one language.
    Whole(Language),
    /// The bytes of its SCL blocks; the rest is STL.
    Mixed(Vec<Range<usize>>),
    /// The bytes of its GRAPH blocks; the rest is STL or SCL, or both.
    WithCharts(Vec<Range<usize>>),
}

/// Decides how to read `text`; `hint` decides where its content does not.
pub fn detect(text: &str, hint: Option<Language>) -> Reading {
    if hint == Some(Language::Sd) || hint.is_none() && has_networks_of_sd(text) {
        return Reading::Whole(Language::Sd);
    }
    if hint == Some(Language::Graph) || gr7::has_chart(text) {
        return match gr7::beside_other_blocks(text) {
            Some(charts) => Reading::WithCharts(charts),
            None => Reading::Whole(Language::Graph),
        };
    }
    // Exports of Micro/WIN and STEP 7 have the same extension, so a hint of STL does not decide it.
    if hint == Some(Language::S7200) || matches!(hint, None | Some(Language::Stl)) && s7200::is_s7200(text) {
        return Reading::Whole(Language::S7200);
    }
    detect_statements(text, hint)
}

/// Decides how to read a `text` of STL and SCL.
pub fn detect_statements(text: &str, hint: Option<Language>) -> Reading {
    if networks::are_all_code(text) {
        return Reading::Whole(hint.unwrap_or(Language::Stl));
    }
    let Outline { blocks, modern } = outline(text);
    let scl = blocks.iter().any(|block| block.language == Some(Language::Scl));
    let stl = blocks.iter().any(|block| block.language == Some(Language::Stl));
    match (scl, stl, hint) {
        (true, true, _) => {
            let ranges =
                blocks.into_iter().filter(|block| block.language == Some(Language::Scl)).map(|block| block.range);
            Reading::Mixed(ranges.collect())
        }
        (_, _, Some(language)) => Reading::Whole(language),
        (true, false, None) => Reading::Whole(Language::Scl),
        (false, true, None) => Reading::Whole(Language::Stl),
        (false, false, None) => Reading::Whole(if modern { Language::Scl } else { Language::Stl }),
    }
}

/// Whether a line of the text ends a network. Only SIMATIC SD has such lines.
fn has_networks_of_sd(text: &str) -> bool {
    text.lines().any(|line| line.trim().eq_ignore_ascii_case("END_NETWORK"))
}

/// `text` with blanks in place of all bytes inside (`keep` false) or outside (`keep` true) of `ranges`; line ends remain.
pub fn masked(text: &str, ranges: &[Range<usize>], keep: bool) -> String {
    let mut out = String::with_capacity(text.len());
    let mut at = 0;
    let mut copy = |range: Range<usize>, shown: bool| {
        if shown {
            out.push_str(&text[range]);
        } else {
            out.extend(text[range].bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' }));
        }
    };
    for range in ranges {
        copy(at..range.start, !keep);
        copy(range.clone(), keep);
        at = range.end;
    }
    copy(at..text.len(), !keep);
    out
}
