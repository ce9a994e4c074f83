//! Declarations: sections, members and their start values.

use std::ops::Range;

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    Bound, CodeBlock, CodeKind, Constant, InitialKind, InitialValue, PathPart, PathRoot, Retain, Section, SectionKind,
    TypeKind, TypeRef, ValueAssignment, Variable,
};
use plcc_syntax::literal::Literal;

use super::{Library, elements, referred};
use crate::frames::{bare, places_of_declarations};
use crate::node::Node;
use crate::scl::expression;
use crate::writer::Writer;

/// The interface of a block with code.
pub fn of_code(block: &CodeBlock, library: &Library, writer: &mut Writer) -> Node {
    let mut sections = sections();
    let is_fb = matches!(block.kind, CodeKind::Fb | CodeKind::Sfb);
    let kinds: &[(SectionKind, &str)] = match block.kind {
        CodeKind::Ob => &[(SectionKind::Input, "Input"), (SectionKind::Temp, "Temp")],
        CodeKind::Fc | CodeKind::Sfc | CodeKind::Fb | CodeKind::Sfb => &[
            (SectionKind::Input, "Input"),
            (SectionKind::Output, "Output"),
            (SectionKind::InOut, "InOut"),
            (SectionKind::Static, "Static"),
            (SectionKind::Temp, "Temp"),
        ],
    };
    // Comments are met in the order of the text.
    let mut order: Vec<usize> = (0..block.sections.len()).collect();
    order.sort_by_key(|at| block.sections[*at].span.start);
    let declared = places_of_declarations(block);
    let first_constant = block.constants.first().map(|constant| constant.name_span.start);
    let first_constant = first_constant.filter(|at| declared.contains(at));
    let mut constants = None;
    let mut members: Vec<Vec<Node>> = vec![Vec::new(); block.sections.len()];
    for at in order {
        let section = &block.sections[at];
        if constants.is_none() && first_constant.is_some_and(|first| first < section.span.start) {
            constants = Some(of_constants(&block.constants, &declared, library, writer));
        }
        members[at] = of_section(section, library, writer);
    }
    let constants = constants.unwrap_or_else(|| of_constants(&block.constants, &declared, library, writer));
    for (kind, name) in kinds {
        let is_own = |section: &Section| section.kind == *kind;
        if *kind == SectionKind::Static && !is_fb && !block.sections.iter().any(is_own) {
            continue;
        }
        let mut node = Node::new("Section").with("Name", name);
        for (_, own) in block.sections.iter().zip(&members).filter(|(section, _)| is_own(section)) {
            node.children.extend(own.iter().cloned());
        }
        sections.push(node);
    }
    sections.push(constants);
    if matches!(block.kind, CodeKind::Fc | CodeKind::Sfc) {
        let member = match &block.return_type {
            Some(ty) => typed("Ret_Val", ty, library, writer),
            None => Node::new("Member").with("Name", "Ret_Val").with("Datatype", "Void"),
        };
        sections.push(Node::new("Section").with("Name", "Return").child(member));
    }
    Node::new("Interface").child(sections)
}

/// The members of a section.
fn of_section(section: &Section, library: &Library, writer: &mut Writer) -> Vec<Node> {
    let mut found = Vec::new();
    for variable in &section.variables {
        let mut member = member(variable, library, writer);
        match section.retain {
            Retain::Retain => member.attributes.push(("Remanence", "Retain".to_string())),
            Retain::DbSpecific => member.attributes.push(("Remanence", "SetInIDB".to_string())),
            Retain::NonRetain | Retain::Unsaid => {}
        }
        found.push(member);
    }
    // What stands at the end of a section is not about the next one.
    if let Some(last) = found.last_mut() {
        let mut rest = writer.trivia.before(section.span.end);
        rest.retain(|remark| !writer.is_written(&remark.text));
        let lines: Vec<String> = rest.iter().map(|remark| bare(&remark.text)).collect();
        add_comment(last, &lines);
    }
    found
}

