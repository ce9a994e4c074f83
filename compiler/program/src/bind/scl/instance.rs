//! Instances in calls: `"Motor 3"(…)`, `FB10.DB20(…)`, `#s.timer(…)`, `#timer.TON(…)`.
//!
//! Source: SCL reference, call forms.

use plcc_abi::image::BlockKind;
use plcc_binding::{fold, similar};
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{Access, Instance};
use plcc_model::types::{DataType, Member, StructType};
use plcc_model::{BlockKey, layout};
use plcc_syntax::Elementary;
use plcc_syntax::ast::{BlockName, BlockPrefix};
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind, Name, NameForm};

use super::Intent;
use super::callee::{Callee, block_of_name};
use crate::bind::globals::names::{code_kind, kind_prefix};
use crate::bind::scl::{SclBinder, SclBlock};

/// A call that is longer than this is not shown in a help.
const CALL_MAX: usize = 60;

impl SclBinder<'_, '_> {
    /// Reports `#timer(IN := a).Q`, which reads an output where its instance is called; false: something else is called.
    pub(super) fn output_of_call(&mut self, ctx: &mut SclBlock, call: &Node, output: &Name) -> bool {
        let NodeKind::Call { callee, arguments } = &call.kind else { return false };
        let NodeKind::Name(name) = &callee.kind else { return false };
        let local = ctx.block.bound.locals.get(&fold(&name.text)).filter(|_| name.form != NameForm::Quoted);
        let is_instance = match local {
            Some(local) => matches!(&local.ty, DataType::Struct(structure) if structure.instance_of.is_some()),
            None => matches!(self.quiet_block(ctx, callee), Some((BlockPrefix::Db, _))),
        };
        if !is_instance {
            return false;
        }
        let (instance, whole) = (self.program.globals.text(callee.span), self.program.globals.text(call.span));
        let statement = match whole.len() <= CALL_MAX && !whole.contains('\n') {
            true => format!("`{whole};`"),
            false => "the call".to_owned(),
        };
        let title = format!("`{instance}` is called in a statement of its own");
        let help = format!("write {statement} before this statement, and `{instance}.{}` in it", output.text);
        self.refuse(Code::OperandKind, call.span, &title, "its outputs are read after the call", &help);
        self.note_arguments(ctx, arguments);
        true
    }

    /// `FB10.DB20`, `"Db".timer`, `"Db".TON`, `#s.timer`, `#timer.TON`.
    pub(super) fn member_callee(
        &mut self,
        ctx: &mut SclBlock,
        node: &Node,
        base: &Node,
        name: &Name,
    ) -> Option<Callee> {
        let (ty, instance) = match self.quiet_block(ctx, base) {
            Some((prefix @ (BlockPrefix::Fb | BlockPrefix::Sfb), number)) => {
                let key = BlockKey { kind: code_kind(prefix)?, number };
                return self.instance_db(key, name, node.span);
            }
            Some((BlockPrefix::Db, number)) => match self.program.data.db_type(number) {
                Some(ty) => (ty, Instance::Db(number)),
                None => {
                    if !self.program.globals.sources.data.contains_key(&number)
                        && !self.program.data.unknown_instances.contains(&number)
                    {
                        self.program.globals.report.missing_db_layout(number, base.span);
                    }
                    return None;
                }
            },
            Some((BlockPrefix::Fc | BlockPrefix::Sfc, _)) if self.undefined_instance(ctx, base, &name.text) => {
                return None;
            }
            Some((BlockPrefix::Fc | BlockPrefix::Sfc, _)) => {
                let (function, whole) = (self.program.globals.text(base.span), self.program.globals.text(node.span));
                self.program.report(
                    Diagnostic::new(Code::OperandKind, node.span, format!("`{whole}` cannot be called"))
                        .label("a function has no instance data block")
                        .help(format!("write `{function}(…)`")),
                );
                return None;
            }
            Some(_) => return self.no_callee(node.span),
            None if self.undefined_instance(ctx, base, &name.text) => return None,
            None => {
                let access = self.access(ctx, base, Intent::Both)?;
                match &access.ty {
                    DataType::Struct(ty) => (std::rc::Rc::clone(ty), Instance::Variable(access)),
                    DataType::Elementary(ty) if self.is_block_of_library(ctx, &name.text) => {
                        self.no_instance(base.span, *ty, &name.text);
                        return None;
                    }
                    _ => return self.variable_callee(ctx, node),
                }
            }
        };
        let folded = fold(&name.text);
        if ty.members.iter().any(|member| fold(&member.name) == folded) {
            return self.variable_callee(ctx, node);
        }
        match self.instruction_of(ctx, &ty, &instance, &name.text, name.span) {
            Some(key) => Some(Callee::Block { key, instance: Some(instance) }),
            None => self.wrong_instruction(&ty, &instance, name),
        }
    }

