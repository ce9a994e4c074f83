//! Classifies the words of charts: raw tokens to the tokens of the grammar.
//!
//! ```text
//! chart ──► permanent instructions ──► rows ───────────────┐
//!   ├─────► step ──► interlock, supervision ──► condition  ├──► expressions
//!   │            └─► actions                    row.rs ────┤    expression.rs
//!   └─────► transition ──► FROM, TO, CONDITION ────────────┘
//! ```
//!
//! Only its line ends an action or a permanent instruction, so this pass finds the ends. It closes parts and brackets that the
//! source left open: the grammar always sees a balanced chart, and one mistake remains one message.

mod expression;
mod keyword;
mod names;
mod row;

use plcc_diag::{Code, Diagnostic, FileId};

use keyword::german;
pub use keyword::{Keyword, at as keyword_at, join_words, misspelt};

use super::lexer::{RawKind, RawToken};
use super::pragma::{self, Tag};
use super::token::Tok;
use plcc_syntax::front::{Classified, Cursor, frame_words};

/// Classifies the tokens of a chart: the whole block except its head and declarations.
pub fn classify<'a>(file: FileId, text: &'a str, raw: &[RawToken]) -> Classified<Tok<'a>> {
    let mut classifier = Classifier { cursor: Cursor::new(file, text, raw, &[]), spaced: Vec::new() };
    classifier.chart();
    classifier.cursor.finish()
}

struct Classifier<'a, 'r> {
    cursor: Cursor<'a, 'r, RawKind, (), Tok<'a>>,
    /// Names of steps that are written with blanks.
    spaced: Vec<&'a str>,
}

plcc_syntax::moves_cursor!(Classifier, RawKind, (), Tok);

