//! Networks: the compile units of a block, each in its language.

use plcc_diag::Severity;
use roxmltree::Node;

use super::block::SAFETY;
use super::reader::{Reader, multilingual, setting, setting_text};
use super::{graph, parts, schema, statements, tokens};
use crate::xml::{child, elements, head, is};
use plcc_syntax::network::ast::{Content, Graph, Language, Network};
use plcc_syntax::scl::ast::Name;

/// The compile units of a block.
pub fn compile_units<'a, 'i>(object: Node<'a, 'i>) -> Vec<Node<'a, 'i>> {
    let list = child(object, "ObjectList");
    list.into_iter().flat_map(elements).filter(|unit| is(*unit, "SW.Blocks.CompileUnit")).collect()
}

/// Reads a network. `number` counts from 1; `default`: language of the block.
pub fn read(reader: &mut Reader, unit: Node, number: usize, block: &str, default: &str) -> Network {
    let title = multilingual(unit, "Title");
    let whose = match &title {
        Some(title) => format!("network {number} (`{title}`) of `{block}`"),
        None => format!("network {number} of `{block}`"),
    };
    let named = setting_text(unit, "ProgrammingLanguage").unwrap_or_else(|| default.to_string());
    let mut sources = setting(unit, "NetworkSource").into_iter().flat_map(elements);
    let source = sources.next();
    if let Some(other) = sources.next() {
        reader.refuse(other, &whose, "code twice");
    }
    // A safety network must be in a safety block.
    let stray = named.starts_with(SAFETY) && !default.starts_with(SAFETY);
    let language = language_of(&named, source.map(|source| source.tag_name().name())).filter(|_| !stray);
    let (labels, content) = content(reader, unit, source, (language, &named), &whose);
    let comment = multilingual(unit, "Comment").map(|text| text.lines().map(str::to_string).collect());
    Network {
        language: language.unwrap_or(Language::Lad),
        title,
        comment: comment.unwrap_or_default(),
        labels,
        content,
        span: reader.span(head(unit)),
    }
}

/// The contents of a network, and its labels. `language`: with its name in the file; `unit`: the node that contains the network.
pub fn content(
    reader: &mut Reader,
    unit: Node,
    source: Option<Node>,
    language: (Option<Language>, &str),
    whose: &str,
) -> (Vec<Name>, Content) {
    let (language, named) = language;
    let mut labels = Vec::new();
    let content = match (language, source) {
        (Some(language @ (Language::Lad | Language::Fbd)), Some(source)) if is(source, "FlgNet") => {
            match parts::read(reader, source, whose) {
                Ok(mut found) => {
                    labels = std::mem::take(&mut found.labels);
                    Content::Graphic(graph::build(found, language))
                }
                Err(_) => Content::Graphic(Graph::default()),
            }
        }
        (Some(Language::Scl), Some(source)) if is(source, "StructuredText") => {
            Content::Scl(tokens::read(reader, source, whose).unwrap_or_default())
        }
        (Some(Language::Stl), Some(source)) if is(source, "StatementList") => {
            Content::Stl(statements::read(reader, source, whose).unwrap_or_default())
        }
        // An empty network.
        (Some(Language::Scl), None) => Content::Scl(Vec::new()),
        (Some(Language::Stl), None) => Content::Stl(Vec::new()),
        (Some(_), None) => Content::Graphic(Graph::default()),
        (None, None) => {
            reader.refuse(unit, whose, &format!("nothing but the name of the language {named}"));
            if let Some(message) = reader.diagnostics.last_mut() {
                message.severity = Severity::Warning;
            }
            Content::Graphic(Graph::default())
        }
        (_, Some(source)) => {
            let what = if named.starts_with(SAFETY) {
                format!("fail-safe code ({named})")
            } else {
                format!("code in {named} (`{}`)", source.tag_name().name())
            };
            reader.refuse(source, whose, &what);
            Content::Graphic(Graph::default())
        }
    };
    if let Some(source) = source {
        schema::check(reader, source, schema::Place::Code, whose);
    }
    (labels, content)
}

/// The language from its name; without a usable name, from the element of the source.
pub fn language_of(name: &str, source: Option<&str>) -> Option<Language> {
    // Only the code that the TIA Portal generates from a network is fail-safe.
    match (name.strip_prefix(SAFETY).unwrap_or(name), source) {
        (name, _) if name.starts_with("LAD") => Some(Language::Lad),
        (name, _) if name.starts_with("FBD") => Some(Language::Fbd),
        ("STL", _) => Some(Language::Stl),
        ("SCL", _) => Some(Language::Scl),
        ("" | "Undef", Some("FlgNet")) => Some(Language::Lad),
        ("" | "Undef", Some("StatementList")) => Some(Language::Stl),
        ("" | "Undef", Some("StructuredText")) => Some(Language::Scl),
        _ => None,
    }
}
