//! Calls: what is called, and its value. A block with its instance, or a function of the language.
//!
//! Source: SCL reference, call forms. Blocks of the program take precedence over functions of the same name.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{BlockName, BlockPrefix, OperandKind};
use plcc_syntax::scl;
use plcc_syntax::scl::ast::{Argument as Given, Expr as Node, ExprKind as NodeKind, Literal, Name, NameForm};

use super::expression::constant_expr;
use super::function::Named;
use super::place::{Db, Thing};
use super::value::Value;
use super::{Intent, Rules};
use crate::bind::globals::names::{Global, code_kind};
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::fold;
use plcc_binding::report::known_type;
use plcc_binding::similar;
use plcc_model::layout;
use plcc_model::scl::{Access, Argument, Base, Call, Complex, Expr, ExprKind, Instance};
use plcc_model::types::{DataType, Member, StructType};
use plcc_model::{BlockKey, Direction, Parameter, Place};
use plcc_syntax::symbols::SymbolTarget;

/// The target of a call.
pub enum Callee {
    Block { key: BlockKey, instance: Option<Instance> },
    Function(Named),
}

impl SclBinder<'_, '_> {
    /// Binds a call: of a block, an instance, a function of the language. `statement`: its value may be unused.
    pub fn call(&mut self, ctx: &mut SclBlock, node: &Node, statement: bool) -> Option<Value> {
        let NodeKind::Call { callee, arguments } = &node.kind else { return None };
        if let Some(number) = self.number_of_block(ctx, callee, arguments, node.span) {
            return number;
        }
        let wide = self.overload(ctx, callee, arguments).map(|key| Callee::Block { key, instance: None });
        if self.cast(ctx, callee, arguments)
            || self.foreign_function(ctx, callee)
            || self.instance_as_argument(ctx, callee, arguments)
        {
            return None;
        }
        let Some(target) = wide.or_else(|| self.callee(ctx, callee)) else {
            self.note_arguments(ctx, arguments);
            return None;
        };
        let repaired = self.named_with_equals(ctx, &target, arguments, callee);
        let arguments = repaired.as_deref().unwrap_or(arguments);
        match target {
            Callee::Block { key, instance } => {
                let call = self.block_call(ctx, key, instance, arguments, callee.span, node.span)?;
                self.call_value(call, statement, callee.span)
            }
            Callee::Function(named) => self.function(ctx, &named, arguments, callee.span, node.span, statement),
        }
    }

    /// `BLOCK_DB_TO_WORD(x)`: the number of a data block. `None`: another call.
    ///
    /// Source: SCL reference, conversions of numbers of data blocks.
    fn number_of_block(
        &mut self,
        ctx: &mut SclBlock,
        callee: &Node,
        given: &[Given],
        span: Span,
    ) -> Option<Option<Value>> {
        let NodeKind::Name(name) = &callee.kind else { return None };
        if !name.text.eq_ignore_ascii_case("BLOCK_DB_TO_WORD")
            || self.program.globals.names.symbols.contains_key(&fold(&name.text))
        {
            return None;
        }
        let [Given { value: Some(node), .. }] = given else { return None };
        let number = match self.thing(ctx, node, Intent::Read) {
            Some(Thing::Db { db: Db::Known(number), .. }) => {
                self.program.use_db(number, node.span);
                constant_expr(number.into(), plcc_syntax::Elementary::Word, span)
            }
            Some(Thing::Db { db: Db::Dynamic(word), .. }) => Expr { span, ..word },
            Some(_) => {
                let text = self.program.globals.text(node.span);
                let title = format!("`{text}` is not a data block");
                let help = "name a data block, or a parameter of type BLOCK_DB";
                self.refuse(Code::OperandKind, node.span, &title, "a data block is expected here", help);
                return Some(None);
            }
            None => return Some(None),
        };
        Some(Some(Value::Elementary(number)))
    }

