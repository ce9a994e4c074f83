//! Start values of elements, in arrays of structures.

use plcc_syntax::ast::{Bound, TypeKind, TypeRef};

use super::interface::VALUES_MAX;
use crate::node::Node;

/// Gives each element of an array of structures, which is of type `ty`, the values that its declaration has for elements of arrays in the
/// structure: their indices begin with those of the arrays around. `false`: the bounds are not known, or there are too many.
pub fn spread(node: &mut Node, ty: &TypeRef) -> bool {
    let count = subelements(node);
    if count == 0 {
        return true;
    }
    let found = places(ty).filter(|places| places.len().saturating_mul(count) <= VALUES_MAX as usize);
    let is_known = found.is_some();
    if let Some(places) = found {
        repeat(node, &places);
    }
    is_known
}

/// How many values of single elements are in a node.
fn subelements(node: &Node) -> usize {
    usize::from(node.name == "Subelement") + node.children.iter().map(subelements).sum::<usize>()
}

fn repeat(node: &mut Node, places: &[Vec<i64>]) {
    let mut children = Vec::with_capacity(node.children.len());
    for mut child in std::mem::take(&mut node.children) {
        if child.name != "Subelement" {
            repeat(&mut child, places);
            children.push(child);
            continue;
        }
        for place in places {
            let mut one = child.clone();
            let before: String = place.iter().map(|index| format!("{index},")).collect();
            for (_, path) in one.attributes.iter_mut().filter(|(key, _)| *key == "Path") {
                path.insert_str(0, &before);
            }
            children.push(one);
        }
    }
    node.children = children;
}

/// The indices of all elements of an array, also of one of arrays; `None`: its bounds are not known, or it has too many.
fn places(ty: &TypeRef) -> Option<Vec<Vec<i64>>> {
    let TypeKind::Array { bounds, element } = &ty.kind else {
        return (!matches!(ty.kind, TypeKind::OpenArray { .. })).then(|| vec![Vec::new()]);
    };
    let mut found: Vec<Vec<i64>> = vec![Vec::new()];
    for bounds in bounds {
        let (Bound::Number(low, _), Bound::Number(high, _)) = bounds else { return None };
        let size = high.checked_sub(*low)?.checked_add(1)?;
        if size < 1 || size.checked_mul(i64::try_from(found.len()).ok()?)? > VALUES_MAX {
            return None;
        }
        let with = |path: &Vec<i64>, index: i64| path.iter().copied().chain([index]).collect::<Vec<i64>>();
        found = found.iter().flat_map(|path| (*low..=*high).map(move |index| with(path, index))).collect();
    }
    let inner = places(element)?;
    if found.len().saturating_mul(inner.len()) > VALUES_MAX as usize {
        return None;
    }
    let joined = found.iter().flat_map(|path| inner.iter().map(move |rest| [&path[..], &rest[..]].concat()));
    Some(joined.collect())
}
