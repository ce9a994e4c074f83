//! Objects of a body as networks, in the order of evaluation.
//!
//! Objects that lines connect form a network; the rail and a variable with several readers connect nothing. Networks run from top to bottom;
//! in a network, an object runs after those that feed it, otherwise from top to bottom and from left to right. If every object has a number
//! of execution, only the numbers decide.
//! Source: LAD/FBD reference, chapter A3.

use std::collections::{HashMap, HashSet};

use super::objects::{Kind, Object};

/// A network: its label, and the objects that run, in order.
#[derive(Debug, Default)]
pub struct Group {
    pub labels: Vec<usize>,
    pub objects: Vec<usize>,
}

/// The networks of a body.
pub fn groups(objects: &[Object]) -> Vec<Group> {
    let running = || objects.iter().filter(|object| object.runs());
    let numbered = running().count() > 0 && running().all(|object| object.order > 0);
    let mut parts = components(objects);
    let first = |part: &Vec<usize>| part.iter().map(|at| objects[*at].position).min().unwrap_or_default();
    let labels = objects.iter().any(|object| object.kind == Kind::Label && object.order == 0);
    if numbered && !labels {
        parts = by_number(objects, parts);
    } else {
        parts.sort_by_key(first);
    }
    let mut groups = Vec::new();
    let mut waiting: Vec<usize> = Vec::new();
    for part in parts {
        waiting.extend(part.iter().filter(|at| objects[**at].kind == Kind::Label));
        let order = if numbered { numbers(objects, &part) } else { flow(objects, &part) };
        if !order.is_empty() {
            groups.push(Group { labels: std::mem::take(&mut waiting), objects: order });
        }
    }
    if !waiting.is_empty() {
        groups.push(Group { labels: waiting, objects: Vec::new() });
    }
    groups
}

/// The objects that run for the value of one object, itself last.
pub fn feeding(objects: &[Object], at: usize) -> Vec<usize> {
    let mut part = vec![at];
    let mut seen = HashSet::from([at]);
    let mut next = 0;
    while let Some(at) = part.get(next).copied() {
        let object = &objects[at];
        let is_connector = |other: &usize| {
            let other = &objects[*other];
            object.kind == Kind::Continuation && other.kind == Kind::Connector && other.name == object.name
        };
        let joined = (0..objects.len()).filter(is_connector);
        let lines = object.inputs.iter().flat_map(|input| &input.from).map(|(from, _)| *from);
        part.extend(lines.chain(joined).filter(|from| seen.insert(*from)));
        next += 1;
    }
    flow(objects, &part)
}

/// Objects that lines connect, except through the rail.
fn components(objects: &[Object]) -> Vec<Vec<usize>> {
    let mut parent: Vec<usize> = (0..objects.len()).collect();
    fn root(parent: &mut [usize], mut at: usize) -> usize {
        while parent[at] != at {
            parent[at] = parent[parent[at]];
            at = parent[at];
        }
        at
    }
    let mut join = |a: usize, b: usize| {
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        parent[a.max(b)] = a.min(b);
    };
    let mut uses = vec![0; objects.len()];
    objects.iter().flat_map(|object| &object.inputs).flat_map(|input| &input.from).for_each(|(at, _)| uses[*at] += 1);
    // A variable that is drawn once and read in several networks does not join them.
    let shared = |at: usize| objects[at].kind == Kind::InVariable && uses[at] > 1;
    let mut connectors: HashMap<&str, usize> = HashMap::new();
    for (at, object) in objects.iter().enumerate() {
        for (from, _) in object.inputs.iter().flat_map(|input| &input.from) {
            if objects[*from].kind != Kind::LeftRail && !shared(*from) {
                join(at, *from);
            }
        }
        if matches!(object.kind, Kind::Connector | Kind::Continuation) {
            match connectors.get(object.name.as_str()) {
                Some(other) => join(at, *other),
                None => {
                    connectors.insert(&object.name, at);
                }
            }
        }
    }
    let mut parts: Vec<Vec<usize>> = Vec::new();
    let mut known: HashMap<usize, usize> = HashMap::new();
    for (at, object) in objects.iter().enumerate() {
        if object.kind == Kind::LeftRail {
            continue;
        }
        let part = *known.entry(root(&mut parent, at)).or_insert_with(|| {
            parts.push(Vec::new());
            parts.len() - 1
        });
        parts[part].push(at);
    }
    parts
}

/// Parts in the order of their numbers; parts whose numbers overlap become one.
fn by_number(objects: &[Object], parts: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    let mut ranges: Vec<(u64, u64, Vec<usize>)> = parts
        .into_iter()
        .filter_map(|part| {
            let numbers = || part.iter().map(|at| objects[*at].order).filter(|order| *order > 0);
            Some((numbers().min()?, numbers().max()?, part))
        })
        .collect();
    ranges.sort();
    let mut merged: Vec<(u64, u64, Vec<usize>)> = Vec::new();
    for (low, high, part) in ranges {
        match merged.last_mut() {
            Some((_, last, members)) if low <= *last => {
                *last = high.max(*last);
                members.extend(part);
            }
            _ => merged.push((low, high, part)),
        }
    }
    merged.into_iter().map(|(_, _, part)| part).collect()
}

fn numbers(objects: &[Object], part: &[usize]) -> Vec<usize> {
    let mut order: Vec<usize> = part.iter().copied().filter(|at| objects[*at].runs()).collect();
    order.sort_by_key(|at| (objects[*at].order, objects[*at].position));
    order
}

/// Depth first through what feeds each object; a line that leads back is not followed.
fn flow(objects: &[Object], part: &[usize]) -> Vec<usize> {
    let mut roots = part.to_vec();
    roots.sort_by_key(|at| objects[*at].position);
    let connectors: HashMap<&str, usize> = part
        .iter()
        .filter(|at| objects[**at].kind == Kind::Connector)
        .map(|at| (objects[*at].name.as_str(), *at))
        .collect();
    let all = |at: usize| -> Vec<usize> {
        let object = &objects[at];
        match connectors.get(object.name.as_str()).filter(|_| object.kind == Kind::Continuation) {
            Some(connector) => vec![*connector],
            None => object.inputs.iter().flat_map(|input| &input.from).map(|(from, _)| *from).collect(),
        }
    };
    // Of a loop, the line from the right to the left has the value of the last cycle.
    let column = |at: usize| objects[at].position.1;
    let feeding = |at: usize| -> Vec<usize> {
        all(at).into_iter().filter(|from| column(*from) <= column(at) || !depends(*from, at, &all)).collect()
    };
    let mut seen: HashSet<usize> = HashSet::new();
    let mut order = Vec::new();
    for root in roots {
        let mut work = vec![(root, feeding(root), 0)];
        if !seen.insert(root) {
            continue;
        }
        while let Some((at, from, done)) = work.pop() {
            match from.get(done).copied() {
                Some(next) => {
                    work.push((at, from, done + 1));
                    if seen.insert(next) {
                        work.push((next, feeding(next), 0));
                    }
                }
                None => order.push(at),
            }
        }
    }
    order.retain(|at| objects[*at].runs());
    order
}

/// Whether `at` needs the output of `on`, directly or through others.
fn depends(at: usize, on: usize, feeding: &dyn Fn(usize) -> Vec<usize>) -> bool {
    let mut seen = HashSet::from([at]);
    let mut work = vec![at];
    while let Some(next) = work.pop() {
        if next == on {
            return true;
        }
        work.extend(feeding(next).into_iter().filter(|from| seen.insert(*from)));
    }
    false
}
