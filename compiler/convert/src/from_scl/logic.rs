//! BOOLs in the RLO: nested logic, or step by step where a part takes a jump or a call.

use plcc_model::scl::{BinaryOp, CompareOp, Conversion, Expr, ExprKind, Function, UnaryOp};
use plcc_model::types::Elementary;
use plcc_syntax::ast::{Operand, OperandKind, StatusOperand};
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::value::is_plain;

/// Nestings that a CPU can hold.
const NESTINGS_MAX: usize = 7;

/// How a term joins those before it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Join {
    And,
    Or,
    Xor,
}

/// The instruction that compares two values of a type as they are, if STL has one.
pub fn comparison(op: CompareOp, ty: Elementary) -> Option<StlInsn> {
    use StlInsn as I;
    let int = [I::CompareEqI, I::CompareNeI, I::CompareLtI, I::CompareLeI, I::CompareGtI, I::CompareGeI];
    let dint = [I::CompareEqD, I::CompareNeD, I::CompareLtD, I::CompareLeD, I::CompareGtD, I::CompareGeD];
    let real = [I::CompareEqR, I::CompareNeR, I::CompareLtR, I::CompareLeR, I::CompareGtR, I::CompareGeR];
    let is_order = !matches!(op, CompareOp::Equal | CompareOp::NotEqual);
    let row = match ty {
        Elementary::Int => int,
        Elementary::Dint | Elementary::Time | Elementary::TimeOfDay => dint,
        // Their high bits are 0.
        Elementary::Byte
        | Elementary::Word
        | Elementary::Char
        | Elementary::Wchar
        | Elementary::Usint
        | Elementary::Uint
        | Elementary::Date
        | Elementary::S5Time => dint,
        Elementary::Real => real,
        Elementary::Dword | Elementary::Udint | Elementary::Sint if !is_order => dint,
        Elementary::Bool
        | Elementary::Dword
        | Elementary::Lword
        | Elementary::Sint
        | Elementary::Udint
        | Elementary::Lint
        | Elementary::Ulint
        | Elementary::Lreal
        | Elementary::Ltime
        | Elementary::Ltod
        | Elementary::Ldt => return None,
    };
    Some(match op {
        CompareOp::Equal => row[0],
        CompareOp::NotEqual => row[1],
        CompareOp::Less => row[2],
        CompareOp::LessEqual => row[3],
        CompareOp::Greater => row[4],
        CompareOp::GreaterEqual => row[5],
    })
}

