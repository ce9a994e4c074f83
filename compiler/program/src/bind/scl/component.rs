//! What follows a point: components of structures and data blocks, and slices.
//!
//! Source: SCL reference, addressing.

use std::rc::Rc;

use plcc_binding::constant::Constant;
use plcc_binding::fold;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::Part;
use plcc_model::types::{DTL, DataType};
use plcc_model::{BlockKey, Direction, Number, Parameter, layout};
use plcc_syntax::ast::{BlockPrefix, Width};
use plcc_syntax::scl::ast::{Name, NameForm};
use plcc_syntax::scl::{db_address, db_area_word};

use super::place::{Db, Spot, Thing};
use crate::bind::declarations::path::{self, Variable};
use crate::bind::declarations::unknown_member::no_component;
use crate::bind::globals::names::code_kind;
use crate::bind::scl::{SclBinder, SclBlock};

impl SclBinder<'_, '_> {
    pub(super) fn member_thing(&mut self, ctx: &mut SclBlock, base: Thing, name: &Name, span: Span) -> Option<Thing> {
        match base {
            Thing::Spot(spot) => self.component(spot, name, span).map(Thing::Spot),
            Thing::Db { db, .. } => {
                if let Db::Known(number) = db
                    && let Some(ty) = self.program.data.db_type(number)
                    && let Some(member) = self.program.types.member(&ty, &name.text)
                {
                    let base = path::Base::Db(number);
                    let (byte, bit, ty) = (member.byte, member.bit, member.ty);
                    if ty == DataType::Void {
                        return None;
                    }
                    return Some(Thing::Spot(Spot::fixed(Variable { base, byte, bit, ty, untyped: false })));
                }
                let word = name.text.strip_prefix('%').unwrap_or(&name.text);
                if name.form == NameForm::Bare {
                    if let Some((width, byte)) = db_address(word) {
                        return self.db_place(ctx, db, width, byte, 0, span);
                    }
                    if let Some(width) = db_area_word(word) {
                        return Some(Thing::DbArea(db, width));
                    }
                }
                match db {
                    Db::Known(number) => {
                        let variable = self.whole_db(number, span)?;
                        self.component(Spot::fixed(variable), name, span).map(Thing::Spot)
                    }
                    Db::Dynamic(_) => {
                        let help = "name an address in it: `.DW[i]`, `.DW4`, `.DX[b, i]`";
                        let label = "this data block is only known at run time";
                        self.refuse(Code::UnknownMember, span, "the components of this block are unknown", label, help);
                        None
                    }
                }
            }
            Thing::Block { prefix: BlockPrefix::Udt, .. } => {
                let base = Span::new(span.file, span.start as usize..name.span.start as usize);
                let text = self.program.globals.text(base);
                self.program.globals.report.missing_beside_type(text.trim_end().trim_end_matches('.'), span);
                None
            }
            Thing::Block { prefix: prefix @ (BlockPrefix::Fb | BlockPrefix::Sfb), number: Number::Known(number) } => {
                let text = self.before_point(name, span);
                let base = Span { end: span.start + text.len() as u32, ..span };
                let key = BlockKey { kind: code_kind(prefix)?, number };
                let help = match self.first_instance(key) {
                    Some(instance) => format!("write `{instance}.{}`", name.text),
                    None => format!("name an instance of it before `.{}`", name.text),
                };
                let title = format!("`{text}` is a function block, and has no data");
                self.refuse(Code::UnknownMember, base, &title, "its data are in its instances", &help);
                None
            }
            Thing::Block { prefix: prefix @ (BlockPrefix::Fc | BlockPrefix::Sfc), number: Number::Known(number) } => {
                let text = self.before_point(name, span);
                let base = Span { end: span.start + text.len() as u32, ..span };
                // A name in quotes is one of the program, also where the library has a function of that name.
                let bare = text.trim_matches('"');
                if text.starts_with('"') && !self.program.globals.names.symbols.contains_key(&fold(bare)) {
                    self.program.globals.unknown_name(bare, base, std::iter::empty());
                    return None;
                }
                let bound = self.program.interface(BlockKey { kind: code_kind(prefix)?, number }, base)?;
                let is_meant = |parameter: &&Parameter| fold(&parameter.name) == fold(&name.text);
                let parameter = bound.interface.parameters.iter().find(is_meant);
                let help = match parameter.map(|parameter| parameter.direction) {
                    Some(Direction::Output) => format!("take it where it is called: `{text}({} => …)`", name.text),
                    Some(Direction::Input | Direction::InOut) => {
                        format!("give it where it is called: `{text}({} := …)`", name.text)
                    }
                    None => "what is to be kept is in a data block, or in an instance of a function block".to_owned(),
                };
                let title = format!("`{text}` is a function, and keeps no data");
                self.refuse(Code::UnknownMember, base, &title, "its parameters exist in its calls only", &help);
                None
            }
            Thing::Constant(Constant::Dtl(bytes)) => self.dtl_component(bytes, name),
            Thing::Constant(_)
            | Thing::Cell { .. }
            | Thing::Block { .. }
            | Thing::Flag
            | Thing::LastEno
            | Thing::Area(..)
            | Thing::DbArea(..) => {
                self.program.report(
                    Diagnostic::new(Code::UnknownMember, name.span, "only data blocks and structures have components")
                        .label("this comes before the point and is something else"),
                );
                None
            }
        }
    }