    /// `INT(x)`, which other languages convert with, is reported.
    fn cast(&mut self, ctx: &mut SclBlock, callee: &Node, given: &[Given]) -> bool {
        let NodeKind::Name(name) = &callee.kind else { return false };
        let Some(to) = plcc_syntax::Elementary::from_word(&name.text.to_ascii_uppercase()) else { return false };
        let known = self.program.globals.names.symbols.contains_key(&fold(&name.text));
        let [Given { name: None, value: Some(node), .. }] = given else { return false };
        if name.form != NameForm::Bare || known || self.is_local(ctx, name) {
            return false;
        }
        let text = self.program.globals.text(node.span);
        let from = match self.value(ctx, node) {
            Some(Value::Elementary(expr)) => expr.ty.name().to_owned() + "_",
            Some(_) => String::new(),
            None => return true,
        };
        let title = format!("`{}` is a data type, not a function", name.text);
        let help = format!("write `{from}TO_{}({text})`", to.name());
        self.refuse(Code::ForeignForm, name.span, &title, "a form of other languages", &help);
        true
    }

    /// `TON(#t, IN := …)`, which hands an instance to its own function block, is reported.
    fn instance_as_argument(&mut self, ctx: &mut SclBlock, callee: &Node, given: &[Given]) -> bool {
        let [Given { name: None, value: Some(node), .. }, rest @ ..] = given else { return false };
        let (NodeKind::Name(block), NodeKind::Name(instance)) = (&callee.kind, &node.kind) else { return false };
        let local = ctx.block.bound.locals.get(&fold(&instance.text));
        let Some(DataType::Struct(structure)) = local.map(|local| &local.ty) else { return false };
        let Some((system, number)) = structure.instance_of else { return false };
        let kind = if system { BlockKind::Sfb } else { BlockKind::Fb };
        let target = self.program.globals.names.symbols.get(&fold(&block.text)).map(|global| global.target);
        let is_own = match target {
            Some(SymbolTarget::Block { prefix: BlockPrefix::Fb, number: own }) => !system && own == u32::from(number),
            Some(_) => false,
            None => self.library_function(ctx.scope.rules, &block.text) == Some(BlockKey { kind, number }),
        };
        if !is_own {
            return false;
        }
        let (called, instance) = (self.program.globals.text(callee.span), self.program.globals.text(node.span));
        let arguments = match rest {
            [first, .., last] => self.program.globals.text(first.span.to(last.span)),
            [only] => self.program.globals.text(only.span),
            [] => String::new(),
        };
        self.refuse(
            Code::MissingOperand,
            callee.span,
            &format!("`{called}` is called by the name of its instance"),
            "the instance is not an argument",
            &format!("write `{instance}({arguments})`"),
        );
        self.note_arguments(ctx, rest);
        true
    }

    /// A call of a block with its arguments.
    pub fn block_call(
        &mut self,
        ctx: &mut SclBlock,
        key: BlockKey,
        instance: Option<Instance>,
        given: &[Given],
        name: Span,
        span: Span,
    ) -> Option<Call> {
        let Some(bound) = self.program.interface(key, name) else {
            self.note_arguments(ctx, given);
            return None;
        };
        let names = given.iter().filter_map(|argument| argument.name.as_ref()).map(|name| name.text.as_str());
        if self.program.globals.is_own_of_program(key, &bound.interface.parameters, names, name) {
            self.note_arguments(ctx, given);
            return None;
        }
        let list = self.arguments(ctx, key, &bound, given, name)?;
        if let Some(instance) = &instance
            && key.kind == BlockKind::Fb
            && let Some(id) = instance_id(ctx, instance)
        {
            let supplied: Vec<usize> = list.arguments.iter().map(|argument| argument.parameter).collect();
            self.program.pointers.note(id, key, &bound, &supplied, span);
        }
        Some(Call {
            target: key,
            instance,
            arguments: list.arguments,
            enable: list.enable,
            eno: list.eno,
            is_operation: false,
            span,
        })
    }

    /// The value of a bound call.
    pub fn call_value(&mut self, call: Call, statement: bool, name: Span) -> Option<Value> {
        if statement {
            return Some(Value::Nothing(Box::new(call)));
        }
        let (key, span) = (call.target, call.span);
        let bound = self.program.interface(key, name)?;
        let supplied = |argument: &Argument| is_result(key, &bound.interface.parameters[argument.parameter]);
        if call.arguments.iter().any(supplied) {
            let label = "the variable after `RET_VAL =>` already gets its value";
            self.refuse(
                Code::UnknownParameter,
                name,
                "the value of this call is used twice",
                label,
                "leave RET_VAL out",
            );
            return None;
        }
        let ty =
            self.program.interface(key, name)?.interface.parameters.iter().find(|one| is_result(key, one)).cloned();
        match ty.map(|result| result.ty) {
            Some(DataType::Elementary(ty)) => {
                Some(Value::Elementary(Expr { kind: ExprKind::Call(Box::new(call)), ty, span }))
            }
            Some(DataType::Void | DataType::Parameter(_) | DataType::OpenArray(_)) | None => {
                let text = self.program.globals.text(name);
                self.program.report(
                    Diagnostic::new(Code::TypeMismatch, name, format!("`{text}` has no value"))
                        .label(match key.kind {
                            BlockKind::Fb | BlockKind::Sfb => "the call of a function block is a statement",
                            _ => "this function has no result that an expression could use",
                        })
                        .help("call it in a separate statement, and read its outputs after it"),
                );
                None
            }
            Some(ty) => Some(Value::Complex { value: Complex::Call(Box::new(call)), ty, span }),
        }
    }

