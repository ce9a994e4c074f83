//! Files in XML: their kind, by root element, and small helpers to walk through them.
//!
//! Names of elements are compared without their namespace, which changes with each version of the tool.

use plcc_diag::{Code, Diagnostic, FileId, Span};
use plcc_literal::distance::nearest;
use plcc_syntax::ast::Pragma;
use roxmltree::{Document, Error, Node};

/// The kind of a text in XML.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum XmlKind {
    /// An export of the TIA Portal.
    SimaticMl(Contents),
    /// An export of PLCopen TC6.
    PlcOpen,
    /// A tag table as the editor of the TIA Portal writes it.
    TagTable,
    /// Something else: the name of its root element.
    Other(String),
    /// It cannot be read as XML.
    Broken,
}

/// The contents of an export of the TIA Portal.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Contents {
    /// Blocks or data types.
    pub blocks: bool,
    /// Tables of tags and user constants.
    pub tags: bool,
    /// Other contents: the element name of the first object.
    pub other: Option<String>,
}

/// The kind of `text`; `None` if it is not XML.
pub fn kind(text: &str) -> Option<XmlKind> {
    if !text.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
        return None;
    }
    let Ok(document) = parse(text) else { return Some(XmlKind::Broken) };
    let root = document.root_element();
    let contents = contents(root);
    Some(match root.tag_name().name() {
        _ if contents.blocks || contents.tags => XmlKind::SimaticMl(contents),
        "Document" if contents.other.is_some() || child(root, "Engineering").is_some() => XmlKind::SimaticMl(contents),
        "project" if is_plcopen(root) => XmlKind::PlcOpen,
        name if is_tag_table(name) => XmlKind::TagTable,
        name => XmlKind::Other(name.to_string()),
    })
}

/// Whether a project is one of PLCopen: tools that build programs for computers have projects too.
fn is_plcopen(root: Node) -> bool {
    let parts = ["fileHeader", "contentHeader", "types", "instances"];
    root.tag_name().namespace().is_some_and(|namespace| namespace.contains("plcopen"))
        || parts.iter().any(|part| child(root, part).is_some())
}

/// The objects of an export are below its root, or one level deeper in files with several objects.
fn contents(root: Node) -> Contents {
    let mut contents = Contents::default();
    for node in objects(root) {
        match node.tag_name().name() {
            name if is_exported_tags(name) => contents.tags = true,
            name if is_block(name) => contents.blocks = true,
            name => {
                contents.other.get_or_insert_with(|| name.to_string());
            }
        }
    }
    contents
}

/// Whether an element of that name is a block or data type.
pub fn is_block(name: &str) -> bool {
    name.starts_with("SW.Blocks.") && name != "SW.Blocks.CompileUnit" && !name.ends_with("Group")
        || name == "SW.Types.PlcStruct"
}

/// Whether an element of that name is a tag table of an export; V13 of the TIA Portal has the second name.
pub fn is_exported_tags(name: &str) -> bool {
    matches!(name, "SW.Tags.PlcTagTable" | "SW.ControllerTagTable")
}

/// The objects that plcc reads.
const OBJECTS: [&str; 9] = [
    "SW.Blocks.OB",
    "SW.Blocks.FB",
    "SW.Blocks.FC",
    "SW.Blocks.GlobalDB",
    "SW.Blocks.InstanceDB",
    "SW.Blocks.ArrayDB",
    "SW.Blocks.CompileUnit",
    "SW.Types.PlcStruct",
    "SW.Tags.PlcTagTable",
];

/// The object whose name `name` is a slip of, part by part.
pub fn nearest_object(name: &str) -> Option<&'static str> {
    if OBJECTS.contains(&name) {
        return None;
    }
    let resembles = |own: &str, known: &'static str| own == known || nearest(own, std::iter::once(known)).is_some();
    let is_slip = |known: &&'static str| {
        let count = known.split('.').count();
        name.split('.').count() == count
            && name.split('.').zip(known.split('.')).all(|(own, known)| resembles(own, known))
    };
    let differences =
        |known: &&'static str| name.split('.').zip(known.split('.')).filter(|(own, known)| own != known).count();
    OBJECTS.into_iter().filter(is_slip).min_by_key(differences)
}

/// Whether an element of that name is a tag table of the editor.
pub fn is_tag_table(name: &str) -> bool {
    name.eq_ignore_ascii_case("Tagtable") || name.eq_ignore_ascii_case("Tagtables")
}

/// Whether an element of that name is a part of an export that belongs below a block.
pub fn is_fragment(name: &str) -> bool {
    let code =
        ["FlgNet", "StructuredText", "StatementList", "Graph", "NetworkSource", "Parts", "Wires", "Access", "Part"];
    let rest = ["Interface", "Sections", "Section", "Member", "AttributeList", "ObjectList", "SW.Blocks.CompileUnit"];
    code.contains(&name) || rest.contains(&name)
}

