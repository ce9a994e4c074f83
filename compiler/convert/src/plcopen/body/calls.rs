//! Calls: functions, function blocks and functions of the system.

use plcc_diag::Span;
use plcc_syntax::ast::{CodeBlock, DataBlock, DataContent, TypeKind};
use plcc_syntax::scl::ast::{Argument, BinaryOp, Expr, ExprKind, Name, NameForm};

use super::{Body, nothing};
use crate::plcopen::identifier::identifier;
use crate::plcopen::program::{Global, is_function};
use crate::plcopen::system::{self, Function};

/// What a call calls.
pub enum Called<'a> {
    Function(&'a CodeBlock, String),
    /// The instance, and the type of it in the file.
    Instance {
        instance: Expr,
        ty: String,
        block: Option<&'a CodeBlock>,
    },
    /// A function of the system.
    System(Name),
    Refused,
}

impl<'a> Body<'_, 'a, '_, '_> {
    /// What an expression calls.
    pub fn called(&mut self, callee: &Expr) -> Called<'a> {
        // `t.TON(…)`: data of a timer or counter.
        if let ExprKind::Member { base, name } = &callee.kind
            && let Some(call) = system::call_on_data(&name.text)
            && let Some(ty) = self.program.type_of(base, self.block)
            && let TypeKind::Named(word) = &ty.kind
        {
            let known = match system::of_data_type(word, call) {
                Some(known) => match self.learned.instances.get(&ty.span) {
                    Some(other) if *other != call => None,
                    _ => {
                        self.learned.instances.insert(ty.span, call);
                        Some(known)
                    }
                },
                None => system::block(word).filter(|known| known.split('_').next() == Some(call)),
            };
            let Some(known) = known else {
                self.refuse(
                    callee.span,
                    format!("an instance of {word} is called as {call}"),
                    "declare it as one block",
                );
                return Called::Refused;
            };
            let instance = self.expr(base);
            return Called::Instance { instance, ty: known.to_string(), block: None };
        }
        if let Some(key) = self.program.callee_key(callee)
            && !matches!(&callee.kind, ExprKind::Name(name) if name.form == NameForm::Bare && self.is_local(&name.text))
        {
            match self.program.global(&key) {
                Some(Global::Code(block)) if is_function(block) => {
                    return Called::Function(block, self.global_name(&key));
                }
                Some(Global::Data(data)) => return self.instance(callee, data),
                Some(Global::Variable(_)) => {}
                _ => {
                    let title = "a call of a block without an instance";
                    self.refuse(callee.span, title, "call an instance data block, or an instance of the block");
                    return Called::Refused;
                }
            }
        }
        if let ExprKind::Name(name) = &callee.kind
            && (name.form == NameForm::Quoted || name.form == NameForm::Bare && !self.is_local(&name.text))
            && self.program.global(&self.program.key_of(&name.text)).is_none()
        {
            return Called::System(name.clone());
        }
        // A multi-instance, also of a structure or an array.
        let ty = self.program.type_of(callee, self.block);
        match ty.and_then(|ty| Some((ty, self.program.block_type(ty)?))) {
            Some((ty, name)) => {
                let key = self.program.type_key(ty);
                let block = match key.and_then(|key| self.program.global(&key)) {
                    Some(Global::Code(block)) => Some(block),
                    _ => None,
                };
                Called::Instance { instance: self.expr(callee), ty: name, block }
            }
            None => {
                let what = match ty.map(|ty| &ty.kind) {
                    Some(TypeKind::Named(word)) => format!("IEC 61131-3 has no function block `{word}`"),
                    _ => "a call of an instance whose function block is not in the sources".to_string(),
                };
                self.refuse(callee.span, what, "give the source of the function block, or program it in another way");
                Called::Refused
            }
        }
    }

    /// A call of an instance data block.
    fn instance(&mut self, callee: &Expr, data: &'a DataBlock) -> Called<'a> {
        let DataContent::OfType(ty) = &data.content else {
            self.refuse(callee.span, "a call of a data block that is not an instance", "call an instance");
            return Called::Refused;
        };
        match self.program.block_type(ty) {
            Some(name) => {
                let block = match self.program.instance_of(data).and_then(|key| self.program.global(&key)) {
                    Some(Global::Code(block)) => Some(block),
                    _ => None,
                };
                Called::Instance { instance: self.expr(callee), ty: name, block }
            }
            None => {
                let word = match &ty.kind {
                    TypeKind::Named(word) => word.clone(),
                    TypeKind::Block(name) => self.program.shown(&self.program.key(name)),
                    _ => String::new(),
                };
                let title = format!("IEC 61131-3 has no function block `{word}`, and no source declares it");
                self.refuse(callee.span, title, "program it in another way");
                Called::Refused
            }
        }
    }

    pub(super) fn call(&mut self, callee: &Expr, arguments: &[Argument], span: Span) -> Expr {
        let arguments_of = |body: &mut Self, name: &dyn Fn(&str) -> String| -> Vec<Argument> {
            let formal_name = |text: &str| match text.to_ascii_uppercase() {
                upper if matches!(upper.as_str(), "EN" | "ENO") => upper,
                _ => name(text),
            };
            let written = |argument: &Argument| Argument {
                name: argument.name.as_ref().map(|formal| Name { text: formal_name(&formal.text), ..formal.clone() }),
                output: argument.output,
                value: argument.value.as_ref().map(|value| body.expr(value)),
                span: argument.span,
            };
            arguments.iter().map(written).collect()
        };
        let named = |text: String, span| {
            Box::new(Expr { kind: ExprKind::Name(Name { text, form: NameForm::Bare, span }), span })
        };
        let kind = match self.called(callee) {
            Called::Function(_, name) => {
                let arguments = arguments_of(self, &identifier);
                ExprKind::Call { callee: named(name, callee.span), arguments }
            }
            Called::Instance { instance, block: Some(block), .. } => {
                let left: Vec<bool> = arguments.iter().map(|argument| self.is_left_out(block, argument)).collect();
                let mut arguments = arguments_of(self, &identifier);
                let mut left = left.into_iter();
                arguments.retain(|_| !left.next().unwrap_or(false));
                ExprKind::Call { callee: Box::new(instance), arguments }
            }
            Called::Instance { instance, block: None, .. } => {
                let arguments = arguments_of(self, &|formal| formal.to_string());
                ExprKind::Call { callee: Box::new(instance), arguments }
            }
            Called::System(name) => return self.function(&name, arguments, span),
            Called::Refused => nothing(span),
        };
        Expr { kind, span }
    }

    /// A function of SCL.
    fn function(&mut self, name: &Name, arguments: &[Argument], span: Span) -> Expr {
        let first = arguments.first().and_then(|argument| argument.value.as_ref());
        let values: Vec<Argument> = arguments
            .iter()
            .map(|argument| Argument {
                value: argument.value.as_ref().map(|value| self.expr(value)),
                ..argument.clone()
            })
            .collect();
        // A square of a variable: computing it twice changes nothing.
        if name.text.eq_ignore_ascii_case("SQR")
            && let [Argument { value: Some(value), .. }] = values.as_slice()
            && matches!(value.kind, ExprKind::Name(_) | ExprKind::Member { .. } | ExprKind::Absolute(_))
        {
            let (left, right) = (Box::new(value.clone()), Box::new(value.clone()));
            return Expr { kind: ExprKind::Binary { op: BinaryOp::Multiply, left, right, op_span: name.span }, span };
        }
        let ty = first.and_then(|value| self.elementary(value));
        let text = match system::function(&name.text, ty) {
            Function::Same => name.text.clone(),
            Function::Named(text) => text,
            Function::None(reason) => {
                let help = "write it with operators and functions of the standard, or as a function of your own";
                self.refuse(name.span, reason, help);
                name.text.clone()
            }
        };
        if text.eq_ignore_ascii_case("TRUNC") && self.locals.contains("trunc") {
            self.refuse(name.span, "a variable has the name of a function", "rename it");
        }
        let callee = Name { text, form: NameForm::Bare, span: name.span };
        let callee = Box::new(Expr { kind: ExprKind::Name(callee), span: name.span });
        Expr { kind: ExprKind::Call { callee, arguments: values }, span }
    }
}
