//! Assertion pragmas.

use plcc_diag::Span;
use plcc_syntax::article::with_article;
use plcc_syntax::ast::{self, Pragma, Width};
use plcc_syntax::front::pragma::sleep_help;

use crate::bind::declarations::block::CurrentBlock;
use crate::bind::stl::StlBinder;
use crate::bind::stl::settle::Settled;
use plcc_binding::assertion::{self, Literal, Side, Type, What};
use plcc_binding::constant::Constant;
use plcc_binding::pragma::{bad_pragma, file_pragma, split, unknown_pragma};
use plcc_binding::value;
use plcc_model::types::{DTL, DataType, Elementary};
use plcc_model::{Assert, AssertSide, CellKind, ComparedValue, Operand, Place, StlStatementKind, TestSettings};

impl StlBinder<'_, '_> {
    /// The settings of all files for tests.
    pub fn file_pragmas(&mut self) -> TestSettings {
        let mut settings = TestSettings::default();
        if self.program.globals.input.pragmas {
            for (_, unit) in self.program.globals.input.units {
                for pragma in &unit.pragmas {
                    self.file_pragma(pragma, &mut settings);
                }
            }
        }
        settings
    }

    /// A pragma between statements.
    pub fn statement_pragma(&mut self, ctx: &mut CurrentBlock, pragma: &Pragma) -> Option<StlStatementKind> {
        if !self.program.globals.input.pragmas {
            return None;
        }
        let (word, rest) = split(&pragma.text);
        match word {
            "assert" => self.assert(ctx, pragma),
            "sleep" => match rest.parse::<u32>() {
                Ok(milliseconds) => Some(StlStatementKind::Sleep(milliseconds)),
                Err(_) => {
                    self.bad_pragma(pragma.span, "`sleep` needs a number of milliseconds", &sleep_help(rest));
                    None
                }
            },
            // Those of the whole file, which the file lists separately.
            "cpu" | "test" => None,
            _ if word.starts_with('^') => None,
            _ => {
                self.unknown_pragma(pragma);
                None
            }
        }
    }

    /// A pragma of the whole file.
    pub fn file_pragma(&mut self, pragma: &Pragma, settings: &mut TestSettings) {
        file_pragma(&mut self.program.globals.report, pragma, settings);
    }

    fn unknown_pragma(&mut self, pragma: &Pragma) {
        unknown_pragma(&mut self.program.globals.report, pragma);
    }

    fn bad_pragma(&mut self, span: Span, title: &str, help: &str) {
        bad_pragma(&mut self.program.globals.report, span, title, help);
    }

    fn assert(&mut self, ctx: &mut CurrentBlock, pragma: &Pragma) -> Option<StlStatementKind> {
        // One that is not a valid assertion was reported by the parser.
        let written = pragma.assert.as_ref()?;
        let mut comparisons = Vec::new();
        for comparison in &written.comparisons {
            let left = self.assert_side(ctx, &comparison.left);
            let right = self.assert_side(ctx, &comparison.right);
            let (left, right) = (left?, right?);
            match assertion::compare(assertion::op(comparison.op), left, right) {
                Ok(comparison) => comparisons.push(comparison),
                Err(mismatch) => {
                    self.program.report(mismatch.message());
                    return None;
                }
            }
        }
        let condition = assertion::condition(&written.condition);
        let trap = assertion::is_trap(&condition, &comparisons);
        Some(StlStatementKind::Assert(Box::new(Assert { condition, comparisons, trap, text: pragma.text.clone() })))
    }

