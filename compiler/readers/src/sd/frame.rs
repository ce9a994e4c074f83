//! The frame of a document: which tokens belong to heads and declarations, which to networks, and what the attributes in braces describe.
//!
//! Heads and declarations are nearly those of SCL. This pass removes and adds what differs: attributes in braces, networks, the
//! `:` before the type of a data block; `BEGIN` before the values of a data block, and TYPE before each type of a document.

mod declaration;

use std::collections::HashMap;
use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::classify::is_word;
use super::pragma::{self, Attribute};
use plcc_syntax::front::{Comment, CommentForm};
use plcc_syntax::scl::keyword::Keyword;
use plcc_syntax::scl::raw::{RawKind, RawText, RawToken};

/// The parts of a document.
pub struct Document {
    /// All tokens of the text.
    pub tokens: Vec<RawToken>,
    /// Heads and declarations, in the form of SCL.
    pub declarations: RawText,
    pub blocks: Vec<Frame>,
    /// Comments inside networks.
    pub comments: Vec<Comment>,
    /// Attributes before a name that is declared, by the first byte of the name.
    pub members: HashMap<u32, Vec<Attribute>>,
}

/// A block.
pub struct Frame {
    /// First byte of its keyword.
    pub start: u32,
    pub attributes: Vec<Attribute>,
    pub networks: Vec<NetworkSource>,
}

/// A network.
pub struct NetworkSource {
    pub attributes: Vec<Attribute>,
    /// Indices of the tokens between `NETWORK` and its end.
    pub tokens: Range<usize>,
    /// The bytes between them.
    pub bytes: Range<usize>,
    /// Of `NETWORK`.
    pub span: Span,
}

/// Splits a document into its parts.
pub fn read(file: FileId, text: &str, raw: RawText, diagnostics: &mut Vec<Diagnostic>) -> Document {
    // Regions count tokens, and some tokens are removed; regions of networks are read again with the networks.
    let RawText { tokens, comments, regions: _, slips, iec: _ } = raw;
    let mut reader = Reader {
        file,
        text,
        tokens: &tokens,
        at: 0,
        out: Vec::new(),
        pending: Vec::new(),
        blocks: Vec::new(),
        members: HashMap::new(),
        diagnostics,
    };
    reader.document();
    let Reader { out, blocks, members, .. } = reader;
    let networks: Vec<&Range<usize>> =
        blocks.iter().flat_map(|block| &block.networks).map(|network| &network.bytes).collect();
    let kept = |comment: &Comment| {
        let at = comment.start as usize;
        let before = networks.partition_point(|bytes| bytes.start <= at);
        let inside = before > 0 && networks[before - 1].contains(&at);
        comment.form == CommentForm::Unterminated || !inside
    };
    let (outside, inside): (Vec<Comment>, Vec<Comment>) = comments.into_iter().partition(kept);
    let declarations = RawText { tokens: out, comments: outside, slips, ..RawText::default() };
    Document { tokens, declarations, blocks, comments: inside, members }
}

/// Attributes before something that has not been read yet.
struct Pending {
    attributes: Vec<Attribute>,
    /// Of `{`.
    span: Span,
}

struct Reader<'a, 'r> {
    file: FileId,
    text: &'a str,
    tokens: &'r [RawToken],
    /// Index of the next token.
    at: usize,
    out: Vec<RawToken>,
    pending: Vec<Pending>,
    blocks: Vec<Frame>,
    members: HashMap<u32, Vec<Attribute>>,
    diagnostics: &'r mut Vec<Diagnostic>,
}

impl Reader<'_, '_> {
    fn document(&mut self) {
        while let Some(token) = self.token() {
            match token.keyword {
                _ if token.kind == RawKind::LeftBrace => self.attributes(),
                _ if token.kind == RawKind::Semicolon => self.at += 1,
                Some(keyword) if self.begins_block() => self.block(token, keyword),
                _ => self.outside_of_blocks(token),
            }
        }
        self.misplaced_attributes();
    }

