//! Actual parameters: what a call passes, checked against the formal parameter.
//!
//! Source: STL reference, passing rules. Addresses fit by their width; symbols must be of the formal's type; constants must be
//! literals of the formal's type. For POINTER and ANY, the compiler makes a pointer to the named operand.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, Area, BlockPrefix, CellKind, OperandKind, Width};
use plcc_syntax::literal::Literal;

use crate::bind::declarations::block::CurrentBlock;
use crate::bind::declarations::path::type_of_width;
use crate::bind::declarations::pointer::{
    CODE_BYTE, CODE_DATE_AND_TIME, POINTS_AT_NOTHING, any_bytes, any_number_of_block, any_number_of_cell, code_for,
    for_formal, known_pointer, local_place, pointed_at, pointed_at_by_literal, pointer_bytes,
};
use crate::bind::declarations::typed::is_complex;
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
use plcc_model::{Actual, BlockKey, Direction, Number, Parameter, Place, Pointed};

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

    /// Reports an actual whose type is not that of the formal.
    fn mismatch(&mut self, callee: BlockKey, formal: &Parameter, settled: &Settled, span: Span) -> Option<Actual> {
        let text = self.program.globals.text(span);
        let is = match settled {
            Settled::Memory { ty: Some(ty), .. } => ty.name().to_string(),
            Settled::Memory { width, .. } => match width {
                Width::Bit => "a bit",
                Width::Byte => "a byte",
                Width::Word => "a word",
                Width::Dword => "a double word",
                Width::Lword => "a long word",
            }
            .to_string(),
            Settled::Complex { ty, .. } => layout::type_name(ty),
            Settled::Cell { kind: CellKind::Timer, .. } => "a timer".to_string(),
            Settled::Cell { kind: CellKind::Counter, .. } => "a counter".to_string(),
            Settled::Block { .. } => "a block".to_string(),
            Settled::Literal(literal) => value::literal_kind(literal).to_string(),
            Settled::Pointer(_) | Settled::ParameterPointer(_) => "a pointer".to_string(),
            Settled::Status(_) => "a status bit".to_string(),
            Settled::Special(_) | Settled::Register(_) => "a register of the CPU".to_string(),
            Settled::Label => "a name without a meaning here".to_string(),
        };
        let wanted = layout::type_name(&formal.ty);
        let is = match &formal.ty {
            DataType::Struct(structure) if structure.name.is_empty() && is == wanted => format!("another {wanted}"),
            _ => is,
        };
        let message = Diagnostic::new(
            Code::TypeMismatch,
            span,
            format!(
                "`{}` of {} is of type {wanted}, but `{text}` is {is}",
                formal.name,
                self.program.globals.shown(callee)
            ),
        )
        .label(is);
        self.program.report(match (&formal.ty, settled) {
            (DataType::Elementary(ty), Settled::Literal(_)) => {
                message.help(rewrite::help(*ty, &text, rewrite::Form::Stl))
            }
            (DataType::Elementary(ty), _) => {
                message.help(format!("name {} or a variable of type {wanted}", address_of_type(*ty, &text)))
            }
            (DataType::Parameter(ParameterType::Any | ParameterType::Variant), _) => {
                let is_pointer = text.get(..2).is_some_and(|sign| sign.eq_ignore_ascii_case("P#"));
                message.help(match rewrite::any_pointer(&text) {
                    Some(pointer) => format!("write `{pointer}`, or name a variable"),
                    None if is_pointer => format!("write the type and the number after it, as in `{text} BYTE 1`"),
                    None => "name a variable, or write a pointer to an area: `P#`, its first bit, a type and a number"
                        .to_string(),
                })
            }
            (DataType::Parameter(ParameterType::Pointer), _) => {
                message.help("write for example `P#M 50.0`, or name a variable")
            }
            (
                DataType::DateAndTime | DataType::String(_) | DataType::Array(_) | DataType::Struct(_),
                Settled::Literal(_),
            ) => message.help(format!("store the value in a variable of type {wanted} and pass that variable")),
            (DataType::Parameter(ParameterType::Timer), _) => {
                message.help("name a timer such as `T 5`, or a parameter of type TIMER")
            }
            (DataType::Parameter(ParameterType::Counter), _) => {
                message.help("name a counter by its number, or a parameter of type COUNTER")
            }
            (ty, _) => message.help(format!("name a variable of type {}", layout::declared_type(ty))),
        });
        None
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

    /// The memory of `bytes` bytes at a pointer constant, checked against its area; `None` after a message.
    fn pointed_place(
        &mut self,
        ctx: &mut CurrentBlock,
        db: u16,
        pointer: u32,
        formal: &Parameter,
        bytes: u32,
        span: Span,
    ) -> Option<Place> {
        use plcc_abi::layout::area;
        let (byte, bit) = ((pointer & 0x00FF_FFFF) >> 3, (pointer & 7) as u8);
        let (found, place) = match (pointer >> 24) as u8 {
            area::I => (Area::I, Place::I { byte, bit }),
            area::Q => (Area::Q, Place::Q { byte, bit }),
            area::M => (Area::M, Place::M { byte, bit }),
            area::L => (Area::L, Place::L { byte, bit }),
            area::DB if db == 0 => (Area::Db, Place::OpenDb { byte, bit }),
            area::DB => (Area::Db, Place::Db { number: db, byte, bit }),
            area::DI if db == 0 => (Area::Di, Place::OpenDi { byte, bit }),
            area::P if formal.direction == Direction::Output => (Area::Pq, Place::Pq { byte, bit }),
            area::P => (Area::Pi, Place::Pi { byte, bit }),
            _ => {
                let text = self.program.globals.text(span);
                self.program.report(
                    Diagnostic::new(Code::OperandKind, span, format!("`{text}` cannot be an actual parameter"))
                        .label("not an address of this block")
                        .help("name an address of I, Q, M, L or a data block"),
                );
                return None;
            }
        };
        self.program.check_address(ctx, found, Width::Byte, byte, span)?;
        self.program.check_address(ctx, found, Width::Byte, byte.saturating_add(bytes.saturating_sub(1)), span)?;
        if let Place::Db { number, .. } = place {
            self.program.use_db(number, span);
            self.program.check_db_end(number, byte + bytes, span);
        }
        Some(place)
    }

    /// `P#DB5.DBX 20.0` for a parameter of type DATE_AND_TIME, STRING, STRUCT or ARRAY: the address of the actual. `None`: it does not
    /// fit; the outer one after a message.
    fn complex_at_pointer(
        &mut self,
        ctx: &mut CurrentBlock,
        formal: &Parameter,
        literal: &Literal,
        span: Span,
    ) -> Option<Option<Actual>> {
        let bytes = layout::bytes(&formal.ty);
        let (db, pointer) = match literal {
            Literal::AreaPointer { db, pointer } => (*db, *pointer),
            Literal::Any([_, code, high, low, db_high, db_low, pointer @ ..]) => {
                let count = u32::from(u16::from_be_bytes([*high, *low]));
                let fits = match (*code, &formal.ty) {
                    (CODE_DATE_AND_TIME, DataType::DateAndTime) => count == 1,
                    (CODE_BYTE, DataType::String(_)) => true,
                    (CODE_BYTE, _) => count == bytes,
                    _ => false,
                };
                if !fits {
                    return Some(None);
                }
                (u16::from_be_bytes([*db_high, *db_low]), u32::from_be_bytes(*pointer))
            }
            _ => return Some(None),
        };
        let peripheral = (pointer >> 24) as u8 == plcc_abi::layout::area::P;
        if pointer & 7 != 0 || peripheral {
            return Some(None);
        }
        let place = self.pointed_place(ctx, db, pointer, formal, bytes, span)?;
        Some(Some(Actual::Place(place)))
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

    fn pointer_actual(&mut self, callee: BlockKey, formal: &Parameter, settled: Settled, span: Span) -> Option<Actual> {
        let to = |place: Place| match known_pointer(&place) {
            Some((db, pointer)) => Actual::PointerBytes(pointer_bytes(db, pointer)),
            None => Actual::PointerTo { place, type_code: 0, count: 0 },
        };
        match &settled {
            Settled::Literal(Literal::AreaPointer { db, pointer }) => {
                self.program.use_db(*db, span);
                Some(match local_place(*pointer) {
                    Some(place) => to(place),
                    None => Actual::PointerBytes(pointer_bytes(*db, *pointer)),
                })
            }
            Settled::Literal(Literal::Pointer(pointer)) => Some(Actual::PointerBytes(pointer_bytes(0, *pointer))),
            Settled::Memory { place, .. } => Some(to(place.clone())),
            Settled::Complex { place, ty } => match ty {
                DataType::Parameter(ParameterType::Pointer) => Some(Actual::PointerCopy(place.clone())),
                ty if is_complex(ty) => Some(to(place.clone())),
                _ => self.mismatch(callee, formal, &settled, span),
            },
            _ => self.mismatch(callee, formal, &settled, span),
        }
    }

    fn any_actual(&mut self, callee: BlockKey, formal: &Parameter, settled: Settled, span: Span) -> Option<Actual> {
        let to = |place: Place, ty: &DataType, code_of: &DataType| {
            let (type_code, count) = code_for(formal, code_of);
            let count = count.min(0xFFFF) as u16;
            let any = match known_pointer(&place) {
                Some((db, pointer)) => Actual::PointerBytes(any_bytes(type_code, count, db, pointer)),
                None => Actual::PointerTo { place, type_code, count },
            };
            for_formal(formal, any, pointed_at(ty))
        };
        match &settled {
            Settled::Literal(Literal::Any(bytes)) => {
                let [_, type_code, high, low, _, _, pointer @ ..] = *bytes;
                self.program.use_pointed_db(callee, &formal.name, *bytes, span);
                let count = u16::from_be_bytes([high, low]);
                let any = match local_place(u32::from_be_bytes(pointer)) {
                    Some(place) => Actual::PointerTo { place, type_code, count },
                    None => Actual::PointerBytes(bytes.to_vec()),
                };
                Some(for_formal(formal, any, pointed_at_by_literal(type_code, count)))
            }
            Settled::Memory { place, width, ty } => {
                let ty = DataType::Elementary(ty.unwrap_or(type_of_width(*width)));
                Some(to(place.clone(), &ty, &ty))
            }
            Settled::Cell { kind, number: Number::Known(number) } => {
                Some(for_formal(formal, Actual::PointerBytes(any_number_of_cell(*kind, *number)), POINTS_AT_NOTHING))
            }
            Settled::Block { prefix, number: Number::Known(number) } => match any_number_of_block(*prefix, *number) {
                Some(bytes) => Some(for_formal(formal, Actual::PointerBytes(bytes), POINTS_AT_NOTHING)),
                None => self.mismatch(callee, formal, &settled, span),
            },
            Settled::Complex { place, ty } => match ty {
                DataType::Parameter(ParameterType::Any) => {
                    Some(for_formal(formal, Actual::PointerCopy(place.clone()), POINTS_AT_NOTHING))
                }
                DataType::Parameter(ParameterType::Variant) => {
                    Some(for_formal(formal, Actual::PointerCopy(place.clone()), Pointed::Copied))
                }
                DataType::Parameter(ParameterType::Pointer) => self.mismatch(callee, formal, &settled, span),
                ty => {
                    let longest = DataType::String(254);
                    // A STRING parameter of an FC has the length of the actual; the pointer covers the longest.
                    let code_of = match place {
                        Place::Parameter { .. } if matches!(ty, DataType::String(_)) => &longest,
                        _ => ty,
                    };
                    Some(to(place.clone(), ty, code_of))
                }
            },
            _ => self.mismatch(callee, formal, &settled, span),
        }
    }
}

/// An address of the width of the type, at the byte of the address that stands there.
fn address_of_type(ty: Elementary, text: &str) -> String {
    let (what, letter) = match layout::width(ty) {
        Width::Bit => ("a bit", 'X'),
        Width::Byte => ("a byte", 'B'),
        Width::Word => ("a word", 'W'),
        Width::Dword => ("a double word", 'D'),
        Width::Lword => return "a variable of 64 bits".to_string(),
    };
    match rewrite::address_of_width(text, letter) {
        Some(address) => format!("{what} such as `{address}`"),
        None => what.to_string(),
    }
}
