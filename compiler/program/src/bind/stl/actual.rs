//! Actual parameters: what a call passes, checked against the formal parameter.
//!
//! Source: STL reference, passing rules. Addresses fit by their width; symbols must be of the formal's type; constants must be
//! literals of the formal's type. For POINTER and ANY, the compiler makes a pointer to the named operand (`pointers`).

mod mismatch;
mod pointers;

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, BlockPrefix, CellKind, OperandKind, Width};
use plcc_syntax::literal::Literal;

use crate::bind::declarations::block::CurrentBlock;
use crate::bind::globals::Globals;
use crate::bind::globals::names::code_kind;
use crate::bind::globals::sources::portal_cpu;
use crate::bind::stl::StlBinder;
use crate::bind::stl::settle::Settled;
use plcc_binding::constant::Constant;
use plcc_binding::rewrite;
use plcc_binding::value::{self, Mismatch};
use plcc_model::layout;
use plcc_model::types::{DataType, Elementary, ParameterType};
use plcc_model::{Actual, BlockKey, Direction, Number, Parameter, Place};

impl StlBinder<'_, '_> {
    /// Binds the actual of parameter `formal` of block `callee`; `None` after a message or if it cannot be determined.
    pub fn bind_actual(
        &mut self,
        ctx: &mut CurrentBlock,
        callee: BlockKey,
        formal: &Parameter,
        actual: &ast::Operand,
    ) -> Option<Actual> {
        let named = self.constant_operand(ctx, actual);
        let actual = named.as_ref().unwrap_or(actual);
        let settled = self.settle(ctx, actual)?;
        self.check_absolute_access(actual, &settled)?;
        let span = actual.span;
        if let Settled::Memory { place: Place::Indirect { .. } | Place::Register { .. }, .. } = &settled {
            let text = self.program.globals.text(span);
            self.program.report(
                Diagnostic::new(Code::OperandKind, span, format!("`{text}` cannot be an actual parameter"))
                    .label("this address is only known at run time")
                    .help("load it, transfer it to a variable of TEMP, and pass that variable"),
            );
            return None;
        }
        let constant = matches!(settled, Settled::Literal(_) | Settled::Pointer(_) | Settled::ParameterPointer(_));
        let points = match &settled {
            Settled::Literal(Literal::AreaPointer { .. } | Literal::Any(_)) => {
                !matches!(formal.ty, DataType::Elementary(_))
            }
            _ => matches!(
                formal.ty,
                DataType::Parameter(ParameterType::Pointer | ParameterType::Any | ParameterType::Variant)
            ),
        };
        if constant && formal.direction != Direction::Input && !points {
            let text = self.program.globals.text(span);
            self.program.report(
                Diagnostic::new(Code::Protected, span, format!("`{text}` cannot be written"))
                    .label(format!("`{}` is written by {}", formal.name, self.program.globals.shown(callee)))
                    .help("name an address or a variable"),
            );
            return None;
        }
        match &formal.ty {
            DataType::Elementary(ty) => {
                if let Settled::Block { prefix: BlockPrefix::Db, number: Number::Known(number) } = &settled {
                    ctx.named_dbs.push((*number, span));
                }
                self.elementary_actual(callee, formal, *ty, settled, span)
            }
            DataType::DateAndTime
            | DataType::String(_)
            | DataType::WideString(_)
            | DataType::Array(_)
            | DataType::Struct(_) => self.complex_actual(ctx, callee, formal, settled, span),
            DataType::Parameter(ParameterType::Pointer) => self.pointer_actual(callee, formal, settled, span),
            DataType::Parameter(ParameterType::Any | ParameterType::Variant) => {
                self.any_actual(callee, formal, settled, span)
            }
            DataType::Parameter(
                parameter @ (ParameterType::Timer
                | ParameterType::Counter
                | ParameterType::BlockFb
                | ParameterType::BlockFc
                | ParameterType::BlockDb
                | ParameterType::BlockSdb),
            ) => self.number_actual(callee, formal, *parameter, settled, span),
            DataType::OpenArray(_) => {
                self.program.report(
                    Diagnostic::new(
                        Code::TypeMismatch,
                        span,
                        format!("`{}` of {} is an ARRAY[*]", formal.name, self.program.globals.shown(callee)),
                    )
                    .label("STL cannot pass the bounds")
                    .help("call the block from SCL"),
                );
                None
            }
            DataType::Void => None,
        }
    }