    /// Skips text outside blocks.
    fn outside_of_blocks(&mut self, token: RawToken) {
        let word = &self.text[token.range()];
        let ends = token.keyword.is_some_and(Keyword::ends_block);
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(token), format!("`{word}` is not allowed outside a block"))
                .label("no block is open here")
                .help(if ends {
                    "remove it, or write the beginning of its block before it"
                } else {
                    "a document contains a block: `FUNCTION_BLOCK Name … END_FUNCTION_BLOCK`, a data block or types"
                }),
        );
        self.pending.clear();
        self.at += 1;
        while let Some(token) = self.token() {
            let ends = token.keyword.is_some_and(Keyword::ends_block);
            if self.begins_block() || ends || self.before_block() {
                return;
            }
            self.at += 1;
        }
    }

    /// Whether attributes of a block follow.
    fn before_block(&self) -> bool {
        self.is_at(RawKind::LeftBrace)
            && pragma::end(self.tokens, self.at).is_some_and(|after| self.begins_block_at(after))
    }

    fn block(&mut self, token: RawToken, keyword: Keyword) {
        let attributes = self.taken_attributes();
        self.blocks.push(Frame { start: token.start, attributes, networks: Vec::new() });
        match keyword {
            Keyword::DataBlock => self.data_block(),
            Keyword::Type => self.types(),
            _ => self.code_block(),
        }
    }

    // Blocks with code.

    /// Head, sections and networks.
    fn code_block(&mut self) {
        self.push();
        self.block_name();
        let mut head = true;
        while let Some(token) = self.token() {
            match token.keyword {
                Some(keyword) if keyword.ends_block() => {
                    self.misplaced_attributes();
                    return self.push();
                }
                Some(_) if self.begins_block() => return,
                Some(keyword) if keyword.begins_section() => {
                    head = false;
                    self.misplaced_attributes();
                    self.section();
                }
                _ if token.kind == RawKind::LeftBrace => self.attributes_of_block_or_network(head),
                _ if self.network_begins(self.at) => {
                    head = false;
                    self.network(token, self.at + 1);
                }
                _ if self.is_word("RUNG") => {
                    head = false;
                    self.rungs(token);
                }
                _ if head && !self.is_word("END_NETWORK") => self.push(),
                _ => {
                    head = false;
                    self.outside_of_networks(token);
                }
            }
        }
    }

    fn block_name(&mut self) {
        if matches!(self.token().map(|token| token.kind), Some(RawKind::Word | RawKind::Quoted)) {
            self.push();
        }
    }

    /// After the name of a block, attributes belong to the block unless a network follows.
    fn attributes_of_block_or_network(&mut self, head: bool) {
        self.attributes();
        let network = self.network_begins(self.at) || self.is_word("RUNG") || self.is_at(RawKind::LeftBrace);
        if head && !network {
            let attributes = self.taken_attributes();
            if let Some(block) = self.blocks.last_mut() {
                block.attributes.extend(attributes);
            }
        }
    }

    fn outside_of_networks(&mut self, token: RawToken) {
        if token.kind == RawKind::Semicolon {
            self.at += 1;
            return;
        }
        let word = &self.text[token.range()];
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(token), format!("`{word}` is not allowed outside a network"))
                .label("no network is open here")
                .help("write statements and rungs between `NETWORK` and `END_NETWORK`"),
        );
        self.at += 1;
        while let Some(token) = self.token() {
            let ends = token.keyword.is_some_and(|word| word.ends_block() || word.begins_section());
            if ends || self.network_begins(self.at) || self.begins_block() || token.kind == RawKind::LeftBrace {
                return;
            }
            self.at += 1;
        }
    }

    fn network_begins(&self, index: usize) -> bool {
        is_word(self.text, self.tokens, index, "NETWORK")
            && !matches!(
                self.tokens.get(index + 1).map(|token| token.kind),
                Some(RawKind::Colon | RawKind::Assign | RawKind::Arrow | RawKind::Comma | RawKind::Dot)
            )
    }

    /// Rungs without `NETWORK` before them.
    fn rungs(&mut self, first: RawToken) {
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(first), "`NETWORK` is missing")
                .label("this rung is in no network")
                .help("write `NETWORK` before the rungs of a network, and `END_NETWORK` after them"),
        );
        self.network(first, self.at);
    }

    /// A network from `NETWORK`, or from its first rung, to its end. `first`: the index of the first token in it.
    fn network(&mut self, opening: RawToken, first: usize) {
        let attributes = self.taken_attributes();
        let begins = first > self.at;
        let mut end = first;
        while let Some(token) = self.tokens.get(end).copied() {
            let closes = is_word(self.text, self.tokens, end, "END_NETWORK");
            let leaves =
                token.keyword.is_some_and(Keyword::ends_block) || self.network_begins(end) || self.begins_block_at(end);
            if closes || leaves {
                break;
            }
            end += 1;
        }
        let closed = is_word(self.text, self.tokens, end, "END_NETWORK");
        self.at = if closed { end + 1 } else { end };
        if !closed {
            if begins {
                self.report(
                    Diagnostic::new(Code::BlockFrame, self.span(opening), "`END_NETWORK` is missing")
                        .label("this network is not closed")
                        .help("write `END_NETWORK` after its last rung or statement"),
                );
            }
            end = self.without_last_attributes(first, end);
            self.at = end;
        }
        let next = self.tokens.get(end).map_or(self.text.len(), |token| token.start as usize);
        let inside = if begins { opening.end as usize } else { opening.start as usize };
        if let Some(block) = self.blocks.last_mut() {
            block.networks.push(NetworkSource {
                attributes,
                tokens: first..end,
                bytes: inside..next.max(inside),
                span: Span { file: self.file, start: opening.start, end: opening.end },
            });
        }
    }

    /// Attributes before the next network are not part of this one.
    fn without_last_attributes(&self, first: usize, end: usize) -> usize {
        let tokens = &self.tokens[first..end];
        if tokens.last().is_none_or(|token| token.kind != RawKind::RightBrace) {
            return end;
        }
        tokens.iter().rposition(|token| token.kind == RawKind::LeftBrace).map_or(end, |at| first + at)
    }

    // Attributes.

    /// Takes the current braces.
    fn attributes(&mut self) {
        let opening = self.tokens[self.at];
        let (attributes, after) = pragma::read(self.file, self.text, self.tokens, self.at, self.diagnostics);
        self.pending.push(Pending { attributes, span: self.span(opening) });
        self.at = after;
    }

    /// The attributes before the current token. Several braces in a row are an error.
    fn taken_attributes(&mut self) -> Vec<Attribute> {
        if let [first, .., last] = self.pending.as_slice() {
            let diagnostic = Diagnostic::new(Code::Syntax, last.span, "a second list of attributes")
                .label("follows another list")
                .also(first.span, "the first list")
                .help("write all attributes into one list");
            self.report(diagnostic);
        }
        self.pending.drain(..).flat_map(|pending| pending.attributes).collect()
    }

    /// Reports attributes that are followed by nothing they could belong to.
    fn misplaced_attributes(&mut self) {
        for pending in std::mem::take(&mut self.pending) {
            self.report(
                Diagnostic::new(Code::Syntax, pending.span, "these attributes belong to nothing")
                    .label("no block, network or name follows")
                    .help("write attributes directly before `NETWORK`, or before the name that they describe"),
            );
        }
    }

    // Tokens.

    fn token(&self) -> Option<RawToken> {
        self.tokens.get(self.at).copied()
    }

    fn is_at(&self, kind: RawKind) -> bool {
        self.token().is_some_and(|token| token.kind == kind)
    }

    fn is_word(&self, word: &str) -> bool {
        is_word(self.text, self.tokens, self.at, word)
    }

    fn begins_block(&self) -> bool {
        self.begins_block_at(self.at)
    }

    /// Whether a block begins at `index`: its keyword, and a name.
    fn begins_block_at(&self, index: usize) -> bool {
        let Some(keyword) = self.tokens.get(index).and_then(|token| token.keyword) else { return false };
        let next = self.tokens.get(index + 1).map(|token| token.kind);
        keyword.begins_block()
            && match next {
                None | Some(RawKind::Word | RawKind::Quoted | RawKind::UnterminatedQuoted) => true,
                Some(RawKind::LeftBrace) => keyword == Keyword::Type,
                Some(_) => false,
            }
    }

    /// Keeps the current token.
    fn push(&mut self) {
        if let Some(token) = self.token() {
            self.out.push(token);
            self.at += 1;
        }
    }

    /// Puts a keyword without width before `next`.
    fn insert(&mut self, next: RawToken, keyword: Keyword) {
        self.out.push(RawToken {
            kind: RawKind::Word,
            start: next.start,
            end: next.start,
            first_on_line: true,
            keyword: Some(keyword),
        });
    }

    fn span(&self, token: RawToken) -> Span {
        Span { file: self.file, start: token.start, end: token.end }
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }
}
