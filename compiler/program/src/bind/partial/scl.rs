//! Uses in statements and expressions of SCL; `call` has those in calls.

mod call;

use plcc_syntax::Elementary;
use plcc_syntax::ast::{BlockPrefix, CellKind};
use plcc_syntax::scl::ast::{
    AssignOp, BinaryOp, CaseValue, Expr as Node, ExprKind as NodeKind, Literal, Statement, StatementKind, UnaryOp,
};

use super::evidence::{Hint, is_named, is_unnamed};
use super::look::{Look, Start};
use crate::bind::scl::SclBlock;
use plcc_binding::fold;
use plcc_model::types::DataType;

/// A hint of an elementary type.
pub const fn typed(ty: Elementary) -> Hint {
    Hint::Type(DataType::Elementary(ty))
}

const INT: Hint = Hint::Literal(DataType::Elementary(Elementary::Int));

/// The most certain of some hints.
pub fn surest(hints: impl IntoIterator<Item = Option<Hint>>) -> Option<Hint> {
    let rank = |hint: &Hint| match hint {
        Hint::Type(_) | Hint::Cell(_) | Hint::DataBlock => 0,
        Hint::Width(_) => 1,
        Hint::Literal(_) => 2,
    };
    hints.into_iter().flatten().min_by_key(rank)
}

impl Look<'_, '_> {
    pub fn statements(&mut self, ctx: &mut SclBlock, list: &[Statement]) {
        for statement in list {
            self.statement(ctx, statement);
        }
    }

    fn statement(&mut self, ctx: &mut SclBlock, statement: &Statement) {
        match &statement.kind {
            StatementKind::Expression(node) => match &node.kind {
                NodeKind::Call { callee, arguments } => self.call(ctx, callee, arguments, None, true),
                _ => self.expect(ctx, node, None),
            },
            StatementKind::Assign { targets, value } => self.assignment(ctx, targets, value),
            StatementKind::If { branches, otherwise } => {
                for (condition, body) in branches {
                    self.expect(ctx, condition, Some(&typed(Elementary::Bool)));
                    self.statements(ctx, body);
                }
                self.statements(ctx, otherwise);
            }
            StatementKind::Case { selector, arms, otherwise } => {
                let hint = self.hint_of(ctx, selector);
                let is_text = |value: &CaseValue| matches!(value.low.kind, NodeKind::Literal(Literal::Text { .. }));
                let of_characters = arms.iter().flat_map(|arm| &arm.values).any(is_text);
                let wanted = if of_characters { typed(Elementary::Char) } else { INT };
                self.expect(ctx, selector, Some(&wanted));
                for arm in arms {
                    for value in &arm.values {
                        self.constant_of_arm(ctx, &value.low, hint.as_ref());
                        value.high.iter().for_each(|high| self.constant_of_arm(ctx, high, hint.as_ref()));
                    }
                    self.statements(ctx, &arm.body);
                }
                self.statements(ctx, otherwise);
            }
            StatementKind::For { variable, start, end, step, body } => {
                let hint = self.hint_of(ctx, variable).unwrap_or(INT);
                for node in [variable, start, end].into_iter().chain(step) {
                    self.expect(ctx, node, Some(&hint));
                }
                self.statements(ctx, body);
            }
            StatementKind::While { condition, body } => {
                self.expect(ctx, condition, Some(&typed(Elementary::Bool)));
                self.statements(ctx, body);
            }
            StatementKind::Repeat { body, until } => {
                self.statements(ctx, body);
                self.expect(ctx, until, Some(&typed(Elementary::Bool)));
            }
            StatementKind::Return(Some(value)) => self.expect(ctx, value, Some(&typed(Elementary::Bool))),
            StatementKind::Return(None)
            | StatementKind::Empty
            | StatementKind::Label(_)
            | StatementKind::Exit
            | StatementKind::Continue
            | StatementKind::Goto(_)
            | StatementKind::Pragma(_)
            | StatementKind::Error => {}
        }
    }

