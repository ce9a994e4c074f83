//! Actual parameters of SCL calls, by the type of the formal one.
//!
//! Source: SCL reference, parameters. Inputs are expressions and convert implicitly; outputs convert from the formal's type to the
//! variable's; complex data must have the same type. `pointer` has what is passed by pointer.

use plcc_abi::image::BlockKind;
use plcc_binding::rewrite;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{BlockPrefix, CellKind};
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind};
use plcc_syntax::{Class, Elementary};

use super::convert::{self, Implicit};
use super::message::described;
use super::value::Value;
use super::{Intent, coerce, complex};
use crate::bind::globals::names::code_kind;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_model::layout;
use plcc_model::scl::{Access, Actual, Conversion, Expr, ExprKind};
use plcc_model::types::{DataType, OpenArrayType, ParameterType};
use plcc_model::{BlockKey, Direction, Number, Parameter};

impl SclBinder<'_, '_> {
    /// Binds the actual of parameter `formal` of block `callee`; `None` after a message, or if it cannot be determined.
    pub fn actual(&mut self, ctx: &mut SclBlock, callee: BlockKey, formal: &Parameter, node: &Node) -> Option<Actual> {
        let intent = match formal.direction {
            Direction::Input => Intent::Read,
            Direction::Output => Intent::Write,
            Direction::InOut => Intent::Both,
        };
        let by_number = matches!(
            formal.ty,
            DataType::Parameter(
                ParameterType::Timer
                    | ParameterType::Counter
                    | ParameterType::BlockFb
                    | ParameterType::BlockFc
                    | ParameterType::BlockDb
                    | ParameterType::BlockSdb
            )
        );
        let points = matches!(
            formal.ty,
            DataType::Parameter(ParameterType::Pointer | ParameterType::Any | ParameterType::Variant)
        );
        if intent != Intent::Read && !by_number && !points && !is_variable(node) {
            return self.not_writable(callee, formal, node.span);
        }
        match &formal.ty {
            DataType::Elementary(ty) => match intent {
                Intent::Read => {
                    let value = self.value(ctx, node)?;
                    self.number_for_duration(ctx, &value, *ty);
                    let value = self.position_in_text(ctx, callee, formal, value);
                    Some(Actual::Value(self.convert(ctx, value, *ty)?))
                }
                Intent::Write | Intent::Both => self.elementary_variable(ctx, callee, formal, *ty, node, intent),
            },
            DataType::DateAndTime
            | DataType::String(_)
            | DataType::WideString(_)
            | DataType::Array(_)
            | DataType::Struct(_) => match intent {
                Intent::Read => {
                    let value = self.complex(ctx, node, &formal.ty)?;
                    // The instance of a function block has room for no more anyway.
                    let is_function = callee.kind == BlockKind::Fc;
                    Some(Actual::Complex(if is_function { complex::cut_constant(value, &formal.ty) } else { value }))
                }
                Intent::Write | Intent::Both => {
                    let access = self.access(ctx, node, intent)?;
                    if !complex::assignable(ctx.scope.rules, &formal.ty, &access.ty) || access.part.is_some() {
                        return self.wrong_actual(callee, formal, &access_type(&access), node.span);
                    }
                    Some(Actual::Reference(access))
                }
            },
            DataType::OpenArray(array) => self.open_array_actual(ctx, callee, formal, &array.clone(), node, intent),
            DataType::Parameter(ParameterType::Pointer) => self.pointer(ctx, callee, formal, node, intent),
            DataType::Parameter(ParameterType::Any | ParameterType::Variant) => {
                self.any(ctx, callee, formal, node, intent)
            }
            DataType::Parameter(parameter) => self.number(ctx, callee, formal, *parameter, node),
            DataType::Void => None,
        }
    }

    fn not_writable(&mut self, callee: BlockKey, formal: &Parameter, span: Span) -> Option<Actual> {
        let text = self.program.globals.text(span);
        let help = match formal.direction {
            Direction::Output => format!("an output is read: write `{} => variable`, or leave it out", formal.name),
            Direction::Input | Direction::InOut => "name a variable or an address".to_owned(),
        };
        self.program.report(
            Diagnostic::new(Code::Protected, span, format!("`{text}` cannot be written"))
                .label(format!("`{}` is written by {}", formal.name, self.program.globals.shown(callee)))
                .help(help),
        );
        None
    }

