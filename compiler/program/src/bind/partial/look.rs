//! Examines the uses of names, to find those that nothing defines and the types that they need.
//!
//! The binder itself finds out what a known part of an expression is, with its messages put aside; anything unknown is taken apart
//! here, and the context shows which type it must have: the other side of an assignment, the parameter of a call, the STL instruction.

use plcc_diag::Span;
use plcc_syntax::ast::{self, BlockName, BlockPrefix, Bound, OperandKind, PathPart, TypeKind, Width};
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind, Literal, Name, NameForm};
use plcc_syntax::scl::{absolute, db_address, db_area_word};
use plcc_syntax::{Elementary, scl};
use rustc_hash::FxHashMap;

use super::evidence::{Evidence, Hint};
use super::inside::descend;
use super::scl::parameter_hint;
use super::write::OPENED_BYTES;
use crate::bind::declarations::Declarations;
use crate::bind::declarations::typed::Use;
use crate::bind::scl::value::Value;
use crate::bind::scl::{SclBinder, SclBlock};
use crate::bind::trees::chart_data::is_step_or_transition;
use plcc_binding::constant::Constant;
use plcc_binding::fold;
use plcc_binding::report::Report;
use plcc_binding::stand_ins::Missing;
use plcc_model::types::{DataType, ParameterType};

/// Examines one program.
pub struct Look<'b, 'a> {
    pub program: &'b mut Declarations<'a>,
    pub found: &'b mut Evidence,
    /// Interfaces as calls describe them, by folded names.
    pub outlines: &'b FxHashMap<String, &'b ast::CodeBlock>,
}

/// A step from a variable into its parts.
#[derive(Clone, Debug)]
pub enum Step {
    Member(String),
    /// Indices that are constants.
    Index(Vec<Option<i64>>),
    /// Bytes up to the end of an address in a data block.
    Absolute(u32),
    /// Bits up to the end of a slice.
    Slice(u32),
}

/// The start of a place.
#[derive(Clone, Debug)]
pub enum Start {
    /// A variable of the block.
    Local(String),
    Global(String),
    Block(BlockPrefix, u32),
}

impl<'b> Look<'b, '_> {
    /// The interface of a missing block, as its calls describe it. `start`: the block, or a variable that is its instance.
    fn outline(&self, ctx: &SclBlock, start: &Start) -> Option<&'b ast::CodeBlock> {
        let name = match start {
            Start::Global(name) => name.clone(),
            Start::Local(name) => {
                let ty = self.declared_type(ctx.block.key, name)?;
                let TypeKind::Block(BlockName::Symbol { name, .. }) = ty.kind else { return None };
                name
            }
            Start::Block(..) => return None,
        };
        self.outlines.get(&fold(&name)).copied()
    }

    /// The type that calls of a missing block state for a parameter.
    pub fn stated(&mut self, ctx: &SclBlock, start: &Start, parameter: &str) -> Option<Hint> {
        let mut sections = self.outline(ctx, start)?.sections.iter();
        let (kind, ty) = sections.find_map(|section| {
            let variable = section.variables.iter().find(|variable| fold(&variable.name) == fold(parameter))?;
            Some((section.kind, &variable.ty))
        })?;
        let typed = self.quietly(|program| program.resolve_type(ty, Use::Parameter(kind)))?;
        parameter_hint(&typed.ty)
    }

    /// The type that calls of a missing function state for its value.
    pub fn stated_value(&mut self, ctx: &SclBlock, start: &Start) -> Option<Hint> {
        let ty = self.outline(ctx, start)?.return_type.as_ref()?;
        let typed = self.quietly(|program| program.resolve_type(ty, Use::Result))?;
        parameter_hint(&typed.ty)
    }
}

