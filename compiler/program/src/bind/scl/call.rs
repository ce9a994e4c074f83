//! Calls: a block with its instance, or a function of the language, and the value of the call.
//!
//! `callee` has what a call names, `instance` the instances in it, `unknown_function` what is said of a name without a meaning.
//! Source: SCL reference, call forms.

use plcc_abi::image::BlockKind;
use plcc_binding::fold;
use plcc_diag::{Code, Span};
use plcc_model::scl::{Access, Argument, Base, Call, Complex, Expr, ExprKind, Instance};
use plcc_model::types::DataType;
use plcc_model::{BlockKey, Direction, Parameter, Place};
use plcc_syntax::ast::BlockPrefix;
use plcc_syntax::scl::ast::{Argument as Given, Expr as Node, ExprKind as NodeKind, Literal, NameForm};
use plcc_syntax::symbols::SymbolTarget;

use super::Intent;
use super::callee::Callee;
use super::expression::constant_expr;
use super::place::{Db, Thing};
use super::value::Value;
use crate::bind::scl::{SclBinder, SclBlock};

impl SclBinder<'_, '_> {
    /// Binds a call: of a block, an instance, a function of the language. `statement`: its value may be unused.
    pub fn call(&mut self, ctx: &mut SclBlock, node: &Node, statement: bool) -> Option<Value> {
        let NodeKind::Call { callee, arguments } = &node.kind else { return None };
        if let Some(number) = self.number_of_block(ctx, callee, arguments, node.span) {
            return number;
        }
        let wide = self.overload(ctx, callee, arguments).map(|key| Callee::Block { key, instance: None });
        if self.cast(ctx, callee, arguments)
            || self.foreign_function(ctx, callee, arguments)
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
        self.check_text_position(key, &bound.interface.parameters, &list.arguments);
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
                let mut parameters = bound.interface.parameters.iter();
                let output = parameters.find(|one| one.direction == Direction::Output && !is_result(key, one));
                let has_instance = matches!(key.kind, BlockKind::Fb | BlockKind::Sfb);
                let label = match has_instance {
                    true => "the call of a function block is a statement",
                    false => "this function has no result that an expression could use",
                };
                let help = match (has_instance, output) {
                    (true, Some(output)) => {
                        // `FB1.DB1`
                        let block = self.program.globals.shown(key).replace(['`', ' '], "");
                        let own = text.split_once('.').filter(|(first, _)| first.replace(['"', ' '], "") == block);
                        let instance = own.map_or(text.as_str(), |(_, instance)| instance);
                        format!("call it in a statement before this one, and read `{instance}.{}`", output.name)
                    }
                    (false, Some(output)) => {
                        format!("call it in a separate statement, and take its output: `{} => …`", output.name)
                    }
                    (_, None) => "call it in a separate statement".to_owned(),
                };
                self.refuse(Code::TypeMismatch, name, &format!("`{text}` has no value"), label, &help);
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
}

/// True of the result of a function, which is the value of its call.
pub fn is_result(key: BlockKey, parameter: &Parameter) -> bool {
    matches!(key.kind, BlockKind::Fc | BlockKind::Sfc)
        && parameter.direction == Direction::Output
        && fold(&parameter.name) == "ret_val"
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
