//! SCL, in the classic form of STEP 7 V5 and in that of the TIA Portal: lexer, classifier, grammar, syntax tree.
//!
//! ```text
//! text ──► raw tokens ──► tokens with a meaning ──► syntax tree
//!      raw.rs         classify/               scl.lalrpop
//! ```

mod actions;
pub mod address;
pub mod ast;
mod classify;
mod dialect;
mod extensions;
pub mod fragment;
pub mod keyword;
pub mod literal;
mod messages;
mod outline;
pub mod raw;
mod region;
mod repair;
mod slips;
pub mod text;
mod token;
mod types_meant;

#[allow(clippy::all, clippy::pedantic, dead_code, unused_imports, unused_parens, missing_docs)] // Generated.
mod grammar {
    include!(concat!(env!("OUT_DIR"), "/scl/scl.rs"));
}

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use crate::ParseOptions;
use crate::ast::{Block, Pragma, SourceUnit};
use crate::front::{self, CommentForm, ParseState, Place};

pub use outline::{Outline, outline};

pub use actions::bound;
pub use address::{absolute, area_word, db_address, db_area_word};

/// Parses a source. Recovers from errors; what it cannot parse is left out or becomes an error node.
pub fn parse(file: FileId, text: &str, options: &ParseOptions) -> (SourceUnit, Vec<Diagnostic>) {
    let raw = raw::scan(text);
    let looks = looks_like_scl(text, &raw);
    let Parsed { blocks, pragmas, diagnostics } = parse_raw(file, text, &raw, options.pragmas);
    let mnemonics = options.mnemonics.unwrap_or_default();
    if !looks && let Some(wrong) = diagnostics.iter().find(|diagnostic| diagnostic.code == Code::Syntax) {
        let span = wrong.primary.span;
        let refused = Diagnostic::new(Code::NotASource, span, "this file does not contain an SCL source")
            .label("not a statement of SCL, and no block begins before it")
            .help("pass a source as STEP 7 or the TIA Portal exports it: blocks from FUNCTION, DATA_BLOCK, TYPE … to their END");
        return (SourceUnit { mnemonics, blocks: Vec::new(), pragmas, ..SourceUnit::default() }, vec![refused]);
    }
    (SourceUnit { mnemonics, blocks, pragmas, ..SourceUnit::default() }, diagnostics)
}

/// The contents of the tokens of a text.
struct Parsed {
    blocks: Vec<Block>,
    pragmas: Vec<Pragma>,
    diagnostics: Vec<Diagnostic>,
}

fn parse_raw(file: FileId, text: &str, raw: &raw::RawText, obey_pragmas: bool) -> Parsed {
    let dialect = dialect::of(text, raw);
    let mut diagnostics = Vec::new();
    report_comments(file, text, raw, &mut diagnostics);
    for slip in &raw.slips {
        let span = Span { file, start: slip.start, end: slip.end };
        let word = text.get(slip.start as usize..slip.end as usize).unwrap_or_default();
        diagnostics.push(front::frame_words::misspelt(span, word, slip.keyword));
    }
    let repaired = repair::repair(file, text, raw, &mut diagnostics);
    let raw = repaired.as_ref().unwrap_or(raw);
    region::check(file, raw, &mut diagnostics);
    let classified = classify::classify(file, text, raw, obey_pragmas);
    diagnostics.extend_from_slice(&classified.diagnostics);
    let mut state = ParseState::new(file, text, &classified.tokens, dialect)
        .with_comments(&raw.comments)
        .after(diagnostics.iter().filter(|diagnostic| diagnostic.is_error()));
    let mut blocks = match grammar::UnitParser::new().parse(&mut state, classified.stream()) {
        Ok(blocks) => blocks,
        Err(error) => {
            if diagnostics.is_empty() && state.diagnostics.is_empty() {
                let at = front::error_range(&error).map_or(text.len(), |(start, _)| start);
                state.report(messages::Recovery::Block.message(&state, at));
            }
            Vec::new()
        }
    };
    diagnostics.append(&mut state.diagnostics);
    front::drop_followers_of_comment(&raw.comments, &mut diagnostics);
    diagnostics.sort_by_key(|diagnostic| diagnostic.primary.span.start);
    front::frame::drop_damaged_statements(&mut blocks, &diagnostics);
    Parsed { blocks, pragmas: classified.pragmas, diagnostics }
}

