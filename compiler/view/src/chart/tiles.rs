//! Steps with their actions, and transitions with their conditions.

use std::cell::RefCell;
use std::collections::HashMap;

use plcc_diag::Span;
use plcc_syntax::chart::ast::{Action, ActionBody, Condition, Qualifier, Step, Transition};
use plcc_syntax::network::ast::{Content, Language};
use plcc_syntax::network::draw;
use plcc_syntax::scl::ast::Expr;

use super::piece::Piece;
use crate::metrics::{self, LINE};
use crate::names::{Names, Scope};
use crate::scene::{Anchor, Area, Frame, Ink, Item, Scene};
use crate::sheet::{Label, Link, Look, Meaning, Part, Pin, Place, Sheet, expression, network};
use crate::{diagram, ladder};

/// Width of small networks.
const NETWORK: i32 = 420;
/// Height of a step.
const STEP: i32 = 38;

/// What tiles are made of.
pub struct Tiles<'a> {
    /// The source, or its overlay.
    pub text: &'a str,
    pub names: &'a Names,
    pub scope: Scope,
    /// Values of operands by their keys.
    pub values: Option<&'a HashMap<String, String>>,
    /// Leave room for values.
    pub is_live: bool,
    /// The steps of the chart.
    pub steps: &'a [Step],
    /// All networks of the chart, with the numbers that their nets have in its drawing.
    pub all: RefCell<Sheet>,
}

