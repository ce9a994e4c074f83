//! What the actions of the grammar work with: the text, its tokens and comments, and the messages.

use std::ops::Range;

use lalrpop_util::ErrorRecovery;
use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::token::{Spanned, Tok};
use plcc_syntax::comment::{Comment, CommentForm};
use plcc_syntax::frame;
use plcc_syntax::scl::ast::{Name, NameForm};

/// Where a syntax error was recovered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    Permanent,
    Action,
    Parameter,
    Steps,
    Condition,
}

/// Context of a parse.
pub struct Context<'a> {
    pub file: FileId,
    pub text: &'a str,
    /// All tokens, for messages.
    pub tokens: &'a [Spanned<'a>],
    pub comments: &'a [Comment],
    pub diagnostics: Vec<Diagnostic>,
    /// Starts of the messages of `classify`, in order: where there is one, the grammar reports nothing.
    pub reported: Vec<u32>,
}

impl<'a> Context<'a> {
    pub fn span(&self, range: Range<usize>) -> Span {
        Span::new(self.file, range.start..range.end.max(range.start))
    }

    /// A name; blanks in an address such as `MW 10` are not part of it.
    pub fn name(&self, text: &str, form: NameForm, range: Range<usize>) -> Name {
        let text = if form == NameForm::Bare { text.replace(' ', "") } else { text.to_owned() };
        Name { text, form, span: self.span(range) }
    }

    pub fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// Reports a recovered error, unless there is a message within `range`.
    pub fn syntax_error(&mut self, error: ErrorRecovery<usize, Tok<'a>, ()>, place: Place, range: Range<usize>) {
        let found = frame::error_range(&error.error).unwrap_or((range.end, range.end));
        if frame::is_reported(&self.reported, &self.diagnostics, range.start.min(found.0)..range.end.max(found.1)) {
            return;
        }
        let diagnostic = self.message(found.0, place);
        self.report(diagnostic);
    }

    /// The message for the token at byte `found`, or for the one before it if the text ends too early.
    fn message(&self, found: usize, place: Place) -> Diagnostic {
        let (code, what, help) = match place {
            Place::Permanent => (
                Code::Syntax,
                "permanent instruction",
                "write `operand (=) := condition`, `operand (S) := condition` or `CALL FC1 ()`",
            ),
            Place::Action => (
                Code::ActionText,
                "action",
                "an action is `operand (N)`, `operand := value (N)`, `operand := T#5S (D)` or `CALL FC1 () (N)`",
            ),
            Place::Parameter => {
                (Code::Syntax, "parameter", "write `name := value` for inputs and outputs, separated by `,`")
            }
            Place::Steps => (Code::Syntax, "list of steps", "write the name of a step, or several as `(Fill, Heat)`"),
            Place::Condition => (
                Code::Syntax,
                "condition",
                "a condition is built of operands, AND, OR, XOR, NOT, comparisons and brackets",
            ),
        };
        let index = self.tokens.partition_point(|(start, ..)| *start < found);
        let wide = |token: &&Spanned| token.0 < token.2;
        let before = self.tokens[..index].iter().rev().find(wide);
        match self.tokens.get(index).filter(wide) {
            Some((start, _, end)) => {
                let text = &self.text[*start..*end];
                let title = match before {
                    Some((start, tok, end)) if follows(tok) => {
                        format!("`{text}` cannot follow `{}` in this {what}", &self.text[*start..*end])
                    }
                    _ => format!("`{text}` cannot begin this {what}"),
                };
                Diagnostic::new(code, self.span(*start..*end), title).label("not expected here").help(help)
            }
            None => {
                let (start, end) = before.map_or((0, 0), |(start, _, end)| (*start, *end));
                Diagnostic::new(code, self.span(start..end), format!("this {what} is not complete"))
                    .label("something is missing after this")
                    .help(help)
            }
        }
    }

    /// The comment after byte `end`, on the same line.
    pub fn comment_after(&self, end: usize) -> Option<String> {
        comment_after(self.text, self.comments, end)
    }
}

/// The comment of either form after byte `end`, if there are only blanks and `;` between. The lines of the comment are joined.
pub fn comment_after(text: &str, comments: &[Comment], end: usize) -> Option<String> {
    let comment = comments.get(comments.partition_point(|comment| (comment.start as usize) < end))?;
    let between = &text[end..comment.start as usize];
    let inside = &text[comment.start as usize + 2..comment.end as usize];
    if !between.bytes().all(|byte| matches!(byte, b' ' | b'\t' | b';')) || inside.starts_with('@') {
        return None;
    }
    let inside = match comment.form {
        CommentForm::Line => inside,
        CommentForm::Block => inside.strip_suffix("*)").unwrap_or(inside),
        CommentForm::Slash | CommentForm::Unterminated => return None,
    };
    let words: Vec<&str> = inside.split_whitespace().collect();
    (!words.is_empty()).then(|| words.join(" "))
}

/// Whether the text after the token belongs to the same row.
fn follows(tok: &Tok) -> bool {
    !matches!(
        tok,
        Tok::Settings(_)
            | Tok::Comment(_)
            | Tok::Permanents(_)
            | Tok::Step(_)
            | Tok::Interlock
            | Tok::Supervision
            | Tok::Number(_)
            | Tok::End
            | Tok::Qualifier(_)
            | Tok::From
            | Tok::To
            | Tok::Condition
    )
}
