//! Start values of elements: of lists, and in arrays of structures.

use std::slice;

use plcc_syntax::ast::{Bound, InitialKind, InitialValue, TypeKind, TypeRef};

use crate::node::Node;

/// No array has more start values than this.
const VALUES_MAX: i64 = 100_000;

/// A start value with the indices of its element.
type Placed<'v> = (Vec<i64>, &'v InitialValue);

/// The values of a list for an array with the indices of their elements, and the type of these; `None`: bounds or repetitions are not known,
/// or there are too many.
///
/// The elements of arrays in an array are counted through; each list in the list begins at the first element of one of these.
pub fn of_list<'v, 't>(value: &'v InitialValue, ty: &'t TypeRef) -> Option<(Vec<Placed<'v>>, &'t TypeRef)> {
    let TypeKind::Array { element, .. } = &ty.kind else { return None };
    let values = match &value.kind {
        InitialKind::List(values) => values.as_slice(),
        _ => slice::from_ref(value),
    };
    let mut numbered = Vec::new();
    run(values, element, 0, &mut 0, &mut numbered)?;
    let (mut limits, mut innermost) = (Vec::new(), ty);
    while let TypeKind::Array { bounds, element } = &innermost.kind {
        for bounds in bounds {
            limits.push(limit(bounds)?);
        }
        innermost = element;
    }
    let found = numbered.into_iter().map(|(number, value)| {
        let mut rest = number;
        // The last index counts first.
        let path = limits.iter().rev().map(|(low, size)| {
            let index = low + rest % size;
            rest /= size;
            index
        });
        let mut path: Vec<i64> = path.collect();
        path.reverse();
        (rest == 0).then_some((path, value))
    });
    Some((found.collect::<Option<Vec<_>>>()?, innermost))
}

/// Numbers values for elements of type `element`, the next of which has the number `start + next`.
fn run<'v>(
    values: &'v [InitialValue],
    element: &TypeRef,
    start: i64,
    next: &mut i64,
    found: &mut Vec<(i64, &'v InitialValue)>,
) -> Option<()> {
    let size = size_of(element)?;
    for value in values {
        if start.saturating_add(*next) >= VALUES_MAX {
            return None;
        }
        match (&value.kind, &element.kind) {
            (InitialKind::List(list), TypeKind::Array { element, .. }) => {
                let at = next.checked_add(size - 1)? / size * size;
                run(list, element, start.checked_add(at)?, &mut 0, found)?;
                *next = at.checked_add(size)?;
            }
            (InitialKind::List(list), _) => run(list, element, start, next, found)?,
            (InitialKind::Repeat { count: Bound::Number(count, _), values }, _) => {
                for _ in 0..*count {
                    let before = *next;
                    run(values, element, start, next, found)?;
                    if *next == before {
                        break;
                    }
                }
            }
            (InitialKind::Repeat { .. }, _) => return None,
            _ => {
                found.push((start + *next, value));
                *next += 1;
            }
        }
    }
    Some(())
}

/// How many elements of the innermost arrays a type has: 1 if it is not an array.
fn size_of(ty: &TypeRef) -> Option<i64> {
    let TypeKind::Array { bounds, element } = &ty.kind else { return Some(1) };
    let mut size = size_of(element)?;
    for bounds in bounds {
        size = size.checked_mul(limit(bounds)?.1)?;
    }
    Some(size)
}

/// The first index of a dimension and how many it has.
fn limit((low, high): &(Bound, Bound)) -> Option<(i64, i64)> {
    let (Bound::Number(low, _), Bound::Number(high, _)) = (low, high) else { return None };
    let size = high.checked_sub(*low)?.checked_add(1)?;
    (size >= 1).then_some((*low, size))
}

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
        let (low, size) = limit(bounds)?;
        if size.checked_mul(i64::try_from(found.len()).ok()?)? > VALUES_MAX {
            return None;
        }
        let with = |path: &Vec<i64>, index: i64| path.iter().copied().chain([index]).collect::<Vec<i64>>();
        found = found.iter().flat_map(|path| (low..low + size).map(move |index| with(path, index))).collect();
    }
    let inner = places(element)?;
    if found.len().saturating_mul(inner.len()) > VALUES_MAX as usize {
        return None;
    }
    let joined = found.iter().flat_map(|path| inner.iter().map(move |rest| [&path[..], &rest[..]].concat()));
    Some(joined.collect())
}
