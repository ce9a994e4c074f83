//! STL for S7-300/400: instruction table, lexer, classifier, grammar.
//!
//! ```text
//! text ──► raw tokens ──► tokens with a meaning ──► syntax tree
//!      raw.rs        classify/               stl.lalrpop
//! ```

mod actions;
mod block_check;
mod check;
mod classify;
mod form_help;
mod forms;
pub mod fragment;
pub mod instructions;
mod messages;
mod mnemonics;
mod operand_form;
mod operand_help;
mod parts;
pub mod pragma;
mod raw;
mod start_values;
mod step5;
mod suggest;
pub(crate) mod token;

#[allow(clippy::all, clippy::pedantic, dead_code, unused_imports, unused_parens, missing_docs)] // Generated.
mod grammar {
    include!(concat!(env!("OUT_DIR"), "/stl/stl.rs"));
}

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use crate::ParseOptions;
use crate::ast::{Block, Pragma, SourceUnit};
use crate::front::{self, CommentForm, ParseState, Place};

pub use instructions::{Mnemonics, OperandClass, StlInsn};
pub use messages::operand_phrase;
pub use mnemonics::letters;
pub use operand_help::value_of_function;

/// Whether `word` is a mnemonic of either set, CALL included.
pub fn is_mnemonic(word: &str) -> bool {
    let upper = mnemonics::Upper::new(word);
    upper.as_str() == "CALL"
        || [Mnemonics::En, Mnemonics::De].into_iter().any(|set| mnemonics::instruction(upper.as_str(), set).is_some())
}

/// Whether a word that stands where an operand is expected is one of the language, not a name: letters of an area, a timer or a counter,
/// a bit or word of the status, an address register. `bracket`: a `[` follows it.
pub fn is_operand_word(word: &str, set: Mnemonics, bracket: bool) -> bool {
    let upper = mnemonics::Upper::new(word);
    let word = upper.as_str();
    mnemonics::area(word, Some(set)).is_some()
        || mnemonics::cell(word, Some(set)).is_some()
        || mnemonics::status(word, Some(set)).is_some()
        || mnemonics::special(word).is_some()
        || mnemonics::register(word).is_some()
        || bracket && (matches!(word, "B" | "W" | "D") || mnemonics::block_prefix(word).is_some())
}

/// Parses a source. Recovers from errors; what it cannot parse is left out or becomes an error node.
pub fn parse(file: FileId, text: &str, options: &ParseOptions) -> (SourceUnit, Vec<Diagnostic>) {
    let raw = raw::scan(text);
    if let Some(refusal) = refuse(file, text, &raw) {
        return (
            SourceUnit { mnemonics: options.mnemonics.unwrap_or_default(), ..SourceUnit::default() },
            vec![refusal],
        );
    }
    let detected = mnemonics::detect(text, &raw, options.mnemonics);
    let mut diagnostics = Vec::new();
    report_comments(file, &raw, &mut diagnostics);
    report_slips(file, text, &raw, &mut diagnostics);
    report_mixture(file, text, &detected, options, &mut diagnostics);
    let Parsed { blocks, pragmas, diagnostics } = parse_raw(file, text, &raw, &detected, options.pragmas, diagnostics);
    let shows_mnemonics = options.mnemonics.is_none().then_some(detected.is_shown);
    (SourceUnit { mnemonics: detected.set, shows_mnemonics, blocks, pragmas, ..SourceUnit::default() }, diagnostics)
}

/// The comments of a source, in the order of the text.
pub fn comments(text: &str) -> Vec<front::Comment> {
    raw::scan(text).comments
}

/// The contents of the tokens of a text.
struct Parsed {
    blocks: Vec<Block>,
    pragmas: Vec<Pragma>,
    diagnostics: Vec<Diagnostic>,
}

/// Parses tokens; their messages are added to the earlier ones.
fn parse_raw(
    file: FileId,
    text: &str,
    raw: &raw::RawText,
    detected: &mnemonics::Detected,
    obey_pragmas: bool,
    mut diagnostics: Vec<Diagnostic>,
) -> Parsed {
    let classified = classify::classify(file, text, raw, detected, obey_pragmas);
    let mut state = ParseState::new(file, text, &classified.tokens, detected.set)
        .with_comments(&raw.comments)
        .after(diagnostics.iter().chain(&classified.diagnostics));
    let whole = || grammar::UnitParser::new().parse(&mut state, classified.stream());
    let parts = parts::parse(file, text, &classified.tokens, &raw.comments, detected.set);
    let mut blocks = match parts.map_or_else(whole, Ok) {
        Ok(blocks) => blocks,
        Err(error) => {
            if diagnostics.is_empty() && classified.diagnostics.is_empty() && state.diagnostics.is_empty() {
                let at = front::error_range(&error).map_or(text.len(), |(start, _)| start);
                state.report(messages::Recovery::Block.message(&state, at));
            }
            Vec::new()
        }
    };
    let mut found = state.diagnostics;
    diagnostics.extend(classified.diagnostics);
    diagnostics.append(&mut found);
    for block in &blocks {
        if let Block::Code(block) = block {
            block_check::check(text, block, detected.set, &mut diagnostics);
        }
    }
    if diagnostics.iter().any(|diagnostic| diagnostic.code == Code::NotASource) {
        diagnostics.retain(|diagnostic| diagnostic.code != Code::MixedMnemonics);
    }
    front::drop_followers_of_comment(&raw.comments, &mut diagnostics);
    diagnostics.sort_by_key(|diagnostic| diagnostic.primary.span.start);
    front::frame::drop_damaged_statements(&mut blocks, &diagnostics);
    Parsed { blocks, pragmas: classified.pragmas, diagnostics }
}

