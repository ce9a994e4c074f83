//! Networks in SCL: the tokens of a `StructuredText`, written to their positions in the overlay and parsed there.

use roxmltree::Node;

use super::operand::{self, Notation};
use super::reader::{Reader, Refused};
use crate::xml::{attribute_range, child, children, elements, is, raw_text_of};
use plcc_syntax::scl::ast::Statement;
use plcc_syntax::scl::fragment;

/// How deep calls may be nested.
const DEPTH_MAX: usize = 64;

/// The statements of a network.
pub fn read(reader: &mut Reader, source: Node, whose: &str) -> Result<Vec<Statement>, Refused> {
    tokens(reader, source, whose, 0)?;
    let (statements, messages) =
        fragment::statements(reader.file, reader.overlay.text(), source.range(), reader.pragmas);
    reader.diagnostics.extend(messages);
    Ok(statements)
}

/// Writes the tokens below a node, in the order of the file.
fn tokens(reader: &mut Reader, list: Node, whose: &str, depth: usize) -> Result<(), Refused> {
    if depth > DEPTH_MAX {
        return Err(reader.refuse(list, whose, "calls that are nested too deeply"));
    }
    for node in elements(list) {
        token(reader, node, whose, depth)?;
    }
    Ok(())
}

/// Writes one of the nodes that statements consist of.
pub fn token(reader: &mut Reader, node: Node, whose: &str, depth: usize) -> Result<(), Refused> {
    match node.tag_name().name() {
        "Token" => write(reader, node, node.attribute("Text").unwrap_or_default(), whose)?,
        "NewLine" => write(reader, node, "\n", whose)?,
        // The name of a region.
        "Text" => write(reader, node, &raw_text_of(node).replace(['\n', '\r'], " "), whose)?,
        "LineComment" => pragma(reader, node),
        "Access" => access(reader, node, whose, depth)?,
        "Parameter" => {
            write_name(reader, node, whose)?;
            tokens(reader, node, whose, depth + 1)?;
        }
        "NamelessParameter" | "Expression" | "Statement" => tokens(reader, node, whose, depth + 1)?,
        "LabelDeclaration" => {
            for label in children(node, "Label") {
                write_name(reader, label, whose)?;
            }
            for token in children(node, "Token") {
                write(reader, token, token.attribute("Text").unwrap_or_default(), whose)?;
            }
        }
        // The instance has been written; types of instructions follow from their operands; settings are checked by the schema.
        "Blank" | "Comment" | "Instance" | "TemplateValue" | "AutomaticTyped" | "StringAttribute"
        | "BooleanAttribute" | "IntegerAttribute" | "DateAttribute" => {}
        other => return Err(reader.refuse(node, whose, &format!("`{other}`"))),
    }
    Ok(())
}

fn access(reader: &mut Reader, node: Node, whose: &str, depth: usize) -> Result<(), Refused> {
    let call = elements(node).find(|part| is(*part, "CallInfo") || is(*part, "Instruction"));
    if let Some(call) = call {
        return self::call(reader, call, whose, depth);
    }
    if child(node, "Expression").is_some() {
        return tokens(reader, node, whose, depth + 1);
    }
    let text = operand::access(node, Notation::Scl);
    let text = text.map_err(|unreadable| reader.refuse_access(&unreadable, whose))?;
    put(reader, node, &text, operand::wanted_place(node), whose)
}

/// `"Fc"(…)`, `#instance(…)`, `ABS(…)`; the parentheses are tokens.
fn call(reader: &mut Reader, node: Node, whose: &str, depth: usize) -> Result<(), Refused> {
    let name = node.attribute("Name").unwrap_or_default();
    let is_instruction = is(node, "Instruction");
    if let Some(instance) = child(node, "Instance") {
        let local = instance.attribute("Scope").is_some_and(|scope| scope.starts_with("Local"));
        let text = operand::path(instance, local, Notation::Scl, 0);
        let mut text = text.map_err(|unreadable| reader.refuse_access(&unreadable, whose))?;
        let has_point = elements(node).any(|token| token.attribute("Text") == Some("."));
        if is_instruction && !has_point && !name.is_empty() {
            text.push_str(&format!(".{}", operand::plain_or_quoted(name)));
        }
        put(reader, instance, &text, operand::wanted_place(instance), whose)?;
    } else {
        let text = if is_instruction { name.to_string() } else { operand::quoted(name) };
        let wanted = attribute_range(node, "Name").start.saturating_sub(usize::from(!is_instruction));
        put(reader, node, &text, wanted, whose)?;
    }
    tokens(reader, node, whose, depth + 1)
}

fn write(reader: &mut Reader, node: Node, text: &str, whose: &str) -> Result<(), Refused> {
    put(reader, node, text, node.range().start, whose)
}

/// Writes a text into its node, so it comes in the order of the file.
pub fn put(reader: &mut Reader, node: Node, text: &str, wanted: usize, whose: &str) -> Result<(), Refused> {
    match reader.overlay.place_inside(text, wanted, node.range()) {
        Some(_) => Ok(()),
        None => Err(reader.refuse(node, whose, &format!("`{text}`, which is longer than its element"))),
    }
}

fn write_name(reader: &mut Reader, node: Node, whose: &str) -> Result<(), Refused> {
    let name = operand::plain_or_quoted(node.attribute("Name").unwrap_or_default());
    let range = attribute_range(node, "Name");
    put(reader, node, &name, range.start.saturating_sub(usize::from(name.starts_with('"'))), whose)
}

/// Comments have no meaning, except for assertions of tests.
pub fn pragma(reader: &mut Reader, node: Node) {
    let text = raw_text_of(node).replace(['\n', '\r'], " ");
    let text = text.trim();
    let text = text.strip_prefix("//").unwrap_or(text);
    if reader.pragmas && text.starts_with('@') {
        reader.overlay.place(&format!("\n//{text}\n"), node.range().start, node.range());
    }
}