/// `declared`: where the declarations of the block are.
fn of_constants(constants: &[Constant], declared: &Range<u32>, library: &Library, writer: &mut Writer) -> Node {
    let mut section = Node::new("Section").with("Name", "Constant");
    for constant in constants {
        let Some(ty) = &constant.ty else {
            let title = format!("SimaticML has no constant without a type: `{}`", constant.name);
            writer.refuse(constant.name_span, title, "declare it in VAR CONSTANT, with its type");
            continue;
        };
        let mut remarks = Vec::new();
        let is_own = declared.contains(&constant.name_span.start);
        if is_own {
            remarks = writer.trivia.before(constant.name_span.start);
            remarks.retain(|remark| !writer.is_written(&remark.text));
        }
        let mut node = typed(&constant.name, ty, library, writer);
        if is_own {
            let end = constant.value.as_ref().map(|value| value.span.end);
            let end = end.or(constant.initial.as_ref().map(|value| value.span.end)).unwrap_or(ty.span.end);
            remarks.extend(writer.trivia.on_line(end));
        }
        let lines: Vec<String> = remarks.iter().map(|remark| bare(&remark.text)).collect();
        add_comment(&mut node, &lines);
        if let Some(value) = &constant.value {
            node.push(Node::of("StartValue", expression::text(value, writer)));
        } else if let Some(value) = &constant.initial {
            start_values(value, ty, &mut node, library, writer);
        }
        section.push(node);
    }
    section
}

/// Adds lines to the comment of a member.
fn add_comment(member: &mut Node, lines: &[String]) {
    if lines.is_empty() {
        return;
    }
    let text = lines.join("\n");
    let own = member.children.iter_mut().find(|child| child.name == "Comment");
    match own.and_then(|comment| comment.children.first_mut()) {
        Some(own) => own.text = Some(format!("{}\n{text}", own.text.as_deref().unwrap_or_default())),
        None => {
            // Values come after it.
            let is_value = |child: &Node| matches!(child.name, "StartValue" | "Subelement" | "Sections");
            let at = member.children.iter().position(is_value).unwrap_or(member.children.len());
            let text = Node::of("MultiLanguageText", text).with("Lang", "en-US");
            member.children.insert(at, Node::new("Comment").child(text));
        }
    }
}

fn sections() -> Node {
    Node::new("Sections").with("xmlns", "http://www.siemens.com/automation/Openness/SW/Interface/v5")
}

/// The interface of a data block or a data type.
pub fn of_members(
    section: &str,
    members: &[Variable],
    retained: &[String],
    library: &Library,
    writer: &mut Writer,
) -> Node {
    let mut node = Node::new("Section").with("Name", section);
    for variable in members {
        let mut member = member(variable, library, writer);
        if retained.iter().any(|name| name.eq_ignore_ascii_case(&variable.name)) {
            member.attributes.push(("Remanence", "Retain".to_string()));
        }
        node.push(member);
    }
    Node::new("Interface").child(sections().child(node))
}

/// Gives the members that say nothing about retentivity what holds for the whole block.
pub fn set_remanence(interface: &mut Node, remanence: &str) {
    let sections = interface.children.iter_mut().flat_map(|sections| sections.children.iter_mut());
    for member in sections.flat_map(|section| section.children.iter_mut()) {
        if !member.attributes.iter().any(|(key, _)| *key == "Remanence") {
            member.attributes.push(("Remanence", remanence.to_string()));
        }
    }
}

fn member(variable: &Variable, library: &Library, writer: &mut Writer) -> Node {
    let mut remarks = writer.trivia.before(variable.name_span.start);
    remarks.retain(|remark| !writer.is_written(&remark.text));
    // What is on the line of a structure is about it, not about its first member.
    let mut beside = writer.trivia.on_line(variable.name_span.end);
    let mut node = typed(&variable.name, &variable.ty, library, writer);
    if let Some((at, _)) = &variable.at {
        let attribute = Node::of("StringAttribute", at.as_str()).with("Name", "At").with("SystemDefined", "true");
        node.children.insert(0, Node::new("AttributeList").child(attribute));
    }
    for (key, value) in &variable.attributes {
        if !attribute(key, value, &mut node) {
            let title = format!("the attribute `{key}` of `{}` is not in the file", variable.name);
            writer.warn(variable.name_span, title, "set it in the editor again");
        }
    }
    let end = variable.initial.as_ref().map_or(variable.ty.span.end, |value| value.span.end);
    let mut comments: Vec<String> = Vec::new();
    beside.extend(writer.trivia.on_line(end.max(variable.name_span.end)));
    let texts = remarks.iter().map(|remark| bare(&remark.text)).chain(variable.comment.clone());
    for text in texts.chain(beside.iter().map(|remark| bare(&remark.text))) {
        if !comments.contains(&text) {
            comments.push(text);
        }
    }
    if !comments.is_empty() {
        let text = Node::of("MultiLanguageText", comments.join("\n")).with("Lang", "en-US");
        node.push(Node::new("Comment").child(text));
    }
    if let Some(value) = &variable.initial {
        start_values(value, &variable.ty, &mut node, library, writer);
    }
    node
}

