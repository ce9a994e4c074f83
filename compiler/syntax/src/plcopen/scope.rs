//! What names in the bodies of a POU stand for.

use std::collections::{HashMap, HashSet};

use crate::ast::{OperandKind, Width};
use crate::scl::ast::{
    AssignOp, BinaryOp, CaseValue, Expr, ExprKind, Name, NameForm, Statement, StatementKind, UnaryOp,
};

/// Flip-flops of IEC 61131-3: SR is set if both inputs are 1, RS is reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlipFlop {
    SetWins,
    ResetWins,
}

/// The names that a POU knows, in lower case.
#[derive(Clone, Default)]
pub struct Scope {
    /// Declared in the POU.
    pub locals: HashSet<String>,
    /// Variables with an address, and the tag that stands for each.
    pub located: HashMap<String, String>,
    /// Variables of the data block of the global ones.
    pub globals: HashSet<String>,
    /// Instances of SR and RS: the BOOL that keeps their state.
    pub flip_flops: HashMap<String, FlipFlop>,
    /// Function blocks of the file that are called by this POU's instances are locals; functions are found by the binder.
    pub global_block: String,
}

impl Scope {
    pub fn statements(&self, list: &mut [Statement]) {
        for statement in list {
            self.statement(&mut statement.kind);
        }
    }

    fn statement(&self, kind: &mut StatementKind) {
        if let StatementKind::Expression(call) = kind
            && let Some(assignment) = self.flip_flop(call)
        {
            *kind = assignment;
        }
        match kind {
            StatementKind::Expression(value) => self.expr(value),
            StatementKind::Assign { targets, value } => {
                targets.iter_mut().for_each(|(target, _)| self.expr(target));
                self.expr(value);
            }
            StatementKind::If { branches, otherwise } => {
                for (condition, body) in branches {
                    self.expr(condition);
                    self.statements(body);
                }
                self.statements(otherwise);
            }
            StatementKind::Case { selector, arms, otherwise } => {
                self.expr(selector);
                for arm in arms {
                    for CaseValue { low, high } in &mut arm.values {
                        self.expr(low);
                        high.iter_mut().for_each(|high| self.expr(high));
                    }
                    self.statements(&mut arm.body);
                }
                self.statements(otherwise);
            }
            StatementKind::For { variable, start, end, step, body } => {
                [variable, start, end].into_iter().chain(step).for_each(|value| self.expr(value));
                self.statements(body);
            }
            StatementKind::While { condition, body } => {
                self.expr(condition);
                self.statements(body);
            }
            StatementKind::Repeat { body, until } => {
                self.statements(body);
                self.expr(until);
            }
            StatementKind::Return(Some(value)) => self.expr(value),
            StatementKind::Empty
            | StatementKind::Label(_)
            | StatementKind::Exit
            | StatementKind::Continue
            | StatementKind::Return(None)
            | StatementKind::Goto(_)
            | StatementKind::Pragma(_)
            | StatementKind::Error => {}
        }
    }

    /// Settles the names of an expression.
    pub fn expr(&self, value: &mut Expr) {
        match &mut value.kind {
            ExprKind::Name(name) if name.form == NameForm::Bare => {
                if let Some(kind) = self.name(name) {
                    value.kind = kind;
                }
            }
            ExprKind::Absolute(operand) => scale(operand),
            ExprKind::Member { base, name } => {
                // The output of a flip-flop is its state.
                let is_state = matches!(&base.kind, ExprKind::Name(base) if self.flip_flops.contains_key(&base.text.to_lowercase()))
                    && (name.text.eq_ignore_ascii_case("Q1") || name.text.eq_ignore_ascii_case("Q"));
                self.expr(base);
                if is_state {
                    value.kind = base.kind.clone();
                }
            }
            ExprKind::MemberAbsolute { base, .. } | ExprKind::Slice { base, .. } => self.expr(base),
            ExprKind::Index { base, indices } => {
                self.expr(base);
                indices.iter_mut().for_each(|index| self.expr(index));
            }
            ExprKind::Call { callee, arguments } => {
                self.expr(callee);
                for argument in arguments {
                    argument.value.iter_mut().for_each(|value| self.expr(value));
                }
            }
            ExprKind::Dereference(base) | ExprKind::Reference(base) => self.expr(base),
            ExprKind::Unary { operand, .. } => self.expr(operand),
            ExprKind::Binary { left, right, .. } => {
                self.expr(left);
                self.expr(right);
            }
            ExprKind::Literal(_) | ExprKind::Name(_) | ExprKind::Error => {}
        }
    }

