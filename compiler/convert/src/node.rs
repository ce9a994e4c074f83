//! Elements of XML, and their text.

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event};

/// An element that is written once all of it is known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Node {
    pub name: &'static str,
    pub attributes: Vec<(&'static str, String)>,
    pub children: Vec<Node>,
    pub text: Option<String>,
}

impl Node {
    pub fn new(name: &'static str) -> Node {
        Node { name, ..Node::default() }
    }

    /// An element with a text in it.
    pub fn of(name: &'static str, text: impl Into<String>) -> Node {
        Node { name, text: Some(text.into()), ..Node::default() }
    }

    pub fn with(mut self, key: &'static str, value: impl ToString) -> Node {
        self.attributes.push((key, value.to_string()));
        self
    }

    pub fn child(mut self, node: Node) -> Node {
        self.children.push(node);
        self
    }

    pub fn children(mut self, nodes: impl IntoIterator<Item = Node>) -> Node {
        self.children.extend(nodes);
        self
    }

    pub fn push(&mut self, node: Node) {
        self.children.push(node);
    }
}

/// The text of a document.
pub fn document(root: &Node) -> String {
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
    const WHY: &str = "memory takes all that is written";
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("utf-8"), None))).expect(WHY);
    write(&mut writer, root);
    let mut bytes = writer.into_inner();
    bytes.push(b'\n');
    String::from_utf8(bytes).expect("texts are UTF-8")
}

/// A document with pragmas of the file, such as the CPU, in comments after its first line.
pub fn with_pragmas(document: &str, pragmas: &[String]) -> String {
    let lines: String = pragmas.iter().map(|text| format!("<!--@ {} -->\n", text.replace("--", "- -"))).collect();
    let (head, rest) = document.split_once('\n').unwrap_or(("", document));
    format!("{head}\n{lines}{rest}")
}

fn write(writer: &mut Writer<Vec<u8>>, node: &Node) {
    const WHY: &str = "memory takes all that is written";
    let attributes: Vec<(&str, String)> =
        node.attributes.iter().map(|(key, value)| (*key, allowed(value).replace(['\n', '\r', '\t'], " "))).collect();
    let pairs = attributes.iter().map(|(key, value)| (*key, value.as_str()));
    let start = BytesStart::new(node.name).with_attributes(pairs);
    if node.children.is_empty() && node.text.is_none() {
        return writer.write_event(Event::Empty(start)).expect(WHY);
    }
    writer.write_event(Event::Start(start)).expect(WHY);
    if let Some(text) = &node.text {
        writer.write_event(Event::Text(BytesText::new(&allowed(text)))).expect(WHY);
    }
    node.children.iter().for_each(|child| write(writer, child));
    writer.write_event(Event::End(BytesEnd::new(node.name))).expect(WHY);
}

/// A text without the characters that XML cannot have.
fn allowed(text: &str) -> String {
    let is_foreign =
        |c: char| c.is_control() && !matches!(c, '\n' | '\r' | '\t') || matches!(c, '\u{FFFE}' | '\u{FFFF}');
    text.chars().map(|c| if is_foreign(c) { ' ' } else { c }).collect()
}
