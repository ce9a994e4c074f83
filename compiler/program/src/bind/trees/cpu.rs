//! The CPU that sources imply if nothing names one, and whether a CPU runs them at all.
//!
//! Some contents of exports only exist in some families; decision 30 says what a source of the TIA Portal without a CPU follows.

use plcc_abi::image::{Family, Profile};
use plcc_diag::FileId;
use plcc_model::profile;
use plcc_syntax::ast::{self, SourceUnit, StatementKind};
use plcc_syntax::network::ast::{Content, Target};
use plcc_syntax::network::elements::Kind;
use plcc_syntax::scl::ast::ExprKind;
use plcc_syntax::stl::StlInsn;

use crate::bind::trees::numbering::has_free_obs;
use crate::bind::trees::{blocks, mentions};

/// Names of the CPU's objects of an S7-1200.
const OF_S7_1200: [&str; 2] = ["local~hsc_", "local~pulse_"];

/// Whether the program is for an S7-200, whose sources cannot be mixed with others.
pub fn is_s7200(units: &[(FileId, SourceUnit)]) -> bool {
    units.iter().any(|(_, unit)| unit.s7200.is_some())
}

/// Whether the CPU runs programs in these languages: an S7-1200 has no STL and no GRAPH, an S7-200 has its own language.
pub fn runs(profile: &Profile, units: &[(FileId, SourceUnit)]) -> bool {
    match profile.family {
        Family::S7200 => is_s7200(units),
        _ if is_s7200(units) => false,
        Family::S7300 | Family::S7400 | Family::S71500 => true,
        Family::S71200 => language_beyond_s7_1200(units).is_none(),
    }
}

/// A language of the sources that an S7-1200 does not have. Sequences of PLCopen XML may be for any editor.
pub fn language_beyond_s7_1200(units: &[(FileId, SourceUnit)]) -> Option<&'static str> {
    let mut blocks = units.iter().flat_map(|(_, unit)| unit.blocks.iter().map(move |block| (unit, block)));
    blocks.find_map(|(unit, block)| match block {
        ast::Block::Code(code) => match &code.code {
            ast::Code::Stl(_) => Some("STL"),
            ast::Code::Chart(_) if unit.overlay.is_none() => Some("GRAPH"),
            ast::Code::Chart(_) | ast::Code::Scl(_) | ast::Code::Graphic(_) => None,
        },
        ast::Block::Data(_) | ast::Block::Type(_) => None,
    })
}

/// The CPU of sources that name none: the generic S7-200 for those of Micro/WIN; else the generic S7-300, or the S7-400 if an instruction
/// needs its accumulators. Exceeding its limits is a warning, because the CPU of the plant may have more, unless networks need its registers:
/// these follow the rules of an S7-300/400 only if it counts as named.
pub fn implied_profile(units: &[(FileId, SourceUnit)]) -> Profile {
    if is_s7200(units) {
        return profile::generic(Family::S7200);
    }
    if let Some(family) = implied_family(units) {
        return Profile { limits_checked: false, ..profile::generic(family) };
    }
    if has_free_obs(units) {
        return Profile { limits_checked: false, ..profile::generic(Family::S71500) };
    }
    let statements = units
        .iter()
        .flat_map(|(_, unit)| &unit.blocks)
        .filter_map(|block| match block {
            ast::Block::Code(code) => Some(code.networks()),
            ast::Block::Data(_) | ast::Block::Type(_) => None,
        })
        .flatten()
        .flat_map(|network| &network.statements);
    let mut instructions = statements.filter_map(|statement| match &statement.kind {
        StatementKind::Instruction { insn, .. } => Some(*insn),
        StatementKind::Empty | StatementKind::Call(_) | StatementKind::Pragma(_) | StatementKind::Error => None,
    });
    let four = instructions.any(|insn| matches!(insn, StlInsn::Enter | StlInsn::Leave));
    let family = if four { Family::S7400 } else { Family::S7300 };
    Profile { limits_checked: has_registers(units), ..profile::generic(family) }
}

/// The element uses registers that only an S7-300 or S7-400 has: BR, status word, open data blocks, MCR.
pub const fn needs_registers(kind: Kind) -> bool {
    matches!(kind, Kind::OpenDb { .. } | Kind::Mcr(_) | Kind::CallCoil | Kind::Save | Kind::Flag(_))
}

/// Whether networks have such elements.
fn has_registers(units: &[(FileId, SourceUnit)]) -> bool {
    let bodies = units.iter().flat_map(|(_, unit)| &unit.blocks).filter_map(|block| match block {
        ast::Block::Code(ast::CodeBlock { code: ast::Code::Graphic(body), .. }) => Some(body),
        ast::Block::Code(_) | ast::Block::Data(_) | ast::Block::Type(_) => None,
    });
    let mut graphs = bodies.flat_map(|body| &body.networks).filter_map(|network| match &network.content {
        Content::Graphic(graph) => Some(graph),
        Content::Scl(_) | Content::Stl(_) => None,
    });
    graphs.any(|graph| {
        let mut targets = graph.elements.iter().map(|element| &element.target);
        targets.any(|target| matches!(target, Target::Element { row, .. } if needs_registers(row.kind)))
    })
}

/// The family; `None`: the sources run on any family.
fn implied_family(units: &[(FileId, SourceUnit)]) -> Option<Family> {
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