/// True if a text has the head of a block, or an assignment: mistakes in it are reported one by one.
fn looks_like_scl(text: &str, raw: &raw::RawText) -> bool {
    const HEADS: [&str; 6] = ["ORGANIZATION_BLOCK", "FUNCTION_BLOCK", "FUNCTION", "DATA_BLOCK", "TYPE", "PROGRAM"];
    raw.tokens.iter().any(|token| {
        let word = &text[token.range()];
        word == ":=" || HEADS.iter().any(|head| head.eq_ignore_ascii_case(word))
    })
}

fn report_comments(file: FileId, text: &str, raw: &raw::RawText, diagnostics: &mut Vec<Diagnostic>) {
    for comment in &raw.comments {
        let diagnostic = match comment.form {
            CommentForm::Line | CommentForm::Block => continue,
            CommentForm::Slash => {
                let span = Span { file, start: comment.start, end: comment.end };
                Diagnostic::new(Code::Tolerated, span, "SCL has no comments in `/* */`")
                    .label("read as a comment")
                    .help("write `(* … *)`, or begin each line of it with `//`")
            }
            CommentForm::Unterminated => {
                let slash = text.get(comment.start as usize..).is_some_and(|rest| rest.starts_with('/'));
                let help = match slash {
                    true => "close it with `*/`, or begin the line with `//`",
                    false => "close it with `*)`; each `(*` inside needs its own `*)`",
                };
                front::unclosed_comment(file, comment.start, "begins here", help)
            }
        };
        diagnostics.push(diagnostic);
    }
}

/// Bytes of the words, signs, constants and comments of a text, in its order. Lines of REGION are not among them.
pub fn pieces(text: &str) -> Vec<Range<usize>> {
    let raw = raw::scan(text);
    let tokens = raw.tokens.iter().map(raw::RawToken::range);
    let mut pieces: Vec<Range<usize>> = tokens.chain(raw.comments.iter().map(front::Comment::range)).collect();
    pieces.sort_by_key(|piece| piece.start);
    pieces
}

/// The comments of a source, in the order of the text.
pub fn comments(text: &str) -> Vec<crate::front::Comment> {
    raw::scan(text).comments
}

/// Bytes of the lines of REGION and END_REGION, in the order of the text.
pub fn regions(text: &str) -> Vec<Range<usize>> {
    raw::scan(text).regions.iter().map(|region| region.start as usize..region.end as usize).collect()
}

/// The comments of a source and the lines of its regions, which are folds of the editor, in the order of the text.
pub fn comments_and_regions(text: &str) -> Vec<front::Comment> {
    let raw = raw::scan(text);
    let mut all = raw.comments;
    let line = |region: &raw::Region| front::Comment {
        start: region.start,
        end: region.end,
        own_line: true,
        form: CommentForm::Line,
    };
    all.extend(raw.regions.iter().map(line));
    all.sort_by_key(|one| one.start);
    // A comment after a region on its line stays there.
    all.dedup_by(|comment, region| {
        let gap = text.get(region.end as usize..comment.start as usize);
        let joins = region.form == CommentForm::Line
            && comment.form == CommentForm::Line
            && raw.regions.binary_search_by_key(&region.start, |one| one.start).is_ok()
            && gap.is_some_and(|gap| gap.chars().all(|c| matches!(c, ' ' | '\t')));
        if joins {
            region.end = comment.end;
        }
        joins
    });
    all
}

/// The tokens of a source as the grammar sees them, one per line, for `--emit tokens`.
pub fn tokens_text(text: &str, options: &ParseOptions) -> String {
    let classified = classify::classify(FileId::default(), text, &raw::scan(text), options.pragmas);
    front::tokens_text(text, &classified.tokens)
}
