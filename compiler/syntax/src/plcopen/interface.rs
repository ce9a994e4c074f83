//! Declarations: variables, their types and their initial values.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Span};
use roxmltree::Node;

use super::Reader;
use super::overlay::content;
use super::scope::FlipFlop;
use crate::ast::{
    BlockName, Bound, Constant, InitialKind, InitialValue, Retain, Section, SectionKind, TypeKind, TypeRef, Variable,
};
use crate::scl::ast::{Name, NameForm};
use crate::scl::fragment;

/// Types inside types are read up to this depth.
const DEPTH_MAX: usize = 32;

/// A variable list of an interface.
pub const LISTS: &[(&str, SectionKind)] = &[
    ("inputVars", SectionKind::Input),
    ("outputVars", SectionKind::Output),
    ("inOutVars", SectionKind::InOut),
    ("localVars", SectionKind::Static),
    ("tempVars", SectionKind::Temp),
];

/// The elements below a node.
pub fn elements<'a, 'i>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(Node::is_element)
}

/// The first element of that name below a node.
pub fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    elements(node).find(|child| child.tag_name().name() == name)
}

impl Reader<'_> {
    pub fn span(&self, range: Range<usize>) -> Span {
        Span::new(self.file, range)
    }

    /// What stands for a node in messages: the value of an attribute, else the start of its tag.
    pub fn place(&self, node: Node, attribute: &str) -> Span {
        match node.attribute_node(attribute) {
            Some(found) => self.span(found.range_value()),
            None => self.span(node.range().start..(node.range().start + 1 + node.tag_name().name().len())),
        }
    }

    /// The text of a node without outer blanks, as bytes of the file.
    pub fn text_range(&self, node: Node) -> Option<Range<usize>> {
        let range = content(node)?;
        let text = self.overlay.get(range.clone())?;
        let start = range.start + text.len() - text.trim_start().len();
        let end = range.end - (text.len() - text.trim_end().len());
        (start < end).then_some(start..end)
    }

    /// The sections of an interface, without variables that have an address of their own.
    pub fn sections(&mut self, interface: Node, function: bool) -> (Vec<Section>, Vec<Constant>) {
        let (mut sections, mut constants) = (Vec::new(), Vec::new());
        for list in elements(interface) {
            let name = list.tag_name().name();
            let Some((_, kind)) = LISTS.iter().find(|(known, _)| *known == name) else { continue };
            let kind = if function && *kind == SectionKind::Static { SectionKind::Temp } else { *kind };
            let is = |attribute: &str| list.attribute(attribute) == Some("true");
            let variables: Vec<Node> = elements(list).filter(|node| node.tag_name().name() == "variable").collect();
            if is("constant") {
                constants.extend(variables.iter().filter_map(|node| self.constant(*node)));
                continue;
            }
            let variables = variables.into_iter().filter(|node| !node.has_attribute("address"));
            let variables: Vec<Variable> = variables.filter_map(|node| self.variable(node, 0)).collect();
            let retain = match (is("retain"), is("nonretain")) {
                (true, _) if kind == SectionKind::Static => Retain::Retain,
                (_, true) if kind == SectionKind::Static => Retain::NonRetain,
                _ => Retain::Unsaid,
            };
            if !variables.is_empty() {
                sections.push(Section { kind, retain, variables, span: self.place(list, "name") });
            }
        }
        (sections, constants)
    }

    fn constant(&mut self, node: Node) -> Option<Constant> {
        let name = node.attribute("name")?.to_string();
        let name_span = self.place(node, "name");
        let ty = child(node, "type").and_then(|ty| self.type_of(ty, 0));
        let value = child(node, "initialValue").and_then(|value| child(value, "simpleValue"));
        let Some(value) = value.and_then(|value| value.attribute_node("value")) else {
            let text = format!("the constant `{name}` has no value");
            self.messages
                .push(Diagnostic::new(Code::DeclarationSyntax, name_span, text).help("give it an initial value"));
            return None;
        };
        let (value, messages) = fragment::expression(self.file, &self.overlay, value.range_value());
        self.messages.extend(messages);
        Some(Constant { name, name_span, ty, value: Some(value) })
    }

    /// A declared variable or component.
    pub fn variable(&mut self, node: Node, depth: usize) -> Option<Variable> {
        let name = node.attribute("name")?.to_string();
        let name_span = self.place(node, "name");
        let ty = child(node, "type").and_then(|ty| self.type_of(ty, depth))?;
        let initial = child(node, "initialValue").and_then(|value| self.initial(value, depth));
        // A flip-flop is its state: see `Scope::flip_flops`.
        let initial = if flip_flop(node).is_some() { None } else { initial };
        let comment = child(node, "documentation").map(|node| plain_text(node)).filter(|text| !text.is_empty());
        Some(Variable { name, name_span, attributes: Vec::new(), at: None, ty, initial, comment })
    }

    /// The type inside a `type` or `baseType` element.
    pub fn type_of(&mut self, holder: Node, depth: usize) -> Option<TypeRef> {
        let node = elements(holder).next()?;
        let span = self.place(node, "name");
        let refused = |reader: &mut Self, what: String| {
            let help = "declare the variable with an elementary type, a structure or an array";
            reader.messages.push(Diagnostic::new(Code::ForeignContent, span, what).help(help));
            None
        };
        if depth > DEPTH_MAX {
            return refused(self, "types inside types are nested too deeply".to_string());
        }
        let kind = match node.tag_name().name() {
            "derived" => {
                let name = node.attribute("name")?;
                match standard_block(name) {
                    Some(name) => TypeKind::Named(name.to_string()),
                    None => TypeKind::Block(BlockName::Symbol { name: name.to_string(), span }),
                }
            }
            "string" | "STRING" => TypeKind::String(length(node, span)),
            "wstring" | "WSTRING" => TypeKind::WideString(length(node, span)),
            "array" => {
                let element = child(node, "baseType").and_then(|base| self.type_of(base, depth + 1))?;
                let mut bounds = Vec::new();
                for dimension in elements(node).filter(|node| node.tag_name().name() == "dimension") {
                    bounds.push((self.bound(dimension, "lower")?, self.bound(dimension, "upper")?));
                }
                TypeKind::Array { bounds, element: Box::new(element) }
            }
            "struct" => {
                TypeKind::Struct(elements(node).filter_map(|member| self.variable(member, depth + 1)).collect())
            }
            "subrangeSigned" | "subrangeUnsigned" => {
                return child(node, "baseType").and_then(|base| self.type_of(base, depth + 1));
            }
            "enum" => TypeKind::Named("INT".to_string()),
            name @ ("pointer" | "reference" | "union") => {
                return refused(self, format!("plcc has no data type for `{name}` of PLCopen XML"));
            }
            name => TypeKind::Named(name.to_ascii_uppercase()),
        };
        Some(TypeRef { kind, span })
    }

    fn bound(&mut self, dimension: Node, attribute: &str) -> Option<Bound> {
        let value = dimension.attribute_node(attribute)?;
        let span = self.span(value.range_value());
        match value.value().trim().parse() {
            Ok(number) => Some(Bound::Number(number, span)),
            Err(_) => Some(Bound::Name(value.value().trim().to_string(), span)),
        }
    }

    /// The value inside an `initialValue` or `value` element.
    fn initial(&mut self, holder: Node, depth: usize) -> Option<InitialValue> {
        let node = elements(holder).next()?;
        let span = self.place(node, "value");
        if depth > DEPTH_MAX {
            return None;
        }
        let kind = match node.tag_name().name() {
            "simpleValue" => {
                let range = node.attribute_node("value")?.range_value();
                if self.overlay.get(range.clone()).is_none_or(|text| text.trim().is_empty()) {
                    return None;
                }
                let (value, messages) = fragment::expression(self.file, &self.overlay, range);
                self.messages.extend(messages);
                InitialKind::Expr(Box::new(value))
            }
            "arrayValue" => {
                let mut values = Vec::new();
                for item in elements(node) {
                    let Some(value) = self.initial(item, depth + 1) else { continue };
                    match item.attribute("repetitionValue").and_then(|count| count.trim().parse::<i64>().ok()) {
                        Some(count) if count != 1 => {
                            let count = Bound::Number(count, self.place(item, "repetitionValue"));
                            let span = value.span;
                            values
                                .push(InitialValue { kind: InitialKind::Repeat { count, values: vec![value] }, span });
                        }
                        _ => values.push(value),
                    }
                }
                InitialKind::List(values)
            }
            "structValue" => {
                let mut fields = Vec::new();
                for item in elements(node) {
                    let (Some(member), Some(value)) = (item.attribute("member"), self.initial(item, depth + 1)) else {
                        continue;
                    };
                    let span = self.place(item, "member");
                    fields.push((Some(Name { text: member.to_string(), form: NameForm::Bare, span }), value));
                }
                InitialKind::Fields(fields)
            }
            _ => return None,
        };
        Some(InitialValue { kind, span })
    }
}