/// The objects of an export, in the order of the file: elements with a point in their name that are not inside another one.
pub fn objects<'a, 'i>(root: Node<'a, 'i>) -> Vec<Node<'a, 'i>> {
    let is_object = |node: &Node| node.is_element() && node.tag_name().name().contains('.');
    if is_object(&root) {
        return vec![root];
    }
    let mut found: Vec<Node> = Vec::new();
    for node in elements(root) {
        if is_object(&node) {
            found.push(node);
        } else {
            found.extend(elements(node).filter(is_object));
        }
    }
    found
}

/// The tag tables of an export that has other objects, too, as a document of their own; `None`: it has none, or nothing else.
pub fn tag_tables(text: &str) -> Option<String> {
    let Some(XmlKind::SimaticMl(Contents { blocks: true, tags: true, .. })) = kind(text) else { return None };
    let document = parse(text).ok()?;
    let tables = objects(document.root_element()).into_iter().filter(|node| is_exported_tags(node.tag_name().name()));
    let tables: Vec<&str> = tables.filter_map(|table| text.get(table.range())).collect();
    let head = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Document>\n  <Engineering version=\"V17\"/>";
    Some(format!("{head}\n  {}\n</Document>\n", tables.join("\n  ")))
}

/// Why a text cannot be read as XML.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Byte of the text.
    pub at: usize,
    pub text: String,
    /// What to write instead.
    pub help: String,
}

/// An element may have at most this many attributes. The parser compares each with all before it; no editor writes more than a few dozen.
const ATTRIBUTES_MAX: usize = 1000;

/// Reads a text as XML, in time that follows its length.
pub fn parse(text: &str) -> Result<Document<'_>, Fault> {
    if let Some(at) = crowded(text) {
        let text = format!("an element with more than {ATTRIBUTES_MAX} attributes");
        return Err(Fault { at, text, help: EXPORT_AGAIN.to_string() });
    }
    Document::parse(text).map_err(|error| {
        let last = text.char_indices().next_back().map_or(0, |(at, _)| at);
        let (label, help) = told(&error);
        if matches!(error, Error::UnexpectedEndOfStream | Error::NoRootNode) {
            return Fault { at: last, text: label, help };
        }
        let place = error.pos();
        let line = text.split_inclusive('\n').take(place.row.saturating_sub(1) as usize).map(str::len).sum::<usize>();
        let rest = text.get(line..).unwrap_or_default();
        let column = rest.char_indices().nth(place.col.saturating_sub(1) as usize);
        let at = (line + column.map_or(rest.len(), |(column, _)| column)).min(text.len());
        // `IF a < 5 THEN` in a text.
        if matches!(error, Error::InvalidName(_))
            && let Some(before) = text.get(..at).and_then(|text| text.strip_suffix('<'))
        {
            let (label, help) = less_sign();
            return Fault { at: before.len(), text: label, help };
        }
        Fault { at, text: label, help }
    })
}

const EXPORT_AGAIN: &str = "export it again, and copy the whole file";

/// A `<` that begins no element.
fn less_sign() -> (String, String) {
    ("`<` begins an element".to_string(), "write `&lt;` for the character `<` in a text".to_string())
}

/// What is wrong, and what to write.
fn told(error: &Error) -> (String, String) {
    let again = EXPORT_AGAIN.to_string();
    match error {
        Error::UnexpectedEndOfStream => ("the file ends inside an element".to_string(), again),
        Error::UnclosedRootNode => ("the first element of the file is never closed".to_string(), again),
        Error::MalformedEntityReference(_) => {
            ("`&` begins the code of a character".to_string(), "write `&amp;` for the character `&`".to_string())
        }
        Error::UnknownEntityReference(name, _) => (
            format!("XML has no character `&{name};`"),
            "the codes are `&amp;`, `&lt;`, `&gt;`, `&quot;` and `&apos;`".to_string(),
        ),
        Error::InvalidChar2(_, b'<', _) | Error::InvalidChar(b'<', _, _) => less_sign(),
        Error::UnexpectedCloseTag(open, closed, _) => {
            (format!("`{closed}` is closed, but `{open}` is open"), format!("write `</{open}>` where `{open}` ends"))
        }
        Error::UnexpectedDeclaration(_) => {
            ("another file begins here".to_string(), "make a file of each export".to_string())
        }
        Error::DuplicatedAttribute(name, _) => {
            (format!("`{name}` is given twice"), format!("remove one of the attributes `{name}`"))
        }
        other => {
            let text = other.to_string();
            let bare =
                text.rsplit_once(" at ").filter(|(_, place)| place.contains(':')).map(|(bare, _)| bare.to_string());
            (bare.unwrap_or(text), again)
        }
    }
}

