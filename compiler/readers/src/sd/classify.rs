//! Classifies the words of a network in LAD or FBD: raw tokens to the tokens of the grammar.
//!
//! Whether a word is an element, a pin, an operand or a label depends on where it is. This pass gives each word its meaning, joins the tokens of an
//! operand into one, and closes rungs and parentheses that the source left open.

mod signs;

use plcc_diag::{Code, Diagnostic, FileId};

use super::pragma::{self, Attribute};
use super::token::Tok;
use plcc_syntax::front::frame_words::slip_of;
use plcc_syntax::front::{Classified, Cursor};
use plcc_syntax::network::ast::Comparison;
use plcc_syntax::network::elements;
use plcc_syntax::scl::keyword::Keyword;
use plcc_syntax::scl::raw::{RawKind, RawToken};

/// Where statements go.
const STATEMENTS: &str =
    "write statements of SCL in a network of their own, with `{ S7_Language := \"SCL\" }` before it";

/// Classifies the tokens between `NETWORK` and `END_NETWORK`.
pub fn classify<'a>(file: FileId, text: &'a str, raw: &[RawToken]) -> Classified<Tok<'a>> {
    let mut classifier = Classifier { cursor: Cursor::new(file, text, raw, &[]) };
    classifier.network();
    classifier.cursor.finish()
}

struct Classifier<'a, 'r> {
    cursor: Cursor<'a, 'r, RawKind, Option<Keyword>, Tok<'a>>,
}

plcc_syntax::moves_cursor!(Classifier, RawKind, Option<Keyword>, Tok);

