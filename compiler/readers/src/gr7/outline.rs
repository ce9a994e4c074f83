//! Which blocks of a file contain charts. A guess: it does not parse.

use std::ops::Range;

use super::classify::{Keyword, keyword_at};
use super::lexer::{self, RawKind, RawToken};

/// Words that begin blocks without a chart.
const OTHER_BLOCKS: [&str; 4] = ["ORGANIZATION_BLOCK", "FUNCTION", "DATA_BLOCK", "TYPE"];

/// Words that only charts have. Comments of other languages may contain them, too.
const CHART_WORDS: [&str; 3] = ["INITIAL_STEP", "END_STEP", "END_TRANSITION"];

/// Whether the text contains a chart, whatever the name of its file.
pub fn has_chart(text: &str) -> bool {
    let hints = has_word(text, "(*$_CMPSET")
        || CHART_WORDS.iter().any(|word| has_word(text, word))
            && text.split(['\n', '\r']).any(|line| {
                let word = line.split([' ', '\t', '(', ';']).find(|word| !word.is_empty()).unwrap_or_default();
                CHART_WORDS.iter().any(|known| known.eq_ignore_ascii_case(word))
            });
    if !hints {
        return false;
    }
    let tokens = lexer::scan(text).tokens;
    let scan = Scan { text, tokens: &tokens };
    let colon = |index: usize| tokens.get(index + 1).is_some_and(|next| next.kind == RawKind::Colon);
    (0..tokens.len()).any(|index| match scan.keyword(index) {
        Some(Keyword::InitialStep | Keyword::EndStep | Keyword::EndTransition) => !colon(index),
        None => tokens[index].kind == RawKind::Pragma && text[tokens[index].range()].starts_with("(*$_CMPSET"),
        _ => false,
    })
}

/// Whether the text contains `word`, in any case of its letters. The word has a `_`, of which most texts have few.
fn has_word(text: &str, word: &str) -> bool {
    let before = word.find('_').unwrap_or_default();
    text.match_indices('_').any(|(at, _)| {
        let found = at.checked_sub(before).and_then(|start| text.as_bytes().get(start..start + word.len()));
        found.is_some_and(|found| found.eq_ignore_ascii_case(word.as_bytes()))
    })
}

/// The bytes of the blocks with charts if the file also contains other blocks; otherwise none.
pub fn beside_other_blocks(text: &str) -> Option<Vec<Range<usize>>> {
    let tokens = lexer::scan(text).tokens;
    let scan = Scan { text, tokens: &tokens };
    let (mut charts, mut others) = (Vec::new(), false);
    let mut at = 0;
    while at < tokens.len() {
        if scan.keyword(at) == Some(Keyword::FunctionBlock) {
            let end = scan.block_end(at);
            if scan.is_other(at..end) {
                others = true;
            } else {
                charts.push(tokens[at].start as usize..tokens[end - 1].end as usize);
            }
            at = end;
        } else {
            others |= scan.begins_other(at);
            at += 1;
        }
    }
    others.then_some(charts)
}

struct Scan<'a> {
    text: &'a str,
    tokens: &'a [RawToken],
}

impl Scan<'_> {
    fn keyword(&self, index: usize) -> Option<Keyword> {
        keyword_at(self.text, self.tokens, index)
    }

    fn is_word(&self, index: usize, words: &[&str]) -> bool {
        let token = self.tokens[index];
        let text = &self.text[token.range()];
        token.kind == RawKind::Word && token.first_on_line && words.iter().any(|word| word.eq_ignore_ascii_case(text))
    }

    /// Whether a block that is not an FB begins at `index`.
    fn begins_other(&self, index: usize) -> bool {
        let next = self.tokens.get(index + 1).map(|next| next.kind);
        self.is_word(index, &OTHER_BLOCKS) && matches!(next, Some(RawKind::Word | RawKind::Quoted))
    }

    /// Index after the FB at `index`.
    fn block_end(&self, index: usize) -> usize {
        let mut end = index + 1;
        while end < self.tokens.len() {
            match self.keyword(end) {
                Some(Keyword::EndFunctionBlock) => return end + 1,
                Some(Keyword::FunctionBlock) => return end,
                _ if self.begins_other(end) => return end,
                _ => end += 1,
            }
        }
        end
    }

    /// Whether an FB has statements: `BEGIN` comes before them, and it has no part of a chart.
    fn is_other(&self, block: Range<usize>) -> bool {
        let chart = block.clone().any(|index| {
            matches!(
                self.keyword(index),
                Some(Keyword::InitialStep | Keyword::EndStep | Keyword::Transition | Keyword::EndTransition)
            )
        });
        !chart && block.into_iter().any(|index| self.is_word(index, &["BEGIN", "NETWORK"]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_found_in_any_case() {
        assert!(has_word("  Initial_Step Start:", "INITIAL_STEP") && has_word("END_STEP", "END_STEP"));
        assert!(has_word("_END_END_STEP", "END_STEP") && has_word("ä (*$_CMPSET", "(*$_CMPSET"));
        assert!(!has_word("_STEP END_STE", "END_STEP") && !has_word("ä_STEP", "END_STEP") && !has_word("", "END_STEP"));
    }

    #[test]
    fn only_charts_have_steps() {
        assert!(has_chart("FUNCTION_BLOCK FB 1\nBEGIN\nINITIAL_STEP S1 (*$_NUM 1*):\nEND_STEP\n"));
        assert!(!has_chart("FUNCTION_BLOCK FB 1\nBEGIN\n// END_STEP\n#end_step := TRUE;\n"));
    }
}
