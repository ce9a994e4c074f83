//! Tags that share memory although neither is a part of the other, or is one of another kind.

use plcc_diag::{Code, Diagnostic};
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
