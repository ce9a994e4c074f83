//! Texts that a tree does not have: titles and comments in other languages than the first, comments of elements of arrays and of boxes.

use plcc_diag::{Code, Diagnostic, FileId, Severity, Span};
use roxmltree::Node;

use super::reader::first_text;
use crate::xml::{child, children, head, is, text_of};

/// A warning that the texts of an export in other languages stay behind when it is written in another notation; none if it has none.
pub fn languages_left_out(file: FileId, text: &str) -> Option<Diagnostic> {
    let document = crate::xml::parse(text).ok()?;
    let others: Vec<(Node, String)> = document.root().descendants().filter_map(other).collect();
    let (first, language) = others.first()?;
    let title = format!("texts in other languages are not in the new file, such as this one in `{language}`");
    let mut message = Diagnostic::new(Code::NotConverted, Span::new(file, head(*first)), title);
    message.severity = Severity::Warning;
    let help = match others.len() {
        1 => "keep the export, or translate the text in the editor again".to_string(),
        count => {
            format!("{count} texts have several languages; keep the export, or translate them in the editor again")
        }
    };
    Some(message.label("only the first language of a text is written").help(help))
}

/// A warning that the comments of elements of arrays, and of elements of networks, stay behind; none if there are none.
pub fn comments_left_out(file: FileId, text: &str) -> Option<Diagnostic> {
    let document = crate::xml::parse(text).ok()?;
    let is_place = |node: Node| ["Subelement", "Part", "Call"].iter().any(|name| is(node, name));
    let is_left =
        |node: &Node| is(*node, "Comment") && node.parent().is_some_and(is_place) && first_text(*node).is_some();
    let found: Vec<Node> = document.root().descendants().filter(is_left).collect();
    let first = *found.first()?;
    let of = if first.parent().is_some_and(|node| is(node, "Subelement")) { "an element of an array" } else { "a box" };
    let title = format!("the comment of {of} is not in the new file");
    let mut message = Diagnostic::new(Code::NotConverted, Span::new(file, head(first)), title);
    message.severity = Severity::Warning;
    let help = match found.len() {
        1 => "write it at the variable or the network".to_string(),
        count => format!("there are {count} of them: write them at the variables or the networks"),
    };
    Some(message.label("only variables, networks and blocks have comments there").help(help))
}

/// The first text of an object or a declaration that says something else in another language, with the language. Tag tables are copied
/// with all their texts.
fn other<'a, 'i>(node: Node<'a, 'i>) -> Option<(Node<'a, 'i>, String)> {
    let mut texts: Vec<(Node, String)> = match is(node, "MultilingualText") {
        true => {
            let items = children(child(node, "ObjectList")?, "MultilingualTextItem");
            let lists = items.filter_map(|item| child(item, "AttributeList"));
            let text = |list| Some((child(list, "Text")?, child(list, "Culture").map(text_of).unwrap_or_default()));
            lists.filter_map(text).collect()
        }
        false => {
            let language = |text: Node| text.attribute("Lang").unwrap_or_default().to_string();
            children(node, "MultiLanguageText").map(|text| (text, language(text))).collect()
        }
    };
    texts.retain(|(text, _)| !text_of(*text).is_empty());
    let first = text_of(texts.first()?.0);
    let found = texts.into_iter().find(|(text, _)| text_of(*text) != first)?;
    let is_tag = node.ancestors().any(|outer| outer.tag_name().name().starts_with("SW.Tags."));
    (!is_tag).then_some(found)
}
