//! Networks: the compile units of a block, each in its language.

use std::collections::HashSet;

use plcc_diag::{Code, Diagnostic, Severity};
use plcc_literal::distance::nearest;
use roxmltree::Node;

use super::block::SAFETY;
use super::parts::{End, Parts};
use super::reader::{Reader, multilingual, setting};
use super::{graph, parts, schema, statements, tokens};
use crate::xml::{child, elements, head, is, text_of};
use plcc_syntax::network::ast::{Content, Graph, Language, Network};
use plcc_syntax::network::elements::Kind;
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
    let named = named_language(reader, unit).unwrap_or_else(|| default.to_string());
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
                    open_inputs(reader, &found, whose);
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
            let element = source.tag_name().name();
            if named.starts_with(SAFETY) {
                reader.refuse(source, whose, &format!("fail-safe code ({named})"));
            } else if language.is_some() && code_of(element) != code_of("") {
                let title = format!("{whose} names the language {named}, but its code is {}", code_of(element));
                let help = format!(
                    "write a language in `ProgrammingLanguage` that has `{element}`, or export the block again"
                );
                reader.fault(head(source), title, format!("`{element}` is {}", code_of(element)), help);
            } else {
                reader.refuse(source, whose, &format!("code in {named} (`{element}`)"));
            }
            Content::Graphic(Graph::default())
        }
    };
    if let Some(source) = source {
        schema::check(reader, source, schema::Place::Code, whose);
    }
    (labels, content)
}

/// Reports sums and similar boxes with an input after the second one that nothing feeds. What every box needs is checked for all files alike.
fn open_inputs(reader: &mut Reader, found: &Parts, whose: &str) {
    let mut fed: HashSet<(usize, &str)> = HashSet::new();
    for wire in &found.wires {
        let feeds = |end: &End| matches!(end, End::Rail | End::Operand(_) | End::Pin { output: true, .. });
        if wire.ends.iter().any(feeds) {
            fed.extend(wire.ends.iter().filter_map(|end| match end {
                End::Pin { part, name, output: false, .. } => Some((*part, name.as_str())),
                End::Pin { .. } | End::Rail | End::Operand(_) | End::Open => None,
            }));
        }
    }
    for (at, part) in found.parts.iter().enumerate() {
        let (Some(row), Some(count)) = (part.row(), part.card) else { continue };
        if !matches!(row.kind, Kind::Operator(_) | Kind::Function("MIN" | "MAX")) {
            continue;
        }
        if let Some(open) = (3..=count).find(|number| !fed.contains(&(at, format!("in{number}").as_str()))) {
            let title = format!("`{}` has {count} inputs, but nothing is connected to `in{open}`", row.name);
            reader.diagnostics.push(
                Diagnostic::new(Code::MissingParameter, part.span, title)
                    .label(format!("in {whose}"))
                    .help(format!("connect `in{open}`, or write in `Card` how many inputs there are")),
            );
        }
    }
}

/// The languages of networks in LAD and FBD; the suffixes are those of old versions and of libraries.
const LADDER: [&str; 4] = ["LAD", "LAD_IEC", "LAD_CLASSIC", "LAD_LIB"];
const DIAGRAM: [&str; 4] = ["FBD", "FBD_IEC", "FBD_CLASSIC", "FBD_LIB"];
/// The other languages of blocks and networks.
#[rustfmt::skip]
const OTHERS: [&str; 23] = [
    "STL", "SCL", "GRAPH", "GRAPH_ACTIONS", "GRAPH_SEQUENCE", "GRAPH_ADDINFOS", "DB", "CPU_DB", "Motion_DB", "CALL", "FB_IDB", "CFC", "SFC",
    "CEM", "ProDiag", "ProDiag_OB", "S7_PDIAG", "RSE", "SDB", "FCP", "FLD", "Annotation", "Undef",
];

/// The language from its name; without a usable name, from the element of the source.
pub fn language_of(name: &str, source: Option<&str>) -> Option<Language> {
    // Only the code that the TIA Portal generates from a network is fail-safe.
    match (name.strip_prefix(SAFETY).unwrap_or(name), source) {
        (name, _) if LADDER.contains(&name) => Some(Language::Lad),
        (name, _) if DIAGRAM.contains(&name) => Some(Language::Fbd),
        ("STL", _) => Some(Language::Stl),
        ("SCL", _) => Some(Language::Scl),
        ("" | "Undef", Some("FlgNet")) => Some(Language::Lad),
        ("" | "Undef", Some("StatementList")) => Some(Language::Stl),
        ("" | "Undef", Some("StructuredText")) => Some(Language::Scl),
        _ => None,
    }
}

/// The language that an object names. If the TIA Portal has none of this name, that is reported, and the one that is meant is returned.
pub fn named_language(reader: &mut Reader, object: Node) -> Option<String> {
    let node = setting(object, "ProgrammingLanguage")?;
    let named = text_of(node);
    let bare = named.strip_prefix(SAFETY).unwrap_or(&named);
    let known = || LADDER.into_iter().chain(DIAGRAM).chain(OTHERS);
    if named.is_empty() || known().any(|known| known == bare) {
        return Some(named).filter(|named| !named.is_empty());
    }
    let meant = match bare.to_ascii_uppercase().as_str() {
        "KOP" => Some("LAD"),
        "FUP" => Some("FBD"),
        "AWL" | "IL" => Some("STL"),
        "ST" => Some("SCL"),
        _ => nearest(bare, known()),
    };
    let range = node.first_child().map_or_else(|| head(node), |text| text.range());
    let message = Diagnostic::new(
        Code::ForeignContent,
        reader.span(range),
        format!("`{named}` is not a language of the TIA Portal"),
    )
    .label("neither LAD, FBD, STL, SCL nor GRAPH");
    reader.diagnostics.push(message.help(match meant {
        Some(meant) => format!("is `{meant}` meant?"),
        None => "write one of LAD, FBD, STL, SCL, GRAPH".to_string(),
    }));
    meant.map(str::to_string)
}

/// What the code in an element is.
fn code_of(element: &str) -> &'static str {
    match element {
        "FlgNet" => "LAD or FBD",
        "StructuredText" => "SCL",
        "StatementList" => "STL",
        "Graph" => "GRAPH",
        _ => "of another language",
    }
}
