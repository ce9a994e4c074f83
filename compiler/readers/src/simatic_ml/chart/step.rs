//! Steps: their settings, conditions and actions.

use roxmltree::Node;

use super::super::reader::{Reader, texts};
use super::{action, condition, is_text, is_true, nodes};
use crate::xml::{attribute_range, children, elements, head};
use plcc_syntax::chart::ast::{Condition, Step};
use plcc_syntax::scl::ast::{Expr, Name};

/// Reads a step that has a number.
pub fn read(reader: &mut Reader, node: Node, name: &Name, block: &str, language: &str) -> Step {
    let whose = format!("step `{}` of `{block}`", name.text);
    reader.own_step = Some(name.text.clone());
    let mut step = Step {
        name: name.clone(),
        number: nodes::number(node, "Number").unwrap_or_default(),
        initial: node.attribute("Init").is_some_and(is_true),
        actions: Vec::new(),
        interlock: None,
        supervision: None,
        maximum: time(reader, node, "MaximumStepTime"),
        warning: time(reader, node, "WarningTime"),
        comment: texts(node, &["Title", "Comment"]),
        span: reader.span(head(node)),
    };
    for part in elements(node) {
        match part.tag_name().name() {
            "Actions" => {
                for row in elements(part) {
                    match row.tag_name().name() {
                        "Action" => step.actions.extend(action::read(reader, row, &whose)),
                        "Title" => step.comment.extend(texts(part, &["Title"])),
                        other if is_text(other) => {}
                        other => {
                            reader.refuse(row, &whose, &format!("`{other}`"));
                        }
                    }
                }
            }
            "Interlocks" => {
                step.interlock = only(reader, part, "Interlock", language, &format!("the interlock of {whose}"));
            }
            "Supervisions" => {
                step.supervision = only(reader, part, "Supervision", language, &format!("the supervision of {whose}"));
            }
            other if is_text(other) => {}
            other => {
                reader.refuse(part, &whose, &format!("`{other}`"));
            }
        }
    }
    reader.own_step = None;
    step
}

/// A time in an attribute.
fn time(reader: &mut Reader, node: Node, attribute: &str) -> Option<Expr> {
    let text = node.attribute(attribute)?.trim();
    if text.is_empty() {
        return None;
    }
    Some(reader.expression(node, attribute_range(node, attribute).start, text))
}

/// The condition of a list that has one at most.
fn only(reader: &mut Reader, list: Node, name: &str, language: &str, whose: &str) -> Option<Condition> {
    let mut found = None;
    for node in children(list, name) {
        if let condition::Found::Network(condition) = condition::read(reader, node, language, whose)
            && found.replace(condition).is_some()
        {
            reader.refuse(node, whose, "more than one network");
        }
    }
    found
}