    fn elementary_actual(
        &mut self,
        callee: BlockKey,
        formal: &Parameter,
        ty: Elementary,
        settled: Settled,
        span: Span,
    ) -> Option<Actual> {
        match &settled {
            Settled::Literal(Literal::Real(value)) if ty == Elementary::Lreal => {
                let value = value::long_real(&self.program.globals.text(span)).unwrap_or(f64::from(*value));
                Some(Actual::Const(value.to_be_bytes().to_vec()))
            }
            Settled::Literal(literal) => match value::elementary_bytes(ty, literal, value::Place::Call) {
                Ok(bytes) => Some(Actual::Const(bytes)),
                Err(Mismatch::Type) => match value::untyped_bytes(ty, literal) {
                    Some(bytes) => Some(Actual::Const(bytes)),
                    None => self.mismatch(callee, formal, &settled, span),
                },
                Err(Mismatch::Range) => {
                    self.program.report(
                        Diagnostic::new(
                            Code::TypeMismatch,
                            span,
                            format!(
                                "`{}` of {} is of type {}, which cannot hold `{}`",
                                formal.name,
                                self.program.globals.shown(callee),
                                ty.name(),
                                self.program.globals.text(span)
                            ),
                        )
                        .label(rewrite::holds(ty))
                        .help(rewrite::wanted(ty)),
                    );
                    None
                }
            },
            // A DB_ANY holds the number of a data block.
            Settled::Block { prefix: BlockPrefix::Db, number: Number::Known(number) }
                if ty == Elementary::Uint && formal.direction == Direction::Input =>
            {
                self.program.use_db(*number, span);
                Some(Actual::Const(number.to_be_bytes().to_vec()))
            }
            Settled::Pointer(pointer) if ty == Elementary::Dword => Some(Actual::Const(pointer.to_be_bytes().to_vec())),
            Settled::Memory { place, width, ty: declared } => {
                let fits = *width == layout::width(ty) && declared.is_none_or(|declared| declared == ty);
                if !fits {
                    return self.mismatch(callee, formal, &settled, span);
                }
                let (title, help) = match (place, formal.direction) {
                    (Place::Pi { .. }, Direction::Output | Direction::InOut) => {
                        ("a peripheral input cannot be written", "name a peripheral output, e.g. `PQW 288`")
                    }
                    (Place::Pq { .. }, Direction::Input | Direction::InOut) => {
                        ("a peripheral output cannot be read", "name a peripheral input, e.g. `PIW 272`")
                    }
                    _ => return Some(Actual::Place(place.clone())),
                };
                let callee = self.program.globals.shown(callee);
                self.program.report(
                    Diagnostic::new(Code::Protected, span, title)
                        .label(match formal.direction {
                            Direction::Input => format!("`{}` is read by {callee}", formal.name),
                            Direction::Output => format!("`{}` is written by {callee}", formal.name),
                            Direction::InOut => format!("`{}` is read and written by {callee}", formal.name),
                        })
                        .help(help),
                );
                None
            }
            _ => self.mismatch(callee, formal, &settled, span),
        }
    }

    /// Binds a pointer that a call without names passes: for an elementary parameter it is the address of the actual.
    pub fn bind_positional(
        &mut self,
        ctx: &mut CurrentBlock,
        callee: BlockKey,
        formal: &Parameter,
        actual: &ast::Operand,
    ) -> Option<Actual> {
        let (OperandKind::Literal(Literal::AreaPointer { db, pointer }), DataType::Elementary(ty)) =
            (&actual.kind, &formal.ty)
        else {
            return self.bind_actual(ctx, callee, formal, actual);
        };
        let width = layout::width(*ty);
        let place = self.pointed_place(ctx, *db, *pointer, formal, width.bytes(), actual.span)?;
        let whole = match width {
            Width::Bit => true,
            Width::Byte | Width::Word | Width::Dword | Width::Lword => pointer & 7 == 0,
        };
        let settled = Settled::Memory { place, width, ty: None };
        match whole {
            true => self.elementary_actual(callee, formal, *ty, settled, actual.span),
            false => self.mismatch(callee, formal, &settled, actual.span),
        }
    }