    /// Reports `"Wait".TON(…)` where nothing of the program has the name or one that resembles it; false: the base may be defined.
    fn undefined_instance(&mut self, ctx: &SclBlock, base: &Node, asked: &str) -> bool {
        const NAMED_BY_THE_PORTAL: [&str; 2] = ["iec_timer_", "iec_counter_"];
        let NodeKind::Name(instance) = &base.kind else { return false };
        let folded = fold(&instance.text);
        let globals = &self.program.globals;
        let defined = || {
            let mut rows = globals.input.tables.iter().flat_map(|table| &table.unreadable);
            ctx.block.bound.locals.contains_key(&folded)
                || globals.names.symbols.contains_key(&folded)
                || rows.any(|row| fold(&row.name) == folded)
        };
        if instance.form != NameForm::Quoted
            || globals.input.partial
            || NAMED_BY_THE_PORTAL.iter().any(|begin| folded.starts_with(begin))
            || !self.is_block_of_library(ctx, asked)
            || defined()
        {
            return false;
        }
        if self.program.globals.report.may_search() {
            let names = self.program.globals.names.symbols.values().map(|global| global.name.as_str());
            if similar(&instance.text, names).is_some() {
                return false;
            }
        }
        let name = &instance.text;
        let help = format!(
            "add the source of this data block, or define it: `DATA_BLOCK \"{name}\" {asked} BEGIN END_DATA_BLOCK`"
        );
        self.program.globals.report.missing_instance(name, asked, base.span, help);
        true
    }

    /// Whether the library has a function block of this name.
    fn is_block_of_library(&self, ctx: &SclBlock, name: &str) -> bool {
        let key = self.library_function(ctx.scope.rules, name);
        key.is_some_and(|key| matches!(key.kind, BlockKind::Fb | BlockKind::Sfb))
    }

    /// `#time.TON(…)` with a single value in place of the instance.
    fn no_instance(&mut self, span: Span, ty: Elementary, asked: &str) {
        let text = self.program.globals.text(span);
        let data = type_of_data(asked);
        self.program.report(
            Diagnostic::new(Code::NoBlockFits, span, format!("`{text}` is not an instance of `{asked}`"))
                .label(format!("a variable of type {}", ty.name()))
                .help(format!("give it the type `{data}`, which holds the data of `{asked}`")),
        );
    }

