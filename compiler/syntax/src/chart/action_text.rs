//! Rows of actions as text: an operand, an operand with its value or parameters, or a call.
//!
//! ```text
//! "Motor"                    "Valve", T#2S           #sum := #a + #b
//! S_ALL                      CALL "Mix" (IN1 := 1, OUT1 := #x)
//! CALL "Ramp", "RampDB" (…)  CALL FC 10
//! ```
//!
//! Operands and values are expressions of SCL. Code that knows the qualifier checks whether they suit it.
//! Source: GRAPH reference A.2, B.4.

mod call;
mod scan;

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::ast::ActionBody;
use crate::scl::ast::{Expr, ExprKind};
use crate::scl::fragment;
use scan::Code as Source;

/// A row of a text.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub body: ActionBody,
    pub comment: Option<String>,
    /// Without outer blanks and comments.
    pub span: Span,
}

/// Reads the rows in a part of a text: one per line, except that a call continues until its parenthesis is closed. Spans are those of `text`.
pub fn rows(file: FileId, text: &str, range: Range<usize>, diagnostics: &mut Vec<Diagnostic>) -> Vec<Row> {
    let source = Source::of(text, range);
    let mut reader = Reader { file, text, source: &source, diagnostics };
    let mut found = Vec::new();
    for line in source.lines() {
        let code = source.trimmed(line.clone());
        if !code.is_empty() {
            let comment = source.comment(line);
            let span = Span::new(file, code.clone());
            found.push(Row { body: reader.body(code), comment, span });
        }
    }
    found
}

struct Reader<'a> {
    file: FileId,
    /// The text that ranges refer to.
    text: &'a str,
    source: &'a Source,
    diagnostics: &'a mut Vec<Diagnostic>,
}

/// Words that begin statements, but not rows.
const STATEMENTS: [&str; 9] = ["IF", "CASE", "FOR", "WHILE", "REPEAT", "RETURN", "EXIT", "CONTINUE", "GOTO"];

impl Reader<'_> {
    /// The contents of the row at `code`, which is not empty.
    fn body(&mut self, code: Range<usize>) -> ActionBody {
        let (word, after) = self.source.word(code.clone());
        if word.eq_ignore_ascii_case("CALL") {
            return self.call(code, after);
        }
        if word.eq_ignore_ascii_case("S_ALL") && after == code.end {
            return ActionBody::All { span: self.span(code) };
        }
        if STATEMENTS.iter().any(|known| known.eq_ignore_ascii_case(word)) {
            let title = format!("an action cannot begin with {}", word.to_uppercase());
            let help = "write one operand, one assignment or one CALL in a row; write the rest in a block, and call it";
            return self.refuse(code.start..code.start + word.len(), title, "a statement of SCL", help);
        }
        let separators = self.source.separators(code.clone());
        match separators.as_slice() {
            [] => self.operand(code),
            [separator] => {
                let left = self.source.trimmed(code.start..separator.start);
                let right = self.source.trimmed(separator.end..code.end);
                if left.is_empty() || right.is_empty() {
                    let what = if left.is_empty() { "the operand" } else { "the value of the operand" };
                    let help = "write the operand, `:=` or a comma, and its value";
                    return self.refuse(separator.clone(), format!("{what} is missing"), "nothing next to it", help);
                }
                match (self.expression(left), self.expression(right)) {
                    (Some(operand), Some(value)) => ActionBody::Value { operand, value },
                    _ => ActionBody::Error,
                }
            }
            [_, second, ..] => {
                let help = "write each assignment in a separate row";
                self.refuse(
                    second.clone(),
                    "an action with more than one value".to_string(),
                    "one value too many",
                    help,
                )
            }
        }
    }

    /// An operand, or a call as SCL writes it.
    fn operand(&mut self, code: Range<usize>) -> ActionBody {
        match self.expression(code) {
            Some(Expr { kind: ExprKind::Call { callee, arguments }, span }) => self.scl_call(*callee, arguments, span),
            Some(operand) => ActionBody::Operand(operand),
            None => ActionBody::Error,
        }
    }

    /// The expression at a place; `None` if there is none, which is reported.
    fn expression(&mut self, code: Range<usize>) -> Option<Expr> {
        let (expr, messages) = fragment::expression(self.file, self.text, code.clone());
        let is_error = matches!(expr.kind, ExprKind::Error);
        if is_error && !messages.iter().any(Diagnostic::is_error) {
            let title = format!("`{}` is not an operand", &self.text[code.clone()]);
            self.refuse(code, title, "cannot be read", "write an operand, an assignment or a CALL");
        }
        self.diagnostics.extend(messages);
        (!is_error).then_some(expr)
    }

    fn refuse(&mut self, place: Range<usize>, title: String, label: &str, help: &str) -> ActionBody {
        let message = Diagnostic::new(Code::ActionText, self.span(place), title);
        self.diagnostics.push(message.label(label).help(help));
        ActionBody::Error
    }

    fn span(&self, place: Range<usize>) -> Span {
        Span::new(self.file, place)
    }
}

#[cfg(test)]
mod tests;
