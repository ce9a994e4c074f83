//! Large sources parsed on all processors: frames are balanced, so a source can be cut after the end of any block.

use std::thread::{Builder, available_parallelism};

use plcc_diag::FileId;

use super::messages::State;
use super::token::Tok;
use super::{Mnemonics, grammar};
use crate::ast::Block;
use crate::front::{Comment, Spanned};

/// Sources with fewer tokens are parsed before a thread has started.
const TOKENS_MIN: usize = 30_000;

/// The blocks of a source without mistakes. `None`: it is small, or the grammar has something to say, for which it needs all tokens in a row.
pub fn parse<'a>(
    file: FileId,
    text: &'a str,
    tokens: &[Spanned<Tok<'a>>],
    comments: &[Comment],
    set: Mnemonics,
) -> Option<Vec<Block>> {
    let threads = available_parallelism().map_or(1, |count| count.get());
    if threads == 1 || tokens.len() < TOKENS_MIN {
        return None;
    }
    let parse = |part: &[Spanned<Tok<'a>>]| {
        let mut state = State::new(file, text, tokens, set).with_comments(comments);
        let blocks = grammar::UnitParser::new().parse(&mut state, part.iter().map(|token| Ok(token.clone()))).ok()?;
        state.diagnostics.is_empty().then_some(blocks)
    };
    let parse = &parse;
    let parts = cut(tokens, threads);
    let (first, others) = parts.split_first()?;
    let parsed = std::thread::scope(|scope| {
        let mut running = Vec::new();
        for &part in others {
            running.push(Builder::new().spawn_scoped(scope, move || parse(part)).ok()?);
        }
        let mut parsed = vec![parse(first)];
        parsed.extend(running.into_iter().map(|other| other.join().ok().flatten()));
        parsed.into_iter().collect::<Option<Vec<_>>>()
    })?;
    Some(parsed.into_iter().flatten().collect())
}

/// `tokens` in up to `count` parts of about the same length, each with whole blocks.
fn cut<'t, 'a>(tokens: &'t [Spanned<Tok<'a>>], count: usize) -> Vec<&'t [Spanned<Tok<'a>>]> {
    let length = tokens.len().div_ceil(count);
    let mut parts = Vec::new();
    let mut rest = tokens;
    while let Some(after) = rest.get(length..)
        && let Some(end) = after.iter().position(|(_, token, _)| matches!(token, Tok::EndBlock))
        && end + 1 < after.len()
    {
        let (part, after) = rest.split_at(length + end + 1);
        parts.push(part);
        rest = after;
    }
    parts.push(rest);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stl::{classify, mnemonics, raw};

    /// Calls `with` with the tokens of `count` functions whose second network is `network`.
    fn with_tokens(count: usize, network: &str, with: impl Fn(&str, &[Spanned<Tok<'_>>], &[Comment], Mnemonics)) {
        let lines = "      A     I 0.0;   // key\n      =     Q 0.0;\n".repeat(10);
        let function =
            |number| format!("FUNCTION FC {number} : VOID\nBEGIN\nNETWORK\n{lines}NETWORK\n{network}END_FUNCTION\n");
        let text: String = (1..=count).map(function).collect();
        let raw = raw::scan(&text);
        let detected = mnemonics::detect(&text, &raw, None);
        let classified = classify::classify(FileId::default(), &text, &raw, &detected, false);
        with(&text, &classified.tokens, &raw.comments, detected.set);
    }

    #[test]
    fn parts_are_whole_blocks_and_together_all_tokens() {
        with_tokens(10, "      SET   ;\n", |_, tokens, _, _| {
            let parts = cut(tokens, 3);
            assert_eq!(parts.len(), 3);
            assert_eq!(parts.concat(), tokens);
            assert!(parts.iter().all(|part| matches!(part.last(), Some((_, Tok::EndBlock, _)))));
        });
    }

    #[test]
    fn parts_have_the_blocks_of_the_whole() {
        with_tokens(800, "      SET   ;\n", |text, tokens, comments, set| {
            assert!(tokens.len() >= TOKENS_MIN, "{} tokens", tokens.len());
            let Some(blocks) = parse(FileId::default(), text, tokens, comments, set) else {
                assert_eq!(available_parallelism().map_or(1, |count| count.get()), 1);
                return;
            };
            let mut state = State::new(FileId::default(), text, tokens, set).with_comments(comments);
            let whole = grammar::UnitParser::new().parse(&mut state, tokens.iter().map(|token| Ok(token.clone())));
            assert_eq!(Ok(blocks), whole);
        });
    }

    #[test]
    fn a_source_with_a_mistake_is_not_parsed_in_parts() {
        with_tokens(800, "      L     ;\n", |text, tokens, comments, set| {
            assert!(parse(FileId::default(), text, tokens, comments, set).is_none());
        });
    }
}
