//! The frame of a file: which tokens of a block are its chart, and which bytes are heads and declarations in the form of SCL.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::classify::Keyword;
use super::lexer::{RawKind, RawText, RawToken};
use super::pragma;
use crate::gr7::classify::keyword_at;
use plcc_syntax::front::pragma::is_pragma;
use plcc_syntax::front::{Comment, CommentForm};

/// The parts of a file.
pub struct Document {
    pub blocks: Vec<Frame>,
    /// Bytes that SCL reads, in order: heads, declarations, ends of blocks, and pragmas for the file.
    pub declarations: Vec<Range<usize>>,
    /// Pragmas inside charts, without those for the file.
    pub misplaced: Vec<Range<usize>>,
}

/// A block.
pub struct Frame {
    /// First byte of its keyword.
    pub start: u32,
    /// The tokens of its chart, including settings and comments of the block.
    pub chart: Vec<RawToken>,
}

/// Splits a file into its parts.
pub fn read(file: FileId, text: &str, raw: &RawText, diagnostics: &mut Vec<Diagnostic>) -> Document {
    let mut reader =
        Reader { file, text, tokens: &raw.tokens, at: 0, blocks: Vec::new(), declarations: Vec::new(), diagnostics };
    reader.file();
    let Reader { blocks, mut declarations, .. } = reader;
    let in_chart = |comment: &Comment| {
        let before = blocks.partition_point(|block| block.start < comment.start);
        let chart = before.checked_sub(1).map_or(&[][..], |before| &blocks[before].chart);
        chart.first().zip(chart.last()).is_some_and(|(first, last)| (first.start..last.end).contains(&comment.start))
    };
    let declared = |comment: &Comment| {
        let before = declarations.partition_point(|range| range.start <= comment.start as usize);
        before > 0 && declarations[before - 1].contains(&(comment.start as usize))
    };
    let (mut pragmas, mut misplaced) = (Vec::new(), Vec::new());
    for comment in raw.comments.iter().filter(|comment| comment.form == CommentForm::Line && comment.own_line) {
        let range = comment.start as usize..comment.end as usize;
        let words = &text[range.clone()];
        if !is_pragma(words) || declared(comment) {
            continue;
        }
        let is_for_file = matches!(words["//@".len()..].split_whitespace().next(), Some("cpu" | "test"));
        let list = if in_chart(comment) && !is_for_file { &mut misplaced } else { &mut pragmas };
        list.push(range);
    }
    declarations.extend(pragmas);
    declarations.sort_by_key(|range| range.start);
    Document { blocks, declarations, misplaced }
}

struct Reader<'a, 'r> {
    file: FileId,
    text: &'a str,
    tokens: &'r [RawToken],
    /// Index of the next token.
    at: usize,
    blocks: Vec<Frame>,
    declarations: Vec<Range<usize>>,
    diagnostics: &'r mut Vec<Diagnostic>,
}

impl Reader<'_, '_> {
    fn file(&mut self) {
        while let Some(token) = self.token() {
            match self.keyword() {
                Some(Keyword::FunctionBlock) => self.block(token),
                _ if matches!(token.kind, RawKind::Semicolon | RawKind::Pragma) => self.at += 1,
                _ => self.outside_of_blocks(token),
            }
        }
    }

    fn outside_of_blocks(&mut self, token: RawToken) {
        let word = &self.text[token.range()];
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(token), format!("`{word}` is not allowed outside a block"))
                .label("no block is open here")
                .help("write a chart between `FUNCTION_BLOCK FB1` and `END_FUNCTION_BLOCK`"),
        );
        while self.token().is_some() && self.keyword() != Some(Keyword::FunctionBlock) {
            self.at += 1;
        }
    }

    /// A block from its keyword to its end.
    fn block(&mut self, opening: RawToken) {
        self.declare();
        if let Some(name) = self.token()
            && matches!(name.kind, RawKind::Word | RawKind::Quoted | RawKind::Local | RawKind::UnterminatedQuoted)
            && (self.keyword().is_none() || !name.first_on_line)
        {
            self.declare();
        }
        let (mut chart, mut head) = (Vec::new(), true);
        while let Some(token) = self.token() {
            match self.keyword() {
                Some(Keyword::EndFunctionBlock) => {
                    self.declare();
                    break;
                }
                Some(Keyword::FunctionBlock) => break,
                Some(Keyword::Var) => self.section(),
                _ if token.kind == RawKind::Header => self.declare(),
                _ if token.kind == RawKind::LeftBrace && head => self.attributes(),
                _ => {
                    if token.kind == RawKind::Pragma {
                        self.check_tag(token);
                    } else {
                        head = false;
                    }
                    chart.push(token);
                    self.at += 1;
                }
            }
        }
        self.blocks.push(Frame { start: opening.start, chart });
    }

    /// `VAR … END_VAR`; SCL does not see pragmas among the declarations.
    fn section(&mut self) {
        let mut range = self.tokens[self.at].range();
        self.at += 1;
        while let Some(token) = self.token() {
            let keyword = self.keyword().filter(|_| !self.declares());
            if keyword.is_some_and(|keyword| keyword != Keyword::EndVar) {
                break;
            }
            self.at += 1;
            if token.kind == RawKind::Pragma {
                self.check_tag(token);
                self.declarations.push(std::mem::replace(&mut range, token.end as usize..token.end as usize));
                continue;
            }
            range.end = token.end as usize;
            if keyword.is_some() {
                break;
            }
        }
        self.declarations.push(range);
    }

    /// A variable may have the name of a keyword.
    fn declares(&self) -> bool {
        self.tokens.get(self.at + 1).is_some_and(|next| next.kind == RawKind::Colon)
    }

    /// `{ name := 'value' }`
    fn attributes(&mut self) {
        let start = self.tokens[self.at].start as usize;
        while let Some(token) = self.token() {
            if self.keyword().is_some() || token.kind == RawKind::Pragma {
                break;
            }
            self.at += 1;
            if token.kind == RawKind::RightBrace {
                break;
            }
        }
        let end = self.tokens[self.at - 1].end as usize;
        self.declarations.push(start..end);
    }

    fn check_tag(&mut self, token: RawToken) {
        let text = &self.text[token.range()];
        let name = pragma::name(text);
        let meant = pragma::meant(name);
        if pragma::tag(text).is_some() && meant.is_none() {
            return;
        }
        let start = token.start + 2;
        let span = Span { file: self.file, start, end: start + 2 + name.len() as u32 };
        self.report(match meant {
            Some(meant) => Diagnostic::new(Code::Tolerated, span, format!("the tag `$_{name}` is misspelt"))
                .label(format!("read as `$_{meant}`"))
                .help(format!("write `$_{meant}`")),
            None => Diagnostic::new(Code::Tolerated, span, format!("plcc does not know the tag `$_{name}`"))
                .label("read as a comment")
                .help("tags are `$_COM`, `$_CMPSET`, `$_SETTINGS`, `$_NUM` and `$_JUMP`"),
        });
    }

    // Tokens.

    fn token(&self) -> Option<RawToken> {
        self.tokens.get(self.at).copied()
    }

    fn keyword(&self) -> Option<Keyword> {
        keyword_at(self.text, self.tokens, self.at)
    }

    /// Keeps the current token for SCL.
    fn declare(&mut self) {
        self.declarations.push(self.tokens[self.at].range());
        self.at += 1;
    }

    fn span(&self, token: RawToken) -> Span {
        Span { file: self.file, start: token.start, end: token.end }
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }
}
