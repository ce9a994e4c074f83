//! Instance DBs that calls name but no source defines.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::{BlockKey, DataBlock};
use plcc_syntax::ast::{self, BlockName, BlockPrefix, OperandKind, PathRoot};
use plcc_syntax::symbols::SymbolTarget;
use rustc_hash::{FxHashMap, FxHashSet};

use super::{BoundDb, at_least_a_word};
use crate::bind::declarations::Declarations;
use crate::bind::trees::mentions::{self, Called};

/// A call that names a function block and an instance DB.
struct InstanceCall {
    target: Option<(BlockPrefix, u16)>,
    target_span: Span,
    instance: u16,
    span: Span,
}

impl Declarations<'_> {
    /// STEP 7 creates the instance DB if a call names one that does not exist.
    pub(super) fn generate_instances(&mut self) {
        let calls = self.instance_calls();
        let unnamed = self.unnamed_instances(&calls);
        for call in calls {
            let InstanceCall { target, target_span, instance, span } = call;
            if instance == 0
                || self.globals.sources.data.contains_key(&instance)
                || self.data.blocks.contains_key(&instance)
            {
                continue;
            }
            let (kind, fb) = match target {
                Some((BlockPrefix::Fb, fb)) => (BlockKind::Fb, fb),
                Some((BlockPrefix::Sfb, fb)) => (BlockKind::Sfb, fb),
                Some(_) => continue,
                None => {
                    self.data.unknown_instances.insert(instance);
                    continue;
                }
            };
            let key = BlockKey { kind, number: fb };
            let known = self.globals.sources.code.contains_key(&key) || self.globals.in_library(key);
            let Some(typed) =
                known.then(|| self.interface(key, target_span)).flatten().and_then(|bound| bound.instance.clone())
            else {
                self.data.unknown_instances.insert(instance);
                continue;
            };
            if !self.fits_with_others(typed.ty.bytes, span) {
                return;
            }
            if let Some((_, defined)) = unnamed.get(&key) {
                let (block, other) = (self.globals.shown(key), self.globals.text(*defined));
                self.report(
                    Diagnostic::new(Code::DbMissing, span, format!("DB {instance} is not defined"))
                        .label(format!("created for this call, with the start values of {block}"))
                        .also(*defined, "no call names this instance of the same block")
                        .help(format!("write `{other}` if that is meant, or define DB {instance} as an instance, too")),
                );
            }
            let kept = self.kept(&ast::Header::default(), &[], Some(key), &typed.ty);
            let block = DataBlock {
                data_type: String::new(),
                number: instance,
                name: self.globals.names.block_name(BlockPrefix::Db, instance),
                span,
                data: at_least_a_word(typed.image.to_vec()),
                members: typed.ty.members.clone(),
                instance_of: Some(key),
                read_only: false,
                unlinked: false,
                optimized: false,
                kept,
            };
            self.data.blocks.insert(instance, BoundDb { block, ty: typed.ty });
        }
    }

    /// The first instance of each block that a source defines, and that no call names: none of `calls`, and none of another form.
    fn unnamed_instances(&self, calls: &[InstanceCall]) -> FxHashMap<BlockKey, (u16, Span)> {
        let mut named: FxHashSet<u16> = calls.iter().map(|call| call.instance).collect();
        for block in self.globals.input.units.iter().flat_map(|(_, unit)| &unit.blocks) {
            let ast::Block::Code(code) = block else { continue };
            let of_calls = mentions::data_of_calls(&code.code);
            named.extend(of_calls.into_iter().filter_map(|data| match data {
                Called::Number(BlockPrefix::Db | BlockPrefix::Di, number) => u16::try_from(number).ok(),
                Called::Number(..) => None,
                Called::Name(name) => match self.type_block(&name) {
                    Some((BlockPrefix::Db, number)) => Some(number),
                    Some(_) | None => None,
                },
            }));
        }
        let mut unnamed: FxHashMap<BlockKey, (u16, Span)> = FxHashMap::default();
        for (number, db) in &self.data.blocks {
            let Some(key) = db.block.instance_of.filter(|_| !named.contains(number)) else { continue };
            let first = unnamed.entry(key).or_insert((*number, db.block.span));
            if *number < first.0 {
                *first = (*number, db.block.span);
            }
        }
        unnamed
    }

    /// Calls that name an instance DB: `CALL FB 1, DB 1`, `FB1.DB1(...)`.
    fn instance_calls(&self) -> Vec<InstanceCall> {
        let mut calls = Vec::new();
        for block in self.globals.input.units.iter().flat_map(|(_, unit)| &unit.blocks) {
            let ast::Block::Code(code) = block else { continue };
            let networks = code.networks().iter().flat_map(|network| &network.statements);
            for statement in networks.chain(mentions::stl_statements(&code.code)) {
                if let ast::StatementKind::Call(call) = &statement.kind
                    && let Some(instance) = &call.instance
                    && let Some((BlockPrefix::Db, number)) = self.named_number(instance)
                {
                    calls.push(InstanceCall {
                        target: self.named_number(&call.target),
                        target_span: call.target.span,
                        instance: number,
                        span: instance.span,
                    });
                }
            }
            for (target, instance) in mentions::instance_calls(&code.code) {
                let block = self.type_block(&target.text);
                if let Some((BlockPrefix::Fb | BlockPrefix::Sfb, _)) = block
                    && let Some((BlockPrefix::Db, number)) = self.type_block(&instance.text)
                {
                    calls.push(InstanceCall {
                        target: block,
                        target_span: target.span,
                        instance: number,
                        span: instance.span,
                    });
                }
            }
        }
        calls
    }

    /// The block that an operand names; no message if it names none.
    pub fn named_number(&self, operand: &ast::Operand) -> Option<(BlockPrefix, u16)> {
        let symbol = |name: &str| match self.globals.global(name) {
            Some(SymbolTarget::Block { prefix, number }) => Some((prefix, u16::try_from(number).ok()?)),
            Some(SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. }) | None => None,
        };
        match &operand.kind {
            OperandKind::Block(BlockName::Numbered { prefix, number, .. }) => {
                Some((*prefix, u16::try_from(*number).ok()?))
            }
            OperandKind::Block(BlockName::Symbol { name, .. }) => symbol(name),
            OperandKind::Path(path) if path.parts.is_empty() => match &path.root {
                PathRoot::Quoted { name, .. } | PathRoot::Bare { name, .. } | PathRoot::Local { name, .. } => {
                    symbol(name)
                }
                PathRoot::Block(_) => None,
            },
            _ => None,
        }
    }
}
