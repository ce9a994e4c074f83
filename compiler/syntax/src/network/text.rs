//! Graphs as text, for `--emit ast`: one element per line, with nets by number. The same network gives the same text from every file.

use std::fmt::Write as _;

use super::ast::{Element, Eno, Graph, NetId, Pin, PinValue, Source, Storage, Target, TemplateKey};
use crate::scl::text::expr;

/// The lines of a graph: its elements, then the sources of its nets.
pub fn graph(graph: &Graph) -> Vec<String> {
    let numbers = Numbers::of(graph);
    let mut lines: Vec<String> = graph.elements.iter().map(|element| element_line(element, &numbers)).collect();
    for (number, id) in numbers.order.iter().enumerate() {
        let sources: Vec<String> =
            graph.net(*id).sources.iter().map(|source| source_text(source, graph, &numbers)).collect();
        lines.push(format!(
            "n{number} = {}",
            if sources.is_empty() { "nothing".to_string() } else { sources.join(" OR ") }
        ));
    }
    lines
}

/// Nets in the order of their first mention.
struct Numbers {
    order: Vec<NetId>,
}

impl Numbers {
    fn of(graph: &Graph) -> Numbers {
        let mut order = Vec::new();
        let mut note = |id: NetId| {
            if !order.contains(&id) {
                order.push(id);
            }
        };
        for pin in graph.elements.iter().flat_map(|element| &element.pins) {
            if let PinValue::Net(id) = pin.value {
                note(id);
            }
        }
        for (at, net) in graph.nets.iter().enumerate() {
            if !net.sources.is_empty() {
                note(NetId(at as u32));
            }
        }
        Numbers { order }
    }

    fn name(&self, id: NetId) -> String {
        match self.order.iter().position(|known| *known == id) {
            Some(number) => format!("n{number}"),
            None => "nothing".to_string(),
        }
    }
}

fn source_text(source: &Source, graph: &Graph, numbers: &Numbers) -> String {
    match source {
        Source::Rail => "rail".to_string(),
        Source::Pin { element, pin } => {
            let name =
                graph.elements.get(*element).and_then(|element| element.pins.get(*pin)).map_or("?", |pin| &pin.name);
            format!("{element}.{name}")
        }
        Source::Operand { value, negated } => format!("{}{}", if *negated { "NOT " } else { "" }, expr(value)),
        Source::Net(id) => numbers.name(*id),
    }
}

fn element_line(element: &Element, numbers: &Numbers) -> String {
    let mut line = match &element.target {
        Target::Element { row, instance: None } => row.name.to_string(),
        Target::Element { row, instance: Some(instance) } => format!("{}.{}", expr(instance), row.name),
        Target::Block { callee, instance: None } => expr(callee),
        Target::Block { callee, instance: Some(instance) } => format!("{}, {}", expr(callee), expr(instance)),
    };
    for template in element.templates.iter().filter(|template| template.key != TemplateKey::Other) {
        let _ = write!(line, " {:?}={}", template.key, template.value.to_uppercase());
    }
    match element.eno {
        Eno::Default => {}
        Eno::Generated => line.push_str(" eno"),
        Eno::Disabled => line.push_str(" no_eno"),
    }
    if let Some(equation) = &element.equation {
        let _ = write!(line, " {{{}}}", expr(equation));
    }
    if !element.cases.is_empty() {
        let _ = write!(line, " {:?}", element.cases);
    }
    let pins: Vec<String> = element.pins.iter().map(|pin| pin_text(pin, numbers)).collect();
    let _ = write!(line, " ({})", pins.join(", "));
    line
}

fn pin_text(pin: &Pin, numbers: &Numbers) -> String {
    let value = match &pin.value {
        PinValue::Net(id) => numbers.name(*id),
        PinValue::Operand(value) => expr(value),
        PinValue::Open => String::new(),
    };
    let storage = match pin.storage {
        Storage::None => "",
        Storage::Set => "S ",
        Storage::Reset => "R ",
    };
    let arrow = if pin.output { "=>" } else { ":=" };
    let not = if pin.negated { "NOT " } else { "" };
    format!("{} {arrow} {storage}{not}{value}", pin.name)
}
