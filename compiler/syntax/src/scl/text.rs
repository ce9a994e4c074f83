//! Text form of SCL trees, for `--emit ast`: one node per line for statements, an expression on one line.

use std::fmt::Write;

use super::ast::{
    Argument, Body, CaseValue, Dialect, Expr, ExprKind, Literal, Name, NameForm, Statement, StatementKind, UnaryOp,
};
use crate::ast::{BlockName, OperandKind, Width};
use crate::ast_text;

/// One line for an expression, fully parenthesised.
pub fn expr(value: &Expr) -> String {
    let mut out = String::new();
    write_expr(&mut out, value);
    out
}

/// Lines for statements, each with its depth.
pub fn statements(list: &[Statement]) -> Vec<(usize, String)> {
    let mut lines = Lines::default();
    lines.statements(list);
    lines.finish()
}

/// Lines for the statements of a block, each with its depth.
pub fn body(value: &Body) -> Vec<(usize, String)> {
    let mut lines = Lines::default();
    match value.dialect {
        Dialect::Either => lines.line("scl"),
        Dialect::Classic => lines.line("scl classic"),
        Dialect::Tia => lines.line("scl tia"),
    }
    lines.inside(|lines| {
        for label in &value.labels {
            lines.line(format!("declared label {}", label.text));
        }
        lines.statements(&value.statements);
    });
    lines.finish()
}

/// The lines of a tree, each with its depth; those of charts too.
#[derive(Default)]
pub(crate) struct Lines {
    lines: Vec<(usize, String)>,
    depth: usize,
}

impl Lines {
    pub(crate) fn finish(self) -> Vec<(usize, String)> {
        self.lines
    }

    pub(crate) fn line(&mut self, text: impl Into<String>) {
        self.lines.push((self.depth, text.into()));
    }

    pub(crate) fn inside(&mut self, print: impl FnOnce(&mut Lines)) {
        self.depth += 1;
        print(self);
        self.depth -= 1;
    }

    pub(crate) fn statements(&mut self, statements: &[Statement]) {
        for statement in statements {
            self.statement(&statement.kind);
        }
    }

    fn block(&mut self, head: impl Into<String>, statements: &[Statement]) {
        self.line(head);
        self.inside(|lines| lines.statements(statements));
    }

    fn statement(&mut self, kind: &StatementKind) {
        match kind {
            StatementKind::Empty => self.line("empty"),
            StatementKind::Label(name) => self.line(format!("label {}", name.text)),
            StatementKind::Expression(value) => self.line(format!("do {}", expr(value))),
            StatementKind::Assign { targets, value } => {
                let mut text = String::new();
                for (target, op) in targets {
                    write_expr(&mut text, target);
                    let _ = write!(text, " {} ", op.sign());
                }
                write_expr(&mut text, value);
                self.line(text);
            }
            StatementKind::If { branches, otherwise } => {
                for (index, (condition, body)) in branches.iter().enumerate() {
                    self.block(format!("{} {}", if index == 0 { "if" } else { "elsif" }, expr(condition)), body);
                }
                self.otherwise(otherwise);
            }
            StatementKind::Case { selector, arms, otherwise } => {
                self.line(format!("case {}", expr(selector)));
                self.inside(|lines| {
                    for arm in arms {
                        let values: Vec<String> = arm.values.iter().map(case_value).collect();
                        lines.block(format!("of {}", values.join(", ")), &arm.body);
                    }
                    lines.otherwise(otherwise);
                });
            }
            StatementKind::For { variable, start, end, step, body } => {
                let step = step.as_ref().map_or(String::new(), |step| format!(" by {}", expr(step)));
                self.block(format!("for {} := {} to {}{step}", expr(variable), expr(start), expr(end)), body);
            }
            StatementKind::While { condition, body } => self.block(format!("while {}", expr(condition)), body),
            StatementKind::Repeat { body, until } => {
                self.block("repeat", body);
                self.line(format!("until {}", expr(until)));
            }
            StatementKind::Exit => self.line("exit"),
            StatementKind::Continue => self.line("continue"),
            StatementKind::Return(None) => self.line("return"),
            StatementKind::Return(Some(value)) => self.line(format!("return {}", expr(value))),
            StatementKind::Goto(label) => self.line(format!("goto {}", label.text)),
            StatementKind::Pragma(pragma) => self.line(ast_text::pragma_text(pragma)),
            StatementKind::Error => self.line("error"),
        }
    }