fn length(node: Node, span: Span) -> Option<Bound> {
    node.attribute("length").and_then(|length| length.trim().parse().ok()).map(|length| Bound::Number(length, span))
}

/// The type of an instance of a standard function block; `None`: a type of the file.
fn standard_block(name: &str) -> Option<&'static str> {
    const BLOCKS: &[(&str, &str)] = &[
        ("TP", "TP_TIME"),
        ("TON", "TON_TIME"),
        ("TOF", "TOF_TIME"),
        ("TONR", "TONR_TIME"),
        ("CTU", "CTU_INT"),
        ("CTD", "CTD_INT"),
        ("CTUD", "CTUD_INT"),
        ("CTU_DINT", "CTU_DINT"),
        ("CTD_DINT", "CTD_DINT"),
        ("CTUD_DINT", "CTUD_DINT"),
        ("CTU_UDINT", "CTU_UDINT"),
        ("CTD_UDINT", "CTD_UDINT"),
        ("CTUD_UDINT", "CTUD_UDINT"),
        ("CTU_LINT", "CTU_LINT"),
        ("CTD_LINT", "CTD_LINT"),
        ("CTUD_LINT", "CTUD_LINT"),
        ("CTU_ULINT", "CTU_ULINT"),
        ("CTD_ULINT", "CTD_ULINT"),
        ("CTUD_ULINT", "CTUD_ULINT"),
        ("R_TRIG", "R_TRIG"),
        ("F_TRIG", "F_TRIG"),
        ("SR", "BOOL"),
        ("RS", "BOOL"),
    ];
    BLOCKS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|(_, ty)| *ty)
}

/// Which flip-flop a variable is, of type SR or RS.
pub fn flip_flop(variable: Node) -> Option<FlipFlop> {
    let ty = child(variable, "type").and_then(|ty| child(ty, "derived"))?;
    match ty.attribute("name")?.to_ascii_uppercase().as_str() {
        "SR" => Some(FlipFlop::SetWins),
        "RS" => Some(FlipFlop::ResetWins),
        _ => None,
    }
}

/// The words of a node, markup aside.
pub fn plain_text(node: Node) -> String {
    let texts: Vec<&str> = node.descendants().filter(|node| node.is_text()).filter_map(|node| node.text()).collect();
    texts.join(" ").split_whitespace().collect::<Vec<_>>().join(" ")
}
