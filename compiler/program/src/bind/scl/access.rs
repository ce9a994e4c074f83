//! Names, components, indices and slices. Source: SCL reference, case and names; addressing.

use std::rc::Rc;

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast::{Area, BlockName, BlockPrefix, CellKind, OperandKind, Width};
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind, Name, NameForm};
use plcc_syntax::scl::{absolute, area_word, db_address, db_area_word};

use super::Intent;
use super::flow::own_value;
use super::place::{Db, Root, Spot, Thing};
use super::scope::TempUse;
use super::value::Value;
use crate::bind::declarations::path::{self, Resolved, Variable, type_of_width};
use crate::bind::globals::names::code_kind;
use crate::bind::scl::message::DEPTH_MAX;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_binding::fold;
use plcc_model::layout;
use plcc_model::scl::{Access, Complex, Expr, ExprKind, IndexedArea, Part};
use plcc_model::types::{DTL, DataType, ParameterType};
use plcc_model::{BlockKey, Number};
use plcc_syntax::symbols::SymbolTarget;

impl SclBinder<'_, '_> {
    /// Whether the name is that of an array of the block.
    fn names_array(ctx: &SclBlock, node: &Node) -> bool {
        let NodeKind::Name(name) = &node.kind else { return false };
        let local = ctx.block.bound.locals.get(&fold(&name.text));
        local.is_some_and(|local| matches!(local.ty, DataType::Array(_)))
    }

    /// Binds a variable.
    pub(in crate::bind) fn access(&mut self, ctx: &mut SclBlock, node: &Node, intent: Intent) -> Option<Access> {
        let spot = self.spot(ctx, node, intent)?;
        Some(spot.access(node.span))
    }

    /// Binds a variable, as its parts.
    pub(super) fn spot(&mut self, ctx: &mut SclBlock, node: &Node, intent: Intent) -> Option<Spot> {
        match self.thing(ctx, node, intent)? {
            Thing::Spot(spot) => {
                self.check_intent(ctx, &spot, intent, node.span)?;
                Some(spot)
            }
            Thing::Db { db: Db::Known(number), .. } => Some(Spot::fixed(self.whole_db(number, node.span)?)),
            Thing::Constant(_) => {
                let text = self.program.globals.text(node.span);
                self.refuse(
                    Code::Protected,
                    node.span,
                    &format!("`{text}` cannot be written"),
                    "a constant",
                    "name a variable",
                );
                None
            }
            thing @ (Thing::Cell { .. } | Thing::Block { .. } | Thing::Db { .. } | Thing::Flag | Thing::LastEno) => {
                let text = self.program.globals.text(node.span);
                // The value of another function is assigned: that of this one is meant.
                let function = matches!(thing, Thing::Block { prefix: BlockPrefix::Fc, .. });
                let own = if function && intent == Intent::Write { self.own_value(ctx) } else { None };
                ctx.scope.value_set |= own.is_some();
                let help = match own {
                    Some(own) => format!("the value of this function is `{own}`: write `{own} := …`"),
                    None => "name a variable or an address such as `MW10`".to_string(),
                };
                let title = format!("`{text}` is not a variable");
                self.refuse(Code::OperandKind, node.span, &title, "a variable is expected here", &help);
                None
            }
            Thing::Area(..) => {
                self.no_address(node.span);
                None
            }
            Thing::DbArea(db, _) => {
                self.no_address_in(&db, node.span);
                None
            }
        }
    }

    /// The meaning of an expression of names.
    pub(in crate::bind) fn thing(&mut self, ctx: &mut SclBlock, node: &Node, intent: Intent) -> Option<Thing> {
        if ctx.scope.depth >= DEPTH_MAX {
            self.too_deep(node.span);
            return None;
        }
        ctx.scope.depth += 1;
        let thing = self.thing_inner(ctx, node, intent);
        ctx.scope.depth -= 1;
        thing
    }

