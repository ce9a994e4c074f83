//! Actions for steps, transitions and rows.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Span};

use crate::gr7::messages::{self, State};
use crate::gr7::pragma;
use crate::gr7::qualifier;
use crate::gr7::token::Mark;
use crate::gr7::tree::{Clause, Head, Item, Part};
use plcc_syntax::chart::ast::{
    Action, ActionBody, Coil, Condition, Permanent, PermanentKind, Qualifier, Step, Transition,
};
use plcc_syntax::scl::ast::{BinaryOp, Expr, ExprKind, Name};

/// Builds a step from its parts.
pub fn step<'a>(
    state: &mut State<'a>,
    initial: bool,
    head: Head,
    items: Vec<Item<'a>>,
    range: Range<usize>,
) -> Part<'a> {
    let mut step = Step {
        name: head.name,
        number: 0,
        initial,
        actions: Vec::new(),
        interlock: None,
        supervision: None,
        maximum: None,
        warning: None,
        comment: Vec::new(),
        span: state.span(range),
    };
    for item in items {
        match item {
            Item::Comment(text) => step.comment.extend(pragma::lines(text)),
            Item::Interlock(condition, span) => keep(state, &mut step.interlock, condition, span, "interlock"),
            Item::Supervision(condition, span) => keep(state, &mut step.supervision, condition, span, "supervision"),
            Item::Action(action) => step.actions.push(action),
        }
    }
    Part::Step(step, head.number)
}

/// Builds a transition from its clauses.
pub fn transition<'a>(state: &mut State<'a>, head: Head, clauses: Vec<Clause<'a>>, range: Range<usize>) -> Part<'a> {
    let mut transition = Transition {
        name: head.name,
        number: 0,
        from: Vec::new(),
        to: Vec::new(),
        jump: false,
        path: Vec::new(),
        condition: None,
        missing: false,
        comment: Vec::new(),
        span: state.span(range),
    };
    for clause in clauses {
        match clause {
            Clause::Comment(text) => transition.comment.extend(pragma::lines(text)),
            Clause::From(names) => steps(state, &mut transition.from, names, "FROM"),
            Clause::To(names, jump) => {
                steps(state, &mut transition.to, names, "TO");
                transition.jump |= jump;
            }
            Clause::Condition(condition, span) => keep(state, &mut transition.condition, condition, span, "condition"),
            Clause::Error => {}
        }
    }
    Part::Transition(transition, head.number)
}

/// Keeps the steps of the first of several clauses `word`.
fn steps(state: &mut State, before: &mut Vec<Name>, names: Vec<Name>, word: &str) {
    let (Some(first), Some(second)) = (place_of(before), place_of(&names)) else { return before.extend(names) };
    let written: Vec<&str> = before.iter().chain(&names).map(|name| &state.text[name.span.range()]).collect();
    let written = written.join(", ");
    let help = match word {
        "FROM" => {
            format!("write `FROM ({written})` if all these steps are before the transition, TO for those after it")
        }
        _ => format!("write `TO ({written})` if all these steps are after the transition, FROM for those before it"),
    };
    state.report(
        Diagnostic::new(Code::Syntax, second, format!("a second {word}"))
            .label("there is already one")
            .also(first, "the first one")
            .help(help),
    );
}

fn place_of(names: &[Name]) -> Option<Span> {
    Some(names.first()?.span.to(names.last()?.span))
}

/// Keeps the first of several conditions.
fn keep(state: &mut State, place: &mut Option<Condition>, condition: Option<Condition>, span: Span, what: &str) {
    if let Some(before) = place {
        let before = match before {
            Condition::Expression(Expr { span, .. }) => *span,
            Condition::Network(network) => network.span,
            Condition::Statements(_) => span,
        };
        return state.report(
            Diagnostic::new(Code::Syntax, span, format!("a second {what}"))
                .label("there is already one")
                .also(before, "the first one")
                .help("join both with AND or OR"),
        );
    }
    *place = condition;
}

