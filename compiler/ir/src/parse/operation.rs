//! An instruction, from its name to its last operand.

use plcc_abi::{RuntimeFn, Type};
use thin_vec::ThinVec;

use super::LineResult;
use super::body::FunctionParser;
use super::cursor::{Cursor, type_named};
use crate::entities::{Entity, Value};
use crate::instructions::{BinaryOp, ConvertOp, FloatCc, InstData, IntCc, UnaryOp, Values};

/// Type of a result: known at once, or that of a value that may be defined further down.
#[derive(Clone, Copy)]
pub(super) enum ResultType {
    Known(Type),
    As(Value),
}

/// An instruction as read; values still have the numbers of their first mention.
pub(super) struct Operation {
    pub(super) data: InstData,
    pub(super) results: Vec<ResultType>,
    /// Type of the stored value in the text.
    pub(super) stored: Option<(Value, Type)>,
}

impl FunctionParser<'_> {
    pub(super) fn parse_operation(&mut self, cursor: &mut Cursor) -> LineResult<Operation> {
        let opcode = cursor.word()?;
        let (name, suffix) = match opcode.split_once('.') {
            Some((name, suffix)) => (name, Some(suffix)),
            None => (opcode, None),
        };
        let plain = |data, results: &[ResultType]| Ok(Operation { data, results: results.to_vec(), stored: None });
        if let Some(suffix) = suffix {
            if suffix == "bit" {
                let (addr, bit) = match name {
                    "load" | "store" => self.bit_address(cursor)?,
                    _ => return Err(format!("`{opcode}` is not an instruction")),
                };
                if name == "load" {
                    return plain(InstData::LoadBit { addr, bit }, &[ResultType::Known(Type::I1)]);
                }
                cursor.expect(",")?;
                let value = self.value(cursor)?;
                return plain(InstData::StoreBit { addr, bit, value }, &[]);
            }
            let ty = type_named(suffix)?;
            if let Some(op) = ConvertOp::from_name(name) {
                let arg = self.value(cursor)?;
                return plain(InstData::Convert { op, arg }, &[ResultType::Known(ty)]);
            }
            return match name {
                "const" => {
                    let bits = cursor.number()?;
                    plain(InstData::Const { bits }, &[ResultType::Known(ty)])
                }
                "load" => {
                    let addr = self.address(cursor)?;
                    plain(InstData::Load { addr }, &[ResultType::Known(ty)])
                }
                "store" => {
                    let addr = self.address(cursor)?;
                    cursor.expect(",")?;
                    let value = self.value(cursor)?;
                    let stored = Some((value, ty));
                    Ok(Operation { data: InstData::Store { addr, value }, results: Vec::new(), stored })
                }
                _ => Err(format!("`{opcode}` is not an instruction")),
            };
        }
        if let Some(op) = UnaryOp::from_name(name) {
            let arg = self.value(cursor)?;
            return plain(InstData::Unary { op, arg }, &[ResultType::As(arg)]);
        }
        if let Some(op) = BinaryOp::from_name(name) {
            let args = self.pair(cursor)?;
            return plain(InstData::Binary { op, args }, &[ResultType::As(args[0])]);
        }
        if let Some(cc) = IntCc::from_name(name) {
            let args = self.pair(cursor)?;
            return plain(InstData::IntCompare { cc, args }, &[ResultType::Known(Type::I1)]);
        }
        if let Some(cc) = FloatCc::from_name(name) {
            let args = self.pair(cursor)?;
            return plain(InstData::FloatCompare { cc, args }, &[ResultType::Known(Type::I1)]);
        }
        let i32_result = [ResultType::Known(Type::I32)];
        match name {
            "select" => {
                let cond = self.value(cursor)?;
                cursor.expect(",")?;
                let [if_true, if_false] = self.pair(cursor)?;
                plain(InstData::Select { cond, if_true, if_false }, &[ResultType::As(if_true)])
            }
            "address" => {
                let addr = self.address(cursor)?;
                plain(InstData::AddressOf { addr }, &i32_result)
            }
            "clear" => {
                let addr = self.address(cursor)?;
                cursor.expect(",")?;
                plain(InstData::Clear { addr, len: cursor.number()? }, &[])
            }
            "copy" => {
                let to = self.address(cursor)?;
                cursor.expect(",")?;
                let from = self.address(cursor)?;
                cursor.expect(",")?;
                plain(InstData::Copy { to, from, len: cursor.number()? }, &[])
            }
            "db_base" => {
                let number = self.value(cursor)?;
                plain(InstData::DbBase { number }, &i32_result)
            }
            "db_length" => {
                let number = self.value(cursor)?;
                plain(InstData::DbLength { number }, &i32_result)
            }
            "call" => {
                let callee = self.signatures.find(cursor.function_name()?)?;
                let args = self.arguments(cursor)?;
                let returns = &self.signatures.returns[callee.index()];
                let results: Vec<ResultType> = returns.iter().map(|&ty| ResultType::Known(ty)).collect();
                plain(InstData::Call { callee, args }, &results)
            }
            "rt" => {
                let name = cursor.function_name()?;
                let function = RuntimeFn::ALL.iter().copied().find(|function| function.name() == name);
                let function = function.ok_or_else(|| format!("there is no runtime function @{name}"))?;
                let args = self.arguments(cursor)?;
                let results: Vec<ResultType> = function.result().map(ResultType::Known).into_iter().collect();
                plain(InstData::CallRuntime { function, args }, &results)
            }
            "frame_base" => plain(InstData::FrameBase { callee: false }, &i32_result),
            "callee_frame_base" => plain(InstData::FrameBase { callee: true }, &i32_result),
            "jump" => {
                let target = self.target(cursor)?;
                plain(InstData::Jump { target }, &[])
            }
            "branch" => {
                let cond = self.value(cursor)?;
                cursor.expect(",")?;
                let then_to = self.target(cursor)?;
                cursor.expect(",")?;
                let else_to = self.target(cursor)?;
                plain(InstData::Branch { cond, then_to, else_to }, &[])
            }
            "switch" => {
                let value = self.value(cursor)?;
                cursor.expect("[")?;
                let mut targets = ThinVec::new();
                if !cursor.take("]") {
                    targets.push(self.target(cursor)?);
                    while cursor.take(",") {
                        targets.push(self.target(cursor)?);
                    }
                    cursor.expect("]")?;
                }
                cursor.expect(",")?;
                let default = self.target(cursor)?;
                plain(InstData::Switch { value, targets, default }, &[])
            }
            "ret" => {
                let mut values = Values::new();
                if cursor.starts_entity('v') {
                    values.push(self.value(cursor)?);
                    while cursor.take(",") {
                        values.push(self.value(cursor)?);
                    }
                }
                plain(InstData::Return { values }, &[])
            }
            _ => Err(format!("`{opcode}` is not an instruction")),
        }
    }
}
