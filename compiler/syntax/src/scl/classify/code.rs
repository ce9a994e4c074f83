//! Classifies the words of statements: where each ends, and what closes each structured statement.

use plcc_diag::{Code, Diagnostic, Span};

use super::Classifier;
use super::expression::{Run, ends_operand};
use crate::front::NESTING_MAX;
use crate::front::pragma::is_for_file;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};
use crate::scl::token::Tok;

/// How many tokens the values of an arm of CASE may have.
const ARM_TOKENS_MAX: usize = 500;

/// How many tokens a condition may have that is found by looking ahead.
const CONDITION_TOKENS_MAX: usize = 200;

/// Statements that are opened and not closed in a block, less those that are closed and not opened: IF, CASE, FOR, WHILE, REPEAT.
type Unclosed = [i32; 5];

/// A section that is longer than this is not shown in a help.
const SECTION_MAX: usize = 80;

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

    /// What the rest of the block leaves unclosed.
    fn unclosed(&self) -> Unclosed {
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

    /// `WHILE condition;` before END_REPEAT, as other languages end this loop. It is reported.
    fn is_condition_of_repeat(&mut self, token: RawToken, open: &[Open]) -> bool {
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

    fn closing_keyword(&mut self, word: Keyword, token: RawToken, open: &mut Vec<Open>, unclosed: &mut Unclosed) {
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
        let Some(index) = open.iter().rposition(fits) else { return self.nothing_to_close(word, token) };
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
    fn unclosed_statement(&mut self, statement: Open) {
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
            Diagnostic::new(Code::BlockFrame, self.span(token), format!("`{word}` cannot stand among the statements"))
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

    /// Numbers alone on a line, from token `first` on: the values of an arm of CASE, without their `:`.
    fn value_without_colon(&mut self, first: usize) -> bool {
        let values = self.raw.get(first..self.at).unwrap_or_default();
        let (Some(&start), Some(&end)) = (values.first(), values.last()) else { return false };
        let is_value = |token: &RawToken| matches!(token.kind, RawKind::Number | RawKind::Minus | RawKind::DotDot);
        let alone = self.peek().is_some_and(|next| next.first_on_line && next.kind != RawKind::Semicolon);
        if !alone || end.kind != RawKind::Number || !values.iter().all(is_value) {
            return false;
        }
        let text = self.head_text(start, end);
        let span = Span { file: self.file, start: start.start, end: end.end };
        self.report(
            Diagnostic::new(Code::Syntax, span, format!("`:` is missing after `{text}`"))
                .label("a value of this CASE")
                .help(format!("write `{text}:`")),
        );
        true
    }

    /// Whether values and `:` follow rather than a statement.
    fn arm_begins(&self) -> bool {
        let mut depth = 0usize;
        for (index, token) in self.raw[self.at..].iter().take(ARM_TOKENS_MAX).enumerate() {
            match token.kind {
                RawKind::Colon => return depth == 0,
                RawKind::LeftParen | RawKind::LeftBracket => depth += 1,
                RawKind::RightParen | RawKind::RightBracket => depth = depth.saturating_sub(1),
                RawKind::Semicolon => return false,
                RawKind::Assign
                | RawKind::AddAssign
                | RawKind::SubtractAssign
                | RawKind::MultiplyAssign
                | RawKind::DivideAssign
                | RawKind::AttemptAssign
                    if depth == 0 =>
                {
                    return false;
                }
                _ if index > 0 && token.keyword.is_some_and(Keyword::ends_expression) => return false,
                _ => {}
            }
        }
        false
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
        let complete = self.out.last().is_some_and(|(_, token, _)| {
            ends_operand(token) || matches!(token, Tok::Exit | Tok::Continue | Tok::Return)
        });
        if !closes && !reported && complete {
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
