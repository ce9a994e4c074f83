//! Initial values of declarations and values after BEGIN: lists, structures, single constants, into the bytes of a variable.
//!
//! Source: STL reference, declarations and data blocks; SCL reference, declarations.

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::ast::{BlockName, BlockPrefix, Bound, CellKind, InitialKind, InitialValue, OperandKind};
use plcc_syntax::count::counted;
use plcc_syntax::literal::Literal;
use plcc_syntax::scl::ast::{Expr, ExprKind, Name};
use rustc_hash::FxHashMap;

use crate::bind::declarations::Declarations;
use crate::bind::declarations::pointer::pointer_bytes;
use crate::bind::declarations::typed::put;
use crate::bind::globals::Globals;
use plcc_binding::constant::Constant;
use plcc_binding::fold;
use plcc_binding::value::{Mismatch, Place, elementary_bytes, literal_kind};
use plcc_model::layout;
use plcc_model::types::{ArrayType, DataType, Elementary, ParameterType, StructType};
use plcc_syntax::symbols::SymbolTarget;

impl Declarations<'_> {
    /// Writes an initial value over the bytes of a variable of type `ty` at `byte`.`bit` of `image`.
    pub fn encode_initial(&mut self, value: &InitialValue, ty: &DataType, image: &mut [u8], byte: u32, bit: u8) {
        self.encode(value, ty, image, byte, bit);
    }

    /// `None` after a message.
    fn encode(&mut self, value: &InitialValue, ty: &DataType, image: &mut [u8], byte: u32, bit: u8) -> Option<()> {
        match (&value.kind, ty) {
            (_, DataType::Void) | (InitialKind::Default, _) => Some(()),
            (InitialKind::Fields(fields), _) if fields.is_empty() => Some(()),
            (kind, DataType::Parameter(parameter)) => self.encode_parameter(kind, *parameter, value.span, image, byte),
            (InitialKind::Operand(kind), _) => match self.constant_operand(kind) {
                Some(constant) => self.encode_constant(&constant, value.span, ty, image, byte, bit),
                None => self.encode_bytes(Err(Mismatch::Type), "this operand", value.span, ty, image, byte, bit),
            },
            (InitialKind::Literal(Literal::Text(text)), DataType::Array(array)) if is_char(&array.element) => {
                self.encode_characters(text, array, value.span, image, byte)
            }
            (InitialKind::Expr(constant), DataType::Array(array)) if is_char(&array.element) && is_text(constant) => {
                match self.scope_constant(constant)? {
                    Constant::Text { bytes, .. } => self.encode_characters(&bytes, array, value.span, image, byte),
                    _ => None,
                }
            }
            (InitialKind::Elements(elements), DataType::Array(_)) => {
                for (path, value) in elements {
                    self.encode_element(path, value, ty, image, (byte, bit));
                }
                Some(())
            }
            (InitialKind::List(values), DataType::Array(array)) => self.encode_list(values, array, image, byte),
            // One value for an array is its first element.
            (_, DataType::Array(array)) => {
                let first = byte as usize..(byte + layout::bytes(&leaf(array, 0).2)) as usize;
                let before = image.get(first.clone()).map(<[u8]>::to_vec);
                self.encode_list(std::slice::from_ref(value), array, image, byte)?;
                if image.get(first) != before.as_deref() {
                    self.value_of_first(value, ty);
                }
                Some(())
            }
            (InitialKind::Fields(fields), DataType::Struct(structure)) => {
                self.encode_fields(fields, structure, value.span, image, byte)
            }
            (InitialKind::Literal(literal), _) => self.encode_literal(literal, value.span, ty, image, byte, bit),
            (InitialKind::Expr(constant), _) => {
                let constant = self.scope_constant(constant)?;
                match (ty, &constant) {
                    (DataType::Struct(_), Constant::Dtl(_)) => {
                        self.encode_constant(&constant, value.span, ty, image, byte, bit)
                    }
                    // `(x)` is a list of one component.
                    (DataType::Struct(structure), _) if structure.members.len() == 1 => {
                        let member = structure.members[0].clone();
                        self.encode_constant(&constant, value.span, &member.ty, image, byte + member.byte, member.bit)
                    }
                    _ => self.encode_constant(&constant, value.span, ty, image, byte, bit),
                }
            }
            (
                InitialKind::List(_) | InitialKind::Elements(_) | InitialKind::Repeat { .. } | InitialKind::Fields(_),
                _,
            ) => {
                let real = matches!(ty, DataType::Elementary(elementary) if elementary.is_float());
                let help = match with_point(&self.globals.text(value.span)).filter(|_| real) {
                    Some(number) => format!("a decimal number has a point: write `{number}`"),
                    None => "write one constant; lists and repetition factors are for arrays".to_string(),
                };
                self.report(
                    Diagnostic::new(
                        Code::InitialValue,
                        value.span,
                        "this is a list of values, but one value is expected",
                    )
                    .label(format!("the variable is of type {}", layout::type_name(ty)))
                    .help(help),
                );
                None
            }
        }
    }

    /// The value of a formal parameter of type TIMER, COUNTER, BLOCK_x, POINTER or ANY in an instance: it is used until a call supplies
    /// another one.
    fn encode_parameter(
        &mut self,
        kind: &InitialKind,
        parameter: ParameterType,
        span: Span,
        image: &mut [u8],
        byte: u32,
    ) -> Option<()> {
        let bytes = match kind {
            InitialKind::Literal(literal) => parameter_bytes(literal, parameter),
            InitialKind::Operand(kind) => self.parameter_number(kind, parameter, span)?,
            InitialKind::Expr(value) => match &value.kind {
                ExprKind::Absolute(kind) => self.parameter_number(kind, parameter, span)?,
                ExprKind::Literal(plcc_syntax::scl::ast::Literal::Any(bytes)) => {
                    parameter_bytes(&Literal::Any(*bytes), parameter)
                }
                _ => None,
            },
            InitialKind::List(_)
            | InitialKind::Elements(_)
            | InitialKind::Repeat { .. }
            | InitialKind::Fields(_)
            | InitialKind::Default => None,
        };
        let Some(bytes) = bytes else {
            let name = layout::type_name(&DataType::Parameter(parameter));
            let example = match parameter {
                ParameterType::Timer => "T 5",
                ParameterType::Counter => "C 5",
                ParameterType::BlockFb => "FB 5",
                ParameterType::BlockFc => "FC 5",
                ParameterType::BlockDb => "DB 5",
                ParameterType::BlockSdb => "SDB 5",
                ParameterType::Pointer => "P#M 10.0",
                ParameterType::Any | ParameterType::Variant => "P#M 10.0 BYTE 4",
            };
            self.report(
                Diagnostic::new(Code::InitialValue, span, format!("this is not a value of type {name}"))
                    .label(format!("the parameter is of type {name}"))
                    .help(format!("write it as `{example}`")),
            );
            return None;
        };
        let at = byte as usize;
        image.get_mut(at..at + bytes.len())?.copy_from_slice(&bytes);
        Some(())
    }

    /// The constant of the program whose name is a start value in STL: `"MAX"`.
    pub(super) fn constant_operand(&self, kind: &OperandKind) -> Option<Constant> {
        let OperandKind::Block(BlockName::Symbol { name, .. }) = kind else { return None };
        self.globals.names.constants.get(&plcc_binding::fold(name)).cloned()
    }

    /// The number of a timer, counter or block; the inner `None`: it is of another kind. The outer one: it is reported.
    fn parameter_number(
        &mut self,
        kind: &OperandKind,
        parameter: ParameterType,
        span: Span,
    ) -> Option<Option<Vec<u8>>> {
        let named = match kind {
            OperandKind::Cell { kind, number } => SymbolTarget::Cell { kind: *kind, number: *number },
            OperandKind::Block(BlockName::Numbered { prefix, number, .. }) => {
                SymbolTarget::Block { prefix: *prefix, number: *number }
            }
            OperandKind::Block(BlockName::Symbol { name, span }) => match self.globals.global(name) {
                Some(target) => target,
                None => {
                    self.globals.unknown_name(name, *span, std::iter::empty());
                    return None;
                }
            },
            _ => return Some(None),
        };
        let number = match (parameter, named) {
            (ParameterType::Timer, SymbolTarget::Cell { kind: kind @ CellKind::Timer, number })
            | (ParameterType::Counter, SymbolTarget::Cell { kind: kind @ CellKind::Counter, number }) => {
                self.globals.check_cell(kind, number, span)?
            }
            (ParameterType::BlockFb, SymbolTarget::Block { prefix: BlockPrefix::Fb | BlockPrefix::Sfb, number })
            | (ParameterType::BlockFc, SymbolTarget::Block { prefix: BlockPrefix::Fc | BlockPrefix::Sfc, number })
            | (ParameterType::BlockDb, SymbolTarget::Block { prefix: BlockPrefix::Db, number }) => {
                match u16::try_from(number) {
                    Ok(number) => number,
                    Err(_) => return Some(None),
                }
            }
            _ => return Some(None),
        };
        Some(Some(number.to_be_bytes().to_vec()))
    }

    /// The value of one element, with indices that count through nested arrays.
    fn encode_element(
        &mut self,
        path: &[i64],
        value: &InitialValue,
        ty: &DataType,
        image: &mut [u8],
        (byte, bit): (u32, u8),
    ) -> Option<()> {
        if path.is_empty() {
            return self.encode(value, ty, image, byte, bit);
        }
        let wrong = |binder: &mut Self| {
            let shown = path.iter().map(i64::to_string).collect::<Vec<_>>().join(", ");
            let title = format!("the start value of the element [{shown}] does not fit any element");
            let message = Diagnostic::new(Code::InitialValue, value.span, title);
            let help = "correct the bounds of the array, or export the block again";
            binder.report(message.label(format!("the type is {}", layout::type_name(ty))).help(help));
            None
        };
        let DataType::Array(array) = ty else { return wrong(self) };
        if path.len() < array.bounds.len() {
            return wrong(self);
        }
        let mut element: u64 = 0;
        for (index, (low, high)) in path.iter().zip(&array.bounds) {
            let (low, high) = (i64::from(*low), i64::from(*high));
            if !(low..=high).contains(index) {
                return wrong(self);
            }
            element = element * (high - low + 1) as u64 + (index - low) as u64;
        }
        let (at, inner) = layout::element_place(array, element);
        let (array, path) = (array.clone(), &path[array.bounds.len()..]);
        self.encode_element(path, value, &array.element, image, (byte + at, inner))
    }

    fn encode_characters(
        &mut self,
        text: &[u8],
        array: &ArrayType,
        span: Span,
        image: &mut [u8],
        byte: u32,
    ) -> Option<()> {
        if text.len() as u64 > layout::element_count(&array.bounds) {
            self.surplus(span);
            return None;
        }
        let at = byte as usize;
        image[at..at + text.len()].copy_from_slice(text);
        Some(())
    }

    fn encode_list(&mut self, values: &[InitialValue], array: &ArrayType, image: &mut [u8], byte: u32) -> Option<()> {
        let mut next = 0;
        self.encode_run(values, array, image, byte, &mut next)
    }

    /// Values of elements, beginning with number `next`. Elements of nested arrays are counted through.
    fn encode_run(
        &mut self,
        values: &[InitialValue],
        array: &ArrayType,
        image: &mut [u8],
        byte: u32,
        next: &mut u64,
    ) -> Option<()> {
        let count = layout::element_count(&array.bounds);
        let inner = leaves(&array.element);
        for value in values {
            match &value.kind {
                InitialKind::Repeat { count: times, values: group } => {
                    let times = self.bound(times)?;
                    self.encode_repeated(times, group, value.span, array, image, byte, next)?;
                }
                InitialKind::Expr(call) if repetition(call).is_some() => {
                    let (times, group) = repetition(call)?;
                    let times = self.bound(&times)?;
                    self.encode_repeated(times, &group, value.span, array, image, byte, next)?;
                }
                // Each nested array has its own bracket; other brackets only group.
                InitialKind::List(_) | InitialKind::Fields(_) if matches!(array.element, DataType::Array(_)) => {
                    let element = next.div_ceil(inner.max(1));
                    if element >= count {
                        self.surplus(value.span);
                        return None;
                    }
                    let (at, bit) = layout::element_place(array, element);
                    self.encode(value, &array.element, image, byte + at, bit)?;
                    *next = (element + 1) * inner;
                }
                InitialKind::List(group) => self.encode_run(group, array, image, byte, next)?,
                InitialKind::Default => *next += 1,
                InitialKind::Fields(fields) if fields.is_empty() => *next += 1,
                InitialKind::Literal(_) if matches!(array.element, DataType::Struct(_)) => {
                    self.report(
                        Diagnostic::new(
                            Code::InitialValue,
                            value.span,
                            "an array of structures cannot have a list of values",
                        )
                        .label("not possible here")
                        .help("give the components their values in the structure or after BEGIN"),
                    );
                    return None;
                }
                InitialKind::Literal(_)
                | InitialKind::Expr(_)
                | InitialKind::Fields(_)
                | InitialKind::Operand(_)
                | InitialKind::Elements(_) => {
                    if *next >= count.saturating_mul(inner) {
                        self.surplus(value.span);
                        return None;
                    }
                    let (at, bit, ty) = leaf(array, *next);
                    *next += 1;
                    self.encode(value, &ty, image, byte + at, bit)?;
                }
            }
        }
        Some(())
    }

    #[allow(clippy::too_many_arguments, reason = "what a run has, and its repetition")]
    fn encode_repeated(
        &mut self,
        times: i64,
        group: &[InitialValue],
        span: Span,
        array: &ArrayType,
        image: &mut [u8],
        byte: u32,
        next: &mut u64,
    ) -> Option<()> {
        let count = layout::element_count(&array.bounds).saturating_mul(leaves(&array.element));
        for _ in 0..times {
            let before = *next;
            if before >= count && !group.is_empty() {
                self.surplus(span);
                return None;
            }
            self.encode_run(group, array, image, byte, next)?;
            if *next == before {
                break;
            }
        }
        Some(())
    }

    /// `(a := 1, b := 2)` by name, `(1, 2)` in order. Omitted components keep their values.
    fn encode_fields(
        &mut self,
        fields: &[(Option<Name>, InitialValue)],
        structure: &std::rc::Rc<StructType>,
        span: Span,
        image: &mut [u8],
        byte: u32,
    ) -> Option<()> {
        let mut given: FxHashMap<String, Span> = FxHashMap::default();
        for (at, (name, value)) in fields.iter().enumerate() {
            if let Some(name) = name
                && let Some(first) = given.insert(fold(&name.text), name.span)
            {
                self.given_twice(&name.text, name.span, first, Severity::Error);
                return None;
            }
            let member = match name {
                Some(name) => match self.types.member(structure, &name.text) {
                    Some(member) => member,
                    None => {
                        self.unknown_member(structure, &name.text, name.span);
                        return None;
                    }
                },
                None => match structure.members.get(at) {
                    Some(member) => member.clone(),
                    None => {
                        self.report(
                            Diagnostic::new(Code::InitialValue, span, "more values than the structure has components")
                                .label(format!(
                                    "{}, {}",
                                    counted(fields.len(), "value"),
                                    counted(structure.members.len(), "component")
                                )),
                        );
                        return None;
                    }
                },
            };
            self.encode(value, &member.ty, image, byte + member.byte, member.bit)?;
        }
        Some(())
    }

    /// Reports a second start value for one component.
    pub fn given_twice(&mut self, name: &str, second: Span, first: Span, severity: Severity) {
        let mut message = Diagnostic::new(Code::InitialValue, second, format!("`{name}` gets a start value twice"))
            .label("the second value")
            .also(first, "the first one")
            .help("remove one of them");
        message.severity = severity;
        self.report(message);
    }

    fn surplus(&mut self, span: Span) {
        let mut message = Diagnostic::new(Code::InitialValue, span, "more values than the array has elements")
            .label("there is no element left for this one")
            .help("remove values or make the array larger");
        // A stand-in for a missing data type may have fewer elements.
        if self.globals.input.partial {
            message.severity = Severity::Warning;
        }
        self.report(message);
    }

    /// A constant of STL, which must be written as its type requires. Types that STL does not have are less strict, and so is the TIA
    /// Portal, where declarations are the same in all languages: `w : Word := 5`.
    fn encode_literal(
        &mut self,
        literal: &Literal,
        span: Span,
        ty: &DataType,
        image: &mut [u8],
        byte: u32,
        bit: u8,
    ) -> Option<()> {
        let fitted = || {
            let constant = self.globals.constant_of_stl(literal, span).ok_or(Mismatch::Type)?;
            Globals::constant_bytes(&constant, ty)
        };
        let of_portal = self.globals.input.profile.family.is_portal();
        let bytes = match ty {
            DataType::Elementary(elementary) => match elementary_bytes(*elementary, literal, Place::Declaration) {
                Err(Mismatch::Type) if of_portal || !elementary.is_of_s7300() => fitted(),
                result => result,
            },
            _ => fitted(),
        };
        self.encode_bytes(bytes, literal_kind(literal), span, ty, image, byte, bit)
    }

    fn encode_constant(
        &mut self,
        constant: &Constant,
        span: Span,
        ty: &DataType,
        image: &mut [u8],
        byte: u32,
        bit: u8,
    ) -> Option<()> {
        let bytes = match ty {
            DataType::Elementary(own) => {
                self.number_for_bits(constant, *own, span);
                Globals::constant_bytes(&self.globals.nearest(constant, *own, span), ty)
            }
            _ => Globals::constant_bytes(constant, ty),
        };
        self.encode_bytes(bytes, &constant.describe(), span, ty, image, byte, bit)
    }

    /// Warns of a start value that looks like the bits of a REAL. No call can be a start value.
    fn number_for_bits(&mut self, constant: &Constant, ty: Elementary, span: Span) {
        let Some(message) = self.globals.number_for_bits(constant, ty, span) else { return };
        // Many elements of an array may have one value.
        let last = self.globals.report.diagnostics.last();
        if last.is_none_or(|last| last.code != message.code || last.primary.span != span) {
            self.report(message.help("write the value itself, with a point"));
        }
    }

    #[allow(clippy::too_many_arguments, reason = "a value, what it is, and its place")]
    fn encode_bytes(
        &mut self,
        bytes: Result<Vec<u8>, Mismatch>,
        what: &str,
        span: Span,
        ty: &DataType,
        image: &mut [u8],
        byte: u32,
        bit: u8,
    ) -> Option<()> {
        match bytes {
            Ok(bytes) => {
                put(image, byte, bit, ty, &bytes);
                self.cut_s5time(ty, &bytes, span);
                Some(())
            }
            Err(problem) => {
                self.globals.bad_initial(what, ty, problem, span);
                None
            }
        }
    }
}

