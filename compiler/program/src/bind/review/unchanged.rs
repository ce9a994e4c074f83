//! Loops in SCL that change nothing in their condition: `WHILE i < 10` without an assignment to `i`.
//!
//! Only conditions of temporary and static data and of the process image of inputs count, in loops that call nothing and that no statement
//! leaves.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::walk::{self, Role, Visitor};
use plcc_model::scl::{Access, BinaryOp, Call, Expr, ExprKind, Statement, StatementKind, UnaryOp};

use super::region::{Bits, Region};
use super::same::is_more_than_variables;
use crate::bind::scl::leaves;

/// Reports the loops in `list` and in the lists inside it. `text`: what is written at a place.
pub fn review(list: &[Statement], text: &dyn Fn(Span) -> String, found: &mut Vec<Diagnostic>) {
    for statement in list {
        let parts = match &statement.kind {
            StatementKind::While { condition, body } => Some((condition, body, "TRUE")),
            StatementKind::Repeat { body, until } => Some((until, body, "FALSE")),
            _ => None,
        };
        if let Some((condition, body, goes_on)) = parts
            && !has_word(condition)
            && !body.iter().any(leaves)
            && let Some((first, is_input)) = unchanged(condition, body)
        {
            let first = text(first);
            let help = match is_input {
                true => format!(
                    "inputs are read before each cycle: write IF, and look at `{first}` in the next cycle again"
                ),
                false => format!("assign to `{first}` in the loop, or leave it with EXIT"),
            };
            found.push(
                Diagnostic::new(Code::NothingLeaves, condition.span, "nothing in this loop changes its condition")
                    .label(format!("once it is {goes_on}, it stays so"))
                    .help(help),
            );
        }
        statement.kind.bodies().into_iter().for_each(|body| review(body, text, found));
    }
}

/// Whether TRUE or FALSE decides a condition, which has a message of its own.
fn has_word(condition: &Expr) -> bool {
    match &condition.kind {
        ExprKind::Const(_) => true,
        ExprKind::Binary { op: BinaryOp::And | BinaryOp::Or | BinaryOp::Xor, left, right } => {
            has_word(left) || has_word(right)
        }
        ExprKind::Unary { op: UnaryOp::Not, operand } => has_word(operand),
        _ => false,
    }
}

/// The first variable of the condition, and whether it is an input, if nothing in `body` changes one of them.
fn unchanged(condition: &Expr, body: &[Statement]) -> Option<(Span, bool)> {
    let mut reads = Reads::default();
    walk::expr(condition, &mut reads);
    let (bits, first) = *reads.places.first().filter(|_| !reads.is_open)?;
    let mut changes = Changes { places: &reads.places, found: false };
    walk::statements(body, &mut changes);
    (!changes.found).then_some((first, bits.region == Region::I))
}

/// What a condition reads.
#[derive(Default)]
struct Reads {
    places: Vec<(Bits, Span)>,
    /// It depends on something else as well.
    is_open: bool,
}

impl Visitor for Reads {
    fn expr(&mut self, value: &Expr) {
        self.is_open |= is_more_than_variables(value);
    }

    fn access(&mut self, access: &Access, _role: Role) {
        match Bits::of(access) {
            Some(bits) if matches!(bits.region, Region::L | Region::Instance | Region::I) => {
                self.places.push((bits, access.span))
            }
            _ => self.is_open = true,
        }
    }
}

/// Looks for a statement that may change one of some places.
struct Changes<'r> {
    places: &'r [(Bits, Span)],
    found: bool,
}

impl Changes<'_> {
    fn written(&mut self, target: &Access) {
        self.found |= match Bits::of(target) {
            // Another name may stand for static data.
            Some(bits) => self.places.iter().any(|(place, _)| match (place.region, bits.region) {
                (a, b) if a == b => place.first < bits.end && bits.first < place.end,
                (Region::Instance, Region::I | Region::Q | Region::M | Region::L) => false,
                (Region::I, Region::Parameter(_) | Region::ThroughPointer(_)) => true,
                (a, _) => a == Region::Instance,
            }),
            None => true,
        };
    }
}

impl Visitor for Changes<'_> {
    fn statement(&mut self, statement: &Statement) {
        statement.kind.target().into_iter().for_each(|target| self.written(target));
        self.found |= matches!(
            statement.kind,
            StatementKind::Call(_)
                | StatementKind::Goto(_)
                | StatementKind::Label(_)
                | StatementKind::Sleep(_)
                | StatementKind::Stl(_)
        );
    }

    fn expr(&mut self, value: &Expr) {
        self.found |= matches!(value.kind, ExprKind::Call(_) | ExprKind::Timer(_) | ExprKind::Counter(_));
    }

    fn call(&mut self, _call: &Call) {
        self.found = true;
    }
}