    fn thing_inner(&mut self, ctx: &mut SclBlock, node: &Node, intent: Intent) -> Option<Thing> {
        let span = node.span;
        match &node.kind {
            NodeKind::Name(name) => self.name_thing(ctx, name, intent),
            NodeKind::Absolute(operand) => {
                if let (OperandKind::Absolute { .. } | OperandKind::DbAbsolute { .. }, Some(untyped)) =
                    (operand, &mut ctx.scope.untyped)
                {
                    untyped.insert(span);
                }
                self.operand_thing(ctx, operand, span)
            }
            NodeKind::Member { base, name } => {
                let base = self.thing(ctx, base, intent)?;
                match without_peripheral(&base, name) {
                    Some(own) => {
                        let thing = self.member_thing(ctx, base, &own, span)?;
                        self.past_image(thing, span).map(Thing::Spot)
                    }
                    None => self.member_thing(ctx, base, name, span),
                }
            }
            NodeKind::MemberAbsolute { base, width, byte, bit } => {
                let base_span = base.span;
                let db = match self.thing(ctx, base, Intent::Read)? {
                    Thing::Db { db, .. } => db,
                    // `#db.%DBW4`: a DB_ANY, whose value is the number of the data block.
                    Thing::Spot(spot) if spot.ty == DataType::Elementary(Elementary::Uint) && spot.part.is_none() => {
                        let load = ExprKind::Load(Box::new(spot.access(base_span)));
                        Db::Dynamic(Expr { kind: load, ty: Elementary::Word, span: base_span })
                    }
                    _ => {
                        self.no_db(span);
                        return None;
                    }
                };
                if let Some(untyped) = &mut ctx.scope.untyped {
                    untyped.insert(span);
                }
                self.db_place(ctx, db, *width, *byte, *bit, span)
            }
            NodeKind::Slice { base, width, index } => {
                let base = self.thing(ctx, base, intent)?;
                self.slice(base, *width, *index, span)
            }
            NodeKind::Index { base, indices } => {
                let base_span = base.span;
                match self.thing(ctx, base, intent)? {
                    Thing::Spot(spot) => self.element(ctx, spot, indices, span).map(Thing::Spot),
                    Thing::Area(area, width) => self.indexed(ctx, IndexedArea::Memory(area), width, indices, span),
                    Thing::DbArea(db, width) => {
                        let area = self.indexed_db(db, base_span);
                        self.indexed(ctx, area, width, indices, span)
                    }
                    _ => {
                        self.refuse(
                            Code::UnknownMember,
                            span,
                            "this is not an array",
                            "there is an index after it",
                            "",
                        );
                        None
                    }
                }
            }
            NodeKind::Call { callee, arguments } => match self.indexed_call(ctx, callee, arguments, span) {
                Some(thing) => thing,
                None => {
                    let text = self.program.globals.text(span);
                    let (title, label, help) = match (text.split_once('('), &callee.kind) {
                        (Some((name, index)), NodeKind::Name(_)) if Self::names_array(ctx, callee) => (
                            "the index of an array is written in brackets",
                            "a form of other languages",
                            format!("write `{name}[{}]`", index.trim_end_matches(')')),
                        ),
                        _ => (
                            "the result of a call is not a variable",
                            "a call",
                            "assign the result to a variable first".to_string(),
                        ),
                    };
                    self.refuse(Code::OperandKind, span, title, label, &help);
                    None
                }
            },
            NodeKind::Dereference(base) => self.dereferenced(ctx, base, span).map(Thing::Spot),
            NodeKind::Reference(_) => {
                self.misplaced_reference(span, "REF(…) is a value, and no variable");
                None
            }
            NodeKind::Literal(_) | NodeKind::Unary { .. } | NodeKind::Binary { .. } => {
                let text = self.program.globals.text(span);
                self.refuse(
                    Code::OperandKind,
                    span,
                    &format!("`{text}` is not a variable"),
                    "a variable is expected here",
                    "name a variable or an address such as `MW10`",
                );
                None
            }
            NodeKind::Error => None,
        }
    }

