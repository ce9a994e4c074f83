//! Labels that no jump names and statements that are never reached, in the typed tree.

use plcc_diag::{Code, Diagnostic, SourceMap, Span};
use plcc_model::scl::{BinaryOp, Expr, ExprKind, SclBody, Statement, StatementKind, UnaryOp, walk};
use plcc_model::{LabelId, Operand, StlStatementKind};
use rustc_hash::FxHashSet;

use super::stl::unused_label;

/// Reports the labels of a block that no jump names.
pub fn labels(body: &SclBody, sources: &SourceMap, found: &mut Vec<Diagnostic>) {
    let mut labels = Labels::default();
    walk::statements(&body.statements, &mut labels);
    let unused = labels.defined.iter().filter(|(label, _)| !labels.used.contains(label));
    found.extend(unused.map(|(_, span)| unused_label(*span, sources)));
}

#[derive(Default)]
struct Labels {
    defined: Vec<(LabelId, Span)>,
    used: FxHashSet<LabelId>,
}

impl walk::Visitor for Labels {
    fn statement(&mut self, statement: &Statement) {
        match &statement.kind {
            StatementKind::Label(label) => self.defined.push((*label, statement.span)),
            StatementKind::Goto(label) => {
                self.used.insert(*label);
            }
            StatementKind::Stl(stl) => match &stl.kind {
                StlStatementKind::Label(label) => self.defined.push((*label, stl.span)),
                StlStatementKind::Instruction { operand: Operand::Label(label), .. } => {
                    self.used.insert(*label);
                }
                StlStatementKind::JumpList { targets, default } => self.used.extend(targets.iter().chain([default])),
                StlStatementKind::Instruction { .. }
                | StlStatementKind::Call(_)
                | StlStatementKind::Assert(_)
                | StlStatementKind::Sleep(_) => {}
            },
            _ => {}
        }
    }
}

/// Reports statements that no path reaches. `name`: of the block, which is the place of what no source contains; `is_text`: the block
/// is in SCL, where a condition may be written as a constant.
pub fn unreachable(body: &SclBody, name: Span, is_text: bool, sources: &SourceMap, found: &mut Vec<Diagnostic>) {
    let mut review = Reached { name, is_text, sources, found };
    review.list(&body.statements);
}

struct Reached<'r> {
    name: Span,
    is_text: bool,
    sources: &'r SourceMap,
    found: &'r mut Vec<Diagnostic>,
}

