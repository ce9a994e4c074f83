//! What a call names: a block, an instance, or a function of the language.
//!
//! Source: SCL reference, call forms. Blocks of the program take precedence over functions of the same name.

use plcc_binding::fold;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::BlockKey;
use plcc_model::scl::Instance;
use plcc_model::types::DataType;
use plcc_stdlib::SystemBlock;
use plcc_syntax::ast::{BlockName, BlockPrefix, OperandKind};
use plcc_syntax::scl;
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind, Name, NameForm};
use plcc_syntax::symbols::SymbolTarget;

use super::Rules;
use super::function::Named;
use crate::bind::globals::names::{code_kind, kind_prefix};
use crate::bind::scl::{SclBinder, SclBlock};
use crate::bind::trees::SYSTEM_FILE;
use crate::bind::trees::chart_data::is_step_or_transition;

/// The library block with the name of a function. One name can mean different blocks in STEP 7 V5 and in the TIA Portal.
pub fn library_block(rules: Rules, name: &str) -> Option<&'static SystemBlock> {
    let name = name.trim();
    // `LEFT_STRING`, next to `LEFT_WSTRING`.
    let narrow = || {
        let base = name.len().checked_sub(7).and_then(|at| name.split_at_checked(at))?;
        let both =
            base.1.eq_ignore_ascii_case("_STRING") && plcc_stdlib::find_tia(&format!("{}_WSTRING", base.0)).is_some();
        plcc_stdlib::find_tia(base.0).filter(|_| both)
    };
    let (classic, tia) = (|| plcc_stdlib::find_name(name), || plcc_stdlib::find_tia(name).or_else(narrow));
    match rules {
        Rules::Classic => classic().or_else(tia),
        Rules::Tia300 | Rules::Tia1200 | Rules::Tia1500 => tia().or_else(classic),
    }
}

/// The target of a call.
pub enum Callee {
    Block { key: BlockKey, instance: Option<Instance> },
    Function(Named),
}

impl SclBinder<'_, '_> {
    pub(in crate::bind) fn callee(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Callee> {
        match &node.kind {
            NodeKind::Name(name) => self.named_callee(ctx, node, name),
            NodeKind::Absolute(OperandKind::Block(name)) => {
                let (prefix, number) = self.program.globals.block_number(name)?;
                self.block_callee(ctx, prefix, number, node.span)
            }
            NodeKind::Member { base, name } => self.member_callee(ctx, node, base, name),
            NodeKind::Index { .. } => self.variable_callee(ctx, node),
            NodeKind::Error => None,
            _ => self.no_callee(node.span),
        }
    }

    fn named_callee(&mut self, ctx: &mut SclBlock, node: &Node, name: &Name) -> Option<Callee> {
        let local = self.is_local(ctx, name);
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
            return self.block_callee(ctx, prefix, number, node.span);
        }
        let rules = ctx.scope.rules;
        let of_library = name.span.file == SYSTEM_FILE;
        // A block of the library means others of the library.
        let own = !of_library || name.form != NameForm::Bare || !self.is_function(rules, &name.text);
        if let Some(global) = self.program.globals.names.symbols.get(&fold(&name.text)).filter(|_| own) {
            let target = global.target;
            if name.form != NameForm::Bare || self.is_called(target) || !self.is_function(rules, &name.text) {
                return match target {
                    SymbolTarget::Block { prefix, number } => self.block_callee(ctx, prefix, number as u16, node.span),
                    SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => self.no_callee(node.span),
                };
            }
        }
        // A quoted name is a block of the program, which a part of the program may not include.
        let quoted = name.form == NameForm::Quoted && self.program.globals.input.partial;
        if let Some(named) = Named::find(&name.text).filter(|_| !quoted) {
            return Some(Callee::Function(named));
        }
        let is_part = !of_library && self.program.globals.is_part(&name.text);
        match self.library_function(rules, &name.text).filter(|_| !is_part) {
            Some(key) => self.block_callee(ctx, kind_prefix(key.kind), key.number, node.span),
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
    pub(super) fn is_local(&self, ctx: &SclBlock, name: &Name) -> bool {
        let folded = fold(&name.text);
        ctx.block.bound.locals.contains_key(&folded)
            && match name.form {
                NameForm::Bare | NameForm::Local => true,
                NameForm::Quoted => {
                    !ctx.scope.marks_locals && !self.program.globals.names.symbols.contains_key(&folded)
                }
            }
    }

    /// True if a name in quotes means something global that nothing defines: where locals are written with `#`, a local of that name is another.
    pub(super) fn is_unknown_global(&self, ctx: &SclBlock, name: &Name) -> bool {
        name.form == NameForm::Quoted
            && ctx.scope.marks_locals
            && !self.program.globals.names.symbols.contains_key(&fold(&name.text))
    }

    /// True of a name in quotes that is used as a value and means a symbol that nothing defines: `"Start"` alone in a chart of S7-GRAPH V5 with a
    /// step or transition of that name, whose data as a whole are not a value, and `"Limit"`, which is a function of the library only where it is
    /// called.
    pub(super) fn is_unknown_symbol(&self, ctx: &SclBlock, name: &Name, span: Span) -> bool {
        let globals = &self.program.globals;
        name.form == NameForm::Quoted
            && match ctx.block.bound.locals.get(&fold(&name.text)) {
                Some(local) => {
                    let is_defined = globals.is_defined(&name.text);
                    ctx.scope.address_numbers && is_step_or_transition(&local.ty) && !is_defined
                }
                None => span.file != SYSTEM_FILE && globals.is_only_in_library(&name.text),
            }
    }

    /// The library block with the name of a function, if the program does not mean its own.
    pub fn library_function(&self, rules: Rules, name: &str) -> Option<BlockKey> {
        library_block(rules, name)
            .filter(|block| !self.program.globals.library.is_foreign(block))
            .map(|block| self.program.globals.library.key_of(block))
    }

    /// A block alone: a function, or a data block that is an instance.
    fn block_callee(&mut self, ctx: &SclBlock, prefix: BlockPrefix, number: u16, span: Span) -> Option<Callee> {
        match prefix {
            BlockPrefix::Fc | BlockPrefix::Sfc => {
                Some(Callee::Block { key: BlockKey { kind: code_kind(prefix)?, number }, instance: None })
            }
            BlockPrefix::Fb | BlockPrefix::Sfb => {
                let text = self.program.globals.text(span);
                let help = self.instance_help(ctx, BlockKey { kind: code_kind(prefix)?, number }, &text);
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
                        let text = self.program.globals.text(span);
                        self.program.report(
                            Diagnostic::new(Code::NoBlockFits, span, format!("`{text}` is not an instance"))
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
            BlockPrefix::Ob => {
                let text = self.program.globals.text(span);
                let title = format!("`{text}` cannot be called");
                let help = "write the statements that both need in a function, and call that";
                self.refuse(Code::OperandKind, span, &title, "only the CPU calls organization blocks", help);
                None
            }
            BlockPrefix::Vat => self.no_callee(span),
        }
    }

    pub(super) fn no_callee(&mut self, span: Span) -> Option<Callee> {
        let text = self.program.globals.text(span);
        let message = Diagnostic::new(Code::OperandKind, span, format!("`{text}` cannot be called"))
            .label("a function, or an instance of a function block, is expected here");
        // `(a + b)(c - d)`
        self.program.report(match text.ends_with(')') {
            true => message.help("write the operator that is missing before the next `(`, as in `a * (b + c)`"),
            false => message,
        });
        None
    }

    /// The block that a node names; no message if it names no block.
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