impl<'a> Classifier<'a, '_> {
    /// Labels and rungs.
    fn network(&mut self) {
        while let Some(token) = self.raw.get(self.at).copied() {
            if self.is_word("RUNG") {
                self.rung(token);
            } else if self.is_word("Label") && self.kind_at(self.at + 1) == Some(RawKind::LeftParen) {
                self.take(Tok::Label);
                self.arguments();
            } else {
                self.outside_of_rungs(token);
            }
        }
    }

    /// Skips tokens outside rungs.
    fn outside_of_rungs(&mut self, token: RawToken) {
        let diagnostic = if token.kind == RawKind::LeftBrace {
            Diagnostic::new(Code::Syntax, self.span(token), "attributes are not allowed between rungs")
                .label("belongs neither to an element nor to a network")
                .help("write attributes of a network directly before `NETWORK`, those of an element directly before it")
        } else if token.kind == RawKind::Semicolon {
            self.at += 1;
            return;
        } else if token.kind == RawKind::Number && self.at == 0 && !token.first_on_line {
            Diagnostic::new(Code::ForeignForm, self.span(token), "a network has no number")
                .label("a form of other languages")
                .help("write `NETWORK` alone; its title is in the attribute `S7_NetworkTitle` before it")
        } else {
            let text = &self.text[token.range()];
            let title = if self.is_word("END_RUNG") {
                "`END_RUNG` has no matching RUNG".to_owned()
            } else {
                format!("`{text}` is not allowed outside a rung")
            };
            let next = self.raw.get(self.at + 1).map_or("", |next| &self.text[next.range()]);
            let line = self.text[token.range().end..].lines().next().unwrap_or_default().trim();
            let help = match token.keyword {
                _ if text == "#" => format!("a comment begins with `//`: write `// {line}`"),
                _ if self.kind_at(self.at + 1) == Some(RawKind::Colon) => format!("write `Label( {text} )`"),
                _ if self.is_word("LABEL") => format!("write `Label( {next} )`"),
                Some(word) if word.begins_statement() => STATEMENTS.to_owned(),
                _ if self.operand_end().is_some_and(|after| self.kind_at(after) == Some(RawKind::Assign)) => {
                    STATEMENTS.to_owned()
                }
                _ => "a network of LAD or FBD contains rungs from `RUNG` to `END_RUNG`".to_owned(),
            };
            Diagnostic::new(Code::Syntax, self.span(token), title).label("no rung is open here").help(help)
        };
        self.report(diagnostic);
        self.at += 1;
        while self.at < self.raw.len() && !self.is_word("RUNG") && !self.is_word("Label") {
            self.at += 1;
        }
    }

    /// A rung from `RUNG` to its end.
    fn rung(&mut self, opening: RawToken) {
        let first = self.at;
        self.take(Tok::Rung);
        let mut separated = false;
        let mut has_open_list = false;
        while let Some(token) = self.raw.get(self.at).copied() {
            if self.is_word("RUNG") {
                break;
            } else if self.is_word("END_RUNG") {
                self.take(Tok::EndRung);
                if let Some(name) = self.wire() {
                    self.take_wire(Tok::Wire(name));
                } else if let Some(name) = self.bare_wire() {
                    self.take_bare_wire(name);
                }
                return;
            } else if let Some(name) = self.wire() {
                self.take_wire(Tok::Wire(name));
            } else if let Some(name) = self.spaced_wire() {
                self.take_spaced_wire(token, name);
            } else if token.kind == RawKind::LeftBrace {
                let is_open = pragma::end(self.raw, self.at).is_none();
                let (attributes, after) = self.attributes(self.at);
                // The rest of the line is in a list that is not closed, which is reported.
                self.take_up_to(if is_open { Tok::Stray } else { Tok::Pragma(attributes) }, after);
                has_open_list |= is_open;
            } else if self.is_word("NOT") && self.kind_at(self.at + 1) != Some(RawKind::LeftParen) {
                self.take(Tok::Not);
            } else if let Some(after) = self.operand_end() {
                match self.kind_at(after) {
                    Some(RawKind::Assign) => self.assignment(after),
                    _ => self.operand_or_element(after),
                }
            } else if matches!(token.kind, RawKind::Semicolon | RawKind::Comma) {
                if !std::mem::replace(&mut separated, true) {
                    let sign = &self.text[token.range()];
                    self.report(
                        Diagnostic::new(
                            Code::Syntax,
                            self.span(token),
                            format!("the elements of a rung are not separated by `{sign}`"),
                        )
                        .label("not needed")
                        .help(format!("remove each `{sign}` between elements and before `END_RUNG`")),
                    );
                }
                self.at += 1;
            } else if !self.sign_of_drawing(token) {
                self.take(Tok::Stray);
            }
        }
        if !has_open_list && !self.has_open_text(first) {
            self.report(
                Diagnostic::new(Code::Syntax, self.span(opening), "`END_RUNG` is missing")
                    .label("this rung is not closed")
                    .help("write `END_RUNG`, or `END_RUNG wire#w1`, after its last element"),
            );
        }
        self.push_here(Tok::EndRung);
    }

    /// Whether a name or a text since index `first` is not closed: the rest of its line is in it, which is reported.
    fn has_open_text(&self, first: usize) -> bool {
        let since = self.raw.get(first..self.at).unwrap_or_default();
        since.iter().any(|token| matches!(token.kind, RawKind::UnterminatedQuoted | RawKind::UnterminatedText))
    }

    /// `#q := #a` in a rung, up to its `;` or the next element. The operand ends before index `after`.
    fn assignment(&mut self, after: usize) {
        let text = |first: usize, after: usize| {
            self.text.get(self.raw[first].start as usize..self.raw[after - 1].end as usize).unwrap_or_default()
        };
        let target = text(self.at, after);
        let mut end = after + 1;
        while let Some(token) = self.raw.get(end) {
            let element = token.kind == RawKind::Word
                && self.kind_at(end + 1) == Some(RawKind::LeftParen)
                && elements::find_sd(&self.text[token.range()]).is_some();
            let ends = ["RUNG", "END_RUNG", "wire"].iter().any(|word| is_word(self.text, self.raw, end, word));
            if token.kind == RawKind::Semicolon || element || ends {
                break;
            }
            end += 1;
        }
        let value = if end > after + 1 { text(after + 1, end) } else { "…" };
        let value = if value.contains(char::is_whitespace) { "…" } else { value };
        let help = format!(
            "write `Contact( {value} ) Coil( {target} )` for a bit, `Move( in := {value}, out1 => {target} )` for a number"
        );
        let message = Diagnostic::new(Code::Syntax, self.span(self.raw[after]), "a rung has no assignments")
            .label("a statement of SCL")
            .help(help);
        self.report(message);
        if self.kind_at(end) == Some(RawKind::Semicolon) {
            end += 1;
        }
        self.take_up_to(Tok::Stray, end);
    }

    /// The name of the current wire, `wire#w1`, which is two raw tokens.
    fn wire(&self) -> Option<&'a str> {
        let next = self.raw.get(self.at + 1).copied()?;
        let adjacent = self.raw[self.at].end == next.start;
        let is_wire = self.is_word("wire") && next.kind == RawKind::Local && adjacent;
        is_wire.then(|| self.text[next.range()].trim_start_matches('#').trim_matches('"'))
    }

    /// Pushes `token` for the wire at the current token.
    fn take_wire(&mut self, token: Tok<'a>) {
        let after = self.at + 2;
        self.take_up_to(token, after);
    }

    /// An element with its pins, or an operand that begins a rung. The tokens of its name end before index `after`.
    fn operand_or_element(&mut self, after: usize) {
        match self.kind_at(after) {
            Some(RawKind::LeftParen) => self.take_up_to(Tok::Target, after),
            Some(RawKind::LeftBrace)
                if pragma::end(self.raw, after).is_some_and(|end| self.kind_at(end) == Some(RawKind::LeftParen)) =>
            {
                self.take_up_to(Tok::Target, after);
                let (attributes, end) = self.attributes(after);
                self.take_up_to(Tok::Inline(attributes), end);
            }
            _ => return self.take_up_to(Tok::Operand, after),
        }
        self.arguments();
    }

    /// `( pin := value, pin => value )`
    fn arguments(&mut self) {
        let (opening, first) = (self.raw[self.at], self.at);
        self.take(Tok::LeftParen);
        while let Some(token) = self.raw.get(self.at).copied() {
            match token.kind {
                RawKind::RightParen => return self.take(Tok::RightParen),
                RawKind::Comma => self.take(Tok::Comma),
                RawKind::Semicolon if self.at + 1 < self.raw.len() => {
                    self.foreign(token, "the pins of an element are separated by `,`", "write `,`");
                    self.take(Tok::Comma);
                }
                RawKind::Word
                    if self.kind_at(self.at + 1) == Some(RawKind::Equal)
                        && matches!(self.out.last(), Some((_, Tok::LeftParen | Tok::Comma, _))) =>
                {
                    self.compared_pin(token);
                }
                RawKind::Assign => self.take(Tok::Assign),
                RawKind::Arrow => self.take(Tok::Arrow),
                _ if self.is_word("RUNG") || self.is_word("END_RUNG") => break,
                RawKind::Word | RawKind::Quoted | RawKind::Local
                    if matches!(self.kind_at(self.at + 1), Some(RawKind::Assign | RawKind::Arrow)) =>
                {
                    if matches!(self.out.last(), Some((_, Tok::Value | Tok::Connected(_), _))) {
                        self.missing_comma(token);
                    }
                    self.take(Tok::Pin);
                }
                _ if self.is_word("NOT") => self.take(Tok::Negated),
                // The next element: this one is not closed.
                _ if self.is_next_element() => break,
                _ => self.value_of_pin(),
            }
        }
        if !self.has_open_text(first) {
            self.report(
                Diagnostic::new(Code::Syntax, self.span(opening), "`(` is not closed")
                    .label("opened here")
                    .help("write `)` after the last pin"),
            );
        }
        self.push_here(Tok::RightParen);
    }

    /// `in := #a out => #b`
    fn missing_comma(&mut self, token: RawToken) {
        let text = |token: RawToken| &self.text[token.range()];
        let (before, sign) = (text(self.raw[self.at - 1]), text(self.raw[self.at + 1]));
        let help = format!("write `{before}, {} {sign} …`", text(token));
        self.foreign(token, "the pins of an element are separated by `,`", &help);
        self.push_here(Tok::Comma);
    }

    /// Whether a pin begins directly after an operand, so that `,` is missing between them.
    fn is_next_pin(&self) -> bool {
        let before = self.at.checked_sub(1).and_then(|before| self.kind_at(before));
        before.is_some_and(|kind| kind == RawKind::Word || ends_value(kind))
            && self.kind_at(self.at) == Some(RawKind::Word)
            && matches!(self.kind_at(self.at + 1), Some(RawKind::Assign | RawKind::Arrow))
    }

    /// Whether an element begins directly after an operand, so that a parenthesis is missing between them.
    fn is_next_element(&self) -> bool {
        let after_operand = self.at.checked_sub(1).and_then(|before| self.kind_at(before)).is_some_and(ends_value);
        after_operand
            && self.kind_at(self.at) == Some(RawKind::Word)
            && self.kind_at(self.at + 1) == Some(RawKind::LeftParen)
            && elements::find_sd(&self.text[self.raw[self.at].range()]).is_some()
    }

    /// `in = 7` for `in := 7`.
    fn compared_pin(&mut self, token: RawToken) {
        let name = &self.text[token.range()];
        let output = name.get(..3).is_some_and(|start| start.eq_ignore_ascii_case("out"));
        let (sign, tok) = if output { ("=>", Tok::Arrow) } else { (":=", Tok::Assign) };
        let value = self.raw.get(self.at + 2).map_or("…", |value| &self.text[value.range()]);
        let equal = self.raw[self.at + 1];
        let help = format!("write `{name} {sign} {value}`");
        self.foreign(equal, &format!("a pin is connected with `{sign}`"), &help);
        self.take(Tok::Pin);
        self.take(tok);
    }

    /// Reports a habit of other languages.
    fn foreign(&mut self, token: RawToken, title: &str, help: &str) {
        let message = Diagnostic::new(Code::ForeignForm, self.span(token), title);
        self.report(message.label("a form of other languages").help(help));
    }

    /// A wire, an operand, or a comparison of SWITCH with its operand.
    fn value_of_pin(&mut self) {
        if let Some(name) = self.wire() {
            return self.take_wire(Tok::Connected(name));
        }
        if let Some(sign) = self.case() {
            self.take(Tok::Case(sign));
        }
        self.value();
    }

    /// The current comparison in `GE #limit => label`.
    fn case(&self) -> Option<Comparison> {
        let word = self.raw[self.at];
        let after = self.kind_at(self.at + 1)?;
        let operand = matches!(
            after,
            RawKind::Word | RawKind::Local | RawKind::Quoted | RawKind::Number | RawKind::Literal | RawKind::Absolute
        );
        if word.kind == RawKind::Word && operand {
            Comparison::of(&self.text[word.range()].to_uppercase())
        } else {
            None
        }
    }

    /// An operand up to the next `,`, `)`, `:=` or `=>` outside brackets.
    fn value(&mut self) {
        let (first, mut depth) = (self.at, 0usize);
        while let Some(token) = self.raw.get(self.at) {
            match token.kind {
                RawKind::LeftParen | RawKind::LeftBracket => depth += 1,
                RawKind::RightParen | RawKind::RightBracket if depth > 0 => depth -= 1,
                RawKind::RightParen | RawKind::Comma | RawKind::Assign | RawKind::Arrow if depth == 0 => break,
                RawKind::Semicolon | RawKind::LeftBrace | RawKind::RightBrace => break,
                _ if self.is_word("RUNG") || self.is_word("END_RUNG") => break,
                _ if depth == 0 && self.at > first && (self.is_next_element() || self.is_next_pin()) => break,
                _ => {}
            }
            self.at += 1;
        }
        let after = self.at;
        self.at = first;
        if after == first { self.take(Tok::Stray) } else { self.take_up_to(Tok::Value, after) }
    }

    /// Index after the current name or constant: `#a.b[1]`, `"DB".x`, `%I0.0`, `TRUE`, `Contact`.
    fn operand_end(&self) -> Option<usize> {
        let mut at = self.at;
        match self.kind_at(at)? {
            RawKind::Number | RawKind::Real | RawKind::Literal | RawKind::Text => return Some(at + 1),
            RawKind::Word | RawKind::Quoted | RawKind::Local | RawKind::Absolute => at += 1,
            _ => return None,
        }
        loop {
            match (self.kind_at(at), self.kind_at(at + 1)) {
                (
                    Some(RawKind::Dot),
                    Some(RawKind::Word | RawKind::Quoted | RawKind::Slice | RawKind::Absolute | RawKind::Number),
                ) => at += 2,
                (Some(RawKind::LeftBracket), _) => {
                    let mut depth = 0usize;
                    let length = self.raw[at..].iter().position(|token| {
                        match token.kind {
                            RawKind::LeftBracket => depth += 1,
                            RawKind::RightBracket => depth -= 1,
                            _ => {}
                        }
                        depth == 0
                    });
                    match length {
                        Some(length) => at += length + 1,
                        None => return Some(at),
                    }
                }
                _ => return Some(at),
            }
        }
    }

    // Raw tokens.

    /// Whether the current token is `word`.
    fn is_word(&self, word: &str) -> bool {
        is_word(self.text, self.raw, self.at, word)
    }

    /// The attributes in the braces that begin at index `open`, and the index after them.
    fn attributes(&mut self, open: usize) -> (Vec<Attribute>, usize) {
        let cursor = &mut self.cursor;
        pragma::read(cursor.file, cursor.text, cursor.raw, open, &mut cursor.diagnostics)
    }
}

