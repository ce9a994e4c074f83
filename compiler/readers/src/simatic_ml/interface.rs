//! Interfaces: `Sections` with their members.

use plcc_diag::Span;
use plcc_literal::distance::nearest;
use roxmltree::Node;

use super::data_type;
use super::initial;
use super::reader::{Reader, first_text};
use super::schema;
use crate::xml::{attribute_range, child, children, elements, head, text_of};
use plcc_syntax::ast::{Constant, Retain, Section, SectionKind, TypeKind, TypeRef, Variable};
use plcc_syntax::scl::ast::{Expr, ExprKind};

/// How deep structures may be nested.
const DEPTH_MAX: usize = 64;

/// The declarations of a block.
#[derive(Default)]
pub struct Interface {
    pub sections: Vec<Section>,
    pub constants: Vec<Constant>,
    /// The result type of the function; `None` for VOID.
    pub return_type: Option<TypeRef>,
}

/// The sections of an object: in `Interface`, or right below its attributes.
pub fn sections<'a, 'i>(object: Node<'a, 'i>) -> Option<Node<'a, 'i>> {
    let interface = super::reader::setting(object, "Interface")?;
    child(interface, "Sections")
}

/// Whether the sections are those of a block in GRAPH: they have the members of every sequence.
fn is_chart(sections: Option<Node>) -> bool {
    let is_base = |section: Node| section.attribute("Name") == Some("Base");
    sections.is_some_and(|sections| children(sections, "Section").any(is_base))
}

/// Whether a member holds data of steps, transitions or the sequencer, which the chart itself describes. `chart`: it belongs to a block in GRAPH.
/// Source: GRAPH reference B.1.
fn is_chart_data(member: Node, chart: bool) -> bool {
    let datatype = member.attribute("Datatype").unwrap_or_default().trim().trim_matches('"');
    datatype.starts_with("G7_") || chart && member.attribute("Name") == Some("RT_DATA")
}

/// Reads the sections of a block with code. `chart`: it is written in GRAPH; `whose`: the block, in messages.
pub fn read(reader: &mut Reader, sections: Option<Node>, chart: bool, whose: &str) -> Interface {
    let mut interface = Interface::default();
    if let Some(sections) = sections {
        schema::check(reader, sections, schema::Place::Declaration, whose);
    }
    for section in sections.iter().flat_map(|sections| children(*sections, "Section")) {
        let named = section.attribute("Name").unwrap_or_default();
        let kind = match known_section(reader, section, named, chart) {
            "Input" => SectionKind::Input,
            "Output" => SectionKind::Output,
            "InOut" => SectionKind::InOut,
            "Static" => SectionKind::Static,
            "Temp" => SectionKind::Temp,
            "Constant" => {
                let constants: Vec<Constant> =
                    children(section, "Member").map(|member| constant(reader, member)).collect();
                interface.constants.extend(constants);
                continue;
            }
            "Return" => {
                if let Some(member) = children(section, "Member").next() {
                    let ty = type_of(reader, member, 0);
                    interface.return_type = Some(ty).filter(|ty| ty.kind != TypeKind::Named("VOID".to_string()));
                }
                continue;
            }
            // `Base` of GRAPH belongs to the system.
            "Base" if chart => continue,
            _ if elements(section).next().is_none() => continue,
            name => {
                let title = format!("{whose} has no section `{name}`");
                let help = "the sections are Input, Output, InOut, Static, Temp, Constant and Return";
                reader.fault(attribute_range(section, "Name"), title, "its declarations are not read", help);
                continue;
            }
        };
        let own = |member: &Node| !(chart && kind == SectionKind::Static && is_chart_data(*member, chart));
        for member in children(section, "Member").filter(own) {
            let retain = match member.attribute("Remanence") {
                Some("Retain") => Retain::Retain,
                Some("SetInIDB") => Retain::DbSpecific,
                _ => Retain::Unsaid,
            };
            let variable = variable(reader, member, 0);
            match interface.sections.last_mut() {
                Some(last) if last.kind == kind && last.retain == retain => last.variables.push(variable),
                _ => {
                    let span = reader.span(head(section));
                    interface.sections.push(Section { kind, retain, variables: vec![variable], span });
                }
            }
        }
    }
    interface
}

/// The section that `named` names; of a misspelt name, which is reported, the one that is meant.
fn known_section<'n>(reader: &mut Reader, section: Node, named: &'n str, chart: bool) -> &'n str {
    const KNOWN: [&str; 7] = ["Input", "Output", "InOut", "Static", "Temp", "Constant", "Return"];
    let is_empty = elements(section).next().is_none();
    if KNOWN.contains(&named) || is_empty || named == "Base" && chart {
        return named;
    }
    let meant = match named.to_ascii_lowercase().as_str() {
        "in" => Some("Input"),
        "out" => Some("Output"),
        "stat" | "var" => Some("Static"),
        _ => nearest(named, KNOWN.into_iter()),
    };
    let Some(meant) = meant else { return named };
    let range = attribute_range(section, "Name");
    let title = format!("`{named}` is not a section of declarations");
    reader.fault(range, title, format!("read as `{meant}`"), format!("write `{meant}`"));
    meant
}

/// The members of all sections as components: of a data block or data type, which `whose` names in messages.
/// `instance`: the block is an instance.
pub fn components(reader: &mut Reader, sections: Option<Node>, instance: bool, whose: &str) -> Vec<Variable> {
    if let Some(sections) = sections {
        schema::check(reader, sections, schema::Place::Declaration, whose);
    }
    let chart = is_chart(sections);
    let sections = sections.iter().flat_map(|sections| children(*sections, "Section"));
    let sections = sections.filter(|section| section.attribute("Name") != Some("Base"));
    let members = sections.flat_map(|section| children(section, "Member"));
    // In other blocks a member may have the type of a step.
    let members: Vec<Node> = members.filter(|member| !(chart || instance) || !is_chart_data(*member, chart)).collect();
    members.into_iter().map(|member| variable(reader, member, 0)).collect()
}

