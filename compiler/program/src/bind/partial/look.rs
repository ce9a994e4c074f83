//! Examines the uses of names, to find those that nothing defines and the types that they need.
//!
//! The binder itself finds out what a known part of an expression is, with its messages put aside; anything unknown is taken apart
//! here, and the context shows which type it must have: the other side of an assignment, the parameter of a call, the STL instruction.

use plcc_diag::Span;
use plcc_syntax::ast::{
    self, BlockName, BlockPrefix, Bound, OperandKind, PathPart, PathRoot, TypeKind, TypeRef, Width,
};
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind, Literal, Name, NameForm};
use plcc_syntax::scl::{absolute, db_address};
use plcc_syntax::{Elementary, scl};

use super::evidence::{Evidence, Hint, Shape};
use crate::bind::declarations::Declarations;
use crate::bind::scl::value::Value;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_abi::image::BlockKind;
use plcc_binding::constant::Constant;
use plcc_binding::fold;
use plcc_binding::report::Report;
use plcc_binding::stand_ins::Missing;
use plcc_model::BlockKey;
use plcc_model::types::{DataType, ParameterType};
use plcc_syntax::symbols::SymbolTarget;

/// Examines one program.
pub struct Look<'b, 'a> {
    pub program: &'b mut Declarations<'a>,
    pub found: &'b mut Evidence,
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
                    steps.push(Step::Member(name.text.clone()));
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
                    steps.push(Step::Index(known));
                    at = base;
                }
                _ => return None,
            }
        }
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
        match name.form {
            NameForm::Local => return local.then(|| Start::Local(text.to_string())),
            NameForm::Bare if local => return Some(Start::Local(text.to_string())),
            // `"Link".client` is not of a local BOOL `link`, but of a data block that is missing.
            NameForm::Quoted
                if local
                    && self.program.globals.global(text).is_none()
                    && !self.is_missing(text)
                    && !(has_steps && has_value_alone()) =>
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
            && !self.program.globals.names.symbols.contains_key(&fold(name))
            && !self.program.globals.names.constants.contains_key(&fold(name))
        {
            return descend(self.found.of(Missing::name(name), name, span), steps, &mut |shape| shape.learn(hint));
        }
        self.with_shape(ctx, start, steps, span, &mut |shape| shape.learn(hint));
    }

    /// Shows `teach` the missing name that a place is, or is part of.
    pub fn with_shape(
        &mut self,
        ctx: &SclBlock,
        start: &Start,
        steps: &[Step],
        span: Span,
        teach: &mut dyn FnMut(&mut Shape),
    ) {
        match start {
            Start::Local(name) => {
                let Some(ty) = self.declared_type(ctx.block.key, name) else { return };
                self.inside_type(&ty, steps, span, teach, 0);
            }
            Start::Global(name) => {
                let missing = Missing::name(name);
                match self.program.globals.global(name) {
                    _ if self.found.things.contains_key(&missing) => {
                        descend(self.found.of(missing, name, span), steps, teach)
                    }
                    None if self.program.globals.names.constants.contains_key(&fold(name)) => {}
                    None => descend(self.found.of(missing, name, span), steps, teach),
                    Some(SymbolTarget::Block { prefix: BlockPrefix::Db, number }) => {
                        self.inside_db(number, name, steps, span, teach);
                    }
                    Some(SymbolTarget::Block { prefix, number }) => {
                        self.numbered(prefix, number, name, steps, span, teach)
                    }
                    Some(SymbolTarget::Memory { .. }) => {
                        let structure = self
                            .program
                            .globals
                            .names
                            .symbols
                            .get(&fold(name))
                            .and_then(|global| global.structure.clone());
                        if let Some(name) = structure {
                            let name = BlockName::Symbol { name, span };
                            self.inside_type(&TypeRef { kind: TypeKind::Block(name), span }, steps, span, teach, 0);
                        }
                    }
                    Some(SymbolTarget::Cell { .. }) => {}
                }
            }
            Start::Block(BlockPrefix::Db | BlockPrefix::Di, number) => {
                self.inside_db(*number, &format!("DB {number}"), steps, span, teach);
            }
            Start::Block(prefix, number) => {
                self.numbered(*prefix, *number, &format!("{} {number}", prefix.letters()), steps, span, teach);
            }
        }
    }

    fn numbered(
        &mut self,
        prefix: BlockPrefix,
        number: u32,
        name: &str,
        steps: &[Step],
        span: Span,
        teach: &mut dyn FnMut(&mut Shape),
    ) {
        let Some(missing) = Missing::block(prefix, number) else { return };
        if self.found.things.contains_key(&missing) || !self.is_block(prefix, number) {
            descend(self.found.of(missing, name, span), steps, teach);
        }
    }

    /// True if a source or the library defines the block.
    pub fn is_block(&mut self, prefix: BlockPrefix, number: u32) -> bool {
        let Ok(number) = u16::try_from(number) else { return true };
        if self.program.globals.names.defined.contains_key(&(prefix, number)) {
            return true;
        }
        match crate::bind::globals::names::code_kind(prefix) {
            Some(kind) => {
                let key = BlockKey { kind, number };
                self.program.globals.sources.code.contains_key(&key) || self.program.globals.in_library(key)
            }
            None => false,
        }
    }

    fn inside_db(&mut self, number: u32, name: &str, steps: &[Step], span: Span, teach: &mut dyn FnMut(&mut Shape)) {
        let Ok(narrow) = u16::try_from(number) else { return };
        let Some(missing) = Missing::block(BlockPrefix::Db, number) else { return };
        let source = self.program.globals.sources.data.get(&narrow).copied();
        match source {
            _ if self.found.things.contains_key(&missing) => {
                descend(self.found.of(missing, name, span), steps, teach);
            }
            // A symbol table names it, but no source defines it.
            None if !self.program.data.blocks.contains_key(&narrow) && number != 0 => {
                descend(self.found.of(missing, name, span), steps, teach);
            }
            None => {}
            Some(source) => match &source.content {
                ast::DataContent::Struct(variables) => {
                    let Some((Step::Member(member), rest)) = steps.split_first() else { return };
                    match variables.iter().find(|variable| fold(&variable.name) == fold(member)) {
                        Some(variable) => {
                            let ty = variable.ty.clone();
                            self.inside_type(&ty, rest, span, teach, 0);
                        }
                        // A component of another version of the data block.
                        None => descend(self.found.added(source.name.span(), name), steps, teach),
                    }
                }
                ast::DataContent::OfType(ty) => self.inside_type(ty, steps, span, teach, 0),
                ast::DataContent::Array(ty, _) => match steps.split_first() {
                    Some((Step::Member(_), rest)) => self.inside_type(ty, rest, span, teach, 0),
                    _ => self.inside_type(ty, steps, span, teach, 0),
                },
                ast::DataContent::Empty => {}
            },
        }
    }

    /// The type in the declaration of a variable of a block.
    fn declared_type(&self, key: BlockKey, name: &str) -> Option<TypeRef> {
        let source = self.program.globals.sources.code.get(&key)?;
        let block = source.block();
        let mut variables = block.sections.iter().flat_map(|section| &section.variables);
        let variable = variables.find(|variable| fold(&variable.name) == fold(name));
        variable.map(|variable| variable.ty.clone()).or_else(|| block.return_type.clone())
    }

    /// Follows steps through declarations until one is missing.
    pub fn inside_type(
        &mut self,
        ty: &TypeRef,
        steps: &[Step],
        span: Span,
        teach: &mut dyn FnMut(&mut Shape),
        depth: u32,
    ) {
        const DEPTH_MAX: u32 = 32;
        if depth > DEPTH_MAX {
            return;
        }
        match &ty.kind {
            TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } | TypeKind::Reference(element) => {
                let rest = match steps.split_first() {
                    Some((Step::Index(_), rest)) => rest,
                    _ => steps,
                };
                self.inside_type(element, rest, span, teach, depth + 1);
            }
            TypeKind::Struct(variables) => self.inside_members(variables, steps, span, teach, depth),
            TypeKind::Named(word) => {
                let name = BlockName::Symbol { name: word.clone(), span: ty.span };
                if !is_type_word(word) {
                    self.inside_named(&name, steps, span, teach, depth);
                }
            }
            TypeKind::Block(name) => self.inside_named(name, steps, span, teach, depth),
            TypeKind::String(_) | TypeKind::WideString(_) | TypeKind::Error => {}
        }
    }

    fn inside_members(
        &mut self,
        variables: &[ast::Variable],
        steps: &[Step],
        span: Span,
        teach: &mut dyn FnMut(&mut Shape),
        depth: u32,
    ) {
        if let Some((Step::Member(name), rest)) = steps.split_first()
            && let Some(variable) = variables.iter().find(|variable| fold(&variable.name) == fold(name))
        {
            let ty = variable.ty.clone();
            self.inside_type(&ty, rest, span, teach, depth + 1);
        }
    }

    fn inside_named(
        &mut self,
        name: &BlockName,
        steps: &[Step],
        span: Span,
        teach: &mut dyn FnMut(&mut Shape),
        depth: u32,
    ) {
        let (prefix, number, missing, text) = match name {
            BlockName::Symbol { name: text, span: place } => {
                let missing = Missing::name(text);
                let known = self.quietly(|program| {
                    program.type_block(text).or_else(|| match program.globals.global(text) {
                        Some(SymbolTarget::Block { prefix, number }) => Some((prefix, number as u16)),
                        _ => None,
                    })
                });
                match known {
                    Some((prefix, number)) if !self.found.things.contains_key(&missing) => {
                        (prefix, u32::from(number), None, text.clone())
                    }
                    _ => {
                        let predefined = self.quietly(|program| program.predefined(text, *place).is_some());
                        if predefined {
                            return;
                        }
                        (BlockPrefix::Udt, 0, Some(missing), text.clone())
                    }
                }
            }
            BlockName::Numbered { prefix, number, .. } => {
                (*prefix, *number, None, format!("{} {number}", prefix.letters()))
            }
        };
        let missing = match missing {
            Some(missing) => Some(missing),
            None => Missing::block(prefix, number)
                .filter(|missing| self.found.things.contains_key(missing) || !self.is_block(prefix, number)),
        };
        if let Some(missing) = missing {
            let shape = self.found.of(missing, &text, span);
            shape.is_type = true;
            descend(shape, steps, teach);
            return;
        }
        let Ok(number) = u16::try_from(number) else { return };
        match prefix {
            BlockPrefix::Udt => {
                let Some(&block) = self.program.globals.sources.types.get(&number) else { return };
                match &block.alias {
                    Some(ty) => self.inside_type(ty, steps, span, teach, depth + 1),
                    None => self.inside_members(&block.members, steps, span, teach, depth + 1),
                }
            }
            BlockPrefix::Fb => {
                let Some((Step::Member(name), rest)) = steps.split_first() else { return };
                if let Some(ty) = self.declared_type(BlockKey { kind: BlockKind::Fb, number }, name) {
                    self.inside_type(&ty, rest, span, teach, depth + 1);
                }
            }
            _ => {}
        }
    }

    /// Examines all types of declarations, used or not.
    pub fn declarations(&mut self, block: &ast::Block) {
        match block {
            ast::Block::Code(code) => {
                for variable in code.sections.iter().flat_map(|section| &section.variables) {
                    self.declared(variable);
                }
                if let Some(ty) = &code.return_type {
                    self.declared_as(ty);
                }
                for constant in &code.constants {
                    if let Some(ty) = &constant.ty {
                        self.declared_as(ty);
                    }
                    if let (Some(ty), Some(initial)) = (&constant.ty, &constant.initial) {
                        self.initial_names(initial);
                        self.initial_fields(ty, &mut Vec::new(), initial);
                    }
                    constant.value.iter().for_each(|value| self.constant_names(value, None));
                }
            }
            ast::Block::Data(data) => match &data.content {
                ast::DataContent::Struct(variables) => {
                    variables.iter().for_each(|variable| self.declared(variable));
                    let ty = TypeRef { kind: TypeKind::Struct(variables.clone()), span: data.span };
                    data.values.iter().for_each(|value| self.start_value(&ty, value));
                }
                ast::DataContent::OfType(ty) => {
                    self.declared_as(ty);
                    data.values.iter().for_each(|value| self.start_value(ty, value));
                }
                ast::DataContent::Array(ty, _) => self.declared_as(ty),
                ast::DataContent::Empty => {}
            },
            ast::Block::Type(ty) => {
                ty.members.iter().for_each(|variable| self.declared(variable));
                if let Some(alias) = &ty.alias {
                    self.declared_as(alias);
                }
            }
        }
    }

    fn declared(&mut self, variable: &ast::Variable) {
        self.declared_as(&variable.ty);
        if let Some(initial) = &variable.initial {
            self.initial_names(initial);
            self.initial_fields(&variable.ty, &mut Vec::new(), initial);
        }
    }

    /// Start values of components whose type is missing.
    fn initial_fields(&mut self, ty: &TypeRef, steps: &mut Vec<Step>, initial: &ast::InitialValue) {
        match &initial.kind {
            ast::InitialKind::Fields(fields) => {
                for (name, value) in fields {
                    let Some(name) = name else { continue };
                    steps.push(Step::Member(name.text.clone()));
                    self.initial_fields(ty, steps, value);
                    steps.pop();
                }
            }
            // Elements of an array have one type.
            ast::InitialKind::List(values) | ast::InitialKind::Repeat { values, .. } => {
                values.iter().for_each(|value| self.initial_fields(ty, steps, value));
            }
            ast::InitialKind::Elements(elements) => {
                elements.iter().for_each(|(_, value)| self.initial_fields(ty, steps, value));
            }
            ast::InitialKind::Literal(_) | ast::InitialKind::Expr(_) | ast::InitialKind::Operand(_) => {
                let hint = self.initial_hint(initial);
                if !steps.is_empty() {
                    self.inside_type(ty, steps, initial.span, &mut |shape| shape.learn(hint.as_ref()), 0);
                }
            }
            ast::InitialKind::Default => {}
        }
    }

    /// The type of a start value.
    fn initial_hint(&mut self, initial: &ast::InitialValue) -> Option<Hint> {
        match &initial.kind {
            ast::InitialKind::Literal(literal) => Constant::of_stl(literal).map(|constant| of_constant(&constant)),
            ast::InitialKind::Expr(node) => {
                let none = plcc_binding::constant::Constants::default();
                self.quietly(|program| program.globals.constant(&none, node)).map(|constant| of_constant(&constant))
            }
            _ => None,
        }
    }

    fn initial_names(&mut self, initial: &ast::InitialValue) {
        match &initial.kind {
            ast::InitialKind::Expr(value) => self.constant_names(value, None),
            ast::InitialKind::List(values) => values.iter().for_each(|value| self.initial_names(value)),
            ast::InitialKind::Repeat { count, values } => {
                self.bound_names(count);
                values.iter().for_each(|value| self.initial_names(value));
            }
            ast::InitialKind::Elements(elements) => elements.iter().for_each(|(_, value)| self.initial_names(value)),
            ast::InitialKind::Fields(fields) => fields.iter().for_each(|(_, value)| self.initial_names(value)),
            ast::InitialKind::Literal(_) | ast::InitialKind::Operand(_) | ast::InitialKind::Default => {}
        }
    }

    fn bound_names(&mut self, bound: &Bound) {
        match bound {
            Bound::Number(..) => {}
            Bound::Name(name, span) => self.missing_constant(name, *span, None),
            Bound::Expr(value) => self.constant_names(value, None),
            // Only indices in code of STL are paths.
            Bound::Path(_) => {}
        }
    }

    /// Types that a declaration names.
    fn declared_as(&mut self, ty: &TypeRef) {
        match &ty.kind {
            TypeKind::Array { bounds, element } => {
                for (low, high) in bounds {
                    self.bound_names(low);
                    self.bound_names(high);
                }
                self.declared_as(element);
            }
            TypeKind::OpenArray { element, .. } | TypeKind::Reference(element) => self.declared_as(element),
            TypeKind::Struct(variables) => variables.iter().for_each(|variable| self.declared(variable)),
            TypeKind::String(Some(bound)) | TypeKind::WideString(Some(bound)) => self.bound_names(bound),
            TypeKind::String(None) | TypeKind::WideString(None) | TypeKind::Error => {}
            TypeKind::Named(_) | TypeKind::Block(_) => self.inside_type(ty, &[], ty.span, &mut |_| {}, 0),
        }
    }

    /// A start value of a data block whose type is missing.
    fn start_value(&mut self, ty: &TypeRef, value: &ast::ValueAssignment) {
        let (PathRoot::Local { name, .. } | PathRoot::Quoted { name, .. } | PathRoot::Bare { name, .. }) =
            &value.target.root
        else {
            return;
        };
        let mut steps = vec![Step::Member(name.clone())];
        steps.extend(value.target.parts.iter().map(step_of_part));
        let hint = self.initial_hint(&value.value);
        self.inside_type(ty, &steps, value.span, &mut |shape| shape.learn(hint.as_ref()), 0);
    }

    /// Names in an expression that must be constant.
    pub fn constant_names(&mut self, node: &Node, hint: Option<&Hint>) {
        match &node.kind {
            NodeKind::Name(name) if name.form != NameForm::Local => self.missing_constant(&name.text, name.span, hint),
            NodeKind::Unary { operand, .. } => self.constant_names(operand, hint),
            NodeKind::Binary { left, right, .. } => {
                self.constant_names(left, hint);
                self.constant_names(right, hint);
            }
            NodeKind::Call { arguments, .. } => {
                for value in arguments.iter().filter_map(|argument| argument.value.as_ref()) {
                    self.constant_names(value, None);
                }
            }
            _ => {}
        }
    }

    fn missing_constant(&mut self, name: &str, span: Span, hint: Option<&Hint>) {
        let folded = fold(name);
        // Constants of blocks are looked up in their own lists first.
        let own = self.program.types.scope.constants.contains_key(&folded)
            || self.program.globals.input.units.iter().flat_map(|(_, unit)| &unit.blocks).any(|block| match block {
                ast::Block::Code(code) if code.span.file == span.file => {
                    code.constants.iter().any(|constant| fold(&constant.name) == folded)
                }
                _ => false,
            });
        let missing = Missing::name(name);
        let known = own
            || self.program.globals.names.constants.contains_key(&folded)
            || self.program.globals.global(name).is_some()
            || absolute(name).is_some();
        if !known || self.found.things.contains_key(&missing) {
            let shape = self.found.of(missing, name, span);
            shape.is_constant = true;
            shape.learn(hint);
        }
    }
}

