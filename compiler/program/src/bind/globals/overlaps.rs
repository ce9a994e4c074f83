//! Tags that share memory although neither is a part of the other, or is one of another kind.

use plcc_diag::{Code, Diagnostic, Severity};
use plcc_model::types::{Class, Elementary};
use plcc_syntax::ast::{Area, Width};
use plcc_syntax::symbols::SymbolTarget;

use crate::bind::globals::Globals;
use crate::bind::globals::names::Global;

/// A tag of a type in memory, in bits.
struct Tag<'g> {
    global: &'g Global,
    area: Area,
    first: u32,
    after: u32,
    ty: Elementary,
}

impl Globals<'_> {
    /// Reports tags in the process images and the bit memory whose values cannot both be right.
    pub fn check_overlaps(&mut self) {
        self.check_widths();
        let mut tags: Vec<Tag<'_>> = self.names.symbols.values().filter_map(tag).collect();
        tags.sort_by(|a, b| {
            (a.area.letters(), a.first, a.after, &a.global.name).cmp(&(
                b.area.letters(),
                b.first,
                b.after,
                &b.global.name,
            ))
        });
        let mut messages = Vec::new();
        for (index, tag) in tags.iter().enumerate() {
            let later = tags[index + 1..].iter().take_while(|other| other.area == tag.area && other.first < tag.after);
            if let Some(other) = later.into_iter().find(|other| conflicts(tag, other)) {
                let (first, second) = match (tag.global.span.file.0, tag.global.span.start)
                    <= (other.global.span.file.0, other.global.span.start)
                {
                    true => (tag, other),
                    false => (other, tag),
                };
                let title = format!("the tags `{}` and `{}` overlap", first.global.name, second.global.name);
                messages.push(
                    Diagnostic::new(Code::OverlappingTags, second.global.span, title)
                        .label(format!("{} here", second.ty.name()))
                        .also(first.global.span, format!("{} in the same memory", first.ty.name()))
                        .help("give one of them another address: to write one changes the other"),
                );
            }
        }
        messages.into_iter().for_each(|message| self.report.push(message));
    }
}

impl Globals<'_> {
    /// Reports tags whose type needs more bytes than their address has.
    fn check_widths(&mut self) {
        let mut messages: Vec<Diagnostic> = self.names.symbols.values().filter_map(too_narrow).collect();
        messages.sort_by_key(|message| (message.primary.span.file.0, message.primary.span.start));
        messages.into_iter().for_each(|message| self.report.push(message));
    }
}

/// The message about a tag such as `MW 10` of type REAL.
fn too_narrow(global: &Global) -> Option<Diagnostic> {
    let SymbolTarget::Memory { area, width: width @ (Width::Byte | Width::Word | Width::Dword), byte, .. } =
        global.target
    else {
        return None;
    };
    let ty = global.ty.filter(|ty| ty.bits() > width.bits())?;
    let letters = area.letters();
    let wide = match ty.bits() {
        16 => format!("`{letters}W {byte}`"),
        32 => format!("`{letters}D {byte}`"),
        _ => format!("the address of its first bit, `{letters} {byte}.0`"),
    };
    let title =
        format!("the tag `{}` is of type {}, but its address has {} bits", global.name, ty.name(), width.bits());
    let mut message = Diagnostic::new(Code::WidthMismatch, global.span, title)
        .label(format!("{} has {} bits", ty.name(), ty.bits()))
        .help(format!("write {wide}, or another type"));
    message.severity = Severity::Warning;
    Some(message)
}

fn tag(global: &Global) -> Option<Tag<'_>> {
    let SymbolTarget::Memory { area: area @ (Area::I | Area::Q | Area::M), width, byte, bit } = global.target else {
        return None;
    };
    let ty = global.ty?;
    let first = byte.checked_mul(8)?.checked_add(if width == Width::Bit { bit.into() } else { 0 })?;
    Some(Tag { global, area, first, after: first.checked_add(ty.bits())?, ty })
}

/// Bits, bytes and words over other values are a usual way to reach their parts, and so are integers in a longer one.
fn conflicts(a: &Tag<'_>, b: &Tag<'_>) -> bool {
    if a.first >= b.after || b.first >= a.after {
        return false;
    }
    let contains = |outer: &Tag<'_>, inner: &Tag<'_>| outer.first <= inner.first && inner.after <= outer.after;
    if !contains(a, b) && !contains(b, a) {
        return true;
    }
    let is_bits = |tag: &Tag<'_>| tag.ty.class() == Class::Bits;
    let is_float = |tag: &Tag<'_>| tag.ty.class() == Class::Float;
    !is_bits(a) && !is_bits(b) && (is_float(a) || is_float(b)) && a.ty != b.ty
}