/// Names of the members that a data block declares as retentive.
pub fn retained(object: Node) -> Vec<String> {
    remanent(object, "Retain")
}

/// Whether a data block declares members as not retentive. An export without defaults leaves that out.
pub fn says_not_retained(object: Node) -> bool {
    !remanent(object, "NonRetain").is_empty()
}

/// Names of the members with that retentivity.
fn remanent(object: Node, remanence: &str) -> Vec<String> {
    let all = sections(object);
    let members =
        all.iter().flat_map(|sections| children(*sections, "Section")).flat_map(|section| children(section, "Member"));
    members.filter(|member| member.attribute("Remanence") == Some(remanence)).map(name_of).collect()
}

fn constant(reader: &mut Reader, member: Node) -> Constant {
    let name_span = reader.name_span(member, "Name");
    let ty = type_of(reader, member, 0);
    if child(member, "StartValue").is_none() {
        let initial = initial::of_member(reader, member, &ty);
        return Constant { name: name_of(member), name_span, ty: Some(ty), value: None, initial };
    }
    let value = child(member, "StartValue").map(|value| {
        let value = reader.start_value(value).and_then(initial::expression);
        value.unwrap_or(Expr { kind: ExprKind::Error, span: name_span })
    });
    Constant { name: name_of(member), name_span, ty: Some(ty), value, initial: None }
}

fn name_of(member: Node) -> String {
    member.attribute("Name").unwrap_or_default().trim().to_string()
}

/// A member with its structure and its start value.
pub fn variable(reader: &mut Reader, member: Node, depth: usize) -> Variable {
    let name_span = reader.name_span(member, "Name");
    let ty = type_of(reader, member, depth);
    Variable {
        name: name_of(member),
        name_span,
        attributes: attributes(member),
        at: overlaid(reader, member),
        initial: initial::of_member(reader, member, &ty),
        ty,
        comment: child(member, "Comment").and_then(first_text),
    }
}

/// The attributes of members that are switches, with their names in sources and the value that is not written.
const SWITCHES: [(&str, &str, bool); 4] = [
    ("ExternalAccessible", "ExternalAccessible", true),
    ("ExternalVisible", "ExternalVisible", true),
    ("ExternalWritable", "ExternalWritable", true),
    ("SetPoint", "S7_SetPoint", false),
];

/// The attributes of a declaration that have no effect on the program: the version of its system block, and what panels may do.
fn attributes(member: Node) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let is_own = member.attribute("Datatype").is_none_or(|ty| ty.contains('"'));
    if let Some(version) = member.attribute("Version").filter(|_| !is_own) {
        found.push(("LibVersion".to_string(), version.trim().to_string()));
    }
    for switch in child(member, "AttributeList").into_iter().flat_map(|list| children(list, "BooleanAttribute")) {
        let row = SWITCHES.iter().find(|(name, ..)| switch.attribute("Name") == Some(*name));
        if let Some((_, source, usual)) = row {
            let is_set = text_of(switch).eq_ignore_ascii_case("true");
            if is_set != *usual {
                found.push(((*source).to_string(), if is_set { "True" } else { "False" }.to_string()));
            }
        }
    }
    found
}

/// The type of a member; a `Struct`, or an array of them, has its members below it.
fn type_of(reader: &mut Reader, member: Node, depth: usize) -> TypeRef {
    let range = attribute_range(member, "Datatype");
    if member.attribute("Datatype").is_none_or(|ty| ty.trim().is_empty()) {
        let title = format!("the member `{}` has no data type", name_of(member));
        reader.fault(range.clone(), title, "`Datatype` is missing", "write its type, as in `Datatype=\"Int\"`");
    }
    let text = member.attribute("Datatype").filter(|ty| !ty.trim().is_empty()).unwrap_or("Int");
    let Some(range) = reader.overlay.place(text, range.start, range) else {
        return TypeRef { kind: TypeKind::Named(text.to_uppercase()), span: reader.span(head(member)) };
    };
    let mut ty = data_type::read(reader, range);
    if depth < DEPTH_MAX
        && let Some(members) = structure(&mut ty)
    {
        let below = children(member, "Member");
        let nested = child(member, "Sections").into_iter().flat_map(|sections| children(sections, "Section"));
        let nested = nested.flat_map(|section| children(section, "Member"));
        let found: Vec<Node> = below.chain(nested).collect();
        *members = found.into_iter().map(|member| variable(reader, member, depth + 1)).collect();
    }
    ty
}

/// The members of the structure that a type is or is an array of.
fn structure(ty: &mut TypeRef) -> Option<&mut Vec<Variable>> {
    match &mut ty.kind {
        TypeKind::Struct(members) => Some(members),
        TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } => structure(element),
        _ => None,
    }
}

/// The variable that a member is a view of (AT).
fn overlaid(reader: &mut Reader, member: Node) -> Option<(String, Span)> {
    let list = child(member, "AttributeList")?;
    let at = children(list, "StringAttribute").find(|attribute| attribute.attribute("Name") == Some("At"))?;
    let name = text_of(at).trim_matches(['"', '#']).to_string();
    let range = at.first_child().map_or_else(|| head(at), |text| text.range());
    let placed = reader.overlay.place(&name, range.start, range.clone());
    (!name.is_empty()).then(|| (name, reader.span(placed.unwrap_or(range))))
}
