//! The conditions of transitions: a variable, an expression, statements or a network.

use plcc_diag::{Code, Span};
use roxmltree::Node;

use super::{Sfc, content};
use crate::plcopen::graph;
use crate::plcopen::interface::{child, elements};
use crate::plcopen::objects::{Edge, Kind, Object};
use crate::plcopen::order;
use plcc_syntax::chart::ast::Condition;
use plcc_syntax::network::ast::{Content, Graph, Language, Network, PinValue, Storage, Target};
use plcc_syntax::network::elements::Kind as ElementKind;
use plcc_syntax::scl::ast::{AssignOp, Expr, ExprKind, Name, NameForm, Statement, StatementKind, UnaryOp};

impl<'a> Sfc<'_, 'a, '_> {
    /// The condition of a transition; `network`: the object that represents it in the networks of the chart.
    pub fn condition(&mut self, transition: Node<'a, 'a>, network: Option<usize>, span: Span) -> Option<Condition> {
        let node = child(transition, "condition");
        if let Some(at) = network {
            return Some(self.connected(at, span));
        }
        let negated = node.is_some_and(|node| matches!(node.attribute("negated").map(str::trim), Some("true" | "1")));
        let reference = node.and_then(|node| child(node, "reference"));
        let inline = node.and_then(|node| child(node, "inline"));
        let condition = match (reference, inline) {
            (Some(reference), _) => self.reference(reference, span),
            (None, Some(inline)) => self.condition_body(inline, inline.attribute("name"), span),
            (None, None) => self.missing(span),
        };
        condition.map(|condition| if negated { inverted(condition) } else { condition })
    }

    fn missing(&mut self, span: Span) -> Option<Condition> {
        let help = "write the condition; with TRUE the transition switches immediately";
        self.report(Code::MissingCondition, span, "a transition without a condition", "", help);
        self.broken = true;
        None
    }

    /// A transition of the POU, or a variable.
    fn reference(&mut self, node: Node<'a, 'a>, span: Span) -> Option<Condition> {
        let name = node.attribute("name").unwrap_or("").trim();
        if let Some(known) = self.transitions.get(&name.to_lowercase()) {
            return known.clone();
        }
        let Some(attribute) = node.attribute_node("name").filter(|_| !name.is_empty()) else {
            return self.missing(span);
        };
        let value = self.reader.expression(attribute.range_value(), Some(&self.body.scope));
        Some(Condition::Expression(value))
    }

    /// A condition with its own body, inline or in a transition of the POU.
    pub fn condition_body(&mut self, holder: Node<'a, 'a>, name: Option<&str>, span: Span) -> Option<Condition> {
        let Some(content) = content(holder) else { return self.missing(span) };
        match content.tag_name().name() {
            "ST" => self.text(content, name, span),
            "LD" => self.graphic(content, name, Language::Lad, span),
            "FBD" => self.graphic(content, name, Language::Fbd, span),
            _ => self.refused(content),
        }
    }

    /// `a AND b`, `:= a AND b;`, `Name := a AND b;`, and statements before it.
    fn text(&mut self, content: Node<'a, 'a>, name: Option<&str>, span: Span) -> Option<Condition> {
        let Some(mut range) = self.reader.text_range(elements(content).next().unwrap_or(content)) else {
            return self.missing(span);
        };
        if self.reader.overlay.get(range.clone()).is_some_and(|text| text.starts_with(":=")) {
            range.start += 2;
        }
        let place = self.reader.span(range.clone());
        let mut statements = self.reader.statements(range, self.body);
        self.stays(&statements)?;
        statements.retain(|statement| statement.kind != StatementKind::Empty);
        let Some(last) = statements.pop() else { return self.missing(span) };
        let value = match last.kind {
            StatementKind::Expression(value) => value,
            StatementKind::Assign { mut targets, value } if is_result(&targets, name) => {
                targets.clear();
                value
            }
            StatementKind::Error => Expr { kind: ExprKind::Error, span: last.span },
            _ => {
                let text = "the statements of the transition do not end in a condition";
                let help = "write the BOOL expression of the condition as the last statement";
                self.report(Code::ConditionType, last.span, text, "not an expression", help);
                Expr { kind: ExprKind::Error, span: place }
            }
        };
        if statements.is_empty() {
            return Some(Condition::Expression(value));
        }
        statements.push(Statement { span: value.span, kind: StatementKind::Expression(value) });
        Some(Condition::Statements(statements))
    }