/// A row. A row that was reported is kept as an error.
pub fn action(
    state: &mut State,
    body: Option<ActionBody>,
    mark: Option<Mark>,
    comment: Option<&str>,
    start: usize,
    qualifier: Range<usize>,
) -> Action {
    let end = qualifier.end;
    let comment = match comment {
        Some(text) => Some(pragma::lines(text).join(" ")).filter(|text| !text.is_empty()),
        None => messages::comment_after(state.text, state.comments, end),
    };
    let (body, mark) = match (body, mark) {
        (Some(body), Some(mark)) if is_action(state, &body) && is_assigned(state, &body, mark, qualifier.clone()) => {
            (body, mark)
        }
        _ => (ActionBody::Error, Mark { event: None, qualifier: Qualifier::N, interlock: false }),
    };
    Action {
        event: mark.event,
        qualifier: mark.qualifier,
        interlock: mark.interlock,
        qualifier_span: state.span(qualifier),
        body,
        comment,
        span: state.span(start..end),
    }
}

/// Whether the operand of the row is a variable; other operands are reported.
fn is_action(state: &mut State, body: &ActionBody) -> bool {
    let (ActionBody::Operand(operand) | ActionBody::Value { operand, .. }) = body else { return true };
    is_variable(state, operand, Code::ActionText)
}

/// Whether `:=` is before the value of an N row, which is not a time or a count as in other rows; reports that it is missing. `place`: where
/// the mark is.
fn is_assigned(state: &mut State, body: &ActionBody, mark: Mark, place: Range<usize>) -> bool {
    let ActionBody::Value { operand, value } = body else { return true };
    let all = state.text;
    let text = |start: u32, end: u32| all.get(start as usize..end as usize).unwrap_or_default();
    if mark.qualifier != Qualifier::N || text(operand.span.end, value.span.start).contains(":=") {
        return true;
    }
    let first = operand.span;
    let (operand, source) = (text(operand.span.start, operand.span.end), text(value.span.start, value.span.end));
    let mark = all.get(place).unwrap_or_default();
    // `ON Run (N)`
    let is_operand = matches!(
        value.kind,
        ExprKind::Name(_) | ExprKind::Absolute(_) | ExprKind::Member { .. } | ExprKind::Index { .. }
    );
    if is_operand && qualifier::parse(operand).is_some() {
        let event = if qualifier::needs_event(operand) { "S1 " } else { "" };
        state.report(
            Diagnostic::new(Code::Qualifier, first, format!("the instruction `{operand}` is before its operand"))
                .label("the instruction comes last, in parentheses")
                .help(format!("write `{source} ({event}{operand})`")),
        );
        return false;
    }
    let title = format!("`:=` is missing between `{operand}` and `{source}`");
    state.report(
        Diagnostic::new(Code::Syntax, value.span, title)
            .label("a second operand")
            .help(format!("write `{operand} := {source} {mark}`, or each operand in a row of its own")),
    );
    false
}

/// Whether the expression can be written to; one that is not an operand is reported.
fn is_variable(state: &mut State, operand: &Expr, code: Code) -> bool {
    let help = match &operand.kind {
        ExprKind::Name(_)
        | ExprKind::Absolute(_)
        | ExprKind::Member { .. }
        | ExprKind::MemberAbsolute { .. }
        | ExprKind::Slice { .. }
        | ExprKind::Index { .. }
        | ExprKind::Dereference(_) => return true,
        // Reported where it was read.
        ExprKind::Error => return false,
        ExprKind::Binary { op: BinaryOp::Equal, left, right, .. } => {
            let slice = |expr: &Expr| state.text.get(expr.span.range()).unwrap_or_default();
            let help = format!("write `{} := {}`", slice(left), slice(right));
            let message = Diagnostic::new(code, operand.span, "a value is assigned with `:=`").label("compares");
            state.report(message.help(help));
            return false;
        }
        _ => "write an address, a symbol, or a step before the qualifier, and a value after `:=`",
    };
    state.report(
        Diagnostic::new(code, operand.span, "this is not an operand").label("nothing can be written to it").help(help),
    );
    false
}

/// A permanent instruction with a coil. An instruction that was reported is left out.
pub fn permanent(
    state: &mut State,
    operand: Expr,
    coil: Option<Coil>,
    value: Expr,
    range: Range<usize>,
) -> Option<Permanent> {
    let coil = coil.filter(|_| is_variable(state, &operand, Code::Syntax))?;
    Some(Permanent { kind: PermanentKind::Coil { operand, coil, value }, span: state.span(range) })
}

/// A row that could not be read.
pub fn no_action(state: &mut State, range: Range<usize>) -> Action {
    let (start, end) = (range.start, range.end);
    action(state, None, None, None, start, end..end)
}
