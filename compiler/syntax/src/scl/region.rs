//! REGION … END_REGION: folds of the editor. They are not statements, but must balance.

use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::keyword::Keyword;
use super::raw::{RawText, Region};

/// Reports regions that are not closed, or closed inside another statement than they were opened in.
pub fn check(file: FileId, raw: &RawText, diagnostics: &mut Vec<Diagnostic>) {
    let mut open: Vec<(Region, i32)> = Vec::new();
    let (mut depth, mut at) = (0i32, 0usize);
    let span = |region: Region| Span { file, start: region.start, end: region.end };
    for region in raw.regions.iter().copied() {
        for token in &raw.tokens[at..region.token as usize] {
            depth += token.keyword.map_or(0, step);
        }
        at = region.token as usize;
        if region.opens {
            open.push((region, depth));
            continue;
        }
        match open.pop() {
            None => diagnostics.push(
                Diagnostic::new(Code::Tolerated, span(region), "`END_REGION` has no matching REGION")
                    .label("no region is open here")
                    .help("remove it"),
            ),
            Some((opening, opened)) if opened != depth => diagnostics.push(
                Diagnostic::new(
                    Code::Tolerated,
                    span(region),
                    "the region does not end in the statement that it begins in",
                )
                .label("ends here")
                .also(span(opening), "begins here")
                .help("put whole statements into the region"),
            ),
            Some(_) => {}
        }
    }
    for (region, _) in open {
        diagnostics.push(
            Diagnostic::new(Code::Tolerated, span(region), "the region is not closed")
                .label("begins here")
                .help("write `END_REGION` after its last statement"),
        );
    }
}

fn step(keyword: Keyword) -> i32 {
    match keyword {
        Keyword::If | Keyword::Case | Keyword::For | Keyword::While | Keyword::Repeat | Keyword::Begin => 1,
        Keyword::EndIf | Keyword::EndCase | Keyword::EndFor | Keyword::EndWhile | Keyword::EndRepeat => -1,
        word if word.ends_block() => -1,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use plcc_diag::FileId;

    #[test]
    fn the_end_of_a_region_in_what_is_read_as_a_comment_is_no_fault() {
        for line in ["# END_REGION ( (/*", "# REGION a", "x = REGION 1; # END_REGION b c d e"] {
            let text = format!("FUNCTION_BLOCK \"f\"\nBEGIN\nREGION\n{line}\nEND_FUNCTION_BLOCK\n");
            let (unit, diagnostics) = crate::scl::parse(FileId(0), &text, &crate::ParseOptions::default());
            assert!(unit.blocks.len() == 1 && !diagnostics.is_empty(), "{line}");
        }
    }
}
