//! Names as texts: GetBlockName, GetInstanceName, GetInstancePath.
//!
//! The name of a block is a constant. That of an instance depends on the one that the block is called with: INSTANCE_TEXT of the library
//! finds it by its address. NAME_OF_SIZE shortens a name. Source: S7-1500 information system, GetBlockName, GetInstanceName, GetInstancePath.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Span};
use plcc_syntax::Elementary;

use super::expression::constant_expr;
use super::pins::Pins;
use super::value::Value;
use crate::bind::globals::names::kind_prefix;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_model::layout::{self, type_code};
use plcc_model::scl::{Access, Actual, Argument, Base, Call};
use plcc_model::types::DataType;
use plcc_model::{BlockKey, Place};

/// Whose name is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Naming {
    /// Of the block itself.
    Block,
    /// Of its instance: the data block, or the component of the instance around it.
    Instance,
    /// Of its instance with all that is around it.
    Path,
}

impl SclBinder<'_, '_> {
    pub fn naming_function(&mut self, ctx: &mut SclBlock, naming: Naming, pins: &Pins, span: Span) -> Option<Value> {
        let size = self.value(ctx, pins.get("SIZE")?)?;
        match naming {
            Naming::Block => {
                let key = ctx.block.key;
                let name = self.program.globals.names.block_name(kind_prefix(key.kind), key.number);
                let name = if name.is_empty() { key.to_string() } else { name };
                let name = Value::Constant(Constant::WideText(name.encode_utf16().collect()), span);
                let part = self.naming_part(ctx, "NAME_OF_SIZE", pins)?;
                self.library_call(ctx, part, vec![name, size], pins.name, span)
            }
            Naming::Instance | Naming::Path => self.instance_name(ctx, naming, size, pins, span),
        }
    }

    fn instance_name(
        &mut self,
        ctx: &mut SclBlock,
        naming: Naming,
        size: Value,
        pins: &Pins,
        span: Span,
    ) -> Option<Value> {
        let Some(instance) = ctx.block.bound.instance.as_ref().filter(|_| ctx.block.key.kind == BlockKind::Fb) else {
            self.refuse(
                Code::OperandKind,
                pins.name,
                "this block has no instance",
                "only a function block has one",
                "ask in the function block, or for the name of this block with `GetBlockName`",
            );
            return None;
        };
        let kind = layout::type_number(&DataType::Struct(instance.ty.clone()));
        let part = self.naming_part(ctx, "INSTANCE_TEXT", pins)?;
        let size = self.convert(ctx, size, Elementary::Dint)?;
        let own = Access {
            base: Base::Place(Place::Instance { byte: 0, bit: 0 }),
            indices: Vec::new(),
            ty: DataType::Elementary(Elementary::Byte),
            part: None,
            span,
        };
        let path = u64::from(naming == Naming::Path);
        // In the order of its declaration.
        let actuals = [
            Actual::PointerTo { access: own, type_code: type_code(Elementary::Byte), count: 1 },
            Actual::Value(constant_expr(kind.into(), Elementary::Dword, span)),
            Actual::Value(constant_expr(path, Elementary::Bool, span)),
            Actual::Value(size),
        ];
        let argument = |(parameter, actual)| Argument { parameter, actual, span };
        let arguments = actuals.into_iter().enumerate().map(argument).collect();
        let call = Call { target: part, instance: None, arguments, enable: None, eno: None, is_operation: false, span };
        self.call_value(call, false, pins.name)
    }

    fn naming_part(&mut self, ctx: &SclBlock, name: &str, pins: &Pins) -> Option<BlockKey> {
        let found = self.library_function(ctx.scope.rules, name);
        if found.is_none() {
            let text = self.program.globals.text(pins.name);
            self.program.globals.report.missing_function(&text, pins.name, None, true);
        }
        found
    }
}