/// Attributes of declarations that are switches, with their names in the file.
const SWITCHES: [(&str, &str); 4] = [
    ("ExternalAccessible", "ExternalAccessible"),
    ("ExternalVisible", "ExternalVisible"),
    ("ExternalWritable", "ExternalWritable"),
    ("S7_SetPoint", "SetPoint"),
];

/// Gives a member an attribute of its declaration; `false`: the file has none like it.
fn attribute(key: &str, value: &str, member: &mut Node) -> bool {
    let is = |name: &str| key.eq_ignore_ascii_case(name);
    if is("LibVersion") {
        member.attributes.push(("Version", value.to_string()));
        return true;
    }
    if is("InstructionName") || is("OriginalPartName") {
        // The type says it.
        return member.attributes.iter().any(|(name, ty)| *name == "Datatype" && ty.eq_ignore_ascii_case(value.trim()));
    }
    let Some((_, name)) = SWITCHES.iter().find(|(source, _)| is(source)) else { return false };
    let is_set = match value.trim() {
        text if text.eq_ignore_ascii_case("true") => "true",
        text if text.eq_ignore_ascii_case("false") => "false",
        _ => return false,
    };
    let switch = Node::of("BooleanAttribute", is_set).with("Name", name).with("SystemDefined", "true");
    match member.children.iter_mut().find(|child| child.name == "AttributeList") {
        Some(list) => list.push(switch),
        None => member.children.insert(0, Node::new("AttributeList").child(switch)),
    }
    true
}

/// A member with its type, and the members of its structure.
fn typed(name: &str, ty: &TypeRef, library: &Library, writer: &mut Writer) -> Node {
    let mut node = Node::new("Member").with("Name", name).with("Datatype", type_text(ty, library, writer));
    if let Some(members) = structure(ty) {
        node.children.extend(members.iter().map(|one| member(one, library, writer)));
        if !matches!(ty.kind, TypeKind::Struct(_)) && !elements::spread(&mut node, ty) {
            refuse_at(ty.span, writer);
        }
    }
    node
}

fn structure(ty: &TypeRef) -> Option<&[Variable]> {
    match &ty.kind {
        TypeKind::Struct(members) => Some(members),
        TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } => structure(element),
        _ => None,
    }
}

/// A type as the export writes it.
pub fn type_text(ty: &TypeRef, library: &Library, writer: &mut Writer) -> String {
    match &ty.kind {
        TypeKind::Named(name) => cased(name),
        TypeKind::String(length) => sized("String", length.as_ref(), writer),
        TypeKind::WideString(length) => sized("WString", length.as_ref(), writer),
        TypeKind::Array { bounds, element } => {
            let list: Vec<String> =
                bounds.iter().map(|(low, high)| format!("{}..{}", bound(low, writer), bound(high, writer))).collect();
            format!("Array[{}] of {}", list.join(", "), type_text(element, library, writer))
        }
        TypeKind::OpenArray { dimensions, element } => {
            let stars = vec!["*"; usize::from(*dimensions)].join(", ");
            format!("Array[{stars}] of {}", type_text(element, library, writer))
        }
        TypeKind::Reference(target) => format!("REF_TO {}", type_text(target, library, writer)),
        TypeKind::Struct(_) => "Struct".to_string(),
        TypeKind::Block(name) => match library.standard_name(name) {
            Some(standard) => standard.to_string(),
            None => format!("\"{}\"", referred(name, library, writer)),
        },
        TypeKind::Error => {
            writer.refuse(ty.span, "a type that was not understood", "repair the source first");
            String::new()
        }
    }
}

fn sized(name: &str, length: Option<&Bound>, writer: &mut Writer) -> String {
    length.map_or_else(|| name.to_string(), |length| format!("{name}[{}]", bound(length, writer)))
}

fn bound(bound: &Bound, writer: &mut Writer) -> String {
    match bound {
        Bound::Number(number, _) => number.to_string(),
        Bound::Name(name, _) => format!("\"{name}\""),
        Bound::Expr(value) => expression::text(value, writer),
        Bound::Path(path) => crate::operand::path_text(path, writer),
    }
}

