//! Mistakes that all notations share: brackets that do not match, texts without an end, characters without a use.

use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::comment::{Comment, CommentForm};
use super::cursor::Cursor;
use super::scan::{Bracket, Kind, RawToken};

/// How deep structured statements, STRUCTs, brackets and signs may be nested.
pub const NESTING_MAX: usize = 200;

/// Tokens of a grammar with brackets.
pub trait Brackets: Sized {
    /// The tokens, in the order of [`Bracket::ALL`].
    const BRACKETS: [Self; 4];

    /// The token for the bracket.
    fn bracket(bracket: Bracket) -> Self {
        let [left_paren, right_paren, left_bracket, right_bracket] = Self::BRACKETS;
        match bracket {
            Bracket::LeftParen => left_paren,
            Bracket::RightParen => right_paren,
            Bracket::LeftBracket => left_bracket,
            Bracket::RightBracket => right_bracket,
        }
    }
}

impl<K: Kind, W: Copy, T: Brackets> Cursor<'_, '_, K, W, T> {
    /// Takes the next token, an opening bracket; false: brackets are nested too deeply.
    pub fn open_bracket(&mut self, token: RawToken<K, W>, open: &mut Vec<RawToken<K, W>>) -> bool {
        let Some(bracket) = token.kind.bracket().filter(|_| open.len() < NESTING_MAX) else { return false };
        open.push(token);
        self.take(T::bracket(bracket));
        true
    }

    /// Takes the next token, a closing bracket, and closes those inside it. One that closes nothing is reported and skipped.
    pub fn close_bracket(&mut self, token: RawToken<K, W>, open: &mut Vec<RawToken<K, W>>) {
        let closing = token.kind.bracket();
        let fits = |opening: &RawToken<K, W>| opening.kind.bracket().map(Bracket::closing) == closing;
        if !open.iter().any(fits) {
            let sign = self.slice(token);
            self.report(
                Diagnostic::new(Code::Syntax, self.span(token), format!("`{sign}` closes nothing"))
                    .label("no bracket is open here")
                    .help("remove it, or write the bracket that it closes"),
            );
            self.at += 1;
            return;
        }
        while let Some(opening) = open.pop() {
            if fits(&opening) {
                break;
            }
            self.close_unclosed(opening);
        }
        self.take(T::bracket(closing.unwrap_or(Bracket::RightParen)));
    }

    /// Reports a bracket that is not closed, and closes it.
    pub fn close_unclosed(&mut self, opening: RawToken<K, W>) {
        let closing = self.unclosed(opening);
        self.push_here(T::bracket(closing));
    }

    /// Reports a bracket that is not closed; returns the one that is missing.
    pub fn unclosed(&mut self, opening: RawToken<K, W>) -> Bracket {
        let (sign, close, closing) = match opening.kind.bracket() {
            Some(Bracket::LeftParen) => ("(", ")", Bracket::RightParen),
            _ => ("[", "]", Bracket::RightBracket),
        };
        self.report(
            Diagnostic::new(Code::Syntax, self.span(opening), format!("`{sign}` is not closed"))
                .label("opened here")
                .help(format!("write `{close}` where it ends")),
        );
        closing
    }
}

/// The message for brackets or signs that are nested too deeply for code that walks the tree. `store`: where a part could be stored.
pub fn too_deep(span: Span, store: &str) -> Diagnostic {
    Diagnostic::new(Code::Syntax, span, "brackets or signs are nested too deeply")
        .label(format!("more than {NESTING_MAX} of them"))
        .help(format!("store a part of the expression in a {store}"))
}

/// The message for a text without its closing quote.
pub fn unterminated_text(span: Span) -> Diagnostic {
    Diagnostic::new(Code::UnterminatedText, span, "the text is not closed on its line")
        .label("begins here")
        .help("close it with `'`; write a quote inside as `$'`")
}

/// The message for a `"name"` without its closing quote. `what`: `name` or `symbol`.
pub fn unterminated_name(span: Span, what: &str) -> Diagnostic {
    Diagnostic::new(Code::UnterminatedText, span, format!("the {what} is not closed on its line"))
        .label("begins here")
        .help("close it with `\"`")
}

/// A comment that is not closed hides the ends of blocks and statements, which are then not reported as missing.
pub fn drop_followers_of_comment(comments: &[Comment], diagnostics: &mut Vec<Diagnostic>) {
    if comments.iter().any(|comment| comment.form == CommentForm::Unterminated) {
        diagnostics.retain(|diagnostic| {
            let missing = diagnostic.title.starts_with("`END_") && diagnostic.title.ends_with("is missing");
            diagnostic.code != Code::BlockFrame && !missing
        });
    }
}

/// The message for a comment without its end, which begins at byte `start`. `label`: how much of the file it includes.
pub fn unclosed_comment(file: FileId, start: u32, label: &str, help: &str) -> Diagnostic {
    Diagnostic::new(Code::UnterminatedText, Span { file, start, end: start + 2 }, "the comment is not closed")
        .label(label)
        .help(help)
}

/// The message for `characters` without a use. `whole`: what they cannot be part of; `language`: which one has no such characters.
pub fn stray_characters(span: Span, characters: &str, whole: &str, language: &str, help: &str) -> Diagnostic {
    let c = characters.chars().next().unwrap_or(' ');
    Diagnostic::new(Code::UnexpectedCharacter, span, format!("`{}` cannot be part of a {whole}", c.escape_debug()))
        .label(format!("not a character of {language}"))
        .help(help)
}

/// What to write in place of the character with which `rest` of the text begins, in notations of quotes and `//`.
/// `what`: `name` or `symbol`.
pub fn stray_help(rest: &str, what: &str) -> String {
    match rest.chars().next().unwrap_or(' ') {
        '‘' | '’' | '`' => "write texts in straight quotes: `'text'`".to_owned(),
        '“' | '”' | '„' => {
            let name = in_curved_quotes(rest).map_or(what, |(name, _)| name);
            format!("write {what}s in straight quotes: `\"{name}\"`")
        }
        '–' | '—' | '−' => "write the sign as `-`".to_owned(),
        '\\' => "comments begin with `//`".to_owned(),
        _ => "remove it, or put it into a comment after `//`".to_owned(),
    }
}

/// The name in `“name”` at the beginning of `text`, and the bytes of both with the quotes.
pub fn in_curved_quotes(text: &str) -> Option<(&str, usize)> {
    let inner = text.strip_prefix(['“', '”', '„'])?;
    let line = inner.lines().next()?;
    let end = line.find(['“', '”']).filter(|end| *end > 0)?;
    let quote = line[end..].chars().next()?;
    Some((&line[..end], text.len() - inner.len() + end + quote.len_utf8()))
}