impl Reached<'_> {
    /// True if no path reaches the end of the list.
    fn list(&mut self, list: &[Statement]) -> bool {
        // The statement after which none is reached.
        let mut end: Option<Span> = None;
        let mut told = false;
        for statement in list {
            match &statement.kind {
                StatementKind::Label(_) => (end, told) = (None, false),
                // Its parts are instructions; the block in STL has its own review.
                StatementKind::Stl(_) => (end, told) = (None, false),
                StatementKind::Assert(_) | StatementKind::Sleep(_) => {}
                _ => {
                    if let Some(leaves) = end
                        && !std::mem::replace(&mut told, true)
                    {
                        self.never(statement.span, leaves, "the program goes on elsewhere");
                    }
                    if self.statement(statement) {
                        end.get_or_insert(statement.span);
                    }
                }
            }
        }
        end.is_some()
    }

    fn never(&mut self, span: Span, reason: Span, text: &str) {
        // `EN := TRUE` of a call is a part of it.
        let is_part = span.file == reason.file && span.start <= reason.start && reason.end <= span.end;
        if span == self.name || is_part {
            return;
        }
        self.found.push(
            Diagnostic::new(Code::UnreachableCode, span, "this statement is never reached")
                .label("no path leads here")
                .also(reason, text)
                .help(match text {
                    EMPTY_RANGE => "a loop counts up unless it has a negative step, as `BY -1`: look at its values",
                    _ => "remove it, or look at the condition that should lead here",
                }),
        );
    }

    /// True if the statement after this one is not reached through it.
    fn statement(&mut self, statement: &Statement) -> bool {
        match &statement.kind {
            StatementKind::Exit | StatementKind::Continue | StatementKind::Return(_) | StatementKind::Goto(_) => true,
            StatementKind::If { branches, otherwise } => {
                let mut all_leave = true;
                let mut decided: Option<Span> = None;
                for (condition, body) in branches {
                    match (decided, self.written(condition)) {
                        (Some(reason), _) => self.body_is_never_reached(body, reason, "this condition is always TRUE"),
                        (None, Some(false)) => {
                            self.body_is_never_reached(body, condition.span, "this condition is always FALSE");
                        }
                        (None, Some(true)) => decided = Some(condition.span),
                        (None, None) => {}
                    }
                    all_leave &= self.list(body);
                }
                if let Some(reason) = decided {
                    self.body_is_never_reached(otherwise, reason, "this condition is always TRUE");
                }
                let otherwise = self.list(otherwise);
                all_leave && otherwise
            }
            StatementKind::Case { arms, otherwise, .. } => {
                let mut all_leave = true;
                for arm in arms {
                    all_leave &= self.list(&arm.body);
                }
                let otherwise = self.list(otherwise);
                all_leave && otherwise
            }
            StatementKind::For { start, end, step, body, .. } => {
                let told = self.counts_down(start.span, end.span) || self.is_cut(start) || self.is_cut(end);
                if self.is_text && never_runs(start, end, step) && !told {
                    self.body_is_never_reached(body, start.span.to(end.span), EMPTY_RANGE);
                }
                self.list(body);
                false
            }
            StatementKind::While { condition, body } => {
                if self.written(condition) == Some(false) {
                    self.body_is_never_reached(body, condition.span, "this condition is always FALSE");
                }
                self.list(body);
                false
            }
            StatementKind::Repeat { body, .. } => {
                self.list(body);
                false
            }
            StatementKind::Assign { .. }
            | StatementKind::AssignText { .. }
            | StatementKind::Copy { .. }
            | StatementKind::SetFlag(_)
            | StatementKind::Failed
            | StatementKind::Watch(_)
            | StatementKind::Call(_)
            | StatementKind::Evaluate(_)
            | StatementKind::Label(_)
            | StatementKind::Assert(_)
            | StatementKind::Sleep(_)
            | StatementKind::Apart
            | StatementKind::Stl(_) => false,
        }
    }

    fn body_is_never_reached(&mut self, body: &[Statement], reason: Span, text: &str) {
        let is_real =
            |statement: &&Statement| !matches!(statement.kind, StatementKind::Assert(_) | StatementKind::Sleep(_));
        // A jump may lead to a label in it.
        if walk::find(body, &|one| matches!(one.kind, StatementKind::Label(_)).then_some(())).is_some() {
            return;
        }
        if let Some(first) = body.iter().find(is_real) {
            self.never(first.span, reason, text);
        }
    }

    /// A condition that is written as TRUE or FALSE, or that such a word decides, as `a AND FALSE`. A named constant may have another value
    /// in the next version.
    fn written(&self, condition: &Expr) -> Option<bool> {
        let value = match &condition.kind {
            ExprKind::Const(value) => *value,
            ExprKind::Binary { op: op @ (BinaryOp::And | BinaryOp::Or), left, right } if condition.ty.bits() == 1 => {
                // What decides alone.
                let word = *op == BinaryOp::Or;
                return match (self.written(left), self.written(right)) {
                    (Some(one), _) | (_, Some(one)) if one == word => Some(word),
                    (Some(_), Some(_)) => Some(!word),
                    _ => None,
                };
            }
            ExprKind::Unary { op: UnaryOp::Not, operand } => return self.written(operand).map(|value| !value),
            _ => return None,
        };
        let span = condition.span;
        let text = self.sources.file(span.file).text.get(span.start as usize..span.end as usize)?;
        let is_word = self.is_text && (text.eq_ignore_ascii_case("TRUE") || text.eq_ignore_ascii_case("FALSE"));
        is_word.then_some(value != 0)
    }

    /// A number that its type cannot hold, of which the low bits are left. It was reported.
    fn is_cut(&self, limit: &Expr) -> bool {
        let span = limit.span;
        let text = self.sources.file(span.file).text.get(span.start as usize..span.end as usize);
        let written = text.and_then(|text| text.replace('_', "").parse::<i128>().ok());
        written.is_some() && known(limit).is_some_and(|value| written != Some(value))
    }

    /// `10 DOWNTO 1`, which was reported.
    fn counts_down(&self, start: Span, end: Span) -> bool {
        let text = &self.sources.file(start.file).text;
        let between = text.get(start.end as usize..end.start as usize).filter(|_| start.file == end.file);
        between.is_some_and(|between| between.split_whitespace().any(|word| word.eq_ignore_ascii_case("DOWNTO")))
    }
}

/// Why a FOR with these limits never runs.
const EMPTY_RANGE: &str = "no value lies between these";

/// The number that a constant is.
pub(super) fn known(expr: &Expr) -> Option<i128> {
    match expr.kind {
        ExprKind::Const(bits) if expr.ty.is_signed() => {
            let unused = 64 - expr.ty.bits().clamp(1, 64);
            Some(i128::from((bits << unused) as i64 >> unused))
        }
        ExprKind::Const(bits) => Some(i128::from(bits)),
        _ => None,
    }
}

/// True if the limits are known and the first value is beyond the last one.
fn never_runs(start: &Expr, end: &Expr, step: &Expr) -> bool {
    match (known(start), known(end), known(step)) {
        (Some(start), Some(end), Some(step)) => (step > 0 && start > end) || (step < 0 && start < end),
        _ => false,
    }
}