    fn assignment(&mut self, ctx: &mut SclBlock, targets: &[(Node, AssignOp)], value: &Node) {
        let of_value = self.hint_of(ctx, value);
        let of_targets: Vec<Option<Hint>> = targets.iter().map(|(target, _)| self.hint_of(ctx, target)).collect();
        let wanted = surest(of_targets.iter().cloned());
        if of_value.is_none() {
            self.expect(ctx, value, wanted.as_ref());
        }
        self.structure(ctx, value, wanted.as_ref());
        let condition = is_condition(value).then(|| typed(Elementary::Bool));
        let given = surest([of_value, wanted]).or(condition);
        for ((target, _), known) in targets.iter().zip(of_targets) {
            if known.is_none() {
                self.expect(ctx, target, given.as_ref());
            }
            self.structure(ctx, target, given.as_ref());
        }
    }

    /// Teaches a place its type as a whole, if that is a structure: components that are used show only what they are themselves. One
    /// without a name counts only where no components are used.
    fn structure(&mut self, ctx: &mut SclBlock, node: &Node, hint: Option<&Hint>) {
        if let Some(Hint::Type(ty)) = hint
            && (is_named(ty) || is_unnamed(ty))
            && let Some((start, steps, span)) = self.steps(ctx, node)
        {
            self.with_shape(ctx, &start, &steps, span, &mut |shape| {
                if is_named(ty) || shape.members.is_empty() && shape.elements.is_none() {
                    shape.learn(hint);
                }
            });
        }
    }

    /// A value of an arm, which must be a constant.
    fn constant_of_arm(&mut self, ctx: &mut SclBlock, node: &Node, hint: Option<&Hint>) {
        let known = self.quietly(|program| program.globals.constant(&ctx.block.bound.constants, node).is_some());
        if !known {
            let own =
                matches!(&node.kind, NodeKind::Name(name) if ctx.block.bound.locals.contains_key(&fold(&name.text)));
            if !own {
                self.constant_names(node, hint);
            }
        }
    }

    /// Examines an expression that should have the type `hint`.
    pub fn expect(&mut self, ctx: &mut SclBlock, node: &Node, hint: Option<&Hint>) {
        if ctx.scope.depth >= crate::bind::scl::message::DEPTH_MAX {
            return;
        }
        ctx.scope.depth += 1;
        self.expect_inner(ctx, node, hint);
        ctx.scope.depth -= 1;
    }

    fn expect_inner(&mut self, ctx: &mut SclBlock, node: &Node, hint: Option<&Hint>) {
        match &node.kind {
            NodeKind::Literal(_) | NodeKind::Error => {}
            NodeKind::Name(_)
            | NodeKind::Absolute(_)
            | NodeKind::Member { .. }
            | NodeKind::MemberAbsolute { .. }
            | NodeKind::Slice { .. }
            | NodeKind::Index { .. } => {
                // Steps also examine indices.
                let place = self.steps(ctx, node);
                let known = self.hint_of(ctx, node);
                if let Some((start, steps, span)) = place
                    && (known.is_none() || steps.is_empty() && self.is_of_type(&start, hint))
                {
                    self.note(ctx, &start, &steps, span, hint);
                }
            }
            NodeKind::Call { callee, arguments } => self.call(ctx, callee, arguments, hint, false),
            NodeKind::Dereference(base) | NodeKind::Reference(base) => self.expect(ctx, base, None),
            NodeKind::Unary { op, operand } => {
                let bool = typed(Elementary::Bool);
                let hint = match op {
                    UnaryOp::Not => Some(hint.unwrap_or(&bool)),
                    UnaryOp::Plus | UnaryOp::Minus => hint,
                };
                self.expect(ctx, operand, hint);
            }
            NodeKind::Binary { .. } => self.chain(ctx, node, hint),
        }
    }

    /// Whether a missing data block is used where a structure with a name is expected: then it is of that type.
    fn is_of_type(&self, start: &Start, hint: Option<&Hint>) -> bool {
        let is_missing = |(prefix, number): (BlockPrefix, u16)| {
            prefix == BlockPrefix::Db && !self.program.globals.sources.data.contains_key(&number)
        };
        matches!(hint, Some(Hint::Type(ty)) if is_named(ty))
            && self.meant(start).and_then(|meant| meant.numbered()).is_some_and(is_missing)
    }

