//! The family that is implied by exports that name no CPU: some of their contents only exist in some families.
//!
//! Decision 30 says what a source of the TIA Portal without a CPU follows.

use plcc_abi::image::Family;
use plcc_diag::FileId;
use plcc_syntax::ast::{self, SourceUnit};
use plcc_syntax::scl::ast::ExprKind;

use crate::bind::trees::blocks;
use crate::bind::trees::mentions;

/// Names of the CPU's objects of an S7-1200.
const OF_S7_1200: [&str; 2] = ["local~hsc_", "local~pulse_"];

/// The family; `None`: the sources run on any family.
pub fn implied_family(units: &[(FileId, SourceUnit)]) -> Option<Family> {
    let blocks = || units.iter().flat_map(|(_, unit)| &unit.blocks);
    let mut of_s7_1200 = false;
    for block in blocks() {
        let ast::Block::Code(code) = block else { continue };
        mentions::expressions(&code.code, &mut |value| {
            if let ExprKind::Name(name) = &value.kind {
                let text = name.text.to_ascii_lowercase();
                of_s7_1200 |= OF_S7_1200.iter().any(|prefix| text.starts_with(prefix));
            }
        });
    }
    let has_stl = blocks().any(|block| match block {
        ast::Block::Code(code) => {
            matches!(code.code, ast::Code::Stl(_)) || mentions::stl_statements(&code.code).next().is_some()
        }
        ast::Block::Data(_) | ast::Block::Type(_) => false,
    });
    if of_s7_1200 && !has_stl {
        return Some(Family::S71200);
    }
    // Only files read with an overlay are exports: they state for each block whether its access is optimised.
    let exported = units.iter().filter(|(_, unit)| unit.overlay.is_some()).flat_map(|(_, unit)| &unit.blocks);
    let optimized = exported.map(|block| match block {
        ast::Block::Code(code) => &code.header,
        ast::Block::Data(data) => &data.header,
        ast::Block::Type(ty) => &ty.header,
    });
    let mut optimized = optimized.filter(|header| blocks::is_optimized(header));
    optimized.next().map(|_| Family::S71500)
}