    /// `#start.YEAR` of a constant, which is not in memory.
    fn dtl_component(&mut self, bytes: [u8; 12], name: &Name) -> Option<Thing> {
        let DataType::Struct(structure) = self.program.predefined(DTL, name.span)?.ty else { return None };
        let Some(member) = self.program.types.member(&structure, &name.text) else {
            self.program.unknown_member(&structure, &name.text, name.span);
            return None;
        };
        let DataType::Elementary(ty) = member.ty else { return None };
        let own = bytes.iter().skip(member.byte as usize).take(ty.bits() as usize / 8);
        let bits = own.fold(0, |bits, byte| (bits << 8) | u64::from(*byte));
        Some(Thing::Constant(Constant::Typed { ty, bits }))
    }

    /// A data block as one structure.
    pub(super) fn whole_db(&mut self, number: u16, span: Span) -> Option<Variable> {
        let Some(ty) = self.program.data.db_type(number) else {
            if !self.program.globals.sources.data.contains_key(&number)
                && !self.program.data.unknown_instances.contains(&number)
            {
                self.program.globals.report.missing_db_layout(number, span);
            }
            return None;
        };
        Some(Variable { base: path::Base::Db(number), byte: 0, bit: 0, ty: DataType::Struct(ty), untyped: false })
    }

    fn component(&mut self, mut spot: Spot, name: &Name, span: Span) -> Option<Spot> {
        let DataType::Struct(structure) = &spot.ty else {
            let before = self.before_point(name, span);
            self.program.report(no_component(&name.text, &spot.ty, &before, name.span));
            return None;
        };
        let structure = Rc::clone(structure);
        let Some(member) = self.program.types.member(&structure, &name.text) else {
            self.program.unknown_member(&structure, &name.text, name.span);
            return None;
        };
        spot.byte += member.byte;
        spot.bit = member.bit;
        spot.ty = member.ty;
        (spot.ty != DataType::Void).then_some(spot)
    }

    /// What is written before the point and `name` in the access at `span`.
    fn before_point(&self, name: &Name, span: Span) -> String {
        let before = Span { end: name.span.start.max(span.start), ..span };
        self.program.globals.text(before).trim_end().trim_end_matches('.').trim_end().to_owned()
    }

    pub(super) fn slice(&mut self, base: Thing, width: Width, index: u32, span: Span) -> Option<Thing> {
        let Thing::Spot(mut spot) = base else {
            let help = "only variables have slices: `word.%X3`";
            self.refuse(Code::OperandKind, span, "this has no slices", "there is no variable before the point", help);
            return None;
        };
        let whole = match (&spot.part, &spot.ty) {
            (Some(part), _) => Some(part.width.bits()),
            (None, DataType::Elementary(ty)) if super::numeric::bit_string(super::Rules::Tia1500, *ty).is_some() => {
                Some(ty.bits()).filter(|bits| *bits > 1)
            }
            _ => None,
        };
        let Some(whole) = whole else {
            let is = layout::type_name(&spot.ty);
            let help = "slices are parts of bit strings and integers";
            self.refuse(Code::OperandKind, span, &format!("a variable of type {is} has no slices"), &is, help);
            return None;
        };
        let count = whole / width.bits();
        if index >= count {
            let label = match count {
                0 => format!("the variable has {whole} bits"),
                1 => "only 0 is possible".to_owned(),
                _ => format!("0 to {} are possible", count - 1),
            };
            let help = self.possible_slices(span, width, count);
            self.refuse(Code::ArrayIndex, span, "this slice is outside the variable", &label, &help);
            return None;
        }
        let before = spot.part.map_or(0, |part| u32::from(part.index) * part.width.bits());
        let index = before / width.bits() + index;
        spot.part = Some(Part { width, index: index as u8 });
        Some(Thing::Spot(spot))
    }

    /// Which slices of a width the variable of the slice at `span` has.
    fn possible_slices(&self, span: Span, width: Width, count: u32) -> String {
        let letter = match width {
            Width::Bit => 'X',
            Width::Byte => 'B',
            Width::Word => 'W',
            Width::Dword | Width::Lword => 'D',
        };
        let text = self.program.globals.text(span);
        let (variable, part) = text.rsplit_once('.').unwrap_or((&text, ""));
        match count {
            0 => format!("remove `.{part}`"),
            1 => format!("write `{variable}.%{letter}0`"),
            _ => format!("write one from `{variable}.%{letter}0` to `{variable}.%{letter}{}`", count - 1),
        }
    }
}
