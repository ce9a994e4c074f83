//! Instances of calls: data blocks, multi-instances, and instances in the data of a data block.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, BlockPrefix, OperandKind, PathRoot};
use plcc_syntax::symbols::SymbolTarget;

use crate::bind::declarations::block::CurrentBlock;
use crate::bind::declarations::typed::BoundInterface;
use crate::bind::globals::names::{code_kind, kind_prefix};
use crate::bind::globals::sources::portal_cpu;
use crate::bind::stl::StlBinder;
use crate::bind::stl::settle::Settled;
use plcc_binding::report::Report;
use plcc_model::types::DataType;
use plcc_model::{BlockKey, Instance, Number, Place};

impl StlBinder<'_, '_> {
    /// The instance of a call; the outer `None` after a message.
    pub fn instance(
        &mut self,
        ctx: &mut CurrentBlock,
        call: &ast::Call,
        key: BlockKey,
        own: Option<Instance>,
    ) -> Option<Option<Instance>> {
        let needs = matches!(key.kind, BlockKind::Fb | BlockKind::Sfb);
        let Some(operand) = &call.instance else {
            if own.is_some() {
                return Some(own);
            }
            if needs {
                self.program.report(
                    Diagnostic::new(
                        Code::MissingOperand,
                        call.target.span,
                        format!("the call of {} names no instance data block", self.program.globals.shown(key)),
                    )
                    .label("a function block keeps its data in a DB")
                    .help(self.with_instance(key, call.target.span)),
                );
                return None;
            }
            return Some(None);
        };
        if own.is_some() || !needs {
            self.program.report(
                Diagnostic::new(Code::SurplusOperand, operand.span, "this call cannot have an instance data block")
                    .label(if needs { "the call names its instance already" } else { "a function has no instance" })
                    .help("remove the data block"),
            );
            return None;
        }
        let settled = self.settle(ctx, operand)?;
        if let Settled::Complex { place, ty } = &settled
            && let Some(own) = instance_key(ty)
        {
            return match named_instance(place) {
                Some(instance) => self.own_instance(key, own, instance, operand.span),
                None if !place.indices().is_empty() => self.computed_instance(operand.span),
                None if is_passed(place) => self.passed_instance(operand.span),
                None => self.no_instance(operand.span),
            };
        }
        let number = match settled {
            Settled::Block { prefix: BlockPrefix::Db, number: Number::Known(number) } if number != 0 => number,
            _ => return self.no_instance(operand.span),
        };
        let own = self.program.data.blocks.get(&number).and_then(|db| db.block.instance_of);
        if own.is_none_or(|own| !self.shares_data(own, key, operand.span)) {
            self.program.check_instance_db(key, number, operand.span)?;
        }
        Some(Some(Instance::Db(number)))
    }

    /// How to call the function block at `span` with one of its instances, if the program has any.
    fn with_instance(&self, key: BlockKey, span: Span) -> String {
        let block = self.program.globals.text(span);
        let of_block = self.program.data.blocks.iter().filter(|(_, db)| db.block.instance_of == Some(key));
        let mut instances: Vec<u16> = of_block.map(|(number, _)| *number).collect();
        instances.sort_unstable();
        let Some(first) = instances.first() else {
            return format!("write `CALL {block}, DB …` with the number or the symbol of its instance data block");
        };
        let data = match self.program.globals.names.block_name(BlockPrefix::Db, *first) {
            name if name.is_empty() => format!("DB {first}"),
            name => format!("\"{name}\""),
        };
        let more = if instances.len() > 1 { ", or another of its instances" } else { "" };
        format!("write `CALL {block}, {data}`{more}")
    }

    fn no_instance<T>(&mut self, span: Span) -> Option<T> {
        let text = self.program.globals.text(span);
        self.program.report(
            Diagnostic::new(Code::OperandKind, span, format!("`{text}` is not a data block"))
                .label("the instance data block is expected here"),
        );
        None
    }

    /// Reports an instance that an index chooses.
    pub fn computed_instance<T>(&mut self, span: Span) -> Option<T> {
        self.no_variable_index(span, "the instance of a call must be known")
    }

    /// Reports an instance that is a parameter.
    pub fn passed_instance<T>(&mut self, span: Span) -> Option<T> {
        let text = self.program.globals.text(span);
        let title = format!("plcc does not call `{text}` in STL: it is an instance of the caller");
        self.program.report(
            Diagnostic::new(Code::OperandKind, span, title)
                .label("a parameter of this block")
                .help("call it in the block that declares it, or write this block in SCL, LAD or FBD"),
        );
        None
    }

