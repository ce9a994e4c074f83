//! Results that a library function writes into the target of an assignment itself, without an intermediate buffer.
//!
//! Texts: the maximum length of the target counts, not the longest STRING, so that a result that is too long is an error of the
//! function. Numbers: FC 37 to FC 39 write nothing if the text has no number, and the target does not change.
//! Source: STL reference, IEC function library; SCL reference, explicit conversions.

use plcc_abi::image::BlockKind;
use plcc_stdlib::{BlockClass, Form, Language, SystemBlock};

use plcc_model::BlockKey;
use plcc_model::scl::{Access, Actual, Argument, Call, Complex, ExprKind, StatementKind};
use plcc_model::types::DataType;

use super::call::is_result;
use super::value::Value;
use crate::bind::scl::SclBinder;

impl SclBinder<'_, '_> {
    /// The call that writes `value` to `target` itself; otherwise returns the value.
    pub(super) fn result_in_place(&mut self, target: &Access, value: Value) -> Result<StatementKind, Value> {
        if target.part.is_some() {
            return Err(value);
        }
        match (&target.ty, value) {
            (
                DataType::String(_),
                Value::Complex { value: Complex::Call(call), ty: ty @ DataType::String(_), span },
            ) if self.writes_texts(call.target) => match self.call_into(&call, Actual::Reference(target.clone())) {
                Some(statement) => Ok(statement),
                None => Err(Value::Complex { value: Complex::Call(call), ty, span }),
            },
            (DataType::Elementary(ty), Value::Elementary(expr)) if expr.ty == *ty => match &expr.kind {
                ExprKind::Call(call) if self.may_write_nothing(call.target) => {
                    let actual = Actual::Variable { access: target.clone(), back: None };
                    self.call_into(call, actual).ok_or(Value::Elementary(expr))
                }
                _ => Err(Value::Elementary(expr)),
            },
            (_, value) => Err(value),
        }
    }

    fn call_into(&mut self, call: &Call, actual: Actual) -> Option<StatementKind> {
        // A call that EN skips has an empty result.
        if call.enable.is_some() {
            return None;
        }
        let bound = self.program.interface(call.target, call.span)?;
        let parameter = bound.interface.parameters.iter().position(|formal| is_result(call.target, formal))?;
        let mut call = call.clone();
        call.arguments.push(Argument { parameter, actual, span: call.span });
        Some(StatementKind::Call(Box::new(call)))
    }

    /// Those in SCL do not clear ENO if the target is too short: the assignment after the call does.
    fn writes_texts(&self, key: BlockKey) -> bool {
        let function = matches!(key.kind, BlockKind::Fc | BlockKind::Sfc);
        let clears_eno = |block: &SystemBlock| block.form == Form::Source && block.language == Language::Stl;
        function && self.program.globals.library_block(key).is_some_and(clears_eno)
    }

    /// FC 37 STRNG_DI, FC 38 STRNG_I, FC 39 STRNG_R.
    fn may_write_nothing(&self, key: BlockKey) -> bool {
        self.program
            .globals
            .library_block(key)
            .is_some_and(|block| block.class == BlockClass::Fc && (37..=39).contains(&block.number))
    }
}
