//! Which operands may have bits in common.

use plcc_syntax::ast::{Area, BlockName, Bound, Operand, OperandKind, PathPart, PathRoot};

/// Whether two operands are written as the same one.
pub fn is_same(one: &Operand, other: &Operand) -> bool {
    match (&one.kind, &other.kind) {
        (OperandKind::Path(one), OperandKind::Path(other)) => {
            let parts = one.parts.iter().zip(&other.parts);
            same_root(&one.root, &other.root)
                && std::mem::discriminant(&one.root) == std::mem::discriminant(&other.root)
                && one.parts.len() == other.parts.len()
                && parts.into_iter().all(|pair| match pair {
                    (PathPart::Member { name, .. }, PathPart::Member { name: other, .. }) => {
                        name.eq_ignore_ascii_case(other)
                    }
                    (PathPart::Index { values, .. }, PathPart::Index { values: others, .. }) => {
                        values.len() == others.len()
                            && values.iter().zip(others).all(|pair| match pair {
                                (Bound::Number(one, _), Bound::Number(other, _)) => one == other,
                                _ => false,
                            })
                    }
                    _ => false,
                })
        }
        (
            OperandKind::Block(BlockName::Symbol { name, .. }),
            OperandKind::Block(BlockName::Symbol { name: other, .. }),
        ) => name.eq_ignore_ascii_case(other),
        (one, other) => one == other,
    }
}

/// Whether reading one operand may read what another one names; addresses and names are not compared with each other.
pub fn may_be_same(read: &Operand, written: &Operand) -> bool {
    use OperandKind as K;
    match (&read.kind, &written.kind) {
        (K::Literal(_) | K::Status(_), _) => false,
        (K::Cell { .. }, K::Cell { .. }) => is_same(read, written),
        (K::Absolute { area, width, byte, .. }, K::Absolute { area: other, byte: at, .. }) => {
            // A bit is only itself; a byte, word or double word has all its bits.
            let bytes = width.bits().div_ceil(8);
            match width.bits() {
                1 => read.kind == written.kind,
                _ => area == other && (*byte..byte.saturating_add(bytes)).contains(at),
            }
        }
        (K::Cell { .. }, K::Absolute { .. }) | (K::Absolute { .. }, K::Cell { .. }) => false,
        (K::Path(one), K::Path(other)) => match (&one.root, &other.root) {
            (PathRoot::Local { .. }, PathRoot::Local { .. }) | (PathRoot::Quoted { .. }, PathRoot::Quoted { .. }) => {
                // One path may be a part of the other: `#a` and `#a.b`.
                let count = one.parts.len().min(other.parts.len());
                same_root(&one.root, &other.root) && same_parts(&one.parts[..count], &other.parts[..count])
            }
            _ => true,
        },
        _ => true,
    }
}

/// Whether two operands of a call may have bits in common. A local variable shares bits with no other operand.
pub fn overlaps(one: &Operand, other: &Operand) -> bool {
    use OperandKind as K;
    let is_local = |operand: &Operand| {
        matches!(&operand.kind, K::Path(path) if matches!(path.root, PathRoot::Local { .. }))
            || matches!(operand.kind, K::Absolute { area: Area::L, .. })
    };
    match (&one.kind, &other.kind) {
        (K::Literal(_), _) | (_, K::Literal(_)) => false,
        _ if is_local(one) != is_local(other) => false,
        (K::Absolute { area, width, byte, bit }, K::Absolute { area: other, width: wide, byte: at, bit: place }) => {
            let ends = |byte: u32, bits: u32| byte.saturating_add(bits.div_ceil(8));
            let is_apart = width.bits() == 1 && wide.bits() == 1 && bit != place;
            area == other && *byte < ends(*at, wide.bits()) && *at < ends(*byte, width.bits()) && !is_apart
        }
        _ => may_be_same(one, other) || may_be_same(other, one),
    }
}

fn same_root(one: &PathRoot, other: &PathRoot) -> bool {
    match (one, other) {
        (PathRoot::Local { name, .. }, PathRoot::Local { name: other, .. })
        | (PathRoot::Quoted { name, .. }, PathRoot::Quoted { name: other, .. }) => name.eq_ignore_ascii_case(other),
        _ => true,
    }
}

/// Indices may be equal whatever they are written as.
fn same_parts(one: &[PathPart], other: &[PathPart]) -> bool {
    one.iter().zip(other).all(|pair| match pair {
        (PathPart::Member { name, .. }, PathPart::Member { name: other, .. }) => name.eq_ignore_ascii_case(other),
        _ => true,
    })
}
