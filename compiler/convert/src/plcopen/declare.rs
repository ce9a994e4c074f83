//! Declarations: types, variables and their start values.

use plcc_diag::Span;
use plcc_syntax::ast::{
    Bound, InitialKind, InitialValue, PathPart, PathRoot, TypeKind, TypeRef, ValueAssignment, Variable,
};
use plcc_syntax::scl::ast::{Expr, Name, NameForm};

use super::body::elementary_of;
use super::identifier::identifier;
use super::program::Program;
use super::{documentation, system};
use crate::frames::bare;
use crate::node::Node;
use crate::scl::expression;
use crate::writer::Writer;

/// Characters of a STRING without a length. It is always written: the editors have other lengths for such a text.
const LONGEST_TEXT: u32 = 254;

/// No array has more start values than this.
const VALUES_MAX: usize = 100_000;

/// Declarations of a file, with the structures without a name that get one.
pub struct Declarer<'p, 'a> {
    pub program: &'p Program<'a>,
    /// Structures without a name: the name that they get, and their members.
    pub structures: Vec<(String, Node)>,
    /// Attributes of variables that the file does not have.
    pub attributes: Vec<(String, Span)>,
}

impl<'a> Declarer<'_, 'a> {
    /// The element inside `type` or `baseType`.
    pub fn type_node(&mut self, ty: &'a TypeRef, name: &str, parent: &str, writer: &mut Writer) -> Node {
        if let Some(block) = self.program.block_type(ty) {
            return Node::new("derived").with("name", block);
        }
        match &ty.kind {
            TypeKind::Named(word) => {
                if let Some(element) = elementary_of(ty).and_then(system::type_element) {
                    return Node::new(element);
                }
                if self.program.type_key(ty).is_some() {
                    return Node::new("derived").with("name", self.program.name(&self.program.key_of(word)));
                }
                let known = self.program.members(ty).is_some();
                if !known {
                    let is_any =
                        matches!(word.to_ascii_uppercase().as_str(), "IEC_TIMER" | "IEC_COUNTER" | "IEC_DCOUNTER");
                    let help = match is_any {
                        true => "declare it as TON, CTU or another block: no call shows which one it is",
                        false => "declare it with a type of IEC 61131-3",
                    };
                    writer.refuse(ty.span, format!("plcc writes no variables of type {word} in PLCopen XML"), help);
                }
                Node::new("derived").with("name", word)
            }
            TypeKind::String(length) => {
                let length = length.as_ref().map_or_else(|| LONGEST_TEXT.to_string(), |length| bound(length, writer));
                Node::new("string").with("length", length)
            }
            TypeKind::Array { bounds, element } => {
                let mut node = Node::new("array");
                for (low, high) in bounds {
                    let dimension = Node::new("dimension").with("lower", bound(low, writer));
                    node.push(dimension.with("upper", bound(high, writer)));
                }
                let element = self.type_node(element, name, parent, writer);
                node.child(Node::new("baseType").child(element))
            }
            TypeKind::Struct(members) => {
                let wanted = identifier(&format!("{}_{name}", parent));
                let node = self.structure(members, &wanted, writer);
                let same = self.structures.iter().find(|(_, known)| *known == node);
                let name = match same {
                    Some((name, _)) => name.clone(),
                    None => {
                        let taken: Vec<String> = self.structures.iter().map(|(name, _)| name.clone()).collect();
                        let name = self.program.free_name(&wanted, &taken);
                        self.structures.push((name.clone(), node));
                        name
                    }
                };
                Node::new("derived").with("name", name)
            }
            TypeKind::Block(_) if self.program.type_key(ty).is_some_and(|key| self.program.global(&key).is_some()) => {
                let key = self.program.type_key(ty).unwrap_or_default();
                Node::new("derived").with("name", self.program.name(&key))
            }
            TypeKind::Block(name) => {
                let name = self.program.shown(&self.program.key(name));
                let title = format!("IEC 61131-3 has no `{name}`, and no source declares it");
                writer.refuse(ty.span, title, "add its source, or program it in another way");
                Node::new("derived")
            }
            TypeKind::WideString(_) => self.none(ty, "WSTRING", "use STRING", writer),
            TypeKind::OpenArray { .. } => self.none(ty, "arrays without bounds", "give the array bounds", writer),
            TypeKind::Reference(_) => self.none(ty, "references", "use an in-out parameter", writer),
            TypeKind::Error => self.none(ty, "this type", "repair the source first", writer),
        }
    }

    fn none(&mut self, ty: &TypeRef, what: &str, help: &str, writer: &mut Writer) -> Node {
        writer.refuse(ty.span, format!("plcc writes no variables of type {what} in PLCopen XML"), help);
        Node::new("derived")
    }

    /// The structure of these members; `name` is for the structures in it.
    pub fn structure(&mut self, members: &'a [Variable], name: &str, writer: &mut Writer) -> Node {
        unique(members.iter().map(|member| (member.name.as_str(), member.name_span)), writer);
        let members: Vec<Node> = members.iter().map(|member| self.variable(member, name, writer)).collect();
        Node::new("struct").children(members)
    }

    /// A variable with its type, its start value and its comment.
    pub fn variable(&mut self, variable: &'a Variable, parent: &str, writer: &mut Writer) -> Node {
        let mut node = Node::new("variable").with("name", identifier(&variable.name));
        if let Some((at, span)) = &variable.at {
            let title = format!("PLCopen XML has no variable at the place of another one, such as of `{at}`");
            writer.refuse(*span, title, "use parts of the variable, or convert it");
        }
        for (key, _) in &variable.attributes {
            if !self.attributes.iter().any(|(known, _)| known.eq_ignore_ascii_case(key)) {
                self.attributes.push((key.clone(), variable.name_span));
            }
        }
        let mut comments: Vec<String> = Vec::new();
        let end = variable.initial.as_ref().map_or(variable.ty.span.end, |value| value.span.end);
        let mut remarks = writer.trivia.before(variable.name_span.start);
        remarks.retain(|remark| !writer.is_written(&remark.text));
        // What is on the line of a structure is about it, not about its first member.
        remarks.extend(writer.trivia.on_line(variable.name_span.end));
        let ty = self.type_node(&variable.ty, &variable.name, parent, writer);
        remarks.extend(writer.trivia.on_line(end.max(variable.name_span.end)));
        node.push(Node::new("type").child(ty));
        if let Some(value) = &variable.initial {
            node.push(self.initial(value, &variable.ty, writer));
        }
        for text in variable.comment.iter().cloned().chain(remarks.iter().map(|remark| bare(&remark.text))) {
            if !text.is_empty() && !comments.contains(&text) {
                comments.push(text);
            }
        }
        if !comments.is_empty() {
            node.push(documentation(&comments.join("\n")));
        }
        node
    }

    // Start values.

    pub fn initial(&mut self, value: &InitialValue, ty: &'a TypeRef, writer: &mut Writer) -> Node {
        let value = self.value(value, ty, writer);
        Node::new("initialValue").children(value)
    }

    /// Start values of some members of a structure without a name.
    pub fn of_members(&mut self, value: &InitialValue, members: &'a [Variable], writer: &mut Writer) -> Option<Node> {
        let InitialKind::Fields(fields) = &value.kind else { return None };
        let mut node = Node::new("structValue");
        for (name, value) in fields {
            let is =
                |member: &&Variable| name.as_ref().is_some_and(|name| member.name.eq_ignore_ascii_case(&name.text));
            let Some(member) = members.iter().find(is) else {
                self.no_value(value, writer);
                continue;
            };
            if let Some(value) = self.override_of(value, member, writer) {
                node.push(Node::new("value").with("member", identifier(&member.name)).child(value));
            }
        }
        Some(Node::new("initialValue").child(node))
    }

    /// A value of elements of an array keeps what the declaration says of the others.
    fn override_of(&mut self, value: &InitialValue, member: &'a Variable, writer: &mut Writer) -> Option<Node> {
        let partial = matches!(value.kind, InitialKind::Elements(_));
        if partial && member.initial.is_some() {
            return self.no_value(value, writer);
        }
        self.value(value, &member.ty, writer)
    }

    fn value(&mut self, value: &InitialValue, ty: &'a TypeRef, writer: &mut Writer) -> Option<Node> {
        match &value.kind {
            InitialKind::Literal(literal) => match crate::to_graph::constant(literal, value.span) {
                Ok(value) => Some(simple(&value, writer)),
                Err(_) => self.no_value(value, writer),
            },
            InitialKind::Expr(value) => Some(simple(value, writer)),
            InitialKind::List(_) | InitialKind::Repeat { .. } => {
                let TypeKind::Array { element, .. } = &self.resolved(ty).kind else {
                    return self.no_value(value, writer);
                };
                let mut list = Vec::new();
                if !self.flat(value, element, &mut list, writer) {
                    return self.no_value(value, writer);
                }
                Some(array(list))
            }
            InitialKind::Elements(elements) => {
                let TypeKind::Array { bounds, element } = &self.resolved(ty).kind else {
                    return self.no_value(value, writer);
                };
                let mut sizes = Vec::new();
                for (low, high) in bounds {
                    let (Bound::Number(low, _), Bound::Number(high, _)) = (low, high) else {
                        return self.no_value(value, writer);
                    };
                    sizes.push((*low, usize::try_from(high - low + 1).unwrap_or(0)));
                }
                let mut list: Vec<Option<Node>> = Vec::new();
                for (index, value) in elements {
                    let mut at = 0;
                    for ((low, size), index) in sizes.iter().zip(index) {
                        at = at * size + usize::try_from(index - low).unwrap_or(VALUES_MAX);
                    }
                    if at >= VALUES_MAX {
                        return self.no_value(value, writer);
                    }
                    if list.len() <= at {
                        list.resize(at + 1, None);
                    }
                    list[at] = self.value(value, element, writer);
                }
                let default = self.default(element)?;
                Some(array(list.into_iter().map(|one| (1, one.unwrap_or_else(|| default.clone()))).collect()))
            }
            InitialKind::Fields(fields) => {
                let Some(members) = self.program.members(ty) else { return self.no_value(value, writer) };
                let mut node = Node::new("structValue");
                for (at, (name, value)) in fields.iter().enumerate() {
                    let member = match name {
                        Some(name) => members.iter().find(|one| one.name.eq_ignore_ascii_case(&name.text)),
                        None => members.get(at),
                    };
                    let Some(member) = member else { return self.no_value(value, writer) };
                    if let Some(value) = self.override_of(value, member, writer) {
                        node.push(Node::new("value").with("member", identifier(&member.name)).child(value));
                    }
                }
                Some(node)
            }
            InitialKind::Operand(_) => self.no_value(value, writer),
            InitialKind::Default => None,
        }
    }

    fn no_value(&self, value: &InitialValue, writer: &mut Writer) -> Option<Node> {
        let help = "assign the value in the program";
        writer.refuse(value.span, "PLCopen XML has no form for this start value", help);
        None
    }

    /// A type with names of data types resolved.
    fn resolved(&self, ty: &'a TypeRef) -> &'a TypeRef {
        let mut ty = ty;
        for _ in 0..16 {
            match self.program.type_key(ty).and_then(|key| self.program.global(&key)) {
                Some(super::program::Global::Type(block)) => match &block.alias {
                    Some(alias) => ty = alias,
                    None => return ty,
                },
                _ => return ty,
            }
        }
        ty
    }

    /// Values of a list, with their repetitions.
    fn flat(
        &mut self,
        value: &InitialValue,
        element: &'a TypeRef,
        list: &mut Vec<(u64, Node)>,
        writer: &mut Writer,
    ) -> bool {
        if list.len() > VALUES_MAX {
            return false;
        }
        match &value.kind {
            InitialKind::List(values) => values.iter().all(|value| self.flat(value, element, list, writer)),
            InitialKind::Repeat { count: Bound::Number(count, _), values } => {
                let Ok(count) = u64::try_from(*count) else { return false };
                if let [InitialValue { kind: InitialKind::Repeat { .. } | InitialKind::List(_), .. }] =
                    values.as_slice()
                {
                    return (0..count).all(|_| self.flat(&values[0], element, list, writer));
                }
                if let [one] = values.as_slice() {
                    return match self.value_or_default(one, element, writer) {
                        Some(node) => {
                            list.push((count, node));
                            true
                        }
                        None => false,
                    };
                }
                (0..count).all(|_| values.iter().all(|value| self.flat(value, element, list, writer)))
            }
            InitialKind::Repeat { .. } => false,
            _ => match self.value_or_default(value, element, writer) {
                Some(node) => {
                    list.push((1, node));
                    true
                }
                None => false,
            },
        }
    }

    fn value_or_default(&mut self, value: &InitialValue, ty: &'a TypeRef, writer: &mut Writer) -> Option<Node> {
        match value.kind {
            InitialKind::Default => self.default(ty),
            _ => self.value(value, ty, writer),
        }
    }

    /// The value that a variable without a start value has.
    fn default(&self, ty: &'a TypeRef) -> Option<Node> {
        let ty = self.resolved(ty);
        let text = match &ty.kind {
            TypeKind::String(_) => "''",
            TypeKind::Struct(_) => return Some(Node::new("structValue")),
            _ if self.program.members(ty).is_some() => return Some(Node::new("structValue")),
            _ => match elementary_of(ty).and_then(system::type_element)? {
                "BOOL" => "FALSE",
                "TIME" => "T#0ms",
                "TOD" => "TOD#0:0:0",
                "REAL" | "LREAL" => "0.0",
                _ => "0",
            },
        };
        Some(Node::new("simpleValue").with("value", text))
    }

    /// Values of an instance that differ from those of its block, or of a data block after BEGIN.
    pub fn values(&mut self, values: &[ValueAssignment], writer: &mut Writer) -> Option<InitialValue> {
        let mut all: Option<InitialValue> = None;
        for value in values {
            let first = match &value.target.root {
                PathRoot::Local { name, .. } | PathRoot::Bare { name, .. } | PathRoot::Quoted { name, .. } => name,
                PathRoot::Block(_) => continue,
            };
            let mut inner = value.value.clone();
            for part in value.target.parts.iter().rev() {
                let kind = match part {
                    PathPart::Member { name, .. } => InitialKind::Fields(vec![(Some(field(name, value.span)), inner)]),
                    PathPart::Index { values, .. } => {
                        let numbers: Option<Vec<i64>> = values
                            .iter()
                            .map(|value| match value {
                                Bound::Number(number, _) => Some(*number),
                                Bound::Name(..) | Bound::Expr(_) | Bound::Path(_) => None,
                            })
                            .collect();
                        let Some(numbers) = numbers else {
                            self.no_value(&value.value, writer);
                            return None;
                        };
                        InitialKind::Elements(vec![(numbers, inner)])
                    }
                };
                inner = InitialValue { kind, span: value.span };
            }
            let kind = InitialKind::Fields(vec![(Some(field(first, value.span)), inner)]);
            let next = InitialValue { kind, span: value.span };
            match &mut all {
                Some(all) => merge(all, next),
                None => all = Some(next),
            }
        }
        all
    }
}

