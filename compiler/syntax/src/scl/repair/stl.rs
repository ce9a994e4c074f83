//! Statements of STL among those of SCL: `L #a; T #b;`, `A #start; = #lamp;`, `JMP end;`, `NOP 0;`.

use super::{Edit, Repair};
use crate::scl::raw::{RawKind, RawToken};

/// Mnemonics of both sets, and of IEC 61131-3.
const MNEMONICS: [&str; 24] = [
    "L", "T", "A", "AN", "U", "UN", "O", "ON", "X", "XN", "S", "R", "=", "JU", "JC", "JCN", "JMP", "JMPC", "SPA",
    "SPB", "SPBN", "LD", "LDN", "ST",
];

/// Statements of one list that a message takes together.
const LIST_MAX: usize = 200;

/// A mnemonic with its operand.
struct Line<'t> {
    /// In upper case.
    mnemonic: String,
    operand: &'t str,
    /// Index of the token after the operand.
    end: usize,
}

impl<'t> Repair<'t> {
    /// Statements of STL that follow each other, which are one message; or `NOP`.
    pub(super) fn statement_list(&mut self, token: RawToken) -> bool {
        let at = self.at;
        if token.kind != RawKind::Word || !self.starts(token) || self.is_declared(self.slice(token)) {
            return false;
        }
        if self.no_operation(token) {
            return true;
        }
        let mut lines: Vec<Line> = Vec::new();
        let mut next = at;
        while lines.len() < LIST_MAX
            && let Some(line) = self.line_of_stl(next)
        {
            next = if self.kind(line.end) == Some(RawKind::Semicolon) { line.end + 1 } else { line.end };
            lines.push(line);
        }
        let (Some(first), Some(last)) = (lines.first(), lines.last()) else { return false };
        let (first_end, end) = (first.end, last.end);
        let title = format!("`{}` begins a statement of STL, not of SCL", self.slice(token));
        let help = meant(&lines);
        self.report(at, first_end, title, "a form of STL", help);
        self.end_reported(at, end);
        true
    }

    /// `NOP;`, `NOP 0;`
    fn no_operation(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let word = self.slice(token);
        let end = if self.kind(at + 1) == Some(RawKind::Number) { at + 2 } else { at + 1 };
        let known = ["NOP", "NOOP", "NULL", "PASS"].iter().any(|known| known.eq_ignore_ascii_case(word));
        if !known || self.kind(end) != Some(RawKind::Semicolon) {
            return false;
        }
        let title = format!("SCL has no statement `{word}`");
        self.report(
            at,
            end,
            title,
            "a form of other languages",
            "a statement that does nothing is `;` alone".to_owned(),
        );
        self.end_reported(at, end);
        true
    }

    /// The statement from token `at` to `end`, exclusive, was reported; a `;` ends it.
    fn end_reported(&mut self, at: usize, end: usize) {
        self.statement = at;
        self.give_up(end);
        if self.kind(end) != Some(RawKind::Semicolon) {
            let place = self.tokens[end - 1].end;
            let kind = RawKind::Semicolon;
            let semicolon = RawToken { kind, keyword: None, start: place, end: place, first_on_line: false };
            self.edits.push(Edit { first: end, after: end, with: vec![semicolon] });
            self.note(semicolon);
        }
    }

    /// The statement of STL that begins at token `at`.
    fn line_of_stl(&self, at: usize) -> Option<Line<'t>> {
        let token = self.token(at).filter(|token| token.keyword.is_none())?;
        let mnemonic = self.slice(token).to_ascii_uppercase();
        if !matches!(token.kind, RawKind::Word | RawKind::Equal) || !MNEMONICS.contains(&mnemonic.as_str()) {
            return None;
        }
        let first = self.beside(at + 1).filter(|next| next.keyword.is_none())?;
        let is_operand = matches!(
            first.kind,
            RawKind::Word
                | RawKind::Local
                | RawKind::Quoted
                | RawKind::Absolute
                | RawKind::Number
                | RawKind::Real
                | RawKind::Literal
        );
        let mut end = self.operand_end(at + 1);
        // `MW 2`
        let is_number = |next: RawToken| matches!(next.kind, RawKind::Number | RawKind::Real);
        if first.kind == RawKind::Word && end == at + 2 && self.beside(end).is_some_and(is_number) {
            end += 1;
        }
        let semicolon = self.kind(end) == Some(RawKind::Semicolon);
        // `A comment` without its sign.
        let is_prose = first.kind == RawKind::Word && end == at + 2 && !self.is_declared(self.slice(first));
        let ends = semicolon || !is_prose && self.token(end).is_none_or(|next| next.first_on_line);
        (is_operand && ends).then(|| Line { mnemonic, operand: self.words(at + 1, end - 1), end })
    }
}

/// What to write in place of the statements.
fn meant(lines: &[Line]) -> String {
    let is_load = |line: &Line| matches!(line.mnemonic.as_str(), "L" | "A" | "U" | "LD");
    let is_store = |line: &Line| matches!(line.mnemonic.as_str(), "T" | "=" | "ST");
    match lines {
        [load, store] if is_load(load) && is_store(store) => {
            format!("write `{} := {};`", store.operand, load.operand)
        }
        [line] => {
            let operand = line.operand;
            match line.mnemonic.as_str() {
                "T" | "=" | "ST" => format!("write `{operand} := …;` with the value"),
                "S" => format!("write `IF … THEN {operand} := TRUE; END_IF;` with the condition"),
                "R" => format!("write `IF … THEN {operand} := FALSE; END_IF;` with the condition"),
                "JU" | "JMP" | "SPA" => format!("write `GOTO {operand};`"),
                "JC" | "JMPC" | "SPB" => format!("write `IF … THEN GOTO {operand}; END_IF;` with the condition"),
                "JCN" | "SPBN" => format!("write `IF NOT … THEN GOTO {operand}; END_IF;` with the condition"),
                "L" | "LD" => format!("write `… := {operand};` with the variable that gets the value"),
                _ => format!("write a condition: `IF {operand} THEN … END_IF;`"),
            }
        }
        _ => "write assignments and conditions: `variable := value;`, `IF condition THEN … END_IF;`".to_owned(),
    }
}
