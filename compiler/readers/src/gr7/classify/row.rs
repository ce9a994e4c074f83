//! Classifies the words of actions and permanent instructions: where a row ends, and what is in the parentheses after its operand.

use plcc_diag::{Code, Diagnostic, Span};

use super::Classifier;
use super::expression::{Place, is_operator};
use crate::gr7::lexer::RawKind;
use crate::gr7::pragma::{self, Tag};
use crate::gr7::qualifier;
use crate::gr7::token::Tok;
use plcc_syntax::chart::ast::{Coil, Event};

/// Where a row ends.
struct Extent {
    /// Index after its last token.
    end: usize,
    /// Index of the parenthesis before the qualifier.
    qualifier: Option<usize>,
}

/// `T#5S` for `5s`; another value as it is.
fn with_prefix(value: &str) -> String {
    let unit = value.trim_start_matches(|c: char| c.is_ascii_digit());
    let is_time =
        unit.len() < value.len() && ["ms", "s", "m", "h", "d"].iter().any(|own| unit.eq_ignore_ascii_case(own));
    if is_time { format!("T#{}", value.to_ascii_uppercase()) } else { value.to_owned() }
}

impl<'a> Classifier<'a, '_> {
    /// `operand := value (qualifier)`
    pub(super) fn action_row(&mut self) {
        let call = self.is_call();
        let Extent { end, qualifier } = self.action_extent(call);
        let body = qualifier.unwrap_or(end);
        let empty = self.at == body;
        if let Some(open) = qualifier.filter(|_| !call) {
            self.leading_event(open, end);
        }
        if call {
            self.take(Tok::Call);
        }
        if body == self.at + 1 && self.is_word(self.at, "S_ALL") {
            self.take(Tok::All);
        } else {
            self.expression(body, if call { Place::Call } else { Place::Action });
        }
        match qualifier {
            Some(open) => self.qualifier(open, end, empty),
            None => self.no_qualifier(),
        }
        self.comment_of_row();
        self.push_here(Tok::RowEnd);
    }

    /// `S1 Q0.0 (N)`: an event before the operand is reported and skipped. `open`: index of the parenthesis of the qualifier.
    fn leading_event(&mut self, open: usize, end: usize) {
        let (first, operand) = (self.raw[self.at], self.at + 1);
        let event = self.slice(first);
        let is_operand = operand < open
            && matches!(
                self.kind_at(operand),
                Some(RawKind::Word | RawKind::Quoted | RawKind::Local | RawKind::Absolute)
            )
            && !is_operator(self.raw[operand], self.slice(self.raw[operand]));
        if first.kind != RawKind::Word || Event::of(event).is_none() || !is_operand {
            return;
        }
        let text = |from: u32, to: u32| self.text[from as usize..to as usize].trim();
        let row = text(self.raw[operand].start, self.raw[open].start);
        let mark = text(self.raw[open].end, self.raw[end - 1].start);
        let help = format!("write `{row} ({event} {mark})`");
        self.report(
            Diagnostic::new(
                Code::Qualifier,
                self.span(first),
                "an event comes before the instruction in the parenthesis",
            )
            .label("before the operand")
            .help(help),
        );
        self.at += 1;
    }

    fn is_call(&self) -> bool {
        self.is_word(self.at, "CALL")
            && matches!(
                self.kind_at(self.at + 1),
                Some(RawKind::Word | RawKind::Quoted | RawKind::Local | RawKind::Number)
            )
    }

    /// A row ends after its qualifier, or at the end of its line.
    fn action_extent(&self, call: bool) -> Extent {
        let (mut depth, mut lists) = (0usize, 0usize);
        let mut index = self.at;
        while let Some(token) = self.raw.get(index) {
            if index > self.at && self.ends_row(index) {
                break;
            }
            let new_line = token.first_on_line && index > self.at;
            if depth == 0 {
                if let Some(close) = self.qualifier_at(index, call && lists == 0) {
                    return Extent { end: close + 1, qualifier: Some(index) };
                }
                let list = call && lists == 0 && token.kind == RawKind::LeftParen;
                if new_line && !list && !self.continues(index) {
                    break;
                }
            } else if new_line && (!call || self.is_word(index, "CALL")) {
                break;
            }
            match token.kind {
                RawKind::LeftParen => {
                    depth += 1;
                    lists += 1;
                }
                RawKind::RightParen => depth = depth.saturating_sub(1),
                _ => {}
            }
            index += 1;
        }
        if depth > 0 {
            // A part that is not closed ends with its line.
            let line = (self.at + 1..index).find(|next| self.raw[*next].first_on_line);
            index = line.unwrap_or(index);
            let open = (self.at..index).rev().take(4).find(|open| self.kind_at(*open) == Some(RawKind::LeftParen));
            if let Some(open) = open.filter(|open| *open > self.at)
                && self.qualifier_at(open, true) == Some(index - 1)
            {
                return Extent { end: index, qualifier: Some(open) };
            }
        }
        Extent { end: index, qualifier: None }
    }

    /// Whether no part of a row can be at `index`.
    fn ends_row(&self, index: usize) -> bool {
        matches!(self.raw[index].kind, RawKind::Semicolon | RawKind::Pragma) || self.keyword_at(index).is_some()
    }

    /// Whether the line at `index` is an action of its own: it continues nothing and ends in a qualifier.
    pub(super) fn begins_action(&self, index: usize) -> bool {
        let follows = index.checked_sub(1).is_some_and(|before| self.joins(before));
        let mut line = (index + 1..self.raw.len()).take_while(|next| !self.raw[*next].first_on_line);
        self.raw[index].first_on_line
            && !follows
            && !self.continues(index)
            && line.any(|next| self.qualifier_at(next, false).is_some())
    }

    /// Whether a line at `index` continues the row of the previous line.
    fn continues(&self, index: usize) -> bool {
        self.joins(index) || self.kind_at(index) == Some(RawKind::LeftParen)
    }

    /// Whether the token comes between two parts of a row.
    fn joins(&self, index: usize) -> bool {
        let token = self.raw[index];
        matches!(token.kind, RawKind::Comma | RawKind::Assign) || is_operator(token, self.slice(token))
    }

    /// Index of the `)` of the qualifier that opens at `index`. `call`: parameters of a call are possible here.
    fn qualifier_at(&self, index: usize, call: bool) -> Option<usize> {
        if self.kind_at(index) != Some(RawKind::LeftParen) {
            return None;
        }
        let words = self.raw[index + 1..].iter().take(4).take_while(|token| token.kind == RawKind::Word).count();
        let close = index + 1 + words;
        if self.kind_at(close) != Some(RawKind::RightParen) {
            return None;
        }
        let last = close + 1 == self.raw.len() || self.raw[close + 1].first_on_line || self.ends_row(close + 1);
        let text = &self.text[self.raw[index].end as usize..self.raw[close].start as usize];
        let known = qualifier::parse(text).is_some();
        let next = self.raw.get(close + 1);
        let after = next.is_none_or(|next| {
            last || matches!(next.kind, RawKind::Word | RawKind::Quoted | RawKind::Local | RawKind::Absolute)
                && !is_operator(*next, self.slice(*next))
        });
        (if known { after } else { last && !call }).then_some(close)
    }

    /// The qualifier in the parenthesis at `open`.
    fn qualifier(&mut self, open: usize, end: usize, alone: bool) {
        let (first, last) = (self.raw[open], self.raw[end - 1]);
        let span = Span { file: self.file, start: first.end, end: last.start };
        let text = &self.text[span.range()];
        let mark = qualifier::parse(text);
        if mark.is_none() {
            let title = match text.trim() {
                "" => "the qualifier is missing".to_owned(),
                text => format!("GRAPH has no qualifier `{text}`"),
            };
            let span = if text.trim().is_empty() { self.span(first).to(self.span(last)) } else { span };
            self.report(
                Diagnostic::new(Code::Qualifier, span, title)
                    .label("not an instruction of an action")
                    .help(qualifier::help(text)),
            );
        } else if alone {
            let rest = self.raw.get(end).filter(|next| !next.first_on_line);
            let rest = rest.and_then(|next| self.text[next.start as usize..].lines().next());
            let operand = rest.map_or("Q4.0", |rest| rest.trim().trim_end_matches(';'));
            let help = format!("write its operand before it: `{operand} ({})`", text.trim());
            self.report(
                Diagnostic::new(Code::ActionText, self.span(first).to(self.span(last)), "the action has no operand")
                    .label("there is only a qualifier here")
                    .help(help),
            );
        }
        self.out.push((first.start as usize, Tok::Qualifier(mark.filter(|_| !alone)), last.end as usize));
        self.at = end;
        if alone {
            self.skip_operand();
        }
    }

    /// `(N) Q0.5`: what follows a qualifier that was reported is the operand of its row, if it has no qualifier of its own.
    fn skip_operand(&mut self) {
        let line = self.raw[self.at..].iter().take_while(|token| !token.first_on_line).count();
        let after = (self.at..self.at + line).find(|index| self.ends_row(*index)).unwrap_or(self.at + line);
        if !(self.at..after).any(|index| self.qualifier_at(index, false).is_some()) {
            self.at = after;
        }
    }

    fn no_qualifier(&mut self) {
        let last = self.raw[self.at - 1];
        // A bracket or character that was reported may include it.
        if !self.reported_in_row() && !self.section_in_row() {
            let help = self.call_row().or_else(|| self.meant_row());
            let help = help.or_else(|| self.foreign_row()).or_else(|| self.assigned_row());
            let help = help.unwrap_or_else(|| qualifier::help(""));
            self.report(
                Diagnostic::new(Code::Qualifier, self.span(last), "the action has no qualifier")
                    .label("after this")
                    .help(help),
            );
        }
        self.push_here(Tok::Qualifier(None));
    }

    /// Index of the first token of the row that ends here.
    fn row_start(&self) -> Option<usize> {
        (0..self.at).rev().find(|index| self.raw[*index].first_on_line)
    }

    /// `INTERLOCK := I0.5`: a section of the step, written as if it were an operand. It is reported.
    fn section_in_row(&mut self) -> bool {
        let Some(row) = self.row_start().filter(|row| self.kind_at(row + 1) == Some(RawKind::Assign)) else {
            return false;
        };
        let Some(word) = ["INTERLOCK", "SUPERVISION"].into_iter().find(|word| self.is_word(row, word)) else {
            return false;
        };
        let condition = self.row_text().and_then(|text| text.split_once(":=")).map_or("…", |(_, value)| value.trim());
        let help = format!("write `{word}`, `CONDITION := {condition}` and `END_{word}`, each on its own line");
        let first = self.span(self.raw[row]);
        self.report(
            Diagnostic::new(Code::Syntax, first, format!("`{word}` is a section of the step, not an operand"))
                .label("an action begins with its operand")
                .help(help),
        );
        true
    }

    /// `CALL FC1`
    fn call_row(&self) -> Option<String> {
        let row = self.row_start().filter(|row| self.is_word(*row, "CALL"))?;
        (row + 1 < self.at).then_some(())?;
        Some(format!("write `{} (N)`", self.row_text()?))
    }

    /// How the author of a row without a qualifier means it: `Q0.0, T#5S (D)` for `Q0.0 (D, T#5S)`, `Q0.1 (N)` for `Q0.1 N`.
    fn meant_row(&self) -> Option<String> {
        let row = self.row_start()?;
        let last = self.at.checked_sub(1)?;
        let slice = |first: usize, after: usize| {
            (first < after).then(|| self.text[self.raw[first].start as usize..self.raw[after - 1].end as usize].trim())
        };
        let Some(open) = (row + 1..self.at).find(|index| self.kind_at(*index) == Some(RawKind::LeftParen)) else {
            // `N Q0.0`
            let first = slice(row, row + 1)?;
            if row < last && qualifier::parse(first).is_some() && !self.joins(row) {
                // `D Q0.0 T#5S`
                let value = slice(last, last + 1).filter(|value| value.contains('#') && !value.starts_with('#'));
                return Some(match (slice(row + 1, last), value) {
                    (Some(operand), Some(value)) => {
                        format!("write `{}, {value} ({first})`", operand.trim_end_matches([',', ' ']))
                    }
                    _ => format!("write `{} ({first})`", slice(row + 1, last + 1)?),
                });
            }
            let (operand, mark) = (slice(row, last)?, slice(last, last + 1)?);
            qualifier::parse(mark).filter(|_| !self.joins(last - 1))?;
            return Some(format!("write `{operand} ({mark})`"));
        };
        // `Q0.0 (D) := T#5S`
        if let Some(close) = (open + 1..last).find(|index| self.kind_at(*index) == Some(RawKind::RightParen))
            && matches!(self.kind_at(close + 1), Some(RawKind::Comma | RawKind::Assign))
        {
            let (operand, mark, value) = (slice(row, open)?, slice(open + 1, close)?, slice(close + 2, last + 1)?);
            return match Event::of(mark) {
                Some(_) => Some(format!("write `{operand} := {value} ({mark} N)`: the parenthesis is last")),
                None => qualifier::parse(mark)
                    .map(|_| format!("write `{operand} := {value} ({mark})`: the parenthesis is last")),
            };
        }
        if self.kind_at(last) != Some(RawKind::RightParen) {
            return None;
        }
        let (operand, mark) = (slice(row, open)?, slice(open + 1, open + 2)?);
        let first = match self.kind_at(open + 2)? {
            RawKind::Comma | RawKind::Assign => open + 3,
            _ => open + 2,
        };
        let value = slice(first, last)?;
        // `(N, S1)`, `(S1, ON)`
        for (event, instruction) in [(mark, value), (value, mark)] {
            if Event::of(event).is_some() && qualifier::parse(instruction).is_some() {
                return Some(format!("write `{operand} ({event} {instruction})`"));
            }
        }
        qualifier::parse(mark)?;
        // `(N, S)`
        if qualifier::parse(value).is_some() {
            return Some(format!("write a row for each of them: `{operand} ({mark})` and `{operand} ({value})`"));
        }
        let event = if qualifier::needs_event(mark) { "S1 " } else { "" };
        Some(format!("write `{operand}, {} ({event}{mark})`", with_prefix(value)))
    }

    /// The row, as written.
    fn row_text(&self) -> Option<&str> {
        let row = self.row_start()?;
        let last = self.raw.get(self.at.checked_sub(1)?)?;
        self.text.get(self.raw[row].start as usize..last.end as usize).map(str::trim)
    }

    /// `MW10 := 5`
    fn assigned_row(&self) -> Option<String> {
        let (operand, value) = self.row_text()?.split_once(":=")?;
        let (operand, value) = (operand.trim(), value.trim().trim_end_matches(';'));
        let plain = !operand.is_empty() && !value.is_empty() && !operand.contains(char::is_whitespace);
        plain.then(|| format!("write `{operand} := {value} (N)`, or another qualifier for `N`"))
    }

    /// `SET M0.0`, `IF …`: instructions of other languages.
    fn foreign_row(&self) -> Option<String> {
        let text = self.row_text()?;
        let (word, rest) = text.split_once(char::is_whitespace)?;
        let rest = rest.trim().trim_end_matches(';');
        Some(match word.to_ascii_uppercase().as_str() {
            "SET" => format!("write `{rest} (S)`"),
            "RESET" | "RST" | "RES" => format!("write `{rest} (R)`"),
            "IF" | "CASE" | "FOR" | "WHILE" => {
                format!(
                    "a step has no `{word}`: call a block with these statements, as in `CALL FC1 () (N)`, or write a condition as an interlock"
                )
            }
            _ => return None,
        })
    }

    /// Whether the last message is about the current line.
    fn reported_in_row(&self) -> bool {
        let before = &self.raw[..self.at];
        let first = before.iter().rposition(|token| token.first_on_line).map_or(0, |first| before[first].start);
        self.diagnostics.last().is_some_and(|last| last.is_error() && last.primary.span.start >= first)
    }

    /// `(*$_COM …*)` on the line of a row belongs to it.
    fn comment_of_row(&mut self) {
        if self.is_at(RawKind::Semicolon) {
            self.at += 1;
        }
        if let Some(token) = self.peek()
            && token.kind == RawKind::Pragma
            && !token.first_on_line
            && pragma::tag(self.slice(token)) == Some(Tag::Comment)
        {
            let body = pragma::body(self.slice(token));
            self.take(Tok::Comment(body));
        }
    }

    /// `operand (=) := value`, `CALL …`
    pub(super) fn permanent_row(&mut self) {
        let call = self.is_call();
        let end = self.permanent_extent(call);
        if call {
            self.take(Tok::Call);
            self.expression(end, Place::Call);
        } else {
            match (self.at..end).find(|index| self.is_coil(*index)) {
                Some(open) => {
                    self.expression(open, Place::Permanent);
                    self.coil(open);
                    if self.is_at(RawKind::Assign) && self.at < end {
                        self.take(Tok::Assign);
                    }
                }
                None => self.no_coil(end),
            }
            self.expression(end, Place::Permanent);
        }
        self.push_here(Tok::RowEnd);
    }

    fn permanent_extent(&self, call: bool) -> usize {
        let (mut depth, mut lists) = (0usize, 0usize);
        let mut index = self.at;
        while let Some(token) = self.raw.get(index) {
            if index > self.at && self.ends_row(index) {
                break;
            }
            let new_line = token.first_on_line && index > self.at;
            let list = call && lists == 0 && token.kind == RawKind::LeftParen;
            let goes_on = || depth > 0 || list || self.continues(index) || self.joins(index - 1);
            if new_line && (!goes_on() || self.begins_permanent(index)) {
                break;
            }
            match token.kind {
                RawKind::LeftParen => {
                    depth += 1;
                    lists += 1;
                }
                RawKind::RightParen => depth = depth.saturating_sub(1),
                _ => {}
            }
            index += 1;
        }
        index
    }

    /// Whether a permanent instruction begins with the line at `index`: an unclosed bracket ends before it.
    fn begins_permanent(&self, index: usize) -> bool {
        let line = &self.raw[index..];
        let length = line.iter().skip(1).take_while(|token| !token.first_on_line).count() + 1;
        self.is_word(index, "CALL") || (index..index + length).any(|index| self.is_coil(index))
    }

    /// `(=) :=`
    fn is_coil(&self, index: usize) -> bool {
        self.kind_at(index) == Some(RawKind::LeftParen)
            && self.kind_at(index + 2) == Some(RawKind::RightParen)
            && (self.kind_at(index + 1) == Some(RawKind::Equal) || self.kind_at(index + 3) == Some(RawKind::Assign))
    }

    fn coil(&mut self, open: usize) {
        let [first, sign, last] = [self.raw[open], self.raw[open + 1], self.raw[open + 2]];
        let coil = match self.slice(sign) {
            "=" => Some(Coil::Assign),
            "S" | "s" => Some(Coil::Set),
            "R" | "r" => Some(Coil::Reset),
            _ => None,
        };
        if coil.is_none() {
            let title = format!("a permanent instruction cannot have the form `({})`", self.slice(sign));
            self.report(
                Diagnostic::new(Code::Qualifier, self.span(sign), title)
                    .label("not `=`, `S` or `R`")
                    .help("write `operand (=) := condition`, or `(S)` or `(R)`"),
            );
        }
        self.out.push((first.start as usize, Tok::Coil(coil), last.end as usize));
        self.at = open + 3;
    }

    fn no_coil(&mut self, end: usize) {
        let first = self.raw[self.at];
        let last = self.raw[end - 1];
        self.report(
            Diagnostic::new(Code::Syntax, self.span(first).to(self.span(last)), "this is not a permanent instruction")
                .label("`(=)`, `(S)` or `(R)` and `:=` are missing")
                .help("write `operand (=) := condition`, or `CALL FC1 ()`"),
        );
        self.out.push((first.start as usize, Tok::Bad, last.end as usize));
        self.at = end;
    }
}
