//! Statements of SCL as text.

use plcc_syntax::scl::ast::{CaseValue, Expr, ExprKind, Name, Statement, StatementKind};

use super::expression::{argument, name_text, text};
use crate::writer::Writer;

/// Arguments beyond this width stand on lines of their own.
const WIDTH_MAX: usize = 100;

impl Writer<'_> {
    pub(crate) fn labels(&mut self, labels: &[Name]) {
        if !labels.is_empty() {
            let list: Vec<String> = labels.iter().map(name_text).collect();
            self.out.line(format!("LABEL {}; END_LABEL", list.join(", ")));
        }
    }

    pub(crate) fn statements(&mut self, statements: &[Statement]) {
        for statement in statements {
            self.scl_statement(statement);
        }
    }

    fn body(&mut self, statements: &[Statement]) {
        self.out.indent();
        self.statements(statements);
        self.out.dedent();
    }

    fn scl_statement(&mut self, statement: &Statement) {
        self.remarks_before(statement.span.start);
        let end = statement.span.end;
        match &statement.kind {
            StatementKind::Empty => self.out.line(";"),
            StatementKind::Label(name) => self.out.line(format!("{}:", name_text(name))),
            StatementKind::Expression(value) => self.call_or_value(value),
            StatementKind::Assign { targets, value } => {
                let mut line = String::new();
                for (target, op) in targets {
                    line.push_str(&format!("{} {} ", text(target, self), op.sign()));
                }
                let value = text(value, self);
                self.out.line(format!("{line}{value};"));
            }
            StatementKind::If { branches, otherwise } => {
                for (at, (condition, body)) in branches.iter().enumerate() {
                    // Those before ELSIF end the branch before it.
                    self.out.indent();
                    self.remarks_before(condition.span.start);
                    self.out.dedent();
                    let word = if at == 0 { "IF" } else { "ELSIF" };
                    let condition_text = text(condition, self);
                    self.out.line(format!("{word} {condition_text} THEN"));
                    self.remarks_on_line(condition.span.end);
                    self.body(body);
                }
                let last = branches.last().map(|(condition, body)| end_of(body, condition.span.end));
                self.otherwise(last.unwrap_or(end), otherwise, end);
                self.close(end, "END_IF;");
            }
            StatementKind::Case { selector, arms, otherwise } => {
                let selector_text = text(selector, self);
                self.out.line(format!("CASE {selector_text} OF"));
                self.remarks_on_line(selector.span.end);
                self.out.indent();
                for arm in arms {
                    self.remarks_before(arm.span.start);
                    let values: Vec<String> = arm.values.iter().map(|value| self.case_value(value)).collect();
                    self.out.line(format!("{}:", values.join(", ")));
                    if let Some(last) = arm.values.last() {
                        self.remarks_on_line(last.high.as_ref().unwrap_or(&last.low).span.end);
                    }
                    self.body(&arm.body);
                }
                self.out.dedent();
                let last = arms.last().map_or(selector.span.end, |arm| {
                    let value = arm.values.last().map(|value| value.high.as_ref().unwrap_or(&value.low).span.end);
                    end_of(&arm.body, value.unwrap_or(arm.span.end))
                });
                self.otherwise(last, otherwise, end);
                self.close(end, "END_CASE;");
            }
            StatementKind::For { variable, start, end: last, step, body } => {
                let step_text = step.as_ref().map_or(String::new(), |step| format!(" BY {}", text(step, self)));
                let line = format!(
                    "FOR {} := {} TO {}{step_text} DO",
                    text(variable, self),
                    text(start, self),
                    text(last, self)
                );
                self.out.line(line);
                self.remarks_on_line(step.as_ref().unwrap_or(last).span.end);
                self.body(body);
                self.close(end, "END_FOR;");
            }
            StatementKind::While { condition, body } => {
                let condition_text = text(condition, self);
                self.out.line(format!("WHILE {condition_text} DO"));
                self.remarks_on_line(condition.span.end);
                self.body(body);
                self.close(end, "END_WHILE;");
            }
            StatementKind::Repeat { body, until } => {
                self.out.line("REPEAT");
                self.body(body);
                self.remarks_before(until.span.start);
                let until = text(until, self);
                self.out.line(format!("UNTIL {until}"));
                self.close(end, "END_REPEAT;");
            }
            StatementKind::Exit => self.out.line("EXIT;"),
            StatementKind::Continue => self.out.line("CONTINUE;"),
            StatementKind::Return(None) => self.out.line("RETURN;"),
            StatementKind::Return(Some(value)) => {
                let value = text(value, self);
                self.out.line(format!("RETURN {value};"));
            }
            StatementKind::Goto(label) => self.out.line(format!("GOTO {};", name_text(label))),
            StatementKind::Pragma(pragma) => self.out.line(format!("//@ {}", pragma.text)),
            StatementKind::Error => {
                self.refuse(statement.span, "a statement that was not understood", "repair the source first");
            }
        }
        self.remarks_on_line(end);
    }

    /// ELSE of a statement that ends at byte `end`. Comments between byte `last`, the end of the branch before it, and the word belong to
    /// that branch; those after it to ELSE, even if it has no statements.
    fn otherwise(&mut self, last: u32, statements: &[Statement], end: u32) {
        let place = self.trivia.word("ELSE", last, statements.first().map_or(end, |first| first.span.start));
        if let Some(place) = place {
            self.out.indent();
            self.remarks_before(place);
            self.out.dedent();
        }
        if !statements.is_empty() || place.is_some() && self.trivia.has_before(end) {
            self.out.line("ELSE");
            self.body(statements);
        }
    }

    /// The end of a statement that contains others; comments before it belong to them.
    fn close(&mut self, end: u32, word: &str) {
        self.out.indent();
        self.remarks_before(end);
        self.out.dedent();
        self.out.line(word);
    }

    fn case_value(&mut self, value: &CaseValue) -> String {
        let low = text(&value.low, self);
        match &value.high {
            Some(high) => format!("{low}..{}", text(high, self)),
            None => low,
        }
    }

    /// A call with many arguments has one on each line.
    fn call_or_value(&mut self, value: &Expr) {
        let line = text(value, self);
        let ExprKind::Call { callee, arguments } = &value.kind else { return self.out.line(format!("{line};")) };
        if line.chars().count() <= WIDTH_MAX || arguments.is_empty() {
            return self.out.line(format!("{line};"));
        }
        let callee = text(callee, self);
        self.out.line(format!("{callee}("));
        self.out.indent();
        for (at, one) in arguments.iter().enumerate() {
            self.remarks_before(one.span.start);
            let end = if at + 1 == arguments.len() { ");" } else { "," };
            let one = argument(one, self);
            self.out.line(format!("{one}{end}"));
        }
        self.out.dedent();
    }
}

/// The end of the last statement; `otherwise` if there is none.
fn end_of(body: &[Statement], otherwise: u32) -> u32 {
    body.last().map_or(otherwise, |last| last.span.end)
}
