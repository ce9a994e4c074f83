//! Bodies in IL (instruction list) as statements.
//!
//! The current result is kept as an expression until something uses it:
//!
//! ```text
//! LD  a
//! AND(
//! LD  b          Lamp := a AND (b OR c);
//! OR  c
//! )
//! ST  Lamp
//! ```
//!
//! Jumps and labels become those of SCL. Where the result is used after a label, each path to the label puts it into a variable of the
//! label. After CAL there is no current result: IEC 61131-3 leaves it undefined.
//!
//! - `lines`: the lines of the text; `labels`: jumps and labels; here: operators and calls.

mod labels;
mod lines;

use std::collections::HashMap;
use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Span};
use roxmltree::Node;

use super::interface::elements;
use super::types::{self, Ty};
use super::{Body, Reader, functions};
use labels::Merged;
pub use lines::without_comments;
use lines::{Line, lines, split};
use plcc_syntax::scl::ast::{
    Argument, AssignOp, BinaryOp, Expr, ExprKind, Name, NameForm, Statement, StatementKind, UnaryOp,
};

/// Most open parentheses.
const DEPTH_MAX: usize = 100;

/// Words of other instruction lists, in capitals, and the operators of IL that they mean.
const OTHER_WORDS: &[(&str, &str)] = &[
    ("LOAD L", "LD"),
    ("LOADN LDI", "LDN"),
    ("STORE T", "ST"),
    ("STOREN", "STN"),
    ("SET", "S"),
    ("RESET RST", "R"),
    ("A U", "AND"),
    ("AN UN ANDNOT", "ANDN"),
    ("O", "OR"),
    ("ON ORNOT", "ORN"),
    ("X", "XOR"),
    ("XN", "XORN"),
    ("CALL", "CAL"),
    ("JUMP JU SPA", "JMP"),
    ("JC SPB", "JMPC"),
    ("JCN SPBN", "JMPCN"),
    ("BE BEU BEA", "RET"),
    ("BEC BEB", "RETC"),
];

/// Reads the IL body of a POU.
pub fn read(reader: &mut Reader, body: &mut Body, node: Node) -> Vec<Statement> {
    let Some(range) = reader.text_range(elements(node).next().unwrap_or(node)) else { return Vec::new() };
    super::pragma::clear(reader.file, reader.editor, &mut reader.overlay, range.clone(), &mut reader.messages);
    let text = without_comments(reader.overlay.get(range.clone()).unwrap_or_default());
    let lines = lines(&text, range.start);
    let mut list = List {
        reader,
        body,
        text: &text,
        start: range.start,
        result: None,
        kind: None,
        reached: true,
        merged: HashMap::new(),
        open: Vec::new(),
        statements: Vec::new(),
    };
    list.merge_at_labels(&lines);
    for (at, line) in lines.iter().enumerate() {
        let kept = lines[at + 1..].iter().find(|line| line.operator.is_some() || line.label.is_some());
        let kept = kept.is_some_and(|next| next.label.is_none() && !list.begins_anew(next));
        list.line(line, kept);
    }
    if let Some(open) = list.open.pop() {
        list.refuse(open.span, "the parenthesis is not closed", "close it with `)` on a separate line");
    }
    list.declare_merged();
    list.statements
}

struct List<'r, 'a, 'b> {
    reader: &'r mut Reader<'a>,
    body: &'b mut Body,
    /// The text without comments; it begins at byte `start` of the file.
    text: &'r str,
    start: usize,
    result: Option<Expr>,
    /// The type of the result, as far as it is known.
    kind: Option<Ty>,
    /// The previous line continues to this one.
    reached: bool,
    /// Labels after which the result is used, in lower case.
    merged: HashMap<String, Merged>,
    open: Vec<Open>,
    statements: Vec<Statement>,
}

/// An operator before an open parenthesis, with the result before it.
struct Open {
    op: BinaryOp,
    not: bool,
    before: Option<Expr>,
    kind: Option<Ty>,
    span: Span,
}