    fn name_thing(&mut self, ctx: &mut SclBlock, name: &Name, intent: Intent) -> Option<Thing> {
        let text = name.text.as_str();
        if let Some(variable) = ctx.scope.hidden.get(text) {
            return Some(Thing::Spot(Spot::fixed(variable.clone())));
        }
        let global = self.program.globals.names.symbols.contains_key(&fold(text));
        let elsewhere = global && name.form == NameForm::Quoted || self.is_unknown_global(ctx, name);
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

    /// `"tag":P`: the input or output itself, past the process image.
    fn peripheral_tag(&mut self, ctx: &mut SclBlock, tag: &str, span: Span) -> Option<Thing> {
        let Some(global) = self.program.globals.names.symbols.get(&fold(tag)) else {
            let locals = ctx.block.bound.locals.values().map(|local| local.name.as_str());
            self.program.globals.unknown_name(tag, span, locals);
            return None;
        };
        let (target, ty) = (global.target, global.ty);
        let place = match target {
            SymbolTarget::Memory { area: Area::I | Area::Pi, width, byte, bit } => Some((Area::Pi, width, byte, bit)),
            SymbolTarget::Memory { area: Area::Q | Area::Pq, width, byte, bit } => Some((Area::Pq, width, byte, bit)),
            _ => None,
        };
        let Some((area, width, byte, bit)) = place else {
            self.only_in_image(tag, span);
            return None;
        };
        let mut thing = self.operand_thing(ctx, &OperandKind::Absolute { area, width, byte, bit }, span)?;
        if let (Thing::Spot(spot), Some(ty)) = (&mut thing, ty)
            && spot.part.is_none()
            && layout::width(ty) == width
        {
            spot.ty = DataType::Elementary(ty);
        }
        Some(thing)
    }

    fn only_in_image(&mut self, text: &str, span: Span) {
        let title = "only inputs and outputs can be accessed without the process image";
        let label = format!("`{text}` is neither");
        self.refuse(Code::OperandKind, span, title, &label, "write it without `:P`");
    }

    /// `"tag".component:P`: the component of an input or output itself, past the process image.
    fn past_image(&mut self, thing: Thing, span: Span) -> Option<Spot> {
        let text = self.program.globals.text(span);
        let text = text.strip_suffix(":P").or_else(|| text.strip_suffix(":p")).unwrap_or(&text).to_owned();
        let Thing::Spot(mut spot) = thing else {
            self.only_in_image(&text, span);
            return None;
        };
        let base = match spot.root {
            Root::Fixed(path::Base::I | path::Base::Pi) => path::Base::Pi,
            Root::Fixed(path::Base::Q | path::Base::Pq) => path::Base::Pq,
            Root::Fixed(_) | Root::Indexed { .. } => {
                self.only_in_image(&text, span);
                return None;
            }
        };
        if !spot.indices.is_empty() {
            let label = "the program computes which element it is";
            let help = "write it without `:P`, or a number between the brackets";
            self.refuse(Code::OperandKind, span, "this element cannot be accessed past the process image", label, help);
            return None;
        }
        match spot.ty {
            // Peripheral addresses have no bits; a bit is read out of its byte.
            DataType::Elementary(Elementary::Bool) => {
                spot.ty = DataType::Elementary(Elementary::Byte);
                spot.part = Some(Part { width: Width::Bit, index: spot.bit });
                spot.bit = 0;
            }
            DataType::Elementary(_) => {}
            _ => {
                let help = format!("name a single value in it: `{text}.component:P`");
                self.refuse(Code::OperandKind, span, "`:P` is only possible with a single value", "a structure", &help);
                return None;
            }
        }
        spot.root = Root::Fixed(base);
        Some(spot)
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
    fn own_value(&self, ctx: &SclBlock) -> Option<String> {
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
            path::Base::Parameter(index) if intent != Intent::Read => {
                let parameter = ctx.block.bound.interface.parameters.get(index);
                ctx.scope.value_set |= parameter.is_some_and(|parameter| parameter.name == "RET_VAL");
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
    fn operand_thing(&mut self, ctx: &mut SclBlock, operand: &OperandKind, span: Span) -> Option<Thing> {
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

    fn member_thing(&mut self, ctx: &mut SclBlock, base: Thing, name: &Name, span: Span) -> Option<Thing> {
        match base {
            Thing::Spot(spot) => self.component(spot, name).map(Thing::Spot),
            Thing::Db { db, .. } => {
                if let Db::Known(number) = db
                    && let Some(ty) = self.program.data.db_type(number)
                    && let Some(member) = self.program.types.member(&ty, &name.text)
                {
                    let base = path::Base::Db(number);
                    let (byte, bit, ty) = (member.byte, member.bit, member.ty);
                    if ty == DataType::Void {
                        return None;
                    }
                    return Some(Thing::Spot(Spot::fixed(Variable { base, byte, bit, ty, untyped: false })));
                }
                let word = name.text.strip_prefix('%').unwrap_or(&name.text);
                if name.form == NameForm::Bare {
                    if let Some((width, byte)) = db_address(word) {
                        return self.db_place(ctx, db, width, byte, 0, span);
                    }
                    if let Some(width) = db_area_word(word) {
                        return Some(Thing::DbArea(db, width));
                    }
                }
                match db {
                    Db::Known(number) => {
                        let variable = self.whole_db(number, span)?;
                        self.component(Spot::fixed(variable), name).map(Thing::Spot)
                    }
                    Db::Dynamic(_) => {
                        let help = "name an address in it: `.DW[i]`, `.DW4`, `.DX[b, i]`";
                        let label = "this data block is only known at run time";
                        self.refuse(Code::UnknownMember, span, "the components of this block are unknown", label, help);
                        None
                    }
                }
            }
            Thing::Block { prefix: BlockPrefix::Udt, .. } => {
                let base = Span::new(span.file, span.start as usize..name.span.start as usize);
                let text = self.program.globals.text(base);
                self.program.globals.report.missing_beside_type(text.trim_end().trim_end_matches('.'), span);
                None
            }
            Thing::Block { prefix: prefix @ (BlockPrefix::Fb | BlockPrefix::Sfb), number: Number::Known(number) } => {
                let base = Span::new(span.file, span.start as usize..name.span.start as usize);
                let text = self.program.globals.text(base);
                let text = text.trim_end().trim_end_matches('.').trim_end();
                let base = Span::new(span.file, span.start as usize..span.start as usize + text.len());
                let key = BlockKey { kind: code_kind(prefix)?, number };
                let help = match self.first_instance(key) {
                    Some(instance) => format!("write `{instance}.{}`", name.text),
                    None => format!("name an instance of it before `.{}`", name.text),
                };
                let title = format!("`{text}` is a function block, and has no data");
                self.refuse(Code::UnknownMember, base, &title, "its data are in its instances", &help);
                None
            }
            Thing::Constant(Constant::Dtl(bytes)) => self.dtl_component(bytes, name),
            Thing::Constant(_)
            | Thing::Cell { .. }
            | Thing::Block { .. }
            | Thing::Flag
            | Thing::LastEno
            | Thing::Area(..)
            | Thing::DbArea(..) => {
                self.program.report(
                    Diagnostic::new(Code::UnknownMember, name.span, "only data blocks and structures have components")
                        .label("this comes before the point and is something else"),
                );
                None
            }
        }
    }

    /// `#start.YEAR` of a constant, which is not in memory.
    fn dtl_component(&mut self, bytes: [u8; 12], name: &Name) -> Option<Thing> {
        let DataType::Struct(structure) = self.program.predefined(DTL, name.span)?.ty else { return None };
        let Some(member) = self.program.types.member(&structure, &name.text) else {
            self.program.unknown_member(&structure, &name.text, name.span);
            return None;
        };
        let DataType::Elementary(ty) = member.ty else { return None };
        let own = bytes.iter().skip(member.byte as usize).take(ty.bits() as usize / 8);
        let bits = own.fold(0, |bits, byte| (bits << 8) | u64::from(*byte));
        Some(Thing::Constant(Constant::Typed { ty, bits }))
    }

    /// A data block as one structure.
    pub(super) fn whole_db(&mut self, number: u16, span: Span) -> Option<Variable> {
        let Some(ty) = self.program.data.db_type(number) else {
            if !self.program.globals.sources.data.contains_key(&number)
                && !self.program.data.unknown_instances.contains(&number)
            {
                self.program.globals.report.missing_db_layout(number, span);
            }
            return None;
        };
        Some(Variable { base: path::Base::Db(number), byte: 0, bit: 0, ty: DataType::Struct(ty), untyped: false })
    }

    fn component(&mut self, mut spot: Spot, name: &Name) -> Option<Spot> {
        let DataType::Struct(structure) = &spot.ty else {
            self.program.report(path::no_component(&name.text, &spot.ty, name.span));
            return None;
        };
        let structure = Rc::clone(structure);
        let Some(member) = self.program.types.member(&structure, &name.text) else {
            self.program.unknown_member(&structure, &name.text, name.span);
            return None;
        };
        spot.byte += member.byte;
        spot.bit = member.bit;
        spot.ty = member.ty;
        (spot.ty != DataType::Void).then_some(spot)
    }

    fn slice(&mut self, base: Thing, width: Width, index: u32, span: Span) -> Option<Thing> {
        let Thing::Spot(mut spot) = base else {
            let help = "only variables have slices: `word.%X3`";
            self.refuse(Code::OperandKind, span, "this has no slices", "there is no variable before the point", help);
            return None;
        };
        let whole = match (&spot.part, &spot.ty) {
            (Some(part), _) => Some(part.width.bits()),
            (None, DataType::Elementary(ty)) if super::numeric::bit_string(super::Rules::Tia1500, *ty).is_some() => {
                Some(ty.bits()).filter(|bits| *bits > 1)
            }
            _ => None,
        };
        let Some(whole) = whole else {
            let is = layout::type_name(&spot.ty);
            let help = "slices are parts of bit strings and integers";
            self.refuse(Code::OperandKind, span, &format!("a variable of type {is} has no slices"), &is, help);
            return None;
        };
        let count = whole / width.bits();
        if index >= count {
            let label = match count {
                0 => format!("the variable has {whole} bits"),
                1 => "only 0 is possible".to_owned(),
                _ => format!("0 to {} are possible", count - 1),
            };
            let help = self.possible_slices(span, width, count);
            self.refuse(Code::ArrayIndex, span, "this slice is outside the variable", &label, &help);
            return None;
        }
        let before = spot.part.map_or(0, |part| u32::from(part.index) * part.width.bits());
        let index = before / width.bits() + index;
        spot.part = Some(Part { width, index: index as u8 });
        Some(Thing::Spot(spot))
    }

    /// Which slices of a width the variable of the slice at `span` has.
    fn possible_slices(&self, span: Span, width: Width, count: u32) -> String {
        let letter = match width {
            Width::Bit => 'X',
            Width::Byte => 'B',
            Width::Word => 'W',
            Width::Dword | Width::Lword => 'D',
        };
        let text = self.program.globals.text(span);
        let (variable, part) = text.rsplit_once('.').unwrap_or((&text, ""));
        match count {
            0 => format!("remove `.{part}`"),
            1 => format!("write `{variable}.%{letter}0`"),
            _ => format!("write one from `{variable}.%{letter}0` to `{variable}.%{letter}{}`", count - 1),
        }
    }

    /// The value of an expression of names.
    pub(super) fn thing_value(&mut self, ctx: &mut SclBlock, thing: Thing, span: Span) -> Option<Value> {
        Some(match thing {
            Thing::Spot(spot) => {
                self.check_intent(ctx, &spot, Intent::Read, span)?;
                let access = spot.access(span);
                match (access.elementary(), access.ty.clone()) {
                    (Some(ty), _) => Value::Elementary(Expr { kind: ExprKind::Load(Box::new(access)), ty, span }),
                    (None, DataType::Parameter(_) | DataType::OpenArray(_)) => Value::Parameter { access, span },
                    (None, DataType::Void) => return None,
                    (None, ty) => Value::Complex { value: Complex::Variable(access), ty, span },
                }
            }
            Thing::Constant(constant) => Value::Constant(constant, span),
            Thing::Cell { kind, number } => Value::Cell { kind, number, span },
            Thing::Block { prefix, number } => Value::Block { prefix, number, span },
            Thing::Db { number: Some(number), .. } => Value::Block { prefix: BlockPrefix::Db, number, span },
            // This code reads it, so it must be set somewhere.
            Thing::Flag => {
                ctx.scope.sets_flag = true;
                Value::Elementary(Expr { kind: ExprKind::Flag, ty: Elementary::Bool, span })
            }
            Thing::LastEno => Value::Elementary(Expr { kind: ExprKind::LastEno, ty: Elementary::Bool, span }),
            Thing::DbArea(db, _) => {
                self.no_address_in(&db, span);
                return None;
            }
            Thing::Area(..) | Thing::Db { number: None, .. } => {
                self.no_address(span);
                return None;
            }
        })
    }

    /// `"Data".d`: the letter of an area of the data block without its index; rather a component that the block does not have.
    fn no_address_in(&mut self, db: &Db, span: Span) {
        let text = self.program.globals.text(span);
        let component = text.rsplit_once('.').map(|(_, component)| component).filter(|component| component.len() == 1);
        if let (Db::Known(number), Some(component)) = (db, component)
            && let Some(ty) = self.program.data.db_type(*number)
        {
            let end = span.end as usize;
            let at = Span::new(span.file, end.saturating_sub(component.len()).max(span.start as usize)..end);
            self.program.unknown_member(&ty, component, at);
            return;
        }
        self.no_address(span);
    }

    fn no_address(&mut self, span: Span) {
        let text = self.program.globals.text(span);
        if text.len() == 1 {
            // A counting variable that nothing declares, rather than an area.
            self.program.globals.report.missing_letter(&text, span);
            return;
        }
        self.refuse(
            Code::OperandKind,
            span,
            &format!("`{text}` alone is not an address"),
            "the number is missing",
            "write for example `MW10`, `MW[i]` or `DB10.DW[i]`",
        );
    }

    /// Whether a variable can be read or written as the access requires.
    pub(in crate::bind) fn check_intent(
        &mut self,
        ctx: &SclBlock,
        spot: &Spot,
        intent: Intent,
        span: Span,
    ) -> Option<()> {
        let text = self.program.globals.text(span);
        let area = match &spot.root {
            Root::Fixed(path::Base::Pi) | Root::Indexed { area: IndexedArea::Memory(Area::Pi), .. } => Some(Area::Pi),
            Root::Fixed(path::Base::Pq) | Root::Indexed { area: IndexedArea::Memory(Area::Pq), .. } => Some(Area::Pq),
            _ => None,
        };
        // A bit is written alone; other parts need what is there.
        let is_bit = spot.part.is_some_and(|part| part.width == Width::Bit)
            && spot.ty == DataType::Elementary(Elementary::Byte)
            && matches!(spot.root, Root::Fixed(_));
        let reads = intent != Intent::Write || (spot.part.is_some() && !is_bit);
        if area == Some(Area::Pq) && reads {
            let title = format!("`{text}` cannot be read");
            self.refuse(
                Code::OperandKind,
                span,
                &title,
                "this is a peripheral output",
                "use the process image, e.g. `QW4`",
            );
            return None;
        }
        if intent == Intent::Read {
            return Some(());
        }
        if ctx.block.bound.constant_db.is_some_and(|number| spot.lies_in_db(number)) {
            let title = format!("`{text}` cannot be written");
            self.refuse(Code::Protected, span, &title, "a constant", "name a variable");
            return None;
        }
        if area == Some(Area::Pi) {
            let title = format!("`{text}` cannot be written");
            self.refuse(
                Code::Protected,
                span,
                &title,
                "this is a peripheral input",
                "peripheral outputs are written: `PQW`",
            );
            return None;
        }
        if let DataType::Struct(structure) = &spot.ty
            && structure.instance_of.is_some()
            && intent == Intent::Write
        {
            let title = format!("`{text}` cannot be assigned");
            self.refuse(Code::Protected, span, &title, "this is an instance", "assign its inputs one by one");
            return None;
        }
        if let Some((_, head)) = ctx.scope.loop_variables.iter().rev().find(|(variable, _)| variable.is_same(spot)) {
            let error = !ctx.scope.rules.is_300();
            let mut message =
                Diagnostic::new(Code::LoopVariable, span, format!("`{text}` counts this loop and is changed in it"))
                    .label("changed here")
                    .also(*head, "the loop")
                    .help("use another variable, or a WHILE loop");
            if !error {
                message.severity = plcc_diag::Severity::Warning;
            }
            self.program.report(message);
            if error {
                return None;
            }
        }
        Some(())
    }
}

/// The name of a component without `:P`; none: it has none, or is called so.
fn without_peripheral(base: &Thing, name: &Name) -> Option<Name> {
    let text = name.text.strip_suffix(":P").or_else(|| name.text.strip_suffix(":p"))?;
    if let Thing::Spot(Spot { ty: DataType::Struct(structure), .. }) = base
        && structure.members.iter().any(|member| member.name.eq_ignore_ascii_case(&name.text))
    {
        return None;
    }
    Some(Name { text: text.to_owned(), ..name.clone() })
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