/// Whether an operand that is not a word may end with the token.
fn ends_value(kind: RawKind) -> bool {
    matches!(
        kind,
        RawKind::Local
            | RawKind::Quoted
            | RawKind::Absolute
            | RawKind::Number
            | RawKind::Real
            | RawKind::Literal
            | RawKind::RightBracket
    )
}

/// Whether `word` is at `index`, as a separate word, or a slip of it.
pub fn is_word(text: &str, tokens: &[RawToken], index: usize, word: &str) -> bool {
    tokens.get(index).is_some_and(|token| {
        token.kind == RawKind::Word
            && (text[token.range()].eq_ignore_ascii_case(word) || misspelt(text, tokens, index) == Some(word))
            && index.checked_sub(1).is_none_or(|before| tokens[before].kind != RawKind::Dot)
    })
}

/// The word of a frame that the one at `index` stands for, where no statement and no operand can be: `NETWROK` alone on its line,
/// `RNUG` before a wire, `ENDRUNG` at the end of a line.
pub fn misspelt(text: &str, tokens: &[RawToken], index: usize) -> Option<&'static str> {
    const FRAME: [&str; 4] = ["NETWORK", "END_NETWORK", "RUNG", "END_RUNG"];
    let token = tokens.get(index).filter(|token| token.kind == RawKind::Word && token.keyword.is_none())?;
    let word = &text[token.range()];
    if word.len() < 3 || !word.starts_with(['N', 'n', 'E', 'e', 'R', 'r']) {
        return None;
    }
    let next = tokens.get(index + 1);
    let before = index.checked_sub(1).map(|before| tokens[before].kind);
    let wire = next.is_some_and(|next| next.kind == RawKind::Word && text[next.range()].eq_ignore_ascii_case("wire"));
    let ends_line = next.is_none_or(|next| next.first_on_line);
    let candidates: &[&'static str] = match token.first_on_line {
        true if wire => &["RUNG", "END_RUNG"],
        true if ends_line => &["NETWORK", "END_NETWORK", "END_RUNG"],
        false if before == Some(RawKind::RightParen) && (ends_line || wire) => &["END_RUNG"],
        _ => return None,
    };
    if FRAME.iter().any(|known| known.eq_ignore_ascii_case(word)) {
        return None;
    }
    slip_of(word, candidates.iter().copied())
}
