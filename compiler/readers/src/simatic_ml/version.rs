//! Versions of exports. plcc reads V14 to V21 of the TIA Portal alike, by the names of elements; another version may mean something else
//! by the same names, which is a warning. Source: LAD/FBD reference A2.1.

use plcc_diag::{Code, Diagnostic, Severity, Span};
use roxmltree::{Document, Node};

use super::reader::Reader;
use crate::xml::{attribute_range, head, is};

/// Versions of the TIA Portal.
const KNOWN: std::ops::RangeInclusive<u32> = 14..=21;
/// Newest version of a part of an export: of its networks, interfaces, charts.
const PART_MAX: u32 = 9;
/// What the namespaces of these parts begin with.
const NAMESPACE: &str = "http://www.siemens.com/automation/Openness/SW/";

/// Warns of the first version that plcc does not know.
pub fn check(reader: &mut Reader, document: &Document) {
    let engineering = document.descendants().find(|node| is(*node, "Engineering"));
    let unknown = engineering.and_then(|node| of_portal(reader, node)).or_else(|| of_part(reader, document));
    reader.diagnostics.extend(unknown);
}

/// `<Engineering version="V17" />`
fn of_portal(reader: &Reader, node: Node) -> Option<Diagnostic> {
    let written = node.attribute("version")?;
    let number: String =
        written.trim().trim_start_matches(['V', 'v']).chars().take_while(char::is_ascii_digit).collect();
    if number.parse().is_ok_and(|number| KNOWN.contains(&number)) {
        return None;
    }
    let span = reader.span(attribute_range(node, "version"));
    Some(unknown(span, format!("`{written}` is not a version of the TIA Portal that plcc knows")))
}

fn of_part(reader: &Reader, document: &Document) -> Option<Diagnostic> {
    let parts = ["FlgNet", "StructuredText", "StatementList", "Graph", "Sections"];
    let mut parts = document.descendants().filter(|node| parts.contains(&node.tag_name().name()));
    parts.find_map(|node| {
        let namespace = node.tag_name().namespace()?;
        let version =
            namespace.strip_prefix(NAMESPACE).and_then(|rest| rest.rsplit_once("/v")).map(|(_, number)| number);
        if version.and_then(|number| number.parse().ok()).is_some_and(|number: u32| number <= PART_MAX) {
            return None;
        }
        let title = format!("`{namespace}` is not a version of `{}` that plcc knows", node.tag_name().name());
        let stated = document.input_text()[node.range()].find(namespace).map(|at| node.range().start + at);
        let range = stated.map_or_else(|| head(node), |start| start..start + namespace.len());
        Some(unknown(reader.span(range), title))
    })
}

fn unknown(span: Span, title: String) -> Diagnostic {
    let mut message = Diagnostic::new(Code::ForeignContent, span, title)
        .label("read as the export of a known version")
        .help("export the program with a version from V14 to V21, or compare what plcc has read: `plcc view` draws it");
    message.severity = Severity::Warning;
    message
}