impl Maker<'_> {
    /// Leaves the value of a BOOL in the RLO.
    pub fn condition(&mut self, value: &Expr) {
        if is_plain(value) && nestings(value) <= NESTINGS_MAX {
            return self.sequence(value);
        }
        match &value.kind {
            ExprKind::Unary { op: UnaryOp::Not, operand } => {
                self.condition(operand);
                self.push(StlInsn::Not, None);
            }
            ExprKind::Binary { left, right, .. } => {
                let both = [left, right].map(|side| {
                    self.condition(side);
                    self.keep(Elementary::Bool)
                });
                self.joined(value, both);
            }
            ExprKind::Compare { left, right, .. } if left.ty == Elementary::Bool => {
                let both = [left, right].map(|side| {
                    self.condition(side);
                    self.keep(Elementary::Bool)
                });
                self.joined(value, both);
            }
            ExprKind::Compare { op, left, right } => self.compare(*op, left, right),
            ExprKind::Call(call) => {
                if let Some(result) = self.call(call) {
                    self.push(StlInsn::And, Some(result));
                }
            }
            ExprKind::Convert { conversion: Conversion::ToBool, operand } => self.lowest_bit(operand),
            ExprKind::Function { function: Function::Select, arguments } => self.select(arguments, value),
            ExprKind::Function { function: Function::Mux { has_else }, arguments } => {
                self.multiplex(*has_else, arguments, value);
            }
            ExprKind::Function { function: Function::IsValid, arguments } => self.is_finite(arguments, value),
            ExprKind::Load(access) => {
                if let Some(target) = self.target(access, true) {
                    let operand = self.reach(&target, Elementary::Bool);
                    self.push(StlInsn::And, Some(operand));
                }
            }
            ExprKind::Const(_)
            | ExprKind::Unary { .. }
            | ExprKind::Convert { .. }
            | ExprKind::Function { .. }
            | ExprKind::Timer(_)
            | ExprKind::Counter(_)
            | ExprKind::Cell { .. }
            | ExprKind::Bound { .. }
            | ExprKind::Flag
            | ExprKind::LastEno => self.no_condition(value),
        }
    }

    fn no_condition(&mut self, value: &Expr) {
        self.refuse(value.span, "this condition", "compute it in steps");
    }

    /// An operation whose sides are variables.
    fn joined(&mut self, value: &Expr, [left, right]: [Operand; 2]) {
        let (first, second) = match &value.kind {
            ExprKind::Binary { op: BinaryOp::And, .. } => (StlInsn::And, StlInsn::And),
            ExprKind::Binary { op: BinaryOp::Or, .. } => (StlInsn::Or, StlInsn::Or),
            ExprKind::Binary { op: BinaryOp::Xor, .. } | ExprKind::Compare { op: CompareOp::NotEqual, .. } => {
                (StlInsn::Xor, StlInsn::Xor)
            }
            ExprKind::Compare { op: CompareOp::Equal, .. } => (StlInsn::Xor, StlInsn::XorNot),
            _ => return self.no_condition(value),
        };
        self.push(first, Some(left));
        self.push(second, Some(right));
    }

    /// A whole condition, or one in parentheses: it begins a new sequence of logic.
    fn sequence(&mut self, value: &Expr) {
        match &value.kind {
            ExprKind::Const(bits) => self.push(if *bits == 0 { StlInsn::ClearRlo } else { StlInsn::SetRlo }, None),
            ExprKind::Binary { op, .. } => {
                let join = match op {
                    BinaryOp::And => Join::And,
                    BinaryOp::Or => Join::Or,
                    BinaryOp::Xor => Join::Xor,
                    _ => return self.no_condition(value),
                };
                for term in terms(value, *op) {
                    self.term(term, join, false);
                }
            }
            ExprKind::Compare { op, left, right } if left.ty == Elementary::Bool => {
                let negated = match op {
                    CompareOp::Equal => true,
                    CompareOp::NotEqual => false,
                    CompareOp::Less | CompareOp::LessEqual | CompareOp::Greater | CompareOp::GreaterEqual => {
                        return self.no_condition(value);
                    }
                };
                self.term(left, Join::Xor, false);
                self.term(right, Join::Xor, negated);
            }
            ExprKind::Compare { op, left, right } => self.compare(*op, left, right),
            ExprKind::Convert { conversion: Conversion::ToBool | Conversion::Bits { .. }, operand }
                if operand.ty != Elementary::Bool =>
            {
                self.lowest_bit(operand);
            }
            ExprKind::Unary { op: UnaryOp::Not, operand } if !is_bit(operand) => {
                self.sequence(operand);
                self.push(StlInsn::Not, None);
            }
            ExprKind::Unary { op: UnaryOp::Not, .. }
            | ExprKind::Load(_)
            | ExprKind::Cell { .. }
            | ExprKind::Flag
            | ExprKind::LastEno => self.term(value, Join::And, false),
            ExprKind::Function { function: Function::IsValid, arguments } => self.is_finite(arguments, value),
            ExprKind::Unary { .. }
            | ExprKind::Convert { .. }
            | ExprKind::Call(_)
            | ExprKind::Function { .. }
            | ExprKind::Timer(_)
            | ExprKind::Counter(_)
            | ExprKind::Bound { .. } => self.no_condition(value),
        }
    }

    fn term(&mut self, value: &Expr, join: Join, negated: bool) {
        let (plain, inverse, nest, inverse_nest) = match join {
            Join::And => (StlInsn::And, StlInsn::AndNot, StlInsn::AndNest, StlInsn::AndNotNest),
            Join::Or => (StlInsn::Or, StlInsn::OrNot, StlInsn::OrNest, StlInsn::OrNotNest),
            Join::Xor => (StlInsn::Xor, StlInsn::XorNot, StlInsn::XorNest, StlInsn::XorNotNest),
        };
        if let ExprKind::Unary { op: UnaryOp::Not, operand } = &value.kind {
            return self.term(operand, join, !negated);
        }
        match self.bit(value) {
            Some(operand) => self.push(if negated { inverse } else { plain }, Some(operand)),
            None if matches!(value.kind, ExprKind::Load(_)) => self.no_condition(value),
            None => {
                self.push(if negated { inverse_nest } else { nest }, None);
                self.sequence(value);
                self.push(StlInsn::CloseNest, None);
            }
        }
    }

    /// The operand of a single bit, after what its address needs.
    fn bit(&mut self, value: &Expr) -> Option<Operand> {
        match &value.kind {
            ExprKind::Load(access) => {
                let target = self.target(access, true)?;
                Some(self.reach(&target, Elementary::Bool))
            }
            ExprKind::Cell { kind, number } => self.cell(*kind, number, value.span),
            ExprKind::Flag => self.flag.clone(),
            ExprKind::LastEno => self.last_eno.clone(),
            _ => None,
        }
    }

    fn compare(&mut self, op: CompareOp, left: &Expr, right: &Expr) {
        if let (ExprKind::Call(call), ExprKind::Const(0)) = (&left.kind, &right.kind)
            && self.compare_order(op, call)
        {
            return;
        }
        let is_order = !matches!(op, CompareOp::Equal | CompareOp::NotEqual);
        let insn = match left.ty {
            // `pair` makes DINT of them.
            Elementary::Sint | Elementary::Dword | Elementary::Udint => comparison(op, Elementary::Dint),
            ty => comparison(op, ty),
        };
        let Some(insn) = insn else {
            let what = format!("this comparison of {}", left.ty.name());
            return self.refuse(left.span, what, "compare DINT or REAL");
        };
        self.pair(left, right, !is_order, is_order);
        self.push(insn, None);
    }

    /// `IS_VALID`: the exponent of a REAL that is infinite or not a number is all ones.
    fn is_finite(&mut self, arguments: &[Expr], value: &Expr) {
        const EXPONENT: u32 = 0x7F80_0000;
        let [real] = arguments else { return self.no_condition(value) };
        self.number(real);
        self.dword_constant(StlInsn::AndD, EXPONENT);
        self.dword_constant(StlInsn::Load, EXPONENT);
        self.push(StlInsn::CompareNeD, None);
    }

    /// `INT_TO_BOOL` and the like.
    fn lowest_bit(&mut self, operand: &Expr) {
        self.number(operand);
        self.dword_constant(StlInsn::AndD, 1);
        let not_zero = OperandKind::Status(StatusOperand::Ne0);
        self.push(StlInsn::And, Some(Operand { kind: not_zero, span: self.span }));
    }
}

/// A single bit.
fn is_bit(value: &Expr) -> bool {
    matches!(value.kind, ExprKind::Load(_) | ExprKind::Cell { .. } | ExprKind::Flag | ExprKind::LastEno)
}

/// The sides of operations of one kind.
fn terms(value: &Expr, kind: BinaryOp) -> Vec<&Expr> {
    match &value.kind {
        ExprKind::Binary { op, left, right } if *op == kind && value.ty == Elementary::Bool => {
            let mut all = terms(left, kind);
            all.extend(terms(right, kind));
            all
        }
        _ => vec![value],
    }
}

/// How deep the parentheses of a condition nest.
fn nestings(value: &Expr) -> usize {
    match &value.kind {
        ExprKind::Unary { operand, .. } | ExprKind::Convert { operand, .. } => 1 + nestings(operand),
        ExprKind::Binary { op, .. } if value.ty == Elementary::Bool => {
            1 + terms(value, *op).into_iter().map(nestings).max().unwrap_or(0)
        }
        ExprKind::Compare { left, right, .. } if left.ty == Elementary::Bool => 1 + nestings(left).max(nestings(right)),
        _ => 0,
    }
}