impl Tiles<'_> {
    /// A step: its box, and a table of its actions beside it.
    pub fn step(&self, step: &Step) -> Piece {
        let mut scene = Scene::default();
        let number = format!("S{}", step.number);
        let name = if step.name.text == number { String::new() } else { step.name.text.clone() };
        let width = (metrics::width(&name, Ink::Title.height()) + 24).max(80);
        let kind = if step.initial { Frame::InitialStep } else { Frame::Step };
        let key = self.names.key(&format!("#{}.X", step.name.text), self.scope).unwrap_or_default();
        let area = Area { x: 0, y: 0, w: width, h: STEP };
        let fault = |member: &str| self.names.key(&format!("#{}.{member}", step.name.text), self.scope);
        let faults = ["LA", "VA"].into_iter().filter_map(fault).collect();
        scene.items.push(Item::Frame { area, kind, key, faults });
        scene.zone(area, Some(step.span.start));
        let middle = width / 2;
        let y = if name.is_empty() { 23 } else { 17 };
        scene.text((middle, y), Anchor::Middle, Ink::Title, &number, "");
        scene.text((middle, 31), Anchor::Middle, Ink::Title, &name, "");
        let (mut bottom, mut right) = (STEP, width);
        let left = width + 14;
        let mut rows: Vec<(String, Vec<String>, Option<Scene>, String)> = Vec::new();
        for action in &step.actions {
            let (text, drawing, key) = self.action(action);
            rows.push((marks(action), text, drawing, key));
        }
        for (caption, condition) in [("C", &step.interlock), ("V", &step.supervision)] {
            if let Some(condition) = condition {
                let (drawing, text) = self.condition(condition, caption);
                rows.push((caption.to_string(), text, drawing, String::new()));
            }
        }
        for (caption, time) in [("T_MAX", &step.maximum), ("T_WARN", &step.warning)] {
            if let Some(time) = time {
                rows.push((caption.to_string(), vec![draw::whole_of(time, self.text)], None, String::new()));
            }
        }
        let marks_width = rows.iter().map(|(marks, ..)| metrics::width(marks, metrics::TEXT)).max().unwrap_or(0) + 12;
        let inner = |(_, text, drawing, _): &(String, Vec<String>, Option<Scene>, String)| {
            let text = text.iter().map(|line| metrics::width(line, metrics::TEXT)).max().unwrap_or(0) + 12;
            text.max(drawing.as_ref().map_or(0, |scene| scene.width))
        };
        let table = rows.iter().map(inner).max().unwrap_or(0);
        if !rows.is_empty() {
            scene.items.push(Item::Stroke { points: vec![(width, 12), (left, 12)], ink: Ink::Plain });
        }
        let mut top = 0;
        for (marks, text, drawing, key) in rows {
            let height =
                drawing.as_ref().map_or(text.len() as i32 * LINE + 8, |scene| scene.height + text.len() as i32 * LINE);
            let height = height.max(LINE + 8);
            scene.frame(Area { x: left, y: top, w: marks_width, h: height }, Frame::Action, "");
            scene.frame(Area { x: left + marks_width, y: top, w: table, h: height }, Frame::Action, "");
            scene.text((left + marks_width / 2, top + 15), Anchor::Middle, Ink::Title, &marks, "");
            for (index, line) in text.iter().enumerate() {
                let at = (left + marks_width + 6, top + 15 + index as i32 * LINE);
                scene.text(at, Anchor::Start, Ink::Operand, line, &key);
            }
            if let Some(drawing) = drawing {
                scene.add(drawing, (left + marks_width, top + text.len() as i32 * LINE));
            }
            top += height;
            right = left + marks_width + table;
        }
        bottom = bottom.max(top);
        if bottom > STEP {
            scene.items.push(Item::Stroke { points: vec![(middle, STEP), (middle, bottom)], ink: Ink::Plain });
        }
        for line in step.comment.iter().flat_map(|line| metrics::wrapped(line.trim(), 60)) {
            let at = (middle + 8, bottom + 12);
            right = right.max(at.0 + metrics::width(&line, Ink::Note.height()));
            scene.items.push(Item::Stroke { points: vec![(middle, bottom), (middle, bottom + LINE)], ink: Ink::Plain });
            scene.text(at, Anchor::Start, Ink::Note, &line, "");
            bottom += LINE;
        }
        Piece { scene, width: right, height: bottom, entry: middle, exit: middle, ends: Vec::new() }
    }

    /// A transition: its bar, its name and its condition beside it.
    pub fn transition(&self, transition: &Transition) -> Piece {
        let mut scene = Scene::default();
        let entry = 40;
        let label = super::label(transition);
        scene.text((entry + 20, 4), Anchor::Start, Ink::Title, &label, "");
        let width = metrics::width(&label, metrics::TEXT);
        scene.zone(Area { x: entry - 14, y: -8, w: 34 + width, h: 16 }, Some(transition.span.start));
        let mut right = entry + 24 + width;
        let mut bottom = 14;
        if let Some(condition) = &transition.condition {
            let (drawing, text) = self.condition(condition, "");
            for line in text {
                scene.text((entry + 20, bottom + 8), Anchor::Start, Ink::Operand, &line, "");
                right = right.max(entry + 20 + metrics::width(&line, metrics::TEXT));
                bottom += LINE;
            }
            if let Some(drawing) = drawing {
                right = right.max(entry + 14 + drawing.width);
                let height = drawing.height;
                scene.add(drawing, (entry + 14, bottom - 6));
                bottom += height - 6;
            }
        }
        for line in transition.comment.iter().flat_map(|line| metrics::wrapped(line.trim(), 60)) {
            scene.text((entry + 20, bottom + 8), Anchor::Start, Ink::Note, &line, "");
            right = right.max(entry + 20 + metrics::width(&line, Ink::Note.height()));
            bottom += LINE;
        }
        scene.items.push(Item::Stroke { points: vec![(entry - 14, 0), (entry + 14, 0)], ink: Ink::Plain });
        scene.items.push(Item::Stroke { points: vec![(entry - 14, 1), (entry + 14, 1)], ink: Ink::Plain });
        scene.items.push(Item::Stroke { points: vec![(entry, -2), (entry, bottom)], ink: Ink::Plain });
        Piece { scene, width: right + 6, height: bottom, entry, exit: entry, ends: Vec::new() }
    }

    /// A condition as a network, or as text.
    pub fn condition(&self, condition: &Condition, sign: &str) -> (Option<Scene>, Vec<String>) {
        match condition {
            Condition::Expression(value) => {
                let sheet = expression::condition(value, sign, self.names, self.scope, self.steps, self.text);
                (Some(self.drawn(sheet, Language::Lad)), Vec::new())
            }
            Condition::Network(network) => match &network.content {
                Content::Graphic(graph) => (Some(self.network(graph, network.language)), Vec::new()),
                Content::Scl(_) | Content::Stl(_) => (None, self.lines(network.span)),
            },
            Condition::Statements(statements) => {
                (None, statements.iter().flat_map(|statement| self.lines(statement.span)).collect())
            }
        }
    }

    /// A small network.
    pub fn network(&self, graph: &plcc_syntax::network::ast::Graph, language: Language) -> Scene {
        self.drawn(network::sheet(graph, language, self.names, self.scope, self.text), language)
    }

    fn drawn(&self, mut sheet: Sheet, language: Language) -> Scene {
        if let Some(values) = self.values {
            sheet.show(&|key| values.get(key).cloned());
        }
        if self.is_live {
            sheet.leave_room();
        }
        let mut scene = match language {
            Language::Fbd => diagram::draw(&sheet, NETWORK),
            Language::Lad | Language::Scl | Language::Stl => ladder::draw(&mut sheet, NETWORK),
        };
        let mut all = self.all.borrow_mut();
        scene.renumber_parts(all.parts.len());
        scene.renumber(all.append(sheet));
        scene
    }

    /// The chart writes an operand.
    fn writes(&self, label: &Label) {
        let pin = Pin {
            name: String::new(),
            place: Place::Side,
            output: true,
            link: Link::Operand(label.clone()),
            negated: false,
        };
        let part = Part {
            look: Look::Nothing,
            meaning: Meaning::Other,
            pins: vec![pin],
            flow_in: None,
            flow_out: None,
            place: None,
            statement: None,
        };
        self.all.borrow_mut().parts.push(part);
    }

    fn action(&self, action: &Action) -> (Vec<String>, Option<Scene>, String) {
        let one = |text: String| (metrics::wrapped(&text, 46), None);
        let mut key = String::new();
        let (mut lines, drawing) = match &action.body {
            ActionBody::Operand(value) => {
                let label = self.names.label(&draw::whole_of(value, self.text), self.scope);
                self.writes(&label);
                key = label.key;
                let address = if label.address.is_empty() { String::new() } else { format!(" {}", label.address) };
                one(label.text + &address)
            }
            ActionBody::Value { operand, value } => {
                let label = self.names.label(&draw::whole_of(operand, self.text), self.scope);
                self.writes(&label);
                key = label.key;
                // With N the value is assigned; with other qualifiers it is their time or count.
                let sign = if action.qualifier == Qualifier::N { " := " } else { ", " };
                one(format!("{}{sign}{}", label.text, self.formula(value)))
            }
            ActionBody::All { .. } => one("S_ALL".to_string()),
            ActionBody::Call(call) => (self.lines(call.span), None),
            ActionBody::Statements(list) => (list.iter().flat_map(|s| self.lines(s.span)).collect(), None),
            ActionBody::Network(network) => match &network.content {
                Content::Graphic(graph) => (Vec::new(), Some(self.network(graph, network.language))),
                Content::Scl(_) | Content::Stl(_) => (self.lines(network.span), None),
            },
            ActionBody::Error => (Vec::new(), None),
        };
        if let Some(comment) = action.comment.as_deref().filter(|comment| !comment.trim().is_empty()) {
            lines.extend(metrics::wrapped(&format!("// {}", comment.trim()), 46));
        }
        (lines, drawing, key)
    }

    /// A formula, whose operands look as they do elsewhere in the chart: an address has no `%`, or is its symbol.
    fn formula(&self, value: &Expr) -> String {
        let is_sign = |c: char| matches!(c, ' ' | '(' | ')' | '[' | ']' | ',');
        let label = |part: &str| {
            let (word, rest) = part.split_at(part.trim_end_matches(is_sign).len());
            format!("{}{rest}", self.names.label(word, self.scope).text)
        };
        // What is in quotes is one word.
        let mut quote: Option<char> = None;
        let is_end = |c: char| {
            let is_quote = matches!(c, '"' | '\'');
            match quote {
                Some(own) => quote = quote.filter(|_| own != c),
                None => quote = Some(c).filter(|_| is_quote),
            }
            quote.is_none() && is_sign(c)
        };
        draw::formula_of(value, self.text).split_inclusive(is_end).map(label).collect()
    }

    /// The text of a place, without line breaks.
    fn lines(&self, span: Span) -> Vec<String> {
        let text = self.text.get(span.start as usize..span.end as usize).unwrap_or_default();
        metrics::wrapped(&text.split_whitespace().collect::<Vec<_>>().join(" "), 46)
    }
}

/// Event, qualifier and the C of the interlock.
fn marks(action: &Action) -> String {
    let event = action.event.map_or(String::new(), |event| format!("{} ", event.name()));
    format!("{event}{}{}", action.qualifier.name(), if action.interlock { "C" } else { "" })
}