    fn assert_side(
        &mut self,
        ctx: &mut CurrentBlock,
        written: &ast::Side<ast::AssertSide>,
    ) -> Option<Side<AssertSide>> {
        let span = written.span;
        let ty = match &written.ty {
            Some((word, at)) => match Type::from_word(word) {
                Some(ty) => Some((ty, *at)),
                None => {
                    let title = format!("`{word}` is not a type of values");
                    self.bad_pragma(*at, &title, "write e.g. `as INT`, `as DINT`, `as REAL` or `as TIME`");
                    return None;
                }
            },
            None => None,
        };
        let value = |side, ty: Option<Type>, width: u8| {
            let what = What::Value { value: ComparedValue::Code(side), ty, width };
            Some(Side { what, span })
        };
        let operand = match &written.value {
            ast::AssertSide::Register(register) => {
                if let ast::AssertRegister::Accu(number @ (3 | 4)) = register
                    && self.program.globals.input.profile.accumulators < 4
                {
                    self.bad_pragma(
                        span,
                        &format!("this CPU has no ACCU{number}"),
                        "add `//@ cpu accus=4` to the file",
                    );
                    return None;
                }
                // A narrower type uses the low bits.
                return match ty {
                    Some((ty, at)) if ty.width() > 32 || ty.is_in_memory() => self.other_width(ty, 32, at),
                    Some((ty, _)) => value(AssertSide::Register(*register), Some(ty), ty.width()),
                    None => value(AssertSide::Register(*register), None, 32),
                };
            }
            ast::AssertSide::Literal(literal) => {
                return self.literal_side(literal_of(literal), ty.map(|(ty, _)| ty), span);
            }
            ast::AssertSide::Operand(operand) => match self.named_cell(ctx, operand) {
                Some(cell) => return self.cell_value(cell?, ty, span),
                None => operand,
            },
            ast::AssertSide::CellValue(operand) => {
                let cell = self.settle(ctx, operand)?;
                return self.cell_value(cell, ty, span);
            }
        };
        match self.settle(ctx, operand)? {
            Settled::Memory { place, width, ty: own } => {
                let bits = width.bits() as u8;
                let Some((ty, at)) = ty else {
                    let own = own.map(Type::Elementary);
                    return value(AssertSide::Operand(Operand::Memory { place, width }), own, bits);
                };
                match (ty, width) {
                    // Places that begin at a byte.
                    (_, Width::Byte) if ty.is_in_memory() && is_memory(&place) => {
                        value(AssertSide::Memory(place), Some(ty), ty.width())
                    }
                    (_, Width::Byte) if ty.width() == 64 && is_memory(&place) => {
                        let operand = Operand::Memory { place, width: Width::Lword };
                        value(AssertSide::Operand(operand), Some(ty), 64)
                    }
                    _ if ty.width() == bits && !ty.is_in_memory() => {
                        value(AssertSide::Operand(Operand::Memory { place, width }), Some(ty), bits)
                    }
                    _ => self.other_width(ty, bits, at),
                }
            }
            Settled::Complex { place, ty: declared } => {
                let own = match &declared {
                    DataType::String(_) => Some(Type::Text),
                    DataType::WideString(_) => Some(Type::WideText),
                    DataType::DateAndTime => Some(Type::DateAndTime),
                    DataType::Struct(structure) if structure.name == DTL => Some(Type::Dtl),
                    _ => None,
                };
                match own {
                    Some(own) if ty.is_some_and(|(ty, _)| ty != own) => {
                        let (ty, at) = ty?;
                        let title = format!(
                            "`{}` is of type {}, not {}",
                            self.program.globals.text(operand.span),
                            own.name(),
                            ty.name()
                        );
                        self.bad_pragma(at, &title, "omit the type, or compare a part of it");
                        None
                    }
                    Some(Type::DateAndTime) => {
                        let operand = Operand::Memory { place, width: Width::Lword };
                        value(AssertSide::Operand(operand), Some(Type::DateAndTime), 64)
                    }
                    Some(own) => value(AssertSide::Memory(place), Some(own), own.width()),
                    None => self.not_comparable(operand),
                }
            }
            Settled::Cell { kind, number } => self.bit(AssertSide::Operand(Operand::Cell { kind, number }), ty, span),
            Settled::Status(status) => self.bit(AssertSide::Operand(Operand::Status(status)), ty, span),
            Settled::Special(special) => {
                value(AssertSide::Operand(Operand::Special(special)), ty.map(|(ty, _)| ty), 32)
            }
            Settled::Pointer(bits) => {
                self.literal_side(Literal { constant: None, loaded: Some(bits.into()) }, ty.map(|(ty, _)| ty), span)
            }
            Settled::Literal(_)
            | Settled::Block { .. }
            | Settled::ParameterPointer(_)
            | Settled::Register(_)
            | Settled::Label => self.not_comparable(operand),
        }
    }

