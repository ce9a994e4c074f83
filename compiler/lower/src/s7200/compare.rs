//! Compare contacts. Source: S7-200 system manual, compare instructions.

use plcc_abi::s7200::{Operation, error, fatal};
use plcc_ir::{BinaryOp, FloatCc, IntCc, Type, Value};
use plcc_model::s7200::{Compare, CompareKind, Contact, Operand, Relation, Width};
use plcc_model::scl::CompareOp;

use super::block::{OnError, S7200Lowering};
use super::operand::Use;
use crate::arithmetic::compare::{self, float_condition, integer_condition};

impl S7200Lowering<'_, '_> {
    /// `LDW>=` and other compare contacts. Both operands are read with any S0; a bad pointer stops the CPU.
    pub fn compare(&mut self, compare: Compare, operands: &[Operand]) {
        let [left, right] = operands else { return };
        self.on_error = OnError::Stop;
        let op = operator(compare.relation);
        let value = match compare.kind {
            CompareKind::Byte => self.compare_integers(integer_condition(op, false), left, right, Width::Byte),
            CompareKind::Word => self.compare_integers(integer_condition(op, true), left, right, Width::Word),
            CompareKind::Dword => self.compare_integers(integer_condition(op, true), left, right, Width::Dword),
            CompareKind::Real => self.compare_reals(float_condition(op), left, right),
            CompareKind::Text => self.compare_texts(compare.relation, left, right),
        };
        self.count_contact(value);
        match compare.contact {
            Contact::Load => self.push(value),
            Contact::And => self.combine(BinaryOp::And, value),
            Contact::Or => self.combine(BinaryOp::Or, value),
        }
    }

    fn compare_integers(&mut self, cc: IntCc, left: &Operand, right: &Operand, width: Width) -> Value {
        let (left, right) = (self.read(left, width), self.read(right, width));
        self.b.icmp(cc, left, right)
    }

    /// A NaN makes the result 0, and is error 000F; with strict comparison it stops the CPU.
    fn compare_reals(&mut self, cc: FloatCc, left: &Operand, right: &Operand) -> Value {
        let (left, right) = (self.read(left, Width::Dword), self.read(right, Width::Dword));
        let (left, right) = (self.b.bitcast(Type::F32, left), self.b.bitcast(Type::F32, right));
        let holds = compare::floats(&mut self.b, cc, left, right);
        let unordered = self.b.fcmp(FloatCc::Uno, left, right);
        let ordered = self.b.not(unordered);
        if self.plan.program.config.s7200.strict_compare {
            self.error_unless(ordered, error::ILLEGAL_REAL, fatal::COMPARE_REAL);
        } else {
            self.on_error = OnError::Skip;
            self.guarded(|lowering| lowering.error_unless(ordered, error::ILLEGAL_REAL, fatal::COMPARE_REAL));
        }
        holds
    }

    fn compare_texts(&mut self, relation: Relation, left: &Operand, right: &Operand) -> Value {
        let (left, right) = (self.operand_address(left, Use::Read), self.operand_address(right, Use::Read));
        let result = self.run_raw(Operation::StringEqual, &[left, right]);
        self.stop_if_told(result);
        let equal = self.value_of(result);
        self.b.icmp_imm(if relation == Relation::Eq { IntCc::Ne } else { IntCc::Eq }, equal, 0)
    }
}

const fn operator(relation: Relation) -> CompareOp {
    match relation {
        Relation::Eq => CompareOp::Equal,
        Relation::Ne => CompareOp::NotEqual,
        Relation::Ge => CompareOp::GreaterEqual,
        Relation::Le => CompareOp::LessEqual,
        Relation::Gt => CompareOp::Greater,
        Relation::Lt => CompareOp::Less,
    }
}