/// Follows a step into a missing name.
fn descend(shape: &mut Shape, steps: &[Step], teach: &mut dyn FnMut(&mut Shape)) {
    match steps.split_first() {
        None => teach(shape),
        Some((Step::Member(name), rest)) => descend(shape.member(name), rest, teach),
        Some((Step::Index(indices), rest)) => descend(shape.element(indices), rest, teach),
        Some((Step::Absolute(end), _)) => {
            shape.extent = shape.extent.max(*end);
            shape.is_db = true;
        }
        Some((Step::Slice(bits), _)) => {
            let ty = match bits {
                0..=8 => Elementary::Byte,
                9..=16 => Elementary::Word,
                17..=32 => Elementary::Dword,
                _ => Elementary::Lword,
            };
            shape.learn(Some(&Hint::Width(ty)));
        }
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

/// Words that are types without a declaration.
fn is_type_word(word: &str) -> bool {
    Elementary::from_word(word).is_some()
        || matches!(
            word,
            "DATE_AND_TIME"
                | "DT"
                | "STRING"
                | "WSTRING"
                | "TIMER"
                | "COUNTER"
                | "BLOCK_FB"
                | "BLOCK_FC"
                | "BLOCK_DB"
                | "BLOCK_SDB"
                | "POINTER"
                | "ANY"
                | "VARIANT"
                | "VOID"
        )
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