/// A file that should not be parsed: not a source, or a template that was not filled in.
fn refuse(file: FileId, text: &str, raw: &raw::RawText) -> Option<Diagnostic> {
    let spanned = |token: &raw::RawToken| Span { file, start: token.start, end: token.end };
    let first = raw.tokens.first()?;
    if first.kind == raw::RawKind::Less {
        return Some(classify::not_a_source(spanned(first), "XML begins here"));
    }
    if let Some(at) = text.find('\0') {
        return Some(classify::not_a_source(Span::new(file, at..at + 1), "a zero byte: the file is not text"));
    }
    let listing = raw.tokens.windows(3).find(|tokens| {
        tokens[0].first_on_line
            && tokens[1].kind == raw::RawKind::Minus
            && matches!(text[tokens[0].range()].to_ascii_uppercase().as_str(), "AWL" | "STL")
            && text[tokens[2].range()].eq_ignore_ascii_case("code")
    });
    if let Some(tokens) = listing {
        let span = spanned(&tokens[0]).to(spanned(&tokens[2]));
        return Some(classify::not_a_source(span, "head of a listing of machine code"));
    }
    let marker = raw.tokens.iter().find(|token| match token.kind {
        raw::RawKind::Marker => true,
        raw::RawKind::Quoted => {
            let name = &text[token.range()];
            name.contains("@@") || name.contains("{{")
        }
        _ => false,
    })?;
    let name = text[marker.range()].trim_matches(['"', '@', '{', '}', ' ']);
    let span = Span { file, start: marker.start, end: marker.end };
    Some(
        Diagnostic::new(Code::TemplateMarker, span, format!("the template's marker `{name}` was never filled in"))
            .label("stands for a text that is missing")
            .help("generate the source from its template, or write the text in place of each marker"),
    )
}

fn report_comments(file: FileId, raw: &raw::RawText, diagnostics: &mut Vec<Diagnostic>) {
    for comment in &raw.comments {
        diagnostics.push(match comment.form {
            CommentForm::Line => continue,
            CommentForm::Block | CommentForm::Slash => {
                let span = Span { file, start: comment.start, end: comment.end };
                let signs = if comment.form == CommentForm::Block { "`(* *)`" } else { "`/* */`" };
                Diagnostic::new(Code::BlockComment, span, format!("STL has no comments in {signs}"))
                    .label("read as a comment")
                    .help("begin each line of the comment with `//`")
            }
            CommentForm::Unterminated => front::unclosed_comment(
                file,
                comment.start,
                "begins here, and includes the rest of the file",
                "close it with `*)`, or begin each line of it with `//`",
            ),
        });
    }
}

/// Keywords of frames that are misspelt.
fn report_slips(file: FileId, text: &str, raw: &raw::RawText, diagnostics: &mut Vec<Diagnostic>) {
    for token in &raw.tokens {
        if let Some(keyword) = token.keyword {
            let span = Span { file, start: token.start, end: token.end };
            diagnostics.push(front::frame_words::misspelt(span, token.text(text), keyword));
        }
    }
}

/// A file has one mnemonic set.
fn report_mixture(
    file: FileId,
    text: &str,
    detected: &mnemonics::Detected,
    options: &ParseOptions,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let [own, Some(foreign)] = detected.first else { return };
    let span = |token: raw::RawToken| Span { file, start: token.start, end: token.end };
    let name = messages::set_name;
    let word = &text[foreign.range()];
    let set = name(detected.set);
    let other = match mnemonics::other(detected.set) {
        Mnemonics::En => "an international",
        Mnemonics::De => "a German",
    };
    let mut diagnostic = Diagnostic::new(
        Code::MixedMnemonics,
        span(foreign),
        format!("`{word}` is {other} mnemonic in a file with {set} ones"),
    )
    .label("a file uses one set only")
    .help(if options.mnemonics.is_some() {
        format!("the {set} set was requested; without `--mnemonics` plcc finds the set itself")
    } else {
        let upper = mnemonics::Upper::new(word);
        match mnemonics::instruction(upper.as_str(), mnemonics::other(detected.set)) {
            Some(insn) => format!("write `{}`: the file has {set} mnemonics", insn.mnemonic(detected.set)),
            None => format!("write the whole file with {set} mnemonics, operands too"),
        }
    });
    if let Some(own) = own {
        diagnostic = diagnostic.also(span(own), format!("{set} mnemonic"));
    }
    diagnostics.push(diagnostic);
}

/// Bytes of the words, signs, constants and comments of a text, in its order.
pub fn pieces(text: &str) -> Vec<Range<usize>> {
    raw::scan(text).pieces()
}

/// The tokens of a source as the grammar sees them, one per line, for `--emit tokens`.
pub fn tokens_text(text: &str, options: &ParseOptions) -> String {
    let raw = raw::scan(text);
    let detected = mnemonics::detect(text, &raw, options.mnemonics);
    let classified = classify::classify(FileId::default(), text, &raw, &detected, options.pragmas);
    front::tokens_text(text, &classified.tokens)
}