    /// Operators in a row, all of one kind.
    fn chain(&mut self, ctx: &mut SclBlock, node: &Node, hint: Option<&Hint>) {
        let NodeKind::Binary { op, .. } = &node.kind else { return };
        let group = group(*op);
        let mut operands = Vec::new();
        let mut at = node;
        while let NodeKind::Binary { op, left, right, .. } = &at.kind
            && self::group(*op) == group
        {
            operands.push((Some(*op), &**right));
            at = left;
        }
        operands.push((None, at));
        operands.reverse();
        let hints: Vec<Option<Hint>> = operands.iter().map(|(_, operand)| self.hint_of(ctx, operand)).collect();
        if hints.iter().all(Option::is_some) {
            return;
        }
        let known = surest(hints.iter().cloned());
        let wanted = match group {
            Group::Compare => known,
            Group::Logic => surest([known, hint.cloned()]).or(Some(typed(Elementary::Bool))),
            Group::Number => surest([hint.cloned(), known]),
        };
        for ((op, operand), known) in operands.into_iter().zip(hints) {
            if known.is_some() {
                continue;
            }
            let is_time = matches!(
                &wanted,
                Some(Hint::Type(DataType::Elementary(Elementary::Time | Elementary::Ltime | Elementary::S5Time)))
            );
            // A time is multiplied with numbers.
            match op {
                Some(BinaryOp::Multiply | BinaryOp::Divide) if is_time => self.expect(ctx, operand, Some(&INT)),
                _ => self.expect(ctx, operand, wanted.as_ref()),
            }
        }
    }
}

/// The hint for a parameter's type; a type that accepts anything has none.
pub fn parameter_hint(ty: &DataType) -> Option<Hint> {
    use plcc_model::types::ParameterType;
    match ty {
        DataType::Parameter(ParameterType::Timer) => Some(Hint::Cell(CellKind::Timer)),
        DataType::Parameter(ParameterType::Counter) => Some(Hint::Cell(CellKind::Counter)),
        DataType::Parameter(ParameterType::BlockDb) => Some(Hint::DataBlock),
        DataType::Parameter(_) | DataType::Void => None,
        DataType::OpenArray(array) => {
            let bounds = vec![(0, 9); usize::from(array.dimensions)];
            let bytes = u32::try_from(plcc_model::layout::array_bytes(&bounds, &array.element)).ok()?;
            let array = plcc_model::types::ArrayType { bounds, element: array.element.clone(), bytes };
            Some(Hint::Type(DataType::Array(std::rc::Rc::new(array))))
        }
        ty => Some(Hint::Type(ty.clone())),
    }
}

/// Whether an expression is a BOOL whatever the types of its operands are: there is a comparison in it.
fn is_condition(node: &Node) -> bool {
    match &node.kind {
        NodeKind::Unary { op: UnaryOp::Not, operand } => is_condition(operand),
        NodeKind::Binary { op, left, right, .. } => match group(*op) {
            Group::Compare => true,
            Group::Logic => is_condition(left) || is_condition(right),
            Group::Number => false,
        },
        _ => false,
    }
}

/// Operators that need the same type on both sides.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Group {
    Compare,
    Logic,
    Number,
}

const fn group(op: BinaryOp) -> Group {
    match op {
        BinaryOp::Less
        | BinaryOp::Greater
        | BinaryOp::LessEqual
        | BinaryOp::GreaterEqual
        | BinaryOp::Equal
        | BinaryOp::NotEqual => Group::Compare,
        BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => Group::Logic,
        BinaryOp::Power
        | BinaryOp::Multiply
        | BinaryOp::Divide
        | BinaryOp::DivideInteger
        | BinaryOp::Modulo
        | BinaryOp::Add
        | BinaryOp::Subtract => Group::Number,
    }
}
