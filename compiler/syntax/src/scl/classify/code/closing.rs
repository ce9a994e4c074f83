//! What closes a structured statement: ELSE, ELSIF, UNTIL, END_IF and so on, and what is wrong with them.

use plcc_diag::{Code, Diagnostic, Span};

use super::super::Classifier;
use super::super::expression::Run;
use super::Open;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};
use crate::scl::token::Tok;

/// How many tokens a condition may have that is found by looking ahead.
const CONDITION_TOKENS_MAX: usize = 200;

/// Statements that are opened and not closed in a block, less those that are closed and not opened: IF, CASE, FOR, WHILE, REPEAT.
type Unclosed = [i32; 5];

impl<'a> Classifier<'a, '_> {
    /// A word that ends a structured statement or a part of one.
    pub(super) fn closing_keyword(
        &mut self,
        word: Keyword,
        token: RawToken,
        open: &mut Vec<Open>,
        unclosed: &mut Unclosed,
    ) {
        let word = self.misnamed_end(word, token, open, unclosed).unwrap_or(word);
        let fits = |statement: &Open| match word {
            Keyword::Else => matches!(statement.keyword, Keyword::If | Keyword::Case) && !statement.otherwise,
            Keyword::Elsif | Keyword::ElseIf => statement.keyword == Keyword::If && !statement.otherwise,
            Keyword::Until => statement.keyword == Keyword::Repeat && !statement.until,
            Keyword::EndIf => statement.keyword == Keyword::If,
            Keyword::EndCase => statement.keyword == Keyword::Case,
            Keyword::EndFor => statement.keyword == Keyword::For,
            Keyword::EndWhile => statement.keyword == Keyword::While,
            _ => statement.keyword == Keyword::Repeat,
        };
        let Some(index) = open.iter().rposition(fits) else {
            let has_condition = self.raw.get(self.at + 1).is_some_and(|next| next.kind != RawKind::Semicolon);
            let begins = matches!(word, Keyword::Elsif | Keyword::ElseIf)
                && has_condition
                && !open.iter().any(|statement| statement.keyword == Keyword::If);
            return match begins {
                true => self.if_without_beginning(token, open),
                false => self.nothing_to_close(word, token),
            };
        };
        while open.len() > index + 1 {
            let statement = open.pop().expect("longer than the index");
            self.unclosed_statement(statement);
        }
        let statement = &mut open[index];
        match word {
            Keyword::Else if statement.keyword == Keyword::If && self.is_else_with_condition() => {
                self.report(
                    Diagnostic::new(Code::Syntax, self.span(token), "ELSE has no condition")
                        .label("read as `ELSIF`")
                        .help("write `ELSIF` for another condition"),
                );
                self.take(Tok::Elsif);
                self.run(Run::If);
                self.wanted(Tok::Then, Keyword::Then, token);
            }
            Keyword::Else => {
                statement.otherwise = true;
                let case = statement.keyword == Keyword::Case;
                self.take(Tok::Else);
                if case && self.is_at(RawKind::Colon) {
                    self.at += 1;
                }
            }
            Keyword::Elsif | Keyword::ElseIf => {
                if word == Keyword::ElseIf {
                    self.report(
                        Diagnostic::new(
                            Code::Syntax,
                            self.span(token),
                            format!("SCL does not have the word `{}`", self.slice(token)),
                        )
                        .label("read as ELSIF")
                        .help("write `ELSIF`"),
                    );
                }
                self.take(Tok::Elsif);
                self.run(Run::If);
                self.wanted(Tok::Then, Keyword::Then, token);
            }
            Keyword::Until => {
                statement.until = true;
                self.take(Tok::Until);
                self.run(Run::Until);
                self.do_after_until(token);
                if self.is_at(RawKind::Semicolon) {
                    self.take(Tok::End);
                } else {
                    self.push_here(Tok::End);
                }
                let opening = statement.token;
                let end = self.peek().and_then(|token| Some((token, token.keyword?)));
                let end = end.map(|(token, word)| self.misnamed_end(word, token, open, unclosed).unwrap_or(word));
                if end == Some(Keyword::EndRepeat) {
                    self.closed(token, Tok::EndRepeat);
                } else {
                    self.report_unclosed(opening, Keyword::Repeat, None);
                    self.push_here(Tok::EndRepeat);
                }
                open.pop();
            }
            _ => {
                let statement = open.pop().expect("it was found");
                let tok = match word {
                    Keyword::EndIf => Tok::EndIf,
                    Keyword::EndCase => Tok::EndCase,
                    Keyword::EndFor => Tok::EndFor,
                    Keyword::EndWhile => Tok::EndWhile,
                    _ => {
                        self.report(
                            Diagnostic::new(
                                Code::Syntax,
                                self.span(statement.token),
                                "the condition of this loop is missing",
                            )
                            .label("ends without UNTIL")
                            .help("write `UNTIL condition` before END_REPEAT"),
                        );
                        self.push_here(Tok::Until);
                        self.push_here(Tok::Bad);
                        self.push_here(Tok::End);
                        Tok::EndRepeat
                    }
                };
                self.closed(token, tok);
            }
        }
    }

    /// `ELSE a = 2 THEN`: THEN follows before anything that a condition does not have.
    fn is_else_with_condition(&self) -> bool {
        let ahead = self.raw.get(self.at + 1..).unwrap_or_default();
        let end = ahead.iter().take(CONDITION_TOKENS_MAX).position(|token| {
            matches!(token.kind, RawKind::Semicolon | RawKind::Assign)
                || token.keyword.is_some_and(|word| {
                    word == Keyword::Then || word.begins_statement() || word.closes_statement() || word.ends_block()
                })
        });
        end.is_some_and(|end| end > 0 && ahead[end].keyword == Some(Keyword::Then))
    }

    /// `WHILE condition;` before END_REPEAT, as other languages end this loop. It is reported.
    pub(super) fn is_condition_of_repeat(&mut self, token: RawToken, open: &[Open]) -> bool {
        if open.last().is_none_or(|statement| statement.keyword != Keyword::Repeat || statement.until) {
            return false;
        }
        let first = self.at + 1;
        let ahead = self.raw.get(first..).unwrap_or_default();
        let end = ahead.iter().take(CONDITION_TOKENS_MAX).position(|token| {
            token.kind == RawKind::Semicolon
                || token.keyword.is_some_and(|word| word.begins_statement() || word.closes_statement())
                || matches!(token.keyword, Some(Keyword::Do | Keyword::Then))
        });
        let Some(end) = end.map(|end| first + end).filter(|&end| {
            end > first
                && self.kind_at(end) == Some(RawKind::Semicolon)
                && self.keyword_at(end + 1) == Some(Keyword::EndRepeat)
        }) else {
            return false;
        };
        let condition = self.head_text(self.raw[first], self.raw[end - 1]);
        self.report(
            Diagnostic::new(
                Code::ForeignForm,
                self.span(token),
                "REPEAT ends with UNTIL and the condition for its end",
            )
            .label("read as `UNTIL`")
            .help(format!("write `UNTIL NOT ({condition})`")),
        );
        true
    }

    /// `UNTIL condition DO`, as in the head of the other loops.
    fn do_after_until(&mut self, until: RawToken) {
        let Some(token) = self.peek().filter(|token| token.keyword == Some(Keyword::Do)) else { return };
        let last = self.last_token().unwrap_or(until);
        self.report(
            Diagnostic::new(
                Code::Syntax,
                self.span(token),
                format!("`{}` does not follow the condition of UNTIL", self.slice(token)),
            )
            .label("belongs to FOR and WHILE")
            .help(format!("write `{}`", self.head_text(until, last))),
        );
        self.at += 1;
    }

    /// Takes the word that ends a structured statement, with its `;`.
    fn closed(&mut self, _token: RawToken, tok: Tok<'a>) {
        let word = self.raw[self.at];
        // The word that is meant, where another one is written.
        let meant = match &tok {
            Tok::EndIf => Keyword::EndIf,
            Tok::EndCase => Keyword::EndCase,
            Tok::EndFor => Keyword::EndFor,
            Tok::EndWhile => Keyword::EndWhile,
            _ => Keyword::EndRepeat,
        };
        self.take(tok);
        if self.is_at(RawKind::Semicolon) {
            self.at += 1;
        } else if self.peek().is_some() && !self.iec && self.slice(word) != "}" {
            let text = self.slice(word);
            self.tolerate(
                self.span(word),
                &format!("`;` is missing after `{text}`"),
                "STEP 7 requires `;` here",
                &format!("write `{};`", if text.eq_ignore_ascii_case(meant.word()) { text } else { meant.word() }),
            );
        }
    }

    /// ELSIF where no IF is open: it begins one, so that its END_IF closes something.
    fn if_without_beginning(&mut self, token: RawToken, open: &mut Vec<Open>) {
        let text = self.slice(token);
        self.report(
            Diagnostic::new(Code::Syntax, self.span(token), format!("`{text}` has no matching IF"))
                .label("read as `IF`")
                .help("write `IF`"),
        );
        self.structured(Keyword::If, token, open);
    }

    fn nothing_to_close(&mut self, word: Keyword, token: RawToken) {
        let text = self.slice(token);
        let opener = match word {
            Keyword::EndCase => "CASE",
            Keyword::EndFor => "FOR",
            Keyword::EndWhile => "WHILE",
            Keyword::EndRepeat | Keyword::Until => "REPEAT",
            Keyword::Else => "IF or CASE",
            _ => "IF",
        };
        self.report(
            Diagnostic::new(Code::Syntax, self.span(token), format!("`{text}` has no matching {opener}"))
                .label("it belongs to nothing that is open")
                .help("remove it, or write the beginning of its statement"),
        );
        self.at += 1;
        match word {
            Keyword::Elsif | Keyword::ElseIf | Keyword::Until => {
                // The missing condition was reported with it.
                let first = self.out.len();
                self.run(if word == Keyword::Until { Run::Until } else { Run::If });
                self.out.truncate(first);
                if self.keyword_at(self.at) == Some(Keyword::Then) || self.is_at(RawKind::Semicolon) {
                    self.at += 1;
                }
            }
            _ => {
                if self.is_at(RawKind::Semicolon) {
                    self.at += 1;
                }
            }
        }
    }

    /// Reports and closes a structured statement.
    pub(super) fn unclosed_statement(&mut self, statement: Open) {
        self.report_unclosed(statement.token, statement.keyword, statement.else_if);
        match statement.keyword {
            Keyword::If => self.push_here(Tok::EndIf),
            Keyword::Case => self.push_here(Tok::EndCase),
            Keyword::For => self.push_here(Tok::EndFor),
            Keyword::While => self.push_here(Tok::EndWhile),
            _ => {
                self.push_here(Tok::Until);
                self.push_here(Tok::Bad);
                self.push_here(Tok::End);
                self.push_here(Tok::EndRepeat);
            }
        }
    }

    fn report_unclosed(&mut self, opening: RawToken, keyword: Keyword, else_if: Option<Span>) {
        let end = match keyword {
            Keyword::If => "END_IF",
            Keyword::Case => "END_CASE",
            Keyword::For => "END_FOR",
            Keyword::While => "END_WHILE",
            _ => "END_REPEAT",
        };
        let mut diagnostic = Diagnostic::new(Code::Syntax, self.span(opening), format!("`{end}` is missing"))
            .label(format!("this {} is not closed", keyword.word()));
        diagnostic = match else_if {
            Some(span) => diagnostic
                .also(span, "`ELSE IF` opens a second IF")
                .help("write `ELSIF` for another condition; `ELSE IF` needs a separate `END_IF`"),
            None => diagnostic.help(format!("write `{end};` after its last statement")),
        };
        self.report(diagnostic);
    }

    /// What the rest of the block leaves unclosed.
    pub(super) fn unclosed(&self) -> Unclosed {
        let mut unclosed = [0; 5];
        for (index, token) in self.raw.iter().enumerate().skip(self.at) {
            match token.keyword {
                Some(word) if word.ends_block() || word.begins_block() && self.block_begins(index) => break,
                Some(word) => {
                    if let Some((kind, opens)) = structure(word) {
                        unclosed[kind] += if opens { 1 } else { -1 };
                    }
                }
                None => {}
            }
        }
        unclosed
    }

    /// The end that `word` is meant as: the innermost statement has no end in this block, and nothing in the block needs this one.
    fn misnamed_end(
        &mut self,
        word: Keyword,
        token: RawToken,
        open: &[Open],
        unclosed: &mut Unclosed,
    ) -> Option<Keyword> {
        let (written, false) = structure(word)? else { return None };
        let innermost = open.last()?;
        let (kind, _) = structure(innermost.keyword)?;
        if kind == written || unclosed[kind] <= 0 || unclosed[written] >= 0 {
            return None;
        }
        unclosed[kind] -= 1;
        unclosed[written] += 1;
        let meant = match innermost.keyword {
            Keyword::If => Keyword::EndIf,
            Keyword::Case => Keyword::EndCase,
            Keyword::For => Keyword::EndFor,
            Keyword::While => Keyword::EndWhile,
            _ => Keyword::EndRepeat,
        };
        let (text, opener) = (self.slice(token), innermost.keyword.word());
        self.report(
            Diagnostic::new(Code::Syntax, self.span(token), format!("`{text}` cannot end {opener}"))
                .label(format!("read as `{}`", meant.word()))
                .also(self.span(innermost.token), format!("this {opener} is open here"))
                .help(format!("write `{};`", meant.word())),
        );
        Some(meant)
    }
}

/// The kind of structured statement of a word, and whether the word opens it; else it closes it.
fn structure(word: Keyword) -> Option<(usize, bool)> {
    Some(match word {
        Keyword::If => (0, true),
        Keyword::Case => (1, true),
        Keyword::For => (2, true),
        Keyword::While => (3, true),
        Keyword::Repeat => (4, true),
        Keyword::EndIf => (0, false),
        Keyword::EndCase => (1, false),
        Keyword::EndFor => (2, false),
        Keyword::EndWhile => (3, false),
        Keyword::EndRepeat => (4, false),
        _ => return None,
    })
}
