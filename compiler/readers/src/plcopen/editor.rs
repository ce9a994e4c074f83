//! Which editor wrote a project. There is one format, but editors treat addresses, comments and dates differently.

use roxmltree::{Document, Node};

use super::interface::{child, elements};

/// Editors whose projects have different meanings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Editor {
    /// CODESYS and its descendants, such as TwinCAT: one memory, in which addresses count units of their width.
    Codesys,
    /// Beremiz, OpenPLC and others that compile with MATIEC: each address is a separate variable.
    Matiec,
    /// Any other, read by the rules of CODESYS.
    Other,
}

impl Editor {
    /// The editor, from its own name in the file or from its way of writing text.
    pub fn of(document: &Document) -> Editor {
        let root = document.root_element();
        let header = child(root, "fileHeader");
        let content = child(root, "contentHeader");
        let words: Vec<String> = [
            header.and_then(|node| node.attribute("companyName")),
            header.and_then(|node| node.attribute("companyURL")),
            header.and_then(|node| node.attribute("productName")),
            header.and_then(|node| node.attribute("contentDescription")),
            content.and_then(|node| node.attribute("organization")),
        ]
        .into_iter()
        .flatten()
        .map(str::to_ascii_lowercase)
        .collect();
        let says = |names: &[&str]| words.iter().any(|word| names.iter().any(|name| word.contains(name)));
        let data_of_codesys = |node: Node| {
            node.tag_name().name() == "data" && node.attribute("name").is_some_and(|name| name.contains("3s-software"))
        };
        if says(&["3s-smart", "codesys", "beckhoff", "twincat"]) || document.descendants().any(data_of_codesys) {
            return Editor::Codesys;
        }
        if says(&["beremiz", "openplc", "matiec"]) {
            return Editor::Matiec;
        }
        let foreign = says(&[
            "plcc",
            "phoenix",
            "pc worx",
            "kw-software",
            "kw software",
            "multiprog",
            "geb",
            "logi.cad",
            "isagraf",
        ]);
        // Text in a paragraph of XHTML whose namespace has a prefix: only editors of this family write it.
        let paragraphs = document.descendants().any(|node| {
            matches!(node.tag_name().name(), "ST" | "IL" | "documentation")
                && elements(node).any(|text| text.tag_name().name() == "p")
        });
        let prefix = root.namespaces().any(|space| space.name() == Some("xhtml"));
        if !foreign && (paragraphs || prefix) { Editor::Matiec } else { Editor::Other }
    }

    /// Addresses of different widths never share memory.
    pub fn separates_widths(self) -> bool {
        self == Editor::Matiec
    }

    /// `(* a (* b *) c *)` is one comment.
    pub fn nests_comments(self) -> bool {
        self != Editor::Matiec
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Editor {
        Editor::of(&Document::parse(text).expect("well-formed"))
    }

    #[test]
    fn the_header_decides_before_the_text() {
        assert_eq!(of(r#"<project><fileHeader companyName="Beremiz"/></project>"#), Editor::Matiec);
        assert_eq!(of(r#"<project><fileHeader productName="OpenPLC Editor"/></project>"#), Editor::Matiec);
        assert_eq!(of(r#"<project><fileHeader productName="CODESYS"/></project>"#), Editor::Codesys);
        assert_eq!(of(r#"<project><fileHeader productName="Own"/></project>"#), Editor::Other);
        let data = r#"<project xmlns:xhtml="x"><data name="http://www.3s-software.com/plcopenxml/method"/></project>"#;
        assert_eq!(of(data), Editor::Codesys);
        assert_eq!(of(r#"<project xmlns:xhtml="x"><fileHeader companyName="Unknown"/></project>"#), Editor::Matiec);
        let own = r#"<project xmlns:xhtml="x"><fileHeader productName="plcc"/></project>"#;
        assert_eq!(of(own), Editor::Other);
        let prefixed = r#"<project xmlns:xhtml="x"><fileHeader productName="PC WORX"/></project>"#;
        assert_eq!(of(prefixed), Editor::Other);
    }
}
