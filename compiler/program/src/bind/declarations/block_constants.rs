//! Constants that blocks declare, also those that are arrays and structures.

use std::rc::Rc;

use plcc_binding::constant::Constant;
use plcc_binding::fold;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::layout;
use plcc_model::types::DataType;
use plcc_syntax::ast::{self, InitialKind};
use rustc_hash::FxHashMap;

use crate::bind::declarations::Declarations;
use crate::bind::declarations::path::Base;
use crate::bind::declarations::typed::{BoundInterface, Local, StructBuilder, Typed, Use, is_composite};
use crate::bind::globals::Globals;

impl Declarations<'_> {
    /// `VAR CONSTANT` and CONST. Each can use the ones before it.
    pub fn constants(
        &mut self,
        block: &ast::CodeBlock,
        bound: &mut BoundInterface,
        names: &mut FxHashMap<String, Span>,
    ) {
        let mut data = StructBuilder::default();
        for constant in &block.constants {
            self.declare_name(names, &constant.name, constant.name_span);
            let value = constant.value.as_ref().map(|value| (self.scope_constant(value), value.span));
            let value = value.or_else(|| self.stl_value(constant.initial.as_ref()?));
            let value = match (&constant.ty, value) {
                (None, value) => value.and_then(|(value, _)| value),
                (Some(ty), value) => {
                    let outer = std::mem::replace(&mut self.types.scope.variable, constant.name.clone());
                    let ty = self.resolve_type(ty, Use::Component);
                    self.types.scope.variable = outer;
                    match (ty, value) {
                        (Some(ty), None) if is_composite(&ty.ty) && self.types.scope.scl => {
                            self.constant_data(constant, ty, bound, &mut data);
                            None
                        }
                        (Some(ty), Some((Some(value), span))) => self.typed_constant(value, &ty.ty, span),
                        (Some(ty), None) => self.constant_without_value(&ty, constant),
                        _ => None,
                    }
                }
            };
            let name = fold(&constant.name);
            if let Some(value) = value {
                self.types.scope.constants.entry(name).or_insert(value);
            } else if !bound.locals.contains_key(&name) {
                self.globals.told.constants.insert(name);
            }
        }
        self.constant_block(block, bound, data);
    }

    /// A constant array or structure is a variable in a data block that is never written.
    fn constant_data(
        &mut self,
        constant: &ast::Constant,
        ty: Typed,
        bound: &mut BoundInterface,
        data: &mut StructBuilder,
    ) {
        let mut image = ty.image.to_vec();
        if let Some(initial) = &constant.initial {
            self.encode_initial(initial, &ty.ty, &mut image, 0, 0);
        }
        let ty = Typed { image: Rc::from(image), ..ty };
        let (byte, bit) = data.add(constant.name.clone(), &ty);
        let name = constant.name.clone();
        bound.locals.entry(fold(&name)).or_insert(Local { name, ty: ty.ty, base: Base::Db(0), byte, bit });
    }

    /// The data block for constants in memory, with the highest free number.
    fn constant_block(&mut self, block: &ast::CodeBlock, bound: &mut BoundInterface, data: StructBuilder) {
        let span = block.name.span();
        if bound.locals.is_empty() {
            return;
        }
        let free =
            |number: &u16| !self.globals.sources.data.contains_key(number) && !self.data.blocks.contains_key(number);
        let number = (1..=u16::MAX).rev().find(free);
        let (Some(number), Some(typed)) = (number, self.finish_structure(data, String::new(), None, span)) else {
            return;
        };
        for local in bound.locals.values_mut() {
            local.base = Base::Db(number);
        }
        bound.constant_db = Some(number);
        self.add_constant_db(number, typed, span);
    }

    /// `VAR CONSTANT x : Int; END_VAR`: the start value of a variable of the type.
    fn constant_without_value(&mut self, ty: &Typed, constant: &ast::Constant) -> Option<Constant> {
        match &ty.ty {
            DataType::Elementary(elementary) => {
                let bits = ty.image.iter().fold(0, |bits, byte| bits << 8 | u64::from(*byte));
                Some(Constant::Typed { ty: *elementary, bits })
            }
            DataType::String(_) => Some(Constant::Text { bytes: Vec::new(), typed: true }),
            DataType::WideString(_) => Some(Constant::WideText(Vec::new())),
            DataType::DateAndTime => Some(Constant::DateAndTime(plcc_binding::value::DT_DEFAULT)),
            other => {
                let name = layout::type_name(other);
                self.report(
                    Diagnostic::new(
                        Code::ConstantRequired,
                        constant.name_span,
                        format!("`{}` is a constant without a value", constant.name),
                    )
                    .label(format!("of type {name}"))
                    .help("write its value: `name : type := value;`"),
                );
                None
            }
        }
    }

    fn typed_constant(&mut self, value: Constant, ty: &DataType, span: Span) -> Option<Constant> {
        if let DataType::Elementary(ty) = ty {
            return self.globals.constant_bits(&value, *ty, span).map(|bits| Constant::Typed { ty: *ty, bits });
        }
        if let Err(problem) = Globals::constant_bytes(&value, ty) {
            self.globals.bad_initial(&value.describe(), ty, problem, span);
            return None;
        }
        Some(match (value, ty) {
            (Constant::Text { bytes, .. }, DataType::String(_)) => Constant::Text { bytes, typed: true },
            (value, _) => value,
        })
    }

    /// The value of a constant that STL declares, and where it is written; none of arrays and structures.
    fn stl_value(&mut self, initial: &ast::InitialValue) -> Option<(Option<Constant>, Span)> {
        let constant = match &initial.kind {
            InitialKind::Literal(literal) => self.globals.constant_of_stl(literal, initial.span),
            InitialKind::Expr(value) => self.scope_constant(value),
            InitialKind::Operand(kind) => {
                let constant = self.constant_operand(kind);
                if constant.is_none() {
                    self.not_one_value(initial.span);
                }
                constant
            }
            InitialKind::List(_) | InitialKind::Elements(_) | InitialKind::Repeat { .. } | InitialKind::Fields(_)
                if !self.types.scope.scl =>
            {
                self.not_one_value(initial.span);
                None
            }
            InitialKind::List(_)
            | InitialKind::Elements(_)
            | InitialKind::Repeat { .. }
            | InitialKind::Fields(_)
            | InitialKind::Default => return None,
        };
        Some((constant, initial.span))
    }

    fn not_one_value(&mut self, span: Span) {
        self.report(
            Diagnostic::new(Code::ConstantRequired, span, "a constant is expected here")
                .label("not one value that is known at compile time")
                .help("write one constant of STL, or the name of a constant of the program in quotes"),
        );
    }
}