impl List<'_, '_, '_> {
    fn slice(&self, range: &Range<usize>) -> &str {
        self.text.get(range.start - self.start..range.end - self.start).unwrap_or_default()
    }

    /// The line does not need the result before it.
    fn begins_anew(&self, line: &Line) -> bool {
        let Some(operator) = &line.operator else { return true };
        let word = self.slice(operator).to_ascii_uppercase();
        matches!(self.meant(&word).unwrap_or(&word), "LD" | "LDN" | "CAL" | "JMP" | "RET")
    }

    /// The operator that a word of other instruction lists means; a POU of the project may have this name.
    fn meant(&self, word: &str) -> Option<&'static str> {
        let (_, meant) = OTHER_WORDS.iter().find(|(other, _)| other.split(' ').any(|other| other == word))?;
        (!self.body.scope.shared.pous.contains(&word.to_lowercase())).then_some(*meant)
    }

    fn refuse(&mut self, span: Span, text: &str, help: &str) {
        self.reader.messages.push(Diagnostic::new(Code::ForeignContent, span, text).help(help));
    }

    fn push(&mut self, kind: StatementKind, span: Span) {
        self.statements.push(Statement { kind, span });
    }

    /// `kept`: the result is needed after this line, too.
    fn line(&mut self, line: &Line, kept: bool) {
        if let Some(label) = &line.label {
            self.label(label);
        }
        let Some(operator) = line.operator.clone() else { return };
        let span = self.reader.span(operator.clone());
        let mut word = self.slice(&operator).to_ascii_uppercase();
        if word == ")" {
            return self.close(span);
        }
        if let Some(meant) = self.meant(&word) {
            let written = format!("{meant} {}", self.slice(&line.operand).trim());
            let title = format!("`{}` is not an operator of IL", self.slice(&operator));
            let told = Diagnostic::new(Code::ForeignForm, span, title).label("a word of other instruction lists");
            self.reader.messages.push(told.help(format!("write `{}`", written.trim_end())));
            word = meant.to_string();
        }
        match word.as_str() {
            "LD" | "LDN" => {
                let value = self.operand(line, span);
                self.kind = value.as_ref().and_then(|(_, kind)| kind.clone());
                self.result = value.map(|(value, _)| negated(value, word == "LDN"));
            }
            "ST" | "STN" => self.store(line, word == "STN", span),
            "S" | "R" => self.set(line, word == "S", kept, span),
            "JMP" | "JMPC" | "JMPCN" => self.jump(line, &word, kept, span),
            "RET" | "RETC" | "RETCN" => {
                self.conditional(&word, kept, vec![StatementKind::Return(None)], span);
                self.reached &= word != "RET";
            }
            "CAL" | "CALC" | "CALCN" => self.call(line, &word, kept, span),
            "NOT" if line.operand.is_empty() => match self.result.take() {
                Some(value) => self.result = Some(negated(value, true)),
                None => self.no_result(span),
            },
            "S1" | "R1" | "CLK" | "CU" | "CD" | "PV" | "IN" | "PT" | "LD1" if !self.body.scope.is_own(&word) => {
                self.input(line, &word, span);
            }
            _ => match binary(&word) {
                Some((op, not)) => self.operator(line, op, not, span),
                None => self.function(line, &operator, span),
            },
        }
    }

    fn no_result(&mut self, span: Span) {
        let help = "begin with LD; the result is undefined after a label or CAL";
        self.refuse(span, "there is no current result here", help);
    }

    fn taken(&mut self, span: Span) -> Option<Expr> {
        let value = self.result.take();
        if value.is_none() {
            self.no_result(span);
        }
        value
    }

    fn operand(&mut self, line: &Line, span: Span) -> Option<(Expr, Option<Ty>)> {
        if self.slice(&line.operand).trim().is_empty() {
            self.refuse(span, "an operator without its operand", "write the operand after it");
            return None;
        }
        Some(self.reader.typed_expression(line.operand.clone(), &self.body.scope))
    }

    /// Puts the result into a separate BOOL, so it can be used twice.
    fn kept_result(&mut self, span: Span) -> Option<Expr> {
        let value = self.taken(span)?;
        if matches!(value.kind, ExprKind::Literal(_)) {
            self.result = Some(value.clone());
            return Some(value);
        }
        let name = Name { text: self.body.hidden_name("result", span), form: NameForm::Local, span };
        let hidden = Expr { kind: ExprKind::Name(name), span };
        self.push(StatementKind::Assign { targets: vec![(hidden.clone(), AssignOp::Set)], value }, span);
        self.result = Some(hidden.clone());
        Some(hidden)
    }

    fn condition(&mut self, not: bool, kept: bool, span: Span) -> Option<Expr> {
        let value = if kept { self.kept_result(span) } else { self.taken(span) };
        value.map(|value| negated(value, not))
    }

    fn store(&mut self, line: &Line, not: bool, span: Span) {
        let (Some(value), Some((target, kind))) = (self.taken(span), self.operand(line, span)) else { return };
        let value = negated(value, not);
        self.kind = kind.or(self.kind.take());
        self.push(StatementKind::Assign { targets: vec![(target.clone(), AssignOp::Set)], value }, span);
        self.result = Some(negated(target, not));
    }

    fn set(&mut self, line: &Line, value: bool, kept: bool, span: Span) {
        let (Some(condition), Some((target, _))) = (self.condition(false, kept, span), self.operand(line, span)) else {
            return;
        };
        let literal =
            plcc_syntax::scl::ast::Literal::Typed { ty: plcc_syntax::Elementary::Bool, bits: u64::from(value) };
        let value = Expr { kind: ExprKind::Literal(literal), span };
        let kind = StatementKind::Assign { targets: vec![(target, AssignOp::Set)], value };
        self.when(condition, vec![Statement { kind, span }], span);
    }

    fn when(&mut self, condition: Expr, body: Vec<Statement>, span: Span) {
        self.push(StatementKind::If { branches: vec![(condition, body)], otherwise: Vec::new() }, span);
    }

    /// Statements that depend on the result because of C or CN after the operator.
    fn conditional(&mut self, word: &str, kept: bool, kinds: Vec<StatementKind>, span: Span) {
        let body: Vec<Statement> = kinds.into_iter().map(|kind| Statement { kind, span }).collect();
        if !word.ends_with('C') && !word.ends_with("CN") {
            return self.statements.extend(body);
        }
        if let Some(condition) = self.condition(word.ends_with('N'), kept, span) {
            self.when(condition, body, span);
        }
    }

    /// `CAL Timer(IN := a, PT := T#1s)`, `CAL Timer`
    fn call(&mut self, line: &Line, word: &str, kept: bool, span: Span) {
        let body = match self.slice(&line.operand).contains('(') {
            true => self.reader.statements(line.operand.clone(), self.body),
            false => {
                let Some((callee, _)) = self.operand(line, span) else { return };
                let kind = ExprKind::Call { callee: Box::new(callee), arguments: Vec::new() };
                vec![Statement { kind: StatementKind::Expression(Expr { kind, span }), span }]
            }
        };
        let always = !word.ends_with("C") && !word.ends_with("CN");
        self.conditional(word, kept, body.into_iter().map(|statement| statement.kind).collect(), span);
        if always {
            self.result = None;
        }
    }

    /// `IN Timer`: the result is an input of a call.
    fn input(&mut self, line: &Line, formal: &str, span: Span) {
        let (Some(value), Some((callee, _))) = (self.taken(span), self.operand(line, span)) else { return };
        let name = Some(Name { text: formal.to_string(), form: NameForm::Bare, span });
        let arguments = vec![Argument { name, output: false, value: Some(value), span }];
        let call = Expr { kind: ExprKind::Call { callee: Box::new(callee), arguments }, span };
        self.push(StatementKind::Expression(call), span);
    }

    fn operator(&mut self, line: &Line, op: BinaryOp, not: bool, span: Span) {
        let operand = self.slice(&line.operand);
        if let Some(inner) = operand.trim_start().strip_prefix('(')
            && !operand.trim_end().ends_with(')')
        {
            let at = line.operand.start + operand.len() - operand.trim_start().len() + 1;
            let inner = at..at + inner.len();
            if self.open.len() >= DEPTH_MAX {
                return self.refuse(span, "parentheses are nested too deeply", "store a part in a variable");
            }
            let before = self.taken(span);
            let kind = self.kind.take();
            self.open.push(Open { op, not, before, kind, span });
            let inner = Line { label: None, operator: None, operand: inner };
            if !self.slice(&inner.operand).trim().is_empty()
                && let Some((value, kind)) = self.operand(&inner, span)
            {
                (self.result, self.kind) = (Some(value), kind);
            }
            return;
        }
        if let (Some(left), Some((right, kind))) = (self.taken(span), self.operand(line, span)) {
            self.combine(op, (left, self.kind.clone()), (negated(right, not), kind), span);
        }
    }

    fn close(&mut self, span: Span) {
        let Some(open) = self.open.pop() else {
            return self.refuse(span, "`)` closes nothing", "write the operator with `(` before it");
        };
        if let (Some(left), Some(right)) = (open.before, self.taken(span)) {
            let kind = self.kind.take();
            self.combine(open.op, (left, open.kind), (negated(right, open.not), kind), open.span);
        }
    }

    /// The result is `left op right`.
    fn combine(&mut self, op: BinaryOp, (left, a): (Expr, Option<Ty>), (right, b): (Expr, Option<Ty>), span: Span) {
        let mut told = Vec::new();
        let rewritten =
            functions::operation(op, span, (&left, &a), (&right, &b), span, &mut |message| told.push(message));
        self.reader.messages.append(&mut told);
        self.kind = types::operation(op, a.as_ref(), b.as_ref());
        self.result = Some(match rewritten {
            Some(kind) => Expr { kind, span },
            None => combined(op, left, right, span),
        });
    }

    /// A function: the result is its first argument, unless all arguments are in parentheses.
    fn function(&mut self, line: &Line, operator: &Range<usize>, span: Span) {
        if self.slice(&line.operand).trim_start().starts_with('(') {
            let whole = operator.start..line.operand.end;
            let (value, kind) = self.reader.typed_expression(whole, &self.body.scope);
            (self.result, self.kind) = (Some(value), kind);
            return;
        }
        let Some(first) = self.taken(span) else { return };
        let (mut values, mut kinds) = (vec![first], vec![self.kind.take()]);
        for range in split(self.slice(&line.operand), line.operand.start) {
            let (value, kind) = self.reader.typed_expression(range, &self.body.scope);
            values.push(value);
            kinds.push(kind);
        }
        let argument = |value: Expr| Argument { name: None, output: false, span: value.span, value: Some(value) };
        let arguments: Vec<Argument> = values.into_iter().map(argument).collect();
        let name = Name { text: self.slice(operator).to_string(), form: NameForm::Bare, span };
        self.kind = self.body.scope.shared.types.result(&name.text.to_ascii_uppercase(), &kinds);
        let (editor, messages) = (self.reader.editor, &mut self.reader.messages);
        let mut tell = |message| messages.push(message);
        let standard = match self.body.scope.is_own(&name.text) {
            true => None,
            false => functions::rewritten(editor, &name, &arguments, &kinds, span, &mut tell),
        };
        let callee = Box::new(Expr { kind: ExprKind::Name(name), span });
        let kind = standard.unwrap_or(ExprKind::Call { callee, arguments });
        self.result = Some(Expr { kind, span });
    }
}