    /// The call of a flip-flop as the assignment of its state: `s := S1 OR s AND NOT R` or `s := (S OR s) AND NOT R1`.
    fn flip_flop(&self, call: &Expr) -> Option<StatementKind> {
        let ExprKind::Call { callee, arguments } = &call.kind else { return None };
        let ExprKind::Name(name) = &callee.kind else { return None };
        let kind = *self.flip_flops.get(&name.text.to_lowercase())?;
        let span = call.span;
        let expr = |kind: ExprKind| Expr { kind, span };
        let (mut set, mut reset, mut targets) = (None, None, Vec::new());
        for (at, argument) in arguments.iter().enumerate() {
            let formal = argument.name.as_ref().map(|name| name.text.to_ascii_uppercase());
            let value = argument.value.clone();
            match (formal.as_deref(), argument.output, at) {
                (Some("S" | "S1"), false, _) | (None, false, 0) => set = value,
                (Some("R" | "R1"), false, _) | (None, false, 1) => reset = value,
                (Some("Q" | "Q1"), true, _) => targets.extend(value.map(|target| (target, AssignOp::Set))),
                _ => return None,
            }
        }
        let combine = |op, left, right| {
            expr(ExprKind::Binary { op, op_span: span, left: Box::new(left), right: Box::new(right) })
        };
        let set_or = |value: Expr, set: Option<Expr>| match set {
            Some(set) => combine(BinaryOp::Or, set, value),
            None => value,
        };
        let unless_reset = |value: Expr| match reset {
            Some(reset) => {
                let not = expr(ExprKind::Unary { op: UnaryOp::Not, operand: Box::new(reset) });
                combine(BinaryOp::And, value, not)
            }
            None => value,
        };
        let state = (**callee).clone();
        let value = match kind {
            FlipFlop::SetWins => set_or(unless_reset(state.clone()), set),
            FlipFlop::ResetWins => unless_reset(set_or(state.clone(), set)),
        };
        targets.push((state, AssignOp::Set));
        Some(StatementKind::Assign { targets, value })
    }

    fn name(&self, name: &Name) -> Option<ExprKind> {
        let key = name.text.to_lowercase();
        if let Some(tag) = self.located.get(&key) {
            return Some(ExprKind::Name(Name { text: tag.clone(), form: NameForm::Quoted, span: name.span }));
        }
        if self.locals.contains(&key) {
            return Some(ExprKind::Name(Name { form: NameForm::Local, ..name.clone() }));
        }
        if self.globals.contains(&key) {
            let block = Name { text: self.global_block.clone(), form: NameForm::Quoted, span: name.span };
            let base = Box::new(Expr { kind: ExprKind::Name(block), span: name.span });
            return Some(ExprKind::Member { base, name: name.clone() });
        }
        None
    }
}

/// Addresses of IEC count in units of their width: `%MW1` is the second word, MW 2.
fn scale(operand: &mut OperandKind) {
    if let OperandKind::Absolute { width, byte, .. } = operand
        && *width != Width::Bit
    {
        *byte = byte.saturating_mul(width.bytes());
    }
}

/// The address of a located variable as the vendor writes it, `%MW2` for `%MW1`; `None`: none of I, Q and M.
pub fn address(text: &str) -> Option<String> {
    let text = text.trim().strip_prefix('%')?;
    let mut letters = text.chars();
    let area = letters.next()?.to_ascii_uppercase();
    if !matches!(area, 'I' | 'Q' | 'M') {
        return None;
    }
    let rest = letters.as_str();
    let (width, number) = match rest.chars().next()?.to_ascii_uppercase() {
        c @ ('X' | 'B' | 'W' | 'D' | 'L') => (c, &rest[1..]),
        _ => ('X', rest),
    };
    let mut parts = number.split('.').map(str::parse::<u32>);
    let first = parts.next()?.ok()?;
    let second = parts.next().transpose().ok()?;
    if parts.next().is_some() {
        return None;
    }
    match (width, second) {
        ('X', Some(bit)) if bit < 8 => Some(format!("%{area}{first}.{bit}")),
        ('X', None) => Some(format!("%{area}{}.{}", first / 8, first % 8)),
        ('B', None) => Some(format!("%{area}B{first}")),
        ('W', None) => Some(format!("%{area}W{}", first.checked_mul(2)?)),
        ('D', None) => Some(format!("%{area}D{}", first.checked_mul(4)?)),
        _ => None,
    }
}
