//! Interfaces of blocks as their calls describe them: `CallInfo` names each parameter with its section and type. They replace a block
//! whose source is missing.

use std::collections::HashSet;

use roxmltree::{Document, Node};

use super::data_type;
use super::reader::Reader;
use crate::xml::{attribute_range, children, elements, is};
use plcc_syntax::ast::{
    BlockName, Code, CodeBlock, CodeKind, Header, Retain, Section, SectionKind, TypeKind, TypeRef, Variable,
};
use plcc_syntax::scl::ast::Body;

/// The interfaces of all blocks that a file calls, one for each name. Read them after everything else has been written to the overlay.
pub fn read(reader: &mut Reader, document: &Document) -> Vec<CodeBlock> {
    let mut known = HashSet::new();
    let mut outlines = Vec::new();
    for info in document.descendants().filter(|node| is(*node, "CallInfo")) {
        let kind = match info.attribute("BlockType") {
            Some("FB") => CodeKind::Fb,
            Some("FC") => CodeKind::Fc,
            _ => continue,
        };
        let Some(name) = info.attribute("Name").map(str::trim).filter(|name| !name.is_empty()) else { continue };
        if known.insert(name.to_lowercase()) {
            outlines.extend(outline(reader, info, name, kind));
        }
    }
    outlines
}

/// `None`: the call does not describe the whole interface.
fn outline(reader: &mut Reader, info: Node, name: &str, kind: CodeKind) -> Option<CodeBlock> {
    if elements(info).any(|part| is(part, "NamelessParameter")) {
        return None;
    }
    let span = reader.span(attribute_range(info, "Name"));
    let mut sections: Vec<Section> = Vec::new();
    let mut return_type = None;
    for parameter in children(info, "Parameter") {
        let ty = type_of(reader, parameter)?;
        let name_span = reader.span(attribute_range(parameter, "Name"));
        let section = match parameter.attribute("Section")? {
            "Input" => SectionKind::Input,
            "Output" => SectionKind::Output,
            "InOut" => SectionKind::InOut,
            "Return" => {
                return_type = Some(ty).filter(|ty| ty.kind != TypeKind::Named("VOID".to_string()));
                continue;
            }
            _ => return None,
        };
        let name = parameter.attribute("Name")?.to_string();
        let (attributes, at, initial, comment) = (Vec::new(), None, None, None);
        let variable = Variable { name, name_span, attributes, at, ty, initial, comment };
        match sections.iter_mut().find(|known| known.kind == section) {
            Some(known) => known.variables.push(variable),
            None => sections.push(Section {
                kind: section,
                retain: Retain::Unsaid,
                variables: vec![variable],
                span: name_span,
            }),
        }
    }
    Some(CodeBlock {
        kind,
        name: BlockName::Symbol { name: name.to_string(), span },
        return_type,
        header: Header::default(),
        sections,
        constants: Vec::new(),
        code: Code::Scl(Body::default()),
        span,
    })
}

fn type_of(reader: &mut Reader, parameter: Node) -> Option<TypeRef> {
    let text = parameter.attribute("Type")?;
    let range = attribute_range(parameter, "Type");
    let range = reader.overlay.place(text, range.start, range)?;
    Some(data_type::read(reader, range))
}
