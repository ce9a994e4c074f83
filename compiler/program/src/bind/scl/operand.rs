//! What one name or one operand means: locals, symbols, constants, `OK`, `MW10`, `T5`, `DB10`.
//!
//! Source: SCL reference, case and names; addressing.

use plcc_binding::fold;
use plcc_diag::{Code, Span};
use plcc_model::scl::{Expr, ExprKind, Part};
use plcc_model::types::{DataType, ParameterType};
use plcc_model::{Number, layout};
use plcc_syntax::Elementary;
use plcc_syntax::ast::{Area, BlockName, BlockPrefix, CellKind, OperandKind, Width};
use plcc_syntax::scl::ast::{Name, NameForm};
use plcc_syntax::scl::{absolute, area_word};

use super::Intent;
use super::flow::own_value;
use super::place::{Db, Spot, Thing};
use super::scope::TempUse;
use crate::bind::declarations::path::{self, Resolved, Variable, type_of_width};
use crate::bind::scl::{SclBinder, SclBlock};

impl SclBinder<'_, '_> {
    pub(super) fn name_thing(&mut self, ctx: &mut SclBlock, name: &Name, intent: Intent) -> Option<Thing> {
        let text = name.text.as_str();
        if let Some(variable) = ctx.scope.hidden.get(text) {
            return Some(Thing::Spot(Spot::fixed(variable.clone())));
        }
        let names = &self.program.globals.names;
        let is_confused = names.confused.get(&fold(text)).is_some_and(|constant| constant == text);
        let global = names.symbols.contains_key(&fold(text)) && !is_confused;
        let is_global = global || names.constants.contains_key(&fold(text));
        let elsewhere = is_global && name.form == NameForm::Quoted || self.is_unknown_global(ctx, name);
        if elsewhere
            && !global
            && let Some(constant) = ctx.block.bound.constants.get(&fold(text))
        {
            return Some(Thing::Constant(constant.clone()));
        }
        if !elsewhere || self.is_own_name(ctx, name) {
            let own = if self.is_own_name(ctx, name) { "RET_VAL" } else { text };
            if let Some(variable) = self.program.local(ctx.block, text).or_else(|| self.program.local(ctx.block, own)) {
                self.note_use(ctx, &variable, text, intent, name.span);
                return self.local_thing(ctx, variable);
            }
            if let Some(constant) = ctx.block.bound.constants.get(&fold(text)) {
                return Some(Thing::Constant(constant.clone()));
            }
            if self.program.is_refused_constant(ctx.block, text) {
                return None;
            }
        }
        match name.form {
            NameForm::Local => {
                self.program.unknown_local(ctx.block, text, name.span);
                return None;
            }
            NameForm::Bare if !global => {
                if let Some(thing) = self.word_thing(ctx, text, name.span) {
                    return thing;
                }
            }
            NameForm::Bare | NameForm::Quoted => {}
        }
        if !global
            && name.form == NameForm::Quoted
            && let Some(tag) = text.strip_suffix(":P").or_else(|| text.strip_suffix(":p"))
        {
            return self.peripheral_tag(ctx, tag, name.span);
        }
        if !global && let Some(constant) = self.program.globals.names.constants.get(&fold(text)) {
            return Some(Thing::Constant(constant.clone()));
        }
        if !global && name.form == NameForm::Quoted {
            if let Some(constant) = self.program.globals.system_constant(text) {
                return Some(Thing::Constant(constant));
            }
            if self.program.globals.missing_hardware(text, name.span) {
                return None;
            }
        }
        match self.program.resolve_global(ctx.block, text, name.span)? {
            Resolved::Variable(variable) => Some(Thing::Spot(Spot::fixed(variable))),
            Resolved::Cell { kind, number } => self.cell(kind, number, name.span),
            Resolved::Block { prefix, number } => Some(block_thing(prefix, Number::Known(number))),
        }
    }

