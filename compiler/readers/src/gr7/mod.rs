//! GRAPH source text (`.gr7`): function blocks with charts, as S7-GRAPH of STEP 7 V5 exports them.
//!
//! ```text
//! text ──► raw tokens ──┬─► heads and declarations ──► grammar of SCL ────────┐
//!        lexer.rs    frame.rs                                                 ├──► syntax tree
//!                       └─► charts ──► tokens with a meaning ──► parts ───────┘   blocks.rs
//!                                   classify/            gr7.lalrpop
//! ```
//!
//! Source: GRAPH reference, chapter A.

mod actions;
mod blocks;
mod classify;
mod frame;
mod lexer;
mod messages;
mod outline;
mod pragma;
mod qualifier;
mod settings;
mod token;
mod tree;

#[allow(clippy::all, clippy::pedantic, dead_code, unused_imports, unused_parens, missing_docs)] // Generated.
mod grammar {
    include!(concat!(env!("OUT_DIR"), "/gr7/gr7.rs"));
}

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use crate::ReadOptions;
use plcc_syntax::ast::SourceUnit;
use plcc_syntax::front::{self, CommentForm};

pub(crate) use outline::{beside_other_blocks, has_chart};

/// Parses a source. Never fails: the messages say what is wrong, in the order of the text.
pub fn parse(file: FileId, text: &str, options: &ReadOptions) -> (SourceUnit, Vec<Diagnostic>) {
    let mut diagnostics = Vec::new();
    let mut raw = lexer::scan(text);
    classify::join_words(text, &mut raw.tokens);
    report_comments(file, &raw, &mut diagnostics);
    for (index, token) in raw.tokens.iter().enumerate() {
        // The parser of declarations reports their sections.
        if let Some(keyword) = classify::misspelt(text, &raw.tokens, index).filter(|keyword| keyword.word() != "VAR") {
            let span = Span { file, start: token.start, end: token.end };
            diagnostics.push(front::frame_words::misspelt(span, &text[token.range()], keyword.word()));
        }
    }
    let document = frame::read(file, text, &raw, &mut diagnostics);
    if options.pragmas {
        diagnostics.extend(document.misplaced.iter().map(|range| misplaced(file, range.clone())));
    }
    let unit = blocks::build(file, text, &raw, &document, options, &mut diagnostics);
    diagnostics.sort_by_key(|diagnostic| diagnostic.primary.span.start);
    (unit, diagnostics)
}

fn report_comments(file: FileId, raw: &lexer::RawText, diagnostics: &mut Vec<Diagnostic>) {
    for comment in raw.comments.iter().filter(|comment| comment.form == CommentForm::Unterminated) {
        let extent = "begins here, and includes the rest of the file";
        diagnostics.push(front::unclosed_comment(file, comment.start, extent, "close it with `*)`"));
    }
}

/// An assertion among steps and transitions: it is undefined when it would be checked.
fn misplaced(file: FileId, range: Range<usize>) -> Diagnostic {
    Diagnostic::new(Code::Pragma, Span::new(file, range), "an assertion is not allowed inside a chart")
        .label("among steps and transitions")
        .help("write it after the call of the block, for example in OB 1: `//@ assert DB1.Run.X == 1`")
}

/// Comments without a meaning, in the order of the text.
pub fn comments(text: &str) -> Vec<front::Comment> {
    lexer::scan(text).comments
}

/// Bytes of the words, signs, constants and comments of a text, in its order.
pub fn pieces(text: &str) -> Vec<Range<usize>> {
    lexer::scan(text).pieces()
}

/// Whether a word begins or ends a part of a chart.
pub fn is_keyword(word: &str) -> bool {
    classify::Keyword::of(word).is_some()
}

/// The tokens of the charts as the grammar sees them, one per line, for `--emit tokens`.
pub fn tokens_text(text: &str) -> String {
    let file = FileId::default();
    let document = frame::read(file, text, &lexer::scan(text), &mut Vec::new());
    let charts = document.blocks.iter().flat_map(|block| classify::classify(file, text, &block.chart).tokens);
    front::tokens_text(text, &charts.collect::<Vec<_>>())
}
