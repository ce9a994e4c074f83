//! `:P` after a name: the input or output itself, past the process image.
//!
//! Source: SCL reference, addressing.

use plcc_binding::fold;
use plcc_diag::{Code, Span};
use plcc_model::layout;
use plcc_model::scl::Part;
use plcc_model::types::DataType;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{Area, OperandKind, Width};
use plcc_syntax::scl::ast::Name;
use plcc_syntax::symbols::SymbolTarget;

use super::place::{Root, Spot, Thing};
use crate::bind::declarations::path;
use crate::bind::scl::{SclBinder, SclBlock};

impl SclBinder<'_, '_> {
    /// `"tag":P`: the input or output itself, past the process image.
    pub(super) fn peripheral_tag(&mut self, ctx: &mut SclBlock, tag: &str, span: Span) -> Option<Thing> {
        // What stands in for a missing input or output is in no process image.
        if let Some(variable) = self.program.stand_in(tag, span) {
            return Some(Thing::Spot(Spot::fixed(variable)));
        }
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

    /// `"tag".component:P`: the component of an input or output itself, past the process image.
    pub(super) fn past_image(&mut self, thing: Thing, span: Span) -> Option<Spot> {
        let text = self.program.globals.text(span);
        let text = text.strip_suffix(":P").or_else(|| text.strip_suffix(":p")).unwrap_or(&text).to_owned();
        let Thing::Spot(mut spot) = thing else {
            self.only_in_image(&text, span);
            return None;
        };
        let base = match spot.root {
            Root::Fixed(path::Base::I | path::Base::Pi) => path::Base::Pi,
            Root::Fixed(path::Base::Q | path::Base::Pq) => path::Base::Pq,
            // What stands in for a missing input or output is in no process image.
            Root::Fixed(path::Base::Db(number)) if self.is_stand_in(number) => return Some(spot),
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

    fn is_stand_in(&self, number: u16) -> bool {
        let globals = &self.program.globals;
        let data = globals.sources.data.get(&number);
        data.is_some_and(|data| Some(data.name.span().file) == globals.input.stand_ins)
    }

    fn only_in_image(&mut self, text: &str, span: Span) {
        let title = "only inputs and outputs can be accessed without the process image";
        let label = format!("`{text}` is neither");
        self.refuse(Code::OperandKind, span, title, &label, "write it without `:P`");
    }
}

/// The name of a component without `:P`; none: it has none, or is called so.
pub(super) fn without_peripheral(base: &Thing, name: &Name) -> Option<Name> {
    let text = name.text.strip_suffix(":P").or_else(|| name.text.strip_suffix(":p"))?;
    if let Thing::Spot(Spot { ty: DataType::Struct(structure), .. }) = base
        && structure.members.iter().any(|member| member.name.eq_ignore_ascii_case(&name.text))
    {
        return None;
    }
    Some(Name { text: text.to_owned(), ..name.clone() })
}