    /// An actual whose type is not that of the formal parameter.
    pub fn wrong_actual(&mut self, callee: BlockKey, formal: &Parameter, is: &str, span: Span) -> Option<Actual> {
        let text = self.program.globals.text(span);
        let wanted = layout::type_name(&formal.ty);
        let is = match &formal.ty {
            DataType::Struct(structure) if structure.name.is_empty() && is == "of type STRUCT" => "another STRUCT",
            _ => is,
        };
        let help = match &formal.ty {
            DataType::Parameter(ParameterType::Any | ParameterType::Variant) => match rewrite::any_pointer(&text) {
                Some(pointer) => format!("write `{pointer}`, or name a variable"),
                None => {
                    "name a variable, or write a pointer to an area: `P#`, its first bit, a type and a number".into()
                }
            },
            DataType::Parameter(ParameterType::Pointer) => "write for example `P#M50.0`, or name a variable".into(),
            ty => format!("name a variable of type {}", layout::declared_type(ty)),
        };
        self.program.report(
            Diagnostic::new(
                Code::TypeMismatch,
                span,
                format!(
                    "`{}` of {} is of type {wanted}, but `{text}` is {is}",
                    formal.name,
                    self.program.globals.shown(callee)
                ),
            )
            .label(is)
            .help(help),
        );
        None
    }

    /// A BYTE as a number of characters or a position in a text, which the IEC check allows. Source: S7-1500 information system, LEFT and MID.
    fn position_in_text(&self, ctx: &SclBlock, callee: BlockKey, formal: &Parameter, value: Value) -> Value {
        let is_position = ctx.scope.strict
            && matches!(formal.name.as_str(), "L" | "P")
            && formal.ty == DataType::Elementary(Elementary::Int)
            && self.program.globals.library_block(callee).is_some();
        match value {
            Value::Elementary(byte) if is_position && byte.ty == Elementary::Byte => {
                let number = convert::explicit_expr(ctx.scope.rules, byte.clone(), Elementary::Int);
                Value::Elementary(number.unwrap_or(byte))
            }
            value => value,
        }
    }

    /// OUT and IN_OUT of elementary types.
    fn elementary_variable(
        &mut self,
        ctx: &mut SclBlock,
        callee: BlockKey,
        formal: &Parameter,
        ty: Elementary,
        node: &Node,
        intent: Intent,
    ) -> Option<Actual> {
        let access = self.access(ctx, node, intent)?;
        let Some(found) = access.elementary() else {
            return self.wrong_actual(callee, formal, &access_type(&access), node.span);
        };
        if found == ty {
            return Some(Actual::Variable { access, back: None });
        }
        // An address only gives its width; so one of two types is a bit string here.
        let same_width = found.bits() == ty.bits() && (found.class() == Class::Bits || ty.class() == Class::Bits);
        if same_width && ty != Elementary::Bool {
            return Some(Actual::Variable { access, back: Some(Conversion::Bits { checked: false }) });
        }
        if intent == Intent::Both {
            if found.bits() == ty.bits() && ctx.scope.rules.is_300() {
                return Some(Actual::Variable { access, back: Some(Conversion::Bits { checked: false }) });
            }
            return self.wrong_actual(callee, formal, &access_type(&access), node.span);
        }
        // An output value converts as any value of the formal's type does.
        let rules = ctx.scope.rules;
        let out = Expr { kind: ExprKind::Load(Box::new(access.clone())), ty, span: node.span };
        let converted = match convert::same_bits(rules, ty, found).filter(|_| coerce::is_untyped(ctx, node.span)) {
            Some(bits) => convert::converted(out, bits, found),
            None => {
                match convert::implicit(rules, ctx.scope.strict, ty, found) {
                    Implicit::No => return self.wrong_actual(callee, formal, &access_type(&access), node.span),
                    Implicit::Unusual => self.output_converts(
                        callee,
                        formal,
                        (ty, found),
                        "S7-SCL of STEP 7 V5 does not convert this implicitly",
                        node.span,
                    ),
                    Implicit::Yes if convert::narrows(ty, found) => {
                        let label = format!("converts to {} without a check", found.name());
                        self.output_converts(callee, formal, (ty, found), &label, node.span);
                    }
                    Implicit::Yes => {}
                }
                convert::explicit_expr(rules, out, found)?
            }
        };
        match converted.kind {
            ExprKind::Convert { conversion, operand } if matches!(operand.kind, ExprKind::Load(_)) => {
                Some(Actual::Variable { access, back: Some(conversion) })
            }
            _ => self.wrong_actual(callee, formal, &access_type(&access), node.span),
        }
    }