/// `INT` as the editor writes it: `Int`.
pub fn cased(name: &str) -> String {
    const WORDS: [&str; 22] = [
        "Bool", "Byte", "Word", "DWord", "LWord", "SInt", "USInt", "Int", "UInt", "DInt", "UDInt", "LInt", "ULInt",
        "Real", "LReal", "Char", "WChar", "Time", "LTime", "Date", "Variant", "S5Time",
    ];
    let known = WORDS.iter().find(|word| word.eq_ignore_ascii_case(name));
    let elementary = || Elementary::ALL.iter().find(|ty| ty.name().eq_ignore_ascii_case(name));
    match known {
        Some(word) => (*word).to_string(),
        None => elementary().map_or_else(|| name.to_string(), |ty| ty.name().to_string()),
    }
}

// Start values.

/// Gives a member its start value, its elements or its components theirs.
fn start_values(value: &InitialValue, ty: &TypeRef, node: &mut Node, library: &Library, writer: &mut Writer) {
    values_at(&[], value, ty, node, library, writer);
}

/// The same, of the elements of all arrays around with these indices.
fn values_at(
    around: &[i64],
    value: &InitialValue,
    ty: &TypeRef,
    node: &mut Node,
    library: &Library,
    writer: &mut Writer,
) {
    match (&value.kind, &ty.kind) {
        (InitialKind::Elements(elements), _) => {
            let of = match &ty.kind {
                TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } => element,
                _ => ty,
            };
            for (index, value) in elements {
                values_at(&[around, index].concat(), value, of, node, library, writer);
            }
        }
        (InitialKind::List(_) | InitialKind::Repeat { .. }, TypeKind::Array { .. }) => {
            let Some((values, element)) = elements::of_list(value, ty) else { return refuse(value, writer) };
            for (index, value) in values {
                values_at(&[around, &index].concat(), value, element, node, library, writer);
            }
        }
        // `()`: what its type says.
        (InitialKind::Fields(fields), _) if fields.is_empty() => {}
        (InitialKind::Fields(fields), _) => {
            let Some(members) = library.members(ty) else { return refuse(value, writer) };
            for (at, (name, value)) in fields.iter().enumerate() {
                let known = match name {
                    Some(name) => members.iter().find(|member| member.name.eq_ignore_ascii_case(&name.text)),
                    None => members.get(at),
                };
                let Some(known) = known else { return refuse(value, writer) };
                let part = component(node, known, ty, library, writer);
                values_at(around, value, &known.ty, part, library, writer);
            }
        }
        (InitialKind::Default, _) => {}
        _ => match text(value, writer).map(|text| without_type(text, value, ty)) {
            Some(text) if around.is_empty() => node.push(Node::of("StartValue", text)),
            Some(text) => {
                let path: Vec<String> = around.iter().map(i64::to_string).collect();
                let start = Node::of("StartValue", text);
                node.push(Node::new("Subelement").with("Path", path.join(",")).child(start));
            }
            None => refuse(value, writer),
        },
    }
}

/// The component of a member: that of its declaration, or one below its data type.
fn component<'n>(
    node: &'n mut Node,
    known: &Variable,
    ty: &TypeRef,
    library: &Library,
    writer: &mut Writer,
) -> &'n mut Node {
    let is = |child: &Node| {
        child.name == "Member" && child.attributes.iter().any(|(key, own)| *key == "Name" && *own == known.name)
    };
    if let Some(at) = node.children.iter().position(is) {
        return &mut node.children[at];
    }
    let section = match structure(ty) {
        // The members of a structure are right below it.
        Some(_) => node,
        None => {
            let sections = node.children.iter().position(|child| child.name == "Sections").unwrap_or_else(|| {
                let section = Node::new("Section").with("Name", "None");
                node.push(Node::new("Sections").with("Datatype", type_text(ty, library, writer)).child(section));
                node.children.len() - 1
            });
            &mut node.children[sections].children[0]
        }
    };
    let at = section.children.iter().position(is).unwrap_or_else(|| {
        let member = Node::new("Member").with("Name", &known.name);
        section.children.push(member.with("Datatype", type_text(&known.ty, library, writer)));
        section.children.len() - 1
    });
    &mut section.children[at]
}

fn refuse(value: &InitialValue, writer: &mut Writer) {
    refuse_at(value.span, writer);
}

fn refuse_at(span: Span, writer: &mut Writer) {
    let help = "add the source of its data type, or assign the value in the program";
    writer.refuse(span, "SimaticML has no form for this start value", help);
}

