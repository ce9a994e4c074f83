//! Classifies the words of statements: where each begins and ends.
//!
//! `closing` has the words that close structured statements, `arm` the arms of CASE.

mod arm;
mod closing;

use plcc_diag::{Code, Diagnostic, Span};

use super::Classifier;
use super::expression::{Run, ends_operand};
use crate::front::NESTING_MAX;
use crate::front::pragma::is_for_file;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};
use crate::scl::token::Tok;

/// A section that is longer than this is not shown in a help.
const SECTION_MAX: usize = 80;

/// A structured statement that is open.
struct Open {
    /// Its first word.
    token: RawToken,
    keyword: Keyword,
    /// ELSE has been seen.
    otherwise: bool,
    /// CASE: a value has been seen.
    arm: bool,
    /// IF directly after the ELSE of this one: ELSIF may have been meant.
    else_if: Option<Span>,
    /// REPEAT: UNTIL has been seen.
    until: bool,
}

impl<'a> Classifier<'a, '_> {
    /// Statements up to the end of the block, which is not consumed.
    pub(super) fn code(&mut self) {
        let mut open: Vec<Open> = Vec::new();
        let mut unclosed = self.unclosed();
        loop {
            let limit = self.peek().map_or(u32::MAX, |token| token.start);
            self.statement_pragmas(limit);
            let Some(token) = self.peek() else { break };
            let before = self.at;
            match (token.kind, token.keyword) {
                (RawKind::Semicolon, _) => self.take(Tok::Empty),
                (RawKind::LeftBrace, _) => self.skip_braces(),
                (_, Some(word)) if word.ends_block() => break,
                (_, Some(word)) if word.begins_block() && self.block_begins(self.at) => break,
                (_, Some(word)) if word.begins_section() && self.section_in_code(token) => {}
                (_, Some(word)) if word.begins_statement() => {
                    if word == Keyword::While && self.is_condition_of_repeat(token, &open) {
                        self.closing_keyword(Keyword::Until, token, &mut open, &mut unclosed);
                    } else {
                        self.statement_keyword(word, token, &mut open);
                    }
                }
                (_, Some(word)) if word.closes_statement() => {
                    self.closing_keyword(word, token, &mut open, &mut unclosed);
                }
                (
                    _,
                    Some(
                        Keyword::Then
                        | Keyword::Begin
                        | Keyword::EndVar
                        | Keyword::EndStruct
                        | Keyword::EndConst
                        | Keyword::EndLabel,
                    ),
                ) => {
                    self.misplaced(token);
                }
                (_, Some(Keyword::Do | Keyword::Of | Keyword::To))
                    if !matches!(
                        self.kind_at(self.at + 1),
                        Some(RawKind::Assign | RawKind::Dot | RawKind::LeftBracket)
                    ) =>
                {
                    self.misplaced(token);
                }
                _ => self.label_or_simple(&mut open),
            }
            if self.at == before {
                self.misplaced(token);
            }
        }
        while let Some(statement) = open.pop() {
            self.unclosed_statement(statement);
        }
    }

    /// Pragmas before byte `before`: in statements.
    fn statement_pragmas(&mut self, before: u32) {
        while let Some(comment) = self.next_pragma(before) {
            let pragma = self.read_pragma(comment);
            if is_for_file(&pragma) {
                self.pragmas.push(pragma);
            } else {
                self.push(comment.start as usize, Tok::Pragma(Box::new(pragma)), comment.end as usize);
            }
        }
    }

    /// Labels that the block's statements jump to, or that it declares.
    pub(super) fn collect_labels(&mut self) {
        let mut declared = false;
        let mut index = self.at;
        while let Some(token) = self.raw.get(index).copied() {
            match token.keyword {
                Some(word) if word.ends_block() => return,
                Some(Keyword::Label) => declared = true,
                Some(Keyword::EndLabel) => declared = false,
                Some(Keyword::Goto) => {
                    if let Some(name) = self.raw.get(index + 1).copied() {
                        self.labels.insert(self.slice(name).to_uppercase());
                    }
                }
                _ if declared && token.kind == RawKind::Word => {
                    self.labels.insert(self.slice(token).to_uppercase());
                }
                _ => {}
            }
            index += 1;
        }
    }

    fn statement_keyword(&mut self, word: Keyword, token: RawToken, open: &mut Vec<Open>) {
        match word {
            Keyword::Exit => self.take(Tok::Exit),
            Keyword::Continue => self.take(Tok::Continue),
            Keyword::Return => {
                self.take(Tok::Return);
                self.run(Run::Statement);
            }
            Keyword::Goto => {
                self.take(Tok::Goto);
                self.run(Run::Statement);
            }
            _ => return self.structured(word, token, open),
        }
        self.end_of_statement();
    }

    /// IF, CASE, FOR, WHILE or REPEAT, up to where its statements begin.
    fn structured(&mut self, word: Keyword, token: RawToken, open: &mut Vec<Open>) {
        if open.len() >= NESTING_MAX {
            return self.too_deep_statement(token);
        }
        if word == Keyword::If
            && let Some(outer) = open.last_mut()
            && outer.otherwise
            && matches!(self.out.last(), Some((_, Tok::Else, _)))
        {
            outer.else_if = Some(Span { file: self.file, start: token.start, end: token.end });
        }
        open.push(Open { token, keyword: word, otherwise: false, arm: false, else_if: None, until: false });
        let (first, run, then, wanted) = match word {
            Keyword::If => (Tok::If, Run::If, Tok::Then, Keyword::Then),
            Keyword::Case => (Tok::Case, Run::Case, Tok::Of, Keyword::Of),
            Keyword::For => (Tok::For, Run::For, Tok::Do, Keyword::Do),
            Keyword::While => (Tok::While, Run::While, Tok::Do, Keyword::Do),
            _ => return self.take(Tok::Repeat),
        };
        self.take(first);
        self.run(run);
        self.wanted(then, wanted, token);
    }

    /// The keyword that ends the head of `statement`.
    fn wanted(&mut self, tok: Tok<'a>, wanted: Keyword, statement: RawToken) {
        if self.peek().and_then(|token| token.keyword) == Some(wanted) {
            return self.take(tok);
        }
        let word = wanted.word();
        let after = self.last_token().unwrap_or(statement);
        self.report(
            Diagnostic::new(
                Code::Syntax,
                self.span(after),
                format!("`{word}` is missing after the head of {}", self.slice(statement).to_uppercase()),
            )
            .label(format!("`{word}` expected after this"))
            .help(format!("write `{} {word}`", self.head_text(statement, after))),
        );
        self.push_here(tok);
    }

    /// A head or a section as written, on one line.
    fn head_text(&self, first: RawToken, last: RawToken) -> String {
        let text = self.text.get(first.start as usize..last.end as usize).unwrap_or_default();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    fn too_deep_statement(&mut self, token: RawToken) {
        self.report(
            Diagnostic::new(Code::Syntax, self.span(token), "statements are nested too deeply")
                .label(format!("inside {NESTING_MAX} others"))
                .help("move a part of them to a separate function"),
        );
        // Reading the rest of the block makes no sense.
        while let Some(token) = self.peek() {
            let ends = token
                .keyword
                .is_some_and(|word| word.ends_block() || word.begins_block() && self.block_begins(self.at));
            if ends {
                return;
            }
            self.at += 1;
        }
    }

    /// `VAR` after BEGIN; false: an ordinary word.
    fn section_in_code(&mut self, token: RawToken) -> bool {
        if token.keyword == Some(Keyword::Label)
            && !matches!(self.kind_at(self.at + 1), Some(RawKind::Word | RawKind::Quoted))
        {
            return false;
        }
        let first = self.at;
        while let Some(token) = self.peek() {
            if token.keyword.is_some_and(|word| word.ends_block() || word.begins_block() && self.block_begins(self.at))
            {
                break;
            }
            self.at += 1;
            if token.keyword.is_some_and(Keyword::ends_section) {
                break;
            }
        }
        let word = self.slice(token);
        let section = self.head_text(token, self.raw[self.at.max(first + 1) - 1]);
        let section = if section.len() > SECTION_MAX { format!("{word} …") } else { section };
        self.report(
            Diagnostic::new(
                Code::BlockFrame,
                self.span(token),
                format!("`{word}` is not allowed among the statements"),
            )
            .label("declarations must come before BEGIN")
            .help(format!("write `{section}` before BEGIN")),
        );
        true
    }

    /// A keyword that belongs to a statement that is not open.
    fn misplaced(&mut self, token: RawToken) {
        self.report(
            Diagnostic::new(
                Code::Syntax,
                self.span(token),
                format!("`{}` cannot begin a statement", self.slice(token)),
            )
            .label("not expected here")
            .help("remove it, or complete the statement before it"),
        );
        self.at += 1;
    }

    fn label_or_simple(&mut self, open: &mut [Open]) {
        let token = self.raw[self.at];
        let case = open.last_mut().filter(|statement| statement.keyword == Keyword::Case && !statement.otherwise);
        let name_colon = token.kind == RawKind::Word && self.kind_at(self.at + 1) == Some(RawKind::Colon);
        if let Some(case) = case {
            let label = name_colon && {
                let name = self.slice(token).to_uppercase();
                self.labels.contains(&name) && !self.constants.contains(&name)
            };
            if !label && self.arm_begins() {
                case.arm = true;
                let start = token.start as usize;
                self.push(start, Tok::Arm, start);
                self.run(Run::Arm);
                if self.is_at(RawKind::Colon) {
                    self.take(Tok::Colon);
                } else {
                    self.push_here(Tok::Colon);
                }
                return;
            }
        }
        if name_colon {
            let name = self.slice(token);
            self.push(token.start as usize, Tok::Label(name), token.end as usize);
            self.at += 2;
            return;
        }
        let (first, out, reported) = (self.at, self.out.len(), self.diagnostics.len());
        self.run(Run::Statement);
        let in_case = open.last().is_some_and(|statement| statement.keyword == Keyword::Case && !statement.otherwise);
        if in_case && reported == self.diagnostics.len() && self.value_without_colon(first) {
            return self.out.truncate(out);
        }
        self.end_of_statement();
    }

    /// The `;` of a simple statement. It may be omitted before a word that closes a statement.
    fn end_of_statement(&mut self) {
        let token = self.peek();
        if self.is_at(RawKind::Semicolon) {
            return self.take(Tok::End);
        }
        let closes =
            token.is_none_or(|token| token.keyword.is_some_and(|word| word.closes_statement() || word.ends_block()));
        let reported = self.last_token().is_none_or(|last| {
            // A whole statement of another language may end with `}` or a word.
            let given_up = last.kind == RawKind::Reported && last.first_on_line;
            given_up || self.diagnostics.last().is_some_and(|diagnostic| diagnostic.primary.span.start >= last.start)
        });
        // A bracket that is missing there was reported.
        let closed = matches!(self.out.last(), Some((start, Tok::RightParen | Tok::RightBracket, end)) if start == end);
        let complete = self.out.last().is_some_and(|(_, token, _)| {
            ends_operand(token) || matches!(token, Tok::Exit | Tok::Continue | Tok::Return)
        });
        if !closes && !reported && !closed && complete {
            let last = self.last_token().expect("a statement has been read");
            let text = self.slice(last);
            self.report(
                Diagnostic::new(Code::Syntax, self.span(last), format!("`;` is missing after `{text}`"))
                    .label("the statement ends here")
                    .help("end each statement with `;`"),
            );
        }
        self.push_here(Tok::End);
    }
}