    /// An output whose value may not fit its actual parameter; `types`: of the output and of the actual.
    fn output_converts(
        &mut self,
        callee: BlockKey,
        formal: &Parameter,
        types: (Elementary, Elementary),
        label: &str,
        span: Span,
    ) {
        let (ty, found) = (types.0.name(), types.1.name());
        let (text, block) = (self.program.globals.text(span), self.program.globals.shown(callee));
        self.program.report(
            Diagnostic::new(
                Code::Narrowing,
                span,
                format!(
                    "`{}` of {block} is of type {ty} and may not fit `{text}`, which is of type {found}",
                    formal.name
                ),
            )
            .label(label)
            .help(format!("name a variable of type {ty}")),
        );
    }

    /// ARRAY[*]: an array of the same element type and number of dimensions, or a formal that is one.
    fn open_array_actual(
        &mut self,
        ctx: &mut SclBlock,
        callee: BlockKey,
        formal: &Parameter,
        wanted: &OpenArrayType,
        node: &Node,
        intent: Intent,
    ) -> Option<Actual> {
        if !is_variable(node) {
            return self.wrong_actual(callee, formal, "not a variable", node.span);
        }
        let access = self.access(ctx, node, intent)?;
        // Instructions that accept characters also accept bytes.
        let kin = |element: &DataType| match (element, &wanted.element) {
            (DataType::Elementary(own), DataType::Elementary(wanted)) => {
                self.program.globals.library_block(callee).is_some_and(|block| block.is_tia())
                    && own.bits() == wanted.bits()
                    && [own, wanted].iter().all(|ty| matches!(ty.class(), Class::Bits | Class::Character))
            }
            _ => false,
        };
        let fits = match &access.ty {
            DataType::Array(array) => {
                array.bounds.len() == usize::from(wanted.dimensions)
                    && (layout::same_type(&array.element, &wanted.element) || kin(&array.element))
            }
            DataType::OpenArray(array) => {
                array.dimensions == wanted.dimensions
                    && (layout::same_type(&array.element, &wanted.element) || kin(&array.element))
            }
            _ => false,
        };
        if !fits {
            return self.wrong_actual(callee, formal, &access_type(&access), node.span);
        }
        Some(Actual::Reference(access))
    }

    /// TIMER, COUNTER and BLOCK_x: the number of what is named.
    fn number(
        &mut self,
        ctx: &mut SclBlock,
        callee: BlockKey,
        formal: &Parameter,
        parameter: ParameterType,
        node: &Node,
    ) -> Option<Actual> {
        let value = self.value(ctx, node)?;
        match (parameter, &value) {
            (ParameterType::Timer, Value::Cell { kind: CellKind::Timer, number, .. })
            | (ParameterType::Counter, Value::Cell { kind: CellKind::Counter, number, .. }) => {
                Some(Actual::Number(number.clone()))
            }
            (ParameterType::BlockDb, Value::Block { prefix: BlockPrefix::Db, number, span }) => {
                if let Number::Known(number) = number {
                    self.program.use_db(*number, *span);
                }
                Some(Actual::Number(number.clone()))
            }
            (
                ParameterType::BlockFb,
                Value::Block { prefix: prefix @ (BlockPrefix::Fb | BlockPrefix::Sfb), number, span },
            )
            | (
                ParameterType::BlockFc,
                Value::Block { prefix: prefix @ (BlockPrefix::Fc | BlockPrefix::Sfc), number, span },
            ) => {
                if let (Number::Known(number), Some(kind)) = (number, code_kind(*prefix)) {
                    self.program.interface(BlockKey { kind, number: *number }, *span)?;
                }
                Some(Actual::Number(number.clone()))
            }
            _ => self.wrong_actual(callee, formal, &described(&value), node.span),
        }
    }
}

/// True of an expression whose form could name a variable.
pub fn is_variable(node: &Node) -> bool {
    match &node.kind {
        NodeKind::Name(_)
        | NodeKind::Absolute(_)
        | NodeKind::Member { .. }
        | NodeKind::MemberAbsolute { .. }
        | NodeKind::Slice { .. }
        | NodeKind::Index { .. }
        | NodeKind::Dereference(_) => true,
        // `%MW(#i)`, as the TIA Portal prints indexed addresses.
        NodeKind::Call { callee, .. } => match &callee.kind {
            NodeKind::Name(name) => name.text.starts_with('%'),
            _ => false,
        },
        NodeKind::Literal(_)
        | NodeKind::Reference(_)
        | NodeKind::Unary { .. }
        | NodeKind::Binary { .. }
        | NodeKind::Error => false,
    }
}

/// The type of a variable, for messages.
pub fn access_type(access: &Access) -> String {
    match (access.part, access.elementary()) {
        (Some(_), Some(ty)) => format!("a part of type {}", ty.name()),
        _ => format!("of type {}", layout::type_name(&access.ty)),
    }
}