    /// The timer or counter before `.VALUE`; inside `None` after a message, outside if it is something else.
    fn named_cell(&mut self, ctx: &mut CurrentBlock, operand: &ast::Operand) -> Option<Option<Settled<'static>>> {
        let ast::OperandKind::Path(path) = &operand.kind else { return None };
        match &path.parts[..] {
            [ast::PathPart::Member { name, .. }] if name.eq_ignore_ascii_case("VALUE") => {}
            _ => return None,
        }
        let cell = ast::Path { parts: Vec::new(), ..path.clone() };
        match self.settle_path(ctx, &cell) {
            Some(cell @ Settled::Cell { .. }) => Some(Some(cell)),
            Some(_) => None,
            None => Some(None),
        }
    }

    /// Time left or count.
    fn cell_value(&mut self, cell: Settled<'_>, ty: Option<(Type, Span)>, span: Span) -> Option<Side<AssertSide>> {
        let Settled::Cell { kind, number } = cell else { return None };
        let own = match kind {
            CellKind::Timer => Elementary::S5Time,
            CellKind::Counter => Elementary::Int,
        };
        let ty = match ty {
            Some((ty, at)) if ty.width() != 16 || ty.is_in_memory() => return self.other_width(ty, 16, at),
            Some((ty, _)) => ty,
            None => Type::Elementary(own),
        };
        let value = ComparedValue::Code(AssertSide::CellValue { kind, number });
        Some(Side { what: What::Value { value, ty: Some(ty), width: 16 }, span })
    }

    /// A side that is a single bit.
    fn bit(&mut self, side: AssertSide, ty: Option<(Type, Span)>, span: Span) -> Option<Side<AssertSide>> {
        match ty {
            Some((ty, at)) if ty.width() != 1 => self.other_width(ty, 1, at),
            _ => {
                let what = What::Value { value: ComparedValue::Code(side), ty: ty.map(|(ty, _)| ty), width: 1 };
                Some(Side { what, span })
            }
        }
    }

    fn literal_side(&mut self, literal: Literal, ty: Option<Type>, span: Span) -> Option<Side<AssertSide>> {
        let Some(ty) = ty else { return Some(Side { what: What::Literal(literal), span }) };
        match assertion::typed_literal(&literal, ty, span) {
            Ok(side) => Some(side),
            Err(mismatch) => {
                self.program.report(mismatch.message());
                None
            }
        }
    }

    fn other_width<T>(&mut self, ty: Type, bits: u8, at: Span) -> Option<T> {
        let title = format!("the address has {bits} bits, but {} has another width", with_article(ty.name()));
        let help = "name an address of the width of the type; larger types begin at a byte: `DB1.DBB 4 as LREAL`";
        self.bad_pragma(at, &title, help);
        None
    }

    fn not_comparable<T>(&mut self, operand: &ast::Operand) -> Option<T> {
        let text = self.program.globals.text(operand.span);
        self.bad_pragma(
            operand.span,
            &format!("`{text}` has no value to compare"),
            "name an address, a variable of an elementary type or a text, a constant, or a register such as ACCU1, AR1, STW, STW.RLO, DBNO",
        );
        None
    }
}

/// A constant as both of its readers understand it.
fn literal_of(written: &ast::AssertLiteral) -> Literal {
    let exact = written.exact.as_ref().and_then(Constant::of_literal);
    let exact = match (exact, written.negative) {
        (exact, false) => exact,
        (Some(Constant::Integer { value, based }), true) => Some(Constant::Integer { value: -value, based }),
        (Some(Constant::Real(value)), true) => Some(Constant::Real(-value)),
        (_, true) => None,
    };
    let loaded = written.loaded.as_ref().and_then(|literal| match literal {
        plcc_syntax::literal::Literal::Bool(value) => Some(u64::from(*value)),
        _ => value::loaded(literal).ok().map(|(bits, _)| bits.into()),
    });
    Literal { constant: exact.or_else(|| written.loaded.as_ref().and_then(Constant::of_stl)), loaded }
}

/// Places whose bytes are in memory.
fn is_memory(place: &Place) -> bool {
    !matches!(place, Place::Pi { .. } | Place::Pq { .. } | Place::Indirect { .. } | Place::Register { .. })
}
