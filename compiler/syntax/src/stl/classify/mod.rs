//! Classifies words: raw tokens to the tokens of the grammar.
//!
//! A word has different meanings in a header, a declaration, before an operand and inside one; line ends end statements in code
//! and have no meaning elsewhere. This pass follows the frame of the file (header, declarations, code, values) and gives each token
//! its meaning. It also closes frames that the source left open, so the grammar always sees balanced frames, and one
//! mistake remains one message.
//!
//! ```text
//! file ──► block ──► header ──► section (VAR … END_VAR, STRUCT … END_STRUCT)   block.rs, header.rs, headless.rs, declaration.rs
//!            │          └────► code (statements, calls)                         code.rs, call.rs, operand.rs, address.rs, foreign.rs, parentheses.rs
//!            │          └────► values of a data block                           values.rs
//!            └── statements without a header: OB 1
//! ```

mod address;
mod block;
mod call;
mod code;
mod declaration;
mod foreign;
mod header;
mod headless;
mod operand;
mod parentheses;
mod values;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use crate::front::{self, Classified, Cursor, extent, frame};
use crate::literal::{self, Literal};
use crate::scl;
use crate::stl::Mnemonics;
use crate::stl::mnemonics::{Detected, Upper};
use crate::stl::raw::{self, RawKind, RawText};
use crate::stl::suggest;
use crate::stl::token::Tok;

/// A longer list of attributes before a block is not looked through for its end.
const ATTRIBUTE_TOKENS_MAX: usize = 400;

/// How deep STRUCTs may be nested. STEP 7 allows 8 levels; the rest is for other tools.
const STRUCT_DEPTH_MAX: usize = 64;
/// How many `ARRAY … OF` one declaration may have. STEP 7 allows one.
const ARRAY_DEPTH_MAX: usize = 8;
/// How deep parentheses and brackets may be nested outside statements.
const BRACKET_DEPTH_MAX: usize = 16;

/// A text is not a source if it has at least this many lines that are not statements, and more of them than statements.
const NO_SOURCE_STATEMENTS_MIN: usize = 3;

/// Classifies the words of a file.
pub fn classify<'a>(
    file: FileId,
    text: &'a str,
    raw: &RawText,
    detected: &Detected,
    pragmas: bool,
) -> Classified<Tok<'a>> {
    let comments = if pragmas { raw.comments.as_slice() } else { &[] };
    let mut classifier = Classifier {
        cursor: Cursor::new(file, text, &raw.tokens, comments),
        set: detected.set,
        both_sets: false,
        mixed: detected.first[1].is_some(),
        may_be_long: false,
    };
    classifier.file();
    classifier.cursor.finish()
}

/// Classifies the words of a side of an assertion: operands, area letters of both sets. `offset`: where `text` begins in the file.
pub fn classify_operand<'a>(file: FileId, text: &'a str, raw: &RawText, offset: usize) -> Classified<Tok<'a>> {
    let cursor = Cursor::new(file, text, &raw.tokens, &[]);
    let mut classifier = Classifier { cursor, set: Mnemonics::En, both_sets: true, mixed: false, may_be_long: false };
    classifier.assert_side();
    let mut classified = classifier.cursor.finish();
    for (start, _, end) in &mut classified.tokens {
        *start += offset;
        *end += offset;
    }
    for diagnostic in &mut classified.diagnostics {
        diagnostic.primary.span.start += offset as u32;
        diagnostic.primary.span.end += offset as u32;
    }
    classified
}

/// What follows a block's header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Frame {
    Code,
    Data,
    Type,
}

struct Classifier<'a, 'r> {
    cursor: Cursor<'a, 'r, RawKind, Option<&'static str>, Tok<'a>>,
    set: Mnemonics,
    /// Area letters of both mnemonic sets are accepted.
    both_sets: bool,
    /// The file has mnemonics of both sets, which has been reported.
    mixed: bool,
    /// A start value may have 64 bits: the type before it has, or is a structure, or no type is before it, after BEGIN.
    may_be_long: bool,
}

