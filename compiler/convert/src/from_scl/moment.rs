//! Functions of DTL, and the order of two DTL or of two texts of wide characters, as instructions of STL of an S7-1500.
//!
//! Source: S7-1500 information system, date and time-of-day, string and char.

use plcc_model::scl::{Access, Actual, Call, CompareOp, Complex};
use plcc_model::types::Elementary;
use plcc_syntax::ast::{self, CallType, Operand};
use plcc_syntax::stl::StlInsn;

use super::Maker;

/// Functions of the library, and the instructions with the same parameters.
const FUNCTIONS: [(&str, &str); 3] = [("DTL_TO_DATE", "T_CONV"), ("DTL_TO_TOD", "T_CONV"), ("SUB_DTL_DTL", "T_DIFF")];

/// Functions of the library that return less than 0, 0, or more for two values, and the instructions that compare them.
const ORDERS: [(&str, &str); 2] = [("COMPARE_DTL", "T_COMP"), ("COMPARE_WSTRING", "S_COMP")];

/// The instruction that a function of the library is.
pub fn instruction_of(function: &str) -> Option<&'static str> {
    FUNCTIONS.into_iter().find(|(own, _)| *own == function).map(|(_, instruction)| instruction)
}

impl Maker<'_> {
    /// The RLO is 1 if the order that a function returns is that to 0; false: it is not such a function, or the CPU has no instruction.
    pub fn compare_order(&mut self, op: CompareOp, call: &Call) -> bool {
        let Some(callee) = self.program.block(call.target).filter(|callee| callee.library) else { return false };
        let Some((_, name)) = ORDERS.into_iter().find(|(own, _)| *own == callee.name) else { return false };
        let mut arguments: Vec<_> = call.arguments.iter().collect();
        arguments.sort_by_key(|argument| argument.parameter);
        let variables = arguments.into_iter().filter_map(|argument| match &argument.actual {
            Actual::Complex(Complex::Variable(access)) => Some(access),
            _ => None,
        });
        let variables: Vec<&Access> = variables.collect();
        let [first, second] = variables[..] else { return false };
        if !self.has_instruction(name) || !self.is_direct(first) || !self.is_direct(second) {
            return false;
        }
        let (Some(first), Some(second)) = (self.operand(first), self.operand(second)) else { return true };
        let result = self.temporary(Elementary::Bool);
        let relation = match op {
            CompareOp::Equal => "EQ",
            CompareOp::NotEqual => "NE",
            CompareOp::Less => "LT",
            CompareOp::LessEqual => "LE",
            CompareOp::Greater => "GT",
            CompareOp::GreaterEqual => "GE",
        };
        let types = vec![CallType { name: "relation".to_string(), ty: relation.to_string() }];
        let parameter = |(name, actual): (&str, Operand)| ast::Parameter {
            name: name.to_string(),
            name_span: self.span,
            actual: Some(actual),
        };
        let parameters = [("IN1", first), ("IN2", second), ("OUT", result.clone())].map(parameter).into();
        let call = ast::Call { target: self.named_block(name), types, instance: None, parameters };
        self.push_kind(ast::StatementKind::Call(Box::new(call)));
        self.push(StlInsn::And, Some(result));
        true
    }
}
