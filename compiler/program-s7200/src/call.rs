//! Calls of subroutines with their parameters, and interrupt routines at ATCH.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::count::counted;
use plcc_syntax::s7200::ast::{self, Constant, Section};
use plcc_syntax::s7200::libraries::{self, Subroutine};
use plcc_syntax::s7200::{Insn, OperandClass};

use super::Binder;
use super::constant::{Target, whole};
use super::interface::{Local, Locals, Type};
use super::operand::memory;
use super::settle::Settled;
use plcc_model::s7200::{Operand, StatementKind};

impl Binder<'_> {
    /// `CALL Scale, VW0, VW2`; `None`: reported.
    pub fn call(
        &mut self,
        locals: &Locals,
        caller: usize,
        operands: &[ast::Operand],
        mnemonic: Span,
    ) -> Option<StatementKind> {
        let Some((target, actuals)) = operands.split_first() else {
            self.missing_operand("the subroutine", mnemonic, "write its name after `CALL`");
            return None;
        };
        let callee = self.block_operand(locals, target, BlockKind::Sbr)?;
        self.uses.call(caller, callee, target.span);
        let block = self.blocks.get(callee)?;
        let (number, name, formals) = (block.number, block.name.clone(), block.locals.clone());
        if formals.has_unknown() {
            return None;
        }
        let title = if name.is_empty() { format!("SBR{number}") } else { format!("`{name}`") };
        let wanted = formals.parameters().count();
        // If the EN of the box is declared, it is S0, and calls may omit it.
        let is_enable = |local: &Local| {
            local.section == Section::Input && local.ty == Type::Bool && local.name.eq_ignore_ascii_case("EN")
        };
        let has_enable = actuals.len() + 1 == wanted && formals.parameters().next().is_some_and(is_enable);
        let left_out = usize::from(has_enable);
        if actuals.len() + left_out < wanted {
            let missing: Vec<&str> =
                formals.parameters().skip(actuals.len()).map(|local| local.name.as_str()).collect();
            self.push(
                Diagnostic::new(
                    Code::MissingParameter,
                    mnemonic,
                    format!("{title} has {}, the call has {} (0090)", counted(wanted, "parameter"), actuals.len()),
                )
                .label(format!("missing: {}", missing.join(", ")))
                .help("write all parameters in the order of the declarations: inputs, in/outs, outputs"),
            );
        }
        if let Some(surplus) = actuals.get(wanted) {
            self.push(
                Diagnostic::new(
                    Code::UnknownParameter,
                    surplus.span,
                    format!("{title} has {}, the call has {} (0090)", counted(wanted, "parameter"), actuals.len()),
                )
                .label("the first surplus argument")
                .help("remove what the subroutine does not declare, or declare it"),
            );
        }
        let mut arguments: Vec<Option<Operand>> = Vec::new();
        if has_enable {
            arguments.push(Some(Operand::Const(1)));
        }
        let complete = actuals.len() + left_out == wanted;
        let told = self.report.diagnostics.len();
        for (formal, actual) in formals.parameters().skip(left_out).zip(actuals) {
            arguments.push(self.argument(locals, formal, actual));
        }
        if !complete {
            // Operands after one that is missing belong to other parameters.
            let misfits = [Code::OperandKind, Code::LiteralRange, Code::Protected];
            let arguments = self.report.diagnostics.split_off(told);
            self.report.diagnostics.extend(arguments.into_iter().filter(|message| !misfits.contains(&message.code)));
        }
        let arguments: Option<Vec<Operand>> = arguments.into_iter().collect();
        let arguments = arguments.filter(|arguments| arguments.len() == wanted && complete)?;
        Some(StatementKind::Call { number, arguments })
    }

    fn argument(&mut self, locals: &Locals, formal: &Local, actual: &ast::Operand) -> Option<Operand> {
        if formal.ty == Type::String {
            return self.string_argument(locals, actual);
        }
        let class = class_of(formal);
        if let Some(message) = self.misfitting_argument(locals, formal, class, actual) {
            self.push(message);
            return None;
        }
        let told = self.report.diagnostics.len();
        let bound = self.argument_of_type(locals, formal, class, actual);
        // The messages name the parameter, whose type is declared.
        for message in self.report.diagnostics.iter_mut().skip(told) {
            message.title = message.title.replace("the instruction needs", "the subroutine needs");
            message.title.push_str(&format!(", parameter `{}`", formal.name));
            if let Some(help) = &mut message.help
                && let Some(at) = help.find("use an instruction for ")
            {
                help.truncate(at);
                help.push_str(&format!("declare `{}` with another type", formal.name));
            }
        }
        bound
    }

    fn argument_of_type(
        &mut self,
        locals: &Locals,
        formal: &Local,
        class: OperandClass,
        actual: &ast::Operand,
    ) -> Option<Operand> {
        let input = formal.section == Section::Input;
        // Constants depend on the type of the parameter, not only on its width: 40000 is a WORD, but not an INT.
        if input && let Some(Settled::Constant(constant)) = self.settle_quietly(locals, actual) {
            let target = match (formal.ty, &constant) {
                (Type::Bool, _) => Some(Target::Bool),
                (Type::Int | Type::Dint, _) => Some(Target::Signed(formal.ty.width())),
                (Type::Dword, Constant::Real(_)) => Some(Target::Bits(formal.ty.width())),
                (Type::Byte | Type::Word | Type::Dword | Type::Real | Type::String, _) => None,
            };
            if let Some(target) = target {
                return self.constant(&constant, target, actual.span).map(Operand::Const);
            }
        }
        self.operand(locals, class, actual)
    }

    /// What the operand is, if known; no message otherwise.
    fn settle_quietly(&mut self, locals: &Locals, operand: &ast::Operand) -> Option<Settled> {
        match &operand.kind {
            ast::OperandKind::Constant(constant) => Some(Settled::Constant(constant.clone())),
            ast::OperandKind::Symbol { name, form: ast::SymbolForm::Bare | ast::SymbolForm::Quoted }
                if locals.find(name).is_none() =>
            {
                match self.globals.get(&super::names::fold(name)).map(|global| &global.target) {
                    Some(ast::OperandKind::Constant(constant)) => Some(Settled::Constant(constant.clone())),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// A string parameter gets a pointer.
    fn string_argument(&mut self, locals: &Locals, actual: &ast::Operand) -> Option<Operand> {
        let span = actual.span;
        match self.settle(locals, actual, true)? {
            Settled::Direct(direct) => self.string_pointer(direct, span),
            Settled::StringVariable(pointer) => memory(pointer, plcc_syntax::ast::Width::Dword),
            Settled::Pointer(pointer) => Some(Operand::Const(pointer)),
            // The value that `*` refers to is a string: its pointer is the value of the pointer variable.
            Settled::Indirect(pointer) => Some(pointer),
            Settled::Constant(Constant::Text(bytes)) => self.text(bytes, span),
            Settled::Constant(_) | Settled::Block(_) => {
                self.push(
                    Diagnostic::new(Code::TypeMismatch, span, "a STRING parameter needs a string (0090)")
                        .label("this is not a string")
                        .help("name its first byte (`VB100`), a pointer (`*VD200`), or write it in double quotes"),
                );
                None
            }
        }
    }

    /// The interrupt routine of ATCH, by name or number.
    pub fn interrupt(&mut self, settled: Settled, span: Span) -> Option<Operand> {
        let index = self.settled_block(settled, BlockKind::Int, span)?;
        let number = self.blocks.get(index)?.number;
        Some(Operand::Const(u32::from(number)))
    }

    /// The interrupt routine of ATCH as an operand.
    pub fn interrupt_operand(&mut self, locals: &Locals, operand: &ast::Operand) -> Option<Operand> {
        let index = self.block_operand(locals, operand, BlockKind::Int)?;
        self.interrupt(Settled::Block(index), operand.span)
    }

    fn block_operand(&mut self, locals: &Locals, operand: &ast::Operand, kind: BlockKind) -> Option<usize> {
        // A block that is called by name may share its name with a local variable.
        if let ast::OperandKind::Symbol { name, form } = &operand.kind
            && *form != ast::SymbolForm::Local
            && let Some(&index) = self.by_name.get(&super::names::fold(name))
        {
            return self.settled_block(Settled::Block(index), kind, operand.span);
        }
        if let ast::OperandKind::Symbol { name, form: ast::SymbolForm::Bare } = &operand.kind
            && !self.globals.contains_key(&super::names::fold(name))
            && locals.find(name).is_none()
        {
            self.unknown_block(locals, name, kind, operand.span);
            return None;
        }
        let settled = self.settle(locals, operand, false)?;
        self.settled_block(settled, kind, operand.span)
    }

    /// A block of `kind`: by name, or by a constant with its number.
    fn settled_block(&mut self, settled: Settled, kind: BlockKind, span: Span) -> Option<usize> {
        let index = match settled {
            Settled::Block(index) => index,
            Settled::Constant(constant) => match whole(&constant).and_then(|number| u32::try_from(number).ok()) {
                Some(number) => match self.settle_block(kind, number, None, span)? {
                    Settled::Block(index) => index,
                    _ => return None,
                },
                None => return self.no_block(kind, span),
            },
            _ => return self.no_block(kind, span),
        };
        match self.blocks.get(index) {
            Some(block) if block.kind == kind => Some(index),
            Some(block) => self.other_block(block.kind, kind, span),
            None => self.no_block(kind, span),
        }
    }

    /// Reports a block that is not of the kind that `CALL` or `ATCH` needs.
    fn other_block(&mut self, own: BlockKind, needed: BlockKind, span: Span) -> Option<usize> {
        let written = self.written(span);
        let (call, attach) = (self.mnemonic(Insn::Call), self.mnemonic(Insn::Atch));
        let help = match own {
            BlockKind::Sbr => format!("attach an interrupt routine that contains `{call} {written}`"),
            BlockKind::Int => format!("write `{attach} {written}, 10`, with the number of the event that starts it"),
            _ => format!("the CPU calls it in each scan: move what is meant into {}", with_article(needed)),
        };
        let is = if own == BlockKind::Ob { "the main program".to_string() } else { with_article(own) };
        let title = format!("`{written}` is {is}, not {} (0087)", with_article(needed));
        let label = format!("{} is needed here", with_article(needed));
        self.push(Diagnostic::new(Code::OperandKind, span, title).label(label).help(help));
        None
    }

    fn no_block(&mut self, kind: BlockKind, span: Span) -> Option<usize> {
        let (what, example) = match kind {
            BlockKind::Int => ("an interrupt routine", "ATCH INT0, 10"),
            _ => ("a subroutine", "CALL SBR0"),
        };
        self.push(
            Diagnostic::new(Code::OperandKind, span, format!("{what} is expected here (0087)"))
                .label(format!("this is not {what}"))
                .help(format!("write its name or its number: `{example}`")),
        );
        None
    }

    fn unknown_block(&mut self, locals: &Locals, name: &str, kind: BlockKind, span: Span) {
        let near = self.nearest(name, locals);
        let what = what(kind);
        self.report.missing(plcc_binding::report::MissingKey::Symbol(super::names::fold(name)), span, || {
            let message =
                Diagnostic::new(Code::UnknownBlock, span, format!("the {what} `{name}` is not defined (0087)"));
            if let Some(known) = libraries::subroutine(name) {
                return of_library(message, name, &known);
            }
            if let Some(purpose) = libraries::wizard(name) {
                return of_wizard(message, name, purpose);
            }
            let message = message.label("no source of the program has this block");
            match near.as_slice() {
                [] => message.help("add the source that defines it; a file without a header is named after its block"),
                _ => message.help(format!("names like it: {}", near.join(", "))),
            }
        });
    }

    /// Reports that an operand is missing after a mnemonic.
    pub fn missing_operand(&mut self, what: &str, mnemonic: Span, help: &str) {
        self.push(
            Diagnostic::new(Code::MissingOperand, mnemonic, "an operand is missing")
                .label(format!("{what} must follow"))
                .help(help),
        );
    }
}

/// What a parameter takes.
fn class_of(formal: &Local) -> OperandClass {
    let input = formal.section == Section::Input;
    match (formal.ty, input) {
        (Type::Bool, true) => OperandClass::Bit,
        (Type::Bool, false) => OperandClass::BitWrite,
        (Type::Byte, true) => OperandClass::ByteIn,
        (Type::Byte, false) => OperandClass::ByteOut,
        (Type::Word | Type::Int, true) => OperandClass::WordIn,
        (Type::Word | Type::Int, false) if formal.section == Section::Output => OperandClass::WordOutAnalog,
        (Type::Word | Type::Int, false) => OperandClass::WordOut,
        (Type::Dword | Type::Dint, true) => OperandClass::DwordInAddress,
        (Type::Real, true) => OperandClass::RealIn,
        (Type::Dword | Type::Dint | Type::Real | Type::String, _) => OperandClass::DwordOut,
    }
}

/// The kind of a block that can be called or attached.
pub(super) fn what(kind: BlockKind) -> &'static str {
    if kind == BlockKind::Int { "interrupt routine" } else { "subroutine" }
}

fn with_article(kind: BlockKind) -> String {
    let article = if kind == BlockKind::Int { "an" } else { "a" };
    format!("{article} {}", what(kind))
}

/// The message about a subroutine of a library of Micro/WIN that is not defined.
pub(super) fn of_library(message: Diagnostic, name: &str, known: &Subroutine) -> Diagnostic {
    let library = known.library;
    message
        .label(format!("it is in the {library} library of Micro/WIN, which plcc does not have"))
        .help(format!("write a subroutine `{name}` in its place, or accept missing parts with `--partial`"))
}

/// The message about a subroutine that a wizard of Micro/WIN makes and that is not defined.
pub(super) fn of_wizard(message: Diagnostic, name: &str, purpose: &str) -> Diagnostic {
    message.label(format!("the wizard {purpose} of Micro/WIN makes it")).help(format!(
        "export it with the program; if it is protected, write a subroutine `{name}` in its place, or accept missing parts with `--partial`"
    ))
}
