//! The common parts of the reader: the overlay, the messages, and operands.

use plcc_diag::{Code, Diagnostic, FileId, Span};
use roxmltree::Node;

use super::operand::{self, Notation, Unreadable};
use super::overlay::Overlay;
use crate::xml::{attribute_range, child, children, head, text_of};
use plcc_syntax::ast::{InitialKind, InitialValue};
use plcc_syntax::scl::ast::{Expr, ExprKind, Name, NameForm};
use plcc_syntax::scl::fragment;

/// State of reading one file.
pub struct Reader {
    pub file: FileId,
    pub overlay: Overlay,
    /// Assertions in comments of SCL and STL are read.
    pub pragmas: bool,
    /// The step that comparisons of step times in GRAPH mean, by name: the step of the network, or the only one before its transition.
    pub own_step: Option<String>,
    pub diagnostics: Vec<Diagnostic>,
}

/// A part of the file cannot be read; this has been reported.
pub struct Refused;

impl Reader {
    pub fn span(&self, range: std::ops::Range<usize>) -> Span {
        Span::new(self.file, range)
    }

    /// Reports a part of the file that plcc does not read; `whose`: the network or block that is left out because of it.
    pub fn refuse(&mut self, node: Node, whose: &str, what: &str) -> Refused {
        let message = Diagnostic::new(
            Code::ForeignContent,
            self.span(head(node)),
            format!("{whose} contains {what}, which plcc does not read"),
        );
        self.diagnostics.push(
            message.label("not known").help(
                "write the network in another way, in SCL for example; no part of a network is left out silently",
            ),
        );
        Refused
    }

    /// Reports the part of an access that cannot be read.
    pub fn refuse_access(&mut self, unreadable: &Unreadable, whose: &str) -> Refused {
        let refused = self.refuse(unreadable.node, whose, &unreadable.what);
        if let (Some(meant), Some(message)) = (unreadable.meant, self.diagnostics.last_mut()) {
            message.help = Some(format!("is `{meant}` meant?"));
        }
        refused
    }

    /// Reports a mistake in the file, because of which a network is left out.
    pub fn fault(
        &mut self,
        range: std::ops::Range<usize>,
        title: String,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> Refused {
        self.diagnostics.push(Diagnostic::new(Code::ForeignContent, self.span(range), title).label(label).help(help));
        Refused
    }

    /// Writes the value of an attribute to its own position, and returns the position.
    pub fn name_span(&mut self, node: Node, attribute: &str) -> Span {
        let range = attribute_range(node, attribute);
        let value = node.attribute(attribute).unwrap_or_default();
        let placed = self.overlay.place(value, range.start, range.clone());
        self.span(placed.unwrap_or(range))
    }

    /// The expression `text`, which represents `node`.
    pub fn expression(&mut self, node: Node, wanted: usize, text: &str) -> Expr {
        let Some(range) = self.overlay.place(text, wanted, node.range()) else {
            return Expr { kind: ExprKind::Error, span: self.span(head(node)) };
        };
        let (expr, messages) = fragment::expression(self.file, self.overlay.text(), range.clone());
        if matches!(expr.kind, ExprKind::Error) && messages.is_empty() {
            let message = Diagnostic::new(Code::Syntax, self.span(range), format!("`{text}` is not an operand"));
            self.diagnostics
                .push(message.label("cannot be read").help("enter it again in the editor, and export the block again"));
        }
        self.diagnostics.extend(messages);
        expr
    }

    /// The operand of an `Access`.
    pub fn operand(&mut self, node: Node, whose: &str) -> Result<Expr, Refused> {
        let text = operand::access(node, Notation::Scl).map_err(|unreadable| self.refuse_access(&unreadable, whose))?;
        if node.attribute("Scope") == Some("Label") {
            return Ok(self.label_operand(node, &text));
        }
        Ok(self.expression(node, operand::wanted_place(node), &text))
    }

    fn label_operand(&mut self, node: Node, text: &str) -> Expr {
        let name = self.label(node, text.to_string());
        Expr { span: name.span, kind: ExprKind::Name(name) }
    }

    /// The label that a node with a `Label` in it names.
    pub fn label(&mut self, node: Node, text: String) -> Name {
        let span = match child(node, "Label") {
            Some(label) => self.name_span(label, "Name"),
            None => self.span(head(node)),
        };
        Name { text, form: NameForm::Bare, span }
    }

    /// The instance of a part or call.
    pub fn instance(&mut self, node: Node, whose: &str) -> Result<Expr, Refused> {
        let local = node.attribute("Scope").is_some_and(|scope| scope.starts_with("Local"));
        let text = operand::path(node, local, Notation::Scl, 0);
        let text = text.map_err(|unreadable| self.refuse_access(&unreadable, whose))?;
        if text.is_empty() {
            return Err(self.refuse(node, whose, "an instance without a name"));
        }
        Ok(self.expression(node, operand::wanted_place(node), &text))
    }

    /// The value in a `StartValue`.
    pub fn start_value(&mut self, node: Node) -> Option<InitialValue> {
        let text = match node.attribute("ConstantName") {
            Some(name) => operand::quoted(name),
            None => text_of(node).replace(['\n', '\r'], " "),
        };
        if text.is_empty() {
            return None;
        }
        let wanted = node.first_child().map_or(node.range().start, |text| text.range().start);
        let expr = self.expression(node, wanted, &text);
        Some(InitialValue { span: expr.span, kind: InitialKind::Expr(Box::new(expr)) })
    }
}

/// The first text of a title or comment (`MultilingualText`) of an object.
pub fn multilingual(object: Node, name: &str) -> Option<String> {
    let list = child(object, "ObjectList")?;
    let found = children(list, "MultilingualText").find(|text| text.attribute("CompositionName") == Some(name))?;
    let texts = found.descendants().filter(|node| crate::xml::is(*node, "Text"));
    texts.map(text_of).find(|text| !text.is_empty())
}

/// The first text of each of the given elements below a node that is not an object, as lines: titles and comments in GRAPH.
pub fn texts(node: Node, names: &[&str]) -> Vec<String> {
    let texts = names.iter().filter_map(|name| child(node, name)).filter_map(first_text);
    texts.flat_map(|text| text.lines().map(str::to_string).collect::<Vec<_>>()).collect()
}

/// A title or comment that is not an object, in the first language that has a text.
pub fn first_text(node: Node) -> Option<String> {
    let mut texts = children(node, "MultiLanguageText").map(text_of);
    texts.find(|text| !text.is_empty())
}

/// The text of an attribute in the list of an object: `Name`, `Number`.
pub fn setting<'a, 'i>(object: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    child(child(object, "AttributeList")?, name)
}

/// Its text; `None` if it is missing or empty.
pub fn setting_text(object: Node, name: &str) -> Option<String> {
    setting(object, name).map(text_of).filter(|text| !text.is_empty())
}
