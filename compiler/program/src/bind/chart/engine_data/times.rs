//! Times T and U of a step, which are counted together as one number.

use plcc_syntax::Elementary;

use super::{Engine, compared};
use crate::bind::chart::build::{assign, number, part_of_element};
use crate::bind::scl::expression::binary_expr;
use plcc_model::scl::{Access, BinaryOp, CompareOp, Conversion, Expr, ExprKind, Statement, StatementKind};

/// The signs of T and U of a step in one number.
pub const SIGNS: u64 = 0x8000_0000_8000_0000;

impl Engine<'_> {
    /// `step`: the time that has passed, once for T and once for U.
    pub fn make_pair(&self) -> Vec<Statement> {
        let passed = || self.widened(self.value("passed"));
        let high = self.both(BinaryOp::ShiftLeft, passed(), self.places(32));
        vec![assign(self.variable("step"), self.both(BinaryOp::Or, high, passed()), self.span)]
    }

    /// The same of the time since `LAST`, of which 31 bits count. Only shifts cut it: a mask would be computed again in each pass of a loop, and all
    /// that depends on it.
    pub fn make_pair_since(&self) -> Vec<Statement> {
        let step = self.variable("step");
        let (now, last) = (self.value("now"), self.value("LAST"));
        let passed = self.widened(binary_expr(BinaryOp::Subtract, now, last, Elementary::Dint, self.span));
        let high = self.both(BinaryOp::ShiftLeft, passed, self.places(33));
        let high = self.both(BinaryOp::ShiftRight, high, self.places(1));
        let low = self.both(BinaryOp::ShiftRight, self.value("step"), self.places(32));
        let both = self.both(BinaryOp::Or, self.value("step"), low);
        vec![assign(step, high, self.span), assign(step, both, self.span)]
    }

    /// `passed`, of `step`.
    pub fn passed_of_pair(&self) -> Statement {
        let passed = self.bits(self.bits(self.value("step"), Elementary::Dword), Elementary::Dint);
        assign(self.variable("passed"), passed, self.span)
    }

    /// A DINT as a number of 64 bits, by way of a bit string, so that the upper half is 0.
    fn widened(&self, value: Expr) -> Expr {
        self.bits(self.bits(value, Elementary::Dword), Elementary::Ulint)
    }

    fn bits(&self, operand: Expr, ty: Elementary) -> Expr {
        let conversion = Conversion::Bits { checked: false };
        Expr { kind: ExprKind::Convert { conversion, operand: Box::new(operand) }, ty, span: self.span }
    }

    fn places(&self, count: u64) -> Expr {
        number(count, Elementary::Dint, self.span)
    }

    /// `both`: T and U of step `k`; `later`: with the time that has passed; `known`: neither is or becomes negative, and U does not stand still.
    pub fn add_pair(&self) -> Vec<Statement> {
        const LA_AND_VA: u64 = 6;
        let loaded = |access: Access, ty| Expr { kind: ExprKind::Load(Box::new(access)), ty, span: self.span };
        let old = loaded(self.times(), Elementary::Ulint);
        let later = self.both(BinaryOp::Add, self.value("both"), self.value("step"));
        let signs = self.both(BinaryOp::Or, self.value("both"), self.value("later"));
        let signs = self.both(BinaryOp::And, signs, number(SIGNS, Elementary::Ulint, self.span));
        let states = part_of_element(self.variable("RAW"), 1, Elementary::Byte, self.value("k"), self.span);
        let states = self.bits(loaded(states, Elementary::Byte), Elementary::Ulint);
        let stops = self.both(BinaryOp::And, states, number(LA_AND_VA, Elementary::Ulint, self.span));
        let obstacles = self.both(BinaryOp::Or, signs, stops);
        vec![
            assign(self.variable("both"), old, self.span),
            assign(self.variable("later"), later, self.span),
            assign(self.variable("known"), compared(CompareOp::Equal, obstacles, 0), self.span),
        ]
    }

    /// `later`: T and U in `both` with the time that has passed, each for itself. What would be negative stays at the end.
    pub fn count_separately(&self) -> Vec<Statement> {
        const UPPER: u64 = 0xFFFF_FFFF_0000_0000;
        let value = |name: &str| self.value(name);
        let and = |value: Expr, mask: u64| self.both(BinaryOp::And, value, number(mask, Elementary::Ulint, self.span));
        let put = |name: &str, value: Expr| assign(self.variable(name), value, self.span);
        let lower = and(self.both(BinaryOp::Add, value("both"), value("step")), !UPPER);
        let upper = self.both(BinaryOp::Add, and(value("both"), UPPER), and(value("step"), UPPER));
        let sign_bits = self.both(BinaryOp::ShiftRight, value("both"), self.places(31));
        let ends = self.both(BinaryOp::Subtract, value("both"), sign_bits);
        vec![
            put("later", self.both(BinaryOp::Or, upper, lower)),
            put("both", and(value("later"), SIGNS)),
            put("later", and(self.both(BinaryOp::Or, value("later"), ends), !SIGNS)),
        ]
    }

    /// Stores `later` as T and U of step `k`.
    pub fn put_pair(&self) -> Vec<Statement> {
        let kind = StatementKind::Assign { target: self.times(), value: self.value("later") };
        vec![Statement { kind, span: self.span }]
    }

    /// T and U of step `k`, which are next to each other, as a number of 64 bits.
    fn times(&self) -> Access {
        part_of_element(self.variable("RAW"), 4, Elementary::Ulint, self.value("k"), self.span)
    }

    fn both(&self, op: BinaryOp, left: Expr, right: Expr) -> Expr {
        binary_expr(op, left, right, Elementary::Ulint, self.span)
    }
}