    /// Words with their own meaning: `OK`, `ENO`, `MW10`, `T5`, `DB10`, `MW` before an index.
    fn word_thing(&mut self, ctx: &mut SclBlock, text: &str, span: Span) -> Option<Option<Thing>> {
        let rules = ctx.scope.rules;
        if text.eq_ignore_ascii_case("OK") {
            return Some(Some(Thing::Flag));
        }
        if text.eq_ignore_ascii_case("ENO") {
            return Some(Some(if rules == super::Rules::Classic { Thing::LastEno } else { Thing::Flag }));
        }
        let word = text.strip_prefix('%').unwrap_or(text);
        if let Some(operand) = absolute(word) {
            return Some(self.operand_thing(ctx, &operand, span));
        }
        let (area, width) = area_word(word)?;
        Some(Some(Thing::Area(area, width)))
    }

    /// How the block writes its own value, if it is a function that has one.
    pub(super) fn own_value(&self, ctx: &SclBlock) -> Option<String> {
        let has_value = ctx.block.bound.interface.parameters.iter().any(|parameter| parameter.name == "RET_VAL");
        let source = self.program.globals.sources.code.get(&ctx.block.key).filter(|_| has_value)?;
        Some(own_value(&source.block().name))
    }

    /// The name is that of the function itself.
    fn is_own_name(&self, ctx: &SclBlock, name: &Name) -> bool {
        use plcc_abi::image::BlockKind;
        if !matches!(ctx.block.key.kind, BlockKind::Fc | BlockKind::Sfc) {
            return false;
        }
        let wanted = fold(&name.text);
        let prefix = crate::bind::globals::names::kind_prefix(ctx.block.key.kind);
        fold(&self.program.globals.names.block_name(prefix, ctx.block.key.number)) == wanted
            || wanted.split_whitespace().collect::<String>() == format!("fc{}", ctx.block.key.number)
            || (ctx.block.key.number >= 1000 || ctx.block.key.kind == BlockKind::Sfc)
                && self
                    .program
                    .globals
                    .sources
                    .code
                    .get(&ctx.block.key)
                    .is_some_and(|source| source.block().header.name.as_deref().is_some_and(|own| fold(own) == wanted))
    }

    fn note_use(&self, ctx: &mut SclBlock, variable: &Variable, name: &str, intent: Intent, span: Span) {
        let bytes = layout::bytes(&variable.ty);
        match variable.base {
            // Data without a type has a message at its declaration.
            path::Base::L if variable.ty != DataType::Void => {
                let (first, end) = (variable.byte, variable.byte + bytes);
                match intent {
                    Intent::Read => {
                        ctx.scope.temp_reads.push(TempUse { name: name.to_string(), first, end, span });
                    }
                    Intent::Write | Intent::Both => ctx.scope.temp_writes.push((first, end)),
                }
            }
            path::Base::Parameter(index) => {
                ctx.scope.named_parameters.insert(index);
                let parameter = ctx.block.bound.interface.parameters.get(index);
                ctx.scope.value_set |=
                    intent != Intent::Read && parameter.is_some_and(|parameter| parameter.name == "RET_VAL");
            }
            _ => {}
        }
    }

    /// A variable of the block, by its type.
    fn local_thing(&mut self, ctx: &SclBlock, variable: Variable) -> Option<Thing> {
        let number = match variable.base {
            path::Base::Parameter(parameter) => Number::Parameter(parameter),
            base => Number::Word(Box::new(base.at(variable.byte, variable.bit))),
        };
        Some(match &variable.ty {
            DataType::Parameter(ParameterType::Timer) => Thing::Cell { kind: CellKind::Timer, number },
            DataType::Parameter(ParameterType::Counter) => Thing::Cell { kind: CellKind::Counter, number },
            DataType::Parameter(ParameterType::BlockFb) => Thing::Block { prefix: BlockPrefix::Fb, number },
            DataType::Parameter(ParameterType::BlockFc) => Thing::Block { prefix: BlockPrefix::Fc, number },
            DataType::Parameter(ParameterType::BlockDb | ParameterType::BlockSdb) => {
                let span = ctx.block.fixed_span.unwrap_or_default();
                let access = Spot::fixed(variable.clone()).access(span);
                let load = Expr { kind: ExprKind::Load(Box::new(access)), ty: Elementary::Word, span };
                Thing::Db { db: Db::Dynamic(load), number: Some(number) }
            }
            // Reported where it is declared.
            DataType::Void => return None,
            _ => Thing::Spot(Spot::fixed(variable)),
        })
    }

