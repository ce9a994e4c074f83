//! Browsing: references of nodes, and paths from one node to another.

use super::Server;
use super::code::{NodeId, Reader, Writer};
use super::space::Node;
use super::standard::{self, HAS_TYPE_DEFINITION};
use super::status::{self, Status};
use crate::limits::{
    OPCUA_BROWSED_MAX, OPCUA_CONTINUATIONS_MAX, OPCUA_NODES_MAX, OPCUA_PATH_MAX, OPCUA_REFERENCES_MAX,
};

/// A reference from a node to another.
#[derive(Clone)]
struct Reference {
    ty: u32,
    forward: bool,
    node: Node,
}

/// What is left of a long answer.
pub struct Rest {
    id: u32,
    references: Vec<Reference>,
    most: usize,
    mask: u32,
}

/// Long answers of a session.
#[derive(Default)]
pub struct Continuations {
    list: Vec<Rest>,
    last: u32,
}

/// What of a node is asked for.
struct Question {
    node: NodeId,
    /// 0: forward, 1: back, 2: both.
    direction: u32,
    /// References of this type; 0: of all.
    reference: NodeId,
    subtypes: bool,
    classes: u32,
    mask: u32,
}

fn question(reader: &mut Reader) -> Option<Question> {
    Some(Question {
        node: reader.node()?,
        direction: reader.u32()?,
        reference: reader.node()?,
        subtypes: reader.bool()?,
        classes: reader.u32()?,
        mask: reader.u32()?,
    })
}

/// Browse.
pub fn browse(server: &Server, kept: &mut Continuations, reader: &mut Reader, out: &mut Writer) -> Result<(), Status> {
    let read = |reader: &mut Reader| {
        let _view = (reader.node()?, reader.i64()?, reader.u32()?);
        Some((reader.u32()?, reader.list(question)?))
    };
    let (most, questions) = read(reader).ok_or(status::DECODING)?;
    let count = questions.len();
    check_count(count)?;
    if count > OPCUA_BROWSED_MAX {
        return Err(status::TOO_MANY_OPERATIONS);
    }
    let most = if most == 0 { OPCUA_REFERENCES_MAX } else { OPCUA_REFERENCES_MAX.min(most as usize) };
    // All answers together are not longer than one may be.
    let most = most.min((OPCUA_REFERENCES_MAX / count).max(1));
    out.u32(count as u32);
    for question in questions {
        match references(server, &question) {
            Ok(references) => kept.put(out, Rest { id: 0, references, most, mask: question.mask }),
            Err(status) => put_result(out, status, &[], &[], 0),
        }
    }
    out.null();
    Ok(())
}

/// BrowseNext.
pub fn browse_next(kept: &mut Continuations, reader: &mut Reader, out: &mut Writer) -> Result<(), Status> {
    let read = |reader: &mut Reader| Some((reader.bool()?, reader.list(|reader| reader.bytes().map(<[u8]>::to_vec))?));
    let (release, points) = read(reader).ok_or(status::DECODING)?;
    check_count(points.len())?;
    out.u32(points.len() as u32);
    for point in points {
        let id = point.try_into().map(u32::from_le_bytes).ok();
        let found = kept.list.iter().position(|rest| Some(rest.id) == id).map(|at| kept.list.remove(at));
        match found {
            Some(_) if release => put_result(out, status::GOOD, &[], &[], 0),
            Some(rest) => kept.put(out, rest),
            None => put_result(out, status::CONTINUATION_INVALID, &[], &[], 0),
        }
    }
    out.null();
    Ok(())
}

/// No request without anything to do, and none with too much.
pub fn check_count(count: usize) -> Result<(), Status> {
    match count {
        0 => Err(status::NOTHING_TO_DO),
        1..=OPCUA_NODES_MAX => Ok(()),
        _ => Err(status::TOO_MANY_OPERATIONS),
    }
}

impl Continuations {
    /// Answers with the first references; the others are kept.
    fn put(&mut self, out: &mut Writer, mut rest: Rest) {
        if rest.references.len() <= rest.most {
            return put_result(out, status::GOOD, &[], &rest.references, rest.mask);
        }
        if self.list.len() >= OPCUA_CONTINUATIONS_MAX {
            return put_result(out, status::NO_CONTINUATION, &[], &[], 0);
        }
        let later = rest.references.split_off(rest.most);
        self.last = self.last.wrapping_add(1);
        put_result(out, status::GOOD, &self.last.to_le_bytes(), &rest.references, rest.mask);
        self.list.push(Rest { id: self.last, references: later, ..rest });
    }
}