/// The value of a constant of STL without the type of its member in front of it: `16#1F` of `B#16#1F`.
fn without_type(text: String, value: &InitialValue, ty: &TypeRef) -> String {
    const WORDS: [(&str, &str); 5] = [("BYTE", "B"), ("WORD", "W"), ("DWORD", "DW"), ("INT", "INT"), ("DINT", "L")];
    let (InitialKind::Literal(_), TypeKind::Named(name)) = (&value.kind, &ty.kind) else { return text };
    let Some((long, short)) = WORDS.iter().find(|(long, _)| long == name) else { return text };
    let typed = text.split_once('#').filter(|(word, _)| [long, short].iter().any(|own| word.eq_ignore_ascii_case(own)));
    match typed.map(|(_, value)| value.to_string()) {
        Some(value) => value,
        None => text,
    }
}

/// A simple value as text.
fn text(value: &InitialValue, writer: &mut Writer) -> Option<String> {
    match &value.kind {
        InitialKind::Expr(value) => Some(expression::text(value, writer)),
        // Expressions of networks have no such constants.
        InitialKind::Literal(literal @ Literal::DateAndTime(_)) => Some(writer.slice(value.span, literal)),
        InitialKind::Literal(Literal::Real(number)) => Some(writer.number(value.span, *number)),
        InitialKind::Literal(literal) => {
            let value = crate::to_graph::constant(literal, value.span).ok()?;
            Some(expression::text(&value, writer))
        }
        _ => None,
    }
}

/// Gives a component of a data block another start value than its declaration. `members`: what the block consists of; the section has
/// all of them, or gets those that have values.
pub fn replace_value(
    section: &mut Node,
    value: &ValueAssignment,
    members: &[Variable],
    library: &Library,
    writer: &mut Writer,
) -> bool {
    let first = match &value.target.root {
        PathRoot::Local { name, .. } | PathRoot::Bare { name, .. } | PathRoot::Quoted { name, .. } => name,
        PathRoot::Block(_) => return false,
    };
    let Some(known) = named(members, first) else { return false };
    let is = |child: &Node| child.attributes.iter().any(|(key, own)| *key == "Name" && *own == known.name);
    let at = section.children.iter().position(is).unwrap_or_else(|| {
        let member = Node::new("Member").with("Name", &known.name);
        section.push(member.with("Datatype", type_text(&known.ty, library, writer)));
        section.children.len() - 1
    });
    let mut node = &mut section.children[at];
    let mut ty = &known.ty;
    let mut around = Vec::new();
    for part in &value.target.parts {
        match part {
            PathPart::Member { name, .. } => {
                let Some(known) = library.members(ty).and_then(|members| named(members, name)) else { return false };
                node = component(node, known, ty, library, writer);
                ty = &known.ty;
            }
            PathPart::Index { values, .. } => {
                let TypeKind::Array { element, .. } = &ty.kind else { return false };
                for value in values {
                    let Bound::Number(number, _) = value else { return false };
                    around.push(*number);
                }
                ty = element;
            }
        }
    }
    let path = around.iter().map(i64::to_string).collect::<Vec<_>>().join(",");
    let inside = format!("{path},");
    node.children.retain(|child| match child.name {
        "StartValue" => !around.is_empty(),
        "Subelement" => {
            let own = child.attributes.iter().find(|(key, _)| *key == "Path").map_or("", |(_, own)| own.as_str());
            !around.is_empty() && own != path && !own.starts_with(&inside)
        }
        _ => true,
    });
    values_at(&around, &value.value, ty, node, library, writer);
    true
}

fn named<'m>(members: &'m [Variable], name: &str) -> Option<&'m Variable> {
    members.iter().find(|member| member.name.eq_ignore_ascii_case(name))
}

/// Members of an instance with the values that differ from those of its block.
pub fn of_values(values: &[ValueAssignment], ty: &TypeRef, library: &Library, writer: &mut Writer) -> Node {
    let mut section = Node::new("Section").with("Name", "Static");
    let members = library.members(ty).unwrap_or_default();
    for value in values {
        if !replace_value(&mut section, value, members, library, writer) {
            let help = "add the source of its function block, or assign the value in the program";
            writer.refuse(value.span, "SimaticML has no form for this value of an instance", help);
        }
    }
    Node::new("Interface").child(sections().child(section))
}