/// A constant as a POINTER or ANY; `P#P 0.0 VOID 0` points nowhere in both.
fn parameter_bytes(literal: &Literal, parameter: ParameterType) -> Option<Vec<u8>> {
    match (parameter, literal) {
        (ParameterType::Any, Literal::Any(bytes)) => Some(bytes.to_vec()),
        (ParameterType::Pointer, Literal::Any(bytes)) if bytes[1] == 0 => Some(bytes[4..].to_vec()),
        (ParameterType::Pointer, Literal::Pointer(pointer)) => Some(pointer_bytes(0, *pointer)),
        (ParameterType::Pointer, Literal::AreaPointer { db, pointer }) => Some(pointer_bytes(*db, *pointer)),
        _ => None,
    }
}

pub(super) fn is_char(ty: &DataType) -> bool {
    *ty == DataType::Elementary(Elementary::Char)
}

pub(super) fn is_text(value: &Expr) -> bool {
    matches!(value.kind, ExprKind::Literal(plcc_syntax::scl::ast::Literal::Text { .. }))
}

/// `N(0)` with a constant N, which looks like a call.
pub(super) fn repetition(value: &Expr) -> Option<(Bound, Vec<InitialValue>)> {
    let ExprKind::Call { callee, arguments } = &value.kind else { return None };
    let values = arguments
        .iter()
        .map(|argument| match (&argument.name, &argument.value) {
            (None, Some(value)) => {
                Some(InitialValue { kind: InitialKind::Expr(Box::new(value.clone())), span: value.span })
            }
            _ => None,
        })
        .collect::<Option<Vec<_>>>()?;
    Some((Bound::Expr(callee.clone()), values))
}

/// Elements of a type, those of nested arrays counted through.
pub(super) fn leaves(ty: &DataType) -> u64 {
    match ty {
        DataType::Array(array) => layout::element_count(&array.bounds).saturating_mul(leaves(&array.element)),
        _ => 1,
    }
}

/// Place and type of element `number`, counted through nested arrays.
fn leaf(array: &ArrayType, number: u64) -> (u32, u8, DataType) {
    let inner = leaves(&array.element).max(1);
    let (byte, bit) = layout::element_place(array, number / inner);
    match &array.element {
        DataType::Array(element) => {
            let (at, bit, ty) = leaf(element, number % inner);
            (byte + at, bit, ty)
        }
        ty => (byte, bit, ty.clone()),
    }
}

/// `1,5` as `1.5`.
fn with_point(text: &str) -> Option<String> {
    let (whole, fraction) = text.split_once(',')?;
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    (digits(whole.trim_start_matches('-')) && digits(fraction)).then(|| format!("{whole}.{fraction}"))
}