    /// The instance in `#timer.TON`, a call that is bound: `TON` is the name of its block and no component.
    pub(in crate::bind) fn instance_before<'n>(&mut self, ctx: &mut SclBlock, node: &'n Node) -> Option<&'n Node> {
        let NodeKind::Member { base, name } = &node.kind else { return None };
        let ty = match self.quiet_block(ctx, base) {
            Some((BlockPrefix::Db, number)) => self.program.data.db_type(number)?,
            Some(_) => return None,
            None => match self.access(ctx, base, Intent::Both)?.ty {
                DataType::Struct(ty) => ty,
                _ => return None,
            },
        };
        let is_component = ty.members.iter().any(|member| fold(&member.name) == fold(&name.text));
        (!is_component).then_some(&**base)
    }

    /// The block that an instruction's name after an instance means: that of the instance, or one for the common data of IEC timers and
    /// counters.
    fn instruction_of(
        &mut self,
        ctx: &SclBlock,
        ty: &StructType,
        instance: &Instance,
        name: &str,
        span: Span,
    ) -> Option<BlockKey> {
        let own = match instance {
            Instance::Db(number) => self.program.data.blocks.get(number)?.block.instance_of,
            Instance::Variable(_) => instance_key(ty),
        };
        if let Some(key) = own
            && let Some(block) = self.program.globals.library_block(key)
            && (block.name.eq_ignore_ascii_case(name)
                || block.name.split('_').next().is_some_and(|first| first.eq_ignore_ascii_case(name)))
        {
            return Some(key);
        }
        // A block of the program with the name of an instruction that plcc does not have.
        if let Some(key) = own
            && self.program.globals.library_block(key).is_none()
            && self.program.globals.names.block_name(kind_prefix(key.kind), key.number).eq_ignore_ascii_case(name)
        {
            return Some(key);
        }
        // Timers share one layout, and counters of one type theirs. IEC_TIMER and IEC_COUNTER, which accept each of them, are declared as
        // TONR and CTUD.
        let block = own.and_then(|key| self.program.globals.library_block(key));
        if block.is_some_and(|block| !["TONR", "CTUD"].contains(&block.name.split('_').next().unwrap_or_default())) {
            return None;
        }
        let typed = block.and_then(|block| block.name.split_once('_'));
        let key = typed
            .and_then(|(_, ty)| self.library_function(ctx.scope.rules, &format!("{name}_{ty}")))
            .or_else(|| self.library_function(ctx.scope.rules, name))?;
        if !matches!(key.kind, BlockKind::Fb | BlockKind::Sfb) {
            return None;
        }
        let bound = self.program.interface(key, span)?;
        let common = ["ET", "CV"].iter().any(|shared| {
            let has = |members: &[Member]| members.iter().any(|member| member.name.eq_ignore_ascii_case(shared));
            has(&ty.members) && has(&bound.interface.instance)
        });
        (common && bound.interface.bytes == ty.bytes).then_some(key)
    }

    fn wrong_instruction(&mut self, ty: &StructType, instance: &Instance, name: &Name) -> Option<Callee> {
        let own = match instance {
            Instance::Db(number) => self.program.data.blocks.get(number).and_then(|db| db.block.instance_of),
            Instance::Variable(_) => instance_key(ty),
        };
        // Timers of IEC 61131-3 have other data under the same names.
        let plain = |name: &str| name.strip_suffix("_IEC").unwrap_or(name).to_string();
        let what = match ty.name.as_str() {
            "" => "the data before the point".to_string(),
            of => format!("`{}`", plain(of)),
        };
        let message = match own {
            Some(key) if self.program.globals.library_block(key).is_none() => {
                let (block, asked) = (self.program.globals.shown(key), &name.text);
                Diagnostic::new(Code::NoBlockFits, name.span, format!("{what} is not an instance of `{asked}`"))
                    .label(format!("the name before the point is an instance of {block}"))
                    .help(format!(
                        "remove `.{asked}` to call {block}, or name an instance of `{asked}` before the point"
                    ))
            }
            Some(key) => {
                let known = self.program.globals.library_block(key).map_or(key.to_string(), |block| plain(block.name));
                // `CTU` of CTU_INT
                let short = known.rsplit_once('_').filter(|(_, ty)| Elementary::from_word(ty).is_some());
                let instruction = short.map_or(known.as_str(), |(first, _)| first);
                let asked = &name.text;
                Diagnostic::new(Code::NoBlockFits, name.span, format!("{what} is not an instance of `{asked}`"))
                    .label(format!("the name before the point is an instance of {known}"))
                    .help(format!("write `{instruction}` here, or name an instance of `{asked}` before the point"))
            }
            None => {
                let message = Diagnostic::new(
                    Code::UnknownMember,
                    name.span,
                    format!("{what} has no component `{}` that could be called", name.text),
                )
                .label("no such component");
                match similar(&name.text, ty.members.iter().map(|member| member.name.as_str())) {
                    Some(other) => message.help(format!("is `{other}` meant?")),
                    None => message,
                }
            }
        };
        self.program.report(message);
        None
    }

    /// The instance data block after a function block: `FB10.DB20`, `"Motor"."Motor 3"`. `call`: both names.
    fn instance_db(&mut self, key: BlockKey, name: &Name, call: Span) -> Option<Callee> {
        let block =
            block_of_name(name).unwrap_or_else(|| BlockName::Symbol { name: name.text.clone(), span: name.span });
        let (prefix, number) = self.program.globals.block_number(&block)?;
        if prefix != BlockPrefix::Db || number == 0 {
            self.program.report(
                Diagnostic::new(Code::OperandKind, name.span, format!("`{}` is not a data block", name.text))
                    .label("the instance data block is expected here"),
            );
            return None;
        }
        if self.program.interface(key, call).is_some() {
            self.program.check_instance_db(key, number, name.span)?;
        }
        Some(Callee::Block { key, instance: Some(Instance::Db(number)) })
    }

    /// A variable that is an instance.
    pub(super) fn variable_callee(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Callee> {
        let access = self.access(ctx, node, Intent::Both)?;
        match instance_of(&access) {
            Some(key) => Some(Callee::Block { key, instance: Some(Instance::Variable(access)) }),
            None => {
                let text = self.program.globals.text(node.span);
                let name = layout::type_name(&access.ty);
                self.program.report(
                    Diagnostic::new(Code::OperandKind, node.span, format!("`{text}` cannot be called"))
                        .label(format!("a variable of type {name}"))
                        .help(match (&access.ty, self.in_parentheses(node.span)) {
                            (DataType::Array(array), inner)
                                if matches!(&array.element, DataType::Struct(ty) if instance_key(ty).is_some()) =>
                            {
                                let first: Vec<String> = array.bounds.iter().map(|(low, _)| low.to_string()).collect();
                                let inner = inner.unwrap_or_default();
                                format!("call one of its instances, as `{text}[{}]({inner})`", first.join(", "))
                            }
                            (DataType::Array(_), Some(index)) => format!("an element is `{text}[{index}]`"),
                            _ => "a call needs a function, a data block of a function block, or a variable whose type is a function block".to_owned(),
                        }),
                );
                None
            }
        }
    }

    /// The text in the parentheses after `span`, on its line.
    fn in_parentheses(&self, span: Span) -> Option<String> {
        let (_, file) = self.program.globals.input.sources.files().nth(span.file.0 as usize)?;
        let rest = file.text.get(span.end as usize..)?.trim_start().strip_prefix('(')?;
        let inner = rest.lines().next()?.split(')').next()?.trim();
        Some(inner.to_owned()).filter(|inner| !inner.is_empty())
    }

    /// The data block with the lowest number that is an instance of the function block, as a program writes it.
    pub(super) fn first_instance(&self, key: BlockKey) -> Option<String> {
        let instances = self.program.data.blocks.iter().filter(|(_, db)| db.block.instance_of == Some(key));
        let number = instances.map(|(number, _)| *number).min()?;
        Some(match self.program.globals.names.block_name(BlockPrefix::Db, number) {
            name if name.is_empty() => format!("DB{number}"),
            name => format!("\"{name}\""),
        })
    }

    /// How to call a function block that the program calls as `text`, without an instance.
    pub(super) fn instance_help(&self, ctx: &SclBlock, key: BlockKey, text: &str) -> String {
        let names = &self.program.globals.names;
        let mut instances: Vec<u16> = self
            .program
            .data
            .blocks
            .iter()
            .filter(|(_, db)| db.block.instance_of == Some(key))
            .map(|(number, _)| *number)
            .collect();
        instances.sort_unstable();
        let word = text.trim_matches('"');
        let named = !word.eq_ignore_ascii_case(&key.to_string().replace(' ', ""));
        match instances.first() {
            Some(number) if named => match names.block_name(BlockPrefix::Db, *number) {
                name if name.is_empty() => format!("call its instance: `{text}.DB{number}(…)`"),
                name => format!("call its instance: `\"{name}\"(…)`"),
            },
            Some(number) => format!("call its instance: `{text}.DB{number}(…)`"),
            None => {
                let data = format!("define `DATA_BLOCK \"{word}_DB\" {text}` and call `\"{word}_DB\"(…)`");
                match ctx.block.key.kind {
                    BlockKind::Fb => {
                        format!(
                            "declare the static variable `inst{word} : {text};` and call `#inst{word}(…)`, or {data}"
                        )
                    }
                    _ => data,
                }
            }
        }
    }
}

/// The data type of the instances of a block of the library, as the TIA Portal declares them.
pub(in crate::bind) fn type_of_data(block: &str) -> String {
    let upper = block.to_ascii_uppercase();
    match upper.as_str() {
        "TP" | "TON" | "TOF" | "TONR" => format!("{upper}_TIME"),
        "CTU" | "CTD" | "CTUD" => format!("{upper}_INT"),
        _ => block.to_string(),
    }
}

fn instance_key(ty: &StructType) -> Option<BlockKey> {
    let (sfb, number) = ty.instance_of?;
    Some(BlockKey { kind: if sfb { BlockKind::Sfb } else { BlockKind::Fb }, number })
}

/// The function block whose instance a variable is.
fn instance_of(access: &Access) -> Option<BlockKey> {
    match (&access.ty, access.part) {
        (DataType::Struct(ty), None) => instance_key(ty),
        _ => None,
    }
}