fn field(name: &str, span: Span) -> Name {
    Name { text: name.to_string(), form: NameForm::Bare, span }
}

/// Puts the values of another list into this one.
pub fn merge(into: &mut InitialValue, other: InitialValue) {
    match (&mut into.kind, other.kind) {
        (InitialKind::Fields(fields), InitialKind::Fields(others)) => {
            for (name, value) in others {
                let same = |known: &Option<Name>| match (known, &name) {
                    (Some(known), Some(name)) => known.text.eq_ignore_ascii_case(&name.text),
                    _ => false,
                };
                match fields.iter_mut().find(|(known, _)| same(known)) {
                    Some((_, known)) => merge(known, value),
                    None => fields.push((name, value)),
                }
            }
        }
        (InitialKind::Elements(elements), InitialKind::Elements(others)) => {
            for (index, value) in others {
                match elements.iter_mut().find(|(known, _)| *known == index) {
                    Some((_, known)) => merge(known, value),
                    None => elements.push((index, value)),
                }
            }
        }
        (_, kind) => into.kind = kind,
    }
}

fn array(list: Vec<(u64, Node)>) -> Node {
    let mut node = Node::new("arrayValue");
    for run in list.chunk_by(|(_, a), (_, b)| a == b) {
        let count: u64 = run.iter().map(|(count, _)| count).sum();
        let mut value = Node::new("value");
        if count != 1 {
            value.attributes.push(("repetitionValue", count.to_string()));
        }
        node.push(value.child(run[0].1.clone()));
    }
    node
}

fn simple(value: &Expr, writer: &mut Writer) -> Node {
    let text = expression::text(value, writer);
    Node::new("simpleValue").with("value", text)
}

pub fn bound(bound: &Bound, writer: &mut Writer) -> String {
    match bound {
        Bound::Number(number, _) => number.to_string(),
        Bound::Name(name, _) => identifier(name),
        Bound::Expr(value) => expression::text(value, writer),
        Bound::Path(path) => crate::operand::path_text(path, writer),
    }
}

/// Reports names that are the same in the file.
pub fn unique<'s>(names: impl Iterator<Item = (&'s str, Span)>, writer: &mut Writer) {
    let mut known: Vec<String> = Vec::new();
    for (name, span) in names {
        let written = identifier(name).to_lowercase();
        if known.contains(&written) {
            let title = format!("two variables would be called `{written}` in PLCopen XML");
            writer.refuse(span, title, "give them names of letters, digits and `_`");
        }
        known.push(written);
    }
}
