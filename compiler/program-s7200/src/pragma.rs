//! Pragmas between statements.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::article::with_article;
use plcc_syntax::ast::{Pragma, Side as WrittenSide, Width};
use plcc_syntax::front::pragma::sleep_help;
use plcc_syntax::s7200::ast::{Area, Assert, AssertSide, Constant as Written};

use super::Binder;
use super::constant::whole;
use super::interface::Locals;
use super::operand::{memory, place};
use super::settle::Settled;
use plcc_binding::assertion::{self, Literal, Side, Type, What};
use plcc_binding::constant::Constant;
use plcc_binding::pragma::{bad_pragma, split, unknown_pragma};
use plcc_model::ComparedValue;
use plcc_model::s7200 as model;
use plcc_model::s7200::StatementKind;

impl Binder<'_> {
    pub fn statement_pragma(
        &mut self,
        locals: &Locals,
        pragma: &Pragma,
        assert: Option<&Assert>,
    ) -> Option<StatementKind> {
        if !self.input.pragmas {
            return None;
        }
        let (word, rest) = split(&pragma.text);
        match word {
            // If it is not a valid `assert LHS OP RHS`, the parser has reported it.
            "assert" => self.assert(locals, pragma, assert?),
            "sleep" => match rest.parse::<u32>() {
                Ok(milliseconds) => Some(StatementKind::Sleep(milliseconds)),
                Err(_) => {
                    let title = "`sleep` needs a number of milliseconds";
                    bad_pragma(&mut self.report, pragma.span, title, &sleep_help(rest));
                    None
                }
            },
            // Those of the whole file, which the file lists separately.
            "cpu" | "test" => None,
            _ if word.starts_with('^') => None,
            _ => {
                unknown_pragma(&mut self.report, pragma);
                None
            }
        }
    }

    fn assert(&mut self, locals: &Locals, pragma: &Pragma, written: &Assert) -> Option<StatementKind> {
        let mut comparisons = Vec::new();
        for comparison in &written.comparisons {
            let left = self.assert_side(locals, &comparison.left);
            let right = self.assert_side(locals, &comparison.right);
            let (left, right) = (left?, right?);
            match assertion::compare(assertion::op(comparison.op), left, right) {
                Ok(comparison) => comparisons.push(comparison),
                Err(mismatch) => {
                    self.push(mismatch.message());
                    return None;
                }
            }
        }
        let condition = assertion::condition(&written.condition);
        let trap = assertion::is_trap(&condition, &comparisons);
        Some(StatementKind::Assert(model::Assert { condition, comparisons, trap, text: pragma.text.clone() }))
    }

    fn assert_side(&mut self, locals: &Locals, written: &WrittenSide<AssertSide>) -> Option<Side<model::AssertSide>> {
        let span = written.span;
        let ty = match &written.ty {
            Some((word, at)) => match Type::from_word(word) {
                Some(ty @ Type::Elementary(_)) if ty.width() <= 32 => Some((ty, *at)),
                _ => {
                    let title = format!("`{word}` is not a type of values of up to 32 bits");
                    bad_pragma(&mut self.report, *at, &title, "write e.g. `as INT`, `as DINT`, `as REAL` or `as TIME`");
                    return None;
                }
            },
            None => None,
        };
        let (side, width) = match &written.value {
            AssertSide::Stack(level @ 0..=8) => (model::AssertSide::Stack(*level), Width::Bit),
            AssertSide::Stack(_) => return None,
            AssertSide::Eno => (model::AssertSide::Eno, Width::Bit),
            AssertSide::Operand(operand) => match self.settle(locals, operand, false)? {
                Settled::Constant(constant) => return self.literal_side(literal_of(&constant), ty, span),
                Settled::Pointer(value) => {
                    return self.literal_side(Literal { constant: None, loaded: Some(value.into()) }, ty, span);
                }
                settled @ (Settled::Direct(_) | Settled::StringVariable(_)) => {
                    let (operand, width) = self.plain(settled, operand.span)?;
                    (model::AssertSide::Operand(operand), width)
                }
                Settled::Indirect(_) | Settled::Block(_) => {
                    bad_pragma(
                        &mut self.report,
                        operand.span,
                        "this has no value of up to 32 bits",
                        "name an address, a symbol, a constant, AC0 to AC3, S0 to S8 of the logic stack, or ENO",
                    );
                    return None;
                }
            },
        };
        let accumulator = matches!(side, model::AssertSide::Operand(model::Operand::Accumulator { .. }));
        let bits = width.bits() as u8;
        if let Some((ty, at)) = ty
            && (ty.width() > bits || ty.width() < bits && !accumulator)
        {
            let title = format!("the address has {bits} bits, {} has {}", with_article(ty.name()), ty.width());
            bad_pragma(&mut self.report, at, &title, "name an address of the width of the type: `VW10 as INT`");
            return None;
        }
        let width = ty.map_or(bits, |(ty, _)| ty.width());
        let what = What::Value { value: ComparedValue::Code(side), ty: ty.map(|(ty, _)| ty), width };
        Some(Side { what, span })
    }

    fn literal_side(
        &mut self,
        literal: Literal,
        ty: Option<(Type, Span)>,
        span: Span,
    ) -> Option<Side<model::AssertSide>> {
        let Some((ty, _)) = ty else { return Some(Side { what: What::Literal(literal), span }) };
        match assertion::typed_literal(&literal, ty, span) {
            Ok(side) => Some(side),
            Err(mismatch) => {
                self.push(mismatch.message());
                None
            }
        }
    }

    /// The operand that the pragma at `span` compares, with its width.
    fn plain(&mut self, settled: Settled, span: Span) -> Option<(model::Operand, Width)> {
        let direct = match settled {
            Settled::Direct(direct) => direct,
            Settled::StringVariable(pointer) => return Some((memory(pointer, Width::Dword)?, Width::Dword)),
            _ => return None,
        };
        let width = match (direct.area, direct.width) {
            (_, Some(width)) => width,
            (Area::T | Area::C, None) => Width::Bit,
            (Area::Ai | Area::Aq, None) => Width::Word,
            (_, None) => Width::Dword,
        };
        self.check_range(direct, width, 1, span)?;
        Some((place(direct, width), width))
    }
}

/// A constant whose bits depend on the width of the other side.
fn literal_of(written: &Written) -> Literal {
    let constant = match written {
        Written::Integer(value) => Constant::Integer { value: i128::from(*value), based: false },
        Written::Bits { value, .. } => Constant::Integer { value: i128::from(*value), based: true },
        Written::Real(value) => Constant::Real(f64::from(*value)),
        Written::Bool(value) => Constant::Typed { ty: Elementary::Bool, bits: u64::from(*value) },
        Written::Characters(bytes) | Written::Text(bytes) => Constant::Text { bytes: bytes.clone(), typed: false },
    };
    let loaded = match written {
        Written::Integer(_) | Written::Real(_) | Written::Text(_) => None,
        Written::Bool(value) => Some(u64::from(*value)),
        Written::Bits { .. } | Written::Characters(_) => whole(written).and_then(|value| u64::try_from(value).ok()),
    };
    Literal { constant: Some(constant), loaded }
}