crate::moves_cursor!(Classifier, RawKind, Option<&'static str>, Tok);

impl<'a> Classifier<'a, '_> {
    /// The whole file: blocks, and statements outside them.
    fn file(&mut self) {
        loop {
            let Some(token) = self.peek() else {
                self.file_pragmas(u32::MAX);
                return;
            };
            match token.kind {
                RawKind::Semicolon => self.at += 1,
                RawKind::LeftBrace if self.attributes_before_block() => {}
                _ if self.block_keyword(self.at).is_some() => {
                    self.file_pragmas(token.start);
                    self.block();
                }
                RawKind::Word if is_end_of_block(self.upper(self.at).as_str()) => {
                    self.report(frame::never_began(self.span(token), self.slice(token)));
                    self.at += 1;
                }
                _ if self.block_without_keyword() => {}
                _ => self.implied_ob(),
            }
        }
    }

    /// Statements without a header.
    fn implied_ob(&mut self) {
        let start = self.peek().map_or(self.text.len(), |token| token.start as usize);
        let start = self.next_pragma(start as u32).map_or(start, |pragma| pragma.start as usize);
        let (first_token, first_message) = (self.out.len(), self.diagnostics.len());
        self.push(start, Tok::ImpliedOb, start);
        self.code();
        let tokens = &self.out[first_token..];
        let bad = tokens.iter().filter(|(_, token, _)| *token == Tok::BadStatement).count();
        let good =
            tokens.iter().filter(|(_, token, _)| matches!(token, Tok::Insn(_) | Tok::Jump(_) | Tok::Call)).count();
        if bad >= NO_SOURCE_STATEMENTS_MIN && bad > good {
            let (start, _, end) =
                tokens.iter().find(|(_, token, _)| *token == Tok::BadStatement).expect("some were counted");
            let span = self.span_of(*start, *end);
            self.out.truncate(first_token);
            self.diagnostics.truncate(first_message);
            return self.report(not_a_source(span, "neither a statement of STL nor a block begins here"));
        }
        let end = self.last_end();
        self.push(end, Tok::EndBlock, end);
    }

    /// Goes past a list of attributes before the keyword of a block, where a block cannot have it; false: none is here.
    fn attributes_before_block(&mut self) -> bool {
        let opening = self.raw[self.at];
        let tokens = self.raw[self.at..].iter().take(ATTRIBUTE_TOKENS_MAX);
        let length = tokens.take_while(|token| token.kind != RawKind::RightBrace).count();
        let block = self.at + length + 1;
        if self.kind_at(block - 1) != Some(RawKind::RightBrace) || self.block_keyword(block).is_none() {
            return false;
        }
        self.at = block;
        let head = &self.text[self.raw[block].start as usize..];
        let message = frame::attributes_before_block(self.span(opening), head);
        self.report(message);
        true
    }

    // Raw tokens.

    /// The word at `index` in upper case; empty if there is no word.
    fn upper(&self, index: usize) -> Upper {
        match self.raw.get(index) {
            Some(token) if token.kind == RawKind::Word => {
                Upper::new(token.keyword.unwrap_or(&self.text[token.range()]))
            }
            _ => Upper::new(""),
        }
    }

    // Keywords of frames.

    /// The keyword at `index` that begins a block. A component named `TYPE` is not one: a name follows a keyword.
    fn block_keyword(&self, index: usize) -> Option<Tok<'static>> {
        use crate::stl::token::CodeKeyword;
        let keyword = match self.upper(index).as_str() {
            "ORGANIZATION_BLOCK" => Tok::Code(CodeKeyword::OrganizationBlock),
            "FUNCTION" => Tok::Code(CodeKeyword::Function),
            "FUNCTION_BLOCK" => Tok::Code(CodeKeyword::FunctionBlock),
            "DATA_BLOCK" => Tok::DataBlock,
            "TYPE" => Tok::Type,
            "PROGRAM" if self.names_program(index) => Tok::Code(CodeKeyword::FunctionBlock),
            _ => return None,
        };
        let before = index.checked_sub(1).and_then(|before| self.kind_at(before));
        if matches!(before, Some(RawKind::Hash | RawKind::Dot | RawKind::Assign)) {
            return None;
        }
        match self.kind_at(index + 1) {
            Some(RawKind::Word | RawKind::Quoted | RawKind::Hash | RawKind::UnterminatedQuoted) | None => Some(keyword),
            Some(_) if keyword != Tok::Type => match self.kind_at(index + 1) {
                Some(RawKind::Colon | RawKind::Assign | RawKind::Dot | RawKind::Comma) => None,
                _ => Some(keyword),
            },
            Some(_) => None,
        }
    }

    /// `PROGRAM Main` on a line of its own.
    fn names_program(&self, index: usize) -> bool {
        let alone = |at: usize| self.raw_at(at).is_none_or(|token| token.first_on_line);
        let is_name = matches!(self.kind_at(index + 1), Some(RawKind::Word | RawKind::Quoted));
        alone(index) && is_name && !alone(index + 1) && alone(index + 2)
    }

    // Constants, common to declarations, values and operands.

    /// Takes the current constant (a number, text or `#` constant), with the sign before it.
    fn literal(&mut self) {
        let first = self.raw[self.at];
        let signed = matches!(first.kind, RawKind::Minus | RawKind::Plus);
        if signed {
            self.at += 1;
        }
        let token = self.raw[self.at];
        let text = if signed { &self.text[first.start as usize..token.end as usize] } else { self.slice(token) };
        self.at += 1;
        let tok = self.literal_token(text, self.span_of(first.start as usize, token.end as usize));
        self.push(first.start as usize, tok, token.end as usize);
    }

    /// Takes a constant of a declaration or after BEGIN, which may be one that no instruction loads.
    fn declared_literal(&mut self) {
        let first = self.raw[self.at];
        let signed = matches!(first.kind, RawKind::Minus | RawKind::Plus);
        let after = self.at + 1 + usize::from(signed);
        let token = self.raw[after - 1];
        let text = self.slice(token);
        let is_long = raw::is_long(text)
            || self.may_be_long
                && token.kind != RawKind::Text
                && literal::parse(text).is_err_and(|error| error.code == Code::LiteralRange);
        if !is_long {
            return self.literal();
        }
        match scl::literal::parse(text) {
            Ok(scl::literal::Read { value, wrapped: None }) => {
                self.take_up_to(Tok::LongLiteral(value, first.kind == RawKind::Minus), after);
            }
            Err(error) if raw::is_long(text) => {
                self.report(error.at(self.span(token)));
                self.take_up_to(Tok::BadOperand, after);
            }
            _ => self.literal(),
        }
    }

    fn literal_token(&mut self, text: &str, span: Span) -> Tok<'a> {
        if raw::is_long(text) {
            self.report(
                Diagnostic::new(Code::BadLiteral, span, format!("`{text}` is not an operand of STL"))
                    .label("only declarations have constants of this type")
                    .help("declare a variable with this start value, and name it here"),
            );
            return Tok::BadOperand;
        }
        let compact: String;
        let value = if text.starts_with(['-', '+']) {
            compact = text.chars().filter(|c| !matches!(c, ' ' | '\t')).collect();
            &compact
        } else {
            text
        };
        match literal::parse(value) {
            Ok(value) => {
                self.warn_of_blanks(&value, text, span);
                Tok::Literal(value)
            }
            Err(error) => {
                self.report(error.at(span));
                Tok::BadOperand
            }
        }
    }

    fn warn_of_blanks(&mut self, value: &Literal, text: &str, span: Span) {
        if matches!(value, Literal::Date(_) | Literal::DateAndTime(_)) && text.contains([' ', '\t']) {
            let compact: String = text.chars().filter(|c| !c.is_whitespace()).collect();
            self.report(
                Diagnostic::new(Code::BlanksInLiteral, span, "STEP 7 allows no blanks inside a constant")
                    .label("read as one constant")
                    .help(format!("write `{compact}`")),
            );
        }
    }

    /// Whether a constant begins at `index`: a value, or a sign with a number after it.
    fn is_literal(&self, index: usize) -> bool {
        match self.kind_at(index) {
            Some(RawKind::Number | RawKind::Real | RawKind::Text | RawKind::Literal) => true,
            Some(RawKind::Minus | RawKind::Plus) => {
                matches!(self.kind_at(index + 1), Some(RawKind::Number | RawKind::Real))
            }
            _ => false,
        }
    }

    /// Reports the current raw token, which is allowed nowhere, and advances. A `BadOperand` takes its place.
    fn stray(&mut self) {
        let token = self.raw[self.at];
        let span = self.span(token);
        let slice = self.slice(token);
        let diagnostic = match token.kind {
            RawKind::UnterminatedText => front::unterminated_text(span),
            RawKind::UnterminatedQuoted => front::unterminated_name(span, "symbol"),
            RawKind::Stray => {
                let language = "STL outside texts and comments";
                let after = &self.text[token.end as usize..];
                let digits = &after[..extent::word(after)];
                if slice == "$"
                    && let Some(written) = suggest::hexadecimal(digits)
                {
                    self.report(
                        Diagnostic::new(Code::ForeignForm, span, "a hexadecimal number begins with `16#`")
                            .label("not a constant of STL")
                            .help(format!("write `{written}`")),
                    );
                    return self.skip_stray();
                }
                let rest = self.raw.get(self.at + 1).filter(|next| !next.first_on_line);
                let rest = rest.map_or("", |next| self.slice(*next));
                if slice == "!" {
                    let (title, help) = match rest {
                        "=" | "==" => ("not equal is `<>`", "write `<>I` for INT, `<>D` for DINT, `<>R` for REAL"),
                        _ => (
                            "a negation is a part of the instruction",
                            "write `AN`, `ON` or `XN` before the operand, or `NOT` on a line of its own",
                        ),
                    };
                    self.report(
                        Diagnostic::new(Code::ForeignForm, span, title)
                            .label("a form of other languages")
                            .help(suggest::in_set(help, self.set)),
                    );
                    return self.skip_stray();
                }
                let help = front::stray_help(self.text.get(span.start as usize..).unwrap_or_default(), "symbol");
                front::stray_characters(span, slice, "statement", language, &help)
            }
            _ if slice == "-"
                && self
                    .raw
                    .get(self.at + 1)
                    .is_some_and(|next| next.start == token.end && self.slice(*next) == "-") =>
            {
                self.report(
                    Diagnostic::new(Code::ForeignForm, span, "a comment begins with `//`")
                        .label("a form of other languages")
                        .help("write `//` in place of `--`"),
                );
                self.take(Tok::BadOperand);
                while self.peek().is_some_and(|token| !token.first_on_line) {
                    self.at += 1;
                }
                return;
            }
            _ if let Some(help) = self.operator_between(slice) => {
                Diagnostic::new(Code::Syntax, span, format!("a statement has no `{slice}` between operands"))
                    .label("a form of other languages")
                    .help(help)
            }
            _ => {
                let next = self.raw.get(self.at + 1).filter(|next| next.start == token.end);
                let is_zero = slice == "=" && next.is_some_and(|next| self.slice(*next) == "0");
                let help = match self.last() {
                    _ if is_zero => "the status bit for a result of 0 is `==0`",
                    Some(Tok::Register(_)) if slice == "+" => "write `,` in place of `+`: `[AR1,P#0.0]`",
                    _ => "an operand is an address (`M 10.0`), a name (`#name`, `\"symbol\"`) or a constant",
                };
                Diagnostic::new(Code::Syntax, span, format!("`{slice}` is not allowed here"))
                    .label("not expected")
                    .help(help)
            }
        };
        self.report(diagnostic);
        self.skip_stray();
    }

    /// Takes the token, and after a character without a meaning the rest of its statement, as an operand that was reported.
    fn skip_stray(&mut self) {
        let token = self.raw[self.at];
        self.take(Tok::BadOperand);
        if token.kind == RawKind::Stray {
            // Text after a character without a meaning has no meaning either.
            while self.peek().is_some_and(|next| {
                !next.first_on_line
                    && !matches!(
                        next.kind,
                        RawKind::Semicolon | RawKind::Comma | RawKind::RightParen | RawKind::RightBracket
                    )
            }) {
                self.at += 1;
            }
        }
    }
}

/// The text at `span` belongs to no PLC source.
pub fn not_a_source(span: Span, label: &str) -> Diagnostic {
    Diagnostic::new(Code::NotASource, span, "this file does not contain a PLC source")
        .label(label)
        .help("pass a source in STL or SCL as STEP 7 or the TIA Portal exports it: blocks, or statements such as `A I 0.0`, but not a printout")
}

/// Whether the word (upper case) ends a block.
fn is_end_of_block(word: &str) -> bool {
    const ENDS: [&str; 6] =
        ["END_ORGANIZATION_BLOCK", "END_FUNCTION", "END_FUNCTION_BLOCK", "END_DATA_BLOCK", "END_TYPE", "END_PROGRAM"];
    ENDS.contains(&word)
}

/// Whether the word (upper case) begins a declaration section.
fn is_section(word: &str) -> bool {
    matches!(word, "VAR" | "VAR_INPUT" | "VAR_OUTPUT" | "VAR_IN_OUT" | "VAR_TEMP")
}

/// Text between the quotes of a `"name"`.
fn unquoted(text: &str) -> &str {
    text.trim_matches('"').trim()
}