    fn cell(&mut self, kind: CellKind, number: u32, span: Span) -> Option<Thing> {
        let number = Number::Known(self.program.globals.check_cell(kind, number, span)?);
        Some(Thing::Cell { kind, number })
    }

    /// An operand in one token.
    pub(super) fn operand_thing(&mut self, ctx: &mut SclBlock, operand: &OperandKind, span: Span) -> Option<Thing> {
        match operand {
            OperandKind::Absolute { area: area @ (Area::Db | Area::Di), width, byte, bit }
                if let Some(opened) = opened(ctx, *area) =>
            {
                self.db_place(ctx, Db::Dynamic(opened), *width, *byte, *bit, span)
            }
            OperandKind::Absolute { area: Area::L | Area::Db | Area::Di, .. } => {
                self.refuse(
                    Code::OperandKind,
                    span,
                    "SCL has no addresses of local data and of open data blocks",
                    "an address as in STL",
                    "declare a variable in VAR_TEMP, or name the data block: `DB10.DBW4`",
                );
                None
            }
            OperandKind::Absolute { area, width, byte, bit } => {
                self.program.check_address(ctx.block, *area, *width, *byte, span)?;
                let ty = DataType::Elementary(type_of_width(*width));
                let base = path::Base::of_area(*area);
                let mut spot = Spot::fixed(Variable { base, byte: *byte, bit: *bit, ty, untyped: true });
                // Peripheral addresses have no bits; a bit is read out of its byte.
                if matches!(area, Area::Pi | Area::Pq) && *width == Width::Bit {
                    spot.ty = DataType::Elementary(Elementary::Byte);
                    spot.bit = 0;
                    spot.part = Some(Part { width: Width::Bit, index: *bit });
                }
                Some(Thing::Spot(spot))
            }
            OperandKind::Cell { kind, number } => self.cell(*kind, *number, span),
            OperandKind::DbAbsolute { db, width, byte, bit } => {
                let (prefix, number) = self.program.globals.block_number(db)?;
                if prefix != BlockPrefix::Db {
                    self.no_db(span);
                    return None;
                }
                self.db_place(ctx, Db::Known(number), *width, *byte, *bit, span)
            }
            OperandKind::Block(name @ BlockName::Numbered { .. }) => {
                let (prefix, number) = self.program.globals.block_number(name)?;
                Some(block_thing(prefix, Number::Known(number)))
            }
            _ => {
                self.refuse(Code::OperandKind, span, "this operand belongs to STL", "not possible in SCL", "");
                None
            }
        }
    }
}

/// A block by its letters.
fn block_thing(prefix: BlockPrefix, number: Number) -> Thing {
    match (prefix, number) {
        (BlockPrefix::Db | BlockPrefix::Di, Number::Known(known)) => {
            Thing::Db { db: Db::Known(known), number: Some(Number::Known(known)) }
        }
        (prefix, number) => Thing::Block { prefix, number },
    }
}

/// Number of the DB in the register of an area, where the block opens data blocks.
fn opened(ctx: &SclBlock, area: Area) -> Option<Expr> {
    if area == Area::Di { ctx.scope.open_di.clone() } else { ctx.scope.open_db.clone() }
}