    /// Arguments of a call that cannot be checked are still bound, so that all undefined names are reported.
    pub fn note_arguments(&mut self, ctx: &mut SclBlock, given: &[Given]) {
        let known = ctx.scope.temp_reads.len();
        let values = given.iter().filter_map(|argument| argument.value.as_ref());
        // NULL may be handed to a parameter of type VARIANT, which this one may be.
        for value in values.filter(|value| !matches!(value.kind, NodeKind::Literal(Literal::Null))) {
            self.value(ctx, value);
        }
        // It is not known which of them the call writes.
        let uses = ctx.scope.temp_reads.drain(known..).map(|read| (read.first, read.end));
        ctx.scope.temp_writes.extend(uses);
    }

    pub(in crate::bind) fn callee(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Callee> {
        match &node.kind {
            NodeKind::Name(name) => self.named_callee(ctx, node, name),
            NodeKind::Absolute(OperandKind::Block(name)) => {
                let (prefix, number) = self.program.globals.block_number(name)?;
                self.block_callee(prefix, number, node.span)
            }
            NodeKind::Member { base, name } => self.member_callee(ctx, node, base, name),
            NodeKind::Index { .. } => self.variable_callee(ctx, node),
            NodeKind::Error => None,
            _ => self.no_callee(node.span),
        }
    }

    fn named_callee(&mut self, ctx: &mut SclBlock, node: &Node, name: &Name) -> Option<Callee> {
        let local = self.is_local(ctx, name);
        if local && self.is_unknown_global(ctx, name) {
            self.unknown_function(name);
            return None;
        }
        if self.is_instance(ctx, name) {
            let text = self.program.globals.text(name.span);
            let write = |instruction: &str| format!("{text}.{instruction}(…)");
            if self.program.has_common_data(ctx.block, &name.text, name.span, write) {
                return None;
            }
            return self.variable_callee(ctx, node);
        }
        if let Some(block) = block_of_name(name) {
            let (prefix, number) = self.program.globals.block_number(&block)?;
            return self.block_callee(prefix, number, node.span);
        }
        let rules = ctx.scope.rules;
        if let Some(global) = self.program.globals.names.symbols.get(&fold(&name.text)) {
            let target = global.target;
            if name.form != NameForm::Bare || self.is_called(target) || !self.is_function(rules, &name.text) {
                return match target {
                    SymbolTarget::Block { prefix, number } => self.block_callee(prefix, number as u16, node.span),
                    SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => self.no_callee(node.span),
                };
            }
        }
        // A quoted name is a block of the program, which a part of the program may not include.
        let quoted = name.form == NameForm::Quoted && self.program.globals.input.partial;
        if let Some(named) = Named::find(&name.text).filter(|_| !quoted) {
            return Some(Callee::Function(named));
        }
        match self.library_function(rules, &name.text) {
            Some(key) => self.block_callee(crate::bind::globals::names::kind_prefix(key.kind), key.number, node.span),
            None if local => self.variable_callee(ctx, node),
            None => {
                self.unknown_function(name);
                None
            }
        }
    }

    /// True if a global symbol is possible before `(`. One that cannot does not hide a function: `LEN(…)` next to the tag `"Len"`.
    fn is_called(&self, target: SymbolTarget) -> bool {
        match target {
            SymbolTarget::Block { prefix: BlockPrefix::Db | BlockPrefix::Di, number } => u16::try_from(number)
                .ok()
                .and_then(|number| self.program.data.blocks.get(&number))
                .is_none_or(|db| db.block.instance_of.is_some()),
            SymbolTarget::Block { .. } => true,
            SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => false,
        }
    }

    /// True if the language or the library has a function of that name.
    fn is_function(&self, rules: Rules, name: &str) -> bool {
        Named::find(name).is_some() || self.library_function(rules, name).is_some()
    }

    /// True if a name before `(` means a variable. One that cannot be called does not hide a function: `LIMIT(…)` next to `#limit`.
    pub(super) fn is_instance(&self, ctx: &SclBlock, name: &Name) -> bool {
        name.form == NameForm::Local || (self.is_local(ctx, name) && callable_local(ctx, name))
    }

    /// True if a name without `#` means a variable of the block.
    fn is_local(&self, ctx: &SclBlock, name: &Name) -> bool {
        let folded = fold(&name.text);
        ctx.block.bound.locals.contains_key(&folded)
            && match name.form {
                NameForm::Bare | NameForm::Local => true,
                NameForm::Quoted => !self.program.globals.names.symbols.contains_key(&folded),
            }
    }

    /// True if a name in quotes means something global that nothing defines: where locals are written with `#`, a local of that name is another.
    pub(super) fn is_unknown_global(&self, ctx: &SclBlock, name: &Name) -> bool {
        name.form == NameForm::Quoted
            && ctx.scope.marks_locals
            && !self.program.globals.names.symbols.contains_key(&fold(&name.text))
    }

    /// The library block with the name of a function. One name can mean different blocks in STEP 7 V5 and in the TIA Portal.
    pub fn library_function(&self, rules: Rules, name: &str) -> Option<BlockKey> {
        let name = name.trim();
        // `LEFT_STRING`, next to `LEFT_WSTRING`.
        let narrow = || {
            let base = name.len().checked_sub(7).and_then(|at| name.split_at_checked(at))?;
            let both = base.1.eq_ignore_ascii_case("_STRING")
                && plcc_stdlib::find_tia(&format!("{}_WSTRING", base.0)).is_some();
            plcc_stdlib::find_tia(base.0).filter(|_| both)
        };
        let (classic, tia) = (|| plcc_stdlib::find_name(name), || plcc_stdlib::find_tia(name).or_else(narrow));
        let block = match rules {
            Rules::Classic => classic().or_else(tia),
            Rules::Tia300 | Rules::Tia1200 | Rules::Tia1500 => tia().or_else(classic),
        };
        block
            .filter(|block| !self.program.globals.library.is_foreign(block))
            .map(|block| self.program.globals.library.key_of(block))
    }

    /// A block alone: a function, or a data block that is an instance.
    fn block_callee(&mut self, prefix: BlockPrefix, number: u16, span: Span) -> Option<Callee> {
        match prefix {
            BlockPrefix::Fc | BlockPrefix::Sfc => {
                Some(Callee::Block { key: BlockKey { kind: code_kind(prefix)?, number }, instance: None })
            }
            BlockPrefix::Fb | BlockPrefix::Sfb => {
                let text = self.program.globals.text(span);
                let help = self.instance_help(BlockKey { kind: code_kind(prefix)?, number }, &text);
                self.program.report(
                    Diagnostic::new(Code::MissingOperand, span, format!("the call of `{text}` names no instance"))
                        .label("a function block keeps its data in an instance")
                        .help(help),
                );
                None
            }
            BlockPrefix::Db | BlockPrefix::Di => {
                let Some(db) = self.program.data.blocks.get(&number) else {
                    if !self.program.globals.sources.data.contains_key(&number)
                        && !self.program.data.unknown_instances.contains(&number)
                    {
                        self.program.globals.report.missing_block(prefix, number, span);
                    }
                    return None;
                };
                match db.block.instance_of {
                    Some(key) => Some(Callee::Block { key, instance: Some(Instance::Db(number)) }),
                    None => {
                        let defined = db.block.span;
                        self.program.report(
                            Diagnostic::new(Code::NoBlockFits, span, format!("DB {number} is not an instance"))
                                .label("a shared data block cannot be called")
                                .also(defined, "the data block")
                                .help("call the data block of a function block"),
                        );
                        None
                    }
                }
            }
            BlockPrefix::Udt => {
                let text = self.program.globals.text(span);
                self.program.globals.report.missing_beside_type(&text, span);
                None
            }
            BlockPrefix::Ob | BlockPrefix::Vat => self.no_callee(span),
        }
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
    fn instance_help(&self, key: BlockKey, text: &str) -> String {
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
            None => format!(
                "declare the static variable `inst{word} : {text};` and call `#inst{word}(…)`, or define `DATA_BLOCK \"{word}_DB\" {text}` and call `\"{word}_DB\"(…)`"
            ),
        }
    }

    /// `FB10.DB20`, `"Db".timer`, `"Db".TON`, `#s.timer`, `#timer.TON`.
    fn member_callee(&mut self, ctx: &mut SclBlock, node: &Node, base: &Node, name: &Name) -> Option<Callee> {
        let (ty, instance) = match self.quiet_block(ctx, base) {
            Some((prefix @ (BlockPrefix::Fb | BlockPrefix::Sfb), number)) => {
                let key = BlockKey { kind: code_kind(prefix)?, number };
                return self.instance_db(key, name);
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
            None => {
                let access = self.access(ctx, base, Intent::Both)?;
                match &access.ty {
                    DataType::Struct(ty) => (std::rc::Rc::clone(ty), Instance::Variable(access)),
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
        let what = match ty.name.as_str() {
            "" => "the data before the point".to_string(),
            of => format!("`{of}`"),
        };
        let message = match own {
            Some(key) => {
                let known =
                    self.program.globals.library_block(key).map_or(key.to_string(), |block| block.name.to_string());
                // `CTU` of CTU_INT
                let short = known.rsplit_once('_').filter(|(_, ty)| plcc_syntax::Elementary::from_word(ty).is_some());
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

    /// The instance data block after a function block: `FB10.DB20`, `"Motor"."Motor 3"`.
    fn instance_db(&mut self, key: BlockKey, name: &Name) -> Option<Callee> {
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
        if self.program.interface(key, name.span).is_some() {
            self.program.check_instance_db(key, number, name.span)?;
        }
        Some(Callee::Block { key, instance: Some(Instance::Db(number)) })
    }

    /// A variable that is an instance.
    fn variable_callee(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Callee> {
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

    fn no_callee(&mut self, span: Span) -> Option<Callee> {
        let text = self.program.globals.text(span);
        self.program.report(
            Diagnostic::new(Code::OperandKind, span, format!("`{text}` cannot be called"))
                .label("a function, or an instance of a function block, is expected here"),
        );
        None
    }

    /// The block that a node names; no message if it is none.
    pub(in crate::bind) fn quiet_block(&self, ctx: &SclBlock, node: &Node) -> Option<(BlockPrefix, u16)> {
        let name = match &node.kind {
            NodeKind::Name(name) if name.form != NameForm::Local && !self.is_local(ctx, name) => name,
            NodeKind::Absolute(OperandKind::Block(BlockName::Numbered { prefix, number, .. })) => {
                return Some((*prefix, u16::try_from(*number).ok()?));
            }
            _ => return None,
        };
        if let Some(BlockName::Numbered { prefix, number, .. }) = block_of_name(name) {
            return Some((prefix, u16::try_from(number).ok()?));
        }
        match self.program.globals.global(&name.text)? {
            SymbolTarget::Block { prefix, number } => Some((prefix, number as u16)),
            SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => None,
        }
    }

    /// Reports a function that neither the program nor the language has.
    fn unknown_function(&mut self, name: &Name) {
        if self.program.globals.missing_instruction(&name.text, name.span) {
            return;
        }
        let (folded, span) = (fold(&name.text), name.span);
        if plcc_stdlib::LIBRARY.iter().any(|block| fold(block.name) == folded) {
            self.program.globals.unknown_name(&name.text, name.span, std::iter::empty());
            return;
        }
        let blocks = || self.program.globals.names.symbols.values();
        let is_fb = |global: &&Global| matches!(global.target, SymbolTarget::Block { prefix: BlockPrefix::Fb, .. });
        let begins =
            |global: &&Global| folded.strip_prefix(&fold(&global.name)).is_some_and(|rest| rest.starts_with('_'));
        if let Some(fb) = blocks().filter(is_fb).filter(begins).max_by_key(|global| global.name.len()) {
            let (name, fb) = (&name.text, &fb.name);
            let help = format!("define the instance: `DATA_BLOCK \"{name}\" \"{fb}\" BEGIN END_DATA_BLOCK`");
            self.program.globals.report.missing_instance(name, fb, span, help);
            return;
        }
        if let Some(instruction) = instruction_of_instance(&name.text) {
            let name = &name.text;
            let help = format!(
                "define the instance: `DATA_BLOCK \"{name}\" {instruction} BEGIN END_DATA_BLOCK`; if it is a block of your own, add its source"
            );
            self.program.globals.report.missing_instance(name, instruction, span, help);
            return;
        }
        let own = blocks().filter(|global| matches!(global.target, SymbolTarget::Block { .. }));
        let own: Vec<&str> = own.map(|global| global.name.as_str()).collect();
        let shipped = plcc_stdlib::blocks().iter().map(|block| block.name);
        // A name in quotes is that of a block of the program.
        let meant = match (similar(&name.text, own.into_iter()), name.form) {
            (Some(own), _) => Some(own.to_owned()),
            (None, NameForm::Quoted) => None,
            (None, NameForm::Bare | NameForm::Local) => {
                let known = similar(&name.text, super::function::names()).or_else(|| similar(&name.text, shipped));
                known.map(str::to_owned).or_else(|| similar_conversion(&name.text))
            }
        };
        self.program.globals.report.missing_function(&name.text, name.span, meant, false);
    }
}

/// The instruction whose data block the TIA Portal names so: `TON_DB`, `R_TRIG_DB_1`, `CTU_2`.
fn instruction_of_instance(name: &str) -> Option<&'static str> {
    const INSTRUCTIONS: [&str; 9] = ["TON", "TOF", "TP", "TONR", "CTU", "CTD", "CTUD", "R_TRIG", "F_TRIG"];
    let rest = |instruction: &str| {
        let head = name.get(..instruction.len()).filter(|head| head.eq_ignore_ascii_case(instruction));
        head.and_then(|_| name[instruction.len()..].strip_prefix('_'))
    };
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    INSTRUCTIONS.into_iter().find(|instruction| {
        rest(instruction).is_some_and(|rest| {
            is_number(rest)
                || rest.get(..2).is_some_and(|db| db.eq_ignore_ascii_case("DB"))
                    && (rest.len() == 2 || rest[2..].strip_prefix('_').is_some_and(is_number))
        })
    })
}

/// `WORD_TO_INT` for `WORD_TO_ITN`.
fn similar_conversion(name: &str) -> Option<String> {
    let upper = name.to_ascii_uppercase();
    let (from, to) = upper.split_once("_TO_")?;
    let own = |word: &str| {
        let names = || plcc_syntax::Elementary::ALL.into_iter().map(|ty| ty.name());
        names().find(|name| *name == word).or_else(|| similar(word, names())).or_else(|| known_type(word))
    };
    Some(format!("{}_TO_{}", own(from)?, own(to)?))
}

/// `FB10`, `DB20` written as a bare word.
pub fn block_of_name(name: &Name) -> Option<BlockName> {
    if name.form != NameForm::Bare {
        return None;
    }
    match scl::absolute(&name.text)? {
        OperandKind::Block(BlockName::Numbered { prefix, number, .. }) => {
            Some(BlockName::Numbered { prefix, number, span: name.span })
        }
        _ => None,
    }
}

/// True if variables of a local's type can be called.
fn callable_local(ctx: &SclBlock, name: &Name) -> bool {
    let local = ctx.block.bound.locals.get(&fold(&name.text));
    local.is_some_and(|local| {
        !matches!(local.ty, DataType::Elementary(_) | DataType::String(_) | DataType::WideString(_))
    })
}

/// True of the result of a function, which is the value of its call.
pub fn is_result(key: BlockKey, parameter: &Parameter) -> bool {
    matches!(key.kind, BlockKind::Fc | BlockKind::Sfc)
        && parameter.direction == Direction::Output
        && fold(&parameter.name) == "ret_val"
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

/// An instance that is the same in every call here.
fn instance_id(ctx: &SclBlock, instance: &Instance) -> Option<crate::bind::declarations::calls::InstanceId> {
    match instance {
        Instance::Db(number) => Some(crate::bind::declarations::calls::InstanceId::Db(*number)),
        Instance::Variable(Access { base: Base::Place(Place::Instance { byte, .. }), indices, .. })
            if indices.is_empty() =>
        {
            Some(crate::bind::declarations::calls::InstanceId::Multi(ctx.block.key, *byte))
        }
        Instance::Variable(_) => None,
    }
}