impl<'a> Classifier<'a, '_> {
    fn chart(&mut self) {
        while let Some(token) = self.peek() {
            match self.keyword_at(self.at) {
                _ if token.kind == RawKind::Semicolon => self.at += 1,
                _ if token.kind == RawKind::Pragma => self.pragma(token),
                Some(Keyword::PermanentBegin) => self.permanents(token, false),
                Some(Keyword::PermanentEnd) => self.permanents(token, true),
                Some(Keyword::InitialStep) => self.step(token, true),
                Some(Keyword::Step) => self.step(token, false),
                Some(Keyword::Transition) => self.transition(token),
                Some(Keyword::Sequence) => self.sequence(),
                Some(Keyword::EndSequence) => self.at += 1,
                _ if self.part_without_keyword(token) => {}
                _ => self.outside_of_parts(token),
            }
        }
    }

    /// `Done (*$_NUM 2*)` up to END_TRANSITION, or up to END_STEP: the first word of the part is missing.
    fn part_without_keyword(&mut self, name: RawToken) -> bool {
        const PART_MAX: usize = 2000;
        let next = self.raw.get(self.at + 1).filter(|next| !next.first_on_line);
        let is_head = next.is_some_and(|next| matches!(next.kind, RawKind::Pragma | RawKind::Colon));
        // A keyword that begins no part here, such as `END_VAR`, is not a name.
        if !is_head || !is_name(name.kind) || !name.first_on_line || self.keyword_at(self.at).is_some() {
            return false;
        }
        let mut rest = (self.at + 1..self.raw.len()).take(PART_MAX);
        let end = rest.find_map(|index| self.keyword_at(index).filter(|word| word.ends_part()));
        let transition = match end {
            Some(Keyword::EndTransition) => true,
            Some(Keyword::EndStep) => false,
            _ => return false,
        };
        // The first step of a chart that has no other initial one.
        let initial = !transition
            && !self.out.iter().any(|(_, token, _)| matches!(token, Tok::Step(_)))
            && !(self.at..self.raw.len()).any(|index| self.keyword_at(index) == Some(Keyword::InitialStep));
        let keyword = match (transition, initial) {
            (true, _) => Keyword::Transition,
            (false, true) => Keyword::InitialStep,
            (false, false) => Keyword::Step,
        };
        let (word, text) = (keyword.word(), self.slice(name));
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(name), format!("`{word}` is missing before `{text}`"))
                .label("a part of the chart begins here")
                .help(format!("write `{word} {text}`")),
        );
        let start = name.start as usize;
        if transition {
            self.push(start, Tok::Transition, start);
            self.rest_of_transition(name);
        } else {
            self.push(start, Tok::Step(initial), start);
            self.rest_of_step(name);
        }
        true
    }

    /// Brackets of a sequence have no meaning.
    fn sequence(&mut self) {
        self.at += 1;
        while let Some(token) = self.peek() {
            if (token.first_on_line || self.keyword_at(self.at).is_some()) && !self.is_number(token) {
                return;
            }
            self.at += 1;
        }
    }

    /// Settings and comments of the block.
    fn pragma(&mut self, token: RawToken) {
        let slice = self.slice(token);
        match pragma::tag(slice) {
            Some(Tag::Settings) => self.take(Tok::Settings(pragma::body(slice))),
            Some(Tag::Comment) => self.take(Tok::Comment(pragma::body(slice))),
            Some(Tag::Number | Tag::Jump) | None => self.at += 1,
        }
    }

    fn outside_of_parts(&mut self, token: RawToken) {
        let word = self.slice(token);
        let diagnostic = match self.keyword_at(self.at) {
            Some(keyword) if keyword.is_end() => {
                Diagnostic::new(Code::BlockFrame, self.span(token), format!("`{word}` ends nothing"))
                    .label("no part of the chart is open here")
                    .help("remove it, or write the beginning of the part that it ends")
            }
            _ => Diagnostic::new(
                Code::BlockFrame,
                self.span(token),
                format!("`{word}` is not allowed outside the chart"),
            )
            .label("neither a step nor a transition is open here")
            .help("a GRAPH block contains permanent instructions, steps from `STEP` to `END_STEP`, then transitions"),
        };
        self.report(diagnostic);
        self.at += 1;
        self.skip_to_keyword();
    }

    /// Advances to the next token that begins or ends a part.
    fn skip_to_keyword(&mut self) {
        while let Some(token) = self.peek() {
            if self.keyword_at(self.at).is_some() || token.kind == RawKind::Pragma {
                return;
            }
            self.at += 1;
        }
    }

    // Parts.

    fn permanents(&mut self, opening: RawToken, after: bool) {
        self.take(Tok::Permanents(after));
        while let Some(token) = self.peek() {
            match self.keyword_at(self.at) {
                _ if matches!(token.kind, RawKind::Semicolon | RawKind::Pragma) => self.at += 1,
                Some(keyword) if keyword.ends_part() => break,
                _ => self.permanent_row(),
            }
        }
        self.end(opening, Keyword::EndPermanent);
    }

    fn step(&mut self, opening: RawToken, initial: bool) {
        self.take(Tok::Step(initial));
        self.rest_of_step(opening);
    }

    /// A step from its name on.
    fn rest_of_step(&mut self, opening: RawToken) {
        self.head(opening, "step");
        while let Some(token) = self.peek() {
            match self.keyword_at(self.at) {
                _ if token.kind == RawKind::Semicolon => self.at += 1,
                _ if token.kind == RawKind::Pragma => self.pragma_of_part(token),
                Some(Keyword::Interlock) => self.section(Tok::Interlock, Keyword::EndInterlock),
                Some(Keyword::Supervision) => self.section(Tok::Supervision, Keyword::EndSupervision),
                Some(keyword) if keyword.ends_part() => break,
                _ => self.action_row(),
            }
        }
        self.end(opening, Keyword::EndStep);
    }

    fn transition(&mut self, opening: RawToken) {
        self.take(Tok::Transition);
        self.rest_of_transition(opening);
    }

    /// A transition from its name on.
    fn rest_of_transition(&mut self, opening: RawToken) {
        self.head(opening, "transition");
        while let Some(token) = self.peek() {
            match self.keyword_at(self.at) {
                _ if matches!(token.kind, RawKind::Semicolon | RawKind::Colon) => self.at += 1,
                _ if token.kind == RawKind::Pragma => self.pragma_of_part(token),
                Some(Keyword::Condition) => self.condition(),
                Some(keyword) if keyword.ends_part() => break,
                _ if self.is_word(self.at, "FROM") => self.steps(Tok::From),
                _ if self.is_word(self.at, "TO") => self.steps(Tok::To),
                _ if self.is_misspelt_condition(token) => {
                    self.report(frame_words::misspelt(self.span(token), self.slice(token), Keyword::Condition.word()));
                    self.condition();
                }
                _ if self.is_word(self.at, "JUMP")
                    && self.raw.get(self.at + 1).is_some_and(|next| is_name(next.kind)) =>
                {
                    let step = self.slice(self.raw[self.at + 1]);
                    let help = format!("write `TO {step} (*$_JUMP*)`");
                    self.foreign(token, "a transition leads to a step with `TO`", &help);
                    self.steps(Tok::To);
                    self.push_here(Tok::Jump);
                }
                _ if let Some((meant, tok)) = self.german_clause(token) => {
                    self.report(frame_words::misspelt(self.span(token), self.slice(token), meant));
                    self.steps(tok);
                }
                _ => self.outside_of_clauses(token),
            }
        }
        self.end(opening, Keyword::EndTransition);
    }

    /// `VON Step`, `NACH Step`
    fn german_clause(&self, token: RawToken) -> Option<(&'static str, Tok<'static>)> {
        let named = self.raw.get(self.at + 1).is_some_and(|next| is_name(next.kind) && !next.first_on_line);
        if !named || token.kind != RawKind::Word {
            return None;
        }
        match german(self.slice(token))? {
            "FROM" => Some(("FROM", Tok::From)),
            "TO" => Some(("TO", Tok::To)),
            _ => None,
        }
    }

    /// Name, number and colon.
    fn head(&mut self, opening: RawToken, what: &str) {
        match self.peek() {
            Some(token) if is_name(token.kind) && !self.begins_part(self.at) && !self.begins_clause(token) => {
                self.defined_name(token, what);
            }
            _ => {
                let word = self.slice(opening);
                let number = self.peek().filter(|next| self.is_number(*next));
                let number = number.map_or("(*$_NUM …*)", |next| self.slice(next));
                self.report(
                    Diagnostic::new(Code::Syntax, self.span(opening), format!("no name of a {what} follows `{word}`"))
                        .label("the name is missing")
                        .help(format!("write `{word} Name {number}`")),
                );
                self.push_here(Tok::Word(""));
            }
        }
        if let Some(token) = self.peek()
            && self.is_number(token)
        {
            let body = pragma::body(self.slice(token)).trim();
            match body.parse() {
                Ok(number) if number > 0 => self.take(Tok::Number(number)),
                _ => {
                    self.report(
                        Diagnostic::new(
                            Code::BadLiteral,
                            self.span(token),
                            format!("`{body}` is not the number of a {what}"),
                        )
                        .label("a whole number from 1 to 999 is expected here")
                        .help("write e.g. `(*$_NUM 3*)`"),
                    );
                    self.take(Tok::Number(0));
                }
            }
        }
        if self.is_at(RawKind::Colon) {
            self.at += 1;
        }
    }

    /// Takes the name of a step or transition.
    fn step_name(&mut self, token: RawToken) {
        let slice = self.slice(token);
        let name = match token.kind {
            RawKind::Quoted => Tok::Quoted(slice.trim_matches('"').trim()),
            _ => Tok::Word(slice),
        };
        self.take(name);
    }

    /// Comments of a step or transition; other pragmas have no meaning here.
    fn pragma_of_part(&mut self, token: RawToken) {
        let slice = self.slice(token);
        match pragma::tag(slice) {
            Some(Tag::Comment) => self.take(Tok::Comment(pragma::body(slice))),
            _ => self.at += 1,
        }
    }

    /// `INTERLOCK CONDITION := … END_INTERLOCK`
    fn section(&mut self, tok: Tok<'a>, end: Keyword) {
        let opening = self.raw[self.at];
        self.take(tok);
        let mut has_condition = false;
        while let Some(token) = self.peek() {
            match self.keyword_at(self.at) {
                _ if matches!(token.kind, RawKind::Semicolon | RawKind::Pragma) => self.at += 1,
                Some(Keyword::Condition) => {
                    self.condition();
                    has_condition = true;
                }
                Some(_) => break,
                // An action of the step follows.
                None if has_condition && token.first_on_line => break,
                None => {
                    let word = self.slice(opening);
                    self.report(
                        Diagnostic::new(
                            Code::Syntax,
                            self.span(token),
                            format!("`{word}` begins without `CONDITION :=`"),
                        )
                        .label("`CONDITION :=` is expected here")
                        .help(format!("write `{word}`, then `CONDITION := …`, then `{}`", end.word())),
                    );
                    self.skip_to_keyword();
                }
            }
        }
        self.end(opening, end);
    }

    /// What to write for a condition whose line begins with the current token, or after its `=` or `:`.
    fn condition_help(&self) -> String {
        let from = self
            .raw
            .get(self.at)
            .filter(|token| matches!(token.kind, RawKind::Equal | RawKind::Colon))
            .map_or(self.at, |_| self.at + 1);
        let line =
            self.raw.get(from).map_or("", |token| self.text[token.start as usize..].lines().next().unwrap_or(""));
        match line.trim() {
            "" => "write `CONDITION := …`".to_string(),
            line => format!("write `CONDITION := {line}`"),
        }
    }

    /// `CONDITION := …`, up to the end of its part.
    fn condition(&mut self) {
        let word = self.raw[self.at];
        self.take(Tok::Condition);
        if self.is_at(RawKind::Assign) {
            self.at += 1;
        } else if let Some(sign) = self.peek().filter(|sign| matches!(sign.kind, RawKind::Equal | RawKind::Colon)) {
            self.report(
                Diagnostic::new(Code::AssignSign, self.span(sign), "a condition is written with `:=`")
                    .label(if sign.kind == RawKind::Equal { "`=` compares" } else { "only a part of the sign" })
                    .help(self.condition_help()),
            );
            self.at += 1;
        } else if self.peek().is_some_and(|token| token.kind != RawKind::Semicolon)
            && self.keyword_at(self.at).is_none()
        {
            self.report(
                Diagnostic::new(Code::Syntax, self.span(word), "`:=` is missing after `CONDITION`")
                    .label("the condition follows without `:=`")
                    .help(self.condition_help()),
            );
        }
        let first = self.at;
        let end = (first..self.raw.len()).find(|index| {
            matches!(self.raw[*index].kind, RawKind::Semicolon | RawKind::Pragma)
                || self.keyword_at(*index).is_some()
                || *index > first && self.begins_action(*index)
        });
        self.expression(end.unwrap_or(self.raw.len()), expression::Place::Condition);
        self.push_here(Tok::RowEnd);
    }

    /// `FROM x`, `FROM ( x, y)`, `TO (x, y) :`, `TO x (*$_JUMP*)`, with the colon before or after the mark.
    fn steps(&mut self, tok: Tok<'a>) {
        self.take(tok);
        let open = self.peek().filter(|token| token.kind == RawKind::LeftParen);
        self.at += usize::from(open.is_some());
        let mut closed = open.is_none();
        let mut named = false;
        while let Some(token) = self.peek() {
            let clause = token.first_on_line && (self.is_word(self.at, "TO") || self.is_word(self.at, "FROM"));
            if clause || self.keyword_at(self.at).is_some() {
                break;
            }
            match token.kind {
                RawKind::RightParen if !closed => {
                    closed = true;
                    named = true;
                    self.at += 1;
                }
                RawKind::Colon if self.is_jump(self.at + 1) => self.at += 1,
                RawKind::Semicolon if !closed => {
                    self.foreign(token, "the steps of a list are separated by `,`", "write `,`");
                    named = false;
                    self.take(Tok::Comma);
                }
                RawKind::Colon | RawKind::Semicolon => break,
                RawKind::Pragma if self.is_jump(self.at) => {
                    self.take(Tok::Jump);
                    named = true;
                }
                RawKind::Pragma => break,
                RawKind::Comma => {
                    named = false;
                    self.take(Tok::Comma);
                }
                kind if is_name(kind) => {
                    // `TO` after a list on the same line begins the next one.
                    if named && closed {
                        break;
                    }
                    named = true;
                    self.used_name(token);
                }
                _ => self.take(Tok::Bad),
            }
        }
        if let Some(opening) = open.filter(|_| !closed) {
            self.unclosed(opening);
        }
        self.push_here(Tok::RowEnd);
    }

    fn is_jump(&self, index: usize) -> bool {
        self.raw
            .get(index)
            .is_some_and(|token| token.kind == RawKind::Pragma && pragma::tag(self.slice(*token)) == Some(Tag::Jump))
    }

    /// `CONDITON := …`
    fn is_misspelt_condition(&self, token: RawToken) -> bool {
        let assigned = matches!(self.kind_at(self.at + 1), Some(RawKind::Assign | RawKind::Equal));
        assigned
            && token.kind == RawKind::Word
            && frame_words::slip_of(self.slice(token), [Keyword::Condition.word()]).is_some()
    }

    /// Reports a habit of other languages.
    fn foreign(&mut self, token: RawToken, title: &str, help: &str) {
        let message = Diagnostic::new(Code::ForeignForm, self.span(token), title);
        self.report(message.label("a form of other languages").help(help));
    }

    fn outside_of_clauses(&mut self, token: RawToken) {
        let word = self.slice(token);
        self.report(
            Diagnostic::new(Code::Syntax, self.span(token), format!("a transition cannot contain `{word}`"))
                .label("not expected here")
                .help("a transition has `FROM steps`, `TO steps` and `CONDITION := …`"),
        );
        self.at += 1;
        while let Some(token) = self.peek() {
            let clause = token.first_on_line && (self.is_word(self.at, "FROM") || self.is_word(self.at, "TO"));
            if clause || self.keyword_at(self.at).is_some() || token.kind == RawKind::Pragma {
                return;
            }
            self.at += 1;
        }
    }

    /// Takes the end of a part; any other word is reported.
    fn end(&mut self, opening: RawToken, end: Keyword) {
        let found = self.keyword_at(self.at).filter(|keyword| keyword.is_end() && *keyword != Keyword::EndSequence);
        match found {
            Some(keyword) if keyword == end => return self.take(Tok::End),
            // The end of another kind of part that is not open is meant for this one.
            Some(_) if !matches!(end, Keyword::EndInterlock | Keyword::EndSupervision) || self.inner_end() => {
                let token = self.raw[self.at];
                let (word, open) = (self.slice(token), self.slice(opening));
                self.report(
                    Diagnostic::new(Code::BlockFrame, self.span(token), format!("`{word}` cannot end `{open}`"))
                        .label("the part ends here")
                        .also(self.span(opening), "begins here")
                        .help(format!("write `{}`", end.word())),
                );
                return self.take(Tok::End);
            }
            _ => {}
        }
        let open = self.slice(opening);
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(opening), format!("`{}` is missing", end.word()))
                .label(format!("this `{open}` is not closed"))
                .help(format!("write `{}` after it", end.word())),
        );
        self.push_here(Tok::End);
    }

    fn inner_end(&self) -> bool {
        matches!(self.keyword_at(self.at), Some(Keyword::EndInterlock | Keyword::EndSupervision))
    }

    // Raw tokens.

    fn is_word(&self, index: usize, word: &str) -> bool {
        self.raw
            .get(index)
            .is_some_and(|token| token.kind == RawKind::Word && self.slice(*token).eq_ignore_ascii_case(word))
    }

    fn keyword_at(&self, index: usize) -> Option<Keyword> {
        keyword::at(self.text, self.raw, index)
    }

    /// Whether a part begins at `index`.
    fn begins_part(&self, index: usize) -> bool {
        self.raw[index].first_on_line && self.keyword_at(index).is_some()
    }

    /// Whether the token is the number of a part, `(*$_NUM 1*)`.
    fn is_number(&self, token: RawToken) -> bool {
        token.kind == RawKind::Pragma && pragma::tag(self.slice(token)) == Some(Tag::Number)
    }

    /// Whether `FROM` or `TO` begins a line: then it is not a name.
    fn begins_clause(&self, token: RawToken) -> bool {
        token.first_on_line && (self.is_word(self.at, "FROM") || self.is_word(self.at, "TO"))
    }

    /// Pushes a token of no width after what has been read; before the first token of the chart if nothing has.
    fn push_here(&mut self, tok: Tok<'a>) {
        let end = match self.last_token() {
            Some(before) => before.end,
            None => self.raw.first().map_or(0, |token| token.start),
        } as usize;
        self.push(end, tok, end);
    }
}

/// Whether a step may have this name.
fn is_name(kind: RawKind) -> bool {
    matches!(kind, RawKind::Word | RawKind::Number | RawKind::Quoted)
}