fn negated(value: Expr, not: bool) -> Expr {
    let span = value.span;
    match not {
        true => Expr { kind: ExprKind::Unary { op: UnaryOp::Not, operand: Box::new(value) }, span },
        false => value,
    }
}

fn combined(op: BinaryOp, left: Expr, right: Expr, span: Span) -> Expr {
    Expr { kind: ExprKind::Binary { op, op_span: span, left: Box::new(left), right: Box::new(right) }, span }
}

/// The operator of a word, and whether it negates its operand.
fn binary(word: &str) -> Option<(BinaryOp, bool)> {
    Some(match word {
        "AND" | "&" => (BinaryOp::And, false),
        "ANDN" | "&N" => (BinaryOp::And, true),
        "OR" => (BinaryOp::Or, false),
        "ORN" => (BinaryOp::Or, true),
        "XOR" => (BinaryOp::Xor, false),
        "XORN" => (BinaryOp::Xor, true),
        "ADD" => (BinaryOp::Add, false),
        "SUB" => (BinaryOp::Subtract, false),
        "MUL" => (BinaryOp::Multiply, false),
        "DIV" => (BinaryOp::Divide, false),
        "MOD" => (BinaryOp::Modulo, false),
        "GT" => (BinaryOp::Greater, false),
        "GE" => (BinaryOp::GreaterEqual, false),
        "EQ" => (BinaryOp::Equal, false),
        "NE" => (BinaryOp::NotEqual, false),
        "LE" => (BinaryOp::LessEqual, false),
        "LT" => (BinaryOp::Less, false),
        _ => return None,
    })
}