fn references(server: &Server, question: &Question) -> Result<Vec<Reference>, Status> {
    let node = server.space.node(&question.node).ok_or(status::NODE_UNKNOWN)?;
    if question.direction > 2 {
        return Err(status::DIRECTION_INVALID);
    }
    let wanted = question.reference.standard().filter(|number| *number != 0);
    let is_wanted = |ty: u32| match wanted {
        Some(wanted) => standard::is_kind_of(ty, wanted, question.subtypes),
        None => question.reference == NodeId::number(0, 0),
    };
    let mut found = Vec::new();
    if question.direction != 1 {
        let children = server.space.children(&node).into_iter();
        found.extend(children.map(|(ty, node)| Reference { ty, forward: true, node }));
        let definition = server.space.node(&NodeId::number(0, node.definition)).filter(|_| node.definition != 0);
        found.extend(definition.map(|node| Reference { ty: HAS_TYPE_DEFINITION, forward: true, node }));
    }
    if question.direction != 0
        && let Some((id, ty)) = &node.parent
        && let Some(parent) = server.space.node(id)
    {
        found.push(Reference { ty: *ty, forward: false, node: parent });
    }
    found.retain(|reference| {
        is_wanted(reference.ty) && (question.classes == 0 || question.classes & reference.node.class != 0)
    });
    Ok(found)
}

fn put_result(out: &mut Writer, status: Status, point: &[u8], references: &[Reference], mask: u32) {
    out.u32(status);
    if point.is_empty() {
        out.null()
    } else {
        out.bytes(point)
    }
    out.list(references, |out, Reference { ty, forward, node }| {
        let wants = |bit: u32| mask & bit != 0;
        out.node(&NodeId::number(0, if wants(1) { *ty } else { 0 }));
        out.bool(wants(2) && *forward);
        out.node(&node.id);
        let (namespace, name) = if wants(8) { (node.name_space(), node.name.as_str()) } else { (0, "") };
        out.name(namespace, name);
        out.localized(if wants(16) { &node.name } else { "" });
        out.u32(if wants(4) { node.class } else { 0 });
        out.node(&NodeId::number(0, if wants(32) { node.definition } else { 0 }));
    });
}

/// TranslateBrowsePathsToNodeIds.
pub fn translate(server: &Server, reader: &mut Reader, out: &mut Writer) -> Result<(), Status> {
    let part = |reader: &mut Reader| Some((reader.node()?, reader.bool()?, reader.bool()?, reader.name()?));
    let path = |reader: &mut Reader| Some((reader.node()?, reader.list(part)?));
    let paths = reader.list(path).ok_or(status::DECODING)?;
    check_count(paths.len())?;
    out.u32(paths.len() as u32);
    for (start, parts) in paths {
        let found = match server.space.node(&start) {
            None => Err(status::NODE_UNKNOWN),
            Some(_) if parts.is_empty() || parts.len() > OPCUA_PATH_MAX => Err(status::NOTHING_TO_DO),
            Some(node) => parts.iter().try_fold(node, |node, (ty, back, subtypes, (namespace, name))| {
                let wanted = |own: u32| {
                    *ty == NodeId::number(0, 0)
                        || ty.standard().is_some_and(|ty| standard::is_kind_of(own, ty, *subtypes))
                };
                let is_named = |node: &Node| node.name_space() == *namespace && node.name == *name;
                let found = match back {
                    true => {
                        let parent = node.parent.as_ref().filter(|(_, own)| wanted(*own));
                        parent.and_then(|(id, _)| server.space.node(id)).filter(is_named)
                    }
                    false => {
                        let child = server.space.child(&node, name).filter(is_named);
                        child.filter(|child| child.parent.as_ref().is_some_and(|(_, own)| wanted(*own)))
                    }
                };
                found.ok_or(status::NO_MATCH)
            }),
        };
        match found {
            Ok(node) => {
                out.u32(status::GOOD);
                out.u32(1);
                out.node(&node.id);
                out.u32(u32::MAX);
            }
            Err(status) => {
                out.u32(status);
                out.null();
            }
        }
    }
    out.null();
    Ok(())
}