    /// `CALL TON, #timer` of the TIA Portal, which names the block of an instance, too. `own`: the block of the instance.
    fn own_instance(
        &mut self,
        key: BlockKey,
        own: BlockKey,
        instance: Instance,
        span: Span,
    ) -> Option<Option<Instance>> {
        if own == key || self.shares_data(own, key, span) {
            return Some(Some(instance));
        }
        let globals = &self.program.globals;
        let (own, key) = (globals.shown(own), globals.shown(key));
        let title = format!("`{}` is an instance of {own}, not of {key}", globals.text(span));
        self.program.report(
            Diagnostic::new(Code::NoBlockFits, span, title)
                .label("an instance of the block is expected here")
                .help("call the instance by its name alone, or name one of the block"),
        );
        None
    }

    /// The block of `CALL TON, #ton`: a name before an instance is that of a block, also if the block declares a variable `ton`.
    pub fn named_before_instance(&mut self, ctx: &mut CurrentBlock, call: &ast::Call) -> Option<(BlockPrefix, u16)> {
        let OperandKind::Path(path) = &call.target.kind else { return None };
        let instance = call.instance.as_ref()?;
        let name = path.name()?;
        if let Some(key) = self.instruction_of(ctx, name, instance) {
            return Some((kind_prefix(key.kind), key.number));
        }
        if !matches!(path.root, PathRoot::Bare { .. }) {
            return None;
        }
        match self.program.globals.global(name)? {
            SymbolTarget::Block { prefix, number } => Some((prefix, u16::try_from(number).ok()?)),
            SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => None,
        }
    }

    /// The block that a name means where data types are declared, if the data of the instance is that of the block. The data decides
    /// about its type: `CTU` with data of the type IEC_DCOUNTER is CTU_DINT.
    fn instruction_of(&mut self, ctx: &mut CurrentBlock, name: &str, instance: &ast::Operand) -> Option<BlockKey> {
        self.program.type_block(name)?;
        let own = self.block_of_instance(ctx, instance)?;
        let ty = self.program.globals.library_block(own).and_then(|block| block.name.split_once('_'));
        let typed = ty.map(|(_, ty)| format!("{name}_{ty}"));
        for name in typed.as_deref().into_iter().chain([name]) {
            let Some((prefix, number)) = self.program.type_block(name) else { continue };
            let Some(kind) = code_kind(prefix) else { continue };
            let key = BlockKey { kind, number };
            if own == key || self.shares_data(own, key, instance.span) {
                return Some(key);
            }
        }
        None
    }

    /// The block whose instance an operand is; no message.
    fn block_of_instance(&mut self, ctx: &mut CurrentBlock, instance: &ast::Operand) -> Option<BlockKey> {
        let report = std::mem::replace(&mut self.program.globals.report, Report::new(true));
        let unknown = ctx.unknown_locals.clone();
        let settled = self.settle(ctx, instance);
        ctx.unknown_locals = unknown;
        self.program.globals.report = report;
        match settled? {
            Settled::Complex { ty, .. } => instance_key(&ty),
            Settled::Block { prefix: BlockPrefix::Db, number: Number::Known(number) } => {
                self.program.data.blocks.get(&number)?.block.instance_of
            }
            _ => None,
        }
    }

    /// Whether an instance of `own` is the common data of IEC timers or counters, which are declared as the block with the most
    /// parameters, and `key` is one of them.
    fn shares_data(&mut self, own: BlockKey, key: BlockKey, span: Span) -> bool {
        let globals = &self.program.globals;
        let (Some(common), Some(_)) = (globals.library_block(own), globals.library_block(key)) else { return false };
        let is_common = ["TONR", "CTUD"].contains(&common.name.split('_').next().unwrap_or_default());
        if own == key || !is_common || !portal_cpu(globals.input) {
            return false;
        }
        let (Some(own), Some(other)) = (self.program.interface(own, span), self.program.interface(key, span)) else {
            return false;
        };
        let has = |bound: &BoundInterface, name: &str| {
            bound.interface.instance.iter().any(|member| member.name.eq_ignore_ascii_case(name))
        };
        own.interface.bytes == other.interface.bytes
            && ["ET", "CV"].iter().any(|shared| has(&own, shared) && has(&other, shared))
    }
}

/// The block whose instance a structure is.
pub fn instance_key(ty: &DataType) -> Option<BlockKey> {
    let DataType::Struct(structure) = ty else { return None };
    let (sfb, number) = structure.instance_of?;
    let kind = if sfb { BlockKind::Sfb } else { BlockKind::Fb };
    Some(BlockKey { kind, number })
}

/// Whether a place is in what the caller passes.
pub const fn is_passed(place: &Place) -> bool {
    matches!(place, Place::Parameter { .. } | Place::ThroughPointer { .. })
}

/// The instance at a place: in the instance of this block, or in a data block.
pub fn named_instance(place: &Place) -> Option<Instance> {
    match place {
        Place::Instance { byte, .. } => Some(Instance::Multi { byte: *byte }),
        Place::Db { number, byte, .. } => Some(Instance::Inner { db: *number, byte: *byte }),
        _ => None,
    }
}
