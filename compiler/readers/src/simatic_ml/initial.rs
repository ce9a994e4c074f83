//! Start values of members.
//!
//! A member has its own (`StartValue`), its elements have values by index (`Subelement Path="1,2"`), and the components of a data type that
//! are below a member have the values that differ from the type's. An index covers all arrays around it, the outermost first; bounds need not
//! be known here.

use std::collections::BTreeMap;

use roxmltree::Node;

use super::reader::Reader;
use crate::xml::{child, children, is};
use plcc_syntax::ast::{
    InitialKind, InitialValue, Path, PathPart, PathRoot, TypeKind, TypeRef, ValueAssignment, Variable,
};
use plcc_syntax::scl::ast::{Expr, Name, NameForm};

/// How deep components with values may be nested.
const DEPTH_MAX: usize = 32;

/// A start value as an expression.
pub fn expression(value: InitialValue) -> Option<Expr> {
    match value.kind {
        InitialKind::Expr(expr) => Some(*expr),
        _ => None,
    }
}

/// Values of a member, by the indices of the elements of all arrays around it.
type Values = BTreeMap<Vec<i64>, InitialValue>;

/// Start value of a member of that type.
pub fn of_member(reader: &mut Reader, member: Node, ty: &TypeRef) -> Option<InitialValue> {
    // Values of a STRUCT are at its components, where its declaration reads them; those of single elements are at the array.
    if matches!(ty.kind, TypeKind::Struct(_)) {
        return None;
    }
    values(reader, member, 0, 0).remove(&Vec::new())
}

/// The components below a member.
fn components<'a, 'i>(member: Node<'a, 'i>) -> Vec<Node<'a, 'i>> {
    let sections = child(member, "Sections").into_iter().flat_map(|sections| children(sections, "Section"));
    sections.flat_map(|section| children(section, "Member")).chain(children(member, "Member")).collect()
}

/// The members around a member.
fn outer<'a, 'i>(member: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    member.ancestors().skip(1).filter(|node| is(*node, "Member"))
}

/// The values of a member below arrays with `dimensions` dimensions in all.
fn values(reader: &mut Reader, member: Node, dimensions: usize, depth: usize) -> Values {
    let levels = dimensions_of(member.attribute("Datatype").unwrap_or_default());
    let own: usize = levels.iter().sum();
    let outer = outer(member).flat_map(|outer| dimensions_of(outer.attribute("Datatype").unwrap_or_default()));
    let around: usize = outer.sum();
    let mut whole = Values::new();
    let mut elements = Values::new();
    for (node, path, value) in own_values(reader, member) {
        let wanted = match path.len() {
            length if length == dimensions => &mut whole,
            length if length == dimensions + own => &mut elements,
            // A component of an array of structures has values for all elements, which belong to its declaration, and for single
            // ones, which belong to the array.
            length if [0, own, around, around + own].contains(&length) => continue,
            _ => {
                reader.refuse(node, "a declaration", "the start value of an element with a wrong number of indices");
                continue;
            }
        };
        wanted.insert(path, value);
    }
    let parts = components(member);
    if elements.is_empty() && whole.is_empty() && !parts.is_empty() {
        if depth >= DEPTH_MAX {
            reader.refuse(member, "a declaration", "components that are nested too deeply");
            return whole;
        }
        elements = fields(reader, parts, dimensions + own, depth + 1);
    }
    match own {
        0 if whole.is_empty() => elements,
        _ => {
            // Each array in an array has values of its own.
            let mut before = dimensions + own;
            for level in levels.iter().rev() {
                before -= level;
                elements = grouped(elements, before);
            }
            for (path, value) in elements {
                whole.entry(path).or_insert(value);
            }
            whole
        }
    }
}

/// `(a := 1, b := 2)`: the components that have values.
fn fields(reader: &mut Reader, parts: Vec<Node>, dimensions: usize, depth: usize) -> Values {
    let mut found: BTreeMap<Vec<i64>, Vec<(Option<Name>, InitialValue)>> = BTreeMap::new();
    for part in parts {
        let values = values(reader, part, dimensions, depth);
        if values.is_empty() {
            continue;
        }
        let span = reader.name_span(part, "Name");
        let text = part.attribute("Name").unwrap_or_default().trim().to_string();
        let name = Name { text, form: NameForm::Bare, span };
        for (path, value) in values {
            found.entry(path).or_default().push((Some(name.clone()), value));
        }
    }
    let structure = |(path, fields): (Vec<i64>, Vec<(Option<Name>, InitialValue)>)| {
        let span = fields.first()?.1.span;
        Some((path, InitialValue { kind: InitialKind::Fields(fields), span }))
    };
    found.into_iter().filter_map(structure).collect()
}

/// Values of elements, collected into values of the arrays: the first `dimensions` indices are those of the arrays around.
fn grouped(elements: Values, dimensions: usize) -> Values {
    let mut arrays: BTreeMap<Vec<i64>, Vec<(Vec<i64>, InitialValue)>> = BTreeMap::new();
    for (path, value) in elements {
        let (around, own) = path.split_at(dimensions);
        arrays.entry(around.to_vec()).or_default().push((own.to_vec(), value));
    }
    let array = |(path, elements): (Vec<i64>, Vec<(Vec<i64>, InitialValue)>)| {
        let span = elements.first()?.1.span;
        Some((path, InitialValue { kind: InitialKind::Elements(elements), span }))
    };
    arrays.into_iter().filter_map(array).collect()
}

/// `StartValue` and `Subelement` of a member, with their indices.
fn own_values<'a, 'i>(reader: &mut Reader, member: Node<'a, 'i>) -> Vec<(Node<'a, 'i>, Vec<i64>, InitialValue)> {
    let mut found = Vec::new();
    if let Some(value) = child(member, "StartValue").and_then(|value| reader.start_value(value)) {
        found.push((member, Vec::new(), value));
    }
    for element in children(member, "Subelement") {
        let path: Option<Vec<i64>> =
            element.attribute("Path").unwrap_or_default().split(',').map(|index| index.trim().parse().ok()).collect();
        let Some(path) = path else {
            reader.refuse(element, "a declaration", "the start value of an element whose index cannot be read");
            continue;
        };
        if let Some(value) = child(element, "StartValue").and_then(|value| reader.start_value(value)) {
            found.push((element, path, value));
        }
    }
    found
}

/// How many dimensions the arrays of a member have: 2 of `Array[0..3, 1..2] of Int`, 1 and 1 of `Array[0..3] of Array[1..2] of Int`.
fn dimensions_of(text: &str) -> Vec<usize> {
    let lower = text.to_ascii_lowercase();
    let mut rest = lower.trim();
    let mut levels = Vec::new();
    while let Some(inner) = rest.strip_prefix("array")
        && let Some((bounds, after)) = inner.trim_start().strip_prefix('[').and_then(|inner| inner.split_once(']'))
    {
        levels.push(bounds.split(',').count());
        rest = after.trim_start().strip_prefix("of").unwrap_or_default().trim_start();
    }
    levels
}

/// Values of an instance data block, whose members come from its type.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dimensions_are_counted_through() {
        assert!(dimensions_of("Int").is_empty());
        assert_eq!(dimensions_of("Array[0..\"MAX\", 1..2] of Array[1..2] of \"Array[0]\""), [2, 1]);
        assert_eq!(dimensions_of("array [*] of Int"), [1]);
    }
}
