//! Start values of members.
//!
//! A member has its own (`StartValue`), its elements have theirs by index (`Subelement Path="1,2"`), and the components of a data type that
//! stand below a member have those that differ from the type's.

use std::collections::{BTreeSet, HashMap};

use roxmltree::{Node, NodeId};

use super::reader::Reader;
use crate::ast::{
    Bound, InitialKind, InitialValue, Path, PathPart, PathRoot, TypeKind, TypeRef, ValueAssignment, Variable,
};
use crate::scl::ast::{Expr, Name, NameForm};
use crate::xml::{child, children};

/// How deep components with values may stand in one another.
const DEPTH_MAX: usize = 32;
/// More elements than these get no values of their own.
const ELEMENTS_MAX: i64 = 65_536;

/// The expression that a start value is.
pub fn expression(value: InitialValue) -> Option<Expr> {
    match value.kind {
        InitialKind::Expr(expr) => Some(*expr),
        _ => None,
    }
}

/// A value and the indices of the element that it belongs to, from the outermost array on.
#[derive(Clone)]
struct Leaf {
    path: Vec<i64>,
    value: InitialValue,
}

/// The values of a member and of the components below it.
type Leaves = HashMap<NodeId, Vec<Leaf>>;

/// Low and high bound of each dimension.
type Dimensions = Vec<(i64, i64)>;

/// Start value of a member of that type.
pub fn of_member(reader: &mut Reader, member: Node, ty: &TypeRef) -> Option<InitialValue> {
    // Values of a STRUCT stand at its components, which its declaration reads; those of single elements stand at the array.
    if matches!(ty.kind, TypeKind::Struct(_)) {
        return None;
    }
    let mut leaves = Leaves::new();
    collect(reader, member, &mut leaves, 0);
    if leaves.is_empty() {
        return None;
    }
    let dimensions = dimensions(ty);
    let count = dimensions.iter().flatten().map(|(low, high)| (i128::from(*high) - i128::from(*low) + 1).max(0));
    if count.product::<i128>() > i128::from(ELEMENTS_MAX) {
        let what = format!("start values of single elements of an array with more than {ELEMENTS_MAX}");
        reader.refuse(member, "a declaration", &what);
    }
    if dimensions.is_none() && leaves.values().flatten().any(|leaf| !leaf.path.is_empty()) {
        let message = "start values of elements of an array whose bounds are constants";
        reader.refuse(member, "a declaration", message);
    }
    build(reader, &leaves, member, &[], &dimensions.unwrap_or_default(), 0)
}

/// The components below a member.
fn components<'a, 'i>(member: Node<'a, 'i>) -> Vec<Node<'a, 'i>> {
    let sections = child(member, "Sections").into_iter().flat_map(|sections| children(sections, "Section"));
    sections.flat_map(|section| children(section, "Member")).chain(children(member, "Member")).collect()
}

/// Reads each value below a member once.
fn collect(reader: &mut Reader, member: Node, leaves: &mut Leaves, depth: usize) {
    let own = own_values(reader, member);
    if !own.is_empty() {
        leaves.insert(member.id(), own);
    }
    if depth < DEPTH_MAX {
        components(member).into_iter().for_each(|part| collect(reader, part, leaves, depth + 1));
    }
}

/// `StartValue` and `Subelement` of a member.
fn own_values(reader: &mut Reader, member: Node) -> Vec<Leaf> {
    let mut leaves = Vec::new();
    if let Some(value) = child(member, "StartValue").and_then(|value| reader.start_value(value)) {
        leaves.push(Leaf { path: Vec::new(), value });
    }
    for element in children(member, "Subelement") {
        let path: Option<Vec<i64>> =
            element.attribute("Path").unwrap_or_default().split(',').map(|index| index.trim().parse().ok()).collect();
        let Some(path) = path else {
            reader.refuse(element, "a declaration", "the start value of an element whose index cannot be read");
            continue;
        };
        if let Some(value) = child(element, "StartValue").and_then(|value| reader.start_value(value)) {
            leaves.push(Leaf { path, value });
        }
    }
    leaves
}

/// The bounds of a type that is an array, and of an array of arrays; `None` if one is no number. Of one dimension the high bound need
/// not be known.
fn dimensions(ty: &TypeRef) -> Option<Dimensions> {
    let mut found = Dimensions::new();
    let mut ty = ty;
    let mut unknown = false;
    while let TypeKind::Array { bounds, element } = &ty.kind {
        for (low, high) in bounds {
            match (low, high) {
                (Bound::Number(low, _), Bound::Number(high, _)) => found.push((*low, *high)),
                (Bound::Number(low, _), _) => {
                    unknown = true;
                    found.push((*low, low.saturating_add(ELEMENTS_MAX - 1)));
                }
                _ => return None,
            }
        }
        ty = element;
    }
    (!unknown || found.len() == 1).then_some(found)
}

/// The bounds in the type of a component: `Array[0..3, 1..2] of Int`.
fn dimensions_of_text(text: &str) -> Option<Dimensions> {
    let mut found = Dimensions::new();
    let lower = text.to_ascii_lowercase();
    let mut rest = lower.trim();
    while let Some(inner) = rest.strip_prefix("array") {
        let (bounds, behind) = inner.trim_start().strip_prefix('[')?.split_once(']')?;
        for dimension in bounds.split(',') {
            let (low, high) = dimension.split_once("..")?;
            found.push((low.trim().parse().ok()?, high.trim().parse().ok()?));
        }
        rest = behind.trim_start().strip_prefix("of")?.trim_start();
    }
    Some(found)
}