    fn otherwise(&mut self, statements: &[Statement]) {
        if !statements.is_empty() {
            self.block("else", statements);
        }
    }
}

fn case_value(value: &CaseValue) -> String {
    match &value.high {
        Some(high) => format!("{}..{}", expr(&value.low), expr(high)),
        None => expr(&value.low),
    }
}

fn name(name: &Name) -> String {
    match name.form {
        NameForm::Bare => name.text.clone(),
        NameForm::Local => format!("#{}", name.text),
        NameForm::Quoted => format!("{:?}", name.text),
    }
}

fn argument(argument: &Argument) -> String {
    let value = argument.value.as_ref().map_or(String::new(), expr);
    match &argument.name {
        Some(formal) if argument.output => format!("{} => {value}", name(formal)).trim_end().to_owned(),
        Some(formal) => format!("{} := {value}", name(formal)).trim_end().to_owned(),
        None => value,
    }
}

fn write_expr(out: &mut String, value: &Expr) {
    match &value.kind {
        ExprKind::Literal(value) => out.push_str(&literal(value)),
        ExprKind::Name(value) => out.push_str(&name(value)),
        ExprKind::Absolute(operand) => out.push_str(&absolute(operand)),
        ExprKind::Member { base, name: member } => {
            write_expr(out, base);
            let _ = write!(out, ".{}", name(member));
        }
        ExprKind::MemberAbsolute { base, width: size, byte, bit } => {
            write_expr(out, base);
            let _ = write!(out, ".%DB{}{byte}", size.letter());
            if *size == Width::Bit {
                let _ = write!(out, ".{bit}");
            }
        }
        ExprKind::Slice { base, width: size, index } => {
            write_expr(out, base);
            let _ = write!(out, ".%{}{index}", size.letter());
        }
        ExprKind::Index { base, indices } => {
            write_expr(out, base);
            let _ = write!(out, "[{}]", indices.iter().map(expr).collect::<Vec<_>>().join(", "));
        }
        ExprKind::Call { callee, arguments } => {
            write_expr(out, callee);
            let _ = write!(out, "({})", arguments.iter().map(argument).collect::<Vec<_>>().join(", "));
        }
        ExprKind::Dereference(base) => {
            write_expr(out, base);
            out.push('^');
        }
        ExprKind::Reference(target) => {
            out.push_str("REF(");
            write_expr(out, target);
            out.push(')');
        }
        ExprKind::Unary { op, operand } => {
            out.push_str(match op {
                UnaryOp::Plus => "(+ ",
                UnaryOp::Minus => "(- ",
                UnaryOp::Not => "(NOT ",
            });
            write_expr(out, operand);
            out.push(')');
        }
        ExprKind::Binary { op, left, right, .. } => {
            out.push('(');
            write_expr(out, left);
            let _ = write!(out, " {} ", op.sign());
            write_expr(out, right);
            out.push(')');
        }
        ExprKind::Error => out.push_str("error"),
    }
}

fn absolute(operand: &OperandKind) -> String {
    match operand {
        OperandKind::Block(BlockName::Numbered { prefix, number, .. }) => format!("%{}{number}", prefix.letters()),
        operand => format!("%{}", ast_text::operand_text(operand).replace(' ', "")),
    }
}

/// Values as a programmer writes them; bits of a type in hexadecimal digits.
pub(crate) fn literal(value: &Literal) -> String {
    let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02X}")).collect::<String>();
    match value {
        Literal::Integer { value, based: false } => value.to_string(),
        Literal::Integer { value, based: true } => format!("16#{value:X}"),
        Literal::Real(value) => format!("{value:?}"),
        Literal::Typed { ty, bits } => format!("{}#16#{bits:X}", ty.name()),
        Literal::Text { bytes, typed } => {
            let text: String = bytes.iter().map(|byte| char::from(*byte)).collect();
            format!("{}{text:?}", if *typed { "STRING#" } else { "TEXT#" })
        }
        Literal::WideText(units) => format!("WSTRING#{:?}", String::from_utf16_lossy(units)),
        Literal::DateAndTime(bytes) => format!("DATE_AND_TIME#{}", hex(bytes)),
        Literal::Dtl(bytes) => format!("DTL#{}", hex(bytes)),
        Literal::Pointer { db, pointer } => format!("P#{db}:{pointer:08X}"),
        Literal::Any(bytes) => format!("ANY#{}", hex(bytes)),
        Literal::Nil => "NIL".to_owned(),
        Literal::Null => "NULL".to_owned(),
    }
}