    /// A network that ends in a coil or an output variable of the transition's name.
    fn graphic(
        &mut self,
        content: Node<'a, 'a>,
        name: Option<&str>,
        language: Language,
        span: Span,
    ) -> Option<Condition> {
        if self.leaves(content) {
            return None;
        }
        let mut objects = self.reader.objects(content);
        let ends: Vec<usize> = (0..objects.len()).filter(|at| is_end(&objects[*at])).collect();
        let text = |at: &&usize| objects[**at].text.clone().and_then(|range| self.reader.overlay.get(range));
        let named = ends.iter().find(|at| text(at).zip(name).is_some_and(|(text, name)| same(text, name)));
        let open = ends.iter().find(|at| text(at).is_none());
        let only = ends.first().filter(|_| ends.len() == 1 && name.is_none());
        let Some(at) = named.or(open).or(only).copied() else {
            let what = name.map_or("its transition".to_string(), |name| format!("`{name}`"));
            let help = "end the network in one coil or output variable that has the name of the transition";
            self.report(Code::ConditionType, span, format!("the network does not write {what}"), "", help);
            return None;
        };
        let end = &mut objects[at];
        if end.modifiers.edge != Edge::None || end.modifiers.storage != Storage::None {
            let text = "a transition reads the signal itself: no edge, no set, no reset";
            let help = "make it a plain coil";
            let span = end.span;
            self.report(Code::ConditionType, span, text, "", help);
        }
        (end.kind, end.text) = (Kind::Condition, None);
        let order: Vec<usize> = order::groups(&objects).into_iter().flat_map(|group| group.objects).collect();
        let graph = graph::build(self.reader, self.body, &objects, &order);
        self.reader.unknown_connectors(&objects);
        Some(self.network(graph, language, span))
    }

    /// A network of the chart that leads to the transition.
    fn connected(&mut self, at: usize, span: Span) -> Condition {
        let objects = std::mem::take(&mut self.objects);
        let order = order::feeding(&objects, at);
        let is_ladder = order.iter().any(|at| matches!(objects[*at].kind, Kind::Contact | Kind::Coil));
        let graph = graph::build(self.reader, self.body, &objects, &order);
        self.objects = objects;
        self.network(graph, if is_ladder { Language::Lad } else { Language::Fbd }, span)
    }

    /// A network that is only an expression is that expression, or the transition of the POU that it names.
    fn network(&self, graph: Graph, language: Language, span: Span) -> Condition {
        if let [element] = graph.elements.as_slice()
            && let [pin] = element.pins.as_slice()
            && let PinValue::Operand(value) = &pin.value
        {
            let known = match &value.kind {
                ExprKind::Name(Name { text, form: NameForm::Bare, .. }) => self.transitions.get(&text.to_lowercase()),
                _ => None,
            };
            let condition = known.cloned().flatten().unwrap_or_else(|| Condition::Expression(value.clone()));
            return if pin.negated { inverted(condition) } else { condition };
        }
        let (title, comment, labels) = (None, Vec::new(), Vec::new());
        Condition::Network(Network { language, title, comment, labels, content: Content::Graphic(graph), span })
    }
}

fn same(text: &str, name: &str) -> bool {
    text.trim().eq_ignore_ascii_case(name.trim())
}

/// An object that a network may end in.
fn is_end(object: &Object) -> bool {
    matches!(object.kind, Kind::Coil | Kind::OutVariable | Kind::InOutVariable) && !object.inputs.is_empty()
}

/// `Name := …` in the transition of that name.
fn is_result(targets: &[(Expr, AssignOp)], name: Option<&str>) -> bool {
    let [(Expr { kind: ExprKind::Name(target), .. }, _)] = targets else { return false };
    name.is_some_and(|name| same(&target.text, name))
}

fn inverted(condition: Condition) -> Condition {
    let not = |value: Expr| {
        let span = value.span;
        Expr { kind: ExprKind::Unary { op: UnaryOp::Not, operand: Box::new(value) }, span }
    };
    match condition {
        Condition::Expression(value) => Condition::Expression(not(value)),
        Condition::Statements(mut list) => {
            if let Some(Statement { kind: StatementKind::Expression(value), .. }) = list.last_mut() {
                *value = not(value.clone());
            }
            Condition::Statements(list)
        }
        Condition::Network(mut network) => {
            if let Content::Graphic(graph) = &mut network.content {
                let is_end = |target: &Target| matches!(target, Target::Element { row, .. } if matches!(row.kind, ElementKind::Condition));
                let ends = graph.elements.iter_mut().filter(|element| is_end(&element.target));
                ends.flat_map(|element| &mut element.pins).for_each(|pin| pin.negated = !pin.negated);
            }
            Condition::Network(network)
        }
    }
}
