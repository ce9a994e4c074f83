//! Rows of actions.

use plcc_syntax::chart::ast::{Action, ActionBody};

use super::Maker;
use crate::scl::expression;
use crate::xml::node::Node;
use crate::xml::{multilingual_lines, scl};

impl Maker<'_, '_> {
    /// A row; `None`: it was refused.
    pub(super) fn action(&mut self, action: &Action) -> Option<Node> {
        let text = match &action.body {
            ActionBody::Operand(operand) => expression::text(operand, self.writer),
            ActionBody::Value { operand, value } => {
                let operand = expression::text(operand, self.writer);
                format!("{operand} := {}", expression::text(value, self.writer))
            }
            ActionBody::All { .. } => "S_ALL".to_string(),
            ActionBody::Call(call) => self.writer.call_text(call),
            ActionBody::Statements(_) | ActionBody::Network(_) => {
                let title = "the TIA Portal has neither statements nor networks in actions";
                self.writer.refuse(action.span, title, "put them into a block, and call it in the action");
                return None;
            }
            ActionBody::Error => {
                self.writer.refuse(action.span, "an action that was not understood", "repair the source first");
                return None;
            }
        };
        let mut node = Node::new("Action");
        if let Some(event) = action.event {
            node = node.with("Event", event.name());
        }
        if action.interlock {
            node = node.with("Interlock", true);
        }
        node = node.with("Qualifier", action.qualifier.name());
        scl::row(&text, self.block, self.library, &mut node);
        if let Some(comment) = &action.comment {
            node.push(multilingual_lines("Comment", std::slice::from_ref(comment)));
        }
        Some(node)
    }
}
