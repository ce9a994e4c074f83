//! Where the parts of statements are in the source: comments between them stay in the branch they are in.

use std::collections::HashMap;

use plcc_diag::Span;
use plcc_syntax::ast::CodeBlock;
use plcc_syntax::front::{Comment, CommentForm};
use plcc_syntax::scl::ast::{Statement, StatementKind};

/// Titles of networks are not longer.
const TITLE_MAX: usize = 64;

/// The source of a block.
pub struct Positions<'a> {
    text: &'a str,
    comments: &'a [Comment],
    /// Statements with others inside, by where they begin.
    compound: HashMap<u32, Compound>,
}

/// The parts of a statement that a typed tree has no places for.
#[derive(Clone, Debug, Default)]
pub struct Compound {
    /// Where the bodies of the branches or arms end.
    pub bodies: Vec<u32>,
    /// Where the last word of the statement is: `END_IF`.
    pub end: u32,
}

impl<'a> Positions<'a> {
    /// `lists`: the statements of the block.
    pub fn new(text: &'a str, comments: &'a [Comment], lists: &[&[Statement]]) -> Positions<'a> {
        let mut positions = Positions { text, comments, compound: HashMap::new() };
        lists.iter().for_each(|list| positions.add(list));
        positions
    }

    /// The parts of the compound statement that begins at `start`.
    pub fn compound(&self, start: u32) -> Compound {
        self.compound.get(&start).cloned().unwrap_or_default()
    }

    fn add(&mut self, statements: &[Statement]) {
        for statement in statements {
            let mut bodies = Vec::new();
            let end = self.last_word(statement.span);
            match &statement.kind {
                StatementKind::If { branches, .. } => {
                    for (at, (condition, body)) in branches.iter().enumerate() {
                        self.add(body);
                        let after = body.last().map_or(condition.span.end, |last| last.span.end);
                        bodies.push(match branches.get(at + 1) {
                            Some((next, _)) => self.word(after, next.span.start, "ELSIF").unwrap_or(next.span.start),
                            None => self.word(after, end, "ELSE").unwrap_or(end),
                        });
                    }
                }
                StatementKind::Case { arms, .. } => {
                    for (at, arm) in arms.iter().enumerate() {
                        self.add(&arm.body);
                        let after = arm.body.last().map_or(arm.span.end, |last| last.span.end);
                        bodies.push(match arms.get(at + 1) {
                            Some(next) => next.span.start,
                            None => self.word(after, end, "ELSE").unwrap_or(end),
                        });
                    }
                }
                StatementKind::For { body, .. }
                | StatementKind::While { body, .. }
                | StatementKind::Repeat { body, .. } => self.add(body),
                StatementKind::Empty
                | StatementKind::Label(_)
                | StatementKind::Expression(_)
                | StatementKind::Assign { .. }
                | StatementKind::Exit
                | StatementKind::Continue
                | StatementKind::Return(_)
                | StatementKind::Goto(_)
                | StatementKind::Pragma(_)
                | StatementKind::Error => continue,
            }
            if let StatementKind::If { otherwise, .. } | StatementKind::Case { otherwise, .. } = &statement.kind {
                self.add(otherwise);
            }
            self.compound.insert(statement.span.start, Compound { bodies, end });
        }
    }

    /// Where `END_IF` and the like are.
    fn last_word(&self, span: Span) -> u32 {
        let text = self.text.get(span.range()).unwrap_or_default().to_ascii_uppercase();
        text.rfind("END_").map_or(span.end, |at| span.start + at as u32)
    }

    /// The first place of a word outside of comments.
    fn word(&self, from: u32, to: u32, word: &str) -> Option<u32> {
        let text = self.text.get(from as usize..to as usize)?.to_ascii_uppercase();
        let is_part = |c: char| c.is_alphanumeric() || c == '_';
        text.match_indices(word).map(|(at, _)| at).find_map(|at| {
            let whole = !text[..at].ends_with(is_part) && !text[at + word.len()..].starts_with(is_part);
            let place = from + at as u32;
            (whole && !self.is_in_comment(place)).then_some(place)
        })
    }

    fn is_in_comment(&self, place: u32) -> bool {
        let before = self.comments.partition_point(|comment| comment.start <= place);
        before.checked_sub(1).is_some_and(|last| place < self.comments[last].end)
    }

    /// The comments that begin between the two places.
    fn comments_between(&self, from: u32, to: u32) -> &'a [Comment] {
        let first = |at: u32| self.comments.partition_point(|comment| comment.start < at);
        self.comments.get(first(from)..first(to)).unwrap_or_default()
    }

    /// A comment begins between the two places.
    pub fn has_comment(&self, from: u32, to: u32) -> bool {
        !self.comments_between(from, to).is_empty()
    }

    /// The lines of comments directly before a statement, as the comment of its network.
    pub fn comment_before(&self, from: u32, to: u32) -> Vec<String> {
        let text = |comment: &Comment| self.text.get(comment.range()).unwrap_or_default().trim_end();
        let plain = |comment: &&Comment| {
            comment.own_line && comment.form == CommentForm::Line && !text(comment).starts_with("//@")
        };
        let mut lines: Vec<String> = self
            .comments_between(from, to)
            .iter()
            .rev()
            .take_while(plain)
            .map(|comment| text(comment).trim_start_matches('/').trim().to_string())
            .collect();
        lines.reverse();
        lines
    }

    /// What the source has at a place.
    pub fn text(&self, span: Span) -> &'a str {
        self.text.get(span.range()).unwrap_or_default()
    }

    /// The first line of a statement.
    pub fn first_line(&self, span: Span) -> String {
        let text = self.text.get(span.range()).unwrap_or_default();
        let line = text.lines().next().unwrap_or_default();
        let line = line.split("//").next().unwrap_or_default();
        let line = line.split("(*").next().unwrap_or_default().trim();
        match line.char_indices().nth(TITLE_MAX) {
            Some((at, _)) => format!("{}...", line[..at].trim_end()),
            None => line.to_string(),
        }
    }

    /// Where the declarations of a block end.
    pub fn code_start(&self, block: &CodeBlock) -> u32 {
        let sections = block.sections.iter().map(|section| section.span.end);
        let constants = block.constants.iter().map(|constant| constant.name_span.end);
        sections.chain(constants).max().unwrap_or(block.name.span().end)
    }

    /// The last word of a block.
    pub fn end_of(&self, block: &CodeBlock) -> Span {
        let at = self.last_word(block.span);
        Span { start: at, end: at, ..block.span }
    }
}