    fn complex_actual(
        &mut self,
        ctx: &mut CurrentBlock,
        callee: BlockKey,
        formal: &Parameter,
        settled: Settled,
        span: Span,
    ) -> Option<Actual> {
        let (place, ty) = match &settled {
            Settled::Complex { place, ty } => (place, ty),
            // A data block of a data type is a value of this type in the TIA Portal.
            Settled::Block { prefix: BlockPrefix::Db, number: Number::Known(number) }
                if portal_cpu(self.program.globals.input) =>
            {
                let ty = self.program.data.db_type(*number).map(DataType::Struct);
                if ty.is_some_and(|ty| layout::same_type(&formal.ty, &ty)) {
                    return Some(Actual::Place(Place::Db { number: *number, byte: 0, bit: 0 }));
                }
                return self.mismatch(callee, formal, &settled, span);
            }
            // The caller keeps the constant in its local data.
            Settled::Literal(literal @ (Literal::DateAndTime(_) | Literal::Text(_)))
                if formal.direction == Direction::Input =>
            {
                let bytes = Constant::of_stl(literal)
                    .ok_or(Mismatch::Type)
                    .and_then(|constant| Globals::constant_bytes(&constant, &formal.ty));
                return match bytes {
                    Ok(bytes) => Some(Actual::Const(bytes)),
                    Err(_) => self.mismatch(callee, formal, &settled, span),
                };
            }
            Settled::Literal(literal) => {
                return match self.complex_at_pointer(ctx, formal, literal, span)? {
                    Some(actual) => Some(actual),
                    None => self.mismatch(callee, formal, &settled, span),
                };
            }
            _ => return self.mismatch(callee, formal, &settled, span),
        };
        // The head of a text has its maximum length, which a function reads.
        let any_length = matches!(callee.kind, BlockKind::Fc | BlockKind::Sfc) || formal.direction == Direction::InOut;
        let fits = match (&formal.ty, ty) {
            (DataType::String(_), DataType::String(_)) | (DataType::WideString(_), DataType::WideString(_))
                if any_length =>
            {
                true
            }
            (formal, actual) => layout::same_type(formal, actual),
        };
        if !fits {
            return self.mismatch(callee, formal, &settled, span);
        }
        Some(Actual::Place(place.clone()))
    }

    fn number_actual(
        &mut self,
        callee: BlockKey,
        formal: &Parameter,
        parameter: ParameterType,
        settled: Settled,
        span: Span,
    ) -> Option<Actual> {
        match (parameter, &settled) {
            (ParameterType::Timer, Settled::Cell { kind: CellKind::Timer, number })
            | (ParameterType::Counter, Settled::Cell { kind: CellKind::Counter, number }) => {
                self.forwarded(number, span)
            }
            (ParameterType::BlockDb, Settled::Block { prefix: BlockPrefix::Db, number }) => {
                if let Number::Known(number) = number {
                    self.program.use_db(*number, span);
                }
                self.forwarded(number, span)
            }
            (
                ParameterType::BlockFb,
                Settled::Block { prefix: prefix @ (BlockPrefix::Fb | BlockPrefix::Sfb), number },
            )
            | (
                ParameterType::BlockFc,
                Settled::Block { prefix: prefix @ (BlockPrefix::Fc | BlockPrefix::Sfc), number },
            ) => {
                if let (Number::Known(number), Some(kind)) = (number, code_kind(*prefix)) {
                    self.program.interface(BlockKey { kind, number: *number }, span)?;
                }
                self.forwarded(number, span)
            }
            _ => self.mismatch(callee, formal, &settled, span),
        }
    }

    /// A number as actual: known, or a parameter of this block that is passed on.
    fn forwarded(&mut self, number: &Number, span: Span) -> Option<Actual> {
        match number {
            Number::Word(place) if !matches!(**place, Place::Instance { .. }) => {
                let text = self.program.globals.text(span);
                self.program.report(
                    Diagnostic::new(Code::OperandKind, span, format!("`{text}` cannot be an actual parameter"))
                        .label("this number is only known at run time")
                        .help("name the timer, counter or block itself"),
                );
                None
            }
            number => Some(Actual::Number(number.clone())),
        }
    }
}