impl<'a> Look<'_, 'a> {
    /// The result of `ask`, without messages.
    pub fn quietly<T>(&mut self, ask: impl FnOnce(&mut Declarations<'a>) -> T) -> T {
        let report = std::mem::replace(&mut self.program.globals.report, Report::new(true));
        let answer = ask(self.program);
        self.program.globals.report = report;
        answer
    }

    /// The type of an expression, if all of it is known.
    pub fn hint_of(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Hint> {
        if let NodeKind::Absolute(OperandKind::Cell { kind, number }) = &node.kind {
            self.found.cells.insert((*kind, *number));
        }
        if let NodeKind::Name(name) = &node.kind
            && let Some(OperandKind::Cell { kind, number }) = absolute(&name.text)
        {
            self.found.cells.insert((kind, number));
        }
        if matches!(node.kind, NodeKind::Literal(Literal::Null)) {
            return Some(Hint::Type(DataType::Parameter(ParameterType::Variant)));
        }
        let (value, clean) = self.quietly(|program| {
            let value = SclBinder::new(program).value(ctx, node);
            (value, program.globals.report.is_clean())
        });
        let is_address = matches!(&node.kind, NodeKind::Absolute(_) | NodeKind::MemberAbsolute { .. })
            || matches!(&node.kind, NodeKind::Name(name) if name.form == NameForm::Bare && absolute(&name.text).is_some());
        let hint = match value? {
            Value::Elementary(expr) if is_address && expr.ty != Elementary::Bool => Hint::Width(expr.ty),
            Value::Elementary(expr) => Hint::Type(DataType::Elementary(expr.ty)),
            Value::Constant(Constant::Dtl(_), _) => {
                Hint::Type(self.quietly(|program| program.predefined("DTL", node.span))?.ty)
            }
            Value::Constant(constant, _) => of_constant(&constant),
            Value::Complex { ty, .. } => Hint::Type(ty),
            Value::Parameter { access, .. } => Hint::Type(access.ty),
            Value::Cell { kind, .. } => Hint::Cell(kind),
            Value::Block { prefix: BlockPrefix::Db | BlockPrefix::Di, .. } => Hint::DataBlock,
            Value::Block { .. } | Value::Nothing(_) | Value::Statements(..) => return None,
        };
        clean.then_some(hint)
    }

    /// Steps of an SCL expression that names a place, outermost last; none if it is not a place.
    pub fn steps(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<(Start, Vec<Step>, Span)> {
        let mut steps = Vec::new();
        let mut at = node;
        loop {
            match &at.kind {
                NodeKind::Name(name) => {
                    steps.reverse();
                    let start = self.start_of(ctx, name, steps.iter().any(|step| !matches!(step, Step::Slice(_))))?;
                    return Some((start, address_steps(steps), name.span));
                }
                NodeKind::Absolute(OperandKind::Block(BlockName::Numbered { prefix, number, .. })) => {
                    steps.reverse();
                    return Some((Start::Block(*prefix, *number), address_steps(steps), at.span));
                }
                NodeKind::Absolute(OperandKind::DbAbsolute { db, width, byte, .. }) => {
                    let start = match db {
                        BlockName::Numbered { prefix, number, .. } => Start::Block(*prefix, *number),
                        BlockName::Symbol { name, .. } => Start::Global(name.clone()),
                    };
                    return Some((start, vec![Step::Absolute(byte.saturating_add(width.bytes()))], at.span));
                }
                NodeKind::Member { base, name } => {
                    let text = name.text.strip_suffix(":P").or_else(|| name.text.strip_suffix(":p"));
                    steps.push(Step::Member(text.unwrap_or(&name.text).to_string()));
                    at = base;
                }
                NodeKind::MemberAbsolute { base, width, byte, .. } => {
                    steps.push(Step::Absolute(byte.saturating_add(width.bytes())));
                    at = base;
                }
                NodeKind::Slice { base, width, index } => {
                    steps.push(Step::Slice(index.saturating_add(1).saturating_mul(width.bits())));
                    at = base;
                }
                NodeKind::Index { base, indices } => {
                    let mut known = Vec::with_capacity(indices.len());
                    for index in indices {
                        known.push(self.number(ctx, index));
                        self.expect(ctx, index, Some(&Hint::Literal(DataType::Elementary(Elementary::Int))));
                    }
                    match self.indexed(ctx, base, &known).filter(|_| steps.is_empty()) {
                        Some((end, db)) => {
                            steps.push(Step::Absolute(end));
                            at = db;
                        }
                        None => {
                            steps.push(Step::Index(known));
                            at = base;
                        }
                    }
                }
                _ => return None,
            }
        }
    }

    /// The data block of `DB10.DW[i]` or `"Data".DX[i, 7]` in S7-SCL, and the bytes that the address reaches. `base`: what is before
    /// the indices.
    fn indexed<'n>(&mut self, ctx: &SclBlock, base: &'n Node, indices: &[Option<i64>]) -> Option<(u32, &'n Node)> {
        let NodeKind::Member { base: db, name } = &base.kind else { return None };
        let width = db_area_word(name.text.strip_prefix('%').unwrap_or(&name.text))?;
        let is_area = name.form == NameForm::Bare
            && ctx.scope.rules.is_300()
            && indices.len() == if width == Width::Bit { 2 } else { 1 };
        let is_block = match &db.kind {
            NodeKind::Name(name) => matches!(self.start_of(ctx, name, true)?, Start::Global(_) | Start::Block(..)),
            NodeKind::Absolute(OperandKind::Block(_)) => true,
            _ => false,
        };
        let end = match indices.first()?.map(u32::try_from) {
            Some(Ok(byte)) => byte.saturating_add(width.bytes()),
            _ => OPENED_BYTES,
        };
        (is_area && is_block).then_some((end, &**db))
    }

    /// An integer whose value is known now.
    fn number(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<i64> {
        match self.quietly(|program| program.globals.constant(&ctx.block.bound.constants, node))? {
            Constant::Integer { value, .. } => i64::try_from(value).ok(),
            Constant::Typed { ty, bits } if ty.is_integer() => {
                i64::try_from(Constant::Typed { ty, bits }.integer()?).ok()
            }
            _ => None,
        }
    }

    /// `has_steps`: components or elements follow.
    fn start_of(&mut self, ctx: &SclBlock, name: &Name, has_steps: bool) -> Option<Start> {
        let text = name.text.trim();
        let local = ctx.block.bound.locals.contains_key(&fold(text));
        let has_value_alone = || {
            let ty = self.declared_type(ctx.block.key, text);
            ty.is_some_and(|ty| matches!(&ty.kind, TypeKind::Named(name) if Elementary::from_word(name).is_some()))
        };
        // The data of a step or transition as a whole are not a value: `"Start"` is a symbol.
        let is_step = ctx.scope.address_numbers
            && ctx.block.bound.locals.get(&fold(text)).is_some_and(|local| is_step_or_transition(&local.ty));
        match name.form {
            NameForm::Local => return local.then(|| Start::Local(text.to_string())),
            NameForm::Bare if local => return Some(Start::Local(text.to_string())),
            // `"Link".client` is not of a local BOOL `link`, but of a data block that is missing.
            NameForm::Quoted
                if local
                    && !ctx.scope.marks_locals
                    && self.program.globals.global(text).is_none()
                    && !self.is_missing(text)
                    && !(has_steps && has_value_alone())
                    && (has_steps || !is_step) =>
            {
                return Some(Start::Local(text.to_string()));
            }
            NameForm::Bare => {
                let word = text.strip_prefix('%').unwrap_or(text);
                if let Some(OperandKind::Block(BlockName::Numbered { prefix, number, .. })) = absolute(word) {
                    return Some(Start::Block(prefix, number));
                }
                if absolute(word).is_some()
                    || scl::area_word(word).is_some()
                    || ["OK", "EN", "ENO"].iter().any(|known| known.eq_ignore_ascii_case(word))
                {
                    return None;
                }
            }
            NameForm::Quoted => {}
        }
        let text = text.strip_suffix(":P").or_else(|| text.strip_suffix(":p")).unwrap_or(text);
        (!text.is_empty()).then(|| Start::Global(text.to_string()))
    }

    /// True of a name that an earlier look has found to be missing.
    pub fn is_missing(&self, name: &str) -> bool {
        self.found.things.contains_key(&Missing::name(name))
    }

    /// Notes a use of a place that the binder does not know.
    pub fn note(&mut self, ctx: &SclBlock, start: &Start, steps: &[Step], span: Span, hint: Option<&Hint>) {
        // A tag may have the name of a function of the library, which has no value without a call.
        if let Start::Global(name) = start
            && !self.program.globals.is_defined(name)
        {
            return descend(self.found.of(Missing::name(name), name, span), steps, &mut |shape| shape.learn(hint));
        }
        self.with_shape(ctx, start, steps, span, &mut |shape| shape.learn(hint));
    }
}

/// `DB10.DW4`: the component is an address.
fn address_steps(steps: Vec<Step>) -> Vec<Step> {
    match steps.first() {
        Some(Step::Member(name)) => match db_address(name) {
            Some((width, byte)) => vec![Step::Absolute(byte.saturating_add(width.bytes()))],
            None => steps,
        },
        _ => steps,
    }
}

/// A step of a path in STL.
pub fn step_of_part(part: &PathPart) -> Step {
    match part {
        PathPart::Member { name, .. } => Step::Member(name.clone()),
        PathPart::Index { values, .. } => Step::Index(
            values
                .iter()
                .map(|value| match value {
                    Bound::Number(number, _) => Some(*number),
                    Bound::Name(..) | Bound::Expr(_) | Bound::Path(_) => None,
                })
                .collect(),
        ),
    }
}

/// The type of a constant alone.
pub fn of_constant(constant: &Constant) -> Hint {
    let elementary = |ty| Hint::Literal(DataType::Elementary(ty));
    match constant {
        Constant::Integer { value, based: true } => elementary(match *value {
            0..=0xFFFF => Elementary::Word,
            0x1_0000..=0xFFFF_FFFF => Elementary::Dword,
            _ => Elementary::Lword,
        }),
        Constant::Integer { value, based: false } => elementary(match *value {
            -0x8000..=0x7FFF => Elementary::Int,
            -0x8000_0000..=0x7FFF_FFFF => Elementary::Dint,
            _ => Elementary::Lint,
        }),
        Constant::Real(_) => elementary(Elementary::Real),
        Constant::Typed { ty, .. } => Hint::Type(DataType::Elementary(*ty)),
        Constant::Text { .. } => Hint::Literal(DataType::String(254)),
        Constant::WideText(_) => Hint::Literal(DataType::WideString(254)),
        Constant::DateAndTime(_) => Hint::Type(DataType::DateAndTime),
        Constant::Dtl(_) => Hint::Literal(DataType::Elementary(Elementary::Dint)),
    }
}

/// The type of an address of this width.
pub const fn of_width(width: Width) -> Elementary {
    crate::bind::declarations::path::type_of_width(width)
}