/// Where a tag with too many attributes begins.
fn crowded(text: &str) -> Option<usize> {
    let after = |at: usize, end: &str| text[at..].find(end).map(|found| at + found + end.len());
    let mut at = 0;
    while let Some(start) = text[at..].find('<').map(|found| at + found) {
        let rest = &text[start..];
        let skipped = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
        if let Some((begin, end)) = skipped.iter().find(|(begin, _)| rest.starts_with(begin)) {
            at = after(start + begin.len(), end)?;
            continue;
        }
        let (mut quote, mut count) = (None, 0);
        at = text.len();
        for (offset, byte) in rest.bytes().enumerate() {
            match (quote, byte) {
                (Some(open), _) if byte == open => quote = None,
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(byte),
                (None, b'=') => count += 1,
                (None, b'>') => {
                    at = start + offset + 1;
                    break;
                }
                (None, _) => {}
            }
        }
        if count > ATTRIBUTES_MAX {
            return Some(start);
        }
    }
    None
}

/// The message for a text that is not well-formed XML.
pub fn broken(file: FileId, text: &str, fault: &Fault) -> Diagnostic {
    let start = fault.at;
    let end = text.get(start..).and_then(|rest| rest.chars().next()).map_or(start, |c| start + c.len_utf8());
    Diagnostic::new(Code::NotASource, Span::new(file, start..end), "the file is not well-formed XML")
        .label(fault.text.clone())
        .help(fault.help.clone())
}

/// The elements below a node.
pub fn elements<'a, 'i>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(Node::is_element)
}

/// Whether a node is an element of that name.
pub fn is(node: Node, name: &str) -> bool {
    node.is_element() && node.tag_name().name() == name
}

/// The first element of that name below a node.
pub fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| is(*child, name))
}

/// All elements of that name directly below a node.
pub fn children<'a, 'i, 'n>(node: Node<'a, 'i>, name: &'n str) -> impl Iterator<Item = Node<'a, 'i>> + use<'a, 'i, 'n> {
    node.children().filter(move |child| is(*child, name))
}

/// The text inside a node, without outer blanks.
pub fn text_of(node: Node) -> String {
    raw_text_of(node).trim().to_string()
}

/// The text inside a node.
pub fn raw_text_of(node: Node) -> String {
    node.descendants().filter(Node::is_text).filter_map(|text| text.text()).collect()
}

/// The bytes of an attribute's value in the file, else those of its element.
pub fn attribute_range(node: Node, name: &str) -> std::ops::Range<usize> {
    node.attribute_node(name).map_or_else(|| head(node), |attribute| attribute.range_value())
}

/// The bytes of an element's start tag, up to the end of its name.
pub fn head(node: Node) -> std::ops::Range<usize> {
    let range = node.range();
    let length = 1 + node.tag_name().name().len();
    range.start..(range.start + length).min(range.end)
}

/// `<!--@ cpu … -->`: settings of a test, as `//@ cpu …` in a source.
pub fn pragmas(file: FileId, document: &Document) -> Vec<Pragma> {
    let comments = document.root().descendants().filter(|node| node.is_comment());
    let pragmas = comments.filter_map(|node| {
        let text = node.text()?.trim().strip_prefix('@')?.trim().to_string();
        Some(Pragma { text, span: Span::new(file, node.range()), assert: None })
    });
    pragmas.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn element(count: usize) -> String {
        let attributes: String = (0..count).map(|number| format!(" a{number}=\"=>\"")).collect();
        format!("<?xml version=\"1.0\"?><!-- < --><r><![CDATA[ <a ]]><x{attributes}/></r>")
    }

    #[test]
    fn elements_have_few_attributes() {
        assert!(parse(&element(ATTRIBUTES_MAX)).is_ok());
        let text = element(ATTRIBUTES_MAX + 1);
        let fault = parse(&text).expect_err("too many");
        assert_eq!(
            (Some(fault.at), fault.text.as_str()),
            (text.find("<x"), "an element with more than 1000 attributes")
        );
    }

    #[test]
    fn slips_of_objects() {
        assert_eq!(nearest_object("SW.Blocks.OBB"), Some("SW.Blocks.OB"));
        assert_eq!(nearest_object("SW.Block.FC"), Some("SW.Blocks.FC"));
        assert_eq!(nearest_object("SW.Tags.PlcTagTabel"), Some("SW.Tags.PlcTagTable"));
        for name in
            ["SW.Blocks.OB", "SW.Blocks.SDB", "SW.WatchAndForceTables.PlcWatchTable", "SW.Blocks.PlcBlockUserGroup"]
        {
            assert_eq!(nearest_object(name), None, "{name}");
        }
    }

    #[test]
    fn faults_have_a_place() {
        for text in [
            "<a",
            "<a b='",
            "<!--",
            "<![CDATA[",
            "<?x",
            "<é",
            "<a>\r\n<b></a>",
            "<",
            "<a></a><",
            "<a x=\"1\" x=\"2\"/>",
        ] {
            let fault = parse(text).expect_err(text);
            assert!(text.is_char_boundary(fault.at), "{text}");
        }
    }
}