/// The value of a member in the element that `prefix` names of the arrays around it.
fn build(
    reader: &mut Reader,
    leaves: &Leaves,
    member: Node,
    prefix: &[i64],
    dimensions: &[(i64, i64)],
    depth: usize,
) -> Option<InitialValue> {
    let behind = |leaf: &Leaf| {
        let path = leaf.path.strip_prefix(prefix)?.to_vec();
        Some(Leaf { path, value: leaf.value.clone() })
    };
    let own: Vec<Leaf> = leaves.get(&member.id()).into_iter().flatten().filter_map(behind).collect();
    if let Some(value) = values(own, dimensions) {
        return Some(value);
    }
    let parts = components(member);
    if parts.is_empty() || depth > DEPTH_MAX {
        return None;
    }
    if dimensions.is_empty() {
        return fields(reader, leaves, parts, prefix, depth);
    }
    let mut elements: BTreeSet<Vec<i64>> = BTreeSet::new();
    for node in member.descendants() {
        let paths = leaves.get(&node.id()).into_iter().flatten().filter_map(|leaf| leaf.path.strip_prefix(prefix));
        elements.extend(paths.filter_map(|path| path.get(..dimensions.len())).map(<[i64]>::to_vec));
    }
    let mut found = Vec::new();
    for path in elements {
        let whole = [prefix, &path].concat();
        if let Some(value) = fields(reader, leaves, components(member), &whole, depth) {
            found.push(Leaf { path, value });
        }
    }
    values(found, dimensions)
}

/// `(a := 1, b := 2)`: the components that have values.
fn fields(
    reader: &mut Reader,
    leaves: &Leaves,
    parts: Vec<Node>,
    prefix: &[i64],
    depth: usize,
) -> Option<InitialValue> {
    let mut found = Vec::new();
    for part in parts {
        let Some(dimensions) = dimensions_of_text(part.attribute("Datatype").unwrap_or_default()) else { continue };
        if let Some(value) = build(reader, leaves, part, prefix, &dimensions, depth + 1) {
            let name_span = reader.name_span(part, "Name");
            let text = part.attribute("Name").unwrap_or_default().trim().to_string();
            found.push((Some(Name { text, form: NameForm::Bare, span: name_span }), value));
        }
    }
    let span = found.first().map(|(_, value)| value.span)?;
    Some(InitialValue { kind: InitialKind::Fields(found), span })
}

/// One value, or the list of the elements' values; elements without one keep their default.
fn values(leaves: Vec<Leaf>, dimensions: &[(i64, i64)]) -> Option<InitialValue> {
    let span = leaves.first()?.value.span;
    if leaves.iter().any(|leaf| leaf.path.is_empty()) {
        return leaves.into_iter().find(|leaf| leaf.path.is_empty()).map(|leaf| leaf.value);
    }
    let mut total: i64 = 1;
    for (low, high) in dimensions {
        let count = high.checked_sub(*low)?.checked_add(1).filter(|count| (1..=ELEMENTS_MAX).contains(count))?;
        total = total.checked_mul(count).filter(|total| *total <= ELEMENTS_MAX)?;
    }
    let mut list = Vec::new();
    for leaf in leaves.into_iter().filter(|leaf| leaf.path.len() == dimensions.len()) {
        let Some(at) = position(&leaf.path, dimensions) else { continue };
        if list.len() <= at {
            list.resize(at + 1, InitialValue { kind: InitialKind::Default, span });
        }
        list[at] = leaf.value;
    }
    (!list.is_empty()).then_some(InitialValue { kind: InitialKind::List(list), span })
}

/// Place of an element among all of its array; `None` if it is outside.
fn position(path: &[i64], dimensions: &[(i64, i64)]) -> Option<usize> {
    let mut at: i64 = 0;
    for (index, (low, high)) in path.iter().zip(dimensions) {
        if !(low..=high).contains(&index) {
            return None;
        }
        at = at * (high - low + 1) + (index - low);
    }
    usize::try_from(at).ok()
}

/// Values of an instance data block, which has its members from its type.
pub fn assignments(members: &[Variable]) -> Vec<ValueAssignment> {
    let mut found = Vec::new();
    for member in members {
        let span = member.name_span;
        let root = PathRoot::Local { name: member.name.clone(), span };
        assign(&Path { root, parts: Vec::new(), span }, member, &mut found, 0);
    }
    found
}

fn assign(path: &Path, member: &Variable, found: &mut Vec<ValueAssignment>, depth: usize) {
    if let Some(value) = &member.initial {
        found.push(ValueAssignment { target: path.clone(), value: value.clone(), span: path.span });
    }
    if let TypeKind::Struct(members) = &member.ty.kind
        && depth < DEPTH_MAX
    {
        for part in members {
            let span = part.name_span;
            let mut inner = Path { span, ..path.clone() };
            inner.parts.push(PathPart::Member { name: part.name.clone(), span });
            assign(&inner, part, found, depth + 1);
        }
    }
}
