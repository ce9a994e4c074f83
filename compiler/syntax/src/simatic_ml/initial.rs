//! Start values of members.
//!
//! A member has its own (`StartValue`), its elements have theirs by index (`Subelement Path="1,2"`), and the components of a data type that
//! stand below a member have those that differ from the type's.

use roxmltree::Node;

use super::reader::Reader;
use crate::ast::{Bound, InitialKind, InitialValue, Path, PathRoot, TypeKind, TypeRef, ValueAssignment, Variable};
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
struct Leaf {
    path: Vec<i64>,
    value: InitialValue,
}

/// Start value of a member of that type.
pub fn of_member(reader: &mut Reader, member: Node, ty: &TypeRef) -> Option<InitialValue> {
    let leaves = own_values(reader, member);
    let own = values(leaves, &dimensions(ty));
    // Values of a STRUCT stand at its components, which the structure's declaration reads.
    match ty.kind {
        TypeKind::Block(_) => own.or_else(|| fields(reader, member, 0)),
        _ => own,
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
        if let Some(path) = path
            && let Some(value) = child(element, "StartValue").and_then(|value| reader.start_value(value))
        {
            leaves.push(Leaf { path, value });
        }
    }
    leaves
}

/// The bounds of a type that is an array, and of an array of arrays; none if one is no number.
fn dimensions(ty: &TypeRef) -> Vec<(i64, i64)> {
    let mut found = Vec::new();
    let mut ty = ty;
    while let TypeKind::Array { bounds, element } = &ty.kind {
        for (low, high) in bounds {
            match (low, high) {
                (Bound::Number(low, _), Bound::Number(high, _)) => found.push((*low, *high)),
                _ => return Vec::new(),
            }
        }
        ty = element;
    }
    found
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
    let mut list = vec![InitialValue { kind: InitialKind::Default, span }; total as usize];
    let mut last = 0;
    for leaf in leaves {
        if leaf.path.len() != dimensions.len() {
            continue;
        }
        let mut at = 0;
        let mut inside = true;
        for (index, (low, high)) in leaf.path.iter().zip(dimensions) {
            if !(low..=high).contains(&index) {
                inside = false;
                break;
            }
            at = at * (high - low + 1) + (index - low);
        }
        if inside && let Some(place) = usize::try_from(at).ok().and_then(|at| list.get_mut(at)) {
            *place = leaf.value;
            last = last.max(at as usize + 1);
        }
    }
    list.truncate(last);
    (last > 0).then_some(InitialValue { kind: InitialKind::List(list), span })
}

/// `(a := 1, b := 2)`: values of components of a data type that stand below a member. Those inside arrays of it keep the type's.
fn fields(reader: &mut Reader, member: Node, depth: usize) -> Option<InitialValue> {
    if depth > DEPTH_MAX {
        return None;
    }
    let sections = child(member, "Sections").into_iter().flat_map(|sections| children(sections, "Section"));
    let members: Vec<Node> = sections.flat_map(|section| children(section, "Member")).collect();
    let members = members.into_iter().chain(children(member, "Member"));
    let mut found = Vec::new();
    for part in members {
        let own = own_values(reader, part).into_iter().find(|leaf| leaf.path.is_empty()).map(|leaf| leaf.value);
        let is_array = part.attribute("Datatype").is_some_and(|ty| ty.to_ascii_lowercase().starts_with("array"));
        let value = match own {
            Some(value) => Some(value),
            None if is_array => None,
            None => fields(reader, part, depth + 1),
        };
        if let Some(value) = value {
            let name_span = reader.name_span(part, "Name");
            let text = part.attribute("Name").unwrap_or_default().trim().to_string();
            found.push((Some(Name { text, form: NameForm::Bare, span: name_span }), value));
        }
    }
    let span = found.first().map(|(_, value)| value.span)?;
    Some(InitialValue { kind: InitialKind::Fields(found), span })
}

/// Values of an instance data block, which has its members from its type.
pub fn assignments(members: &[Variable]) -> Vec<ValueAssignment> {
    members.iter().filter_map(|member| assignment(member, member.initial.as_ref()?)).collect()
}

fn assignment(member: &Variable, value: &InitialValue) -> Option<ValueAssignment> {
    let span = member.name_span;
    let root = PathRoot::Local { name: member.name.clone(), span };
    Some(ValueAssignment { target: Path { root, parts: Vec::new(), span }, value: value.clone(), span })
}
